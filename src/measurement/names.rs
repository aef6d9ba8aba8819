//! Which columns there are, and what they are called.

/// Position of a column in [`MEASURED`](crate::scenario::parameters::MEASURED) and in `COLUMNS` there.
pub(crate) const SPEED: usize = 0;
pub(crate) const LOAD: usize = 1;
pub(crate) const DRIVE: usize = 2;
pub(crate) const FREQUENCY: usize = 3;
pub(crate) const AMPLITUDE: usize = 4;
pub(crate) const PHASE: usize = 5;
pub(crate) const AMPLITUDE_SD: usize = 6;
pub(crate) const PHASE_SD: usize = 7;
pub(crate) const MEAN: usize = 8;
/// How many columns hold numbers.
pub(crate) const NUMBERS: usize = 9;
/// Position in `COLUMNS` of the columns that hold words.
pub(crate) const SERIES: usize = 9;
pub(crate) const SWEEP: usize = 10;
/// How many columns a table may have.
pub(crate) const ALL: usize = 11;

/// Names of columns in headers, and which column each is.
pub(crate) const NAMES: &[(&str, usize)] = &[
    ("speed", SPEED),
    ("load", LOAD),
    ("drive", DRIVE),
    ("force", DRIVE),
    ("torque", DRIVE),
    ("frequency", FREQUENCY),
    ("amplitude", AMPLITUDE),
    ("phase", PHASE),
    ("amplitude_sd", AMPLITUDE_SD),
    ("phase_sd", PHASE_SD),
    ("mean", MEAN),
];

/// Another name of a column, as laboratories' programs write it.
pub(crate) struct Alias {
    pub name: &'static str,
    pub column: usize,
    /// SI units with which it is that column; all of the column where there are none.
    pub units: &'static [&'static str],
    /// Whether it is the column where no unit is stated, too.
    pub bare: bool,
}

const fn alias(name: &'static str, column: usize, units: &'static [&'static str], bare: bool) -> Alias {
    Alias { name, column, units, bare }
}

/// Any element of a scattering matrix, `s11` to `s99`.
pub(crate) const SCATTERING: &str = "s21";
/// A phase that is positive where the reading lags.
pub(crate) const LAG: &str = "phase_lag";

/// A power that is stated as a level.
pub(crate) const POWER: &[&str] = &["mW"];
const LENGTH: &[&str] = &["m"];
const VELOCITY: &[&str] = &["m/s"];
const ACCELERATION: &[&str] = &["m/s^2"];
const ANY_ACCELERATION: &[&str] = &["m/s^2", "rad/s^2"];
const HERTZ: &[&str] = &["Hz"];
const SECOND: &[&str] = &["s"];
const RADIAN: &[&str] = &["rad"];
const NEWTON: &[&str] = &["N"];
const VOLT: &[&str] = &["V"];
const TORQUE: &[&str] = &["N m"];

/// A unit decides wherever a name alone could be another quantity.
pub(crate) const ALIASES: &[Alias] = &[
    alias("f", FREQUENCY, HERTZ, true),
    alias("freq", FREQUENCY, HERTZ, true),
    alias("hz", FREQUENCY, HERTZ, true),
    alias("frequenz", FREQUENCY, HERTZ, true),
    alias("frequencia", FREQUENCY, HERTZ, true),
    alias("frequência", FREQUENCY, HERTZ, true),
    alias("frecuencia", FREQUENCY, HERTZ, true),
    alias("frequenza", FREQUENCY, HERTZ, true),
    alias("fréquence", FREQUENCY, HERTZ, true),
    alias("drive_frequency", FREQUENCY, HERTZ, true),
    alias("excitation_frequency", FREQUENCY, HERTZ, true),
    alias("omega", FREQUENCY, HERTZ, false),
    alias("ω", FREQUENCY, HERTZ, false),
    alias("w", FREQUENCY, HERTZ, false),
    alias("angular_frequency", FREQUENCY, HERTZ, false),
    alias("kreisfrequenz", FREQUENCY, HERTZ, false),
    alias("period", FREQUENCY, SECOND, false),
    alias("t", FREQUENCY, SECOND, false),
    alias("periodendauer", FREQUENCY, SECOND, false),
    alias("schwingungsdauer", FREQUENCY, SECOND, false),
    alias("periode", FREQUENCY, SECOND, false),
    alias("période", FREQUENCY, SECOND, false),
    alias("periodo", FREQUENCY, SECOND, false),
    alias("período", FREQUENCY, SECOND, false),
    alias("f", DRIVE, NEWTON, false),
    alias("force", DRIVE, NEWTON, false),
    alias("torque", DRIVE, TORQUE, false),
    alias("drive", DRIVE, &[], false),
    alias("kraft", DRIVE, NEWTON, false),
    alias("excitation_force", DRIVE, NEWTON, false),
    alias("drive_force", DRIVE, NEWTON, false),
    alias("drehmoment", DRIVE, TORQUE, false),
    alias("moment", DRIVE, TORQUE, false),
    alias("excitation", DRIVE, &[], false),
    alias("drive_level", DRIVE, &[], false),
    alias("base_displacement", DRIVE, &["m", "rad"], false),
    alias("base_acceleration", DRIVE, ANY_ACCELERATION, false),
    alias("base_accel", DRIVE, ANY_ACCELERATION, false),
    alias("power", DRIVE, POWER, false),
    alias("p", DRIVE, POWER, false),
    alias("leistung", DRIVE, POWER, false),
    alias("input", DRIVE, &[], true),
    alias("in", DRIVE, &[], true),
    alias("v_in", DRIVE, VOLT, true),
    alias("vin", DRIVE, VOLT, true),
    alias("u_in", DRIVE, VOLT, true),
    alias("output", AMPLITUDE, &[], true),
    alias("out", AMPLITUDE, &[], true),
    alias("v_out", AMPLITUDE, VOLT, true),
    alias("vout", AMPLITUDE, VOLT, true),
    alias("u_out", AMPLITUDE, VOLT, true),
    alias("ampl", AMPLITUDE, &[], true),
    alias("amp", AMPLITUDE, &[], true),
    alias("magnitude", AMPLITUDE, &[], true),
    alias("ampiezza", AMPLITUDE, &[], true),
    alias("amplitud", AMPLITUDE, &[], true),
    alias("mag", AMPLITUDE, &[], true),
    alias("level", AMPLITUDE, &[], false),
    alias("transmission_loss", AMPLITUDE, &[], false),
    alias("return_loss", AMPLITUDE, &[], false),
    alias("|z|", AMPLITUDE, &[], false),
    alias("|zs|", AMPLITUDE, &[], false),
    alias("impedance", AMPLITUDE, &[], true),
    alias("|y|", AMPLITUDE, &[], false),
    alias("admittance", AMPLITUDE, &[], false),
    alias("gain", PHASE, RADIAN, false),
    alias("gain", AMPLITUDE, &[], false),
    alias(SCATTERING, PHASE, RADIAN, false),
    alias(SCATTERING, AMPLITUDE, &[], false),
    alias("h", AMPLITUDE, &[], false),
    alias("|h|", AMPLITUDE, &[], false),
    alias("frf", AMPLITUDE, &[], false),
    alias("spl", AMPLITUDE, &[], false),
    alias("transfer_function", AMPLITUDE, &[], false),
    alias("transmissibility", AMPLITUDE, &[], false),
    alias("transmission", AMPLITUDE, &[], false),
    alias("receptance", AMPLITUDE, LENGTH, false),
    alias("compliance", AMPLITUDE, LENGTH, false),
    alias("mobility", AMPLITUDE, VELOCITY, false),
    alias("inertance", AMPLITUDE, ACCELERATION, false),
    alias("accelerance", AMPLITUDE, ACCELERATION, false),
    alias("response", AMPLITUDE, &[], false),
    alias("displacement", AMPLITUDE, LENGTH, false),
    alias("deflection", AMPLITUDE, LENGTH, false),
    alias("auslenkung", AMPLITUDE, LENGTH, false),
    alias("x", AMPLITUDE, LENGTH, false),
    alias("velocity", AMPLITUDE, VELOCITY, false),
    alias("vel", AMPLITUDE, VELOCITY, false),
    alias("v", AMPLITUDE, VELOCITY, false),
    alias("acceleration", AMPLITUDE, ACCELERATION, false),
    alias("accel", AMPLITUDE, ACCELERATION, false),
    alias("acc", AMPLITUDE, ACCELERATION, false),
    alias("beschleunigung", AMPLITUDE, ACCELERATION, false),
    alias("a", AMPLITUDE, ACCELERATION, false),
    alias("angle", AMPLITUDE, RADIAN, false),
    alias("angular_velocity", AMPLITUDE, &["rad/s"], false),
    alias("angular_acceleration", AMPLITUDE, &["rad/s^2"], false),
    alias("phi", PHASE, RADIAN, true),
    alias("φ", PHASE, RADIAN, true),
    alias("ϕ", PHASE, RADIAN, true),
    alias("phase_angle", PHASE, RADIAN, true),
    alias("phase_shift", PHASE, RADIAN, true),
    alias("phase_difference", PHASE, RADIAN, true),
    alias("phasendifferenz", PHASE, RADIAN, true),
    alias("phasenverschiebung", PHASE, RADIAN, true),
    alias("sfasamento", PHASE, RADIAN, true),
    alias("fase", PHASE, RADIAN, true),
    alias("desfasaje", PHASE, RADIAN, true),
    alias("déphasage", PHASE, RADIAN, true),
    alias("desfase", PHASE, RADIAN, true),
    alias("theta_z", PHASE, RADIAN, true),
    alias("θz", PHASE, RADIAN, true),
    alias("phasenwinkel", PHASE, RADIAN, true),
    alias("arg", PHASE, RADIAN, true),
    alias(LAG, PHASE, RADIAN, true),
    alias("lag", PHASE, RADIAN, false),
    alias("time_lag", PHASE, SECOND, false),
    alias("time_delay", PHASE, SECOND, false),
    alias("time_shift", PHASE, SECOND, false),
    alias("delay", PHASE, SECOND, false),
    alias("zeitdifferenz", PHASE, SECOND, false),
    alias("zeitverschiebung", PHASE, SECOND, false),
    alias("a", PHASE, SECOND, false),
    alias("roller_speed", SPEED, VELOCITY, false),
    alias("roller_velocity", SPEED, VELOCITY, false),
    alias("belt_speed", SPEED, VELOCITY, false),
    alias("belt_velocity", SPEED, VELOCITY, false),
    alias("surface_speed", SPEED, VELOCITY, false),
    alias("sliding_speed", SPEED, VELOCITY, false),
    alias("sliding_velocity", SPEED, VELOCITY, false),
    alias("gleitgeschwindigkeit", SPEED, VELOCITY, false),
    alias("w", LOAD, NEWTON, false),
    alias("normal_load", LOAD, NEWTON, false),
    alias("normal_force", LOAD, NEWTON, false),
    alias("normalkraft", LOAD, NEWTON, false),
];

/// Words in names that say what is held, with its SI unit; the first that is there decides.
pub(crate) const SAYING: &[(&str, &str)] = &[
    ("angular_velocity", "rad/s"),
    ("angular_acceleration", "rad/s^2"),
    ("velocity", "m/s"),
    ("acceleration", "m/s^2"),
    ("accel", "m/s^2"),
    ("displacement", "m"),
    ("deflection", "m"),
    ("torque", "N m"),
    ("force", "N"),
    ("voltage", "V"),
    ("strain", "1"),
    ("angle", "rad"),
    ("frequency", "Hz"),
];
