//! Readings in canonical order; those of one condition and frequency are united.

use std::collections::BTreeMap;

use super::reading::{Reading, Readings};
use super::settle::settle;
use super::{Point, Series, series};
use crate::error::Result;
use crate::statistics::wrap;

/// Spread of repeated readings: sum of squares about their mean, and its degrees of freedom.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Repeats {
    pub squares: f64,
    pub freedom: usize,
}

/// What the readings of one point tell about its noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Own {
    /// Standard deviation of the pooled amplitude, from three or more readings.
    pub amplitude: Option<f64>,
    /// Standard deviation of the pooled phase, from three or more readings.
    pub phase: Option<f64>,
    /// Readings that have a phase.
    pub phases: usize,
    /// Standard deviations that rounding leaves of amplitude and phase.
    pub rounding: [f64; 2],
}

/// Points without estimated deviations yet, and what repetition tells about them.
#[derive(Debug)]
pub(crate) struct Pooled {
    /// The sweeps that the points belong to.
    pub series: Vec<Series>,
    /// Deviations that are not stated are NaN.
    pub points: Vec<Point>,
    /// Per point, what its own readings tell.
    pub spreads: Vec<Own>,
    pub amplitude_stated: bool,
    pub phase_stated: bool,
    /// Of relative amplitudes.
    pub amplitude_repeats: Repeats,
    /// Of phases.
    pub phase_repeats: Repeats,
}

/// Finds the series, sorts, leaves out copies of rows, unites repetitions. `arm` tells the paper's rig.
pub(crate) fn pool(readings: Readings, arm: bool, notes: &mut Vec<String>) -> Result<Pooled> {
    let Readings { mut list, amplitude_stated, phase_stated, .. } = readings;
    let axes: [fn(&mut Reading) -> &mut f64; 4] =
        [|r| &mut r.load, |r| &mut r.speed, |r| &mut r.drive, |r| &mut r.frequency];
    for axis in axes {
        snap(&mut list, axis);
    }
    settle(&mut list, notes);
    let series = series::group(&mut list, arm, notes);
    list.sort_by(|a, b| {
        let keys = key(a).into_iter().zip(key(b)).map(|(a, b)| a.total_cmp(&b));
        keys.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then).then_with(|| a.row.cmp(&b.row))
    });
    let list = without_copies(list, notes);
    let mut pooled = Pooled {
        series,
        points: Vec::new(),
        spreads: Vec::new(),
        amplitude_stated,
        phase_stated,
        amplitude_repeats: Repeats::default(),
        phase_repeats: Repeats::default(),
    };
    for group in list.chunk_by(|a, b| key(a)[..3] == key(b)[..3]) {
        unite(group, &mut pooled);
    }
    let (rows, points) = (list.len(), pooled.points.len());
    if points < rows {
        let several = pooled.points.iter().filter(|point| point.replicates > 1).count();
        notes.push(format!("{rows} rows are {points} points: repeated readings were pooled at {several} of them"));
    }
    Ok(pooled)
}

/// Series, frequency, drive and reading: everything that an order of rows must not decide.
fn key(reading: &Reading) -> [f64; 7] {
    let Reading { series, drive, frequency, amplitude, phase, amplitude_sd, phase_sd, .. } = reading;
    let or = |value: &Option<f64>| value.unwrap_or(f64::NEG_INFINITY);
    [*series as f64, *frequency, *drive, *amplitude, or(phase), or(amplitude_sd), or(phase_sd)]
}

/// Makes values equal that differ by rounding only, whatever the order of the rows.
fn snap(list: &mut [Reading], axis: fn(&mut Reading) -> &mut f64) {
    let mut values: Vec<f64> = list.iter_mut().map(|reading| *axis(reading) + 0.0).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let mut first = Vec::with_capacity(values.len());
    for (at, value) in values.iter().enumerate() {
        let same = at > 0 && value - values[at - 1] <= 1e-9 * value.abs();
        first.push(if same { first[at - 1] } else { *value });
    }
    for reading in list {
        let value = axis(reading);
        if let Ok(at) = values.binary_search_by(|probe| probe.total_cmp(&(*value + 0.0))) {
            *value = first[at];
        }
    }
}

/// A row that says the same as another, be it a slip of the pen or a reading of few digits, is used once.
fn without_copies(list: Vec<Reading>, notes: &mut Vec<String>) -> Vec<Reading> {
    let mut copies: Vec<(usize, usize)> = Vec::new();
    let mut kept: Vec<Reading> = Vec::with_capacity(list.len());
    let mut seen: BTreeMap<(Option<u64>, String), usize> = BTreeMap::new();
    for reading in list {
        if kept.last().is_none_or(|last| key(last) != key(&reading)) {
            seen.clear();
        }
        let said = (reading.mean.map(|mean| (mean + 0.0).to_bits()), reading.aside.clone());
        match seen.get(&said) {
            Some(first) => copies.push((reading.line, *first)),
            None => {
                seen.insert(said, reading.line);
                kept.push(reading);
            }
        }
    }
    copies.sort_unstable();
    if let [(line, first), others @ ..] = copies.as_slice() {
        let what = match others.len() {
            0 => format!("line {line} repeats line {first}, number by number, and is not used"),
            more => format!(
                "line {line} repeats line {first}, number by number, and {more} more lines others: each is used once"
            ),
        };
        notes.push(what + "; a column of your own such as `run` tells readings apart");
    }
    kept
}

/// Weighted mean, its standard deviation from the weights, and that from the spread of three or more.
struct Mean {
    value: f64,
    propagated: f64,
    spread: Option<f64>,
}

fn mean(values: &[f64], deviations: &[f64]) -> Mean {
    let weights: Vec<f64> = deviations.iter().map(|sd| 1.0 / (sd * sd)).collect();
    let total: f64 = weights.iter().sum();
    let value = values.iter().zip(&weights).map(|(value, weight)| value * weight).sum::<f64>() / total;
    let squares: f64 = values.iter().zip(&weights).map(|(x, weight)| weight * (x - value).powi(2)).sum();
    let n = values.len();
    let spread = (n >= 3).then(|| (squares / (total * (n - 1) as f64)).sqrt());
    Mean { value, propagated: total.powf(-0.5), spread }
}

/// One point from the readings of one condition and frequency.
fn unite(group: &[Reading], pooled: &mut Pooled) {
    let Some(first) = group.iter().min_by_key(|reading| reading.row) else { return };
    let amplitudes: Vec<f64> = group.iter().map(|reading| reading.amplitude).collect();
    let deviations: Vec<f64> = group.iter().map(|reading| reading.amplitude_sd.unwrap_or(1.0)).collect();
    let amplitude = mean(&amplitudes, &deviations);

    let angles: Vec<f64> = group.iter().filter_map(|reading| reading.phase).collect();
    let turned = group.iter().filter(|reading| reading.phase.is_some());
    let deviations: Vec<f64> = turned.map(|reading| reading.phase_sd.unwrap_or(1.0)).collect();
    let phase = (!angles.is_empty()).then(|| {
        let centre = direction(&angles, &deviations);
        let about: Vec<f64> = angles.iter().map(|angle| wrap(angle - centre)).collect();
        (wrap(centre), mean(&about, &deviations), about)
    });

    if group.len() > 1 {
        let value = amplitude.value;
        let squares = amplitudes.iter().map(|x| (x / value - 1.0).powi(2)).filter(|square| square.is_finite());
        pooled.amplitude_repeats.squares += squares.sum::<f64>();
        pooled.amplitude_repeats.freedom += group.len() - 1;
    }
    if let Some((_, mean, about)) = &phase {
        pooled.phase_repeats.squares += about.iter().map(|x| (x - mean.value).powi(2)).sum::<f64>();
        pooled.phase_repeats.freedom += about.len() - 1;
    }
    let means: Vec<f64> = group.iter().filter_map(|reading| reading.mean).collect();
    let single = angles.len() == 1;
    pooled.points.push(Point {
        row: first.row,
        line: first.line,
        speed: first.speed,
        load: first.load,
        drive: first.drive,
        frequency: first.frequency,
        // A single reading is kept to the last bit.
        amplitude: if group.len() == 1 { first.amplitude } else { amplitude.value },
        phase: phase.as_ref().map(|(centre, ..)| if single { angles[0] } else { *centre }),
        amplitude_sd: match (pooled.amplitude_stated, group.len(), first.amplitude_sd) {
            (true, 1, Some(sd)) => sd,
            (true, ..) => amplitude.propagated.max(amplitude.spread.unwrap_or(0.0)),
            _ => f64::NAN,
        },
        phase_sd: phase.as_ref().map(|(_, mean, _)| match (pooled.phase_stated, single) {
            (true, true) => deviations[0],
            (true, _) => mean.propagated.max(mean.spread.unwrap_or(0.0)),
            _ => f64::NAN,
        }),
        mean: (!means.is_empty()).then(|| means.iter().sum::<f64>() / means.len() as f64),
        replicates: group.len(),
        series: first.series,
    });
    let of_phase = phase.and_then(|(_, mean, _)| mean.spread);
    let rounding = |of: usize| group.iter().map(|reading| reading.rounding[of]).fold(0.0, f64::max);
    pooled.spreads.push(Own {
        amplitude: amplitude.spread,
        phase: of_phase,
        phases: angles.len(),
        rounding: [rounding(0), rounding(1)],
    });
}

/// Direction of the weighted sum of unit vectors.
fn direction(angles: &[f64], deviations: &[f64]) -> f64 {
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (angle, sd) in angles.iter().zip(deviations) {
        sine += angle.sin() / (sd * sd);
        cosine += angle.cos() / (sd * sd);
    }
    sine.atan2(cosine)
}
