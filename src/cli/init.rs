//! `stickslip init`: write the embedded scenarios and a commented template; never overwrite.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::scenario::{EMBEDDED_FILES, TEMPLATE};
use crate::{files, terminal};

/// Writes `scenarios/…` and `my-rig.toml` below `dir`. Where any of them exists nothing is written.
pub fn execute(dir: &Path) -> Result<()> {
    let files = targets(dir);
    refuse_existing(&files)?;
    for (path, text) in &files {
        files::create(path, text.as_bytes())?;
    }
    let (count, here, next) = (files.len(), dir.display(), dir.join("my-rig.toml"));
    terminal::print(&format!("wrote {count} files below {here}\nnext: stickslip check {}\n", next.display()))
}

fn targets(dir: &Path) -> Vec<(PathBuf, &'static str)> {
    let scenarios = EMBEDDED_FILES.iter().map(|(name, text)| (dir.join("scenarios").join(name), *text));
    scenarios.chain([(dir.join("my-rig.toml"), TEMPLATE)]).collect()
}

fn refuse_existing(files: &[(PathBuf, &str)]) -> Result<()> {
    let existing = files.iter().filter(|(path, _)| path.symlink_metadata().is_ok());
    let existing: Vec<_> = existing.map(|(path, _)| format!("  {}", path.display())).collect();
    if existing.is_empty() {
        return Ok(());
    }
    Err(Error::Input(format!(
        "error: these files exist already, nothing was written:\n{}\n  = help: name another folder, e.g. `stickslip init fresh`, or move them away",
        existing.join("\n")
    )))
}
