//! Least squares with numbers that may not be negative: the active set of Lawson and Hanson, Solving Least Squares
//! Problems (1974), chapter 23, on the triangle of the matrix.

use nalgebra::{DMatrix, DVector};

/// The vector x >= 0 that minimises |a x - b|. Columns of zeros get zero.
pub fn nnls(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let norms: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
    let unit = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| if norms[j] > 0.0 { a[(i, j)] / norms[j] } else { 0.0 });
    let qr = unit.qr();
    let mut rotated = b.clone();
    qr.q_tr_mul(&mut rotated);
    let r = qr.unpack_r();
    let rotated = rotated.rows(0, r.nrows()).into_owned();
    let x = active_set(&r, &rotated);
    DVector::from_fn(x.len(), |j, _| if norms[j] > 0.0 { x[j] / norms[j] } else { 0.0 })
}

/// The same of columns of unit length.
fn active_set(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let n = a.ncols();
    let mut x = DVector::zeros(n);
    let (mut passive, mut barred) = (vec![false; n], vec![false; n]);
    // What rounding alone can leave of a gradient.
    let least = f64::EPSILON * (a.nrows() * n) as f64 * b.norm();
    for _ in 0..3 * n {
        let gradient = a.tr_mul(&(b - a * &x));
        let rises = |j: &usize| !passive[*j] && !barred[*j] && gradient[*j] > least;
        let Some(next) = (0..n).filter(rises).max_by(|&i, &j| gradient[i].total_cmp(&gradient[j])) else { break };
        passive[next] = true;
        loop {
            let z = free(a, b, &passive);
            let low = |j: &usize| passive[*j] && z[*j] <= 0.0;
            let share = |j: usize| if x[j] > z[j] { x[j] / (x[j] - z[j]) } else { 0.0 };
            let Some(first) = (0..n).filter(low).min_by(|&i, &j| share(i).total_cmp(&share(j))) else {
                x = z;
                break;
            };
            let step = share(first);
            x += step * (&z - &x);
            (x[first], passive[first]) = (0.0, false);
            // Rounding promised a rise that is none.
            barred[first] |= first == next;
        }
    }
    x
}

/// Least squares in the passive columns, zero elsewhere and where columns are the same to rounding.
fn free(a: &DMatrix<f64>, b: &DVector<f64>, passive: &[bool]) -> DVector<f64> {
    let columns: Vec<usize> = (0..passive.len()).filter(|&j| passive[j]).collect();
    let mut z = DVector::zeros(passive.len());
    if columns.is_empty() {
        return z;
    }
    let qr = a.select_columns(&columns).qr();
    let mut right = b.clone();
    qr.q_tr_mul(&mut right);
    if let Some(some) = qr.r().solve_upper_triangular(&right.rows(0, columns.len())) {
        columns.iter().zip(some.iter()).for_each(|(&j, value)| z[j] = if value.is_finite() { *value } else { 0.0 });
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the minimum the gradient is zero where a number is free and does not point inwards where it is zero (Karush,
    /// Kuhn and Tucker): what tells a minimum of a convex problem without another solver.
    #[test]
    fn the_conditions_of_a_minimum_hold() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut zeros = 0;
        for n in [1, 2, 5, 12] {
            for _ in 0..20 {
                let a = DMatrix::from_fn(15, n, |_, _| random());
                let b = DVector::from_fn(15, |_, _| random());
                let x = nnls(&a, &b);
                let gradient = a.tr_mul(&(&b - &a * &x));
                for j in 0..n {
                    zeros += usize::from(x[j] == 0.0);
                    assert!(x[j] >= 0.0 && gradient[j] < 1e-12, "{x} {gradient}");
                    assert!(x[j] == 0.0 || gradient[j].abs() < 1e-12, "{x} {gradient}");
                }
            }
        }
        assert!(zeros > 100, "{zeros}");
    }

    #[test]
    fn columns_that_are_zero_or_the_same_do_no_harm() {
        let a = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 0.0, 2.0, 2.0, 0.0, 3.0, 3.0, 0.0]);
        let x = nnls(&a, &DVector::from_vec(vec![2.0, 4.0, 6.0]));
        assert!((x[0] + x[1] - 2.0).abs() < 1e-12 && x[2] == 0.0, "{x}");
    }
}
