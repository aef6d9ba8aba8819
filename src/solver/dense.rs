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
