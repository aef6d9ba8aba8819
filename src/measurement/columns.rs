//! Which column of a table is which: by its header, by the scenario's mapping, or from the scenario where it is one
//! value.

use super::frame::{DRIVES, Frame};
use super::header::{self, Meaning};
use super::likely::{deviates, is_deviation, is_setting};
use super::mapping::{Found, Slot, column_of};
use super::names::{ALIASES, AMPLITUDE, DRIVE, FREQUENCY, LOAD, NAMES, NUMBERS, PHASE, SERIES, SPEED, SWEEP};
use super::parts::Parts;
use super::samples;
use super::search::search;
use super::sheet::{Complaints, Sheet};
use super::swings::{is_effective, is_peak_to_peak};
use super::unit::{Wanted, is_unit};
use crate::scenario::Sweep;
use crate::scenario::diagnostic::{MAX_TOLD, nearest, quote};
use crate::scenario::parameters::COLUMNS;
use crate::units;

/// The columns of a table in standard order, and the positions of those that are kept aside.
#[derive(Default)]
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
    /// The columns of amplitude and phase, where they hold their parts.
    pub parts: Option<Parts>,
    /// Whether nothing states the drive, and one setting is taken for all rows.
    pub drive_assumed: bool,
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
    if is_recording(sheet, mapping, frame, complaints) {
        return Layout::default();
    }
    let Found { mut slots, words, taken, told, choices, parts, tallies } =
        search(sheet, mapping, frame, complaints, notes);
    per_drive(sheet, frame, sweep, &mut slots, notes);
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
    // What else lacks is told without it.
    let filled: Vec<usize> = aside.iter().copied().filter(|index| !tallies[*index].is_zero()).collect();
    let perhaps = perhaps_drive(sheet, frame, &filled, slots[AMPLITUDE].as_ref());
    // One setting is taken for all rows where the rig may be driven by a voltage.
    let may_be_held = frame.serving(DRIVE).contains(&"V") && sweep_values(DRIVE, sweep).is_empty();
    let drive_assumed = lacking.contains(&DRIVE) && may_be_held && perhaps.is_none();
    if drive_assumed {
        lacking.retain(|column| *column != DRIVE);
        slots[DRIVE] = Some(Slot::Value(1.0, "V"));
        notes.push(
            "no drive is stated: that of all rows is taken as one setting, 1 V, of which nothing is known".into(),
        );
    }
    if !lacking.is_empty() {
        missing(sheet, frame, (&lacking, perhaps), sweep, &aside, complaints);
    }
    name_aside(sheet, frame, &slots, &aside, notes);
    without_contact(sheet, frame, &slots, notes);
    without_sensitivity(sheet, frame, &slots, notes);
    let (series, sweep) = (words[SERIES - NUMBERS], words[SWEEP - NUMBERS]);
    Layout { slots, series, sweep, aside, choices, parts, drive_assumed }
}

/// Whether nothing names a frequency or a phase, or most rows leave it empty, and the rows are a recording in time, which
/// is complained about.
fn is_recording(
    sheet: &Sheet,
    mapping: &[(String, String)],
    frame: &Frame<'_>,
    complaints: &mut Complaints<'_>,
) -> bool {
    // A phase by that word has no meaning from sample to sample; a letter such as `phi` may be an angle, a T a time.
    let of_state = |index: usize| match header::meaning(&sheet.headed(index), frame) {
        Meaning::Alias(FREQUENCY, unit, _) if unit.is_of_periods() => {
            !header::plain(&sheet.headed(index)).starts_with('t')
        }
        Meaning::Column(column, ..) | Meaning::Alias(column, ..) | Meaning::Likely(column, _) if column == PHASE => {
            header::plain(&sheet.headed(index)).starts_with("phas")
        }
        Meaning::Column(column, ..)
        | Meaning::Alias(column, ..)
        | Meaning::Likely(column, _)
        | Meaning::BadUnit(column, _) => column == FREQUENCY,
        _ => false,
    };
    let filled = |index: usize| 2 * sheet.rows().filter(|row| !row.cells[index].is_empty()).count() > sheet.count;
    let mapped = mapping.iter().any(|(key, _)| column_of(key) == Some(FREQUENCY));
    !mapped
        && !(0..sheet.header.cells.len()).any(|index| of_state(index) && filled(index))
        && samples::refuse(sheet, complaints)
}

/// The column that may be the drive by its name or its unit, of those that are left and hold numbers; beside a voltage
/// that is read one that is steadier.
fn perhaps_drive(sheet: &Sheet, frame: &Frame<'_>, filled: &[usize], reading: Option<&Slot>) -> Option<usize> {
    let is_steadier = |index: usize| match reading {
        Some(Slot::Cells(reading, unit)) if unit.is_voltage() => sheet.change(index) < sheet.change(*reading),
        _ => true,
    };
    let wanted = Wanted { possible: DRIVES, natural: None, share: false, per_drive: false };
    let may_be = |index: &usize| {
        let (name, bracket) = header::split(&sheet.header.cells[*index]);
        let near = [frame.standard(DRIVE), COLUMNS[DRIVE]].iter().any(|key| nearest(key, [name]).is_some());
        let own = header::plain(name);
        // A drive by its name, in a unit that is not known.
        let is_unread = bracket.is_some_and(|unit| !is_unit(unit));
        let is_named = ALIASES.iter().any(|alias| alias.column == DRIVE && alias.name == own)
            || NAMES.iter().any(|(name, column)| *column == DRIVE && *name == own);
        let is_deviation = deviates(&own) || sheet.names().any(|of| is_deviation(&own, &of));
        near || is_named && is_unread
            || !is_deviation
                && !is_setting(&own)
                && is_steadier(*index)
                && bracket.is_some_and(|unit| wanted.unit(unit).is_ok())
    };
    filled.iter().copied().find(may_be)
}

/// A frequency response function is of one drive, of a size that it does not tell: where nothing states it, it is one.
fn per_drive(
    sheet: &Sheet,
    frame: &Frame<'_>,
    sweep: Option<&Sweep>,
    slots: &mut [Option<Slot>; NUMBERS],
    notes: &mut Vec<String>,
) {
    let Some(Slot::Cells(index, unit)) = &slots[AMPLITUDE] else { return };
    let Some(over) = &unit.over else { return };
    let stated = slots[DRIVE].as_ref().map(Slot::si);
    let other = over.si.zip(stated).is_some_and(|(over, stated)| over != stated);
    if other || stated.is_none() && sweep_values(DRIVE, sweep).len() != 1 {
        let si = over.si.or(frame.natural(DRIVE)).unwrap_or("V");
        let name = |index: usize| quote(&sheet.header.cells[index]);
        let unused = match &slots[DRIVE] {
            Some(Slot::Cells(drive, unit)) => format!("; {}, in {}, is not used", name(*drive), unit.shown()),
            _ => String::new(),
        };
        notes.push(format!(
            "{} is a ratio, and no drive is stated in {si}: readings of a drive of 1 {si}; what depends on its size shows in the shape of a peak alone{unused}",
            name(*index)
        ));
        slots[DRIVE] = Some(Slot::Value(1.0, si));
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
pub(crate) fn sweep_values(column: usize, sweep: Option<&Sweep>) -> &[f64] {
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

/// Tells which columns are needed and not there, all at once.
fn missing(
    sheet: &Sheet,
    frame: &Frame<'_>,
    (lacking, perhaps): (&[usize], Option<usize>),
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
        (_, true) => "speed_mm_s, drive_um, period_s, amplitude_urad, …",
        (true, _) => "speed_mm_s, force_mn, period_s, amplitude_um, amplitude_v, …",
        _ => "force_mn, drive_g, period_s, amplitude_um, amplitude_v, …",
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
    if let Some(index) = perhaps.filter(|_| frame.is_free() && lacking.contains(&DRIVE)) {
        let header = quote(&sheet.header.cells[index]);
        help += &format!(
            "; if {header} is the drive, name it `drive`; if it is not, take it out: one drive is then taken for all rows"
        );
    } else if frame.is_free() && lacking.contains(&DRIVE) {
        help +=
            "; of a drive that was held and not measured, its setting will do: drive_v, the same number in every row";
    }
    let unread = |index: &&usize| header::split(&sheet.headed(**index)).1.is_some_and(|unit| !is_unit(unit));
    let unread: Vec<String> = aside.iter().filter(unread).map(|index| quote(&sheet.header.cells[*index])).collect();
    if !unread.is_empty() {
        help += &format!("; what stands in brackets is no unit that is known: {}", join(unread));
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
        let more = aside.len().saturating_sub(MAX_TOLD);
        let names: Vec<String> = aside.into_iter().take(MAX_TOLD).map(name).collect();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        notes.push(format!("not used: {}{more}", names.join(", ")));
    }
}
