//! Readings far wider than a resonance: whether those about it are followed better alone.

use super::Verdict;
use super::select::Search;
use crate::compare::{self, Compared, Comparison, calibrate};
use crate::fit::resonance::{Resonance, shown};
use crate::measurement::{Point, TOLD, Table};
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use crate::statistics::{median, median_of_three};
use crate::units::readable::percent;
use std::ops::Range;

/// By how much smaller residuals have to be for it to be told.
const BETTER: f64 = 2.0;

/// Readings about the resonance, and how calibration follows them alone.
pub struct Narrower {
    /// First and last of their frequencies \[Hz\].
    pub band: (f64, f64),
    /// How many they are.
    count: usize,
    /// Root mean square error of the amplitude of these, and of all.
    errors: [f64; 2],
    /// Whether they are followed far better so.
    pub is_better: bool,
    /// Steady states that were solved.
    solved: u64,
}

/// How a rig without contact follows the readings about the resonance alone, against `all` of a table by some model;
/// `None` where there are none of their own.
pub fn narrower(scenario: &Scenario, table: &Table, all: &[Compared], seed: u32) -> Option<Narrower> {
    let model = Model::new(scenario);
    if model.has_contact {
        return None;
    }
    let seen = shown(&table.points, model.signals.reading.order);
    let (from, to) = about_the_peak(&table.points, seen)?;
    let inside = |p: &Point| (from..=to).contains(&p.frequency);
    let points: Vec<Point> = table.points.iter().filter(|p| inside(p)).cloned().collect();
    let alone = calibrate(&model, &scenario.free, &points, Tolerance::FIT, seed);
    let followed = compare::compared(&points, &alone.fit.evaluation.predictions);
    // Readings enough to have left an error, and half of that of all.
    let is_told = points.len() > 2 * alone.fit.parameters.len();
    let is_better = is_told && are_better(&followed, all);
    let errors = [error(followed.iter()), error(all.iter())];
    Some(Narrower { band: (from, to), count: points.len(), errors, is_better, solved: alone.solved })
}

/// Whether readings are followed far better than all of a table.
pub fn are_better(some: &[Compared], all: &[Compared]) -> bool {
    BETTER * BETTER * mean_square(some.iter()) <= mean_square(all.iter())
}

impl Search<'_> {
    /// Where nothing explains the readings of a rig without contact, though calibration alone follows those about the
    /// resonance far better than the best explanation follows all: which they are, in words.
    pub(super) fn followed_alone(&self, verdict: Verdict, end: &Comparison) -> Option<String> {
        if verdict != Verdict::Unexplained {
            return None;
        }
        let found = narrower(self.scenario, self.table, &end.points, self.options.seed)?;
        self.data.count(found.solved);
        if !found.is_better {
            return None;
        }
        let (from, to) = found.band;
        let [now, all] = found.errors.map(|error| percent(error, 2));
        Some(format!(
            "the {} points from {from} to {to} Hz, about the resonance, are followed to {now} by calibration alone (all: \
             {all}), which does not reach what lies beyond; for that resonance alone write frequency = {{ from = \"{from} Hz\", to = \
             \"{to} Hz\" }} in [measurement]",
            found.count
        ))
    }
}

/// The frequencies \[Hz\] about the peak of the response per drive, on either side down to the geometric mean of it and
/// the least there, over all series; `None` where these are all readings, or too few. The peak is that of the resonance
/// that is `seen`, or else the largest response.
fn about_the_peak(points: &[Point], seen: Option<Resonance>) -> Option<(f64, f64)> {
    let series = points.iter().map(|p| p.series).max()?;
    let bands = (0..=series).filter_map(|series| {
        let mut own: Vec<&Point> = points.iter().filter(|p| p.series == series && p.drive > 0.0).collect();
        own.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        of_series(&own, seen)
    });
    let (from, to) = bands.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let inside = points.iter().filter(|p| (from..=to).contains(&p.frequency)).count();
    // Numbers that are easily written, nearer than the next readings that are left out.
    let before = points.iter().map(|p| p.frequency).filter(|f| *f < from).fold(0.0, f64::max);
    let after = points.iter().map(|p| p.frequency).filter(|f| *f > to).fold(f64::INFINITY, f64::min).min(2.0 * to);
    (inside > TOLD && inside < points.len()).then(|| (short(from, before), short(to, after)))
}

/// The number of the fewest digits from `from` to the middle between that and `beyond`.
fn short(from: f64, beyond: f64) -> f64 {
    let middle = 0.5 * (from + beyond);
    let range = from.min(middle)..=from.max(middle);
    let written = |digits: i32| {
        let step = 10f64.powi(from.log10().floor() as i32 - digits);
        let steps = if beyond < from { (from / step).floor() } else { (from / step).ceil() };
        format!("{steps:.0}e{}", from.log10().floor() as i32 - digits).parse::<f64>().unwrap_or(from)
    };
    (0..17).map(written).find(|value| range.contains(value)).unwrap_or(from)
}

/// As [`about_the_peak`], of one series in the order of the frequency.
fn of_series(points: &[&Point], seen: Option<Resonance>) -> Option<(f64, f64)> {
    let sizes: Vec<f64> = points.iter().map(|p| (p.amplitude / p.drive).ln()).collect();
    // One reading far off is no peak.
    let y = median_of_three(&sizes);
    let highest = |of: Range<usize>| of.max_by(|a, b| y[*a].total_cmp(&y[*b]));
    // Within the width of the resonance; what is higher beside it makes that the flank of something else.
    let near = seen.and_then(|seen| {
        let away = |p: &&Point| (p.frequency - seen.frequency) * seen.quality / seen.frequency;
        let (first, end) = (points.partition_point(|p| away(p) < -1.0), points.partition_point(|p| away(p) <= 1.0));
        let is_top =
            |peak: &usize| *peak > 0 && *peak + 1 < y.len() && y[*peak].max(y[peak - 1]).max(y[peak + 1]) == y[*peak];
        highest(first..end).filter(is_top)
    });
    let notch = seen.filter(|_| near.is_none()).and_then(|seen| about_the_notch(points, &y, seen));
    if notch.is_some() {
        return notch;
    }
    let peak = near.or_else(|| highest(0..y.len()))?;
    let below = |side: &[f64]| 0.5 * (y[peak] + side.iter().copied().fold(y[peak], f64::min));
    let (left, right) = (below(&y[..peak]), below(&y[peak..]));
    let first = (0..peak).rev().take_while(|&i| y[i] >= left).last().unwrap_or(peak);
    let last = (peak..y.len()).take_while(|&i| y[i] >= right).last().unwrap_or(peak);
    Some((points[first].frequency, points[last].frequency))
}

/// The frequencies \[Hz\] about the least response (logarithms `y`) within the width of a resonance, where that is none of
/// an end: on either side up to the geometric mean of its depth below the highest there and of how far most others are
/// below that.
fn about_the_notch(points: &[&Point], y: &[f64], seen: Resonance) -> Option<(f64, f64)> {
    let is_near = |f: f64| ((f - seen.frequency) * seen.quality / seen.frequency).abs() <= 1.0;
    let near = (0..y.len()).filter(|&i| is_near(points[i].frequency));
    let bottom = near.min_by(|a, b| y[*a].total_cmp(&y[*b]))?;
    let (before, after) = (&y[..bottom], &y[bottom + 1..]);
    if [before.last()?, after.first()?].iter().any(|beside| **beside < y[bottom]) {
        return None;
    }
    let reach = |side: &[f64]| {
        let level = side.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        level - ((level - y[bottom]) * (level - median(side.iter().copied()))).sqrt()
    };
    let (left, right) = (reach(before), reach(after));
    let first = (0..bottom).rev().take_while(|&i| y[i] <= left).last().unwrap_or(bottom);
    let last = (bottom..y.len()).take_while(|&i| y[i] <= right).last().unwrap_or(bottom);
    Some((points[first].frequency, points[last].frequency))
}

/// Mean square of the amplitudes' residuals in standard deviations.
fn mean_square<'a>(points: impl ExactSizeIterator<Item = &'a Compared>) -> f64 {
    let count = points.len() as f64;
    points.map(|p| p.amplitude_residual.powi(2)).sum::<f64>() / count
}

/// Root mean square of the relative error of the amplitude.
fn error<'a>(points: impl Iterator<Item = &'a Compared>) -> f64 {
    let (count, sum) = points.fold((0.0, 0.0), |(n, sum), p| (n + 1.0, sum + (0.01 * p.error_percent()).powi(2)));
    f64::sqrt(sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_is_written_in_as_few_digits_as_keep_its_readings() {
        assert_eq!(short(207692.27376149502, 207687.25), 207690.0);
        assert_eq!(short(208128.72185160813, 208133.7), 208130.0);
        assert_eq!(short(1.23456, 1.2345), 1.23456);
        assert_eq!(short(52.0, 104.0), 60.0);
    }
}
