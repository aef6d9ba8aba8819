//! The coefficients of the equations of motion as functions of all parameters, with gradients.

use super::dual::Dual;
use super::{Model, Operation};
use crate::effects::Support;
use std::f64::consts::TAU;

/// Index of the first effect parameter among the parameters of a model.
pub const FIRST_EFFECT_PARAMETER: usize = 16;
/// Keys of the parameters before those of the effects, in order; the last three are the operating point.
pub const BASE_PARAMETERS: [&str; FIRST_EFFECT_PARAMETER] = [
    "rig.inertia",
    "rig.torsional_stiffness",
    "rig.torsional_damping",
    "rig.spring_stiffness",
    "rig.spring_damping",
    "rig.spring_arm",
    "rig.contact_arm",
    "contact.stiffness",
    "contact.damping",
    "contact.friction",
    "instrument.drive_gain",
    "instrument.amplitude_gain",
    "instrument.phase_offset",
    "speed",
    "load",
    "drive",
];

/// Coefficients at one operating point; symbols of the paper (Eqs. 1-8) where it has them.
#[derive(Debug, Clone)]
pub struct Lumps {
    /// w, angular frequency of the drive \[rad/s\].
    pub omega: f64,
    /// J \[kg m^2\].
    pub inertia: Dual,
    /// C, with what effects add \[N m s/rad\].
    pub damping: Dual,
    /// K \[N m/rad\].
    pub stiffness: Dual,
    /// Gamma e^{i phi0}, complex drive torque: real part \[N m\].
    pub torque_re: Dual,
    /// Imaginary part of the drive torque \[N m\].
    pub torque_im: Dual,
    /// b \[m\].
    pub arm: Dual,
    /// kc \[N/m\].
    pub contact_stiffness: Dual,
    /// cc \[N s/m\].
    pub contact_damping: Dual,
    /// mu \[-\].
    pub friction: Dual,
    /// V \[m/s\].
    pub speed: Dual,
    /// W \[N\].
    pub load: Dual,
    /// Coupling of the arm's displacement into the normal load \[N/m\].
    pub load_stiffness: Dual,
    /// Rate of renewal of the bristles \[1/s\].
    pub renewal: Dual,
    /// Viscoelastic branch: stiffness \[N/m\] and relaxation time \[s\].
    pub branch: Option<(Dual, Dual)>,
    /// Viscous coefficient of the rate element \[N s/m\].
    pub rate_element: Option<Dual>,
    /// Support of the roller.
    pub support: Option<Support>,
    /// Power scale \[W\] and relaxation time \[s\] of the heating.
    pub heating: Option<(Dual, Dual)>,
    /// Reading over true amplitude \[-\].
    pub amplitude_gain: Dual,
    /// Reading minus true phase \[rad\].
    pub phase_offset: Dual,
}

impl Lumps {
    /// The coefficients of a model at an operating point.
    pub fn new(model: &Model, at: &Operation) -> Self {
        let (rig, contact, instrument) = (&model.rig, &model.contact, &model.instrument);
        let values = [
            rig.inertia,
            rig.torsional_stiffness,
            rig.torsional_damping,
            rig.spring_stiffness,
            rig.spring_damping,
            rig.spring_arm,
            rig.contact_arm,
            contact.stiffness,
            contact.damping,
            contact.friction,
            instrument.drive_gain,
            instrument.amplitude_gain,
            instrument.phase_offset,
            at.speed,
            at.load,
            at.drive,
        ];
        let [j, k0t, c0t, k0, c0, a, b, kc, cc, mu, drive_gain, amplitude_gain, phase_offset, speed, load, drive] =
            std::array::from_fn(|i| Dual::parameter(values[i], i));
        let omega = TAU * at.frequency;
        let stiffness = k0t + a * a * k0 * 2.0;
        let u0 = drive * drive_gain * a;
        let mut lumps = Self {
            omega,
            inertia: j,
            damping: c0t + a * a * c0 * 2.0,
            stiffness,
            torque_re: u0 * k0,
            torque_im: u0 * c0 * omega,
            arm: b,
            contact_stiffness: kc,
            contact_damping: cc,
            friction: mu,
            speed,
            load,
            load_stiffness: Dual::constant(0.0),
            renewal: Dual::constant(0.0),
            branch: None,
            rate_element: None,
            support: None,
            heating: None,
            amplitude_gain,
            phase_offset,
        };
        let mut first = FIRST_EFFECT_PARAMETER;
        for (effect, parameters) in &model.effects {
            let p: Vec<Dual> = parameters.iter().enumerate().map(|(i, &v)| Dual::parameter(v, first + i)).collect();
            first += p.len();
            lumps.add(*effect, &p);
        }
        lumps
    }

    fn add(&mut self, effect: &dyn crate::effects::Effect, p: &[Dual]) {
        if let Some(damping) = effect.damping(p, self.stiffness, self.omega) {
            self.damping = self.damping + damping;
        }
        if let Some((re, im)) = effect.drive(p, self.omega) {
            let (x, y) = (self.torque_re, self.torque_im);
            (self.torque_re, self.torque_im) = (x * re - y * im, x * im + y * re);
        }
        if let Some(stiffness) = effect.load_stiffness(p) {
            self.load_stiffness = self.load_stiffness + stiffness;
        }
        if let Some(rate) = effect.renewal(p, self.speed) {
            self.renewal = self.renewal + rate;
        }
        if let Some(angle) = effect.reading(p, self.omega) {
            self.phase_offset = self.phase_offset + angle;
        }
        self.branch = self.branch.or(effect.branch(p));
        self.rate_element = self.rate_element.or(effect.rate_element(p));
        self.support = self.support.or(effect.support(p));
        self.heating = self.heating.or(effect.heating(p));
    }

    /// Complex amplitude \[rad\] of the arm without contact: Gamma e^{i phi0} / (K - J w^2 + i w C).
    pub fn free_response(&self) -> (Dual, Dual) {
        let w = self.omega;
        let re = self.stiffness - self.inertia * (w * w);
        let im = self.damping * w;
        divide((self.torque_re, self.torque_im), (re, im))
    }

    /// Complex amplitude \[rad\] of the arm with the bristles stuck to a roller at rest (case II, with a compliant support
    /// and a viscoelastic branch where there are any).
    pub fn stuck_response(&self) -> (Dual, Dual) {
        let w = self.omega;
        let mut z = (self.contact_stiffness, self.contact_damping * w);
        if let Some((k1, tau)) = self.branch {
            let wt = tau * w;
            let scale = k1 * (wt * wt + Dual::constant(1.0)).recip();
            z = (z.0 + scale * wt * wt, z.1 + scale * wt);
        }
        if let Some(support) = self.support {
            let s = (support.stiffness - support.mass * (w * w), support.damping * w);
            let product = (z.0 * s.0 - z.1 * s.1, z.0 * s.1 + z.1 * s.0);
            z = divide(product, (z.0 + s.0, z.1 + s.1));
        }
        let b2 = self.arm * self.arm;
        let re = self.stiffness - self.inertia * (w * w) + b2 * z.0;
        let im = self.damping * w + b2 * z.1;
        divide((self.torque_re, self.torque_im), (re, im))
    }
}

fn divide(n: (Dual, Dual), d: (Dual, Dual)) -> (Dual, Dual) {
    let inverse = (d.0 * d.0 + d.1 * d.1).recip();
    ((n.0 * d.0 + n.1 * d.1) * inverse, (n.1 * d.0 - n.0 * d.1) * inverse)
}
