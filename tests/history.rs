//! A report held against an earlier one and against all earlier ones.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use std::path::Path;

const SWEEP: &str = "\n[sweep]\nfrequency = { from = \"60 Hz\", to = \"90 Hz\", points = 16 }\n\
                     speed = [\"0.05 mm/s\", \"20 mm/s\"]\nload = \"20 N\"\ndrive = \"2.5 um\"\n";

fn stickslip(dir: &Path) -> Command {
    let mut command = Command::cargo_bin("stickslip").unwrap();
    command.current_dir(dir).env("SOURCE_DATE_EPOCH", "0").env("XDG_CACHE_HOME", dir.join("home"));
    command
}

/// A scenario with a sweep and a table of few readings, its report in the folder `base`.
fn prepare(dir: &Path) {
    let embedded = |name: &str| stickslip::scenario::embedded_file(name).unwrap();
    let lines = embedded("practice/4/measurements.csv").lines().enumerate().filter(|(number, _)| number % 6 == 0);
    std::fs::write(dir.join("table.csv"), lines.map(|(_, line)| line).collect::<Vec<_>>().join("\n")).unwrap();
    let text = embedded("practice/4/scenario.toml").replace("measurements.csv", "table.csv");
    std::fs::write(dir.join("rig.toml"), text + SWEEP).unwrap();
    report(dir, &["--out", "base"]).assert().success();
}

fn report(dir: &Path, more: &[&str]) -> Command {
    let mut command = stickslip(dir);
    command.args(["report", "rig.toml"]).args(more);
    command
}

fn read(dir: &Path, name: &str) -> String {
    std::fs::read_to_string(dir.join(name)).unwrap()
}

fn parsed(dir: &Path, name: &str) -> Value {
    serde_json::from_str(&read(dir, name)).unwrap()
}

/// Changes a report of the folder `base` by hand.
fn alter(dir: &Path, change: impl FnOnce(&mut Value)) {
    let mut view = parsed(dir, "base/report.json");
    change(&mut view);
    std::fs::write(dir.join("base/report.json"), view.to_string()).unwrap();
}

#[test]
fn what_improved_and_what_regressed_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let same = ["--baseline", "base", "--no-regression"];
    report(dir, &same).assert().success().stdout(contains("The inputs are the same").and(contains("changed:").not()));
    let view = parsed(dir, "output/report.json");
    assert_eq!((&view["baseline"]["changes"], &view["baseline"]["pictures"]), (&json!([]), &json!([])));
    assert_eq!(view["gates"][0]["verdict"], "gate passed");
    assert!(read(dir, "output/report.html").contains("id=\"baseline\""));

    alter(dir, |view| {
        let scenario = &mut view["scenarios"][0];
        for (pointer, factor) in [("/comparison/overall/chi2", 0.5), ("/comparison/overall/error", 3.0)] {
            let value = scenario.pointer_mut(pointer).unwrap().get_mut("value").unwrap();
            *value = json!(value.as_f64().unwrap() * factor);
        }
        // Less than counts as a difference.
        let after = &mut scenario["discovery"]["after"]["value"];
        *after = json!(after.as_f64().unwrap() * 1.0005);
        scenario["discovery"]["verdict"] = json!("unexplained");
        view["verification"][0]["name"] = json!("A check of old");
    });
    report(dir, &same)
        .assert()
        .code(1)
        .stdout(
            contains("regressed: rig: χ² per reading, calibrated")
                .and(contains("improved: rig: discovery: unexplained")),
        )
        .stderr(contains("base: no_regression: 1 regressed, 1 gone; demanded: none"));
    let changes = parsed(dir, "output/report.json")["baseline"]["changes"].clone();
    let verdicts: Vec<_> =
        changes.as_array().unwrap().iter().map(|change| change["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["regressed", "gone", "new", "improved", "improved"]);
    assert_eq!(changes[0]["by"], "+100 %");
    // The same page again from its JSON.
    let page = read(dir, "output/report.html");
    stickslip(dir).args(["--from", "output", "--out", "again"]).assert().code(1);
    assert!(read(dir, "again/report.html") == page);
    // Without the gate a regression is told and does not fail.
    report(dir, &["--baseline", "base/report.json"]).assert().success().stdout(contains("1 regressed"));
}

#[test]
fn curves_pictures_and_inputs_that_differ_are_shown() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let text = read(dir, "rig.toml");
    assert!(text.contains("torsional_stiffness = 990"));
    std::fs::write(dir.join("rig.toml"), text.replace("torsional_stiffness = 990", "torsional_stiffness = 1020"))
        .unwrap();
    report(dir, &["--baseline", "base"])
        .assert()
        .success()
        .stdout(contains("input rig (rig.toml) has other values: rig.torsional_stiffness: 990 N m/rad → 1020 N m/rad"));
    let view = parsed(dir, "output/report.json");
    let baseline = &view["baseline"];
    assert_eq!(baseline["inputs"][0]["id"], "rig");
    assert_eq!(baseline["figures"][0]["name"], "baseline");
    assert!(dir.join("output/baseline/rig/baseline.png").is_file());
    let csv = read(dir, "output/baseline/rig/baseline.csv");
    assert_eq!(csv.lines().count(), 1 + 2 * 2 * 16, "{csv}");
    let pictures = baseline["pictures"].as_array().unwrap();
    let before = pictures.iter().find(|picture| picture["before"] == "baseline/rig/resonance.svg").unwrap();
    assert_eq!(read(&dir.join("output"), before["before"].as_str().unwrap()), read(dir, "base/rig/resonance.svg"));
    let page = read(dir, "output/report.html");
    assert!(page.contains("class=\"swap\"") && page.contains("rig.torsional_stiffness: 990 N m"));

    // The same page again from its JSON, and nothing in a JSON that was changed leads out of its folder.
    stickslip(dir).args(["--from", "output", "--out", "again"]).assert().success();
    assert!(read(dir, "again/report.html") == page);
    let text = read(dir, "output/report.json");
    let outside = text.replace("\"before\": \"baseline/rig/resonance.svg\"", "\"before\": \"../rig/resonance.svg\"");
    assert!(outside != text);
    std::fs::write(dir.join("output/outside.json"), outside).unwrap();
    stickslip(dir).args(["--from", "output/outside.json"]).assert().code(2).stderr(contains("outside its folder"));

    // The same input, the same bytes; the folder of the results may be the baseline itself.
    report(dir, &["--baseline", "base", "--out", "other"]).assert().success();
    assert!(read(dir, "other/report.html") == page);
    report(dir, &["--baseline", "output"]).assert().success().stdout(contains("The inputs are the same"));

    // Numbers alone are a baseline too.
    std::fs::copy(dir.join("base/report.json"), dir.join("alone.json")).unwrap();
    report(dir, &["--baseline", "alone.json"]).assert().success().stdout(contains("One input differs"));
}

#[test]
fn what_is_no_baseline_is_refused_before_anything_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let whole = read(dir, "base/report.json");
    for (name, text) in [
        ("empty", String::new()),
        ("cut", whole[..whole.len() / 2].to_string()),
        ("schema", whole.replace("stickslip.report/1", "stickslip.report/9")),
        ("outside", whole.replace("\"rig/overlay.svg\"", "\"../../etc/overlay.svg\"")),
    ] {
        let file = format!("{name}.json");
        std::fs::write(dir.join(&file), text).unwrap();
        report(dir, &["--baseline", &file]).assert().code(2).stderr(contains(file).and(contains("help: ")));
    }
    report(dir, &["--baseline", "nowhere"]).assert().code(2).stderr(contains("nowhere"));
    report(dir, &["--no-regression"]).assert().code(2).stderr(contains("--baseline"));
    assert!(!dir.join("output").exists());
    // A scenario of the earlier run that is named to lead out of its folder has no curves, and does no harm.
    alter(dir, |view| view["scenarios"][0]["id"] = json!("../../rig"));
    report(dir, &["--baseline", "base"]).assert().success();
    assert!(!dir.join("../rig").exists());
}

#[test]
fn a_baseline_is_accepted_after_its_difference_is_shown() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let accept = |more: &[&str]| {
        let mut command = stickslip(dir);
        command.args(["accept", "base", "--baseline", "accepted"]).args(more);
        command
    };
    accept(&["--dry-run"]).assert().success().stdout(contains("holds no baseline yet").and(contains("dry run")));
    assert!(!dir.join("accepted").exists());
    accept(&[]).assert().success().stdout(contains("accepted: "));
    for name in ["report.json", "rig/resonance.svg", "rig/curves.csv"] {
        assert!(read(dir, &format!("accepted/{name}")) == read(dir, &format!("base/{name}")), "{name}");
    }
    report(dir, &["--baseline", "accepted", "--no-regression"]).assert().success();
    alter(dir, |view| view["scenarios"][0]["comparison"]["overall"]["chi2"]["value"] = json!(1e3));
    let before = read(dir, "accepted/report.json");
    accept(&["--dry-run"]).assert().success().stdout(contains("regressed: rig: χ² per reading, calibrated"));
    assert!(read(dir, "accepted/report.json") == before);
    accept(&[]).assert().success().stdout(contains("regressed: rig"));
    assert!(read(dir, "accepted/report.json") == read(dir, "base/report.json"));
    stickslip(dir)
        .args(["accept", "base", "--baseline", "base"])
        .assert()
        .code(2)
        .stderr(contains("the report itself"));
    stickslip(dir).args(["accept", "nothing"]).assert().code(2).stderr(contains("nothing"));
    stickslip(dir).args(["accept", "base", "--baseline", "rig.toml"]).assert().code(2).stderr(contains("not a folder"));
}

#[test]
fn a_history_grows_by_a_line_per_run_and_tells_where_values_stepped() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    report(dir, &["--history", "runs"]).assert().success().stdout(contains("This is the first run."));
    let line = read(dir, "runs/history.jsonl");
    let record: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(
        (record["schema"].as_str(), record["seconds"].as_object().unwrap().len()),
        (Some("stickslip.history/1"), 0)
    );
    let error = record["errors"]["rig: calibrated"].as_f64().unwrap();
    // Five runs with half the error before this one, and another peak of one curve.
    let mut earlier = record.clone();
    earlier["errors"]["rig: calibrated"] = json!(0.5 * error);
    for peak in earlier["peaks"].as_object_mut().unwrap().values_mut() {
        *peak = json!(peak.as_f64().unwrap() + 4.0);
    }
    let lines = format!("{earlier}\n").repeat(5) + &line;
    std::fs::write(dir.join("runs/history.jsonl"), &lines).unwrap();
    report(dir, &["--history", "runs"])
        .assert()
        .success()
        .stdout(contains("rig: calibrated: rms error of the amplitude").and(contains("(+100 %) since run 6")));
    let view = parsed(dir, "output/report.json");
    let steps = view["history"]["steps"].as_array().unwrap();
    assert!(steps.iter().any(|step| step["verdict"] == "regressed" && step["run"] == 6), "{steps:?}");
    assert!(steps.iter().filter(|step| step["verdict"] == "changed").count() >= 2, "{steps:?}");
    assert!(dir.join("output/history/trend.svg").is_file() && view["provenance"]["times"].is_null());
    assert_eq!(read(dir, "runs/history.jsonl"), lines + &line);

    // A bad line is named, nothing is written, and the file stays as it is.
    let bad = format!("{line}not a record\n");
    std::fs::create_dir(dir.join("bad")).unwrap();
    std::fs::write(dir.join("bad/history.jsonl"), &bad).unwrap();
    report(dir, &["--history", "bad", "--out", "none"])
        .assert()
        .code(2)
        .stderr(contains("history.jsonl:2: this line is not the record of a run").and(contains("help: ")));
    assert!(!dir.join("none").exists() && read(dir, "bad/history.jsonl") == bad);
    report(dir, &["--history", "rig.toml"]).assert().code(2).stderr(contains("not a folder"));
}

#[test]
fn two_runs_at_once_leave_two_whole_lines() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let start = |out: &str| {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("stickslip"));
        command.current_dir(dir).env("XDG_CACHE_HOME", dir.join("home")).stdout(std::process::Stdio::null());
        command.args(["report", "rig.toml", "--history", "runs", "--out", out]).spawn().unwrap()
    };
    let both = [start("one"), start("two"), start("three")];
    for mut process in both {
        assert!(process.wait().unwrap().success());
    }
    let text = read(dir, "runs/history.jsonl");
    assert!(text.ends_with('\n') && text.lines().count() == 3);
    assert!(text.lines().all(|line| serde_json::from_str::<Value>(line).is_ok()));
}
