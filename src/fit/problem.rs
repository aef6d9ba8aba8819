//! Residuals of a model against measured points, with derivatives by the parameters of a fit.

use super::Parameter;
use super::dense::{Chain, Reading, Solved, chains};
use crate::effects::slides;
use crate::measurement::Point;
use crate::model::{Model, Operation};
use crate::parameter::FIRST_EFFECT_PARAMETER;
use crate::solver::cycle::Tolerance;
use crate::solver::{Status, Warm, solve_steady};
use crate::statistics::wrap;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};

/// Residuals of a point that the model cannot be compared at (no steady state) count as this many standard deviations:
/// enough to be avoided, too little to rule out an otherwise good model. Of a bad model they count as the others do on
/// average: to have no steady state must not be a bargain.
pub const TROUBLED: f64 = 6.0;

/// A model without a steady state at more than this share of the points explains none of them: there a residual counts
/// as this many standard deviations at least.
const LOST: (f64, f64) = (0.25, 1e3);
/// The share where the model is a continuum of sliders, which takes long to find none, and is only looked at.
const LOST_COSTLY: f64 = 0.05;

/// Step of a difference on the natural scale of a parameter.
const DIFFERENCE: f64 = 0.02;

/// Steps of an integration that take as long as a steady state of a single slider.
const STEPS_A_STATE: u64 = 7;
/// Laws of friction that take as long as everything else of a steady state.
const A_LAW: u64 = 3;

/// What a model says of one measured point.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Prediction {
    /// alpha \[rad\].
    pub amplitude: f64,
    /// phi \[rad\].
    pub phase: f64,
    /// Whether it is a steady state.
    pub status: Status,
    /// Readings (amplitude, phase) of the other stable states there: between folds the state nearest to the measured
    /// one is compared with it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<(f64, f64)>,
    /// Whether the branch of states that the reading is nearest to ends short of it: the amplitude is then as far from
    /// the reading as that end is in amplitude and drive.
    #[serde(skip)]
    pub beyond: bool,
}

/// Residuals in standard deviations, model minus measurement: per point the amplitude, then the phase where measured.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// The residuals.
    pub residuals: DVector<f64>,
    /// Their derivatives by the values of the parameters (one column each).
    pub jacobian: DMatrix<f64>,
    /// What the model says of each point.
    pub predictions: Vec<Prediction>,
    /// Whether it has no steady state at so many points that the residuals say nothing of the others.
    pub lost: bool,
}

impl Evaluation {
    /// Sum of the squares of the residuals.
    pub fn chi2(&self) -> f64 {
        self.residuals.norm_squared()
    }

    /// Number of points at which the model has no steady state.
    pub fn troubled(&self) -> usize {
        self.predictions.iter().filter(|p| !p.status.is_steady()).count()
    }
}

/// A model, the points it is compared with, and the parameters that may move. An evaluation does not depend on those
/// before it, nor on the number of threads: where a model has more than one steady state it is always the same that is
/// found. Only a continuum of sliders starts from its last states.
#[derive(Clone)]
pub struct Problem<'a> {
    model: Model,
    points: Vec<&'a Point>,
    parameters: Vec<Parameter>,
    tolerance: Tolerance,
    warm: Vec<Warm>,
    /// Whether the points of a model that is lost need not all be solved.
    gives_up: bool,
    /// Series that are read between some of their points.
    dense: Vec<Chain>,
    /// The points of the others.
    single: Vec<usize>,
    /// Evaluations so far.
    pub evaluations: usize,
    /// Steady states solved so far, each counted by what it costs ([`cost`]).
    pub solved: u64,
}

/// Values of parameters in a model.
pub fn values_in(model: &Model, parameters: &[Parameter]) -> Vec<f64> {
    let mut model = model.clone();
    parameters.iter().filter_map(|p| with_parameter(&mut model, p.index, |x| *x)).collect()
}

/// A model with these values of its parameters.
pub fn model_with(model: &Model, parameters: &[Parameter], values: &[f64]) -> Model {
    let mut model = model.clone();
    for (parameter, &value) in parameters.iter().zip(values) {
        with_parameter(&mut model, parameter.index, |slot| *slot = value);
    }
    model
}

impl<'a> Problem<'a> {
    /// A problem over `points`.
    pub fn new(
        model: Model,
        points: impl IntoIterator<Item = &'a Point>,
        parameters: Vec<Parameter>,
        tolerance: Tolerance,
    ) -> Self {
        let points: Vec<_> = points.into_iter().collect();
        let warm = vec![Warm::default(); points.len()];
        let (dense, single) = chains(&points);
        Self { model, points, parameters, tolerance, warm, gives_up: false, dense, single, evaluations: 0, solved: 0 }
    }

    /// The same points with the model at these values and other parameters to move.
    pub fn at(&self, values: &[f64], parameters: Vec<Parameter>) -> Self {
        Self { model: self.model(values), parameters, evaluations: 0, solved: 0, ..self.clone() }
    }

    /// Another model at the same points, nothing to move, for a look at its residuals alone: one without a steady state
    /// at many points is given up before all are solved.
    pub fn of(&self, model: Model) -> Self {
        Self { model, parameters: Vec::new(), gives_up: true, evaluations: 0, solved: 0, ..self.clone() }
    }

    /// What the error of the solver amounts to in the norm of all residuals, about \[standard deviations\].
    pub fn error(&self) -> f64 {
        let of = |point: &&Point| {
            (point.amplitude / point.amplitude_sd).powi(2) + point.phase_sd.map_or(0.0, |sd| sd.powi(-2))
        };
        self.tolerance.error() * self.points.iter().map(of).sum::<f64>().sqrt()
    }

    /// The parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The points.
    pub fn points(&self) -> &[&'a Point] {
        &self.points
    }

    /// Values of the parameters in the model as it was given.
    pub fn values(&self) -> Vec<f64> {
        values_in(&self.model, &self.parameters)
    }

    /// The model with these values.
    pub fn model(&self, values: &[f64]) -> Model {
        model_with(&self.model, &self.parameters, values)
    }

    /// Residuals at these values, and with `derivatives` their Jacobian (otherwise without columns).
    pub fn evaluate(&mut self, values: &[f64], derivatives: bool) -> Evaluation {
        // The solver's own derivatives of a continuum are differences by every parameter of the model.
        if derivatives && self.model.has_sliders() {
            return self.differences(values);
        }
        self.solve(values, derivatives)
    }

    fn solve(&mut self, values: &[f64], derivatives: bool) -> Evaluation {
        self.evaluations += 1;
        let model = self.model(values);
        let indices: Vec<usize> = if derivatives { self.parameters.iter().map(|p| p.index).collect() } else { vec![] };
        let share = if self.gives_up && model.has_sliders() { LOST_COSTLY } else { LOST.0 };
        let allowed = share * self.points.len() as f64;
        let (solved, troubled) = self.states(&model, &indices, allowed);
        // Of all points, those between the ones that were solved too.
        let missing = solved.iter().filter(|(prediction, _)| !prediction.status.is_steady()).count();
        let lost = troubled.max(missing) as f64 > allowed;
        let rows = self.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum();
        let mut residuals = DVector::zeros(rows);
        let mut jacobian = DMatrix::zeros(rows, indices.len());
        if lost && self.gives_up {
            // Whichever points were solved before: the same for any order of them.
            let all = self.points.iter().flat_map(|point| {
                let (amplitude, phase) = unread(point);
                std::iter::once(amplitude).chain(phase)
            });
            residuals.iter_mut().zip(all).for_each(|(slot, residual)| *slot = residual);
            let predictions = solved.into_iter().map(|(p, _)| p).collect();
            return Evaluation { residuals, jacobian, predictions, lost };
        }
        let pairs = || self.points.iter().copied().zip(solved.iter().map(|(prediction, _)| prediction));
        let left = read_all(pairs, lost);
        let mut row = 0;
        for ((point, (amplitude, phase)), (_, gradient)) in self.points.iter().zip(left).zip(&solved) {
            residuals[row] = amplitude;
            for (column, (by_amplitude, _)) in gradient.iter().enumerate() {
                jacobian[(row, column)] = by_amplitude / point.amplitude_sd;
            }
            row += 1;
            if let (Some(phase), Some(sd)) = (phase, point.phase_sd) {
                residuals[row] = phase;
                for (column, (_, by_phase)) in gradient.iter().enumerate() {
                    jacobian[(row, column)] = by_phase / sd;
                }
                row += 1;
            }
        }
        Evaluation { residuals, jacobian, predictions: solved.into_iter().map(|(p, _)| p).collect(), lost }
    }

    /// The steady states of a model at all points, with their derivatives by the parameters of these indices, and at
    /// how many of those that were solved there is none; one that may be given up is once these are more than allowed.
    fn states(&mut self, model: &Model, indices: &[usize], allowed: f64) -> (Vec<Solved>, usize) {
        let (tolerance, gives_up, points) = (self.tolerance, self.gives_up, &self.points);
        let troubled = AtomicUsize::new(0);
        let spent = AtomicU64::new(0);
        // What was integrated comes on top; the balance of a mode alone costs what was expected, or more.
        let least = if model.has_sliders() { 1 } else { cost(model) };
        let solve = |(index, warm): (usize, &mut Warm)| -> (usize, Solved) {
            let point = points[index];
            warm.forget_orbit();
            warm.expect(point.amplitude, point.phase);
            if gives_up && troubled.load(Relaxed) as f64 > allowed {
                let status = Status::Failed("one of too many points without a steady state".into());
                let (amplitude, phase) = (f64::NAN, f64::NAN);
                let none = Prediction { amplitude, phase, status, others: Vec::new(), beyond: false };
                return (index, (none, vec![]));
            }
            let solution = solve_steady(model, &operation(point), &tolerance, !indices.is_empty(), warm);
            let own = solution.steps as u64 / STEPS_A_STATE;
            spent.fetch_add(if model.has_contact { least + own } else { least.max(own) }, Relaxed);
            let state = solution.state;
            if !state.status.is_steady() {
                troubled.fetch_add(1, Relaxed);
            }
            let gradient = match &solution.derivatives {
                Some(all) if state.status.is_steady() => indices.iter().map(|&i| all[i]).collect(),
                _ => vec![(0.0, 0.0); indices.len()],
            };
            let (others, beyond) = (solution.others, solution.beyond);
            let (amplitude, phase, status) = (state.amplitude, state.phase, state.status);
            (index, (Prediction { amplitude, phase, status, others, beyond }, gradient))
        };
        let mut solved: Vec<Option<Solved>> = vec![None; points.len()];
        let (mut readings, mut wave): (Vec<Reading<'_>>, Vec<Vec<usize>>) = self.dense.iter().map(Reading::new).unzip();
        wave.push(self.single.clone());
        while wave.iter().any(|own| !own.is_empty()) {
            let mut wanted = vec![false; points.len()];
            wave.iter().flatten().for_each(|&index| wanted[index] = true);
            let work: Vec<(usize, &mut Warm)> = self.warm.iter_mut().enumerate().filter(|(i, _)| wanted[*i]).collect();
            // One after the other where the first may tell enough of all, so that as many are solved on any number of
            // threads.
            let found: Vec<(usize, Solved)> = if gives_up {
                work.into_iter().map(solve).collect()
            } else {
                work.into_par_iter().map(solve).collect()
            };
            let before = solved.iter().any(Option::is_some);
            found.into_iter().for_each(|(index, one)| solved[index] = Some(one));
            if before {
                readings.iter_mut().for_each(|reading| reading.refine(points, &solved));
            }
            wave = readings.iter().map(Reading::next).collect();
        }
        self.solved += spent.into_inner() * (A_LAW + model.friction_laws() as u64) / A_LAW;
        readings.iter().for_each(|reading| reading.fill(points, &mut solved));
        (solved.into_iter().flatten().collect(), troubled.into_inner())
    }
}

impl Problem<'_> {
    /// An evaluation of a continuum of sliders: its derivatives by the parameters of the effect that makes it one are
    /// differences, those by all others are of the single slider that it becomes where that effect vanishes. They lead
    /// a fit to its minimum; what it is worth there is told by the residuals. Of bristles that remember all are
    /// differences.
    fn differences(&mut self, values: &[f64]) -> Evaluation {
        let mut evaluation = self.evaluate(values, false);
        let mut single = self.clone();
        let mut own = Vec::new();
        let mut index = FIRST_EFFECT_PARAMETER;
        for (effect, p) in &self.model.effects {
            if slides(*effect, p) {
                for zero in effect.zero() {
                    with_parameter(&mut single.model, index + zero.parameter, |slot| *slot = zero.value);
                }
                own.extend(index..index + p.len());
            }
            index += p.len();
        }
        let remembers = self.model.remembers();
        let kept = |i: &usize| !remembers && !own.contains(&self.parameters[*i].index);
        let kept: Vec<usize> = (0..values.len()).filter(kept).collect();
        let mut jacobian = DMatrix::zeros(evaluation.residuals.len(), values.len());
        if !kept.is_empty() {
            single.parameters = kept.iter().map(|&i| self.parameters[i].clone()).collect();
            let others: Vec<f64> = kept.iter().map(|&i| values[i]).collect();
            let analytic = single.solve(&others, true).jacobian;
            for (column, &i) in kept.iter().enumerate() {
                jacobian.set_column(i, &analytic.column(column));
            }
        }
        for column in (0..values.len()).filter(|i| !kept.contains(i)) {
            let (parameter, value) = (&self.parameters[column].clone(), values[column]);
            let mut moved = values.to_vec();
            // Away from a bound, where the step would be lost.
            moved[column] = parameter.moved(value, DIFFERENCE);
            if parameter.natural_distance(value, moved[column]) < 0.5 * DIFFERENCE {
                moved[column] = parameter.moved(value, -DIFFERENCE);
            }
            let step = moved[column] - value;
            let change = self.evaluate(&moved, false).residuals - &evaluation.residuals;
            jacobian.set_column(column, &(change / step));
        }
        evaluation.jacobian = jacobian;
        evaluation
    }
}

/// Steady states of a single slider, of 0.015 ms, that one of a model is expected to cost: what decides whether a fit is
/// begun. What it turns out to take is counted by its steps. Of a joint or a stop it is 0.1 ms, where dry friction may
/// stop the body as much, under a damping without a bounded slope 0.1 to 0.3 ms, beside a joint 0.8 ms; of elements that
/// share the contact 0.06 to 0.5 ms where they meet no other law, of which the least is expected, and 10 to 30 ms beside
/// one.
pub fn cost(model: &Model) -> u64 {
    if model.has_sliders() {
        return match (model.has_law_beside_sliders(), model.has_hysteresis()) {
            (true, _) => 500,
            (false, true) => 15,
            (false, false) => 3,
        };
    }
    let corners = if model.has_corners() || model.has_dry_friction() { 3 } else { 1 };
    if model.is_steep() { 8 * corners } else { corners }
}

/// Whether a model has no steady state at so many of some points that it explains none of them.
pub fn is_lost<'p>(predictions: impl IntoIterator<Item = &'p Prediction>) -> bool {
    let (mut troubled, mut all) = (0_usize, 0_usize);
    for prediction in predictions {
        troubled += usize::from(!prediction.status.is_steady());
        all += 1;
    }
    troubled as f64 > LOST.0 * all as f64
}

/// Residuals of all points; those without a steady state are as bad as the others are on average, and the worst of a
/// model that is lost.
pub fn read_all<'p, I: Iterator<Item = (&'p Point, &'p Prediction)>>(
    pairs: impl Fn() -> I,
    lost: bool,
) -> Vec<(f64, Option<f64>)> {
    let squares = pairs().filter(|(_, prediction)| prediction.status.is_steady()).map(|(point, prediction)| {
        let (amplitude, phase) = read(point, prediction);
        (amplitude.powi(2) + phase.map_or(0.0, |r| r.powi(2)), 1 + usize::from(phase.is_some()))
    });
    let (square, readings) = squares.fold((0.0, 0), |(square, count), (s, n)| (square + s, count + n));
    let average = (square / readings.max(1) as f64).sqrt();
    let of = |(point, prediction): (&Point, &Prediction)| match prediction.status {
        Status::Steady | Status::Stuck => read(point, prediction),
        _ if lost => unread(point),
        _ if average > TROUBLED => (average, point.phase.map(|_| average)),
        _ => read(point, prediction),
    };
    pairs().map(of).collect()
}

/// Residuals of a point of a model that is lost: as of a motion of no size and of the opposite phase, and many times
/// the noise.
fn unread(point: &Point) -> (f64, Option<f64>) {
    let phase = point.phase.zip(point.phase_sd).map(|(_, sd)| LOST.1.max(std::f64::consts::PI / sd));
    (LOST.1.max(point.amplitude / point.amplitude_sd), phase)
}

/// Residuals of amplitude and, where measured, phase in standard deviations.
fn read(point: &Point, prediction: &Prediction) -> (f64, Option<f64>) {
    let amplitude = (prediction.amplitude - point.amplitude) / point.amplitude_sd;
    let phase = point.phase.zip(point.phase_sd).map(|(phase, sd)| wrap(prediction.phase - phase) / sd);
    match prediction.status {
        Status::Steady | Status::Stuck => (amplitude, phase),
        _ => (troubled(amplitude), phase.map(troubled)),
    }
}

fn troubled(residual: f64) -> f64 {
    if residual.is_finite() { residual.abs().clamp(2.0, TROUBLED).copysign(residual) } else { TROUBLED }
}

/// Where a point was measured.
pub fn operation(point: &Point) -> Operation {
    Operation {
        speed: point.speed,
        load: point.load,
        drive: point.drive,
        frequency: point.frequency,
        series: point.series,
    }
}

/// Reads or writes a parameter of the model; the operating point, which is none of them, is a dummy here.
fn with_parameter<T>(model: &mut Model, index: usize, act: impl FnOnce(&mut f64) -> T) -> Option<T> {
    let mut at = Operation { speed: 0.0, load: 0.0, drive: 0.0, frequency: 0.0, series: 0 };
    model.parameter(&mut at, index).map(act)
}
