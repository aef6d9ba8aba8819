//! Who races in a search: all candidates beside all parents, or pairs of laws, from the starting points that are worth a
//! fit.

use super::field::Field;
use super::hypothesis::{Addition, Hypothesis, extended};
use super::known::{Entry, Known};
use super::look::motion::Pair;
use super::look::{Count, Look, Parent, Start, look};
use super::options::{MARGIN, MISTAKE};
use super::race::{Competitor, Race, Round};
use super::runner::{Bar, COSTLY, Runner};
use super::select::{CONTINUED, Search};
use crate::fit::{cost, placed, resonance, robust_square, values_in};
use crate::model::Model;
use nalgebra::DVector;
use rayon::prelude::*;

/// Of single linkage: above 2 and the better the larger, by its authors' 4, that almost surely few basins are searched
/// twice.
const SIGMA: f64 = 4.0;

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
    /// The race of all candidates beside all parents; the hypotheses that came to its end, fitted to all points.
    pub(super) fn race(
        &self,
        parents: &[&Hypothesis],
        pool: &[Addition],
        entered: Field<'_>,
        known: &mut Known,
    ) -> Vec<Hypothesis> {
        let o = self.options;
        let (field, entries) = self.line_up(parents, pool, entered, known);
        let rules = match entered {
            Field::Best(..) => (o.first_evaluations, o.kept, o.survivors),
            Field::Each(_) => (o.first_evaluations, 1.0, field.len()),
        };
        if matches!(entered, Field::Best(..)) {
            known.parents.extend(parents.iter().map(|from| from.additions.clone()));
        }
        self.run_race((field, entries), rules, known)
    }

    /// Two laws of the motion together, started from what is estimated at the motion that was measured: what each of
    /// them does to a resonance may hide the other.
    pub(super) fn pairs(&self, from: &Hypothesis, known: &mut Known) -> Vec<Hypothesis> {
        let o = self.options;
        let points = self.data.begins_on(o);
        let parent = Parent::new(&self.data, from, from.fit.values.clone(), points);
        let rest = parent.rest();
        let found = parent.pairs(&self.data, from, &self.pool, (o.entrants, (o.starts, o.seed)));
        let one_more =
            |addition: Addition| -> Vec<Addition> { from.additions.iter().copied().chain([addition]).collect() };
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
        self.run_race((field, entries), (o.first_evaluations, o.kept, o.survivors), known)
    }

    /// All that left a race beside a hypothesis, from where they were: a rival of what is named has lost to it, squares
    /// in this unit, not to others or for what it costs.
    pub(super) fn race_on(&self, from: &Hypothesis, (best, unit): (&Hypothesis, f64), known: &mut Known) {
        let (rest, sure) = (&from.fit.evaluation.residuals, self.sure());
        let (mut field, mut entries): (Vec<Runner<'_, 'a>>, Vec<Entry>) = Default::default();
        for (addition, entry) in known.left_beside(&from.additions) {
            let model = entry.hypothesis.fitted();
            let values = values_in(&model, &self.data.beside(&model, from, addition));
            let start = Start { model, values, residuals: entry.hypothesis.left().0.clone() };
            field.push(Runner::new(&self.data, (from, entries.len(), sure), addition, (start, rest)));
            entries.push(entry);
        }
        field.iter_mut().for_each(|runner| runner.bar = Bar::At(best, unit));
        let all = field.len();
        // With the work of a second round, all of it as evaluations: a curved valley takes that many.
        let evaluations = (self.options.first_evaluations as f64 / self.options.kept).ceil() as usize;
        self.run_race((field, entries), (evaluations, 1.0, all), known);
    }

    /// Runs a race; the hypotheses that came to its end, fitted to all points.
    fn run_race(
        &self,
        (field, mut entries): (Vec<Runner<'_, 'a>>, Vec<Entry>),
        (evaluations, kept, survivors): (usize, f64, usize),
        known: &mut Known,
    ) -> Vec<Hypothesis> {
        let all = self.data.points.len();
        let first = Round { points: self.data.begins_on(self.options), evaluations, states: 0 };
        let ended = Race { first, points: all, kept, survivors }.run(field, |among| self.data.share(among));
        for runner in ended.dropped.iter().chain(&ended.survivors).filter(|runner| runner.fit.is_some()) {
            entries[runner.of].keep(runner.hypothesis(false));
        }
        let full = |r: &Runner<'_, '_>| r.fit.as_ref().is_some_and(|fit| fit.evaluation.predictions.len() == all);
        let going_on = ended.survivors.iter().filter(|runner| !runner.has_lost());
        let mut fitted: Vec<(usize, Hypothesis)> =
            going_on.map(|runner| (runner.of, runner.hypothesis(full(runner)))).collect();
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
            Field::Best(turn, _) => (turn, o.kept),
            Field::Each(_) => (0, 1.0),
        };
        let of = |number: usize| pool.iter().map(move |addition| (number, *addition));
        let work: Vec<(usize, Addition)> = (0..parents.len())
            .flat_map(of)
            .filter(|(number, addition)| self.goes_with(parents[*number], *addition))
            .collect();
        // A look is the round before the first, and takes half of its points.
        let points = self.data.begins_on(o) / 2;
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
            Field::Best(_, Some((best, unit))) | Field::Each(Some((best, unit))) => Bar::At(best, unit),
            _ => Bar::None,
        };
        if let [only] = parents
            && matches!(entered, Field::Best(..))
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

    /// A hypothesis where its fit is, and with the base where the scenario states it: once something is missing, a
    /// calibration may have carried it far off, and nothing is left there for an addition to act on.
    pub(super) fn places(&self, from: &Hypothesis, points: usize) -> Vec<Parent<'a>> {
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
        if let Some(seen) = placed::started(&from.model, &keys, self.data.points) {
            let values = values_in(&seen, &from.fit.parameters);
            let place = Parent::new(&self.data, from, values, points);
            let has_left = resonance::left_readings(&from.fitted(), self.data.points).is_some();
            places.push(if has_left { place } else { place.for_what_is_read_beside() });
        }
        places
    }
}
