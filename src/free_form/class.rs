//! A class of laws: the model with curves of some variables as its free force, at a state of its unknowns.

use super::linear::HELD;
use super::readings::{Readings, Response};
use super::spline::Basis;
use super::variable::Variable;
use nalgebra::{DMatrix, DVector};

/// Near a fold the amplitude that a curve of the amplitude leads to moves without bound: by more than so many times its
/// direct change it counts as that.
const NEAR_FOLD: f64 = 0.1;
/// Longest change of a logarithm of an amplitude in one step.
const LONGEST: f64 = 0.5;
/// Largest logarithm of a ratio of stiffnesses.
const LARGEST: f64 = 20.0;
/// A nuisance parameter of whose effect others leave less than this share is not moved.
const SAME: f64 = 0.1;

/// Residuals of amplitude and, where measured, phase in standard deviations.
pub type Residual = (f64, Option<f64>);

/// One variable of a class, at all readings.
pub struct Axis {
    /// Which.
    pub variable: Variable,
    /// Its values.
    pub values: Vec<f64>,
    /// Where they lie on the scale of the curve.
    pub places: Vec<f64>,
    /// The functions of the curve.
    pub basis: Basis,
    /// Number of the first coefficient of k; those of c follow them.
    first: usize,
}

/// A class: the unknowns are the nuisance parameters, a constant k and c, and the coefficients of the curves.
pub struct Class<'a> {
    /// The readings.
    pub readings: &'a Readings<'a>,
    /// Its variables; none for a constant.
    pub axes: Vec<Axis>,
    /// Number of the unknowns.
    pub unknowns: usize,
    /// Nuisance parameters that move: none whose work the constants, the curves or those before do.
    moved: Vec<bool>,
}

/// A state of a fit: unknowns, and where the curve of the amplitude is read for every reading.
#[derive(Clone)]
pub struct State {
    pub unknowns: DVector<f64>,
    /// ln of the motion at which the curve of the amplitude is read.
    pub motion: Vec<f64>,
}

/// What residuals are of.
#[derive(Clone, Copy, PartialEq)]
pub enum Measure {
    /// The dynamic stiffness that a reading asks for, drive over motion, relative to itself, at the motion that was
    /// measured: linear in k and c, so that curves far from the truth find their way.
    Stiffness,
    /// The logarithm of the reading, at the motion that the model is led to.
    Reading,
}

/// What the model says of the readings at a state.
pub struct Seen {
    /// Rows: amplitude, then phase where measured, of every reading.
    pub residuals: DVector<f64>,
    /// Their derivatives by the unknowns.
    pub jacobian: DMatrix<f64>,
    /// Motion that each reading is led to.
    pub motion: Vec<f64>,
}

impl<'a> Class<'a> {
    /// Whether what depends on the amplitude may be in it: series of several drives differ in that.
    pub fn may_follow_amplitude(&self) -> bool {
        let may = |axis: &Axis| matches!(axis.variable, Variable::Amplitude | Variable::DriveLevel | Variable::Drift);
        self.axes.is_empty() || self.axes.iter().any(may)
    }

    /// The class of these variables; `None` where one of them does not vary.
    pub fn of(
        readings: &'a Readings<'a>,
        variables: &[(Variable, Vec<f64>)],
        series: usize,
        motion: &[f64],
    ) -> Option<Self> {
        let mut unknowns = readings.nuisance.len() + 2;
        let mut axes = Vec::new();
        for (variable, values) in variables {
            let places = variable.places(values);
            let basis = match variable {
                Variable::Drift => Basis::series(series, &places),
                _ => Basis::spline(&places)?,
            };
            let first = unknowns;
            unknowns += 2 * basis.len();
            axes.push(Axis { variable: *variable, values: values.clone(), places, basis, first });
        }
        let mut class = Self { readings, axes, unknowns, moved: vec![true; readings.nuisance.len()] };
        class.moved = class.independent(motion);
        Some(class)
    }

    pub(super) fn nothing(&self, motion: &[f64]) -> State {
        State { unknowns: DVector::zeros(self.unknowns), motion: motion.to_vec() }
    }

    /// Which nuisance parameters do what nothing before them does: constants and curves first. With a mass and a gain
    /// both free, or a gain beside a curve of the frequency, the scale of everything could go to zero, which has no
    /// penalty.
    fn independent(&self, motion: &[f64]) -> Vec<bool> {
        let seen = self.see(&self.nothing(motion), Measure::Reading);
        let mut basis: Vec<DVector<f64>> = Vec::new();
        let nuisance = self.constants();
        let mut moved = vec![false; nuisance];
        for column in (nuisance..self.unknowns).chain(0..nuisance) {
            let mut rest = seen.jacobian.column(column).into_owned();
            let before = rest.norm();
            // Twice, for what rounding leaves.
            for known in basis.iter().chain(&basis) {
                rest -= known * known.dot(&rest);
            }
            let own = rest.norm();
            let least = if column < nuisance { SAME } else { HELD };
            if own > least * before {
                basis.push(rest / own);
                moved.get_mut(column).into_iter().for_each(|moved| *moved = true);
            }
        }
        moved
    }

    pub(super) fn constants(&self) -> usize {
        self.readings.nuisance.len()
    }

    /// Whether the readings could be more than twice as many as the curves could follow by themselves.
    pub fn is_bounded(&self) -> bool {
        let measured: usize = self.readings.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum();
        measured > 2 * self.unknowns
    }

    /// Numbers of the coefficients of k and of c of a curve.
    pub fn coefficients(axis: &Axis) -> [std::ops::Range<usize>; 2] {
        let n = axis.basis.len();
        [axis.first..axis.first + n, axis.first + n..axis.first + 2 * n]
    }

    /// The curves at a state, at a place of an axis: k and c in the units of the readings.
    pub fn curve(axis: &Axis, state: &State, place: f64) -> [f64; 2] {
        let values = axis.basis.values(place);
        Self::coefficients(axis).map(|range| range.zip(&values).map(|(i, b)| state.unknowns[i] * b).sum())
    }

    pub(super) fn natural(&self, state: &State) -> Vec<f64> {
        let readings = self.readings;
        let steps = readings.nuisance.iter().zip(&readings.calibrated).enumerate();
        steps.map(|(i, (p, value))| p.moved(*value, state.unknowns[i])).collect()
    }

    /// Place of reading `index` on an axis.
    pub(super) fn place(&self, axis: &Axis, state: &State, index: usize) -> f64 {
        if axis.variable == Variable::Amplitude { state.motion[index] } else { axis.places[index] }
    }

    /// k, c and their slopes by the logarithm of the amplitude at a reading.
    pub(super) fn force(&self, state: &State, index: usize) -> ([f64; 2], [f64; 2]) {
        let first = self.constants();
        let mut force = [state.unknowns[first], state.unknowns[first + 1]];
        let mut slopes = [0.0; 2];
        for axis in &self.axes {
            let place = self.place(axis, state, index);
            let curve = Self::curve(axis, state, place);
            (0..2).for_each(|i| force[i] += curve[i]);
            if axis.variable == Variable::Amplitude {
                let by = axis.basis.slopes(place);
                let ranges = Self::coefficients(axis);
                for (slope, range) in slopes.iter_mut().zip(ranges) {
                    *slope += range.zip(&by).map(|(i, b)| state.unknowns[i] * b).sum::<f64>();
                }
            }
        }
        (force, slopes)
    }

    pub(super) fn solve(&self, state: &State, which: &[usize]) -> Vec<Option<Response>> {
        let force: Vec<[f64; 2]> = which.iter().map(|&i| self.force(state, i).0).collect();
        self.readings.solve(which, &self.natural(state), &force)
    }

    /// Where a response leads: with a curve of the amplitude the motion is one that leads to itself, found by Newton's
    /// step. Changes of ln amplitude, phase and ln motion by that step, and the factor of every change of the motion.
    pub(super) fn led(&self, state: &State, index: usize, response: &Response) -> ([f64; 2], f64, f64) {
        if !self.axes.iter().any(|axis| axis.variable == Variable::Amplitude) {
            return ([0.0; 2], state.motion[index], 1.0);
        }
        let (_, slopes) = self.force(state, index);
        let by = |what: usize| response.by[0][what] * slopes[0] + response.by[1][what] * slopes[1];
        let own = 1.0 - by(2);
        let factor = 1.0 / own.abs().max(NEAR_FOLD).copysign(own);
        let step = ((response.motion - state.motion[index]) * factor).clamp(-LONGEST, LONGEST);
        ([by(0) * step, by(1) * step], state.motion[index] + step, factor)
    }

    pub(super) fn see(&self, state: &State, measure: Measure) -> Seen {
        let all: Vec<usize> = (0..self.readings.points.len()).collect();
        let responses = self.solve(state, &all);
        let rows = self.readings.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum();
        let mut seen = Seen {
            residuals: DVector::zeros(rows),
            jacobian: DMatrix::zeros(rows, self.unknowns),
            motion: state.motion.clone(),
        };
        let mut row = 0;
        for (index, response) in responses.iter().enumerate() {
            let point = self.readings.points[index];
            let led = |response| match measure {
                Measure::Reading => self.led(state, index, response),
                Measure::Stiffness => ([0.0; 2], state.motion[index], 0.0),
            };
            let led = response.as_ref().map(|response| (response, led(response)));
            let predicted = led.as_ref().map(|(r, (change, ..))| (r.amplitude + change[0], r.phase + change[1]));
            let (amplitude, phase) = self.readings.residuals(index, predicted);
            let sds = [Some(point.amplitude_sd / point.amplitude), point.phase_sd];
            for (what, residual) in [Some(amplitude), phase].into_iter().enumerate() {
                let (Some(residual), Some(sd)) = (residual, sds[what]) else { continue };
                seen.residuals[row] = residual;
                if let Some((response, (_, motion, factor))) = &led {
                    seen.motion[index] = *motion;
                    self.derivatives(state, index, (response, *factor), what, |column, by| {
                        seen.jacobian[(row, column)] = by / sd;
                    });
                }
                row += 1;
            }
            if measure == Measure::Stiffness && led.is_some() {
                let count = 1 + usize::from(phase.is_some());
                in_stiffness(&mut seen, row - count, &sds[..count]);
            }
        }
        seen
    }

    /// Derivatives of ln amplitude (0) or phase (1) of a reading by the unknowns.
    fn derivatives(
        &self,
        state: &State,
        index: usize,
        (response, factor): (&Response, f64),
        what: usize,
        mut put: impl FnMut(usize, f64),
    ) {
        let (_, slopes) = self.force(state, index);
        let through = (response.by[0][what] * slopes[0] + response.by[1][what] * slopes[1]) * factor;
        let of = |number: usize| response.by[number][what] + through * response.by[number][2];
        let nuisance = self.constants();
        (0..nuisance).filter(|i| self.moved[*i]).for_each(|i| put(i, of(2 + i)));
        let by = [of(0), of(1)];
        (0..2).for_each(|i| put(nuisance + i, by[i]));
        for axis in &self.axes {
            let values = axis.basis.values(self.place(axis, state, index));
            for (range, by) in Self::coefficients(axis).into_iter().zip(by) {
                range.zip(&values).for_each(|(column, value)| put(column, by * value));
            }
        }
    }

    /// Reading of every row of residuals.
    pub(super) fn of_rows(&self) -> Vec<usize> {
        let points = self.readings.points.iter().enumerate();
        points.flat_map(|(index, p)| std::iter::repeat_n(index, 1 + usize::from(p.phase.is_some()))).collect()
    }
}

/// Turns the residuals of a reading in the logarithm of its motion, d, with their derivatives, into those of the
/// dynamic stiffness, 1 - exp(-d); `first` is the row of the amplitude, that of the phase follows where there is one.
fn in_stiffness(seen: &mut Seen, first: usize, sds: &[Option<f64>]) {
    let sd = |part: usize| sds.get(part).copied().flatten().unwrap_or(1.0);
    let has_phase = sds.len() > 1;
    let (amplitude, phase) =
        (seen.residuals[first] * sd(0), if has_phase { seen.residuals[first + 1] * sd(1) } else { 0.0 });
    let size = (-amplitude).min(LARGEST).exp();
    let (re, im) = (size * phase.cos(), -size * phase.sin());
    seen.residuals[first] = (1.0 - re) / sd(0);
    if has_phase {
        seen.residuals[first + 1] = -im / sd(1);
    }
    for column in 0..seen.jacobian.ncols() {
        let of_amplitude = seen.jacobian[(first, column)] * sd(0);
        let of_phase = if has_phase { seen.jacobian[(first + 1, column)] * sd(1) } else { 0.0 };
        seen.jacobian[(first, column)] = (re * of_amplitude - im * of_phase) / sd(0);
        if has_phase {
            seen.jacobian[(first + 1, column)] = (im * of_amplitude + re * of_phase) / sd(1);
        }
    }
}
