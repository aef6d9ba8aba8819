//! Where the JSON of a command goes.

use crate::compare::COMPARATOR;
use crate::error::{Error, Result};
use crate::files;
use crate::gate::Judged;
use serde::Serialize;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A result with what judged it.
#[derive(Debug, Serialize)]
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

    /// Writes a value; `inputs` are files that must not be replaced.
    pub fn write(&self, value: &impl Serialize, inputs: &[&Path]) -> Result<()> {
        let mut text = serde_json::to_string_pretty(value).map_err(|why| Error::Unfinished(why.to_string()))?;
        text.push('\n');
        if self.to_standard_output() {
            // A reader that has gone is no error of the command.
            let _ = std::io::stdout().lock().write_all(text.as_bytes());
            return Ok(());
        }
        let same = |input: &&Path| matches!((input.canonicalize(), self.0.canonicalize()), (Ok(a), Ok(b)) if a == b);
        if let Some(input) = inputs.iter().copied().find(same) {
            return Err(Error::Input(format!(
                "error: {} is an input and is not overwritten\n  = help: give --json another file",
                input.display()
            )));
        }
        files::replace(&self.0, text.as_bytes())
    }
}
