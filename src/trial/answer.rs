//! Sealed answers: written before a search, read after it.

use super::cause::Kind;
use crate::error::{Error, Result};
use crate::results::Results;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// How many draws a trial took.
#[derive(Debug, Clone, Copy, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Draws {
    /// Draws that the data could not show.
    pub invisible: usize,
    /// Draws with a point that has no steady state.
    pub unsteady: usize,
    /// Whether one was kept.
    pub kept: bool,
}

/// What was planted.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Answer {
    /// Name of the trial.
    pub id: String,
    /// Name of the cause.
    pub cause: String,
    /// Sort of cause.
    pub kind: Kind,
    /// Effects of the catalogue.
    pub effects: Vec<String>,
    /// A number of the rig or the instrument that is off.
    pub recalibrate: Option<String>,
    /// Noise of the table.
    pub noise: f64,
    /// Seed.
    pub seed: u32,
    /// Mean square misfit of the calibrated base beyond the noise, in standard deviations.
    pub excess: f64,
    /// Everything drawn, by key.
    pub parameters: BTreeMap<String, f64>,
    /// How many draws it took.
    pub draws: Draws,
}

/// A closed answer: where it lies, and the hash it must still have when it is opened.
#[derive(Debug, Clone, PartialEq)]
pub struct Seal {
    path: PathBuf,
    /// BLAKE3 hash of the file.
    pub hash: String,
}

/// Writes an answer to the folder of answers, and closes it.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn seal(results: &Results, answer: &Answer) -> Result<Seal> {
    let name = format!("answers/{}.json", answer.id);
    let text = serde_json::to_string_pretty(answer).map_err(|why| Error::Unfinished(why.to_string()))? + "\n";
    results.write(&name, text.as_bytes())?;
    Ok(Seal { path: results.path().join(name), hash: blake3::hash(text.as_bytes()).to_hex().to_string() })
}

/// Opens an answer.
///
/// # Errors
/// [`Error::Io`] where it cannot be read; [`Error::Unfinished`] where it is not what was sealed.
pub fn open(seal: &Seal) -> Result<Answer> {
    let bytes = std::fs::read(&seal.path).map_err(Error::io("read", &seal.path))?;
    if blake3::hash(&bytes).to_hex().to_string() != seal.hash {
        return Err(Error::Unfinished(format!("{} was changed after it had been sealed", seal.path.display())));
    }
    serde_json::from_slice(&bytes).map_err(|why| Error::Unfinished(format!("{}: {why}", seal.path.display())))
}
