//! The folder of results: what was written there is remembered, so that a cache can keep it.

use super::drawn::Drawn;
use crate::error::Result;
use crate::files;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Mutex;

/// A folder that files are written below.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    drawn: Drawn,
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
    /// The folder at a path, in which nothing has been written yet.
    pub fn new(path: &Path) -> Self {
        Self::of(path, &Drawn::default())
    }

    /// The same, with what is wanted of every figure.
    pub fn of(path: &Path, drawn: &Drawn) -> Self {
        Self { path: path.to_path_buf(), drawn: drawn.clone(), written: Mutex::default() }
    }

    /// What is wanted of every figure.
    pub fn drawn(&self) -> &Drawn {
        &self.drawn
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file `name` below the folder.
    ///
    /// # Errors
    /// [`crate::error::Error::Io`] where the operating system refuses.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        files::replace(&self.path.join(name), bytes)?;
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
            Some(bytes) => files::replace(&self.path.join(name), &bytes).map(|()| true),
            None => Ok(false),
        }
    }

    /// What was written under a name.
    pub fn written(&self, name: &str) -> Option<Content> {
        self.written.lock().ok()?.get(name).cloned()
    }
}
