//! The fit of one class: curves of its variables, and beside them what a constant can do, by Gauss-Newton steps with
//! damping.

use super::class::{Axis, Class, Measure, Residual, Seen, State};
use super::linear::{inverse, robust, solved, typical};
use super::variable::Variable;
use crate::fit::TAIL;
use nalgebra::{DMatrix, DVector};

/// Penalties that are tried: powers of ten times the ratio of what the readings and what the penalty know of a curve.
const PENALTIES: [f64; 9] = [-4.5, -3.0, -1.5, 0.0, 1.5, 3.0, 4.5, 6.0, 7.5];
/// The one that the search for them begins with.
const START: usize = 1;
/// Blocks of neighbouring readings of a series, each predicted from all other readings when a penalty is chosen.
const BLOCKS: usize = 4;
/// Choices of the penalties, each followed by steps ...
const ROUNDS: usize = 3;
/// ... at most so many, ...
const STEPS: usize = 12;
/// ... until one lowers the sum of squares by less than this share.
const DONE: f64 = 1e-4;
/// Damping of the first step, a share of what the readings know of each unknown: next to none, since other penalties
/// ask for long steps, but along what the readings hardly know (a slope of k over the frequency, and the mass) none
/// leads far away.
const LEAST: f64 = 1e-4;

/// A finished fit.
pub struct Fitted {
    /// Its state.
    pub state: State,
    /// Residuals in standard deviations, amplitude and phase of every reading.
    pub residuals: Vec<Residual>,
    /// Unknowns that the readings determine.
    pub freedom: f64,
    /// Covariance of the unknowns over the variance of the residuals.
    pub covariance: DMatrix<f64>,
    /// Residuals of each series as predicted from all others; `None` with one series.
    pub predicted: Option<Vec<Residual>>,
    motion: Vec<f64>,
    /// In the measure of the stiffness.
    asked: Seen,
}

impl Class<'_> {
    /// Standard deviations of the curves at a place, over that of the residuals.
    pub fn deviation(axis: &Axis, fitted: &Fitted, place: f64) -> [f64; 2] {
        let values = DVector::from_vec(axis.basis.values(place));
        Self::coefficients(axis).map(|range| {
            let own = fitted.covariance.view((range.start, range.start), (range.len(), range.len()));
            values.dot(&(own * &values)).max(0.0).sqrt()
        })
    }

    /// Fits the class; `start` gives k and c that the readings ask for, where phases tell them, with their weights.
    pub fn fit(&self, motion: &[f64], start: &[Option<([f64; 2], [f64; 2])>]) -> Fitted {
        let folds = self.blocks();
        let mut penalties = vec![PENALTIES[START]; 2 * self.axes.len()];
        let mut state = self.nothing(motion);
        let mut seen = self.see(&state, Measure::Stiffness);
        if let Some(other) = self.begin(&state, start) {
            let found = self.see(&other, Measure::Stiffness);
            let threshold = TAIL * typical(&seen.residuals).min(typical(&found.residuals));
            if robust(&found.residuals, threshold).0 < robust(&seen.residuals, threshold).0 {
                (state, seen) = (other, found);
            }
        }
        for _ in 0..ROUNDS {
            penalties = self.chosen(&state, &seen, &folds, &penalties);
            (state, seen) = self.descend(state, seen, &penalties, Measure::Stiffness);
        }
        seen = self.see(&state, Measure::Reading);
        penalties = self.chosen(&state, &seen, &folds, &penalties);
        (state, seen) = self.descend(state, seen, &penalties, Measure::Reading);
        self.finish(state, seen, &penalties)
    }

    /// Linear least squares on the k and c that the readings ask for.
    fn begin(&self, from: &State, start: &[Option<([f64; 2], [f64; 2])>]) -> Option<State> {
        let nuisance = self.constants();
        let mut normal = DMatrix::zeros(self.unknowns, self.unknowns);
        let mut right = DVector::zeros(self.unknowns);
        for (index, wanted) in start.iter().enumerate() {
            let Some((values, weights)) = wanted else { continue };
            for part in 0..2 {
                let mut row = DVector::zeros(self.unknowns);
                row[nuisance + part] = weights[part];
                for axis in &self.axes {
                    let own = axis.basis.values(self.place(axis, from, index));
                    let range = Self::coefficients(axis)[part].clone();
                    range.zip(own).for_each(|(column, value)| row[column] = weights[part] * value);
                }
                right += &row * (weights[part] * values[part]);
                normal += &row * row.transpose();
            }
        }
        let penalty = self.penalty(&normal, &vec![PENALTIES[START]; 2 * self.axes.len()]);
        let unknowns = solved(&(normal + penalty), &right)?;
        Some(State { unknowns, motion: from.motion.clone() })
    }

    /// The penalty over all unknowns, scaled to what the readings know of each curve.
    fn penalty(&self, normal: &DMatrix<f64>, exponents: &[f64]) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.unknowns, self.unknowns);
        for (axis, own) in self.axes.iter().zip(exponents.chunks(2)) {
            let penalty = axis.basis.penalty();
            let known = penalty.trace();
            for (range, exponent) in Self::coefficients(axis).into_iter().zip(own) {
                let (first, n) = (range.start, range.len());
                let trace = normal.view((first, first), (n, n)).trace();
                let scale = if known > 0.0 { 10f64.powf(*exponent) * trace / known } else { 0.0 };
                all.view_mut((first, first), (n, n)).copy_from(&(&penalty * scale));
            }
        }
        all
    }

    /// Blocks of neighbouring readings along every series: the number of that of every reading.
    fn blocks(&self) -> Vec<usize> {
        let points = &self.readings.points;
        let series = |of: usize| points.iter().filter(|p| p.series == of).count();
        let mut seen = vec![0; points.iter().map(|p| p.series + 1).max().unwrap_or(0)];
        let place = |p: &&crate::measurement::Point| {
            let at = seen[p.series];
            seen[p.series] += 1;
            p.series * BLOCKS + at * BLOCKS / series(p.series)
        };
        points.iter().map(place).collect()
    }

    /// Sums of the normal equations over the readings of every fold, and those over all.
    fn sums(&self, state: &State, seen: &Seen, folds: &[usize]) -> Vec<(DMatrix<f64>, DVector<f64>)> {
        let (_, weights) = robust(&seen.residuals, TAIL * typical(&seen.residuals));
        let count = folds.iter().max().map_or(0, |last| last + 1);
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); count];
        self.of_rows().iter().enumerate().for_each(|(row, reading)| rows[folds[*reading]].push(row));
        let working = &seen.jacobian * &state.unknowns - &seen.residuals;
        let sum = |rows: &Vec<usize>| {
            let own = seen.jacobian.select_rows(rows);
            let weighted = DMatrix::from_fn(rows.len(), self.unknowns, |i, j| own[(i, j)] * weights[rows[i]]);
            let right = DVector::from_iterator(rows.len(), rows.iter().map(|row| working[*row]));
            (weighted.transpose() * &own, weighted.transpose() * right)
        };
        rows.iter().map(sum).collect()
    }

    /// The penalties that predict blocks of readings best from all others, one after the other.
    fn chosen(&self, state: &State, seen: &Seen, folds: &[usize], from: &[f64]) -> Vec<f64> {
        let sums = self.sums(state, seen, folds);
        let normal = sums.iter().fold(DMatrix::zeros(self.unknowns, self.unknowns), |all, (own, _)| all + own);
        let right = sums.iter().fold(DVector::zeros(self.unknowns), |all, (_, own)| all + own);
        let working = &seen.jacobian * &state.unknowns - &seen.residuals;
        let threshold = TAIL * typical(&seen.residuals);
        let of_rows = self.of_rows();
        let score = |exponents: &[f64]| -> f64 {
            let whole = &normal + self.penalty(&normal, exponents);
            let without = sums.iter().map(|(own, of)| solved(&(&whole - own), &(&right - of)));
            let without: Vec<Option<DVector<f64>>> = without.collect();
            let errors = of_rows.iter().enumerate().map(|(row, reading)| match &without[folds[*reading]] {
                Some(unknowns) => seen.jacobian.row(row).transpose().dot(unknowns) - working[row],
                None => f64::INFINITY,
            });
            robust(&DVector::from_iterator(of_rows.len(), errors), threshold).0
        };
        let mut best = from.to_vec();
        for number in 0..best.len() {
            let tried = PENALTIES.iter().map(|exponent| {
                let mut trial = best.clone();
                trial[number] = *exponent;
                (score(&trial), trial)
            });
            let least = tried.min_by(|a, b| a.0.total_cmp(&b.0));
            best = least.map_or(best, |(_, trial)| trial);
        }
        best
    }

    /// Damped Gauss-Newton steps with these penalties.
    fn descend(&self, mut state: State, mut seen: Seen, exponents: &[f64], measure: Measure) -> (State, Seen) {
        let mut damping = LEAST;
        let threshold = TAIL * typical(&seen.residuals);
        let all = vec![0; self.readings.points.len()];
        for _ in 0..STEPS {
            let Some((normal, right)) = self.sums(&state, &seen, &all).into_iter().next() else { break };
            let penalty = self.penalty(&normal, exponents);
            let cost = |state: &State, seen: &Seen| {
                robust(&seen.residuals, threshold).0 + state.unknowns.dot(&(&penalty * &state.unknowns))
            };
            let before = cost(&state, &seen);
            let whole = &normal + &penalty;
            let slope = &right - &whole * &state.unknowns;
            let mut taken = None;
            for _ in 0..STEPS {
                let damped = &whole + DMatrix::from_diagonal(&(normal.diagonal() * damping));
                let Some(step) = solved(&damped, &slope) else { break };
                let trial = State { unknowns: &state.unknowns + step, motion: seen.motion.clone() };
                let found = self.see(&trial, measure);
                let after = cost(&trial, &found);
                if after < before {
                    damping *= 0.1;
                    taken = Some((trial, found, after));
                    break;
                }
                damping *= 10.0;
            }
            let Some((next, found, after)) = taken else { break };
            (state, seen) = (next, found);
            if before - after < DONE * before {
                break;
            }
        }
        (state, seen)
    }

    fn finish(&self, state: State, seen: Seen, exponents: &[f64]) -> Fitted {
        let all = vec![0; self.readings.points.len()];
        let sums = self.sums(&state, &seen, &all);
        let (normal, right) = sums
            .into_iter()
            .next()
            .unwrap_or((DMatrix::zeros(self.unknowns, self.unknowns), DVector::zeros(self.unknowns)));
        let penalty = self.penalty(&normal, exponents);
        let whole = &normal + &penalty;
        let covariance = inverse(&whole).unwrap_or_else(|| DMatrix::zeros(self.unknowns, self.unknowns));
        let freedom = (&covariance * &normal).trace();
        let residuals = self.pairs(&seen.residuals);
        let predicted = self.predicted(&state, &seen, &whole, &right);
        let asked = self.see(&state, Measure::Stiffness);
        Fitted { state, residuals, freedom, covariance, predicted, motion: seen.motion, asked }
    }

    /// Residuals of every series as predicted from all others: a step from the fit to all, and a new solution.
    fn predicted(
        &self,
        state: &State,
        seen: &Seen,
        whole: &DMatrix<f64>,
        right: &DVector<f64>,
    ) -> Option<Vec<Residual>> {
        let folds: Vec<usize> = self.readings.points.iter().map(|p| p.series).collect();
        let sums = self.sums(state, seen, &folds);
        if sums.len() < 2 {
            return None;
        }
        let mut found = vec![(0.0, None); folds.len()];
        for (series, (own, of)) in sums.iter().enumerate() {
            let which: Vec<usize> = (0..folds.len()).filter(|&i| folds[i] == series).collect();
            let unknowns = solved(&(whole - own), &(right - of))?;
            let mut trial = State { unknowns, motion: state.motion.clone() };
            let mut predicted = vec![None; which.len()];
            let led = self.axes.iter().any(|axis| axis.variable == Variable::Amplitude);
            for _ in 0..if led { ROUNDS } else { 1 } {
                for (at, response) in self.solve(&trial, &which).iter().enumerate() {
                    predicted[at] = response.as_ref().map(|r| {
                        let (change, motion, _) = self.led(&trial, which[at], r);
                        ((r.amplitude + change[0], r.phase + change[1]), motion)
                    });
                }
                let moved = which.iter().zip(&predicted).filter_map(|(i, p)| Some((*i, p.as_ref()?.1)));
                moved.for_each(|(i, motion)| trial.motion[i] = motion);
            }
            for (index, predicted) in which.iter().zip(predicted) {
                found[*index] = self.readings.residuals(*index, predicted.map(|(values, _)| values));
            }
        }
        Some(found)
    }

    /// The motion at which each reading is found in the fit.
    pub fn motion<'f>(&self, fitted: &'f Fitted) -> &'f [f64] {
        &fitted.motion
    }

    /// Residuals that are left where k and c at the readings are those that a law of free strength gives instead of the
    /// curves, at the motion of the fit: what a constant can do beside it is done. The strength has the sign that is
    /// wanted of it, or any.
    pub fn left_by(&self, fitted: &Fitted, law: &[[f64; 2]], signed: bool) -> Option<Vec<Residual>> {
        let seen = &fitted.asked;
        let nuisance = self.constants();
        let curves: Vec<[f64; 2]> = (0..law.len())
            .map(|i| {
                let own = self.force(&fitted.state, i).0;
                [own[0] - fitted.state.unknowns[nuisance], own[1] - fitted.state.unknowns[nuisance + 1]]
            })
            .collect();
        let through = |force: &[[f64; 2]]| {
            let of_rows = self.of_rows();
            let by = |(row, reading): (usize, &usize)| {
                (0..2).map(|part| seen.jacobian[(row, nuisance + part)] * force[*reading][part]).sum::<f64>()
            };
            DVector::from_iterator(of_rows.len(), of_rows.iter().enumerate().map(by))
        };
        let bare = &seen.residuals - through(&curves);
        let (_, weights) = robust(&seen.residuals, TAIL * typical(&seen.residuals));
        // The scale of everything stays: of what is far off, none at all would be the nearest.
        let mut columns = seen.jacobian.columns(nuisance, 2).into_owned().insert_columns(2, 1, 0.0);
        columns.set_column(2, &through(law));
        let without = |columns: &DMatrix<f64>| {
            let weighted = DMatrix::from_fn(columns.nrows(), columns.ncols(), |i, j| columns[(i, j)] * weights[i]);
            let step = solved(&(weighted.transpose() * columns), &-(weighted.transpose() * &bare))?;
            let strength = step[step.len() - 1];
            Some((&bare + columns * step, strength))
        };
        let (left, strength) = without(&columns)?;
        let left = if signed || strength >= 0.0 { left } else { without(&columns.remove_column(2))?.0 };
        let of_reading = |((amplitude, phase), point): (Residual, &&crate::measurement::Point)| {
            let sds = (point.amplitude_sd / point.amplitude, point.phase_sd.unwrap_or(1.0));
            let (re, im) = (1.0 - amplitude * sds.0, -phase.unwrap_or(0.0) * sds.1);
            (-re.hypot(im).ln() / sds.0, phase.map(|_| -im.atan2(re) / sds.1))
        };
        Some(self.pairs(&left).into_iter().zip(&self.readings.points).map(of_reading).collect())
    }

    /// Residuals of amplitude and phase from those in rows.
    fn pairs(&self, residuals: &DVector<f64>) -> Vec<Residual> {
        let mut rows = residuals.iter().copied();
        let points = self.readings.points.iter();
        points.map(|p| (rows.next().unwrap_or(0.0), p.phase.and_then(|_| rows.next()))).collect()
    }
}
