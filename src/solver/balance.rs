//! Harmonic balance: periodic states that stay in one mode all through the cycle, as Fourier series.
//!
//! The laws are evaluated at some instants and the rates transformed (alternating frequency and time). The instants are
//! equidistant; where a slope has a kink they are the points of Gauss between the kinks of the motion. What is not constant of
//! the Jacobian is left to iteration: (ikw - A) dZ_k = F_k - ikw Z_k with A the mean over the cycle. Where that does not
//! contract, the series does not fall off or the mode would end, there is no answer, and shooting finds one.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::exponential::{Square, apply, exponential, multiply, unit};
use super::harmonic::{Complex, resolvent, times};
use super::shooting::Start;
use super::tolerance::Tolerance;
use crate::model::system::{Evaluation, Forcing, HybridSystem, MAX_COLUMNS, MAX_STATES, Mode, ParameterColumns};
use std::f64::consts::TAU;
use std::sync::LazyLock;

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
/// Largest of the last two harmonics of a state, relative to its scale: aliasing of a series that falls off geometrically
/// goes with the square, and so does what higher harmonics would do to the fundamental.
const TAIL: f64 = 5e-4;
const KINKED_TAIL: f64 = 1.5e-4;
/// Largest mean rate of a state of rest, relative to its scale and the frequency.
const DRIFT: f64 = 1e-9;
/// Largest modulus of the Floquet multipliers of a motion that is stable beyond doubt, by a bound and by a product over few
/// instants, which counts fast changes of the slopes too little; of other motions shooting knows more.
const STABLE: f64 = 1.0 - 1e-4;
const SURELY_STABLE: f64 = 0.99;
/// Largest correction after which slopes and margins count as those of the motion.
const CORRECTED: f64 = 1e-4;
/// Squarings of a matrix whose spectral radius is wanted.
const SQUARINGS: usize = 24;

/// Cosine and sine of the equidistant phases.
static ROOTS: LazyLock<[Complex; MOST]> = LazyLock::new(|| {
    std::array::from_fn(|j| {
        let (sine, cosine) = (TAU * j as f64 / MOST as f64).sin_cos();
        (cosine, sine)
    })
});

/// Points and weights of Gauss's quadrature from 0 to 1.
static GAUSS: LazyLock<[Vec<(f64, f64)>; 2]> = LazyLock::new(|| KINKED.map(|(points, _)| gauss(points)));

/// Zeros of the Legendre polynomial by Newton's method, and the weights that belong to them.
fn gauss(points: usize) -> Vec<(f64, f64)> {
    let degree = points as f64;
    let point = |j: usize| {
        let mut x = -((j as f64 + 0.75) / (degree + 0.5) * 0.5 * TAU).cos();
        let mut slope = 0.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for n in 2..=points {
                let n = n as f64;
                (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
            }
            slope = degree * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..points).map(point).collect()
}

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
    /// Phase of a harmonic at an instant: cosine and sine.
    fn root(&self, harmonic: usize, instant: usize) -> Complex {
        self.roots[(self.harmonics + 1) * instant + harmonic]
    }

    /// The states at the phase with these cosines and sines of its multiples.
    fn states(&self, root: impl Fn(usize) -> Complex) -> [f64; MAX_STATES] {
        let mut value: [f64; N] = self.series[0].map(|z| z.0);
        for k in 1..=self.harmonics {
            let root = root(k);
            for i in 0..N {
                let z = self.series[k][i];
                value[i] += 2.0 * (z.0 * root.0 - z.1 * root.1);
            }
        }
        let mut z = [0.0; MAX_STATES];
        for i in 0..N {
            z[i] = value[i] * self.scales[i];
        }
        z
    }

    /// Forcing and states at a phase.
    fn at(&self, phase: f64) -> (Forcing, [f64; MAX_STATES]) {
        let (sine, cosine) = phase.sin_cos();
        let roots = powers((cosine, sine), self.harmonics);
        (self.system.forcing_at(sine, cosine), self.states(|k| roots[k]))
    }

    /// States, mode and algebraic unknown at time 0.
    fn start(&self) -> Option<Start> {
        let (forcing, z) = self.at(0.0);
        let near = |j: &usize| self.root(1, *j).0;
        let nearest = (0..self.samples.len()).max_by(|i, j| near(i).total_cmp(&near(j)))?;
        let mut s = self.samples[nearest].s;
        let mut out = Evaluation::default();
        for _ in 0..4 {
            self.system.constraint(&forcing, &z[..N], s, self.mode, &mut out);
            s -= out.g / out.gs;
        }
        s.is_finite().then_some((z, (self.mode, s)))
    }

    /// Lays the series out at equidistant instants; the algebraic unknown as at the instants before them, or as guessed.
    fn spread(&mut self, count: usize) {
        let before: Vec<f64> = self.samples.iter().map(|sample| sample.s).collect();
        let harmonics = count / 2 - 1;
        let stride = MOST / count;
        let places: Vec<(f64, [Complex; HARMONICS + 1])> =
            (0..count).map(|j| (1.0 / count as f64, std::array::from_fn(|k| ROOTS[k * j * stride % MOST]))).collect();
        let slip = self.slip;
        self.place(harmonics, &places, |j| {
            if before.is_empty() {
                return slip;
            }
            0.5 * (before[j / 2] + before[(j / 2 + j % 2) % before.len()])
        });
    }

    /// Lays the series out between the kinks of the motion; `None` where there are not two in a cycle.
    fn follow_kinks(&mut self) -> Option<()> {
        const LOOKS: usize = 16;
        let kink = |phase: f64| {
            let (forcing, z) = self.at(phase);
            self.system.kink(&forcing, &z[..N])
        };
        let looks: [f64; LOOKS] = std::array::from_fn(|j| kink(TAU * j as f64 / LOOKS as f64));
        let mut kinks = [0.0; 2];
        let mut found = 0;
        for j in 0..LOOKS {
            let (mut low, mut high) = (looks[j], looks[(j + 1) % LOOKS]);
            if (low > 0.0) == (high > 0.0) {
                continue;
            }
            let mut ends = [TAU * j as f64 / LOOKS as f64, TAU * (j + 1) as f64 / LOOKS as f64];
            let (mut place, mut last) = (ends[0], 0);
            for _ in 0..8 {
                // Regula falsi; an end that stays twice is weighted less (Illinois).
                place = ends[0] - low * (ends[1] - ends[0]) / (high - low);
                let value = kink(place);
                if (value > 0.0) == (high > 0.0) {
                    (ends[1], high) = (place, value);
                    low *= if last == 1 { 0.5 } else { 1.0 };
                    last = 1;
                } else {
                    (ends[0], low) = (place, value);
                    high *= if last == -1 { 0.5 } else { 1.0 };
                    last = -1;
                }
                if value.abs() < 1e-9 * looks[j].abs() {
                    break;
                }
            }
            *kinks.get_mut(found)? = place;
            found += 1;
        }
        if found != 2 {
            return None;
        }
        let before: Vec<f64> = self.samples.iter().map(|sample| sample.s).collect();
        let slip = self.slip;
        let (points, harmonics) = KINKED[self.level];
        let mut places = Vec::with_capacity(2 * points);
        for (from, to) in [(kinks[0], kinks[1]), (kinks[1], kinks[0] + TAU)] {
            for (place, weight) in &GAUSS[self.level] {
                let (sine, cosine) = (from + place * (to - from)).sin_cos();
                places.push((weight * (to - from) / TAU, powers((cosine, sine), harmonics)));
            }
        }
        self.place(harmonics, &places, |j| if before.len() == 2 * points { before[j] } else { slip });
        Some(())
    }

    /// Lays the series out at instants with these weights and phases.
    fn place(&mut self, harmonics: usize, at: &[(f64, [Complex; HARMONICS + 1])], slip: impl Fn(usize) -> f64) {
        let samples = at.iter().enumerate().map(|(j, (weight, roots))| Sample {
            weight: *weight,
            forcing: self.system.forcing_at(roots[1].1, roots[1].0),
            z: self.states(|k| roots[k]),
            s: slip(j),
            rate: [0.0; N],
            slope: [[0.0; N]; N],
            excess: 0.0,
            by: [0.0; N],
            through: [0.0; N],
            margins: [0.0; 2],
        });
        self.samples = samples.collect();
        self.harmonics = harmonics;
        self.roots.clear();
        self.roots.extend(at.iter().flat_map(|(_, roots)| &roots[..=harmonics]));
    }

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

    /// Mean of the slopes and what follows from it.
    fn linearise(&mut self) -> Option<()> {
        let mut mean = [[0.0; N]; N];
        for sample in &self.samples {
            for i in 0..N {
                for j in 0..N {
                    mean[i][j] += sample.weight * sample.slope[i][j];
                }
            }
        }
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
            let harmonics = self.harmonics;
            self.evaluate()?;
            *iterations += 1;
            if round > 0 && !self.nearly_holds() {
                return None;
            }
            if round == 0 || (round == 1 && self.level == 0) {
                self.linearise()?;
            }
            let mut size = 0.0f64;
            let mut change = [[(0.0, 0.0); N]; HARMONICS + 1];
            for k in 0..=harmonics {
                let mut excess = self.transform(k, |sample| &sample.rate);
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
                    let mut sum = (0.0, 0.0);
                    for j in 0..N {
                        let part = times(by[i][j], excess[j]);
                        sum = (sum.0 + part.0, sum.1 + part.1);
                    }
                    let z = &mut self.series[k][i];
                    *z = (z.0 + sum.0, z.1 + sum.1);
                    change[k][i] = sum;
                    size = larger(size, sum.0.abs() + sum.1.abs());
                }
            }
            for j in 0..self.samples.len() {
                let mut moved: [f64; N] = change[0].map(|z| z.0);
                for k in 1..=harmonics {
                    let root = self.root(k, j);
                    for i in 0..N {
                        moved[i] += 2.0 * (change[k][i].0 * root.0 - change[k][i].1 * root.1);
                    }
                }
                let sample = &mut self.samples[j];
                let mut slip = sample.excess;
                for i in 0..N {
                    slip += sample.by[i] * moved[i];
                    sample.z[i] += moved[i] * self.scales[i];
                }
                sample.s -= slip;
                size = larger(size, slip.abs() * by_slip);
            }
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

    /// Harmonic `k` of a quantity.
    fn transform<const M: usize>(&self, k: usize, of: impl Fn(&Sample<N>) -> &[f64; M]) -> [Complex; M] {
        let mut sum = [(0.0, 0.0); M];
        for (j, sample) in self.samples.iter().enumerate() {
            let root = self.root(k, j);
            for (sum, value) in sum.iter_mut().zip(of(sample)) {
                sum.0 += sample.weight * value * root.0;
                sum.1 -= sample.weight * value * root.1;
            }
        }
        sum
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

    /// Whether every disturbance dies out, by the Floquet multipliers.
    fn is_stable(&self) -> bool {
        let period = TAU / self.omega;
        let mut mean = [[0.0; N]; N];
        for sample in &self.samples {
            for i in 0..N {
                for j in 0..N {
                    mean[i][j] += sample.weight * sample.slope[i][j];
                }
            }
        }
        let change = |sample: &Sample<N>| -> f64 {
            let rows = sample.slope.iter().zip(&mean);
            rows.map(|(row, mean)| row.iter().zip(mean).map(|(a, b)| (a - b).abs()).sum()).fold(0.0, larger)
        };
        // At resonances of the disturbances with the drive a change of the slopes shifts the multipliers in first order.
        let shift = 2.0 * period * self.samples.iter().map(change).fold(0.0, larger);
        let mean = spectral_radius(&self.at_rest(exponential(&mean, period)));
        if mean.is_some_and(|largest| largest + shift < STABLE) {
            return true;
        }
        let mut monodromy: Square<N> = unit();
        for sample in &self.samples {
            monodromy = multiply(&exponential(&sample.slope, sample.weight * period), &monodromy);
        }
        // What grows beyond all numbers within a cycle is no number.
        spectral_radius(&self.at_rest(monodromy)).is_some_and(|largest| largest < SURELY_STABLE)
    }

    /// The disturbances that a contact at rest lets live: it keeps what it came to rest with.
    fn at_rest(&self, mut monodromy: Square<N>) -> Square<N> {
        if self.mode == Mode::Stick {
            for (i, rest) in self.system.resting_state(&self.samples[0].z)[..N].iter().enumerate() {
                let Some((_, gradient)) = rest else { continue };
                for m in 0..N {
                    let by = std::mem::take(&mut monodromy[m][i]) / (gradient[i] * self.scales[i]);
                    for j in (0..N).filter(|&j| j != i) {
                        monodromy[m][j] -= by * gradient[j] * self.scales[j];
                    }
                }
                monodromy[i] = [0.0; N];
            }
        }
        monodromy
    }

    /// Extremes of the tangential force.
    fn force(&self) -> (f64, f64) {
        self.extremes(|sample| self.system.force(&sample.forcing, &sample.z[..N], sample.s).0)
    }

    /// Extremes of a quantity: its series evaluated at many phases, and the vertices of parabolas there.
    fn extremes(&self, of: impl Fn(&Sample<N>) -> f64) -> (f64, f64) {
        let harmonics = self.harmonics;
        let mut series = [(0.0, 0.0); HARMONICS + 1];
        for (j, sample) in self.samples.iter().enumerate() {
            let value = sample.weight * of(sample);
            for (k, out) in series.iter_mut().enumerate().take(harmonics + 1) {
                let root = self.root(k, j);
                *out = (out.0 + value * root.0, out.1 - value * root.1);
            }
        }
        let value: [f64; MOST] = std::array::from_fn(|j| {
            let wave = |k: usize| {
                let root = ROOTS[k * j % MOST];
                2.0 * (series[k].0 * root.0 - series[k].1 * root.1)
            };
            series[0].0 + (1..=harmonics).map(wave).sum::<f64>()
        });
        let mut extremes = (f64::INFINITY, f64::NEG_INFINITY);
        for j in 0..MOST {
            let (one, two, three) = (value[(j + MOST - 1) % MOST], value[j], value[(j + 1) % MOST]);
            let (slope, bend) = (0.5 * (three - one), one - 2.0 * two + three);
            let vertex = if bend != 0.0 && slope.abs() <= bend.abs() { two - 0.5 * slope * slope / bend } else { two };
            extremes = (extremes.0.min(vertex), extremes.1.max(vertex));
        }
        extremes
    }

    /// Derivatives of the fundamental by the columns, by the adjoint method: the equations of the adjoint are solved by the
    /// same iteration, for the real and the imaginary part in turn.
    fn columns(&self) -> Option<Vec<Complex>> {
        // A = (2i/T) integral of z e^{-iwt}
        let functional = |part: fn(Complex) -> f64| -> Vec<f64> {
            (0..self.samples.len()).map(|j| 2.0 * part(self.root(1, j))).collect()
        };
        let (re, im) = (functional(|root| root.1), functional(|root| root.0));
        let (re, im) = (self.adjoint(&re)?, self.adjoint(&im)?);
        let mut out = vec![(0.0, 0.0); self.system.columns()];
        let mut columns = ParameterColumns { f: [[0.0; MAX_STATES]; MAX_COLUMNS], g: [0.0; MAX_COLUMNS] };
        for ((sample, re), im) in self.samples.iter().zip(&re).zip(&im) {
            self.system.parameter_columns(&sample.forcing, &sample.z[..N], sample.s, self.mode, &mut columns);
            for (out, (f, g)) in out.iter_mut().zip(columns.f.iter().zip(&columns.g)) {
                for i in 0..N {
                    let rate = sample.weight * (f[i] - sample.through[i] * g) * self.scales[0] / self.scales[i];
                    out.0 += re[i] * rate;
                    out.1 += im[i] * rate;
                }
            }
        }
        Some(out)
    }

    /// l with (-d/dt - A^T) l = `functional` in the first state.
    fn adjoint(&self, functional: &[f64]) -> Option<Vec<[f64; N]>> {
        let (count, harmonics) = (self.samples.len(), self.harmonics);
        let transposed: Square<N> = std::array::from_fn(|i| std::array::from_fn(|j| self.mean_slope[j][i]));
        let mut adjoint = vec![[0.0; N]; count];
        let mut before = f64::INFINITY;
        for round in 0..4 * ITERATIONS {
            // (-d/dt - A_mean^T) l = functional + (A - A_mean)^T l
            let mut right = vec![[0.0; N]; count];
            for (j, sample) in self.samples.iter().enumerate() {
                let l = &adjoint[j];
                let steady = apply(&transposed, l);
                for i in 0..N {
                    right[j][i] = -steady[i];
                    for m in 0..N {
                        right[j][i] += sample.slope[m][i] * l[m];
                    }
                }
                right[j][0] += functional[j];
            }
            let mut next = vec![[0.0; N]; count];
            for k in 0..=harmonics {
                let mut of = [(0.0, 0.0); N];
                for (j, right) in right.iter().enumerate() {
                    let (root, weight) = (self.root(k, j), self.samples[j].weight);
                    for i in 0..N {
                        of[i] = (of[i].0 + weight * right[i] * root.0, of[i].1 - weight * right[i] * root.1);
                    }
                }
                let weight = if k == 0 { 1.0 } else { 2.0 };
                let by = &self.resolvents[k];
                let mut harmonic = [(0.0, 0.0); N];
                for i in 0..N {
                    for m in 0..N {
                        // Transposed and conjugate.
                        let part = times((by[m][i].0, -by[m][i].1), of[m]);
                        harmonic[i] = (harmonic[i].0 + weight * part.0, harmonic[i].1 + weight * part.1);
                    }
                }
                for (j, next) in next.iter_mut().enumerate() {
                    let root = self.root(k, j);
                    for i in 0..N {
                        next[i] += harmonic[i].0 * root.0 - harmonic[i].1 * root.1;
                    }
                }
            }
            let (mut size, mut most) = (0.0f64, 0.0f64);
            for (next, last) in next.iter().flatten().zip(adjoint.iter().flatten()) {
                size = larger(size, (next - last).abs());
                most = larger(most, next.abs());
            }
            adjoint = next;
            if size < 1e-10 * most {
                return Some(adjoint);
            }
            if !size.is_finite() || (round > 4 && size > before) {
                return None;
            }
            before = size;
        }
        None
    }
}

/// The larger of two; no number where one is none, unlike [`f64::max`].
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Powers 0 to `most` of a number of modulus one.
fn powers(one: Complex, most: usize) -> [Complex; HARMONICS + 1] {
    let mut powers = [(1.0, 0.0); HARMONICS + 1];
    for k in 1..=most {
        powers[k] = times(powers[k - 1], one);
    }
    powers
}

/// Spectral radius by repeated squaring; `None` where the matrix is not finite.
fn spectral_radius<const N: usize>(matrix: &Square<N>) -> Option<f64> {
    if !matrix.iter().flatten().all(|v| v.is_finite()) {
        return None;
    }
    let largest = |m: &Square<N>| m.iter().flatten().fold(0.0f64, |most, v| most.max(v.abs()));
    let (mut matrix, mut log, mut power) = (*matrix, 0.0, 1.0);
    for _ in 0..SQUARINGS {
        let norm = largest(&matrix);
        if norm == 0.0 {
            return Some(0.0);
        }
        log += norm.ln() / power;
        matrix = matrix.map(|row| row.map(|v| v / norm));
        matrix = multiply(&matrix, &matrix);
        power *= 2.0;
    }
    Some((log + largest(&matrix).max(1e-300).ln() / power).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;
    use crate::model::contact::Problem;
    use crate::model::{Model, Operation};
    use crate::scenario::{Contact, Formulation, Instrument, Rig};

    /// The fundamental with a fixed number of instants, on a hardening spring over a fast roller.
    fn fundamental(count: usize) -> Complex {
        let rig = Rig {
            inertia: 5.0e-3,
            torsional_stiffness: 990.0,
            torsional_damping: 0.43,
            spring_stiffness: 1.6e4,
            spring_damping: 12.0,
            spring_arm: 0.03,
            contact_arm: 0.06,
        };
        let contact = Contact { stiffness: 8.9e4, damping: 26.0, friction: 0.5, formulation: Formulation::Series };
        let effects = vec![(find("cubic-stiffness").expect("known"), vec![2e11])];
        let model = Model { rig, contact, instrument: Instrument::default(), effects };
        let at = Operation { speed: 0.1, load: 0.02, drive: 1e-5, frequency: 55.0 };
        let problem = Problem::new(&model, &at);
        let mut search = Balancing::<3>::new(&problem).expect("slips");
        search.spread(count);
        search.iterate(1e-12, &mut 0).expect("contracts");
        assert!(search.holds());
        search.series[1][0]
    }

    #[test]
    fn gauss_integrates_polynomials_up_to_its_degree() {
        for (points, _) in KINKED {
            for power in [0, 1, 7, 2 * points - 1] {
                let sum: f64 = gauss(points).iter().map(|(x, weight)| weight * x.powi(power as i32)).sum();
                assert!((sum * (power as f64 + 1.0) - 1.0).abs() < 1e-13, "{points} points, power {power}: {sum}");
            }
        }
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
