//! Prints as JSON the time and the error of one steady state, for `benches/peers`: the base law at the points that the
//! peers solve (times are the smallest of several batch means), and with `--effects` every effect against the reference
//! table (the effects in turn, the fastest of many rounds for each row). Times in seconds.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::paper_model;
use serde_json::{Value, json};
use std::hint::black_box;
use std::time::Instant;
use stickslip::effects::{ParameterInfo, find};
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;
use stickslip::solver::{Status, SteadyState, Warm, cycle::Tolerance, solve};

/// The reference table.
const TABLE: &str = include_str!("../tests/data/effects.csv");
/// Rounds over all rows of the table, of which the fastest counts for each row.
const ROUNDS: usize = 150;
/// Batches, of which the fastest counts, and the shortest time that a batch may take \[s\].
const BATCHES: (usize, f64) = (9, 4e-3);

fn main() {
    let model = paper_model(Series);
    let base: Vec<Value> = [60.0, 74.0, 82.0].map(|frequency| point(&model, &common::at(5e-5, frequency))).into();
    let mut report = json!({ "base": base });
    if std::env::args().any(|argument| argument == "--effects") {
        let (effects, times_base) = effects(&groups());
        report["effects"] = effects;
        report["times_base"] = times_base;
    }
    println!("{report:#}");
}

/// Time of one call, the smallest of several batch means.
fn seconds(mut work: impl FnMut()) -> f64 {
    work();
    let mut repeats = 1;
    let mut batch = |repeats: usize| {
        let began = Instant::now();
        (0..repeats).for_each(|_| work());
        began.elapsed().as_secs_f64()
    };
    while batch(repeats) < BATCHES.1 {
        repeats *= 2;
    }
    (0..BATCHES.0).map(|_| batch(repeats) / repeats as f64).fold(f64::INFINITY, f64::min)
}

fn steady(model: &Model, at: &Operation, derivatives: bool, warm: &mut Warm) -> SteadyState {
    solve(model, at, 20_000, &Tolerance::default(), derivatives, warm).state
}

/// One operating point of the base law: cold, from a neighbour 0.5 Hz away, and with all derivatives.
fn point(model: &Model, at: &Operation) -> Value {
    let state = steady(model, at, false, &mut Warm::default());
    let mut neighbour = Warm::default();
    steady(model, &Operation { frequency: at.frequency - 0.5, ..*at }, false, &mut neighbour);
    json!({
        "frequency": at.frequency,
        "amplitude": state.amplitude,
        "phase": state.phase,
        "cycles": state.cycles,
        "status": state.status.word(),
        "cold": seconds(|| _ = black_box(steady(model, at, false, &mut Warm::default()))),
        "warm": seconds(|| _ = black_box(steady(model, at, false, &mut neighbour.clone()))),
        "derivatives": seconds(|| _ = black_box(steady(model, at, true, &mut Warm::default()))),
    })
}

/// One row of the reference table.
struct Row {
    effect: &'static str,
    settings: &'static str,
    at: Operation,
    amplitude: f64,
    phase: f64,
}

/// The rows of the table by effect and condition, in its order.
fn groups() -> Vec<Vec<Row>> {
    let mut groups: Vec<Vec<Row>> = Vec::new();
    for line in TABLE.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let v: Vec<f64> = fields[2..8].iter().map(|v| v.parse().expect("a number")).collect();
        let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3], series: 0 };
        let row = Row { effect: fields[0], settings: fields[1], at, amplitude: v[4], phase: v[5] };
        match groups.last_mut() {
            Some(rows) if rows[0].same_curve(&row) => rows.push(row),
            _ => groups.push(vec![row]),
        }
    }
    groups
}

impl Row {
    fn same_curve(&self, other: &Self) -> bool {
        (self.effect, self.at.speed, self.at.load) == (other.effect, other.at.speed, other.at.load)
    }

    fn model(&self) -> Model {
        let mut model = paper_model(Series);
        if let Some(effect) = find(self.effect) {
            let value = |info: &ParameterInfo| {
                let pair = self.settings.split(' ').find_map(|pair| pair.strip_prefix(info.key)?.strip_prefix('='));
                pair.and_then(|value| value.parse().ok()).expect("a value")
            };
            model.effects.push((effect, effect.parameters().iter().map(value).collect()));
        }
        model
    }
}

/// Fastest time of every row of every group, the rows of all groups in turn.
fn fastest(groups: &[Vec<Row>], derivatives: bool) -> Vec<Vec<f64>> {
    let models: Vec<Model> = groups.iter().map(|rows| rows[0].model()).collect();
    let mut best: Vec<Vec<f64>> = groups.iter().map(|rows| vec![f64::INFINITY; rows.len()]).collect();
    for _ in 0..ROUNDS {
        for ((rows, model), best) in groups.iter().zip(&models).zip(&mut best) {
            // Its derivatives are differences by every parameter.
            if derivatives && rows[0].effect == "partial-slip" {
                continue;
            }
            for (row, best) in rows.iter().zip(best) {
                let began = Instant::now();
                black_box(steady(model, &row.at, derivatives, &mut Warm::default()));
                *best = best.min(began.elapsed().as_secs_f64());
            }
        }
    }
    best
}

/// Mean times over the rows of each effect at each condition, and its largest errors; and over all conditions of an
/// effect how many times the base law takes its time there.
fn effects(groups: &[Vec<Row>]) -> (Value, Value) {
    let mean = |times: &[f64]| times.iter().sum::<f64>() / times.len() as f64;
    let cold: Vec<f64> = fastest(groups, false).iter().map(|times| mean(times)).collect();
    let with_derivatives: Vec<f64> = fastest(groups, true).iter().map(|times| mean(times)).collect();
    let base = |of: &Row| {
        let same = |rows: &Vec<Row>| {
            rows[0].effect == "none" && (rows[0].at.speed, rows[0].at.load) == (of.at.speed, of.at.load)
        };
        groups.iter().position(same).map(|index| cold[index])
    };
    let mut sums: Vec<(&str, f64, f64)> = Vec::new();
    let mut report = Vec::new();
    for ((rows, &cold), &derivatives) in groups.iter().zip(&cold).zip(&with_derivatives) {
        let base = base(&rows[0]);
        if let Some(base) = base {
            match sums.iter_mut().find(|(effect, ..)| *effect == rows[0].effect) {
                Some((_, own, of_base)) => (*own, *of_base) = (*own + cold, *of_base + base),
                None => sums.push((rows[0].effect, cold, base)),
            }
        }
        report.push(group(rows, cold, derivatives, base));
    }
    let times_base = sums.iter().map(|(effect, own, base)| (effect.to_string(), json!(own / base))).collect();
    (report.into(), Value::Object(times_base))
}

/// One effect at one condition.
fn group(rows: &[Row], cold: f64, derivatives: f64, base: Option<f64>) -> Value {
    let model = rows[0].model();
    let (mut amplitude, mut phase) = (0.0f64, 0.0f64);
    let (mut cycles, mut steady_rows) = (0, 0);
    for row in rows {
        let state = steady(&model, &row.at, false, &mut Warm::default());
        amplitude = amplitude.max((state.amplitude / row.amplitude - 1.0).abs());
        phase = phase.max((state.phase - row.phase).abs());
        cycles += state.cycles;
        steady_rows += usize::from(state.status == Status::Steady);
    }
    json!({
        "effect": rows[0].effect,
        "speed": rows[0].at.speed,
        "load": rows[0].at.load,
        "rows": rows.len(),
        "steady_rows": steady_rows,
        "cycles": cycles as f64 / rows.len() as f64,
        "amplitude_error": amplitude,
        "phase_error": phase,
        "cold": cold,
        "times_base": base.map(|base| cold / base),
        "derivatives": derivatives.is_finite().then_some(derivatives),
    })
}
