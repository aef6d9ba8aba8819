//! The exact flow of a mode whose equations are affine: z' = M z + m + (terms in sin wt and cos wt).
//!
//! With the particular solution p(t) = ps sin wt + pc cos wt the rest y = z - p obeys y' = M y + m, whose maps over a
//! step and its halves are computed once. The margins of the mode are sampled once a step, with their slopes; an end of
//! the mode is located on the power series of y. Of a whole stretch only the exponential is formed; the fundamental
//! follows from the states at its ends, since (iw - M) int y e^{-iwt} dt = -[y e^{-iwt}] + m int e^{-iwt} dt.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::cubic::{between, crossing, cubic, turning_point};
use super::dense::Matrix;
use super::eliminated::Eliminated;
use super::events::{Approximation, Jump, rising};
use super::exponential::{Map, Square, apply, dot, exponential, multiply, norm};
use super::harmonic::{Complex, particular, products, resolvent};
use super::radau::State;
use super::sensitivity::{Equations, Gradient, Stretch, gather};
use crate::model::system::{Forcing, HybridSystem, MAX_STATES, Mode};

/// Norm of M t up to which the power series of y is summed.
const SERIES: f64 = 2.0;
/// Terms of that series: what is left out is 2^22/22! = 4e-15.
const TERMS: usize = 22;
/// Margins below this count as crossed.
const CROSSED: f64 = -1e-11;

/// What a stretch of one mode leaves behind.
#[derive(Debug, Clone)]
pub struct Segment {
    /// Time at the end \[s\].
    pub time: f64,
    /// States at the end.
    pub state: State,
    /// Algebraic unknown at the end.
    pub slip: f64,
    /// Whether the mode ended there.
    pub ended: bool,
    /// Derivative of the states at the end by those at the start.
    pub transition: Matrix,
    /// Part of the fundamental of state 0.
    pub fundamental: Complex,
    /// Its derivatives by the states at the start.
    pub fundamental_by_start: [Complex; MAX_STATES],
    /// Whether what follows was gathered.
    pub observed: bool,
    /// Part of the mean of state 0.
    pub mean: f64,
    /// Extremes of the force.
    pub force: (f64, f64),
}

/// The flow of one mode, whatever the number of states.
pub trait Flow {
    /// Follows the mode from a state at a time to its end, or to the end of the period; the fundamental is that of
    /// state 0 less `offset`. Mean and force are gathered where they are to be observed.
    fn segment(&self, start: f64, z: &State, period: f64, offset: f64, observe: bool) -> Segment;
    /// Follows the mode in whole steps; its end is known to a polynomial between them.
    fn approximate_segment(&self, start: f64, z: &State, period: f64) -> Approximation;
    /// Continues an orbit in the mode to a stated time, whatever its margins.
    fn jump(&self, at: &mut Jump, end: f64);
    /// Adds the derivatives of an output by the coefficients of the equations over a stretch; see [`super::sensitivity`].
    fn gather(&self, stretch: &Stretch, into: &mut Gradient);
}

/// a y + constant + sine sin wt + cosine cos wt, and the same for its slope.
#[derive(Debug, Clone, Copy)]
struct Reading<const N: usize> {
    a: [f64; N],
    constant: f64,
    sine: f64,
    cosine: f64,
    slope_a: [f64; N],
    slope_constant: f64,
    omega: f64,
}

impl<const N: usize> Reading<N> {
    #[inline]
    fn value(&self, y: &[f64; N], (sine, cosine): (f64, f64)) -> f64 {
        dot(&self.a, y) + self.constant + self.sine * sine + self.cosine * cosine
    }
    #[inline]
    fn slope(&self, y: &[f64; N], (sine, cosine): (f64, f64)) -> f64 {
        dot(&self.slope_a, y) + self.slope_constant + self.omega * (self.sine * cosine - self.cosine * sine)
    }
}

/// The flow of one mode of a system of N states, in units of their scales.
pub struct Affine<const N: usize> {
    equations: Equations<N>,
    step: f64,
    rotation: (f64, f64),
    ladder: Vec<Map<N>>,
    dense: usize,
    slip: Reading<N>,
    margins: [Reading<N>; 2],
    two_margins: bool,
    force: Reading<N>,
    angle: Reading<N>,
}

/// The flow of a mode that is affine altogether; `None` for another one or where it cannot be followed.
pub fn flow(system: &dyn HybridSystem, mode: Mode, steps: usize) -> Option<Box<dyn Flow>> {
    if !system.affine(mode).all() {
        return None;
    }
    macro_rules! of {
        ($n:literal) => {
            Affine::<$n>::new(system, mode, steps).map(|flow| Box::new(flow) as Box<dyn Flow>)
        };
    }
    match system.states() {
        3 => of!(3),
        4 => of!(4),
        5 => of!(5),
        6 => of!(6),
        _ => None,
    }
}

impl<const N: usize> Affine<N> {
    fn new(system: &dyn HybridSystem, mode: Mode, steps: usize) -> Option<Self> {
        let equations = Eliminated::new(system, mode)?;
        let (e, all_scales) = (&equations.base, system.scales());
        let scales: [f64; N] = std::array::from_fn(|i| all_scales[i]);
        let through: [f64; N] = std::array::from_fn(|i| e.fs[i] / e.gs);
        let m: Square<N> = std::array::from_fn(|i| {
            std::array::from_fn(|j| (e.fz[i][j] - through[i] * e.gz[j]) * scales[j] / scales[i])
        });
        let constant: [f64; N] = std::array::from_fn(|i| (e.f[i] - through[i] * e.g) / scales[i]);
        let forced: [[f64; N]; 2] = std::array::from_fn(|part| {
            let (f, g) = &equations.forced[part];
            std::array::from_fn(|i| (f[i] - through[i] * g) / scales[i])
        });
        let period = system.period();
        let omega = std::f64::consts::TAU / period;
        let resolvent = resolvent(&m, omega)?;
        let particular = particular(&resolvent, &forced);
        let step = period / steps as f64;
        let ladder = Map::ladder(&m, &constant, step)?;
        let size = norm(&m) * step;
        let dense = (0..ladder.len()).find(|&k| size <= SERIES * (1u64 << k) as f64).unwrap_or(ladder.len() - 1);
        // Readings by probing: each is affine in states and forcing.
        let crests = [system.forcing(0.25 * period), system.forcing(0.0)];
        let probe = |value: &dyn Fn(&Forcing, &State, f64) -> f64| {
            let zero = [0.0; MAX_STATES];
            let base = value(&Forcing::default(), &zero, equations.slip(&zero, [1.0, 0.0, 0.0]));
            let sine = value(&crests[0], &zero, equations.slip(&zero, [1.0, 1.0, 0.0])) - base;
            let cosine = value(&crests[1], &zero, equations.slip(&zero, [1.0, 0.0, 1.0])) - base;
            let a: [f64; N] = std::array::from_fn(|i| {
                let mut z = zero;
                z[i] = scales[i];
                value(&Forcing::default(), &z, equations.slip(&z, [1.0, 0.0, 0.0])) - base
            });
            Reading {
                a,
                constant: base,
                sine: sine + dot(&a, &particular[0]),
                cosine: cosine + dot(&a, &particular[1]),
                slope_a: std::array::from_fn(|j| (0..N).map(|i| a[i] * m[i][j]).sum()),
                slope_constant: dot(&a, &constant),
                omega,
            }
        };
        let margins = [0, 1].map(|j| probe(&|forcing, z, s| system.margins(forcing, z, s, mode)[j]));
        let two_margins = margins[0].a != margins[1].a || margins[0].constant != margins[1].constant;
        let flow = Self {
            equations: Equations { omega, scales, m, constant, particular, resolvent },
            step,
            rotation: (omega * step).sin_cos(),
            ladder,
            dense,
            slip: probe(&|_, _, s| s),
            margins,
            two_margins,
            force: probe(&|forcing, z, s| system.force(forcing, z, s).0),
            angle: probe(&|_, z, _| z[0]),
        };
        Some(flow)
    }

    /// The margins that differ.
    #[inline]
    fn margins(&self) -> &[Reading<N>] {
        &self.margins[..if self.two_margins { 2 } else { 1 }]
    }

    #[inline]
    fn margins_at(&self, at: &Sample<N>) -> [f64; 2] {
        let mut values = [0.0; 2];
        for (value, margin) in values.iter_mut().zip(self.margins()) {
            *value = margin.value(&at.y, at.turn);
        }
        values
    }

    /// Sine and cosine of the phase a step later.
    #[inline]
    fn turned(&self, (s0, c0): (f64, f64)) -> (f64, f64) {
        let (s, c) = self.rotation;
        (s0 * c + c0 * s, c0 * c - s0 * s)
    }

    /// y after a part of a step.
    fn after(&self, y: &[f64; N], time: f64) -> [f64; N] {
        let (mut y, mut rest, mut size) = (*y, time, self.step);
        for map in &self.ladder[..self.dense] {
            if rest >= size {
                y = map.apply(&y);
                rest -= size;
            }
            size *= 0.5;
        }
        let series = self.series(&y);
        sum(&series, rest)
    }

    /// Power series of y.
    fn series(&self, y: &[f64; N]) -> [[f64; N]; TERMS] {
        let mut series = [[0.0; N]; TERMS];
        series[0] = *y;
        series[1] = self.equations.rate(y);
        for k in 2..TERMS {
            let next = apply(&self.equations.m, &series[k - 1]);
            let inverse = 1.0 / k as f64;
            series[k] = next.map(|v| v * inverse);
        }
        series
    }

    /// Whether a margin falls below zero on the way between two samples; a dip between them is looked at exactly.
    fn falls(&self, reading: &Reading<N>, from: &Sample<N>, to: &Sample<N>, before: f64, after: f64) -> bool {
        if after < CROSSED {
            return true;
        }
        let size = to.time - from.time;
        let (g0, g1) = (reading.slope(&from.y, from.turn), reading.slope(&to.y, to.turn));
        if g0 >= 0.0 || g1 <= 0.0 {
            return false;
        }
        let (tau, least) = turning_point(before, g0 * size, after, g1 * size);
        // Clearly positive, given the accuracy of a cubic between samples.
        if least > 0.05 * before.abs().max(after.abs()) + 1e-6 {
            return false;
        }
        let turn = (self.equations.omega * (from.time + tau * size)).sin_cos();
        reading.value(&self.after(&from.y, tau * size), turn) < CROSSED
    }

    /// Where a margin that [`Self::falls`] first does so: time after `from` and y there.
    fn root(&self, reading: &Reading<N>, from: &Sample<N>, to: &Sample<N>) -> (f64, [f64; N]) {
        let (mut from, mut to) = (*from, *to);
        // Halve until the power series holds.
        let mut size = self.step;
        for map in &self.ladder[1..=self.dense] {
            size *= 0.5;
            let time = from.time + size;
            if time >= to.time {
                continue;
            }
            let middle = Sample { time, y: map.apply(&from.y), turn: (self.equations.omega * time).sin_cos() };
            let (a, b) = (reading.value(&from.y, from.turn), reading.value(&middle.y, middle.turn));
            if self.falls(reading, &from, &middle, a, b) { to = middle } else { from = middle }
        }
        let series = self.series(&from.y);
        let scalar: [f64; TERMS] = std::array::from_fn(|k| dot(&reading.a, &series[k]));
        let (sine, cosine) = from.turn;
        let value = |d: f64| {
            let (s, c) = (self.equations.omega * d).sin_cos();
            let turn = (sine * c + cosine * s, cosine * c - sine * s);
            let (mut v, mut slope) = (0.0, 0.0);
            for k in (0..TERMS).rev() {
                slope = slope * d + v;
                v = v * d + scalar[k];
            }
            let (x, y) = (reading.sine, reading.cosine);
            (v + reading.constant + x * turn.0 + y * turn.1, slope + self.equations.omega * (x * turn.1 - y * turn.0))
        };
        let (mut low, mut high) = (0.0, to.time - from.time);
        if value(high).0 >= 0.0 {
            // A dip between the samples: its lowest point bounds the root.
            let (f0, f1) = (value(low), value(high));
            high *= turning_point(f0.0, f0.1 * high, f1.0, f1.1 * high).0;
        }
        if value(low).1 > 0.0 {
            low = rising(high, |d| value(d).0);
        }
        let mut d = high;
        for _ in 0..60 {
            let (v, slope) = value(d);
            *(if v > 0.0 { &mut low } else { &mut high }) = d;
            let newton = d - v / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let change = (next - d).abs();
            d = next;
            if change < 1e-13 * self.step {
                break;
            }
        }
        (from.time + d, sum(&series, d))
    }
}

/// A point on the way.
#[derive(Clone, Copy)]
struct Sample<const N: usize> {
    time: f64,
    y: [f64; N],
    turn: (f64, f64),
}

impl<const N: usize> Flow for Affine<N> {
    fn segment(&self, start: f64, z: &State, period: f64, offset: f64, observe: bool) -> Segment {
        let turn = (self.equations.omega * start).sin_cos();
        let first = Sample { time: start, y: self.equations.rest(z, turn), turn };
        let mut from = first;
        let margins = self.margins();
        let mut before = self.margins_at(&from);
        let force_at = |at: &Sample<N>| (self.force.value(&at.y, at.turn), self.force.slope(&at.y, at.turn));
        let angle_at = |at: &Sample<N>| {
            let (bend, turn) = (apply(&self.equations.m, &self.equations.rate(&at.y)), at.turn);
            let [ps, pc] = [self.equations.particular[0][0], self.equations.particular[1][0]];
            let second = bend[0] - self.equations.omega * self.equations.omega * (ps * turn.0 + pc * turn.1);
            (self.angle.value(&at.y, turn), self.angle.slope(&at.y, turn), second * self.equations.scales[0])
        };
        let (mut force, mut angle) = (force_at(&from), angle_at(&from));
        let (mut extremes, mut area, mut ended) = ((force.0, force.0), 0.0, false);
        while !ended && period - from.time > 1e-12 * period {
            let left = period - from.time;
            let mut to = if left >= self.step * (1.0 - 1e-9) {
                let (time, turn) = (from.time + self.step, self.turned(from.turn));
                Sample { time, y: self.ladder[0].apply(&from.y), turn }
            } else {
                Sample { time: period, y: self.after(&from.y, left), turn: (self.equations.omega * period).sin_cos() }
            };
            let mut after = [0.0; 2];
            for (j, margin) in margins.iter().enumerate() {
                after[j] = margin.value(&to.y, to.turn);
                if self.falls(margin, &from, &to, before[j], after[j]) {
                    ended = true;
                    let (time, y) = self.root(margin, &from, &to);
                    to = Sample { time, y, turn: (self.equations.omega * time).sin_cos() };
                }
            }
            if observe {
                let size = to.time - from.time;
                let (next_force, next_angle) = (force_at(&to), angle_at(&to));
                for value in [next_force.0, between(force, next_force, size)] {
                    extremes = (extremes.0.min(value), extremes.1.max(value));
                }
                // The polynomial with these values and first and second slopes at both ends.
                let bend = size / 12.0 * (angle.2 + next_angle.2);
                area += size * (0.5 * (angle.0 + next_angle.0) + size / 10.0 * (angle.1 - next_angle.1 + bend));
                (force, angle) = (next_force, next_angle);
            }
            (from, before) = (to, after);
        }
        let mut segment = Segment {
            time: from.time,
            state: self.equations.state(&from.y, from.turn),
            slip: self.slip.value(&from.y, from.turn),
            ended,
            transition: [[0.0; MAX_STATES]; MAX_STATES],
            fundamental: (0.0, 0.0),
            fundamental_by_start: [(0.0, 0.0); MAX_STATES],
            observed: observe,
            mean: area / period,
            force: extremes,
        };
        self.fundamental(&first, &from, 2.0 / period, offset / self.equations.scales[0], &mut segment);
        segment
    }

    fn approximate_segment(&self, start: f64, z: &State, period: f64) -> Approximation {
        let turn = (self.equations.omega * start).sin_cos();
        let mut from = Sample { time: start, y: self.equations.rest(z, turn), turn };
        let margins = self.margins();
        let mut before = self.margins_at(&from);
        loop {
            let (time, turn) = (from.time + self.step, self.turned(from.turn));
            let to = Sample { time, y: self.ladder[0].apply(&from.y), turn };
            let last = (period - from.time) / self.step;
            let mut fraction = last.min(1.0);
            let (mut ended, mut after) = (false, [0.0; 2]);
            for (j, margin) in margins.iter().enumerate() {
                after[j] = margin.value(&to.y, to.turn);
                if after[j] < CROSSED {
                    let slopes = (margin.slope(&from.y, from.turn), margin.slope(&to.y, to.turn));
                    let root = crossing(before[j], slopes.0 * self.step, after[j], slopes.1 * self.step);
                    if root < fraction {
                        (fraction, ended) = (root, true);
                    }
                }
            }
            if ended || last <= 1.0 + 1e-9 {
                let (time, rates) =
                    (from.time + fraction * self.step, (self.equations.rate(&from.y), self.equations.rate(&to.y)));
                let y = std::array::from_fn(|i| {
                    cubic(from.y[i], rates.0[i] * self.step, to.y[i], rates.1[i] * self.step, fraction)
                });
                let turn = (self.equations.omega * time).sin_cos();
                return Approximation {
                    time,
                    state: self.equations.state(&y, turn),
                    slip: self.slip.value(&y, turn),
                    ended,
                };
            }
            (from, before) = (to, after);
        }
    }

    fn jump(&self, at: &mut Jump, end: f64) {
        let (from, to) = ((self.equations.omega * at.time).sin_cos(), (self.equations.omega * end).sin_cos());
        let map = Map::over(&self.equations.m, &self.equations.constant, end - at.time);
        let y = map.apply(&self.equations.rest(&at.state, from));
        let before: Square<N> = std::array::from_fn(|i| std::array::from_fn(|j| at.through[i][j]));
        let through = multiply(&map.matrix, &before);
        let values = [0, 1].map(|j| self.margins[j].value(&y, to));
        let margin = usize::from(values[1] < values[0]);
        let reading = &self.margins[margin];
        for i in 0..N {
            at.through[i][..N].copy_from_slice(&through[i]);
            at.margin_by_start[i] = (0..N).map(|k| reading.a[k] * through[k][i]).sum();
        }
        (at.time, at.state, at.slip) = (end, self.equations.state(&y, to), self.slip.value(&y, to));
        (at.margin, at.rate) = (values[margin], reading.slope(&y, to));
    }

    fn gather(&self, stretch: &Stretch, into: &mut Gradient) {
        gather(&self.equations, stretch, into);
    }
}

impl<const N: usize> Affine<N> {
    /// Fundamental of state 0 over a stretch, and the derivatives by its start; `weight` is 2/T.
    fn fundamental(&self, from: &Sample<N>, to: &Sample<N>, weight: f64, offset: f64, segment: &mut Segment) {
        let transition = exponential(&self.equations.m, to.time - from.time);
        let (e0, e1) = ((from.turn.1, -from.turn.0), (to.turn.1, -to.turn.0));
        let row = &self.equations.resolvent[0];
        // int e^{-iwt} dt = (e0 - e1)/(iw)
        let bare = ((e0.1 - e1.1) / self.equations.omega, -(e0.0 - e1.0) / self.equations.omega);
        let mut integral = (-offset * bare.0, -offset * bare.1);
        for i in 0..N {
            let c = self.equations.constant[i];
            let x = from.y[i] * e0.0 - to.y[i] * e1.0 + c * bare.0;
            let y = from.y[i] * e0.1 - to.y[i] * e1.1 + c * bare.1;
            integral.0 += row[i].0 * x - row[i].1 * y;
            integral.1 += row[i].0 * y + row[i].1 * x;
        }
        let [sine2, cosine2, both] = products(self.equations.omega, to.time - from.time, from.turn, to.turn);
        let [ps, pc] = [self.equations.particular[0][0], self.equations.particular[1][0]];
        let factor = weight * self.equations.scales[0];
        segment.fundamental =
            (factor * (-integral.1 + ps * sine2 + pc * both), factor * (integral.0 + ps * both + pc * cosine2));
        for j in 0..N {
            let (mut x, mut y) = (0.0, 0.0);
            for i in 0..N {
                let d = (e0.0 * f64::from(u8::from(i == j)) - e1.0 * transition[i][j], {
                    e0.1 * f64::from(u8::from(i == j)) - e1.1 * transition[i][j]
                });
                x += row[i].0 * d.0 - row[i].1 * d.1;
                y += row[i].0 * d.1 + row[i].1 * d.0;
                segment.transition[i][j] = transition[i][j] * self.equations.scales[i] / self.equations.scales[j];
            }
            segment.fundamental_by_start[j] =
                (-factor * y / self.equations.scales[j], factor * x / self.equations.scales[j]);
        }
    }
}

/// Sum of a power series at `d`.
fn sum<const N: usize>(series: &[[f64; N]; TERMS], d: f64) -> [f64; N] {
    let mut out = [0.0; N];
    for term in series.iter().rev() {
        for i in 0..N {
            out[i] = out[i] * d + term[i];
        }
    }
    out
}
