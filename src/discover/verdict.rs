//! The verdict, from figures alone: the table of `docs/search.md` as one function.

use super::Verdict;

/// Share of the points at which an explanation may lack a steady state: as many readings may be far off.
const UNSOLVED: f64 = 0.1;

/// The figures of the best hypothesis that a verdict follows from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Whether the test for structure could have found any: enough neighbours along the series.
    pub testable: bool,
    /// Whether it found structure: along the series where noise is stated or scatters, or a misfit larger than the
    /// scatter.
    pub structured: bool,
    /// Whether the readings could tell what it adds from a linear law of the frequency.
    pub decidable: bool,
    /// Share of the points at which the hypothesis has no steady state.
    pub unsolved: f64,
    /// Effects that it adds.
    pub effects: usize,
    /// Numbers that it recalibrates.
    pub recalibrations: usize,
}

/// What the figures say. An addition is in the hypothesis only where it gains more than its price and the margin.
pub fn verdict(evidence: &Evidence) -> Verdict {
    let Evidence { testable, structured, decidable, unsolved, effects, recalibrations } = *evidence;
    match (testable && !structured && decidable && unsolved <= UNSOLVED, effects, recalibrations) {
        (false, ..) => Verdict::Unexplained,
        (true, 0, 0) => Verdict::NothingMissing,
        (true, 0, _) => Verdict::Recalibrate,
        (true, ..) => Verdict::EffectMissing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Evidence =
        Evidence { testable: true, structured: false, decidable: true, unsolved: 0.0, effects: 0, recalibrations: 0 };

    #[test]
    fn what_leaves_noise_is_named_by_what_it_adds() {
        assert_eq!(verdict(&GOOD), Verdict::NothingMissing);
        assert_eq!(verdict(&Evidence { recalibrations: 1, ..GOOD }), Verdict::Recalibrate);
        assert_eq!(verdict(&Evidence { effects: 1, ..GOOD }), Verdict::EffectMissing);
        assert_eq!(verdict(&Evidence { effects: 2, recalibrations: 1, ..GOOD }), Verdict::EffectMissing);
    }

    #[test]
    fn without_a_test_that_was_passed_nothing_is_explained() {
        for effects in 0..3 {
            let good = Evidence { effects, ..GOOD };
            assert_eq!(verdict(&Evidence { structured: true, ..good }), Verdict::Unexplained);
            assert_eq!(verdict(&Evidence { testable: false, ..good }), Verdict::Unexplained);
            assert_eq!(verdict(&Evidence { decidable: false, ..good }), Verdict::Unexplained);
            assert_eq!(verdict(&Evidence { unsolved: 0.2, ..good }), Verdict::Unexplained);
        }
    }
}
