//! The cache: it saves time and changes nothing else.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use std::path::{Path, PathBuf};

const SMALL: &str = r#"
extends = "rig.toml"
title = "Small"
[sweep]
frequency = { from = "60 Hz", to = "90 Hz", points = 13 }
speed = ["0 mm/s", "20 mm/s"]
load = "20 N"
drive = "2.5 um"
"#;

/// A scenario, and one with a table of few readings that are compared and searched.
fn prepare(dir: &Path) {
    let embedded = |name: &str| stickslip::scenario::embedded_file(name).unwrap();
    std::fs::write(dir.join("rig.toml"), embedded("paper/rig.toml")).unwrap();
    std::fs::write(dir.join("small.toml"), SMALL).unwrap();
    let lines = embedded("practice/4/measurements.csv").lines().enumerate().filter(|(number, _)| number % 6 == 0);
    std::fs::write(dir.join("table.csv"), lines.map(|(_, line)| line).collect::<Vec<_>>().join("\n")).unwrap();
    let text = embedded("practice/4/scenario.toml").replace("measurements.csv", "table.csv");
    std::fs::write(dir.join("measured.toml"), text).unwrap();
}

fn stickslip(dir: &Path) -> Command {
    let mut command = Command::cargo_bin("stickslip").unwrap();
    command.current_dir(dir).env("SOURCE_DATE_EPOCH", "0").env("XDG_CACHE_HOME", dir.join("home"));
    command
}

/// A report of both scenarios or of the small one below `out`; what it says of the cache has to hold `said`.
fn report(dir: &Path, out: &str, more: &[&str], said: &str) {
    let mut command = stickslip(dir);
    command.args(["report", "small.toml", "--out", out]).args(more);
    command.assert().success().stdout(contains(said.to_string()));
}

/// Every file below a folder with its bytes.
fn contents(root: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(contents(&path).into_iter().map(|(name, bytes)| (path.join(name), bytes)));
        } else {
            found.push((path.clone(), std::fs::read(&path).unwrap()));
        }
    }
    for (name, _) in &mut found {
        *name = name.strip_prefix(root).unwrap().to_path_buf();
    }
    found.sort();
    found
}

fn same(dir: &Path, one: &str, other: &str) {
    let (one, other) = (contents(&dir.join(one)), contents(&dir.join(other)));
    let names = |all: &[(PathBuf, Vec<u8>)]| all.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one), names(&other));
    for (a, b) in one.iter().zip(&other) {
        assert!(a.1 == b.1, "{} differs", a.0.display());
    }
}

#[test]
fn a_report_from_the_cache_is_the_same_bytes_and_what_changed_is_computed() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let both = ["measured.toml", "--cache", "kept"];
    report(dir, "cold", &both, "0 of 3 parts");
    report(dir, "warm", &both, "3 of 3 parts");
    same(dir, "cold", "warm");
    assert!(dir.join("warm/measured/overlay.png").is_file() && dir.join("warm/small/curves.csv").is_file());
    stickslip(dir).args(["report", "small.toml", "measured.toml", "--no-cache", "--out", "none"]).assert().success();
    same(dir, "cold", "none");

    let change = |name: &str, from: &str, to: &str| {
        let text = std::fs::read_to_string(dir.join(name)).unwrap();
        assert!(text.contains(from), "{name}: {from}");
        std::fs::write(dir.join(name), text.replacen(from, to, 1)).unwrap();
    };
    change("small.toml", "20 mm/s", "20.000001 mm/s");
    report(dir, "speed", &both, "2 of 3 parts");
    change("rig.toml", "\"990", "\"990.5");
    report(dir, "rig", &["--cache", "kept"], "1 of 2 parts");
    // The last digit of the last reading.
    let table = std::fs::read_to_string(dir.join("table.csv")).unwrap();
    let place = table.rfind(|c: char| c.is_ascii_digit()).unwrap();
    let digit = if &table[place..=place] == "1" { "2" } else { "1" };
    std::fs::write(dir.join("table.csv"), format!("{}{digit}{}", &table[..place], &table[place + 1..])).unwrap();
    report(dir, "table", &both, "2 of 3 parts");
    report(dir, "table", &both, "3 of 3 parts");
}

#[test]
fn damaged_entries_are_computed_again() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let kept = ["--cache", "kept"];
    report(dir, "cold", &kept, "0 of 2 parts");
    for damage in [
        |bytes: Vec<u8>| bytes[..bytes.len() / 2].to_vec(),
        |_: Vec<u8>| Vec::new(),
        |mut bytes: Vec<u8>| {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            bytes
        },
        |_: Vec<u8>| b"stickslip-cache/1 0000\n{}".to_vec(),
    ] {
        for (name, bytes) in contents(&dir.join("kept")) {
            std::fs::write(dir.join("kept").join(name), damage(bytes)).unwrap();
        }
        report(dir, "again", &kept, "0 of 2 parts");
        same(dir, "cold", "again");
        report(dir, "warm", &kept, "2 of 2 parts");
        same(dir, "cold", "warm");
    }
}

#[test]
fn two_processes_share_a_cache_and_nothing_half_written_is_left() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let start = |out: &str| {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("stickslip"));
        command.current_dir(dir).env("SOURCE_DATE_EPOCH", "0").stdout(std::process::Stdio::null());
        command.args(["report", "small.toml", "--cache", "kept", "--out", out]).spawn().unwrap()
    };
    let both = [start("one"), start("two")];
    for mut process in both {
        assert!(process.wait().unwrap().success());
    }
    same(dir, "one", "two");
    report(dir, "three", &["--cache", "kept"], "2 of 2 parts");
    same(dir, "one", "three");
    let names: Vec<_> = contents(&dir.join("kept")).into_iter().map(|(name, _)| name).collect();
    assert!(names.len() == 2 && names.iter().all(|name| name.extension().unwrap() == "entry"), "{names:?}");
}

#[test]
fn without_the_cache_nothing_is_read_or_written() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    stickslip(dir)
        .args(["report", "small.toml", "--no-cache"])
        .assert()
        .success()
        .stdout(contains("earlier run").not());
    assert!(!dir.join("home").exists());
    // The usual folder otherwise.
    report(dir, "output", &[], "0 of 2 parts");
    let before = contents(&dir.join("home/stickslip"));
    assert_eq!(before.len(), 2);
    for (name, _) in &before {
        std::fs::write(dir.join("home/stickslip").join(name), "x").unwrap();
    }
    stickslip(dir).args(["report", "small.toml", "--no-cache"]).assert().success();
    assert!(contents(&dir.join("home/stickslip")).iter().all(|(_, bytes)| bytes == b"x"));

    // The usual folder is done without where it cannot be used; one that was asked for is not.
    std::fs::write(dir.join("file"), "").unwrap();
    stickslip(dir).env("XDG_CACHE_HOME", dir.join("file")).args(["report", "small.toml"]).assert().success();
    let named = ["report", "small.toml", "--cache", "file/below"];
    stickslip(dir).args(named).assert().code(3).stderr(contains("file/below").and(contains("help:")));
    stickslip(dir).args(["report", "small.toml", "--cache", "a", "--no-cache"]).assert().code(2);
}
