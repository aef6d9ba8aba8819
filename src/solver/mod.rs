//! Steady states. Knows no physics beyond the shape of the equations handed in by [`crate::model`].

pub mod analytic;
mod balance;
mod collocation;
mod columns;
mod cubic;
pub mod cycle;
mod dense;
pub mod describing;
mod eliminated;
mod elimination;
mod events;
pub mod exponential;
pub mod flow;
mod harmonic;
mod healing;
mod integrated;
mod integration;
mod joint;
pub mod lu;
mod observables;
mod orbit;
pub mod oscillator;
pub mod paper_euler;
pub mod parallel;
mod period;
mod prediction;
pub mod radau;
pub mod sensitivity;
pub mod shooting;
mod slider;
mod sliders;
mod stages;
mod steady;
mod stopping;
pub mod time;
mod tolerance;

pub use integrated::{Integrated, integrated, plan_for};
pub use observables::Solution;
pub use orbit::{orbit, solve_paper};
pub use paper_euler::LANES;
pub use steady::{Warm, solve, solve_steady};

/// Whether the point is a steady state, and if not, why.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind", content = "reason")]
pub enum Status {
    /// Periodic at the drive frequency within the tolerance.
    Steady,
    /// The periodic solution is unstable, or none was approached: the numbers are a lock-in average.
    SelfExcited(String),
    /// The body sticks: friction holds it against the drive, and the amplitude is zero.
    Stuck,
    /// No answer; the numbers are NaN.
    Failed(String),
}

impl Status {
    /// Whether it is a steady state, a body at rest included.
    pub fn is_steady(&self) -> bool {
        matches!(self, Self::Steady | Self::Stuck)
    }

    /// One word for tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::SelfExcited(_) => "self-excited",
            Self::Stuck => "stuck",
            Self::Failed(_) => "failed",
        }
    }
}

/// How a steady state was obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Limiting case in closed form.
    Analytic,
    /// The published explicit Euler procedure.
    PaperEuler,
    /// Fourier series of a motion that stays in one mode.
    HarmonicBalance,
    /// Newton shooting on a collocation integrator with exact events.
    Shooting,
    /// Plain time integration until the transient has died out.
    TimeIntegration,
}

/// Observables of one steady state; angles in rad, SI units, phase in (-pi, pi] relative to the actuator.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SteadyState {
    /// alpha, amplitude of the component of the angle at the drive frequency \[rad\].
    pub amplitude: f64,
    /// phi, phase of that component \[rad\].
    pub phase: f64,
    /// th0, mean angle \[rad\].
    pub mean: f64,
    /// b w alpha, amplitude of the arm's speed at the contact \[m/s\].
    pub speed_amplitude: f64,
    /// Share of the cycle during which the interface sticks, 0..1.
    pub stick_fraction: f64,
    /// Smallest tangential force over the cycle \[N\].
    pub force_minimum: f64,
    /// Largest tangential force over the cycle \[N\].
    pub force_maximum: f64,
    /// Cycles followed to reach the state (sum over Newton iterations for shooting, those of a prediction included; 0
    /// for closed forms; evaluations of the laws over a cycle for harmonic balance).
    pub cycles: usize,
    /// Relative change of the state over a cycle from the start that was found \[-\]: of the last cycle, or as
    /// estimated where a Newton step followed it that leaves next to nothing.
    pub periodicity_error: f64,
    /// Whether it is a steady state.
    pub status: Status,
    /// How it was obtained.
    pub method: Method,
}

/// One period of a steady state, sampled uniformly in time (the last sample is one step before the end of the period).
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Orbit {
    /// Time since the actuator passed zero upwards \[s\].
    pub time: Vec<f64>,
    /// th, angle \[rad\].
    pub angle: Vec<f64>,
    /// th', angular velocity \[rad/s\].
    pub velocity: Vec<f64>,
    /// x, stretch of the bristles \[m\].
    pub stretch: Vec<f64>,
    /// s, slip rate at the interface \[m/s\].
    pub slip_rate: Vec<f64>,
    /// F, tangential force on the arm \[N\].
    pub force: Vec<f64>,
}
