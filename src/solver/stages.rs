//! Linear equations over one Radau step, solved for their values at the stages.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::radau::A;
use crate::model::system::Linear;

/// Three stage values.
pub type Stages = [f64; 3];
/// Coefficients between stages.
pub type Block = [Stages; 3];

/// Response of two states x, x' at the stages to their start values and to the forces at the stages.
pub struct Pair {
    /// By x and x' at the start.
    pub start: [[Stages; 2]; 2],
    /// By the forces at the stages.
    pub force: [Block; 2],
}

impl Pair {
    /// For a step of size `h`.
    pub fn new(h: f64, linear: Linear) -> Self {
        // x_i = x + h A x', x'_i = x' + h A (-k x - c x' + f): eliminate x.
        let square: Block =
            std::array::from_fn(|i| std::array::from_fn(|k| (0..3).map(|l| h * A[i][l] * h * A[l][k]).sum()));
        let unit = |i: usize, k: usize| f64::from(u8::from(i == k));
        let matrix: Block = std::array::from_fn(|i| {
            std::array::from_fn(|k| unit(i, k) + linear.damping * h * A[i][k] + linear.stiffness * square[i][k])
        });
        let sums: Stages = std::array::from_fn(|i| h * A[i].iter().sum::<f64>());
        let from_x = solve3(matrix, sums.map(|s| -linear.stiffness * s));
        let from_v = solve3(matrix, [1.0; 3]);
        let mut by_force = [[0.0; 3]; 3];
        for k in 0..3 {
            let column = solve3(matrix, std::array::from_fn(|i| h * A[i][k]));
            for i in 0..3 {
                by_force[i][k] = column[i];
            }
        }
        let integrate =
            |v: &Stages| -> Stages { std::array::from_fn(|i| h * (0..3).map(|l| A[i][l] * v[l]).sum::<f64>()) };
        let x_from_x = integrate(&from_x).map(|x| 1.0 + x);
        let x_from_v = integrate(&from_v);
        let mut x_by_force = [[0.0; 3]; 3];
        for k in 0..3 {
            let column = integrate(&std::array::from_fn(|i| by_force[i][k]));
            for i in 0..3 {
                x_by_force[i][k] = column[i];
            }
        }
        Self { start: [[x_from_x, x_from_v], [from_x, from_v]], force: [x_by_force, by_force] }
    }

    /// x (0) or x' (1) at the stages.
    pub fn states(&self, which: usize, x: f64, v: f64, load: &Stages) -> Stages {
        std::array::from_fn(|i| {
            let [a, b] = self.start[which];
            a[i] * x + b[i] * v + (0..3).map(|k| self.force[which][i][k] * load[k]).sum::<f64>()
        })
    }
}

/// Stages of y' = d - rate y: (from the start value, from d at the stages).
pub fn relaxation(h: f64, rate: f64) -> (Stages, Block) {
    let matrix: Block =
        std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k)) + h * rate * A[i][k]));
    let start = solve3(matrix, [1.0; 3]);
    let mut out = [[0.0; 3]; 3];
    for k in 0..3 {
        let column = solve3(matrix, std::array::from_fn(|i| h * A[i][k]));
        for i in 0..3 {
            out[i][k] = column[i];
        }
    }
    (start, out)
}

/// Solves three equations by elimination with pivoting.
pub fn solve3(mut m: Block, mut b: Stages) -> Stages {
    for k in 0..3 {
        let pivot = (k..3).max_by(|&i, &j| m[i][k].abs().total_cmp(&m[j][k].abs())).unwrap_or(k);
        m.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..3 {
            let factor = m[i][k] / m[k][k];
            for j in k..3 {
                m[i][j] -= factor * m[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..3).rev() {
        for j in k + 1..3 {
            b[k] -= m[k][j] * b[j];
        }
        b[k] /= m[k][k];
    }
    b
}
