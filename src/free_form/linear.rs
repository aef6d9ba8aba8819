//! Linear algebra of the fits: robust sums, and normal equations with directions of which nothing is known.

use crate::statistics::spread;
use nalgebra::{DMatrix, DVector};

/// Share of the largest that a direction of which the readings know nothing is held by.
pub const HELD: f64 = 1e-9;

/// Typical size of residuals, at least that of the noise.
pub fn typical(residuals: &DVector<f64>) -> f64 {
    spread(residuals.iter().copied(), 0.0).max(1.0)
}

/// Sum of squares with residuals beyond a threshold counted with their logarithm, and the weights that residuals have
/// in it.
pub fn robust(residuals: &DVector<f64>, threshold: f64) -> (f64, DVector<f64>) {
    let weights = residuals.map(|r| (threshold / r.abs()).powi(2).min(1.0));
    let loss = |r: &f64| {
        let size = r.abs();
        if size <= threshold { size * size } else { threshold * threshold * (1.0 + 2.0 * (size / threshold).ln()) }
    };
    (residuals.iter().map(loss).sum(), weights)
}

/// The matrix with directions of which nothing is known held where they are.
fn held(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let scale: Vec<f64> = matrix.diagonal().iter().copied().collect();
    let largest = scale.iter().copied().fold(0.0, f64::max);
    let own = |i: usize| HELD * if scale[i] > 0.0 { scale[i] } else { largest.max(f64::MIN_POSITIVE) };
    matrix + DMatrix::from_diagonal(&DVector::from_fn(scale.len(), |i, _| own(i)))
}

/// Solution of the equations; `None` where there is none in numbers.
pub fn solved(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    Some(held(matrix).cholesky()?.solve(right)).filter(|x| x.iter().all(|x| x.is_finite()))
}

/// Inverse of the matrix.
pub fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    Some(held(matrix).cholesky()?.inverse())
}
