//! The tables `[rig]`, `[contact]` and `[instrument]`.

use super::axes;
use super::diagnostic::{nearest, quote, suggestion};
use super::parameters::{CONTACT, DRIVE_SENSITIVITY, INSTRUMENT, OSCILLATOR_WORDS, RIG, SENSITIVITY, oscillator};
use super::reader::{Reader, Table, units};
use super::rig::{Dissipation, Elasticity, Excitation, Oscillator, Rig, Signal, TorsionalArm};
use super::types::{Contact, Formulation, Instrument};
use super::written::{Entry, Value, inside};
use crate::parameter::Coordinate;
use crate::parameter::ParameterInfo;
use crate::units;

/// Kinds of rigs.
const KINDS: [&str; 2] = ["torsional-arm", "oscillator"];

/// The table `[rig]`.
pub(crate) fn rig(reader: &mut Reader<'_>, entries: &[Entry]) -> Option<Rig> {
    if !entries.iter().any(|entry| entry.key == "rig") {
        let keys: Vec<_> = RIG.iter().map(|info| format!("{} ({})", info.key, info.unit)).collect();
        let help = format!(
            "no value is assumed; add [rig] with {}; or kind = \"oscillator\" with natural_frequency and quality_factor; \
             or extend a file that has it",
            keys.join(", ")
        );
        reader.fail(&reader.top(), "the table [rig] is missing", "neither here nor in a file it extends", &help);
    }
    let table = reader.table(entries, "rig")?;
    match word(reader, &table, "kind", &KINDS)?.unwrap_or(0) {
        0 => arm(reader, &table).map(Rig::TorsionalArm),
        _ => mode(reader, &table, entries).map(Rig::Oscillator),
    }
}

/// Whether the table `[rig]`, sound or not, is meant to be that of the paper's kind.
pub(crate) fn means_arm(entries: &[Entry]) -> bool {
    let rig = entries.iter().find(|entry| entry.key == "rig").map(|entry| inside(&entry.node));
    let kind = rig.and_then(|keys| keys.iter().find(|entry| entry.key == "kind"));
    kind.is_none_or(|entry| matches!(&entry.node.value, Value::Text(kind) if kind == KINDS[0]))
}

/// Which of `known` a key names; the inner option tells whether it is there.
fn word(reader: &mut Reader<'_>, table: &Table<'_>, key: &str, known: &[&str]) -> Option<Option<usize>> {
    let Some(node) = table.get(key) else { return Some(None) };
    let text = reader.text(key, node)?;
    if let Some(at) = known.iter().position(|word| *word == text) {
        return Some(Some(at));
    }
    let label = suggestion(nearest(&text, known.iter().copied()), "none of these words");
    let help =
        format!("`{key}` is {}", known.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or "));
    reader.fail(&node.place, &format!("unknown {key} {}", quote(&text)), &label, &help);
    None
}

fn arm(reader: &mut Reader<'_>, table: &Table<'_>) -> Option<TorsionalArm> {
    let [inertia, torsional_stiffness, torsional_damping, spring_stiffness, spring_damping, spring_arm, contact_arm] =
        numbers(reader, table, RIG, &["kind"])?;
    Some(TorsionalArm {
        inertia,
        torsional_stiffness,
        torsional_damping,
        spring_stiffness,
        spring_damping,
        spring_arm,
        contact_arm,
    })
}

/// Reads the numbers of a table in the order of `infos`, all of them needed.
fn numbers<const N: usize>(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    infos: &[ParameterInfo],
    optional: &[&str],
) -> Option<[f64; N]> {
    reader.keys(table, &units(infos), optional);
    let values: Vec<_> =
        infos.iter().map(|info| table.get(info.key).and_then(|node| reader.quantity(node, info))).collect();
    values.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
}

/// A rig of kind `oscillator`.
fn mode(reader: &mut Reader<'_>, table: &Table<'_>, entries: &[Entry]) -> Option<Oscillator> {
    let [coordinate, drive, reading] = [0, 1, 2].map(|at| {
        let (key, known) = OSCILLATOR_WORDS[at];
        word(reader, table, key, known).map(|found| found.unwrap_or(0))
    });
    let coordinate = if coordinate? == 0 { Coordinate::Displacement } else { Coordinate::Angle };
    let excitation = [Excitation::Force, Excitation::Base, Excitation::Spring][drive?];
    let absolute = reading? == 1;
    let infos = oscillator(coordinate);
    let words: Vec<&str> = OSCILLATOR_WORDS.iter().map(|(key, _)| *key).chain(["kind"]).collect();
    let known: Vec<&str> = infos.iter().map(|info| info.key).chain(words).collect();
    reader.keys(table, &[], &known);
    if absolute && excitation != Excitation::Base {
        let help = "only the reading of a base-driven rig can be relative to the base or absolute; remove the key";
        return misplaced(reader, table, "reading", ["drive = \"base\"", "not driven by its base", help]);
    }
    let mut stated = |keys: &[&str], needed: bool| stated(reader, table, infos, keys, needed);
    let mass = stated(&[if coordinate == Coordinate::Angle { "inertia" } else { "mass" }], false);
    let elasticity = stated(&["natural_frequency", "stiffness"], true);
    let dissipation = stated(&["quality_factor", "damping_ratio", "damping"], true);
    let spring = excitation == Excitation::Spring;
    let (stiffness, dashpot) = (stated(&["spring_stiffness"], spring), stated(&["spring_damping"], false));
    let (factor, participation) = (stated(&["contact_factor"], false), stated(&["participation"], false));
    let (mass, elasticity, dissipation) = (mass?, elasticity??, dissipation??);
    let (stiffness, dashpot, factor, participation) = (stiffness?, dashpot?, factor?, participation?);
    if participation.is_some() && !absolute {
        let help = "remove it: of a reading relative to the base it is the amplitude_gain of [instrument]";
        return misplaced(reader, table, "participation", ["reading = \"absolute\"", "not read in space", help]);
    }
    if !spring && (stiffness.is_some() || dashpot.is_some()) {
        let key = if stiffness.is_some() { "spring_stiffness" } else { "spring_damping" };
        let help = "remove it, or say that the rig is driven through the spring: drive = \"spring\"";
        return misplaced(reader, table, key, ["drive = \"spring\"", "not driven through a spring", help]);
    }
    let contact = entries.iter().any(|entry| entry.key == "contact");
    if factor.is_some() && !contact {
        let help = "remove it, or add the table [contact]";
        return misplaced(reader, table, "contact_factor", ["a rig with a [contact]", "there is no contact", help]);
    }
    let of = |found: Option<(usize, f64)>, default: f64| found.map_or(default, |(_, value)| value);
    Some(Oscillator {
        coordinate,
        excitation,
        absolute,
        mass: of(mass, 1.0),
        mass_stated: mass.is_some(),
        elasticity: elasticity.1,
        elasticity_form: [Elasticity::NaturalFrequency, Elasticity::Stiffness][elasticity.0],
        dissipation: dissipation.1,
        dissipation_form: [Dissipation::QualityFactor, Dissipation::DampingRatio, Dissipation::Damping][dissipation.0],
        spring_stiffness: of(stiffness, 0.0),
        spring_damping: of(dashpot, 0.0),
        contact_factor: of(factor, if contact { 1.0 } else { 0.0 }),
        participation: of(participation, 1.0),
    })
}

/// The number of a rig that is stated under one of some keys, and under which of them; the inner option tells whether
/// it is there.
fn stated(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    infos: &[ParameterInfo],
    keys: &[&str],
    needed: bool,
) -> Option<Option<(usize, f64)>> {
    let found: Vec<usize> = (0..keys.len()).filter(|&at| table.get(keys[at]).is_some()).collect();
    let list = |keys: &[&str], word: &str| keys.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(word);
    match found[..] {
        [] if needed => {
            let title = format!("[rig] lacks {}", list(keys, " or "));
            let help = format!("no value is assumed; add one of them, e.g. {} = {}", keys[0], example(infos, keys[0]));
            reader.fail(&table.place, &title, "missing in this table", &help);
            None
        }
        [] => Some(None),
        [at] => {
            let info = infos.iter().find(|info| info.key == keys[at])?;
            reader.quantity(table.get(keys[at])?, info).map(|value| Some((at, value)))
        }
        [_, second, ..] => {
            let place = table.get(keys[second])?.place.clone();
            let both = list(&found.iter().map(|at| keys[*at]).collect::<Vec<_>>(), " and ");
            let label = "the same in another form";
            reader.fail(&place, &format!("[rig] states {both} together"), label, "keep one of them");
            None
        }
    }
}

/// Says that a key belongs to another kind of rig, why this is none, and what to do.
fn misplaced<T>(reader: &mut Reader<'_>, table: &Table<'_>, key: &str, [of, why, help]: [&str; 3]) -> Option<T> {
    let place = table.get(key).map_or(table.place.clone(), |node| node.place.clone());
    reader.fail(&place, &format!("`{key}` belongs to {of}"), why, help);
    None
}

fn example(infos: &[ParameterInfo], key: &str) -> String {
    let unit = infos.iter().find(|info| info.key == key).map_or("1", |info| info.unit);
    if unit == "1" { "100".into() } else { format!("\"80 {unit}\"") }
}

/// The table `[contact]`; the outer option tells whether it is sound, the inner one whether it is there.
pub(crate) fn contact(reader: &mut Reader<'_>, entries: &[Entry], needed: bool) -> Option<Option<Contact>> {
    if !entries.iter().any(|entry| entry.key == "contact") {
        if needed {
            let keys: Vec<_> = CONTACT
                .iter()
                .map(|info| if info.unit == "1" { info.key.into() } else { format!("{} ({})", info.key, info.unit) })
                .collect();
            let help =
                format!("no value is assumed; add [contact] with {}, or extend a file that has it", keys.join(", "));
            reader.fail(
                &reader.top(),
                "the table [contact] is missing",
                "neither here nor in a file it extends",
                &help,
            );
            return None;
        }
        return Some(None);
    }
    let table = reader.table(entries, "contact")?;
    let values = numbers(reader, &table, CONTACT, &["formulation"]);
    let formulation = match table.get("formulation") {
        Some(node) => axes::formulation(reader, node)?,
        None => Formulation::Series,
    };
    let [stiffness, damping, friction] = values?;
    Some(Some(Contact { stiffness, damping, friction, formulation }))
}

/// The table `[instrument]`, and the signals that its sensitivities make of those of the rig.
pub(crate) fn instrument(reader: &mut Reader<'_>, entries: &[Entry], rig: Option<&Rig>) -> Option<Instrument> {
    if !entries.iter().any(|entry| entry.key == "instrument") {
        return Some(Instrument::default());
    }
    let table = reader.table(entries, "instrument")?;
    let keys: Vec<_> = INSTRUMENT.iter().map(|info| info.key).chain(["drive_sensitivity", "sensitivity"]).collect();
    reader.keys(&table, &[], &keys);
    let default = Instrument::default();
    let mut read = |at: usize, default: f64| -> Option<f64> {
        table.get(INSTRUMENT[at].key).map_or(Some(default), |node| reader.quantity(node, &INSTRUMENT[at]))
    };
    let (drive_gain, amplitude_gain) = (read(0, default.drive_gain), read(1, default.amplitude_gain));
    let phase_offset = read(2, default.phase_offset);
    // Where the rig could not be read, any.
    let driven = |unit: &str| {
        rig.is_none_or(|rig| match rig.signals().drive.unit {
            "N m" => unit == "V/(N m)",
            own => unit.ends_with(&format!("/{own}")),
        })
    };
    let turns = rig.map(|rig| rig.coordinate() == Coordinate::Angle);
    let read = |unit: &str| turns.is_none_or(|turns| unit.ends_with("rad") == turns);
    let drive = sensitivity(reader, &table, ("drive_sensitivity", "drive_gain"), DRIVE_SENSITIVITY, driven)?;
    let reading = sensitivity(reader, &table, ("sensitivity", "amplitude_gain"), SENSITIVITY, read)?;
    Some(Instrument {
        drive_gain: drive.map_or(drive_gain?, |(_, value)| value),
        amplitude_gain: reading.map_or(amplitude_gain?, |(_, value)| value),
        phase_offset: phase_offset?,
        drive_sensitivity: drive.map(|(at, _)| at),
        sensitivity: reading.map(|(at, _)| at),
    })
}

/// A sensitivity in one of several units that are `possible` with the rig, in place of a `gain`; a bare number is in
/// the first of them.
fn sensitivity(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    (key, gain): (&str, &str),
    forms: &[ParameterInfo],
    possible: impl Fn(&str) -> bool,
) -> Option<Option<(usize, f64)>> {
    let Some(node) = table.get(key) else { return Some(None) };
    if let Some(other) = table.get(gain) {
        let title = format!("`{gain}` and `{key}` scale the same reading");
        reader.fail(&other.place, &title, "two numbers that no data can tell apart", "keep one of the two");
        return None;
    }
    let fitting: Vec<usize> = (0..forms.len()).filter(|&at| possible(forms[at].unit)).collect();
    let first = fitting.first().copied().unwrap_or(0);
    if let Value::Text(text) = &node.value {
        let dimension = |&at: &usize| units::parse(text, forms[at].unit).is_ok();
        if let Some(at) = fitting.iter().copied().find(dimension) {
            return reader.quantity(node, &forms[at]).map(|value| Some((at, value)));
        }
        let list = fitting.iter().map(|&at| forms[at].unit).collect::<Vec<_>>().join(", ");
        let why = units::parse(text, forms[first].unit).err().map_or(String::new(), |error| error.to_string());
        let help = format!("of this rig `{key}` is the {}, in one of {list}", forms[first].meaning);
        reader.fail(&node.place, &format!("cannot read `{key}`"), &why, &help);
        return None;
    }
    reader.quantity(node, &forms[first]).map(|value| Some((first, value)))
}

/// The voltage signals that stand in place of those of the rig where a sensitivity is stated.
pub(crate) fn signals(rig: &Rig, instrument: &Instrument) -> super::rig::Signals {
    let mut signals = rig.signals();
    if let Some(at) = instrument.drive_sensitivity {
        signals.drive =
            Signal { order: if DRIVE_SENSITIVITY[at].unit.contains("s^2") { 2 } else { 0 }, ..Signal::DRIVE_VOLTAGE };
    }
    if let Some(at) = instrument.sensitivity {
        signals.reading = Signal { order: (at % 3) as u8, ..Signal::VOLTAGE };
    }
    signals
}
