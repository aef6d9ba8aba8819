//! A power of the frequency as a sum of relaxations, for an integration in time.
//!
//! K (i w/w0)^a = K sin(pi a)/pi int (r/w0)^a i w/(i w + r) d ln r, summed at equal steps of ln r; the slower rest as a
//! spring and one relaxation, the faster one as a dashpot and one relaxation, with the same first three moments.

use std::f64::consts::{FRAC_PI_2, PI};

/// Steps of ln r: the sum over all of them is off by 2 sin(pi a) exp(-pi^2/step), 1e-5 at most.
const STEP: f64 = 0.8;
/// The slowest and the fastest of the relaxations summed one by one, in steps from w0: from 0.2 to 120 times w0.
const FROM: i32 = -2;
const TO: i32 = 6;
/// Relaxations in all.
pub const RELAXATIONS: usize = (TO - FROM + 3) as usize;

/// Spring, dashpot and relaxations side by side.
#[derive(Debug, Clone)]
pub struct Relaxations {
    /// Stiffness of what is too slow to relax \[N/m\]. It shifts the mean stretch, and no force.
    pub spring: f64,
    /// Damping of what is too fast to hold \[N s/m\].
    pub dashpot: f64,
    /// Stiffness \[N/m\] and rate \[1/s\] of every relaxation.
    pub branches: [(f64, f64); RELAXATIONS],
}

impl Relaxations {
    /// Those of the stiffness K i^a at the angular frequency `omega` (in phase, in quadrature; 0 < a < 1). Within 1e-5
    /// at its first ten multiples, 1e-3 up to the fiftieth.
    pub fn new((re, im): (f64, f64), omega: f64) -> Self {
        let order = im.atan2(re) / FRAC_PI_2;
        let scale = re.hypot(im) * (PI * order).sin() / PI * STEP;
        // Sum of exp(power n) from the step `n` on outwards.
        let rest =
            |power: f64, n: i32| scale * (power * STEP * f64::from(n)).exp() / (1.0 - (-power.abs() * STEP).exp());
        let slow = [0.0, 1.0, 2.0].map(|moment| rest(order + moment, FROM - 1));
        let fast = [1.0, 2.0, 3.0].map(|moment| rest(order - moment, TO + 1));
        let slow_branch = (slow[1] * slow[1] / slow[2], slow[2] / slow[1]);
        let fast_rate = fast[1] / fast[2];
        let fast_branch = (fast[1] * fast_rate * fast_rate, fast_rate);
        let branches = std::array::from_fn(|i| {
            let (stiffness, rate) = match i32::try_from(i).unwrap_or(0) + FROM - 1 {
                n if n < FROM => slow_branch,
                n if n > TO => fast_branch,
                n => (scale * (order * STEP * f64::from(n)).exp(), (STEP * f64::from(n)).exp()),
            };
            (stiffness, rate * omega)
        });
        let dashpot = fast[0] - fast_branch.0 / fast_branch.1;
        Self { spring: slow[0] - slow_branch.0, dashpot: dashpot / omega, branches }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_is_the_power_over_the_harmonics() {
        for order in [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98] {
            let (sine, cosine) = (FRAC_PI_2 * order).sin_cos();
            let found = Relaxations::new((5.0 * cosine, 5.0 * sine), 400.0);
            assert!(
                found.spring >= 0.0 && found.dashpot >= 0.0 && found.branches.iter().all(|b| b.0 > 0.0 && b.1 > 0.0)
            );
            for (harmonic, close) in [(1.0, 2e-5), (2.0, 1e-5), (5.0, 1e-5), (10.0, 1e-5), (20.0, 3e-5), (50.0, 1e-3)] {
                let w = 400.0 * harmonic;
                let start = (found.spring, w * found.dashpot);
                let (re, im) = found.branches.iter().fold(start, |(re, im), (k, r)| {
                    let square = w * w + r * r;
                    (re + k * w * w / square, im + k * w * r / square)
                });
                let size = 5.0 * f64::powf(harmonic, order);
                let error = (re - size * cosine).hypot(im - size * sine) / size;
                assert!(error < close, "{order} {harmonic}: {error:e}");
            }
        }
    }
}
