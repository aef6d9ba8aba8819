//! The file of records: one line each, appended under a lock in one piece.

use super::{Record, SCHEMA};
use crate::error::{Error, Result};
use crate::files;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;

/// Largest file that is read.
const MAX_BYTES: u64 = 1 << 26;
const HELP: &str = "take the line out, or give --history another folder";

/// Every record of a file, the oldest first; none where there is no file yet. A last line that an interrupted writer left
/// unfinished is passed over.
///
/// # Errors
/// [`Error::Input`] naming the first line that is not a record; [`Error::Io`] where the operating system refuses.
pub fn read(path: &Path) -> Result<Vec<Record>> {
    let mut bytes = Vec::new();
    match File::open(path) {
        Err(why) if why.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        file => {
            let file = file.map_err(Error::io("read", path))?;
            file.lock_shared().map_err(Error::io("read", path))?;
            file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
        }
    }
    if bytes.len() as u64 > MAX_BYTES {
        let help = "begin a new history: give --history another folder";
        return Err(Error::Input(format!("error: {} is larger than any history\n  = help: {help}", path.display())));
    }
    let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(&[][..], |end| &bytes[..end]);
    let lines = whole.split(|byte| *byte == b'\n').enumerate().filter(|(_, line)| !line.trim_ascii().is_empty());
    lines.map(|(index, line)| record(line).map_err(|why| refused(path, index + 1, &why))).collect()
}

fn record(line: &[u8]) -> std::result::Result<Record, String> {
    let text = std::str::from_utf8(line).map_err(|_| "it is not UTF-8 text".to_string())?;
    let value: serde_json::Value = serde_json::from_str(text).map_err(|why| format!("it is not JSON: {why}"))?;
    let schema = value.get("schema").and_then(serde_json::Value::as_str).unwrap_or("none");
    if schema != SCHEMA {
        let shown: String = schema.chars().filter(|c| !c.is_control()).take(60).collect();
        return Err(format!("its schema is `{shown}`; expected `{SCHEMA}`"));
    }
    serde_json::from_value(value).map_err(|why| format!("it is not a whole record: {why}"))
}

fn refused(path: &Path, line: usize, why: &str) -> Error {
    Error::Input(format!(
        "error: {}:{line}: this line is not the record of a run: {why}\n  = help: {HELP}",
        path.display()
    ))
}

/// Appends a record; what an interrupted writer left unfinished at the end is dropped first.
///
/// # Errors
/// [`Error::Io`] where the operating system refuses.
pub fn append(path: &Path, record: &Record) -> Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        files::prepare(folder)?;
    }
    let line = serde_json::to_string(record).map_err(|why| Error::Unfinished(why.to_string()))? + "\n";
    let write = || -> std::io::Result<()> {
        let mut file = File::options().read(true).append(true).create(true).open(path)?;
        file.lock()?;
        let end = end_of_lines(&mut file)?;
        file.set_len(end)?;
        file.write_all(line.as_bytes())?;
        file.sync_all()
    };
    write().map_err(Error::io("write", path))
}

/// Where the last whole line ends.
fn end_of_lines(file: &mut File) -> std::io::Result<u64> {
    const STEP: u64 = 4096;
    let mut end = file.seek(SeekFrom::End(0))?;
    while end > 0 {
        let start = end.saturating_sub(STEP);
        let mut piece = vec![0; (end - start) as usize];
        file.seek(SeekFrom::Start(start))?;
        file.read_exact(&mut piece)?;
        if let Some(place) = piece.iter().rposition(|byte| *byte == b'\n') {
            return Ok(start + place as u64 + 1);
        }
        end = start;
    }
    Ok(0)
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
        assert!(read(&path).unwrap().is_empty());
        std::thread::scope(|scope| {
            for writer in 0..8 {
                let path = &path;
                scope.spawn(move || (0..20).for_each(|run| append(path, &sample(100 * writer + run)).unwrap()));
            }
        });
        let mut found = read(&path).unwrap();
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
        assert_eq!(read(&path).unwrap(), [sample(1)]);
        append(&path, &sample(2)).unwrap();
        assert_eq!(read(&path).unwrap(), [sample(1), sample(2)]);
        std::fs::write(&path, "{\"sch").unwrap();
        append(&path, &sample(3)).unwrap();
        assert_eq!(read(&path).unwrap(), [sample(3)]);
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
