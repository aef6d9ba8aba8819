//! Forward selection with a beam, exchange and backward elimination, from the calibrated base to the explanation.

use super::Discovery;
use super::data::Data;
use super::field::Field;
use super::hypothesis::{Addition, Hypothesis, additions, compatible, extended};
use super::known::{Entry, Known};
use super::look::{Count, look};
use super::options::{MARGIN, SearchOptions};
use crate::compare::{self, Calibration};
use crate::fit::{TAIL, cost, robust_chi2, typical_of};
use crate::measurement::{Noise, Table, shows_anything};
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

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
    let (table, understated) = &compare::unless_understated(table);
    let (search, start) = Search::begin(&scenario, table, options, solved);
    let mut known = Known::default();
    let chosen = search.forward(&start, &mut known);
    let Some(noise) = search.scatter(&chosen) else {
        return search.run(&start, chosen, known, *understated);
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
    search.run(&start, chosen, known, noise.times(*understated))
}

/// What explains the measurements of a scenario as far as the forward selection goes, and what the criterion charges it
/// for having looked at many additions.
///
/// `solved` counts the steady states that were solved, those of its own calls before too: the budget is of each.
pub fn explain(
    scenario: &Scenario,
    table: &Table,
    options: &SearchOptions,
    solved: &Arc<AtomicU64>,
) -> (Hypothesis, f64) {
    let scenario = table.applied_to(scenario);
    let (table, _) = &compare::unless_understated(table);
    let (search, start) = Search::begin(&scenario, table, options, solved);
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

impl<'a> Search<'a> {
    /// A search for what is missing in `base`, whose parameters `free` move.
    pub fn new(
        scenario: &'a Scenario,
        table: &'a Table,
        (options, solved): (&'a SearchOptions, &Arc<AtomicU64>),
        free: &[String],
        base: Model,
    ) -> Self {
        let data = Data::new(base, free, (&table.points, table.freedom), (options.budget, solved));
        let pool = if shows_anything(&table.points) {
            additions(&data.base, free, table.points.iter().any(|p| p.phase.is_some()), &options.candidates)
        } else {
            Vec::new()
        };
        Self { scenario, table, options, data, pool }
    }

    /// A search, and the calibrated base that it begins with.
    pub(super) fn begin(
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

    /// What explains the readings, from a hypothesis on. What the races alone leave structure with, or three additions,
    /// is held against what comes of every step being held against everything else that a user might do by hand.
    fn forward(&self, start: &Hypothesis, known: &mut Known) -> Hypothesis {
        let mut chosen = self.steps(start, known, false);
        if (chosen.additions.len() > 2 || self.structured(&chosen)) && self.goes_on() {
            let by_hand = self.steps(start, known, true);
            let unit = self.unit(&by_hand).min(self.unit(&chosen));
            if self.score(unit, &by_hand) < self.score(unit, &chosen) {
                chosen = by_hand;
            }
        }
        self.ordered(chosen, known)
    }

    /// Adds to a hypothesis as long as that pays, and removes what that makes needless: all candidates race beside the
    /// leading hypotheses, and pairs of laws beside the base. `by_hand`: what leaves structure is fitted from other
    /// starting points, too, and held against every other candidate, fitted to its end, and against pairs beside that.
    fn steps(&self, start: &Hypothesis, known: &mut Known, by_hand: bool) -> Hypothesis {
        let (mut chosen, mut beam) = (start.clone(), vec![start.clone()]);
        for _ in 0..self.options.max_effects {
            beam.retain(|h| h.additions.len() < self.options.max_effects);
            if beam.is_empty() || !self.goes_on() {
                break;
            }
            let (again, new): (Vec<&Hypothesis>, Vec<&Hypothesis>) =
                beam.iter().partition(|h| known.raced(&h.additions));
            let mut full: Vec<Hypothesis> = again.iter().flat_map(|h| known.beside(&h.additions)).collect();
            if !new.is_empty() {
                full.extend(self.race(&new, &self.pool, Field::Best(0, None), known));
            }
            let testable = self.testable(&chosen);
            self.add_pairs(&chosen, &mut full, testable && (by_hand || chosen.additions.is_empty()), known);
            if by_hand {
                self.hold_against_all(&chosen, &mut full, known);
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
            // Of what more numbers leave nothing could be said.
            if !testable || !self.testable(&chosen) {
                break;
            }
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

    /// Adds to what was fitted beside a hypothesis pairs of laws, where they are `wanted` and the best leaves structure:
    /// before a race beside each of many, since what two laws do together may show in neither.
    fn add_pairs(&self, chosen: &Hypothesis, full: &mut Vec<Hypothesis>, wanted: bool, known: &mut Known) {
        let room = chosen.additions.len() + 2 <= self.options.max_effects;
        let structured = self.least(&*full).is_none_or(|(_, least)| self.structured(least));
        if !(wanted && room && structured) {
            return;
        }
        let before = known.pairs.iter().find(|(beside, _)| *beside == chosen.additions);
        if let Some((_, pairs)) = before {
            full.extend(pairs.iter().flat_map(|additions| known.with(additions)));
        } else if self.goes_on() {
            let pairs = self.pairs(chosen, known);
            known.pairs.push((chosen.additions.clone(), pairs.iter().map(|h| h.additions.clone()).collect()));
            full.extend(pairs);
        }
    }

    /// Adds to what was fitted beside a hypothesis what a user might do by hand, as long as the best of all leaves
    /// structure.
    fn hold_against_all(&self, chosen: &Hypothesis, full: &mut Vec<Hypothesis>, known: &mut Known) {
        let mut least = self.least(&*full).map_or(chosen, |(_, least)| least).clone();
        if self.structured(&least) && self.goes_on() {
            // A race may end beside the minimum, where a resonance folds say; a calibration has other starting points.
            least = self.calibrated(&least);
            full.push(least.clone());
        }
        if self.structured(&least) && self.goes_on() {
            // Beside the base what came to the end of the race, too: from one starting point of many.
            let at_first = chosen.additions.is_empty();
            let others = if at_first { self.pool.clone() } else { self.not_fitted_beside(chosen, known) };
            let bar = Some((&least, self.unit(&least)));
            full.extend(self.race(&[chosen], &others, Field::Each(bar), known));
        }
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

    /// The best fit of one addition to a hypothesis.
    pub(super) fn add(&self, from: &Hypothesis, addition: Addition, known: &mut Known) -> Option<Hypothesis> {
        Hypothesis::best_fit(self.race(&[from], &[addition], Field::Each(None), known))
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

    pub(super) fn goes_with(&self, from: &Hypothesis, addition: Addition) -> bool {
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

    /// Whether a test of what a hypothesis leaves could find more than noise.
    fn testable(&self, hypothesis: &Hypothesis) -> bool {
        self.whiteness(hypothesis).is_none_or(|white| white.testable)
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
                    self.race(&[&rest], &self.pool, Field::Best(1, None), known);
                }
            } else {
                let rest = rest();
                let aim = (&chosen, unit);
                if !known.raced(&additions) {
                    self.race(&[&rest], &self.pool, Field::Best(1, Some(aim)), known);
                }
                self.race_on(&rest, aim, known);
            }
            let mut rivals = known.beside(&additions);
            let bic = |h: &Hypothesis| self.bic(unit, h);
            let own = bic(&chosen);
            // Of effects, or of instruments, that leave noise alone and that the data do not tell apart the likeliest.
            let alike = |h: &Hypothesis| {
                let same = h.additions.last().is_some_and(|a| a.is_effect() == addition.is_effect());
                same && !structured && bic(h) + GAIN < own && !self.structured(h)
            };
            let better = |h: &Hypothesis| bic(h) + MARGIN < own || alike(h);
            let best = rivals.iter().filter(|h| better(h)).min_by(|a, b| bic(a).total_cmp(&bic(b)));
            if let Some(best) = best {
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
