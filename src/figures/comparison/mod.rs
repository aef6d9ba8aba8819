//! Figures of a comparison: a [`Comparison`] in, SVG, CSV and caption out.
//!
//! `words` says how conditions are named and chosen, `sigma` how residuals are scaled, `grid` where small multiples stand.

mod budget;
mod columns;
pub(super) mod contact;
pub(super) mod grid;
pub(super) mod limits;
mod map;
pub(super) mod overlay;
mod peaks;
pub(super) mod sigma;
pub(super) mod words;

use super::{Drawing, FigureError};
use crate::compare::Comparison;

/// A figure of a comparison.
pub trait ComparisonFigure: Sync {
    /// Name, in kebab-case; also the stem of its files.
    fn name(&self) -> &'static str;
    /// Title.
    fn title(&self) -> &'static str;
    /// Draws the comparison.
    ///
    /// # Errors
    /// [`FigureError::MissingData`] where the measurements lack what the figure shows.
    fn draw(&self, comparison: &Comparison) -> Result<Drawing, FigureError>;
}

/// Every figure of a comparison, in the order in which a report shows them.
pub static REGISTRY: &[&dyn ComparisonFigure] = &[
    &overlay::AMPLITUDE,
    &overlay::PHASE,
    &map::MisfitMap,
    &contact::FREQUENCY,
    &contact::SPEED,
    &peaks::Peaks,
    &budget::Budget,
];

/// The figure of that name.
pub fn find(name: &str) -> Option<&'static dyn ComparisonFigure> {
    REGISTRY.iter().copied().find(|figure| figure.name() == name)
}

/// The drawing of a figure: caption and text alternative, SVG and CSV, key numbers followed by how to read it.
fn drawing(
    figure: &dyn ComparisonFigure,
    (caption, alt): (String, String),
    (svg, csv): (String, String),
    (mut notes, reading): (Vec<(String, String)>, [&str; 3]),
) -> Drawing {
    let labels = ["What good looks like", "What bad looks like", "What to do"];
    notes.extend(labels.iter().zip(reading).map(|(label, text)| (label.to_string(), text.to_string())));
    let (name, title) = (figure.name().into(), figure.title().into());
    Drawing { name, title, caption, alt, svg, csv, notes }
}
