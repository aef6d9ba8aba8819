//! A user's own effect, `formula` in a scenario: the physics of the catalogue typed as text, rows of another program,
//! closed forms, every command.

mod common;

use assert_cmd::Command;
use common::{Random, paper_model};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;
use stickslip::effects::formula::{ActsOn, Formula, Stated, Statement};
use stickslip::effects::{Effect, find};
use stickslip::model::{Model, Operation};
use stickslip::parameter::FIRST_EFFECT_PARAMETER;
use stickslip::scenario::Formulation::Series;
use stickslip::scenario::{self, Scenario};
use stickslip::solver::cycle::Tolerance;
use stickslip::solver::time::Plan;
use stickslip::solver::{Solution, Status, Warm, integrated, solve};

fn own(acts_on: ActsOn, text: &str, parameters: &[(&str, f64)]) -> (&'static dyn Effect, Vec<f64>) {
    let stated =
        |(key, value): &(&str, f64)| Stated { key: (*key).into(), unit: "1".into(), value: *value, range: None };
    let statement = Statement {
        name: "own".into(),
        text: text.into(),
        acts_on,
        parameters: parameters.iter().map(stated).collect(),
    };
    let formula = Formula::new(statement).unwrap_or_else(|fault| panic!("{text}: {fault:?}"));
    (formula, parameters.iter().map(|(_, value)| *value).collect())
}

fn paper(effect: (&'static dyn Effect, Vec<f64>)) -> Model {
    Model { effects: vec![effect], ..paper_model(Series) }
}

fn solved(model: &Model, at: &Operation) -> Solution {
    solve(model, at, 0, &Tolerance::default(), true, &mut Warm::default())
}

/// Relative distance of two steady states in the complex plane, and of their derivatives by parameter number `index`.
fn distance(one: &Solution, other: &Solution, index: usize) -> (f64, f64) {
    let apart = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).hypot(a.1 - b.1) / b.0.hypot(b.1).max(1e-300);
    let of = |s: &Solution| (s.state.amplitude * s.state.phase.cos(), s.state.amplitude * s.state.phase.sin());
    let derivative = |s: &Solution| s.derivatives.as_ref().map_or((f64::NAN, f64::NAN), |all| all[index]);
    (apart(of(one), of(other)), apart(derivative(one), derivative(other)))
}

/// Static contact, partial stick, full slip, slip both ways, and no contact.
const CONDITIONS: [(f64, f64, f64); 5] =
    [(0.0, 20.0, 2.5e-6), (5e-5, 20.0, 2.5e-6), (0.02, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6), (0.0, 0.0, 7.5e-6)];

/// Name in the catalogue, what it acts on, the formula and its parameters.
type Typed = (&'static str, ActsOn, &'static str, Vec<(&'static str, f64)>);

/// The laws of the catalogue that a formula can state.
fn typed() -> Vec<Typed> {
    use ActsOn::{Force, Friction};
    vec![
        ("cubic-stiffness", Force, "-K_3*x^3", vec![("K_3", 8e7)]),
        ("quadratic-damping", Force, "-D_2*v*abs(v)", vec![("D_2", 40.0)]),
        ("stribeck", Friction, "delta_mu*exp(-s/v_s)", vec![("delta_mu", 0.15), ("v_s", 0.15)]),
        ("rate-strengthening", Friction, "beta*ln(1 + s/v_0)", vec![("beta", 0.1), ("v_0", 1e-3)]),
    ]
}

#[test]
fn a_law_of_the_catalogue_typed_as_a_formula_is_that_law() {
    for (name, acts_on, text, parameters) in typed() {
        let built_in = paper((find(name).unwrap(), parameters.iter().map(|p| p.1).collect()));
        let typed = paper(own(acts_on, text, &parameters));
        for (speed, load, drive) in CONDITIONS {
            for frequency in [58.0, 71.0, 74.0, 82.0] {
                let at = Operation { speed, load, drive, frequency, series: 0 };
                let (one, other) = (solved(&typed, &at), solved(&built_in, &at));
                assert_eq!(one.state.status, other.state.status, "{name} {at:?}");
                let (state, derivative) = distance(&one, &other, FIRST_EFFECT_PARAMETER);
                assert!(state < 1e-8, "{name} {at:?}: {state:e}");
                let none = other.derivatives.as_ref().is_none_or(|all| all[FIRST_EFFECT_PARAMETER] == (0.0, 0.0));
                assert!(none || derivative < 1e-5, "{name} {at:?}: derivative {derivative:e}");
            }
        }
    }
}

#[test]
fn formulas_agree_with_the_rows_of_a_separate_program() {
    let mut compared = 0;
    for line in include_str!("data/effects.csv").lines() {
        let Some((_, acts_on, text, parameters)) = typed().into_iter().find(|one| line.starts_with(one.0)) else {
            continue;
        };
        let fields: Vec<&str> = line.split(',').collect();
        let value = |key: &str| {
            let pair = fields[1].split(' ').find_map(|pair| pair.strip_prefix(key)?.strip_prefix('='));
            pair.unwrap_or_else(|| panic!("{line}: {key}")).parse().unwrap()
        };
        let parameters: Vec<(&str, f64)> = parameters.iter().map(|(key, _)| (*key, value(key))).collect();
        let v: Vec<f64> = fields[2..8].iter().map(|v| v.parse().unwrap()).collect();
        let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3], series: 0 };
        let found = solved(&paper(own(acts_on, text, &parameters)), &at).state;
        let apart = (found.amplitude / v[4] - 1.0).hypot(found.phase - v[5]);
        assert!(apart < 1e-4, "{line}: {apart:e}");
        compared += 1;
    }
    assert!(compared > 80, "{compared}");
}

/// More stiffness and damping of the bristles, typed as a force of theirs, are more stiffness and damping.
#[test]
fn a_linear_force_of_the_bristles_is_their_stiffness_and_damping() {
    let (k, c) = (3e4, 9.0);
    let mut stiffer = paper_model(Series);
    stiffer.contact.stiffness += k;
    stiffer.contact.damping += c;
    let typed = paper(own(ActsOn::ContactForce, "k*stretch + c*stretch_rate", &[("k", k), ("c", c)]));
    for (speed, load, drive) in CONDITIONS {
        for frequency in [58.0, 71.0, 74.0, 82.0, 90.0] {
            let at = Operation { speed, load, drive, frequency, series: 0 };
            let (one, other) = (solved(&typed, &at), solved(&stiffer, &at));
            assert_eq!(one.state.status, other.state.status, "{at:?}");
            let (state, _) = distance(&one, &other, 0);
            assert!(state < 1e-5, "{at:?}: {state:e}");
            // The derivative by k is that by the stiffness of the contact, number 7, and that by c that by its damping.
            for (own, stiff) in [(FIRST_EFFECT_PARAMETER, 7), (FIRST_EFFECT_PARAMETER + 1, 8)] {
                let of = |s: &Solution, index: usize| s.derivatives.as_ref().expect("asked for")[index];
                let (a, b) = (of(&one, own), of(&other, stiff));
                let apart = (a.0 - b.0).hypot(a.1 - b.1);
                let scale = b.0.hypot(b.1) + 1e-6 * other.state.amplitude / [k, c][own - FIRST_EFFECT_PARAMETER];
                assert!(apart < 1e-3 * scale, "{at:?}: {a:?} for {b:?}");
            }
        }
    }
}

/// Over a roller at rest, without slip, the stretch is -b th: a cubic force of the bristles is b^4 of a cubic torque.
#[test]
fn a_cubic_force_of_stuck_bristles_is_a_cubic_torque() {
    let mut base = paper_model(Series);
    base.contact.friction = 50.0;
    let (b, k3) = (0.06f64, 3e17);
    let effect = own(ActsOn::ContactForce, "k*stretch^3", &[("k", k3)]);
    let typed = Model { effects: vec![effect], ..base.clone() };
    let torque = (find("cubic-stiffness").unwrap(), vec![k3 * b.powi(4)]);
    let other = Model { effects: vec![torque], ..base.clone() };
    let mut moved = 0.0f64;
    for frequency in [70.0, 78.0, 81.0, 84.0, 90.0] {
        let at = Operation { speed: 0.0, load: 20.0, drive: 2.5e-6, frequency, series: 0 };
        let (one, other, bare) = (solved(&typed, &at), solved(&other, &at), solved(&base, &at));
        assert_eq!(one.state.status, Status::Steady);
        let (state, _) = distance(&one, &other, 0);
        assert!(state < 1e-6, "{frequency}: {state:e}");
        moved = moved.max(distance(&one, &bare, 0).0);
    }
    assert!(moved > 0.01, "the law matters: {moved}");
}

/// A mass on a spring.
fn oscillator(extra: &str) -> Scenario {
    let text = format!(
        "title = 't'\n[rig]\nkind = 'oscillator'\nmass = 2\nnatural_frequency = 80\nquality_factor = 50\n\
         drive = 'force'\n[sweep]\nfrequency = [79, 81]\ndrive = 1\n{extra}"
    );
    scenario::load_text("/nowhere/mine.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

const PLAN: Plan = Plan { steps: 1000, cycles: 1500, settled: 1e-9, window: 1, solved: 1e-9 };

/// Laws of every form - even, one-sided, kinked, steep, of both variables - against an integration in time from rest.
#[test]
fn laws_of_any_form_agree_with_an_integration_in_time() {
    let base = Model::new(&oscillator(""));
    let (k, motion) = (2.0 * (TAU * 80.0f64).powi(2), 50.0 / (2.0 * (TAU * 80.0f64).powi(2)));
    let speed = TAU * 80.0 * motion;
    let damping = k / 50.0 / (TAU * 80.0);
    let (stiff, narrow) = (k / 50.0, 0.5 * motion);
    let cases: Vec<(&str, Vec<(&str, f64)>)> = vec![
        ("-k*x^5", vec![("k", 0.6 * stiff / motion.powi(4))]),
        ("-k*x^2", vec![("k", 2.0 * stiff / motion)]),
        ("-k*max(0, x - g)", vec![("k", 2.0 * stiff), ("g", narrow)]),
        ("-k*sign(x)*max(0, abs(x) - g)", vec![("k", stiff), ("g", narrow)]),
        ("-d*abs(v)^1.5*sign(v)", vec![("d", damping / speed.sqrt())]),
        ("-d*x^2*v", vec![("d", damping / motion.powi(2))]),
        ("-f*tanh(v/u)", vec![("f", 0.2), ("u", 0.1 * speed)]),
        ("-k*x - d*v", vec![("k", 0.1 * k), ("d", damping)]),
        ("-k*x", vec![("k", 1e6 * k)]),
        ("d*v", vec![("d", 0.5 * damping)]),
    ];
    for (text, parameters) in cases {
        let model = Model { effects: vec![own(ActsOn::Force, text, &parameters)], ..base.clone() };
        // Far above the resonance of the mode alone the stiffest is driven below its own.
        for frequency in [60.0, 78.5, 80.0, 81.5, 100.0] {
            let at = Operation { speed: 0.0, load: 0.0, drive: 1.0, frequency, series: 0 };
            let found = solved(&model, &at);
            assert_eq!(found.state.status, Status::Steady, "{text} {frequency}");
            if text == "-k*x" {
                let closed = 1.0 / (1e6 * k + k - 2.0 * (TAU * frequency).powi(2));
                assert!((found.state.amplitude / closed - 1.0).abs() < 1e-6, "{frequency}");
                continue;
            }
            let other = integrated(&model, &at, &PLAN);
            assert!(other.periodic, "{text} {frequency}");
            let states = std::iter::once(found.state.amplitude).chain(found.others.iter().map(|other| other.0));
            let apart = states.map(|x| (x / other.amplitude - 1.0).abs()).fold(f64::INFINITY, f64::min);
            assert!(apart < 3e-4, "{text} {frequency}: {apart:e}");
        }
    }
}

#[test]
fn derivatives_by_the_parameters_of_a_formula_are_those_of_differences() {
    let force = own(ActsOn::Force, "-k*tanh(x/g)^3 - d*v*abs(v)", &[("k", 0.3), ("g", 5e-4), ("d", 30.0)]);
    let friction = own(ActsOn::Friction, "m*exp(-(s/w)^2)", &[("m", 0.05), ("w", 0.02)]);
    let bristles = own(ActsOn::ContactForce, "k*stretch*abs(stretch)", &[("k", 1e10)]);
    for effect in [force, friction, bristles] {
        let model = paper(effect);
        for (speed, load, drive) in CONDITIONS {
            let at = Operation { speed, load, drive, frequency: 75.0, series: 0 };
            let found = solved(&model, &at);
            if found.state.status != Status::Steady {
                continue;
            }
            let all = found.derivatives.clone().expect("asked for");
            for number in 0..model.effects[0].1.len() {
                let index = FIRST_EFFECT_PARAMETER + number;
                let step = 1e-4 * model.effects[0].1[number];
                let moved = |sign: f64| {
                    let mut model = model.clone();
                    model.effects[0].1[number] += sign * step;
                    solved(&model, &at).state
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                let amplitude = (up.amplitude - down.amplitude) / (2.0 * step);
                let phase = (up.phase - down.phase) / (2.0 * step);
                let scale = found.state.amplitude / model.effects[0].1[number];
                let error = (all[index].0 - amplitude).abs() / scale
                    + (all[index].1 - phase).abs() / scale * found.state.amplitude;
                let size = (amplitude / scale).abs() + phase.abs() * model.effects[0].1[number];
                assert!(error < 1e-3 * size + 1e-5, "{at:?} {number}: {error:e} of {size:e}");
            }
        }
    }
}

#[test]
fn a_formula_is_read_with_its_units_and_ranges() {
    let scenario = oscillator(
        "[[effect]]\nformula = '-k5*x^5'\nname = 'my-quintic'\nacts_on = 'force'\n\
         k5 = { value = '2 kN/m^5', low = '1 N/m^5', high = '1 MN/m^5' }\n[fit]\nfree = ['effect.my-quintic.k5']\n\
         [[effect]]\nname = 'other'\nacts_on = 'force'\nformula = '-d*v^3'\nd = 0\n",
    );
    let setting = &scenario.effects[0];
    assert_eq!((setting.name(), setting.parameters.as_slice()), ("my-quintic", &[2e3][..]));
    assert_eq!(setting.effect.parameters()[0].unit, "N/m^5");
    let model = Model::new(&scenario);
    assert_eq!(setting.effect.search_range(0, &model.scales), (1.0, 1e6));
    let names: Vec<&str> = model.effects.iter().map(|(effect, _)| effect.name()).collect();
    assert_eq!(names, ["my-quintic"], "what has no strength is no part of the model ...");
    assert!(model.catalogue().any(|effect| effect.name() == "other"), "... but may be added");
    assert_eq!(scenario.parameter_keys().iter().filter(|key| key.starts_with("effect.")).count(), 2);
}

/// Amplitude of a mass on a quintic spring, its first harmonic: [(K - M w^2) + 5/8 K5 X^4]^2 + (w C)^2 = (f/X)^2.
fn quintic(frequency: f64, force: f64, k5: f64) -> f64 {
    let (m, w0, w) = (2.0, TAU * 80.0, TAU * frequency);
    let balance = |x: f64| {
        let spring = m * (w0 * w0 - w * w) + 0.625 * k5 * x.powi(4);
        x * spring.hypot(w * m * w0 / 50.0) - force
    };
    let (mut low, mut high) = (0.0, 60.0 * force / (m * w0 * w0));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if balance(middle) > 0.0 { high = middle } else { low = middle }
    }
    high
}

/// A folder with the readings of a quintic spring at several drives, with 0.5 % of scatter, and a scenario that
/// declares it.
fn measured() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let mut random = Random(5);
    let mut table = String::from("series,force_n,frequency_hz,amplitude_m,amplitude_sd_percent\n");
    let k = 2.0 * (TAU * 80.0f64).powi(2);
    let largest = 50.0 * 2.0 / k;
    // At the largest drive bent by half its width.
    let k5 = 0.8 * 0.5 * 2.0 * k / 50.0 / largest.powi(4);
    for (series, force) in [0.5, 1.0, 1.5, 2.0].into_iter().enumerate() {
        for step in 0..41 {
            let frequency = 77.0 + 0.15 * f64::from(step);
            let scatter: f64 = (0..12).map(|_| random.next()).sum::<f64>() - 6.0;
            let amplitude = quintic(frequency, force, k5) * (1.0 + 0.005 * scatter);
            writeln!(table, "{series},{force},{frequency},{amplitude:.6e},0.5").unwrap();
        }
    }
    std::fs::write(dir.path().join("table.csv"), table).unwrap();
    std::fs::write(dir.path().join("mine.toml"), MINE).unwrap();
    dir
}

const MINE: &str = r#"title = "Mine"

[rig]
kind = "oscillator"
mass = "2 kg"
natural_frequency = "80 Hz"
quality_factor = 50
drive = "force"

[measurement]
file = "table.csv"

[[effect]]
formula = "-k5*x^5"   # of mine
name = "my-quintic"
acts_on = "force"
k5 = { value = "0 N/m^5" }

[fit]
free = ["rig.natural_frequency", "rig.quality_factor"]
"#;

fn stickslip(dir: &Path) -> Command {
    let mut command = Command::cargo_bin("stickslip").unwrap();
    command.current_dir(dir);
    command
}

fn json(dir: &Path, command: &[&str]) -> serde_json::Value {
    let output = stickslip(dir).args(command).args(["--json", "-", "--quiet"]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    serde_json::from_str(&text)
        .unwrap_or_else(|error| panic!("{error}: {text}{}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn discover_names_a_planted_formula_and_add_writes_it() {
    let dir = measured();
    let found = json(dir.path(), &["discover", "mine.toml", "--max-effects", "1"]);
    assert_eq!(found["verdict"], "effect-missing", "{found}");
    assert_eq!(found["effects"], serde_json::json!(["my-quintic"]));
    // By its name like any effect, in the catalogue with its law.
    let named = json(dir.path(), &["discover", "mine.toml", "--candidates", "my-quintic"]);
    assert_eq!(named["effects"], serde_json::json!(["my-quintic"]));
    let listed = stickslip(dir.path()).args(["effects", "--of", "mine.toml"]).output().unwrap();
    assert!(String::from_utf8_lossy(&listed.stdout).contains("my-quintic"));
    let page = stickslip(dir.path()).args(["effects", "my-quintic", "--of", "mine.toml"]).output().unwrap();
    assert!(String::from_utf8_lossy(&page.stdout).contains("k5*x^5"));
    let own = &found["candidates"][0]["parameters"]["effect.my-quintic.k5"];
    assert_eq!(own["unit"], "N/m^5", "{own}");

    stickslip(dir.path()).args(["add", "my-quintic", "mine.toml", "-o", "full.toml", "--quiet"]).assert().success();
    let text = std::fs::read_to_string(dir.path().join("full.toml")).unwrap();
    assert!(text.contains("formula = \"-k5*x^5\"   # of mine\n"), "{text}");
    let line = text.lines().find(|line| line.starts_with("k5 = { value = \"")).expect(&text);
    assert!(line.contains(" N/m^5\" }  # 95 %: "), "{line}");
    assert!(text.contains("\"effect.my-quintic.k5\""), "{text}");
    let compared = json(dir.path(), &["compare", "full.toml"]);
    let chi2 = compared["chi2_per_point"].as_f64().unwrap();
    assert!((0.7..1.3).contains(&chi2), "{chi2}");

    let again = stickslip(dir.path()).args(["add", "my-quintic", "full.toml"]).output().unwrap();
    assert!(String::from_utf8_lossy(&again.stderr).contains("has the effect `my-quintic` already"));
    let unknown = stickslip(dir.path()).args(["add", "my-quintik", "mine.toml"]).output().unwrap();
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("did you mean `my-quintic`?"));
}

#[test]
fn a_value_is_put_where_none_stands() {
    for (before, after) in
        [("k5 = {}", "k5 = { value = \""), ("k5 = 0", "k5 = "), ("k5 = { low = 1, high = 1e30 }", "k5 = { value = ")]
    {
        let dir = measured();
        let text = MINE.replace("k5 = { value = \"0 N/m^5\" }", before);
        std::fs::write(dir.path().join("mine.toml"), text).unwrap();
        stickslip(dir.path()).args(["add", "my-quintic", "mine.toml", "--quiet"]).assert().success();
        let text = std::fs::read_to_string(dir.path().join("mine.toml")).unwrap();
        let after = after.trim_end_matches('"');
        assert!(text.contains(after) && text.contains("# 95 %: "), "{text}");
        let scenario = scenario::load(dir.path().join("mine.toml")).unwrap();
        assert!(scenario.effects[0].parameters[0] > 0.0);
    }
}

#[test]
fn a_report_shows_the_formula_with_its_value() {
    let dir = tempfile::tempdir().unwrap();
    let text = MINE
        .replace("k5 = { value = \"0 N/m^5\" }", "k5 = \"1e20 N/m^5\"")
        .replace("[measurement]\nfile = \"table.csv\"", "[sweep]\nfrequency = [79, 80, 81]\ndrive = \"1 N\"")
        .replace("[fit]\nfree = [\"rig.natural_frequency\", \"rig.quality_factor\"]\n", "");
    std::fs::write(dir.path().join("mine.toml"), text).unwrap();
    stickslip(dir.path()).args(["run", "mine.toml", "--out", "drawn", "--quiet"]).assert().success();
    stickslip(dir.path()).args(["report", "mine.toml", "--out", "told", "--quiet"]).assert().success();
    let report = std::fs::read_to_string(dir.path().join("told/report.json")).unwrap();
    assert!(report.contains("effect.my-quintic.k5") && report.contains("1e20 N/m^5"), "{report}");
    assert!(report.contains("strength of the force -k5*x^5"), "{report}");
}
