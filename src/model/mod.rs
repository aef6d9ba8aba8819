//! Rig, contact and effects assembled into the equations of one operating point; no numerics.
//!
//! The arm is described relative to its motion without contact, th = Im(Ad e^{iwt}) + z0, so that a constant contact force
//! (full slip) leaves the limiting case III exact and the drive never has to be integrated.

pub mod contact;
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
}
