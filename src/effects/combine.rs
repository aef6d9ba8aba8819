//! Which effects go together. The rules follow from what effects contribute, not from their names.

use super::{Beside, Branch, Effect, typical};
use crate::dual::{Dual, MAX_PARAMETERS};
use crate::parameter::FIRST_EFFECT_PARAMETER;

/// A test of what an effect contributes, at the parameters given.
type Contributes = fn(&dyn Effect, &[f64], &[Dual]) -> bool;

/// Contributions that the model has room for once, with their names in messages.
const SINGLE: &[(&str, Contributes)] = &[
    ("the element between interface and arm", |e, p, d| e.rate_element(d).is_some() || e.continuum(p).is_some()),
    ("an internal state of the interface", |e, p, _| e.interface_rate(p, 1.0, 1.0).is_some()),
    ("the heating of the interface", |e, _, d| e.heating(d).is_some()),
    ("a viscoelastic branch", |e, _, d| e.branch(d).is_some() || e.fractional(d, 1.0).is_some()),
    ("a hysteresis of the bristles", |e, p, _| remembers(e, p)),
    ("a joint to ground", |e, _, d| slips(e, d)),
    ("the support of the roller", |e, _, d| e.support(d).is_some()),
];

/// Whether these effects can act together; the error says which two cannot, and why.
pub fn compatible(effects: &[&dyn Effect]) -> Result<(), String> {
    for (what, contributes) in SINGLE {
        let mut having = effects.iter().filter(|effect| {
            let (p, d) = sample(**effect);
            contributes(**effect, &p, &d)
        });
        if let (Some(one), Some(other)) = (having.next(), having.next()) {
            return Err(format!(
                "`{}` and `{}` cannot be combined: each of them provides {what}",
                one.name(),
                other.name()
            ));
        }
    }
    one_set_of_bristles(effects)?;
    let parameters = effects.iter().map(|effect| effect.parameters().len()).sum::<usize>();
    let most = MAX_PARAMETERS - FIRST_EFFECT_PARAMETER;
    if parameters > most {
        return Err(format!("the effects have {parameters} parameters together, but there is room for {most}"));
    }
    Ok(())
}

/// Whether no effect changes the bristles on which another acts.
fn one_set_of_bristles(effects: &[&dyn Effect]) -> Result<(), String> {
    let rules: [(Contributes, Contributes); 4] = [
        (
            |e, p, _| e.bristle_force(p, 0.0, 0.0).is_some(),
            |e, p, d| {
                e.continuum(p).is_some() || e.support(d).is_some() || e.fractional(d, 1.0).is_some() || remembers(e, p)
            },
        ),
        (|e, p, _| remembers(e, p), |e, p, _| e.continuum(p).is_some()),
        (
            |e, p, d| {
                e.fractional(d, 1.0).is_some()
                    || e.further_branch(d).is_some()
                    || remembers(e, p)
                    || e.bristle_force(p, 0.0, 0.0).is_some()
            },
            |e, _, d| e.rate_element(d).is_some() || e.renewal(d, Dual::constant(1.0)).is_some(),
        ),
        (
            |e, _, d| e.further_branch(d).is_some(),
            |e, p, d| e.fractional(d, 1.0).is_some() || e.bristle_force(p, 0.0, 0.0).is_some(),
        ),
    ];
    for (acts, changes) in rules {
        let find = |which: Contributes| {
            effects.iter().find(|effect| {
                let (p, d) = sample(**effect);
                which(**effect, &p, &d)
            })
        };
        if let (Some(one), Some(other)) = (find(acts), find(changes)) {
            let (one, other) = (one.name(), other.name());
            return Err(format!(
                "`{one}` is a force of one set of bristles between arm and roller, and `{other}` changes these"
            ));
        }
    }
    Ok(())
}

/// Whether the force of the bristles depends on their history by a law without states.
pub fn remembers(effect: &dyn Effect, p: &[f64]) -> bool {
    effect.hysteresis(p, Branch::default(), 0.0).is_some()
}

/// Whether an effect is a force or a friction that is not linear in the motion.
pub fn is_law(effect: &dyn Effect, p: &[f64]) -> bool {
    let d: Vec<Dual> = p.iter().map(|&value| Dual::constant(value)).collect();
    effect.torque(p, 0.0, 0.0).is_some()
        || effect.friction(p, 1.0, 1.0).is_some()
        || effect.heating(&d).is_some()
        || effect.load_stiffness(&d).is_some()
}

/// Whether only the solver of sliders can carry an effect with these parameters.
pub fn slides(effect: &dyn Effect, p: &[f64]) -> bool {
    let d: Vec<Dual> = p.iter().map(|&value| Dual::constant(value)).collect();
    effect.continuum(p).is_some()
        || remembers(effect, p)
        || effect.fractional(&d, 1.0).is_some()
        || effect.further_branch(&d).is_some()
}

/// Whether an effect enters the equations of the contact or of its load.
pub fn enters_contact(effect: &dyn Effect) -> bool {
    let (p, d) = sample(effect);
    (effect.beside_contact() && SINGLE.iter().any(|(_, contributes)| contributes(effect, &p, &d)))
        || effect.friction(&p, 1.0, 1.0).is_some()
        || effect.load_stiffness(&d).is_some()
        || effect.renewal(&d, Dual::constant(1.0)).is_some()
        || effect.contact_factor(&d, Dual::constant(1.0)).is_some()
        || effect.bristle_force(&p, 0.0, 0.0).is_some()
        || effect.further_branch(&d).is_some()
        || remembers(effect, &p)
}

/// Whether an effect can act on a rig with or without a contact; the error says why not.
pub fn fits_rig(effect: &dyn Effect, contact: bool) -> Result<(), String> {
    let (p, _) = sample(effect);
    let of_contact = enters_contact(effect) || effect.continuum(&p).is_some();
    let name = effect.name();
    match (of_contact, effect.beside_contact()) {
        (true, _) if !contact => Err(format!("`{name}` is an effect of the contact, and the rig has none")),
        (_, false) if contact => Err(format!("`{name}` is solved for rigs without a [contact]")),
        _ => Ok(()),
    }
}

/// Whether the published procedure can carry an effect: only changes of the drive, of the linear damping and of the
/// reading.
pub fn in_paper_formulation(effect: &dyn Effect) -> bool {
    let (p, d) = sample(effect);
    let one = Dual::constant(1.0);
    let unit = Beside { omega: 1.0, stiffness: one, inertia: one, order: 0 };
    !enters_contact(effect)
        && effect.torque(&p, 0.0, 0.0).is_none()
        && !slips(effect, &d)
        && effect.beside(&d, &unit).is_none()
        && effect.of_series().is_none()
}

/// Whether an effect holds the body to the ground by friction.
fn slips(effect: &dyn Effect, d: &[Dual]) -> bool {
    effect.joint(d).is_some() || effect.dry_friction(d).is_some()
}

fn sample(effect: &dyn Effect) -> (Vec<f64>, Vec<Dual>) {
    let p = typical(effect);
    let d = p.iter().map(|&value| Dual::constant(value)).collect();
    (p, d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{REGISTRY, find};

    const EXCLUDED: [[&str; 2]; 8] = [
        ["lugre", "partial-slip"],
        ["friction-joint", "pivot-friction"],
        ["maxwell-branch", "spring-pot"],
        ["spring-pot", "lugre"],
        ["spring-pot", "contact-renewal"],
        ["berg-friction", "lugre"],
        ["berg-friction", "contact-renewal"],
        ["berg-friction", "partial-slip"],
    ];

    #[test]
    fn only_two_elements_of_the_contact_exclude_each_other() {
        for (i, one) in REGISTRY.iter().enumerate() {
            for other in &REGISTRY[..i] {
                let both = [one.name(), other.name()];
                let excluded = EXCLUDED.iter().any(|pair| pair.iter().all(|name| both.contains(name)));
                assert_eq!(compatible(&[*other, *one]).is_err(), excluded, "{both:?}");
            }
        }
        let lugre = find("lugre").expect("registered");
        assert!(compatible(&[lugre, lugre]).is_err());
        let message = compatible(&[find("partial-slip").expect("registered"), lugre]).expect_err("two elements");
        assert!(message.starts_with("`partial-slip` and `lugre` cannot be combined"), "{message}");
        let apart: Vec<&str> = EXCLUDED.iter().map(|pair| pair[0]).collect();
        let all: Vec<_> = REGISTRY.iter().copied().filter(|e| !apart.contains(&e.name())).collect();
        // Nothing but their number is against the rest together, and nothing against as many as there is room for.
        let message = compatible(&all).expect_err("more parameters than there is room for");
        assert!(message.contains("but there is room for"), "{message}");
        assert_eq!(compatible(&all[..all.len() / 2]), Ok(()));
    }

    #[test]
    fn the_published_procedure_carries_what_leaves_its_equations_alone() {
        let carried: Vec<_> = REGISTRY.iter().filter(|e| in_paper_formulation(**e)).map(|e| e.name()).collect();
        assert_eq!(carried, ["structural-damping", "actuator-lag", "sensor-delay"]);
    }
}
