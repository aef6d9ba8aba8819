//! The atlas over the whole registry: complete, nested in the base, finite, drawn.

#[path = "figures/layout.rs"]
mod layout;

use stickslip::atlas::{self, CONDITIONS, Entry};
use stickslip::effects::{Effect, REGISTRY, fits_rig};
use stickslip::model::Model;
use stickslip::solver::Status;
use stickslip::solver::cycle::Tolerance;
use stickslip::{figures, scenario};

/// The effects that act on the paper's rig.
fn beside_contact() -> impl Iterator<Item = &'static &'static dyn Effect> {
    REGISTRY.iter().filter(|effect| fits_rig(**effect, true).is_ok())
}

#[test]
fn every_effect_has_its_entry_with_finite_numbers_and_its_figure() {
    let entries = atlas::run(&scenario::paper());
    assert!(entries.iter().map(|entry| entry.effect.name()).eq(beside_contact().map(|effect| effect.name())));
    for Entry { effect, base, strengths } in &entries {
        assert!(base.len() == CONDITIONS.len() && strengths.len() >= 3, "{}", effect.name());
        for state in base.iter().flat_map(|curve| &curve.states) {
            assert_eq!(state.status, Status::Steady, "the base");
        }
        for curve in base.iter().chain(strengths.iter().flat_map(|strength| &strength.curves)) {
            assert!(curve.states.len() >= 20 && curve.states.len() == curve.frequency.len(), "{}", effect.name());
            for state in curve.states.iter().filter(|state| state.status == Status::Steady) {
                assert!(state.amplitude.is_finite() && state.phase.is_finite(), "{}: {state:?}", effect.name());
            }
        }
    }
    for entry in &entries {
        let drawing = figures::atlas::draw(entry).unwrap();
        assert_eq!(drawing, figures::atlas::draw(entry).unwrap());
        assert!(drawing.caption.ends_with(entry.effect.fingerprint()));
        layout::check_drawing("atlas", &drawing);
        assert_eq!(
            layout::rows(&drawing).len(),
            (1 + entry.strengths.len()) * CONDITIONS.len() * entry.base[0].states.len()
        );
    }
}

#[test]
fn zero_strength_is_the_base() {
    let bare = Model::new(&scenario::paper());
    let with = |effect: &&'static dyn stickslip::effects::Effect| {
        let mut parameters = atlas::strengths(*effect).swap_remove(0);
        for zero in effect.zero() {
            parameters[zero.parameter] = zero.value.min(1e12);
        }
        Model { effects: vec![(*effect, parameters)], ..bare.clone() }
    };
    let effects: Vec<_> = beside_contact().filter(|effect| !effect.zero().is_empty()).collect();
    let models: Vec<Model> = std::iter::once(bare.clone()).chain(effects.iter().map(|e| with(e))).collect();
    let curves = atlas::curves(&models, &Tolerance::default());
    for (effect, with) in effects.iter().zip(&curves[1..]) {
        for (a, b) in with.iter().flat_map(|c| &c.states).zip(curves[0].iter().flat_map(|c| &c.states)) {
            let error = (a.amplitude / b.amplitude - 1.0).abs();
            assert!(error < 1e-5, "{}: {error:e}, {:?}", effect.name(), a.status);
        }
    }
}
