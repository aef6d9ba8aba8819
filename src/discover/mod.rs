//! Which effect is missing: from data alone, or an honest statement that the data cannot tell.
//!
//! Hypotheses are nothing but calibration, one recalibrated number of rig or instrument, or effects of the registry,
//! added one after the other. They are ranked by Schwarz's criterion and by the prediction of left-out conditions.

mod add;
mod candidates;
mod conclude;
mod criteria;
mod data;
mod each_series;
mod fall;
mod field;
mod held_out;
mod hypothesis;
mod json;
mod known;
mod line_up;
mod look;
mod narrow;
mod next;
mod notes;
mod options;
mod race;
mod reduce;
mod runner;
mod select;
mod testimony;
mod unnamed;
mod verdict;
mod words;

pub use add::{Change, fit_addition, fit_removal};
pub use candidates::Candidates;
pub use fall::{Fall, Part, STRENGTHS, State};
pub use held_out::{HeldOut, held_out};
pub use hypothesis::{Addition, Basis, Estimate, Hypothesis, additions, compatible, extended, has_size};
pub use json::{DiscoveryJson, SCHEMA, json};
pub use narrow::{are_better, narrower};
pub use next::{Bounds, NextMeasurement, farthest};
pub use options::{MARGIN, SearchOptions};
pub use select::{discover, discover_counted, explain};
pub use unnamed::beside;
pub use verdict::{Evidence, verdict};
pub use words::{how_sure, identified, open_ends, sentence};

use crate::compare::{Comparison, Outlier};
use crate::fit::{Correlation, Interval};
use crate::measurement::Noise;
use schemars::JsonSchema;
use std::sync::OnceLock;

/// What the data say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The calibrated base explains the data within their noise.
    NothingMissing,
    /// A number of the rig or the instrument is off.
    Recalibrate,
    /// One or more effects are missing, and explain the data within their noise.
    EffectMissing,
    /// Structured misfit is left whatever is added.
    Unexplained,
}

impl Verdict {
    /// The word of the JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::NothingMissing => "nothing-missing",
            Self::Recalibrate => "recalibrate",
            Self::EffectMissing => "effect-missing",
            Self::Unexplained => "unexplained",
        }
    }
}

/// One rung of the ladder: the model so far against the measurements.
#[derive(Debug, Clone)]
pub struct Step {
    /// What this step added; `None` for the calibrated base.
    pub added: Option<String>,
    /// The hypothesis.
    pub hypothesis: Hypothesis,
    /// The comparison with the measurements.
    pub comparison: Comparison,
    /// Prediction of left-out conditions; `None` where there is only one condition.
    pub held_out: Option<HeldOut>,
}

impl Step {
    /// What it is called.
    pub fn name(&self) -> String {
        match &self.added {
            Some(added) => format!("+ {added}"),
            None if self.comparison.scenario.free.is_empty() => "base, as stated".into(),
            None => "base, calibrated".into(),
        }
    }
}

/// A ranked hypothesis.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The hypothesis.
    pub hypothesis: Hypothesis,
    /// Schwarz's criterion above the best one.
    pub delta_bic: f64,
    /// Share of the evidence among all that were ranked.
    pub weight: f64,
    /// Whether the data could show it at any plausible strength.
    pub testable: bool,
    /// Mean square of the residuals in standard deviations.
    pub chi2_per_point: f64,
    /// Intervals of its parameters: by profile likelihood for the chosen one and the leading ones tied with it, from
    /// the curvature for the others.
    pub intervals: Vec<Interval>,
    /// Prediction of left-out conditions, for the leading ones.
    pub held_out: Option<HeldOut>,
    /// Whether it has no place among the others: it was estimated to do at least as well as the best that was fitted, and
    /// not fitted itself.
    pub is_open: bool,
}

/// An effect that the data cannot show, and where it would show.
#[derive(Debug, Clone, PartialEq, JsonSchema, serde::Serialize)]
pub struct NotTestable {
    /// Its name.
    pub effect: String,
    /// Largest change at any plausible strength, in standard deviations over all points together.
    pub largest_sigma: f64,
    /// Where its strongest plausible form would show most, in words; empty where nowhere within the bounds.
    pub would_show: String,
}

/// Everything that a discovery found.
#[derive(Debug, Clone)]
// Wide: every reader of a discovery takes some of these, and none a group of them.
pub struct Discovery {
    /// What the data say.
    pub verdict: Verdict,
    /// The ladder from the calibrated base to the explanation.
    pub steps: Vec<Step>,
    /// All hypotheses that were ranked, the best first.
    pub candidates: Vec<Candidate>,
    /// Groups of names that the data do not tell apart.
    pub indistinguishable: Vec<Vec<String>>,
    /// Effects that were asked for.
    pub asked: Vec<&'static str>,
    /// Effects that the data cannot show.
    pub not_testable: Vec<NotTestable>,
    /// Readings that stand out of the best explanation.
    pub outliers: Vec<Outlier>,
    /// Where the survivors differ most.
    pub next_measurement: Option<NextMeasurement>,
    /// Standard deviations of the search over those of the table.
    pub noise: Noise,
    /// Estimates that are tied together in the explanation.
    pub correlations: Vec<Correlation>,
    /// Steady states that were solved, and whether the search ended because it had spent its budget of them.
    pub solved: u64,
    /// As that.
    pub spent: bool,
    /// Why the readings could not have told against the explanation, where that is so, in words.
    pub undecidable: Option<&'static str>,
    /// Things said in plain words.
    pub notes: Vec<String>,
    fall: OnceLock<Option<Fall>>,
}

impl Discovery {
    /// The fall of the error as what was found grows; solved when first asked for, `None` where nothing was found.
    pub fn fall(&self) -> Option<&Fall> {
        if self.fall.get().is_none() {
            // Not while others wait for it: this thread may take up their work meanwhile.
            let fall = fall::fall(self);
            self.fall.get_or_init(|| fall);
        }
        self.fall.get().and_then(Option::as_ref)
    }

    /// What to measure next, where that has something to decide: where nothing is missing a rival that cannot be told
    /// apart is no news, nor is one that is ruled out and would hardly be told, or that would confirm what explains nothing.
    pub fn next_worth(&self) -> Option<&NextMeasurement> {
        let open = |n: &NextMeasurement| self.verdict != Verdict::NothingMissing && n.ruled_out_by.is_none();
        let confirms = |n: &NextMeasurement| self.verdict != Verdict::Unexplained && n.decides();
        self.next_measurement.as_ref().filter(|n| confirms(n) || open(n))
    }

    /// The candidates to be shown, in their order: the first so many that have a place and are wanted, and the base.
    pub fn leading(&self, most: usize, is_wanted: impl Fn(&Candidate) -> bool) -> Vec<&Candidate> {
        let placed = self.candidates.iter().filter(|c| !c.is_open && is_wanted(c)).enumerate();
        placed.filter(|(rank, c)| *rank < most || c.hypothesis.additions.is_empty()).map(|(_, c)| c).collect()
    }

    /// The last rung: the explanation, or the calibrated base.
    pub fn explanation(&self) -> &Step {
        &self.steps[self.steps.len() - 1]
    }
}
