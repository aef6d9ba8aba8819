//! Gates: what a scenario or the command line demands of a comparison, a discovery and the claims, each judged.
//!
//! Limits hold for the model as the scenario states it, its free parameters calibrated: the base of a discovery.

use crate::claims;
use crate::compare::{Compared, Comparison};
use crate::discover::Discovery;
use crate::scenario::Gate;
use crate::units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Share of the points without a steady state up to which an error over the others may pass.
const UNSOLVED: f64 = 0.01;

/// One demand and what came of it.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Judged {
    /// Id of the scenario.
    pub scenario: String,
    /// Key in the table `[gate]`.
    pub gate: String,
    /// What was found, in words and with unit.
    pub found: String,
    /// What is demanded, in words and with unit.
    pub demanded: String,
    /// What was found as a number in SI, where it is one.
    pub value: Option<f64>,
    /// The limit as a number in SI, where it is one.
    pub limit: Option<f64>,
    /// Whether it holds.
    pub holds: bool,
}

impl Judged {
    /// Scenario, gate, value and limit in a line.
    pub fn sentence(&self) -> String {
        format!("{}: {}: {}; demanded: {}", self.scenario, self.gate, self.found, self.demanded)
    }
}

/// A number with the unit of its limit; percent for shares.
fn largest(id: &str, gate: &str, value: f64, limit: f64, show: impl Fn(f64) -> String) -> Judged {
    Judged {
        scenario: id.into(),
        gate: gate.into(),
        found: show(value),
        demanded: format!("at most {}", show(limit)),
        value: Some(value).filter(|value| value.is_finite()),
        limit: Some(limit),
        // Not a number never holds.
        holds: value <= limit,
    }
}

fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share))
}

/// Four significant digits.
fn digits(value: f64) -> String {
    if !value.is_finite() {
        return "not a number".into();
    }
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    format!("{rounded}")
}

/// The gates of a comparison: its error, its residuals, and the tolerances of every reading.
pub fn of_comparison(gate: &Gate, c: &Comparison) -> Vec<Judged> {
    let id = c.scenario.id.as_str();
    let mut list = Vec::new();
    if let Some(limit) = gate.max_rms_error {
        list.push(largest(id, "max_rms_error", c.overall.rms_error_percent / 100.0, limit, percent));
    }
    if let Some(limit) = gate.max_chi2_per_point {
        list.push(largest(id, "max_chi2_per_point", c.overall.chi2_per_point, limit, digits));
    }
    // These two say nothing of the points that have no steady state.
    let (unsolved, all) = (c.unsolved(), c.points.len());
    for judged in list.iter_mut().filter(|_| unsolved > 0) {
        judged.found += &format!(" (no steady state at {unsolved} of {all} points)");
        judged.holds &= unsolved as f64 <= UNSOLVED * all as f64;
    }
    match of_another_reading(gate, c) {
        Some(judged) => list.push(judged),
        None => list.extend(amplitudes(gate, c).into_iter().chain(phases(gate, c))),
    }
    list
}

/// A floor of another quantity than the one that was read lets nothing be judged.
fn of_another_reading(gate: &Gate, c: &Comparison) -> Option<Judged> {
    let unit = c.table.signals.reading.unit;
    let stated = gate.floor_unit.filter(|stated| *stated != unit)?;
    Some(Judged {
        scenario: c.scenario.id.clone(),
        gate: "amplitude_floor".into(),
        found: format!("a floor in {stated}, while the readings are in {unit}"),
        demanded: format!("a floor in {unit}"),
        value: None,
        limit: None,
        holds: false,
    })
}

/// Readings that are judged one by one: all but those that stand out of their neighbours, which no model follows.
fn judged(c: &Comparison, phase: bool) -> impl Iterator<Item = &Compared> {
    c.points.iter().filter(move |p| !c.stands_out(p.point.row, phase))
}

/// The amplitude that is furthest beyond what its tolerance allows.
fn amplitudes(gate: &Gate, c: &Comparison) -> Option<Judged> {
    let (relative, floor) = match (gate.amplitude_tolerance, gate.amplitude_floor, gate.phase_tolerance) {
        (None, None, _) => return None,
        // Beside a tolerance of the phase alone, the floor is only there for the phase.
        (None, Some(_), Some(_)) => return None,
        (relative, floor, _) => (relative.unwrap_or(0.0), floor.unwrap_or(0.0)),
    };
    let unit = c.table.signals.reading.unit;
    let allowed = |p: &Compared| (relative * p.point.amplitude).max(floor);
    let error = |p: &Compared| (p.model.amplitude - p.point.amplitude).abs();
    let excess = |p: &&Compared| match error(p) {
        e if e.is_nan() => f64::INFINITY,
        // Also where nothing is allowed.
        0.0 => 0.0,
        e => e / allowed(p),
    };
    let worst = judged(c, false).max_by(|a, b| excess(a).total_cmp(&excess(b)))?;
    let key = if gate.amplitude_tolerance.is_some() { "amplitude_tolerance" } else { "amplitude_floor" };
    let show = |value: f64| units::format(value.abs(), unit);
    let mut result = largest(&c.scenario.id, key, error(worst), allowed(worst), show);
    result.found = format!("{} off at row {}", result.found, worst.point.row);
    result.demanded += " there";
    Some(result)
}

/// The phase that is furthest off, of amplitudes above the floor.
fn phases(gate: &Gate, c: &Comparison) -> Option<Judged> {
    let limit = gate.phase_tolerance?;
    let floor = gate.amplitude_floor.unwrap_or(0.0);
    let show = |value: f64| format!("{}°", digits(value.to_degrees()));
    let error = |p: &Compared| p.phase_error().map(|e| if e.is_nan() { f64::INFINITY } else { e.abs() });
    let errors = judged(c, true).filter(|p| p.point.amplitude >= floor);
    let worst = errors.filter_map(|p| Some((error(p)?, p.point.row))).max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((value, row)) = worst else {
        let found = "no phase to judge".into();
        let demanded = format!("at most {}", show(limit));
        let (scenario, gate) = (c.scenario.id.clone(), "phase_tolerance".into());
        return Some(Judged { scenario, gate, found, demanded, value: None, limit: Some(limit), holds: false });
    };
    let mut result = largest(&c.scenario.id, "phase_tolerance", value, limit, show);
    result.found = format!("{} off at row {row}", result.found);
    Some(result)
}

/// The gates of a discovery: its verdict and the effects that it names.
pub fn of_discovery(gate: &Gate, d: &Discovery) -> Vec<Judged> {
    let end = d.explanation();
    let id = &end.comparison.scenario.id;
    let words = |key: &str, found: String, demanded: String, holds: bool| Judged {
        scenario: id.clone(),
        gate: key.into(),
        found,
        demanded,
        value: None,
        limit: None,
        holds,
    };
    let mut list = Vec::new();
    if let Some(verdict) = &gate.verdict {
        list.push(words("verdict", d.verdict.word().into(), verdict.clone(), verdict == d.verdict.word()));
    }
    if let Some(wanted) = &gate.effects {
        let sorted = |mut names: Vec<String>| {
            names.sort();
            names
        };
        let (found, wanted) = (sorted(end.hypothesis.effects()), sorted(wanted.clone()));
        let name = |names: &[String]| if names.is_empty() { "none".into() } else { names.join(", ") };
        list.push(words("effects", name(&found), name(&wanted), found == wanted));
    }
    list
}

/// The claims that a scenario demands, of the verdicts on them by id.
pub fn of_claims(gate: &Gate, id: &str, claims: &[(String, claims::Verdict)]) -> Vec<Judged> {
    let one = |wanted: &String| {
        let verdict = claims.iter().find(|(id, _)| id == wanted).map(|(_, verdict)| *verdict);
        let found = match verdict {
            Some(claims::Verdict::Reproduced) => "reproduced",
            Some(claims::Verdict::Caveat) => "reproduced with a caveat",
            Some(claims::Verdict::NotReproducible) => "not reproducible from the printed values",
            Some(claims::Verdict::Failed) => "failed",
            None => "not judged",
        };
        Judged {
            scenario: id.into(),
            gate: "claims".into(),
            found: format!("{wanted} {found}"),
            demanded: "reproduced".into(),
            value: None,
            limit: None,
            holds: matches!(verdict, Some(claims::Verdict::Reproduced | claims::Verdict::Caveat)),
        }
    };
    gate.claims.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::Verdict;
    use crate::scenario::parameters::VERDICTS;

    #[test]
    fn a_scenario_may_demand_every_verdict() {
        let all = [Verdict::NothingMissing, Verdict::Recalibrate, Verdict::EffectMissing, Verdict::Unexplained];
        assert_eq!(all.map(Verdict::word).as_slice(), VERDICTS);
    }

    #[test]
    fn not_a_number_never_holds() {
        assert!(!largest("a", "b", f64::NAN, 1.0, digits).holds);
        let gate = largest("a", "b", 1.23456, 1.5, percent);
        assert!(gate.holds && gate.sentence() == "a: b: 123.5 %; demanded: at most 150 %", "{}", gate.sentence());
    }

    #[test]
    fn a_claim_that_nobody_judged_does_not_hold() {
        let gate = Gate { claims: vec!["x".into()], ..Gate::default() };
        assert!(!of_claims(&gate, "a", &[])[0].holds && !gate.needs_measurements());
    }
}
