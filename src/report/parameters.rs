//! Every number of a scenario as a row: symbol, meaning, value with unit, origin.

use super::format;
use super::glossary::meaning;
use super::view::ParameterView;
use crate::effects::ParameterInfo;
use crate::model::{Model, Operation};
use crate::scenario::{Coordinate, EffectSetting, Formulation, Scenario, Sweep};

/// All parameters of the scenario: rig, contact, instrument, effects, sweep.
pub fn parameters(scenario: &Scenario) -> Vec<ParameterView> {
    let (model, mut at) =
        (Model::new(scenario), Operation { speed: 0.0, load: 0.0, drive: 0.0, frequency: 0.0, series: 0 });
    let source = |key: &str| scenario.origins.get(key).unwrap_or(&scenario.provenance).clone();
    let number = |key: &str, symbol: &str, value: f64, unit: &str| ParameterView {
        key: key.into(),
        symbol: symbol.into(),
        name: meaning(symbol).into(),
        value: format::setting(value, unit).text,
        unit: unit.into(),
        source: source(key),
    };
    let mut rows = Vec::new();
    for (key, index, info) in model.base_parameters() {
        let value = model.clone().parameter(&mut at, index).map_or(f64::NAN, |value| *value);
        let symbol = info.symbol.replace("kc", "k_c").replace("cc", "c_c");
        let name = if scenario.rig.is_arm() { of_arm(&key, &symbol) } else { info.meaning };
        let row = ParameterView { name: name.into(), ..number(&key, &symbol, value, info.unit) };
        // The words of a contact stand with its numbers.
        if key == "instrument.drive_gain" || key == "instrument.drive_sensitivity" {
            rows.extend(scenario.contact.map(|contact| {
                let key = "contact.formulation";
                words(key, "formulation of the contact", formulation(contact.formulation), &source(key))
            }));
        }
        // Of an instrument nobody has said anything of.
        let neutral = if info.key == "phase_offset" { 0.0 } else { 1.0 };
        let ideal = key.starts_with("instrument.") && !info.key.contains("sensitivity") && value == neutral;
        rows.push(if ideal { ParameterView { source: "ideal instrument".into(), ..row } } else { row });
    }
    let coordinate = scenario.rig.coordinate();
    rows.extend(scenario.effects.iter().flat_map(|effect| of_effect(effect, coordinate, &scenario.provenance)));
    rows.extend(scenario.sweep.iter().flat_map(|sweep| of_sweep(sweep, scenario)));
    rows
}

/// What a number of the paper's rig is, in the words of the table of symbols.
fn of_arm(key: &str, symbol: &str) -> &'static str {
    match key {
        "instrument.drive_gain" => "true over stated amplitude of the actuator",
        "instrument.amplitude_gain" => "reading over true amplitude",
        "instrument.phase_offset" => "reading minus true phase",
        _ => meaning(symbol),
    }
}

/// The formulation in the word of the scenario files.
pub fn formulation(formulation: Formulation) -> &'static str {
    match formulation {
        Formulation::Series => "series",
        Formulation::Paper => "paper",
    }
}

fn words(key: &str, name: &str, value: &str, source: &str) -> ParameterView {
    ParameterView {
        key: key.into(),
        symbol: String::new(),
        name: name.into(),
        value: value.into(),
        unit: String::new(),
        source: source.into(),
    }
}

fn of_effect(setting: &EffectSetting, coordinate: Coordinate, source: &str) -> Vec<ParameterView> {
    let row = |((info, key), value): ((&ParameterInfo, String), &f64)| {
        let info = info.on(coordinate);
        ParameterView {
            key,
            symbol: info.symbol.into(),
            name: info.meaning.into(),
            value: format::setting(*value, info.unit).text,
            unit: info.unit.into(),
            source: source.into(),
        }
    };
    let keyed = setting.effect.parameters().iter().zip(setting.effect.keys());
    keyed.zip(&setting.parameters).map(row).collect()
}

fn of_sweep(sweep: &Sweep, scenario: &Scenario) -> Vec<ParameterView> {
    let (drive, arm) = (&scenario.signals.drive, scenario.rig.is_arm());
    let axis = |key: &str, symbol: &str, values: &[f64], unit: &str| ParameterView {
        key: key.into(),
        symbol: symbol.into(),
        name: match key {
            "sweep.drive" if !arm => format!("amplitude of the drive: {}", drive.name),
            "sweep.speed" if !arm => "speed of the surface that slides on the rig".into(),
            _ => meaning(symbol).into(),
        },
        value: list(values, unit),
        unit: unit.into(),
        source: "sweep".into(),
    };
    let frequency = axis("sweep.frequency", "f", &sweep.frequency, "Hz");
    let driven = axis("sweep.drive", drive.symbol, &sweep.drive, drive.unit);
    if scenario.contact.is_none() {
        return vec![frequency, driven];
    }
    vec![
        frequency,
        axis("sweep.speed", "V", &sweep.speed, "m/s"),
        axis("sweep.load", "W", &sweep.load, "N"),
        driven,
        axis("sweep.friction", "μ", &sweep.friction, "1"),
    ]
}

/// Up to eight values in full; more as their range and number.
fn list(values: &[f64], unit: &str) -> String {
    let text = |value: &f64| format::setting(*value, unit).text;
    match values {
        [] => format::NONE.into(),
        [first, .., last] if values.len() > 8 => {
            format!("{} … {} ({} values)", text(first), text(last), format::count(values.len()))
        }
        _ => values.iter().map(text).collect::<Vec<_>>().join(", "),
    }
}
