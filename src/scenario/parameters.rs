//! Every base parameter stated once: key, symbol, unit, physical range, meaning. Parser, documentation and reports follow it.

use crate::effects::ParameterInfo;

const fn info(
    (key, symbol, unit): (&'static str, &'static str, &'static str),
    (minimum, maximum): (f64, f64),
    meaning: &'static str,
) -> ParameterInfo {
    ParameterInfo { key, symbol, unit, minimum, maximum, range: None, signed: false, meaning }
}

/// The table `[rig]`.
pub const RIG: &[ParameterInfo] = &[
    info(("inertia", "J", "kg m^2"), (1e-9, 1e3), "inertia of the arm about the torsional axis"),
    info(("torsional_stiffness", "K₀", "N m/rad"), (1e-3, 1e9), "stiffness of the torsional spring"),
    info(("torsional_damping", "C₀", "N m s/rad"), (0.0, 1e6), "damping of the torsional spring"),
    info(("spring_stiffness", "k₀", "N/m"), (1e-3, 1e10), "stiffness of each pinching spring"),
    info(("spring_damping", "c₀", "N s/m"), (0.0, 1e6), "damping of each pinching spring"),
    info(("spring_arm", "a", "m"), (1e-5, 10.0), "arm of the pinching springs about the axis"),
    info(("contact_arm", "b", "m"), (1e-5, 10.0), "arm of the contact about the axis"),
];

/// The numbers of the table `[contact]`; its key `formulation` is a word.
pub const CONTACT: &[ParameterInfo] = &[
    info(("stiffness", "kc", "N/m"), (1e-3, 1e12), "tangential stiffness of the bristles"),
    info(("damping", "cc", "N s/m"), (0.0, 1e6), "tangential damping of the bristles"),
    info(("friction", "μ", "1"), (0.0, 10.0), "coefficient of friction"),
];

/// The table `[instrument]`; each has a default.
pub const INSTRUMENT: &[ParameterInfo] = &[
    info(("drive_gain", "", "1"), (0.01, 100.0), "true amplitude of the actuator over the stated one"),
    info(("amplitude_gain", "", "1"), (0.01, 100.0), "amplitude read over the true one"),
    info(("phase_offset", "", "rad"), (-6.3, 6.3), "phase read minus the true one"),
];

/// The numeric axes of `[sweep]`; its key `formulation` is a list of words.
pub const SWEEP: &[ParameterInfo] = &[
    info(("frequency", "f", "Hz"), (1e-3, 1e5), "frequency of the drive"),
    info(("speed", "V", "m/s"), (0.0, 10.0), "peripheral speed of the roller"),
    info(("load", "W", "N"), (0.0, 1e5), "normal load; 0 means no contact"),
    info(("drive", "u₀", "m"), (1e-12, 1e-2), "amplitude of the actuator"),
    info(("friction", "μ", "1"), (0.0, 10.0), "coefficient of friction, in place of the contact's"),
    info(("euler_steps", "", "1"), (16.0, 1e6), "steps per cycle of the published Euler procedure"),
];

/// The numbers of the table `[gate]`.
pub const GATE: &[ParameterInfo] = &[
    info(("max_rms_error", "", "1"), (0.0, 1.0), "largest root mean square error of the amplitude, relative"),
    info(("max_chi2_per_point", "", "1"), (1e-3, 1e9), "largest mean square of the residuals in standard deviations"),
    info(("amplitude_tolerance", "", "1"), (0.0, 1.0), "largest error of any amplitude, relative to its reading"),
    info(("amplitude_floor", "", "rad"), (0.0, 1.0), "error of an amplitude that always passes"),
    info(("phase_tolerance", "", "rad"), (0.0, 3.2), "largest error of any phase"),
];

/// Verdicts of a discovery.
pub const VERDICTS: &[&str] = &["nothing-missing", "recalibrate", "effect-missing", "unexplained"];

/// The table `[question]`.
pub const QUESTION: &[ParameterInfo] = &[
    info(("resembles", "V", "m/s"), (1e-9, 10.0), "speed at which the model's own curve is the one to resemble"),
    info(("tolerance", "", "1"), (1e-3, 0.3), "relative difference of two amplitudes that counts as none"),
];

/// Columns of a measurement table that `[measurement] columns` may map.
pub const COLUMNS: &[&str] =
    &["speed", "load", "drive", "frequency", "amplitude", "phase", "amplitude_sd", "phase_sd", "mean"];

/// What those columns hold, in the same order; units without prefix.
pub const MEASURED: &[ParameterInfo] = &[
    SWEEP[1],
    SWEEP[2],
    SWEEP[3],
    SWEEP[0],
    info(("amplitude", "A", "rad"), (0.0, 1.0), "amplitude of the arm's angle at the frequency of the drive"),
    info(("phase", "φ", "rad"), (-12.6, 12.6), "phase of the arm's angle relative to the actuator"),
    info(("amplitude_sd", "", "rad"), (0.0, 1.0), "standard deviation of the amplitude"),
    info(("phase_sd", "", "rad"), (0.0, 12.6), "standard deviation of the phase"),
    info(("mean", "", "rad"), (-1.0, 1.0), "mean angle of the arm"),
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
    fn every_parameter_has_a_readable_unit_a_range_and_a_meaning() {
        for info in [RIG, CONTACT, INSTRUMENT, SWEEP, GATE, QUESTION, MEASURED].concat() {
            assert!(info.minimum < info.maximum && !info.meaning.is_empty(), "{}", info.key);
            let value = crate::units::parse(&format!("1 {}", info.unit), info.unit);
            assert_eq!(value, Ok(1.0), "{}", info.key);
        }
    }

    #[test]
    fn every_column_says_what_it_holds() {
        assert_eq!(MEASURED.iter().map(|info| info.key).collect::<Vec<_>>(), COLUMNS);
    }
}
