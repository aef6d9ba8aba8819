//! The result of a long run, which comes with the program.

use super::Summary;
use super::agreement::parse;
use std::sync::OnceLock;

/// A series of trials that comes with the program.
#[derive(Debug)]
pub struct Series {
    /// What is measured otherwise than in the first; empty for that.
    pub otherwise: &'static str,
    /// The command that made it.
    pub command: &'static str,
    /// Its result.
    pub summary: Summary,
}

/// (Otherwise, command, result) of every series, the main one first. The others hold the scores alone.
const RESULTS: [(&str, &str, &str); 6] = [
    ("", include_str!("../../docs/trials/command.txt"), include_str!("../../docs/trials/result.json")),
    (
        "effects, none and outside causes",
        "stickslip trial --effects none,effects,outside --seeds 2 --noise \"0.3 %,1 %,3 %,10 %\" --json docs/trials/noise.json --scores-alone",
        include_str!("../../docs/trials/noise.json"),
    ),
    (
        "the same, without phases",
        "stickslip trial --effects none,effects,outside --seeds 1 --no-phase --json docs/trials/no-phase.json --scores-alone",
        include_str!("../../docs/trials/no-phase.json"),
    ),
    (
        "the same, 3 % of the readings far off",
        "stickslip trial --effects none,effects,outside --seeds 1 --outliers \"3 %\" --json docs/trials/outliers.json --scores-alone",
        include_str!("../../docs/trials/outliers.json"),
    ),
    (
        "the same, only V = 20 mm/s (96 points)",
        "stickslip trial --effects none,effects,outside --seeds 1 --conditions docs/trials/one-speed.toml --json docs/trials/one-speed.json --scores-alone",
        include_str!("../../docs/trials/one-speed.json"),
    ),
    (
        "the same, only W = 20 N (168 points)",
        "stickslip trial --effects none,effects,outside --seeds 1 --conditions docs/trials/one-load.toml --json docs/trials/one-load.json --scores-alone",
        include_str!("../../docs/trials/one-load.json"),
    ),
];

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
            assert!(series.summary.scores.iter().all(|scores| scores.visible.of > 0), "{}", series.otherwise);
        }
    }
}
