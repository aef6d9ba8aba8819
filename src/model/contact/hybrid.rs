//! The equations as the shooting solver sees them: rates, constraint, Jacobians, modes and their ends.

use super::Problem;
use crate::model::system::{Affine, Evaluation, Forcing, HybridSystem, MAX_STATES, Mode, ParameterColumns};

/// Slip rate, relative to its scale, from which on the branch beyond a weakening threshold is looked for.
const SMALL_SLIP: f64 = 1e-6;

impl Problem {
    /// The constraint of slip in direction `sign`: the bristles pull as hard as friction holds; what is zero is left as
    /// it is.
    fn slip_at_limit(&self, forcing: &Forcing, z: &[f64], s: f64, sign: f64, out: &mut Evaluation) {
        let (x, b) = (self.at.x, self.b);
        let th = forcing.angle + z[0];
        let v = self.relative_speed(forcing, z);
        let normal = (self.load + self.load_stiffness * b * th).max(0.0);
        let force = self.pull(z, v, v - s);
        let friction = self.friction(sign * s, self.state(self.at.psi, z), self.state(self.at.heat, z));
        let (mu, mu_s, mu_psi, mu_heat, _) = friction;
        let scale = 1.0 / self.force_scale();
        out.g = scale * (force - sign * mu * normal);
        let own = self.bristle_law(z[x], v - s);
        let force_v = scale * (self.cc + self.sigma2 + own.d_second);
        out.gz[1] = -b * force_v;
        out.gz[x] = scale * (self.kc + own.d_first);
        if normal > 0.0 {
            out.gz[0] = -scale * sign * mu * self.load_stiffness * b;
        }
        if let Some(i) = self.at.roller {
            out.gz[i + 1] = force_v;
        }
        if let Some(i) = self.at.q {
            out.gz[i] = scale;
        }
        if let Some(i) = self.at.psi {
            out.gz[i] = -scale * sign * mu_psi * normal;
        }
        if let Some(i) = self.at.heat {
            out.gz[i] = -scale * sign * mu_heat * normal;
        }
        out.gs = -scale * (self.cc + own.d_second + mu_s * normal);
    }

    /// The constraint of a rate element, over which the interface slips all the time, in direction `sign`.
    fn slip_of_rate_element(&self, forcing: &Forcing, z: &[f64], s: f64, sign: f64, out: &mut Evaluation) {
        let (x, b) = (self.at.x, self.b);
        // s = kc |v| x / (mu N), with |v| continued beyond the end of the mode and mu as it is there: s is smooth.
        let p = self.point(forcing, z, s);
        let speed = sign * p.v;
        let (mu, mu_s, mu_psi, mu_heat, _) =
            self.friction(speed.max(0.0), self.state(self.at.psi, z), self.state(self.at.heat, z));
        let mu_s = if speed < 0.0 { 0.0 } else { mu_s };
        let normal_th = if p.loaded { self.load_stiffness * b } else { 0.0 };
        let mut rate_z = [0.0; MAX_STATES];
        rate_z[1] = -b;
        if let Some(i) = self.at.roller {
            rate_z[i + 1] = 1.0;
        }
        let limit = (mu * p.normal).max(1e-12 * self.force_scale());
        let flow = self.kc * z[x] / limit;
        let scale = 1.0 / self.slip_scale();
        out.g = scale * (s - flow * speed);
        let by_limit = flow * speed / limit;
        let by_speed = sign * (-flow + by_limit * mu_s * p.normal);
        for (gz, rate) in out.gz.iter_mut().zip(&rate_z) {
            *gz = by_speed * rate;
        }
        out.gz[x] -= self.kc * speed / limit;
        out.gz[0] += by_limit * mu * normal_th;
        if let Some(i) = self.at.psi {
            out.gz[i] += by_limit * mu_psi * p.normal;
        }
        if let Some(i) = self.at.heat {
            out.gz[i] += by_limit * mu_heat * p.normal;
        }
        out.gz = out.gz.map(|g| scale * g);
        out.gs = scale;
    }
}

impl HybridSystem for Problem {
    fn states(&self) -> usize {
        self.at.states
    }

    fn period(&self) -> f64 {
        std::f64::consts::TAU / self.omega
    }

    fn damping_ratio(&self) -> f64 {
        let [_, c, k] = self.support;
        let support = if self.at.roller.is_some() { 0.5 * c / k.sqrt() } else { f64::INFINITY };
        support.min(0.5 * self.c / self.k.abs().sqrt())
    }

    fn scales(&self) -> [f64; MAX_STATES] {
        let mut scales = [1.0; MAX_STATES];
        let angle = self.stroke / self.b;
        scales[0] = angle;
        scales[1] = self.omega * angle;
        scales[self.at.x] = self.stroke;
        if let Some(i) = self.at.roller {
            scales[i] = self.stroke;
            scales[i + 1] = self.omega * self.stroke;
        }
        if let Some(i) = self.at.heat {
            let rise = self.heating_gain / self.cooling_rate * self.mu * self.load;
            scales[i] = rise * (self.speed + self.slip_scale());
        }
        if let Some(i) = self.at.q {
            scales[i] = self.k1 * self.stroke;
        }
        if let Some(i) = self.at.psi {
            scales[i] = self.psi_scale;
        }
        // A state that a strength of zero keeps at rest has no scale of its own.
        scales.map(|scale| if scale > 0.0 { scale } else { 1.0 })
    }

    fn slip_scale(&self) -> f64 {
        self.omega * self.stroke
    }

    fn forcing_at(&self, sine: f64, cosine: f64) -> Forcing {
        let (re, im) = self.free;
        Forcing { sine, cosine, angle: re * sine + im * cosine, velocity: self.omega * (re * cosine - im * sine) }
    }

    fn is_kinked(&self) -> bool {
        self.laws.iter().any(|(effect, _)| effect.torque_is_kinked() || !effect.is_smooth())
    }

    fn kink(&self, forcing: &Forcing, z: &[f64]) -> f64 {
        forcing.velocity + z[1]
    }

    fn is_smooth(&self) -> bool {
        self.never_lifts() && self.laws.iter().all(|(effect, _)| effect.is_smooth())
    }

    // Long: a branch for each kind of row; what they share is evaluated once, in the innermost loop of every integration.
    fn rates(&self, rows: &[usize], forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut Evaluation) {
        let v = self.relative_speed(forcing, z);
        let d = v - if mode == Mode::Stick { 0.0 } else { s };
        let force = self.pull(z, v, d);
        let (x, b) = (self.at.x, self.b);
        // Gradient of F by (w, u, x, q, s).
        let own = self.bristle_law(z[x], d);
        let force_v = self.cc + self.sigma2 + own.d_second;
        let mut force_z = [0.0; MAX_STATES];
        force_z[1] = -b * force_v;
        force_z[x] = self.kc + own.d_first;
        // Relative speed of the bristles' ends.
        let mut rate_z = [0.0; MAX_STATES];
        rate_z[1] = -b;
        if let Some(i) = self.at.roller {
            force_z[i + 1] = force_v;
            rate_z[i + 1] = 1.0;
        }
        if let Some(i) = self.at.q {
            force_z[i] = 1.0;
        }
        let force_s = -(self.cc + own.d_second);
        // The slip rate that friction works on: that of the interface, or the relative speed for a rate element.
        let slip = if self.rate_element { v } else { s };
        for &i in rows {
            let (f, fz, fs) = (&mut out.f[i], &mut out.fz[i], &mut out.fs[i]);
            let place = Some(i);
            if i == 0 || place == self.at.roller {
                *f = z[i + 1];
                *fz = [0.0; MAX_STATES];
                fz[i + 1] = 1.0;
                *fs = 0.0;
            } else if i == 1 {
                let torque = self.torque(forcing.angle + z[0], forcing.velocity + z[1]);
                let gain = self.inverse_inertia * b;
                *f = -self.c * z[1] - self.k * z[0] + self.inverse_inertia * (b * force + torque.value);
                *fz = force_z.map(|f| gain * f);
                fz[0] += -self.k + self.inverse_inertia * torque.d_first;
                fz[1] += -self.c + self.inverse_inertia * torque.d_second;
                *fs = gain * force_s;
            } else if i == x {
                *f = d - self.renewal * z[x];
                *fz = rate_z;
                fz[x] = -self.renewal;
                *fs = -1.0;
            } else if place == self.at.q {
                *f = self.k1 * d - self.branch_rate * z[i];
                *fz = rate_z.map(|r| self.k1 * r);
                fz[i] -= self.branch_rate;
                *fs = -self.k1;
            } else if place == self.at.heat {
                let gain = self.heating_gain;
                *f = gain * force * slip - self.cooling_rate * z[i];
                for j in 0..self.at.states {
                    let slip_z = if self.rate_element { rate_z[j] } else { 0.0 };
                    fz[j] = gain * (force_z[j] * slip + force * slip_z);
                }
                fz[i] -= self.cooling_rate;
                *fs = gain * (force_s * slip + if self.rate_element { 0.0 } else { force });
            } else if place == self.at.psi {
                let sign = Self::sign(mode);
                let law = self.interface_rate(sign * slip, z[i]);
                *f = law.value;
                let slope = law.d_first * sign;
                *fz = if self.rate_element { rate_z.map(|r| slope * r) } else { [0.0; MAX_STATES] };
                fz[i] += law.d_second;
                *fs = if self.rate_element { 0.0 } else { slope };
            } else {
                // The speed of the roller: the only row left.
                let [inverse, c, k] = self.support;
                *f = -inverse * force - c * z[i] - k * z[i - 1];
                *fz = force_z.map(|f| -inverse * f);
                fz[i - 1] -= k;
                fz[i] -= c;
                *fs = -inverse * force_s;
            }
        }
    }

    fn constraint(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut Evaluation) {
        out.gz = [0.0; MAX_STATES];
        match mode {
            Mode::Stick => {
                let scale = 1.0 / self.slip_scale();
                out.g = s * scale;
                out.gs = scale;
            }
            Mode::SlipForward | Mode::SlipBackward => self.slip_at_limit(forcing, z, s, Self::sign(mode), out),
            Mode::RateForward | Mode::RateBackward => self.slip_of_rate_element(forcing, z, s, Self::sign(mode), out),
        }
    }

    fn affine(&self, mode: Mode) -> Affine {
        let (friction, own_bristles) = (!self.friction_is_constant(), self.own_bristles);
        let (torque, heated) = (self.laws.iter().any(|(e, p)| e.torque(p, 0.0, 0.0).is_some()), self.at.heat.is_some());
        let stick = mode == Mode::Stick;
        let mut rows = [true; MAX_STATES];
        rows[1] = !torque && !own_bristles;
        if let Some(i) = self.at.heat {
            rows[i] = stick;
        }
        if let Some(i) = self.at.psi {
            rows[i] = false;
        }
        // Friction in proportion to a load that the arm moves, as long as it cannot lift off.
        let constant = !heated && self.at.psi.is_none() && self.never_lifts();
        match mode {
            Mode::Stick => Affine { rows, constraint: true, margins: constant && !own_bristles },
            Mode::SlipForward | Mode::SlipBackward => {
                let constraint = constant && !friction && !own_bristles && self.cc > 0.0;
                Affine { rows, constraint, margins: true }
            }
            Mode::RateForward | Mode::RateBackward => Affine { rows, constraint: false, margins: true },
        }
    }

    fn margins(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode) -> [f64; 2] {
        let alone = |margin: f64| [margin, margin];
        match mode {
            Mode::Stick => {
                let p = self.point(forcing, z, 0.0);
                let scale = 1.0 / self.force_scale();
                [(p.mu * p.normal - p.force) * scale, (p.mu * p.normal + p.force) * scale]
            }
            Mode::SlipForward | Mode::SlipBackward => alone(Self::sign(mode) * s / self.slip_scale()),
            Mode::RateForward | Mode::RateBackward => {
                alone(Self::sign(mode) * self.point(forcing, z, s).v / self.slip_scale())
            }
        }
    }

    fn next_mode(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode) -> (Mode, f64) {
        match mode {
            Mode::RateForward => (Mode::RateBackward, s),
            Mode::RateBackward => (Mode::RateForward, s),
            Mode::Stick => {
                let forward = self.point(forcing, z, 0.0).force > 0.0;
                let (mode, sign) = if forward { (Mode::SlipForward, 1.0) } else { (Mode::SlipBackward, -1.0) };
                let psi = self.state(self.at.psi, z);
                let (_, slope, ..) = self.friction(0.0, psi, self.state(self.at.heat, z));
                let p = self.point(forcing, z, 0.0);
                let resistance = self.cc + self.bristle_law(z[self.at.x], p.d).d_second + slope * p.normal;
                let s = if resistance < 0.0 {
                    // Weakening steeper than the bristles' damping: the slip rate jumps to the next stable branch.
                    // Looked for from a small rate, since the force at the end of stick is at its limit to rounding
                    // only.
                    let small = SMALL_SLIP * self.slip_scale();
                    sign * self.slip_root_above(forcing, z, sign, (0.0, small)).unwrap_or(0.0)
                } else if resistance == 0.0 {
                    // Nothing damps the bristles: they stop stretching at once.
                    p.v
                } else {
                    0.0
                };
                (mode, s)
            }
            Mode::SlipForward | Mode::SlipBackward => {
                if self.point(forcing, z, 0.0).normal <= 0.0 {
                    let opposite = if mode == Mode::SlipForward { Mode::SlipBackward } else { Mode::SlipForward };
                    return (opposite, 0.0);
                }
                (Mode::Stick, 0.0)
            }
        }
    }

    fn project(&self, forcing: &Forcing, z: &mut [f64]) -> Option<usize> {
        if !self.instant_slip() {
            return None;
        }
        // Without damping the bristles' force cannot exceed the friction force even for an instant.
        let p = self.point(forcing, z, 0.0);
        let excess = p.force.abs() - p.mu * p.normal;
        (excess > 0.0).then(|| {
            z[self.at.x] -= excess.copysign(p.force) / self.kc;
            self.at.x
        })
    }

    fn enter(&self, forcing: &Forcing, z: &[f64], last: Option<(Mode, f64)>) -> (Mode, f64) {
        let p = self.point(forcing, z, 0.0);
        if self.rate_element {
            let flow = self.kc * z[self.at.x] / (p.mu * p.normal).max(1e-12 * self.force_scale());
            let mode = if p.v >= 0.0 { Mode::RateForward } else { Mode::RateBackward };
            return (mode, flow * p.v.abs());
        }
        let slip = |sign: f64, s: f64| (if sign > 0.0 { Mode::SlipForward } else { Mode::SlipBackward }, sign * s);
        let limit = p.mu * p.normal;
        let slack = 1e-9 * self.force_scale();
        let pull = p.force.signum();
        if self.instant_slip() {
            let slips = p.force.abs() > limit + slack || (p.force.abs() > limit - slack && pull * p.v > 0.0);
            return if slips { (slip(pull, 0.0).0, p.v) } else { (Mode::Stick, 0.0) };
        }
        // Slip goes on where it can, also at forces at which a contact at rest would hold.
        let going = match last {
            Some((Mode::Stick, _)) => None,
            Some((mode, s)) => Some((Self::sign(mode), s.abs())),
            None if self.speed > 0.0 => Some((1.0, p.v.abs().max(self.speed))),
            None => None,
        };
        if let Some((sign, s)) = going
            && let Some(root) = self.slip_root_near(forcing, z, sign, s)
        {
            return slip(sign, root);
        }
        if p.force.abs() > limit + slack {
            slip(pull, self.slip_root(forcing, z, pull).unwrap_or(0.0))
        } else {
            (Mode::Stick, 0.0)
        }
    }

    fn locks(&self, z: &[f64]) -> bool {
        let (mu, ..) = self.friction(0.0, self.state(self.at.psi, z), 0.0);
        self.locked_state().is_some_and(|locked| locked.force.1 < mu * self.load)
    }

    fn age_at_rest(&self) -> Option<usize> {
        // Beside heat or another law of friction a contact that would hold may slip on all the same.
        let laws = self.laws.iter().filter(|(e, p)| e.friction(p, 0.0, 0.0).is_some()).count();
        self.locked_state().and(self.at.psi).filter(|_| laws == 1 && self.at.heat.is_none())
    }

    fn initial_state(&self) -> [f64; MAX_STATES] {
        let mut z = [0.0; MAX_STATES];
        if self.speed == 0.0 {
            if let Some(stuck) = self.stuck_state() {
                return stuck;
            }
            // At rest: the bristles are stretched by the arm's own motion.
            let forcing = self.forcing(0.0);
            let limit = 0.5 * self.mu * self.load / self.kc;
            z[self.at.x] = (-self.b * forcing.angle).clamp(-limit, limit);
        } else {
            let psi = self.steady_interface_state(self.speed);
            let (mu, ..) = self.friction(self.speed, psi, 0.0);
            let heat = if self.at.heat.is_some() {
                // T (1 + T) = mu N V / P0
                let rise = self.heating_gain / self.cooling_rate * mu * self.load * self.speed;
                0.5 * ((1.0 + 4.0 * rise).sqrt() - 1.0)
            } else {
                0.0
            };
            let mu = mu / (1.0 + heat);
            let (angle, normal) = self.deflection(mu);
            let force = mu * normal + self.sigma2 * self.speed;
            z[0] = angle;
            z[self.at.x] = self.stretch_under(mu * normal);
            if let Some(i) = self.at.roller {
                let [inverse, _, k] = self.support;
                z[i] = -force * inverse / k;
            }
            if let Some(i) = self.at.heat {
                z[i] = heat;
            }
            if let Some(i) = self.at.psi {
                z[i] = psi;
            }
        }
        z
    }

    fn reference(&self) -> [f64; MAX_STATES] {
        let mut z = [0.0; MAX_STATES];
        if self.speed > 0.0 {
            let guess = self.initial_state();
            (z[0], z[self.at.x]) = (guess[0], guess[self.at.x]);
            if let Some(i) = self.at.roller {
                z[i] = guess[i];
            }
        }
        z
    }

    fn resting_state(&self, z: &[f64]) -> [Option<(f64, [f64; MAX_STATES])>; MAX_STATES] {
        let mut out = [None; MAX_STATES];
        if self.renewal == 0.0 && self.speed == 0.0 {
            // No roller motion without slip, hence x = y - b th.
            let y = self.at.roller.map_or(0.0, |i| z[i]);
            let mut gradient = [0.0; MAX_STATES];
            gradient[self.at.x] = 1.0;
            gradient[0] = self.b;
            if let Some(i) = self.at.roller {
                gradient[i] = -1.0;
            }
            out[self.at.x] = Some((z[self.at.x] - y + self.b * (self.forcing(0.0).angle + z[0]), gradient));
        } else if self.renewal == 0.0 {
            // Under a moving roller such a cycle is no steady state: the bristles are taken to where they slip next.
            let th = self.forcing(0.0).angle + z[0];
            let (mu, ..) = self.friction(0.0, self.state(self.at.psi, z), self.state(self.at.heat, z));
            let normal = (self.load + self.load_stiffness * self.b * th).max(0.0);
            let mut gradient = [0.0; MAX_STATES];
            gradient[self.at.x] = 1.0;
            let held = self.stretch_under(mu * normal - self.state(self.at.q, z));
            out[self.at.x] = Some((z[self.at.x] - held, gradient));
        }
        if let Some(i) = self.at.psi {
            let mut gradient = [0.0; MAX_STATES];
            gradient[i] = 1.0;
            out[i] = Some((z[i] - self.psi_scale, gradient));
        }
        out
    }

    fn can_rest(&self) -> bool {
        self.speed == 0.0 || self.renewal > 0.0
    }

    fn columns(&self) -> usize {
        self.columns.len()
    }

    fn parameter_columns(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut ParameterColumns) {
        self.fill_columns(forcing, z, s, mode, out);
    }

    fn force(&self, forcing: &Forcing, z: &[f64], s: f64) -> (f64, f64) {
        let v = self.relative_speed(forcing, z);
        (self.pull(z, v, v - s), z[self.at.x])
    }
}
