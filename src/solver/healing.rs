//! Whether a contact over a roller at rest heals until it rests for ever, or slips on at an age that slip keeps in
//! balance.
//!
//! The age psi changes little in a cycle, the other states settle in few. Followed in time the contact thus heals for
//! tens or hundreds of cycles. Here the age is an unknown that is held while Newton's method settles the others; what
//! is left is a drift D(psi) of the age per cycle and its slope. The slip of a cycle falls about as the logarithm of
//! the age, so that D = T - psi S(psi)/D_c is convex: it has a zero, where the contact slips for ever, or a lowest
//! value above zero. Newton's method for D = 0 from ages below does not pass a zero of a convex function; where it
//! comes to ages at which the drift is positive and grows, there is none, and the contact rests in the end.

use super::cycle::Integrator;
use super::dense::{self, Matrix};
use super::period::Start;
use super::radau::State;
use crate::model::system::Mode;

/// How healing ends.
#[derive(Debug)]
pub enum Healed {
    /// At rest for ever.
    Rests,
    /// In a periodic motion near this start.
    Slips(Start),
    /// Nobody knows: it came to this start.
    Undecided(Start),
}

/// Change of the settled states over a cycle, relative to their scales, below which the drift of the age is known.
const SETTLED: f64 = 1e-2;
/// Most cycles.
const MAX_CYCLES: usize = 30;
/// Largest factor by which a step makes the contact younger.
const FAR: f64 = 4.0;
/// Relative step of the age below which the ordinary search takes over.
const NEAR: f64 = 0.03;

/// Newton's equations of the other states with the age held, in units of the scales.
struct Held {
    states: usize,
    age: usize,
    matrix: Matrix,
    /// Their right side for a change of the age by one.
    by_age: State,
    /// Derivatives of the drift of the age by all states.
    drift_by: State,
}

impl Held {
    fn new(monodromy: Matrix, scales: &State, (states, age): (usize, usize)) -> Self {
        let mut matrix = monodromy;
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = (*entry * scales[j] / scales[i]) - f64::from(i == j);
            }
        }
        let drift_by = matrix[age];
        let by_age: State = std::array::from_fn(|i| if i == age { 1.0 } else { -matrix[i][age] });
        for (i, row) in matrix.iter_mut().enumerate() {
            row[age] = f64::from(i == age);
        }
        matrix[age] = std::array::from_fn(|j| f64::from(j == age));
        Self { states, age, matrix, by_age, drift_by }
    }

    /// What the other states have to change by for a cycle to end where it began.
    fn settle(&self, residual: &State) -> Option<State> {
        let right = std::array::from_fn(|i| if i == self.age { 0.0 } else { -residual[i] });
        dense::solve(self.states, self.matrix, right)
    }

    /// How the settled states change with the age.
    fn answer_to_age(&self) -> Option<State> {
        dense::solve(self.states, self.matrix, self.by_age)
    }

    /// Change of the drift with such a change of the states.
    fn drift_along(&self, delta: &State) -> f64 {
        (0..self.states).map(|j| self.drift_by[j] * delta[j]).sum()
    }
}

/// Follows the age from `start` on and adds the cycles that takes to `cycles`; `None` where the contact does not heal,
/// or a cycle cannot be followed.
pub fn heal(integrator: &mut Integrator, start: &State, cycles: &mut usize) -> Option<Healed> {
    let system = integrator.system();
    let age = system.age_at_rest()?;
    let (n, scales) = (system.states(), system.scales());
    let mut start = *start;
    let (mut entry, mut last, mut before): (Option<(Mode, f64)>, _, _) = (None, None, f64::INFINITY);
    let most = MAX_CYCLES.min(integrator.tolerance().cycles / 2);
    for _ in 0..most {
        *cycles += 1;
        let cycle = integrator.cycle(&start, entry).ok()?;
        entry = Some(cycle.branch[1]);
        last = Some((cycle.end, cycle.branch[1]));
        if cycle.stick_fraction > 1.0 - 1e-9 {
            if system.locks(&cycle.end) {
                return Some(Healed::Rests);
            }
            start = cycle.end;
            continue;
        }
        let residual: State = std::array::from_fn(|i| (cycle.end[i] - start[i]) / scales[i]);
        let held = Held::new(cycle.monodromy, &scales, (n, age));
        let mut settle = held.settle(&residual)?;
        let size = (0..n).filter(|&i| i != age).fold(0.0f64, |most, i| most.max(residual[i].abs()));
        if size < SETTLED {
            let answer = held.answer_to_age()?;
            let (drift, slope) = (residual[age] + held.drift_along(&settle), held.drift_along(&answer));
            if drift > 0.0 && slope >= 0.0 {
                return Some(Healed::Rests);
            }
            let now = start[age] / scales[age];
            let next = if slope < 0.0 { now - drift / slope } else { 0.0 };
            let mut aged = start;
            aged[age] = scales[age] * next;
            if drift > 0.0 && system.locks(&aged) {
                return Some(Healed::Rests);
            }
            let step = next.max(now / FAR) - now;
            for i in 0..n {
                start[i] += scales[i] * (settle[i] + step * answer[i]);
            }
            if (next - now).abs() < NEAR * now {
                return Some(Healed::Slips((start, cycle.branch[0])));
            }
            before = f64::INFINITY;
            continue;
        }
        // Newton's method where it helps, the transient at this age where it does not.
        if size > before {
            settle = std::array::from_fn(|i| if i == age { 0.0 } else { residual[i] });
            before = f64::INFINITY;
        } else {
            before = size;
        }
        for i in 0..n {
            start[i] += scales[i] * settle[i];
        }
    }
    last.map(Healed::Undecided)
}
