//! Clipping of lines to a rectangle, which plotters does not do.

use super::canvas::Point;

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
}
