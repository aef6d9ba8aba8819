//! Rewriting a scenario file: fitted numbers, an effect put in or taken out, everything else byte for byte as it was.
//!
//! The text is parsed for the places of its keys and values, and only there changed.

use std::path::{Path, PathBuf};

use super::diagnostic::{render, whole_file};
use super::extends::{self, Document};
use super::source::Store;
use super::splice::Splice;
use super::written::{Entry, Node, Value, end, find, inside, list, name, parse, quoted, texts};
use crate::error::{Error, Result};

use super::literal::Written;

pub use super::literal::Estimate;

/// A scenario file that is to be changed.
#[derive(Debug)]
pub struct Editable {
    document: Document,
    /// The entries of the file itself, those that it extends left out.
    own: Vec<Entry>,
}

/// What is to be different.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    /// Parameters of rig, contact, instrument and of effects: their new values.
    pub values: Vec<Estimate>,
    /// Names of effects to put in; their parameters are among the values.
    pub add: Vec<String>,
    /// Name of an effect to take out.
    pub remove: Option<String>,
    /// The whole list `[fit] free`.
    pub free: Vec<String>,
    /// Another path under `extends`.
    pub extends: Option<String>,
    /// Another path under `file` in `[measurement]`.
    pub table: Option<String>,
}

impl Editable {
    /// Reads a file and those that it extends.
    ///
    /// # Errors
    /// [`Error::Input`] where one of them cannot be used.
    pub fn open(path: &Path) -> Result<Self> {
        let document = extends::read(Store::Disk, path)?;
        let own = parse(&document.sources[0], 0)?;
        Ok(Self { document, own })
    }

    /// The text of the file.
    pub fn text(&self) -> &str {
        &self.document.sources[0].text
    }

    /// The files that it extends, the nearest first.
    pub fn parents(&self) -> impl Iterator<Item = &Path> {
        self.document.sources[1..].iter().map(|source| source.path.as_path())
    }

    /// The file that states the effects, where that is one that this file extends.
    pub fn effects_elsewhere(&self) -> Option<&Path> {
        let entry = self.document.entries.iter().find(|entry| entry.key == "effect")?;
        let file = entry.place.file;
        (file > 0).then(|| self.document.sources[file].path.as_path())
    }

    /// The files that this one names itself, `extends` and the measured table: as written, and where they are.
    pub fn named(&self) -> [Option<(String, PathBuf)>; 2] {
        let folder = self.document.sources[0].path.parent().unwrap_or(Path::new(""));
        [&["extends"][..], &["measurement", "file"]].map(|keys| match &find(&self.own, keys)?.value {
            Value::Text(name) => Some((name.clone(), folder.join(name))),
            _ => None,
        })
    }

    /// The changed text.
    ///
    /// # Errors
    /// [`Error::Input`] where the file is written in a way that cannot be changed here.
    pub fn apply(&self, changes: &Changes) -> Result<String> {
        let mut splice = Splice::new(self.text());
        let fitted = |name: &str| -> Vec<&Estimate> {
            let of = |estimate: &&Estimate| estimate.key.rsplit_once('.').is_some_and(|(owner, _)| owner == name);
            changes.values.iter().filter(of).collect()
        };
        for table in ["rig", "contact", "instrument"] {
            self.table(&mut splice, table, &fitted(table));
        }
        for item in list(&self.own, "effect") {
            let Some(name) = name(item) else { continue };
            let gone = changes.remove.as_deref() == Some(name);
            if !gone {
                fitted(&format!("effect.{name}")).into_iter().for_each(|one| set(&mut splice, item, one));
            }
        }
        let new: Vec<(&str, Vec<&Estimate>)> =
            changes.add.iter().map(|name| (name.as_str(), fitted(&format!("effect.{name}")))).collect();
        self.put_in(&mut splice, &new);
        if let Some(name) = &changes.remove {
            self.take_out(&mut splice, name)?;
        }
        self.free(&mut splice, &changes.free);
        let paths = [(&["extends"][..], &changes.extends), (&["measurement", "file"], &changes.table)];
        for (keys, path) in paths {
            if let (Some(node), Some(path)) = (find(&self.own, keys), path) {
                splice.replace(node.place.span.clone(), quoted(path));
            }
        }
        splice.finish().ok_or_else(|| {
            let title = format!("`{}` is written in a way that cannot be changed here", self.document.sources[0].name);
            Error::Input(whole_file(&title, "write one key per line below [table] headers"))
        })
    }

    /// Values of a table: replaced where this file has them, put in where they come from elsewhere.
    fn table(&self, splice: &mut Splice<'_>, table: &str, values: &[&Estimate]) {
        let (here, new): (Vec<_>, Vec<_>) =
            values.iter().copied().partition(|one: &&Estimate| find(&self.own, &[table, key(one)]).is_some());
        if let Some(node) = find(&self.own, &[table]) {
            here.iter().for_each(|one| set(splice, node, one));
        }
        let old = |one: &Estimate| {
            let place = &find(&self.document.entries, &[table, key(one)])?.place;
            Some(&self.document.sources[place.file].text[place.span.clone()])
        };
        let lines: Vec<(String, String, Option<String>)> = new
            .iter()
            .map(|one| {
                let written = one.written(old(one));
                (key(one).to_string(), written.literal, Some(written.interval))
            })
            .collect();
        self.insert(splice, table, &lines);
    }

    /// Puts keys (with their values and what is to be said of them) into a table, in the style in which that is
    /// written.
    fn insert(&self, splice: &mut Splice<'_>, table: &str, new: &[(String, String, Option<String>)]) {
        if new.is_empty() {
            return;
        }
        let line = |before: &str, (key, literal, said): &(String, String, Option<String>)| {
            let said = said.as_ref().map_or_else(String::new, |said| format!("  # 95 %: {said}"));
            format!("{before}{key} = {literal}{said}")
        };
        let Some(node) = find(&self.own, &[table]) else {
            let mut lines = vec![format!("[{table}]")];
            lines.extend(new.iter().map(|one| line("", one)));
            return splice.section(None, &lines);
        };
        let last = end(node);
        match splice.at(&node.place.span).chars().next() {
            Some('{') => {
                let text: Vec<String> = new.iter().map(|(key, literal, _)| format!("{key} = {literal}")).collect();
                let (at, text) = match inside(node).is_empty() {
                    true => (node.place.span.start + 1, format!(" {} ", text.join(", "))),
                    false => (last, format!(", {}", text.join(", "))),
                };
                splice.replace(at..at, text);
                new.iter().for_each(|(key, _, said)| splice.note(node.place.span.end, key, said.as_deref()));
            }
            first => {
                let dotted = if first == Some('[') { String::new() } else { format!("{table}.") };
                let indent = if inside(node).is_empty() { "" } else { splice.indent(last) };
                let lines: Vec<String> = new.iter().map(|one| line(&format!("{indent}{dotted}"), one)).collect();
                splice.lines_below(last, &lines);
            }
        }
    }

    /// Puts in effects with their parameters, in the style in which the others are written.
    fn put_in(&self, splice: &mut Splice<'_>, effects: &[(&str, Vec<&Estimate>)]) {
        if effects.is_empty() {
            return;
        }
        let written = |values: &[&Estimate]| -> Vec<_> {
            values.iter().map(|one| (key(one).to_string(), one.written(None))).collect()
        };
        let items = list(&self.own, "effect");
        let below = items.last().filter(|last| splice.at(&last.place.span).starts_with('['));
        let Some(node) = find(&self.own, &["effect"]).filter(|_| below.is_none()) else {
            let mut lines = Vec::new();
            for (name, values) in effects {
                let said = |(key, one): (String, Written)| format!("{key} = {}  # 95 %: {}", one.literal, one.interval);
                lines.extend(["".into(), "[[effect]]".into(), format!("name = {}", quoted(name))]);
                lines.extend(written(values).into_iter().map(said));
            }
            return splice.section(below.map(end), &lines[1..]);
        };
        let spans: Vec<_> = items.iter().map(|item| item.place.span.clone()).collect();
        let inline = |(name, values): &(&str, Vec<&Estimate>)| {
            let keys: String = written(values).iter().map(|(key, one)| format!(", {key} = {}", one.literal)).collect();
            format!("{{ name = {}{keys} }}", quoted(name))
        };
        splice.push(&node.place.span, &spans, &effects.iter().map(inline).collect::<Vec<_>>());
        // Where each element has a line of its own, there is none yet to comment on.
        let at = items.last().map_or(node.place.span.end, |last| last.place.span.end);
        if splice.at(&(at..node.place.span.end)).find('\n').is_none() {
            for (key, one) in effects.iter().flat_map(|(_, values)| written(values)) {
                splice.note(node.place.span.end, &key, Some(&one.interval));
            }
        }
    }

    fn take_out(&self, splice: &mut Splice<'_>, name: &str) -> Result<()> {
        let items = list(&self.own, "effect");
        let Some(index) = items.iter().position(|item| self::name(item) == Some(name)) else { return Ok(()) };
        let item = &items[index];
        let span = item.place.span.clone();
        if splice.at(&span).starts_with('[') {
            splice.take_lines(&(span.start..end(item)), true);
            return Ok(());
        }
        if !splice.at(&span).starts_with('{') {
            let source = &self.document.sources[0];
            let help = "write it as a table [[effect]] of its own";
            return Err(Error::Input(render(source, span, "this effect cannot be taken out here", "written so", help)));
        }
        let spans: Vec<_> = items.iter().map(|item| item.place.span.clone()).collect();
        splice.take(&spans, &[index]);
        Ok(())
    }

    fn free(&self, splice: &mut Splice<'_>, free: &[String]) {
        let quoted: Vec<String> = free.iter().map(|key| quoted(key)).collect();
        let Some(node) = find(&self.own, &["fit", "free"]) else {
            let before = find(&self.document.entries, &["fit", "free"]).map(texts).unwrap_or_default();
            if before != free {
                self.insert(splice, "fit", &[("free".into(), format!("[{}]", quoted.join(", ")), None)]);
            }
            return;
        };
        let Value::List(items) = &node.value else { return };
        let (before, spans) = (texts(node), items.iter().map(|item| item.place.span.clone()).collect::<Vec<_>>());
        let gone: Vec<usize> = (0..before.len()).filter(|&i| !free.iter().any(|key| key == before[i])).collect();
        if !gone.is_empty() {
            splice.take(&spans, &gone);
        }
        let new: Vec<String> =
            free.iter().zip(quoted).filter(|(key, _)| !before.contains(&key.as_str())).map(|(_, q)| q).collect();
        if !new.is_empty() {
            splice.push(&node.place.span, &spans, &new);
        }
    }
}

/// Sets one value of a table, and says how well it is known. A parameter of a formula may be a table with its value.
fn set(splice: &mut Splice<'_>, table: &Node, one: &Estimate) {
    let Some(node) = find(inside(table), &[key(one)]) else { return };
    let node = match &node.value {
        Value::Table(entries) => match find(entries, &["value"]) {
            Some(value) => value,
            None if splice.at(&node.place.span).starts_with('{') => {
                let (written, at) = (one.written(None), node.place.span.start + 1);
                let comma = if entries.is_empty() { "" } else { "," };
                splice.replace(at..at, format!(" value = {}{comma}", written.literal));
                return splice.note(node.place.span.end, key(one), Some(&written.interval));
            }
            None => return,
        },
        _ => node,
    };
    let span = node.place.span.clone();
    let written = one.written(Some(splice.at(&span)));
    splice.replace(span.clone(), written.literal);
    splice.note(span.end, key(one), Some(&written.interval));
}

/// The last part of an estimate's key.
fn key(one: &Estimate) -> &str {
    one.key.rsplit('.').next().unwrap_or(&one.key)
}
