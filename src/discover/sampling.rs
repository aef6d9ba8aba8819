//! Samples over the ranges of an addition, and what they tell before any fit.

use super::hypothesis::{Addition, Hypothesis, extended};
use super::search::Data;
use crate::fit::resonance;
use crate::fit::{Evaluation, Parameter, Problem, parameter, robust_chi2};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::cycle::Tolerance;
use nalgebra::{DMatrix, DVector};

/// Samples over the ranges of an effect of one, two, three, four parameters; one that has either sign gets half as many of
/// each.
const SAMPLES: [usize; 4] = [16, 14, 18, 20];
/// Samples where values are known that are worth a look; a continuum of sliders, which takes long to solve, is looked at with
/// these values alone.
const WITH_HINT: usize = 6;
/// Samples beside an explanation that leaves nothing but noise.
const BESIDE_NOISE: usize = 2;
/// Change of a residual, in standard deviations, below which a point counts as left alone.
const UNTOUCHED: f64 = 0.1;
/// Samples about values that may be a local minimum, and how far they reach on the natural scale of a parameter.
const ABOUT: (u32, f64) = (32, 2.0);
/// Samples over the whole ranges besides, and their first number in the sequence: past those of any first look.
const WIDE: u32 = 48;
const FIRST_WIDE: u32 = 20;

/// Distance, on its natural scale, from which on a calibrated value is far off the stated one.
const FAR: f64 = 1.0;

/// What an earlier search of an addition tells a later one.
#[derive(Debug, Clone)]
pub struct Hint {
    /// Values of its parameters that are worth a look.
    pub values: Vec<f64>,
    /// Which points of the part it changes at all.
    pub touched: Vec<bool>,
}

/// A model with an addition.
#[derive(Debug, Clone)]
pub struct Sample {
    /// As it was drawn.
    pub drawn: Model,
    /// As strong as a linear estimate wants it, where that is another strength.
    pub strengthened: Option<Model>,
}

/// What samples tell.
pub struct Look {
    /// The samples with the sum of squares over the part after as much of its change as is best in a linear estimate; the most
    /// promising first.
    pub starts: Vec<(f64, Sample)>,
    /// Sum of squares over the part after as much of one sample's change as is best, in a linear estimate.
    pub after: f64,
    /// Largest change that a sample makes beyond what the parameters before it can imitate: sum of squares over the part.
    pub visibility: f64,
    /// The sample with that change; all of them where none changes anything.
    pub strongest: Vec<Model>,
    /// Which points of the part a sample changes at all.
    pub touched: Vec<bool>,
}

/// Looks at samples of one more addition. Points that the hint says it leaves alone are not solved again.
pub fn look(data: &Data<'_>, base: &Base<'_>, addition: Addition, samples: &[Model], hint: Option<&Hint>) -> Look {
    let rest = base.rest();
    let rows = rows(&data.part);
    let mut touched = vec![false; data.part.len()];
    let mut told = false;
    let (mut visibility, mut strongest) = (0.0, samples.to_vec());
    let mut after = robust_chi2(&rest, data.threshold);
    let mut tried: Vec<(f64, Sample)> = Vec::new();
    for model in samples {
        let (residuals, lost) = residuals(data, model, base, hint);
        for (touched, rows) in touched.iter_mut().zip(&rows).filter(|_| !lost) {
            *touched |= rows.clone().any(|r| (residuals[r] - base.evaluation.residuals[r]).abs() > UNTOUCHED);
        }
        told |= !lost;
        let change = base.without(&(&residuals - &base.evaluation.residuals));
        let size = change.norm_squared();
        let as_it_is = robust_chi2(&base.without(&residuals), data.threshold);
        let mut least = as_it_is;
        let mut sample = Sample { drawn: model.clone(), strengthened: None };
        if size > 0.0 {
            // As much of the change as the sum of squares wants.
            let share = (-rest.dot(&change) / size).max(0.0);
            let scaled = robust_chi2(&(&rest + &change * share), data.threshold);
            if scaled < least {
                least = scaled;
                sample.strengthened = strengthened(model, addition, share);
            }
        }
        after = after.min(least);
        if size > visibility {
            (visibility, strongest) = (size, vec![model.clone()]);
        }
        tried.push((least, sample));
    }
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    if !told {
        touched.fill(true);
    }
    Look { starts: tried, after, visibility, strongest, touched }
}

impl Look {
    /// Two looks as one.
    pub fn and(mut self, other: Self) -> Self {
        self.starts.extend(other.starts);
        self.starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        if other.visibility > self.visibility {
            (self.visibility, self.strongest) = (other.visibility, other.strongest);
        }
        self.touched.iter_mut().zip(other.touched).for_each(|(touched, other)| *touched |= other);
        Self { after: self.after.min(other.after), ..self }
    }
}

/// The model with the strength of the addition times `share`, within its bounds; `None` where its law states no single
/// strength that vanishes with the effect.
fn strengthened(model: &Model, addition: Addition, share: f64) -> Option<Model> {
    let Addition::Effect(effect) = addition else { return None };
    let [zero] = effect.zero() else { return None };
    let step = match zero.value {
        0.0 => share.ln(),
        f64::INFINITY => -share.ln(),
        _ => return None,
    };
    let strength = parameter(model, &addition.keys()[zero.parameter]).filter(|_| step.is_finite())?;
    let none: [&Point; 0] = [];
    let problem = Problem::new(model.clone(), none, vec![strength.clone()], Tolerance::COARSE);
    Some(problem.model(&[strength.moved(problem.values()[0], step)]))
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

/// Residuals of a model on the part of the points, those of `base` where the hint says that nothing changes; and whether the
/// model is lost, so that they say nothing of each point.
fn residuals(data: &Data<'_>, model: &Model, base: &Base<'_>, hint: Option<&Hint>) -> (DVector<f64>, bool) {
    let everywhere = vec![true; data.part.len()];
    let touched = hint.map_or(&everywhere, |hint| &hint.touched);
    let solved = base.problem.of(model.clone(), touched).evaluate(&[], false);
    let mut all = base.evaluation.residuals.clone();
    let mut next = 0;
    for (range, _) in rows(&data.part).into_iter().zip(touched).filter(|(_, touched)| **touched) {
        for row in range {
            all[row] = solved.residuals[next];
            next += 1;
        }
    }
    (all, solved.lost)
}

/// Models with the addition at samples of its ranges.
pub fn samples(
    data: &Data<'_>,
    before: &Model,
    addition: Addition,
    hint: Option<&[f64]>,
    beside_noise: bool,
) -> Vec<Model> {
    let model = extended(before, &[addition]);
    let parameters = data.movable(&model, &addition.keys());
    let none: [&Point; 0] = [];
    let with = |parameters: Vec<Parameter>, values: &[f64]| {
        Problem::new(model.clone(), none, parameters, Tolerance::COARSE).model(values)
    };
    if let Addition::Recalibration(_) = addition {
        // The stated value, and a little to either side.
        let value = Problem::new(model.clone(), none, parameters.clone(), Tolerance::COARSE).values();
        let mut values: Vec<f64> = [-0.05, 0.05].iter().map(|step| parameters[0].moved(value[0], *step)).collect();
        // And where the resonance of the readings puts it: a sensor may be inverted, a gain off by any factor.
        values.extend(resonance::started(&model, &addition.keys(), data.points).and_then(|there| {
            let none: [&Point; 0] = [];
            Problem::new(there, none, parameters.clone(), Tolerance::COARSE).values().first().copied()
        }));
        return values.into_iter().map(|value| with(parameters.clone(), &[value])).collect();
    }
    let mut all: Vec<Model> = hint.map(|values| with(parameters.clone(), values)).into_iter().collect();
    let signed = parameters.iter().any(|p| p.signed);
    let most = SAMPLES[parameters.len().clamp(1, 4) - 1] / (1 + usize::from(signed));
    let costly = model.has_continuum();
    let count = match hint {
        Some(_) if costly => 0,
        Some(_) if beside_noise => BESIDE_NOISE,
        Some(_) => most.min(WITH_HINT),
        None => most,
    };
    for number in 0..count as u32 {
        let shares = match parameters.len() {
            1 => vec![(f64::from(number) + 0.5) / count as f64],
            n => spread(number, n, data.seed),
        };
        for negative in [false, true].into_iter().take(1 + usize::from(signed)) {
            let turned: Vec<Parameter> =
                parameters.iter().map(|p| if p.signed && negative { p.mirrored() } else { p.clone() }).collect();
            let values: Vec<f64> = turned.iter().zip(&shares).map(|(p, &share)| p.within(share)).collect();
            all.push(with(turned, &values));
        }
    }
    all
}

/// Models with the addition at samples about the values that it has in `model`, and at more samples of its whole ranges,
/// with the signs that it has.
pub fn about(data: &Data<'_>, model: &Model, addition: Addition) -> Vec<Model> {
    let parameters = data.movable(model, &addition.keys());
    let none: [&Point; 0] = [];
    let problem = Problem::new(model.clone(), none, parameters.clone(), Tolerance::COARSE);
    let (values, (count, reach)) = (problem.values(), ABOUT);
    let moved = |number| -> Vec<f64> {
        let shares = spread(number, parameters.len(), data.seed);
        let step = |share: f64| reach * (2.0 * share - 1.0);
        parameters.iter().zip(&values).zip(shares).map(|((p, &x), share)| p.moved(x, step(share))).collect()
    };
    let wide = |number| -> Vec<f64> {
        let shares = spread(FIRST_WIDE + number, parameters.len(), data.seed);
        parameters.iter().zip(shares).map(|(p, share)| p.within(share)).collect()
    };
    let near = (0..count).map(moved);
    near.chain((0..WIDE).map(wide)).map(|values| problem.model(&values)).collect()
}

/// Whether the calibration has carried a parameter far off the value that the scenario states.
pub fn far_off(data: &Data<'_>, from: &Hypothesis) -> bool {
    let mut both = from.fit.parameters.iter().zip(from.fit.values.iter().zip(&data.stated));
    both.any(|(p, (&a, &b))| p.natural_distance(a, b) > FAR)
}

/// A hypothesis with the base at the values that the scenario states, if the calibration has carried one far off: there an
/// addition may have nothing left to act on.
pub fn at_stated_values<'a>(data: &Data<'a>, from: &Hypothesis) -> Option<(Hypothesis, Base<'a>)> {
    if !far_off(data, from) {
        return None;
    }
    let mut there = from.clone();
    there.fit.values[..data.stated.len()].copy_from_slice(&data.stated);
    let base = Base::new(data, &there);
    Some((there, base))
}

/// A point of a quasi-random sequence in the unit cube.
fn spread(number: u32, dimensions: usize, seed: u32) -> Vec<f64> {
    (0..dimensions as u32).map(|d| f64::from(sobol_burley::sample(number, d, seed))).collect()
}

/// The hypothesis that a search starts from, on the part of the points.
pub struct Base<'a> {
    problem: Problem<'a>,
    evaluation: Evaluation,
    /// Orthonormal columns that span what its parameters can do.
    span: DMatrix<f64>,
}

impl<'a> Base<'a> {
    /// Its residuals and what its parameters can do.
    pub fn new(data: &Data<'a>, from: &Hypothesis) -> Self {
        let mut problem =
            Problem::new(from.model.clone(), data.part.iter().copied(), from.fit.parameters.clone(), Tolerance::COARSE);
        let evaluation = problem.evaluate(&from.fit.values, true);
        if evaluation.jacobian.is_empty() {
            let span = DMatrix::zeros(evaluation.residuals.len(), 0);
            return Self { problem, evaluation, span };
        }
        let svd = evaluation.jacobian.clone().svd(true, false);
        let largest = svd.singular_values.iter().copied().fold(0.0, f64::max);
        let columns: Vec<usize> =
            (0..svd.singular_values.len()).filter(|&i| svd.singular_values[i] > 1e-9 * largest).collect();
        let span = match &svd.u {
            Some(u) if !columns.is_empty() => u.select_columns(&columns),
            _ => DMatrix::zeros(evaluation.residuals.len(), 0),
        };
        Self { problem, evaluation, span }
    }

    /// Residuals at the best that the parameters can do, in a linear estimate.
    pub fn rest(&self) -> DVector<f64> {
        self.without(&self.evaluation.residuals)
    }

    /// A change of the residuals less what the parameters could undo.
    fn without(&self, change: &DVector<f64>) -> DVector<f64> {
        if self.span.ncols() == 0 {
            return change.clone();
        }
        change - &self.span * (self.span.transpose() * change)
    }
}
