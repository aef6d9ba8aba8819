//! The parameters of one effect at which its curve comes closest, and the least strained ones at which it is still
//! alike.
//!
//! Closest: samples over the ranges of the catalogue, the best of them followed by least squares on the solver's
//! derivatives, within three times those ranges. Least squares does not know of peaks and ends: from there a compass
//! search (steps along one parameter at a time, halved where none helps) goes to the nearest setting with all features,
//! and on to the closest such. Least strained: the same compass search within boxes about the middle of all ranges
//! (logarithms), the smallest box with a setting that has all features by bisection. A compass search may miss what
//! lies beyond a valley, so that a strain is an upper bound.

use super::features::Judge;
use super::{Hypothesis, Setting};
use crate::discover::{Addition, extended};
use crate::effects::Effect;
use crate::fit::{Parameter, Problem, Settings, minimise, parameter};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::Status;
use crate::solver::cycle::Tolerance;
use crate::sweep::{Condition, curve};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Points that a search works on, at most.
const POINTS: usize = 34;
/// Samples over the ranges of an effect of one, two, three, four parameters, of each sign.
const SAMPLES: [usize; 4] = [12, 24, 32, 40];
/// Samples that are followed.
const FOLLOWED: usize = 3;
/// Samples, and those followed, of a continuum of sliders, which takes long.
const COSTLY: (usize, usize) = (4, 1);
/// How hard a fit tries.
const EFFORT: Settings = Settings { evaluations: 15, threshold: f64::INFINITY, converged: 1e-5, states: u64::MAX };
/// Bisections of the box.
const BISECTIONS: usize = 6;
/// First and last step of a compass search, in shares of the range of a parameter, and its evaluations at most.
const COMPASS: (f64, f64, usize) = (0.08, 0.004, 90);
/// What a shortfall of the features weighs against one tolerance of difference.
const WEIGHT: f64 = 100.0;
/// Relative change of the difference below which an effect counts as without influence.
const IDLE: f64 = 1e-3;
/// Digits of the values that are tried and told.
const DIGITS: usize = 3;

/// Parameters with their signs, and values of them.
type Start = (Vec<Parameter>, Vec<f64>);

/// What the effect gives at the points of a search: amplitudes, and how many points have no steady state.
type Response = (Vec<f64>, usize);

struct Search<'a> {
    base: &'a Model,
    effect: &'static dyn Effect,
    condition: &'a Condition,
    judge: &'a Judge,
    /// The same for the points of the search.
    coarse: Judge,
    points: Vec<&'a Point>,
    model: Model,
    /// What was solved, by the bits of the values.
    known: Rc<RefCell<BTreeMap<Vec<u64>, Response>>>,
}

/// Searches the parameters of an effect; whether it can is also said for `others` that judge by another tolerance.
pub(super) fn search(
    base: &Model,
    effect: &'static dyn Effect,
    condition: &Condition,
    points: &[Point],
    (judge, others): (&Judge, &[Judge]),
) -> (Hypothesis, Vec<bool>) {
    let stride = stride(points.len());
    let model = extended(base, &[Addition::Effect(effect)]);
    let (coarse, points) = (judge.every(stride), points.iter().step_by(stride).collect());
    let search = Search { base, effect, condition, judge, coarse, points, model, known: Rc::default() };
    let starts = search.starts();
    let nearest = search.nearest(&starts).unwrap_or_else(|| starts[0].clone());
    let near = search.setting(&nearest);
    let idle = (near.features.rms / judge.rms_of_full_slip() - 1.0).abs() < IDLE;
    if idle {
        return (Hypothesis { effect, best: near, mildest: None, idle }, vec![false; others.len()]);
    }
    let mut all = vec![nearest];
    all.extend(starts);
    let able = search.able(&all, f64::INFINITY, true);
    let with_all = able.as_ref().map(|start| search.setting(start)).filter(|setting| setting.features.all());
    all.extend(able);
    let otherwise = others.iter().map(|judge| search.judged_by(judge).can(&all)).collect();
    let Some(best) = with_all else {
        return (Hypothesis { effect, best: near, mildest: None, idle }, otherwise);
    };
    let mildest = search.mildest(&best, &all);
    let closer = mildest.features.rms < best.features.rms;
    let best = if closer { mildest.clone() } else { best };
    (Hypothesis { effect, best, mildest: Some(mildest), idle }, otherwise)
}

fn stride(points: usize) -> usize {
    points.div_ceil(POINTS)
}

impl<'a> Search<'a> {
    /// The same search for another judge of the same curve.
    fn judged_by(&self, judge: &'a Judge) -> Self {
        let coarse = judge.every(stride(judge.frequency().len()));
        let (points, model, known) = (self.points.clone(), self.model.clone(), Rc::clone(&self.known));
        Self { judge, coarse, points, model, known, ..*self }
    }

    /// Whether a search from these starts finds a setting with all features.
    fn can(&self, starts: &[Start]) -> bool {
        // What is enough on a part of the frequencies need not be on all of them: then the closest has to be.
        let found =
            |closest| self.able(starts, f64::INFINITY, closest).map(|start| self.setting(&start).features.all());
        found(false).is_some_and(|all| all || found(true) == Some(true))
    }

    fn problem(&self, parameters: &[Parameter]) -> Problem<'a> {
        Problem::new(self.model.clone(), self.points.iter().copied(), parameters.to_vec(), Tolerance::COARSE)
    }

    /// The best samples over the ranges.
    fn starts(&self) -> Vec<Start> {
        let keys = Addition::Effect(self.effect).keys();
        let parameters: Vec<Parameter> = keys.iter().filter_map(|key| parameter(&self.model, key)).collect();
        let signed = parameters.iter().any(|p| p.signed);
        let costly = self.model.has_sliders();
        let (count, followed) = if costly { COSTLY } else { (SAMPLES[parameters.len().clamp(1, 4) - 1], FOLLOWED) };
        let mut tried: Vec<(f64, Start)> = Vec::new();
        for number in 0..count {
            for negative in [false, true].into_iter().take(1 + usize::from(signed)) {
                let turn = |p: &Parameter| if p.signed && negative { p.mirrored() } else { p.clone() };
                let turned: Vec<Parameter> = parameters.iter().map(turn).collect();
                let value = |(d, p): (usize, &Parameter)| p.within(share(number, count, d, parameters.len()));
                let values: Vec<f64> = turned.iter().enumerate().map(value).collect();
                tried.push((self.problem(&turned).evaluate(&values, false).chi2(), (turned, values)));
            }
        }
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        tried.into_iter().take(followed).map(|(_, start)| start).collect()
    }

    /// The best of the fits from these starts.
    fn nearest(&self, starts: &[Start]) -> Option<Start> {
        let fit = |(parameters, values): &Start| minimise(&mut self.problem(parameters), values, &EFFORT);
        let fits = starts.iter().map(fit).filter(|fit| fit.objective.is_finite());
        let best = fits.min_by(|a, b| a.objective.total_cmp(&b.objective))?;
        Some((best.parameters, best.values))
    }

    /// The effect at values rounded as they are told, over all frequencies at full accuracy.
    fn setting(&self, (parameters, values): &Start) -> Setting {
        let moved: Vec<f64> = values.iter().map(|&x| rounded(x)).collect();
        let strain = strain(parameters, &moved);
        let mut model = self.problem(parameters).model(&moved);
        let values = model.effects.pop().map_or_else(Vec::new, |(_, values)| values);
        model.clone_from(self.base);
        model.effects.push((self.effect, values.clone()));
        let curve = curve(&model, self.condition, self.judge.frequency(), &Tolerance::default());
        let features = self.judge.judge(&curve);
        Setting { values, strain, curve, features }
    }

    /// A setting with all features within a strain, the `closest` one or any; `None` where a compass search finds none.
    fn able(&self, starts: &[Start], strain: f64, closest: bool) -> Option<Start> {
        let able = WEIGHT * 1e-9 + self.judge.most();
        let enough = if closest { f64::NEG_INFINITY } else { able };
        let mut best: Option<(f64, Start)> = None;
        for (parameters, values) in starts {
            let narrowed: Vec<Parameter> = parameters.iter().map(|p| p.strained_at_most(strain)).collect();
            let values: Vec<f64> = narrowed.iter().zip(values).map(|(p, &x)| p.moved(x, 0.0)).collect();
            let (cost, values) = self.compass(&narrowed, values, enough);
            if cost < able && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, (parameters.clone(), values)));
            }
            if !closest && best.is_some() {
                break;
            }
        }
        best.map(|(_, start)| start)
    }

    /// What the effect gives at these values. Searches by several judges and within several bounds pass through the
    /// same ones; only what a continuum of sliders gives depends on what was solved before.
    fn response(&self, problem: &mut Problem<'_>, values: &[f64]) -> Response {
        let key: Vec<u64> = values.iter().map(|value| value.to_bits()).collect();
        if let Some(known) = self.known.borrow().get(&key).filter(|_| !self.model.has_sliders()) {
            return known.clone();
        }
        let predictions = problem.evaluate(values, false).predictions;
        let not_steady = predictions.iter().filter(|p| p.status != Status::Steady).count();
        let response: Response = (predictions.iter().map(|p| p.amplitude).collect(), not_steady);
        self.known.borrow_mut().insert(key, response.clone());
        response
    }

    /// Goes downhill along one parameter at a time from a start within the bounds, until the cost is below `enough`.
    fn compass(&self, parameters: &[Parameter], start: Vec<f64>, enough: f64) -> (f64, Vec<f64>) {
        let mut problem = self.problem(parameters);
        let mut cost = |values: &[f64]| {
            let (amplitude, not_steady) = self.response(&mut problem, values);
            let features = self.coarse.features(&amplitude, 0);
            let cost = WEIGHT * (self.coarse.shortfall(&features) + not_steady as f64) + features.rms;
            if cost.is_finite() { cost } else { f64::MAX }
        };
        let (mut step, last, most) = COMPASS;
        let mut best = (cost(&start), start);
        let mut tried = 1;
        while step > last && tried < most && best.0 >= enough {
            let mut next = best.clone();
            for (d, parameter) in parameters.iter().enumerate() {
                for direction in [step, -step] {
                    let mut values = best.1.clone();
                    values[d] = parameter.moved(values[d], direction * parameter.extent());
                    if values[d] == best.1[d] {
                        continue;
                    }
                    tried += 1;
                    let found = cost(&values);
                    if found < next.0 {
                        next = (found, values);
                    }
                }
            }
            if next.0 < best.0 { best = next } else { step *= 0.5 }
        }
        best
    }

    /// The least strained setting that has all features.
    fn mildest(&self, best: &Setting, starts: &[Start]) -> Setting {
        // The last start is the setting that has all features.
        let mut starts: Vec<Start> = starts.iter().rev().take(FOLLOWED).cloned().collect();
        let mut found = best.clone();
        let (mut low, mut high) = (0.0, best.strain);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            let tried = |closest| self.able(&starts, middle, closest).map(|start| (self.setting(&start), start));
            // What is enough on a part of the frequencies need not be on all of them: then the closest has to be.
            let within = match tried(false) {
                Some((setting, _)) if !setting.features.all() => tried(true),
                found => found,
            };
            match within.filter(|(setting, _)| setting.features.all()) {
                Some((setting, start)) => {
                    high = setting.strain.min(middle);
                    starts[0] = start;
                    if setting.strain < found.strain {
                        found = setting;
                    }
                }
                None => low = middle,
            }
        }
        found
    }
}

/// Largest distance of a value from the middle of its range.
fn strain(parameters: &[Parameter], values: &[f64]) -> f64 {
    parameters.iter().zip(values).map(|(p, &x)| p.strain(x)).fold(0.0, f64::max)
}

/// Where a sample lies in the range of a parameter: evenly for one, quasi-random for more.
fn share(number: usize, count: usize, dimension: usize, dimensions: usize) -> f64 {
    if dimensions == 1 {
        (number as f64 + 0.5) / count as f64
    } else {
        f64::from(sobol_burley::sample(number as u32, dimension as u32, 0))
    }
}

fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}
