//! Names and units of columns that hold another measure of a swing than its amplitude.

use super::names::{AMPLITUDE, DRIVE};
use crate::scenario::diagnostic::quote;

/// What measures a swing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Swing {
    /// Its amplitude.
    Amplitude,
    /// From peak to peak.
    Whole,
    /// Root mean square.
    Effective,
}

impl Swing {
    /// The amplitude of a sine over this measure.
    pub fn factor(self) -> f64 {
        match self {
            Self::Amplitude => 1.0,
            Self::Whole => 0.5,
            Self::Effective => std::f64::consts::SQRT_2,
        }
    }

    /// What is said of it beside the unit.
    pub fn note(self) -> &'static str {
        match self {
            Self::Amplitude => "",
            Self::Whole => ", half of what stands there",
            Self::Effective => ", √2 times the effective values that stand there",
        }
    }

    /// A unit without the mark that may stand behind it, as in `Vpp`, `g rms` and `mm 0-p`, and what the mark says.
    pub fn marked(unit: &str) -> (&str, Self) {
        const MARKS: [(&str, Swing); 12] = [
            ("pk-pk", Swing::Whole),
            ("pk pk", Swing::Whole),
            ("pkpk", Swing::Whole),
            ("p-p", Swing::Whole),
            ("pp", Swing::Whole),
            ("ptp", Swing::Whole),
            ("p2p", Swing::Whole),
            ("rms", Swing::Effective),
            ("eff", Swing::Effective),
            ("peak", Swing::Amplitude),
            ("0-p", Swing::Amplitude),
            ("pk", Swing::Amplitude),
        ];
        for (mark, swing) in MARKS {
            let at = unit.len().wrapping_sub(mark.len());
            if let Some(end) = unit.get(at..)
                && end.eq_ignore_ascii_case(mark)
                && at > 0
            {
                return (unit[..at].trim_end_matches([' ', '_']), swing);
            }
        }
        (unit, Self::Amplitude)
    }
}

/// Whether the name of a column says that it holds the whole swing.
pub(crate) fn is_peak_to_peak(name: &str) -> bool {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    // A channel's number may stand before the mark.
    let is_numbered = |word: &str| {
        word.strip_suffix("pp")
            .and_then(|name| name.strip_prefix(['v', 'u', 'a']))
            .is_some_and(|name| name.chars().all(|c| c.is_ascii_digit()))
    };
    words
        .iter()
        .any(|word| ["pp", "p2p", "ptp", "pkpk"].contains(word) || is_numbered(word) || word.ends_with("plitudepp"))
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
    use super::{Swing, is_peak_to_peak};

    #[test]
    fn the_mark_behind_a_unit_says_what_is_measured() {
        for (text, unit, swing) in [
            ("Vpp", "V", Swing::Whole),
            ("mV p-p", "mV", Swing::Whole),
            ("g_rms", "g", Swing::Effective),
            ("m/s^2 RMS", "m/s^2", Swing::Effective),
            ("mm 0-p", "mm", Swing::Amplitude),
            ("Vpk", "V", Swing::Amplitude),
            ("V", "V", Swing::Amplitude),
            ("rms", "rms", Swing::Amplitude),
            ("°", "°", Swing::Amplitude),
        ] {
            assert_eq!(Swing::marked(text), (unit, swing), "{text}");
        }
    }

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
            "V1pp (mV)",
        ] {
            assert!(is_peak_to_peak(name), "{name}");
        }
        for name in ["applied_angle", "stepped", "peak_angle", "amplitude"] {
            assert!(!is_peak_to_peak(name), "{name}");
        }
    }
}
