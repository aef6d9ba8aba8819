//! What the rounds of a search say together: verdict, ladder, ranking, rivals, and what remains open.

use super::each_series::is_told_within;
use super::hypothesis::{Addition, Basis, Estimate, Hypothesis, count, extended, not_searched};
use super::known::{Entry, Known};
use super::notes::{of_both_ways, of_gain_alone, of_named, of_what_is_left};
use super::select::{CONTINUED, Search};
use super::testimony::{beyond_prediction, beyond_testimony};
use super::unnamed::{OF_AMPLITUDE, is_drift_a_law_of_the_amplitude};
use super::{Candidate, Discovery, Evidence, MARGIN, NotTestable, Step, Verdict, fall, held_out, next, verdict};
use crate::compare::{self, Calibration, Comparison};
use crate::fit::{Interval, TAIL, approximate_intervals, operation};
use crate::measurement::{Noise, curves, shows_anything};
use crate::model::Model;
use crate::model::alone::Alone;
use rayon::prelude::*;
use std::sync::OnceLock;

/// A sum of squares that is larger by this than that of a smaller hypothesis shows a fit that did not come to its end.
const WORSE: f64 = 1.0;
/// Shares of its strength at which an addition begins that from there on has come to a worse end than without it.
const WEAK: [f64; 2] = [1.0 / 64.0, 1.0 / 8.0];
/// Rivals of the explanation whose prediction of left-out conditions and, where they are tied with it, profiles are
/// computed.
const RIVALS: usize = 3;

/// Groups of names that the data do not tell apart beside the last of the steps.
fn not_told_apart(ties: &[Vec<Hypothesis>], steps: &[Step], verdict: Verdict) -> Vec<Vec<String>> {
    let names = |tied: &Vec<Hypothesis>| tied.iter().filter_map(|h| Some(h.additions.last()?.name().into())).collect();
    let mut groups: Vec<Vec<String>> = ties.iter().filter(|tied| tied.len() > 1).map(names).collect();
    // What is left unexplained has no ties, and the free form beside it.
    if verdict != Verdict::Unexplained && is_drift_a_law_of_the_amplitude(&steps[0], &steps[steps.len() - 1]) {
        match groups.iter_mut().find(|group| group.first().is_some_and(|name| name == "drift")) {
            Some(group) => group.push(OF_AMPLITUDE.into()),
            None => groups.push(vec!["drift".into(), OF_AMPLITUDE.into()]),
        }
    }
    groups
}

/// The figures that the verdict on an explanation follows from.
fn evidence(end: &Step, undecidable: Option<&str>, points: usize) -> Evidence {
    let (additions, white) = (&end.hypothesis.additions, &end.comparison.whiteness);
    let effects = additions.iter().filter(|a| a.is_effect()).count();
    Evidence {
        testable: white.testable && shows_anything(&end.comparison.table.points),
        structured: white.structured,
        decidable: undecidable.is_none(),
        unsolved: end.comparison.unsolved() as f64 / points as f64,
        effects,
        recalibrations: additions.len() - effects,
    }
}

/// Why the readings could not have told against what an explanation adds, where that is so, in words.
fn undecidable(base: &Step, end: &Step, looked_at: f64) -> Option<&'static str> {
    if end.comparison.whiteness.structured {
        return None;
    }
    if !is_told_from_linear(base, end) {
        return Some(
            "one sweep without phases does not tell a law of the amplitude from one of the frequency: sweep again at a third \
             or three times the drive",
        );
    }
    (!is_told_within(base, end, looked_at)).then_some(
        "a rig of its own in every series, damping included, follows the readings as well, and so what else drifted is not \
         told from a law: repeat the first sweep at the end; where it differs, the rig has changed",
    )
}

/// Whether the readings could tell what an explanation adds from a linear law of the frequency, which follows any one
/// sweep of amplitudes: that a motion has two stable states or comes back at another frequency or drive is against one.
fn is_told_from_linear(base: &Step, end: &Step) -> bool {
    let (table, model) = (&end.comparison.table, &end.hypothesis.model);
    let Some(at) = table.points.first().map(operation) else { return true };
    let is_linear = |model| Alone::new(model, &at).is_linear();
    let linear = model.has_contact || is_linear(model) || !is_linear(&base.hypothesis.model);
    let has_folds = || end.comparison.points.iter().any(|p| !p.model.others.is_empty());
    linear || curves(&table.points) > 1 || has_folds()
}

/// All hypotheses of the first round and those about the explanation, each once; and whether it can be tested for.
fn to_be_ranked(
    steps: &[Step],
    (known, showing): (&Known, &[Addition]),
    ties: &[Vec<Hypothesis>],
) -> Vec<(Hypothesis, bool)> {
    let mut all: Vec<(Hypothesis, bool)> = Vec::new();
    let mut add = |hypothesis: &Hypothesis, testable: bool| {
        if !all.iter().any(|(known, _)| known.same_additions(hypothesis)) {
            all.push((hypothesis.clone(), testable));
        }
    };
    for step in steps {
        add(&step.hypothesis, true);
    }
    ties.iter().flatten().for_each(|tied| add(tied, true));
    // Of larger ones those that were fitted to all points.
    for entry in &known.entries {
        let hypothesis = &entry.hypothesis;
        if hypothesis.additions.len() == 1 || hypothesis.estimate.is_none() {
            add(hypothesis, hypothesis.additions.last().is_none_or(|a| showing.contains(a)));
        }
    }
    all
}

/// Counts what contains a smaller hypothesis, and can do whatever that does, as if it did, where its own fit is worse;
/// `all` are in the order of their size.
fn counted_as_contained(all: &mut [(Hypothesis, bool)], unit: f64) {
    for index in 0..all.len() {
        let (smaller, rest) = all.split_at_mut(index);
        let hypothesis = &mut rest[0].0;
        let contained = |h: &Hypothesis| h.basis() == Basis::AllPoints && h.nested_in(hypothesis);
        let least = smaller.iter().map(|(h, _)| h).filter(|h| contained(h));
        if let Some(least) = least.min_by(|a, b| a.square(unit).total_cmp(&b.square(unit)))
            && least.square(unit) + WORSE < hypothesis.square(unit)
        {
            let (residuals, scale) = least.left();
            let basis = hypothesis.estimate.as_ref().map_or(Basis::Contained, |own| own.basis);
            hypothesis.estimate = Some(Estimate { residuals: residuals.clone(), scale, basis });
        }
    }
}

impl Search<'_> {
    pub(super) fn conclude(
        &self,
        start: &Hypothesis,
        chosen: &Hypothesis,
        explanation: Comparison,
        known: &Known,
        ties: &[Vec<Hypothesis>],
        noise: Noise,
    ) -> Discovery {
        let mut steps = self.ladder(start, chosen, explanation, known);
        let unit = self.unit(chosen);
        let showing = self.showing(chosen, known);
        let candidates = self.rank(&steps, (known, &showing), ties, unit);
        let is_explained = !self.structured(chosen);
        let further = if is_explained { beyond_testimony(&mut steps) } else { beyond_prediction(&mut steps) };
        let ties = if is_explained && further.is_some() { &[] } else { ties };
        let end = &steps[steps.len() - 1];
        let undecidable = undecidable(&steps[0], end, self.looked_at(&end.hypothesis));
        let verdict = verdict(&evidence(end, undecidable, self.table.points.len()));
        let tied = || ties.iter().filter(|tied| tied.len() > 1);
        let rivals: Vec<Hypothesis> = tied().flatten().cloned().collect();
        let seen: Vec<String> = ties.iter().flatten().chain([&end.hypothesis]).flat_map(Hypothesis::effects).collect();
        let not_testable = self.not_testable(&candidates, known, &showing, &seen);
        let next_measurement = self.next(&end.hypothesis, &rivals, &candidates);
        let spent = !self.goes_on();
        let mut notes = not_searched(&self.data.base, &self.pool, &self.options.candidates);
        notes.extend(spent.then(|| {
            format!("the search has spent its budget of {} steady states: this is the best so far (more: --search budget=…)", self.options.budget)
        }));
        notes.extend(noise.words(self.table.noise_sources()).map(|words| {
            format!(
                "{words}; the search went on with standard deviations so many times as large, and its chi2 is in these"
            )
        }));
        if verdict == Verdict::EffectMissing {
            notes.extend(of_named(&end.hypothesis));
        }
        notes.extend(of_both_ways(end));
        notes.extend(of_gain_alone(end));
        notes.extend(self.not_chosen(&candidates, &end.hypothesis, further.as_deref()));
        notes.extend(of_what_is_left(end, unit));
        notes.extend(self.followed_alone(verdict, &end.comparison));
        Discovery {
            verdict,
            candidates,
            indistinguishable: not_told_apart(ties, &steps, verdict),
            asked: self.pool.iter().filter(|addition| addition.is_effect()).map(Addition::name).collect(),
            not_testable,
            outliers: end.comparison.outliers.clone(),
            next_measurement,
            noise,
            correlations: end.comparison.correlations.clone(),
            solved: self.data.solved(),
            spent,
            undecidable,
            notes,
            steps,
            fall: OnceLock::new(),
        }
    }

    /// What was chosen, one addition after the other, each fitted as well as anything that is known with these.
    fn ladder(&self, start: &Hypothesis, chosen: &Hypothesis, explanation: Comparison, known: &Known) -> Vec<Step> {
        let mut ladder = vec![start.clone()];
        for length in 1..chosen.additions.len() {
            let additions = &chosen.additions[..length];
            let mut all = known.with(additions);
            all.push(self.refit(chosen, additions.to_vec()));
            let before = &ladder[length - 1];
            let is_less = |h: &Hypothesis| h.fits_better_than(before) && h.chi2() <= before.chi2();
            if !all.iter().any(is_less) {
                all.extend(self.grown(chosen, before, additions));
            }
            if all.iter().any(is_less) {
                all.retain(is_less);
            }
            ladder.push(Hypothesis::best_fit(all).unwrap_or_else(|| chosen.clone()));
        }
        ladder.truncate(chosen.additions.len());
        let step = |index: usize, hypothesis: Hypothesis, comparison: Comparison| Step {
            added: index.checked_sub(1).map(|k| hypothesis.additions[k].name().to_string()),
            held_out: held_out(&self.data, &hypothesis),
            comparison,
            hypothesis,
        };
        let compared = |(index, hypothesis): (usize, Hypothesis)| {
            let comparison = self.comparison(&hypothesis, false);
            step(index, hypothesis, comparison)
        };
        let mut steps: Vec<Step> = ladder.into_par_iter().enumerate().map(compared).collect();
        steps.push(step(steps.len(), chosen.clone(), explanation));
        if let [base, others @ ..] = &mut steps[..] {
            for step in others {
                let c = &mut step.comparison;
                c.overall.rms_error_percent = compare::rms_error_beside(c.points.iter(), base.comparison.points.iter());
            }
        }
        steps
    }

    /// What comes of additions that begin weak beside the hypothesis before: what contains that fits no worse.
    fn grown(&self, chosen: &Hypothesis, before: &Hypothesis, additions: &[Addition]) -> Vec<Hypothesis> {
        let end = self.moved(chosen, &chosen.fitted(), additions.to_vec());
        let weak = WEAK.map(|share| self.at(&end, fall::along(&end, before, share)));
        weak.into_iter().map(|h| self.data.fitted(h, self.data.last_effort(CONTINUED))).collect()
    }

    /// Why the best of all candidates, where it is another one, is not the explanation.
    fn not_chosen(&self, candidates: &[Candidate], end: &Hypothesis, further: Option<&str>) -> Option<String> {
        let best = candidates.first().filter(|c| c.hypothesis.label() != end.label())?;
        let above = candidates.iter().find(|c| c.hypothesis.label() == end.label()).map_or(0.0, |c| c.delta_bic);
        let (label, pool) = (best.hypothesis.label(), self.pool.len());
        let more = best.hypothesis.additions.len().saturating_sub(end.additions.len());
        let takes = MARGIN + 2.0 * more as f64 * (pool.max(1) as f64).ln();
        let verdict = if let Some(further) = further {
            format!("but {further}")
        } else if above < takes {
            format!("too little to decide for it: among {pool} that were looked at it takes {takes:.1}")
        } else {
            "but counted in the noise, as the search counts where a candidate leaves no structure, it gains too little"
                .into()
        };
        Some(format!("{label} would be better by {above:.1} in BIC, {verdict}"))
    }

    /// A hypothesis against the readings; with `profile` intervals are by profile likelihood as far as the budget goes.
    pub(super) fn comparison(&self, hypothesis: &Hypothesis, profile: bool) -> Comparison {
        let (base, fit) = (hypothesis.model.clone(), hypothesis.fit.clone());
        let calibration = Calibration { base, fit, threshold: TAIL, solved: 0 };
        let left = || self.data.budget.saturating_sub(self.data.solved());
        let comparison = compare::judge(self.scenario, self.table, &calibration, profile.then(left));
        self.data.count(comparison.solved);
        comparison
    }

    /// All hypotheses of the first round and those about the explanation, the best first.
    fn rank(
        &self,
        steps: &[Step],
        (known, showing): (&Known, &[Addition]),
        ties: &[Vec<Hypothesis>],
        unit: f64,
    ) -> Vec<Candidate> {
        let mut all = to_be_ranked(steps, (known, showing), ties);
        all.sort_by_key(|(hypothesis, _)| (hypothesis.additions.len(), hypothesis.fit.parameters.len()));
        counted_as_contained(&mut all, unit);
        all.iter_mut().for_each(|(hypothesis, _)| hypothesis.bic = self.bic(unit, hypothesis));
        // What was not fitted to all points is estimated, and never better than what was.
        let full = |h: &Hypothesis| h.basis() == Basis::AllPoints;
        let least = all.iter().map(|(h, _)| h).filter(|h| full(h)).map(|h| h.bic).fold(f64::INFINITY, f64::min);
        all.iter_mut().filter(|(h, _)| !full(h)).for_each(|(h, _)| h.bic = h.bic.max(least));
        // Of what is as good to the digits that are told the explanation is the first: a law may be typed as a formula, too.
        let told = |h: &Hypothesis| (10.0 * h.bic).round();
        let other = |h: &Hypothesis| !steps.last().is_some_and(|step| step.hypothesis.same_additions(h));
        all.sort_by(|(a, _), (b, _)| {
            let by_basis = || full(b).cmp(&full(a)).then(other(a).cmp(&other(b)));
            let closer = || a.bic.total_cmp(&b.bic).then_with(|| a.label().cmp(&b.label()));
            told(a).total_cmp(&told(b)).then_with(by_basis).then_with(closer)
        });
        let best = all.first().map_or(0.0, |(h, _)| h.bic);
        // An estimate that was not allowed to be better has no share in the evidence: that was not looked at.
        let is_open = |h: &Hypothesis| !full(h) && h.bic <= least;
        let evidence = |h: &Hypothesis| if is_open(h) { 0.0 } else { (-0.5 * (h.bic - best)).exp() };
        let total: f64 = all.iter().map(|(h, _)| evidence(h)).sum();
        let weigh = |(rank, (mut hypothesis, testable)): (usize, (Hypothesis, bool))| {
            let step = steps.iter().find(|s| s.hypothesis.additions == hypothesis.additions);
            let tied = rank < RIVALS && ties.iter().flatten().any(|tied| tied.same_additions(&hypothesis));
            let intervals: Vec<Interval> = match step {
                Some(step) => step.comparison.intervals.clone(),
                // Profiles may come below the fit, and move it.
                None if tied => {
                    let profiled = self.comparison(&hypothesis, true);
                    hypothesis.fit = profiled.fit;
                    profiled.intervals
                }
                None => approximate_intervals(&hypothesis.fit, 1.0),
            };
            let is_rival = rank < RIVALS && hypothesis.estimate.is_none();
            Candidate {
                delta_bic: (hypothesis.bic - best).max(0.0),
                is_open: is_open(&hypothesis),
                weight: evidence(&hypothesis) / total,
                testable,
                chi2_per_point: hypothesis.chi2() / self.readings() as f64,
                intervals,
                held_out: match step {
                    Some(step) => step.held_out,
                    None => is_rival.then(|| held_out(&self.data, &hypothesis)).flatten(),
                },
                hypothesis,
            }
        };
        all.into_iter().enumerate().map(weigh).collect()
    }

    /// Additions of which the strongest plausible form would be found beside something: what was fitted, or the
    /// explanation.
    fn showing(&self, chosen: &Hypothesis, known: &Known) -> Vec<Addition> {
        let shows = |addition: Addition, visibility: f64| {
            let parameters = count(&extended(&self.data.base, &[addition]), &addition.keys()) as f64;
            visibility > parameters * (self.readings() as f64).ln() + MARGIN
        };
        let last = |e: &Entry| Some((*e.hypothesis.additions.last()?, e.visibility));
        let mut showing: Vec<Addition> = known
            .entries
            .iter()
            .filter_map(last)
            .filter(|(a, visibility)| shows(*a, *visibility))
            .map(|(a, _)| a)
            .collect();
        if !chosen.additions.is_empty() {
            let hidden: Vec<Addition> =
                self.pool.iter().copied().filter(|a| a.is_effect() && !showing.contains(a)).collect();
            let seen = self.visible(chosen, &hidden);
            showing
                .extend(hidden.into_iter().zip(seen).filter(|(a, visibility)| shows(*a, *visibility)).map(|(a, _)| a));
        }
        showing
    }

    /// Effects that no plausible form would show, but those `seen`: what is named, or tied with what is, was found beside
    /// other numbers of the rig than such a form was looked at.
    fn not_testable(
        &self,
        candidates: &[Candidate],
        known: &Known,
        showing: &[Addition],
        seen: &[String],
    ) -> Vec<NotTestable> {
        let base = candidates.iter().find(|c| c.hypothesis.additions.is_empty());
        let mut list = Vec::new();
        for entry in &known.entries {
            let [addition @ Addition::Effect(_)] = entry.hypothesis.additions[..] else { continue };
            if showing.contains(&addition) || seen.iter().any(|name| name == addition.name()) {
                continue;
            }
            let would_show = base.map_or_else(String::new, |base| {
                // Beside the calibrated base: a form was looked at beside other numbers of the rig, too.
                let fitted = base.hypothesis.fitted();
                let beside = |form: &Model| {
                    let effects = fitted.effects.iter().chain(form.effects.last()).cloned().collect();
                    Model { effects, ..fitted.clone() }
                };
                let forms: Vec<Model> = entry.strongest.iter().map(beside).collect();
                next::would_show(&fitted, &forms, self.table, &self.options.bounds)
            });
            list.push(NotTestable {
                effect: addition.name().into(),
                largest_sigma: entry.visibility.sqrt(),
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
    ) -> Option<next::NextMeasurement> {
        let unit = self.unit(chosen);
        let bic = |h: &Hypothesis| self.bic(unit, h);
        let mut survivors: Vec<&Hypothesis> = rivals.iter().collect();
        let mut behind = None;
        if survivors.len() < 2 {
            // The explanation and its closest rival with as many additions, fitted to all points if there is one;
            // calibration alone has one only where the data favour it, if too little to decide.
            let rivals = || {
                candidates.iter().filter(|Candidate { hypothesis: h, .. }| {
                    let favoured = !chosen.additions.is_empty() || h.bic < bic(chosen);
                    favoured && h.additions != chosen.additions && h.additions.len() == chosen.additions.len().max(1)
                })
            };
            let whole = rivals().find(|c| c.hypothesis.estimate.is_none());
            let rival = whole.or_else(|| rivals().next())?;
            let by = if whole.is_some() { bic(&rival.hypothesis) - bic(chosen) } else { rival.delta_bic };
            behind = Some(by).filter(|behind| *behind > MARGIN);
            survivors = vec![chosen, &rival.hypothesis];
        }
        let next = next::next(&survivors, self.table, &self.options.bounds)?;
        Some(next::NextMeasurement { ruled_out_by: behind, ..next })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::SearchOptions;
    use crate::{measurement, scenario};
    use std::sync::Arc;

    #[test]
    fn what_contains_a_step_of_the_ladder_fits_no_worse() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/delay/scenario.toml");
        let scenario = scenario::load(&path).expect("a scenario");
        let table = measurement::load(&scenario).expect("a table").expect("measurements");
        let (scenario, options) = (table.applied_to(&scenario), SearchOptions::default());
        let (search, start) = Search::begin(&scenario, &table, &options, &Arc::default());
        for name in ["sensor-delay", "crosstalk"] {
            let addition = *search.pool.iter().find(|a| a.name() == name).expect("a candidate");
            // From far beside the readings a fit does not find back.
            let middle = search.moved(&start, &extended(&start.fitted(), &[addition]), vec![addition]);
            let far = middle.fit.values.iter().zip(&middle.fit.parameters);
            let far = far.map(|(x, p)| if p.key.starts_with("effect") { 1e3 * x } else { *x }).collect();
            let chosen = search.at(&middle, far);
            let lost = search.refit(&chosen, vec![addition]);
            // A strength of either sign finds back through zero.
            let is_lost = lost.chi2() > 1.05 * start.chi2();
            assert_eq!(is_lost, name == "sensor-delay", "{name}: {} {}", lost.chi2(), start.chi2());
            let grown = Hypothesis::best_fit(search.grown(&chosen, &start, &[addition])).expect("fits");
            assert!(grown.chi2() < 1.01 * start.chi2(), "{name}: {} {}", grown.chi2(), start.chi2());
        }
    }
}
