//! From the view to bytes: one self-contained HTML file, or JSON.

use std::collections::BTreeMap;
use std::sync::Arc;

use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Serde, Value};
use minijinja::{AutoEscape, Environment, UndefinedBehavior, context};

use super::anchor;
use super::glossary::Links;
use super::verdict::Tone;
use super::view::{FigureView, ReportView, SymbolView};
use super::{glossary, mathml, packed, svg};
use rayon::prelude::*;

/// The style sheet and the scripts, which go into the page as they are.
const STYLE: &str = include_str!("../../templates/report.css");
const SCRIPT: &str = concat!(
    include_str!("../../templates/common.js"),
    include_str!("../../templates/figures.js"),
    include_str!("../../templates/page.js")
);

/// Name in the environment and text of every template; all are escaped automatically.
const TEMPLATES: &[(&str, &str)] = &[
    ("page.html.j2", include_str!("../../templates/page.html.j2")),
    ("report.html.j2", include_str!("../../templates/report.html.j2")),
    ("trials.html.j2", include_str!("../../templates/trials.html.j2")),
    ("checks.html.j2", include_str!("../../templates/checks.html.j2")),
    ("macros.html.j2", include_str!("../../templates/partials/macros.html.j2")),
    ("summary.html.j2", include_str!("../../templates/partials/summary.html.j2")),
    ("gates.html.j2", include_str!("../../templates/partials/gates.html.j2")),
    ("baseline.html.j2", include_str!("../../templates/partials/baseline.html.j2")),
    ("history.html.j2", include_str!("../../templates/partials/history.html.j2")),
    ("claims.html.j2", include_str!("../../templates/partials/claims.html.j2")),
    ("headline.html.j2", include_str!("../../templates/partials/headline.html.j2")),
    ("measured.html.j2", include_str!("../../templates/partials/measured.html.j2")),
    ("simulated.html.j2", include_str!("../../templates/partials/simulated.html.j2")),
    ("run.html.j2", include_str!("../../templates/partials/run.html.j2")),
    ("sweep.html.j2", include_str!("../../templates/partials/sweep.html.j2")),
    ("comparison.html.j2", include_str!("../../templates/partials/comparison.html.j2")),
    ("discovery.html.j2", include_str!("../../templates/partials/discovery.html.j2")),
    ("free_form.html.j2", include_str!("../../templates/partials/free_form.html.j2")),
    ("question.html.j2", include_str!("../../templates/partials/question.html.j2")),
    ("figure.html.j2", include_str!("../../templates/partials/figure.html.j2")),
    ("atlas.html.j2", include_str!("../../templates/partials/atlas.html.j2")),
    ("trust.html.j2", include_str!("../../templates/partials/trust.html.j2")),
    ("verification.html.j2", include_str!("../../templates/partials/verification.html.j2")),
    ("symbols.html.j2", include_str!("../../templates/partials/symbols.html.j2")),
    ("provenance.html.j2", include_str!("../../templates/partials/provenance.html.j2")),
];

/// The report could not be written down. Either is a fault of the program, not of its input.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// A template asks for something that the view does not have.
    #[error("the report's template does not fit its data: {0:#}")]
    Template(#[from] minijinja::Error),
    /// The view cannot be written as JSON.
    #[error("the report cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// A page of a report: name of its file, name of its template.
type Page = (&'static str, &'static str);
const MAIN: Page = ("report.html", "report.html.j2");
const TRIALS: Page = ("trials.html", "trials.html.j2");
const CHECKS: Page = ("checks.html", "checks.html.j2");
/// Names of the files that the pages of a report have.
pub const PAGES: [&str; 3] = [MAIN.0, TRIALS.0, CHECKS.0];

/// The main page.
pub fn render(view: &ReportView) -> Result<String, RenderError> {
    page(view, MAIN.1, (&view.figures_of_page(), &view.glossary))
}

/// Every page but the main one, with the names of their files: the trials and the checks, where there are any.
pub fn others(view: &ReportView) -> Result<Vec<(&'static str, String)>, RenderError> {
    let trials: Vec<&FigureView> = view.trust.iter().flat_map(|trust| &trust.figures).collect();
    let wanted = [(TRIALS, view.trust.is_some(), trials), (CHECKS, !view.verification.is_empty(), Vec::new())];
    let wanted = wanted.into_iter().filter(|(_, there, _)| *there);
    wanted.map(|((file, template), _, figures)| Ok((file, page(view, template, (&figures, &[]))?))).collect()
}

/// A page with these figures, and with these symbols that texts lead to.
fn page(
    view: &ReportView,
    template: &str,
    (figures, symbols): (&[&FigureView], &[SymbolView]),
) -> Result<String, RenderError> {
    let inline = |svg: &str, prefix: String| Value::from_safe_string(svg::inline(svg, &prefix).unwrap_or_default());
    let drawing = |figure: &FigureView| {
        let narrow = figure.narrow.as_ref().map(|svg| inline(svg, format!("{}--narrow--", figure.anchor)));
        let wide = inline(&figure.svg, format!("{}--", figure.anchor));
        (figure.anchor.clone(), BTreeMap::from([("wide", wide), ("narrow", narrow.unwrap_or_else(|| Value::from("")))]))
    };
    let table = |figure: &FigureView| (figure.anchor.clone(), packed::packed(&figure.csv));
    let drawings: BTreeMap<String, BTreeMap<&str, Value>> = figures.par_iter().map(|figure| drawing(figure)).collect();
    let tables: BTreeMap<String, String> = figures.par_iter().map(|figure| table(figure)).collect();
    let environment = environment(symbols)?;
    let page = environment.get_template(template)?;
    let pictures = view.baseline.iter().flat_map(|baseline| &baseline.pictures);
    let earlier: BTreeMap<&str, String> = pictures.map(|p| (p.before.as_str(), packed::packed(&p.svg))).collect();
    let policy = format!(
        "default-src 'none'; script-src {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'",
        packed::source(SCRIPT),
        packed::source(STYLE)
    );
    let [style, script] = [STYLE, SCRIPT].map(|text| Value::from_safe_string(text.into()));
    let report = Value::from(Serde(view));
    Ok(page.render(context! { report, drawings, tables, earlier, policy, style, script })?)
}

/// The same view as JSON: indented, keys in the order of the types, a line feed at the end.
pub fn json(view: &ReportView) -> Result<String, RenderError> {
    Ok(serde_json::to_string_pretty(view)? + "\n")
}

impl ReportView {
    /// Every figure.
    pub fn figures(&self) -> Vec<&FigureView> {
        let of_trust = self.trust.iter().flat_map(|trust| &trust.figures);
        self.figures_of_page().into_iter().chain(of_trust).collect()
    }

    /// Every figure of the main page.
    fn figures_of_page(&self) -> Vec<&FigureView> {
        let of_scenarios = self.scenarios.iter().flat_map(|scenario| &scenario.figures);
        let comparisons = self.scenarios.iter().filter_map(|scenario| scenario.comparison.as_ref());
        let of_comparisons = comparisons.flat_map(|comparison| comparison.figures.iter().chain(&comparison.more));
        let discoveries = self.scenarios.iter().filter_map(|scenario| scenario.discovery.as_ref());
        let of_discoveries = discoveries.flat_map(|discovery| discovery.figures.iter().chain(&discovery.more));
        let of_free_forms = self.scenarios.iter().filter_map(|scenario| scenario.free_form.as_ref());
        let of_discoveries = of_discoveries.chain(of_free_forms.flat_map(|free_form| &free_form.figures));
        let questions = self.scenarios.iter().filter_map(|scenario| scenario.question.as_ref());
        let of_questions = questions.flat_map(|question| &question.figures);
        let of_effects = self.atlas.iter().map(|effect| &effect.figure);
        let of_baseline = self.baseline.iter().flat_map(|baseline| &baseline.figures);
        let of_history = self.history.iter().flat_map(|history| &history.figures).chain(&self.provenance.times);
        let of_input = of_scenarios.chain(of_comparisons).chain(of_discoveries).chain(of_questions).chain(of_effects);
        of_input.chain(of_baseline).chain(of_history).collect()
    }
}

fn environment(symbols: &[SymbolView]) -> Result<Environment<'static>, minijinja::Error> {
    let links = Arc::new(Links::to(symbols));
    let (of_symbol, of_text) = (Arc::clone(&links), links);
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.add_filter("tone", |verdict: &str| Tone::of(verdict).class());
    environment.add_filter("place", anchor::place);
    environment.add_filter("sign", |verdict: &str| Tone::of(verdict).symbol());
    environment.add_filter("symbol", move |text: &str| Value::from_safe_string(of_symbol.linked(text)));
    environment.add_filter("parameter", glossary::parameter);
    environment.add_filter("letters", |text: &str| Value::from_safe_string(glossary::set(text)));
    environment.add_filter("terms", move |text: &str| Value::from_safe_string(of_text.terms(text)));
    environment.add_filter("math", |text: &str| Value::from_safe_string(mathml::block(text)));
    environment.add_filter("raw", raw);
    for (name, text) in TEMPLATES {
        environment.add_template(name, text)?;
    }
    Ok(environment)
}

/// A number exactly as the JSON has it.
fn raw(number: f64) -> String {
    serde_json::to_string(&number).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_template_parses() {
        environment(&[]).unwrap();
    }
}
