//! Nodes and coefficients of the three-stage Radau IIA method, and the polynomials through its stages.

// Indices run over several tables at once here.
#![allow(clippy::needless_range_loop)]

use crate::model::system::MAX_STATES;

/// States of all systems are at most this many.
pub type State = [f64; MAX_STATES];

const SQRT6: f64 = 2.449_489_742_783_178;
/// Nodes.
pub const C: [f64; 3] = [(4.0 - SQRT6) / 10.0, (4.0 + SQRT6) / 10.0, 1.0];
/// Coefficients; the last row is also the weights.
pub const A: [[f64; 3]; 3] = [
    [(88.0 - 7.0 * SQRT6) / 360.0, (296.0 - 169.0 * SQRT6) / 1800.0, (-2.0 + 3.0 * SQRT6) / 225.0],
    [(296.0 + 169.0 * SQRT6) / 1800.0, (88.0 + 7.0 * SQRT6) / 360.0, (-2.0 - 3.0 * SQRT6) / 225.0],
    [(16.0 - SQRT6) / 36.0, (16.0 + SQRT6) / 36.0, 1.0 / 9.0],
];

/// Value at the fraction `tau` of the step of the polynomial through `start` and the three stage values.
pub fn interpolate(start: f64, stages: [f64; 3], tau: f64) -> f64 {
    let nodes = [0.0, C[0], C[1], C[2]];
    let values = [start, stages[0], stages[1], stages[2]];
    let mut sum = 0.0;
    for i in 0..4 {
        let mut weight = 1.0;
        for j in 0..4 {
            if j != i {
                weight *= (tau - nodes[j]) / (nodes[i] - nodes[j]);
            }
        }
        sum += weight * values[i];
    }
    sum
}

/// Distance of `start` from the parabola through the stage values: the measure by which the step size is chosen.
pub fn roughness(start: f64, stages: [f64; 3]) -> f64 {
    const L: [f64; 3] = [
        C[1] * C[2] / ((C[0] - C[1]) * (C[0] - C[2])),
        C[0] * C[2] / ((C[1] - C[0]) * (C[1] - C[2])),
        C[0] * C[1] / ((C[2] - C[0]) * (C[2] - C[1])),
    ];
    (start - L[0] * stages[0] - L[1] * stages[1] - L[2] * stages[2]).abs()
}

/// Weights of the values at the nodes in the parabola through them at `tau`.
pub fn parabola(tau: f64) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        (tau - C[j]) * (tau - C[k]) / ((C[i] - C[j]) * (C[i] - C[k]))
    })
}
