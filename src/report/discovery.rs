//! Which effect is missing: the part of a scenario's section that a discovery fills.

use super::anchor;
use super::comparison::{fitted, none, outlier, shown, tie};
use super::discovery_view::{
    CandidateView, DiscoveryView, FallPartView, FallView, NextView, NotTestableView, StepView,
};
use super::format::{quantity, setting};
use super::scenario::{FigureInput, figure};
use super::verdict::Found;
use super::view::{FigureView, Quantity, ScenarioView};
use crate::compare::{Comparison, outlier_words};
use crate::discover::{
    self, Addition, Candidate, Discovery, Fall, NextMeasurement, NotTestable, Part, STRENGTHS, Step, Verdict,
    identified,
};
use crate::fit::{Identified, Interval, Parameter, parameter, values_in};
use crate::scenario::parameters::of_key;
use crate::units::Frequencies;

/// Figures shown at once; the others are folded.
const FIRST: [&str; 5] = ["before-after", "ladder", "ladder-overlay", "fingerprint-before-after", "ranking"];
/// Candidates, ranges of misfit and outliers listed.
const CANDIDATES: usize = 12;
const REGIONS: usize = 8;
const OUTLIERS: usize = 24;
/// Most numbers of an explanation that its head tells.
const AMOUNTS: usize = 4;

impl ScenarioView {
    /// The section with a discovery in it.
    pub fn with_discovery(mut self, d: &Discovery, figures: &[FigureInput]) -> Self {
        self.discovery = Some(discovery_view(d, figures));
        self
    }
}

/// The view of a discovery.
pub fn discovery_view(d: &Discovery, figures: &[FigureInput]) -> DiscoveryView {
    let end = d.explanation();
    let c = &end.comparison;
    let id = &c.scenario.id;
    let arm = end.hypothesis.model.rig.is_arm();
    let views: Vec<FigureView> = figures.iter().map(|input| figure(id, input)).collect();
    let (first, more) = views.into_iter().partition(|view| FIRST.contains(&view.name.as_str()));
    let words = |(p, i)| super::view::FittedView { meaning: identified(p, i).into(), ..fitted(p, i) };
    let leading = d.leading(CANDIDATES, |_| true);
    DiscoveryView {
        anchor: anchor::discovery(id),
        verdict: Found::of(d.verdict),
        sentence: capital(&discover::sentence(d)),
        meanings: end.hypothesis.additions.iter().map(|addition| meaning(addition, arm)).collect(),
        sure: capital(&discover::how_sure(d)),
        amounts: amounts(d),
        story: story(d),
        added: if end.hypothesis.additions.is_empty() { String::new() } else { end.hypothesis.label() },
        titles: end.hypothesis.additions.iter().map(|addition| addition.title(arm)).collect(),
        before: shown(d.steps[0].comparison.overall.chi2_per_point, "1", 3),
        after: shown(c.overall.chi2_per_point, "1", 3),
        steps: d.steps.iter().map(step).collect(),
        parameters: c.fit.parameters.iter().zip(&c.intervals).map(words).collect(),
        ties: d.correlations.iter().map(tie).collect(),
        candidates: leading.iter().map(|c| candidate(c, end.comparison.table.points.len())).collect(),
        more_candidates: d.candidates.len() - leading.len(),
        indistinguishable: d.indistinguishable.iter().map(|group| group.join(", ")).collect(),
        not_testable: d.not_testable.iter().map(not_testable).collect(),
        outliers: d.outliers.iter().take(OUTLIERS).map(outlier).collect(),
        more_outliers: d.outliers.len().saturating_sub(OUTLIERS),
        next: d.next_worth().map(|n| next(n, &end.comparison)),
        notes: d.notes.clone(),
        regions: c.regions.iter().take(REGIONS).map(|region| region.sentence.clone()).collect(),
        more_regions: c.regions.len().saturating_sub(REGIONS),
        contact: contact(d),
        fall: d.fall().map(fall),
        figures: first,
        more,
    }
}

/// What is added, in a sentence: its title, and of an effect the first sentence of what it is physically.
fn meaning(addition: &Addition, arm: bool) -> String {
    let what = format!("{}: {}.", addition.name(), addition.title(arm));
    match addition {
        Addition::Recalibration(_) => what,
        Addition::Effect(effect) => {
            let first = effect.meaning().split_inclusive(". ").next().unwrap_or_default();
            format!("{what} {}", first.trim_end())
        }
    }
}

/// Numbers of what was added, with their intervals; of a recalibrated number what was stated. Nothing where there are
/// too many to be read at once, and where what is left contradicts the model that intervals rest on.
fn amounts(d: &Discovery) -> Vec<String> {
    let end = d.explanation();
    let (c, base) = (&end.comparison, &d.steps[0].hypothesis.model);
    let keys: Vec<String> = end.hypothesis.additions.iter().flat_map(Addition::keys).collect();
    let added = c.fit.parameters.iter().zip(&c.intervals).filter(|(p, _)| keys.contains(&p.key));
    let one = end.hypothesis.effects().len() == 1;
    let line = |(p, interval): (&Parameter, &Interval)| {
        let view = fitted(p, interval);
        let name = called(p, one, base.rig.is_arm());
        match interval.identified {
            Identified::Yes => {}
            Identified::OneSided => return format!("{name} = {}, {}", view.value.text, identified(p, interval)),
            Identified::No => return format!("{name} is not determined"),
        }
        let stated = parameter(base, &p.key).filter(|_| !p.key.starts_with("effect."));
        let stated = stated.and_then(|p| values_in(base, &[p]).pop());
        let stated = stated.map_or(String::new(), |value| format!("; stated {}", quantity(value, p.unit, 4)));
        format!("{name} = {} (95 %: {}{stated})", view.value.text, range(&view.low.text, &view.high.text))
    };
    let lines: Vec<String> = added.map(line).collect();
    if lines.len() > AMOUNTS || d.verdict == Verdict::Unexplained { Vec::new() } else { lines }
}

/// What a number is called in running text: of `one` effect by its symbol alone, of a torsional `arm` or an oscillator by
/// what it is.
fn called(p: &Parameter, one: bool, arm: bool) -> String {
    let Some((effect, key)) = p.key.strip_prefix("effect.").and_then(|key| key.rsplit_once('.')) else {
        return of_key(&p.key, arm).map_or(&*p.key, |info| info.meaning).into();
    };
    let symbol = if p.symbol.is_empty() { key } else { p.symbol };
    if one { symbol.into() } else { format!("{symbol} of {effect}") }
}

/// From one value to another, a unit that both have said once.
fn range(low: &str, high: &str) -> String {
    let unit = |text: &str| text.split_once(' ').map(|(_, unit)| unit.to_string());
    match low.split_once(' ') {
        Some((number, _)) if unit(low) == unit(high) => format!("{number} to {high}"),
        _ => format!("{low} to {high}"),
    }
}

fn fall(fall: &Fall) -> FallView {
    let part = |part: &Part| {
        let finite = |value: f64| Some(value).filter(|v| v.is_finite());
        let names = fall.additions.iter().zip(&part.members).filter(|(_, is)| **is);
        FallPartView {
            additions: names.map(|(name, _)| name.clone()).collect(),
            chi2_per_point: part.states.iter().map(|state| finite(state.chi2_per_point)).collect(),
            rms_error_percent: part.states.iter().map(|state| finite(state.rms_error_percent)).collect(),
        }
    };
    FallView {
        additions: fall.additions.clone(),
        strengths: (0..STRENGTHS).map(|k| k as f64 / (STRENGTHS - 1) as f64).collect(),
        parts: fall.parts.iter().map(part).collect(),
    }
}

/// What happened, in a few sentences with numbers.
fn story(d: &Discovery) -> Vec<String> {
    let (base, end) = (&d.steps[0], d.explanation());
    let (before, after) = (&base.comparison.overall, &end.comparison.overall);
    let number = |value: f64| quantity(value, "1", 3);
    let percent = |value: f64| quantity(value, "%", 3);
    let mut lines = vec![format!(
        "The calibrated model leaves χ² = {} per reading, and an error of {} in the amplitude where the noise is {}.",
        number(before.chi2_per_point),
        percent(before.rms_error_percent),
        quantity(before.noise_percent, "%", 2)
    )];
    if d.verdict == Verdict::NothingMissing {
        let tried = d.candidates.len().saturating_sub(1);
        lines.push(format!("None of {tried} candidates improves on that by more than the penalty for its parameters."));
    } else if !end.hypothesis.additions.is_empty() {
        lines.push(format!(
            "With {} it comes to χ² = {} and an error of {}.",
            end.hypothesis.label(),
            number(after.chi2_per_point),
            percent(after.rms_error_percent)
        ));
    }
    if let Some(without) = end.comparison.chi2_without_outliers() {
        let outliers = outlier_words(end.comparison.outliers.len());
        lines.push(format!("Without {outliers} of it, χ² = {}.", number(without)));
    }
    if let Some(held_out) = end.held_out {
        lines.push(format!(
            "Each condition predicted by a fit to all others: error {}, χ² = {} per reading.",
            percent(held_out.rms_percent),
            number(held_out.chi2_per_point)
        ));
    }
    lines
}

/// What is known of something unknown.
fn contact(d: &Discovery) -> String {
    let points = d.explanation().comparison.contact.len();
    if d.verdict != Verdict::Unexplained || points == 0 {
        return String::new();
    }
    if !d.explanation().comparison.model.has_contact {
        return format!(
            "What is known of the unknown: the stiffness and damping that the missing force must have had at {points} readings, from \
             the readings and the linear rig alone. They are in the figures of the missing force above and in their CSV, whatever \
             law they follow."
        );
    }
    format!(
        "What is known of the unknown: the stiffness and damping that the contact must have had at {points} readings, from the \
         readings and the rig alone. They are in the figure of the contact above and in its CSV, whatever law they follow."
    )
}

fn step(step: &Step) -> StepView {
    let m = &step.comparison.overall;
    StepView {
        name: step.name(),
        chi2: shown(m.chi2_per_point, "1", 3),
        error: shown(m.rms_error_percent, "%", 3),
        noise: shown(m.noise_percent, "%", 2),
        held_out: left_out(step.held_out),
        phase_error: m.rms_phase_deg.map_or(none(), |value| shown(value, "°", 3)),
        regions: step.comparison.regions.len(),
    }
}

fn left_out(held_out: Option<discover::HeldOut>) -> Quantity {
    held_out.map_or(none(), |h| shown(h.rms_percent, "%", 3))
}

fn candidate(c: &Candidate, points: usize) -> CandidateView {
    let small = Quantity { value: Some(c.weight), text: "< 0.001".into() };
    CandidateView {
        name: c.hypothesis.label(),
        delta_bic: shown(c.delta_bic, "1", 3),
        weight: if c.weight < 1e-3 { small } else { shown(c.weight, "1", 2) },
        chi2: shown(c.chi2_per_point, "1", 3),
        held_out: left_out(c.held_out),
        testable: if c.testable { "yes" } else { "no" }.into(),
        basis: c.hypothesis.basis().words(points),
    }
}

fn not_testable(n: &NotTestable) -> NotTestableView {
    let nowhere = "would not show within the ranges of these readings either";
    NotTestableView {
        effect: n.effect.clone(),
        largest: shown(n.largest_sigma, "σ", 2),
        would_show: if n.would_show.is_empty() { nowhere.into() } else { format!("would show {}", n.would_show) },
    }
}

fn next(n: &NextMeasurement, c: &Comparison) -> NextView {
    let meaning = n.meaning();
    let of_contact = |value: f64, unit: &str| if n.setting.contact { rounded(value, unit) } else { none() };
    NextView {
        speed: of_contact(n.setting.speed, "m/s"),
        load: of_contact(n.setting.load, "N"),
        drive: rounded(n.setting.drive, n.setting.signal.unit),
        frequency: if c.table.signals.of_arm() {
            rounded(n.frequency_hz, "Hz")
        } else {
            let digits = Frequencies::of(c.table.points.iter().map(|p| p.frequency));
            Quantity { value: Some(n.frequency_hz), text: digits.show(n.frequency_hz) }
        },
        separates: n.separates.to_vec(),
        sigma: shown(n.sigma, "σ", 2),
        meaning,
    }
}

/// A setting as one would dial it: three digits.
fn rounded(value: f64, unit: &str) -> Quantity {
    let near = format!("{value:.2e}").parse().unwrap_or(value);
    Quantity { value: Some(value).filter(|v| v.is_finite()), ..setting(near, unit) }
}

/// The sentence with a capital letter and a full stop.
fn capital(sentence: &str) -> String {
    let mut chars = sentence.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).chain(['.']).collect())
}
