//! Every base parameter stated once: key, symbol, unit, physical range, meaning. Parser, documentation and reports
//! follow it.

use crate::parameter::{ANY, Coordinate, Measure, POSITIVE, ParameterInfo, ZERO_OR_MORE};
use std::sync::LazyLock;

const fn info(
    (key, symbol, unit): (&'static str, &'static str, &'static str),
    (minimum, maximum): (f64, f64),
    meaning: &'static str,
) -> ParameterInfo {
    ParameterInfo {
        key,
        symbol,
        unit,
        minimum,
        maximum,
        range: None,
        measure: Measure::Number,
        alone: None,
        signed: false,
        change: false,
        held: false,
        meaning,
    }
}

/// What values of a range need to be, for messages: `needs to be more than zero`, `needs 16 to 1e6`.
pub(crate) fn needed_range(range: (f64, f64), unit: &str) -> String {
    let show = |value| crate::units::format(value, unit);
    match range {
        POSITIVE => "needs to be more than zero".into(),
        ZERO_OR_MORE => "needs to be zero or more".into(),
        ANY => "needs to be finite".into(),
        (f64::MIN_POSITIVE, maximum) => format!("needs to be more than zero, up to {}", show(maximum)),
        (minimum, f64::MAX) => format!("needs to be {} or more", show(minimum)),
        (minimum, maximum) => format!("needs {} to {}", show(minimum), show(maximum)),
    }
}

/// The table `[rig]` of kind `torsional-arm`.
pub const RIG: &[ParameterInfo] = &[
    info(("inertia", "J", "kg m^2"), POSITIVE, "inertia of the arm about the torsional axis"),
    info(("torsional_stiffness", "K₀", "N m/rad"), POSITIVE, "stiffness of the torsional spring"),
    info(("torsional_damping", "C₀", "N m s/rad"), ZERO_OR_MORE, "damping of the torsional spring"),
    info(("spring_stiffness", "k₀", "N/m"), POSITIVE, "stiffness of each pinching spring"),
    info(("spring_damping", "c₀", "N s/m"), ZERO_OR_MORE, "damping of each pinching spring"),
    info(("spring_arm", "a", "m"), POSITIVE, "arm of the pinching springs about the axis"),
    info(("contact_arm", "b", "m"), POSITIVE, "arm of the contact about the axis"),
];

/// Words of the table `[rig]` of kind `oscillator`, with what each may be.
pub const OSCILLATOR_WORDS: &[(&str, &[&str])] = &[
    ("coordinate", &["displacement", "angle"]),
    ("drive", &["force", "base", "spring"]),
    ("reading", &["relative", "absolute"]),
];

const FREQUENCY_OF_MODE: ParameterInfo =
    info(("natural_frequency", "f₀", "Hz"), POSITIVE, "natural frequency without damping");
const QUALITY_FACTOR: ParameterInfo = info(("quality_factor", "Q", "1"), POSITIVE, "quality factor of the resonance");
const DAMPING_RATIO: ParameterInfo =
    info(("damping_ratio", "ζ", "1"), ZERO_OR_MORE, "damping over the critical damping, 1/(2Q)");
const PARTICIPATION: ParameterInfo = info(
    ("participation", "Γ", "1"),
    POSITIVE,
    "motion of the place that is read over that of a mass on a spring, both relative to the base",
);

/// The numbers of the table `[rig]` of kind `oscillator` for a displacement.
const OF_DISPLACEMENT: &[ParameterInfo] = &[
    info(("mass", "M", "kg"), POSITIVE, "modal mass"),
    info(("stiffness", "K", "N/m"), POSITIVE, "stiffness of the mode"),
    FREQUENCY_OF_MODE,
    info(("damping", "C", "N s/m"), ZERO_OR_MORE, "damping of the mode"),
    QUALITY_FACTOR,
    DAMPING_RATIO,
    info(("spring_stiffness", "k_s", "N/m"), POSITIVE, "stiffness of the driving spring, part of the stiffness"),
    info(("spring_damping", "c_s", "N s/m"), ZERO_OR_MORE, "damping of the driving spring, part of the damping"),
    info(("contact_factor", "q", "1"), POSITIVE, "motion at the contact per unit of the coordinate"),
    PARTICIPATION,
];

/// The same for an angle.
const OF_ANGLE: &[ParameterInfo] = &[
    info(("inertia", "M", "kg m^2"), POSITIVE, "moment of inertia of the mode"),
    info(("stiffness", "K", "N m/rad"), POSITIVE, "stiffness of the mode"),
    FREQUENCY_OF_MODE,
    info(("damping", "C", "N m s/rad"), ZERO_OR_MORE, "damping of the mode"),
    QUALITY_FACTOR,
    DAMPING_RATIO,
    info(("spring_stiffness", "k_s", "N m/rad"), POSITIVE, "stiffness of the driving spring, part of the stiffness"),
    info(("spring_damping", "c_s", "N m s/rad"), ZERO_OR_MORE, "damping of the driving spring, part of the damping"),
    info(("contact_factor", "q", "m/rad"), POSITIVE, "motion at the contact per unit of the coordinate"),
    PARTICIPATION,
];

/// The numbers of the table `[rig]` of kind `oscillator`.
pub const fn oscillator(coordinate: Coordinate) -> &'static [ParameterInfo] {
    match coordinate {
        Coordinate::Displacement => OF_DISPLACEMENT,
        Coordinate::Angle => OF_ANGLE,
    }
}

/// The numbers of the table `[contact]`; its key `formulation` is a word.
pub const CONTACT: &[ParameterInfo] = &[
    info(("stiffness", "kc", "N/m"), POSITIVE, "tangential stiffness of the bristles"),
    info(("damping", "cc", "N s/m"), ZERO_OR_MORE, "tangential damping of the bristles"),
    info(("friction", "μ", "1"), ZERO_OR_MORE, "coefficient of friction"),
];

/// The table `[instrument]`; each has a default.
pub const INSTRUMENT: &[ParameterInfo] = &[
    info(("drive_gain", "", "1"), POSITIVE, "true amplitude of the drive over the stated one"),
    info(("amplitude_gain", "", "1"), POSITIVE, "amplitude read over the true one"),
    info(("phase_offset", "", "rad"), (-6.3, 6.3), "phase read minus the true one"),
];

/// Sensitivity of a drive that is read in volts, in place of `drive_gain`; its unit is V over that of the drive.
pub const DRIVE_SENSITIVITY: &[ParameterInfo] = &[
    info(("drive_sensitivity", "", "V/N"), POSITIVE, "voltage read per drive"),
    info(("drive_sensitivity", "", "V/(N m)"), POSITIVE, "voltage read per drive"),
    info(("drive_sensitivity", "", "V/m"), POSITIVE, "voltage read per drive"),
    info(("drive_sensitivity", "", "V/rad"), POSITIVE, "voltage read per drive"),
    info(("drive_sensitivity", "", "V s^2/m"), POSITIVE, "voltage read per drive"),
    info(("drive_sensitivity", "", "V s^2/rad"), POSITIVE, "voltage read per drive"),
];

/// Sensitivity of a reading in volts, in place of `amplitude_gain`; by the order of the reading, displacement before
/// angle.
pub const SENSITIVITY: &[ParameterInfo] = &[
    info(("sensitivity", "", "V/m"), POSITIVE, "voltage read per motion"),
    info(("sensitivity", "", "V s/m"), POSITIVE, "voltage read per motion"),
    info(("sensitivity", "", "V s^2/m"), POSITIVE, "voltage read per motion"),
    info(("sensitivity", "", "V/rad"), POSITIVE, "voltage read per motion"),
    info(("sensitivity", "", "V s/rad"), POSITIVE, "voltage read per motion"),
    info(("sensitivity", "", "V s^2/rad"), POSITIVE, "voltage read per motion"),
];

/// Keys of all parameters that rigs and instruments may have, as in `[fit] free`.
pub fn base_keys() -> &'static [String] {
    static KEYS: LazyLock<Vec<String>> = LazyLock::new(|| {
        let tables = [
            ("rig", &[RIG, OF_DISPLACEMENT, OF_ANGLE][..]),
            ("instrument", &[INSTRUMENT, DRIVE_SENSITIVITY, SENSITIVITY]),
        ];
        let keys = |(table, lists): (&str, &[&[ParameterInfo]])| {
            lists.concat().iter().map(|info| format!("{table}.{}", info.key)).collect::<Vec<_>>()
        };
        let mut all: Vec<String> = tables.into_iter().flat_map(keys).collect();
        all.sort();
        all.dedup();
        all
    });
    &KEYS
}

/// The parameter of a rig, contact or instrument that a key such as `rig.stiffness` names, of a torsional `arm` or of an
/// oscillator; of a displacement or an angle, since units differ only.
pub fn of_key(key: &str, arm: bool) -> Option<&'static ParameterInfo> {
    let (table, own) = key.split_once('.')?;
    let lists: &[&'static [ParameterInfo]] = match table {
        "rig" if arm => &[RIG],
        "rig" => &[OF_DISPLACEMENT, OF_ANGLE],
        "contact" => &[CONTACT],
        "instrument" => &[INSTRUMENT, DRIVE_SENSITIVITY, SENSITIVITY],
        _ => return None,
    };
    lists.iter().copied().flatten().find(|info| info.key == own)
}

/// The numeric axes of `[sweep]`; its key `formulation` is a list of words.
pub const SWEEP: &[ParameterInfo] = &[
    info(("frequency", "f", "Hz"), POSITIVE, "frequency of the drive"),
    info(("speed", "V", "m/s"), ZERO_OR_MORE, "peripheral speed of the roller"),
    info(("load", "W", "N"), ZERO_OR_MORE, "normal load; 0 means no contact"),
    info(("drive", "u₀", "m"), POSITIVE, "amplitude of the drive"),
    info(("friction", "μ", "1"), ZERO_OR_MORE, "coefficient of friction, in place of the contact's"),
    info(("euler_steps", "", "1"), (16.0, 1e6), "steps per cycle of the published Euler procedure"),
];

/// The numbers of the table `[gate]`.
pub const GATE: &[ParameterInfo] = &[
    info(("max_rms_error", "", "1"), (0.0, 1.0), "largest root mean square error of the amplitude, relative"),
    info(("max_chi2_per_point", "", "1"), (1e-3, 1e9), "largest mean square of the residuals in standard deviations"),
    info(("amplitude_tolerance", "", "1"), (0.0, 1.0), "largest error of any amplitude, relative to its reading"),
    info(("amplitude_floor", "", "rad"), ZERO_OR_MORE, "error of an amplitude that always passes"),
    info(("phase_tolerance", "", "rad"), (0.0, 3.2), "largest error of any phase"),
];

/// Verdicts of a discovery.
pub const VERDICTS: &[&str] = &["nothing-missing", "recalibrate", "effect-missing", "unexplained"];

/// The table `[question]`.
pub const QUESTION: &[ParameterInfo] = &[
    info(("resembles", "V", "m/s"), POSITIVE, "speed at which the model's own curve is the one to resemble"),
    info(("tolerance", "", "1"), (1e-3, 0.3), "relative difference of two amplitudes that counts as none"),
];

/// Columns of a measurement table that `[measurement] columns` may map.
pub const COLUMNS: &[&str] = &[
    "speed",
    "load",
    "drive",
    "frequency",
    "amplitude",
    "phase",
    "amplitude_sd",
    "phase_sd",
    "mean",
    "series",
    "sweep",
    "force",
    "torque",
    "phase_lag",
];

/// What the columns of numbers hold, in the same order; units without prefix, those of drive and reading as of the
/// paper's rig.
pub const MEASURED: &[ParameterInfo] = &[
    SWEEP[1],
    SWEEP[2],
    SWEEP[3],
    SWEEP[0],
    info(("amplitude", "A", "rad"), ZERO_OR_MORE, "amplitude of the reading at the frequency of the drive"),
    info(("phase", "φ", "rad"), (-12.6, 12.6), "phase of the reading relative to the drive"),
    info(("amplitude_sd", "", "rad"), ZERO_OR_MORE, "standard deviation of the amplitude"),
    info(("phase_sd", "", "rad"), (0.0, 12.6), "standard deviation of the phase"),
    info(("mean", "", "rad"), ANY, "mean of the reading"),
];

/// Names of figures that a scenario may ask for.
pub const FIGURES: &[&str] = &[
    "rig-sketch",
    "velocity-amplitude",
    "friction-independence",
    "resonance",
    "ridge",
    "regime-map",
    "collapse",
    "loops",
    "time-histories",
    "formulations",
];

/// Largest number of points that one sweep may hold.
pub const MAX_POINTS: u128 = 1_000_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_that_two_rigs_have_means_what_it_is_of_the_one() {
        let meaning = |key: &str, arm: bool| of_key(key, arm).map_or("", |info| info.meaning);
        for key in ["rig.inertia", "rig.spring_stiffness", "rig.spring_damping"] {
            assert!(meaning(key, true) != meaning(key, false) && !meaning(key, false).is_empty(), "{key}");
        }
        assert_eq!((meaning("rig.mass", true), meaning("rig.mass", false)), ("", "modal mass"));
    }

    #[test]
    fn every_parameter_has_a_readable_unit_a_range_and_a_meaning() {
        for info in [RIG, CONTACT, INSTRUMENT, SWEEP, GATE, QUESTION, MEASURED].concat() {
            assert!(info.minimum < info.maximum && !info.meaning.is_empty(), "{}", info.key);
            let value = crate::units::parse(&format!("1 {}", info.unit), info.unit);
            assert_eq!(value, Ok(1.0), "{}", info.key);
        }
    }

    #[test]
    fn every_column_says_what_it_holds() {
        assert_eq!(MEASURED.iter().map(|info| info.key).collect::<Vec<_>>(), COLUMNS[..MEASURED.len()]);
    }
}
