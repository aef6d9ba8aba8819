//! Cells become readings in SI; every cell that is no such number is told with its place.

use super::columns::{Layout, layout};
use super::frame::{Frame, amplitude_header, kind};
use super::mapping::Slot;
use super::names::{AMPLITUDE, AMPLITUDE_SD, DRIVE, FREQUENCY, LOAD, MEAN, PHASE, PHASE_SD, SERIES, SPEED, SWEEP};
use super::parts::{Parts, split_complex};
use super::preamble::BLANKS;
use super::reading::{Reading, Readings};
use super::rounding::Steps;
use super::sheet::{Complaints, Row, Sheet};
use super::unit::Unit;
use super::{Column, Direction};
use crate::error::Result;
use crate::scenario::Sweep;
use crate::scenario::diagnostic::quote;
use crate::scenario::parameters::{COLUMNS, MEASURED, needed_range};
use crate::statistics::wrap;
use crate::units::{self, count};
use std::f64::consts::{PI, TAU};

/// The readings of a sheet.
pub(crate) fn readings(
    sheet: &Sheet,
    mapping: &[(String, String)],
    frame: &Frame<'_>,
    sweep: Option<&Sweep>,
    notes: &mut Vec<String>,
) -> Result<Readings> {
    let mut complaints = Complaints::of(&sheet.source);
    let mut layout = layout(sheet, mapping, frame, sweep, &mut complaints, notes);
    same_quantity(sheet, &mut layout, &mut complaints, notes);
    if layout.slots[PHASE].is_none() && layout.slots[PHASE_SD].take().is_some() {
        notes.push("the standard deviation of the phase is not used: there is no phase".into());
    }
    let columns: Vec<usize> = layout.slots.iter().flatten().filter_map(Slot::index).collect();
    let commas = decimal_commas(sheet, &columns, &mut complaints);
    written(sheet, commas, notes);
    let steps = [AMPLITUDE, PHASE].map(|column| {
        layout.slots[column].as_ref().and_then(Slot::index).map_or(Steps::default(), |at| Steps::of(sheet, at, commas))
    });
    let mut list = Vec::new();
    // A frequency of zero anywhere else is a slip.
    let is_spectrum = sheet.rows().next().is_some_and(|first| is_constant_part(&layout, &first))
        && sheet.rows().any(|row| !is_constant_part(&layout, &row));
    let mut without = [0; WITHOUT.len()];
    for (at, row) in sheet.rows().enumerate() {
        let is_without = [
            is_spectrum && is_constant_part(&layout, &row),
            row.cells.iter().any(|cell| is_overflow(cell)),
            is_unread(&layout, &row),
        ];
        if let Some(why) = is_without.into_iter().position(|is| is) {
            without[why] += 1;
            continue;
        }
        let mut cells = Cells { sheet, layout: &layout, row: &row, commas, steps, complaints: &mut complaints };
        list.extend(cells.reading(at + 1));
    }
    if list.is_empty() {
        no_readings(sheet, without, &mut complaints);
    }
    complaints.check()?;
    let blank = list.iter().filter(|reading| reading.phase.is_none()).count();
    if layout.slots[PHASE].is_some() && blank > 0 {
        notes.push(format!("{blank} of {} rows have no phase", list.len()));
    }
    let without = without.into_iter().zip(WITHOUT).filter(|(rows, _)| *rows > 0);
    notes.extend(without.map(|(rows, why)| format!("{} {why}, not used", count(rows, "row"))));
    let stated = |column: usize| layout.slots[column].is_some();
    let si = |column: usize| layout.slots[column].as_ref().map_or("", Slot::si);
    Ok(Readings {
        list,
        signals: frame.signals(si(DRIVE), si(AMPLITUDE)),
        columns: used(sheet, &layout),
        choices: layout.choices,
        drive_assumed: layout.drive_assumed,
        amplitude_stated: stated(AMPLITUDE_SD),
        phase_stated: stated(PHASE_SD),
    })
}

/// Why rows hold no reading.
const WITHOUT: [&str; 3] = [
    "at 0 Hz, the constant part of a spectrum",
    "with a number of 9.9e37, which an instrument writes that has no reading",
    "with empty cells where the reading would stand",
];

/// No row holds a reading, and so many lack it for each reason.
fn no_readings(sheet: &Sheet, without: [usize; WITHOUT.len()], complaints: &mut Complaints<'_>) {
    let most = without.into_iter().zip(WITHOUT).max_by_key(|(rows, _)| *rows).filter(|(rows, _)| *rows > 0);
    let Some((rows, why)) = most else { return };
    let label = format!("below are {} {why}", count(rows, "row"));
    let help = "write a frequency and a reading in each row; leave out the rows that have none";
    complaints.add(&sheet.row_place(&sheet.header), "the table has no readings", &label, help);
}

/// What an instrument writes instead of infinity, or, a little larger, of no number (SCPI-99, volume 1, section 7.2.1).
const OVERFLOW: f64 = 9.9e37;

/// Whether a cell is a number that stands for none.
fn is_overflow(cell: &str) -> bool {
    let number = || cell.trim().replace(',', ".").parse::<f64>();
    cell.contains("37") && number().is_ok_and(|number| number.abs() >= OVERFLOW && number.is_finite())
}

/// Whether a row has a frequency, and empty cells in place of amplitude and phase.
fn is_unread(layout: &Layout, row: &Row) -> bool {
    let of = |column: usize| layout.slots[column].as_ref().and_then(Slot::index);
    let is_empty = |index: usize| row.cells.get(index).is_some_and(|cell| cell.trim().is_empty());
    let parts = layout.parts.iter().flat_map(|parts| [parts.real, parts.imaginary]);
    let read: Vec<usize> =
        if layout.parts.is_some() { parts.collect() } else { of(AMPLITUDE).into_iter().chain(of(PHASE)).collect() };
    !read.is_empty() && read.into_iter().all(is_empty) && of(FREQUENCY).is_some_and(|index| !is_empty(index))
}

/// Whether a row is of frequency zero, with which a spectrum begins.
fn is_constant_part(layout: &Layout, row: &Row) -> bool {
    let Some(Slot::Cells(index, unit)) = &layout.slots[FREQUENCY] else { return false };
    row.cells.get(*index).is_some_and(|cell| unit.convert(&cell.replace(',', ".")) == Ok(0.0))
}

/// What was made of the columns of a sheet.
fn used(sheet: &Sheet, layout: &Layout) -> Vec<Column> {
    let name = |(index, header): (usize, &String)| {
        let numbers = layout.slots.iter().zip(COLUMNS).find_map(|(slot, key)| match slot {
            Some(Slot::Cells(at, unit)) if *at == index => Some((*key, unit.shown())),
            _ => None,
        });
        let part = |parts: &&Parts| [parts.real, parts.imaginary].contains(&index);
        let part = layout.parts.as_ref().filter(part).map(|parts| (COLUMNS[AMPLITUDE], parts.unit.shown()));
        let numbers = part.or(numbers);
        let words = [(layout.series, COLUMNS[SERIES]), (layout.sweep, COLUMNS[SWEEP])];
        let words = words.into_iter().find(|(at, _)| *at == Some(index)).map(|(_, key)| (key, String::new()));
        let (key, unit) = numbers.or(words).unzip();
        Column { header: header.clone(), key, unit: unit.filter(|unit| !unit.is_empty()) }
    };
    sheet.header.cells.iter().enumerate().map(name).collect()
}

/// A standard deviation and a mean are of what is read.
fn same_quantity(sheet: &Sheet, layout: &mut Layout, complaints: &mut Complaints<'_>, notes: &mut Vec<String>) {
    let Some(si) = layout.slots[AMPLITUDE].as_ref().map(Slot::si) else { return };
    for column in [AMPLITUDE_SD, MEAN] {
        let Some(Slot::Cells(index, unit)) = &mut layout.slots[column] else { continue };
        if unit.relative || unit.si == si {
            continue;
        }
        let (index, header) = (*index, quote(&sheet.header.cells[*index]));
        if column == MEAN {
            notes.push(format!("{header} is not used: it holds {}, and what is read is {}", kind(unit.si), kind(si)));
            layout.slots[MEAN] = None;
            continue;
        }
        let title = format!("the standard deviation in column {header} is not one of the amplitude");
        let label =
            format!("{}{}, where the amplitude is {}", sheet.cell_name(&sheet.header, index), kind(unit.si), kind(si));
        let help = "state it in the unit of the amplitude, or in percent of it: amplitude_sd_percent";
        complaints.add(&sheet.place(&sheet.header, index), &title, &label, help);
    }
}

/// Whether commas are decimal ones: inside of cells of the columns used, and not beside decimal points.
pub(crate) fn decimal_commas(sheet: &Sheet, used: &[usize], complaints: &mut Complaints<'_>) -> bool {
    let find = |mark: char| {
        let cell = |row: Row| {
            let index = *used.iter().find(|index| row.cells.get(**index).is_some_and(|cell| cell.contains(mark)))?;
            Some((row, index))
        };
        sheet.rows().find_map(cell)
    };
    let Some((row, index)) = find(',') else { return false };
    if let Some((other, point)) = find('.') {
        let (cell, point) = (quote(&row.cells[index]), quote(&other.cells[point]));
        let title = format!("the table has decimal commas, {cell}, and decimal points, {point}");
        let label = format!("a point stands in line {}", other.line);
        let help = "it cannot be told which of them separate thousands; write all numbers the same way";
        complaints.add(&sheet.place(&row, index), &title, &label, help);
    }
    true
}

/// Says how the file was taken apart where that is not as the documentation has it.
pub(crate) fn written(sheet: &Sheet, commas: bool, notes: &mut Vec<String>) {
    notes.extend(sheet.told.iter().cloned());
    let cells = match sheet.delimiter {
        b';' => Some("semicolons separate the cells"),
        b'\t' if !(sheet.workbook || sheet.told.iter().any(|told| told == BLANKS)) => Some("tabs separate the cells"),
        _ => None,
    };
    let units = (!sheet.units.is_empty()).then_some("the row below the header states units");
    let said: Vec<&str> = cells.into_iter().chain(commas.then_some("commas are decimal ones")).chain(units).collect();
    if !said.is_empty() {
        notes.push(said.join(", "));
    }
}

impl Slot {
    fn index(&self) -> Option<usize> {
        match self {
            Self::Cells(index, _) => Some(*index),
            Self::Value(..) => None,
        }
    }
}

/// The cells of one row.
struct Cells<'a, 'b> {
    sheet: &'a Sheet,
    layout: &'a Layout,
    row: &'a Row,
    commas: bool,
    /// Those of amplitude and phase.
    steps: [Steps; 2],
    complaints: &'a mut Complaints<'b>,
}

impl Cells<'_, '_> {
    fn reading(&mut self, number: usize) -> Option<Reading> {
        let (speed, load, drive) = (self.setting(SPEED), self.setting(LOAD), self.number(DRIVE));
        let (name, sweep) = (self.name(), self.sweep());
        let (frequency, mean) = (self.number(FREQUENCY), self.optional(MEAN));
        let (amplitude, phase) = self.reading_of(drive);
        let share = self.layout.slots[AMPLITUDE_SD].as_ref().is_some_and(|slot| match slot {
            Slot::Cells(_, unit) => unit.relative,
            Slot::Value(..) => false,
        });
        let amplitude_sd =
            self.deviation(AMPLITUDE_SD, true).map(|sd| sd.map(|sd| sd * self.times(AMPLITUDE_SD, drive)));
        let phase_sd = self.deviation(PHASE_SD, !matches!(phase, Some(None)));
        if let (Some(value), Some(sd)) = (amplitude, amplitude_sd) {
            self.zero(value, sd.is_none() || share);
            self.resolved(AMPLITUDE_SD, sd, if share { 1.0 } else { value });
        }
        self.resolved(PHASE_SD, phase_sd.flatten(), PI);
        let turns = self.turns(frequency);
        let aside = self.layout.aside.iter().filter_map(|index| self.row.cells.get(*index).map(String::as_str));
        let aside = aside.collect::<Vec<_>>().join("\0");
        Some(Reading {
            row: number,
            line: self.row.line,
            speed: speed?,
            load: load?,
            drive: drive?,
            frequency: frequency?,
            amplitude: amplitude?,
            phase: phase?.map(|phase| wrap(phase * turns)),
            amplitude_sd: amplitude_sd?.map(|sd| if share { sd * amplitude.unwrap_or(0.0) } else { sd }),
            phase_sd: phase_sd?,
            mean: mean?,
            rounding: [self.rounding(AMPLITUDE, 0) * self.times(AMPLITUDE, drive), self.rounding(PHASE, 1) * turns],
            name: name?,
            sweep: sweep?,
            series: 0,
            aside,
        })
    }

    /// What makes angles of the phases: 2 pi f where they are times.
    fn turns(&self, frequency: Option<f64>) -> f64 {
        match &self.layout.slots[PHASE] {
            Some(Slot::Cells(_, unit)) if unit.is_of_lags() => TAU * frequency.unwrap_or(f64::NAN),
            _ => 1.0,
        }
    }

    /// Amplitude and phase, from their parts where the table holds these; a ratio times the drive.
    fn reading_of(&mut self, drive: Option<f64>) -> (Option<f64>, Option<Option<f64>>) {
        let times = self.times(AMPLITUDE, drive);
        let Some(Parts { real, imaginary, unit, .. }) = &self.layout.parts else {
            return (self.number(AMPLITUDE).map(|size| size * times), self.optional(PHASE));
        };
        let parts = if real == imaginary {
            let cell = self.row.cells[*real].as_str();
            match split_complex(cell) {
                Some(parts) => parts.map(|part| self.number_of(AMPLITUDE, *real, unit, &part)),
                None => [self.number_of(AMPLITUDE, *real, unit, cell), Some(0.0)],
            }
        } else {
            [*real, *imaginary].map(|index| self.value(AMPLITUDE, index, unit))
        };
        let [Some(real), Some(imaginary)] = parts else { return (None, None) };
        (Some(real.hypot(imaginary) * times), Some(Some(imaginary.atan2(real))))
    }

    /// Standard deviation that rounding leaves of a cell; zero where a number is made of several.
    fn rounding(&self, column: usize, of: usize) -> f64 {
        match &self.layout.slots[column] {
            Some(Slot::Cells(index, unit)) if self.layout.parts.is_none() => {
                self.steps[of].deviation(&self.row.cells[*index], self.commas, unit)
            }
            _ => 0.0,
        }
    }

    /// What the numbers of a column are times: the drive, where they are per drive.
    fn times(&self, column: usize, drive: Option<f64>) -> f64 {
        match &self.layout.slots[column] {
            Some(Slot::Cells(_, unit)) if unit.over.is_some() => drive.unwrap_or(1.0),
            _ => 1.0,
        }
    }

    /// A number that every row needs.
    fn number(&mut self, column: usize) -> Option<f64> {
        match self.layout.slots[column].as_ref()? {
            Slot::Value(value, _) => Some(*value),
            Slot::Cells(index, unit) => self.cell(column, *index, unit),
        }
    }

    /// Speed or load, zero where there is no such column.
    fn setting(&mut self, column: usize) -> Option<f64> {
        if self.layout.slots[column].is_none() { Some(0.0) } else { self.number(column) }
    }

    /// The name of the series; none where the cell lacks it.
    fn name(&mut self) -> Option<String> {
        let Some(index) = self.layout.series else { return Some(String::new()) };
        let name = self.row.cells[index].clone();
        if name.is_empty() {
            let help = "a column `series` names the sweep of every row, with a word or a number; write it in each";
            self.fail(index, "empty", "the cell is empty", "a name is needed", help);
            return None;
        }
        Some(name)
    }

    /// The direction of the sweep; the outer option tells whether the cell is sound.
    fn sweep(&mut self) -> Option<Option<Direction>> {
        let Some(index) = self.layout.sweep else { return Some(None) };
        let written = self.row.cells[index].as_str();
        match written.to_lowercase().as_str() {
            "up" => Some(Some(Direction::Up)),
            "down" => Some(Some(Direction::Down)),
            _ => {
                let title = format!("{} is not a direction", quote(written));
                let help = "a column `sweep` says which way the frequency was swept: up or down; rename it if it holds anything else";
                self.fail(index, "direction", &title, "`up` or `down` is needed", help);
                None
            }
        }
    }

    /// A number that may be left out; the outer option tells whether the cell is sound.
    fn optional(&mut self, column: usize) -> Option<Option<f64>> {
        match &self.layout.slots[column] {
            Some(Slot::Cells(index, _)) if self.row.cells[*index].is_empty() => Some(None),
            Some(_) => self.number(column).map(Some),
            None => Some(None),
        }
    }

    /// A standard deviation: where the column is there, needed in every row that has the reading.
    fn deviation(&mut self, column: usize, needed: bool) -> Option<Option<f64>> {
        if self.layout.slots[column].is_none() {
            return Some(None);
        }
        if !needed {
            return self.optional(column).map(|_| None);
        }
        let sd = self.number(column)?;
        if sd == 0.0 {
            let index = self.layout.slots[column].as_ref().and_then(Slot::index).unwrap_or(0);
            let label = "needs to be more than zero";
            let help = "a reading without uncertainty would outweigh all others: write the least that could be told there, or remove the \
                        column to have the noise estimated";
            self.fail(index, "deviation", "the standard deviation is zero", label, help);
            return None;
        }
        Some(Some(sd))
    }

    /// A deviation below the rounding of what it is of says nothing of it, and would outweigh all others.
    fn resolved(&mut self, column: usize, sd: Option<f64>, of: f64) {
        if sd.is_some_and(|sd| sd < f64::EPSILON * of)
            && let Some(index) = self.layout.slots[column].as_ref().and_then(Slot::index)
        {
            let title = "the standard deviation is less than the rounding of the number that it is of";
            let help = "check it, and its unit; remove the column to have the noise estimated";
            self.fail(index, "deviation", title, "too small for a computer's numbers", help);
        }
    }

    /// An amplitude of zero has no relative uncertainty.
    fn zero(&mut self, amplitude: f64, relative: bool) {
        if amplitude == 0.0
            && relative
            && let Some(index) = self.layout.slots[AMPLITUDE].as_ref().and_then(Slot::index)
        {
            let unit = self.layout.slots[AMPLITUDE].as_ref().map_or("rad", Slot::si);
            let header = amplitude_header(unit).replacen("amplitude", "amplitude_sd", 1);
            let help =
                format!("its standard deviation cannot be a share of it; state one in {header}, or remove the row");
            self.fail(index, "zero", "the amplitude is zero", "zero", &help);
        }
    }

    fn cell(&mut self, column: usize, index: usize, unit: &Unit) -> Option<f64> {
        let value = self.value(column, index, unit)?;
        let info = MEASURED[column];
        if !(info.minimum..=info.maximum).contains(&value) {
            let si = if unit.relative { "1" } else { unit.si };
            let name = if matches!(column, AMPLITUDE_SD | PHASE_SD) { info.meaning } else { info.key };
            let title = format!("the {name} is outside its physical range: {}", units::format(value, si));
            let label = needed_range((info.minimum, info.maximum), si);
            let shown = if unit.relative { "%".into() } else { unit.shown() };
            let what = format!("`{}` is the {}", info.key, info.meaning);
            let help = format!("{what}, here read in {shown}; check the number, and the unit in the header");
            self.fail(index, "range", &title, &label, &help);
            return None;
        }
        Some(value)
    }

    /// The number of a cell, whatever is possible of its column.
    fn value(&mut self, column: usize, index: usize, unit: &Unit) -> Option<f64> {
        let row = self.row;
        self.number_of(column, index, unit, &row.cells[index])
    }

    /// The number that is written in a cell.
    fn number_of(&mut self, column: usize, index: usize, unit: &Unit, written: &str) -> Option<f64> {
        let info = MEASURED[column];
        let shown = || if unit.relative { "%".into() } else { unit.shown() };
        let what = || format!("`{}` is the {}", info.key, info.meaning);
        if written.is_empty() {
            let help = match column {
                AMPLITUDE_SD | PHASE_SD => {
                    format!("{}; state it in every row, or in none to have it estimated", what())
                }
                _ => format!("{}; write it, or remove the row", what()),
            };
            self.fail(index, "empty", "the cell is empty", &format!("a number in {} is needed", shown()), &help);
            return None;
        }
        let number = written.replace('−', "-");
        let number = if self.commas { number.replace(',', ".") } else { number };
        let Ok(value) = number.parse::<f64>() else {
            let help = format!("{}; its unit belongs in the header; remove the row if there is no reading", what());
            self.fail(
                index,
                "number",
                &format!("{} is not a number", quote(written)),
                &format!("a number in {} is needed", shown()),
                &help,
            );
            return None;
        };
        let value = if value.is_finite() { unit.convert(&number) } else { Ok(value) };
        match value {
            Ok(value) if value.is_finite() => Some(value),
            _ => {
                let label = format!("a finite number in {} is needed", shown());
                let help = format!("{}; remove the row if there is no reading", what());
                self.fail(index, "finite", &format!("{} is not finite", quote(written)), &label, &help);
                None
            }
        }
    }

    /// Notes a problem of a cell, with the name of its column; those of one kind are told once.
    fn fail(&mut self, index: usize, kind: &'static str, title: &str, label: &str, help: &str) {
        if self.complaints.again((index, kind), self.row.line) {
            return;
        }
        let place = self.sheet.place(self.row, index);
        let title = format!("column {}: {title}", quote(&self.sheet.header.cells[index]));
        let label = self.sheet.cell_name(self.row, index) + label;
        self.complaints.add_row((index, kind), self.row.line, &place, [&title, &label, help]);
    }
}
