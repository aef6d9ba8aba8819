//! Whether disturbances of a motion in one mode die out.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::super::dense;
use super::super::exponential::{Square, exponential, multiply, unit};
use super::{Balancing, Sample, larger};
use crate::model::system::{MAX_STATES, Mode};
use std::f64::consts::TAU;

/// Largest modulus of the Floquet multipliers of a motion that is stable beyond doubt, by a bound and by a product over
/// few instants, which counts fast changes of the slopes too little; of other motions shooting knows more.
const STABLE: f64 = 1.0 - 1e-4;
const SURELY_STABLE: f64 = 0.99;

impl<const N: usize> Balancing<'_, N> {
    /// Whether every disturbance dies out, by the Floquet multipliers.
    pub(super) fn is_stable(&self) -> bool {
        let period = TAU / self.omega;
        let mean = self.mean_slopes();
        let change = |sample: &Sample<N>| -> f64 {
            let rows = sample.slope.iter().zip(&mean);
            rows.map(|(row, mean)| row.iter().zip(mean).map(|(a, b)| (a - b).abs()).sum()).fold(0.0, larger)
        };
        // At resonances of the disturbances with the drive a change of the slopes shifts the multipliers in first
        // order.
        let shift = 2.0 * period * self.samples.iter().map(change).fold(0.0, larger);
        if self.radius(exponential(&mean, period)) + shift < STABLE {
            return true;
        }
        let mut monodromy: Square<N> = unit();
        for sample in &self.samples {
            monodromy = multiply(&exponential(&sample.slope, sample.weight * period), &monodromy);
        }
        self.radius(monodromy) < SURELY_STABLE
    }

    /// Largest modulus of the multipliers; no number where a disturbance grows beyond all numbers within a cycle.
    fn radius(&self, monodromy: Square<N>) -> f64 {
        let mut matrix = [[0.0; MAX_STATES]; MAX_STATES];
        for (row, of) in matrix.iter_mut().zip(&self.at_rest(monodromy)) {
            row[..N].copy_from_slice(of);
        }
        dense::spectral_radius(N, matrix)
    }

    /// The disturbances that a contact at rest lets live: it keeps what it came to rest with.
    fn at_rest(&self, mut monodromy: Square<N>) -> Square<N> {
        if self.mode == Mode::Stick {
            for (i, rest) in self.system.resting_state(&self.samples[0].z)[..N].iter().enumerate() {
                let Some((_, gradient)) = rest else { continue };
                for m in 0..N {
                    let by = std::mem::take(&mut monodromy[m][i]) / (gradient[i] * self.scales[i]);
                    for j in (0..N).filter(|&j| j != i) {
                        monodromy[m][j] -= by * gradient[j] * self.scales[j];
                    }
                }
                monodromy[i] = [0.0; N];
            }
        }
        monodromy
    }
}
