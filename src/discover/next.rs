//! Where rival explanations differ most, relative to the noise.

use super::hypothesis::Hypothesis;
use crate::compare::{Label, Setting, words};
use crate::measurement::Table;
use crate::model::{Model, Operation};
use crate::solver::cycle::Tolerance;
use crate::solver::{Status, SteadyState, Warm, solve_steady};
use crate::statistics::wrap;
use crate::units;
use rayon::prelude::*;

/// Values of speed, load, drive and frequency that are tried.
const GRID: [usize; 4] = [9, 4, 3, 24];
/// Every so many-th of these points serves to choose among forms of an effect; no divisor of their number.
const THIN: usize = 37;
/// Without a positive value in a table and without a lower bound, values reach down to this share of the upper one.
const LOWEST: f64 = 1e-3;
/// Changes of prediction smaller than this many standard deviations do not show.
const SHOWS: f64 = 3.0;

/// Where a next measurement may be made; without a range, that of the measurements at hand.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bounds {
    /// V \[m/s\].
    pub speed: Option<(f64, f64)>,
    /// W \[N\].
    pub load: Option<(f64, f64)>,
    /// Drive, in the unit of the table's.
    pub drive: Option<(f64, f64)>,
    /// f \[Hz\].
    pub frequency: Option<(f64, f64)>,
}

/// The point at which two explanations differ most.
#[derive(Debug, Clone, PartialEq)]
pub struct NextMeasurement {
    /// Load, speed and drive.
    pub setting: Setting,
    /// f \[Hz\].
    pub frequency_hz: f64,
    /// The two explanations.
    pub separates: [String; 2],
    /// Expected distance of the two readings in standard deviations of one.
    pub sigma: f64,
    /// How far the second is behind the first in BIC, where that decides already: then a reading would
    /// only confirm. Absent where the data leave the two open.
    pub ruled_out_by: Option<f64>,
}

impl NextMeasurement {
    /// Whether one reading there decides.
    pub fn decides(&self) -> bool {
        self.sigma >= SHOWS
    }

    /// What one reading there is worth, in words.
    pub fn meaning(&self) -> String {
        match self.ruled_out_by {
            Some(behind) if self.decides() => format!("only to confirm: BIC already prefers the first by {behind:.0}"),
            Some(behind) => format!("nothing to decide: BIC already prefers the first by {behind:.0}"),
            None if self.decides() => "one reading there decides".into(),
            None => "too little for one reading within these ranges: repeat it, or go beyond them".into(),
        }
    }
}

/// Typical noise of a table.
struct Typical {
    amplitude: f64,
    phase: Option<f64>,
}

/// The point within the bounds at which two of the survivors, those that are hardest to tell apart there included,
/// differ most: the largest distance of the best two.
pub(super) fn next(survivors: &[&Hypothesis], table: &Table, bounds: &Bounds) -> Option<NextMeasurement> {
    let [one, other, ..] = survivors else { return None };
    let (fitted, rival) = (one.fitted(), other.fitted());
    if has_numbers_of_series(&fitted) || has_numbers_of_series(&rival) {
        return None;
    }
    let (at, sigma) = within(&fitted, &rival, table, bounds)?;
    Some(NextMeasurement {
        setting: setting(&at, table, one.model.has_contact),
        frequency_hz: at.frequency,
        separates: [one.label(), other.label()],
        sigma,
        ruled_out_by: None,
    })
}

/// Where an effect that the data cannot show would show most, in the one of its `forms` that shows most there, in
/// words; empty where nowhere.
pub(super) fn would_show(without: &Model, forms: &[Model], table: &Table, bounds: &Bounds) -> String {
    if has_numbers_of_series(without) {
        return String::new();
    }
    let (typical, all) = (typical(table), grid(table, bounds, without.has_contact));
    let thin: Vec<Operation> = all.iter().step_by(THIN).copied().collect();
    let shown =
        |with: &&Model, grid: &[Operation]| farthest(&[without, with], grid, (typical.amplitude, typical.phase));
    let most = |with: &&Model| shown(with, &thin).map_or(0.0, |(_, sigma)| sigma);
    let form = match forms {
        [one] => Some(one),
        many => many.iter().max_by(|a, b| most(a).total_cmp(&most(b))),
    };
    match form.and_then(|with| shown(&with, &all)) {
        Some((at, sigma)) if sigma > SHOWS => {
            format!(
                "most at {}, f = {}: {sigma:.*} standard deviations in one reading, before the free parameters take up \
                 what they can",
                words(&setting(&at, table, without.has_contact)),
                units::format(at.frequency, "Hz"),
                usize::from(sigma < 10.0)
            )
        }
        _ => String::new(),
    }
}

/// Whether a model has numbers of each series, of which one that is still to be measured has none: nothing is predicted
/// there.
fn has_numbers_of_series(model: &Model) -> bool {
    model.effects.iter().any(|(effect, _)| effect.of_series().is_some())
}

/// The condition of a point.
fn setting(at: &Operation, table: &Table, contact: bool) -> Setting {
    let (speed, load, drive, signal) = (at.speed, at.load, at.drive, table.signals.drive);
    Setting { speed, load, drive, signal, contact, number: 0, name: Label::default() }
}

/// Where two models differ most within the bounds, in standard deviations of a reading.
fn within(one: &Model, other: &Model, table: &Table, bounds: &Bounds) -> Option<(Operation, f64)> {
    let typical = typical(table);
    farthest(&[one, other], &grid(table, bounds, one.has_contact), (typical.amplitude, typical.phase))
}

/// The point of `grid` at which the two of the models that are most alike there differ most, and by how much: in
/// standard deviations, the relative one of an amplitude and, where phases count, that of a phase \[rad\]. Points at
/// which a model has no steady state are left out.
pub fn farthest(models: &[&Model], grid: &[Operation], sd: (f64, Option<f64>)) -> Option<(Operation, f64)> {
    let tolerance = Tolerance::default();
    let distance = |a: &SteadyState, b: &SteadyState| {
        let amplitude = 2.0 * (a.amplitude - b.amplitude) / (a.amplitude + b.amplitude) / sd.0;
        amplitude.hypot(sd.1.map_or(0.0, |sd| wrap(a.phase - b.phase) / sd))
    };
    let distances: Vec<Option<f64>> = grid
        .par_iter()
        .map(|at| {
            let state = |model: &&Model| solve_steady(model, at, &tolerance, false, &mut Warm::default()).state;
            let states: Vec<SteadyState> = models.iter().map(state).collect();
            if states.iter().any(|state| state.status != Status::Steady) {
                return None;
            }
            let pairs = states.iter().enumerate().flat_map(|(i, a)| states[..i].iter().map(move |b| (a, b)));
            pairs.map(|(a, b)| distance(a, b)).min_by(f64::total_cmp).filter(|d| d.is_finite())
        })
        .collect();
    let best = grid.iter().zip(distances).filter_map(|(at, d)| Some((*at, d?)));
    best.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn typical(table: &Table) -> Typical {
    let n = table.points.len() as f64;
    let relative = table.points.iter().map(|p| (p.amplitude_sd / p.amplitude).powi(2)).sum::<f64>() / n;
    let phases: Vec<f64> = table.points.iter().filter_map(|p| p.phase_sd).collect();
    let phase = (!phases.is_empty()).then(|| (phases.iter().map(|s| s * s).sum::<f64>() / phases.len() as f64).sqrt());
    Typical { amplitude: relative.sqrt(), phase }
}

fn grid(table: &Table, bounds: &Bounds, contact: bool) -> Vec<Operation> {
    let range = |given: Option<(f64, f64)>, value: &dyn Fn(&crate::measurement::Point) -> f64| {
        given.unwrap_or_else(|| {
            table.points.iter().map(value).fold((f64::INFINITY, 0.0), |(a, b), x| (a.min(x), x.max(b)))
        })
    };
    let speeds = logarithmic(range(bounds.speed, &|p| p.speed), GRID[0], smallest(table, |p| p.speed));
    let loads = logarithmic(range(bounds.load, &|p| p.load), GRID[1], smallest(table, |p| p.load));
    let drives = logarithmic(range(bounds.drive, &|p| p.drive), GRID[2], smallest(table, |p| p.drive));
    let (from, to) = range(bounds.frequency, &|p| p.frequency);
    let mut all = Vec::new();
    for &speed in &speeds {
        for &load in &loads {
            for &drive in &drives {
                for i in 0..GRID[3] {
                    let frequency = from + (to - from) * i as f64 / (GRID[3] - 1) as f64;
                    all.push(Operation { speed, load, drive, frequency, series: 0 });
                }
            }
        }
    }
    all.retain(|at| (at.load > 0.0 || !contact) && at.drive > 0.0);
    all
}

fn smallest(table: &Table, value: impl Fn(&crate::measurement::Point) -> f64) -> f64 {
    table.points.iter().map(value).filter(|x| *x > 0.0).fold(f64::INFINITY, f64::min)
}

/// Values spread evenly in their logarithm; zero where the range contains it. `least` is the smallest positive one.
fn logarithmic((from, to): (f64, f64), count: usize, least: f64) -> Vec<f64> {
    let mut values = Vec::new();
    if from <= 0.0 {
        values.push(0.0);
    }
    let low = if from > 0.0 { from } else { least.min(LOWEST * to) };
    if to <= low * (1.0 + 1e-9) {
        if to > 0.0 {
            values.push(to);
        }
        return values;
    }
    let count = count - values.len();
    // In between, values that one would set.
    let between = |i: usize| {
        let value = low * (to / low).powf(i as f64 / (count - 1) as f64);
        format!("{value:.2e}").parse().unwrap_or(value).clamp(low, to)
    };
    values.push(low);
    values.extend((1..count - 1).map(between));
    values.push(to);
    values
}
