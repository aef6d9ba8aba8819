//! States known without a solver: limiting cases in closed form, and the first guesses near them.

use super::Problem;
use crate::model::system::MAX_STATES;

/// Amplitudes without contact that no motion reaches.
const MANY_SWINGS: f64 = 30.0;

/// A steady state in closed form.
#[derive(Debug, Clone, Copy)]
pub struct LimitingState {
    /// Complex amplitude of the arm \[rad\].
    pub response: (f64, f64),
    /// Whether the bristles stick, so that it is [`crate::model::lumps::Lumps::stuck_response`]; else the free one.
    pub stuck: bool,
    /// Mean angle \[rad\].
    pub mean: f64,
    /// Share of the cycle in stick.
    pub stick_fraction: f64,
    /// Extremes of the tangential force \[N\].
    pub force: (f64, f64),
}

impl Problem {
    /// The steady state where it is known in closed form: full slip under a constant friction force (case III), or
    /// bristles that stick to a roller at rest throughout (case II, started from rest). `None` where the interface
    /// changes between stick and slip or a law of the cycle is not linear.
    pub fn limiting_state(&self) -> Option<LimitingState> {
        if self.rate_element || self.laws.iter().any(|(e, p)| e.torque(p, 0.0, 0.0).is_some()) {
            return None;
        }
        let constant_friction = self.at.heat.is_none()
            && self.load_stiffness == 0.0
            && self.laws.iter().all(|(e, p)| e.friction(p, 0.0, 0.0).is_none());
        if constant_friction {
            let response = self.free;
            // Bristles that are replaced keep being stretched at this rate; the interface slips at what is left of V.
            let relaxing = self.cc + if self.k1 > 0.0 { self.k1 / self.branch_rate } else { 0.0 };
            let stretching = self.mu * self.load * self.renewal / (self.kc + self.renewal * relaxing);
            if self.speed - stretching > self.b * self.omega * response.0.hypot(response.1) {
                let force = self.mu * self.load;
                let mean = self.b * force * self.inverse_inertia / self.k;
                return Some(LimitingState {
                    response,
                    stuck: false,
                    mean,
                    stick_fraction: 0.0,
                    force: (force, force),
                });
            }
        }
        if self.speed == 0.0 && !self.own_bristles && !self.hysteretic && self.continuum().is_none() {
            let stuck = self.static_contact();
            let (mu, ..) = self.friction(0.0, 0.0, 0.0);
            let swing = self.load_stiffness.abs() * self.b * stuck.response.0.hypot(stuck.response.1);
            if stuck.force.1 < mu * (self.load - swing) {
                return Some(stuck);
            }
        }
        None
    }

    /// Whether no motion of the arm that is worth looking for takes the load off the contact.
    pub(super) fn never_lifts(&self) -> bool {
        let static_angle = self.b * self.mu * self.load * self.inverse_inertia / self.k;
        let swing = MANY_SWINGS * self.stroke / self.b;
        self.load_stiffness.abs() * self.b * (2.0 * static_angle + swing) < self.load
    }

    /// Case II: bristles that stick to a roller at rest throughout, started from rest.
    pub(super) fn static_contact(&self) -> LimitingState {
        let (free, response): (_, (f64, f64)) = (self.free, self.lumps.stuck_response());
        // The force makes up the difference to the free arm: b F = (K - J w^2 + i w C)(A - A_free).
        let (re, im) = (free.0 - response.0, free.1 - response.1);
        let w = self.omega;
        let impedance = (self.k - w * w).hypot(w * self.c) / (self.inverse_inertia * self.b);
        let force = impedance * re.hypot(im);
        LimitingState { response, stuck: true, mean: 0.0, stick_fraction: 1.0, force: (-force, force) }
    }

    /// The stuck motion (case II) of a contact whose strength grows without bound while it rests on a roller at rest:
    /// once it rests it never slips again. `None` where the strength is bounded.
    pub fn locked_state(&self) -> Option<LimitingState> {
        let linear =
            !self.own_bristles && !self.hysteretic && self.laws.iter().all(|(e, p)| e.torque(p, 0.0, 0.0).is_none());
        let grows = self.at.psi.is_some() && {
            let aged = |age: f64| self.friction(0.0, age * self.psi_scale, 0.0).0;
            aged(1e12) > aged(1e9)
        };
        (self.speed == 0.0 && grows && linear && !self.rate_element && self.load_stiffness == 0.0)
            .then(|| self.static_contact())
    }

    /// Mean angle of the arm and normal load under sliding friction `mu`: K th = torque(th) + b F, the load and the
    /// torque depending on the angle. The load given, where there is no such equilibrium.
    pub(super) fn deflection(&self, mu: f64) -> (f64, f64) {
        let drag = self.sigma2 * self.speed;
        let (coupling, stiffness) = (self.load_stiffness * self.b, self.k / self.inverse_inertia);
        let linear = self.b * (mu * self.load + drag) / stiffness;
        let mut th = linear;
        for _ in 0..20 {
            let mut balance = self.b * (mu * (self.load + coupling * th) + drag) - stiffness * th;
            let mut slope = self.b * mu * coupling - stiffness;
            for law in self.laws.iter().filter_map(|(e, p)| e.torque(p, th, 0.0)) {
                balance += law.value;
                slope += law.d_first;
            }
            if slope >= 0.0 {
                break;
            }
            th -= balance / slope;
            if balance.abs() < 1e-12 * (stiffness * th).abs() {
                return (th, (self.load + coupling * th).max(0.0));
            }
        }
        (linear, self.load)
    }

    /// Stretch of bristles at rest under a force: kc x + law(x) = F, or that of the stiffness alone where there is
    /// none.
    pub(super) fn stretch_under(&self, force: f64) -> f64 {
        let stiffness = self.kc + self.cc * self.renewal;
        let linear = force / stiffness;
        if !self.own_bristles {
            return linear;
        }
        let mut stretch = linear;
        for _ in 0..50 {
            let law = self.bristle_law(stretch, 0.0);
            let step = (force - stiffness * stretch - law.value) / (stiffness + law.d_first);
            stretch += step;
            if step.abs() <= 1e-12 * stretch.abs() {
                return stretch;
            }
        }
        linear
    }

    /// State at time 0 of the motion with the bristles stuck to a roller at rest, where friction can hold them.
    pub(super) fn stuck_state(&self) -> Option<[f64; MAX_STATES]> {
        let w = self.omega;
        let (free, stuck): (_, (f64, f64)) = (self.free, self.lumps.stuck_response());
        let apart = (stuck.0 - free.0, stuck.1 - free.1);
        let scale = 1.0 / (self.inverse_inertia * self.b);
        // F = (K - J w^2 + i w C) (stuck - free)/b
        let force = times(apart, (scale * (self.k - w * w), scale * w * self.c));
        if force.0.hypot(force.1) > self.mu * self.load {
            return None;
        }
        let mut y = (0.0, 0.0);
        let mut z = [0.0; MAX_STATES];
        (z[0], z[1]) = (apart.1, w * apart.0);
        if let Some(i) = self.at.roller {
            // m y'' + c y' + k y = -F
            let [inverse, c, k] = self.support;
            let d = (k - w * w, w * c);
            y = times((-inverse * force.0, -inverse * force.1), (d.0, -d.1));
            y = (y.0 / (d.0 * d.0 + d.1 * d.1), y.1 / (d.0 * d.0 + d.1 * d.1));
            (z[i], z[i + 1]) = (y.1, w * y.0);
        }
        let stretch = (y.0 - self.b * stuck.0, y.1 - self.b * stuck.1);
        z[self.at.x] = stretch.1;
        if let Some(i) = self.at.q {
            // q = k1 x i w/(1/tau + i w)
            let gain = self.k1 * w / (self.branch_rate * self.branch_rate + w * w);
            z[i] = gain * (w * stretch.1 + self.branch_rate * stretch.0);
        }
        if let Some(i) = self.at.psi {
            z[i] = self.psi_scale;
        }
        Some(z)
    }

    pub(super) fn steady_interface_state(&self, s: f64) -> f64 {
        let rate = |psi: f64| self.laws.iter().find_map(|(e, p)| e.interface_rate(p, s, psi));
        match rate(0.0) {
            Some(law) if law.d_second < 0.0 => -law.value / law.d_second,
            _ => 1.0,
        }
    }
}

/// Product of two complex numbers (real, imaginary).
fn times(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}
