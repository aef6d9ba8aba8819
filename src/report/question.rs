//! The part of a scenario's section that answers its question.

use super::anchor;
use super::comparison::{none, shown};
use super::format::{percent, quantity, setting};
use super::question_view::{AbleView, QuestionView, SettingView};
use super::scenario::{FigureInput, figure};
use super::view::{Quantity, ScenarioView};
use crate::question::{Answer, Deciding, Hypothesis, Setting, otherwise, why_not};

/// Noise of a reading that is assumed where none is known.
const ASSUMED_NOISE: f64 = 0.01;
/// Relative accuracy that is demanded of a steady state.
const SOLVED: f64 = 1e-5;

impl ScenarioView {
    /// The section with the answer to its question.
    pub fn with_question(mut self, answer: &Answer, figures: &[FigureInput]) -> Self {
        self.question = Some(question_view(answer, figures));
        self
    }
}

/// The view of an answer.
pub fn question_view(answer: &Answer, figures: &[FigureInput]) -> QuestionView {
    let id = &answer.scenario.id;
    QuestionView {
        anchor: anchor::question(id),
        story: story(answer),
        effects: answer.hypotheses.iter().map(able).collect(),
        deciding: answer.deciding.as_ref().map(deciding).unwrap_or_default(),
        figures: figures.iter().map(|input| figure(id, input)).collect(),
    }
}

fn story(answer: &Answer) -> Vec<String> {
    let (c, d) = (&answer.condition, &answer.described);
    let words = |value: f64, unit: &str| setting(value, unit).text;
    let (target, tolerance) = (words(answer.question.resembles, "m/s"), percent(answer.question.tolerance, 2));
    let mut story = vec![
        format!(
            "Everything in this section is simulated. The curve asked for is the model's own at V = {target}, W = {}, \
             u₀ = {}: its peak is {} lower than in full slip and {} further right, and at both ends of the range it is full \
             slip to {}.",
            words(c.load, "N"),
            words(c.drive, "m"),
            percent(d.lower, 2),
            quantity(d.shift_hz, "Hz", 2),
            difference(d.ends[0].abs().max(d.ends[1].abs())),
        ),
        format!(
            "Each effect is tried alone at V = {}, rig and contact as they are. It can, where its peak is lower by {} or \
             more and further right by a step of the frequencies or more, its ends are full slip within {tolerance}, and the \
             difference from the curve asked for is {tolerance} (rms) or less. Tolerance and drive are assumptions of the \
             scenario.",
            words(c.speed, "m/s"),
            percent(2.0 * answer.question.tolerance, 2),
        ),
        format!(
            "{} of {} effects can. They are hypotheses, not findings about the experiment. They are ranked by their strain: \
             how far the most extreme of their parameters must go from the middle of the catalogue's range (on a logarithmic \
             scale: 0 in the middle, 1 at the edge, more outside). A strain is what the search found, an upper bound.",
            answer.able().count(),
            answer.hypotheses.len()
        ),
    ];
    if let Some(line) = narrowly(answer) {
        story.push(line);
    }
    if !answer.otherwise.is_empty() {
        story.push(format!(
            "How many can hangs on the tolerance, which also says how much lower is clearly lower. Those that can with another \
             one: {}.",
            otherwise(answer)
        ));
    }
    story
}

/// What is to be said where those that can only just can.
fn narrowly(answer: &Answer) -> Option<String> {
    let tightest = answer.otherwise.iter().map(|other| other.tolerance).filter(|t| *t < answer.question.tolerance);
    let tightest = tightest.fold(f64::NEG_INFINITY, f64::max);
    let none = |t: f64| answer.otherwise.iter().any(|other| other.tolerance == t && other.able.is_empty());
    (answer.able().next().is_some() && none(tightest)).then(|| {
        format!(
            "They can only narrowly: with a tolerance of {} none can. Full slip itself, without any effect, differs from the curve \
             asked for by {} (rms).",
            percent(tightest, 2),
            percent(answer.rms_of_full_slip, 2)
        )
    })
}

fn able(h: &Hypothesis) -> AbleView {
    let name = h.effect.name();
    AbleView {
        effect: name.into(),
        atlas: anchor::effect(name),
        verdict: if h.can() { "can" } else { "cannot" }.into(),
        unmet: why_not(h),
        mildest: h.mildest.as_ref().map(|mild| view(h, mild)),
        closest: view(h, &h.best),
    }
}

fn view(h: &Hypothesis, at: &Setting) -> SettingView {
    let infos = h.effect.parameters().iter().zip(&at.values);
    let values: Vec<String> =
        infos.map(|(info, value)| format!("{} = {}", info.symbol, setting(*value, info.unit).text)).collect();
    let f = &at.features;
    let ends = f.ends[0].abs().max(f.ends[1].abs());
    SettingView {
        parameters: values.join(", "),
        strain: shown(at.strain, "1", 2),
        rms: shown(100.0 * f.rms, "%", 2),
        peak_frequency: f.peak.map_or(none(), |peak| shown(peak.frequency_hz, "Hz", 3)),
        peak_amplitude: f.peak.map_or(none(), |peak| shown(peak.amplitude, "rad", 3)),
        ends: Quantity { value: Some(100.0 * ends), text: difference(ends) },
    }
}

/// A difference in percent; one below the accuracy of the solver is said to be that.
fn difference(share: f64) -> String {
    if share < SOLVED { format!("< {}", percent(SOLVED, 1)) } else { percent(share, 2) }
}

fn deciding(d: &Deciding) -> Vec<String> {
    let words = |value: f64, unit: &str| setting(value, unit).text;
    let says: Vec<String> =
        d.predictions.iter().map(|p| format!("{} for {}", quantity(p.amplitude_rad, "rad", 3), p.effect)).collect();
    vec![
        format!(
            "Amplitude at V = {}, W = {}, u₀ = {}, f = {}: {}.",
            words(d.speed_m_s, "m/s"),
            words(d.load_n, "N"),
            words(d.drive_m, "m"),
            quantity(d.frequency_hz, "Hz", 3),
            says.join(", ")
        ),
        format!(
            "No two of these are closer than {}, which is {} standard deviations of a reading if its noise is {} (assumed: no \
             noise is known). At the condition of the question itself they are within {} everywhere. Speeds from a tenth to \
             ten times, loads from a quarter to twice and drives from a third to once those of the question were tried; \
             whether the rig can make them is not known. These are the closest settings found: others that can as well would \
             differ by other amounts, and by less where one effect holds another within it.",
            percent(d.least_difference, 2),
            quantity(d.least_difference / ASSUMED_NOISE, "1", 2),
            percent(ASSUMED_NOISE, 1),
            percent(d.without_change, 2),
        ),
    ]
}
