//! The affine part of a Radau step, eliminated once per mode and size of step (see [`super::radau`]).

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::lu::Lu;
use super::radau::{A, C, State};
use crate::model::system::{Affine, Evaluation, Forcing, HybridSystem, MAX_STATES, Mode};

/// Most unknowns of a stage: the algebraic one and the rates of all states.
const MAX_UNKNOWNS: usize = MAX_STATES + 1;
/// Columns of E, K and H side by side, at most; the first number serves most systems.
const COLUMNS: [usize; 2] = [12, MAX_STATES + 3 + 3 * MAX_UNKNOWNS];

/// What the affine rows of a mode make of a step of one size.
pub struct Elimination {
    mode: Option<Mode>,
    size: f64,
    /// What is affine.
    pub affine: Affine,
    /// Rows that are not affine.
    pub rows: [usize; MAX_STATES],
    /// Their number.
    pub count: usize,
    /// The affine rates: dz'/dz, dz'/ds and the parts of 1, sin wt, cos wt; rows that are not affine are zero.
    linear: [State; MAX_STATES],
    by_slip: State,
    parts: [State; 3],
    /// The factorised equations of the affine rows, in units of the scales.
    pub lu: Lu,
    /// dZ/dz.
    pub start: [[State; MAX_STATES]; 3],
    /// Z of (1, sin wt, cos wt) at the start of the step.
    pub forced: [[[f64; 3]; MAX_STATES]; 3],
    /// dZ/dU: stage of Z, state, stage of U, unknown.
    pub unknowns: [[[[f64; MAX_UNKNOWNS]; 3]; MAX_STATES]; 3],
}

impl Default for Elimination {
    fn default() -> Self {
        Self {
            mode: None,
            size: 0.0,
            affine: Affine { rows: [false; MAX_STATES], constraint: false, margins: false },
            rows: [0; MAX_STATES],
            count: 0,
            linear: [[0.0; MAX_STATES]; MAX_STATES],
            by_slip: [0.0; MAX_STATES],
            parts: [[0.0; MAX_STATES]; 3],
            lu: Lu::default(),
            start: [[[0.0; MAX_STATES]; MAX_STATES]; 3],
            forced: [[[0.0; 3]; MAX_STATES]; 3],
            unknowns: [[[[0.0; MAX_UNKNOWNS]; 3]; MAX_STATES]; 3],
        }
    }
}

impl Elimination {
    /// Makes the matrices fit a mode and a size of step; false where they do not exist.
    pub fn fit(&mut self, system: &dyn HybridSystem, mode: Mode, h: f64) -> bool {
        if self.mode == Some(mode) && self.size == h {
            return true;
        }
        let n = system.states();
        if self.mode != Some(mode) {
            self.learn(system, mode, n);
        }
        (self.mode, self.size) = (None, h);
        let scales = system.scales();
        let matrix = self.lu.matrix(3 * n);
        for i in 0..3 {
            for j in 0..n {
                let row = &mut matrix[i * n + j];
                for k in 0..3 {
                    let factor = -h * A[i][k] / scales[j];
                    for l in 0..n {
                        row[k * n + l] = factor * self.linear[j][l] * scales[l];
                    }
                }
                row[i * n + j] += 1.0;
            }
        }
        if !self.lu.factorise() {
            return false;
        }
        if n + 3 + 3 * (1 + self.count) <= COLUMNS[0] {
            self.solve::<{ COLUMNS[0] }>(system, n, h, &scales);
        } else {
            self.solve::<{ COLUMNS[1] }>(system, n, h, &scales);
        }
        self.mode = Some(mode);
        true
    }

    /// The affine rates of a mode.
    fn learn(&mut self, system: &dyn HybridSystem, mode: Mode, n: usize) {
        self.affine = system.affine(mode);
        self.count = 0;
        let zero = [0.0; MAX_STATES];
        let mut e = [Evaluation::default(); 3];
        system.evaluate(&Forcing::default(), &zero, 0.0, mode, &mut e[0]);
        system.evaluate(&system.forcing(0.25 * system.period()), &zero, 0.0, mode, &mut e[1]);
        system.evaluate(&system.forcing(0.0), &zero, 0.0, mode, &mut e[2]);
        for j in 0..n {
            if self.affine.rows[j] {
                self.linear[j] = e[0].fz[j];
                self.by_slip[j] = e[0].fs[j];
                for (part, parts) in self.parts.iter_mut().enumerate() {
                    parts[j] = e[part].f[j] - if part == 0 { 0.0 } else { e[0].f[j] };
                }
            } else {
                self.linear[j] = [0.0; MAX_STATES];
                self.by_slip[j] = 0.0;
                self.parts.iter_mut().for_each(|part| part[j] = 0.0);
                self.rows[self.count] = j;
                self.count += 1;
            }
        }
    }

    /// Columns of E, K and H.
    fn solve<const W: usize>(&mut self, system: &dyn HybridSystem, n: usize, h: f64, scales: &State) {
        let omega = std::f64::consts::TAU / system.period();
        let turn = C.map(|c| (omega * c * h).sin_cos());
        let mut rhs = [[0.0; W]; 3 * MAX_STATES];
        for i in 0..3 {
            for j in 0..n {
                let row = &mut rhs[i * n + j];
                row[j] = 1.0;
                for k in 0..3 {
                    let factor = h * A[i][k] / scales[j];
                    // sin w(t + ch) = sin wt cos wch + cos wt sin wch
                    let (sine, cosine) = turn[k];
                    row[n] += factor * self.parts[0][j];
                    row[n + 1] += factor * (self.parts[1][j] * cosine - self.parts[2][j] * sine);
                    row[n + 2] += factor * (self.parts[1][j] * sine + self.parts[2][j] * cosine);
                    row[n + 3 + k * (1 + self.count)] = factor * self.by_slip[j];
                }
            }
            for (index, &j) in self.rows[..self.count].iter().enumerate() {
                for k in 0..3 {
                    rhs[i * n + j][n + 3 + k * (1 + self.count) + 1 + index] = h * A[i][k] / scales[j];
                }
            }
        }
        self.lu.solve_block(&mut rhs[..3 * n]);
        for i in 0..3 {
            for j in 0..n {
                let row = &rhs[i * n + j];
                let scale = scales[j];
                for l in 0..n {
                    self.start[i][j][l] = row[l] * scale / scales[l];
                }
                for part in 0..3 {
                    self.forced[i][j][part] = row[n + part] * scale;
                }
                for k in 0..3 {
                    for u in 0..1 + self.count {
                        self.unknowns[i][j][k][u] = row[n + 3 + k * (1 + self.count) + u] * scale;
                    }
                }
            }
        }
    }
}
