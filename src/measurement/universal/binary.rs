//! Dataset 58b: the records of dataset 58 and then its numbers in binary form. They are written out as text, so that
//! there is one form to read.

use std::fmt::Write as _;

use crate::error::{Error, Result};
use crate::scenario::diagnostic::whole_file;

/// The bytes of a file with every dataset 58b as dataset 58; all others as they are.
pub(super) fn written_out(name: &str, bytes: &[u8]) -> Result<Vec<u8>> {
    let refuse = |what: &str| {
        let title = format!("`{name}`: a dataset 58b {what}");
        Err(Error::Input(whole_file(&title, "export the function again, or in ASCII (dataset 58)")))
    };
    let (mut out, mut rest, mut begins) = (Vec::with_capacity(bytes.len()), bytes, false);
    while !rest.is_empty() {
        let line = next_line(&mut rest);
        let words = String::from_utf8_lossy(line).to_lowercase();
        let words: Vec<&str> = words.split_whitespace().collect();
        if !(begins && words.first() == Some(&"58b")) {
            begins = words == ["-1"];
            out.extend_from_slice(line);
            continue;
        }
        begins = false;
        let numbers: Vec<usize> = words[1..].iter().map_while(|word| word.parse().ok()).collect();
        let [order, form, records, length, ..] = numbers[..] else {
            return refuse("does not say how its numbers are stored");
        };
        if !matches!(order, 1 | 2) || form != 2 {
            return refuse("holds numbers that are not of IEEE 754");
        }
        out.extend_from_slice(b"    58\n");
        let mut kind = String::new();
        for number in 0..records {
            if rest.is_empty() {
                return refuse("is cut off");
            }
            let record = next_line(&mut rest);
            if number == 6 {
                kind = String::from_utf8_lossy(record).chars().take(10).collect();
            }
            out.extend_from_slice(record);
        }
        let Some((body, after)) = rest.split_at_checked(length) else { return refuse("is cut off") };
        rest = after;
        // Data types 2 and 5 are of single precision, 4 and 6 of double.
        let double = matches!(kind.trim(), "4" | "6");
        out.extend_from_slice(text(body, double, order == 1).as_bytes());
        // The line that ends the numbers may follow them at once.
        if rest.first().is_some_and(|byte| !matches!(byte, b'\n' | b'\r')) {
            out.push(b'\n');
        }
    }
    Ok(out)
}

fn next_line<'a>(rest: &mut &'a [u8]) -> &'a [u8] {
    let end = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |at| at + 1);
    let (line, after) = rest.split_at(end);
    *rest = after;
    line
}

/// The numbers, one a line.
fn text(body: &[u8], double: bool, little: bool) -> String {
    let mut text = String::new();
    for bytes in body.chunks_exact(if double { 8 } else { 4 }) {
        let mut all = [0; 8];
        all[..bytes.len()].copy_from_slice(bytes);
        if !little {
            all[..bytes.len()].reverse();
        }
        let value =
            if double { f64::from_le_bytes(all) } else { f32::from_le_bytes([all[0], all[1], all[2], all[3]]).into() };
        let _ = writeln!(text, "{value:e}");
    }
    text.truncate(text.trim_end().len());
    text
}
