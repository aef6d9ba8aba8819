//! The search, given nothing but a folder with a scenario and its table.

use crate::discover::{self, Discovery};
use crate::error::{Error, Result};
use crate::{measurement, scenario};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// A parameter as it was found, with its 95 % interval.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Estimate {
    /// Estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// `yes`, `one-sided` or `no`.
    pub identified: String,
}

/// A rung of the ladder.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Rung {
    /// What it added.
    pub added: Option<String>,
    /// Mean square of the residuals in standard deviations.
    pub chi2_per_point: f64,
    /// Error of the amplitude, root mean square \[%\].
    pub rms_error_percent: f64,
}

/// What a search found.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Found {
    /// Verdict.
    pub verdict: String,
    /// Effects, in the order in which they were added.
    pub effects: Vec<String>,
    /// Numbers of rig and instrument recalibrated.
    pub recalibrate: Vec<String>,
    /// Groups that the data do not tell apart.
    pub indistinguishable: Vec<Vec<String>>,
    /// The ladder, the calibrated base first.
    pub steps: Vec<Rung>,
    /// Root mean square of the stated standard deviations of the amplitude \[%\].
    pub noise_percent: f64,
    /// Parameters of the explanation.
    pub parameters: BTreeMap<String, Estimate>,
    /// Readings that stand out of it.
    pub outliers: usize,
    /// Time of the search \[s\].
    pub seconds: f64,
}

impl Found {
    /// What was named, in a word for tables: a verdict or names.
    pub fn label(&self) -> String {
        match self.verdict.as_str() {
            "nothing-missing" => "nothing".into(),
            "unexplained" => "unexplained".into(),
            _ => {
                let mut names = self.effects.clone();
                names.sort();
                names.extend(self.recalibrate.iter().cloned());
                names.join(" + ")
            }
        }
    }
}

/// Searches in `folder`, which holds `scenario.toml` and its table.
///
/// # Errors
/// Whatever reading the files reports.
pub fn examine(folder: &Path, options: &discover::SearchOptions) -> Result<Found> {
    let scenario = scenario::load(folder.join("scenario.toml"))?;
    let table = measurement::load(&scenario)?
        .ok_or_else(|| Error::Unfinished(format!("{} names no measurements", scenario.path.display())))?;
    let start = Instant::now();
    let discovery = discover::discover(&scenario, &table, options);
    Ok(found(&discovery, start.elapsed().as_secs_f64()))
}

fn found(d: &Discovery, seconds: f64) -> Found {
    let end = d.explanation();
    let c = &end.comparison;
    let rung = |step: &discover::Step| Rung {
        added: step.added.clone(),
        chi2_per_point: step.comparison.overall.chi2_per_point,
        rms_error_percent: step.comparison.overall.rms_error_percent,
    };
    let estimate = |i: &crate::fit::Interval| Estimate {
        value: i.value,
        low: i.low,
        high: i.high,
        identified: i.identified.word().into(),
    };
    Found {
        verdict: d.verdict.word().into(),
        effects: end.hypothesis.effects(),
        recalibrate: end.hypothesis.recalibrated(),
        indistinguishable: d.indistinguishable.clone(),
        steps: d.steps.iter().map(rung).collect(),
        noise_percent: c.overall.noise_percent,
        parameters: c.fit.parameters.iter().zip(&c.intervals).map(|(p, i)| (p.key.clone(), estimate(i))).collect(),
        outliers: d.outliers.len(),
        seconds,
    }
}
