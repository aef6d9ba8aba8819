//! Moving the free parameters of a scenario to where its model fits best.

use super::{Label, Outlier, STATES, Setting};
use crate::fit::{CONVERGED, Fit, Parameter, Problem, Settings, TAIL, minimise, parameter, robust_chi2, typical_of};
use crate::fit::{placed, resonance};
use crate::measurement::{Point, Series, Table};
use crate::model::{Model, Operation};
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use crate::statistics::{median, spread};
use nalgebra::{DMatrix, DVector};
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
/// A residual this many times the scatter of its neighbours about a line, or the step from one to the next, away from
/// that line stands out ...
const OUTLYING: f64 = 5.0;
/// Share of such a step that counts as scatter.
const STEP: f64 = 0.6;
/// ... and so many standard deviations from the parabola through them.
const OFF_PARABOLA: f64 = 4.5;
/// Neighbours on either side.
const NEIGHBOURS: usize = 3;

/// Relative difference of the drives of two series below which their numbers tell them apart.
const ALIKE: f64 = 0.02;

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
    let same =
        |s: &Series, o: &Series| (s.speed, s.load) == (o.speed, o.load) && (s.drive / o.drive - 1.0).abs() < ALIKE;
    let number = |at: usize| {
        let series = &table.series[at];
        let told = table.series.iter().enumerate().all(|(other, s)| other == at || !same(s, series));
        if told && series.drives.0 == series.drives.1 { 0 } else { at + 1 }
    };
    let setting = |(at, series): (usize, &Series)| {
        let Series { speed, load, drive, .. } = *series;
        let name = Label::of(&series.name);
        Setting { speed, load, drive, signal, contact, number: number(at), name }
    };
    table.series.iter().enumerate().map(setting).collect()
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

/// Readings that are far off where their neighbours along the frequency are not. `residuals` holds (row, residual) of
/// one column of one curve, in the order of the frequency; `noise` is that of the readings over the stated one. What
/// stands out is taken out and the others are looked at again: of several near each other one may hide the others.
pub(crate) fn outliers(column: &'static str, residuals: &[(usize, f64)], noise: f64) -> Vec<Outlier> {
    let mut kept = residuals.to_vec();
    let mut found: Vec<Outlier> = Vec::new();
    loop {
        let next = far_off(column, &kept, noise);
        if next.is_empty() {
            found.sort_by_key(|outlier| residuals.iter().position(|(row, _)| *row == outlier.row));
            return found;
        }
        kept.retain(|(row, _)| !next.iter().any(|outlier| outlier.row == *row));
        found.extend(next);
    }
}

/// Those of them that their neighbours tell at once.
fn far_off(column: &'static str, residuals: &[(usize, f64)], noise: f64) -> Vec<Outlier> {
    let mut found = Vec::new();
    for (i, &(row, residual)) in residuals.iter().enumerate() {
        // As many on one side as are missing on the other.
        let first = i.saturating_sub(NEIGHBOURS).min(residuals.len().saturating_sub(2 * NEIGHBOURS + 1));
        let range = first..(first + 2 * NEIGHBOURS + 1).min(residuals.len());
        let near: Vec<(f64, f64)> = range.filter(|&j| j != i).map(|j| (j as f64 - i as f64, residuals[j].1)).collect();
        if near.len() < NEIGHBOURS {
            continue;
        }
        // Along the line through the neighbours (Theil 1950, Sen 1968): at the end of a curve on which a model fails
        // smoothly they are all on one side.
        let pairs = near.iter().enumerate().flat_map(|(n, a)| near[..n].iter().map(move |b| (a.1 - b.1) / (a.0 - b.0)));
        let slope = median(pairs);
        let level: Vec<f64> = near.iter().map(|(step, residual)| residual - slope * step).collect();
        let middle = median(level.iter().copied());
        let scatter = spread(level, middle);
        // Where a model fails, its residuals run steeply and bend: a step from one neighbour to the next is no
        // surprise.
        let step = median(near.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()));
        let off_line = (residual - middle).abs() > OUTLYING * scatter.max(STEP * step).max(noise);
        if off_line && off_parabola(residual, &near, noise) {
            found.push(Outlier { row, column, sigma: residual, off_neighbours: residual - middle });
        }
    }
    found
}

/// Whether a residual is further from the parabola through its neighbours (step, residual) than noise takes it: at the
/// end of a curve, where neighbours are on one side, that is known less well. One of them, the one that fits least to
/// the others, is left out: it may stand out itself.
fn off_parabola(residual: f64, near: &[(f64, f64)], noise: f64) -> bool {
    let without = |skipped: usize| {
        let kept: Vec<(f64, f64)> = (0..near.len()).filter(|&i| i != skipped).map(|i| near[i]).collect();
        let design = DMatrix::from_fn(kept.len(), 3, |row, power| kept[row].0.powi(power as i32));
        let values = DVector::from_iterator(kept.len(), kept.iter().map(|(_, residual)| *residual));
        let inverse = (design.transpose() * &design).try_inverse()?;
        let parabola = &inverse * design.transpose() * &values;
        Some(((values - design * &parabola).norm_squared(), parabola[0], inverse[(0, 0)]))
    };
    // Of four neighbours or fewer there is none that could miss.
    let fits = (0..near.len()).filter(|_| near.len() > 4).filter_map(without);
    let Some((_, there, variance)) = fits.min_by(|a, b| a.0.total_cmp(&b.0)) else { return true };
    (residual - there).abs() > OFF_PARABOLA * noise * (1.0 + variance).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals without noise: what stands out is known.
    fn rows(residual: impl Fn(f64) -> f64) -> Vec<(usize, f64)> {
        (0..24).map(|row| (row, residual(row as f64))).collect()
    }

    #[test]
    fn a_smooth_misfit_has_no_outliers_and_a_reading_far_off_is_one_wherever_it_stands() {
        for smooth in [|x: f64| 60.0 - 8.0 * x, |x: f64| 100.0 * (0.2 * x).sin(), |x: f64| 0.5 * x * x] {
            assert_eq!(outliers("amplitude_rad", &rows(smooth), 1.0), []);
        }
        for far in [0, 1, 12, 23] {
            let found =
                outliers("amplitude_rad", &rows(|x| 60.0 - 8.0 * x + if x == far as f64 { 30.0 } else { 0.0 }), 1.0);
            assert_eq!(found.iter().map(|o| o.row).collect::<Vec<_>>(), [far]);
        }
    }

    #[test]
    fn two_readings_off_side_by_side_hide_neither() {
        for (first, size) in [(0, 20.0), (11, 12.0), (22, 20.0)] {
            let found = outliers(
                "amplitude_rad",
                &rows(|x| if x == f64::from(first) || x == f64::from(first) + 1.0 { size } else { 0.0 }),
                1.0,
            );
            let found: Vec<usize> = found.iter().map(|o| o.row).collect();
            assert_eq!(found, [first as usize, first as usize + 1], "{size}");
        }
    }

    #[test]
    fn a_third_reading_off_nearby_hides_no_two_at_an_end() {
        // Where a planted drag is fitted, of an independent table with 6 % of its readings off.
        let few = [14.1, 21.8, 0.0, -0.3, 1.5, -19.0, -0.3, -0.8, 0.9, -0.9, 0.2, -0.5, -1.5, -1.0, -0.9, -0.8];
        let rows: Vec<(usize, f64)> = few.into_iter().enumerate().collect();
        let found: Vec<usize> = outliers("amplitude_v", &rows, 1.0).iter().map(|o| o.row).collect();
        assert_eq!(found, [0, 1, 5]);
    }

    #[test]
    fn a_misfit_that_bends_at_its_end_has_no_outliers() {
        // Where the sixth of the practice curves of table 1 ends, as the published law misses it.
        let bent = [60.1, 66.7, 69.0, 69.1, 67.1, 66.7, 60.4, 54.1, 47.3, 40.6, 29.3, 20.1, 8.3, -5.2, -17.8, -24.4];
        let rows: Vec<(usize, f64)> = bent.into_iter().enumerate().collect();
        assert_eq!(outliers("amplitude_rad", &rows, 1.0), []);
        let mirrored: Vec<(usize, f64)> = bent.into_iter().rev().enumerate().collect();
        assert_eq!(outliers("amplitude_rad", &mirrored, 1.0), []);
    }
}
