//! What a scenario adds to rig and contact: effects, a table of measurements, parameters that may be fitted.

use super::LoadOptions;
use super::diagnostic::{nearest, quote, suggestion};
use super::embedded;
use super::formula;
use super::parameters::{COLUMNS, CONTACT, RIG, SWEEP};
use super::reader::{Reader, Table, units};
use super::rig::Rig;
use super::source::Store;
use super::types::{EffectSetting, Instrument, MeasurementSource, Scenario};
use super::written::{Entry, Node, Value};
use crate::effects::{Effect, ParameterInfo, compatible, find_among, fits_rig, in_paper_formulation};
use crate::parameter::Coordinate;

/// The list `[[effect]]`, each from the catalogue or a formula and none twice, for a rig with that coordinate and with
/// a contact or without; `None` where the table of either is not sound.
pub(crate) fn effects(
    reader: &mut Reader<'_>,
    node: Option<&Node>,
    (coordinate, contact): (Option<Coordinate>, Option<bool>),
    options: &LoadOptions<'_>,
) -> Vec<EffectSetting> {
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
        let Some(setting) = effect(reader, &table, coordinate.unwrap_or(Coordinate::Angle), options) else { continue };
        let unfit = contact.and_then(|has| fits_rig(setting.effect, has).err());
        if let Some(why) = unfit {
            let help = match contact {
                Some(true) => "remove the effect, or the table [contact]",
                _ => "remove the effect, or add the table [contact]; `stickslip effects` says which effects need one",
            };
            reader.fail(&item.place, &why, "does not go with the rig", help);
            continue;
        }
        if list.iter().any(|other| other.name() == setting.name()) {
            let title = format!("the effect `{}` appears twice", setting.name());
            let further = setting.effect.further().first();
            let other = further.map_or(String::new(), |other| format!(", or name it `{}` to have both", other.name()));
            reader.fail(&item.place, &title, "appeared before", &format!("remove one of the two{other}"));
        } else {
            let together: Vec<&dyn Effect> =
                list.iter().chain([&setting]).map(|one| one.effect as &dyn Effect).collect();
            if let Err(why) = compatible(&together) {
                let help = "remove one of the two, or write a scenario for each";
                reader.fail(&item.place, &why, "does not go with an effect above", help);
            } else {
                list.push(setting);
            }
        }
    }
    list
}

/// The published procedure has no place for effects of the contact and of the arm's motion.
pub(crate) fn fits_formulation(reader: &mut Reader<'_>, node: Option<&Node>, list: &[EffectSetting], paper: bool) {
    let Some(Node { value: Value::List(items), .. }) = node else { return };
    let outside = |setting: &&EffectSetting| !in_paper_formulation(setting.effect);
    for setting in list.iter().filter(outside).filter(|_| paper) {
        let is_it = |item: &&Node| match &item.value {
            Value::Table(entries) => entries.iter().any(|entry| {
                entry.key == "name" && matches!(&entry.node.value, Value::Text(name) if name == setting.name())
            }),
            _ => false,
        };
        if let Some(item) = items.iter().find(is_it) {
            let title = format!("the published procedure carries no effects such as `{}`", setting.name());
            let help = "use formulation = \"series\" in [contact], and in [sweep] where it lists formulations";
            reader.fail(&item.place, &title, "not part of formulation = \"paper\"", help);
        }
    }
}

fn effect(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    coordinate: Coordinate,
    options: &LoadOptions<'_>,
) -> Option<EffectSetting> {
    if table.get("formula").is_some() {
        return formula::effect(reader, table, options);
    }
    let Some(node) = table.get("name") else {
        reader.keys(
            table,
            &[("name", "text")],
            &table.entries.iter().map(|entry| entry.key.as_str()).collect::<Vec<_>>(),
        );
        return None;
    };
    let name = reader.text("name", node)?;
    let Some(effect) = find_among(options.effects, &name) else {
        let known: Vec<_> = options.effects.iter().map(|effect| effect.name()).collect();
        let label = suggestion(nearest(&name, known.iter().copied()), "not in the catalogue");
        let help = format!("`stickslip effects` lists the catalogue: {}", known.join(", "));
        reader.fail(&node.place, &format!("unknown effect {}", quote(&name)), &label, &help);
        return None;
    };
    let infos: Vec<ParameterInfo> = effect.parameters().iter().map(|info| info.on(coordinate)).collect();
    let table = Table { name: format!("the effect `{name}`"), place: node.place.clone(), entries: table.entries };
    let (optional, required): (Vec<_>, Vec<_>) =
        infos.iter().copied().enumerate().partition(|(index, _)| effect.unstated(*index).is_some());
    let required: Vec<ParameterInfo> = required.into_iter().map(|(_, info)| info).collect();
    let optional: Vec<&str> = ["name"].into_iter().chain(optional.iter().map(|(_, info)| info.key)).collect();
    reader.keys(&table, &units(&required), &optional);
    let value = |(index, info): (usize, &ParameterInfo)| match table.get(info.key) {
        Some(node) => reader.quantity(node, info),
        None => effect.unstated(index),
    };
    let values: Vec<_> = infos.iter().enumerate().map(value).collect();
    Some(EffectSetting { effect, parameters: values.into_iter().collect::<Option<_>>()? })
}

/// The table `[measurement]`; the outer option tells whether it is sound, the inner one whether it is there.
pub(crate) fn measurement(
    reader: &mut Reader<'_>,
    entries: &[Entry],
    store: Store,
) -> Option<Option<MeasurementSource>> {
    if !entries.iter().any(|entry| entry.key == "measurement") {
        return Some(None);
    }
    let table = reader.table(entries, "measurement")?;
    reader.keys(&table, &[("file", "text")], &["columns", "record", "sheet", "frequency"]);
    let node = table.get("file")?;
    let name = reader.text("file", node)?;
    let folder = reader.source(&node.place).path.parent().unwrap_or(std::path::Path::new("")).to_path_buf();
    let file = match store {
        Store::Disk => Some(folder.join(&name)).filter(|file| file.is_file()),
        Store::Embedded => embedded::marked(&folder.join(&name)),
    };
    let Some(file) = file else {
        let title = format!("there is no measurement table {}", quote(&name));
        let help = "the path is relative to the file that contains it; check its spelling";
        reader.fail(&node.place, &title, "no such file", help);
        return None;
    };
    let columns = match table.get("columns") {
        Some(node) => columns(reader, node)?,
        None => Vec::new(),
    };
    let record = match table.get("record") {
        Some(node) => Some(record(reader, node)?),
        None => None,
    };
    let sheet = match table.get("sheet") {
        Some(node) => Some(reader.text("sheet", node)?),
        None => None,
    };
    let band = match table.get("frequency") {
        Some(_) => Some(band(reader, table.entries)?),
        None => None,
    };
    Some(Some(MeasurementSource { file, columns, record, sheet, band }))
}

/// Between which frequencies readings are used.
fn band(reader: &mut Reader<'_>, entries: &[Entry]) -> Option<(f64, f64)> {
    let table = reader.table(entries, "frequency")?;
    reader.keys(&table, &[("from", "Hz"), ("to", "Hz")], &[]);
    let [from, to] = ["from", "to"].map(|key| table.get(key).and_then(|node| reader.quantity(node, &SWEEP[0])));
    let (from, to) = (from?, to?);
    if from >= to {
        let help = "`frequency` of [measurement] keeps the readings of this range: write the lower frequency as `from`";
        reader.fail(&table.place, "`from` needs to be less than `to`", "no frequency lies in this range", help);
        return None;
    }
    Some((from, to))
}

/// Which function of a universal file.
fn record(reader: &mut Reader<'_>, node: &Node) -> Option<usize> {
    match node.value {
        Value::Number(number) if (1.0..=1e6).contains(&number) && number.fract() == 0.0 => Some(number as usize),
        _ => {
            let help =
                "`record` says which frequency response function of a universal file is meant: write e.g. record = 2";
            reader.fail(&node.place, "`record` needs a whole number from 1", "not such a number", help);
            None
        }
    }
}

fn columns(reader: &mut Reader<'_>, node: &Node) -> Option<Vec<(String, String)>> {
    let Value::Table(entries) = &node.value else {
        let title = format!("`columns` needs to be a table, not {}", node.value.kind());
        let help = "write e.g. columns = { frequency = \"f [Hz]\" }";
        reader.fail(&node.place, &title, "a table is needed", help);
        return None;
    };
    reader.keys(&Table { name: "`columns`".into(), place: node.place.clone(), entries }, &[], COLUMNS);
    let pairs = entries.iter().map(|entry| reader.text(&entry.key, &entry.node).map(|text| (entry.key.clone(), text)));
    pairs.collect()
}

/// `[fit] free`, each the key of a parameter that this scenario has.
pub(crate) fn free(
    reader: &mut Reader<'_>,
    entries: &[Entry],
    of: (Option<&Rig>, bool, Option<&Instrument>),
    effects: &[EffectSetting],
) -> Vec<String> {
    let Some(table) = reader.table(entries, "fit") else { return Vec::new() };
    reader.keys(&table, &[("free", "list")], &[]);
    let Some(node) = table.get("free") else { return Vec::new() };
    let known = parameter_keys(of, effects);
    // Which numbers a rig has that is not sound is not known.
    let of_rig = |item: &Node| match &item.value {
        Value::Text(name) if of.0.is_none() && name.starts_with("rig.") => Some(name.clone()),
        _ => None,
    };
    let listed: Vec<String> = match &node.value {
        Value::List(items) => items.iter().filter_map(of_rig).collect(),
        _ => Vec::new(),
    };
    let known: Vec<&str> = known.iter().chain(&listed).map(String::as_str).collect();
    reader.names("free", node, &known, "a parameter of this scenario")
}

/// Keys of all parameters that a calibration may move: of the rig, the contact where there is one, the instrument, and
/// of `effects`. A table that is not sound has those of the paper's rig.
fn parameter_keys(of: (Option<&Rig>, bool, Option<&Instrument>), effects: &[EffectSetting]) -> Vec<String> {
    let (rig, contact, instrument) = of;
    let rig: Vec<&str> = rig.map_or_else(
        || RIG.iter().map(|info| info.key).collect(),
        |rig| rig.parameters().into_iter().map(|(_, info)| info.key).collect(),
    );
    let contact: Vec<&str> = CONTACT.iter().map(|info| info.key).filter(|_| contact).collect();
    let instrument = instrument.copied().unwrap_or_default().parameters().map(|info| info.key);
    let base = [("rig", rig), ("contact", contact), ("instrument", instrument.to_vec())];
    let base = base.into_iter().flat_map(|(table, keys)| keys.into_iter().map(move |key| format!("{table}.{key}")));
    base.chain(effects.iter().flat_map(|setting| setting.effect.keys())).collect()
}

impl Scenario {
    /// Keys of all parameters that a calibration may move, those of its effects included.
    pub fn parameter_keys(&self) -> Vec<String> {
        parameter_keys((Some(&self.rig), self.contact.is_some(), Some(&self.instrument)), &self.effects)
    }
}
