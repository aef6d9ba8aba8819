//! The program examines itself, blind: causes are planted, measured with noise by plain time integration, sealed,
//! searched for in the table alone, and only then compared with the answer.
//!
//! `cause` lists what is planted, `outside` holds causes that the catalogue does not have; `draw` chooses strengths,
//! `generate` integrates, `visible` says whether the data could show it; `table` adds noise and writes what the search
//! reads, `answer` what it must not; `examine` searches, `score` judges, `record` keeps a finished trial, `summary`
//! counts, `agreement` holds two runs against each other, `committed` holds the results that come with the program.

mod agreement;
mod answer;
mod cause;
mod committed;
mod conditions;
mod draw;
mod examine;
mod generate;
pub mod outside;
mod proportion;
mod record;
mod run;
mod score;
mod summary;
mod table;
mod visible;

pub use agreement::{Both, agreement, load, parse};
pub use answer::{Answer, Draws, Seal, open, seal};
pub use cause::{Cause, Kind, causes, numbered_causes, shown};
pub use committed::{Series, committed};
pub use conditions::{Bench, practice};
pub use draw::{Planted, draw};
pub use examine::{Estimate, Found, Rung, examine};
pub use generate::{Reading, readings};
pub use proportion::Proportion;
pub use record::Record;
pub use run::{id, plant, run, single};
pub use score::{Score, Share, score};
pub use summary::sorted;
pub use summary::{ByCause, Confusion, Coverage, SCHEMA, Scores, Summary, summarise};
pub use table::{scenario as scenario_text, table as table_text};
pub use visible::{excess, noiseless};

use crate::discover::SearchOptions;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// chi2 per reading that a draw must leave the calibrated base with, noise included, to count as visible.
pub const VISIBLE: f64 = 1.3;
/// Draws for one trial before it is given up.
pub const DRAWS: usize = 40;

/// What to examine, and how.
#[derive(Debug, Clone)]
pub struct Options {
    /// What is planted.
    pub causes: Vec<Cause>,
    /// Causes, by name, of which fewer draws are wanted.
    pub fewer: BTreeMap<String, u32>,
    /// First seed.
    pub seed: u32,
    /// Number of seeds, each a draw and a noise of its own for every cause.
    pub seeds: u32,
    /// Levels of noise: standard deviation of amplitudes relative to them and of phases in rad.
    pub noise: Vec<f64>,
    /// Share of the readings that are thrown far off.
    pub outliers: f64,
    /// Whether the tables have phases.
    pub phase: bool,
    /// How is searched.
    pub search: SearchOptions,
    /// Folder of tables, answers and results.
    pub out: PathBuf,
    /// Files that none of these may replace.
    pub inputs: Vec<PathBuf>,
}

impl Options {
    /// Number of draws of a cause.
    pub fn draws_of(&self, cause: &Cause) -> u32 {
        self.fewer.get(&cause.name()).map_or(self.seeds, |&most| most.min(self.seeds))
    }
}

/// The version of the program that a result records.
pub fn program() -> String {
    format!("stickslip {}", env!("CARGO_PKG_VERSION"))
}
