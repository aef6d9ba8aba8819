//! Closed forms of a harmonic oscillator (paper Eqs. 9-16) and their extremes.

pub use crate::statistics::wrap;
use std::f64::consts::TAU;

/// A damped oscillator driven by the torque Gamma e^{i phi0} = torque (k0 + i c0 w) (paper Eq. 8).
#[derive(Debug, Clone, Copy)]
pub struct Oscillator {
    /// J \[kg m^2\].
    pub inertia: f64,
    /// C \[N m s/rad\].
    pub damping: f64,
    /// K \[N m/rad\].
    pub stiffness: f64,
    /// a u0, lever times amplitude of the actuator \[m^2\].
    pub lever: f64,
    /// k0 \[N/m\].
    pub spring_stiffness: f64,
    /// c0 \[N s/m\].
    pub spring_damping: f64,
}

impl Oscillator {
    /// alpha \[rad\] and phi \[rad\] in (-pi, pi] at the frequency `f` \[Hz\]; the arctangent of Eq. 10 read with two
    /// arguments.
    pub fn response(&self, f: f64) -> (f64, f64) {
        let w = TAU * f;
        let gamma = self.lever * self.spring_stiffness.hypot(self.spring_damping * w);
        let phi0 = (self.spring_damping * w).atan2(self.spring_stiffness);
        let (re, im) = (self.stiffness - self.inertia * w * w, self.damping * w);
        (gamma / re.hypot(im), wrap(phi0 - im.atan2(re)))
    }

    /// Frequency \[Hz\] and height of the largest value of alpha times w^`power` in `from..to` \[Hz\], by golden
    /// section around the largest point of a fine grid.
    pub fn peak(&self, from: f64, to: f64, power: i32) -> (f64, f64) {
        let value = |f: f64| self.response(f).0 * (TAU * f).powi(power);
        let grid = |i: usize| from + (to - from) * i as f64 / 400.0;
        let best = (0..=400).max_by(|&i, &j| value(grid(i)).total_cmp(&value(grid(j)))).unwrap_or(0);
        let (mut low, mut high) = (grid(best.saturating_sub(1)), grid((best + 1).min(400)));
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        for _ in 0..60 {
            let (x1, x2) = (high - golden * (high - low), low + golden * (high - low));
            if value(x1) > value(x2) { high = x2 } else { low = x1 }
        }
        let f = 0.5 * (low + high);
        (f, value(f))
    }
}
