//! One period of a hybrid system: steps cut exactly at the events, observables and tangents gathered on the way.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::columns::Adjoints;
use super::dense::{Matrix, solve};
use super::flow::{self, Flow};
use super::integration::{Demands, Integration};
pub use super::period::{Cycle, Part, Record};
use super::radau::{State, Stepper};
use super::sensitivity::{self, Gradient};
pub use super::tolerance::Tolerance;
use crate::model::system::{HybridSystem, MAX_STATES, Mode};

/// Difference of the starts of two cycles, relative to the scales, at which their derivatives are the same.
const SAME_ORBIT: f64 = 1e-6;
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

    /// Steps so far.
    pub fn spent(&self) -> usize {
        self.spent
    }

    /// Whether exactly the steps asked for are wanted.
    pub fn measures_order(&self) -> bool {
        self.tolerance.measures_order()
    }

    /// Relative change of the states over a cycle that may be left by the last Newton step.
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

    /// Integrates one period from `start`, on the branch that continues `entry` ([`HybridSystem::enter`]). Errors say
    /// where and why in words.
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

    /// The cycle from `start` with all its parts: the last one, if it began there or as close as serves for
    /// derivatives.
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
    /// gives, of the cycle, the Jacobian of the defect of periodicity and the states that keep the value they are
    /// given.
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
        // Adjoint at the end: -l jacobian = derivative by the start. An open state keeps its value: nothing comes of
        // it.
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
            let (mut stretch, segment) = match part {
                Part::Segment(both) => *both,
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
            adjoint = segment.fundamental_by_start;
            for j in 0..n {
                for i in 0..n {
                    adjoint[j].0 += stretch.adjoint[i].0 * segment.transition[i][j];
                    adjoint[j].1 += stretch.adjoint[i].1 * segment.transition[i][j];
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
        let (exact, observe) = (recorder.is_none(), self.observe);
        let keep = exact && self.keep && !self.coarse;
        let mut run =
            Integration::new(self.system, Demands::new(self.system, &self.tolerance, self.coarse), start, entry);
        let mut stepper = self.stepper.take();
        if let Some(stepper) = &mut stepper {
            stepper.accept(None);
        }
        while run.goes_on()? {
            if exact && let Some(flow) = self.flow(run.mode) {
                let part = run.follow(flow, observe)?;
                if observe && keep {
                    parts.push(Part::Segment(Box::new(part)));
                }
                continue;
            }
            run.check_bounded()?;
            self.spent += 1;
            if self.spent > self.tolerance.budget {
                return Err(format!("given up after {} steps", self.tolerance.budget));
            }
            let stepper = stepper.get_or_insert_default();
            let (size, event) = self.step(&mut run, stepper)?;
            let weight = run.gather(stepper, size);
            if keep {
                parts.push(Part::Step(Box::new(stepper.taken(run.mode, size, weight))));
            }
            if let Some(record) = &mut recorder {
                record(&Record { time: run.time, size, start: &run.state, slip: run.slip, stepper, mode: run.mode });
            }
            run.advance(stepper, size, event)?;
        }
        self.stepper = stepper;
        Ok(run.finish())
    }

    /// Takes a step, cut where the mode ends in it: its size \[s\], and whether the mode ends with it.
    fn step(&mut self, run: &mut Integration, stepper: &mut Stepper) -> Result<(f64, bool), String> {
        let (opening, first) = ((run.mode, run.time == 0.0), run.first);
        let known = self.firsts.iter_mut().find(|(known, _)| *known == opening);
        if first && let Some((_, share)) = &known {
            run.resume(*share);
        }
        let taken = run.step(stepper)?;
        // Smaller from cycle to cycle only: with other steps each time the cycles would not converge to rounding.
        if first && let Some(share) = taken.share {
            match known {
                Some((_, least)) => *least = least.min(share),
                None => self.firsts.push((opening, share)),
            }
        }
        run.cut(stepper, &taken)
    }
}
