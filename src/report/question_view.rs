//! What the report says of a question to the catalogue, as data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::figure_view::FigureView;
use crate::units::readable::Quantity;

/// Which effects can give the curve asked for: hypotheses, all simulated.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct QuestionView {
    /// Stable id in the page.
    pub anchor: String,
    /// What is asked, and of what nature the answer is.
    pub story: Vec<String>,
    /// The effects, those that can first.
    pub effects: Vec<AbleView>,
    /// The reading that would decide between the leading ones; may be empty.
    pub deciding: Vec<String>,
    /// Figures.
    pub figures: Vec<FigureView>,
}

/// An effect and what it can do.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct AbleView {
    /// Its name.
    pub effect: String,
    /// Anchor in the atlas of effects.
    pub atlas: String,
    /// `can` or `cannot`.
    pub verdict: String,
    /// What is lacking; may be empty.
    pub unmet: String,
    /// Where it is strained least; absent where it cannot.
    pub mildest: Option<SettingView>,
    /// Where it comes closest.
    pub closest: SettingView,
}

/// An effect at certain values.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct SettingView {
    /// Its parameters with units.
    pub parameters: String,
    /// Distance from the middle of the catalogue's ranges: 0 there, 1 at the edge.
    pub strain: Quantity,
    /// Root mean square difference from the curve asked for.
    pub rms: Quantity,
    /// Frequency of the peak.
    pub peak_frequency: Quantity,
    /// Its height.
    pub peak_amplitude: Quantity,
    /// Largest difference from full slip at the ends.
    pub ends: Quantity,
}
