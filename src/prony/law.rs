//! The laws of a linear viscoelastic solid whose amounts are zero or more: series of relaxations, spring-pot, constant
//! moduli.

use super::nnls::nnls;
use super::{Kind, Moduli, Point};
use nalgebra::{Complex, DMatrix, DVector};
use statrs::function::gamma::gamma;
use std::f64::consts::FRAC_PI_2;

/// Exponents between which that of a spring-pot lies, how many are tried, and steps of the golden section beside the
/// best.
const EXPONENTS: (f64, f64, usize) = (0.01, 0.99, 50);
const STEPS: usize = 40;

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
    /// So many relaxation times, evenly on a logarithmic scale over the band of a table, the longest first.
    pub fn series(terms: usize, moduli: &Moduli) -> Self {
        let (low, high) = moduli.band();
        let share = |j: usize| if terms == 1 { 0.5 } else { j as f64 / (terms - 1) as f64 };
        Self::Series((0..terms).map(|j| (-(low.ln() + share(j) * (high / low).ln())).exp()).collect())
    }

    /// The amounts, and the exponent, that bring the sum of squared relative residuals at `points` to its minimum.
    pub fn fit(&self, moduli: &Moduli, points: &[Point]) -> Fitted {
        let center = moduli.center();
        let at = |exponent: f64| {
            let mut fitted = Fitted { law: self.clone(), exponent, center, amounts: Vec::new() };
            let square = fitted.solve(moduli, points);
            (square, fitted)
        };
        if *self != Self::SpringPot {
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
        let (kind, scale) = (moduli.kind, moduli.scale());
        let rows: Vec<(Vec<[f64; 2]>, usize, f64)> = points
            .iter()
            .flat_map(|point| {
                let columns = self.columns(kind, point.x);
                (0..kind.readings()).map(move |k| (columns.clone(), k, point.y[k] / scale))
            })
            .collect();
        let width = rows.first().map_or(0, |row| row.0.len());
        let a = DMatrix::from_fn(rows.len(), width, |i, j| rows[i].0[j][rows[i].1] / rows[i].2);
        let b = DVector::from_element(rows.len(), 1.0);
        let x = nnls(&a, &b);
        self.amounts = x.iter().map(|amount| amount * scale).collect();
        (a * x - b).norm_squared()
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
        self.amounts.iter().map(|amount| amount / moduli.scale()).collect()
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
