//! The model between the measured frequencies.

use super::Setting;
use crate::measurement::{Direction, Series};
use crate::model::Model;
use crate::scenario::Formulation;
use crate::sweep::{self, Condition, DEFAULT_EULER_STEPS};
use rayon::prelude::*;

/// Points of a curve.
const POINTS: usize = 121;

/// A curve of the model at one condition; NaN where it has no steady state.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelCurve {
    /// f \[Hz\].
    pub frequency: Vec<f64>,
    /// alpha \[rad\].
    pub amplitude: Vec<f64>,
    /// phi \[rad\].
    pub phase: Vec<f64>,
}

/// Curves over the given ranges of frequency, one per series, each swept as that was.
pub fn model_curves(model: &Model, settings: &[Setting], ranges: &[(f64, f64)], series: &[Series]) -> Vec<ModelCurve> {
    let work: Vec<_> = settings.iter().zip(ranges).zip(series).collect();
    work.par_iter().map(|((setting, range), series)| curve(model, setting, **range, series.direction)).collect()
}

fn curve(model: &Model, setting: &Setting, (from, to): (f64, f64), direction: Direction) -> ModelCurve {
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
    };
    // Between folds the state depends on where the sweep comes from.
    let downwards = direction == Direction::Down;
    let swept: Vec<f64> = if downwards { frequency.iter().rev().copied().collect() } else { frequency.clone() };
    let mut states = sweep::curve(model, &condition, &swept).states;
    if downwards {
        states.reverse();
    }
    let (amplitude, phase) = states.iter().map(|s| (s.amplitude, s.phase)).unzip();
    ModelCurve { frequency, amplitude, phase }
}
