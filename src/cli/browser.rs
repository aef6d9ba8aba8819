//! A page shown in the user's browser.

use crate::terminal;
use std::path::Path;
use std::process::{Command, Stdio};

/// Shows a page with `$BROWSER`, or as the desktop shows pages; that it cannot is told and no failure.
pub fn open(page: &Path) {
    let usual = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let browser = std::env::var_os("BROWSER").filter(|name| !name.is_empty()).unwrap_or_else(|| usual.into());
    let quiet =
        Command::new(&browser).arg(page).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    if let Err(why) = quiet {
        let browser = browser.to_string_lossy();
        terminal::tell(&format!(
            "{} could not be opened with {browser}: {why}; set BROWSER, or open it by hand",
            page.display()
        ));
    }
}
