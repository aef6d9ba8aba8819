//! Where a mode ends within a step: the event function on the polynomial through its start and its stages.

use super::dense::{Matrix, identity};
use super::radau::{C, State, Stepper};
use crate::model::system::{Forcing, HybridSystem, MAX_STATES, Mode};

/// Largest deviation of the event function from its polynomial over a step, relative to its own size: with more, a
/// crossing could not be told from a wiggle of the polynomial.
pub const EVENT_ROUGHNESS: f64 = 0.03;

/// Event values at the end of a step that count as zero there, at the default tolerance: the states depend on the time
/// of an event in second order.
pub const LOCATED: f64 = 1e-8;
/// The largest at any tolerance: a mode may begin as far below zero.
pub const LOOSEST_LOCATED: f64 = 0.5e-6;
/// Fraction of a step by which an event may lie off its end to be found by the slope there.
const NEAR_EVENT: f64 = 0.05;
/// Event values below this count as crossed.
const CROSSED: f64 = -1e-11;
/// Largest event value below zero at which a mode may begin: the change to it was located to rounding, and what is
/// little for the slip rate is more for the force on a stiff contact.
const BEGUN: f64 = -1e-6;
/// Shortest share of a step in which a mode that has just begun is seen to rise.
const BRIEF: f64 = 1e-6;
/// Relative change of a step, in periods, at which its end is known to rounding.
const ROUNDING: f64 = 1e-13;
/// Steps tried to find the end of a mode, ...
const TRIALS: usize = 80;
/// ... and from which of them on every other one halves what is left: where friction has a kink no polynomial leads
/// there.
const SMOOTH_TRIALS: usize = 8;
/// Fractions of a step at which the interpolated event function is looked at.
const LOOKS: [f64; 12] = [0.02, 0.05, 0.1, C[0], 0.25, 0.35, 0.45, 0.55, C[1], 0.75, 0.88, 1.0];

/// Where a mode that is followed approximately ends.
#[derive(Debug, Clone, Copy)]
pub struct Approximation {
    /// Time \[s\].
    pub time: f64,
    /// States.
    pub state: State,
    /// Algebraic unknown.
    pub slip: f64,
    /// Whether the mode ended there.
    pub ended: bool,
}

/// A point of an orbit that is followed from event to event.
#[derive(Debug, Clone)]
pub struct Jump {
    /// Time \[s\].
    pub time: f64,
    /// States.
    pub state: State,
    /// Algebraic unknown.
    pub slip: f64,
    /// Derivative of the states by those at the start of the cycle, in units of their scales.
    pub through: Matrix,
    /// The smaller margin of the mode that led here.
    pub margin: f64,
    /// Its rate of change \[1/s\].
    pub rate: f64,
    /// Its derivatives by the states at the start of the cycle, in units of their scales.
    pub margin_by_start: State,
}

impl Jump {
    /// The start of a cycle.
    pub fn new(state: State) -> Self {
        let none = [0.0; MAX_STATES];
        Self { time: 0.0, state, slip: 0.0, through: identity(), margin: 0.0, rate: 0.0, margin_by_start: none }
    }
}

/// Value below which the event function has fallen through zero: a mode that begins a rounding below zero has not
/// ended.
fn floor(start: f64) -> f64 {
    CROSSED + start.clamp(BEGUN, 0.0)
}

/// Where the interpolated event function is looked at. A mode that begins at zero and has risen by the first stage has
/// not ended before it: where it rises ever faster the cubic undershoots there.
fn looks(start: f64, e: [f64; 3]) -> &'static [f64] {
    if start.abs() < -BEGUN && e[0] > 0.0 { &LOOKS[3..] } else { &LOOKS }
}

/// Whether the event function falls below zero during the step, between the stages included.
pub fn crosses(start: f64, e: [f64; 3]) -> bool {
    let floor = floor(start);
    e.iter().any(|&e| e < floor)
        || (e.iter().any(|&e| e < 0.1) && {
            let cubic = Cubic::through(start, e);
            looks(start, e).iter().any(|&tau| cubic.at(tau) < floor)
        })
}

/// Fraction of the step at which the event function first falls to zero.
fn first_root(start: f64, e: [f64; 3]) -> f64 {
    let cubic = Cubic::through(start, e);
    let (mut low, mut high) = (0.0, 1.0);
    for &tau in looks(start, e) {
        if cubic.at(tau) < floor(start) {
            high = tau;
            break;
        }
        low = tau;
    }
    if cubic.at(low) <= 0.0 {
        low = rising(high, |tau| cubic.at(tau));
    }
    // Newton's method, kept within the bracket.
    let mut tau = 0.5 * (low + high);
    for _ in 0..60 {
        let value = cubic.at(tau);
        if value > 0.0 {
            low = tau
        } else {
            high = tau
        }
        let next = tau - value / cubic.slope(tau);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - tau).abs() < 1e-15 {
            return next;
        }
        tau = next;
    }
    tau
}

/// Event function at the stages of the step just taken.
pub fn at_stages(system: &dyn HybridSystem, stepper: &Stepper, mode: Mode) -> [f64; 3] {
    std::array::from_fn(|i| system.event(&stepper.forcing[i], &stepper.z[i], stepper.s[i], mode))
}

/// Where a step begins.
pub struct Start<'a> {
    /// The system.
    pub system: &'a dyn HybridSystem,
    /// Time \[s\].
    pub time: f64,
    /// The forcing.
    pub forcing: &'a Forcing,
    /// States.
    pub z: &'a State,
    /// Algebraic unknown.
    pub slip: f64,
    /// Mode.
    pub mode: Mode,
    /// Event function.
    pub event: f64,
}

/// A step that was shortened.
pub struct Shorter {
    /// Its size \[s\].
    pub size: f64,
    /// Whether the mode ends with it.
    pub ended: bool,
}

impl Start<'_> {
    fn step(&self, stepper: &mut Stepper, size: f64) -> Result<[f64; 3], String> {
        if stepper.step(self.system, self.forcing, self.z, self.slip, size, self.mode, false) {
            return Ok(at_stages(self.system, stepper, self.mode));
        }
        Err(self.lost())
    }

    /// Whether the event function has fallen through zero by one of the stages. One that begins a rounding below zero
    /// has to rise first.
    fn ended(&self, e: [f64; 3]) -> bool {
        let mut risen = self.event > 0.0;
        for e in e {
            if risen && e <= 0.0 {
                return true;
            }
            risen |= e > 0.0;
        }
        !risen && e[2] <= self.event
    }

    fn lost(&self) -> String {
        format!("an event at {:.4} of the cycle could not be located", self.time / self.system.period())
    }

    /// Shortens a step just taken, over which the event function crosses zero, to the place where it does, within
    /// `located`.
    pub fn shorten(&self, stepper: &mut Stepper, full: f64, mut e: [f64; 3], located: f64) -> Result<Shorter, String> {
        let mut size = full;
        // A mode that has just begun may end long before the first stage: the force of a stiff contact turns from one
        // limit to the other. Shorter steps see the event function rise, or find that it does not.
        while self.event < located && e.iter().all(|&e| e < located) && size > BRIEF * full {
            size *= 0.25;
            e = self.step(stepper, size)?;
            if !crosses(self.event, e) {
                return Ok(Shorter { size, ended: false });
            }
        }
        let mut tau = first_root(self.event, e);
        let mut before: Option<(f64, f64)> = None;
        // Sizes between which the place lies, as far as they are known.
        let (mut low, mut high) = (0.0, if self.ended(e) { size } else { f64::INFINITY });
        for number in 0..TRIALS {
            let mut trial = (size * tau).max(1e-14 * full);
            let outside = trial <= low || trial >= high || (number >= SMOOTH_TRIALS && number % 2 == 0);
            if high.is_finite() && outside {
                trial = 0.5 * (low + high);
            }
            e = self.step(stepper, trial)?;
            if self.ended(e) {
                high = f64::min(high, trial);
            } else {
                low = f64::max(low, trial);
            }
            let changed = (trial - size).abs();
            size = trial;
            if e[2].abs() < located || changed < ROUNDING * self.system.period() {
                return Ok(Shorter { size, ended: true });
            }
            // Close to the end it is found by the slope there, whichever side it lies on. The slope between two ends
            // serves also where friction has a kink at rest.
            let slope = match before {
                Some((size_before, end)) => (e[2] - end) / (size - size_before) * size,
                None => end_slope(self.event, e),
            };
            before = Some((size, e[2]));
            let shift = -e[2] / slope;
            tau = if shift.abs() < NEAR_EVENT {
                1.0 + shift
            } else if e.iter().all(|&e| e > 0.0) {
                if shift > 0.0 { 1.0 + shift.min(0.5) } else { 1.5 }
            } else {
                first_root(self.event, e)
            };
        }
        Err(self.lost())
    }
}

/// A place before `high`, where the function is negative, at which it is positive: it begins at zero, give or take a
/// rounding, and the root there is not where it falls. Zero where it does not rise.
pub(super) fn rising(high: f64, value: impl Fn(f64) -> f64) -> f64 {
    (1..50).map(|k| high * 0.5f64.powi(k)).find(|&at| value(at) > 0.0).unwrap_or(0.0)
}

/// Slope of the event function at the end of the step, per step.
fn end_slope(start: f64, e: [f64; 3]) -> f64 {
    Cubic::through(start, e).slope(1.0)
}

/// The cubic through the start and the stages of a step, by Newton's divided differences.
struct Cubic([f64; 4]);

impl Cubic {
    fn through(start: f64, e: [f64; 3]) -> Self {
        let first = [(e[0] - start) / C[0], (e[1] - e[0]) / (C[1] - C[0]), (e[2] - e[1]) / (C[2] - C[1])];
        let second = [(first[1] - first[0]) / C[1], (first[2] - first[1]) / (C[2] - C[0])];
        Self([start, first[0], second[0], (second[1] - second[0]) / C[2]])
    }

    fn at(&self, tau: f64) -> f64 {
        let [a, b, c, d] = self.0;
        a + tau * (b + (tau - C[0]) * (c + (tau - C[1]) * d))
    }

    fn slope(&self, tau: f64) -> f64 {
        let [_, b, c, d] = self.0;
        let (p, q) = (tau - C[0], tau - C[1]);
        b + (tau + p) * c + (p * q + tau * q + tau * p) * d
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_two_roots_between_the_stages_is_found() {
        let f = |t: f64| (t - 0.2) * (t - 0.5) * (3.0 - t);
        let e = C.map(f);
        assert!(crosses(f(0.0), e));
        assert!((first_root(f(0.0), e) - 0.2).abs() < 1e-13);
        assert!((end_slope(f(0.0), e) - (0.5 * 2.0 + 0.8 * 2.0 - 0.8 * 0.5)).abs() < 1e-12);
    }

    #[test]
    fn a_mode_that_begins_and_rises_ever_faster_has_not_ended() {
        // Slip rates of a contact whose friction rises with the logarithm of the slip rate.
        let rising = [0.0027, 0.0883, 0.2419];
        assert!(Cubic::through(0.0, rising).at(LOOKS[0]) < CROSSED);
        assert!(!crosses(0.0, rising));
        assert!(crosses(0.0, [rising[0], rising[1], -1e-9]));
    }

    #[test]
    fn a_mode_that_begins_a_rounding_below_zero_goes_on_only_if_it_rises() {
        for (slope, ends) in [(1.0, false), (-1.0, true)] {
            let f = |t: f64| -1e-8 + slope * t;
            assert_eq!(crosses(f(0.0), C.map(f)), ends);
        }
    }

    #[test]
    fn the_root_at_which_a_mode_begins_is_not_where_it_ends() {
        let f = |t: f64| -1e-15 + t * (1e-3 - t);
        assert!(crosses(f(0.0), C.map(f)));
        assert!((first_root(f(0.0), C.map(f)) - 1e-3).abs() < 1e-9);
    }
}
