//! Completions and manual pages.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;

fn stickslip() -> Command {
    Command::cargo_bin("stickslip").unwrap()
}

#[test]
fn every_shell_has_completions_and_another_is_refused() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let told = contains("stickslip").and(contains("max-rms-error"));
        stickslip().args(["completions", shell]).assert().success().stdout(told);
    }
    stickslip().args(["completions", "csh"]).assert().code(2);
}

#[test]
fn every_command_has_a_manual_page() {
    stickslip().arg("man").assert().success().stdout(contains(".TH stickslip"));
    let dir = tempfile::tempdir().unwrap();
    stickslip().arg("man").arg("--out").arg(dir.path()).assert().success();
    for name in ["stickslip", "stickslip-report", "stickslip-discover"] {
        let page = std::fs::read_to_string(dir.path().join(format!("{name}.1"))).unwrap();
        assert!(page.contains(&format!(".TH {name}")), "{name}");
    }
}
