//! What of a ladder of additions nothing testifies to, and is taken off again.

use super::Step;
use super::criteria::is_worth;
use super::hypothesis::Addition;
use crate::fit::is_lost;

/// Takes off the last additions where what is left is no noise: those that leave no steady state, and those beyond the
/// step that predicts series best that are left out of the fit; of a single series, of which nothing is left out, those
/// that gain no more than their price. Misfit of one cause, spread over many readings, makes terms significant that only
/// follow it. Tells the first that was taken off, and why.
pub(super) fn beyond_prediction(steps: &mut Vec<Step>) -> Option<String> {
    let mut first = None;
    let lost = |step: &Step| is_lost(step.comparison.points.iter().map(|p| &p.model));
    while let [.., before, last] = &steps[..]
        && lost(last)
        && !lost(before)
    {
        first = steps.pop()?.added.map(|name| format!("with {name} too few of the readings have a steady state"));
    }
    // How far each series has drifted the others do not tell: from there on their prediction is no testimony.
    let told = steps.iter().take_while(|s| !s.hypothesis.additions.iter().any(Addition::is_of_each_series));
    let predicted: Option<Vec<f64>> = told.map(|s| s.held_out.map(|h| h.chi2_per_point)).collect();
    if let Some(predicted) = predicted {
        let least = (0..predicted.len()).min_by(|a, b| predicted[*a].total_cmp(&predicted[*b])).unwrap_or(0);
        if let [next, ..] = &steps[least + 1..predicted.len()] {
            let of = |index: usize| format!("{:.2}", predicted[index]);
            first = next.added.as_ref().map(|name| {
                let (with, without) = (of(least + 1), of(least));
                format!(
                    "series that are left out are predicted worse with {name}: chi2 {with} there, {without} without it"
                )
            });
            steps.truncate(least + 1);
        }
    }
    let single = steps.iter().all(|step| step.held_out.is_none());
    while let [.., before, last] = &steps[..]
        && (chi2(last) >= chi2(before) || single && !pays(before, last))
    {
        let why = match chi2(last) >= chi2(before) {
            true => "lowers no squares",
            false => "gains no more than its price over as many readings as are independent in what is left",
        };
        first = steps.pop()?.added.map(|name| format!("{name} {why}"));
    }
    first
}

/// Takes off all additions where neither testimony for them holds: what the calibration leaves has no structure, by a test
/// that could have found some, and series that are left out are predicted no better with them. Noise that is larger at
/// some readings than at others, as where the frequency wavers on a flank, makes laws significant that follow it. Tells
/// what was taken off, and why. A drift, which no other series predicts, is told by what is left alone.
pub(super) fn beyond_testimony(steps: &mut Vec<Step>) -> Option<String> {
    let [base, .., end] = &steps[..] else { return None };
    let white = &base.comparison.whiteness;
    let of_each_series = end.hypothesis.additions.iter().any(Addition::is_of_each_series);
    let (with, without) = (end.held_out?.chi2_per_point, base.held_out?.chi2_per_point);
    if white.structured || !white.testable || of_each_series || with < without {
        return None;
    }
    let label = end.hypothesis.label();
    steps.truncate(1);
    Some(format!(
        "what the calibrated model leaves has no structure, and series that are left out are predicted no better with {label}: \
         chi2 {with:.2} there, {without:.2} without it"
    ))
}

fn chi2(step: &Step) -> f64 {
    step.comparison.overall.chi2_per_point
}

/// Whether a step of a ladder gains more than its price.
fn pays(before: &Step, last: &Step) -> bool {
    let parameters = last.hypothesis.fit.parameters.len().saturating_sub(before.hypothesis.fit.parameters.len());
    is_worth(
        chi2(before) / chi2(last),
        parameters,
        last.comparison.overall.readings,
        last.comparison.whiteness.autocorrelation,
    )
}
