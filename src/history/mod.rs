//! A compact record of every run, in a file that only grows, and where its values moved from one level to another.

mod file;
mod steps;

pub use file::{append, read, records};
pub use steps::{Step, steps};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Schema of a record.
pub const SCHEMA: &str = "stickslip.history/1";
/// Name of the file in its folder.
pub const FILE: &str = "history.jsonl";

/// What a number is about, by the end of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A pure number that should be small.
    Misfit,
    /// An error in percent.
    Error,
    /// A frequency.
    Frequency,
    /// A wall time.
    Time,
}

impl Kind {
    /// The unit in which the numbers are kept.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Misfit => "1",
            Self::Error => "%",
            Self::Frequency => "Hz",
            Self::Time => "s",
        }
    }

    /// Least scatter that is reckoned with, relative to the level: what rounding and the solvers' tolerances leave, and
    /// what a busy machine does to times.
    fn scatter(self) -> f64 {
        if self == Self::Time { 0.1 } else { 1e-4 }
    }

    /// Whether less is better; of a frequency neither is.
    pub fn falls(self) -> bool {
        self != Self::Frequency
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// [`SCHEMA`].
    pub schema: String,
    /// When it was.
    pub time: String,
    /// Program and version.
    pub program: String,
    /// Version of the comparison with measurements.
    pub comparator: String,
    /// Hash of the hashes of all inputs.
    pub inputs: String,
    /// χ² per reading, by scenario and state of the model.
    pub misfits: BTreeMap<String, f64>,
    /// Root mean square errors of the amplitude \[% of the readings\], likewise.
    pub errors: BTreeMap<String, f64>,
    /// Peak frequencies \[Hz\] by scenario and curve.
    pub peaks: BTreeMap<String, f64>,
    /// Wall times \[s\] of the parts that take time; empty where times are left out, or where a part came from the
    /// cache.
    pub seconds: BTreeMap<String, f64>,
}

/// The latest runs of a history.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Records {
    /// How many runs there were before these.
    pub before: usize,
    /// The records, the oldest first.
    pub latest: Vec<Record>,
}

/// A value over the runs; not a number where a run does not have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it is.
    pub name: String,
    /// What it is about.
    pub kind: Kind,
    /// How many runs there were before the first value.
    pub before: usize,
    /// One value per run.
    pub values: Vec<f64>,
    /// Where it moved.
    pub steps: Vec<Step>,
}

/// Every value that the latest record has, over all of them.
pub fn series(records: &Records, times: bool) -> Vec<Series> {
    let Records { before, latest: records } = records;
    type Field = fn(&Record) -> &BTreeMap<String, f64>;
    let all: [(Kind, Field); 4] = [
        (Kind::Misfit, |record| &record.misfits),
        (Kind::Error, |record| &record.errors),
        (Kind::Frequency, |record| &record.peaks),
        (Kind::Time, |record| &record.seconds),
    ];
    let wanted = all.iter().filter(|(kind, _)| (*kind == Kind::Time) == times);
    let names = |field: Field| {
        let latest = records.iter().rev().find(|record| !field(record).is_empty());
        latest.map(|record| field(record).keys().cloned().collect::<Vec<_>>()).unwrap_or_default()
    };
    let one = |kind: Kind, field: Field, name: String| {
        let values: Vec<f64> = records.iter().map(|r| field(r).get(&name).copied().unwrap_or(f64::NAN)).collect();
        let steps = steps(&values, kind.scatter());
        Series { name, kind, before: *before, values, steps }
    };
    wanted.flat_map(|&(kind, field)| names(field).into_iter().map(move |name| one(kind, field, name))).collect()
}
