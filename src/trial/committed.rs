//! The result of a long run, which comes with the program.

use super::Summary;
use super::agreement::parse;
use std::sync::OnceLock;

/// What [`COMMAND`] wrote.
const RESULT: &str = include_str!("../../docs/trials/result.json");
/// The command that made it.
pub const COMMAND: &str = include_str!("../../docs/trials/command.txt");

/// The scores that come with the program; `None` where they are of another version of the format.
pub fn committed() -> Option<&'static Summary> {
    static SUMMARY: OnceLock<Option<Summary>> = OnceLock::new();
    SUMMARY.get_or_init(|| parse(RESULT).ok()).as_ref()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_result_that_comes_with_the_program_can_be_read() {
        let summary = parse(RESULT).unwrap();
        assert!(!summary.trials.is_empty() && !summary.causes.is_empty());
        assert!(COMMAND.starts_with("stickslip trial "));
    }
}
