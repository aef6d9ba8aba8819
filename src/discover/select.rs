//! Forward selection with a beam, exchange and backward elimination, from the calibrated base to the explanation.

use super::Discovery;
use super::data::Data;
use super::hypothesis::{Addition, Hypothesis, additions, compatible, extended};
use super::known::{Entry, Known};
use super::look::motion::Pair;
use super::look::{Count, Look, Parent, look};
use super::options::{MARGIN, MISTAKE, SearchOptions};
use super::race::{Competitor, Race, Round};
use super::runner::{Bar, COSTLY, Runner};
use crate::compare::{self, Calibration};
use crate::fit::{Problem, TAIL, cost, resonance, robust_chi2, robust_square, typical_of};
use crate::measurement::{Noise, Point, Table};
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use nalgebra::DVector;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// Of single linkage: above 2 and the better the larger, by its authors' 4, that almost surely few basins are searched
/// twice.
const SIGMA: f64 = 4.0;
/// Evaluations of one continuation of a fit to all points.
pub(super) const CONTINUED: usize = 15;
/// A fit that ended for want of evaluations goes on while that gains more than this in the criterion, and may bring it
/// level with the best.
const GAIN: f64 = 0.1;

/// Finds what is missing in the model of a scenario, given its measurements.
pub fn discover(scenario: &Scenario, table: &Table, options: &SearchOptions) -> Discovery {
    discover_counted(scenario, table, options, &Arc::default())
}

/// The same, counting the steady states that it solves where another thread may look.
pub fn discover_counted(
    scenario: &Scenario,
    table: &Table,
    options: &SearchOptions,
    solved: &Arc<AtomicU64>,
) -> Discovery {
    let scenario = table.applied_to(scenario);
    let understated = compare::understated(table);
    let table = &table.estimated(understated);
    let (search, start) = Search::begin(&scenario, table, options, solved);
    let mut known = Known::default();
    let chosen = search.forward(&start, &mut known);
    let Some(noise) = search.scatter(&chosen) else {
        return search.run(&start, chosen, known, understated);
    };
    // It goes on with the standard deviations that the readings scatter by.
    let table = table.rescaled(noise);
    let search = search.over(&table);
    let [start, chosen] = [start, chosen]
        .map(|h| search.data.fitted(search.data.reweighted(h, noise), search.data.last_effort(CONTINUED)));
    let again = search.goes_on();
    let mut known = known.map(|entry| search.reweighted(entry, noise, again));
    // What was decided for in the other deviations may not be in these.
    let chosen = search.forward(&search.eliminate_to(0, chosen), &mut known);
    search.run(&start, chosen, known, noise.times(understated))
}

/// What explains the measurements of a scenario as far as the forward selection goes, and what the criterion charges it
/// for having looked at many additions.
pub fn explain(scenario: &Scenario, table: &Table, options: &SearchOptions) -> (Hypothesis, f64) {
    let scenario = table.applied_to(scenario);
    let table = &table.estimated(compare::understated(table));
    let (search, start) = Search::begin(&scenario, table, options, &Arc::default());
    let found = search.forward(&start, &mut Known::default());
    let charge = search.looked_at(&found);
    (found, charge)
}

/// A search and what it has found so far.
pub(super) struct Search<'a> {
    pub scenario: &'a Scenario,
    pub table: &'a Table,
    pub options: &'a SearchOptions,
    pub data: Data<'a>,
    /// Everything that may be added.
    pub pool: Vec<Addition>,
}

/// Who goes on in a race.
#[derive(Clone, Copy)]
enum Field<'h> {
    /// The best of all, from starting points of this part of the sequence.
    Best(usize),
    /// Every candidate by itself, unless it cannot come below this hypothesis, squares in this unit.
    Each(Option<(&'h Hypothesis, f64)>),
}

/// Leaves `most` of ranked starting points: half are the best of those that have no better one near, as multi-level
/// single linkage takes them (Rinnooy Kan and Timmer 1987), spread over the basins of attraction that the estimate
/// sees; the others the best of those that have one, second samples of these basins: where a candidate changes nothing,
/// every point is alone.
fn entrants(ranked: &mut Vec<Runner<'_, '_>>, most: usize) {
    let Some(first) = ranked.first() else { return };
    let (count, d) = (ranked.len() as f64, first.own() as f64);
    let volume = statrs::function::gamma::gamma(1.0 + 0.5 * d) * SIGMA * count.ln() / count;
    let radius = volume.powf(1.0 / d) / std::f64::consts::PI.sqrt();
    let better_near = |at: &usize| ranked[..*at].iter().any(|better| ranked[*at].distance(better) < radius);
    let (near, mut alone): (Vec<usize>, Vec<usize>) = (0..ranked.len()).partition(better_near);
    // Of either sort half, where there are as many.
    alone.truncate(most.div_ceil(2).max(most.saturating_sub(near.len())));
    let rest = most.saturating_sub(alone.len());
    let chosen: Vec<usize> = alone.into_iter().chain(near.into_iter().take(rest)).collect();
    let mut at = 0..;
    ranked.retain(|_| at.next().is_some_and(|at: usize| chosen.contains(&at)));
}

/// Whether an addition makes a continuum of sliders of what has none.
fn costly(from: &Hypothesis, addition: Addition) -> bool {
    extended(&from.model, &[addition]).has_sliders() && !from.model.has_sliders()
}

impl<'a> Search<'a> {
    /// A search for what is missing in `base`, whose parameters `free` move.
    pub fn new(
        scenario: &'a Scenario,
        table: &'a Table,
        (options, solved): (&'a SearchOptions, &Arc<AtomicU64>),
        free: &[String],
        base: Model,
    ) -> Self {
        let data = Data::new(base, free, &table.points, (options.budget, solved));
        let pool = additions(&data.base, free, table.points.iter().any(|p| p.phase.is_some()), &options.candidates);
        Self { scenario, table, options, data, pool }
    }

    /// A search, and the calibrated base that it begins with.
    fn begin(
        scenario: &'a Scenario,
        table: &'a Table,
        options: &'a SearchOptions,
        solved: &Arc<AtomicU64>,
    ) -> (Self, Hypothesis) {
        let model = Model::new(scenario);
        let Calibration { base, fit, .. } =
            compare::calibrate(&model, &scenario.free, &table.points, Tolerance::default(), options.seed);
        let search = Self::new(scenario, table, (options, solved), &scenario.free, base.clone());
        (search, Hypothesis { additions: Vec::new(), model: base, fit, estimate: None, bic: f64::INFINITY })
    }

    /// The same with other standard deviations.
    fn over<'t>(&'t self, table: &'t Table) -> Search<'t> {
        let data = self.data.over(&table.points);
        Search { scenario: self.scenario, table, options: self.options, data, pool: self.pool.clone() }
    }

    /// What was found, in standard deviations that are so many times as large; fitted `again` where the fit is to all
    /// points.
    fn reweighted(&self, entry: Entry, noise: Noise, again: bool) -> Entry {
        let Entry { hypothesis, visibility, strongest } = entry;
        let mut hypothesis = self.data.reweighted(hypothesis, noise);
        if again && hypothesis.is_full(self.data.points.len()) {
            hypothesis = self.data.fitted(hypothesis, self.data.effort(CONTINUED, 1));
        }
        let phases = self.readings() - self.data.points.len();
        let factor = noise.together(self.data.points.len(), phases);
        Entry { hypothesis, visibility: visibility / factor.powi(2), strongest }
    }

    /// From the end of the forward selection to what is told.
    fn run(&self, start: &Hypothesis, chosen: Hypothesis, mut known: Known, noise: Noise) -> Discovery {
        let (mut chosen, mut ties) = self.exchange(chosen, &mut known);
        let explanation = loop {
            let comparison = self.comparison(&chosen, !self.structured(&chosen));
            let moved = comparison.fit.values != chosen.fit.values;
            chosen.fit.clone_from(&comparison.fit);
            // Where the profiles moved the fit, an addition may have become needless.
            let fewer = if moved { self.eliminate(chosen.clone()) } else { chosen.clone() };
            if fewer.additions.len() == chosen.additions.len() {
                break comparison;
            }
            (chosen, ties) = self.exchange(fewer, &mut known);
        };
        self.conclude(start, &chosen, explanation, &known, &ties, noise)
    }

    /// Whether there is anything left to spend on the search; the rest is for intervals.
    pub(super) fn goes_on(&self) -> bool {
        self.data.left() > 0
    }

    /// Adds to a hypothesis as long as that pays, and removes what that makes needless: all candidates race beside the
    /// leading hypotheses.
    fn forward(&self, start: &Hypothesis, known: &mut Known) -> Hypothesis {
        let (mut chosen, mut beam) = (start.clone(), vec![start.clone()]);
        for _ in 0..self.options.max_effects {
            beam.retain(|h| h.additions.len() < self.options.max_effects);
            if beam.is_empty() || !self.goes_on() {
                break;
            }
            let mut full = self.race(&beam.iter().collect::<Vec<_>>(), &self.pool, Field::Best(0), known);
            // What leaves structure is held against everything else that a user might add by hand, fitted as it would
            // be then.
            let mut least = self.least(&full).map_or(&chosen, |(_, least)| least).clone();
            if self.structured(&least) && self.goes_on() {
                // A race may end beside the minimum, where a resonance folds say; a calibration has other starting
                // points.
                least = self.calibrated(&least);
                full.push(least.clone());
            }
            if self.structured(&least) && self.goes_on() {
                // Beside the base what came to the end of the race, too: from one starting point of many.
                let at_first = chosen.additions.is_empty();
                let others = if at_first { self.pool.clone() } else { self.not_fitted_beside(&chosen, known) };
                let bar = Some((&least, self.unit(&least)));
                full.extend(self.race(&[&chosen], &others, Field::Each(bar), known));
                least = self.least(&full).map_or(least, |(_, least)| least.clone());
                let room = chosen.additions.len() + 2 <= self.options.max_effects;
                if room && self.structured(&least) && self.goes_on() {
                    full.extend(self.pairs(&chosen, known));
                }
            }
            // What explains less where readings are far off is no step towards an explanation.
            let scale = TAIL * typical_of(&chosen.fit.evaluation.residuals);
            let misfit = |h: &Hypothesis| robust_chi2(&h.fit.evaluation.residuals, scale);
            full.retain(|h| !self.structured(h) || misfit(h) <= misfit(&chosen));
            let Some(best) = self.pick(&full, chosen.additions.is_empty()) else { break };
            let unit = self.unit(&best).min(self.unit(&chosen));
            if self.score(unit, &chosen) - self.score(unit, &best) <= MARGIN {
                break;
            }
            chosen = self.simplified(self.eliminate(best), known);
            if !self.structured(&chosen) && !chosen.fitted().has_sliders() {
                beam = vec![chosen.clone()];
                continue;
            }
            if !self.structured(&chosen) {
                break;
            }
            full.push(chosen.clone());
            let unit = self.least(&full).map_or(1.0, |(unit, _)| unit);
            full.sort_by(|a, b| self.bic(unit, a).total_cmp(&self.bic(unit, b)));
            beam.clear();
            for hypothesis in full {
                if beam.len() < self.options.beam && !beam.iter().any(|h| h.same_additions(&hypothesis)) {
                    beam.push(hypothesis);
                }
            }
        }
        chosen
    }

    /// A hypothesis where a calibration from starting points about its fit takes it, if that is better.
    fn calibrated(&self, hypothesis: &Hypothesis) -> Hypothesis {
        let keys: Vec<String> = hypothesis.fit.parameters.iter().map(|p| p.key.clone()).collect();
        let model = hypothesis.fitted();
        // One evaluation tells what all will cost; elsewhere more of a dense series may have to be solved.
        let mut problem = compare::problem(&model, &keys, &self.table.points, Tolerance::FIT);
        problem.evaluate(&problem.values(), true);
        self.data.count(problem.solved);
        let one = problem.solved.max(self.table.points.len() as u64 * cost(&model));
        if one * compare::MOST as u64 > self.data.left() {
            return hypothesis.clone();
        }
        let how = (self.options.seed, self.data.share(1));
        let found = compare::calibrate_about(&model, &keys, &self.table.points, Tolerance::default(), how);
        self.data.count(found.solved);
        let moved = Hypothesis { model: found.base, fit: found.fit, ..hypothesis.clone() };
        if moved.fits_better_than(hypothesis) { moved } else { hypothesis.clone() }
    }

    /// Candidates of which no fit to all points is known beside a hypothesis.
    fn not_fitted_beside(&self, from: &Hypothesis, known: &Known) -> Vec<Addition> {
        let fitted = known.beside(&from.additions);
        let is_fitted = |a: &Addition| fitted.iter().any(|h| h.additions.last() == Some(a));
        self.pool.iter().copied().filter(|a| !is_fitted(a)).collect()
    }

    /// The race of all candidates beside all parents; the hypotheses that came to its end, fitted to all points.
    fn race(
        &self,
        parents: &[&Hypothesis],
        pool: &[Addition],
        entered: Field<'_>,
        known: &mut Known,
    ) -> Vec<Hypothesis> {
        let o = self.options;
        let (field, entries) = self.line_up(parents, pool, entered, known);
        let rules = match entered {
            Field::Best(_) => (o.kept, o.survivors),
            Field::Each(_) => (1.0, field.len()),
        };
        if matches!(entered, Field::Best(_)) {
            known.parents.extend(parents.iter().map(|from| from.additions.clone()));
        }
        self.run_race((field, entries), rules, known)
    }

    /// Two laws of the motion together, started from what is estimated at the motion that was measured: what each of
    /// them does to a resonance may hide the other.
    fn pairs(&self, from: &Hypothesis, known: &mut Known) -> Vec<Hypothesis> {
        let o = self.options;
        let points = o.first_points.min(self.data.points.len());
        let parent = Parent::new(&self.data, from, from.fit.values.clone(), points);
        let rest = parent.rest();
        let mut found = parent.pairs(&self.data, from, &self.pool, (o.entrants, (o.starts, o.seed)));
        let one_more =
            |addition: Addition| -> Vec<Addition> { from.additions.iter().copied().chain([addition]).collect() };
        // First what explains more without the other.
        let alone = |addition: Addition| {
            let all = known.with(&one_more(addition));
            all.iter().map(|h| self.bic(1.0, h)).fold(f64::INFINITY, f64::min)
        };
        found.iter_mut().filter(|pair| alone(pair.additions[1]) < alone(pair.additions[0])).for_each(Pair::turn);
        let first = |pair: &Pair| {
            let mut model = pair.model.clone();
            model.effects.pop();
            let mut fit = from.fit.clone();
            fit.parameters = self.data.beside(&model, from, pair.additions[0]);
            Hypothesis { additions: one_more(pair.additions[0]), model, fit, ..from.clone() }
        };
        let firsts: Vec<Hypothesis> = found.iter().map(first).collect();
        let sure = self.sure();
        let mut field: Vec<Runner<'_, '_>> = Vec::new();
        for (of, (pair, first)) in found.iter().zip(&firsts).enumerate() {
            let start = parent.start_of(&self.data, first, pair);
            field.push(Runner::new(&self.data, (first, of, sure), pair.additions[1], (start, &rest)));
        }
        let entry =
            |r: &Runner<'_, '_>| Entry { hypothesis: r.hypothesis(false), visibility: 0.0, strongest: Vec::new() };
        let entries = field.iter().map(entry).collect();
        self.run_race((field, entries), (o.kept, o.survivors), known)
    }

    /// Runs a race; the hypotheses that came to its end, fitted to all points.
    fn run_race(
        &self,
        (field, mut entries): (Vec<Runner<'_, 'a>>, Vec<Entry>),
        (kept, survivors): (f64, usize),
        known: &mut Known,
    ) -> Vec<Hypothesis> {
        let o = self.options;
        let all = self.data.points.len();
        let first = Round { points: o.first_points.min(all), evaluations: o.first_evaluations, states: 0 };
        let ended = Race { first, points: all, kept, survivors }.run(field, |among| self.data.share(among));
        for runner in ended.dropped.iter().chain(&ended.survivors) {
            entries[runner.of].keep(runner.hypothesis(false));
        }
        let full = |r: &Runner<'_, '_>| r.fit.as_ref().is_some_and(|fit| fit.evaluation.predictions.len() == all);
        let mut fitted: Vec<(usize, Hypothesis)> =
            ended.survivors.iter().map(|runner| (runner.of, runner.hypothesis(full(runner)))).collect();
        let effort = self.data.effort(CONTINUED, fitted.len());
        fitted.retain(|(_, h)| h.is_full(all) || self.data.affords(&h.model, effort));
        fitted.par_iter_mut().filter(|(_, h)| !h.is_full(all)).for_each(|(_, h)| {
            *h = self.data.fitted(h.clone(), effort);
        });
        if let Some(best) = Hypothesis::best_fit(fitted.iter().map(|(_, h)| h.clone())) {
            self.settle_all(fitted.iter_mut().map(|(_, h)| h).collect(), &best);
        }
        for (of, hypothesis) in &fitted {
            entries[*of].keep(hypothesis.clone());
        }
        known.keep(entries);
        fitted.into_iter().map(|(_, hypothesis)| hypothesis).collect()
    }

    /// All candidates beside all parents, each looked at; and the starting points of each that are worth a fit.
    fn line_up<'s>(
        &'s self,
        parents: &[&'s Hypothesis],
        pool: &[Addition],
        entered: Field<'s>,
        known: &Known,
    ) -> (Vec<Runner<'s, 'a>>, Vec<Entry>) {
        let o = self.options;
        let (turn, kept) = match entered {
            Field::Best(turn) => (turn, o.kept),
            Field::Each(_) => (0, 1.0),
        };
        let of = |number: usize| pool.iter().map(move |addition| (number, *addition));
        let work: Vec<(usize, Addition)> = (0..parents.len())
            .flat_map(of)
            .filter(|(number, addition)| self.goes_with(parents[*number], *addition))
            .collect();
        // A look is the round before the first, and takes half of its points.
        let points = (o.first_points / 2).min(self.data.points.len());
        // A continuum of sliders costs as much as all others together: it is looked at on fewer points.
        let few = work.iter().any(|(number, addition)| costly(parents[*number], *addition)).then_some(points / COSTLY);
        let places_on = |points: usize| -> Vec<Vec<Parent<'_>>> {
            parents.par_iter().map(|from| self.places(from, points)).collect()
        };
        let places = [places_on(points), few.map_or_else(Vec::new, places_on)];
        let fitted: Vec<(Addition, Model)> = known.entries.iter().filter_map(Entry::single).collect();
        let looks: Vec<Look> = work
            .par_iter()
            .map(|(number, addition)| {
                let from = parents[*number];
                let known = fitted.iter().find(|(a, _)| a == addition).map(|(_, model)| model);
                let known = known.filter(|_| !from.additions.is_empty());
                // Beside what leaves nothing but noise the promise alone decides: no more than would go on are looked
                // at.
                let starts = if self.structured(from) { o.starts } else { (o.starts as f64 * kept).ceil() as usize };
                let places = &places[usize::from(costly(from, *addition))][*number];
                let asked = places[0].with_law(&self.data, from, *addition, (o.starts, o.seed));
                let count = Count { known, asked: asked.as_ref(), starts, shared: parents.len(), turn, seed: o.seed };
                look(&self.data, places, from, *addition, count)
            })
            .collect();
        let mut field: Vec<Runner<'s, 'a>> = Vec::new();
        let mut entries: Vec<Entry> = Vec::new();
        let sure = self.sure();
        for (of, ((number, addition), look)) in work.iter().zip(looks).enumerate() {
            let from = parents[*number];
            let Look { starts, visibility, strongest } = look;
            let rest = places[usize::from(costly(from, *addition))][*number][0].rest();
            let new = |start| Runner::new(&self.data, (from, of, sure), *addition, (start, &rest));
            let runners = self.best_starts(starts.into_iter().map(new).collect(), kept);
            entries.extend(runners.first().map(|r| Entry { hypothesis: r.hypothesis(false), visibility, strongest }));
            field.extend(runners);
        }
        self.keep_promising(&mut field);
        self.set_bar(&mut field, parents, entered, || places[0][0][0].rest());
        (field, entries)
    }

    /// Once something is found a continuum of sliders competes only if that leaves structure, and it promises most.
    fn keep_promising(&self, field: &mut Vec<Runner<'_, 'a>>) {
        let typical = field.iter().map(Competitor::typical).fold(f64::INFINITY, f64::min);
        let most = field.iter().map(|r| r.badness(typical)).fold(f64::INFINITY, f64::min);
        field.retain(|r| {
            let wanted = r.from.additions.is_empty() || (r.badness(typical) <= most && self.structured(r.from));
            wanted || !costly(r.from, r.addition)
        });
    }

    /// By how much likelihood ratios of so many candidates differ by chance in all cases but one of a thousand.
    fn sure(&self) -> f64 {
        MARGIN.max(2.0 * (self.pool.len() as f64 / MISTAKE).ln())
    }

    /// Tells those lined up above what they are of no use. Beside a parent that leaves nothing but noise, of which
    /// `rest` is left of the readings of the look, only what would be decided for is worth a fit, unless it is asked
    /// for.
    fn set_bar<'s>(
        &self,
        field: &mut Vec<Runner<'s, 'a>>,
        parents: &[&Hypothesis],
        entered: Field<'s>,
        rest: impl Fn() -> DVector<f64>,
    ) {
        let mut bar = match entered {
            Field::Each(Some((best, unit))) => Bar::At(best, unit),
            _ => Bar::None,
        };
        if let [only] = parents
            && matches!(entered, Field::Best(_))
            && !self.structured(only)
        {
            let rest = rest();
            let scale = self.data.readings() as f64 / rest.len().max(1) as f64;
            let aim = scale * robust_square(&rest, 1.0) + self.data.price(only.fit.parameters.len());
            field.retain(|runner| runner.badness(1.0) + MARGIN < aim);
            bar = Bar::Parent;
        }
        field.iter_mut().for_each(|runner| runner.bar = bar);
    }

    /// The starting points of a candidate that are worth a fit, of which it keeps a share, the best first. They compete
    /// with one another first: a linear estimate tells them apart, but little of what candidates are worth.
    fn best_starts<'s>(&'s self, mut runners: Vec<Runner<'s, 'a>>, kept: f64) -> Vec<Runner<'s, 'a>> {
        let Some(first) = runners.first() else { return runners };
        let (from, addition) = (first.from, first.addition);
        let typical = runners.iter().map(Competitor::typical).fold(f64::INFINITY, f64::min);
        runners.sort_by(|a, b| a.badness(typical).total_cmp(&b.badness(typical)));
        // Of a continuum of sliders fewer by what it costs, but one.
        let model = extended(&from.model, &[addition]);
        let share = if model.has_sliders() { cost(&model) } else { 1 };
        let most = (self.options.entrants as u64 / share).max(1) as usize;
        let most = ((runners.len() as f64 * kept).ceil() as usize).min(most);
        if addition.is_effect() {
            entrants(&mut runners, most)
        } else {
            runners.truncate(most)
        }
        runners
    }

    /// The best fit of one addition to a hypothesis.
    pub(super) fn add(&self, from: &Hypothesis, addition: Addition, known: &mut Known) -> Option<Hypothesis> {
        Hypothesis::best_fit(self.race(&[from], &[addition], Field::Each(None), known))
    }

    /// A hypothesis where its fit is, and with the base where the scenario states it: once something is missing, a
    /// calibration may have carried it far off, and nothing is left there for an addition to act on.
    fn places(&self, from: &Hypothesis, points: usize) -> Vec<Parent<'a>> {
        let fitted = from.fit.values.clone();
        let mut stated = fitted.clone();
        stated[..self.data.stated.len()].copy_from_slice(&self.data.stated);
        let mut places = vec![Parent::new(&self.data, from, fitted.clone(), points)];
        if !from.additions.is_empty() {
            return places;
        }
        if stated != fitted {
            places.push(Parent::new(&self.data, from, stated, points));
        }
        // ... or where the readings show a resonance beside what is read with it, out of which a flank of it may have
        // led the fit.
        let keys: Vec<String> = from.fit.parameters.iter().map(|p| p.key.clone()).collect();
        if let Some(seen) = resonance::started(&from.model, &keys, self.data.points) {
            let none: [&Point; 0] = [];
            let values = Problem::new(seen, none, from.fit.parameters.clone(), Tolerance::COARSE).values();
            let place = Parent::new(&self.data, from, values, points);
            let has_left = resonance::left_readings(&from.fitted(), self.data.points).is_some();
            places.push(if has_left { place } else { place.for_what_is_read_beside() });
        }
        places
    }

    /// What the strongest plausible form of each of these would change beside a hypothesis ([`Look::visibility`]).
    pub(super) fn visible(&self, from: &Hypothesis, additions: &[Addition]) -> Vec<f64> {
        let places = self.places(from, (self.options.first_points / 2).min(self.data.points.len()));
        let count = Count {
            known: None,
            asked: None,
            starts: self.options.starts,
            shared: 1,
            turn: 0,
            seed: self.options.seed,
        };
        let of = |addition: &Addition| {
            let goes = self.goes_with(from, *addition) && !extended(&from.model, &[*addition]).has_sliders();
            if goes { look(&self.data, &places[..1], from, *addition, count).visibility } else { 0.0 }
        };
        additions.par_iter().map(of).collect()
    }

    fn goes_with(&self, from: &Hypothesis, addition: Addition) -> bool {
        let all: Vec<Addition> = from.additions.iter().copied().chain([addition]).collect();
        !from.additions.contains(&addition) && compatible(&self.data.base, &all)
    }

    /// Follows fits that ended for want of evaluations, in a curved valley say, to their minimum, while they may come
    /// level with the best.
    pub(super) fn settle_all(&self, mut all: Vec<&mut Hypothesis>, best: &Hypothesis) {
        let unit = self.unit(best);
        let best = self.bic(unit, best);
        all.retain(|h| h.fit.is_exhausted());
        // In step, so that the budget is asked of the same count for any number of threads.
        loop {
            let effort = self.data.effort(CONTINUED, all.len());
            all.retain(|h| self.data.affords(&h.model, effort));
            if all.is_empty() {
                break;
            }
            let continued = all.into_par_iter().filter_map(|h| {
                let before = self.bic(unit, h);
                *h = self.data.fitted(h.clone(), effort);
                let gain = before - self.bic(unit, h);
                let goes_on = gain >= GAIN && before - 2.0 * gain <= best + MARGIN && h.fit.is_exhausted();
                goes_on.then_some(h)
            });
            all = continued.collect();
        }
    }

    /// Whether a hypothesis leaves more than noise.
    pub(super) fn structured(&self, hypothesis: &Hypothesis) -> bool {
        self.whiteness(hypothesis).is_none_or(|white| white.structured)
    }

    /// The best of hypotheses. Of those that the data do not tell apart the simpler: at first a recalibration; once
    /// something is known to be missing, an effect.
    fn pick(&self, all: &[Hypothesis], first: bool) -> Option<Hypothesis> {
        let unit = self.least(all)?.0;
        let bic = |h: &Hypothesis| self.bic(unit, h);
        let best = all.iter().map(bic).fold(f64::INFINITY, f64::min);
        let preferred = |h: &Hypothesis| h.additions.last().is_some_and(|a| a.is_effect() != first);
        let close: Vec<&Hypothesis> = all.iter().filter(|h| bic(h) - best < MARGIN).collect();
        // A formula that does what an effect of the catalogue does comes before it: its user asked for it.
        let own = |h: &Hypothesis| {
            h.additions.last().is_some_and(|a| self.data.base.candidates.iter().any(|e| e.name() == a.name()))
        };
        let order = |h: &Hypothesis| bic(h) - if own(h) { GAIN } else { 0.0 };
        let least = |a: &&&Hypothesis, b: &&&Hypothesis| order(a).total_cmp(&order(b));
        let simple = close.iter().filter(|h| preferred(h)).min_by(least);
        simple.or(close.iter().min_by(least)).map(|h| (**h).clone())
    }

    /// Replaces every addition in turn by another that explains better beside the others, itself at another place
    /// included; with what does as well in the place of each, itself first. What is no explanation has none that does
    /// as well.
    fn exchange(&self, chosen: Hypothesis, known: &mut Known) -> (Hypothesis, Vec<Vec<Hypothesis>>) {
        let mut chosen = chosen;
        let mut ties: Vec<Vec<Hypothesis>> = Vec::new();
        // One for all exchanges beside structure, so that they come to an end.
        let mut unit = self.unit(&chosen);
        while ties.len() < chosen.additions.len() {
            let index = ties.len();
            let structured = self.structured(&chosen);
            if !structured {
                unit = 1.0;
            }
            if structured && !self.goes_on() {
                break;
            }
            let addition = chosen.additions[index];
            let mut additions = chosen.additions.clone();
            additions.remove(index);
            let rest = || self.refit(&chosen, additions.clone());
            if structured {
                // Raced again only at a better place than all that it was raced at.
                let rest = rest();
                if known.with(&additions).iter().all(|seen| rest.fits_better_than(seen)) {
                    self.race(&[&rest], &self.pool, Field::Best(1), known);
                }
            } else if !known.raced(&additions) {
                self.race(&[&rest()], &self.pool, Field::Best(1), known);
            }
            let mut rivals = known.beside(&additions);
            let bic = |h: &Hypothesis| self.bic(unit, h);
            let own = bic(&chosen);
            let best = rivals.iter().min_by(|a, b| bic(a).total_cmp(&bic(b)));
            if let Some(best) = best.filter(|best| bic(best) + MARGIN < own) {
                chosen = self.eliminate(best.clone());
                ties.clear();
                continue;
            }
            rivals.retain(|h| h.additions.last() != Some(&addition) && bic(h) - own < MARGIN);
            rivals.sort_by(|a, b| bic(a).total_cmp(&bic(b)));
            let mut itself = chosen.clone();
            itself.additions.remove(index);
            itself.additions.push(addition);
            rivals.insert(0, itself);
            ties.push(rivals);
        }
        if self.structured(&chosen) {
            ties.clear();
        }
        (chosen, ties)
    }
}
