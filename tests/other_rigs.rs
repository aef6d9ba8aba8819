//! Reports of rigs that are not the paper's speak of these rigs and of nothing else.

use assert_cmd::Command;
use std::fmt::Write as _;
use std::path::Path;
use stickslip::model::{Model, Operation};
use stickslip::scenario::load;
use stickslip::solver::cycle::Tolerance;
use stickslip::solver::{Warm, solve_steady};

const RIG: &str = "[rig]\nkind = \"oscillator\"\nmass = \"0.4 kg\"\nnatural_frequency = \"55 Hz\"\nquality_factor = 100\n\
    drive = \"force\"\n";
const BENT: &str = "[[effect]]\nname = \"cubic-stiffness\"\nK_3 = \"4e9 N/m^3\"\n";
const SWEEP: &str = "[sweep]\nfrequency = { from = \"53 Hz\", to = \"59 Hz\", points = 61 }\n\
    drive = [\"0.05 N\", \"0.5 N\"]\n";

/// A scenario of a beam that is driven by a force and read by an accelerometer, with a table that its linear model
/// misses.
fn beam(folder: &Path) {
    let bent = folder.join("bent.toml");
    std::fs::write(&bent, format!("title = \"Bent\"\n{RIG}{BENT}{SWEEP}")).unwrap();
    let model = Model::new(&load(&bent).unwrap());
    let mut table = String::from("series,frequency_hz,force_n,amplitude_m_s2,phase_rad\n");
    let mut row = 0_u32;
    for (series, force) in [("soft", 0.02), ("middle", 0.06), ("hard", 0.15)] {
        let mut warm = Warm::default();
        for i in 0..25 {
            let frequency = 54.0 + 0.1 * f64::from(i);
            // As of a shaker whose force falls at the resonance.
            let drive = force * (1.0 - 0.2 / (1.0 + (frequency - 55.0_f64).powi(2) / 0.1));
            let at = Operation { speed: 0.0, load: 0.0, drive, frequency, series: 0 };
            let state = solve_steady(&model, &at, &Tolerance::default(), false, &mut warm).state;
            let omega = std::f64::consts::TAU * frequency;
            let noise = |of: u32| f64::from(sobol_burley::sample(row, of, 3)) - 0.5;
            let acceleration = omega * omega * state.amplitude * (1.0 + 0.02 * noise(0));
            let phase = state.phase + std::f64::consts::PI + 0.02 * noise(1);
            writeln!(table, "{series},{frequency:.4},{drive:.7e},{acceleration:.7e},{phase:.6}").unwrap();
            row += 1;
        }
    }
    std::fs::write(folder.join("beam.csv"), table).unwrap();
    let fit = "[measurement]\nfile = \"beam.csv\"\n[fit]\nfree = [\"rig.mass\", \"rig.natural_frequency\", \
               \"rig.quality_factor\"]\n[gate]\namplitude_floor = \"1 mm/s^2\"\namplitude_tolerance = 0.9\n";
    let text = format!("title = \"A beam on a shaker\"\nfigures = [\"resonance\"]\n{RIG}{SWEEP}{fit}");
    std::fs::write(folder.join("beam.toml"), text).unwrap();
}

/// The words of the paper's rig and its readings in a text, each with what stands around it.
fn of_the_paper(text: &str) -> Vec<String> {
    let parts = [
        "roller",
        "Roller",
        "rubber",
        "Rubber",
        "amplitude_rad",
        "µrad",
        "u₀",
        "u0",
        "W = ",
        "V = ",
        "bωα",
        "α",
        "piezo",
    ];
    let around = |at: usize, length: usize| {
        let start = (0..=at.saturating_sub(40)).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
        let end = (at + length + 40..text.len()).find(|i| text.is_char_boundary(*i)).unwrap_or(text.len());
        text[start..end].replace('\n', " ")
    };
    let mut found: Vec<String> = parts
        .iter()
        .flat_map(|part| text.match_indices(part).map(|(at, _)| around(at, part.len())).take(2).collect::<Vec<_>>())
        .collect();
    let letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    for (at, word) in text.match_indices("arm") {
        if !letter(text[..at].chars().next_back()) && !letter(text[at + word.len()..].chars().next()) {
            found.push(around(at, word.len()));
        }
    }
    // Speeds; accelerations have the same beginning.
    for (at, word) in text.match_indices("mm/s") {
        if !text[at + word.len()..].starts_with(['²', '^']) {
            found.push(around(at, word.len()));
        }
    }
    found
}

fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
// Long: one run of all commands, which takes long, is looked at from all sides.
fn a_beam_is_reported_without_a_word_of_the_papers_rig() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    beam(root);
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("stickslip").unwrap();
        let output = command.current_dir(root).env("XDG_CACHE_HOME", root).args(arguments).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let mut told = vec![("report".to_string(), run(&["report", "beam.toml", "--no-cache", "--history", "runs"]))];
    told.push(("compare".into(), run(&["compare", "beam.toml", "--json", "comparison.json"])));
    told.push((
        "discover".into(),
        run(&["discover", "beam.toml", "--json", "discovery.json", "--drive", "10 mN..200 mN"]),
    ));
    for name in ["comparison.json", "discovery.json"] {
        told.push((name.into(), std::fs::read_to_string(root.join(name)).unwrap()));
    }
    let written = files(&root.join("output"));
    for kind in ["html", "json", "svg", "csv"] {
        let of_kind = |path: &&std::path::PathBuf| path.extension().is_some_and(|extension| extension == kind);
        assert!(written.iter().any(|path| of_kind(&path)), "{kind}");
        for path in written.iter().filter(of_kind) {
            let text = std::fs::read_to_string(path).unwrap();
            // The page's own script and style speak of no rig, whatever their names are.
            let text = text.split("<script>").next().unwrap_or_default();
            // Tables are packed into links; they are among the files as well.
            let unpacked = text.split("data-packed=\"").enumerate();
            let text: String = unpacked
                .map(|(i, part)| if i == 0 { part } else { part.split_once('"').map_or("", |p| p.1) })
                .collect();
            told.push((path.strip_prefix(root).unwrap().display().to_string(), text));
        }
    }
    let found: Vec<String> = told
        .iter()
        .flat_map(|(name, text)| of_the_paper(text).into_iter().map(move |words| format!("{name}: {words}")))
        .collect();
    assert!(found.is_empty(), "{} places:\n{}", found.len(), found.join("\n"));

    let text = |name: &str| told.iter().find(|(known, _)| known == name).map_or("", |(_, text)| text);
    let page = text("output/report.html");
    for words in [
        "<h1>A beam on a shaker</h1>",
        "F₀",
        "acceleration amplitude A [m/s²]",
        "Mx″ + Cx′ + Kx = F₀ sin(ωt)",
        "missing force",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("id=\"claims\"") && !page.contains("id=\"atlas\"") && !page.contains("id=\"trust\""));
    let curves = text("output/beam/curves.csv");
    assert!(curves.starts_with("force_n,frequency_hz,amplitude_m_s2,phase_rad,mean_m,"), "{curves:.200}");
    let comparison: serde_json::Value = serde_json::from_str(text("comparison.json")).unwrap();
    let first = &comparison["conditions"][0];
    assert_eq!((first["drive_unit"].as_str(), first["series"]["name"].as_str()), (Some("N"), Some("soft")));
    assert_eq!(first["measured_peak"]["amplitude_unit"].as_str(), Some("m/s^2"));
    assert!(first.get("drive_m").is_none() && first.get("load_n").is_none(), "{first}");
    assert_eq!(comparison["missing_force"]["stiffness_unit"].as_str(), Some("N/m"));
    assert_eq!(comparison["missing_force"]["points"].as_array().map(Vec::len), Some(75));
    // What the cubic spring does, seen without knowing of it: 3 K3 X^2/4 above what it does on average.
    let points = comparison["missing_force"]["points"].as_array().unwrap();
    let number = |point: &serde_json::Value, key: &str| point[key].as_f64().unwrap();
    let clear = |p: &&serde_json::Value| number(p, "stiffness_sd") < 60.0;
    let (mut sums, mut n) = ([0.0; 4], 0.0);
    for p in points.iter().filter(clear) {
        let (x, y) = (number(p, "motion").powi(2), number(p, "stiffness"));
        sums = [sums[0] + x, sums[1] + y, sums[2] + x * y, sums[3] + x * x];
        n += 1.0;
    }
    let slope = (n * sums[2] - sums[0] * sums[1]) / (n * sums[3] - sums[0] * sums[0]);
    assert!((slope / 3e9 - 1.0).abs() < 0.15, "{slope:e} from {n} points");
    let discovery: serde_json::Value = serde_json::from_str(text("discovery.json")).unwrap();
    assert_eq!(discovery["effects"][0].as_str(), Some("cubic-stiffness"));
}

#[test]
fn a_point_without_an_answer_has_a_status_and_no_numbers() {
    let dir = tempfile::tempdir().unwrap();
    let scenario = "title = 'Nothing damps it'\n[rig]\ninertia = '5.0e-3 kg m^2'\ntorsional_stiffness = '1000 N m/rad'\n\
        torsional_damping = 0\nspring_stiffness = '1.6e4 N/m'\nspring_damping = '0 N s/m'\nspring_arm = '30 mm'\n\
        contact_arm = '60 mm'\n[contact]\nstiffness = 1\ndamping = 1\nfriction = 0.5\n[sweep]\nspeed = 0\nload = 0\n\
        frequency = [70, 72.19391724073334, 75]\ndrive = '2.5 um'\n";
    std::fs::write(dir.path().join("undamped.toml"), scenario).unwrap();
    Command::cargo_bin("stickslip").unwrap().current_dir(dir.path()).args(["run", "undamped.toml"]).assert().success();
    let curves = std::fs::read_to_string(dir.path().join("output/undamped/curves.csv")).unwrap();
    let rows: Vec<Vec<&str>> = curves.lines().map(|line| line.split(',').collect()).collect();
    let at = |name: &str| rows[0].iter().position(|cell| *cell == name).unwrap();
    let (amplitude, status) = (at("amplitude_rad"), at("status"));
    assert_eq!(rows.len(), 4);
    for row in &rows[1..] {
        let number: Option<f64> = row[amplitude].parse().ok();
        assert_eq!(row[status] == "steady", number.is_some_and(f64::is_finite), "{row:?}");
    }
    assert!(rows.iter().any(|row| row[status] == "failed" && row[amplitude].is_empty()), "{curves}");
}
