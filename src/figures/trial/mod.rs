//! Figures of a series of trials: a [`Summary`] in, SVG, CSV and caption out.

mod confusion;
mod coverage;
mod fall;

use super::{Drawing, FigureError};
use crate::trial::Summary;

/// A figure of a series of trials.
pub trait TrialFigure: Sync {
    /// Name, in kebab-case; also the stem of its files.
    fn name(&self) -> &'static str;
    /// Title.
    fn title(&self) -> &'static str;
    /// Draws the summary.
    ///
    /// # Errors
    /// [`FigureError::MissingData`] where there is nothing to show.
    fn draw(&self, summary: &Summary) -> Result<Drawing, FigureError>;
}

/// Every figure of a series of trials, in the order in which they are shown.
pub static REGISTRY: &[&dyn TrialFigure] = &[&confusion::ConfusionMatrix, &coverage::Intervals, &fall::ErrorFall];

/// The figure of that name.
pub fn find(name: &str) -> Option<&'static dyn TrialFigure> {
    REGISTRY.iter().copied().find(|figure| figure.name() == name)
}

/// The drawing of a figure: caption and text alternative, SVG and CSV, how to read it.
fn drawing(
    figure: &dyn TrialFigure,
    (caption, alt): (String, String),
    (svg, csv): (String, String),
    reading: [&str; 3],
) -> Drawing {
    let labels = ["What good looks like", "What bad looks like", "What to do"];
    let notes = labels.iter().zip(reading).map(|(label, text)| (label.to_string(), text.to_string())).collect();
    let (name, title) = (figure.name().into(), figure.title().into());
    Drawing { name, title, caption, alt, svg, csv, notes }
}

/// A noun with its number.
fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
