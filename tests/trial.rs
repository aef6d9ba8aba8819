//! The program's examination of itself: generators, reproducibility, sealed answers, resumption.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use stickslip::discover;
use stickslip::figures;
use stickslip::model::Operation;
use stickslip::scenario;
use stickslip::solver::integrated;
use stickslip::solver::time::Plan;
use stickslip::trial::outside::{self, OUTSIDE, reading};
use stickslip::trial::{self, Bench, Cause, Options};

const SMALL: &str = r#"
title = "Small"
[rig]
inertia = 0.005
torsional_stiffness = 990
torsional_damping = 0.43
spring_stiffness = 16000
spring_damping = 12
spring_arm = 0.03
contact_arm = 0.06
[contact]
stiffness = 89000
damping = 26
friction = 0.5
[sweep]
frequency = { from = "60 Hz", to = "88 Hz", points = 8 }
speed = ["0 mm/s", "0.1 mm/s", "20 mm/s"]
load = "20 N"
drive = "2.5 um"
"#;

fn small(folder: &Path) -> Bench {
    let path = folder.join("small.toml");
    std::fs::write(&path, SMALL).unwrap();
    Bench::of(&scenario::load(&path).unwrap()).unwrap()
}

fn options(causes: &[&str], out: PathBuf) -> Options {
    Options {
        causes: trial::causes(causes).unwrap(),
        fewer: BTreeMap::new(),
        seed: 3,
        seeds: 1,
        noise: vec![0.01],
        outliers: 0.0,
        phase: true,
        search: discover::SearchOptions { max_effects: 1, ..discover::SearchOptions::default() },
        out,
        inputs: Vec::new(),
    }
}

fn at(speed: f64, load: f64, frequency: f64) -> Operation {
    Operation { speed, load, drive: 2.5e-6, frequency, series: 0 }
}

/// Rest, partial stick, full slip, slip both ways at a low load.
fn regimes() -> [Operation; 4] {
    [at(0.0, 20.0, 80.0), at(5e-5, 20.0, 74.0), at(0.02, 20.0, 70.0), Operation { drive: 7.5e-6, ..at(0.0, 0.1, 72.0) }]
}

fn plan(steps: usize) -> Plan {
    Plan { steps, cycles: 600, settled: 1e-8, window: 36, solved: Plan::SOLVED }
}

/// Relative difference of two readings as complex numbers.
fn difference(one: (f64, f64), other: (f64, f64)) -> f64 {
    let point = |(a, p): (f64, f64)| (a * p.cos(), a * p.sin());
    let ((a, b), (c, d)) = (point(one), point(other));
    (a - c).hypot(b - d) / other.0
}

#[test]
fn causes_outside_the_catalogue_vanish_at_zero_strength() {
    let model = trial::practice().model;
    for cause in OUTSIDE {
        for operation in regimes() {
            let mut p: Vec<f64> = cause.parameters().iter().map(|info| info.range.unwrap().0).collect();
            p[0] = 0.0;
            let departure = cause.departure(&p, &model, operation.speed, 5);
            let found = reading(&model, &departure, &operation, &plan(2000));
            let base = integrated(&model, &operation, &plan(4000));
            let difference = difference((found.amplitude, found.phase), (base.amplitude, base.phase));
            assert!(difference < 2e-4 && found.periodic, "{} at {operation:?}: {difference:e}", cause.name());
        }
    }
}

#[test]
fn causes_outside_the_catalogue_change_something_somewhere_and_are_no_effects() {
    let model = trial::practice().model;
    for cause in OUTSIDE {
        let strong: Vec<f64> = cause.parameters().iter().map(|info| info.range.unwrap().1).collect();
        let fast = at(0.1, 20.0, 76.0);
        let change = |operation: &Operation| {
            let departure = cause.departure(&strong, &model, operation.speed, 7);
            let found = reading(&model, &departure, operation, &plan(1000));
            let base = integrated(&model, operation, &plan(1000));
            difference((found.amplitude, found.phase), (base.amplitude, base.phase))
        };
        let largest = regimes().iter().chain([&fast]).map(change).fold(0.0, f64::max);
        assert!(largest > 0.02, "{}: {largest:e}", cause.name());
        assert!(stickslip::effects::find(cause.name()).is_none());
    }
}

#[test]
fn the_generators_converge() {
    let model = trial::practice().model;
    for cause in OUTSIDE {
        let middle = |info: &stickslip::effects::ParameterInfo| {
            let (low, high) = info.range.unwrap();
            (low * high).sqrt()
        };
        let p: Vec<f64> = cause.parameters().iter().map(middle).collect();
        for operation in [at(0.0, 20.0, 80.0), at(5e-5, 20.0, 74.0)] {
            let departure = cause.departure(&p, &model, operation.speed, 0);
            let run = |steps| {
                let found = reading(&model, &departure, &operation, &plan(steps));
                (found.amplitude, found.phase)
            };
            let fine = run(16_000);
            let [coarse, half] = [1000, 2000].map(|steps| difference(run(steps), fine));
            // Second order where nothing switches; at least first order, with a small error, where the contact does.
            let order = (coarse / half).log2();
            let smooth = operation.speed == 0.0 && cause.name() != "outside-backlash";
            assert!(coarse < 5e-4, "{} at {operation:?}: {coarse:e}", cause.name());
            let least = if smooth { 1.9 } else { 0.9 };
            assert!(order > least || half < 2e-5, "{} at {operation:?}: order {order}, {half:e}", cause.name());
        }
    }
}

#[test]
fn the_readings_of_an_effect_are_those_of_the_integrator() {
    let folder = tempfile::tempdir().unwrap();
    let bench = small(folder.path());
    let options = options(&["quadratic-damping"], folder.path().into());
    let (answer, readings) = trial::plant(&bench, &options, &options.causes[0], 3, 0.01);
    let readings = readings.unwrap();
    assert_eq!((answer.effects.len(), readings.len()), (1, 24));
    assert!(answer.excess > trial::VISIBLE - 1.0 && answer.draws.kept);
    let effect = stickslip::effects::find("quadratic-damping").unwrap();
    let mut model = bench.model.clone();
    model.contact.stiffness = answer.parameters["contact.stiffness"];
    model.contact.damping = answer.parameters["contact.damping"];
    model.effects.push((effect, vec![answer.parameters["effect.quadratic-damping.D_2"]]));
    for (operation, reading) in bench.operations.iter().zip(&readings).step_by(5) {
        let found = integrated(&model, operation, &plan(8000));
        let difference = difference((reading.amplitude, reading.phase), (found.amplitude, found.phase));
        assert!(difference < 3e-4, "{operation:?}: {difference:e}");
    }
}

#[test]
fn tables_are_the_same_bytes_whatever_the_threads_and_differ_by_seed() {
    let folder = tempfile::tempdir().unwrap();
    let bench = small(folder.path());
    let table = |threads: usize, seed: u32| {
        let pool = rayon_pool(threads);
        let out = folder.path().join(format!("{threads}-{seed}"));
        pool.install(|| {
            let options = options(&["maxwell-branch"], out.clone());
            let (answer, readings) = trial::plant(&bench, &options, &options.causes[0], seed, 0.01);
            trial::table_text(&bench, &readings.unwrap(), 0.01, 0.02, true, &answer.id)
        })
    };
    let (one, two, other) = (table(1, 3), table(2, 3), table(2, 4));
    assert_eq!(one, two);
    assert_ne!(one, other);
    assert_eq!(one.lines().count(), 25);
}

fn rayon_pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[test]
// Long: one trial, which takes long, is followed from its seal to its summary.
fn trials_are_sealed_scored_kept_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let bench = small(folder.path());
    let mut options = options(&["none", "quadratic-damping"], folder.path().join("out"));
    let fresh = std::cell::RefCell::new(Vec::new());
    let run = |options: &Options| {
        fresh.borrow_mut().clear();
        let done = |_: &trial::Record, new: bool| fresh.borrow_mut().push(new);
        trial::run(&bench, options, &done).unwrap()
    };
    // Interrupted after the first.
    let all = std::mem::take(&mut options.causes);
    options.causes = vec![all[0].clone()];
    let first = run(&options);
    options.causes = all;
    let records = run(&options);
    assert_eq!(*fresh.borrow(), [false, true]);
    assert_eq!(first[0], records[0]);
    let (none, damping) = (&records[0], &records[1]);
    let id = &damping.id;
    assert_eq!(id, "quadratic-damping-3-0.01");

    // The files hold no word of the answer, and the search needs none.
    let trial = options.out.join(id);
    let names: Vec<_> = std::fs::read_dir(&trial).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
    let text = std::fs::read_to_string(trial.join("scenario.toml")).unwrap();
    assert!(!text.contains("damping-3") && !text.contains("quadratic"), "{text}");
    let answers = options.out.join("answers");
    let sealed = std::fs::read(answers.join(format!("{id}.json"))).unwrap();
    std::fs::remove_dir_all(&answers).unwrap();
    let settings = discover::SearchOptions { max_effects: 1, ..discover::SearchOptions::default() };
    let again = trial::examine(&trial, &settings).unwrap();
    let found = damping.found.as_ref().unwrap();
    assert_eq!(
        (&again.verdict, &again.effects, &again.parameters),
        (&found.verdict, &found.effects, &found.parameters)
    );
    assert_eq!(blake3::hash(&sealed).to_hex().to_string(), damping.sealed);

    // An answer that was changed is not opened.
    let results = stickslip::results::Results::open(&options.out, []).unwrap();
    let seal = trial::seal(&results, &damping.answer).unwrap();
    drop(results);
    std::fs::write(answers.join(format!("{id}.json")), b"{}").unwrap();
    assert!(trial::open(&seal).unwrap_err().to_string().contains("changed after it had been sealed"));
    std::fs::write(answers.join(format!("{id}.json")), &sealed).unwrap();

    // Scores.
    assert_eq!(none.score.as_ref().unwrap().false_alarm.map(|alarm| !alarm), none.score.as_ref().map(|s| s.verdict));
    let score = damping.score.as_ref().unwrap();
    assert_eq!((score.first.is_some(), score.flagged, score.recalibration), (true, None, None));
    assert!(score.base_error > 1.1 && score.final_error < 1.5, "{score:?}");
    assert!(score.named == Some(true), "{found:?}");

    // Other inputs make another trial.
    options.outliers = 0.05;
    run(&options);
    assert_eq!(*fresh.borrow(), [true, true]);

    let summary = trial::summarise(records.clone(), &options, bench.operations.len());
    assert_eq!(summary.confusion.planted, ["none", "quadratic-damping"]);
    assert_eq!(summary.confusion.counts.iter().flatten().sum::<usize>(), 2);
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["schema"], "stickslip.trial/1");
    assert_eq!(json["trials"][1]["answer"]["cause"], "quadratic-damping");
    // The draws that the first level of noise hides count against what the data can show; at the second none was made.
    options.noise = vec![0.01, 0.03];
    let summary = trial::summarise(records.clone(), &options, bench.operations.len());
    let hidden: usize = records.iter().map(|r| r.answer.draws.invisible).sum();
    let visible: Vec<_> = summary.scores.iter().map(|s| (s.noise, s.visible.successes, s.visible.of)).collect();
    assert_eq!(visible, [(None, 1, 1 + hidden), (Some(0.01), 1, 1 + hidden), (Some(0.03), 0, 0)]);
    for figure in figures::trial::REGISTRY {
        let drawing = figure.draw(&summary).unwrap();
        let by_cause = figures::trial::OF_SCORES.iter().all(|other| other.name() != figure.name());
        assert!(drawing.svg.contains("quadratic-damping") || !by_cause, "{}", drawing.name);
        assert!(drawing.csv.lines().count() > 1, "{}", drawing.name);
        assert!(figures::png(&drawing.svg, 1.0).is_ok());
    }
    let alone = summary.scores_alone();
    assert!(alone.trials.is_empty() && figures::trial::OF_SCORES.iter().all(|figure| figure.draw(&alone).is_ok()));
}

#[test]
fn names_of_causes_are_read_and_unknown_ones_refused() {
    let all = trial::causes(&["all"]).unwrap();
    let count = |kind| all.iter().filter(|c| c.kind() == kind).count();
    assert_eq!(count(trial::Kind::None), 1);
    // Some are effects of rigs without contact.
    let planted = |effect: &&&dyn stickslip::effects::Effect| {
        stickslip::effects::fits_rig(**effect, true).is_ok() && effect.of_series().is_none()
    };
    assert_eq!(count(trial::Kind::Effect), stickslip::effects::REGISTRY.iter().filter(planted).count());
    assert!(
        count(trial::Kind::Outside) >= 3 && count(trial::Kind::Recalibration) >= 5 && count(trial::Kind::Pair) >= 3
    );
    let pair = trial::causes(&["grosch+actuator-lag", "none"]).unwrap();
    assert_eq!(pair.iter().map(Cause::name).collect::<Vec<_>>(), ["grosch+actuator-lag", "none"]);
    let (causes, fewer) = trial::numbered_causes(&["all", "pairs:8", "none: 2"]).unwrap();
    assert_eq!(causes.len(), all.len());
    let options = Options { causes, fewer, seeds: 5, ..options(&[], "unused".into()) };
    let draws =
        |kind| options.causes.iter().filter(|c| c.kind() == kind).map(|c| options.draws_of(c)).collect::<Vec<_>>();
    assert_eq!((draws(trial::Kind::None), draws(trial::Kind::Pair)), (vec![2], vec![5; count(trial::Kind::Pair)]));
    for wrong in ["pairs:0", "pairs:", "none:many", "groch:2"] {
        assert!(trial::numbered_causes(&[wrong]).is_err(), "{wrong}");
    }
    let refused = trial::causes(&["groch"]).unwrap_err().to_string();
    assert!(refused.contains("did you mean `grosch`"), "{refused}");
    assert!(trial::causes(&["lugre+partial-slip"]).is_err());
    let refused = trial::causes(&["clearance"]).unwrap_err().to_string();
    assert!(refused.contains("`clearance` is solved for rigs without a [contact]"), "{refused}");
    assert!(outside::find("outside-run-out").is_some());
}

/// The calibration without the roller's compliance takes the contact to a thousandth of its stiffness, where a roller
/// that gives way changes nothing: the search has to look at the stated contact as well.
#[test]
fn effects_that_the_calibration_hides_are_found() {
    let folder = tempfile::tempdir().unwrap();
    // The calibrated base of the first is far off; the fit that begins at that of the second ends at a roller without
    // mass.
    for seed in [0, 4] {
        let options = Options { seed, ..options(&["roller-compliance"], folder.path().into()) };
        let results = stickslip::results::Results::open(folder.path(), []).unwrap();
        let one = (&options.causes[0], seed, 0.01);
        let record = trial::single(&trial::practice(), &options, &results, one, "").unwrap();
        let (score, found) = (record.score.unwrap(), record.found.unwrap());
        assert_eq!(score.exact, Some(true), "{seed}: {}", found.label());
        assert!(found.steps[0].chi2_per_point > 2.0 && score.final_error < 1.1, "{seed}: {:?}", found.steps);
    }
}
