//! The equations of one operating point as a solver sees them.
//!
//! States: th and th' relative to the motion without contact; y and y' of the roller's support; the heating T; the stretch
//! x of the bristles; the force q of the viscoelastic branch; the interface state psi (those present, in that order).

mod parallel;

pub use parallel::Sliders;

use super::lumps::{FIRST_EFFECT_PARAMETER, Lumps};
use super::system::{Evaluation, Forcing, HybridSystem, MAX_STATES, Mode, ParameterColumns};
use super::{Model, Operation, dual::Dual};
use crate::effects::{Effect, Law};

/// Largest number of law parameters evaluated inside a cycle per effect.
const LAW_PARAMETERS: usize = 4;

/// A loss tangent w cc/kc of the bristles below this is none: it would change alpha by less than 1e-6 and make the
/// equations needlessly stiff.
const NO_DAMPING: f64 = 3e-6;

/// Where a column of parameter derivatives enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    FreeRe,
    FreeIm,
    Damping,
    Stiffness,
    InverseInertia,
    Arm,
    ContactStiffness,
    ContactDamping,
    Friction,
    Load,
    Speed,
    LoadStiffness,
    Renewal,
    BranchStiffness,
    BranchRate,
    RateViscosity,
    SupportInverseMass,
    SupportDamping,
    SupportStiffness,
    HeatingGain,
    CoolingRate,
    Law { effect: usize, parameter: usize },
}

/// One operating point of a model.
pub struct Problem {
    /// The coefficients with their gradients.
    pub lumps: Lumps,
    laws: Vec<(&'static dyn Effect, Vec<f64>)>,
    omega: f64,
    free: (f64, f64),
    c: f64,
    k: f64,
    inverse_inertia: f64,
    b: f64,
    kc: f64,
    cc: f64,
    mu: f64,
    load: f64,
    speed: f64,
    load_stiffness: f64,
    renewal: f64,
    k1: f64,
    branch_rate: f64,
    sigma2: f64,
    support: [f64; 3],
    heating_gain: f64,
    cooling_rate: f64,
    states: usize,
    roller: Option<usize>,
    heat: Option<usize>,
    x: usize,
    q: Option<usize>,
    psi: Option<usize>,
    rate_element: bool,
    stroke: f64,
    psi_scale: f64,
    columns: Vec<(Column, Dual)>,
}

/// A steady state in closed form.
#[derive(Debug, Clone, Copy)]
pub struct LimitingState {
    /// Complex amplitude of the arm \[rad\].
    pub response: (Dual, Dual),
    /// Mean angle \[rad\].
    pub mean: f64,
    /// Share of the cycle in stick.
    pub stick_fraction: f64,
    /// Extremes of the tangential force \[N\].
    pub force: (f64, f64),
}

/// Intermediate quantities at one instant.
struct Point {
    th: f64,
    w: f64,
    v: f64,
    d: f64,
    normal: f64,
    loaded: bool,
    force: f64,
    mu: f64,
    mu_s: f64,
    mu_psi: f64,
    mu_heat: f64,
    heat_factor: f64,
    torque: Law,
}

impl Problem {
    /// The equations of `model` at an operating point.
    pub fn new(model: &Model, at: &Operation) -> Self {
        let lumps = Lumps::new(model, at);
        let (free_re, free_im) = lumps.free_response();
        let (stuck_re, stuck_im) = lumps.stuck_response();
        let laws = model.effects.clone();
        let mut states = 2;
        let mut take = |present: bool, count: usize| {
            let index = states;
            if present {
                states += count;
            }
            present.then_some(index)
        };
        let roller = take(lumps.support.is_some(), 2);
        let heat = take(lumps.heating.is_some(), 1);
        let x = take(true, 1).unwrap_or(2);
        let q = take(lumps.branch.is_some(), 1);
        let has_psi = laws.iter().any(|(e, p)| e.interface_rate(p, 0.0, 0.0).is_some());
        let psi = take(has_psi, 1);
        let inverse = lumps.inertia.recip();
        let (kc, cc) = (lumps.contact_stiffness.value, lumps.contact_damping.value);
        let amplitude = free_re.value.hypot(free_im.value);
        let stuck = stuck_re.value.hypot(stuck_im.value);
        let mut columns = vec![
            (Column::FreeRe, free_re),
            (Column::FreeIm, free_im),
            (Column::Damping, lumps.damping * inverse),
            (Column::Stiffness, lumps.stiffness * inverse),
            (Column::InverseInertia, inverse),
            (Column::Arm, lumps.arm),
            (Column::ContactStiffness, lumps.contact_stiffness),
            (Column::ContactDamping, lumps.contact_damping),
            (Column::Friction, lumps.friction),
            (Column::Load, lumps.load),
            (Column::Speed, lumps.speed),
            (Column::LoadStiffness, lumps.load_stiffness),
            (Column::Renewal, lumps.renewal),
        ];
        let mut support = [0.0; 3];
        if let Some(s) = lumps.support {
            let inverse = s.mass.recip();
            let parts = [inverse, s.damping * inverse, s.stiffness * inverse];
            support = parts.map(|part| part.value);
            let kinds = [Column::SupportInverseMass, Column::SupportDamping, Column::SupportStiffness];
            columns.extend(kinds.into_iter().zip(parts));
        }
        let (mut k1, mut branch_rate) = (0.0, 0.0);
        if let Some((stiffness, tau)) = lumps.branch {
            let rate = tau.recip();
            (k1, branch_rate) = (stiffness.value, rate.value);
            columns.extend([(Column::BranchStiffness, stiffness), (Column::BranchRate, rate)]);
        }
        let mut sigma2 = 0.0;
        if let Some(viscosity) = lumps.rate_element {
            sigma2 = viscosity.value;
            columns.push((Column::RateViscosity, viscosity));
        }
        let (mut heating_gain, mut cooling_rate) = (0.0, 0.0);
        if let Some((power, tau)) = lumps.heating {
            let (gain, rate) = ((power * tau).recip(), tau.recip());
            (heating_gain, cooling_rate) = (gain.value, rate.value);
            columns.extend([(Column::HeatingGain, gain), (Column::CoolingRate, rate)]);
        }
        let mut first = FIRST_EFFECT_PARAMETER;
        for (index, (effect, p)) in laws.iter().enumerate() {
            let inside = effect.friction(p, 0.0, 0.0).is_some() || effect.torque(p, 0.0, 0.0).is_some();
            for (parameter, &value) in p.iter().enumerate().take(LAW_PARAMETERS) {
                if inside {
                    columns.push((Column::Law { effect: index, parameter }, Dual::parameter(value, first + parameter)));
                }
            }
            first += p.len();
        }
        let mut problem = Self {
            omega: lumps.omega,
            free: (free_re.value, free_im.value),
            c: (lumps.damping * inverse).value,
            k: (lumps.stiffness * inverse).value,
            inverse_inertia: inverse.value,
            b: lumps.arm.value,
            kc,
            cc: if lumps.omega * cc < NO_DAMPING * kc { 0.0 } else { cc },
            mu: lumps.friction.value,
            load: lumps.load.value,
            speed: lumps.speed.value,
            load_stiffness: lumps.load_stiffness.value,
            renewal: lumps.renewal.value,
            k1,
            branch_rate,
            sigma2,
            support,
            heating_gain,
            cooling_rate,
            states,
            roller,
            heat,
            x,
            q,
            psi,
            rate_element: lumps.rate_element.is_some(),
            stroke: lumps.arm.value * (amplitude * stuck).sqrt(),
            psi_scale: 1.0,
            columns,
            laws,
            lumps,
        };
        problem.psi_scale = problem.steady_interface_state(problem.speed.max(problem.slip_scale()));
        problem
    }

    /// Gradient of each column's lumped coefficient by the parameters of the model.
    pub fn column_gradients(&self) -> impl Iterator<Item = &Dual> {
        self.columns.iter().map(|(_, dual)| dual)
    }

    /// Whether the interface is a rate element (no true sticking).
    pub fn is_rate_element(&self) -> bool {
        self.rate_element
    }

    /// The steady state where it is known in closed form: full slip under a constant friction force (case III), or
    /// bristles that stick to a roller at rest throughout (case II, started from rest). `None` where the interface
    /// changes between stick and slip or a law of the cycle is not linear.
    pub fn limiting_state(&self) -> Option<LimitingState> {
        if self.rate_element || self.laws.iter().any(|(e, p)| e.torque(p, 0.0, 0.0).is_some()) {
            return None;
        }
        let magnitude = |(re, im): (Dual, Dual)| re.value.hypot(im.value);
        let constant_friction = self.heat.is_none()
            && self.load_stiffness == 0.0
            && self.laws.iter().all(|(e, p)| e.friction(p, 0.0, 0.0).is_none());
        if constant_friction {
            let response = self.lumps.free_response();
            // Bristles that are replaced keep being stretched at this rate; the interface slips at what is left of V.
            let relaxing = self.cc + if self.k1 > 0.0 { self.k1 / self.branch_rate } else { 0.0 };
            let stretching = self.mu * self.load * self.renewal / (self.kc + self.renewal * relaxing);
            if self.speed - stretching > self.b * self.omega * magnitude(response) {
                let force = self.mu * self.load;
                let mean = self.b * force * self.inverse_inertia / self.k;
                return Some(LimitingState { response, mean, stick_fraction: 0.0, force: (force, force) });
            }
        }
        if self.speed == 0.0 && self.continuum().is_none() {
            let stuck = self.static_contact();
            let (mu, ..) = self.friction(0.0, 0.0, 0.0);
            let swing = self.load_stiffness.abs() * self.b * magnitude(stuck.response);
            if stuck.force.1 < mu * (self.load - swing) {
                return Some(stuck);
            }
        }
        None
    }

    /// Case II: bristles that stick to a roller at rest throughout, started from rest.
    fn static_contact(&self) -> LimitingState {
        let (free, response) = (self.lumps.free_response(), self.lumps.stuck_response());
        // The force makes up the difference to the free arm: b F = (K - J w^2 + i w C)(A - A_free).
        let (re, im) = (free.0.value - response.0.value, free.1.value - response.1.value);
        let w = self.omega;
        let impedance = (self.k - w * w).hypot(w * self.c) / (self.inverse_inertia * self.b);
        let force = impedance * re.hypot(im);
        LimitingState { response, mean: 0.0, stick_fraction: 1.0, force: (-force, force) }
    }

    /// The stuck motion (case II) of a contact whose strength grows without bound while it rests on a roller at rest:
    /// once it rests it never slips again. `None` where the strength is bounded.
    pub fn locked_state(&self) -> Option<LimitingState> {
        let linear = self.laws.iter().all(|(e, p)| e.torque(p, 0.0, 0.0).is_none());
        let grows = self.psi.is_some() && {
            let aged = |age: f64| self.friction(0.0, age * self.psi_scale, 0.0).0;
            aged(1e12) > aged(1e9)
        };
        (self.speed == 0.0 && grows && linear && !self.rate_element && self.load_stiffness == 0.0)
            .then(|| self.static_contact())
    }

    /// Index of the stretch of the bristles among the states.
    pub fn stretch_index(&self) -> usize {
        self.x
    }

    /// Mean angle of the arm and normal load under sliding friction `mu`: K th = torque(th) + b F, the load and the torque
    /// depending on the angle. The load given, where there is no such equilibrium.
    fn deflection(&self, mu: f64) -> (f64, f64) {
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

    /// State at time 0 of the motion with the bristles stuck to a roller at rest, where friction can hold them.
    fn stuck_state(&self) -> Option<[f64; MAX_STATES]> {
        let w = self.omega;
        let (free, stuck) = (self.lumps.free_response(), self.lumps.stuck_response());
        let apart = (stuck.0.value - free.0.value, stuck.1.value - free.1.value);
        let scale = 1.0 / (self.inverse_inertia * self.b);
        // F = (K - J w^2 + i w C) (stuck - free)/b
        let force = times(apart, (scale * (self.k - w * w), scale * w * self.c));
        if force.0.hypot(force.1) > self.mu * self.load {
            return None;
        }
        let mut y = (0.0, 0.0);
        let mut z = [0.0; MAX_STATES];
        (z[0], z[1]) = (apart.1, w * apart.0);
        if let Some(i) = self.roller {
            // m y'' + c y' + k y = -F
            let [inverse, c, k] = self.support;
            let d = (k - w * w, w * c);
            y = times((-inverse * force.0, -inverse * force.1), (d.0, -d.1));
            y = (y.0 / (d.0 * d.0 + d.1 * d.1), y.1 / (d.0 * d.0 + d.1 * d.1));
            (z[i], z[i + 1]) = (y.1, w * y.0);
        }
        let stretch = (y.0 - self.b * stuck.0.value, y.1 - self.b * stuck.1.value);
        z[self.x] = stretch.1;
        if let Some(i) = self.q {
            // q = k1 x i w/(1/tau + i w)
            let gain = self.k1 * w / (self.branch_rate * self.branch_rate + w * w);
            z[i] = gain * (w * stretch.1 + self.branch_rate * stretch.0);
        }
        if let Some(i) = self.psi {
            z[i] = self.psi_scale;
        }
        Some(z)
    }

    fn steady_interface_state(&self, s: f64) -> f64 {
        let rate = |psi: f64| self.laws.iter().find_map(|(e, p)| e.interface_rate(p, s, psi));
        match rate(0.0) {
            Some(law) if law.d_second < 0.0 => -law.value / law.d_second,
            _ => 1.0,
        }
    }

    /// mu at slip rate `s >= 0` with its slopes by s, psi and T: (mu, mu_s, mu_psi, mu_T, 1/(1+T)).
    fn friction(&self, s: f64, psi: f64, heat: f64) -> (f64, f64, f64, f64, f64) {
        let (mut mu, mut mu_s, mut mu_psi) = (self.mu, 0.0, 0.0);
        let inside = s.max(0.0);
        for (effect, p) in &self.laws {
            if let Some(law) = effect.friction(p, inside, psi) {
                mu += law.value;
                mu_psi += law.d_second;
                if s >= 0.0 {
                    mu_s += law.d_first;
                }
            }
        }
        let factor = 1.0 / (1.0 + heat);
        (mu * factor, mu_s * factor, mu_psi * factor, -mu * factor * factor, factor)
    }

    fn state(&self, index: Option<usize>, z: &[f64]) -> f64 {
        index.map_or(0.0, |i| z[i])
    }

    fn point(&self, forcing: &Forcing, z: &[f64], s: f64) -> Point {
        let (th, w) = (forcing.angle + z[0], forcing.velocity + z[1]);
        let v = self.speed + self.roller.map_or(0.0, |i| z[i + 1]) - self.b * w;
        let d = v - s;
        let normal = self.load + self.load_stiffness * self.b * th;
        let loaded = normal > 0.0;
        let normal = normal.max(0.0);
        let force = self.kc * z[self.x] + self.cc * d + self.state(self.q, z) + self.sigma2 * v;
        let argument = if self.rate_element { v.abs() } else { s.abs() };
        let (mu, mu_s, mu_psi, mu_heat, heat_factor) =
            self.friction(argument, self.state(self.psi, z), self.state(self.heat, z));
        let mut torque = Law::default();
        for (effect, p) in &self.laws {
            if let Some(law) = effect.torque(p, th, w) {
                torque.value += law.value;
                torque.d_first += law.d_first;
                torque.d_second += law.d_second;
            }
        }
        Point { th, w, v, d, normal, loaded, force, mu, mu_s, mu_psi, mu_heat, heat_factor, torque }
    }

    /// Whether nothing holds the slip rate back, so that it jumps to the relative speed at once.
    fn instant_slip(&self) -> bool {
        self.cc == 0.0 && !self.rate_element && self.laws.iter().all(|(e, p)| e.friction(p, 0.0, 0.0).is_none())
    }

    fn force_scale(&self) -> f64 {
        (self.kc + self.omega * self.cc) * self.stroke
    }

    fn sign(mode: Mode) -> f64 {
        match mode {
            Mode::SlipBackward | Mode::RateBackward => -1.0,
            _ => 1.0,
        }
    }

    /// By how much the bristles pull harder in direction `sign` than friction holds, at the slip rate `s >= 0`.
    fn excess(&self, forcing: &Forcing, z: &[f64], sign: f64, s: f64) -> f64 {
        let p = self.point(forcing, z, sign * s);
        let (mu, ..) = self.friction(s, self.state(self.psi, z), self.state(self.heat, z));
        sign * p.force - mu * p.normal
    }

    /// Slip rate on the stable branch nearest to zero in direction `sign`, or None where the interface can stick.
    fn slip_root(&self, forcing: &Forcing, z: &[f64], sign: f64) -> Option<f64> {
        if self.excess(forcing, z, sign, 0.0) < 0.0 {
            return None;
        }
        self.slip_root_above(forcing, z, sign, (0.0, 1e-9 * self.slip_scale()))
    }

    /// Slip rate on the stable branch nearest to `last` in direction `sign`, or None where there is none.
    fn slip_root_near(&self, forcing: &Forcing, z: &[f64], sign: f64, last: f64) -> Option<f64> {
        let last = last.max(1e-9 * self.slip_scale());
        if self.excess(forcing, z, sign, last) > 0.0 {
            return self.slip_root_above(forcing, z, sign, (last, 1.1 * last));
        }
        let (mut low, mut high) = (0.9 * last, last);
        while self.excess(forcing, z, sign, low) <= 0.0 {
            (low, high) = (0.9 * low, low);
            if low < 1e-9 * self.slip_scale() {
                return None;
            }
        }
        self.slip_root_above(forcing, z, sign, (low, high))
    }

    /// Where the excess, positive at the lower end of the bracket, first vanishes at or above it.
    fn slip_root_above(&self, forcing: &Forcing, z: &[f64], sign: f64, bracket: (f64, f64)) -> Option<f64> {
        let (mut low, mut high) = bracket;
        let top = 1e3 * (self.slip_scale() + self.speed) + high;
        while self.excess(forcing, z, sign, high) > 0.0 {
            (low, high) = (high, 1.5 * high);
            if high > top {
                return Some(top);
            }
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.excess(forcing, z, sign, middle) > 0.0 { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }
}

/// Product of two complex numbers (real, imaginary).
fn times(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

impl HybridSystem for Problem {
    fn states(&self) -> usize {
        self.states
    }

    fn period(&self) -> f64 {
        std::f64::consts::TAU / self.omega
    }

    fn damping_ratio(&self) -> f64 {
        let [_, c, k] = self.support;
        let support = if self.roller.is_some() { 0.5 * c / k.sqrt() } else { f64::INFINITY };
        support.min(0.5 * self.c / self.k.abs().sqrt())
    }

    fn scales(&self) -> [f64; MAX_STATES] {
        let mut scales = [1.0; MAX_STATES];
        let angle = self.stroke / self.b;
        scales[0] = angle;
        scales[1] = self.omega * angle;
        scales[self.x] = self.stroke;
        if let Some(i) = self.roller {
            scales[i] = self.stroke;
            scales[i + 1] = self.omega * self.stroke;
        }
        if let Some(i) = self.heat {
            let rise = self.heating_gain / self.cooling_rate * self.mu * self.load;
            scales[i] = rise * (self.speed + self.slip_scale());
        }
        if let Some(i) = self.q {
            scales[i] = self.k1 * self.stroke;
        }
        if let Some(i) = self.psi {
            scales[i] = self.psi_scale;
        }
        // A state that a strength of zero keeps at rest has no scale of its own.
        scales.map(|scale| if scale > 0.0 { scale } else { 1.0 })
    }

    fn slip_scale(&self) -> f64 {
        self.omega * self.stroke
    }

    fn forcing(&self, t: f64) -> Forcing {
        let (sine, cosine) = (self.omega * t).sin_cos();
        let (re, im) = self.free;
        Forcing { sine, cosine, angle: re * sine + im * cosine, velocity: self.omega * (re * cosine - im * sine) }
    }

    fn evaluate(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut Evaluation) {
        let p = self.point(forcing, z, if mode == Mode::Stick { 0.0 } else { s });
        let sign = Self::sign(mode);
        let (x, b) = (self.x, self.b);
        // Gradient of F by (w, u, x, q, s).
        let force_v = self.cc + self.sigma2;
        let mut force_z = [0.0; MAX_STATES];
        force_z[1] = -b * force_v;
        force_z[x] = self.kc;
        if let Some(i) = self.roller {
            force_z[i + 1] = force_v;
        }
        if let Some(i) = self.q {
            force_z[i] = 1.0;
        }
        let force_s = -self.cc;
        // Arm.
        out.f[0] = z[1];
        out.fz[0] = [0.0; MAX_STATES];
        out.fz[0][1] = 1.0;
        out.fs[0] = 0.0;
        let gain = self.inverse_inertia * b;
        out.f[1] = -self.c * z[1] - self.k * z[0] + self.inverse_inertia * (b * p.force + p.torque.value);
        out.fz[1] = force_z.map(|f| gain * f);
        out.fz[1][0] += -self.k + self.inverse_inertia * p.torque.d_first;
        out.fz[1][1] += -self.c + self.inverse_inertia * p.torque.d_second;
        out.fs[1] = gain * force_s;
        // Relative speed of the bristles' ends.
        let mut rate_z = [0.0; MAX_STATES];
        rate_z[1] = -b;
        if let Some(i) = self.roller {
            rate_z[i + 1] = 1.0;
            let [inverse, c, k] = self.support;
            out.f[i] = z[i + 1];
            out.fz[i] = [0.0; MAX_STATES];
            out.fz[i][i + 1] = 1.0;
            out.fs[i] = 0.0;
            out.f[i + 1] = -inverse * p.force - c * z[i + 1] - k * z[i];
            out.fz[i + 1] = force_z.map(|f| -inverse * f);
            out.fz[i + 1][i] -= k;
            out.fz[i + 1][i + 1] -= c;
            out.fs[i + 1] = -inverse * force_s;
        }
        // The slip rate that friction works on: that of the interface, or the relative speed for a rate element.
        let slip = if self.rate_element { p.v } else { s };
        if let Some(i) = self.heat {
            let gain = self.heating_gain;
            out.f[i] = gain * p.force * slip - self.cooling_rate * z[i];
            for j in 0..self.states {
                let slip_z = if self.rate_element { rate_z[j] } else { 0.0 };
                out.fz[i][j] = gain * (force_z[j] * slip + p.force * slip_z);
            }
            out.fz[i][i] -= self.cooling_rate;
            out.fs[i] = gain * (force_s * slip + if self.rate_element { 0.0 } else { p.force });
        }
        out.f[x] = p.d - self.renewal * z[x];
        out.fz[x] = rate_z;
        out.fz[x][x] = -self.renewal;
        out.fs[x] = -1.0;
        if let Some(i) = self.q {
            out.f[i] = self.k1 * p.d - self.branch_rate * z[i];
            out.fz[i] = rate_z.map(|r| self.k1 * r);
            out.fz[i][i] -= self.branch_rate;
            out.fs[i] = -self.k1;
        }
        if let Some(i) = self.psi {
            let law = self.laws.iter().find_map(|(e, q)| e.interface_rate(q, slip.abs(), z[i])).unwrap_or_default();
            out.f[i] = law.value;
            let slope = law.d_first * if slip < 0.0 { -1.0 } else { 1.0 };
            out.fz[i] = if self.rate_element { rate_z.map(|r| slope * r) } else { [0.0; MAX_STATES] };
            out.fz[i][i] += law.d_second;
            out.fs[i] = if self.rate_element { 0.0 } else { slope };
        }
        // Constraint.
        out.gz = [0.0; MAX_STATES];
        let normal_th = if p.loaded { self.load_stiffness * b } else { 0.0 };
        match mode {
            Mode::Stick => {
                out.g = s;
                out.gs = 1.0;
                let scale = 1.0 / self.slip_scale();
                out.g *= scale;
                out.gs *= scale;
            }
            Mode::SlipForward | Mode::SlipBackward => {
                let (mu, mu_s, ..) = self.friction(sign * s, self.state(self.psi, z), self.state(self.heat, z));
                let scale = 1.0 / self.force_scale();
                out.g = scale * (p.force - sign * mu * p.normal);
                out.gz = force_z;
                out.gz[0] -= sign * mu * normal_th;
                if let Some(i) = self.psi {
                    out.gz[i] -= sign * p.mu_psi * p.normal;
                }
                if let Some(i) = self.heat {
                    out.gz[i] -= sign * p.mu_heat * p.normal;
                }
                out.gz = out.gz.map(|g| scale * g);
                out.gs = scale * (force_s - mu_s * p.normal);
            }
            Mode::RateForward | Mode::RateBackward => {
                // s = kc |v| x / (mu N)
                let limit = (p.mu * p.normal).max(1e-12 * self.force_scale());
                let flow = self.kc * z[x] / limit;
                let scale = 1.0 / self.slip_scale();
                let speed = p.v.abs();
                out.g = scale * (s - flow * speed);
                let by_limit = flow * speed / limit;
                let by_speed = sign * (-flow + by_limit * p.mu_s * p.normal);
                for (gz, rate) in out.gz.iter_mut().zip(&rate_z) {
                    *gz = by_speed * rate;
                }
                out.gz[x] -= self.kc * speed / limit;
                out.gz[0] += by_limit * p.mu * normal_th;
                if let Some(i) = self.psi {
                    out.gz[i] += by_limit * p.mu_psi * p.normal;
                }
                if let Some(i) = self.heat {
                    out.gz[i] += by_limit * p.mu_heat * p.normal;
                }
                out.gz = out.gz.map(|g| scale * g);
                out.gs = scale;
            }
        }
    }

    fn event(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode) -> f64 {
        match mode {
            Mode::Stick => {
                let p = self.point(forcing, z, 0.0);
                (p.mu * p.normal - p.force.abs()) / self.force_scale()
            }
            Mode::SlipForward | Mode::SlipBackward => Self::sign(mode) * s / self.slip_scale(),
            Mode::RateForward | Mode::RateBackward => {
                Self::sign(mode) * self.point(forcing, z, s).v / self.slip_scale()
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
                let psi = self.state(self.psi, z);
                let (_, slope, ..) = self.friction(0.0, psi, self.state(self.heat, z));
                let p = self.point(forcing, z, 0.0);
                let resistance = self.cc + slope * p.normal;
                let s = if resistance < 0.0 {
                    // Weakening steeper than the bristles' damping: the slip rate jumps to the next stable branch.
                    sign * self.slip_root(forcing, z, sign).unwrap_or(0.0)
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
            z[self.x] -= excess.copysign(p.force) / self.kc;
            self.x
        })
    }

    fn enter(&self, forcing: &Forcing, z: &[f64], last: Option<(Mode, f64)>) -> (Mode, f64) {
        let p = self.point(forcing, z, 0.0);
        if self.rate_element {
            let flow = self.kc * z[self.x] / (p.mu * p.normal).max(1e-12 * self.force_scale());
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
            None if self.speed > 0.0 => Some((1.0, p.v.abs() + self.speed)),
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

    fn initial_state(&self) -> [f64; MAX_STATES] {
        let mut z = [0.0; MAX_STATES];
        if self.speed == 0.0 {
            if let Some(stuck) = self.stuck_state() {
                return stuck;
            }
            // At rest: the bristles are stretched by the arm's own motion.
            let forcing = self.forcing(0.0);
            let limit = 0.5 * self.mu * self.load / self.kc;
            z[self.x] = (-self.b * forcing.angle).clamp(-limit, limit);
        } else {
            let psi = self.steady_interface_state(self.speed);
            let (mu, ..) = self.friction(self.speed, psi, 0.0);
            let heat = if self.heat.is_some() {
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
            z[self.x] = mu * normal / (self.kc + self.cc * self.renewal);
            if let Some(i) = self.roller {
                let [inverse, _, k] = self.support;
                z[i] = -force * inverse / k;
            }
            if let Some(i) = self.heat {
                z[i] = heat;
            }
            if let Some(i) = self.psi {
                z[i] = psi;
            }
        }
        z
    }

    fn resting_state(&self, z: &[f64]) -> [Option<(f64, [f64; MAX_STATES])>; MAX_STATES] {
        let mut out = [None; MAX_STATES];
        if self.renewal == 0.0 && self.speed == 0.0 {
            // No roller motion without slip, hence x = y - b th.
            let y = self.roller.map_or(0.0, |i| z[i]);
            let mut gradient = [0.0; MAX_STATES];
            gradient[self.x] = 1.0;
            gradient[0] = self.b;
            if let Some(i) = self.roller {
                gradient[i] = -1.0;
            }
            out[self.x] = Some((z[self.x] - y + self.b * (self.forcing(0.0).angle + z[0]), gradient));
        } else if self.renewal == 0.0 {
            // Under a moving roller such a cycle is no steady state: the bristles are taken to where they slip next.
            let th = self.forcing(0.0).angle + z[0];
            let (mu, ..) = self.friction(0.0, self.state(self.psi, z), self.state(self.heat, z));
            let normal = (self.load + self.load_stiffness * self.b * th).max(0.0);
            let mut gradient = [0.0; MAX_STATES];
            gradient[self.x] = 1.0;
            out[self.x] = Some((z[self.x] - (mu * normal - self.state(self.q, z)) / self.kc, gradient));
        }
        if let Some(i) = self.psi {
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
        let s = if mode == Mode::Stick { 0.0 } else { s };
        let p = self.point(forcing, z, s);
        let sign = Self::sign(mode);
        let slip = if self.rate_element { p.v } else { s };
        let psi = self.state(self.psi, z);
        let limit = (p.mu * p.normal).max(1e-12 * self.force_scale());
        for (index, (column, _)) in self.columns.iter().enumerate() {
            // Direct partial derivatives of the intermediate quantities by this column.
            let (mut dth, mut dw, mut dv, mut dn, mut dforce, mut dmu, mut dtorque) =
                (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
            let (mut arm, mut support, mut heat, mut stretch, mut branch, mut dpsi, mut stiff) =
                (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
            match *column {
                Column::FreeRe => (dth, dw) = (forcing.sine, self.omega * forcing.cosine),
                Column::FreeIm => (dth, dw) = (forcing.cosine, -self.omega * forcing.sine),
                Column::Damping => arm = -z[1],
                Column::Stiffness => arm = -z[0],
                Column::InverseInertia => arm = self.b * p.force + p.torque.value,
                Column::Arm => {
                    dv = -p.w;
                    dn = self.load_stiffness * p.th;
                    arm = self.inverse_inertia * p.force;
                }
                Column::ContactStiffness => {
                    dforce = z[self.x];
                    stiff = 1.0;
                }
                Column::ContactDamping => dforce = p.d,
                Column::Friction => dmu = p.heat_factor,
                Column::Load => dn = 1.0,
                Column::Speed => dv = 1.0,
                Column::LoadStiffness => dn = self.b * p.th,
                Column::Renewal => stretch = -z[self.x],
                Column::BranchStiffness => branch = p.d,
                Column::BranchRate => branch = -self.state(self.q, z),
                Column::RateViscosity => dforce = p.v,
                Column::SupportInverseMass => support = -p.force,
                Column::SupportDamping => support = -self.roller.map_or(0.0, |i| z[i + 1]),
                Column::SupportStiffness => support = -self.state(self.roller, z),
                Column::HeatingGain => heat = p.force * slip,
                Column::CoolingRate => heat = -self.state(self.heat, z),
                Column::Law { effect, parameter } => {
                    let (e, q) = &self.laws[effect];
                    let argument = if self.rate_element { p.v.abs() } else { (sign * s).max(0.0) };
                    if let Some(law) = e.friction(q, argument, psi) {
                        dmu = law.d_parameters[parameter] * p.heat_factor;
                    }
                    if let Some(law) = e.interface_rate(q, slip.abs(), psi) {
                        dpsi = law.d_parameters[parameter];
                    }
                    if let Some(law) = e.torque(q, p.th, p.w) {
                        dtorque = law.d_parameters[parameter];
                    }
                }
            }
            dv -= self.b * dw;
            dn += self.load_stiffness * self.b * dth;
            if !p.loaded {
                dn = 0.0;
            }
            dforce += (self.cc + self.sigma2) * dv;
            dtorque += p.torque.d_first * dth + p.torque.d_second * dw;
            let f = &mut out.f[index];
            *f = [0.0; MAX_STATES];
            f[1] = self.inverse_inertia * (self.b * dforce + dtorque) + arm;
            if let Some(i) = self.roller {
                f[i + 1] = support - self.support[0] * dforce;
            }
            if let Some(i) = self.heat {
                let dslip = if self.rate_element { dv } else { 0.0 };
                f[i] = heat + self.heating_gain * (dforce * slip + p.force * dslip);
            }
            f[self.x] = dv + stretch;
            if let Some(i) = self.q {
                f[i] = self.k1 * dv + branch;
            }
            if let Some(i) = self.psi {
                f[i] = dpsi;
                if self.rate_element {
                    let law = self.laws.iter().find_map(|(e, q)| e.interface_rate(q, p.v.abs(), psi));
                    f[i] += law.unwrap_or_default().d_first * sign * dv;
                }
            }
            out.g[index] = match mode {
                Mode::Stick => 0.0,
                Mode::SlipForward | Mode::SlipBackward => {
                    (dforce - sign * (p.mu * dn + dmu * p.normal)) / self.force_scale()
                }
                Mode::RateForward | Mode::RateBackward => {
                    let flow = self.kc * z[self.x] / limit;
                    let speed = p.v.abs();
                    let dlimit = p.mu * dn + (dmu + p.mu_s * sign * dv) * p.normal;
                    let by_stiffness = stiff * z[self.x] * speed / limit;
                    (flow * speed / limit * dlimit - flow * sign * dv - by_stiffness) / self.slip_scale()
                }
            };
        }
    }

    fn force(&self, forcing: &Forcing, z: &[f64], s: f64) -> (f64, f64) {
        (self.point(forcing, z, s).force, z[self.x])
    }
}
