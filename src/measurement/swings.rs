//! Names of columns that hold another measure of a swing than its amplitude.

use super::names::{AMPLITUDE, DRIVE};
use crate::scenario::diagnostic::quote;

/// Whether the name of a column says that it holds the whole swing.
pub(crate) fn is_peak_to_peak(name: &str) -> bool {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    words
        .iter()
        .any(|word| ["pp", "p2p", "ptp", "pkpk", "vpp", "upp", "app"].contains(word) || word.ends_with("plitudepp"))
        || words.windows(2).any(|pair| matches!(pair, ["peak", "to" | "peak"] | ["pk", "pk"] | ["p", "p"]))
}

/// What is said of a mapped drive or reading whose name says that it is no amplitude.
pub(crate) fn other_amplitude(header: &str, column: usize) -> Option<String> {
    let key = match column {
        DRIVE => "drive_gain",
        AMPLITUDE => "amplitude_gain",
        _ => return None,
    };
    // The drive's gain is the true one over the stated one, the reading's the other way round.
    let (what, gain) = match (is_peak_to_peak(header), is_effective(header)) {
        (true, _) => ("peak to peak", if column == DRIVE { "0.5" } else { "2" }),
        (_, true) => ("an effective value", if column == DRIVE { "1.414214" } else { "0.707107" }),
        _ => return None,
    };
    Some(format!("the name of {} says {what}: where it is, state {key} = {gain} in [instrument]", quote(header)))
}

/// Whether the name of a column says that it holds root mean squares.
pub(crate) fn is_effective(name: &str) -> bool {
    let name = name.to_lowercase();
    name.split(|c: char| !c.is_alphanumeric()).any(|word| matches!(word, "rms" | "eff"))
}

#[cfg(test)]
mod tests {
    use super::is_peak_to_peak;

    #[test]
    fn the_whole_swing_is_told_from_words_that_merely_look_like_it() {
        for name in [
            "theta_pp_urad",
            "PP [rad]",
            "p2p",
            "peak-to-peak",
            "Angle (peak to peak)",
            "alpha_pk_pk",
            "amplitudePP_urad",
            "amplitude_p-p",
            "Vpp (V)",
        ] {
            assert!(is_peak_to_peak(name), "{name}");
        }
        for name in ["applied_angle", "stepped", "peak_angle", "amplitude"] {
            assert!(!is_peak_to_peak(name), "{name}");
        }
    }
}
