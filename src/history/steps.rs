//! Steps of a series: binary segmentation of the series under a running median of three, with a penalty of Schwarz's
//! kind.
//!
//! A piece is cut where two constant levels leave the least sum of squares, if that is less than the sum about one
//! level by more than three times ln n in units of the variance of the scatter: one for the second level, one for the
//! place, one for good measure. The scatter is estimated from the differences of successive values, by their median, so
//! that steps are no part of it; the caller says how large it is at least. Pieces have two values or more, so a step
//! shows from its second run on, and a single run that stands out is none.

use crate::statistics::median;

/// Least number of values on a level.
const LEAST: usize = 2;
/// Penalty of a step in units of ln n.
const PENALTY: f64 = 3.0;

/// A move from one level to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Index of the first value on the new level.
    pub at: usize,
    /// Median before, back to the previous step.
    pub before: f64,
    /// Median since, up to the next step.
    pub after: f64,
}

/// The steps of a series whose values scatter by `scatter` of their level at least, in order; values that are not
/// numbers are passed over.
pub fn steps(values: &[f64], scatter: f64) -> Vec<Step> {
    let (places, known): (Vec<usize>, Vec<f64>) =
        values.iter().copied().enumerate().filter(|(_, value)| value.is_finite()).unzip();
    let smooth = running_median(&known);
    let scale = known.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let deviation = deviation(&known).max(scatter * scale);
    let least = PENALTY * (known.len() as f64).ln() * deviation.powi(2);
    let mut cuts = Vec::new();
    segment(&smooth, least, 0, &mut cuts);
    cuts.sort_unstable();
    let ends: Vec<usize> = std::iter::once(0).chain(cuts.iter().copied()).chain([known.len()]).collect();
    let level = |piece: usize| median(known[ends[piece]..ends[piece + 1]].iter().copied());
    let step = |(index, &cut): (usize, &usize)| Step { at: places[cut], before: level(index), after: level(index + 1) };
    cuts.iter().enumerate().map(step).collect()
}

/// Standard deviation of values that scatter about a level with steps.
fn deviation(values: &[f64]) -> f64 {
    // Of normal differences, the median of the magnitude is 0.6745 deviations, each of which is that of two values.
    median(values.windows(2).map(|pair| (pair[1] - pair[0]).abs())) / (0.6745 * std::f64::consts::SQRT_2)
}

/// The median of each value and its neighbours; at the ends, of the outermost three.
fn running_median(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let at = |index: usize| {
        let start = index.saturating_sub(1).min(n.saturating_sub(3));
        median(values[start..n.min(start + 3)].iter().copied())
    };
    (0..n).map(at).collect()
}

/// Cuts a piece that begins at `start` of the whole where that takes more than `least` from its sum of squares, and
/// what comes of it.
fn segment(values: &[f64], least: f64, start: usize, cuts: &mut Vec<usize>) {
    let n = values.len();
    if n < 2 * LEAST {
        return;
    }
    let squares = |part: &[f64]| {
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        part.iter().map(|value| (value - mean).powi(2)).sum::<f64>()
    };
    let cut = |at: usize| (at, squares(&values[..at]) + squares(&values[at..]));
    let best = (LEAST..=n - LEAST).map(cut).min_by(|a, b| a.1.total_cmp(&b.1));
    let Some((at, sum)) = best else { return };
    if squares(values) - sum > least {
        cuts.push(start + at);
        segment(&values[..at], least, start, cuts);
        segment(&values[at..], least, start + at, cuts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(values: &[f64]) -> Vec<usize> {
        steps(values, 1e-4).iter().map(|step| step.at).collect()
    }

    /// Noise that repeats: the fractional parts of multiples of the golden ratio.
    fn noise(index: usize) -> f64 {
        (index as f64 * 0.618_034).fract() - 0.5
    }

    #[test]
    fn a_planted_step_is_found_where_it_is() {
        let values: Vec<f64> = (0..20).map(|i| if i < 13 { 1.0 } else { 1.2 } + 0.05 * noise(i)).collect();
        assert_eq!(places(&values), [13]);
        let step = steps(&values, 1e-4)[0];
        assert!((step.before - 1.0).abs() < 0.02 && (step.after - 1.2).abs() < 0.02);
        let two: Vec<f64> = (0..30).map(|i| [5.0, 3.0, 4.0][i / 10] + 0.1 * noise(i)).collect();
        assert_eq!(places(&two), [10, 20]);
    }

    #[test]
    fn numbers_without_noise_step_at_their_second_run() {
        assert_eq!(places(&[0.02, 0.02, 0.02, 0.05]), [] as [usize; 0]);
        assert_eq!(places(&[0.02, 0.02, 0.02, 0.05, 0.05]), [3]);
        assert_eq!(places(&[0.02, f64::NAN, 0.02, 0.05, f64::NAN, 0.05]), [3]);
    }

    #[test]
    fn neither_noise_nor_one_run_nor_rounding_is_a_step() {
        let noisy: Vec<f64> = (0..60).map(|i| 10.0 + noise(i)).collect();
        assert!(places(&noisy).is_empty(), "{:?}", places(&noisy));
        let mut one = vec![7.0; 20];
        one[9] = 9.0;
        assert!(places(&one).is_empty());
        // Wall times of four runs on a busy machine.
        assert!(
            steps(&[4.0, 4.1, 4.4, 4.39], 0.1).is_empty() && steps(&[1.0, 1.1, 1.0, 2.0, 2.1, 2.0], 0.1).len() == 1
        );
        assert!(places(&[1.0, 1.0, 1.0, 1.0 + 1e-9, 1.0 + 1e-9, 1.0 + 1e-9]).is_empty());
        assert!(places(&[0.0; 8]).is_empty() && places(&[]).is_empty() && places(&[f64::NAN; 9]).is_empty());
    }
}
