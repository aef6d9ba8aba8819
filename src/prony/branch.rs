//! The contact of a scenario that comes nearest to a series: springs, a dashpot and the one Maxwell branch that it has
//! room for (`effects/combine.rs`).

use super::law::{golden, relaxation};
use super::nnls::nnls;
use super::{Analysis, Kind};
use crate::scenario::diagnostic::quote;
use crate::units::{self, readable};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Frequencies at which both are compared, and relaxation times that are tried.
const PLACES: usize = 41;
const TIMES: usize = 81;
/// How far beyond the band relaxation times are tried, as a factor.
const BEYOND: f64 = 30.0;
/// Share of the storage modulus that the elastic part has at least: a contact has a stiffness.
const LEAST: f64 = 1e-3;

/// E(iw) = elastic + iw viscous + amount iwt/(1 + iwt).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Branch {
    /// Band for which it holds \[Hz\].
    pub band_hz: [f64; 2],
    /// Elastic part \[Pa\].
    pub elastic: f64,
    /// What relaxations much faster than the band amount to \[Pa s\].
    pub viscous: f64,
    /// Modulus of the branch \[Pa\].
    pub amount: f64,
    /// Its relaxation time \[s\].
    pub time: f64,
    /// Root mean square of the relative errors against the series, of storage and loss modulus.
    pub rms: [f64; 2],
}

impl Branch {
    /// The nearest to the series of an analysis over a band \[Hz\]; an error says where the table determines nothing of
    /// it.
    pub fn nearest(analysis: &Analysis, (low, high): (f64, f64)) -> Result<Self, String> {
        let known = analysis.moduli.band();
        let known = (known.0 / TAU, known.1 / TAU);
        if high < known.0 || low > known.1 {
            return Err(format!(
                "the experiment is at {} and the table determines the modulus at {}",
                hertz(low, high),
                hertz(known.0, known.1)
            ));
        }
        let place = |i: usize| TAU * (low.ln() + (high / low).ln() * i as f64 / (PLACES - 1) as f64).exp();
        let target = |w: f64| analysis.series.fitted.modulus(analysis.moduli.kind, w);
        let goal: Vec<_> = (0..PLACES).map(place).map(|w| (w, target(w))).collect();
        let (from, to) = ((TAU * high * BEYOND).ln(), (TAU * low / BEYOND).ln());
        let at = |i: usize| -(from + (to - from) * i as f64 / (TIMES - 1) as f64);
        let error = |log: f64| fit(&goal, log.exp()).1;
        let best = (0..TIMES).map(at).min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap_or(-from);
        let step = at(1) - at(0);
        let time = golden((best - step, best + step), error).exp();
        let [elastic, viscous, amount] = fit(&goal, time).0;
        let branch = Self { band_hz: [low, high], elastic, viscous, amount, time, rms: [0.0; 2] };
        let rms = |part: fn(Complex<f64>) -> f64| {
            let off = |w: f64, e| (part(branch.modulus(w)) - part(e)) / size(part(e), e);
            let square = |&(w, e): &(f64, Complex<f64>)| off(w, e).powi(2);
            (goal.iter().map(square).sum::<f64>() / PLACES as f64).sqrt()
        };
        Ok(Self { rms: [rms(|e| e.re), rms(|e| e.im)], ..branch })
    }

    /// Its modulus at an angular frequency \[rad/s\].
    pub fn modulus(&self, omega: f64) -> Complex<f64> {
        let [of_amount, of_viscous] = [branch(omega, self.time), Complex::new(0.0, omega)];
        of_amount * self.amount + of_viscous * self.viscous + self.elastic
    }
}

/// A unit Maxwell branch.
fn branch(omega: f64, time: f64) -> Complex<f64> {
    let [storage, loss] = relaxation(Kind::Dynamic, omega, time);
    Complex::new(storage, loss)
}

/// Elastic part, viscous part and amount for a relaxation time, and the sum of squared relative residuals.
fn fit(goal: &[(f64, Complex<f64>)], time: f64) -> ([f64; 3], f64) {
    let middle = goal[goal.len() / 2].0;
    let scale = goal[goal.len() / 2].1.re;
    let columns = |w: f64| [Complex::from(1.0), Complex::new(0.0, w / middle), branch(w, time)];
    let part = |row: usize, z: Complex<f64>| if row.is_multiple_of(2) { z.re } else { z.im };
    let weight = |row: usize| scale / size(part(row, goal[row / 2].1), goal[row / 2].1);
    let wanted = |row: usize| part(row, goal[row / 2].1) / scale - if row.is_multiple_of(2) { LEAST } else { 0.0 };
    let a = DMatrix::from_fn(2 * goal.len(), 3, |i, j| part(i, columns(goal[i / 2].0)[j]) * weight(i));
    let b = DVector::from_fn(2 * goal.len(), |i, _| wanted(i) * weight(i));
    let x = nnls(&a, &b);
    let square = (&a * &x - b).norm_squared();
    ([(x[0] + LEAST) * scale, x[1] * scale / middle, x[2] * scale], square)
}

/// What an error is relative to: the part of the modulus, or the whole where there is no loss.
fn size(part: f64, modulus: Complex<f64>) -> f64 {
    if part == 0.0 { modulus.norm() } else { part }
}

/// A range of frequencies for people.
pub fn hertz(low: f64, high: f64) -> String {
    format!("{} to {}", told(low, "Hz"), told(high, "Hz"))
}

/// A frequency or a time for people, with a power of ten where no prefix is usual.
pub fn told(value: f64, unit: &str) -> String {
    let value = rounded(value, 3);
    let usual = if unit == "s" { 1e-9..1e4 } else { 1e-3..1e10 };
    if usual.contains(&value) { units::format(value, unit) } else { format!("{value:e} {unit}") }
}

/// So many significant digits.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// First line of every fragment.
const HEAD: &str = "# Written by `stickslip prony` from ";

/// The branch as a fragment of a scenario: stiffness = modulus x `factor` \[m\], or for a contact stiffness of 1 N/m.
pub fn fragment(analysis: &Analysis, branch: &Branch, factor: Option<f64>) -> String {
    let m = &analysis.moduli;
    let mut text = format!("{HEAD}{}, BLAKE3 {}\n", quote(&m.file), m.hash);
    let mut remark = |line: String| text += &format!("# {line}\n");
    let scale = factor.unwrap_or(1.0 / branch.elastic);
    remark(match factor {
        Some(factor) => format!("Stiffness = modulus x {}.", units::format(factor, "m")),
        None => "No geometry was stated (--geometry): this is for a contact stiffness of 1 N/m. Multiply stiffness, damping and k_1 \
                 by that of your contact; the ratios are the material's. Or let one factor be found: with \"rig.contact_factor\" in \
                 [fit] free its square multiplies all three."
            .into(),
    });
    let [storage, loss] = branch.rms.map(|share| readable::percent(share, 2));
    let [low, high] = branch.band_hz;
    remark(format!(
        "A scenario has room for one maxwell-branch: this is the nearest to the series of {} from {}, root mean square error \
         {storage} of the storage and {loss} of the loss modulus.",
        units::count(analysis.terms(), "term"),
        hertz(low, high)
    ));
    remark("Put stiffness and damping into the scenario's [contact], which keeps its friction.".into());
    let number = |value: f64| rounded(value, 5);
    let _ = write!(
        text,
        "[contact]\nstiffness = {:e}  # N/m\ndamping = {:e}  # N s/m\n\n[[effect]]\nname = \"maxwell-branch\"\nk_1 = {:e}  # N/m\n\
         tau = {:e}  # s\n\n",
        number(branch.elastic * scale),
        number(branch.viscous * scale),
        number(branch.amount * scale),
        number(branch.time)
    );
    let (amount, what) = if m.kind == Kind::Creep { ("J", "Kelvin") } else { ("E", "Maxwell") };
    let _ = writeln!(text, "# The whole series (generalised {what}), in {} and s:", m.kind.unit());
    let amounts = &analysis.series.fitted.amounts;
    let _ = writeln!(text, "# {amount}_0 = {:e}", number(amounts[0]));
    for (j, (value, time)) in amounts[1..].iter().zip(analysis.times()).enumerate() {
        let _ = writeln!(text, "# {amount}_{} = {:e}, tau_{0} = {:e}", j + 1, number(*value), number(*time));
    }
    text
}
