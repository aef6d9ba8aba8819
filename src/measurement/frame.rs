//! What a scenario's rig makes of a table: which quantities may be its drive and its reading, and whether it needs a
//! contact's load and speed. A table that is read without a scenario may hold any of them.

use super::names::{AMPLITUDE, AMPLITUDE_SD, DRIVE, FREQUENCY, LOAD, MEAN, PHASE, SPEED};
use crate::scenario::parameters::MEASURED;
use crate::scenario::{Coordinate, Excitation, Rig, Scenario, Signal, Signals};

/// SI units that a drive may have.
pub(crate) const DRIVES: &[&str] = &["N", "N m", "m", "rad", "m/s^2", "rad/s^2", "V"];
/// SI units that a reading may have.
pub(crate) const READINGS: &[&str] = &["m", "m/s", "m/s^2", "rad", "rad/s", "rad/s^2", "V"];

/// What is expected of a table.
pub(crate) struct Frame<'a> {
    /// The scenario; none where a table is looked at by itself.
    scenario: Option<&'a Scenario>,
    /// Units of a drive that serve, the natural one first.
    drives: Vec<&'static str>,
    /// Units of a reading that serve, the natural one first.
    readings: Vec<&'static str>,
}

impl<'a> Frame<'a> {
    /// That of a scenario.
    pub fn of(scenario: &'a Scenario) -> Self {
        let (rig, instrument) = (&scenario.rig, &scenario.instrument);
        let angle = rig.coordinate() == Coordinate::Angle;
        let drives: &[&str] = match (rig, angle) {
            _ if instrument.drive_sensitivity.is_some() => &["V"],
            (Rig::TorsionalArm(_), _) => &["m"],
            (Rig::Oscillator(rig), angle) => match (rig.excitation, angle) {
                (Excitation::Force, false) => &["N", "V"],
                (Excitation::Force, true) => &["N m", "V"],
                (Excitation::Base, false) => &["m", "m/s^2", "V"],
                (Excitation::Base, true) => &["rad", "rad/s^2", "V"],
                (Excitation::Spring, false) => &["m", "V"],
                (Excitation::Spring, true) => &["rad", "V"],
            },
        };
        let readings: &[&str] = match (rig, angle) {
            _ if instrument.sensitivity.is_some() => &["V"],
            (Rig::TorsionalArm(_), _) => &["rad"],
            (_, false) => &["m", "m/s", "m/s^2", "V"],
            (_, true) => &["rad", "rad/s", "rad/s^2", "V"],
        };
        Self { scenario: Some(scenario), drives: drives.into(), readings: readings.into() }
    }

    /// That of a table by itself.
    pub fn any() -> Self {
        Self { scenario: None, drives: DRIVES.into(), readings: READINGS.into() }
    }

    /// Whether the rig is the paper's.
    pub fn is_arm(&self) -> bool {
        self.scenario.is_some_and(|scenario| scenario.rig.is_arm())
    }

    /// Whether there is no scenario.
    pub fn is_free(&self) -> bool {
        self.scenario.is_none()
    }

    /// Whether rows need a speed and a load.
    pub fn has_contact(&self) -> bool {
        self.scenario.is_some_and(|scenario| scenario.contact.is_some())
    }

    /// Units in which a column serves; all of a column that every rig has.
    pub fn serving(&self, column: usize) -> &[&'static str] {
        match column {
            DRIVE => &self.drives,
            AMPLITUDE => &self.readings,
            AMPLITUDE_SD | MEAN => READINGS,
            _ => std::slice::from_ref(&MEASURED[column].unit),
        }
    }

    /// The unit of a column where nothing states one; none where only the table could tell.
    pub fn natural(&self, column: usize) -> Option<&'static str> {
        match column {
            DRIVE | AMPLITUDE | AMPLITUDE_SD | MEAN if self.is_free() => None,
            DRIVE => self.drives.first().copied(),
            AMPLITUDE | AMPLITUDE_SD | MEAN => self.readings.first().copied(),
            _ => Some(MEASURED[column].unit),
        }
    }

    /// The header of a column in SI, as the documentation has it.
    pub fn standard(&self, column: usize) -> &'static str {
        let unit = self.natural(column).unwrap_or("m");
        match (column, unit) {
            (SPEED, _) => "speed_m_s",
            (LOAD, _) => "load_n",
            (FREQUENCY, _) => "frequency_hz",
            (DRIVE, _) if self.is_free() => "force_n",
            (DRIVE, unit) => drive_header(unit),
            (AMPLITUDE, unit) => amplitude_header(unit),
            (AMPLITUDE_SD, "rad") => "amplitude_sd_rad",
            (AMPLITUDE_SD, _) => "amplitude_sd_percent",
            (MEAN, "rad") => "mean_rad",
            (MEAN, "V") => "mean_v",
            (MEAN, _) => "mean_m",
            (PHASE, _) => "phase_rad",
            _ => "phase_sd_rad",
        }
    }

    /// What a column needs to be for the rig, as headers.
    pub fn headers(&self, column: usize) -> String {
        let of = if column == DRIVE { drive_header } else { amplitude_header };
        let list: Vec<&str> = self.serving(column).iter().map(|unit| of(unit)).collect();
        match list.as_slice() {
            [one] => (*one).into(),
            [several @ .., last] => format!("{} or {last}", several.join(", ")),
            [] => String::new(),
        }
    }

    /// The keys to change for a drive or an amplitude in another unit to serve, as the end of a sentence.
    pub fn change(&self, column: usize, unit: &str) -> String {
        let Some(scenario) = self.scenario else { return String::new() };
        let instrument = &scenario.instrument;
        let (stated, key) = match column {
            DRIVE => (instrument.drive_sensitivity, "drive_sensitivity"),
            _ => (instrument.sensitivity, "sensitivity"),
        };
        if stated.is_some() {
            return format!("or remove `{key}` from [instrument]: it says that the table is in volts");
        }
        if unit == "V" {
            return format!("or state `{key}` in [instrument]");
        }
        let angle = unit.contains("rad") || unit == "N m";
        let mut keys = Vec::new();
        let excitation = match scenario.rig {
            Rig::TorsionalArm(_) => {
                keys.push("kind = \"oscillator\"");
                if angle {
                    keys.push("coordinate = \"angle\"");
                }
                Excitation::Force
            }
            Rig::Oscillator(rig) => {
                match (rig.coordinate, angle) {
                    (Coordinate::Displacement, true) => keys.push("coordinate = \"angle\""),
                    (Coordinate::Angle, false) => keys.push("coordinate = \"displacement\""),
                    _ => {}
                }
                rig.excitation
            }
        };
        if column == DRIVE {
            keys.push(match (unit, excitation) {
                ("N" | "N m", _) => "drive = \"force\"",
                ("m/s^2" | "rad/s^2", _) => "drive = \"base\"",
                (_, Excitation::Force) => "drive = \"base\" or \"spring\"",
                (_, Excitation::Base) => "drive = \"base\"",
                (_, Excitation::Spring) => "drive = \"spring\"",
            });
        }
        format!("or say in [rig] that it is another: {}", keys.join(", "))
    }

    /// What drive and reading are, from their units.
    pub fn signals(&self, drive: &str, reading: &str) -> Signals {
        let stated = self.scenario.map(|scenario| scenario.signals);
        let volts = |unit: &str, stated: Option<Signal>| stated.filter(|signal| unit == "V" && signal.unit == "V");
        Signals {
            drive: volts(drive, stated.map(|s| s.drive)).unwrap_or_else(|| drive_signal(drive)),
            reading: volts(reading, stated.map(|s| s.reading)).unwrap_or_else(|| reading_signal(reading)),
        }
    }

    /// Whether a scenario leaves the sensitivity of a signal in volts open.
    pub fn lacks_sensitivity(&self, column: usize) -> bool {
        let Some(scenario) = self.scenario else { return false };
        let instrument = &scenario.instrument;
        if column == DRIVE { instrument.drive_sensitivity.is_none() } else { instrument.sensitivity.is_none() }
    }
}

fn drive_signal(unit: &str) -> Signal {
    match unit {
        "N" => Signal::FORCE,
        "N m" => Signal::TORQUE,
        "rad" => Signal::DRIVE_ANGLE,
        "m/s^2" => Signal::DRIVE_ACCELERATION,
        "rad/s^2" => Signal::DRIVE_ANGULAR_ACCELERATION,
        "V" => Signal::DRIVE_VOLTAGE,
        _ => Signal::DRIVE_DISPLACEMENT,
    }
}

fn reading_signal(unit: &str) -> Signal {
    match unit {
        "m" => Signal::DISPLACEMENT,
        "m/s" => Signal::VELOCITY,
        "m/s^2" => Signal::ACCELERATION,
        "rad/s" => Signal::ANGULAR_VELOCITY,
        "rad/s^2" => Signal::ANGULAR_ACCELERATION,
        "V" => Signal::VOLTAGE,
        _ => Signal::ANGLE,
    }
}

fn drive_header(unit: &str) -> &'static str {
    match unit {
        "N" => "force_n",
        "N m" => "torque_n_m",
        "rad" => "drive_rad",
        "m/s^2" => "drive_m_s2",
        "rad/s^2" => "drive_rad_s2",
        "V" => "drive_v",
        _ => "drive_m",
    }
}

/// The header of an amplitude in an SI unit.
pub(crate) fn amplitude_header(unit: &str) -> &'static str {
    match unit {
        "m" => "amplitude_m",
        "m/s" => "amplitude_m_s",
        "m/s^2" => "amplitude_m_s2",
        "rad/s" => "amplitude_rad_s",
        "rad/s^2" => "amplitude_rad_s2",
        "V" => "amplitude_v",
        _ => "amplitude_rad",
    }
}

/// What a unit in SI measures, in running text.
pub(crate) fn kind(unit: &str) -> &'static str {
    match unit {
        "N" => "a force",
        "N m" => "a torque",
        "m" => "a displacement",
        "m/s" => "a velocity",
        "m/s^2" => "an acceleration",
        "rad" => "an angle",
        "rad/s" => "an angular velocity",
        "rad/s^2" => "an angular acceleration",
        "V" => "a voltage",
        "1" => "a strain; where it goes with the displacement call it amplitude_v, and its sensitivity is fitted",
        _ => "another quantity",
    }
}
