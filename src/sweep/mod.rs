//! The sweep engine: every point of a scenario, in input order, on all threads.

mod run;

pub use run::{Options, at_condition, conditions, curve, driven_curve, limiting_oscillator, run};

use crate::scenario::{Formulation, Scenario};
use crate::solver::{Orbit, SteadyState};

/// The setting of one steady state apart from its frequency.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Condition {
    /// Formulation solved.
    pub formulation: Formulation,
    /// Steps per cycle of the Euler procedure (meaningful for [`Formulation::Paper`]).
    pub euler_steps: usize,
    /// u0, stated amplitude of the actuator \[m\].
    pub drive: f64,
    /// W, normal load \[N\].
    pub load: f64,
    /// mu, coefficient of friction \[-\].
    pub friction: f64,
    /// V, speed of the roller \[m/s\].
    pub speed: f64,
    /// Number of the measured series that it is of, the first being 0; also where there is none.
    #[serde(skip)]
    pub series: usize,
}

/// A resonance curve: one condition over all frequencies of the sweep.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Curve {
    /// The condition.
    pub condition: Condition,
    /// f, frequencies \[Hz\].
    pub frequency: Vec<f64>,
    /// One steady state per frequency.
    pub states: Vec<SteadyState>,
    /// Where the arm has more than one steady state: what sweeping the frequency downwards finds, one entry per
    /// frequency, `None` where it is the state in `states`, which were found sweeping upwards. Empty for arms that have
    /// but one.
    pub down: Vec<Option<SteadyState>>,
    /// One orbit per frequency where orbits were asked for, otherwise empty.
    #[serde(skip)]
    pub orbits: Vec<Orbit>,
}

/// A limiting case in closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LimitingCase {
    /// Case I, no contact; case III, full slip, has the same curve.
    FreeOrFullSlip,
    /// Case II, static contact.
    StaticContact,
}

/// Closed-form curve of a limiting case for one drive.
#[derive(Debug, Clone, serde::Serialize)]
pub struct LimitCurve {
    /// Which case.
    pub case: LimitingCase,
    /// u0, stated amplitude of the actuator \[m\].
    pub drive: f64,
    /// f, a fine grid over the range of the sweep \[Hz\].
    pub frequency: Vec<f64>,
    /// alpha \[rad\].
    pub amplitude: Vec<f64>,
    /// phi \[rad\].
    pub phase: Vec<f64>,
    /// b w alpha \[m/s\].
    pub speed_amplitude: Vec<f64>,
    /// Frequency of the largest alpha \[Hz\], refined to the maximum of the closed form.
    pub peak_frequency: f64,
    /// Largest alpha \[rad\].
    pub peak_amplitude: f64,
    /// Frequency of the largest b w alpha \[Hz\].
    pub speed_peak_frequency: f64,
    /// Largest b w alpha \[m/s\].
    pub speed_peak: f64,
}

/// Everything a scenario's sweep gave.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Outcome {
    /// The scenario that was run.
    pub scenario: Scenario,
    /// Curves in the order of the axes: formulation, Euler steps, drive, load, friction, speed.
    pub curves: Vec<Curve>,
    /// Limiting cases, both for every drive.
    pub limits: Vec<LimitCurve>,
    /// Wall time of the sweep \[s\]; provenance only, never compared.
    #[serde(skip)]
    pub seconds: f64,
}
