//! A table looked at by itself, before there is a scenario.

use std::path::{Path, PathBuf};

use super::frame::Frame;
use super::names::{LAG, PHASE};
use super::{Format, Table, doubts, file, read, universal};
use crate::error::Result;
use crate::scenario::parameters::COLUMNS;
use crate::scenario::{Coordinate, MeasurementSource};

/// A column of a file and what was made of it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Column {
    /// Its header, letter by letter.
    pub header: String,
    /// Which column of a measured table it is, as in `[measurement] columns`; none where it is not used.
    pub key: Option<&'static str>,
    /// The unit that it is read in; none where it holds words or is not used.
    pub unit: Option<String>,
}

/// What a table holds by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The table as a scenario of a fitting oscillator would have it, with the loads and speeds that it states.
    pub table: Table,
    /// Its columns in the order of the file; none of a universal file.
    pub columns: Vec<Column>,
    /// Keys and headers that a scenario needs under `[measurement] columns`, as several columns could serve and one was
    /// chosen.
    pub mapping: Vec<(String, String)>,
    /// Which function of a universal file it is, counted from 1, where there are several.
    pub record: Option<usize>,
}

impl Survey {
    /// Whether a column of this key is there: `speed`, `load`, `phase`, `series`, ...
    pub fn has(&self, key: &str) -> bool {
        self.columns.iter().any(|column| column.key == Some(key))
    }

    /// The coordinate of an oscillator that is driven and read so; none where the drive is of a displacement and the
    /// reading of an angle, as of the paper's rig, or the other way round.
    pub fn coordinate(&self) -> Option<Coordinate> {
        let of = |unit: &str| match unit {
            "V" => None,
            "N m" => Some(Coordinate::Angle),
            unit if unit.contains("rad") => Some(Coordinate::Angle),
            _ => Some(Coordinate::Displacement),
        };
        let signals = self.table.signals;
        match (of(signals.drive.unit), of(signals.reading.unit)) {
            (Some(drive), Some(reading)) if drive != reading => None,
            (drive, reading) => drive.or(reading).or(Some(Coordinate::Displacement)),
        }
    }
}

/// Reads a table without a scenario: the units of its columns decide what drives and what is read.
///
/// # Errors
/// As of [`super::load`].
pub fn survey(path: impl AsRef<Path>) -> Result<Survey> {
    survey_of(path.as_ref().to_path_buf(), None, file::bytes)
}

/// The same of the readings between two frequencies \[Hz\].
///
/// # Errors
/// As of [`survey`].
pub fn survey_between(path: impl AsRef<Path>, band: (f64, f64)) -> Result<Survey> {
    survey_of(path.as_ref().to_path_buf(), Some(band), file::bytes)
}

/// The same of bytes that are at hand; the name still tells their format.
///
/// # Errors
/// As of [`survey`].
pub fn survey_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<Survey> {
    survey_of(path.as_ref().to_path_buf(), None, |_| Ok(bytes.to_vec()))
}

fn survey_of(file: PathBuf, band: Option<(f64, f64)>, bytes: impl Fn(&Path) -> Result<Vec<u8>>) -> Result<Survey> {
    let bytes = bytes(&file)?;
    let record = match Format::of(&file)? {
        Format::Universal => universal::record(&universal::source(&file, &bytes)?)?,
        _ => None,
    };
    let mut wanted = MeasurementSource { file, columns: Vec::new(), record, sheet: None, band };
    let (mut table, mut columns, mut mapping) = read(&wanted, &bytes, &Frame::any(), None)?;
    let phase = columns.iter().find(|column| column.key == Some("phase")).map(|column| column.header.clone());
    // Whatever it is called: those of a column of lags may be negative where the reading lags.
    for (key, sign) in [(LAG, "as lags"), (COLUMNS[PHASE], "as they are, negative where the reading lags")] {
        let Some(header) = phase.clone().filter(|_| doubts::counts_lags(&table.points)) else { break };
        wanted.columns = vec![(key.to_string(), header)];
        (table, columns, mapping) = read(&wanted, &bytes, &Frame::any(), None)?;
        table.notes.push(format!(
            "the phases rose with the frequency, where those of an oscillator that is driven fall through its resonance: they are read {sign}"
        ));
        mapping.extend(wanted.columns.clone());
    }
    if doubts::are_random(&table.points) {
        wanted.columns = vec![(COLUMNS[PHASE].to_string(), String::new())];
        (table, columns, mapping) = read(&wanted, &bytes, &Frame::any(), None)?;
        table.notes.push(
            "the phases are scattered over the whole circle, from row to row as well: they are not used; they are used again \
             without `phase = \"\"` in [measurement] columns"
                .into(),
        );
        mapping.extend(wanted.columns.clone());
    }
    Ok(Survey { table, columns, mapping, record })
}
