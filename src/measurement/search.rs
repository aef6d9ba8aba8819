//! The search for columns: those that the scenario maps, then those whose headers say what they are.

use super::frame::{Frame, READINGS};
use super::header::{self, Meaning};
use super::likely::{is_deviation, is_time};
use super::mapping::{Found, Search, Slot};
use super::modes::TOLD;
use super::names::{AMPLITUDE, AMPLITUDE_SD, DRIVE, FREQUENCY, LOAD, NUMBERS, PHASE, PHASE_SD, SPEED};
use super::parts::parts;
use super::rest::Candidate;
use super::sheet::{Complaints, Sheet};
use super::swings::Swing;
use super::unit::{Unit, Wanted};
use crate::scenario::diagnostic::quote;
use crate::scenario::parameters::COLUMNS;

/// Finds the columns that headers and mapping name.
pub(crate) fn search(
    sheet: &Sheet,
    mapping: &[(String, String)],
    frame: &Frame<'_>,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> Found {
    let mut search = Search { sheet, frame, complaints, notes, found: Found::nothing_of(sheet) };
    search.map(mapping);
    search.find();
    search.found
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

impl Search<'_, '_> {
    /// Two columns that hold the parts of the readings, where no column holds their amplitude.
    fn find_parts(&mut self) {
        let amplitude = |index: usize| {
            matches!(header::meaning(&self.sheet.headed(index), self.frame), Meaning::Column(AMPLITUDE, ..))
        };
        if self.found.told[AMPLITUDE] || (0..self.found.taken.len()).any(amplitude) {
            return;
        }
        let Some(parts) = parts(self.sheet, self.frame, &self.found.taken, &self.found.tallies) else { return };
        let [real, imaginary] = [parts.real, parts.imaginary].map(|at| quote(&self.sheet.header.cells[at]));
        let unit = parts.unit.shown();
        let unit = if parts.stated { unit } else { format!("{unit}, no unit being stated") };
        self.notes.push(if parts.real == parts.imaginary {
            format!("the complex numbers of {real} are read as what is in phase with the drive and 90° ahead of it, in {unit}")
        } else {
            format!("{real} and {imaginary} are read as what is in phase with the drive and 90° ahead of it, in {unit}")
        });
        self.found.slots[AMPLITUDE] = Some(Slot::Cells(parts.real, parts.unit.clone()));
        self.found.slots[PHASE] = Some(Slot::Cells(parts.imaginary, Unit::of("rad")));
        for (index, column) in [(parts.real, AMPLITUDE), (parts.imaginary, PHASE)] {
            (self.found.taken[index], self.found.told[column]) = (true, true);
        }
        self.found.parts = Some(parts);
    }

    /// What the headers say of columns that have no use yet.
    fn read_headers(&mut self) -> Said {
        let mut said = Said::default();
        for index in 0..self.found.taken.len() {
            if self.found.taken[index] {
                continue;
            }
            match header::meaning(&self.sheet.headed(index), self.frame) {
                // Of what deviates its unit is known.
                Meaning::NoUnit(AMPLITUDE_SD | PHASE_SD) | Meaning::Column(AMPLITUDE_SD | PHASE_SD, _, false) => {}
                Meaning::Column(column, unit, stated) if !self.found.told[column] => {
                    let unit = self.of_numbers(index, column, unit, stated);
                    if self.frame.serving(column).contains(&unit.si) {
                        said.named[column].push(Candidate { index, unit, stated });
                    } else {
                        said.unsuited.push((index, column, Err(unit.si)));
                    }
                }
                Meaning::Alias(column, unit, stated)
                    if !self.found.told[column] && self.frame.serving(column).contains(&unit.si) =>
                {
                    let unit = self.of_numbers(index, column, unit, stated);
                    said.aliases[column].push(Candidate { index, unit, stated });
                }
                Meaning::Likely(column, unit)
                    if !self.found.told[column] && self.frame.serving(column).contains(&unit.si) =>
                {
                    said.likely[column].push(Candidate { index, unit, stated: true });
                }
                // Of a drive or a reading without a unit nothing is known but that it goes with the force or the
                // motion.
                Meaning::NoUnit(column @ (DRIVE | AMPLITUDE)) if self.frame.is_free() && !self.found.told[column] => {
                    let unit = self.of_numbers(index, column, Unit::of("V"), false);
                    said.unstated[column].push(Candidate { index, unit, stated: false });
                }
                Meaning::NoUnit(column) if !self.found.told[column] => {
                    said.unsuited.push((index, column, Ok("no unit is stated, and nothing else tells it".into())));
                }
                Meaning::BadUnit(column, why) if !self.found.told[column] => {
                    said.unsuited.push((index, column, Ok(why)))
                }
                Meaning::Words(column) if !self.found.told[column] => {
                    if let Some(before) = self.found.words[column - NUMBERS] {
                        self.twice(column, before, index);
                    } else {
                        self.found.words[column - NUMBERS] = Some(index);
                    }
                    self.found.taken[index] = true;
                }
                _ => {}
            }
        }
        said
    }

    /// Columns whose headers say what they are.
    fn find(&mut self) {
        self.find_parts();
        let Said { named, mut aliases, mut likely, unstated, unsuited } = self.read_headers();
        // A time is the same angle, told in coarser steps; but what is the only reading there can be tells no phase.
        if let Some(angle) = self.rest().only(|unit| unit.si == "rad") {
            let all = [&named, &aliases, &likely, &unstated].map(|said| said[AMPLITUDE].iter().map(|one| one.index));
            let readings: Vec<usize> = all.into_iter().flatten().collect();
            let is_reading = readings.contains(&angle.index);
            let others = self.rest().readings(true);
            let unnamed =
                others.iter().filter(|other| !is_reading && !other.unit.is_voltage()).map(|other| other.index);
            if readings.into_iter().chain(unnamed).any(|index| index != angle.index) {
                aliases[PHASE].retain(|candidate| !candidate.unit.is_of_lags());
            }
        }
        let loaded = !named[LOAD].is_empty() || !aliases[LOAD].is_empty();
        let mut roller = self.found.told[SPEED] || !named[SPEED].is_empty() || !aliases[SPEED].is_empty();
        if !roller && (self.frame.has_contact() || self.frame.is_free() && loaded) {
            roller = self.tell_roller(&mut aliases);
        }
        if self.frame.is_free() && !roller {
            // A force beside one that drives is no load of a contact where nothing slides.
            aliases[LOAD].clear();
        }
        if self.frame.is_free() && named[AMPLITUDE].is_empty() {
            let driven = [&named, &aliases, &likely, &unstated].iter().any(|said| !said[DRIVE].is_empty());
            let said = if aliases[AMPLITUDE].is_empty() { &mut likely } else { &mut aliases };
            self.set_apart(&mut said[AMPLITUDE], driven || self.is_settled(DRIVE));
        }
        let contact = self.frame.has_contact() || self.frame.is_free() && !named[LOAD].is_empty();
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
        if unstated[AMPLITUDE].is_empty() && !(self.frame.is_free() && self.rest().letter().is_some()) {
            self.find_reading(with_speed);
        }
        self.find_phase();
        self.find_without_unit(unstated);
        self.leave_out_dead_phases();
        self.find_drive();
        self.find_deviations();
        for (index, column, why) in unsuited {
            if self.found.slots[column].is_none() && !self.found.told[column] {
                match why {
                    Ok(why) => self.bad_unit(index, column, &why),
                    Err(si) => self.unsuited(index, column, si),
                }
                (self.found.taken[index], self.found.told[column]) = (true, true);
            }
        }
    }

    /// Beside a load and another reading, a velocity that changes from row to row less than that is the roller's: whether
    /// there is one.
    fn tell_roller(&self, aliases: &mut [Vec<Candidate>; NUMBERS]) -> bool {
        let readings = &mut aliases[AMPLITUDE];
        let is_velocity = |one: &Candidate| one.unit.si == "m/s";
        let change = |one: &Candidate| self.sheet.change(one.index);
        let least = readings.iter().filter(|one| !is_velocity(one)).map(change).reduce(f64::min);
        let mut velocities = (0..readings.len()).filter(|&at| is_velocity(&readings[at]));
        let (Some(at), None, Some(least)) = (velocities.next(), velocities.next(), least) else { return false };
        let is_held = change(&readings[at]) < least;
        if is_held {
            let roller = readings.remove(at);
            aliases[SPEED].push(roller);
        }
        is_held
    }

    /// Uses a column that was chosen by what it is like, and says so where there was a choice.
    fn choose_likely(&mut self, column: usize, likely: Candidate, of_several: bool) {
        if of_several {
            self.found.choices.push((COLUMNS[column].into(), self.sheet.header.cells[likely.index].clone()));
        }
        self.choose_alias(column, vec![likely], true);
    }

    /// The frequency by its unit alone, where one column has it and none a name, or by its letter.
    fn find_hertz(&mut self) {
        if self.is_settled(FREQUENCY) {
            return;
        }
        let phased = self.frame.is_free() && self.found.slots[PHASE].is_some();
        if let Some(likely) = self.rest().hertz(phased) {
            let guessed = !likely.stated;
            self.choose_likely(FREQUENCY, likely, guessed);
        }
    }

    /// The reading by its unit alone, where one column has such a unit, its deviation apart, and none a name.
    fn find_reading(&mut self, with_speed: bool) {
        if self.is_settled(AMPLITUDE) || !self.is_settled(FREQUENCY) {
            return;
        }
        let mut found = self.rest().readings(self.is_settled(PHASE));
        if let ([one, other], false) = (&found[..], self.is_settled(DRIVE)) {
            if one.unit.is_voltage() && other.unit.is_voltage() && self.frame.is_free() {
                // Of two voltages the one that is held drives.
                let held = self.sheet.change(one.index) < self.sheet.change(other.index);
                let drive = found.remove(usize::from(!held));
                self.found.choices.push((COLUMNS[AMPLITUDE].into(), self.sheet.header.cells[found[0].index].clone()));
                self.choose_likely(DRIVE, drive, true);
            } else {
                // A voltage drives what stands beside it.
                found.retain(|reading| !reading.unit.is_voltage());
            }
        }
        if found.len() == 1 {
            self.choose_alias(AMPLITUDE, found, with_speed);
        }
    }

    /// The drive by its unit alone: one voltage beside a reading that is none, unless it follows that as the signal of its
    /// sensor; beside a voltage, or what states no unit, one that is held from row to row.
    fn find_drive(&mut self) {
        let Some(Slot::Cells(reading, read)) = &self.found.slots[AMPLITUDE] else { return };
        if self.is_settled(DRIVE) || !self.frame.serving(DRIVE).contains(&"V") {
            return;
        }
        let beside = read.is_voltage();
        if let Some(likely) = self.rest().only(Unit::is_voltage)
            && !self.sheet.follows(likely.index, *reading)
            && (!beside || self.frame.is_free() && self.sheet.change(likely.index) == 0.0)
        {
            self.choose_likely(DRIVE, likely, beside);
        }
    }

    /// The phase by its unit alone: one angle beside a reading and a frequency, none of which has a phase.
    fn find_phase(&mut self) {
        if self.is_settled(PHASE) || !self.is_settled(AMPLITUDE) || !self.is_settled(FREQUENCY) {
            return;
        }
        if let Some(likely) = self.rest().only(|unit| unit.si == "rad") {
            self.choose_likely(PHASE, likely, true);
        }
    }

    /// Phases that are zero in all rows, of a curve or more, were not measured, unless the scenario says which column holds them.
    fn leave_out_dead_phases(&mut self) {
        let Some(Slot::Cells(index, _)) = self.found.slots[PHASE] else { return };
        let tally = &self.found.tallies[index];
        if tally.is_zero() && tally.numbers >= TOLD && !self.found.told[PHASE] {
            self.found.slots[PHASE] = None;
            let header = quote(&self.sheet.header.cells[index]);
            self.notes.retain(|note| !note.starts_with(&header));
            self.notes.push(format!("{header} is 0 in all rows: no phase was measured"));
        }
    }

    /// Drive and reading where none has a unit: the one that has its name or letter, of two columns the reading by what the
    /// other is; without a scenario that says what they are.
    fn find_without_unit(&mut self, mut named: [Vec<Candidate>; NUMBERS]) {
        if !self.frame.is_free() {
            return;
        }
        if named[AMPLITUDE].is_empty() && self.found.slots[AMPLITUDE].is_none() && self.found.slots[FREQUENCY].is_some()
        {
            let (sheet, both) = (self.sheet, self.found.taken.len() == 2);
            if let Some(index) =
                if both { self.rest().bare(|name| !is_time(&header::plain(name))) } else { self.rest().letter() }
            {
                self.found.choices.push((COLUMNS[AMPLITUDE].into(), sheet.header.cells[index].clone()));
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
            if self.found.slots[column].is_none() && !self.found.told[column] && named[column].len() == 1 {
                self.choose(column, std::mem::take(&mut named[column]));
            }
        }
    }

    /// Standard deviations by the names of what they are of, `dA` beside `A`, `Δφ` beside `φ`; in the unit of that where
    /// they state none.
    fn find_deviations(&mut self) {
        for (column, of) in [(AMPLITUDE_SD, AMPLITUDE), (PHASE_SD, PHASE)] {
            let Some(Slot::Cells(at, unit)) = &self.found.slots[of] else { continue };
            if self.found.slots[column].is_some() || self.found.told[column] {
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
            let unused = (0..self.found.taken.len())
                .filter(|index| !self.found.taken[*index] && !self.found.tallies[*index].is_zero());
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
            self.found.taken[index] = true;
            if let Some(Slot::Cells(before, _)) = &self.found.slots[column] {
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
            self.found.slots[column] = Some(Slot::Cells(index, unit));
        }
    }

    /// The one column that a name of another custom means; of several, none is more likely than the others.
    fn choose_alias(&mut self, column: usize, mut candidates: Vec<Candidate>, with_speed: bool) {
        let sheet = self.sheet;
        let header = |candidate: &Candidate| quote(&sheet.header.cells[candidate.index]);
        // Nobody reads nothing in all rows: that is the speed or the load of a rig without a contact.
        candidates.retain(|candidate| column != AMPLITUDE || !self.found.tallies[candidate.index].is_zero());
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
                self.found.choices.push((COLUMNS[column].into(), self.sheet.header.cells[first].clone()));
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
                self.found.taken[one.index] = true;
                self.found.slots[column] = Some(Slot::Cells(one.index, one.unit.clone()));
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
                self.found.told[column] = true;
            }
            _ => {}
        }
    }

    /// Sets apart what could be read by its name but is held while another is not; where that is one voltage and nothing
    /// else drives, it does. A current that is held is a setting beside whatever else could be read.
    fn set_apart(&mut self, candidates: &mut Vec<Candidate>, driven: bool) {
        let (sheet, mut all) = (self.sheet, std::mem::take(candidates));
        let changes = self.rest().readings(true).iter().any(|one| sheet.change(one.index) > 0.0);
        all.retain(|one| !(changes && one.unit.is_current() && sheet.change(one.index) == 0.0));
        let ways: [&dyn Fn(&Candidate) -> bool; 2] =
            [&|one| sheet.is_narrow(one.index), &|one| sheet.change(one.index) == 0.0];
        let is_held = |way: &&dyn Fn(&Candidate) -> bool, one: &Candidate| !one.unit.is_level() && way(one);
        let tells = |way: &&&dyn Fn(&Candidate) -> bool| {
            all.iter().any(|one| is_held(way, one)) && !all.iter().all(|one| is_held(way, one))
        };
        let held: Vec<bool> = match ways.iter().find(tells) {
            Some(way) => all.iter().map(|one| is_held(way, one)).collect(),
            None => vec![false; all.len()],
        };
        let (held, moving): (Vec<_>, Vec<_>) = all.into_iter().zip(held).partition(|(_, held)| *held);
        let [held, moving] = [held, moving].map(|of| of.into_iter().map(|(one, _)| one).collect::<Vec<_>>());
        *candidates = moving;
        if let ([drive], false) = (&held[..], driven)
            && drive.unit.is_voltage()
        {
            self.choose_likely(DRIVE, drive.clone(), true);
        }
        if let ([reading], false) = (&candidates[..], held.is_empty()) {
            self.found.choices.push((COLUMNS[AMPLITUDE].into(), sheet.header.cells[reading.index].clone()));
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
            self.found.choices.push((COLUMNS[column].into(), self.sheet.header.cells[candidates[0].index].clone()));
        }
    }
}
