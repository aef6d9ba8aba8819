//! Measured moduli of a material as a series of relaxations: storage and loss modulus against frequency, or a
//! relaxation modulus or creep compliance against time, fitted by a generalised Maxwell model (of a compliance: Kelvin)
//! with positive moduli and by a spring-pot, E0 + c (iw)^a.
//!
//! `read` reads the table, `law` has the models and `nnls` their fit, `blocks` judges them at blocks of rows that were
//! left out, `remarks` says what the data cannot tell, `contact` finds the contact with Maxwell branches that
//! comes nearest to a series. `docs/prony.md` has method and limits. Scales come from the data: no number here carries a unit.

mod blocks;
mod contact;
mod law;
mod nnls;
mod read;
mod remarks;

pub use blocks::Score;
pub use contact::{Branch, Contact, branches, fragment, hertz, told};
pub use law::{Fitted, Law};
pub use read::{read, read_bytes};

use schemars::JsonSchema;
use serde::Serialize;
use std::ops::Range;

/// Schema of the JSON.
pub const SCHEMA: &str = "stickslip.prony/1";
/// Terms that are tried per decade: finer than this, neighbouring relaxations differ by less than any table resolves.
const TERMS_PER_DECADE: f64 = 1.5;
/// Series of more terms that are tried after the one that predicts best.
const IN_VAIN: usize = 4;
/// Mean squared relative residual that rounding alone leaves.
const ROUNDING: f64 = f64::EPSILON;
/// Places of the curve on which the band is drawn.
const PLACES: usize = 121;

/// What a table holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Storage and loss modulus \[Pa\] against angular frequency \[rad/s\].
    Dynamic,
    /// Relaxation modulus \[Pa\] against time \[s\].
    Relaxation,
    /// Creep compliance \[1/Pa\] against time \[s\].
    Creep,
}

impl Kind {
    /// How many readings a row has.
    pub fn readings(self) -> usize {
        if self == Self::Dynamic { 2 } else { 1 }
    }

    /// What they are called.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Self::Dynamic => &["storage modulus", "loss modulus"],
            Self::Relaxation => &["relaxation modulus"],
            Self::Creep => &["creep compliance"],
        }
    }

    /// Their SI unit.
    pub fn unit(self) -> &'static str {
        if self == Self::Creep { "1/Pa" } else { "Pa" }
    }
}

/// A row.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Angular frequency \[rad/s\] or time \[s\].
    pub x: f64,
    /// Readings, as many as the kind has.
    pub y: [f64; 2],
}

/// A measured table, by rising frequency or time; every number is positive.
#[derive(Debug, Clone, PartialEq)]
pub struct Moduli {
    /// The file.
    pub file: String,
    /// BLAKE3 hash of its bytes, in hexadecimal.
    pub hash: String,
    /// What it holds.
    pub kind: Kind,
    /// Its rows.
    pub points: Vec<Point>,
    /// What the user should know of how it was read.
    pub notes: Vec<String>,
}

impl Moduli {
    /// Lowest and highest angular frequency \[rad/s\]; of times their inverses.
    pub fn band(&self) -> (f64, f64) {
        let (first, last) = (self.points[0].x, self.points[self.points.len() - 1].x);
        if self.kind == Kind::Dynamic { (first, last) } else { (last.recip(), first.recip()) }
    }

    /// Width of the band.
    pub fn decades(&self) -> f64 {
        let (low, high) = self.band();
        (high / low).log10()
    }

    /// Middle of the frequencies or times on a logarithmic scale.
    fn center(&self) -> f64 {
        let (first, last) = (self.points[0].x, self.points[self.points.len() - 1].x);
        first.sqrt() * last.sqrt()
    }

    /// Middle of the readings on a logarithmic scale.
    fn scale(&self) -> f64 {
        let logs = self.points.iter().flat_map(|p| p.y[..self.kind.readings()].iter().map(|y| y.ln()));
        (logs.sum::<f64>() / (self.points.len() * self.kind.readings()) as f64).exp()
    }

    /// Squared relative residuals of some rows: all of one reading, then all of the other.
    fn errors(&self, fitted: &Fitted, rows: Range<usize>) -> Vec<f64> {
        let one = |k: usize| {
            let of = move |p: &Point| (fitted.value(self.kind, p.x)[k] / p.y[k] - 1.0).powi(2);
            self.points[rows.clone()].iter().map(of).collect::<Vec<_>>()
        };
        (0..self.kind.readings()).flat_map(one).collect()
    }

    /// Root mean square of the relative residuals of each reading.
    pub fn rms(&self, fitted: &Fitted) -> Vec<f64> {
        let squares = self.errors(fitted, 0..self.points.len());
        squares.chunks(self.points.len()).map(|of| (of.iter().sum::<f64>() / of.len() as f64).sqrt()).collect()
    }

    /// Most terms that are tried.
    fn most_terms(&self) -> usize {
        let by_band = (TERMS_PER_DECADE * self.decades()).ceil() as usize + 1;
        by_band.clamp(2, (self.points.len() * self.kind.readings() / 3).max(2))
    }
}

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, Serialize)]
pub struct Interval {
    /// The number.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// An amount, which is not negative.
    fn positive(value: f64, half: f64) -> Self {
        Self { value, low: (value - half).max(0.0), high: value + half }
    }
}

/// A law, how well it does, and the intervals of its amounts.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The law fitted to all rows.
    pub fitted: Fitted,
    /// At blocks that were left out.
    pub score: Score,
    /// The elastic part first, in the unit of the table.
    pub amounts: Vec<Interval>,
}

/// What a table comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// The table.
    pub moduli: Moduli,
    /// Scores of series of 1, 2, ... terms.
    pub scores: Vec<Score>,
    /// The series with the number of terms that was chosen.
    pub series: Judged,
    /// Lower end, curve and upper end of it at frequencies or times over the band: (place, readings each).
    pub curve: Vec<(f64, [Interval; 2])>,
    /// The spring-pot.
    pub spring_pot: Judged,
    /// Its exponent.
    pub exponent: Interval,
    /// A storage and a loss modulus that do not depend on the frequency, where both were measured.
    pub constant: Option<Score>,
    /// What the data cannot tell.
    pub remarks: Vec<String>,
}

impl Analysis {
    /// Fits and judges everything.
    pub fn of(moduli: Moduli) -> Self {
        let (fits, scores) = tried(&moduli);
        let fitted = fits[chosen(&scores)].clone();
        let law = &fitted.law.clone();
        let places = places(&moduli);
        let readings = |fitted: &Fitted| -> Vec<f64> {
            let logs = |x: &f64| fitted.value(moduli.kind, *x).map(|value| value.max(f64::MIN_POSITIVE).ln());
            fitted.shares(&moduli).into_iter().chain(places.iter().flat_map(logs)).collect()
        };
        let halves = blocks::half_widths(law, &moduli, readings);
        let (of_amounts, of_curve) = halves.split_at(fitted.amounts.len());
        let curve = places.iter().zip(of_curve.chunks(2)).map(|(&x, half)| {
            let value = fitted.value(moduli.kind, x);
            let end = |k: usize, sign: f64| value[k] * (sign * half[k]).exp();
            (x, [0, 1].map(|k| Interval { value: value[k], low: end(k, -1.0), high: end(k, 1.0) }))
        });
        let curve = curve.collect();
        let series =
            Judged { score: scores[chosen(&scores)], amounts: intervals(&fitted, of_amounts, &moduli), fitted };
        let (spring_pot, exponent) = spring_pot(&moduli);
        let constant = (moduli.kind == Kind::Dynamic).then(|| blocks::held_out(&Law::Constant, &moduli));
        let remarks = remarks::remarks(&moduli, &fits, &scores, (spring_pot.score, constant));
        Self { moduli, scores, series, curve, spring_pot, exponent, constant, remarks }
    }

    /// How many terms the series has.
    pub fn terms(&self) -> usize {
        self.series.fitted.amounts.len() - 1
    }

    /// Relaxation times of its terms \[s\], of a compliance retardation times.
    pub fn times(&self) -> &[f64] {
        match &self.series.fitted.law {
            Law::Series(times) => times,
            Law::SpringPot | Law::Constant => &[],
        }
    }
}

/// Series of 1, 2, ... terms and their scores, until [`IN_VAIN`] more in turn predict no better.
fn tried(moduli: &Moduli) -> (Vec<Fitted>, Vec<Score>) {
    let (mut fits, mut scores) = (Vec::new(), Vec::<Score>::new());
    let mut best = (f64::INFINITY, 0);
    for terms in 1..=moduli.most_terms() {
        let fitted = Law::series(terms, moduli).fit(moduli, &moduli.points).reduced();
        // What is left out moves the times from there.
        let score = blocks::held_out(&fitted.law, moduli);
        fits.push(fitted);
        scores.push(score);
        if score.mean < best.0 {
            best = (score.mean, terms);
        }
        if terms >= best.1 + IN_VAIN || best.0 <= ROUNDING {
            break;
        }
    }
    (fits, scores)
}

/// The fewest terms that are within a standard error of the best (Breiman et al., Classification and Regression Trees,
/// 1984), or that leave nothing but rounding.
fn chosen(scores: &[Score]) -> usize {
    let limit = reach(scores);
    scores.iter().position(|score| score.mean <= limit).unwrap_or(0)
}

/// Mean squared residual within a standard error of the best.
fn reach(scores: &[Score]) -> f64 {
    let best = scores.iter().min_by(|a, b| a.mean.total_cmp(&b.mean));
    best.map_or(ROUNDING, |best| (best.mean + best.standard_error).max(ROUNDING))
}

fn spring_pot(moduli: &Moduli) -> (Judged, Interval) {
    let law = Law::SpringPot;
    let fitted = law.fit(moduli, &moduli.points);
    let read = |fitted: &Fitted| [fitted.shares(moduli), vec![fitted.exponent]].concat();
    let halves = blocks::half_widths(&law, moduli, read);
    let (exponent, half) = (fitted.exponent, halves[2]);
    let exponent = Interval { value: exponent, low: (exponent - half).max(0.0), high: (exponent + half).min(1.0) };
    let score = blocks::held_out(&law, moduli);
    (Judged { score, amounts: intervals(&fitted, &halves[..2], moduli), fitted }, exponent)
}

/// Amounts with half widths in units of the middle of the readings.
fn intervals(fitted: &Fitted, halves: &[f64], moduli: &Moduli) -> Vec<Interval> {
    let scale = moduli.scale();
    fitted.amounts.iter().zip(halves).map(|(value, half)| Interval::positive(*value, half * scale)).collect()
}

/// Places evenly over the frequencies or times on a logarithmic scale.
fn places(moduli: &Moduli) -> Vec<f64> {
    let (first, last) = (moduli.points[0].x.ln(), moduli.points[moduli.points.len() - 1].x.ln());
    (0..PLACES).map(|i| (first + (last - first) * i as f64 / (PLACES - 1) as f64).exp()).collect()
}
