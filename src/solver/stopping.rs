//! Periodic states of a single mode that dry friction may bring to rest, or whose damping has no bounded slope at rest:
//! shooting over one period in time.
//!
//! The linear mode is carried exactly, as the difference from its own answer to the drive; the other forces are linear
//! in time over a step, dry friction constant. A step ends where the velocity is zero. There the body stays as long as
//! the force on it is no more than the friction. Derivatives are differences of one cycle each, carried over to the
//! periodic state by its map.

use super::describing::{describing, nearly};
use super::oscillator::Found;
use super::oscillator::stability::flow;
use super::tolerance::Tolerance;
use crate::model::system::SingleMode;
use crate::roots::regula_falsi;
use std::f64::consts::TAU;

/// Steps of a cycle, and of one with a slope without bound.
const STEPS: [usize; 2] = [256, 2048];
/// Fewest steps of a coarse search.
const FEWEST: usize = 96;
/// Parts of a step between which the body stops or starts, at most.
const PARTS: usize = 8;
/// Corrections of the start of a cycle, and the largest relative one that is left.
const CORRECTIONS: usize = 60;
const LEFT: f64 = 1e-9;
/// Relative size of the changes by which derivatives are taken: half the digits of what a cycle is good for.
const CHANGE: f64 = 1e-6;
/// Iterations for the velocity at the end of a step, and its accuracy relative to the largest velocity.
const ITERATIONS: usize = 80;
const VELOCITY: f64 = 1e-13;
/// Phases below which a step is so short that its coefficients are those of a free mass.
const SHORT: f64 = 1e-3;
/// Amplitudes of two states that differ by less than this share are one.
const SAME: f64 = 1e-6;
/// Where a force of the laws is looked at, in amplitudes.
const LOOKED: [f64; 3] = [0.3, 0.7, 1.1];

/// Numbers of the equations, some of them moved to take derivatives.
#[derive(Clone, Copy)]
struct Numbers {
    /// M, C, K, drive (real, imaginary), dry friction.
    values: [f64; 6],
    /// A parameter of the laws and by how much it is moved.
    law: Option<(usize, f64)>,
}

/// Coefficients of a step: the flow of the linear mode, and the motion by the other forces at the end of the step.
#[derive(Clone, Copy)]
struct Carry {
    length: f64,
    flow: [[f64; 2]; 2],
    by: [f64; 2],
}

/// What a cycle leads to.
#[derive(Clone, Copy, Default)]
struct Cycle {
    end: [f64; 2],
    response: [f64; 2],
    mean: f64,
    rest: f64,
}

impl Cycle {
    /// The motion over a part of the cycle by its cubic, on the two points of Gauss.
    fn add(&mut self, omega: f64, (t, length): (f64, f64), from: [f64; 2], to: [f64; 2]) {
        for share in [0.5 - 0.5 / 3f64.sqrt(), 0.5 + 0.5 / 3f64.sqrt()] {
            let rest = 1.0 - share;
            let x = rest * rest * (1.0 + 2.0 * share) * from[0]
                + share * share * (3.0 - 2.0 * share) * to[0]
                + share * rest * length * (rest * from[1] - share * to[1]);
            let (sine, cosine) = (omega * (t + share * length)).sin_cos();
            let weight = 0.5 * length * omega / TAU;
            self.mean += weight * x;
            self.response[0] += 2.0 * weight * x * sine;
            self.response[1] += 2.0 * weight * x * cosine;
        }
    }
}

/// The mode with these numbers.
struct Shot<'a> {
    mode: &'a dyn SingleMode,
    numbers: Numbers,
    steps: usize,
    free: (f64, f64),
    fastest: f64,
    full: Carry,
}

impl<'a> Shot<'a> {
    fn new(mode: &'a dyn SingleMode, numbers: Numbers, steps: usize) -> Self {
        let [mass, damping, stiffness, re, im, _] = numbers.values;
        let omega = mode.omega();
        let (k, c) = (stiffness - mass * omega * omega, damping * omega);
        let square = k * k + c * c;
        let free = ((re * k + im * c) / square, (im * k - re * c) / square);
        let full = Carry { length: 0.0, flow: [[0.0; 2]; 2], by: [0.0; 2] };
        let mut shot = Self { mode, numbers, steps, free, fastest: omega * free.0.hypot(free.1), full };
        shot.full = shot.carry(TAU / omega / steps as f64);
        shot
    }

    fn friction(&self) -> f64 {
        self.numbers.values[5]
    }

    fn carry(&self, length: f64) -> Carry {
        let [mass, damping, stiffness, ..] = self.numbers.values;
        let flow = flow(stiffness / mass, 0.5 * damping / mass, length);
        let by = if length * (stiffness / mass).sqrt() < SHORT {
            [length * length / (6.0 * mass), 0.5 * length / mass]
        } else {
            let (lag, gain) = (damping / stiffness, 1.0 / (stiffness * length));
            [gain * (length - lag + flow[0][0] * lag - flow[0][1]), gain * (1.0 + flow[1][0] * lag - flow[1][1])]
        };
        Carry { length, flow, by }
    }

    /// Force of the laws with its slopes.
    fn force(&self, x: f64, v: f64) -> [f64; 3] {
        self.mode.spend(self.mode.force_cost());
        let mut force = self.mode.force(x, v);
        if let Some((number, change)) = self.numbers.law {
            let mut by = vec![0.0; self.mode.columns()];
            self.mode.add_columns(x, v, change, &mut by);
            force[0] += by[number];
        }
        force
    }

    /// What drive, spring and laws do to the body at rest at `x`.
    fn pull(&self, t: f64, x: f64) -> f64 {
        let [_, _, stiffness, re, im, _] = self.numbers.values;
        let (sine, cosine) = (self.mode.omega() * t).sin_cos();
        re * sine + im * cosine - stiffness * x + self.force(x, 0.0)[0]
    }

    /// The motion without other forces than the drive.
    fn free(&self, t: f64) -> [f64; 2] {
        let ((re, im), omega) = (self.free, self.mode.omega());
        let (sine, cosine) = (omega * t).sin_cos();
        [re * sine + im * cosine, omega * (re * cosine - im * sine)]
    }

    /// The end of a step from time `t` on, dry friction opposing a motion of this sign.
    fn step(&self, t: f64, [x, v]: [f64; 2], carry: &Carry, sign: f64) -> [f64; 2] {
        let stiffness = self.numbers.values[2];
        let (free, then) = (self.free(t), self.free(t + carry.length));
        let start = self.force(x, v)[0] - sign * self.friction();
        let rest = start / stiffness;
        let apart = [x - free[0] - rest, v - free[1]];
        let [row, other] = carry.flow;
        let steady = [
            then[0] + rest + row[0] * apart[0] + row[1] * apart[1],
            then[1] + other[0] * apart[0] + other[1] * apart[1],
        ];
        let change = self.change(steady, start + sign * self.friction(), carry);
        [steady[0] + carry.by[0] * change, steady[1] + carry.by[1] * change]
    }

    /// By how much the force of the laws differs from `start` at the end of a step that leads to `steady` without that:
    /// Newton's method for the velocity there, within what is known to enclose it.
    fn change(&self, steady: [f64; 2], start: f64, carry: &Carry) -> f64 {
        let [by_x, by_v] = carry.by;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut velocity = steady[1];
        for _ in 0..ITERATIONS {
            let change = (velocity - steady[1]) / by_v;
            let [force, slope_x, slope_v] = self.force(steady[0] + by_x * change, velocity);
            let left = force - start - change;
            if left > 0.0 {
                low = velocity
            } else {
                high = velocity
            }
            let mut next = velocity - left / (slope_x * by_x / by_v + slope_v - 1.0 / by_v);
            if !(next > low && next < high) {
                next = match (low.is_finite(), high.is_finite()) {
                    (true, true) => 0.5 * (low + high),
                    // A step without damping goes too far at most.
                    _ => velocity + by_v * left,
                };
            }
            let moved = (next - velocity).abs();
            velocity = next;
            if moved <= VELOCITY * self.fastest || high - low <= VELOCITY * self.fastest {
                break;
            }
        }
        (velocity - steady[1]) / by_v
    }

    /// When within a time the body that rests at `x` begins to move, and in which direction.
    fn leaves(&self, t: f64, within: f64, x: f64) -> Option<(f64, f64)> {
        let beyond = |after: f64| self.pull(t + after, x).abs() - self.friction();
        let (now, then) = (beyond(0.0), beyond(within));
        let after = match (now > 0.0, then > 0.0) {
            (true, _) => 0.0,
            (false, false) => return None,
            (false, true) => regula_falsi(beyond, [0.0, within], [now, then], (0.0, 1e-12), ITERATIONS),
        };
        Some((after, self.pull(t + after, x).signum()))
    }

    /// One cycle from a state at time 0.
    fn cycle(&self, start: [f64; 2]) -> Cycle {
        let mut cycle = Cycle::default();
        let mut state = start;
        for step in 0..self.steps {
            state = self.between(step as f64 * self.full.length, state, &mut cycle);
        }
        Cycle { end: state, ..cycle }
    }

    /// One step of the cycle, in parts where the body stops or starts.
    fn between(&self, from: f64, mut state: [f64; 2], cycle: &mut Cycle) -> [f64; 2] {
        let (mut t, mut left, omega) = (from, self.full.length, self.mode.omega());
        for _ in 0..PARTS {
            let mut sign = state[1].signum();
            if self.friction() > 0.0 && state[1] == 0.0 {
                let leaves = self.leaves(t, left, state[0]);
                let (rest, direction) = leaves.unwrap_or((left, 0.0));
                cycle.add(omega, (t, rest), state, state);
                cycle.rest += rest * omega / TAU;
                (t, left, sign) = (t + rest, left - rest, direction);
                if leaves.is_none() || left <= 0.0 {
                    return state;
                }
            }
            let carry = if left == self.full.length { self.full } else { self.carry(left) };
            let end = self.step(t, state, &carry, sign);
            if self.friction() == 0.0 || end[1] * sign >= 0.0 {
                cycle.add(omega, (t, left), state, end);
                return end;
            }
            if state[1] == 0.0 {
                cycle.add(omega, (t, left), state, state);
                return state;
            }
            let speed = |length: f64| sign * self.step(t, state, &self.carry(length), sign)[1];
            let ends = [sign * state[1], sign * end[1]];
            let took = regula_falsi(speed, [0.0, left], ends, (0.0, 1e-13), ITERATIONS);
            let stopped = [self.step(t, state, &self.carry(took), sign)[0], 0.0];
            cycle.add(omega, (t, took), state, stopped);
            (state, t, left) = (stopped, t + took, left - took);
        }
        state
    }

    /// Slopes of end and response of a cycle by its start.
    fn slopes(&self, start: [f64; 2], cycle: &Cycle, size: f64) -> [Slope; 2] {
        [0, 1].map(|which| {
            let change = CHANGE * if which == 0 { size } else { size * self.mode.omega() };
            let mut moved = start;
            moved[which] += change;
            Slope::of(&self.cycle(moved), cycle, change)
        })
    }
}

/// Derivatives of end and response of a cycle.
#[derive(Clone, Copy, Default)]
struct Slope {
    end: [f64; 2],
    response: [f64; 2],
}

impl Slope {
    fn of(one: &Cycle, other: &Cycle, width: f64) -> Self {
        let difference = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| (a[i] - b[i]) / width);
        Self { end: difference(one.end, other.end), response: difference(one.response, other.response) }
    }
}

/// The change of a periodic start under which the end of its cycle moves by `by` beside what its map does.
fn carried(map: &[Slope; 2], by: [f64; 2]) -> [f64; 2] {
    let (a, b, c, d) = (1.0 - map[0].end[0], -map[1].end[0], -map[0].end[1], 1.0 - map[1].end[1]);
    let determinant = a * d - b * c;
    [(d * by[0] - b * by[1]) / determinant, (a * by[1] - c * by[0]) / determinant]
}

/// Largest modulus of the multipliers of a map.
fn multiplier(map: &[Slope; 2]) -> f64 {
    let (trace, determinant) =
        (map[0].end[0] + map[1].end[1], map[0].end[0] * map[1].end[1] - map[1].end[0] * map[0].end[1]);
    let root = 0.25 * trace * trace - determinant;
    if root >= 0.0 { 0.5 * trace.abs() + root.sqrt() } else { determinant.max(0.0).sqrt() }
}

/// All stable periodic states that are found, the smallest amplitude first; without any, the unstable ones.
pub fn states(mode: &dyn SingleMode, tolerance: &Tolerance, derivatives: bool) -> Vec<Found> {
    let ([mass, damping, stiffness], (re, im), omega) = (mode.linear(), mode.drive(), mode.omega());
    let numbers = Numbers { values: [mass, damping, stiffness, re, im, mode.dry_friction()], law: None };
    if re.hypot(im) + mode.force(0.0, 0.0)[0].abs() <= mode.dry_friction() {
        return vec![stuck(mode)];
    }
    let most = STEPS[usize::from(mode.is_steep())];
    let steps = ((most as f64 / tolerance.coarsening().powi(4)) as usize).max(FEWEST);
    let shot = Shot::new(mode, numbers, steps);
    if !shot.fastest.is_finite() {
        return Vec::new();
    }
    let start = |amplitude: f64| {
        let (k, c) = describing(mode, amplitude);
        let (x, y) = (stiffness + k - mass * omega * omega, omega * damping + c);
        let scale = amplitude / re.hypot(im) / x.hypot(y);
        [scale * (im * x - re * y), omega * scale * (re * x + im * y)]
    };
    let mut starts: Vec<[f64; 2]> = nearly(mode).states.into_iter().map(start).collect();
    if starts.is_empty() {
        starts.push([0.0; 2]);
    }
    let mut found: Vec<Found> = Vec::new();
    for start in starts {
        let Some(state) = periodic(&shot, start, tolerance, derivatives) else { continue };
        let apart = |other: &Found| {
            (state.response.0 - other.response.0).hypot(state.response.1 - other.response.1)
                < SAME * state.response.0.hypot(state.response.1)
        };
        if !found.iter().any(apart) {
            found.push(state);
        }
    }
    let stable = |state: &Found| state.multiplier <= 1.0 + SAME;
    if found.iter().any(stable) {
        found.retain(stable);
    }
    found.sort_by(|a, b| a.response.0.hypot(a.response.1).total_cmp(&b.response.0.hypot(b.response.1)));
    found
}

/// A body that the drive cannot move.
fn stuck(mode: &dyn SingleMode) -> Found {
    Found {
        response: (0.0, 0.0),
        mean: 0.0,
        cycles: 0,
        left: 0.0,
        multiplier: 0.0,
        rest: 1.0,
        by: [(0.0, 0.0); 9],
        by_law: vec![(0.0, 0.0); mode.columns()],
    }
}

/// The periodic state that corrections lead to, by Newton's method where that helps and by following the motion
/// elsewhere.
fn periodic(shot: &Shot<'_>, start: [f64; 2], tolerance: &Tolerance, derivatives: bool) -> Option<Found> {
    let omega = shot.mode.omega();
    let mut start = start;
    let mut cycle = shot.cycle(start);
    let left = |start: [f64; 2], cycle: &Cycle| [cycle.end[0] - start[0], cycle.end[1] - start[1]];
    let large = |by: [f64; 2]| by[0].hypot(by[1] / omega);
    for corrections in 1..=CORRECTIONS {
        let size = cycle.response[0].hypot(cycle.response[1]);
        let residual = left(start, &cycle);
        if !(size > 0.0 && large(residual).is_finite()) || shot.mode.is_given_up() {
            return None;
        }
        let map = shot.slopes(start, &cycle, size);
        let by = carried(&map, residual);
        let next = [start[0] + by[0], start[1] + by[1]];
        let tried = shot.cycle(next);
        let better = large(left(next, &tried)) < large(residual);
        if large(by) < LEFT * tolerance.slack() * size || (!better && large(residual) < LEFT * size) {
            let (start, cycle) = if better { (next, tried) } else { (start, cycle) };
            return Some(found(shot, start, &cycle, (map, size), (corrections, large(by) / size, derivatives)));
        }
        (start, cycle) = if better { (next, tried) } else { (cycle.end, shot.cycle(cycle.end)) };
    }
    None
}

/// What is told of a periodic state.
fn found(
    shot: &Shot<'_>,
    start: [f64; 2],
    cycle: &Cycle,
    (map, size): ([Slope; 2], f64),
    (corrections, left, derivatives): (usize, f64, bool),
) -> Found {
    let by = |moved: &dyn Fn(f64) -> Numbers, change: f64| {
        if change == 0.0 || !derivatives {
            return (0.0, 0.0);
        }
        let moved = Shot::new(shot.mode, moved(change), shot.steps).cycle(start);
        let own = Slope::of(&moved, cycle, change);
        let along = carried(&map, own.end);
        let part = |i: usize| own.response[i] + map[0].response[i] * along[0] + map[1].response[i] * along[1];
        (part(0), part(1))
    };
    let [mass, _, stiffness, re, im, _] = shot.numbers.values;
    let (drive, critical) = (re.hypot(im), (mass * stiffness).sqrt());
    let of_number = |number: usize, scale: f64| {
        let moved = |change: f64| {
            let mut numbers = shot.numbers;
            numbers.values[number] += change;
            numbers
        };
        by(&moved, CHANGE * scale)
    };
    // Of mass, damping and stiffness what moves the resonance by a small part of its width.
    let scales = [size.recip() * drive / shot.mode.omega().powi(2), drive / size / shot.mode.omega(), drive / size];
    let scales = [scales[0].min(mass), scales[1].min(critical), scales[2].min(stiffness), drive, drive, drive];
    let numbers: [(f64, f64); 6] = std::array::from_fn(|i| match i {
        5 if shot.friction() == 0.0 => (0.0, 0.0),
        _ => of_number(i, scales[i]),
    });
    let none = (0.0, 0.0);
    let of_law = |number: usize| {
        let largest = LOOKED.iter().map(|share| {
            let mut sums = vec![0.0; shot.mode.columns()];
            shot.mode.add_columns(share * size, share * size * shot.mode.omega(), 1.0, &mut sums);
            sums[number].abs()
        });
        let largest = largest.fold(0.0, f64::max);
        let moved = |change: f64| Numbers { law: Some((number, change)), ..shot.numbers };
        by(&moved, if largest > 0.0 { CHANGE * drive / largest } else { 0.0 })
    };
    Found {
        response: (cycle.response[0], cycle.response[1]),
        mean: cycle.mean,
        cycles: corrections,
        left,
        multiplier: multiplier(&map),
        rest: cycle.rest,
        by: [numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], none, none, none, numbers[5]],
        by_law: (0..shot.mode.columns()).map(of_law).collect(),
    }
}
