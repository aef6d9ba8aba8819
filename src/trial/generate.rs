//! The readings of a planted cause, by plain time integration: never by the solver that fits.

use super::draw::Planted;
use super::outside;
use crate::model::Operation;
use crate::solver::integrated;
use crate::solver::time::Plan;
use rayon::prelude::*;

/// Steps and accuracy: errors near 1e-4, a hundredth of the smallest usual noise.
const PLAN: Plan = Plan { steps: 1200, cycles: 600, settled: 1e-6, window: 36 };

/// One reading without noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Amplitude \[rad\].
    pub amplitude: f64,
    /// Phase \[rad\].
    pub phase: f64,
    /// Whether the motion became periodic.
    pub steady: bool,
}

/// What the instrument would show without noise at every operating point, in their order.
pub fn readings(planted: &Planted, operations: &[Operation]) -> Vec<Reading> {
    let one = |(ordinal, at): (usize, &Operation)| {
        let found = match &planted.outside {
            None => integrated(&planted.model, at, &PLAN),
            Some((cause, p)) => {
                let departure = cause.departure(p, &planted.model, at.speed, ordinal);
                outside::reading(&planted.model, &departure, at, &PLAN)
            }
        };
        let finite = found.amplitude.is_finite() && found.phase.is_finite();
        Reading { amplitude: found.amplitude, phase: found.phase, steady: found.periodic && finite }
    };
    operations.par_iter().enumerate().map(one).collect()
}
