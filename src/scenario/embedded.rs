//! The scenarios inside the binary, so that the command works in an empty folder.

use std::path::{Path, PathBuf};

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        /// Every file below `scenarios/`: its path there and its text.
        pub const FILES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/", $name)))),*];
    };
}

files![
    "paper/claims.toml",
    "paper/collapse.toml",
    "paper/figure-1.toml",
    "paper/figure-2.toml",
    "paper/figure-3.toml",
    "paper/figure-5.toml",
    "paper/figure-6-printed.toml",
    "paper/figure-6.toml",
    "paper/formulations.toml",
    "paper/open-question.toml",
    "paper/orbits.toml",
    "paper/regime-map.toml",
    "paper/ridge.toml",
    "paper/rig.toml",
    "practice/1/measurements.csv",
    "practice/1/scenario.toml",
    "practice/4/measurements.csv",
    "practice/4/scenario.toml",
    "practice/6/measurements.csv",
    "practice/6/scenario.toml",
];

/// The commented scenario for one's own rig; valid as it stands.
pub const TEMPLATE: &str = include_str!("template.toml");

/// The text of an embedded file by its path below `scenarios/`, e.g. `paper/claims.toml`.
pub fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(path, _)| *path == name).map(|(_, text)| *text)
}

/// Marks the path of a file inside the binary, so that it is never taken for one on disk.
const MARK: &str = "built-in:";

/// The path under which [`text`] finds an embedded file, given its path below `scenarios/`; none where there is no such
/// file.
pub(crate) fn marked(path: &Path) -> Option<PathBuf> {
    let name = path.to_string_lossy().replace('\\', "/");
    file(&name).map(|_| PathBuf::from(format!("{MARK}{name}")))
}

/// The text behind a path that the table of an embedded scenario has; none for files on disk.
pub fn text(path: &Path) -> Option<&'static str> {
    path.to_str()?.strip_prefix(MARK).and_then(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fails where a file below `scenarios/` was added, renamed or removed without its line in the list above.
    #[test]
    fn the_list_is_what_the_folder_holds() {
        fn collect(folder: &Path, prefix: &str, found: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).expect("the folder is there") {
                let entry = entry.expect("its entries can be read");
                let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
                match entry.path().is_dir() {
                    true => collect(&entry.path(), &format!("{name}/"), found),
                    false => found.push(name),
                }
            }
        }
        let mut found = Vec::new();
        collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios"), "", &mut found);
        found.retain(|name| name.ends_with(".toml") || name.ends_with(".csv"));
        found.sort();
        let mut listed: Vec<_> = FILES.iter().map(|(name, _)| *name).collect();
        listed.sort_unstable();
        assert_eq!(found, listed, "left: files in scenarios/; right: the list in this file");
    }
}
