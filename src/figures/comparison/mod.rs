//! Figures of a comparison: a [`Comparison`] in, SVG, CSV and caption out.
//!
//! `words` says how conditions are named and chosen, `sigma` how residuals are scaled, `grid` where small multiples
//! stand, `multiples` draws what they share, `stack` what a narrow screen shows of them.

mod budget;
mod columns;
pub(super) mod contact;
pub(super) mod grid;
pub(super) mod limits;
mod map;
pub(super) mod multiples;
pub(crate) mod overlay;
mod peaks;
pub(super) mod sigma;
pub(super) mod stack;
pub(crate) mod words;

use super::Figure;
use crate::compare::Comparison;

/// Every figure of a comparison, in the order in which a report shows them.
pub static REGISTRY: &[&dyn Figure<Comparison>] = &[
    &overlay::AMPLITUDE,
    &overlay::PHASE,
    &map::MisfitMap,
    &contact::FREQUENCY,
    &contact::SPEED,
    &peaks::Peaks,
    &budget::Budget,
];
