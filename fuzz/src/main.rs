//! A driver for stable Rust: mutates the corpora, runs every target, counts, and keeps what panics or takes long.
//!
//! `mutate [--seconds N] [--threads N] [--seed N] [--target NAME]`; the inputs of a thread follow from the seed alone.
//! `mutate --target NAME --input FILE` runs one input, and shows where it panics.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use stickslip_fuzz::{TARGETS, Target};

/// An input that takes longer is kept: the largest sheet, which a few bytes can describe, takes some seconds.
const SLOW: Duration = Duration::from_secs(10);
/// Inputs between two looks at the clock.
const ROUND: usize = 100;
/// Texts that readers look for.
const WORDS: &[&str] = &[
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "-1e-308",
    "5e-324",
    "999999999999",
    "18446744073709551616",
    "\"",
    "\n",
    "\r\n",
    "\t",
    ";",
    ",",
    "#",
    "\0",
    "\u{feff}",
    "é",
    "\u{2028}",
    "[",
    "]",
    "{",
    "}",
    "=",
    "[[effect]]",
    "\n    -1\n",
    "    58\n",
    "null",
    "true",
    "[]",
    "\\u0000",
    "'",
    "''",
    "mm/s",
    "deg",
    "%",
    "V",
    "Hz",
    "up",
    "phase_rad",
    "series",
    "<c r='XFD1048576'/>",
];

fn main() {
    let option = |name: &str| {
        let mut words = std::env::args().skip_while(|word| word != name);
        words.next().and_then(|_| words.next())
    };
    let number = |name: &str, otherwise: u64| option(name).and_then(|word| word.parse().ok()).unwrap_or(otherwise);
    let (seconds, seed) = (number("--seconds", 60), number("--seed", 1));
    let threads = number("--threads", std::thread::available_parallelism().map_or(1, |n| n.get() as u64));
    let chosen: Vec<Target> =
        TARGETS.iter().copied().filter(|(name, _)| option("--target").is_none_or(|wanted| wanted == *name)).collect();
    if let (Some(file), [(_, run)]) = (option("--input"), chosen.as_slice()) {
        let began = Instant::now();
        run(&std::fs::read(file).expect("the input"));
        println!("{:?}", began.elapsed());
        return;
    }
    std::panic::set_hook(Box::new(|_| ()));
    let mut found = 0;
    for target in &chosen {
        let each = Duration::from_secs(seconds) / chosen.len() as u32;
        let (runs, kept) = fuzz(*target, each, threads, seed);
        println!("{}: {runs} runs, {kept} kept", target.0);
        found += kept;
    }
    std::process::exit(i32::from(found > 0));
}

/// Runs a target for so long on so many threads: how many runs, and how many inputs were kept.
fn fuzz((name, run): Target, time: Duration, threads: u64, seed: u64) -> (u64, u64) {
    let corpus = corpus(name);
    let (runs, kept) = (AtomicU64::new(0), AtomicU64::new(0));
    let until = Instant::now() + time;
    std::thread::scope(|scope| {
        for thread in 0..threads {
            let (corpus, runs, kept) = (&corpus, &runs, &kept);
            scope.spawn(move || {
                let mut random = Pcg64Mcg::seed_from_u64(seed.wrapping_mul(1000).wrapping_add(thread));
                while Instant::now() < until {
                    for _ in 0..ROUND {
                        let input = mutated(corpus, &mut random);
                        let began = Instant::now();
                        let sound = catch_unwind(AssertUnwindSafe(|| run(&input))).is_ok();
                        if !sound || began.elapsed() > SLOW {
                            kept.fetch_add(1, Ordering::Relaxed);
                            keep(name, &input, if sound { "slow" } else { "panic" });
                        }
                    }
                    runs.fetch_add(ROUND as u64, Ordering::Relaxed);
                }
            });
        }
    });
    (runs.into_inner(), kept.into_inner())
}

fn folder(kind: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(kind).join(name)
}

fn corpus(name: &str) -> Vec<Vec<u8>> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder("corpus", name)).expect("a corpus").map(|file| file.expect("a file").path()).collect();
    files.sort();
    files.into_iter().map(|file| std::fs::read(file).expect("a file")).collect()
}

fn keep(name: &str, input: &[u8], kind: &str) {
    let folder = folder("artifacts", name);
    let sum = input
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3));
    let path = folder.join(format!("{kind}-{sum:016x}"));
    std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, input)).expect("a kept input");
    println!("{}", path.display());
}

/// A file of the corpus with one to eight changes.
fn mutated(corpus: &[Vec<u8>], random: &mut impl Rng) -> Vec<u8> {
    let mut bytes = corpus[random.random_range(0..corpus.len())].clone();
    for _ in 0..1 << random.random_range(0..4) {
        change(&mut bytes, corpus, random);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], random: &mut impl Rng) {
    if bytes.is_empty() {
        bytes.push(b'0');
    }
    let at = random.random_range(0..bytes.len());
    let end = (at + (1 << random.random_range(0..8))).min(bytes.len());
    match random.random_range(0..9) {
        0 => bytes[at] ^= 1 << random.random_range(0..8),
        1 => bytes[at] = random.random(),
        2 => drop(bytes.drain(at..end)),
        3 => {
            let piece = bytes[at..end].to_vec();
            let to = random.random_range(0..=bytes.len());
            drop(bytes.splice(to..to, piece));
        }
        4 => bytes.truncate(at),
        5 => {
            let word = WORDS[random.random_range(0..WORDS.len())];
            drop(bytes.splice(at..at, word.bytes()));
        }
        6 => {
            let word = WORDS[random.random_range(0..WORDS.len())];
            drop(bytes.splice(at..end, word.bytes()));
        }
        7 => {
            let other = &corpus[random.random_range(0..corpus.len())];
            let from = random.random_range(0..=other.len());
            bytes.truncate(at);
            bytes.extend(&other[from..]);
        }
        // A digit becomes another one.
        _ => {
            if let Some(digit) = bytes[at..].iter_mut().find(|byte| byte.is_ascii_digit()) {
                *digit = random.random_range(b'0'..=b'9');
            }
        }
    }
}
