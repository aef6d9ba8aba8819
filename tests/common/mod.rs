//! What several tests need: the paper's rig, built by hand so that the tests do not lean on the scenario reader.
#![allow(dead_code)]

use stickslip::effects::Scales;
use stickslip::model::{Model, Operation};
use stickslip::scenario::{
    Contact, Coordinate, Dissipation, Elasticity, Excitation, Formulation, Instrument, Oscillator, Rig, Signals,
    TorsionalArm,
};
use stickslip::solver::{SteadyState, Warm, cycle::Tolerance, solve};

/// Steps per cycle of the Euler procedure where a test does not say.
pub const EULER_STEPS: usize = 20_000;

/// The paper's printed values, no effect.
pub fn paper_model(formulation: Formulation) -> Model {
    Model {
        rig: Rig::TorsionalArm(TorsionalArm {
            inertia: 5.0e-3,
            torsional_stiffness: 990.0,
            torsional_damping: 0.43,
            spring_stiffness: 1.6e4,
            spring_damping: 12.0,
            spring_arm: 0.03,
            contact_arm: 0.06,
        }),
        contact: Contact { stiffness: 8.9e4, damping: 26.0, friction: 0.5, formulation },
        has_contact: true,
        signals: Signals::ARM,
        scales: Scales::PAPER,
        instrument: Instrument::default(),
        effects: Vec::new(),
        candidates: Vec::new(),
    }
}

/// A mass on a spring, driven by a force.
pub fn oscillator(mass: f64, frequency: f64, quality: f64) -> Model {
    let rig = Rig::Oscillator(Oscillator {
        coordinate: Coordinate::Displacement,
        excitation: Excitation::Force,
        absolute: false,
        mass,
        mass_stated: true,
        elasticity: frequency,
        elasticity_form: Elasticity::NaturalFrequency,
        dissipation: quality,
        dissipation_form: Dissipation::QualityFactor,
        spring_stiffness: 0.0,
        spring_damping: 0.0,
        contact_factor: 0.0,
        participation: 1.0,
    });
    Model {
        rig,
        contact: Contact::NONE,
        has_contact: false,
        instrument: Instrument::default(),
        signals: rig.signals(),
        scales: Scales::PAPER,
        candidates: Vec::new(),
        effects: Vec::new(),
    }
}

/// Operating point at the paper's load and drive.
pub fn at(speed: f64, frequency: f64) -> Operation {
    Operation { speed, load: 20.0, drive: 2.5e-6, frequency, series: 0 }
}

/// Steady state from a cold start.
pub fn steady(model: &Model, at: &Operation) -> SteadyState {
    solve(model, at, EULER_STEPS, &Tolerance::default(), false, &mut Warm::default()).state
}

/// Complex amplitude of a steady state.
pub fn complex(state: &SteadyState) -> (f64, f64) {
    (state.amplitude * state.phase.cos(), state.amplitude * state.phase.sin())
}

/// Relative distance of two steady states in the complex plane.
pub fn distance(a: &SteadyState, b: &SteadyState) -> f64 {
    let (a1, b1) = (complex(a), complex(b));
    (a1.0 - b1.0).hypot(a1.1 - b1.1) / b.amplitude
}

/// Random numbers between 0 and 1.
pub struct Random(pub u64);

impl Random {
    /// Evenly between 0 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly over the logarithm.
    pub fn between(&mut self, (low, high): (f64, f64)) -> f64 {
        let low = low.max(1e-6 * high);
        low * (high / low).powf(self.next())
    }
}
