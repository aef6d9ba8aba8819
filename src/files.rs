//! Writing files whole or not at all: beside the target first, then moved there in one step.

use std::io::Write as _;
use std::path::Path;

use crate::error::{Error, Result};

/// Creates a folder for results and tries to write there, before the work that fills it.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn prepare(folder: &Path) -> Result<()> {
    if folder.exists() && !folder.is_dir() {
        let help = "name a folder, or a path where there is nothing yet";
        return Err(Error::Input(format!("error: {} is not a folder\n  = help: {help}", folder.display())));
    }
    std::fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    tempfile::tempfile_in(folder).map_err(Error::io("write in", folder))?;
    Ok(())
}

/// Writes a file that must not exist yet, with the folders above it.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses, also where the file has appeared meanwhile.
pub fn create(path: &Path, bytes: &[u8]) -> Result<()> {
    stage(path, bytes)?.persist_noclobber(path).map_err(|error| Error::io("write", path)(error.error))?;
    Ok(())
}

/// Writes a file, replacing an earlier one.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    stage(path, bytes)?.persist(path).map_err(|error| Error::io("write", path)(error.error))?;
    Ok(())
}

/// Writes a file anew, where it is that links lead to it and with the permissions that it has.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn update(path: &Path, bytes: &[u8]) -> Result<()> {
    let Ok(path) = path.canonicalize() else { return replace(path, bytes) };
    let file = stage(&path, bytes)?;
    let permissions = std::fs::metadata(&path).map_err(Error::io("read", &path))?.permissions();
    file.as_file().set_permissions(permissions).map_err(Error::io("write", &path))?;
    file.persist(&path).map_err(|error| Error::io("write", &path)(error.error))?;
    Ok(())
}

fn stage(path: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    let mut file = tempfile::Builder::new().tempfile_in(folder).map_err(Error::io("write in", folder))?;
    file.write_all(bytes).map_err(Error::io("write", path))?;
    readable(file.as_file()).map_err(Error::io("write", path))?;
    Ok(file)
}

/// Temporary files are private; results are not.
#[cfg(unix)]
fn readable(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
