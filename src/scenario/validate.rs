//! From what was written to what is meant: the table of contents of a scenario file.

use super::axes;
use super::diagnostic::{nearest, quote, suggestion};
use super::extends::Document;
use super::parameters::{COLUMNS, CONTACT, INSTRUMENT, RIG};
use super::reader::{Reader, Table};
use super::source::Store;
use super::types::{Contact, EffectSetting, Formulation, Instrument, MeasurementSource, Rig, Scenario, Sweep};
use super::written::{Entry, Node, Value};
use super::{LoadOptions, Role};
use crate::effects::ParameterInfo;
use crate::error::{Error, Result};

const TOP: &[&str] = &[
    "extends",
    "title",
    "description",
    "provenance",
    "figures",
    "rig",
    "contact",
    "instrument",
    "sweep",
    "effect",
    "measurement",
    "fit",
];

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
    reader.known_keys("the scenario", entries, TOP);
    let get = |key: &str| entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node);
    let title = title(reader, get("title"));
    let mut text = |key: &str| get(key).map_or(Some(String::new()), |node| reader.text(key, node));
    let (description, provenance) = (text("description"), text("provenance"));
    let figures = get("figures")
        .map(|node| reader.names("figures", node, options.figure_names, "a figure that can be drawn"))
        .unwrap_or_default();

    let rig = rig(reader, entries);
    let contact = contact(reader, entries);
    let instrument = instrument(reader, entries);
    let table = reader.table(entries, "sweep");
    let sweep: Option<Option<Sweep>> = match &table {
        Some(table) => axes::sweep(reader, table, contact.as_ref()).map(Some),
        None => Some(None),
    };
    let effects = effects(reader, get("effect"), options);
    let measurement = measurement(reader, entries, store);
    let free = free(reader, entries, &effects, options);
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
        rig: rig?,
        contact: contact?,
        instrument: instrument?,
        sweep: sweep?,
        effects,
        measurement: measurement?,
        free,
        figures,
    })
}

fn title(reader: &mut Reader<'_>, node: Option<&Node>) -> Option<String> {
    let help = "write one line that says what is shown: title = \"…\"";
    let Some(node) = node else {
        reader.fail(&reader.top(), "the scenario has no `title`", "add a title at the top of this file", help);
        return None;
    };
    let text = reader.text("title", node)?;
    if text.trim().is_empty() || text.chars().count() > 200 || text.chars().any(char::is_control) {
        reader.fail(&node.place, "`title` needs one line of 1 to 200 characters", "not such a line", help);
        return None;
    }
    Some(text)
}

/// Reads the numbers of a table in the order of `infos`; `default` where a key may be absent.
fn numbers<const N: usize>(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    infos: &[ParameterInfo],
    default: Option<f64>,
) -> Option<[f64; N]> {
    if default.is_none() {
        let needed: Vec<_> = infos.iter().map(|info| (info.key, info.unit)).collect();
        reader.needed_keys(table, &needed);
    }
    let values: Vec<_> =
        infos.iter().map(|info| table.get(info.key).map_or(default, |node| reader.quantity(node, info))).collect();
    values.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
}

/// A table that has to be there.
fn needed<'a>(reader: &mut Reader<'_>, entries: &'a [Entry], key: &str, infos: &[ParameterInfo]) -> Option<Table<'a>> {
    if !entries.iter().any(|entry| entry.key == key) {
        let keys: Vec<_> = infos.iter().map(|info| format!("{} ({})", info.key, info.unit)).collect();
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
    reader.known_keys(&table.name, table.entries, &keys(RIG));
    let [inertia, torsional_stiffness, torsional_damping, spring_stiffness, spring_damping, spring_arm, contact_arm] =
        numbers(reader, &table, RIG, None)?;
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
    reader.known_keys(&table.name, table.entries, &[keys(CONTACT), vec!["formulation"]].concat());
    let values = numbers(reader, &table, CONTACT, None);
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
    reader.known_keys(&table.name, table.entries, &keys(INSTRUMENT));
    let default = Instrument::default();
    let mut read = |at: usize, default: f64| -> Option<f64> {
        table.get(INSTRUMENT[at].key).map_or(Some(default), |node| reader.quantity(node, &INSTRUMENT[at]))
    };
    let (drive_gain, amplitude_gain) = (read(0, default.drive_gain), read(1, default.amplitude_gain));
    let phase_offset = read(2, default.phase_offset);
    Some(Instrument { drive_gain: drive_gain?, amplitude_gain: amplitude_gain?, phase_offset: phase_offset? })
}

fn keys(infos: &[ParameterInfo]) -> Vec<&'static str> {
    infos.iter().map(|info| info.key).collect()
}

fn effects(reader: &mut Reader<'_>, node: Option<&Node>, options: &LoadOptions<'_>) -> Vec<EffectSetting> {
    let Some(node) = node else { return Vec::new() };
    let help = "write a line [[effect]], double brackets, with name = \"…\" and its parameters below it";
    let Value::List(items) = &node.value else {
        let title = format!("`effect` needs to be a list of tables, not {}", node.value.kind());
        reader.fail(&node.place, &title, "use [[effect]]", help);
        return Vec::new();
    };
    let mut list: Vec<EffectSetting> = Vec::new();
    for item in items {
        let Value::Table(entries) = &item.value else {
            reader.fail(&item.place, "an effect needs to be a table", "not a table", help);
            continue;
        };
        let table = Table { name: "[[effect]]".into(), place: item.place.clone(), entries };
        let Some(setting) = effect(reader, &table, options) else { continue };
        if list.iter().any(|other| other.name == setting.name) {
            let title = format!("the effect `{}` appears twice", setting.name);
            reader.fail(&item.place, &title, "appeared before", "remove one of the two");
        } else {
            list.push(setting);
        }
    }
    list
}

fn effect(reader: &mut Reader<'_>, table: &Table<'_>, options: &LoadOptions<'_>) -> Option<EffectSetting> {
    let Some(node) = table.get("name") else {
        reader.needed_keys(table, &[("name", "text")]);
        return None;
    };
    let name = reader.text("name", node)?;
    let Some(effect) = options.effects.iter().find(|effect| effect.name() == name) else {
        let known: Vec<_> = options.effects.iter().map(|effect| effect.name()).collect();
        let label = suggestion(nearest(&name, known.iter().copied()), "not in the catalogue");
        let help = format!("`stickslip effects` lists the catalogue: {}", known.join(", "));
        reader.fail(&node.place, &format!("unknown effect {}", quote(&name)), &label, &help);
        return None;
    };
    let infos = effect.parameters();
    let table = Table { name: format!("the effect `{name}`"), place: node.place.clone(), entries: table.entries };
    reader.known_keys(&table.name, table.entries, &[vec!["name"], keys(infos)].concat());
    let needed: Vec<_> = infos.iter().map(|info| (info.key, info.unit)).collect();
    reader.needed_keys(&table, &needed);
    let values: Vec<_> =
        infos.iter().map(|info| table.get(info.key).and_then(|node| reader.quantity(node, info))).collect();
    Some(EffectSetting { name, parameters: values.into_iter().collect::<Option<_>>()? })
}

fn measurement(reader: &mut Reader<'_>, entries: &[Entry], store: Store) -> Option<Option<MeasurementSource>> {
    if !entries.iter().any(|entry| entry.key == "measurement") {
        return Some(None);
    }
    let table = reader.table(entries, "measurement")?;
    reader.known_keys(&table.name, table.entries, &["file", "columns"]);
    let Some(node) = table.get("file") else {
        reader.needed_keys(&table, &[("file", "text")]);
        return None;
    };
    let name = reader.text("file", node)?;
    let folder = reader.source(&node.place).path.parent().unwrap_or(std::path::Path::new("")).to_path_buf();
    let file = folder.join(&name);
    if name.is_empty() || store == Store::Disk && !file.is_file() {
        let title = format!("there is no measurement table {}", quote(&name));
        let help = "the path is relative to the file that contains it; check its spelling";
        reader.fail(&node.place, &title, "no such file", help);
        return None;
    }
    let columns = match table.get("columns") {
        Some(node) => columns(reader, node)?,
        None => Vec::new(),
    };
    Some(Some(MeasurementSource { file, columns }))
}

fn columns(reader: &mut Reader<'_>, node: &Node) -> Option<Vec<(String, String)>> {
    let Value::Table(entries) = &node.value else {
        let title = format!("`columns` needs to be a table, not {}", node.value.kind());
        let help = "write e.g. columns = { frequency = \"f [Hz]\" }";
        reader.fail(&node.place, &title, "a table is needed", help);
        return None;
    };
    reader.known_keys("`columns`", entries, COLUMNS);
    let pairs = entries.iter().map(|entry| reader.text(&entry.key, &entry.node).map(|text| (entry.key.clone(), text)));
    pairs.collect()
}

/// `[fit] free`, each the key of a parameter that this scenario has.
fn free(
    reader: &mut Reader<'_>,
    entries: &[Entry],
    effects: &[EffectSetting],
    options: &LoadOptions<'_>,
) -> Vec<String> {
    let Some(table) = reader.table(entries, "fit") else { return Vec::new() };
    reader.known_keys(&table.name, table.entries, &["free"]);
    let Some(node) = table.get("free") else {
        reader.needed_keys(&table, &[("free", "text")]);
        return Vec::new();
    };
    let present = |name: &str| effects.iter().any(|setting| setting.name == name);
    let present: Vec<_> = options.effects.iter().filter(|effect| present(effect.name())).copied().collect();
    let known = parameter_keys(&present);
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    reader.names("free", node, &known, "a parameter of this scenario")
}

/// Keys of all parameters that a calibration may move: of the rig, the contact, the instrument, and of `effects`.
pub fn parameter_keys(effects: &[&dyn crate::effects::Effect]) -> Vec<String> {
    let base = [("rig", RIG), ("contact", CONTACT), ("instrument", INSTRUMENT)];
    let base = base.iter().flat_map(|(table, infos)| infos.iter().map(move |info| format!("{table}.{}", info.key)));
    let added = effects.iter().flat_map(|effect| {
        effect.parameters().iter().map(move |info| format!("effect.{}.{}", effect.name(), info.key))
    });
    base.chain(added).collect()
}
