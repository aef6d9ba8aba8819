//! Where the model fails: contiguous ranges of frequency of one condition, the largest share of the misfit first.

use super::{Compared, ConditionMetrics, Setting};
use crate::scenario::{Signal, Signals};
use crate::statistics::SIGNIFICANCE;
use crate::units::{self, Frequencies};
use schemars::JsonSchema;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A residual's square above which a reading counts as misfit.
const EXCESS: f64 = 3.0;

/// A range of one condition at which the model fails.
#[derive(Debug, Clone, PartialEq, JsonSchema, serde::Serialize)]
pub struct Region {
    /// The condition.
    #[serde(flatten)]
    #[schemars(with = "super::setting::SettingKeys")]
    pub setting: Setting,
    /// Index of the condition.
    pub condition: usize,
    /// First frequency \[Hz\].
    pub frequency_from_hz: f64,
    /// Last frequency \[Hz\].
    pub frequency_to_hz: f64,
    /// Points.
    pub points: usize,
    /// Mean residual of the amplitude, model minus measurement, in standard deviations.
    pub mean_residual_sigma: f64,
    /// Mean relative error of the amplitude, model over measurement \[%\], where the model has an answer.
    pub mean_residual_percent: f64,
    /// Mean error of the phase \[deg\], where measured.
    pub mean_phase_deg: Option<f64>,
    /// Share of chi2 over all points, 0..1.
    pub share_of_chi2: f64,
    /// The same in plain words.
    pub sentence: String,
}

/// Regions of all conditions, the largest share of chi2 first. Within noise there are none, up to a small chance.
/// `noise` is that of the readings over the stated one.
pub fn regions(points: &[Compared], conditions: &[ConditionMetrics], noise: f64) -> Vec<Region> {
    let total: f64 = points.iter().map(misfit).sum();
    let looked_at: f64 =
        (0..conditions.len()).map(|c| points.iter().filter(|p| p.condition == c).count().pow(2) as f64).sum();
    let mut found = Vec::new();
    for (index, condition) in conditions.iter().enumerate() {
        let curve: Vec<&Compared> = points.iter().filter(|p| p.condition == index).collect();
        let digits = Frequencies::of(curve.iter().map(|p| p.point.frequency));
        for (from, to) in ranges(&curve, noise * noise, SIGNIFICANCE / looked_at.max(1.0)) {
            found.push(region((index, condition), &curve[from..=to], total, &digits));
        }
    }
    found.sort_by(|a, b| b.share_of_chi2.total_cmp(&a.share_of_chi2));
    found
}

fn misfit(point: &Compared) -> f64 {
    point.amplitude_residual.powi(2) + point.phase_residual.map_or(0.0, |r| r * r)
}

fn readings(point: &Compared) -> f64 {
    1.0 + f64::from(u8::from(point.phase_residual.is_some()))
}

/// Ranges (first and last index) whose misfit is no chance, from left to right: those of largest total excess. A single
/// point is no range but an outlier.
fn ranges(curve: &[&Compared], variance: f64, significance: f64) -> Vec<(usize, usize)> {
    let excess: Vec<f64> = curve.iter().map(|p| misfit(p) / variance - EXCESS * readings(p)).collect();
    let (mut best, mut sum, mut start) = ((0.0, 0, 0), 0.0, 0);
    for (i, e) in excess.iter().enumerate() {
        if sum <= 0.0 {
            (sum, start) = (0.0, i);
        }
        sum += e;
        if sum > best.0 {
            best = (sum, start, i);
        }
    }
    let (gain, from, to) = best;
    if gain <= 0.0 {
        return Vec::new();
    }
    let part = &curve[from..=to];
    let (chi2, freedom): (f64, f64) =
        part.iter().fold((0.0, 0.0), |(c, n), p| (c + misfit(p) / variance, n + readings(p)));
    let chance = ChiSquared::new(freedom).map_or(1.0, |distribution| distribution.sf(chi2));
    let mut found = ranges(&curve[..from], variance, significance);
    if to > from && chance < significance {
        found.push((from, to));
    }
    found.extend(ranges(&curve[to + 1..], variance, significance).into_iter().map(|(a, b)| (a + to + 1, b + to + 1)));
    found
}

fn region(
    (index, condition): (usize, &ConditionMetrics),
    part: &[&Compared],
    total: f64,
    digits: &Frequencies,
) -> Region {
    let over = |some: &[&Compared], value: &dyn Fn(&Compared) -> f64| {
        some.iter().map(|p| value(p)).sum::<f64>() / some.len() as f64
    };
    let answered = answered(part);
    let mean = |value: &dyn Fn(&Compared) -> f64| over(&answered, value);
    let phase = part.iter().all(|p| p.phase_residual.is_some());
    let mut region = Region {
        setting: condition.setting,
        condition: index,
        frequency_from_hz: part[0].point.frequency,
        frequency_to_hz: part[part.len() - 1].point.frequency,
        points: part.len(),
        mean_residual_sigma: over(part, &|p| p.amplitude_residual),
        mean_residual_percent: mean(&|p| p.error_percent()),
        mean_phase_deg: (phase && !answered.is_empty()).then(|| mean(&|p| p.phase_error().unwrap_or(0.0).to_degrees())),
        share_of_chi2: part.iter().map(|p| misfit(p)).sum::<f64>() / total,
        sentence: String::new(),
    };
    region.sentence = sentence(&region, condition, part, digits);
    region
}

/// The points at which the model has an answer.
fn answered<'a>(part: &[&'a Compared]) -> Vec<&'a Compared> {
    part.iter().copied().filter(|p| p.error_percent().is_finite()).collect()
}

/// The region in plain words.
fn sentence(region: &Region, condition: &ConditionMetrics, part: &[&Compared], digits: &Frequencies) -> String {
    let amplitudes: f64 = part.iter().map(|p| p.amplitude_residual.powi(2)).sum();
    let phases: f64 = part.iter().filter_map(|p| p.phase_residual).map(|r| r * r).sum();
    let mut said = Vec::new();
    let answered = answered(part);
    let silent = part.len() - answered.len();
    if amplitudes >= 0.3 * phases && !answered.is_empty() {
        said.push(amplitude_words(region, &answered, digits));
    }
    if silent > 0 {
        said.push(format!("has no steady state at {silent} of its {} points", part.len()));
    }
    let inside = |f: f64| f >= region.frequency_from_hz && f <= region.frequency_to_hz;
    if let (Some(model), Some(measured)) = (condition.model_peak, condition.measured_peak) {
        let shift = model.frequency_hz - measured.frequency_hz;
        if shift.abs() > (SHIFTED * condition.measured_width).max(3.0 * condition.measured_peak_sd)
            && (inside(model.frequency_hz) || inside(measured.frequency_hz))
        {
            let side = if shift > 0.0 { "high" } else { "low" };
            said.push(format!("resonates {} too {side}", digits.difference(shift.abs())));
        }
    }
    if let Some(phase) = region.mean_phase_deg.filter(|_| phases > amplitudes) {
        said.push(phase_words(phase, &answered, digits));
    }
    format!(
        "{}: {}-{}, the model {}; {} of the misfit",
        words(&region.setting),
        digits.number(region.frequency_from_hz),
        digits.show(region.frequency_to_hz),
        said.join(" and "),
        if region.share_of_chi2 < 0.01 {
            "less than 1 %".into()
        } else {
            format!("{:.0} %", 100.0 * region.share_of_chi2)
        }
    )
}

/// Shift of a resonance, in its width, up to which nothing is said of it.
pub(super) const SHIFTED: f64 = 0.03;

/// A phase that runs through the measured one is on neither side of it.
fn phase_words(mean: f64, part: &[&Compared], digits: &Frequencies) -> String {
    let side = |phase: f64| if phase > 0.0 { "ahead" } else { "behind" };
    let errors = || part.iter().filter_map(|p| Some((p.phase_error()?.to_degrees(), p.point.frequency)));
    let (sum, count) = errors().fold((0.0, 0), |(sum, n), (error, _)| (sum + error * error, n + 1));
    let by = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0);
    let through = errors().min_by(by).zip(errors().max_by(by)).filter(|(least, most)| least.0 < 0.0 && most.0 > 0.0);
    let aside = mean.abs() >= 0.5 * (sum / f64::from(count.max(1))).sqrt();
    let Some((least, most)) = through.filter(|_| !aside) else {
        return format!("is {:.1}° {} in phase on average", mean.abs(), side(mean));
    };
    let at = |(error, f): (f64, f64)| format!("{:.1}° {} at {}", error.abs(), side(error), digits.show(f));
    format!("is {} and {} in phase", at(least), at(most))
}

/// A model that errs to both sides is said to be on one of them where the errors to the other are below this share.
const OTHER_SIDE: f64 = 0.2;

fn amplitude_words(region: &Region, part: &[&Compared], digits: &Frequencies) -> String {
    let side = |percent: f64| if percent > 0.0 { "high" } else { "low" };
    let mean = region.mean_residual_percent;
    let square = part.iter().map(|p| p.error_percent().powi(2)).sum::<f64>() / part.len() as f64;
    let reach = |sign: f64| part.iter().map(|p| sign * p.error_percent()).fold(0.0, f64::max);
    let one_sided = reach(-mean.signum()) < OTHER_SIDE * reach(mean.signum());
    if one_sided && mean.abs() >= 0.5 * square.sqrt() {
        return format!("is {} % too {} on average", rounded(mean.abs()), side(mean));
    }
    let by = |a: &&&Compared, b: &&&Compared| a.error_percent().total_cmp(&b.error_percent());
    let (Some(low), Some(high)) = (part.iter().min_by(by), part.iter().max_by(by)) else { return String::new() };
    let at = |p: &Compared| {
        format!(
            "{} % too {} at {}",
            rounded(p.error_percent().abs()),
            side(p.error_percent()),
            digits.show(p.point.frequency)
        )
    };
    format!("is {} and {}", at(low), at(high))
}

fn rounded(percent: f64) -> String {
    if percent < 10.0 { format!("{percent:.1}") } else { format!("{percent:.0}") }
}

/// A condition in words, e.g. `V = 20 mm/s, W = 20 N, u₀ = 2.5 µm`, or `series 2, F₀ = 0.3 N`.
pub fn words(setting: &Setting) -> String {
    let mut parts = Vec::new();
    match (setting.number, setting.name.as_str()) {
        (0, _) => {}
        (number, "") => parts.push(format!("series {number}")),
        (_, name) => parts.push(format!("series {name}")),
    }
    if setting.contact {
        let speed = if setting.speed == 0.0 { "0 mm/s".into() } else { units::format(setting.speed, "m/s") };
        parts.push(format!("V = {speed}, W = {} N", setting.load));
    }
    parts.push(format!("{} = {}", setting.signal.symbol, drive(setting.drive, &setting.signal)));
    parts.join(", ")
}

/// A drive with its unit. Those of the paper's actuator are as somebody set them; others are often measured.
pub(super) fn drive(value: f64, signal: &Signal) -> String {
    let rounded = || format!("{value:.3e}").parse().unwrap_or(value);
    units::format(if *signal == Signals::ARM.drive { value } else { rounded() }, signal.unit)
}

#[cfg(test)]
mod tests {
    use super::super::{Metrics, rms_error_beside};
    use super::*;
    use crate::fit::Prediction;
    use crate::measurement::Point;
    use crate::solver::Status;

    /// The model 30 % and ten standard deviations too high everywhere, where it has an answer.
    fn point(row: usize, answers: bool) -> Compared {
        let (speed, load, drive) = (0.02, 20.0, 2.5e-6);
        let point = Point {
            row,
            line: row + 1,
            speed,
            load,
            drive,
            frequency: 60.0 + row as f64,
            amplitude: 1e-6,
            phase: None,
            amplitude_sd: 3e-8,
            phase_sd: None,
            mean: None,
            replicates: 1,
            series: 0,
        };
        let status = if answers { Status::Steady } else { Status::Failed("none".into()) };
        let model = Prediction {
            amplitude: if answers { 1.3e-6 } else { f64::NAN },
            phase: 0.0,
            status,
            others: Vec::new(),
            beyond: false,
        };
        Compared {
            point,
            condition: 0,
            model,
            amplitude_residual: if answers { 10.0 } else { 4.0 },
            phase_residual: None,
        }
    }

    fn told(answers: [bool; 4]) -> Region {
        let points: Vec<Compared> = answers.into_iter().enumerate().map(|(row, answers)| point(row, answers)).collect();
        let setting = Setting::of_arm(0.02, 20.0, 2.5e-6);
        let metrics = Metrics::over(points.iter());
        let condition = ConditionMetrics {
            setting,
            metrics,
            model_peak: None,
            measured_peak: None,
            measured_peak_sd: 0.0,
            measured_width: 0.0,
        };
        regions(&points, &[condition], 1.0).remove(0)
    }

    #[test]
    fn an_error_does_not_fall_by_what_is_not_predicted() {
        let base: Vec<Compared> = (0..4).map(|row| point(row, true)).collect();
        let mut own: Vec<Compared> = (0..4).map(|row| point(row, row > 0)).collect();
        own[1..].iter_mut().for_each(|p| p.model.amplitude = p.point.amplitude);
        let error = rms_error_beside(own.iter(), base.iter());
        assert!((error - 15.0).abs() < 1e-9, "{error}");
        assert!(Metrics::over(own.iter()).rms_error_percent < 1e-9);
    }

    #[test]
    fn points_without_an_answer_are_counted_and_not_averaged() {
        let region = told([true, true, false, true]);
        assert!(
            region.sentence.contains("is 30 % too high on average and has no steady state at 1 of its 4 points"),
            "{}",
            region.sentence
        );
        assert!((region.mean_residual_percent - 30.0).abs() < 1e-9);
        let region = told([false; 4]);
        assert!(region.sentence.contains("the model has no steady state at 4 of its 4 points;"), "{}", region.sentence);
        let region = told([true; 4]);
        assert!(region.sentence.contains("the model is 30 % too high on average;"), "{}", region.sentence);
    }
}
