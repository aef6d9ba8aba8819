//! What the report says of a discovery, as data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::comparison_view::{FittedView, OutlierView};
use super::figure_view::FigureView;
use super::verdict::Found;
use crate::units::readable::Quantity;

/// Which effect is missing, as a story.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
// Wide: a field is a place of the template, and a key of the JSON beside the page.
pub struct DiscoveryView {
    /// Stable id in the page.
    pub anchor: String,
    /// What the data say.
    pub verdict: Found,
    /// The verdict in a sentence.
    pub sentence: String,
    /// What was added, for readers without the names of the program: `grosch: master curve of rubber (Grosch). …`.
    #[serde(default)]
    pub meanings: Vec<String>,
    /// How sure that is, in a sentence.
    #[serde(default)]
    pub sure: String,
    /// By how much what was added changes the model: numbers with intervals.
    #[serde(default)]
    pub amounts: Vec<String>,
    /// The verdict for readers without the words of the program, with its numbers.
    pub story: Vec<String>,
    /// Names of what the explanation adds; empty where nothing.
    pub added: String,
    /// What these are called in running text.
    #[serde(default)]
    pub titles: Vec<String>,
    /// Mean square of the residuals of the calibrated base.
    pub before: Quantity,
    /// The same of the explanation.
    pub after: Quantity,
    /// The ladder, the calibrated base first.
    pub steps: Vec<StepView>,
    /// Parameters of the explanation.
    pub parameters: Vec<FittedView>,
    /// Estimates that are tied together.
    pub ties: Vec<String>,
    /// The leading candidates, the best first.
    pub candidates: Vec<CandidateView>,
    /// How many more there are.
    pub more_candidates: usize,
    /// Groups that these data do not tell apart.
    pub indistinguishable: Vec<String>,
    /// Effects that the data cannot show.
    pub not_testable: Vec<NotTestableView>,
    /// Readings that stand out of the explanation.
    pub outliers: Vec<OutlierView>,
    /// How many more there are.
    pub more_outliers: usize,
    /// What to measure next.
    pub next: Option<NextView>,
    /// Remarks.
    pub notes: Vec<String>,
    /// Where the explanation still fails.
    pub regions: Vec<String>,
    /// How many more such ranges there are.
    pub more_regions: usize,
    /// What is known of the contact where something is left unexplained; may be empty.
    pub contact: String,
    /// How the error falls as what was found grows to its fitted strength; absent where nothing was found.
    #[serde(default)]
    pub fall: Option<FallView>,
    /// Figures that carry the story.
    pub figures: Vec<FigureView>,
    /// Further figures.
    pub more: Vec<FigureView>,
}

/// How the error falls.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct FallView {
    /// What was found.
    pub additions: Vec<String>,
    /// Strengths, 0 for the calibrated base, 1 for the fit.
    pub strengths: Vec<f64>,
    /// The error for every part of it, the whole last.
    pub parts: Vec<FallPartView>,
}

/// The error at every strength of a part of what was found.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct FallPartView {
    /// What it has.
    pub additions: Vec<String>,
    /// Mean square of the residuals in standard deviations.
    pub chi2_per_point: Vec<Option<f64>>,
    /// Root mean square error of the amplitude \[%\].
    pub rms_error_percent: Vec<Option<f64>>,
}

/// A rung of the ladder.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct StepView {
    /// What it added.
    pub name: String,
    /// Mean square of the residuals in standard deviations.
    pub chi2: Quantity,
    /// Root mean square error of the amplitude.
    pub error: Quantity,
    /// Noise of the amplitude.
    pub noise: Quantity,
    /// The same error for conditions left out of the fit.
    pub held_out: Quantity,
    /// Root mean square error of the phase.
    pub phase_error: Quantity,
    /// Ranges at which it still fails.
    pub regions: usize,
}

/// A ranked candidate.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct CandidateView {
    /// What it adds.
    pub name: String,
    /// Schwarz's criterion above the best.
    pub delta_bic: Quantity,
    /// Share of the evidence.
    pub weight: Quantity,
    /// Mean square of the residuals in standard deviations.
    pub chi2: Quantity,
    /// Error for conditions left out of the fit.
    pub held_out: Quantity,
    /// `yes` or `no`.
    pub testable: String,
    /// What the numbers rest on: a fit to all points or to some, or an estimate.
    pub basis: String,
}

/// An effect that the data cannot show.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct NotTestableView {
    /// Its name.
    pub effect: String,
    /// Largest change at any plausible strength, over all readings together.
    pub largest: Quantity,
    /// Where it would show.
    pub would_show: String,
}

/// The measurement that decides most.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct NextView {
    /// V.
    pub speed: Quantity,
    /// W.
    pub load: Quantity,
    /// u0.
    pub drive: Quantity,
    /// f.
    pub frequency: Quantity,
    /// What it separates.
    pub separates: Vec<String>,
    /// Expected distance in standard deviations of one reading.
    pub sigma: Quantity,
    /// What that distance means.
    pub meaning: String,
}
