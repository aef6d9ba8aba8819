//! The reading that tells the leading hypotheses apart.

use super::Hypothesis;
use crate::discover::farthest;
use crate::model::{Model, Operation};
use crate::solver::cycle::Tolerance;
use crate::solver::{Warm, solve_steady};
use crate::sweep::Condition;

/// Hypotheses that are told apart, at most.
pub const MOST: usize = 4;
/// Multiples of the speed, the load and the drive of the question at which a reading is tried. They are assumed: what
/// the rig allows is not known.
const SPEEDS: [f64; 7] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
const LOADS: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const DRIVES: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];
/// Frequencies tried.
const FREQUENCIES: usize = 26;

/// What one hypothesis says of the reading.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Prediction {
    /// The effect.
    pub effect: String,
    /// alpha \[rad\].
    pub amplitude_rad: f64,
}

/// The reading at which the leading hypotheses, each at its closest, differ most.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Deciding {
    /// V \[m/s\].
    pub speed_m_s: f64,
    /// W \[N\].
    pub load_n: f64,
    /// u0 \[m\].
    pub drive_m: f64,
    /// f \[Hz\].
    pub frequency_hz: f64,
    /// What each says, the smallest amplitude first.
    pub predictions: Vec<Prediction>,
    /// Relative difference of the two amplitudes that are closest to each other \[-\].
    pub least_difference: f64,
    /// The largest that can be had at the condition of the question itself, for comparison \[-\].
    pub without_change: f64,
}

/// The reading that tells apart the leading hypotheses that can; `None` for fewer than two.
pub(super) fn deciding(
    base: &Model,
    condition: &Condition,
    frequency: &[f64],
    hypotheses: &[Hypothesis],
) -> Option<Deciding> {
    let leading: Vec<&Hypothesis> = hypotheses.iter().filter(|h| h.can()).take(MOST).collect();
    if leading.len() < 2 {
        return None;
    }
    let models: Vec<Model> = leading.iter().map(|h| h.model(base, &h.best)).collect();
    let models: Vec<&Model> = models.iter().collect();
    let frequency = spread(frequency);
    let grid = |speeds: &[f64], loads: &[f64], drives: &[f64]| -> Vec<Operation> {
        let mut all = Vec::new();
        for (v, w, u) in speeds.iter().flat_map(|v| loads.iter().map(move |w| (v, w))).flat_map(|(v, w)| {
            drives.iter().map(move |u| (v * condition.speed, w * condition.load, u * condition.drive))
        }) {
            all.extend(frequency.iter().map(|&f| Operation { speed: v, load: w, drive: u, frequency: f, series: 0 }));
        }
        all
    };
    let (at, least_difference) = farthest(&models, &grid(&SPEEDS, &LOADS, &DRIVES), (1.0, None))?;
    let without_change = farthest(&models, &grid(&[1.0], &[1.0], &[1.0]), (1.0, None)).map_or(0.0, |(_, d)| d);
    let mut predictions: Vec<Prediction> = leading
        .iter()
        .zip(&models)
        .map(|(h, model)| {
            let state = solve_steady(model, &at, &Tolerance::default(), false, &mut Warm::default()).state;
            Prediction { effect: h.effect.name().into(), amplitude_rad: state.amplitude }
        })
        .collect();
    predictions.sort_by(|a, b| a.amplitude_rad.total_cmp(&b.amplitude_rad));
    Some(Deciding {
        speed_m_s: at.speed,
        load_n: at.load,
        drive_m: at.drive,
        frequency_hz: at.frequency,
        predictions,
        least_difference,
        without_change,
    })
}

/// Some of the frequencies, evenly spread.
fn spread(frequency: &[f64]) -> Vec<f64> {
    let stride = frequency.len().div_ceil(FREQUENCIES).max(1);
    frequency.iter().copied().step_by(stride).collect()
}
