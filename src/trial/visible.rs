//! Whether data could show a planted cause at all.

use super::conditions::Bench;
use super::generate::Reading;
use crate::compare;
use crate::measurement::Point;
use crate::solver::cycle::Tolerance;

/// The readings as measured points without noise, with the standard deviations that they will have.
pub fn noiseless(bench: &Bench, readings: &[Reading], noise: f64, phase: bool) -> Vec<Point> {
    let point = |(row, (at, reading)): (usize, (&crate::model::Operation, &Reading))| Point {
        row: row + 1,
        line: row + 2,
        speed: at.speed,
        load: at.load,
        drive: at.drive,
        frequency: at.frequency,
        amplitude: reading.amplitude,
        phase: phase.then_some(reading.phase),
        amplitude_sd: noise * reading.amplitude,
        phase_sd: phase.then_some(noise),
        mean: None,
        replicates: 1,
        series: 0,
    };
    bench.operations.iter().zip(readings).enumerate().map(point).collect()
}

/// Mean square misfit that the calibrated base is left with, in standard deviations, beyond the noise.
pub fn excess(bench: &Bench, readings: &[Reading], noise: f64, phase: bool) -> f64 {
    let points = noiseless(bench, readings, noise, phase);
    let fit = compare::calibrate(&bench.model, &bench.free, &points, Tolerance::COARSE, 0).fit;
    fit.evaluation.chi2() / fit.evaluation.residuals.len() as f64
}
