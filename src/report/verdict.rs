//! Verdicts as the report words them, and how serious each is.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a verdict is to be read, from good to bad; decides symbol, colour and order, never the words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tone {
    /// As it should be.
    Good,
    /// Right, with something to know.
    Caveat,
    /// Cannot be decided from what is given.
    Open,
    /// Wrong, or not obtained.
    Bad,
}

impl Tone {
    /// Name of the style class.
    pub fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Caveat => "caveat",
            Self::Open => "open",
            Self::Bad => "bad",
        }
    }

    /// Symbol shown beside the words, so that colour is never the only sign.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Good => "✓",
            Self::Caveat => "!",
            Self::Open => "?",
            Self::Bad => "✗",
        }
    }

    /// The tone of any verdict the report words; unknown words count as undecided.
    pub fn of(words: &str) -> Self {
        let claims = Verdict::ALL.iter().map(|v| (v.words(), v.tone()));
        let scenarios = Completeness::ALL.iter().map(|v| (v.words(), v.tone()));
        let checks = Agreement::ALL.iter().map(|v| (v.words(), v.tone()));
        let matches = Match::ALL.iter().map(|v| (v.words(), v.tone()));
        let found = Found::ALL.iter().map(|v| (v.words(), v.tone()));
        let gates = Passed::ALL.iter().map(|v| (v.words(), v.tone()));
        let changes = Change::ALL.iter().map(|v| (v.words(), v.tone()));
        claims
            .chain(scenarios)
            .chain(checks)
            .chain(matches)
            .chain(found)
            .chain(gates)
            .chain(changes)
            .find(|(w, _)| *w == words)
            .map_or(Self::Open, |(_, tone)| tone)
    }
}

/// Verdict on a published claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, JsonSchema, Serialize, Deserialize)]
pub enum Verdict {
    /// The computed value agrees within the tolerance.
    #[serde(rename = "reproduced")]
    Reproduced,
    /// It agrees, under a condition that the note states.
    #[serde(rename = "reproduced with a caveat")]
    Caveat,
    /// The printed values contradict the claim; the note says which value would make it follow.
    #[serde(rename = "not reproducible from the printed values")]
    NotReproducible,
    /// The program should have reproduced it and did not.
    #[default]
    #[serde(rename = "failed")]
    Failed,
}

impl Verdict {
    /// All verdicts, the most serious first.
    pub const ALL: [Self; 4] = [Self::Failed, Self::NotReproducible, Self::Caveat, Self::Reproduced];

    /// The words of the report and of the JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::Caveat => "reproduced with a caveat",
            Self::NotReproducible => "not reproducible from the printed values",
            Self::Failed => "failed",
        }
    }

    /// How it is to be read.
    pub fn tone(self) -> Tone {
        match self {
            Self::Reproduced => Tone::Good,
            Self::Caveat => Tone::Caveat,
            Self::NotReproducible => Tone::Open,
            Self::Failed => Tone::Bad,
        }
    }
}

/// Whether every point of a scenario is a steady state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, JsonSchema, Serialize, Deserialize)]
pub enum Completeness {
    /// All points are steady.
    #[serde(rename = "all points steady")]
    Steady,
    /// Some points excite themselves; their numbers are lock-in averages.
    #[serde(rename = "some points self-excited")]
    SelfExcited,
    /// Some points have no answer.
    #[serde(rename = "some points failed")]
    Failed,
}

impl Completeness {
    /// All of them, the most serious first.
    pub const ALL: [Self; 3] = [Self::Failed, Self::SelfExcited, Self::Steady];

    /// The words of the report and of the JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Steady => "all points steady",
            Self::SelfExcited => "some points self-excited",
            Self::Failed => "some points failed",
        }
    }

    /// How it is to be read.
    pub fn tone(self) -> Tone {
        match self {
            Self::Steady => Tone::Good,
            Self::SelfExcited => Tone::Caveat,
            Self::Failed => Tone::Bad,
        }
    }
}

/// What a model leaves of its measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, JsonSchema, Serialize, Deserialize)]
pub enum Match {
    /// A misfit that noise would not have: something is missing or wrong.
    #[serde(rename = "structured misfit")]
    Structured,
    /// No structure, but more than the stated noise.
    #[serde(rename = "noise larger than stated")]
    Noisy,
    /// Too few neighbouring readings to test it.
    #[serde(rename = "not tested")]
    Untested,
    /// Noise.
    #[serde(rename = "within the noise")]
    Noise,
}

impl Match {
    /// All of them, the most serious first.
    pub const ALL: [Self; 4] = [Self::Structured, Self::Noisy, Self::Untested, Self::Noise];

    /// The words of the report and of the JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Structured => "structured misfit",
            Self::Noisy => "noise larger than stated",
            Self::Untested => "not tested",
            Self::Noise => "within the noise",
        }
    }

    /// How it is to be read.
    pub fn tone(self) -> Tone {
        match self {
            Self::Structured => Tone::Bad,
            Self::Noisy => Tone::Caveat,
            Self::Untested => Tone::Open,
            Self::Noise => Tone::Good,
        }
    }
}

/// What a discovery makes of a table of measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, JsonSchema, Serialize, Deserialize)]
pub enum Found {
    /// Structured misfit is left whatever is added.
    #[serde(rename = "unexplained")]
    Unexplained,
    /// Effects explain the misfit.
    #[serde(rename = "explained by an effect")]
    Effect,
    /// A number of rig or instrument explains it.
    #[serde(rename = "explained by recalibration")]
    Recalibrated,
    /// There is no misfit to explain.
    #[serde(rename = "nothing missing")]
    Nothing,
}

impl Found {
    /// All of them, the most serious first.
    pub const ALL: [Self; 4] = [Self::Unexplained, Self::Effect, Self::Recalibrated, Self::Nothing];

    /// The word for a verdict.
    pub fn of(verdict: crate::discover::Verdict) -> Self {
        use crate::discover::Verdict;
        match verdict {
            Verdict::Unexplained => Self::Unexplained,
            Verdict::EffectMissing => Self::Effect,
            Verdict::Recalibrate => Self::Recalibrated,
            Verdict::NothingMissing => Self::Nothing,
        }
    }

    /// The words of the report and of the JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Unexplained => "unexplained",
            Self::Effect => "explained by an effect",
            Self::Recalibrated => "explained by recalibration",
            Self::Nothing => "nothing missing",
        }
    }

    /// How it is to be read.
    pub fn tone(self) -> Tone {
        match self {
            Self::Unexplained => Tone::Bad,
            Self::Effect | Self::Recalibrated => Tone::Caveat,
            Self::Nothing => Tone::Good,
        }
    }
}

/// Verdict on a number that proves the solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, JsonSchema, Serialize, Deserialize)]
pub enum Agreement {
    /// The difference is within the tolerance.
    #[serde(rename = "agrees")]
    Agrees,
    /// It is not.
    #[default]
    #[serde(rename = "disagrees")]
    Disagrees,
}

impl Agreement {
    /// Both, the serious one first.
    pub const ALL: [Self; 2] = [Self::Disagrees, Self::Agrees];

    /// The words of the report and of the JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Disagrees => "disagrees",
        }
    }

    /// How it is to be read.
    pub fn tone(self) -> Tone {
        match self {
            Self::Agrees => Tone::Good,
            Self::Disagrees => Tone::Bad,
        }
    }
}

/// Verdict on a gate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, JsonSchema, Serialize, Deserialize)]
pub enum Passed {
    /// What is demanded holds.
    #[serde(rename = "gate passed")]
    Yes,
    /// It does not.
    #[serde(rename = "gate failed")]
    No,
}

impl Passed {
    /// Both, the serious one first.
    pub const ALL: [Self; 2] = [Self::No, Self::Yes];

    /// The words of the report and of the JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Yes => "gate passed",
            Self::No => "gate failed",
        }
    }

    /// How it is to be read.
    pub fn tone(self) -> Tone {
        match self {
            Self::Yes => Tone::Good,
            Self::No => Tone::Bad,
        }
    }
}

/// What became of a value since an earlier run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, JsonSchema, Serialize, Deserialize)]
pub enum Change {
    /// It is worse.
    #[serde(rename = "regressed")]
    Regressed,
    /// It is another one, for good or bad.
    #[serde(rename = "changed")]
    Changed,
    /// Only the earlier run had it.
    #[serde(rename = "gone")]
    Gone,
    /// Only this run has it.
    #[serde(rename = "new")]
    New,
    /// It is better.
    #[serde(rename = "improved")]
    Improved,
}

impl Change {
    /// All of them, the most serious first.
    pub const ALL: [Self; 5] = [Self::Regressed, Self::Changed, Self::Gone, Self::New, Self::Improved];

    /// The words of the report and of the JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Regressed => "regressed",
            Self::Changed => "changed",
            Self::Gone => "gone",
            Self::New => "new",
            Self::Improved => "improved",
        }
    }

    /// How it is to be read.
    pub fn tone(self) -> Tone {
        match self {
            Self::Regressed => Tone::Bad,
            Self::Changed => Tone::Caveat,
            Self::Gone | Self::New => Tone::Open,
            Self::Improved => Tone::Good,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_are_those_of_the_json_and_carry_their_tone() {
        for verdict in Verdict::ALL {
            assert_eq!(serde_json::to_value(verdict).unwrap(), verdict.words());
            assert_eq!(Tone::of(verdict.words()), verdict.tone());
        }
        for verdict in Completeness::ALL {
            assert_eq!(serde_json::to_value(verdict).unwrap(), verdict.words());
            assert_eq!(Tone::of(verdict.words()), verdict.tone());
        }
        for verdict in Agreement::ALL {
            assert_eq!(serde_json::to_value(verdict).unwrap(), verdict.words());
            assert_eq!(Tone::of(verdict.words()), verdict.tone());
        }
        for verdict in Passed::ALL {
            assert_eq!(serde_json::to_value(verdict).unwrap(), verdict.words());
            assert_eq!(Tone::of(verdict.words()), verdict.tone());
        }
        for verdict in Change::ALL {
            assert_eq!(serde_json::to_value(verdict).unwrap(), verdict.words());
            assert_eq!(Tone::of(verdict.words()), verdict.tone());
        }
        for verdict in Match::ALL {
            assert_eq!(serde_json::to_value(verdict).unwrap(), verdict.words());
            assert_eq!(Tone::of(verdict.words()), verdict.tone());
        }
        assert_eq!(Tone::of("something else"), Tone::Open);
    }
}
