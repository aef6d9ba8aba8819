//! Writing files whole or not at all: beside the target first, then moved there in one step.

use std::io::{Read as _, Write as _};
use std::path::Path;
use tempfile::{NamedTempFile, PersistError};

use crate::error::{Error, Result};
use crate::interrupt;

/// How names of files that are not yet whole begin and end.
const UNFINISHED: (&str, &str) = (".stickslip-", ".tmp");

/// Most that is read of a file to tell what it is.
const BEGINNING: u64 = 1 << 20;

/// The beginning of a file, as far as it is text.
pub fn beginning(path: &Path) -> Option<String> {
    ordinary(path, "").ok()?;
    let mut bytes = Vec::new();
    std::fs::File::open(path).ok()?.take(BEGINNING).read_to_end(&mut bytes).ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

/// The text of an ordinary file of at most so many bytes; `help` says which file is meant.
///
/// # Errors
/// [`Error::Input`] where it is none, [`Error::Io`] where it cannot be read.
pub fn text(path: &Path, most: u64, help: &str) -> Result<String> {
    ordinary(path, help)?;
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(Error::io("read", path))?;
    file.take(most + 1).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    if bytes.len() as u64 > most {
        return Err(refused(path, &format!("is too large: at most {} MiB are read", most >> 20), help));
    }
    String::from_utf8(bytes).map_err(|_| refused(path, "is not UTF-8 text", help))
}

/// Complains where there is no ordinary file: to open a pipe would be to wait for its writer.
///
/// # Errors
/// [`Error::Input`] naming the path.
pub fn ordinary(path: &Path, help: &str) -> Result<()> {
    match std::fs::metadata(path) {
        Err(_) => Err(refused(path, "is not there", help)),
        Ok(metadata) if metadata.is_file() => Ok(()),
        Ok(_) => Err(refused(path, "is not an ordinary file", help)),
    }
}

/// A path that is not what it should be: why, and what to do.
pub(crate) fn refused(path: &Path, why: &str, help: &str) -> Error {
    Error::Input(format!("error: {} {why}\n  = help: {help}", path.display()))
}

/// Creates a folder for results and tries to write there, before the work that fills it.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn prepare(folder: &Path) -> Result<()> {
    if folder.exists() && !folder.is_dir() {
        let help = "name a folder, or a path where there is nothing yet";
        return Err(refused(folder, "is not a folder", help));
    }
    std::fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    tempfile::tempfile_in(folder).map_err(Error::io("write in", folder))?;
    Ok(())
}

/// Removes files that a killed run left half written; one that is being written is locked, and stays.
pub fn tidy(folder: &Path) {
    let ours = |name: &str| name.starts_with(UNFINISHED.0) && name.ends_with(UNFINISHED.1);
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let left = entry.file_name().to_str().is_some_and(ours) && entry.file_type().is_ok_and(|kind| kind.is_file());
        if left && std::fs::File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Writes a file that must not exist yet, with the folders above it.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses, also where the file has appeared meanwhile.
pub fn create(path: &Path, bytes: &[u8]) -> Result<()> {
    put(path, bytes, |file| file.persist_noclobber(path))
}

/// Writes a file, replacing an earlier one.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    put(path, bytes, |file| file.persist(path))
}

/// Writes a file that is asked for by its name, in place of one that is empty or that `ours` knows as the program's
/// own.
///
/// # Errors
/// [`Error::Input`] where another file is in its place; [`Error::Io`] where the operating system refuses.
pub fn replace_own(path: &Path, bytes: &[u8], ours: impl Fn(&str) -> bool) -> Result<()> {
    free(path, ours)?;
    replace(path, bytes)
}

/// Complains where [`replace_own`] would.
///
/// # Errors
/// [`Error::Input`] naming the file.
pub fn free(path: &Path, ours: impl Fn(&str) -> bool) -> Result<()> {
    let Ok(metadata) = path.symlink_metadata() else { return Ok(()) };
    let why = if metadata.is_dir() {
        "is a folder"
    } else if !metadata.is_file() {
        "is not an ordinary file and is not overwritten"
    } else if beginning(path).is_some_and(|text| text.is_empty() || ours(&text)) {
        return Ok(());
    } else {
        "was not written by this command and is not overwritten"
    };
    Err(refused(path, why, "name another file, or move this one away"))
}

/// Writes a file anew, where it is that links lead to it and with the permissions that it has.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn update(path: &Path, bytes: &[u8]) -> Result<()> {
    let Ok(path) = path.canonicalize() else { return replace(path, bytes) };
    let permissions = std::fs::metadata(&path).map_err(Error::io("read", &path))?.permissions();
    put(&path, bytes, |file| {
        if let Err(error) = file.as_file().set_permissions(permissions) {
            return Err(PersistError { error, file });
        }
        file.persist(&path)
    })
}

/// Writes beside the place of a file, and moves that there.
fn put(
    path: &Path,
    bytes: &[u8],
    place: impl FnOnce(NamedTempFile) -> std::result::Result<std::fs::File, PersistError>,
) -> Result<()> {
    interrupt::whole(|| {
        let file = stage(path, bytes)?;
        place(file).map_err(|error| Error::io("write", path)(error.error))?;
        Ok(())
    })
}

fn stage(path: &Path, bytes: &[u8]) -> Result<NamedTempFile> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(Error::io("create the folder", folder))?;
    let builder = || tempfile::Builder::new().prefix(UNFINISHED.0).suffix(UNFINISHED.1).tempfile_in(folder);
    let mut file = builder().map_err(Error::io("write in", folder))?;
    // Some network drives have no locks.
    let _ = file.as_file().lock_shared();
    let write = file.write_all(bytes).and_then(|()| readable(file.as_file())).and_then(|()| file.as_file().sync_all());
    write.map_err(Error::io("write", path))?;
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
