//! One period of a hybrid system: steps cut exactly at the events, observables and tangents gathered on the way.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::collocation::roughness;
use super::columns::Adjoints;
use super::dense::{Matrix, identity, multiply, solve};
use super::events::{EVENT_ROUGHNESS, LOCATED, LOOSEST_LOCATED, Start, at_stages, crosses};
use super::flow::{self, Flow};
pub use super::period::{Cycle, Part, Record};
use super::radau::{A, State, Stepper};
use super::sensitivity::{self, Gradient, Stretch};
pub use super::tolerance::Tolerance;
use crate::model::system::{HybridSystem, MAX_STATES, Mode};

/// Largest numerical damping relative to the damping of the arm.
const NUMERICAL_DAMPING: f64 = 2e-6;
/// Factors on size and roughness of the steps, and on the accuracy of the places of events, while a search is far off.
const COARSE: f64 = 2.0;
const COARSE_ROUGHNESS: f64 = 10.0;
const COARSE_LOCATED: f64 = 100.0;
/// Difference of the starts of two cycles, relative to the scales, at which their derivatives are the same.
const SAME_ORBIT: f64 = 1e-6;
/// Most changes of mode in one period.
const MAX_EVENTS: usize = 1000;
/// States this many times their first guess, and a thousand times as many times their scale, are on their way to infinity.
const UNBOUNDED: f64 = 1e3;
/// How many times more steps a kink asks for.
const KINKED: f64 = 4.0 / 3.0;
/// Ratio of neighbouring sizes of step: a power of it is that of coarse steps to fine ones.
const RUNG: f64 = 0.840_896_415_253_714_5;
/// Shares of a step or of a period that are rounding.
const ROUNDING: f64 = 1e-12;
/// Roughness below which a step may be twice as long.
const SMOOTH: f64 = 0.45 * 0.45 * 0.45;
/// Most steps in one period.
const MAX_STEPS: usize = 20_000;

/// A cycle: its start, its parts and what it amounts to.
type Orbit = (State, Vec<Part>, Cycle);

/// Integrates period after period of one system, keeping what does not depend on where it starts.
pub struct Integrator<'a> {
    system: &'a dyn HybridSystem,
    tolerance: Tolerance,
    /// Modes met so far, with their exact flows where they have one.
    flows: Vec<(Mode, Option<Box<dyn Flow>>)>,
    stepper: Option<Stepper>,
    /// The last orbit of which all parts are known.
    orbit: Option<Orbit>,
    /// Whether mean and extremes of the force are wanted of exact flows.
    pub observe: bool,
    /// Whether the parts of an orbit are kept: its derivatives will be wanted.
    pub keep: bool,
    /// Whether steps may be coarser than the tolerance asks for: enough for a search that is still far off.
    pub coarse: bool,
    /// Sizes of the first steps in each mode, from the start of the cycle or an event on, as shares of the largest.
    firsts: Vec<((Mode, bool), f64)>,
    /// Steps integrated so far.
    spent: usize,
}

impl<'a> Integrator<'a> {
    /// An integrator of `system`.
    pub fn new(system: &'a dyn HybridSystem, tolerance: &Tolerance) -> Self {
        Self {
            system,
            tolerance: *tolerance,
            flows: Vec::new(),
            stepper: None,
            orbit: None,
            observe: true,
            keep: false,
            coarse: false,
            firsts: Vec::new(),
            spent: 0,
        }
    }

    /// The demands.
    pub fn tolerance(&self) -> &Tolerance {
        &self.tolerance
    }

    /// The system.
    pub fn system(&self) -> &'a dyn HybridSystem {
        self.system
    }

    /// Whether exactly the steps asked for are wanted.
    pub fn measures_order(&self) -> bool {
        self.tolerance.measures_order()
    }

    /// Relative change of the states over a cycle that may be left by the last step of Newton's.
    pub fn left(&self) -> f64 {
        self.tolerance.left()
    }

    /// Exact flow of a mode, unless the order of the method is to be measured.
    fn flow(&mut self, mode: Mode) -> Option<&dyn Flow> {
        if self.measures_order() {
            return None;
        }
        let index = self.known(mode)?;
        self.flow_at(index)
    }

    /// Place of the exact flow of a mode among those met so far; `None` where it has none.
    pub(super) fn known(&mut self, mode: Mode) -> Option<usize> {
        let index = self.flows.iter().position(|(known, _)| *known == mode).unwrap_or_else(|| {
            self.flows.push((mode, flow::flow(self.system, mode, self.tolerance.steps)));
            self.flows.len() - 1
        });
        self.flows[index].1.is_some().then_some(index)
    }

    /// The exact flow at a place.
    pub(super) fn flow_at(&self, index: usize) -> Option<&dyn Flow> {
        self.flows[index].1.as_deref()
    }

    /// Integrates one period from `start`, on the branch that continues `entry` ([`HybridSystem::enter`]). Errors say where
    /// and why in words.
    pub fn cycle(&mut self, start: &State, entry: Option<(Mode, f64)>) -> Result<Cycle, String> {
        let mut parts = Vec::new();
        let cycle = self.integrate(start, entry, None, &mut parts)?;
        self.orbit = (!parts.is_empty() && parts.len() == cycle.steps).then(|| (*start, parts, cycle.clone()));
        Ok(cycle)
    }

    /// The same with a record of every step.
    pub fn trace(
        &mut self,
        start: &State,
        entry: Option<(Mode, f64)>,
        recorder: &mut dyn FnMut(&Record),
    ) -> Result<(), String> {
        self.integrate(start, entry, Some(recorder), &mut Vec::new()).map(|_| ())
    }

    /// The cycle from `start` with all its parts: the last one, if it began there or as close as serves for derivatives.
    fn orbit(&mut self, start: &State, entry: (Mode, f64)) -> Result<Orbit, String> {
        let (n, scales, near) = (self.system.states(), self.system.scales(), SAME_ORBIT * self.tolerance.slack());
        let begins = |(begin, ..): &Orbit| (0..n).all(|i| (begin[i] - start[i]).abs() <= near * scales[i]);
        if !self.orbit.as_ref().is_some_and(begins) {
            (self.observe, self.coarse, self.keep) = (true, false, true);
            self.cycle(start, Some(entry))?;
        }
        self.orbit.take().ok_or_else(|| "the parts of the cycle are not known".into())
    }

    /// Derivatives of the fundamental by the parameter columns on a periodic orbit, by the adjoint method. `defect`
    /// gives, of the cycle, the Jacobian of the defect of periodicity and the states that keep the value they are given.
    pub fn columns(
        &mut self,
        start: &State,
        entry: (Mode, f64),
        defect: impl Fn(&Cycle) -> (Matrix, [bool; MAX_STATES]),
    ) -> Result<Vec<(f64, f64)>, String> {
        let (_, parts, cycle) = self.orbit(start, entry)?;
        let system = self.system;
        let (n, scales) = (system.states(), system.scales());
        let (jacobian, open) = defect(&cycle);
        // Adjoint at the end: -l jacobian = derivative by the start. An open state keeps its value: nothing comes of it.
        let transposed: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|j| -jacobian[j][i] * scales[i] / scales[j]));
        let by_start = |part: fn((f64, f64)) -> f64| -> State {
            std::array::from_fn(|i| part(cycle.fundamental_by_start[i]) * scales[i])
        };
        let isolated = "the periodic solution is not isolated: its derivatives do not exist";
        let re = solve(n, transposed, by_start(|z| z.0)).ok_or(isolated)?;
        let im = solve(n, transposed, by_start(|z| z.1)).ok_or(isolated)?;
        let mut adjoint = [(0.0, 0.0); MAX_STATES];
        for i in (0..n).filter(|&i| !open[i]) {
            adjoint[i] = (re[i] / scales[i], im[i] / scales[i]);
        }
        let mut gradients: Vec<(Mode, Gradient)> = Vec::new();
        let mut adjoints: Option<Adjoints> = None;
        let mut columns = vec![(0.0, 0.0); system.columns()];
        for part in parts.into_iter().rev() {
            let (mut stretch, leg) = match part {
                Part::Leg(both) => *both,
                Part::Step(taken) => {
                    let stepper = self.stepper.get_or_insert_default();
                    let adjoints = adjoints.get_or_insert_with(Adjoints::new);
                    if !adjoints.step(system, stepper, &taken, &mut adjoint, &mut columns) {
                        return Err("the Jacobian is singular on the periodic solution".into());
                    }
                    continue;
                }
            };
            stretch.adjoint = adjoint;
            adjoint = leg.fundamental_by_start;
            for j in 0..n {
                for i in 0..n {
                    adjoint[j].0 += stretch.adjoint[i].0 * leg.transition[i][j];
                    adjoint[j].1 += stretch.adjoint[i].1 * leg.transition[i][j];
                }
            }
            let index = gradients.iter().position(|(mode, _)| *mode == stretch.mode).unwrap_or_else(|| {
                gradients.push((stretch.mode, Gradient::default()));
                gradients.len() - 1
            });
            if let Some(flow) = self.flow(stretch.mode) {
                flow.gather(&stretch, &mut gradients[index].1);
            }
        }
        let determined = gradients
            .iter()
            .all(|(mode, gradient)| sensitivity::through_columns(system, *mode, gradient, &mut columns));
        if determined { Ok(columns) } else { Err("the equations do not determine the slip rate".into()) }
    }

    fn integrate(
        &mut self,
        start: &State,
        entry: Option<(Mode, f64)>,
        mut recorder: Option<&mut dyn FnMut(&Record)>,
        parts: &mut Vec<Part>,
    ) -> Result<Cycle, String> {
        let (system, mut tolerance) = (self.system, self.tolerance);
        let coarse = self.coarse;
        // The deviation from the polynomial grows with the third power of the step.
        tolerance.roughness *= tolerance.relief().powi(3) * if coarse { COARSE_ROUGHNESS } else { 1.0 };
        let (exact, observe) = (recorder.is_none(), self.observe);
        let keep = exact && self.keep && !coarse;
        let n = system.states();
        let period = system.period();
        // The method damps an oscillation by (w h)^5/7200 a radian; that must be little against its own damping.
        let ratio = system.damping_ratio().clamp(1e-6, 1.0);
        let needed = std::f64::consts::TAU / (7200.0 * NUMERICAL_DAMPING * ratio).powf(0.2) / tolerance.relief();
        let steps = tolerance.steps as f64 * if system.is_kinked() { KINKED } else { 1.0 };
        let largest = period / if tolerance.roughness.is_finite() { needed.max(steps).ceil() } else { steps }
            * if coarse { COARSE } else { 1.0 };
        let slip_scale = system.slip_scale();
        let located = (LOCATED * tolerance.slack() * if coarse { COARSE_LOCATED } else { 1.0 }).min(LOOSEST_LOCATED);
        let mut stepper = self.stepper.take();
        if let Some(stepper) = &mut stepper {
            stepper.accept(None);
        }
        let (mut t, mut z, mut h) = (0.0, *start, largest);
        let mut first = true;
        let moved = system.project(&system.forcing(0.0), &mut z);
        let entered = system.enter(&system.forcing(0.0), &z, entry);
        let (mut mode, mut s) = entered;
        let mut cycle = Cycle {
            end: z,
            branch: [entered; 2],
            monodromy: identity(),
            fundamental: (0.0, 0.0),
            fundamental_by_start: [(0.0, 0.0); MAX_STATES],
            mean: 0.0,
            mean_by_start: [0.0; MAX_STATES],
            legs: 0,
            observed: true,
            stick_fraction: 0.0,
            force: (f64::INFINITY, f64::NEG_INFINITY),
            steps: 0,
            events: 0,
        };
        if let Some(index) = moved {
            cycle.monodromy[index][index] = 0.0;
        }
        let (scales, at_first) = (system.scales(), system.initial_state());
        let mut tangents = [[[0.0; MAX_STATES]; MAX_STATES]; 3];
        let mut through = tangents;
        let mut reached = None;
        while period - t > ROUNDING * period {
            if cycle.steps > MAX_STEPS {
                return Err(format!(
                    "more than {MAX_STEPS} steps in one cycle, stopped at {:.4} of the cycle",
                    t / period
                ));
            }
            if exact && let Some(flow) = self.flow(mode) {
                let leg = flow.leg(t, &z, period, start[0], observe);
                if !leg.state.iter().all(|z| z.is_finite()) {
                    return Err(format!("the motion grew without bound at {:.4} of the cycle", t / period));
                }
                cycle.follow(&leg, mode, (leg.time - t) / period, n);
                if observe && keep {
                    let stretch = Stretch {
                        mode,
                        time: [t, leg.time],
                        states: [z, leg.state],
                        adjoint: Default::default(),
                        period,
                    };
                    parts.push(Part::Leg(Box::new((stretch, leg.clone()))));
                }
                (t, z, s, h, first) = (leg.time, leg.state, leg.slip, largest, true);
                reached = None;
                if leg.ended {
                    cycle.events += 1;
                    if cycle.events > MAX_EVENTS {
                        return Err(format!("more than {MAX_EVENTS} changes between stick and slip in one cycle"));
                    }
                    (mode, s) = system.next_mode(&system.forcing(t), &z, s, mode);
                }
                continue;
            }
            if (0..n).any(|i| z[i].abs() > UNBOUNDED * (1e3 * scales[i] + at_first[i].abs())) {
                return Err(format!("the motion grew without bound at {:.4} of the cycle", t / period));
            }
            self.spent += 1;
            if self.spent > self.tolerance.budget {
                return Err(format!("given up after {} steps", self.tolerance.budget));
            }
            let stepper = stepper.get_or_insert_default();
            let opening = (mode, t == 0.0);
            if first && let Some((_, share)) = self.firsts.iter().find(|(known, _)| *known == opening) {
                h = rung(largest, share * largest);
            }
            // Rounding does not make the last of equal steps another one.
            let mut size = if h < (period - t) * (1.0 + ROUNDING) { h } else { period - t };
            let mut event = false;
            // At the end of a step it is known.
            let forcing = reached.take().unwrap_or_else(|| system.forcing(t));
            let at_start = system.event(&forcing, &z, s, mode);
            let mut e;
            loop {
                if size < 1e-10 * period {
                    return Err(format!(
                        "the step size fell below 1e-10 of the cycle at {:.4} of it in {mode:?}",
                        t / period
                    ));
                }
                // What fills the cycle up is of a size of its own.
                let lasting = size < period - t;
                if !stepper.step(system, &forcing, &z, s, size, mode, lasting) {
                    size = rung(largest, 0.25 * size);
                    continue;
                }
                e = at_stages(system, stepper, mode);
                let roughness = (roughness(s, stepper.s) / slip_scale / tolerance.roughness)
                    .max(roughness(at_start, e) / (EVENT_ROUGHNESS * e.iter().fold(1e-7, |m: f64, e| m.max(e.abs()))));
                if roughness > 1.0 && size > 1e-6 * period {
                    size = rung(largest, size * (0.9 / roughness.cbrt()).clamp(0.2, 0.7));
                    continue;
                }
                h = rung(largest, size * if roughness > SMOOTH { 0.9 / roughness.cbrt() } else { 2.0 });
                break;
            }
            if std::mem::take(&mut first) && size < period - t {
                // Smaller from cycle to cycle only: with other steps each time the cycles would not converge to rounding.
                let share = size / largest;
                match self.firsts.iter_mut().find(|(known, _)| *known == opening) {
                    Some((_, least)) => *least = least.min(share),
                    None => self.firsts.push((opening, share)),
                }
            }
            if crosses(at_start, e) {
                let start = Start { system, time: t, forcing: &forcing, z: &z, slip: s, mode, event: at_start };
                let shorter = start.shorten(stepper, size, e, located)?;
                (size, event) = (shorter.size, shorter.ended);
                h = if event { largest } else { rung(largest, size) };
                first = event;
            } else if e[2] < located && e[2] < at_start {
                // As good as ended: a step from here would take this for a mode that has just begun.
                (event, h, first) = (true, largest, true);
            }
            // Tangents and observables of the accepted step.
            stepper.tangent(system, &mut tangents);
            let weight = 2.0 * size / period;
            for i in 0..3 {
                // Of the inner stages only the first state is read.
                let rows = if i == 2 { n } else { 1 };
                multiply(rows, n, &tangents[i], &cycle.monodromy, &mut through[i]);
                // A = (2i/T) integral of z0 e^{-iwt}
                let (sine, cosine) = (stepper.forcing[i].sine, stepper.forcing[i].cosine);
                let w = weight * A[2][i];
                // A constant has no fundamental: taken off, the large static angle does not enter through rounding.
                let swing = stepper.z[i][0] - start[0];
                cycle.fundamental.0 += w * sine * swing;
                cycle.fundamental.1 += w * cosine * swing;
                for j in 0..n {
                    cycle.fundamental_by_start[j].0 += w * sine * through[i][0][j];
                    cycle.fundamental_by_start[j].1 += w * cosine * through[i][0][j];
                    cycle.mean_by_start[j] += 0.5 * w * through[i][0][j];
                }
                cycle.mean += 0.5 * w * stepper.z[i][0];
                let (force, _) = system.force(&stepper.forcing[i], &stepper.z[i], stepper.s[i]);
                cycle.force = (cycle.force.0.min(force), cycle.force.1.max(force));
            }
            if keep {
                parts.push(Part::Step(Box::new(stepper.taken(mode, size, weight))));
            }
            if mode == Mode::Stick {
                cycle.stick_fraction += size / period;
            }
            if let Some(record) = &mut recorder {
                record(&Record { time: t, size, start: &z, slip: s, stepper, mode });
            }
            stepper.accept((!event).then_some((mode, size)));
            cycle.monodromy[..n].copy_from_slice(&through[2][..n]);
            t += size;
            z = stepper.z[2];
            s = stepper.s[2];
            reached = Some(stepper.forcing[2]);
            cycle.steps += 1;
            if event {
                cycle.events += 1;
                if cycle.events > MAX_EVENTS {
                    return Err(format!("more than {MAX_EVENTS} changes between stick and slip in one cycle"));
                }
                let (next, slip) = system.next_mode(&stepper.forcing[2], &z, s, mode);
                (mode, s) = (next, slip);
            }
        }
        self.stepper = stepper;
        cycle.end = z;
        cycle.branch[1] = (mode, s);
        Ok(cycle)
    }
}

/// The largest of few sizes of step that is not above `size`: what a size makes of a step is kept for the next one.
fn rung(largest: f64, size: f64) -> f64 {
    let mut rung = largest;
    while rung > size {
        rung *= RUNG;
    }
    rung
}
