//! Under what a curve was measured.

use crate::scenario::{Signal, Signals};
use schemars::JsonSchema;

/// Load, speed and drive of a measured curve.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(into = "SettingKeys")]
pub struct Setting {
    /// V \[m/s\].
    pub speed: f64,
    /// W \[N\].
    pub load: f64,
    /// Drive, in the unit of `signal`.
    pub drive: f64,
    /// What drives the rig.
    pub signal: Signal,
    /// Whether there is a contact, so that speed and load mean something.
    pub contact: bool,
    /// Number of the series from 1, where drives alone do not tell them apart; otherwise 0.
    pub number: usize,
    /// What the table calls the series, if anything.
    pub name: Label,
}

/// Relative difference of the drives of two series below which their numbers tell them apart.
const ALIKE: f64 = 0.02;

impl Setting {
    /// Whether another is the same, but for how a drive wavers.
    pub fn is_alike(&self, other: &Self) -> bool {
        (self.speed, self.load) == (other.speed, other.load) && (self.drive / other.drive - 1.0).abs() < ALIKE
    }
}

/// Bytes of a label.
const LABEL: usize = 32;

/// A name of a user's, shortened where it is long.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Label {
    bytes: [u8; LABEL],
    length: usize,
}

impl Label {
    /// The name, or as much of it as there is room for.
    pub fn of(name: &str) -> Self {
        let cut = if name.len() <= LABEL { name.into() } else { format!("{}…", Self::start(name, LABEL - 3)) };
        let mut bytes = [0; LABEL];
        bytes[..cut.len()].copy_from_slice(cut.as_bytes());
        Self { bytes, length: cut.len() }
    }

    /// The first bytes of a text, up to the end of a character.
    fn start(text: &str, most: usize) -> &str {
        let end = (0..=most).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
        &text[..end]
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.length]).unwrap_or_default()
    }
}

/// What is written of a setting.
#[derive(JsonSchema, serde::Serialize)]
pub(super) struct SettingKeys {
    /// V \[m/s\], where there is a contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    speed: Option<f64>,
    /// W \[N\], where there is a contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    load: Option<f64>,
    /// Drive \[m, or the unit that is stated\].
    drive: f64,
    /// Unit of the drive, where it is not that of the paper's rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    drive_unit: Option<&'static str>,
    /// Number of the series from 1, where drives alone do not tell them apart.
    #[serde(skip_serializing_if = "Option::is_none")]
    series: Option<usize>,
    /// What the table calls it.
    #[serde(skip_serializing_if = "Option::is_none")]
    series_name: Option<String>,
}

impl From<Setting> for SettingKeys {
    fn from(s: Setting) -> Self {
        Self {
            speed: s.contact.then_some(s.speed),
            load: s.contact.then_some(s.load),
            drive: s.drive,
            drive_unit: (!s.contact || s.signal != Signals::ARM.drive).then_some(s.signal.unit),
            series: (s.number > 0).then_some(s.number),
            series_name: (s.number > 0).then(|| s.name.as_str().into()),
        }
    }
}

impl Setting {
    /// A setting of the paper's rig.
    pub fn of_arm(speed: f64, load: f64, drive: f64) -> Self {
        Self { speed, load, drive, signal: Signals::ARM.drive, contact: true, number: 0, name: Label::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_short_names_and_shorten_long_ones_between_characters() {
        for name in ["", "0.3", "série 2, à froid"] {
            assert_eq!(Label::of(name).as_str(), name);
        }
        let long = Label::of(&"é".repeat(40));
        assert!(long.as_str().ends_with('…') && long.as_str().len() <= LABEL, "{}", long.as_str());
    }
}
