//! The model between the measured frequencies.

use super::Setting;
use crate::measurement::{Direction, Series};
use crate::model::Model;
use crate::scenario::DEFAULT_EULER_STEPS;
use crate::scenario::Formulation;
use crate::solver::cycle::Tolerance;
use crate::sweep::{self, Condition};
use rayon::prelude::*;

/// Points of a curve.
const POINTS: usize = 121;

/// A curve of the model at one condition; NaN where it has no steady state.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelCurve {
    /// f \[Hz\].
    pub frequency: Vec<f64>,
    /// Drive, in the unit of the table's.
    pub drive: Vec<f64>,
    /// Amplitude, in the unit of the reading.
    pub amplitude: Vec<f64>,
    /// phi \[rad\].
    pub phase: Vec<f64>,
}

/// Curves over the range of the measured frequencies, one per series, each swept and driven as that was. `driven` are
/// frequency and drive of the readings of every series, in the order of the frequency.
pub fn model_curves(
    model: &Model,
    settings: &[Setting],
    driven: &[Vec<(f64, f64)>],
    series: &[Series],
) -> Vec<ModelCurve> {
    let of = |number: usize| curve(model, (number, &settings[number]), &driven[number], series[number].direction);
    (0..settings.len().min(driven.len()).min(series.len())).into_par_iter().map(of).collect()
}

/// The drive at a frequency, from those of the readings about it.
fn drive_at(driven: &[(f64, f64)], frequency: f64) -> f64 {
    let after = driven.partition_point(|(f, _)| *f < frequency);
    match (after.checked_sub(1).map(|i| driven[i]), driven.get(after)) {
        (Some((f, u)), Some(&(g, v))) if u != v => u + (v - u) * (frequency - f) / (g - f),
        (Some((_, u)), _) | (None, Some(&(_, u))) => u,
        (None, None) => f64::NAN,
    }
}

fn curve(
    model: &Model,
    (series, setting): (usize, &Setting),
    driven: &[(f64, f64)],
    direction: Direction,
) -> ModelCurve {
    let frequencies = || driven.iter().map(|(f, _)| *f);
    let (from, to) = (frequencies().fold(f64::INFINITY, f64::min), frequencies().fold(0.0, f64::max));
    let points = if to > from { POINTS } else { 1 };
    let share = |i: usize| if points == 1 { 0.0 } else { i as f64 / (points - 1) as f64 };
    let frequency: Vec<f64> = (0..points).map(|i| from + (to - from) * share(i)).collect();
    let condition = Condition {
        formulation: Formulation::Series,
        euler_steps: DEFAULT_EULER_STEPS,
        drive: setting.drive,
        load: setting.load,
        friction: model.contact.friction,
        speed: setting.speed,
        series,
    };
    // Between folds the state depends on where the sweep comes from.
    let downwards = direction == Direction::Down;
    let drive: Vec<f64> = frequency.iter().map(|f| drive_at(driven, *f)).collect();
    let mut swept: Vec<(f64, f64)> = frequency.iter().copied().zip(drive.iter().copied()).collect();
    if downwards {
        swept.reverse();
    }
    let mut states = sweep::driven_curve(model, &condition, &swept, &Tolerance::default()).states;
    if downwards {
        states.reverse();
    }
    let (amplitude, phase) = states.iter().map(|s| (s.amplitude, s.phase)).unzip();
    ModelCurve { frequency, drive, amplitude, phase }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drive_between_readings_is_between_theirs_and_a_constant_one_stays() {
        let driven = [(10.0, 2.0), (11.0, 4.0), (13.0, 4.0)];
        let at = [9.0, 10.0, 10.25, 11.0, 12.1, 13.0, 14.0].map(|f| drive_at(&driven, f));
        assert_eq!(at, [2.0, 2.0, 2.5, 4.0, 4.0, 4.0, 4.0]);
    }
}
