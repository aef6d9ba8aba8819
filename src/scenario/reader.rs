//! From written values to numbers and words: every reader either returns what was meant or notes a problem.

use super::diagnostic::{Place, Problems, nearest, quote, suggestion};
use super::source::Source;
use super::written::{Entry, Node, Value};
use crate::effects::ParameterInfo;
use crate::units;

/// The files of a scenario and the problems found so far.
pub(crate) struct Reader<'a> {
    sources: &'a [Source],
    problems: Problems,
}

/// A table and its name as it appears in messages, e.g. `[rig]`.
pub(crate) struct Table<'a> {
    /// Name in brackets.
    pub name: String,
    /// Where its header stands.
    pub place: Place,
    /// Its entries.
    pub entries: &'a [Entry],
}

impl<'a> Table<'a> {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&'a Node> {
        self.entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }
}

impl<'a> Reader<'a> {
    /// A reader without problems yet.
    pub fn new(sources: &'a [Source]) -> Self {
        Self { sources, problems: Problems::default() }
    }

    /// Notes a problem.
    pub fn fail(&mut self, place: &Place, title: &str, label: &str, help: &str) {
        self.problems.push(self.sources, place, title, label, help);
    }

    /// All problems as one message.
    pub fn into_message(self) -> Option<String> {
        self.problems.into_message()
    }

    /// The file of a place.
    pub fn source(&self, place: &Place) -> &'a Source {
        &self.sources[place.file]
    }

    /// The first line of the file that was named, for what is missing altogether.
    pub fn top(&self) -> Place {
        let end = self.sources.first().map_or(0, |source| source.text.find(['\r', '\n']).unwrap_or(source.text.len()));
        Place { file: 0, span: 0..end }
    }

    /// A table of the top level, if it is there.
    pub fn table<'b>(&mut self, entries: &'b [Entry], key: &str) -> Option<Table<'b>> {
        let entry = entries.iter().find(|entry| entry.key == key)?;
        match &entry.node.value {
            Value::Table(inner) => Some(Table { name: format!("[{key}]"), place: entry.place.clone(), entries: inner }),
            other => {
                let title = format!("`{key}` needs to be a table, not {}", other.kind());
                let help = format!("write a line [{key}] and its keys below it");
                self.fail(&entry.node.place, &title, "a table is needed", &help);
                None
            }
        }
    }

    /// Complains about keys that the table does not have.
    pub fn known_keys(&mut self, table: &str, entries: &[Entry], keys: &[&str]) {
        for entry in entries.iter().filter(|entry| !keys.contains(&entry.key.as_str())) {
            let title = format!("unknown key {} in {table}", quote(&entry.key));
            let label = suggestion(nearest(&entry.key, keys.iter().copied()), "no such key");
            let help = format!("{table} has the keys {}", keys.join(", "));
            self.fail(&entry.place, &title, &label, &help);
        }
    }

    /// Complains, at the table, about all keys that are needed and not there.
    pub fn needed_keys(&mut self, table: &Table<'_>, needed: &[(&str, &str)]) {
        let missing: Vec<_> = needed.iter().filter(|(key, _)| table.get(key).is_none()).collect();
        if missing.is_empty() {
            return;
        }
        let names: Vec<_> = missing.iter().map(|(key, _)| format!("`{key}`")).collect();
        let lines: Vec<_> = missing.iter().map(|(key, unit)| format!("{key} = {}", example(unit))).collect();
        let plural = if missing.len() == 1 { "key" } else { "keys" };
        let title = format!("{} lacks the {plural} {}", table.name, names.join(", "));
        let help = format!("no value is assumed; add, with your own numbers: {}", lines.join("; "));
        self.fail(&table.place, &title, &format!("{plural} missing in this table"), &help);
    }

    /// A string.
    pub fn text(&mut self, what: &str, node: &Node) -> Option<String> {
        match &node.value {
            Value::Text(text) => Some(text.clone()),
            other => {
                let title = format!("`{what}` needs text, not {}", other.kind());
                self.fail(&node.place, &title, "text is needed", "put the text in double quotes");
                None
            }
        }
    }

    /// A list of names, each from `known`, none twice.
    pub fn names(&mut self, what: &str, node: &Node, known: &[&str], kind: &str) -> Vec<String> {
        let Value::List(items) = &node.value else {
            let title = format!("`{what}` needs a list, not {}", node.value.kind());
            self.fail(&node.place, &title, "a list is needed", "write the names in brackets: [\"…\", \"…\"]");
            return Vec::new();
        };
        let mut names: Vec<String> = Vec::new();
        for item in items {
            let Some(name) = self.text(what, item) else { continue };
            if !known.contains(&name.as_str()) {
                let label = suggestion(nearest(&name, known.iter().copied()), "not one of the names below");
                let help = format!("choose from {}", known.join(", "));
                self.fail(&item.place, &format!("{} is not {kind}", quote(&name)), &label, &help);
            } else if names.contains(&name) {
                let title = format!("`{name}` appears twice in `{what}`");
                self.fail(&item.place, &title, "named before", "remove one of the two");
            } else {
                names.push(name);
            }
        }
        names
    }

    /// A number in SI or a string with a unit, within the physical range.
    pub fn quantity(&mut self, node: &Node, info: &ParameterInfo) -> Option<f64> {
        let (key, unit) = (info.key, info.unit);
        let bare = if unit == "1" { String::new() } else { format!(", or a bare number in {unit}") };
        let value = match &node.value {
            Value::Number(value) => *value,
            Value::Text(text) => match units::parse(text, unit) {
                Ok(value) => value,
                Err(error) => {
                    let help = format!("`{key}` is the {}: write e.g. {}{bare}", info.meaning, example(unit));
                    self.fail(&node.place, &format!("cannot read `{key}`"), &error.to_string(), &help);
                    return None;
                }
            },
            other => {
                let title = format!("`{key}` needs a quantity, not {}", other.kind());
                let help = format!("`{key}` is the {}: write e.g. {}{bare}", info.meaning, example(unit));
                self.fail(&node.place, &title, "a number, or a string with a unit, is needed", &help);
                return None;
            }
        };
        if !(info.minimum..=info.maximum).contains(&value) {
            let shown = if value.is_finite() { units::format(value, unit) } else { format!("{value}") };
            let title = format!("`{key}` is outside its physical range: {shown}");
            let label = format!("needs {} to {}", units::format(info.minimum, unit), units::format(info.maximum, unit));
            let help =
                format!("`{key}` is the {}; check the number and its unit (a bare number is in {unit})", info.meaning);
            let help = if unit == "1" { format!("`{key}` is the {}; check the number", info.meaning) } else { help };
            self.fail(&node.place, &title, &label, &help);
            return None;
        }
        Some(value)
    }
}

/// A quantity in the notation of scenario files, to show the form.
fn example(unit: &str) -> String {
    match unit {
        "1" => "0.5".into(),
        "text" => "\"…\"".into(),
        "m" => "\"60 mm\"".into(),
        "m/s" => "\"20 mm/s\"".into(),
        "Hz" => "\"72 Hz\"".into(),
        "N" => "\"20 N\"".into(),
        unit => format!("\"1 {unit}\""),
    }
}
