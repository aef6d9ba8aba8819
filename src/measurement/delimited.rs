//! Tables of text: CSV and its relatives with semicolons or tabs. Rows are taken apart as they are needed and not kept.

use super::preamble::bare;
use super::sheet::{Complaints, MAX_COLUMNS, MAX_ROWS, Row, Sheet, records};
use super::unit::units_of;
use crate::error::{Error, Result};
use crate::scenario::diagnostic::{Place, whole_file};
use crate::scenario::source::Source;
use crate::units::count;

/// Takes the text apart; the separator is told by the header line unless it is known.
pub(crate) fn sheet(mut source: Source, delimiter: Option<u8>) -> Result<Sheet> {
    let told = bare(&mut source.text);
    let delimiter = delimiter.unwrap_or_else(|| separator(first_line(&source.text)));
    check_width(&source, delimiter)?;
    let mut first = records(&source.text, delimiter);
    let Some(mut header) = first.next() else {
        let help = "a table has a header line and one row per steady state";
        return Err(Error::Input(whole_file(&format!("`{}` holds nothing but remarks", source.name), help)));
    };
    while header.cells.last().is_some_and(String::is_empty) {
        header.cells.pop();
    }
    let units = first.next().and_then(|row| units_of(&row.cells, header.cells.len())).unwrap_or_default();
    drop(first);
    let mut sheet = Sheet { source, delimiter, workbook: false, header, units, count: 0, told };
    sheet.count = check_shape(&sheet)?;
    Ok(sheet)
}

/// No line has more cells than a sheet has columns.
fn check_width(source: &Source, delimiter: u8) -> Result<()> {
    let cells = |line: &str| 1 + line.bytes().filter(|byte| *byte == delimiter).count();
    let widest =
        source.text.lines().enumerate().map(|(at, line)| (cells(line), at + 1)).find(|(n, _)| *n > MAX_COLUMNS);
    let Some((cells, line)) = widest else { return Ok(()) };
    let title = format!("`{}`, line {line}: the row has {cells} cells, at most {MAX_COLUMNS} are read", source.name);
    Err(Error::Input(whole_file(&title, "a table has a column for each quantity; is this another kind of file?")))
}

/// The first line that is neither blank nor a remark.
fn first_line(text: &str) -> &str {
    text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or("")
}

/// What separates the cells of a header: semicolons before tabs before commas, quotes and brackets apart.
fn separator(header: &str) -> u8 {
    let (mut quoted, mut depth) = (false, 0i32);
    let mut found = [false; 2];
    for byte in header.bytes() {
        match byte {
            b'"' => quoted = !quoted,
            b'[' | b'(' => depth += 1,
            b']' | b')' => depth -= 1,
            b';' if !quoted && depth <= 0 => found[0] = true,
            b'\t' if !quoted => found[1] = true,
            _ => {}
        }
    }
    match found {
        [true, _] => b';',
        [_, true] => b'\t',
        _ => b',',
    }
}

/// A header of words, rows below it, each as wide as the header; tells how many there are.
fn check_shape(sheet: &Sheet) -> Result<usize> {
    let mut complaints = Complaints::of(&sheet.source);
    // Blanks may part the numbers.
    let numbers = |cell: &String| cell.split_whitespace().all(|part| part.replace(',', ".").parse::<f64>().is_ok());
    if sheet.header.cells.iter().all(numbers) {
        let help = "write a line above them that names every column, such as `f [Hz],A [um],phase [deg]`, `f [Hz],U [V],a [m/s^2]`, \
                    `f [Hz],S21 [dB],phase [deg]` or `f [Hz],X [V],Y [V]`; of rigs with a contact also speed [m/s] and load [N], of moduli \
                    `frequency [Hz],storage [MPa],loss [MPa]`";
        let place = sheet.row_place(&sheet.header);
        complaints.add(&place, "the table has no header", "numbers where names are needed", help);
        return complaints.check().map(|()| 0);
    }
    if lies_on_its_side(sheet) {
        let help = "turn it: a column for each quantity, named in the first row, and one row per steady state";
        let place = sheet.row_place(&sheet.header);
        complaints.add(&place, "the table lies on its side", "each row below begins with a name, numbers follow", help);
        return complaints.check().map(|()| 0);
    }
    let mut rows = 0;
    for row in sheet.untrimmed() {
        rows += 1;
        if rows > MAX_ROWS {
            let title = format!("`{}` has more than {MAX_ROWS} rows", sheet.source.name);
            let help = "one row per steady state is needed, not the recording in time";
            return Err(Error::Input(whole_file(&title, help)));
        }
        check_row(sheet, &row, &mut complaints);
    }
    if rows == 0 {
        let place = sheet.row_place(&sheet.header);
        let help = "write one row per steady state below the header";
        complaints.add(&place, "the table has a header but no rows", "nothing follows", help);
    }
    complaints.check().map(|()| rows)
}

/// Whether most rows are a name with numbers behind it, below a header that names no columns of such numbers.
fn lies_on_its_side(sheet: &Sheet) -> bool {
    let number = |cell: &String| cell.replace(',', ".").parse::<f64>().is_ok();
    let named = |cells: &[String]| match cells {
        [name, numbers @ ..] => {
            !name.is_empty()
                && !number(name)
                && numbers.iter().filter(|c| number(c)).count() >= 2
                && numbers.iter().all(|c| c.is_empty() || number(c))
        }
        [] => false,
    };
    let header = &sheet.header.cells;
    if header.len() > 1 && !named(header) {
        return false;
    }
    let of = |row: Row| named(&row.cells);
    let (mut rows, mut all) = (0, 0);
    for is_named in sheet.untrimmed().map(of) {
        (rows, all) = (rows + usize::from(is_named), all + 1);
    }
    rows > 1 && 2 * rows >= all
}

/// A row has as many cells as the header; empty ones may follow.
fn check_row(sheet: &Sheet, row: &Row, complaints: &mut Complaints<'_>) {
    let width = sheet.header.cells.len();
    let cells = row.cells.len();
    let surplus = row.cells.iter().skip(width).position(|cell| !cell.is_empty());
    let cause = (cells, if surplus.is_some() { "surplus" } else { "lacking" });
    if cells >= width && surplus.is_none() || complaints.again(cause, row.line) {
        return;
    }
    let title = format!("the row has {}, the header has {width}", count(cells, "cell"));
    let (place, label) = match surplus {
        Some(at) => (sheet.place(row, width + at), "no column belongs to this".to_string()),
        None => {
            let end = sheet.row_place(row).span.end;
            (Place { file: 0, span: end..end }, format!("{} missing", count(width - cells, "cell")))
        }
    };
    let help = if surplus.is_some() && sheet.delimiter == b',' {
        "every row needs one cell per column; if these are decimal commas, separate the cells by semicolons or tabs"
    } else {
        "every row needs one cell per column; leave the cell empty where an optional reading is missing"
    };
    complaints.add_row(cause, row.line, &place, [&title, &label, help]);
}
