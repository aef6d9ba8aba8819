//! A scenario's section of the report, from what its sweep gave and what was drawn of it.

use super::anchor;
use super::format::{NONE, computed, percent, setting};
use super::glossary::meaning;
use super::parameters::{formulation, parameters};
use super::verdict::Completeness;
use super::view::{AxisView, CurveView, FigureView, FileView, LimitView, NoteView, Quantity, ScenarioView};
use crate::effects::ParameterInfo;
use crate::scenario::{Coordinate, EffectSetting, Formulation, Scenario, Signals};
use crate::solver::{Status, SteadyState};
use crate::sweep::{Curve, LimitCurve, LimitingCase, Outcome};
use crate::units;

/// A drawing as it comes from the figures.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FigureInput {
    /// Name, unique in its scenario.
    pub name: String,
    /// Title.
    pub title: String,
    /// What it shows and what to look for.
    pub caption: String,
    /// The drawing in words.
    pub alt: String,
    /// The drawing.
    pub svg: String,
    /// The same for a narrow screen, where it has such a form.
    pub narrow: Option<String>,
    /// Labelled numbers.
    pub notes: Vec<(String, String)>,
    /// What is shown as a table.
    pub csv: String,
    /// What good looks like, what bad looks like, what to do.
    pub reading: [String; 3],
    /// Paths of its files relative to the report.
    pub files: Vec<String>,
}

/// Kind of a file with the drawing for a narrow screen.
const NARROW: &str = "narrow SVG";
/// How the name of such a file ends.
pub const NARROW_ENDING: &str = "-narrow.svg";
/// Frequencies from which on a list of them is a curve with a peak.
const CURVE: usize = 5;
/// How many reasons of points that are not steady a section shows.
const REASONS: usize = 4;

/// The section of one scenario.
pub fn scenario_view(outcome: &Outcome, figures: &[FigureInput]) -> ScenarioView {
    let scenario = &outcome.scenario;
    let states = || outcome.curves.iter().flat_map(|curve| &curve.states);
    let self_excited = states().filter(|state| matches!(state.status, Status::SelfExcited(_))).count();
    let failed = states().filter(|state| matches!(state.status, Status::Failed(_))).count();
    let points = states().count();
    let status = match (failed, self_excited) {
        (0, 0) => Completeness::Steady,
        (0, _) => Completeness::SelfExcited,
        _ => Completeness::Failed,
    };
    let curves: Vec<CurveView> = outcome.curves.iter().map(|one| curve(one, scenario)).collect();
    ScenarioView {
        id: scenario.id.clone(),
        anchor: anchor::scenario(&scenario.id),
        title: scenario.title.clone(),
        description: scenario.description.clone(),
        provenance: scenario.provenance.clone(),
        effects: scenario.effects.iter().map(|setting| effect(setting, scenario.rig.coordinate())).collect(),
        status,
        points,
        steady: points - self_excited - failed,
        self_excited,
        failed,
        reasons: reasons(states()),
        figures: figures.iter().map(|input| figure(&scenario.id, input)).collect(),
        parameters: parameters(scenario),
        axes: axes(&curves, &scenario.signals),
        curves,
        limits: outcome.limits.iter().map(limit).collect(),
        comparison: None,
        rig: super::rig::rig(scenario),
        discovery: None,
        free_form: None,
        question: None,
        path: scenario.path.display().to_string(),
        hash: scenario.hash.clone(),
    }
}

/// A figure of the section `scenario_id`.
pub(super) fn figure(scenario_id: &str, input: &FigureInput) -> FigureView {
    let anchor = anchor::figure(scenario_id, &input.name);
    let file = |name: &String| FileView {
        name: name.clone(),
        href: anchor::href(name),
        kind: match name.rsplit_once('.') {
            Some(_) if name.ends_with(NARROW_ENDING) => NARROW.into(),
            Some((_, extension)) => extension.to_ascii_uppercase(),
            None => "file".into(),
        },
    };
    FigureView {
        svg: input.svg.clone(),
        narrow: input.narrow.clone(),
        csv: input.csv.clone(),
        anchor,
        name: input.name.clone(),
        title: input.title.clone(),
        caption: input.caption.clone(),
        alt: input.alt.clone(),
        notes: input.notes.iter().map(|(label, text)| NoteView { label: label.clone(), text: text.clone() }).collect(),
        reading: reading(&input.reading),
        files: input.files.iter().map(file).collect(),
    }
}

impl FigureView {
    /// Where the text of its file of that kind belongs. The first table is what is shown; others go with it.
    pub fn text(&mut self, kind: &str) -> Option<&mut String> {
        match kind {
            "SVG" => Some(&mut self.svg),
            NARROW => Some(self.narrow.insert(String::new())),
            "CSV" if self.csv.is_empty() => Some(&mut self.csv),
            _ => None,
        }
    }
}

/// How to read a figure; nothing where nothing is said.
fn reading(texts: &[String; 3]) -> Vec<NoteView> {
    let labels = ["What good looks like", "What bad looks like", "What to do"];
    let said = labels.iter().zip(texts).filter(|(_, text)| !text.is_empty());
    said.map(|(label, text)| NoteView { label: (*label).into(), text: text.clone() }).collect()
}

/// An effect with its parameters in one line.
fn effect(setting: &EffectSetting, coordinate: Coordinate) -> String {
    let infos = setting.effect.parameters();
    let values = infos.iter().zip(&setting.parameters);
    let one = |(p, v): (&ParameterInfo, &f64)| format!("{} = {}", p.symbol, units::format(*v, p.unit_for(coordinate)));
    let values: Vec<String> = values.map(one).collect();
    format!("{} ({})", setting.name(), values.join(", "))
}

fn curve(curve: &Curve, scenario: &Scenario) -> CurveView {
    let (condition, signals) = (&curve.condition, &scenario.signals);
    let contact = scenario.contact.is_some();
    let of_contact = |quantity: Quantity| if contact { quantity } else { none() };
    let count = |wanted: fn(&Status) -> bool| curve.states.iter().filter(|state| wanted(&state.status)).count();
    let down = curve.frequency.iter().zip(&curve.down).filter_map(|(f, state)| Some((f, state.as_ref()?)));
    let peak = curve
        .frequency
        .iter()
        .zip(&curve.states)
        .chain(down)
        .filter(|(_, state)| state.amplitude.is_finite() && curve.frequency.len() >= CURVE)
        .max_by(|a, b| a.1.amplitude.total_cmp(&b.1.amplitude));
    let at_peak =
        |unit: &str, value: fn(&SteadyState) -> f64| peak.map_or(none(), |(_, state)| computed(value(state), unit));
    CurveView {
        formulation: of_contact(Quantity { value: None, text: formulation(condition.formulation).into() }),
        euler_steps: match condition.formulation {
            Formulation::Paper => setting(condition.euler_steps as f64, "1"),
            Formulation::Series => none(),
        },
        drive: setting(condition.drive, signals.drive.unit),
        load: of_contact(setting(condition.load, "N")),
        friction: of_contact(setting(condition.friction, "1")),
        speed: of_contact(setting(condition.speed, "m/s")),
        peak_frequency: peak.map_or(none(), |(frequency, _)| setting(*frequency, "Hz")),
        peak_amplitude: at_peak(signals.reading.unit, |state| state.amplitude),
        peak_phase: at_peak("rad", |state| state.phase),
        peak_speed_amplitude: of_contact(at_peak("m/s", |state| state.speed_amplitude)),
        stick_fraction: of_contact(peak.map_or(none(), |(_, state)| Quantity {
            value: Some(state.stick_fraction).filter(|share| share.is_finite()),
            text: percent(state.stick_fraction, 3),
        })),
        steady: count(Status::is_steady),
        self_excited: count(|status| matches!(status, Status::SelfExcited(_))),
        failed: count(|status| matches!(status, Status::Failed(_))),
    }
}

fn limit(limit: &LimitCurve) -> LimitView {
    LimitView {
        case: match limit.case {
            LimitingCase::FreeOrFullSlip => "I, III: no contact, full slip".into(),
            LimitingCase::StaticContact => "II: static contact".into(),
        },
        drive: setting(limit.drive, "m"),
        peak_frequency: computed(limit.peak_frequency, "Hz"),
        peak_amplitude: computed(limit.peak_amplitude, "rad"),
        speed_peak_frequency: computed(limit.speed_peak_frequency, "Hz"),
        speed_peak: computed(limit.speed_peak, "m/s"),
    }
}

/// The settings of the curves, outermost first; those that are the same for all of them carry the common value.
fn axes(curves: &[CurveView], signals: &Signals) -> Vec<AxisView> {
    type Field = fn(&CurveView) -> &Quantity;
    let (drive, speed) = match signals.of_arm() {
        true => (meaning("u₀"), meaning("V")),
        false => (signals.drive.name, "speed of the surface that slides on the rig"),
    };
    let fields: [(&str, &str, &str, Field); 6] = [
        ("formulation", "", "formulation", |curve| &curve.formulation),
        ("euler_steps", "", "Euler steps per cycle", |curve| &curve.euler_steps),
        ("drive", signals.drive.symbol, drive, |curve| &curve.drive),
        ("load", "W", meaning("W"), |curve| &curve.load),
        ("friction", "μ", meaning("μ"), |curve| &curve.friction),
        ("speed", "V", speed, |curve| &curve.speed),
    ];
    let axis = |(key, symbol, name, field): (&str, &str, &str, Field)| {
        let first = curves.first().map(field)?;
        let fixed = curves.iter().all(|curve| field(curve) == first).then(|| first.clone());
        if fixed.as_ref().is_some_and(|common| common.text == NONE) {
            return None;
        }
        Some(AxisView { key: key.into(), symbol: symbol.into(), name: name.into(), fixed })
    };
    fields.into_iter().filter_map(axis).collect()
}

fn reasons<'a>(states: impl Iterator<Item = &'a SteadyState>) -> Vec<String> {
    let mut reasons: Vec<String> = Vec::new();
    for state in states {
        if let Status::SelfExcited(reason) | Status::Failed(reason) = &state.status
            && reasons.len() < REASONS
            && !reasons.contains(reason)
        {
            reasons.push(reason.clone());
        }
    }
    reasons
}

fn none() -> Quantity {
    Quantity { value: None, text: NONE.into() }
}
