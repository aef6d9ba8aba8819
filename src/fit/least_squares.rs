//! Levenberg-Marquardt in the coordinates of the parameters, from one start or several.

use super::{Evaluation, Parameter, Problem};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::{DMatrix, DVector, Dyn, storage::Owned};

/// Beyond this many standard deviations residuals count with their logarithm: normal noise with the tails of Student's
/// t, so that what is far off loses its pull and outliers decide nothing.
pub const TAIL: f64 = 4.0;
/// Relative change of the sum of squares at which a fit to all points is done: far below one unit for any table that
/// fits.
pub const CONVERGED: f64 = 1e-7;

/// How hard to try.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Most evaluations of the model.
    pub evaluations: usize,
    /// Residuals beyond this count with their logarithm; infinity for plain least squares.
    pub threshold: f64,
    /// Relative change of the sum of squares at which it is done.
    pub converged: f64,
    /// Steady states, each counted as what it costs: it ends with the evaluation that reaches so many.
    pub states: u64,
}

/// A finished fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// What was moved.
    pub parameters: Vec<Parameter>,
    /// Where to.
    pub values: Vec<f64>,
    /// Residuals and derivatives there.
    pub evaluation: Evaluation,
    /// Sum of squares, residuals beyond the threshold counted with their logarithm.
    pub objective: f64,
    /// Evaluations of the model.
    pub evaluations: usize,
    /// Why it ended.
    pub termination: String,
}

impl Fit {
    /// Schwarz's criterion with squares in this unit (1: in that of the noise, which is known from so many degrees of
    /// freedom), less a constant common to all fits of the same readings, of which there are so many; smaller is
    /// better.
    pub fn schwarz(&self, unit: f64, readings: usize, freedom: f64) -> f64 {
        let square = deviance(robust_square(&self.evaluation.residuals, unit), readings, freedom);
        square + price(self.parameters.len(), readings, freedom)
    }

    /// Of strengths of either sign that came to less than a search looks for, and would take off more squares at the other
    /// sign than [`MARGIN`] of what is typically left, the other parameters following: all parameters and values with
    /// these at the least of that sign. `None` where there is none.
    pub fn across_zero(&self) -> Option<(Vec<Parameter>, Vec<f64>)> {
        let (residuals, jacobian) = (&self.evaluation.residuals, &self.evaluation.jacobian);
        let goes_on = |index: usize| {
            let (parameter, value) = (&self.parameters[index], self.values[index]);
            if !parameter.signed || parameter.share(value) >= 0.0 {
                return false;
            }
            let others = jacobian.clone().remove_column(index).qr().q();
            let column = jacobian.column(index);
            let own = column - &others * (others.transpose() * column);
            let uphill = own.dot(residuals);
            uphill * value > 0.0 && uphill * uphill > MARGIN * typical_of(residuals).powi(2) * own.norm_squared()
        };
        let across: Vec<bool> = (0..self.values.len()).map(goes_on).collect();
        let mirrored = |(p, goes_on): (&Parameter, &bool)| if *goes_on { p.mirrored() } else { p.clone() };
        let parameters: Vec<Parameter> = self.parameters.iter().zip(&across).map(mirrored).collect();
        let least = |(at, value): (usize, &f64)| if across[at] { parameters[at].within(0.0) } else { *value };
        let values = self.values.iter().enumerate().map(least).collect();
        across.contains(&true).then_some((parameters, values))
    }

    /// Whether it ended for want of evaluations, not at a minimum.
    pub fn is_exhausted(&self) -> bool {
        self.termination == format!("{:?}", TerminationReason::LostPatience)
    }
}

/// Sum of squares in this unit (1: in that of the noise), residuals beyond [`TAIL`] of its root counted with their
/// logarithm.
pub fn robust_square(residuals: &DVector<f64>, unit: f64) -> f64 {
    robust_chi2(residuals, TAIL * unit.sqrt()) / unit
}

/// Sum of squares with residuals beyond `threshold` counted with their logarithm.
pub fn robust_chi2(residuals: &DVector<f64>, threshold: f64) -> f64 {
    residuals.iter().map(|&r| soften(r, threshold).0.powi(2)).sum()
}

/// Typical size of residuals, at least that of the noise.
pub fn typical_of(residuals: &DVector<f64>) -> f64 {
    crate::statistics::spread(residuals.iter().copied(), 0.0).max(1.0)
}

/// Schwarz's criterion of two hypotheses closer than this: the data do not decide between them. Odds of twenty to one
/// where both were as likely before (Kass and Raftery 1995).
pub const MARGIN: f64 = 6.0;

/// What Schwarz's criterion charges for parameters that so many readings are to tell, in variances that are known from
/// so many degrees of freedom: where few tell both, more (McQuarrie, Statist. Probab. Lett. 42 (1999) 79).
pub fn price(parameters: usize, readings: usize, freedom: f64) -> f64 {
    let (parameters, all) = (parameters as f64, readings as f64 + freedom);
    let few = if all.is_infinite() { 1.0 } else { all / (all - parameters - 2.0).max(f64::EPSILON) };
    parameters * (readings as f64).ln() * few
}

/// A sum of squares over so many readings, in variances that are known from so many degrees of freedom, as a deviance:
/// the variance is where both together are likeliest. That of variances that are stated is the sum itself.
pub fn deviance(square: f64, readings: usize, freedom: f64) -> f64 {
    let readings = readings as f64;
    if freedom.is_infinite() {
        return square;
    }
    let all = readings + freedom.max(1.0);
    readings + all * ((square - readings) / all).ln_1p()
}

/// Residual whose square is the loss, r^2 up to the threshold t and t^2 (1 + 2 ln(r/t)) beyond it (both and their
/// slopes meet there), and its derivative by the residual.
fn soften(r: f64, threshold: f64) -> (f64, f64) {
    let size = r.abs();
    if size <= threshold {
        return (r, 1.0);
    }
    let soft = threshold * (1.0 + 2.0 * (size / threshold).ln()).sqrt();
    (soft.copysign(r), threshold * threshold / (size * soft))
}

/// Minimises the sum of squares from `start` (values, not coordinates).
pub fn minimise(problem: &mut Problem<'_>, start: &[f64], settings: &Settings) -> Fit {
    let parameters = problem.parameters().to_vec();
    let before = problem.evaluations;
    if parameters.is_empty() {
        let evaluation = problem.evaluate(&[], true);
        let objective = robust_chi2(&evaluation.residuals, settings.threshold);
        let termination = "nothing to move".into();
        return Fit { parameters, values: Vec::new(), evaluation, objective, evaluations: 1, termination };
    }
    let held = held(problem, &parameters, start, settings.threshold);
    let coordinate = |((p, &x), held): ((&Parameter, &f64), &Option<f64>)| held.unwrap_or_else(|| p.coordinate(x));
    let u = DVector::from_iterator(start.len(), parameters.iter().zip(start).zip(&held).map(coordinate));
    let mut target = Target::new(problem, parameters, settings.threshold);
    target.held = held.iter().map(Option::is_some).collect();
    target.states = settings.states;
    target.set_params(&u);
    let patience = settings.evaluations / (start.len() + 1);
    let method = LevenbergMarquardt::new()
        .with_ftol(settings.converged)
        .with_xtol(1e-9)
        .with_gtol(1e-9)
        .with_stepbound(0.3)
        .with_patience(patience.max(1));
    let (target, report) = method.minimize(target);
    let Target { problem, parameters, best, .. } = target;
    let (objective, values, evaluation) = best;
    let spent = problem.solved >= settings.states;
    let termination =
        if spent { "its share of the budget is spent".into() } else { format!("{:?}", report.termination) };
    Fit { parameters, values, evaluation, objective, evaluations: problem.evaluations - before, termination }
}

/// Coordinates of the bounds at which parameters stay, since the sum of squares falls beyond (an active set): a step
/// along a coordinate that turns back there would lead uphill, and be made shorter for all.
fn held(problem: &mut Problem<'_>, parameters: &[Parameter], start: &[f64], threshold: f64) -> Vec<Option<f64>> {
    let edges: Vec<Option<(f64, f64)>> = parameters.iter().zip(start).map(|(p, &x)| p.edge(x)).collect();
    if edges.iter().all(Option::is_none) {
        return vec![None; start.len()];
    }
    let evaluation = problem.evaluate(start, true);
    let falls_beyond = |(j, edge): (usize, Option<(f64, f64)>)| {
        let (side, bound) = edge?;
        let softened = evaluation.residuals.iter().map(|&r| soften(r, threshold));
        let column = evaluation.jacobian.column(j);
        let gradient: f64 = softened.zip(&column).map(|((r, by), d)| r * by * d).sum();
        (gradient * parameters[j].natural_slope(start[j]) * side < 0.0).then_some(bound)
    };
    edges.into_iter().enumerate().map(falls_beyond).collect()
}

/// The problem as the library of the method sees it: beside the residuals of the readings one of each parameter, which
/// is zero where a step starts, and grows along its coordinate as much as all readings may by the error of the solver. It
/// moves no minimum; what the readings tell nothing about, where a quotient of two errors would be the step, stays where
/// it is.
struct Target<'p, 'a> {
    problem: &'p mut Problem<'a>,
    parameters: Vec<Parameter>,
    threshold: f64,
    /// Which parameters stay.
    held: Vec<bool>,
    states: u64,
    /// Slope of the residuals by a coordinate that is not known from zero.
    unknown: f64,
    u: DVector<f64>,
    evaluation: Option<Evaluation>,
    best: (f64, Vec<f64>, Evaluation),
}

impl<'p, 'a> Target<'p, 'a> {
    fn new(problem: &'p mut Problem<'a>, parameters: Vec<Parameter>, threshold: f64) -> Self {
        let nothing = Evaluation {
            residuals: DVector::zeros(0),
            jacobian: DMatrix::zeros(0, 0),
            predictions: Vec::new(),
            lost: false,
        };
        let best = (f64::INFINITY, Vec::new(), nothing);
        let held = vec![false; parameters.len()];
        let unknown = problem.error();
        let (states, u) = (u64::MAX, DVector::zeros(0));
        Self { problem, parameters, threshold, held, states, unknown, u, evaluation: None, best }
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Target<'_, '_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, u: &DVector<f64>) {
        if self.evaluation.is_some() && *u == self.u {
            return;
        }
        self.u = u.clone();
        let values: Vec<f64> = self.parameters.iter().zip(u.iter()).map(|(p, &u)| p.value(u)).collect();
        let evaluation = self.problem.evaluate(&values, true);
        let objective = robust_chi2(&evaluation.residuals, self.threshold);
        if objective < self.best.0 || self.best.1.is_empty() {
            self.best = (objective, values, evaluation.clone());
        }
        self.evaluation = Some(evaluation);
    }

    fn params(&self) -> DVector<f64> {
        self.u.clone()
    }

    /// None once the steady states allowed are solved, which ends the fit.
    fn residuals(&self) -> Option<DVector<f64>> {
        if self.problem.solved >= self.states {
            return None;
        }
        let residuals = &self.evaluation.as_ref()?.residuals;
        let softened = residuals.iter().map(|&r| soften(r, self.threshold).0);
        let all = residuals.len() + self.parameters.len();
        Some(DVector::from_iterator(all, softened.chain(std::iter::repeat_n(0.0, self.parameters.len()))))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let evaluation = self.evaluation.as_ref()?;
        let readings = evaluation.residuals.len();
        let mut jacobian = evaluation.jacobian.clone().resize_vertically(readings + self.parameters.len(), 0.0);
        for j in 0..self.parameters.len() {
            jacobian[(readings + j, j)] = self.unknown;
        }
        for (i, &r) in evaluation.residuals.iter().enumerate() {
            let by_residual = soften(r, self.threshold).1;
            for (j, parameter) in self.parameters.iter().enumerate() {
                let slope = if self.held[j] { 0.0 } else { parameter.slope(self.u[j]) };
                jacobian[(i, j)] *= by_residual * slope;
            }
        }
        Some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the readings off by `near`, the others by `far`.
    fn misfit(near: f64, far: f64) -> DVector<f64> {
        DVector::from_fn(100, |i, _| if i % 2 == 0 { near } else { far })
    }

    /// Twice the logarithm of the likelihood of n residuals and of an estimate of their variance with nu degrees of
    /// freedom, at the variance where that is largest.
    #[test]
    fn a_deviance_is_that_of_the_likeliest_variance() {
        let likelihood = |square: f64, n: f64, freedom: f64, variance: f64| {
            -(n + freedom) * variance.ln() - (square + freedom) / variance
        };
        let most = |square: f64, n: f64, freedom: f64| {
            let all = (1..40_000).map(|i| likelihood(square, n, freedom, 1e-3 * f64::from(i)));
            all.fold(f64::NEG_INFINITY, f64::max)
        };
        for (better, worse, freedom) in [(32.9, 72.5, 13.0), (20.0, 31.0, 5.0), (31.0, 500.0, 60.0)] {
            let expected = most(better, 31.0, freedom) - most(worse, 31.0, freedom);
            let found = deviance(worse, 31, freedom) - deviance(better, 31, freedom);
            assert!((found - expected).abs() < 1e-3, "{better} {worse} {freedom}: {found} {expected}");
        }
        // A variance that is known: the sum itself; near it also one that is known from many readings.
        assert_eq!(deviance(500.0, 31, f64::INFINITY), 500.0);
        assert!((deviance(40.0, 31, 1e6) - 40.0).abs() < 1e-4);
    }

    #[test]
    fn squares_in_a_unit_do_not_depend_on_that_of_the_readings() {
        let residuals = misfit(0.7, 30.0);
        for factor in [1e-3, 7.0, 1e4] {
            let scaled = robust_square(&(&residuals * factor), 9.0 * factor * factor);
            assert!((scaled / robust_square(&residuals, 9.0) - 1.0).abs() < 1e-12, "{factor}");
        }
    }

    #[test]
    fn what_is_left_far_above_the_noise_is_judged_by_its_squares() {
        // The mean of the logarithms prefers the first, that of the squares the second.
        let (uneven, even) = (misfit(40.0, 400.0), misfit(150.0, 150.0));
        assert!(robust_square(&uneven, 1.0) < robust_square(&even, 1.0));
        let unit = 150.0 * 150.0;
        assert!(robust_square(&uneven, unit) > robust_square(&even, unit));
    }
}
