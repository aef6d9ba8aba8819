//! The coefficients of the equations of motion as functions of all parameters, with gradients.

use super::{Model, Operation};
use crate::dual::{Dual, Scalar};
use crate::effects::{Beside, Support};
use crate::parameter::{FIRST_CONTACT_PARAMETER, FIRST_EFFECT_PARAMETER, RIG_PARAMETERS};
use crate::scenario::{Dissipation, Elasticity, Excitation, Oscillator, Rig};
use crate::statistics::wrap;
use nalgebra::Complex;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Coefficients at one operating point; symbols of the paper (Eqs. 1-8) where it has them.
#[derive(Debug, Clone)]
// Wide: a field is a symbol of the equations, and effects change them one by one.
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
    pub branch: Option<Box<(Dual, Dual)>>,
    /// Those beside it.
    pub further_branches: Vec<(Dual, Dual)>,
    /// Complex stiffness of the spring-pot at w \[N/m\].
    pub spring_pot: Option<Box<(Dual, Dual)>>,
    /// Viscous coefficient of the rate element \[N s/m\].
    pub rate_element: Option<Box<Dual>>,
    /// Support of the roller.
    pub support: Option<Box<Support>>,
    /// Power scale \[W\] and relaxation time \[s\] of the heating.
    pub heating: Option<Box<(Dual, Dual)>>,
    /// Reading over true amplitude \[-\].
    pub amplitude_gain: Dual,
    /// Reading minus true phase \[rad\].
    pub phase_offset: Dual,
    /// Motion of the base, complex, which a reading of the motion in space adds to the coordinate \[rad, m\], and that
    /// of the modes outside the band.
    pub read_beside: Option<Box<(Dual, Dual)>>,
    /// Slip elements from the body to ground: stiffness, force at full slip, exponent.
    pub joint: Option<Box<[Dual; 3]>>,
    /// Dry friction between the body and the ground.
    pub dry_friction: Option<Box<Dual>>,
}

impl Lumps {
    /// The coefficients of a model at an operating point.
    pub fn new(model: &Model, at: &Operation) -> Self {
        let (contact, instrument, rig) = (&model.contact, &model.instrument, model.rig.values());
        let values = [
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
        let rig: [Dual; RIG_PARAMETERS] = std::array::from_fn(|i| Dual::parameter(rig[i], i));
        let [kc, cc, mu, drive_gain, amplitude_gain, phase_offset, speed, load, drive] =
            std::array::from_fn(|i| Dual::parameter(values[i], FIRST_CONTACT_PARAMETER + i));
        let omega = TAU * at.frequency;
        let drive = if instrument.drive_sensitivity.is_some() { drive / drive_gain } else { drive * drive_gain };
        let mode = match &model.rig {
            Rig::TorsionalArm(_) => Mode::of_arm(rig, drive, omega),
            Rig::Oscillator(of) => Mode::of_oscillator(of, rig, drive, model.signals.drive.order, omega),
        };
        let Mode { inertia, damping, stiffness, torque, arm, base_motion } = mode;
        // Each derivative of the reading is a factor i omega.
        let (amplitude_gain, phase_offset) = match model.signals.reading.order {
            0 => (amplitude_gain, phase_offset),
            order => {
                (amplitude_gain * omega.powi(order.into()), phase_offset + Dual::constant(FRAC_PI_2 * f64::from(order)))
            }
        };
        let mut lumps = Self {
            omega,
            inertia,
            damping,
            stiffness,
            torque_re: torque.0,
            torque_im: torque.1,
            arm,
            contact_stiffness: kc,
            contact_damping: cc,
            friction: mu,
            speed,
            load,
            load_stiffness: Dual::constant(0.0),
            renewal: Dual::constant(0.0),
            branch: None,
            further_branches: Vec::new(),
            spring_pot: None,
            rate_element: None,
            support: None,
            heating: None,
            amplitude_gain,
            phase_offset,
            read_beside: base_motion.map(Box::new),
            joint: None,
            dry_friction: None,
        };
        lumps.add_effects(model, at.series);
        lumps
    }

    /// Adds what all effects of the model make of the coefficients of rig, contact and instrument.
    fn add_effects(&mut self, model: &Model, series: usize) {
        let mut first = FIRST_EFFECT_PARAMETER;
        let none = Dual::constant(0.0);
        let order = model.signals.reading.order;
        let of = Beside { omega: self.omega, stiffness: self.stiffness, inertia: self.inertia, order };
        let mut beside: Option<(Dual, Dual)> = None;
        for (effect, parameters) in &model.effects {
            let p: Vec<Dual> = parameters.iter().enumerate().map(|(i, &v)| Dual::parameter(v, first + i)).collect();
            first += p.len();
            if let Some((stiffness, gain)) = effect.between_series(&p, series) {
                self.stiffness = self.stiffness + of.stiffness * (stiffness - Dual::constant(1.0));
                self.amplitude_gain = self.amplitude_gain * gain;
            }
            self.add(*effect, &p);
            beside = [beside, effect.beside(&p, &of)].into_iter().flatten().reduce(|a, b| (a.0 + b.0, a.1 + b.1));
        }
        // In proportion to the drive as all effects leave it.
        if let Some((re, im)) = beside {
            let (x, y) = self.read_beside.take().map_or((none, none), |beside| *beside);
            let (u, v) = (self.torque_re, self.torque_im);
            self.read_beside = Some(Box::new((x + re * u - im * v, y + re * v + im * u)));
        }
    }

    fn add(&mut self, effect: &dyn crate::effects::Effect, p: &[Dual]) {
        if let Some(damping) = effect.damping(p, self.stiffness, self.omega) {
            self.damping = self.damping + damping;
        }
        if let Some(stiffness) = effect.stiffness(p) {
            self.stiffness = self.stiffness + stiffness;
        }
        if let Some((re, im)) = effect.drive(p, self.omega) {
            let (x, y) = (self.torque_re, self.torque_im);
            (self.torque_re, self.torque_im) = (x * re - y * im, x * im + y * re);
            if let Some(base) = &mut self.read_beside {
                let (x, y) = **base;
                **base = (x * re - y * im, x * im + y * re);
            }
        }
        if let Some(stiffness) = effect.load_stiffness(p) {
            self.load_stiffness = self.load_stiffness + stiffness;
        }
        if let Some(factor) = effect.contact_factor(p, self.load).filter(|_| self.load.value > 0.0) {
            self.contact_stiffness = self.contact_stiffness * factor;
            self.contact_damping = self.contact_damping * factor;
        }
        if let Some(rate) = effect.renewal(p, self.speed) {
            self.renewal = self.renewal + rate;
        }
        if let Some(angle) = effect.reading(p, self.omega) {
            self.phase_offset = self.phase_offset + angle;
        }
        keep_first(&mut self.branch, effect.branch(p));
        self.further_branches.extend(effect.further_branch(p));
        keep_first(&mut self.spring_pot, effect.fractional(p, self.omega));
        keep_first(&mut self.rate_element, effect.rate_element(p));
        keep_first(&mut self.support, effect.support(p));
        keep_first(&mut self.heating, effect.heating(p));
        keep_first(&mut self.joint, effect.joint(p));
        keep_first(&mut self.dry_friction, effect.dry_friction(p));
    }

    /// What the instrument shows of a motion of this complex amplitude: amplitude and phase in (-pi, pi].
    pub fn reading(&self, (re, im): (f64, f64)) -> (f64, f64) {
        let (re, im) = self.read_beside.as_ref().map_or((re, im), |by| (re + by.0.value, im + by.1.value));
        self.polar_reading(re.hypot(im), im.atan2(re))
    }

    /// The complex amplitude of the motion behind a reading of this amplitude and phase.
    pub fn motion(&self, (amplitude, phase): (f64, f64)) -> Complex<f64> {
        let read = Complex::from_polar(amplitude / self.amplitude_gain.value, phase - self.phase_offset.value);
        self.read_beside.as_deref().map_or(read, |(re, im)| read - Complex::new(re.value, im.value))
    }

    /// The same of an amplitude and a phase.
    pub fn polar_reading(&self, amplitude: f64, phase: f64) -> (f64, f64) {
        (self.amplitude_gain.value * amplitude, wrap(phase + self.phase_offset.value))
    }

    /// Complex amplitude \[rad\] of the arm without contact: Gamma e^{i phi0} / (K - J w^2 + i w C).
    pub fn free_response<T: Scalar>(&self) -> (T, T) {
        let w = self.omega;
        let re = T::of(&self.stiffness) - T::of(&self.inertia) * (w * w);
        let im = T::of(&self.damping) * w;
        divide((T::of(&self.torque_re), T::of(&self.torque_im)), (re, im))
    }

    /// Complex amplitude \[rad\] of the arm with the bristles stuck to a roller at rest (case II, with a compliant
    /// support, viscoelastic branches and a spring-pot where there are any).
    pub fn stuck_response<T: Scalar>(&self) -> (T, T) {
        let w = self.omega;
        let mut z = (T::of(&self.contact_stiffness), T::of(&self.contact_damping) * w);
        for (k1, tau) in self.branch.as_deref().into_iter().chain(&self.further_branches) {
            let wt = T::of(tau) * w;
            let scale = T::of(k1) * (wt * wt + T::constant(1.0)).recip();
            z = (z.0 + scale * wt * wt, z.1 + scale * wt);
        }
        if let Some((re, im)) = self.spring_pot.as_deref() {
            z = (z.0 + T::of(re), z.1 + T::of(im));
        }
        if let Some(support) = &self.support {
            let (mass, damping) = (T::of(&support.mass), T::of(&support.damping));
            let s = (T::of(&support.stiffness) - mass * (w * w), damping * w);
            let product = (z.0 * s.0 - z.1 * s.1, z.0 * s.1 + z.1 * s.0);
            z = divide(product, (z.0 + s.0, z.1 + s.1));
        }
        let arm = T::of(&self.arm);
        let b2 = arm * arm;
        let re = T::of(&self.stiffness) - T::of(&self.inertia) * (w * w) + b2 * z.0;
        let im = T::of(&self.damping) * w + b2 * z.1;
        divide((T::of(&self.torque_re), T::of(&self.torque_im)), (re, im))
    }
}

/// Of two effects that add the same the first counts.
fn keep_first<T>(own: &mut Option<Box<T>>, other: Option<T>) {
    if own.is_none() {
        *own = other.map(Box::new);
    }
}

/// The mode of a rig: M x'' + C x' + K x = torque, complex at the drive frequency.
struct Mode {
    inertia: Dual,
    damping: Dual,
    stiffness: Dual,
    torque: (Dual, Dual),
    arm: Dual,
    base_motion: Option<(Dual, Dual)>,
}

impl Mode {
    /// The paper's arm (Eqs. 1-8); `drive` is the motion of the actuator.
    fn of_arm([j, k0t, c0t, k0, c0, a, b]: [Dual; RIG_PARAMETERS], drive: Dual, omega: f64) -> Self {
        let u0 = drive * a;
        Self {
            inertia: j,
            damping: c0t + a * a * c0 * 2.0,
            stiffness: k0t + a * a * k0 * 2.0,
            torque: (u0 * k0, u0 * c0 * omega),
            arm: b,
            base_motion: None,
        }
    }

    /// Any oscillator; `drive` is a force, or the motion of base or spring differentiated `order` times.
    fn of_oscillator(
        of: &Oscillator,
        [mass, elasticity, dissipation, spring, dashpot, factor, participation]: [Dual; RIG_PARAMETERS],
        drive: Dual,
        order: u8,
        omega: f64,
    ) -> Self {
        let stiffness = match of.elasticity_form {
            Elasticity::Stiffness => elasticity,
            Elasticity::NaturalFrequency => mass * elasticity * elasticity * (TAU * TAU),
        };
        let damping = match of.dissipation_form {
            Dissipation::Damping => dissipation,
            Dissipation::QualityFactor => (mass * stiffness).sqrt() / dissipation,
            Dissipation::DampingRatio => (mass * stiffness).sqrt() * dissipation * 2.0,
        };
        // The motion of base or spring, in phase with what is measured of it.
        let moved = if order == 2 { drive * (-1.0 / (omega * omega)) } else { drive };
        let none = Dual::constant(0.0);
        let torque = match of.excitation {
            Excitation::Force => (drive, none),
            Excitation::Base => (participation * mass * moved * (omega * omega), none),
            Excitation::Spring => (spring * moved, dashpot * moved * omega),
        };
        let base_motion = of.absolute.then_some((moved, none));
        Self { inertia: mass, damping, stiffness, torque, arm: factor, base_motion }
    }
}

fn divide<T: Scalar>(n: (T, T), d: (T, T)) -> (T, T) {
    let inverse = (d.0 * d.0 + d.1 * d.1).recip();
    ((n.0 * d.0 + n.1 * d.1) * inverse, (n.1 * d.0 - n.0 * d.1) * inverse)
}
