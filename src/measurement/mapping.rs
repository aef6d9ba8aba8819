//! The columns that the scenario maps, and the complaints about columns.

use super::frame::{Frame, kind};
use super::header::{self, Meaning};
use super::names::{ALL, AMPLITUDE, DRIVE, LAG, NUMBERS, PHASE};
use super::parts::Parts;
use super::rest::Rest;
use super::sheet::{Complaints, Sheet, Tally};
use super::swings::{Swing, other_amplitude};
use super::unit::Unit;
use crate::scenario::diagnostic::{nearest, quote};
use crate::scenario::parameters::{COLUMNS, MEASURED};

/// Where the numbers of a column come from.
#[derive(Debug, Clone)]
pub(crate) enum Slot {
    /// A column of the table and the unit of its numbers.
    Cells(usize, Unit),
    /// One value for all rows, in SI.
    Value(f64, &'static str),
}

impl Slot {
    /// The SI unit of its values.
    pub fn si(&self) -> &'static str {
        match self {
            Self::Cells(_, unit) => unit.si,
            Self::Value(_, si) => si,
        }
    }
}

/// What a search found.
pub(crate) struct Found {
    /// Columns of numbers, by position in [`COLUMNS`].
    pub slots: [Option<Slot>; NUMBERS],
    /// Columns of words, those after them.
    pub words: [Option<usize>; ALL - NUMBERS],
    /// Columns of the table that have a use, or that were complained about.
    pub taken: Vec<bool>,
    /// Columns that the scenario maps, or that were complained about.
    pub told: [bool; ALL],
    /// What was chosen of several where there is no scenario to say it.
    pub choices: Vec<(String, String)>,
    /// The columns of amplitude and phase, where they hold their parts.
    pub parts: Option<Parts>,
    /// What the numbers of every column of the table are like.
    pub tallies: Vec<Tally>,
}

impl Found {
    /// What is known before the search.
    pub fn nothing_of(sheet: &Sheet) -> Self {
        Self {
            slots: Default::default(),
            words: Default::default(),
            taken: vec![false; sheet.header.cells.len()],
            told: [false; ALL],
            choices: Vec::new(),
            parts: None,
            tallies: sheet.tallies(),
        }
    }
}

/// The columns found so far, and what is said of them.
pub(crate) struct Search<'a, 'b> {
    pub sheet: &'a Sheet,
    pub frame: &'a Frame<'a>,
    pub complaints: &'a mut Complaints<'b>,
    pub notes: &'a mut Vec<String>,
    pub found: Found,
}

impl Search<'_, '_> {
    /// The columns that the scenario maps.
    pub fn map(&mut self, mapping: &[(String, String)]) {
        for (key, wanted) in mapping {
            let Some(column) = column_of(key) else { continue };
            if wanted.trim().is_empty() && column > AMPLITUDE {
                // No column, whatever one is called.
                self.found.told[column] = true;
                let is_named = |index: usize| {
                    let meaning = header::meaning(&self.sheet.headed(index), self.frame);
                    matches!(meaning, Meaning::Column(c, ..) | Meaning::Alias(c, ..) | Meaning::Likely(c, _) if c == column)
                };
                let named: Vec<usize> = (0..self.found.taken.len()).filter(|index| is_named(*index)).collect();
                named.into_iter().for_each(|index| self.found.taken[index] = true);
                continue;
            }
            let Some(index) = self.mapped_index(key, wanted.trim(), column) else { continue };
            self.found.taken[index] = true;
            if column >= NUMBERS {
                self.found.words[column - NUMBERS] = Some(index);
                self.notes.push(format!("{} is read as {key}", quote(&self.sheet.header.cells[index])));
            } else {
                self.map_numbers(key, index, column);
            }
        }
    }

    /// Where the header stands that is mapped to a key; none where there is none, or the column or the header is mapped
    /// already.
    fn mapped_index(&mut self, key: &str, wanted: &str, column: usize) -> Option<usize> {
        let sheet = self.sheet;
        let headers = &sheet.header.cells;
        let place_of = |index: usize| sheet.place(&sheet.header, index);
        let exact = headers.iter().position(|header| header == wanted);
        let index = exact.or_else(|| headers.iter().position(|header| header.eq_ignore_ascii_case(wanted)));
        let again = std::mem::replace(&mut self.found.told[column], true);
        let Some(index) = index else {
            let title =
                format!("the table has no column {}, which [measurement] columns names as {key}", quote(wanted));
            let near = nearest(wanted, headers.iter().map(String::as_str));
            let label =
                near.map_or("the columns that there are".into(), |near| format!("did you mean {}?", quote(near)));
            let help = format!("write {key} = \"…\" in columns with one of these headers, letter by letter");
            self.complaints.add(&sheet.row_place(&sheet.header), &title, &label, &help);
            return None;
        };
        if again {
            let title = format!("[measurement] columns names the {} twice", COLUMNS[column]);
            let help = "drive, force and torque are one: name the one that drives the rig";
            self.complaints.add(&place_of(index), &title, &format!("named as {key}"), help);
            return None;
        }
        if self.found.taken[index] {
            let title = format!("[measurement] columns uses {} twice", quote(wanted));
            let label = format!("named again as {key}");
            self.complaints.add(&place_of(index), &title, &label, "name each header once");
            return None;
        }
        Some(index)
    }

    /// A column of numbers that is mapped to a key, in the unit that its header states or that is taken for granted.
    fn map_numbers(&mut self, key: &str, index: usize, column: usize) {
        let (sheet, frame) = (self.sheet, self.frame);
        let header = &sheet.header.cells[index];
        match header::mapped(&sheet.headed(index), key, column, frame) {
            Ok((unit, _)) if !frame.serving(column).contains(&unit.si) => self.unsuited(index, column, unit.si),
            Ok((unit, stated)) => {
                let unit = self.of_numbers(index, column, unit, stated).counted(key == LAG);
                let more = if stated { "" } else { ", no unit being stated" };
                let (shown, swing) = (unit.shown(), unit.swing.note());
                self.notes.push(format!("{} is read as {key} in {shown}{more}{swing}", quote(header)));
                if unit.swing == Swing::Amplitude {
                    self.notes.extend(other_amplitude(header, column));
                }
                self.found.slots[column] = Some(Slot::Cells(index, unit));
            }
            Err(why) => {
                let title = format!("the unit of column {} does not serve as {key}", quote(header));
                let si = frame.natural(column).unwrap_or(MEASURED[column].unit);
                let help = format!("`{key}` is the {}, in units like {si}", MEASURED[column].meaning);
                self.complaints.add(&sheet.place(&sheet.header, index), &title, &why, &help);
            }
        }
    }

    /// Two columns for one quantity.
    pub fn twice(&mut self, column: usize, before: usize, index: usize) {
        if self.complaints.leaves_out() {
            return;
        }
        let sheet = self.sheet;
        let title = format!("two columns hold the {}", COLUMNS[column].replace('_', " "));
        let label = format!("so does {}, column {}", quote(&sheet.header.cells[before]), before + 1);
        let help = "remove or rename one of the two, or choose with [measurement] columns";
        let label = sheet.cell_name(&sheet.header, index) + &label;
        self.complaints.add(&sheet.place(&sheet.header, index), &title, &label, help);
    }

    /// A unit that is none of the column's.
    pub fn bad_unit(&mut self, index: usize, column: usize, why: &str) {
        if self.complaints.leaves_out() {
            return;
        }
        let (sheet, frame) = (self.sheet, self.frame);
        let title = format!("the unit of column {} does not serve", quote(&sheet.header.cells[index]));
        let label = sheet.cell_name(&sheet.header, index) + why;
        let (key, meaning) = (COLUMNS[column], MEASURED[column].meaning);
        let help = format!("`{key}` is the {meaning}; write e.g. {}", frame.standard(column));
        self.complaints.add(&sheet.place(&sheet.header, index), &title, &label, &help);
    }

    /// A drive or a reading that the scenario's rig does not have.
    pub fn unsuited(&mut self, index: usize, column: usize, si: &'static str) {
        if self.complaints.leaves_out() {
            return;
        }
        let sheet = self.sheet;
        let (title, help) = other_rig(self.frame, column, si);
        let title = format!("column {} {title}", quote(&sheet.header.cells[index]));
        let label = format!("{}{}", sheet.cell_name(&sheet.header, index), kind(si));
        self.complaints.add(&sheet.place(&sheet.header, index), &title, &label, &help);
    }

    /// The unit of a column that states none by its numbers: of phases degrees where one is more than two turns of the
    /// circle in radians, of readings a level where most are negative, as no amplitude is.
    pub fn of_numbers(&self, index: usize, column: usize, unit: Unit, stated: bool) -> Unit {
        let most = MEASURED[PHASE].maximum;
        match column {
            PHASE if !stated && self.found.tallies[index].largest > most => unit.spelt("deg"),
            AMPLITUDE if !stated && unit.is_voltage() && self.found.tallies[index].is_negative() => Unit::level(),
            _ => unit,
        }
    }

    /// What has no use yet.
    pub fn rest(&self) -> Rest<'_> {
        Rest { sheet: self.sheet, frame: self.frame, taken: &self.found.taken, tallies: &self.found.tallies }
    }

    /// Whether a column is found, or was complained about.
    pub fn is_settled(&self, column: usize) -> bool {
        self.found.slots[column].is_some() || self.found.told[column]
    }
}

/// The column that a key of `[measurement] columns` means.
pub(crate) fn column_of(key: &str) -> Option<usize> {
    match key {
        "force" | "torque" => Some(DRIVE),
        LAG => Some(PHASE),
        _ => COLUMNS[..ALL].iter().position(|name| *name == key),
    }
}

/// What is said of a drive or a reading in a unit that the scenario's rig does not have: end of the title, and help.
pub(crate) fn other_rig(frame: &Frame<'_>, column: usize, si: &str) -> (String, String) {
    let (kind, change) = (kind(si), frame.change(column, si));
    let headers = frame.headers(column);
    if column == DRIVE {
        (format!("holds {kind}, by which the rig is not driven"), format!("the drive needs to be {headers}; {change}"))
    } else {
        (format!("holds {kind}, which is not read of the rig"), format!("the reading needs to be {headers}; {change}"))
    }
}
