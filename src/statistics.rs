//! Robust averages, used wherever a few values may be far off, and a test of what runs along a curve.

use statrs::distribution::{ContinuousCDF, Normal};

/// Standard deviation of a normal distribution over its median absolute deviation.
const MAD: f64 = 1.4826;
/// Values beyond so many typical ones count as that in tests.
pub const CLIP: f64 = 4.0;
/// Probability below which chance is no explanation.
pub const SIGNIFICANCE: f64 = 1e-3;

/// The median, 0 of nothing.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n => 0.5 * (values[(n - 1) / 2] + values[n / 2]),
    }
}

/// Of each number the median of it and its neighbours, in which one far off leaves no trace.
pub fn median_of_three(values: &[f64]) -> Vec<f64> {
    let about = |i: usize| values[i.saturating_sub(1)..(i + 2).min(values.len())].iter().copied();
    (0..values.len()).map(|i| median(about(i))).collect()
}

/// Robust standard deviation about `center`: 0 of nothing.
pub fn spread(values: impl IntoIterator<Item = f64>, center: f64) -> f64 {
    MAD * median(values.into_iter().map(|value| (value - center).abs()))
}

/// Whether most of what the values vary by is in common to neighbours (statistic of L. C. Young, Ann. Math. Stat. 12
/// (1941) 293): of scatter alone nothing is.
pub fn is_curve(values: &[f64]) -> bool {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let steps: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    1.0 - 0.5 * steps / squares > 0.5
}

/// Whether neighbours are more alike than those of scatter about zero by chance; what is far off counts little.
pub fn is_alike(values: &[f64]) -> bool {
    let most = CLIP * spread(values.iter().copied(), 0.0);
    let cut: Vec<f64> = values.iter().map(|value| value.clamp(-most, most)).collect();
    let squares: f64 = cut.iter().map(|value| value * value).sum();
    let products: f64 = cut.windows(2).map(|pair| pair[0] * pair[1]).sum();
    // The sum of products of independent neighbours has the deviation of squares over the root of their number.
    let deviations = products * (cut.len() as f64).sqrt() / squares;
    deviations.is_finite() && Normal::standard().sf(deviations) < SIGNIFICANCE
}

/// The angle wrapped to (-pi, pi].
pub fn wrap(angle: f64) -> f64 {
    let turned = angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round();
    if turned <= -std::f64::consts::PI { turned + std::f64::consts::TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_told_from_scatter() {
        let of = |value: fn(i32) -> f64| (0..40).map(value).collect::<Vec<f64>>();
        assert!(is_curve(&of(|i| f64::from(i - 20).abs())) && is_curve(&of(|i| f64::from(i / 20))));
        assert!(!is_curve(&of(|i| f64::from(i * 7919 % 101))) && !is_curve(&of(|i| f64::from(i % 2))));
        // Nothing, and nothing that differs, is no curve.
        assert!(!is_curve(&[]) && !is_curve(&of(|_| 1.0)));
    }

    #[test]
    fn what_goes_on_from_value_to_value_is_told_from_scatter_about_zero() {
        let of = |value: fn(i32) -> f64| (0..40).map(value).collect::<Vec<f64>>();
        let scatter: fn(i32) -> f64 = |i| f64::from(i * 7919 % 101 - 50);
        assert!(
            !is_alike(&of(scatter))
                && !is_alike(&of(|i| if i == 20 || i == 21 { 9e9 } else { f64::from(i * 7919 % 101 - 50) }))
        );
        assert!(
            is_alike(&of(|i| 100.0 + f64::from(i * 7919 % 101 - 50))) && is_alike(&of(|i| (f64::from(i) / 6.0).sin()))
        );
        assert!(!is_alike(&[]) && !is_alike(&of(|_| 0.0)));
    }

    #[test]
    fn one_value_far_off_changes_nothing() {
        assert_eq!([median([]), median([3.0]), median([1.0, 2.0]), median([9e9, 1.0, 2.0])], [0.0, 3.0, 1.5, 2.0]);
        assert_eq!(spread([1.0, 2.0, 3.0, 4.0, 9e9], 3.0), MAD);
    }
}
