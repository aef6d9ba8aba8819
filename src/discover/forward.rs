//! Forward selection with backward elimination and exchange, from the calibrated base to the explanation.

use super::hypothesis::{Addition, Hypothesis, additions, compatible, count, extended};
use super::search::{Base, Data, Explored, Found, Hint, explore, movable, on_all};
use super::{Candidate, Discovery, MARGIN, Noise, NotTestable, Options, Step, Verdict, held_out, next};
use crate::compare::{self, Calibration, Comparison, conditions_of};
use crate::fit::{HUBER, Interval, approximate_intervals, robust_chi2};
use crate::measurement::Table;
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use rayon::prelude::*;

/// A fit on a part of the points is followed on all of them if its sum of squares is within this factor of the best.
const PROMISING: f64 = 1.6;
/// ... and its gain more than this share of what it needs to be accepted.
const NEARLY: f64 = 0.4;
/// After few steps a fit is pursued if its sum of squares is within this factor of the best.
const CONTENDING: f64 = 3.0;
/// An addition that leaves more than this share of the misfit explains little.
const MINOR: f64 = 0.85;
/// A costly addition is followed unless another leaves less than this share of what it may leave.
const RIVALLING: f64 = 0.7;
/// At least so many are followed.
const FOLLOWED: usize = 2;
/// Rivals of the explanation whose prediction of left-out conditions is computed.
const RIVALS: usize = 3;
/// The stated noise is contradicted by a scatter that differs by more than this factor.
const NOISE_DIFFERS: f64 = 1.25;

/// Finds what is missing in the model of a scenario, given its measurements.
pub fn discover(scenario: &Scenario, table: &Table, options: &Options) -> Discovery {
    let base = Model::new(scenario);
    let calibration = compare::calibrate(&base, &scenario.free, &table.points, Tolerance::default(), options.seed);
    let (_, of_condition) = conditions_of(&table.points);
    let stated = compare::problem(&base, &scenario.free, [], Tolerance::default()).values();
    let data = Data::new(&table.points, &of_condition, calibration.threshold, stated, options.seed);
    let search = Search { scenario, table, options, base, data };
    search.run(calibration)
}

struct Search<'a> {
    scenario: &'a Scenario,
    table: &'a Table,
    options: &'a Options,
    /// The model of the scenario, not calibrated.
    base: Model,
    data: Data<'a>,
}

/// All additions to one hypothesis, fitted.
struct Round {
    found: Vec<Entry>,
}

/// An addition that was fitted.
#[derive(Clone)]
struct Entry {
    found: Found,
    /// Whether the fit is to all points, not only to a part of them.
    full: bool,
    /// Its sum of squares over all points (scaled up from a part).
    objective: f64,
}

impl Search<'_> {
    fn run(&self, calibration: Calibration) -> Discovery {
        let start = Hypothesis {
            additions: Vec::new(),
            model: self.base.clone(),
            fit: calibration.fit.clone(),
            estimate: None,
            bic: f64::INFINITY,
        };
        let pool = additions(&self.base, &self.scenario.free, self.table.points.iter().any(|p| p.phase.is_some()));
        let many = pool.len();
        let mut chosen = start.clone();
        let mut rounds: Vec<Round> = Vec::new();
        let mut ties: Vec<(usize, Vec<Entry>)> = Vec::new();
        while chosen.additions.iter().filter(|a| a.is_effect()).count() < self.options.max_effects
            && chosen.additions.len() <= self.options.max_effects
        {
            let round = self.round(&chosen, &pool, rounds.first());
            let Some(best) = self.pick(&round, rounds.is_empty()) else { break };
            let best_hypothesis = best.found.hypothesis.clone();
            let noise = self.noise(&best_hypothesis);
            let better = self.score(&chosen, many, noise) - self.score(&best_hypothesis, many, noise);
            let accepted = better > MARGIN;
            if accepted {
                ties.push((chosen.additions.len(), self.tied(&round, &best, noise)));
                chosen = best_hypothesis;
                chosen = self.eliminate(chosen, many, &mut ties);
            }
            rounds.push(round);
            if !accepted {
                break;
            }
        }
        if chosen.additions.len() > 1 {
            chosen = self.exchange(chosen, &pool, &rounds, many, &mut ties);
        }
        self.conclude(&start, &chosen, &rounds, &ties)
    }

    /// All additions that go with a hypothesis, each fitted to a part of the points, the promising ones to all.
    fn round(&self, from: &Hypothesis, pool: &[Addition], first: Option<&Round>) -> Round {
        let fitting: Vec<Addition> = pool
            .iter()
            .copied()
            .filter(|a| !from.additions.contains(a) && compatible(&self.base, &with(&from.additions, *a)))
            .collect();
        let base = Base::new(&self.data, from);
        let explored: Vec<Explored> = fitting
            .par_iter()
            .map(|&addition| {
                let hint = first.and_then(|round| round.hint(addition));
                explore(&self.data, from, &base, addition, hint.as_ref())
            })
            .collect();
        // Those that explain little of much misfit, and those that are costly, wait until it is known what others explain.
        let much = 10.0 * self.data.part.len() as f64;
        let waits = |e: &Explored| e.promises() && (e.costly || e.after > MINOR * e.before && e.before > much);
        let mut followed: Vec<Option<Found>> =
            explored.par_iter().map(|e| (!waits(e)).then(|| e.follow(&self.data, from, !e.promises()))).collect();
        // A costly one is brought to its end only if it would be accepted.
        let enough = |e: &Explored| if e.costly { 1.0 } else { NEARLY };
        let objective = |f: &Found| f.hypothesis.fit.objective;
        let least = followed.iter().flatten().map(objective).fold(f64::INFINITY, f64::min);
        let found: Vec<Found> = explored
            .par_iter()
            .zip(&mut followed)
            .map(|(e, found)| {
                let vain = least < if e.costly { RIVALLING * e.after } else { (1.0 - MINOR) * e.before };
                let mut found = found.take().unwrap_or_else(|| e.follow(&self.data, from, vain));
                if found.gain > enough(e) && objective(&found) < CONTENDING * least + 0.1 * self.data.part.len() as f64
                {
                    e.pursue(&self.data, from, &mut found);
                }
                found
            })
            .collect();
        let scale = self.data.points.len() as f64 / self.data.part.len() as f64;
        let least = found.iter().map(|f| f.hypothesis.fit.objective).fold(f64::INFINITY, f64::min);
        let criterion = |f: &Found| {
            scale * f.hypothesis.fit.objective
                + f.hypothesis.fit.parameters.len() as f64 * (self.readings() as f64).ln()
        };
        let mut order: Vec<usize> = (0..found.len()).collect();
        order.sort_by(|&i, &j| criterion(&found[i]).total_cmp(&criterion(&found[j])));
        let readings = self.data.part.len() as f64;
        let promising = |(f, e): (&Found, &Explored)| {
            f.gain > enough(e) && f.hypothesis.fit.objective < PROMISING * least + 0.1 * readings
        };
        let mut full: Vec<bool> = found.iter().zip(&explored).map(promising).collect();
        let cheap = |i: &&usize| found[**i].gain > 0.0 && !explored[**i].costly;
        order.iter().filter(cheap).take(FOLLOWED).for_each(|&i| full[i] = true);
        let found = found
            .into_par_iter()
            .zip(full)
            .map(|(mut found, full)| {
                let mut objective = found.hypothesis.estimate.unwrap_or(f64::INFINITY);
                if full {
                    found.hypothesis.estimate = None;
                    found.hypothesis.fit = on_all(&self.data, &found.hypothesis.model, &found.hypothesis.fit);
                    objective = found.hypothesis.fit.objective;
                }
                Entry { found, full, objective }
            })
            .collect();
        Round { found }
    }

    /// The best addition. Of those that the data do not tell apart the simpler: at first a recalibration; once something is
    /// known to be missing, an effect.
    fn pick(&self, round: &Round, first: bool) -> Option<Entry> {
        let full: Vec<&Entry> = round.found.iter().filter(|e| e.full).collect();
        let noise = self.noise(&full.iter().min_by(|a, b| a.objective.total_cmp(&b.objective))?.found.hypothesis);
        let bic = |entry: &Entry| self.bic(&entry.found.hypothesis, noise);
        let best = full.iter().map(|e| bic(e)).fold(f64::INFINITY, f64::min);
        let preferred = |entry: &Entry| entry.found.hypothesis.additions.last().is_some_and(|a| a.is_effect() != first);
        let close: Vec<&&Entry> = full.iter().filter(|e| bic(e) - best < MARGIN).collect();
        let simple = close.iter().filter(|e| preferred(e)).min_by(|a, b| bic(a).total_cmp(&bic(b)));
        simple.or(close.iter().min_by(|a, b| bic(a).total_cmp(&bic(b)))).map(|e| (**e).clone())
    }

    /// Additions that explain as well as the one chosen.
    fn tied(&self, round: &Round, best: &Entry, noise: f64) -> Vec<Entry> {
        let chosen = self.bic(&best.found.hypothesis, noise);
        let close = |e: &&Entry| e.full && (self.bic(&e.found.hypothesis, noise) - chosen) < MARGIN;
        let mut tied: Vec<Entry> = round.found.iter().filter(close).cloned().collect();
        tied.sort_by(|a, b| self.bic(&a.found.hypothesis, noise).total_cmp(&self.bic(&b.found.hypothesis, noise)));
        tied
    }

    /// Removes additions that the others make needless; the last may merely have helped an earlier one out of a local minimum.
    fn eliminate(&self, chosen: Hypothesis, many: usize, ties: &mut Vec<(usize, Vec<Entry>)>) -> Hypothesis {
        let mut chosen = chosen;
        let mut index = 0;
        while chosen.additions.len() > 1 && index < chosen.additions.len() {
            let fewer = self.refit_without(&chosen, index);
            let noise = self.noise(&chosen);
            if self.score(&fewer, many, noise) < self.score(&chosen, many, noise) + MARGIN {
                chosen = fewer;
                ties.clear();
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

    /// The hypothesis with only these additions, fitted from the values it has.
    fn refit(&self, from: &Hypothesis, additions: Vec<Addition>) -> Hypothesis {
        let fitted = from.fitted();
        let mut model = self.base.clone();
        for addition in &additions {
            if let Addition::Effect(effect) = addition {
                let values = fitted.effects.iter().find(|(e, _)| e.name() == effect.name());
                model.effects.extend(values.cloned());
            }
        }
        let mut keys = self.scenario.free.clone();
        keys.extend(additions.iter().flat_map(Addition::keys));
        let mut fit = from.fit.clone();
        fit.parameters = movable(&model, &keys);
        let value = |key: &str| from.fit.parameters.iter().position(|p| p.key == key).map(|i| from.fit.values[i]);
        fit.values = fit.parameters.iter().filter_map(|p| value(&p.key)).collect();
        let fit = on_all(&self.data, &model, &fit);
        Hypothesis { additions, model, fit, estimate: None, bic: f64::INFINITY }
    }

    /// Tries every earlier addition's replacement by another that is about as good; notes those that are as good.
    fn exchange(
        &self,
        chosen: Hypothesis,
        pool: &[Addition],
        rounds: &[Round],
        many: usize,
        ties: &mut Vec<(usize, Vec<Entry>)>,
    ) -> Hypothesis {
        let mut chosen = chosen;
        for index in 0..chosen.additions.len() - 1 {
            let rest = self.refit_without(&chosen, index);
            let round = self.round(&rest, pool, rounds.first());
            let Some(best) = self.pick(&round, false) else { continue };
            let noise = self.noise(&best.found.hypothesis);
            let swapped = best.found.hypothesis.clone();
            let differs = swapped.additions.last() != Some(&chosen.additions[index]);
            ties.retain(|(place, _)| *place != index);
            if differs && self.score(&swapped, many, noise) + MARGIN < self.score(&chosen, many, noise) {
                let mut additions = chosen.additions.clone();
                additions[index] = *swapped.additions.last().unwrap_or(&additions[index]);
                chosen = Hypothesis { additions, ..swapped };
            }
            ties.push((index, self.tied(&round, &best, noise)));
        }
        chosen
    }

    /// Scatter of the residuals of a hypothesis about anything smooth, over the stated noise, where it differs from one by
    /// more than chance.
    fn noise(&self, hypothesis: &Hypothesis) -> f64 {
        let (factor, contradicted) = self.scatter(hypothesis);
        if contradicted { factor } else { 1.0 }
    }

    fn scatter(&self, hypothesis: &Hypothesis) -> (f64, bool) {
        let residuals = &hypothesis.fit.evaluation.residuals;
        if residuals.len() != self.readings() {
            return (1.0, false);
        }
        let points = compare::compared(&self.table.points, &hypothesis.fit.evaluation.predictions);
        let (settings, _) = conditions_of(&self.table.points);
        let white = compare::whiteness(&points, settings.len(), hypothesis.fit.parameters.len());
        let factor = white.rough_chi2.sqrt();
        let sure = (factor.ln()).abs() > 4.0 / (2.0 * white.rough_freedom.max(1.0)).sqrt();
        (factor, sure && !(1.0 / NOISE_DIFFERS..NOISE_DIFFERS).contains(&factor))
    }

    fn readings(&self) -> usize {
        self.data.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum()
    }

    /// Schwarz's criterion with residuals in units of `noise` times their stated standard deviations.
    fn bic(&self, hypothesis: &Hypothesis, noise: f64) -> f64 {
        let square = hypothesis.estimate.map_or_else(
            || robust_chi2(&(&hypothesis.fit.evaluation.residuals / noise), HUBER),
            |estimate| estimate / (noise * noise),
        );
        square + hypothesis.fit.parameters.len() as f64 * (self.readings() as f64).ln()
    }

    /// The criterion with a charge for having looked at many additions (extended BIC of Chen and Chen 2008).
    fn score(&self, hypothesis: &Hypothesis, many: usize, noise: f64) -> f64 {
        self.bic(hypothesis, noise) + 2.0 * hypothesis.additions.len() as f64 * (many.max(1) as f64).ln()
    }

    fn conclude(
        &self,
        start: &Hypothesis,
        chosen: &Hypothesis,
        rounds: &[Round],
        ties: &[(usize, Vec<Entry>)],
    ) -> Discovery {
        let (factor, contradicted) = self.scatter(chosen);
        let noise = if contradicted { factor } else { 1.0 };
        // The ladder, one addition after the other.
        let mut ladder = vec![start.clone()];
        for length in 1..chosen.additions.len() {
            ladder.push(self.refit(chosen, chosen.additions[..length].to_vec()));
        }
        if !chosen.additions.is_empty() {
            ladder.push(chosen.clone());
        }
        let last = ladder.len() - 1;
        let steps: Vec<Step> = ladder
            .into_par_iter()
            .enumerate()
            .map(|(i, hypothesis)| Step {
                added: i.checked_sub(1).map(|k| hypothesis.additions[k].name().to_string()),
                comparison: self.comparison(&hypothesis, i == last, noise),
                held_out: held_out(&self.data, &hypothesis),
                hypothesis,
            })
            .collect();
        let candidates = self.rank(&steps, rounds, ties, noise);
        let end = &steps[last];
        let structured = end.comparison.whiteness.structured;
        let verdict = match (structured, chosen.additions.iter().any(Addition::is_effect), chosen.additions.is_empty())
        {
            (true, _, _) => Verdict::Unexplained,
            (false, _, true) => Verdict::NothingMissing,
            (false, true, false) => Verdict::EffectMissing,
            (false, false, false) => Verdict::Recalibrate,
        };
        let mut indistinguishable: Vec<Vec<String>> = Vec::new();
        let mut rivals: Vec<Hypothesis> = Vec::new();
        for (_, tied) in ties {
            let names: Vec<String> =
                tied.iter().filter_map(|e| e.found.hypothesis.additions.last().map(|a| a.name().to_string())).collect();
            if names.len() > 1 {
                rivals.extend(tied.iter().map(|e| e.found.hypothesis.clone()));
                indistinguishable.push(names);
            }
        }
        let outliers = end.comparison.outliers.clone();
        let not_testable = self.not_testable(&candidates, rounds);
        let next_measurement = self.next(chosen, &rivals, &candidates, noise);
        let correlations = end.comparison.correlations.clone();
        let evaluations = rounds.iter().flat_map(|r| &r.found).map(|e| e.found.hypothesis.fit.evaluations).sum();
        let mut notes = Vec::new();
        if contradicted {
            notes.push(format!(
                "the readings scatter {factor:.2} times as much as their stated standard deviations; all tests and intervals use the scatter"
            ));
        }
        if let Some(best) = candidates.first().filter(|c| c.hypothesis.label() != end.hypothesis.label()) {
            let above =
                candidates.iter().find(|c| c.hypothesis.label() == end.hypothesis.label()).map_or(0.0, |c| c.delta_bic);
            notes.push(format!(
                "{} would be better by {above:.1} in Schwarz's criterion, too little to decide for it among as many candidates",
                best.hypothesis.label()
            ));
        }
        let troubled = end.hypothesis.fit.evaluation.troubled();
        if troubled > 0 {
            notes.push(format!("{troubled} points have no steady state in the explanation; each counts as a misfit of 2 to 6 standard deviations"));
        }
        Discovery {
            verdict,
            candidates,
            indistinguishable,
            not_testable,
            outliers,
            next_measurement,
            noise: Noise { factor, contradicted },
            correlations,
            notes,
            evaluations,
            steps,
        }
    }

    fn comparison(&self, hypothesis: &Hypothesis, profile: bool, noise: f64) -> Comparison {
        let calibration = Calibration { fit: hypothesis.fit.clone(), threshold: HUBER * noise };
        compare::judge(self.scenario, self.table, &hypothesis.model, &calibration, profile)
    }

    /// All hypotheses of the first round and those about the explanation, the best first.
    fn rank(&self, steps: &[Step], rounds: &[Round], ties: &[(usize, Vec<Entry>)], noise: f64) -> Vec<Candidate> {
        let mut all: Vec<(Hypothesis, bool)> = Vec::new();
        let mut add = |hypothesis: &Hypothesis, testable: bool| {
            let mut names: Vec<_> = hypothesis.additions.iter().map(Addition::name).collect();
            names.sort_unstable();
            let same = |other: &Hypothesis| {
                let mut others: Vec<_> = other.additions.iter().map(Addition::name).collect();
                others.sort_unstable();
                others == names
            };
            if !all.iter().any(|(known, _)| same(known)) {
                all.push((hypothesis.clone(), testable));
            }
        };
        for step in steps {
            add(&step.hypothesis, true);
        }
        for (_, tied) in ties {
            tied.iter().for_each(|e| add(&e.found.hypothesis, true));
        }
        for (number, round) in rounds.iter().enumerate() {
            for entry in round.found.iter().filter(|e| number == 0 || e.full) {
                let testable = self.testable(entry);
                add(&entry.found.hypothesis, testable);
            }
        }
        for (hypothesis, _) in &mut all {
            hypothesis.bic = self.bic(hypothesis, noise);
        }
        all.sort_by(|a, b| a.0.bic.total_cmp(&b.0.bic).then_with(|| a.0.label().cmp(&b.0.label())));
        let best = all.first().map_or(0.0, |(h, _)| h.bic);
        let total: f64 = all.iter().map(|(h, _)| (-0.5 * (h.bic - best)).exp()).sum();
        all.into_iter()
            .enumerate()
            .map(|(rank, (hypothesis, testable))| {
                let step = steps.iter().find(|s| s.hypothesis.additions == hypothesis.additions);
                let intervals: Vec<Interval> = match step {
                    Some(step) => step.comparison.intervals.clone(),
                    None => approximate_intervals(&hypothesis.fit, noise),
                };
                let chi2 = hypothesis.estimate.unwrap_or_else(|| hypothesis.fit.evaluation.chi2());
                Candidate {
                    delta_bic: hypothesis.bic - best,
                    weight: (-0.5 * (hypothesis.bic - best)).exp() / total,
                    testable,
                    chi2_per_point: chi2 / self.readings() as f64,
                    intervals,
                    held_out: match step {
                        Some(step) => step.held_out,
                        None if rank < RIVALS => held_out(&self.data, &hypothesis),
                        None => None,
                    },
                    hypothesis,
                }
            })
            .collect()
    }

    /// Whether the strongest plausible form of an addition would be found.
    fn testable(&self, entry: &Entry) -> bool {
        let hypothesis = &entry.found.hypothesis;
        let Some(addition) = hypothesis.additions.last() else { return true };
        let parameters = count(&extended(&self.base, &[*addition]), &addition.keys()) as f64;
        entry.found.visibility > parameters * (self.readings() as f64).ln() + MARGIN
    }

    fn not_testable(&self, candidates: &[Candidate], rounds: &[Round]) -> Vec<NotTestable> {
        let Some(first) = rounds.first() else { return Vec::new() };
        let named = |entry: &&Entry| entry.found.hypothesis.additions.first().is_some_and(Addition::is_effect);
        let mut list = Vec::new();
        for entry in first.found.iter().filter(named).filter(|e| !self.testable(e)) {
            let Some(addition) = entry.found.hypothesis.additions.first() else { continue };
            let base = candidates.iter().find(|c| c.hypothesis.additions.is_empty());
            let would_show = match (base, &entry.found.strongest) {
                (Some(base), Some(strongest)) => {
                    next::would_show(&base.hypothesis.fitted(), strongest, self.table, &self.options.bounds)
                }
                _ => String::new(),
            };
            list.push(NotTestable {
                effect: addition.name().into(),
                largest_sigma: entry.found.visibility.sqrt(),
                would_show,
            });
        }
        list
    }

    fn next(
        &self,
        chosen: &Hypothesis,
        rivals: &[Hypothesis],
        candidates: &[Candidate],
        noise: f64,
    ) -> Option<next::NextMeasurement> {
        let mut survivors: Vec<&Hypothesis> = rivals.iter().collect();
        if survivors.len() < 2 {
            // The explanation and its closest rival with as many additions; calibration alone has one only where the data
            // favour it, if too little to decide.
            let rival = candidates.iter().map(|c| &c.hypothesis).find(|h| {
                if chosen.additions.is_empty() && h.bic >= self.bic(chosen, noise) {
                    return false;
                }
                h.additions != chosen.additions
                    && h.additions.len() == chosen.additions.len().max(1)
                    && h.estimate.is_none()
            })?;
            survivors = vec![chosen, rival];
        }
        next::next(&survivors, self.table, &self.options.bounds, noise)
    }
}

impl Round {
    /// What is known of an addition from this round.
    fn hint(&self, addition: Addition) -> Option<Hint> {
        let entry = self.found.iter().find(|e| e.found.hypothesis.additions.last() == Some(&addition))?;
        let fit = &entry.found.hypothesis.fit;
        let value = |key: &String| Some(fit.values[fit.parameters.iter().position(|p| p.key == *key)?]);
        let values = addition.keys().iter().map(value).collect::<Option<_>>()?;
        Some(Hint { values, touched: entry.found.touched.clone() })
    }
}

fn with(additions: &[Addition], one: Addition) -> Vec<Addition> {
    let mut all = additions.to_vec();
    all.push(one);
    all
}
