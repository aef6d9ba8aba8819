//! `stickslip init`: write the embedded scenarios and a commented template; never overwrite.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::scenario::{EMBEDDED_FILES, TEMPLATE};

/// Writes `scenarios/…` and `my-rig.toml` below `dir`. Where any of them exists nothing is written.
pub fn execute(dir: &Path) -> Result<()> {
    let files = targets(dir);
    refuse_existing(&files)?;
    for (path, text) in &files {
        write(path, text)?;
    }
    let _ = writeln!(
        std::io::stdout().lock(),
        "wrote {} files below {}\nnext: stickslip check {}",
        files.len(),
        dir.display(),
        dir.join("my-rig.toml").display()
    );
    Ok(())
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

/// Writes beside the target and moves it there in one step, unless something has appeared there meanwhile.
fn write(path: &Path, text: &str) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    let mut file = tempfile::Builder::new().tempfile_in(folder).map_err(Error::io("write in", folder))?;
    file.write_all(text.as_bytes()).map_err(Error::io("write", path))?;
    readable(file.as_file()).map_err(Error::io("write", path))?;
    file.persist_noclobber(path).map_err(|error| Error::io("write", path)(error.error))?;
    Ok(())
}

/// Temporary files are private; a scenario is not.
#[cfg(unix)]
fn readable(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
