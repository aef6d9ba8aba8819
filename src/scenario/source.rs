//! The text of a scenario file, from disk or from the binary, read with suspicion.

use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

pub(crate) use super::diagnostic::Source;
use super::diagnostic::whole_file;
use super::embedded;
use crate::error::{Error, Result};

/// Largest scenario file that is read.
pub(crate) const MAX_BYTES: u64 = 1 << 20;

/// Where files come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Store {
    /// The file system.
    Disk,
    /// The scenarios inside the binary, named as below `scenarios/`.
    Embedded,
}

impl Store {
    /// Reads one file; its absence, size, kind or encoding may be at fault.
    pub fn read(self, path: &Path) -> Result<Source> {
        match self {
            Self::Disk => from_disk(path),
            Self::Embedded => {
                let name = path.to_string_lossy().replace('\\', "/");
                let text = embedded::file(&name).ok_or_else(|| {
                    let title = format!("no embedded scenario file `{name}`");
                    Error::Input(whole_file(&title, "the embedded scenarios are listed by `stickslip check`"))
                })?;
                Ok(Source { name, path: path.into(), text: text.into() })
            }
        }
    }

    /// The path without `.` and `..`, with links followed on disk, so that two names of one file compare equal.
    pub fn resolve(self, path: &Path) -> PathBuf {
        let found = if self == Self::Disk { path.canonicalize().ok() } else { None };
        found.unwrap_or_else(|| {
            let absolute =
                if self == Self::Disk { std::path::absolute(path).unwrap_or(path.into()) } else { path.into() };
            tidy(&absolute)
        })
    }
}

/// The path with `.` and `..` worked out as text; a `..` that leads above the start is kept.
pub(crate) fn tidy(path: &Path) -> PathBuf {
    let mut tidied = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(tidied.components().next_back(), Some(Component::Normal(_))) => {
                tidied.pop();
            }
            other => tidied.push(other),
        }
    }
    tidied
}

fn from_disk(path: &Path) -> Result<Source> {
    let name = path.display().to_string();
    let refuse = |title: String, help: &str| Err(Error::Input(whole_file(&title, help)));
    let metadata = std::fs::metadata(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => Error::Input(whole_file(
            &format!("there is no scenario file `{name}`"),
            "check the spelling and the current folder; `stickslip init` writes scenarios to start from",
        )),
        _ => Error::io("read", path)(error),
    })?;
    if metadata.is_dir() {
        return refuse(format!("`{name}` is a folder, not a scenario file"), "name one of the .toml files in it");
    }
    if !metadata.is_file() {
        return refuse(format!("`{name}` is not an ordinary file"), "save the scenario as a .toml file first");
    }
    if metadata.len() > MAX_BYTES {
        let size = metadata.len() as f64 / 1e6;
        let help = "a scenario is a short text file; is this a table of measurements? Then name it under [measurement]";
        return refuse(format!("`{name}` is too large for a scenario: {size:.1} MB, at most 1 MB is read"), help);
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(Error::io("read", path))?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count() + 1;
            let title = format!("`{name}` is not UTF-8 text: byte {at} (line {line}) does not belong to any character");
            return refuse(title, "save the file as UTF-8 in a text editor, or check that it is not a binary file");
        }
    };
    let text = text.strip_prefix('\u{feff}').map_or_else(|| text.clone(), String::from);
    if text.trim().is_empty() {
        return refuse(format!("`{name}` is empty"), "`stickslip init` writes a commented scenario to start from");
    }
    Ok(Source { name, path: path.into(), text })
}
