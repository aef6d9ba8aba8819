//! Scenario files: what was written (raw TOML with positions) becomes what is meant ([`Scenario`], SI, validated).
//!
//! `source` reads a file with suspicion, `written` parses it into a tree whose every key knows its place, `extends`
//! lays a file over the files that it builds on, `reader` and `axes` turn values into numbers and note problems,
//! `validate` assembles the scenario, `additions` being its effects, measurements and fit, `formula` an effect of the
//! user's own, `gate` what has to hold, `question` what it asks of the catalogue. [`parameters`] states every key, unit
//! and range once.

mod additions;
mod axes;
pub mod diagnostic;
pub mod edit;
mod embedded;
mod extends;
mod formula;
mod gate;
mod listing;
mod literal;
pub mod parameters;
mod question;
mod read_rig;
mod reader;
mod rig;
pub(crate) mod source;
mod splice;
mod types;
mod validate;
mod written;

use std::path::Path;

pub use crate::parameter::Coordinate;
pub use axes::DEFAULT_EULER_STEPS;
pub use embedded::{FILES as EMBEDDED_FILES, TEMPLATE, file as embedded_file, text as embedded_text};
pub use listing::{discover, embedded_names};
pub use rig::*;
pub use types::*;

use crate::effects::{Effect, REGISTRY};
use crate::error::{Error, Result};
use source::Store;

/// What names a scenario may use.
#[derive(Clone, Copy)]
pub struct LoadOptions<'a> {
    /// Names of figures that can be drawn.
    pub figure_names: &'a [&'a str],
    /// The catalogue of effects.
    pub effects: &'a [&'static dyn Effect],
}

impl Default for LoadOptions<'_> {
    fn default() -> Self {
        Self { figure_names: parameters::FIGURES, effects: REGISTRY }
    }
}

/// Whether a file has to be complete or only serves others to extend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Something to solve or to compare is needed.
    Complete,
    /// Neither a sweep nor measurements are needed.
    Base,
}

/// Reads and validates a scenario file.
pub fn load(path: impl AsRef<Path>) -> Result<Scenario> {
    load_with(path, &LoadOptions::default())
}

/// Reads and validates a file that others extend: it need not say what to solve.
pub fn load_base(path: impl AsRef<Path>) -> Result<Scenario> {
    open(Store::Disk, path.as_ref(), &LoadOptions::default(), Role::Base)
}

/// Validates a text as [`load`] would if it stood at `path`, where nothing needs to be yet.
pub fn load_text(path: impl AsRef<Path>, text: &str) -> Result<Scenario> {
    let path = path.as_ref();
    let source = source::Source {
        name: path.display().to_string(),
        path: path.into(),
        text: text.strip_prefix('\u{feff}').unwrap_or(text).into(),
    };
    let document = extends::read_from(Store::Disk, source)?;
    validate::scenario(&document, listing::id(Store::Disk, path), Store::Disk, &LoadOptions::default(), Role::Complete)
}

/// Like [`load`], with another set of names for figures and effects.
pub fn load_with(path: impl AsRef<Path>, options: &LoadOptions<'_>) -> Result<Scenario> {
    open(Store::Disk, path.as_ref(), options, Role::Complete)
}

/// Loads a scenario from inside the binary by its id, e.g. `paper/figure-6`.
pub fn load_embedded(name: &str) -> Result<Scenario> {
    let path = format!("{}.toml", name.trim_end_matches(".toml"));
    if embedded::file(&path).is_none() {
        let names = embedded_names();
        let near = diagnostic::nearest(name, names.iter().map(String::as_str));
        let hint =
            near.map_or_else(|| format!("there are {}", names.join(", ")), |near| format!("did you mean `{near}`?"));
        let title = format!("there is no embedded scenario {}", diagnostic::quote(name));
        return Err(Error::Input(diagnostic::whole_file(&title, &hint)));
    }
    open(Store::Embedded, Path::new(&path), &LoadOptions::default(), Role::Complete)
}

/// The paper's rig and contact with nothing to sweep: where tests and examples start.
pub fn paper() -> Scenario {
    match open(Store::Embedded, Path::new("paper/rig.toml"), &LoadOptions::default(), Role::Base) {
        Ok(scenario) => scenario,
        Err(error) => unreachable!("the embedded rig is checked by a test: {error}"),
    }
}

fn open(store: Store, path: &Path, options: &LoadOptions<'_>, role: Role) -> Result<Scenario> {
    let document = extends::read(store, path)?;
    validate::scenario(&document, listing::id(store, path), store, options, role)
}
