//! The rig integrated in time with a departure from the base: trapezoidal rule with fixed steps, Newton's method for
//! the rate at which the bristles stretch. Written for this purpose alone; it knows no effect of the catalogue.

use super::Departure;
use crate::model::{Model, Operation};
use crate::solver::Integrated;
use crate::solver::time::Plan;
use std::f64::consts::{PI, TAU};

/// Cycles after which the motion that follows a slowly changing load has forgotten its start.
const SETTLING: usize = 40;
/// Iterations of one step.
const ITERATIONS: usize = 40;

/// What the instrument shows at an operating point with load.
pub fn reading(model: &Model, departure: &Departure, at: &Operation, plan: &Plan) -> Integrated {
    let mut rig = Rig::new(model, departure, at, plan.steps);
    let changing = departure.run_out.is_some_and(|r| r.share > 0.0) && at.speed > 0.0 && at.load > 0.0;
    let scale = rig.free.0.hypot(rig.free.1);
    let (mut last, mut calm, mut periodic) = (([0.0; 2], 0.0), 0, false);
    for _ in 0..if changing { SETTLING } else { plan.cycles } {
        let (fundamental, mean, stuck) = rig.cycle();
        let change = (fundamental[0] - last.0[0]).hypot(fundamental[1] - last.0[1]) / scale;
        last = (fundamental, mean);
        // Bristles that stick to a turning roller are being wound up: they will slip.
        let winding = stuck == plan.steps && at.speed > 0.0 && at.load > 0.0;
        calm = if change < plan.settled && !winding { calm + 1 } else { 0 };
        if calm >= 3 && !changing {
            periodic = true;
            break;
        }
    }
    if !periodic {
        // Lock-in average over the window.
        let share = 1.0 / plan.window as f64;
        last = ([0.0; 2], 0.0);
        for _ in 0..plan.window {
            let (fundamental, mean, _) = rig.cycle();
            last = ([0, 1].map(|i| last.0[i] + share * fundamental[i]), last.1 + share * mean);
        }
    }
    let (re, im) = (rig.free.0 + last.0[0], rig.free.1 + last.0[1]);
    let phase = im.atan2(re) + model.instrument.phase_offset;
    Integrated {
        amplitude: re.hypot(im) * model.instrument.amplitude_gain,
        phase: phase - TAU * ((phase + PI) / TAU).floor(),
        mean: last.1,
        periodic: periodic || changing,
    }
}

// Wide: symbols and states of equations that share nothing with the solvers which they check.
struct Rig<'a> {
    departure: &'a Departure,
    steps: usize,
    h: f64,
    omega: f64,
    speed: f64,
    limit: f64,
    drive: f64,
    spring: f64,
    spring_arm: f64,
    arm: f64,
    inertia: f64,
    /// Stiffness and damping of the arm over its inertia.
    k: f64,
    c: f64,
    kc: f64,
    cc: f64,
    /// Motion without contact and without departure, complex.
    free: (f64, f64),
    time: f64,
    /// Angle, velocity and acceleration of the arm relative to that motion.
    z: f64,
    w: f64,
    a: f64,
    /// Stretch of the bristles and its rate.
    x: f64,
    d: f64,
}

impl<'a> Rig<'a> {
    fn new(model: &Model, departure: &'a Departure, at: &Operation, steps: usize) -> Self {
        let (r, omega) = (model.rig.arm(), TAU * at.frequency);
        let k = r.torsional_stiffness + 2.0 * r.spring_arm.powi(2) * r.spring_stiffness;
        let c = r.torsional_damping + 2.0 * r.spring_arm.powi(2) * r.spring_damping;
        let drive = at.drive * model.instrument.drive_gain;
        let (re, im) = (k - r.inertia * omega * omega, c * omega);
        let (p, q) = (r.spring_arm * drive * r.spring_stiffness, r.spring_arm * drive * r.spring_damping * omega);
        let square = re * re + im * im;
        let free = ((p * re + q * im) / square, (q * re - p * im) / square);
        let mut rig = Self {
            departure,
            steps,
            h: TAU / omega / steps as f64,
            omega,
            speed: at.speed,
            limit: model.contact.friction * at.load,
            drive,
            spring: r.spring_stiffness,
            spring_arm: r.spring_arm,
            arm: if at.load > 0.0 { r.contact_arm } else { 0.0 },
            inertia: r.inertia,
            k: k / r.inertia,
            c: c / r.inertia,
            kc: model.contact.stiffness,
            cc: model.contact.damping,
            free,
            time: 0.0,
            z: 0.0,
            w: 0.0,
            a: 0.0,
            x: 0.0,
            d: 0.0,
        };
        let limit = rig.limit_at(0.0);
        let most = rig.stretch(limit);
        if at.speed > 0.0 {
            (rig.x, rig.z) = (most, rig.arm * limit / k);
        } else {
            rig.x = (-rig.arm * free.1).clamp(-most, most);
        }
        rig
    }

    fn limit_at(&self, time: f64) -> f64 {
        let change = self.departure.run_out.map_or(0.0, |r| r.share * (r.phase + self.speed * time / r.radius).sin());
        self.limit * (1.0 + change)
    }

    /// Stretch at which the springs carry a force.
    fn stretch(&self, force: f64) -> f64 {
        let mut x = 0.0;
        for _ in 0..200 {
            let excess = self.kc * x + self.departure.cubic * x * x * x - force;
            x -= excess / (self.kc + 3.0 * self.departure.cubic * x * x);
        }
        x
    }

    /// Torque of the pinching springs that the gap takes away.
    fn lost_torque(&self, angle: f64, sine: f64) -> f64 {
        let half = 0.5 * self.departure.gap;
        if half == 0.0 {
            return 0.0;
        }
        let (a, k) = (self.spring_arm, self.spring);
        let lost = |stretch: f64| k * stretch.clamp(-half, half);
        // Driven side and fixed side.
        a * lost(a * angle - self.drive * sine) + a * lost(a * angle)
    }

    /// Force of the contact at the end of the step, and its slope, at the stretching rate `d` there.
    fn force(&self, d: f64) -> (f64, f64) {
        let half = 0.5 * self.h;
        let x = self.x + half * (self.d + d);
        let cubic = self.departure.cubic;
        let force = (self.kc + cubic * x * x) * x + self.cc * d;
        (force, (self.kc + 3.0 * cubic * x * x) * half + self.cc)
    }

    /// Root of an increasing function given with its slope.
    fn root(start: f64, scale: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
        let mut d = start;
        for _ in 0..ITERATIONS {
            let (value, slope) = f(d);
            let step = value / slope;
            d -= step;
            if step.abs() <= 1e-13 * (scale + d.abs()) {
                break;
            }
        }
        d
    }

    /// One step; whether the contact sticks at its end.
    fn advance(&mut self, number: usize) -> bool {
        let h = self.h;
        let turn = self.omega * h * number as f64;
        let (sine, cosine) = turn.sin_cos();
        self.time += h;
        let (z, w) = (self.z + h * self.w + 0.25 * h * h * self.a, self.w + 0.5 * h * self.a);
        let inertia = 1.0 + 0.5 * h * self.c + 0.25 * h * h * self.k;
        let own = -(self.k * z + self.c * w) / inertia;
        let per_torque = 1.0 / (inertia * self.inertia);
        let free = self.free.0 * sine + self.free.1 * cosine;
        let free_velocity = self.omega * (self.free.0 * cosine - self.free.1 * sine);
        let limit = self.limit_at(self.time);
        let scale = self.speed + self.arm * self.omega * self.free.0.hypot(self.free.1);
        let (mut torque, mut force, mut d, mut sticks, mut a) = (0.0, 0.0, self.d, false, 0.0);
        for _ in 0..ITERATIONS {
            if self.arm > 0.0 {
                let gain = self.arm * 0.5 * h * per_torque;
                let open = self.speed - self.arm * (free_velocity + w + 0.5 * h * own) - gain * torque;
                let stick = |d: f64| {
                    let (force, slope) = self.force(d);
                    (d - open + gain * self.arm * force, 1.0 + gain * self.arm * slope)
                };
                d = Self::root(self.d, scale, stick);
                force = self.force(d).0;
                sticks = force.abs() <= limit;
                if !sticks {
                    let held = limit.copysign(force);
                    d = Self::root(self.d, scale, |d| (self.force(d).0 - held, self.force(d).1));
                    force = held;
                }
            }
            a = own + per_torque * (self.arm * force + torque);
            let before = torque;
            torque = self.lost_torque(free + z + 0.25 * h * h * a, sine);
            if (torque - before).abs() <= 1e-12 * self.spring_arm * self.spring * self.drive {
                break;
            }
        }
        (self.z, self.w, self.a) = (z + 0.25 * h * h * a, w + 0.5 * h * a, a);
        if self.arm > 0.0 {
            self.x += 0.5 * h * (self.d + d);
            self.d = d;
        }
        sticks
    }

    /// One cycle of the drive: complex fundamental and mean of the relative angle, and the number of steps stuck.
    fn cycle(&mut self) -> ([f64; 2], f64, usize) {
        let (share, reference) = (1.0 / self.steps as f64, self.z);
        let (mut fundamental, mut mean, mut stuck) = ([0.0; 2], 0.0, 0);
        for number in 1..=self.steps {
            stuck += usize::from(self.advance(number));
            let (sine, cosine) = (self.omega * self.h * number as f64).sin_cos();
            let swing = 2.0 * share * (self.z - reference);
            fundamental = [fundamental[0] + swing * sine, fundamental[1] + swing * cosine];
            mean += share * self.z;
        }
        (fundamental, mean, stuck)
    }
}
