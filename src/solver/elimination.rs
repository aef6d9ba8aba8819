//! The affine part of a Radau step, eliminated once per mode and size of step (see [`super::radau`]).

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::collocation::{A, C, State};
use crate::model::system::{Evaluation, Forcing, HybridSystem, MAX_NONLINEAR, MAX_STATES, Mode};
use nalgebra::{Complex, ComplexField, Matrix3};
use std::array::from_fn;
use std::sync::LazyLock;

/// Most unknowns of a stage: the algebraic one and the rates that are not affine.
pub const MAX_UNKNOWNS: usize = MAX_NONLINEAR + 1;
/// Eliminations kept.
const KEPT: usize = 12;
/// Parts of the spectrum of A: its real eigenvalue, and real and imaginary part of the pair.
const PARTS: usize = 3;
type Parts = [f64; PARTS];

/// The spectral decomposition A = sum lambda P of the coefficients of the method, by which the equations of the three
/// stages fall apart: (1 - h A x M)^-1 = sum P x (1 - h lambda M)^-1 (Hairer and Wanner, Solving ODEs II, IV.8).
struct Spectrum {
    real: f64,
    pair: Complex<f64>,
    /// P, row by row.
    projectors: [[Parts; 3]; 3],
    /// lambda P.
    weighted: [[Parts; 3]; 3],
}

static SPECTRUM: LazyLock<Spectrum> = LazyLock::new(|| {
    // The eigenvalues are the roots of x^3 - 3/5 x^2 + 3/20 x - 1/60.
    let (p, q) = (81f64.cbrt(), 9f64.cbrt());
    let real = (6.0 + p - q) / 30.0;
    let pair = Complex::new((12.0 - p + q) / 60.0, 3f64.sqrt() * (p + q) / 60.0);
    let a = Matrix3::from_fn(|i, k| Complex::from(A[i][k]));
    let less = |root: Complex<f64>| a - Matrix3::from_diagonal_element(root);
    let conjugate = pair.conj();
    let of_real = less(pair) * less(conjugate) / ((pair - real).norm_sqr() * Complex::ONE);
    let of_pair = less(real.into()) * less(conjugate) / ((pair - real) * (pair - conjugate));
    let parts = |of_real: Matrix3<Complex<f64>>, of_pair: Matrix3<Complex<f64>>| {
        from_fn(|i| from_fn(|k| [of_real[(i, k)].re, 2.0 * of_pair[(i, k)].re, -2.0 * of_pair[(i, k)].im]))
    };
    Spectrum {
        real,
        pair,
        projectors: parts(of_real, of_pair),
        weighted: parts(of_real * Complex::from(real), of_pair * pair),
    }
});

fn dot(a: &Parts, b: &Parts) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The unknowns of a mode, and the algebraic one where it is not among them.
#[derive(Clone, Copy)]
pub struct Unknowns {
    /// Rows that are affine.
    pub affine: [bool; MAX_STATES],
    /// Whether the algebraic unknown is the first: the constraint is not affine.
    pub slip: bool,
    /// Rows that are not affine, whose rates follow.
    rows: [usize; MAX_NONLINEAR],
    /// Their number.
    count: usize,
    /// Otherwise what it is made of: the states, and (1, sin wt, cos wt).
    slip_by: (State, [f64; 3]),
}

impl Unknowns {
    /// Their number at a stage.
    pub fn len(&self) -> usize {
        self.count + usize::from(self.slip)
    }

    /// The row whose rate an unknown is; `None` for the algebraic one.
    pub fn row(&self, unknown: usize) -> Option<usize> {
        if self.slip { unknown.checked_sub(1).map(|index| self.rows[index]) } else { Some(self.rows[unknown]) }
    }

    /// The rows that are not affine.
    pub fn rows(&self) -> &[usize] {
        &self.rows[..self.count]
    }

    /// The algebraic unknown where it is not among the unknowns.
    pub fn slip_at(&self, n: usize, z: &State, forcing: &Forcing) -> f64 {
        let (by, parts) = &self.slip_by;
        let mut s = parts[0] + parts[1] * forcing.sine + parts[2] * forcing.cosine;
        for l in 0..n {
            s += by[l] * z[l];
        }
        s
    }

    /// Its derivatives by the states.
    pub fn slip_by(&self) -> &State {
        &self.slip_by.0
    }
}

/// The affine rates of a mode: dz'/dz, dz'/ds and the parts of 1, sin wt, cos wt; rows that are not affine are zero.
/// Where the constraint is affine, too, it has taken the algebraic unknown out of them.
struct Rates {
    mode: Mode,
    unknowns: Unknowns,
    linear: [State; MAX_STATES],
    by_slip: State,
    parts: [State; 3],
}

impl Rates {
    fn new(system: &dyn HybridSystem, mode: Mode) -> Self {
        let (n, affine, zero) = (system.states(), system.affine(mode), [0.0; MAX_STATES]);
        let mut e = [Evaluation::default(); 3];
        let still = Forcing::default();
        for (e, forcing) in e.iter_mut().zip([still, system.forcing_at(1.0, 0.0), system.forcing_at(0.0, 1.0)]) {
            system.evaluate(&forcing, &zero, 0.0, mode, e);
        }
        let part = |of: &dyn Fn(&Evaluation) -> f64| [of(&e[0]), of(&e[1]) - of(&e[0]), of(&e[2]) - of(&e[0])];
        let slip = !affine.constraint || e[0].gs == 0.0;
        let mut slip_by = (zero, [0.0; 3]);
        if !slip {
            let per = -1.0 / e[0].gs;
            slip_by = (e[0].gz.map(|g| g * per), part(&|e| e.g).map(|g| g * per));
        }
        let mut unknowns = Unknowns { affine: affine.rows, slip, rows: [0; MAX_NONLINEAR], count: 0, slip_by };
        let (mut linear, mut by_slip, mut parts) = ([zero; MAX_STATES], zero, [zero; 3]);
        for j in 0..n {
            if !affine.rows[j] {
                unknowns.rows[unknowns.count] = j;
                unknowns.count += 1;
                continue;
            }
            let by = e[0].fs[j];
            by_slip[j] = by;
            linear[j] = from_fn(|l| e[0].fz[j][l] + by * slip_by.0[l]);
            for (parts, (own, slip)) in parts.iter_mut().zip(part(&|e| e.f[j]).iter().zip(&slip_by.1)) {
                parts[j] = own + by * slip;
            }
        }
        Self { mode, unknowns, linear, by_slip, parts }
    }
}

/// What the affine rows of a mode make of a step of one size.
pub struct Elimination {
    mode: Mode,
    size: f64,
    /// When it was last used.
    used: usize,
    /// The unknowns.
    pub unknowns: Unknowns,
    /// Their units: of the algebraic unknown its scale, of a rate that of the state over the step.
    pub units: [f64; MAX_UNKNOWNS],
    /// Sine and cosine of the phase from the start of the step to its stages.
    pub turn: [(f64, f64); 3],
    /// (1 - h lambda M)^-1 in units of the scales.
    resolvents: [[Parts; MAX_STATES]; MAX_STATES],
    /// dZ/dz.
    pub start: [[State; MAX_STATES]; 3],
    /// Z of (1, sin wt, cos wt) at the start of the step.
    pub forced: [[[f64; 3]; MAX_STATES]; 3],
    /// dZ/dU: stage of Z, state, stage of U, unknown.
    pub by_unknown: [[[[f64; MAX_UNKNOWNS]; 3]; MAX_STATES]; 3],
}

/// The eliminations in use: steps of few sizes come again and again.
#[derive(Default)]
pub struct Eliminations {
    rates: Vec<Rates>,
    kept: Vec<Box<Elimination>>,
    current: usize,
    clock: usize,
}

impl Eliminations {
    /// The one that was asked for last.
    pub fn current(&self) -> &Elimination {
        &self.kept[self.current]
    }

    /// Makes the one of a mode and a size of step the current one; false where it does not exist. One that is not
    /// `lasting` takes the place of the last such.
    pub fn fit(&mut self, system: &dyn HybridSystem, mode: Mode, h: f64, lasting: bool) -> bool {
        self.clock += 1;
        let known = self.kept.iter().position(|kept| kept.size == h && kept.mode == mode);
        if let Some(known) = known {
            self.current = known;
            self.kept[known].used = self.clock;
            return true;
        }
        let index = self.rates.iter().position(|rates| rates.mode == mode).unwrap_or_else(|| {
            self.rates.push(Rates::new(system, mode));
            self.rates.len() - 1
        });
        let rates = &self.rates[index];
        if self.kept.is_empty() || lasting && self.kept.len() < KEPT {
            self.kept.push(Box::new(Elimination::empty(rates)));
        }
        // The first place is for what does not last.
        self.current = match self.kept.len() {
            _ if !lasting => 0,
            KEPT => (1..KEPT).min_by_key(|&k| self.kept[k].used).unwrap_or(0),
            len => len - 1,
        };
        let elimination = &mut self.kept[self.current];
        if elimination.mode != mode {
            (elimination.mode, elimination.unknowns) = (mode, rates.unknowns);
        }
        (elimination.size, elimination.used) = (f64::NAN, self.clock);
        let fits = match system.states() {
            3 => elimination.fit::<3>(system, rates, 3, h),
            4 => elimination.fit::<4>(system, rates, 4, h),
            5 => elimination.fit::<5>(system, rates, 5, h),
            n => elimination.fit::<MAX_STATES>(system, rates, n, h),
        };
        if fits {
            elimination.size = h;
        }
        fits
    }
}

impl Elimination {
    fn empty(rates: &Rates) -> Self {
        Self {
            mode: rates.mode,
            size: f64::NAN,
            used: 0,
            unknowns: rates.unknowns,
            units: [1.0; MAX_UNKNOWNS],
            turn: [(0.0, 1.0); 3],
            resolvents: [[[0.0; PARTS]; MAX_STATES]; MAX_STATES],
            start: [[[0.0; MAX_STATES]; MAX_STATES]; 3],
            forced: [[[0.0; 3]; MAX_STATES]; 3],
            by_unknown: [[[[0.0; MAX_UNKNOWNS]; 3]; MAX_STATES]; 3],
        }
    }

    /// E, K and H.
    #[inline(always)]
    fn fit<const N: usize>(&mut self, system: &dyn HybridSystem, rates: &Rates, n: usize, h: f64) -> bool {
        let (spectrum, scales) = (&*SPECTRUM, system.scales());
        let Some(resolvents) = resolvents::<N>(rates, n, h, &scales) else { return false };
        let applied = |v: &State| {
            let mut out = [[0.0; PARTS]; N];
            for j in 0..n {
                for l in 0..n {
                    let x = h * v[l] / scales[l] * scales[j];
                    for part in 0..PARTS {
                        out[j][part] += resolvents[j][l][part] * x;
                    }
                }
            }
            out
        };
        let omega = std::f64::consts::TAU / system.period();
        let turn = C.map(|c| (omega * c * h).sin_cos());
        self.turn = turn;
        let forced = rates.parts.map(|part| applied(&part));
        for i in 0..3 {
            let along = |rows: &[Parts; 3], by: [f64; 3]| -> Parts {
                from_fn(|part| rows[0][part] * by[0] + rows[1][part] * by[1] + rows[2][part] * by[2])
            };
            let weighted = &spectrum.weighted[i];
            // sin w(t + ch) = sin wt cos wch + cos wt sin wch
            let (still, sine, cosine) =
                (along(weighted, [1.0; 3]), along(weighted, turn.map(|t| t.0)), along(weighted, turn.map(|t| t.1)));
            let whole = along(&spectrum.projectors[i], [1.0; 3]);
            for j in 0..n {
                for l in 0..n {
                    self.start[i][j][l] = dot(&whole, &resolvents[j][l]) * scales[j] / scales[l];
                }
                let [constant, first, second] = [&forced[0][j], &forced[1][j], &forced[2][j]];
                self.forced[i][j] = [
                    dot(&still, constant),
                    dot(&cosine, first) - dot(&sine, second),
                    dot(&sine, first) + dot(&cosine, second),
                ];
            }
        }
        for u in 0..rates.unknowns.len() {
            let row = rates.unknowns.row(u);
            self.units[u] = row.map_or(system.slip_scale(), |j| scales[j] / h);
            let by = match row {
                None => applied(&rates.by_slip),
                Some(row) => applied(&from_fn(|j| f64::from(u8::from(j == row)))),
            };
            self.answer_to_unknown(u, &by[..n]);
        }
        for j in 0..n {
            self.resolvents[j][..n].copy_from_slice(&resolvents[j][..n]);
        }
        true
    }

    /// Sets dZ/dU for one of the unknowns, which the resolvents make `by` of.
    #[inline(always)]
    fn answer_to_unknown(&mut self, u: usize, by: &[Parts]) {
        let weighted = &SPECTRUM.weighted;
        for i in 0..3 {
            for (j, by) in by.iter().enumerate() {
                for k in 0..3 {
                    self.by_unknown[i][j][k][u] = dot(&weighted[i][k], by);
                }
            }
        }
    }

    /// Solves the transposed equations of the affine rows, in units of the scales, for two right sides:
    /// `b[stage][state]`.
    pub fn solve_transposed(&self, n: usize, b: &mut [[[f64; 2]; MAX_STATES]; 3]) {
        let mut out = [[[0.0; 2]; MAX_STATES]; 3];
        for i in 0..3 {
            for j in 0..n {
                let mut by = [[0.0; 2]; PARTS];
                for l in 0..n {
                    for part in 0..PARTS {
                        by[part][0] += self.resolvents[l][j][part] * b[i][l][0];
                        by[part][1] += self.resolvents[l][j][part] * b[i][l][1];
                    }
                }
                for k in 0..3 {
                    for part in 0..PARTS {
                        out[k][j][0] += SPECTRUM.projectors[i][k][part] * by[part][0];
                        out[k][j][1] += SPECTRUM.projectors[i][k][part] * by[part][1];
                    }
                }
            }
        }
        *b = out;
    }
}

/// (1 - h lambda M)^-1 in units of the scales; `None` where it does not exist.
#[inline(always)]
fn resolvents<const N: usize>(rates: &Rates, n: usize, h: f64, scales: &State) -> Option<[[Parts; N]; N]> {
    let spectrum = &*SPECTRUM;
    let (mut real, mut pair) = ([[0.0; N]; N], [[Complex::ZERO; N]; N]);
    for j in 0..N {
        for l in 0..n {
            let step = h * rates.linear[j][l] * scales[l] / scales[j];
            real[j][l] = -spectrum.real * step;
            pair[j][l] = -spectrum.pair * step;
        }
        real[j][j] += 1.0;
        pair[j][j] += 1.0;
    }
    let (real, pair) = (invert(real)?, invert(pair)?);
    let mut resolvents = [[[0.0; PARTS]; N]; N];
    for j in 0..n {
        for l in 0..n {
            resolvents[j][l] = [real[j][l], pair[j][l].re, pair[j][l].im];
        }
    }
    Some(resolvents)
}

/// The inverse of a matrix, by elimination with partial pivoting; `None` where it is singular to working precision.
#[inline(always)]
fn invert<T: ComplexField<RealField = f64> + Copy, const N: usize>(mut a: [[T; N]; N]) -> Option<[[T; N]; N]> {
    let mut inverse = [[T::zero(); N]; N];
    for (i, row) in inverse.iter_mut().enumerate() {
        row[i] = T::one();
    }
    for k in 0..N {
        let mut best = k;
        for i in k + 1..N {
            if a[i][k].norm1() > a[best][k].norm1() {
                best = i;
            }
        }
        a.swap(k, best);
        inverse.swap(k, best);
        let pivot = a[k][k].norm1();
        if pivot < 1e-280 || !pivot.is_finite() {
            return None;
        }
        let by = T::one() / a[k][k];
        for j in 0..N {
            a[k][j] *= by;
            inverse[k][j] *= by;
        }
        for i in 0..N {
            if i != k {
                let factor = a[i][k];
                for j in 0..N {
                    let (x, y) = (a[k][j], inverse[k][j]);
                    a[i][j] -= factor * x;
                    inverse[i][j] -= factor * y;
                }
            }
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spectrum_is_that_of_the_method() {
        for i in 0..3 {
            for k in 0..3 {
                let sum = |table: &[[Parts; 3]; 3]| table[i][k][0] + table[i][k][1];
                assert!((sum(&SPECTRUM.projectors) - f64::from(u8::from(i == k))).abs() < 1e-14);
                assert!((sum(&SPECTRUM.weighted) - A[i][k]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn an_inverse_needs_pivoting_and_a_singular_matrix_has_none() {
        let a = [[0.0, 2.0, 1.0], [1.0, -1.0, 3.0], [4.0, 0.5, -2.0]];
        let inverse = invert(a).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| a[i][k] * inverse[k][j]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        assert!(invert([[1.0, 2.0], [2.0, 4.0]]).is_none());
    }
}
