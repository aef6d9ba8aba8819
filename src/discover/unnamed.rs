//! What is said beside a discovery of laws that the catalogue does not name.

use super::{Discovery, Step, Verdict};
use crate::fit::operation;
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
    drifts && free_form::analyse(&base.comparison).classes.iter().any(does)
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
