//! What is meant: the validated scenario in SI, the type that every later step starts from.

use super::parameters::{DRIVE_SENSITIVITY, INSTRUMENT, SENSITIVITY};
use super::rig::{Rig, Signals};
use crate::effects::Effect;
use crate::parameter::ParameterInfo;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// How the contact equations are discretised and coupled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Formulation {
    /// Kelvin-Voigt bristle in series with a slip interface: the physical statement.
    Series,
    /// The published explicit Euler procedure (paper Eqs. 17-18).
    Paper,
}

/// The base contact, SI units.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Contact {
    /// kc, stiffness of the bristles \[N/m\].
    pub stiffness: f64,
    /// cc, damping of the bristles \[N s/m\].
    pub damping: f64,
    /// mu, coefficient of friction \[-\].
    pub friction: f64,
    /// Which of the two formulations is solved.
    pub formulation: Formulation,
}

impl Contact {
    /// That of a rig without one.
    pub const NONE: Self = Self { stiffness: 0.0, damping: 0.0, friction: 0.0, formulation: Formulation::Series };
}

/// How the reading relates to the motion, and the drive to what is stated of it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Instrument {
    /// True drive over stated drive \[-\]; of a drive in volts, its sensitivity (volts per drive).
    pub drive_gain: f64,
    /// Reading over true amplitude \[-\]; of a reading in volts, its sensitivity (volts per motion).
    pub amplitude_gain: f64,
    /// Reading minus true phase \[rad\].
    pub phase_offset: f64,
    /// Which of [`DRIVE_SENSITIVITY`] the drive's gain is, where it is one.
    pub drive_sensitivity: Option<usize>,
    /// Which of [`SENSITIVITY`] the amplitude's gain is, where it is one.
    pub sensitivity: Option<usize>,
}

impl Default for Instrument {
    fn default() -> Self {
        Self { drive_gain: 1.0, amplitude_gain: 1.0, phase_offset: 0.0, drive_sensitivity: None, sensitivity: None }
    }
}

impl Instrument {
    /// Gain of the drive, gain of the reading, offset of the phase, as they are stated.
    pub fn parameters(&self) -> [&'static ParameterInfo; 3] {
        [
            self.drive_sensitivity.map_or(&INSTRUMENT[0], |at| &DRIVE_SENSITIVITY[at]),
            self.sensitivity.map_or(&INSTRUMENT[1], |at| &SENSITIVITY[at]),
            &INSTRUMENT[2],
        ]
    }
}

/// The product of these lists is what is solved; order of the axes, outermost first:
/// formulation, drive, load, friction, speed, frequency.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Sweep {
    /// f, drive frequencies \[Hz\].
    pub frequency: Vec<f64>,
    /// V, peripheral speeds of the roller \[m/s\].
    pub speed: Vec<f64>,
    /// W, normal loads \[N\]; 0 means no contact.
    pub load: Vec<f64>,
    /// Amplitudes of the drive, of the paper's actuator u0 \[m\].
    pub drive: Vec<f64>,
    /// mu, coefficients of friction \[-\]; the scenario's own where the file gives no list.
    pub friction: Vec<f64>,
    /// Formulations; the scenario's own where the file gives no list.
    pub formulation: Vec<Formulation>,
    /// Steps per cycle of the Euler procedure; used by [`Formulation::Paper`] only.
    pub euler_steps: Vec<usize>,
}

/// One effect, of the catalogue or a formula, with its parameters, as a scenario carries it.
#[derive(Clone, serde::Serialize)]
pub struct EffectSetting {
    /// The effect.
    #[serde(rename = "name", serialize_with = "by_name")]
    pub effect: &'static dyn Effect,
    /// Parameter values in SI, in the order of the effect.
    pub parameters: Vec<f64>,
}

fn by_name<S: serde::Serializer>(effect: &&'static dyn Effect, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(effect.name())
}

impl EffectSetting {
    /// Name of the effect.
    pub fn name(&self) -> &'static str {
        self.effect.name()
    }

    /// Whether it is a formula that is stated without strength: nothing of the model, but something that a search may
    /// find.
    pub fn is_candidate(&self, free: &[String]) -> bool {
        let vanishes = self.effect.formula().is_some_and(|formula| formula.vanishes(&self.parameters));
        vanishes && !self.effect.keys().iter().any(|key| free.contains(key))
    }
}

impl PartialEq for EffectSetting {
    fn eq(&self, other: &Self) -> bool {
        let law = |setting: &Self| (setting.name(), setting.effect.equation());
        law(self) == law(other) && self.parameters == other.parameters
    }
}

impl std::fmt::Debug for EffectSetting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EffectSetting").field("name", &self.name()).field("parameters", &self.parameters).finish()
    }
}

/// The table of measured steady states to compare with.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MeasurementSource {
    /// Path of the table, resolved against the scenario's folder.
    pub file: PathBuf,
    /// Mapping from the standard column name to the header in the table.
    pub columns: Vec<(String, String)>,
    /// Which frequency response function of a universal file, counted from 1; needed where there are several.
    pub record: Option<usize>,
    /// Which sheet of a workbook; the first where it is not said.
    pub sheet: Option<String>,
    /// Lowest and highest frequency of the readings that are used \[Hz\]; all where it is not said.
    pub band: Option<(f64, f64)>,
}

/// What has to hold for a run to pass; what is absent is not asked for.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Gate {
    /// Largest root mean square error of the amplitude, relative.
    pub max_rms_error: Option<f64>,
    /// Largest mean square of the residuals in standard deviations.
    pub max_chi2_per_point: Option<f64>,
    /// Largest error of any amplitude, relative to its reading.
    pub amplitude_tolerance: Option<f64>,
    /// Largest error of an amplitude that passes however small its reading, in the unit of the reading.
    pub amplitude_floor: Option<f64>,
    /// The unit that it is stated in; `None` where it is a bare number, which is in that of the reading.
    pub floor_unit: Option<&'static str>,
    /// Largest error of any phase \[rad\]; phases of amplitudes below the floor are not judged.
    pub phase_tolerance: Option<f64>,
    /// Verdict that a discovery has to come to.
    pub verdict: Option<String>,
    /// Effects that it has to name, in any order.
    pub effects: Option<Vec<String>>,
    /// Claims that have to be reproduced.
    pub claims: Vec<String>,
}

impl Gate {
    /// Whether it asks for something that only measurements can decide.
    pub fn needs_measurements(&self) -> bool {
        *self != Self { claims: self.claims.clone(), ..Self::default() }
    }

    /// Keys of what only a discovery can decide.
    pub fn needs_discovery(&self) -> Vec<&'static str> {
        let keys = [("verdict", self.verdict.is_some()), ("effects", self.effects.is_some())];
        keys.into_iter().filter(|(_, asked)| *asked).map(|(key, _)| key).collect()
    }
}

/// A question to the catalogue: which effects make the curve of the sweep look like one of the model itself at another
/// speed?
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Question {
    /// V of the model's own curve that is to be resembled \[m/s\].
    pub resembles: f64,
    /// Relative difference of two amplitudes that counts as none \[-\].
    pub tolerance: f64,
}

/// A validated scenario.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
// Wide: a field is a table or a key of the file.
pub struct Scenario {
    /// Stable identifier: path below the scenarios folder without extension, e.g. `paper/figure-6`.
    pub id: String,
    /// The file as the user named it (for embedded scenarios, its name inside the binary).
    pub path: PathBuf,
    /// BLAKE3 hash (hex) of the file and everything it extends.
    pub hash: String,
    /// Title; plain text of the user, to be escaped wherever it is shown.
    pub title: String,
    /// What the scenario is about, one or two sentences; may be empty.
    pub description: String,
    /// Where the numbers come from: "published number", "independent computation", "synthetic, hidden effect (if any)
    /// known only to the generator", "measured"; may be empty.
    pub provenance: String,
    /// Where the numbers come from that stand in a file that this one extends, by their keys, e.g. `rig.inertia`.
    #[serde(skip)]
    pub origins: BTreeMap<String, String>,
    /// The rig.
    pub rig: Rig,
    /// The contact, where there is one.
    pub contact: Option<Contact>,
    /// The instrument.
    pub instrument: Instrument,
    /// What is driven and what is read.
    pub signals: Signals,
    /// What to sweep; absent where only measurements are compared.
    pub sweep: Option<Sweep>,
    /// Effects beyond the base law.
    pub effects: Vec<EffectSetting>,
    /// Measurements, where there are any.
    pub measurement: Option<MeasurementSource>,
    /// What is asked of the catalogue of effects, where anything is.
    pub question: Option<Question>,
    /// Keys of the parameters that a calibration may move, e.g. `contact.stiffness`.
    pub free: Vec<String>,
    /// Names of the figures of the sweep to draw; `None` means the default ones.
    pub figures: Option<Vec<String>>,
    /// What has to hold.
    pub gate: Gate,
}
