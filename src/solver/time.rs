//! Plain time integration with fixed steps: trapezoidal rule for the oscillators (Newmark's average acceleration) and
//! for the bristles, a scalar search for the slip rate. Slow, simple, and independent of the periodic solvers, with
//! which it shares only the statement of the laws.

use crate::effects::Branch;
use crate::model::continuum::{Element, held};
use crate::model::relaxations::RELAXATIONS;
use crate::model::system::{Forcing, Linear, SliderSystem};

/// Trials for the force at the end of a step.
const ITERATIONS: usize = 50;
/// Trials that a step may take on average, most take three to five: an integration that needs more of them is given up.
const TRIALS: usize = 12;

/// How long and how finely to integrate.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Steps per cycle of the drive.
    pub steps: usize,
    /// Most cycles before the motion counts as not periodic.
    pub cycles: usize,
    /// Relative change of the fundamental over a cycle below which the motion counts as periodic.
    pub settled: f64,
    /// Cycles over which a motion that is not periodic is averaged, after `cycles`.
    pub window: usize,
    /// Relative accuracy to which the implicit equations of a step are solved.
    pub solved: f64,
}

impl Plan {
    /// For points without a stable periodic state.
    pub const LOCK_IN: Self = Self { steps: 1000, cycles: 200, settled: 1e-7, window: 100, solved: Self::SOLVED };

    /// The same of many parallel sliders, of which a step takes thirty times the work: fewer cycles. Not fewer steps,
    /// of which a third takes a motion that excites itself for a steady one.
    pub const LOCK_IN_OF_SLIDERS: Self = Self { cycles: 60, window: 40, solved: 1e-9, ..Self::LOCK_IN };

    /// Solved to rounding.
    pub const SOLVED: f64 = 1e-12;
}

impl Default for Plan {
    fn default() -> Self {
        Self { steps: 8000, cycles: 400, settled: 1e-8, window: 100, solved: Self::SOLVED }
    }
}

/// What the integration ended with; the fundamental is that of the angle relative to the motion without contact.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// Complex fundamental of the relative angle, of the last cycle or averaged over the window.
    pub fundamental: (f64, f64),
    /// Mean relative angle.
    pub mean: f64,
    /// Share of stuck stiffness over the last cycle.
    pub stick_fraction: f64,
    /// Extremes of the force over the last cycle (over the window).
    pub force: (f64, f64),
    /// Cycles integrated.
    pub cycles: usize,
    /// Relative change of the fundamental over the last cycle.
    pub change: f64,
    /// Whether the motion became periodic, every step of it solved.
    pub periodic: bool,
    /// Whether the steps took so many trials that the integration was given up; then the numbers are of the last cycle.
    pub given_up: bool,
}

impl Outcome {
    /// Whether the motion is none of numbers any more: it stays so for ever.
    fn is_lost(&self) -> bool {
        ![self.fundamental.0, self.fundamental.1, self.mean, self.force.0, self.force.1].iter().all(|x| x.is_finite())
    }
}

/// Integrates until the motion is periodic, or through the averaging window; or until it is none of numbers, or has
/// taken more work than such an integration is worth.
pub fn integrate(system: &dyn SliderSystem, plan: &Plan) -> Outcome {
    let mut state = State::new(system, plan);
    let scale = system.scale().0 / system.lever();
    let mut before = (f64::NAN, f64::NAN);
    let mut calm = 0;
    let mut last = Outcome {
        fundamental: before,
        mean: f64::NAN,
        stick_fraction: f64::NAN,
        force: (f64::NAN, f64::NAN),
        cycles: 0,
        change: f64::NAN,
        periodic: false,
        given_up: false,
    };
    for cycle in 1..=plan.cycles {
        let reading = state.cycle();
        if reading.is_lost() {
            return Outcome { fundamental: (f64::NAN, f64::NAN), cycles: cycle, ..reading };
        }
        let change = (reading.fundamental.0 - before.0).hypot(reading.fundamental.1 - before.1) / scale;
        before = reading.fundamental;
        // Bristles that stick to a turning roller are being wound up: they will slip, however quiet the cycle.
        let winding = reading.stick_fraction > 1.0 - 1e-9 && !system.at_rest() && system.bristles()[2] == 0.0;
        calm = if change < plan.settled && !winding { calm + 1 } else { 0 };
        last = Outcome { cycles: cycle, change, periodic: calm >= 3 && state.solvable, ..reading };
        last.given_up = state.trials > TRIALS * plan.steps * (plan.cycles + plan.window);
        if last.periodic || last.given_up {
            return last;
        }
    }
    average(&mut state, plan, last)
}

/// Lock-in average over the window.
fn average(state: &mut State, plan: &Plan, last: Outcome) -> Outcome {
    let mut sum = Outcome { cycles: last.cycles + plan.window, ..last };
    (sum.fundamental, sum.mean, sum.stick_fraction) = ((0.0, 0.0), 0.0, 0.0);
    let share = 1.0 / plan.window as f64;
    for _ in 0..plan.window {
        let reading = state.cycle();
        if reading.is_lost() {
            return Outcome { fundamental: (f64::NAN, f64::NAN), ..reading };
        }
        sum.fundamental.0 += share * reading.fundamental.0;
        sum.fundamental.1 += share * reading.fundamental.1;
        sum.mean += share * reading.mean;
        sum.stick_fraction += share * reading.stick_fraction;
        sum.force = (sum.force.0.min(reading.force.0), sum.force.1.max(reading.force.1));
    }
    sum
}

/// An oscillator x'' = -stiffness x - damping x' + load by the trapezoidal rule.
#[derive(Clone, Copy)]
struct Oscillator {
    linear: Linear,
    x: f64,
    v: f64,
    a: f64,
}

impl Oscillator {
    /// (x, v) at the end of a step without load at its end, and the denominator by which a load there is divided.
    fn predict(&self, h: f64) -> (f64, f64, f64) {
        let (x, v) = (self.x + h * self.v + 0.25 * h * h * self.a, self.v + 0.5 * h * self.a);
        let inertia = 1.0 + 0.5 * h * self.linear.damping + 0.25 * h * h * self.linear.stiffness;
        let a = -(self.linear.stiffness * x + self.linear.damping * v) / inertia;
        (x + 0.25 * h * h * a, v + 0.5 * h * a, inertia)
    }

    fn advance(&mut self, h: f64, load: f64) {
        let (x, v, inertia) = self.predict(h);
        let a = load / inertia;
        let (x, v) = (x + 0.25 * h * h * a, v + 0.5 * h * a);
        self.a = -self.linear.stiffness * x - self.linear.damping * v + load;
        (self.x, self.v) = (x, v);
    }
}

/// The force at the end of a step, looked for by secants between bounds: more force moves arm and roller so that the
/// bristles pull less, the more so the lighter these are.
struct Root {
    at: f64,
    tried: usize,
    /// The force tried before, and by how much it fell short of what the bristles then pull.
    before: Option<(f64, f64)>,
    low: f64,
    high: f64,
}

impl Root {
    fn new(at: f64) -> Self {
        Self { at, tried: 1, before: None, low: f64::NEG_INFINITY, high: f64::INFINITY }
    }

    /// The next one to try, `short` being by how much the last fell short.
    fn next(&mut self, short: f64) {
        let at = self.at;
        if short > 0.0 {
            self.low = self.low.max(at);
        } else {
            self.high = self.high.min(at);
        }
        let secant = self.before.map(|(x, y)| at - short * (at - x) / (short - y));
        let inside = |x: &f64| *x > self.low && *x < self.high;
        self.at = secant.filter(inside).unwrap_or_else(|| {
            let middle = 0.5 * (self.low + self.high);
            if middle.is_finite() { middle } else { at + short }
        });
        self.before = Some((at, short));
        self.tried += 1;
    }
}

#[derive(Clone, Copy)]
struct Bristle {
    x: f64,
    rate: f64,
    q: [f64; RELAXATIONS],
    q_rate: [f64; RELAXATIONS],
    branch: Branch,
    psi: f64,
    psi_rate: f64,
    slip: f64,
}

// Wide: the equations and the states that a step moves together.
struct State<'a> {
    system: &'a dyn SliderSystem,
    steps: usize,
    solved: f64,
    h: f64,
    arm: Oscillator,
    support: Option<(Oscillator, f64)>,
    heat: f64,
    heat_rate: f64,
    bristles: Vec<Bristle>,
    /// The bristles at the end of the step that is being solved.
    moved: Vec<Bristle>,
    force: f64,
    step: usize,
    /// Whether the equations of every step so far were solved.
    solvable: bool,
    /// Trials that all steps so far took.
    trials: usize,
}

impl<'a> State<'a> {
    fn new(system: &'a dyn SliderSystem, plan: &Plan) -> Self {
        let (shared, psi) = system.start();
        let forcing = system.forcing(0.0);
        let kc = system.bristles()[0];
        let (limit, _) = system.limit(&forcing, shared[0], 0.0, psi, shared[4]);
        let rest = shared[2] - system.lever() * (forcing.angle + shared[0]);
        let bristle = |e: &Element| {
            let most = e.limit * limit / kc;
            let x = if system.at_rest() { held(rest, most) } else { most };
            let slip = if system.at_rest() { 0.0 } else { system.relative_speed(&forcing, 0.0, 0.0).max(0.0) };
            let (q, q_rate) = ([0.0; RELAXATIONS], [0.0; RELAXATIONS]);
            let branch = system.hysteresis(Branch::default(), x).unwrap_or_default().0;
            Bristle { x, rate: 0.0, q, q_rate, branch, psi, psi_rate: 0.0, slip }
        };
        let bristles: Vec<Bristle> = system.elements().iter().map(bristle).collect();
        let force = system.elements().iter().zip(&bristles).map(|(e, s)| e.share * kc * s.x).sum();
        let oscillator = |linear, x, v| Oscillator { linear, x, v, a: 0.0 };
        Self {
            system,
            steps: plan.steps,
            solved: plan.solved,
            h: system.period() / plan.steps as f64,
            arm: oscillator(system.arm(), shared[0], shared[1]),
            support: system.support().map(|(linear, gain)| (oscillator(linear, shared[2], shared[3]), gain)),
            heat: shared[4],
            heat_rate: 0.0,
            moved: bristles.clone(),
            bristles,
            force,
            step: 0,
            solvable: true,
            trials: 0,
        }
    }

    fn cycle(&mut self) -> Outcome {
        let mut out = Outcome {
            fundamental: (0.0, 0.0),
            mean: 0.0,
            stick_fraction: 0.0,
            force: (f64::INFINITY, f64::NEG_INFINITY),
            cycles: 0,
            change: 0.0,
            periodic: false,
            given_up: false,
        };
        let share = 1.0 / self.steps as f64;
        let reference = self.arm.x;
        for _ in 0..self.steps {
            let (forcing, stuck) = self.advance();
            let swing = 2.0 * share * (self.arm.x - reference);
            out.fundamental.0 += swing * forcing.sine;
            out.fundamental.1 += swing * forcing.cosine;
            out.mean += share * self.arm.x;
            out.stick_fraction += share * stuck;
            out.force = (out.force.0.min(self.force), out.force.1.max(self.force));
        }
        out
    }

    /// One step; the forcing at its end and the share of stuck stiffness.
    fn advance(&mut self) -> (Forcing, f64) {
        let (system, h) = (self.system, self.h);
        self.step = self.step % self.steps + 1;
        let forcing = system.forcing(h * self.step as f64);
        let (angle, velocity, inertia) = self.arm.predict(h);
        let (gain, mut torque) = system.arm_load(&forcing, angle, velocity);
        let by_load = 0.5 * h / inertia;
        let support = self.support.map(|(oscillator, gain)| {
            let (_, v, inertia) = oscillator.predict(h);
            (v, 0.5 * h * gain / inertia)
        });
        let heat = self.heat + h * self.heat_rate;
        let mut root = Root::new(self.force);
        self.moved.copy_from_slice(&self.bristles);
        let (force, stuck, power) = loop {
            let force = root.at;
            let support = support.map_or(0.0, |(v, by_force)| v + by_force * force);
            // The load at the end of the step moves the arm by the trapezoidal rule.
            let load = gain * force + torque;
            let (angle, velocity) = (angle + 0.5 * h * by_load * load, velocity + by_load * load);
            torque = system.arm_load(&forcing, angle, velocity).1;
            let v = system.relative_speed(&forcing, velocity, support);
            let (mut sum, mut held, mut work) = (0.0, 0.0, 0.0);
            for ((element, old), new) in system.elements().iter().zip(&self.bristles).zip(&mut self.moved) {
                let f = bristle(system, element, old, new, &forcing, angle, heat, v, h, self.solved);
                sum += element.share * f;
                let slip = if system.rate_viscosity().is_some() { v } else { new.slip };
                work += element.share * f * slip;
                held += if new.slip == 0.0 { element.share } else { 0.0 };
            }
            let change = (sum - force).abs() + (gain * force + torque - load).abs() / gain;
            // Between close bounds the bristles jump, or rounding does.
            let accuracy = self.solved * (force.abs() + system.scale().0 * system.bristles()[0]);
            if change <= accuracy || (root.high - root.low).abs() <= accuracy {
                break (sum, held, work);
            }
            if root.tried >= ITERATIONS {
                self.solvable = false;
                break (sum, held, work);
            }
            root.next(sum - force);
        };
        self.trials += root.tried;
        self.force = force;
        std::mem::swap(&mut self.bristles, &mut self.moved);
        self.arm.advance(h, gain * force + torque);
        if let Some((oscillator, gain)) = &mut self.support {
            oscillator.advance(h, *gain * force);
        }
        let (heating, cooling) = system.heating();
        if heating > 0.0 {
            let heat = (self.heat + 0.5 * h * (self.heat_rate + heating * power)) / (1.0 + 0.5 * h * cooling);
            self.heat_rate = heating * power - cooling * heat;
            self.heat = heat;
        }
        (forcing, stuck)
    }
}

/// Advances one bristle to the relative speed `v` at the end of the step; its force per share.
#[allow(clippy::too_many_arguments)]
fn bristle(
    system: &dyn SliderSystem,
    element: &Element,
    old: &Bristle,
    new: &mut Bristle,
    forcing: &Forcing,
    angle: f64,
    heat: f64,
    v: f64,
    h: f64,
    solved: f64,
) -> f64 {
    let [kc, cc, renewal] = system.bristles();
    let half = 0.5 * h;
    // f = own + slope d + hysteresis, with the stretching rate d at the end of the step.
    let fade = 1.0 / (1.0 + half * renewal);
    let mut own = kc * fade * (old.x + half * old.rate);
    let mut slope = kc * fade * half + cc;
    for ((k1, rate), (q, q_rate)) in system.branches().iter().zip(old.q.iter().zip(&old.q_rate)) {
        let relax = 1.0 / (1.0 + half * rate);
        own += relax * (q + half * q_rate);
        slope += k1 * relax * half;
    }
    let hysteresis = |d: f64| {
        let by = fade * (old.x + half * (old.rate + d)) - old.x;
        system.hysteresis(old.branch, by).unwrap_or_default().0
    };
    let psi_at = |s: f64| match system.interface(s) {
        Some((constant, factor)) => {
            let psi = (old.psi + half * (old.psi_rate + constant)) / (1.0 - half * factor);
            (psi, constant + factor * psi)
        }
        None => (old.psi, 0.0),
    };
    let d = if let Some(viscosity) = system.rate_viscosity() {
        // The slip rate is kc |v| x/(mu N): linear in x at the end of the step.
        let (limit, _) = system.limit(forcing, angle, v.abs(), psi_at(v.abs()).0, heat);
        let flow = kc * v.abs() / limit.max(1e-300);
        let x = (old.x + half * (old.rate + v)) / (1.0 + half * (flow + renewal));
        new.slip = flow * x;
        (new.psi, new.psi_rate) = psi_at(v.abs());
        let d = v - new.slip;
        finish(system, old, new, d, h);
        return kc * new.x + cc * d + new.q.iter().sum::<f64>() + viscosity * v;
    } else {
        let stick = own + slope * v;
        let sign = if stick + hysteresis(v).force < 0.0 { -1.0 } else { 1.0 };
        let excess = |s: f64| {
            let (limit, _) = system.limit(forcing, angle, s, psi_at(s).0, heat);
            sign * (stick + hysteresis(v - sign * s).force) - slope * s - element.limit * limit
        };
        let s = slip_rate(&excess, sign * old.slip, system.scale().1, 0.1 * solved);
        new.slip = sign * s;
        (new.psi, new.psi_rate) = psi_at(s);
        v - new.slip
    };
    finish(system, old, new, d, h);
    new.branch = hysteresis(d);
    own + slope * d + new.branch.force
}

fn finish(system: &dyn SliderSystem, old: &Bristle, new: &mut Bristle, d: f64, h: f64) {
    let [.., renewal] = system.bristles();
    let half = 0.5 * h;
    new.x = (old.x + half * (old.rate + d)) / (1.0 + half * renewal);
    new.rate = d - renewal * new.x;
    for (i, (k1, rate)) in system.branches().iter().enumerate() {
        new.q[i] = (old.q[i] + half * (old.q_rate[i] + k1 * d)) / (1.0 + half * rate);
        new.q_rate[i] = k1 * d - rate * new.q[i];
    }
}

/// Slip rate s >= 0 at which the excess of pull over friction vanishes, on the branch of the last one; 0 for stick.
fn slip_rate(excess: &dyn Fn(f64) -> f64, last: f64, scale: f64, solved: f64) -> f64 {
    let (mut low, mut high);
    if last > 0.0 && excess(last) > 0.0 {
        (low, high) = (last, 1.01 * last);
        while excess(high) > 0.0 && high < 1e9 * scale {
            (low, high) = (high, high + 2.0 * (high - low));
        }
    } else if last > 0.0 {
        (low, high) = (0.99 * last, last);
        while excess(low) <= 0.0 {
            if low < 1e-12 * scale || low == 0.0 {
                return if excess(0.0) > 0.0 { low } else { 0.0 };
            }
            (low, high) = (0.5 * low, low);
        }
    } else {
        if excess(0.0) <= 0.0 {
            return 0.0;
        }
        (low, high) = (0.0, 1e-9 * scale);
        while excess(high) > 0.0 && high < 1e9 * scale {
            (low, high) = (high, 2.0 * high);
        }
    }
    // Regula falsi with the Illinois weight.
    let (mut at_low, mut at_high) = (excess(low), excess(high));
    for _ in 0..100 {
        let middle = (low * at_high - high * at_low) / (at_high - at_low);
        let value = excess(middle);
        if value > 0.0 {
            (low, at_low) = (middle, value);
            at_high *= 0.5;
        } else {
            (high, at_high) = (middle, value);
            at_low *= 0.5;
        }
        if value == 0.0 || (high - low) <= solved * high {
            return middle;
        }
    }
    0.5 * (low + high)
}
