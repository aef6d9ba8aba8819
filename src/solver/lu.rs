//! LU factorisation with partial pivoting of small dense systems, in place and without allocation.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

/// Largest order: three stages of all states and the algebraic unknown.
pub const MAX_ORDER: usize = 3 * (crate::model::system::MAX_STATES + 1);

/// A factorised square matrix.
pub struct Lu {
    order: usize,
    rows: Box<[[f64; MAX_ORDER]; MAX_ORDER]>,
    columns: Box<[[f64; MAX_ORDER]; MAX_ORDER]>,
    inverse: [f64; MAX_ORDER],
    pivots: [usize; MAX_ORDER],
}

impl Default for Lu {
    fn default() -> Self {
        let zero = [[0.0; MAX_ORDER]; MAX_ORDER];
        Self {
            order: 0,
            rows: Box::new(zero),
            columns: Box::new(zero),
            inverse: [0.0; MAX_ORDER],
            pivots: [0; MAX_ORDER],
        }
    }
}

impl Lu {
    /// The matrix to be filled before [`Lu::factorise`]; only the leading `order` rows and columns count.
    pub fn matrix(&mut self, order: usize) -> &mut [[f64; MAX_ORDER]; MAX_ORDER] {
        self.order = order;
        &mut self.rows
    }

    /// Factorises; false where the matrix is singular to working precision.
    pub fn factorise(&mut self) -> bool {
        let n = self.order;
        for k in 0..n {
            let mut best = k;
            for i in k + 1..n {
                if self.rows[i][k].abs() > self.rows[best][k].abs() {
                    best = i;
                }
            }
            self.pivots[k] = best;
            if best != k {
                let (upper, lower) = self.rows.split_at_mut(best);
                upper[k][..n].swap_with_slice(&mut lower[0][..n]);
            }
            let pivot = self.rows[k][k];
            if pivot.abs() < 1e-280 || !pivot.is_finite() {
                return false;
            }
            let inverse = 1.0 / pivot;
            self.inverse[k] = inverse;
            let (upper, lower) = self.rows.split_at_mut(k + 1);
            let top = &upper[k][k + 1..n];
            for row in lower[..n - k - 1].iter_mut() {
                let factor = row[k] * inverse;
                row[k] = factor;
                if factor != 0.0 {
                    for (r, t) in row[k + 1..n].iter_mut().zip(top) {
                        *r -= factor * t;
                    }
                }
            }
        }
        // Columns side by side, for substitutions that update a whole column at once.
        for k in 0..n {
            for i in 0..n {
                self.columns[k][i] = self.rows[i][k];
            }
        }
        true
    }

    /// Solves in place for one right side.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.order;
        let b = &mut b[..n];
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        for k in 0..n {
            let (done, rest) = b.split_at_mut(k + 1);
            let x = done[k];
            for (r, l) in rest.iter_mut().zip(&self.columns[k][k + 1..n]) {
                *r -= x * l;
            }
        }
        for k in (0..n).rev() {
            let x = b[k] * self.inverse[k];
            b[k] = x;
            for (r, u) in b[..k].iter_mut().zip(&self.columns[k][..k]) {
                *r -= x * u;
            }
        }
    }

    /// Solves in place with the transposed matrix for `W` right sides, the columns of `b`.
    pub fn solve_transposed<const W: usize>(&self, b: &mut [[f64; W]]) {
        let n = self.order;
        for k in 0..n {
            let (done, rest) = b[..n].split_at_mut(k + 1);
            let x = &mut done[k];
            for x in x.iter_mut() {
                *x *= self.inverse[k];
            }
            for (row, u) in rest.iter_mut().zip(&self.rows[k][k + 1..n]) {
                for (r, x) in row.iter_mut().zip(&*x) {
                    *r -= u * x;
                }
            }
        }
        for k in (1..n).rev() {
            let (rest, done) = b.split_at_mut(k);
            for (row, l) in rest.iter_mut().zip(&self.rows[k][..k]) {
                for (r, x) in row.iter_mut().zip(&done[0]) {
                    *r -= l * x;
                }
            }
        }
        for k in (0..n).rev() {
            b.swap(k, self.pivots[k]);
        }
    }

    /// Solves in place for `W` right sides, the columns of `b`.
    pub fn solve_block<const W: usize>(&self, b: &mut [[f64; W]]) {
        let n = self.order;
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        for k in 1..n {
            let (done, rest) = b.split_at_mut(k);
            for (x, l) in done.iter().zip(&self.rows[k][..k]) {
                for (r, x) in rest[0].iter_mut().zip(x) {
                    *r -= l * x;
                }
            }
        }
        for k in (0..n).rev() {
            let (rest, done) = b.split_at_mut(k + 1);
            let row = &mut rest[k];
            for (x, u) in done.iter().zip(&self.rows[k][k + 1..n]) {
                for (r, x) in row.iter_mut().zip(x) {
                    *r -= u * x;
                }
            }
            for r in row {
                *r *= self.inverse[k];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_system_that_needs_pivoting_and_refuses_a_singular_one() {
        let a = [[0.0, 2.0, 1.0], [1.0, -1.0, 3.0], [4.0, 0.5, -2.0]];
        let x = [1.5, -2.0, 0.25];
        let mut lu = Lu::default();
        let matrix = lu.matrix(3);
        for i in 0..3 {
            matrix[i][..3].copy_from_slice(&a[i]);
        }
        assert!(lu.factorise());
        let mut b: Vec<f64> = a.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        lu.solve(&mut b);
        assert!(b.iter().zip(&x).all(|(b, x)| (b - x).abs() < 1e-14));
        let mut block: Vec<[f64; 2]> =
            a.iter().map(|row| [row.iter().zip(&x).map(|(a, x)| a * x).sum(), row[1]]).collect();
        lu.solve_block(&mut block);
        assert!(
            block
                .iter()
                .zip(x)
                .zip([0.0, 1.0, 0.0])
                .all(|((b, x), e)| (b[0] - x).abs() < 1e-14 && (b[1] - e).abs() < 1e-14)
        );
        let transposed = |j: usize, f: fn(f64) -> f64| -> f64 { (0..3).map(|i| a[i][j] * f(x[i])).sum() };
        let mut block: Vec<[f64; 2]> = (0..3).map(|j| [transposed(j, |x| x), transposed(j, |x| x * x)]).collect();
        lu.solve_transposed(&mut block);
        assert!(block.iter().zip(x).all(|(b, x)| (b[0] - x).abs() < 1e-14 && (b[1] - x * x).abs() < 1e-14));
        let matrix = lu.matrix(2);
        matrix[0][..2].copy_from_slice(&[1.0, 2.0]);
        matrix[1][..2].copy_from_slice(&[2.0, 4.0]);
        assert!(!lu.factorise());
    }
}
