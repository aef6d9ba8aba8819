//! From scenarios to outcomes, drawings and the files beside the report.

use super::figure_output::{FigureOutput, Format};
use super::folder::Folder;
use crate::atlas;
use crate::compare::Comparison;
use crate::discover::Discovery;
use crate::error::{Error, Result};
use crate::figures::{self, Drawing, Figure, FigureError};
use crate::free_form::FreeForm;
use crate::report::{self, EffectView, FigureInput};
use crate::scenario::{Coordinate, Scenario};
use crate::solver::SteadyState;
use crate::sweep::{self, Condition, Outcome};
use crate::trial::{Series, Summary};
use rayon::prelude::*;

/// Pixels of a PNG per logical pixel of its figure.
const PNG_SCALE: f32 = 2.0;
/// Figures of a scenario that names none, as far as it has what they show.
const DEFAULT_FIGURES: [&str; 2] = ["resonance", "velocity-amplitude"];

/// Solves every point of a scenario.
pub fn outcome(scenario: &Scenario, quiet: bool) -> Outcome {
    let orbits = selected_figures(scenario).iter().any(|figure| figure.needs_orbits());
    sweep::run(scenario, &sweep::Options { orbits, progress: !quiet })
}

fn selected_figures(scenario: &Scenario) -> Vec<&'static dyn Figure> {
    let find = |name: &str| figures::find(figures::REGISTRY, name);
    match &scenario.figures {
        Some(names) => names.iter().filter_map(|name| find(name)).collect(),
        None => DEFAULT_FIGURES.iter().filter_map(|name| find(name)).collect(),
    }
}

/// Draws the figures of every outcome and writes them with the curves below `out`; what the report needs of them, per
/// outcome.
pub fn figures(outcomes: &[Outcome], out: &Folder) -> Result<Vec<Vec<FigureInput>>> {
    let jobs: Vec<(&Outcome, &dyn Figure)> = outcomes
        .iter()
        .flat_map(|outcome| selected_figures(&outcome.scenario).into_iter().map(move |f| (outcome, f)))
        .collect();
    let drawn: Vec<Option<FigureInput>> = jobs
        .par_iter()
        .map(|(outcome, figure)| {
            match figure.draw(outcome) {
                Ok(drawing) => write(drawing, &outcome.scenario.id, out).map(Some),
                // A default figure that the sweep cannot fill is left out; one that was asked for is an error.
                Err(FigureError::MissingData(_)) if outcome.scenario.figures.is_none() => Ok(None),
                Err(why) => {
                    let path = outcome.scenario.path.display();
                    // No sweep gives a rig a contact.
                    let extend = if outcome.scenario.contact.is_some() { "extend the sweep, or " } else { "" };
                    let help = format!("{extend}take the name out of `figures`");
                    Err(Error::Input(format!("error: {path}: {why}\n  = help: {help}")))
                }
            }
        })
        .collect::<Result<_>>()?;
    outcomes
        .par_iter()
        .filter(|outcome| !outcome.curves.is_empty())
        .try_for_each(|outcome| out.write(&curves_name(&outcome.scenario.id), curves(outcome).as_bytes()))?;
    let mut drawn = drawn.into_iter();
    Ok(outcomes.iter().map(|o| drawn.by_ref().take(selected_figures(&o.scenario).len()).flatten().collect()).collect())
}

/// Draws the atlas of effects on the rig of `scenario` and writes it below `out`; the sections of the report.
pub fn atlas(scenario: &Scenario, out: &Folder) -> Result<Vec<EffectView>> {
    let entries = atlas::run(scenario);
    let drawn = entries.par_iter().map(|entry| {
        let drawing = figures::atlas::draw(entry).map_err(|why| Error::Unfinished(why.to_string()))?;
        Ok(report::effect_view(entry.effect, &write(drawing, "atlas", out)?))
    });
    drawn.collect()
}

/// Draws those figures of a registry that the subject can fill, and writes them into the folder `id` below `out`.
fn drawn<T: Sync + 'static>(
    registry: &[&'static dyn Figure<T>],
    subject: &T,
    id: &str,
    out: &Folder,
) -> Result<Vec<FigureInput>> {
    let drawings = figures::drawings(registry, subject).map_err(|why| Error::Unfinished(why.to_string()))?;
    drawings.into_par_iter().map(|drawing| write(drawing, id, out)).collect()
}

/// Draws the figures of a comparison that its measurements can fill, and writes them below `out`.
pub fn comparison(comparison: &Comparison, out: &Folder) -> Result<Vec<FigureInput>> {
    drawn(figures::comparison::REGISTRY, comparison, &comparison.scenario.id, out)
}

/// Draws the figures of a discovery that it can fill, and writes them below `out`.
pub fn discovery(discovery: &Discovery, out: &Folder) -> Result<Vec<FigureInput>> {
    drawn(figures::discovery::REGISTRY, discovery, &discovery.explanation().comparison.scenario.id, out)
}

/// Draws the figures of the free form of a scenario and writes them below `out`.
pub fn free_form(found: &FreeForm, id: &str, out: &Folder) -> Result<Vec<FigureInput>> {
    drawn(figures::discovery::FREE_FORM, found, id, out)
}

/// Draws the figures of a series of trials and writes them below `out`.
pub fn trial(summary: &Summary, out: &Folder) -> Result<Vec<FigureInput>> {
    drawn(figures::trial::REGISTRY, summary, "figures", out)
}

/// Draws the figures of the trials that come with the program and writes them below `out`.
pub fn committed_trials(main: &Series, others: &[Series], out: &Folder) -> Result<Vec<FigureInput>> {
    let mut figures = trial(&main.summary, out)?;
    for series in others {
        figures.extend(drawn(figures::trial::OF_SCORES, &series.summary, "figures", out)?);
    }
    Ok(figures)
}

/// Writes those files of a drawing that are wanted into the folder `id` below `out`.
pub(super) fn write(drawing: Drawing, id: &str, out: &Folder) -> Result<FigureInput> {
    let FigureOutput { format, preset } = out.drawn();
    let mut names = Vec::new();
    for kind in [Format::Svg, Format::Png, Format::Csv].into_iter().filter(|kind| format.contains(kind)) {
        let bytes = match (kind, preset) {
            (Format::Svg, None) => drawing.svg.clone().into_bytes(),
            (Format::Svg, Some(preset)) => preset.svg(&drawing.svg).into_bytes(),
            (Format::Png, None) => {
                figures::png(&drawing.svg, PNG_SCALE).map_err(|e| Error::Unfinished(e.to_string()))?
            }
            (Format::Png, Some(preset)) => preset.png(&drawing.svg).map_err(|e| Error::Unfinished(e.to_string()))?,
            (Format::Csv, _) => drawing.csv.clone().into_bytes(),
        };
        let name = format!("{id}/{}.{}", drawing.name, kind.ending());
        out.write(&name, &bytes)?;
        names.push(name);
    }
    if let Some(svg) = drawing.narrow.as_ref().filter(|_| format.contains(&Format::Svg)) {
        let name = format!("{id}/{}{}", drawing.name, report::NARROW_ENDING);
        let svg = preset.map_or_else(|| svg.clone(), |preset| preset.svg(svg));
        out.write(&name, svg.as_bytes())?;
        names.push(name);
    }
    let Drawing { name, title, caption, alt, svg, narrow, csv, notes, reading } = drawing;
    Ok(FigureInput { name, title, caption, alt, svg, narrow, csv, notes, reading, files: names })
}

/// Name of the file with every steady state of the scenario `id`.
pub fn curves_name(id: &str) -> String {
    format!("{id}/curves.csv")
}

/// Every steady state of an outcome as CSV.
fn curves(outcome: &Outcome) -> String {
    let columns = columns(&outcome.scenario);
    let mut text = columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",") + "\n";
    for curve in &outcome.curves {
        let up = curve.frequency.iter().zip(&curve.states).map(|(f, s)| (f, s, "up"));
        let down = curve.frequency.iter().zip(&curve.down).filter_map(|(f, s)| s.as_ref().map(|s| (f, s, "down")));
        for (frequency, state, branch) in up.chain(down) {
            // A curve without a second branch has none to name.
            let branch = if curve.down.is_empty() { "" } else { branch };
            let row = Row { condition: &curve.condition, frequency: *frequency, state, branch };
            // A point without an answer has its status, and no numbers.
            let cells =
                columns.iter().map(|(_, cell)| Some(cell(&row)).filter(|text| text != "NaN").unwrap_or_default());
            text += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
    }
    text
}

/// One steady state of a sweep.
struct Row<'a> {
    condition: &'a Condition,
    frequency: f64,
    state: &'a SteadyState,
    branch: &'static str,
}

/// A column and its cell in a row.
type Column = (&'static str, fn(&Row<'_>) -> String);

/// The columns of a scenario's curves: of a contact only where there is one.
fn columns(scenario: &Scenario) -> Vec<Column> {
    let contact = scenario.contact.is_some();
    let mean = match scenario.rig.coordinate() {
        Coordinate::Angle => "mean_rad",
        Coordinate::Displacement => "mean_m",
    };
    let all: [(bool, Column); 18] = [
        (contact, ("formulation", |row| crate::report::formulation(row.condition.formulation).into())),
        (contact, ("euler_steps", |row| row.condition.euler_steps.to_string())),
        (true, (scenario.signals.drive.drive_column(), |row| format!("{:e}", row.condition.drive))),
        (contact, ("load_n", |row| row.condition.load.to_string())),
        (contact, ("friction", |row| row.condition.friction.to_string())),
        (contact, ("speed_m_s", |row| format!("{:e}", row.condition.speed))),
        (true, ("frequency_hz", |row| row.frequency.to_string())),
        (true, (scenario.signals.reading.reading_column(), |row| format!("{:.9e}", row.state.amplitude))),
        (true, ("phase_rad", |row| format!("{:.9}", row.state.phase))),
        (true, (mean, |row| format!("{:.9e}", row.state.mean))),
        (contact, ("speed_amplitude_m_s", |row| format!("{:.9e}", row.state.speed_amplitude))),
        (contact, ("stick_fraction", |row| format!("{:.6}", row.state.stick_fraction))),
        (contact, ("force_minimum_n", |row| format!("{:.9e}", row.state.force_minimum))),
        (contact, ("force_maximum_n", |row| format!("{:.9e}", row.state.force_maximum))),
        (true, ("cycles", |row| row.state.cycles.to_string())),
        (true, ("periodicity_error", |row| format!("{:.1e}", row.state.periodicity_error))),
        (true, ("status", |row| row.state.status.word().into())),
        (true, ("branch", |row| row.branch.into())),
    ];
    all.into_iter().filter(|(wanted, _)| *wanted).map(|(_, column)| column).collect()
}
