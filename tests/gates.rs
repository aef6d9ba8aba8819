//! Gates: what a scenario or the command line demands decides the exit status; everything is written all the same.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::path::Path;

fn stickslip(dir: &Path) -> Command {
    let mut command = Command::cargo_bin("stickslip").unwrap();
    command.current_dir(dir).env("SOURCE_DATE_EPOCH", "0").env("XDG_CACHE_HOME", dir);
    command
}

/// A scenario with a table of few readings, `gate` at its end.
fn measured(dir: &Path, gate: &str) {
    let table = stickslip::scenario::embedded_file("practice/4/measurements.csv").unwrap();
    let lines = table.lines().enumerate().filter(|(number, _)| number % 4 == 0).map(|(_, line)| line);
    std::fs::write(dir.join("table.csv"), lines.collect::<Vec<_>>().join("\n")).unwrap();
    let text = stickslip::scenario::embedded_file("practice/4/scenario.toml").unwrap();
    let text = text.replace("measurements.csv", "table.csv");
    std::fs::write(dir.join("rig.toml"), format!("{text}\n{gate}")).unwrap();
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn compare_holds_to_the_gates_of_the_scenario_and_the_command_line() {
    let dir = tempfile::tempdir().unwrap();
    measured(
        dir.path(),
        "[gate]\nmax_rms_error = \"30 %\"\nmax_chi2_per_point = 1e6\namplitude_tolerance = \"1e-3 %\"\nphase_tolerance = \"3 rad\"\n",
    );
    let arguments = ["compare", "rig.toml", "--json", "c.json", "--out", "o"];
    stickslip(dir.path())
        .args(arguments)
        .assert()
        .code(1)
        .stdout(contains("gates: 3 of 4 passed"))
        .stderr(contains("1 of 4 gates failed").and(contains("amplitude_tolerance").and(contains("at row"))));
    assert!(dir.path().join("o/rig/overlay.svg").is_file());
    let c = json(&dir.path().join("c.json"));
    assert_eq!((c["schema"].as_str(), c["comparator"].as_str()), (Some("stickslip.comparison/1"), Some("7")));
    let holds: Vec<_> = c["gates"].as_array().unwrap().iter().map(|gate| gate["holds"].as_bool().unwrap()).collect();
    assert_eq!(holds, [true, true, false, true]);
    measured(
        dir.path(),
        "[gate]\nmax_rms_error = \"30 %\"\namplitude_tolerance = \"0 %\"\namplitude_floor = \"1 mrad\"",
    );
    stickslip(dir.path()).args(["compare", "rig.toml"]).assert().success();
    let limits = ["compare", "rig.toml", "--max-rms-error", "1e-6 %", "--max-chi2", "0.001", "--json", "-"];
    let failed = stickslip(dir.path()).args(limits).assert().code(1).stderr(contains("2 of 3 gates failed"));
    let text = &failed.get_output().stdout;
    assert!(serde_json::from_slice::<Value>(text).is_ok(), "nothing but JSON on standard output");
}

#[test]
fn bad_limits_are_told_before_anything_is_done() {
    let dir = tempfile::tempdir().unwrap();
    measured(dir.path(), "");
    let told = |arguments: &[&str], what: &str| {
        stickslip(dir.path()).args(arguments).assert().code(2).stderr(contains(what.to_string()));
    };
    told(&["compare", "rig.toml", "--max-rms-error", "5 mm"], "a share such as '5 %'");
    told(&["compare", "rig.toml", "--max-chi2", "NaN"], "a number such as 1.5");
    told(&["discover", "rig.toml", "--verdict", "nothing-missin"], "nothing-missing");
    stickslip(dir.path()).arg("init").assert().success();
    told(&["report", "my-rig.toml", "--max-chi2", "2"], "no scenario names measurements");
    measured(dir.path(), "[gate]\nclaims = [\"full-slip-equals-no-contcat\"]");
    told(&["report", "rig.toml"], "did you mean `full-slip-equals-no-contact`?");
    told(&["check", "rig.toml"], "did you mean `full-slip-equals-no-contact`?");
    assert!(!dir.path().join("output").exists());
}

#[test]
fn a_report_tells_every_gate_and_exits_with_1_where_one_fails() {
    let dir = tempfile::tempdir().unwrap();
    measured(
        dir.path(),
        "[gate]\nmax_chi2_per_point = 5\nverdict = \"unexplained\"\nclaims = [\"full-slip-equals-no-contact\"]\n",
    );
    stickslip(dir.path())
        .args([
            "report",
            "rig.toml",
            "--max-rms-error",
            "1e-3 %",
            "--junit",
            "r/junit.xml",
            "--markdown",
            "r/summary.md",
        ])
        .assert()
        .code(1)
        .stderr(contains("max_rms_error").and(contains("verdict: nothing-missing; demanded: unexplained")));
    let report = json(&dir.path().join("output/report.json"));
    let verdicts: Vec<_> = report["gates"].as_array().unwrap().iter().map(|gate| gate["verdict"].as_str()).collect();
    assert_eq!(verdicts, [Some("gate failed"), Some("gate failed"), Some("gate passed"), Some("gate passed")]);
    assert!(report["summary"]["sentence"].as_str().unwrap().starts_with("2 of 4 gates failed. "));
    assert_eq!(report["provenance"]["comparator"], "7");
    let page = std::fs::read_to_string(dir.path().join("output/report.html")).unwrap();
    assert!(page.contains("gate failed") && page.contains("max_rms_error"));
    let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
    assert!(read("r/junit.xml").contains("<failure message=\"nothing-missing; demanded: unexplained\">"));
    assert!(read("r/summary.md").contains("| ✗ gate failed | rig | max\\_rms\\_error | "));

    // The page is made again from the JSON and the files beside it, byte for byte, and the gates fail again.
    std::fs::remove_file(dir.path().join("output/report.html")).unwrap();
    let again = ["report", "--from", "output/report.json", "--junit", "again.xml"];
    stickslip(dir.path()).args(again).assert().code(1).stderr(contains("2 of 4 gates failed"));
    assert!(read("output/report.html") == page && read("again.xml") == read("r/junit.xml"));
    stickslip(dir.path()).args(["--from", "output", "--out", "other"]).assert().code(1);
    assert!(read("other/report.html") == page);

    // Nothing in a report that was changed leads out of its folder.
    let text = read("output/report.json");
    for (name, from, to) in [
        ("outside", "\"name\": \"rig/overlay.svg\"", "\"name\": \"../../etc/overlay.svg\""),
        ("absolute", "\"name\": \"rig/overlay.csv\"", "\"name\": \"/etc/passwd\""),
        ("script", "\"anchor\": \"figure-rig-overlay\"", "\"anchor\": \"x\\\"><script>\""),
        ("schema", "stickslip.report/1", "stickslip.report/2"),
        ("cut", "\"glossary\"", "\"glosary\""),
    ] {
        assert!(text.contains(from), "{from}");
        let path = dir.path().join(format!("output/{name}.json"));
        std::fs::write(&path, text.replace(from, to)).unwrap();
        stickslip(dir.path()).arg("report").arg("--from").arg(&path).assert().code(2).stderr(contains("help: "));
    }
    std::fs::remove_file(dir.path().join("output/rig/overlay.svg")).unwrap();
    stickslip(dir.path()).args(["report", "--from", "output"]).assert().code(2).stderr(contains("overlay.svg"));
    assert!(read("output/report.html") == page);
    stickslip(dir.path()).args(["report", "rig.toml", "--junit", "table.csv"]).assert().code(2);
}

#[test]
fn a_comparison_says_which_gates_only_a_discovery_judges() {
    let dir = tempfile::tempdir().unwrap();
    measured(dir.path(), "[gate]\nmax_chi2_per_point = 5\nverdict = \"unexplained\"\n");
    stickslip(dir.path())
        .args(["compare", "rig.toml"])
        .assert()
        .success()
        .stdout(contains("gates: 1 of 1 passed").and(contains("not judged here: verdict of [gate]")));
}

#[test]
fn measurements_without_anything_free_can_be_searched() {
    let dir = tempfile::tempdir().unwrap();
    let from = Path::new("tests/data/practice/8");
    std::fs::copy(from.join("measurements.csv"), dir.path().join("measurements.csv")).unwrap();
    let text = std::fs::read_to_string(from.join("scenario.toml")).unwrap();
    let (before, after) = text.split_once("[fit]").unwrap();
    let rest = after.split_once("\n[").map_or(String::new(), |(_, rest)| format!("[{rest}"));
    std::fs::write(dir.path().join("rig.toml"), format!("{before}{rest}")).unwrap();
    stickslip(dir.path()).args(["discover", "rig.toml", "--max-effects", "1"]).assert().success();
}
