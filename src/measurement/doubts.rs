//! What in a table is possible and yet not likely: said, not refused.

use super::Point;
use crate::solver::analytic::wrap;
use crate::statistics::median;
use crate::units;

/// Normal loads above this are doubted \[N\].
const HEAVY: f64 = 2e3;
/// Points of a curve whose phases tell which way they turn, at least, and by how much they turn, at least \[rad\].
const TURNING: (usize, f64) = (6, 0.5);

/// Doubts about the loads and the sign of the phases.
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
    doubts
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
}
