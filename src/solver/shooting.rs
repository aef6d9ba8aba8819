//! Periodic solutions by Newton shooting.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::cycle::{Cycle, Integrator, Record, Tolerance};
use super::dense;
use super::healing::{self, Healed};
pub use super::period::Start;
use super::radau::State;
use crate::model::system::{HybridSystem, MAX_STATES, Mode};

/// Why no periodic solution is given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unsolved {
    /// The contact, which strengthens without bound as it rests over a roller at rest, comes to rest for ever.
    Rests,
    /// None was found, for this reason.
    Failed(String),
}

/// A periodic solution.
#[derive(Debug, Clone)]
pub struct Periodic {
    /// States at time 0.
    pub start: State,
    /// Mode and algebraic unknown at time 0.
    pub entry: (Mode, f64),
    /// The converged cycle.
    pub cycle: Cycle,
    /// Cycles followed, those of the prediction included.
    pub cycles: usize,
    /// Largest change of a state over the cycle, relative to its scale.
    pub residual: f64,
    /// Largest modulus of the Floquet multipliers, those of undetermined states left out.
    pub multiplier: f64,
}

/// Relative change over a cycle below which a solution counts as periodic.
const PERIODIC: f64 = 1e-10;
/// Relative difference of slip rates from which on two branches are two.
const SAME_SLIP: f64 = 1e-5;
/// Factor on the change over a cycle by which the first Newton step may increase it.
const FARTHER: f64 = 2.0;
/// Relative change over a cycle below which coarse steps no longer serve.
const NEAR: f64 = 3e-2;
/// Relative change over a cycle below which the last Newton step may stand for a cycle.
const SQUARED: f64 = 1e-4;
/// Largest last Newton step, relative to the scales, where the derivative of the mean by the start is not known.
const STEP_WITHOUT_MEAN: f64 = 1e-8;
/// Relative change over a cycle below which the next may be the last, and is observed.
const LAST: f64 = 1e-3;
/// Cycles of the transient that are followed where Newton's method does not help: at first, and at most.
const FIRST_TRANSIENT: usize = 3;
const LONGEST_TRANSIENT: usize = 32;
/// Cycles of a transient without slip both ways after which a contact that strengthens as it rests is taken to rest for
/// ever.
const RESTING: usize = 3;
/// Most cycles where the contact may come to rest.
const MAX_CYCLES_AT_REST: usize = 150;

/// Finds the periodic solution from `guess` (or from the system's own first guess).
pub fn solve(system: &dyn HybridSystem, guess: Option<&Start>, tolerance: &Tolerance) -> Result<Periodic, Unsolved> {
    search(&mut Integrator::new(system, tolerance), guess)
}

/// The same with an integrator that has been in use for the system.
pub fn search(integrator: &mut Integrator, guess: Option<&Start>) -> Result<Periodic, Unsolved> {
    let system = integrator.system();
    let most = integrator.tolerance().cycles.min(if system.can_rest() { MAX_CYCLES_AT_REST } else { usize::MAX });
    let mut search = Search::begin(integrator, guess)?;
    while search.cycles < most {
        search.cycles += 1;
        let Some(cycle) = search.cycle()? else { continue };
        search.check_rest(&cycle)?;
        if let Some(found) = search.improve(cycle) {
            return Ok(found);
        }
    }
    Err(Unsolved::Failed(format!("no periodic state within {most} cycles")))
}

/// A search on its way.
struct Search<'a, 'b> {
    integrator: &'a mut Integrator<'b>,
    start: State,
    entry: Option<(Mode, f64)>,
    /// Whether it still hopes for a start near that of another problem.
    warm: bool,
    /// The end of the last cycle that could be followed.
    sound: Option<Start>,
    /// Smallest change over a cycle since the transient was followed.
    best: f64,
    /// Change over the cycle from which the last Newton step began.
    before: f64,
    /// Cycles of the transient that are still to be followed, and how many the next time.
    transient: (usize, usize),
    /// Cycles in a row in which the contact came to rest.
    resting: usize,
    /// Whether a coarse Newton step was taken.
    stepped: bool,
    cycles: usize,
}

impl<'a, 'b> Search<'a, 'b> {
    /// Where to begin: at the prediction, the guess or the system's own first guess; further on where the contact
    /// heals.
    fn begin(integrator: &'a mut Integrator<'b>, guess: Option<&Start>) -> Result<Self, Unsolved> {
        let system = integrator.system();
        let predicted = if integrator.measures_order() { None } else { integrator.predict(guess) };
        let (predicted, cycles) = predicted.unzip();
        let guess = predicted.as_ref().or(guess);
        let mut cycles = cycles.unwrap_or(0);
        let (mut start, mut entry) = match guess {
            Some(guess) => (guess.0, Some(guess.1)),
            None => (system.initial_state(), None),
        };
        integrator.observe = guess.is_some();
        integrator.coarse = guess.is_none() && !integrator.measures_order();
        let mut healed = healing::heal(integrator, &start, &mut cycles);
        if guess.is_some() && matches!(healed, Some(Healed::Rests)) {
            // A neighbour may have been older than this contact ever becomes.
            healed = healing::heal(integrator, &system.initial_state(), &mut cycles);
        }
        match healed {
            Some(Healed::Rests) => return Err(Unsolved::Rests),
            Some(Healed::Slips(near) | Healed::Undecided(near)) => (start, entry) = (near.0, Some(near.1)),
            None => {}
        }
        let (warm, sound, transient) = (guess.is_some(), None, (0, FIRST_TRANSIENT));
        let (best, before) = (f64::INFINITY, f64::INFINITY);
        Ok(Self { integrator, start, entry, warm, sound, best, before, transient, resting: 0, stepped: false, cycles })
    }

    /// The cycle from the present start; `None` where it cannot be followed and the search goes on from somewhere else.
    fn cycle(&mut self) -> Result<Option<Cycle>, Unsolved> {
        let why = match self.integrator.cycle(&self.start, self.entry) {
            Ok(cycle) => return Ok(Some(cycle)),
            Err(why) => why,
        };
        // A warm start that leads nowhere is dropped; a Newton step is taken back and the transient followed.
        (self.start, self.entry) = match self.sound.take() {
            Some(end) => (end.0, Some(end.1)),
            None if self.warm => (self.integrator.system().initial_state(), None),
            None => return Err(Unsolved::Failed(why)),
        };
        self.warm = false;
        self.follow_transient();
        Ok(None)
    }

    /// Newton does not help here: follow the transient for some cycles, longer each time.
    fn follow_transient(&mut self) {
        self.transient = (self.transient.1, (2 * self.transient.1).min(LONGEST_TRANSIENT));
        self.best = f64::INFINITY;
    }

    /// Over a roller at rest a steady motion slips both ways or not at all: one way only is how the contact comes to
    /// rest.
    fn check_rest(&mut self, cycle: &Cycle) -> Result<(), Unsolved> {
        let system = self.integrator.system();
        let rests = self.transient.0 > 0
            && cycle.events <= 2
            && cycle.stick_fraction > 0.0
            && system.can_rest()
            && system.locks(&cycle.end);
        self.resting = if rests { self.resting + 1 } else { 0 };
        if self.resting == RESTING { Err(Unsolved::Rests) } else { Ok(()) }
    }

    /// The solution, where this cycle is it or leads to it; otherwise a better start.
    fn improve(&mut self, cycle: Cycle) -> Option<Periodic> {
        let system = self.integrator.system();
        let (n, scales) = (system.states(), system.scales());
        self.sound = Some((cycle.end, cycle.branch[1]));
        self.entry = Some(cycle.branch[1]);
        // Where the transient has been followed into rest (shakedown), what the cycle leaves open stays where it came
        // to rest.
        let settled = self.transient.1 > FIRST_TRANSIENT && system.can_rest();
        let (mut residual, jacobian) = defect(system, &self.start, &cycle, settled);
        for (r, scale) in residual.iter_mut().zip(&scales) {
            *r /= scale;
        }
        let size = residual.iter().take(n).fold(0.0f64, |m, r| m.max(r.abs()));
        // Large constant states, such as the stretch under a heavy load, are known to rounding only.
        let rounding = self.start.iter().zip(&scales).take(n).fold(0.0f64, |m, (z, scale)| m.max(z.abs() / scale));
        let tolerated = PERIODIC + 1e-15 * rounding;
        // Near the solution, and where nothing pulls towards it, the full accuracy is needed.
        let coarse = self.integrator.coarse;
        // From a first guess far off a first Newton step may lead no nearer, and the second does.
        let steps = self.transient.0 == 0 && self.best.is_finite();
        let far = coarse && !std::mem::replace(&mut self.stepped, steps) && size < FARTHER * self.best;
        self.integrator.coarse = coarse && size > NEAR && (far || size < 0.9 * self.best);
        self.integrator.observe = size < LAST;
        if !coarse && cycle.observed && size < tolerated && closes(system, &self.start, &cycle, tolerated) {
            let multiplier = largest_multiplier(system, &cycle);
            let (start, entry, cycles) = (self.start, cycle.branch[0], self.cycles);
            return Some(Periodic { start, entry, cycle, cycles, residual: size, multiplier });
        }
        if self.transient.0 == 0 && size > 0.9 * self.best && !far {
            self.follow_transient();
        }
        if self.transient.0 > 0 {
            self.transient.0 -= 1;
            self.start = cycle.end;
            return None;
        }
        // Coarse and fine cycles differ by more than their defects near the solution.
        self.best = match (coarse && !self.integrator.coarse, far) {
            (true, _) => f64::INFINITY,
            (false, true) => size,
            (false, false) => self.best.min(size),
        };
        let before = std::mem::replace(&mut self.before, size);
        let matrix = std::array::from_fn(|i| std::array::from_fn(|j| jacobian[i][j] * scales[j] / scales[i]));
        let Some(delta) = dense::solve(n, matrix, residual.map(|r| -r)) else {
            self.start = cycle.end;
            return None;
        };
        self.newton(cycle, &delta, (before, size), coarse)
    }

    /// Takes a Newton step `delta`, relative to the scales, from a cycle that changes by `size`, the one before by
    /// `before`; the solution, where the step leaves nothing.
    fn newton(
        &mut self,
        mut cycle: Cycle,
        delta: &State,
        (before, size): (f64, f64),
        coarse: bool,
    ) -> Option<Periodic> {
        let system = self.integrator.system();
        let (n, scales) = (system.states(), system.scales());
        let step = delta.iter().take(n).fold(0.0f64, |most, d| most.max(d.abs()));
        let delta: State = std::array::from_fn(|i| delta[i] * scales[i]);
        for i in 0..n {
            self.start[i] += delta[i];
        }
        // Newton's method squares the error: where that leaves nothing, the cycle need not be integrated again.
        let ratio = if before.is_finite() { size / before } else { 1.0 };
        let left = size * ratio * ratio;
        let last = !coarse
            && !self.integrator.measures_order()
            && cycle.observed
            && size < SQUARED
            && (cycle.segments == 0 || step < STEP_WITHOUT_MEAN)
            && left < self.integrator.left()
            && same_branch(system, &cycle);
        if !last {
            return None;
        }
        let multiplier = largest_multiplier(system, &cycle);
        cycle.shift(n, &delta);
        let (start, entry, cycles) = (self.start, cycle.branch[1], self.cycles);
        Some(Periodic { start, entry, cycle, cycles, residual: left, multiplier })
    }
}

/// Whether a cycle ends on the branch on which it began, and, where it cannot be one of rest, in the states in which it
/// began.
fn closes(system: &dyn HybridSystem, start: &State, cycle: &Cycle, tolerated: f64) -> bool {
    let scales = system.scales();
    let states = system.can_rest()
        || (0..system.states()).all(|i| (cycle.end[i] - start[i]).abs() < 10.0 * tolerated * scales[i]);
    states && same_branch(system, cycle)
}

/// Whether a cycle ends on the branch on which it began.
fn same_branch(system: &dyn HybridSystem, cycle: &Cycle) -> bool {
    let [(first, before), (last, after)] = cycle.branch;
    // Where a change of mode falls on the end of the cycle the slip rate tells.
    (first == last || (before - after).abs() < SAME_SLIP * system.slip_scale())
        && (before - after).abs() < SAME_SLIP * (system.slip_scale() + before.abs())
}

/// Defect of periodicity and its Jacobian; states that a cycle without slip leaves open take their value at rest.
fn defect(system: &dyn HybridSystem, start: &State, cycle: &Cycle, settled: bool) -> (State, [State; MAX_STATES]) {
    let n = system.states();
    let mut residual: State = std::array::from_fn(|i| cycle.end[i] - start[i]);
    let mut jacobian = cycle.monodromy;
    for (i, row) in jacobian.iter_mut().enumerate() {
        row[i] -= 1.0;
    }
    if cycle.stick_fraction > 1.0 - 1e-9 {
        for (i, rest) in system.resting_state(start).iter().enumerate().take(n) {
            if let Some((value, gradient)) = rest {
                residual[i] = if settled { 0.0 } else { *value };
                jacobian[i] = *gradient;
            }
        }
    }
    (residual, jacobian)
}

/// Spectral radius of the monodromy matrix.
fn largest_multiplier(system: &dyn HybridSystem, cycle: &Cycle) -> f64 {
    let n = system.states();
    let scales = system.scales();
    let open = open(system, &cycle.end, cycle);
    let kept: Vec<usize> = (0..n).filter(|&i| !open[i]).collect();
    let count = kept.len();
    let mut matrix = [[0.0; MAX_STATES]; MAX_STATES];
    for (row, &i) in matrix.iter_mut().zip(&kept) {
        for (entry, &j) in row.iter_mut().zip(&kept) {
            *entry = cycle.monodromy[i][j] * scales[j] / scales[i];
        }
    }
    dense::spectral_radius(count, matrix)
}

/// Derivative of the fundamental by each parameter column: at a fixed start plus through the start.
pub fn column_derivatives(integrator: &mut Integrator, periodic: &Periodic) -> Result<Vec<(f64, f64)>, String> {
    let (system, start) = (integrator.system(), &periodic.start);
    integrator.columns(start, periodic.entry, |cycle| {
        let (_, jacobian) = defect(system, start, cycle, false);
        (jacobian, open(system, start, cycle))
    })
}

/// The states that a cycle without slip leaves open.
fn open(system: &dyn HybridSystem, z: &State, cycle: &Cycle) -> [bool; MAX_STATES] {
    if cycle.stick_fraction > 1.0 - 1e-9 {
        system.resting_state(z).map(|rest| rest.is_some())
    } else {
        [false; MAX_STATES]
    }
}

/// Samples a periodic solution: calls back with every step of its cycle.
pub fn trace(
    system: &dyn HybridSystem,
    periodic: &Periodic,
    tolerance: &Tolerance,
    recorder: &mut dyn FnMut(&Record),
) -> Result<(), String> {
    Integrator::new(system, tolerance).trace(&periodic.start, Some(periodic.entry), recorder)
}
