//! The published explicit Euler procedure (paper Eqs. 17-18), kept as published to reproduce its numbers.

use super::{Method, Orbit, Status, SteadyState};
use std::f64::consts::TAU;

/// Coefficients of the published equations at one operating point, SI.
#[derive(Debug, Clone, Copy)]
pub struct PaperContact {
    /// w \[rad/s\].
    pub omega: f64,
    /// J \[kg m^2\].
    pub inertia: f64,
    /// C \[N m s/rad\].
    pub damping: f64,
    /// K \[N m/rad\].
    pub stiffness: f64,
    /// Drive torque, in phase with the actuator and a quarter period ahead \[N m\].
    pub torque: (f64, f64),
    /// b \[m\].
    pub arm: f64,
    /// kc \[N/m\].
    pub contact_stiffness: f64,
    /// cc \[N s/m\].
    pub contact_damping: f64,
    /// mu W \[N\].
    pub friction_force: f64,
    /// V \[m/s\].
    pub speed: f64,
}

/// Relative change of the fundamental over a cycle below which the transient counts as dead.
const SETTLED: f64 = 1e-10;
/// Most cycles integrated.
const MAX_CYCLES: usize = 20_000;

/// Integrates with `steps` Euler steps a cycle until the fundamental is steady, or says that it is not.
pub fn solve(c: &PaperContact, steps: usize, keep_orbit: bool) -> (SteadyState, Orbit) {
    let period = TAU / c.omega;
    let dt = period / steps as f64;
    let (sine, cosine): (Vec<f64>, Vec<f64>) = (0..steps).map(|i| (c.omega * dt * i as f64).sin_cos()).unzip();
    // Full slip is the start: a roller at creeping speed would need minutes to load the bristles.
    let sliding = if c.speed > 0.0 { c.friction_force } else { 0.0 };
    let (mut th, mut w, mut force) = (c.arm * sliding / c.stiffness, 0.0f64, sliding);
    let mut before = (0.0f64, 0.0f64);
    let mut orbit = Orbit::default();
    let mut calm = 0;
    for cycle in 1..=MAX_CYCLES {
        let last = calm >= 2 || cycle == MAX_CYCLES;
        let (mut re, mut im, mut mean) = (0.0, 0.0, 0.0);
        let (mut low, mut high, mut stuck) = (f64::INFINITY, f64::NEG_INFINITY, 0usize);
        let start = th;
        for i in 0..steps {
            re += th * sine[i];
            im += th * cosine[i];
            mean += th;
            if last && keep_orbit {
                orbit.time.push(dt * i as f64);
                orbit.angle.push(th);
                orbit.velocity.push(w);
                orbit.force.push(force);
            }
            let torque = c.torque.0 * sine[i] + c.torque.1 * cosine[i];
            let acceleration = (torque + c.arm * force - c.damping * w - c.stiffness * th) / c.inertia;
            let speed = c.speed - c.arm * w;
            let trial = force + (c.contact_stiffness * speed - c.contact_damping * c.arm * acceleration) * dt;
            let sticks = trial.abs() < c.friction_force;
            stuck += usize::from(sticks);
            th += w * dt;
            w += acceleration * dt;
            force = if sticks { trial } else { c.friction_force.copysign(speed) };
            (low, high) = (low.min(force), high.max(force));
        }
        let scale = 2.0 / steps as f64;
        (re, im) = (re * scale, im * scale);
        let amplitude = re.hypot(im);
        let change = (re - before.0).hypot(im - before.1) / amplitude;
        before = (re, im);
        calm = if change < SETTLED { calm + 1 } else { 0 };
        if last {
            let status = if !amplitude.is_finite() {
                Status::Failed(format!("the Euler procedure diverges with {steps} steps a cycle; take more"))
            } else if cycle == MAX_CYCLES {
                Status::SelfExcited(format!("not periodic after {MAX_CYCLES} cycles; the last one is averaged"))
            } else {
                Status::Steady
            };
            let state = SteadyState {
                amplitude,
                phase: im.atan2(re),
                mean: mean / steps as f64,
                speed_amplitude: c.arm * c.omega * amplitude,
                stick_fraction: stuck as f64 / steps as f64,
                force_minimum: low,
                force_maximum: high,
                cycles: cycle,
                periodicity_error: (th - start).abs() / amplitude,
                status,
                method: Method::PaperEuler,
            };
            return (state, orbit);
        }
        if !amplitude.is_finite() {
            calm = 2;
        }
    }
    unreachable!("the last cycle returns")
}
