//! Data flows one way: what a module may read of the others, checked on the `use` lines and paths of the source. And
//! what is long or wide says why.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Every Rust file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        match entry.path() {
            path if path.is_dir() => all.extend(files(&path)),
            path if path.extension().is_some_and(|end| end == "rs") => all.push(path),
            _ => {}
        }
    }
    all.sort();
    all
}

/// A file without comments and without the module of its unit tests, which may use whatever it likes.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.split("\n#[cfg(test)]\nmod ").next().unwrap();
    text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

/// The first names of what is read through a prefix such as `crate::`, one of a list in braces as well as a single one.
fn names_after<'a>(text: &'a str, prefix: &str) -> BTreeSet<&'a str> {
    let word = |text: &'a str| &text[..text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len())];
    let mut names = BTreeSet::new();
    for (at, _) in text.match_indices(prefix) {
        if text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':') {
            continue;
        }
        let rest = &text[at + prefix.len()..];
        let Some(list) = rest.strip_prefix('{') else {
            names.insert(word(rest));
            continue;
        };
        let mut depth = 0;
        let mut first = true;
        for (at, c) in list.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => first = true,
                c if first && !c.is_whitespace() => {
                    names.insert(word(&list[at..]));
                    first = false;
                }
                _ => {}
            }
        }
    }
    names
}

/// The modules as the page of the library lists them, which is the order in which data flows.
fn order() -> Vec<String> {
    let page = std::fs::read_to_string("src/lib.rs").unwrap();
    let listed = page.lines().filter_map(|line| line.strip_prefix("//! * "));
    let names = listed.flat_map(|line| line.split(" - ").next().unwrap().split(", "));
    names.map(|name| name.trim_matches(['[', ']', '`']).to_string()).collect()
}

/// The roots of the two crates: what computes, and what draws and tells.
const ENGINE_AND_PROGRAM: [&str; 2] = ["src/engine.rs", "src/lib.rs"];

/// The modules that the root of a crate has.
fn declared(root: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root).unwrap();
    let names = text.lines().filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod "));
    names.map(|name| name.trim_end_matches(';').to_string()).collect()
}

/// The module of the crate that a file belongs to.
fn module(path: &Path) -> String {
    let first = path.strip_prefix("src").unwrap().components().next().unwrap();
    first.as_os_str().to_str().unwrap().trim_end_matches(".rs").to_string()
}

#[test]
fn the_page_of_the_library_lists_every_module_once() {
    let mut declared: Vec<String> = ENGINE_AND_PROGRAM.into_iter().flat_map(declared).collect();
    let mut listed = order();
    declared.sort();
    listed.sort();
    assert_eq!(listed, declared, "the list of src/lib.rs beside its `mod` lines");
}

#[test]
fn the_engine_is_the_first_modules_of_that_page() {
    let [engine, program] = ENGINE_AND_PROGRAM.map(declared);
    let order = order();
    let place = |name: &String| order.iter().position(|one| one == name).unwrap();
    assert!(engine.iter().map(place).max() < program.iter().map(place).min());
}

#[test]
fn no_module_reads_one_that_comes_after_it() {
    let order = order();
    let place = |name: &str| order.iter().position(|one| one == name);
    let mut upward = Vec::new();
    for path in files(Path::new("src")) {
        let own = module(&path);
        let Some(at) = place(&own) else { continue };
        let text = code(&path);
        let later =
            names_after(&text, "crate::").into_iter().filter(|name| place(name).is_some_and(|other| other > at));
        upward.extend(later.map(|name| format!("{} reads `{name}`, which comes after `{own}`", path.display())));
    }
    assert!(upward.is_empty(), "move what is read to a module before both:\n{}", upward.join("\n"));
}

/// Files of a folder by their names, each with those that it reads; a file and the folder of its name are one.
fn readers(folder: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let name = |path: &Path| module(&Path::new("src").join(path.strip_prefix(folder).unwrap()));
    let paths: Vec<PathBuf> = files(folder).into_iter().filter(|path| *path != folder.join("mod.rs")).collect();
    let known: BTreeSet<String> = paths.iter().map(|path| name(path)).collect();
    let mut all: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in &paths {
        let depth = path.strip_prefix(folder).unwrap().components().count() - usize::from(path.ends_with("mod.rs"));
        let text = code(path);
        let own = folder.file_name().unwrap().to_str().unwrap();
        let ways = ["super::".repeat(depth), format!("crate::{own}::")];
        let read = ways.iter().flat_map(|way| names_after(&text, way)).map(String::from);
        let read = read.filter(|other| known.contains(other) && *other != name(path));
        all.entry(name(path)).or_default().extend(read);
    }
    all
}

/// Files that read, through others or at once, themselves.
fn circle(readers: &BTreeMap<String, BTreeSet<String>>) -> Vec<&String> {
    let reaches = |from: &String| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(one) = next.pop() {
            next.extend(readers[one].iter().filter(|other| seen.insert(*other)));
        }
        seen.contains(from)
    };
    readers.keys().filter(|file| reaches(file)).collect()
}

#[test]
fn no_files_of_a_folder_read_each_other_in_a_circle() {
    for name in order() {
        let folder = Path::new("src").join(&name);
        if !folder.is_dir() {
            continue;
        }
        let readers = readers(&folder);
        let circle = circle(&readers);
        assert!(circle.is_empty(), "src/{name}: {circle:?}");
    }
}

#[test]
fn what_is_read_is_found_in_every_way_of_writing_it() {
    let text = "use crate::a::B;\nuse crate::{\n c::{D, e}, f,\n};\nlet x = crate::g::h(); super::super::i::J; pub(crate) struct K;";
    assert_eq!(names_after(text, "crate::").into_iter().collect::<Vec<_>>(), ["a", "c", "f", "g"]);
    assert_eq!(names_after(text, "super::super::").into_iter().collect::<Vec<_>>(), ["i"]);
    assert!(names_after(text, "super::").contains("super"));
}

/// Most lines of a function and most fields of a struct that give no reason.
const MOST_LINES: usize = 60;
const MOST_FIELDS: usize = 11;

fn depth(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// The lines of what begins with the first of these, as rustfmt lays them out: up to the first that closes it at the
/// same depth.
fn whole<'a>(lines: &'a [&'a str]) -> &'a [&'a str] {
    let closes = |line: &str| depth(line) == depth(lines[0]) && (line.trim() == "}" || line.ends_with(';'));
    let one_line = lines[0].ends_with(['}', ';']);
    let last = (1..lines.len()).find(|at| closes(lines[*at])).unwrap_or(lines.len() - 1);
    &lines[..=if one_line { 0 } else { last }]
}

/// The name of a function or struct that begins with a line.
fn begins<'a>(line: &'a str, keyword: &str) -> Option<&'a str> {
    let (before, after) = line.split_once(keyword)?;
    let modifier = |word: &str| ["pub", "const", "async", "unsafe"].contains(&word) || word.starts_with("pub(");
    let name = after.split(|c: char| !c.is_alphanumeric() && c != '_').next()?;
    (before.split_whitespace().all(modifier) && !name.is_empty()).then_some(name)
}

/// Whether `// word: reason` stands above the item that begins at a line, attributes apart, or first in its body.
fn has_reason(lines: &[&str], at: usize, word: &str) -> bool {
    let above = lines[..at].iter().rfind(|line| !line.trim_start().starts_with("#["));
    let inside = lines[at..].iter().skip_while(|line| !line.ends_with('{')).nth(1);
    above.into_iter().chain(inside).any(|line| line.trim().starts_with(&format!("// {word}: ")))
}

/// Functions and structs of a file that are long or wide without a reason.
fn without_reason(text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let is_field = |line: &&str| line.trim_start().starts_with(char::is_alphabetic) && line.contains(": ");
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        if let Some(name) = begins(line, "fn ") {
            let count = whole(&lines[at..]).len();
            if count > MOST_LINES && !has_reason(&lines, at, "Long") {
                found.push(format!("{name} has {count} lines"));
            }
        } else if let Some(name) = begins(line, "struct ") {
            let inside = whole(&lines[at..]).iter().filter(|field| depth(field) == depth(line) + 4);
            let count = inside.filter(|line| is_field(line)).count();
            if count > MOST_FIELDS && !has_reason(&lines, at, "Wide") {
                found.push(format!("{name} has {count} fields"));
            }
        }
    }
    found
}

#[test]
fn what_is_long_or_wide_says_why() {
    let folders = ["src", "tests", "benches", "examples", "fuzz/src", "fuzz/fuzz_targets"];
    let mut silent = Vec::new();
    for path in folders.iter().flat_map(|folder| files(Path::new(folder))) {
        let text = std::fs::read_to_string(&path).unwrap();
        silent.extend(without_reason(&text).iter().map(|what| format!("{}: {what}", path.display())));
    }
    assert!(
        silent.is_empty(),
        "split these, or say in a line `// Long: ` or `// Wide: ` why not:\n{}",
        silent.join("\n")
    );
}

#[test]
fn what_is_long_or_wide_is_found_wherever_it_stands() {
    let long = |above: &str, lines: usize| {
        format!(
            "impl A {{\n{above}    pub(super) const fn f(\n        a: B,\n    ) -> C {{\n{}    }}\n}}\n",
            "        a;\n".repeat(lines - 4)
        )
    };
    assert_eq!(without_reason(&long("", 61)), ["f has 61 lines"]);
    assert_eq!(without_reason(&long("    // Long: \n", 61)), ["f has 61 lines"]);
    assert!(without_reason(&long("", 60)).is_empty());
    assert!(without_reason(&long("    // Long: one loop.\n    #[inline]\n", 61)).is_empty());
    let wide = |above: &str, fields: usize| {
        format!(
            "{above}pub struct S<'a> {{\n{}}}\n",
            "    #[serde(default)]\n    /// A: B.\n    pub a: &'a B,\n".repeat(fields)
        )
    };
    assert_eq!(without_reason(&wide("", 12)), ["S has 12 fields"]);
    assert!(without_reason(&wide("", 11)).is_empty());
    assert!(without_reason(&wide("// Wide: keys of a file.\n", 12)).is_empty());
}
