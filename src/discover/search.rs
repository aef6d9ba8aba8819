//! Fitting one hypothesis: quasi-random samples over the ranges on a part of the points, the best of them followed on that
//! part, the best of these on all points.

use super::MARGIN;
use super::hypothesis::{Addition, Basis, Estimate, Hypothesis, extended};
use super::sampling::{Base, Hint, Sample, about, far_off, look, samples};
use crate::compare::scattered;
use crate::fit::{Fit, HUBER, Parameter, Problem, Settings, minimise, parameter, robust_chi2};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::cycle::Tolerance;

/// Points of the part on which a search begins, at least, and the largest stride along a curve.
const PART: usize = 75;
const STRIDE: usize = 5;
/// Tables up to this size are searched whole.
const SMALL: usize = 80;
/// Samples from which fits begin, for effects of one, two, three, four parameters: where the sum of squares jumps with a
/// parameter, only a start on the right side finds the minimum.
const BEGUN: [usize; 4] = [6, 4, 3, 3];
/// The same on a second look.
const BEGUN_AGAIN: usize = 8;
/// Samples of a continuum of sliders from which fits begin.
const COSTLY: usize = 2;
/// A fit begins from a sample as it was drawn only where that leaves less than this share of the sum of squares.
const AS_DRAWN: f64 = 0.8;
/// Evaluations of a fit that begins, of one that goes on, of one that goes to its end, and of one to all points.
const BEGIN: usize = 4;
const GO_ON: usize = 10;
const END: usize = 30;
const ALL: usize = 15;
/// Of the fits begun, so many go on, if within this factor of the best.
const GOING_ON: (usize, f64) = (2, 3.0);
/// Starts scattered over the ranges of all parameters, and how many of them are followed.
const ELSEWHERE: (u32, usize) = (48, 4);
/// So many of those have every parameter of their additions tried at so many values.
const SCAN: (usize, usize) = (2, 80);
/// Relative change of the sum of squares at which a fit to a part of the points is done, and one to all.
const CLOSE: f64 = 1e-4;
const CLOSER: f64 = 1e-6;

/// What a search works on.
pub struct Data<'a> {
    /// The model of the scenario, not calibrated.
    pub base: Model,
    /// All points.
    pub points: &'a [Point],
    /// A part of them, spread over every curve.
    pub part: Vec<&'a Point>,
    /// Residuals beyond this count linearly.
    pub threshold: f64,
    /// Values that the scenario states for the parameters that a calibration may move: once something is missing, the
    /// calibrated ones may be far off.
    pub stated: Vec<f64>,
    /// Seed of the samples.
    pub seed: u32,
}

impl<'a> Data<'a> {
    /// All points, and the part for searching: every so many-th of a curve, at another offset in the next.
    pub fn new(base: Model, points: &'a [Point], threshold: f64, stated: Vec<f64>, seed: u32) -> Self {
        let stride = if points.len() <= SMALL { 1 } else { (points.len() / PART).clamp(1, STRIDE) };
        let mut part = Vec::new();
        let (mut number, mut last) = (0, usize::MAX);
        for point in points {
            let condition = point.series;
            if condition != last {
                (number, last) = (condition % stride, condition);
            }
            if number % stride == 0 {
                part.push(point);
            }
            number += 1;
        }
        Self { base, points, part, threshold, stated, seed }
    }

    /// Readings in the part.
    pub fn part_readings(&self) -> usize {
        self.part.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum()
    }

    /// Parameters of these keys: those of an effect with the signs that the model has, all others about the values that the
    /// scenario states, wherever fits have carried them since.
    pub fn movable(&self, model: &Model, keys: &[String]) -> Vec<Parameter> {
        let of = |key: &String| parameter(if key.starts_with("effect.") { model } else { &self.base }, key);
        keys.iter().filter_map(of).collect()
    }
}

/// An addition at samples of its ranges, before any fit.
pub struct Explored {
    addition: Addition,
    /// The samples, the most promising first.
    starts: Vec<Sample>,
    /// Sum of squares over the part of the points before the addition, at the best that its parameters can do there.
    pub before: f64,
    /// The same with the threshold by which hypotheses are ranked.
    before_ranked: f64,
    /// The same after as much of one sample's change as is best, in a linear estimate.
    pub after: f64,
    /// Gain over all points that the addition needs to be accepted.
    needed: f64,
    scale: f64,
    visibility: f64,
    strongest: Vec<Model>,
    touched: Vec<bool>,
    /// Whether its points take long to solve: it makes the contact a continuum of sliders.
    pub costly: bool,
}

/// A search for the best fit of one hypothesis.
#[derive(Debug, Clone)]
pub struct Found {
    /// The fitted hypothesis (criterion not yet set).
    pub hypothesis: Hypothesis,
    /// Gain in the sum of squares, over all points, over what the addition needs to be accepted.
    pub gain: f64,
    /// Largest change that a plausible strength of the last addition makes to the predictions beyond what the parameters
    /// before it can imitate: sum of squares in standard deviations, over all points.
    pub visibility: f64,
    /// The sample with that change; all of them where none changes anything.
    pub strongest: Vec<Model>,
    /// Which points of the part it changes at all.
    pub touched: Vec<bool>,
}

/// Looks at samples of one more addition to a hypothesis, at its own values and at the `other` place; at few of them
/// `beside_noise`, where the hypothesis leaves nothing else.
pub fn explore(
    data: &Data<'_>,
    from: &Hypothesis,
    base: &Base<'_>,
    other: Option<&(Hypothesis, Base<'_>)>,
    addition: Addition,
    hint: Option<&Hint>,
    beside_noise: bool,
) -> Explored {
    let known = hint.map(|h| h.values.as_slice());
    let samples_of = |from: &Hypothesis| samples(data, &from.fitted(), addition, known, beside_noise);
    let samples = samples_of(from);
    let scale = data.points.len() as f64 / data.part.len() as f64;
    let rest = base.rest();
    let mut found = look(data, base, addition, &samples, hint);
    let costly = samples[0].has_continuum();
    if let Some((from, base)) = other.filter(|_| !costly) {
        found = found.and(look(data, base, addition, &samples_of(from), hint));
    }
    let readings = data.part_readings() as f64 * scale;
    Explored {
        addition,
        before: robust_chi2(&rest, data.threshold),
        before_ranked: robust_chi2(&rest, HUBER),
        after: found.after,
        needed: addition.keys().len() as f64 * readings.ln() + 3.0 * MARGIN,
        scale,
        visibility: found.visibility * scale,
        strongest: found.strongest,
        touched: found.touched,
        costly,
        starts: found.starts.into_iter().map(|(_, sample)| sample).collect(),
    }
}

impl Explored {
    /// Gain over all points, over what the addition needs to be accepted, where the sum of squares over the part comes to
    /// `reached`; less what its parameters gain on noise.
    pub fn gain(&self, reached: f64) -> f64 {
        self.scale * (self.before - reached - self.addition.keys().len() as f64) / self.needed
    }

    /// Fits to the part of the points, begun from the best samples; the best first.
    pub fn begin(&self, data: &Data<'_>, from: &Hypothesis) -> Vec<Attempt> {
        let begun = if self.costly { COSTLY } else { BEGUN[self.addition.keys().len().clamp(1, 4) - 1] };
        self.begin_at(data, from, &self.starts, begun)
    }

    /// Whether a second look may find what the first has missed: the samples of a single parameter are close enough.
    pub fn is_seen_again(&self) -> bool {
        self.addition.keys().len() > 1 && !self.costly
    }

    /// The better of an attempt and one begun from samples about it: the first may have ended in a local minimum.
    pub fn second_look(&self, data: &Data<'_>, from: &Hypothesis, attempt: Attempt) -> Attempt {
        let known = from.fit.values.len();
        let there = on_part(data, &attempt.model, attempt.fit.parameters.clone());
        let mut places = vec![attempt.fit.values[..known].to_vec()];
        if far_off(data, from) {
            let mut stated = places[0].clone();
            stated[..data.stated.len()].copy_from_slice(&data.stated);
            places.push(stated);
        }
        let mut best = attempt.clone();
        for place in places {
            let mut values = attempt.fit.values.clone();
            values[..known].copy_from_slice(&place);
            let mut near = from.clone();
            near.fit.values = place;
            let samples = about(data, &there.model(&values), self.addition);
            let starts = look(data, &Base::new(data, &near), self.addition, &samples, None).starts;
            let starts: Vec<Sample> = starts.into_iter().map(|(_, sample)| sample).collect();
            let other = lead(data, self.begin_at(data, &near, &starts, BEGUN_AGAIN)).map(|other| other.finished(data));
            best = other.filter(|other| other.fit.objective < best.fit.objective).unwrap_or(best);
        }
        best
    }

    fn begin_at(&self, data: &Data<'_>, from: &Hypothesis, starts: &[Sample], begun: usize) -> Vec<Attempt> {
        let keys = self.keys(from);
        let far = far_off(data, from);
        let mut attempts = Vec::new();
        for (rank, sample) in starts.iter().take(begun).enumerate() {
            let at = |model: &Model| Start::new(data, model, &keys);
            let (drawn, strengthened) = (at(&sample.drawn), sample.strengthened.as_ref().map(at));
            let base = drawn.values[..data.stated.len()].to_vec();
            let stated = if from.additions.is_empty() || far { data.stated.clone() } else { base.clone() };
            // Both where it costs little or the two are far apart, otherwise in turn.
            let places = match self.addition.keys().len() {
                count if stated != base && !self.costly && (count == 1 || far) => vec![base, stated.clone()],
                _ if rank % 2 == 1 => vec![stated.clone()],
                _ => vec![base],
            };
            for place in places {
                let mut start = self.better(data, drawn.at(&place), strengthened.as_ref().map(|s| s.at(&place)));
                // Far from there the base has taken the place of the addition, and would again.
                if far && place == stated && !self.costly {
                    start = start.alone(data, self.addition.keys().len());
                }
                let settings = Settings { evaluations: BEGIN, threshold: data.threshold, converged: CLOSE };
                let fit = minimise(&mut start.problem.clone(), &start.values, &settings);
                attempts.push(Attempt { model: start.model, fit });
            }
        }
        attempts.sort_by(|a, b| a.fit.objective.total_cmp(&b.fit.objective));
        attempts
    }

    /// Where a fit begins from a sample: as strong as a linear estimate wants it, or as it was drawn where that is better, and
    /// much better than nothing. A law that sets in with a jump is no matter for a linear estimate.
    fn better<'a>(&self, data: &Data<'a>, drawn: Start<'a>, strengthened: Option<Start<'a>>) -> Start<'a> {
        let Some(strengthened) = strengthened else { return drawn };
        if self.costly {
            return strengthened;
        }
        let as_drawn = drawn.square(data);
        if as_drawn < AS_DRAWN * self.before && as_drawn < strengthened.square(data) { drawn } else { strengthened }
    }

    fn keys(&self, from: &Hypothesis) -> Vec<String> {
        from.fit.parameters.iter().map(|p| p.key.clone()).chain(self.addition.keys()).collect()
    }

    /// What the best attempt has reached; without one, what a linear estimate says of the addition.
    pub fn found(&self, data: &Data<'_>, from: &Hypothesis, best: Option<Attempt>) -> Found {
        let mut additions = from.additions.clone();
        additions.push(self.addition);
        let known = best.is_some();
        let Attempt { model, fit } = best.unwrap_or_else(|| self.untouched(data, from));
        let before = robust_chi2(&from.fit.evaluation.residuals, HUBER);
        let (gain, estimate) = if known {
            // What counts is the change: which points are in the part is chance.
            let ranked = robust_chi2(&fit.evaluation.residuals, HUBER);
            (self.gain(fit.objective), (before - self.scale * (self.before_ranked - ranked)).max(0.0))
        } else {
            // Never better than what it is added to: nobody has seen it.
            (0.0, before * (self.after / self.before).min(1.0) + self.needed)
        };
        let basis = if known { Basis::SomePoints(fit.evaluation.predictions.len()) } else { Basis::Linear };
        let estimate = Some(Estimate { square: estimate, basis });
        let hypothesis = Hypothesis { additions, model, fit, estimate, bic: f64::INFINITY };
        let (strongest, touched) = (self.strongest.clone(), self.touched.clone());
        Found { hypothesis, gain, visibility: self.visibility, strongest, touched }
    }

    /// The hypothesis before, with an addition that was not followed: its parameters have no derivatives.
    fn untouched(&self, data: &Data<'_>, from: &Hypothesis) -> Attempt {
        let model = extended(&from.fitted(), &[self.addition]);
        let mut fit = from.fit.clone();
        fit.parameters = data.movable(&model, &self.keys(from));
        let none: [&Point; 0] = [];
        fit.values = Problem::new(model.clone(), none, fit.parameters.clone(), Tolerance::COARSE).values();
        let columns = fit.parameters.len();
        fit.evaluation.jacobian.resize_horizontally_mut(columns, 0.0);
        fit.termination = "not fitted: in a linear estimate it explains too little".into();
        Attempt { model, fit }
    }
}

/// Where a fit to the part of the points may begin.
#[derive(Clone)]
struct Start<'a> {
    model: Model,
    problem: Problem<'a>,
    values: Vec<f64>,
}

impl<'a> Start<'a> {
    fn new(data: &Data<'a>, model: &Model, keys: &[String]) -> Self {
        let problem = on_part(data, model, data.movable(model, keys));
        Self { model: model.clone(), values: problem.values(), problem }
    }

    /// The same with the base at these values.
    fn at(&self, base: &[f64]) -> Self {
        let mut start = self.clone();
        start.values[..base.len()].copy_from_slice(base);
        start
    }

    /// The same with the last `count` parameters fitted, the others where they are.
    fn alone(&self, data: &Data<'a>, count: usize) -> Self {
        let others = self.values.len() - count;
        let mut problem = self.problem.at(&self.values, self.problem.parameters()[others..].to_vec());
        let settings = Settings { evaluations: BEGIN, threshold: data.threshold, converged: CLOSE };
        let fit = minimise(&mut problem, &self.values[others..], &settings);
        let mut start = self.clone();
        start.values[others..].copy_from_slice(&fit.values);
        start
    }

    fn square(&self, data: &Data<'_>) -> f64 {
        robust_chi2(&self.problem.clone().evaluate(&self.values, false).residuals, data.threshold)
    }
}

/// A fit of one more addition to the part of the points, from one sample of its ranges.
#[derive(Clone)]
pub struct Attempt {
    model: Model,
    /// How far it has come.
    pub fit: Fit,
}

impl Attempt {
    fn continued(self, data: &Data<'_>, evaluations: usize) -> Self {
        let mut problem = on_part(data, &self.model, self.fit.parameters.clone());
        let settings = Settings { evaluations, threshold: data.threshold, converged: CLOSE };
        let fit = minimise(&mut problem, &self.fit.values, &settings);
        Self { fit, ..self }
    }

    /// Brought to its end on the part of the points.
    pub fn finished(self, data: &Data<'_>) -> Self {
        self.continued(data, END)
    }
}

/// The best of attempts, the leading ones taken some steps on.
pub fn lead(data: &Data<'_>, attempts: Vec<Attempt>) -> Option<Attempt> {
    let best = attempts.first()?.fit.objective;
    let (most, within) = GOING_ON;
    let leading = attempts.into_iter().take(most).filter(|a| a.fit.objective <= within * best);
    let continued = leading.map(|a| a.continued(data, GO_ON));
    continued.min_by(|a, b| a.fit.objective.total_cmp(&b.fit.objective))
}

/// A part of the points at the accuracy of a search.
pub fn on_part<'a>(data: &Data<'a>, model: &Model, parameters: Vec<Parameter>) -> Problem<'a> {
    Problem::new(model.clone(), data.part.iter().copied(), parameters, Tolerance::COARSE)
}

/// All points at the accuracy at which hypotheses are ranked.
pub fn on_all_problem<'a>(data: &Data<'a>, model: &Model, parameters: Vec<Parameter>) -> Problem<'a> {
    Problem::new(model.clone(), data.points, parameters, Tolerance::FIT)
}

/// The fit followed on all points at full accuracy.
pub fn on_all(data: &Data<'_>, model: &Model, fit: &Fit) -> Fit {
    let mut problem = on_all_problem(data, model, fit.parameters.clone());
    let evaluations = if model.has_continuum() { GO_ON } else { ALL };
    minimise(&mut problem, &fit.values, &Settings { evaluations, threshold: data.threshold, converged: CLOSER })
}

/// Moves every parameter of the additions in turn to the best of so many values over its range: a narrow resonance is no
/// valley that a fit could follow.
fn scan(data: &Data<'_>, problem: &mut Problem<'_>, (square, start): (&mut f64, &mut Vec<f64>), values: usize) {
    for index in data.stated.len()..start.len() {
        let parameter = problem.parameters()[index].clone();
        let mut moved = start.clone();
        for number in 0..values {
            moved[index] = parameter.within((number as f64 + 0.5) / values as f64);
            let found = robust_chi2(&problem.evaluate(&moved, false).residuals, data.threshold);
            if found < *square {
                (*square, start[index]) = (found, moved[index]);
            }
        }
    }
}

/// A fit from starts scattered over the ranges of its parameters, of either sign where there are two, begun on the part
/// of the points and followed on all; the model with the signs it ends with. `None` where on that part it does not come below
/// `aim`, and for a continuum of sliders, which takes too long.
pub fn scattered_fit(data: &Data<'_>, model: &Model, fit: &Fit, aim: f64) -> Option<(Model, Fit)> {
    if model.has_continuum() {
        return None;
    }
    let (count, followed) = ELSEWHERE;
    let start = |number: u32| {
        let turn = |p: &Parameter| if p.signed && number % 2 == 1 { p.mirrored() } else { p.clone() };
        let parameters: Vec<Parameter> = fit.parameters.iter().map(turn).collect();
        let mut values = scattered(&parameters, number, data.seed);
        // Every other pair of them with the base as it is stated.
        if (number / 2).is_multiple_of(2) {
            values[..data.stated.len()].copy_from_slice(&data.stated);
        }
        let problem = on_part(data, model, parameters);
        // Where the base makes room for it: of a strong effect beside a base that has taken its place, nothing else is seen.
        let count = data.stated.len();
        let mut base = problem.at(&values, problem.parameters()[..count].to_vec());
        let settings = Settings { evaluations: BEGIN, threshold: data.threshold, converged: CLOSE };
        let room = minimise(&mut base, &values[..count], &settings);
        values[..count].copy_from_slice(&room.values);
        (room.objective, problem, values)
    };
    let mut tried: Vec<(f64, Problem<'_>, Vec<f64>)> = (0..count).map(start).collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (scanned, values) = SCAN;
    tried.iter_mut().take(scanned).for_each(|(square, problem, start)| scan(data, problem, (square, start), values));
    let settings = Settings { evaluations: END, threshold: data.threshold, converged: CLOSE };
    let ends = tried.iter_mut().take(followed).map(|(_, problem, start)| minimise(problem, start, &settings));
    let best = ends.min_by(|a, b| a.objective.total_cmp(&b.objective)).filter(|best| best.objective < aim)?;
    let model = on_part(data, model, best.parameters.clone()).model(&best.values);
    let fit = on_all(data, &model, &best);
    Some((model, fit))
}
