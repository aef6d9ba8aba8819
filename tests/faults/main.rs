//! What goes wrong outside the program: files of others in the way, full disks, closed outputs, kills, two runs at
//! once.
#![cfg(unix)]

mod surroundings;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const RIG: &str = r#"
title = "Small"
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
"#;
const SWEEP: &str = r#"
[sweep]
frequency = { from = "60 Hz", to = "90 Hz", points = 11 }
speed = ["0.05 mm/s", "20 mm/s"]
load = "20 N"
drive = "2.5 um"
"#;

fn stickslip(dir: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("stickslip"));
    command.args(arguments).current_dir(dir).env("SOURCE_DATE_EPOCH", "0").env("XDG_CACHE_HOME", dir.join("home"));
    command.stdin(Stdio::null());
    command
}

fn output(dir: &Path, arguments: &[&str]) -> Output {
    stickslip(dir, arguments).output().unwrap()
}

/// Runs a line of the shell in which the program is `$S`.
fn shell(dir: &Path, line: &str) -> Output {
    let program = assert_cmd::cargo::cargo_bin("stickslip");
    let mut command = Command::new("sh");
    command.args(["-c", line]).current_dir(dir).env("S", program).env("XDG_CACHE_HOME", dir.join("home"));
    command.env("SOURCE_DATE_EPOCH", "0").stdin(Stdio::null()).output().unwrap()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn succeeds(dir: &Path, arguments: &[&str]) {
    let output = output(dir, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", told(&output));
}

/// Fails with a status, a message and no panic.
fn fails(output: &Output, status: i32, words: &str) {
    let told = told(output);
    assert_eq!(output.status.code(), Some(status), "{told}");
    assert!(told.contains(words) && !told.contains("panicked"), "{words}: {told}");
}

/// A scenario with a sweep, and one with a table of few readings.
fn prepare(dir: &Path) {
    std::fs::write(dir.join("small.toml"), format!("{RIG}{SWEEP}")).unwrap();
    std::fs::write(dir.join("table.csv"), table()).unwrap();
    std::fs::write(dir.join("measured.toml"), measured("table.csv")).unwrap();
}

fn table() -> String {
    let whole = stickslip::scenario::embedded_file("practice/4/measurements.csv").unwrap();
    let lines = whole.lines().enumerate().filter(|(number, _)| number % 6 == 0);
    lines.map(|(_, line)| format!("{line}\n")).collect()
}

fn measured(table: &str) -> String {
    format!("{RIG}[measurement]\nfile = \"{table}\"\n[fit]\nfree = [\"contact.stiffness\", \"contact.damping\"]\n")
}

/// Every file below a folder with its bytes.
fn contents(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if let Ok(bytes) = std::fs::read(&path) {
                found.insert(path.strip_prefix(root).unwrap().display().to_string(), bytes);
            }
        }
    }
    found
}

#[test]
fn no_result_takes_the_place_of_an_input_or_of_a_file_of_others() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    // The measured table lies where a figure's would go.
    std::fs::create_dir(dir.join("measured")).unwrap();
    std::fs::write(dir.join("measured/overlay.csv"), table()).unwrap();
    std::fs::write(dir.join("measured.toml"), measured("measured/overlay.csv")).unwrap();
    for command in [&["compare", "measured.toml", "--out", "."][..], &["run", "measured.toml", "--out", "."]] {
        fails(&output(dir, command), 2, "measured/overlay.csv is an input and is not overwritten");
        assert_eq!(std::fs::read_to_string(dir.join("measured/overlay.csv")).unwrap(), table());
    }
    // A table that no command has read.
    std::fs::create_dir_all(dir.join("x/small")).unwrap();
    std::fs::write(dir.join("x/small/curves.csv"), "mine").unwrap();
    fails(&output(dir, &["run", "small.toml", "--out", "x"]), 2, "x/small/curves.csv was not written by this program");
    assert_eq!(std::fs::read(dir.join("x/small/curves.csv")).unwrap(), b"mine");
    // Nor does a file asked for by name replace one of others, a result, a folder or a device.
    std::fs::write(dir.join("mine.json"), "{\"mine\": 1}").unwrap();
    std::os::unix::fs::symlink("mine.json", dir.join("link.json")).unwrap();
    for to in ["mine.json", "link.json", "table.csv", "measured", "/dev/null"] {
        for command in [&["compare", "measured.toml", "--json", to][..], &["report", "small.toml", "--junit", to]] {
            fails(&output(dir, command), 2, to);
        }
    }
    assert_eq!(std::fs::read(dir.join("mine.json")).unwrap(), b"{\"mine\": 1}");
    for to in ["o/report.json", "o/./report.html", "o/small/resonance.svg", "./o/small/x.xml"] {
        for option in ["--junit", "--markdown"] {
            fails(&output(dir, &["report", "small.toml", "--out", "o", option, to]), 2, "where results of this run go");
        }
    }
    fails(&output(dir, &["report", "small.toml", "--junit", "a", "--markdown", "./a"]), 2, "the same file");
    assert!(!dir.join("o").exists() && !dir.join("a").exists());
}

#[test]
fn the_same_command_twice_replaces_its_results_also_those_of_an_earlier_version() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let report = ["report", "small.toml", "measured.toml", "--junit", "output/junit.xml", "--markdown", "output/a.md"];
    let commands: [&[&str]; 3] =
        [&report, &["run", "small.toml"], &["compare", "measured.toml", "--json", "c.json", "--out", "figures"]];
    for command in commands {
        succeeds(dir, command);
    }
    let change = |from: &str, to: &str| {
        for name in ["small.toml", "measured.toml"] {
            let text = std::fs::read_to_string(dir.join(name)).unwrap();
            std::fs::write(dir.join(name), text.replace(from, to)).unwrap();
        }
    };
    change("friction = 0.5", "friction = 0.4");
    for command in commands {
        succeeds(dir, command);
    }
    // An earlier version left no list.
    for folder in ["output", "figures"] {
        std::fs::remove_file(dir.join(folder).join(stickslip::results::LIST)).unwrap();
    }
    change("friction = 0.4", "friction = 0.6");
    for command in commands {
        succeeds(dir, command);
    }
}

#[test]
fn outputs_that_cannot_be_written_are_told_once_and_a_reader_that_has_gone_is_not() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let commands = [
        "compare measured.toml --json -",
        "compare measured.toml",
        "discover measured.toml --max-effects 0 --json -",
        "run small.toml",
        "report small.toml",
        "add stribeck measured.toml --dry-run",
        "check small.toml",
        "effects",
        "completions bash",
        "man",
        "--help",
        "run --help",
        "--version",
    ];
    for command in commands {
        let full = shell(dir, &format!("\"$S\" {command} > /dev/full"));
        fails(&full, 3, "cannot write to `standard output`");
        assert_eq!(told(&full).matches("error:").count(), 1, "{command}: {}", told(&full));
        // Without a reader: the pipe is closed before anything is written.
        let gone = shell(dir, &format!("{{ sleep 0.1; \"$S\" {command}; echo status $? >&2; }} | true"));
        assert!(told(&gone).contains("status 0") && !told(&gone).contains("error"), "{command}: {}", told(&gone));
        // Neither output is there.
        let closed = shell(dir, &format!("\"$S\" {command} >&- 2>&-"));
        assert_eq!(closed.status.code(), Some(0), "{command}");
    }
    std::fs::write(dir.join("bad.toml"), "x = ").unwrap();
    for command in ["check bad.toml", "run nowhere.toml", "--no-such-option", "run"] {
        assert_eq!(shell(dir, &format!("\"$S\" {command} 2> /dev/full")).status.code(), Some(2), "{command}");
    }
    let told = shell(dir, "\"$S\" add stribeck measured.toml --dry-run 2> /dev/full > out; echo $?");
    assert_eq!(told.stdout, b"0\n");
}

/// Characters that a terminal obeys, in a place where every reader of TOML, JSON and file names takes them.
const HOSTILE: &str = "a\u{9b}31mb\u{85}c\u{202e}d";

fn harmless(output: &Output, from: &str) {
    for text in [&output.stdout, &output.stderr] {
        let text = std::str::from_utf8(text).unwrap();
        let obeyed = text.chars().find(|c| stickslip::terminal::obeyed(*c));
        assert!(obeyed.is_none() && !text.contains("panicked"), "{from}: {obeyed:?} in {text:?}");
    }
    assert!(!output.stdout.is_empty() || !output.stderr.is_empty(), "{from} says nothing");
}

#[test]
// Long: every way by which text of others comes in, one after the other in one folder.
fn no_text_of_others_reaches_a_terminal_as_a_command() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let escape = format!("{HOSTILE}\u{1b}[2J\u{7f}\r");
    // Units, titles, keys and comments of scenarios; names of files.
    let files = [
        ("unit", format!("{RIG}{SWEEP}").replace("5.0e-3 kg m^2", &format!("5.0e-3 {HOSTILE}"))),
        ("key", format!("{RIG}{SWEEP}").replace("friction", &format!("\"{HOSTILE}\""))),
        ("syntax", format!("title = \"{HOSTILE}\" {escape}\n")),
        ("comment", format!("x = 1 # {HOSTILE}\n")),
        (HOSTILE, format!("{RIG}{SWEEP}")),
        ("table", measured(HOSTILE)),
        ("columns", measured("columns.csv")),
    ];
    std::fs::write(dir.join("columns.csv"), format!("frequency_hz,{escape}\n1,{escape}\n")).unwrap();
    for (name, text) in &files {
        std::fs::write(dir.join(format!("{name}.toml")), text).unwrap();
        for command in ["check", "run", "compare", "discover", "report"] {
            harmless(&output(dir, &[command, &format!("{name}.toml")]), name);
        }
    }
    harmless(&output(dir, &["check", &escape]), "a name");
    harmless(&output(dir, &["new", "columns.csv"]), "new");
    std::fs::create_dir_all(dir.join("s/scenarios/paper")).unwrap();
    let paper = dir.join("s/scenarios/paper");
    std::fs::write(paper.join("small.toml"), format!("{RIG}{SWEEP}")).unwrap();
    std::fs::write(paper.join("rig.toml"), RIG).unwrap();
    std::fs::write(paper.join("claims.toml"), format!("[[claim]] # {HOSTILE}\nid = {HOSTILE}\n")).unwrap();
    harmless(&output(&dir.join("s"), &["report"]), "claims");
    // Arguments.
    for arguments in [&["trial", "--effects", &escape][..], &["effects", &escape], &[&escape], &["run", "x", &escape]] {
        harmless(&output(dir, arguments), "arguments");
    }
    harmless(&output(dir, &["trial", "--search", &escape]), "search");
    harmless(&output(dir, &["add", &escape, "measured.toml"]), "add");
    // Reports and histories of others.
    succeeds(dir, &["report", "small.toml", "measured.toml", "--history", "runs", "--out", "base"]);
    let whole = std::fs::read_to_string(dir.join("base/report.json")).unwrap();
    let mut view: serde_json::Value = serde_json::from_str(&whole).unwrap();
    view["summary"]["sentence"] = escape.as_str().into();
    view["scenarios"][0]["id"] = escape.as_str().into();
    view["scenarios"][1]["comparison"]["overall"]["chi2"]["text"] = escape.as_str().into();
    let mut other = view.clone();
    other["schema"] = escape.as_str().into();
    let mut worse = view.clone();
    worse["scenarios"][1]["comparison"]["verdict"] = escape.as_str().into();
    for (name, json) in [("view", view), ("other", other), ("worse", worse)] {
        std::fs::write(dir.join(format!("base/{name}.json")), json.to_string()).unwrap();
        let json = &format!("base/{name}.json");
        harmless(&output(dir, &["--from", json]), name);
        harmless(&output(dir, &["report", "small.toml", "--baseline", json]), name);
        harmless(&output(dir, &["accept", json, "--baseline", "accepted", "--dry-run"]), name);
        harmless(&output(dir, &["accept", "base", "--baseline", json]), name);
    }
    let line = std::fs::read_to_string(dir.join("runs/history.jsonl")).unwrap();
    let mut record: serde_json::Value = serde_json::from_str(&line).unwrap();
    for number in [1.0, 1.0, 2.0, 2.0] {
        record["errors"][&escape] = number.into();
        std::fs::write(dir.join("runs/history.jsonl"), format!("{record}\n").repeat(4)).unwrap();
        harmless(&output(dir, &["report", "small.toml", "--history", "runs"]), "history");
    }
    record["schema"] = escape.as_str().into();
    std::fs::write(dir.join("runs/history.jsonl"), format!("{record}\n")).unwrap();
    harmless(&output(dir, &["report", "small.toml", "--history", "runs"]), "history");
}

/// No file is cut, whatever its kind.
fn all_whole(root: &Path) {
    for (name, bytes) in contents(root) {
        let ends = |end: &[u8]| assert!(bytes.trim_ascii_end().ends_with(end), "{name} is cut: {} bytes", bytes.len());
        let hidden = name.rsplit('/').next().is_some_and(|name| name.starts_with(stickslip::results::LIST));
        match name.rsplit('.').next() {
            _ if hidden => {}
            Some("json") => assert!(serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(), "{name}"),
            Some("svg") => ends(b"</svg>"),
            Some("html") => ends(b"</html>"),
            Some("png") => ends(b"IEND\xaeB`\x82"),
            Some("csv" | "jsonl") => assert!(bytes.ends_with(b"\n"), "{name}"),
            _ => {}
        }
    }
}

fn unfinished(root: &Path) -> Vec<String> {
    contents(root).into_keys().filter(|name| name.ends_with(".tmp")).collect()
}

/// What stands in a folder of results, its list left out.
fn results(root: &Path) -> BTreeMap<String, Vec<u8>> {
    contents(root).into_iter().filter(|(name, _)| name != stickslip::results::LIST).collect()
}

#[test]
fn a_run_killed_at_any_instant_leaves_whole_files_and_the_next_one_is_not_disturbed() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let report = |out: &'static str| ["report", "small.toml", "measured.toml", "--history", "runs", "--out", out];
    let began = std::time::Instant::now();
    succeeds(dir, &report("fresh"));
    let whole = began.elapsed();
    std::fs::remove_dir_all(dir.join("home")).unwrap();
    std::fs::remove_dir_all(dir.join("runs")).unwrap();
    for instant in 0..12 {
        let mut child = stickslip(dir, &report("killed")).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // By the golden ratio, so that the instants keep apart.
        std::thread::sleep(whole.mul_f64((0.1 + f64::from(instant) * 0.618_034).fract()));
        child.kill().unwrap();
        child.wait().unwrap();
        all_whole(dir);
        std::fs::remove_dir_all(dir.join("home")).ok();
        // A run that had come to its end is in the history, which the next one would draw.
        std::fs::remove_dir_all(dir.join("runs")).ok();
    }
    // What a killed run leaves behind is seldom hit by chance.
    for folder in ["killed", "killed/small", "home/stickslip"] {
        std::fs::create_dir_all(dir.join(folder)).unwrap();
        std::fs::write(dir.join(folder).join(".stickslip-abcdef.tmp"), "half").unwrap();
    }
    succeeds(dir, &report("killed"));
    assert_eq!(unfinished(dir), [] as [String; 0]);
    let (killed, fresh) = (results(&dir.join("killed")), results(&dir.join("fresh")));
    let names = killed.keys().chain(fresh.keys()).filter(|name| killed.get(*name) != fresh.get(*name));
    assert_eq!(names.collect::<Vec<_>>(), [] as [&String; 0]);
}

#[test]
fn two_scenarios_of_one_name_do_not_mix_in_one_folder() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for (folder, friction) in [("a", "0.5"), ("b", "0.3")] {
        std::fs::create_dir(dir.join(folder)).unwrap();
        let text = format!("{RIG}{SWEEP}").replace("friction = 0.5", &format!("friction = {friction}"));
        std::fs::write(dir.join(folder).join("x.toml"), text).unwrap();
        succeeds(dir, &["run", &format!("{folder}/x.toml"), "--out", &format!("alone-{folder}")]);
    }
    let alone = ["a", "b"].map(|folder| results(&dir.join(format!("alone-{folder}"))));
    assert!(alone[0] != alone[1]);
    for _ in 0..8 {
        let start = |name: &str| stickslip(dir, &["run", name, "--out", "both"]).output();
        std::thread::scope(|scope| {
            let both = ["a/x.toml", "b/x.toml"].map(|name| scope.spawn(move || start(name).unwrap()));
            for run in both {
                let output = run.join().unwrap();
                assert!(output.status.success(), "{}", told(&output));
            }
        });
        let both = results(&dir.join("both"));
        assert!(alone.contains(&both), "{:?}", both.keys());
    }
}

#[test]
fn an_interrupt_ends_every_command_at_once_with_its_status() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    // One point of many seconds.
    let point = format!("{RIG}{SWEEP}")
        .replace("friction = 0.5", "friction = 0.5\nformulation = \"paper\"")
        .replace("{ from = \"60 Hz\", to = \"90 Hz\", points = 11 }", "\"70 Hz\"")
        .replace("[sweep]", "[sweep]\neuler_steps = 1000000");
    std::fs::write(dir.join("point.toml"), point).unwrap();
    let whole = stickslip::scenario::embedded_file("practice/4/measurements.csv").unwrap();
    std::fs::write(dir.join("whole.csv"), whole).unwrap();
    std::fs::write(dir.join("whole.toml"), measured("whole.csv")).unwrap();
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/own-rig/swept.csv");
    std::fs::copy(own, dir.join("own.csv")).unwrap();
    let before = std::fs::read(dir.join("whole.toml")).unwrap();
    let commands: [&[&str]; 7] = [
        &["run", "point.toml"],
        &["new", "own.csv", "-o", "new.toml"],
        &["report", "point.toml", "whole.toml"],
        &["discover", "whole.toml", "--json", "d.json"],
        &["compare", "whole.toml", "--json", "-", "--out", "figures"],
        &["add", "stribeck", "whole.toml"],
        &["trial", "--effects", "stribeck", "--seeds", "1"],
    ];
    for command in commands {
        let run = stickslip(dir, command).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(100));
        let id = run.id().to_string();
        let pressed = std::time::Instant::now();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let output = run.wait_with_output().unwrap();
        let took = pressed.elapsed();
        fails(&output, 3, "error: interrupted");
        assert!(took.as_secs_f64() < 1.0, "{command:?} went on for {took:?}");
        // Either nothing was said yet, or all of it.
        let whole = output.stdout.is_empty() || serde_json::from_slice::<serde_json::Value>(&output.stdout).is_ok();
        assert!(whole, "{command:?}: {}", String::from_utf8_lossy(&output.stdout));
        all_whole(dir);
    }
    assert!(!dir.join("d.json").exists() && !dir.join("new.toml").exists());
    assert!(std::fs::read(dir.join("whole.toml")).unwrap() == before);
}

#[test]
fn a_disk_that_fills_or_a_folder_that_cannot_be_written_to_leaves_no_half_of_a_file() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    // Where files may not grow beyond a size, a write fails in its middle as it does on a full disk.
    for blocks in [0, 1, 16, 64, 200] {
        let line = format!("trap '' XFSZ; ulimit -f {blocks}; \"$S\" report small.toml --no-cache --out full");
        let output = shell(dir, &line);
        assert!([Some(0), Some(3)].contains(&output.status.code()), "{blocks}: {}", told(&output));
        assert!(blocks > 16 || output.status.code() == Some(3), "{blocks}");
        all_whole(dir);
        assert_eq!(unfinished(dir), [] as [String; 0], "{blocks}");
    }
    succeeds(dir, &["report", "small.toml", "--no-cache", "--out", "full"]);
    for to in ["/proc/results", "/dev/full/results", "small.toml"] {
        let output = output(dir, &["run", "small.toml", "--out", to]);
        assert!([Some(2), Some(3)].contains(&output.status.code()), "{to}: {}", told(&output));
    }
    fails(&output(dir, &["compare", "measured.toml", "--json", "/proc/c.json"]), 3, "cannot write in `/proc`");
    fails(&output(dir, &["report", "small.toml", "--history", "/proc/runs"]), 3, "/proc/runs");
}

#[test]
fn a_scenario_may_have_the_name_of_a_result() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for name in ["report.html.toml", "report.json.toml", "history.toml"] {
        std::fs::write(dir.join(name), format!("{RIG}{SWEEP}")).unwrap();
    }
    succeeds(dir, &["report", "report.html.toml", "report.json.toml", "history.toml", "--history", "runs"]);
    assert!(dir.join("output/report.html").is_file() && dir.join("output/report.html-2/curves.csv").is_file());
}

/// A contact without a load at any reading leaves its effects without a size: nothing is searched for, and nothing
/// panics.
#[test]
fn readings_without_any_load_are_searched_and_an_effect_without_a_size_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let rows: String =
        (0..24).map(|i| format!("0,0,2.5e-6,{},{:e}\n", 60.0 + f64::from(i), 1e-6 + 1e-8 * f64::from(i))).collect();
    std::fs::write(dir.join("table.csv"), format!("speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad\n{rows}"))
        .unwrap();
    std::fs::write(
        dir.join("s.toml"),
        format!("{RIG}[measurement]\nfile = \"table.csv\"\n[fit]\nfree = [\"contact.stiffness\"]\n"),
    )
    .unwrap();
    succeeds(dir, &["discover", "s.toml"]);
    let refused = output(dir, &["add", "frictional-heating", "s.toml"]);
    fails(&refused, 2, "the measurements leave `frictional-heating` nothing to act on");
}
