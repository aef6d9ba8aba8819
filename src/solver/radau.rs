//! One step of the three-stage Radau IIA collocation method (order 5; Hairer and Wanner, Solving ODEs II, IV.5) for a
//! system with one algebraic unknown, and its tangent.
//!
//! What of the rates is affine ([`crate::model::system::Affine`]) is eliminated beforehand: with the unknowns U at the
//! stages - the algebraic unknown s and the rates r of the rows that are not affine - the states at the stages are
//!
//!   Z = E z + K (1, sin wt, cos wt) + H U,
//!
//! with matrices that depend on the mode and the size of the step only and are kept from step to step. Newton's method
//! then has three unknowns where only the law of friction is not affine, whatever the number of states. Where the
//! constraint is affine, s is eliminated with the states, and none is left if the rates are, too.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::collocation::parabola;
pub use super::collocation::{A, C, State};
use super::elimination::{Eliminations, MAX_UNKNOWNS};
use super::harmonic::Complex;
use super::lu::{Lu, MAX_ORDER};
use crate::model::system::{Evaluation, Forcing, HybridSystem, MAX_STATES, Mode};

/// Calls a method with the numbers of states and of unknowns of a stage, and with the first and the order of the
/// equations as constants where they are common, so that the compiler unrolls the loops.
macro_rules! sized {
    (($n:expr, $m:expr), $self:ident.$method:ident($($argument:expr),*)) => {
        match ($n, $m) {
            (3, 1) => $self.$method::<3, 3>((3, 1), $($argument),*),
            (3, 2) => $self.$method::<3, 6>((3, 2), $($argument),*),
            (4, 1) => $self.$method::<4, 3>((4, 1), $($argument),*),
            (4, 2) => $self.$method::<4, 6>((4, 2), $($argument),*),
            (4, 3) => $self.$method::<4, 9>((4, 3), $($argument),*),
            (5, 1) => $self.$method::<5, 3>((5, 1), $($argument),*),
            (5, 2) => $self.$method::<5, 6>((5, 2), $($argument),*),
            sizes => $self.$method::<MAX_STATES, MAX_ORDER>(sizes, $($argument),*),
        }
    };
}

/// Values of the unknowns at a stage.
type Values = [f64; MAX_UNKNOWNS];

/// A step that was taken, as far as its adjoint needs it.
#[derive(Debug, Clone)]
pub struct Taken {
    /// Mode.
    pub mode: Mode,
    /// Size \[s\].
    pub size: f64,
    /// Weight of its integral in the fundamental.
    pub weight: f64,
    /// Forcing at the stages.
    pub forcing: [Forcing; 3],
    /// States at the stages.
    pub z: [State; 3],
    /// Algebraic unknown at the stages.
    pub s: [f64; 3],
}

/// Stage values and the factorised Jacobian of the last step taken.
pub struct Stepper {
    eliminations: Eliminations,
    lu: Lu,
    evaluations: [Evaluation; 3],
    /// Forcing at the stages.
    pub forcing: [Forcing; 3],
    /// States at the stages.
    pub z: [State; 3],
    /// Algebraic unknown at the stages.
    pub s: [f64; 3],
    /// The unknowns at the stages.
    values: [Values; 3],
    /// Size and mode of the last step that was accepted, with its unknowns, from which the next is guessed.
    last: Option<(Mode, f64, [Values; 3])>,
    /// Newton iterations of all steps.
    pub iterations: usize,
}

impl Default for Stepper {
    fn default() -> Self {
        Self {
            eliminations: Eliminations::default(),
            lu: Lu::default(),
            evaluations: Default::default(),
            forcing: Default::default(),
            z: [[0.0; MAX_STATES]; 3],
            s: [0.0; 3],
            values: [[0.0; MAX_UNKNOWNS]; 3],
            last: None,
            iterations: 0,
        }
    }
}

impl Stepper {
    /// Takes a step of size `h` from (z, s) under `forcing`; the stages hold the result (the last one is the end). Says
    /// in `lasting` whether more steps of this size are to be expected. False where Newton does not converge.
    #[allow(clippy::too_many_arguments)]
    pub fn step(
        &mut self,
        system: &dyn HybridSystem,
        forcing: &Forcing,
        z: &State,
        s: f64,
        h: f64,
        mode: Mode,
        lasting: bool,
    ) -> bool {
        if !self.eliminations.fit(system, mode, h, lasting) {
            return false;
        }
        let (sine, cosine) = (forcing.sine, forcing.cosine);
        let eliminated = self.eliminations.current();
        let (n, m) = (system.states(), eliminated.unknowns.len());
        self.forcing = eliminated.turn.map(|(s, c)| system.forcing_at(sine * c + cosine * s, cosine * c - sine * s));
        let mut base = [[0.0; MAX_STATES]; 3];
        sized!((n, m), self.base(forcing, z, &mut base));
        if m == 0 {
            self.states(n, m, &base);
            return true;
        }
        self.guess(system, forcing, z, s, h, mode);
        let mut previous = f64::INFINITY;
        for _ in 0..25 {
            self.iterations += 1;
            self.states(n, m, &base);
            self.evaluate(system, mode);
            if !self.factorise(n, m) {
                return false;
            }
            let size = self.correct(m);
            if !size.is_finite() {
                return false;
            }
            // Converged, as far as the squaring of errors by Newton's method tells, or as close as rounding lets it
            // come.
            let ratio = if previous.is_finite() { size / previous } else { 1.0 };
            if size * ratio * ratio < 1e-12 || size < 1e-10 || (size < 1e-6 && ratio > 0.5) {
                self.states(n, m, &base);
                return true;
            }
            previous = size;
        }
        false
    }

    /// Corrects the unknowns by the factorised Jacobian; the largest correction, relative to their units.
    #[inline(always)]
    fn correct(&mut self, m: usize) -> f64 {
        let eliminated = self.eliminations.current();
        let mut delta = [0.0; MAX_ORDER];
        for i in 0..3 {
            let e = &self.evaluations[i];
            for u in 0..m {
                delta[i * m + u] = match eliminated.unknowns.row(u) {
                    None => -e.g,
                    Some(j) => (self.values[i][u] - e.f[j]) / eliminated.units[u],
                };
            }
        }
        self.lu.solve(&mut delta);
        let mut size = 0.0f64;
        for i in 0..3 {
            for u in 0..m {
                let delta = delta[i * m + u];
                self.values[i][u] += delta * eliminated.units[u];
                size = size.max(delta.abs());
            }
        }
        size
    }

    /// Z without the unknowns; the forcing at the start by way of that at the end.
    #[inline(always)]
    fn base<const N: usize, const ORDER: usize>(
        &self,
        (n, _): (usize, usize),
        forcing: &Forcing,
        z: &State,
        base: &mut [State; 3],
    ) {
        let eliminated = self.eliminations.current();
        for i in 0..3 {
            for j in 0..n {
                let (from_start, by) = (&eliminated.start[i][j], &eliminated.forced[i][j]);
                let mut sum = by[0] + by[1] * forcing.sine + by[2] * forcing.cosine;
                for l in 0..n {
                    sum += from_start[l] * z[l];
                }
                base[i][j] = sum;
            }
        }
    }

    /// First values of the unknowns: continued from the last step in the same mode, or constant.
    fn guess(&mut self, system: &dyn HybridSystem, forcing: &Forcing, z: &State, s: f64, h: f64, mode: Mode) {
        let unknowns = &self.eliminations.current().unknowns;
        let m = unknowns.len();
        if let Some((before, size, values)) = &self.last
            && *before == mode
            && h <= 2.0 * size
        {
            for i in 0..3 {
                let [a, b, c] = parabola(1.0 + C[i] * h / size);
                for u in 0..m {
                    self.values[i][u] = a * values[0][u] + b * values[1][u] + c * values[2][u];
                }
            }
            return;
        }
        if !unknowns.rows().is_empty() {
            system.rates(unknowns.rows(), forcing, z, s, mode, &mut self.evaluations[0]);
        }
        for u in 0..m {
            let value = unknowns.row(u).map_or(s, |j| self.evaluations[0].f[j]);
            self.values.iter_mut().for_each(|values| values[u] = value);
        }
    }

    /// Keeps the step just taken, from which the next is guessed; `None` for a mode that ended with it.
    pub fn accept(&mut self, going_on: Option<(Mode, f64)>) {
        self.last = going_on.map(|(mode, size)| (mode, size, self.values));
    }

    /// States and algebraic unknown at the stages from the unknowns.
    fn states(&mut self, n: usize, m: usize, base: &[State; 3]) {
        sized!((n, m), self.states_of(base));
        let unknowns = &self.eliminations.current().unknowns;
        for i in 0..3 {
            self.s[i] =
                if unknowns.slip { self.values[i][0] } else { unknowns.slip_at(n, &self.z[i], &self.forcing[i]) };
        }
    }

    #[inline(always)]
    fn states_of<const N: usize, const ORDER: usize>(&mut self, (n, m): (usize, usize), base: &[State; 3]) {
        let eliminated = self.eliminations.current();
        for i in 0..3 {
            for j in 0..n {
                let by = &eliminated.by_unknown[i][j];
                let mut sum = base[i][j];
                for k in 0..3 {
                    for u in 0..m {
                        sum += by[k][u] * self.values[k][u];
                    }
                }
                self.z[i][j] = sum;
            }
        }
    }

    /// Of rates, constraint and their derivatives at the stages what is not affine; the derivatives by the states
    /// include what goes by way of an algebraic unknown that was eliminated.
    fn evaluate(&mut self, system: &dyn HybridSystem, mode: Mode) {
        let unknowns = &self.eliminations.current().unknowns;
        for i in 0..3 {
            let (forcing, z, s, e) = (&self.forcing[i], &self.z[i], self.s[i], &mut self.evaluations[i]);
            if unknowns.slip {
                system.constraint(forcing, z, s, mode, e);
            }
            if !unknowns.rows().is_empty() {
                system.rates(unknowns.rows(), forcing, z, s, mode, e);
            }
        }
        self.through_slip();
    }

    /// The same with all rates.
    fn evaluate_all(&mut self, system: &dyn HybridSystem, mode: Mode) {
        for i in 0..3 {
            system.evaluate(&self.forcing[i], &self.z[i], self.s[i], mode, &mut self.evaluations[i]);
        }
        self.through_slip();
    }

    fn through_slip(&mut self) {
        let unknowns = &self.eliminations.current().unknowns;
        if unknowns.slip {
            return;
        }
        for e in &mut self.evaluations {
            for &j in unknowns.rows() {
                for (fz, by) in e.fz[j].iter_mut().zip(unknowns.slip_by()) {
                    *fz += e.fs[j] * by;
                }
            }
        }
    }

    fn factorise(&mut self, n: usize, m: usize) -> bool {
        sized!((n, m), self.jacobian());
        self.lu.factorise()
    }

    #[inline(always)]
    fn jacobian<const N: usize, const ORDER: usize>(&mut self, (n, m): (usize, usize)) {
        let eliminated = self.eliminations.current();
        let (unknowns, units) = (&eliminated.unknowns, &eliminated.units);
        let columns = self.lu.columns(3 * m);
        for i in 0..3 {
            let e = &self.evaluations[i];
            for index in 0..m {
                // Residuals: g, and f - r in units of the state over the step.
                let (gradient, own, factor) = match unknowns.row(index) {
                    None => (&e.gz, e.gs, 1.0),
                    Some(j) => (&e.fz[j], e.fs[j], 1.0 / units[index]),
                };
                let row = i * m + index;
                for k in 0..3 {
                    for u in 0..m {
                        let mut through = 0.0;
                        for l in 0..n {
                            through += gradient[l] * eliminated.by_unknown[i][l][k][u];
                        }
                        columns[k * m + u][row] = factor * through * units[u];
                    }
                }
                if unknowns.slip {
                    columns[i * m][row] += factor * own * units[0];
                }
                if unknowns.row(index).is_some() {
                    columns[row][row] -= 1.0;
                }
            }
        }
    }

    /// Derivative of the stage states by the state at the start: `out[stage][row][column]`, for the columns `0..n`. The
    /// unknowns answer through the Jacobian to what the start does without them.
    pub fn tangent(&self, system: &dyn HybridSystem, out: &mut [[State; MAX_STATES]; 3]) {
        sized!((system.states(), self.eliminations.current().unknowns.len()), self.tangent_of(out));
    }

    #[inline(always)]
    fn tangent_of<const N: usize, const ORDER: usize>(
        &self,
        (n, m): (usize, usize),
        out: &mut [[State; MAX_STATES]; 3],
    ) {
        let eliminated = self.eliminations.current();
        let direct = &eliminated.start;
        if m == 0 {
            *out = *direct;
            return;
        }
        let mut rhs = [[0.0; N]; ORDER];
        for i in 0..3 {
            let e = &self.evaluations[i];
            for index in 0..m {
                let row = &mut rhs[i * m + index];
                let (gradient, factor) = match eliminated.unknowns.row(index) {
                    None => (&e.gz, 1.0),
                    Some(j) => (&e.fz[j], 1.0 / eliminated.units[index]),
                };
                for l in 0..n {
                    let weight = -factor * gradient[l];
                    if weight != 0.0 {
                        for column in 0..n {
                            row[column] += weight * direct[i][l][column];
                        }
                    }
                }
            }
        }
        self.lu.solve_block(&mut rhs[..3 * m]);
        for i in 0..3 {
            for j in 0..n {
                let mut row = direct[i][j];
                for k in 0..3 {
                    for u in 0..m {
                        let weight = eliminated.by_unknown[i][j][k][u] * eliminated.units[u];
                        for column in 0..n {
                            row[column] += weight * rhs[k * m + u][column];
                        }
                    }
                }
                out[i][j] = row;
            }
        }
    }

    /// The step just taken; `weight` is that of its integral in the fundamental.
    pub fn taken(&self, mode: Mode, size: f64, weight: f64) -> Taken {
        Taken { mode, size, weight, forcing: self.forcing, z: self.z, s: self.s }
    }

    /// Carries the adjoint of the states at the end of a step that was taken back to its start. Leaves in `rates` and
    /// `constraint` the derivatives of the fundamental by disturbances of f and g at the stages.
    pub fn adjoint(
        &mut self,
        system: &dyn HybridSystem,
        taken: &Taken,
        adjoint: &mut [Complex; MAX_STATES],
        rates: &mut [[Complex; MAX_STATES]; 3],
        constraint: &mut [Complex; 3],
    ) -> bool {
        let h = taken.size;
        if !self.eliminations.fit(system, taken.mode, h, true) {
            return false;
        }
        (self.forcing, self.z, self.s) = (taken.forcing, taken.z, taken.s);
        self.evaluate_all(system, taken.mode);
        let (n, m) = (system.states(), self.eliminations.current().unknowns.len());
        if m > 0 && !self.factorise(n, m) {
            return false;
        }
        // By the states at the stages as they stand: through the fundamental and, at the last, the end.
        let mut by_stage = [[[0.0; 2]; MAX_STATES]; 3];
        for i in 0..3 {
            let w = taken.weight * A[2][i];
            by_stage[i][0] = [w * taken.forcing[i].sine, w * taken.forcing[i].cosine];
        }
        for j in 0..n {
            by_stage[2][j][0] += adjoint[j].0;
            by_stage[2][j][1] += adjoint[j].1;
        }
        *rates = [[(0.0, 0.0); MAX_STATES]; 3];
        self.adjoint_through_unknowns((n, m), &mut by_stage, rates, constraint);
        self.adjoint_through_affine_rows((n, h), &system.scales(), &mut by_stage, adjoint, rates);
        // An algebraic unknown that was eliminated answers to a disturbance of g and moves all rates.
        if !self.eliminations.current().unknowns.slip {
            for i in 0..3 {
                let e = &self.evaluations[i];
                for j in 0..n {
                    constraint[i].0 -= rates[i][j].0 * e.fs[j] / e.gs;
                    constraint[i].1 -= rates[i][j].1 * e.fs[j] / e.gs;
                }
            }
        }
        true
    }

    /// Carries the derivatives by the states at the stages through the affine rows, to the start of a step of size `h`.
    fn adjoint_through_affine_rows(
        &self,
        (n, h): (usize, f64),
        scales: &State,
        by_stage: &mut [[[f64; 2]; MAX_STATES]; 3],
        adjoint: &mut [Complex; MAX_STATES],
        rates: &mut [[Complex; MAX_STATES]; 3],
    ) {
        let eliminated = self.eliminations.current();
        for i in 0..3 {
            for j in 0..n {
                by_stage[i][j] = by_stage[i][j].map(|by| by * scales[j]);
            }
        }
        eliminated.solve_transposed(n, by_stage);
        *adjoint = [(0.0, 0.0); MAX_STATES];
        for j in 0..n {
            for i in 0..3 {
                let by = by_stage[i][j];
                adjoint[j].0 += by[0] / scales[j];
                adjoint[j].1 += by[1] / scales[j];
                if eliminated.unknowns.affine[j] {
                    for k in 0..3 {
                        let w = h * A[i][k] / scales[j];
                        rates[k][j].0 += w * by[0];
                        rates[k][j].1 += w * by[1];
                    }
                }
            }
        }
    }

    /// Adds to the derivatives by the states at the stages what goes by way of the unknowns, which answer through the
    /// Jacobian.
    fn adjoint_through_unknowns(
        &self,
        (n, m): (usize, usize),
        by_stage: &mut [[[f64; 2]; MAX_STATES]; 3],
        rates: &mut [[Complex; MAX_STATES]; 3],
        constraint: &mut [Complex; 3],
    ) {
        let eliminated = self.eliminations.current();
        let (unknowns, units) = (&eliminated.unknowns, &eliminated.units);
        let mut through = [[0.0; 2]; MAX_ORDER];
        for k in 0..3 {
            for u in 0..m {
                let sum = &mut through[k * m + u];
                for i in 0..3 {
                    for j in 0..n {
                        let by = units[u] * eliminated.by_unknown[i][j][k][u];
                        sum[0] += by_stage[i][j][0] * by;
                        sum[1] += by_stage[i][j][1] * by;
                    }
                }
            }
        }
        if m > 0 {
            self.lu.solve_transposed(&mut through[..3 * m]);
        }
        for i in 0..3 {
            let e = &self.evaluations[i];
            for index in 0..m {
                let by = through[i * m + index];
                let row = unknowns.row(index);
                let (gradient, factor) = match row {
                    None => (&e.gz, 1.0),
                    Some(j) => (&e.fz[j], 1.0 / units[index]),
                };
                for l in 0..n {
                    by_stage[i][l][0] -= by[0] * factor * gradient[l];
                    by_stage[i][l][1] -= by[1] * factor * gradient[l];
                }
                match row {
                    None => constraint[i] = (-by[0], -by[1]),
                    Some(j) => rates[i][j] = (-factor * by[0], -factor * by[1]),
                }
            }
        }
    }
}
