//! Bytes inside the page: files that it can give out without its folder, and the hashes that let its own script run.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use sha2::{Digest as _, Sha256};
use std::io::Write as _;

/// Bytes of a packed file from which on it stays beside the page.
const LARGEST: usize = 150_000;

/// A text deflated and in base 64; empty for none, and for one that would burden the page.
pub fn packed(text: &str) -> String {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    let bytes = encoder.write_all(text.as_bytes()).and_then(|()| encoder.finish()).unwrap_or_default();
    if text.is_empty() || bytes.len() > LARGEST { String::new() } else { STANDARD.encode(bytes) }
}

/// The source of a content security policy that allows exactly this script or style.
pub fn source(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read as _;

    #[test]
    fn what_is_packed_can_be_unpacked() {
        let text = "frequency [Hz],amplitude [µrad]\n70,6.24\n".repeat(9);
        let packed = packed(&text);
        assert!(packed.len() < text.len());
        let mut back = String::new();
        flate2::read::DeflateDecoder::new(&*STANDARD.decode(packed).unwrap()).read_to_string(&mut back).unwrap();
        assert_eq!(back, text);
    }

    #[test]
    fn the_hash_is_that_of_the_standard() {
        assert_eq!(source(""), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
    }
}
