//! What has to be known of an explanation, beside its verdict.

use super::Step;
use super::hypothesis::{Addition, Hypothesis};
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

/// That a drift of nothing but the gain, which follows the drive, is more likely the transducer's or the amplifier's.
pub(super) fn of_gain_alone(end: &Step) -> Option<String> {
    let c = &end.comparison;
    let of = |key: char, series: usize| {
        let key = format!("effect.drift.{key}_{}", series + 1);
        c.fit.parameters.iter().position(|p| p.key == key).map(|at| c.intervals[at])
    };
    let series = &c.table.series;
    let stays = |series: usize| of('d', series).is_some_and(|i| i.low <= 0.0 && 0.0 <= i.high);
    if series.len() < 3 || !(1..series.len()).all(stays) {
        return None;
    }
    let first = Interval { low: 0.0, high: 0.0, value: 0.0, ..of('g', 1)? };
    let gains = (0..series.len()).map(|number| if number == 0 { Some(first) } else { of('g', number) });
    let mut gains: Vec<(f64, Interval)> =
        series.iter().map(|s| s.drive).zip(gains.collect::<Option<Vec<_>>>()?).collect();
    gains.sort_by(|a, b| a.0.total_cmp(&b.0));
    let falls = |sign: f64| {
        let pairs = || gains.windows(2);
        let ends = [gains[0].1, gains[gains.len() - 1].1];
        let [low, high] = ends.map(|i| if sign > 0.0 { (i.low, i.high) } else { (-i.high, -i.low) });
        pairs().all(|pair| pair[0].0 < pair[1].0 && sign * (pair[0].1.value - pair[1].1.value) > 0.0) && high.1 < low.0
    };
    let how = if falls(1.0) {
        "falls"
    } else if falls(-1.0) {
        "rises"
    } else {
        return None;
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
