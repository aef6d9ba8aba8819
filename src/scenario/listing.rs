//! Names of scenarios and where to find them.

use std::path::{Path, PathBuf};

use super::embedded::FILES;
use super::extends;
use super::source::Store;

/// All scenario files below a folder, sorted. `claims.toml` and bases (files that, with what they extend, have neither
/// `[sweep]` nor `[measurement]`) are left out; files that cannot be read are kept, so that checking them tells why.
pub fn discover(dir: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    collect(dir, 0, &mut found);
    found.retain(|path| is_scenario(Store::Disk, path));
    found.sort();
    found
}

/// Ids of the scenarios inside the binary, bases left out.
pub fn embedded_names() -> Vec<String> {
    let written = FILES.iter().map(|(name, _)| Path::new(*name));
    let written = written.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let scenarios = written.filter(|path| is_scenario(Store::Embedded, path));
    scenarios.map(|path| id(Store::Embedded, path)).collect()
}

fn collect(dir: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(dir) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            if depth < 16 && !hidden && entry.file_name() != "target" {
                collect(&path, depth + 1, found);
            }
        } else if !hidden && path.extension().is_some_and(|ending| ending == "toml") && path.is_file() {
            found.push(path);
        }
    }
}

fn is_scenario(store: Store, path: &Path) -> bool {
    if path.file_name().is_some_and(|name| name == "claims.toml") {
        return false;
    }
    let Ok(document) = extends::read(store, path) else { return true };
    document.entries.iter().any(|entry| matches!(entry.key.as_str(), "sweep" | "measurement"))
}

/// The path below the nearest `scenarios` folder without extension; elsewhere the stem of the file.
pub(crate) fn id(store: Store, path: &Path) -> String {
    let stem = path.with_extension("");
    let words = |path: &Path| -> Vec<String> {
        path.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    if store == Store::Embedded {
        return words(&stem).join("/");
    }
    let full = words(&store.resolve(path).with_extension(""));
    match full.iter().rposition(|part| part == "scenarios") {
        Some(at) if at + 1 < full.len() => full[at + 1..].join("/"),
        _ => stem.file_name().map_or_else(|| "scenario".into(), |name| name.to_string_lossy().into_owned()),
    }
}
