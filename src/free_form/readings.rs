//! What the model with a free force says of every reading, with derivatives.

use super::force::FreeForce;
use crate::compare::Comparison;
use crate::fit::{Parameter, TROUBLED, operation, parameter};
use crate::measurement::Point;
use crate::model::lumps::Lumps;
use crate::model::{Model, Operation};
use crate::parameter::FIRST_INSTRUMENT_PARAMETER;
use crate::solver::cycle::Tolerance;
use crate::solver::{Status, Warm, solve_steady};
use crate::statistics::wrap;
use nalgebra::Complex;
use rayon::prelude::*;

/// Points at most of a rig whose steady states have to be searched for; of a linear one, which has them in closed form,
/// many times as many.
const MOST: (usize, usize) = (600, 4_000);

/// Numbers of the rig's own stiffness and damping among the parameters of a model: a constant k and c do the same.
const OF_CONSTANTS: [usize; 2] = [1, 2];

/// The calibrated base with a free force, at the readings that are used.
pub struct Readings<'a> {
    model: Model,
    index: usize,
    /// The points that are used, and their numbers among those of the comparison.
    pub points: Vec<&'a Point>,
    /// As that.
    pub numbers: Vec<usize>,
    /// What is refitted beside every curve and a constant k and c: the other free parameters and the gain of the
    /// reading.
    pub nuisance: Vec<Parameter>,
    /// Their calibrated values.
    pub calibrated: Vec<f64>,
    /// Units of k and c in which the numbers are of order one: K/Q and C of the base.
    pub units: [f64; 2],
    /// K and C of the base.
    pub rig: [f64; 2],
}

/// The model at one reading: in the logarithm of the amplitude, the phase \[rad\] and the logarithm of the motion; each
/// with its derivatives by k, c and the natural scale of the nuisance parameters.
#[derive(Clone)]
pub struct Response {
    /// ln of the reading's amplitude.
    pub amplitude: f64,
    /// Phase \[rad\].
    pub phase: f64,
    /// ln of the amplitude of the coordinate's motion.
    pub motion: f64,
    /// Derivatives of the three by each.
    pub by: Vec<[f64; 3]>,
}

impl<'a> Readings<'a> {
    /// Those of a comparison's calibrated model; at most so many, spread evenly along every series.
    pub fn of(c: &'a Comparison) -> Self {
        let (model, index) = FreeForce::beside(&c.model);
        let free = c.fit.parameters.iter().cloned().zip(c.fit.values.iter().copied());
        let (mut nuisance, mut calibrated): (Vec<Parameter>, Vec<f64>) =
            free.filter(|(p, _)| !OF_CONSTANTS.contains(&p.index)).unzip();
        let gain = model.base_parameters().into_iter().find(|(_, at, _)| *at == FIRST_INSTRUMENT_PARAMETER + 1);
        let gain = gain.and_then(|(key, ..)| parameter(&model, &key));
        if let Some(gain) = gain.filter(|gain| nuisance.iter().all(|p| p.index != gain.index)) {
            nuisance.push(gain);
            calibrated.push(model.instrument.amplitude_gain);
        }
        let closed = c.points.iter().all(|p| p.point.load == 0.0) && !c.model.may_fold();
        let most = if closed { MOST.1 } else { MOST.0 };
        let usable = |i: &usize| c.points[*i].point.amplitude > 0.0 && c.points[*i].point.drive > 0.0;
        let usable: Vec<usize> = (0..c.points.len()).filter(usable).collect();
        let stride = usable.len().div_ceil(most).max(1);
        let numbers: Vec<usize> = usable.into_iter().step_by(stride).collect();
        let points: Vec<&Point> = numbers.iter().map(|i| &c.points[*i].point).collect();
        let first = points.first().map(|p| Lumps::new(&model, &operation(p)));
        let (units, rig) = first.map_or(([1.0; 2], [1.0; 2]), |l| {
            let (k, m, c) = (l.stiffness.value, l.inertia.value, l.damping.value);
            let w0 = (k / m).sqrt();
            let least = c.max(f64::EPSILON * m * w0);
            ([least * w0, least], [k, c])
        });
        Self { model, index, points, numbers, nuisance, calibrated, units, rig }
    }

    /// Whether the model has derivatives that are worth their time.
    pub fn solvable(&self) -> bool {
        !self.model.has_sliders()
            && (!self.model.has_contact || self.model.contact.formulation == crate::scenario::Formulation::Series)
    }

    /// ln of the measured amplitude of the coordinate's motion; of a motion in space without a phase that of the
    /// reading.
    pub fn measured_motion(&self) -> Vec<f64> {
        let of = |p: &&Point| {
            let lumps = Lumps::new(&self.model, &operation(p));
            let motion = p.phase.map(|phase| lumps.motion((p.amplitude, phase)).norm());
            motion.unwrap_or(p.amplitude / lumps.amplitude_gain.value).ln()
        };
        self.points.iter().map(of).collect()
    }

    /// The model at these readings, those of the numbers `which`, with a stiffness and damping in [`Self::units`] for
    /// each.
    pub fn solve(&self, which: &[usize], values: &[f64], force: &[[f64; 2]]) -> Vec<Option<Response>> {
        let mut model = self.model.clone();
        for (p, value) in self.nuisance.iter().zip(values) {
            // The operating point is none of what a fit moves.
            let mut none = Operation { speed: 0.0, load: 0.0, drive: 0.0, frequency: 0.0, series: 0 };
            if let Some(slot) = model.parameter(&mut none, p.index) {
                *slot = *value;
            }
        }
        let solve = |(&i, force): (&usize, &[f64; 2])| self.one(&model, self.points[i], values, *force);
        which.par_iter().zip(force).map(solve).collect()
    }

    fn one(&self, model: &Model, point: &Point, values: &[f64], force: [f64; 2]) -> Option<Response> {
        let mut model = model.clone();
        let own = &mut model.effects.last_mut()?.1;
        own.copy_from_slice(&[force[0] * self.units[0], force[1] * self.units[1]]);
        let at = operation(point);
        let mut warm = Warm::default();
        warm.expect(point.amplitude, point.phase);
        let solution = solve_steady(&model, &at, &Tolerance::FIT, true, &mut warm);
        let (state, all) = (solution.state, solution.derivatives?);
        let finite = state.amplitude > 0.0 && state.amplitude.is_finite() && state.phase.is_finite();
        if state.status != Status::Steady || !finite {
            return None;
        }
        let lumps = Lumps::new(&model, &at);
        let (gain, offset) = (lumps.amplitude_gain, lumps.phase_offset);
        let x = lumps.motion((state.amplitude, state.phase));
        let read = Complex::from_polar(state.amplitude / gain.value, state.phase - offset.value);
        let by = |index: usize, per: f64| {
            let (amplitude, phase) = (all[index].0 / state.amplitude, all[index].1);
            let of_motion =
                Complex::new(amplitude - gain.gradient[index] / gain.value, phase - offset.gradient[index]) * read;
            let beside = lumps.read_beside.as_deref();
            let beside = beside.map_or(Complex::ZERO, |(re, im)| Complex::new(re.gradient[index], im.gradient[index]));
            let motion = (x.conj() * (of_motion - beside)).re / x.norm_sqr();
            [amplitude * per, phase * per, motion * per]
        };
        let mut derivatives = vec![by(self.index, self.units[0]), by(self.index + 1, self.units[1])];
        let natural = self.nuisance.iter().zip(values).map(|(p, value)| by(p.index, p.natural_slope(*value)));
        derivatives.extend(natural);
        let response =
            Response { amplitude: state.amplitude.ln(), phase: state.phase, motion: x.norm().ln(), by: derivatives };
        response.by.iter().flatten().all(|d| d.is_finite()).then_some(response)
    }

    /// Residuals of amplitude and, where measured, phase in standard deviations: of small ones those of a comparison.
    /// Where the model has no steady state they are as large as those count.
    pub fn residuals(&self, index: usize, predicted: Option<(f64, f64)>) -> (f64, Option<f64>) {
        let point = self.points[index];
        let Some((amplitude, phase)) = predicted else { return (TROUBLED, point.phase.map(|_| TROUBLED)) };
        let relative = point.amplitude_sd / point.amplitude;
        let of_phase = point.phase.zip(point.phase_sd).map(|(measured, sd)| wrap(phase - measured) / sd);
        ((amplitude - point.amplitude.ln()) / relative, of_phase)
    }
}
