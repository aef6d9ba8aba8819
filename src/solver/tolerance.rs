//! What is demanded of an integration.

use super::time::Plan;

/// Relative change over a cycle that the last Newton step may leave at the default tolerance.
const LEFT: f64 = 1e-8;
/// Relative error of a steady state at the default tolerance, about.
const ERROR: f64 = 1e-6;

/// Demands on the integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Smallest number of steps per period.
    pub steps: usize,
    /// Largest deviation of the slip rate from its polynomial over a step, relative to its scale.
    pub roughness: f64,
    /// Most cycles integrated in one search for a periodic state.
    pub cycles: usize,
    /// Most steps integrated in one search.
    pub budget: usize,
}

impl Tolerance {
    /// For searches over many models: errors of 1e-4, and points that are hard to solve are given up soon.
    pub const COARSE: Self = Self { steps: 12, roughness: 1e-2, cycles: 30, budget: 400 };

    /// For fits to all points: errors of 1e-5, and points that are hard to solve are given up before long.
    pub const FIT: Self = Self { steps: 18, roughness: 1e-3, cycles: 60, budget: 1500 };
}

impl Tolerance {
    /// The same, if not finer than a fit needs on its way to a minimum.
    pub fn for_search(self) -> Self {
        if self.steps > Self::FIT.steps { Self::FIT } else { self }
    }

    /// Relative error of a steady state, about.
    pub fn error(&self) -> f64 {
        ERROR * self.slack()
    }

    /// Whether points that are hard to solve are given up.
    pub(super) fn gives_up(&self) -> bool {
        self.budget < Self::default().budget
    }

    /// Whether exactly the steps asked for are wanted, to measure the order of convergence: an infinite roughness says
    /// so.
    pub(super) fn measures_order(&self) -> bool {
        self.roughness.is_infinite()
    }

    /// Factor >= 1 by which steps may be longer than by default: where fewer of them are asked for, that holds for
    /// those too that follow from the damping of the arm and from the roughness.
    pub(super) fn coarsening(&self) -> f64 {
        (Self::default().steps as f64 / self.steps.max(1) as f64).max(1.0)
    }

    /// Relative change of the states over a cycle that may be left by the last Newton step.
    pub(super) fn left(&self) -> f64 {
        LEFT * self.slack()
    }

    /// Factor >= 1 on what is small by default.
    pub(super) fn slack(&self) -> f64 {
        self.coarsening().powi(7)
    }
}

/// As many steps at most as those of the integration in time that follows where a search finds nothing.
impl Default for Tolerance {
    fn default() -> Self {
        let last = Plan::LOCK_IN;
        Self { steps: 24, roughness: 1e-3, cycles: 250, budget: last.steps * (last.cycles + last.window) }
    }
}
