//! Whether a disturbance of a periodic motion grows.

use crate::model::system::SingleMode;
use std::f64::consts::TAU;

/// Largest modulus of the Floquet multipliers: a disturbance M y'' + (C + c) y' + (K + k) y = 0 over one period, by the
/// exact flow between instants.
pub fn multiplier(mode: &dyn SingleMode, motion: &[[f64; 4]], instants: usize) -> f64 {
    let [mass, damping, stiffness] = mode.linear();
    let h = TAU / mode.omega() / instants as f64;
    let w0 = (stiffness / mass).sqrt();
    let mut product = [[1.0, 0.0], [0.0, 1.0]];
    // Of an odd motion the second half of the period has the slopes of the first.
    for [_, _, k, c] in motion.iter().cycle().take(instants) {
        // In units of 1/w0: y'' + 2 d y' + s y = 0.
        let (s, d) = ((stiffness + k) / stiffness, 0.5 * (damping + c) / (mass * w0));
        let t = h * w0;
        let flow = flow(s, d, t);
        let p = product;
        for i in 0..2 {
            for j in 0..2 {
                product[i][j] = flow[i][0] * p[0][j] + flow[i][1] * p[1][j];
            }
        }
    }
    let (trace, determinant) =
        (product[0][0] + product[1][1], product[0][0] * product[1][1] - product[0][1] * product[1][0]);
    let root = 0.25 * trace * trace - determinant;
    if root >= 0.0 { 0.5 * trace.abs() + root.sqrt() } else { determinant.max(0.0).sqrt() }
}

/// The flow of y'' + 2 d y' + s y = 0 over a time t: y and y' by y and y'.
pub fn flow(s: f64, d: f64, t: f64) -> [[f64; 2]; 2] {
    let square = s - d * d;
    let w = square.abs().sqrt();
    let (cosine, sine) = if square >= 0.0 { ((w * t).cos(), (w * t).sin()) } else { ((w * t).cosh(), (w * t).sinh()) };
    let sine = if w * t < 1e-8 { t } else { sine / w };
    let fade = (-d * t).exp();
    [[fade * (cosine + d * sine), fade * sine], [-fade * s * sine, fade * (cosine - d * sine)]]
}
