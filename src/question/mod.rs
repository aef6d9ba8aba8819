//! Which effects of the catalogue can make the curve of a sweep look like one of the model itself at another speed, and
//! how far their parameters have to be strained for it.
//!
//! Everything here is simulated, the curve to be resembled too. What comes out are hypotheses that a measurement could
//! decide between; none is a finding.

mod deciding;
mod features;
mod json;
mod search;
mod words;

pub use deciding::{Deciding, MOST as MOST_RIVALS, Prediction};
pub use features::{CLEARLY, Features};
pub use json::{QuestionJson, SCHEMA, json, table};
pub use words::{Criterion, close, condition, criteria, lines, otherwise, parameters, why_not};

use crate::compare::Peak;
use crate::discover::{Addition, compatible};
use crate::effects::Effect;
use crate::measurement::Point;
use crate::model::Model;
use crate::scenario::DEFAULT_EULER_STEPS;
use crate::scenario::{Formulation, Question, Scenario};
use crate::solver::SteadyState;
use crate::solver::cycle::Tolerance;
use crate::sweep::{Condition, Curve, LimitingCase, curve, limiting_oscillator};
use features::Judge;
use rayon::prelude::*;

/// Other tolerances that are tried, relative to that of the question.
const OTHERWISE: [f64; 3] = [0.5, 0.75, 1.25];

/// An effect at certain values of its parameters.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Its parameters in SI, in the order of the registry.
    pub values: Vec<f64>,
    /// Largest distance of one of them from the middle of its range in the catalogue (logarithms): 0 there, 1 at the
    /// edge, more outside.
    pub strain: f64,
    /// The curve at the condition of the sweep.
    pub curve: Curve,
    /// What the curve has of the one to be resembled.
    pub features: Features,
}

/// An effect and what it can do.
#[derive(Clone)]
pub struct Hypothesis {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Where its curve comes closest, with all features where it can have them.
    pub best: Setting,
    /// Where it is strained least among those that still have all features; `None` where it cannot have them.
    pub mildest: Option<Setting>,
    /// Whether it changes nothing that could be seen.
    pub idle: bool,
}

impl Hypothesis {
    /// Whether it can have all features.
    pub fn can(&self) -> bool {
        self.mildest.is_some()
    }

    /// The setting by which it is ranked.
    pub fn shown(&self) -> &Setting {
        self.mildest.as_ref().unwrap_or(&self.best)
    }

    /// The model with the effect at a setting of it.
    pub fn model(&self, base: &Model, setting: &Setting) -> Model {
        let mut model = base.clone();
        model.effects.push((self.effect, setting.values.clone()));
        model
    }
}

/// The effects that can with another tolerance.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Otherwise {
    /// That tolerance \[-\].
    pub tolerance: f64,
    /// Their names, in the order of the catalogue.
    pub able: Vec<&'static str>,
}

/// The answer to the question of a scenario.
#[derive(Clone)]
// Wide: every reader of an answer takes some of these, and none a group of them.
pub struct Answer {
    /// The scenario.
    pub scenario: Scenario,
    /// Its question.
    pub question: Question,
    /// Where the effects are tried.
    pub condition: Condition,
    /// The curve to be resembled: the model itself at another speed.
    pub target: Curve,
    /// Case I/III, full slip, in closed form \[rad\].
    pub full_slip: Vec<f64>,
    /// Case II, static contact, in closed form \[rad\].
    pub static_contact: Vec<f64>,
    /// The peak of full slip.
    pub slip_peak: Peak,
    /// Root mean square of the relative differences of full slip, which is what the model gives without any effect at
    /// high speeds, from the curve to be resembled \[-\].
    pub rms_of_full_slip: f64,
    /// The features of the curve to be resembled itself.
    pub described: Features,
    /// Every effect: those that can by strain, then those that cannot by their error.
    pub hypotheses: Vec<Hypothesis>,
    /// Which can with another tolerance, where that leaves the curve to be resembled itself clearly lower.
    pub otherwise: Vec<Otherwise>,
    /// The reading that tells the leading ones apart; `None` where fewer than two can.
    pub deciding: Option<Deciding>,
}

impl Answer {
    /// Step of the frequencies \[Hz\]: a peak is further right from so much on.
    pub fn step_hz(&self) -> f64 {
        let frequency = &self.target.frequency;
        (frequency[frequency.len() - 1] - frequency[0]) / (frequency.len() - 1) as f64
    }

    /// The effects that can, the least strained first.
    pub fn able(&self) -> impl Iterator<Item = &Hypothesis> {
        self.hypotheses.iter().filter(|hypothesis| hypothesis.can())
    }
}

/// Answers the question of a scenario; `None` where it asks none, or where its curves have no peak. The result does not
/// depend on the number of threads.
pub fn answer(scenario: &Scenario) -> Option<Answer> {
    let (question, sweep) = (scenario.question?, scenario.sweep.as_ref()?);
    let base = Model::new(scenario);
    let condition = Condition {
        formulation: Formulation::Series,
        euler_steps: DEFAULT_EULER_STEPS,
        drive: *sweep.drive.first()?,
        load: *sweep.load.first()?,
        friction: *sweep.friction.first()?,
        speed: *sweep.speed.first()?,
        series: 0,
    };
    let base = crate::sweep::at_condition(&base, &condition);
    let target =
        curve(&base, &Condition { speed: question.resembles, ..condition }, &sweep.frequency, &Tolerance::default());
    let limit = |case: LimitingCase| -> Vec<f64> {
        let oscillator = limiting_oscillator(&base, case, condition.drive);
        sweep.frequency.iter().map(|f| base.instrument.amplitude_gain * oscillator.response(*f).0).collect()
    };
    let full_slip = limit(LimitingCase::FreeOrFullSlip);
    let judge = Judge::new(&sweep.frequency, &full_slip, &amplitudes(&target), question.tolerance)?;
    let points = points(&condition, &target, question.tolerance);
    let described = judge.judge(&target);
    let others: Vec<Judge> = OTHERWISE.iter().map(|share| judge.within(share * question.tolerance)).collect();
    let others: Vec<Judge> = others.into_iter().filter(|other| other.judge(&target).all()).collect();
    let searched: Vec<(Hypothesis, Vec<bool>)> = base
        .catalogue()
        .collect::<Vec<_>>()
        .par_iter()
        .filter(|effect| compatible(&base, &[Addition::Effect(**effect)]))
        .filter(|effect| !base.effects.iter().any(|(present, _)| present.name() == effect.name()))
        .map(|effect| search::search(&base, *effect, &condition, &points, (&judge, &others)))
        .collect();
    let able_at = |index: usize| searched.iter().filter(move |(_, able)| able[index]).map(|(h, _)| h.effect.name());
    let otherwise = others.iter().enumerate();
    let otherwise: Vec<Otherwise> =
        otherwise.map(|(i, other)| Otherwise { tolerance: other.most(), able: able_at(i).collect() }).collect();
    let hypotheses = ranked(searched.into_iter().map(|(hypothesis, _)| hypothesis).collect());
    let deciding = deciding::deciding(&base, &condition, &sweep.frequency, &hypotheses);
    let static_contact = limit(LimitingCase::StaticContact);
    let (slip_peak, rms_of_full_slip) = (judge.slip_peak, judge.rms_of_full_slip());
    let scenario = scenario.clone();
    let answer = Answer {
        scenario,
        question,
        condition,
        target,
        full_slip,
        static_contact,
        slip_peak,
        rms_of_full_slip,
        described,
        hypotheses,
        otherwise,
        deciding,
    };
    Some(answer)
}

/// Those that can by strain, then those that cannot by their error.
fn ranked(mut hypotheses: Vec<Hypothesis>) -> Vec<Hypothesis> {
    hypotheses.sort_by(|a, b| {
        let key = |h: &Hypothesis| if h.can() { (0, h.shown().strain) } else { (1, h.best.features.rms) };
        let ((i, x), (j, y)) = (key(a), key(b));
        i.cmp(&j).then(x.total_cmp(&y)).then(a.effect.name().cmp(b.effect.name()))
    });
    hypotheses
}

fn amplitudes(curve: &Curve) -> Vec<f64> {
    curve.states.iter().map(|state: &SteadyState| state.amplitude).collect()
}

/// The curve to be resembled as points at the condition of the sweep, their standard deviation the tolerance.
fn points(condition: &Condition, target: &Curve, tolerance: f64) -> Vec<Point> {
    let point = |(index, (&frequency, state)): (usize, (&f64, &SteadyState))| Point {
        row: index + 1,
        line: 0,
        speed: condition.speed,
        load: condition.load,
        drive: condition.drive,
        frequency,
        amplitude: state.amplitude,
        phase: None,
        amplitude_sd: tolerance * state.amplitude,
        phase_sd: None,
        mean: None,
        replicates: 1,
        series: 0,
    };
    target.frequency.iter().zip(&target.states).enumerate().map(point).collect()
}
