//! Zeros of functions of one variable.

/// Zero of `f` between the two ends of a bracket, where it has the given values of opposite signs: regula falsi, the
/// value at an end that stays twice halved (Illinois). Ends where a step or the bracket is below the accuracy, absolute
/// plus relative, or after `most` evaluations; an end where the value is zero is the answer.
pub fn regula_falsi(
    f: impl Fn(f64) -> f64,
    [mut low, mut high]: [f64; 2],
    mut ends: [f64; 2],
    (absolute, relative): (f64, f64),
    most: usize,
) -> f64 {
    if let Some(end) = ends.iter().position(|value| *value == 0.0) {
        return [low, high][end];
    }
    let positive_below = ends[0] > 0.0;
    let (mut last, mut side) = (f64::INFINITY, None);
    for _ in 0..most {
        let inside = (low * ends[1] - high * ends[0]) / (ends[1] - ends[0]);
        let x = if inside > low && inside < high { inside } else { 0.5 * (low + high) };
        let value = f(x);
        let below = (value > 0.0) == positive_below;
        if below {
            (low, ends[0]) = (x, value)
        } else {
            (high, ends[1]) = (x, value)
        }
        if side == Some(below) {
            ends[usize::from(below)] *= 0.5;
        }
        side = Some(below);
        let small = |step: f64| step.abs() < absolute + relative * x.abs();
        if value == 0.0 || small(x - last) || small(high - low) {
            return x;
        }
        last = x;
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_found_to_rounding_whatever_the_sign_below_them() {
        for turned in [1.0, -1.0] {
            let f = |x: f64| turned * (x * x * x - 2.0);
            let zero = regula_falsi(f, [0.0, 5.0], [f(0.0), f(5.0)], (0.0, 1e-15), 60);
            assert!((zero - 2f64.cbrt()).abs() < 1e-14, "{zero}");
        }
    }

    #[test]
    fn an_end_that_is_zero_is_the_answer() {
        for (ends, zero) in [([0.0, -1.0], 0.0), ([0.0, 1.0], 0.0), ([1.0, 0.0], 1.0), ([-1.0, 0.0], 1.0)] {
            let f = |x: f64| ends[0] + (ends[1] - ends[0]) * x;
            assert_eq!(regula_falsi(f, [0.0, 1.0], ends, (1e-9, 0.0), 8), zero);
        }
    }

    #[test]
    fn a_few_evaluations_find_the_zero_of_a_wave() {
        let calls = std::cell::Cell::new(0);
        let f = |x: f64| {
            calls.set(calls.get() + 1);
            (x - 0.1).sin()
        };
        let zero = regula_falsi(f, [0.0, 0.4], [(-0.1f64).sin(), 0.3f64.sin()], (1e-9, 0.0), 8);
        assert!((zero - 0.1).abs() < 1e-9 && calls.get() < 8, "{zero} {}", calls.get());
    }
}
