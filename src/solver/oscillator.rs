//! Periodic states of a single mode without a contact: every stable one, by harmonic balance with alternating frequency
//! and time.
//!
//! The balance of the first harmonic alone is one equation for the amplitude, all roots of which are found on a grid;
//! so both stable states between the folds of a resonance are found at any frequency, whatever was solved before.
//! Newton's method on all harmonics starts from them. Unknowns are the mean and the cosine and sine of every harmonic.

pub mod fold;
mod laid;
pub(super) mod stability;

use super::describing::{companions, describing, nearly};
use super::joint::{Instant, pulls};
use super::tolerance::Tolerance;
use crate::model::system::SingleMode;
use laid::{Laid, basis_at};
use nalgebra::{DMatrix, DVector};
use stability::multiplier;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Highest harmonics that are tried in turn; all odd.
const HARMONICS: [usize; 4] = [5, 11, 21, 41];
/// Instants per harmonic, and under a force whose slope jumps, as that of a joint: at the default accuracy, and at
/// least.
const INSTANTS: usize = 6;
const INSTANTS_AT_CORNERS: (usize, usize) = (512, 64);
/// Largest of the last harmonics over the first at which a series is long enough: what is left out acts on the first
/// harmonic by its square.
const TAIL: f64 = 5e-5;
/// The same below which the longest series is accepted.
const LONGEST_TAIL: f64 = 1e-2;
/// Multiplications for a slope of a force by an unknown.
const SLOPE: usize = 6;
/// Newton steps with one number of harmonics.
const STEPS: usize = 40;
/// Relative Newton step below which a balance that no step improves any more is as good as its kinks allow.
const AT_KINKS: f64 = 1e-6;
/// Multiples of an amplitude of one harmonic from which a state is looked for in turn, until there is one.
const AROUND: [f64; 3] = [1.0, 0.6, 1.6];
/// Largest modulus of the multipliers of a stable state: rounding apart, one.
const STABLE: f64 = 1.0 + 1e-9;
/// Amplitudes of two states that differ by less than this share are one.
const SAME: f64 = 1e-6;

/// A periodic state.
#[derive(Debug, Clone)]
pub struct Periodic {
    /// Harmonic of every number of the series.
    harmonics: Vec<usize>,
    /// The mean where there is one, then cosine and sine of every harmonic.
    pub series: Vec<f64>,
    /// Newton steps that were made.
    pub steps: usize,
    /// Relative size of the last of them.
    pub left: f64,
    /// Largest modulus of the Floquet multipliers.
    pub multiplier: f64,
    /// Adjoints of the cosine and of the sine of the first harmonic.
    adjoints: [Vec<f64>; 2],
    /// By which numbers of joint and laws the residual changes: rows of derivatives projected by the adjoints.
    by_joint: [[f64; 3]; 2],
    by_law: [Vec<f64>; 2],
}

impl Periodic {
    /// Position of the cosine of the first harmonic.
    fn first(&self) -> usize {
        usize::from(self.harmonics[0] == 0)
    }

    /// Complex amplitude A of x = Im(A e^{iwt}).
    pub fn response(&self) -> (f64, f64) {
        (self.series[self.first() + 1], self.series[self.first()])
    }

    /// Mean.
    pub fn mean(&self) -> f64 {
        if self.first() == 0 { 0.0 } else { self.series[0] }
    }

    /// What is read of it, with its derivatives.
    pub fn found(&self, omega: f64) -> Found {
        Found {
            response: self.response(),
            mean: self.mean(),
            cycles: self.steps,
            left: self.left,
            multiplier: self.multiplier,
            rest: 0.0,
            by: self.derivatives(omega),
            by_law: self.by_laws().collect(),
        }
    }

    /// Derivatives of (real, imaginary) part of the amplitude by M, C, K, drive (real, imaginary), the joint's numbers
    /// and dry friction, of which it has none.
    fn derivatives(&self, omega: f64) -> [(f64, f64); 9] {
        let first = self.first();
        let part = |which: usize| {
            let adjoint = &self.adjoints[which];
            let (mut mass, mut damping) = (0.0, 0.0);
            let mut stiffness = if first == 0 { 0.0 } else { adjoint[0] * self.series[0] };
            for at in (first..self.series.len()).step_by(2) {
                let (a, b) = (self.series[at], self.series[at + 1]);
                let (u, v) = (adjoint[at], adjoint[at + 1]);
                let kw = self.harmonics[at] as f64 * omega;
                stiffness += u * a + v * b;
                mass -= kw * kw * (u * a + v * b);
                damping += kw * (u * b - v * a);
            }
            let joint = self.by_joint[which];
            // The drive stands on the other side.
            [-mass, -damping, -stiffness, adjoint[first + 1], adjoint[first], -joint[0], -joint[1], -joint[2], 0.0]
        };
        let (imaginary, real) = (part(0), part(1));
        std::array::from_fn(|i| (real[i], imaginary[i]))
    }

    /// The same by the parameters of the laws.
    fn by_laws(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.by_law[1].iter().zip(&self.by_law[0]).map(|(real, imaginary)| (*real, *imaginary))
    }
}

/// What is read of a periodic state.
#[derive(Debug, Clone)]
pub struct Found {
    /// Complex amplitude A of x = Im(A e^{iwt}).
    pub response: (f64, f64),
    /// Mean.
    pub mean: f64,
    /// Cycles, or Newton steps, that it took.
    pub cycles: usize,
    /// Relative size of the last correction.
    pub left: f64,
    /// Largest modulus of the Floquet multipliers.
    pub multiplier: f64,
    /// Share of the cycle in which the body rests.
    pub rest: f64,
    /// Derivatives of the response by M, C, K, drive (real, imaginary), the joint's numbers and dry friction.
    pub by: [(f64, f64); 9],
    /// The same by the parameters of the laws.
    pub by_law: Vec<(f64, f64)>,
}

/// All stable periodic states, the smallest amplitude first; without any, the unstable ones. And amplitudes near which
/// a branch of states may end at another drive ([`fold::end`]).
pub fn states(mode: &dyn SingleMode, tolerance: &Tolerance) -> (Vec<Periodic>, Vec<f64>) {
    let mut found: Vec<Periodic> = Vec::new();
    let mut near = nearly(mode);
    for around in AROUND {
        for root in &near.states {
            let Some(periodic) = solve(mode, around * root, tolerance) else { continue };
            let (re, im) = periodic.response();
            let same = |other: &Periodic| {
                let (x, y) = other.response();
                (re - x).hypot(im - y) < SAME * re.hypot(im)
            };
            if !found.iter().any(same) {
                found.push(periodic);
            }
        }
        if !found.is_empty() {
            break;
        }
    }
    let stable = |p: &Periodic| p.multiplier <= STABLE;
    if found.iter().any(stable) {
        found.retain(stable);
    }
    let size = |p: &Periodic| p.response().0.hypot(p.response().1);
    found.sort_by(|a, b| size(a).total_cmp(&size(b)));
    if found.len() < near.states.len() {
        // One harmonic sees a state, all of them none: it is close to an end.
        near.ends.extend(near.states);
    }
    (found, near.ends)
}

/// Forces at every instant with their slopes, and what they are on the harmonics.
struct Balance {
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    /// Of the joint, by its three numbers, on the harmonics.
    by_joint: Option<DMatrix<f64>>,
    /// Motion, velocity and tangential stiffness and damping at every instant.
    motion: Vec<[f64; 4]>,
}

/// A motion of this amplitude as one harmonic sees it: whether its even harmonics vanish, its series, and the factor to
/// the drive that holds it.
fn one_harmonic(mode: &dyn SingleMode, amplitude: f64) -> (bool, Vec<f64>, f64) {
    let ([mass, damping, stiffness], omega, (re, im)) = (mode.linear(), mode.omega(), mode.drive());
    let (k, c) = describing(mode, amplitude);
    // A = drive / Z.
    let (x, y) = (stiffness + k - mass * omega * omega, omega * damping + c);
    let square = x * x + y * y;
    let (a_re, a_im) = ((re * x + im * y) / square, (im * x - re * y) / square);
    let drive = amplitude / a_re.hypot(a_im);
    let odd = mode.is_odd(amplitude);
    let mut series = vec![companions(mode, amplitude)[0]; usize::from(!odd)];
    series.extend([a_im * drive, a_re * drive]);
    (odd, series, drive)
}

/// The periodic state that Newton's method reaches from a motion at the drive's frequency of this amplitude.
fn solve(mode: &dyn SingleMode, amplitude: f64, tolerance: &Tolerance) -> Option<Periodic> {
    let (odd, series, _) = one_harmonic(mode, amplitude);
    let mut steps = 0;
    with_harmonics(mode, odd, series, tolerance, |laid, series| newton(mode, laid, series, tolerance, &mut steps))
        .map(|(laid, series, (balance, left))| finished(mode, &laid, (series, steps, left), &balance))
}

/// Solves with as many harmonics as the motion needs: `solve` improves a series on the harmonics that are laid.
fn with_harmonics<T>(
    mode: &dyn SingleMode,
    odd: bool,
    mut series: Vec<f64>,
    tolerance: &Tolerance,
    mut solve: impl FnMut(&Laid, &mut [f64]) -> Option<T>,
) -> Option<(Rc<Laid>, Vec<f64>, T)> {
    let first = usize::from(!odd);
    for (level, &highest) in HARMONICS.iter().enumerate() {
        let mut instants = (INSTANTS * highest).max(24);
        let (most, least) = INSTANTS_AT_CORNERS;
        if mode.is_steep() {
            instants = instants.max(most);
        } else if mode.joint().is_some() || mode.has_corners() {
            let wanted = (most as f64 / tolerance.coarsening().powi(5)) as usize;
            instants = instants.max(wanted.max(least));
        }
        let laid = Laid::of(highest, instants + instants % 2, odd);
        series.resize(laid.harmonics.len(), 0.0);
        let solved = solve(&laid, &mut series)?;
        let size = |at: usize| series[at].hypot(series[at + 1]);
        let count = series.len();
        let tail = size(count - 2).max(size(count - 4)) / size(first);
        let last = level + 1 == HARMONICS.len();
        if tail < TAIL * tolerance.slack().sqrt() || (last && tail < LONGEST_TAIL) {
            return Some((laid, series, solved));
        }
    }
    None
}

/// Newton's method, its steps halved while they lead uphill.
fn newton(
    mode: &dyn SingleMode,
    laid: &Laid,
    series: &mut [f64],
    tolerance: &Tolerance,
    steps: &mut usize,
) -> Option<(Balance, f64)> {
    let mut balance = evaluate(mode, laid, series);
    let mut norm = balance.residual.norm();
    for _ in 0..STEPS {
        let step = balance.jacobian.clone().lu().solve(&balance.residual)?;
        let size = series.iter().map(|z| z * z).sum::<f64>().sqrt();
        let mut share = 1.0;
        loop {
            let moved: Vec<f64> = series.iter().zip(step.iter()).map(|(z, d)| z - share * d).collect();
            *steps += 1;
            let next = evaluate(mode, laid, &moved);
            let reached = next.residual.norm();
            let left = step.norm() / size;
            if !left.is_finite() || mode.is_given_up() {
                return None;
            }
            if reached <= norm || left < tolerance.left() {
                series.copy_from_slice(&moved);
                let done = left < tolerance.left();
                (balance, norm) = (next, reached);
                if done {
                    return Some((balance, left));
                }
                break;
            }
            share *= 0.5;
            if share < 1e-3 {
                return (left < AT_KINKS * tolerance.slack()).then_some((balance, left));
            }
        }
    }
    None
}

/// The balance of every harmonic: K x + C x' + M x'' - force + joint - drive, and its slopes.
fn evaluate(mode: &dyn SingleMode, laid: &Laid, series: &[f64]) -> Balance {
    let (omega, n, unknowns) = (mode.omega(), laid.projected, series.len());
    mode.spend(n * (mode.force_cost() + (SLOPE + unknowns) * unknowns));
    let z = DVector::from_column_slice(series);
    let (x, v) = (&laid.basis * &z, &laid.slopes * &z * omega);
    let mut force = DVector::zeros(n);
    let mut motion = Vec::with_capacity(n);
    for j in 0..n {
        let [value, by_x, by_v] = mode.force(x[j], v[j]);
        force[j] = -value;
        motion.push([x[j], v[j], -by_x, -by_v]);
    }
    // Slopes of the force by the unknowns, one column each.
    let mut slopes = DMatrix::zeros(n, unknowns);
    for m in 0..unknowns {
        let (basis, by_phase) = (laid.basis.column(m), laid.slopes.column(m));
        for (((slope, [_, _, k, c]), x), v) in slopes.column_mut(m).iter_mut().zip(&motion).zip(&basis).zip(&by_phase) {
            *slope = k * x + c * omega * v;
        }
    }
    let mut by_joint = None;
    if let Some(joint) = mode.joint() {
        let (mut by_parameters, mut tangent) = (DMatrix::zeros(n, 3), 0.0);
        let (pulls, corners) = pulls(joint, x.as_slice(), &turns(laid, series));
        for m in 0..unknowns {
            let basis = laid.basis.column(m);
            for ((slope, pull), x) in slopes.column_mut(m).iter_mut().zip(&pulls).zip(&basis) {
                let Some(from) = corners.get(pull.corner) else { break };
                *slope += from.by[m] + pull.stiffness * (x - from.dx[m]);
            }
        }
        for (j, pull) in pulls.into_iter().take(n).enumerate() {
            force[j] += pull.force;
            for (p, by) in pull.by_parameters.into_iter().enumerate() {
                by_parameters[(j, p)] = by;
            }
            tangent += pull.stiffness / n as f64;
        }
        // What a disturbance meets beside the memory of the elements, which only dissipates: their mean stiffness.
        motion.iter_mut().for_each(|at| at[2] += tangent);
        by_joint = Some(project(laid, &by_parameters));
    }
    let mut residual: DVector<f64> =
        project(laid, &DMatrix::from_column_slice(n, 1, force.as_slice())).column(0).into();
    let mut jacobian = project(laid, &slopes);
    add_linear_mode(mode, laid, series, &mut residual, &mut jacobian);
    Balance { residual, jacobian, by_joint, motion }
}

/// Adds to every harmonic the forces of the linear mode and takes off those of the drive.
fn add_linear_mode(
    mode: &dyn SingleMode,
    laid: &Laid,
    series: &[f64],
    residual: &mut DVector<f64>,
    jacobian: &mut DMatrix<f64>,
) {
    let ([mass, damping, stiffness], omega, (re, im)) = (mode.linear(), mode.omega(), mode.drive());
    if laid.harmonics[0] == 0 {
        residual[0] += stiffness * series[0];
        jacobian[(0, 0)] += stiffness;
    }
    for (i, k) in laid.pairs() {
        let kw = k as f64 * omega;
        let (along, across) = (stiffness - mass * kw * kw, damping * kw);
        let j = i + 1;
        residual[i] += along * series[i] + across * series[j];
        residual[j] += along * series[j] - across * series[i];
        jacobian[(i, i)] += along;
        jacobian[(i, j)] += across;
        jacobian[(j, j)] += along;
        jacobian[(j, i)] -= across;
    }
    let first = laid.cosine(1);
    residual[first] -= im;
    residual[first + 1] -= re;
}

/// Harmonics of columns that are given at the instants.
fn project(laid: &Laid, columns: &DMatrix<f64>) -> DMatrix<f64> {
    let mut harmonics = laid.basis.rows(0, laid.projected).tr_mul(columns) * (2.0 / laid.projected as f64);
    if laid.harmonics[0] == 0 {
        harmonics.row_mut(0).scale_mut(0.5);
    }
    harmonics
}

/// Where the motion turns back between an instant and the next: by the secant of its velocity there.
fn turns(laid: &Laid, series: &[f64]) -> Vec<Option<Instant>> {
    let n = laid.instants;
    let velocity = &laid.slopes * DVector::from_column_slice(series);
    let turn = |j: usize| {
        let (a, b) = (velocity[j], velocity[(j + 1) % n]);
        if (a > 0.0) == (b > 0.0) || a == b {
            return None;
        }
        let phase = TAU * (j as f64 + a / (a - b)) / n as f64;
        let (by, _) = basis_at(&laid.harmonics, phase);
        Some(Instant { x: by.iter().zip(series).map(|(b, z)| b * z).sum(), by })
    };
    (0..n).map(turn).collect()
}

/// The state with what its derivatives need.
fn finished(
    mode: &dyn SingleMode,
    laid: &Laid,
    (series, steps, left): (Vec<f64>, usize, f64),
    balance: &Balance,
) -> Periodic {
    let transposed = balance.jacobian.transpose().lu();
    let unknowns = series.len();
    let adjoint = |unknown: usize| -> Vec<f64> {
        let mut right = DVector::zeros(unknowns);
        right[unknown] = 1.0;
        transposed.solve(&right).map_or_else(|| vec![f64::NAN; unknowns], |found| found.iter().copied().collect())
    };
    let first = laid.cosine(1);
    let adjoints = [adjoint(first), adjoint(first + 1)];
    projected(mode, laid, (series, steps, left), balance, adjoints)
}

/// The state with the derivatives that these adjoints tell.
fn projected(
    mode: &dyn SingleMode,
    laid: &Laid,
    (series, steps, left): (Vec<f64>, usize, f64),
    balance: &Balance,
    adjoints: [Vec<f64>; 2],
) -> Periodic {
    let unknowns = series.len();
    let by_joint = [0, 1].map(|which| {
        let Some(by) = &balance.by_joint else { return [0.0; 3] };
        std::array::from_fn(|p| (0..unknowns).map(|m| adjoints[which][m] * by[(m, p)]).sum())
    });
    let by_law = [0, 1].map(|which| {
        let mut sums = vec![0.0; mode.columns()];
        if sums.is_empty() {
            return sums;
        }
        for (j, [x, v, ..]) in balance.motion.iter().enumerate() {
            let projected = |m: usize| laid.basis[(j, m)] * if laid.harmonics[m] == 0 { 1.0 } else { 2.0 };
            let weight: f64 = (0..unknowns).map(|m| adjoints[which][m] * projected(m)).sum();
            mode.add_columns(*x, *v, weight / laid.projected as f64, &mut sums);
        }
        sums
    });
    let multiplier = multiplier(mode, &balance.motion, laid.instants);
    let harmonics = laid.harmonics.clone();
    Periodic { harmonics, series, steps, left, multiplier, adjoints, by_joint, by_law }
}
