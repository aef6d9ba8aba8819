//! What may be wrong with a model: a number of the rig or the instrument, or an effect that is missing; alone or
//! together.

use super::candidates::Candidates;
use crate::effects::{self, Effect, find, middle};
use crate::fit::{Fit, model_with, parameter, robust_square, typical_of};
use crate::model::Model;
use crate::scenario::parameters::{base_keys, of_key};
use nalgebra::DVector;

/// One thing to add to a model.
#[derive(Clone, Copy)]
pub enum Addition {
    /// Let a parameter of the rig or the instrument move; its key, e.g. `rig.inertia`.
    Recalibration(&'static str),
    /// An effect of the catalogue, or a formula of the scenario.
    Effect(&'static dyn Effect),
}

impl Addition {
    /// Whether it is another effect with a parameter at a value.
    pub fn is_case_of(&self, other: &Self) -> bool {
        matches!((self, other), (Self::Effect(one), Self::Effect(other)) if other.contains().contains(&one.name()))
    }

    /// Name in tables and JSON.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Recalibration(key) => key,
            Self::Effect(effect) => effect.name(),
        }
    }

    /// What it is called in running text, of a torsional `arm` or an oscillator: `master curve of rubber (Grosch)`,
    /// `damping of the torsional spring`.
    pub fn title(&self, arm: bool) -> String {
        match self {
            Self::Recalibration(key) => of_key(key, arm).map_or(*key, |info| info.meaning).into(),
            Self::Effect(effect) => uncapital(effect.title()),
        }
    }

    /// Whether it is an effect.
    pub fn is_effect(&self) -> bool {
        matches!(self, Self::Effect(_))
    }

    /// Whether it has numbers of each series, which no other series tells: a drift.
    pub fn is_of_each_series(&self) -> bool {
        matches!(self, Self::Effect(effect) if effect.of_series().is_some())
    }

    /// Keys of the parameters that it lets move.
    pub fn keys(&self) -> Vec<String> {
        match self {
            Self::Recalibration(key) => vec![(*key).to_string()],
            Self::Effect(effect) => effect.keys(),
        }
    }
}

/// A title within a sentence.
fn uncapital(title: &str) -> String {
    let mut letters = title.chars();
    letters.next().into_iter().flat_map(char::to_lowercase).chain(letters).collect()
}

impl PartialEq for Addition {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl std::fmt::Debug for Addition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Everything that may be added to a model whose parameters `free` move already: first recalibrations, then those of
/// the `candidates` that fit its rig.
pub fn additions(model: &Model, free: &[String], with_phase: bool, candidates: &Candidates) -> Vec<Addition> {
    let movable = |key: &&'static str| {
        !key.starts_with("contact.")
            && !free.iter().any(|f| f == key)
            && (with_phase || *key != "instrument.phase_offset")
    };
    let keys = model
        .base_parameters()
        .into_iter()
        .filter_map(|(key, ..)| base_keys().iter().map(String::as_str).find(|k| *k == key));
    let mut all: Vec<Addition> = keys.filter(movable).map(Addition::Recalibration).collect();
    let absent = |effect: &&'static dyn Effect| !model.effects.iter().any(|(e, _)| e.name() == effect.name());
    let asked = |effect: &&'static dyn Effect| candidates.include(*effect);
    let sized = |effect: &&'static dyn Effect| has_size(model, *effect);
    all.extend(model.catalogue().filter(asked).filter(absent).filter(sized).map(Addition::Effect));
    all
}

/// Why effects that were asked for by name are not searched, in words.
pub fn not_searched(model: &Model, pool: &[Addition], candidates: &Candidates) -> Vec<String> {
    let why = |name: &&'static str| {
        let effect = find(name).filter(|_| !pool.iter().any(|addition| addition.name() == *name))?;
        let reason = if model.effects.iter().any(|(present, _)| present.name() == *name) {
            "the scenario has it already".to_string()
        } else {
            let fits = effects::fits_rig(effect, model.has_contact);
            let fits = fits.and_then(|()| effects::for_series(effect, model.scales.series).map(|_| ()));
            fits.err().unwrap_or_else(|| "the measurements leave it nothing to act on".to_string())
        };
        Some(format!("{name} was asked for and is not searched: {reason}"))
    };
    candidates.named().iter().filter_map(why).collect()
}

/// Whether the measurements give an effect a size to be looked for at: without any load on the contact some have none.
pub fn has_size(model: &Model, effect: &dyn Effect) -> bool {
    let most = |number| effect.search_range(number, &model.scales).1;
    (0..effect.parameters().len()).map(most).all(|most| most > 0.0 && most.is_finite())
}

/// A model with additions, as it is before a fit: effects at values in the middle of their ranges.
pub fn extended(model: &Model, additions: &[Addition]) -> Model {
    let mut model = model.clone();
    for addition in additions {
        if let Addition::Effect(effect) = addition {
            let middle = middle(*effect, &model.scales);
            model.effects.push((*effect, middle));
        }
    }
    model
}

/// Whether the additions go together and with what the model has.
pub fn compatible(model: &Model, additions: &[Addition]) -> bool {
    let mut all: Vec<&dyn Effect> = model.effects.iter().map(|(effect, _)| *effect as &dyn Effect).collect();
    for addition in additions {
        if let Addition::Effect(effect) = addition {
            all.push(*effect);
        }
    }
    effects::compatible(&all).is_ok()
}

/// Residuals that stand for those at all points, which its own fit has not reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Of some readings or all.
    pub residuals: DVector<f64>,
    /// By how much the sum of squares is larger over all readings.
    pub scale: f64,
    /// Where they come from.
    pub basis: Basis,
}

/// What the sum of squares of a hypothesis rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// A fit to all points.
    AllPoints,
    /// A fit to so many of them.
    SomePoints(usize),
    /// The derivatives at samples of the ranges; no fit was begun.
    Linear,
    /// The fit of a smaller hypothesis that it contains: its own came to a worse end.
    Contained,
}

impl Basis {
    /// In words, given the number of all points.
    pub fn words(self, points: usize) -> String {
        match self {
            Self::AllPoints => "all points".into(),
            Self::SomePoints(some) => format!("{some} of {points} points"),
            Self::Linear => "estimate only".into(),
            Self::Contained => "the smaller one in it".into(),
        }
    }
}

/// A model with additions, fitted.
#[derive(Debug, Clone)]
pub struct Hypothesis {
    /// What was added, in this order.
    pub additions: Vec<Addition>,
    /// The model before the fit (with the effects, at the signs of the fit).
    pub model: Model,
    /// The fit, to all points or to a part of them.
    pub fit: Fit,
    /// Where it was not fitted to all points, or not to its end: what its sum of squares over all would be.
    pub estimate: Option<Estimate>,
    /// Schwarz's criterion in the unit of the ranking, less a constant common to all hypotheses; smaller is better.
    pub bic: f64,
}

impl Hypothesis {
    /// The fitted model.
    pub fn fitted(&self) -> Model {
        model_with(&self.model, &self.fit.parameters, &self.fit.values)
    }

    /// Whether its fit is to all of so many points.
    pub fn is_full(&self, points: usize) -> bool {
        self.estimate.is_none() && self.fit.evaluation.predictions.len() == points
    }

    /// Sum of squares over all points, or what it would be.
    pub fn chi2(&self) -> f64 {
        self.over_all(DVector::norm_squared)
    }

    /// What its sum of squares rests on.
    pub fn basis(&self) -> Basis {
        self.estimate.as_ref().map_or(Basis::AllPoints, |estimate| estimate.basis)
    }

    /// What it leaves: residuals, and by how much their sum of squares is larger over all readings.
    pub(super) fn left(&self) -> (&DVector<f64>, f64) {
        self.estimate.as_ref().map_or((&self.fit.evaluation.residuals, 1.0), |e| (&e.residuals, e.scale))
    }

    /// Sum of squares over all points, or what it would be, in this unit; large ones count less.
    pub(super) fn square(&self, unit: f64) -> f64 {
        self.over_all(|residuals| robust_square(residuals, unit))
    }

    /// A sum of squares over all points, or what it would be: every parameter takes off one unit by chance, of a part
    /// of the readings as of all.
    fn over_all(&self, square: impl Fn(&DVector<f64>) -> f64) -> f64 {
        let (residuals, scale) = self.left();
        let by_chance = self.fit.parameters.len() as f64;
        scale * (square(residuals) + by_chance) - by_chance
    }

    /// Whether its sum of squares is the smaller one, large residuals counted as beside the smaller typical ones.
    pub(super) fn fits_better_than(&self, other: &Self) -> bool {
        let unit = typical_of(self.left().0).min(typical_of(other.left().0)).powi(2);
        self.square(unit) < other.square(unit)
    }

    /// The best fit of hypotheses, the first of equal ones.
    pub(super) fn best_fit(all: impl IntoIterator<Item = Self>) -> Option<Self> {
        all.into_iter().reduce(|best, other| if other.fits_better_than(&best) { other } else { best })
    }

    /// Whether another has the same additions, in whatever order.
    pub fn same_additions(&self, other: &Self) -> bool {
        self.within(other) && other.within(self)
    }

    /// Whether another has all its additions.
    pub fn within(&self, other: &Self) -> bool {
        self.additions.iter().all(|a| other.additions.contains(a))
    }

    /// Whether it is a special case of another, larger one: what that adds can be switched off, or has an effect of this
    /// one as a case of its own.
    pub fn nested_in(&self, other: &Self) -> bool {
        let mut rest: Vec<&Addition> = other.additions.iter().collect();
        let mut is_larger = rest.len() > self.additions.len();
        for addition in &self.additions {
            let same = rest.iter().position(|of| *of == addition);
            let Some(at) = same.or_else(|| rest.iter().position(|of| addition.is_case_of(of))) else { return false };
            is_larger |= same.is_none();
            rest.remove(at);
        }
        let switched_off = |a: &&Addition| match a {
            Addition::Effect(effect) => !effect.zero().is_empty(),
            Addition::Recalibration(_) => true,
        };
        is_larger && rest.iter().all(switched_off)
    }

    /// Names of the effects added, in order.
    pub fn effects(&self) -> Vec<String> {
        self.additions.iter().filter(|a| a.is_effect()).map(|a| a.name().to_string()).collect()
    }

    /// Keys recalibrated, in order.
    pub fn recalibrated(&self) -> Vec<String> {
        self.additions.iter().filter(|a| !a.is_effect()).map(|a| a.name().to_string()).collect()
    }

    /// All names, `nothing` where there are none.
    pub fn label(&self) -> String {
        match self.additions.as_slice() {
            [] => "nothing".into(),
            some => some.iter().map(Addition::name).collect::<Vec<_>>().join(" + "),
        }
    }
}

/// Number of parameters of a model that `keys` name and a fit can move.
pub fn count(model: &Model, keys: &[String]) -> usize {
    keys.iter().filter(|key| parameter(model, key).is_some()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every effect that contains another has it in the catalogue, and is not itself a case of that.
    #[test]
    fn cases_are_effects_and_no_circle() {
        let all: Vec<Addition> = effects::REGISTRY.iter().map(|effect| Addition::Effect(*effect)).collect();
        let mut cases = 0;
        for one in &all {
            let Addition::Effect(effect) = one else { continue };
            for name in effect.contains() {
                let case = Addition::Effect(find(name).expect("registered"));
                assert!(case.is_case_of(one) && !one.is_case_of(&case), "{name}");
                cases += 1;
            }
        }
        assert!(cases >= 3);
    }
}
