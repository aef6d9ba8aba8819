//! The instants at which the laws are evaluated, and series laid out there.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::super::harmonic::{Complex, times};
use super::super::period::Start;
use super::{Balancing, HARMONICS, KINKED, MOST, Sample};
use crate::model::system::{Evaluation, Forcing, MAX_STATES};
use crate::roots::regula_falsi;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Accuracy of the phase of a kink \[rad\].
const LOCATED: f64 = 1e-9;

/// Cosine and sine of the equidistant phases.
pub(super) static ROOTS: LazyLock<[Complex; MOST]> = LazyLock::new(|| {
    std::array::from_fn(|j| {
        let (sine, cosine) = (TAU * j as f64 / MOST as f64).sin_cos();
        (cosine, sine)
    })
});

/// Points and weights of Gauss's quadrature from 0 to 1.
static GAUSS: LazyLock<[Vec<(f64, f64)>; 2]> = LazyLock::new(|| KINKED.map(|(points, _)| gauss(points)));

/// Zeros of the Legendre polynomial by Newton's method, and the weights that belong to them.
fn gauss(points: usize) -> Vec<(f64, f64)> {
    let degree = points as f64;
    let point = |j: usize| {
        let mut x = -((j as f64 + 0.75) / (degree + 0.5) * 0.5 * TAU).cos();
        let mut slope = 0.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for n in 2..=points {
                let n = n as f64;
                (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
            }
            slope = degree * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..points).map(point).collect()
}

impl<const N: usize> Balancing<'_, N> {
    /// Phase of a harmonic at an instant: cosine and sine.
    pub(super) fn root(&self, harmonic: usize, instant: usize) -> Complex {
        self.roots[(self.harmonics + 1) * instant + harmonic]
    }

    /// The states at the phase with these cosines and sines of its multiples.
    fn states(&self, root: impl Fn(usize) -> Complex) -> [f64; MAX_STATES] {
        let value = sum(&self.series[..=self.harmonics], root);
        let mut z = [0.0; MAX_STATES];
        for i in 0..N {
            z[i] = value[i] * self.scales[i];
        }
        z
    }

    /// Forcing and states at a phase.
    fn at(&self, phase: f64) -> (Forcing, [f64; MAX_STATES]) {
        let (sine, cosine) = phase.sin_cos();
        let roots = powers((cosine, sine), self.harmonics);
        (self.system.forcing_at(sine, cosine), self.states(|k| roots[k]))
    }

    /// States, mode and algebraic unknown at time 0.
    pub(super) fn start(&self) -> Option<Start> {
        let (forcing, z) = self.at(0.0);
        let near = |j: &usize| self.root(1, *j).0;
        let nearest = (0..self.samples.len()).max_by(|i, j| near(i).total_cmp(&near(j)))?;
        let mut s = self.samples[nearest].s;
        let mut out = Evaluation::default();
        for _ in 0..4 {
            self.system.constraint(&forcing, &z[..N], s, self.mode, &mut out);
            s -= out.g / out.gs;
        }
        s.is_finite().then_some((z, (self.mode, s)))
    }

    /// Lays the series out at equidistant instants; the algebraic unknown as at the instants before them, or as
    /// guessed.
    pub(super) fn spread(&mut self, count: usize) {
        let before: Vec<f64> = self.samples.iter().map(|sample| sample.s).collect();
        let harmonics = count / 2 - 1;
        let stride = MOST / count;
        let places: Vec<(f64, [Complex; HARMONICS + 1])> =
            (0..count).map(|j| (1.0 / count as f64, std::array::from_fn(|k| ROOTS[k * j * stride % MOST]))).collect();
        let slip = self.slip;
        self.place(harmonics, &places, |j| {
            if before.is_empty() {
                return slip;
            }
            0.5 * (before[j / 2] + before[(j / 2 + j % 2) % before.len()])
        });
    }

    /// Lays the series out between the kinks of the motion; `None` where there are not two in a cycle.
    pub(super) fn follow_kinks(&mut self) -> Option<()> {
        const LOOKS: usize = 16;
        let kink = |phase: f64| {
            let (forcing, z) = self.at(phase);
            self.system.kink(&forcing, &z[..N])
        };
        let looks: [f64; LOOKS] = std::array::from_fn(|j| kink(TAU * j as f64 / LOOKS as f64));
        let mut kinks = [0.0; 2];
        let mut found = 0;
        for j in 0..LOOKS {
            let (low, high) = (looks[j], looks[(j + 1) % LOOKS]);
            if (low > 0.0) == (high > 0.0) {
                continue;
            }
            let bracket = [j, j + 1].map(|j| TAU * j as f64 / LOOKS as f64);
            let place = regula_falsi(kink, bracket, [low, high], (LOCATED, 0.0), 8);
            *kinks.get_mut(found)? = place;
            found += 1;
        }
        if found != 2 {
            return None;
        }
        let before: Vec<f64> = self.samples.iter().map(|sample| sample.s).collect();
        let slip = self.slip;
        let (points, harmonics) = KINKED[self.level];
        let mut places = Vec::with_capacity(2 * points);
        for (from, to) in [(kinks[0], kinks[1]), (kinks[1], kinks[0] + TAU)] {
            for (place, weight) in &GAUSS[self.level] {
                let (sine, cosine) = (from + place * (to - from)).sin_cos();
                places.push((weight * (to - from) / TAU, powers((cosine, sine), harmonics)));
            }
        }
        self.place(harmonics, &places, |j| if before.len() == 2 * points { before[j] } else { slip });
        Some(())
    }

    /// Lays the series out at instants with these weights and phases.
    fn place(&mut self, harmonics: usize, at: &[(f64, [Complex; HARMONICS + 1])], slip: impl Fn(usize) -> f64) {
        let samples = at.iter().enumerate().map(|(j, (weight, roots))| Sample {
            weight: *weight,
            forcing: self.system.forcing_at(roots[1].1, roots[1].0),
            z: self.states(|k| roots[k]),
            s: slip(j),
            rate: [0.0; N],
            slope: [[0.0; N]; N],
            excess: 0.0,
            by: [0.0; N],
            through: [0.0; N],
            margins: [0.0; 2],
        });
        self.samples = samples.collect();
        self.harmonics = harmonics;
        self.roots.clear();
        self.roots.extend(at.iter().flat_map(|(_, roots)| &roots[..=harmonics]));
    }

    /// Harmonic `k` of quantities that are given at every instant.
    pub(super) fn transform<const M: usize>(&self, k: usize, of: impl Fn(usize) -> [f64; M]) -> [Complex; M] {
        let mut sum = [(0.0, 0.0); M];
        for (j, sample) in self.samples.iter().enumerate() {
            let root = self.root(k, j);
            for (sum, value) in sum.iter_mut().zip(of(j)) {
                sum.0 += sample.weight * value * root.0;
                sum.1 -= sample.weight * value * root.1;
            }
        }
        sum
    }
}

/// Sum of the harmonics 0, 1, .. of real quantities at the phase with these cosines and sines of its multiples.
pub(super) fn sum<const M: usize>(series: &[[Complex; M]], root: impl Fn(usize) -> Complex) -> [f64; M] {
    let mut value = series[0].map(|z| z.0);
    for (k, harmonic) in series.iter().enumerate().skip(1) {
        let root = root(k);
        for (value, z) in value.iter_mut().zip(harmonic) {
            *value += 2.0 * (z.0 * root.0 - z.1 * root.1);
        }
    }
    value
}

/// Powers 0 to `most` of a number of modulus one.
fn powers(one: Complex, most: usize) -> [Complex; HARMONICS + 1] {
    let mut powers = [(1.0, 0.0); HARMONICS + 1];
    for k in 1..=most {
        powers[k] = times(powers[k - 1], one);
    }
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_integrates_polynomials_up_to_its_degree() {
        for (points, _) in KINKED {
            for power in [0, 1, 7, 2 * points - 1] {
                let sum: f64 = gauss(points).iter().map(|(x, weight)| weight * x.powi(power as i32)).sum();
                assert!((sum * (power as f64 + 1.0) - 1.0).abs() < 1e-13, "{points} points, power {power}: {sum}");
            }
        }
    }
}
