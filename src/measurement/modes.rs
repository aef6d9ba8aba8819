//! How many resonances a table holds: a scenario is of one mode.

use super::doubts::shows_curve;
use super::{Point, Table};
use crate::statistics::{median, median_of_three};

/// A response at half power is this much below its peak, as a logarithm.
const HALF: f64 = 0.5 * std::f64::consts::LN_2;
/// Between two modes the response falls below this share of the lower peak: what either adds to the peak of the other
/// is of the order of what both add there. Nearer ones are one system of two modes, no two of one.
const APART: f64 = 0.1;
/// A valley between two peaks is none of noise if it is so many standard deviations of a reading deep.
const DEEP: f64 = 6.0;
/// Fewest readings on the upper half of its flanks that tell a peak from a reading that is far off, or from two
/// branches in turn.
const FEWEST: usize = 3;
/// Readings of which a mode is told from others well; of fewer all are used that are nearer to it than to others.
const ENOUGH: usize = 12;
/// Fewest readings that tell a resonance at all.
pub const TOLD: usize = 5;

/// A resonance among others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Of its peak \[Hz\].
    pub frequency: f64,
    /// Where it alone makes most of the response: down to the geometric mean of its peak and the valleys beside it, or,
    /// where few readings lie there, to the valleys \[Hz\].
    pub band: (f64, f64),
    /// Largest response per drive.
    peak: f64,
}

/// The resonances that most series show whose readings reach them, the strongest first; nothing where fewer than two
/// are seen.
pub fn modes(table: &Table) -> Vec<Mode> {
    falling(table, -APART.ln())
}

/// Peaks between which the response falls below half power of the lower one, as of two modes that are coupled.
pub fn peaks(table: &Table) -> Vec<Mode> {
    let noise = median(table.points.iter().map(|p| p.amplitude_sd / p.amplitude));
    falling(table, HALF.max(DEEP * noise))
}

/// Peaks between which the logarithm of the response falls by so much.
fn falling(table: &Table, fall: f64) -> Vec<Mode> {
    let of = |index: usize| {
        let mut own: Vec<&Point> = table.points.iter().filter(|p| p.series == index).collect();
        own.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        own
    };
    if !shows_curve(&table.points) {
        return Vec::new();
    }
    let series: Vec<Vec<&Point>> = (0..table.series.len()).map(of).collect();
    let seen: Vec<Vec<Mode>> = series.iter().map(|points| of_series(points, fall)).collect();
    let Some(most) = seen.iter().max_by_key(|modes| modes.len()).filter(|modes| modes.len() > 1) else {
        return Vec::new();
    };
    let shared = |mode: &&Mode| {
        let inside = |f: f64| (mode.band.0..=mode.band.1).contains(&f);
        let reach = |points: &&Vec<&Point>| points.iter().filter(|p| inside(p.frequency)).count() >= TOLD;
        let reaching = series.iter().filter(reach).count();
        let showing = seen.iter().filter(|modes| modes.iter().any(|other| inside(other.frequency))).count();
        reaching > 0 && 2 * showing >= reaching
    };
    let mut modes: Vec<Mode> = most.iter().filter(shared).copied().collect();
    modes.sort_by(|a, b| b.peak.total_cmp(&a.peak));
    if modes.len() < 2 { Vec::new() } else { modes }
}

/// The peaks of one series in the order of the frequency whose logarithm falls by so much on the way to any other.
fn of_series(points: &[&Point], fall: f64) -> Vec<Mode> {
    if points.len() < ENOUGH {
        return Vec::new();
    }
    let sizes: Vec<f64> = points.iter().map(|p| (p.amplitude / p.drive).ln()).collect();
    // One reading far off is no peak.
    let y = median_of_three(&sizes);
    let (mut peaks, mut valleys) = (Vec::new(), vec![0]);
    let (mut high, mut low, mut rising) = (0, 0, true);
    for i in 0..y.len() {
        if rising {
            if y[i] < y[low] && peaks.is_empty() && high == low {
                (high, low, valleys[0]) = (i, i, i);
            }
            high = if y[i] > y[high] { i } else { high };
            if y[high] - y[i] > fall {
                peaks.push(high);
                (low, rising) = (i, false);
            }
        } else {
            low = if y[i] < y[low] { i } else { low };
            if y[i] - y[low] > fall {
                valleys.push(low);
                (high, rising) = (i, true);
            }
        }
    }
    if rising {
        peaks.push(high);
    }
    valleys.push(if rising { y.len() - 1 } else { low });
    // At an end of the band the flank of a peak may be cut short, down to half power. A sharp one may have a single
    // reading above that, but has flanks on the way to the higher valley.
    let has_flanks = |&(number, &peak): &(usize, &usize)| {
        let valleys = [valleys[number], valleys[number + 1]].map(|valley| y[valley]);
        let higher = 0.5 * (y[peak] + valleys[0].max(valleys[1]));
        let above = |i: &usize| y[*i] > higher;
        let near = (0..peak).rev().take_while(above).count() + (peak..y.len()).take_while(above).count();
        valleys.iter().all(|valley| *valley < y[peak] - HALF) && near >= FEWEST
    };
    let mode = |(number, peak): (usize, &usize)| {
        let side = |valley: usize| 0.5 * (y[*peak] + y[valley]);
        let (left, right) = (valleys[number], valleys[number + 1]);
        let first = (left..=*peak).find(|&i| y[i] >= side(left)).unwrap_or(left);
        let last = (*peak..=right).rev().find(|&i| y[i] >= side(right)).unwrap_or(right);
        let (first, last) = if last - first < ENOUGH { (left, right) } else { (first, last) };
        let band = (points[first].frequency, points[last].frequency);
        Mode { frequency: points[*peak].frequency, band, peak: y[*peak] }
    };
    peaks.iter().enumerate().filter(has_flanks).map(mode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;
    use std::f64::consts::TAU;

    fn series(modes: &[(f64, f64, f64)], noise: f64) -> Vec<Point> {
        let point = |i: usize| {
            let frequency = 20.0 * (1.0 + 0.004 * i as f64).powi(2);
            let of = |&(f0, q, m): &(f64, f64, f64)| {
                let (w, w0) = (TAU * frequency, TAU * f0);
                Complex::new(1.0 / m, 0.0) / Complex::new(w0 * w0 - w * w, w * w0 / q)
            };
            let amplitude = modes.iter().map(of).sum::<Complex<f64>>().norm() * (1.0 + noise * (7.0 * i as f64).sin());
            Point {
                row: i,
                line: i,
                speed: 0.0,
                load: 0.0,
                drive: 1.0,
                frequency,
                amplitude,
                phase: None,
                amplitude_sd: 0.01 * amplitude,
                phase_sd: None,
                mean: None,
                replicates: 1,
                series: 0,
            }
        };
        (0..800).map(point).collect()
    }

    fn found(modes: &[(f64, f64, f64)], noise: f64) -> Vec<f64> {
        let points = series(modes, noise);
        of_series(&points.iter().collect::<Vec<_>>(), -APART.ln()).iter().map(|mode| mode.frequency.round()).collect()
    }

    #[test]
    fn modes_far_apart_are_told_and_a_split_peak_is_one() {
        assert_eq!(found(&[(45.0, 60.0, 1.0)], 0.02), [45.0]);
        assert_eq!(found(&[(45.0, 60.0, 1.0), (160.0, 80.0, 1.0), (300.0, 50.0, 1.0)], 0.02), [45.0, 160.0, 300.0]);
        // Half the width of the sharpest ones is less than what readings are apart.
        assert_eq!(found(&[(45.0, 60.0, 1.0), (160.0, 2e3, 1.0), (300.0, 5e3, 1.0)], 0.02), [45.0, 160.0, 300.0]);
        assert_eq!(found(&[(100.0, 30.0, 1.0), (108.0, 30.0, 1.0)], 0.02).len(), 1);
        // Noise of half the reading between the peaks is no mode.
        assert_eq!(found(&[(45.0, 60.0, 1.0)], 0.5), [45.0]);
    }

    #[test]
    fn the_peaks_of_two_coupled_modes_are_two_where_the_valley_is_below_half_power() {
        let seen = |second: f64, noise: f64| {
            let points = series(&[(100.0, 30.0, 1.0), (second, 30.0, 1.0)], noise);
            of_series(&points.iter().collect::<Vec<_>>(), HALF.max(DEEP * noise)).len()
        };
        assert_eq!((seen(108.0, 0.01), seen(101.0, 0.01), seen(108.0, 0.3)), (2, 1, 1));
    }

    #[test]
    fn the_band_of_a_mode_leaves_out_its_neighbours() {
        let points = series(&[(45.0, 60.0, 1.0), (160.0, 80.0, 1.0)], 0.0);
        let modes = of_series(&points.iter().collect::<Vec<_>>(), -APART.ln());
        let (low, high) = modes[0].band;
        assert!(low < 44.0 && high > 46.0 && high < modes[1].band.0, "{low} {high}");
        let (low, high) = modes[1].band;
        assert!(low < 158.0 && high > 163.0, "{low} {high}");
    }

    /// Two resonances read by hand: six or seven readings of each, down to both valleys.
    #[test]
    fn modes_of_few_readings_each_are_told_apart_and_all_of_their_readings_used() {
        let all = series(&[(40.9, 18.0, 1.0), (80.5, 18.0, 0.25)], 0.0);
        let wanted = [23.0, 30.0, 36.0, 38.5, 40.0, 40.9, 42.0, 45.0, 52.0, 60.0];
        let wanted = wanted.into_iter().chain([65.0, 70.0, 75.0, 78.0, 80.0, 80.5, 81.5, 84.0, 87.0]);
        let nearest = |f: f64| all.iter().min_by(|a, b| (a.frequency - f).abs().total_cmp(&(b.frequency - f).abs()));
        let points: Vec<&Point> = wanted.filter_map(nearest).collect();
        let modes = of_series(&points, -APART.ln());
        let inside = |mode: &Mode| points.iter().filter(|p| (mode.band.0..=mode.band.1).contains(&p.frequency)).count();
        assert_eq!(modes.iter().map(|mode| mode.frequency.round()).collect::<Vec<_>>(), [40.0, 80.0], "{modes:?}");
        assert!(modes.iter().all(|mode| (TOLD..ENOUGH).contains(&inside(mode))), "{modes:?}");
    }
}
