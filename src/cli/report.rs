//! `stickslip report`: everything, and one page about it.

use super::baseline::{self, Baseline};
use super::caching::{self, CacheOptions, Illustrated};
use super::exports::Extras;
use super::figure_output::FigureOutput;
use super::folder::Folder;
use super::gates::{self, GateLimits, Verdicts};
use super::ledger::{Claims, Ledger, of_paper};
use super::record::{self, Past};
use super::rerender;
use super::sections::{self, Clock, Section};
use super::{Global, compare, say, select, simulate};
use crate::cache::{Cache, Key};
use crate::error::{Error, Result};
use crate::gate::{self, Judged};
use crate::report::{self, CheckView, EffectView, FigureView, Provenance, ReportView, TrustView};
use crate::scenario::{self, Scenario};
use crate::trial::{self, Series};
use crate::units::readable as format;
use crate::{figures, verification};
use clap::Args;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Title of a page about the paper's kind of rig.
const TITLE: &str = "Rubber in frictional contact: model and experiment";
/// Shortest wall time \[s\] that a history keeps.
const NOTED: f64 = 0.05;
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
    /// Compare with an earlier run, its folder or its report.json: what improved, what got worse, which pictures
    /// changed
    #[arg(long, visible_alias = "against", value_name = "DIR|FILE", conflicts_with = "from")]
    baseline: Option<PathBuf>,
    /// Show the page in the browser ($BROWSER, or that of the desktop)
    #[arg(long)]
    pub open: bool,
    /// Gate: nothing may be worse than in the baseline
    #[arg(long, requires = "baseline")]
    no_regression: bool,
    /// Folder with a record of every run, extended by this one; draws errors, peaks and times by run
    #[arg(long, value_name = "DIR", conflicts_with = "from")]
    history: Option<PathBuf>,
    /// Files for pipelines.
    #[command(flatten)]
    pub extras: Extras,
    #[command(flatten)]
    limits: GateLimits,
    #[command(flatten)]
    verdict: Verdicts,
    #[command(flatten)]
    cache: CacheOptions,
}

/// Simulates the scenarios, draws, judges claims and gates, and writes `report.html` and `report.json`.
pub fn execute(arguments: &Arguments, global: &Global) -> Result<()> {
    let Arguments {
        scenarios: paths,
        out,
        from,
        baseline,
        open,
        no_regression,
        history,
        extras,
        limits,
        verdict,
        cache,
    } = arguments;
    if let Some(from) = from {
        return rerender::execute(from, (out.as_deref(), *open), extras, global);
    }
    let out = out.as_deref().unwrap_or(Path::new("output"));
    let scenarios = selected_scenarios(paths, limits, verdict, global.quiet)?;
    let tables = scenarios.iter().map(compare::table).collect::<Result<Vec<_>>>()?;
    let ledger = Ledger::find(&scenarios)?;
    extras.free(out)?;
    let baseline = baseline.as_deref().map(Baseline::load).transpose()?;
    let past = history.as_deref().map(Past::load).transpose()?;
    let inputs = scenarios.iter().zip(&tables).flat_map(|(scenario, table)| select::inputs(scenario, table.as_ref()));
    let results = Folder::open(out, &FigureOutput::default(), inputs)?;
    let cache = cache.open()?;
    let mut clock = Clock::start();
    let work: Vec<_> = scenarios.iter().zip(&tables).collect();
    let parts = Parts::make(&work, ledger.as_ref(), (&cache, &results), &mut clock, global.quiet)?;
    let (kept, of) = (parts.kept, parts.number);

    let mut judged = parts.gates(&scenarios);
    let mut provenance = Provenance::from_environment(&command(paths, limits, verdict), rayon::current_num_threads());
    provenance.timings = clock.laps;
    let mut plain = parts.view(&title(&scenarios), &provenance);
    // The trials that come with the program are of the paper's rig as well.
    let tried = scenarios.iter().zip(&tables).any(|(scenario, table)| scenario.rig.is_arm() && table.is_some());
    if tried && let [main, others @ ..] = trial::committed() {
        plain = plain.with_trust(trust(main, others, (&cache, &results))?);
    }
    let against = match &baseline {
        Some(baseline) => Some(baseline.against(&plain.clone().with_gates(&judged), &results)?),
        None => None,
    };
    judged.extend(against.as_ref().filter(|_| *no_regression).map(baseline::no_regression));
    let view = plain.with_gates(&judged).with_baseline(against);
    let view = write(view, past, &provenance, kept, &results)?;
    let extras = extras.write(&view)?;
    let of_cache = cache.folder().map(|folder| (kept, of, folder));
    tell(global, &view, of_cache, &provenance.timings)?;
    say(global, &format!("wrote {} and {}", out.join("report.html").display(), out.join("report.json").display()))?;
    extras.iter().try_for_each(|path| say(global, &format!("wrote {}", path.display())))?;
    if *open {
        super::browser::open(&out.join("report.html"));
    }
    gates::passed(&judged)
}

/// Says what the report comes to, how many parts of how many a cache has kept, and how long each part took.
fn tell(
    global: &Global,
    view: &ReportView,
    cache: Option<(usize, usize, &Path)>,
    timings: &[(String, f64)],
) -> Result<()> {
    say(global, &view.summary.sentence)?;
    if let Some((kept, of, folder)) = cache {
        say(global, &format!("  {kept} of {of} parts as an earlier run left them in {}", folder.display()))?;
    }
    view.baseline.iter().flat_map(baseline::words).try_for_each(|line| say(global, &line))?;
    record::words(view).iter().try_for_each(|line| say(global, line))?;
    timings.iter().try_for_each(|(part, seconds)| say(global, &format!("  {part}: {seconds:.2} s")))
}

/// The scenarios with the gates of the command line, in the order of the figures, then of the names.
fn selected_scenarios(
    paths: &[PathBuf],
    limits: &GateLimits,
    verdict: &Verdicts,
    quiet: bool,
) -> Result<Vec<Scenario>> {
    let mut scenarios = select::scenarios(paths, quiet)?;
    gates::apply(limits, verdict, &mut scenarios)?;
    let place = |s: &Scenario| {
        figures::names().iter().position(|name| s.figures.iter().flatten().next().is_some_and(|f| f == name))
    };
    scenarios.sort_by_key(|s| place(s).unwrap_or(usize::MAX));
    if scenarios.is_empty() {
        return Err(Error::Input(
            "error: no scenario to report on\n  = help: name a scenario file, or write one with `stickslip init`"
                .into(),
        ));
    }
    Ok(scenarios)
}

/// What a report is made of.
struct Parts {
    sections: Vec<Section>,
    claims: Claims,
    atlas: Atlas,
    checks: Vec<CheckView>,
    /// Parts that an earlier run has kept, of so many.
    kept: usize,
    number: usize,
}

impl Parts {
    fn make(
        work: &sections::Work<'_>,
        ledger: Option<&Ledger>,
        (cache, results): (&Cache, &Folder),
        clock: &mut Clock,
        quiet: bool,
    ) -> Result<Self> {
        let (sections, mut kept) = sections::make(work, cache, results, clock, quiet)?;
        let claims = ledger.map(|ledger| caching::or_compute(cache, &ledger.key(), || ledger.views())).transpose()?;
        clock.lap("claims");
        let of_paper = of_paper(work.iter().map(|(scenario, _)| *scenario)).is_some();
        let atlas = of_paper.then(|| atlas(cache, results)).transpose()?;
        clock.lap("atlas");
        // The checks are of the paper's rig: where no scenario is, those of the points at hand are left.
        let of_paper_kind = work.iter().any(|(scenario, _)| scenario.rig.is_arm());
        let verified = match of_paper_kind {
            true => caching::or_compute(cache, &Key::of("verification", &scenario::paper()), || Ok(verified()))?,
            false => (Vec::new(), false),
        };
        clock.lap("verification");
        let of_checks = of_paper_kind.then_some(verified.1);
        let whole = [claims.as_ref().map(|(_, kept)| *kept), atlas.as_ref().map(|(_, kept)| *kept), of_checks];
        kept += whole.iter().flatten().filter(|kept| **kept).count();
        let number = sections.len() + whole.iter().flatten().count();
        let (claims, atlas) = (claims.unwrap_or_default().0, atlas.unwrap_or_default().0);
        Ok(Self { sections, claims, atlas, checks: verified.0, kept, number })
    }

    /// The gates of these scenarios, judged.
    fn gates(&self, scenarios: &[Scenario]) -> Vec<Judged> {
        let verdicts = &self.claims.verdicts;
        let of = |(scenario, section): (&Scenario, &Section)| {
            let of_claims = gate::of_claims(&scenario.gate, &scenario.id, verdicts);
            section.gates.iter().cloned().chain(of_claims).collect::<Vec<_>>()
        };
        scenarios.iter().zip(&self.sections).flat_map(of).collect()
    }

    /// The page without gates, trials, baseline and history.
    fn view(self, title: &str, provenance: &Provenance) -> ReportView {
        let (sections, points): (Vec<_>, Vec<_>) =
            self.sections.into_iter().map(|section| (section.view, section.points)).unzip();
        let mut checks = self.checks;
        checks.extend(verification::numerical_error(points.concat()).iter().map(check_view));
        ReportView::assemble(title, self.claims.views, sections, self.atlas.0, checks, provenance)
    }
}

/// Writes page and JSON, and extends the history, which the view then shows.
fn write(
    mut view: ReportView,
    past: Option<Past>,
    provenance: &Provenance,
    kept: usize,
    results: &Folder,
) -> Result<ReportView> {
    // Times of parts out of the cache say nothing.
    let seconds = if provenance.fixed || kept > 0 { Vec::new() } else { provenance.timings.clone() };
    let record = view.record(seconds.into_iter().filter(|(_, seconds)| *seconds >= NOTED).collect());
    let file = past.as_ref().map(|past| past.path().to_path_buf());
    if let Some(past) = past {
        view = past.with(view, record.clone(), results)?;
    }
    let page = rerender::page(&view)?;
    let json = report::json(&view).map_err(|why| Error::Unfinished(why.to_string()))?;
    results.write("report.json", json.as_bytes())?;
    results.write("report.html", page.as_bytes())?;
    for (name, page) in rerender::others(&view)? {
        results.write(name, page.as_bytes())?;
    }
    if let Some(file) = file {
        crate::history::append(&file, &record)?;
    }
    Ok(view)
}

/// Title of the page: of scenarios that are not all about the paper's kind of rig, their own.
fn title(scenarios: &[Scenario]) -> String {
    match scenarios {
        some if of_paper(some).is_some() || some.iter().all(|scenario| scenario.rig.is_arm()) => TITLE.into(),
        [one] => one.title.clone(),
        [first, others @ ..] => format!("{} and {} more", first.title, others.len()),
        [] => TITLE.into(),
    }
}

/// How the search fared in the trials that come with the program, with their figures.
fn trust(main: &Series, others: &[Series], (cache, out): (&Cache, &Folder)) -> Result<TrustView> {
    let key = Key::of("trust", &(main, others));
    let draw = || Ok(report::trust_view(main, others, &simulate::committed_trials(main, others, out)?));
    Ok(caching::or_draw(cache, &key, out, draw)?.0)
}

impl Illustrated for TrustView {
    fn figures(&mut self) -> Vec<&mut FigureView> {
        self.figures.iter_mut().collect()
    }
}

/// The atlas of effects, and whether an earlier run has kept it.
fn atlas(cache: &Cache, out: &Folder) -> Result<(Atlas, bool)> {
    let rig = scenario::paper();
    caching::or_draw(cache, &Key::of("atlas", &rig), out, || Ok(Atlas(simulate::atlas(&rig, out)?)))
}

/// The sections of the atlas.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Atlas(Vec<EffectView>);

impl Illustrated for Atlas {
    fn figures(&mut self) -> Vec<&mut FigureView> {
        self.0.iter_mut().map(|effect| &mut effect.figure).collect()
    }
}

fn verified() -> Vec<CheckView> {
    verification::run().iter().map(check_view).collect()
}

/// The command that gives the same results again; what they are held against, baseline and history, is named beside it.
fn command(paths: &[PathBuf], limits: &GateLimits, verdict: &Verdicts) -> String {
    let mut words = vec!["stickslip report".to_string()];
    words.extend(paths.iter().map(|path| path.display().to_string()));
    words.extend(limits.max_rms_error.map(|limit| format!("--max-rms-error {limit}")));
    words.extend(limits.max_chi2.map(|limit| format!("--max-chi2 {limit}")));
    words.extend(verdict.verdict.as_ref().map(|verdict| format!("--verdict {verdict}")));
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
