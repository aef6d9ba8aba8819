//! A start close to a periodic orbit of affine modes: Newton's method from event to event.
//!
//! A few cycles of long steps show which modes follow one another. Unknown are then the states at the start and the
//! times of the events; the flows between them are exponentials. Since the rates of the states are continuous at an
//! event, the states at the end of the cycle depend on the times of the events in second order only, and the equations
//! fall apart: first the start, then the times. Nothing is looked at between the events; the cycle that follows the
//! prediction does that.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::cycle::Integrator;
use super::dense;
use super::events::Jump;
use super::period::Start;
use super::radau::State;
use crate::model::system::{MAX_STATES, Mode};

/// Cycles of long steps from a cold start, and from a neighbouring problem.
const APPROXIMATE_CYCLES: [usize; 2] = [2, 1];
/// How often Newton's method is tried, each time from later in the transient.
const ATTEMPTS: usize = 4;
/// Phase by which the time of an event may be moved in a Newton step method; more means that it is far off \[rad\].
const FAR: f64 = 1.0;
/// Most stretches of one mode in a cycle.
const MAX_STRETCHES: usize = 12;
/// Most Newton steps.
const MAX_ROUNDS: usize = 12;
/// Relative error of states and times that may be left.
const LEFT: f64 = 1e-12;

/// A stretch of the orbit that is looked for.
#[derive(Clone, Copy)]
struct Piece {
    mode: Mode,
    flow: usize,
    end: f64,
}

impl Integrator<'_> {
    /// A start close to the periodic orbit; `None` where a mode is not affine, nothing slips, or Newton's method fails.
    /// Says also how many cycles the search amounts to.
    pub fn predict(&mut self, guess: Option<&Start>) -> Option<(Start, usize)> {
        let system = self.system();
        let (mut start, mut entry) = match guess {
            Some(guess) => (guess.0, Some(guess.1)),
            None => (system.initial_state(), None),
        };
        let rounds = APPROXIMATE_CYCLES[usize::from(guess.is_some())];
        let mut pieces = Vec::with_capacity(MAX_STRETCHES);
        let mut cycles = 0;
        for _ in 0..ATTEMPTS {
            for _ in 0..rounds {
                entry = Some(self.approximate_cycle(&mut start, entry, &mut pieces)?);
                cycles += 1;
            }
            let (first, last) = (pieces.first()?, pieces.last()?);
            if pieces.iter().all(|piece| piece.mode == Mode::Stick) {
                return None;
            }
            if first.mode == last.mode {
                let (found, rounds) = self.newton(start, &mut pieces);
                cycles += rounds;
                if let Some(start) = found {
                    return Some((start, cycles));
                }
            }
        }
        None
    }

    /// Follows a cycle in long steps; gathers its stretches and leaves its end.
    fn approximate_cycle(
        &mut self,
        z: &mut State,
        entry: Option<(Mode, f64)>,
        pieces: &mut Vec<Piece>,
    ) -> Option<(Mode, f64)> {
        let system = self.system();
        let period = system.period();
        pieces.clear();
        let forcing = system.forcing(0.0);
        system.project(&forcing, z);
        let (mut mode, _) = system.enter(&forcing, z, entry);
        let mut time = 0.0;
        while pieces.len() < MAX_STRETCHES {
            let index = self.known(mode)?;
            let seen = self.flow_at(index)?.approximate_segment(time, z, period);
            pieces.push(Piece { mode, flow: index, end: seen.time });
            (time, *z) = (seen.time, seen.state);
            if !seen.ended {
                return z.iter().all(|z| z.is_finite()).then_some((mode, seen.slip));
            }
            (mode, _) = system.next_mode(&system.forcing(time), z, seen.slip, mode);
        }
        None
    }

    /// Newton's method for the start and the times of the events: the start and the
    /// steps taken.
    fn newton(&self, mut start: State, pieces: &mut [Piece]) -> (Option<Start>, usize) {
        let system = self.system();
        let (n, scales, period) = (system.states(), system.scales(), system.period());
        let omega = std::f64::consts::TAU / period;
        let events = pieces.len() - 1;
        let mut before = f64::INFINITY;
        for round in 1..=MAX_ROUNDS {
            let failed = (None, round);
            let mut at = Jump::new(start);
            let mut ends = [(0.0, 0.0, [0.0; MAX_STATES]); MAX_STRETCHES];
            for (piece, end) in pieces.iter().zip(&mut ends) {
                if let Some(flow) = self.flow_at(piece.flow) {
                    flow.jump(&mut at, piece.end);
                }
                *end = (at.margin, at.rate, at.margin_by_start);
            }
            let mut matrix = at.through;
            for (i, row) in matrix.iter_mut().enumerate() {
                row[i] -= 1.0;
            }
            let z = at.state;
            let residual = std::array::from_fn(|i| (start[i] - z[i]) / scales[i]);
            let Some(delta) = dense::solve(n, matrix, residual) else { return failed };
            let mut size = 0.0f64;
            for i in 0..n {
                start[i] += delta[i] * scales[i];
                size = size.max(delta[i].abs());
            }
            let mut time = -period;
            for (piece, (margin, rate, by_start)) in pieces.iter_mut().zip(&ends).take(events) {
                let moved: f64 = (0..n).map(|j| by_start[j] * delta[j]).sum();
                let shift = -(margin + moved) / rate;
                piece.end += shift;
                size = size.max(omega * shift.abs());
                if !(piece.end > time && omega * shift.abs() < FAR) {
                    return failed;
                }
                time = piece.end;
            }
            if time > pieces[0].end + period {
                return failed;
            }
            let ratio = if before.is_finite() { size / before } else { 1.0 };
            if size * ratio * ratio < LEFT {
                return (self.start(start, at.slip, pieces), round);
            }
            if !size.is_finite() || (round > 3 && ratio > 1.0) {
                return failed;
            }
            before = size;
        }
        (None, MAX_ROUNDS)
    }

    /// The start that was found. Where an event has moved across the ends of the cycle, the states found belong to the
    /// mode beyond it: they are taken back to the event and on from there in the mode that holds at time 0.
    fn start(&self, start: State, slip: f64, pieces: &[Piece]) -> Option<Start> {
        let period = self.system().period();
        let [first, .., before, last] = pieces else { return Some((start, (pieces[0].mode, slip))) };
        let (event, holds) = if first.end < 0.0 {
            (first.end, &pieces[1])
        } else if before.end > period {
            (before.end - period, before)
        } else {
            return Some((start, (first.mode, slip)));
        };
        let mut at = Jump::new(start);
        self.flow_at(last.flow)?.jump(&mut at, event);
        self.flow_at(holds.flow)?.jump(&mut at, 0.0);
        Some((at.state, (holds.mode, at.slip)))
    }
}
