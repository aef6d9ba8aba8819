//! An earlier run: read before anything is written, then held against this one.

use super::folder::Folder;
use super::{rerender, simulate};
use crate::error::{Error, Result};
use crate::figures::FigureError;
use crate::figures::baseline::{Pair, draw};
use crate::gate::Judged;
use crate::report::{self, BaselineView, Change, ChangeView, FigureView, PictureView, ReportView};
use crate::scenario::Signal;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Most scenarios whose curves are drawn.
const DRAWN: usize = 4;
/// Changes of one kind, and inputs, told on the terminal.
const TOLD: usize = 10;

/// Frequency \[Hz\] and amplitude by name of the curve, in the order of the file.
type Curves = Vec<(String, Vec<(f64, f64)>)>;

/// An earlier run.
pub struct Baseline {
    path: PathBuf,
    /// Its report, drawings filled in where their files are there.
    pub view: ReportView,
    curves: BTreeMap<String, Curves>,
}

impl Baseline {
    /// The run whose `report.json`, or whose folder, is at a path.
    ///
    /// # Errors
    /// [`Error::Input`] where that is not the report of this version of the program.
    pub fn load(path: &Path) -> Result<Self> {
        let file = if path.is_dir() { path.join("report.json") } else { path.to_path_buf() };
        let mut view = rerender::load(&file)?;
        // What that run was held against is no part of it.
        (view.baseline, view.history, view.provenance.times) = (None, None, None);
        let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
        for figure in report::figures(&mut view) {
            let svg = figure.files.iter().find(|file| file.kind == "SVG");
            // A report alone is a baseline too: its numbers are compared, its figures are not.
            figure.svg = svg.and_then(|file| rerender::text(&folder.join(&file.name)).ok()).unwrap_or_default();
        }
        let mut curves = BTreeMap::new();
        for scenario in view.scenarios.iter().filter(|scenario| inside(&scenario.id)) {
            if let Ok(text) = rerender::text(&folder.join(simulate::curves_name(&scenario.id))) {
                curves.insert(scenario.id.clone(), parse(&text).0);
            }
        }
        Ok(Self { path: path.to_path_buf(), view, curves })
    }

    /// What differs in numbers, verdicts and inputs.
    pub fn numbers(&self, now: &ReportView) -> BaselineView {
        report::baseline(&self.view, now, &self.path.display().to_string())
    }

    /// What differs, with curves and pictures, whose files go below `out`.
    ///
    /// # Errors
    /// [`Error::Io`] where they cannot be written.
    pub fn against(&self, now: &ReportView, out: &Folder) -> Result<BaselineView> {
        let mut view = self.numbers(now);
        for scenario in &now.scenarios {
            let (Some(before), true) = (self.curves.get(&scenario.id), view.figures.len() < DRAWN) else { continue };
            let Ok(text) = rerender::text(&out.path().join(simulate::curves_name(&scenario.id))) else { continue };
            let (after, reading) = parse(&text);
            let pairs = after.into_iter().filter_map(|(name, after)| {
                let before = before.iter().find(|(other, _)| *other == name)?.1.clone();
                Some(Pair { name, before, after })
            });
            let pairs: Vec<Pair> = shortened(pairs.collect());
            match draw(&pairs, &scenario.id, report::TOLERANCE, &reading) {
                Ok(drawing) => {
                    let section = format!("baseline/{}", scenario.id);
                    let input = simulate::write(drawing, &section, out)?;
                    view.figures.push(report::figure_view(&section, &input));
                }
                Err(FigureError::MissingData(_)) => {}
                Err(why) => return Err(Error::Unfinished(why.to_string())),
            }
        }
        let old: BTreeMap<&str, &FigureView> =
            self.view.figures().into_iter().map(|f| (f.anchor.as_str(), f)).collect();
        for figure in now.figures() {
            let Some(before) = old.get(figure.anchor.as_str()).filter(|old| !old.svg.is_empty()) else { continue };
            let file = before.files.iter().find(|file| file.kind == "SVG");
            let Some(file) = file.filter(|_| before.svg != figure.svg) else { continue };
            let name = format!("baseline/{}", file.name);
            out.write(&name, before.svg.as_bytes())?;
            view.pictures.push(PictureView {
                title: figure.title.clone(),
                anchor: figure.anchor.clone(),
                href: report::anchor::href(&name),
                before: name,
                svg: before.svg.clone(),
            });
        }
        Ok(view)
    }
}

/// The gate that nothing is worse than before.
pub fn no_regression(view: &BaselineView) -> Judged {
    let of = |verdict| view.changes.iter().filter(|change| change.verdict == verdict).count();
    // What is no longer judged may hide anything.
    let (worse, gone) = (of(Change::Regressed), of(Change::Gone));
    Judged {
        scenario: view.path.clone(),
        gate: "no_regression".into(),
        found: format!("{worse} regressed, {gone} gone"),
        demanded: "none".into(),
        value: Some((worse + gone) as f64),
        limit: Some(0.0),
        holds: worse + gone == 0,
    }
}

/// What differs in lines of text.
pub fn words(view: &BaselineView) -> Vec<String> {
    let mut lines = vec![format!("against {}: {}", view.path, view.sentence)];
    lines.extend(view.notes.iter().map(|note| format!("  note: {note}")));
    for verdict in Change::ALL {
        let all: Vec<&ChangeView> = view.changes.iter().filter(|change| change.verdict == verdict).collect();
        for c in all.iter().take(TOLD) {
            let by = if c.by.is_empty() { String::new() } else { format!(" ({})", c.by) };
            let (before, after) = (&c.before.text, &c.after.text);
            lines.push(format!("  {}: {}: {}: {before} → {after}{by}", verdict.words(), c.subject, c.what));
        }
        if all.len() > TOLD {
            lines.push(format!("  {}: and {} more", verdict.words(), all.len() - TOLD));
        }
    }
    for input in view.inputs.iter().take(TOLD) {
        let what = match (input.before.is_empty(), input.after.is_empty()) {
            (true, _) => "is new".into(),
            (_, true) => "is gone".into(),
            _ if input.keys.is_empty() => "has other bytes".into(),
            _ => format!("has other values: {}", input.keys.join("; ")),
        };
        lines.push(format!("  input {} ({}) {what}", input.id, input.path));
    }
    if view.inputs.len() > TOLD {
        lines.push(format!("  and {} more inputs", view.inputs.len() - TOLD));
    }
    lines
}

/// Whether a name leads to a file below a folder.
pub fn inside(name: &str) -> bool {
    !name.is_empty()
        && !name.contains('\\')
        && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// Curves of a `curves.csv`, named by what stands in their rows, and what they are of; rows that are no numbers are
/// passed over.
fn parse(text: &str) -> (Curves, Signal) {
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
    let Ok(header) = reader.headers().cloned() else { return (Vec::new(), Signal::ANGLE) };
    let column = |name: &str| header.iter().position(|cell| cell == name);
    let reading = Signal::READINGS.into_iter().find(|reading| column(reading.reading_column()).is_some());
    let reading = reading.unwrap_or(Signal::ANGLE);
    let (Some(frequency), Some(amplitude)) = (column("frequency_hz"), column(reading.reading_column())) else {
        return (Vec::new(), reading);
    };
    let others = Signal::DRIVES.iter().filter(|drive| **drive != Signal::DRIVE_DISPLACEMENT);
    let others = others.map(|drive| (drive.drive_column(), drive.symbol, 1.0, drive.unit));
    let scaled = [
        ("drive_m", "u₀", 1e6, "µm"),
        ("load_n", "W", 1.0, "N"),
        ("friction", "μ", 1.0, ""),
        ("speed_m_s", "V", 1e3, "mm/s"),
    ];
    let mut curves: Curves = Vec::new();
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for row in reader.records().flatten() {
        let number = |index: usize| row.get(index).and_then(|cell| cell.parse::<f64>().ok());
        let (Some(f), Some(a)) = (number(frequency), number(amplitude)) else { continue };
        let mut parts = Vec::new();
        for name in ["formulation", "euler_steps", "branch"] {
            parts.extend(column(name).and_then(|c| row.get(c)).filter(|cell| !cell.is_empty()).map(String::from));
        }
        for (name, symbol, factor, unit) in scaled.into_iter().chain(others.clone()) {
            let value =
                column(name).and_then(number).map(|value| crate::figures::style::significant(factor * value, 4));
            parts.extend(value.map(|value| format!("{symbol} = {value} {unit}").trim_end().to_string()));
        }
        let name = parts.join(", ");
        let place = *places.entry(name.clone()).or_insert_with(|| {
            curves.push((name, Vec::new()));
            curves.len() - 1
        });
        curves[place].1.push((f, a));
    }
    (curves, reading)
}

/// The pairs with names without what all of them have in common.
fn shortened(mut pairs: Vec<Pair>) -> Vec<Pair> {
    let parts = |name: &str| name.split(", ").map(String::from).collect::<Vec<_>>();
    let Some(first) = pairs.first().map(|pair| parts(&pair.name)).filter(|_| pairs.len() > 1) else { return pairs };
    let common: Vec<String> =
        first.into_iter().filter(|part| pairs.iter().all(|pair| parts(&pair.name).contains(part))).collect();
    for pair in &mut pairs {
        pair.name = parts(&pair.name).into_iter().filter(|part| !common.contains(part)).collect::<Vec<_>>().join(", ");
    }
    pairs
}
