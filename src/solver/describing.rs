//! The balance of the first harmonic of a single mode: forces as a stiffness and a damping that depend on the
//! amplitude, and all amplitudes at which these are in balance.
//!
//! A law that is not the same to both sides shifts the mean and adds a second harmonic; both are taken along.

use super::joint::unloading;
use crate::model::system::SingleMode;
use crate::roots::regula_falsi;
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// Amplitudes at which the balance of the first harmonic is looked at, per factor of ten, and instants for it.
pub const GRID_PER_DECADE: f64 = 8.0;
const GRID_INSTANTS: usize = 16;
/// Factors of ten by which the range of amplitudes may be too short.
const DECADES: usize = 6;
/// Refinements of where two roots may have met; relative accuracy of roots and of the amplitudes of resonance.
const REFINEMENTS: usize = 30;
const ROOT: f64 = 1e-6;
const RESONANT: f64 = 1e-7;
/// Largest amplitude over that of a linear resonance: up to here the end of a branch is seen that a larger drive would
/// reach.
const BEYOND: f64 = 2.0;
/// A damping ratio that stands for none.
const UNDAMPED: f64 = 1e-9;
/// Step of differences by the logarithm of an amplitude: far below the width of a resonance, far above rounding.
const APART: f64 = 1e-4;
/// Newton steps from the end of a branch to where one harmonic has it.
const NEWTON_STEPS: usize = 4;
/// Steps towards mean and second harmonic of a motion.
const COMPANION_STEPS: usize = 12;

/// Amplitudes of one harmonic.
pub struct Nearly {
    /// Near which a stable state is looked for, in ascending order.
    pub states: Vec<f64>,
    /// At which the balance comes nearest without being reached: a branch of states ends at another drive.
    pub ends: Vec<f64>,
}

/// Amplitudes near which a stable state, or the end of a branch of them, is looked for.
pub fn nearly(mode: &dyn SingleMode) -> Nearly {
    let [.., stiffness] = mode.linear();
    // Of three the middle one is unstable, as is every other one between folds. Beyond where the restoring force ends
    // there is no oscillation.
    let (roots, mut ends) = first_harmonic_roots(mode);
    let oscillates = |amplitude: &f64| stiffness + describing(mode, *amplitude).0 > 0.0;
    ends.retain(oscillates);
    Nearly { states: roots.into_iter().step_by(2).filter(oscillates).collect(), ends }
}

/// How the end of a branch near this amplitude moves: derivatives of the logarithm of its amplitude and of its phase
/// \[rad\], in one harmonic. By M, C, K, the drive (real, imaginary), the joint's numbers (left out: zero) and dry
/// friction, then by the parameters of the laws.
pub(super) fn end_by_numbers(mode: &dyn SingleMode, amplitude: f64) -> Vec<(f64, f64)> {
    let ([mass, damping, stiffness], omega, (re, im)) = (mode.linear(), mode.omega(), mode.drive());
    let at = |log: f64| amplitude * log.exp();
    let both = |log: f64| {
        let (k, c) = describing(mode, at(log));
        [stiffness + k - mass * omega * omega, damping * omega + c]
    };
    let by_log = |log: f64| {
        let (above, below) = (both(log + APART), both(log - APART));
        std::array::from_fn::<f64, 2, _>(|i| (above[i] - below[i]) / (2.0 * APART))
    };
    // The excess ln(a |Z|) has the slope s = 1 + Z.Z'/Z.Z, which is zero at the end of a branch.
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let slope = |log: f64| 1.0 + dot(both(log), by_log(log)) / dot(both(log), both(log));
    let curvature = |log: f64| (slope(log + APART) - slope(log - APART)) / (2.0 * APART);
    let mut end = 0.0;
    for _ in 0..NEWTON_STEPS {
        end -= slope(end) / curvature(end);
    }
    let (z, by_log, curvature) = (both(end), by_log(end), curvature(end));
    let square = dot(z, z);
    let columns = |log: f64| -> Vec<[f64; 2]> {
        let own = [[-omega * omega, 0.0], [0.0, omega], [1.0, 0.0], [0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]];
        own.into_iter().chain([[0.0, 4.0 / (PI * at(log))]]).chain(describing_by_laws(mode, at(log))).collect()
    };
    let (here, above, below) = (columns(end), columns(end + APART), columns(end - APART));
    let of_drive = [(3, -im / (re * re + im * im)), (4, re / (re * re + im * im))];
    (0..here.len())
        .map(|p| {
            let turned: [f64; 2] = std::array::from_fn(|i| (above[p][i] - below[p][i]) / (2.0 * APART));
            let change = (dot(here[p], by_log) + dot(z, turned)) * square - 2.0 * dot(z, by_log) * dot(z, here[p]);
            let log = -change / (square * square * curvature);
            let moved: [f64; 2] = std::array::from_fn(|i| here[p][i] + by_log[i] * log);
            let phase = (z[1] * moved[0] - z[0] * moved[1]) / square;
            (log, phase + of_drive.iter().filter(|(own, _)| *own == p).map(|(_, by)| by).sum::<f64>())
        })
        .collect()
}

/// Derivatives of (stiffness, quadrature) of [`describing`] by the parameters of the laws.
fn describing_by_laws(mode: &dyn SingleMode, amplitude: f64) -> Vec<[f64; 2]> {
    let (omega, with) = (mode.omega(), companions(mode, amplitude));
    let mut sums = [vec![0.0; mode.columns()], vec![0.0; mode.columns()]];
    for &(sine, cosine) in &GRID_PHASES[0] {
        let (x, v) = accompanied((sine, cosine), amplitude, &with);
        let scale = -2.0 / (GRID_INSTANTS as f64 * amplitude);
        for (sum, part) in sums.iter_mut().zip([sine, cosine]) {
            mode.add_columns(x, omega * v, scale * part, sum);
        }
    }
    std::iter::zip(&sums[0], &sums[1]).map(|(k, c)| [*k, *c]).collect()
}

/// Mean, and cosine and sine of the second harmonic, with which a law that is not the same to both sides lets the body
/// swing as X sin(wt).
pub(super) fn companions(mode: &dyn SingleMode, amplitude: f64) -> [f64; 3] {
    let mut with = [0.0; 3];
    if mode.is_odd(amplitude) {
        return with;
    }
    let (omega, [mass, damping, stiffness]) = (mode.omega(), mode.linear());
    let (k, c) = (stiffness - 4.0 * mass * omega * omega, 2.0 * damping * omega);
    for _ in 0..COMPANION_STEPS {
        let [mut mean, mut slope, mut cosine, mut sine] = [0.0; 4];
        for &phase in &GRID_PHASES[0] {
            let (x, v) = accompanied(phase, amplitude, &with);
            let [force, by_x, _] = mode.force(x, omega * v).map(|part| part / GRID_INSTANTS as f64);
            let (twice_sine, twice_cosine) = twice(phase);
            (mean, slope) = (mean + force, slope + by_x);
            (cosine, sine) = (cosine + 2.0 * force * twice_cosine, sine + 2.0 * force * twice_sine);
        }
        // Beyond where the restoring force ends there is no mean.
        if slope >= stiffness {
            return [0.0; 3];
        }
        let moved = (mean - stiffness * with[0]) / (stiffness - slope);
        let square = k * k + c * c;
        let next = [with[0] + moved, (k * cosine - c * sine) / square, (k * sine + c * cosine) / square];
        let change = next.iter().zip(&with).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        with = next;
        if change < ROOT * amplitude {
            break;
        }
    }
    with
}

/// X sin(wt) with its companions, and its derivative by the phase.
fn accompanied(phase: (f64, f64), amplitude: f64, [mean, of_cosine, of_sine]: &[f64; 3]) -> (f64, f64) {
    let (sine, cosine) = twice(phase);
    (
        mean + amplitude * phase.0 + of_cosine * cosine + of_sine * sine,
        amplitude * phase.1 + 2.0 * (of_sine * cosine - of_cosine * sine),
    )
}

/// Sine and cosine of twice a phase.
fn twice((sine, cosine): (f64, f64)) -> (f64, f64) {
    (2.0 * sine * cosine, cosine * cosine - sine * sine)
}

/// Sine and cosine at the instants of the grid, and from the top down, where a joint is looked at.
static GRID_PHASES: LazyLock<[[(f64, f64); GRID_INSTANTS]; 2]> = LazyLock::new(|| {
    [0.0, 0.25].map(|from| std::array::from_fn(|j| (TAU * (from + (j as f64 + 0.5) / GRID_INSTANTS as f64)).sin_cos()))
});

/// Stiffness and quadrature of the forces over X sin(wt) with its companions: the dynamic stiffness without the linear
/// mode.
pub fn describing(mode: &dyn SingleMode, amplitude: f64) -> (f64, f64) {
    let (omega, n) = (mode.omega(), GRID_INSTANTS);
    let [instants, from_top] = &*GRID_PHASES;
    let (mut in_phase, mut quadrature) = (0.0, 0.0);
    // The second half of an odd motion is the negative of the first.
    let odd = mode.is_odd(amplitude);
    let with = if odd { [0.0; 3] } else { companions(mode, amplitude) };
    let looked = if odd { &instants[..n / 2] } else { &instants[..] };
    for &(sine, cosine) in looked {
        let (x, v) = accompanied((sine, cosine), amplitude, &with);
        let force = mode.force(x, omega * v)[0];
        in_phase -= force * sine;
        quadrature -= force * cosine;
    }
    let scale = 2.0 / (n as f64 * amplitude);
    let of_laws = 2.0 / (looked.len() as f64 * amplitude);
    let (mut k, mut c) = (of_laws * in_phase, of_laws * quadrature + 4.0 * mode.dry_friction() / (PI * amplitude));
    if let Some(joint) = mode.joint() {
        // On the way down from the top; on the way up it is the negative.
        let down = unloading(joint, amplitude);
        for &(sine, cosine) in &from_top[..n / 2] {
            let force = down(amplitude * sine);
            k += 2.0 * scale * force * sine;
            c += 2.0 * scale * force * cosine;
        }
    }
    (k, c)
}

/// Amplitudes at which the first harmonic is in balance, in ascending order, and those at which it comes nearest to it
/// between two places farther from it.
fn first_harmonic_roots(mode: &dyn SingleMode) -> (Vec<f64>, Vec<f64>) {
    let ([mass, damping, stiffness], omega, (re, im)) = (mode.linear(), mode.omega(), mode.drive());
    let drive = re.hypot(im);
    let static_part = stiffness - mass * omega * omega;
    let resistance = (damping * omega).max(UNDAMPED * omega * (mass * stiffness).sqrt());
    // Nothing moves more than a mode in resonance that only the linear damping holds; beyond, to see what more drive
    // would reach.
    let mut most = BEYOND * drive / resistance;
    let detuning = |log: f64| static_part + describing(mode, log.exp()).0;
    let both = |log: f64| {
        let x = log.exp();
        let (k, c) = describing(mode, x);
        ((x * (static_part + k).hypot(resistance + c) / drive).ln(), static_part + k > 0.0)
    };
    let excess = |log: f64| both(log).0;
    // From where no force of an effect can matter: far below the linear motion.
    let mut least = 1e-2 * (drive / static_part.hypot(resistance)).min(drive / stiffness).min(most);
    if !(least > 0.0 && most.is_finite()) {
        return Default::default();
    }
    // A force that is much stronger than the mode's own at any amplitude, or that drives it, moves the ends.
    for _ in 0..DECADES {
        let (below, above) = (excess(least.ln()) > 0.0, excess(most.ln()) < 0.0);
        if !below && !above {
            break;
        }
        (least, most) = (if below { 0.1 * least } else { least }, if above { 10.0 * most } else { most });
    }
    let (low, high) = (least.ln(), most.ln());
    let count = ((high - low) / std::f64::consts::LN_10 * GRID_PER_DECADE).ceil().max(8.0) as usize;
    let at = |i: usize| low + (high - low) * i as f64 / count as f64;
    let looked: Vec<(f64, bool)> = (0..=count).map(|i| both(at(i))).collect();
    let mut grid: Vec<(f64, f64)> = looked.iter().enumerate().map(|(i, (excess, _))| (at(i), *excess)).collect();
    // At the amplitudes of resonance the excess has dips as narrow as the resonance.
    for i in (1..=count).filter(|&i| looked[i].1 != looked[i - 1].1) {
        let bracket = [grid[i - 1].0, grid[i].0];
        let resonance = regula_falsi(detuning, bracket, bracket.map(detuning), (RESONANT, 0.0), REFINEMENTS);
        grid.push((resonance, excess(resonance)));
    }
    grid.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Where the excess turns back before it reaches zero, two roots may lie between three places.
    let (mut inserted, mut ends) = (Vec::new(), Vec::new());
    for three in grid.windows(3) {
        let [a, b, c] = [three[0], three[1], three[2]];
        let towards = |s: f64| s * b.1 > 0.0 && s * b.1 <= s * a.1 && s * b.1 <= s * c.1;
        let Some(sign) = [1.0, -1.0].into_iter().find(|s| towards(*s)) else { continue };
        let nearest = nearest_to_zero(&excess, sign, [a.0, b.0, c.0], b);
        if sign * nearest.1 > 0.0 {
            ends.push(nearest.0.exp());
        }
        inserted.push(nearest);
    }
    grid.extend(inserted);
    grid.sort_by(|a, b| a.0.total_cmp(&b.0));
    (sign_changes(&grid, excess).map(f64::exp).collect(), ends)
}

/// Roots between neighbours of a grid of places and values.
fn sign_changes(grid: &[(f64, f64)], excess: impl Fn(f64) -> f64) -> impl Iterator<Item = f64> {
    let changes =
        grid.windows(2).map(|pair| (pair[0], pair[1])).filter(|((_, fa), (_, fb))| (*fa > 0.0) != (*fb > 0.0));
    changes.map(move |((a, fa), (b, fb))| regula_falsi(&excess, [a, b], [fa, fb], (ROOT, 0.0), REFINEMENTS))
}

/// The place between the outer two at which the excess, of one sign at all three, comes nearest to zero (golden
/// section).
fn nearest_to_zero(excess: &impl Fn(f64) -> f64, sign: f64, [a, _, c]: [f64; 3], best: (f64, f64)) -> (f64, f64) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high, mut best) = (a, c, best);
    for _ in 0..REFINEMENTS {
        let (x, y) = (high - golden * (high - low), low + golden * (high - low));
        let (fx, fy) = (excess(x), excess(y));
        for (place, value) in [(x, fx), (y, fy)] {
            if sign * value < sign * best.1 {
                best = (place, value);
            }
        }
        if sign * best.1 <= 0.0 {
            return best;
        }
        if sign * fx < sign * fy { high = y } else { low = x }
    }
    best
}
