//! `extends`: a file and the files that it builds on, read in order and merged.

use std::path::{Path, PathBuf};

use super::diagnostic::{quote, render};
use super::source::{Source, Store, tidy};
use super::written::{Entry, Value, find, merge, parse};
use crate::error::{Error, Result};

/// Longest chain of `extends`.
const MAX_LEVELS: usize = 16;

/// A scenario as it was written, `extends` worked out.
#[derive(Debug)]
pub(crate) struct Document {
    /// The files, the one that was named first.
    pub sources: Vec<Source>,
    /// The merged top-level entries.
    pub entries: Vec<Entry>,
    /// What each file says of the origin of its numbers; empty where it says nothing.
    pub provenances: Vec<String>,
    /// BLAKE3 over all files, hex.
    pub hash: String,
}

/// Reads `path` and everything it extends.
pub(crate) fn read(store: Store, path: &Path) -> Result<Document> {
    read_from(store, store.read(path)?)
}

/// Reads everything that a file extends.
pub(crate) fn read_from(store: Store, first: Source) -> Result<Document> {
    let root = root(store, &first.path);
    let mut seen: Vec<PathBuf> = Vec::new();
    let mut sources: Vec<Source> = Vec::new();
    let mut layers: Vec<Vec<Entry>> = Vec::new();
    let mut hasher = blake3::Hasher::new();
    let mut next = Some(first);
    while let Some(source) = next.take() {
        hasher.update(&(source.text.len() as u64).to_le_bytes()).update(source.text.as_bytes());
        let mut entries = parse(&source, sources.len())?;
        seen.push(store.resolve(&source.path));
        if let Some(at) = entries.iter().position(|entry| entry.key == "extends") {
            let entry = entries.remove(at);
            let path = target(store, &source, &entry, &root, &seen)?;
            next = Some(store.read(&path)?);
        }
        sources.push(source);
        layers.push(entries);
    }
    let provenances = layers.iter().map(|entries| provenance(entries)).collect();
    let entries = layers.into_iter().rev().reduce(merge).unwrap_or_default();
    Ok(Document { sources, entries, provenances, hash: hasher.finalize().to_hex().to_string() })
}

/// What a file says of the origin of its numbers, in one line.
fn provenance(entries: &[Entry]) -> String {
    match find(entries, &["provenance"]).map(|node| &node.value) {
        Some(Value::Text(text)) => text.split_whitespace().collect::<Vec<_>>().join(" "),
        _ => String::new(),
    }
}

/// The folder that `extends` may not leave: the nearest ancestor called `scenarios`, otherwise the file's own folder.
fn root(store: Store, file: &Path) -> PathBuf {
    if store == Store::Embedded {
        return PathBuf::new();
    }
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = store.resolve(folder);
    let tree = folder.ancestors().find(|ancestor| ancestor.file_name().is_some_and(|name| name == "scenarios"));
    tree.map_or(folder.clone(), Path::to_path_buf)
}

/// The file that `extends` names, if it may be read.
fn target(store: Store, source: &Source, entry: &Entry, root: &Path, seen: &[PathBuf]) -> Result<PathBuf> {
    let fail = |title: &str, label: &str, help: &str| {
        Err(Error::Input(render(source, entry.node.place.span.clone(), title, label, help)))
    };
    let Value::Text(name) = &entry.node.value else {
        let title = format!("`extends` needs the name of one file, not {}", entry.node.value.kind());
        return fail(&title, "a string is needed", "write e.g. extends = \"rig.toml\"");
    };
    if name.trim().is_empty() || Path::new(name).is_absolute() {
        let title = "`extends` needs a path relative to this file";
        return fail(title, "not a relative path", "write e.g. extends = \"rig.toml\"");
    }
    let path = tidy(&source.path.parent().unwrap_or(Path::new("")).join(name));
    let resolved = store.resolve(&path);
    let leaves = match store {
        Store::Disk => !resolved.starts_with(root),
        Store::Embedded => path.starts_with(".."),
    };
    if leaves {
        let help = "a scenario may only extend files of its own folder, or of the `scenarios` folder that it is in; \
                    copy the file there";
        return fail(&format!("`extends` leaves the scenario's folder: {}", quote(name)), "outside the folder", help);
    }
    if seen.contains(&resolved) {
        let help = "remove one `extends` so that the chain ends in a file without it";
        return fail("`extends` goes round in a circle", "this file is already part of the chain", help);
    }
    if seen.len() >= MAX_LEVELS {
        return fail("`extends` is nested too deeply", "more than 16 levels", "merge some of the files");
    }
    match store.read(&path) {
        Ok(_) => Ok(path),
        Err(error) if store == Store::Disk && path.exists() => {
            let Error::Input(reason) = error else { return Err(error) };
            let place = render(
                source,
                entry.node.place.span.clone(),
                "the file that `extends` names cannot be used",
                "named here",
                "",
            );
            Err(Error::Input(format!("{reason}\n\n{place}")))
        }
        Err(_) => {
            let title = format!("`extends` names a file that does not exist: {}", quote(name));
            fail(
                &title,
                "no such file",
                "the path is relative to the file that contains `extends`; `stickslip init` writes the built-in scenarios",
            )
        }
    }
}
