//! How well the data determine a parameter: profile likelihood, and the correlations behind it.

use super::{Fit, Parameter, Problem, Settings, minimise, robust_chi2};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// 95 % quantile of chi squared with one degree of freedom.
const RISE: f64 = 3.841_458_820_694_124;
/// Singular values below this share of the largest count as none.
const SINGULAR: f64 = 1e-9;
/// Refits on the way to one end of an interval.
const TRIALS: usize = 5;
/// Relative accuracy of the rise at the end of an interval.
const CLOSE: f64 = 0.06;
/// Relative change of the sum of squares at which a refit is done: well below what that accuracy asks for.
const CONVERGED: f64 = 5e-5;
/// Correlation of two estimates from which on it is named.
const STRONG: f64 = 0.95;

/// What the data say of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
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
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Correlation {
    /// Keys of the two.
    pub parameters: (String, String),
    /// Correlation of the estimates on their natural scales.
    pub value: f64,
}

/// Covariance of the estimates on their natural scales (logarithms of magnitudes) in units of the noise; directions that
/// the data do not see have huge variance.
fn covariance(fit: &Fit) -> DMatrix<f64> {
    let n = fit.parameters.len();
    if n == 0 {
        return DMatrix::zeros(0, 0);
    }
    let mut jacobian = fit.evaluation.jacobian.clone();
    for (column, (parameter, &value)) in fit.parameters.iter().zip(&fit.values).enumerate() {
        let slope = parameter.natural_slope(value);
        jacobian.column_mut(column).scale_mut(slope);
    }
    let normal = jacobian.transpose() * &jacobian;
    let eigen = normal.symmetric_eigen();
    let largest = eigen.eigenvalues.max().max(f64::MIN_POSITIVE);
    let mut inverse = DMatrix::zeros(n, n);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        inverse += vector * vector.transpose() / value.max(largest * SINGULAR * SINGULAR);
    }
    inverse
}

/// Intervals (95 %) from the curvature at the optimum, on the natural scales and within the bounds of the search: cheap, and
/// exact where the model is linear in the parameters.
pub fn approximate_intervals(fit: &Fit, noise: f64) -> Vec<Interval> {
    let covariance = covariance(fit);
    let of = |(i, (p, &value)): (usize, (&Parameter, &f64))| {
        let half = noise * (RISE * covariance[(i, i)]).sqrt();
        let (one, other) = (p.moved(value, -half), p.moved(value, half));
        let identified = match (p.at_bound(one), p.at_bound(other)) {
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

/// Profile-likelihood intervals (95 %) of all parameters of a fit. `noise` is the factor by which the standard deviations
/// of the data are to be multiplied; `problem` moves the parameters of the fit.
pub fn intervals(fit: &Fit, noise: f64, threshold: f64, problem: &mut Problem<'_>) -> Vec<Interval> {
    let covariance = covariance(fit);
    // The sum of squares at the accuracy of the problem, which need not be that of the fit.
    let least = robust_chi2(&problem.evaluate(&fit.values, false).residuals, threshold);
    let problem = &*problem;
    let sides: Vec<(usize, f64)> = (0..fit.parameters.len()).flat_map(|i| [(i, -1.0), (i, 1.0)]).collect();
    let ends: Vec<(f64, bool)> = sides
        .into_par_iter()
        .map(|(i, direction)| end(fit, i, direction, (noise, threshold, least), &covariance, problem))
        .collect();
    let interval = |(value, ends): (&f64, &[(f64, bool)])| {
        let identified = match (ends[0].1, ends[1].1) {
            (true, true) => Identified::Yes,
            (false, false) => Identified::No,
            _ => Identified::OneSided,
        };
        Interval { value: *value, low: ends[0].0.min(ends[1].0), high: ends[0].0.max(ends[1].0), identified }
    };
    fit.values.iter().zip(ends.chunks(2)).map(interval).collect()
}

/// One end of an interval and whether it is the data's.
fn end(
    fit: &Fit,
    i: usize,
    direction: f64,
    (noise, threshold, least): (f64, f64, f64),
    covariance: &DMatrix<f64>,
    problem: &Problem<'_>,
) -> (f64, bool) {
    let parameter = &fit.parameters[i];
    let sensitive = fit.evaluation.jacobian.column(i).norm() * parameter.natural_slope(fit.values[i]).abs();
    let bound = parameter.moved(fit.values[i], direction * 1e3);
    if sensitive < 1e-9 {
        return (bound, false);
    }
    let others: Vec<usize> = (0..fit.parameters.len()).filter(|&j| j != i).collect();
    let mut values = fit.values.clone();
    let goal = RISE * noise * noise;
    let mut step = (goal * covariance[(i, i)]).sqrt();
    let mut inside = (0.0, 0.0);
    let mut outside: Option<(f64, f64)> = None;
    // By how much the others move per step, on their natural scales: at first as the curvature at the optimum ties them.
    let mut slopes: Vec<f64> = others.iter().map(|&j| covariance[(i, j)] / covariance[(i, i)] * direction).collect();
    for _ in 0..TRIALS {
        let room = parameter.natural_distance(fit.values[i], bound);
        step = step.min(room);
        values[i] = parameter.moved(fit.values[i], direction * step);
        let moving: Vec<Parameter> = others.iter().map(|&j| fit.parameters[j].clone()).collect();
        let mut constrained = problem.at(&values, moving);
        let from: Vec<f64> = others
            .iter()
            .zip(&slopes)
            .map(|(&j, slope)| fit.parameters[j].moved(fit.values[j], (slope * step).clamp(-1.0, 1.0)))
            .collect();
        let settings = Settings { evaluations: 4 * (others.len() + 1), threshold, converged: CONVERGED };
        let refit = minimise(&mut constrained, &from, &settings);
        for ((slope, &j), &to) in slopes.iter_mut().zip(&others).zip(&refit.values) {
            *slope = fit.parameters[j].natural_step(fit.values[j], to) / step;
        }
        let rise = refit.objective - least;
        if (rise / goal - 1.0).abs() < CLOSE {
            return (values[i], true);
        }
        if rise < goal {
            if step >= room * (1.0 - 1e-9) {
                return (bound, false);
            }
            inside = (step, rise.max(0.0));
        } else {
            outside = Some((step, rise));
        }
        // The square root of the rise is nearly linear in the step.
        step = match outside {
            Some((far, much)) => {
                let (a, b, g) = (inside.1.sqrt(), much.sqrt(), goal.sqrt());
                inside.0 + (far - inside.0) * ((g - a) / (b - a)).clamp(0.05, 0.95)
            }
            None => step * (goal / rise.max(1e-3 * goal)).sqrt().clamp(1.2, 8.0),
        };
    }
    match outside {
        // A better optimum on the way or a step along a flat valley: the last bracket.
        Some(_) => (parameter.moved(fit.values[i], direction * step), true),
        None => (bound, false),
    }
}
