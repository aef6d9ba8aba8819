//! Readings as two parts, as lock-in amplifiers and analysers of frequency response functions tell them: what is in
//! phase with the drive and what is 90° ahead of it; in two columns, or in one of complex numbers.

use super::frame::{Frame, READINGS};
use super::header::split;
use super::likely::MEANS;
use super::names::AMPLITUDE;
use super::sheet::{Sheet, Tally};
use super::unit::{Unit, Wanted, suffix};

/// Words that name either part within a longer name.
const WORDS: [&[&str]; 2] = [&["re", "real", "inphase"], &["im", "imag", "imaginary", "quadrature", "quad"]];
/// Names that are a part as they stand: of a lock-in amplifier, of an admittance.
const ALONE: [[&str; 3]; 2] = [["x", "g", "vx"], ["y", "b", "vy"]];

/// Rows that are looked at for complex numbers.
const SEEN: usize = 16;

/// Columns of both parts, and the unit of both. Of complex numbers both are the same column.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    /// In phase with the drive.
    pub real: usize,
    /// 90° ahead of it.
    pub imaginary: usize,
    pub unit: Unit,
    /// Whether the headers state that.
    pub stated: bool,
}

/// The pair of columns among those that are not `taken` whose names differ in the part alone: of several channels whose
/// names say that they are parts the first.
pub(crate) fn parts(sheet: &Sheet, frame: &Frame<'_>, taken: &[bool], tallies: &[Tally]) -> Option<Parts> {
    let of = |index: usize| Some((index, part(&sheet.headed(index), frame)?));
    // What is zero throughout is no part, but what an analyser writes beside a magnitude.
    let may_be = |index: &usize| !taken[*index] && !tallies[*index].is_zero();
    let all: Vec<(usize, Part)> = (0..taken.len()).filter(may_be).filter_map(of).collect();
    let imaginary_of = |real: &Part| {
        let same = |other: &Part| other.imaginary && (&other.stem, &other.unit) == (&real.stem, &real.unit);
        all.iter().find(|(_, other)| same(other)).map(|(index, _)| *index)
    };
    let reals = all.iter().filter(|(_, part)| !part.imaginary);
    let mut pairs = reals.filter_map(|(real, part)| {
        let imaginary = imaginary_of(part)?;
        // No amplitude is negative.
        let is_signed = |index: usize| tallies[index].negative > 0;
        if part.doubtful && !(frame.is_free() && (is_signed(*real) || is_signed(imaginary))) {
            return None;
        }
        let unit = part.unit.clone().unwrap_or(Unit::of(frame.serving(AMPLITUDE).last()?));
        Some((part.doubtful, Parts { real: *real, imaginary, unit, stated: part.unit.is_some() }))
    });
    match (pairs.next(), pairs.next()) {
        (Some((_, first)), None) | (Some((false, first)), Some((false, _))) => Some(first),
        (Some(_), Some(_)) => None,
        (None, _) => complex(sheet, frame, taken),
    }
}

/// The one column of complex numbers.
fn complex(sheet: &Sheet, frame: &Frame<'_>, taken: &[bool]) -> Option<Parts> {
    // What is real is written as a real number.
    let rows: Vec<_> = sheet.rows().take(SEEN).collect();
    let is_complex =
        |index: &usize| rows.iter().filter_map(|row| row.cells.get(*index)).any(|cell| split_complex(cell).is_some());
    let mut all = (0..taken.len()).filter(|index| !taken[*index]).filter(is_complex);
    let (index, None) = (all.next()?, all.next()) else { return None };
    let header = sheet.headed(index);
    let unit = split(&header).1.and_then(|text| reading_unit(text, frame));
    let stated = unit.is_some();
    let unit = unit.unwrap_or(Unit::of(frame.serving(AMPLITUDE).last()?));
    Some(Parts { real: index, imaginary: index, unit, stated })
}

/// The unit of a reading.
fn reading_unit(text: &str, frame: &Frame<'_>) -> Option<Unit> {
    let wanted = Wanted { possible: READINGS, natural: None, share: false, per_drive: true };
    wanted.unit(text).ok().filter(|unit| frame.serving(AMPLITUDE).contains(&unit.si))
}

/// Real and imaginary part of `(1.2e-3-4e-4j)`, `1 + 2i` and the like.
pub(super) fn split_complex(cell: &str) -> Option<[String; 2]> {
    let bare = cell.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')).unwrap_or(cell);
    let bare = bare.replace('−', "-").replace(char::is_whitespace, "");
    let body = bare.strip_suffix(['i', 'j'])?.trim_end_matches('*');
    let is_sign = |(at, c): &(usize, char)| matches!(c, '+' | '-') && *at > 0 && !body[..*at].ends_with(['e', 'E']);
    let at = body.char_indices().rfind(is_sign).map_or(0, |(at, _)| at);
    let real = if at == 0 { "0" } else { &body[..at] };
    let imaginary = if matches!(&body[at..], "" | "+" | "-") { format!("{}1", &body[at..]) } else { body[at..].into() };
    let parts = [real.into(), imaginary];
    parts.iter().all(|part| part.parse::<f64>().is_ok()).then_some(parts)
}

/// What a header says of a part.
struct Part {
    imaginary: bool,
    /// The other words of its name.
    stem: String,
    unit: Option<Unit>,
    /// Whether it may as well be a coordinate.
    doubtful: bool,
}

fn part(header: &str, frame: &Frame<'_>) -> Option<Part> {
    let (name, bracket) = split(header);
    // `Gain (Real)`: which part it is stands where a unit would.
    let is_word =
        |text: &str| WORDS.iter().any(|words| words.contains(&text.trim_end_matches('.').to_lowercase().as_str()));
    let (name, bracket) = match bracket.filter(|text| is_word(text)) {
        Some(text) => (format!("{name} {text}"), None),
        None => (name.to_string(), bracket),
    };
    let name = name.to_lowercase().replace("in-phase", "inphase").replace("in phase", "inphase");
    let words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty() && !MEANS.contains(word));
    // The channel of an amplifier: `X1` and `Y1`.
    let bare = |word: &'_ str| word.strip_suffix(|c: char| c.is_ascii_digit()).map_or(word.len(), str::len);
    let is_channel = |word: &str| matches!(&word[..bare(word)], "x" | "y");
    let words: Vec<&str> = words.map(|word| if is_channel(word) { &word[..bare(word)] } else { word }).collect();
    let at = |imaginary: usize| match words.as_slice() {
        [only] if ALONE[imaginary].contains(only) => Some(0),
        _ => words.iter().position(|word| WORDS[imaginary].contains(word)),
    };
    let (imaginary, at) = match (at(0), at(1)) {
        (Some(at), None) => (false, at),
        (None, Some(at)) => (true, at),
        _ => return None,
    };
    let unit = bracket.and_then(|text| reading_unit(text, frame));
    let of_name =
        || (1..words.len()).flat_map(|from| suffix(&words[from..])).find_map(|text| reading_unit(&text, frame));
    let unit = unit.or_else(of_name);
    // Coordinates have these names, too.
    let alone = ALONE[usize::from(imaginary)].iter().position(|name| words == [*name]);
    if alone.is_some() && unit.as_ref().is_some_and(|unit| unit.si != "V" && unit.over.is_none()) {
        return None;
    }
    let doubtful = alone.is_some() && unit.is_none();
    let stem = words.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, word)| *word).collect::<Vec<_>>().join("_");
    // `Re(H)`: what stands in the brackets is no unit, but the name.
    let stem = if unit.is_none() { stem + bracket.unwrap_or_default() } else { stem };
    Some(Part { imaginary, stem: alone.map_or(stem, |pair| pair.to_string()), unit, doubtful })
}

#[cfg(test)]
mod tests {
    use super::split_complex;

    #[test]
    fn complex_numbers_as_programs_write_them() {
        for (cell, real, imaginary) in [
            ("(1.2e-3-4e-4j)", 1.2e-3, -4e-4),
            ("1+2i", 1.0, 2.0),
            ("-1.5 - 2 i", -1.5, -2.0),
            ("3E+2+1e-05*i", 300.0, 1e-5),
            ("-0.5j", 0.0, -0.5),
            ("2-i", 2.0, -1.0),
        ] {
            let parts = split_complex(cell).unwrap_or_else(|| panic!("{cell}")).map(|part| part.parse::<f64>());
            assert_eq!(parts, [Ok(real), Ok(imaginary)], "{cell}");
        }
        for cell in ["1.5", "", "1+2", "abci", "1e-5", "(1+2j", "Hi", "--1i"] {
            assert_eq!(split_complex(cell), None, "{cell}");
        }
    }
}
