//! One period of a hybrid system: what it amounts to, and of what parts it is made.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::dense::{Matrix, multiply};
use super::flow::Segment;
use super::radau::{State, Stepper, Taken};
use super::sensitivity::Stretch;
use crate::model::system::{MAX_STATES, Mode};

/// States at time 0 with the mode and the algebraic unknown there.
pub type Start = (State, (Mode, f64));

/// What a step leaves behind for a recorder: times, states and algebraic unknown at the start and the stages.
pub struct Record<'a> {
    /// Time at the start \[s\].
    pub time: f64,
    /// Size of the step \[s\].
    pub size: f64,
    /// States at the start.
    pub start: &'a State,
    /// Algebraic unknown at the start.
    pub slip: f64,
    /// The stages.
    pub stepper: &'a Stepper,
    /// Mode over the step.
    pub mode: Mode,
}

/// Result of one period.
#[derive(Debug, Clone)]
// Wide: what one integration gathers at once; each search for a period takes other parts.
pub struct Cycle {
    /// States at the end.
    pub end: State,
    /// Mode and algebraic unknown at the start and at the end.
    pub branch: [(Mode, f64); 2],
    /// Derivative of `end` by the states at the start.
    pub monodromy: Matrix,
    /// Fundamental of state 0: complex A with z0 = Im(A e^{iwt}) + ... (real, imaginary).
    pub fundamental: (f64, f64),
    /// Derivatives of the fundamental by the states at the start (real, imaginary).
    pub fundamental_by_start: [(f64, f64); MAX_STATES],
    /// Mean of state 0.
    pub mean: f64,
    /// Its derivatives by the states at the start; not gathered on exact flows.
    pub mean_by_start: State,
    /// Stretches on exact flows.
    pub segments: usize,
    /// Whether mean and extremes of the force are complete.
    pub observed: bool,
    /// Share of the period in [`Mode::Stick`].
    pub stick_fraction: f64,
    /// Extremes of the force.
    pub force: (f64, f64),
    /// Steps taken.
    pub steps: usize,
    /// Changes of mode.
    pub events: usize,
}

impl Cycle {
    /// Carries the cycle over to a start that is a small Newton step `delta` away.
    pub fn shift(&mut self, n: usize, delta: &State) {
        for j in 0..n {
            self.fundamental.0 += self.fundamental_by_start[j].0 * delta[j];
            self.fundamental.1 += self.fundamental_by_start[j].1 * delta[j];
            self.mean += self.mean_by_start[j] * delta[j];
            for i in 0..n {
                self.end[i] += self.monodromy[i][j] * delta[j];
            }
        }
    }

    /// Adds an exact stretch, a share of the period in one mode.
    pub fn follow(&mut self, segment: &Segment, mode: Mode, share: f64, n: usize) {
        let mut through = [[0.0; MAX_STATES]; MAX_STATES];
        multiply(n, n, &segment.transition, &self.monodromy, &mut through);
        self.fundamental.0 += segment.fundamental.0;
        self.fundamental.1 += segment.fundamental.1;
        for (by_start, column) in self.fundamental_by_start.iter_mut().zip(0..n) {
            for (row, by) in self.monodromy.iter().zip(&segment.fundamental_by_start).take(n) {
                by_start.0 += by.0 * row[column];
                by_start.1 += by.1 * row[column];
            }
        }
        self.monodromy = through;
        self.mean += segment.mean;
        self.force = (self.force.0.min(segment.force.0), self.force.1.max(segment.force.1));
        self.stick_fraction += if mode == Mode::Stick { share } else { 0.0 };
        self.steps += 1;
        self.segments += 1;
        self.observed &= segment.observed;
    }
}

/// A part of an orbit.
pub enum Part {
    /// An exact stretch.
    Segment(Box<(Stretch, Segment)>),
    /// A step.
    Step(Box<Taken>),
}
