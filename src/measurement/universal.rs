//! Universal files (UFF, UNV): frequency response functions of dataset 58, as text or in its binary form.
//!
//! The function is response over reference with the sign exp(+i omega t): its magnitude times the amplitude of the
//! drive is the amplitude of the reading, its argument the phase. Drive, load and speed come from the scenario's
//! `[sweep]`; of an oscillator whose drive is not stated it is one.

mod binary;
mod dataset;

use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

use super::columns::{only_value, sweep_values};
use super::file;
use super::frame::{DRIVES, Frame, READINGS, kind};
use super::mapping::other_rig;
use super::names::{AMPLITUDE, DRIVE, FREQUENCY, LOAD, SPEED};
use super::reading::{Reading, Readings};
use super::sheet::Complaints;
use super::unit::Wanted;
use crate::error::{Error, Result};
use crate::scenario::diagnostic::{MAX_TOLD, Place, quote, whole_file};
use crate::scenario::parameters::{MEASURED, needed_range};
use crate::scenario::source::Source;
use crate::scenario::{Signals, Sweep};
use crate::statistics::wrap;
use crate::units;
use dataset::{Characteristics, Dataset, Value};

/// The text of a file, the numbers of binary datasets written out.
pub(crate) fn source(path: &Path, bytes: &[u8]) -> Result<Source> {
    let written = binary::written_out(&path.display().to_string(), bytes)?;
    file::text(path, &written, &mut Vec::new())
}

/// The number of the function that a file of several is looked at for: the first where response and reference are the
/// same place in the same direction, else the first.
pub(crate) fn record(source: &Source) -> Result<Option<usize>> {
    let found = dataset::functions(source)?;
    let functions: Vec<&Dataset> = found.iter().filter(|set| set.is_response()).collect();
    let own = functions.iter().position(|set| set.response == set.reference);
    Ok((functions.len() > 1).then(|| own.unwrap_or(0) + 1))
}

/// The readings of the one function of a file, or of the one that is chosen.
pub(crate) fn readings(
    source: &Source,
    record: Option<usize>,
    frame: &Frame<'_>,
    sweep: Option<&Sweep>,
    notes: &mut Vec<String>,
) -> Result<Readings> {
    let found = dataset::functions(source)?;
    let chosen = choose(source, &found, record)?;
    let mut complaints = Complaints::of(source);
    // An oscillator is driven by one unit where nothing else is said; the actuator of an arm by what its stroke allows.
    let driven = frame.is_arm() || sweep_values(DRIVE, sweep).len() == 1;
    let conditions = conditions(chosen, frame, sweep, driven, &mut complaints, notes);
    let scale = match frame.is_arm() {
        true => scale(chosen, &mut complaints, notes),
        false => ratio(chosen, frame, driven, &mut complaints, notes),
    };
    let values = chosen.values(source, &mut complaints);
    let (Some(scale), Some(values)) = (scale, values) else {
        complaints.check()?;
        return Err(Error::Input(whole_file(&format!("cannot read `{}`", source.name), "check the dataset")));
    };
    let list = scaled(&values, &scale, conditions, frame, &mut complaints);
    complaints.check()?;
    if values.iter().any(|value| value.abscissa * scale.frequency == 0.0) {
        notes.push("the value at 0 Hz is not used".into());
    }
    if let Some(chosen) = record.filter(|_| frame.is_free()) {
        let all = found.iter().filter(|set| set.is_response()).count();
        notes.push(format!("function {chosen} of {all}; for another change `record` in [measurement]"));
    }
    let signals = scale.signals;
    let (columns, choices) = (Vec::new(), Vec::new());
    Ok(Readings { list, signals, columns, choices, drive_assumed: false, amplitude_stated: false, phase_stated: false })
}

/// Speed, load and drive of a function as the scenario has them: 0 for what a rig without a contact does not need, a
/// drive of 1 unless it is `driven` by a stated one.
fn conditions(
    set: &Dataset,
    frame: &Frame<'_>,
    sweep: Option<&Sweep>,
    driven: bool,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> [f64; 3] {
    let mut conditions = [0.0; 3];
    let needed = [(SPEED, frame.has_contact()), (LOAD, frame.has_contact()), (DRIVE, driven)];
    for (value, (column, _)) in conditions.iter_mut().zip(needed).filter(|(_, (_, needed))| *needed) {
        match only_value(column, frame, sweep, notes) {
            Ok(found) => *value = found,
            Err(why) => {
                let key = MEASURED[column].key;
                let title = format!("a universal file does not state the {key}, and {why}");
                let unit = frame.natural(column).unwrap_or("N");
                let help = format!("write one value, {key} = \"… {unit}\", in [sweep] of the scenario");
                complaints.add(&set.place(), &title, "this function", &help);
            }
        }
    }
    if !driven {
        conditions[DRIVE] = 1.0;
    }
    conditions
}

/// The readings that the values of a function are under these conditions; one at rest is none.
fn scaled(
    values: &[Value],
    scale: &Scale,
    [speed, load, drive]: [f64; 3],
    frame: &Frame<'_>,
    complaints: &mut Complaints<'_>,
) -> Vec<Reading> {
    let reading = |(at, value): (usize, &Value)| {
        let frequency = value.abscissa * scale.frequency;
        if frequency == 0.0 {
            return None;
        }
        // Each derivative of the response is a factor i omega of the function.
        let omega = TAU * frequency;
        let amplitude = value.real.hypot(value.imaginary) * scale.size * omega.powi(-scale.derivatives) * drive;
        let turn = FRAC_PI_2 * f64::from(scale.derivatives);
        let place = Place { file: 0, span: value.span.clone() };
        let mut sound = within(FREQUENCY, frequency, frame, &place, complaints);
        sound &= within(AMPLITUDE, amplitude, frame, &place, complaints);
        sound.then(|| Reading {
            row: at + 1,
            line: value.line,
            speed,
            load,
            drive,
            frequency,
            amplitude,
            phase: Some(wrap(value.imaginary.atan2(value.real) - turn)),
            amplitude_sd: None,
            phase_sd: None,
            mean: None,
            name: String::new(),
            sweep: None,
            series: 0,
            rounding: [0.0; 2],
            aside: String::new(),
        })
    };
    values.iter().enumerate().filter_map(reading).collect()
}

/// Whether a value is within the physical range of its column; what is not is complained about.
fn within(column: usize, value: f64, frame: &Frame<'_>, place: &Place, complaints: &mut Complaints<'_>) -> bool {
    let info = MEASURED[column];
    let inside = (info.minimum..=info.maximum).contains(&value);
    if !inside && !complaints.leaves_out() {
        let title = format!("the {} is outside its physical range: {}", info.key, units::format(value, info.unit));
        let label = needed_range((info.minimum, info.maximum), info.unit);
        let help = if frame.is_arm() {
            "check that the function is the arm's angle in rad over the actuator's displacement in m, and u0 in [sweep]"
        } else {
            "check that the function is what is read over what drives the rig, and drive in [sweep]"
        };
        complaints.add(place, &title, &label, help);
    }
    inside
}

/// The function that is meant.
fn choose<'a>(source: &Source, found: &'a [Dataset], record: Option<usize>) -> Result<&'a Dataset> {
    let functions: Vec<&Dataset> = found.iter().filter(|set| set.is_response()).collect();
    let refuse = |title: String, help: String| Err(Error::Input(whole_file(&title, &help)));
    let list = || {
        let line =
            |(n, set): (usize, &&Dataset)| format!("\n          record = {}: line {}, {}", n + 1, set.line, set.name());
        let more = functions.len().saturating_sub(MAX_TOLD);
        let more = if more > 0 { format!("\n          and {more} more") } else { String::new() };
        functions.iter().enumerate().take(MAX_TOLD).map(line).collect::<String>() + &more
    };
    let name = &source.name;
    match (functions.as_slice(), record) {
        ([], _) if found.is_empty() => refuse(
            format!("`{name}` holds no dataset 58"),
            "export the frequency response function as a universal file, dataset 58".into(),
        ),
        ([], _) => {
            let kinds: Vec<_> =
                found.iter().take(MAX_TOLD).map(|set| format!("line {}: {}", set.line, set.kind())).collect();
            refuse(
                format!("`{name}` holds no frequency response function (function type 4)"),
                format!(
                    "export a response over what drives the rig, against frequency; there are {}",
                    kinds.join("; ")
                ),
            )
        }
        ([one], None) => Ok(one),
        (several, None) => refuse(
            format!("`{name}` holds {} frequency response functions", several.len()),
            format!("choose one in [measurement], one scenario for each:{}", list()),
        ),
        (several, Some(n)) => match several.get(n - 1) {
            Some(one) => Ok(one),
            None => refuse(format!("`{name}` has no record {n}"), format!("choose one of{}", list())),
        },
    }
}

/// How the numbers of the file become SI and a ratio of angle and displacement.
struct Scale {
    /// To Hz.
    frequency: f64,
    /// Of the function, to rad/m and its derivatives.
    size: f64,
    /// Derivatives in time of the response, less those of the reference, that are taken back.
    derivatives: i32,
    /// What drive and reading then are.
    signals: Signals,
}

/// Factor of an abscissa to Hz.
fn hertz(abscissa: &Characteristics, complaints: &mut Complaints<'_>) -> Option<f64> {
    if !matches!(abscissa.kind, 0 | 18) {
        let title = format!("the abscissa has the specific data type {}, not 18 (frequency)", abscissa.kind);
        complaints.add(&abscissa.place(), &title, "not a frequency", "export the function against frequency in Hz");
        return None;
    }
    Some(if abscissa.unit.to_lowercase().contains("rad") { 1.0 / TAU } else { 1.0 })
}

fn scale(set: &Dataset, complaints: &mut Complaints<'_>, notes: &mut Vec<String>) -> Option<Scale> {
    let frequency = hertz(&set.characteristics[0], complaints);
    let response = derivatives(&set.characteristics[1], "response", complaints);
    let reference = derivatives(&set.characteristics[2], "reference", complaints);
    let derivatives = response? - reference?;
    let size = size(&set.characteristics[1], &set.characteristics[2], response?, reference?, complaints, notes)?;
    let over = match derivatives {
        0 => "taken as it is".to_string(),
        n if n > 0 => format!("divided by (i omega)^{n}"),
        n => format!("multiplied by (i omega)^{}", -n),
    };
    notes.push(format!(
        "{}: the function, {over}, is the arm's angle over the actuator's displacement with the sign exp(+i omega t); \
         response {}, reference {}, their directions as they are",
        set.name(),
        set.response,
        set.reference
    ));
    Some(Scale { frequency: frequency?, size, derivatives, signals: Signals::ARM })
}

/// The function of any other rig, of the quantities that the file says; `driven` where the size of its drive is stated.
fn ratio(
    set: &Dataset,
    frame: &Frame<'_>,
    driven: bool,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> Option<Scale> {
    let frequency = hertz(&set.characteristics[0], complaints);
    let response = side(&set.characteristics[1], AMPLITUDE, frame, complaints, notes);
    let reference = side(&set.characteristics[2], DRIVE, frame, complaints, notes);
    let ((reading, above), (drive, below)) = (response?, reference?);
    notes.push(format!(
        "{}: the function is {} over {} with the sign exp(+i omega t); response {}, reference {}, their directions as \
         they are",
        set.name(),
        kind(reading),
        kind(drive),
        set.response,
        set.reference
    ));
    if !driven {
        notes.push(format!(
            "no drive is stated: readings of a drive of 1 {drive}; what depends on its size shows in the shape of a peak alone"
        ));
    }
    // A drive in [sweep] is the motion of the base itself, not its acceleration.
    let natural = frame.natural(DRIVE).filter(|natural| driven && drive == format!("{natural}/s^2"));
    let derivatives = if natural.is_some() { -2 } else { 0 };
    let signals = frame.signals(natural.unwrap_or(drive), reading);
    Some(Scale { frequency: frequency?, size: above / below, derivatives, signals })
}

/// What one side of a function is, in SI, and the size of its unit.
fn side(
    of: &Characteristics,
    column: usize,
    frame: &Frame<'_>,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> Option<(&'static str, f64)> {
    let si = quantity(of, column, frame, complaints)?;
    if !frame.serving(column).contains(&si) {
        let (title, help) = other_rig(frame, column, si);
        let role = role(column);
        complaints.add(&of.place(), &format!("the {role} {title}"), kind(si), &help);
        return None;
    }
    let unit = of.unit.as_str();
    let wanted = Wanted { possible: possible(si), natural: Some(si), share: false, per_drive: false };
    match wanted.unit(unit).map(|unit| unit.convert("1")) {
        Ok(Ok(size)) if !unit.is_empty() => Some((si, size)),
        _ if unit.is_empty() => {
            notes.push(format!("a unit is not stated and taken to be {si}"));
            Some((si, 1.0))
        }
        _ if units::parse(&format!("1 {unit}"), si)
            .is_err_and(|error| matches!(error, units::UnitError::Dimension { .. })) =>
        {
            let title = format!("the unit {} does not serve, one like {si} is needed", quote(unit));
            let help = "check unit and specific data type of the export: they contradict each other";
            complaints.add(&of.place(), &title, "not such a unit", help);
            None
        }
        _ => {
            notes.push(format!("the unit {} is not known and taken to be {si}", quote(unit)));
            Some((si, 1.0))
        }
    }
}

/// What one side of a function is by its specific data type and its unit, as an SI unit.
fn quantity(
    of: &Characteristics,
    column: usize,
    frame: &Frame<'_>,
    complaints: &mut Complaints<'_>,
) -> Option<&'static str> {
    let unit = of.unit.as_str();
    let torque = || units::parse(&format!("1 {unit}"), "N m").is_ok();
    let angle = match frame.is_free() {
        true => unit.contains("rad") || unit.contains("deg") || torque(),
        false => frame.serving(column).iter().any(|si| si.contains("rad") || *si == "N m"),
    };
    let of_unit = || {
        let possible = if column == DRIVE { DRIVES } else { READINGS };
        let wanted = Wanted { possible, natural: None, share: false, per_drive: false };
        wanted.unit(unit).ok().filter(|_| !unit.is_empty()).map(|unit| unit.si)
    };
    Some(match (of.kind, angle) {
        (0 | 1, _) if !frame.is_free() => frame.natural(column)?,
        (0 | 1, _) if of_unit().is_some() => of_unit()?,
        (8, false) => "m",
        (8, true) => "rad",
        (11, false) if column == AMPLITUDE => "m/s",
        (11, true) if column == AMPLITUDE => "rad/s",
        (12, false) => "m/s^2",
        (12, true) => "rad/s^2",
        (9 | 13, false) if column == DRIVE => "N",
        (9 | 13, true) if column == DRIVE => "N m",
        (other, _) => {
            let role = role(column);
            let title = format!("the {role} has the specific data type {other}, which serves for no {role} of the rig");
            let help = "export displacement, velocity or acceleration (8, 11, 12) over force, displacement or acceleration (13, 8, 12)";
            complaints.add(&of.place(), &title, "not such a quantity", help);
            return None;
        }
    })
}

/// What a side of a function is called.
fn role(column: usize) -> &'static str {
    if column == DRIVE { "reference" } else { "response" }
}

/// A unit as the list that it is alone in.
fn possible(si: &'static str) -> &'static [&'static str] {
    DRIVES.iter().chain(READINGS).find(|known| **known == si).map_or(&[], std::slice::from_ref)
}

/// How many times a quantity is differentiated in time.
fn derivatives(of: &Characteristics, role: &str, complaints: &mut Complaints<'_>) -> Option<i32> {
    match of.kind {
        0 | 1 | 8 => Some(0),
        11 => Some(1),
        12 => Some(2),
        kind => {
            let title = format!("the {role} has the specific data type {kind}, not 8, 11 or 12");
            let help = "export the angle of the arm (displacement, velocity or acceleration) over the displacement of the actuator";
            complaints.add(&of.place(), &title, "not displacement, velocity or acceleration", help);
            None
        }
    }
}

/// Size of the function's unit; what cannot be read is taken to be SI and said to be so.
fn size(
    response: &Characteristics,
    reference: &Characteristics,
    of_response: i32,
    of_reference: i32,
    complaints: &mut Complaints<'_>,
    notes: &mut Vec<String>,
) -> Option<f64> {
    let per = |base: &str, times: i32| match times {
        0 => base.to_string(),
        1 => format!("{base}/s"),
        n => format!("{base}/s^{n}"),
    };
    let expected = [per("rad", of_response), per("m", of_reference)];
    let both =
        format!("rad/{}", if of_reference == 0 { "m".to_string() } else { format!("({})", per("m", of_reference)) });
    if of_response == 0 && reference.unit.is_empty() && units::parse(&format!("1 {}", response.unit), &both).is_ok() {
        return units::parse(&format!("1 {}", response.unit), &both).ok();
    }
    let mut sizes = [1.0; 2];
    for ((size, what), expected) in sizes.iter_mut().zip([response, reference]).zip(&expected) {
        let unit = what.unit.as_str();
        match units::parse(&format!("1 {unit}"), expected) {
            Ok(found) => *size = found,
            Err(units::UnitError::Dimension { .. }) => {
                let title = format!("the unit {} does not serve, one like {expected} is needed", quote(unit));
                let help = "the response is an angle in rad; a reading of length has to be divided by its arm before it is exported";
                complaints.add(&what.place(), &title, "not such a unit", help);
                return None;
            }
            Err(_) if unit.is_empty() => notes.push(format!("a unit is not stated and taken to be {expected}")),
            Err(_) => notes.push(format!("the unit {} is not known and taken to be {expected}", quote(unit))),
        }
    }
    Some(sizes[0] / sizes[1])
}
