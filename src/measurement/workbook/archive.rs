//! The ZIP archive that a workbook is.

use std::io::Read as _;

use flate2::Crc;
use flate2::bufread::DeflateDecoder;

use super::Read;
use crate::measurement::file::MAX_BYTES;

/// Length of the record that ends an archive, without its remark.
const END: usize = 22;
/// Length of the fixed part of an entry of the directory, and of the header before its bytes.
const ENTRY: usize = 46;
const HEADER: usize = 30;

/// An archive whose parts are unpacked one after the other, all together up to the size of a table.
pub(super) struct Archive<'a> {
    bytes: &'a [u8],
    /// Where the directory begins.
    directory: usize,
    /// Bytes that may still be unpacked.
    left: u64,
}

/// An entry of the directory.
struct Entry<'a> {
    name: &'a [u8],
    /// The fixed part.
    fields: &'a [u8],
}

impl<'a> Archive<'a> {
    pub fn of(bytes: &'a [u8]) -> Read<Self> {
        let from = bytes.len().saturating_sub(END + usize::from(u16::MAX));
        let end = bytes[from..].windows(END).rposition(|window| window.starts_with(b"PK\x05\x06"));
        let end = end.ok_or("it is no workbook, or its end is missing")?;
        let directory = number(bytes, from + end + 16, 4).ok_or("its end is missing")?;
        Ok(Self { bytes, directory, left: MAX_BYTES })
    }

    fn entries(&self) -> impl Iterator<Item = Entry<'a>> {
        let (bytes, mut at) = (self.bytes, self.directory);
        std::iter::from_fn(move || {
            let fields = piece(bytes, at, ENTRY).filter(|fields| fields.starts_with(b"PK\x01\x02"))?;
            let lengths = [28, 30, 32].map(|field| number(fields, field, 2).unwrap_or(0));
            let name = piece(bytes, at + ENTRY, lengths[0])?;
            at += ENTRY + lengths.iter().sum::<usize>();
            Some(Entry { name, fields })
        })
    }

    fn find(&self, name: &str) -> Option<Entry<'a>> {
        self.entries().find(|entry| entry.name.eq_ignore_ascii_case(name.as_bytes()))
    }

    /// Whether there is such a part.
    pub fn holds(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    /// The text of a part.
    pub fn text(&mut self, name: &str) -> Read<String> {
        let entry = self.find(name).ok_or_else(|| format!("it lacks its part {name}"))?;
        let damaged = || format!("its part {name} is damaged");
        let field = |at: usize, length: usize| number(entry.fields, at, length).ok_or_else(damaged);
        let [flags, method] = [field(8, 2)?, field(10, 2)?];
        let [sum, packed, start] = [field(16, 4)?, field(20, 4)?, field(42, 4)?];
        if flags & 1 == 1 {
            return Err("it is protected by a password".into());
        }
        let header = piece(self.bytes, start, HEADER).ok_or_else(damaged)?;
        let names = [26, 28].map(|field| number(header, field, 2).unwrap_or(0));
        let data = piece(self.bytes, start + HEADER + names[0] + names[1], packed).ok_or_else(damaged)?;
        let mut unpacked = Vec::new();
        let read = match method {
            0 => data.take(self.left + 1).read_to_end(&mut unpacked),
            8 => DeflateDecoder::new(data).take(self.left + 1).read_to_end(&mut unpacked),
            _ => return Err(format!("its part {name} is packed in a way that is not read")),
        };
        read.map_err(|_| damaged())?;
        self.left = self.left.checked_sub(unpacked.len() as u64).ok_or_else(|| {
            format!("it is too large for a table of steady states: at most {} MB are unpacked", MAX_BYTES / 1_000_000)
        })?;
        let mut check = Crc::new();
        check.update(&unpacked);
        if check.sum() as usize != sum {
            return Err(damaged());
        }
        let text = String::from_utf8(unpacked).map_err(|_| format!("its part {name} is not UTF-8 text"))?;
        Ok(text.strip_prefix('\u{feff}').map_or_else(|| text.clone(), String::from))
    }
}

/// So many bytes from a place on, where there are so many.
fn piece(bytes: &[u8], at: usize, length: usize) -> Option<&[u8]> {
    bytes.get(at..)?.get(..length)
}

/// A number of two or four bytes, the last of them the highest.
fn number(bytes: &[u8], at: usize, length: usize) -> Option<usize> {
    Some(piece(bytes, at, length)?.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte)))
}
