//! The published JSON Schemas: they are those of the types, and what the program writes obeys them.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;

fn read(path: impl AsRef<Path>) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn obeys(name: &str, path: &Path) {
    let schema = jsonschema::validator_for(&read(format!("schemas/{name}.json"))).unwrap();
    let value = read(path);
    let found: Vec<String> =
        schema.iter_errors(&value).take(20).map(|why| format!("{}: {why:.90}", why.instance_path())).collect();
    assert!(found.is_empty(), "schemas/{name}.json:\n{}", found.join("\n"));
}

#[test]
fn the_published_schemas_are_those_of_the_types() {
    for name in ["comparison", "discovery", "history", "prony", "report", "trial"] {
        let output = Command::cargo_bin("stickslip").unwrap().args(["schema", name]).output().unwrap();
        let published = std::fs::read_to_string(format!("schemas/{name}.json")).unwrap();
        let own = String::from_utf8(output.stdout).unwrap();
        assert_eq!(own, published, "stickslip schema {name} > schemas/{name}.json");
    }
}

#[test]
fn what_the_program_writes_obeys_the_published_schemas() {
    let dir = tempfile::tempdir().unwrap();
    let root = dir.path();
    let table = stickslip::scenario::embedded_file("practice/1/measurements.csv").unwrap();
    let lines = table.lines().enumerate().filter(|(number, _)| number % 3 == 0).map(|(_, line)| line);
    std::fs::write(root.join("measurements.csv"), lines.collect::<Vec<_>>().join("\n")).unwrap();
    let text = stickslip::scenario::embedded_file("practice/1/scenario.toml").unwrap();
    let gate = "\n[sweep]\nfrequency = { from = \"60 Hz\", to = \"90 Hz\", points = 7 }\nspeed = \"20 mm/s\"\nload = \"20 N\"\ndrive = \"2.5 um\"\n[gate]\nmax_chi2_per_point = 1e9\nclaims = [\"full-slip-equals-no-contact\"]\n";
    std::fs::write(root.join("rig.toml"), format!("{text}{gate}")).unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("stickslip").unwrap();
        command.current_dir(root).env("XDG_CACHE_HOME", root).args(arguments).assert().success();
    };
    run(&["report", "rig.toml", "--out", "before", "--history", "runs"]);
    // Other frequencies, so that there are curves, pictures and inputs that differ.
    let text = std::fs::read_to_string(root.join("rig.toml")).unwrap();
    assert!(text.contains("points = 7"));
    std::fs::write(root.join("rig.toml"), text.replace("points = 7", "points = 9")).unwrap();
    run(&["report", "rig.toml", "--no-cache", "--baseline", "before", "--history", "runs"]);
    let report = read(root.join("output/report.json"));
    for list in ["changes", "inputs", "figures", "pictures"] {
        assert!(!report["baseline"][list].as_array().unwrap().is_empty(), "{list}");
    }
    let lines = std::fs::read_to_string(root.join("runs/history.jsonl")).unwrap();
    std::fs::write(root.join("record.json"), lines.lines().next().unwrap()).unwrap();
    obeys("history", &root.join("record.json"));
    run(&["compare", "rig.toml", "--json", "comparison.json"]);
    run(&["discover", "rig.toml", "--json", "discovery.json"]);
    run(&["trial", "--effects", "none", "--seeds", "1", "--max-effects", "1", "--json", "trial.json"]);
    obeys("report", &root.join("output/report.json"));
    for name in ["comparison", "discovery", "trial"] {
        obeys(name, &root.join(format!("{name}.json")));
    }
}

#[test]
fn what_it_writes_of_another_rig_obeys_them_too() {
    let dir = tempfile::tempdir().unwrap();
    let root = dir.path();
    // A pendulum whose damping grows with the torque, which no effect of the catalogue does by itself.
    let mut table = String::from("series,frequency_hz,torque_n_m,amplitude_rad_s,phase_deg\n");
    for (series, torque, loss) in [(1, 1e-4, 0.02), (2, 3e-4, 0.05)] {
        for i in 0..24 {
            let f = 1.0 + 0.02 * (f64::from(i) - 11.5);
            let (re, im) = (1.0 - f * f, loss * f);
            let (amplitude, phase) = (torque / 0.01 / re.hypot(im), -im.atan2(re).to_degrees() + 90.0);
            let omega = std::f64::consts::TAU * f;
            let scatter = 1.0 + 0.004 * f64::from(i * i % 7 - 3);
            table += &format!("{series},{f:.3},{torque},{:.6e},{:.3}\n", omega * amplitude * scatter, phase + scatter);
        }
    }
    std::fs::write(root.join("pendulum.csv"), table).unwrap();
    let text = "title = \"A pendulum\"\n[rig]\nkind = \"oscillator\"\ncoordinate = \"angle\"\nstiffness = \"0.01 N m/rad\"\n\
        inertia = \"2.533e-4 kg m^2\"\ndamping_ratio = 0.02\ndrive = \"force\"\n[sweep]\nfrequency = { from = \"0.8 Hz\", \
        to = \"1.2 Hz\", points = 9 }\ndrive = \"0.1 N mm\"\n[measurement]\nfile = \"pendulum.csv\"\n[fit]\nfree = [\"rig.stiffness\", \
        \"rig.damping_ratio\"]\n";
    std::fs::write(root.join("pendulum.toml"), text).unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("stickslip").unwrap();
        command.current_dir(root).env("XDG_CACHE_HOME", root).args(arguments).assert().success();
    };
    run(&["report", "pendulum.toml", "--no-cache"]);
    run(&["compare", "pendulum.toml", "--json", "comparison.json"]);
    run(&["discover", "pendulum.toml", "--json", "discovery.json", "--max-effects", "1"]);
    obeys("report", &root.join("output/report.json"));
    for name in ["comparison", "discovery"] {
        obeys(name, &root.join(format!("{name}.json")));
    }
    let peak = &read(root.join("comparison.json"))["conditions"][0]["measured_peak"];
    assert_eq!(peak["amplitude_unit"], "rad/s");
}

#[test]
fn moduli_as_a_series_obey_theirs() {
    let dir = tempfile::tempdir().unwrap();
    let root = dir.path();
    let rows = |second: &str| (1..9).map(|i| format!("{i},{}{second}\n", 9 - i)).collect::<String>();
    std::fs::write(root.join("dma.csv"), "frequency_hz,storage_mpa,loss_mpa\n".to_string() + &rows(",1")).unwrap();
    std::fs::write(root.join("time.csv"), "time_s,relaxation_mpa\n".to_string() + &rows("")).unwrap();
    for (table, more) in [("dma.csv", "--geometry=1mm"), ("time.csv", "--quiet")] {
        let mut command = Command::cargo_bin("stickslip").unwrap();
        command.current_dir(root).args(["prony", table, "--json", "prony.json", more]).assert().success();
        obeys("prony", &root.join("prony.json"));
    }
}

#[test]
fn a_schema_refuses_what_lacks_a_key_or_has_another_type() {
    let schema = jsonschema::validator_for(&read("schemas/history.json")).unwrap();
    let strings = ["schema", "time", "program", "comparator", "inputs"].map(|key| (key.to_string(), Value::from("x")));
    let maps = ["misfits", "errors", "peaks", "seconds"].map(|key| (key.to_string(), serde_json::json!({})));
    let mut record: serde_json::Map<String, Value> = strings.into_iter().chain(maps).collect();
    record["schema"] = "stickslip.history/1".into();
    assert!(schema.is_valid(&record.clone().into()));
    for (key, value) in [("schema", "stickslip.history/0".into()), ("time", 1.into()), ("misfits", Value::Null)] {
        let mut other = record.clone();
        other[key] = value;
        assert!(!schema.is_valid(&other.into()), "{key}");
    }
    record.remove("peaks");
    assert!(!schema.is_valid(&record.into()));
}
