//! Steady states against numbers that a separate program integrated (Newmark for the arm, trapezoidal stretch).

mod common;

use common::{paper_model, steady};
use stickslip::model::Operation;
use stickslip::scenario::Formulation;
use stickslip::solver::{Status, Warm, cycle::Tolerance, solve};

#[test]
fn base_rows_agree_to_1e_4() {
    let model = paper_model(Formulation::Series);
    let table = include_str!("data/effects.csv");
    let mut rows = 0;
    for line in table.lines().filter(|line| line.starts_with("none,")) {
        let v: Vec<f64> = line.split(',').skip(2).map(|v| v.parse().unwrap()).collect();
        let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3], series: 0 };
        let state = steady(&model, &at);
        assert_eq!(state.status, Status::Steady, "{line}");
        assert!((state.amplitude / v[4] - 1.0).abs() < 1e-4, "{line}: amplitude {:e}", state.amplitude);
        assert!((state.phase - v[5]).abs() < 1e-4, "{line}: phase {}", state.phase);
        assert!((state.mean - v[6]).abs() < 1e-4 * v[6].abs().max(1e-9), "{line}: mean {:e}", state.mean);
        rows += 1;
    }
    assert_eq!(rows, 25);
}

/// Peaks of the paper formulation on a 0.5 Hz grid: (V in mm/s, f in Hz, alpha in 1e-6 rad).
const PEAKS: [(f64, f64, f64); 8] = [
    (0.0, 81.5, 4.58),
    (0.001, 81.5, 4.52),
    (0.01, 80.5, 4.10),
    (0.02, 79.0, 3.90),
    (0.05, 74.0, 4.17),
    (0.10, 71.0, 5.26),
    (0.15, 71.0, 6.12),
    (0.17, 71.0, 6.24),
];

#[test]
fn peaks_of_the_paper_formulation_agree_with_the_independent_table() {
    let model = paper_model(Formulation::Paper);
    let euler =
        |at: &Operation| solve(&model, at, 80_000, &Tolerance::default(), false, &mut Warm::default()).state.amplitude;
    for (speed, frequency, alpha) in PEAKS {
        // Around the tabulated peak the whole half-hertz grid is searched.
        let (best, peak) = (-4..=4)
            .map(|i| frequency + 0.5 * i as f64)
            .map(|f| (f, euler(&common::at(speed * 1e-3, f))))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        assert_eq!(best, frequency, "V = {speed} mm/s");
        assert!((peak * 1e6 - alpha).abs() < 0.0065, "V = {speed} mm/s: {}", peak * 1e6);
    }
}
