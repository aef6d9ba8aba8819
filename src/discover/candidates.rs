//! Which effects of the catalogue a search asks for.

use crate::effects::{Effect, REGISTRY, find};
use crate::scenario::diagnostic::nearest;

/// The effects that a search asks for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Candidates {
    /// The whole catalogue.
    #[default]
    All,
    /// These.
    Named(Vec<&'static str>),
}

impl Candidates {
    /// Of a list of names or `all`, which an empty list is, too; names of the catalogue, or of a scenario's `own`
    /// formulas.
    ///
    /// # Errors
    /// In words, naming the first that is unknown.
    pub fn of<S: AsRef<str>>(list: &[S], own: &[&'static dyn Effect]) -> Result<Self, String> {
        let words: Vec<&str> = list.iter().map(|word| word.as_ref().trim()).collect();
        match words[..] {
            [] | ["all"] => return Ok(Self::All),
            _ => {}
        }
        let name = |word: &&str| {
            let known = || REGISTRY.iter().chain(own).map(|effect| effect.name());
            let own = own.iter().copied().find(|effect| effect.name() == *word);
            find(word).or(own).map(Effect::name).ok_or_else(|| {
                let near = nearest(word, known());
                let hint = near.map_or(String::new(), |near| format!(", did you mean `{near}`"));
                format!("there is no effect `{word}`{hint}")
            })
        };
        words.iter().map(name).collect::<Result<_, _>>().map(Self::Named)
    }

    /// Those that are named; none where all are asked for.
    pub fn named(&self) -> &[&'static str] {
        match self {
            Self::All => &[],
            Self::Named(names) => names,
        }
    }

    /// Whether an effect is among them; a formula, which a scenario states to be searched, always is.
    pub fn include(&self, effect: &dyn Effect) -> bool {
        match self {
            Self::All => true,
            Self::Named(names) => effect.formula().is_some() || names.contains(&effect.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_and_refused_with_what_would_do() {
        let power = find("power-damping").expect("registered");
        let none: [&str; 0] = [];
        let includes = |list: &[&str]| Candidates::of(list, &[]).expect("known").include(power);
        assert_eq!(Candidates::of(&none, &[]), Ok(Candidates::All));
        assert!(includes(&["all"]) && includes(&["stribeck", " power-damping"]) && !includes(&["lugre"]));
        let refused = Candidates::of(&["lugre", "power-dampin"], &[]).expect_err("no such effect");
        assert_eq!(refused, "there is no effect `power-dampin`, did you mean `power-damping`");
    }
}
