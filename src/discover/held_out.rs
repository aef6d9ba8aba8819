//! Prediction of conditions that were left out of the fit.

use super::data::Data;
use super::hypothesis::Hypothesis;
use crate::effects::Zero;
use crate::fit::{Parameter, Problem, TAIL, robust_chi2, typical_of};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::cycle::Tolerance;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Longest step on the natural scale of a parameter that leaving a condition out may make.
const LONGEST: f64 = 1.0;
/// A step longer than this may leave the straight part of a valley: it is tried on a part of the points, and halved where the
/// sum of squares rises ...
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

/// Leaves one condition out after the other. The fit without it is one Gauss-Newton step from the fit to all, shortened
/// until it leads no more uphill; the prediction is a new solution of the model. `None` where there is only one condition, or
/// the fit is to a part of the points.
pub fn held_out(data: &Data<'_>, hypothesis: &Hypothesis) -> Option<HeldOut> {
    let of_point: Vec<usize> = data.points.iter().map(|p| p.series).collect();
    let series = of_point.iter().max().map_or(0, |last| last + 1);
    let fit = &hypothesis.fit;
    if series < 2 || fit.evaluation.predictions.len() != data.points.len() {
        return None;
    }
    let mut jacobian = fit.evaluation.jacobian.clone();
    for (column, (parameter, &value)) in fit.parameters.iter().zip(&fit.values).enumerate() {
        jacobian.column_mut(column).scale_mut(parameter.natural_slope(value));
    }
    let residuals = &fit.evaluation.residuals;
    let stride = (data.points.len() / SOME).max(1);
    let threshold = TAIL * typical_of(residuals);
    let of_row: Vec<usize> = data
        .points
        .iter()
        .zip(&of_point)
        .flat_map(|(p, &c)| std::iter::repeat_n(c, 1 + usize::from(p.phase.is_some())))
        .collect();
    let predicted: Vec<(f64, f64, usize, usize)> = (0..series)
        .into_par_iter()
        .map(|condition| {
            let rows: Vec<usize> = (0..of_row.len()).filter(|&r| of_row[r] != condition).collect();
            let clipped =
                DVector::from_iterator(rows.len(), rows.iter().map(|&r| residuals[r].clamp(-threshold, threshold)));
            let rest_of = jacobian.select_rows(&rows);
            let step = newton(&rest_of, &clipped);
            // What only the series tells that is left out is not known of it: a drift.
            let unknown: Vec<Option<f64>> = fit
                .parameters
                .iter()
                .enumerate()
                .map(|(i, p)| {
                    vanishing(&hypothesis.model, p)
                        .filter(|_| rest_of.column(i).amax() == 0.0 && jacobian.column(i).amax() > 0.0)
                })
                .collect();
            let moved = |share: f64| -> Vec<f64> {
                let by = |(i, (p, &x)): (usize, (&Parameter, &f64))| match unknown[i] {
                    Some(nothing) => nothing,
                    None => p.moved(x, share * step[i].clamp(-LONGEST, LONGEST)),
                };
                fit.parameters.iter().zip(&fit.values).enumerate().map(by).collect()
            };
            let all = |out: bool| data.points.iter().zip(&of_point).filter(move |(_, c)| (**c == condition) == out);
            let mut values = moved(1.0);
            if step.amax() > STRAIGHT {
                // A part of the rest says where it leads.
                let some = || all(false).step_by(stride);
                let mut rest = Problem::new(
                    hypothesis.model.clone(),
                    some().map(|(p, _)| p),
                    fit.parameters.clone(),
                    Tolerance::COARSE,
                );
                let mut objective = |values: &[f64]| robust_chi2(&rest.evaluate(values, false).residuals, threshold);
                let before = objective(&fit.values);
                let shares = (0..HALVINGS).map(|n| 0.5f64.powi(n));
                let downhill = shares.map(moved).find(|values| objective(values) <= before + UPHILL);
                values = downhill.unwrap_or_else(|| fit.values.clone());
            }
            let points: Vec<&Point> = all(true).map(|(p, _)| p).collect();
            let mut problem = Problem::new(
                hypothesis.model.clone(),
                points.iter().copied(),
                fit.parameters.clone(),
                Tolerance::default(),
            );
            let evaluation = problem.evaluate(&values, false);
            let relative = |(p, q): (&&Point, &crate::fit::Prediction)| (q.amplitude / p.amplitude - 1.0).powi(2);
            let square: f64 = points.iter().zip(&evaluation.predictions).map(relative).filter(|e| e.is_finite()).sum();
            (square, evaluation.chi2(), points.len(), evaluation.residuals.len())
        })
        .collect();
    let (square, chi2, points, readings) =
        predicted.iter().fold((0.0, 0.0, 0, 0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2, a.3 + b.3));
    Some(HeldOut { rms_percent: 100.0 * (square / points as f64).sqrt(), chi2_per_point: chi2 / readings as f64 })
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
