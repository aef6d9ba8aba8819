//! The search for columns: those that the scenario maps, then those whose headers say what they are.

use super::frame::{Frame, READINGS, kind};
use super::header::{self, Meaning};
use super::likely::{in_hertz, is_deviation, is_other, is_setting, is_time};
use super::names::{ALL, AMPLITUDE, AMPLITUDE_SD, DRIVE, FREQUENCY, LAG, LOAD, NUMBERS, PHASE, PHASE_SD, SPEED};
use super::parts::{Parts, parts};
use super::sheet::{Complaints, Sheet, Tally};
use super::swings::{Swing, is_peak_to_peak, other_amplitude};
use super::unit::{Unit, Wanted};
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

/// Finds the columns that headers and mapping name.
pub(crate) fn search(
    sheet: &Sheet,
    mapping: &[(String, String)],
    frame: &Frame<'_>,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> Found {
    let taken = vec![false; sheet.header.cells.len()];
    let (slots, words, told, choices) = (Default::default(), Default::default(), [false; ALL], Vec::new());
    let tallies = sheet.tallies();
    let mut search =
        Search { sheet, tallies, frame, complaints, notes, slots, words, taken, told, choices, parts: None };
    search.map(mapping);
    search.find();
    let Search { slots, words, taken, told, choices, parts, tallies, .. } = search;
    Found { slots, words, taken, told, choices, parts, tallies }
}

/// A column that a header names.
struct Candidate {
    index: usize,
    unit: Unit,
    stated: bool,
}

/// What headers say, by the column that they speak for.
#[derive(Default)]
struct Said {
    /// By its name.
    named: [Vec<Candidate>; NUMBERS],
    /// By another name, which serves where no column has the name itself.
    aliases: [Vec<Candidate>; NUMBERS],
    /// By words and unit together.
    likely: [Vec<Candidate>; NUMBERS],
    /// By its name, without a unit.
    unstated: [Vec<Candidate>; NUMBERS],
    /// Columns of the table that cannot serve, what for, and why: in words, or their unit.
    unsuited: Vec<(usize, usize, Result<String, &'static str>)>,
}

/// The columns found so far.
struct Search<'a, 'b> {
    sheet: &'a Sheet,
    /// What the numbers of every column of the table are like.
    tallies: Vec<Tally>,
    frame: &'a Frame<'a>,
    complaints: &'a mut Complaints<'b>,
    notes: &'a mut Vec<String>,
    slots: [Option<Slot>; NUMBERS],
    words: [Option<usize>; ALL - NUMBERS],
    /// Columns of the table that have a use, or that were complained about.
    taken: Vec<bool>,
    /// Columns that the scenario maps, or that were complained about.
    told: [bool; ALL],
    /// What was chosen of several where there is no scenario to say it.
    choices: Vec<(String, String)>,
    parts: Option<Parts>,
}

/// The letter of an amplitude, whatever word stands behind it: `A_Skt`.
fn is_a(name: &str) -> bool {
    name.split('_').next() == Some("a")
}

/// The letter of a voltage, with a letter or digit behind it: `U`, `UC`, `U0`.
fn is_voltage(name: &str) -> bool {
    name.starts_with(['u', 'v']) && name.replace('_', "").chars().count() <= 2
}

impl Search<'_, '_> {
    /// Two columns that hold the parts of the readings, where no column holds their amplitude.
    fn find_parts(&mut self) {
        let amplitude = |index: usize| {
            matches!(header::meaning(&self.sheet.headed(index), self.frame), Meaning::Column(AMPLITUDE, ..))
        };
        if self.told[AMPLITUDE] || (0..self.taken.len()).any(amplitude) {
            return;
        }
        let Some(parts) = parts(self.sheet, self.frame, &self.taken, &self.tallies) else { return };
        let [real, imaginary] = [parts.real, parts.imaginary].map(|at| quote(&self.sheet.header.cells[at]));
        let unit = parts.unit.shown();
        let unit = if parts.stated { unit } else { format!("{unit}, no unit being stated") };
        self.notes.push(if parts.real == parts.imaginary {
            format!("the complex numbers of {real} are read as what is in phase with the drive and 90° ahead of it, in {unit}")
        } else {
            format!("{real} and {imaginary} are read as what is in phase with the drive and 90° ahead of it, in {unit}")
        });
        self.slots[AMPLITUDE] = Some(Slot::Cells(parts.real, parts.unit.clone()));
        self.slots[PHASE] = Some(Slot::Cells(parts.imaginary, Unit::of("rad")));
        for (index, column) in [(parts.real, AMPLITUDE), (parts.imaginary, PHASE)] {
            (self.taken[index], self.told[column]) = (true, true);
        }
        self.parts = Some(parts);
    }

    /// What the headers say of columns that have no use yet.
    fn read_headers(&mut self) -> Said {
        let mut said = Said::default();
        for index in 0..self.taken.len() {
            if self.taken[index] {
                continue;
            }
            match header::meaning(&self.sheet.headed(index), self.frame) {
                // Of what deviates its unit is known.
                Meaning::NoUnit(AMPLITUDE_SD | PHASE_SD) | Meaning::Column(AMPLITUDE_SD | PHASE_SD, _, false) => {}
                Meaning::Column(column, unit, stated) if !self.told[column] => {
                    let unit = self.of_numbers(index, column, unit, stated);
                    if self.frame.serving(column).contains(&unit.si) {
                        said.named[column].push(Candidate { index, unit, stated });
                    } else {
                        said.unsuited.push((index, column, Err(unit.si)));
                    }
                }
                Meaning::Alias(column, unit, stated)
                    if !self.told[column] && self.frame.serving(column).contains(&unit.si) =>
                {
                    let unit = self.of_numbers(index, column, unit, stated);
                    said.aliases[column].push(Candidate { index, unit, stated });
                }
                Meaning::Likely(column, unit)
                    if !self.told[column] && self.frame.serving(column).contains(&unit.si) =>
                {
                    said.likely[column].push(Candidate { index, unit, stated: true });
                }
                // Of a drive or a reading without a unit nothing is known but that it goes with the force or the
                // motion.
                Meaning::NoUnit(column @ (DRIVE | AMPLITUDE)) if self.frame.is_free() && !self.told[column] => {
                    let unit = self.of_numbers(index, column, Unit::of("V"), false);
                    said.unstated[column].push(Candidate { index, unit, stated: false });
                }
                Meaning::NoUnit(column) if !self.told[column] => {
                    said.unsuited.push((index, column, Ok("no unit is stated, and nothing else tells it".into())));
                }
                Meaning::BadUnit(column, why) if !self.told[column] => said.unsuited.push((index, column, Ok(why))),
                Meaning::Words(column) if !self.told[column] => {
                    if let Some(before) = self.words[column - NUMBERS] {
                        self.twice(column, before, index);
                    } else {
                        self.words[column - NUMBERS] = Some(index);
                    }
                    self.taken[index] = true;
                }
                _ => {}
            }
        }
        said
    }

    /// Columns whose headers say what they are.
    fn find(&mut self) {
        self.find_parts();
        let Said { named, mut aliases, likely, unstated, unsuited } = self.read_headers();
        // A time is the same angle, told in coarser steps.
        if self.only(|unit| unit.si == "rad").is_some() {
            aliases[PHASE].retain(|candidate| !candidate.unit.is_of_lags());
        }
        let contact = self.frame.has_contact() || self.frame.is_free() && !named[LOAD].is_empty();
        let roller = self.told[SPEED] || !named[SPEED].is_empty() || !aliases[SPEED].is_empty();
        let with_speed = !contact || roller;
        for (column, ((named, aliases), likely)) in named.into_iter().zip(aliases).zip(likely).enumerate() {
            if named.is_empty() {
                let others = if aliases.is_empty() { likely } else { aliases };
                self.choose_alias(column, others, with_speed);
            } else {
                self.choose(column, named);
            }
        }
        self.find_hertz();
        // A name says more than a unit.
        if unstated[AMPLITUDE].is_empty() && !(self.frame.is_free() && self.letter().is_some()) {
            self.find_reading(with_speed);
        }
        self.find_phase();
        self.find_without_unit(unstated);
        self.find_drive();
        self.find_deviations();
        for (index, column, why) in unsuited {
            if self.slots[column].is_none() && !self.told[column] {
                match why {
                    Ok(why) => self.bad_unit(index, column, &why),
                    Err(si) => self.unsuited(index, column, si),
                }
                (self.taken[index], self.told[column]) = (true, true);
            }
        }
    }

    /// The unit of a column that states none by its numbers: of phases degrees where one is more than two turns of the
    /// circle in radians, of readings a level where most are negative, as no amplitude is.
    fn of_numbers(&self, index: usize, column: usize, unit: Unit, stated: bool) -> Unit {
        let most = MEASURED[PHASE].maximum;
        match column {
            PHASE if !stated && self.tallies[index].largest > most => unit.spelt("deg"),
            AMPLITUDE if !stated && unit.is_voltage() && self.tallies[index].is_negative() => Unit::level(),
            _ => unit,
        }
    }

    /// The frequency by its unit alone, where one column has it and none a name, or by its letter.
    fn find_hertz(&mut self) {
        if self.slots[FREQUENCY].is_some() || self.told[FREQUENCY] {
            return;
        }
        let sheet = self.sheet;
        let unit = |index: &usize| {
            let header = sheet.headed(*index);
            let (name, bracket) = header::split(&header);
            in_hertz(&header::plain(name), bracket)
        };
        let unused = || (0..self.taken.len()).filter(|index| !self.taken[*index]);
        let mut found: Vec<(usize, Unit, bool)> =
            unused().filter_map(|index| Some((index, unit(&index)?, true))).collect();
        // What has a phase is no force: an F beside it that states no unit.
        if found.is_empty() && self.frame.is_free() && self.slots[PHASE].is_some() {
            let bare = unused().filter(|index| sheet.headed(*index).trim() == "F");
            found = bare.map(|index| (index, Unit::of("Hz"), false)).collect();
        }
        if let [(index, unit, stated)] = found.as_slice() {
            if !stated {
                self.choices.push((COLUMNS[FREQUENCY].into(), sheet.header.cells[*index].clone()));
            }
            let likely = vec![Candidate { index: *index, unit: unit.clone(), stated: *stated }];
            self.choose_alias(FREQUENCY, likely, true);
        }
    }

    /// Columns without a use that are not zero throughout, their plain names and their units where they have one that a
    /// reading may have.
    fn unnamed(&self) -> Vec<(usize, String, Unit)> {
        let wanted = Wanted { possible: READINGS, natural: None, share: false, per_drive: false };
        let of = |index: usize| {
            let header = self.sheet.headed(index);
            let (name, bracket) = header::split(&header);
            let unit = match bracket {
                Some(text) => wanted.unit(text).ok()?,
                // The end of a name is a word more often than a unit.
                None => wanted.unit(name.rsplit_once('_')?.1).ok().filter(Unit::is_voltage)?,
            };
            Some((index, header::plain(name), unit))
        };
        (0..self.taken.len())
            .filter(|index| !self.taken[*index] && !self.tallies[*index].is_zero())
            .filter_map(of)
            .collect()
    }

    /// The reading by its unit alone, where one column has such a unit, its deviation apart, and none a name.
    fn find_reading(&mut self, with_speed: bool) {
        let named = |column: usize| self.slots[column].is_some() || self.told[column];
        if named(AMPLITUDE) || !named(FREQUENCY) {
            return;
        }
        let all = self.unnamed();
        let deviation = |name: &str| self.sheet.names().any(|of| is_deviation(name, &of));
        let whole = |index: usize| is_peak_to_peak(&self.sheet.header.cells[index]);
        // An angle may be a phase as well, unless nothing else is there to be read.
        let plain = |index: usize| header::plain(header::split(&self.sheet.headed(index)).0);
        let is_left = |index: &usize| !self.taken[*index] && !deviation(&plain(*index));
        let phased = named(PHASE) || (0..self.taken.len()).filter(is_left).count() == 1;
        let serves = |(_, name, unit): &&(usize, String, Unit)| {
            let known = phased || unit.si != "rad";
            known && self.frame.serving(AMPLITUDE).contains(&unit.si) && !deviation(name)
        };
        let (swings, others): (Vec<_>, Vec<_>) = all.iter().filter(serves).partition(|(index, ..)| whole(*index));
        let mut found: Vec<_> = others.into_iter().filter(|(_, name, _)| !is_other(name)).collect();
        // Of what was measured for its own sake its deviation is stated.
        let is_stated = |(_, name, _): &&(usize, String, Unit)| self.sheet.names().any(|own| is_deviation(&own, name));
        if found.is_empty() || found.len() > 1 && swings.iter().any(is_stated) && !found.iter().any(is_stated) {
            found = swings;
        }
        if let ([one, other], false) = (&found[..], named(DRIVE)) {
            if one.2.is_voltage() && other.2.is_voltage() && self.frame.is_free() {
                // Of two voltages the one that is held drives.
                let held = self.sheet.change(one.0) < self.sheet.change(other.0);
                let (drive, reading) = if held { (*one, *other) } else { (*other, *one) };
                for (column, (index, ..)) in [(DRIVE, drive), (AMPLITUDE, reading)] {
                    self.choices.push((COLUMNS[column].into(), self.sheet.header.cells[*index].clone()));
                }
                self.choose_alias(DRIVE, vec![Candidate { index: drive.0, unit: drive.2.clone(), stated: true }], true);
                found = vec![reading];
            } else {
                // A voltage drives what stands beside it.
                found.retain(|(.., unit)| !unit.is_voltage());
            }
        }
        if let [(index, _, unit)] = found[..] {
            let unit = if whole(*index) { unit.clone().swinging(Swing::Whole) } else { unit.clone() };
            let likely = vec![Candidate { index: *index, unit, stated: true }];
            self.choose_alias(AMPLITUDE, likely, with_speed);
        }
    }

    /// The one column without a use and of no statistics whose unit fits.
    fn only(&self, fits: impl Fn(&Unit) -> bool) -> Option<(usize, Unit)> {
        let is_plain =
            |name: &str| !is_other(name) && !is_setting(name) && !self.sheet.names().any(|of| is_deviation(name, &of));
        let mut all = self.unnamed().into_iter().filter(|(_, name, unit)| fits(unit) && is_plain(name));
        let (index, _, unit) = all.next()?;
        all.next().is_none().then_some((index, unit))
    }

    /// The drive by its unit alone: one voltage beside a reading that is none, unless it follows that as the signal of its
    /// sensor; beside a voltage, or what states no unit, one that is held from row to row.
    fn find_drive(&mut self) {
        let Some(Slot::Cells(reading, read)) = &self.slots[AMPLITUDE] else { return };
        let driven = self.slots[DRIVE].is_some() || self.told[DRIVE];
        if driven || !self.frame.serving(DRIVE).contains(&"V") {
            return;
        }
        if let Some((index, unit)) = self.only(Unit::is_voltage)
            && !self.sheet.follows(index, *reading)
            && (!read.is_voltage() || self.frame.is_free() && self.sheet.change(index) == 0.0)
        {
            if read.is_voltage() {
                self.choices.push((COLUMNS[DRIVE].into(), self.sheet.header.cells[index].clone()));
            }
            let likely = vec![Candidate { index, unit, stated: true }];
            self.choose_alias(DRIVE, likely, true);
        }
    }

    /// The phase by its unit alone: one angle beside a reading and a frequency, none of which has a phase.
    fn find_phase(&mut self) {
        let found = |column: usize| self.slots[column].is_some() || self.told[column];
        if found(PHASE) || !found(AMPLITUDE) || !found(FREQUENCY) {
            return;
        }
        if let Some((index, unit)) = self.only(|unit| unit.si == "rad") {
            self.choices.push((COLUMNS[PHASE].into(), self.sheet.header.cells[index].clone()));
            let likely = vec![Candidate { index, unit, stated: true }];
            self.choose_alias(PHASE, likely, true);
        }
    }

    /// The first column without a use and without a unit that has such a name.
    fn bare(&self, is_named: impl Fn(&str) -> bool) -> Option<usize> {
        (0..self.taken.len()).filter(|index| !self.taken[*index]).find(|index| {
            let header = self.sheet.headed(*index);
            let (name, unit) = header::split(&header);
            unit.is_none() && is_named(name)
        })
    }

    /// The column whose name is the letter of an amplitude; a small one, which may be a distance on the screen of an
    /// oscilloscope, not beside voltages.
    fn letter(&self) -> Option<usize> {
        let capital = self.bare(|name| name.starts_with('A') && is_a(&header::plain(name)));
        let voltage = || self.bare(|name| is_voltage(&header::plain(name)));
        capital
            .or_else(|| self.bare(|name| is_a(&header::plain(name))))
            .filter(|_| capital.is_some() || voltage().is_none())
    }

    /// Drive and reading where none has a unit: the one that has its name or letter, of two columns the reading by what the
    /// other is; without a scenario that says what they are.
    fn find_without_unit(&mut self, mut named: [Vec<Candidate>; NUMBERS]) {
        if !self.frame.is_free() {
            return;
        }
        if named[AMPLITUDE].is_empty() && self.slots[AMPLITUDE].is_none() && self.slots[FREQUENCY].is_some() {
            let (sheet, both) = (self.sheet, self.taken.len() == 2);
            if let Some(index) = if both { self.bare(|name| !is_time(&header::plain(name))) } else { self.letter() } {
                self.choices.push((COLUMNS[AMPLITUDE].into(), sheet.header.cells[index].clone()));
                // Of two columns the name may end in the unit: `theta_rad`.
                let wanted = Wanted { possible: READINGS, natural: None, share: false, per_drive: false };
                let header = sheet.headed(index);
                let end = header.rsplit_once('_').and_then(|(_, end)| wanted.unit(end).ok());
                let stated = end.is_some();
                let unit = end.unwrap_or_else(|| Unit::of("V"));
                named[AMPLITUDE].push(Candidate { index, unit, stated });
            }
        }
        for column in [DRIVE, AMPLITUDE] {
            if self.slots[column].is_none() && !self.told[column] && named[column].len() == 1 {
                self.choose(column, std::mem::take(&mut named[column]));
            }
        }
    }

    /// Standard deviations by the names of what they are of, `dA` beside `A`, `Δφ` beside `φ`; in the unit of that where
    /// they state none.
    fn find_deviations(&mut self) {
        for (column, of) in [(AMPLITUDE_SD, AMPLITUDE), (PHASE_SD, PHASE)] {
            let Some(Slot::Cells(at, unit)) = &self.slots[of] else { continue };
            if self.slots[column].is_some() || self.told[column] {
                continue;
            }
            let (sheet, its) = (self.sheet, unit.clone().counted(false));
            let name = header::plain(header::split(&sheet.headed(*at)).0);
            let candidate = |index: usize| {
                let header = sheet.headed(index);
                let own = header::plain(header::split(&header).0);
                if own != COLUMNS[column] && !is_deviation(&own, &name) {
                    return None;
                }
                let (unit, stated) = header::mapped(&header, COLUMNS[column], column, self.frame).ok()?;
                let unit = if stated { unit } else { its.clone() };
                // What a whole swing deviates by is of the whole swing, unless it says otherwise.
                let as_its = own != COLUMNS[column] && !unit.relative && unit.swing == Swing::Amplitude;
                let unit = if as_its { unit.swinging(its.swing) } else { unit };
                // A level deviates by a factor.
                let serves = unit.relative || unit.si == its.si && !unit.is_level();
                serves.then_some(Candidate { index, unit, stated })
            };
            let unused = (0..self.taken.len()).filter(|index| !self.taken[*index] && !self.tallies[*index].is_zero());
            let found: Vec<Candidate> = unused.filter_map(candidate).collect();
            if found.len() == 1 {
                self.choose_alias(column, found, true);
            }
        }
    }

    /// The column that is used of those that could be; volts only where nothing else is there.
    fn choose(&mut self, column: usize, mut candidates: Vec<Candidate>) {
        if self.frame.is_free() {
            self.keep_likeliest(column, &mut candidates);
        }
        let volts = |candidate: &Candidate| candidate.unit.si == "V";
        let all_volts = candidates.iter().all(volts);
        for candidate in candidates.into_iter().filter(|candidate| all_volts || !volts(candidate)) {
            let Candidate { index, unit, stated } = candidate;
            self.taken[index] = true;
            if let Some(Slot::Cells(before, _)) = &self.slots[column] {
                self.twice(column, *before, index);
                continue;
            }
            if !stated {
                let header = quote(&self.sheet.header.cells[index]);
                self.notes.push(match self.frame.is_free() && unit.si == "V" {
                    true if unit.over.is_some() => format!(
                        "{header} is read as {} in dB: it states no unit, and most of its numbers are negative",
                        COLUMNS[column]
                    ),
                    true => format!(
                        "{header} is read as {}: it states no unit, and 1 V stands for one of whatever it is in",
                        COLUMNS[column]
                    ),
                    false => format!("{header} states no unit and is read in {}", unit.shown()),
                });
            }
            if unit.swing != Swing::Amplitude {
                let (header, unit, swing) = (&self.sheet.header.cells[index], unit.shown(), unit.swing.note());
                self.notes.push(format!("{} is read as {} in {unit}{swing}", quote(header), COLUMNS[column]));
            }
            self.slots[column] = Some(Slot::Cells(index, unit));
        }
    }

    /// The one column that a name of another custom means; of several, none is more likely than the others.
    fn choose_alias(&mut self, column: usize, mut candidates: Vec<Candidate>, with_speed: bool) {
        let sheet = self.sheet;
        let header = |candidate: &Candidate| quote(&sheet.header.cells[candidate.index]);
        // Nobody reads nothing in all rows: that is the speed or the load of a rig without a contact.
        candidates.retain(|candidate| column != AMPLITUDE || !self.tallies[candidate.index].is_zero());
        if candidates.iter().any(|candidate| candidate.unit.si != "V") {
            candidates.retain(|candidate| candidate.unit.si != "V");
        }
        if !with_speed {
            // A velocity may be the roller's.
            candidates.retain(|candidate| column != AMPLITUDE || candidate.unit.si != "m/s");
        }
        if self.frame.is_free() {
            self.keep_likeliest(column, &mut candidates);
        }
        // A time beside a frequency is another one than its period.
        if candidates.iter().any(|candidate| !candidate.unit.is_of_periods()) {
            candidates.retain(|candidate| !candidate.unit.is_of_periods());
        }
        if let (FREQUENCY, true, [first, other]) = (column, self.frame.is_free(), &candidates[..]) {
            // Both channels of an oscilloscope tell it.
            let first = first.index;
            if self.sheet.follows(other.index, first) {
                candidates.truncate(1);
                self.choices.push((COLUMNS[column].into(), self.sheet.header.cells[first].clone()));
            }
        }
        match candidates.as_slice() {
            [] => {}
            [one] => {
                let (header, key) = (header(one), COLUMNS[column]);
                let unit = one.unit.shown() + if one.stated { "" } else { ", no unit being stated" };
                let lag = if one.unit.negated { ", a lag positive," } else { "" };
                let swing = one.unit.swing.note();
                self.notes.push(format!("{header} is read as {key}{lag} in {unit}{swing}"));
                self.taken[one.index] = true;
                self.slots[column] = Some(Slot::Cells(one.index, one.unit.clone()));
            }
            [first, second, ..] if column <= AMPLITUDE => {
                let title = format!("which column is the {}?", COLUMNS[column]);
                let label = format!("{}this or {}", sheet.cell_name(&sheet.header, second.index), header(first));
                let more = if column == FREQUENCY { "; where it is their sum, add a column of that" } else { "" };
                let help = format!(
                    "name it {}, or say which with [measurement] columns = {{ {} = \"…\" }}{more}",
                    self.frame.standard(column),
                    COLUMNS[column]
                );
                self.complaints.add(&sheet.place(&sheet.header, second.index), &title, &label, &help);
                self.told[column] = true;
            }
            _ => {}
        }
    }

    /// Of several drives or readings, where there is no scenario to say which: the drive that is most often one, the
    /// reading that stands first; volts come last.
    fn keep_likeliest(&mut self, column: usize, candidates: &mut Vec<Candidate>) {
        if candidates.len() < 2 || !matches!(column, DRIVE | AMPLITUDE) {
            return;
        }
        let rank = |candidate: &Candidate| {
            let place = self.frame.serving(column).iter().position(|si| *si == candidate.unit.si);
            if column == DRIVE { place } else { Some(usize::from(candidate.unit.si == "V")) }
        };
        candidates.sort_by_key(rank);
        let alone = rank(&candidates[0]) != rank(&candidates[1]) && candidates[1].unit.si == "V";
        candidates.truncate(1);
        if !alone {
            self.choices.push((COLUMNS[column].into(), self.sheet.header.cells[candidates[0].index].clone()));
        }
    }

    /// Two columns for one quantity.
    fn twice(&mut self, column: usize, before: usize, index: usize) {
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
    fn bad_unit(&mut self, index: usize, column: usize, why: &str) {
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
    fn unsuited(&mut self, index: usize, column: usize, si: &'static str) {
        if self.complaints.leaves_out() {
            return;
        }
        let sheet = self.sheet;
        let (title, help) = other_rig(self.frame, column, si);
        let title = format!("column {} {title}", quote(&sheet.header.cells[index]));
        let label = format!("{}{}", sheet.cell_name(&sheet.header, index), kind(si));
        self.complaints.add(&sheet.place(&sheet.header, index), &title, &label, &help);
    }

    /// The columns that the scenario maps.
    fn map(&mut self, mapping: &[(String, String)]) {
        for (key, wanted) in mapping {
            let Some(column) = column_of(key) else { continue };
            let Some(index) = self.mapped_index(key, wanted.trim(), column) else { continue };
            self.taken[index] = true;
            if column >= NUMBERS {
                self.words[column - NUMBERS] = Some(index);
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
        let again = std::mem::replace(&mut self.told[column], true);
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
        if self.taken[index] {
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
                self.slots[column] = Some(Slot::Cells(index, unit));
            }
            Err(why) => {
                let title = format!("the unit of column {} does not serve as {key}", quote(header));
                let si = frame.natural(column).unwrap_or(MEASURED[column].unit);
                let help = format!("`{key}` is the {}, in units like {si}", MEASURED[column].meaning);
                self.complaints.add(&sheet.place(&sheet.header, index), &title, &why, &help);
            }
        }
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
