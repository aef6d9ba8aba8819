//! What an answer says, in words that the terminal, the figure and the report share.

use super::{Answer, CLEARLY, Deciding, Features, Hypothesis, Setting};
use crate::units;

/// Percent with two digits.
fn percent(share: f64) -> String {
    if share.is_finite() { format!("{:.1} %", 100.0 * share) } else { "-".into() }
}

/// Percent of a number that somebody wrote: with the digits that it has.
fn whole(share: f64) -> String {
    format!("{} %", (1e4 * share).round() / 100.0)
}

/// The parameters of an effect at a setting, with units.
pub fn parameters(hypothesis: &Hypothesis, setting: &Setting) -> String {
    let infos = hypothesis.effect.parameters().iter().zip(&setting.values);
    infos
        .map(|(info, value)| format!("{} = {}", info.key, units::format(*value, info.unit)))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Why an effect cannot; empty where it can.
pub fn why_not(hypothesis: &Hypothesis) -> String {
    match (hypothesis.can(), hypothesis.idle) {
        (true, _) => String::new(),
        (false, true) => "comes no closer than without it".into(),
        (false, false) => unmet(&hypothesis.best.features),
    }
}

/// What a curve lacks of the description; empty where nothing.
fn unmet(features: &Features) -> String {
    let points = |n: usize| if n == 1 { "1 point is".into() } else { format!("{n} points are") };
    let mut all = Vec::new();
    if features.not_steady > 0 {
        all.push(format!("{} not steady", points(features.not_steady)));
    } else {
        let wanted = [
            (features.is_lower, "peak not clearly lower"),
            (features.is_right, "peak not shifted right"),
            (features.same_at_ends, "differs from full slip at the ends"),
            (features.is_alike, "too far from the curve between"),
        ];
        all.extend(wanted.iter().filter(|(met, _)| !met).map(|(_, text)| text.to_string()));
    }
    all.join("; ")
}

/// One of the things that are asked of a curve, and what a curve has of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    /// Whether the curve has it.
    pub met: bool,
    /// What it has and what is asked.
    pub text: String,
}

/// Everything that is asked of a curve, with what a setting's has.
pub fn criteria(answer: &Answer, setting: &Setting) -> [Criterion; 4] {
    let (f, tolerance) = (&setting.features, answer.question.tolerance);
    let ends = f.ends[0].abs().max(f.ends[1].abs());
    let step = answer.step_hz();
    let peak = |text: String| if f.peak.is_some() { text } else { "no peak".into() };
    let side = if f.shift_hz < 0.0 { "left" } else { "right" };
    let height = if f.lower < 0.0 { "higher" } else { "lower" };
    [
        Criterion {
            met: f.is_lower,
            text: peak(format!("peak {} {height} (≥ {} lower)", percent(f.lower.abs()), whole(CLEARLY * tolerance))),
        },
        Criterion {
            met: f.is_right, text: peak(format!("{:.2} Hz {side} (≥ {step:.2} Hz right)", f.shift_hz.abs()))
        },
        Criterion { met: f.same_at_ends, text: format!("ends differ by {} (≤ {})", percent(ends), whole(tolerance)) },
        Criterion { met: f.is_alike, text: format!("rms {} (≤ {})", percent(f.rms), whole(tolerance)) },
    ]
}

/// How many can with another tolerance; empty where none was tried.
pub fn otherwise(answer: &Answer) -> String {
    let at = |other: &super::Otherwise| {
        let names = if other.able.is_empty() { "none".into() } else { other.able.join(", ") };
        format!("{}: {names}", whole(other.tolerance))
    };
    answer.otherwise.iter().map(at).collect::<Vec<_>>().join("; ")
}

/// The speeds and the condition in words.
pub fn condition(answer: &Answer) -> String {
    let c = &answer.condition;
    format!(
        "V = {}, W = {}, u0 = {}",
        units::format(c.speed, "m/s"),
        units::format(c.load, "N"),
        units::format(c.drive, "m")
    )
}

/// The deciding reading and what the hypotheses say of it.
pub fn close(deciding: &Deciding) -> String {
    let says = deciding.predictions.iter().map(|p| format!("{} {:.3e} rad", p.effect, p.amplitude_rad));
    format!(
        "V = {}, W = {}, u0 = {}, f = {:.1} Hz: {}; no two closer than {} (at the condition of the question at most {})",
        units::format(deciding.speed_m_s, "m/s"),
        units::format(deciding.load_n, "N"),
        units::format(deciding.drive_m, "m"),
        deciding.frequency_hz,
        says.collect::<Vec<_>>().join(", "),
        percent(deciding.least_difference),
        percent(deciding.without_change)
    )
}

/// The ranking in lines of text.
pub fn lines(answer: &Answer) -> Vec<String> {
    let able = answer.able().count();
    let mut lines = vec![
        format!(
            "{}: which effects give at {} a curve like the simulated one at {}?",
            answer.scenario.title,
            condition(answer),
            units::format(answer.question.resembles, "m/s")
        ),
        format!(
            "  hypotheses, not findings: {able} of {} effects can; strain is 0 in the middle of the catalogue's ranges, 1 at their edge",
            answer.hypotheses.len()
        ),
    ];
    for (index, h) in answer.hypotheses.iter().enumerate().filter(|(_, h)| h.can()) {
        let (mild, best) = (h.shown(), &h.best);
        lines.push(format!(
            "  {}. {}: strain {:.2} with {} (differs by {} rms); closest {} rms with {}, strain {:.2}",
            index + 1,
            h.effect.name(),
            mild.strain,
            parameters(h, mild),
            percent(mild.features.rms),
            percent(best.features.rms),
            parameters(h, best),
            best.strain
        ));
    }
    for h in answer.hypotheses.iter().filter(|h| !h.can() && !h.idle) {
        lines.push(format!(
            "  cannot: {}, {} rms at best: {}",
            h.effect.name(),
            percent(h.best.features.rms),
            why_not(h)
        ));
    }
    let idle: Vec<&str> = answer.hypotheses.iter().filter(|h| h.idle).map(|h| h.effect.name()).collect();
    if !idle.is_empty() {
        lines.push(format!("  no closer than without them: {}", idle.join(", ")));
    }
    if !answer.otherwise.is_empty() {
        lines.push(format!("  with another tolerance, {}", otherwise(answer)));
    }
    if let Some(deciding) = &answer.deciding {
        lines.push(format!("  a reading that decides: {}", close(deciding)));
    }
    lines
}
