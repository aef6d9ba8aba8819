//! `stickslip new`: looks at a measured table, says what it sees, and writes a scenario that fits it.

mod choose;
mod describe;
mod draft;
mod write;

use super::{Global, say};
use crate::error::{Error, Result};
use crate::files;
use crate::measurement::{modes, survey, survey_between};
use crate::scenario::diagnostic::whole_file;
use draft::Draft;
use std::path::{Path, PathBuf};

/// Looks at `table` and writes the scenario to `output`, or beside the table under its name.
pub fn execute(table: &Path, output: Option<&Path>, global: &Global) -> Result<()> {
    let whole = survey(table)?;
    let modes = modes(&whole.table);
    let target = output.map_or_else(|| table.with_extension("toml"), PathBuf::from);
    if target.symlink_metadata().is_ok() {
        let title = format!("{} exists already, nothing was written", target.display());
        return Err(Error::Input(whole_file(&title, "name another file with -o, or move it away")));
    }
    if let Some(folder) = target.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
        let title = format!("{} cannot be written: there is no folder {}", target.display(), folder.display());
        return Err(Error::Input(whole_file(&title, "make it, or name another file with -o")));
    }
    let drafted = |band: Option<(f64, f64)>| {
        let seen = band.map_or_else(|| Ok(whole.clone()), |band| survey_between(table, band))?;
        Draft::new(seen, table, &modes, band)
    };
    let mut draft = drafted(modes.first().map(|mode| mode.band))?;
    let (mut text, mut chosen) = draft.best_scenario(&target, global)?;
    if let Some(band) = draft.followed_alone(&target, &text)? {
        draft = drafted(Some(band))?;
        (text, chosen) = draft.best_scenario(&target, global)?;
    }
    files::create(&target, text.as_bytes())?;
    for line in draft.description() {
        say(global, &line)?;
    }
    if let Some(chosen) = chosen {
        say(global, &format!("  note: {chosen}"))?;
    }
    say(global, &format!("wrote {}", target.display()))?;
    say(global, &format!("next: stickslip discover {}", target.display()))?;
    Ok(())
}
