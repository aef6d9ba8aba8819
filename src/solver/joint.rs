//! The force of parallel slip elements (Iwan 1966) over a periodic motion, by Masing's rules: a branch from a reversal
//! is twice the curve of first loading, halved in both directions; a branch that passes an earlier reversal goes on
//! where the loop that it closes was left.

/// Force of first loading f(u) = F [1 - (1 - u/x_m)^n], x_m = n F/k, odd in u, with its slopes by u, k, F and n.
#[derive(Debug, Clone, Copy)]
struct Loading {
    force: f64,
    by_stretch: f64,
    by_parameters: [f64; 3],
}

fn loading([k, limit, n]: [f64; 3], u: f64) -> Loading {
    let sign = if u < 0.0 { -1.0 } else { 1.0 };
    let share = (u.abs() * k / (n * limit)).min(1.0);
    let rest = 1.0 - share;
    if rest <= 0.0 {
        return Loading { force: sign * limit, by_stretch: 0.0, by_parameters: [0.0, sign, 0.0] };
    }
    let slope = rest.powf(n - 1.0);
    let power = slope * rest;
    let by_limit = 1.0 - power - n * slope * share;
    let by_exponent = -limit * (power * rest.ln() + slope * share);
    Loading {
        force: sign * limit * (1.0 - power),
        by_stretch: k * slope,
        by_parameters: [u * slope, sign * by_limit, sign * by_exponent],
    }
}

/// Force on the way down from the top of a motion between `amplitude` and its negative, at any place of it.
pub(super) fn unloading([k, limit, n]: [f64; 3], amplitude: f64) -> impl Fn(f64) -> f64 {
    // Of first loading by u >= 0.
    let loading = move |u: f64| limit * (1.0 - (1.0 - u * k / (n * limit)).max(0.0).powf(n));
    let top = loading(amplitude);
    move |x| top - 2.0 * loading(0.5 * (amplitude - x))
}

/// A motion at one instant: its value and the derivatives of that by the unknowns of the motion.
#[derive(Debug, Clone)]
pub(super) struct Instant {
    /// x.
    pub x: f64,
    /// dx by every unknown.
    pub by: Vec<f64>,
}

/// A reversal that the elements remember: motion and force there, with their derivatives.
#[derive(Debug, Clone)]
pub(super) struct Corner {
    x: f64,
    /// dx by every unknown.
    pub dx: Vec<f64>,
    force: f64,
    /// Of the force by every unknown.
    pub by: Vec<f64>,
    by_parameters: [f64; 3],
}

/// The force at one instant; its derivative by the unknowns is that of the corner and `stiffness` times the motion
/// since.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pull {
    /// The force.
    pub force: f64,
    /// Its derivatives by stiffness, limit and exponent.
    pub by_parameters: [f64; 3],
    /// Tangential stiffness.
    pub stiffness: f64,
    /// The reversal from which the motion comes.
    pub corner: usize,
}

/// Forces over one period of the motion `x`, with the reversals that they come from; none where the motion has none.
/// `turns[j]` is the reversal between instant j and the next, where there is one.
pub(super) fn pulls(joint: [f64; 3], x: &[f64], turns: &[Option<Instant>]) -> (Vec<Pull>, Vec<Corner>) {
    let count = x.len();
    let mut pulls = vec![Pull::default(); count];
    let reversals: Vec<(usize, &Instant)> =
        turns.iter().enumerate().filter_map(|(j, t)| Some((j, t.as_ref()?))).collect();
    let top = reversals.iter().max_by(|a, b| a.1.x.total_cmp(&b.1.x));
    let bottom = reversals.iter().min_by(|a, b| a.1.x.total_cmp(&b.1.x));
    let (Some(&(top, high)), Some(&(bottom, low))) = (top, bottom) else { return (pulls, Vec::new()) };
    // At the two ends the elements that slip are loaded to their limits, the others follow the motion.
    let end = loading(joint, 0.5 * (high.x - low.x));
    let extreme = |at: &Instant, sign: f64| Corner {
        x: at.x,
        dx: at.by.clone(),
        force: sign * end.force + end.by_stretch * 0.5 * (high.x + low.x),
        by: high.by.iter().zip(&low.by).map(|(a, b)| 0.5 * end.by_stretch * (sign * (a - b) + a + b)).collect(),
        by_parameters: end.by_parameters.map(|p| sign * p),
    };
    let mut corners = vec![extreme(low, -1.0), extreme(high, 1.0)];
    let mut stack = vec![0, 1];
    for step in 1..=count {
        let j = (top + step) % count;
        close_loops(&mut stack, &corners, x[j]);
        pulls[j] = branch(joint, &corners, stack[stack.len() - 1], x[j]);
        if j == top {
            break;
        }
        if j == bottom {
            stack = vec![1, 0];
        } else if let Some(turn) = &turns[j] {
            close_loops(&mut stack, &corners, turn.x);
            let there = branch(joint, &corners, stack[stack.len() - 1], turn.x);
            let from = &corners[there.corner];
            let by = from.by.iter().zip(turn.by.iter().zip(&from.dx));
            let by = by.map(|(force, (x, start))| force + there.stiffness * (x - start)).collect();
            let Pull { force, by_parameters, .. } = there;
            stack.push(corners.len());
            corners.push(Corner { x: turn.x, dx: turn.by.clone(), force, by, by_parameters });
        }
    }
    (pulls, corners)
}

/// Forgets the inner loops that a motion to `x` has closed.
fn close_loops(stack: &mut Vec<usize>, corners: &[Corner], x: f64) {
    while let [_, _, .., before, last] = stack[..] {
        let (last, before) = (corners[last].x, corners[before].x);
        let inside = (x - before) * (last - before) > 0.0;
        if inside {
            return;
        }
        stack.truncate(stack.len() - 2);
    }
}

/// The force at `x` on the branch that leads there from a reversal.
fn branch(joint: [f64; 3], corners: &[Corner], corner: usize, x: f64) -> Pull {
    let from = &corners[corner];
    let law = loading(joint, 0.5 * (x - from.x));
    Pull {
        force: from.force + 2.0 * law.force,
        by_parameters: std::array::from_fn(|p| from.by_parameters[p] + 2.0 * law.by_parameters[p]),
        stiffness: law.by_stretch,
        corner,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// In phase and in quadrature: the first harmonic of the force over x = A sin.
    fn first_harmonic(joint: [f64; 3], amplitude: f64, samples: usize) -> (f64, f64) {
        let at = |phase: f64| Instant { x: amplitude * phase.sin(), by: vec![phase.sin()] };
        let phase = |j: usize| TAU * j as f64 / samples as f64;
        let x: Vec<f64> = (0..samples).map(|j| at(phase(j)).x).collect();
        let mut turns = vec![None; samples];
        (turns[samples / 4], turns[3 * samples / 4]) = (Some(at(0.5 * PI)), Some(at(1.5 * PI)));
        let (pulls, _) = pulls(joint, &x, &turns);
        let sum = |of: fn(f64) -> f64| (0..samples).map(|j| pulls[j].force * of(phase(j))).sum::<f64>();
        (2.0 * sum(f64::sin) / samples as f64 / amplitude, 2.0 * sum(f64::cos) / samples as f64 / amplitude)
    }

    /// Caughey's (1960) equivalent stiffness and damping of a Jenkins element.
    #[test]
    fn one_element_has_the_stiffness_and_the_damping_of_caughey() {
        for (amplitude, stiffness, damping) in
            [(1.2, 0.890_45, 0.176_84), (2.0, 0.5, 1.0 / PI), (5.0, 0.142_378, 0.203_719)]
        {
            let (k, c) = first_harmonic([1.0, 1.0, 1.0], amplitude, 4096);
            assert!((k - stiffness).abs() < 1e-5 && (c - damping).abs() < 1e-5, "{amplitude}: {k} {c}");
        }
    }

    #[test]
    fn below_the_limit_a_joint_is_a_spring() {
        let (k, c) = first_harmonic([3.0, 1.0, 1.0], 0.3, 64);
        assert!((k - 3.0).abs() < 1e-12 && c.abs() < 1e-12);
    }

    /// Energy of the Hertz-Mindlin-Cattaneo loop (n = 3/2), in closed form.
    #[test]
    fn the_loop_of_mindlin_loses_what_the_closed_form_says() {
        for (q, energy) in [(0.3f64, 0.007_525_1), (0.7, 0.149_826_6), (0.95, 0.677_531_5)] {
            let amplitude = 1.5 * (1.0 - (1.0 - q).powf(2.0 / 3.0));
            let (_, c) = first_harmonic([1.0, 1.0, 1.5], amplitude, 4096);
            let lost = PI * amplitude * amplitude * c;
            assert!((lost / energy - 1.0).abs() < 1e-5, "{q}: {lost}");
        }
    }

    #[test]
    fn slopes_of_first_loading_are_those_of_differences() {
        for u in [-0.7, -0.2, 0.1, 0.5, 1.2, 3.0] {
            let p = [2.0, 1.1, 1.7];
            let found = loading(p, u);
            let h = 1e-6;
            let by_u = (loading(p, u + h).force - loading(p, u - h).force) / (2.0 * h);
            assert!((found.by_stretch - by_u).abs() < 1e-6, "{u}");
            for i in 0..3 {
                let moved =
                    |step: f64| loading(std::array::from_fn(|k| p[k] + if k == i { step } else { 0.0 }), u).force;
                let by = (moved(h) - moved(-h)) / (2.0 * h);
                assert!((found.by_parameters[i] - by).abs() < 1e-6, "{u} {i}: {} {by}", found.by_parameters[i]);
            }
        }
    }
}
