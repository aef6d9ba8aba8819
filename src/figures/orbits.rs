//! Points whose orbits were kept, as the figures of loops and histories show them.

use super::FigureError;
use super::axes::range;
use super::data;
use super::style::{Unit, significant};
use crate::solver::{Orbit, Status, SteadyState};
use crate::sweep::{Condition, Outcome};

/// A share of the Coulomb limit that is rounding.
pub const ROUNDING: f64 = 1e-9;

/// Most points shown in one figure.
const MOST: usize = 6;

/// A point with its orbit.
#[derive(Debug, Clone, Copy)]
pub struct Cycle<'a> {
    /// The condition.
    pub condition: &'a Condition,
    /// f \[Hz\].
    pub frequency: f64,
    /// The observables.
    pub state: &'a SteadyState,
    /// The orbit.
    pub orbit: &'a Orbit,
    /// b, arm of the contact \[m\].
    pub arm: f64,
}

impl Cycle<'_> {
    /// Number of samples.
    pub fn len(&self) -> usize {
        let o = self.orbit;
        [o.angle.len(), o.velocity.len(), o.slip_rate.len(), o.force.len()].into_iter().fold(o.time.len(), usize::min)
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Displacement of the arm at the contact from its mean \[m\].
    pub fn displacement(&self, index: usize) -> f64 {
        self.arm * (self.orbit.angle[index] - self.state.mean)
    }

    /// Force less the Coulomb limit mu W \[N\].
    pub fn force(&self, index: usize) -> f64 {
        self.orbit.force[index] - self.condition.friction * self.condition.load
    }

    /// Speed of the arm at the contact \[m/s\].
    pub fn velocity(&self, index: usize) -> f64 {
        self.arm * self.orbit.velocity[index]
    }

    /// Whether the interface sticks at a sample: slip below a thousandth of the speeds at play.
    pub fn sticks(&self, index: usize) -> bool {
        let scale = self.condition.speed + self.state.speed_amplitude.abs();
        self.condition.load > 0.0 && self.orbit.slip_rate[index].abs() <= 1e-3 * scale
    }

    /// The regime in words.
    pub fn regime(&self) -> &'static str {
        match self.state.stick_fraction {
            _ if self.condition.load == 0.0 => "no contact",
            share if share <= 0.0 => "full slip",
            share if share >= 1.0 => "static",
            share if share > 0.8 => "nearly static",
            _ => "partial stick",
        }
    }

    /// Two lines that name the point: frequency and speed, regime and share.
    pub fn name(&self) -> [String; 2] {
        let speed = Unit::speed().show(self.condition.speed, 4);
        let share = 100.0 * self.state.stick_fraction;
        let excited = if self.state.status == Status::Steady { "" } else { ", not steady" };
        [
            format!("{} Hz, V = {speed}", significant(self.frequency, 5)),
            format!("{}: {share:.0} % stick{excited}", self.regime()),
        ]
    }
}

/// The points with orbits, at most six, spread evenly; and how many were left out.
///
/// # Errors
/// [`FigureError::MissingData`] where no orbit was kept.
pub fn cycles<'a>(outcome: &'a Outcome, figure: &str) -> Result<(Vec<Cycle<'a>>, usize), FigureError> {
    data::with_contact(outcome, figure)?;
    let arm = outcome.scenario.rig.lever();
    let of_curve = |curve: &'a crate::sweep::Curve| {
        let points = curve.frequency.iter().zip(&curve.states).zip(&curve.orbits);
        points.map(move |((&frequency, state), orbit)| Cycle {
            condition: &curve.condition,
            frequency,
            state,
            orbit,
            arm,
        })
    };
    let failed = |cycle: &Cycle<'_>| matches!(cycle.state.status, Status::Failed(_));
    let all: Vec<Cycle<'_>> = outcome.curves.iter().flat_map(of_curve).filter(|c| c.len() > 3 && !failed(c)).collect();
    if all.is_empty() {
        return Err(FigureError::missing(
            figure,
            "orbits: a sweep of a few frequencies and speeds, run with this figure requested",
        ));
    }
    let shown = data::spread(&all, MOST);
    let left_out = all.len() - shown.len();
    Ok((shown, left_out))
}

/// What the caption says about points that are not shown.
pub fn left_out(count: usize) -> String {
    if count == 0 { String::new() } else { format!(" {count} further points with orbits are not shown.") }
}

/// Range of an axis for the force of one point less mu W, in `unit`; one unit either way where only rounding would
/// show.
pub fn force_range(cycle: &Cycle<'_>, unit: &Unit) -> (f64, f64) {
    let (lowest, highest) = range((0..cycle.len()).map(|i| cycle.force(i)));
    if highest - lowest <= ROUNDING * cycle.condition.friction * cycle.condition.load {
        return (-1.0, 1.0);
    }
    let (lowest, highest) = (unit.of(lowest), unit.of(highest));
    let pad = 0.08 * (highest - lowest);
    (lowest - pad, highest + pad)
}

/// The unit that suits the forces less mu W; mN where they never leave that limit and only rounding would show.
pub fn force_unit(cycles: &[Cycle<'_>]) -> Unit {
    let forces = cycles.iter().flat_map(|c| (0..c.len()).map(|i| c.force(i).abs()));
    let (largest, limits) = (range(forces).1, cycles.iter().map(|c| c.condition.friction * c.condition.load));
    if largest > ROUNDING * limits.fold(0.0, f64::max) { Unit::fitting(largest, "N") } else { Unit::new(1e-3, "mN") }
}
