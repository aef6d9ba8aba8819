//! The folder of results: what was written there is remembered, so that a cache can keep it.

use super::figure_output::FigureOutput;
use crate::error::{Error, Result};
use crate::results::Results;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Mutex;

/// Names in the folder of a report that are no scenario's.
pub const RESERVED: [&str; 5] = {
    let [main, trials, checks] = crate::report::PAGES;
    [main, trials, checks, "report.json", crate::results::LIST]
};

/// A folder that files are written below.
#[derive(Debug)]
pub struct Folder {
    results: Results,
    drawn: FigureOutput,
    written: Mutex<BTreeMap<String, Content>>,
}

/// What stands in a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Content {
    /// Text.
    Text(String),
    /// Anything else, in base64.
    Base64(String),
}

impl Content {
    fn of(bytes: &[u8]) -> Self {
        match std::str::from_utf8(bytes) {
            Ok(text) => Self::Text(text.into()),
            Err(_) => Self::Base64(STANDARD.encode(bytes)),
        }
    }

    /// The text, where it is one.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            Self::Base64(_) => None,
        }
    }
}

impl Folder {
    /// The folder at a path, where no file takes the place of one of the `inputs`, with what is wanted of every figure.
    ///
    /// # Errors
    /// Those of [`Results::open`].
    pub fn open<'a>(path: &Path, drawn: &FigureOutput, inputs: impl IntoIterator<Item = &'a Path>) -> Result<Self> {
        Ok(Self { results: Results::open(path, inputs)?, drawn: drawn.clone(), written: Mutex::default() })
    }

    /// Complains where a file that is asked for by an option lies where results go: it may lie in the folder under a
    /// name of its own, not deeper.
    ///
    /// # Errors
    /// [`Error::Input`] naming the option.
    pub fn apart(path: &Path, option: &str, file: &Path) -> Result<()> {
        let (folder, place) = (resolved(path), resolved(file));
        let Ok(below) = place.strip_prefix(&folder) else { return Ok(()) };
        if below.components().count() != 1 || RESERVED.iter().any(|name| below == Path::new(name)) {
            return Err(Error::Input(format!(
                "error: {option} names {}, where results of this run go\n  = help: give {option} another file",
                file.display()
            )));
        }
        Ok(())
    }

    /// What is wanted of every figure.
    pub fn drawn(&self) -> &FigureOutput {
        &self.drawn
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.results.path()
    }

    /// Writes the file `name` below the folder.
    ///
    /// # Errors
    /// [`crate::error::Error::Io`] where the operating system refuses.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.results.write(name, bytes)?;
        if let Ok(mut written) = self.written.lock() {
            written.insert(name.into(), Content::of(bytes));
        }
        Ok(())
    }

    /// Writes a file as it was kept; whether its name is one below the folder and its content is whole.
    ///
    /// # Errors
    /// [`crate::error::Error::Io`] where the operating system refuses.
    pub fn restore(&self, name: &str, content: &Content) -> Result<bool> {
        let inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        let bytes = match content {
            Content::Text(text) => Some(text.clone().into_bytes()),
            Content::Base64(text) => STANDARD.decode(text).ok(),
        };
        match bytes.filter(|_| inside && !name.is_empty()) {
            Some(bytes) => self.results.write(name, &bytes).map(|()| true),
            None => Ok(false),
        }
    }

    /// What was written under a name.
    pub fn written(&self, name: &str) -> Option<Content> {
        self.written.lock().ok()?.get(name).cloned()
    }
}

/// The path without links, of which the end need not exist yet.
fn resolved(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.into());
    let found = path.ancestors().find_map(|above| Some((above, above.canonicalize().ok()?)));
    let whole = found.and_then(|(above, real)| Some(real.join(path.strip_prefix(above).ok()?)));
    // Joining nothing leaves a slash at the end.
    whole.map_or(path, |whole| whole.components().collect())
}
