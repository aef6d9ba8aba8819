//! From written values to numbers and words: every reader either returns what was meant or notes a problem.

use super::diagnostic::Source;
use super::diagnostic::{Place, Problems, nearest, quote, suggestion};
use super::written::{Entry, Node, Value};
use crate::parameter::ParameterInfo;
use crate::units;

/// Name of the file's top level in messages.
pub(crate) const WHOLE: &str = "the scenario";

/// Keys of a scenario outside its tables, and its tables.
pub(crate) const TOP_LEVEL: &[&str] = &[
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
    "gate",
    "question",
];

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

    /// Complains about keys that the table does not have, and at its header about all that are needed and not there.
    /// `needed` holds keys with their units. A misspelt key is told once, not also as missing.
    pub fn keys(&mut self, table: &Table<'_>, needed: &[(&str, &str)], optional: &[&str]) {
        let known: Vec<&str> = needed.iter().map(|(key, _)| *key).chain(optional.iter().copied()).collect();
        let mut misspelt = Vec::new();
        for entry in table.entries.iter().filter(|entry| !known.contains(&entry.key.as_str())) {
            let near = nearest(&entry.key, known.iter().copied());
            misspelt.extend(near);
            let title = format!("unknown key {} in {}", quote(&entry.key), table.name);
            let label = match near {
                None if TOP_LEVEL.contains(&entry.key.as_str()) => "belongs above the first [table]".into(),
                near => suggestion(near, "no such key"),
            };
            let help = format!("{} has the keys {}", table.name, known.join(", "));
            self.fail(&entry.place, &title, &label, &help);
        }
        let lacking = |key: &str| table.get(key).is_none() && !misspelt.contains(&key);
        let missing: Vec<_> = needed.iter().filter(|(key, _)| lacking(key)).collect();
        if missing.is_empty() {
            return;
        }
        let names: Vec<_> = missing.iter().map(|(key, _)| format!("`{key}`")).collect();
        let lines: Vec<_> = missing.iter().map(|(key, unit)| format!("{key} = {}", example(key, unit))).collect();
        let plural = if missing.len() == 1 { "key" } else { "keys" };
        let title = format!("{} lacks the {plural} {}", table.name, names.join(", "));
        let help = format!("no value is assumed; add, with your own values: {}", lines.join("; "));
        let label = if table.name == WHOLE { "add it at the top of this file" } else { "missing in this table" };
        self.fail(&table.place, &title, label, &help);
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
                    let help = format!("`{key}` is the {}: write e.g. {}{bare}", info.meaning, example(key, unit));
                    self.fail(&node.place, &format!("cannot read `{key}`"), &error.to_string(), &help);
                    return None;
                }
            },
            other => {
                let title = format!("`{key}` needs a quantity, not {}", other.kind());
                let help = format!("`{key}` is the {}: write e.g. {}{bare}", info.meaning, example(key, unit));
                self.fail(&node.place, &title, "a number, or a string with a unit, is needed", &help);
                return None;
            }
        };
        if !(info.minimum..=info.maximum).contains(&value) {
            let shown = if value.is_finite() { units::format(value, unit) } else { format!("{value}") };
            let title = format!("`{key}` is outside its physical range: {shown}");
            let label = super::parameters::needed_range((info.minimum, info.maximum), unit);
            let help =
                format!("`{key}` is the {}; check the number and its unit (a bare number is in {unit})", info.meaning);
            let help = if unit == "1" { format!("`{key}` is the {}; check the number", info.meaning) } else { help };
            self.fail(&node.place, &title, &label, &help);
            return None;
        }
        Some(value)
    }
}

/// A value in the notation of scenario files, to show the form.
fn example(key: &str, unit: &str) -> String {
    match (key, unit) {
        ("points", _) => "101".into(),
        ("drive", _) => "\"2.5 um\"".into(),
        (_, "text") => "\"…\"".into(),
        (_, "list") => "[\"…\"]".into(),
        ("max_rms_error" | "amplitude_tolerance", _) => "\"5 %\"".into(),
        ("max_chi2_per_point", _) => "1.5".into(),
        ("amplitude_floor", "rad") => "\"0.1 urad\"".into(),
        ("phase_tolerance", _) => "\"3 deg\"".into(),
        (_, "1") => "0.5".into(),
        (_, "m") => "\"60 mm\"".into(),
        (_, "m/s") => "\"20 mm/s\"".into(),
        (_, "Hz") => "\"72 Hz\"".into(),
        (_, "N") => "\"20 N\"".into(),
        (_, unit) => format!("\"1 {unit}\""),
    }
}

/// Keys with their units.
pub(crate) fn units(infos: &[ParameterInfo]) -> Vec<(&'static str, &'static str)> {
    infos.iter().map(|info| (info.key, info.unit)).collect()
}
