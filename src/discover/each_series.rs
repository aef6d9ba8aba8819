//! What is named beside a drift, against a rig of its own in every series.

use super::Step;
use crate::compare::calibrate;
use crate::effects::Effect;
use crate::fit::{MARGIN, TAIL, parameter, robust_chi2, typical_of};
use crate::measurement::Point;
use crate::model::Model;
use crate::solver::cycle::Tolerance;

/// Whether the readings within the series tell what an explanation adds to the motion beside a drift. A rig that was
/// another one in each series may have had another damping there, too: what the calibrated model leaves where it is
/// fitted to every series by itself, each with numbers of its own, nothing beside the drift has explained. True without
/// a drift, of a single series, and of a contact, whose laws are told by loads and speeds. The explanation was chosen among
/// many: what the search charges for having `looked_at` them it has to gain as well.
pub(super) fn is_told_within(base: &Step, end: &Step, looked_at: f64) -> bool {
    let additions = &end.hypothesis.additions;
    let acts = |name: &str| end.hypothesis.model.effects.iter().any(|(e, _)| e.name() == name && !e.is_read_beside());
    let beside = additions.iter().any(|a| !a.is_of_each_series() && a.is_effect() && acts(a.name()));
    let drifts = additions.iter().any(|a| a.is_of_each_series());
    if !(drifts && beside) || base.hypothesis.model.has_contact {
        return true;
    }
    let points = &end.comparison.table.points;
    let series = points.iter().map(|p| p.series).max().map_or(0, |last| last + 1);
    let own = base.hypothesis.fitted();
    let mut keys: Vec<String> = base.hypothesis.fit.parameters.iter().map(|p| p.key.clone()).collect();
    let damping = ["rig.quality_factor", "rig.damping_ratio", "rig.damping"];
    if !keys.iter().any(|key| damping.contains(&key.as_str())) {
        keys.extend(damping.iter().find(|key| parameter(&own, key).is_some()).map(|key| key.to_string()));
    }
    let of = |index: usize| points.iter().filter(|p| p.series == index).cloned().collect();
    // Of a series that lies outside the band that is used there are none.
    let of_each: Vec<Vec<Point>> = (0..series).map(of).filter(|own: &Vec<Point>| !own.is_empty()).collect();
    let residuals = &end.comparison.fit.evaluation.residuals;
    let threshold = TAIL * typical_of(residuals);
    let left = |model: &Model| -> f64 {
        let fit = |points: &Vec<Point>| calibrate(model, &keys, points, Tolerance::FIT, 0).fit;
        of_each.iter().map(|points| robust_chi2(&fit(points).evaluation.residuals, threshold)).sum()
    };
    let unit = end.comparison.unit();
    // More numbers take off as many squares of noise.
    let is_worse = |model: &Model, others: usize| {
        let more = (of_each.len() * keys.len() + others) as f64 - end.hypothesis.fit.parameters.len() as f64;
        left(model) + more * unit > robust_chi2(residuals, threshold) + (MARGIN + looked_at) * unit
    };
    // By themselves, and with what the explanation reads beside the motion.
    let mut with = own.clone();
    let is_new = |name: &str| !own.effects.iter().any(|(effect, _)| effect.name() == name);
    let read = |(effect, _): &(&dyn Effect, Vec<f64>)| effect.is_read_beside() && is_new(effect.name());
    with.effects.extend(end.hypothesis.fitted().effects.into_iter().filter(read));
    let others = with.effects[own.effects.len()..].iter().map(|(_, numbers)| numbers.len()).sum();
    is_worse(&own, 0) && (others == 0 || is_worse(&with, others))
}
