//! Derivatives of a motion in one mode by the parameters.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::super::exponential::{Square, apply};
use super::super::harmonic::{Complex, times};
use super::instants::sum;
use super::{Balancing, HARMONICS, ITERATIONS, larger};
use crate::model::system::{MAX_COLUMNS, MAX_STATES, ParameterColumns};

impl<const N: usize> Balancing<'_, N> {
    /// Derivatives of the fundamental by the columns, by the adjoint method: the equations of the adjoint are solved by
    /// the same iteration, for the real and the imaginary part in turn.
    pub(super) fn columns(&self) -> Option<Vec<Complex>> {
        // A = (2i/T) integral of z e^{-iwt}
        let functional = |part: fn(Complex) -> f64| -> Vec<f64> {
            (0..self.samples.len()).map(|j| 2.0 * part(self.root(1, j))).collect()
        };
        let (re, im) = (functional(|root| root.1), functional(|root| root.0));
        let (re, im) = (self.adjoint(&re)?, self.adjoint(&im)?);
        let mut out = vec![(0.0, 0.0); self.system.columns()];
        let mut columns = ParameterColumns { f: [[0.0; MAX_STATES]; MAX_COLUMNS], g: [0.0; MAX_COLUMNS] };
        for ((sample, re), im) in self.samples.iter().zip(&re).zip(&im) {
            self.system.parameter_columns(&sample.forcing, &sample.z[..N], sample.s, self.mode, &mut columns);
            for (out, (f, g)) in out.iter_mut().zip(columns.f.iter().zip(&columns.g)) {
                for i in 0..N {
                    let rate = sample.weight * (f[i] - sample.through[i] * g) * self.scales[0] / self.scales[i];
                    out.0 += re[i] * rate;
                    out.1 += im[i] * rate;
                }
            }
        }
        Some(out)
    }

    /// l with (-d/dt - A^T) l = `functional` in the first state.
    fn adjoint(&self, functional: &[f64]) -> Option<Vec<[f64; N]>> {
        let (count, harmonics) = (self.samples.len(), self.harmonics);
        let transposed: Square<N> = std::array::from_fn(|i| std::array::from_fn(|j| self.mean_slope[j][i]));
        let mut adjoint = vec![[0.0; N]; count];
        let mut before = f64::INFINITY;
        for round in 0..4 * ITERATIONS {
            // (-d/dt - A_mean^T) l = functional + (A - A_mean)^T l
            let mut right = vec![[0.0; N]; count];
            for (j, sample) in self.samples.iter().enumerate() {
                let l = &adjoint[j];
                let steady = apply(&transposed, l);
                for i in 0..N {
                    right[j][i] = -steady[i];
                    for m in 0..N {
                        right[j][i] += sample.slope[m][i] * l[m];
                    }
                }
                right[j][0] += functional[j];
            }
            let mut series = [[(0.0, 0.0); N]; HARMONICS + 1];
            for k in 0..=harmonics {
                let of = self.transform(k, |j| right[j]);
                let by = &self.resolvents[k];
                for i in 0..N {
                    for m in 0..N {
                        // Transposed and conjugate.
                        let part = times((by[m][i].0, -by[m][i].1), of[m]);
                        series[k][i] = (series[k][i].0 + part.0, series[k][i].1 + part.1);
                    }
                }
            }
            let next: Vec<[f64; N]> = (0..count).map(|j| sum(&series[..=harmonics], |k| self.root(k, j))).collect();
            let (mut size, mut most) = (0.0f64, 0.0f64);
            for (next, last) in next.iter().flatten().zip(adjoint.iter().flatten()) {
                size = larger(size, (next - last).abs());
                most = larger(most, next.abs());
            }
            adjoint = next;
            if size < 1e-10 * most {
                return Some(adjoint);
            }
            if !size.is_finite() || (round > 4 && size > before) {
                return None;
            }
            before = size;
        }
        None
    }
}
