//! Linear equations over one Radau step, solved for their values at the stages.

use super::radau::A;
use crate::model::system::Linear;
use nalgebra::Matrix3;

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
        let by_rate: Block = A.map(|row| row.map(|a| h * a));
        let square = chained(&by_rate, &by_rate);
        let unit = |i: usize, k: usize| f64::from(u8::from(i == k));
        let inverse = inverse(&std::array::from_fn(|i| {
            std::array::from_fn(|k| unit(i, k) + linear.damping * by_rate[i][k] + linear.stiffness * square[i][k])
        }));
        let from_x = product(&inverse, &product(&by_rate, &[-linear.stiffness; 3]));
        let from_v = product(&inverse, &[1.0; 3]);
        let by_force = chained(&inverse, &by_rate);
        let x_from_x = product(&by_rate, &from_x).map(|x| 1.0 + x);
        let x_from_v = product(&by_rate, &from_v);
        let x_by_force = chained(&by_rate, &by_force);
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
    let inverse =
        inverse(&std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k)) + h * rate * A[i][k])));
    (product(&inverse, &[1.0; 3]), chained(&inverse, &A.map(|row| row.map(|a| h * a))))
}

/// The inverse; not finite where there is none.
pub fn inverse(matrix: &Block) -> Block {
    let inverse = Matrix3::from_fn(|i, k| matrix[i][k]).try_inverse();
    inverse.map_or([[f64::NAN; 3]; 3], |inverse| std::array::from_fn(|i| std::array::from_fn(|k| inverse[(i, k)])))
}

/// B v.
pub fn product(b: &Block, v: &Stages) -> Stages {
    std::array::from_fn(|i| b[i][0] * v[0] + b[i][1] * v[1] + b[i][2] * v[2])
}

/// B C.
pub fn chained(b: &Block, c: &Block) -> Block {
    std::array::from_fn(|i| std::array::from_fn(|k| b[i][0] * c[0][k] + b[i][1] * c[1][k] + b[i][2] * c[2][k]))
}
