//! Odd surroundings: names, variables, pipes and devices in place of files, few threads, little memory, long histories.

use std::path::Path;
use std::process::Command;

use super::{all_whole, contents, fails, measured, prepare, shell, stickslip, succeeds, told};

#[test]
fn threads_that_cannot_be_had_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    for (line, status, words) in [
        ("ulimit -v 100000; \"$S\" run small.toml --threads 64", 3, "64 threads could not be started"),
        ("ulimit -v 100000; RAYON_NUM_THREADS=64 \"$S\" run small.toml", 3, "64 threads could not be started"),
        ("ulimit -v 1000000; RAYON_NUM_THREADS=1000000 timeout 10 \"$S\" run small.toml", 2, "from 1 to 1024"),
        ("RAYON_NUM_THREADS=many \"$S\" run small.toml", 2, "RAYON_NUM_THREADS is `many`"),
        ("RAYON_NUM_THREADS=2 \"$S\" check small.toml", 0, ""),
        ("RAYON_NUM_THREADS= \"$S\" check small.toml", 0, ""),
    ] {
        fails(&shell(dir, line), status, words);
    }
}

#[test]
fn few_files_and_little_memory_are_told_or_suffice() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    for limit in ["-n 5", "-n 6", "-n 8", "-n 10", "-n 12", "-n 16", "-v 60000", "-v 120000", "-v 400000"] {
        for command in
            ["run small.toml", "report small.toml measured.toml --history runs", "compare measured.toml --json c.json"]
        {
            let output = shell(dir, &format!("ulimit {limit}; \"$S\" {command} --threads 2"));
            let (status, told) = (output.status.code(), told(&output));
            // Where memory ends within the work, the program is aborted; its files are whole all the same.
            let aborted = limit.starts_with("-v") && told.contains("memory allocation");
            assert!([Some(0), Some(2), Some(3)].contains(&status) || aborted, "{limit}: {command}: {status:?} {told}");
            assert!(!told.contains("panicked"), "{limit}: {command}: {told}");
            all_whole(dir);
        }
    }
    succeeds(dir, &["report", "small.toml", "measured.toml", "--history", "runs"]);
}

#[test]
fn a_history_of_a_hundred_thousand_runs_is_read_in_little_time_and_memory() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    succeeds(dir, &["report", "small.toml", "--history", "runs"]);
    let line = std::fs::read_to_string(dir.join("runs/history.jsonl")).unwrap();
    std::fs::write(dir.join("runs/history.jsonl"), line.repeat(100_000)).unwrap();
    let began = std::time::Instant::now();
    let output = shell(dir, "ulimit -v 400000; \"$S\" report small.toml --history runs --threads 2");
    assert!(output.status.success(), "{}", told(&output));
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
    let json = std::fs::read(dir.join("output/report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["history"]["runs"], 100_001);
    assert!(std::fs::read_to_string(dir.join("output/history/trend.csv")).unwrap().contains(",100001,"));
}

#[test]
fn what_is_no_ordinary_file_is_told_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    succeeds(dir, &["report", "small.toml", "--out", "base"]);
    shell(
        dir,
        "mkdir -p pipes scenarios/paper; mkfifo pipe pipe.toml pipe.csv pipes/history.jsonl scenarios/paper/claims.toml",
    );
    shell(dir, "cp small.toml scenarios/paper/; printf '%s' '[rig]' > scenarios/paper/rig.toml; ln -s loop loop");
    std::fs::write(dir.join("piped.toml"), measured("pipe.csv")).unwrap();
    std::fs::write(dir.join("endless.toml"), measured("/dev/zero")).unwrap();
    for command in [
        "check pipe.toml",
        "check /dev/zero",
        "check loop",
        "run piped.toml",
        "compare endless.toml",
        "discover piped.toml",
        "add stribeck pipe.toml",
        "add stribeck piped.toml",
        "new pipe.csv",
        "report small.toml --history pipes",
        "report small.toml --baseline pipe",
        "report small.toml --baseline /dev/zero",
        "--from pipe",
        "accept /dev/zero --baseline other",
        "accept base --baseline pipe",
        "trial --effects none --seeds 1 --agree pipe",
        "trial --effects none --seeds 1 --agree /dev/zero",
    ] {
        fails(&shell(dir, &format!("ulimit -v 2000000; timeout 20 \"$S\" {command}")), 2, "help: ");
    }
    // A ledger that is no file is none: the one in the program is read.
    assert_eq!(shell(dir, "timeout 60 \"$S\" report --no-cache --out ledger").status.code(), Some(0));
}

#[test]
fn names_and_surroundings_make_no_difference() {
    use std::os::unix::ffi::OsStrExt as _;
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    prepare(dir);
    let curves = |run: &mut Command, out: &std::ffi::OsStr| {
        let told = run.arg("--out").arg(out).output().unwrap();
        assert!(told.status.success(), "{out:?}: {}", String::from_utf8_lossy(&told.stderr));
        let found = contents(&dir.join(out)).into_iter().find(|(name, _)| name.ends_with("curves.csv"));
        found.unwrap_or_else(|| panic!("{out:?}")).1
    };
    let plain = curves(&mut stickslip(dir, &["run", "small.toml"]), "plain".as_ref());
    let names = [&b"with space.toml"[..], b"-x.toml", b"a:b*?.toml", b"new\nline.toml", b"not\xfftext.toml", b"..toml"];
    let long = [b'y'; 200];
    for (number, name) in names.into_iter().chain([&long[..]]).enumerate() {
        let path = Path::new(".").join(std::ffi::OsStr::from_bytes(name));
        // What is no text cannot be named on every file system.
        if std::fs::copy(dir.join("small.toml"), dir.join(&path)).is_err() {
            continue;
        }
        for command in ["run", "report"] {
            let out = [format!("{number} {command} ").as_bytes(), b"\xff"].concat();
            let found = curves(stickslip(dir, &[command]).arg(&path), std::ffi::OsStr::from_bytes(&out));
            assert_eq!(found, plain, "{path:?}");
        }
    }
    let surroundings: [&[(&str, &str)]; 6] = [
        &[("HOME", ""), ("XDG_CACHE_HOME", "")],
        &[("XDG_CACHE_HOME", "/proc")],
        &[("XDG_CACHE_HOME", "/dev/null")],
        &[("TERM", "dumb"), ("COLUMNS", "0"), ("LC_ALL", "C"), ("TMPDIR", "/nowhere")],
        &[("SOURCE_DATE_EPOCH", "-1")],
        &[("SOURCE_DATE_EPOCH", "99999999999999999999")],
    ];
    for (number, variables) in surroundings.into_iter().enumerate() {
        let mut run = stickslip(dir, &["report", "small.toml"]);
        run.envs(variables.iter().copied());
        assert_eq!(curves(&mut run, format!("around {number}").as_ref()), plain, "{variables:?}");
    }
    let mut bare = stickslip(dir, &["report", "small.toml"]);
    assert_eq!(curves(bare.env_clear(), "bare".as_ref()), plain);
}
