//! What has to be known of an explanation, beside its verdict.

use super::Step;
use super::hypothesis::{Addition, Hypothesis};
use super::unnamed::of_drift;
use crate::fit::Interval;
use crate::measurement::{Direction, Series};

/// What has to be known of the effects that are named: what looks like them, and signs that leave no trace.
pub(super) fn of_named(chosen: &Hypothesis) -> Vec<String> {
    let named = chosen.additions.iter().filter_map(|a| match a {
        Addition::Effect(effect) if !effect.impersonator().is_empty() => Some(effect),
        _ => None,
    });
    let mut notes: Vec<String> =
        named.map(|effect| format!("of {}: {}", effect.name(), effect.impersonator())).collect();
    if chosen.effects().len() > 1 {
        notes.push(
            "of effects together: one law that the catalogue does not have may look like them; numbers that are tied or cancel \
             each other are a sign"
                .into(),
        );
    }
    let ends = chosen.fit.parameters.iter().zip(&chosen.fit.values);
    notes.extend(ends.filter(|(p, value)| p.key.starts_with("effect.") && p.at_bound(**value)).map(|(p, _)| {
        format!("{} is at the bound of its range: unless that is where its law ends, another law may do better", p.key)
    }));
    let hidden = (0..chosen.model.effects.len()).filter(|&index| chosen.model.hides_sign(index));
    for (effect, _) in hidden.map(|index| &chosen.model.effects[index]) {
        notes.extend(effect.parameters().iter().map(|info| {
            let key = format!("effect.{}.{}", effect.name(), info.key);
            format!("the sign of {key} leaves no trace in a fundamental: it is given as positive")
        }));
    }
    notes
}

/// That sweeps up and down may differ without a drift that is added, where that has both at one drive.
pub(super) fn of_both_ways(end: &Step) -> Option<String> {
    let series = &end.comparison.table.series;
    let is_both = |a: &Series| {
        let ways = (Direction::Up, Direction::Down);
        series.iter().any(|b| b.drive == a.drive && (a.direction, b.direction) == ways)
    };
    let drifts = end.hypothesis.additions.iter().any(Addition::is_of_each_series);
    (drifts && series.iter().any(is_both)).then(|| {
        "of drift: sweeps up and down at one drive differ as well where a reading lags behind the sweep, as a lock-in amplifier \
         or a rig that rings long does: sweep more slowly, and in turn, to tell"
            .into()
    })
}

/// That a drift of nothing but the gain is more likely the transducer's or the amplifier's: follows it the drive, of what is
/// not in proportion, else of a range or a sensitivity.
pub(super) fn of_gain_alone(end: &Step) -> Option<String> {
    let c = &end.comparison;
    let all = |key: char| (0..c.table.series.len()).map(|number| of_drift(c, key, number)).collect::<Option<Vec<_>>>();
    let (stiffness, mut gains) = (all('d')?, all('g')?);
    let is_none = |i: &Interval| i.low <= 0.0 && 0.0 <= i.high;
    if gains.len() < 3 || !stiffness.iter().all(is_none) || gains.iter().all(is_none) {
        return None;
    }
    let mut order: Vec<usize> = (0..gains.len()).collect();
    order.sort_by(|a, b| c.table.series[*a].drive.total_cmp(&c.table.series[*b].drive));
    let rises = order.windows(2).all(|pair| c.table.series[pair[0]].drive < c.table.series[pair[1]].drive);
    gains = order.into_iter().map(|number| gains[number]).collect();
    let falls = |of: fn(&Interval) -> [f64; 3]| {
        let ends = [&gains[0], &gains[gains.len() - 1]].map(of);
        rises && gains.windows(2).all(|pair| of(&pair[0])[1] > of(&pair[1])[1]) && ends[1][2] < ends[0][0]
    };
    let how = if falls(|i| [i.low, i.value, i.high]) {
        "falls"
    } else if falls(|i| [-i.high, -i.value, -i.low]) {
        "rises"
    } else {
        return Some(
            "of drift: only the gain differs from series to series: another range or sensitivity of what reads or drives \
             rather than another rig"
                .into(),
        );
    };
    Some(format!(
        "of drift: only the gain differs from series to series, and it {how} with the drive: what drives or what reads is not in \
         proportion (an amplifier at its limit, a saturating transducer) rather than another rig"
    ))
}

/// What the residuals of an explanation say, where its typical one is `unit` times the noise.
pub(super) fn of_what_is_left(end: &Step, unit: f64) -> Vec<String> {
    let mut notes = Vec::new();
    if unit > 1.0 {
        notes.push(format!(
            "what is left is {:.2} times the noise: BIC counts squares in that, not in the noise",
            unit.sqrt()
        ));
    }
    if !end.comparison.whiteness.testable {
        notes.push(
            "whether the residuals have structure cannot be tested: the series have too few neighbouring readings; no \
             verdict rests on its absence"
                .into(),
        );
    }
    notes.extend(end.comparison.notes.iter().cloned());
    let troubled = end.hypothesis.fit.evaluation.troubled();
    if troubled > 0 {
        notes.push(format!("{troubled} points have no steady state in the explanation; each counts as a misfit of at least 2 standard deviations, and as the others where these are worse"));
    }
    notes
}
