//! `stickslip discover`: which effect is missing.

use super::bounds::Limits;
use super::changed_scenario::{Edit, Rewriting};
use super::compare::{interval_words, outlier_lines, parameter, uncalibrated, verdict, with_measurements};
use super::figure_output::FigureOutput;
use super::folder::Folder;
use super::gates::{self, GateLimits, Verdicts};
use super::plot::{self, Plot};
use super::{Global, Json, Stamped, page, progress, say, simulate};
use crate::compare::{self, Comparison, outlier_words};
use crate::discover::{self, Addition, Basis, Candidate, Discovery, SearchOptions, Verdict};
use crate::effects::{self, Effect};
use crate::error::Result;
use crate::fit::Correlation;
use crate::free_form::{self, FreeForm};
use crate::gate::{self, Judged};
use crate::measurement::Table;
use crate::scenario::Scenario;
use crate::units::Frequencies;
use schemars::JsonSchema;
use std::path::{Path, PathBuf};

/// Candidates shown on the terminal.
const CANDIDATES: usize = 6;
/// Outliers, regions, ties shown there.
const SHOWN: usize = 3;
/// What stands in the columns of the candidates.
const LEGEND: &str = "  delta BIC: BIC above the best (misfit and penalty for parameters), 6 is 20 to 1; weight: share of the evidence; left-out: \
                      error at series that were not fitted; from: what was fitted";

/// The terms of what is printed, for `--help`.
pub const TERMS: &str = "What is printed: chi2 is the mean square of the residuals in standard deviations, 1 where nothing but noise is \
    left. rms error is that of the amplitude. left-out is the error at series that were predicted from the others. delta BIC is the Bayesian \
    information criterion (misfit and penalty for parameters) above that of the best: what is within 6 (20 to 1) is not decided. weight is the share of \
    the evidence. tied: the data do not tell them apart. nested in: a special case of. docs/search.md tells how the search goes and from \
    which figures each verdict follows. A budget that is spent ends with what is best so far, is said, and is no failure: exit status 0.";

/// What is asked for.
pub struct Job<'a> {
    /// The scenario.
    pub path: &'a Path,
    /// Where its JSON goes.
    pub json: Option<&'a Json>,
    /// Folder of the page and the figures, if they are wanted.
    pub out: Option<(&'a Path, &'a FigureOutput)>,
    /// Where the scenario goes as it is explained.
    pub output: Option<&'a Path>,
    /// Whether the free form is told whatever the verdict.
    pub free_form: bool,
    /// Whether plots in characters are wanted.
    pub plot: Plot,
}

/// A discovery with the free form beside it, in JSON.
#[derive(JsonSchema, serde::Serialize)]
pub struct Told<'a> {
    #[serde(flatten)]
    discovery: &'a discover::DiscoveryJson,
    #[serde(flatten)]
    free_form: free_form::FreeFormJson,
}

/// Searches for what is missing in a scenario's model, and holds the result to its gates; the JSON goes to `json` where
/// given.
pub fn execute(
    &Job { path, json, out, output, free_form, plot }: &Job<'_>,
    (options, bounds): (&SearchOptions, &Limits),
    (limits, verdict): (&GateLimits, &Verdicts),
    global: &Global,
) -> Result<()> {
    let (stated, table) = with_measurements(path)?;
    let mut scenario = stated.clone();
    limits.apply(&mut scenario.gate);
    verdict.apply(&mut scenario.gate);
    if let Some(json) = json {
        output.map_or(Ok(()), |output| json.differs_from("-o", output))?;
        json.free(discover::SCHEMA, out.map(|(out, _)| out))?;
    }
    let inputs = || [path, table.file.as_path()];
    let out = out.map(|(out, drawn)| Folder::open(out, drawn, inputs())).transpose()?;
    let file = output.map(|output| Rewriting::begin(path, Some(output), &table.file)).transpose()?;
    file.as_ref().map_or(Ok(()), |file| Edit::new(&stated, file).trial())?;
    let options = SearchOptions { bounds: bounds.of(&scenario, &table)?, ..options.clone() };
    let discovery = progress::of_searches(global, 1, options.budget, |solved| {
        discover::discover_counted(&scenario, &table, &options, &solved[0])
    });
    let mut judged = gate::of_comparison(&scenario.gate, &discovery.steps[0].comparison);
    judged.extend(gate::of_discovery(&scenario.gate, &discovery));
    let asked = free_form;
    let free_form = discover::beside(&discovery, asked);
    if let Some(json) = json {
        let free_form = free_form::json(free_form.as_ref());
        let told = Told { discovery: &discover::json(&discovery), free_form };
        json.write(&Stamped::new(&told, &judged), discover::SCHEMA)?;
    }
    let page = out.map(|out| written((&discovery, free_form.as_ref()), &judged, path, &out)).transpose()?;
    if !json.is_some_and(Json::to_standard_output) {
        for line in words(&discovery, output) {
            say(global, &line)?;
        }
        free_form.iter().flat_map(|found| free_form::lines(found, asked)).try_for_each(|line| say(global, &line))?;
        if plot.wanted() {
            plots(&discovery).iter().try_for_each(|line| say(global, line))?;
        }
        page.iter().try_for_each(|page| say(global, &format!("wrote {}", page.display())))?;
        gates::told(&judged, global)?;
        gates::claims_elsewhere(&scenario.gate, global)?;
    }
    if let Some(file) = &file {
        file.write(&explained(&discovery, &stated, file)?)?;
        if !json.is_some_and(Json::to_standard_output) {
            say(global, &format!("wrote {}", file.to().display()))?;
        }
    }
    gates::passed(&judged)
}

/// The scenario with what explains its measurements.
fn explained(d: &Discovery, scenario: &Scenario, file: &Rewriting<'_>) -> Result<String> {
    let end = d.explanation();
    let mut edit = Edit::new(scenario, file);
    for addition in &end.hypothesis.additions {
        match *addition {
            Addition::Effect(effect) => edit.add.push(effect),
            Addition::Recalibration(key) => edit.numbers.push(key.into()),
        }
    }
    edit.fitted(&end.comparison)
}

/// The page of a discovery, with the comparison that it began with.
fn written(
    (d, free_form): (&Discovery, Option<&FreeForm>),
    judged: &[Judged],
    path: &Path,
    out: &Folder,
) -> Result<PathBuf> {
    let base = &d.steps[0].comparison;
    let (compared, discovered) = (simulate::comparison(base, out)?, simulate::discovery(d, out)?);
    let section = page::section(&base.scenario).with_comparison(base, &compared).with_discovery(d, &discovered);
    let section = match free_form {
        Some(found) => section.with_free_form(found, &simulate::free_form(found, &base.scenario.id, out)?),
        None => section,
    };
    page::write(section, judged, &format!("stickslip discover {}", path.display()), out)
}

/// The curve before and after, and the fall of the error, in characters.
fn plots(d: &Discovery) -> Vec<String> {
    let (base, end) = (&d.steps[0].comparison, &d.explanation().comparison);
    let models = [('.', "model before", base), ('*', "model, corrected", end)];
    let mut lines = plot::curves(if d.steps.len() > 1 { &models } else { &models[..1] });
    let steps: Vec<_> = d.steps.iter().map(|step| (step.name(), step.comparison.overall.chi2_per_point)).collect();
    lines.extend(plot::fall(&steps));
    lines
}

/// The discovery in lines of text; it is written into that scenario, if into any.
pub(super) fn words(d: &Discovery, output: Option<&Path>) -> Vec<String> {
    let c = &d.explanation().comparison;
    let mut lines = vec![format!("{}: {}", c.scenario.title, discover::sentence(d))];
    let notes = c.table.notes.iter().chain(&d.notes);
    lines.extend(notes.cloned().chain(uncalibrated(&c.scenario)).map(|note| format!("note: {note}")));
    lines.extend(compare::shifts(&d.steps[0].comparison).iter().map(|shift| format!("  before: {shift}")));
    lines.extend(ladder(d, c));
    lines.push(format!("parameters ({}):", interval_words(c)));
    lines.extend(c.fit.parameters.iter().zip(&c.intervals).map(|(p, i)| format!("  {}", parameter(p, i))));
    lines.extend(tied(d));
    lines.push(verdict(c));
    lines.extend(candidates(d, c.table.points.len()));
    for group in &d.indistinguishable {
        lines.push(format!("these data do not tell apart: {}", group.join(", ")));
    }
    lines.extend(nested(d));
    lines.extend(not_testable(d));
    lines.extend(misfits(d, c));
    if let Some(next) = d.next_worth() {
        let [one, other] = &next.separates;
        lines.push(format!(
            "measure next: {}, f = {}: {one} and {other} differ by {:.1} sigma there, {}",
            compare::words(&next.setting),
            digits(&c.table).difference(next.frequency_hz),
            next.sigma,
            next.meaning()
        ));
    }
    lines.extend(step(d, output));
    lines
}

/// The steps of the ladder, and their chi2 without the outliers of its end `c`.
fn ladder(d: &Discovery, c: &Comparison) -> Vec<String> {
    let mut lines = vec!["ladder:                                chi2   rms error  left-out".into()];
    for step in &d.steps {
        let overall = &step.comparison.overall;
        let held_out = step.held_out.map_or("-".into(), |h| format!("{:.2} %", h.rms_percent));
        let name = step.name();
        lines.push(format!(
            "  {name:<32} {:>9.2} {:>9.2} % {held_out:>9}",
            overall.chi2_per_point, overall.rms_error_percent
        ));
    }
    let without: Option<Vec<String>> =
        d.steps.iter().map(|step| Some(format!("{:.2}", step.comparison.chi2_without(c)?))).collect();
    lines.extend(without.map(|all| format!("  chi2 without {}: {}", outlier_words(c.outliers.len()), all.join(", "))));
    lines
}

/// The candidates that rank first.
fn candidates(d: &Discovery, points: usize) -> Vec<String> {
    let mut lines = vec!["candidates:                       delta BIC  weight      chi2  left-out  from".into()];
    // What does no better than a smaller one that it contains says nothing of its own.
    let own = |c: &Candidate| c.hypothesis.basis() != Basis::Contained;
    let shown = d.leading(CANDIDATES, own);
    lines.extend(shown.iter().map(|candidate| ranked(candidate, points)));
    if d.candidates.len() > shown.len() {
        let open = d.candidates.iter().filter(|c| c.is_open).count();
        let open = if open > 0 { format!(", {open} estimated to do as well and not fitted") } else { String::new() };
        let weight: f64 = 1.0 - shown.iter().map(|c| c.weight).sum::<f64>();
        let together = Some(format!("{weight:.3}")).filter(|weight| !weight.trim_matches(['0', '.', '-']).is_empty());
        let together = together.map_or(String::new(), |weight| format!(", weight {weight} together"));
        lines.push(format!("  and {} more{together} (see --json){open}", d.candidates.len() - shown.len()));
    }
    lines.push(LEGEND.into());
    lines
}

/// Effects of the explanation that are special cases of others that were asked for.
fn nested(d: &Discovery) -> Vec<String> {
    let containing = |name: &str| -> Vec<&str> {
        let asked = d.asked.iter().filter_map(|other| effects::find(other));
        asked.filter(|effect| effect.contains().contains(&name)).map(Effect::name).collect()
    };
    let named = d.explanation().hypothesis.effects();
    let of = |name: &String| Some((name.clone(), containing(name))).filter(|(_, others)| !others.is_empty());
    let say = |(name, others): (String, Vec<&str>)| {
        format!("{name} is nested in {}: where the two do as well the simpler one is named", others.join(" and in "))
    };
    named.iter().filter_map(of).map(say).collect()
}

/// The effects that the data cannot show, on one line.
fn not_testable(d: &Discovery) -> Option<String> {
    if d.not_testable.is_empty() {
        return None;
    }
    let names: Vec<&str> = d.not_testable.iter().map(|e| e.effect.as_str()).collect();
    let show = d.not_testable.iter().find(|e| !e.would_show.is_empty());
    let shows = match show {
        Some(effect) => format!("{} would show {}", effect.effect, effect.would_show),
        None => "nor in any measurement within the bounds".into(),
    };
    Some(format!("not testable with these data: {} ({shows})", names.join(", ")))
}

/// Outliers of the best model `c`, and where it fails.
fn misfits(d: &Discovery, c: &Comparison) -> Vec<String> {
    // Beside a model that fails what stands out of it is no finding of its own.
    let outliers = if d.verdict == Verdict::Unexplained { 1 } else { SHOWN };
    let mut lines = outlier_lines(c, &d.outliers, outliers);
    if d.verdict == Verdict::Unexplained && !c.regions.is_empty() {
        lines.push("where the best model still fails:".into());
        lines.extend(c.regions.iter().take(SHOWN).map(|region| format!("  {}", region.sentence)));
    }
    lines
}

/// The estimates that are tied together, on one line.
fn tied(d: &Discovery) -> Option<String> {
    let pair = |tie: &Correlation| format!("{} and {} ({:.3})", tie.parameters.0, tie.parameters.1, tie.value);
    let mut pairs: Vec<String> = d.correlations.iter().take(SHOWN).map(pair).collect();
    if d.correlations.len() > SHOWN {
        pairs.push(format!("{} more pairs (see --json)", d.correlations.len() - SHOWN));
    }
    (!pairs.is_empty()).then(|| format!("  tied together (correlation): {}", pairs.join("; ")))
}

/// How the frequencies of a table are written.
fn digits(table: &Table) -> Frequencies {
    Frequencies::of(table.points.iter().map(|p| p.frequency))
}

/// The command or the change that comes next.
fn step(d: &Discovery, output: Option<&Path>) -> Option<String> {
    let end = d.explanation();
    if d.verdict == Verdict::Unexplained || end.hypothesis.additions.is_empty() {
        return None;
    }
    if let Some(output) = output {
        return Some(format!("next: stickslip compare {}", output.display()));
    }
    let file = end.comparison.scenario.path.display();
    Some(match end.hypothesis.additions[..] {
        [Addition::Recalibration(key)] => format!("next: name \"{key}\" in [fit] free of {file}"),
        [Addition::Effect(effect)] => format!("next: stickslip add {} {file} --dry-run", effect.name()),
        _ => format!("next: stickslip discover {file} -o FILE writes the scenario with all of these, fitted"),
    })
}

fn ranked(c: &Candidate, points: usize) -> String {
    let held_out = c.held_out.map_or("-".into(), |h| format!("{:.2} %", h.rms_percent));
    let testable = if c.testable { "" } else { "  (not testable)" };
    format!(
        "  {:<32} {:>9.1} {:>7.3} {:>9.2} {held_out:>9}  {}{testable}",
        c.hypothesis.label(),
        c.delta_bic,
        c.weight,
        c.chi2_per_point,
        c.hypothesis.basis().words(points)
    )
}
