//! Rig, contact and effects assembled into the equations of one operating point; no numerics.
//!
//! The arm is described relative to its motion without contact, th = Im(Ad e^{iwt}) + z0, so that a constant contact force
//! (full slip) leaves the limiting case III exact and the drive never has to be integrated.

pub mod contact;
pub mod continuum;
pub mod dual;
pub mod lumps;
pub mod system;

use crate::effects::{self, Effect};
use crate::scenario::{Contact, Instrument, Rig, Scenario};

/// Setting of one steady state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operation {
    /// V, speed of the roller \[m/s\].
    pub speed: f64,
    /// W, normal load \[N\].
    pub load: f64,
    /// u0, stated amplitude of the actuator \[m\].
    pub drive: f64,
    /// f, frequency \[Hz\].
    pub frequency: f64,
}

/// Rig, contact, instrument and effects: everything but the operating point.
#[derive(Clone)]
pub struct Model {
    /// The rig.
    pub rig: Rig,
    /// The contact.
    pub contact: Contact,
    /// The instrument.
    pub instrument: Instrument,
    /// Effects with their parameters in SI.
    pub effects: Vec<(&'static dyn Effect, Vec<f64>)>,
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let effects: Vec<_> = self.effects.iter().map(|(effect, values)| (effect.name(), values)).collect();
        let mut shown = f.debug_struct("Model");
        shown.field("rig", &self.rig).field("contact", &self.contact).field("instrument", &self.instrument);
        shown.field("effects", &effects).finish()
    }
}

impl Model {
    /// The model a validated scenario describes.
    pub fn new(scenario: &Scenario) -> Self {
        let effects = scenario
            .effects
            .iter()
            .filter_map(|setting| effects::find(&setting.name).map(|effect| (effect, setting.parameters.clone())))
            .collect();
        Self { rig: scenario.rig, contact: scenario.contact, instrument: scenario.instrument, effects }
    }

    /// Whether an effect makes the contact a continuum of sliders.
    pub fn has_continuum(&self) -> bool {
        self.effects.iter().any(|(effect, p)| effect.continuum(p).is_some())
    }

    /// The parameter number `index` in the order of [`lumps::BASE_PARAMETERS`] and then of the effects, or None where
    /// there is none of that number.
    pub fn parameter<'a>(&'a mut self, at: &'a mut Operation, index: usize) -> Option<&'a mut f64> {
        let (rig, contact, instrument) = (&mut self.rig, &mut self.contact, &mut self.instrument);
        Some(match index {
            0 => &mut rig.inertia,
            1 => &mut rig.torsional_stiffness,
            2 => &mut rig.torsional_damping,
            3 => &mut rig.spring_stiffness,
            4 => &mut rig.spring_damping,
            5 => &mut rig.spring_arm,
            6 => &mut rig.contact_arm,
            7 => &mut contact.stiffness,
            8 => &mut contact.damping,
            9 => &mut contact.friction,
            10 => &mut instrument.drive_gain,
            11 => &mut instrument.amplitude_gain,
            12 => &mut instrument.phase_offset,
            13 => &mut at.speed,
            14 => &mut at.load,
            15 => &mut at.drive,
            _ => return self.effects.iter_mut().flat_map(|(_, p)| p).nth(index - lumps::FIRST_EFFECT_PARAMETER),
        })
    }

    /// Whether a torque of the arm itself is nonlinear, so that it may have several steady states.
    pub fn may_fold(&self) -> bool {
        self.effects.iter().any(|(effect, p)| effect.torque(p, 0.0, 0.0).is_some())
    }
}
