//! A report read back from its JSON, so that the page can be made again without simulating.

use super::anchor;
use super::view::{FigureView, ReportView, SCHEMA, ScenarioView};
use serde_json::Value;
use std::path::{Component, Path};

/// The view of a `report.json`; whoever changed it, nothing in it can lead out of its folder or into the page's script.
///
/// # Errors
/// What is wrong with it, and what to do.
pub fn read(text: &str) -> Result<ReportView, (String, &'static str)> {
    let value: Value =
        serde_json::from_str(text).map_err(|why| (format!("is not JSON: {why}"), "name a report.json"))?;
    let schema = value.get("schema").and_then(Value::as_str).unwrap_or_default();
    if schema != SCHEMA {
        let found = if schema.is_empty() { "no schema".into() } else { format!("the schema `{}`", short(schema)) };
        return Err((format!("has {found}, not `{SCHEMA}`"), "name the report.json of this version of the program"));
    }
    let mut view: ReportView = serde_json::from_value(value)
        .map_err(|why| (format!("is not a whole report: {why}"), "make it again with `stickslip report`"))?;
    for figure in figures(&mut view) {
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if figure.anchor.is_empty() || !figure.anchor.chars().all(plain) {
            let help = "it was changed by hand; make it again with `stickslip report`";
            return Err((format!("names a figure by the id `{}`", short(&figure.anchor)), help));
        }
        for file in &mut figure.files {
            file.href = link(&file.name)?;
        }
    }
    for picture in view.baseline.iter_mut().flat_map(|baseline| &mut baseline.pictures) {
        picture.href = link(&picture.before)?;
    }
    Ok(view)
}

/// The link to a file beside the report.
fn link(name: &str) -> Result<String, (String, &'static str)> {
    let inside = |part: Component<'_>| matches!(part, Component::Normal(_));
    if !Path::new(name).components().all(inside) || name.contains('\\') {
        let help = "it was changed by hand; make it again with `stickslip report`";
        return Err((format!("names a file outside its folder: `{}`", short(name)), help));
    }
    Ok(anchor::href(name))
}

/// Every figure of a report.
pub fn figures(view: &mut ReportView) -> impl Iterator<Item = &mut FigureView> {
    let of_scenarios = view.scenarios.iter_mut().flat_map(ScenarioView::figures_mut);
    let of_baseline = view.baseline.iter_mut().flat_map(|baseline| &mut baseline.figures);
    let of_history = view.history.iter_mut().flat_map(|history| &mut history.figures);
    let of_runs = of_baseline.chain(of_history).chain(&mut view.provenance.times);
    let of_trust = view.trust.iter_mut().flat_map(|trust| &mut trust.figures);
    of_scenarios.chain(view.atlas.iter_mut().map(|effect| &mut effect.figure)).chain(of_trust).chain(of_runs)
}

impl ScenarioView {
    /// Every figure of the section.
    pub fn figures_mut(&mut self) -> impl Iterator<Item = &mut FigureView> {
        let compared = self.comparison.iter_mut().flat_map(|c| c.figures.iter_mut().chain(&mut c.more));
        let discovered = self.discovery.iter_mut().flat_map(|d| d.figures.iter_mut().chain(&mut d.more));
        let discovered = discovered.chain(self.free_form.iter_mut().flat_map(|free_form| &mut free_form.figures));
        let asked = self.question.iter_mut().flat_map(|question| &mut question.figures);
        self.figures.iter_mut().chain(compared).chain(discovered).chain(asked)
    }
}

fn short(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(60).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_report_is_refused_with_a_reason() {
        for (text, reason) in [
            ("", "is not JSON"),
            ("[]", "no schema"),
            ("{\"schema\": 3}", "no schema"),
            ("{\"schema\": \"stickslip.comparison/1\"}", "stickslip.comparison/1"),
            ("{\"schema\": \"stickslip.report/1\"}", "missing field"),
        ] {
            let (why, help) = read(text).unwrap_err();
            assert!(why.contains(reason) && !help.is_empty(), "{why}");
        }
    }
}
