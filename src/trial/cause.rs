//! What can be planted.

use super::outside::{self, OUTSIDE, Outside};
use crate::effects::{self, Effect, REGISTRY, fits_rig};
use crate::error::{Error, Result};
use crate::scenario::diagnostic::{nearest, whole_file};
use schemars::JsonSchema;
use std::collections::BTreeMap;

/// Numbers of the rig and the instrument that may be off.
const RECALIBRATIONS: &[&str] = &[
    "rig.torsional_stiffness",
    "rig.inertia",
    "rig.torsional_damping",
    "rig.spring_stiffness",
    "rig.contact_arm",
    "instrument.drive_gain",
    "instrument.amplitude_gain",
    "instrument.phase_offset",
];

/// Pairs of effects that are planted together.
const PAIRS: &[[&str; 2]] = &[
    ["rate-strengthening", "structural-damping"],
    ["rate-strengthening", "maxwell-branch"],
    ["grosch", "roller-compliance"],
    ["contact-renewal", "sensor-delay"],
    ["cubic-stiffness", "rate-strengthening"],
];

/// Sort of cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, JsonSchema, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Nothing is missing.
    None,
    /// A number of the rig or the instrument is off.
    Recalibration,
    /// One effect of the catalogue.
    Effect,
    /// Two of them.
    Pair,
    /// Something that the catalogue does not have.
    Outside,
}

impl Kind {
    /// The verdict that is right.
    pub fn verdict(self) -> &'static str {
        match self {
            Self::None => "nothing-missing",
            Self::Recalibration => "recalibrate",
            Self::Effect | Self::Pair => "effect-missing",
            Self::Outside => "unexplained",
        }
    }

    /// Its name in text.
    pub fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Recalibration => "recalibration",
            Self::Effect => "effect",
            Self::Pair => "pair",
            Self::Outside => "outside",
        }
    }
}

/// A cause to plant.
#[derive(Clone)]
pub enum Cause {
    /// Nothing.
    None,
    /// A number of the rig or the instrument, by its key.
    Recalibration(&'static str),
    /// Effects of the catalogue.
    Effects(Vec<&'static dyn Effect>),
    /// Something outside the catalogue.
    Outside(&'static dyn Outside),
}

impl Cause {
    /// Name in lists and files; a pair is joined by `+`.
    pub fn name(&self) -> String {
        match self {
            Self::None => "none".into(),
            Self::Recalibration(key) => (*key).into(),
            Self::Effects(effects) => effects.iter().map(|e| e.name()).collect::<Vec<_>>().join("+"),
            Self::Outside(cause) => cause.name().into(),
        }
    }

    /// Its sort.
    pub fn kind(&self) -> Kind {
        match self {
            Self::None => Kind::None,
            Self::Recalibration(_) => Kind::Recalibration,
            Self::Effects(effects) if effects.len() > 1 => Kind::Pair,
            Self::Effects(_) => Kind::Effect,
            Self::Outside(_) => Kind::Outside,
        }
    }

    fn find(name: &str) -> Option<Self> {
        if name == "none" {
            return Some(Self::None);
        }
        if let Some(key) = RECALIBRATIONS.iter().find(|key| **key == name) {
            return Some(Self::Recalibration(key));
        }
        if let Some(cause) = outside::find(name) {
            return Some(Self::Outside(cause));
        }
        let effects: Option<Vec<_>> = name.split('+').map(effects::find).collect();
        effects.filter(|all| effects::compatible(all).is_ok()).map(Self::Effects)
    }
}

impl std::fmt::Debug for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

/// A cause by its name as a reader is told it: what was not planted is `nothing`.
pub fn shown(cause: &str) -> &str {
    if cause == "none" { "nothing" } else { cause }
}

/// All names, in the order in which they are planted.
fn names(kind: Option<Kind>) -> Vec<String> {
    let mut all = vec![(Kind::None, "none".to_string())];
    // The paper's rig has a contact, and its tables more series than a drift has numbers for.
    let fitting = REGISTRY.iter().filter(|effect| fits_rig(**effect, true).is_ok() && effect.of_series().is_none());
    all.extend(fitting.map(|e| (Kind::Effect, e.name().to_string())));
    all.extend(RECALIBRATIONS.iter().map(|key| (Kind::Recalibration, (*key).to_string())));
    all.extend(PAIRS.iter().map(|pair| (Kind::Pair, pair.join("+"))));
    all.extend(OUTSIDE.iter().map(|cause| (Kind::Outside, cause.name().to_string())));
    all.into_iter().filter(|(k, _)| kind.is_none_or(|kind| kind == *k)).map(|(_, name)| name).collect()
}

/// The causes of a list: names, pairs joined by `+`, and the groups `all`, `effects`, `recalibrations`, `pairs`,
/// `outside`.
///
/// # Errors
/// [`Error::Input`] naming the first that is unknown, with the nearest that is known.
pub fn causes<S: AsRef<str>>(list: &[S]) -> Result<Vec<Cause>> {
    let mut wanted: Vec<String> = Vec::new();
    for word in list {
        let word = word.as_ref().trim();
        let found = match word {
            "all" => names(None),
            "effects" => names(Some(Kind::Effect)),
            "recalibrations" => names(Some(Kind::Recalibration)),
            "pairs" => names(Some(Kind::Pair)),
            "outside" => names(Some(Kind::Outside)),
            name => vec![name.to_string()],
        };
        for name in found {
            if !wanted.contains(&name) {
                wanted.push(name);
            }
        }
    }
    let found: Vec<Cause> =
        wanted.iter().map(|name| Cause::find(name).ok_or_else(|| unknown(name))).collect::<Result<_>>()?;
    let unfit = found.iter().find_map(|cause| {
        let Cause::Effects(effects) = cause else { return None };
        effects.iter().find_map(|effect| fits_rig(*effect, true).err())
    });
    let refused = |why: String| Error::Input(whole_file(&why, "trials are planted on a rig with a [contact]"));
    unfit.map_or(Ok(found), |why| Err(refused(why)))
}

/// The same, where `NAME:N` wants at most N draws of these: the causes, and those numbers by name.
///
/// # Errors
/// As of [`causes`], and for what is no number of draws.
pub fn numbered_causes<S: AsRef<str>>(list: &[S]) -> Result<(Vec<Cause>, BTreeMap<String, u32>)> {
    let (mut names, mut fewer) = (Vec::new(), BTreeMap::new());
    for word in list {
        let word = word.as_ref().trim();
        let (name, number) = word.split_once(':').map_or((word, None), |(name, number)| (name, Some(number)));
        names.push(name);
        let Some(number) = number else { continue };
        let most: u32 = number.trim().parse().ok().filter(|most| *most > 0).ok_or_else(|| {
            let help = "a whole number of at least 1 follows the colon, as in `pairs:8`";
            Error::Input(whole_file(&format!("`{word}` says no number of draws"), help))
        })?;
        fewer.extend(causes(&[name])?.iter().map(|cause| (cause.name(), most)));
    }
    Ok((causes(&names)?, fewer))
}

fn unknown(name: &str) -> Error {
    let known = names(None);
    let help = nearest(name, known.iter().map(String::as_str)).map_or_else(
        || "`stickslip effects` lists the catalogue; pairs are joined by +".to_string(),
        |near| format!("did you mean `{near}`?"),
    );
    Error::Input(whole_file(&format!("`{name}` is no cause that can be planted"), &help))
}
