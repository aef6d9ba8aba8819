//! Whether a new run finds what an earlier one found.

use super::Summary;
use super::record::MAX_BYTES;
use crate::error::{Error, Result};
use crate::files;
use std::path::Path;

/// A trial of both runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Both {
    /// Its name.
    pub id: String,
    /// What the earlier run named.
    pub before: String,
    /// What this run names.
    pub now: String,
}

impl Both {
    /// Whether both named the same.
    pub fn agree(&self) -> bool {
        self.before == self.now
    }
}

/// Reads the scores that `--json` wrote.
///
/// # Errors
/// A file that cannot be read, or that is not such a result.
pub fn load(path: &Path) -> Result<Summary> {
    let help = "expected what `stickslip trial --json FILE` writes";
    parse(&files::text(path, MAX_BYTES, help)?).map_err(|why| {
        Error::Input(format!("error: `{}` is no result of trials: {why}\n  = help: {help}", path.display()))
    })
}

/// The scores that a JSON holds.
///
/// # Errors
/// What is wrong with it, in words.
pub fn parse(text: &str) -> std::result::Result<Summary, String> {
    let summary: Summary = serde_json::from_str(text).map_err(|why| why.to_string())?;
    if summary.schema != super::SCHEMA {
        return Err(format!("its schema is `{}`, not `{}`", summary.schema, super::SCHEMA));
    }
    Ok(summary)
}

/// The trials that both runs made of the same inputs.
pub fn agreement(now: &Summary, before: &Summary) -> Vec<Both> {
    let named = |record: &super::Record| record.found.as_ref().map_or("not drawn".into(), super::Found::label);
    let same = |record: &super::Record| {
        let other = before.trials.iter().find(|other| other.inputs == record.inputs && other.id == record.id)?;
        Some(Both { id: record.id.clone(), before: named(other), now: named(record) })
    };
    now.trials.iter().filter_map(same).collect()
}
