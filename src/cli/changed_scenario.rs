//! The text that `stickslip add` writes: fitted numbers rounded to what is known of them, and proof that it says so.

use super::destination::{Job, Target};
use crate::compare;
use crate::discover::{Addition, Change};
use crate::effects::{Effect, ParameterInfo, typical};
use crate::error::{Error, Result};
use crate::fit::{Identified, Interval, Parameter};
use crate::measurement::Point;
use crate::model::Model;
use crate::scenario::diagnostic::whole_file;
use crate::scenario::edit::{Changes, Editable, Estimate};
use crate::scenario::{self, Contact, Scenario};
use crate::solver::cycle::Tolerance;

/// Rounding one parameter moves the predictions by at most half of this, in standard deviations, taken together.
const ROUNDING: f64 = 0.2;

/// Makes the change with values from the catalogue: whatever is wrong with the input shows before the fit.
pub fn trial(
    job: &Job<'_>,
    effect: &'static dyn Effect,
    scenario: &Scenario,
    file: &Editable,
    target: &Target,
) -> Result<()> {
    let one = |(key, (info, value)): (String, (&ParameterInfo, f64))| Estimate {
        key,
        value,
        unit: info.unit_for(scenario.rig.coordinate()),
        low: None,
        high: None,
        detectable_change: f64::INFINITY,
        contradicted: false,
    };
    let key = |info: &ParameterInfo| format!("effect.{}.{}", effect.name(), info.key);
    let infos = effect.parameters().iter();
    let values = infos.zip(typical(effect)).map(|pair| one((key(pair.0), pair))).filter(|_| !job.remove).collect();
    write(job, effect, scenario, values, file, target).map(|_| ())
}

/// The text with the fitted values.
pub fn fitted(
    job: &Job<'_>,
    effect: &'static dyn Effect,
    scenario: &Scenario,
    change: &Change,
    file: &Editable,
    target: &Target,
) -> Result<String> {
    let c = &change.after;
    let noise = c.overall.chi2_per_point.sqrt().max(1.0);
    let detectable_change = |column: usize| ROUNDING * noise / c.fit.evaluation.jacobian.column(column).norm();
    let pairs = c.fit.parameters.iter().zip(&c.intervals).enumerate();
    let one = |(column, (parameter, interval)): (usize, (&Parameter, &Interval))| Estimate {
        contradicted: c.whiteness.structured,
        ..estimate(parameter, interval, detectable_change(column))
    };
    let added = c.model.effects.iter().filter(|(own, _)| !job.remove && own.name() == effect.name());
    let numbers = added.flat_map(|(_, values)| effect.parameters().iter().zip(values));
    let coordinate = scenario.rig.coordinate();
    let held = numbers.filter(|(info, _)| info.held).map(|(info, &value)| held(effect, &info.on(coordinate), value));
    let values = pairs.map(one).chain(held).collect();
    write(job, effect, scenario, values, file, target)
}

/// A parameter that no fit moves.
fn held(effect: &dyn Effect, info: &ParameterInfo, value: f64) -> Estimate {
    Estimate {
        key: format!("effect.{}.{}", effect.name(), info.key),
        value,
        unit: info.unit,
        low: Some(value),
        high: Some(value),
        detectable_change: f64::INFINITY,
        contradicted: false,
    }
}

/// A fitted parameter; ends of its interval that are only bounds of the search are left out.
fn estimate(parameter: &Parameter, interval: &Interval, detectable_change: f64) -> Estimate {
    let bounds = parameter.bounds();
    let open = |end: f64| [bounds.0, bounds.1].iter().any(|&bound| parameter.natural_distance(end, bound) < 1e-6);
    let (low, high) = match interval.identified {
        Identified::Yes => (Some(interval.low), Some(interval.high)),
        Identified::No => (None, None),
        Identified::OneSided => {
            (Some(interval.low).filter(|low| !open(*low)), Some(interval.high).filter(|high| !open(*high)))
        }
    };
    Estimate {
        key: parameter.key.clone(),
        value: interval.value,
        unit: parameter.unit,
        low,
        high,
        detectable_change,
        contradicted: false,
    }
}

/// The changed text, once it is known to be a scenario that differs from the one at hand in nothing else.
fn write(
    job: &Job<'_>,
    effect: &'static dyn Effect,
    before: &Scenario,
    values: Vec<Estimate>,
    file: &Editable,
    target: &Target,
) -> Result<String> {
    let keys = Addition::Effect(effect).keys();
    let mut free: Vec<String> = before.free.iter().filter(|key| !keys.contains(key)).cloned().collect();
    if !job.remove {
        free.extend(keys);
    }
    let name = effect.name().to_string();
    let (add, remove) = if job.remove { (None, Some(name)) } else { (Some(name), None) };
    // A formula is there already, without strength.
    let add = add.filter(|_| effect.formula().is_none());
    let changes = Changes {
        values,
        add,
        remove,
        free: free.clone(),
        extends: target.extends.clone(),
        table: target.table.clone(),
    };
    let text = file.apply(&changes)?;
    let after = scenario::load_text(&target.path, &text).map_err(|error| match error {
        Error::Input(why) => {
            let title = format!("the scenario as it would stand in {} is not valid", target.path.display());
            Error::Input(format!("{why}\n\n{}", whole_file(&title, "nothing was written; see above for what is wrong")))
        }
        other => other,
    })?;
    if !means(before, &after, &changes) || after.free != free {
        let title =
            format!("{} is written in a way that cannot be changed here; nothing was written", job.path.display());
        return Err(Error::Input(whole_file(&title, "write one key per line below [table] headers")));
    }
    Ok(text)
}

/// Whether one scenario is the other with these changes, and nothing else.
fn means(before: &Scenario, after: &Scenario, changes: &Changes) -> bool {
    let mut meant = before.clone();
    meant.effects.retain(|setting| changes.remove.as_deref() != Some(setting.name()));
    meant.effects.extend(after.effects.last().filter(|_| changes.add.is_some()).cloned());
    let laws =
        |scenario: &Scenario| scenario.effects.iter().map(|s| (s.name(), s.effect.equation())).collect::<Vec<_>>();
    let keys = meant.parameter_keys();
    let right = |(key, (old, new)): (&String, (f64, f64))| match changes.values.iter().find(|one| one.key == *key) {
        Some(one) => (new - one.value).abs() <= 0.1 * one.value.abs(),
        None => new == old,
    };
    let numbers = keys.iter().zip(numbers(&meant, &keys).into_iter().zip(numbers(after, &keys)));
    let place = |s: &Scenario| s.measurement.as_ref().and_then(|m| m.file.canonicalize().ok());
    // What the numbers above are, and what depends on the place of the file.
    let mut rest = after.clone();
    (rest.id, rest.path, rest.hash) = (before.id.clone(), before.path.clone(), before.hash.clone());
    (rest.rig, rest.instrument) = (before.rig, before.instrument);
    if let (Some(there), Some(here)) = (&mut rest.contact, &before.contact) {
        *there = Contact { formulation: there.formulation, ..*here };
    }
    (rest.effects, rest.free) = (before.effects.clone(), before.free.clone());
    if let (Some(there), Some(here)) = (&mut rest.measurement, &before.measurement) {
        there.file = here.file.clone();
    }
    if let (Some(there), Some(here)) = (&mut rest.sweep, &before.sweep)
        && after.contact.is_some_and(|contact| there.friction == [contact.friction])
    {
        there.friction = here.friction.clone();
    }
    numbers.into_iter().all(right) && laws(after) == laws(&meant) && rest == *before && place(after) == place(before)
}

/// Values of the parameters of these keys.
fn numbers(scenario: &Scenario, keys: &[String]) -> Vec<f64> {
    let none: [&Point; 0] = [];
    // What is free is part of the model, a formula without strength too.
    let scenario = Scenario { free: keys.to_vec(), ..scenario.clone() };
    compare::problem(&Model::new(&scenario), keys, none, Tolerance::default()).values()
}
