//! The observables of a point by plain time integration: the cross-check of the periodic solver, and the maker of test data.

use super::analytic::wrap;
use super::time::{Plan, integrate};
use crate::model::contact::Problem;
use crate::model::{Model, Operation};

/// What a time integration reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrated {
    /// alpha as the instrument shows it \[rad\].
    pub amplitude: f64,
    /// phi as the instrument shows it \[rad\].
    pub phase: f64,
    /// Mean angle \[rad\].
    pub mean: f64,
    /// Whether the motion became periodic; otherwise the numbers are averages over the window of the plan.
    pub periodic: bool,
}

/// Integrates the model at an operating point with load from rest, and reads the fundamental. Shares only the statement of
/// the laws with the periodic solver.
pub fn integrated(model: &Model, at: &Operation, plan: &Plan) -> Integrated {
    let problem = Problem::new(model, at);
    let lumps = &problem.lumps;
    let (free_re, free_im) = lumps.free_response();
    let (free_re, free_im) = (free_re.value, free_im.value);
    let (re, im, mean, periodic) = if at.load == 0.0 {
        (free_re, free_im, 0.0, true)
    } else {
        let found = integrate(&problem.sliders(), plan);
        (free_re + found.fundamental.0, free_im + found.fundamental.1, found.mean, found.periodic)
    };
    Integrated {
        amplitude: re.hypot(im) * lumps.amplitude_gain.value,
        phase: wrap(im.atan2(re) + lumps.phase_offset.value),
        mean,
        periodic,
    }
}
