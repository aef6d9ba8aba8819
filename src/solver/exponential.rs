//! Exponentials of small matrices by scaling and squaring, and maps y -> Phi y + c of affine flows y' = M y + m.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

/// A square matrix.
pub type Square<const N: usize> = [[f64; N]; N];

/// Norm up to which the series of the exponential is summed.
const SMALL: f64 = 0.5;
/// Terms of the series: what is left out is 0.5^14/14! = 7e-16.
const TERMS: usize = 13;
/// Most squarings of a map over a step: each of them doubles what rounding left of the slow motions.
const MAX_SQUARINGS: usize = 10;

/// The unit matrix.
pub fn unit<const N: usize>() -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

/// Product of two matrices.
#[inline]
pub fn multiply<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    let mut out = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..N {
            for j in 0..N {
                out[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    out
}

/// Product of a matrix and a vector.
#[inline]
pub fn apply<const N: usize>(a: &Square<N>, v: &[f64; N]) -> [f64; N] {
    let mut out = [0.0; N];
    for i in 0..N {
        for j in 0..N {
            out[i] += a[i][j] * v[j];
        }
    }
    out
}

/// Sum of products.
#[inline]
pub fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}

/// Largest row sum of absolute values.
pub fn norm<const N: usize>(a: &Square<N>) -> f64 {
    a.iter().map(|row| row.iter().map(|v| v.abs()).sum()).fold(0.0, f64::max)
}

/// Halvings until the norm is small.
fn squarings(norm: f64) -> usize {
    // A saturating cast; beyond 60 halvings nothing is left of the motion.
    ((norm / SMALL).log2().ceil().max(0.0) as usize).min(60)
}

/// Sum of A^k/(k+1)! up to k = 12 for a small A, in five products: blocks of three powers, by Horner's rule in A^3.
fn phi<const N: usize>(a: &Square<N>) -> Square<N> {
    let square = multiply(a, a);
    let cube = multiply(&square, a);
    let mut sum = cube.map(|row| row.map(|v| v * FACTORIALS[12]));
    for block in (0..4).rev() {
        let [one, two, three] = [0, 1, 2].map(|k| FACTORIALS[3 * block + k]);
        for i in 0..N {
            for j in 0..N {
                sum[i][j] += two * a[i][j] + three * square[i][j];
            }
            sum[i][i] += one;
        }
        if block > 0 {
            sum = multiply(&cube, &sum);
        }
    }
    sum
}

/// 1/(k+1)!
const FACTORIALS: [f64; TERMS] = {
    let mut out = [1.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        out[k] = out[k - 1] / (k + 1) as f64;
        k += 1;
    }
    out
};

/// exp(M t).
pub fn exponential<const N: usize>(m: &Square<N>, t: f64) -> Square<N> {
    let count = squarings(norm(m) * t);
    let small = m.map(|row| row.map(|v| v * t / (1u64 << count) as f64));
    let mut e = multiply(&small, &phi(&small));
    for i in 0..N {
        e[i][i] += 1.0;
    }
    for _ in 0..count {
        e = multiply(&e, &e);
    }
    e
}

/// Derivative of `g . exp(M t)`, the sum of products of the entries, by the entries of M.
pub fn exponential_gradient<const N: usize>(m: &Square<N>, t: f64, g: &Square<N>) -> Square<N> {
    // It is t times the derivative of exp(M^T t) in the direction of g.
    let count = squarings(norm(m) * t);
    let factor = t / (1u64 << count) as f64;
    let a: Square<N> = std::array::from_fn(|i| std::array::from_fn(|j| m[j][i] * factor));
    let d = g.map(|row| row.map(|v| v * factor));
    // Horner's rule for the series of the exponential and its derivative side by side.
    let (mut e, mut l) = (unit::<N>(), [[0.0; N]; N]);
    for k in (1..=TERMS).rev() {
        let (de, al) = (multiply(&d, &e), multiply(&a, &l));
        e = multiply(&a, &e);
        for i in 0..N {
            for j in 0..N {
                e[i][j] /= k as f64;
                l[i][j] = (de[i][j] + al[i][j]) / k as f64;
            }
            e[i][i] += 1.0;
        }
    }
    for _ in 0..count {
        let (el, le) = (multiply(&e, &l), multiply(&l, &e));
        e = multiply(&e, &e);
        for i in 0..N {
            for j in 0..N {
                l[i][j] = el[i][j] + le[i][j];
            }
        }
    }
    l
}

/// The map y -> Phi y + c over a time.
#[derive(Debug, Clone, Copy)]
pub struct Map<const N: usize> {
    /// Phi.
    pub matrix: Square<N>,
    /// c.
    pub shift: [f64; N],
}

impl<const N: usize> Map<N> {
    /// The map of y' = M y + m over a time so short that the norm of M t is small.
    fn short(m: &Square<N>, constant: &[f64; N], t: f64) -> Self {
        let small = m.map(|row| row.map(|v| v * t));
        let phi = phi(&small);
        let mut matrix = multiply(&small, &phi);
        for i in 0..N {
            matrix[i][i] += 1.0;
        }
        Self { matrix, shift: apply(&phi, &constant.map(|c| c * t)) }
    }

    /// The map over any time, forwards or backwards.
    pub fn over(m: &Square<N>, constant: &[f64; N], t: f64) -> Self {
        let count = squarings(norm(m) * t.abs());
        let mut map = Self::short(m, constant, t / (1u64 << count) as f64);
        for _ in 0..count {
            map = map.twice();
        }
        map
    }

    /// The maps over t, t/2, t/4, ... down to a small norm of M t; `None` where there are too many.
    pub fn ladder(m: &Square<N>, constant: &[f64; N], t: f64) -> Option<Vec<Self>> {
        let count = squarings(norm(m) * t);
        if count > MAX_SQUARINGS {
            return None;
        }
        let mut maps = Vec::with_capacity(count + 1);
        maps.push(Self::short(m, constant, t / (1u64 << count) as f64));
        for k in 0..count {
            maps.push(maps[k].twice());
        }
        maps.reverse();
        Some(maps)
    }

    fn twice(&self) -> Self {
        Self { matrix: multiply(&self.matrix, &self.matrix), shift: self.apply(&self.shift) }
    }

    /// Phi y + c.
    #[inline]
    pub fn apply(&self, y: &[f64; N]) -> [f64; N] {
        let mut out = self.shift;
        for i in 0..N {
            for j in 0..N {
                out[i] += self.matrix[i][j] * y[j];
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const M: Square<2> = [[-0.3, 2.0], [-2.0, -0.3]];

    #[test]
    fn a_damped_rotation_is_exact_for_short_and_long_times() {
        for t in [1e-3f64, 0.2, 7.0, 40.0] {
            let (e, decay) = (exponential(&M, t), (-0.3 * t).exp());
            let expected = [[(2.0 * t).cos(), (2.0 * t).sin()], [-(2.0 * t).sin(), (2.0 * t).cos()]];
            for (row, expected) in e.iter().zip(&expected) {
                for (value, expected) in row.iter().zip(expected) {
                    assert!((value - decay * expected).abs() < 2e-13 * decay.max(1e-2), "{t}: {e:?}");
                }
            }
        }
    }

    #[test]
    fn the_gradient_is_that_of_differences() {
        let g = [[0.7, -1.1], [0.4, 2.0]];
        let value = |m: &Square<2>| {
            let e = exponential(m, 1.7);
            (0..2).map(|i| dot(&e[i], &g[i])).sum::<f64>()
        };
        let gradient = exponential_gradient(&M, 1.7, &g);
        for i in 0..2 {
            for j in 0..2 {
                let (mut plus, mut minus) = (M, M);
                plus[i][j] += 1e-5;
                minus[i][j] -= 1e-5;
                let difference = (value(&plus) - value(&minus)) / 2e-5;
                assert!((difference - gradient[i][j]).abs() < 1e-8, "{i} {j}: {difference} {gradient:?}");
            }
        }
    }

    #[test]
    fn the_ladder_halves_the_time_and_keeps_the_particular_solution() {
        let maps = Map::ladder(&M, &[1.0, 0.5], 4.0).expect("few halvings");
        let mut y = [0.3, -0.2];
        let direct = maps[0].apply(&y);
        for _ in 0..1 << (maps.len() - 1) {
            y = maps[maps.len() - 1].apply(&y);
        }
        assert!((0..2).all(|i| (y[i] - direct[i]).abs() < 1e-13), "{y:?} {direct:?}");
        assert!(Map::ladder(&M, &[0.0; 2], 1e300).is_none());
    }
}
