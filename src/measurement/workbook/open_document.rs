//! Workbooks of LibreOffice and others: all sheets in one part, where equal cells and rows that follow each other stand
//! once.

use super::archive::Archive;
use super::grid::Grid;
use super::xml::{Piece, Pieces, attribute, name};
use super::{Names, Read};
use quick_xml::events::BytesStart;

const CONTENT: &str = "content.xml";

/// Names of the sheets and their positions.
pub(super) fn names(archive: &mut Archive<'_>) -> Read<Names> {
    let text = archive.text(CONTENT)?;
    let mut pieces = Pieces::of(&text);
    let mut names = Vec::new();
    while let Some(piece) = pieces.next()? {
        if let Piece::Start(element) = piece
            && name(&element) == "table"
        {
            names.push((attribute(&element, "name").unwrap_or_default(), names.len().to_string()));
        }
    }
    Ok(Names(names))
}

/// A cell while it is read.
#[derive(Default)]
struct Cell {
    times: usize,
    /// The value where it is no text.
    value: Option<String>,
    text: String,
}

/// The text of a sheet.
pub(super) fn text(archive: &mut Archive<'_>, position: &str) -> Read<String> {
    let text = archive.text(CONTENT)?;
    let mut pieces = Pieces::of(&text);
    let mut grid = Grid::default();
    let (mut tables, mut at) = (0usize, 0usize);
    let mut times = 1;
    let mut cell: Option<Cell> = None;
    // How deep in remarks, which are not part of a cell, and in paragraphs, which are.
    let (mut aside, mut inside) = (0usize, 0usize);
    while let Some(piece) = pieces.next()? {
        let ours = tables > 0 && (tables - 1).to_string() == position;
        match piece {
            Piece::Start(element) => match name(&element) {
                "table" => tables += 1,
                "table-row" if ours => (times, at) = (repeated(&element, "number-rows-repeated")?, 0),
                "table-cell" | "covered-table-cell" if ours => {
                    let times = repeated(&element, "number-columns-repeated")?;
                    let keys = ["value", "boolean-value", "date-value", "time-value"];
                    let value = keys.into_iter().find_map(|key| attribute(&element, key));
                    cell = Some(Cell { times, value, text: String::new() });
                }
                "annotation" => aside += 1,
                "p" => inside += 1,
                _ => {}
            },
            Piece::End(element) => match name(&element) {
                "table" if ours => break,
                "table-row" if ours => grid.end_row(times)?,
                "table-cell" | "covered-table-cell" if ours => {
                    let Some(Cell { times, value, text }) = cell.take() else { continue };
                    let value = value.unwrap_or(text);
                    for column in at..at.saturating_add(if value.trim().is_empty() { 0 } else { times }) {
                        grid.cell(column, value.trim())?;
                    }
                    at = at.saturating_add(times);
                }
                "annotation" => aside = aside.saturating_sub(1),
                "p" => inside = inside.saturating_sub(1),
                _ => {}
            },
            Piece::Text(words) => {
                if let Some(cell) = &mut cell
                    && aside == 0
                    && inside > 0
                {
                    cell.text += &words;
                }
            }
        }
    }
    grid.text()
}

/// How many times a cell or a row stands.
fn repeated(element: &BytesStart<'_>, key: &str) -> Read<usize> {
    let written = attribute(element, key).unwrap_or_else(|| "1".into());
    written.parse().map_err(|_| format!("it repeats something {written} times"))
}
