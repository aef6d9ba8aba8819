//! What a scenario states of a formula.

use super::expression::{Blame, FUNCTIONS, Fault, PI, Step};
use super::program::PARAMETERS;
use strsim::osa_distance;

/// What a formula is a term of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsOn {
    /// The force or torque on the coordinate.
    Force,
    /// The friction coefficient.
    Friction,
    /// The force of the bristles.
    ContactForce,
}

impl ActsOn {
    /// All of them with their words in a scenario.
    pub const ALL: [(&'static str, Self); 3] =
        [("force", Self::Force), ("friction", Self::Friction), ("contact-force", Self::ContactForce)];

    /// Its word.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(_, one)| *one == self).map_or("", |(word, _)| word)
    }

    /// The variables of its formulas.
    pub fn variables(self) -> &'static [&'static str] {
        match self {
            Self::Force => &["x", "v"],
            Self::Friction => &["s"],
            Self::ContactForce => &["stretch", "stretch_rate"],
        }
    }
}

/// A parameter as a scenario states it; SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Its name.
    pub key: String,
    /// Its SI unit; `1` where it is stated in bare numbers.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// Magnitudes that a search should cover, and whether of either sign.
    pub range: Option<(f64, f64, bool)>,
}

/// A formula as a scenario states it.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// Name of the effect.
    pub name: String,
    /// The expression.
    pub text: String,
    /// What it is a term of.
    pub acts_on: ActsOn,
    /// Its parameters.
    pub parameters: Vec<Stated>,
}

impl Statement {
    /// What is wrong with the whole of it.
    pub(super) fn fault(&self, title: &str, label: &str, help: &str) -> Fault {
        let blame = Blame::Text(0..self.text.len());
        Fault { blame, title: title.into(), label: label.into(), help: help.into() }
    }

    /// Whether every name means something, and every parameter occurs.
    pub(super) fn check_names(&self, steps: &[Step]) -> Result<(), Fault> {
        let variables = self.acts_on.variables();
        let parameter = |index: usize, title: String, label: &str, help: &str| {
            Err(Fault { blame: Blame::Parameter(index), title, label: label.into(), help: help.into() })
        };
        for (index, stated) in self.parameters.iter().enumerate() {
            let key = stated.key.as_str();
            if variables.contains(&key) || key == PI || FUNCTIONS.iter().any(|(name, ..)| *name == key) {
                let what = if variables.contains(&key) { "a variable" } else { "a name that every formula knows" };
                let title = format!("the parameter `{key}` has the name of {what}");
                return parameter(index, title, "taken", "give the parameter another name, here and in the formula");
            }
        }
        let names = || steps.iter().filter_map(|step| if let Step::Name(span) = step { Some(span) } else { None });
        for span in names() {
            let name = &self.text[span.clone()];
            let known = || variables.iter().copied().chain(self.parameters.iter().map(|p| p.key.as_str()));
            if known().any(|one| one == name) {
                continue;
            }
            let near = known().min_by_key(|one| osa_distance(one, name)).filter(|one| osa_distance(one, name) < 2);
            let label = match near {
                Some(near) if name.len() > 1 => format!("did you mean `{near}`?"),
                _ => "neither a variable nor a parameter".into(),
            };
            let help = format!(
                "the variables of acts_on = \"{}\" are {}; a parameter is a key of this effect: add {name} = {{ value = 0 }}",
                self.acts_on.word(),
                variables.join(", ")
            );
            let title = format!("the formula has an unknown name `{name}`");
            return Err(Fault { blame: Blame::Text(span.clone()), title, label, help });
        }
        if let Some(index) = self.parameters.iter().position(|p| !names().any(|span| self.text[span.clone()] == p.key))
        {
            let title = format!("the parameter `{}` does not occur in the formula", self.parameters[index].key);
            return parameter(index, title, "not in the formula", "remove it, or write it into the formula");
        }
        if self.parameters.is_empty() {
            let help = "write e.g. formula = \"-k*x^5\" and below it k = { value = 0 }";
            return Err(self.fault("the formula has no parameter", "nothing in it can be fitted", help));
        }
        if self.parameters.len() > PARAMETERS {
            let title = format!("the formula has {} parameters, at most {PARAMETERS} are read", self.parameters.len());
            let help = "write fixed numbers into the formula, or two effects: forces of several add up";
            return parameter(PARAMETERS, title, "one too many", help);
        }
        Ok(())
    }
}
