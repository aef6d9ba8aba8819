//! The contact of a scenario that comes nearest to a series: a spring, a dashpot and Maxwell branches beside them.

use super::law::{golden, relaxation};
use super::nnls::nnls;
use super::{Analysis, Kind};
use crate::effects;
use crate::scenario::diagnostic::quote;
use crate::units::{self, readable};
use nalgebra::{Complex, DMatrix, DVector};
use schemars::JsonSchema;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Effect of the first branch.
const BRANCH: &str = "maxwell-branch";
/// Frequencies at which both are compared, and relaxation times that are tried.
const PLACES: usize = 41;
const TIMES: usize = 81;
/// How far beyond the band relaxation times are tried, as a factor.
const BEYOND: f64 = 30.0;
/// Share of the storage modulus that the elastic part has at least: a contact has a stiffness.
const LEAST: f64 = 1e-3;
/// Times are moved on as long as the sum of squares falls to this share of itself.
const GAIN: f64 = 0.9;
/// Significant digits that are written.
const DIGITS: usize = 5;

/// E(iw) = elastic + iw viscous + sum of amount iwt/(1 + iwt).
#[derive(Debug, Clone, PartialEq, JsonSchema, serde::Serialize)]
pub struct Contact {
    /// Band for which it holds \[Hz\].
    pub band_hz: [f64; 2],
    /// Elastic part \[Pa\].
    pub elastic: f64,
    /// What relaxations much faster than the band amount to \[Pa s\].
    pub viscous: f64,
    /// Its branches, the largest first.
    pub branches: Vec<Branch>,
    /// Root mean square of the relative errors against the series, of storage and loss modulus.
    pub rms: [f64; 2],
}

/// A spring and a dashpot in series.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, serde::Serialize)]
pub struct Branch {
    /// Modulus \[Pa\].
    pub amount: f64,
    /// Relaxation time \[s\].
    pub time: f64,
}

impl Contact {
    /// The nearest to the series of an analysis over a band \[Hz\], of as few branches as come as near to the series as
    /// that does to the readings; an error says where the table determines nothing of it.
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
        let goal = Goal::new(analysis, (low, high));
        let enough = analysis.moduli.rms(&analysis.series.fitted);
        let enough = [enough[0], enough[enough.len() - 1]];
        let most = analysis.terms().min(most());
        // What is written is no nearer.
        let written = 10f64.powi(1 - DIGITS as i32);
        let near = |contact: &Contact| contact.rms.iter().zip(enough).all(|(rms, enough)| *rms <= enough.max(written));
        let mut times = Vec::new();
        loop {
            times = goal.with_another(times);
            let mut left = f64::INFINITY;
            let contact = loop {
                let contact = goal.contact(&times, [low, high]);
                let square = contact.rms[0].powi(2) + contact.rms[1].powi(2);
                let falls = square < GAIN * left;
                if near(&contact) || !falls {
                    break contact;
                }
                left = square;
                times = goal.moved(times);
            };
            if near(&contact) || times.len() >= most {
                return Ok(contact);
            }
        }
    }

    /// Its modulus at an angular frequency \[rad/s\].
    pub fn modulus(&self, omega: f64) -> Complex<f64> {
        let relaxing: Complex<f64> = self.branches.iter().map(|b| branch(omega, b.time) * b.amount).sum();
        relaxing + Complex::new(self.elastic, omega * self.viscous)
    }
}

/// How many branches a scenario has room for.
fn most() -> usize {
    effects::find(BRANCH).map_or(1, |first| 1 + first.further().len())
}

/// A unit Maxwell branch.
fn branch(omega: f64, time: f64) -> Complex<f64> {
    let [storage, loss] = relaxation(Kind::Dynamic, omega, time);
    Complex::new(storage, loss)
}

/// The series at places over the band.
struct Goal {
    places: Vec<(f64, Complex<f64>)>,
    /// Logarithms of relaxation times that are tried.
    times: Vec<f64>,
}

impl Goal {
    fn new(analysis: &Analysis, (low, high): (f64, f64)) -> Self {
        let place = |i: usize| TAU * (low.ln() + (high / low).ln() * i as f64 / (PLACES - 1) as f64).exp();
        let target = |w: f64| analysis.series.fitted.modulus(analysis.moduli.kind, w);
        let (from, to) = ((TAU * high * BEYOND).ln(), (TAU * low / BEYOND).ln());
        let at = |i: usize| -(from + (to - from) * i as f64 / (TIMES - 1) as f64);
        Self { places: (0..PLACES).map(place).map(|w| (w, target(w))).collect(), times: (0..TIMES).map(at).collect() }
    }

    /// The times with the one that helps most beside them.
    fn with_another(&self, mut times: Vec<f64>) -> Vec<f64> {
        let error = |log: &f64| self.beside(&times, *log);
        let best = self.times.iter().copied().min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(self.times[0]);
        times.push(best.exp());
        times
    }

    /// The times, each in turn where it is best beside the others.
    fn moved(&self, mut times: Vec<f64>) -> Vec<f64> {
        let step = self.times[1] - self.times[0];
        for _ in 0..times.len() {
            let log = times.remove(0).ln();
            let best = golden((log - step, log + step), |log| self.beside(&times, log));
            times.push(best.exp());
        }
        times
    }

    /// Sum of squared relative residuals with a further time of that logarithm.
    fn beside(&self, times: &[f64], log: f64) -> f64 {
        self.fit(&[times, &[log.exp()]].concat()).1
    }

    fn contact(&self, times: &[f64], band_hz: [f64; 2]) -> Contact {
        let amounts = self.fit(times).0;
        let branch = |(time, amount): (&f64, &f64)| Branch { amount: *amount, time: *time };
        let mut branches: Vec<Branch> = times.iter().zip(&amounts[2..]).map(branch).collect();
        branches.sort_by(|a, b| b.amount.total_cmp(&a.amount));
        let helping = branches.iter().filter(|branch| branch.amount > 0.0).count();
        branches.truncate(helping.max(1));
        let contact = Contact { band_hz, elastic: amounts[0], viscous: amounts[1], branches, rms: [0.0; 2] };
        let rms = |part: fn(Complex<f64>) -> f64| {
            let off = |w: f64, e| (part(contact.modulus(w)) - part(e)) / size(part(e), e);
            let square = |&(w, e): &(f64, Complex<f64>)| off(w, e).powi(2);
            (self.places.iter().map(square).sum::<f64>() / PLACES as f64).sqrt()
        };
        Contact { rms: [rms(|e| e.re), rms(|e| e.im)], ..contact }
    }

    /// Elastic part, viscous part and amounts for relaxation times, and the sum of squared relative residuals.
    fn fit(&self, times: &[f64]) -> (Vec<f64>, f64) {
        let (middle, scale) = (self.places[PLACES / 2].0, self.places[PLACES / 2].1.re);
        let column = |j: usize, w: f64| match j {
            0 => Complex::from(1.0),
            1 => Complex::new(0.0, w / middle),
            _ => branch(w, times[j - 2]),
        };
        let part = |row: usize, z: Complex<f64>| if row.is_multiple_of(2) { z.re } else { z.im };
        let weight = |row: usize, e: Complex<f64>| scale / size(part(row, e), e);
        let wanted =
            |row: usize, e: Complex<f64>| part(row, e) / scale - if row.is_multiple_of(2) { LEAST } else { 0.0 };
        let rows = 2 * self.places.len();
        let a = DMatrix::from_fn(rows, 2 + times.len(), |i, j| {
            let (w, e) = self.places[i / 2];
            part(i, column(j, w)) * weight(i, e)
        });
        let b = DVector::from_fn(rows, |i, _| wanted(i, self.places[i / 2].1) * weight(i, self.places[i / 2].1));
        let x = nnls(&a, &b);
        let square = (&a * &x - b).norm_squared();
        let amounts = [(x[0] + LEAST) * scale, x[1] * scale / middle];
        (amounts.into_iter().chain(x.iter().skip(2).map(|amount| amount * scale)).collect(), square)
    }
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

/// How many branches a contact has, in words.
pub fn branches(contact: &Contact) -> String {
    match contact.branches.len() {
        1 => format!("one {BRANCH}"),
        count => format!("{count} {BRANCH} effects"),
    }
}

/// First line of every fragment.
const HEAD: &str = "# Written by `stickslip prony` from ";

/// A contact as a fragment of a scenario: stiffness = modulus x `factor` \[m\], or for a contact stiffness of 1 N/m.
pub fn fragment(analysis: &Analysis, contact: &Contact, factor: Option<f64>) -> String {
    let m = &analysis.moduli;
    let mut text = format!("{HEAD}{}, BLAKE3 {}\n", quote(&m.file), m.hash);
    let mut remark = |line: String| text += &format!("# {line}\n");
    let scale = factor.unwrap_or(1.0 / contact.elastic);
    remark(match factor {
        Some(factor) => format!("Stiffness = modulus x {}.", units::format(factor, "m")),
        None => "No geometry was stated (--geometry): this is for a contact stiffness of 1 N/m. Multiply stiffness, damping and every \
                 k_1 by that of your contact; the ratios are the material's. Or let one factor be found: with \
                 \"rig.contact_factor\" in [fit] free its square multiplies all of them."
            .into(),
    });
    let [storage, loss] = contact.rms.map(|share| readable::percent(share, 2));
    let [low, high] = contact.band_hz;
    remark(format!(
        "{}: the nearest to the series of {} from {}, root mean square error {storage} of the storage and {loss} of the loss \
         modulus.",
        branches(contact),
        units::count(analysis.terms(), "term"),
        hertz(low, high)
    ));
    remark("Put stiffness and damping into the scenario's [contact], which keeps its friction.".into());
    let number = |value: f64| rounded(value, DIGITS);
    let _ = write!(
        text,
        "[contact]\nstiffness = {:e}  # N/m\ndamping = {:e}  # N s/m\n\n",
        number(contact.elastic * scale),
        number(contact.viscous * scale)
    );
    let further = effects::find(BRANCH).map_or(&[][..], |first| first.further());
    let names = std::iter::once(BRANCH).chain(further.iter().map(|effect| effect.name()));
    for (name, branch) in names.zip(&contact.branches) {
        let (stiffness, time) = (number(branch.amount * scale), number(branch.time));
        let _ = write!(text, "[[effect]]\nname = \"{name}\"\nk_1 = {stiffness:e}  # N/m\ntau = {time:e}  # s\n\n");
    }
    let (amount, what) = if m.kind == Kind::Creep { ("J", "Kelvin") } else { ("E", "Maxwell") };
    let _ = writeln!(text, "# The whole series (generalised {what}), in {} and s:", m.kind.unit());
    let amounts = &analysis.series.fitted.amounts;
    let _ = writeln!(text, "# {amount}_0 = {:e}", number(amounts[0]));
    for (j, (value, time)) in amounts[1..].iter().zip(analysis.times()).enumerate() {
        let _ = writeln!(text, "# {amount}_{} = {:e}, tau_{0} = {:e}", j + 1, number(*value), number(*time));
    }
    text
}
