//! The comparison as JSON, schema `stickslip.comparison/1`.

use super::{Comparison, ContactPoint, Peak, Region, Setting, Whiteness};
use crate::measurement::NoiseSource;
use serde::Serialize;
use std::collections::BTreeMap;

/// Version of the format.
pub const SCHEMA: &str = "stickslip.comparison/1";

/// What `stickslip compare --json` writes.
#[derive(Debug, Clone, Serialize)]
pub struct ComparisonJson {
    schema: &'static str,
    scenario: String,
    title: String,
    provenance: String,
    measurement_file: String,
    measurement_hash: String,
    notes: Vec<String>,
    points: usize,
    readings: usize,
    chi2_per_point: f64,
    rms_error_percent: f64,
    rms_phase_deg: Option<f64>,
    noise_percent: f64,
    noise_phase_deg: Option<f64>,
    noise_source: NoiseSource,
    parameters: BTreeMap<String, ParameterJson>,
    correlations: Vec<crate::fit::Correlation>,
    whiteness: Whiteness,
    conditions: Vec<ConditionJson>,
    regions: Vec<Region>,
    contact: Vec<ContactPoint>,
    contact_model: Vec<ContactPoint>,
    outliers: Vec<super::Outlier>,
    error_budget: super::ErrorBudget,
}

/// A fitted parameter with its 95 % interval.
#[derive(Debug, Clone, Serialize)]
pub struct ParameterJson {
    value: f64,
    low: f64,
    high: f64,
    unit: &'static str,
    identified: &'static str,
}

impl ParameterJson {
    /// A parameter and its interval.
    pub fn new(unit: &'static str, interval: &crate::fit::Interval) -> Self {
        let crate::fit::Interval { value, low, high, identified } = *interval;
        Self { value, low, high, unit, identified: identified.word() }
    }
}

#[derive(Debug, Clone, Serialize)]
struct ConditionJson {
    speed_m_s: f64,
    load_n: f64,
    drive_m: f64,
    points: usize,
    chi2_per_point: f64,
    rms_error_percent: f64,
    rms_phase_deg: Option<f64>,
    noise_percent: f64,
    model_peak: Option<Peak>,
    measured_peak: Option<Peak>,
}

/// The view of a comparison that scripts read.
pub fn json(comparison: &Comparison) -> ComparisonJson {
    let c = comparison;
    let conditions = c.conditions.iter().map(|condition| {
        let (Setting { speed, load, drive, .. }, m) = (condition.setting, condition.metrics);
        ConditionJson {
            speed_m_s: speed,
            load_n: load,
            drive_m: drive,
            points: m.points,
            chi2_per_point: m.chi2_per_point,
            rms_error_percent: m.rms_error_percent,
            rms_phase_deg: m.rms_phase_deg,
            noise_percent: m.noise_percent,
            model_peak: condition.model_peak,
            measured_peak: condition.measured_peak,
        }
    });
    let parameters = c.fit.parameters.iter().zip(&c.intervals);
    ComparisonJson {
        schema: SCHEMA,
        scenario: c.scenario.id.clone(),
        title: c.scenario.title.clone(),
        provenance: c.scenario.provenance.clone(),
        measurement_file: c.table.file.display().to_string(),
        measurement_hash: c.table.hash.clone(),
        notes: c.table.notes.clone(),
        points: c.overall.points,
        readings: c.overall.readings,
        chi2_per_point: c.overall.chi2_per_point,
        rms_error_percent: c.overall.rms_error_percent,
        rms_phase_deg: c.overall.rms_phase_deg,
        noise_percent: c.overall.noise_percent,
        noise_phase_deg: c.overall.noise_phase_deg,
        noise_source: c.table.amplitude_noise,
        parameters: parameters.map(|(p, i)| (p.key.clone(), ParameterJson::new(p.unit, i))).collect(),
        correlations: c.correlations.clone(),
        whiteness: c.whiteness,
        conditions: conditions.collect(),
        regions: c.regions.clone(),
        contact: c.contact.clone(),
        contact_model: c.contact_model.clone(),
        outliers: c.outliers.clone(),
        error_budget: *c.error_budget(),
    }
}
