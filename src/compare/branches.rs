//! Readings on the one or the other of two stable states.

use super::Compared;
use crate::measurement::{Direction, Series};

/// How many readings lie on another stable state than the one that a sweep of the model in the direction of the series
/// is on at their frequency. The state of a sweep is the one nearest to that at the frequency before.
pub(super) fn off_the_sweep(points: &[Compared], series: &[Series]) -> usize {
    let mut count = 0;
    for (index, of) in series.iter().enumerate() {
        let mut along: Vec<&Compared> = points.iter().filter(|p| p.condition == index).collect();
        if of.direction == Direction::Down {
            along.reverse();
        }
        let mut last: Option<f64> = None;
        for point in along {
            let own = point.model.amplitude;
            let states = point.model.others.iter().map(|other| other.0);
            let states = states.chain((!point.model.beyond).then_some(own));
            let far = |x: f64| last.map_or(0.0, |last: f64| (x / last).ln().abs());
            let followed = states.min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(own);
            // The first reading says where the sweep begins.
            let followed = if last.is_none() { own } else { followed };
            count += usize::from(of.direction != Direction::Unknown && !point.model.beyond && followed != own);
            last = Some(followed).filter(|x| x.is_finite()).or(last);
        }
    }
    count
}
