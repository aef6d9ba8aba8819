//! The strengths of planted causes, from a seed.

use super::cause::Cause;
use super::outside::Outside;
use crate::fit::parameter;
use crate::model::{Model, Operation};
use crate::parameter::ParameterInfo;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// The contact is drawn within this factor of what is stated.
const CONTACT_FACTOR: f64 = 1.3;
/// Magnitudes by which a number of the rig is off, relative.
const OFF: (f64, f64) = (0.01, 0.2);
/// The damping of a rig is known less well.
const DAMPING_OFF: (f64, f64) = (0.05, 1.0);
/// Magnitudes by which a phase is off \[rad\].
const PHASE_OFF: (f64, f64) = (0.01, 0.2);
/// Part of the largest magnitude that is drawn where a range starts at zero.
const SMALLEST: f64 = 1e-4;

/// A cause with its strength: what is measured.
#[derive(Debug, Clone)]
pub struct Planted {
    /// Rig, contact and effects as they are.
    pub model: Model,
    /// A cause outside the catalogue with its parameters.
    pub outside: Option<(&'static dyn Outside, Vec<f64>)>,
    /// Everything drawn, by key.
    pub parameters: BTreeMap<String, f64>,
}

impl std::fmt::Debug for dyn Outside {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// A stream of random numbers of its own for every purpose.
pub fn stream(words: &[&str]) -> Pcg64 {
    Pcg64::from_seed(*blake3::hash(words.join("\n").as_bytes()).as_bytes())
}

fn logarithmic(rng: &mut Pcg64, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.random::<f64>())
}

fn sign(rng: &mut Pcg64) -> f64 {
    if rng.random::<bool>() { 1.0 } else { -1.0 }
}

fn magnitude(rng: &mut Pcg64, info: &ParameterInfo) -> f64 {
    let (low, high) = info.range.unwrap_or((info.minimum.abs(), info.maximum));
    let value = logarithmic(rng, low.max(SMALLEST * high), high);
    if info.signed { sign(rng) * value } else { value }
}

/// A cause of a drawn strength in a rig whose contact is near what is stated.
pub fn draw(cause: &Cause, stated: &Model, rng: &mut Pcg64) -> Planted {
    let mut planted = Planted { model: stated.clone(), outside: None, parameters: BTreeMap::new() };
    for (key, value) in [
        ("contact.stiffness", &mut planted.model.contact.stiffness),
        ("contact.damping", &mut planted.model.contact.damping),
    ] {
        *value *= logarithmic(rng, 1.0 / CONTACT_FACTOR, CONTACT_FACTOR);
        planted.parameters.insert(key.into(), *value);
    }
    match cause {
        Cause::None => {}
        Cause::Recalibration(key) => {
            let value = off(&planted.model, key, rng);
            set(&mut planted.model, key, value);
            planted.parameters.insert((*key).into(), value);
        }
        Cause::Effects(effects) => {
            for effect in effects {
                let values: Vec<f64> = effect.parameters().iter().map(|info| magnitude(rng, info)).collect();
                for (info, value) in effect.parameters().iter().zip(&values) {
                    planted.parameters.insert(format!("effect.{}.{}", effect.name(), info.key), *value);
                }
                planted.model.effects.push((*effect, values));
            }
        }
        Cause::Outside(cause) => {
            let values: Vec<f64> = cause.parameters().iter().map(|info| magnitude(rng, info)).collect();
            for (info, value) in cause.parameters().iter().zip(&values) {
                planted.parameters.insert(format!("{}.{}", cause.name(), info.key), *value);
            }
            planted.outside = Some((*cause, values));
        }
    }
    planted
}

/// A value of a parameter that is not what is stated.
fn off(model: &Model, key: &str, rng: &mut Pcg64) -> f64 {
    let stated = value(model, key);
    let sign = sign(rng);
    let by = |rng: &mut Pcg64, (low, high): (f64, f64)| sign * logarithmic(rng, low, high);
    match key {
        "instrument.phase_offset" => stated + by(rng, PHASE_OFF),
        "rig.torsional_damping" => stated * (1.0 + by(rng, DAMPING_OFF)).max(0.1),
        _ => stated * by(rng, OFF).exp(),
    }
}

fn value(model: &Model, key: &str) -> f64 {
    let mut model = model.clone();
    slot(&mut model, key, |slot| *slot).unwrap_or(f64::NAN)
}

fn set(model: &mut Model, key: &str, value: f64) {
    slot(model, key, |slot| *slot = value);
}

fn slot<T>(model: &mut Model, key: &str, apply: impl FnOnce(&mut f64) -> T) -> Option<T> {
    let index = parameter(model, key)?.index;
    let mut at = Operation { speed: 0.0, load: 0.0, drive: 0.0, frequency: 0.0, series: 0 };
    model.parameter(&mut at, index).map(apply)
}
