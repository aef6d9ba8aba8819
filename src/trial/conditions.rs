//! What is measured: the rig as it is stated, and the operating points of a table.

use crate::error::{Error, Result};
use crate::measurement;
use crate::model::{Model, Operation};
use crate::scenario::diagnostic::whole_file;
use crate::scenario::{self, Formulation, Scenario};

/// Speed \[m/s\], load \[N\] and drive \[m\] of the practice tables.
const PRACTICE: [[f64; 3]; 13] = [
    [0.0, 20.0, 2.5e-6],
    [0.0, 20.0, 7.5e-6],
    [0.0, 0.1, 2.5e-6],
    [0.0, 0.1, 7.5e-6],
    [5e-5, 20.0, 2.5e-6],
    [1e-4, 20.0, 2.5e-6],
    [1e-4, 10.0, 2.5e-6],
    [5e-4, 20.0, 2.5e-6],
    [2e-3, 20.0, 2.5e-6],
    [2e-2, 20.0, 2.5e-6],
    [2e-2, 20.0, 7.5e-6],
    [2e-2, 10.0, 2.5e-6],
    [0.1, 20.0, 2.5e-6],
];
/// Their frequencies \[Hz\]: from, step, number.
const FREQUENCIES: (f64, f64, usize) = (52.0, 2.0, 24);

/// The rig as it is stated, what a calibration may move, and what is measured.
#[derive(Debug, Clone)]
pub struct Bench {
    /// Rig and contact as stated, without effects.
    pub model: Model,
    /// Keys of the parameters that a calibration may move.
    pub free: Vec<String>,
    /// The operating points, in the order in which they are measured.
    pub operations: Vec<Operation>,
}

/// The paper's rig at the 13 conditions and 24 frequencies of the practice tables.
pub fn practice() -> Bench {
    let mut operations = Vec::new();
    let (from, step, number) = FREQUENCIES;
    for [speed, load, drive] in PRACTICE {
        operations.extend((0..number).map(|i| Operation {
            speed,
            load,
            drive,
            frequency: from + step * i as f64,
            series: 0,
        }));
    }
    Bench { model: Model::new(&scenario::paper()), free: free(Vec::new()), operations }
}

fn free(stated: Vec<String>) -> Vec<String> {
    if stated.is_empty() { vec!["contact.stiffness".into(), "contact.damping".into()] } else { stated }
}

impl Bench {
    /// The rig of a scenario at the rows of its measurements, or else at the product of its sweep.
    ///
    /// # Errors
    /// [`Error::Input`] where the scenario has effects, or nothing to measure.
    pub fn of(scenario: &Scenario) -> Result<Self> {
        let refuse = |title: &str, help: &str| {
            let title = format!("{}: {title}", scenario.path.display());
            Err(Error::Input(whole_file(&title, help)))
        };
        if !scenario.effects.is_empty() {
            return refuse("a trial plants effects itself", "take the tables [[effect]] out of the scenario");
        }
        if !scenario.rig.is_arm() {
            let help = "trials plant effects in the paper's kind of rig; give a scenario of kind = \"torsional-arm\"";
            return refuse("a rig of kind \"oscillator\"", help);
        }
        if scenario.contact.is_some_and(|contact| contact.formulation == Formulation::Paper) {
            return refuse("the published procedure carries no effects", "use formulation = \"series\"");
        }
        let mut operations = Vec::new();
        if let Some(table) = measurement::load(scenario)? {
            operations.extend(table.points.iter().map(|p| Operation {
                speed: p.speed,
                load: p.load,
                drive: p.drive,
                frequency: p.frequency,
                series: 0,
            }));
        } else if let Some(sweep) = &scenario.sweep {
            for &drive in &sweep.drive {
                for &load in &sweep.load {
                    for &speed in &sweep.speed {
                        let at = |&frequency: &f64| Operation { speed, load, drive, frequency, series: 0 };
                        operations.extend(sweep.frequency.iter().map(at));
                    }
                }
            }
        }
        if operations.is_empty() {
            return refuse("nothing to measure", "add a table [sweep] or [measurement]");
        }
        Ok(Self { model: Model::new(scenario), free: free(scenario.free.clone()), operations })
    }

    /// A hash of everything stated here.
    pub fn hash(&self) -> String {
        // In the form of the committed results, which knew one kind of rig.
        let (rig, i) = (format!("{:?}", self.model.rig.arm()).replace("TorsionalArm", "Rig"), &self.model.instrument);
        // Nor series: what was measured where is the same without.
        let of = |at: &Operation| {
            let Operation { speed, load, drive, frequency, .. } = at;
            format!("Operation {{ speed: {speed:?}, load: {load:?}, drive: {drive:?}, frequency: {frequency:?} }}")
        };
        let operations: Vec<String> = self.operations.iter().map(of).collect();
        let text = format!(
            "Model {{ rig: {rig}, contact: {:?}, instrument: Instrument {{ drive_gain: {:?}, amplitude_gain: {:?}, phase_offset: {:?} }}, \
             effects: [] }} {:?} [{}]",
            self.model.contact,
            i.drive_gain,
            i.amplitude_gain,
            i.phase_offset,
            self.free,
            operations.join(", ")
        );
        blake3::hash(text.as_bytes()).to_hex().to_string()
    }
}
