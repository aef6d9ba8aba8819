//! An integration over one period: exact stretches where a mode is affine, elsewhere steps that are cut at the events;
//! observables and tangents are gathered on the way.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::collocation::roughness;
use super::dense::{Matrix, identity, multiply};
use super::events::{EVENT_ROUGHNESS, LOCATED, LOOSEST_LOCATED, Start, at_stages, crosses};
use super::flow::{Flow, Segment};
use super::period::Cycle;
use super::radau::{A, State, Stepper};
use super::sensitivity::Stretch;
use super::tolerance::Tolerance;
use crate::model::system::{Forcing, HybridSystem, MAX_STATES, Mode};

/// Largest numerical damping relative to the damping of the arm.
const NUMERICAL_DAMPING: f64 = 2e-6;
/// Factors on size and roughness of the steps, and on the accuracy of the places of events, while a search is far off.
const COARSE: f64 = 2.0;
const COARSE_ROUGHNESS: f64 = 10.0;
const COARSE_LOCATED: f64 = 100.0;
/// Most changes of mode in one period.
const MAX_EVENTS: usize = 1000;
/// States this many times their first guess, and a thousand times as many times their scale, are on their way to
/// infinity.
const UNBOUNDED: f64 = 1e3;
/// How many times more steps a kink asks for.
const KINKED: f64 = 4.0 / 3.0;
/// Ratio of neighbouring sizes of step: a power of it is that of coarse steps to fine ones.
const STEP_RATIO: f64 = 0.840_896_415_253_714_5;
/// Shares of a step or of a period that are rounding.
const ROUNDING: f64 = 1e-12;
/// Roughness below which a step may be twice as long.
const SMOOTH: f64 = 0.45 * 0.45 * 0.45;
/// Smallest step as a share of the period.
const SMALLEST: f64 = 1e-10;
/// Most steps in one period.
const MAX_STEPS: usize = 20_000;

/// What is demanded of the steps of one integration.
pub struct Demands {
    /// Largest deviation of the slip rate from its polynomial over a step, relative to its scale.
    roughness: f64,
    /// Largest step \[s\].
    largest: f64,
    /// Event value below which an event is at the end of a step.
    located: f64,
    /// States beyond these are on their way to infinity.
    bounds: State,
}

impl Demands {
    /// Those of a tolerance; coarse ones serve a search that is still far off.
    pub fn new(system: &dyn HybridSystem, tolerance: &Tolerance, coarse: bool) -> Self {
        // The deviation from the polynomial grows with the third power of the step.
        let roughness =
            tolerance.roughness * (tolerance.coarsening().powi(3) * if coarse { COARSE_ROUGHNESS } else { 1.0 });
        // The method damps an oscillation by (w h)^5/7200 a radian; that must be little against its own damping.
        let ratio = system.damping_ratio().clamp(1e-6, 1.0);
        let needed = std::f64::consts::TAU / (7200.0 * NUMERICAL_DAMPING * ratio).powf(0.2) / tolerance.coarsening();
        let steps = tolerance.steps as f64 * if system.is_kinked() { KINKED } else { 1.0 };
        let largest = system.period() / if roughness.is_finite() { needed.max(steps).ceil() } else { steps }
            * if coarse { COARSE } else { 1.0 };
        let located = (LOCATED * tolerance.slack() * if coarse { COARSE_LOCATED } else { 1.0 }).min(LOOSEST_LOCATED);
        let (scales, at_first) = (system.scales(), system.initial_state());
        let bounds = std::array::from_fn(|i| UNBOUNDED * (1e3 * scales[i] + at_first[i].abs()));
        Self { roughness, largest, located, bounds }
    }
}

/// A step whose size suits, before its end is looked at.
pub struct Step {
    size: f64,
    forcing: Forcing,
    /// Event values at the start and at the stages.
    events: (f64, [f64; 3]),
    /// Of a first step in a mode that does not fill the cycle up: its size over the largest one.
    pub share: Option<f64>,
}

/// An integration on its way through one period.
// Wide: where an integration stands and what it gathers on the way.
pub struct Integration<'a> {
    system: &'a dyn HybridSystem,
    demands: Demands,
    /// State 0 at the start.
    offset: f64,
    /// Time \[s\].
    pub time: f64,
    /// States.
    pub state: State,
    /// Algebraic unknown.
    pub slip: f64,
    /// Mode.
    pub mode: Mode,
    /// Whether the next step is the first in its mode.
    pub first: bool,
    /// Size of the next step \[s\].
    next: f64,
    /// The forcing at `time`, where a step has ended there.
    reached: Option<Forcing>,
    cycle: Cycle,
    /// Derivatives of the stages by the states at the start of the step, and of the cycle.
    tangents: [[Matrix; 3]; 2],
}

impl<'a> Integration<'a> {
    /// From these states, on the branch that continues `entry`.
    pub fn new(system: &'a dyn HybridSystem, demands: Demands, start: &State, entry: Option<(Mode, f64)>) -> Self {
        let mut state = *start;
        let moved = system.project(&system.forcing(0.0), &mut state);
        let (mode, slip) = system.enter(&system.forcing(0.0), &state, entry);
        let mut monodromy = identity();
        if let Some(index) = moved {
            monodromy[index][index] = 0.0;
        }
        let cycle = Cycle {
            end: state,
            branch: [(mode, slip); 2],
            monodromy,
            fundamental: (0.0, 0.0),
            fundamental_by_start: [(0.0, 0.0); MAX_STATES],
            mean: 0.0,
            mean_by_start: [0.0; MAX_STATES],
            segments: 0,
            observed: true,
            stick_fraction: 0.0,
            force: (f64::INFINITY, f64::NEG_INFINITY),
            steps: 0,
            events: 0,
        };
        let (next, tangents) = (demands.largest, [[[[0.0; MAX_STATES]; MAX_STATES]; 3]; 2]);
        let (offset, time, first, reached) = (start[0], 0.0, true, None);
        Self { system, demands, offset, time, state, slip, mode, first, next, reached, cycle, tangents }
    }

    /// Time that is left of the period \[s\].
    fn left(&self) -> f64 {
        self.system.period() - self.time
    }

    /// Share of the period that is over, for messages.
    fn share(&self) -> f64 {
        self.time / self.system.period()
    }

    /// Whether some of the period is left.
    ///
    /// # Errors
    /// In words, where too many steps were taken.
    pub fn goes_on(&self) -> Result<bool, String> {
        let on = self.left() > ROUNDING * self.system.period();
        if on && self.cycle.steps > MAX_STEPS {
            return Err(format!(
                "more than {MAX_STEPS} steps in one cycle, stopped at {:.4} of the cycle",
                self.share()
            ));
        }
        Ok(on)
    }

    /// What the period amounts to.
    pub fn finish(mut self) -> Cycle {
        self.cycle.end = self.state;
        self.cycle.branch[1] = (self.mode, self.slip);
        self.cycle
    }

    fn unbounded(&self) -> String {
        format!("the motion grew without bound at {:.4} of the cycle", self.share())
    }

    /// Complains where the states are on their way to infinity.
    ///
    /// # Errors
    /// In words.
    pub fn check_bounded(&self) -> Result<(), String> {
        let far = |i: usize| self.state[i].abs() > self.demands.bounds[i];
        if (0..self.system.states()).any(far) { Err(self.unbounded()) } else { Ok(()) }
    }

    /// Follows the exact flow of the mode to its end, or to that of the period.
    ///
    /// # Errors
    /// In words, where the motion grows without bound or the mode changes too often.
    pub fn follow(&mut self, flow: &dyn Flow, observe: bool) -> Result<(Stretch, Segment), String> {
        let (system, period) = (self.system, self.system.period());
        let segment = flow.segment(self.time, &self.state, period, self.offset, observe);
        if !segment.state.iter().all(|z| z.is_finite()) {
            return Err(self.unbounded());
        }
        self.cycle.follow(&segment, self.mode, (segment.time - self.time) / period, system.states());
        let (time, states) = ([self.time, segment.time], [self.state, segment.state]);
        let stretch = Stretch { mode: self.mode, time, states, adjoint: Default::default(), period };
        (self.time, self.state, self.slip) = (segment.time, segment.state, segment.slip);
        (self.next, self.first, self.reached) = (self.demands.largest, true, None);
        if segment.ended {
            self.change(&system.forcing(self.time))?;
        }
        Ok((stretch, segment))
    }

    /// Goes over to the mode that follows.
    fn change(&mut self, forcing: &Forcing) -> Result<(), String> {
        self.cycle.events += 1;
        if self.cycle.events > MAX_EVENTS {
            return Err(format!("more than {MAX_EVENTS} changes between stick and slip in one cycle"));
        }
        (self.mode, self.slip) = self.system.next_mode(forcing, &self.state, self.slip, self.mode);
        Ok(())
    }

    /// Makes the next step as large as that share of the largest.
    pub fn resume(&mut self, share: f64) {
        self.next = quantize_step(self.demands.largest, share * self.demands.largest);
    }

    /// Takes a step of a size that suits; leaves that of the next.
    ///
    /// # Errors
    /// In words, where no size does.
    pub fn step(&mut self, stepper: &mut Stepper) -> Result<Step, String> {
        let (system, largest, period) = (self.system, self.demands.largest, self.system.period());
        let (left, slip_scale) = (self.left(), system.slip_scale());
        // Rounding does not make the last of equal steps another one.
        let mut size = if self.next < left * (1.0 + ROUNDING) { self.next } else { left };
        // At the end of a step it is known.
        let forcing = self.reached.take().unwrap_or_else(|| system.forcing(self.time));
        let at_start = system.event(&forcing, &self.state, self.slip, self.mode);
        loop {
            if size < SMALLEST * period {
                let (share, mode) = (self.share(), self.mode);
                return Err(format!(
                    "the step size fell below {SMALLEST:e} of the cycle at {share:.4} of it in {mode:?}"
                ));
            }
            // What fills the cycle up is of a size of its own.
            let lasting = size < left;
            if !stepper.step(system, &forcing, &self.state, self.slip, size, self.mode, lasting) {
                size = quantize_step(largest, 0.25 * size);
                continue;
            }
            let e = at_stages(system, stepper, self.mode);
            let roughness = (roughness(self.slip, stepper.s) / slip_scale / self.demands.roughness)
                .max(roughness(at_start, e) / (EVENT_ROUGHNESS * e.iter().fold(1e-7, |m: f64, e| m.max(e.abs()))));
            if roughness > 1.0 && size > 1e-6 * period {
                size = quantize_step(largest, size * (0.9 / roughness.cbrt()).clamp(0.2, 0.7));
                continue;
            }
            self.next = quantize_step(largest, size * if roughness > SMOOTH { 0.9 / roughness.cbrt() } else { 2.0 });
            let share = (std::mem::take(&mut self.first) && size < left).then_some(size / largest);
            return Ok(Step { size, forcing, events: (at_start, e), share });
        }
    }

    /// Cuts a step where the mode ends in it: its size \[s\], and whether the mode ends with it.
    ///
    /// # Errors
    /// In words, where the end is not found.
    pub fn cut(&mut self, stepper: &mut Stepper, step: &Step) -> Result<(f64, bool), String> {
        let Demands { largest, located, .. } = self.demands;
        let &Step { size, ref forcing, events: (at_start, e), .. } = step;
        if crosses(at_start, e) {
            let (system, time, mode) = (self.system, self.time, self.mode);
            let start = Start { system, time, forcing, z: &self.state, slip: self.slip, mode, event: at_start };
            let shorter = start.shorten(stepper, size, e, located)?;
            self.next = if shorter.ended { largest } else { quantize_step(largest, shorter.size) };
            self.first = shorter.ended;
            return Ok((shorter.size, shorter.ended));
        }
        // As good as ended: a step from here would take this for a mode that has just begun.
        let ended = e[2] < located && e[2] < at_start;
        if ended {
            (self.next, self.first) = (largest, true);
        }
        Ok((size, ended))
    }

    /// Gathers tangents and observables of a step; its weight in the fundamental.
    pub fn gather(&mut self, stepper: &mut Stepper, size: f64) -> f64 {
        let (system, n, cycle) = (self.system, self.system.states(), &mut self.cycle);
        let [tangents, through] = &mut self.tangents;
        stepper.tangent(system, tangents);
        let weight = 2.0 * size / system.period();
        for i in 0..3 {
            // Of the inner stages only the first state is read.
            let rows = if i == 2 { n } else { 1 };
            multiply(rows, n, &tangents[i], &cycle.monodromy, &mut through[i]);
            // A = (2i/T) integral of z0 e^{-iwt}
            let (sine, cosine) = (stepper.forcing[i].sine, stepper.forcing[i].cosine);
            let w = weight * A[2][i];
            // A constant has no fundamental: taken off, the large static angle does not enter through rounding.
            let swing = stepper.z[i][0] - self.offset;
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
        weight
    }

    /// Goes to the end of a step that was gathered.
    ///
    /// # Errors
    /// In words, where the mode changes too often.
    pub fn advance(&mut self, stepper: &mut Stepper, size: f64, event: bool) -> Result<(), String> {
        let n = self.system.states();
        if self.mode == Mode::Stick {
            self.cycle.stick_fraction += size / self.system.period();
        }
        stepper.accept((!event).then_some((self.mode, size)));
        self.cycle.monodromy[..n].copy_from_slice(&self.tangents[1][2][..n]);
        self.time += size;
        (self.state, self.slip) = (stepper.z[2], stepper.s[2]);
        self.reached = Some(stepper.forcing[2]);
        self.cycle.steps += 1;
        if event { self.change(&stepper.forcing[2]) } else { Ok(()) }
    }
}

/// The largest of few sizes of step that is not above `size`: what a size makes of a step is kept for the next one.
fn quantize_step(largest: f64, size: f64) -> f64 {
    let mut step = largest;
    while step > size {
        step *= STEP_RATIO;
    }
    step
}
