//! One cycle of a contact of many parallel sliders: fixed Radau steps, each slider solved at the stages for itself.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::collocation::{A, C, interpolate};
use super::slider::{Bristles, Slider};
use super::stages::{Block, Pair, Stages, chained, inverse, product, relaxation};
use crate::effects::Branch;
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
    bristles: Bristles<'a>,
    is_rate_independent: bool,
    /// Forcing at the stages of every step.
    forcing: Vec<[Forcing; 3]>,
}

impl<'a> Method<'a> {
    /// With so many steps per period.
    pub fn new(system: &'a dyn SliderSystem, steps: usize) -> Self {
        let h = system.period() / steps as f64;
        let support = system.support().map(|(linear, gain)| (Pair::new(h, linear), gain));
        let bristles = Bristles::new(system, h);
        let is_rate_independent = system.rate_independent();
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
        Self { system, steps, h, arm, support, gain, by_force, bristles, is_rate_independent, forcing }
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
        if self.bristles.is_hysteretic {
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
            let solved = if let Some(slipping) = &self.bristles.slipping {
                self.bristles.steady_slider(
                    slipping,
                    &cycle.sliders[j],
                    v,
                    &most.map(|most| element.limit * most),
                    speed,
                )
            } else {
                let limit = |i: usize, s: f64, psi: f64| {
                    if self.is_rate_independent {
                        return (element.limit * most[i], 0.0);
                    }
                    let (most, by_s) = limit(i, s, psi);
                    (element.limit * most, element.limit * by_s)
                };
                self.bristles.slider(&cycle.sliders[j], branch, v, &limit, speed)
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
            if self.bristles.is_hysteretic {
                let branch = self.bristles.hysteresis(hysteresis_of(&cycle.shared), slider.rate, &d).0;
                with_hysteresis(&mut cycle.shared, branch);
            }
            let slip: Stages = std::array::from_fn(|i| (v[i] - d[i]).abs());
            self.bristles.advance(slider, &d, &slip);
            if self.follows_stretch() {
                cycle.shared[STRETCH] = slider.x;
            }
            for i in 0..3 {
                if slip[i] > 1e-12 * speed {
                    cycle.slipped[j] = true;
                } else {
                    cycle.stick += element.share * A[2][i] / self.steps as f64;
                }
            }
        }
    }
}
