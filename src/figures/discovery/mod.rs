//! Figures of a discovery: a [`Discovery`] in, SVG, CSV and caption out; nothing is simulated.

mod before_after;
mod fingerprint;
mod free_form;
mod ladder;
mod overlay;
mod parameters;
mod ranking;
mod rows;

use super::style::{Color, DASHES, readable, viridis};
use super::{Figure, FigureError, canvas::Dash};
use crate::discover::{Discovery, Step};
use crate::free_form::FreeForm;

/// Every figure of a discovery, in the order in which a report shows them.
pub static REGISTRY: &[&dyn Figure<Discovery>] = &[
    &before_after::BeforeAfter,
    &ladder::Ladder,
    &overlay::Overlay,
    &fingerprint::Fingerprint,
    &parameters::Parameters,
    &ranking::Ranking,
];

/// Every figure of the free form beside it.
pub static FREE_FORM: &[&dyn Figure<FreeForm>] = &[&free_form::Curves];

/// Colour of a step: from pale to dark along the ladder.
fn color(index: usize, count: usize) -> Color {
    let share = index as f64 / (count.max(2) - 1) as f64;
    readable(viridis(0.82 - 0.57 * share))
}

/// Dash of a step: solid for the last one.
fn dash(index: usize, count: usize) -> Dash {
    DASHES[(count.saturating_sub(1) - index.min(count.saturating_sub(1))).min(DASHES.len() - 1)]
}

/// A ladder with one step has nothing to compare.
fn ladder_of<'a>(figure: &dyn Figure<Discovery>, d: &'a Discovery) -> Result<&'a [Step], FigureError> {
    if d.steps.len() < 2 { Err(FigureError::missing(figure.name(), "a second step")) } else { Ok(&d.steps) }
}
