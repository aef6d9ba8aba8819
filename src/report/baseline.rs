//! This run against an earlier one: what improved, what regressed, which inputs are others.

use super::anchor::Anchors;
use super::baseline_view::{BaselineView, ChangeView, ChangedInputView};
use super::format::{NONE, percent};
use super::summary::SECTIONS;
use super::values::{Value, values};
use super::verdict::{Change, Tone};
use super::view::{Quantity, ReportView, ScenarioView};
use std::collections::BTreeMap;

/// Relative differences up to this count as none: above what solvers leave, below what matters.
pub const TOLERANCE: f64 = 1e-3;
/// Keys told of one input.
const KEYS: usize = 12;

/// What differs between an earlier report, found at `path`, and this one; curves and pictures are added by the caller.
pub fn baseline(before: &ReportView, after: &ReportView, path: &str) -> BaselineView {
    let (old, new) = (by_name(before), by_name(after));
    let mut changes = Vec::new();
    for (name, value) in &new {
        match old.get(name) {
            Some(earlier) => changes.extend(change(earlier, value)),
            None => changes.push(lone(value, Change::New)),
        }
    }
    changes.extend(old.iter().filter(|(name, _)| !new.contains_key(*name)).map(|(_, value)| lone(value, Change::Gone)));
    changes.sort_by_key(|change| Change::ALL.iter().position(|verdict| *verdict == change.verdict));
    let same = new.len() + old.keys().filter(|name| !new.contains_key(*name)).count() - changes.len();
    let inputs = inputs(before, after);
    let sentence = sentence(&changes, same, &inputs);
    let p = &before.provenance;
    BaselineView {
        path: path.into(),
        generated: p.generated.clone(),
        program: format!("{} {}", p.program, p.version),
        sentence,
        notes: notes(before, after),
        changes,
        same,
        inputs,
        figures: Vec::new(),
        pictures: Vec::new(),
    }
}

impl ReportView {
    /// The report with what differs from an earlier one.
    pub fn with_baseline(mut self, baseline: Option<BaselineView>) -> Self {
        let mut anchors = Anchors::default();
        for section in SECTIONS {
            anchors.claim(section);
        }
        self.figures().iter().for_each(|figure| drop(anchors.claim(&figure.anchor)));
        self.baseline = baseline;
        for figure in self.baseline.iter_mut().flat_map(|baseline| &mut baseline.figures) {
            figure.anchor = anchors.claim(&figure.anchor);
        }
        self
    }
}

fn by_name(view: &ReportView) -> BTreeMap<(String, String), Value> {
    values(view).into_iter().map(|value| ((value.subject.clone(), value.what.clone()), value)).collect()
}

/// What became of a value; nothing where it is the same.
fn change(before: &Value, after: &Value) -> Option<ChangeView> {
    let (verdict, by) = match (before.shown.value, after.shown.value) {
        (Some(a), Some(b)) => {
            let relative = (b - a) / a.abs().max(b.abs());
            // Both zero are the same.
            if relative.is_nan() || relative.abs() <= TOLERANCE {
                return None;
            }
            let verdict = match after.falls {
                Some(falls) if falls == (b < a) => Change::Improved,
                Some(_) => Change::Regressed,
                None => Change::Changed,
            };
            let by = if a == 0.0 { String::new() } else { signed((b - a) / a.abs()) };
            (verdict, by)
        }
        _ if before.shown.text == after.shown.text => return None,
        _ => {
            let tone = |value: &Value| value.tone.unwrap_or(Tone::Open);
            let verdict = match tone(after).cmp(&tone(before)) {
                _ if before.tone.is_none() || after.tone.is_none() => Change::Changed,
                std::cmp::Ordering::Less => Change::Improved,
                std::cmp::Ordering::Greater => Change::Regressed,
                std::cmp::Ordering::Equal => Change::Changed,
            };
            (verdict, String::new())
        }
    };
    let (before, shown) = (before.shown.clone(), after.shown.clone());
    Some(ChangeView { before, after: shown, by, ..lone(after, verdict) })
}

fn lone(value: &Value, verdict: Change) -> ChangeView {
    let none = Quantity { value: None, text: NONE.into() };
    let (before, after) =
        if verdict == Change::Gone { (value.shown.clone(), none) } else { (none, value.shown.clone()) };
    // What is gone has no place in this report.
    let anchor = if verdict == Change::Gone { "baseline".into() } else { value.anchor.clone() };
    let (subject, what) = (value.subject.clone(), value.what.clone());
    ChangeView { verdict, subject, what, before, after, by: String::new(), anchor }
}

/// A relative difference with its sign.
pub(super) fn signed(relative: f64) -> String {
    let sign = if relative < 0.0 { "−" } else { "+" };
    format!("{sign}{}", percent(relative.abs(), 2))
}

fn sentence(changes: &[ChangeView], same: usize, inputs: &[ChangedInputView]) -> String {
    let count = |verdict: Change| changes.iter().filter(|change| change.verdict == verdict).count();
    let told = Change::ALL.map(|verdict| (count(verdict), verdict.words()));
    let mut parts: Vec<String> =
        told.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}")).collect();
    parts.push(format!("{same} the same"));
    let inputs = match inputs.len() {
        0 => "The inputs are the same".into(),
        1 => "One input differs".into(),
        n => format!("{n} inputs are others"),
    };
    format!("Of values and verdicts: {}. {inputs}.", parts.join(", "))
}

fn notes(before: &ReportView, after: &ReportView) -> Vec<String> {
    let (old, new) = (&before.provenance, &after.provenance);
    let mut notes = Vec::new();
    if old.comparator != new.comparator {
        notes.push(format!(
            "The comparison with measurements is of version {}, before {}: the same input may give other numbers.",
            new.comparator, old.comparator
        ));
    }
    if old.version != new.version {
        notes.push(format!("Made by version {} of the program, before {}.", new.version, old.version));
    }
    notes
}

/// Scenarios and tables with other hashes, or that only one of the runs has.
fn inputs(before: &ReportView, after: &ReportView) -> Vec<ChangedInputView> {
    let list = |view: &ReportView| -> BTreeMap<String, (String, String)> {
        view.provenance.inputs.iter().map(|i| (i.id.clone(), (i.path.clone(), i.hash.clone()))).collect()
    };
    let (old, new) = (list(before), list(after));
    let mut ids: Vec<&String> = old.keys().chain(new.keys()).collect();
    ids.sort();
    ids.dedup();
    let one = |id: &String| {
        let (a, b) = (old.get(id), new.get(id));
        let hash = |input: Option<&(String, String)>| input.map(|(_, hash)| hash.clone()).unwrap_or_default();
        if hash(a) == hash(b) {
            return None;
        }
        let path = b.or(a).map(|(path, _)| path.clone()).unwrap_or_default();
        let of = |view: &'_ ReportView| view.scenarios.iter().find(|scenario| scenario.id == *id).cloned();
        let keys = of(before).zip(of(after)).map(|(a, b)| keys(&a, &b)).unwrap_or_default();
        Some(ChangedInputView { id: id.clone(), path, before: hash(a), after: hash(b), keys })
    };
    ids.into_iter().filter_map(one).collect()
}

/// Keys of a scenario with other values.
fn keys(before: &ScenarioView, after: &ScenarioView) -> Vec<String> {
    let list = |view: &ScenarioView| -> BTreeMap<String, String> {
        view.parameters.iter().map(|p| (p.key.clone(), p.value.clone())).collect()
    };
    let (old, new) = (list(before), list(after));
    let show = |value: Option<&String>| value.map_or("absent".into(), Clone::clone);
    let mut keys: Vec<&String> = old.keys().chain(new.keys()).filter(|key| old.get(*key) != new.get(*key)).collect();
    keys.sort();
    keys.dedup();
    let more = keys.len().saturating_sub(KEYS);
    let line = |key: &&String| format!("{key}: {} → {}", show(old.get(*key)), show(new.get(*key)));
    let mut lines: Vec<String> = keys.iter().take(KEYS).map(line).collect();
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    lines
}
