//! Noise in two parts: one in proportion to the reading, and one that falls with something else - the reading, as what
//! an amplifier adds does, or how flat the curve is, as what a frequency that wavers leaves - told apart by the scatter
//! of windows where that is small beside that of windows where it is large.

/// Fewest windows of a group, and most groups.
const GROUP: usize = 20;
const GROUPS: usize = 16;
/// Bayesian evidence of 20 to 1 for a second part, beside its price.
const MARGIN: f64 = 6.0;
/// Steps over the ratio of both parts, for a factor of ten.
const STEPS: f64 = 20.0;

/// Relative variance of windows that have about as much of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group {
    /// With which the second part falls: a reading, or the inverse of a slope.
    pub size: f64,
    pub variance: f64,
    pub degrees_of_freedom: f64,
}

/// Both parts of a noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Two {
    /// Standard deviation in proportion to the reading.
    pub share: f64,
    /// The other, times the size with which it falls.
    pub rest: f64,
    /// Twice the logarithm of how much likelier both are than one alone, less the price of the second.
    pub gain: f64,
}

/// Ranges of sizes with as many windows each, and the middle of each; none where there are too few.
pub(super) fn groups(mut sizes: Vec<f64>) -> Vec<((f64, f64), f64)> {
    sizes.sort_by(f64::total_cmp);
    let count = (sizes.len() / GROUP).min(GROUPS);
    if count < 2 {
        return Vec::new();
    }
    let at = |half: usize| sizes[half * (sizes.len() - 1) / (2 * count)];
    (0..count).map(|number| ((at(2 * number), at(2 * number + 2)), at(2 * number + 1))).collect()
}

/// Both parts, where the variances v = s^2 + (c/size)^2 are likelier so than all the same, by more than a second
/// parameter costs.
pub(super) fn parts(groups: &[Group]) -> Option<Two> {
    if groups.len() < 2 {
        return None;
    }
    let freedom: f64 = groups.iter().map(|group| group.degrees_of_freedom).sum();
    // Of variances in these proportions: the size of all, and -2 ln likelihood.
    let fitted = |shape: &dyn Fn(&Group) -> f64| {
        let each = groups.iter().map(|group| group.degrees_of_freedom * group.variance / shape(group));
        let size = each.sum::<f64>() / freedom;
        let log = |group: &Group| group.degrees_of_freedom * (size * shape(group)).ln();
        (size, groups.iter().map(log).sum::<f64>() + freedom)
    };
    let alone = fitted(&|_| 1.0).1;
    let least = groups.iter().map(|group| group.size).fold(f64::INFINITY, f64::min);
    let most = groups.iter().map(|group| group.size).fold(0.0, f64::max);
    let decades = (most / least).log10() + 2.0;
    let number = (decades * STEPS) as usize;
    // From one below the least size to one above the largest, where it is all that there is.
    let ratio = |step: usize| 0.1 * least * 10f64.powf(step as f64 / STEPS);
    let of = |step: usize| {
        let ratio = ratio(step);
        (ratio, fitted(&|group: &Group| 1.0 + (ratio / group.size).powi(2)))
    };
    let all: Vec<(f64, (f64, f64))> = (0..=number).map(of).collect();
    let likelihood = all.iter().map(|(_, (_, likelihood))| *likelihood).fold(f64::INFINITY, f64::min);
    // The largest share within a standard deviation: small sizes hide it, and the largest ones would count too much
    // without.
    let (ratio, (size, _)) = *all.iter().find(|(_, (_, own))| *own <= likelihood + 1.0)?;
    let gain = alone - likelihood - freedom.ln() - MARGIN;
    (gain > 0.0).then(|| Two { share: size.sqrt(), rest: size.sqrt() * ratio, gain })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(variance: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let group = |n: i32| {
            let size = 10f64.powf(-0.3 * f64::from(n));
            // As far off as 20 degrees of freedom are.
            let chance = 1.0 + 0.2 * f64::from(n % 3 - 1);
            Group { size, variance: chance * variance(size), degrees_of_freedom: 20.0 }
        };
        parts(&(0..6).map(group).collect::<Vec<_>>()).map(|two| (two.share, two.rest))
    }

    #[test]
    fn either_part_is_found_and_none_where_there_is_one() {
        assert_eq!(of(|_| 1e-4), None);
        let (share, floor) = of(|reading| 1e-4 + (1e-3 / reading).powi(2)).expect("two parts");
        assert!((0.5..2.0).contains(&(share / 1e-2)) && (0.6..1.6).contains(&(floor / 1e-3)), "{share} {floor}");
        let (share, floor) = of(|reading| (1e-3 / reading).powi(2)).expect("a floor");
        assert!(share < 1.2e-3 && (0.7..1.4).contains(&(floor / 1e-3)), "{share} {floor}");
        // What grows with the reading is no floor.
        assert_eq!(of(|reading| 1e-4 * reading), None);
    }

    #[test]
    fn too_few_windows_are_one_group() {
        assert!(groups(vec![1.0; 2 * GROUP - 1]).is_empty());
        assert_eq!(groups((0..50).map(f64::from).collect()), [((0.0, 24.0), 12.0), ((24.0, 49.0), 36.0)]);
    }
}
