//! Sheets of Excel and OpenDocument workbooks (.xlsx, .xlsm, .ods).
//!
//! A sheet is written out as text with tabs, one line per row, and read like every other table. A workbook may be
//! damaged, or made to take all memory: its parts are unpacked up to the size of a table of text, cells are read one by
//! one, in order and within the dimensions of a sheet, and what they are written out to is no longer than a table of
//! text either.

mod archive;
mod grid;
mod open_document;
mod open_xml;
mod xml;

use std::path::Path;

use super::sheet::Sheet;
use crate::error::{Error, Result};
use crate::scenario::diagnostic::{MAX_TOLD, nearest, quote, whole_file};
use crate::scenario::source::Source;
use archive::Archive;

/// What is read of a workbook, or why it cannot be.
type Read<T> = std::result::Result<T, String>;

/// Names of the sheets of a workbook with what tells where each is.
struct Names(Vec<(String, String)>);

/// The named sheet of a workbook, or its first.
pub(crate) fn sheet(path: &Path, bytes: &[u8], wanted: Option<&str>, notes: &mut Vec<String>) -> Result<Sheet> {
    let file = path.display().to_string();
    let refuse = |title: String, help: &str| Error::Input(whole_file(&title, help));
    if bytes.starts_with(&[0xd0, 0xcf, 0x11, 0xe0]) {
        let title = format!("`{file}` is a workbook of an old form, or protected by a password");
        return Err(refuse(title, "save it without a password as .xlsx or .ods, or export the sheet as CSV"));
    }
    let broken = |why: String| {
        refuse(
            format!("cannot read the workbook `{file}`: {why}"),
            "open it, save it again, or export the sheet as CSV",
        )
    };
    let mut archive = Archive::of(bytes).map_err(broken)?;
    let open_document = archive.holds("content.xml");
    let names = if open_document { open_document::names(&mut archive) } else { open_xml::names(&mut archive) };
    let Names(names) = names.map_err(broken)?;
    let chosen = match wanted {
        None => names.first().ok_or_else(|| refuse(format!("`{file}` has no sheets"), "add the table"))?,
        Some(wanted) => names.iter().find(|(name, _)| name == wanted).ok_or_else(|| {
            let near = nearest(wanted, names.iter().map(|(name, _)| name.as_str()));
            let near = near.map_or(String::new(), |name| format!("did you mean `{name}`? "));
            let list: Vec<&str> = names.iter().take(MAX_TOLD).map(|(name, _)| name.as_str()).collect();
            let help = format!("{near}the workbook has the sheets {}", list.join(", "));
            refuse(format!("`{file}` has no sheet {}", quote(wanted)), &help)
        })?,
    };
    let (name, place) = chosen;
    let read =
        if open_document { open_document::text(&mut archive, place) } else { open_xml::text(&mut archive, place) };
    let text = read.map_err(broken)?;
    if wanted.is_none() && names.len() > 1 {
        notes.push(format!("of {} sheets the first, {}, is read", names.len(), quote(name)));
    }
    if text.trim().is_empty() {
        let title = format!("the sheet {} of `{file}` is empty", quote(name));
        return Err(refuse(title, "choose another with sheet = \"…\""));
    }
    let shown = quote(name);
    let source = Source { name: format!("{file} (sheet {})", shown.trim_matches('`')), path: path.into(), text };
    let mut sheet = super::delimited::sheet(source, Some(b'\t'))?;
    sheet.workbook = true;
    Ok(sheet)
}
