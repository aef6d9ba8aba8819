//! Which column of a table is which: by its header, by the scenario's mapping, or from the scenario where it is one value.

use super::header::{self, AMPLITUDE, DRIVE, LOAD, Meaning, SPEED, STANDARD, Unit};
use super::sheet::{Complaints, Sheet};
use crate::scenario::Sweep;
use crate::scenario::diagnostic::{nearest, quote};
use crate::scenario::parameters::{COLUMNS, MEASURED};
use crate::units;

/// Where the numbers of a column come from.
#[derive(Debug, Clone)]
pub(crate) enum Slot {
    /// A column of the table and the unit of its numbers.
    Cells(usize, Unit),
    /// One value for all rows.
    Value(f64),
}

/// The columns of a table in standard order, and the positions of those that are kept aside.
pub(crate) struct Layout {
    /// By position in [`COLUMNS`].
    pub slots: [Option<Slot>; 9],
    /// Columns that are not used.
    pub aside: Vec<usize>,
}

/// Finds the columns; problems are noted at the header.
pub(crate) fn layout(
    sheet: &Sheet,
    mapping: &[(String, String)],
    sweep: Option<&Sweep>,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> Layout {
    let mut slots: [Option<Slot>; 9] = Default::default();
    let mut taken = vec![false; sheet.header.cells.len()];
    map(sheet, mapping, &mut slots, &mut taken, complaints, notes);
    let mapped: Vec<bool> = COLUMNS.iter().map(|key| mapping.iter().any(|(name, _)| name == key)).collect();
    let mut unsuited = Vec::new();
    for (index, header) in sheet.header.cells.iter().enumerate() {
        if taken[index] {
            continue;
        }
        match header::meaning(header) {
            Meaning::Column(column, ..) if mapped[column] => {}
            Meaning::Column(column, unit, stated) => {
                if let Some(Slot::Cells(before, _)) = &slots[column] {
                    let title = format!("two columns hold the {}", MEASURED[column].key.replace('_', " "));
                    let label = format!("so does {}, column {}", quote(&sheet.header.cells[*before]), before + 1);
                    let help = "remove or rename one of the two, or choose with [measurement] columns";
                    let label = sheet.cell_name(&sheet.header, index) + &label;
                    complaints.add(&sheet.place(&sheet.header, index), &title, &label, help);
                } else {
                    if !stated {
                        notes.push(format!("{} states no unit and is read in {}", quote(header), unit.si));
                    }
                    slots[column] = Some(Slot::Cells(index, unit));
                }
                taken[index] = true;
            }
            Meaning::BadUnit(column, why) if !mapped[column] => unsuited.push((index, column, why)),
            _ => {}
        }
    }
    let mut told = mapped;
    for (index, column, why) in unsuited {
        if slots[column].is_none() {
            let title = format!("the unit of column {} does not serve", quote(&sheet.header.cells[index]));
            let label = sheet.cell_name(&sheet.header, index) + &why;
            let help =
                format!("`{}` is the {}; write e.g. {}", COLUMNS[column], MEASURED[column].meaning, STANDARD[column]);
            complaints.add(&sheet.place(&sheet.header, index), &title, &label, &help);
            (taken[index], told[column]) = (true, true);
        }
    }
    let aside: Vec<usize> = (0..taken.len()).filter(|index| !taken[*index]).collect();
    let mut lacking = Vec::new();
    for column in (SPEED..=AMPLITUDE).filter(|column| !told[*column]) {
        if slots[column].is_none() {
            slots[column] = swept(column, sweep, notes);
        }
        if slots[column].is_none() {
            lacking.push(column);
        }
    }
    if !lacking.is_empty() {
        missing(sheet, &lacking, sweep, &aside, complaints);
    }
    name_aside(sheet, &slots, &aside, notes);
    Layout { slots, aside }
}

/// The columns that the scenario maps.
fn map(
    sheet: &Sheet,
    mapping: &[(String, String)],
    slots: &mut [Option<Slot>; 9],
    taken: &mut [bool],
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) {
    let headers = &sheet.header.cells;
    for (key, wanted) in mapping {
        let Some(column) = COLUMNS.iter().position(|name| name == key) else { continue };
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
            complaints.add(&sheet.row_place(&sheet.header), &title, &label, &help);
            continue;
        };
        let place = sheet.place(&sheet.header, index);
        if taken[index] {
            let title = format!("[measurement] columns uses {} twice", quote(wanted));
            complaints.add(&place, &title, &format!("named again as {key}"), "name each header once");
            continue;
        }
        taken[index] = true;
        match header::mapped(&headers[index], column) {
            Ok((unit, stated)) => {
                let read =
                    if stated { format!("in {}", unit.text) } else { format!("in {}, no unit being stated", unit.si) };
                notes.push(format!("{} is read as {key} {read}", quote(&headers[index])));
                slots[column] = Some(Slot::Cells(index, unit));
            }
            Err(why) => {
                let title = format!("the unit of column {} does not serve as {key}", quote(&headers[index]));
                let help =
                    format!("`{key}` is the {}, in units like {}", MEASURED[column].meaning, MEASURED[column].unit);
                complaints.add(&place, &title, &why, &help);
            }
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
fn swept(column: usize, sweep: Option<&Sweep>, notes: &mut Vec<String>) -> Option<Slot> {
    let info = MEASURED[column];
    let [value] = sweep_values(column, sweep) else { return None };
    notes.push(format!("the {} of all rows is that of [sweep]: {}", info.key, units::format(*value, info.unit)));
    Some(Slot::Value(*value))
}

/// Load, speed or drive of a file that cannot state it: one value in `[sweep]`, or why that is not so.
pub(crate) fn only_value(column: usize, sweep: Option<&Sweep>, notes: &mut Vec<String>) -> Result<f64, String> {
    match swept(column, sweep, notes) {
        Some(Slot::Value(value)) => Ok(value),
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

/// Tells which columns are needed and not there, all at once.
fn missing(sheet: &Sheet, lacking: &[usize], sweep: Option<&Sweep>, aside: &[usize], complaints: &mut Complaints<'_>) {
    let others: Vec<&str> = aside.iter().map(|index| sheet.header.cells[*index].as_str()).collect();
    let near = |column: &usize| {
        let found = nearest(STANDARD[*column], others.iter().copied());
        let found = found.or_else(|| nearest(COLUMNS[*column], others.iter().copied()))?;
        if *column == AMPLITUDE && is_peak_to_peak(found) {
            return Some(format!("is {} peak to peak? The amplitude is half of that", quote(found)));
        }
        Some(format!("is {} the {}?", quote(found), COLUMNS[*column]))
    };
    let near: Vec<String> = lacking.iter().filter_map(near).collect();
    let label = if near.is_empty() { "the columns that there are".to_string() } else { near.join(" ") };
    let join = |list: Vec<String>| list.join(", ");
    let mut help = format!(
        "name columns {} (other units: speed_mm_s, drive_um, amplitude_urad, …), or map those that there are: columns = {{ {} }}",
        join(lacking.iter().map(|column| STANDARD[*column].to_string()).collect()),
        join(lacking.iter().map(|column| format!("{} = \"…\"", COLUMNS[*column])).collect()),
    );
    let fixed: Vec<usize> = lacking.iter().copied().filter(|column| *column <= DRIVE).collect();
    if !fixed.is_empty() {
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
fn name_aside(sheet: &Sheet, slots: &[Option<Slot>; 9], aside: &[usize], notes: &mut Vec<String>) {
    let free: Vec<&str> = (0..9).filter(|column| slots[*column].is_none()).map(|column| STANDARD[column]).collect();
    let name = |index: &usize| {
        let header = &sheet.header.cells[*index];
        match nearest(header, free.iter().copied()) {
            Some(near) => format!("{} (did you mean `{near}`?)", quote(header)),
            None if header.is_empty() => format!("column {} without a name", index + 1),
            None => quote(header),
        }
    };
    if !aside.is_empty() {
        let names: Vec<String> = aside.iter().map(name).collect();
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
