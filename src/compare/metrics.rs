//! How wrong a model is, in figures: over all points and per condition.

use super::{Compared, Setting};
use crate::linear::least_squares;
use crate::measurement::Point;
use crate::statistics::median;
use schemars::JsonSchema;

/// Points through which the parabola of a peak is laid.
const PEAK_POINTS: usize = 5;

/// Figures over a set of points.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Metrics {
    /// Points.
    pub points: usize,
    /// Readings: amplitudes and phases.
    pub readings: usize,
    /// Mean square of the residuals in standard deviations, over all readings: 1 where the model is right.
    pub chi2_per_point: f64,
    /// Root mean square of the relative error in amplitude \[%\].
    pub rms_error_percent: f64,
    /// Root mean square of the error in phase \[deg\], where measured.
    pub rms_phase_deg: Option<f64>,
    /// Root mean square of the standard deviation of the amplitude \[%\].
    pub noise_percent: f64,
    /// Root mean square of the standard deviation of the phase \[deg\], where measured.
    pub noise_phase_deg: Option<f64>,
}

/// A resonance peak.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, serde::Serialize)]
pub struct Peak {
    /// Where \[Hz\].
    pub frequency_hz: f64,
    /// How high, in the unit of the reading; that of the paper's rig in what is written of its questions.
    #[serde(rename = "amplitude_rad")]
    pub amplitude: f64,
}

/// Figures of one load, speed and drive.
#[derive(Debug, Clone, PartialEq)]
pub struct ConditionMetrics {
    /// The condition.
    pub setting: Setting,
    /// Figures over its points.
    pub metrics: Metrics,
    /// Peak of the model at the measured frequencies; none where the largest amplitude lies at an end.
    pub model_peak: Option<Peak>,
    /// Measured peak.
    pub measured_peak: Option<Peak>,
    /// Standard deviation of its frequency \[Hz\]; zero without a peak.
    pub measured_peak_sd: f64,
    /// Width of the measured resonance at 1/√2 of its height \[Hz\]; that of the curve where it is no narrower.
    pub measured_width: f64,
}

impl Metrics {
    /// Figures over some points.
    pub fn over<'a>(points: impl Iterator<Item = &'a Compared> + Clone) -> Self {
        let count = points.clone().count();
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut n) = (0.0, 0);
            for value in values {
                sum += value;
                n += 1;
            }
            (n > 0).then(|| sum / f64::from(n))
        };
        let residuals = || points.clone().flat_map(|p| [Some(p.amplitude_residual), p.phase_residual]).flatten();
        let relative = |p: &Compared| (0.01 * p.error_percent()).powi(2);
        let phase = |p: &Compared| p.phase_error().map(|e| e.to_degrees().powi(2));
        let noise = |p: &Point| (p.amplitude_sd / p.amplitude).powi(2);
        let root = |x: Option<f64>| x.map(f64::sqrt);
        Self {
            points: count,
            readings: residuals().count(),
            chi2_per_point: mean(&mut residuals().map(|r| r * r)).unwrap_or(f64::NAN),
            rms_error_percent: 100.0
                * root(mean(&mut points.clone().map(relative).filter(|e| e.is_finite()))).unwrap_or(f64::NAN),
            rms_phase_deg: root(mean(&mut points.clone().filter_map(phase).filter(|e| e.is_finite()))),
            noise_percent: 100.0 * root(mean(&mut points.clone().map(|p| noise(&p.point)))).unwrap_or(f64::NAN),
            noise_phase_deg: root(mean(
                &mut points.clone().filter_map(|p| p.point.phase_sd.map(|sd| sd.to_degrees().powi(2))),
            )),
        }
    }
}

/// Root mean square of the relative error in amplitude \[%\], the model at no point better than `base` where it has no
/// steady state: an error does not fall by what is not predicted. Both are of the same points.
pub fn rms_error_beside<'a>(
    points: impl Iterator<Item = &'a Compared>,
    base: impl Iterator<Item = &'a Compared>,
) -> f64 {
    let of =
        |(own, base): (&Compared, &Compared)| if own.model.status.is_steady() { own } else { base }.error_percent();
    let (sum, count) = points
        .zip(base)
        .map(of)
        .filter(|error| error.is_finite())
        .fold((0.0, 0), |(sum, count), error| (sum + error * error, count + 1));
    (sum / f64::from(count)).sqrt()
}

impl ConditionMetrics {
    /// Figures of a condition; `points` in the order of the frequency.
    pub(super) fn over(setting: Setting, points: &[&Compared]) -> Self {
        // At the drive of the series, from which that of a reading may differ.
        let scale = |p: &Compared| if p.point.drive == setting.drive { 1.0 } else { setting.drive / p.point.drive };
        let model: Vec<_> = points.iter().map(|p| (p.point.frequency, p.model.amplitude * scale(p))).collect();
        let measured: Vec<_> = points.iter().map(|p| (p.point.frequency, p.point.amplitude * scale(p))).collect();
        let noise = median(points.iter().map(|p| p.point.amplitude_sd / p.point.amplitude));
        let (measured_peak, sd) = vertex(&measured).unzip();
        Self {
            setting,
            metrics: Metrics::over(points.iter().copied()),
            model_peak: peak(&model),
            measured_peak,
            measured_peak_sd: sd.unwrap_or(0.0) * noise,
            measured_width: width(&measured),
        }
    }
}

/// Width of a curve at 1/√2 of its largest amplitude; where it falls so low on one side only, twice the half of it
/// there.
fn width(curve: &[(f64, f64)]) -> f64 {
    let Some(top) = (0..curve.len()).max_by(|&i, &j| curve[i].1.total_cmp(&curve[j].1)) else { return 0.0 };
    let (at, level) = (curve[top].0, curve[top].1 * std::f64::consts::FRAC_1_SQRT_2);
    let crossing = |low: (f64, f64), high: (f64, f64)| low.0 + (level - low.1) / (high.1 - low.1) * (high.0 - low.0);
    let falls = |pair: (usize, usize)| (curve[pair.0].1 < level).then(|| crossing(curve[pair.0], curve[pair.1]));
    let below = (0..top).rev().find_map(|i| falls((i, i + 1))).map(|f| at - f);
    let above = (top + 1..curve.len()).find_map(|i| falls((i, i - 1))).map(|f| f - at);
    match (below, above) {
        (Some(a), Some(b)) => a + b,
        (Some(half), None) | (None, Some(half)) => 2.0 * half,
        (None, None) => curve[curve.len() - 1].0 - curve[0].0,
    }
}

/// The largest amplitude of a curve by a parabola through the logarithms of the points around it (least squares).
pub fn peak(curve: &[(f64, f64)]) -> Option<Peak> {
    vertex(curve).map(|(peak, _)| peak)
}

/// The same and the standard deviation of its frequency \[Hz\] over that of the amplitudes relative to them, to first
/// order.
fn vertex(curve: &[(f64, f64)]) -> Option<(Peak, f64)> {
    let top = (0..curve.len()).max_by(|&i, &j| curve[i].1.total_cmp(&curve[j].1))?;
    if top == 0 || top + 1 == curve.len() {
        return None;
    }
    let half = PEAK_POINTS / 2;
    let part = &curve[top.saturating_sub(half)..(top + half + 1).min(curve.len())];
    let rows = nalgebra::DMatrix::from_fn(part.len(), 3, |i, j| (part[i].0 - curve[top].0).powi(j as i32));
    let logs = nalgebra::DVector::from_iterator(part.len(), part.iter().map(|p| p.1.ln()));
    let inverse = (rows.transpose() * &rows).try_inverse();
    let fit = least_squares(rows, &logs, 1e-12)?;
    if fit[2] >= 0.0 {
        return None;
    }
    let shift = (-0.5 * fit[1] / fit[2]).clamp(part[0].0 - curve[top].0, part[part.len() - 1].0 - curve[top].0);
    let height = fit[0] + fit[1] * shift + fit[2] * shift * shift;
    // Of -b/(2c), with b and c from the same readings.
    let slope = nalgebra::Vector3::new(0.0, -0.5 / fit[2], 0.5 * fit[1] / (fit[2] * fit[2]));
    let variance = inverse.map_or(f64::INFINITY, |inverse| (slope.transpose() * inverse * slope)[0]);
    Some((Peak { frequency_hz: curve[top].0 + shift, amplitude: height.exp() }, variance.max(0.0).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_is_that_at_half_the_power() {
        let resonance = |q: f64| move |f: f64| 1.0 / ((1.0 - f * f).powi(2) + (f / q).powi(2)).sqrt();
        let curve = |from: f64, to: f64, of: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
            (0..=400).map(|i| from + (to - from) * f64::from(i) / 400.0).map(|f| (f, of(f))).collect()
        };
        let of = resonance(50.0);
        for (from, to) in [(0.9, 1.1), (0.9, 1.005), (0.995, 1.1)] {
            assert!((width(&curve(from, to, &of)) - 0.02).abs() < 4e-4, "{from} to {to}");
        }
        assert!((width(&curve(0.997, 1.003, &of)) - 0.006).abs() < 1e-9);
        assert_eq!(width(&[]), 0.0);
    }
}
