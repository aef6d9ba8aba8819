//! The table `[gate]`: what has to hold for a run to pass.

use super::diagnostic::{nearest, quote, suggestion};
use super::parameters::{GATE, VERDICTS};
use super::reader::{Reader, Table};
use super::types::Gate;
use super::written::{Entry, Value};
use crate::parameter::ParameterInfo;
use crate::units;

/// Keys of the table that are no numbers.
const WORDS: [&str; 3] = ["verdict", "effects", "claims"];

/// The table, or nothing asked for; `None` where it is not sound. `readings` are the units of what may be read of the
/// rig: which of them is, the measured table says. `effects` are the names of what a discovery may find.
pub(crate) fn gate(
    reader: &mut Reader<'_>,
    entries: &[Entry],
    readings: &[&'static str],
    effects: &[&str],
) -> Option<Gate> {
    if !entries.iter().any(|entry| entry.key == "gate") {
        return Some(Gate::default());
    }
    let table = reader.table(entries, "gate")?;
    let keys: Vec<_> = GATE.iter().map(|info| info.key).chain(WORDS).collect();
    reader.keys(&table, &[], &keys);
    let floor_unit = table.get("amplitude_floor").and_then(|node| match &node.value {
        Value::Text(text) => readings.iter().copied().find(|unit| units::parse(text, unit).is_ok()),
        _ => None,
    });
    let in_unit = |info: &ParameterInfo| match info.key {
        "amplitude_floor" => ParameterInfo { unit: floor_unit.unwrap_or(readings[0]), ..*info },
        _ => *info,
    };
    let numbers: Vec<Option<f64>> = GATE
        .iter()
        .map(|info| table.get(info.key).map_or(Some(None), |node| reader.quantity(node, &in_unit(info)).map(Some)))
        .collect::<Option<_>>()?;
    let gate = Gate {
        max_rms_error: numbers[0],
        max_chi2_per_point: numbers[1],
        amplitude_tolerance: numbers[2],
        amplitude_floor: numbers[3],
        floor_unit,
        phase_tolerance: numbers[4],
        verdict: verdict(reader, &table)?,
        effects: table.get("effects").map(|node| reader.names("effects", node, effects, "an effect of the catalogue")),
        claims: claims(reader, &table),
    };
    sound(reader, &table, entries, (&gate, readings[0]));
    Some(gate)
}

fn verdict(reader: &mut Reader<'_>, table: &Table<'_>) -> Option<Option<String>> {
    let Some(node) = table.get("verdict") else { return Some(None) };
    let text = reader.text("verdict", node)?;
    if VERDICTS.contains(&text.as_str()) {
        return Some(Some(text));
    }
    let label = suggestion(nearest(&text, VERDICTS.iter().copied()), "not a verdict");
    let help = format!("choose from {}", VERDICTS.join(", "));
    reader.fail(&node.place, &format!("{} is not a verdict of a discovery", quote(&text)), &label, &help);
    None
}

/// Ids of claims; whether the ledger has them is for the report, which reads it.
fn claims(reader: &mut Reader<'_>, table: &Table<'_>) -> Vec<String> {
    let Some(node) = table.get("claims") else { return Vec::new() };
    let Value::List(items) = &node.value else {
        let title = format!("`claims` needs a list, not {}", node.value.kind());
        reader.fail(&node.place, &title, "a list is needed", "write the ids in brackets: [\"…\", \"…\"]");
        return Vec::new();
    };
    let mut ids: Vec<String> = Vec::new();
    for item in items {
        let Some(id) = reader.text("claims", item) else { continue };
        if ids.contains(&id) {
            let title = format!("{} appears twice in `claims`", quote(&id));
            reader.fail(&item.place, &title, "named before", "remove one of the two");
        } else {
            ids.push(id);
        }
    }
    ids
}

/// Whether the keys go together with each other and with the rest of the scenario.
fn sound(reader: &mut Reader<'_>, table: &Table<'_>, entries: &[Entry], (gate, reading): (&Gate, &str)) {
    for (key, unit) in [("phase_tolerance", "rad"), ("amplitude_floor", reading)] {
        let Some(node) = table.get(key) else { continue };
        if matches!(&node.value, Value::Text(text) if text.contains('%')) {
            let what = if unit == "rad" { "an angle".into() } else { format!("an amplitude in {unit}") };
            let small = if reading == "rad" { "urad" } else { reading };
            let help = format!("write e.g. \"5 deg\" for a phase, \"1 {small}\" for an amplitude");
            reader.fail(&node.place, &format!("`{key}` is {what}, not a share"), "a percentage of what?", &help);
        }
    }
    let place = |key: &str| {
        table.entries.iter().find(|entry| entry.key == key).map_or(table.place.clone(), |entry| entry.place.clone())
    };
    if gate.needs_measurements() && !entries.iter().any(|entry| entry.key == "measurement") {
        let help = "add [measurement] with file, or keep only `claims` in [gate]";
        reader.fail(&table.place, "[gate] needs measurements to judge", "there is no [measurement]", help);
    }
    let found = gate.verdict.as_deref();
    if gate.effects.as_ref().is_some_and(|names| !names.is_empty())
        && found.is_some_and(|verdict| !["effect-missing", "unexplained"].contains(&verdict))
    {
        let title = format!("`effects` do not go with verdict = \"{}\"", found.unwrap_or_default());
        let help = "such a verdict names no effects; remove one of the two keys";
        reader.fail(&place("effects"), &title, "no effect can be named", help);
    }
}
