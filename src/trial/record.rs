//! The result of one trial, kept in a file so that it is not run again.

use super::answer::Answer;
use super::examine::Found;
use super::score::{Score, score};
use crate::error::{Error, Result};
use crate::files;
use crate::results::Results;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Largest file of trials that is read; a thousand of them take 5 MB.
pub(super) const MAX_BYTES: u64 = 64 << 20;

/// Everything known of a finished trial.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Record {
    /// Name of the trial.
    pub id: String,
    /// Hash of everything that decides its result.
    pub inputs: String,
    /// Version of the program.
    pub program: String,
    /// Hash of the program's file, the first digits: results of different builds are said to be so.
    pub build: String,
    /// Hash of the table.
    pub table: Option<String>,
    /// Hash with which the answer was sealed.
    pub sealed: String,
    /// What was planted.
    pub answer: Answer,
    /// What was found; nothing where no draw was kept.
    pub found: Option<Found>,
    /// How the two compare.
    pub score: Option<Score>,
    /// Time to draw and to measure \[s\].
    pub planting_seconds: f64,
}

fn place(id: &str) -> String {
    format!("results/{id}.json")
}

impl Record {
    /// The kept result of a trial, where there is one of the same inputs and version; it is scored again.
    pub fn load(out: &Path, id: &str, inputs: &str, program: &str) -> Option<Self> {
        let text = files::text(&out.join(place(id)), MAX_BYTES, "").ok()?;
        let mut record: Self = serde_json::from_str(&text).ok()?;
        if record.inputs != inputs || record.program != program {
            return None;
        }
        record.score = record.found.as_ref().map(|found| score(&record.answer, found));
        Some(record)
    }

    /// Keeps it.
    ///
    /// # Errors
    /// [`Error::Io`] where the operating system refuses.
    pub fn save(&self, results: &Results) -> Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(|why| Error::Unfinished(why.to_string()))? + "\n";
        results.write(&place(&self.id), text.as_bytes())
    }
}
