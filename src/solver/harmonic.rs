//! Parts in sin wt and cos wt: complex numbers as pairs, resolvents, particular solutions, integrals.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::exponential::Square;

/// A complex number (real, imaginary).
pub type Complex = (f64, f64);

/// Integrals of sin^2 wt, cos^2 wt and sin wt cos wt over a stretch of length `time`.
pub fn products(omega: f64, time: f64, from: (f64, f64), to: (f64, f64)) -> [f64; 3] {
    let wave = (to.0 * to.1 - from.0 * from.1) / (2.0 * omega);
    [0.5 * time - wave, 0.5 * time + wave, (to.0 * to.0 - from.0 * from.0) / (2.0 * omega)]
}

/// (iw - M)^-1 by elimination; `None` where it is singular.
pub fn resolvent<const N: usize>(m: &Square<N>, omega: f64) -> Option<[[Complex; N]; N]> {
    let mut a: [[Complex; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| (-m[i][j], if i == j { omega } else { 0.0 })));
    let mut inverse: [[Complex; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| (f64::from(u8::from(i == j)), 0.0)));
    let square = |z: Complex| z.0 * z.0 + z.1 * z.1;
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| square(a[i][k]).total_cmp(&square(a[j][k])))?;
        a.swap(k, pivot);
        inverse.swap(k, pivot);
        let size = square(a[k][k]);
        if size < 1e-18 * omega * omega || !size.is_finite() {
            return None;
        }
        let reciprocal = (a[k][k].0 / size, -a[k][k].1 / size);
        a[k] = a[k].map(|z| times(z, reciprocal));
        inverse[k] = inverse[k].map(|z| times(z, reciprocal));
        for i in 0..N {
            let factor = a[i][k];
            if i == k || factor == (0.0, 0.0) {
                continue;
            }
            for j in 0..N {
                let (x, y) = (times(factor, a[k][j]), times(factor, inverse[k][j]));
                a[i][j] = (a[i][j].0 - x.0, a[i][j].1 - x.1);
                inverse[i][j] = (inverse[i][j].0 - y.0, inverse[i][j].1 - y.1);
            }
        }
    }
    Some(inverse)
}

/// Product of two complex numbers.
#[inline]
pub fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// (ps, pc) from those parts of the forcing: P = R m with P = ps + i pc.
pub fn particular<const N: usize>(resolvent: &[[Complex; N]; N], forced: &[[f64; N]; 2]) -> [[f64; N]; 2] {
    let mut out = [[0.0; N]; 2];
    for i in 0..N {
        for j in 0..N {
            let p = times(resolvent[i][j], (forced[0][j], forced[1][j]));
            out[0][i] += p.0;
            out[1][i] += p.1;
        }
    }
    out
}
