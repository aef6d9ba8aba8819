//! Small matrices and systems of linear equations on the stack.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::radau::State;
use crate::model::system::MAX_STATES;

/// Square matrix over the states.
pub type Matrix = [State; MAX_STATES];

/// Solves the leading `n` equations by elimination with pivoting; `None` where they are singular.
pub fn solve(n: usize, mut m: Matrix, mut b: State) -> Option<State> {
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| m[i][k].abs().total_cmp(&m[j][k].abs()))?;
        m.swap(k, pivot);
        b.swap(k, pivot);
        let (upper, lower) = m.split_at_mut(k + 1);
        let top = &upper[k];
        if top[k] == 0.0 || !top[k].is_finite() {
            return None;
        }
        for (i, row) in lower[..n - k - 1].iter_mut().enumerate() {
            let factor = row[k] / top[k];
            for j in k..n {
                row[j] -= factor * top[j];
            }
            b[k + 1 + i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            b[k] -= m[k][j] * b[j];
        }
        b[k] /= m[k][k];
    }
    b[..n].iter().all(|x| x.is_finite()).then_some(b)
}

/// Squarings of a matrix whose spectral radius is wanted: what a norm misses of it goes down by half each time.
const SQUARINGS: usize = 24;

/// Spectral radius of the leading `n` rows and columns by repeated squaring; no number where an entry is none or
/// infinite.
pub fn spectral_radius(n: usize, mut matrix: Matrix) -> f64 {
    let largest = |m: &Matrix| {
        let leading = m[..n].iter().flat_map(|row| &row[..n]);
        leading.fold(0.0f64, |most, entry| if entry.abs() > most || entry.is_nan() { entry.abs() } else { most })
    };
    let (mut log, mut power) = (0.0, 1.0);
    for _ in 0..SQUARINGS {
        let norm = largest(&matrix);
        if norm == 0.0 {
            return 0.0;
        }
        if !norm.is_finite() {
            return f64::NAN;
        }
        log += norm.ln() / power;
        for row in &mut matrix[..n] {
            row[..n].iter_mut().for_each(|entry| *entry /= norm);
        }
        let mut square = [[0.0; MAX_STATES]; MAX_STATES];
        multiply(n, n, &matrix, &matrix, &mut square);
        matrix = square;
        power *= 2.0;
    }
    (log + largest(&matrix).ln() / power).exp()
}

/// The identity.
pub fn identity() -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

/// The leading rows of the product of two matrices of order `n`.
pub fn multiply(rows: usize, n: usize, a: &Matrix, b: &Matrix, out: &mut Matrix) {
    match n {
        3 => product(rows, 3, a, b, out),
        4 => product(rows, 4, a, b, out),
        5 => product(rows, 5, a, b, out),
        _ => product(rows, n, a, b, out),
    }
}

#[inline(always)]
fn product(rows: usize, n: usize, a: &Matrix, b: &Matrix, out: &mut Matrix) {
    for i in 0..rows {
        for j in 0..n {
            let mut sum = 0.0;
            for k in 0..n {
                sum += a[i][k] * b[k][j];
            }
            out[i][j] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spectral_radius_of_a_matrix_that_is_far_from_normal() {
        // Eigenvalues 1.0005 and 0.3 beside an entry a million times larger, and a rotation by 1 rad.
        let mut matrix = [[0.0; MAX_STATES]; MAX_STATES];
        (matrix[0][0], matrix[0][1], matrix[1][1]) = (1.0005, 1e6, 0.3);
        assert!((spectral_radius(2, matrix) - 1.0005).abs() < 1e-5, "{}", spectral_radius(2, matrix));
        let (sine, cosine) = 1f64.sin_cos();
        (matrix[0][0], matrix[0][1], matrix[1][0], matrix[1][1]) =
            (0.9 * cosine, -0.9 * sine, 0.9 * sine, 0.9 * cosine);
        assert!((spectral_radius(2, matrix) - 0.9).abs() < 1e-6);
        for none in [f64::NAN, f64::INFINITY] {
            matrix[1][0] = none;
            assert!(spectral_radius(2, matrix).is_nan());
        }
    }

    #[test]
    fn the_spectral_radius_of_matrices_that_vanish_or_nearly_do() {
        let mut matrix = [[0.0; MAX_STATES]; MAX_STATES];
        assert_eq!(spectral_radius(3, matrix), 0.0);
        (matrix[0][1], matrix[1][2]) = (5.0, 7.0);
        assert_eq!(spectral_radius(3, matrix), 0.0);
        matrix = [[0.0; MAX_STATES]; MAX_STATES];
        (matrix[0][0], matrix[1][1]) = (1e-310, 1e-312);
        assert!((spectral_radius(2, matrix) / 1e-310 - 1.0).abs() < 1e-6);
    }
}
