//! Rig, contact and effects assembled into the equations of one operating point; no numerics.
//!
//! The arm is described relative to its motion without contact, th = Im(Ad e^{iwt}) + z0, so that a constant contact
//! force (full slip) leaves the limiting case III exact and the drive never has to be integrated.

pub mod alone;
pub mod contact;
pub mod continuum;
pub mod lumps;
pub mod relaxations;
mod scales;
pub mod system;

use crate::dual::Dual;
use crate::effects::{Effect, REGISTRY, fits_rig, for_series, is_law, remembers, slides};
use crate::parameter::{FIRST_CONTACT_PARAMETER, FIRST_INSTRUMENT_PARAMETER, ParameterInfo, Scales};
use crate::scenario::parameters::CONTACT;
use crate::scenario::{Contact, Instrument, Rig, Scenario, Signals};

/// Setting of one steady state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operation {
    /// V, speed of the roller \[m/s\].
    pub speed: f64,
    /// W, normal load \[N\].
    pub load: f64,
    /// Stated amplitude of the drive, of the paper's actuator u0 \[m\].
    pub drive: f64,
    /// f, frequency \[Hz\].
    pub frequency: f64,
    /// Number of the series that it is of, the first being 0; also where there are no series.
    pub series: usize,
}

/// Rig, contact, instrument and effects: everything but the operating point.
#[derive(Clone)]
pub struct Model {
    /// The rig.
    pub rig: Rig,
    /// The contact; without one it is that of no stiffness, which no load presses on.
    pub contact: Contact,
    /// Whether the scenario has a contact.
    pub has_contact: bool,
    /// The instrument.
    pub instrument: Instrument,
    /// What is driven and what is read.
    pub signals: Signals,
    /// Sizes of the rig and its motion.
    pub scales: Scales,
    /// Effects with their parameters in SI.
    pub effects: Vec<(&'static dyn Effect, Vec<f64>)>,
    /// Formulas of the scenario that are stated without strength: they may be added, as the effects of the catalogue.
    pub candidates: Vec<&'static dyn Effect>,
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
        let (candidates, present): (Vec<_>, Vec<_>) =
            scenario.effects.iter().partition(|setting| setting.is_candidate(&scenario.free));
        Self {
            rig: scenario.rig,
            contact: scenario.contact.unwrap_or(Contact::NONE),
            has_contact: scenario.contact.is_some(),
            instrument: scenario.instrument,
            signals: scenario.signals,
            scales: Scales { has_contact: scenario.contact.is_some(), ..Scales::PAPER },
            effects: present.into_iter().map(|setting| (setting.effect, setting.parameters.clone())).collect(),
            candidates: candidates.into_iter().map(|setting| setting.effect).collect(),
        }
    }

    /// Everything that may be added: effects of the catalogue that fit the rig and the series measured, and formulas.
    pub fn catalogue(&self) -> impl Iterator<Item = &'static dyn Effect> + '_ {
        let registered = REGISTRY.iter().copied().filter(|effect| fits_rig(*effect, self.has_contact).is_ok());
        let registered = registered.filter_map(|effect| for_series(effect, self.scales.series).ok());
        registered.chain(self.candidates.iter().copied())
    }

    /// Whether the sign of the one parameter of effect number `index` leaves no trace in what is read: without a
    /// contact and beside odd laws, the body moves the other way round with the other sign, and its fundamental is the
    /// same.
    pub fn hides_sign(&self, index: usize) -> bool {
        let mut others = self.effects.iter().enumerate().filter(|(other, _)| *other != index);
        let Some((effect, [_])) = self.effects.get(index).map(|(effect, p)| (*effect, &p[..])) else { return false };
        let force = |p: f64, x: f64, v: f64| effect.torque(&[p], x, v).unwrap_or_default().value;
        let mirrored = |(x, v): (f64, f64)| force(-1.0, x, v) == -force(1.0, -x, -v);
        !self.has_contact
            && !effect.torque_is_odd()
            && [(1.0, 0.3), (-0.6, 1.0), (0.2, -0.7)].into_iter().all(mirrored)
            && others.all(|(_, (effect, _))| effect.torque_is_odd())
    }

    /// Whether only the solver of sliders can carry an effect: the contact is a continuum of them, or its bristles
    /// remember.
    pub fn has_sliders(&self) -> bool {
        self.effects.iter().any(|(effect, p)| slides(*effect, p))
    }

    /// Whether the force of its bristles depends on more of their history than states tell.
    pub fn remembers(&self) -> bool {
        self.effects.iter().any(|(effect, p)| slides(*effect, p) && effect.continuum(p).is_none())
    }

    /// Laws by which friction depends on the slip rate.
    pub fn friction_laws(&self) -> usize {
        self.effects.iter().filter(|(effect, p)| effect.friction(p, 0.0, 0.0).is_some()).count()
    }

    /// Whether its bristles follow a hysteresis of their own.
    pub fn has_hysteresis(&self) -> bool {
        self.effects.iter().any(|(effect, p)| remembers(*effect, p))
    }

    /// Whether a force that is not linear acts beside the elements that share the contact.
    pub fn has_law_beside_sliders(&self) -> bool {
        self.effects.iter().any(|(effect, p)| !slides(*effect, p) && is_law(*effect, p))
    }

    /// Whether an effect is a joint that slips bit by bit.
    pub fn has_joint(&self) -> bool {
        let joint = |p: &[f64]| p.iter().map(|&x| Dual::constant(x)).collect::<Vec<_>>();
        self.effects.iter().any(|(effect, p)| effect.joint(&joint(p)).is_some())
    }

    /// Whether dry friction may stop a body without a contact.
    pub fn has_dry_friction(&self) -> bool {
        let dual = |p: &[f64]| p.iter().map(|&x| Dual::constant(x)).collect::<Vec<_>>();
        self.effects.iter().any(|(effect, p)| effect.dry_friction(&dual(p)).is_some())
    }

    /// Whether a force has a slope that jumps, or one of a joint.
    pub fn has_corners(&self) -> bool {
        let corners = |(effect, p): &(&dyn Effect, Vec<f64>)| !effect.is_smooth() || effect.torque_is_rough(p);
        self.has_joint() || self.effects.iter().any(corners)
    }

    /// Whether a damping has a slope without bound at rest.
    pub fn is_steep(&self) -> bool {
        self.effects.iter().any(|(effect, p)| effect.torque_is_steep(p))
    }

    /// The parameter number `index`: rig, contact, instrument, operating point ([`crate::parameter`] states where each
    /// begins), then the effects; or None where there is none of that number.
    pub fn parameter<'a>(&'a mut self, at: &'a mut Operation, index: usize) -> Option<&'a mut f64> {
        use crate::parameter::{FIRST_CONTACT_PARAMETER as CONTACT, FIRST_EFFECT_PARAMETER as EFFECT};
        let (contact, instrument) = (&mut self.contact, &mut self.instrument);
        if index < CONTACT {
            return self.rig.slot(index);
        }
        if index >= EFFECT {
            return self.effects.iter_mut().flat_map(|(_, p)| p).nth(index - EFFECT);
        }
        Some(match index - CONTACT {
            0 => &mut contact.stiffness,
            1 => &mut contact.damping,
            2 => &mut contact.friction,
            3 => &mut instrument.drive_gain,
            4 => &mut instrument.amplitude_gain,
            5 => &mut instrument.phase_offset,
            6 => &mut at.speed,
            7 => &mut at.load,
            _ => &mut at.drive,
        })
    }

    /// Keys of the parameters of rig, contact and instrument, as in `[fit] free`, with their index and what is known of
    /// them.
    pub fn base_parameters(&self) -> Vec<(String, usize, &'static ParameterInfo)> {
        let keyed = |table: &str, first: usize, at: usize, info: &'static ParameterInfo| {
            (format!("{table}.{}", info.key), first + at, info)
        };
        let rig = self.rig.parameters().into_iter().map(|(at, info)| keyed("rig", 0, at, info));
        let contact = CONTACT.iter().filter(|_| self.has_contact).enumerate();
        let contact = contact.map(|(at, info)| keyed("contact", FIRST_CONTACT_PARAMETER, at, info));
        let instrument = self.instrument.parameters().into_iter().enumerate();
        let instrument = instrument.map(|(at, info)| keyed("instrument", FIRST_INSTRUMENT_PARAMETER, at, info));
        rig.chain(contact).chain(instrument).collect()
    }

    /// Whether a torque of the arm itself is nonlinear, so that it may have several steady states.
    pub fn may_fold(&self) -> bool {
        self.effects.iter().any(|(effect, p)| effect.torque(p, 0.0, 0.0).is_some())
    }
}
