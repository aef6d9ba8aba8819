//! Results of earlier runs, kept in a folder under a hash of everything that they follow from.
//!
//! A name is the hash of the inputs and of the program itself (version, sources, compiler, target), so that an entry
//! never is out of date: what has changed has another name. An entry is written beside its place and moved there, so
//! that neither an interruption nor a second writer leaves half of one; it begins with the hash of what follows, and
//! one that does not match is computed again. What would not come back exactly as it went in is not kept at all.

use crate::error::Result;
use crate::files;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// First word of every entry.
const MARK: &str = "stickslip-cache/1";
/// Ending of the entries' names.
const ENDING: &str = "entry";
/// Entries that nobody asked for in this time are removed.
const UNUSED: Duration = Duration::from_secs(30 * 24 * 3600);
/// Largest entry that is read.
const MAX_BYTES: u64 = 1 << 28;
/// What the program is made of: its version and a hash of sources, dependencies, compiler and target.
pub const PROGRAM: &str = concat!(env!("CARGO_PKG_VERSION"), "+", env!("STICKSLIP_SOURCES"));

/// A folder of results, or none.
#[derive(Debug, Clone, Default)]
pub struct Cache {
    folder: Option<PathBuf>,
}

/// Name of an entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key(String);

impl Key {
    /// The name of the `kind` of result that follows from `inputs`; numbers in them count to the last bit.
    pub fn of(kind: &str, inputs: &impl Debug) -> Self {
        let text = format!("{MARK}\n{PROGRAM}\n{kind}\n{inputs:?}");
        Self(blake3::hash(text.as_bytes()).to_hex().to_string())
    }
}

impl Cache {
    /// No cache: nothing is found, nothing is kept.
    pub fn none() -> Self {
        Self::default()
    }

    /// The cache in a folder, which is made where it does not exist.
    ///
    /// # Errors
    /// [`crate::error::Error::Io`] where nothing can be written there.
    pub fn open(folder: &Path) -> Result<Self> {
        files::prepare(folder)?;
        files::tidy(folder);
        let cache = Self { folder: Some(folder.to_path_buf()) };
        cache.tidy();
        Ok(cache)
    }

    /// The folder that users' programs keep such things in: `$XDG_CACHE_HOME/stickslip`, `~/.cache/stickslip`, or
    /// `%LOCALAPPDATA%\stickslip`; none where the system names none.
    pub fn usual_folder() -> Option<PathBuf> {
        let folder = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let home = || Some(folder("HOME")?.join(".cache"));
        let base = folder("XDG_CACHE_HOME").or_else(|| if cfg!(windows) { folder("LOCALAPPDATA") } else { home() });
        Some(base?.join("stickslip"))
    }

    /// The folder, where there is one.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// What was kept under a name; nothing where there is no whole entry.
    pub fn get<T: DeserializeOwned>(&self, key: &Key) -> Option<T> {
        let path = self.path(key)?;
        let value = opened(&files::text(&path, MAX_BYTES, "").ok()?)?;
        // Only so that entries in use are not removed; a folder that cannot be written to is no reason to compute
        // again.
        if let Ok(file) = std::fs::File::options().append(true).open(&path) {
            let _ = file.set_modified(SystemTime::now());
        }
        Some(value)
    }

    /// Keeps a result, if it comes back from the entry as it is and the folder takes it; whether it was kept.
    pub fn put<T: Serialize + DeserializeOwned + PartialEq>(&self, key: &Key, value: &T) -> bool {
        let Some(path) = self.path(key) else { return false };
        let Ok(body) = serde_json::to_string(value) else { return false };
        let whole = serde_json::from_str::<T>(&body).is_ok_and(|back| back == *value);
        whole && files::replace(&path, sealed(&body).as_bytes()).is_ok()
    }

    fn path(&self, key: &Key) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(&key.0).with_extension(ENDING))
    }

    /// Removes what nobody has asked for in a long time; what cannot be removed stays.
    fn tidy(&self) {
        let entries = self.folder.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
        for entry in entries.filter(|entry| entry.path().extension().is_some_and(|ending| ending == ENDING)) {
            let age = entry.metadata().and_then(|metadata| metadata.modified()).map(|time| time.elapsed());
            if matches!(age, Ok(Ok(age)) if age > UNUSED) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

/// The text of an entry that holds this JSON.
pub fn sealed(body: &str) -> String {
    format!("{MARK} {}\n{body}", blake3::hash(body.as_bytes()).to_hex())
}

/// What the text of an entry holds; nothing where it is not whole.
pub fn opened<T: DeserializeOwned>(text: &str) -> Option<T> {
    let (_, body) = text.split_once('\n')?;
    if text == sealed(body) { serde_json::from_str(body).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_comes_back_to_the_last_bit() {
        let dir = tempfile::tempdir().unwrap();
        let cache = Cache::open(&dir.path().join("deep/cache")).unwrap();
        let key = Key::of("numbers", &(1.0, "a"));
        let numbers = vec![0.1 + 0.2, -0.0, 5e-324, f64::MAX, 1.0 / 3.0];
        assert!(cache.get::<Vec<f64>>(&key).is_none() && cache.put(&key, &numbers));
        let back: Vec<f64> = cache.get(&key).unwrap();
        assert!(back.iter().zip(&numbers).all(|(a, b)| a.to_bits() == b.to_bits()) && back.len() == numbers.len());
        assert!(cache.get::<Vec<f64>>(&Key::of("numbers", &(1.0 + f64::EPSILON, "a"))).is_none());
        assert!(!Cache::none().put(&key, &numbers) && Cache::none().get::<Vec<f64>>(&key).is_none());
    }

    #[test]
    fn what_would_not_come_back_is_not_kept() {
        let dir = tempfile::tempdir().unwrap();
        let cache = Cache::open(dir.path()).unwrap();
        assert!(!cache.put(&Key::of("nan", &0), &Some(f64::NAN)));
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
    }

    #[test]
    fn damaged_entries_are_none() {
        let dir = tempfile::tempdir().unwrap();
        let cache = Cache::open(dir.path()).unwrap();
        let key = Key::of("text", &"x");
        assert!(cache.put(&key, &"content".to_string()));
        let path = cache.path(&key).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(cache.get::<String>(&key).is_none(), "{length}");
        }
        let mut other = whole.clone();
        *other.last_mut().unwrap() ^= 1;
        std::fs::write(&path, other).unwrap();
        assert!(cache.get::<String>(&key).is_none());
        std::fs::write(&path, [0xff; 40]).unwrap();
        assert!(cache.get::<String>(&key).is_none());
        assert!(cache.put(&key, &"content".to_string()) && cache.get::<String>(&key).is_some());
    }

    #[test]
    fn entries_without_use_are_removed() {
        let dir = tempfile::tempdir().unwrap();
        let cache = Cache::open(dir.path()).unwrap();
        let (old, new) = (Key::of("a", &1), Key::of("a", &2));
        assert!(cache.put(&old, &1) && cache.put(&new, &2));
        let file = std::fs::File::options().append(true).open(cache.path(&old).unwrap()).unwrap();
        file.set_modified(SystemTime::now() - UNUSED - Duration::from_secs(60)).unwrap();
        drop(file);
        let again = Cache::open(dir.path()).unwrap();
        assert_eq!((again.get::<i32>(&old), again.get::<i32>(&new)), (None, Some(2)));
    }
}
