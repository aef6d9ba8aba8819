//! One cycle of a contact of many parallel sliders: fixed Radau steps, each slider solved at the stages for itself.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::collocation::{A, C, interpolate};
use super::stages::{Block, Pair, Stages, chained, inverse, product, relaxation};
use crate::effects::Branch;
use crate::model::relaxations::RELAXATIONS;
use crate::model::system::{Forcing, SliderSystem};
use nalgebra::DMatrix;

/// Number of shared states: angle, velocity, support, its velocity, heating; the two numbers of a hysteresis, which one
/// slider has; and the stretch of a slider by itself.
pub const SHARED: usize = 8;
/// The shared states.
pub type Shared = [f64; SHARED];
/// Where the hysteresis stands among them.
const HYSTERESIS: [usize; 2] = [5, 6];
/// The stretch, which a roller at rest leaves to the slider.
pub const STRETCH: usize = 7;

/// The hysteresis among the shared states.
fn hysteresis_of(shared: &Shared) -> Branch {
    let [force, reach] = HYSTERESIS.map(|i| shared[i]);
    Branch { force, reach }
}

/// Sets the hysteresis among the shared states.
pub fn with_hysteresis(shared: &mut Shared, branch: Branch) {
    [shared[HYSTERESIS[0]], shared[HYSTERESIS[1]]] = [branch.force, branch.reach];
}

/// States of a slider.
#[derive(Debug, Clone, Copy)]
pub struct Slider {
    /// Stretch \[m\].
    pub x: f64,
    /// Rate of stretch at the end of the last step \[m/s\].
    rate: f64,
    /// Forces of its branches \[N\].
    q: [f64; RELAXATIONS],
    /// State of its interface.
    pub psi: f64,
}

impl Slider {
    /// At rest.
    pub fn new(x: f64, psi: f64) -> Self {
        Self { x, rate: 0.0, q: [0.0; RELAXATIONS], psi }
    }

    /// With stretch and forces that many times as large.
    pub fn times(&self, stretch: f64, force: f64) -> Self {
        Self { x: self.x * stretch, rate: self.rate * stretch, q: self.q.map(|q| q * force), psi: self.psi }
    }
}

/// What a cycle leaves behind.
pub struct Cycle {
    /// Shared states at the end.
    pub shared: Shared,
    /// The sliders at the end.
    pub sliders: Vec<Slider>,
    /// Which of them slipped.
    pub slipped: Vec<bool>,
    /// Complex fundamental of the relative angle.
    pub fundamental: (f64, f64),
    /// Mean of the relative angle.
    pub mean: f64,
    /// Mean share of stuck stiffness.
    pub stick: f64,
    /// Extremes of the force.
    pub force: (f64, f64),
}

/// Stage coefficients of the fixed step.
// Wide: coefficients that are computed once and read in every step.
pub struct Method<'a> {
    system: &'a dyn SliderSystem,
    /// Steps per period.
    steps: usize,
    h: f64,
    arm: Pair,
    support: Option<(Pair, f64)>,
    /// Acceleration of the arm by the force, and relative speeds at the stages by the forces there.
    gain: f64,
    by_force: Block,
    stretch: (Stages, Block),
    /// Of every branch: its stiffness, its force at the stages by that at the start and by the rates.
    branches: Vec<(f64, Stages, Block)>,
    stiffness: Block,
    /// Where friction does not depend on the slip rate: what a slider does with each set of its stages slipping.
    slipping: Option<[Slipping; 8]>,
    has_interface: bool,
    is_hysteretic: bool,
    is_rate_independent: bool,
    /// Forcing at the stages of every step.
    forcing: Vec<[Forcing; 3]>,
}

/// The force of the bristles about a motion over the stages: its value there, and own + stiffness times the rates near
/// it.
struct Tangent {
    force: Stages,
    own: Stages,
    stiffness: Block,
}

/// A slider with some of its stages slipping (the bits of its index) at a force that does not depend on the slip rate.
struct Slipping {
    /// Rates of stretch by the relative speeds (stuck stages) and by the forces less those at no rate (slipping ones).
    rate: Block,
    /// Forces by the relative speeds.
    slope: Block,
}

impl Slipping {
    fn new(stiffness: &Block, stages: usize) -> Self {
        let slips = |i: usize| stages >> i & 1 == 1;
        let unit = |i: usize, k: usize| f64::from(u8::from(i == k));
        let row = |i: usize| if slips(i) { stiffness[i] } else { std::array::from_fn(|k| unit(i, k)) };
        let rate = inverse(&std::array::from_fn(row));
        let mut slope = chained(stiffness, &rate);
        (0..3).filter(|&k| slips(k)).for_each(|k| slope.iter_mut().for_each(|row| row[k] = 0.0));
        Self { rate, slope }
    }
}

impl<'a> Method<'a> {
    /// With so many steps per period.
    pub fn new(system: &'a dyn SliderSystem, steps: usize) -> Self {
        let h = system.period() / steps as f64;
        let [kc, cc, renewal] = system.bristles();
        let stretch = relaxation(h, renewal);
        let branch = |&(k, rate): &(f64, f64)| {
            let (start, by_rate) = relaxation(h, rate);
            (k, start, by_rate)
        };
        let branches: Vec<_> = system.branches().iter().map(branch).collect();
        let mut stiffness = [[0.0; 3]; 3];
        for i in 0..3 {
            for k in 0..3 {
                let relaxing: f64 = branches.iter().map(|(k1, _, by_rate)| k1 * by_rate[i][k]).sum();
                stiffness[i][k] = kc * stretch.1[i][k] + relaxing;
            }
            stiffness[i][i] += cc;
        }
        let support = system.support().map(|(linear, gain)| (Pair::new(h, linear), gain));
        let is_hysteretic = system.hysteresis(Branch::default(), 0.0).is_some();
        let is_rate_independent = system.rate_independent();
        let slipping = (is_rate_independent && !is_hysteretic)
            .then(|| std::array::from_fn(|stages| Slipping::new(&stiffness, stages)));
        let has_interface = system.interface(0.0).is_some();
        let arm = Pair::new(h, system.arm());
        let start = Forcing::default();
        let gain = system.arm_load(&start, 0.0, 0.0).0;
        let lever = system.relative_speed(&start, 1.0, 0.0) - system.relative_speed(&start, 0.0, 0.0);
        let mut by_force = arm.force[1].map(|row| row.map(|by| lever * gain * by));
        if let Some((pair, gain)) = &support {
            let rows = by_force.iter_mut().zip(&pair.force[1]);
            rows.for_each(|(row, own)| row.iter_mut().zip(own).for_each(|(by, own)| *by += gain * own));
        }
        let forcing = (0..steps).map(|step| C.map(|c| system.forcing(h * (step as f64 + c)))).collect();
        Self {
            system,
            steps,
            h,
            arm,
            support,
            gain,
            by_force,
            stretch,
            branches,
            stiffness,
            slipping,
            has_interface,
            is_hysteretic,
            is_rate_independent,
            forcing,
        }
    }

    /// The shared states that there are.
    pub fn active(&self) -> Vec<usize> {
        let mut active = vec![0, 1];
        if self.support.is_some() {
            active.extend([2, 3]);
        }
        if self.system.heating().0 > 0.0 {
            active.push(4);
        }
        if self.is_hysteretic {
            active.extend(HYSTERESIS);
        }
        active.extend(self.follows_stretch().then_some(STRETCH));
        active
    }

    /// Whether the stretch of the one slider, over a turning roller, is among the shared states.
    fn follows_stretch(&self) -> bool {
        !self.system.at_rest() && self.system.elements().len() == 1
    }

    /// Derivatives of the shared states at the end of a cycle by those at its start, in units of the scales, by
    /// differences.
    pub fn jacobian(
        &self,
        shared: &Shared,
        sliders: &[Slider],
        base: &Cycle,
        scales: &Shared,
        active: &[usize],
    ) -> Result<DMatrix<f64>, String> {
        let n = active.len();
        let mut out = DMatrix::zeros(n, n);
        for (column, &j) in active.iter().enumerate() {
            let mut moved = *shared;
            moved[j] += 1e-6 * scales[j];
            let cycle = self.cycle(&moved, sliders)?;
            for (row, &i) in active.iter().enumerate() {
                out[(row, column)] = (cycle.shared[i] - base.shared[i]) / (1e-6 * scales[i]);
            }
        }
        Ok(out)
    }

    /// One cycle from these states.
    pub fn cycle(&self, shared: &Shared, sliders: &[Slider]) -> Result<Cycle, String> {
        let system = self.system;
        let mut out = Cycle {
            shared: *shared,
            sliders: sliders.to_vec(),
            slipped: vec![false; sliders.len()],
            fundamental: (0.0, 0.0),
            mean: 0.0,
            stick: 0.0,
            force: (f64::INFINITY, f64::NEG_INFINITY),
        };
        if self.follows_stretch() {
            out.sliders[0].x = shared[STRETCH];
        }
        let kc = system.bristles()[0];
        let of = |s: &Slider| kc * s.x + s.q.iter().sum::<f64>();
        let held: f64 = system.elements().iter().zip(&out.sliders).map(|(e, s)| e.share * of(s)).sum();
        let mut force: Stages = [held + hysteresis_of(shared).force; 3];
        let mut before: Option<(f64, Stages)> = None;
        for step in 0..self.steps {
            // The first guess continues the polynomial of the last step.
            let start = force[2];
            if let Some((start, stages)) = before {
                force = C.map(|c| interpolate(start, stages, 1.0 + c));
            }
            let stages = self.step(step, force, &mut out, shared[0])?;
            before = Some((start, stages));
            force = stages;
        }
        Ok(out)
    }

    /// One step; returns the stage forces.
    fn step(&self, step: usize, guess: Stages, cycle: &mut Cycle, reference: f64) -> Result<Stages, String> {
        let system = self.system;
        let [angle, velocity, support, support_velocity, heat, ..] = cycle.shared;
        let forcing = self.forcing[step];
        let (stroke, speed) = system.scale();
        let tolerance = 1e-10 * system.bristles()[0] * stroke;
        let mut force = guess;
        let mut torque = [0.0; 3];
        let mut heats = [heat; 3];
        let mut rates: Vec<Stages> = vec![[0.0; 3]; cycle.sliders.len()];
        for round in 0..60 {
            let load: Stages = std::array::from_fn(|i| self.gain * force[i] + torque[i]);
            let angles = self.arm.states(0, angle, velocity, &load);
            let velocities = self.arm.states(1, angle, velocity, &load);
            for i in 0..3 {
                torque[i] = system.arm_load(&forcing[i], angles[i], velocities[i]).1;
            }
            let mut supports = ([0.0; 3], [0.0; 3]);
            if let Some((pair, gain)) = &self.support {
                let load = force.map(|f| gain * f);
                let states = |which: usize| pair.states(which, support, support_velocity, &load);
                supports = (states(0), states(1));
            }
            let v: Stages = std::array::from_fn(|i| system.relative_speed(&forcing[i], velocities[i], supports.1[i]));
            // All sliders at these speeds.
            let limit = |i: usize, s: f64, psi: f64| system.limit(&forcing[i], angles[i], s, psi, heats[i]);
            let (sum, slope, power) = self.all_sliders(cycle, (&v, speed), &limit, &mut rates);
            let (heating, cooling) = system.heating();
            if heating > 0.0 {
                let (start, by_rate) = relaxation(self.h, cooling);
                heats = std::array::from_fn(|i| {
                    start[i] * heat + heating * (0..3).map(|k| by_rate[i][k] * power[k]).sum::<f64>()
                });
            }
            // (1 - dF/dv dv/dF) delta = F(v) - F
            let loop_gain = chained(&slope, &self.by_force);
            let matrix: Block =
                std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k)) - loop_gain[i][k]));
            let delta = product(&inverse(&matrix), &std::array::from_fn(|i| sum[i] - force[i]));
            let size = delta.iter().fold(0.0f64, |m, d| m.max(d.abs()));
            if !size.is_finite() {
                return Err("the forces of the parallel sliders diverge".into());
            }
            for i in 0..3 {
                force[i] += delta[i];
            }
            if size < tolerance || (round > 30 && size < 1e4 * tolerance) {
                self.accept(cycle, &forcing, &v, &rates, &angles, &force, reference);
                let ends = [angles[2], velocities[2], supports.0[2], supports.1[2], heats[2]];
                cycle.shared[..ends.len()].copy_from_slice(&ends);
                return Ok(force);
            }
        }
        Err(format!("the parallel sliders did not converge at {:.4} of the cycle", step as f64 / self.steps as f64))
    }

    /// All sliders at these relative speeds: the force, its slopes by the speeds, and the power of friction. `speed` is
    /// their scale, `limit` that of the whole contact at a stage by slip rate and state of the interface.
    #[inline(always)]
    fn all_sliders(
        &self,
        cycle: &Cycle,
        (v, speed): (&Stages, f64),
        limit: &impl Fn(usize, f64, f64) -> (f64, f64),
        rates: &mut [Stages],
    ) -> (Stages, Block, Stages) {
        let branch = hysteresis_of(&cycle.shared);
        let (mut sum, mut slope, mut power) = ([0.0; 3], [[0.0; 3]; 3], [0.0; 3]);
        let most: Stages = std::array::from_fn(|i| limit(i, 0.0, 0.0).0);
        for (j, element) in self.system.elements().iter().enumerate() {
            let solved = if let Some(slipping) = &self.slipping {
                self.steady_slider(slipping, &cycle.sliders[j], v, &most.map(|most| element.limit * most), speed)
            } else {
                let limit = |i: usize, s: f64, psi: f64| {
                    if self.is_rate_independent {
                        return (element.limit * most[i], 0.0);
                    }
                    let (most, by_s) = limit(i, s, psi);
                    (element.limit * most, element.limit * by_s)
                };
                self.slider(&cycle.sliders[j], branch, v, &limit, speed)
            };
            for i in 0..3 {
                sum[i] += element.share * solved.force[i];
                power[i] += element.share * solved.force[i] * (v[i] - solved.rate[i]);
                for k in 0..3 {
                    slope[i][k] += element.share * solved.slope[i][k];
                }
            }
            rates[j] = solved.rate;
        }
        (sum, slope, power)
    }

    #[allow(clippy::too_many_arguments)]
    fn accept(
        &self,
        cycle: &mut Cycle,
        forcing: &[Forcing; 3],
        v: &Stages,
        rates: &[Stages],
        angles: &Stages,
        force: &Stages,
        reference: f64,
    ) {
        let (_, speed) = self.system.scale();
        let weight = 2.0 / self.steps as f64;
        for i in 0..3 {
            let swing = weight * A[2][i] * (angles[i] - reference);
            cycle.fundamental.0 += swing * forcing[i].sine;
            cycle.fundamental.1 += swing * forcing[i].cosine;
            cycle.mean += 0.5 * weight * A[2][i] * angles[i];
            cycle.force = (cycle.force.0.min(force[i]), cycle.force.1.max(force[i]));
        }
        for (j, element) in self.system.elements().iter().enumerate() {
            let slider = &mut cycle.sliders[j];
            let d = rates[j];
            if self.is_hysteretic {
                let branch = self.hysteresis(hysteresis_of(&cycle.shared), slider.rate, &d).0;
                with_hysteresis(&mut cycle.shared, branch);
            }
            slider.rate = d[2];
            let dot = |row: &Stages| row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
            slider.x = self.stretch.0[2] * slider.x + dot(&self.stretch.1[2]);
            if self.follows_stretch() {
                cycle.shared[STRETCH] = slider.x;
            }
            for (q, (k1, start, by_rate)) in slider.q.iter_mut().zip(&self.branches) {
                *q = start[2] * *q + k1 * dot(&by_rate[2]);
            }
            let slip: Stages = std::array::from_fn(|i| (v[i] - d[i]).abs());
            slider.psi = self.interface(slider.psi, &slip)[2];
            for i in 0..3 {
                if slip[i] > 1e-12 * speed {
                    cycle.slipped[j] = true;
                } else {
                    cycle.stick += element.share * A[2][i] / self.steps as f64;
                }
            }
        }
    }

    /// Interface state at the stages for given slip rates.
    fn interface(&self, psi: f64, slip: &Stages) -> Stages {
        if !self.has_interface {
            return [psi; 3];
        }
        let rate = slip.map(|s| self.system.interface(s).unwrap_or_default());
        let matrix: Block = std::array::from_fn(|i| {
            std::array::from_fn(|k| f64::from(u8::from(i == k)) - self.h * A[i][k] * rate[k].1)
        });
        let growth = product(&A, &rate.map(|r| r.0));
        product(&inverse(&matrix), &growth.map(|g| psi + self.h * g))
    }

    /// Force of bristles and branches at the stages without any rate.
    fn own(&self, slider: &Slider) -> Stages {
        let kc = self.system.bristles()[0];
        let relaxing =
            |i: usize| -> f64 { self.branches.iter().zip(&slider.q).map(|((_, start, _), q)| start[i] * q).sum() };
        std::array::from_fn(|i| kc * self.stretch.0[i] * slider.x + relaxing(i))
    }

    /// The force of the bristles at these rates, and its tangent there.
    fn tangent(&self, own: Stages, branch: Branch, before: f64, d: &Stages) -> Tangent {
        let mut stiffness = self.stiffness;
        let mut force = plus(&own, &stiffness, d);
        if !self.is_hysteretic {
            return Tangent { force, own, stiffness };
        }
        let (_, forces, slopes) = self.hysteresis(branch, before, d);
        for i in 0..3 {
            force[i] += forces[i];
            for k in 0..3 {
                stiffness[i][k] += slopes[i] * self.stretch.1[i][k];
            }
        }
        let moved = product(&stiffness, d);
        Tangent { force, own: std::array::from_fn(|i| force[i] - moved[i]), stiffness }
    }

    /// The hysteresis over a step: where it ends, its force and slope at the stages. Between two stages whose rates
    /// differ in sign the stretch turns back, where the line between the rates is zero.
    fn hysteresis(&self, from: Branch, before: f64, d: &Stages) -> (Branch, Stages, Stages) {
        let (mut branch, mut x, mut rate, mut time) = (from, 0.0, before, 0.0);
        let (mut forces, mut slopes) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let stretch = (0..3).map(|k| self.stretch.1[i][k] * d[k]).sum::<f64>();
            let mut by = stretch - x;
            let mut go = |by: f64| {
                let (there, slope) = self.system.hysteresis(branch, by).unwrap_or_default();
                branch = there;
                slope
            };
            if rate * d[i] < 0.0 {
                let to_reversal = 0.5 * rate * rate / (rate - d[i]) * (C[i] - time) * self.h;
                go(to_reversal);
                by -= to_reversal;
            }
            slopes[i] = go(by);
            forces[i] = branch.force;
            (x, rate, time) = (stretch, d[i], C[i]);
        }
        (branch, forces, slopes)
    }

    /// One slider at the stages, where its limit does not depend on the slip rate.
    fn steady_slider(
        &self,
        slipping: &[Slipping; 8],
        slider: &Slider,
        v: &Stages,
        most: &Stages,
        speed: f64,
    ) -> Solved {
        let own = self.own(slider);
        let mut rate = *v;
        let mut force = plus(&own, &self.stiffness, &rate);
        let mut sign = [0.0; 3];
        let mut stages = 0;
        for _ in 0..40 {
            if !switch(&mut sign, &force, |i| most[i], |i| v[i] - rate[i], speed) {
                break;
            }
            stages = (0..3).filter(|&i| sign[i] != 0.0).map(|i| 1 << i).sum();
            let known = std::array::from_fn(|i| if sign[i] == 0.0 { v[i] } else { sign[i] * most[i] - own[i] });
            rate = product(&slipping[stages].rate, &known);
            force = plus(&own, &self.stiffness, &rate);
        }
        Solved { force, rate, slope: slipping[stages].slope }
    }

    /// One slider at the stages: stuck or at its limit, each stage by itself.
    fn slider(
        &self,
        slider: &Slider,
        branch: Branch,
        v: &Stages,
        limit: &dyn Fn(usize, f64, f64) -> (f64, f64),
        speed: f64,
    ) -> Solved {
        let own = self.own(slider);
        let mut d = *v;
        let Tangent { force: mut f, own: mut start, mut stiffness } = self.tangent(own, branch, slider.rate, &d);
        if (0..3).all(|i| f[i].abs() <= limit(i, 0.0, slider.psi).0) && !self.has_interface {
            return Solved { force: f, rate: d, slope: stiffness };
        }
        let mut psi = [slider.psi; 3];
        let mut sign = [0.0; 3];
        let mut slopes = [0.0; 3];
        for _ in 0..40 {
            let changed = switch(&mut sign, &f, |i| limit(i, 0.0, psi[i]).0, |i| v[i] - d[i], speed);
            if sign == [0.0; 3] && !changed {
                break;
            }
            let mut matrix = [[0.0; 3]; 3];
            let mut right = [0.0; 3];
            for i in 0..3 {
                if sign[i] == 0.0 {
                    matrix[i][i] = 1.0;
                    right[i] = v[i];
                    slopes[i] = 0.0;
                } else {
                    let slip = (sign[i] * (v[i] - d[i])).max(0.0);
                    let (most, by_s) = limit(i, slip, psi[i]);
                    matrix[i] = stiffness[i];
                    matrix[i][i] += by_s;
                    right[i] = -start[i] + sign[i] * (most - by_s * slip) + by_s * v[i];
                    slopes[i] = by_s;
                }
            }
            let new = product(&inverse(&matrix), &right);
            let change = (0..3).fold(0.0f64, |m, i| m.max((new[i] - d[i]).abs()));
            d = new;
            Tangent { force: f, own: start, stiffness } = self.tangent(own, branch, slider.rate, &d);
            psi = self.interface(slider.psi, &std::array::from_fn(|i| (v[i] - d[i]).abs()));
            if !changed && change < 1e-13 * speed {
                break;
            }
        }
        if sign.iter().all(|s| *s != 0.0) && slopes == [0.0; 3] {
            return Solved { force: f, rate: d, slope: [[0.0; 3]; 3] };
        }
        Solved { force: f, rate: d, slope: chained(&stiffness, &rate_by_speed(&stiffness, &sign, &slopes)) }
    }
}

/// Lets stages slip whose force is beyond the limit, in its direction, and those stick whose slip has turned back;
/// whether any did.
#[inline(always)]
fn switch(
    sign: &mut Stages,
    force: &Stages,
    limit: impl Fn(usize) -> f64,
    slip: impl Fn(usize) -> f64,
    speed: f64,
) -> bool {
    let mut changed = false;
    for i in 0..3 {
        if sign[i] == 0.0 {
            if force[i].abs() > limit(i) {
                sign[i] = force[i].signum();
                changed = true;
            }
        } else if sign[i] * slip(i) < -1e-13 * speed {
            sign[i] = 0.0;
            changed = true;
        }
    }
    changed
}

/// Rates of stretch by the relative speeds: stuck stages follow, slipping ones through the slopes of the law.
fn rate_by_speed(stiffness: &Block, sign: &Stages, slopes: &Stages) -> Block {
    let mut matrix = [[0.0; 3]; 3];
    for i in 0..3 {
        if sign[i] == 0.0 {
            matrix[i][i] = 1.0;
        } else {
            matrix[i] = stiffness[i];
            matrix[i][i] += slopes[i];
        }
    }
    let mut by_speed = inverse(&matrix);
    for k in (0..3).filter(|&k| sign[k] != 0.0) {
        by_speed.iter_mut().for_each(|row| row[k] *= slopes[k]);
    }
    by_speed
}

/// a + B v
fn plus(a: &Stages, b: &Block, v: &Stages) -> Stages {
    let moved = product(b, v);
    std::array::from_fn(|i| a[i] + moved[i])
}

struct Solved {
    force: Stages,
    rate: Stages,
    slope: Block,
}
