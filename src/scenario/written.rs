//! What was written: a TOML file as a tree in which every key and value knows its place, and the merging of `extends`.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::diagnostic::Source;
use super::diagnostic::{Place, render};
use crate::error::{Error, Result};

/// A value and its place.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// Where the value stands; for a table, its header or braces.
    pub place: Place,
    /// The value.
    pub value: Value,
}

/// The kinds of value that scenario files use.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    /// A string.
    Text(String),
    /// An integer or a float.
    Number(f64),
    /// A list.
    List(Vec<Node>),
    /// A table.
    Table(Vec<Entry>),
    /// Anything else, e.g. "a date".
    Other(&'static str),
}

/// One `key = value` of a table.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// The key.
    pub key: String,
    /// Where the key stands.
    pub place: Place,
    /// The value.
    pub node: Node,
}

impl Value {
    /// The kind in words, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "a string",
            Self::Number(_) => "a number",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
            Self::Other(kind) => kind,
        }
    }
}

/// Parses one file; `file` is its index among the sources.
pub(crate) fn parse(source: &Source, file: usize) -> Result<Vec<Entry>> {
    let table = DeTable::parse(&source.text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        let (title, label) = match error.message().split_once(", ") {
            Some((title, label)) => (title, label),
            None => (error.message(), "here"),
        };
        let mut help =
            "scenario files are TOML: `key = value` lines under [table] headers, text in double quotes".to_string();
        if !source.text.contains('=') {
            help += &format!("; of a measured table `stickslip new {}` writes one", source.name);
        }
        Error::Input(render(source, span, &format!("not valid TOML: {title}"), label, &help))
    })?;
    Ok(entries(table.into_inner(), file))
}

fn entries(table: DeTable<'_>, file: usize) -> Vec<Entry> {
    let mut list: Vec<Entry> = table
        .into_iter()
        .map(|(key, value)| {
            let place = Place { file, span: key.span() };
            let span = value.span();
            Entry { key: key.into_inner().into_owned(), place, node: node(value.into_inner(), span, file) }
        })
        .collect();
    list.sort_by_key(|entry| entry.place.span.start);
    list
}

fn node(value: DeValue<'_>, span: Range<usize>, file: usize) -> Node {
    let value = match value {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(number) => {
            let value = i64::from_str_radix(number.as_str(), number.radix());
            value.map_or(Value::Other("an integer beyond 64 bits"), |value| Value::Number(value as f64))
        }
        DeValue::Float(number) => number.as_str().parse().map_or(Value::Other("a malformed number"), Value::Number),
        DeValue::Boolean(_) => Value::Other("true or false"),
        DeValue::Datetime(_) => Value::Other("a date"),
        DeValue::Array(list) => Value::List(
            list.into_iter()
                .map(|item| {
                    let span = item.span();
                    node(item.into_inner(), span, file)
                })
                .collect(),
        ),
        DeValue::Table(table) => Value::Table(entries(table, file)),
    };
    Node { place: Place { file, span }, value }
}

/// Lays `child` over `base`: tables of the top level are merged key by key, everything else is replaced.
/// A range (`{ from, to, points }`) is one value and never mixes with the one it replaces.
pub(crate) fn merge(base: Vec<Entry>, child: Vec<Entry>) -> Vec<Entry> {
    overlay(base, child, true)
}

fn overlay(base: Vec<Entry>, child: Vec<Entry>, tables: bool) -> Vec<Entry> {
    let mut merged = base;
    for mut entry in child {
        let Some(old) = merged.iter_mut().find(|old| old.key == entry.key) else {
            merged.push(entry);
            continue;
        };
        entry.node.value = match (std::mem::replace(&mut old.node.value, Value::Other("")), entry.node.value) {
            (Value::Table(below), Value::Table(above)) if tables => Value::Table(overlay(below, above, false)),
            (_, above) => above,
        };
        *old = entry;
    }
    merged
}

/// The value under a key of a table, and so on inwards.
pub(crate) fn find<'a>(entries: &'a [Entry], keys: &[&str]) -> Option<&'a Node> {
    let (first, rest) = keys.split_first()?;
    let node = &entries.iter().find(|entry| entry.key == *first)?.node;
    if rest.is_empty() { Some(node) } else { find(inside(node), rest) }
}

/// The entries of a table; of anything else, none.
pub(crate) fn inside(node: &Node) -> &[Entry] {
    if let Value::Table(entries) = &node.value { entries } else { &[] }
}

/// The items of the list under a key.
pub(crate) fn list<'a>(entries: &'a [Entry], key: &str) -> &'a [Node] {
    match find(entries, &[key]).map(|node| &node.value) {
        Some(Value::List(items)) => items,
        _ => &[],
    }
}

/// The strings of a list.
pub(crate) fn texts(node: &Node) -> Vec<&str> {
    let Value::List(items) = &node.value else { return Vec::new() };
    items
        .iter()
        .filter_map(|item| if let Value::Text(text) = &item.value { Some(text.as_str()) } else { None })
        .collect()
}

/// The string under `name`.
pub(crate) fn name(item: &Node) -> Option<&str> {
    match find(inside(item), &["name"]).map(|node| &node.value) {
        Some(Value::Text(name)) => Some(name),
        _ => None,
    }
}

/// Where the last value of a table ends; without one, its header.
pub(crate) fn end(table: &Node) -> usize {
    inside(table).iter().map(|entry| entry.node.place.span.end).max().unwrap_or(table.place.span.end)
}

/// A text as TOML.
pub(crate) fn quoted(text: &str) -> String {
    toml::Value::String(text.into()).to_string()
}
