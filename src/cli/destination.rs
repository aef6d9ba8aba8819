//! Where `stickslip add` and `stickslip discover` write a scenario, and the paths that it needs there.

use crate::error::{Error, Result};
use crate::scenario::diagnostic::whole_file;
use crate::scenario::edit::Editable;
use std::path::{Component, Path, PathBuf};

/// A place to write a scenario to.
#[derive(Debug)]
pub struct Target {
    /// The file.
    pub path: PathBuf,
    /// Byte order mark of the scenario, where it has one.
    pub mark: &'static str,
    /// `extends` as it has to be there, where that differs.
    pub extends: Option<String>,
    /// The measured table likewise.
    pub table: Option<String>,
}

/// The file to write; an error where it would destroy something or could not find what it needs.
pub fn find(scenario: &Path, output: Option<&Path>, file: &Editable, table: &Path) -> Result<Target> {
    let bytes = std::fs::read(scenario).map_err(Error::io("read", scenario))?;
    let mark = if bytes.starts_with("\u{feff}".as_bytes()) { "\u{feff}" } else { "" };
    let path = output.unwrap_or(scenario).to_path_buf();
    let mut target = Target { path, mark, extends: None, table: None };
    if same(&target.path, scenario) {
        return Ok(target);
    }
    let refuse = |title: String, help: &str| Err(Error::Input(whole_file(&title, help)));
    let shown = target.path.display();
    if std::iter::once(table).chain(file.parents()).any(|input| same(input, &target.path)) {
        return refuse(format!("{shown} is an input and is not overwritten"), "give -o another file");
    }
    let folder = folder(&target.path);
    if !folder.is_dir() {
        return refuse(format!("there is no folder {}", folder.display()), "make it first, or give -o another file");
    }
    if target.path.exists() {
        let title = match crate::scenario::load(&target.path) {
            // As an earlier run of the same command left it.
            Ok(other) if other.measurement.as_ref().is_some_and(|m| same(&m.file, table)) => None,
            Ok(_) => Some(format!("{shown} exists, is a scenario of other measurements and is not overwritten")),
            Err(_) => Some(format!("{shown} exists, is not a scenario and is not overwritten")),
        };
        if let Some(title) = title {
            return refuse(title, "give -o another file, or remove this one first");
        }
    }
    let [extends, table] = file.named();
    target.extends = extends.and_then(|(name, at)| elsewhere(&name, &at, folder, scenario));
    target.table = table.and_then(|(name, at)| elsewhere(&name, &at, folder, scenario));
    Ok(target)
}

impl Target {
    /// Complains where a file was changed during the fit.
    pub fn unchanged(&self, path: &Path, text: &str) -> Result<()> {
        let now = std::fs::read(path).map_err(Error::io("read", path))?;
        if now == format!("{}{text}", self.mark).as_bytes() {
            return Ok(());
        }
        let title = format!("{} was changed during the fit; nothing was written", path.display());
        Err(Error::Input(whole_file(&title, "run the command again")))
    }
}

/// A path that a scenario names, as it has to be written in another folder; nothing where it stays.
fn elsewhere(name: &str, file: &Path, to: &Path, scenario: &Path) -> Option<String> {
    let resolve = |path: &Path| path.canonicalize().ok();
    if Path::new(name).is_absolute() || resolve(to)? == resolve(folder(scenario))? {
        return None;
    }
    Some(relative(&resolve(to)?, &resolve(folder(file))?.join(file.file_name()?)))
}

/// The path of a file as seen from a folder, both absolute.
fn relative(from: &Path, to: &Path) -> String {
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return to.iter().collect::<PathBuf>().display().to_string();
    }
    let up = from[common..].iter().map(|_| "..".to_string());
    let down = to[common..].iter().map(|part: &Component<'_>| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

fn folder(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn same(one: &Path, other: &Path) -> bool {
    one == other || matches!((one.canonicalize(), other.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
