//! `stickslip trial`: causes planted, hidden, searched for, and the searches scored.

use super::figure_output::FigureOutput;
use super::folder::Folder;
use super::{Global, Json, say, simulate};
use crate::discover::{Candidates, SearchOptions};
use crate::effects::Effect;
use crate::error::{Error, Result};
use crate::trial::{self, Bench, Options, Record, Summary};
use crate::{scenario, terminal, units};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of the command.
#[derive(Debug, Clone, Args)]
// Wide: an option of the command line is a field.
pub struct Arguments {
    /// What to plant: names of effects, pairs joined by +, none, keys like rig.inertia, causes outside the catalogue,
    /// or all, effects, recalibrations, pairs, outside; NAME:N draws N of these at most
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "all")]
    effects: Vec<String>,
    /// Number of draws per cause
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: u32,
    /// Levels of noise: of amplitudes relative to them, of phases the same number in rad
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "1 %")]
    noise: Vec<String>,
    /// Share of the readings that are thrown far off
    #[arg(long, value_name = "SHARE", default_value = "0")]
    outliers: String,
    /// Measure no phases
    #[arg(long)]
    no_phase: bool,
    /// Scenario whose rig is measured at the rows of its table or at its sweep [default: the paper's rig, 13
    /// conditions, 24 frequencies]
    #[arg(long, value_name = "SCENARIO")]
    conditions: Option<PathBuf>,
    /// Folder of tables, answers, results and figures; finished trials in it are not run again
    #[arg(long, value_name = "DIR", default_value = "trials")]
    out: PathBuf,
    /// Write the scores as JSON; - for standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Leave the trials out of the JSON: the scores alone
    #[arg(long, requires = "json")]
    scores_alone: bool,
    /// Hold the trials against those of an earlier run, as --json wrote it: exit status 1 where another thing is named
    #[arg(long, value_name = "FILE")]
    agree: Option<PathBuf>,
    /// First seed
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Most effects in one explanation
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(0..=6))]
    max_effects: u8,
    /// Search otherwise than by default: NAME=VALUE, as docs/search.md lists them
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
    search: Vec<String>,
    /// Effects to ask for: names, or all [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    candidates: Vec<String>,
}

/// The options of a search with settings NAME=VALUE, and the effects that it asks for, a scenario's `own` among them.
///
/// # Errors
/// [`Error::Input`] naming the first setting that is none, or the first effect.
pub(super) fn searched(
    (settings, candidates): (&[String], &[String]),
    own: &[&'static dyn Effect],
    max_effects: u8,
    seed: u32,
) -> Result<SearchOptions> {
    let candidates = Candidates::of(candidates, own).map_err(|why| {
        Error::Input(format!(
            "error: --candidates: {why}\n  = help: names of effects or `all`; `stickslip effects` lists them"
        ))
    })?;
    let mut options = SearchOptions { max_effects: max_effects.into(), seed, candidates, ..SearchOptions::default() };
    for setting in settings {
        options.set(setting).map_err(|why| {
            let list: Vec<String> =
                SearchOptions::NAMES.iter().map(|(name, meaning)| format!("{name}: {meaning}")).collect();
            Error::Input(format!("error: --search: {why}\n  = help: {}", list.join("; ")))
        })?;
    }
    Ok(options)
}

/// Runs the trials, prints the scores, writes the figures.
pub fn execute(arguments: &Arguments, global: &Global) -> Result<()> {
    let a = arguments;
    let (causes, fewer) = trial::numbered_causes(&a.effects)?;
    let mut options = Options {
        causes,
        fewer,
        seed: a.seed,
        seeds: a.seeds,
        noise: a.noise.iter().map(|text| share("--noise", text, 1e-6)).collect::<Result<_>>()?,
        outliers: share("--outliers", &a.outliers, 0.0)?,
        phase: !a.no_phase,
        search: searched((&a.search, &a.candidates), &[], a.max_effects, 0)?,
        out: a.out.clone(),
        inputs: a.conditions.iter().cloned().collect(),
    };
    let bench = match &a.conditions {
        Some(path) => {
            let scenario = scenario::load(path)?;
            options.inputs.extend(scenario.measurement.iter().map(|measurement| measurement.file.clone()));
            Bench::of(&scenario)?
        }
        None => trial::practice(),
    };
    let before = a.agree.as_deref().map(trial::load).transpose()?;
    let json = a.json.clone().map(Json::from);
    if let Some(json) = &json {
        json.free(trial::SCHEMA, Some(&options.out))?;
        same(a)?;
    }
    let draws: u32 = options.causes.iter().map(|cause| options.draws_of(cause)).sum();
    let bar = bar(global, options.noise.len() * draws as usize);
    let done = |record: &Record, fresh: bool| {
        bar.set_message(terminal::clean(&record.id).into_owned());
        bar.inc(1);
        if !fresh {
            // Kept results take no time: they would spoil the estimate of what remains.
            bar.reset_eta();
        }
    };
    let records = trial::run(&bench, &options, &done)?;
    bar.finish_and_clear();
    let summary = trial::summarise(records, &options, bench.operations.len());
    if let Some(json) = &json {
        if a.scores_alone {
            json.write(&summary.clone().scores_alone(), trial::SCHEMA)?;
        } else {
            json.write(&summary, trial::SCHEMA)?;
        }
    }
    let drawn = simulate::trial(&summary, &Folder::open(&options.out, &FigureOutput::default(), [])?)?;
    if !json.as_ref().is_some_and(Json::to_standard_output) {
        for line in words(&summary) {
            say(global, &line)?;
        }
        for name in drawn.iter().flat_map(|figure| &figure.files) {
            say(global, &format!("  {}", options.out.join(name).display()))?;
        }
    }
    before.map_or(Ok(()), |before| agree(&summary, &before, global))
}

/// Complains where the result would replace that of the earlier run.
fn same(a: &Arguments) -> Result<()> {
    let of = |path: &Option<PathBuf>| path.as_ref().and_then(|path| path.canonicalize().ok());
    match of(&a.json) {
        Some(path) if Some(&path) == of(&a.agree).as_ref() => {
            Err(Error::Input("error: --json and --agree name the same file\n  = help: give --json another file".into()))
        }
        _ => Ok(()),
    }
}

/// Whether the trials name what those of an earlier run named.
fn agree(summary: &Summary, before: &Summary, global: &Global) -> Result<()> {
    let both = trial::agreement(summary, before);
    let differ: Vec<String> =
        both.iter().filter(|b| !b.agree()).map(|b| format!("  {}: {}, before {}", b.id, b.now, b.before)).collect();
    if both.is_empty() {
        return Err(Error::Gate(
            "error: none of the trials is among those of the earlier run\n  = help: the same causes, seeds, noise and conditions".into(),
        ));
    }
    if differ.is_empty() {
        say(global, &format!("{} trials name what they named before", both.len()))?;
        return Ok(());
    }
    let title = format!("error: {} of {} trials name another thing than before", differ.len(), both.len());
    Err(Error::Gate(format!("{title}\n{}", differ.join("\n"))))
}

/// A share given as `1 %` or `0.01`.
fn share(option: &str, text: &str, least: f64) -> Result<f64> {
    let value = text.trim().parse().ok().or_else(|| units::parse(text.trim(), "1").ok());
    // 7 % is 0.07 also in the names of folders.
    let value = value.and_then(|v: f64| format!("{v:.6e}").parse().ok());
    value.filter(|v: &f64| (least..0.5).contains(v)).ok_or_else(|| {
        Error::Input(format!(
            "error: `{text}` is no value of {option}\n  = help: a share below 50 %, such as \"1 %\" or 0.01"
        ))
    })
}

fn bar(global: &Global, trials: usize) -> ProgressBar {
    if global.quiet || !terminal::shows_progress() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(trials as u64);
    let template = "{bar:30} {pos}/{len} trials, {elapsed} gone, {eta} left; last: {msg}";
    bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_secs(1));
    bar
}

/// The scores in lines of text.
fn words(s: &Summary) -> Vec<String> {
    let total = &s.scores[0];
    let mut lines = vec![format!("{} trials of {} points; shares with Wilson's 95 % interval", total.trials, s.points)];
    if s.builds.len() > 1 {
        lines.push(format!("note: the results come from {} builds of the program", s.builds.len()));
    }
    let heads = s.scores.iter().map(|x| x.noise.map_or("all".into(), |n| format!("noise {} %", 100.0 * n)));
    lines.push(format!("{:<34}{}", "", heads.map(|head: String| format!("{head:>20}")).collect::<String>()));
    type Column = fn(&trial::Scores) -> String;
    let rows: [(&str, Column); 12] = [
        ("draws that the data could show", |x| x.visible.to_string()),
        ("right verdict", |x| x.verdict.to_string()),
        ("right effect first", |x| x.first.to_string()),
        ("truth named or tied", |x| x.named.to_string()),
        ("exactly the truth named", |x| x.exact.to_string()),
        ("false alarms where nothing is", |x| x.false_alarm.to_string()),
        ("outside the catalogue, flagged", |x| x.flagged.to_string()),
        ("right recalibration", |x| x.recalibration.to_string()),
        ("95 % intervals that hold", |x| x.coverage.to_string()),
        ("final error over noise, median", |x| x.final_error.map_or("-".into(), |e| format!("{:.3}", e[0]))),
        ("final error over noise, largest", |x| x.final_error.map_or("-".into(), |e| format!("{:.3}", e[1]))),
        ("time of a search, median", |x| x.seconds.map_or("-".into(), |t| format!("{t:.1} s"))),
    ];
    for (name, of) in rows {
        let cells: String = s.scores.iter().map(|x| format!("{:>20}", of(x))).collect();
        lines.push(format!("{name:<34}{cells}"));
    }
    lines
        .push(format!("{:<42}{:>8}{:>8}{:>8}{:>8}{:>10}", "cause", "trials", "verdict", "first", "named", "not drawn"));
    for c in &s.causes {
        let x = &c.scores;
        let cell = |p: &trial::Proportion| if p.of == 0 { "-".into() } else { p.successes.to_string() };
        let named = if x.recalibration.of > 0 { &x.recalibration } else { &x.named };
        lines.push(format!(
            "{:<42}{:>8}{:>8}{:>8}{:>8}{:>10}",
            c.cause,
            x.trials,
            cell(&x.verdict),
            cell(&x.first),
            cell(named),
            format!("{}+{}", c.invisible, c.unsteady)
        ));
    }
    lines.push("not drawn: draws that the data could not show + draws without a steady state somewhere".into());
    for record in s.trials.iter().filter(|r| r.found.is_none()) {
        lines.push(format!("{}: no draw of {} was visible and steady", record.id, trial::DRAWS));
    }
    lines
}
