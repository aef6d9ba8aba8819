//! What is said beside a discovery of laws that the catalogue does not name.

use super::{Discovery, Step, Verdict};
use crate::compare::{Comparison, settings_of};
use crate::fit::{Identified, Interval, operation};
use crate::free_form::{self, FreeForm, MOST, Standing, Variable};
use crate::model::alone::Alone;

/// Any law of the amplitude, among names that the data do not tell apart.
pub const OF_AMPLITUDE: &str = "a law of the amplitude";

/// Whether some law of the amplitude does as well as a drift in the explanation, as where the response was held: each
/// series then has an amplitude of its own.
pub(super) fn is_drift_a_law_of_the_amplitude(base: &Step, end: &Step) -> bool {
    let drifts = end.hypothesis.additions.iter().any(|addition| addition.name() == "drift");
    let does = |class: &free_form::Dependence| {
        class.variables == [Variable::Amplitude] && [Standing::Leading, Standing::Tied].contains(&class.standing)
    };
    drifts && !differs_at_one_drive(&end.comparison) && free_form::analyse(&base.comparison).classes.iter().any(does)
}

/// What a drift adds to the stiffness (`d`) or the gain (`g`) of a series, as shares; nothing to the first.
pub(super) fn of_drift(c: &Comparison, key: char, series: usize) -> Option<Interval> {
    if series == 0 {
        return Some(Interval { value: 0.0, low: 0.0, high: 0.0, identified: Identified::Yes });
    }
    let key = format!("effect.drift.{key}_{}", series + 1);
    c.fit.parameters.iter().position(|p| p.key == key).map(|at| c.intervals[at])
}

/// Whether the stiffness has drifted between two sweeps one way at one setting, which have the same amplitudes: no law of
/// these does that.
fn differs_at_one_drive(c: &Comparison) -> bool {
    let (series, settings) = (&c.table.series, settings_of(&c.scenario, &c.table));
    let differ = |a: usize, b: usize| {
        let pair = of_drift(c, 'd', a).zip(of_drift(c, 'd', b));
        pair.is_some_and(|(a, b)| a.high < b.low || b.high < a.low)
    };
    let is_repeated = |a: usize, b: usize| {
        settings[a].is_alike(&settings[b]) && series[a].direction == series[b].direction && differ(a, b)
    };
    (0..series.len()).any(|b| (0..b).any(|a| is_repeated(a, b)))
}

/// The free form beside a discovery: where that leaves something unexplained, or where it is `wanted` whatever it
/// found. It stands on the calibrated base, not on what helps.
pub fn beside(discovery: &Discovery, wanted: bool) -> Option<FreeForm> {
    (wanted || discovery.verdict == Verdict::Unexplained).then(|| {
        let mut found = free_form::analyse(&discovery.steps[0].comparison);
        if let Some(text) = contradicted(discovery, &found) {
            found.classes.iter_mut().for_each(|class| class.standing = Standing::Undecided);
            found.shapes.clear();
            found.statement = text;
        }
        found
    })
}

/// That a law of the amplitude which was found explains most of what the class of the amplitude, which contains it,
/// could not: that was not followed to its minimum, and tells nothing. In words, where it is so.
fn contradicted(discovery: &Discovery, found: &FreeForm) -> Option<String> {
    let [base, first, ..] = &discovery.steps[..] else { return None };
    let class = found.classes.iter().find(|class| class.variables == [Variable::Amplitude])?;
    let at = operation(base.comparison.table.points.first()?);
    let is_law = !base.hypothesis.model.has_contact && !Alone::new(&first.hypothesis.model, &at).is_linear();
    let [before, left] = [base, first].map(|step| step.comparison.overall.rms_error_percent);
    let explained = 100.0 * (1.0 - (left / before).powi(2));
    (is_law && explained >= MOST && class.explained_percent < MOST).then(|| {
        format!(
            "on which variable what is missing depends is not told: smooth curves of the amplitude leave {:.1} % from the \
             calibrated base on, where {} leaves {left:.1} %",
            class.left_rms_percent,
            first.hypothesis.label()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::{SearchOptions, discover};
    use crate::free_form::Dependence;
    use crate::{measurement, scenario};

    #[test]
    fn a_class_that_is_worse_than_a_law_in_it_tells_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let table = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/oscillators/d.csv");
        std::fs::copy(table, folder.path().join("d.csv")).expect("a copy");
        let text = "title = 'd'\n[rig]\nkind = 'oscillator'\ndrive = 'force'\nmass = '3.02e-6 kg'\nnatural_frequency = '7957.7 Hz'\n\
             quality_factor = 300\n[measurement]\nfile = 'd.csv'\n[fit]\nfree = ['rig.mass', 'rig.natural_frequency', \
             'rig.quality_factor']\n";
        let path = folder.path().join("a.toml");
        std::fs::write(&path, text).expect("a file");
        let scenario = scenario::load(&path).expect("a scenario");
        let table = measurement::load(&scenario).expect("a table").expect("measurements");
        let d = discover(&scenario, &table, &SearchOptions::default());
        let mut found = beside(&d, true).expect("asked for");
        assert_eq!(found.leading().map(Dependence::name).as_deref(), Some("amplitude"));
        let class = found.classes.iter_mut().find(|class| class.variables == [Variable::Amplitude]);
        class.expect("the class").explained_percent = 0.0;
        let text = contradicted(&d, &found).expect("a damping explains more");
        assert!(text.contains("quadratic-damping leaves"), "{text}");
    }
}
