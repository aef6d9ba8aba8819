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

/// Points integrated in lockstep: a step of one waits for the last, those of several do not wait for each other.
pub const LANES: usize = 8;

/// Sums over a cycle.
#[derive(Clone, Copy)]
struct Sums {
    re: f64,
    im: f64,
    mean: f64,
    force: (f64, f64),
    stuck: usize,
}

/// Integrates up to [`LANES`] points with `steps` Euler steps a cycle each, until the fundamental of each is steady or
/// it is said that it is not. What becomes of one does not depend on the others. Calls back with (angle, velocity,
/// force) of the first at every step of its last cycle.
pub fn solve(contacts: &[PaperContact], steps: usize, keep: impl FnMut(f64, f64, f64)) -> Vec<SteadyState> {
    assert!(contacts.len() <= LANES, "more points than lanes");
    match contacts.len() {
        0 => Vec::new(),
        1 => lockstep::<1>(contacts, steps, keep),
        2..=4 => lockstep::<4>(contacts, steps, keep),
        _ => lockstep::<LANES>(contacts, steps, keep),
    }
}

// Long: the lanes and their coefficients stay in registers all through the steps, which take nearly all the time.
fn lockstep<const L: usize>(
    contacts: &[PaperContact],
    steps: usize,
    mut keep: impl FnMut(f64, f64, f64),
) -> Vec<SteadyState> {
    let count = contacts.len().min(L);
    let lane = |l: usize| contacts[l.min(count - 1)];
    let of = |f: &dyn Fn(&PaperContact) -> f64| -> [f64; L] { std::array::from_fn(|l| f(&lane(l))) };
    let dt = of(&|c| TAU / c.omega / steps as f64);
    let turn: Vec<(f64, f64)> = (0..steps).map(|i| (TAU * i as f64 / steps as f64).sin_cos()).collect();
    // Accelerations per torque in phase and ahead, per force, velocity and angle; rates of force per speed and
    // acceleration.
    let (ahead, behind) = (of(&|c| c.torque.0 / c.inertia), of(&|c| c.torque.1 / c.inertia));
    let (by_force, by_velocity) = (of(&|c| c.arm / c.inertia), of(&|c| c.damping / c.inertia));
    let by_angle = of(&|c| c.stiffness / c.inertia);
    let (stiffness, damping) = (of(&|c| c.contact_stiffness), of(&|c| c.contact_damping * c.arm));
    let (limit, speed, arm) = (of(&|c| c.friction_force), of(&|c| c.speed), of(&|c| c.arm));
    // Full slip is the start: a roller at creeping speed would need minutes to load the bristles.
    let mut force = of(&|c| if c.speed > 0.0 { c.friction_force } else { 0.0 });
    let mut th = of(&|c| if c.speed > 0.0 { c.arm * c.friction_force / c.stiffness } else { 0.0 });
    let mut w = [0.0f64; L];
    // One step of all; whether each sticks.
    let step = |th: &mut [f64; L], w: &mut [f64; L], force: &mut [f64; L], (sine, cosine): (f64, f64)| -> [bool; L] {
        let mut sticks = [false; L];
        for l in 0..L {
            let acceleration = ahead[l] * sine + behind[l] * cosine + by_force[l] * force[l]
                - by_velocity[l] * w[l]
                - by_angle[l] * th[l];
            let relative = speed[l] - arm[l] * w[l];
            let trial = force[l] + (stiffness[l] * relative - damping[l] * acceleration) * dt[l];
            sticks[l] = trial.abs() < limit[l];
            th[l] += w[l] * dt[l];
            w[l] += acceleration * dt[l];
            force[l] = if sticks[l] { trial } else { limit[l].copysign(relative) };
        }
        sticks
    };
    let mut before = [(0.0f64, 0.0f64); L];
    let mut calm = [0; L];
    let mut states: Vec<Option<SteadyState>> = vec![None; count];
    for cycle in 1..=MAX_CYCLES {
        let last: [bool; L] = std::array::from_fn(|l| calm[l] >= 2 || cycle == MAX_CYCLES);
        let kept = last[0] && states[0].is_none();
        let nothing = Sums { re: 0.0, im: 0.0, mean: 0.0, force: (f64::INFINITY, f64::NEG_INFINITY), stuck: 0 };
        let mut sums = [nothing; L];
        let (mut re, mut im) = ([0.0; L], [0.0; L]);
        let start = th;
        // Only in a last cycle more than the fundamental is asked for: without branches the lanes go side by side.
        if (0..count).any(|l| last[l] && states[l].is_none()) {
            for &turn in &turn {
                if kept {
                    keep(th[0], w[0], force[0]);
                }
                let at = th;
                let sticks = step(&mut th, &mut w, &mut force, turn);
                for l in 0..L {
                    re[l] += at[l] * turn.0;
                    im[l] += at[l] * turn.1;
                    sums[l].mean += at[l];
                    sums[l].stuck += usize::from(sticks[l]);
                    sums[l].force = (sums[l].force.0.min(force[l]), sums[l].force.1.max(force[l]));
                }
            }
        } else {
            for &turn in &turn {
                for l in 0..L {
                    re[l] += th[l] * turn.0;
                    im[l] += th[l] * turn.1;
                }
                step(&mut th, &mut w, &mut force, turn);
            }
        }
        for l in 0..count {
            if states[l].is_some() {
                continue;
            }
            let scale = 2.0 / steps as f64;
            sums[l] = Sums { re: re[l] * scale, im: im[l] * scale, mean: sums[l].mean / steps as f64, ..sums[l] };
            let amplitude = sums[l].re.hypot(sums[l].im);
            let change = (sums[l].re - before[l].0).hypot(sums[l].im - before[l].1) / amplitude;
            before[l] = (sums[l].re, sums[l].im);
            calm[l] = if change < SETTLED { calm[l] + 1 } else { 0 };
            if last[l] {
                let left = (th[l] - start[l]).abs() / amplitude;
                states[l] = Some(state(&contacts[l], &sums[l], steps, cycle, left));
            }
            if !amplitude.is_finite() {
                calm[l] = 2;
            }
        }
        if states.iter().all(Option::is_some) {
            break;
        }
    }
    states.into_iter().flatten().collect()
}

/// One point, with its last cycle.
pub fn orbit(contact: &PaperContact, steps: usize) -> Orbit {
    let dt = TAU / contact.omega / steps as f64;
    let mut orbit = Orbit::default();
    solve(std::slice::from_ref(contact), steps, |angle, velocity, force| {
        orbit.time.push(dt * orbit.time.len() as f64);
        orbit.angle.push(angle);
        orbit.velocity.push(velocity);
        orbit.force.push(force);
    });
    orbit
}

fn state(contact: &PaperContact, sums: &Sums, steps: usize, cycle: usize, left: f64) -> SteadyState {
    let amplitude = sums.re.hypot(sums.im);
    let status = if !amplitude.is_finite() {
        Status::Failed(format!("the Euler procedure diverges with {steps} steps a cycle; take more"))
    } else if cycle == MAX_CYCLES {
        Status::SelfExcited(format!("not periodic after {MAX_CYCLES} cycles; the last one is averaged"))
    } else {
        Status::Steady
    };
    SteadyState {
        amplitude,
        phase: sums.im.atan2(sums.re),
        mean: sums.mean,
        speed_amplitude: contact.arm * contact.omega * amplitude,
        stick_fraction: sums.stuck as f64 / steps as f64,
        force_minimum: sums.force.0,
        force_maximum: sums.force.1,
        cycles: cycle,
        periodicity_error: left,
        status,
        method: Method::PaperEuler,
    }
}
