//! What a search reads: a scenario and a table with noise.

use super::conditions::Bench;
use super::draw::stream;
use super::generate::Reading;
use crate::statistics::wrap;
use rand::RngExt as _;
use rand_distr::{Distribution as _, StandardNormal};

/// Sizes of readings thrown far off, in standard deviations.
const OUTLYING: (f64, f64) = (8.0, 40.0);

/// The noisy table as CSV. The standard deviations stated are those that the noise has.
pub fn table(bench: &Bench, readings: &[Reading], noise: f64, outliers: f64, phase: bool, seed: &str) -> String {
    let mut rng = stream(&["noise", seed]);
    let mut thrown = stream(&["outliers", seed]);
    let mut off = move || {
        if thrown.random::<f64>() >= outliers {
            return 0.0;
        }
        let size = OUTLYING.0 * (OUTLYING.1 / OUTLYING.0).powf(thrown.random::<f64>());
        if thrown.random::<bool>() { size } else { -size }
    };
    let mut text = String::from("speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,amplitude_sd_rad");
    text += if phase { ",phase_rad,phase_sd_rad\n" } else { "\n" };
    for (at, reading) in bench.operations.iter().zip(readings) {
        let mut deviation = || -> f64 {
            let normal: f64 = StandardNormal.sample(&mut rng);
            noise * (normal + off())
        };
        // Both are drawn whether or not they are shown, so that tables with and without phases have the same
        // amplitudes.
        let (by, turn) = (deviation(), deviation());
        let amplitude = (reading.amplitude * (1.0 + by)).abs();
        let sd = noise * reading.amplitude;
        text += &format!("{},{},{:e},{},{amplitude:.6e},{sd:.3e}", at.speed, at.load, at.drive, at.frequency);
        if phase {
            text += &format!(",{:.6},{noise}", wrap(reading.phase + turn));
        }
        text.push('\n');
    }
    text
}

/// The scenario beside it: the rig as stated, nothing of what is planted.
pub fn scenario(bench: &Bench) -> String {
    let (r, c, i) = (bench.model.rig.arm(), &bench.model.contact, &bench.model.instrument);
    let free: Vec<String> = bench.free.iter().map(|key| format!("\"{key}\"")).collect();
    format!(
        "title = \"Blind trial\"\nprovenance = \"synthetic, hidden cause\"\n\n[rig]\ninertia = {}\ntorsional_stiffness = {}\n\
         torsional_damping = {}\nspring_stiffness = {}\nspring_damping = {}\nspring_arm = {}\ncontact_arm = {}\n\n[contact]\n\
         stiffness = {}\ndamping = {}\nfriction = {}\n\n[instrument]\ndrive_gain = {}\namplitude_gain = {}\nphase_offset = {}\n\n\
         [measurement]\nfile = \"measurements.csv\"\n\n[fit]\nfree = [{}]\n",
        r.inertia,
        r.torsional_stiffness,
        r.torsional_damping,
        r.spring_stiffness,
        r.spring_damping,
        r.spring_arm,
        r.contact_arm,
        c.stiffness,
        c.damping,
        c.friction,
        i.drive_gain,
        i.amplitude_gain,
        i.phase_offset,
        free.join(", ")
    )
}
