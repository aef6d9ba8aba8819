//! All additions to one hypothesis in a race: each is looked at, the promising ones are fitted, the best to all points.

use super::MARGIN;
use super::forward::Search;
use super::hypothesis::{Addition, Basis, Hypothesis, compatible};
use super::sampling::{Base, Hint, at_stated_values};
use super::search::{Attempt, Explored, Found, explore, lead, on_all, on_part};
use crate::fit::robust_chi2;
use rayon::prelude::*;

/// Fits on a part of the points begin for additions that take off, on a logarithmic scale, this share of what the best one
/// takes off in a linear estimate; ...
const BEGIN: f64 = 0.35;
/// ... and, in that estimate, come within this factor of the best one; ...
const WITHIN: f64 = 12.0;
/// ... they go on where they took off this share of what the best one did, ...
const GO_ON: f64 = 0.6;
/// ... and on to their end where this.
const END: f64 = 0.8;
/// A continuum of sliders takes long to solve: it has to be this good; beside two other additions it has to be the best.
const COSTLY: f64 = 0.9;
/// Sums of squares that differ by less than this many units a point are as good as equal.
const EQUAL: f64 = 0.2;
/// Sum of squares per reading from which on nothing explains the data.
const UNEXPLAINED: f64 = 1.25;
/// So many additions at most get a second look, those that promise most in the linear estimate.
const SEEN_AGAIN: usize = 3;
/// A fit on a part of the points is followed on all of them if its sum of squares is within this factor of the best ...
const PROMISING: f64 = 1.5;
/// (where the aim is known, within this one of it) ...
const WITHIN_REACH: f64 = 1.25;
/// ... and its gain more than this share of what it needs to be accepted.
const NEARLY: f64 = 0.5;
/// No fit begins where, in a linear estimate, the gain is less than this share of what is needed.
const HOPELESS: f64 = 0.5;
/// Fits within this of the least sum of squares are followed to their minimum, ...
pub(super) const CONTESTED: f64 = 40.0;
/// ... if it is not above this many times the number of readings (of what explains so little a unit more or less is no
/// matter), ...
const NEAR: f64 = 10.0;
/// ... by so many continuations at most, ...
const SETTLED: usize = 8;
/// ... as long as one lowers the sum of squares by more than this, times what is left of a reading where that is more than one.
const PAYS: f64 = 0.1;
/// At least so many of those to the calibrated base are followed, ...
const FOLLOWED: usize = 2;
/// ... and of those to something more at most so many, continua of sliders aside, where the best leaves more than this many
/// times the noise.
const FOLLOWED_FAR: usize = 4;
const FAR: f64 = 3.0;

/// How much is done for a round.
#[derive(Clone, Copy)]
pub(super) enum Pace<'h> {
    /// Every fit that may be needed.
    Thorough,
    /// Without a second look at what may be in a local minimum.
    Quick,
    /// The same, and what cannot come near this hypothesis is not fitted to its end.
    Towards(&'h Hypothesis),
    /// The same, of what else than this hypothesis.
    Beside(&'h Hypothesis),
}

/// All additions to one hypothesis, fitted.
pub(super) struct Round {
    pub found: Vec<Entry>,
    /// The looks and the fits to a part of the points behind them, the same order, and whether everything was done for them.
    explored: Vec<Explored>,
    attempts: Vec<Option<Attempt>>,
    thorough: bool,
}

/// An addition that was fitted.
#[derive(Clone)]
pub(super) struct Entry {
    pub found: Found,
    /// Whether the fit is to all points, not only to a part of them.
    pub full: bool,
}

/// Rounds made so far, by the additions that they started from; the first is from the calibrated base.
#[derive(Default)]
pub(super) struct Rounds {
    made: Vec<(Hypothesis, Round)>,
}

impl Rounds {
    /// Forgets the rounds from more than these additions: they are fitted anew.
    pub fn forget_beyond(&mut self, hypothesis: &Hypothesis) {
        self.made.retain(|(from, _)| from.same_additions(hypothesis) || !hypothesis.within(from));
    }

    /// Forgets the rounds from these additions and from more than these: they are fitted anew.
    pub fn forget(&mut self, hypothesis: &Hypothesis) {
        self.made.retain(|(from, _)| from.additions.is_empty() || !hypothesis.within(from));
    }

    /// The hypotheses of the first round for which a fit was at least begun.
    fn begun(&self) -> impl Iterator<Item = &Hypothesis> {
        let found = self.made.first().map_or(&[][..], |(_, round)| &round.found);
        found.iter().map(|entry| &entry.found.hypothesis).filter(|h| h.basis() != Basis::Linear)
    }

    /// The rounds in the order in which they were made.
    pub fn all(&self) -> impl Iterator<Item = &Round> {
        self.made.iter().map(|(_, round)| round)
    }
}

impl Search<'_> {
    /// The hypotheses of the first round for which a fit was at least begun, the best first.
    pub(super) fn first_additions(&self, rounds: &Rounds) -> Vec<Hypothesis> {
        let mut all: Vec<Hypothesis> = rounds.begun().cloned().collect();
        all.sort_by(|a, b| self.square(a, 1.0).total_cmp(&self.square(b, 1.0)));
        all
    }

    /// All additions that go with a hypothesis; as they were found where there is a round already, which is gone on with
    /// where more is wanted than was done.
    pub(super) fn round<'r>(&self, from: &Hypothesis, rounds: &'r mut Rounds, pace: Pace<'_>) -> &'r Round {
        let known = rounds.made.iter().position(|(other, _)| other.same_additions(from));
        let index = known.unwrap_or_else(|| {
            let round = self.race(from, rounds.made.first().map(|(_, round)| round), pace);
            rounds.made.push((from.clone(), round));
            rounds.made.len() - 1
        });
        if matches!(pace, Pace::Thorough) && !rounds.made[index].1.thorough {
            let (from, Round { explored, attempts, .. }) = rounds.made.remove(index);
            let round = self.looked_again(&from, explored, attempts);
            rounds.made.insert(index, (from, round));
        }
        &rounds.made[index].1
    }

    fn race(&self, from: &Hypothesis, first: Option<&Round>, pace: Pace<'_>) -> Round {
        let data = &self.data;
        let goal = match pace {
            Pace::Towards(goal) | Pace::Beside(goal) => Some(goal),
            Pace::Thorough | Pace::Quick => None,
        };
        let known = |a: &Addition| matches!(pace, Pace::Beside(goal) if goal.additions.contains(a));
        let with = |addition: &Addition| from.additions.iter().copied().chain([*addition]).collect::<Vec<_>>();
        let fitting: Vec<Addition> = self
            .pool
            .iter()
            .copied()
            .filter(|a| !from.additions.contains(a) && !known(a) && compatible(&self.data.base, &with(a)))
            .collect();
        let base = Base::new(data, from);
        let beside_noise = !self.structured(from);
        let elsewhere = from.additions.is_empty() || !beside_noise;
        let stated = if elsewhere { at_stated_values(data, from) } else { None };
        let explored: Vec<Explored> = fitting
            .par_iter()
            .map(|&addition| {
                let hint = first.and_then(|round| round.hint(addition));
                explore(data, from, &base, stated.as_ref(), addition, hint.as_ref(), beside_noise)
            })
            .collect();
        let goal_on_part = goal.map_or(f64::INFINITY, |goal| {
            let mut problem = on_part(data, &goal.model, goal.fit.parameters.clone());
            robust_chi2(&problem.evaluate(&goal.fit.values, false).residuals, data.threshold)
        });
        let mut attempts: Vec<Option<Attempt>> = explored.iter().map(|_| None).collect();
        let estimates: Vec<f64> = explored.iter().map(|e| e.after.max(f64::MIN_POSITIVE)).collect();
        let possible = estimates.iter().copied().fold(f64::INFINITY, f64::min);
        let promising = self.leading(from, &explored, &estimates, goal_on_part, BEGIN);
        let first = explored.iter().zip(promising).map(|(e, leads)| leads && e.after < WITHIN * possible).collect();
        self.begin(from, &explored, first, goal_on_part, &mut attempts);
        if matches!(pace, Pace::Thorough) {
            return self.looked_again(from, explored, attempts);
        }
        self.followed(from, explored, attempts, goal.map(|goal| (goal_on_part, goal)))
    }

    /// Who is left of the race at a stage, given the sums of squares that were `reached` and the one to beat.
    fn leading(&self, from: &Hypothesis, explored: &[Explored], reached: &[f64], goal: f64, share: f64) -> Vec<bool> {
        let best = reached.iter().copied().fold(goal, f64::min);
        let leads = |(e, &reached): (&Explored, &f64)| {
            let share = if e.costly { COSTLY } else { share };
            let equal = reached < best + EQUAL * self.data.part.len() as f64;
            let gains = e.gain(reached) > if e.costly { 1.0 } else { NEARLY };
            if e.costly && from.additions.len() > 1 {
                return gains && reached <= best;
            }
            gains && (equal || (e.before / reached).ln() > share * (e.before / best).ln())
        };
        explored.iter().zip(reached).map(leads).collect()
    }

    /// Begins the fits of those that are to begin, and takes the leading ones of them on.
    fn begin(
        &self,
        from: &Hypothesis,
        explored: &[Explored],
        begins: Vec<bool>,
        goal: f64,
        attempts: &mut [Option<Attempt>],
    ) {
        let data = &self.data;
        let begun = explored
            .par_iter()
            .zip(&begins)
            .map(|(e, &begins)| if begins && e.gain(e.after) > HOPELESS { e.begin(data, from) } else { Vec::new() });
        let begun: Vec<Vec<Attempt>> = begun.collect();
        for (best, begun) in attempts.iter_mut().zip(&begun).filter(|(_, begun)| !begun.is_empty()) {
            *best = begun.first().cloned();
        }
        let goes_on = self.leading(from, explored, &reached(attempts), goal, GO_ON);
        attempts
            .par_iter_mut()
            .zip(begun)
            .zip(goes_on)
            .filter(|((_, begun), on)| *on && !begun.is_empty())
            .for_each(|((best, begun), _)| *best = lead(data, begun));
        let ends = self.leading(from, explored, &reached(attempts), goal, END);
        attempts
            .par_iter_mut()
            .zip(begins)
            .zip(ends)
            .filter(|((_, begins), ends)| *begins && *ends)
            .for_each(|((best, _), _)| *best = best.take().map(|attempt| attempt.finished(data)));
    }

    /// A round in which everything is done that may be needed where nothing explains the data.
    fn looked_again(&self, from: &Hypothesis, explored: Vec<Explored>, mut attempts: Vec<Option<Attempt>>) -> Round {
        let data = &self.data;
        let readings = data.part_readings() as f64;
        // Beside two other additions a longer search takes too long.
        let thorough = from.additions.len() < 2;
        let least = |attempts: &[Option<Attempt>]| reached(attempts).into_iter().fold(f64::INFINITY, f64::min);
        let unexplained = |attempts: &[Option<Attempt>]| thorough && least(attempts) > UNEXPLAINED * readings;
        // Where nothing explains the data, the linear estimate may have left out what would, if it is not much that is left, ...
        let nearly = least(&attempts) < NEAR * self.noise(from).powi(2) * readings;
        if unexplained(&attempts) && nearly {
            let left_out = explored.iter().zip(&attempts).map(|(e, best)| best.is_none() && !e.costly).collect();
            self.begin(from, &explored, left_out, f64::INFINITY, &mut attempts);
        }
        // ... or the leading ones may be in local minima. So may one that, in the linear estimate, promises what the best reached.
        let (nothing_explains, reached) = (unexplained(&attempts), reached(&attempts));
        let ends = self.leading(from, &explored, &reached, f64::INFINITY, END);
        let equal = reached.iter().copied().fold(f64::INFINITY, f64::min) + EQUAL * data.part.len() as f64;
        let mut again: Vec<usize> = (0..explored.len()).collect();
        again.retain(|&index| {
            let promises = explored[index].after < equal && reached[index] > equal;
            explored[index].is_seen_again() && ((nothing_explains && ends[index]) || (thorough && promises))
        });
        again.sort_by(|&i, &j| explored[i].after.total_cmp(&explored[j].after));
        again.truncate(SEEN_AGAIN);
        let begun = attempts.par_iter_mut().zip(&explored).enumerate();
        begun.filter(|(index, _)| again.contains(index)).for_each(|(_, (best, e))| {
            *best = best.take().map(|attempt| e.second_look(data, from, attempt));
        });
        Round { thorough: true, ..self.followed(from, explored, attempts, None) }
    }

    /// The leading ones followed on all points; only what comes near the `goal`, given with its sum of squares on the part.
    fn followed(
        &self,
        from: &Hypothesis,
        explored: Vec<Explored>,
        attempts: Vec<Option<Attempt>>,
        goal: Option<(f64, &Hypothesis)>,
    ) -> Round {
        let found = explored.par_iter().zip(&attempts).map(|(e, best)| e.found(&self.data, from, best.clone()));
        let found: Vec<Found> = found.collect();
        let at_least = if from.additions.is_empty() { FOLLOWED } else { 0 };
        let scale = self.data.points.len() as f64 / self.data.part.len() as f64;
        let objective = |f: &Found| f.hypothesis.fit.objective;
        let gaining = |f: &&Found| f.gain > 0.0;
        let least = found.iter().filter(gaining).map(objective).fold(f64::INFINITY, f64::min);
        let criterion =
            |f: &Found| scale * objective(f) + f.hypothesis.fit.parameters.len() as f64 * (self.readings() as f64).ln();
        let near = match goal {
            Some((on_part, _)) => WITHIN_REACH * on_part.min(least),
            None => PROMISING * least,
        };
        let near = near + EQUAL * self.data.part.len() as f64;
        // A costly one is brought to its end only if it would be accepted.
        let promising =
            |(f, e): (&Found, &Explored)| f.gain > if e.costly { 1.0 } else { NEARLY } && objective(f) < near;
        let mut full: Vec<bool> = found.iter().zip(&explored).map(promising).collect();
        let mut order: Vec<usize> = (0..found.len()).filter(|&i| gaining(&&found[i]) && !explored[i].costly).collect();
        order.sort_by(|&i, &j| criterion(&found[i]).total_cmp(&criterion(&found[j])));
        order.iter().take(at_least).for_each(|&i| full[i] = true);
        let far = goal.is_none() && least > FAR * self.noise(from).powi(2) * self.data.part_readings() as f64;
        if far && !from.additions.is_empty() {
            order.iter().skip(FOLLOWED_FAR).for_each(|&i| full[i] = false);
        }
        let entry = |(mut found, full): (Found, bool)| {
            if full {
                found.hypothesis.estimate = None;
                found.hypothesis.fit = on_all(&self.data, &found.hypothesis.model, &found.hypothesis.fit);
            }
            Entry { found, full }
        };
        let mut found: Vec<Entry> = found.into_par_iter().zip(full).map(entry).collect();
        let objective = |e: &Entry| e.found.hypothesis.fit.objective;
        let full = |e: &&Entry| e.full;
        let least = goal.map_or(f64::INFINITY, |(_, goal)| goal.fit.objective);
        let least = found.iter().filter(full).map(objective).fold(least, f64::min);
        let noises = found.iter().filter(full).map(|e| self.noise(&e.found.hypothesis));
        let noise = noises.fold(1.0, f64::max);
        let least = least.min(NEAR * noise.powi(2) * self.readings() as f64);
        let close = |e: &&mut Entry| e.full && objective(e) <= least + CONTESTED;
        // What at the pace of its last continuation does not come level with the best any more is left where it is.
        let all = found.iter().filter(full).map(|e| &e.found.hypothesis).chain(goal.map(|(_, goal)| goal));
        let best = all.min_by(|a, b| a.fit.objective.total_cmp(&b.fit.objective));
        let (noise, aim) = best.map_or((1.0, f64::INFINITY), |best| {
            let noise = self.noise(best);
            (noise, self.bic(best, noise) + MARGIN)
        });
        let level = |h: &Hypothesis, gain: f64| self.bic(h, noise) - gain / noise.powi(2) < aim;
        found.par_iter_mut().filter(close).for_each(|e| self.settle_while(&mut e.found.hypothesis, level));
        Round { found, explored, attempts, thorough: false }
    }

    /// Follows a fit that ended for want of evaluations, in a curved valley say, to its minimum.
    pub(super) fn settle(&self, hypothesis: &mut Hypothesis) {
        self.settle_while(hypothesis, |_, _| true);
    }

    /// The same while that may matter, given the hypothesis and what the continuations that are left would gain in its sum of
    /// squares, each as much as the last.
    fn settle_while(&self, hypothesis: &mut Hypothesis, matters: impl Fn(&Hypothesis, f64) -> bool) {
        for left in (0..SETTLED).rev() {
            if !hypothesis.fit.is_exhausted() {
                break;
            }
            let fit = on_all(&self.data, &hypothesis.model, &hypothesis.fit);
            let gain = hypothesis.fit.objective - fit.objective;
            if gain > 0.0 {
                hypothesis.fit = fit;
            }
            let left_over = (hypothesis.fit.objective / self.readings() as f64).max(1.0);
            if gain < PAYS * left_over || !matters(hypothesis, left as f64 * gain) {
                break;
            }
        }
    }
}

/// Sums of squares over the part of the points.
fn reached(attempts: &[Option<Attempt>]) -> Vec<f64> {
    attempts.iter().map(|a| a.as_ref().map_or(f64::INFINITY, |a| a.fit.objective)).collect()
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
