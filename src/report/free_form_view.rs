//! What the report says of the variable that what is missing depends on, as data.

use super::figure_view::FigureView;
use crate::units::readable::Quantity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The free form, as data.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct FreeFormView {
    /// Stable id in the page.
    pub anchor: String,
    /// What follows, in a sentence.
    pub statement: String,
    /// Where the force acts.
    pub acts_on: String,
    /// What limits it.
    pub notes: Vec<String>,
    /// The classes of laws, a constant first.
    pub classes: Vec<DependenceView>,
    /// Named effects with that shape, nearest first.
    pub shapes: Vec<ShapeView>,
    /// Its figure.
    pub figures: Vec<FigureView>,
}

/// A class of laws.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct DependenceView {
    /// Its variables.
    pub name: String,
    /// What the data say of it.
    pub standing: String,
    /// Error of the amplitude that it leaves.
    pub left: Quantity,
    /// Share of the misfit that it explains at most.
    pub explained: Quantity,
    /// Error of series predicted from the others.
    pub predicted: Quantity,
}

/// A named effect.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ShapeView {
    /// Its name.
    pub effect: String,
    /// Error of the amplitude that it leaves.
    pub left: Quantity,
    /// Share of the misfit that it explains.
    pub explained: Quantity,
}
