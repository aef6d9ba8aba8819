//! Where the error comes from: numerics, noise, model.

use super::{Compared, Metrics, Outlier};
use crate::model::Model;
use crate::solver::time::Plan;
use crate::solver::{Status, integrated, plan_for};
use rayon::prelude::*;
use schemars::JsonSchema;

/// Points at which both solvers are compared.
const NUMERICAL_POINTS: usize = 4;
/// Error of the time integration at these steps is of the order of 1e-5.
const PLAN: Plan = Plan { steps: 2000, cycles: 400, settled: 1e-7, window: 1, solved: 1e-9 };

/// Root mean square errors of the amplitude in percent; the squares of the three parts add up to that of the total.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, serde::Serialize)]
pub struct ErrorBudget {
    /// Difference of the two solvers, at a sample of the points; NaN where a rig without contact rings too long for
    /// that.
    pub numerical_percent: f64,
    /// Noise of the measurements, with the readings that stand out.
    pub noise_percent: f64,
    /// What is left: the model.
    pub model_percent: f64,
    /// Model against measurement.
    pub total_percent: f64,
}

/// The budget of a comparison; `scatter` is the noise of the readings over the stated one, amplitudes among the
/// `outliers` are no matter of the model.
pub(super) fn budget(
    model: &Model,
    points: &[Compared],
    overall: &Metrics,
    (scatter, outliers): (f64, &[Outlier]),
) -> ErrorBudget {
    let usable: Vec<&Compared> = points.iter().filter(|p| p.model.status == Status::Steady).collect();
    let count = usable.len().min(NUMERICAL_POINTS);
    let sample: Vec<&Compared> =
        (0..count).map(|i| usable[((i as f64 + 0.5) / count as f64 * usable.len() as f64) as usize]).collect();
    let differences: Vec<f64> = sample
        .par_iter()
        .filter_map(|p| {
            let at = crate::fit::operation(&p.point);
            let other = integrated(model, &at, &plan_for(model, &at, &PLAN));
            other.periodic.then(|| 100.0 * (other.amplitude / p.model.amplitude - 1.0))
        })
        .collect();
    let square = differences.iter().map(|d| d * d).sum::<f64>() / differences.len().max(1) as f64;
    let total = overall.rms_error_percent;
    let compared = model.has_contact || !differences.is_empty();
    let numerical = if compared { square.sqrt().min(total) } else { 0.0 };
    let stands_out = |p: &&Compared| outliers.iter().any(|o| o.row == p.point.row && !o.is_phase());
    let errors = usable.iter().copied().filter(stands_out).map(|p| p.error_percent().powi(2));
    let thrown = errors.sum::<f64>() / usable.len().max(1) as f64;
    // Where the noise does not grow with the reading, small ones that came out smaller yet make up most of the error: their
    // squares are noise as far as those in standard deviations are.
    let kept = usable.iter().copied().filter(|p| !stands_out(p));
    let residuals = kept.clone().map(|p| p.amplitude_residual.powi(2)).sum::<f64>() / kept.count().max(1) as f64;
    let share = (scatter * scatter / residuals).min(1.0);
    // Residuals may by chance be smaller than the stated noise.
    let noise = (scatter * overall.noise_percent).powi(2).max(share * (total * total - thrown)) + thrown;
    let noise = noise.min(total * total - numerical * numerical).max(0.0).sqrt();
    let model = (total * total - numerical * numerical - noise * noise).max(0.0).sqrt();
    let numerical = if compared { numerical } else { f64::NAN };
    ErrorBudget { numerical_percent: numerical, noise_percent: noise, model_percent: model, total_percent: total }
}
