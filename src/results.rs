//! A folder of results, which one run at a time writes to, and in which it replaces nothing but what earlier runs left.
//!
//! The file `.stickslip` in it holds a line for every file written there, its hash and its name, put down before the
//! file is; a run holds a lock on it. A folder of an earlier version has no such list: what it holds is told by its
//! content.

use crate::error::{Error, Result};
use crate::files::{self, beginning, refused};
use crate::{interrupt, terminal};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, TryLockError};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Name of the list of a folder.
pub const LIST: &str = ".stickslip";
/// First line of the list.
const HEAD: &str = "stickslip results/1: files written here by the program, which it may replace\n";
/// Most that is read of a list: names of some hundred thousand files. One that is longer ends in a line of no use.
const LONGEST: u64 = 1 << 26;

/// A locked folder of results.
#[derive(Debug)]
pub struct Results {
    path: PathBuf,
    inputs: Vec<PathBuf>,
    list: Mutex<List>,
}

#[derive(Debug)]
struct List {
    file: File,
    /// Hashes of what was written under each name.
    known: BTreeMap<String, BTreeSet<String>>,
    /// Hash of what this run wrote.
    written: BTreeMap<String, String>,
    /// Whether the folder had no list.
    new: bool,
}

impl Results {
    /// The folder at a path, made where it does not exist; `inputs` are files that no result may replace. Waits where
    /// another run writes there, and removes what runs that were killed left half written.
    ///
    /// # Errors
    /// [`Error::Input`] where a file of another program has the name of the list; [`Error::Io`] where the operating system
    /// refuses.
    pub fn open<'a>(path: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<Self> {
        files::prepare(path)?;
        let at = path.join(LIST);
        if at.symlink_metadata().is_ok_and(|metadata| !metadata.is_file()) {
            return Err(foreign(&at));
        }
        let open = File::options().read(true).append(true).create(true).open(&at);
        let mut file = open.map_err(Error::io("write", &at))?;
        lock(&file, path).map_err(Error::io("lock", &at))?;
        let mut text = String::new();
        (&file).take(LONGEST).read_to_string(&mut text).map_err(Error::io("read", &at))?;
        let known = match text.strip_prefix(HEAD) {
            Some(lines) => parse(lines),
            // Also a head that a killed run did not finish.
            None if HEAD.starts_with(&text) => BTreeMap::new(),
            None => return Err(foreign(&at)),
        };
        let new = known.is_empty();
        if !text.starts_with(HEAD) {
            text = HEAD.into();
            let begin = file.set_len(0).and_then(|()| file.write_all(HEAD.as_bytes()));
            begin.map_err(Error::io("write", &at))?;
        }
        if !text.ends_with('\n') {
            file.write_all(b"\n").map_err(Error::io("write", &at))?;
        }
        let folders: BTreeSet<PathBuf> =
            known.keys().filter_map(|name| Some(path.join(name).parent()?.into())).collect();
        folders.iter().map(PathBuf::as_path).chain([path]).for_each(files::tidy);
        let inputs = inputs.into_iter().filter_map(|input| input.canonicalize().ok()).collect();
        let list = Mutex::new(List { file, known, written: BTreeMap::new(), new });
        Ok(Self { path: path.to_path_buf(), inputs, list })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file `name` below the folder.
    ///
    /// # Errors
    /// [`Error::Input`] where that would replace an input, another result of this run or a file that the program did not
    /// write; [`Error::Io`] where the operating system refuses.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path.join(name);
        let hash = blake3::hash(bytes).to_hex().to_string();
        let old = hash_of(&path)?;
        let mut list = self.list.lock().unwrap_or_else(PoisonError::into_inner);
        let refuse =
            |why: &str| Err(refused(&path, why, "name another folder for the results, or move that file away"));
        match list.written.get(name) {
            Some(written) if *written == hash => return Ok(()),
            Some(_) => return refuse("is another result of this run"),
            None => {}
        }
        if let Some(old) = old {
            if path.canonicalize().is_ok_and(|path| self.inputs.contains(&path)) {
                return refuse("is an input and is not overwritten");
            }
            let known = list.known.get(name).is_some_and(|hashes| hashes.contains(&old));
            if !known && old != hash && !(list.new && of_earlier_version(&path)) {
                return refuse("was not written by this program, or changed since, and is not overwritten");
            }
        }
        let at = self.path.join(LIST);
        list.file.write_all(line(&hash, name).as_bytes()).map_err(Error::io("write", at))?;
        list.written.insert(name.into(), hash);
        drop(list);
        files::replace(&path, bytes)
    }
}

/// Names that were written more than once are listed once.
impl Drop for Results {
    fn drop(&mut self) {
        let list = self.list.get_mut().unwrap_or_else(PoisonError::into_inner);
        for (name, hash) in &list.written {
            list.known.insert(name.clone(), BTreeSet::from([hash.clone()]));
        }
        let lines = list.known.iter().flat_map(|(name, hashes)| hashes.iter().map(move |hash| line(hash, name)));
        let text = HEAD.to_string() + &lines.collect::<String>();
        // Whatever fails here costs no more than lines twice.
        let _ = interrupt::whole(|| {
            list.file.set_len(HEAD.len() as u64)?;
            list.file.write_all(&text.as_bytes()[HEAD.len()..])?;
            list.file.sync_all()
        });
    }
}

fn line(hash: &str, name: &str) -> String {
    format!("{hash} {}\n", serde_json::Value::from(name))
}

fn parse(lines: &str) -> BTreeMap<String, BTreeSet<String>> {
    let mut known: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (hash, name) in lines.lines().filter_map(|line| line.split_once(' ')) {
        if let Ok(name) = serde_json::from_str::<String>(name) {
            known.entry(name).or_default().insert(hash.into());
        }
    }
    known
}

fn lock(file: &File, folder: &Path) -> std::io::Result<()> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            terminal::tell(&format!("waiting for another run that writes to {}", folder.display()));
            file.lock()
        }
        // Some network drives have no locks.
        Err(TryLockError::Error(why)) if why.kind() != std::io::ErrorKind::Unsupported => Err(why),
        _ => Ok(()),
    }
}

/// The hash of an ordinary file; nothing where there is no file.
fn hash_of(path: &Path) -> Result<Option<String>> {
    match path.symlink_metadata() {
        Err(_) => Ok(None),
        Ok(metadata) if !metadata.is_file() => {
            Err(refused(path, "is not an ordinary file and is not overwritten", "name another place, or move it away"))
        }
        Ok(_) => {
            let mut hasher = blake3::Hasher::new();
            let read = File::open(path).and_then(|file| hasher.update_reader(file).map(|_| ()));
            read.map_err(Error::io("read", path))?;
            Ok(Some(hasher.finalize().to_hex().to_string()))
        }
    }
}

fn foreign(list: &Path) -> Error {
    refused(list, "is not the list of results that the program keeps there", "name another folder for the results")
}

/// Whether a file without a list is a result of an earlier version: by what stands in it, a table or a picture in
/// pixels by the drawing or the JSON beside it.
fn of_earlier_version(path: &Path) -> bool {
    let drawing = || beginning(&path.with_extension("svg")).is_some_and(|text| drawn(&text));
    let json = || beginning(&path.with_extension("json")).is_some_and(|text| schema(&text, ""));
    let of = |test: &dyn Fn(&str) -> bool| beginning(path).is_some_and(|text| test(&text));
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("html") => of(&|text| text.contains("<meta name=\"generator\" content=\"stickslip ")),
        Some("json") => of(&|text| schema(text, "")),
        Some("svg") => drawing(),
        Some("png") => drawing(),
        Some("csv") => drawing() || json() || of(&|text| text.lines().next().is_some_and(curves)),
        _ => false,
    }
}

/// Whether this is the beginning of a JSON that the program wrote, of a `kind` such as `report`; any where that is
/// empty.
pub fn schema(text: &str, kind: &str) -> bool {
    let slash = if kind.is_empty() { "" } else { "/" };
    text.starts_with('{') && text.contains(&format!("\"schema\": \"stickslip.{kind}{slash}"))
}

fn drawn(text: &str) -> bool {
    let marks =
        ["<svg xmlns=\"http://www.w3.org/2000/svg\" width=", " role=\"img\" stroke-linejoin=\"round\">\n<title>"];
    text.starts_with(marks[0]) && text.contains(marks[1])
}

/// Whether this is the header of `curves.csv`.
fn curves(line: &str) -> bool {
    line.ends_with(",cycles,periodicity_error,status,branch")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn none() -> [&'static Path; 0] {
        []
    }

    #[test]
    fn only_what_the_program_wrote_is_replaced() {
        let dir = tempfile::tempdir().unwrap();
        let own = dir.path().join("a/own.csv");
        let results = Results::open(dir.path(), none()).unwrap();
        results.write("a/own.csv", b"1").unwrap();
        assert!(results.write("a/own.csv", b"2").unwrap_err().to_string().contains("another result of this run"));
        drop(results);
        std::fs::write(dir.path().join("a/foreign.csv"), "mine").unwrap();
        let results = Results::open(dir.path(), none()).unwrap();
        results.write("a/own.csv", b"2").unwrap();
        let told = results.write("a/foreign.csv", b"2").unwrap_err();
        assert!(told.to_string().contains("not written by this program") && told.exit_code() == 2, "{told}");
        drop(results);
        let results = Results::open(dir.path(), [own.as_path()]).unwrap();
        assert!(results.write("a/own.csv", b"3").unwrap_err().to_string().contains("is an input"));
        drop(results);
        // What was changed by hand is no longer a result.
        std::fs::write(&own, "by hand").unwrap();
        assert!(Results::open(dir.path(), none()).unwrap().write("a/own.csv", b"3").is_err());
        assert_eq!(std::fs::read_to_string(own).unwrap(), "by hand");
    }

    #[test]
    fn a_list_that_was_cut_at_any_place_does_no_harm() {
        let dir = tempfile::tempdir().unwrap();
        Results::open(dir.path(), none()).unwrap().write("own.csv", b"1").unwrap();
        let list = dir.path().join(LIST);
        let whole = std::fs::read(&list).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&list, &whole[..length]).unwrap();
            Results::open(dir.path(), none()).unwrap().write("own.csv", b"1").unwrap();
            assert_eq!(std::fs::read(&list).unwrap(), whole, "{length}");
        }
        std::fs::write(&list, "something else").unwrap();
        assert!(Results::open(dir.path(), none()).is_err());
    }
}
