//! How well the data determine a parameter: profile likelihood, and the correlations behind it.

use super::{Fit, Parameter, Problem, Settings, minimise, robust_chi2};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use schemars::JsonSchema;

/// 95 % quantile of chi squared with one degree of freedom.
const RISE: f64 = 3.841_458_820_694_124;
/// Singular values below this share of the largest count as none.
const SINGULAR: f64 = 1e-9;
/// Refits on the way to one end of an interval.
const TRIALS: usize = 7;
/// Relative accuracy of the rise at the end of an interval.
const CLOSE: f64 = 0.06;
/// A sum of squares lower than that of the estimate by this share of the rise at the ends shows that it is no minimum.
const BETTER: f64 = 0.1;
/// Times that a fit is made again from a better place, and evaluations of each.
const MOVES: usize = 3;
const EVALUATIONS: usize = 60;
/// Change of the sum of squares at which a refit is done, in units of the rise at the ends: below that accuracy.
const DONE: f64 = 0.005;
/// Correlation of two estimates from which on it is named.
const STRONG: f64 = 0.95;

/// What the data say of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Identified {
    /// Bounded from both sides.
    Yes,
    /// Bounded from one side only.
    OneSided,
    /// Not bounded within the range of the search.
    No,
}

impl Identified {
    /// The word of the JSON and of tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::OneSided => "one-sided",
            Self::No => "no",
        }
    }
}

/// 95 % interval of a parameter by profile likelihood; an open end is the bound of the search.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, serde::Serialize)]
pub struct Interval {
    /// Estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether both ends are the data's.
    pub identified: Identified,
}

/// Two estimates that the data tie together.
#[derive(Debug, Clone, PartialEq, JsonSchema, serde::Serialize)]
pub struct Correlation {
    /// Keys of the two.
    pub parameters: (String, String),
    /// Correlation of the estimates on their natural scales.
    pub value: f64,
}

/// Covariance of the estimates on their natural scales (logarithms of magnitudes) in units of the noise; directions
/// that the data do not see have huge variance.
fn covariance(fit: &Fit) -> DMatrix<f64> {
    let n = fit.parameters.len();
    if n == 0 {
        return DMatrix::zeros(0, 0);
    }
    // Columns of unit length: what two estimates do against each other is not lost beside what each of them does.
    let mut jacobian = fit.evaluation.jacobian.clone();
    let mut unit = DVector::from_element(n, 1.0);
    for (i, (parameter, &value)) in fit.parameters.iter().zip(&fit.values).enumerate() {
        let slope = parameter.natural_slope(value);
        let length = jacobian.column(i).norm() * slope.abs();
        unit[i] = if length > 0.0 { 1.0 / length } else { 1.0 };
        jacobian.column_mut(i).scale_mut(slope * unit[i]);
    }
    let normal = jacobian.transpose() * &jacobian;
    let eigen = normal.symmetric_eigen();
    let largest = eigen.eigenvalues.max().max(f64::MIN_POSITIVE);
    let mut inverse = DMatrix::zeros(n, n);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let vector = vector.component_mul(&unit);
        inverse += &vector * vector.transpose() / value.max(largest * SINGULAR * SINGULAR).max(f64::MIN_POSITIVE);
    }
    inverse
}

/// Intervals (95 %) from the curvature at the optimum, on the natural scales and within the bounds of the search:
/// cheap, and exact where the model is linear in the parameters.
pub fn approximate_intervals(fit: &Fit, noise: f64) -> Vec<Interval> {
    let covariance = covariance(fit);
    let of = |(i, (p, &value)): (usize, (&Parameter, &f64))| {
        let half = noise * (RISE * covariance[(i, i)]).sqrt();
        let end = |side: f64| p.moved(value, side * half.min(p.room(value, side)));
        let (one, other) = (end(-1.0), end(1.0));
        let identified = match (p.is_open(value, one), p.is_open(value, other)) {
            (false, false) => Identified::Yes,
            (true, true) => Identified::No,
            _ => Identified::OneSided,
        };
        Interval { value, low: one.min(other), high: one.max(other), identified }
    };
    fit.parameters.iter().zip(&fit.values).enumerate().map(of).collect()
}

/// Pairs of estimates that are tied together.
pub fn correlations(fit: &Fit) -> Vec<Correlation> {
    let covariance = covariance(fit);
    let mut strong = Vec::new();
    for i in 0..fit.parameters.len() {
        for j in i + 1..fit.parameters.len() {
            let value = covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
            if value.abs() >= STRONG {
                let parameters = (fit.parameters[i].key.clone(), fit.parameters[j].key.clone());
                strong.push(Correlation { parameters, value });
            }
        }
    }
    strong
}

/// Intervals of a fit by profile likelihood.
#[derive(Debug, Clone)]
pub struct Profiles {
    /// The fit: where a profile comes below it, it was no minimum, and is made again from there.
    pub fit: Fit,
    /// One interval for each of its parameters.
    pub intervals: Vec<Interval>,
    /// Ends that are of the curvature, since the steady states allowed were spent.
    pub unfinished: usize,
    /// Steady states solved.
    pub solved: u64,
}

/// Profile-likelihood intervals (95 %) of all parameters of a fit. `noise` is the factor by which the standard
/// deviations of the data are to be multiplied, given a fit; `problem` moves the parameters of the fit. All ends are
/// looked for in step, so that what is done does not depend on the number of threads; once as many steady states as are
/// `allowed` were solved, those not found yet are put where the curvature of the sum of squares has them.
pub fn profiled(
    fit: &Fit,
    noise: impl Fn(&Fit) -> f64,
    threshold: f64,
    problem: &mut Problem<'_>,
    allowed: u64,
) -> Profiles {
    let mut fit = fit.clone();
    let (mut solved, mut moves) = (0, 0);
    loop {
        let covariance = covariance(&fit);
        // The sum of squares at the accuracy of the problem, which need not be that of the fit.
        let mut again = problem.at(&fit.values, Vec::new());
        let least = robust_chi2(&again.evaluate(&[], false).residuals, threshold);
        solved += again.solved;
        let goal = RISE * noise(&fit).powi(2);
        let profile = Profile { fit: &fit, goal, least, threshold, covariance: &covariance, problem };
        let mut sides: Vec<Side> = (0..fit.parameters.len())
            .flat_map(|i| [-1.0, 1.0].map(|direction| Side::new(&profile, i, direction)))
            .collect();
        if solved < allowed {
            let share = share(&sides, allowed - solved);
            sides.par_iter_mut().for_each(|side| side.begin(share));
            solved += spent(&mut sides);
        }
        let lowest = sides.iter().filter_map(|side| side.refit.as_ref()).min_by(|a, b| a.rise.total_cmp(&b.rise));
        if let Some(lowest) = lowest.filter(|lowest| moves < MOVES && lowest.rise < -BETTER * goal && solved < allowed)
        {
            let states = allowed - solved;
            let settings = Settings { evaluations: EVALUATIONS, threshold, converged: super::CONVERGED, states };
            let mut again = problem.at(&fit.values, fit.parameters.clone());
            let moved = minimise(&mut again, &lowest.values, &settings);
            solved += again.solved;
            moves += 1;
            if moved.objective < least {
                fit = moved;
                continue;
            }
        }
        solved += in_step(&mut sides, allowed.saturating_sub(solved));
        // A profile runs along a valley where others may have lost it: what one has found to be as good as the ends
        // lies in the intervals of all.
        let inside: Vec<Refit> = sides.iter().flat_map(|side| side.inside.iter().cloned()).collect();
        sides.iter_mut().for_each(|side| side.resume(&inside));
        solved += in_step(&mut sides, allowed.saturating_sub(solved));
        let unfinished = sides.iter().filter(|side| side.end.is_none()).count();
        let inside: Vec<Refit> = sides.iter().flat_map(|side| side.inside.iter().cloned()).collect();
        sides.iter_mut().for_each(|side| side.close(&inside));
        let intervals = sides.chunks(2).map(|pair| Side::interval(&pair[0], &pair[1])).collect();
        return Profiles { fit, intervals, unfinished, solved };
    }
}

/// Takes all sides a step further in turn, until each has its end or as many steady states were solved as are allowed.
fn in_step(sides: &mut [Side<'_, '_>], allowed: u64) -> u64 {
    let mut solved = 0;
    while solved < allowed && sides.iter().any(|side| side.end.is_none()) {
        let share = share(sides, allowed - solved);
        sides.par_iter_mut().for_each(|side| side.advance(share));
        solved += spent(sides);
    }
    solved
}

/// What each side without an end may solve in its next step of so many steady states.
fn share(sides: &[Side<'_, '_>], left: u64) -> u64 {
    left.div_ceil(sides.iter().filter(|side| side.end.is_none()).count().max(1) as u64)
}

/// Steady states that the sides solved since they were last asked.
fn spent(sides: &mut [Side<'_, '_>]) -> u64 {
    sides.iter_mut().map(|side| std::mem::take(&mut side.solved)).sum()
}

/// What the profiles of a fit have in common.
struct Profile<'p, 'a> {
    fit: &'p Fit,
    /// Rise of the sum of squares at the ends.
    goal: f64,
    least: f64,
    threshold: f64,
    covariance: &'p DMatrix<f64>,
    problem: &'p Problem<'a>,
}

/// One parameter from its estimate in one direction, on the way to the end of its interval.
// Wide: the state of a search for one end, which goes on trial by trial.
struct Side<'p, 'a> {
    of: &'p Profile<'p, 'a>,
    i: usize,
    direction: f64,
    /// The other parameters.
    others: Vec<usize>,
    /// Distance of the bound of the search on the natural scale.
    room: f64,
    /// The last refit; `None` where the data do not depend on the parameter.
    refit: Option<Refit>,
    /// From where the others are tied, the last refit inside the interval: one beyond its end may have gone astray.
    tie: Option<Refit>,
    /// What was found to be no worse than the ends.
    inside: Vec<Refit>,
    /// The farthest step inside and the rise there, the nearest outside.
    near: (f64, f64),
    outside: Option<(f64, f64)>,
    /// Refits so far.
    trials: usize,
    /// The end: its step, and whether it is the data's rather than the bound of the search.
    end: Option<(f64, bool)>,
    /// Steady states solved since they were last counted.
    solved: u64,
}

/// All parameters but one fitted again with that one held at a step from its estimate.
#[derive(Clone)]
struct Refit {
    step: f64,
    /// Sum of squares above that of the estimate.
    rise: f64,
    values: Vec<f64>,
    /// Whether its share of the steady states was spent before it came to its end.
    is_cut: bool,
}

impl<'p, 'a> Side<'p, 'a> {
    fn new(of: &'p Profile<'p, 'a>, i: usize, direction: f64) -> Self {
        let fit = of.fit;
        Self {
            of,
            i,
            direction,
            others: (0..fit.parameters.len()).filter(|&j| j != i).collect(),
            room: fit.parameters[i].room(fit.values[i], direction),
            refit: None,
            tie: None,
            inside: Vec::new(),
            near: (0.0, 0.0),
            outside: None,
            trials: 0,
            end: None,
            solved: 0,
        }
    }

    fn at(&self, step: f64) -> f64 {
        self.of.fit.parameters[self.i].moved(self.of.fit.values[self.i], self.direction * step)
    }

    /// The step to where the curvature puts the end.
    fn curvature(&self) -> f64 {
        (self.of.goal * self.of.covariance[(self.i, self.i)]).sqrt().min(self.room)
    }

    /// Refits where the curvature puts the end, with so many steady states.
    fn begin(&mut self, share: u64) {
        let (fit, i) = (self.of.fit, self.i);
        let sensitive = fit.evaluation.jacobian.column(i).norm() * fit.parameters[i].natural_slope(fit.values[i]).abs();
        if sensitive < 1e-9 {
            self.end = Some((self.room, false));
            return;
        }
        // The others as the curvature at the optimum ties them.
        let covariance = self.of.covariance;
        let slope = |&j: &usize| covariance[(i, j)] / covariance[(i, i)] * self.direction;
        let slopes: Vec<f64> = self.others.iter().map(slope).collect();
        let refit = self.refitted(self.curvature(), &slopes, share);
        (self.tie, self.refit) = (Some(refit.clone()), Some(refit));
    }

    /// Fits the others again at a step, from where they are if they move by `slopes` per step on their natural scales.
    fn refitted(&mut self, step: f64, slopes: &[f64], share: u64) -> Refit {
        let fit = self.of.fit;
        let step = step.min(self.room);
        // A magnitude by a factor of e at most; an angle has no such scale.
        let tied = |(&j, slope): (&usize, &f64)| {
            let p = &fit.parameters[j];
            let step = if p.is_periodic() { slope * step } else { (slope * step).clamp(-1.0, 1.0) };
            p.moved(fit.values[j], step)
        };
        let from: Vec<f64> = self.others.iter().zip(slopes).map(tied).collect();
        self.trials += 1;
        self.refitted_from(step, &from, share)
    }

    /// Fits the others again at a step from these values of them, as far as so many steady states lead.
    fn refitted_from(&mut self, step: f64, from: &[f64], states: u64) -> Refit {
        let fit = self.of.fit;
        let mut values = fit.values.clone();
        values[self.i] = self.at(step);
        let moving: Vec<Parameter> = self.others.iter().map(|&j| fit.parameters[j].clone()).collect();
        let mut constrained = self.of.problem.at(&values, moving);
        let evaluations = 4 * (self.others.len() + 1);
        let converged = (DONE * self.of.goal / self.of.least).min(1e-3);
        let settings = Settings { evaluations, threshold: self.of.threshold, converged, states };
        let goal = self.of.goal;
        let mut refit = minimise(&mut constrained, from, &settings);
        // Along a curved valley a refit takes more evaluations: as long as going on may bring it inside the interval.
        while refit.is_exhausted()
            && constrained.solved < states
            && refit.objective - self.of.least > goal * (1.0 + CLOSE)
        {
            let next = minimise(&mut constrained, &refit.values, &settings);
            let gain = refit.objective - next.objective;
            refit = next;
            if refit.objective - self.of.least - 2.0 * gain > goal {
                break;
            }
        }
        self.others.iter().zip(&refit.values).for_each(|(&j, &value)| values[j] = value);
        self.solved += constrained.solved;
        Refit { step, rise: refit.objective - self.of.least, values, is_cut: constrained.solved >= states }
    }

    /// The step to values, negative where they lie on the other side.
    fn step(&self, values: &[f64]) -> f64 {
        let fit = self.of.fit;
        self.direction * fit.parameters[self.i].natural_step(fit.values[self.i], values[self.i])
    }

    /// The farthest on this side of the refits of all.
    fn farthest(&self, inside: &[Refit]) -> Option<Refit> {
        let steps = inside.iter().map(|refit| Refit { step: self.step(&refit.values), ..refit.clone() });
        steps.max_by(|a, b| a.step.total_cmp(&b.step))
    }

    /// Goes on from the farthest of the refits of all sides where that lies beyond what this one took for its end.
    fn resume(&mut self, inside: &[Refit]) {
        let Some(far) = self.farthest(inside) else { return };
        if self.end.is_some_and(|(step, _)| far.step > step * (1.0 + CLOSE)) {
            (self.tie, self.refit) = (Some(far.clone()), Some(far));
            (self.inside, self.near, self.outside, self.trials, self.end) = (Vec::new(), (0.0, 0.0), None, 0, None);
        }
    }

    /// The end that was found, else that of the curvature; not before what any side found to be inside.
    fn close(&mut self, inside: &[Refit]) {
        let (step, closed) = self.end.unwrap_or((self.curvature(), self.curvature() < self.room));
        let far = self.farthest(inside).map_or(0.0, |far| far.step);
        self.end = Some(if far > step { (far, far < self.room * (1.0 - 1e-9)) } else { (step, closed) });
    }

    /// Judges the last refit, and makes the next one with so many steady states or ends; one that was cut short beyond
    /// the interval goes on.
    fn advance(&mut self, share: u64) {
        let (goal, room) = (self.of.goal, self.room);
        if self.end.is_some() {
            return;
        }
        let (Some(refit), Some(mut tie)) = (self.refit.clone(), self.tie.clone()) else { return };
        let Refit { step, rise, is_cut, .. } = refit;
        if is_cut && rise > goal {
            let from: Vec<f64> = self.others.iter().map(|&j| refit.values[j]).collect();
            self.refit = Some(self.refitted_from(step, &from, share));
            return;
        }
        if (rise / goal - 1.0).abs() < CLOSE {
            self.end = Some((step, true));
            return;
        }
        if rise < goal || (self.near.0 == 0.0 && step <= tie.step) {
            tie.clone_from(&refit);
        }
        if rise < goal {
            self.inside.push(refit);
            if step >= room * (1.0 - 1e-9) {
                self.end = Some((room, false));
                return;
            }
            self.near = (step, rise.max(0.0));
        } else {
            self.outside = Some((step, rise));
        }
        if self.trials >= TRIALS {
            // Not found: rather too wide than too narrow.
            self.end = Some(self.outside.map_or((room, false), |(far, _)| (far, true)));
            return;
        }
        let next = self.next(step, rise);
        let fit = self.of.fit;
        let slope = |&j: &usize| fit.parameters[j].natural_step(fit.values[j], tie.values[j]) / tie.step;
        let slopes: Vec<f64> = self.others.iter().map(slope).collect();
        self.refit = Some(self.refitted(next, &slopes, share));
        self.tie = Some(tie);
    }

    /// The step at which the rise is expected to reach its goal: it goes nearly as a power of the step, at first as its
    /// square.
    fn next(&self, step: f64, rise: f64) -> f64 {
        let (near, goal) = (self.near, self.of.goal);
        let power = match self.outside {
            Some((far, much)) if near.1 > 0.0 => (much / near.1).ln() / (far / near.0).ln(),
            _ => 2.0,
        };
        let scaled = step * (goal / rise.max(1e-3 * goal)).powf(1.0 / power);
        match self.outside {
            Some((far, _)) if self.inside.len() % 2 == 1 => 0.5 * (near.0 + far),
            Some((far, _)) => scaled.clamp(0.95 * near.0 + 0.05 * far, 0.05 * near.0 + 0.95 * far),
            None => scaled.clamp(1.2 * step, 8.0 * step),
        }
    }

    /// The interval between the ends on two sides.
    fn interval(below: &Self, above: &Self) -> Interval {
        let of = |side: &Self| {
            let (step, closed) = side.end.unwrap_or((side.room, false));
            (side.at(step), closed)
        };
        let mut ends = (of(below), of(above));
        let (fit, i) = (below.of.fit, below.i);
        if fit.parameters[i].signed && !ends.0.1 && ends.1.1 {
            // It goes through zero, about which a model is linear: as far to the other side as to this.
            ends.0 = (2.0 * fit.values[i] - ends.1.0, true);
        }
        let identified = match (ends.0.1, ends.1.1) {
            (true, true) => Identified::Yes,
            (false, false) => Identified::No,
            _ => Identified::OneSided,
        };
        let value = fit.values[i];
        Interval { value, low: ends.0.0.min(ends.1.0), high: ends.0.0.max(ends.1.0), identified }
    }
}
