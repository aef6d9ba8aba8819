//! The sections of a report, one per scenario: from the cache where nothing has changed, computed where something has.

use super::caching::{self, Illustrated};
use super::folder::Folder;
use super::{compare, question, simulate};
use crate::cache::{Cache, Key};
use crate::compare::Comparison;
use crate::discover::{self, Discovery};
use crate::error::Result;
use crate::free_form::FreeForm;
use crate::gate::{self, Judged};
use crate::measurement::Table;
use crate::report::{self, FigureInput, FigureView, ScenarioView};
use crate::scenario::Scenario;
use crate::sweep::Outcome;
use crate::verification::{self, Compared};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Everything that a report says of one scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// The section of the page.
    pub view: ScenarioView,
    /// Gates of its comparison and discovery.
    pub gates: Vec<Judged>,
    /// Points solved both ways.
    pub points: Vec<Compared>,
}

impl Illustrated for Section {
    fn figures(&mut self) -> Vec<&mut FigureView> {
        self.view.figures_mut().collect()
    }
}

/// Scenarios with their tables of measurements.
pub type Work<'a> = [(&'a Scenario, &'a Option<Table>)];

/// The section of every scenario, in order, and how many of them were kept by an earlier run; files go below `out`.
///
/// # Errors
/// What cannot be drawn or written, or that the user has asked to stop.
pub fn make(
    work: &Work<'_>,
    cache: &Cache,
    out: &Folder,
    clock: &mut Clock,
    quiet: bool,
) -> Result<(Vec<Section>, usize)> {
    let keys: Vec<Key> = work.iter().map(|both| Key::of("section", both)).collect();
    let kept = keys.par_iter().map(|key| caching::get(cache, key, out)).collect::<Result<Vec<Option<Section>>>>()?;
    clock.lap("cache");
    let missing: Vec<usize> = (0..work.len()).filter(|&index| kept[index].is_none()).collect();
    let fresh: Vec<_> = missing.iter().map(|&index| work[index]).collect();
    let mut computed = compute(&fresh, out, clock, quiet)?.into_iter();
    missing.par_iter().zip(computed.as_slice()).for_each(|(&index, section)| {
        let curves = simulate::curves_name(&section.view.id);
        caching::put(cache, &keys[index], section, &[curves], out);
    });
    let found = work.len() - missing.len();
    // As many were computed as are missing.
    let sections = kept.into_iter().filter_map(|kept| kept.or_else(|| computed.next())).collect();
    clock.lap("cache");
    Ok((sections, found))
}

fn compute(work: &Work<'_>, out: &Folder, clock: &mut Clock, quiet: bool) -> Result<Vec<Section>> {
    let swept = work.iter().map(|(scenario, table)| compare::swept(scenario, table.as_ref()));
    let outcomes = swept.map(|scenario| simulate::outcome(&scenario, quiet)).collect::<Vec<_>>();
    clock.lap("sweeps");
    // Towards its end each of these keeps few threads busy.
    let (figures, compared) = rayon::join(|| simulate::figures(&outcomes, out), || compared(work, out));
    let (figures, compared) = (figures?, compared?);
    clock.lap("figures and comparisons");
    let answers = || work.par_iter().map(|(s, _)| question::answer(s, out)).collect::<Result<Vec<_>>>();
    let (discovered, answered) = rayon::join(|| discovered(work, out), answers);
    let (discovered, answered) = (discovered?, answered?);
    clock.lap("discoveries and questions");
    let points: Vec<_> = outcomes.par_iter().map(verification::solved_twice).collect();
    clock.lap("verification");
    let section = |(index, points): (usize, Vec<Compared>)| {
        let (compared, discovered) = (compared[index].as_ref(), discovered[index].as_ref());
        let gate = &work[index].0.gate;
        let mut gates: Vec<Judged> = compared.iter().flat_map(|(c, _)| gate::of_comparison(gate, c)).collect();
        gates.extend(discovered.iter().flat_map(|(d, ..)| gate::of_discovery(gate, d)));
        let mut view = view(&outcomes[index], &figures[index], compared, discovered);
        if let Some((answer, figures)) = &answered[index] {
            view = view.with_question(answer, figures);
        }
        Section { view, gates, points }
    };
    Ok(points.into_iter().enumerate().map(section).collect())
}

/// A comparison and a discovery, each with its figures.
type Compare = (Comparison, Vec<FigureInput>);
type Discover = (Discovery, Vec<FigureInput>, Option<(FreeForm, Vec<FigureInput>)>);

/// Compares every scenario that has measurements, and draws that.
fn compared(work: &Work<'_>, out: &Folder) -> Result<Vec<Option<Compare>>> {
    let one = |(scenario, table): &(&Scenario, &Option<Table>)| {
        let Some(table) = table else { return Ok(None) };
        let comparison = compare::compare(scenario, table);
        let figures = simulate::comparison(&comparison, out)?;
        Ok(Some((comparison, figures)))
    };
    work.par_iter().map(one).collect()
}

/// Looks for what is missing in every scenario that has measurements, and draws that.
fn discovered(work: &Work<'_>, out: &Folder) -> Result<Vec<Option<Discover>>> {
    let one = |(scenario, table): &(&Scenario, &Option<Table>)| {
        let Some(table) = table else { return Ok(None) };
        let discovery = discover::discover(scenario, table, &discover::SearchOptions::default());
        let figures = simulate::discovery(&discovery, out)?;
        let free_form = discover::beside(&discovery, false);
        let drawn = |found: FreeForm| simulate::free_form(&found, &scenario.id, out).map(|figures| (found, figures));
        Ok(Some((discovery, figures, free_form.map(drawn).transpose()?)))
    };
    work.par_iter().map(one).collect()
}

fn view(
    outcome: &Outcome,
    figures: &[FigureInput],
    compared: Option<&Compare>,
    discovered: Option<&Discover>,
) -> ScenarioView {
    let mut view = report::scenario_view(outcome, figures);
    if let Some((comparison, figures)) = compared {
        view = view.with_comparison(comparison, figures);
    }
    let Some((discovery, figures, free_form)) = discovered else { return view };
    let view = view.with_discovery(discovery, figures);
    match free_form {
        Some((found, figures)) => view.with_free_form(found, figures),
        None => view,
    }
}

/// Wall times of the parts.
pub struct Clock {
    last: Instant,
    /// Name and seconds of each part, in the order in which they began.
    pub laps: Vec<(String, f64)>,
}

impl Clock {
    /// A clock that runs.
    pub fn start() -> Self {
        Self { last: Instant::now(), laps: Vec::new() }
    }

    /// Adds the time since the last call to a part.
    pub fn lap(&mut self, part: &str) {
        let seconds = self.last.elapsed().as_secs_f64();
        match self.laps.iter_mut().find(|(name, _)| name == part) {
            Some((_, sum)) => *sum += seconds,
            None => self.laps.push((part.into(), seconds)),
        }
        self.last = Instant::now();
    }
}
