//! Derivatives of the fundamental by the parameters along exact flows, by the adjoint method.
//!
//! The adjoint of the states at a point of the orbit, the derivative of the fundamental A by a disturbance there that
//! is carried round and round, follows from the transitions backwards. Over a stretch A and the states at its end are
//! explicit functions of the coefficients of z' = M z + m + ms sin wt + mc cos wt; their derivatives are gathered per
//! mode and only then multiplied by those of the coefficients by the parameters. The times at which modes change do not
//! enter, since the rates are continuous there.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::eliminated::Eliminated;
use super::exponential::{Square, apply, exponential, exponential_gradient};
use super::harmonic::{Complex, products, times};
use super::radau::State;
use crate::model::system::{Forcing, HybridSystem, MAX_COLUMNS, MAX_STATES, Mode, ParameterColumns};

/// The affine equations of one mode of a system of N states, y' = M y + m beside the particular solution, in units of
/// the scales of the states.
pub struct Equations<const N: usize> {
    /// w \[rad/s\].
    pub omega: f64,
    /// Scales of the states.
    pub scales: [f64; N],
    /// M \[1/s\].
    pub m: Square<N>,
    /// m \[1/s\].
    pub constant: [f64; N],
    /// Particular solution ps sin wt + pc cos wt: (ps, pc).
    pub particular: [[f64; N]; 2],
    /// (iw - M)^-1 \[s\].
    pub resolvent: [[Complex; N]; N],
}

impl<const N: usize> Equations<N> {
    /// y at a state.
    pub fn rest(&self, z: &State, (sine, cosine): (f64, f64)) -> [f64; N] {
        let [ps, pc] = &self.particular;
        std::array::from_fn(|i| z[i] / self.scales[i] - ps[i] * sine - pc[i] * cosine)
    }

    /// y'.
    pub fn rate(&self, y: &[f64; N]) -> [f64; N] {
        let mut out = apply(&self.m, y);
        for i in 0..N {
            out[i] += self.constant[i];
        }
        out
    }

    /// The state at y.
    pub fn state(&self, y: &[f64; N], (sine, cosine): (f64, f64)) -> State {
        let [ps, pc] = &self.particular;
        let mut z = [0.0; MAX_STATES];
        for i in 0..N {
            z[i] = (y[i] + ps[i] * sine + pc[i] * cosine) * self.scales[i];
        }
        z
    }
}

/// A stretch of the orbit in one mode.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// Its mode.
    pub mode: Mode,
    /// Times at the start and at the end \[s\].
    pub time: [f64; 2],
    /// States at the start and at the end.
    pub states: [State; 2],
    /// Adjoint of the states at the end.
    pub adjoint: [Complex; MAX_STATES],
    /// Period \[s\].
    pub period: f64,
}

/// Derivatives of the fundamental by the coefficients of a mode, in units of the scales of the states.
#[derive(Debug, Clone, Copy, Default)]
pub struct Gradient {
    matrix: [[Complex; MAX_STATES]; MAX_STATES],
    constant: [Complex; MAX_STATES],
    sine: [Complex; MAX_STATES],
    cosine: [Complex; MAX_STATES],
}

fn add(to: &mut Complex, z: Complex) {
    *to = (to.0 + z.0, to.1 + z.1);
}

/// Adds the derivatives over one stretch.
pub fn gather<const N: usize>(equations: &Equations<N>, stretch: &Stretch, into: &mut Gradient) {
    let [t0, t1] = stretch.time;
    let turn = stretch.time.map(|t| (equations.omega * t).sin_cos());
    let y: [[f64; N]; 2] = std::array::from_fn(|k| equations.rest(&stretch.states[k], turn[k]));
    let e = turn.map(|(sine, cosine)| (cosine, -sine));
    let bare = ((e[0].1 - e[1].1) / equations.omega, -(e[0].0 - e[1].0) / equations.omega);
    let [sine2, cosine2, both] = products(equations.omega, t1 - t0, turn[0], turn[1]);
    // A = gain * integral of z0 e^{-iwt}
    let gain = (0.0, 2.0 / stretch.period * equations.scales[0]);
    let row = equations.resolvent[0].map(|r| times(gain, r));
    let adjoint: [Complex; N] = std::array::from_fn(|i| {
        (stretch.adjoint[i].0 * equations.scales[i], stretch.adjoint[i].1 * equations.scales[i])
    });
    // Adjoints of y at the end and at the start.
    let last: [Complex; N] = std::array::from_fn(|i| {
        let own = times(row[i], e[1]);
        (adjoint[i].0 - own.0, adjoint[i].1 - own.1)
    });
    let transition = exponential(&equations.m, t1 - t0);
    let first: [Complex; N] = std::array::from_fn(|j| {
        let mut sum = times(row[j], e[0]);
        for i in 0..N {
            add(&mut sum, (last[i].0 * transition[i][j], last[i].1 * transition[i][j]));
        }
        sum
    });
    let through = through_transition(equations, t1 - t0, &y[0], &last);
    // Through the resolvent: dR = R dM R.
    let v: [Complex; N] = std::array::from_fn(|i| {
        let c = equations.constant[i];
        (y[0][i] * e[0].0 - y[1][i] * e[1].0 + c * bare.0, y[0][i] * e[0].1 - y[1][i] * e[1].1 + c * bare.1)
    });
    let rv = product(&equations.resolvent, &v);
    // Through the particular solution: derivatives by its sine and cosine parts.
    let mut parts = [[(0.0, 0.0); N]; 2];
    for i in 0..N {
        for (part, (a, b)) in parts.iter_mut().zip([(turn[1].0, turn[0].0), (turn[1].1, turn[0].1)]) {
            part[i] = (adjoint[i].0 * a - first[i].0 * b, adjoint[i].1 * a - first[i].1 * b);
        }
    }
    add(&mut parts[0][0], times(gain, (both, -sine2)));
    add(&mut parts[1][0], times(gain, (cosine2, -both)));
    let (alpha, beta) = through_particular(equations, &parts);
    let [ps, pc] = &equations.particular;
    for i in 0..N {
        for j in 0..N {
            let entry = &mut into.matrix[i][j];
            add(entry, (through[0][i][j], through[1][i][j]));
            add(entry, times(row[i], rv[j]));
            add(entry, times(alpha[i], (ps[j], pc[j])));
            add(entry, times(beta[i], (ps[j], -pc[j])));
        }
        add(&mut into.constant[i], (through[0][i][N], through[1][i][N]));
        add(&mut into.constant[i], times(row[i], bare));
        add(&mut into.sine[i], (alpha[i].0 + beta[i].0, alpha[i].1 + beta[i].1));
        add(&mut into.cosine[i], (beta[i].1 - alpha[i].1, alpha[i].0 - beta[i].0));
    }
}

/// By matrix and constant through the map y -> Phi y + c over a time, of which `last` is the adjoint at the end: real
/// and imaginary part, from the exponential of the matrix with the constant beside it.
fn through_transition<const N: usize>(
    equations: &Equations<N>,
    time: f64,
    y: &[f64; N],
    last: &[Complex; N],
) -> [Wide; 2] {
    let mut wide = [[0.0; MAX_STATES]; MAX_STATES];
    let mut outer = [[[0.0; MAX_STATES]; MAX_STATES]; 2];
    for i in 0..N {
        wide[i][..N].copy_from_slice(&equations.m[i]);
        wide[i][N] = equations.constant[i];
        for (part, outer) in outer.iter_mut().enumerate() {
            let nu = if part == 0 { last[i].0 } else { last[i].1 };
            for j in 0..N {
                outer[i][j] = nu * y[j];
            }
            outer[i][N] = nu;
        }
    }
    outer.map(|outer| widened(N + 1, &wide, time, &outer))
}

/// By the forcing through the particular solution, given the derivatives by its sine and cosine parts: the terms that
/// turn forwards and backwards.
fn through_particular<const N: usize>(
    equations: &Equations<N>,
    parts: &[[Complex; N]; 2],
) -> ([Complex; N], [Complex; N]) {
    let (mut alpha, mut beta) = ([(0.0, 0.0); N], [(0.0, 0.0); N]);
    for k in 0..N {
        let (s, c) = (parts[0][k], parts[1][k]);
        let minus = (0.5 * (s.0 + c.1), 0.5 * (s.1 - c.0));
        let plus = (0.5 * (s.0 - c.1), 0.5 * (s.1 + c.0));
        for i in 0..N {
            let r = equations.resolvent[k][i];
            add(&mut alpha[i], times(minus, r));
            add(&mut beta[i], times(plus, (r.0, -r.1)));
        }
    }
    (alpha, beta)
}

fn product<const N: usize>(a: &[[Complex; N]; N], v: &[Complex; N]) -> [Complex; N] {
    std::array::from_fn(|i| {
        let mut sum = (0.0, 0.0);
        for j in 0..N {
            add(&mut sum, times(a[i][j], v[j]));
        }
        sum
    })
}

type Wide = Square<MAX_STATES>;

/// [`exponential_gradient`] of the leading block of order `n`.
fn widened(n: usize, m: &Wide, t: f64, g: &Wide) -> Wide {
    macro_rules! of {
        ($n:literal) => {{
            let cut = |a: &Wide| -> Square<$n> { std::array::from_fn(|i| std::array::from_fn(|j| a[i][j])) };
            let small = exponential_gradient(&cut(m), t, &cut(g));
            let mut out = [[0.0; MAX_STATES]; MAX_STATES];
            for i in 0..$n {
                out[i][..$n].copy_from_slice(&small[i]);
            }
            out
        }};
    }
    match n {
        4 => of!(4),
        5 => of!(5),
        6 => of!(6),
        _ => of!(7),
    }
}

/// Adds to `out`, per parameter column, the derivative of the fundamental through the coefficients of one mode. False
/// where they are not determined.
pub fn through_columns(system: &dyn HybridSystem, mode: Mode, by: &Gradient, out: &mut [Complex]) -> bool {
    let Some(equations) = Eliminated::new(system, mode) else { return false };
    let (n, scales) = (system.states(), system.scales());
    let through: State = std::array::from_fn(|i| equations.base.fs[i] / equations.base.gs);
    let mut columns = ParameterColumns { f: [[0.0; MAX_STATES]; MAX_COLUMNS], g: [0.0; MAX_COLUMNS] };
    // The derivatives of the rates are affine as the rates are: values at as many points as there are coefficients.
    let mut point = |forcing: &Forcing, z: &State, parts: [f64; 3], weight: &[Complex; MAX_STATES]| {
        system.parameter_columns(forcing, z, equations.slip(z, parts), mode, &mut columns);
        for (out, (f, g)) in out.iter_mut().zip(columns.f.iter().zip(&columns.g)) {
            for i in 0..n {
                let rate = (f[i] - through[i] * g) / scales[i];
                out.0 += weight[i].0 * rate;
                out.1 += weight[i].1 * rate;
            }
        }
    };
    let rest = Forcing::default();
    let zero = [0.0; MAX_STATES];
    let mut remaining = by.constant;
    for i in 0..n {
        for part in by.matrix[i][..n].iter().chain([&by.sine[i], &by.cosine[i]]) {
            remaining[i] = (remaining[i].0 - part.0, remaining[i].1 - part.1);
        }
    }
    point(&rest, &zero, [1.0, 0.0, 0.0], &remaining);
    point(&system.forcing(0.25 * system.period()), &zero, [1.0, 1.0, 0.0], &by.sine);
    point(&system.forcing(0.0), &zero, [1.0, 0.0, 1.0], &by.cosine);
    for j in 0..n {
        let mut z = zero;
        z[j] = scales[j];
        let weight = std::array::from_fn(|i| by.matrix[i][j]);
        point(&rest, &z, [1.0, 0.0, 0.0], &weight);
    }
    true
}
