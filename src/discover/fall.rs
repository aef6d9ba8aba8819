//! How the error falls as what was found grows from nothing to its fitted strength, all of it or a part of it.
//!
//! Each state on the way is a solution of the model at all measured points. Nothing is read between two laws: what a
//! strength says in between are the values of the parameters, which go in equal steps from the calibrated base to the
//! fit.

use super::hypothesis::{Addition, Hypothesis};
use super::select::Search;
use super::{Discovery, SearchOptions, Step};
use crate::compare::{self, Compared, Metrics};
use crate::fit::{Parameter, Prediction, Problem, values_in};
use crate::measurement::Point;
use crate::solver::cycle::Tolerance;
use rayon::prelude::*;
use std::sync::Arc;

/// Strengths from nothing to the fitted one, both included.
pub const STRENGTHS: usize = 21;
/// Most additions of which every combination is solved; of more, those that the ladder passes.
const COMBINED: usize = 3;

/// The fall of the error.
#[derive(Debug, Clone)]
pub struct Fall {
    /// What was found, in the order of the ladder.
    pub additions: Vec<String>,
    /// Its parts, from single additions to all of them, which is the last.
    pub parts: Vec<Part>,
}

/// Some of what was found.
#[derive(Debug, Clone)]
pub struct Part {
    /// Whether it has each of the additions.
    pub members: Vec<bool>,
    /// The model at each of the [`STRENGTHS`]: first the calibrated base, last the fit of this part.
    pub states: Vec<State>,
}

/// The model at one strength.
#[derive(Debug, Clone)]
pub struct State {
    /// Mean square of the residuals in standard deviations.
    pub chi2_per_point: f64,
    /// Root mean square error of the amplitude \[%\].
    pub rms_error_percent: f64,
    /// What it says of each point of the table.
    pub predictions: Vec<Prediction>,
}

/// Where a parameter of a fit begins.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Start {
    /// At this value: the calibrated one, or the one at which its effect vanishes.
    Value(f64),
    /// At infinity: its inverse grows from nothing.
    Infinity,
    /// Where the fit has it: the strength is another parameter, or the effect replaces a part of the base and has none.
    End,
}

impl Start {
    fn at(self, share: f64, end: f64) -> f64 {
        match self {
            Self::Value(value) => value + (end - value) * share,
            Self::Infinity => end / share,
            Self::End => end,
        }
    }
}

/// The fall of the error of a discovery; `None` where nothing was found, or where it would take as long as the search.
pub(super) fn fall(d: &Discovery) -> Option<Fall> {
    let end = &d.explanation().hypothesis;
    let costly = end.model.has_sliders() && end.model.effects.len() > 1;
    if end.additions.is_empty() || costly {
        return None;
    }
    let base = &d.steps[0];
    let (scenario, table) = (&base.comparison.scenario, &base.comparison.table);
    let options = SearchOptions::default();
    let search =
        Search::new(scenario, table, (&options, &Arc::default()), &scenario.free, base.hypothesis.model.clone());
    let part = |members: Vec<bool>| {
        let of: Vec<Addition> = end.additions.iter().zip(&members).filter(|(_, is)| **is).map(|(a, _)| *a).collect();
        let step = d.steps.iter().find(|step| step.hypothesis.additions == of);
        let hypothesis = step.map_or_else(|| search.refit(end, of), |step| step.hypothesis.clone());
        let last = step.map_or_else(|| hypothesis.fit.evaluation.predictions.clone(), predicted);
        let between = (1..STRENGTHS - 1).into_par_iter().map(|k| {
            let values = along(&hypothesis, &base.hypothesis, k as f64 / (STRENGTHS - 1) as f64);
            let points: Vec<&Point> = table.points.iter().collect();
            let model = hypothesis.model.clone();
            let mut problem = Problem::new(model, points, hypothesis.fit.parameters.clone(), Tolerance::FIT);
            problem.evaluate(&values, false).predictions
        });
        let mut all = vec![predicted(base)];
        all.extend(between.collect::<Vec<_>>());
        all.push(last);
        let state = |predictions| state(&base.comparison.points, &table.points, predictions);
        Part { members, states: all.into_iter().map(state).collect() }
    };
    let parts = parts(end.additions.len()).into_par_iter().map(part).collect();
    Some(Fall { additions: end.additions.iter().map(|a| a.name().to_string()).collect(), parts })
}

/// The parts of so many additions.
fn parts(count: usize) -> Vec<Vec<bool>> {
    match count {
        0..=COMBINED => (1..1usize << count).map(|bits| (0..count).map(|k| bits >> k & 1 == 1).collect()).collect(),
        _ => (1..=count).map(|length| (0..count).map(|k| k < length).collect()).collect(),
    }
}

fn predicted(step: &Step) -> Vec<Prediction> {
    step.comparison.points.iter().map(|p| p.model.clone()).collect()
}

fn state(base: &[Compared], points: &[Point], predictions: Vec<Prediction>) -> State {
    let compared = compare::compared(points, &predictions);
    let Metrics { chi2_per_point, .. } = Metrics::over(compared.iter());
    let rms_error_percent = compare::rms_error_beside(compared.iter(), base.iter());
    State { chi2_per_point, rms_error_percent, predictions }
}

/// Values of the parameters of a fit at a share of the way from the base.
pub(super) fn along(hypothesis: &Hypothesis, base: &Hypothesis, share: f64) -> Vec<f64> {
    let fit = &hypothesis.fit;
    fit.parameters.iter().zip(&fit.values).map(|(p, &end)| start(p, base).at(share, end)).collect()
}

fn start(parameter: &Parameter, base: &Hypothesis) -> Start {
    let Hypothesis { model, fit, .. } = base;
    if let Some(own) = fit.parameters.iter().position(|p| p.key == parameter.key) {
        return Start::Value(fit.values[own]);
    }
    let Some(key) = parameter.key.strip_prefix("effect.") else {
        // A number of rig or instrument that the calibration left as stated.
        return values_in(model, std::slice::from_ref(parameter))
            .first()
            .map_or(Start::End, |value| Start::Value(*value));
    };
    let zero = key.rsplit_once('.').and_then(|(name, key)| {
        let effect = model.catalogue().find(|effect| effect.name() == name)?;
        let number = effect.parameters().iter().position(|info| info.key == key)?;
        effect.zero().iter().find(|zero| zero.parameter == number)
    });
    match zero {
        Some(zero) if zero.value.is_finite() => Start::Value(zero.value),
        Some(_) => Start::Infinity,
        None => Start::End,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strength_goes_from_where_nothing_is_added_to_the_fit() {
        assert_eq!([0.0, 0.5, 1.0].map(|share| Start::Value(2.0).at(share, 6.0)), [2.0, 4.0, 6.0]);
        assert_eq!([0.5, 1.0].map(|share| Start::Infinity.at(share, 6.0)), [12.0, 6.0]);
        assert_eq!([0.5, 1.0].map(|share| Start::End.at(share, 6.0)), [6.0, 6.0]);
    }

    #[test]
    fn of_three_additions_all_parts_are_there_and_the_whole_is_the_last() {
        assert_eq!(parts(1), [[true]]);
        assert_eq!(parts(3).len(), 7);
        assert_eq!(parts(3).last().unwrap(), &[true; 3]);
        assert_eq!(
            parts(4),
            [[true, false, false, false], [true, true, false, false], [true, true, true, false], [true; 4]]
        );
    }
}
