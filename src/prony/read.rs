//! Tables of moduli: which column is which and in which unit, and its cells in SI.

use super::{Kind, Moduli, Point};
use crate::error::{Error, Result};
use crate::measurement::{
    Complaints, Row, Sheet, Unit, Wanted, bytes, decimal_commas, plain, sheet, split, suffix, written,
};
use crate::scenario::diagnostic::{MAX_TOLD, quote, render, whole_file};
use std::f64::consts::TAU;
use std::path::Path;

/// Fewest different frequencies or times that make a curve, and most rows: each is fitted some thousand times.
const FEWEST: usize = 6;
const MOST_ROWS: usize = 2000;
/// Largest ratio of two readings, or of two frequencies: beyond it squares leave a computer's numbers.
const WIDEST: f64 = 1e100;

/// A quantity that a column may hold.
struct Quantity {
    names: &'static [&'static str],
    si: &'static str,
    /// Unit where none is stated; of a modulus it has to be.
    unit: Option<&'static str>,
    /// How to name a column of it.
    example: &'static str,
}

const OMEGA: usize = 1;
const TAN: usize = 5;
const QUANTITIES: [Quantity; 8] = [
    Quantity {
        names: &["frequency", "freq", "f", "frequenz", "reduced_frequency"],
        si: "Hz",
        unit: Some("Hz"),
        example: "frequency_hz",
    },
    Quantity {
        names: &["omega", "ω", "angular_frequency", "kreisfrequenz"],
        si: "Hz",
        unit: Some("rad/s"),
        example: "omega_rad_s",
    },
    Quantity { names: &["time", "t", "zeit", "reduced_time"], si: "s", unit: Some("s"), example: "time_s" },
    Quantity {
        names: &["storage", "storage_modulus", "e'", "g'", "e_stor", "g_stor", "speichermodul"],
        si: "Pa",
        unit: None,
        example: "storage_mpa",
    },
    Quantity {
        names: &["loss", "loss_modulus", "e''", "g''", "e\"", "g\"", "e_loss", "g_loss", "verlustmodul"],
        si: "Pa",
        unit: None,
        example: "loss_mpa",
    },
    Quantity {
        names: &["loss_factor", "tan_delta", "tan_d", "tan_δ", "tanδ", "tan(delta)", "tan(δ)", "verlustfaktor"],
        si: "1",
        unit: Some("1"),
        example: "tan_delta",
    },
    Quantity {
        names: &["relaxation", "relaxation_modulus", "e_relax", "g_relax", "e(t)", "g(t)", "relaxationsmodul"],
        si: "Pa",
        unit: None,
        example: "relaxation_mpa",
    },
    Quantity {
        names: &["compliance", "creep_compliance", "j", "j(t)", "d(t)", "nachgiebigkeit"],
        si: "1/Pa",
        unit: None,
        example: "compliance_1_mpa",
    },
];
/// What makes a table, the frequency or time first; the first that is there in full holds.
const TABLES: [(Kind, &[usize]); 6] = [
    (Kind::Dynamic, &[0, 3, 4]),
    (Kind::Dynamic, &[OMEGA, 3, 4]),
    (Kind::Dynamic, &[0, 3, TAN]),
    (Kind::Dynamic, &[OMEGA, 3, TAN]),
    (Kind::Relaxation, &[2, 6]),
    (Kind::Creep, &[2, 7]),
];

/// Reads a table of moduli.
///
/// # Errors
/// [`Error::Input`] with every problem of the table, up to a number that people read; [`Error::Io`] where the operating
/// system refuses the file.
pub fn read(path: &Path) -> Result<Moduli> {
    read_bytes(path, &bytes(path)?)
}

/// The same of bytes that are at hand; the name of the file still tells their format.
///
/// # Errors
/// As of [`read`].
pub fn read_bytes(path: &Path, bytes: &[u8]) -> Result<Moduli> {
    let mut notes = Vec::new();
    let sheet = sheet(path, bytes, &mut notes)?;
    let mut complaints = Complaints::of(&sheet.source);
    let (kind, columns) = columns(&sheet, &mut complaints)?;
    let used: Vec<usize> = columns.iter().map(|column| column.index).collect();
    let commas = decimal_commas(&sheet, &used, &mut complaints);
    written(&sheet, commas, &mut notes);
    if sheet.count > MOST_ROWS {
        let title = format!("`{}` has {} rows, at most {MOST_ROWS} are fitted", sheet.source.name, sheet.count);
        return Err(Error::Input(whole_file(
            &title,
            "average or thin it, evenly on a logarithmic scale of frequency or time",
        )));
    }
    let mut points = Vec::new();
    for row in sheet.rows() {
        let cells: Vec<Option<f64>> =
            columns.iter().map(|column| cell(&sheet, &row, column, commas, &mut complaints)).collect();
        if let [Some(x), Some(first), rest @ ..] = &cells[..]
            && !rest.contains(&None)
        {
            let second = rest.first().copied().flatten().unwrap_or(0.0);
            let second = if columns.get(2).is_some_and(|column| column.what == TAN) { first * second } else { second };
            points.push(Point { x: if kind == Kind::Dynamic { TAU * x } else { *x }, y: [*first, second] });
        }
    }
    complaints.check()?;
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    let read: Vec<String> = columns.iter().map(|column| quote(&sheet.headed(column.index))).collect();
    notes.push(format!("read: {}", read.join(", ")));
    let file = path.display().to_string();
    let moduli = Moduli { file, hash: blake3::hash(bytes).to_hex().to_string(), kind, points, notes };
    enough(&moduli)?;
    Ok(moduli)
}

/// A column that is used.
struct Column {
    index: usize,
    what: usize,
    unit: Unit,
}

/// What a header says: the quantity, and its unit or what is wrong with it.
fn meaning(header: &str) -> Option<(usize, std::result::Result<Unit, String>)> {
    let header = header.replace('′', "'").replace('″', "''");
    let (written, bracket) = split(&header);
    let name = plain(written);
    let whole = plain(header.trim());
    let find = |name: &str| QUANTITIES.iter().position(|quantity| quantity.names.contains(&name));
    let wanted = |what: usize| Wanted {
        possible: std::slice::from_ref(&QUANTITIES[what].si),
        natural: None,
        share: false,
        per_drive: false,
    };
    if let (Some(what), Some(text)) = (find(&name), bracket) {
        return Some((what, wanted(what).unit(text)));
    }
    if let Some(what) = find(&name).or_else(|| find(&whole)) {
        let Quantity { unit, example, .. } = QUANTITIES[what];
        let none = || format!("it states no unit: write e.g. {example}, or a unit in brackets");
        return Some((what, unit.ok_or_else(none).and_then(|unit| wanted(what).unit(unit))));
    }
    // The longest name, then a unit.
    let rest = |key: &str| name.strip_prefix(key).and_then(|rest| rest.strip_prefix('_'));
    let names = QUANTITIES.iter().enumerate().flat_map(|(what, q)| q.names.iter().map(move |key| (what, *key)));
    let (what, key) = names.filter(|(_, key)| rest(key).is_some()).max_by_key(|(_, key)| key.len())?;
    let parts: Vec<&str> = written.trim().get(key.len() + 1..)?.split(['_', ' ']).collect();
    let unit = suffix(&parts).find_map(|text| wanted(what).unit(&text).ok())?;
    let alike = |text: &str| wanted(what).unit(text).is_ok_and(|other| other.convert("1") == unit.convert("1"));
    let different = || "the name and the brackets state different units".to_string();
    Some((what, if bracket.is_none_or(alike) { Ok(unit) } else { Err(different()) }))
}

/// The columns of the first kind of table that is there in full.
fn columns(sheet: &Sheet, complaints: &mut Complaints<'_>) -> Result<(Kind, Vec<Column>)> {
    let headers: Vec<_> = (0..sheet.header.cells.len()).map(|index| meaning(&sheet.headed(index))).collect();
    let of = |what: usize| -> Vec<usize> {
        let is = |index: &usize| headers[*index].as_ref().is_some_and(|(found, _)| *found == what);
        (0..headers.len()).filter(is).collect()
    };
    let full = TABLES.iter().find(|(_, wanted)| wanted.iter().all(|&what| !of(what).is_empty()));
    let Some((kind, wanted)) = full else {
        let names: Vec<String> = sheet.header.cells.iter().take(MAX_TOLD).map(|name| quote(name)).collect();
        let title = format!("no table of moduli that is known: its columns are {}", names.join(", "));
        let of = |list: &[usize]| list.iter().map(|&what| QUANTITIES[what].example).collect::<Vec<_>>().join(",");
        let examples: Vec<String> = TABLES.iter().map(|(_, list)| of(list)).collect();
        let help = format!("name them in the header, units included: {}", examples.join(" or "));
        let label = "a frequency or a time with its modulus is needed";
        let span = sheet.row_place(&sheet.header).span;
        return Err(Error::Input(render(&sheet.source, span, &title, label, &help)));
    };
    let mut columns = Vec::new();
    for &what in *wanted {
        let found = of(what);
        let (index, place) = (found[0], sheet.place(&sheet.header, found[0]));
        let header = quote(&sheet.headed(index));
        if let [_, second, ..] = found[..] {
            let title = format!("two columns hold the same quantity: {header} and {}", quote(&sheet.headed(second)));
            complaints.add(
                &sheet.place(&sheet.header, second),
                &title,
                "the second of them",
                "rename the one that is not meant",
            );
        }
        match &headers[index] {
            Some((_, Ok(unit))) => columns.push(Column { index, what, unit: unit.clone() }),
            Some((_, Err(why))) => {
                let help = format!("a column of it is called e.g. {}", QUANTITIES[what].example);
                complaints.add(&place, &format!("the unit of column {header} does not serve"), why, &help);
            }
            None => {}
        }
    }
    Ok((*kind, columns))
}

/// A cell in SI; what is no positive number is noted.
fn cell(sheet: &Sheet, row: &Row, column: &Column, commas: bool, complaints: &mut Complaints<'_>) -> Option<f64> {
    let written = row.cells[column.index].as_str();
    let number = written.replace('−', "-");
    let number = if commas { number.replace(',', ".") } else { number };
    let value =
        number.parse::<f64>().ok().filter(|value| value.is_finite()).and_then(|_| column.unit.convert(&number).ok());
    let (kind, title) = match value {
        Some(value) if value > 0.0 && value.recip().is_finite() => return Some(value),
        Some(_) => ("positive", format!("{} is not more than zero", quote(written))),
        None if written.is_empty() => ("empty", "the cell is empty".to_string()),
        None => ("number", format!("{} is not a finite number", quote(written))),
    };
    let label = format!("{}a positive number in {} is needed", sheet.cell_name(row, column.index), column.unit.text);
    let title = format!("column {}: {title}", quote(&sheet.header.cells[column.index]));
    let help = "residuals are relative to the reading, on a logarithmic axis; remove the row if there is none";
    complaints.add_row((column.index, kind), row.line, &sheet.place(row, column.index), [&title, &label, help]);
    None
}

/// A curve has a few places, and numbers whose squares are numbers.
fn enough(moduli: &Moduli) -> Result<()> {
    let refuse =
        |title: String, help: &str| Err(Error::Input(whole_file(&format!("`{}`: {title}", moduli.file), help)));
    let places = 1 + moduli.points.windows(2).filter(|two| two[1].x > two[0].x).count();
    if places < FEWEST {
        let title = format!("only {places} different frequencies or times");
        return refuse(title, "a series needs six or more, over a decade or more to tell anything");
    }
    let readings = moduli.points.iter().flat_map(|point| point.y[..moduli.kind.readings()].iter().copied());
    let (low, high) = readings.fold((f64::INFINITY, 0.0f64), |(low, high), y| (low.min(y), high.max(y)));
    let (slow, fast) = moduli.band();
    if !(high / low < WIDEST && fast / slow < WIDEST && fast.is_finite() && slow > 0.0) {
        let title = "readings or frequencies differ by more than a computer's numbers can tell".to_string();
        return refuse(title, "check them, and their units");
    }
    Ok(())
}
