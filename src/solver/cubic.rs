//! Cubics between two samples with values and slopes: values, turning points, roots.

/// Value at a fraction of the way of the cubic with the values and slopes at its ends.
pub fn cubic(f0: f64, g0: f64, f1: f64, g1: f64, t: f64) -> f64 {
    let (b, c) = (3.0 * (f1 - f0) - 2.0 * g0 - g1, g0 + g1 - 2.0 * (f1 - f0));
    f0 + t * (g0 + t * (b + c * t))
}

/// Fraction of the way at which a cubic falls to zero, negative at its end; next to exactly.
pub fn crossing(f0: f64, g0: f64, f1: f64, g1: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if cubic(f0, g0, f1, g1, middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Fraction of the way at which a cubic with slopes of opposite sign at its ends turns round, and its value there.
pub fn turning_point(f0: f64, g0: f64, f1: f64, g1: f64) -> (f64, f64) {
    // f = f0 + g0 t + b t^2 + c t^3
    let (b, c) = (3.0 * (f1 - f0) - 2.0 * g0 - g1, g0 + g1 - 2.0 * (f1 - f0));
    let slope = |t: f64| g0 + t * (2.0 * b + 3.0 * c * t);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if (slope(middle) < 0.0) == (g0 < 0.0) { low = middle } else { high = middle }
    }
    let t = 0.5 * (low + high);
    (t, f0 + t * (g0 + t * (b + c * t)))
}

/// Value at the turning point between two samples (value, slope), or the first value where there is none.
pub fn between(from: (f64, f64), to: (f64, f64), size: f64) -> f64 {
    if from.1 * to.1 < 0.0 { turning_point(from.0, from.1 * size, to.0, to.1 * size).1 } else { from.0 }
}
