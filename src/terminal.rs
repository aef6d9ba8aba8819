//! What the program says: results on standard output, messages on standard error, each through one function.
//!
//! Names of files, titles and cells of tables are other people's text. On its way to a terminal it loses what a
//! terminal would obey rather than show.

#![allow(clippy::disallowed_methods)]

use crate::error::{Error, Result};
use crate::interrupt;
use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal as _, Write as _};

/// Writes to standard output; that its reader has gone is no error.
///
/// # Errors
/// [`Error::Io`] for anything else that goes wrong.
pub fn print(text: &str) -> Result<()> {
    let text = clean(text);
    interrupt::whole(|| written(std::io::stdout().lock().write_all(text.as_bytes())))
}

/// Lets another write to standard output, under the same rule.
///
/// # Errors
/// [`Error::Io`] for anything but that the reader has gone.
pub fn written(outcome: std::io::Result<()>) -> Result<()> {
    match outcome.and_then(|()| std::io::stdout().flush()) {
        Err(why) if why.kind() == ErrorKind::BrokenPipe => Ok(()),
        flushed => flushed.map_err(Error::io("write to", "standard output")),
    }
}

/// Ends a line that is begun on the terminal of standard error, where it is one: a bar of progress, or the `^C` of the
/// user.
pub fn end_line() {
    if shows_progress() {
        let _ = std::io::stderr().write_all(b"\n");
    }
}

/// Whether standard output is a terminal, where a reader sees plots.
pub fn shows_results() -> bool {
    std::io::stdout().is_terminal()
}

/// Whether standard error is a terminal, where progress is shown.
pub fn shows_progress() -> bool {
    std::io::stderr().is_terminal()
}

/// Writes a message and an end of line to standard error, where that can be written to.
pub fn tell(message: &str) {
    // There is nowhere left to tell that this has failed.
    let _ = std::io::stderr().lock().write_all(format!("{}\n", clean(message)).as_bytes());
}

/// The text with a sign in place of every character that a terminal would obey: control characters, but for tabs and
/// ends of lines, and those that turn the direction of what follows.
pub fn clean(text: &str) -> Cow<'_, str> {
    if !text.chars().any(obeyed) {
        return text.into();
    }
    let ends = text.replace("\r\n", "\n");
    ends.chars().map(|c| if obeyed(c) { char::REPLACEMENT_CHARACTER } else { c }).collect::<String>().into()
}

/// Whether a terminal obeys a character rather than shows it.
pub fn obeyed(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (c.is_control() && !matches!(c, '\n' | '\t'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_replaced() {
        assert_eq!(clean("Größe\tµ\r\nθ\n"), "Größe\tµ\nθ\n");
        for c in ['\0', '\u{7}', '\r', '\u{1b}', '\u{7f}', '\u{80}', '\u{9b}', '\u{9f}', '\u{202e}', '\u{2066}'] {
            assert_eq!(clean(&format!("a{c}b")), "a\u{fffd}b");
        }
    }
}
