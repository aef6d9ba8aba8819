//! The scenario that `stickslip add` and `stickslip discover` write: fitted numbers rounded to what is known of them,
//! and proof that it says so.

use super::destination::{self, Target};
use crate::compare::{self, Comparison};
use crate::discover::Addition;
use crate::effects::{Effect, ParameterInfo, typical};
use crate::error::{Error, Result};
use crate::files;
use crate::fit::{Identified, Interval, Parameter};
use crate::measurement::Point;
use crate::model::Model;
use crate::scenario::diagnostic::whole_file;
use crate::scenario::edit::{Changes, Editable, Estimate};
use crate::scenario::{self, Contact, Scenario};
use crate::solver::cycle::Tolerance;
use std::path::Path;

/// Rounding one parameter moves the predictions by at most half of this, in standard deviations, taken together.
const ROUNDING: f64 = 0.2;

/// A scenario file and where its changed text goes.
pub struct Rewriting<'a> {
    path: &'a Path,
    file: Editable,
    target: Target,
}

impl<'a> Rewriting<'a> {
    /// Complains where that would destroy something, or the effects are stated in another file.
    pub fn begin(path: &'a Path, output: Option<&Path>, table: &Path) -> Result<Self> {
        let file = Editable::open(path)?;
        if let Some(other) = file.effects_elsewhere() {
            let title =
                format!("the effects of {} are stated in {}, which it extends", path.display(), other.display());
            let help = "use this command on that file, or copy its [[effect]] tables into this one first";
            return Err(Error::Input(whole_file(&title, help)));
        }
        let target = destination::find(path, output, &file, table)?;
        Ok(Self { path, file, target })
    }

    /// The text as it is.
    pub fn before(&self) -> &str {
        self.file.text()
    }

    /// Where the changed text goes.
    pub fn to(&self) -> &Path {
        &self.target.path
    }

    /// Writes the changed text, unless the file has changed meanwhile.
    pub fn write(&self, text: &str) -> Result<()> {
        self.target.unchanged(self.path, self.file.text())?;
        files::update(&self.target.path, format!("{}{text}", self.target.mark).as_bytes())
    }
}

/// What becomes of the model of a scenario.
pub struct Edit<'a> {
    /// The scenario as it is.
    pub scenario: &'a Scenario,
    /// Its file.
    pub file: &'a Rewriting<'a>,
    /// Effects that are put in, and moved by fits from then on.
    pub add: Vec<&'static dyn Effect>,
    /// An effect that is taken out.
    pub remove: Option<&'static dyn Effect>,
    /// Numbers of rig, contact or instrument that fits move from then on.
    pub numbers: Vec<String>,
}

impl<'a> Edit<'a> {
    /// No change yet.
    pub fn new(scenario: &'a Scenario, file: &'a Rewriting<'a>) -> Self {
        Self { scenario, file, add: Vec::new(), remove: None, numbers: Vec::new() }
    }

    /// Makes the change with values from the catalogue: whatever is wrong with the input shows before the fit.
    pub fn trial(&self) -> Result<()> {
        let coordinate = self.scenario.rig.coordinate();
        let of = |effect: &&'static dyn Effect| {
            let one = |(info, value): (&ParameterInfo, f64)| Estimate {
                key: format!("effect.{}.{}", effect.name(), info.key),
                value,
                unit: info.unit_for(coordinate),
                low: None,
                high: None,
                detectable_change: f64::INFINITY,
                contradicted: false,
            };
            effect.parameters().iter().zip(typical(*effect)).map(one).collect::<Vec<_>>()
        };
        self.text(self.add.iter().flat_map(of).collect()).map(|_| ())
    }

    /// The text with the values of a fit of the changed model.
    pub fn fitted(&self, c: &Comparison) -> Result<String> {
        let noise = c.overall.chi2_per_point.sqrt().max(1.0);
        let detectable_change = |column: usize| ROUNDING * noise / c.fit.evaluation.jacobian.column(column).norm();
        let pairs = c.fit.parameters.iter().zip(&c.intervals).enumerate();
        let one = |(column, (parameter, interval)): (usize, (&Parameter, &Interval))| Estimate {
            contradicted: c.whiteness.structured,
            ..estimate(parameter, interval, detectable_change(column))
        };
        let coordinate = self.scenario.rig.coordinate();
        let new = c.model.effects.iter().filter(|(own, _)| self.add.iter().any(|effect| effect.name() == own.name()));
        let unmoved = new.flat_map(|(effect, values)| {
            let numbers = effect.parameters().iter().zip(values).filter(|(info, _)| info.held);
            numbers.map(move |(info, &value)| held(*effect, &info.on(coordinate), value))
        });
        self.text(pairs.map(one).chain(unmoved).collect())
    }

    /// The changed text, once it is known to be a scenario that differs from the one at hand in nothing else.
    fn text(&self, values: Vec<Estimate>) -> Result<String> {
        let keys = |effect: &&'static dyn Effect| Addition::Effect(*effect).keys();
        let new: Vec<String> = self.add.iter().flat_map(keys).chain(self.numbers.iter().cloned()).collect();
        let gone: Vec<String> = self.remove.iter().flat_map(keys).collect();
        let stays = |key: &&String| !new.contains(key) && !gone.contains(key);
        let mut free: Vec<String> = self.scenario.free.iter().filter(stays).cloned().collect();
        free.extend(new);
        // A formula is there already, without strength.
        let add = self.add.iter().filter(|effect| effect.formula().is_none());
        let changes = Changes {
            values,
            add: add.map(|effect| effect.name().to_string()).collect(),
            remove: self.remove.map(|effect| effect.name().to_string()),
            free: free.clone(),
            extends: self.file.target.extends.clone(),
            table: self.file.target.table.clone(),
        };
        let text = self.file.file.apply(&changes)?;
        let after = scenario::load_text(self.file.to(), &text).map_err(|error| match error {
            Error::Input(why) => {
                let title = format!("the scenario as it would stand in {} is not valid", self.file.to().display());
                let said = whole_file(&title, "nothing was written; see above for what is wrong");
                Error::Input(format!("{why}\n\n{said}"))
            }
            other => other,
        })?;
        if !means(self.scenario, &after, &changes) || after.free != free {
            let path = self.file.path.display();
            let title = format!("{path} is written in a way that cannot be changed here; nothing was written");
            return Err(Error::Input(whole_file(&title, "write one key per line below [table] headers")));
        }
        Ok(text)
    }
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

/// Whether one scenario is the other with these changes, and nothing else.
fn means(before: &Scenario, after: &Scenario, changes: &Changes) -> bool {
    let mut meant = before.clone();
    meant.effects.retain(|setting| changes.remove.as_deref() != Some(setting.name()));
    let before_them = after.effects.len().saturating_sub(changes.add.len());
    meant.effects.extend(after.effects[before_them..].iter().cloned());
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
