//! The bytes of a measured file and their text; the file is opened for reading only.

use std::io::Read as _;
use std::path::Path;

use crate::error::{Error, Result};
use crate::scenario::diagnostic::whole_file;
use crate::scenario::embedded_text;
use crate::scenario::source::Source;

/// Largest table that is read.
pub(super) const MAX_BYTES: u64 = 64 << 20;

/// All bytes of an ordinary file of a sensible size.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>> {
    if let Some(text) = embedded_text(path) {
        return Ok(text.as_bytes().to_vec());
    }
    let name = path.display();
    let refuse = |title: String, help: &str| Err(Error::Input(whole_file(&title, help)));
    let metadata = std::fs::metadata(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => Error::Input(whole_file(
            &format!("there is no measurement table `{name}`"),
            "check its spelling; a path in a scenario is relative to the file that names it",
        )),
        _ => Error::io("read", path)(error),
    })?;
    if !metadata.is_file() {
        return refuse(format!("`{name}` is not an ordinary file"), "name the file that holds the table");
    }
    if metadata.len() > MAX_BYTES {
        let size = metadata.len() as f64 / 1e6;
        let title = format!("`{name}` is too large for a table of steady states: {size:.0} MB, at most 67 MB is read");
        return refuse(title, "one row per steady state is needed, not the recording in time");
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(Error::io("read", path))?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    Ok(bytes)
}

/// The bytes as text without byte order mark and with plain line ends; old encodings of western Europe are tolerated.
pub(crate) fn text(path: &Path, bytes: &[u8], notes: &mut Vec<String>) -> Result<Source> {
    let name = path.display().to_string();
    let refuse = |title: String, help: &str| Err(Error::Input(whole_file(&title, help)));
    let wide = utf_16(bytes);
    if wide.is_some() {
        notes.push("the file is UTF-16 text".into());
    }
    let bytes = wide.as_deref().map_or(bytes, str::as_bytes);
    if let Some(at) = bytes.iter().position(|byte| *byte == 0) {
        let help = "save the table as text: CSV, or a universal file (dataset 58)";
        return refuse(format!("`{name}` is a binary file: byte {at} is zero"), help);
    }
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text).to_string(),
        Err(_) => {
            notes.push("the file is not UTF-8 and was read as Latin-1".into());
            bytes.iter().map(|byte| char::from(*byte)).collect()
        }
    };
    if text.trim().is_empty() {
        return refuse(format!("`{name}` is empty"), "a table has a header line and one row per steady state");
    }
    let text = if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n") } else { text };
    Ok(Source { name, path: path.into(), text })
}

/// Text in UTF-16 with its byte order mark, as some programs write "Unicode".
fn utf_16(bytes: &[u8]) -> Option<String> {
    let of: fn([u8; 2]) -> u16 = match bytes {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return None,
    };
    let units = bytes[2..].chunks_exact(2).map(|pair| of([pair[0], pair[1]]));
    Some(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect())
}
