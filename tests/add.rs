//! `stickslip add` as a user meets it, on a part of a practice table.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use std::path::Path;

fn stickslip(dir: &Path) -> Command {
    let mut command = Command::cargo_bin("stickslip").unwrap();
    command.current_dir(dir);
    command
}

/// Four conditions of practice table 1, every second frequency.
fn table() -> String {
    let text = include_str!("data/practice-1.csv");
    let wanted = ["0.0,20.0,2.5e-06", "0.0005,20.0,2.5e-06", "0.02,20.0,2.5e-06", "0.1,20.0,2.5e-06"];
    let mut lines: Vec<&str> = text.lines().take(1).collect();
    for condition in wanted {
        lines.extend(text.lines().filter(|line| line.starts_with(&format!("{condition},"))).step_by(2));
    }
    assert_eq!(lines.len(), 1 + 4 * 12);
    lines.join("\n") + "\n"
}

const PARENT: &str = r#"title = "Parent"
[rig]
inertia = "5.0e-3 kg m^2"
torsional_stiffness = "990 N m/rad"
torsional_damping = 0.43
spring_stiffness = "1.6e4 N/m"
spring_damping = "12 N s/m"
spring_arm = "30 mm"
contact_arm = "60 mm"
[contact]
stiffness = "8.9e4 N/m"
damping = 26
friction = 0.5
"#;

const MINE: &str = r#"# My measurements.
extends = "parent.toml"
title = "Mine"   # a title

[contact]
damping = "26 N s/m"   # cc

[measurement]
file = "table.csv"

[fit]
free = ["contact.stiffness", "contact.damping"]  # of the contact
"#;

fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in [("parent.toml", PARENT), ("mine.toml", MINE), ("table.csv", &table())] {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    dir
}

fn read(dir: &Path, name: &str) -> String {
    std::fs::read_to_string(dir.join(name)).unwrap()
}

/// chi2 per reading that `compare` finds.
fn chi2(dir: &Path, name: &str) -> f64 {
    let output = stickslip(dir).args(["compare", name, "--json", "-"]).output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    json["chi2_per_point"].as_f64().unwrap()
}

/// chi2 per reading before and after, as `add` prints them.
fn printed(output: &[u8]) -> [f64; 2] {
    let text = String::from_utf8(output.to_vec()).unwrap();
    let line = text.lines().find(|line| line.contains("chi2 per reading  ")).unwrap_or_else(|| panic!("{text}"));
    let mut numbers = line.split_whitespace().filter_map(|word| word.parse().ok());
    [numbers.next().unwrap(), numbers.next().unwrap()]
}

#[test]
fn add_then_compare_then_remove() {
    let dir = folder();
    let dir = dir.path();
    let before = chi2(dir, "mine.toml");
    let output = stickslip(dir).args(["add", "rate-strengthening", "mine.toml"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("wrote mine.toml") && text.contains("the data are for this effect"), "{text}");
    assert!(text.contains("where it failed before, and what became of it:\n  V = 0.5 mm/s, W = 20 N"), "{text}");
    let [printed_before, after] = printed(&output.stdout);
    assert!((printed_before - before).abs() <= 0.0051, "{printed_before} {before}");
    let now = chi2(dir, "mine.toml");
    assert!((after - now).abs() <= 0.011 && (0.7..1.4).contains(&now), "{after} {now}");

    let mine = read(dir, "mine.toml");
    assert!(
        mine.starts_with("# My measurements.\nextends = \"parent.toml\"\ntitle = \"Mine\"   # a title\n"),
        "{mine}"
    );
    assert!(
        mine.contains(" N s/m\"   # cc; 95 %: ")
            && mine.contains("\nstiffness = \"8.")
            && mine.contains("e4 N/m\"  # 95 %: "),
        "{mine}"
    );
    assert!(mine.contains("\"effect.rate-strengthening.v_0\"]  # of the contact\n"), "{mine}");
    assert_eq!((read(dir, "parent.toml").as_str(), read(dir, "table.csv")), (PARENT, table()));

    stickslip(dir)
        .args(["add", "rate-strengthening", "mine.toml"])
        .assert()
        .code(2)
        .stderr(contains("already").and(contains("--remove")));
    // A second effect goes beside the first; the data have no need of it.
    stickslip(dir)
        .args(["add", "sensor-delay", "mine.toml", "--dry-run"])
        .assert()
        .success()
        .stdout(contains("+name = \"sensor-delay\""));

    let output = stickslip(dir).args(["add", "rate-strengthening", "mine.toml", "--remove"]).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stdout).contains("the data need this effect"));
    let [_, after] = printed(&output.stdout);
    assert!((after - before).abs() <= 0.01 * before, "{after} {before}");
    let back: Vec<String> = read(dir, "mine.toml")
        .lines()
        .filter(|line| !line.contains("stiffness = "))
        .map(|line| if line.starts_with("damping") { "damping = \"26 N s/m\"   # cc".into() } else { line.into() })
        .collect();
    assert_eq!(back, MINE.lines().collect::<Vec<_>>());
}

#[test]
fn elsewhere_the_paths_still_lead_to_the_files() {
    let dir = tempfile::tempdir().unwrap();
    let root = dir.path().join("scenarios");
    std::fs::create_dir_all(root.join("other")).unwrap();
    for (name, text) in [("parent.toml", PARENT), ("mine.toml", MINE), ("table.csv", &table())] {
        std::fs::write(root.join(name), text.replace('\n', "\r\n")).unwrap();
    }
    let inputs = |name: &str| std::fs::read(root.join(name)).unwrap();
    let before = ["parent.toml", "mine.toml", "table.csv"].map(inputs);
    let add = ["add", "rate-strengthening", "mine.toml", "-o"];
    stickslip(&root).args(add).arg("other/new.toml").assert().success();
    let new = read(&root, "other/new.toml");
    assert!(new.contains("extends = \"../parent.toml\"\r\n") && new.contains("file = \"../table.csv\"\r\n"), "{new}");
    assert!(!new.replace("\r\n", "").contains('\n'));
    stickslip(&root).args(["check", "other/new.toml"]).assert().success();
    // Again, over a scenario.
    stickslip(&root).args(add).args(["other/new.toml", "--quiet"]).assert().success().stdout("");
    // What would be destroyed, or could not find its parent, is refused before any fit.
    for input in ["table.csv", "parent.toml", "./other/../parent.toml"] {
        stickslip(&root).args(add).arg(input).assert().code(2).stderr(contains("is an input"));
    }
    std::fs::write(root.join("notes.txt"), "mine").unwrap();
    stickslip(&root).args(add).arg("notes.txt").assert().code(2).stderr(contains("not a scenario"));
    // Nor is a scenario of other measurements.
    std::fs::write(root.join("theirs.csv"), table()).unwrap();
    std::fs::write(root.join("theirs.toml"), MINE.replace("table.csv", "theirs.csv")).unwrap();
    stickslip(&root).args(add).arg("theirs.toml").assert().code(2).stderr(contains("of other measurements"));
    assert!(read(&root, "theirs.toml").contains("theirs.csv"));
    stickslip(&root).args(add).arg("none/new.toml").assert().code(2).stderr(contains("no folder"));
    std::fs::create_dir(dir.path().join("away")).unwrap();
    stickslip(&root).args(add).arg("../away/new.toml").assert().code(2).stderr(contains("`extends` leaves"));
    assert!(!dir.path().join("away/new.toml").exists() && read(&root, "notes.txt") == "mine");
    assert_eq!(["parent.toml", "mine.toml", "table.csv"].map(inputs), before);
}

#[test]
fn an_effect_that_leaves_points_without_a_state_is_not_what_the_data_are_for() {
    let dir = folder();
    // In slip at these speeds a falling friction shakes the arm by itself.
    let output = stickslip(dir.path()).args(["add", "stribeck", "mine.toml", "--dry-run"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(!text.contains("NaN") && !text.contains("the data are for this effect"), "{text}");
}

#[test]
fn a_dry_run_shows_the_difference_and_writes_nothing() {
    let dir = folder();
    let dir = dir.path();
    let output = stickslip(dir).args(["add", "rate-strengthening", "mine.toml", "--dry-run"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    for line in ["--- mine.toml\n", "+++ mine.toml\n", "\n-damping = \"26 N s/m\"   # cc\n", "\n+[[effect]]\n"] {
        assert!(text.contains(line), "{line:?} in {text}");
    }
    assert!(!text.contains("wrote"));
    assert_eq!(read(dir, "mine.toml"), MINE);
    assert_eq!(std::fs::read_dir(dir).unwrap().count(), 3);
}

#[test]
fn what_cannot_be_done_is_told_before_the_fit() {
    let dir = folder();
    let dir = dir.path();
    let refused = |args: &[&str], told: &str| {
        stickslip(dir).arg("add").args(args).assert().code(2).stderr(contains(told));
    };
    refused(&["rate-strenghtening", "mine.toml"], "did you mean `rate-strengthening`?");
    refused(&["grosch", "mine.toml", "--remove"], "no effect `grosch` to take out");
    refused(&["grosch", "parent.toml"], "neither [sweep] nor [measurement]");
    let sweep = "[sweep]\nfrequency = 72\nspeed = 0\nload = 20\ndrive = \"2.5 um\"\n";
    std::fs::write(dir.join("sweep.toml"), format!("{PARENT}{sweep}")).unwrap();
    refused(&["grosch", "sweep.toml"], "names no measurements");
    let lugre = stickslip::effects::find("lugre").unwrap();
    let lines: String = lugre
        .parameters()
        .iter()
        .zip(stickslip::effects::typical(lugre))
        .map(|(info, value)| format!("{} = {value:e}\n", info.key))
        .collect();
    std::fs::write(dir.join("lugre.toml"), format!("{MINE}[[effect]]\nname = \"lugre\"\n{lines}")).unwrap();
    refused(&["partial-slip", "lugre.toml"], "`lugre` and `partial-slip` cannot be combined");
    std::fs::write(dir.join("child.toml"), "extends = \"lugre.toml\"\ntitle = \"Child\"\n").unwrap();
    refused(&["stribeck", "child.toml"], "lugre.toml, which it extends");
    refused(&["lugre", "child.toml", "--remove"], "lugre.toml, which it extends");
    std::fs::write(
        dir.join("paper.toml"),
        format!("{MINE}{}", sweep.replace("speed", "formulation = \"paper\"\nspeed")),
    )
    .unwrap();
    refused(&["stribeck", "paper.toml"], "published procedure");
    assert_eq!(read(dir, "mine.toml"), MINE);
}

/// A number at which others are stated is written, and no fit moves it.
#[test]
fn a_held_parameter_is_written_and_not_freed() {
    let dir = folder();
    let dir = dir.path();
    let output = stickslip(dir).args(["add", "load-stiffening", "mine.toml"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mine = read(dir, "mine.toml");
    assert!(mine.contains("\nN_ref = \"20 N\"  # 95 %: held"), "{mine}");
    assert!(mine.contains("\"effect.load-stiffening.m\"]") && !mine.contains("load-stiffening.N_ref"), "{mine}");
    let free = mine.replace("load-stiffening.m\"", "load-stiffening.N_ref\"");
    std::fs::write(dir.join("free.toml"), free).unwrap();
    stickslip(dir).args(["check", "free.toml"]).assert().code(2).stderr(contains("load-stiffening.N_ref"));
}

#[test]
fn what_a_search_asks_for_is_named_and_told() {
    let dir = folder();
    let dir = dir.path();
    let search = |list: &str| {
        let mut command = stickslip(dir);
        command.args(["discover", "mine.toml", "--max-effects", "1", "--json", "-", "--candidates", list]);
        command
    };
    search("stribeck,viscus-film").assert().code(2).stderr(contains("did you mean `viscous-film`"));
    let output = search("viscous-film,sensor-delay").output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["asked"], serde_json::json!(["viscous-film", "sensor-delay"]));
    let names: Vec<&str> = json["candidates"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|c| c["effects"].as_array().unwrap())
        .filter_map(|name| name.as_str())
        .collect();
    assert!(names.contains(&"viscous-film") && !names.contains(&"rate-strengthening"), "{names:?}");
}

/// A mass on a linear spring by its closed form, read with one per cent of scatter.
fn linear(dir: &Path) {
    let (mass, f0, quality) = (0.1, 100.0, 40.0);
    let w0 = std::f64::consts::TAU * f0;
    let mut text = String::from("force_N,frequency_Hz,amplitude_m,phase_rad\n");
    for (index, (force, step)) in
        [0.05, 0.2].iter().flat_map(|force| (0..25).map(move |step| (force, step))).enumerate()
    {
        let w = std::f64::consts::TAU * (94.0 + 0.5 * f64::from(step));
        let (re, im) = (mass * (w0 * w0 - w * w), mass * w0 / quality * w);
        let square = ((index + 1) * (index + 1)) as f64;
        let [scatter, turn] = [1.7 * square, 2.3 * square + 1.0].map(|angle: f64| 0.01 * angle.sin());
        let amplitude = force / re.hypot(im) * (1.0 + scatter);
        text += &format!("{force},{},{amplitude:e},{}\n", 94.0 + 0.5 * f64::from(step), turn - im.atan2(re));
    }
    std::fs::write(dir.join("linear.csv"), text).unwrap();
    stickslip(dir).args(["new", "linear.csv", "-o", "linear.toml"]).assert().success();
}

/// Residuals that are far off count little, so that Schwarz's criterion may fall while everything rises.
#[test]
fn an_effect_with_which_chi2_and_error_are_larger_is_not_decided_for() {
    let folder = tempfile::tempdir().expect("a folder");
    linear(folder.path());
    let scenario = stickslip::scenario::load(folder.path().join("linear.toml")).unwrap_or_else(|e| panic!("{e}"));
    let table = stickslip::measurement::load(&scenario).unwrap_or_else(|e| panic!("{e}")).expect("measurements");
    let effect = stickslip::effects::find("cubic-stiffness").expect("registered");
    let mut change = stickslip::discover::fit_addition(&scenario, &table, effect, 0);
    change.gain = 60.0;
    for (chi2, error, decided) in [(0.9, 0.9, Some(true)), (1.1, 0.9, Some(true)), (1.1, 1.1, None)] {
        change.after.overall.chi2_per_point = chi2 * change.before.overall.chi2_per_point;
        change.after.overall.rms_error_percent = error * change.before.overall.rms_error_percent;
        assert_eq!(change.decided(), decided, "{chi2} {error}");
    }
}

#[test]
fn an_interval_of_what_is_not_there_holds_both_signs() {
    let dir = tempfile::tempdir().unwrap();
    linear(dir.path());
    let add = stickslip(dir.path()).args(["add", "cubic-stiffness", "linear.toml", "--dry-run"]).output().unwrap();
    let text = String::from_utf8(add.stdout).unwrap();
    let cubic =
        text.lines().find(|line| line.contains("effect.cubic-stiffness.K_3 = ")).unwrap_or_else(|| panic!("{text}"));
    let numbers: Vec<f64> = cubic.split([' ', '(']).filter_map(|word| word.parse().ok()).collect();
    let [value, low, high] = numbers[..] else { panic!("{cubic}") };
    assert!(low < 0.0 && 0.0 < high && low < value && value < high, "{cubic}");
    // As far to one side as to the other: the model is linear about zero.
    assert!(((high - value) / (value - low) - 1.0).abs() < 0.3, "{cubic}");
}

#[test]
fn an_estimate_is_held_against_the_same_readings() {
    let dir = tempfile::tempdir().unwrap();
    linear(dir.path());
    let found = stickslip(dir.path()).args(["discover", "linear.toml", "--json", "-"]).output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
    let chi2 = |name: Option<&str>| {
        let is = |c: &&serde_json::Value| {
            let names: Vec<&str> = c["effects"].as_array().unwrap().iter().filter_map(|e| e.as_str()).collect();
            names == name.as_slice() && c["recalibrate"].as_array().is_none_or(Vec::is_empty)
        };
        let candidates = json["candidates"].as_array().unwrap();
        candidates.iter().find(is).unwrap_or_else(|| panic!("{name:?}"))["chi2_per_point"].as_f64().unwrap()
    };
    // A fit to all readings takes off 0.01; the readings that were looked at happen to scatter less than all by 0.08.
    assert!((chi2(None) - chi2(Some("cubic-stiffness"))).abs() < 0.05);
}
