//! A look at one more addition before any fit: at starting points over its ranges, and how much of the misfit each
//! would take off in a linear estimate.

pub mod motion;

use super::data::{Data, readings};
use super::hypothesis::{Addition, Hypothesis, extended};
use crate::effects::Effect;
use crate::fit::{
    Evaluation, Parameter, Prediction, Problem, TAIL, model_with, parameter, robust_chi2, typical_of, values_in,
};
use crate::fit::{placed, resonance};
use crate::linear::{least_squares, svd};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::cycle::Tolerance;
use crate::statistics::wrap;
use nalgebra::{Complex, DMatrix, DVector, SVD};

/// Singular values below this share of the largest count as none.
const SINGULAR: f64 = 1e-9;
/// Turns in which what scales all readings and what is read beside come near to each other.
const TURNS: usize = 20;

/// A hypothesis to which something may be added, on some of the points.
pub struct Parent<'a> {
    model: Model,
    problem: Problem<'a>,
    evaluation: Evaluation,
    /// Orthonormal columns that span what its parameters can do.
    span: DMatrix<f64>,
    /// Whether only what is read beside the motion is looked for from there.
    beside: bool,
}

impl<'a> Parent<'a> {
    /// The hypothesis at these values of its parameters.
    pub fn new(data: &Data<'a>, from: &Hypothesis, values: Vec<f64>, points: usize) -> Self {
        let parameters = from.fit.parameters.clone();
        let mut problem = Problem::new(from.model.clone(), data.some(points), parameters, Tolerance::COARSE);
        let evaluation = problem.evaluate(&values, true);
        data.count(problem.solved);
        let rows = evaluation.residuals.len();
        let mut span = DMatrix::zeros(rows, 0);
        if evaluation.jacobian.ncols() > 0 {
            // By natural steps of the parameters: their units are no matter.
            let mut jacobian = evaluation.jacobian.clone();
            for (column, (parameter, &value)) in from.fit.parameters.iter().zip(&values).enumerate() {
                jacobian.column_mut(column).scale_mut(parameter.natural_slope(value));
            }
            if let Some(SVD { u: Some(u), singular_values, .. }) = svd(jacobian) {
                let least = SINGULAR * singular_values.max();
                let seen: Vec<usize> = (0..singular_values.len()).filter(|&i| singular_values[i] > least).collect();
                span = u.select_columns(&seen);
            }
        }
        Self { model: problem.model(&values), problem, evaluation, span, beside: false }
    }

    /// The same, for nothing but what is read beside the motion.
    pub fn for_what_is_read_beside(self) -> Self {
        Self { beside: true, ..self }
    }

    /// Residuals at the best that the parameters can do, in a linear estimate.
    pub fn rest(&self) -> DVector<f64> {
        self.without(&self.evaluation.residuals)
    }

    /// A model at its points.
    fn evaluated(&self, data: &Data<'_>, model: &Model) -> Evaluation {
        let mut problem = self.problem.of(model.clone());
        let evaluation = problem.evaluate(&[], false);
        data.count(problem.solved);
        evaluation
    }

    /// The model, which has one more addition and leaves this, with the resonance that the hypothesis has.
    fn kept(&self, model: &Model, from: &Hypothesis, evaluation: &Evaluation) -> Option<Model> {
        let free: Vec<String> = from.fit.parameters.iter().map(|p| p.key.clone()).collect();
        let read = |evaluation: &Evaluation| -> Vec<Point> {
            let pairs = self.problem.points().iter().zip(&evaluation.predictions);
            let steady = pairs.filter(|(_, prediction)| prediction.status.is_steady());
            steady.map(|(point, prediction)| predicted(point, prediction)).collect()
        };
        placed::kept(model, &free, &read(&self.evaluation), &read(evaluation))
    }

    /// Changes of stiffness and gain, beside those of the first series, with which the model would have the resonance
    /// that the readings of so many others have; none of what is not seen.
    fn of_series(&self, others: usize) -> Vec<f64> {
        let order = self.model.signals.reading.order;
        let ratios = |series: usize| -> Option<(f64, f64)> {
            let pairs = self.problem.points().iter().zip(&self.evaluation.predictions);
            let own = pairs.filter(|(point, prediction)| point.series == series && prediction.status.is_steady());
            let (measured, modelled): (Vec<&Point>, Vec<Point>) =
                own.map(|(point, prediction)| (*point, predicted(point, prediction))).unzip();
            let measured = resonance::resonance(&measured, order)?;
            let modelled = resonance::resonance(&modelled.iter().collect::<Vec<_>>(), order)?;
            Some(((measured.frequency / modelled.frequency).powi(2), measured.peak / modelled.peak))
        };
        let first = ratios(0);
        let of = |series: usize| {
            let both = ratios(series).zip(first);
            both.map_or([0.0; 2], |(own, first)| [own.0 / first.0 - 1.0, own.1 / first.1 - 1.0])
        };
        (1..=others).flat_map(of).collect()
    }

    /// The model with an effect that is read beside the motion, of the strengths with which the readings are nearest in
    /// the complex plane, where it is linear in them and in what scales and turns all readings; `None` where phases are
    /// missing.
    fn with_read_beside(&self, data: &Data<'_>, from: &Hypothesis, addition: Addition) -> Option<Model> {
        let Addition::Effect(effect) = addition else { return None };
        let points = self.problem.points();
        let measured: Option<Vec<Complex<f64>>> =
            points.iter().map(|point| Some(Complex::from_polar(point.amplitude, point.phase?))).collect();
        let measured = measured.filter(|_| effect.is_read_beside())?;
        let free: Vec<String> = from.fit.parameters.iter().map(|p| p.key.clone()).collect();
        let mut model = extended(&self.model, &[addition]);
        // First both in turn; what scales the readings may scale the strengths, which are then found again.
        let (_, scale) = self.nearest(data, &model, &measured, TURNS)?;
        model = placed::scaled(&model, &free, scale.norm());
        if free.iter().any(|key| key == placed::PHASE) {
            model.instrument.phase_offset = wrap(model.instrument.phase_offset + scale.arg());
        }
        let (strengths, _) = self.nearest(data, &model, &measured, 1)?;
        model.effects.last_mut()?.1 = strengths;
        Some(model)
    }

    /// The strengths of the last effect with which a model is nearest to readings in the complex plane, and the factor
    /// that takes it nearest then, each in so many turns.
    fn nearest(
        &self,
        data: &Data<'_>,
        model: &Model,
        measured: &[Complex<f64>],
        turns: usize,
    ) -> Option<(Vec<f64>, Complex<f64>)> {
        let mut model = model.clone();
        let sizes = model.effects.last()?.1.clone();
        let mut read = |values: Vec<f64>| -> Vec<Complex<f64>> {
            model.effects.last_mut().into_iter().for_each(|(_, own)| own.clone_from(&values));
            let predicted = |p: &Prediction| Complex::from_polar(p.amplitude, p.phase);
            self.evaluated(data, &model).predictions.iter().map(predicted).collect()
        };
        let none = read(vec![0.0; sizes.len()]);
        let of = |k: usize| sizes.iter().enumerate().map(|(at, size)| if at == k { *size } else { 0.0 }).collect();
        let each: Vec<Vec<Complex<f64>>> = (0..sizes.len()).map(|k| read(of(k))).collect();
        // Where the model has no steady state nothing is known.
        let seen: Vec<usize> = (0..none.len()).filter(|at| none[*at].is_finite()).collect();
        let part = |row: usize, value: Complex<f64>| if row.is_multiple_of(2) { value.re } else { value.im };
        let rows = 2 * seen.len();
        let of_strength = |row: usize, k: usize| each[k][seen[row / 2]] - none[seen[row / 2]];
        let matrix = DMatrix::from_fn(rows, sizes.len(), |row, k| part(row, of_strength(row, k)));
        let (mut scale, mut shares) = (Complex::ONE, DVector::zeros(sizes.len()));
        for _ in 0..turns {
            let left = |at: usize| measured[at] / scale - none[at];
            let right = DVector::from_fn(rows, |row, _| part(row, left(seen[row / 2])));
            shares = least_squares(matrix.clone(), &right, SINGULAR)?;
            let with = |row: usize| {
                none[seen[row]] + (0..shares.len()).map(|k| of_strength(2 * row, k) * shares[k]).sum::<Complex<f64>>()
            };
            let all: Vec<Complex<f64>> = (0..seen.len()).map(with).collect();
            let square: f64 = all.iter().map(Complex::norm_sqr).sum();
            scale = seen.iter().zip(&all).map(|(at, with)| with.conj() * measured[*at]).sum::<Complex<f64>>() / square;
        }
        let strengths = sizes.iter().zip(shares.iter()).map(|(size, share)| size * share).collect();
        (shares.iter().all(|share| share.is_finite()) && scale.is_finite()).then_some((strengths, scale))
    }

    /// A starting point: the model, which has one more addition and leaves this, or as much of the addition as the sum
    /// of squares wants; and the sum of squares of what the addition changes beyond what the parameters could.
    fn start(
        &self,
        data: &Data<'_>,
        from: &Hypothesis,
        addition: Addition,
        (model, evaluation): (&Model, &Evaluation),
    ) -> (Start, f64) {
        let values = |model: &Model| values_in(model, &data.beside(model, from, addition));
        let rest = self.rest();
        let change = self.without(&(&evaluation.residuals - &self.evaluation.residuals));
        let drawn = self.without(&evaluation.residuals);
        let size = change.norm_squared();
        if size > 0.0 {
            let share = (-rest.dot(&change) / size).max(0.0);
            let scaled = &rest + &change * share;
            let threshold = TAIL * typical_of(&rest);
            let better = robust_chi2(&scaled, threshold) < robust_chi2(&drawn, threshold);
            let strengthened = better.then(|| strengthened(&self.model, model, addition, share)).flatten();
            if let Some(model) = strengthened {
                return (Start { values: values(&model), model, residuals: scaled }, size);
            }
        }
        (Start { values: values(model), model: model.clone(), residuals: drawn }, size)
    }

    /// A change of the residuals less what the parameters could undo.
    fn without(&self, change: &DVector<f64>) -> DVector<f64> {
        if self.span.ncols() == 0 {
            return change.clone();
        }
        change - &self.span * (self.span.transpose() * change)
    }
}

/// What would be read at a point if the model were right.
fn predicted(point: &Point, prediction: &Prediction) -> Point {
    Point { amplitude: prediction.amplitude, phase: point.phase.map(|_| prediction.phase), ..point.clone() }
}

/// A starting point of an addition.
pub struct Start {
    /// The model with the addition, at the signs of its start.
    pub model: Model,
    /// Values of all parameters.
    pub values: Vec<f64>,
    /// Residuals there, in a linear estimate.
    pub residuals: DVector<f64>,
}

/// What a look saw.
pub struct Look {
    /// Starting points.
    pub starts: Vec<Start>,
    /// Largest change that any of them makes beyond what the parameters before can imitate: sum of squares, over all
    /// points.
    pub visibility: f64,
    /// The model with that change; all of them where none changes anything.
    pub strongest: Vec<Model>,
}

/// Looks at starting points of an addition, in turn from the places where its parent may be.
pub fn look(data: &Data<'_>, parents: &[Parent<'_>], from: &Hypothesis, addition: Addition, count: Count<'_>) -> Look {
    let mut found = Look { starts: Vec::new(), visibility: 0.0, strongest: Vec::new() };
    let others = parents.iter().filter(|parent| !parent.beside);
    let sampled = count.samples(from, addition).into_iter().zip(others.cycle());
    let sampled = sampled.map(|(shares, parent)| (parent, shares.of(data, parent, addition)));
    let beside = parents.iter().filter_map(|parent| Some((parent, parent.with_read_beside(data, from, addition)?)));
    let nearest = count.asked.map(|model| (&parents[0], model.clone())).into_iter().chain(beside);
    for (parent, model) in nearest.chain(sampled) {
        let evaluation = parent.evaluated(data, &model);
        let (start, size) = parent.start(data, from, addition, (&model, &evaluation));
        found.starts.push(start);
        // An effect may be a part of what was taken for the rig.
        let kept = if addition.is_effect() { parent.kept(&model, from, &evaluation) } else { None };
        found.starts.extend(kept.map(|model| {
            let evaluation = parent.evaluated(data, &model);
            parent.start(data, from, addition, (&model, &evaluation)).0
        }));
        if size > found.visibility {
            (found.visibility, found.strongest) = (size, vec![model]);
        } else {
            found.strongest.push(model);
        }
    }
    if found.visibility > 0.0 {
        found.strongest.drain(1..);
    }
    let seen = readings(parents[0].problem.points().iter().copied()).max(1);
    found.visibility *= data.readings() as f64 / seen as f64;
    found
}

/// Which starting points.
#[derive(Debug, Clone, Copy)]
pub struct Count<'k> {
    /// The model with the addition as it was fitted beside something else.
    pub known: Option<&'k Model>,
    /// The same as the readings ask for it at the motion that was measured.
    pub asked: Option<&'k Model>,
    /// How many for each of its parameters.
    pub starts: usize,
    /// Parents that share them.
    pub shared: usize,
    /// Which part of the sequence.
    pub turn: usize,
    /// Seed of the sequence.
    pub seed: u32,
}

/// A starting point as shares of the ranges of an addition, or as values.
enum Sample {
    Known(Vec<f64>),
    /// Shares of the ranges, and which of the parameters of either sign are negative, a bit for each.
    Shares(Vec<f64>, usize),
    Step(f64),
    Resonance,
    /// Numbers of each series as its resonance in the readings differs from that in the model, ...
    OfSeries,
    /// ... or the smallest that are looked for.
    Smallest,
}

impl Count<'_> {
    fn samples(&self, from: &Hypothesis, addition: Addition) -> Vec<Sample> {
        if let Addition::Recalibration(_) = addition {
            // The stated value, a little to either side, and where the resonance of the readings puts it: a sensor may
            // be inverted, a gain off by any factor.
            return vec![Sample::Step(-0.05), Sample::Step(0.05), Sample::Resonance];
        }
        if matches!(addition, Addition::Effect(effect) if effect.of_series().is_some()) {
            return vec![Sample::OfSeries, Sample::Smallest];
        }
        let model = extended(&from.model, &[addition]);
        let own: Vec<Parameter> = addition.keys().iter().filter_map(|key| parameter(&model, key)).collect();
        let signs = 1 << own.iter().filter(|p| p.signed && !model.hides_sign(model.effects.len() - 1)).count();
        let count = (self.starts * own.len() / self.shared).max(2);
        let shares = |number: usize| -> Vec<f64> {
            match own.len() {
                1 => vec![radical(number + 1)],
                n => (0..n as u32).map(|d| f64::from(sobol_burley::sample(number as u32, d, self.seed))).collect(),
            }
        };
        // All signs of a point before the next one.
        let of = |i: usize| Sample::Shares(shares(i / signs), i % signs);
        let known = self.known.and_then(|model| {
            let Addition::Effect(effect) = addition else { return None };
            let (_, values) = model.effects.iter().find(|(e, _)| e.name() == effect.name())?;
            Some(Sample::Known(values.clone()))
        });
        let count = if model.has_sliders() && known.is_some() { 0 } else { count };
        known.into_iter().chain((self.turn * count..(self.turn + 1) * count).map(of)).collect()
    }
}

impl Sample {
    /// The model with the addition there.
    fn of(&self, data: &Data<'_>, parent: &Parent<'_>, addition: Addition) -> Model {
        let model = extended(&parent.model, &[addition]);
        let parameters: Vec<Parameter> = addition.keys().iter().filter_map(|key| parameter(&model, key)).collect();
        let stated = values_in(&model, &parameters);
        match self {
            Self::Known(values) => {
                let mut model = model;
                if let Some((_, own)) = model.effects.last_mut() {
                    own.clone_from(values);
                }
                model
            }
            Self::Shares(shares, negative) => {
                let mut signs = *negative;
                let turned = |p: &Parameter| {
                    let turn = p.signed && signs & 1 == 1;
                    signs >>= usize::from(p.signed);
                    if turn { p.mirrored() } else { p.clone() }
                };
                let parameters: Vec<Parameter> = parameters.iter().map(turned).collect();
                let values: Vec<f64> = parameters.iter().zip(shares).map(|(p, &share)| p.within(share)).collect();
                model_with(&model, &parameters, &values)
            }
            Self::Step(step) => {
                let moved = parameters[0].moved(stated[0], *step);
                model_with(&model, &parameters, &[moved])
            }
            Self::OfSeries => model_with(&model, &parameters, &parent.of_series(stated.len() / 2)),
            Self::Smallest => {
                let least = |(effect, p): &(&'static dyn Effect, Vec<f64>)| -> Vec<f64> {
                    (0..p.len()).map(|number| effect.search_range(number, &model.scales).0).collect()
                };
                model_with(&model, &parameters, &model.effects.last().map_or(stated, least))
            }
            Self::Resonance => placed::started(&model, &addition.keys(), data.points).unwrap_or(model),
        }
    }
}

/// The van der Corput sequence: 1/2, 1/4, 3/4, 1/8, ...
fn radical(number: usize) -> f64 {
    (number as u32).reverse_bits() as f64 / 2f64.powi(32)
}

/// The model with the strength of the addition times `share`, or with a number moved so much further from where it is
/// `before`, within its bounds; `None` where a law states no single strength that vanishes with the effect.
fn strengthened(before: &Model, model: &Model, addition: Addition, share: f64) -> Option<Model> {
    let effect = match addition {
        Addition::Effect(effect) => effect,
        Addition::Recalibration(key) => {
            let number = parameter(before, key)?;
            let value = |model: &Model| values_in(model, std::slice::from_ref(&number))[0];
            let step = share * number.natural_step(value(before), value(model));
            let moved = number.moved(value(before), step);
            return Some(model_with(before, &[number], &[moved]));
        }
    };
    let [zero] = effect.zero() else { return None };
    let step = match zero.value {
        0.0 => share.ln(),
        f64::INFINITY => -share.ln(),
        _ => return None,
    };
    let strength = parameter(model, &addition.keys()[zero.parameter]).filter(|_| step.is_finite())?;
    let value = values_in(model, std::slice::from_ref(&strength))[0];
    Some(model_with(model, std::slice::from_ref(&strength), &[strength.moved(value, step)]))
}
