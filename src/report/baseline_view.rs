//! What the report says of an earlier run that it is held against, and of the runs before, as data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::figure_view::FigureView;
use super::verdict::Change;
use crate::units::readable::Quantity;

/// This run against an earlier one.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct BaselineView {
    /// The earlier report as the user named it.
    pub path: String,
    /// When it was made.
    pub generated: String,
    /// Program and version that made it.
    pub program: String,
    /// What the difference comes to.
    pub sentence: String,
    /// What to know about how far the two can be compared.
    pub notes: Vec<String>,
    /// What differs, the most serious first.
    pub changes: Vec<ChangeView>,
    /// Number of values and verdicts that are the same.
    pub same: usize,
    /// Inputs that differ.
    pub inputs: Vec<ChangedInputView>,
    /// Curves of both.
    pub figures: Vec<FigureView>,
    /// Figures that look different.
    pub pictures: Vec<PictureView>,
}

/// A value or a verdict that is another one than before.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ChangeView {
    /// What became of it.
    pub verdict: Change,
    /// Scenario, claim or check.
    pub subject: String,
    /// Which of its values.
    pub what: String,
    /// Before.
    pub before: Quantity,
    /// Now.
    pub after: Quantity,
    /// By how much; empty where it is no number.
    pub by: String,
    /// Where the report treats it.
    pub anchor: String,
}

/// An input that is another one than before.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ChangedInputView {
    /// Scenario, or its measurements.
    pub id: String,
    /// The file.
    pub path: String,
    /// Its hash before; empty where it is new.
    pub before: String,
    /// Its hash now; empty where it is gone.
    pub after: String,
    /// Keys that have other values, each with both; empty where the values are the same.
    pub keys: Vec<String>,
}

/// A figure that looks different.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct PictureView {
    /// Title of the figure.
    pub title: String,
    /// Where it stands in the report.
    pub anchor: String,
    /// The earlier drawing, relative to the report.
    pub before: String,
    /// Link to it.
    pub href: String,
    /// The earlier drawing. Not part of the JSON: it is among the files.
    #[serde(skip)]
    pub svg: String,
}

/// The runs before this one, and this one.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct HistoryView {
    /// The file of records as the user named it.
    pub path: String,
    /// Number of runs, this one included.
    pub runs: usize,
    /// What became of the values.
    pub sentence: String,
    /// What to know about it.
    pub notes: Vec<String>,
    /// Values that moved from one level to another, the latest first.
    pub steps: Vec<StepChangeView>,
    /// Values by run.
    pub figures: Vec<FigureView>,
}

/// A value that moved from one level to another.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct StepChangeView {
    /// What became of it.
    pub verdict: Change,
    /// Which value.
    pub what: String,
    /// Number of the first run on the new level, from 1.
    pub run: usize,
    /// When that was.
    pub time: String,
    /// Level before.
    pub before: Quantity,
    /// Level since.
    pub after: Quantity,
    /// By how much.
    pub by: String,
}
