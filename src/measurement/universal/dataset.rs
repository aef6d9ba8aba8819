//! The layout of dataset 58: eleven header records in fixed columns, then numbers.

use std::ops::Range;

use super::super::sheet::{Complaints, MAX_ROWS};
use crate::error::{Error, Result};
use crate::scenario::diagnostic::{Place, quote, render, whole_file};
use crate::scenario::source::Source;

/// Names of the function types.
const KINDS: &[&str] = &[
    "general",
    "time response",
    "auto spectrum",
    "cross spectrum",
    "frequency response function",
    "transmissibility",
    "coherence",
    "auto correlation",
    "cross correlation",
    "power spectral density",
    "energy spectral density",
    "probability density",
    "spectrum",
];

/// Records before the numbers.
const HEADERS: usize = 11;

/// One of the records 8 to 11.
#[derive(Debug, Clone, Default)]
pub(super) struct Characteristics {
    /// Specific data type, e.g. 8 displacement, 18 frequency.
    pub kind: i64,
    /// Label of the unit; empty where there is none.
    pub unit: String,
    span: Range<usize>,
}

impl Characteristics {
    /// The line of the record.
    pub fn place(&self) -> Place {
        Place { file: 0, span: self.span.clone() }
    }
}

/// A dataset 58 with its numbers still as text.
#[derive(Debug, Clone)]
// Wide: the fields of the header that are read, as the format lists them.
pub(super) struct Dataset {
    /// Line of its first ID line.
    pub line: usize,
    ids: Vec<String>,
    function: i64,
    /// Node and direction of the response and the reference.
    pub response: String,
    pub reference: String,
    ordinate: i64,
    count: usize,
    even: bool,
    minimum: f64,
    increment: f64,
    /// Abscissa, ordinate's numerator, its denominator.
    pub characteristics: [Characteristics; 3],
    head: Range<usize>,
    form: Range<usize>,
    body: Range<usize>,
}

/// One value of a function.
#[derive(Debug, Clone)]
pub(super) struct Value {
    pub abscissa: f64,
    pub real: f64,
    pub imaginary: f64,
    pub line: usize,
    pub span: Range<usize>,
}

impl Dataset {
    /// Whether it is a frequency response function.
    pub fn is_response(&self) -> bool {
        self.function == 4
    }

    /// What kind of function it is.
    pub fn kind(&self) -> String {
        let name = usize::try_from(self.function).ok().and_then(|kind| KINDS.get(kind));
        name.map_or_else(|| format!("function type {}", self.function), |name| (*name).to_string())
    }

    /// Its ID lines as far as they say anything.
    pub fn name(&self) -> String {
        let said: Vec<&str> =
            self.ids.iter().map(String::as_str).filter(|id| !id.is_empty() && *id != "NONE").collect();
        if said.is_empty() { "without a name".into() } else { quote(&said.join(" / ")) }
    }

    /// Its first line.
    pub fn place(&self) -> Place {
        Place { file: 0, span: self.head.clone() }
    }

    /// The numbers, or problems with their places.
    pub fn values(&self, source: &Source, complaints: &mut Complaints<'_>) -> Option<Vec<Value>> {
        let form = Place { file: 0, span: self.form.clone() };
        if !matches!(self.ordinate, 5 | 6) {
            let help = "the phase is needed: export the complex function (ordinate data type 5 or 6)";
            complaints.add(
                &form,
                "the function is not complex",
                &format!("ordinate data type {}", self.ordinate),
                help,
            );
            return None;
        }
        let each = if self.even { 2 } else { 3 };
        let promised = each * self.count;
        let (mut numbers, mut held) = (Vec::new(), 0);
        for span in tokens(&source.text, self.body.clone()) {
            let text = &source.text[span.clone()];
            match number(text) {
                Some(value) => {
                    held += 1;
                    if held <= promised {
                        numbers.push((value, span));
                    }
                }
                None => {
                    let title = format!("{} is not a finite number", quote(text));
                    let place = Place { file: 0, span };
                    complaints.add(&place, &title, "a number is needed", "export the dataset again");
                    return None;
                }
            }
        }
        if held != promised || self.count == 0 {
            let title = format!("the dataset promises {promised} numbers and holds {held}");
            let help = "the file may have been cut off; export it again";
            complaints.add(&form, &title, &format!("{} values of {each} numbers each", self.count), help);
            return None;
        }
        let (mut line, mut counted) = (1, 0);
        let values = numbers.chunks_exact(each).enumerate().map(|(at, numbers)| {
            let start = numbers[0].1.start;
            line += source.text[counted..start].matches('\n').count();
            counted = start;
            let end = if each == 2 { numbers[1].1.end } else { numbers[2].1.end };
            let even = self.minimum + self.increment * at as f64;
            Value {
                abscissa: if self.even { even } else { numbers[0].0 },
                real: numbers[each - 2].0,
                imaginary: numbers[each - 1].0,
                line,
                span: start..end,
            }
        });
        Some(values.collect())
    }
}

/// All datasets 58 of a file.
pub(super) fn functions(source: &Source) -> Result<Vec<Dataset>> {
    let mut lines = lines(&source.text).enumerate();
    let mut found = Vec::new();
    let mut delimited = false;
    while let Some((_, span)) = lines.next() {
        if source.text[span].trim() != "-1" {
            continue;
        }
        let Some((at, id)) = lines.next() else { break };
        delimited = true;
        let id = source.text[id].trim().to_lowercase();
        let mut inside = Vec::new();
        for (_, span) in lines.by_ref() {
            if source.text[span.clone()].trim() == "-1" {
                break;
            }
            // The numbers are one piece, whatever the number of their lines.
            match inside.get_mut(HEADERS) {
                Some(Range { end, .. }) => *end = span.end,
                None => inside.push(span),
            }
        }
        let name = id.split_whitespace().next().unwrap_or("");
        if name == "58" {
            found.push(dataset(source, at + 2, &inside)?);
        }
    }
    if !delimited {
        let title = format!("`{}` is not a universal file: no line holds -1 alone", source.name);
        return Err(Error::Input(whole_file(&title, "datasets stand between lines with -1; is the table a .csv?")));
    }
    Ok(found)
}

fn lines(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    let span = move |line: &str| {
        let span = at..at + line.trim_end().len();
        at += line.len();
        span
    };
    text.split_inclusive('\n').map(span)
}

fn dataset(source: &Source, line: usize, records: &[Range<usize>]) -> Result<Dataset> {
    let text = |n: usize| records.get(n).map_or("", |span| &source.text[span.clone()]);
    let refuse = |n: usize, title: &str| {
        let span = records.get(n).cloned().unwrap_or(source.text.len()..source.text.len());
        Error::Input(render(source, span, title, &format!("record {}", n + 1), "export the dataset again"))
    };
    if records.len() <= HEADERS {
        let last = records.len().saturating_sub(1);
        return Err(refuse(last, "the dataset 58 is cut off: eleven records and its numbers are needed"));
    }
    let integer = |n: usize, columns: Range<usize>| cut(text(n), columns).parse::<i64>();
    let function = integer(5, 0..5).map_err(|_| refuse(5, "columns 1 to 5 need the function type, a whole number"))?;
    let (Ok(ordinate), Ok(count), Ok(spacing)) = (integer(6, 0..10), integer(6, 10..20), integer(6, 20..30)) else {
        return Err(refuse(6, "columns 1 to 30 need data type, number of values and spacing, whole numbers"));
    };
    let Some(count) = usize::try_from(count).ok().filter(|count| *count <= MAX_ROWS) else {
        return Err(refuse(6, &format!("columns 11 to 20 need the number of values, at most {MAX_ROWS}")));
    };
    let even = spacing != 0;
    let tail = records[6].start + text(6).char_indices().nth(30).map_or(text(6).len(), |(at, _)| at)..records[6].end;
    let mut reals = tokens(&source.text, tail).map(|span| number(&source.text[span]).unwrap_or(f64::NAN));
    let (minimum, increment) = (reals.next().unwrap_or(f64::NAN), reals.next().unwrap_or(f64::NAN));
    if even && !(minimum.is_finite() && increment.is_finite() && increment > 0.0) {
        return Err(refuse(6, "even spacing needs a minimum and a positive increment of the abscissa"));
    }
    let characteristics = [7, 8, 9].map(|n| Characteristics {
        kind: cut(text(n), 0..10).parse().unwrap_or(0),
        unit: Some(cut(text(n), 47..67)).filter(|unit| unit != "NONE").unwrap_or_default(),
        span: records.get(n).cloned().unwrap_or_default(),
    });
    let freedom = |name: Range<usize>, node: Range<usize>, direction: Range<usize>| {
        let name = Some(cut(text(5), name)).filter(|name| name != "NONE" && !name.is_empty());
        let place = format!("node {} direction {}", cut(text(5), node), cut(text(5), direction));
        name.map_or(place.clone(), |name| format!("{name} {place}"))
    };
    Ok(Dataset {
        line,
        ids: (0..5).map(|n| text(n).trim().to_string()).collect(),
        function,
        response: freedom(31..41, 41..51, 51..55),
        reference: freedom(56..66, 66..76, 76..80),
        ordinate,
        count,
        even,
        minimum,
        increment,
        characteristics,
        head: records.first().cloned().unwrap_or_default(),
        form: records.get(6).cloned().unwrap_or_default(),
        body: records[HEADERS].clone(),
    })
}

/// Columns of a line, counted in characters from 0, without blanks around.
fn cut(line: &str, columns: Range<usize>) -> String {
    line.chars().skip(columns.start).take(columns.len()).collect::<String>().trim().into()
}

/// A finite number; Fortran writes its exponents with D.
fn number(text: &str) -> Option<f64> {
    text.replace(['D', 'd'], "e").parse().ok().filter(|value: &f64| value.is_finite())
}

/// Numbers in fixed columns need no blanks between them: a sign that follows no exponent starts the next one.
fn tokens(text: &str, range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let bytes = text.as_bytes();
    let (mut at, end) = (range.start, range.end);
    std::iter::from_fn(move || {
        while at < end && bytes[at].is_ascii_whitespace() {
            at += 1;
        }
        let start = at;
        while at < end && !bytes[at].is_ascii_whitespace() {
            let exponent = at > start && matches!(bytes[at - 1], b'e' | b'E' | b'd' | b'D');
            if at > start && matches!(bytes[at], b'+' | b'-') && !exponent {
                break;
            }
            at += 1;
        }
        (start < at).then_some(start..at)
    })
}
