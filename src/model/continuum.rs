//! A continuum of parallel elements (Iwan 1966), each a bristle in series with its own slider, discretised.
//!
//! Monotonic force F = mu N [1 - (1 - x/xm)^n] with xm = n mu N/kc. The share of the stiffness whose sliders give way
//! below the stretch xi xm is p(xi) = 1 - (1 - xi)^(n-1); an element at xi carries at most n xi mu N per unit share.
//! Each element stands for a cell of p and takes the mean of xi over it, so that stiffness and largest force are exact.

/// Stretch of a bristle at rest that would be stretched by `free` and whose slider holds it up to `most`; none where a
/// law of friction that falls below zero leaves it nothing to hold with.
pub fn held(free: f64, most: f64) -> f64 {
    free.abs().min(most.max(0.0)).copysign(free)
}

/// Elements that resolve the part of the continuum that can slip.
const ELEMENTS: usize = 24;

/// One element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Share of the stiffness (and of the damping); the shares add up to one.
    pub share: f64,
    /// Largest force per share over mu N; shares times this add up to one.
    pub limit: f64,
}

/// The elements for exponent `n >= 1`. Only sliders with xi below `reach` are resolved one by one: those above never
/// slip on their own and act as one.
pub fn elements(n: f64, reach: f64) -> Vec<Element> {
    if n <= 1.0 {
        return vec![Element { share: 1.0, limit: 1.0 }];
    }
    let m = 1.0 / (n - 1.0);
    // Integral of xi over the shares from 0 to p.
    let integral = |p: f64| p - (1.0 - (1.0 - p).powf(m + 1.0)) / (m + 1.0);
    let mean = |from: f64, to: f64| n * (integral(to) - integral(from)) / (to - from);
    let reach = reach.min(1.0);
    let share = |xi: f64| 1.0 - (1.0 - xi).powf(n - 1.0);
    let resolved = share(reach);
    // Cells of equal weight half in the share and half in the stretch: neither is left coarse where the other is dense.
    let edge = |i: usize| {
        let (mut low, mut high) = (0.0, reach);
        for _ in 0..50 {
            let xi = 0.5 * (low + high);
            let weight = 0.5 * share(xi) / resolved + 0.5 * xi / reach;
            if weight < i as f64 / ELEMENTS as f64 { low = xi } else { high = xi }
        }
        if i == ELEMENTS { resolved } else { share(0.5 * (low + high)) }
    };
    let edges: Vec<f64> = (0..=ELEMENTS).map(edge).collect();
    let mut out: Vec<Element> = edges
        .windows(2)
        .map(|pair| Element { share: pair[1] - pair[0], limit: mean(pair[0], pair[1]) })
        .filter(|element| element.share > 1e-12)
        .collect();
    if resolved < 1.0 {
        out.push(Element { share: 1.0 - resolved, limit: mean(resolved, 1.0) });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force of a first loading to the stretch `x`, for mu N = kc = 1.
    fn loading(elements: &[Element], x: f64) -> f64 {
        elements.iter().map(|e| e.share * x.min(e.limit)).sum()
    }

    #[test]
    fn first_loading_follows_the_law() {
        for n in [1.05, 1.5, 2.0, 3.0, 4.0] {
            for reach in [0.02, 0.3, 1.0] {
                let all = elements(n, reach);
                let law = |x: f64| 1.0 - (1.0 - x / n).max(0.0).powf(n);
                for i in 1..=50 {
                    let x = n * reach * i as f64 / 50.0;
                    let error = (loading(&all, x) - law(x)).abs();
                    assert!(error < 1.2e-3 * reach * law(n * reach), "n {n} reach {reach} x {x}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn shares_and_largest_force_are_exact() {
        for n in [1.0, 1.01, 1.5, 2.0, 4.0] {
            for reach in [0.1, 0.9, 2.0] {
                let all = elements(n, reach);
                let share: f64 = all.iter().map(|e| e.share).sum();
                assert!((share - 1.0).abs() < 1e-12 && (loading(&all, 1e9) - 1.0).abs() < 1e-12, "n {n} reach {reach}");
            }
        }
    }

    /// Closed form of the Hertz-Mindlin-Cattaneo loop (n = 3/2) for mu = N = k0 = 1, by Masing's rule on the elements.
    #[test]
    fn loop_energy_is_that_of_mindlin() {
        for (q, energy) in [(0.3f64, 0.0075251), (0.7, 0.1498266), (0.95, 0.6775315)] {
            // Stretch at the force q, then the energy each element loses per cycle of that amplitude.
            let x = 1.5 * (1.0 - (1.0 - q).powf(2.0 / 3.0));
            let all = elements(1.5, 1.2 * x / 1.5);
            let lost: f64 = all.iter().map(|e| 4.0 * e.share * e.limit * (x - e.limit).max(0.0)).sum();
            assert!((lost / energy - 1.0).abs() < 5e-3, "q {q}: {lost}");
        }
    }
}
