//! The model between the measured frequencies.

use super::Setting;
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

/// Curves over the given ranges of frequency, one per condition.
pub fn model_curves(model: &Model, settings: &[Setting], ranges: &[(f64, f64)]) -> Vec<ModelCurve> {
    let work: Vec<_> = settings.iter().zip(ranges).collect();
    work.par_iter().map(|(setting, range)| curve(model, setting, **range)).collect()
}

fn curve(model: &Model, setting: &Setting, (from, to): (f64, f64)) -> ModelCurve {
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
    let states = sweep::curve(model, &condition, &frequency).states;
    let (amplitude, phase) = states.iter().map(|s| (s.amplitude, s.phase)).unzip();
    ModelCurve { frequency, amplitude, phase }
}
