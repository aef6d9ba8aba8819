//! What the contact must have done: its dynamic stiffness and damping from the measured response and the known rig,
//! with no model of the contact at all. Of a rig without one, what force must have acted besides those that the model
//! has.

use super::Compared;
use crate::model::Model;
use crate::model::lumps::Lumps;
use schemars::JsonSchema;
use std::f64::consts::TAU;

/// Dynamic stiffness and damping of the contact at one point: `k + i w c = [Gamma e^{i phi0}/(alpha e^{i phi}) - (K - J
/// w^2 + i w C)]/b^2`; without a contact those of the missing force, with b = 1 and in the units of K and C.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, serde::Serialize)]
pub struct ContactPoint {
    /// Data row of the table, from 1.
    pub row: usize,
    /// Index of the condition.
    pub condition: usize,
    /// f \[Hz\].
    pub frequency_hz: f64,
    /// b w alpha, amplitude of the arm's speed \[m/s\]; without a contact that of the coordinate \[m/s, rad/s\].
    pub speed_amplitude_m_s: f64,
    /// k \[N/m\].
    pub stiffness_n_m: f64,
    /// Its standard deviation \[N/m\]; 0 for a model.
    pub stiffness_sd_n_m: f64,
    /// c \[N s/m\].
    pub damping_n_s_m: f64,
    /// Its standard deviation \[N s/m\]; 0 for a model.
    pub damping_sd_n_s_m: f64,
}

impl ContactPoint {
    /// Amplitude of the motion at the contact \[m\]; without a contact that of the coordinate \[m, rad\].
    pub fn motion(&self) -> f64 {
        self.speed_amplitude_m_s / (TAU * self.frequency_hz)
    }
}

/// The contact of the measurements, and that of the model, at every point with phase. Of `model` only rig and
/// instrument are used; standard deviations are propagated to first order, amplitude and phase being independent.
pub fn fingerprint(model: &Model, points: &[Compared]) -> (Vec<ContactPoint>, Vec<ContactPoint>) {
    let with_phase = points.iter().filter_map(|p| Some((p, p.point.phase?, p.point.phase_sd?)));
    with_phase
        .map(|(p, phase, phase_sd)| {
            let relative = p.point.amplitude_sd / p.point.amplitude;
            let measured = contact(model, p, p.point.amplitude, phase, (relative, phase_sd));
            (measured, contact(model, p, p.model.amplitude, p.model.phase, (0.0, 0.0)))
        })
        .unzip()
}

fn contact(model: &Model, p: &Compared, amplitude: f64, phase: f64, sd: (f64, f64)) -> ContactPoint {
    let point = &p.point;
    let at = crate::fit::operation(point);
    let lumps = Lumps::new(model, &at);
    let (w, b) = (TAU * point.frequency, if model.has_contact { lumps.arm.value } else { 1.0 });
    let (alpha, phi) = (amplitude / lumps.amplitude_gain.value, phase - lumps.phase_offset.value);
    // Of a motion in space, that relative to the base.
    let (alpha, phi, sd) = lumps.read_beside.as_deref().map_or((alpha, phi, sd), |(re, im)| {
        let (re, im) = (alpha * phi.cos() - re.value, alpha * phi.sin() - im.value);
        let relative = re.hypot(im);
        (relative, im.atan2(re), (sd.0 * alpha / relative, sd.1 * alpha / relative))
    });
    // Gamma e^{i phi0}/(alpha e^{i phi}), whose errors are those of the reading.
    let (re, im) = (lumps.torque_re.value, lumps.torque_im.value);
    let drive = ((re * phi.cos() + im * phi.sin()) / alpha, (im * phi.cos() - re * phi.sin()) / alpha);
    let stiffness = drive.0 - (lumps.stiffness.value - lumps.inertia.value * w * w);
    let damping = drive.1 - w * lumps.damping.value;
    let square = b * b;
    ContactPoint {
        row: point.row,
        condition: p.condition,
        frequency_hz: point.frequency,
        speed_amplitude_m_s: b * w * alpha,
        stiffness_n_m: stiffness / square,
        stiffness_sd_n_m: (drive.0 * sd.0).hypot(drive.1 * sd.1) / square,
        damping_n_s_m: damping / (w * square),
        damping_sd_n_s_m: (drive.1 * sd.0).hypot(drive.0 * sd.1) / (w * square),
    }
}
