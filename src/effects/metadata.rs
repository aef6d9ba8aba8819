//! What is known of an effect and its parameters beside the law.

use super::Effect;
use crate::scenario::Coordinate;

/// A parameter of an effect, of the rig, the contact or the instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Key inside its table, e.g. `beta`, `torsional_stiffness`.
    pub key: &'static str,
    /// Symbol of the equations, e.g. `β`, `K₀`.
    pub symbol: &'static str,
    /// SI unit in the notation of scenario files, e.g. `N m/rad`; `1` for pure numbers.
    pub unit: &'static str,
    /// Smallest value that is physical.
    pub minimum: f64,
    /// Largest value that is physical.
    pub maximum: f64,
    /// Magnitudes that a search should cover, the smaller may be 0; `None` where the catalogue gives none.
    pub range: Option<(f64, f64)>,
    /// Whether a search should try both signs.
    pub signed: bool,
    /// One phrase of meaning.
    pub meaning: &'static str,
}

impl ParameterInfo {
    /// A parameter of an effect: (key, symbol, unit), physical limits, range of a search, meaning.
    pub const fn searched(
        (key, symbol, unit): (&'static str, &'static str, &'static str),
        (minimum, maximum): (f64, f64),
        range: (f64, f64),
        meaning: &'static str,
    ) -> Self {
        Self { key, symbol, unit, minimum, maximum, range: Some(range), signed: false, meaning }
    }

    /// The same, of either sign.
    pub const fn either_sign(self) -> Self {
        Self { signed: true, ..self }
    }

    /// Its unit on a rig with that coordinate: the catalogue states effects of the rig for an angle.
    pub fn unit_for(&self, coordinate: Coordinate) -> &'static str {
        match (coordinate, self.unit) {
            (Coordinate::Displacement, "N m") => "N",
            (Coordinate::Displacement, "rad") => "m",
            (Coordinate::Displacement, "N m/rad") => "N/m",
            (Coordinate::Displacement, "N m s/rad") => "N s/m",
            (Coordinate::Displacement, "N m/rad^2") => "N/m^2",
            (Coordinate::Displacement, "N m s^2/rad^2") => "N s^2/m^2",
            (Coordinate::Displacement, "N m/rad^3") => "N/m^3",
            (Coordinate::Displacement, "N m/rad^5") => "N/m^5",
            (_, unit) => unit,
        }
    }

    /// The same on a rig with that coordinate.
    pub fn on(&self, coordinate: Coordinate) -> Self {
        Self { unit: self.unit_for(coordinate), ..*self }
    }
}

/// Part of the experiment that an effect belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// The law of friction at the interface.
    Interface,
    /// The element between the interface and the arm.
    Contact,
    /// The arm, its drive, the roller's support, the reading.
    RigAndInstrument,
}

impl Group {
    /// Its name in running text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interface => "interface",
            Self::Contact => "contact",
            Self::RigAndInstrument => "rig and instrument",
        }
    }
}

/// A parameter and the value at which its effect vanishes; infinity means the limit.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Zero {
    /// Index of the parameter.
    pub parameter: usize,
    /// The value.
    pub value: f64,
}

/// Values in the middle of the search ranges (geometric mean to one digit): valid, and no statement about any material.
pub fn typical(effect: &dyn Effect) -> Vec<f64> {
    let middle = |info: &ParameterInfo| {
        let (low, high) = info.range.unwrap_or((info.minimum, info.maximum));
        let low = low.max(1e-4 * high);
        format!("{:.0e}", (low * high).sqrt()).parse().unwrap_or(high)
    };
    effect.parameters().iter().map(middle).collect()
}
