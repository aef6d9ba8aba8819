//! `stickslip compare`: the model against measurements, and where it fails.

use super::figure_output::FigureOutput;
use super::folder::Folder;
use super::gates::{self, GateLimits};
use super::plot::{self, Plot};
use super::{Global, Json, Stamped, page, say, simulate};
use crate::compare::{self, Comparison, Options, Outlier, outlier_words};
use crate::discover::open_ends;
use crate::error::{Error, Result};
use crate::figures::style::{budget_percent, count};
use crate::fit::{Identified, Interval, Parameter};
use crate::gate;
use crate::measurement::{self, Table};
use crate::scenario::{self, Formulation, Scenario, Signals};
use crate::units;
use std::path::Path;

/// Regions shown on the terminal.
const REGIONS: usize = 8;

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    /// The scenario.
    pub path: &'a Path,
    /// Where the JSON goes, if anywhere.
    pub json: Option<&'a Json>,
    /// Folder of the figures, if they are wanted.
    pub out: Option<(&'a Path, &'a FigureOutput)>,
    /// Seed of the fit.
    pub seed: u32,
    /// Gates in place of the scenario's own.
    pub limits: &'a GateLimits,
    /// Whether plots in characters are wanted.
    pub plot: Plot,
}

/// Compares a scenario with its measurements, and holds the comparison to its gates.
pub fn execute(job: &Job<'_>, global: &Global) -> Result<()> {
    let Job { path, json, out, seed, limits, plot } = *job;
    let (mut scenario, table) = with_measurements(path)?;
    limits.apply(&mut scenario.gate);
    if let Some(json) = json {
        json.free(compare::SCHEMA, out.map(|(out, _)| out))?;
    }
    let inputs = || [path, table.file.as_path()];
    let out = out.map(|(out, drawn)| Folder::open(out, drawn, inputs())).transpose()?;
    let out = out.as_ref();
    let comparison = compare::compare(&scenario, &table, &Options { seed });
    let judged = gate::of_comparison(&scenario.gate, &comparison);
    if let Some(json) = json {
        json.write(&Stamped::new(&compare::json(&comparison), &judged), compare::SCHEMA)?;
    }
    let drawn = out.map(|out| simulate::comparison(&comparison, out)).transpose()?;
    let command = format!("stickslip compare {} --seed {seed}", path.display());
    let section = || page::section(&comparison.scenario).with_comparison(&comparison, drawn.as_deref().unwrap_or(&[]));
    let written = out.map(|out| page::write(section(), &judged, &command, out)).transpose()?;
    if !json.is_some_and(Json::to_standard_output) {
        for line in words(&comparison) {
            say(global, &line)?;
        }
        if plot.wanted() {
            plot::curves(&[('.', "model", &comparison)]).iter().try_for_each(|line| say(global, line))?;
        }
        let names = drawn.iter().flatten().flat_map(|figure| &figure.files);
        for (name, out) in names.zip(std::iter::repeat(out)) {
            say(global, &format!("  {}", out.map_or_else(|| name.into(), |out| out.path().join(name)).display()))?;
        }
        written.iter().try_for_each(|page| say(global, &format!("wrote {}", page.display())))?;
        gates::told(&judged, global)?;
        gates::claims_elsewhere(&scenario.gate, global)?;
        let open = scenario.gate.needs_discovery();
        if !open.is_empty() {
            say(
                global,
                &format!("not judged here: {} of [gate]; `stickslip discover` and `report` do", open.join(" and ")),
            )?;
        }
    }
    gates::passed(&judged)
}

/// A scenario and its table; an error where it names none.
pub(super) fn with_measurements(path: &Path) -> Result<(Scenario, Table)> {
    let scenario = scenario::load(path)?;
    let Some(table) = table(&scenario)? else {
        return Err(Error::Input(format!(
            "error: {} names no measurements to compare with\n  = help: add a table [measurement] with file = \"table.csv\"",
            path.display()
        )));
    };
    Ok((scenario, table))
}

/// The measurements of a scenario, where it names some.
pub(super) fn table(scenario: &Scenario) -> Result<Option<Table>> {
    let table = measurement::load(scenario)?;
    if table.is_some() && scenario.contact.is_some_and(|contact| contact.formulation == Formulation::Paper) {
        return Err(Error::Input(format!(
            "error: {}: measurements are compared with formulation = \"series\"\n  = help: the published procedure is \
             within 0.4 % of it; change or remove formulation in [contact]",
            scenario.path.display()
        )));
    }
    Ok(table)
}

/// The scenario whose sweep is simulated: what is read in it is what was measured, where anything was.
pub(super) fn swept(scenario: &Scenario, table: Option<&Table>) -> Scenario {
    let reading = table.map_or(scenario.signals.reading, |table| table.signals.reading);
    Scenario { signals: Signals { reading, ..scenario.signals }, ..scenario.clone() }
}

/// The comparison of a scenario with its table in a report.
pub(super) fn compare(scenario: &Scenario, table: &Table) -> Comparison {
    compare::compare(scenario, table, &Options { seed: 0 })
}

/// Said where a scenario with measurements leaves everything as stated.
pub(super) fn uncalibrated(scenario: &Scenario) -> Option<String> {
    // What nobody knows before the measurement: a contact, or resonance and damping of a rig.
    let usual = if scenario.contact.is_some() {
        "contact.stiffness and contact.damping".into()
    } else {
        let of_mode = scenario.rig.parameters().into_iter().filter(|(at, _)| [1, 2].contains(at));
        of_mode.map(|(_, info)| format!("rig.{}", info.key)).collect::<Vec<_>>().join(" and ")
    };
    let told = || format!("nothing is calibrated: [fit] free names no parameter; {usual} are the usual ones");
    scenario.free.is_empty().then(told)
}

/// chi2 per reading without what stands out, in words.
fn without_outliers(c: &Comparison) -> Option<String> {
    Some(format!("{:.2} without {}", c.chi2_without_outliers()?, outlier_words(c.outliers.len())))
}

/// Where a reading that stands out is, and by how much.
fn stands_out(c: &Comparison, outlier: &Outlier) -> String {
    let point = c.table.points.iter().find(|p| p.row == outlier.row);
    let line = point.map_or(0, |p| p.line);
    let place = if line > 0 { format!("line {line} (row {})", outlier.row) } else { format!("row {}", outlier.row) };
    let pooled = match point.map_or(1, |p| p.replicates) {
        0 | 1 => String::new(),
        several => format!(", the first of {several} pooled rows"),
    };
    let off = |sigma: f64| format!("{:.1} sigma {}", sigma.abs(), if sigma < 0.0 { "above" } else { "below" });
    let from_model = format!("{} the model", off(outlier.sigma));
    let told = if outlier.off_neighbours == outlier.sigma {
        from_model
    } else {
        format!("{} the course of its neighbours, {from_model}", off(outlier.off_neighbours))
    };
    format!("outlier: {place}{pooled}, {}: {told}", outlier.column)
}

/// The comparison in lines of text.
pub(super) fn words(c: &Comparison) -> Vec<String> {
    let m = &c.overall;
    let (points, conditions) = (count(m.points, "point"), count(c.conditions.len(), "condition"));
    let mut lines = vec![format!("{}: {points}, {conditions}", c.scenario.title)];
    let notes = c.table.notes.iter().chain(&c.notes).cloned().chain(uncalibrated(&c.scenario));
    lines.extend(notes.map(|note| format!("  note: {note}")));
    if !c.fit.parameters.is_empty() {
        lines.push(format!("calibrated ({}):", interval_words(c)));
        lines.extend(c.fit.parameters.iter().zip(&c.intervals).map(|(p, i)| format!("  {}", parameter(p, i))));
    }
    let phase = match (m.rms_phase_deg, m.noise_phase_deg) {
        (Some(error), Some(noise)) => format!("; phase {error:.2}° rms (noise {noise:.2}°)"),
        _ => String::new(),
    };
    lines.push(format!(
        "error: chi2 per reading {:.2}{}; amplitude {:.2} % rms (noise {:.2} %){phase}",
        m.chi2_per_point,
        without_outliers(c).map_or(String::new(), |without| format!(" ({without})")),
        m.rms_error_percent,
        m.noise_percent
    ));
    let b = c.error_budget();
    lines.push(format!(
        "error budget (squares add up): model {:.2} %, noise{} {:.2} %, numerics {}",
        b.model_percent,
        if c.outliers.iter().any(|o| !o.is_phase()) { " and what stands out" } else { "" },
        b.noise_percent,
        budget_percent(b.numerical_percent)
    ));
    lines.push(verdict(c));
    lines.extend(compare::shifts(c).iter().map(|shift| format!("  {shift}")));
    if !c.regions.is_empty() {
        lines.push("where it fails:".into());
        lines.extend(c.regions.iter().take(REGIONS).map(|region| format!("  {}", region.sentence)));
        if c.regions.len() > REGIONS {
            lines.push(format!("  and {} more", c.regions.len() - REGIONS));
        }
    }
    lines.extend(outlier_lines(c, &c.outliers, REGIONS));
    if c.whiteness.structured {
        lines.push(format!("next: stickslip discover {}", c.scenario.path.display()));
    }
    lines
}

/// Outliers in lines, `most` of them.
pub(super) fn outlier_lines(c: &Comparison, outliers: &[Outlier], most: usize) -> Vec<String> {
    let mut lines: Vec<String> = outliers.iter().take(most).map(|outlier| stands_out(c, outlier)).collect();
    if outliers.len() > most {
        let more = units::count(outliers.len() - most, "reading");
        let verb = if outliers.len() - most == 1 { "stands" } else { "stand" };
        lines.push(format!("and {more} more that {verb} out (see --json)"));
    }
    lines
}

/// What intervals are.
pub(super) fn interval_words(c: &Comparison) -> &'static str {
    if c.whiteness.structured {
        "95 % interval, were the model right, which the data contradict"
    } else {
        "95 % interval"
    }
}

/// What the residuals look like.
pub(super) fn verdict(c: &Comparison) -> String {
    let w = &c.whiteness;
    let tests = format!(
        "{}runs {} of {:.0} expected, autocorrelation {:.2}, smooth part {:.1} times the rest",
        if w.as_read { "in the order of the rows: " } else { "" },
        w.runs,
        w.runs_expected,
        w.autocorrelation,
        w.smooth_ratio
    );
    if !w.testable {
        "whether the misfit has structure cannot be tested: the series have too few neighbouring readings".into()
    } else if w.exceeds {
        format!("what is left is larger than the readings scatter along their series: no noise ({tests})")
    } else if w.structured {
        format!("the misfit is structured, not noise ({tests})")
    } else {
        format!("what is left looks like noise ({tests})")
    }
}

/// A parameter with its interval.
pub(super) fn parameter(parameter: &Parameter, interval: &Interval) -> String {
    let [value, low, high] = units::format_interval([interval.value, interval.low, interval.high], parameter.unit);
    let range = format!("{low} to {high}");
    match interval.identified {
        Identified::Yes => format!("{} = {value} ({range})", parameter.key),
        Identified::OneSided => {
            // The end that the data set, and what fits best within the bounds of the search.
            let limit = if open_ends(parameter, interval).1 { format!("> {low}") } else { format!("< {high}") };
            format!("{} {limit} (95 %; {value} fits best, and these data set no other end)", parameter.key)
        }
        Identified::No => format!("{}: not determined by these data ({value} used)", parameter.key),
    }
}
