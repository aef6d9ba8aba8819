//! Readings as a file has them, before those of one point are united.

use super::Column;
use crate::scenario::Signals;
use schemars::JsonSchema;

/// Which way the frequency was swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// From low to high.
    Up,
    /// From high to low.
    Down,
    /// Not known: the rows are in no order, or their order is not known.
    Unknown,
}

/// One row as it was read, SI units and rad.
#[derive(Debug, Clone)]
// Wide: what a row of a file can say, whatever its format.
pub(crate) struct Reading {
    pub row: usize,
    pub line: usize,
    pub speed: f64,
    pub load: f64,
    pub drive: f64,
    pub frequency: f64,
    pub amplitude: f64,
    pub phase: Option<f64>,
    pub amplitude_sd: Option<f64>,
    pub phase_sd: Option<f64>,
    pub mean: Option<f64>,
    /// Standard deviations that rounding leaves of amplitude and phase.
    pub rounding: [f64; 2],
    /// What the table calls its series.
    pub name: String,
    /// Which way the table says that the frequency was swept.
    pub sweep: Option<Direction>,
    /// Number of its series, once these are found.
    pub series: usize,
    /// Cells of the columns that are not used, with zeros between them; they tell a repetition from a copy.
    pub aside: String,
}

/// The readings of a file and what it states about their noise.
#[derive(Debug)]
pub(crate) struct Readings {
    pub list: Vec<Reading>,
    /// What drive and amplitude are.
    pub signals: Signals,
    /// What was made of the file's columns.
    pub columns: Vec<Column>,
    /// Keys and headers that a scenario has to map, as several columns could serve.
    pub choices: Vec<(String, String)>,
    /// Whether nothing states the drive, and one setting is taken for all rows.
    pub drive_assumed: bool,
    pub amplitude_stated: bool,
    pub phase_stated: bool,
}
