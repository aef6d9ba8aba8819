//! A model put where the readings resonate, as far as its numbers may move.

use super::resonance::of_all;
use crate::dual::Dual;
use crate::measurement::Point;
use crate::model::lumps::Lumps;
use crate::model::{Model, Operation};
use crate::scenario::{Dissipation, Elasticity, Oscillator, Rig};
use crate::statistics::wrap;
use std::f64::consts::TAU;

/// The model with those of its numbers that are `free` to move where the resonance of the readings puts them; `None`
/// for the paper's kind of rig, whose contact makes most of its resonance, and where no resonance is seen.
pub fn started(model: &Model, free: &[String], points: &[Point]) -> Option<Model> {
    let Rig::Oscillator(_) = model.rig else { return None };
    let seen = of_all(points, model.signals.reading.order)?;
    let mut model = model.clone();
    let typical = points.iter().min_by(|a, b| {
        let distance = |p: &Point| (p.frequency / seen.frequency).ln().abs();
        distance(a).total_cmp(&distance(b))
    })?;
    let at = Operation { speed: 0.0, load: 0.0, drive: typical.drive, frequency: seen.frequency, series: 0 };
    let Rig::Oscillator(rig) = &mut model.rig else { return None };
    put(rig, free, seen.frequency, seen.quality);
    let reading = |model: &Model| {
        let lumps = Lumps::new(model, &at);
        lumps.reading(lumps.free_response())
    };
    let ratio = seen.peak * at.drive / reading(&model).0;
    if !(ratio.is_finite() && ratio > 0.0) {
        return None;
    }
    let mut model = scaled(&model, free, ratio);
    if let Some(phase) = seen.phase.filter(|_| free.iter().any(|key| key == PHASE)) {
        model.instrument.phase_offset = wrap(model.instrument.phase_offset + phase - reading(&model).1);
    }
    Some(model)
}

/// Key of what turns all phases.
pub const PHASE: &str = "instrument.phase_offset";

/// The model with readings so many times as large, as far as its numbers are `free`.
pub fn scaled(model: &Model, free: &[String], ratio: f64) -> Model {
    let mut model = model.clone();
    let is_free = |key: &str| free.iter().any(|k| k == key);
    // Of numbers that do the same one moves.
    let mass = is_free("rig.mass") || is_free("rig.inertia");
    if let (Rig::Oscillator(rig), true) = (&mut model.rig, mass) {
        rig.mass /= ratio;
        if rig.elasticity_form == Elasticity::Stiffness {
            rig.elasticity /= ratio;
        }
        if rig.dissipation_form == Dissipation::Damping {
            rig.dissipation /= ratio;
        }
    } else if is_free("instrument.amplitude_gain") || is_free("instrument.sensitivity") {
        model.instrument.amplitude_gain *= ratio;
    } else if is_free("instrument.drive_gain") {
        model.instrument.drive_gain *= ratio;
    } else if is_free("instrument.drive_sensitivity") {
        model.instrument.drive_gain /= ratio;
    }
    model
}

/// Gives a rig a natural frequency \[Hz\] and a quality factor as far as its numbers are `free`.
fn put(rig: &mut Oscillator, free: &[String], frequency: f64, quality: f64) {
    let is_free = |key: &str| free.iter().any(|k| k == key);
    match rig.elasticity_form {
        Elasticity::NaturalFrequency if is_free("rig.natural_frequency") => rig.elasticity = frequency,
        Elasticity::Stiffness if is_free("rig.stiffness") => rig.elasticity = rig.mass * (TAU * frequency).powi(2),
        _ => {}
    }
    let critical = (rig.mass * rig.stiffness()).sqrt();
    match rig.dissipation_form {
        Dissipation::QualityFactor if is_free("rig.quality_factor") => rig.dissipation = quality,
        Dissipation::DampingRatio if is_free("rig.damping_ratio") => rig.dissipation = 0.5 / quality,
        Dissipation::Damping if is_free("rig.damping") => rig.dissipation = critical / quality,
        _ => {}
    }
}

/// The model with as much stiffness and damping taken from those of its numbers that are `free` as its readings
/// resonate higher and broader than others do, both at the same places: what was added to it replaces a part of the
/// rig. Of the paper's kind of rig that is a contact in series with a support. `None` where no resonance is seen, and
/// where there is not as much stiffness.
pub fn kept(model: &Model, free: &[String], without: &[Point], with: &[Point]) -> Option<Model> {
    let mut model = model.clone();
    let order = model.signals.reading.order;
    let Rig::Oscillator(rig) = &mut model.rig else { return stiffer_in_series(model, free) };
    let (before, after) = (of_all(without, order)?, of_all(with, order)?);
    let (stiffness, damping) = (rig.stiffness(), rig.damping());
    let frequency = (stiffness / rig.mass).sqrt() / TAU;
    let square = frequency.powi(2) + before.frequency.powi(2) - after.frequency.powi(2);
    let loss = damping / (rig.mass * stiffness).sqrt();
    let less = loss + 1.0 / before.quality - 1.0 / after.quality;
    let loss = if less > 0.0 { less } else { loss };
    put(rig, free, Some(square).filter(|square| *square > 0.0)?.sqrt(), 1.0 / loss);
    Some(model)
}

/// The model with a contact that is stiffer by what its support gives way, where its stiffness is `free`: both in
/// series are as stiff as the contact was, and, where its damping is free, of the same loss.
fn stiffer_in_series(mut model: Model, free: &[String]) -> Option<Model> {
    let is_free = |key: &str| free.iter().any(|k| k == key);
    let support = model.effects.iter().rev().find_map(|(effect, p)| {
        let p: Vec<Dual> = p.iter().map(|value| Dual::constant(*value)).collect();
        effect.support(&p)
    })?;
    let share = 1.0 - model.contact.stiffness / support.stiffness.value;
    if !(is_free("contact.stiffness") && share > 0.0) {
        return None;
    }
    model.contact.stiffness /= share;
    if is_free("contact.damping") {
        model.contact.damping /= share * share;
    }
    Some(model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    #[test]
    fn contact_and_support_in_series_are_as_stiff_and_as_lossy_as_the_contact_was() {
        let scenario = crate::scenario::load_embedded("paper/figure-2").expect("a scenario");
        let before = Model::new(&scenario);
        let free = ["contact.stiffness", "contact.damping"].map(String::from);
        let supported = |stiffness: f64| {
            let mut model = before.clone();
            model
                .effects
                .push((crate::effects::find("roller-compliance").expect("registered"), vec![0.01, stiffness, 0.0]));
            stiffer_in_series(model, &free)
        };
        let k = before.contact.stiffness;
        let after = supported(1.7 * k).expect("stiff enough");
        let in_series = |stiffness: f64, damping: f64| {
            let (contact, support) = (Complex::new(stiffness, damping), Complex::new(1.7 * k, 0.0));
            contact * support / (contact + support)
        };
        // At a frequency so low that the damping is a small loss.
        let small = 1e-6 * k / before.contact.damping;
        let whole = in_series(after.contact.stiffness, small * after.contact.damping);
        assert!((whole.re / k - 1.0).abs() < 1e-9, "{whole}");
        assert!((whole.im / (small * before.contact.damping) - 1.0).abs() < 1e-9, "{whole}");
        assert!(supported(0.9 * k).is_none());
    }
}
