//! The result of a long run, which comes with the program.

use super::Summary;
use super::agreement::parse;
use std::sync::OnceLock;

/// A series of trials that comes with the program.
pub struct Series {
    /// What is measured otherwise than in the first; empty for that.
    pub otherwise: &'static str,
    /// The command that made it.
    pub command: &'static str,
    /// Its result.
    pub summary: Summary,
}

/// (Otherwise, command, result) of every series, the main one first. The others hold the scores alone.
const RESULTS: [(&str, &str, &str); 1] =
    [("", include_str!("../../docs/trials/command.txt"), include_str!("../../docs/trials/result.json"))];

/// The results that come with the program, the main one first; none where that is of another version of the format.
pub fn committed() -> &'static [Series] {
    static SERIES: OnceLock<Vec<Series>> = OnceLock::new();
    SERIES.get_or_init(|| {
        let series = |&(otherwise, command, text): &(&'static str, &'static str, &str)| {
            Some(Series { otherwise, command: command.trim(), summary: parse(text).ok()? })
        };
        let Some(main) = series(&RESULTS[0]) else { return Vec::new() };
        std::iter::once(main).chain(RESULTS[1..].iter().filter_map(series)).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_results_that_come_with_the_program_can_be_read() {
        assert_eq!(committed().len(), RESULTS.len());
        for (index, series) in committed().iter().enumerate() {
            assert_eq!(series.summary.trials.is_empty(), index > 0, "{}", series.otherwise);
            assert_eq!(series.otherwise.is_empty(), index == 0);
            assert!(series.command.starts_with("stickslip trial ") && !series.summary.causes.is_empty());
        }
    }
}
