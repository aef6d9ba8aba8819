//! Readings as two parts, as lock-in amplifiers and analysers of frequency response functions tell them: what is in phase with the
//! drive and what is 90° ahead of it.

use super::frame::{Frame, READINGS};
use super::header::split;
use super::sheet::Sheet;
use super::unit::{Unit, Wanted, suffix};

/// Words that name either part within a longer name.
const WORDS: [&[&str]; 2] = [&["re", "real", "inphase"], &["im", "imag", "imaginary", "quadrature", "quad"]];
/// Names that are a part as they stand.
const ALONE: [&str; 2] = ["x", "y"];

/// Columns of both parts, and the unit of both.
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

/// The one pair of columns among those that are not `taken` whose names differ in the part alone.
pub(crate) fn parts(sheet: &Sheet, frame: &Frame<'_>, taken: &[bool]) -> Option<Parts> {
    let of = |index: usize| Some((index, part(&sheet.headed(index), frame)?));
    let all: Vec<(usize, Part)> = (0..taken.len()).filter(|index| !taken[*index]).filter_map(of).collect();
    let imaginary_of = |real: &Part| {
        let same = |other: &Part| other.imaginary && (&other.stem, &other.unit) == (&real.stem, &real.unit);
        all.iter().find(|(_, other)| same(other)).map(|(index, _)| *index)
    };
    let reals = all.iter().filter(|(_, part)| !part.imaginary);
    let mut pairs = reals.filter_map(|(real, part)| {
        let imaginary = imaginary_of(part)?;
        let unit = part.unit.clone().unwrap_or(Unit::of(frame.serving(super::header::AMPLITUDE).last()?));
        Some(Parts { real: *real, imaginary, unit, stated: part.unit.is_some() })
    });
    let first = pairs.next()?;
    pairs.next().is_none().then_some(first)
}

/// What a header says of a part.
struct Part {
    imaginary: bool,
    /// The other words of its name.
    stem: String,
    unit: Option<Unit>,
}

fn part(header: &str, frame: &Frame<'_>) -> Option<Part> {
    let (name, bracket) = split(header);
    let name = name.to_lowercase().replace("in-phase", "inphase").replace("in phase", "inphase");
    let possible = READINGS;
    let wanted = Wanted { possible, natural: None, share: false, per_drive: true };
    let serves = |unit: &Unit| frame.serving(super::header::AMPLITUDE).contains(&unit.si);
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let at = |imaginary: usize| match words.as_slice() {
        [only] if *only == ALONE[imaginary] => Some(0),
        _ => words.iter().position(|word| WORDS[imaginary].contains(word)),
    };
    let (imaginary, at) = match (at(0), at(1)) {
        (Some(at), None) => (false, at),
        (None, Some(at)) => (true, at),
        _ => return None,
    };
    let unit = bracket.and_then(|text| wanted.unit(text).ok());
    let of_name = || (1..words.len()).flat_map(|from| suffix(&words[from..])).find_map(|text| wanted.unit(&text).ok());
    let unit = unit.or_else(of_name).filter(serves);
    // Coordinates have these names, too.
    let alone = words.len() == 1 && ALONE.contains(&words[0]);
    if alone && unit.as_ref().is_none_or(|unit| unit.si != "V" && unit.over.is_none()) {
        return None;
    }
    let stem = words.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, word)| *word).collect::<Vec<_>>().join("_");
    // `Re(H)`: what stands in the brackets is no unit, but the name.
    let stem = if unit.is_none() { stem + bracket.unwrap_or_default() } else { stem };
    Some(Part { imaginary, stem: if alone { String::new() } else { stem }, unit })
}
