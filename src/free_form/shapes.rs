//! Which named laws have the shape: their describing functions in place of the curves.

use super::judge::{Judged, rms_percent};
use super::readings::Readings;
use crate::compare::Comparison;
use crate::effects::{Effect, compatible, middle};
use crate::fit::operation;
use crate::model::Model;
use crate::model::alone::Alone;
use crate::solver::describing::describing;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

/// Places along the range of each parameter at which a law is tried first.
const TRIED: usize = 9;
/// Steps of the refinement, each half as long as the last, of which ...
const HALVINGS: usize = 6;
/// Relative change of a force that is none: describing functions are as exact.
const SAME: f64 = 1e-3;

/// A named effect and how far it stays from what its class can reach.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Shape {
    /// The effect.
    pub effect: &'static str,
    /// Root mean square of the relative error in amplitude that it leaves with its best numbers \[%\].
    pub left_rms_percent: f64,
    /// The same over what the leading class leaves, less one \[%\].
    pub beyond_percent: f64,
    /// Share of what a constant leaves that it explains \[%\].
    pub explained_percent: f64,
}

/// The effects that are a stiffness and a damping of the body, fitted to the curves of a class; the nearest first.
pub fn shapes(c: &Comparison, readings: &Readings<'_>, judged: &Judged<'_>, leading: usize) -> Vec<Shape> {
    let present = |effect: &dyn Effect| c.model.effects.iter().any(|(e, _)| e.name() == effect.name());
    let usable: Vec<&'static dyn Effect> = c
        .model
        .catalogue()
        // What differs from series to series is a class, no shape.
        .filter(|effect| !present(*effect) && effect.of_series().is_none())
        .filter(|effect| {
            let mut all: Vec<&dyn Effect> = c.model.effects.iter().map(|(e, _)| *e as &dyn Effect).collect();
            all.push(*effect);
            compatible(&all).is_ok()
        })
        .collect();
    let of = |effect: &&'static dyn Effect| Law::of(c, readings, judged, leading, *effect)?.nearest();
    // What leaves as much as a constant alone has none of the shape.
    let is_nearer =
        |shape: &Shape| shape.explained_percent > 0.0 && shape.left_rms_percent < judged.tried[0].left_rms_percent;
    let mut found: Vec<Shape> = usable.par_iter().filter_map(of).filter(is_nearer).collect();
    found.sort_by(|a, b| b.explained_percent.total_cmp(&a.explained_percent).then(a.effect.cmp(b.effect)));
    found
}

/// An effect beside the model at the readings.
struct Law<'a> {
    readings: &'a Readings<'a>,
    judged: &'a Judged<'a>,
    leading: usize,
    base: &'a Model,
    effect: &'static dyn Effect,
    motion: Vec<f64>,
}

impl<'a> Law<'a> {
    /// The effect, where it is a stiffness or a damping of the body.
    fn of(
        c: &'a Comparison,
        readings: &'a Readings<'a>,
        judged: &'a Judged<'a>,
        leading: usize,
        effect: &'static dyn Effect,
    ) -> Option<Self> {
        let tried = &judged.tried[leading];
        let motion = tried.class.motion(&tried.fitted).iter().map(|ln| ln.exp()).collect();
        let law = Self { readings, judged, leading, base: &c.model, effect, motion };
        let there = law.force(&middle(effect, &c.model.scales));
        let is_force = there.iter().any(|[k, d]| k.abs() + d.abs() > 0.0);
        (is_force && (tried.class.may_follow_amplitude() || !law.follows_amplitude(&there))).then_some(law)
    }

    /// Whether the effect, which is this at the readings, is another where all of them move twice as much.
    fn follows_amplitude(&self, there: &[[f64; 2]]) -> bool {
        let motion = self.motion.iter().map(|motion| 2.0 * motion).collect();
        let twice = Self { motion, ..*self }.force(&middle(self.effect, &self.base.scales));
        let largest = there.iter().flatten().fold(0.0, |most: f64, part| most.max(part.abs()));
        there.iter().flatten().zip(twice.iter().flatten()).any(|(a, b)| (a - b).abs() > SAME * largest)
    }

    /// k and c of the effect at every reading, in units of the readings.
    fn force(&self, parameters: &[f64]) -> Vec<[f64; 2]> {
        let mut with = self.base.clone();
        with.effects.push((self.effect, parameters.to_vec()));
        let at = |(point, motion): (&&crate::measurement::Point, &f64)| {
            let of = |model: &Model| {
                let alone = Alone::new(model, &operation(point));
                let (k, c) = describing(&alone, *motion);
                let (omega, lumps) = (alone.lumps.omega, &alone.lumps);
                [k + lumps.stiffness.value, c / omega + lumps.damping.value]
            };
            let (with, without) = (of(&with), of(self.base));
            [0, 1].map(|i| (with[i] - without[i]) / self.readings.units[i])
        };
        self.readings.points.iter().zip(&self.motion).map(at).collect()
    }

    /// What the effect leaves at a place of its ranges (0 to 1 each), its strength being free; those held, which come
    /// last, have no place.
    fn shape(&self, place: &[f64]) -> Option<Shape> {
        let infos = self.effect.parameters();
        let value = |(number, info): (usize, &crate::effects::ParameterInfo)| {
            let Some(share) = place.get(number) else { return info.measure.size(&self.base.scales) };
            let (low, high) = self.effect.search_range(number, &self.base.scales);
            // From a range that begins at zero, three decades.
            let low = if low > 0.0 { low } else { 1e-3 * high };
            (low * (high / low).powf(*share)).clamp(info.minimum, info.maximum)
        };
        let parameters: Vec<f64> = infos.iter().enumerate().map(value).collect();
        let signed = infos.first().is_some_and(|info| info.signed);
        let tried = &self.judged.tried[self.leading];
        let residuals = tried.class.left_by(&tried.fitted, &self.force(&parameters), signed)?;
        let rms = rms_percent(self.readings, &residuals);
        Some(Shape {
            effect: self.effect.name(),
            left_rms_percent: rms,
            beyond_percent: 100.0 * (rms / tried.left_rms_percent - 1.0),
            explained_percent: self.judged.explained_by(&residuals),
        })
    }

    /// The best place: the strength needs none, of one more parameter a grid, of several a grid each and all together.
    fn nearest(&self) -> Option<Shape> {
        let free = self.effect.parameters().iter().filter(|info| !info.held).count();
        let mut best = vec![0.5; free];
        let mut found = self.shape(&best)?;
        let mut step = 1.0 / (TRIED - 1) as f64;
        let mut consider = |place: Vec<f64>, best: &mut Vec<f64>| {
            if let Some(shape) = self.shape(&place).filter(|s| s.explained_percent > found.explained_percent) {
                (found, *best) = (shape, place);
            }
        };
        if free > 1 {
            for _ in 0..free {
                for number in 0..free {
                    for share in 0..TRIED {
                        let mut place = best.clone();
                        place[number] = share as f64 * step;
                        consider(place, &mut best);
                    }
                }
            }
            for _ in 0..HALVINGS {
                step *= 0.5;
                for number in 0..free {
                    for direction in [-1.0, 1.0] {
                        let mut place = best.clone();
                        place[number] += direction * step;
                        consider(place, &mut best);
                    }
                }
            }
        }
        Some(found)
    }
}
