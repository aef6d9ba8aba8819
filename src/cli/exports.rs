//! Files of a report for pipelines: JUnit XML and a Markdown summary.

use super::folder::Folder;
use crate::error::{Error, Result};
use crate::files;
use crate::report::{self, ReportView};
use clap::Args;
use std::path::{Path, PathBuf};

/// Where they go.
#[derive(Debug, Clone, Default, Args)]
pub struct Extras {
    /// Write gates, claims and checks as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Write a summary as Markdown, e.g. for $GITHUB_STEP_SUMMARY
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
}

impl Extras {
    /// Complains where one of them would take the place of another file, or of a result in the folder `results`.
    ///
    /// # Errors
    /// [`Error::Input`] where it would.
    pub fn free(&self, results: &Path) -> Result<()> {
        for Extra { option, path, ours, .. } in self.given() {
            Folder::apart(results, option, path)?;
            files::free(path, ours)?;
        }
        let same = |a: &Path, b: &Path| std::path::absolute(a).ok() == std::path::absolute(b).ok();
        match (&self.junit, &self.markdown) {
            (Some(junit), Some(markdown)) if same(junit, markdown) => Err(Error::Input(
                "error: --junit and --markdown name the same file\n  = help: give each its own file".into(),
            )),
            _ => Ok(()),
        }
    }

    /// Writes what was asked for; the paths written.
    pub fn write(&self, view: &ReportView) -> Result<Vec<&Path>> {
        let mut written = Vec::new();
        for Extra { path, text, ours, .. } in self.given() {
            files::replace_own(path, text(view).as_bytes(), ours)?;
            written.push(path);
        }
        Ok(written)
    }

    fn given(&self) -> impl Iterator<Item = Extra<'_>> {
        let junit = self.junit.as_deref().map(|path| Extra {
            option: "--junit",
            path,
            text: report::junit,
            ours: |text| {
                let suites = ["gates", "measurements", "claims", "verification"];
                let suite = |name| text.contains(&format!("\n  <testsuite name=\"{name}\" tests="));
                text.starts_with("<?xml") && text.contains("\n<testsuites name=") && suites.into_iter().any(suite)
            },
        });
        let markdown = self.markdown.as_deref().map(|path| Extra {
            option: "--markdown",
            path,
            text: report::markdown,
            ours: |text| text.starts_with("# ") && text.contains(", comparison version "),
        });
        junit.into_iter().chain(markdown)
    }
}

/// One of them.
struct Extra<'a> {
    option: &'static str,
    path: &'a Path,
    text: fn(&ReportView) -> String,
    /// Whether a text is one that the program wrote there.
    ours: fn(&str) -> bool,
}
