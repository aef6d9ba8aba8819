//! The readings of a planted cause, by plain time integration: never by the solver that fits.

use super::draw::Planted;
use super::outside;
use crate::model::Operation;
use crate::solver::integrated;
use crate::solver::time::Plan;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Steps and accuracy: errors near 1e-4, a hundredth of the smallest usual noise.
const PLAN: Plan = Plan { steps: 1200, cycles: 400, settled: 1e-6, window: 36, solved: 1e-7 };

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

/// What the instrument would show without noise at every operating point, in their order. Once one is found without a
/// steady state the rest is left out and counts as such: the whole is of no use then.
pub fn readings(planted: &Planted, operations: &[Operation]) -> Vec<Reading> {
    let stop = AtomicBool::new(false);
    let one = |(ordinal, at): (usize, &Operation)| {
        if stop.load(Ordering::Relaxed) {
            return Reading { amplitude: f64::NAN, phase: f64::NAN, steady: false };
        }
        let found = match &planted.outside {
            None => integrated(&planted.model, at, &PLAN),
            Some((cause, p)) => {
                let departure = cause.departure(p, &planted.model, at.speed, ordinal);
                outside::reading(&planted.model, &departure, at, &PLAN)
            }
        };
        let finite = found.amplitude.is_finite() && found.phase.is_finite();
        let steady = found.periodic && finite;
        if !steady {
            stop.store(true, Ordering::Relaxed);
        }
        Reading { amplitude: found.amplitude, phase: found.phase, steady }
    };
    operations.par_iter().enumerate().map(one).collect()
}
