//! Causes that the catalogue does not have, with a time integration of their own. None of them is an effect of the
//! registry, so that no search can find one: at best it says that something is left unexplained.

mod backlash;
mod cubic_spring;
mod rig;
mod run_out;

pub use rig::reading;

use crate::model::Model;
use crate::parameter::ParameterInfo;

/// A slow change of the normal load with the angle of the roller, W (1 + share sin(phase + V t/radius)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunOut {
    /// Share e of the load \[-\].
    pub share: f64,
    /// Radius R of the roller \[m\].
    pub radius: f64,
    /// Angle of the roller at the start of a reading \[rad\].
    pub phase: f64,
}

/// In what a rig departs from the base.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Departure {
    /// Cubic stiffness of the bristles \[N/m^3\].
    pub cubic: f64,
    /// Width of the gap in either pinching spring \[m\].
    pub gap: f64,
    /// Run-out of the roller.
    pub run_out: Option<RunOut>,
}

/// A cause outside the catalogue.
pub trait Outside: Sync {
    /// Name in lists and files, in kebab-case.
    fn name(&self) -> &'static str;
    /// What it is, in a phrase.
    fn title(&self) -> &'static str;
    /// Its parameters with the ranges that draws cover.
    fn parameters(&self) -> &'static [ParameterInfo];
    /// What it changes in the rig of `model` at these parameters, for the reading number `ordinal` of a table.
    fn departure(&self, p: &[f64], model: &Model, speed: f64, ordinal: usize) -> Departure;
}

/// All of them.
pub static OUTSIDE: &[&dyn Outside] = &[&run_out::RollerRunOut, &backlash::Backlash, &cubic_spring::CubicSpring];

/// The cause of that name.
pub fn find(name: &str) -> Option<&'static dyn Outside> {
    OUTSIDE.iter().copied().find(|cause| cause.name() == name)
}
