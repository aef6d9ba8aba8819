//! Small systems of linear equations on the stack.

use super::cycle::Matrix;
use super::radau::State;

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
