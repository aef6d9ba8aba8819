//! A resonance beside something constant that is read with it: a peak on a floor, a notch, what is neither (Fano 1961).
//!
//! Against d = w^2/wc^2 - 1 the reading per drive is H = B + c/(d - p) with a complex pole p; multiplied by d - p that
//! is linear in p, B and c - B p (Levy 1959), and with the weights 1/|d - p| of the pole before the residual is that of
//! H (Sanathanan and Koerner 1963). Of amplitudes alone |H|^2 is a ratio of two parabolas, and the same holds. However
//! many times the motion is differentiated in the reading, that changes c by no more than in proportion to d.

use super::Resonance;
use crate::fit::{MARGIN, price};
use crate::measurement::Point;
use crate::statistics::{median, wrap};
use nalgebra::{Complex, ComplexField, DMatrix, DVector};

/// Fewest readings for each number of the ratio.
const FEWEST: usize = 3;
/// Fewest readings of a part: three for each number of a ratio beside what changes in proportion to the frequency, at
/// half of the length.
const FEWEST_OF_PART: usize = 2 * FEWEST * 4;
/// Parts of one length that are looked at: those of which a straight line leaves most.
const PARTS: usize = 4;
/// Weights are found again so many times; a pole that is one settles within three or four.
const ROUNDS: usize = 12;
/// Square of the relative change of all numbers at which they are settled: that of rounding errors.
const SETTLED: f64 = 1e-20;

/// What lies in the band of the readings; `None` where they tell none, by Schwarz's criterion against a straight line.
pub(super) fn on_floor(usable: &[&Point]) -> Option<Resonance> {
    within(usable).map(|(_, resonance)| resonance)
}

/// What lies with its width in a part of the readings, beside what no straight line is over all of them (a coil): of
/// the halves, quarters and so on along the frequency the part where a resonance tells most.
pub(super) fn in_part(usable: &[&Point]) -> Option<Resonance> {
    let mut sorted = usable.to_vec();
    sorted.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    let mut best: Option<(f64, Resonance)> = None;
    let mut length = sorted.len() / 2;
    while length >= FEWEST_OF_PART {
        // Every part of half the length lies in one of the windows.
        let firsts = (0..=sorted.len() - length).step_by(length / 2);
        let mut windows: Vec<(f64, &[&Point])> =
            firsts.map(|first| &sorted[first..first + length]).map(|window| (bent(window), window)).collect();
        windows.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, window) in windows.into_iter().take(PARTS) {
            let Some((gain, found)) = within(window) else { continue };
            let half = 0.5 * found.frequency / found.quality;
            let holds = |p: &&Point, side: f64| side * (p.frequency - found.frequency) > half;
            let inside = window.iter().any(|p| holds(p, 1.0)) && window.iter().any(|p| holds(p, -1.0));
            if inside && best.as_ref().is_none_or(|(most, _)| gain > *most) {
                best = Some((gain, found));
            }
        }
        length /= 2;
    }
    best.map(|(_, resonance)| resonance)
}

/// Squares that a straight line leaves of amplitudes.
fn bent(window: &[&Point]) -> f64 {
    let center = window[window.len() / 2].frequency;
    let d: Vec<f64> = window.iter().map(|p| (p.frequency / center).powi(2) - 1.0).collect();
    let responses: Vec<f64> = window.iter().map(|p| p.amplitude / p.drive).collect();
    straight(&d, &responses).unwrap_or(0.0)
}

/// What lies in the band of the readings, and by how much Schwarz's criterion is for it against a straight line.
fn within(usable: &[&Point]) -> Option<(f64, Resonance)> {
    let (low, high) = usable.iter().fold((f64::INFINITY, 0.0f64), |(l, h), p| (l.min(p.frequency), h.max(p.frequency)));
    let center = (low * high).sqrt();
    let detuning: Vec<f64> = usable.iter().map(|p| (p.frequency / center).powi(2) - 1.0).collect();
    let reach = detuning.iter().map(|d| d.abs()).fold(0.0, f64::max);
    let d: Vec<f64> = detuning.iter().map(|d| d / reach).collect();
    let size = |p: &Point| p.amplitude / p.drive;
    let response: Option<Vec<Complex<f64>>> =
        usable.iter().map(|p| Some(Complex::from_polar(size(p), p.phase?))).collect();
    let found = match response {
        Some(response) => of_responses(&d, &response),
        None => of_squares(&d, &usable.iter().map(|p| size(p).powi(2)).collect::<Vec<_>>()),
    }?;
    let (shift, width) = (found.shift * reach, found.width * reach);
    let frequency = center * (1.0 + shift).max(0.0).sqrt();
    let ratio = frequency / center;
    let quality = (ratio.powi(2) / width).clamp(super::QUALITY.0, super::QUALITY.1);
    let resonance = || Resonance {
        frequency,
        quality,
        peak: found.peak,
        phase: found.phase.map(wrap),
        spanned: true,
        peaked: quality > super::QUALITY.0,
    };
    (low < frequency && frequency < high).then(|| (found.gain, resonance()))
}

/// A pole in units of the reach of the readings, and what it adds to them where it is nearest.
struct Pole {
    shift: f64,
    width: f64,
    peak: f64,
    phase: Option<f64>,
    /// By how much Schwarz's criterion is for it.
    gain: f64,
}

/// Of a cable, too, which turns the phase in proportion to the frequency: as the readings say that stand between
/// others, or not at all.
fn of_responses(d: &[f64], response: &[Complex<f64>]) -> Option<Pole> {
    let mut order: Vec<usize> = (0..d.len()).collect();
    order.sort_by(|&a, &b| d[a].total_cmp(&d[b]));
    let turn = |pair: &[usize]| (response[pair[1]] / response[pair[0]]).arg() / (d[pair[1]] - d[pair[0]]);
    let slope = median(order.windows(2).map(turn).filter(|slope| slope.is_finite()));
    let along = |slope: f64| {
        let turned: Vec<Complex<f64>> =
            d.iter().zip(response).map(|(d, value)| value * Complex::from_polar(1.0, -slope * d)).collect();
        [beside::<3>(d, &turned), beside::<4>(d, &turned)].map(|found| found.map(|(left, pole)| (left, slope, pole)))
    };
    let found = [0.0, slope].into_iter().flat_map(along).flatten();
    let (_, slope, pole) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Pole { phase: pole.phase.map(|phase| phase + slope * pole.shift), ..pole })
}

/// A pole beside something constant (N = 3), or that changes in proportion to the frequency (N = 4), and the criterion
/// of what it leaves.
fn beside<const N: usize>(d: &[f64], response: &[Complex<f64>]) -> Option<(f64, Pole)> {
    let mean = response.iter().sum::<Complex<f64>>() / d.len() as f64;
    let h: Vec<Complex<f64>> = response.iter().map(|value| value - mean).collect();
    let powers = |d: Complex<f64>| -> [Complex<f64>; N] { std::array::from_fn(|k| d.powu(k as u32)) };
    // h d = p h + numerator, in which the numbers after the first multiply powers of d.
    let solution = settled(d.len(), |i, before: Option<&[Complex<f64>; N]>| {
        let weight = before.map_or(1.0, |before| 1.0 / (Complex::from(d[i]) - before[0]).norm());
        let mut row = powers(d[i].into());
        row.rotate_right(1);
        row[0] = h[i];
        (row.map(|x| x * weight), h[i] * d[i] * weight)
    })?;
    let p = solution[0];
    let numerator = |d: Complex<f64>| -> Complex<f64> {
        powers(d).iter().zip(&solution[1..]).map(|(power, number)| power * number).sum()
    };
    let left = |i: usize| h[i] - numerator(d[i].into()) / (Complex::from(d[i]) - p);
    let line = straight(d, &h)?;
    let own = criterion((0..d.len()).map(|i| left(i).norm_sqr()).sum::<f64>(), 2 * N, 2 * d.len());
    let gain = criterion(line, 4, 2 * d.len()) - own;
    let at = numerator(p) / Complex::new(0.0, -p.im);
    let pole = Pole { shift: p.re, width: p.im.abs(), peak: at.norm(), phase: Some(at.arg()), gain };
    (gain > 0.0 && p.im != 0.0).then_some((own, pole))
}

fn of_squares(d: &[f64], squares: &[f64]) -> Option<Pole> {
    let mean = squares.iter().sum::<f64>() / d.len() as f64;
    let y: Vec<f64> = squares.iter().map(|value| value / mean - 1.0).collect();
    let below = |d: f64, [by, own, ..]: &[f64; 5]| d * d + by * d + own;
    let solution = settled(d.len(), |i, before: Option<&[f64; 5]>| {
        let weight = before.map_or(1.0, |x| 1.0 / below(d[i], x).abs());
        ([-y[i] * d[i], -y[i], 1.0, d[i], d[i] * d[i]].map(|x| x * weight), y[i] * d[i] * d[i] * weight)
    })?;
    let [by, own, a, b, c] = solution;
    let shift = -0.5 * by;
    let width = (own - shift * shift).sqrt();
    let ratio = |d: f64| (a + b * d + c * d * d) / below(d, &solution);
    let line = straight(d, &y)?;
    let left = (0..d.len()).map(|i| (y[i] - ratio(d[i])).powi(2)).sum::<f64>();
    let gain = criterion(line, 2, d.len()) - criterion(left, 5, d.len());
    let amplitude = |y: f64| (mean * (1.0 + y).max(0.0)).sqrt();
    let peak = (amplitude(ratio(shift)) - amplitude(c)).abs();
    (gain > 0.0 && width > 0.0 && peak > 0.0).then_some(Pole { shift, width, peak, phase: None, gain })
}

/// Whether a resonance alone, which leaves so much of the squares of responses, tells more of them than a parabola,
/// which has as many numbers: what is far wider than the readings is none of theirs.
pub(super) fn is_no_parabola(responses: &[(f64, f64)], left: f64) -> bool {
    let row = |i: usize, _: Option<&[f64; 3]>| {
        let (d, value) = responses[i];
        ([1.0, d, d * d], value)
    };
    let Some([a, b, c]) = settled(responses.len(), row) else { return true };
    let parabola: f64 = responses.iter().map(|(d, value)| (value - a - b * d - c * d * d).powi(2)).sum();
    criterion(left, 3, responses.len()) + MARGIN < criterion(parabola, 3, responses.len())
}

/// Schwarz's criterion of what is left of so many readings whose noise nobody states.
fn criterion(square: f64, parameters: usize, readings: usize) -> f64 {
    readings as f64 * square.ln() + price(parameters, readings, 0.0)
}

/// Least squares of rows whose weights are by the solution before.
fn settled<T: ComplexField<RealField = f64>, const N: usize>(
    count: usize,
    row: impl Fn(usize, Option<&[T; N]>) -> ([T; N], T),
) -> Option<[T; N]> {
    if count < FEWEST * N {
        return None;
    }
    let mut solution: Option<[T; N]> = None;
    for _ in 0..ROUNDS {
        let rows: Vec<([T; N], T)> = (0..count).map(|i| row(i, solution.as_ref())).collect();
        let matrix = DMatrix::from_fn(count, N, |i, k| rows[i].0[k].clone());
        let right = DVector::from_fn(count, |i, _| rows[i].1.clone());
        let found = matrix.qr();
        let found = found.r().solve_upper_triangular(&(found.q().adjoint() * right))?;
        if found.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let found: [T; N] = std::array::from_fn(|k| found[k].clone());
        let same = |before: &[T; N]| {
            let change = before.iter().zip(&found).map(|(b, f)| (f.clone() - b.clone()).modulus_squared());
            change.sum::<f64>() <= SETTLED * found.iter().map(|f| f.clone().modulus_squared()).sum::<f64>()
        };
        let done = solution.as_ref().is_some_and(same);
        solution = Some(found);
        if done {
            break;
        }
    }
    solution
}

/// Squares that a straight line in d leaves.
fn straight<T: ComplexField<RealField = f64>>(d: &[f64], values: &[T]) -> Option<f64> {
    let real = |x: f64| T::from_real(x);
    let [slope, offset] = settled(d.len(), |i, _: Option<&[T; 2]>| ([real(d[i]), real(1.0)], values[i].clone()))?;
    let left = |i: usize| values[i].clone() - slope.clone() * real(d[i]) - offset.clone();
    Some((0..d.len()).map(|i| left(i).modulus_squared()).sum())
}

#[cfg(test)]
mod tests {
    use super::super::tests::point;
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Readings of a resonance at 50 Hz of quality 400 beside a floor, 41 about it.
    fn points(floor: Complex<f64>, with_phase: bool) -> Vec<Point> {
        let at = |row: usize| {
            let f = 50.0 * (1.0 + (row as f64 - 17.0) / 8.0 / 400.0);
            let ratio: f64 = f / 50.0;
            let mode = Complex::from(0.01) / Complex::new(1.0 - ratio * ratio, ratio / 400.0);
            let reading = (floor + mode) * 3.0;
            point(row, f, reading.norm(), with_phase.then(|| reading.arg()))
        };
        (0..41).map(at).collect()
    }

    #[test]
    fn a_peak_on_a_floor_and_a_notch_are_found_with_and_without_phases() {
        // From a floor of a quarter of the peak to one that is 25 times as high, which hides it.
        for size in [1.0, 4.2, 100.0] {
            for angle in [0.3, 1.5, -2.0] {
                for with_phase in [true, false] {
                    let points = points(Complex::from_polar(size, angle), with_phase);
                    let points: Vec<&Point> = points.iter().collect();
                    let found = on_floor(&points).expect("a resonance");
                    // High on its floor it is found as what it is, not as a resonance of nothing but itself.
                    let shown = super::super::resonance(&points, 0).expect("a resonance");
                    assert!(size < 100.0 || (shown.frequency / found.frequency - 1.0).abs() < 1e-9, "{shown:?}");
                    assert!((found.frequency / 50.0 - 1.0).abs() < 0.05 / 400.0, "{size} {angle} {found:?}");
                    assert!((found.quality / 400.0 - 1.0).abs() < 0.05, "{size} {angle} {found:?}");
                    let phase = found.phase.map_or(0.0, |phase| wrap(phase + FRAC_PI_2));
                    assert!(phase.abs() < 0.01, "{size} {angle} {found:?}");
                    assert!(!with_phase || (found.peak / 4.0 - 1.0).abs() < 0.05, "{size} {angle} {found:?}");
                }
            }
        }
    }

    /// From half a turn to ten thousand times the frequency, where what grows beside it is far larger.
    #[test]
    fn a_bump_far_below_what_grows_with_the_frequency_is_found() {
        for (quality, height) in [(4.0, 2.0), (9.0, 0.8)] {
            for with_phase in [true, false] {
                let at = |row: usize| {
                    let f = 10f64.powf(row as f64 / 100.0);
                    let coil = Complex::new(0.0, f / 57.0).powf(0.7) * 0.2 + 6.0;
                    let mode = Complex::from(height) / Complex::new(1.0, quality * (f / 57.0 - 57.0 / f));
                    let noise = 1.0 + 0.004 * ((row * 7919 % 101) as f64 / 101.0 - 0.5);
                    let reading = (coil + mode) * 3.0 * noise;
                    point(row, f, reading.norm(), with_phase.then(|| reading.arg()))
                };
                let points: Vec<Point> = (0..430).map(at).collect();
                let points: Vec<&Point> = points.iter().collect();
                let found = super::super::resonance(&points, 1).expect("a resonance");
                let close = 0.3 / quality;
                assert!((found.frequency / 57.0 - 1.0).abs() < close, "{quality} {with_phase} {found:?}");
                assert!((found.quality / quality).ln().abs() < 0.3, "{quality} {with_phase} {found:?}");
            }
        }
    }

    #[test]
    fn a_notch_behind_a_cable_that_turns_the_phase_many_times_is_found() {
        let mut points = points(Complex::from_polar(4.2, 0.3), true);
        points
            .iter_mut()
            .for_each(|p| p.phase = p.phase.map(|phase| wrap(phase - 300.0 * (p.frequency / 50.0 - 1.0) * 8.0)));
        let points: Vec<&Point> = points.iter().collect();
        let found = on_floor(&points).expect("a resonance");
        assert!((found.frequency / 50.0 - 1.0).abs() < 0.05 / 400.0, "{found:?}");
        assert!((found.quality / 400.0 - 1.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn a_straight_line_with_noise_has_no_resonance() {
        let noise = |row: usize| ((row * 7919 % 101) as f64 / 101.0 - 0.5) * 0.02;
        for with_phase in [true, false] {
            let mut points = points(Complex::new(1e9, 0.0), with_phase);
            points.iter_mut().for_each(|p| p.amplitude *= 1.0 + noise(p.row));
            let points: Vec<&Point> = points.iter().collect();
            assert!(on_floor(&points).is_none());
        }
    }
}
