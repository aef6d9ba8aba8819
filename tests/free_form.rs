//! The free form: tables with a law outside the catalogue, made by a program that shares no code
//! (`tests/reference/beyond.py`), and tables in closed form written here.

#[path = "figures/layout.rs"]
mod layout;

use layout::{check_drawing, rows};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use stickslip::compare::{Options, compare};
use stickslip::discover::{Candidates, SearchOptions, Verdict, discover, sentence};
use stickslip::figures::{self, discovery::FREE_FORM};
use stickslip::free_form::{Dependence, FreeForm, Standing, Variable, analyse};
use stickslip::{measurement, scenario};

/// A mode: mass, f0 and Q.
#[derive(Clone, Copy)]
struct Mode {
    mass: f64,
    f0: f64,
    q: f64,
}

fn found(table: &Path, mode: Mode, folder: &Path) -> FreeForm {
    let Mode { mass, f0, q } = mode;
    let text = format!(
        "title = \"free form\"\n[rig]\nkind = \"oscillator\"\ncoordinate = \"displacement\"\nmass = \"{mass:e} kg\"\n\
         natural_frequency = \"{f0:e} Hz\"\nquality_factor = {q:e}\ndrive = \"force\"\n[measurement]\nfile = \"{}\"\n\
         [fit]\nfree = [\"rig.natural_frequency\", \"rig.quality_factor\"]\n",
        table.file_name().and_then(|name| name.to_str()).expect("a name")
    );
    let here = folder.join(table.file_name().expect("a name"));
    if here != table {
        std::fs::copy(table, &here).expect("a copy");
    }
    let path = here.with_extension("toml");
    std::fs::write(&path, text).expect("a scenario");
    let scenario = scenario::load(&path).unwrap_or_else(|error| panic!("{error}"));
    let table = measurement::load(&scenario).unwrap_or_else(|error| panic!("{error}")).expect("measurements");
    analyse(&compare(&scenario, &table, &Options { seed: 0 }))
}

fn of(found: &FreeForm, variable: Variable) -> &Dependence {
    found.classes.iter().find(|class| class.variables == [variable]).expect("a class")
}

/// Linear between the rows of a table (v, k, c).
fn between(truth: &[[f64; 3]], v: f64) -> [f64; 2] {
    let at = truth.partition_point(|row| row[0] < v).clamp(1, truth.len() - 1);
    let (a, b) = (truth[at - 1], truth[at]);
    let share = ((v - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
    [1, 2].map(|i| a[i] + share * (b[i] - a[i]))
}

#[test]
fn laws_outside_the_catalogue_are_told_by_their_variable_and_their_curve() {
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/free-form");
    let text = std::fs::read_to_string(source.join("answers.json")).expect("answers");
    let answers: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text).expect("JSON");
    let folder = tempfile::tempdir().expect("a folder");
    let (mut right, mut inside, mut places) = (0, 0, 0);
    let mut told = String::new();
    for (name, answer) in &answers {
        let number = |key: &str| answer[key].as_f64().expect(key);
        let mode = Mode { mass: number("mass"), f0: number("f0"), q: number("Q") };
        let started = std::time::Instant::now();
        let found = found(&source.join(name).with_extension("csv"), mode, folder.path());
        let seconds = started.elapsed().as_secs_f64();
        let wanted = if answer["variable"] == "amplitude" { Variable::Amplitude } else { Variable::Frequency };
        let leads = found.leading().is_some_and(|class| class.variables == [wanted]) && found.tied().count() == 0;
        right += usize::from(leads);
        // A law of the amplitude has no shape of the frequency alone.
        let of_amplitude = ["cubic-stiffness", "clearance", "power-damping", "quadratic-damping"];
        let bends = found.shapes.iter().any(|shape| of_amplitude.contains(&shape.effect));
        assert!(!leads || bends == (wanted == Variable::Amplitude), "{name}: {:?}", found.shapes);
        let truth: Vec<[f64; 3]> = serde_json::from_value(answer["truth"].clone()).expect("rows");
        let rows = std::fs::read_to_string(source.join(name).with_extension("csv")).expect("rows");
        let column = if wanted == Variable::Amplitude { 3 } else { 1 };
        let values =
            rows.lines().skip(1).map(|line| line.split(',').nth(column).expect("a cell").parse().expect("a number"));
        let values: Vec<f64> = values.collect();
        let mean = [0, 1].map(|i| values.iter().map(|v| between(&truth, *v)[i]).sum::<f64>() / values.len() as f64);
        let curve = &of(&found, wanted).curves[0];
        let mut own = 0;
        for (at, v) in curve.values.iter().enumerate() {
            let true_value = between(&truth, *v);
            for (i, band) in [&curve.stiffness, &curve.damping].into_iter().enumerate() {
                let value = true_value[i] - mean[i];
                own += usize::from((band[at][1]..=band[at][2]).contains(&value));
            }
        }
        inside += own;
        places += 2 * curve.values.len();
        writeln!(
            told,
            "{name} {} {seconds:.1} s, {own} of {}: {}",
            answer["kind"],
            2 * curve.values.len(),
            found.statement
        )
        .expect("text");
        for line in stickslip::free_form::lines(&found, true) {
            writeln!(told, "    {line}").expect("text");
        }
    }
    println!("{told}{right} of {} right, curves inside {inside} of {places}", answers.len());
    assert!(20 * right >= 19 * answers.len(), "{right} of {}\n{told}", answers.len());
    assert!(10 * inside >= 9 * places, "{inside} of {places}\n{told}");
}

/// How a table is written: levels, the response of a series at a frequency to be measured, or the drive for one to be
/// held.
struct Made {
    mode: Mode,
    /// Largest motion.
    size: f64,
    noise: f64,
    with_phase: bool,
    stated: bool,
}

impl Made {
    /// Rows (series, f/f0, drive in units of K times the largest motion, motion in units of that, phase) as a table.
    fn write(&self, rows: &[[f64; 5]], random: &mut Pcg64, path: &Path) {
        let Mode { mass, f0, .. } = self.mode;
        let stiffness = mass * (std::f64::consts::TAU * f0).powi(2);
        let mut text = String::from("series,frequency_hz,force_n,amplitude_m");
        text += if self.with_phase { ",phase_rad" } else { "" };
        text += if self.stated { ",amplitude_sd_percent" } else { "" };
        text += if self.stated && self.with_phase { ",phase_sd_rad\n" } else { "\n" };
        for [series, w, p, a, phase] in rows {
            let amplitude = a * self.size * (1.0 + self.noise * random.sample::<f64, _>(StandardNormal));
            let (frequency, force) = (w * f0, p * stiffness * self.size);
            write!(text, "{series},{frequency:.9e},{force:.9e},{amplitude:.9e}").expect("text");
            if self.with_phase {
                write!(text, ",{:.6}", phase + self.noise * random.sample::<f64, _>(StandardNormal)).expect("text");
            }
            if self.stated {
                write!(text, ",{}", 100.0 * self.noise).expect("text");
                if self.with_phase {
                    write!(text, ",{}", self.noise).expect("text");
                }
            }
            text.push('\n');
        }
        std::fs::write(path, text).expect("a table");
    }
}

/// (1 - w^2 + k) + i w (1/Q + c).
fn dynamic_stiffness(w: f64, q: f64, [k, c]: [f64; 2]) -> (f64, f64) {
    (1.0 - w * w + k, w * (1.0 / q + c))
}

fn grid(q: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| 1.0 + (8.0 * i as f64 / (count - 1) as f64 - 4.0) * 0.5 / q).collect()
}

/// Steady states of a mode whose k and c depend on the amplitude, at drives of set levels: by bisection.
fn driven(q: f64, levels: &[f64], count: usize, law: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 5]> {
    let mut rows = Vec::new();
    for (series, level) in levels.iter().enumerate() {
        let p = level / q;
        for w in grid(q, count) {
            let size = |a: f64| {
                let (re, im) = dynamic_stiffness(w, q, law(a));
                re.hypot(im) * a
            };
            let (mut low, mut high) = (0.0, 3.0);
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if size(middle) < p { low = middle } else { high = middle }
            }
            let (re, im) = dynamic_stiffness(w, q, law(low));
            rows.push([series as f64 + 1.0, w, p, low, -im.atan2(re)]);
        }
    }
    rows
}

const NOTHING: [f64; 2] = [0.0, 0.0];

#[test]
fn nothing_is_claimed_of_data_with_nothing_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut claimed = Vec::new();
    for seed in 0..50 {
        let mut random = Pcg64::seed_from_u64(seed);
        let mode =
            Mode { mass: 10f64.powf(random.random_range(-3.0..1.0)), f0: 80.0, q: random.random_range(5.0..500.0) };
        let levels: Vec<f64> = [0.2, 0.45, 1.0][..random.random_range(2..=3)].to_vec();
        let made = Made {
            mode,
            size: 1e-4,
            noise: 10f64.powf(random.random_range(-3.0..-1.4)),
            with_phase: seed % 3 != 0,
            stated: seed % 2 == 0,
        };
        let rows = driven(mode.q, &levels, 41, |_| NOTHING);
        let path = folder.path().join(format!("{seed}.csv"));
        made.write(&rows, &mut random, &path);
        let found = found(&path, mode, folder.path());
        if found.leading().is_some() {
            claimed.push(format!("{seed}: {}", found.statement));
        }
    }
    assert!(claimed.is_empty(), "{claimed:#?}");
}

/// Four series, each held at its own amplitude while the frequency is swept: the drive is what is measured of the law.
#[test]
fn with_the_response_held_amplitude_and_drift_are_tied() {
    let folder = tempfile::tempdir().expect("a folder");
    let mode = Mode { mass: 0.3, f0: 120.0, q: 60.0 };
    let made = Made { mode, size: 2e-5, noise: 0.005, with_phase: true, stated: true };
    let law = |a: f64| [-0.03 * a, 0.01 * a.sqrt()];
    let mut measured = Vec::new();
    for (series, a) in [0.15, 0.3, 0.6, 1.0].into_iter().enumerate() {
        for w in grid(mode.q, 41) {
            let (re, im) = dynamic_stiffness(w, mode.q, law(a));
            measured.push([series as f64 + 1.0, w, a * re.hypot(im), a, -im.atan2(re)]);
        }
    }
    let path = folder.path().join("held.csv");
    made.write(&measured, &mut Pcg64::seed_from_u64(7), &path);
    let found = found(&path, mode, folder.path());
    for variable in [Variable::Amplitude, Variable::Drift] {
        let standing = of(&found, variable).standing;
        assert!([Standing::Leading, Standing::Tied].contains(&standing), "{variable:?}: {}", found.statement);
    }
    assert_eq!(of(&found, Variable::Frequency).standing, Standing::Excluded, "{}", found.statement);
    // Nor does a search name one of them alone.
    let scenario = scenario::load(path.with_extension("toml")).expect("a scenario");
    let table = measurement::load(&scenario).expect("a table").expect("measurements");
    let candidates = Candidates::of(&["drift", "power-damping"], &[]).expect("known");
    let d = discover(&scenario, &table, &SearchOptions { candidates, ..SearchOptions::default() });
    assert_eq!(d.explanation().hypothesis.effects(), ["drift", "power-damping"]);
    assert_eq!(d.verdict, Verdict::Unexplained);
    let said = sentence(&d);
    assert!(said.contains("a rig of its own in every series") && said.contains("not told from a law"), "{said}");
    // The figure shows the leading class and those that are tied with it, and has room for every text.
    let drawings = figures::drawings(FREE_FORM, &found).expect("a figure");
    assert_eq!(drawings, figures::drawings(FREE_FORM, &found).expect("a figure"));
    drawings.iter().for_each(|drawing| check_drawing("held", drawing));
    let shown: usize =
        found.leading().into_iter().chain(found.tied()).flat_map(|c| &c.curves).map(|c| c.values.len()).sum();
    assert_eq!(rows(&drawings[0]).len(), shown);
}

/// A hump in mu(s), by a program that shares no code: what is missing is a number of every speed of the roller. One
/// series at each speed does not tell that from a drift, which is said; the amplitude and the frequency are ruled out.
#[test]
fn a_hump_of_the_friction_depends_on_the_roller_speed_or_the_series() {
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/free-form/friction-1.csv");
    let folder = tempfile::tempdir().expect("a folder");
    let rig = "title = 'A hump'\n[rig]\ninertia = 0.005\ntorsional_stiffness = 990\ntorsional_damping = 0.43\n\
               spring_stiffness = 16000\nspring_damping = 12\nspring_arm = 0.03\ncontact_arm = 0.06\n[contact]\n\
               stiffness = 89000\ndamping = 26\nfriction = 0.5\n[fit]\nfree = ['contact.stiffness', 'contact.damping']\n";
    let path = folder.path().join("hump.toml");
    std::fs::write(&path, format!("{rig}[measurement]\nfile = {source:?}\n")).expect("a scenario");
    let scenario = scenario::load(&path).unwrap_or_else(|error| panic!("{error}"));
    let table = measurement::load(&scenario).unwrap_or_else(|error| panic!("{error}")).expect("measurements");
    let found = analyse(&compare(&scenario, &table, &Options { seed: 0 }));
    for variable in [Variable::RollerSpeed, Variable::Drift] {
        let class = of(&found, variable);
        let leads = [Standing::Leading, Standing::Tied].contains(&class.standing);
        assert!(leads && class.explained_percent > 80.0, "{variable:?}: {}", found.statement);
    }
    for variable in [Variable::Amplitude, Variable::Frequency] {
        assert_eq!(of(&found, variable).standing, Standing::Excluded, "{}", found.statement);
    }
}

/// The same readings of a mode of another mass, length and frequency.
#[test]
fn what_is_told_does_not_depend_on_the_units_of_the_rig() {
    let folder = tempfile::tempdir().expect("a folder");
    let told = [(0.3, 2e-5, 120.0), (7e5, 3.0, 0.02), (1e-9, 1e-10, 1e6)].map(|(mass, size, f0)| {
        let mode = Mode { mass, f0, q: 40.0 };
        let made = Made { mode, size, noise: 0.01, with_phase: true, stated: false };
        let rows = driven(mode.q, &[0.25, 0.5, 1.0], 31, |a| [0.02 * a * a, 0.02 * a]);
        let path = folder.path().join(format!("{mass}.csv"));
        made.write(&rows, &mut Pcg64::seed_from_u64(3), &path);
        let found = found(&path, mode, folder.path());
        let numbers: Vec<f64> = found.classes.iter().flat_map(|c| [c.left_rms_percent, c.explained_percent]).collect();
        let k = mass * (std::f64::consts::TAU * f0).powi(2);
        let curve = &of(&found, Variable::Amplitude).curves[0];
        let curve: Vec<f64> = curve.stiffness.iter().flatten().map(|value| value / k).collect();
        (found.statement, numbers, curve)
    });
    for other in &told[1..] {
        assert_eq!(told[0].0, other.0);
        let close = |a: &[f64], b: &[f64], within: f64| a.iter().zip(b).all(|(a, b)| (a - b).abs() < within);
        assert!(close(&told[0].1, &other.1, 0.05), "{:?} {:?}", told[0].1, other.1);
        assert!(close(&told[0].2, &other.2, 2e-4), "{:?} {:?}", told[0].2, other.2);
    }
    assert!(told[0].0.contains("depends on the amplitude"), "{}", told[0].0);
}

/// Amplitudes alone, in one series: a curve of the amplitude could follow whatever there is.
#[test]
fn one_series_without_phases_tells_no_variable() {
    let folder = tempfile::tempdir().expect("a folder");
    let mode = Mode { mass: 1.0, f0: 10.0, q: 20.0 };
    let made = Made { mode, size: 1e-3, noise: 0.003, with_phase: false, stated: true };
    let rows = driven(mode.q, &[1.0], 201, |a| [0.08 * a * a, 0.0]);
    let path = folder.path().join("one.csv");
    made.write(&rows, &mut Pcg64::seed_from_u64(3), &path);
    let found = found(&path, mode, folder.path());
    assert!(found.leading().is_none(), "{}", found.statement);
    let told: Vec<Standing> = found.classes.iter().map(|class| class.standing).collect();
    assert_eq!(told, [Standing::Base, Standing::Untestable, Standing::Untestable]);
}

/// One series with phases passes every amplitude twice and every frequency once: a law of the amplitude is told, one of
/// the frequency, which another happens to follow in part, is not taken for it.
#[test]
fn one_series_with_phases_tells_a_law_of_the_amplitude_and_takes_none_of_the_frequency_for_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let mode = Mode { mass: 1.0, f0: 10.0, q: 20.0 };
    let made = Made { mode, size: 1e-3, noise: 0.003, with_phase: true, stated: true };
    let statement = |name: &str, rows: &[[f64; 5]]| {
        let path = folder.path().join(name).with_extension("csv");
        made.write(rows, &mut Pcg64::seed_from_u64(3), &path);
        found(&path, mode, folder.path()).statement
    };
    let of_amplitude = driven(mode.q, &[1.0], 201, |a| [0.04 * a * a, 0.0]);
    let told = statement("amplitude", &of_amplitude);
    assert!(told.contains("what is missing depends on the amplitude"), "{told}");
    let of_frequency: Vec<[f64; 5]> = grid(mode.q, 201)
        .into_iter()
        .map(|w| {
            // Another mode beside the first.
            let law = [0.04 / (1.0 + (100.0 * (w - 1.03)).powi(2)), 0.03 / (1.0 + (100.0 * (w - 1.03)).powi(2))];
            let (re, im) = dynamic_stiffness(w, mode.q, law);
            [1.0, w, 1.0 / mode.q, 1.0 / mode.q / re.hypot(im), -im.atan2(re)]
        })
        .collect();
    let told = statement("frequency", &of_frequency);
    assert!(!told.contains("what is missing depends on the amplitude"), "{told}");
}

/// A cubic stiffness: its own name is the nearest shape, and leaves no more than the class.
#[test]
fn the_effect_that_is_there_has_the_nearest_shape() {
    let folder = tempfile::tempdir().expect("a folder");
    let mode = Mode { mass: 2.0, f0: 50.0, q: 80.0 };
    let made = Made { mode, size: 1e-3, noise: 0.005, with_phase: true, stated: true };
    let rows = driven(mode.q, &[0.25, 0.5, 1.0], 41, |a| [0.012 * a * a, 0.0]);
    let path = folder.path().join("cubic.csv");
    made.write(&rows, &mut Pcg64::seed_from_u64(5), &path);
    let found = found(&path, mode, folder.path());
    let nearest = found.shapes.first().expect("a shape");
    assert_eq!(nearest.effect, "cubic-stiffness", "{:?}", found.shapes);
    assert!(nearest.beyond_percent < 10.0, "{:?}", found.shapes);
    // What leaves as much as a constant has none of the shape.
    assert!(!found.shapes.iter().any(|s| s.effect == "quadratic-damping"), "{:?}", found.shapes);
    assert!(found.shapes.iter().any(|s| s.effect == "clearance" && s.beyond_percent > 100.0), "{:?}", found.shapes);
}
