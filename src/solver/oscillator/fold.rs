//! The end of a branch of states: the least drive, or the largest, at which there is a state of the kind.
//!
//! A reading that is on a branch which a model does not quite reach is no reading of the other branch. Held against the
//! end of its branch, by how far that is off in amplitude and in drive, it leads a fit there without a step in the
//! misfit.

use super::super::describing::{GRID_PER_DECADE, end_by_numbers};
use super::laid::Laid;
use super::{Balance, Found, STEPS, Tolerance, evaluate, one_harmonic, projected, with_harmonics};
use crate::model::system::SingleMode;
use nalgebra::{DMatrix, DVector};
use std::rc::Rc;

/// Step of the amplitude, in logarithm, with which its search begins, and below which it ends.
const SECANT: (f64, f64) = (1e-3, 1e-7);
/// Steps of that search.
const SECANTS: usize = 12;
/// Farthest that the end may be from where one harmonic sees it, in logarithm: a place of the grid there.
const FARTHEST: f64 = std::f64::consts::LN_10 / GRID_PER_DECADE;

/// The end of a branch of states.
#[derive(Debug, Clone)]
pub struct End {
    /// What is read of it, its derivatives in one harmonic.
    pub found: Found,
    /// Logarithm of the factor to the drive at which the branch ends: above zero the branch is not reached. Of a branch
    /// that ends for too much drive, that of its inverse.
    pub lacks: f64,
    /// Derivatives of that by M, C, K, the drive, the joint's numbers and dry friction.
    pub by: [f64; 9],
    /// By the parameters of the laws.
    pub by_law: Vec<f64>,
}

/// The end of a branch near this amplitude, where there is one.
pub fn end(mode: &dyn SingleMode, amplitude: f64, tolerance: &Tolerance) -> Option<End> {
    let mut held = Held::at(mode, amplitude, tolerance)?;
    let (mut log, mut moved, mut curvature) = (0.0, SECANT.0, 0.0);
    for _ in 0..SECANTS {
        let next = Held::at(mode, amplitude * f64::exp(log + moved), tolerance)?;
        curvature = (next.slope - held.slope) / moved;
        (log, held) = (log + moved, next);
        moved = -held.slope / curvature;
        if !moved.is_finite() || (log + moved).abs() > FARTHEST {
            return None;
        }
        if moved.abs() < SECANT.1 {
            break;
        }
    }
    let sign = curvature.signum();
    let Held { laid, series, drive, adjoint, balance, .. } = held;
    let none = vec![0.0; adjoint.len()];
    let mut found = projected(mode, &laid, (series, 0, moved.abs()), &balance, [adjoint, none]).found(mode.omega());
    let (re, im) = found.response;
    let one_harmonic = end_by_numbers(mode, re.hypot(im));
    if one_harmonic.iter().any(|(log, phase)| !(log.is_finite() && phase.is_finite())) {
        return None;
    }
    // A moves by A (d ln a + i d phi).
    let by_response = |&(log, phase): &(f64, f64)| (re * log - im * phase, im * log + re * phase);
    let by_response: Vec<(f64, f64)> = one_harmonic.iter().map(by_response).collect();
    // The adjoint of the drive stands where that of the cosine does, which is the imaginary part.
    let by: [f64; 9] = std::array::from_fn(|i| {
        // The drive itself is as many times as large.
        let share = if i == 3 || i == 4 { 1.0 } else { 1.0 / drive };
        sign * share * found.by[i].1
    });
    let by_law = found.by_law.iter().map(|(_, imaginary)| sign * imaginary / drive).collect();
    found.by.copy_from_slice(&by_response[..9]);
    found.by_law = by_response[9..].to_vec();
    Some(End { found, lacks: sign * drive.ln(), by, by_law })
}

/// A motion of given amplitude, and the drive that holds it.
struct Held {
    laid: Rc<Laid>,
    series: Vec<f64>,
    /// Factor to the drive.
    drive: f64,
    /// Slope of its logarithm by that of the amplitude, and its adjoint.
    slope: f64,
    adjoint: Vec<f64>,
    balance: Balance,
}

impl Held {
    /// The motion of this amplitude: Newton's method for the series and the drive, from one harmonic.
    fn at(mode: &dyn SingleMode, amplitude: f64, tolerance: &Tolerance) -> Option<Self> {
        let (odd, series, mut drive) = one_harmonic(mode, amplitude);
        let newton = |laid: &Laid, series: &mut [f64]| newton(mode, laid, (series, &mut drive), amplitude, tolerance);
        let (laid, series, (balance, bordered)) = with_harmonics(mode, odd, series, tolerance, newton)?;
        let unit = |last: f64| DVector::from_fn(series.len() + 1, |i, _| if i == series.len() { last } else { 0.0 });
        // The bordered matrix by a change of the amplitude, and by the drive.
        let slope = bordered.clone().lu().solve(&unit(mode.linear()[2] * amplitude))?[series.len()] / drive;
        let adjoint = bordered.transpose().lu().solve(&unit(1.0))?;
        let adjoint = adjoint.iter().take(series.len()).copied().collect();
        Some(Self { laid, series, drive, slope, adjoint, balance })
    }
}

/// Newton's method for a motion of given amplitude and the drive; with the bordered matrix at its end.
fn newton(
    mode: &dyn SingleMode,
    laid: &Laid,
    (series, drive): (&mut [f64], &mut f64),
    amplitude: f64,
    tolerance: &Tolerance,
) -> Option<(Balance, DMatrix<f64>)> {
    let ([.., stiffness], (re, im)) = (mode.linear(), mode.drive());
    let (n, first) = (series.len(), laid.cosine(1));
    let of_drive = [(first, im), (first + 1, re)];
    for _ in 0..STEPS {
        let balance = evaluate(mode, laid, series);
        let mut bordered = balance.jacobian.clone().resize(n + 1, n + 1, 0.0);
        let mut residual = balance.residual.clone().resize_vertically(n + 1, 0.0);
        let weight = stiffness / amplitude;
        for (i, part) in of_drive {
            bordered[(i, n)] = -part;
            residual[i] -= (*drive - 1.0) * part;
            bordered[(n, i)] = weight * series[i];
            residual[n] += 0.5 * weight * series[i] * series[i];
        }
        residual[n] -= 0.5 * weight * amplitude * amplitude;
        let step = bordered.clone().lu().solve(&residual)?;
        series.iter_mut().zip(step.iter()).for_each(|(z, d)| *z -= d);
        *drive -= step[n];
        let left = step.rows(0, n).norm() / amplitude + (step[n] / *drive).abs();
        if left < tolerance.left() {
            return Some((balance, bordered));
        }
        if !left.is_finite() {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::oscillator::states;

    /// A mode of quality 110 with a cubic spring, driven by `force` at `omega` times its frequency.
    #[derive(Clone, Copy)]
    struct Duffing {
        stiffness: f64,
        damping: f64,
        cubic: f64,
        force: f64,
        omega: f64,
    }

    impl SingleMode for Duffing {
        fn linear(&self) -> [f64; 3] {
            [1.0, self.damping, self.stiffness]
        }
        fn drive(&self) -> (f64, f64) {
            (0.8 * self.force, 0.6 * self.force)
        }
        fn omega(&self) -> f64 {
            self.omega
        }
        fn force(&self, x: f64, _: f64) -> [f64; 3] {
            [-self.cubic * x.powi(3), -3.0 * self.cubic * x * x, 0.0]
        }
        fn is_odd(&self, _: f64) -> bool {
            true
        }
        fn has_corners(&self) -> bool {
            false
        }
        fn joint(&self) -> Option<[f64; 3]> {
            None
        }
        fn dry_friction(&self) -> f64 {
            0.0
        }
        fn is_steep(&self) -> bool {
            false
        }
        fn add_columns(&self, x: f64, _: f64, weight: f64, sums: &mut [f64]) {
            sums[0] -= weight * x.powi(3);
        }
        fn columns(&self) -> usize {
            1
        }
    }

    /// Above its peak and below the drop of the way down: on either side no state is left.
    fn beyond() -> [Duffing; 2] {
        let mode =
            |force: f64, omega: f64| Duffing { stiffness: 1.0, damping: 1.0 / 110.0, cubic: 0.235, force, omega };
        [mode(0.8 / 110.0, 1.07), mode(2.0 / 110.0, 1.02)]
    }

    fn end_of(mode: &Duffing) -> End {
        let (found, ends) = states(mode, &Tolerance::default());
        assert_eq!((found.len(), ends.len()), (1, 1));
        end(mode, ends[0], &Tolerance::default()).expect("an end")
    }

    #[test]
    fn a_branch_ends_at_the_drive_that_it_says() {
        for (mode, upwards) in std::iter::zip(beyond(), [true, false]) {
            let end = end_of(&mode);
            assert!(end.lacks > 0.01, "{}", end.lacks);
            let factor = if upwards { end.lacks } else { -end.lacks };
            for (by, exists) in [(1e-5, true), (-1e-5, false)] {
                let by = if upwards { by } else { -by };
                let mode = Duffing { force: mode.force * (factor + by).exp(), ..mode };
                let (re, im) = end.found.response;
                let near = |share: f64| {
                    let state = super::super::solve(&mode, share * re.hypot(im), &Tolerance::default())?;
                    let (x, y) = state.response();
                    ((x - re).hypot(y - im) < 0.05 * re.hypot(im)).then_some(())
                };
                assert_eq!([0.99, 1.01].into_iter().filter_map(near).count() > 0, exists, "{factor} {by}");
            }
        }
    }

    #[test]
    fn its_derivatives_are_those_of_differences() {
        type Change = (usize, fn(&mut Duffing) -> &mut f64);
        let numbers: [Change; 3] = [(1, |m| &mut m.damping), (2, |m| &mut m.stiffness), (9, |m| &mut m.cubic)];
        for mode in beyond() {
            let end = end_of(&mode);
            for (number, of) in numbers {
                let moved = |by: f64| {
                    let mut mode = mode;
                    *of(&mut mode) += by;
                    end_of(&mode)
                };
                let h = 1e-4 * *of(&mut mode.clone());
                let (above, below) = (moved(h), moved(-h));
                let difference = (above.lacks - below.lacks) / (2.0 * h);
                let (by, response) = match number {
                    9 => (end.by_law[0], end.found.by_law[0]),
                    i => (end.by[i], end.found.by[i]),
                };
                assert!((by / difference - 1.0).abs() < 1e-4, "{number}: {by} {difference}");
                let ([a, b], size) =
                    ([above, below].map(|e| e.found.response), end.found.response.0.hypot(end.found.response.1));
                let apart = [(a.0 - b.0) / (2.0 * h), (a.1 - b.1) / (2.0 * h)];
                let off = (response.0 - apart[0]).hypot(response.1 - apart[1]) * h / size;
                let change = apart[0].hypot(apart[1]) * h / size;
                // In one harmonic: good enough to lead.
                assert!(off < 0.05 * change + 1e-7, "{number}: {response:?} {apart:?}");
            }
        }
    }
}
