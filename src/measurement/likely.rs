//! What a header probably is that is none of the known names: by its words and the dimension of its unit.

use super::frame::{DRIVES, READINGS};
use super::names::{AMPLITUDE, DRIVE, FREQUENCY, PHASE};
use super::unit::{Unit, Wanted, known, suffix};

/// Beginnings of words of a column that is none of the four: statistics, harmonics, swings that are no amplitudes, a
/// lag whose sign is another, the sampling.
const OTHER: &[&str] = &[
    "sd", "std", "stdev", "error", "unc", "unsich", "sigma", "mean", "mittel", "harmon", "lag", "sampl", "abtast",
    "noise", "ruido", "rausch", "fehler", "pp", "p2p", "pk", "peak", "rms", "eff", "bandw", "temp", "sensit", "calib",
];
/// Beginnings of words for a setting of an instrument, which is held and drives nothing.
const SETTINGS: &[&str] = &["scale", "escal", "skal", "range", "bias", "offset", "vdc"];
/// Beginnings of words for a time, a period or a delay.
const TIMES: &[&str] = &["time", "zeit", "tiemp", "sekund", "seconds", "period", "delay", "lag"];
/// Beginnings of words that say what shakes the rig. They come before [`READS`]: the displacement of a base is a drive.
const DRIVES_IT: &[&str] = &[
    "driv",
    "forc",
    "kraft",
    "torque",
    "moment",
    "excit",
    "anreg",
    "erreg",
    "input",
    "base",
    "shaker",
    "actuat",
    "motor",
    "generator",
    "source",
];
/// Beginnings of words that say what is read of it.
const READS: &[&str] = &[
    "amplit", "ampiez", "disp", "deflect", "auslenk", "respon", "antwort", "output", "veloc", "geschw", "accel",
    "beschl", "angle", "winkel", "tip", "motion", "laser", "vibrom", "sensor", "magnit",
];

/// The column that words and unit of a header speak for, and the unit; none where no unit is stated, or too little
/// said. `name` is in lower case with its words joined by underscores, `bracket` the unit beside it.
pub(crate) fn likely(name: &str, bracket: Option<&str>) -> Option<(usize, Unit)> {
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    // A number within a word, as in `phase2`, is of another channel or of a harmonic.
    let is_word = |word: &&&str| word.chars().all(char::is_alphabetic);
    let says =
        |beginnings: &[&str]| words.iter().filter(is_word).any(|word| beginnings.iter().any(|b| word.starts_with(b)));
    let ends_so = |what: &str| words.iter().any(|word| word.ends_with(what));
    // Not as a beginning: "Erregerkraft" has it too.
    if says(OTHER) || words.contains(&"err") {
        return None;
    }
    let unit = |possible: &'static [&'static str]| {
        let wanted = Wanted { possible, natural: None, share: false, per_drive: possible == READINGS };
        match bracket {
            Some(text) => wanted.unit(text).ok(),
            None => (1..words.len()).flat_map(|from| suffix(&words[from..])).find_map(|text| wanted.unit(&text).ok()),
        }
    };
    if bracket.is_none() && words.len() == 1 {
        // Nothing but a unit.
        let angle = Wanted { possible: &["rad"], natural: None, share: false, per_drive: false };
        return angle.unit(name).ok().map(|unit| (PHASE, unit));
    }
    let column = if says(&["freq"]) || ends_so("frequency") || ends_so("frequenz") {
        return unit(&["Hz"]).map(|unit| (FREQUENCY, unit));
    } else if says(&["phas", "fase", "desfas", "sfas"]) || words.contains(&"arg") {
        return unit(&["rad"]).map(|unit| (PHASE, unit));
    } else if says(DRIVES_IT) || ends_so("kraft") || ends_so("moment") {
        (DRIVE, unit(DRIVES)?)
    } else if says(READS) {
        (AMPLITUDE, unit(READINGS)?)
    } else {
        return None;
    };
    Some(column)
}

/// Whether a name is of a column that is none of drive, frequency, amplitude and phase.
pub(crate) fn is_other(name: &str) -> bool {
    name.split('_').any(|word| OTHER.iter().any(|beginning| word.starts_with(beginning)))
}

/// Whether a name is that of a setting of an instrument: its range, a bias.
pub(crate) fn is_setting(name: &str) -> bool {
    name.split('_').any(|word| SETTINGS.iter().any(|beginning| word.starts_with(beginning)))
}

/// Whether a name is that of a time, which is no reading of a motion.
pub(crate) fn is_time(name: &str) -> bool {
    name.split('_').any(|word| TIMES.iter().any(|beginning| word.starts_with(beginning)))
}

/// Words for the deviation of what the rest of a name, or the letter after them, stands for.
const DEVIATES: &[&str] = &[
    "d",
    "δ",
    "delta",
    "σ",
    "s",
    "sigma",
    "sd",
    "std",
    "stdev",
    "u",
    "unc",
    "err",
    "error",
    "noise",
    "ruido",
    "rauschen",
    "fehler",
    "unsicherheit",
    "errore",
    "erreur",
    "erro",
    "incertezza",
    "incertitude",
    "incerteza",
    "incertidumbre",
];
/// Marks that stand before the letter of a quantity: `dA`.
const BEFORE_LETTERS: &[&str] = &["d", "δ", "σ", "s"];
/// Words for a mean, which is of the same quantity.
pub(crate) const MEANS: &[&str] = &["mean", "avg", "average", "mittel", "mittelwert"];
/// Words for what of a swing is measured, as in `peak-to-peak voltage`; their deviation is of the same quantity.
const SWINGS: &[&str] = &["peak", "to", "pk", "pp", "p", "ptp", "p2p", "pkpk", "rms", "eff"];
/// Letters of a word that abbreviates another, at least.
const SHORT: usize = 3;
/// Words for how a phase counts.
const COUNTS: &[&str] = &["lag", "shift", "difference", "diff"];

/// Whether a name is that of the deviation of what has the other one: `dA` and `A`, `amp_err` and `amp_mm`,
/// `Amp.std` and `Amp.mittel`.
pub(crate) fn is_deviation(name: &str, of: &str) -> bool {
    let glued = name.strip_suffix(of).is_some_and(|mark| DEVIATES.contains(&mark.trim_end_matches('_')));
    // Also before the letter of a name that is spelt out: `dA` beside `Amplitude`.
    let first = of.split('_').next().unwrap_or_default();
    let is_word = first.chars().all(char::is_alphabetic) && first.chars().count() >= SHORT;
    let initial = first.chars().next().filter(|_| is_word);
    let lettered = initial.is_some_and(|i| name.strip_suffix(i).is_some_and(|mark| BEFORE_LETTERS.contains(&mark)));
    let mut own: Vec<&str> = name.split('_').collect();
    // A letter behind a name is of another of its kind: `U_s` is the voltage of a source.
    let is_mark = |(at, word): (usize, &&str)| DEVIATES.contains(word) && (at == 0 || word.chars().count() > 1);
    glued
        || lettered
        || own.iter().enumerate().position(is_mark).is_some_and(|at| {
            own.remove(at);
            // Of `std dev` both are the mark.
            own.retain(|word| !matches!(*word, "dev" | "deviation"));
            let whole: Vec<&str> = of.split('_').collect();
            !own.is_empty() && (is_short(&own, &whole) || quantity(own) == quantity(whole))
        })
}

/// Whether a word abbreviates a name: its beginning, `amp` of `amplitude`, or its initials, `ps` of `phase_shift`.
fn is_short(word: &[&str], name: &[&str]) -> bool {
    let [word] = word else { return false };
    let begins = word.chars().count() >= SHORT && name[0].starts_with(word);
    begins || name.len() > 1 && name.iter().filter_map(|word| word.chars().next()).eq(word.chars())
}

/// Whether a name says that it is a deviation, of whatever.
pub(crate) fn deviates(name: &str) -> bool {
    // A letter may be anything.
    name.split('_').any(|word| word.chars().count() > 1 && DEVIATES.contains(&word))
}

/// Words of a name without what says no more of the quantity, and without the unit behind them.
fn quantity(mut words: Vec<&str>) -> Vec<&str> {
    words.retain(|word| !MEANS.contains(word) && !COUNTS.contains(word));
    if !words.iter().all(|word| SWINGS.contains(word)) {
        words.retain(|word| !SWINGS.contains(word));
    }
    while words.len() > 1 && words.last().is_some_and(|word| known(word)) {
        words.pop();
    }
    words
}

/// The unit of a column in hertz, whatever its name is but one of the others: nothing else is measured in that.
pub(crate) fn in_hertz(name: &str, bracket: Option<&str>) -> Option<Unit> {
    let wanted = Wanted { possible: &["Hz"], natural: None, share: false, per_drive: false };
    let unit = wanted.unit(bracket?).ok()?;
    (!is_other(name) && unit.text.ends_with("Hz")).then_some(unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_units_tell_a_column_together() {
        for (name, bracket, column, si) in [
            ("frequenz_f", Some("Hz"), FREQUENCY, "Hz"),
            ("shaker_frequency", Some("rad/s"), FREQUENCY, "Hz"),
            ("motorspannung_u", Some("V"), DRIVE, "V"),
            ("table_input_acceleration", Some("g"), DRIVE, "m/s^2"),
            ("base_displacement_mm", None, DRIVE, "m"),
            ("anregungskraft", Some("mN"), DRIVE, "N"),
            ("erregerkraft_f", Some("N"), DRIVE, "N"),
            ("tip_displacement", Some("mm"), AMPLITUDE, "m"),
            ("auslenkung", Some("°"), AMPLITUDE, "rad"),
            ("laser_output", Some("mV"), AMPLITUDE, "V"),
            ("tip_velocity_mm_s", None, AMPLITUDE, "m/s"),
            ("phase_of_the_tip", Some("deg"), PHASE, "rad"),
            ("deg", None, PHASE, "rad"),
        ] {
            let (found, unit) = likely(name, bracket).unwrap_or_else(|| panic!("{name}"));
            assert_eq!((found, unit.si), (column, si), "{name}");
        }
    }

    #[test]
    fn neither_words_nor_units_are_enough() {
        for (name, bracket) in [
            ("tip_displacement", None),
            ("tip_displacement", Some("kg")),
            ("room_temperature", Some("V")),
            ("sampling_frequency", Some("Hz")),
            ("tip_displacement_sd", Some("mm")),
            ("phase_lag", Some("deg")),
            ("tip_err", Some("mm")),
            ("phase2", Some("rad")),
            ("tip_pp_mm", None),
            ("ampltude_rad", None),
            ("gain", Some("V")),
            ("remark", None),
        ] {
            assert_eq!(likely(name, bracket).map(|(column, _)| column), None, "{name}");
        }
    }

    #[test]
    fn a_deviation_has_the_name_of_what_it_is_of() {
        for (name, of) in [
            ("da", "a"),
            ("δφ", "φ"),
            ("sd_amplitude", "amplitude"),
            ("amp_err", "amp_mm"),
            ("amp_std", "amp_mittel"),
            ("x1_std_dev", "x1_avg"),
            ("err_amp", "amplitude"),
            ("err_ps", "phase_shift"),
            ("da", "amplitude"),
            ("errore_v_r", "v_r"),
        ] {
            assert!(is_deviation(name, of), "{name} {of}");
        }
        for (name, of) in [
            ("u_s", "u"),
            ("amplitude", "amplitude"),
            ("phase_err", "amplitude"),
            ("error", "amplitude"),
            ("err_a", "amplitude"),
            ("ua", "amplitude"),
            ("du", "u0"),
            ("dx", "x0"),
        ] {
            assert!(!is_deviation(name, of), "{name} {of}");
        }
    }
}
