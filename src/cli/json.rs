//! Where the JSON of a command goes.

use super::folder::Folder;
use crate::compare::COMPARATOR;
use crate::error::{Error, Result};
use crate::gate::Judged;
use crate::scenario::diagnostic::whole_file;
use crate::{files, results, terminal};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A result with what judged it.
#[derive(Debug, JsonSchema, Serialize)]
pub struct Stamped<'a, T> {
    #[serde(flatten)]
    result: &'a T,
    program: &'static str,
    comparator: &'static str,
    gates: &'a [Judged],
}

impl<'a, T> Stamped<'a, T> {
    /// The result of this program, with the gates that it was held to.
    pub fn new(result: &'a T, gates: &'a [Judged]) -> Self {
        let program = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
        Self { result, program, comparator: COMPARATOR, gates }
    }
}

/// A file, or standard output.
#[derive(Debug, Clone)]
pub struct Json(PathBuf);

impl From<PathBuf> for Json {
    fn from(path: PathBuf) -> Self {
        Self(path)
    }
}

impl Json {
    /// Whether it goes to standard output, so that nothing else may.
    pub fn to_standard_output(&self) -> bool {
        self.0.as_os_str() == "-"
    }

    /// Complains where the file is another than one of this `schema`, or lies where results of the run go.
    ///
    /// # Errors
    /// [`Error::Input`] naming it.
    pub fn free(&self, schema: &str, results: Option<&Path>) -> Result<()> {
        if self.to_standard_output() {
            return Ok(());
        }
        results.map_or(Ok(()), |results| Folder::apart(results, "--json", &self.0))?;
        files::free(&self.0, |text| ours(text, schema))
    }

    /// Complains where another file of the same command is to be written to the same place.
    pub fn differs_from(&self, option: &str, other: &Path) -> Result<()> {
        if self.0 != other {
            return Ok(());
        }
        let title = format!("--json and {option} both name {}", other.display());
        Err(Error::Input(whole_file(&title, "give them different files")))
    }

    /// Writes a value of a `schema`.
    pub fn write(&self, value: &impl Serialize, schema: &str) -> Result<()> {
        let text = serde_json::to_string_pretty(value).map_err(|why| Error::Unfinished(why.to_string()))?;
        let text = escaped(&text) + "\n";
        if self.to_standard_output() {
            return terminal::print(&text);
        }
        files::replace_own(&self.0, text.as_bytes(), |text| ours(text, schema))
    }
}

/// Whether this is the beginning of a JSON of a schema, of whatever version.
fn ours(text: &str, schema: &str) -> bool {
    let kind = schema.trim_start_matches("stickslip.").split('/').next().unwrap_or_default();
    results::schema(text, kind)
}

/// JSON in which what a terminal would obey is escaped; such a character stands within strings only.
fn escaped(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            c if terminal::obeyed(c) => text.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => text.push(c),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_comes_back_from_its_escapes() {
        let text = serde_json::to_string("a\u{9b}2J\u{1b}\u{202e}µ\u{7f}").unwrap();
        let plain = escaped(&text);
        assert!(!plain.chars().any(terminal::obeyed) && plain.contains("\\u009b2J"), "{plain}");
        assert_eq!(serde_json::from_str::<String>(&plain).unwrap(), serde_json::from_str::<String>(&text).unwrap());
    }
}
