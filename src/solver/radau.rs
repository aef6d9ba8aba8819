//! One step of the three-stage Radau IIA collocation method (order 5; Hairer and Wanner, Solving ODEs II, IV.5) for a
//! system with one algebraic unknown, and its tangent.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::lu::{Lu, MAX_ORDER};
use crate::model::system::{Evaluation, Forcing, HybridSystem, MAX_COLUMNS, MAX_STATES, Mode, ParameterColumns};

const SQRT6: f64 = 2.449_489_742_783_178;
/// Nodes.
pub const C: [f64; 3] = [(4.0 - SQRT6) / 10.0, (4.0 + SQRT6) / 10.0, 1.0];
/// Coefficients; the last row is also the weights.
pub const A: [[f64; 3]; 3] = [
    [(88.0 - 7.0 * SQRT6) / 360.0, (296.0 - 169.0 * SQRT6) / 1800.0, (-2.0 + 3.0 * SQRT6) / 225.0],
    [(296.0 + 169.0 * SQRT6) / 1800.0, (88.0 + 7.0 * SQRT6) / 360.0, (-2.0 - 3.0 * SQRT6) / 225.0],
    [(16.0 - SQRT6) / 36.0, (16.0 + SQRT6) / 36.0, 1.0 / 9.0],
];

/// States of all systems are at most this many.
pub type State = [f64; MAX_STATES];

/// Stage values and the factorised Jacobian of the last step taken.
#[derive(Default)]
pub struct Stepper {
    lu: Lu,
    evaluations: [Evaluation; 3],
    /// Forcing at the stages.
    pub forcing: [Forcing; 3],
    /// States at the stages.
    pub z: [State; 3],
    /// Algebraic unknown at the stages.
    pub s: [f64; 3],
    /// Newton iterations of all steps.
    pub iterations: usize,
}

impl Stepper {
    /// Takes a step of size `h` from (t, z, s); the stages hold the result (the last one is the end). False where Newton
    /// does not converge.
    pub fn step(&mut self, system: &dyn HybridSystem, t: f64, z: &State, s: f64, h: f64, mode: Mode) -> bool {
        let n = system.states();
        let (scales, slip_scale) = (system.scales(), system.slip_scale());
        self.forcing = C.map(|c| system.forcing(t + c * h));
        self.z = [*z; 3];
        self.s = [s; 3];
        let mut previous = f64::INFINITY;
        let mut fresh = false;
        for _ in 0..25 {
            self.iterations += 1;
            for i in 0..3 {
                system.evaluate(&self.forcing[i], &self.z[i], self.s[i], mode, &mut self.evaluations[i]);
            }
            if !fresh {
                if !self.factorise(n, h, &scales, slip_scale) {
                    return false;
                }
                fresh = true;
            }
            let mut delta = [0.0; MAX_ORDER];
            for i in 0..3 {
                for j in 0..n {
                    let sum: f64 = (0..3).map(|k| A[i][k] * self.evaluations[k].f[j]).sum();
                    delta[i * (n + 1) + j] = (z[j] - self.z[i][j] + h * sum) / scales[j];
                }
                delta[i * (n + 1) + n] = -self.evaluations[i].g;
            }
            self.lu.solve(&mut delta);
            let mut size = 0.0f64;
            for i in 0..3 {
                for j in 0..n {
                    let d = delta[i * (n + 1) + j];
                    self.z[i][j] += d * scales[j];
                    size = size.max(d.abs());
                }
                let d = delta[i * (n + 1) + n];
                self.s[i] += d * slip_scale;
                size = size.max(d.abs());
            }
            if !size.is_finite() {
                return false;
            }
            // Converged, or as close as rounding lets it come.
            if size < 1e-10 || (size < 1e-6 && fresh && size > 0.5 * previous) {
                return true;
            }
            if size > 0.02 * previous {
                fresh = false;
            }
            previous = size;
        }
        false
    }

    fn factorise(&mut self, n: usize, h: f64, scales: &State, slip_scale: f64) -> bool {
        let evaluations = &self.evaluations;
        let m = self.lu.matrix(3 * (n + 1));
        for i in 0..3 {
            for j in 0..n {
                let row = &mut m[i * (n + 1) + j];
                for (k, e) in evaluations.iter().enumerate() {
                    let factor = -h * A[i][k] / scales[j];
                    let block = &mut row[k * (n + 1)..(k + 1) * (n + 1)];
                    for l in 0..n {
                        block[l] = factor * e.fz[j][l] * scales[l];
                    }
                    block[n] = factor * e.fs[j] * slip_scale;
                }
                row[i * (n + 1) + j] += 1.0;
            }
            let row = &mut m[i * (n + 1) + n];
            row[..3 * (n + 1)].fill(0.0);
            for l in 0..n {
                row[i * (n + 1) + l] = evaluations[i].gz[l] * scales[l];
            }
            row[i * (n + 1) + n] = evaluations[i].gs * slip_scale;
        }
        self.lu.factorise()
    }

    /// Evaluates and factorises the Jacobian at the converged stages, for exact tangents.
    pub fn refactorise(&mut self, system: &dyn HybridSystem, h: f64, mode: Mode) -> bool {
        for i in 0..3 {
            system.evaluate(&self.forcing[i], &self.z[i], self.s[i], mode, &mut self.evaluations[i]);
        }
        self.factorise(system.states(), h, &system.scales(), system.slip_scale())
    }

    /// Derivative of the stage states by the state at the start: `out[stage][row][column]`, for the columns `0..n`.
    pub fn tangent(&self, system: &dyn HybridSystem, out: &mut [[State; MAX_STATES]; 3]) {
        let n = system.states();
        let scales = system.scales();
        let mut rhs = [[0.0; MAX_STATES]; MAX_ORDER];
        for i in 0..3 {
            for column in 0..n {
                rhs[i * (n + 1) + column][column] = 1.0;
            }
        }
        self.lu.solve_block(&mut rhs);
        for i in 0..3 {
            for row in 0..n {
                for column in 0..n {
                    out[i][row][column] = rhs[i * (n + 1) + row][column] * scales[row] / scales[column];
                }
            }
        }
    }

    /// Adds the step's own part of the derivative of the stage states by the parameter columns: `out[stage][column]`
    /// is overwritten with the response to the parameters alone (start state held fixed).
    pub fn parameter_tangent(
        &self,
        system: &dyn HybridSystem,
        h: f64,
        mode: Mode,
        columns: &mut [ParameterColumns; 3],
        out: &mut [Vec<State>; 3],
    ) {
        let n = system.states();
        let scales = system.scales();
        for i in 0..3 {
            system.parameter_columns(&self.forcing[i], &self.z[i], self.s[i], mode, &mut columns[i]);
        }
        let mut rhs = [[0.0; MAX_COLUMNS]; MAX_ORDER];
        for column in 0..system.columns() {
            for i in 0..3 {
                for j in 0..n {
                    let sum: f64 = (0..3).map(|k| A[i][k] * columns[k].f[column][j]).sum();
                    rhs[i * (n + 1) + j][column] = h * sum / scales[j];
                }
                rhs[i * (n + 1) + n][column] = -columns[i].g[column];
            }
        }
        self.lu.solve_block(&mut rhs);
        for column in 0..system.columns() {
            for i in 0..3 {
                for j in 0..n {
                    out[i][column][j] = rhs[i * (n + 1) + j][column] * scales[j];
                }
            }
        }
    }

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
}
