//! One effect that somebody has decided on: added to a scenario or taken away, everything fitted again.

use super::MARGIN;
use super::hypothesis::{Addition, Hypothesis};
use super::known::Known;
use super::options::SearchOptions;
use super::select::Search;
use crate::compare::{self, Comparison, calibrate};
use crate::effects::Effect;
use crate::measurement::Table;
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use std::sync::Arc;

/// A scenario's model before and after a change, each calibrated.
#[derive(Debug, Clone)]
pub struct Change {
    /// As `compare` finds it.
    pub before: Comparison,
    /// With the change, all its parameters fitted; intervals by profile likelihood.
    pub after: Comparison,
    /// Schwarz's criterion before less that after: positive where the data are for the change.
    pub gain: f64,
    /// What its squares are counted in: the less of both [`Comparison::unit`]s.
    pub unit: f64,
}

impl Change {
    /// Whether the data decide for the change, or against it; a model without a steady state at measured points where
    /// the other has one is none to decide for, whatever its sum of squares, nor is a larger one that leaves more of
    /// everything.
    pub fn decided(&self) -> Option<bool> {
        if self.leaves_more() {
            return None;
        }
        let (before, after) = (self.before.unsolved(), self.after.unsolved());
        match after.cmp(&before) {
            std::cmp::Ordering::Greater if self.gain > -MARGIN => None,
            std::cmp::Ordering::Less if self.gain < MARGIN => None,
            _ => (self.gain.abs() > MARGIN).then_some(self.gain > 0.0),
        }
    }

    /// Whether the model with more effects is preferred though chi2 and the error of the amplitude are larger with it,
    /// which only residuals that count little make possible: it contains the other, and could leave less.
    pub fn leaves_more(&self) -> bool {
        let (with, without) = match self.gain > 0.0 {
            true => (&self.after, &self.before),
            false => (&self.before, &self.after),
        };
        with.model.effects.len() > without.model.effects.len()
            && with.overall.chi2_per_point >= without.overall.chi2_per_point
            && with.overall.rms_error_percent >= without.overall.rms_error_percent
    }
}

/// Fits an effect together with the scenario's free parameters and those of the effects that it has.
pub fn fit_addition(scenario: &Scenario, table: &Table, effect: &'static dyn Effect, seed: u32) -> Change {
    let scenario = &table.applied_to(scenario);
    let before = compare::compare(scenario, table, &compare::Options { seed });
    let model = Model::new(scenario);
    let addition = Addition::Effect(effect);
    let keys = movable(scenario, "");
    let base = calibrate(&model, &keys, &table.points, Tolerance::default(), seed);
    let model = base.base.clone();
    // What somebody has decided on is fitted whatever a steady state costs.
    let options = SearchOptions { seed, budget: u64::MAX, ..SearchOptions::default() };
    let search = Search::new(scenario, table, (&options, &Arc::default()), &keys, model.clone());
    let from = Hypothesis { additions: Vec::new(), model, fit: base.fit, estimate: None, bic: f64::INFINITY };
    let best = search.add(&from, addition, &mut Known::default()).unwrap_or(from);
    let keys = keys.into_iter().chain(addition.keys()).collect::<Vec<_>>();
    conclude(scenario, table, before, best.fitted(), &keys, seed)
}

/// Takes an effect away and fits the scenario's free parameters and those of its other effects.
pub fn fit_removal(scenario: &Scenario, table: &Table, name: &str, seed: u32) -> Change {
    let scenario = &table.applied_to(scenario);
    let before = compare::compare(scenario, table, &compare::Options { seed });
    let mut model = before.model.clone();
    model.effects.retain(|(effect, _)| effect.name() != name);
    conclude(scenario, table, before, model, &movable(scenario, name), seed)
}

/// Keys that a fit moves: the free ones and all of the effects, those of `without` left out.
fn movable(scenario: &Scenario, without: &str) -> Vec<String> {
    let mut keys = scenario.free.clone();
    let present = || scenario.effects.iter().filter(|setting| !setting.is_candidate(&scenario.free));
    keys.extend(present().flat_map(|setting| setting.effect.keys()).filter(|key| !scenario.free.contains(key)));
    let gone: Vec<String> = present().filter(|s| s.name() == without).flat_map(|s| s.effect.keys()).collect();
    keys.retain(|key| !gone.contains(key));
    keys
}

/// The last fit is the one that `compare` will make of the scenario that is written.
fn conclude(
    scenario: &Scenario,
    table: &Table,
    before: Comparison,
    model: Model,
    keys: &[String],
    seed: u32,
) -> Change {
    let calibration = calibrate(&model, keys, &table.points, Tolerance::default(), seed);
    let after = compare::judge(scenario, table, &calibration, Some(compare::STATES));
    let unit = before.unit().min(after.unit());
    let criterion = |c: &Comparison| c.fit.schwarz(unit, c.overall.readings, table.freedom);
    let gain = criterion(&before) - criterion(&after);
    Change { before, after, gain, unit }
}
