//! Noise from the data themselves: what is left of curves when everything smooth is removed.
//!
//! Windows of k+1 neighbouring frequencies are combined with divided-difference weights, which remove every polynomial
//! of degree below k; what remains is noise of known weight. Near a resonance neither the logarithm of the amplitude
//! nor the phase is nearly a polynomial, but the dynamic stiffness u0/(A exp(i phi)) is: of a linear oscillator it is
//! one of degree 2, and its squared magnitude one of degree 4. So all of these are tried in orders 2 to 5. Whatever is
//! not smooth enough for one of them makes that one too large, never too small; the answer is the middle of those that
//! are not distinguishable from the smallest. Each scale is robust, so a jump, an outlier or one steep stretch does not
//! matter.

use std::f64::consts::PI;

use super::Point;
use super::floor::{self, Group, Two};
use crate::statistics::{median, wrap};

/// The noise of single readings as the curves show it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// Relative standard deviation of the amplitude.
    pub amplitude: Option<Spread>,
    /// Standard deviation of the phase \[rad\].
    pub phase: Option<Spread>,
}

/// A standard deviation and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// The standard deviation.
    pub sd: f64,
    /// Roughly how many independent deviations it comes from.
    pub degrees_of_freedom: usize,
    /// Order of the differences that were decisive.
    pub order: usize,
    /// Its parts, where the readings tell more than one.
    pub parts: Option<Parts>,
}

/// The parts of a noise; none of a kind is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// In proportion to the reading, or of any phase \[rad\].
    pub share: f64,
    /// The same at any reading, as that of an amplifier is \[times the unit of the reading\].
    pub floor: f64,
    /// Relative deviation of a frequency that wavers, of which the slope of a curve makes one of the reading.
    pub waver: f64,
}

impl Parts {
    /// The standard deviation at an amplitude: relative, or of the phase. `slope` is its change, relative or in rad, per
    /// relative change of the frequency.
    fn at(&self, amplitude: f64, slope: f64) -> f64 {
        self.share.hypot(self.floor / amplitude).hypot(self.waver * slope)
    }
}

impl Spread {
    /// As `Parts::at`.
    pub fn at(&self, amplitude: f64, slope: f64) -> f64 {
        self.parts.map_or(self.sd, |parts| parts.at(amplitude, slope))
    }
}

/// Fewest points of a curve that tell noise from shape.
const MIN_CURVE: usize = 6;
/// Readings of the shortest window.
const SHORTEST: usize = 3;
/// Neighbours on either side by which the slope of a curve is told.
const NEAR: usize = 2;
/// Deviations beyond this many standard deviations do not count.
const CUT: f64 = 2.5;
/// Variance of a normal distribution that is cut there.
const CUT_VARIANCE: f64 = 0.911_26;

/// One estimate among several.
#[derive(Debug, Clone, Copy)]
struct Trial {
    sd: f64,
    windows: usize,
    order: usize,
}

/// A reading of a curve: frequency, amplitude, unwrapped phase, number of readings pooled in it.
#[derive(Debug, Clone, Copy)]
struct Sample {
    frequency: f64,
    amplitude: f64,
    phase: Option<f64>,
    readings: f64,
    /// The amplitude as it was read.
    read: f64,
    /// Changes of amplitude, relative, and phase per relative change of the frequency.
    slopes: [f64; 2],
}

/// Estimates the noise of single readings from the scatter of points about smooth curves of amplitude and phase against
/// frequency, one curve per series, and per load and speed in it. Where the drive differs from row to row, the
/// amplitude per drive is what is smooth. `None` where no curve has six points.
pub fn scatter(points: &[Point]) -> Scatter {
    let curves: Vec<Vec<Sample>> = grouped(points).iter().map(|group| curve(points, group)).collect();
    if curves.iter().all(|curve| curve.len() < MIN_CURVE) {
        return Scatter::default();
    }
    let [amplitude, phase] = of_windows(&curves, &EVEN, &|_| true);
    let with = |of: usize, spread: Option<Spread>| spread.map(|spread| Spread { parts: parts(&curves, of), ..spread });
    Scatter { amplitude: with(0, amplitude), phase: with(1, phase) }
}

/// The parts of the noise of amplitude (0) or phase (1): first the one that tells more beside what is the same
/// everywhere, then the other beside both.
fn parts(curves: &[Vec<Sample>], of: usize) -> Option<Parts> {
    let sizes: [&dyn Fn(&Sample) -> f64; 2] = [&|sample| sample.read, &|sample| sample.slopes[of].recip()];
    let told = |kind: usize| second(curves, of, &EVEN, sizes[kind]).map(|two| (kind, two));
    let (first, two) = [0, 1].into_iter().filter_map(told).max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
    let mut rests = [0.0; 2];
    rests[first] = two.rest;
    let both = |sample: &Sample| two.share.hypot(two.rest / sizes[first](sample));
    let mut share = two.share;
    let mut deviations: Deviations<'_> = EVEN;
    deviations[of] = &both;
    if let Some(more) = second(curves, of, &deviations, &|sample| sizes[1 - first](sample) * both(sample)) {
        share *= more.share;
        rests[first] *= more.share;
        rests[1 - first] = more.rest;
    }
    Some(Parts { share, floor: rests[0], waver: rests[1] })
}

/// A second part of the noise of amplitude or phase, which falls with this size of a reading, beside what is in these
/// proportions.
fn second(
    curves: &[Vec<Sample>],
    of: usize,
    deviations: &Deviations<'_>,
    size: &dyn Fn(&Sample) -> f64,
) -> Option<Two> {
    let middle = |window: &[Sample]| size(&window[window.len() / 2]);
    let all = curves.iter().flat_map(|curve| curve.windows(SHORTEST).map(middle));
    let ranges = floor::groups(all.filter(|size| *size > 0.0 && size.is_finite()).collect()).into_iter();
    let group = |((low, high), middle): ((f64, f64), f64)| {
        let Spread { sd, degrees_of_freedom, .. } =
            of_windows(curves, deviations, &|sample| (low..=high).contains(&size(sample)))[of]?;
        Some(Group { size: middle, variance: sd * sd, degrees_of_freedom: degrees_of_freedom as f64 })
    };
    floor::parts(&ranges.filter_map(group).collect::<Vec<_>>())
}

/// The same deviation everywhere, of amplitude and phase.
const EVEN: Deviations<'static> = [&|_| 1.0, &|_| 1.0];

/// Changes of amplitude, relative, and phase per relative change of the frequency at every point, along its curve.
pub(super) fn slopes(points: &[Point]) -> Vec<[f64; 2]> {
    let mut all = vec![[0.0; 2]; points.len()];
    for group in grouped(points) {
        let samples = curve(points, &group);
        for index in group {
            let at = samples.partition_point(|sample| sample.frequency < points[index].frequency);
            all[index] = samples[at].slopes;
        }
    }
    all
}

/// Noise of amplitude and phase, in units of what is in these proportions, as the windows show it whose middle is one of
/// these.
fn of_windows(curves: &[Vec<Sample>], deviations: &Deviations<'_>, within: Within<'_>) -> [Option<Spread>; 2] {
    let (mut amplitude, mut phase) = (Vec::new(), Vec::new());
    let [of_amplitude, of_phase] = *deviations;
    let with_phase: Vec<Vec<Sample>> =
        curves.iter().map(|curve| curve.iter().copied().filter(|sample| sample.phase.is_some()).collect()).collect();
    let phases = with_phase.iter().any(|curve| curve.len() >= MIN_CURVE);
    for order in 2..=5 {
        amplitude.extend(plain(curves, order, within, |s| (s.amplitude.ln(), of_amplitude(s))));
        amplitude.extend(plain(curves, order, within, |s| {
            (s.amplitude.powi(-2), 2.0 * s.amplitude.powi(-2) * of_amplitude(s))
        }));
        if phases {
            phase.extend(plain(&with_phase, order, within, |s| (s.phase.unwrap_or(0.0), of_phase(s))));
            if let Some((along, across)) = stiffness(&with_phase, order, deviations, within) {
                amplitude.push(along);
                phase.push(across);
            }
        }
    }
    [verdict(amplitude), verdict(phase)]
}

/// Standard deviations of amplitude, relative, and phase, up to a factor.
type Deviations<'a> = [&'a dyn Fn(&Sample) -> f64; 2];
/// Whether a sample is one of those that are looked at.
type Within<'a> = &'a dyn Fn(&Sample) -> bool;

/// The windows of so many neighbours whose middle is one of these.
fn windows<'c>(curves: &'c [Vec<Sample>], order: usize, within: Within<'_>) -> impl Iterator<Item = &'c [Sample]> {
    let inside = move |window: &&[Sample]| within(&window[window.len() / 2]);
    curves.iter().flat_map(move |curve| curve.windows(order + 1)).filter(inside)
}

/// Numbers of the points of every curve, sorted by frequency.
fn grouped(points: &[Point]) -> Vec<Vec<usize>> {
    let mut sorted: Vec<usize> = (0..points.len()).filter(|index| points[*index].amplitude > 0.0).collect();
    let key = |index: usize| {
        let p = &points[index];
        [p.series as f64, p.load, p.speed, p.frequency, p.amplitude]
    };
    sorted.sort_by(|a, b| {
        let pairs = key(*a).into_iter().zip(key(*b)).map(|(a, b)| a.total_cmp(&b));
        pairs.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    });
    let same = |a: &usize, b: &usize| key(*a)[..3] == key(*b)[..3];
    sorted.chunk_by(same).map(<[usize]>::to_vec).collect()
}

/// One of them: phases unwrapped, amplitudes, or amplitudes per drive, in units of the largest.
fn curve(points: &[Point], group: &[usize]) -> Vec<Sample> {
    let group: Vec<&Point> = group.iter().map(|index| &points[*index]).collect();
    let steady = group.iter().all(|point| point.drive == group[0].drive);
    let size = |point: &Point| if steady { point.amplitude } else { point.amplitude / point.drive };
    let largest = group.iter().map(|point| size(point)).fold(0.0, f64::max);
    let mut before: Option<f64> = None;
    let mut samples: Vec<Sample> = Vec::with_capacity(group.len());
    for point in group {
        let phase = point.phase.map(|phase| before.map_or(phase, |last| last + wrap(phase - last)));
        before = phase.or(before);
        if samples.last().is_some_and(|last| last.frequency == point.frequency) {
            continue;
        }
        let (amplitude, readings) = (size(point) / largest, point.replicates.max(1) as f64);
        let (frequency, read, slopes) = (point.frequency, point.amplitude, [0.0; 2]);
        samples.push(Sample { frequency, amplitude, phase, readings, read, slopes });
    }
    for index in 0..samples.len() {
        let near = &samples[index.saturating_sub(NEAR)..(index + NEAR + 1).min(samples.len())];
        let of_amplitude = slope(near.iter().map(|s| (s.frequency.ln(), s.amplitude.ln())));
        let of_phase = slope(near.iter().filter_map(|s| Some((s.frequency.ln(), s.phase?))));
        samples[index].slopes = [of_amplitude, of_phase].map(f64::abs);
    }
    samples
}

/// Slope of the straight line by least squares; 0 for one point.
fn slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let count = points.clone().count() as f64;
    let [x, y] = points.clone().fold([0.0; 2], |[x, y], point| [x + point.0 / count, y + point.1 / count]);
    let [xx, xy] = points.fold([0.0; 2], |[xx, xy], p| [xx + (p.0 - x).powi(2), xy + (p.0 - x) * (p.1 - y)]);
    if xx > 0.0 { xy / xx } else { 0.0 }
}

/// Weights that remove every polynomial of degree below the number of samples less one.
fn weights(window: &[Sample]) -> Vec<f64> {
    let width = window[window.len() - 1].frequency - window[0].frequency;
    let inverse = |j: usize| -> f64 {
        let others = window.iter().enumerate().filter(|(m, _)| *m != j);
        others.map(|(_, other)| width / (window[j].frequency - other.frequency)).product()
    };
    (0..window.len()).map(inverse).collect()
}

/// Scale of the differences of a real quantity; `of` gives it and its change per relative change of the reading.
fn plain(
    curves: &[Vec<Sample>],
    order: usize,
    within: Within<'_>,
    of: impl Fn(&Sample) -> (f64, f64),
) -> Option<Trial> {
    let residual = |window: &[Sample]| {
        let (mut sum, mut variance) = (0.0, 0.0);
        for (weight, sample) in weights(window).iter().zip(window) {
            let (value, slope) = of(sample);
            sum += weight * value;
            variance += (weight * slope).powi(2) / sample.readings;
        }
        sum / variance.sqrt()
    };
    let residuals: Vec<f64> = windows(curves, order, within).map(residual).collect();
    Some(Trial { sd: scale(&residuals)?, windows: residuals.len(), order })
}

/// Scales of the differences of the dynamic stiffness, of which the noise of amplitude and phase are the two parts.
fn stiffness(
    curves: &[Vec<Sample>],
    order: usize,
    deviations: &Deviations<'_>,
    within: Within<'_>,
) -> Option<(Trial, Trial)> {
    // Real and imaginary part against the middle of the window, and of each the variance by amplitude and by phase.
    let part = |window: &[Sample]| {
        let middle = window[order / 2].phase.unwrap_or(0.0);
        let mut found = [0.0; 6];
        for (weight, sample) in weights(window).iter().zip(window) {
            let (sine, cosine) = (middle - sample.phase.unwrap_or(0.0)).sin_cos();
            let (along, across) = (weight * cosine / sample.amplitude, weight * sine / sample.amplitude);
            let [by_amplitude, by_phase] = deviations.map(|deviation| deviation(sample).powi(2) / sample.readings);
            found[0] += along;
            found[1] += across;
            found[2] += along * along * by_amplitude;
            found[3] += across * across * by_phase;
            found[4] += across * across * by_amplitude;
            found[5] += along * along * by_phase;
        }
        found
    };
    let parts: Vec<[f64; 6]> = windows(curves, order, within).map(part).collect();
    // The variance of phase over that of amplitude, found together with both.
    let mut ratio: f64 = 1.0;
    let mut found = (0.0, 0.0);
    for _ in 0..12 {
        let real = |[re, _, own, other, ..]: &[f64; 6]| re / (own + ratio * other).sqrt();
        let imaginary = |[_, im, _, _, other, own]: &[f64; 6]| im / (own + other / ratio).sqrt();
        found = (
            scale(&parts.iter().map(real).collect::<Vec<_>>())?,
            scale(&parts.iter().map(imaginary).collect::<Vec<_>>())?,
        );
        ratio = (found.1 / found.0).powi(2);
        ratio = if ratio.is_finite() { ratio.clamp(1e-3, 1e3) } else { 1.0 };
    }
    let trial = |sd: f64| Trial { sd, windows: parts.len(), order };
    Some((trial(found.0), trial(found.1)))
}

/// Robust standard deviation about zero: from the median, then of all that lies within [`CUT`] of it.
fn scale(residuals: &[f64]) -> Option<f64> {
    let mut sizes: Vec<f64> = residuals.iter().map(|value| value.abs()).filter(|size| size.is_finite()).collect();
    if sizes.len() < 3 {
        return None;
    }
    sizes.sort_by(f64::total_cmp);
    let mut sd = median(sizes.iter().copied()) / 0.6745;
    for _ in 0..50 {
        let near = &sizes[..sizes.partition_point(|size| *size <= CUT * sd)];
        let next = (near.iter().map(|size| size * size).sum::<f64>() / near.len().max(1) as f64 / CUT_VARIANCE).sqrt();
        if near.is_empty() || next == sd {
            break;
        }
        sd = next;
    }
    Some(sd)
}

/// The middle of the estimates that are no larger than the smallest by more than chance.
fn verdict(trials: Vec<Trial>) -> Option<Spread> {
    let most = trials.iter().map(|trial| trial.windows).max()?;
    let mut trials: Vec<Trial> = trials.into_iter().filter(|trial| 2 * trial.windows >= most).collect();
    trials.sort_by(|a, b| a.sd.total_cmp(&b.sd).then(a.order.cmp(&b.order)));
    let limit = trials.first()?.sd * (1.0 + 1.5 / (most as f64).sqrt());
    let alike: Vec<Trial> = trials.into_iter().take_while(|trial| trial.sd <= limit).collect();
    let sd = median(alike.iter().map(|trial| trial.sd));
    let chosen = alike[(alike.len() - 1) / 2];
    // Overlapping windows are correlated; this many of them count in the variance of their mean square.
    let independent = 1.0 / (PI * chosen.order as f64 / 2.0).sqrt();
    let degrees_of_freedom = ((chosen.windows as f64 * independent).round() as usize).max(1);
    Some(Spread { sd, degrees_of_freedom, order: chosen.order, parts: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(frequencies: impl Iterator<Item = f64>, of: impl Fn(f64) -> (f64, f64)) -> Vec<Point> {
        let point = |(row, frequency): (usize, f64)| {
            let (amplitude, phase) = of(frequency);
            let (speed, load, drive) = (0.01, 20.0, 2.5e-6);
            let (phase, phase_sd) = (Some(wrap(phase)), Some(f64::NAN));
            let amplitude_sd = f64::NAN;
            let (mean, replicates) = (None, 1);
            Point {
                row,
                line: row,
                speed,
                load,
                drive,
                frequency,
                amplitude,
                phase,
                amplitude_sd,
                phase_sd,
                mean,
                replicates,
                series: 0,
            }
        };
        frequencies.enumerate().map(point).collect()
    }

    #[test]
    fn a_linear_resonance_without_noise_leaves_nothing() {
        let of = |f: f64| {
            let (re, im) = (1.0 - (f / 72.0).powi(2), f / 72.0 / 7.0);
            (1e-6 / re.hypot(im), -im.atan2(re))
        };
        let seen = scatter(&curve((0..24).map(|n| 52.0 + 2.0 * f64::from(n)), of));
        assert!(seen.amplitude.is_some_and(|spread| spread.sd < 1e-9), "{seen:?}");
        assert!(seen.phase.is_some_and(|spread| spread.sd < 1e-9), "{seen:?}");
    }

    #[test]
    fn uneven_steps_and_a_turning_phase_are_smooth_too() {
        let seen = scatter(&curve((0..30).map(|n| 50.0 * 1.02f64.powi(n)), |f| (1e-6 / f, -0.2 * f)));
        assert!(seen.amplitude.is_some_and(|spread| spread.sd < 1e-6), "{seen:?}");
        assert!(seen.phase.is_some_and(|spread| spread.sd < 1e-6), "{seen:?}");
    }

    #[test]
    fn five_points_tell_nothing() {
        let five = curve((0..5).map(|n| 50.0 + f64::from(n)), |f| (1e-6 * f, 0.0));
        assert_eq!(scatter(&five), Scatter::default());
        assert_eq!(scatter(&[]), Scatter::default());
    }
}
