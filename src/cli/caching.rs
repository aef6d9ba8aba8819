//! Parts of a report out of the cache and into it, with the files that belong to them.

use super::folder::{Content, Folder};
use crate::cache::{Cache, Key};
use crate::error::Result;
use crate::report::FigureView;
use clap::Args;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Whether and where results are kept.
#[derive(Debug, Clone, Default, Args)]
pub struct CacheOptions {
    /// Folder of results kept between runs [default: $XDG_CACHE_HOME/stickslip or ~/.cache/stickslip]
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Compute everything, and keep nothing for the next run
    #[arg(long)]
    no_cache: bool,
}

impl CacheOptions {
    /// The cache asked for. The usual folder is done without where it cannot be used, a named one is not.
    ///
    /// # Errors
    /// [`crate::error::Error::Io`] where the named folder cannot be written to.
    pub fn open(&self) -> Result<Cache> {
        match (&self.cache, self.no_cache) {
            (_, true) => Ok(Cache::none()),
            (Some(folder), _) => Cache::open(folder),
            (None, _) => Ok(Cache::usual_folder().and_then(|folder| Cache::open(&folder).ok()).unwrap_or_default()),
        }
    }
}

/// Something with figures.
pub trait Illustrated {
    /// Every figure.
    fn figures(&mut self) -> Vec<&mut FigureView>;
}

/// A part of a report as it is kept: drawings and tables are among the files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Part<T> {
    result: T,
    files: BTreeMap<String, Content>,
}

/// A part that was kept, its files written anew below `out`.
///
/// # Errors
/// [`crate::error::Error::Io`] where they cannot be written.
pub fn get<T: Illustrated + DeserializeOwned>(cache: &Cache, key: &Key, out: &Folder) -> Result<Option<T>> {
    let Some(Part { mut result, files }) = cache.get::<Part<T>>(key) else { return Ok(None) };
    for figure in result.figures() {
        for file in figure.files.clone() {
            let Some(place) = figure.text(&file.kind) else { continue };
            let Some(text) = files.get(&file.name).and_then(Content::text) else { return Ok(None) };
            *place = text.into();
        }
    }
    for (name, content) in &files {
        if !out.restore(name, content)? {
            return Ok(None);
        }
    }
    Ok(Some(result))
}

/// Keeps a part with the files of its figures and the `more` that belong to it, as they were written below `out`.
pub fn put<T>(cache: &Cache, key: &Key, part: &T, more: &[String], out: &Folder)
where
    T: Illustrated + Clone + PartialEq + Serialize + DeserializeOwned,
{
    if cache.folder().is_none() {
        return;
    }
    let mut result = part.clone();
    let mut names = more.to_vec();
    for figure in result.figures() {
        names.extend(figure.files.iter().map(|file| file.name.clone()));
        figure.svg.clear();
        figure.narrow = None;
        figure.csv.clear();
    }
    let files = names.into_iter().filter_map(|name| Some((out.written(&name)?, name)));
    let files = files.map(|(content, name)| (name, content)).collect();
    // A full disk or the like costs time on the next run and nothing else.
    cache.put(key, &Part { result, files });
}

/// A part out of the cache, or computed, drawn below `out` and kept; whether it was kept before.
///
/// # Errors
/// Those of the computation, and of writing its files.
pub fn or_draw<T>(cache: &Cache, key: &Key, out: &Folder, compute: impl FnOnce() -> Result<T>) -> Result<(T, bool)>
where
    T: Illustrated + Clone + PartialEq + Serialize + DeserializeOwned,
{
    if let Some(kept) = get(cache, key, out)? {
        return Ok((kept, true));
    }
    let computed = compute()?;
    put(cache, key, &computed, &[], out);
    Ok((computed, false))
}

/// A result without figures out of the cache, or computed and kept; whether it was kept before.
///
/// # Errors
/// Those of the computation.
pub fn or_compute<T>(cache: &Cache, key: &Key, compute: impl FnOnce() -> Result<T>) -> Result<(T, bool)>
where
    T: PartialEq + Serialize + DeserializeOwned,
{
    if let Some(kept) = cache.get(key) {
        return Ok((kept, true));
    }
    let computed = compute()?;
    cache.put(key, &computed);
    Ok((computed, false))
}
