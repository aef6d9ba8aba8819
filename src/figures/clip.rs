//! Clipping of lines to a rectangle, and thinning of them, which plotters does not do.

use super::pixels::Point;

/// A rectangle: its upper left and its lower right corner.
pub type Window = (Point, Point);

/// The parts of an open polygon that lie in the window; interrupted where a coordinate is not finite.
pub fn polyline(points: &[Point], window: Window) -> Vec<Vec<Point>> {
    let mut runs: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((from, to)) = segment(pair[0], pair[1], window) else {
            open = false;
            continue;
        };
        match runs.last_mut().filter(|_| open) {
            Some(run) => run.push(to),
            None => runs.push(vec![from, to]),
        }
        open = to == pair[1];
    }
    runs
}

/// The part of a segment in the window (Liang and Barsky).
fn segment(from: Point, to: Point, (low, high): Window) -> Option<(Point, Point)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    if !(from.0 + from.1 + dx + dy).is_finite() {
        return None;
    }
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    // For every edge: the way to it, and how much of that way the segment takes.
    let edges = [(low.0 - from.0, dx), (from.0 - high.0, -dx), (low.1 - from.1, dy), (from.1 - high.1, -dy)];
    for (way, speed) in edges {
        if speed > 0.0 {
            enter = enter.max(way / speed);
        } else if speed < 0.0 {
            leave = leave.min(way / speed);
        } else if way > 0.0 {
            return None;
        }
    }
    let at = |share: f64| (from.0 + share * dx, from.1 + share * dy);
    let (start, end) = (if enter > 0.0 { at(enter) } else { from }, if leave < 1.0 { at(leave) } else { to });
    (enter <= leave).then_some((start, end))
}

/// Largest distance \[px\] of a point that is left out from the line without it: half a unit of the drawing.
const DEVIATION: f64 = 0.03;
/// Largest distance \[px\] of neighbours between which points are left out; the page reads values at what is left.
const SPACING: f64 = 5.0;

/// An open polygon without points that lie on the line between their neighbours as finely as drawings are written.
pub fn thinned(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
    let mut from = 0;
    while from + 1 < points.len() {
        let skippable = |to: &usize| {
            let (a, b) = (points[from], points[*to]);
            let (dx, dy) = (b.0 - a.0, b.1 - a.1);
            let length = dx.hypot(dy);
            let near = |&(x, y): &Point| {
                let along = (dx * (x - a.0) + dy * (y - a.1)) / length;
                (dx * (y - a.1) - dy * (x - a.0)).abs() < DEVIATION * length && (0.0..=length).contains(&along)
            };
            length <= SPACING && points[from + 1..*to].iter().all(near)
        };
        let to = (from + 2..points.len()).take_while(skippable).last().unwrap_or(from + 1);
        kept.push(points[to]);
        from = to;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = ((0.0, 0.0), (10.0, 10.0));

    #[test]
    fn what_lies_inside_stays_in_one_piece() {
        let line = [(0.0, 0.0), (5.0, 5.0), (10.0, 0.0), (10.0, 10.0)];
        assert_eq!(polyline(&line, WINDOW), vec![line.to_vec()]);
    }

    #[test]
    fn excursions_are_cut_at_the_edges() {
        let line = [(1.0, 5.0), (4.0, 5.0), (4.0, 20.0), (8.0, 20.0), (8.0, 5.0), (-8.0, 5.0)];
        let parts = vec![vec![(1.0, 5.0), (4.0, 5.0), (4.0, 10.0)], vec![(8.0, 10.0), (8.0, 5.0), (0.0, 5.0)]];
        assert_eq!(polyline(&line, WINDOW), parts);
        assert_eq!(polyline(&[(-5.0, 5.0), (15.0, 5.0)], WINDOW), vec![vec![(0.0, 5.0), (10.0, 5.0)]]);
    }

    #[test]
    fn what_lies_outside_or_is_missing_leaves_nothing() {
        assert!(polyline(&[(-5.0, 0.0), (-5.0, 10.0), (-1.0, 40.0), (20.0, 12.0)], WINDOW).is_empty());
        assert!(polyline(&[(1.0, 1.0)], WINDOW).is_empty());
        let gap = [(1.0, 1.0), (2.0, 1.0), (3.0, f64::NAN), (4.0, 1.0), (5.0, 1.0), (f64::INFINITY, 1.0)];
        assert_eq!(polyline(&gap, WINDOW), vec![vec![(1.0, 1.0), (2.0, 1.0)], vec![(4.0, 1.0), (5.0, 1.0)]]);
    }

    #[test]
    fn thinning_leaves_corners_reversals_and_wide_steps_and_moves_nothing_visibly() {
        let wide = [(0.0, 0.0), (6.0, 0.0), (12.0, 0.0)];
        assert_eq!(thinned(&wide), wide);
        let corner: Vec<Point> = (0..=20).map(|i| (0.1 * f64::from(i), (0.1 * f64::from(i) - 1.0).max(0.0))).collect();
        assert_eq!(thinned(&corner), [corner[0], corner[10], corner[20]]);
        let there_and_back = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (1.0, 0.0), (0.0, 0.0)];
        assert_eq!(thinned(&there_and_back), [(0.0, 0.0), (2.0, 0.0), (0.0, 0.0)]);
        let wave: Vec<Point> = (0..=4000).map(|i| f64::from(i) * 0.1).map(|x| (x, 80.0 * (x / 40.0).sin())).collect();
        let thin = thinned(&wave);
        assert!(thin.len() < wave.len() / 20, "{}", thin.len());
        for &(x, y) in &wave {
            let at = thin.partition_point(|p| p.0 < x).clamp(1, thin.len() - 1);
            let ((a, u), (b, v)) = (thin[at - 1], thin[at]);
            assert!((u + (v - u) * (x - a) / (b - a) - y).abs() < 0.1, "{x}");
        }
        assert!(thinned(&[]).is_empty() && thinned(&[(1.0, 1.0)]).len() == 1);
    }
}
