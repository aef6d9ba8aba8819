//! Keeps `docs/own-rig.md` true: its commands are run as a reader types them, and say what the page shows.

use assert_cmd::Command;
use std::path::Path;

const PAGE: &str = include_str!("../docs/own-rig.md");

/// A command of the page, without its comment, and the exit status that the comment states.
fn command(line: &str) -> (Vec<&str>, i32) {
    let (words, comment) = line.split_once(" #").unwrap_or((line, ""));
    let status = comment.split_once("exit ").and_then(|(_, number)| number.trim().parse().ok()).unwrap_or(0);
    (words.split_whitespace().skip(1).collect(), status)
}

/// What a line of the page's source says to this test: `<!-- key: value -->`.
fn remark<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    line.strip_prefix("<!-- ")?.strip_prefix(key)?.strip_prefix(": ")?.strip_suffix(" -->")
}

/// Everything that a command prints.
fn output(folder: &Path, line: &str) -> String {
    let (arguments, status) = command(line);
    let done = Command::cargo_bin("stickslip")
        .unwrap()
        .current_dir(folder)
        .env("SOURCE_DATE_EPOCH", "0")
        .env("XDG_CACHE_HOME", folder.join("cache"))
        .args(arguments)
        .output()
        .unwrap();
    let text = [done.stdout, done.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    assert_eq!(done.status.code(), Some(status), "{line}\n{text}");
    text
}

/// The tables beside the page, where a reader has them.
fn tables(folder: &Path) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/own-rig");
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            std::fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
    }
}

#[test]
fn every_command_of_the_page_says_what_the_page_shows() {
    let dir = tempfile::tempdir().unwrap();
    tables(dir.path());
    let (mut fence, mut there, mut run) = (None, true, 0);
    let (mut said, mut shown) = (String::new(), String::new());
    for line in PAGE.lines() {
        if let Some(language) = line.strip_prefix("```") {
            match (fence, language) {
                (None, "sh") => said.clear(),
                (None, "text") => shown.clear(),
                _ => {}
            }
            fence = if fence.is_some() { None } else { Some(language) };
        } else if fence == Some("sh") {
            if there && line.starts_with("stickslip ") {
                said.push_str(&output(dir.path(), line));
                run += 1;
            }
        } else if fence == Some("text") {
            shown.push_str(line);
            shown.push('\n');
        } else if let Some(table) = remark(line, "table") {
            // What follows is of another table, which the repository need not have.
            there = dir.path().join(table).is_file();
        } else if let Some(list) = remark(line, "in the output") {
            for phrase in list.split(" | ") {
                assert!(shown.contains(phrase), "the page does not show `{phrase}`:\n{shown}");
                assert!(!there || said.contains(phrase), "the program does not say `{phrase}`:\n{said}");
            }
            // A verdict is one only as a whole: `missing: A + B` is not `missing: A`.
            for verdict in shown.lines().filter(|line| line.contains(": missing: ")) {
                assert!(
                    !there || said.lines().any(|line| line == verdict),
                    "the program does not say `{verdict}`:\n{said}"
                );
            }
        }
    }
    assert!(fence.is_none() && run >= 6, "{run} commands");
    assert!(dir.path().join("output/report.html").is_file());
}

#[test]
fn every_marked_line_of_the_page_is_read() {
    let marked = PAGE.lines().filter(|line| line.contains("<!--")).count();
    let read = PAGE.lines().filter(|line| remark(line, "table").or(remark(line, "in the output")).is_some()).count();
    assert_eq!(marked, read);
}
