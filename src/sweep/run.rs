//! Running the product of the axes on all threads.

use super::{Condition, Curve, LimitCurve, LimitingCase, Outcome};
use crate::model::lumps::Lumps;
use crate::model::{Model, Operation};
use crate::scenario::{Formulation, Scenario};
use crate::solver::analytic::Oscillator;
use crate::solver::cycle::Tolerance;
use crate::solver::{LANES, Orbit, Status, SteadyState, Warm, orbit, solve, solve_paper, solve_steady};
use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use std::time::Instant;

/// Points solved one after the other, each starting from its neighbour; the unit of parallel work.
const CHUNK: usize = 26;
/// Samples of an orbit.
const ORBIT_SAMPLES: usize = 2000;
/// Relative difference in amplitude from which on two states at one frequency are two.
const DIFFERENT: f64 = 1e-4;
/// Points of a closed-form curve.
const LIMIT_POINTS: usize = 401;

/// How to run a sweep.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    /// Keep one period of every point.
    pub orbits: bool,
    /// Show progress on standard error if that is a terminal.
    pub progress: bool,
}

/// Conditions of a scenario's sweep, in the order of the axes.
pub fn conditions(scenario: &Scenario) -> Vec<Condition> {
    let Some(sweep) = &scenario.sweep else { return Vec::new() };
    let mut all = Vec::new();
    for &formulation in &sweep.formulation {
        // Only the Euler procedure has a step size.
        let steps = if formulation == Formulation::Paper { &sweep.euler_steps[..] } else { &sweep.euler_steps[..1] };
        for &euler_steps in steps {
            for &drive in &sweep.drive {
                for &load in &sweep.load {
                    for &friction in &sweep.friction {
                        for &speed in &sweep.speed {
                            all.push(Condition { formulation, euler_steps, drive, load, friction, speed, series: 0 });
                        }
                    }
                }
            }
        }
    }
    all
}

/// Solves every point of the scenario's sweep. The result does not depend on the number of threads.
pub fn run(scenario: &Scenario, options: &Options) -> Outcome {
    let began = Instant::now();
    let model = Model::new(scenario);
    let conditions = conditions(scenario);
    let frequency = scenario.sweep.as_ref().map_or(&[][..], |sweep| &sweep.frequency);
    let bar = progress_bar(options, conditions.len() * frequency.len(), &scenario.id);
    // An arm with several steady states is followed through the whole range, up and down.
    let folds = model.may_fold();
    let chunk = if folds { frequency.len().max(1) } else { CHUNK };
    let tasks: Vec<(&Condition, &[f64])> =
        conditions.iter().flat_map(|c| frequency.chunks(chunk).map(move |part| (c, part))).collect();
    let solved: Vec<Part> = tasks
        .par_iter()
        .map(|(condition, frequencies)| {
            let follow = Follow { model: at_condition(&model, condition), condition, bar: &bar };
            let states = follow.solve(frequencies.iter().copied());
            let down = if folds { follow.other_branch(frequencies, &states) } else { Vec::new() };
            let orbits = if options.orbits { follow.orbits(frequencies) } else { Vec::new() };
            Part { states, down, orbits }
        })
        .collect();
    bar.finish_and_clear();
    let mut parts = solved.into_iter();
    let per_curve = frequency.len().div_ceil(chunk);
    let curves = conditions
        .iter()
        .map(|&condition| {
            let mut curve = Curve {
                condition,
                frequency: frequency.to_vec(),
                states: Vec::new(),
                down: Vec::new(),
                orbits: Vec::new(),
            };
            for part in parts.by_ref().take(per_curve) {
                curve.states.extend(part.states);
                curve.down.extend(part.down);
                curve.orbits.extend(part.orbits);
            }
            curve
        })
        .collect();
    let limits = limits(&model, scenario);
    Outcome { scenario: scenario.clone(), curves, limits, seconds: began.elapsed().as_secs_f64() }
}

/// The periodic states of one condition on the calling thread, each starting from its neighbour.
///
/// Points without one fail, and so do all that follow two of them in a row: the search is long where there is nothing.
pub fn curve(model: &Model, condition: &Condition, frequency: &[f64], tolerance: &Tolerance) -> Curve {
    let points: Vec<(f64, f64)> = frequency.iter().map(|f| (*f, condition.drive)).collect();
    driven_curve(model, condition, &points, tolerance)
}

/// The same at every frequency with the drive beside it; what gives up at this tolerance is solved at the default one.
pub fn driven_curve(model: &Model, condition: &Condition, points: &[(f64, f64)], tolerance: &Tolerance) -> Curve {
    let model = at_condition(model, condition);
    let mut warm = Warm::default();
    let mut states: Vec<SteadyState> = Vec::with_capacity(points.len());
    for &(f, drive) in points {
        let lost = |state: &SteadyState| matches!(state.status, Status::Failed(_));
        let at = Operation { drive, ..operation(condition, f) };
        let state = match states.as_slice() {
            [.., before, last] if lost(before) && lost(last) => last.clone(),
            _ => {
                let state = solve_steady(&model, &at, tolerance, false, &mut warm).state;
                // What gives up early has not shown that there is none.
                let is_whole = *tolerance == Tolerance::default();
                if is_whole || !lost(&state) {
                    state
                } else {
                    solve_steady(&model, &at, &Tolerance::default(), false, &mut Warm::default()).state
                }
            }
        };
        states.push(state);
    }
    let frequency = points.iter().map(|point| point.0).collect();
    Curve { condition: *condition, frequency, states, down: Vec::new(), orbits: Vec::new() }
}

fn operation(condition: &Condition, frequency: f64) -> Operation {
    Operation {
        speed: condition.speed,
        load: condition.load,
        drive: condition.drive,
        frequency,
        series: condition.series,
    }
}

/// A stretch of a curve.
struct Part {
    states: Vec<SteadyState>,
    down: Vec<Option<SteadyState>>,
    orbits: Vec<Orbit>,
}

/// Solves frequencies one after the other, each starting from its neighbour.
struct Follow<'a> {
    model: Model,
    condition: &'a Condition,
    bar: &'a ProgressBar,
}

impl Follow<'_> {
    fn at(&self, frequency: f64) -> Operation {
        operation(self.condition, frequency)
    }

    /// The states.
    fn solve(&self, frequencies: impl Iterator<Item = f64>) -> Vec<SteadyState> {
        let mut warm = Warm::default();
        let mut states = Vec::new();
        if self.model.contact.formulation == Formulation::Paper && self.condition.load > 0.0 {
            let at: Vec<Operation> = frequencies.map(|f| self.at(f)).collect();
            for lanes in at.chunks(LANES) {
                states.extend(solve_paper(&self.model, lanes, self.condition.euler_steps));
                self.bar.inc(lanes.len() as u64);
            }
            return states;
        }
        for f in frequencies {
            let (steps, tolerance) = (self.condition.euler_steps, Tolerance::default());
            states.push(solve(&self.model, &self.at(f), steps, &tolerance, false, &mut warm).state);
            self.bar.inc(1);
        }
        states
    }

    /// What sweeping downwards finds where it differs.
    fn other_branch(&self, frequencies: &[f64], up: &[SteadyState]) -> Vec<Option<SteadyState>> {
        self.bar.inc_length(frequencies.len() as u64);
        let mut down = self.solve(frequencies.iter().rev().copied());
        down.reverse();
        let differs = |a: &SteadyState, b: &SteadyState| (a.amplitude / b.amplitude - 1.0).abs() > DIFFERENT;
        down.into_iter().zip(up).map(|(down, up)| differs(&down, up).then_some(down)).collect()
    }

    fn orbits(&self, frequencies: &[f64]) -> Vec<Orbit> {
        let (steps, tolerance) = (self.condition.euler_steps, Tolerance::default());
        frequencies.iter().map(|&f| orbit(&self.model, &self.at(f), steps, &tolerance, ORBIT_SAMPLES)).collect()
    }
}

/// The model of a scenario in one condition.
pub fn at_condition(model: &Model, condition: &Condition) -> Model {
    let mut model = model.clone();
    model.contact.friction = condition.friction;
    model.contact.formulation = condition.formulation;
    model
}

fn progress_bar(options: &Options, points: usize, label: &str) -> ProgressBar {
    if !options.progress || !terminal::shows_progress() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(points as u64);
    let template = "{msg:24} {bar:30} {pos}/{len} points, {per_sec}, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(terminal::clean(label).into_owned());
    bar
}

/// The oscillator of a limiting case for one drive, of the paper's kind of rig.
pub fn limiting_oscillator(model: &Model, case: LimitingCase, drive: f64) -> Oscillator {
    let at = Operation { speed: 0.0, load: 0.0, drive, frequency: 1.0, series: 0 };
    let lumps = Lumps::new(model, &at);
    let rig = model.rig.arm();
    let b2 = rig.contact_arm.powi(2);
    let (kc, cc) = match case {
        LimitingCase::FreeOrFullSlip => (0.0, 0.0),
        LimitingCase::StaticContact => (model.contact.stiffness, model.contact.damping),
    };
    Oscillator {
        inertia: rig.inertia,
        damping: rig.torsional_damping + 2.0 * rig.spring_arm.powi(2) * rig.spring_damping + b2 * cc,
        stiffness: lumps.stiffness.value + b2 * kc,
        lever: rig.spring_arm * drive * model.instrument.drive_gain,
        spring_stiffness: rig.spring_stiffness,
        spring_damping: rig.spring_damping,
    }
}

fn limits(model: &Model, scenario: &Scenario) -> Vec<LimitCurve> {
    let Some(sweep) = scenario.sweep.as_ref().filter(|_| model.rig.is_arm()) else { return Vec::new() };
    let from = sweep.frequency.iter().copied().fold(f64::INFINITY, f64::min);
    let to = sweep.frequency.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut out = Vec::new();
    for &drive in &sweep.drive {
        for case in [LimitingCase::FreeOrFullSlip, LimitingCase::StaticContact] {
            out.push(limit_curve(&limiting_oscillator(model, case, drive), model, case, drive, from, to));
        }
    }
    out
}

fn limit_curve(o: &Oscillator, model: &Model, case: LimitingCase, drive: f64, from: f64, to: f64) -> LimitCurve {
    let gain = model.instrument.amplitude_gain;
    let b = model.rig.lever();
    let count = if to > from { LIMIT_POINTS } else { 1 };
    let frequency: Vec<f64> = (0..count).map(|i| from + (to - from) * i as f64 / (count.max(2) - 1) as f64).collect();
    let response: Vec<(f64, f64)> = frequency.iter().map(|&f| o.response(f)).collect();
    // The peaks are those of the case itself, wherever the sweep ends.
    let (low, high) = (0.2 * from.min(10.0), 5.0 * to.max(natural_frequency(o)));
    let (peak_frequency, peak) = o.peak(low, high, 0);
    let (speed_peak_frequency, speed_peak) = o.peak(low, high, 1);
    LimitCurve {
        case,
        drive,
        amplitude: response.iter().map(|r| gain * r.0).collect(),
        phase: response.iter().map(|r| crate::statistics::wrap(r.1 + model.instrument.phase_offset)).collect(),
        speed_amplitude: frequency.iter().zip(&response).map(|(f, r)| b * std::f64::consts::TAU * f * r.0).collect(),
        frequency,
        peak_frequency,
        peak_amplitude: gain * peak,
        speed_peak_frequency,
        speed_peak: b * speed_peak,
    }
}

fn natural_frequency(o: &Oscillator) -> f64 {
    (o.stiffness / o.inertia).sqrt() / std::f64::consts::TAU
}
