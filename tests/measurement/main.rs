//! Tables of measured steady states: every form that is read, what becomes of it, and what is said about broken ones.
//!
//! The message for each broken table is a snapshot under `snapshots`, word for word.

mod forms;
mod hostile;
mod laboratory;
mod noise;
mod oscillators;
mod ratios;
mod series;
mod survey;
mod universal;
mod workbooks;

use std::path::Path;

use stickslip::measurement::{self, Table};
use stickslip::scenario;

const BASE: &str = include_str!("../broken/base.toml");
const PRACTICE: &str = include_str!("../data/practice-1.csv");
const HEADER: &str = "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_rad,phase_rad,phase_sd_rad";
const SWEEP: &str = "[sweep]\nfrequency = 72\nspeed = 0.02\nload = 20\ndrive = 2.5e-6\n";

/// Reads a file beside a scenario that says `more` under `[measurement]`; messages name it without its folder.
fn read(name: &str, bytes: &[u8], more: &str) -> Result<Table, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = folder.path().join("scenario.toml");
    std::fs::write(folder.path().join(name), bytes).expect("a file");
    std::fs::write(&scenario, format!("{BASE}\n[measurement]\nfile = '{name}'\n{more}\n")).expect("a file");
    let told = |error: stickslip::error::Error| {
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    };
    let table = measurement::load(&scenario::load(scenario).map_err(told)?).map_err(told)?;
    Ok(table.expect("the scenario names a table"))
}

fn csv(text: &str) -> Table {
    read("table.csv", text.as_bytes(), "").unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    read("table.csv", text.as_bytes(), "").expect_err("the table is broken")
}

/// A table of the standard columns with one sound row and then `row`.
fn with_row(row: &str) -> String {
    format!("{HEADER}\n0.02,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,0.01\n{row}\n")
}

#[test]
// Long: a list of broken tables.
fn every_broken_table_has_its_message() {
    let rows = [
        ("table-text-in-a-number", "0.02,20,2.5e-6,61,n/a,1.5e-8,-0.1,0.01"),
        ("table-nan", "0.02,20,2.5e-6,61,NaN,1.5e-8,-0.1,0.01"),
        ("table-infinite", "0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-inf,0.01"),
        ("table-too-large-for-a-double", "0.02,20,2.5e-6,61,1e999,1.5e-8,-0.1,0.01"),
        ("table-negative-amplitude", "0.02,20,2.5e-6,61,-1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-frequency-zero", "0.02,20,2.5e-6,0,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-negative-load", "0.02,-20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-negative-speed", "-0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-drive-zero", "0.02,20,0,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-deviation-zero", "0.02,20,2.5e-6,61,1.5e-6,0,-0.1,0.01"),
        ("table-deviation-negative", "0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,-0.01"),
        ("table-deviation-empty", "0.02,20,2.5e-6,61,1.5e-6,,-0.1,0.01"),
        ("table-amplitude-empty", "0.02,20,2.5e-6,61,,1.5e-8,-0.1,0.01"),
        ("table-phase-in-degrees", "0.02,20,2.5e-6,61,1.5e-6,1.5e-8,-170,0.01"),
        ("table-unit-in-a-cell", "20 mm/s,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-row-too-short", "0.02,20,2.5e-6,61,1.5e-6"),
        ("table-row-too-long", "0,02,20,2.5e-6,61,1.5e-6,1.5e-8,-0.1,0.01"),
        ("table-several-problems", "0.02,20,2.5e-6,-1,x,1.5e-8,-0.1,\n0.02,W,2.5e-6,60,1,1.5e-8,-0.1,0.01"),
    ];
    for (name, row) in rows {
        insta::assert_snapshot!(name, refused(&with_row(row)));
    }
    let row = "0.02,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,0.01";
    let whole = [
        ("table-header-only", format!("{HEADER}\n")),
        ("table-remarks-only", "# nothing\n".into()),
        ("table-empty", "\n".into()),
        ("table-without-header", format!("{row}\n{row}\n")),
        ("table-column-missing", format!("{}\n{row}\n", HEADER.replace("amplitude_rad", "ampltude_rad"))),
        ("table-columns-missing", "f [Hz];A [rad]\n60;1e-6\n".into()),
        ("table-column-twice", format!("{}\n{row}\n", HEADER.replace("phase_sd_rad", "amplitude_urad"))),
        ("table-unit-of-another-kind", format!("{}\n{row}\n", HEADER.replace("speed_m_s", "speed [N]"))),
        ("table-unit-unknown", format!("{}\n{row}\n", HEADER.replace("drive_m", "drive [furlong]"))),
        ("table-phase-in-percent", format!("{}\n{row}\n", HEADER.replace("phase_rad", "phase_percent"))),
        (
            "table-decimal-commas-and-points",
            with_row("0.03,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,0.01").replace(',', ";").replacen("0.03", "0,03", 1),
        ),
        ("table-decimal-commas-and-tabs", with_row(row).replace(',', "\t").replace("0.02", "0,02")),
        (
            "table-amplitude-zero",
            "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_percent\n0,20,1e-6,60,0,1\n".into(),
        ),
        (
            "table-noise-unknown",
            "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad\n0,20,1e-6,60,1e-6\n0,20,1e-6,61,1e-6\n".into(),
        ),
    ];
    for (name, text) in whole {
        insta::assert_snapshot!(name, refused(&text));
    }
    let noise =
        "speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_percent,phase_rad\n0,20,1e-6,60,1e-6,1,0\n";
    insta::assert_snapshot!("table-phase-noise-unknown", refused(noise));
    let many: String = (0..1000).map(|n| format!("0.02,20,2.5e-6,{n},x,1.5e-8,-0.1,0.01\n")).collect();
    let message = refused(&with_row(&many));
    assert!(message.contains("`x` is not a number … and 999 more rows, lines 4 to 1002"), "{message}");
    assert!(message.matches("error: ").count() == 2, "the frequency of the first, the amplitudes of all: {message}");
}

#[test]
fn files_of_other_kinds_are_refused() {
    let fails = |name: &str, bytes: &[u8], more: &str| read(name, bytes, more).expect_err("refused");
    insta::assert_snapshot!("table-binary", fails("table.csv", b"a,b\n\x00\x01", ""));
    insta::assert_snapshot!("table-utf-16", fails("table.csv", b"\xff\xfes\0p\0", ""));
    insta::assert_snapshot!("table-of-unknown-kind", fails("table.pdf", b"x", ""));
    insta::assert_snapshot!(
        "table-mapping-without-column",
        fails("table.csv", with_row("").as_bytes(), "columns = { phase = 'phse_rad' }")
    );
    insta::assert_snapshot!(
        "table-mapping-twice",
        fails("table.csv", with_row("").as_bytes(), "columns = { phase = 'load_n', mean = 'load_n' }")
    );
    insta::assert_snapshot!(
        "table-mapping-wrong-unit",
        fails("table.csv", b"f [N]\n1\n", "columns = { frequency = 'f [N]' }")
    );
    insta::assert_snapshot!("table-record-not-a-number", fails("table.csv", b"", "record = 1.5"));
}

#[test]
fn the_measured_file_is_never_touched() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.csv");
    std::fs::write(&path, PRACTICE).expect("a file");
    let scenario = folder.path().join("own.toml");
    std::fs::write(&scenario, format!("{BASE}\n[measurement]\nfile = 'table.csv'\n")).expect("a file");
    let modified = |path: &Path| std::fs::metadata(path).and_then(|data| data.modified()).expect("a time");
    let before = modified(&path);
    let mut permissions = std::fs::metadata(&path).expect("there").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).expect("read only");
    stickslip::cli::check::execute(std::slice::from_ref(&scenario)).expect("sound");
    assert_eq!((std::fs::read(&path).expect("there"), modified(&path)), (PRACTICE.as_bytes().to_vec(), before));
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 2, "nothing is written beside it");
    std::fs::write(folder.path().join("broken.csv"), with_row("x")).expect("a file");
    std::fs::write(&scenario, format!("{BASE}\n[measurement]\nfile = 'broken.csv'\n")).expect("a file");
    let error = stickslip::cli::check::execute(&[scenario]).expect_err("ragged").to_string();
    assert!(error.contains("broken.csv:3"), "{error}");
}

#[test]
fn a_scenario_without_measurements_has_no_table() {
    assert_eq!(measurement::load(&scenario::paper()).expect("nothing to read"), None);
}

#[test]
fn nothing_panics_whatever_the_bytes() {
    let sources = [
        ("t.csv", PRACTICE.lines().take(8).collect::<Vec<_>>().join("\n")),
        ("t.uff", include_str!("../data/frf.uff").to_string()),
        (
            "t.txt",
            "series;sweep;f / Hz;F / N;a / g;phi / °;amplitude_2_m\n".to_string()
                + &(0..12).map(|n| format!("{};up;{n},5;1,{n};{n}e-3;-9{n};1\n", n / 6)).collect::<String>(),
        ),
    ];
    const SPLICES: &[&str] =
        &["9e999", "\"", ",", ";", "\t", "[", "]", "\n", "µ", "-", "nan", "#", "%", "\u{feff}", "\r", "🙂", "    -1\n"];
    let folder = tempfile::tempdir().expect("a folder");
    let mut noise = noise::Noise(99);
    let mut random = |below: usize| (noise.uniform() * below as f64) as usize;
    for (name, text) in sources {
        let path = folder.path().join("scenario.toml");
        std::fs::write(folder.path().join(name), &text).expect("a file");
        std::fs::write(&path, format!("{BASE}\n[measurement]\nfile = '{name}'\nrecord = 1\n{SWEEP}")).expect("a file");
        let scenario = scenario::load(&path).expect("sound");
        for _ in 0..1000 {
            let mut bytes = text.clone().into_bytes();
            for _ in 0..=random(4) {
                let at = random(bytes.len().max(1)).min(bytes.len().saturating_sub(1));
                match random(3) {
                    0 if !bytes.is_empty() => bytes[at] = random(256) as u8,
                    1 => drop(bytes.drain(at..(at + random(60)).min(bytes.len()))),
                    _ => drop(bytes.splice(at..at, SPLICES[random(SPLICES.len())].bytes())),
                }
            }
            std::fs::write(folder.path().join(name), &bytes).expect("a file");
            if let Err(error) = measurement::load(&scenario) {
                assert_eq!(error.exit_code(), 2, "{error}");
            }
            if let Err(error) = measurement::survey(folder.path().join(name)) {
                assert_eq!(error.exit_code(), 2, "{error}");
            }
        }
    }
}
