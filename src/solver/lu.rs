//! LU factorisation with partial pivoting of small dense systems, in place and without allocation.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::elimination::MAX_UNKNOWNS;

/// Largest order: the unknowns of three stages.
pub const MAX_ORDER: usize = 3 * MAX_UNKNOWNS;

/// Calls a method with the order, and with it as a constant where it is common, so that the compiler unrolls the loops.
macro_rules! of_order {
    ($self:ident.$method:ident$([$width:ident])?($($argument:expr),*)) => {
        match $self.order {
            3 => $self.$method::<3$(, $width)?>($($argument),*),
            6 => $self.$method::<6$(, $width)?>($($argument),*),
            9 => $self.$method::<9$(, $width)?>($($argument),*),
            _ => $self.$method::<MAX_ORDER$(, $width)?>($($argument),*),
        }
    };
}

/// A factorised square matrix.
pub struct Lu {
    order: usize,
    columns: Box<[[f64; MAX_ORDER]; MAX_ORDER]>,
    inverse: [f64; MAX_ORDER],
    pivots: [usize; MAX_ORDER],
}

impl Default for Lu {
    fn default() -> Self {
        Self {
            order: 0,
            columns: Box::new([[0.0; MAX_ORDER]; MAX_ORDER]),
            inverse: [0.0; MAX_ORDER],
            pivots: [0; MAX_ORDER],
        }
    }
}

impl Lu {
    /// The matrix to be filled before [`Lu::factorise`], column by column; only the leading `order` columns and rows
    /// count.
    pub fn columns(&mut self, order: usize) -> &mut [[f64; MAX_ORDER]; MAX_ORDER] {
        self.order = order;
        &mut self.columns
    }

    /// Factorises; false where the matrix is singular to working precision.
    pub fn factorise(&mut self) -> bool {
        of_order!(self.eliminate())
    }

    fn eliminate<const N: usize>(&mut self) -> bool {
        let n = if N == MAX_ORDER { self.order } else { N };
        for k in 0..n {
            let column = &self.columns[k];
            let mut best = k;
            for i in k + 1..n {
                if column[i].abs() > column[best].abs() {
                    best = i;
                }
            }
            self.pivots[k] = best;
            if best != k {
                self.columns[..n].iter_mut().for_each(|column| column.swap(k, best));
            }
            let pivot = self.columns[k][k];
            if pivot.abs() < 1e-280 || !pivot.is_finite() {
                return false;
            }
            let inverse = 1.0 / pivot;
            self.inverse[k] = inverse;
            // Of fixed length, with zeros where nothing is taken off: that is faster than loops of varying length.
            let mut factors = [0.0; N];
            for i in k + 1..n {
                factors[i] = self.columns[k][i] * inverse;
                self.columns[k][i] = factors[i];
            }
            for column in &mut self.columns[k + 1..n] {
                let x = column[k];
                for (r, l) in column[..N].iter_mut().zip(&factors) {
                    *r -= x * l;
                }
            }
        }
        true
    }

    /// Solves in place for one right side.
    pub fn solve(&self, b: &mut [f64]) {
        of_order!(self.substitute(b))
    }

    fn substitute<const N: usize>(&self, b: &mut [f64]) {
        let n = if N == MAX_ORDER { self.order } else { N };
        let b = &mut b[..n];
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        for k in 0..n {
            let (done, rest) = b.split_at_mut(k + 1);
            for (r, l) in rest.iter_mut().zip(&self.columns[k][k + 1..n]) {
                *r -= done[k] * l;
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

    /// Solves in place for `W` right sides, the columns of `b`.
    pub fn solve_block<const W: usize>(&self, b: &mut [[f64; W]]) {
        of_order!(self.substitute_block[W](b))
    }

    fn substitute_block<const N: usize, const W: usize>(&self, b: &mut [[f64; W]]) {
        let n = if N == MAX_ORDER { self.order } else { N };
        let b = &mut b[..n];
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        for k in 0..n {
            let x = b[k];
            for i in k + 1..n {
                for (r, x) in b[i].iter_mut().zip(&x) {
                    *r -= self.columns[k][i] * x;
                }
            }
        }
        for k in (0..n).rev() {
            let x = b[k].map(|x| x * self.inverse[k]);
            b[k] = x;
            for i in 0..k {
                for (r, x) in b[i].iter_mut().zip(&x) {
                    *r -= self.columns[k][i] * x;
                }
            }
        }
    }

    /// Solves in place with the transposed matrix for `W` right sides, the columns of `b`.
    pub fn solve_transposed<const W: usize>(&self, b: &mut [[f64; W]]) {
        let n = self.order;
        for k in 0..n {
            for i in 0..k {
                for column in 0..W {
                    b[k][column] -= self.columns[k][i] * b[i][column];
                }
            }
            b[k] = b[k].map(|x| x * self.inverse[k]);
        }
        for k in (0..n).rev() {
            for i in k + 1..n {
                for column in 0..W {
                    b[k][column] -= self.columns[k][i] * b[i][column];
                }
            }
        }
        for k in (0..n).rev() {
            b.swap(k, self.pivots[k]);
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
        let columns = lu.columns(3);
        for i in 0..3 {
            for j in 0..3 {
                columns[j][i] = a[i][j];
            }
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
        let columns = lu.columns(2);
        columns[0][..2].copy_from_slice(&[1.0, 2.0]);
        columns[1][..2].copy_from_slice(&[2.0, 4.0]);
        assert!(!lu.factorise());
    }
}
