//! `stickslip report`: everything, and one page about it.

use super::{Global, compare, question, say, select, simulate};
use crate::claims::{self, Judged, Relation};
use crate::compare::Comparison;
use crate::discover::{self, Discovery};
use crate::error::{Error, Result};
use crate::measurement::Table;
use crate::report::{
    self, CheckView, ClaimView, FigureInput, Provenance, ReportView, ScenarioView, Verdict, anchor, format,
};
use crate::scenario::{self, Scenario};
use crate::sweep::Outcome;
use crate::{figures, files, verification};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Title of the page.
const TITLE: &str = "Rubber in frictional contact: model and experiment";
/// Ledger and rig of the claims, below a scenarios folder.
const LEDGER: &str = "paper/claims.toml";
const RIG: &str = "paper/rig.toml";

/// Simulates the scenarios, draws, judges the claims, and writes `report.html` and `report.json` below `out`.
pub fn execute(paths: &[PathBuf], out: &Path, global: &Global) -> Result<()> {
    let mut scenarios = select::scenarios(paths)?;
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
    let claims = judge(&scenarios)?;
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
    let claims = claims.iter().map(claim_view).collect();
    let checks = checks.iter().map(check_view).collect();
    let view = ReportView::assemble(TITLE, claims, sections, atlas, checks, &provenance);
    let page = report::render(&view).map_err(|why| Error::Unfinished(why.to_string()))?;
    let json = report::json(&view).map_err(|why| Error::Unfinished(why.to_string()))?;
    files::replace(&out.join("report.json"), json.as_bytes())?;
    files::replace(&out.join("report.html"), page.as_bytes())?;
    say(global, &view.summary.sentence);
    for (part, seconds) in &provenance.timings {
        say(global, &format!("  {part}: {seconds:.2} s"));
    }
    say(global, &format!("wrote {} and {}", out.join("report.html").display(), out.join("report.json").display()));
    Ok(())
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

/// A scenario of the paper, where there is one: claims and atlas are for these.
fn of_paper(scenarios: &[Scenario]) -> Option<&Scenario> {
    scenarios.iter().find(|scenario| scenario.id.starts_with("paper/"))
}

/// The claims, where scenarios of the paper are among those reported.
fn judge(scenarios: &[Scenario]) -> Result<Vec<Judged>> {
    let Some(one) = of_paper(scenarios) else { return Ok(Vec::new()) };
    // The folder of the scenarios has its own ledger and rig, unless they are the ones in the binary.
    let beside =
        |name: &str| one.path.parent().and_then(Path::parent).map(|root| root.join(name)).filter(|p| p.is_file());
    match (beside(LEDGER), beside(RIG)) {
        (Some(ledger), Some(rig)) => {
            let text = std::fs::read_to_string(&ledger).map_err(Error::io("read", &ledger))?;
            claims::judge(&text, &ledger.display().to_string(), &scenario::load_base(&rig)?)
        }
        _ => claims::judge(scenario::embedded_file(LEDGER).unwrap_or_default(), LEDGER, &scenario::paper()),
    }
}

fn claim_view(claim: &Judged) -> ClaimView {
    let show = |value: f64| number(value, claim.unit);
    let (expected, tolerance) = match claim.expected {
        Relation::AtLeast(bound) => (format!("at least {}", show(bound)), String::new()),
        Relation::AtMost(bound) => (format!("at most {}", show(bound)), String::new()),
        Relation::Equal(value, tolerance) => (show(value), format!("± {}", show(tolerance))),
    };
    let mut note = claim.caveat.clone();
    if let Some((needed, printed)) = claim.remedy {
        note += &format!(
            "It would hold for an actuator amplitude u₀ of {} or more; printed is {}.",
            format::quantity(needed, "m", 3),
            format::quantity(printed, "m", 3)
        );
    }
    ClaimView {
        id: claim.id.clone(),
        section: claim.section.clone(),
        statement: claim.statement.clone(),
        quantity: claim.quantity.clone(),
        expected,
        computed: show(claim.computed),
        tolerance,
        reason: claim.reason.clone(),
        verdict: match claim.verdict {
            claims::Verdict::Reproduced => Verdict::Reproduced,
            claims::Verdict::Caveat => Verdict::Caveat,
            claims::Verdict::NotReproducible => Verdict::NotReproducible,
            claims::Verdict::Failed => Verdict::Failed,
        },
        note,
        figure: claim.figure.as_ref().and_then(|f| f.split_once('#')).map(|(id, name)| anchor::figure(id, name)),
        ..ClaimView::default()
    }
}

/// Counts as they are, shares in percent, quantities with their unit.
fn number(value: f64, unit: &str) -> String {
    match unit {
        "1" if value.fract() == 0.0 && value.abs() < 1e6 => format!("{value}"),
        "1" if value.abs() >= 1e-4 => format::percent(value, 3),
        "1" => format!("{value:.1e}"),
        _ => format::quantity(value, unit, 3),
    }
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
