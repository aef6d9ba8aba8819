//! A user's own effect: `[[effect]] formula`, its name, what it acts on and its parameters.

use super::LoadOptions;
use super::diagnostic::{Place, nearest, quote, suggestion};
use super::reader::{Reader, Table};
use super::types::EffectSetting;
use super::written::{Entry, Node, Value, find};
use crate::effects::find_among;
use crate::effects::formula::{ActsOn, Blame, Formula, Stated, Statement};
use crate::units;

/// Keys of the table that are no parameters.
const OWN: [&str; 3] = ["formula", "name", "acts_on"];
/// Keys of a parameter.
const OF_PARAMETER: [&str; 3] = ["value", "low", "high"];
/// Longest name of an effect.
const LONGEST_NAME: usize = 40;

/// The effect that a table with a formula states.
pub(crate) fn effect(reader: &mut Reader<'_>, table: &Table<'_>, options: &LoadOptions<'_>) -> Option<EffectSetting> {
    let shown = Table { name: "an effect with a formula".into(), place: table.place.clone(), entries: table.entries };
    let keys: Vec<&str> = table.entries.iter().map(|entry| entry.key.as_str()).collect();
    reader.keys(&shown, &[("name", "text"), ("acts_on", "text"), ("formula", "text")], &keys);
    let name = table.get("name").and_then(|node| name(reader, node, options));
    let acts_on = table.get("acts_on").and_then(|node| acts_on(reader, node));
    let node = table.get("formula")?;
    let text = reader.text("formula", node);
    let own = table.entries.iter().filter(|entry| !OWN.contains(&entry.key.as_str()));
    let entries: Vec<&Entry> = own.collect();
    let parameters: Vec<Option<Stated>> = entries.iter().map(|entry| parameter(reader, entry)).collect();
    let parameters: Vec<Stated> = parameters.into_iter().collect::<Option<_>>()?;
    let values = parameters.iter().map(|stated| stated.value).collect();
    let statement = Statement { name: name?, text: text?, acts_on: acts_on?, parameters };
    match Formula::new(statement.clone()) {
        Ok(effect) => Some(EffectSetting { effect, parameters: values }),
        Err(fault) => {
            let place = match fault.blame {
                Blame::Text(span) => within(reader, node, &statement.text, span),
                Blame::Parameter(index) => entries[index].place.clone(),
            };
            reader.fail(&place, &fault.title, &fault.label, &fault.help);
            None
        }
    }
}

/// The place of a part of a text: within its quotation marks, or all of it where it is written with escapes.
fn within(reader: &Reader<'_>, node: &Node, text: &str, part: std::ops::Range<usize>) -> Place {
    let Place { file, span } = node.place.clone();
    let literal = reader.source(&node.place).text.get(span.clone()).unwrap_or_default();
    match literal.find(text).filter(|_| !text.is_empty()) {
        Some(at) => Place { file, span: span.start + at + part.start..span.start + at + part.end },
        None => Place { file, span },
    }
}

fn name(reader: &mut Reader<'_>, node: &Node, options: &LoadOptions<'_>) -> Option<String> {
    let name = reader.text("name", node)?;
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if name.len() > LONGEST_NAME || !name.starts_with(|c: char| c.is_ascii_alphabetic()) || !name.chars().all(letter) {
        let title = format!("{} cannot be the name of an effect", quote(&name));
        let help =
            format!("use at most {LONGEST_NAME} letters, digits and hyphens, a letter first, e.g. \"my-quintic\"");
        reader.fail(&node.place, &title, "not such a name", &help);
        return None;
    }
    if find_among(options.effects, &name).is_some() {
        let title = format!("`{name}` is an effect of the catalogue");
        let help = "give the formula a name of its own, or remove the key `formula` to use the effect of the catalogue";
        reader.fail(&node.place, &title, "taken", help);
        return None;
    }
    Some(name)
}

fn acts_on(reader: &mut Reader<'_>, node: &Node) -> Option<ActsOn> {
    let word = reader.text("acts_on", node)?;
    let found = ActsOn::ALL.iter().find(|(known, _)| *known == word);
    if found.is_none() {
        let words = ActsOn::ALL.map(|(word, _)| word);
        let of = ActsOn::ALL.map(|(word, one)| format!("\"{word}\" (variables {})", one.variables().join(", ")));
        let label = suggestion(nearest(&word, words), "not something that a formula can act on");
        let title = format!("a formula cannot act on {}", quote(&word));
        reader.fail(&node.place, &title, &label, &format!("choose from {}", of.join(", ")));
    }
    found.map(|(_, one)| *one)
}

/// A parameter: a value, or a table with its value and what a search should cover.
fn parameter(reader: &mut Reader<'_>, entry: &Entry) -> Option<Stated> {
    let key = entry.key.as_str();
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if key.starts_with(|c: char| c.is_ascii_digit()) || !key.chars().all(letter) {
        let title = format!("{} cannot be the name of a parameter", quote(key));
        reader.fail(&entry.place, &title, "not such a name", "use letters, digits and underscores, no digit first");
        return None;
    }
    let alone = std::slice::from_ref(entry);
    let (entries, keys) = match &entry.node.value {
        Value::Table(entries) => (entries.as_slice(), OF_PARAMETER),
        _ => (alone, [key, "", ""]),
    };
    if let Value::Table(_) = &entry.node.value {
        let name = format!("the parameter `{key}`");
        reader.keys(&Table { name, place: entry.place.clone(), entries }, &[], &OF_PARAMETER);
    }
    let nodes = keys.map(|key| find(entries, &[key]));
    let text = |node: &&Node| if let Value::Text(text) = &node.value { Some(text.clone()) } else { None };
    let unit = match nodes.iter().flatten().find_map(text).map(|text| units::si_unit(&text)) {
        None => "1".to_string(),
        Some(Ok(unit)) => unit,
        // Told of where the number is read.
        Some(Err(_)) => String::new(),
    };
    let numbers = nodes.map(|node| node.map(|node| number(reader, node, key, &unit)));
    if numbers.contains(&Some(None)) {
        return None;
    }
    let [value, low, high] = numbers.map(Option::flatten);
    let range = match (low, high) {
        (None, None) => None,
        (Some(low), Some(high)) if low < high && high > 0.0 => {
            Some(if low < 0.0 { (0.0, high.max(-low), true) } else { (low, high, false) })
        }
        (low, high) => {
            let help = format!(
                "write {key} = {{ value = …, low = …, high = … }}, low below high and high above zero; a minus \
                                sign that a parameter always has belongs into the formula"
            );
            let both = low.is_some() && high.is_some();
            let label = if both { "no range" } else { "one of the two is missing" };
            reader.fail(&entry.place, &format!("`low` and `high` of `{key}` make no range"), label, &help);
            return None;
        }
    };
    Some(Stated { key: key.into(), unit, value: value.unwrap_or(0.0), range })
}

fn number(reader: &mut Reader<'_>, node: &Node, key: &str, unit: &str) -> Option<f64> {
    let told = match &node.value {
        Value::Number(value) if value.is_finite() => return Some(*value),
        Value::Number(_) => "not a finite number".to_string(),
        Value::Text(text) => {
            let wanted = if unit.is_empty() { "1" } else { unit };
            // A unit that is none is told of before one of another dimension.
            match units::parse(text, wanted).map_err(|error| units::si_unit(text).err().unwrap_or(error)) {
                Ok(value) => return Some(value),
                Err(error) => error.to_string(),
            }
        }
        other => format!("{} is no number", other.kind()),
    };
    let help = format!(
        "write a number in SI, a text with its unit such as \"3e5 N/m^5\", or {key} = {{ value = …, low = …, high = … }}"
    );
    reader.fail(&node.place, &format!("cannot read the parameter `{key}`"), &told, &help);
    None
}
