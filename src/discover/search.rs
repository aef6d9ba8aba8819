//! Fitting one hypothesis: quasi-random samples over the ranges on a part of the points, the best of them followed on that
//! part, the best of these on all points.

use super::MARGIN;
use super::hypothesis::{Addition, Hypothesis, extended};
use crate::fit::{Evaluation, Fit, HUBER, Parameter, Problem, Settings, minimise, parameter, robust_chi2};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::cycle::Tolerance;
use nalgebra::{DMatrix, DVector};

/// Points of the part on which a search begins, at least, and the largest stride along a curve.
const PART: usize = 75;
const STRIDE: usize = 5;
/// Tables up to this size are searched whole.
const SMALL: usize = 80;
/// Samples over the ranges of an effect of one, two, three, four parameters.
const SAMPLES: [usize; 4] = [8, 14, 18, 20];
/// Samples where values are known that are worth a look.
const WITH_HINT: usize = 6;
/// Samples from which fits begin, for effects of one, two, three, four parameters: where the sum of squares jumps with a
/// parameter, only a start on the right side finds the minimum.
const BEGUN: [usize; 4] = [6, 4, 3, 3];
/// Samples of a continuum of sliders from which fits begin.
const COSTLY: usize = 2;
/// Evaluations of a fit that begins, of one that goes on, of one that goes to its end, and of one to all points.
const BEGIN: usize = 4;
const GO_ON: usize = 10;
const END: usize = 30;
const ALL: usize = 15;
/// Of the fits begun, so many go on, if within this factor of the best.
const GOING_ON: (usize, f64) = (2, 3.0);
/// Relative change of the sum of squares at which a fit to a part of the points is done, and one to all.
const CLOSE: f64 = 1e-4;
const CLOSER: f64 = 1e-6;

/// Accuracy of a fit to all points: errors of 1e-5, but points that are hard to solve are given up before long.
const ON_ALL: Tolerance = Tolerance { steps: 24, roughness: 1e-3, cycles: 100, budget: 3000 };
/// Change of a residual, in standard deviations, below which a point counts as left alone.
const UNTOUCHED: f64 = 0.1;
/// What a search works on.
pub struct Data<'a> {
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
    pub fn new(points: &'a [Point], of_condition: &[usize], threshold: f64, stated: Vec<f64>, seed: u32) -> Self {
        let stride = if points.len() <= SMALL { 1 } else { (points.len() / PART).clamp(1, STRIDE) };
        let mut part = Vec::new();
        let (mut number, mut last) = (0, usize::MAX);
        for (point, &condition) in points.iter().zip(of_condition) {
            if condition != last {
                (number, last) = (condition % stride, condition);
            }
            if number % stride == 0 {
                part.push(point);
            }
            number += 1;
        }
        Self { points, part, threshold, stated, seed }
    }
}

/// What an earlier search of an addition tells a later one.
#[derive(Debug, Clone)]
pub struct Hint {
    /// Values of its parameters that are worth a look.
    pub values: Vec<f64>,
    /// Which points of the part it changes at all.
    pub touched: Vec<bool>,
}

/// An addition at samples of its ranges, before any fit.
pub struct Explored {
    addition: Addition,
    /// The samples, each as strong as a linear estimate wants it, the most promising first.
    starts: Vec<Model>,
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
    strongest: Option<Model>,
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
    /// The sample with that change.
    pub strongest: Option<Model>,
    /// Which points of the part it changes at all.
    pub touched: Vec<bool>,
}

/// Looks at samples of one more addition to `from`. Points that the hint says it leaves alone are not solved again.
pub fn explore(data: &Data<'_>, from: &Hypothesis, base: &Base, addition: Addition, hint: Option<&Hint>) -> Explored {
    let samples = samples(&from.fitted(), addition, data.seed, hint.map(|h| h.values.as_slice()));
    let scale = data.points.len() as f64 / data.part.len() as f64;
    let rest = base.without(&base.evaluation.residuals);
    let rows = rows(&data.part);
    let mut touched = vec![false; data.part.len()];
    let before = robust_chi2(&rest, data.threshold);
    let (mut visibility, mut strongest, mut after) = (0.0, None, before);
    let costly = on_part(data, &samples[0], Vec::new()).has_continuum();
    let mut tried: Vec<(f64, Model)> = Vec::new();
    for model in &samples {
        let residuals = residuals(data, model, base, hint);
        for (touched, rows) in touched.iter_mut().zip(&rows) {
            *touched |= rows.clone().any(|r| (residuals[r] - base.evaluation.residuals[r]).abs() > UNTOUCHED);
        }
        let change = base.without(&(&residuals - &base.evaluation.residuals));
        let size = change.norm_squared();
        let as_it_is = robust_chi2(&base.without(&residuals), data.threshold);
        let (mut least, mut best) = (as_it_is, model.clone());
        if size > 0.0 {
            // As much of the change as the sum of squares wants.
            let share = (-rest.dot(&change) / size).max(0.0);
            let scaled = robust_chi2(&(&rest + &change * share), data.threshold);
            if scaled < least {
                (least, best) = (scaled, strengthened(model, addition, share));
            }
        }
        after = after.min(least);
        if size * scale > visibility {
            (visibility, strongest) = (size * scale, Some(model.clone()));
        }
        tried.push((least, best));
    }
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let readings = base.evaluation.residuals.len() as f64 * scale;
    Explored {
        addition,
        starts: tried.into_iter().map(|(_, model)| model).collect(),
        before,
        before_ranked: robust_chi2(&rest, HUBER),
        after,
        needed: addition.keys().len() as f64 * readings.ln() + 3.0 * MARGIN,
        scale,
        visibility,
        strongest,
        touched,
        costly,
    }
}

/// The model with the strength of the addition times `share`, within its bounds; as it is where its law states no single
/// strength that vanishes with the effect.
fn strengthened(model: &Model, addition: Addition, share: f64) -> Model {
    let Addition::Effect(effect) = addition else { return model.clone() };
    let [zero] = effect.zero() else { return model.clone() };
    let key = &addition.keys()[zero.parameter];
    let step = match zero.value {
        0.0 => share.ln(),
        f64::INFINITY => -share.ln(),
        _ => 0.0,
    };
    match parameter(model, key) {
        Some(strength) if step.is_finite() => {
            let none: [&Point; 0] = [];
            let problem = Problem::new(model.clone(), none, vec![strength.clone()], Tolerance::COARSE);
            problem.model(&[strength.moved(problem.values()[0], step)])
        }
        _ => model.clone(),
    }
}

/// Rows of the residuals that belong to each point.
fn rows(points: &[&Point]) -> Vec<std::ops::Range<usize>> {
    let mut next = 0;
    let mut range = |point: &&Point| {
        let start = next;
        next += 1 + usize::from(point.phase.is_some());
        start..next
    };
    points.iter().map(&mut range).collect()
}

/// Residuals of a model on the part of the points, those of `base` where the hint says that nothing changes.
fn residuals(data: &Data<'_>, model: &Model, base: &Base, hint: Option<&Hint>) -> DVector<f64> {
    let Some(hint) = hint else { return on_part(data, model, Vec::new()).evaluate(&[], false).residuals };
    let points = data.part.iter().zip(&hint.touched).filter(|(_, touched)| **touched).map(|(point, _)| *point);
    let solved = Problem::new(model.clone(), points, Vec::new(), Tolerance::COARSE).evaluate(&[], false).residuals;
    let mut all = base.evaluation.residuals.clone();
    let mut next = 0;
    for (range, _) in rows(&data.part).into_iter().zip(&hint.touched).filter(|(_, touched)| **touched) {
        for row in range {
            all[row] = solved[next];
            next += 1;
        }
    }
    all
}

impl Explored {
    /// Gain over all points, over what the addition needs to be accepted, where the sum of squares over the part comes to
    /// `reached`; less what its parameters gain on noise.
    pub fn gain(&self, reached: f64) -> f64 {
        self.scale * (self.before - reached - self.addition.keys().len() as f64) / self.needed
    }

    /// Fits to the part of the points, begun from the best samples; the best first.
    pub fn begin(&self, data: &Data<'_>, from: &Hypothesis) -> Vec<Attempt> {
        let keys = self.keys(from);
        let begun = if self.costly { COSTLY } else { BEGUN[self.addition.keys().len().clamp(1, 4) - 1] };
        let mut attempts = Vec::new();
        for (rank, model) in self.starts.iter().take(begun).enumerate() {
            let problem = on_part(data, model, movable(model, &keys));
            let calibrated = problem.values();
            let mut stated = calibrated.clone();
            if from.additions.is_empty() {
                stated[..data.stated.len()].copy_from_slice(&data.stated);
            }
            // Both where it costs little, otherwise in turn.
            let starts = match self.addition.keys().len() {
                1 if stated != calibrated && !self.costly => vec![calibrated, stated],
                _ if rank % 2 == 1 => vec![stated],
                _ => vec![calibrated],
            };
            for start in starts {
                let settings = Settings { evaluations: BEGIN, threshold: data.threshold, converged: CLOSE };
                let fit = minimise(&mut problem.clone(), &start, &settings);
                attempts.push(Attempt { model: model.clone(), fit });
            }
        }
        attempts.sort_by(|a, b| a.fit.objective.total_cmp(&b.fit.objective));
        attempts
    }

    fn keys(&self, from: &Hypothesis) -> Vec<String> {
        from.fit.parameters.iter().map(|p| p.key.clone()).chain(self.addition.keys()).collect()
    }

    /// What the best attempt has reached; without one, what a linear estimate says of the addition.
    pub fn found(&self, from: &Hypothesis, best: Option<Attempt>) -> Found {
        let mut additions = from.additions.clone();
        additions.push(self.addition);
        let known = best.is_some();
        let Attempt { model, fit } = best.unwrap_or_else(|| self.untouched(from));
        let before = robust_chi2(&from.fit.evaluation.residuals, HUBER);
        let (gain, estimate) = if known {
            // What counts is the change: which points are in the part is chance.
            let ranked = robust_chi2(&fit.evaluation.residuals, HUBER);
            (self.gain(fit.objective), (before - self.scale * (self.before_ranked - ranked)).max(0.0))
        } else {
            // Never better than what it is added to: nobody has seen it.
            (0.0, before * (self.after / self.before).min(1.0) + self.needed)
        };
        let hypothesis = Hypothesis { additions, model, fit, estimate: Some(estimate), bic: f64::INFINITY };
        let (strongest, touched) = (self.strongest.clone(), self.touched.clone());
        Found { hypothesis, gain, visibility: self.visibility, strongest, touched }
    }

    /// The hypothesis before, with an addition that was not followed: its parameters have no derivatives.
    fn untouched(&self, from: &Hypothesis) -> Attempt {
        let model = extended(&from.fitted(), &[self.addition]);
        let mut fit = from.fit.clone();
        fit.parameters = movable(&model, &self.keys(from));
        let none: [&Point; 0] = [];
        fit.values = Problem::new(model.clone(), none, fit.parameters.clone(), Tolerance::COARSE).values();
        let columns = fit.parameters.len();
        fit.evaluation.jacobian.resize_horizontally_mut(columns, 0.0);
        fit.termination = "not fitted: in a linear estimate it explains too little".into();
        Attempt { model, fit }
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

fn on_part<'a>(data: &Data<'a>, model: &Model, parameters: Vec<Parameter>) -> Problem<'a> {
    Problem::new(model.clone(), data.part.iter().copied(), parameters, Tolerance::COARSE)
}

/// All points at the accuracy at which hypotheses are ranked.
pub fn on_all_problem<'a>(data: &Data<'a>, model: &Model, parameters: Vec<Parameter>) -> Problem<'a> {
    Problem::new(model.clone(), data.points, parameters, ON_ALL)
}

/// The fit followed on all points at full accuracy.
pub fn on_all(data: &Data<'_>, model: &Model, fit: &Fit) -> Fit {
    let mut problem = on_all_problem(data, model, fit.parameters.clone());
    let evaluations = if problem.has_continuum() { GO_ON } else { ALL };
    minimise(&mut problem, &fit.values, &Settings { evaluations, threshold: data.threshold, converged: CLOSER })
}

/// Parameters of these keys, with the signs that the model has.
pub fn movable(model: &Model, keys: &[String]) -> Vec<Parameter> {
    keys.iter().filter_map(|key| parameter(model, key)).collect()
}

/// Models with the addition at samples of its ranges.
fn samples(before: &Model, addition: Addition, seed: u32, hint: Option<&[f64]>) -> Vec<Model> {
    let model = extended(before, &[addition]);
    let parameters = movable(&model, &addition.keys());
    let none: [&Point; 0] = [];
    let with = |parameters: Vec<Parameter>, values: &[f64]| {
        Problem::new(model.clone(), none, parameters, Tolerance::COARSE).model(values)
    };
    if let Addition::Recalibration(_) = addition {
        // The stated value, and a little to either side.
        let value = Problem::new(model.clone(), none, parameters.clone(), Tolerance::COARSE).values();
        return [-0.05, 0.05]
            .iter()
            .map(|step| with(parameters.clone(), &[parameters[0].moved(value[0], *step)]))
            .collect();
    }
    let mut all: Vec<Model> = hint.map(|values| with(parameters.clone(), values)).into_iter().collect();
    let most = SAMPLES[parameters.len().clamp(1, 4) - 1];
    let count = if hint.is_some() { most.min(WITH_HINT) } else { most };
    for number in 0..count as u32 {
        let shares: Vec<f64> = if parameters.len() == 1 {
            vec![(f64::from(number) + 0.5) / count as f64]
        } else {
            (0..parameters.len()).map(|d| f64::from(sobol_burley::sample(number, d as u32, seed))).collect()
        };
        let signed = parameters.iter().any(|p| p.signed);
        for negative in [false, true].into_iter().take(1 + usize::from(signed)) {
            let turned: Vec<Parameter> =
                parameters.iter().map(|p| if p.signed && negative { p.mirrored() } else { p.clone() }).collect();
            let values: Vec<f64> = turned.iter().zip(&shares).map(|(p, &share)| p.within(share)).collect();
            all.push(with(turned, &values));
        }
    }
    all
}

/// The hypothesis that a search starts from, on the part of the points.
pub struct Base {
    evaluation: Evaluation,
    /// Orthonormal columns that span what its parameters can do.
    span: DMatrix<f64>,
}

impl Base {
    /// Its residuals and what its parameters can do.
    pub fn new(data: &Data<'_>, from: &Hypothesis) -> Self {
        let mut problem =
            Problem::new(from.model.clone(), data.part.iter().copied(), from.fit.parameters.clone(), Tolerance::COARSE);
        let evaluation = problem.evaluate(&from.fit.values, true);
        let svd = evaluation.jacobian.clone().svd(true, false);
        let largest = svd.singular_values.iter().copied().fold(0.0, f64::max);
        let columns: Vec<usize> =
            (0..svd.singular_values.len()).filter(|&i| svd.singular_values[i] > 1e-9 * largest).collect();
        let span = match &svd.u {
            Some(u) if !columns.is_empty() => u.select_columns(&columns),
            _ => DMatrix::zeros(evaluation.residuals.len(), 0),
        };
        Self { evaluation, span }
    }

    /// A change of the residuals less what the parameters could undo.
    fn without(&self, change: &DVector<f64>) -> DVector<f64> {
        if self.span.ncols() == 0 {
            return change.clone();
        }
        change - &self.span * (self.span.transpose() * change)
    }
}
