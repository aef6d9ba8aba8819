//! The comparison as JSON, schema `stickslip.comparison/1`.

use super::{Comparison, ContactPoint, Peak, Region, Setting, Whiteness};
use crate::measurement::{NoiseSource, Table};
use crate::model::Model;
use crate::scenario::{Coordinate, Rig, Signals};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Version of the format.
pub const SCHEMA: &str = "stickslip.comparison/1";

/// What `stickslip compare --json` writes.
#[derive(Debug, Clone, JsonSchema, Serialize)]
// Wide: a field is a key of the file, in the order in which it is written.
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
    /// Schwarz's criterion: squares in those of the noise, what is far off by its logarithm, and ln(readings) for each
    /// parameter.
    bic: f64,
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
    #[serde(skip_serializing_if = "Option::is_none")]
    missing_force: Option<ForceJson>,
    outliers: Vec<super::Outlier>,
    error_budget: super::ErrorBudget,
}

/// A fitted parameter with its 95 % interval.
#[derive(Debug, Clone, JsonSchema, Serialize)]
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

/// A condition as scripts read it: keys with units where they are those of the paper's rig, and for any other one the
/// drive with its unit, and its series.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct SettingJson {
    #[serde(skip_serializing_if = "Option::is_none")]
    speed_m_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    load_n: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    drive_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    drive: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    drive_unit: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    series: Option<SeriesJson>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct SeriesJson {
    number: usize,
    name: String,
    direction: crate::measurement::Direction,
}

impl SettingJson {
    /// A setting of a rig with those signals.
    pub fn new(setting: &Setting, signals: &Signals) -> Self {
        let other = !signals.of_arm();
        Self {
            speed_m_s: setting.contact.then_some(setting.speed),
            load_n: setting.contact.then_some(setting.load),
            drive_m: (setting.signal.unit == "m").then_some(setting.drive),
            drive: other.then_some(setting.drive),
            drive_unit: other.then_some(setting.signal.unit),
            series: None,
        }
    }

    /// The same with the series number `at` of a table, counted from 0, where the rig is not the paper's.
    fn of_series(self, table: &Table, at: usize) -> Self {
        let series = table.series.get(at).filter(|_| self.drive.is_some()).map(|series| SeriesJson {
            number: at + 1,
            name: series.name.clone(),
            direction: series.direction,
        });
        Self { series, ..self }
    }
}

/// A peak, its height by the key of the paper's rig where that is its unit.
#[derive(Debug, Clone, JsonSchema, Serialize)]
struct PeakJson {
    frequency_hz: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    amplitude_rad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    amplitude: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    amplitude_unit: Option<&'static str>,
}

impl PeakJson {
    fn new(peak: Peak, signals: &Signals) -> Self {
        let (unit, other) = (signals.reading.unit, !signals.of_arm());
        Self {
            frequency_hz: peak.frequency_hz,
            amplitude_rad: (unit == "rad").then_some(peak.amplitude),
            amplitude: other.then_some(peak.amplitude),
            amplitude_unit: other.then_some(unit),
        }
    }
}

/// The force that must have acted on a rig without contact besides those of its model, as a dynamic stiffness and
/// damping.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct ForceJson {
    stiffness_unit: &'static str,
    damping_unit: &'static str,
    motion_unit: &'static str,
    points: Vec<ForcePointJson>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct ForcePointJson {
    row: usize,
    condition: usize,
    frequency_hz: f64,
    motion: f64,
    stiffness: f64,
    stiffness_sd: f64,
    damping: f64,
    damping_sd: f64,
}

impl ForceJson {
    /// That of some points; `None` where the rig has a contact, or no point has a phase.
    pub fn of(model: &Model, points: &[ContactPoint]) -> Option<Self> {
        let [stiffness_unit, damping_unit, motion_unit] = units_of_force(model);
        let point = |p: &ContactPoint| ForcePointJson {
            row: p.row,
            condition: p.condition,
            frequency_hz: p.frequency_hz,
            motion: p.motion(),
            stiffness: p.stiffness_n_m,
            stiffness_sd: p.stiffness_sd_n_m,
            damping: p.damping_n_s_m,
            damping_sd: p.damping_sd_n_s_m,
        };
        (!model.has_contact && !points.is_empty()).then(|| Self {
            stiffness_unit,
            damping_unit,
            motion_unit,
            points: points.iter().map(point).collect(),
        })
    }
}

/// Units of stiffness, damping and motion of a rig without contact; where its mass is not stated the first two are per
/// mass.
pub fn units_of_force(model: &Model) -> [&'static str; 3] {
    let stated = !matches!(model.rig, Rig::Oscillator(oscillator) if !oscillator.mass_stated);
    match (model.rig.coordinate(), stated) {
        (Coordinate::Displacement, true) => ["N/m", "N s/m", "m"],
        (Coordinate::Displacement, false) => ["1/s^2", "1/s", "m"],
        (Coordinate::Angle, true) => ["N m/rad", "N m s/rad", "rad"],
        (Coordinate::Angle, false) => ["1/s^2", "1/s", "rad"],
    }
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct ConditionJson {
    #[serde(flatten)]
    setting: SettingJson,
    points: usize,
    chi2_per_point: f64,
    rms_error_percent: f64,
    rms_phase_deg: Option<f64>,
    noise_percent: f64,
    model_peak: Option<PeakJson>,
    measured_peak: Option<PeakJson>,
}

/// The view of a comparison that scripts read.
pub fn json(comparison: &Comparison) -> ComparisonJson {
    let (c, signals) = (comparison, &comparison.table.signals);
    let peak = |peak: Option<Peak>| peak.map(|peak| PeakJson::new(peak, signals));
    let conditions = c.conditions.iter().enumerate().map(|(at, condition)| {
        let m = condition.metrics;
        ConditionJson {
            setting: SettingJson::new(&condition.setting, signals).of_series(&c.table, at),
            points: m.points,
            chi2_per_point: m.chi2_per_point,
            rms_error_percent: m.rms_error_percent,
            rms_phase_deg: m.rms_phase_deg,
            noise_percent: m.noise_percent,
            model_peak: peak(condition.model_peak),
            measured_peak: peak(condition.measured_peak),
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
        notes: c.table.notes.iter().chain(&c.notes).cloned().collect(),
        points: c.overall.points,
        readings: c.overall.readings,
        chi2_per_point: c.overall.chi2_per_point,
        bic: c.fit.schwarz(1.0, c.overall.readings, c.table.freedom),
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
        contact: of_contact(&c.model, &c.contact),
        contact_model: of_contact(&c.model, &c.contact_model),
        missing_force: ForceJson::of(&c.model, &c.contact),
        outliers: c.outliers.clone(),
        error_budget: *c.error_budget(),
    }
}

/// Points of a contact; none where there is none.
pub fn of_contact(model: &Model, points: &[ContactPoint]) -> Vec<ContactPoint> {
    if model.has_contact { points.to_vec() } else { Vec::new() }
}
