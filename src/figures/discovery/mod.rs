//! Figures of a discovery: a [`Discovery`] in, SVG, CSV and caption out; nothing is simulated.

mod fingerprint;
mod ladder;
mod overlay;
mod parameters;
mod ranking;
mod rows;

use super::style::{Color, DASHES, viridis};
use super::{Drawing, FigureError, canvas::Dash};
use crate::discover::{Discovery, Step};

/// A figure of a discovery.
pub trait DiscoveryFigure: Sync {
    /// Name, in kebab-case; also the stem of its files.
    fn name(&self) -> &'static str;
    /// Title.
    fn title(&self) -> &'static str;
    /// Draws the discovery.
    ///
    /// # Errors
    /// [`FigureError::MissingData`] where the discovery lacks what the figure shows, e.g. a second step.
    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError>;
}

/// Every figure of a discovery, in the order in which a report shows them.
pub static REGISTRY: &[&dyn DiscoveryFigure] =
    &[&ladder::Ladder, &overlay::Overlay, &fingerprint::Fingerprint, &parameters::Parameters, &ranking::Ranking];

/// The figure of that name.
pub fn find(name: &str) -> Option<&'static dyn DiscoveryFigure> {
    REGISTRY.iter().copied().find(|figure| figure.name() == name)
}

/// The drawing of a figure: caption and text alternative, SVG and CSV, key numbers followed by how to read it.
fn drawing(
    figure: &dyn DiscoveryFigure,
    (caption, alt): (String, String),
    (svg, csv): (String, String),
    (mut notes, reading): (Vec<(String, String)>, [&str; 3]),
) -> Drawing {
    let labels = ["What good looks like", "What bad looks like", "What to do"];
    notes.extend(labels.iter().zip(reading).map(|(label, text)| (label.to_string(), text.to_string())));
    let (name, title) = (figure.name().into(), figure.title().into());
    Drawing { name, title, caption, alt, svg, csv, notes }
}

/// What a step of the ladder is called.
fn name(step: &Step) -> String {
    step.added.as_ref().map_or_else(|| "base, calibrated".into(), |added| format!("+ {added}"))
}

/// Colour of a step: from pale to dark along the ladder.
fn color(index: usize, count: usize) -> Color {
    let share = index as f64 / (count.max(2) - 1) as f64;
    viridis(0.82 - 0.57 * share)
}

/// Dash of a step: solid for the last one.
fn dash(index: usize, count: usize) -> Dash {
    DASHES[(count.saturating_sub(1) - index.min(count.saturating_sub(1))).min(DASHES.len() - 1)]
}

/// A ladder with one step has nothing to compare.
fn ladder_of<'a>(figure: &dyn DiscoveryFigure, d: &'a Discovery) -> Result<&'a [Step], FigureError> {
    if d.steps.len() < 2 { Err(FigureError::missing(figure.name(), "a second step")) } else { Ok(&d.steps) }
}
