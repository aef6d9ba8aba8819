//! Model against measurements: the part of a scenario's section that a comparison fills.

use super::anchor;
use super::format::{self, NONE, computed, quantity};
use super::scenario::{FigureInput, figure};
use super::verdict::{Completeness, Match};
use super::view::{
    ComparisonView, FigureView, FittedView, MatchView, NoteView, OutlierView, PeakView, Quantity, ScenarioView,
};
use crate::compare::{self, Comparison, ConditionMetrics, Peak, outlier_words};
use crate::figures::style::budget_percent;
use crate::fit::{Identified, Interval, Parameter};
use crate::scenario::Signals;
use crate::solver::Status;
use crate::units::Frequencies;

/// Figures shown at once; the others are folded.
const FIRST: [&str; 5] = ["overlay", "misfit-map", "contact-fingerprint", "missing-force", "missing-force-amplitude"];
/// Ranges of misfit listed.
const REGIONS: usize = 6;
/// Outliers listed.
const OUTLIERS: usize = 24;

impl ScenarioView {
    /// The section with a comparison in it. The model's points count like those of a sweep.
    pub fn with_comparison(mut self, c: &Comparison, figures: &[FigureInput]) -> Self {
        let count = |wanted: fn(&Status) -> bool| c.points.iter().filter(|p| wanted(&p.model.status)).count();
        let self_excited = count(|status| matches!(status, Status::SelfExcited(_)));
        let failed = count(|status| matches!(status, Status::Failed(_)));
        self.points += c.points.len();
        self.steady += c.points.len() - self_excited - failed;
        self.self_excited += self_excited;
        self.failed += failed;
        self.status = match (self.failed, self.self_excited) {
            (0, 0) => Completeness::Steady,
            (0, _) => Completeness::SelfExcited,
            _ => Completeness::Failed,
        };
        self.comparison = Some(comparison_view(c, figures));
        self.rig = self.rig.map(|rig| rig.with(&c.scenario));
        self
    }
}

/// The view of a comparison.
pub fn comparison_view(c: &Comparison, figures: &[FigureInput]) -> ComparisonView {
    let id = &c.scenario.id;
    let views: Vec<FigureView> = figures.iter().map(|input| figure(id, input)).collect();
    let (first, more) = views.into_iter().partition(|view| FIRST.contains(&view.name.as_str()));
    let verdict = verdict(c);
    let signals = &c.table.signals;
    let digits = (!signals.of_arm()).then(|| Frequencies::of(c.table.points.iter().map(|p| p.frequency)));
    let all = ConditionMetrics {
        setting: c.conditions[0].setting,
        metrics: c.overall,
        model_peak: None,
        measured_peak: None,
        measured_peak_sd: 0.0,
        measured_width: 0.0,
    };
    ComparisonView {
        anchor: anchor::comparison(id),
        verdict,
        sentence: sentence(c, verdict),
        shifts: compare::shifts(c),
        tests: tests(c),
        signals: super::rig::signals(signals),
        file: c.table.file.display().to_string(),
        hash: c.table.hash.clone(),
        notes: c.table.notes.iter().chain(&c.notes).cloned().collect(),
        overall: MatchView { speed: none(), load: none(), drive: none(), ..metrics(&all, signals, digits.as_ref()) },
        parameters: c.fit.parameters.iter().zip(&c.intervals).map(|(p, i)| fitted(p, i)).collect(),
        ties: c.correlations.iter().map(tie).collect(),
        conditions: c
            .conditions
            .iter()
            .enumerate()
            .map(|(at, condition)| MatchView {
                series: if signals.of_arm() { String::new() } else { series(c, at) },
                ..metrics(condition, signals, digits.as_ref())
            })
            .collect(),
        regions: c.regions.iter().take(REGIONS).map(|region| region.sentence.clone()).collect(),
        more_regions: c.regions.len().saturating_sub(REGIONS),
        outliers: c.outliers.iter().take(OUTLIERS).map(outlier).collect(),
        more_outliers: c.outliers.len().saturating_sub(OUTLIERS),
        budget: budget(c),
        figures: first,
        more,
    }
}

/// What the residuals are like.
fn verdict(c: &Comparison) -> Match {
    if c.whiteness.structured {
        Match::Structured
    } else if !c.whiteness.testable {
        Match::Untested
    } else if c.whiteness.noise() > 1.0 {
        Match::Noisy
    } else {
        Match::Noise
    }
}

fn sentence(c: &Comparison, verdict: Match) -> String {
    let m = &c.overall;
    let what = match verdict {
        Match::Structured if c.whiteness.exceeds => {
            "What the model leaves is larger than the readings scatter along their series: no noise"
        }
        Match::Structured => "What the model leaves is structured, not noise",
        Match::Noisy => "What the model leaves has no structure, but is larger than the stated noise",
        Match::Untested => {
            "Whether what the model leaves is noise cannot be tested: the series have too few neighbouring readings"
        }
        Match::Noise => "What the model leaves looks like noise",
    };
    let aside = match c.outliers.len() {
        0 => String::new(),
        n => format!(
            " with {}{}",
            outlier_words(n),
            c.chi2_without_outliers().map_or(String::new(), |chi2| format!(", {} without", quantity(chi2, "1", 3)))
        ),
    };
    let phase = match (m.rms_phase_deg, m.noise_phase_deg) {
        (Some(error), Some(noise)) => {
            format!(", phase {} (noise {})", shown(error, "°", 3).text, shown(noise, "°", 2).text)
        }
        _ => String::new(),
    };
    format!(
        "{what}: χ² per reading {}{aside} (noise alone: 1); root mean square error of the amplitude {} (noise {}){phase}.",
        quantity(m.chi2_per_point, "1", 3),
        quantity(m.rms_error_percent, "%", 3),
        quantity(m.noise_percent, "%", 2)
    )
}

fn tests(c: &Comparison) -> String {
    let w = &c.whiteness;
    format!(
        "Tests of the residuals {}: {} runs of equal sign where noise has about {:.0}; correlation of neighbours {}; \
         smooth part {} times the rest.",
        if w.as_read { "in the order of the rows" } else { "along the frequency" },
        w.runs,
        w.runs_expected,
        quantity(w.autocorrelation, "1", 2),
        quantity(w.smooth_ratio, "1", 2)
    )
}

/// The name of a series, or its number.
fn series(c: &Comparison, at: usize) -> String {
    let name = c.table.series.get(at).map_or("", |series| &series.name);
    if name.is_empty() { (at + 1).to_string() } else { name.to_string() }
}

/// A condition; `digits` says how its frequencies are written where the rig is not the paper's.
fn metrics(condition: &ConditionMetrics, signals: &Signals, digits: Option<&Frequencies>) -> MatchView {
    let (m, s) = (&condition.metrics, &condition.setting);
    let of_contact = |value: f64, unit: &str| if s.contact { format::setting(value, unit) } else { none() };
    let peak = |found: Option<Peak>| peak(found, signals.reading.unit, digits);
    let degrees = |value: Option<f64>, digits| value.map_or(none(), |value| shown(value, "°", digits));
    MatchView {
        series: String::new(),
        speed: of_contact(s.speed, "m/s"),
        load: of_contact(s.load, "N"),
        drive: match digits {
            None => format::setting(s.drive, s.signal.unit),
            Some(_) => trimmed(s.drive, s.signal.unit),
        },
        points: m.points,
        readings: m.readings,
        chi2: shown(m.chi2_per_point, "1", 3),
        error: shown(m.rms_error_percent, "%", 3),
        noise: shown(m.noise_percent, "%", 2),
        phase_error: degrees(m.rms_phase_deg, 3),
        phase_noise: degrees(m.noise_phase_deg, 2),
        measured_peak: peak(condition.measured_peak),
        model_peak: peak(condition.model_peak),
    }
}

/// A drive as it was measured: four digits.
fn trimmed(value: f64, unit: &str) -> Quantity {
    let near = format!("{value:.3e}").parse().unwrap_or(value);
    Quantity { value: Some(value).filter(|v| v.is_finite()), ..format::setting(near, unit) }
}

fn peak(peak: Option<Peak>, unit: &str, digits: Option<&Frequencies>) -> PeakView {
    let frequency = |f: f64| match digits {
        None => computed(f, "Hz"),
        Some(digits) => Quantity { value: Some(f), text: digits.fixed(f) },
    };
    PeakView {
        frequency: peak.map_or(none(), |p| frequency(p.frequency_hz)),
        amplitude: peak.map_or(none(), |p| computed(p.amplitude, unit)),
    }
}

pub(super) fn fitted(parameter: &Parameter, interval: &Interval) -> FittedView {
    let meaning = match interval.identified {
        Identified::Yes => "bounded on both sides",
        Identified::OneSided => "bounded on one side; the other end is that of the search",
        Identified::No => "not determined by these data",
    };
    let [value, low, high] = format::interval([interval.value, interval.low, interval.high], parameter.unit);
    FittedView {
        key: parameter.key.clone(),
        value,
        low,
        high,
        identified: interval.identified.word().into(),
        meaning: meaning.into(),
    }
}

pub(super) fn tie(pair: &crate::fit::Correlation) -> String {
    let (a, b) = &pair.parameters;
    format!("The estimates of {a} and {b} are tied together (correlation {}).", quantity(pair.value, "1", 3))
}

pub(super) fn outlier(outlier: &crate::compare::Outlier) -> OutlierView {
    let column = if outlier.is_phase() { "phase" } else { "amplitude" };
    OutlierView { row: outlier.row, column: column.into(), error: shown(outlier.off_neighbours, "σ", 3) }
}

fn budget(c: &Comparison) -> Vec<NoteView> {
    let b = c.error_budget();
    let parts = [
        ("model", b.model_percent),
        ("noise", b.noise_percent),
        ("numerics", b.numerical_percent),
        ("total", b.total_percent),
    ];
    parts.iter().map(|(label, value)| NoteView { label: (*label).into(), text: budget_percent(*value) }).collect()
}

pub(super) fn shown(value: f64, unit: &str, digits: usize) -> Quantity {
    // Degrees stand close to their number.
    let text = quantity(value, unit, digits).replace(" °", "°");
    Quantity { value: Some(value).filter(|value| value.is_finite()), text }
}

pub(super) fn none() -> Quantity {
    Quantity { value: None, text: NONE.into() }
}
