//! A sheet of cells with their places, whatever file it came from.

use std::collections::BTreeSet;
use std::ops::Range;

use super::series::SEVERAL;
use crate::error::{Error, Result};
use crate::scenario::diagnostic::{MAX_TOLD, Place, Problems};
use crate::scenario::source::Source;
use crate::statistics::{median, spread};

/// Rows and columns of the largest sheet of the usual spreadsheets. More in a file is another kind of file, and a sheet
/// of a few bytes cannot ask for more memory than one that is full.
pub(crate) const MAX_ROWS: usize = 1 << 20;
pub(crate) const MAX_COLUMNS: usize = 1 << 14;

/// Header and rows of a table.
#[derive(Debug)]
pub(crate) struct Sheet {
    /// The text, for messages; of a workbook, its cells written with tabs.
    pub source: Source,
    /// What separates the cells in that text.
    pub delimiter: u8,
    /// Whether the text stands for a workbook, whose cells have names such as `C5`.
    pub workbook: bool,
    /// The header.
    pub header: Row,
    /// Units of the columns, where a row below the header states them.
    pub units: Vec<String>,
    /// How many rows hold anything.
    pub count: usize,
    /// What of the file is no part of it, in words.
    pub told: Vec<String>,
}

/// A row of cells.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Line in the file, counted from 1.
    pub line: usize,
    /// Byte where it starts in the text.
    pub start: usize,
    /// Trimmed cells.
    pub cells: Vec<String>,
}

impl Sheet {
    /// The rows that hold anything, each as wide as the header, taken apart anew.
    pub fn rows(&self) -> impl Iterator<Item = Row> {
        let width = self.header.cells.len();
        self.untrimmed().map(move |mut row| {
            row.cells.truncate(width);
            row
        })
    }

    /// The same with all their cells.
    pub(super) fn untrimmed(&self) -> impl Iterator<Item = Row> {
        records(&self.source.text, self.delimiter).skip(1 + usize::from(!self.units.is_empty()))
    }

    /// The header of a column with its unit, wherever that stands; without the trace that it is of, as in
    /// `CH1_S11_1=S21_dB`.
    pub fn headed(&self, index: usize) -> String {
        let header = &self.header.cells[index];
        let header = header.rsplit_once('=').map_or(header.as_str(), |(_, name)| name).to_string();
        match self.units.get(index).filter(|unit| !unit.is_empty()) {
            Some(unit) => format!("{header} [{unit}]"),
            None => header,
        }
    }

    /// The names of all columns without their units, plain.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.header.cells.iter().map(|header| super::header::plain(super::header::split(header).0))
    }

    /// The numbers of a column, of any decimal mark; what is none is left out.
    pub fn numbers(&self, index: usize) -> impl Iterator<Item = f64> {
        self.rows().filter_map(move |row| number(row.cells.get(index)?))
    }

    /// What its numbers are like, of every column, in one pass.
    pub fn tallies(&self) -> Vec<Tally> {
        let mut all = vec![Tally::default(); self.header.cells.len()];
        for row in self.rows() {
            for (tally, cell) in all.iter_mut().zip(&row.cells) {
                if let Some(number) = number(cell) {
                    tally.numbers += 1;
                    tally.negative += usize::from(number < 0.0);
                    tally.largest = tally.largest.max(number.abs());
                }
            }
        }
        all
    }

    /// How much a column changes from row to row, as a logarithm.
    pub fn change(&self, index: usize) -> f64 {
        change(self.numbers(index))
    }

    /// Whether a column changes by less than a resonance does between its peak and half power.
    pub fn is_narrow(&self, index: usize) -> bool {
        let (low, high) =
            self.numbers(index).fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x.abs()), h.max(x.abs())));
        high < std::f64::consts::SQRT_2 * low
    }

    /// Whether a column changes more than its ratio to another, which it then follows, as the signal of a sensor does;
    /// levels that were set do not.
    pub fn follows(&self, index: usize, other: usize) -> bool {
        let (own, of): (Vec<f64>, Vec<f64>) = (self.numbers(index).collect(), self.numbers(other).collect());
        let mut levels = own.clone();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let is_set = SEVERAL * levels.len() <= own.len();
        let ratios: Vec<f64> = own.iter().zip(&of).map(|(one, other)| one / other).collect();
        // Where rows go through the levels at one frequency after the other the ratio changes at the next one only.
        let is_one = spread(ratios.iter().copied(), ratios.first().copied().unwrap_or(0.0)) == 0.0;
        let changes_more = self.change(index) > change(ratios.into_iter());
        own.len() == of.len() && changes_more && (!is_set || is_one)
    }

    /// Place of a cell; of the whole row where there is no such cell.
    pub fn place(&self, row: &Row, index: usize) -> Place {
        let spans = spans(&self.source.text, row.start, self.delimiter);
        spans.get(index).map_or_else(|| self.row_place(row), |span| Place { file: 0, span: span.clone() })
    }

    /// Place of a whole row.
    pub fn row_place(&self, row: &Row) -> Place {
        let end = self.source.text[row.start..].find('\n').map_or(self.source.text.len(), |at| row.start + at);
        Place { file: 0, span: row.start..end }
    }

    /// The name of a cell in a workbook as the start of a label, e.g. `cell C5: `; nothing for other files.
    pub fn cell_name(&self, row: &Row, index: usize) -> String {
        if !self.workbook {
            return String::new();
        }
        let mut letters = Vec::new();
        let mut rest = index + 1;
        while rest > 0 {
            letters.insert(0, char::from(b'A' + ((rest - 1) % 26) as u8));
            rest = (rest - 1) / 26;
        }
        format!("cell {}{}: ", letters.iter().collect::<String>(), row.line)
    }
}

/// What the numbers of a column are like.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tally {
    /// How many cells hold one.
    pub numbers: usize,
    /// How many are negative.
    pub negative: usize,
    /// The largest of their sizes.
    pub largest: f64,
}

impl Tally {
    /// Whether all are zero.
    pub fn is_zero(&self) -> bool {
        self.numbers > 0 && self.largest == 0.0
    }

    /// Whether most are negative.
    pub fn is_negative(&self) -> bool {
        2 * self.negative > self.numbers
    }
}

/// A number of any decimal mark.
fn number(cell: &str) -> Option<f64> {
    cell.parse().ok().or_else(|| cell.replace('−', "-").replace(',', ".").parse().ok())
}

/// The median change of successive numbers, as a logarithm.
fn change(numbers: impl Iterator<Item = f64>) -> f64 {
    let numbers: Vec<f64> = numbers.collect();
    let changes = numbers.windows(2).map(|pair| (pair[1] / pair[0]).abs().ln().abs());
    median(changes.filter(|change| change.is_finite()))
}

/// All records that hold anything, with their places. The text is valid, and so are they.
pub(super) fn records(text: &str, delimiter: u8) -> impl Iterator<Item = Row> {
    let reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let (mut line, mut counted) = (1, 0);
    let row = move |record: csv::StringRecord| {
        let start = skip_remarks(text, record.position().map_or(0, |position| position.byte() as usize));
        line += text[counted..start].bytes().filter(|byte| *byte == b'\n').count();
        counted = start;
        let holds = record.iter().any(|cell| !cell.is_empty());
        holds.then(|| Row { line, start, cells: record.iter().map(String::from).collect() })
    };
    reader.into_records().map_while(std::result::Result::ok).filter_map(row)
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

/// Byte ranges of the cells of the record that starts at `start`, without surrounding blanks.
fn spans(text: &str, start: usize, delimiter: u8) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let mut found = Vec::new();
    let (mut from, mut at, mut quoted) = (start, start, false);
    loop {
        let byte = bytes.get(at).copied();
        if byte == Some(b'"') {
            quoted = !quoted;
        }
        let ends = byte.is_none() || !quoted && (byte == Some(b'\n') || byte == Some(delimiter));
        if ends {
            let cell = &text[from..at];
            let blank = cell.len() - cell.trim_start().len();
            let inner = if cell.trim().is_empty() { from..at } else { from + blank..from + blank + cell.trim().len() };
            found.push(inner);
            if byte != Some(delimiter) {
                return found;
            }
            from = at + 1;
        }
        at += 1;
    }
}

/// A problem and the rows that have the same one.
struct Complaint {
    place: Place,
    title: String,
    label: String,
    help: String,
    /// What makes others the same; nothing is the same as one without.
    cause: Option<(usize, &'static str)>,
    /// How many more rows have it, and in which lines the first and the last of them stand.
    more: usize,
    lines: (usize, usize),
}

/// Problems of one file, told together; equal ones of many rows as one. Those that will not be told are only counted.
pub(crate) struct Complaints<'a> {
    source: &'a Source,
    list: Vec<Complaint>,
    untold: usize,
    /// Causes among those.
    causes: BTreeSet<(usize, &'static str)>,
}

impl<'a> Complaints<'a> {
    /// None yet.
    pub fn of(source: &'a Source) -> Self {
        Self { source, list: Vec::new(), untold: 0, causes: BTreeSet::new() }
    }

    /// Counts one more of a cause that is known already; says whether it is.
    pub fn again(&mut self, cause: (usize, &'static str), line: usize) -> bool {
        let Some(first) = self.list.iter_mut().find(|complaint| complaint.cause == Some(cause)) else {
            return self.causes.contains(&cause);
        };
        let from = if first.more == 0 { line } else { first.lines.0 };
        first.more += 1;
        first.lines = (from, line);
        true
    }

    /// Counts one more where enough are told; says whether they are.
    ///
    /// Not `let full = self.list.len() == MAX_TOLD; self.untold += usize::from(full); full`: where that is inlined
    /// before a branch, rustc 1.95 adds a number that it never sets (its pass `SimplifyComparisonIntegral`), with `-O`
    /// and without overflow checks. `tests/measurement/hostile.rs` counts.
    pub fn leaves_out(&mut self) -> bool {
        if self.list.len() < MAX_TOLD {
            return false;
        }
        self.untold += 1;
        true
    }

    /// One more.
    pub fn add(&mut self, place: &Place, title: &str, label: &str, help: &str) {
        self.note(None, 0, place, [title, label, help]);
    }

    /// One more in a row, of a column and a kind: the first of those is told, and how many follow. `words` are title,
    /// label and help.
    pub fn add_row(&mut self, cause: (usize, &'static str), line: usize, place: &Place, words: [&str; 3]) {
        if !self.again(cause, line) {
            self.note(Some(cause), line, place, words);
        }
    }

    fn note(&mut self, cause: Option<(usize, &'static str)>, line: usize, place: &Place, words: [&str; 3]) {
        if self.leaves_out() {
            self.causes.extend(cause);
            return;
        }
        let [title, label, help] = words.map(String::from);
        self.list.push(Complaint { place: place.clone(), title, label, help, cause, more: 0, lines: (line, line) });
    }

    /// All of them as an error, where there are any.
    pub fn check(self) -> Result<()> {
        let Self { source, list, untold, .. } = self;
        let mut problems = Problems::default();
        problems.leave_out(untold);
        for Complaint { place, title, label, help, more, lines, .. } in list {
            let title = match more {
                0 => title,
                1 => format!("{title} … and 1 more row, line {}", lines.0),
                more => format!("{title} … and {more} more rows, lines {} to {}", lines.0, lines.1),
            };
            problems.push(std::slice::from_ref(source), &place, &title, &label, &help);
        }
        problems.into_message().map_or(Ok(()), |message| Err(Error::Input(message)))
    }
}
