//! The discovery as JSON, schema `stickslip.discovery/1`.

use super::{Basis, Candidate, Discovery, NextMeasurement, NotTestable, Step};
use crate::compare::{ContactPoint, ForceJson, Outlier, ParameterJson, Region, SettingJson, of_contact};
use crate::fit::Correlation;
use crate::measurement::Noise;
use crate::scenario::Signals;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Version of the format.
pub const SCHEMA: &str = "stickslip.discovery/1";

/// What `stickslip discover --json` writes.
#[derive(Debug, Clone, JsonSchema, Serialize)]
// Wide: a field is a key of the file, in the order in which it is written.
pub struct DiscoveryJson {
    schema: &'static str,
    scenario: String,
    title: String,
    provenance: String,
    measurement_file: String,
    measurement_hash: String,
    verdict: &'static str,
    effects: Vec<String>,
    recalibrate: Vec<String>,
    steps: Vec<StepJson>,
    candidates: Vec<CandidateJson>,
    indistinguishable: Vec<Vec<String>>,
    /// Effects that the search asked for, the usual ones or those of `--candidates`.
    asked: Vec<&'static str>,
    not_testable: Vec<String>,
    not_testable_details: Vec<NotTestable>,
    outliers: Vec<Outlier>,
    next_measurement: Option<NextJson>,
    noise_factor: f64,
    noise_contradicted: bool,
    noise_factors: Noise,
    correlations: Vec<Correlation>,
    regions: Vec<Region>,
    /// The contact's fingerprint, where something is left unexplained.
    contact: Vec<ContactPoint>,
    /// The missing force of a rig without contact, where something is left unexplained.
    #[serde(skip_serializing_if = "Option::is_none")]
    missing_force: Option<ForceJson>,
    notes: Vec<String>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct NextJson {
    #[serde(flatten)]
    setting: SettingJson,
    frequency_hz: f64,
    separates: [String; 2],
    sigma: f64,
    ruled_out_by: Option<f64>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct StepJson {
    added: Option<String>,
    chi2_per_point: f64,
    rms_error_percent: f64,
    rms_phase_deg: Option<f64>,
    noise_percent: f64,
    held_out_rms_percent: Option<f64>,
    held_out_chi2_per_point: Option<f64>,
    structured: bool,
    parameters: BTreeMap<String, ParameterJson>,
    regions: Vec<Region>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
// Wide: a field is a key of the file, in the order in which it is written.
struct CandidateJson {
    effects: Vec<String>,
    recalibrate: Vec<String>,
    delta_bic: f64,
    weight: f64,
    testable: bool,
    chi2_per_point: f64,
    held_out_rms_percent: Option<f64>,
    held_out_chi2_per_point: Option<f64>,
    /// How the fit ended, and the points it was made to.
    termination: String,
    fitted_points: usize,
    /// What chi2 and BIC rest on, in words.
    basis: String,
    parameters: BTreeMap<String, ParameterJson>,
}

/// The view of a discovery that scripts read.
pub fn json(discovery: &Discovery) -> DiscoveryJson {
    let d = discovery;
    let end = d.explanation();
    let scenario = &end.comparison.scenario;
    let points_of = &end.comparison.table.points;
    let phases = points_of.iter().filter(|point| point.phase.is_some()).count();
    let unexplained = d.verdict == super::Verdict::Unexplained;
    let (model, points) = (&end.comparison.model, if unexplained { &end.comparison.contact[..] } else { &[] });
    DiscoveryJson {
        schema: SCHEMA,
        scenario: scenario.id.clone(),
        title: scenario.title.clone(),
        provenance: scenario.provenance.clone(),
        measurement_file: end.comparison.table.file.display().to_string(),
        measurement_hash: end.comparison.table.hash.clone(),
        verdict: d.verdict.word(),
        effects: end.hypothesis.effects(),
        recalibrate: end.hypothesis.recalibrated(),
        steps: d.steps.iter().map(step).collect(),
        candidates: d.candidates.iter().map(|c| candidate(c, end.comparison.table.points.len())).collect(),
        indistinguishable: d.indistinguishable.clone(),
        asked: d.asked.clone(),
        not_testable: d.not_testable.iter().map(|n| n.effect.clone()).collect(),
        not_testable_details: d.not_testable.clone(),
        outliers: d.outliers.clone(),
        next_measurement: d.next_measurement.as_ref().map(|next| next_json(next, &end.comparison.table.signals)),
        noise_factor: end.comparison.whiteness.scatter().0 * d.noise.together(points_of.len(), phases),
        noise_contradicted: d.noise.contradicts(end.comparison.table.noise_sources()),
        noise_factors: d.noise,
        correlations: d.correlations.clone(),
        regions: end.comparison.regions.clone(),
        contact: of_contact(model, points),
        missing_force: ForceJson::of(model, points),
        notes: d.notes.clone(),
    }
}

fn next_json(next: &NextMeasurement, signals: &Signals) -> NextJson {
    NextJson {
        setting: SettingJson::new(&next.setting, signals),
        frequency_hz: next.frequency_hz,
        separates: next.separates.clone(),
        sigma: next.sigma,
        ruled_out_by: next.ruled_out_by,
    }
}

fn step(step: &Step) -> StepJson {
    let c = &step.comparison;
    StepJson {
        added: step.added.clone(),
        chi2_per_point: c.overall.chi2_per_point,
        rms_error_percent: c.overall.rms_error_percent,
        rms_phase_deg: c.overall.rms_phase_deg,
        noise_percent: c.overall.noise_percent,
        held_out_rms_percent: step.held_out.map(|h| h.rms_percent),
        held_out_chi2_per_point: step.held_out.map(|h| h.chi2_per_point),
        structured: c.whiteness.structured,
        parameters: parameters(&c.fit, &c.intervals),
        regions: c.regions.clone(),
    }
}

fn candidate(candidate: &Candidate, points: usize) -> CandidateJson {
    let h = &candidate.hypothesis;
    CandidateJson {
        effects: h.effects(),
        recalibrate: h.recalibrated(),
        delta_bic: candidate.delta_bic,
        weight: candidate.weight,
        testable: candidate.testable,
        chi2_per_point: candidate.chi2_per_point,
        held_out_rms_percent: candidate.held_out.map(|h| h.rms_percent),
        held_out_chi2_per_point: candidate.held_out.map(|h| h.chi2_per_point),
        termination: h.fit.termination.clone(),
        fitted_points: if h.basis() == Basis::Linear { 0 } else { h.fit.evaluation.predictions.len() },
        basis: h.basis().words(points),
        parameters: parameters(&h.fit, &candidate.intervals),
    }
}

fn parameters(fit: &crate::fit::Fit, intervals: &[crate::fit::Interval]) -> BTreeMap<String, ParameterJson> {
    fit.parameters.iter().zip(intervals).map(|(p, i)| (p.key.clone(), ParameterJson::new(p.unit, i))).collect()
}
