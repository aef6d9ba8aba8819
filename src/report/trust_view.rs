//! What the report says of how far the search can be trusted, as data.

use super::figure_view::FigureView;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The section of the page.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct TrustView {
    /// The result in a sentence.
    pub sentence: String,
    /// What was done.
    pub method: String,
    /// The command that made it.
    pub command: String,
    /// The program that made it, with its builds.
    pub program: String,
    /// Shares over all trials.
    pub scores: Vec<ScoreView>,
    /// The same under other conditions, the main ones first.
    #[serde(default)]
    pub otherwise: Vec<OtherwiseView>,
    /// The commands that made them.
    #[serde(default)]
    pub commands: Vec<String>,
    /// The programs that made them, with their builds.
    #[serde(default)]
    pub programs: Vec<String>,
    /// How each cause fared.
    pub causes: Vec<CauseView>,
    /// The figures.
    pub figures: Vec<FigureView>,
}

/// A share of the trials.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ScoreView {
    /// Of what.
    pub what: String,
    /// How many of how many.
    pub count: String,
    /// The share.
    pub share: String,
    /// Wilson's 95 % interval.
    pub interval: String,
}

/// Scores under some conditions.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct OtherwiseView {
    /// The conditions.
    pub conditions: String,
    /// Trials.
    pub trials: usize,
    /// Draws that the data could show, of all.
    pub visible: String,
    /// Right verdicts.
    pub verdict: String,
    /// Planted effects named, or in a declared tie.
    pub named: String,
    /// False alarms where nothing was planted.
    pub false_alarm: String,
    /// Causes outside the catalogue called unexplained.
    pub flagged: String,
    /// Intervals that hold the truth.
    pub coverage: String,
}

/// One cause.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct CauseView {
    /// Its name.
    pub cause: String,
    /// Trials.
    pub trials: usize,
    /// Right verdicts.
    pub verdict: String,
    /// The truth named, or in a declared tie.
    pub named: String,
    /// What else was named, with how often.
    pub instead: String,
    /// Draws that the data could not show, or that had no steady state somewhere.
    pub not_drawn: usize,
}
