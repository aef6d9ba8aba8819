//! Sheets of Excel and OpenDocument workbooks, behind the cargo feature `xlsx`.
//!
//! A sheet is written out as text with tabs, one line per row, and read like every other table.

use std::path::Path;

use super::sheet::Sheet;
use crate::error::{Error, Result};
use crate::scenario::diagnostic::whole_file;

/// The named sheet of a workbook, or its first.
#[cfg(not(feature = "xlsx"))]
pub(crate) fn sheet(path: &Path, _: &[u8], _: Option<&str>, _: &mut Vec<String>) -> Result<Sheet> {
    let title = format!("`{}` is a workbook, and this program was built without support for them", path.display());
    let help = "export the sheet as CSV, or install with `cargo install stickslip --features xlsx`";
    Err(Error::Input(whole_file(&title, help)))
}

/// The named sheet of a workbook, or its first.
#[cfg(feature = "xlsx")]
pub(crate) fn sheet(path: &Path, bytes: &[u8], wanted: Option<&str>, notes: &mut Vec<String>) -> Result<Sheet> {
    use crate::scenario::diagnostic::{nearest, quote};
    use crate::scenario::source::Source;
    use calamine::Reader as _;

    let file = path.display().to_string();
    let refuse = |title: String, help: &str| Error::Input(whole_file(&title, help));
    let broken = |error: calamine::Error| {
        refuse(
            format!("cannot read the workbook `{file}`: {error}"),
            "open it, save it again, or export the sheet as CSV",
        )
    };
    let mut workbook = calamine::open_workbook_auto_from_rs(std::io::Cursor::new(bytes)).map_err(broken)?;
    let names = workbook.sheet_names();
    let name = match wanted {
        None => names.first().cloned().ok_or_else(|| refuse(format!("`{file}` has no sheets"), "add the table"))?,
        Some(wanted) if names.iter().any(|name| name == wanted) => wanted.to_string(),
        Some(wanted) => {
            let near = nearest(wanted, names.iter().map(String::as_str));
            let near = near.map_or(String::new(), |name| format!("did you mean `{name}`? "));
            let help = format!("{near}the workbook has the sheets {}", names.join(", "));
            return Err(refuse(format!("`{file}` has no sheet {}", quote(wanted)), &help));
        }
    };
    let range = workbook.worksheet_range(&name).map_err(broken)?;
    if wanted.is_none() && names.len() > 1 {
        notes.push(format!("of {} sheets the first, `{name}`, is read", names.len()));
    }
    let Some((rows, columns)) = range.end() else {
        return Err(refuse(format!("the sheet `{name}` of `{file}` is empty"), "choose another with sheet = \"…\""));
    };
    let mut text = String::new();
    for row in 0..=rows {
        let cells = (0..=columns).map(|column| range.get_value((row, column)).map_or(String::new(), written));
        let line = cells.collect::<Vec<_>>().join("\t");
        text += line.trim_end_matches('\t');
        text.push('\n');
    }
    let source =
        Source { name: format!("{file} (sheet {name})"), path: path.into(), text: padded(&text, columns as usize) };
    let mut sheet = super::delimited::sheet(source, Some(b'\t'))?;
    sheet.workbook = true;
    Ok(sheet)
}

/// The cell as text that can stand between tabs.
#[cfg(feature = "xlsx")]
fn written(cell: &calamine::Data) -> String {
    match cell {
        calamine::Data::Float(value) => format!("{value}"),
        other => other.to_string().replace(['\t', '\n', '\r', '"'], " "),
    }
}

/// Rows that end in empty cells keep them, blank rows stay blank.
#[cfg(feature = "xlsx")]
fn padded(text: &str, tabs: usize) -> String {
    let width = text.lines().find(|line| !line.is_empty()).map_or(0, |line| line.matches('\t').count()).min(tabs);
    let pad = |line: &str| {
        let missing = if line.is_empty() { 0 } else { width.saturating_sub(line.matches('\t').count()) };
        format!("{line}{}\n", "\t".repeat(missing))
    };
    text.lines().map(pad).collect()
}
