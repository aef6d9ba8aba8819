//! Forward selection with backward elimination and exchange, from the calibrated base to the explanation.

use super::hypothesis::{Addition, Hypothesis, additions};
use super::round::{CONTESTED, Entry, Pace, Round, Rounds};
use super::search::{Data, on_all, on_all_problem, on_part, scattered_fit};
use super::{Discovery, MARGIN, Options};
use crate::compare::{self, Calibration, Whiteness};
use crate::fit::{HUBER, robust_chi2};
use crate::measurement::Table;
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use rayon::prelude::*;

/// Sum of squares per reading up to which structure may be left by a fit that is not quite the best.
const NEARLY: f64 = 1.1;
/// Where structure is left, additions whose sum of squares is within this factor of the best are carried on ...
const CONTENDING: f64 = 1.3;
/// ... up to so many: what explains best alone need not belong to the best pair.
const CARRIED: usize = 2;
/// Where the explanation leaves structure, pairs with so many of the leading first additions are tried quickly, ...
const OTHER_BEGINNINGS: usize = 5;
/// ... and if a third addition leaves structure too, the pairs with the first so many thoroughly.
const THOROUGH: usize = 2;
/// Scattered starts are tried for so many of the leading first additions ...
const ELSEWHERE: usize = 3;
/// ... and for the explanation, if it has at most so many: they are too few for the parameters of more.
const ELSEWHERE_ADDITIONS: usize = 2;
/// Sum of squares per reading from which on nothing is exchanged, and what does as well is not looked for.
const FAR: f64 = 5.0;
/// Times that the additions of an explanation are exchanged one after the other.
const EXCHANGES: usize = 2;

/// Finds what is missing in the model of a scenario, given its measurements.
pub fn discover(scenario: &Scenario, table: &Table, options: &Options) -> Discovery {
    let scenario = &table.applied_to(scenario);
    let base = Model::new(scenario);
    let calibration = compare::calibrate(&base, &scenario.free, &table.points, Tolerance::default(), options.seed);
    let base = calibration.base.clone();
    let stated = compare::problem(&base, &scenario.free, [], Tolerance::default()).values();
    let data = Data::new(base, &table.points, calibration.threshold, stated, options.seed);
    let pool = additions(&data.base, &scenario.free, table.points.iter().any(|p| p.phase.is_some()));
    let search = Search { scenario, table, options, data, pool };
    search.run(calibration)
}

pub(super) struct Search<'a> {
    pub scenario: &'a Scenario,
    pub table: &'a Table,
    pub options: &'a Options,
    pub data: Data<'a>,
    /// Everything that may be added.
    pub pool: Vec<Addition>,
}

impl Search<'_> {
    fn run(&self, calibration: Calibration) -> Discovery {
        let start = Hypothesis {
            additions: Vec::new(),
            model: self.data.base.clone(),
            fit: calibration.fit,
            estimate: None,
            bic: f64::INFINITY,
        };
        let mut rounds = Rounds::default();
        let mut chosen = self.extend(start.clone(), &mut rounds);
        if self.structured(&chosen)
            && let Some(better) = self.begin_elsewhere(&chosen, &rounds)
        {
            let better = self.eliminate(better);
            rounds.forget(&better);
            chosen = self.extend(better, &mut rounds);
        }
        // What is far from an explanation is none with one addition in place of another either.
        let far = |chosen: &Hypothesis| self.square(chosen, self.noise(chosen)) > FAR * self.readings() as f64;
        if !far(&chosen) {
            let exchanged = self.exchange(chosen.clone(), &mut rounds);
            // A better minimum of the same may show that one of them is needless, too.
            let moved = exchanged.fit.objective != chosen.fit.objective;
            chosen = if moved { self.eliminate(exchanged) } else { exchanged };
        }
        self.settle(&mut chosen);
        let explanation = loop {
            // A profile of what does not explain the data says nothing; of what nearly does, it may lead to a better fit.
            let nearly = chosen.fit.objective < NEARLY * self.readings() as f64;
            let profiled = !self.structured(&chosen) || (nearly && !chosen.additions.is_empty());
            let comparison = self.comparison(&chosen, profiled, self.noise(&chosen));
            let moved = comparison.fit.values != chosen.fit.values;
            chosen.fit.clone_from(&comparison.fit);
            // Where the profiles moved the fit, an addition may have become needless.
            let fewer = if moved { self.eliminate(chosen.clone()) } else { chosen.clone() };
            if fewer.additions.len() == chosen.additions.len() {
                break comparison;
            }
            chosen = fewer;
        };
        let ties = if far(&chosen) { Vec::new() } else { self.ties(&chosen, &mut rounds) };
        self.conclude(&start, &chosen, explanation, &rounds, &ties)
    }

    /// Adds to a hypothesis as long as that pays, and removes what that makes needless; where a pair leaves structure it looks
    /// for another one, quickly before a third addition, thoroughly where that leaves structure too.
    fn extend(&self, from: Hypothesis, rounds: &mut Rounds) -> Hypothesis {
        let (mut pair, mut contenders) = self.extend_to(2, vec![from.clone()], from, rounds);
        if self.options.max_effects > 1 && self.structured(&pair) {
            let others = self.other_beginnings(rounds);
            if let Some(other) = self.begin_otherwise(&others, &pair, rounds, Pace::Quick) {
                (pair, contenders) = (other.clone(), vec![other]);
            }
            let chosen = self.extend_to(usize::MAX, contenders, pair.clone(), rounds).0;
            if !self.structured(&chosen) {
                return chosen;
            }
            let leading = &others[..others.len().min(THOROUGH)];
            let Some(other) = self.begin_otherwise(leading, &pair, rounds, Pace::Thorough) else { return chosen };
            let other = self.extend_to(usize::MAX, vec![other.clone()], other, rounds).0;
            let noise = self.noise(&other);
            return if self.score(&other, noise) < self.score(&chosen, noise) { other } else { chosen };
        }
        self.extend_to(usize::MAX, contenders, pair, rounds).0
    }

    /// Adds to a hypothesis as long as that pays, up to so many additions; with those that may lead further than it does.
    fn extend_to(
        &self,
        most: usize,
        frontier: Vec<Hypothesis>,
        from: Hypothesis,
        rounds: &mut Rounds,
    ) -> (Hypothesis, Vec<Hypothesis>) {
        let (mut frontier, mut chosen) = (frontier, from);
        while chosen.additions.len() < self.options.max_effects.min(most) {
            // Nothing is looked for beside a continuum of sliders that leaves nothing but noise: it takes too long to solve.
            if chosen.fitted().has_continuum() && !self.structured(&chosen) {
                break;
            }
            let pace = if chosen.additions.is_empty() { Pace::Thorough } else { Pace::Quick };
            let Some((best, contenders)) = self.advance(&frontier, rounds, pace) else { break };
            let noise = self.noise(&best);
            if self.score(&chosen, noise) - self.score(&best, noise) <= MARGIN {
                break;
            }
            let length = best.additions.len();
            chosen = self.eliminate(best);
            frontier = if self.structured(&chosen) && chosen.additions.len() == length {
                contenders
            } else {
                vec![chosen.clone()]
            };
        }
        (chosen, frontier)
    }

    /// Where structure is left, the explanation or one of the leading first additions may sit in a local minimum, the
    /// parameters of the base with it: the best of them fitted from starts scattered over the ranges of all parameters, if it
    /// explains better.
    fn begin_elsewhere(&self, chosen: &Hypothesis, rounds: &Rounds) -> Option<Hypothesis> {
        let mut from: Vec<Hypothesis> = self.first_additions(rounds).into_iter().take(ELSEWHERE).collect();
        from.retain(|h| !h.same_additions(chosen));
        if chosen.additions.len() <= ELSEWHERE_ADDITIONS {
            from.push(chosen.clone());
        }
        let mut problem = on_part(&self.data, &chosen.model, chosen.fit.parameters.clone());
        let aim = robust_chi2(&problem.evaluate(&chosen.fit.values, false).residuals, self.data.threshold);
        let refitted = from.into_par_iter().filter(|h| !h.additions.is_empty()).filter_map(|h| {
            let (model, fit) = scattered_fit(&self.data, &h.model, &h.fit, aim)?;
            let mut found = Hypothesis { model, fit, estimate: None, ..h };
            self.settle(&mut found);
            Some(found)
        });
        let refitted: Vec<Hypothesis> = refitted.collect();
        let noise = self.noise(chosen);
        let best = refitted.into_iter().min_by(|a, b| self.score(a, noise).total_cmp(&self.score(b, noise)))?;
        (self.score(&best, noise) + MARGIN < self.score(chosen, noise)).then_some(best)
    }

    /// The leading first additions, fitted to all points.
    fn other_beginnings(&self, rounds: &Rounds) -> Vec<Hypothesis> {
        let mut others = self.first_additions(rounds);
        // Beside a continuum of sliders every look takes too long.
        others.retain(|h| !h.model.has_continuum());
        others.truncate(OTHER_BEGINNINGS);
        for other in others.iter_mut().filter(|other| other.estimate.is_some()) {
            other.fit = on_all(&self.data, &other.model, &other.fit);
            other.estimate = None;
        }
        others
    }

    /// The best pair that contains one of these first additions, if it explains better than what is `chosen`; the first that
    /// leaves nothing but noise.
    fn begin_otherwise(
        &self,
        others: &[Hypothesis],
        chosen: &Hypothesis,
        rounds: &mut Rounds,
        pace: Pace<'_>,
    ) -> Option<Hypothesis> {
        let mut best: Option<Hypothesis> = None;
        for other in others {
            if matches!(pace, Pace::Thorough) {
                rounds.forget_beyond(other);
            }
            let Some((pair, _)) = self.advance(std::slice::from_ref(other), rounds, pace) else { continue };
            let noise = self.noise(&pair);
            if self.score(&pair, noise) + MARGIN < self.score(best.as_ref().unwrap_or(chosen), noise) {
                best = Some(self.eliminate(pair));
            }
            if best.as_ref().is_some_and(|best| !self.structured(best)) {
                break;
            }
        }
        best
    }

    /// The best hypothesis with one addition more than one of the frontier, and those that may lead further than it does.
    /// Ends early where one explains the data.
    fn advance(
        &self,
        frontier: &[Hypothesis],
        rounds: &mut Rounds,
        pace: Pace<'_>,
    ) -> Option<(Hypothesis, Vec<Hypothesis>)> {
        let mut best: Option<Hypothesis> = None;
        let mut all: Vec<Hypothesis> = Vec::new();
        for from in frontier {
            let round = self.round(from, rounds, pace);
            let Some(entry) = self.pick(round, from.additions.is_empty()) else { continue };
            let hypothesis = entry.found.hypothesis;
            let noise = self.noise(&hypothesis);
            if self.score(from, noise) - self.score(&hypothesis, noise) <= MARGIN {
                continue;
            }
            all.extend(round.found.iter().filter(|e| e.full).map(|e| e.found.hypothesis.clone()));
            let better = |best: &Hypothesis| self.score(&hypothesis, noise) < self.score(best, noise);
            if best.as_ref().is_none_or(better) {
                best = Some(hypothesis);
            }
            if best.as_ref().is_some_and(|best| !self.structured(best)) {
                break;
            }
        }
        let best = best?;
        // The simplest first: it is what more complicated ones may only imitate.
        all.retain(|h| h.fit.objective < CONTENDING * best.fit.objective);
        all.sort_by(|a, b| {
            let parameters = a.fit.parameters.len().cmp(&b.fit.parameters.len());
            parameters.then_with(|| a.fit.objective.total_cmp(&b.fit.objective))
        });
        all.truncate(CARRIED - 1);
        if !all.iter().any(|h| h.same_additions(&best)) {
            all.push(best.clone());
        }
        Some((best, all))
    }

    /// Whether a hypothesis leaves more than noise.
    pub(super) fn structured(&self, hypothesis: &Hypothesis) -> bool {
        self.whiteness(hypothesis).is_none_or(|white| white.structured)
    }

    /// The best addition. Of those that the data do not tell apart the simpler: at first a recalibration; once something is
    /// known to be missing, an effect.
    fn pick(&self, round: &Round, first: bool) -> Option<Entry> {
        let full: Vec<&Entry> = round.found.iter().filter(|e| e.full).collect();
        let noise = self.noise(
            full.iter().map(|e| &e.found.hypothesis).min_by(|a, b| a.fit.objective.total_cmp(&b.fit.objective))?,
        );
        let bic = |entry: &Entry| self.bic(&entry.found.hypothesis, noise);
        let best = full.iter().map(|e| bic(e)).fold(f64::INFINITY, f64::min);
        let preferred = |entry: &Entry| entry.found.hypothesis.additions.last().is_some_and(|a| a.is_effect() != first);
        let close: Vec<&&Entry> = full.iter().filter(|e| bic(e) - best < MARGIN).collect();
        let simple = close.iter().filter(|e| preferred(e)).min_by(|a, b| bic(a).total_cmp(&bic(b)));
        simple.or(close.iter().min_by(|a, b| bic(a).total_cmp(&bic(b)))).map(|e| (**e).clone())
    }

    /// Removes additions that the others make needless; the last may merely have helped an earlier one out of a local minimum.
    fn eliminate(&self, chosen: Hypothesis) -> Hypothesis {
        let mut chosen = chosen;
        let mut index = 0;
        while chosen.additions.len() > 1 && index < chosen.additions.len() {
            let mut fewer = self.refit_without(&chosen, index);
            if fewer.fit.objective < chosen.fit.objective + CONTESTED {
                self.settle(&mut fewer);
            }
            let noise = self.noise(&chosen);
            if self.score(&fewer, noise) < self.score(&chosen, noise) + MARGIN {
                chosen = fewer;
                index = 0;
            } else {
                index += 1;
            }
        }
        chosen
    }

    fn refit_without(&self, from: &Hypothesis, index: usize) -> Hypothesis {
        let mut additions = from.additions.clone();
        additions.remove(index);
        self.refit(from, additions)
    }

    /// What an addition of the explanation competes for: the same without it, the rest as it is.
    fn without(&self, from: &Hypothesis, index: usize) -> Hypothesis {
        let mut additions = from.additions.clone();
        additions.remove(index);
        self.reduced(from, additions)
    }

    /// The hypothesis with only these additions, fitted from the values it has.
    pub(super) fn refit(&self, from: &Hypothesis, additions: Vec<Addition>) -> Hypothesis {
        let reduced = self.reduced(from, additions);
        let fit = on_all(&self.data, &reduced.model, &reduced.fit);
        Hypothesis { fit, ..reduced }
    }

    /// The hypothesis with only these additions, at the values it has.
    fn reduced(&self, from: &Hypothesis, additions: Vec<Addition>) -> Hypothesis {
        let fitted = from.fitted();
        let mut model = self.data.base.clone();
        for addition in &additions {
            if let Addition::Effect(effect) = addition {
                let values = fitted.effects.iter().find(|(e, _)| e.name() == effect.name());
                model.effects.extend(values.cloned());
            }
        }
        let mut keys = self.scenario.free.clone();
        keys.extend(additions.iter().flat_map(Addition::keys));
        let mut fit = from.fit.clone();
        fit.parameters = self.data.movable(&model, &keys);
        let value = |key: &str| from.fit.parameters.iter().position(|p| p.key == key).map(|i| from.fit.values[i]);
        fit.values = fit.parameters.iter().filter_map(|p| value(&p.key)).collect();
        fit.evaluation = on_all_problem(&self.data, &model, fit.parameters.clone()).evaluate(&fit.values, true);
        fit.objective = robust_chi2(&fit.evaluation.residuals, self.data.threshold);
        Hypothesis { additions, model, fit, estimate: None, bic: f64::INFINITY }
    }

    /// Replaces every addition in turn by another that explains better beside the others.
    fn exchange(&self, chosen: Hypothesis, rounds: &mut Rounds) -> Hypothesis {
        let mut chosen = chosen;
        for _ in 0..EXCHANGES {
            let before = chosen.additions.clone();
            for index in 0..chosen.additions.len() {
                if chosen.additions.len() < 2 {
                    break;
                }
                let rest = self.without(&chosen, index);
                let round = self.round(&rest, rounds, Pace::Towards(&chosen));
                let Some(best) = self.pick(round, false) else { continue };
                let noise = self.noise(&best.found.hypothesis);
                let swapped = best.found.hypothesis;
                let Some(&new) = swapped.additions.last() else { continue };
                // The same one, too: beside the others it may have found a better minimum.
                if self.score(&swapped, noise) + MARGIN < self.score(&chosen, noise) {
                    let mut additions = chosen.additions.clone();
                    additions[index] = new;
                    chosen = Hypothesis { additions, ..swapped };
                }
            }
            if chosen.additions == before {
                break;
            }
        }
        chosen
    }

    /// For every addition of the explanation those that would explain as well in its place, itself first.
    fn ties(&self, chosen: &Hypothesis, rounds: &mut Rounds) -> Vec<Vec<Hypothesis>> {
        let noise = self.noise(chosen);
        let own = self.bic(chosen, noise);
        let mut ties = Vec::new();
        for (index, addition) in chosen.additions.iter().enumerate() {
            let rest = self.without(chosen, index);
            let round = self.round(&rest, rounds, Pace::Beside(chosen));
            let mut tied: Vec<Hypothesis> =
                round.found.iter().filter(|e| e.full).map(|e| e.found.hypothesis.clone()).collect();
            tied.retain(|h| h.additions.last() != Some(addition) && self.bic(h, noise) - own < MARGIN);
            tied.sort_by(|a, b| self.bic(a, noise).total_cmp(&self.bic(b, noise)));
            let mut own = chosen.clone();
            own.additions.remove(index);
            own.additions.push(*addition);
            tied.insert(0, own);
            ties.push(tied);
        }
        ties
    }

    /// Scatter of the residuals of a hypothesis about anything smooth, over the stated noise, where it differs from one by
    /// more than chance.
    pub(super) fn noise(&self, hypothesis: &Hypothesis) -> f64 {
        self.whiteness(hypothesis).map_or(1.0, |white| white.noise())
    }

    pub(super) fn scatter(&self, hypothesis: &Hypothesis) -> (f64, bool) {
        self.whiteness(hypothesis).map_or((1.0, false), |white| white.scatter())
    }

    /// Tests of the residuals; `None` where the fit is to a part of the points.
    fn whiteness(&self, hypothesis: &Hypothesis) -> Option<Whiteness> {
        if hypothesis.fit.evaluation.residuals.len() != self.readings() {
            return None;
        }
        let points = compare::compared(&self.table.points, &hypothesis.fit.evaluation.predictions);
        Some(compare::whiteness(
            &points,
            self.table.series.len(),
            hypothesis.fit.parameters.len(),
            self.table.amplitude_noise,
        ))
    }

    pub(super) fn readings(&self) -> usize {
        self.data.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum()
    }

    /// Schwarz's criterion with residuals in units of `noise` times their stated standard deviations.
    pub(super) fn bic(&self, hypothesis: &Hypothesis, noise: f64) -> f64 {
        self.square(hypothesis, noise) + hypothesis.fit.parameters.len() as f64 * (self.readings() as f64).ln()
    }

    /// Sum of squares of the residuals in units of `noise`, large ones counted less.
    pub(super) fn square(&self, hypothesis: &Hypothesis, noise: f64) -> f64 {
        hypothesis.estimate.map_or_else(
            || robust_chi2(&(&hypothesis.fit.evaluation.residuals / noise), HUBER),
            |estimate| estimate.square / (noise * noise),
        )
    }

    /// The criterion with a charge for having looked at many additions (extended BIC of Chen and Chen 2008).
    fn score(&self, hypothesis: &Hypothesis, noise: f64) -> f64 {
        self.bic(hypothesis, noise) + 2.0 * hypothesis.additions.len() as f64 * (self.pool.len().max(1) as f64).ln()
    }
}
