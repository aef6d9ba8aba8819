//! The laws of a linear viscoelastic solid whose amounts are zero or more: series of relaxations, spring-pot, constant
//! moduli.

use super::nnls::nnls;
use super::{Kind, Moduli, Point};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Complex, DMatrix, DVector, Dyn, storage::Owned};
use statrs::function::gamma::gamma;
use std::f64::consts::FRAC_PI_2;

/// Exponents between which that of a spring-pot lies, how many are tried, and steps of the golden section beside the
/// best.
const EXPONENTS: (f64, f64, usize) = (0.01, 0.99, 50);
const STEPS: usize = 40;

/// Relative change of the sum of squares at which a fit of relaxation times is done, and evaluations at most, in the
/// number of times.
const CONVERGED: f64 = 1e-5;
const EVALUATIONS: usize = 12;

/// What is fitted.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// An elastic part and relaxations with these times \[s\] (generalised Maxwell; of a compliance, generalised
    /// Kelvin).
    Series(Vec<f64>),
    /// An elastic part and a fractional element of any exponent.
    SpringPot,
    /// A storage and a loss modulus that do not depend on the frequency.
    Constant,
}

/// A law with its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The law.
    pub law: Law,
    /// Exponent of the spring-pot.
    pub exponent: f64,
    /// Where the spring-pot's amount is that of its modulus \[rad/s or s\].
    pub center: f64,
    /// The elastic part first, in the unit of the table (SI).
    pub amounts: Vec<f64>,
}

impl Law {
    /// So many relaxation times, evenly on a logarithmic scale within the band of a table, the longest first: where a fit
    /// begins.
    pub fn series(terms: usize, moduli: &Moduli) -> Self {
        let (low, high) = moduli.band();
        let share = |j: usize| (j as f64 + 0.5) / terms as f64;
        Self::Series((0..terms).map(|j| (-(low.ln() + share(j) * (high / low).ln())).exp()).collect())
    }

    /// The amounts, and the exponent or the times, that bring the sum of squared relative residuals at `points` to its
    /// minimum; times from those of the law on, within the band of the table: nothing outside it is determined.
    pub fn fit(&self, moduli: &Moduli, points: &[Point]) -> Fitted {
        if let Self::Series(times) = self {
            return Times::fit(times, moduli, points);
        }
        let center = moduli.center();
        let at = |exponent: f64| {
            let mut fitted = Fitted { law: self.clone(), exponent, center, amounts: Vec::new() };
            let square = fitted.solve(moduli, points);
            (square, fitted)
        };
        if *self == Self::Constant {
            return at(0.0).1;
        }
        let (low, high, count) = EXPONENTS;
        let step = (high - low) / (count - 1) as f64;
        let tried = (0..count).map(|i| low + step * i as f64).min_by(|a, b| at(*a).0.total_cmp(&at(*b).0));
        let best = tried.unwrap_or(low);
        let ends = ((best - step).max(low), (best + step).min(high));
        at(golden(ends, |exponent| at(exponent).0)).1
    }
}

/// Where a function has its minimum between two ends that hold one, by the golden section.
pub(super) fn golden((mut from, mut to): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..STEPS {
        let (a, b) = (to - share * (to - from), from + share * (to - from));
        if f(a) < f(b) { to = b } else { from = a }
    }
    0.5 * (from + to)
}

impl Fitted {
    /// Sets the amounts to their best at `points`; the sum of squares there.
    fn solve(&mut self, moduli: &Moduli, points: &[Point]) -> f64 {
        let a = self.matrix(moduli, points);
        let b = DVector::from_element(a.nrows(), 1.0);
        let (x, scale) = (nnls(&a, &b), moduli.scale());
        self.amounts = x.iter().map(|amount| amount * scale).collect();
        (a * x - b).norm_squared()
    }

    /// What a unit of each amount, in that of the middle of the readings, is of every reading, relative to that.
    pub(super) fn matrix(&self, moduli: &Moduli, points: &[Point]) -> DMatrix<f64> {
        let (kind, scale) = (moduli.kind, moduli.scale());
        let rows: Vec<(Vec<[f64; 2]>, usize, f64)> = points
            .iter()
            .flat_map(|point| {
                let columns = self.columns(kind, point.x);
                (0..kind.readings()).map(move |k| (columns.clone(), k, point.y[k] / scale))
            })
            .collect();
        let width = rows.first().map_or(0, |row| row.0.len());
        DMatrix::from_fn(rows.len(), width, |i, j| rows[i].0[j][rows[i].1] / rows[i].2)
    }

    /// The same without relaxations that have no amount, but for one.
    pub(super) fn reduced(mut self) -> Self {
        if let Law::Series(times) = &mut self.law {
            let amounts = self.amounts.split_off(1);
            let mut kept: Vec<(f64, f64)> = times.iter().copied().zip(amounts).collect();
            let first = kept[0];
            kept.retain(|(_, amount)| *amount > 0.0);
            if kept.is_empty() {
                kept.push(first);
            }
            *times = kept.iter().map(|(time, _)| *time).collect();
            self.amounts.extend(kept.iter().map(|(_, amount)| *amount));
        }
        self
    }

    /// Puts the relaxations in order, the longest time first.
    fn sort(&mut self) {
        let Law::Series(times) = &mut self.law else { return };
        let mut pairs: Vec<(f64, f64)> = times.iter().copied().zip(self.amounts[1..].iter().copied()).collect();
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (j, (time, amount)) in pairs.into_iter().enumerate() {
            (times[j], self.amounts[j + 1]) = (time, amount);
        }
    }

    /// What a unit of each amount is of the readings at a frequency \[rad/s\] or a time \[s\].
    fn columns(&self, kind: Kind, x: f64) -> Vec<[f64; 2]> {
        let elastic = [1.0, 0.0];
        let a = self.exponent;
        match (&self.law, kind) {
            (Law::Series(times), _) => {
                std::iter::once(elastic).chain(times.iter().map(|tau| relaxation(kind, x, *tau))).collect()
            }
            (Law::Constant, _) => vec![elastic, [0.0, 1.0]],
            (Law::SpringPot, Kind::Dynamic) => {
                let (sin, cos) = (FRAC_PI_2 * a).sin_cos();
                let size = (x / self.center).powf(a);
                vec![elastic, [size * cos, size * sin]]
            }
            (Law::SpringPot, Kind::Relaxation) => {
                vec![elastic, [(x / self.center).powf(-a) / gamma(1.0 - a), 0.0]]
            }
            (Law::SpringPot, Kind::Creep) => vec![elastic, [(x / self.center).powf(a) / gamma(1.0 + a), 0.0]],
        }
    }

    /// The amounts over the middle of the readings: their squares are numbers whatever the unit.
    pub(super) fn shares(&self, moduli: &Moduli) -> Vec<f64> {
        {
            let scale = moduli.scale();
            self.amounts.iter().map(|amount| amount / scale).collect()
        }
    }

    /// The readings that the law gives at a frequency \[rad/s\] or a time \[s\].
    pub fn value(&self, kind: Kind, x: f64) -> [f64; 2] {
        let columns = self.columns(kind, x);
        [0, 1].map(|k| columns.iter().zip(&self.amounts).map(|(column, amount)| column[k] * amount).sum())
    }

    /// Complex modulus of a series at an angular frequency \[rad/s\], whatever it was fitted to.
    pub fn modulus(&self, kind: Kind, omega: f64) -> Complex<f64> {
        let [storage, loss] = self.value(Kind::Dynamic, omega);
        let dynamic = Complex::new(storage, loss);
        if kind != Kind::Creep {
            return dynamic;
        }
        // J = J_0 + sum of J_j/(1 + iwt) = J_0 + sum of J_j less what iwt/(1 + iwt) has of it.
        let compliance = Complex::from(self.amounts.iter().sum::<f64>() + self.amounts[0]) - dynamic;
        compliance.inv()
    }
}

/// Relaxation times on their way to the least squares, amounts at their best everywhere (variable projection: Golub and
/// Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; derivatives after Kaufman, BIT 15 (1975) 49).
struct Times<'a> {
    moduli: &'a Moduli,
    points: &'a [Point],
    /// log time = middle + half sin(u): no end of the band can be passed.
    u: DVector<f64>,
    fitted: Fitted,
    /// What a unit of each amount is of the readings, and the amounts in the unit of that.
    matrix: DMatrix<f64>,
    amounts: DVector<f64>,
}

impl<'a> Times<'a> {
    /// The series of least squares from these times on, the longest first.
    fn fit(times: &[f64], moduli: &'a Moduli, points: &'a [Point]) -> Fitted {
        let fitted = Fitted { law: Law::Constant, exponent: 0.0, center: moduli.center(), amounts: Vec::new() };
        let (matrix, amounts) = (DMatrix::zeros(0, 0), DVector::zeros(0));
        let mut problem = Self { moduli, points, u: DVector::zeros(times.len()), fitted, matrix, amounts };
        let (middle, half) = problem.band();
        let u = times.iter().map(|time| ((time.ln() - middle) / half).clamp(-1.0, 1.0).asin());
        problem.set_params(&DVector::from_iterator(times.len(), u));
        let (begun, from) = (problem.residuals().map_or(f64::INFINITY, |r| r.norm()), problem.fitted.clone());
        let how = LevenbergMarquardt::new().with_ftol(CONVERGED).with_patience(EVALUATIONS);
        let (ended, report) = how.minimize(problem);
        let mut fitted = if (2.0 * report.objective_function).sqrt() <= begun { ended.fitted } else { from };
        fitted.sort();
        fitted
    }

    /// Middle of the logarithms of the times within the band, and half their width.
    fn band(&self) -> (f64, f64) {
        let (low, high) = self.moduli.band();
        (-0.5 * (low.ln() + high.ln()), (0.5 * (high / low).ln()).max(f64::EPSILON))
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Times<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, u: &DVector<f64>) {
        let (middle, half) = self.band();
        self.u = u.clone();
        self.fitted.law = Law::Series(u.iter().map(|u| (middle + half * u.sin()).exp()).collect());
        self.matrix = self.fitted.matrix(self.moduli, self.points);
        self.amounts = nnls(&self.matrix, &DVector::from_element(self.matrix.nrows(), 1.0));
        let scale = self.moduli.scale();
        self.fitted.amounts = self.amounts.iter().map(|amount| amount * scale).collect();
    }

    fn params(&self) -> DVector<f64> {
        self.u.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(&self.matrix * &self.amounts - DVector::from_element(self.matrix.nrows(), 1.0))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let Law::Series(times) = &self.fitted.law else { return None };
        let ((_, half), kind, scale) = (self.band(), self.moduli.kind, self.moduli.scale());
        let rows = self.points.iter().flat_map(|p| (0..kind.readings()).map(move |k| (p, k)));
        let rows: Vec<(&Point, usize)> = rows.collect();
        let slope = |i: usize, j: usize| {
            let (point, k) = rows[i];
            let weight = self.amounts[j + 1] * scale / point.y[k];
            weight * by_log_time(kind, point.x, times[j])[k] * half * self.u[j].cos()
        };
        let mut jacobian = DMatrix::from_fn(rows.len(), times.len(), slope);
        // What the amounts take back of it.
        let free: Vec<usize> = (0..self.amounts.len()).filter(|j| self.amounts[*j] > 0.0).collect();
        if !free.is_empty() && free.len() <= rows.len() {
            let q = self.matrix.select_columns(&free).qr().q();
            jacobian -= &q * q.tr_mul(&jacobian);
        }
        Some(jacobian)
    }
}

/// Derivatives of [`relaxation`] by the logarithm of its time.
fn by_log_time(kind: Kind, x: f64, tau: f64) -> [f64; 2] {
    let q = x * tau;
    match kind {
        Kind::Dynamic => {
            let share = 1.0 / (q + 1.0 / q);
            [2.0 * share * share, share * (1.0 / q - q) / (q + 1.0 / q)]
        }
        Kind::Relaxation => [x / tau * (-x / tau).exp(), 0.0],
        Kind::Creep => [-x / tau * (-x / tau).exp(), 0.0],
    }
}

/// A unit relaxation of time tau: iwt/(1 + iwt), exp(-t/tau), and of a compliance 1 - exp(-t/tau); without overflow.
pub(super) fn relaxation(kind: Kind, x: f64, tau: f64) -> [f64; 2] {
    let q = x * tau;
    match kind {
        Kind::Dynamic => [1.0 / (1.0 + 1.0 / (q * q)), 1.0 / (q + 1.0 / q)],
        Kind::Relaxation => [(-x / tau).exp(), 0.0],
        Kind::Creep => [-(-x / tau).exp_m1(), 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_by_the_times_are_those_of_differences() {
        for kind in [Kind::Dynamic, Kind::Relaxation, Kind::Creep] {
            for (x, tau) in [(0.3, 2.0), (5.0, 0.1), (1.0, 1.0)] {
                let step = 1e-6f64;
                let [more, less] = [step, -step].map(|step| relaxation(kind, x, tau * step.exp()));
                for (k, slope) in by_log_time(kind, x, tau).into_iter().enumerate() {
                    assert!((slope - (more[k] - less[k]) / (2.0 * step)).abs() < 1e-8, "{kind:?} {x} {tau} {k}");
                }
            }
        }
    }

    /// A standard linear solid has its compliance in closed form: J_0 = 1/(E_0 + E_1), J_1 = 1/E_0 - J_0, its time
    /// longer by (E_0 + E_1)/E_0.
    #[test]
    fn the_modulus_of_a_compliance_is_that_of_the_same_solid() {
        let (e0, e1, tau) = (2.0, 3.0, 0.1);
        let of = |times, amounts| Fitted { law: Law::Series(times), exponent: 0.0, center: 1.0, amounts };
        let maxwell = of(vec![tau], vec![e0, e1]);
        let kelvin = of(vec![tau * (e0 + e1) / e0], vec![1.0 / (e0 + e1), 1.0 / e0 - 1.0 / (e0 + e1)]);
        for omega in [1e-9, 0.3, 10.0, 1e9] {
            let [a, b] = [maxwell.modulus(Kind::Dynamic, omega), kelvin.modulus(Kind::Creep, omega)];
            assert!((a - b).norm() < 1e-12 * a.norm(), "{omega}: {a} {b}");
        }
    }
}
