//! Moving the free parameters of a scenario to where its model fits best.

use super::{Label, STATES, Setting};
use crate::fit::{CONVERGED, Fit, Parameter, Problem, Settings, TAIL, minimise, parameter, robust_chi2, typical_of};
use crate::fit::{placed, resonance};
use crate::measurement::{Point, Series, Table};
use crate::model::{Model, Operation};
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use nalgebra::DVector;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Starts besides the stated values.
const STARTS: usize = 12;
/// Starts that are followed to their end.
const FOLLOWED: usize = 2;
/// Times that a fit which met a bound begins again, and the share of the sum of squares by which that has to lower it.
const RESTARTS: usize = 8;
const LOWER: f64 = 1e-3;
/// A robust fit is made again where what it leaves has become smaller than this share of what it was.
pub(crate) const TIGHTER: f64 = 0.9;
/// Mean square of the residuals beyond which they are more than a noise that was estimated from the scatter of the
/// readings along series: that estimate is known to a fifth or so.
pub const EXCESS: f64 = 2.0;
/// Evaluations of one fit at most.
const EVALUATIONS: usize = 60;
/// A calibrated model.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The model that the ranges of the fit are about: as it is stated, or where a calibration that met a bound began
    /// again.
    pub base: Model,
    /// The fit.
    pub fit: Fit,
    /// Residuals beyond this counted linearly.
    pub threshold: f64,
    /// Steady states solved for it.
    pub solved: u64,
}

impl Calibration {
    /// Keys of the parameters of rig, contact and instrument that ended at a bound of the search.
    pub fn at_bounds(&self) -> Vec<&str> {
        let ends = self.fit.parameters.iter().zip(&self.fit.values);
        ends.filter(|(p, value)| !p.key.starts_with("effect.") && p.at_bound(**value))
            .map(|(p, _)| p.key.as_str())
            .collect()
    }
}

/// Load, speed and drive of every series of a table.
pub fn settings_of(scenario: &Scenario, table: &Table) -> Vec<Setting> {
    let (signal, contact) = (table.signals.drive, scenario.contact.is_some());
    let of = |series: &Series| {
        let Series { speed, load, drive, .. } = *series;
        Setting { speed, load, drive, signal, contact, number: 0, name: Label::of(&series.name) }
    };
    let settings: Vec<Setting> = table.series.iter().map(of).collect();
    let number = |at: usize| {
        let is_other = |(other, setting): (usize, &Setting)| other == at || !setting.is_alike(&settings[at]);
        let drives = table.series[at].drives;
        if settings.iter().enumerate().all(is_other) && drives.0 == drives.1 { 0 } else { at + 1 }
    };
    settings.iter().enumerate().map(|(at, setting)| Setting { number: number(at), ..*setting }).collect()
}

/// The problem of moving the parameters named `keys` of `model`.
pub fn problem<'a>(
    model: &Model,
    keys: &[String],
    points: impl IntoIterator<Item = &'a Point>,
    tolerance: Tolerance,
) -> Problem<'a> {
    let parameters = keys.iter().filter_map(|key| parameter(model, key)).collect();
    Problem::new(model.clone(), points, parameters, tolerance)
}

/// Fits the parameters named `keys`, starting from the model's own values, from those that a linear resonance of the
/// readings has, and from others within their ranges (quasi-random, by `seed`). A fit that ends at a bound begins again
/// about it, while that lowers the sum of squares. Residuals that are many times the typical one count linearly. The
/// fit is no more accurate than [`Tolerance::FIT`]: at full accuracy, points without a steady state that it passes take
/// seconds each. Residuals and derivatives at its end are as accurate as `tolerance` says.
pub fn calibrate(model: &Model, keys: &[String], points: &[Point], tolerance: Tolerance, seed: u32) -> Calibration {
    let operations: Vec<(Operation, f64)> = points.iter().map(|p| (crate::fit::operation(p), p.amplitude)).collect();
    let model = model.clone().scaled_at(&operations);
    let about = |model: &Model, spent: u64| {
        calibrate_about(model, keys, points, tolerance, (seed, STATES.saturating_sub(spent)))
    };
    let mut best = about(&model, 0);
    let started = placed::started(&model, keys, points).map(|model| model.scaled_at(&operations));
    let mut solved = best.solved;
    if let Some(other) = started.map(|model| about(&model, solved)) {
        solved += other.solved;
        if other.fit.objective < best.fit.objective {
            best = other;
        }
    }
    for _ in 0..RESTARTS {
        // A contact that leaves its range has left the motion: what it does beyond is nothing that a search could start
        // from.
        if solved >= STATES || best.at_bounds().iter().all(|key| key.starts_with("contact.")) {
            break;
        }
        let there = problem(&best.base, keys, [], tolerance).model(&best.fit.values).scaled_at(&operations);
        // Beside something that is missing a flank may leave less than the peak that the readings show.
        if resonance::left_readings(&there, points).is_some() {
            break;
        }
        let other = about(&there, solved);
        solved += other.solved;
        // Of a number that the data do not determine any value does.
        if other.fit.objective > best.fit.objective * (1.0 - LOWER) {
            break;
        }
        best = other;
    }
    Calibration { solved, ..best }
}

/// Most evaluations of the model that [`calibrate_about`] takes, but for a robust fit that goes on getting tighter.
pub const MOST: usize = 1 + STARTS + (FOLLOWED + 1) * EVALUATIONS;

/// A calibration as [`calibrate`] within the ranges about the values that the model has, and no further; every fit of
/// it ends with the evaluation that reaches so many steady states.
pub fn calibrate_about(
    model: &Model,
    keys: &[String],
    points: &[Point],
    tolerance: Tolerance,
    (seed, states): (u32, u64),
) -> Calibration {
    let stated = problem(model, keys, points, tolerance.for_search());
    let search = Search { stated: &stated, states, solved: AtomicU64::new(0) };
    let mut fit = search.settled(search.best_of_starts(seed));
    let is_noise = |fit: &Fit| typical_of(&fit.evaluation.residuals).powi(2) <= EXCESS;
    if !is_noise(&fit) {
        // A stretch of readings that are far off may have carried the squares away, where the stated values leave of
        // most others nothing but noise.
        let start = stated.values();
        let typical = typical_of(&search.residuals(&start));
        let other = search.settled(search.minimised(&start, TAIL * typical));
        if is_noise(&other) {
            fit = other;
        }
    }
    let threshold = threshold_of(&fit);
    if tolerance.for_search() != tolerance {
        fit.evaluation = problem(model, keys, points, tolerance).evaluate(&fit.values, true);
    }
    fit.objective = robust_chi2(&fit.evaluation.residuals, threshold);
    Calibration { base: model.clone(), fit, threshold, solved: search.solved.into_inner() }
}

/// The residual beyond which a fit counts linearly.
fn threshold_of(fit: &Fit) -> f64 {
    TAIL * typical_of(&fit.evaluation.residuals)
}

/// The fits of one calibration, which count the steady states that they solve.
struct Search<'p, 'a> {
    stated: &'p Problem<'a>,
    /// Steady states with which a fit ends.
    states: u64,
    solved: AtomicU64,
}

impl Search<'_, '_> {
    fn minimised(&self, start: &[f64], threshold: f64) -> Fit {
        let mut problem = self.stated.clone();
        let settings = Settings { evaluations: EVALUATIONS, threshold, converged: CONVERGED, states: self.states };
        let fit = minimise(&mut problem, start, &settings);
        self.solved.fetch_add(problem.solved, Relaxed);
        fit
    }

    fn residuals(&self, values: &[f64]) -> DVector<f64> {
        let mut problem = self.stated.clone();
        let residuals = problem.evaluate(values, false).residuals;
        self.solved.fetch_add(problem.solved, Relaxed);
        residuals
    }

    /// The best least-squares fit from the stated values and from the most promising of the other starts.
    fn best_of_starts(&self, seed: u32) -> Fit {
        let (stated, parameters) = (self.stated.values(), self.stated.parameters());
        let (others, followed) = if parameters.is_empty() { (0, 1) } else { (STARTS as u32, FOLLOWED) };
        let others = (0..others).map(|i| scattered(parameters, i, seed));
        let starts: Vec<Vec<f64>> = std::iter::once(stated).chain(others).collect();
        let square = |start: &Vec<f64>| robust_chi2(&self.residuals(start), TAIL);
        let mut tried: Vec<(f64, &Vec<f64>)> = starts.par_iter().map(|start| (square(start), start)).collect();
        // The stated values are always followed.
        tried[1..].sort_by(|a, b| a.0.total_cmp(&b.0));
        let follow = |start: &[f64]| self.minimised(start, f64::INFINITY);
        let fits: Vec<Fit> = tried.par_iter().take(followed).map(|(_, start)| follow(start)).collect();
        let best = fits.into_iter().min_by(|a, b| a.objective.total_cmp(&b.objective));
        best.unwrap_or_else(|| follow(&starts[0]))
    }

    /// A fit made again while it gets tighter: what is far off has less pull the better the others fit.
    fn settled(&self, mut fit: Fit) -> Fit {
        let mut threshold = threshold_of(&fit);
        while fit.evaluation.residuals.amax() > threshold {
            fit = self.minimised(&fit.values, threshold);
            if threshold_of(&fit) > TIGHTER * threshold {
                break;
            }
            threshold = threshold_of(&fit);
        }
        fit
    }
}

/// A quasi-random start within the ranges of the parameters.
fn scattered(parameters: &[Parameter], number: u32, seed: u32) -> Vec<f64> {
    let share = |dimension: usize| f64::from(sobol_burley::sample(number, dimension as u32, seed));
    parameters.iter().enumerate().map(|(d, p)| p.within(share(d))).collect()
}
