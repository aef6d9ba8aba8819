//! One step of the three-stage Radau IIA collocation method (order 5; Hairer and Wanner, Solving ODEs II, IV.5) for a
//! system with one algebraic unknown, and its tangent.
//!
//! What of the rates is affine ([`crate::model::system::Affine`]) is eliminated beforehand: with the unknowns U at the stages - the algebraic
//! unknown s and the rates r of the rows that are not affine - the states at the stages are
//!
//!   Z = E z + K (1, sin wt, cos wt) + H U,
//!
//! with matrices that depend on the mode and the size of the step only and are kept from step to step. Newton's method then
//! has three unknowns where only the law of friction is not affine, whatever the number of states.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::elimination::Elimination;
use super::harmonic::Complex;
use super::lu::{Lu, MAX_ORDER};
use crate::model::system::{Evaluation, Forcing, HybridSystem, MAX_STATES, Mode};

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

/// A step that was taken, as far as its adjoint needs it.
#[derive(Debug, Clone)]
pub struct Taken {
    /// Mode.
    pub mode: Mode,
    /// Size \[s\].
    pub size: f64,
    /// Weight of its integral in the fundamental.
    pub weight: f64,
    /// Forcing at the stages.
    pub forcing: [Forcing; 3],
    /// States at the stages.
    pub z: [State; 3],
    /// Algebraic unknown at the stages.
    pub s: [f64; 3],
    rates: [State; 3],
}

/// Stage values and the factorised Jacobian of the last step taken.
pub struct Stepper {
    eliminated: Box<Elimination>,
    lu: Lu,
    evaluations: [Evaluation; 3],
    /// Forcing at the stages.
    pub forcing: [Forcing; 3],
    /// States at the stages.
    pub z: [State; 3],
    /// Algebraic unknown at the stages.
    pub s: [f64; 3],
    /// Rates of the rows that are not affine, at the stages.
    rates: [State; 3],
    /// Size and mode of the last step that was accepted, with its unknowns, from which the next is guessed.
    last: Option<(Mode, f64, [f64; 3], [State; 3])>,
    /// Newton iterations of all steps.
    pub iterations: usize,
}

impl Default for Stepper {
    fn default() -> Self {
        Self {
            eliminated: Box::default(),
            lu: Lu::default(),
            evaluations: Default::default(),
            forcing: Default::default(),
            z: [[0.0; MAX_STATES]; 3],
            s: [0.0; 3],
            rates: [[0.0; MAX_STATES]; 3],
            last: None,
            iterations: 0,
        }
    }
}

impl Stepper {
    /// Takes a step of size `h` from (t, z, s); the stages hold the result (the last one is the end). False where Newton
    /// does not converge.
    pub fn step(&mut self, system: &dyn HybridSystem, t: f64, z: &State, s: f64, h: f64, mode: Mode) -> bool {
        let n = system.states();
        let (scales, slip_scale) = (system.scales(), system.slip_scale());
        if !self.eliminated.fit(system, mode, h) {
            return false;
        }
        self.forcing = C.map(|c| system.forcing(t + c * h));
        let count = self.eliminated.count;
        self.guess(system, t, z, s, h, mode);
        // Z without the unknowns; the forcing at the start by way of that at the end.
        let start = system.forcing(t);
        let parts = [1.0, start.sine, start.cosine];
        let mut base = [[0.0; MAX_STATES]; 3];
        for i in 0..3 {
            for j in 0..n {
                let (from_start, from_forcing) = (&self.eliminated.start[i][j], &self.eliminated.forced[i][j]);
                base[i][j] = (0..n).map(|l| from_start[l] * z[l]).sum::<f64>()
                    + (0..3).map(|part| from_forcing[part] * parts[part]).sum::<f64>();
            }
        }
        let straight = self.eliminated.affine.constraint && count == 0;
        let mut previous = f64::INFINITY;
        for _ in 0..25 {
            self.iterations += 1;
            self.states(n, count, &base);
            self.evaluate(system, count, mode);
            if !self.factorise(n, count, h, &scales, slip_scale) {
                return false;
            }
            let mut delta = [0.0; MAX_ORDER];
            let m = 1 + count;
            for i in 0..3 {
                delta[i * m] = -self.evaluations[i].g;
                for (index, &j) in self.eliminated.rows[..count].iter().enumerate() {
                    delta[i * m + 1 + index] = h / scales[j] * (self.rates[i][index] - self.evaluations[i].f[j]);
                }
            }
            self.lu.solve(&mut delta);
            let mut size = 0.0f64;
            for i in 0..3 {
                self.s[i] += delta[i * m] * slip_scale;
                size = size.max(delta[i * m].abs());
                for (index, &j) in self.eliminated.rows[..count].iter().enumerate() {
                    self.rates[i][index] += delta[i * m + 1 + index] * scales[j] / h;
                    size = size.max(delta[i * m + 1 + index].abs());
                }
            }
            if !size.is_finite() {
                return false;
            }
            // Converged, as far as the squaring of errors by Newton's method tells, or as close as rounding lets it come.
            let ratio = if previous.is_finite() { size / previous } else { 1.0 };
            if straight || size * ratio * ratio < 1e-12 || size < 1e-10 || (size < 1e-6 && ratio > 0.5) {
                self.states(n, count, &base);
                return true;
            }
            previous = size;
        }
        false
    }

    /// First values of the unknowns: continued from the last step in the same mode, or constant.
    fn guess(&mut self, system: &dyn HybridSystem, t: f64, z: &State, s: f64, h: f64, mode: Mode) {
        let count = self.eliminated.count;
        if let Some((before, size, slips, rates)) = &self.last
            && *before == mode
            && h <= 2.0 * size
        {
            for i in 0..3 {
                let weights = parabola(1.0 + C[i] * h / size);
                self.s[i] = (0..3).map(|k| weights[k] * slips[k]).sum();
                for index in 0..count {
                    self.rates[i][index] = (0..3).map(|k| weights[k] * rates[k][index]).sum();
                }
            }
            return;
        }
        self.s = [s; 3];
        if count > 0 {
            let e = &mut self.evaluations[0];
            system.evaluate(&system.forcing(t), z, s, mode, e);
            for (index, &j) in self.eliminated.rows[..count].iter().enumerate() {
                self.rates.iter_mut().for_each(|rates| rates[index] = e.f[j]);
            }
        }
    }

    /// Keeps the step just taken, from which the next is guessed; `None` for a mode that ended with it.
    pub fn accept(&mut self, going_on: Option<(Mode, f64)>) {
        self.last = going_on.map(|(mode, size)| (mode, size, self.s, self.rates));
    }

    /// States at the stages from the unknowns.
    fn states(&mut self, n: usize, count: usize, base: &[State; 3]) {
        for i in 0..3 {
            for j in 0..n {
                let by = &self.eliminated.unknowns[i][j];
                let mut sum = base[i][j];
                for k in 0..3 {
                    sum += by[k][0] * self.s[k];
                    for index in 0..count {
                        sum += by[k][1 + index] * self.rates[k][index];
                    }
                }
                self.z[i][j] = sum;
            }
        }
    }

    fn evaluate(&mut self, system: &dyn HybridSystem, count: usize, mode: Mode) {
        for i in 0..3 {
            let e = &mut self.evaluations[i];
            if count == 0 {
                system.constraint(&self.forcing[i], &self.z[i], self.s[i], mode, e);
            } else {
                system.evaluate(&self.forcing[i], &self.z[i], self.s[i], mode, e);
            }
        }
    }

    fn factorise(&mut self, n: usize, count: usize, h: f64, scales: &State, slip_scale: f64) -> bool {
        let m = 1 + count;
        let eliminated = &self.eliminated;
        let matrix = self.lu.matrix(3 * m);
        for i in 0..3 {
            let e = &self.evaluations[i];
            for index in 0..m {
                // Residuals: g, and f - r in units of the state over the step.
                let (gradient, own, factor) = match index {
                    0 => (&e.gz, e.gs, 1.0),
                    _ => {
                        let j = eliminated.rows[index - 1];
                        (&e.fz[j], e.fs[j], h / scales[j])
                    }
                };
                let row = &mut matrix[i * m + index];
                for k in 0..3 {
                    for u in 0..m {
                        let through: f64 = (0..n).map(|l| gradient[l] * eliminated.unknowns[i][l][k][u]).sum();
                        let unit = if u == 0 { slip_scale } else { scales[eliminated.rows[u - 1]] / h };
                        row[k * m + u] = factor * through * unit;
                    }
                }
                row[i * m] += factor * own * slip_scale;
                if index > 0 {
                    row[i * m + index] -= 1.0;
                }
            }
        }
        self.lu.factorise()
    }

    /// Evaluates and factorises the Jacobian at the converged stages, for exact tangents.
    pub fn refactorise(&mut self, system: &dyn HybridSystem, h: f64, mode: Mode) -> bool {
        let count = self.eliminated.count;
        self.evaluate(system, count, mode);
        self.factorise(system.states(), count, h, &system.scales(), system.slip_scale())
    }

    /// Derivative of the stage states by the state at the start: `out[stage][row][column]`, for the columns `0..n`. The
    /// unknowns answer through the Jacobian to what the start does without them.
    pub fn tangent(&self, system: &dyn HybridSystem, h: f64, out: &mut [[State; MAX_STATES]; 3]) {
        let n = system.states();
        let (scales, slip_scale) = (system.scales(), system.slip_scale());
        let (eliminated, m) = (&self.eliminated, 1 + self.eliminated.count);
        let direct = &eliminated.start;
        let mut rhs = [[0.0; MAX_STATES]; MAX_ORDER];
        for i in 0..3 {
            let e = &self.evaluations[i];
            for index in 0..m {
                let row = &mut rhs[i * m + index];
                let (gradient, factor) = match index {
                    0 => (&e.gz, 1.0),
                    _ => (&e.fz[eliminated.rows[index - 1]], h / scales[eliminated.rows[index - 1]]),
                };
                for l in 0..n {
                    let weight = -factor * gradient[l];
                    if weight != 0.0 {
                        for column in 0..n {
                            row[column] += weight * direct[i][l][column];
                        }
                    }
                }
            }
        }
        self.lu.solve_block(&mut rhs[..3 * m]);
        for i in 0..3 {
            for j in 0..n {
                let mut row = direct[i][j];
                for k in 0..3 {
                    for u in 0..m {
                        let unit = if u == 0 { slip_scale } else { scales[eliminated.rows[u - 1]] / h };
                        let weight = eliminated.unknowns[i][j][k][u] * unit;
                        for column in 0..n {
                            row[column] += weight * rhs[k * m + u][column];
                        }
                    }
                }
                out[i][j] = row;
            }
        }
    }

    /// The step just taken; `weight` is that of its integral in the fundamental.
    pub fn taken(&self, mode: Mode, size: f64, weight: f64) -> Taken {
        Taken { mode, size, weight, forcing: self.forcing, z: self.z, s: self.s, rates: self.rates }
    }

    /// Carries the adjoint of the states at the end of a step that was taken back to its start. Leaves in `rates` and
    /// `constraint` the derivatives of the fundamental by disturbances of f and g at the stages.
    pub fn adjoint(
        &mut self,
        system: &dyn HybridSystem,
        taken: &Taken,
        adjoint: &mut [Complex; MAX_STATES],
        rates: &mut [[Complex; MAX_STATES]; 3],
        constraint: &mut [Complex; 3],
    ) -> bool {
        let h = taken.size;
        if !self.eliminated.fit(system, taken.mode, h) {
            return false;
        }
        (self.forcing, self.z, self.s, self.rates) = (taken.forcing, taken.z, taken.s, taken.rates);
        if !self.refactorise(system, h, taken.mode) {
            return false;
        }
        let (n, scales, slip_scale) = (system.states(), system.scales(), system.slip_scale());
        let (eliminated, m) = (&self.eliminated, 1 + self.eliminated.count);
        // By the states at the stages as they stand: through the fundamental and, at the last, the end.
        let mut by_stage = [[[0.0; 2]; MAX_STATES]; 3];
        for i in 0..3 {
            let w = taken.weight * A[2][i];
            by_stage[i][0] = [w * taken.forcing[i].sine, w * taken.forcing[i].cosine];
        }
        for j in 0..n {
            by_stage[2][j][0] += adjoint[j].0;
            by_stage[2][j][1] += adjoint[j].1;
        }
        // Through the unknowns, which answer by way of the Jacobian.
        let mut through = [[0.0; 2]; MAX_ORDER];
        for k in 0..3 {
            for u in 0..m {
                let unit = if u == 0 { slip_scale } else { scales[eliminated.rows[u - 1]] / h };
                let sum = &mut through[k * m + u];
                for i in 0..3 {
                    for j in 0..n {
                        let by = unit * eliminated.unknowns[i][j][k][u];
                        sum[0] += by_stage[i][j][0] * by;
                        sum[1] += by_stage[i][j][1] * by;
                    }
                }
            }
        }
        self.lu.solve_transposed(&mut through[..3 * m]);
        *rates = [[(0.0, 0.0); MAX_STATES]; 3];
        for i in 0..3 {
            let e = &self.evaluations[i];
            for index in 0..m {
                let by = through[i * m + index];
                let (gradient, factor) = match index {
                    0 => (&e.gz, 1.0),
                    _ => (&e.fz[eliminated.rows[index - 1]], h / scales[eliminated.rows[index - 1]]),
                };
                for l in 0..n {
                    by_stage[i][l][0] -= by[0] * factor * gradient[l];
                    by_stage[i][l][1] -= by[1] * factor * gradient[l];
                }
                match index {
                    0 => constraint[i] = (-by[0], -by[1]),
                    _ => rates[i][eliminated.rows[index - 1]] = (-factor * by[0], -factor * by[1]),
                }
            }
        }
        // Through the affine rows.
        let mut affine = [[0.0; 2]; MAX_ORDER];
        for i in 0..3 {
            for j in 0..n {
                affine[i * n + j] = by_stage[i][j].map(|by| by * scales[j]);
            }
        }
        eliminated.lu.solve_transposed(&mut affine[..3 * n]);
        *adjoint = [(0.0, 0.0); MAX_STATES];
        for j in 0..n {
            for i in 0..3 {
                let by = affine[i * n + j];
                adjoint[j].0 += by[0] / scales[j];
                adjoint[j].1 += by[1] / scales[j];
                if eliminated.affine.rows[j] {
                    for k in 0..3 {
                        let w = h * A[i][k] / scales[j];
                        rates[k][j].0 += w * by[0];
                        rates[k][j].1 += w * by[1];
                    }
                }
            }
        }
        true
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

/// Weights of the values at the nodes in the parabola through them at `tau`.
fn parabola(tau: f64) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        (tau - C[j]) * (tau - C[k]) / ((C[i] - C[j]) * (C[i] - C[k]))
    })
}
