//! What instruments write before the numbers: settings, titles, a header behind a remark sign; and cells that blanks
//! part. The text is changed in place, byte for byte, so that every place in it stays what it was.

use super::sheet::MAX_COLUMNS;
use super::unit::units_of;
use crate::scenario::diagnostic::quote;
use crate::units::count;

/// What may part cells, and is tried in this order; blanks last.
const SEPARATORS: [u8; 4] = *b";\t, ";

/// Lines among which the numbers begin: what has more before them is no table.
const MOST: usize = 1000;

/// Names of a column of comments.
const COMMENTS: [&str; 3] = ["comment", "comments", "remark"];

/// What is told of a file whose cells blanks part.
pub(super) const BLANKS: &str = "blanks separate the cells";

/// A line of a text.
#[derive(Clone, Copy)]
struct Line<'a> {
    start: usize,
    text: &'a str,
}

impl Line<'_> {
    fn is_remark(&self) -> bool {
        self.text.starts_with('#')
    }

    /// Its cells where they are numbers, two or more, and what parts them.
    fn numbers(&self) -> Option<(u8, usize)> {
        SEPARATORS.into_iter().find_map(|separator| self.parted_by(separator))
    }

    /// The same where more than one tab stands between the numbers.
    fn tabbed(&self) -> Option<(u8, usize)> {
        self.parted_by(b' ').filter(|_| self.text.trim().contains("\t\t"))
    }

    fn parted_by(&self, separator: u8) -> Option<(u8, usize)> {
        let cells = cells(self.text, separator);
        let filled: Vec<&String> = cells.iter().filter(|cell| !cell.is_empty()).collect();
        let numeric = filled.iter().all(|cell| cell.replace(',', ".").parse::<f64>().is_ok_and(f64::is_finite));
        (filled.len() > 1 && numeric).then_some((separator, cells.len()))
    }
}

/// The lines that hold anything.
fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let mut at = 0;
    let line = move |line: &'_ str| {
        at += line.len();
        at - line.len()
    };
    text.split_inclusive('\n')
        .scan(line, |start, line| Some((start(line), line)))
        .map(|(start, line)| Line { start, text: line.trim_end_matches('\n') })
        .filter(|line| !line.text.trim().is_empty())
}

/// Trimmed cells of a line, as many as a sheet has and one more; none at its end where a separator ends it.
fn cells(line: &str, separator: u8) -> Vec<String> {
    let trimmed = |cell: &str| cell.trim().trim_matches('"').to_string();
    if separator == b' ' {
        return line.split_whitespace().take(MAX_COLUMNS + 1).map(String::from).collect();
    }
    let mut cells: Vec<String> = line.split(char::from(separator)).take(MAX_COLUMNS + 1).map(trimmed).collect();
    while cells.len() > 1 && cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
    cells
}

/// Makes header and numbers of a text the first that stands in it; tells what was done, in words. A text that is such a
/// table already, and one in which no header is seen, are left as they are.
pub(super) fn bare(text: &mut String) -> Vec<String> {
    marked(text);
    axis(text);
    let mut told: Vec<String> = closed(text).into_iter().collect();
    told.extend(opened(text));
    told
}

/// Gives remarks of other programs before the numbers the sign that they have here: a line that `%` (MATLAB), `*`
/// (loudspeaker programs) or `!` (analysers) begins. Below them such a mark may be one of a reading.
fn marked(text: &mut String) {
    let is_marked = |line: &Line<'_>| line.text.starts_with(['%', '*', '!']);
    let above = lines(text).take_while(|line| line.numbers().is_none());
    let starts: Vec<usize> = above.filter(is_marked).map(|line| line.start).collect();
    let mut bytes = std::mem::take(text).into_bytes();
    starts.into_iter().for_each(|start| bytes[start] = b'#');
    // Only ASCII was replaced.
    *text = String::from_utf8(bytes).unwrap_or_default();
}

/// Names the axis of a spectrum, where the preamble states its unit and the column has an apostrophe for its name and
/// for its unit: `AxisUnit;Hz` and `';Signal 1 (Real)`.
fn axis(text: &mut String) {
    let above: Vec<Line<'_>> = lines(text).take(MOST).take_while(|line| line.numbers().is_none()).collect();
    let is_of_frequency = |line: &Line<'_>| {
        let cells = SEPARATORS.map(|separator| cells(line.text, separator));
        cells.iter().any(|cells| cells.len() == 2 && cells[0].ends_with("AxisUnit") && cells[1] == "Hz")
    };
    let has_no_name = |line: &&Line<'_>| line.text.starts_with('\'') && line.text[1..].starts_with([';', '\t', ',']);
    let starts: Vec<usize> = above.iter().filter(has_no_name).map(|line| line.start).collect();
    if !above.iter().any(is_of_frequency) {
        return;
    }
    let mut bytes = std::mem::take(text).into_bytes();
    starts.into_iter().zip([b'f', b' ']).for_each(|(start, name)| bytes[start] = name);
    // Only ASCII was replaced.
    *text = String::from_utf8(bytes).unwrap_or_default();
}

/// Takes away the line that closes the numbers, as analysers write it: `END`.
fn closed(text: &mut String) -> Option<String> {
    let start = text.trim_end().rfind('\n')? + 1;
    let last = text[start..].trim();
    let closes = last.split_whitespace().next().is_some_and(|word| word.eq_ignore_ascii_case("end"));
    let told = closes.then(|| format!("what closes the numbers is not read: {}", quote(last)))?;
    text.truncate(start);
    Some(told)
}

/// Makes header and numbers the first that stand in a text.
fn opened(text: &mut String) -> Vec<String> {
    let first: Vec<Line<'_>> = lines(text).take(MOST).collect();
    let Some(Found { header, units, shape, remark }) = find(&first) else { return Vec::new() };
    let separator = shape.separator;
    let before = first[..header].iter().filter(|line| !line.is_remark()).count();
    let parts_alike = header_line(first[header].text, shape) == first[header].text;
    if before == 0 && !remark && separator != b' ' && parts_alike {
        return Vec::new();
    }
    let last = units.unwrap_or(header);
    let mut bytes = text.as_bytes().to_vec();
    for (number, line) in lines(text).enumerate().take_while(|(number, _)| *number <= last || separator == b' ') {
        let own = &mut bytes[line.start..line.start + line.text.len()];
        if number == header || (remark && Some(number) == units) {
            own.copy_from_slice(header_line(line.text, shape).as_bytes());
        } else if number < last && !(number < header && line.is_remark()) {
            own.fill(b' ');
        } else if separator == b' ' && !line.is_remark() {
            own.copy_from_slice(parted(line.text, 1).as_bytes());
        }
    }
    let mut told = Vec::new();
    if before > 0 {
        told.push(format!(
            "{} before the header {} not read",
            count(before, "line"),
            if before == 1 { "is" } else { "are" }
        ));
    }
    if remark {
        told.push("the names of the columns stand in the remark above the numbers".into());
    }
    if !parts_alike && !remark && separator == b'\t' && !first[header].text.contains('\t') {
        told.push("blanks separate the names in the header, tabs the numbers".into());
    }
    if separator == b' ' {
        told.push(BLANKS.into());
    }
    // Only ASCII was replaced, and whole lines.
    if let Ok(bared) = String::from_utf8(bytes) {
        *text = bared;
        return told;
    }
    Vec::new()
}

/// The form of the rows of numbers.
#[derive(Clone, Copy)]
struct Shape {
    /// What parts the cells.
    separator: u8,
    /// How many are filled, up to the last.
    width: usize,
    /// How many there are, empty ones at the end too.
    most: usize,
}

/// Where the table begins.
struct Found {
    /// Number of the line of the header.
    header: usize,
    /// Of the row below it that states units, where there is one.
    units: Option<usize>,
    shape: Shape,
    /// Whether the header stands in a remark.
    remark: bool,
}

fn find(lines: &[Line<'_>]) -> Option<Found> {
    begun(lines, false).or_else(|| begun(lines, true))
}

/// Where it begins, if its numbers are parted by one separator or by `tabs`.
fn begun(lines: &[Line<'_>], tabs: bool) -> Option<Found> {
    let numbers = |line: &Line<'_>| if tabs { line.tabbed() } else { line.numbers() };
    let is_data = |number: usize| {
        let (line, next) = (lines.get(number)?, lines.get(number + 1).or(lines.get(number))?);
        numbers(line).filter(|shape| !line.is_remark() && numbers(next) == Some(*shape))
    };
    let (first, (separator, width)) = (0..lines.len()).find_map(|number| Some((number, is_data(number)?)))?;
    // Cells that a row leaves empty at its end have names, too: LabVIEW closes its header with a comment.
    let cells = || lines[first].text.split(char::from(separator)).count();
    above(lines, first, Shape { separator, width, most: if separator == b' ' { width } else { cells() } })
}

/// The header above the first row of numbers.
fn above(lines: &[Line<'_>], first: usize, shape: Shape) -> Option<Found> {
    let Shape { width, most, .. } = shape;
    let named = |line: &str| {
        // A row of words and numbers is one of the table.
        let is_word = |cell: &&String| cell.replace(',', ".").parse::<f64>().is_err();
        Some(header_cells(line, shape)).filter(|cells| {
            let filled: Vec<&String> = cells.iter().filter(|cell| !cell.is_empty()).collect();
            (width..=most).contains(&cells.len()) && filled.len() > 1 && filled.iter().all(is_word)
        })
    };
    let above: Vec<usize> = (0..first).filter(|&number| !lines[number].is_remark()).collect();
    if let Some(&last) = above.last() {
        let own = named(lines[last].text)?;
        let is_units = units_of(&own, width).is_some();
        let before = above.iter().rev().nth(1).filter(|&&number| is_units && named(lines[number].text).is_some());
        return Some(match before {
            Some(&header) => Found { header, units: Some(last), shape, remark: false },
            None => Found { header: last, units: None, shape, remark: false },
        });
    }
    let remark = |number: usize| named(lines[number].text.trim_start_matches('#'));
    let header = (0..first).rev().find(|&number| remark(number).is_some())?;
    // Its units may stand in a remark of their own.
    let is_units = remark(header).is_some_and(|own| units_of(&own, width).is_some());
    match header.checked_sub(1).filter(|&above| is_units && remark(above).is_some()) {
        Some(above) => Some(Found { header: above, units: Some(header), shape, remark: true }),
        None => Some(Found { header, units: None, shape, remark: true }),
    }
}

/// The cells of a header above numbers that this separator parts, which need not part the header.
fn header_cells(line: &str, shape: Shape) -> Vec<String> {
    let (separator, line) = (shape.separator, header_line(line, shape));
    let mut cells = cells(&line, if separator == b' ' { b'\t' } else { separator });
    while cells.len() > 1 && cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
    cells
}

/// A header with its cells parted as the numbers of this shape are, of the same length in bytes; without its remark sign.
fn header_line(line: &str, Shape { separator, width, most }: Shape) -> String {
    let marks = line.len() - line.trim_start_matches('#').len();
    // A mark between blanks parts names.
    let mut line = " ".repeat(marks) + &line[marks..].replace(" # ", "   ");
    if separator == b' ' {
        return match SEPARATORS[..3].iter().find(|own| line.as_bytes().contains(own)) {
            Some(own) => line.replace(char::from(*own), "\t"),
            None if line.trim().contains("  ") => parted(&line, 2),
            None => parted(&line, 1),
        };
    }
    if separator == b'\t' && !line.contains('\t') {
        return parted(&line, if line.trim().contains("  ") { 2 } else { 1 });
    }
    // An attribute of the sweep, as some write it behind the names of the columns, is none of these.
    let is_attribute = |cell: &str| {
        let value = cell.split_once('=').map(|(_, value)| value.trim_start());
        value.is_some_and(|value| value.is_empty() || value.starts_with(|c: char| c.is_ascii_digit() || c == '-'))
    };
    while let Some(at) = line.rfind(char::from(separator)).filter(|at| is_attribute(&line[*at..])) {
        line.replace_range(at.., &" ".repeat(line.len() - at));
    }
    let names = |line: &str| line.split(char::from(separator)).filter(|name| !name.trim().is_empty()).count();
    // A column of comments has no cell in a row without one.
    if let Some(at) = line.trim_end().rfind(char::from(separator))
        && names(&line) > most
        && COMMENTS.contains(&line[at + 1..].trim().to_lowercase().as_str())
    {
        line.replace_range(at.., &" ".repeat(line.len() - at));
    }
    // As many names as numbers, with more than one separator between them.
    if names(&line) == width && line.trim().split(char::from(separator)).count() > width {
        let mut bytes = line.into_bytes();
        let mut last = None;
        for at in 0..bytes.len() {
            if bytes[at] == separator
                && let Some(before) = last.replace(at)
            {
                bytes[before] = b' ';
            } else if bytes[at] != separator && !bytes[at].is_ascii_whitespace() {
                last = None;
            }
        }
        return String::from_utf8(bytes).unwrap_or_default();
    }
    line
}

/// A line with a tab at the end of every run of so many blanks or more, but for those at its ends and before a unit in
/// brackets.
fn parted(line: &str, blanks: usize) -> String {
    let mut bytes = line.as_bytes().to_vec();
    let (from, to) = (line.len() - line.trim_start().len(), line.trim_end().len());
    let mut run = 0;
    for at in from..to {
        if bytes[at].is_ascii_whitespace() {
            run += 1;
            bytes[at] = b' ';
            continue;
        }
        if run >= blanks && !(blanks == 1 && matches!(bytes[at], b'(' | b'[')) {
            bytes[at - 1] = b'\t';
        }
        run = 0;
    }
    String::from_utf8(bytes).unwrap_or_else(|_| line.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bared(text: &str) -> (Vec<String>, Vec<String>) {
        let (lines, told) = bared_of(text);
        assert!(!told.iter().any(|one| one.contains("closes")));
        (lines, told)
    }

    fn bared_of(text: &str) -> (Vec<String>, Vec<String>) {
        let mut own = text.to_string();
        let told = bare(&mut own);
        assert!(own.len() == text.len() || told.iter().any(|one| one.contains("closes")));
        let lines = own.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
        (lines.map(|line| line.trim().replace(" \t", "\t").replace("\t ", "\t")).collect(), told)
    }

    #[test]
    fn tables_that_begin_with_their_header_are_left_alone() {
        for text in [
            "f,a\n1,2\n3,4\n",
            "# remark\nf;a\n1,5;2\n3,5;4\n",
            "series,f,a\nup,1,2\nup,2,3\n",
            "f,a\nHz,m\n1,2\n3,4\n",
            "series,sweep,f,a\nx,up,1,2\n,,2,3\n,,3,4\n",
            "1,2\n3,4\n",
            "f a\n",
        ] {
            let mut own = text.to_string();
            assert!(bare(&mut own).is_empty() && own == text, "{text:?} {own:?}");
        }
    }

    #[test]
    fn a_header_behind_a_remark_sign_is_one() {
        let (lines, told) = bared("# sweep of June\n# f (Hz), a (V), phase (rad), level=3 V\n1.0,2,3\n2.0,3,4\n");
        assert_eq!((lines[0].as_str(), lines.len(), told.len()), ("f (Hz), a (V), phase (rad)", 3, 1));
        let (lines, told) = bared("# f (Hz), a (V)\n1.0 2e-3\n 2.0   3e-3\n");
        assert_eq!((lines.join("|"), told.len()), ("f (Hz)\ta (V)|1.0\t2e-3|2.0 \t3e-3".into(), 2));
    }

    #[test]
    fn what_closes_the_numbers_is_not_read() {
        let (lines, told) = bared_of("BEGIN CH1_DATA\nf (Hz), a (V)\n1.0, 2\n2.0, 3\nEND\n");
        assert_eq!((lines.len(), lines[2].as_str()), (3, "2.0, 3"));
        assert_eq!(told, ["what closes the numbers is not read: `END`", "1 line before the header is not read"]);
        // A second block is none that closes the first.
        assert_eq!(bared_of("f,a\n1,2\n2,3\nEND\nf,a\n1,2\n2,3\n").1, Vec::<String>::new());
    }

    #[test]
    fn settings_and_titles_before_the_header_are_not_read() {
        let text = "--- Setup ---\nStart (Hz): 10\nFrequency (Hz),TR1: Gain (dB)\n10,0.5\n11,0.6\n";
        let (lines, told) = bared(text);
        assert_eq!((lines[0].as_str(), lines.len()), ("Frequency (Hz),TR1: Gain (dB)", 3));
        assert_eq!(told, ["2 lines before the header are not read"]);
        let (lines, _) = bared("Run 3\t\t\nf\ta\tu\nHz\tm\tN\n1\t2\t3\n2\t3\t4\n");
        assert_eq!(lines[..2], ["f\ta\tu", "Hz\tm\tN"]);
        let text = "Separator\tTab\n***End***\t\t\t\nX0\t0.0\t0.0\nf\ta\tp\tComment\n1\t2\t3\t\n2\t3\t4\t\n";
        assert_eq!(bared(text).0[0], "f\ta\tp\tComment");
        let (lines, _) = bared("f [Hz]  A [V]\n 1.0   2.0\n 1.5   2.5\n");
        assert_eq!(lines[0], "f [Hz]\tA [V]");
        // A loudspeaker program, a header padded with tabs, doubled tabs, a comment that no row has.
        let (lines, _) = bared("% Fs 57.7\n% Freq    Impedance\n1.0  \t4.9 \n1.1  \t4.8 \n");
        assert_eq!((lines[0].as_str(), lines.len()), ("Freq  \tImpedance", 3));
        let (lines, _) = bared("f,a\n1,2\n*3,4\n5,6\n");
        assert_eq!(lines[2], "*3,4", "a reading that is marked is no remark");
        let (lines, told) = bared("Frequency\tPhase Shift\t\tAmplitude\t\n1\t2\t3\n2\t3\t4\n");
        assert_eq!((lines[0].trim(), told), ("Frequency\tPhase Shift\tAmplitude", Vec::new()));
        let (lines, _) = bared("# f Uc\n# kHz V\n\n15\t\t11\n16\t\t12\n");
        assert_eq!(lines, ["f\tUc", "kHz\tV", "15\t11", "16\t12"]);
        let (lines, _) = bared("Writer\t2\nX_Value\tAcceleration\tComment\n0.1\t-7\n0.2\t-9\n");
        assert_eq!(lines[0], "X_Value\tAcceleration");
    }
}
