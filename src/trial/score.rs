//! A search against the answer.

use super::answer::Answer;
use super::cause::Kind;
use super::examine::Found;
use crate::dual::Dual;
use crate::effects::{ParameterInfo, find, typical};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A planted parameter beside its estimate.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Share {
    /// Its key.
    pub key: String,
    /// What was planted.
    pub truth: f64,
    /// Estimate.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether the data bound it from both sides.
    pub identified: bool,
    /// Whether the interval holds the truth.
    pub covered: bool,
    /// Estimate over truth, less one; where the truth is near zero, the difference.
    pub bias: f64,
}

/// How a search did; `None` where a question does not arise for the sort of cause.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct Score {
    /// The verdict is right.
    pub verdict: bool,
    /// The effect added first is a planted one.
    pub first: Option<bool>,
    /// Every planted effect is named, or not told apart from one that is.
    pub named: Option<bool>,
    /// The verdict is right, exactly the planted effects are named, and nothing but what was planted is recalibrated.
    pub exact: Option<bool>,
    /// Something was found where nothing is.
    pub false_alarm: Option<bool>,
    /// A cause outside the catalogue is left as unexplained.
    pub flagged: Option<bool>,
    /// The right number is recalibrated or not told apart from the one that is, and no effect is named.
    pub recalibration: Option<bool>,
    /// Root mean square error of the calibrated base over the noise.
    pub base_error: f64,
    /// The same of the explanation; 1 is the noise floor.
    pub final_error: f64,
    /// Planted parameters that the explanation has, where it names what was planted and nothing else.
    pub parameters: Vec<Share>,
}

/// Compares what was found with what was planted.
pub fn score(answer: &Answer, found: &Found) -> Score {
    let tied = |wanted: &str, names: &[String]| {
        let with = |group: &&Vec<String>| group.iter().any(|g| g == wanted) && names.iter().any(|n| group.contains(n));
        names.iter().any(|n| n == wanted) || found.indistinguishable.iter().any(|g| with(&g))
    };
    let all: Vec<String> = found.effects.iter().chain(&found.recalibrate).cloned().collect();
    let (mut planted, mut effects) = (answer.effects.clone(), found.effects.clone());
    planted.sort();
    effects.sort();
    let has_effects = matches!(answer.kind, Kind::Effect | Kind::Pair);
    let same = match (&answer.recalibrate, answer.kind) {
        (_, Kind::Outside) => false,
        (Some(key), _) => found.effects.is_empty() && found.recalibrate == [key.clone()],
        (None, _) => planted == effects && found.recalibrate.is_empty(),
    };
    let noise = found.noise_percent.max(1e-12);
    let ratio = |rung: Option<&super::examine::Rung>| rung.map_or(f64::NAN, |r| r.rms_error_percent / noise);
    let verdict = found.verdict == answer.kind.verdict();
    Score {
        verdict,
        first: has_effects.then(|| found.effects.first().is_some_and(|name| answer.effects.contains(name))),
        named: has_effects.then(|| answer.effects.iter().all(|name| tied(name, &all))),
        exact: (answer.kind != Kind::Outside).then_some(verdict && same),
        false_alarm: (answer.kind == Kind::None).then_some(found.verdict != "nothing-missing"),
        flagged: (answer.kind == Kind::Outside).then_some(found.verdict == "unexplained"),
        recalibration: answer.recalibrate.as_ref().map(|key| found.effects.is_empty() && tied(key, &all)),
        base_error: ratio(found.steps.first()),
        final_error: ratio(found.steps.last()),
        parameters: if same { shares(answer, found) } else { Vec::new() },
    }
}

/// Whether a number holds at a load, a time or a speed that a search keeps where it likes: such numbers of two places
/// cannot be held against each other.
fn is_stated_at_a_place(key: &str, effects: &[String]) -> bool {
    let planted = effects.iter().filter_map(|name| find(name));
    let mut placed = planted.filter(|effect| effect.parameters().iter().any(|info| info.held));
    placed.any(|effect| {
        let p: Vec<Dual> = typical(effect).into_iter().map(Dual::constant).collect();
        let own = |info: &ParameterInfo| key == format!("effect.{}.{}", effect.name(), info.key) && info.unit != "1";
        let of_contact = effect.contact_factor(&p, Dual::constant(1.0)).is_some();
        effect.parameters().iter().any(own) || (of_contact && key.starts_with("contact."))
    })
}

fn shares(answer: &Answer, found: &Found) -> Vec<Share> {
    let beside = |(key, &truth): (&String, &f64)| {
        let e = found.parameters.get(key).filter(|_| !is_stated_at_a_place(key, &answer.effects))?;
        let slack = 1e-12 * truth.abs();
        Some(Share {
            key: key.clone(),
            truth,
            value: e.value,
            low: e.low,
            high: e.high,
            identified: e.identified == "yes",
            covered: e.low - slack <= truth && truth <= e.high + slack,
            bias: if truth == 0.0 { e.value } else { e.value / truth - 1.0 },
        })
    };
    answer.parameters.iter().filter_map(beside).collect()
}

#[cfg(test)]
mod tests {
    use super::is_stated_at_a_place;

    #[test]
    fn numbers_that_hold_at_a_place_are_not_held_against_those_of_another() {
        let placed = |effect: &str, key: &str| is_stated_at_a_place(key, &[effect.to_string()]);
        assert!(placed("load-stiffening", "contact.stiffness") && placed("load-stiffening", "contact.damping"));
        assert!(placed("spring-pot", "effect.spring-pot.c_a") && placed("power-damping", "effect.power-damping.D"));
        for (effect, key) in [
            ("load-stiffening", "effect.load-stiffening.m"),
            ("spring-pot", "effect.spring-pot.a"),
            ("spring-pot", "contact.stiffness"),
            ("maxwell-branch", "effect.maxwell-branch.k_1"),
        ] {
            assert!(!placed(effect, key), "{key}");
        }
    }
}
