//! The command as a user meets it.

use assert_cmd::Command;
use predicates::prelude::*;
use std::path::Path;

fn stickslip(dir: &Path) -> Command {
    let mut command = Command::cargo_bin("stickslip").unwrap();
    command.current_dir(dir).env("SOURCE_DATE_EPOCH", "0").env("XDG_CACHE_HOME", dir);
    command
}

const SMALL: &str = r#"
title = "Small <b>& hostile</b>"
[rig]
inertia = "5.0e-3 kg m^2"
torsional_stiffness = "990 N m/rad"
torsional_damping = "0.43 N m s/rad"
spring_stiffness = "1.6e4 N/m"
spring_damping = "12 N s/m"
spring_arm = "30 mm"
contact_arm = "60 mm"
[contact]
stiffness = "8.9e4 N/m"
damping = "26 N s/m"
friction = 0.5
[sweep]
frequency = { from = "60 Hz", to = "90 Hz", points = 31 }
speed = ["0 mm/s", "0.05 mm/s", "0.1 mm/s", "20 mm/s"]
load = ["0 N", "20 N"]
drive = "2.5 um"
"#;

fn small(dir: &Path) {
    std::fs::write(dir.join("small.toml"), SMALL).unwrap();
}

/// Every result below a folder with its bytes.
fn contents(root: &Path) -> Vec<(String, Vec<u8>)> {
    let mut out = Vec::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|name| name != stickslip::results::LIST) {
                let name = path.strip_prefix(root).unwrap().display().to_string();
                out.push((name, std::fs::read(&path).unwrap()));
            }
        }
    }
    out.sort();
    out
}

#[test]
fn report_gives_the_same_bytes_for_any_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    small(dir.path());
    for threads in ["1", "2", "5"] {
        let out = format!("out{threads}");
        stickslip(dir.path())
            .args(["report", "small.toml", "--no-cache", "--out", &out, "--threads", threads])
            .assert()
            .success();
    }
    let one = contents(&dir.path().join("out1"));
    assert!(one.iter().any(|(name, _)| name == "report.html") && one.iter().any(|(name, _)| name.ends_with(".png")));
    for other in ["out2", "out5"] {
        for (a, b) in one.iter().zip(contents(&dir.path().join(other))) {
            assert_eq!(a.0, b.0);
            assert!(a.1 == b.1, "{} differs with more threads", a.0);
        }
    }
    let page = String::from_utf8(std::fs::read(dir.path().join("out1/report.html")).unwrap()).unwrap();
    assert!(page.contains("Small &lt;b&gt;&amp; hostile") && !page.contains("<b>& hostile"));
}

#[test]
fn run_writes_curves_whose_numbers_are_the_limiting_cases_at_the_ends() {
    let dir = tempfile::tempdir().unwrap();
    small(dir.path());
    stickslip(dir.path()).args(["run", "small.toml"]).assert().success();
    let text = std::fs::read_to_string(dir.path().join("output/small/curves.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 2 * 4 * 31);
    let amplitude = |load: &str, speed: &str, f: &str| -> f64 {
        rows.iter().find(|r| r[3] == load && r[5] == speed && r[6] == f).unwrap()[7].parse().unwrap()
    };
    // No contact and full slip are the same curve; static contact is stiffer: lower below its resonance.
    assert!((amplitude("0", "0e0", "71") / amplitude("20", "2e-2", "71") - 1.0).abs() < 1e-12);
    assert!(amplitude("20", "0e0", "71") < amplitude("20", "5e-5", "71"));
    assert!(rows.iter().all(|r| r[16] == "steady"));
}

#[test]
fn anywhere_without_a_scenarios_folder_the_built_in_ones_are_used() {
    let dir = tempfile::tempdir().unwrap();
    stickslip(dir.path()).arg("check").assert().success().stdout(predicate::str::contains("paper/figure-6"));
    stickslip(dir.path()).arg("init").assert().success();
    stickslip(dir.path()).args(["check", "my-rig.toml", "scenarios"]).assert().success();
    stickslip(dir.path()).arg("init").assert().code(2).stderr(predicate::str::contains("nothing was written"));
}

#[test]
fn bad_usage_and_bad_input_exit_with_2_and_write_nothing() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("bad.toml"), SMALL.replace("inertia", "inertai")).unwrap();
    let told = predicate::str::contains("bad.toml").and(predicate::str::contains("inertia"));
    stickslip(dir.path()).args(["run", "bad.toml"]).assert().code(2).stderr(told);
    stickslip(dir.path()).args(["run"]).assert().code(2);
    stickslip(dir.path()).args(["report", "missing.toml"]).assert().code(2);
    stickslip(dir.path()).args(["--threads", "0"]).assert().code(2);
    std::fs::write(dir.path().join("figure.toml"), SMALL.replacen("title", "figures = [\"ridge\"]\ntitle", 1)).unwrap();
    assert!(!dir.path().join("output").exists());
}

#[test]
fn a_figure_that_the_sweep_cannot_fill_is_an_error_that_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let text = SMALL.replacen("title", "figures = [\"loops\", \"formulations\"]\ntitle", 1);
    std::fs::write(dir.path().join("figure.toml"), text).unwrap();
    let told = predicate::str::contains("figure.toml").and(predicate::str::contains("formulations"));
    stickslip(dir.path()).args(["run", "figure.toml"]).assert().code(2).stderr(told);
}

/// A table of the readings that the base model would give, every third left out, with a bump where asked for.
fn measured(dir: &Path, phases: bool, bump: f64) {
    let table = stickslip::scenario::embedded_file("practice/4/measurements.csv").unwrap();
    let keep = if phases { 8 } else { 6 };
    let mut text = String::new();
    for (number, line) in table.lines().enumerate() {
        let mut cells: Vec<String> = line.split(',').take(keep).map(String::from).collect();
        if number % 3 == 2 {
            continue;
        }
        if number > 0 && cells[0] == "0.02" && cells[3].parse::<f64>().unwrap() > 70.0 {
            cells[4] = format!("{:e}", cells[4].parse::<f64>().unwrap() * (1.0 + bump));
        }
        text += &(cells.join(",") + "\n");
    }
    std::fs::write(dir.join("table.csv"), text).unwrap();
    let (head, _) = SMALL.split_once("[sweep]").unwrap();
    let rest = "[measurement]\nfile = \"table.csv\"\n[fit]\nfree = [\"contact.stiffness\", \"contact.damping\"]\n";
    std::fs::write(dir.join("measured.toml"), format!("{head}{rest}")).unwrap();
}

#[test]
fn compare_writes_the_json_that_scripts_read() {
    let dir = tempfile::tempdir().unwrap();
    measured(dir.path(), true, 0.1);
    let output = stickslip(dir.path()).args(["compare", "measured.toml", "--json", "-"]).output().unwrap();
    assert!(output.status.success());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("nothing but JSON on standard output");
    assert_eq!(json["schema"], "stickslip.comparison/1");
    for key in ["chi2_per_point", "rms_error_percent", "rms_phase_deg", "noise_percent"] {
        assert!(json[key].is_f64(), "{key}");
    }
    for key in ["conditions", "regions", "contact"] {
        assert!(json[key].as_array().is_some_and(|list| !list.is_empty()), "{key}");
    }
    for key in ["chi2_per_point", "rms_error_percent", "noise_percent", "model_peak", "measured_peak", "load_n"] {
        assert!(!json["conditions"][4][key].is_null(), "{key}");
    }
    let region = &json["regions"][0];
    for key in ["frequency_from_hz", "frequency_to_hz", "mean_residual_sigma", "mean_residual_percent", "share_of_chi2"]
    {
        assert!(region[key].is_f64(), "{key}");
    }
    assert!(region["sentence"].as_str().unwrap().contains("too low") && region["speed"] == 0.02);
    for key in ["numerical_percent", "noise_percent", "model_percent"] {
        assert!(json["error_budget"][key].is_f64(), "{key}");
    }
    assert!(json["contact"][0]["stiffness_sd_n_m"].as_f64().unwrap() > 0.0);
    assert!(!dir.path().join("output").exists());
}

#[test]
fn compare_draws_where_asked_and_leaves_out_what_needs_phases() {
    let dir = tempfile::tempdir().unwrap();
    measured(dir.path(), true, 0.0);
    stickslip(dir.path())
        .args(["compare", "measured.toml", "--out", "figures"])
        .assert()
        .success()
        .stdout(predicate::str::contains("looks like noise").and(predicate::str::contains("overlay.svg")));
    let names: Vec<String> = contents(&dir.path().join("figures")).into_iter().map(|(name, _)| name).collect();
    for figure in ["overlay", "overlay-phase", "misfit-map", "contact-fingerprint", "contact-amplitude", "peaks"] {
        for kind in ["svg", "png", "csv"] {
            assert!(names.contains(&format!("measured/{figure}.{kind}")), "{figure}.{kind} in {names:?}");
        }
    }
    let narrow = ["overlay", "misfit-map"].map(|figure| format!("measured/{figure}-narrow.svg"));
    let others = ["report.html", "report.json"].map(String::from).into_iter().chain(narrow);
    assert!(others.into_iter().all(|name| names.contains(&name)), "{names:?}");
    assert_eq!(names.len(), 25);
}

#[test]
fn a_scenario_with_nothing_but_measurements_is_reported_and_run() {
    let dir = tempfile::tempdir().unwrap();
    measured(dir.path(), true, 0.1);
    stickslip(dir.path()).args(["run", "measured.toml"]).assert().success();
    assert!(dir.path().join("output/measured/misfit-map.png").is_file());
    assert!(!dir.path().join("output/measured/curves.csv").exists());
    stickslip(dir.path())
        .args(["report", "measured.toml"])
        .assert()
        .success()
        .stdout(predicate::str::contains("within the noise in 0 of 1 comparison"))
        .stderr(predicate::str::contains("warning").not());
    let page = std::fs::read_to_string(dir.path().join("output/report.html")).unwrap();
    assert!(page.contains("structured misfit") && page.contains("Small &lt;b&gt;&amp; hostile"));
    let json = std::fs::read_to_string(dir.path().join("output/report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let comparison = &json["scenarios"][0]["comparison"];
    assert_eq!(comparison["verdict"], "structured misfit");
    let discovery = &json["scenarios"][0]["discovery"];
    assert_eq!(json["summary"]["compared"][0]["anchor"], discovery["anchor"]);
    assert_eq!(json["summary"]["compared"][0]["verdict"], discovery["verdict"]);
    assert!(discovery["candidates"].as_array().is_some_and(|list| list.len() > 5));
    assert_eq!(comparison["parameters"][0]["identified"], "yes");
}

#[cfg(unix)]
#[test]
fn interrupted_work_leaves_no_half_written_file() {
    let dir = tempfile::tempdir().unwrap();
    let long = SMALL
        .replace("points = 31", "points = 2001")
        .replace("speed = [\"0 mm/s\",", "formulation = \"paper\"\nspeed = [\"0.07 mm/s\",");
    std::fs::write(dir.path().join("long.toml"), long).unwrap();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("stickslip"))
        .args(["run", "long.toml"])
        .current_dir(dir.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(700));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(3));
    assert_eq!(contents(&dir.path().join("output")), []);
}

#[test]
fn figures_come_in_the_formats_and_sizes_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    small(dir.path());
    let run = |more: &[&str]| {
        let mut command = stickslip(dir.path());
        command.args(["run", "small.toml", "--quiet"]).args(more);
        command.assert()
    };
    run(&["--format", "svg", "--preset", "double-column", "--out", "print"]).success();
    let names: Vec<String> = contents(&dir.path().join("print/small")).into_iter().map(|(name, _)| name).collect();
    assert!(names.iter().all(|name| name.ends_with(".svg") || name == "curves.csv") && names.len() > 1, "{names:?}");
    let svg = std::fs::read_to_string(dir.path().join("print/small/resonance.svg")).unwrap();
    assert!(svg.contains(" width=\"183.00mm\" "));
    run(&["--format", "png", "--preset", "web", "--out", "web"]).success();
    let png = std::fs::read(dir.path().join("web/small/resonance.png")).unwrap();
    assert_eq!(u32::from_be_bytes(png[16..20].try_into().unwrap()), 1100);
    run(&["--format", "pdf"]).code(2).stderr(predicates::str::contains("svg, png, csv"));
    run(&["--preset", "poster"]).code(2).stderr(predicates::str::contains("double-column"));
}

#[test]
fn trials_can_be_written_as_scores_alone() {
    let dir = tempfile::tempdir().unwrap();
    let arguments = ["trial", "--effects", "none", "--seeds", "1", "--max-effects", "1", "--out", "trials", "--json"];
    let json = |name: &str, more: &[&str]| -> serde_json::Value {
        stickslip(dir.path()).args(arguments).arg(name).args(more).assert().success();
        serde_json::from_slice(&std::fs::read(dir.path().join(name)).unwrap()).unwrap()
    };
    let whole = json("whole.json", &[]);
    // The second run finds the trial done, and takes it with its times.
    let mut alone = json("alone.json", &["--scores-alone"]);
    assert_eq!(whole["trials"].as_array().map(Vec::len), Some(1));
    assert_eq!(alone["trials"], serde_json::json!([]));
    alone["trials"] = whole["trials"].clone();
    assert_eq!(alone, whole);
}

/// Practice table 3, bent by something that no effect does.
#[test]
fn the_print_of_a_search_fits_forty_lines_also_where_it_ends_in_structure() {
    let dir = tempfile::tempdir().unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/practice/3");
    std::fs::copy(from.join("scenario.toml"), dir.path().join("scenario.toml")).unwrap();
    let table = std::fs::read_to_string(from.join("measurements.csv")).unwrap();
    let bent = |(number, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(String::from).collect();
        if number > 0 {
            let (frequency, amplitude): (f64, f64) = (cells[3].parse().unwrap(), cells[4].parse().unwrap());
            cells[4] = format!("{:e}", amplitude * (1.0 + 0.06 * (0.3 * frequency).sin()));
        }
        cells.join(",") + "\n"
    };
    let table: String = table.lines().enumerate().map(bent).collect();
    std::fs::write(dir.path().join("measurements.csv"), table).unwrap();
    let output = stickslip(dir.path()).args(["discover", "scenario.toml"]).unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("unexplained") && text.contains("free form:"), "{text}");
    assert!(text.lines().count() <= 40, "{} lines:\n{text}", text.lines().count());
}

/// A cable that came off half-way: from there on the readings are rounding. What lowers the squares raises the error
/// there.
#[test]
fn an_error_that_rose_is_not_told_as_one_that_fell() {
    let dir = tempfile::tempdir().unwrap();
    let table =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/oscillators/b.csv")).unwrap();
    let rows = table.lines().count();
    let pulled = |(number, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(String::from).collect();
        if number > rows / 2 {
            cells[3] = format!("{}e-12", 1 + number % 7);
        }
        cells.join(",") + "\n"
    };
    let table: String = table.lines().enumerate().map(pulled).collect();
    std::fs::write(dir.path().join("pulled.csv"), table).unwrap();
    stickslip(dir.path()).args(["new", "pulled.csv"]).assert().success();
    let output = stickslip(dir.path()).args(["discover", "pulled.toml"]).unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("unexplained"), "{text}");
    if let Some((_, errors)) = text.lines().next().unwrap().split_once("takes the rms error from ") {
        let errors: Vec<f64> = errors.split(' ').filter_map(|word| word.parse().ok()).collect();
        assert!(errors[1] < errors[0], "{text}");
    }
}

#[test]
fn what_was_not_tried_is_not_said_to_have_failed() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/oscillators/b.csv"), dir.path().join("b.csv"))
        .unwrap();
    stickslip(dir.path()).args(["new", "b.csv"]).assert().success();
    for (how, expected) in
        [(["--max-effects", "0"], "nothing was tried"), (["--search", "budget=1"], "budget was spent before")]
    {
        let output = stickslip(dir.path()).args(["discover", "b.toml"]).args(how).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.lines().next().unwrap().contains(expected), "{text}");
    }
    // A table where a scenario is asked for, and a folder that is not there.
    let refused = stickslip(dir.path()).args(["discover", "b.csv"]).assert().failure();
    refused.stderr(predicate::str::contains("`stickslip new b.csv` writes one"));
    let refused = stickslip(dir.path()).args(["new", "b.csv", "-o", "nowhere/b.toml"]).assert().failure();
    refused.stderr(predicate::str::contains("there is no folder nowhere"));
}

#[test]
fn a_jump_is_a_step_that_stays_and_not_one_of_two_sweeps_that_differ() {
    let response = |f: f64, at: f64| 1.0 / ((1.0 - (f / at).powi(2)).powi(2) + (f / at / 30.0).powi(2)).sqrt();
    let grid = |offset: f64| (0..60).map(move |i| 70.0 + offset + f64::from(i) / 3.0);
    let twice = grid(0.0).map(|f| (f, response(f, 80.0))).chain(grid(0.1).map(|f| (f, 1.3 * response(f, 80.0))));
    let folded = grid(0.0).map(|f| (f, response(f, 80.0) / if f > 81.0 { 5.0 } else { 1.0 }));
    for (rows, expected) in [(twice.collect::<Vec<_>>(), false), (folded.collect(), true)] {
        let dir = tempfile::tempdir().unwrap();
        let lines = rows.iter().map(|(f, a)| format!("{f:.4},1,{:.6}\n", 0.01 * a));
        std::fs::write(
            dir.path().join("t.csv"),
            "frequency_hz,force_n,amplitude_mm\n".to_string() + &lines.collect::<String>(),
        )
        .unwrap();
        let output = stickslip(dir.path()).args(["new", "t.csv"]).unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(text.contains("jump"), expected, "{text}");
    }
}

/// Where nothing states the drive both are tried: a base that moves bends the shape of a resonance as effects do.
#[test]
fn a_drive_that_is_not_stated_may_be_a_force_or_a_base() {
    let force = |r: f64| 1.0 / (1.0 - r * r).hypot(r / 8.0);
    let base = |r: f64| r * r * force(r);
    let cases: [(&dyn Fn(f64) -> f64, &str); 2] = [(&force, "drive = \"force\""), (&base, "drive = \"base\"")];
    for (response, expected) in cases {
        let dir = tempfile::tempdir().unwrap();
        let row = |i: u32| {
            let (f, noise) = (0.6 + 0.02 * f64::from(i), 1.0 + 0.005 * (f64::from(i * i) * 1.7).sin());
            format!("{f:.2},{:.6}\n", 0.1 * noise * response(f))
        };
        let rows: String = (0..=40).map(row).collect();
        std::fs::write(dir.path().join("t.csv"), "frequency_hz,theta_rad\n".to_string() + &rows).unwrap();
        let output = stickslip(dir.path()).args(["new", "t.csv"]).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
        let scenario = std::fs::read_to_string(dir.path().join("t.toml")).expect(&text);
        assert!(scenario.contains(expected) && text.contains("better by"), "{text}{scenario}");
        stickslip(dir.path()).args(["compare", "t.toml"]).assert().success();
    }
}

/// A resonance of a Q of 30 with another cause far from it: which readings calibration follows alone is said, and not
/// where these are all there are.
#[test]
fn readings_about_a_resonance_that_are_followed_alone_are_told() {
    let response = |r: f64| 1.0 / (1.0 - r * r).hypot(r / 30.0);
    for (wide, told) in [(true, true), (false, false)] {
        let dir = tempfile::tempdir().unwrap();
        let row = |i: u32| {
            let f = 60.0 + 0.5 * f64::from(i);
            // Beyond the resonance, or where it is.
            let other = if ((f - 80.0_f64).abs() > 8.0) == wide { 3.0 } else { 0.0 };
            let beyond = 1.0 + other * (0.9 * f).sin().powi(2);
            let noise = 1.0 + 0.002 * (f64::from(i * i) * 1.7).sin();
            format!("{f},1,{:.7}\n", 0.1 * noise * beyond * response(f / 80.0))
        };
        let rows: String = (0..81).map(row).collect();
        std::fs::write(dir.path().join("t.csv"), "frequency_hz,force_n,amplitude_mm\n".to_string() + &rows).unwrap();
        stickslip(dir.path()).args(["new", "t.csv"]).assert().success();
        let some = ["discover", "t.toml", "--max-effects", "1", "--candidates", "cubic-stiffness,crosstalk"];
        let output = stickslip(dir.path()).args(some).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("unexplained"), "{text}");
        assert_eq!(text.contains("about the resonance, are followed to"), told, "{text}");
    }
}

/// What falls as a filter does, or does not change, has no resonance: not one with the least quality factor that is
/// looked for.
#[test]
fn a_curve_without_a_peak_has_no_resonance() {
    let low_pass = |f: f64| 1.0 / (1.0 + (f / 400.0).powi(2)).sqrt();
    let flat = |f: f64| 1020.0 * (1.0 + 1e-4 * (f / 1000.0).powi(2));
    let peak = |f: f64| 1.0 / (1.0 - (f / 500.0).powi(2)).hypot(f / 500.0 / 1.5);
    let cases: [(&dyn Fn(f64) -> f64, bool); 3] = [(&low_pass, false), (&flat, false), (&peak, true)];
    for (number, (response, seen)) in cases.into_iter().enumerate() {
        let dir = tempfile::tempdir().unwrap();
        let rows = (1..=40).map(|i| 25.0 * f64::from(i)).map(|f| format!("{f},1,{:.6}\n", 0.01 * response(f)));
        let text = "frequency_hz,force_n,amplitude_mm\n".to_string() + &rows.collect::<String>();
        std::fs::write(dir.path().join("t.csv"), text).unwrap();
        let output = stickslip(dir.path()).args(["new", "t.csv"]).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(!error.contains("no resonance is seen in any series"), seen, "{number}: {error}");
    }
}
