//! Harmonic balance: periodic states that stay in one mode all through the cycle, as Fourier series.
//!
//! The laws are evaluated at some instants and the rates transformed (alternating frequency and time). The instants are
//! equidistant; where a slope has a kink they are the points of Gauss between the kinks of the motion. What is not
//! constant of the Jacobian is left to iteration: (ikw - A) dZ_k = F_k - ikw Z_k with A the mean over the cycle. Where
//! that does not contract, the series does not fall off or the mode would end, there is no answer, and shooting finds
//! one.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

mod adjoint;
mod instants;
mod stability;

use super::exponential::{Square, unit};
use super::harmonic::{Complex, resolvent, times};
use super::period::Start;
use super::tolerance::Tolerance;
use crate::model::system::{Evaluation, Forcing, HybridSystem, MAX_STATES, Mode};
use instants::{ROOTS, sum};
use std::f64::consts::TAU;

/// Most instants.
const MOST: usize = FEWEST << (SMOOTH - 1);
/// Fewest instants, and how many numbers of them are tried, each twice the one before.
const FEWEST: usize = 8;
const SMOOTH: usize = 4;
/// Most harmonics.
const HARMONICS: usize = MOST / 2 - 1;
/// Most iterations with one number of instants.
const ITERATIONS: usize = 24;
/// Points of Gauss between two kinks and the harmonics that they determine: what is tried in turn.
const KINKED: [(usize, usize); 2] = [(14, 7), (28, 15)];
/// Corrections up to which the instants follow the kinks: what a misplaced kink does goes with the third power.
const FOLLOWED: f64 = 1e-3;
/// Largest share of a correction that the next one may be.
const CONTRACTION: f64 = 0.6;
/// Share of the range of the margins by which the lowest may be too low while the search is under way.
const NEARLY: f64 = 0.15;
/// Largest of the last two harmonics of a state, relative to its scale: aliasing of a series that falls off
/// geometrically goes with the square, and so does what higher harmonics would do to the fundamental.
const TAIL: f64 = 5e-4;
const KINKED_TAIL: f64 = 1.5e-4;
/// Largest mean rate of a state of rest, relative to its scale and the frequency.
const DRIFT: f64 = 1e-9;
/// Largest correction after which slopes and margins count as those of the motion.
const CORRECTED: f64 = 1e-4;
/// A stable periodic state in one mode.
#[derive(Debug, Clone)]
pub struct Balance {
    /// States, mode and algebraic unknown at time 0.
    pub start: Start,
    /// Complex amplitude of the first state, as that of [`super::cycle::Cycle`].
    pub fundamental: Complex,
    /// Its mean.
    pub mean: f64,
    /// Extremes of the tangential force \[N\].
    pub force: (f64, f64),
    /// Iterations: evaluations of the laws over a cycle.
    pub iterations: usize,
    /// Estimated relative error that the iteration left.
    pub left: f64,
    /// Derivatives of the fundamental by the columns, where asked for.
    pub columns: Option<Vec<Complex>>,
}

/// The periodic state in the mode in which a cycle begins; `None` where none is found that stays in it and is stable.
pub fn solve(system: &dyn HybridSystem, tolerance: &Tolerance, columns: bool) -> Option<Balance> {
    if tolerance.measures_order() {
        return None;
    }
    match system.states() {
        3 => balance::<3>(system, tolerance, columns),
        4 => balance::<4>(system, tolerance, columns),
        5 => balance::<5>(system, tolerance, columns),
        6 => balance::<6>(system, tolerance, columns),
        7 => balance::<7>(system, tolerance, columns),
        8 => balance::<8>(system, tolerance, columns),
        _ => None,
    }
}

/// One instant; rates and slopes in units of the scales of the states, the algebraic unknown eliminated.
#[derive(Clone, Copy)]
struct Sample<const N: usize> {
    /// Share of the cycle.
    weight: f64,
    forcing: Forcing,
    z: [f64; MAX_STATES],
    s: f64,
    rate: [f64; N],
    slope: Square<N>,
    /// s moves by -(excess + by dz) where the states move by dz.
    excess: f64,
    by: [f64; N],
    /// df/ds over dg/ds.
    through: [f64; N],
    /// Of the mode.
    margins: [f64; 2],
}

/// Harmonics 0, 1, .. of every state.
type Series<const N: usize> = [[Complex; N]; HARMONICS + 1];

// Wide: one iterate: series, instants and the linearisation that belong to each other.
struct Balancing<'a, const N: usize> {
    system: &'a dyn HybridSystem,
    mode: Mode,
    scales: [f64; MAX_STATES],
    omega: f64,
    /// First guess of the algebraic unknown.
    slip: f64,
    samples: Vec<Sample<N>>,
    /// Cosine and sine of the phase of every harmonic at every instant.
    roots: Vec<Complex>,
    /// Harmonics that the instants determine.
    harmonics: usize,
    /// How often there were too few of them.
    level: usize,
    series: Series<N>,
    /// Mean of the slopes and (ikw - A)^-1.
    mean_slope: Square<N>,
    resolvents: Vec<[[Complex; N]; N]>,
}

fn balance<const N: usize>(system: &dyn HybridSystem, tolerance: &Tolerance, columns: bool) -> Option<Balance> {
    let mut search = Balancing::<N>::new(system)?;
    let kinked = system.is_kinked();
    let (levels, tail) = if kinked { (KINKED.len(), KINKED_TAIL) } else { (SMOOTH, TAIL) };
    let mut iterations = 0;
    let mut error = None;
    for level in 0..levels {
        search.level = level;
        if !kinked {
            search.spread(FEWEST << level);
        }
        let left = search.iterate(tolerance.left(), &mut iterations)?;
        if !search.holds() {
            return None;
        }
        if search.tail() < tail {
            error = Some(left);
            break;
        }
    }
    let error = error?;
    if !search.is_stable() {
        return None;
    }
    let columns = if columns { Some(search.columns()?) } else { None };
    let scale = search.scales[0];
    let (re, im) = search.series[1][0];
    Some(Balance {
        start: search.start()?,
        // z = Im (A e^{iwt}) = 2 Re (Z e^{iwt})
        fundamental: (-2.0 * im * scale, 2.0 * re * scale),
        mean: search.series[0][0].0 * scale,
        force: search.force(),
        iterations,
        left: error,
        columns,
    })
}

impl<'a, const N: usize> Balancing<'a, N> {
    /// The search from the first guess of the system; `None` where exact flows serve better or the mode is not smooth.
    fn new(system: &'a dyn HybridSystem) -> Option<Self> {
        let start = system.initial_state();
        let (mode, s) = system.enter(&system.forcing(0.0), &start, None);
        let affine = system.affine(mode);
        let linear = affine.constraint && affine.rows.iter().all(|&row| row);
        if linear || !system.is_smooth() {
            return None;
        }
        let rests = mode == Mode::Stick;
        if rests && !(0..N).all(|i| affine.rows[i] || system.resting_state(&start)[i].is_none()) {
            return None;
        }
        let scales = system.scales();
        let mut series = [[(0.0, 0.0); N]; HARMONICS + 1];
        if !rests {
            series[0] = std::array::from_fn(|i| (start[i] / scales[i], 0.0));
        }
        Some(Self {
            system,
            mode,
            scales,
            omega: TAU / system.period(),
            slip: s,
            samples: Vec::with_capacity(MOST),
            roots: Vec::new(),
            harmonics: 0,
            level: 0,
            series,
            mean_slope: unit(),
            resolvents: Vec::with_capacity(HARMONICS + 1),
        })
    }
}

impl<const N: usize> Balancing<'_, N> {
    /// Evaluates the laws at every instant; `None` where they do not determine the algebraic unknown.
    fn evaluate(&mut self) -> Option<()> {
        let mut out = Evaluation::default();
        for sample in &mut self.samples {
            self.system.evaluate(&sample.forcing, &sample.z[..N], sample.s, self.mode, &mut out);
            if out.gs == 0.0 || !out.gs.is_finite() {
                return None;
            }
            sample.excess = out.g / out.gs;
            for j in 0..N {
                sample.by[j] = out.gz[j] * self.scales[j] / out.gs;
            }
            for i in 0..N {
                let scale = 1.0 / self.scales[i];
                sample.through[i] = out.fs[i] / out.gs;
                sample.rate[i] = (out.f[i] - out.fs[i] * sample.excess) * scale;
                for j in 0..N {
                    sample.slope[i][j] = (out.fz[i][j] * self.scales[j] - out.fs[i] * sample.by[j]) * scale;
                }
            }
            sample.margins = self.system.margins(&sample.forcing, &sample.z[..N], sample.s, self.mode);
        }
        Some(())
    }

    /// Mean of the slopes over the cycle.
    fn mean_slopes(&self) -> Square<N> {
        let mut mean = [[0.0; N]; N];
        for sample in &self.samples {
            for i in 0..N {
                for j in 0..N {
                    mean[i][j] += sample.weight * sample.slope[i][j];
                }
            }
        }
        mean
    }

    /// Mean of the slopes and what follows from it.
    fn linearise(&mut self) -> Option<()> {
        let mean = self.mean_slopes();
        self.mean_slope = mean;
        self.resolvents.clear();
        for k in 0..=self.harmonics {
            let constant = k == 0 && self.mode == Mode::Stick;
            // Over a roller at rest a stuck motion has no mean; its states are open there.
            let inverse = if constant { [[(0.0, 0.0); N]; N] } else { resolvent(&mean, k as f64 * self.omega)? };
            self.resolvents.push(inverse);
        }
        Some(())
    }

    /// Iterates until a correction leaves less than `left`; what it leaves. Says in `iterations` how often.
    fn iterate(&mut self, left: f64, iterations: &mut usize) -> Option<f64> {
        let by_slip = 1.0 / self.system.slip_scale();
        let kinked = self.system.is_kinked();
        let mut before = f64::INFINITY;
        for round in 0..ITERATIONS {
            if kinked && before > FOLLOWED {
                self.follow_kinks()?;
            }
            self.evaluate()?;
            *iterations += 1;
            if round > 0 && !self.nearly_holds() {
                return None;
            }
            if round == 0 || (round == 1 && self.level == 0) {
                self.linearise()?;
            }
            let mut change = [[(0.0, 0.0); N]; HARMONICS + 1];
            let by_states = self.correct_series(&mut change)?;
            let size = larger(by_states, self.move_samples(&change) * by_slip);
            if !size.is_finite() {
                return None;
            }
            let ratio = if before.is_finite() { size / before } else { 1.0 };
            if round > 2 && ratio > CONTRACTION {
                return None;
            }
            let remains = size * ratio / (1.0 - ratio).max(0.1);
            if round > 0 && remains < left && size < CORRECTED {
                return Some(remains);
            }
            before = size;
        }
        None
    }

    /// Corrects every harmonic by what its balance lacks; the largest correction, relative to the scales of the states.
    /// `None` where a contact at rest drifts.
    fn correct_series(&mut self, change: &mut Series<N>) -> Option<f64> {
        let mut size = 0.0f64;
        for k in 0..=self.harmonics {
            let mut excess = self.transform(k, |j| self.samples[j].rate);
            let turning = k as f64 * self.omega;
            for i in 0..N {
                let z = self.series[k][i];
                excess[i] = (excess[i].0 + turning * z.1, excess[i].1 - turning * z.0);
            }
            if k == 0 && self.mode == Mode::Stick && excess.iter().any(|rate| rate.0.abs() > DRIFT * self.omega) {
                return None;
            }
            let by = &self.resolvents[k];
            for i in 0..N {
                let mut step = (0.0, 0.0);
                for j in 0..N {
                    let part = times(by[i][j], excess[j]);
                    step = (step.0 + part.0, step.1 + part.1);
                }
                let z = &mut self.series[k][i];
                *z = (z.0 + step.0, z.1 + step.1);
                change[k][i] = step;
                size = larger(size, step.0.abs() + step.1.abs());
            }
        }
        Some(size)
    }

    /// Moves the states at the instants as their series change, and the algebraic unknown with them; its largest
    /// change.
    fn move_samples(&mut self, change: &Series<N>) -> f64 {
        let mut size = 0.0f64;
        for j in 0..self.samples.len() {
            let moved = sum(&change[..=self.harmonics], |k| self.root(k, j));
            let sample = &mut self.samples[j];
            let mut slip = sample.excess;
            for i in 0..N {
                slip += sample.by[i] * moved[i];
                sample.z[i] += moved[i] * self.scales[i];
            }
            sample.s -= slip;
            size = larger(size, slip.abs());
        }
        size
    }

    /// Smallest and largest margin at the instants.
    fn margins(&self) -> (f64, f64) {
        let margins = self.samples.iter().flat_map(|sample| sample.margins);
        margins.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), m| (low.min(m), high.max(m)))
    }

    /// Whether the mode may hold, as far as a search under way can tell.
    fn nearly_holds(&self) -> bool {
        let (low, high) = self.margins();
        low > -NEARLY * (high - low)
    }

    /// Whether the mode holds, between the instants too.
    fn holds(&self) -> bool {
        let (low, high) = self.margins();
        // As far below its lowest instant a wave may fall whose crest is one instant away.
        let between = 1.0 - (TAU / self.samples.len() as f64).cos();
        low > between * (high - low) || (0..2).all(|side| self.extremes(|sample| sample.margins[side]).0 > 0.0)
    }

    /// The larger of the last two harmonics, over all states.
    fn tail(&self) -> f64 {
        let last = self.harmonics;
        let states = self.series[last - 1..=last].iter().flatten();
        states.fold(0.0, |most, z| most.max(2.0 * z.0.hypot(z.1)))
    }

    /// Extremes of the tangential force.
    fn force(&self) -> (f64, f64) {
        self.extremes(|sample| self.system.force(&sample.forcing, &sample.z[..N], sample.s).0)
    }

    /// Extremes of a quantity: its series evaluated at many phases, and the vertices of parabolas there.
    fn extremes(&self, of: impl Fn(&Sample<N>) -> f64) -> (f64, f64) {
        let values: Vec<[f64; 1]> = self.samples.iter().map(|sample| [of(sample)]).collect();
        let series: Vec<[Complex; 1]> = (0..=self.harmonics).map(|k| self.transform(k, |j| values[j])).collect();
        let value: [f64; MOST] = std::array::from_fn(|j| sum(&series, |k| ROOTS[k * j % MOST])[0]);
        let mut extremes = (f64::INFINITY, f64::NEG_INFINITY);
        for j in 0..MOST {
            let (one, two, three) = (value[(j + MOST - 1) % MOST], value[j], value[(j + 1) % MOST]);
            let (slope, bend) = (0.5 * (three - one), one - 2.0 * two + three);
            let vertex = if bend != 0.0 && slope.abs() <= bend.abs() { two - 0.5 * slope * slope / bend } else { two };
            extremes = (extremes.0.min(vertex), extremes.1.max(vertex));
        }
        extremes
    }
}

/// The larger of two; no number where one is none, unlike [`f64::max`].
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;
    use crate::model::contact::Problem;
    use crate::model::{Model, Operation};
    use crate::scenario;

    /// The fundamental with a fixed number of instants, on a hardening spring over a fast roller.
    fn fundamental(count: usize) -> Complex {
        let mut model = Model::new(&scenario::paper());
        model.effects = vec![(find("cubic-stiffness").expect("known"), vec![2e11])];
        let at = Operation { speed: 0.1, load: 0.02, drive: 1e-5, frequency: 55.0, series: 0 };
        let problem = Problem::new(&model, &at);
        let mut search = Balancing::<3>::new(&problem).expect("slips");
        search.spread(count);
        search.iterate(1e-12, &mut 0).expect("contracts");
        assert!(search.holds());
        search.series[1][0]
    }

    #[test]
    fn what_is_no_number_is_never_small() {
        assert!(larger(f64::NAN, 1.0).is_nan() && larger(1.0, f64::NAN).is_nan());
        assert_eq!((larger(1.0, 2.0), larger(2.0, 1.0)), (2.0, 2.0));
    }

    #[test]
    fn the_error_falls_faster_than_any_power_of_the_number_of_instants() {
        let exact = fundamental(MOST);
        let error = |count| {
            let found = fundamental(count);
            (found.0 - exact.0).hypot(found.1 - exact.1) / exact.0.hypot(exact.1)
        };
        let (one, two, four) = (error(8), error(16), error(32));
        assert!(one > 1e-9, "{one:e}");
        assert!(two < 1e-2 * one && four < 1e-2 * two.max(1e-11), "{one:e} {two:e} {four:e}");
    }
}
