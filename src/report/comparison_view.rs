//! What the report says of a comparison, as data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::figure_view::{FigureView, NoteView};
use super::rig_view::SignalsView;
use super::verdict::Match;
use crate::units::readable::Quantity;

/// Model against measurements.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a place of the template, and a key of the JSON beside the page.
pub struct ComparisonView {
    /// Stable id in the page.
    pub anchor: String,
    /// What the model leaves.
    pub verdict: Match,
    /// The same with its numbers.
    pub sentence: String,
    /// Which way its resonances are off, in a few words; empty where they are right.
    #[serde(default)]
    pub shifts: Vec<String>,
    /// The tests behind the verdict.
    pub tests: String,
    /// What drives the rig and what was read of it, where it is not the paper's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signals: Option<SignalsView>,
    /// The table of measurements.
    pub file: String,
    /// Its hash.
    pub hash: String,
    /// How the table was read: where its noise comes from, what was left out.
    pub notes: Vec<String>,
    /// Figures over all readings.
    pub overall: MatchView,
    /// Calibrated parameters.
    pub parameters: Vec<FittedView>,
    /// Estimates that are tied together.
    pub ties: Vec<String>,
    /// Figures per condition.
    pub conditions: Vec<MatchView>,
    /// Where the model fails, the worst first.
    pub regions: Vec<String>,
    /// How many more there are.
    pub more_regions: usize,
    /// Single readings that stand out.
    pub outliers: Vec<OutlierView>,
    /// How many more there are.
    pub more_outliers: usize,
    /// Error budget.
    pub budget: Vec<NoteView>,
    /// Figures to begin with.
    pub figures: Vec<FigureView>,
    /// Further figures.
    pub more: Vec<FigureView>,
}

/// How well a model matches some readings; of several conditions together, settings and peaks are empty.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a column of the table.
pub struct MatchView {
    /// The series by its name or number, where the rig is not the paper's.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub series: String,
    /// V.
    pub speed: Quantity,
    /// W.
    pub load: Quantity,
    /// The drive, u0 of the paper's rig.
    pub drive: Quantity,
    /// Points.
    pub points: usize,
    /// Readings: amplitudes and phases.
    pub readings: usize,
    /// Mean square of the residuals in standard deviations.
    pub chi2: Quantity,
    /// Root mean square error of the amplitude.
    pub error: Quantity,
    /// Noise of the amplitude.
    pub noise: Quantity,
    /// Root mean square error of the phase.
    pub phase_error: Quantity,
    /// Noise of the phase.
    pub phase_noise: Quantity,
    /// Measured peak.
    pub measured_peak: PeakView,
    /// Peak of the model.
    pub model_peak: PeakView,
}

/// A resonance peak.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct PeakView {
    /// Where.
    pub frequency: Quantity,
    /// How high.
    pub amplitude: Quantity,
}

/// A calibrated parameter.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct FittedView {
    /// Key in a scenario file.
    pub key: String,
    /// Best value.
    pub value: Quantity,
    /// Lower end of the 95 % interval.
    pub low: Quantity,
    /// Its upper end.
    pub high: Quantity,
    /// `yes`, `one-sided` or `no`.
    pub identified: String,
    /// The same in words.
    pub meaning: String,
}

/// A reading that stands out.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct OutlierView {
    /// Data row of the table, from 1.
    pub row: usize,
    /// Amplitude or phase.
    pub column: String,
    /// Its error.
    pub error: Quantity,
}
