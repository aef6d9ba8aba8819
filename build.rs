//! Hashes what the program is made of, so that results of one build are never taken for those of another.

#![allow(clippy::print_stdout)]

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

fn main() {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut hasher = DefaultHasher::new();
    for name in ["src", "Cargo.toml", "Cargo.lock"] {
        println!("cargo::rerun-if-changed={name}");
        visit(&root.join(name), &mut hasher);
    }
    for name in ["TARGET", "PROFILE", "OPT_LEVEL", "CARGO_CFG_TARGET_FEATURE", "CARGO_ENCODED_RUSTFLAGS"] {
        std::env::var(name).ok().hash(&mut hasher);
    }
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    if let Ok(output) = std::process::Command::new(compiler).arg("-vV").output() {
        output.stdout.hash(&mut hasher);
    }
    println!("cargo::rustc-env=STICKSLIP_SOURCES={:016x}", hasher.finish());
}

/// Every file below a path, in the order of the names.
fn visit(path: &Path, hasher: &mut DefaultHasher) {
    let Ok(entries) = std::fs::read_dir(path) else {
        path.file_name().hash(hasher);
        std::fs::read(path).ok().hash(hasher);
        return;
    };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.iter().for_each(|path| visit(path, hasher));
}
