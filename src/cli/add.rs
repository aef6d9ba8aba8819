//! `stickslip add`: one effect fitted and written into a scenario, or taken out of it.

use super::changed_scenario::{Edit, Rewriting};
use super::compare::{interval_words, parameter, with_measurements};
use super::plot;
use super::{Global, say};
use crate::compare::{Compared, Comparison, Metrics, words as condition};
use crate::discover::{Change, fit_addition, fit_removal, has_size};
use crate::effects::{self, Effect, REGISTRY};
use crate::error::{Error, Result};
use crate::fit::operation;
use crate::model::Model;
use crate::scenario::Scenario;
use crate::scenario::diagnostic::{nearest, quote, whole_file};
use crate::scenario::parameters::base_keys;
use crate::terminal;
use imara_diff::{Algorithm, BasicLineDiffPrinter, Diff, InternedInput, UnifiedDiffConfig};
use std::path::Path;

/// Conditions and regions shown on the terminal.
const SHOWN: usize = 5;

/// What is asked of `stickslip add`.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    /// Name of the effect.
    pub effect: &'a str,
    /// The scenario.
    pub path: &'a Path,
    /// Another file to write to.
    pub output: Option<&'a Path>,
    /// Whether to show the difference and write nothing.
    pub dry_run: bool,
    /// Whether the effect is to be taken out.
    pub remove: bool,
    /// Seed of the search.
    pub seed: u32,
    /// Whether plots in characters are wanted.
    pub plot: plot::Plot,
}

/// Fits the effect to the scenario's measurements and writes the changed scenario; everything that can be wrong with
/// the input is found before the fit.
pub fn execute(job: &Job<'_>, global: &Global) -> Result<()> {
    let (scenario, table) = with_measurements(job.path)?;
    let refused = |why: String| {
        Error::Input(whole_file(&why, "the free form of `stickslip discover` tells what changes from series to series"))
    };
    let effect = effects::for_series(known(job.effect, &scenario)?, table.series.len()).map_err(refused)?;
    check_applicable(job, &scenario)?;
    let places: Vec<_> = table.points.iter().map(|point| (operation(point), point.amplitude)).collect();
    if !job.remove && !has_size(&Model::new(&scenario).scaled_at(&places), effect) {
        let title = format!("the measurements leave {} nothing to act on", quote(effect.name()));
        return Err(Error::Input(whole_file(&title, "it takes readings with a load on the contact")));
    }
    let file = Rewriting::begin(job.path, job.output, &table.file)?;
    let mut edit = Edit::new(&scenario, &file);
    if job.remove {
        edit.remove = Some(effect);
    } else {
        edit.add.push(effect);
    }
    edit.trial()?;
    if !global.quiet {
        let points = table.points.len();
        terminal::tell(&format!(
            "fitting to {points} points: seconds, or minutes where the model has no steady state at many of them"
        ));
    }
    let change = if job.remove {
        fit_removal(&scenario, &table, effect.name(), job.seed)
    } else {
        fit_addition(&scenario, &table, effect, job.seed)
    };
    let text = edit.fitted(&change.after)?;
    for line in words(job, &change) {
        say(global, &line)?;
    }
    if job.plot.wanted() {
        let models = [('.', "model before", &change.before), ('*', "model after", &change.after)];
        plot::curves(&models).iter().try_for_each(|line| say(global, line))?;
        let steps = [("before", &change.before), ("after", &change.after)];
        let steps = steps.map(|(name, c)| (name.to_string(), c.overall.chi2_per_point));
        plot::fall(&steps).iter().try_for_each(|line| say(global, line))?;
    }
    if job.dry_run {
        return terminal::print(&difference(file.before(), &text, job.path, file.to()));
    }
    file.write(&text)?;
    say(global, &format!("wrote {}", file.to().display()))?;
    say(global, &format!("next: stickslip discover {}", file.to().display()))?;
    Ok(())
}

/// The effect of that name: one of the catalogue, or a formula of the scenario.
fn known(name: &str, scenario: &Scenario) -> Result<&'static dyn Effect> {
    let own = scenario.effects.iter().find(|setting| setting.name() == name).map(|setting| setting.effect);
    own.or_else(|| effects::find_among(REGISTRY, name)).ok_or_else(|| {
        let formulas = scenario.effects.iter().map(|setting| setting.effect).filter(|e| e.formula().is_some());
        let names = || REGISTRY.iter().copied().chain(formulas.clone()).map(|effect| effect.name());
        let help = match nearest(name, names()) {
            _ if base_keys().iter().any(|key| key == name) || name.starts_with("contact.") => {
                format!("it is a number of the model: to fit it, name it in [fit] free = [\"{name}\"]")
            }
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("`stickslip effects` lists the catalogue: {}", names().collect::<Vec<_>>().join(", ")),
        };
        Error::Input(whole_file(&format!("unknown effect {}", quote(name)), &help))
    })
}

/// Whether the effect can be put in or taken out here.
fn check_applicable(job: &Job<'_>, scenario: &Scenario) -> Result<()> {
    let refuse = |title: String, help: &str| Err(Error::Input(whole_file(&title, help)));
    let (name, path) = (job.effect, job.path.display());
    let setting = scenario.effects.iter().find(|setting| setting.name() == name);
    let present = setting.is_some_and(|setting| job.remove || !setting.is_candidate(&scenario.free));
    if present && !job.remove {
        let help = "--remove takes it out; `stickslip compare` fits its parameters where [fit] free names them";
        return refuse(format!("{path} has the effect `{name}` already"), help);
    }
    if !present && job.remove {
        let names: Vec<_> = scenario.effects.iter().map(|setting| setting.name()).collect();
        let help = if names.is_empty() { "it has no effects".into() } else { format!("it has {}", names.join(", ")) };
        return refuse(format!("{path} has no effect `{name}` to take out"), &help);
    }
    let added = effects::find_among(REGISTRY, name).filter(|_| !job.remove);
    let all = scenario.effects.iter().map(|setting| setting.effect).chain(added);
    let all: Vec<&dyn Effect> = all.map(|effect| effect as &dyn Effect).collect();
    match effects::compatible(&all) {
        Ok(()) => Ok(()),
        Err(why) => refuse(why, "take the other one out first, with --remove"),
    }
}

/// The error before and after in lines of text.
fn words(job: &Job<'_>, change: &Change) -> Vec<String> {
    let (before, after) = (&change.before, &change.after);
    let (b, a) = (&before.overall, &after.overall);
    let sign = if job.remove { "without" } else { "with" };
    let mut lines = vec![format!("{}: {sign} {}", before.scenario.title, job.effect)];
    lines.push("error:                    before      after      noise".into());
    lines.push(format!("  chi2 per reading   {:>11.2} {:>10.2}", b.chi2_per_point, a.chi2_per_point));
    let percent = (b.rms_error_percent, a.rms_error_percent, a.noise_percent);
    lines.push(format!("  amplitude, rms     {:>9.2} %{:>9.2} %{:>9.2} %", percent.0, percent.1, percent.2));
    if let (Some(b), Some(a), Some(n)) = (b.rms_phase_deg, a.rms_phase_deg, a.noise_phase_deg) {
        lines.push(format!("  phase, rms         {b:>9.2} °{a:>9.2} °{n:>9.2} °"));
    }
    lines.push("conditions, the worst before first (chi2 per reading; amplitude, rms):".into());
    let mut order: Vec<usize> = (0..before.conditions.len()).collect();
    order.sort_by(|&i, &j| chi2(&before.conditions[j].metrics).total_cmp(&chi2(&before.conditions[i].metrics)));
    for &i in order.iter().take(SHOWN) {
        let (one, other) = (&before.conditions[i], &after.conditions[i]);
        lines.push(format!("  {}: {}", condition(&one.setting), became(&one.metrics, &other.metrics)));
    }
    if !before.regions.is_empty() {
        lines.push("where it failed before, and what became of it:".into());
    }
    for region in before.regions.iter().take(SHOWN) {
        let (from, to) = (region.frequency_from_hz, region.frequency_to_hz);
        let inside = |p: &&Compared| p.condition == region.condition && (from..=to).contains(&p.point.frequency);
        let over = |c: &Comparison| Metrics::over(c.points.iter().filter(inside).collect::<Vec<_>>().into_iter());
        lines.push(format!("  {}", region.sentence));
        lines.push(format!("    {}", became(&over(before), &over(after))));
    }
    lines.push(format!("fitted ({}):", interval_words(after)));
    lines.extend(after.fit.parameters.iter().zip(&after.intervals).map(|(p, i)| format!("  {}", parameter(p, i))));
    lines.push(judgement(job, change));
    lines
}

fn chi2(metrics: &Metrics) -> f64 {
    metrics.chi2_per_point * metrics.readings as f64
}

fn became(before: &Metrics, after: &Metrics) -> String {
    let percent = |m: &Metrics| match m.rms_error_percent {
        error if error.is_nan() => "no steady state".into(),
        error => format!("{error:.2} %"),
    };
    format!("{:.2} -> {:.2}; {} -> {}", before.chi2_per_point, after.chi2_per_point, percent(before), percent(after))
}

/// Whether the data are for the change.
fn judgement(job: &Job<'_>, change: &Change) -> String {
    let gain = change.gain;
    let (before, after) = (change.before.unsolved(), change.after.unsolved());
    if change.leaves_more() {
        return "the data do not decide: with this effect chi2 and error are larger, only most readings are nearer"
            .into();
    }
    if before != after && change.decided().is_none() {
        let (with, without) = if job.remove { (before, after) } else { (after, before) };
        return format!(
            "the data do not decide: with this effect the model has no steady state at {with} of {} points, without it at {without}",
            change.after.points.len()
        );
    }
    let unit = if change.unit > 1.0 { ", squares in units of what is left" } else { "" };
    match (change.decided(), job.remove) {
        (None, _) => format!("the data do not decide whether this effect is needed (BIC changes by {gain:+.1}{unit})"),
        (Some(true), false) => format!("the data are for this effect (BIC falls by {gain:.1}{unit})"),
        (Some(false), false) => format!("the data are against this effect (BIC rises by {:.1}{unit})", -gain),
        (Some(true), true) => format!("the data do not need this effect (BIC falls by {gain:.1} without it{unit})"),
        (Some(false), true) => format!("the data need this effect (BIC rises by {:.1} without it{unit})", -gain),
    }
}

/// Lines that differ, in the unified format.
fn difference(old: &str, new: &str, from: &Path, to: &Path) -> String {
    let input = InternedInput::new(old, new);
    let mut diff = Diff::compute(Algorithm::Histogram, &input);
    diff.postprocess_lines(&input);
    let printer = BasicLineDiffPrinter(&input.interner);
    let hunks = diff.unified_diff(&printer, UnifiedDiffConfig::default(), &input);
    format!("--- {}\n+++ {}\n{hunks}", from.display(), to.display())
}
