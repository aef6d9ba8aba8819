//! The file of records: one line each, appended under a lock in one piece.

use super::{Record, Records, SCHEMA};
use crate::error::{Error, Result};
use crate::{files, interrupt};
use std::collections::VecDeque;
use std::fmt::Display;
use std::fs::File;
use std::io::{BufRead, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;

/// Records that are kept of a file: as many as a figure has pixels for.
const LATEST: usize = 1000;
/// Longest line that is read; a record of a hundred scenarios has some tens of thousands of bytes.
const LONGEST: u64 = 1 << 20;
/// How every record begins.
const BEGINNING: &str = "{\"schema\":\"stickslip.history/";
const HELP: &str = "give --history another folder";

/// The latest records of a file; none where there is no file yet. A last line that an interrupted writer left
/// unfinished is passed over.
///
/// # Errors
/// [`Error::Input`] naming the first line that is not a record; [`Error::Io`] where the operating system refuses.
pub fn read(path: &Path) -> Result<Records> {
    if !path.exists() {
        return Ok(Records::default());
    }
    files::ordinary(path, HELP)?;
    let file = File::open(path).map_err(Error::io("read", path))?;
    file.lock_shared().map_err(Error::io("read", path))?;
    records(BufReader::new(file), path)
}

/// The same of lines that are at hand; `path` is for messages.
///
/// # Errors
/// As of [`read`].
pub fn records(mut reader: impl BufRead, path: &Path) -> Result<Records> {
    let (mut latest, mut before, mut line) = (VecDeque::with_capacity(LATEST + 1), 0, Vec::new());
    for number in 1.. {
        line.clear();
        reader.by_ref().take(LONGEST).read_until(b'\n', &mut line).map_err(Error::io("read", path))?;
        if line.is_empty() {
            break;
        }
        let text = line.trim_ascii();
        if text.is_empty() || (!line.ends_with(b"\n") && unfinished(text)) {
            continue;
        }
        latest.push_back(record(text).map_err(|why| refused(path, number, &why))?);
        if latest.len() > LATEST {
            latest.pop_front();
            before += 1;
        }
    }
    Ok(Records { before, latest: latest.into() })
}

/// Whether this is what an interrupted writer leaves of a record.
fn unfinished(line: &[u8]) -> bool {
    let begins = line.starts_with(BEGINNING.as_bytes()) || BEGINNING.as_bytes().starts_with(line);
    begins && record(line).is_err()
}

fn record(line: &[u8]) -> std::result::Result<Record, String> {
    let text = std::str::from_utf8(line).map_err(|_| "it is not UTF-8 text".to_string())?;
    if let Ok(record) = serde_json::from_str::<Record>(text)
        && record.schema == SCHEMA
    {
        return Ok(record);
    }
    let value: serde_json::Value = serde_json::from_str(text).map_err(|why| format!("it is not JSON: {why}"))?;
    let schema = value.get("schema").and_then(serde_json::Value::as_str).unwrap_or("none");
    if schema != SCHEMA {
        let shown: String = schema.chars().filter(|c| !c.is_control()).take(60).collect();
        return Err(format!("its schema is `{shown}`; expected `{SCHEMA}`"));
    }
    serde_json::from_value(value).map_err(|why| format!("it is not a whole record: {why}"))
}

fn refused(path: &Path, line: impl Display, why: &str) -> Error {
    Error::Input(format!(
        "error: {}:{line}: this line is not the record of a run: {why}\n  = help: take the line out, or {HELP}",
        path.display()
    ))
}

/// Appends a record; what an interrupted writer left unfinished at the end is dropped first.
///
/// # Errors
/// [`Error::Input`] where the file ends in something else; [`Error::Io`] where the operating system refuses.
pub fn append(path: &Path, record: &Record) -> Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        files::prepare(folder)?;
    }
    if path.exists() {
        files::ordinary(path, HELP)?;
    }
    let line = serde_json::to_string(record).map_err(|why| Error::Unfinished(why.to_string()))? + "\n";
    let open = || -> std::io::Result<(File, u64, Vec<u8>)> {
        let mut file = File::options().read(true).append(true).create(true).open(path)?;
        file.lock()?;
        let (end, rest) = end_of_lines(&mut file)?;
        Ok((file, end, rest))
    };
    let (mut file, end, rest) = open().map_err(Error::io("write", path))?;
    let between = match rest.trim_ascii() {
        rest if rest.is_empty() || unfinished(rest) => "",
        // An editor has left out the last end of line.
        rest if self::record(rest).is_ok() => "\n",
        _ => return Err(refused(path, "its end", "it is no beginning of one either")),
    };
    let write = || {
        if between.is_empty() {
            file.set_len(end)?;
        }
        file.write_all(format!("{between}{line}").as_bytes())?;
        file.sync_all()
    };
    interrupt::whole(write).map_err(Error::io("write", path))
}

/// Where the last whole line ends, and what comes after it, as far as a line may be long.
fn end_of_lines(file: &mut File) -> std::io::Result<(u64, Vec<u8>)> {
    let size = file.seek(SeekFrom::End(0))?;
    let start = size.saturating_sub(LONGEST);
    let mut rest = Vec::new();
    file.seek(SeekFrom::Start(start))?;
    file.take(LONGEST).read_to_end(&mut rest)?;
    if let Some(place) = rest.iter().rposition(|byte| *byte == b'\n') {
        rest.drain(..=place);
    }
    Ok((size - rest.len() as u64, rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn sample(number: usize) -> Record {
        Record {
            schema: SCHEMA.into(),
            time: format!("run {number}"),
            program: "stickslip 0".into(),
            comparator: "1".into(),
            inputs: "0".repeat(64),
            misfits: BTreeMap::from([("a: calibrated".into(), number as f64 / 3.0)]),
            errors: BTreeMap::new(),
            peaks: BTreeMap::new(),
            seconds: BTreeMap::new(),
        }
    }

    #[test]
    fn records_of_many_writers_come_back_whole() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("deep/history.jsonl");
        assert_eq!(read(&path).unwrap(), Records::default());
        std::thread::scope(|scope| {
            for writer in 0..8 {
                let path = &path;
                scope.spawn(move || (0..20).for_each(|run| append(path, &sample(100 * writer + run)).unwrap()));
            }
        });
        let mut found = read(&path).unwrap().latest;
        found.sort_by(|a, b| a.misfits["a: calibrated"].total_cmp(&b.misfits["a: calibrated"]));
        let expected: Vec<Record> =
            (0..8).flat_map(|writer| (0..20).map(move |run| sample(100 * writer + run))).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn an_unfinished_line_is_passed_over_and_then_dropped() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("history.jsonl");
        append(&path, &sample(1)).unwrap();
        let half = "{\"schema\":\"stickslip.history/1\",\"ti".repeat(300);
        File::options().append(true).open(&path).unwrap().write_all(half.as_bytes()).unwrap();
        assert_eq!(read(&path).unwrap().latest, [sample(1)]);
        append(&path, &sample(2)).unwrap();
        assert_eq!(read(&path).unwrap().latest, [sample(1), sample(2)]);
        std::fs::write(&path, "{\"sch").unwrap();
        append(&path, &sample(3)).unwrap();
        assert_eq!(read(&path).unwrap().latest, [sample(3)]);
    }

    #[test]
    fn an_end_that_is_no_record_stays_as_it_is() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("history.jsonl");
        for text in ["my notes", "first\nsecond", "{\"other\": 1}"] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(append(&path, &sample(1)).unwrap_err().exit_code(), 2, "{text}");
            assert_eq!(read(&path).unwrap_err().exit_code(), 2, "{text}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        // Nor does a record lose its place for want of an end of line.
        std::fs::write(&path, serde_json::to_string(&sample(1)).unwrap()).unwrap();
        assert_eq!(read(&path).unwrap().latest, [sample(1)]);
        append(&path, &sample(2)).unwrap();
        assert_eq!(read(&path).unwrap().latest, [sample(1), sample(2)]);
    }

    #[test]
    fn of_a_long_history_the_latest_records_are_kept() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("history.jsonl");
        let line = |number: usize| serde_json::to_string(&sample(number)).unwrap() + "\n";
        std::fs::write(&path, (0..LATEST + 7).map(line).collect::<String>()).unwrap();
        let Records { before, latest } = read(&path).unwrap();
        assert_eq!((before, latest.len(), &latest[0]), (7, LATEST, &sample(7)));
        std::fs::write(&path, "x".repeat(3 << 20)).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("history.jsonl:1: "));
    }

    #[test]
    fn a_bad_line_is_named_by_its_number() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("history.jsonl");
        for (line, why) in [
            (&b"{"[..], "is not JSON"),
            (b"\xff\xfe", "not UTF-8"),
            (b"[1, 2]", "schema is `none`"),
            (b"{\"schema\":\"stickslip.history/9\"}", "expected `stickslip.history/1`"),
            (b"{\"schema\":\"stickslip.history/1\"}", "missing field"),
        ] {
            std::fs::remove_file(&path).ok();
            append(&path, &sample(1)).unwrap();
            let mut file = File::options().append(true).open(&path).unwrap();
            file.write_all(&[line, b"\n"].concat()).unwrap();
            let told = read(&path).unwrap_err();
            let text = told.to_string();
            assert!(text.contains("history.jsonl:2: ") && text.contains(why) && text.contains("help: "), "{text}");
            assert_eq!(told.exit_code(), 2);
        }
    }
}
