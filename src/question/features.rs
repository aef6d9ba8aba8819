//! What the words describe, in numbers: lower, further right, the same at the ends, alike.

use crate::compare::{Peak, peak};
use crate::solver::Status;
use crate::sweep::Curve;
use schemars::JsonSchema;

/// A peak is clearly lower from this many tolerances on.
pub const CLEARLY: f64 = 2.0;
/// What counts as a peak that is not there, in units of what is asked of a peak.
const NO_PEAK: f64 = 10.0;

/// What a curve has of the one to be resembled.
#[derive(Debug, Clone, PartialEq, JsonSchema, serde::Serialize)]
pub struct Features {
    /// Its peak; `None` where it has none within the range, or has points that are not steady.
    pub peak: Option<Peak>,
    /// Height of the peak below that of full slip, relative to it.
    pub lower: f64,
    /// Shift of the peak from that of full slip \[Hz\], positive to the right.
    pub shift_hz: f64,
    /// Relative differences from full slip at the first and at the last frequency.
    pub ends: [f64; 2],
    /// Root mean square of the relative differences from the curve to be resembled.
    pub rms: f64,
    /// Number of points that are not steady.
    pub not_steady: usize,
    /// Clearly lower: by two tolerances or more.
    pub is_lower: bool,
    /// Further right: by one step of the frequencies or more.
    pub is_right: bool,
    /// The same as full slip at both ends, within the tolerance.
    pub same_at_ends: bool,
    /// Alike: root mean square within the tolerance.
    pub is_alike: bool,
}

impl Features {
    /// Whether it has all of them, at steady points only.
    pub fn all(&self) -> bool {
        self.not_steady == 0 && self.is_lower && self.is_right && self.same_at_ends && self.is_alike
    }
}

/// Judges curves over the same frequencies.
pub(super) struct Judge {
    frequency: Vec<f64>,
    full_slip: Vec<f64>,
    target: Vec<f64>,
    tolerance: f64,
    step: f64,
    /// The peak of full slip.
    pub slip_peak: Peak,
}

impl Judge {
    /// A judge; `None` where full slip has no peak within the range.
    pub fn new(frequency: &[f64], full_slip: &[f64], target: &[f64], tolerance: f64) -> Option<Self> {
        let slip_peak = peak(&frequency.iter().copied().zip(full_slip.iter().copied()).collect::<Vec<_>>())?;
        let step = (frequency[frequency.len() - 1] - frequency[0]) / (frequency.len() - 1) as f64;
        Some(Self {
            frequency: frequency.into(),
            full_slip: full_slip.into(),
            target: target.into(),
            tolerance,
            step,
            slip_peak,
        })
    }

    /// The same judge with another tolerance.
    pub fn within(&self, tolerance: f64) -> Self {
        let (frequency, full_slip, target) = (self.frequency.clone(), self.full_slip.clone(), self.target.clone());
        Self { frequency, full_slip, target, tolerance, ..*self }
    }

    /// The same judge for every so many-th frequency; what is asked stays.
    pub fn every(&self, stride: usize) -> Self {
        let part = |values: &[f64]| values.iter().copied().step_by(stride).collect();
        Self { frequency: part(&self.frequency), full_slip: part(&self.full_slip), target: part(&self.target), ..*self }
    }

    /// The largest difference of a curve that is alike.
    pub fn most(&self) -> f64 {
        self.tolerance
    }

    /// The difference of full slip from the curve to be resembled.
    pub fn rms_of_full_slip(&self) -> f64 {
        self.features(&self.full_slip, 0).rms
    }

    /// The frequencies.
    pub fn frequency(&self) -> &[f64] {
        &self.frequency
    }

    /// The features of a curve.
    pub fn judge(&self, curve: &Curve) -> Features {
        let amplitude: Vec<f64> = curve.states.iter().map(|state| state.amplitude).collect();
        self.features(&amplitude, curve.states.iter().filter(|state| state.status != Status::Steady).count())
    }

    /// The features of amplitudes, of which so many are not of steady states.
    pub fn features(&self, amplitude: &[f64], not_steady: usize) -> Features {
        let points: Vec<(f64, f64)> = self.frequency.iter().copied().zip(amplitude.iter().copied()).collect();
        let peak = if not_steady == 0 { peak(&points) } else { None };
        let last = amplitude.len() - 1;
        let ends = [0, last].map(|i| amplitude[i] / self.full_slip[i] - 1.0);
        let errors: Vec<f64> = amplitude.iter().zip(&self.target).map(|(a, t)| a / t - 1.0).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let lower = peak.map_or(f64::NAN, |p| 1.0 - p.amplitude / self.slip_peak.amplitude);
        let shift_hz = peak.map_or(f64::NAN, |p| p.frequency_hz - self.slip_peak.frequency_hz);
        Features {
            peak,
            lower,
            shift_hz,
            ends,
            rms,
            not_steady,
            is_lower: lower >= CLEARLY * self.tolerance,
            is_right: shift_hz >= self.step,
            same_at_ends: ends.iter().all(|end| end.abs() <= self.tolerance),
            is_alike: rms <= self.tolerance,
        }
    }

    /// By how much features fail, each in units of what is asked of it, with a little to spare; 0 where none does.
    pub fn shortfall(&self, f: &Features) -> f64 {
        const SPARE: f64 = 0.03;
        let clearly = CLEARLY * self.tolerance;
        let missing = |has: f64, asked: f64| {
            let short = 1.0 + SPARE - has / asked;
            if short.is_nan() { NO_PEAK } else { short.clamp(0.0, NO_PEAK) }
        };
        let excess = |has: f64, most: f64| {
            let over = has / most - 1.0 + SPARE;
            if over.is_nan() { NO_PEAK } else { over.clamp(0.0, NO_PEAK) }
        };
        missing(f.lower, clearly)
            + missing(f.shift_hz, self.step)
            + f.ends.iter().map(|end| excess(end.abs(), self.tolerance)).sum::<f64>()
            + excess(f.rms, self.tolerance)
    }
}
