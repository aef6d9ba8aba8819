//! Forward selection with a beam, exchange and backward elimination, from the calibrated base to the explanation.

use super::data::{Data, Effort, typical_of};
use super::hypothesis::{Addition, Basis, Estimate, Hypothesis, additions, compatible, extended};
use super::look::{Count, Look, Parent, Start, look};
use super::race::{Competitor, Race, Round};
use super::{Discovery, MARGIN, SearchOptions};
use crate::compare::{self, Whiteness};
use crate::fit::{Fit, Parameter, TAIL, robust_chi2};
use crate::measurement::{Noise, Table};
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Evaluations of one continuation of a fit to all points.
const CONTINUED: usize = 15;
/// Starting points along each parameter beside what leaves nothing but noise.
const FEW: usize = 2;
/// A continuum of sliders is looked at, and raced, on the points divided by this.
const COSTLY: usize = 2;
/// A sum of squares as large as of noise, so many standard deviations of its distribution above the mean.
const NOISE: f64 = 3.0;
/// Most continuations of a fit that ended for want of evaluations: it goes on while those that are left, each as good as the
/// last, may bring it level with the best, ...
const CONTINUATIONS: u32 = 8;
/// ... and gain more than this in the criterion each.
const GAIN: f64 = 0.1;

/// Finds what is missing in the model of a scenario, given its measurements.
pub fn discover(scenario: &Scenario, table: &Table, options: &SearchOptions) -> Discovery {
    searched(&table.applied_to(scenario), table, options, Noise::STATED)
}

/// Where the readings scatter more or less than their standard deviations say, these are scaled and the search begins again.
fn searched(scenario: &Scenario, table: &Table, options: &SearchOptions, noise: Noise) -> Discovery {
    let model = Model::new(scenario);
    let calibration = compare::calibrate(&model, &scenario.free, &table.points, Tolerance::default(), options.seed);
    let search = Search::new(scenario, table, options, &scenario.free, calibration.base.clone());
    let start = Hypothesis {
        additions: Vec::new(),
        model: calibration.base,
        fit: calibration.fit,
        estimate: None,
        bic: f64::INFINITY,
    };
    let mut known = Known::default();
    let chosen = search.forward(&start, &mut known);
    if noise == Noise::STATED
        && let Some(noise) = search.scatter(&chosen)
    {
        let left = options.budget.saturating_sub(search.data.solved());
        let options = SearchOptions { budget: left.max(1), ..options.clone() };
        return searched(scenario, &table.rescaled(noise), &options, noise);
    }
    search.run(&start, chosen, known, noise)
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

/// A hypothesis with one more addition, and what the look at that saw.
#[derive(Clone)]
pub(super) struct Entry {
    pub hypothesis: Hypothesis,
    /// As of [`Look`].
    pub visibility: f64,
    pub strongest: Vec<Model>,
}

impl Entry {
    /// Of a single addition that was fitted: that and the model.
    fn single(&self) -> Option<(Addition, Model)> {
        let [addition] = self.hypothesis.additions[..] else { return None };
        (self.hypothesis.basis() != Basis::Linear).then(|| (addition, self.hypothesis.fitted()))
    }
}

/// All hypotheses that were fitted, the best fit of each.
#[derive(Default)]
pub(super) struct Known {
    pub entries: Vec<Entry>,
    /// What every candidate was raced beside.
    parents: Vec<Vec<Addition>>,
}

impl Known {
    /// Whether all candidates were raced beside these.
    fn raced(&self, additions: &[Addition]) -> bool {
        self.parents.iter().any(|known| known.len() == additions.len() && known.iter().all(|a| additions.contains(a)))
    }

    /// What was fitted to all points with one addition more than these, that last.
    fn beside(&self, additions: &[Addition]) -> Vec<Hypothesis> {
        let one_more = |h: &&Hypothesis| {
            h.estimate.is_none()
                && h.additions.len() == additions.len() + 1
                && additions.iter().all(|a| h.additions.contains(a))
        };
        let mut found: Vec<Hypothesis> = self.entries.iter().map(|e| &e.hypothesis).filter(one_more).cloned().collect();
        for hypothesis in &mut found {
            hypothesis.additions.sort_by_key(|a| !additions.contains(a));
        }
        found
    }

    /// Keeps the better of two fits of the same additions: one to all points before one to some.
    fn keep(&mut self, entry: &Entry) {
        let Some(own) = self.entries.iter_mut().find(|e| e.hypothesis.same_additions(&entry.hypothesis)) else {
            self.entries.push(entry.clone());
            return;
        };
        let square = |h: &Hypothesis| robust_chi2(&h.fit.evaluation.residuals, TAIL);
        let better = match (&own.hypothesis.estimate, &entry.hypothesis.estimate) {
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (None, None) => square(&entry.hypothesis) < square(&own.hypothesis),
            (Some(a), Some(b)) => b.square < a.square,
        };
        if better {
            own.hypothesis = entry.hypothesis.clone();
        }
        if entry.visibility > own.visibility {
            (own.visibility, own.strongest) = (entry.visibility, entry.strongest.clone());
        }
    }
}

/// A fit of one more addition from one starting point, on its way.
struct Runner<'s, 'a> {
    search: &'s Search<'a>,
    from: &'s Hypothesis,
    of: usize,
    addition: Addition,
    model: Model,
    parameters: Vec<Parameter>,
    values: Vec<f64>,
    residuals: DVector<f64>,
    fit: Option<Fit>,
    /// What the last round took off its badness.
    gain: f64,
    /// Above what it is of no use.
    bar: Bar,
}

/// Criterion above which a fit is of no use.
#[derive(Clone, Copy)]
enum Bar {
    None,
    /// That of the hypothesis that it adds to, which leaves nothing but noise, less the margin.
    Parent,
    /// This one.
    At(f64),
}

/// Who goes on in a race.
#[derive(Clone, Copy)]
enum Field {
    /// The best of all, from starting points of this part of the sequence.
    Best(usize),
    /// Every candidate by itself, unless at its minimum it stays above this criterion.
    Each(f64),
}

impl<'s, 'a> Runner<'s, 'a> {
    fn new(search: &'s Search<'a>, (from, of): (&'s Hypothesis, usize), addition: Addition, start: Start) -> Self {
        let Start { model, values, residuals } = start;
        let parameters = search.data.beside(&model, from, addition);
        Self { search, from, of, addition, model, parameters, values, residuals, fit: None, gain: 0.0, bar: Bar::None }
    }

    /// Readings over those that the residuals are of.
    fn scale(&self) -> f64 {
        self.search.data.readings() as f64 / self.residuals.len().max(1) as f64
    }

    /// The criterion of the hypothesis that it adds to, on the points that it was fitted to.
    fn aim(&self) -> f64 {
        let points = self.fit.as_ref().map_or(0, |fit| fit.evaluation.predictions.len());
        let residuals = self.search.data.part(&self.from.fit.evaluation.residuals, points);
        self.scale() * robust_chi2(&residuals, TAIL) + self.search.price(self.from.fit.parameters.len())
    }

    fn hypothesis(&self, full: bool) -> Hypothesis {
        let additions: Vec<Addition> = self.from.additions.iter().copied().chain([self.addition]).collect();
        let own = self.scale() * robust_chi2(&self.residuals, TAIL);
        let basis = match &self.fit {
            Some(fit) => Basis::SomePoints(fit.evaluation.predictions.len()),
            None => Basis::Linear,
        };
        let unfitted = || {
            let mut fit = self.from.fit.clone();
            (fit.parameters, fit.values) = (self.parameters.clone(), self.values.clone());
            fit.evaluation.jacobian = DMatrix::zeros(fit.evaluation.residuals.len(), fit.parameters.len());
            fit.termination = "not fitted: in a linear estimate it explains too little".into();
            fit
        };
        let fit = self.fit.clone().unwrap_or_else(unfitted);
        let estimate = (!full).then_some(Estimate { square: own, basis });
        Hypothesis { additions, model: self.model.clone(), fit, estimate, bic: f64::INFINITY }
    }
}

impl Competitor for Runner<'_, '_> {
    fn of(&self) -> usize {
        self.of
    }

    fn advance(&mut self, Round { points, evaluations }: Round) {
        let typical = if self.fit.is_some() { typical_of(&self.residuals) } else { f64::INFINITY };
        let all = self.search.data.points.len();
        let points = if self.model.has_continuum() && points < all { points / COSTLY } else { points };
        let effort = Effort { points, evaluations };
        if !self.search.data.affords(&self.model, effort) {
            return;
        }
        let before = if self.fit.is_some() { self.badness(1.0) } else { f64::INFINITY };
        let fit = self.search.data.fit(&self.model, &self.parameters, &self.values, typical, effort);
        self.values.clone_from(&fit.values);
        self.residuals.clone_from(&fit.evaluation.residuals);
        self.fit = Some(fit);
        self.gain = (before - self.badness(1.0)).max(0.0);
    }

    fn typical(&self) -> f64 {
        typical_of(&self.residuals)
    }

    fn badness(&self, typical: f64) -> f64 {
        self.scale() * robust_chi2(&self.residuals, TAIL * typical) + self.search.price(self.parameters.len())
    }

    fn is_beaten(&self, first: &Self) -> bool {
        let Some(fit) = &self.fit else { return false };
        // What it was fitted to is enough to tell, were it to gain in the next round, with twice the evaluations, twice as much.
        let gain = if fit.is_exhausted() { 2.0 * self.gain } else { 0.0 };
        let above = |bar: f64| self.badness(1.0) - gain - bar > MARGIN * self.scale();
        let count = first.residuals.len() as f64;
        let noise = robust_chi2(&first.residuals, TAIL) < count + NOISE * (2.0 * count).sqrt();
        let barred = match self.bar {
            Bar::None => false,
            Bar::Parent => self.badness(1.0) + MARGIN >= self.aim(),
            Bar::At(bar) => above(bar),
        };
        barred || (noise && above(first.badness(1.0)))
    }
}

impl<'a> Search<'a> {
    /// A search for what is missing in `base`, whose parameters `free` move.
    pub fn new(
        scenario: &'a Scenario,
        table: &'a Table,
        options: &'a SearchOptions,
        free: &[String],
        base: Model,
    ) -> Self {
        let data = Data::new(base, free, &table.points, options.budget);
        let pool = additions(&data.base, free, table.points.iter().any(|p| p.phase.is_some()));
        Self { scenario, table, options, data, pool }
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

    /// Whether there is anything left to spend.
    pub(super) fn goes_on(&self) -> bool {
        self.data.solved() < self.data.budget
    }

    /// Adds to a hypothesis as long as that pays, and removes what that makes needless: all candidates race beside the leading
    /// hypotheses.
    fn forward(&self, start: &Hypothesis, known: &mut Known) -> Hypothesis {
        let (mut chosen, mut beam) = (start.clone(), vec![start.clone()]);
        for _ in 0..self.options.max_effects {
            beam.retain(|h| h.additions.len() < self.options.max_effects);
            if beam.is_empty() || !self.goes_on() {
                break;
            }
            let mut full = self.race(&beam.iter().collect::<Vec<_>>(), &self.pool, Field::Best(0), known);
            // What leaves structure is held against everything that a user might add by hand, fitted as it would be then.
            let best = self.pick(&full, true).unwrap_or_else(|| chosen.clone());
            if self.structured(&best) && self.goes_on() {
                full.extend(self.race(&[&chosen], &self.pool, Field::Each(self.bic(&best)), known));
            }
            let Some(best) = self.pick(&full, chosen.additions.is_empty()) else { break };
            if self.score(&chosen) - self.score(&best) <= MARGIN {
                break;
            }
            chosen = self.eliminate(best);
            if !self.structured(&chosen) && !chosen.fitted().has_continuum() {
                beam = vec![chosen.clone()];
                continue;
            }
            if !self.structured(&chosen) {
                break;
            }
            full.push(chosen.clone());
            full.sort_by(|a, b| self.bic(a).total_cmp(&self.bic(b)));
            beam.clear();
            for hypothesis in full {
                if beam.len() < self.options.beam && !beam.iter().any(|h| h.same_additions(&hypothesis)) {
                    beam.push(hypothesis);
                }
            }
        }
        chosen
    }

    /// The race of all candidates beside all parents; the hypotheses that came to its end, fitted to all points.
    fn race(&self, parents: &[&Hypothesis], pool: &[Addition], entered: Field, known: &mut Known) -> Vec<Hypothesis> {
        let o = self.options;
        let (turn, kept, survivors, mut bar) = match entered {
            Field::Best(turn) => (turn, o.kept, o.survivors, Bar::None),
            Field::Each(bar) => (0, 1.0, pool.len() * o.entrants, Bar::At(bar)),
        };
        let points = o.first_points.min(self.data.points.len());
        let work: Vec<(usize, Addition)> = parents
            .iter()
            .enumerate()
            .flat_map(|(number, _)| pool.iter().map(move |addition| (number, *addition)))
            .filter(|(number, addition)| self.goes_with(parents[*number], *addition))
            .collect();
        // A continuum of sliders costs as much as all others together: it is looked at on fewer points, ...
        let costly = |from: &Hypothesis, addition: Addition| {
            extended(&from.model, &[addition]).has_continuum() && !from.model.has_continuum()
        };
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
                // Whether a weak trace of it is there any starting point tells; which basin, only many.
                let starts = if self.structured(from) { o.starts } else { FEW };
                let count = Count { known, starts, shared: parents.len(), turn, seed: o.seed };
                look(&self.data, &places[usize::from(costly(from, *addition))][*number], from, *addition, count)
            })
            .collect();
        let mut field: Vec<Runner<'_, '_>> = Vec::new();
        let mut entries: Vec<Entry> = Vec::new();
        for (of, ((number, addition), look)) in work.iter().zip(looks).enumerate() {
            let Look { starts, visibility, strongest } = look;
            let runners = starts.into_iter().map(|start| Runner::new(self, (parents[*number], of), *addition, start));
            let mut runners: Vec<Runner<'_, '_>> = runners.collect();
            // The starting points of a candidate compete with one another first: a linear estimate tells them apart, but little
            // of what candidates are worth.
            let typical = runners.iter().map(Competitor::typical).fold(f64::INFINITY, f64::min);
            runners.sort_by(|a, b| a.badness(typical).total_cmp(&b.badness(typical)));
            runners.truncate(((runners.len() as f64 * kept).ceil() as usize).min(o.entrants));
            let Some(first) = runners.first() else { continue };
            entries.push(Entry { hypothesis: first.hypothesis(false), visibility, strongest });
            field.extend(runners);
        }
        // ... and once something is found competes only if that leaves structure, and it promises most.
        let typical = field.iter().map(Competitor::typical).fold(f64::INFINITY, f64::min);
        let most = field.iter().map(|r| r.badness(typical)).fold(f64::INFINITY, f64::min);
        field.retain(|r| {
            let wanted = r.from.additions.is_empty() || (r.badness(typical) <= most && self.structured(r.from));
            wanted || !costly(r.from, r.addition)
        });
        // Beside what leaves nothing but noise only what would be decided for is worth a fit, unless it is asked for.
        if let [only] = parents
            && matches!(bar, Bar::None)
            && !self.structured(only)
        {
            let rest = places[0][0][0].rest();
            let scale = self.data.readings() as f64 / rest.len().max(1) as f64;
            let aim = scale * robust_chi2(&rest, TAIL);
            let price = self.price(only.fit.parameters.len());
            field.retain(|runner| runner.badness(1.0) + MARGIN < aim + price);
            bar = Bar::Parent;
        }
        let race = Race {
            first: Round { points, evaluations: o.first_evaluations },
            points: self.data.points.len(),
            kept,
            survivors,
        };
        field.iter_mut().for_each(|runner| runner.bar = bar);
        let ended = race.run(field, || self.goes_on());
        for runner in ended.dropped.iter().chain(&ended.survivors) {
            self.told(&mut entries, runner.of, runner.hypothesis(false));
        }
        let all = self.data.points.len();
        let full = |r: &Runner<'_, '_>| r.fit.as_ref().is_some_and(|fit| fit.evaluation.predictions.len() == all);
        let mut fitted: Vec<(usize, Hypothesis)> =
            ended.survivors.iter().map(|runner| (runner.of, runner.hypothesis(full(runner)))).collect();
        let effort = Effort { points: all, evaluations: CONTINUED };
        fitted.retain(|(_, h)| h.is_full(all) || self.data.affords(&h.model, effort));
        fitted.par_iter_mut().filter(|(_, h)| !h.is_full(all)).for_each(|(_, h)| {
            *h = self.data.fitted(h.clone(), CONTINUED);
        });
        let best = fitted.iter().map(|(_, h)| h).min_by(|a, b| square(a).total_cmp(&square(b)));
        if let Some(best) = best.cloned() {
            self.settle_all(fitted.iter_mut().map(|(_, h)| h).collect(), &best);
        }
        for (of, hypothesis) in &fitted {
            self.told(&mut entries, *of, hypothesis.clone());
        }
        entries.iter().for_each(|entry| known.keep(entry));
        if matches!(entered, Field::Best(_)) {
            known.parents.extend(parents.iter().map(|from| from.additions.clone()));
        }
        fitted.into_iter().map(|(_, hypothesis)| hypothesis).collect()
    }

    /// Keeps the better fit of the candidate number `of`.
    fn told(&self, entries: &mut [Entry], of: usize, hypothesis: Hypothesis) {
        let mut one = Known { entries: vec![entries[of].clone()], parents: Vec::new() };
        let entry = Entry { hypothesis, ..entries[of].clone() };
        one.keep(&entry);
        entries[of] = one.entries.remove(0);
    }

    /// The best fit of one addition to a hypothesis.
    pub(super) fn add(&self, from: &Hypothesis, addition: Addition, known: &mut Known) -> Option<Hypothesis> {
        let found = self.race(&[from], &[addition], Field::Each(f64::INFINITY), known);
        found.into_iter().min_by(|a, b| square(a).total_cmp(&square(b)))
    }

    /// A hypothesis where its fit is, and with the base where the scenario states it: once something is missing, a calibration
    /// may have carried it far off, and nothing is left there for an addition to act on.
    fn places(&self, from: &Hypothesis, points: usize) -> Vec<Parent<'a>> {
        let fitted = from.fit.values.clone();
        let mut stated = fitted.clone();
        stated[..self.data.stated.len()].copy_from_slice(&self.data.stated);
        let mut places = vec![Parent::new(&self.data, from, fitted.clone(), points)];
        if stated != fitted && from.additions.is_empty() {
            places.push(Parent::new(&self.data, from, stated, points));
        }
        places
    }

    fn goes_with(&self, from: &Hypothesis, addition: Addition) -> bool {
        let all: Vec<Addition> = from.additions.iter().copied().chain([addition]).collect();
        !from.additions.contains(&addition) && compatible(&self.data.base, &all)
    }

    /// Follows fits that ended for want of evaluations, in a curved valley say, to their minimum, while they may come level with
    /// the best.
    fn settle_all(&self, mut all: Vec<&mut Hypothesis>, best: &Hypothesis) {
        let best = self.bic(best);
        all.par_iter_mut().for_each(|h| {
            let effort = Effort { points: self.data.points.len(), evaluations: CONTINUED };
            for _ in 0..CONTINUATIONS {
                if !h.fit.is_exhausted() || !self.data.affords(&h.model, effort) {
                    break;
                }
                let before = self.bic(h);
                **h = self.data.fitted((*h).clone(), CONTINUED);
                let gain = before - self.bic(h);
                if gain < GAIN || before - 2.0 * gain > best + MARGIN {
                    break;
                }
            }
        });
    }

    /// Whether a hypothesis leaves more than noise.
    pub(super) fn structured(&self, hypothesis: &Hypothesis) -> bool {
        self.whiteness(hypothesis).is_none_or(|white| white.structured)
    }

    /// The best of hypotheses. Of those that the data do not tell apart the simpler: at first a recalibration; once something
    /// is known to be missing, an effect.
    fn pick(&self, all: &[Hypothesis], first: bool) -> Option<Hypothesis> {
        let bic = |h: &Hypothesis| self.bic(h);
        let best = all.iter().map(bic).fold(f64::INFINITY, f64::min);
        let preferred = |h: &Hypothesis| h.additions.last().is_some_and(|a| a.is_effect() != first);
        let close: Vec<&Hypothesis> = all.iter().filter(|h| bic(h) - best < MARGIN).collect();
        let simple = close.iter().filter(|h| preferred(h)).min_by(|a, b| bic(a).total_cmp(&bic(b)));
        simple.or(close.iter().min_by(|a, b| bic(a).total_cmp(&bic(b)))).map(|h| (**h).clone())
    }

    /// Removes additions that the others make needless; the last may merely have helped an earlier one out of a local minimum.
    fn eliminate(&self, chosen: Hypothesis) -> Hypothesis {
        let mut chosen = chosen;
        let mut index = 0;
        while chosen.additions.len() > 1 && index < chosen.additions.len() {
            let mut additions = chosen.additions.clone();
            additions.remove(index);
            let mut fewer = self.refit(&chosen, additions);
            self.settle_all(vec![&mut fewer], &chosen);
            if self.score(&fewer) < self.score(&chosen) + MARGIN {
                chosen = fewer;
                index = 0;
            } else {
                index += 1;
            }
        }
        chosen
    }

    /// The hypothesis with only these additions, fitted from the values it has.
    pub(super) fn refit(&self, from: &Hypothesis, additions: Vec<Addition>) -> Hypothesis {
        self.data.fitted(self.reduced(from, additions), CONTINUED)
    }

    /// The hypothesis with only these additions, at the values it has.
    fn reduced(&self, from: &Hypothesis, additions: Vec<Addition>) -> Hypothesis {
        let fitted = from.fitted();
        let mut model = extended(&self.data.base, &additions);
        for (effect, values) in &mut model.effects {
            if let Some((_, own)) = fitted.effects.iter().find(|(e, _)| e.name() == effect.name()) {
                values.clone_from(own);
            }
        }
        let mut fit = from.fit.clone();
        fit.parameters = self.data.movable(&model, &additions);
        let value = |key: &str| from.fit.parameters.iter().position(|p| p.key == key).map(|i| from.fit.values[i]);
        fit.values = fit.parameters.iter().filter_map(|p| value(&p.key)).collect();
        let points = self.data.some(self.data.points.len());
        let mut problem = crate::fit::Problem::new(model.clone(), points, fit.parameters.clone(), Tolerance::FIT);
        fit.evaluation = problem.evaluate(&fit.values, true);
        self.data.count(&model, problem.solved);
        Hypothesis { additions, model, fit, estimate: None, bic: f64::INFINITY }
    }

    /// Replaces every addition in turn by another that explains better beside the others, itself at another place included;
    /// with what does as well in the place of each, itself first.
    fn exchange(&self, chosen: Hypothesis, known: &mut Known) -> (Hypothesis, Vec<Vec<Hypothesis>>) {
        let mut chosen = chosen;
        let mut ties: Vec<Vec<Hypothesis>> = Vec::new();
        // What is no explanation has none that does as well.
        if self.structured(&chosen) {
            return (chosen, ties);
        }
        while ties.len() < chosen.additions.len() {
            let index = ties.len();
            let addition = chosen.additions[index];
            let mut additions = chosen.additions.clone();
            additions.remove(index);
            if !known.raced(&additions) {
                let rest = self.refit(&chosen, additions.clone());
                self.race(&[&rest], &self.pool, Field::Best(1), known);
            }
            let mut rivals = known.beside(&additions);
            let own = self.bic(&chosen);
            let best = rivals.iter().min_by(|a, b| self.bic(a).total_cmp(&self.bic(b)));
            if let Some(best) = best.filter(|best| self.bic(best) + MARGIN < own) {
                chosen = self.eliminate(best.clone());
                ties.clear();
                continue;
            }
            rivals.retain(|h| h.additions.last() != Some(&addition) && self.bic(h) - own < MARGIN);
            rivals.sort_by(|a, b| self.bic(a).total_cmp(&self.bic(b)));
            let mut itself = chosen.clone();
            itself.additions.remove(index);
            itself.additions.push(addition);
            rivals.insert(0, itself);
            ties.push(rivals);
        }
        (chosen, ties)
    }

    /// Scatter of the residuals of a hypothesis about anything smooth over the stated noise, where that contradicts it.
    fn scatter(&self, hypothesis: &Hypothesis) -> Option<Noise> {
        let points = compare::compared(&self.table.points, &hypothesis.fit.evaluation.predictions);
        compare::scatter(&points, self.table, hypothesis.fit.parameters.len())
    }

    /// Tests of the residuals; `None` where the fit is to a part of the points.
    fn whiteness(&self, hypothesis: &Hypothesis) -> Option<Whiteness> {
        if hypothesis.fit.evaluation.predictions.len() != self.data.points.len() {
            return None;
        }
        let points = compare::compared(&self.table.points, &hypothesis.fit.evaluation.predictions);
        let (series, parameters) = (self.table.series.len(), hypothesis.fit.parameters.len());
        Some(compare::whiteness(&points, series, parameters, self.table.amplitude_noise))
    }

    pub(super) fn readings(&self) -> usize {
        self.data.readings()
    }

    /// What Schwarz's criterion charges for parameters.
    fn price(&self, parameters: usize) -> f64 {
        parameters as f64 * (self.readings() as f64).ln()
    }

    /// Schwarz's criterion.
    pub(super) fn bic(&self, hypothesis: &Hypothesis) -> f64 {
        square(hypothesis) + self.price(hypothesis.fit.parameters.len())
    }

    /// The criterion with a charge for having looked at many additions (extended BIC of Chen and Chen 2008).
    fn score(&self, hypothesis: &Hypothesis) -> f64 {
        self.bic(hypothesis) + 2.0 * hypothesis.additions.len() as f64 * (self.pool.len().max(1) as f64).ln()
    }
}

/// Sum of squares of the residuals, large ones counted less.
pub(super) fn square(hypothesis: &Hypothesis) -> f64 {
    let own = || robust_chi2(&hypothesis.fit.evaluation.residuals, TAIL);
    hypothesis.estimate.map_or_else(own, |estimate| estimate.square)
}
