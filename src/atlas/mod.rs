//! What each effect of the registry does to resonance curves, by its strength, at the same few conditions.
//!
//! Only periodic states are sought, with the tolerance of a fit, whose errors are far below the width of a line: where
//! there is none, or it is unstable, a curve has a gap.

mod strength;

pub use strength::{strengths, varied};

use crate::effects::{Effect, REGISTRY, fits_rig, for_series};
use crate::model::Model;
use crate::scenario::DEFAULT_EULER_STEPS;
use crate::scenario::{Formulation, Scenario};
use crate::solver::cycle::Tolerance;
use crate::sweep::{Condition, Curve, curve};
use rayon::prelude::*;

/// Conditions of the atlas: their names for the base law, and (speed \[m/s\], load \[N\], drive \[m\]).
///
/// Rest is shown twice, because the printed load leaves no slip there: many effects show only in one of the two.
pub const CONDITIONS: [(&str, (f64, f64, f64)); 4] = [
    ("Rest, stuck", (0.0, 20.0, 2.5e-6)),
    ("Rest, slipping", (0.0, 0.1, 7.5e-6)),
    ("Partial stick", (5e-5, 20.0, 2.5e-6)),
    ("Full slip", (0.02, 20.0, 2.5e-6)),
];

/// Frequencies of the curves: from, to \[Hz\] and their number.
const FREQUENCIES: (f64, f64, usize) = (50.0, 100.0, 26);

/// Curves at one strength of an effect.
#[derive(Debug, Clone)]
pub struct Strength {
    /// Parameters of the effect in SI, in the order of the registry.
    pub parameters: Vec<f64>,
    /// One curve per condition.
    pub curves: Vec<Curve>,
}

/// One effect in the atlas.
#[derive(Clone)]
pub struct Entry {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// The curves without it, one per condition.
    pub base: Vec<Curve>,
    /// The curves with it, weakest first and negative before positive.
    pub strengths: Vec<Strength>,
}

/// An entry for every effect of the registry that acts on such a rig, on rig, contact and instrument of `scenario`; its
/// effects are left out. The result does not depend on the number of threads.
pub fn run(scenario: &Scenario) -> Vec<Entry> {
    let bare = Model { effects: Vec::new(), ..Model::new(scenario) };
    let fits = |effect: &&&'static dyn Effect| fits_rig(**effect, bare.has_contact).is_ok();
    // Of two series, the second of which is shown.
    let shown = || REGISTRY.iter().filter(fits).filter_map(|effect| for_series(*effect, 2).ok());
    let wanted: Vec<(&'static dyn Effect, Vec<f64>)> =
        shown().flat_map(|effect| strengths(effect).into_iter().map(move |parameters| (effect, parameters))).collect();
    let models: Vec<Model> = std::iter::once(bare.clone())
        .chain(wanted.iter().map(|with| Model { effects: vec![with.clone()], ..bare.clone() }))
        .collect();
    let mut curves = curves(&models, &Tolerance::FIT).into_iter();
    let base = curves.next().unwrap_or_default();
    let mut strengths = wanted.into_iter().zip(curves).peekable();
    let entry = |effect: &'static dyn Effect| {
        let own = |((other, _), _): &((&'static dyn Effect, Vec<f64>), Vec<Curve>)| other.name() == effect.name();
        let mut entry = Entry { effect, base: base.clone(), strengths: Vec::new() };
        while let Some(((_, parameters), curves)) = strengths.next_if(own) {
            entry.strengths.push(Strength { parameters, curves });
        }
        entry
    };
    shown().map(entry).collect()
}

/// The curves of every model at every condition.
pub fn curves(models: &[Model], tolerance: &Tolerance) -> Vec<Vec<Curve>> {
    let (from, to, count) = FREQUENCIES;
    let frequency: Vec<f64> = (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect();
    let tasks: Vec<(&Model, Condition)> =
        models.iter().flat_map(|model| CONDITIONS.map(|(_, at)| (model, condition(model, at)))).collect();
    let drawn = |(model, condition): &(&Model, Condition)| curve(model, condition, &frequency, tolerance);
    let solved: Vec<Curve> = tasks.par_iter().map(drawn).collect();
    solved.chunks(CONDITIONS.len()).map(<[Curve]>::to_vec).collect()
}

/// Of a second series: what drifts from series to series has done so.
fn condition(model: &Model, (speed, load, drive): (f64, f64, f64)) -> Condition {
    let (formulation, friction) = (Formulation::Series, model.contact.friction);
    Condition { formulation, euler_steps: DEFAULT_EULER_STEPS, drive, load, friction, speed, series: 1 }
}
