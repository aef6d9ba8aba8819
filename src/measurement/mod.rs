//! Tables of measured steady states with their uncertainties. The measured file is read and never written.
//!
//! One file per input format: `delimited` (CSV and its relatives), `workbook` (Excel, OpenDocument) and
//! `universal` (dataset 58). The first two give a `sheet` of cells; `header`, `names` and `unit` find out what a header says,
//! `frame` what the scenario's rig can make of it, `search` and `columns` which column is which, `rows` turns cells into
//! readings, `samples` tells recordings in time from tables. From there all formats are one: `series` finds the sweeps that
//! readings belong to, `pool` unites repeated ones, `noise` gives every point its standard deviations, where none are stated
//! from the [`scatter`](scatter()), `doubts` says what is possible and yet not likely. [`survey`](survey()) does all of it
//! without a scenario.

mod columns;
mod delimited;
mod doubts;
mod file;
mod floor;
mod frame;
mod header;
mod instrument;
mod likely;
mod mapping;
mod modes;
mod names;
mod noise;
mod parts;
mod pool;
mod preamble;
mod reading;
mod rest;
mod rounding;
mod rows;
mod samples;
mod scatter;
mod search;
mod series;
mod settle;
mod sheet;
mod survey;
mod swings;
mod unit;
mod universal;
mod workbook;

use schemars::JsonSchema;
use std::path::{Path, PathBuf};

pub(crate) use doubts::shows_anything;
pub(crate) use file::bytes;
pub(crate) use header::{plain, split};
pub use modes::{Mode, TOLD, modes, peaks};
pub use noise::Noise;
pub use reading::Direction;
pub(crate) use rows::{decimal_commas, written};
pub use scatter::{Parts, Scatter, Spread, scatter};
pub use series::{Series, by_condition, curves};
pub(crate) use sheet::{Complaints, Row, Sheet};
pub use survey::{Column, Survey, survey, survey_between, survey_bytes};
pub(crate) use unit::{Unit, Wanted, suffix};

use crate::error::{Error, Result};
use crate::scenario::diagnostic::whole_file;
use crate::scenario::parameters::COLUMNS;
use crate::scenario::{MeasurementSource, Scenario, Signals, Sweep};
use crate::statistics::median;
use frame::Frame;
use names::PHASE;
use reading::Readings;

/// One measured steady state, SI units.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
// Wide: the columns of a table in SI; files have these names.
pub struct Point {
    /// Data row in the file, counted from 1, the header not counted; the first of them where readings were pooled.
    pub row: usize,
    /// Line in the file, counted from 1.
    pub line: usize,
    /// V, peripheral speed of the roller \[m/s\].
    pub speed: f64,
    /// W, normal load \[N\].
    pub load: f64,
    /// Amplitude of the drive, in the unit of [`Table::signals`]: of the paper's actuator u0 \[m\].
    pub drive: f64,
    /// f, frequency of the drive \[Hz\].
    pub frequency: f64,
    /// Amplitude of the reading at that frequency, in the unit of [`Table::signals`]: of the paper's arm A \[rad\].
    pub amplitude: f64,
    /// Phase relative to the drive in (-pi, pi] \[rad\].
    pub phase: Option<f64>,
    /// Standard deviation of the amplitude, in its unit.
    pub amplitude_sd: f64,
    /// Standard deviation of the phase \[rad\]; there exactly where there is a phase.
    pub phase_sd: Option<f64>,
    /// Mean of the reading, in the unit of the amplitude.
    pub mean: Option<f64>,
    /// Number of readings that were pooled; 1 for a single one.
    pub replicates: usize,
    /// Index of its series among [`Table::series`].
    pub series: usize,
}

impl Point {
    /// Whether reading and deviations are numbers, also where they were computed from others.
    fn is_finite(&self) -> bool {
        let optional = [self.phase, self.phase_sd, self.mean].into_iter().flatten();
        [self.amplitude, self.amplitude_sd].into_iter().chain(optional).all(f64::is_finite)
    }
}

/// Where standard deviations come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseSource {
    /// The table states them.
    Stated,
    /// The scatter about smooth curves.
    Estimated,
    /// The spread of repeated readings.
    Replicates,
}

impl NoiseSource {
    fn word(self) -> &'static str {
        match self {
            Self::Stated => "stated",
            Self::Estimated => "estimated",
            Self::Replicates => "from replicates",
        }
    }
}

/// A table of measured steady states, sorted by series and frequency; the series by load, speed and drive.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Table {
    /// The file, as the scenario leads to it.
    pub file: PathBuf,
    /// BLAKE3 hash of the file's bytes, in hexadecimal.
    pub hash: String,
    /// The points.
    pub points: Vec<Point>,
    /// The sweeps that they belong to.
    pub series: Vec<Series>,
    /// What drive and amplitude are.
    pub signals: Signals,
    /// Where the standard deviations of the amplitudes come from.
    pub amplitude_noise: NoiseSource,
    /// Where those of the phases come from; `None` without phases.
    pub phase_noise: Option<NoiseSource>,
    /// Degrees of freedom that the deviations are known from; infinite where they are stated.
    pub freedom: f64,
    /// Where both came from, if the readings refuted them.
    pub refuted: Option<(NoiseSource, Option<NoiseSource>)>,
    /// What the user should know about how the file was read, in plain words.
    pub notes: Vec<String>,
}

impl Table {
    /// Where the deviations of amplitudes and phases that the table came with are from.
    pub fn noise_sources(&self) -> (NoiseSource, Option<NoiseSource>) {
        self.refuted.unwrap_or((self.amplitude_noise, self.phase_noise))
    }

    /// The table with deviations so many times as large, estimated from the readings where that is not once: from so
    /// many degrees of freedom of amplitudes and of phases.
    pub fn estimated(&self, noise: Noise, freedom: [f64; 2]) -> Self {
        let mut table = self.rescaled(noise);
        table.freedom = (self.freedom.recip() + noise::freedom(&self.points, freedom).recip()).recip();
        let estimated = |factor: f64, source| if factor == 1.0 { source } else { NoiseSource::Estimated };
        table.amplitude_noise = estimated(noise.amplitude, self.amplitude_noise);
        table.phase_noise = self.phase_noise.map(|source| estimated(noise.phase, source));
        table.refuted = Some(self.noise_sources());
        table
    }

    /// The table with other standard deviations.
    pub fn rescaled(&self, noise: Noise) -> Self {
        let mut table = self.clone();
        for point in &mut table.points {
            point.amplitude_sd *= noise.amplitude;
            point.phase_sd = point.phase_sd.map(|sd| sd * noise.phase);
        }
        table
    }

    /// One line for people: `312 points, 13 conditions, 52-98 Hz, amplitude and phase, noise stated 1.0 %`.
    pub fn summary(&self) -> String {
        let mut conditions = 0;
        let mut last = None;
        for point in &self.points {
            let key = Some((point.load, point.speed, point.drive));
            conditions += usize::from(key != last);
            last = key;
        }
        let frequencies = || self.points.iter().map(|point| point.frequency);
        let (low, high) = (frequencies().fold(f64::INFINITY, f64::min), frequencies().fold(0.0, f64::max));
        let with_phase = self.points.iter().filter(|point| point.phase.is_some()).count();
        let kinds = match with_phase {
            0 => "amplitude",
            n if n == self.points.len() => "amplitude and phase",
            _ => "amplitude and some phases",
        };
        let relative = median(self.points.iter().map(|point| point.amplitude_sd / point.amplitude));
        // One decimal, or two digits of what is smaller than that shows.
        let percent = 100.0 * relative;
        let decimals = if percent > 0.0 { (1.0 - percent.log10().floor()).max(1.0) as usize } else { 1 };
        let decimals = if percent >= 0.1 { 1 } else { decimals };
        let mut noise = format!("noise {} {percent:.decimals$} %", self.amplitude_noise.word());
        if let Some(source) = self.phase_noise {
            let phase = median(self.points.iter().filter_map(|point| point.phase_sd)).to_degrees();
            let word = if source == self.amplitude_noise { String::new() } else { format!("{} ", source.word()) };
            // Two decimals, or two digits of what is smaller.
            let decimals = if phase > 0.0 { (1.0 - phase.log10().floor()).max(2.0) as usize } else { 2 };
            noise += &format!(" and {word}{phase:.decimals$} deg");
        }
        let number = |value| crate::units::format(value, "1");
        let span =
            if low == high { format!("{} Hz", number(low)) } else { format!("{}-{} Hz", number(low), number(high)) };
        let points = crate::units::count(self.points.len(), "point");
        let sweeps = if self.has_set_drives(conditions) {
            crate::units::count(conditions, "condition")
        } else {
            format!("{} series", self.series.len())
        };
        format!("{points}, {sweeps}, {span}, {kinds}, {noise}")
    }

    /// Whether load, speed and drive tell the series apart, of which there are so many combinations.
    fn has_set_drives(&self, conditions: usize) -> bool {
        let set = |series: &Series| series.name.is_empty() && series.drives.0 == series.drives.1;
        self.series.len() <= conditions && self.series.iter().all(set)
    }

    /// Ranges of what was set and of what was read, in a line: a wrong unit shows there.
    pub fn ranges(&self) -> String {
        let one = |name: &str, unit: &str, of: &dyn Fn(&Point) -> f64| {
            let (low, high) =
                self.points.iter().map(of).fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
            let show = |value: f64| crate::units::format(format!("{value:.2e}").parse().unwrap_or(value), unit);
            let (low, high) = (show(low), show(high));
            if low == high { format!("{name} {low}") } else { format!("{name} {low} to {high}") }
        };
        let Signals { drive, reading } = self.signals;
        let arm = self.signals == Signals::ARM;
        let contact = arm || self.points.iter().any(|point| (point.speed, point.load) != (0.0, 0.0));
        let of_contact = [one("speed", "m/s", &|p| p.speed), one("load", "N", &|p| p.load)];
        let of_rig = [
            one(drive.name, drive.unit, &|p| p.drive),
            one(if arm { "amplitude" } else { reading.name }, reading.unit, &|p| p.amplitude),
        ];
        of_contact.into_iter().filter(|_| contact).chain(of_rig).collect::<Vec<_>>().join(", ")
    }
}

/// Reads the table that a scenario names under `[measurement]`; `None` where it names none.
///
/// # Errors
/// [`Error::Input`] with every problem of the table, up to a number that people read; [`Error::Io`] where the operating
/// system refuses the file.
pub fn load(scenario: &Scenario) -> Result<Option<Table>> {
    let Some(wanted) = &scenario.measurement else { return Ok(None) };
    load_bytes(scenario, &file::bytes(&wanted.file)?)
}

/// The same of bytes that are at hand; the name of the file still tells their format.
///
/// # Errors
/// As of [`load`].
pub fn load_bytes(scenario: &Scenario, bytes: &[u8]) -> Result<Option<Table>> {
    let Some(wanted) = &scenario.measurement else { return Ok(None) };
    read(wanted, bytes, &Frame::of(scenario), scenario.sweep.as_ref()).map(|(table, ..)| Some(table))
}

/// The cells of a table of other quantities than those of steady states.
pub(crate) fn sheet(path: &Path, bytes: &[u8], notes: &mut Vec<String>) -> Result<Sheet> {
    match Format::of(path)? {
        Format::Delimited => delimited::sheet(file::text(path, bytes, notes)?, None),
        Format::Instrument(kind) => delimited::sheet(instrument::table(file::text(path, bytes, notes)?, kind)?, None),
        Format::Workbook => workbook::sheet(path, bytes, None, notes),
        Format::Universal => {
            let title = format!("`{}` is a universal file, which holds no table of these", path.display());
            Err(Error::Input(whole_file(&title, "export the table as CSV")))
        }
    }
}

/// Table, columns and choices of a file.
type Read = (Table, Vec<Column>, Vec<(String, String)>);

/// Reads a table for what is expected of it.
fn read(wanted: &MeasurementSource, bytes: &[u8], frame: &Frame<'_>, sweep: Option<&Sweep>) -> Result<Read> {
    let mut notes = Vec::new();
    let format = Format::of(&wanted.file)?;
    let readings = match format {
        Format::Universal => {
            let source = universal::source(&wanted.file, bytes)?;
            universal::readings(&source, wanted.record, frame, sweep, &mut notes)?
        }
        _ => {
            let sheet = match format {
                Format::Workbook => workbook::sheet(&wanted.file, bytes, wanted.sheet.as_deref(), &mut notes)?,
                _ => sheet(&wanted.file, bytes, &mut notes)?,
            };
            rows::readings(&sheet, &wanted.columns, frame, sweep, &mut notes)?
        }
    };
    let readings = phased(within(readings, wanted, &mut notes)?, wanted);
    unused_keys(wanted, format, &mut notes);
    let Readings { signals, columns, choices, .. } = &readings;
    let (signals, columns, choices) = (*signals, columns.clone(), choices.clone());
    let (sweeps, agree) = if readings.drive_assumed { series::sweeps(&readings.list) } else { (1, true) };
    if sweeps > 1 && agree {
        notes.push(format!(
            "no column states the drive of the {sweeps} sweeps: where they meet they are mostly as large, as those of one drive are"
        ));
    } else if sweeps > 1 {
        let title = format!("`{}` holds {sweeps} sweeps, and no column states their drives", wanted.file.display());
        let help = "name a column force_n, drive_g, drive_v or the like; of a drive that was the same in all of them its setting will do: \
                    drive_v, the same number in every row";
        return Err(Error::Input(whole_file(&title, help)));
    }
    let mut pooled = pool::pool(readings, frame.is_arm(), &mut notes)?;
    let without = doubts::without_signal(&pooled.points, &mut notes);
    let all = pooled.points.into_iter().zip(pooled.spreads).zip(without);
    (pooled.points, pooled.spreads) = all.filter(|(_, without)| !without).map(|(kept, _)| kept).unzip();
    let mut series = std::mem::take(&mut pooled.series);
    let (mut points, amplitude_noise, phase_noise, freedom) = noise::assign(pooled, &wanted.file, signals, &mut notes)?;
    if let Some(point) = points.iter().find(|point| !point.is_finite()) {
        let title =
            format!("`{}`, line {}: reading and deviation are beyond all numbers", wanted.file.display(), point.line);
        let help =
            "the readings of the table differ by more than a computer's numbers can tell; check them, and their units";
        return Err(Error::Input(whole_file(&title, help)));
    }
    if !frame.is_free() && !frame.has_contact() {
        // Without a contact they tell series apart and nothing else.
        points.iter_mut().for_each(|point| (point.speed, point.load) = (0.0, 0.0));
        series.iter_mut().for_each(|one| (one.speed, one.load) = (0.0, 0.0));
    }
    notes.extend(doubts::doubts(&points, frame.is_arm()));
    let hash = blake3::hash(bytes).to_hex().to_string();
    let file = wanted.file.clone();
    let table =
        Table { file, hash, points, series, signals, amplitude_noise, phase_noise, freedom, refuted: None, notes };
    Ok((table, columns, choices))
}

/// The readings that a scenario asks for.
fn within(readings: Readings, wanted: &MeasurementSource, notes: &mut Vec<String>) -> Result<Readings> {
    let Some((from, to)) = wanted.band else { return Ok(readings) };
    let (mut kept, all) = (readings, |readings: &Readings| readings.list.len());
    let before = all(&kept);
    kept.list.retain(|reading| (from..=to).contains(&reading.frequency));
    let [from, to] = [from, to].map(|f| crate::units::format(f, "Hz"));
    if kept.list.is_empty() {
        let title = format!("`{}` has no reading between {from} and {to}", wanted.file.display());
        return Err(Error::Input(whole_file(&title, "change `frequency` in [measurement]")));
    }
    let out = before - all(&kept);
    if out > 0 {
        notes.push(format!("{out} of {before} rows are not used: they lie outside {from} to {to}"));
    }
    Ok(kept)
}

/// The readings without their phases, where the scenario wants none.
fn phased(mut readings: Readings, wanted: &MeasurementSource) -> Readings {
    if wanted.columns.iter().any(is_no_phase) {
        readings.list.iter_mut().for_each(|reading| (reading.phase, reading.phase_sd) = (None, None));
        readings.phase_stated = false;
    }
    readings
}

/// Whether an entry of a mapping says that no column is of phases.
fn is_no_phase((key, header): &(String, String)) -> bool {
    key == COLUMNS[PHASE] && header.trim().is_empty()
}

/// Formats, by the extension of the file's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Delimited,
    Instrument(instrument::Kind),
    Workbook,
    Universal,
}

impl Format {
    fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|text| text.to_string_lossy().to_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "csv" | "tsv" | "txt" | "dat" | "lvm" => Ok(Self::Delimited),
            "xlsx" | "xlsm" | "xlsb" | "xls" | "ods" => Ok(Self::Workbook),
            "uff" | "unv" | "uf" | "58" => Ok(Self::Universal),
            other => {
                if let Some(kind) = instrument::Kind::of(other) {
                    return Ok(Self::Instrument(kind));
                }
                let title = format!("`{}` does not say by its extension what kind of table it is", path.display());
                let help = "a table with commas, semicolons or tabs is .csv, .tsv, .txt, .dat or .lvm; \
                            a universal file .uff or .unv; a workbook .xlsx or .ods; Touchstone .s1p or .s2p; of a loudspeaker .zma or .frd";
                Err(Error::Input(whole_file(&title, help)))
            }
        }
    }
}

/// Says which keys of `[measurement]` have no meaning for the format.
fn unused_keys(wanted: &MeasurementSource, format: Format, notes: &mut Vec<String>) {
    let mut unused = |key: &str, of: &str| notes.push(format!("`{key}` is not used: it belongs to {of}"));
    if wanted.record.is_some() && format != Format::Universal {
        unused("record", "universal files");
    }
    if wanted.sheet.is_some() && format != Format::Workbook {
        unused("sheet", "workbooks");
    }
    if !wanted.columns.iter().all(is_no_phase) && format == Format::Universal {
        unused("columns", "tables with a header");
    }
}
