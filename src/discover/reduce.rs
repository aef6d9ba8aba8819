//! Backward steps of the selection: fewer additions, or simpler ones in their place.

use super::hypothesis::{Addition, Hypothesis, compatible, extended};
use super::known::Known;
use super::options::MARGIN;
use super::select::{CONTINUED, Search};
use crate::fit::{Fit, Problem, values_in};
use crate::model::Model;
use crate::solver::cycle::Tolerance;

impl Search<'_> {
    /// Removes additions that the others make needless; the last may merely have helped an earlier one out of a local
    /// minimum. What leaves structure is judged by what it leaves, not by the noise: there the last one may go, too.
    pub(super) fn eliminate(&self, chosen: Hypothesis) -> Hypothesis {
        let least = usize::from(self.unit(&chosen) == 1.0);
        self.eliminate_to(least, chosen)
    }

    /// The same down to so many of them.
    pub(super) fn eliminate_to(&self, least: usize, chosen: Hypothesis) -> Hypothesis {
        let unit = self.unit(&chosen);
        let mut chosen = chosen;
        let mut index = 0;
        while chosen.additions.len() > least && index < chosen.additions.len() {
            let mut additions = chosen.additions.clone();
            additions.remove(index);
            let mut fewer = self.refit(&chosen, additions);
            self.settle_all(vec![&mut fewer], &chosen);
            if self.score(unit, &fewer) < self.score(unit, &chosen) + MARGIN {
                chosen = fewer;
                index = 0;
            } else {
                index += 1;
            }
        }
        chosen
    }

    /// The hypothesis with that of its additions first which explains most by itself.
    pub(super) fn ordered(&self, chosen: Hypothesis, known: &Known) -> Hypothesis {
        if chosen.additions.len() < 2 {
            return chosen;
        }
        let alone = |addition: &Addition| {
            let all = known.with(&[*addition]).into_iter().chain([self.refit(&chosen, vec![*addition])]);
            all.map(|h| self.bic(1.0, &h)).fold(f64::INFINITY, f64::min)
        };
        let alone: Vec<f64> = chosen.additions.iter().map(alone).collect();
        let Some(first @ 1..) = (0..alone.len()).min_by(|a, b| alone[*a].total_cmp(&alone[*b])) else { return chosen };
        let mut additions = chosen.additions.clone();
        additions[..=first].rotate_right(1);
        self.moved(&chosen, &chosen.fitted(), additions)
    }

    /// The hypothesis with only these additions, fitted from the values it has.
    pub(super) fn refit(&self, from: &Hypothesis, additions: Vec<Addition>) -> Hypothesis {
        self.data.fitted(self.moved(from, &from.fitted(), additions), self.data.last_effort(CONTINUED))
    }

    /// The hypothesis with these additions in place of its own, at the values that it has and that effects have in a
    /// model.
    pub(super) fn moved(&self, from: &Hypothesis, fitted: &Model, additions: Vec<Addition>) -> Hypothesis {
        let mut model = extended(&self.data.base, &additions);
        for (effect, values) in &mut model.effects {
            if let Some((_, own)) = fitted.effects.iter().find(|(e, _)| e.name() == effect.name()) {
                values.clone_from(own);
            }
        }
        let mut fit = from.fit.clone();
        let at = Model { effects: model.effects.clone(), ..from.fitted() };
        fit.parameters = self.data.movable(&at, &additions);
        let value = |key: &str| from.fit.parameters.iter().position(|p| p.key == key).map(|i| from.fit.values[i]);
        let own = values_in(&model, &fit.parameters);
        let values = fit.parameters.iter().zip(own).map(|(p, own)| value(&p.key).unwrap_or(own)).collect();
        self.at(&Hypothesis { additions, model, fit, estimate: None, bic: f64::INFINITY }, values)
    }

    /// A hypothesis at other values of its parameters, at all points.
    pub(super) fn at(&self, hypothesis: &Hypothesis, values: Vec<f64>) -> Hypothesis {
        let Hypothesis { model, fit, .. } = hypothesis;
        let points = self.data.some(self.data.points.len());
        let mut problem = Problem::new(model.clone(), points, fit.parameters.clone(), Tolerance::FIT);
        let evaluation = problem.evaluate(&values, true);
        self.data.count(problem.solved);
        Hypothesis { fit: Fit { values, evaluation, ..fit.clone() }, ..hypothesis.clone() }
    }

    /// Puts the simpler effect that one is with a parameter at a value, or acts like, in its place, fitted from where
    /// that is, unless the data tell the two apart: a race may have ended beside the minimum of the simpler one.
    pub(super) fn simplified(&self, chosen: Hypothesis, known: &mut Known) -> Hypothesis {
        let mut chosen = chosen;
        for index in 0..chosen.additions.len() {
            let mut model = chosen.fitted();
            let own = model.effects.iter().find(|(effect, _)| effect.name() == chosen.additions[index].name());
            let Some((name, values)) = own.and_then(|(effect, values)| effect.simpler(values, &self.data.base.scales))
            else {
                continue;
            };
            let Some(&simple) = self.pool.iter().find(|a| a.name() == name && !chosen.additions.contains(a)) else {
                continue;
            };
            let Addition::Effect(effect) = simple else { continue };
            model.effects.push((effect, values));
            let mut additions = chosen.additions.clone();
            additions[index] = simple;
            if !compatible(&self.data.base, &additions) {
                continue;
            }
            let simpler = self.moved(&chosen, &model, additions);
            let mut simpler = self.data.fitted(simpler, self.data.last_effort(4 * CONTINUED));
            self.settle_all(vec![&mut simpler], &chosen);
            known.improve(&simpler);
            let unit = self.unit(&chosen);
            if self.score(unit, &simpler) < self.score(unit, &chosen) + MARGIN {
                chosen = simpler;
            }
        }
        chosen
    }
}
