//! The values and verdicts by which two runs are compared, and the record of a run in a history.

use super::verdict::Tone;
use super::view::{CurveView, Quantity, ReportView, ScenarioView};
use crate::history::{Record, SCHEMA};
use std::collections::BTreeMap;

/// A number or a verdict of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// Scenario, claim or check.
    pub subject: String,
    /// Which of its values; unique with the subject.
    pub what: String,
    /// As the report shows it.
    pub shown: Quantity,
    /// Whether less is better; `None` where neither is.
    pub falls: Option<bool>,
    /// How it is to be read, where it is a verdict.
    pub tone: Option<Tone>,
    /// Where the report treats it.
    pub anchor: String,
}

impl Value {
    fn verdict(subject: &str, what: &str, words: &str, anchor: &str) -> Self {
        Self {
            subject: subject.into(),
            what: what.into(),
            shown: Quantity { value: None, text: words.into() },
            falls: None,
            tone: Some(Tone::of(words)),
            anchor: anchor.into(),
        }
    }

    fn number(subject: &str, what: &str, shown: &Quantity, falls: Option<bool>, anchor: &str) -> Self {
        let (subject, what, anchor) = (subject.into(), what.into(), anchor.into());
        Self { subject, what, shown: shown.clone(), falls, tone: None, anchor }
    }
}

/// What two runs are compared by: errors, peaks, verdicts, gates; no times.
pub fn values(view: &ReportView) -> Vec<Value> {
    let of_gate = |g: &super::GateView| {
        Value::verdict(&g.scenario, &format!("gate {}", gate_name(g)), g.verdict.words(), &g.anchor)
    };
    let of_claim = |c: &super::ClaimView| Value::verdict(&c.id, "claim", c.verdict.words(), &c.anchor);
    let of_check = |c: &super::CheckView| Value::verdict(&c.name, "check", c.verdict.words(), &c.anchor);
    // Whether something is worse than before is no value of the run itself.
    let gates = view.gates.iter().filter(|gate| gate.gate != "no_regression").map(of_gate);
    let claims = view.claims.iter().map(of_claim);
    let checks = view.verification.iter().map(of_check);
    gates.chain(view.scenarios.iter().flat_map(of_scenario)).chain(claims).chain(checks).collect()
}

/// A gate with the claim where there may be several.
fn gate_name(gate: &super::GateView) -> String {
    match (gate.gate.as_str(), gate.found.text.split_whitespace().next()) {
        ("claims", Some(claim)) => format!("claims: {claim}"),
        (name, _) => name.into(),
    }
}

fn of_scenario(s: &ScenarioView) -> Vec<Value> {
    let mut list = vec![Value::verdict(&s.id, "steady states", s.status.words(), &s.anchor)];
    if let Some(c) = &s.comparison {
        list.push(Value::verdict(&s.id, "comparison", c.verdict.words(), &c.anchor));
        let number = |what: &str, shown: &Quantity| Value::number(&s.id, what, shown, Some(true), &c.anchor);
        list.extend([
            number("χ² per reading, calibrated", &c.overall.chi2),
            number("rms error of the amplitude, calibrated", &c.overall.error),
            number("rms error of the phase, calibrated", &c.overall.phase_error),
        ]);
    }
    if let Some(d) = &s.discovery {
        list.push(Value::verdict(&s.id, "discovery", d.verdict.words(), &d.anchor));
        let effects = if d.added.is_empty() { "nothing" } else { &d.added };
        let added = Value::verdict(&s.id, "added by the explanation", effects, &d.anchor);
        list.push(Value { tone: None, ..added });
        list.push(Value::number(&s.id, "χ² per reading, explained", &d.after, Some(true), &d.anchor));
        for parameter in &d.parameters {
            let what = format!("{}, explained", parameter.key);
            list.push(Value::number(&s.id, &what, &parameter.value, None, &d.anchor));
        }
        if let Some(step) = d.steps.last() {
            let what = "rms error of the amplitude, explained";
            list.push(Value::number(&s.id, what, &step.error, Some(true), &d.anchor));
        }
    }
    for (name, curve) in curves(s) {
        let named = |what: &str| if name.is_empty() { what.to_string() } else { format!("{what}, {name}") };
        for (what, shown) in [("peak frequency", &curve.peak_frequency), ("peak amplitude", &curve.peak_amplitude)] {
            if shown.value.is_some() {
                list.push(Value::number(&s.id, &named(what), shown, None, &s.anchor));
            }
        }
    }
    list
}

/// Every curve with what distinguishes it from the others of its scenario.
fn curves(s: &ScenarioView) -> impl Iterator<Item = (String, &CurveView)> {
    let symbol =
        |key: &str| s.axes.iter().find(|axis| axis.key == key).map_or(String::new(), |axis| axis.symbol.clone());
    let label = move |curve: &CurveView| {
        let setting = |key: &str| match key {
            "formulation" => curve.formulation.text.clone(),
            "euler_steps" => format!("{} steps", curve.euler_steps.text),
            "drive" => format!("{} = {}", symbol(key), curve.drive.text),
            "load" => format!("W = {}", curve.load.text),
            "friction" => format!("μ = {}", curve.friction.text),
            _ => format!("V = {}", curve.speed.text),
        };
        let free = s.axes.iter().filter(|axis| axis.fixed.is_none());
        free.map(|axis| setting(&axis.key)).collect::<Vec<_>>().join(", ")
    };
    s.curves.iter().map(move |curve| (label(curve), curve))
}

impl ReportView {
    /// The record of this run in a history; `seconds` are its wall times.
    pub fn record(&self, seconds: BTreeMap<String, f64>) -> Record {
        let p = &self.provenance;
        let mut hasher = blake3::Hasher::new();
        for input in &p.inputs {
            hasher.update(format!("{}\n{}\n", input.id, input.hash).as_bytes());
        }
        let mut record = Record {
            schema: SCHEMA.into(),
            time: p.generated.clone(),
            program: format!("{} {}", p.program, p.version),
            comparator: p.comparator.clone(),
            inputs: hasher.finalize().to_hex().to_string(),
            misfits: BTreeMap::new(),
            errors: BTreeMap::new(),
            peaks: BTreeMap::new(),
            seconds,
        };
        for s in &self.scenarios {
            let put = |map: &mut BTreeMap<String, f64>, what: &str, shown: &Quantity| {
                map.extend(shown.value.map(|value| (format!("{}: {what}", s.id), value)));
            };
            if let Some(c) = &s.comparison {
                put(&mut record.misfits, "calibrated", &c.overall.chi2);
                put(&mut record.errors, "calibrated", &c.overall.error);
            }
            if let Some(d) = &s.discovery {
                put(&mut record.misfits, "explained", &d.after);
                put(
                    &mut record.errors,
                    "explained",
                    &d.steps.last().map(|step| step.error.clone()).unwrap_or_default(),
                );
            }
            for (name, curve) in curves(s) {
                put(&mut record.peaks, if name.is_empty() { "peak" } else { &name }, &curve.peak_frequency);
            }
        }
        record
    }
}
