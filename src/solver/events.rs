//! Where a mode ends within a step: the event function on the polynomial through its start and its stages.

use super::radau::{C, Stepper};

/// Largest deviation of the event function from its polynomial over a step, relative to its own size: with more, a crossing
/// could not be told from a wiggle of the polynomial.
pub const EVENT_ROUGHNESS: f64 = 0.03;

/// Event values below this count as crossed.
const CROSSED: f64 = -1e-11;
/// Fractions of a step at which the interpolated event function is looked at.
const LOOKS: [f64; 12] = [0.02, 0.05, 0.1, C[0], 0.25, 0.35, 0.45, 0.55, C[1], 0.75, 0.88, 1.0];

/// Whether the event function falls below zero during the step, between the stages included.
pub fn crosses(start: f64, e: [f64; 3]) -> bool {
    e.iter().any(|&e| e < CROSSED)
        || (e.iter().any(|&e| e < 0.1) && LOOKS.iter().any(|&tau| Stepper::interpolate(start, e, tau) < CROSSED))
}

/// Fraction of the step at which the event function first falls to zero.
pub fn first_root(start: f64, e: [f64; 3]) -> f64 {
    let value = |tau: f64| Stepper::interpolate(start, e, tau);
    let first = LOOKS.into_iter().find(|&tau| value(tau) < CROSSED).unwrap_or(1.0);
    let (mut low, mut high) = (0.0, first);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if value(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
