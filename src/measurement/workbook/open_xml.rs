//! Workbooks of Excel: a list of sheets, strings that cells share, and a part for each sheet.

use std::collections::BTreeMap;

use super::archive::Archive;
use super::grid::Grid;
use super::xml::{Piece, Pieces, attribute, name};
use super::{Names, Read};
use crate::measurement::sheet::{MAX_COLUMNS, MAX_ROWS};

const MAIN: &str = "xl/workbook.xml";

/// Names of the sheets and their parts.
pub(super) fn names(archive: &mut Archive<'_>) -> Read<Names> {
    if !archive.holds(MAIN) {
        return Err("it is no workbook of Excel or OpenDocument".into());
    }
    let parts = relations(archive)?;
    let text = archive.text(MAIN)?;
    let mut pieces = Pieces::of(&text);
    let mut names = Vec::new();
    while let Some(piece) = pieces.next()? {
        let Piece::Start(element) = piece else { continue };
        if name(&element) == "sheet"
            && let (Some(name), Some(id)) = (attribute(&element, "name"), attribute(&element, "id"))
            && let Some((_, part)) = parts.get(&id)
        {
            names.push((name, part.clone()));
        }
    }
    Ok(Names(names))
}

/// Kinds and names of the parts that belong to the workbook, by their identifiers.
fn relations(archive: &mut Archive<'_>) -> Read<BTreeMap<String, (String, String)>> {
    let text = archive.text("xl/_rels/workbook.xml.rels")?;
    let mut pieces = Pieces::of(&text);
    let mut found = BTreeMap::new();
    while let Some(piece) = pieces.next()? {
        let Piece::Start(element) = piece else { continue };
        let [id, kind, target] = ["Id", "Type", "Target"].map(|key| attribute(&element, key));
        if let (Some(id), Some(kind), Some(target)) = (id, kind, target) {
            let part = target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), String::from);
            found.insert(id, (kind, part));
        }
    }
    Ok(found)
}

/// The text of a sheet.
pub(super) fn text(archive: &mut Archive<'_>, part: &str) -> Read<String> {
    let shared = shared(archive)?;
    let text = archive.text(part)?;
    let mut pieces = Pieces::of(&text);
    let mut grid = Grid::default();
    let mut cell: Option<Cell> = None;
    while let Some(piece) = pieces.next()? {
        match (piece, &mut cell) {
            (Piece::Start(element), _) if name(&element) == "row" => {
                if let Some(row) = attribute(&element, "r") {
                    grid.go_to(place(&row).0.ok_or_else(|| format!("there is no row {row}"))?)?;
                }
            }
            (Piece::End(element), _) if name(&element) == "row" => grid.end_row(1)?,
            (Piece::Start(element), _) if name(&element) == "c" => {
                let column = match attribute(&element, "r") {
                    Some(at) => match place(&at) {
                        (Some(row), Some(column)) if row == grid.rows() => column,
                        _ => return Err(format!("row {} has a cell {at}", grid.rows() + 1)),
                    },
                    None => grid.cells(),
                };
                let kind = attribute(&element, "t").unwrap_or_default();
                cell = Some(Cell { column, kind, text: String::new(), inside: false });
            }
            (Piece::Start(element), Some(cell)) if matches!(name(&element), "v" | "t") => cell.inside = true,
            (Piece::End(element), Some(cell)) if matches!(name(&element), "v" | "t") => cell.inside = false,
            (Piece::Text(text), Some(cell)) if cell.inside => cell.text += &text,
            (Piece::End(element), Some(_)) if name(&element) == "c" => {
                let Some(cell) = cell.take() else { continue };
                let value = cell.value(&shared)?;
                if !value.is_empty() {
                    grid.cell(cell.column, &value)?;
                }
            }
            (Piece::End(element), _) if name(&element) == "sheetData" => break,
            _ => {}
        }
    }
    grid.text()
}

/// A cell while it is read.
struct Cell {
    column: usize,
    kind: String,
    text: String,
    /// Whether text that follows is its value.
    inside: bool,
}

impl Cell {
    fn value(&self, shared: &Shared) -> Read<String> {
        Ok(match (self.kind.as_str(), self.text.trim()) {
            ("s", at) => shared.get(at).ok_or_else(|| format!("it has no shared text {at}"))?.into(),
            ("b", "0") => "false".into(),
            ("b", _) => "true".into(),
            ("" | "n", number) => match number.parse::<f64>() {
                Ok(value) if value.is_finite() => value.to_string(),
                _ => number.into(),
            },
            (_, text) => text.into(),
        })
    }
}

/// Row and column of a reference such as `C5`, counted from 0, where it names them.
fn place(reference: &str) -> (Option<usize>, Option<usize>) {
    let letters = reference.bytes().take_while(u8::is_ascii_alphabetic).count();
    let (column, row) = reference.split_at(letters);
    let add =
        |sum: usize, letter: u8| (26 * sum + usize::from(letter.to_ascii_uppercase() - b'A') + 1).min(MAX_COLUMNS + 1);
    let column = column.bytes().fold(0, add).checked_sub(1).filter(|column| *column < MAX_COLUMNS);
    let digits = !row.is_empty() && row.bytes().all(|byte| byte.is_ascii_digit());
    let row = row.parse::<usize>().ok().filter(|row| digits && (1..=MAX_ROWS).contains(row));
    (row.map(|row| row - 1), column)
}

/// Texts that cells share, one after the other, and where each ends.
#[derive(Default)]
struct Shared {
    text: String,
    ends: Vec<u32>,
}

impl Shared {
    fn get(&self, at: &str) -> Option<&str> {
        let at: usize = at.parse().ok()?;
        let from = if at == 0 { 0 } else { *self.ends.get(at - 1)? };
        self.text.get(from as usize..*self.ends.get(at)? as usize)
    }
}

fn shared(archive: &mut Archive<'_>) -> Read<Shared> {
    let mut shared = Shared::default();
    let parts = relations(archive)?;
    let Some((_, part)) = parts.values().find(|(kind, _)| kind.ends_with("/sharedStrings")) else { return Ok(shared) };
    if !archive.holds(part) {
        return Ok(shared);
    }
    let text = archive.text(part)?;
    let mut pieces = Pieces::of(&text);
    // How deep in phonetic readings, which are not part of the text.
    let (mut inside, mut aside) = (false, 0usize);
    while let Some(piece) = pieces.next()? {
        match piece {
            Piece::Start(element) => match name(&element) {
                "t" => inside = true,
                "rPh" => aside += 1,
                _ => {}
            },
            Piece::End(element) => match name(&element) {
                "t" => inside = false,
                "rPh" => aside = aside.saturating_sub(1),
                "si" => shared.ends.push(shared.text.len() as u32),
                _ => {}
            },
            Piece::Text(text) if inside && aside == 0 => shared.text += &text,
            Piece::Text(_) => {}
        }
    }
    Ok(shared)
}

#[cfg(test)]
mod tests {
    use super::place;

    #[test]
    fn references_name_cells_of_a_sheet_or_nothing() {
        assert_eq!(place("A1"), (Some(0), Some(0)));
        assert_eq!(place("xfd1048576"), (Some(MAX_ROW), Some(16383)));
        assert_eq!(place("7"), (Some(6), None));
        for nothing in ["", "A", "A0", "A+1", "A1048577", "-1", "1A", "Ä1", "A1:B2", "A99999999999999999999999"] {
            assert_eq!(place(nothing).0, None, "{nothing}");
        }
        assert_eq!(place("XFE1"), (Some(0), None));
        assert_eq!(place(&"Z".repeat(100_000)), (None, None));
    }

    const MAX_ROW: usize = 1_048_575;
}
