//! Tables of text: CSV and its relatives with semicolons or tabs.

use super::sheet::{Complaints, Row, Sheet};
use super::unit::{gravity, known};
use crate::error::{Error, Result};
use crate::scenario::diagnostic::{Place, whole_file};
use crate::scenario::source::Source;
use crate::units::count;

/// Takes the text apart; the separator is told by the header line unless it is known.
pub(crate) fn sheet(source: Source, delimiter: Option<u8>) -> Result<Sheet> {
    let delimiter = delimiter.unwrap_or_else(|| separator(first_line(&source.text)));
    let mut records = records(&source, delimiter)?;
    if records.is_empty() {
        let help = "a table has a header line and one row per steady state";
        return Err(Error::Input(whole_file(&format!("`{}` holds nothing but remarks", source.name), help)));
    }
    let mut header = records.remove(0);
    while header.cells.last().is_some_and(String::is_empty) {
        header.cells.pop();
    }
    let units = records.first().and_then(|row| units_of(row, header.cells.len())).unwrap_or_default();
    if !units.is_empty() {
        records.remove(0);
    }
    let mut sheet = Sheet { source, delimiter, workbook: false, header, units, rows: records };
    check_shape(&sheet)?;
    let width = sheet.header.cells.len();
    for row in &mut sheet.rows {
        row.cells.truncate(width);
    }
    Ok(sheet)
}

/// The first line that is neither blank nor a remark.
fn first_line(text: &str) -> &str {
    text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or("")
}

/// The units that a row below the header states: nothing else stands in it.
fn units_of(row: &Row, width: usize) -> Option<Vec<String>> {
    let bare = |cell: &String| cell.trim_matches(['[', ']', '(', ')']).trim().to_string();
    let cells: Vec<String> =
        row.cells.iter().map(bare).map(|cell| if cell == "-" { String::new() } else { cell }).collect();
    let unit = |cell: &String| cell.is_empty() || cell == "%" || known(cell) || gravity(cell).is_some();
    let stated = cells.iter().filter(|cell| !cell.is_empty()).count();
    (stated > 1 && cells.len() == width && cells.iter().all(unit)).then_some(cells)
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

/// All records that hold anything, with their places.
fn records(source: &Source, delimiter: u8) -> Result<Vec<Row>> {
    let text = source.text.as_str();
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let (mut rows, mut line, mut counted) = (Vec::new(), 1, 0);
    for record in reader.records() {
        let record = record.map_err(|error| {
            let title = format!("cannot read `{}`: {error}", source.name);
            Error::Input(whole_file(&title, "check the quotes: every cell that opens one has to close it"))
        })?;
        let start = skip_remarks(text, record.position().map_or(0, |position| position.byte() as usize));
        line += text[counted..start].bytes().filter(|byte| *byte == b'\n').count();
        counted = start;
        let cells: Vec<String> = record.iter().map(String::from).collect();
        if cells.iter().any(|cell| !cell.is_empty()) {
            rows.push(Row { line, start, cells });
        }
    }
    Ok(rows)
}

/// Where the record really starts: its position counts blank lines and remarks before it.
fn skip_remarks(text: &str, mut at: usize) -> usize {
    loop {
        let rest = &text[at..];
        if !(rest.starts_with('#') || rest.starts_with('\n')) {
            return at;
        }
        match rest.find('\n') {
            Some(end) => at += end + 1,
            None => return text.len(),
        }
    }
}

/// A header of words, rows below it, each as wide as the header.
fn check_shape(sheet: &Sheet) -> Result<()> {
    let mut complaints = Complaints::of(&sheet.source);
    let width = sheet.header.cells.len();
    if sheet.header.cells.iter().all(|cell| cell.replace(',', ".").parse::<f64>().is_ok()) {
        let help = "the first line names the columns: speed_m_s, load_n, drive_m, frequency_hz, amplitude_rad, …; \
                    a line that begins with # is a remark, so a header must not";
        let place = sheet.row_place(&sheet.header);
        complaints.add(&place, "the table has no header", "numbers where names are needed", help);
        return complaints.check();
    }
    if sheet.rows.is_empty() {
        let place = sheet.row_place(&sheet.header);
        let help = "write one row per steady state below the header";
        complaints.add(&place, "the table has a header but no rows", "nothing follows", help);
    }
    for row in &sheet.rows {
        let cells = row.cells.len();
        let surplus = row.cells.iter().skip(width).position(|cell| !cell.is_empty());
        if cells >= width && surplus.is_none() {
            continue;
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
        let cause = (row.cells.len(), if surplus.is_some() { "surplus" } else { "lacking" });
        complaints.add_row(cause, row.line, &place, [&title, &label, help]);
    }
    complaints.check()
}
