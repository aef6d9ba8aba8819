//! Prediction of conditions that were left out of the fit.

use super::data::Data;
use super::hypothesis::Hypothesis;
use crate::effects::Zero;
use crate::fit::{Parameter, Prediction, Problem, TAIL, robust_chi2, typical_of};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::cycle::Tolerance;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Longest step on the natural scale of a parameter that leaving a condition out may make.
const LONGEST: f64 = 1.0;
/// A step longer than this may leave the straight part of a valley: it is tried on a part of the points, and halved
/// where the sum of squares rises ...
const STRAIGHT: f64 = 0.05;
/// ... by more than a good step may raise that of a part, ...
const UPHILL: f64 = 2.0;
/// ... so many times at most; then it is left out.
const HALVINGS: i32 = 5;
/// Points of such a part, about.
const SOME: usize = 64;
/// Directions that the rest of the data see less than this share of the best seen one stay as they are.
const UNSEEN: f64 = 1e-5;

/// Errors of predictions, each condition (load, speed, drive) predicted from a fit to all others.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct HeldOut {
    /// Root mean square of the relative error in amplitude \[%\].
    pub rms_percent: f64,
    /// Mean square of the residuals in standard deviations.
    pub chi2_per_point: f64,
}

/// Leaves one series out after the other. The fit without it is one Gauss-Newton step from the fit to all, shortened
/// until it leads no more uphill; the prediction is a new solution of the model. `None` where there is only one series,
/// or the fit is to a part of the points.
pub fn held_out(data: &Data<'_>, hypothesis: &Hypothesis) -> Option<HeldOut> {
    let series = data.points.iter().map(|p| p.series).max().map_or(0, |last| last + 1);
    if series < 2 || hypothesis.fit.evaluation.predictions.len() != data.points.len() {
        return None;
    }
    let fitted = Fitted::new(data.points, hypothesis);
    let predicted: Vec<_> = (0..series).into_par_iter().map(|series| fitted.predicted(series)).collect();
    let (square, chi2, points, readings) =
        predicted.iter().fold((0.0, 0.0, 0, 0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2, a.3 + b.3));
    Some(HeldOut { rms_percent: 100.0 * (square / points as f64).sqrt(), chi2_per_point: chi2 / readings as f64 })
}

/// A fit to all series, of which one is to be left out.
struct Fitted<'a> {
    points: &'a [Point],
    hypothesis: &'a Hypothesis,
    /// On the natural scales of the parameters.
    jacobian: DMatrix<f64>,
    /// The series of every residual.
    series: Vec<usize>,
    /// Residuals beyond this count linearly.
    threshold: f64,
}

impl<'a> Fitted<'a> {
    fn new(points: &'a [Point], hypothesis: &'a Hypothesis) -> Self {
        let fit = &hypothesis.fit;
        let mut jacobian = fit.evaluation.jacobian.clone();
        for (column, (parameter, &value)) in fit.parameters.iter().zip(&fit.values).enumerate() {
            jacobian.column_mut(column).scale_mut(parameter.natural_slope(value));
        }
        let readings = |p: &Point| std::iter::repeat_n(p.series, 1 + usize::from(p.phase.is_some()));
        let series = points.iter().flat_map(readings).collect();
        Self { points, hypothesis, jacobian, series, threshold: TAIL * typical_of(&fit.evaluation.residuals) }
    }

    /// The points of a series, or those of all others.
    fn points_of(&self, series: usize, out: bool) -> impl Iterator<Item = &'a Point> {
        self.points.iter().filter(move |p| (p.series == series) == out)
    }

    /// The problem of predicting some of the points.
    fn problem<'p>(&self, points: impl IntoIterator<Item = &'p Point>, tolerance: Tolerance) -> Problem<'p> {
        Problem::new(self.hypothesis.model.clone(), points, self.hypothesis.fit.parameters.clone(), tolerance)
    }

    /// The parameters that all series but one have.
    fn values_without(&self, series: usize) -> Vec<f64> {
        let fit = &self.hypothesis.fit;
        let rows: Vec<usize> = (0..self.series.len()).filter(|&row| self.series[row] != series).collect();
        let clip = |&row: &usize| fit.evaluation.residuals[row].clamp(-self.threshold, self.threshold);
        let rest = self.jacobian.select_rows(&rows);
        let step = newton(&rest, &DVector::from_iterator(rows.len(), rows.iter().map(clip)));
        // What only the series tells that is left out is not known of it: a drift.
        let only_there = |i: usize| rest.column(i).amax() == 0.0 && self.jacobian.column(i).amax() > 0.0;
        let unknown = |(i, p): (usize, &Parameter)| vanishing(&self.hypothesis.model, p).filter(|_| only_there(i));
        let unknown: Vec<Option<f64>> = fit.parameters.iter().enumerate().map(unknown).collect();
        let moved = |share: f64| -> Vec<f64> {
            let by = |(i, (p, &x)): (usize, (&Parameter, &f64))| match unknown[i] {
                Some(nothing) => nothing,
                None => p.moved(x, share * step[i].clamp(-LONGEST, LONGEST)),
            };
            fit.parameters.iter().zip(&fit.values).enumerate().map(by).collect()
        };
        if step.amax() <= STRAIGHT {
            return moved(1.0);
        }
        // A part of the rest says where it leads.
        let stride = (self.points.len() / SOME).max(1);
        let mut rest = self.problem(self.points_of(series, false).step_by(stride), Tolerance::COARSE);
        let mut objective = |values: &[f64]| robust_chi2(&rest.evaluate(values, false).residuals, self.threshold);
        let before = objective(&fit.values);
        let mut shares = (0..HALVINGS).map(|n| 0.5f64.powi(n)).map(moved);
        shares.find(|values| objective(values) <= before + UPHILL).unwrap_or_else(|| fit.values.clone())
    }

    /// Of a series as the others predict it: sum of squares of the amplitude's relative error, chi2, points and
    /// readings.
    fn predicted(&self, series: usize) -> (f64, f64, usize, usize) {
        let points: Vec<&Point> = self.points_of(series, true).collect();
        let values = self.values_without(series);
        let evaluation = self.problem(points.iter().copied(), Tolerance::default()).evaluate(&values, false);
        let relative = |(p, q): (&&Point, &Prediction)| (q.amplitude / p.amplitude - 1.0).powi(2);
        let square: f64 = points.iter().zip(&evaluation.predictions).map(relative).filter(|e| e.is_finite()).sum();
        (square, evaluation.chi2(), points.len(), evaluation.residuals.len())
    }
}

/// The value of a parameter at which its effect vanishes.
fn vanishing(model: &Model, parameter: &Parameter) -> Option<f64> {
    let (name, key) = parameter.key.strip_prefix("effect.")?.rsplit_once('.')?;
    let (effect, _) = model.effects.iter().find(|(effect, _)| effect.name() == name)?;
    let zero = |zero: &&Zero| effect.parameters()[zero.parameter].key == key && zero.value.is_finite();
    effect.zero().iter().find(zero).map(|zero| zero.value)
}

/// The step that minimises the linearised sum of squares.
fn newton(jacobian: &DMatrix<f64>, residuals: &DVector<f64>) -> DVector<f64> {
    let n = jacobian.ncols();
    if n == 0 {
        return DVector::zeros(0);
    }
    let normal = jacobian.transpose() * jacobian;
    let gradient = jacobian.transpose() * residuals;
    let eigen = normal.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut step = DVector::zeros(n);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > largest * UNSEEN * UNSEEN {
            step -= vector * (vector.dot(&gradient) / value);
        }
    }
    step
}
