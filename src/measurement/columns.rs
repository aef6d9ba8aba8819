//! Which column of a table is which: by its header, by the scenario's mapping, or from the scenario where it is one value.

use super::frame::{Frame, kind};
use super::header::{self, ALL, AMPLITUDE, DRIVE, FREQUENCY, LOAD, Meaning, NUMBERS, SERIES, SPEED, SWEEP};
use super::samples;
use super::sheet::{Complaints, Sheet};
use super::unit::Unit;
use crate::scenario::Sweep;
use crate::scenario::diagnostic::{nearest, quote};
use crate::scenario::parameters::{COLUMNS, MEASURED};
use crate::units;

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

/// The columns of a table in standard order, and the positions of those that are kept aside.
pub(crate) struct Layout {
    /// By position in [`COLUMNS`].
    pub slots: [Option<Slot>; NUMBERS],
    /// The column that names the series.
    pub series: Option<usize>,
    /// The column that states the direction of the sweep.
    pub sweep: Option<usize>,
    /// Columns that are not used.
    pub aside: Vec<usize>,
    /// Keys and headers that a scenario has to map, as several columns could serve.
    pub choices: Vec<(String, String)>,
}

/// A column that a header names.
struct Candidate {
    index: usize,
    unit: Unit,
    stated: bool,
}

/// The columns found so far.
struct Search<'a, 'b> {
    sheet: &'a Sheet,
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
}

/// Finds the columns; problems are noted at the header.
pub(crate) fn layout(
    sheet: &Sheet,
    mapping: &[(String, String)],
    frame: &Frame<'_>,
    sweep: Option<&Sweep>,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> Layout {
    let taken = vec![false; sheet.header.cells.len()];
    let (slots, words, told) = (Default::default(), Default::default(), [false; ALL]);
    let known = |index: usize| {
        let found = header::meaning(&sheet.headed(index), frame);
        matches!(found, Meaning::Column(FREQUENCY, ..) | Meaning::Alias(FREQUENCY, ..) | Meaning::BadUnit(FREQUENCY, _))
    };
    let named = mapping.iter().any(|(key, _)| column_of(key) == Some(FREQUENCY));
    if !named && !(0..sheet.header.cells.len()).any(known) && samples::refuse(sheet, complaints) {
        let slots = Default::default();
        return Layout { slots, series: None, sweep: None, aside: Vec::new(), choices: Vec::new() };
    }
    let choices = Vec::new();
    let mut search = Search { sheet, frame, complaints, notes, slots, words, taken, told, choices };
    search.map(mapping);
    search.find();
    let Search { mut slots, words, taken, told, choices, .. } = search;
    let aside: Vec<usize> = (0..taken.len()).filter(|index| !taken[*index]).collect();
    let needed = (SPEED..=AMPLITUDE).filter(|column| frame.has_contact() || !matches!(*column, SPEED | LOAD));
    let mut lacking = Vec::new();
    for column in needed.filter(|column| !told[*column]) {
        if slots[column].is_none() {
            slots[column] = swept(column, frame, sweep, notes);
        }
        if slots[column].is_none() {
            lacking.push(column);
        }
    }
    if !lacking.is_empty() {
        missing(sheet, frame, &lacking, sweep, &aside, complaints);
    }
    name_aside(sheet, frame, &slots, &aside, notes);
    without_contact(sheet, frame, &slots, notes);
    without_sensitivity(sheet, frame, &slots, notes);
    Layout { slots, series: words[SERIES - NUMBERS], sweep: words[SWEEP - NUMBERS], aside, choices }
}

impl Search<'_, '_> {
    /// Columns whose headers say what they are.
    fn find(&mut self) {
        let mut candidates: [Vec<Candidate>; NUMBERS] = Default::default();
        let mut aliases: [Vec<Candidate>; NUMBERS] = Default::default();
        let mut unsuited = Vec::new();
        for index in 0..self.taken.len() {
            if self.taken[index] {
                continue;
            }
            match header::meaning(&self.sheet.headed(index), self.frame) {
                Meaning::Column(column, unit, stated) if !self.told[column] => {
                    if self.frame.serving(column).contains(&unit.si) {
                        candidates[column].push(Candidate { index, unit, stated });
                    } else {
                        unsuited.push((index, column, Err(unit.si)));
                    }
                }
                Meaning::Alias(column, unit, stated) if !self.told[column] => {
                    if self.frame.serving(column).contains(&unit.si) {
                        aliases[column].push(Candidate { index, unit, stated });
                    }
                }
                Meaning::NoUnit(column) if !self.told[column] => {
                    unsuited.push((index, column, Ok("no unit is stated, and nothing else tells it".into())));
                }
                Meaning::BadUnit(column, why) if !self.told[column] => unsuited.push((index, column, Ok(why))),
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
        let contact = self.frame.has_contact() || self.frame.is_free() && !candidates[LOAD].is_empty();
        let roller = self.told[SPEED] || !candidates[SPEED].is_empty() || !aliases[SPEED].is_empty();
        let with_speed = !contact || roller;
        for (column, (candidates, aliases)) in candidates.into_iter().zip(aliases).enumerate() {
            if candidates.is_empty() {
                self.choose_alias(column, aliases, with_speed);
            } else {
                self.choose(column, candidates);
            }
        }
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
                self.notes.push(format!("{header} states no unit and is read in {}", unit.si));
            }
            self.slots[column] = Some(Slot::Cells(index, unit));
        }
    }

    /// The one column that a name of another custom means; of several, none is more likely than the others.
    fn choose_alias(&mut self, column: usize, mut candidates: Vec<Candidate>, with_speed: bool) {
        let sheet = self.sheet;
        let header = |candidate: &Candidate| quote(&sheet.header.cells[candidate.index]);
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
        match candidates.as_slice() {
            [] => {}
            [one] => {
                let (header, key) = (header(one), COLUMNS[column]);
                let unit =
                    if one.stated { one.unit.text.clone() } else { format!("{}, no unit being stated", one.unit.si) };
                self.notes.push(format!("{header} is read as {key} in {unit}"));
                self.taken[one.index] = true;
                self.slots[column] = Some(Slot::Cells(one.index, one.unit.clone()));
            }
            [first, second, ..] if column <= AMPLITUDE => {
                let title = format!("which column is the {}?", COLUMNS[column]);
                let label = format!("{}this or {}", sheet.cell_name(&sheet.header, second.index), header(first));
                let help = format!(
                    "name it {}, or say which with [measurement] columns = {{ {} = \"…\" }}",
                    self.frame.standard(column),
                    COLUMNS[column]
                );
                self.complaints.add(&sheet.place(&sheet.header, second.index), &title, &label, &help);
                self.told[column] = true;
            }
            _ => {}
        }
    }

    /// Of several drives or readings, where there is no scenario to say which: the drive that is most often one, the reading that
    /// stands first; volts come last.
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
        let sheet = self.sheet;
        let title = format!("two columns hold the {}", COLUMNS[column].replace('_', " "));
        let label = format!("so does {}, column {}", quote(&sheet.header.cells[before]), before + 1);
        let help = "remove or rename one of the two, or choose with [measurement] columns";
        let label = sheet.cell_name(&sheet.header, index) + &label;
        self.complaints.add(&sheet.place(&sheet.header, index), &title, &label, help);
    }

    /// A unit that is none of the column's.
    fn bad_unit(&mut self, index: usize, column: usize, why: &str) {
        let (sheet, frame) = (self.sheet, self.frame);
        let title = format!("the unit of column {} does not serve", quote(&sheet.header.cells[index]));
        let label = sheet.cell_name(&sheet.header, index) + why;
        let (key, meaning) = (COLUMNS[column], MEASURED[column].meaning);
        let help = format!("`{key}` is the {meaning}; write e.g. {}", frame.standard(column));
        self.complaints.add(&sheet.place(&sheet.header, index), &title, &label, &help);
    }

    /// A drive or a reading that the scenario's rig does not have.
    fn unsuited(&mut self, index: usize, column: usize, si: &'static str) {
        let sheet = self.sheet;
        let (title, help) = other_rig(self.frame, column, si);
        let title = format!("column {} {title}", quote(&sheet.header.cells[index]));
        let label = format!("{}{}", sheet.cell_name(&sheet.header, index), kind(si));
        self.complaints.add(&sheet.place(&sheet.header, index), &title, &label, &help);
    }

    /// The columns that the scenario maps.
    fn map(&mut self, mapping: &[(String, String)]) {
        let (sheet, frame) = (self.sheet, self.frame);
        let headers = &sheet.header.cells;
        for (key, wanted) in mapping {
            let Some(column) = column_of(key) else { continue };
            let place_of = |index: usize| sheet.place(&sheet.header, index);
            let wanted = wanted.trim();
            let exact = headers.iter().position(|header| header == wanted);
            let index = exact.or_else(|| headers.iter().position(|header| header.eq_ignore_ascii_case(wanted)));
            let Some(index) = index else {
                let title =
                    format!("the table has no column {}, which [measurement] columns names as {key}", quote(wanted));
                let near = nearest(wanted, headers.iter().map(String::as_str));
                let label =
                    near.map_or("the columns that there are".into(), |near| format!("did you mean {}?", quote(near)));
                let help = format!("write {key} = \"…\" in columns with one of these headers, letter by letter");
                self.complaints.add(&sheet.row_place(&sheet.header), &title, &label, &help);
                self.told[column] = true;
                continue;
            };
            if self.told[column] {
                let title = format!("[measurement] columns names the {} twice", COLUMNS[column]);
                let help = "drive, force and torque are one: name the one that drives the rig";
                self.complaints.add(&place_of(index), &title, &format!("named as {key}"), help);
                continue;
            }
            self.told[column] = true;
            if self.taken[index] {
                let title = format!("[measurement] columns uses {} twice", quote(wanted));
                self.complaints.add(
                    &place_of(index),
                    &title,
                    &format!("named again as {key}"),
                    "name each header once",
                );
                continue;
            }
            self.taken[index] = true;
            if column >= NUMBERS {
                self.words[column - NUMBERS] = Some(index);
                self.notes.push(format!("{} is read as {key}", quote(&headers[index])));
                continue;
            }
            match header::mapped(&sheet.headed(index), key, column, frame) {
                Ok((unit, _)) if !frame.serving(column).contains(&unit.si) => self.unsuited(index, column, unit.si),
                Ok((unit, stated)) => {
                    let read = if stated {
                        format!("in {}", unit.text)
                    } else {
                        format!("in {}, no unit being stated", unit.si)
                    };
                    self.notes.push(format!("{} is read as {key} {read}", quote(&headers[index])));
                    self.notes.extend(other_amplitude(&headers[index], column));
                    self.slots[column] = Some(Slot::Cells(index, unit));
                }
                Err(why) => {
                    let title = format!("the unit of column {} does not serve as {key}", quote(&headers[index]));
                    let si = frame.natural(column).unwrap_or(MEASURED[column].unit);
                    let help = format!("`{key}` is the {}, in units like {si}", MEASURED[column].meaning);
                    self.complaints.add(&place_of(index), &title, &why, &help);
                }
            }
        }
    }
}

/// The column that a key of `[measurement] columns` means.
fn column_of(key: &str) -> Option<usize> {
    match key {
        "force" | "torque" => Some(DRIVE),
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

/// Says that speed and load tell nothing without a contact.
fn without_contact(sheet: &Sheet, frame: &Frame<'_>, slots: &[Option<Slot>; NUMBERS], notes: &mut Vec<String>) {
    if frame.is_free() || frame.has_contact() {
        return;
    }
    let name = |slot: &Option<Slot>| match slot {
        Some(Slot::Cells(index, _)) => Some(quote(&sheet.header.cells[*index])),
        _ => None,
    };
    let names: Vec<String> = [SPEED, LOAD].iter().filter_map(|column| name(&slots[*column])).collect();
    if !names.is_empty() {
        let word = if names.len() == 1 { "tells" } else { "tell" };
        notes.push(format!(
            "{} {word} series apart and nothing else: the scenario has no [contact]",
            names.join(" and ")
        ));
    }
}

/// Says what a voltage is taken for where no sensitivity is stated.
fn without_sensitivity(sheet: &Sheet, frame: &Frame<'_>, slots: &[Option<Slot>; NUMBERS], notes: &mut Vec<String>) {
    for (column, key) in [(DRIVE, "drive_sensitivity"), (AMPLITUDE, "sensitivity")] {
        if let Some(Slot::Cells(index, unit)) = &slots[column]
            && unit.si == "V"
            && frame.lacks_sensitivity(column)
        {
            let header = quote(&sheet.header.cells[*index]);
            let of = if column == DRIVE { "unit of the drive" } else { "unit of the motion" };
            notes.push(format!("{header} is in volts and [instrument] states no `{key}`: 1 V per {of} is assumed"));
        }
    }
}

/// The values that `[sweep]` gives for a column.
fn sweep_values(column: usize, sweep: Option<&Sweep>) -> &[f64] {
    match (column, sweep) {
        (SPEED, Some(sweep)) => &sweep.speed,
        (LOAD, Some(sweep)) => &sweep.load,
        (DRIVE, Some(sweep)) => &sweep.drive,
        _ => &[],
    }
}

/// The one value of `[sweep]` that holds for a whole file.
fn swept(column: usize, frame: &Frame<'_>, sweep: Option<&Sweep>, notes: &mut Vec<String>) -> Option<Slot> {
    let [value] = sweep_values(column, sweep) else { return None };
    let unit = frame.natural(column)?;
    notes.push(format!("the {} of all rows is that of [sweep]: {}", COLUMNS[column], units::format(*value, unit)));
    Some(Slot::Value(*value, unit))
}

/// Load, speed or drive of a file that cannot state it: one value in `[sweep]`, or why that is not so.
pub(crate) fn only_value(
    column: usize,
    frame: &Frame<'_>,
    sweep: Option<&Sweep>,
    notes: &mut Vec<String>,
) -> Result<f64, String> {
    match swept(column, frame, sweep, notes) {
        Some(Slot::Value(value, _)) => Ok(value),
        _ => {
            let found = sweep_values(column, sweep).len();
            Err(if found == 0 { "there is no [sweep]".into() } else { format!("[sweep] lists {found} values") })
        }
    }
}

/// Whether the name of a column says that it holds the whole swing.
fn is_peak_to_peak(name: &str) -> bool {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    words.iter().any(|word| ["pp", "p2p", "ptp", "pkpk"].contains(word) || word.ends_with("plitudepp"))
        || words.windows(2).any(|pair| matches!(pair, ["peak", "to" | "peak"] | ["pk", "pk"] | ["p", "p"]))
}

/// What is said of a mapped drive or reading whose name says that it is no amplitude.
fn other_amplitude(header: &str, column: usize) -> Option<String> {
    let key = match column {
        DRIVE => "drive_gain",
        AMPLITUDE => "amplitude_gain",
        _ => return None,
    };
    // The drive's gain is the true one over the stated one, the reading's the other way round.
    let (what, gain) = match (is_peak_to_peak(header), is_effective(header)) {
        (true, _) => ("peak to peak", if column == DRIVE { "0.5" } else { "2" }),
        (_, true) => ("an effective value", if column == DRIVE { "1.414214" } else { "0.707107" }),
        _ => return None,
    };
    Some(format!("the name of {} says {what}: where it is, state {key} = {gain} in [instrument]", quote(header)))
}

/// Whether the name of a column says that it holds root mean squares.
fn is_effective(name: &str) -> bool {
    let name = name.to_lowercase();
    name.split(|c: char| !c.is_alphanumeric()).any(|word| matches!(word, "rms" | "eff"))
}

/// Tells which columns are needed and not there, all at once.
fn missing(
    sheet: &Sheet,
    frame: &Frame<'_>,
    lacking: &[usize],
    sweep: Option<&Sweep>,
    aside: &[usize],
    complaints: &mut Complaints<'_>,
) {
    let others: Vec<&str> = aside.iter().map(|index| sheet.header.cells[*index].as_str()).collect();
    let near = |column: &usize| {
        let found = nearest(frame.standard(*column), others.iter().copied());
        let found = found.or_else(|| nearest(COLUMNS[*column], others.iter().copied()))?;
        if *column == AMPLITUDE && is_peak_to_peak(found) {
            return Some(format!("is {} peak to peak? The amplitude is half of that", quote(found)));
        }
        if *column == AMPLITUDE && is_effective(found) {
            return Some(format!("is {} an effective value? The amplitude is 1.414 times that", quote(found)));
        }
        Some(format!("is {} the {}?", quote(found), COLUMNS[*column]))
    };
    let near: Vec<String> = lacking.iter().filter_map(near).collect();
    let label = if near.is_empty() { "the columns that there are".to_string() } else { near.join(" ") };
    let join = |list: Vec<String>| list.join(", ");
    let other = match (frame.has_contact(), frame.is_arm()) {
        (_, true) => "speed_mm_s, drive_um, amplitude_urad, …",
        (true, _) => "speed_mm_s, force_mn, amplitude_um, amplitude_v, …",
        _ => "force_mn, drive_g, amplitude_um, amplitude_v, …",
    };
    let standard = join(lacking.iter().map(|column| frame.standard(*column).to_string()).collect());
    let mut help = format!("name columns {standard} (other units: {other})");
    if !frame.is_free() {
        let keys = lacking.iter().map(|column| format!("{} = \"…\"", COLUMNS[*column])).collect();
        help += &format!(", or map those that there are: columns = {{ {} }}", join(keys));
    }
    let fixed: Vec<usize> = lacking.iter().copied().filter(|column| *column <= DRIVE).collect();
    if !fixed.is_empty() && !frame.is_free() {
        let one = |column: &usize| match sweep_values(*column, sweep).len() {
            0 => format!("{} = …", COLUMNS[*column]),
            n => format!("{} = … (it lists {n})", COLUMNS[*column]),
        };
        help += &format!("; one value for all rows may stand in [sweep]: {}", join(fixed.iter().map(one).collect()));
    }
    let names = join(lacking.iter().map(|column| COLUMNS[*column].to_string()).collect());
    let title = format!("the table has no column for {names}");
    complaints.add(&sheet.row_place(&sheet.header), &title, &label, &help);
}

/// Tells which columns are not used, and what they may have been meant to be.
fn name_aside(
    sheet: &Sheet,
    frame: &Frame<'_>,
    slots: &[Option<Slot>; NUMBERS],
    aside: &[usize],
    notes: &mut Vec<String>,
) {
    let harmonic = |index: &&usize| header::meaning(&sheet.headed(**index), frame) == Meaning::Harmonic;
    let (harmonics, aside): (Vec<&usize>, Vec<&usize>) = aside.iter().partition(harmonic);
    if !harmonics.is_empty() {
        let names: Vec<String> = harmonics.iter().map(|index| quote(&sheet.header.cells[**index])).collect();
        notes.push(format!("harmonics are not used yet: {}", names.join(", ")));
    }
    let open = |column: &usize| slots[*column].is_none();
    let free: Vec<&str> = (0..NUMBERS).filter(open).map(|column| frame.standard(column)).collect();
    let name = |index: &usize| {
        let header = &sheet.header.cells[*index];
        match nearest(header, free.iter().copied()) {
            Some(near) => format!("{} (did you mean `{near}`?)", quote(header)),
            None if header.is_empty() => format!("column {} without a name", index + 1),
            None => quote(header),
        }
    };
    if !aside.is_empty() {
        let names: Vec<String> = aside.into_iter().map(name).collect();
        notes.push(format!("not used: {}", names.join(", ")));
    }
}

#[cfg(test)]
mod tests {
    use super::is_peak_to_peak;

    #[test]
    fn the_whole_swing_is_told_from_words_that_merely_look_like_it() {
        for name in [
            "theta_pp_urad",
            "PP [rad]",
            "p2p",
            "peak-to-peak",
            "Angle (peak to peak)",
            "alpha_pk_pk",
            "amplitudePP_urad",
            "amplitude_p-p",
        ] {
            assert!(is_peak_to_peak(name), "{name}");
        }
        for name in ["applied_angle", "stepped", "peak_angle", "amplitude"] {
            assert!(!is_peak_to_peak(name), "{name}");
        }
    }
}
