//! The force of parallel slip elements (Iwan 1966) over a periodic motion, by Masing's rules: a branch from a reversal is
//! twice the curve of first loading, halved in both directions; a branch that passes an earlier reversal goes on where the
//! loop that it closes was left.

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

/// Force at `x` on the way down from the top of a motion between `amplitude` and its negative.
pub(super) fn unloading(joint: [f64; 3], amplitude: f64, x: f64) -> f64 {
    loading(joint, amplitude).force - 2.0 * loading(joint, 0.5 * (amplitude - x)).force
}

/// A motion at one instant: its value and the derivatives of that by the unknowns of the motion.
#[derive(Debug, Clone)]
pub(super) struct Instant {
    /// x.
    pub x: f64,
    /// dx by every unknown.
    pub by: Vec<f64>,
}

/// The force at one instant.
#[derive(Debug, Clone)]
pub(super) struct Pull {
    /// The force.
    pub force: f64,
    /// Its derivatives by every unknown of the motion.
    pub by: Vec<f64>,
    /// Its derivatives by stiffness, limit and exponent.
    pub by_parameters: [f64; 3],
    /// Tangential stiffness.
    pub stiffness: f64,
}

/// Forces over one period. `instants` are in the order of time; `turns[j]` is the reversal of the motion between instant j and
/// the next, where there is one.
pub(super) fn pulls(joint: [f64; 3], instants: &[Instant], turns: &[Option<Instant>]) -> Vec<Pull> {
    let count = instants.len();
    let unknowns = instants.first().map_or(0, |i| i.by.len());
    let reversals: Vec<usize> = (0..count).filter(|&j| turns[j].is_some()).collect();
    let value = |j: usize| turns[j].as_ref().map_or(0.0, |turn| turn.x);
    let top = reversals.iter().copied().max_by(|&i, &j| value(i).total_cmp(&value(j)));
    let bottom = reversals.iter().copied().min_by(|&i, &j| value(i).total_cmp(&value(j)));
    let (Some(top), Some(bottom)) = (top, bottom) else { return vec![at_rest(unknowns); count] };
    let (Some(high), Some(low)) = (&turns[top], &turns[bottom]) else { return vec![at_rest(unknowns); count] };
    // At the two ends the elements that slip are loaded to their limits, the others follow the motion.
    let (half, middle) = (0.5 * (high.x - low.x), 0.5 * (high.x + low.x));
    let end = loading(joint, half);
    let offset = end.by_stretch * middle;
    let of_half: Vec<f64> = high.by.iter().zip(&low.by).map(|(a, b)| 0.5 * end.by_stretch * (a - b)).collect();
    let of_middle: Vec<f64> = high.by.iter().zip(&low.by).map(|(a, b)| 0.5 * end.by_stretch * (a + b)).collect();
    let sum = |sign: f64| -> Vec<f64> { of_half.iter().zip(&of_middle).map(|(a, b)| sign * a + b).collect() };
    let corner = |at: &Instant, sign: f64| Corner {
        x: at.x,
        dx: at.by.clone(),
        force: sign * end.force + offset,
        by: sum(sign),
        by_parameters: end.by_parameters.map(|p| sign * p),
    };
    let mut stack = vec![corner(low, -1.0), corner(high, 1.0)];
    let mut pulls = vec![at_rest(unknowns); count];
    for step in 1..=count {
        let j = (top + step) % count;
        close_loops(&mut stack, instants[j].x);
        pulls[j] = branch(joint, &stack[stack.len() - 1], &instants[j]);
        if j == top {
            break;
        }
        if j == bottom {
            stack = vec![corner(high, 1.0), corner(low, -1.0)];
        } else if let Some(turn) = &turns[j] {
            close_loops(&mut stack, turn.x);
            let there = branch(joint, &stack[stack.len() - 1], turn);
            let (x, dx) = (turn.x, turn.by.clone());
            stack.push(Corner { x, dx, force: there.force, by: there.by, by_parameters: there.by_parameters });
        }
    }
    pulls
}

fn at_rest(unknowns: usize) -> Pull {
    Pull { force: 0.0, by: vec![0.0; unknowns], by_parameters: [0.0; 3], stiffness: 0.0 }
}

/// A reversal that the elements remember.
#[derive(Debug, Clone)]
struct Corner {
    x: f64,
    dx: Vec<f64>,
    force: f64,
    by: Vec<f64>,
    by_parameters: [f64; 3],
}

/// Forgets the inner loops that a motion to `x` has closed.
fn close_loops(stack: &mut Vec<Corner>, x: f64) {
    while stack.len() > 3 {
        let (last, before) = (&stack[stack.len() - 1], &stack[stack.len() - 2]);
        let inside = (x - before.x) * (last.x - before.x) > 0.0;
        if inside {
            return;
        }
        stack.truncate(stack.len() - 2);
    }
}

/// The force on the branch that leads from a reversal to `at`.
fn branch(joint: [f64; 3], from: &Corner, at: &Instant) -> Pull {
    let law = loading(joint, 0.5 * (at.x - from.x));
    let by = from.by.iter().zip(at.by.iter().zip(&from.dx));
    Pull {
        force: from.force + 2.0 * law.force,
        by: by.map(|(force, (x, start))| force + law.by_stretch * (x - start)).collect(),
        by_parameters: std::array::from_fn(|p| from.by_parameters[p] + 2.0 * law.by_parameters[p]),
        stiffness: law.by_stretch,
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
        let instants: Vec<Instant> = (0..samples).map(|j| at(phase(j))).collect();
        let mut turns = vec![None; samples];
        (turns[samples / 4], turns[3 * samples / 4]) = (Some(at(0.5 * PI)), Some(at(1.5 * PI)));
        let pulls = pulls(joint, &instants, &turns);
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
