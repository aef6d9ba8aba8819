//! The basis of a Fourier series at the instants of a period.

use nalgebra::DMatrix;
use std::cell::RefCell;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::rc::Rc;

/// The basis functions at many instants of one period: cosine and sine of the harmonics, the mean first where there is
/// one.
pub struct Laid {
    /// Harmonics of the unknowns: each twice, the mean once.
    pub harmonics: Vec<usize>,
    /// Values at every instant, and their derivatives by the phase.
    pub basis: DMatrix<f64>,
    pub slopes: DMatrix<f64>,
    /// How many there are.
    pub instants: usize,
    /// Instants on which forces are projected: half of them where the second half of a period is the negative of the
    /// first.
    pub projected: usize,
}

impl Laid {
    fn new(harmonics: Vec<usize>, instants: usize, odd: bool) -> Self {
        let unknowns = harmonics.len();
        let (mut basis, mut slopes) = (DMatrix::zeros(instants, unknowns), DMatrix::zeros(instants, unknowns));
        for j in 0..instants {
            let (values, by_phase) = basis_at(&harmonics, TAU * j as f64 / instants as f64);
            for m in 0..unknowns {
                (basis[(j, m)], slopes[(j, m)]) = (values[m], by_phase[m]);
            }
        }
        let projected = if odd { instants / 2 } else { instants };
        Self { harmonics, basis, slopes, instants, projected }
    }

    /// The basis of the harmonics up to `highest`, kept for the next time.
    pub fn of(highest: usize, instants: usize, odd: bool) -> Rc<Self> {
        thread_local!(static KEPT: RefCell<HashMap<(usize, usize, bool), Rc<Laid>>> = RefCell::default());
        KEPT.with_borrow_mut(|kept| {
            let new = || Rc::new(Self::new(harmonics(highest, odd), instants, odd));
            kept.entry((highest, instants, odd)).or_insert_with(new).clone()
        })
    }

    /// Position of the cosine of harmonic `k`.
    pub fn cosine(&self, k: usize) -> usize {
        self.harmonics.iter().position(|h| *h == k).unwrap_or(0)
    }

    /// Positions and harmonics of the cosines.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let first = self.cosine(1);
        (first..self.harmonics.len()).step_by(2).map(|at| (at, self.harmonics[at]))
    }
}

/// Harmonics of the unknowns up to `highest`: of an odd motion the odd ones alone.
fn harmonics(highest: usize, odd: bool) -> Vec<usize> {
    let all = (if odd { 1 } else { 0 }..=highest).filter(|k| !odd || k % 2 == 1);
    all.flat_map(|k| std::iter::repeat_n(k, if k == 0 { 1 } else { 2 })).collect()
}

/// Cosine, then sine of every harmonic, and their derivatives by the phase.
pub fn basis_at(harmonics: &[usize], phase: f64) -> (Vec<f64>, Vec<f64>) {
    let mut last = 0;
    let value = |&k: &usize| {
        let (sine, cosine) = (k as f64 * phase).sin_cos();
        let second = std::mem::replace(&mut last, k) == k;
        if second { (sine, k as f64 * cosine) } else { (cosine, -(k as f64) * sine) }
    };
    let both: Vec<(f64, f64)> = if harmonics.first() == Some(&0) {
        std::iter::once((1.0, 0.0)).chain(harmonics[1..].iter().map(value)).collect()
    } else {
        harmonics.iter().map(value).collect()
    };
    both.into_iter().unzip()
}
