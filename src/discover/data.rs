//! What a search works on, and the one fit that everything in it is made by.

use super::SearchOptions;
use super::hypothesis::{Addition, Hypothesis};
use crate::compare::TIGHTER;
use crate::fit::{
    Fit, Parameter, Problem, Settings, TAIL, cost, minimise, model_with, parameter, price, robust_chi2, typical_of,
    values_in,
};
use crate::measurement::{Noise, Point};
use crate::model::Model;
use crate::solver::cycle::Tolerance;
use nalgebra::DVector;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Relative change of the sum of squares at which a fit to some of the points is done, and one to all.
const CLOSE: f64 = 1e-4;
const CLOSER: f64 = 1e-6;

/// The readings, and the model that is to explain them.
#[derive(Clone)]
pub struct Data<'a> {
    /// The model of the scenario, not calibrated.
    pub base: Model,
    /// All points.
    pub points: &'a [Point],
    /// Degrees of freedom that their deviations are known from.
    freedom: f64,
    /// Their numbers such that any first part of them is spread over all series.
    order: Vec<usize>,
    /// Values that the scenario states for the parameters that a calibration may move: once something is missing, the
    /// calibrated ones may be far off.
    pub stated: Vec<f64>,
    /// Number of series.
    series: usize,
    /// Keys of those parameters.
    free: Vec<String>,
    /// Steady states that may be solved.
    pub budget: u64,
    /// Steady states solved by all searches that count here, and before this one.
    counter: Arc<AtomicU64>,
    before: u64,
}

/// How far a fit is taken.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Points; where these are all, also the accuracy at which hypotheses are ranked.
    pub points: usize,
    /// Evaluations.
    pub evaluations: usize,
    /// Steady states, each counted as what it costs: the fit ends with the evaluation that reaches so many.
    pub states: u64,
}

impl<'a> Data<'a> {
    /// The points, and from how many degrees of freedom their deviations are known, as a model sees them whose
    /// parameters `free` move.
    pub fn new(
        base: Model,
        free: &[String],
        (points, freedom): (&'a [Point], f64),
        (budget, counter): (u64, &Arc<AtomicU64>),
    ) -> Self {
        let parameters: Vec<Parameter> = free.iter().filter_map(|key| parameter(&base, key)).collect();
        let stated = values_in(&base, &parameters);
        Self {
            base,
            points,
            freedom,
            order: spread_out(points),
            stated,
            series: points.last().map_or(0, |p| p.series + 1),
            free: free.to_vec(),
            budget,
            counter: Arc::clone(counter),
            before: counter.load(Relaxed),
        }
    }

    /// The same at the same points with other standard deviations.
    pub fn over<'t>(&'t self, points: &'t [Point]) -> Data<'t> {
        Data { points, ..self.clone() }
    }

    /// Points on which a race begins.
    pub fn begins_on(&self, options: &SearchOptions) -> usize {
        let count = self.points.len();
        options.begins_on(self.series, readings(self.points) as f64 / count.max(1) as f64).min(count)
    }

    /// So many of the points in their order.
    pub fn some(&self, count: usize) -> Vec<&'a Point> {
        let mut chosen: Vec<usize> = self.order.iter().copied().take(count).collect();
        chosen.sort_unstable();
        chosen.into_iter().map(|index| &self.points[index]).collect()
    }

    /// The residuals of all points that belong to so many of them.
    pub fn part(&self, residuals: &DVector<f64>, count: usize) -> DVector<f64> {
        let mut chosen = vec![false; self.points.len()];
        self.order.iter().take(count).for_each(|&index| chosen[index] = true);
        let rows = self.points.iter().zip(chosen).flat_map(|(p, chosen)| (0..readings([p])).map(move |_| chosen));
        DVector::from_vec(residuals.iter().zip(rows).filter(|(_, chosen)| *chosen).map(|(&r, _)| r).collect())
    }

    /// A hypothesis in standard deviations that are so many times as large.
    pub fn reweighted(&self, hypothesis: Hypothesis, noise: Noise) -> Hypothesis {
        let of = |p: &Point| [Some(noise.amplitude), p.phase.map(|_| noise.phase)];
        let all = DVector::from_vec(self.points.iter().flat_map(of).flatten().map(f64::recip).collect());
        // A fit to some of the points is to the first of their order that have so many readings.
        let weights = |rows: usize| {
            let mut count = 0;
            let first = self.order.iter().position(|&index| {
                let before = count;
                count += readings([&self.points[index]]);
                before >= rows
            });
            self.part(&all, first.unwrap_or(self.points.len()))
        };
        let Hypothesis { mut fit, mut estimate, .. } = hypothesis;
        let own = weights(fit.evaluation.residuals.len());
        fit.evaluation.residuals.component_mul_assign(&own);
        fit.evaluation.jacobian.column_iter_mut().for_each(|mut column| column.component_mul_assign(&own));
        if let Some(estimate) = &mut estimate {
            let own = weights(estimate.residuals.len());
            estimate.residuals.component_mul_assign(&own);
        }
        Hypothesis { fit, estimate, ..hypothesis }
    }

    /// Readings: amplitudes and phases.
    pub fn readings(&self) -> usize {
        readings(self.points)
    }

    /// What Schwarz's criterion charges for parameters.
    pub fn price(&self, parameters: usize) -> f64 {
        price(parameters, self.readings(), self.freedom)
    }

    /// Steady states solved so far, by all threads.
    pub fn solved(&self) -> u64 {
        self.counter.load(Relaxed) - self.before
    }

    /// Counts steady states.
    pub fn count(&self, solved: u64) {
        self.counter.fetch_add(solved, Relaxed);
    }

    /// What the search may solve yet, which leaves a part of the budget for intervals.
    pub fn left(&self) -> u64 {
        (self.budget - self.budget / INTERVALS).saturating_sub(self.solved())
    }

    /// A fit to all points, one of so many that are made at once, with its share of what is left: asked while none is
    /// under way, so that it is the same for any number of threads.
    pub fn effort(&self, evaluations: usize, among: usize) -> Effort {
        Effort { points: self.points.len(), evaluations, states: self.share(among) }
    }

    /// The same of a fit that has to be made, however little is left.
    pub fn last_effort(&self, evaluations: usize) -> Effort {
        let effort = self.effort(evaluations, 1);
        Effort { states: effort.states.max(self.budget / (INTERVALS * SHARE)), ..effort }
    }

    /// Steady states that each of so many fits may solve.
    pub fn share(&self, among: usize) -> u64 {
        self.left() / SHARE.max(among as u64)
    }

    /// Whether a fit is expected to cost no more than it may: what does is not begun.
    pub fn affords(&self, model: &Model, effort: Effort) -> bool {
        let points = effort.points.min(self.points.len()).min(DENSE * self.series);
        (points * effort.evaluations) as u64 * cost(model) < effort.states
    }

    /// Parameters that move where these are added: those of an effect with the signs that the model has, all others
    /// about the values that the base has, wherever fits have carried them since, but for a value that is beyond the
    /// bounds there.
    pub fn movable(&self, model: &Model, additions: &[Addition]) -> Vec<Parameter> {
        let keys = self.free.iter().cloned().chain(additions.iter().flat_map(Addition::keys));
        keys.filter_map(|key| self.about(model, &key)).collect()
    }

    fn about(&self, model: &Model, key: &str) -> Option<Parameter> {
        let own = parameter(model, key)?;
        let of_base = parameter(&self.base, key).filter(|_| !key.starts_with("effect."));
        let value = values_in(model, std::slice::from_ref(&own))[0];
        Some(of_base.filter(|of_base| of_base.reaches(value)).unwrap_or(own))
    }

    /// The same of a hypothesis, in its order, and of one more addition.
    pub fn beside(&self, model: &Model, from: &Hypothesis, addition: Addition) -> Vec<Parameter> {
        let keys = from.fit.parameters.iter().map(|p| p.key.clone()).chain(addition.keys());
        keys.filter_map(|key| self.about(model, &key)).collect()
    }

    /// Fits the parameters of a model from a start, whose residuals are about as large as `typical` (infinite where
    /// that is not known): what is far larger than those counts little. A strength that comes to nothing and would go on to
    /// the other sign is followed there, too.
    pub fn fit(&self, model: &Model, parameters: &[Parameter], start: &[f64], typical: f64, effort: Effort) -> Fit {
        let fit = self.fit_of_signs(model, parameters, start, typical, effort);
        let Some((parameters, values)) = fit.across_zero() else { return fit };
        let across = self.fit_of_signs(model, &parameters, &values, typical, effort);
        let threshold = TAIL * typical_of(&fit.evaluation.residuals);
        let left = |fit: &Fit| robust_chi2(&fit.evaluation.residuals, threshold);
        if left(&across) < left(&fit) { across } else { fit }
    }

    fn fit_of_signs(
        &self,
        model: &Model,
        parameters: &[Parameter],
        start: &[f64],
        typical: f64,
        effort: Effort,
    ) -> Fit {
        let all = effort.points >= self.points.len();
        let (tolerance, converged) = if all { (Tolerance::FIT, CLOSER) } else { (Tolerance::COARSE, CLOSE) };
        let mut problem = Problem::new(model.clone(), self.some(effort.points), parameters.to_vec(), tolerance);
        let mut threshold = TAIL * typical.max(1.0);
        let mut values = start.to_vec();
        loop {
            let left = effort.evaluations.saturating_sub(problem.evaluations).max(1);
            let settings = Settings { evaluations: left, threshold, converged, states: effort.states };
            let fit = minimise(&mut problem, &values, &settings);
            let tighter = TAIL * typical_of(&fit.evaluation.residuals);
            let pulled = fit.evaluation.residuals.amax() > tighter && tighter < TIGHTER * threshold;
            if !pulled || problem.evaluations >= effort.evaluations || problem.solved >= effort.states {
                self.count(problem.solved);
                return Fit { evaluations: problem.evaluations, ..fit };
            }
            (threshold, values) = (tighter, fit.values);
        }
    }

    /// A hypothesis fitted to all points from the values that it has.
    pub fn fitted(&self, hypothesis: Hypothesis, effort: Effort) -> Hypothesis {
        let Hypothesis { model, fit, .. } = &hypothesis;
        let typical = typical_of(&fit.evaluation.residuals);
        let found = self.fit(model, &fit.parameters, &fit.values, typical, effort);
        let model = with_signs(model, &found);
        let better = Hypothesis { model, fit: found, estimate: None, ..hypothesis.clone() };
        if hypothesis.is_full(self.points.len()) && !better.fits_better_than(&hypothesis) {
            let fit = Fit { termination: better.fit.termination, ..hypothesis.fit };
            return Hypothesis { model: hypothesis.model, fit, ..better };
        }
        better
    }
}

/// The model with strengths of the signs that a fit found, from which later fits begin.
pub(super) fn with_signs(model: &Model, fit: &Fit) -> Model {
    let stated = values_in(model, &fit.parameters);
    let turned =
        fit.parameters.iter().zip(&fit.values).zip(stated).filter(|((p, x), stated)| p.signed && *x * stated < 0.0);
    turned.fold(model.clone(), |model, ((p, x), _)| model_with(&model, std::slice::from_ref(p), &[*x]))
}

/// Part of the budget that is kept for intervals, one over this.
const INTERVALS: u64 = 4;
/// Largest part of what is left that one fit may cost, one over this, however few there are.
const SHARE: u64 = 4;
/// Steady states that a densely measured series takes, about.
const DENSE: usize = 100;

/// Amplitudes and phases of points.
pub fn readings<'p>(points: impl IntoIterator<Item = &'p Point>) -> usize {
    points.into_iter().map(|p| 1 + usize::from(p.phase.is_some())).sum()
}

/// Numbers of points such that every first part of them is spread over all series and over each: by the van der Corput
/// sequence along each.
fn spread_out(points: &[Point]) -> Vec<usize> {
    let series = points.iter().map(|p| p.series).max().map_or(0, |last| last + 1);
    let mut keys: Vec<(f64, usize)> = Vec::with_capacity(points.len());
    for of in 0..series {
        let own: Vec<usize> = (0..points.len()).filter(|&i| points[i].series == of).collect();
        let count = own.len();
        let mut chosen = vec![false; count];
        let mut rank = 0.5;
        // The middle, the quarters, the eighths, ...
        for number in 1_u32.. {
            if rank > count as f64 {
                break;
            }
            let place = (count as f64 * f64::from(number.reverse_bits()) / 2f64.powi(32)) as usize;
            if std::mem::replace(&mut chosen[place], true) {
                continue;
            }
            keys.push((rank / count as f64, own[place]));
            rank += 1.0;
        }
    }
    keys.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    keys.into_iter().map(|(_, index)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::hypothesis::extended;
    use crate::discover::select::Search;

    #[test]
    fn every_first_part_of_the_points_is_spread_over_all_series_and_along_each() {
        let point = |row: usize, series: usize| Point {
            row,
            line: row,
            speed: 0.0,
            load: 0.0,
            drive: 1.0,
            frequency: 1.0 + row as f64,
            amplitude: 1.0,
            phase: None,
            amplitude_sd: 1.0,
            phase_sd: None,
            mean: None,
            replicates: 1,
            series,
        };
        let points: Vec<Point> = (0..90).map(|row| point(row, usize::from(row >= 30))).collect();
        let order = spread_out(&points);
        let mut all = order.clone();
        all.sort_unstable();
        assert_eq!(all, (0..90).collect::<Vec<_>>());
        for (first, of_first) in [(6, 2), (12, 4), (45, 15)] {
            assert_eq!(order[..first].iter().filter(|&&i| i < 30).count(), of_first, "{first}");
        }
        // The first of either series lies in its middle.
        assert!(order[..3].contains(&15) && order[..3].contains(&60), "{order:?}");
    }

    /// Amplitudes of a velocity of 66 Hz and quality 2.9 on a share of the drive, b_r = 1.1 and b_i = 0.13, to a thousandth.
    #[test]
    fn a_strength_of_the_wrong_sign_goes_on_through_zero() {
        let folder = tempfile::tempdir().expect("a folder");
        let row = |n: u32| {
            let x = 0.6 + 0.02 * f64::from(n);
            let (re, im) = (2.9 * (x - 1.0 / x), 1.0);
            let size = re * re + im * im;
            let reading = (1.1 + 2.9 * im / size).hypot(0.13 - 2.9 * re / size);
            let noise = 1.0 + 0.002 * (f64::from(n * 7919 % 101) / 101.0 - 0.5);
            format!("{},1,{},0.1\n", 66.0 * x, 3.0 * reading * noise)
        };
        let text: String = (0..41).map(row).collect();
        std::fs::write(
            folder.path().join("t.csv"),
            format!("frequency_hz,drive_v,amplitude_v,amplitude_sd_percent\n{text}"),
        )
        .expect("a table");
        let text = "title = 't'\n[rig]\nkind = 'oscillator'\ndrive = 'force'\nnatural_frequency = '65 Hz'\nquality_factor = 2.5\n\
             [instrument]\nsensitivity = '4000 V s/m'\ndrive_sensitivity = '1 V/N'\n[measurement]\nfile = 't.csv'\n[fit]\n\
             free = ['rig.natural_frequency', 'rig.quality_factor', 'instrument.sensitivity']\n";
        std::fs::write(folder.path().join("t.toml"), text).expect("a scenario");
        let scenario = crate::scenario::load(folder.path().join("t.toml")).expect("a scenario");
        let table = crate::measurement::load(&scenario).expect("a table").expect("measurements");
        let (scenario, options) = (table.applied_to(&scenario), SearchOptions::default());
        let (search, start) = Search::begin(&scenario, &table, &options, &Arc::default());
        let crosstalk = *search.pool.iter().find(|a| a.name() == "crosstalk").expect("a candidate");
        let mut stuck = 0;
        for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let mut model = extended(&start.fitted(), &[crosstalk]);
            model.effects[0].1 = signs.map(|sign| 0.3 * sign).to_vec();
            let parameters = search.data.beside(&model, &start, crosstalk);
            let values = values_in(&model, &parameters);
            let effort = Effort { points: 41, evaluations: 400, states: u64::MAX };
            let alone = search.data.fit_of_signs(&model, &parameters, &values, f64::INFINITY, effort);
            stuck += usize::from(alone.evaluation.chi2() > 100.0 * 41.0);
            let fit = search.data.fit(&model, &parameters, &values, f64::INFINITY, effort);
            let chi2 = fit.evaluation.chi2() / 41.0;
            assert!(chi2 < 1.5, "{signs:?}: {chi2} at {:?}", fit.values);
            let found = with_signs(&model, &fit).effects[0].1.clone();
            assert!(found.iter().zip(&fit.values[3..]).all(|(own, of)| own * of > 0.0), "{found:?} {:?}", fit.values);
        }
        assert!(stuck > 0, "no start was stuck at zero");
    }
}
