//! What a discovery says, in words that the terminal and the report share.

use super::hypothesis::Basis;
use super::{Candidate, Discovery, MARGIN, Step, Verdict};
use crate::compare::outlier_words;
use crate::fit::{Identified, Interval, Parameter};
use crate::measurement::{NoiseSource, shows_anything};
use crate::scenario::parameters::of_key;
use crate::units::count;
use crate::units::readable::{percent, quantity};

/// That these numbers, by key, have other values, each with its rivals; of one with what it is, on the rig of `d`.
fn recalibration(d: &Discovery, keys: &[String]) -> String {
    let arm = d.explanation().hypothesis.model.rig.is_arm();
    let meaning = match keys {
        [key] => of_key(key, arm).map_or_else(String::new, |info| format!(", the {}", info.meaning)),
        _ => String::new(),
    };
    let named: Vec<String> = keys.iter().map(|key| format!("{key}{meaning}{}", rivals(d, key))).collect();
    format!("recalibrate {}: no effect is needed", named.join(", "))
}

/// That what the calibrated model leaves lies within the deviations that the table states, where the readings scatter
/// less and the search went by that.
fn as_stated(d: &Discovery) -> Option<String> {
    let base = &d.steps[0].comparison;
    let points = &base.table.points;
    let phases = points.iter().filter(|p| p.phase.is_some()).count();
    let noise = d.noise.together(points.len(), phases);
    let chi2 = base.overall.chi2_per_point * noise.powi(2);
    let is_within = d.noise.contradicts(base.table.noise_sources()) && noise < 1.0 && chi2 < 1.0;
    is_within.then(|| {
        let which = match base.table.amplitude_noise {
            NoiseSource::Replicates => "the deviations of repeated readings",
            _ => "the stated deviations",
        };
        format!("; within {which}, {:.1} times the scatter, the calibrated model explains the data", 1.0 / noise)
    })
}

/// What a test found in what a step leaves.
fn what_is_left(end: &Step) -> &'static str {
    match end.comparison.whiteness.exceeds {
        true => "more is left than the readings scatter along their series",
        false => "structured misfit is left",
    }
}

/// The verdict in a sentence.
pub fn sentence(d: &Discovery) -> String {
    match d.verdict {
        Verdict::NothingMissing => said(d),
        _ => said(d) + &as_stated(d).unwrap_or_default(),
    }
}

fn said(d: &Discovery) -> String {
    let end = d.explanation();
    let named = |names: Vec<String>| names.iter().map(|name| format!("{name}{}", rivals(d, name))).collect::<Vec<_>>();
    let (effects, recalibrated) = (named(end.hypothesis.effects()), named(end.hypothesis.recalibrated()));
    let all = end.hypothesis.label();
    match d.verdict {
        Verdict::NothingMissing if d.not_testable.is_empty() => {
            format!("nothing is missing; the calibrated model explains the data within {}", noise(d))
        }
        Verdict::NothingMissing => format!(
            "nothing is missing that these data can show, and {} of {} effects they cannot; the calibrated model explains \
             them within {}",
            d.not_testable.len(),
            d.asked.len(),
            noise(d)
        ),
        Verdict::Recalibrate => recalibration(d, &end.hypothesis.recalibrated()),
        Verdict::EffectMissing if recalibrated.is_empty() => format!("missing: {}", effects.join(" + ")),
        Verdict::EffectMissing => format!("missing: {}; recalibrate {}", effects.join(" + "), recalibrated.join(", ")),
        Verdict::Unexplained if !shows_anything(&end.comparison.table.points) => {
            "undecided: the readings vary from one to the next as much as along their series; there is no curve to hold a \
             model against"
                .into()
        }
        Verdict::Unexplained if !end.comparison.whiteness.testable => {
            let what = if end.hypothesis.additions.is_empty() { "the calibrated model".into() } else { all };
            let freedom = end.comparison.table.freedom;
            let known = Some(freedom).filter(|freedom| freedom.is_finite()).map_or(String::new(), |freedom| {
                format!(", by a noise known from {} of freedom", count(freedom.round() as usize, "degree"))
            });
            format!(
                "undecided: the series are too short to test whether {what} leaves more than noise; chi2 {:.2}{known}",
                end.comparison.overall.chi2_per_point
            )
        }
        Verdict::Unexplained if end.hypothesis.additions.is_empty() => {
            format!("unexplained: {}, {}", what_is_left(end), nothing(d))
        }
        Verdict::Unexplained => {
            let error = |step: &Step| step.comparison.overall.rms_error_percent / 100.0;
            let (before, after) = (error(&d.steps[0]), error(end));
            let [from, to] = [before, after].map(|error| percent(error, 2));
            let but = format!("but {}", d.undecidable.unwrap_or(what_is_left(end)));
            // The search goes by squares over the noise: the relative error of the amplitude need not fall with them, where
            // readings far below the peak, which are mostly noise, make most of it.
            let [chi2, left] = [&d.steps[0], end].map(|step| step.comparison.overall.chi2_per_point);
            if 2.0 * left / chi2 < (after / before).powi(2) {
                format!("unexplained: {all} takes chi2 per reading from {chi2:.2} to {left:.2}, {but}")
            } else if after < before && from != to {
                format!("unexplained: {all} takes the rms error from {from} to {to}, {but}")
            } else {
                format!("unexplained: {all} helps, {but}")
            }
        }
    }
}

/// Whether something that was added was fitted to all readings.
fn is_fitted(c: &Candidate) -> bool {
    !c.hypothesis.additions.is_empty() && c.hypothesis.basis() == Basis::AllPoints
}

/// Why nothing is named beside a misfit that is left, in words.
fn nothing(d: &Discovery) -> String {
    match nearest(d) {
        _ if d.candidates.len() < 2 => "and nothing was tried".into(),
        None if d.spent && !d.candidates.iter().any(is_fitted) => {
            "and the budget was spent before anything was fitted to all readings".into()
        }
        Some(nearest) => nearest,
        None if d.candidates.iter().any(|c| c.is_open) => {
            "and what may account for it would take more than the budget to fit (raise it: --search budget=…)".into()
        }
        None => format!("and {} takes off enough of it to count", none_of(d)),
    }
}

/// None of the effects that were tried, in words.
fn none_of(d: &Discovery) -> String {
    match d.asked[..] {
        [only] => format!("none of what was tried ({only})"),
        _ => format!("none of the {} effects that were tried", d.asked.len()),
    }
}

/// What of the catalogue comes nearest to an explanation, where that was none.
fn nearest(d: &Discovery) -> Option<String> {
    let best = d.candidates.iter().find(|c| is_fitted(c))?;
    let base = d.candidates.iter().find(|c| c.hypothesis.additions.is_empty());
    let is_ahead = base.is_none_or(|base| base.delta_bic - best.delta_bic > MARGIN);
    let [before, after] = [d.steps[0].comparison.overall.chi2_per_point, best.chi2_per_point];
    (is_ahead && after < before).then(|| {
        let label = best.hypothesis.label();
        format!("and {} accounts for it; nearest comes {label}, chi2 {before:.2} to {after:.2}", none_of(d))
    })
}

/// How sure the verdict is: the test that could have failed, and the closest rival.
pub fn how_sure(d: &Discovery) -> String {
    let end = d.explanation();
    let white = &end.comparison.whiteness;
    if d.verdict == Verdict::Unexplained {
        return if !shows_anything(&end.comparison.table.points) {
            "how sure cannot be said: nothing but scatter is seen".into()
        } else if !white.testable {
            "how sure cannot be said: there are too few neighbouring readings to test what is left".into()
        } else if white.structured {
            let noise = end.comparison.unit().sqrt();
            let size = if noise > 1.0 { format!(", {noise:.1} times the noise") } else { String::new() };
            if white.exceeds {
                return format!(
                    "no cause is named, since more is left than the readings scatter along their series{size}"
                );
            }
            format!("no cause is named, since a test finds structure in what is left{size}")
        } else if d.undecidable.is_none() {
            "no cause is named, since too few of the readings have a steady state".into()
        } else {
            "no cause is named, since these readings could not contradict it".into()
        };
    }
    let chi2 = quantity(end.comparison.overall.chi2_per_point, "1", 3);
    let tested = format!(
        "what is left shows no pattern, by a test that could have found one (χ² per reading {chi2}, noise alone 1)"
    );
    let tied = d.indistinguishable.iter().find(|group| group.len() > 1);
    if let Some(group) = tied {
        return format!("{tested}; these data do not tell {} from {}", group[0], group[1..].join(" or "));
    }
    let own = d.candidates.iter().find(|c| c.hypothesis.same_additions(&end.hypothesis)).map_or(0.0, |c| c.delta_bic);
    // What contains the explanation is no rival of it, but where that is nothing.
    let contains = |c: &Candidate| end.hypothesis.within(&c.hypothesis);
    let is_rival = |c: &&Candidate| {
        if end.hypothesis.additions.is_empty() { !c.hypothesis.additions.is_empty() } else { !contains(c) }
    };
    let Some(rival) = d.candidates.iter().find(is_rival) else { return tested };
    format!("{tested}; {}", beside(d, rival, rival.delta_bic - own))
}

/// How far a rival is behind the explanation, and what that rests on.
fn beside(d: &Discovery, rival: &Candidate, behind: f64) -> String {
    let end = d.explanation();
    let points = end.comparison.table.points.len();
    let alone = rival.hypothesis.additions.is_empty();
    let label = if alone { "the calibrated model alone".into() } else { rival.hypothesis.label() };
    match (rival.hypothesis.basis(), behind) {
        (_, b) if b < 0.0 => format!("{label} is {:.1} ahead in BIC, too little to decide for it among so many", -b),
        (Basis::SomePoints(some), b) if b >= MARGIN => {
            format!("the closest rival, {label}, was given up {b:.0} behind in BIC after {some} of {points} points")
        }
        (Basis::Linear, b) if b >= MARGIN => {
            format!("the closest rival, {label}, was given up {b:.0} behind in BIC on an estimate, before any fit")
        }
        (_, b) if b >= MARGIN => {
            let price = match rival.hypothesis.fit.parameters.len().saturating_sub(end.hypothesis.fit.parameters.len())
            {
                more if more as f64 * (end.comparison.overall.readings as f64).ln() > 0.5 * b => {
                    format!(", most of that for {} more", count(more, "parameter"))
                }
                _ => String::new(),
            };
            format!("the closest rival, {label}, is {b:.0} behind in BIC{}{price}", odds(b))
        }
        (_, b) if end.hypothesis.additions.is_empty() => {
            format!("{label} explains no more than its price (BIC {b:.1} worse with it), which does not rule it out")
        }
        // What was left before its fit had ended may come nearer: no odds are told of it.
        (Basis::AllPoints, b) => format!("{label} is only {b:.1} behind in BIC{}, which does not rule it out", odds(b)),
        (basis, b) => {
            let fitted = basis.words(points);
            format!(
                "{label} is only {b:.1} behind in BIC, as far as it was fitted ({fitted}), which does not rule it out"
            )
        }
    }
}

/// The odds that a difference in Schwarz's criterion stands for, where they can be said in words.
fn odds(behind: f64) -> String {
    let odds = (0.5 * behind).exp();
    match odds {
        odds if odds < 10.0 => format!(" ({odds:.0} to 1)"),
        odds if odds < 1e6 => {
            // To one digit.
            let size = 10f64.powf(odds.log10().floor());
            format!(" (about {} to 1)", (odds / size).round() * size)
        }
        _ => " (more than a million to 1)".into(),
    }
}

/// What the data are explained within: their noise, or their scatter where that contradicts it; and what stands out.
fn noise(d: &Discovery) -> String {
    let sources = d.explanation().comparison.table.noise_sources();
    let noise: String = match d.noise.words(sources) {
        Some(words) if d.noise.contradicts(sources) => format!("their scatter ({words})"),
        _ => "their noise".into(),
    };
    match d.outliers.len() {
        0 => noise,
        n => format!("{noise}, {} aside", outlier_words(n)),
    }
}

/// What the data do not tell from a part of the explanation, in brackets.
fn rivals(d: &Discovery, name: &str) -> String {
    let group = d.indistinguishable.iter().find(|group| group.first().is_some_and(|first| first == name));
    match group.map(Vec::as_slice) {
        Some([_, others @ ..]) if !others.is_empty() => format!(" (or {})", others.join(", or ")),
        _ => String::new(),
    }
}

/// Whether the lower and the upper end of an interval are the search's rather than the data's.
pub fn open_ends(parameter: &Parameter, interval: &Interval) -> (bool, bool) {
    match interval.identified {
        Identified::Yes => (false, false),
        Identified::No => (true, true),
        Identified::OneSided => {
            let low = parameter.at_bound(interval.low);
            (low, !low)
        }
    }
}

/// What the data say of a parameter, in words.
pub fn identified(parameter: &Parameter, interval: &Interval) -> &'static str {
    match open_ends(parameter, interval) {
        (false, false) => "identified",
        (true, false) => "only an upper bound",
        (false, true) => "only a lower bound",
        (true, true) => "these data do not determine it",
    }
}
