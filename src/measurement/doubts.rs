//! What in a table is possible and yet not likely: said, not refused.

use super::Point;
use crate::solver::analytic::wrap;
use crate::statistics::median;
use crate::units;

/// Normal loads above this are doubted \[N\].
const HEAVY: f64 = 2e3;
/// Points of a curve whose phases tell which way they turn, at least, and by how much they turn, at least \[rad\].
const TURNING: (usize, f64) = (6, 0.5);

/// An amplitude this many times above or below both its neighbours along a curve is doubted, and by more than so many standard
/// deviations, ...
const OFF: (f64, f64) = (5.0, 10.0);
/// ... where these are so near in frequency, relatively, that a resonance of a damped arm is wider.
const NEAR: f64 = 0.05;
/// So many rows are named.
const NAMED: usize = 5;

/// Doubts about the loads, the sign of the phases and single readings.
pub(super) fn doubts(points: &[Point]) -> Vec<String> {
    let mut doubts = Vec::new();
    let load = points.iter().map(|p| p.load).fold(0.0, f64::max);
    if load > HEAVY {
        doubts.push(format!("the normal load comes to {}: in which unit is it?", units::format(load, "N")));
    }
    if turn(points).is_some_and(|turn| turn > TURNING.1) {
        doubts.push(
            "the phases rise with the frequency, where those of an arm that is driven fall through its resonance: an \
             instrument that counts a lag as positive needs the sign of its phases reversed"
                .into(),
        );
    }
    let rows = off(points);
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
    doubts
}

/// Rows of amplitudes far off both their neighbours in frequency; those at the ends of a curve, which have one, are not judged.
fn off(points: &[Point]) -> Vec<usize> {
    let mut rows = Vec::new();
    for curve in points.chunk_by(|a, b| (a.load, a.speed, a.drive) == (b.load, b.speed, b.drive)) {
        let mut curve: Vec<&Point> = curve.iter().collect();
        curve.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        for three in curve.windows(3) {
            let [before, point, after] = [three[0], three[1], three[2]];
            let near = after.frequency - before.frequency < 2.0 * NEAR * point.frequency;
            let (low, high) = (before.amplitude.min(after.amplitude), before.amplitude.max(after.amplitude));
            let away = (point.amplitude - high).max(low - point.amplitude);
            let sure = away > OFF.1 * point.amplitude_sd.max(before.amplitude_sd).max(after.amplitude_sd);
            if near && sure && (point.amplitude > OFF.0 * high || OFF.0 * point.amplitude < low) {
                rows.push(point.row);
            }
        }
    }
    rows.sort_unstable();
    rows
}

/// How far the phases of a curve turn from its lowest to its highest frequency, the median over the curves \[rad\]; `None`
/// without a curve that tells.
fn turn(points: &[Point]) -> Option<f64> {
    let mut turns = Vec::new();
    for curve in points.chunk_by(|a, b| (a.load, a.speed, a.drive) == (b.load, b.speed, b.drive)) {
        let mut phases: Vec<(f64, f64)> = curve.iter().filter_map(|p| Some((p.frequency, p.phase?))).collect();
        phases.sort_by(|a, b| a.0.total_cmp(&b.0));
        if phases.len() >= TURNING.0 {
            turns.push(phases.windows(2).map(|pair| wrap(pair[1].1 - pair[0].1)).sum());
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
        assert!(doubts(&curve(20.0, 1.0)).is_empty());
        assert!(doubts(&curve(20.0, -1.0))[0].contains("sign of its phases"));
        assert!(doubts(&curve(20_000.0, 1.0))[0].contains("20 kN"));
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
            let doubts = doubts(&points);
            assert!(doubts.len() == 1 && doubts[0].contains("(row 8)"), "{doubts:?}");
        }
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
