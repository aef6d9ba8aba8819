//! Cells in order become lines of text with tabs.

use super::Read;
use crate::measurement::file::MAX_BYTES;
use crate::measurement::sheet::{MAX_COLUMNS, MAX_ROWS};

/// The sheet so far.
#[derive(Default)]
pub(super) struct Grid {
    text: String,
    /// The line of the row that is read, and how many cells it has.
    line: String,
    cells: usize,
    /// Rows that are complete, the last of which may be blank and not written yet.
    rows: usize,
    blank: usize,
    /// Cells of the first row that holds any: others that end in empty cells keep them.
    width: usize,
}

impl Grid {
    /// How many rows are complete.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Cells of the row that is read.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// A cell of the row that is read, counted from 0; those left out are empty.
    pub fn cell(&mut self, column: usize, value: &str) -> Read<()> {
        if column >= MAX_COLUMNS {
            return Err(format!("row {} has a cell beyond column {MAX_COLUMNS}", self.rows + 1));
        }
        if column < self.cells {
            return Err(format!("the cells of row {} stand in no order", self.rows + 1));
        }
        let tabs = column - self.cells + usize::from(self.cells > 0);
        self.line.extend(std::iter::repeat_n('\t', tabs));
        self.line.extend(value.chars().map(|c| if matches!(c, '\t' | '\n' | '\r' | '"' | '\0') { ' ' } else { c }));
        self.cells = column + 1;
        self.room(self.line.len())
    }

    /// The row is complete, and stands so many times.
    pub fn end_row(&mut self, times: usize) -> Read<()> {
        let (line, cells) = (std::mem::take(&mut self.line), std::mem::take(&mut self.cells));
        self.rows = self.rows.saturating_add(times);
        if line.trim().is_empty() {
            self.blank = self.blank.saturating_add(times);
            return Ok(());
        }
        if self.rows > MAX_ROWS {
            return Err(format!("it has more than {MAX_ROWS} rows"));
        }
        if self.width == 0 {
            self.width = cells;
        }
        self.text.extend(std::iter::repeat_n('\n', std::mem::take(&mut self.blank)));
        let tabs = self.width.saturating_sub(cells);
        for _ in 0..times {
            self.text += &line;
            self.text.extend(std::iter::repeat_n('\t', tabs));
            self.text.push('\n');
            self.room(0)?;
        }
        Ok(())
    }

    /// Blank rows up to a row, counted from 0.
    pub fn go_to(&mut self, row: usize) -> Read<()> {
        let skipped = row.checked_sub(self.rows).ok_or_else(|| format!("row {} stands twice or too late", row + 1))?;
        if self.cells > 0 { Err(format!("row {} does not end", self.rows + 1)) } else { self.end_row(skipped) }
    }

    /// The text of the whole sheet.
    pub fn text(mut self) -> Read<String> {
        self.end_row(1)?;
        Ok(self.text)
    }

    fn room(&self, more: usize) -> Read<()> {
        let fits = (self.text.len() + more) as u64 <= MAX_BYTES;
        if fits { Ok(()) } else { Err("the sheet is too large for a table of steady states".into()) }
    }
}
