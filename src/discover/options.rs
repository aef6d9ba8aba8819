//! How a search is made: everything about it that is a choice.

use super::candidates::Candidates;
use super::next::Bounds;

pub use crate::fit::MARGIN;

/// Chance at which the right one of rival additions may leave a race for good, since on the readings seen so far
/// another is better.
pub const MISTAKE: f64 = 1e-3;

/// The policy of a search, whole. `docs/search.md` tells what each is for.
#[derive(Debug, Clone)]
// Wide: a field is an option of a search, which a user sets by its name.
pub struct SearchOptions {
    /// Most additions in one explanation. Each more costs a race.
    pub max_effects: usize,
    /// Seed of the Sobol sequence of starting points.
    pub seed: u32,
    /// Starting points that are looked at for each parameter of a candidate, over the ranges of all. Cost of the looks
    /// in proportion.
    pub starts: usize,
    /// Starting points of one candidate that are fitted at most, fewer of sliders. Cost of the first round in
    /// proportion.
    pub entrants: usize,
    /// Points of the table on which a race begins at most, spread over all series (`SearchOptions::begins_on`); every
    /// round takes twice as many.
    pub first_points: usize,
    /// Evaluations of a fit in the first round; every round takes twice as many.
    pub first_evaluations: usize,
    /// Share of the competitors that go on after a round. A quarter makes all rounds cost the same; more costs more.
    pub kept: f64,
    /// Competitors that a race ends with: these are fitted to all points to their end.
    pub survivors: usize,
    /// Hypotheses to which a further addition is looked for. Looks in proportion.
    pub beam: usize,
    /// Steady states that may be solved, each counted by what it costs. When they are spent the best so far is
    /// reported as that.
    pub budget: u64,
    /// Effects that are asked for.
    pub candidates: Candidates,
    /// Where the next measurement may be.
    pub bounds: Bounds,
}

/// Points of a series that tell its resonance apart from another: its place, width and height, and how it leans.
const OF_SERIES: usize = 5;
/// Readings that tell candidates apart at least: three for each parameter of those that have the most.
const OF_TABLE: usize = 32;

impl SearchOptions {
    /// Points on which a race begins, of a table of so many series whose points have so many readings each.
    pub(super) fn begins_on(&self, series: usize, each: f64) -> usize {
        (OF_SERIES * series).max((OF_TABLE as f64 / each).ceil() as usize).min(self.first_points)
    }

    /// What may be set by name, with its meaning.
    pub const NAMES: [(&str, &str); 9] = [
        ("max_effects", "most additions in one explanation"),
        ("starts", "starting points that are looked at for each parameter of a candidate"),
        ("entrants", "most starting points of one candidate that are fitted"),
        ("first_points", "most points of the table in the first round"),
        ("first_evaluations", "evaluations of a fit in the first round"),
        ("kept", "share of the competitors that go on after a round"),
        ("survivors", "competitors that a race ends with"),
        ("beam", "hypotheses to which a further addition is looked for"),
        ("budget", "steady states that may be solved"),
    ];

    /// Sets one of them, written `name=value`.
    ///
    /// # Errors
    /// In words, where there is no such name or the value is none for it.
    pub fn set(&mut self, setting: &str) -> Result<(), String> {
        let names = || Self::NAMES.map(|(name, _)| name).join(", ");
        let (name, value) = setting.split_once('=').ok_or_else(|| format!("`{setting}` is not written NAME=VALUE"))?;
        let (name, value) = (name.trim(), value.trim());
        let whole = |least: u64| {
            let number = value.parse::<u64>().ok().filter(|number| *number >= least);
            number.ok_or_else(|| format!("`{value}` is no value of {name}: it is a whole number from {least} on"))
        };
        match name {
            "max_effects" => self.max_effects = whole(0)? as usize,
            "starts" => self.starts = whole(1)? as usize,
            "first_points" => self.first_points = whole(8)? as usize,
            "first_evaluations" => self.first_evaluations = whole(1)? as usize,
            "entrants" => self.entrants = whole(1)? as usize,
            "survivors" => self.survivors = whole(1)? as usize,
            "beam" => self.beam = whole(1)? as usize,
            "budget" => self.budget = whole(1)?,
            "kept" => {
                let share = value.parse::<f64>().ok().filter(|share| *share > 0.0 && *share <= 1.0);
                self.kept =
                    share.ok_or_else(|| format!("`{value}` is no value of kept: it is a share above 0, at most 1"))?;
            }
            _ => return Err(format!("a search has no `{name}`; it has {}", names())),
        }
        Ok(())
    }
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            max_effects: 3,
            seed: 0,
            starts: 12,
            entrants: 8,
            first_points: 64,
            first_evaluations: 4,
            kept: 0.25,
            survivors: 6,
            beam: 4,
            budget: 1_600_000,
            candidates: Candidates::default(),
            bounds: Bounds::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_by_name_and_refused_with_what_would_do() {
        let mut options = SearchOptions::default();
        for (name, _) in SearchOptions::NAMES {
            options.set(&format!("{name} = {}", if name == "kept" { "0.5" } else { "9" })).expect(name);
        }
        assert_eq!((options.starts, options.kept, options.budget), (9, 0.5, 9));
        for (setting, expected) in [
            ("starts", "NAME=VALUE"),
            ("start=3", "no `start`; it has max_effects"),
            ("starts=0", "from 1 on"),
            ("kept=1.5", "at most 1"),
            ("beam=x", "whole number"),
        ] {
            let refused = options.set(setting).expect_err(setting);
            assert!(refused.contains(expected), "{refused}");
        }
    }
}
