//! The trials one after the other; what a trial computes runs on all threads.

use super::answer::{Answer, Draws, open, seal};
use super::cause::{Cause, Kind};
use super::conditions::Bench;
use super::draw::{Planted, draw, stream};
use super::examine::examine;
use super::generate::{Reading, readings};
use super::record::Record;
use super::score::score;
use super::visible::{excess, noiseless};
use super::{DRAWS, Options, VISIBLE, program, table};
use crate::discover;
use crate::error::Result;
use crate::fit::Problem;
use crate::model::Model;
use crate::results::Results;
use crate::solver::Status;
use crate::solver::cycle::Tolerance;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

/// Larger tables are screened at every third point.
const SCREENED: usize = 100;

/// Name of a trial; also of its folder.
pub fn id(cause: &Cause, seed: u32, noise: f64) -> String {
    format!("{}-{seed}-{noise}", cause.name())
}

/// Runs every trial that has no kept result, telling `done` after each how many are finished, and the trial's name.
///
/// # Errors
/// Whatever reading and writing files reports.
pub fn run(bench: &Bench, options: &Options, done: &dyn Fn(&Record, bool)) -> Result<Vec<Record>> {
    let mut records = Vec::new();
    let build = build();
    let results = Results::open(&options.out, options.inputs.iter().map(PathBuf::as_path))?;
    for seed in options.seed..options.seed + options.seeds {
        for cause in options.causes.iter().filter(|cause| seed - options.seed < options.draws_of(cause)) {
            for &noise in &options.noise {
                let inputs = inputs(bench, options, cause, seed, noise);
                let kept = Record::load(&options.out, &id(cause, seed, noise), &inputs, &program());
                let fresh = kept.is_none();
                let record = match kept {
                    Some(record) => record,
                    None => single(bench, options, &results, (cause, seed, noise), &build)?,
                };
                done(&record, fresh);
                records.push(record);
            }
        }
    }
    Ok(records)
}

/// Everything that decides the result of a trial, hashed.
fn inputs(bench: &Bench, options: &Options, cause: &Cause, seed: u32, noise: f64) -> String {
    let text = format!(
        "{} {} {seed} {noise} {} {} {} {VISIBLE} {DRAWS}",
        bench.hash(),
        cause.name(),
        options.outliers,
        options.phase,
        options.search.max_effects
    );
    // A search by default has the hash that it had before others could be asked for.
    let usual =
        discover::SearchOptions { max_effects: options.search.max_effects, ..discover::SearchOptions::default() };
    let (own, usual) = (format!("{:?}", options.search), format!("{usual:?}"));
    let text = if own == usual { text } else { text + &own };
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

/// The first digits of the hash of the running program; empty where it cannot be read.
fn build() -> String {
    let bytes = std::env::current_exe().ok().and_then(|path| std::fs::read(path).ok());
    bytes.map_or_else(String::new, |bytes| blake3::hash(&bytes).to_hex()[..16].to_string())
}

/// One trial from the draw to the score.
///
/// # Errors
/// Whatever reading and writing files reports.
pub fn single(
    bench: &Bench,
    options: &Options,
    results: &Results,
    (cause, seed, noise): (&Cause, u32, f64),
    build: &str,
) -> Result<Record> {
    let start = Instant::now();
    let name = id(cause, seed, noise);
    // Nothing of what was planted outlives this block but what is sealed.
    let (closed, table) = {
        let (answer, planted) = plant(bench, options, cause, seed, noise);
        let table = planted.map(|readings| write(bench, options, results, &readings, noise, &name)).transpose()?;
        (seal(results, &answer)?, table)
    };
    let planting_seconds = start.elapsed().as_secs_f64();
    let found = table.is_some().then(|| examine(&results.path().join(&name), &options.search)).transpose()?;
    let answer = open(&closed)?;
    let score = found.as_ref().map(|found| score(&answer, found));
    let record = Record {
        id: name,
        inputs: inputs(bench, options, cause, seed, noise),
        program: program(),
        build: build.into(),
        table,
        sealed: closed.hash,
        answer,
        found,
        score,
        planting_seconds,
    };
    record.save(results)?;
    Ok(record)
}

/// Writes what the search reads; the hash of the table.
fn write(
    bench: &Bench,
    options: &Options,
    results: &Results,
    readings: &[Reading],
    noise: f64,
    name: &str,
) -> Result<String> {
    let text = table::table(bench, readings, noise, options.outliers, options.phase, name);
    results.write(&format!("{name}/scenario.toml"), table::scenario(bench).as_bytes())?;
    results.write(&format!("{name}/measurements.csv"), text.as_bytes())?;
    Ok(blake3::hash(text.as_bytes()).to_hex().to_string())
}

/// Draws until the data could show the cause and the motion is steady everywhere; the readings without noise of the
/// draw that was kept, or none.
pub fn plant(bench: &Bench, options: &Options, cause: &Cause, seed: u32, noise: f64) -> (Answer, Option<Vec<Reading>>) {
    let mut rng = stream(&["draw", &cause.name(), &seed.to_string()]);
    let mut draws = Draws::default();
    let mut kept: Option<(Planted, Vec<Reading>, f64)> = None;
    for _ in 0..DRAWS {
        let planted = draw(cause, &bench.model, &mut rng);
        if let Some(unsteady) = hopeless(bench, &planted, noise, options.phase) {
            *(if unsteady { &mut draws.unsteady } else { &mut draws.invisible }) += 1;
            continue;
        }
        let readings = readings(&planted, &bench.operations);
        if readings.iter().any(|r| !r.steady) {
            draws.unsteady += 1;
            continue;
        }
        let excess = excess(bench, &readings, noise, options.phase);
        if cause.kind() != Kind::None && excess < VISIBLE - 1.0 {
            draws.invisible += 1;
            continue;
        }
        draws.kept = true;
        kept = Some((planted, readings, excess));
        break;
    }
    let answer = Answer {
        id: id(cause, seed, noise),
        cause: cause.name(),
        kind: cause.kind(),
        effects: match cause {
            Cause::Effects(effects) => effects.iter().map(|e| e.name().into()).collect(),
            _ => Vec::new(),
        },
        recalibrate: match cause {
            Cause::Recalibration(key) => Some((*key).into()),
            _ => None,
        },
        noise,
        seed,
        excess: kept.as_ref().map_or(0.0, |k| k.2),
        parameters: kept.as_ref().map_or_else(BTreeMap::new, |k| k.0.parameters.clone()),
        draws,
    };
    (answer, kept.map(|(_, readings, _)| readings))
}

/// Whether a draw is not worth the time integration, by the fast solver at a part of the points: `Some(true)` where the
/// motion is not steady somewhere, `Some(false)` where a planted effect, alone, would hardly show.
fn hopeless(bench: &Bench, planted: &Planted, noise: f64, phase: bool) -> Option<bool> {
    if planted.outside.is_some() || planted.model.effects.is_empty() {
        return None;
    }
    let stride = if bench.operations.len() > SCREENED { 3 } else { 1 };
    let bench = &Bench {
        operations: bench.operations.iter().step_by(stride).copied().collect(),
        model: bench.model.clone(),
        free: bench.free.clone(),
    };
    let quick = |model: &Model| {
        let blank = vec![Reading { amplitude: 1.0, phase: 0.0, steady: true }; bench.operations.len()];
        let points = noiseless(bench, &blank, noise, phase);
        let mut problem = Problem::new(model.clone(), &points, Vec::new(), Tolerance::COARSE);
        let predictions = problem.evaluate(&[], false).predictions;
        let reading = |p: &crate::fit::Prediction| Reading {
            amplitude: p.amplitude,
            phase: p.phase,
            steady: p.status == Status::Steady,
        };
        predictions.iter().map(reading).collect::<Vec<_>>()
    };
    let together = quick(&planted.model);
    if together.iter().any(|r| !r.steady) {
        return Some(true);
    }
    let shows = |readings: &[Reading]| {
        readings.iter().all(|r| r.steady && r.amplitude > 0.0)
            && excess(bench, readings, noise, phase) > 0.9 * (VISIBLE - 1.0)
    };
    let alone = planted.model.effects.len() == 1;
    let each = planted.model.effects.iter().all(|effect| {
        let mut model = planted.model.clone();
        model.effects = vec![effect.clone()];
        if alone { shows(&together) } else { shows(&quick(&model)) }
    });
    (!each).then_some(false)
}
