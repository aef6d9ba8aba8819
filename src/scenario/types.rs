//! What is meant: the validated scenario in SI, the type that every later step starts from.

use std::collections::BTreeMap;
use std::path::PathBuf;

/// The rig (paper Eqs. 1-8), SI units.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Rig {
    /// J, inertia of the arm about the torsional axis \[kg m^2\].
    pub inertia: f64,
    /// K0, stiffness of the torsional spring \[N m/rad\].
    pub torsional_stiffness: f64,
    /// C0, damping of the torsional spring \[N m s/rad\].
    pub torsional_damping: f64,
    /// k0, stiffness of each translational (pinching) spring \[N/m\].
    pub spring_stiffness: f64,
    /// c0, damping of each translational spring \[N s/m\].
    pub spring_damping: f64,
    /// a, arm of the translational springs \[m\].
    pub spring_arm: f64,
    /// b, arm of the contact \[m\].
    pub contact_arm: f64,
}

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

/// How the reading relates to the motion.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Instrument {
    /// True u0 over stated u0 \[-\].
    pub drive_gain: f64,
    /// Reading over true amplitude \[-\].
    pub amplitude_gain: f64,
    /// Reading minus true phase \[rad\].
    pub phase_offset: f64,
}

impl Default for Instrument {
    fn default() -> Self {
        Self { drive_gain: 1.0, amplitude_gain: 1.0, phase_offset: 0.0 }
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
    /// u0, amplitudes of the actuator \[m\].
    pub drive: Vec<f64>,
    /// mu, coefficients of friction \[-\]; the scenario's own where the file gives no list.
    pub friction: Vec<f64>,
    /// Formulations; the scenario's own where the file gives no list.
    pub formulation: Vec<Formulation>,
    /// Steps per cycle of the Euler procedure; used by [`Formulation::Paper`] only.
    pub euler_steps: Vec<usize>,
}

/// One effect of the catalogue with its parameters, as a scenario carries it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct EffectSetting {
    /// Name in the registry.
    pub name: String,
    /// Parameter values in SI, in the order of the registry.
    pub parameters: Vec<f64>,
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
    /// Largest error of an amplitude that passes however small its reading \[rad\].
    pub amplitude_floor: Option<f64>,
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

/// A question to the catalogue: which effects make the curve of the sweep look like one of the model itself at another speed?
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Question {
    /// V of the model's own curve that is to be resembled \[m/s\].
    pub resembles: f64,
    /// Relative difference of two amplitudes that counts as none \[-\].
    pub tolerance: f64,
}

/// A validated scenario.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
    /// Where the numbers come from: "published number", "independent computation", "synthetic, hidden effect if any", "measured"; may be empty.
    pub provenance: String,
    /// Where the numbers come from that stand in a file that this one extends, by their keys, e.g. `rig.inertia`.
    #[serde(skip)]
    pub origins: BTreeMap<String, String>,
    /// The rig.
    pub rig: Rig,
    /// The contact.
    pub contact: Contact,
    /// The instrument.
    pub instrument: Instrument,
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
