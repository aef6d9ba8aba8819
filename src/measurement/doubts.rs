//! What in a table is possible and yet not likely: said, not refused.

use super::Point;
use crate::statistics::{SIGNIFICANCE, is_curve, median, wrap};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Points of a curve whose phases tell which way they turn, at least, and by how much they turn, at least \[rad\].
const TURNING: (usize, f64) = (6, 0.5);

/// An amplitude this many times above or below both its neighbours along a curve is doubted, and by more than so many
/// standard deviations, ...
const OFF: (f64, f64) = (5.0, 10.0);
/// ... where these are so near in frequency, relatively, that a resonance of a damped arm is wider, ...
const NEAR: f64 = 0.05;
/// ... and where the curve does not rise, or fall, towards it on both sides as towards a sharp resonance: by this
/// factor from the neighbours' neighbours to the neighbours.
const TOWARDS: f64 = 1.5;
/// Fewest readings of a curve that may have been taken without a signal: a notch is narrower.
const DEAD: usize = 5;
/// Scatter of ln(amplitude) beyond which readings are below the detection limit, three times the noise (IUPAC 1976).
const UNDETECTED: f64 = 1.0 / 3.0;
/// Fewest readings of a series that is told from scatter: of fewer a resonance may have a single one.
const TELLING: usize = 30;
/// So many rows are named.
const NAMED: usize = 5;

/// Doubts about the sign of the phases and single readings; `arm` tells the paper's rig.
pub(super) fn doubts(points: &[Point], arm: bool) -> Vec<String> {
    let mut doubts = Vec::new();
    if counts_lags(points) {
        doubts.push(format!(
            "the phases rise with the frequency, where those of an {} that is driven fall through its resonance: an \
             instrument that counts a lag as positive needs the sign of its phases reversed",
            if arm { "arm" } else { "oscillator" }
        ));
    }
    if let Some(turn) = turns_too_little(points) {
        doubts.push(format!(
            "the phases turn by {turn:.1}° over a peak, where those of an oscillator turn by 90° and more: are they in radians?"
        ));
    }
    let (apart, signal): (Vec<Vec<usize>>, Vec<bool>) = points.chunk_by(same_curve).map(far_off).unzip();
    // A branch of smaller amplitudes is no slip.
    let of_branch = |row: &usize| apart.iter().zip(&signal).any(|(rows, is)| *is && rows.contains(row));
    let rows: Vec<usize> = off(points).into_iter().filter(|row| !of_branch(row)).collect();
    if !rows.is_empty() {
        let named: Vec<String> = rows.iter().take(NAMED).map(usize::to_string).collect();
        let more = if rows.len() > NAMED { format!(" and {} more", rows.len() - NAMED) } else { String::new() };
        let (what, word) = if rows.len() == 1 { ("an amplitude is", "row") } else { ("amplitudes are", "rows") };
        doubts.push(format!(
            "{what} more than {} times above or below both neighbours along the curve ({word} {}{more}): a slip of the decimal point?",
            OFF.0,
            named.join(", ")
        ));
    }
    if !shows_curve(points) {
        doubts.push(
            "most of what the amplitudes of a series vary by is scatter from neighbour to neighbour: no curve is seen"
                .into(),
        );
    }
    for (rows, signal) in apart.iter().zip(&signal).filter(|(rows, _)| !rows.is_empty()) {
        let asked = match signal {
            true => "on a curve of their own: a lower stable branch, or no signal?",
            false => "was there a signal? Take these rows out if not",
        };
        doubts.push(format!("{}: {asked}", far_below(rows)));
    }
    doubts
}

/// Rows of the smallest amplitudes of a curve, as [`dead`], and whether they follow a curve of their own, as a second
/// stable branch does.
fn far_off(curve: &[Point]) -> (Vec<usize>, bool) {
    let rows = dead(curve);
    let mut own: Vec<&Point> = curve.iter().filter(|point| rows.contains(&point.row)).collect();
    own.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    let sizes: Vec<f64> = own.iter().map(|point| (point.amplitude / point.drive).ln()).collect();
    let follows = is_curve(&sizes);
    // Below a peak on either side lie its flanks.
    let mut all: Vec<&Point> = curve.iter().collect();
    all.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    let is_low = |point: &&&Point| rows.contains(&point.row);
    let ends = [all.iter().take_while(is_low).count(), all.iter().rev().take_while(is_low).count()];
    let are_flanks = follows && ends[0] > 0 && ends[1] > 0 && ends[0] + ends[1] == rows.len();
    if are_flanks { (Vec::new(), false) } else { (rows, follows) }
}

/// Whether any series is a curve, and not scatter alone; what is too short to tell is taken for one.
pub(super) fn shows_curve(points: &[Point]) -> bool {
    points.chunk_by(same_curve).any(|curve| {
        let mut curve: Vec<&Point> = curve.iter().collect();
        curve.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        let sizes: Vec<f64> = curve.iter().map(|point| (point.amplitude / point.drive).ln()).collect();
        sizes.len() < TELLING || is_curve(&sizes)
    })
}

/// Whether any series is a curve in its amplitudes or in its phases: what is scatter alone no model is held against.
pub(crate) fn shows_anything(points: &[Point]) -> bool {
    let turns = |part: fn(f64) -> f64| {
        let phases = |curve: &[Point]| {
            let mut all: Vec<(f64, f64)> = curve.iter().filter_map(|p| Some((p.frequency, part(p.phase?)))).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all.into_iter().map(|(_, value)| value).collect::<Vec<_>>()
        };
        points.chunk_by(same_curve).map(phases).any(|values| values.len() >= TELLING && is_curve(&values))
    };
    shows_curve(points) || turns(f64::cos) || turns(f64::sin)
}

/// Which points were taken without a signal, as their series shows: far below the others, and nothing but noise.
pub(super) fn without_signal(points: &[Point], notes: &mut Vec<String>) -> Vec<bool> {
    let mut without = vec![false; points.len()];
    let mut at = 0;
    for curve in points.chunk_by(same_curve) {
        let rows = dead(curve);
        let mut readings: Vec<&Point> = curve.iter().filter(|point| rows.binary_search(&point.row).is_ok()).collect();
        readings.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        let sizes: Vec<f64> = readings.iter().map(|point| (point.amplitude / point.drive).ln()).collect();
        // What a line through neighbours leaves.
        let left = sizes.windows(3).map(|near| (near[0] + near[2] - 2.0 * near[1]).powi(2) / 6.0);
        let scatters = left.sum::<f64>() / (sizes.len() as f64 - 2.0) > UNDETECTED.powi(2);
        if !rows.is_empty() && scatters && !is_curve(&sizes) {
            let noise = "scatter like noise without a signal: these rows are not used";
            notes.push(format!("{} and {noise}", far_below(&rows)));
            let flags = without[at..at + curve.len()].iter_mut().zip(curve);
            flags.for_each(|(flag, point)| *flag = rows.binary_search(&point.row).is_ok());
        }
        at += curve.len();
    }
    without
}

fn far_below(rows: &[usize]) -> String {
    let (count, first, last) = (rows.len(), rows[0], rows[rows.len() - 1]);
    format!(
        "{count} amplitudes (rows {first} to {last}) lie further below the others of their series than these spread"
    )
}

/// By how much the phases turn \[deg\] along a curve with a peak twice as high as both its ends, where that is so little
/// that the numbers are a whole turn at most in radians, and more than a tenth of one.
fn turns_too_little(points: &[Point]) -> Option<f64> {
    let turn = |curve: &[Point]| {
        let response = |p: &Point| p.amplitude / p.drive;
        let ends = response(curve.first()?).max(response(curve.last()?));
        let is_peak = curve.iter().any(|p| response(p) > 2.0 * ends);
        let phases: Vec<f64> = curve.iter().filter_map(|p| p.phase).map(f64::to_degrees).collect();
        let range = phases.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        let turn = range.1 - range.0;
        (is_peak && phases.len() == curve.len() && turn > 0.1 * TAU && turn <= TAU).then_some(turn)
    };
    points.chunk_by(same_curve).find_map(turn)
}

/// Whether phases rise with the frequency, as where a lag is counted positive.
pub(super) fn counts_lags(points: &[Point]) -> bool {
    turn(points).is_some_and(|turn| turn > TURNING.1)
}

/// Whether phases, and their changes between neighbours along the frequency, point anywhere: neither has a direction by a
/// test that could have found one (Rayleigh 1919). A long cable turns phases all around, by the same from one to the next.
pub(super) fn are_random(points: &[Point]) -> bool {
    let mut order: Vec<&Point> = points.iter().filter(|p| p.phase.is_some()).collect();
    order.sort_by(|a, b| a.series.cmp(&b.series).then(a.frequency.total_cmp(&b.frequency)));
    let phases: Vec<f64> = order.iter().filter_map(|p| p.phase).collect();
    let pairs = order.windows(2).zip(phases.windows(2)).filter(|(pair, _)| pair[0].series == pair[1].series);
    let changes: Vec<f64> = pairs.map(|(_, pair)| pair[1] - pair[0]).collect();
    let points_anywhere = |angles: &[f64]| {
        let count = angles.len() as f64;
        let sum: Complex<f64> = angles.iter().map(|angle| Complex::from_polar(1.0, *angle)).sum();
        let by_chance = -SIGNIFICANCE.ln();
        // Half as much in common would have been found.
        0.25 * count > by_chance && sum.norm_sqr() < by_chance * count
    };
    points_anywhere(&phases) && points_anywhere(&changes)
}

/// Rows of the smallest amplitudes of a curve, fewer than half, where the gap to the others is wider than these spread,
/// as a ratio.
fn dead(curve: &[Point]) -> Vec<usize> {
    let mut curve: Vec<(f64, usize)> = curve.iter().map(|p| ((p.amplitude / p.drive).ln(), p.row)).collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(largest, _)) = curve.last() else { return Vec::new() };
    let apart = |&count: &usize| curve[count].0 - curve[count - 1].0 > largest - curve[count].0;
    let mut rows: Vec<usize> = match (DEAD..=curve.len() / 2).find(apart) {
        Some(count) => curve[..count].iter().map(|(_, row)| *row).collect(),
        None => Vec::new(),
    };
    rows.sort_unstable();
    rows
}

/// Rows of amplitudes far off both their neighbours in frequency; those at the ends of a curve, which have one, are not
/// judged.
fn off(points: &[Point]) -> Vec<usize> {
    let mut rows = Vec::new();
    for curve in points.chunk_by(same_curve) {
        let steady = curve.iter().all(|point| point.drive == curve[0].drive);
        let of = |value: f64, point: &Point| if steady { value } else { value / point.drive };
        let mut curve: Vec<&Point> = curve.iter().collect();
        curve.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        let sizes: Vec<f64> = curve.iter().map(|point| of(point.amplitude, point)).collect();
        let deviations: Vec<f64> = curve.iter().map(|point| of(point.amplitude_sd, point)).collect();
        for at in 1..curve.len().saturating_sub(1) {
            let near = curve[at + 1].frequency - curve[at - 1].frequency < 2.0 * NEAR * curve[at].frequency;
            let [before, size, after] = [sizes[at - 1], sizes[at], sizes[at + 1]];
            let (low, high) = (before.min(after), before.max(after));
            let away = (size - high).max(low - size);
            let sure = away > OFF.1 * deviations[at - 1..=at + 1].iter().fold(0.0, |a: f64, b| a.max(*b));
            let rises = size > OFF.0 * high;
            if near && sure && (rises || OFF.0 * size < low) && !is_sharp(&sizes, at, rises) {
                rows.push(curve[at].row);
            }
        }
    }
    rows.sort_unstable();
    rows
}

/// Whether the curve goes towards a point on both sides as towards a sharp resonance, or away from it.
fn is_sharp(sizes: &[f64], at: usize, rises: bool) -> bool {
    let (Some(first), Some(last)) = (at.checked_sub(2).map(|at| sizes[at]), sizes.get(at + 2)) else { return false };
    let towards = |far: f64, near: f64| if rises { near > TOWARDS * far } else { far > TOWARDS * near };
    towards(first, sizes[at - 1]) && towards(*last, sizes[at + 1])
}

/// Points in canonical order that follow each other in one series, at one load and speed.
fn same_curve(a: &Point, b: &Point) -> bool {
    (a.series, a.load, a.speed) == (b.series, b.load, b.speed)
}

/// How far the phases of a curve turn from its lowest to its highest frequency, each step by the square of its
/// responses over the largest, since it is at the resonance that they tell; the median over the curves \[rad\]. `None`
/// without a curve that tells.
fn turn(points: &[Point]) -> Option<f64> {
    let mut turns = Vec::new();
    for curve in points.chunk_by(same_curve) {
        let mut phases: Vec<(f64, f64, f64)> =
            curve.iter().filter_map(|p| Some((p.frequency, p.phase?, p.amplitude / p.drive))).collect();
        phases.sort_by(|a, b| a.0.total_cmp(&b.0));
        let largest = phases.iter().map(|(.., response)| *response).fold(0.0, f64::max);
        let step = |pair: &[(f64, f64, f64)]| wrap(pair[1].1 - pair[0].1) * pair[0].2 * pair[1].2 / largest.powi(2);
        if phases.len() >= TURNING.0 {
            turns.push(phases.windows(2).map(step).sum());
        }
    }
    (!turns.is_empty()).then(|| median(turns))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One curve of an arm with a resonance at 72 Hz.
    fn curve(load: f64, sign: f64) -> Vec<Point> {
        let point = |i: usize| {
            let frequency = 50.0 + 2.0 * i as f64;
            let phase = -(0.1 * 72.0 * frequency).atan2(72.0 * 72.0 - frequency * frequency);
            Point {
                load,
                speed: 0.02,
                drive: 2.5e-6,
                frequency,
                amplitude: 1e-6,
                amplitude_sd: 1e-8,
                phase: Some(sign * phase),
                phase_sd: Some(0.01),
                row: i + 1,
                line: i + 2,
                mean: None,
                replicates: 1,
                series: 0,
            }
        };
        (0..25).map(point).collect()
    }

    #[test]
    fn only_what_is_unlikely_is_doubted() {
        assert!(doubts(&curve(20.0, 1.0), true).is_empty() && doubts(&curve(2e9, 1.0), true).is_empty());
        assert!(doubts(&curve(20.0, -1.0), true)[0].contains("sign of its phases"));
    }

    #[test]
    fn a_stretch_without_a_signal_is_told_from_a_resonance_and_a_notch() {
        let mut points = curve(20.0, 1.0);
        for point in &mut points {
            let ratio = point.frequency / 72.0;
            point.amplitude = 1e-6 / ((1.0 - ratio * ratio).powi(2) + (2e-3 * ratio).powi(2)).sqrt();
        }
        assert!(doubts(&points, true).is_empty());
        let mut notched = points.clone();
        notched[4..7].iter_mut().for_each(|point| point.amplitude *= 1e-7);
        assert!(dead(&notched).is_empty());
        points[15..22].iter_mut().for_each(|point| point.amplitude *= 1e-7);
        assert_eq!(dead(&points), (16..=22).collect::<Vec<_>>());
        assert!(doubts(&points, true).iter().any(|doubt| doubt.contains("7 amplitudes (rows 16 to 22)")));
        // Small and smooth they may be what the rig does; not as noise.
        let mut notes = Vec::new();
        assert!(without_signal(&points, &mut notes).iter().all(|without| !without) && notes.is_empty());
        points[15..22].iter_mut().zip([0.3, 1.9, 0.9, 1.2, 0.5, 2.2, 1.0]).for_each(|(point, r)| point.amplitude *= r);
        let without = without_signal(&points, &mut notes);
        assert!(without.iter().enumerate().all(|(at, without)| *without == (15..22).contains(&at)));
        assert!(notes.len() == 1 && notes[0].starts_with("7 amplitudes (rows 16 to 22)"), "{notes:?}");
    }

    #[test]
    fn a_slip_of_the_decimal_point_is_told_from_a_resonance() {
        // The resonance itself, of an arm with a hundredth of critical damping, in steps of 2 Hz.
        let mut sound = curve(20.0, 1.0);
        for point in &mut sound {
            let (f, f0) = (point.frequency, 72.0f64);
            point.amplitude = 1e-6 / ((1.0 - (f / f0).powi(2)).powi(2) + (0.1 * f / f0).powi(2)).sqrt();
            point.amplitude_sd = 0.01 * point.amplitude;
        }
        assert!(off(&sound).is_empty());
        for times in [10.0, 0.1] {
            let mut points = sound.clone();
            points[7].amplitude *= times;
            points[7].amplitude_sd *= times;
            let doubts = doubts(&points, true);
            assert!(doubts.len() == 1 && doubts[0].contains("(row 8)"), "{doubts:?}");
        }
        // A resonance of Q = 1000, in steps of 1 %: the peak is ten times its neighbours.
        for (i, point) in sound.iter_mut().enumerate() {
            point.frequency = 72.0 * (1.0 + 0.01 * (i as f64 - 12.0));
            let ratio = point.frequency / 72.0;
            point.amplitude = 1e-6 / ((1.0 - ratio * ratio).powi(2) + (1e-3 * ratio).powi(2)).sqrt();
            point.amplitude_sd = 0.01 * point.amplitude;
        }
        assert!(off(&sound).is_empty());
        // At the level of the noise, and with readings a decade apart, nothing is sure.
        for (sd, step) in [(1e-6, 2.0), (1e-8, 60.0)] {
            let mut points = curve(20.0, 1.0);
            for (i, point) in points.iter_mut().enumerate() {
                (point.amplitude, point.amplitude_sd) = ([1e-7, 1e-6][i % 2], sd);
                point.frequency = 10.0 + step * i as f64;
            }
            assert!(off(&points[..4]).is_empty());
        }
    }
}
