//! Figures of a series of trials: a [`Summary`] in, SVG, CSV and caption out.

mod confusion;
mod coverage;
mod fall;
mod power;

use super::Figure;
use crate::trial::Summary;

/// Every figure of a series of trials, in the order in which they are shown.
pub static REGISTRY: &[&dyn Figure<Summary>] =
    &[&confusion::ConfusionMatrix, &coverage::Intervals, &fall::ErrorFall, &power::Power];

/// Those that need no more than the scores.
pub static OF_SCORES: &[&dyn Figure<Summary>] = &[&power::Power];
