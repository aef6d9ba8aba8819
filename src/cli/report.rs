//! `stickslip report`: everything, and one page about it.

use super::again;
use super::extras::Extras;
use super::gates::{self, GateLimits, Verdicts};
use super::ledger::{self, Ledger, of_paper};
use super::{Global, compare, question, say, select, simulate};
use crate::compare::Comparison;
use crate::discover::{self, Discovery};
use crate::error::{Error, Result};
use crate::gate::{self, Judged};
use crate::measurement::Table;
use crate::report::{self, CheckView, FigureInput, Provenance, ReportView, ScenarioView, format};
use crate::scenario::{self, Scenario};
use crate::sweep::Outcome;
use crate::{figures, files, verification};
use clap::Args;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Title of the page.
const TITLE: &str = "Rubber in frictional contact: model and experiment";
/// Arguments of the command.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// Scenario files or folders [default: scenarios/, or the built-in ones]
    scenarios: Vec<PathBuf>,
    /// Folder of the results [default: output; with --from, that of the earlier run]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Make the page again from the report.json of an earlier run and the files beside it; nothing is simulated
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenarios", "max_rms_error", "max_chi2", "verdict"])]
    from: Option<PathBuf>,
    /// Files for pipelines.
    #[command(flatten)]
    pub extras: Extras,
    #[command(flatten)]
    limits: GateLimits,
    #[command(flatten)]
    verdict: Verdicts,
}

/// Simulates the scenarios, draws, judges claims and gates, and writes `report.html` and `report.json`.
pub fn execute(arguments: &Arguments, global: &Global) -> Result<()> {
    let Arguments { scenarios: paths, out, from, extras, limits, verdict } = arguments;
    if let Some(from) = from {
        return again::execute(from, arguments, global);
    }
    let out = out.as_deref().unwrap_or(Path::new("output"));
    let mut scenarios = select::scenarios(paths)?;
    gates::apply(limits, verdict, &mut scenarios)?;
    // In the order of the figures, then of the names.
    let place = |s: &Scenario| figures::names().iter().position(|name| s.figures.first().is_some_and(|f| f == name));
    scenarios.sort_by_key(|s| place(s).unwrap_or(usize::MAX));
    if scenarios.is_empty() {
        return Err(Error::Input(
            "error: no scenario to report on\n  = help: name a scenario file, or write one with `stickslip init`"
                .into(),
        ));
    }
    let tables = scenarios.iter().map(compare::table).collect::<Result<Vec<_>>>()?;
    let ledger = Ledger::find(&scenarios)?;
    let inputs = scenarios.iter().map(|s| s.path.as_path()).chain(tables.iter().flatten().map(|t| t.file.as_path()));
    extras.refuse(inputs)?;
    files::prepare(out)?;
    let mut clock = Clock::start();
    let outcomes = scenarios.iter().map(|s| simulate::outcome(s, global.quiet)).collect::<Result<Vec<_>>>()?;
    clock.lap("sweeps");
    let figures = simulate::figures(&outcomes, out)?;
    clock.lap("figures");
    let compared = compared(&scenarios, &tables, out)?;
    clock.lap("comparisons");
    let discovered = discovered(&scenarios, &tables, out)?;
    clock.lap("discoveries");
    let answered = scenarios.iter().map(|s| question::answer(s, out)).collect::<Result<Vec<_>>>()?;
    clock.lap("questions");
    let claims = ledger.map_or(Ok(Vec::new()), |ledger| ledger.judge())?;
    clock.lap("claims");
    let atlas = if of_paper(&scenarios).is_some() { simulate::atlas(&scenario::paper(), out)? } else { Vec::new() };
    clock.lap("atlas");
    let mut checks = verification::run();
    checks.extend(verification::numerical_error(&outcomes));
    clock.lap("verification");

    let sections = outcomes.iter().zip(&figures).zip(compared.iter().zip(&discovered));
    let sections = sections.map(|((o, f), (c, d))| section(o, f, c.as_ref(), d.as_ref()));
    let asked = sections.zip(&answered).map(|(view, answered)| match answered {
        Some((answer, figures)) => view.with_question(answer, figures),
        None => view,
    });
    let sections = asked.collect();
    let mut provenance = Provenance::from_environment(&command(paths), rayon::current_num_threads());
    provenance.timings = clock.laps;
    let judged: Vec<Judged> = scenarios
        .iter()
        .zip(compared.iter().zip(&discovered))
        .flat_map(|(s, (c, d))| {
            let of_comparison = c.iter().flat_map(|(c, _)| gate::of_comparison(&s.gate, c));
            let of_discovery = d.iter().flat_map(|(d, _)| gate::of_discovery(&s.gate, d));
            of_comparison.chain(of_discovery).chain(gate::of_claims(&s.gate, &s.id, &claims)).collect::<Vec<_>>()
        })
        .collect();
    let claims = claims.iter().map(ledger::view).collect();
    let checks = checks.iter().map(check_view).collect();
    let view = ReportView::assemble(TITLE, claims, sections, atlas, checks, &provenance).with_gates(&judged);
    let page = report::render(&view).map_err(|why| Error::Unfinished(why.to_string()))?;
    let json = report::json(&view).map_err(|why| Error::Unfinished(why.to_string()))?;
    files::replace(&out.join("report.json"), json.as_bytes())?;
    files::replace(&out.join("report.html"), page.as_bytes())?;
    let extras = extras.write(&view)?;
    say(global, &view.summary.sentence);
    for (part, seconds) in &provenance.timings {
        say(global, &format!("  {part}: {seconds:.2} s"));
    }
    say(global, &format!("wrote {} and {}", out.join("report.html").display(), out.join("report.json").display()));
    extras.iter().for_each(|path| say(global, &format!("wrote {}", path.display())));
    gates::passed(&judged)
}

/// A comparison and a discovery, each with its figures.
type Compared = (Comparison, Vec<FigureInput>);
type Discovered = (Discovery, Vec<FigureInput>);

/// Compares every scenario that has measurements, and draws that.
fn compared(scenarios: &[Scenario], tables: &[Option<Table>], out: &Path) -> Result<Vec<Option<Compared>>> {
    let one = |(scenario, table): (&Scenario, &Option<Table>)| {
        let Some(table) = table else { return Ok(None) };
        simulate::go_on()?;
        let comparison = compare::compare(scenario, table);
        let figures = simulate::comparison(&comparison, out)?;
        Ok(Some((comparison, figures)))
    };
    scenarios.iter().zip(tables).map(one).collect()
}

/// Looks for what is missing in every scenario that has measurements, and draws that.
fn discovered(scenarios: &[Scenario], tables: &[Option<Table>], out: &Path) -> Result<Vec<Option<Discovered>>> {
    let one = |(scenario, table): (&Scenario, &Option<Table>)| {
        let Some(table) = table else { return Ok(None) };
        simulate::go_on()?;
        let discovery = discover::discover(scenario, table, &discover::Options::default());
        let figures = simulate::discovery(&discovery, out)?;
        Ok(Some((discovery, figures)))
    };
    // One table keeps few threads busy towards its end.
    scenarios.par_iter().zip(tables).map(one).collect()
}

fn section(
    outcome: &Outcome,
    figures: &[FigureInput],
    compared: Option<&Compared>,
    discovered: Option<&Discovered>,
) -> ScenarioView {
    let mut view = report::scenario_view(outcome, figures);
    if let Some((comparison, figures)) = compared {
        view = view.with_comparison(comparison, figures);
    }
    match discovered {
        Some((discovery, figures)) => view.with_discovery(discovery, figures),
        None => view,
    }
}

/// Wall times of the parts.
struct Clock {
    last: Instant,
    laps: Vec<(String, f64)>,
}

impl Clock {
    fn start() -> Self {
        Self { last: Instant::now(), laps: Vec::new() }
    }
    fn lap(&mut self, part: &str) {
        self.laps.push((part.into(), self.last.elapsed().as_secs_f64()));
        self.last = Instant::now();
    }
}

/// The command that makes the report again.
fn command(paths: &[PathBuf]) -> String {
    let mut words = vec!["stickslip report".to_string()];
    words.extend(paths.iter().map(|path| path.display().to_string()));
    words.join(" ")
}

fn check_view(check: &verification::Check) -> CheckView {
    let show =
        |value: f64| if check.unit == "1" { format!("{value:.6}") } else { format::quantity(value, check.unit, 5) };
    CheckView {
        name: check.name.clone(),
        compares: check.compares.clone(),
        expected: check.expected.map_or(format::NONE.into(), show),
        computed: check.computed.map_or(format::NONE.into(), show),
        difference: format!("{:.1e}", check.difference),
        tolerance: format!("{:.0e}", check.tolerance),
        verdict: if check.holds() { report::Agreement::Agrees } else { report::Agreement::Disagrees },
        ..CheckView::default()
    }
}
