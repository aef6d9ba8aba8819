//! From what was written to what is meant: the table of contents of a scenario file.

use std::collections::BTreeMap;

use super::additions::{effects, fits_formulation, free, measurement};
use super::axes;
use super::extends::Document;
use super::gate::gate;
use super::parameters::{CONTACT, INSTRUMENT, RIG};
use super::question::question;
use super::reader::{Reader, TOP_LEVEL, Table, WHOLE};
use super::source::Store;
use super::types::{Contact, Formulation, Instrument, Rig, Scenario, Sweep};
use super::written::{Entry, Node, inside};
use super::{LoadOptions, Role};
use crate::effects::ParameterInfo;
use crate::error::{Error, Result};

/// Validates a document; all its problems are told at once.
pub(crate) fn scenario(
    document: &Document,
    id: String,
    store: Store,
    options: &LoadOptions<'_>,
    role: Role,
) -> Result<Scenario> {
    let mut reader = Reader::new(&document.sources);
    let meant = read(&mut reader, document, id, store, options, role);
    match (reader.into_message(), meant) {
        (None, Some(scenario)) => Ok(scenario),
        (Some(message), _) => Err(Error::Input(message)),
        (None, None) => Err(Error::Input(
            "error: the scenario is incomplete\n  = help: compare it with the file that `stickslip init` writes".into(),
        )),
    }
}

fn read(
    reader: &mut Reader<'_>,
    document: &Document,
    id: String,
    store: Store,
    options: &LoadOptions<'_>,
    role: Role,
) -> Option<Scenario> {
    let entries = document.entries.as_slice();
    let whole = Table { name: WHOLE.into(), place: reader.top(), entries };
    let optional: Vec<&str> = TOP_LEVEL.iter().copied().filter(|key| *key != "title").collect();
    reader.keys(&whole, &[("title", "text")], &optional);
    let get = |key: &str| entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node);
    let title = get("title").and_then(|node| title(reader, node));
    let mut text = |key: &str| {
        let text = get(key).map_or(Some(String::new()), |node| reader.text(key, node))?;
        Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
    };
    let (description, provenance) = (text("description"), text("provenance"));
    let figures =
        get("figures").map(|node| reader.names("figures", node, options.figure_names, "a figure that can be drawn"));

    let rig = rig(reader, entries);
    let contact = contact(reader, entries);
    let instrument = instrument(reader, entries);
    let table = reader.table(entries, "sweep");
    let sweep: Option<Option<Sweep>> = match &table {
        Some(table) => axes::sweep(reader, table, contact.as_ref()).map(Some),
        None => Some(None),
    };
    let effects = effects(reader, get("effect"), options);
    let swept = sweep.iter().flatten().any(|sweep| sweep.formulation.contains(&Formulation::Paper));
    let paper = match sweep {
        Some(Some(_)) => swept,
        _ => contact.is_some_and(|contact| contact.formulation == Formulation::Paper),
    };
    fits_formulation(reader, get("effect"), &effects, paper, options);
    let measurement = measurement(reader, entries, store);
    let question = question(reader, entries, sweep.as_ref().and_then(Option::as_ref));
    let free = free(reader, entries, &effects, options);
    let gate = gate(reader, entries, options);
    if get("sweep").is_none() && get("measurement").is_none() && role == Role::Complete {
        let help = "add [sweep] with frequency, speed, load and drive, or [measurement] with file; \
                    a file with neither can only be extended by others";
        reader.fail(&reader.top(), "the scenario has neither [sweep] nor [measurement]", "nothing to solve", help);
    }
    let path = document.sources.first()?.path.clone();
    Some(Scenario {
        id,
        path,
        hash: document.hash.clone(),
        title: title?,
        description: description?,
        provenance: provenance?,
        origins: origins(document),
        rig: rig?,
        contact: contact?,
        instrument: instrument?,
        sweep: sweep?,
        effects,
        measurement: measurement?,
        question: question?,
        free,
        figures,
        gate: gate?,
    })
}

/// Origins of the numbers of rig, contact and instrument that stand in another file than the first.
fn origins(document: &Document) -> BTreeMap<String, String> {
    let mut origins = BTreeMap::new();
    for table in document.entries.iter().filter(|table| ["rig", "contact", "instrument"].contains(&table.key.as_str()))
    {
        for entry in inside(&table.node).iter().filter(|entry| entry.node.place.file > 0) {
            if let Some(origin) = document.provenances.get(entry.node.place.file).filter(|origin| !origin.is_empty()) {
                origins.insert(format!("{}.{}", table.key, entry.key), origin.clone());
            }
        }
    }
    origins
}

fn title(reader: &mut Reader<'_>, node: &Node) -> Option<String> {
    let help = "write one line that says what is shown: title = \"…\"";
    let text = reader.text("title", node)?;
    if text.trim().is_empty() || text.chars().count() > 200 || text.chars().any(char::is_control) {
        reader.fail(&node.place, "`title` needs one line of 1 to 200 characters", "not such a line", help);
        return None;
    }
    Some(text)
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

/// Keys with their units.
pub(crate) fn units(infos: &[ParameterInfo]) -> Vec<(&'static str, &'static str)> {
    infos.iter().map(|info| (info.key, info.unit)).collect()
}

/// A table that has to be there.
fn needed<'a>(reader: &mut Reader<'_>, entries: &'a [Entry], key: &str, infos: &[ParameterInfo]) -> Option<Table<'a>> {
    if !entries.iter().any(|entry| entry.key == key) {
        let name = |(key, unit)| if unit == "1" { String::from(key) } else { format!("{key} ({unit})") };
        let keys: Vec<_> = units(infos).into_iter().map(name).collect();
        let help = format!("no value is assumed; add [{key}] with {}, or extend a file that has it", keys.join(", "));
        reader.fail(
            &reader.top(),
            &format!("the table [{key}] is missing"),
            "neither here nor in a file it extends",
            &help,
        );
    }
    reader.table(entries, key)
}

fn rig(reader: &mut Reader<'_>, entries: &[Entry]) -> Option<Rig> {
    let table = needed(reader, entries, "rig", RIG)?;
    let [inertia, torsional_stiffness, torsional_damping, spring_stiffness, spring_damping, spring_arm, contact_arm] =
        numbers(reader, &table, RIG, &[])?;
    Some(Rig {
        inertia,
        torsional_stiffness,
        torsional_damping,
        spring_stiffness,
        spring_damping,
        spring_arm,
        contact_arm,
    })
}

fn contact(reader: &mut Reader<'_>, entries: &[Entry]) -> Option<Contact> {
    let table = needed(reader, entries, "contact", CONTACT)?;
    let values = numbers(reader, &table, CONTACT, &["formulation"]);
    let formulation = match table.get("formulation") {
        Some(node) => axes::formulation(reader, node)?,
        None => Formulation::Series,
    };
    let [stiffness, damping, friction] = values?;
    Some(Contact { stiffness, damping, friction, formulation })
}

fn instrument(reader: &mut Reader<'_>, entries: &[Entry]) -> Option<Instrument> {
    if !entries.iter().any(|entry| entry.key == "instrument") {
        return Some(Instrument::default());
    }
    let table = reader.table(entries, "instrument")?;
    let keys: Vec<_> = INSTRUMENT.iter().map(|info| info.key).collect();
    reader.keys(&table, &[], &keys);
    let default = Instrument::default();
    let mut read = |at: usize, default: f64| -> Option<f64> {
        table.get(INSTRUMENT[at].key).map_or(Some(default), |node| reader.quantity(node, &INSTRUMENT[at]))
    };
    let (drive_gain, amplitude_gain) = (read(0, default.drive_gain), read(1, default.amplitude_gain));
    let phase_offset = read(2, default.phase_offset);
    Some(Instrument { drive_gain: drive_gain?, amplitude_gain: amplitude_gain?, phase_offset: phase_offset? })
}
