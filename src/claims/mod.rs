//! The ledger of published statements: each is read from a file, computed and judged.

mod quantity;

use crate::error::{Error, Result};
use crate::scenario::{Formulation, Scenario};
use crate::units;
use quantity::{Context, Setting};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Deserialize;

/// Verdict on a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, serde::Serialize, serde::Deserialize)]
pub enum Verdict {
    /// The relation holds.
    Reproduced,
    /// The relation holds under a condition that the ledger states.
    Caveat,
    /// The relation does not hold with the printed values, but with another value of one of them.
    NotReproducible,
    /// The relation does not hold.
    Failed,
}

/// A statement with what the program makes of it. Numbers are in the SI unit `unit`.
#[derive(Debug, Clone)]
// Wide: a field is what a page tells of a claim.
pub struct Judged {
    /// Stable identifier.
    pub id: String,
    /// Section of the paper.
    pub section: String,
    /// The statement in our own words.
    pub statement: String,
    /// Scenario and figure that show it, `scenario#figure`.
    pub figure: Option<String>,
    /// The quantity in words.
    pub quantity: String,
    /// SI unit of the quantity; `1` for a pure number.
    pub unit: &'static str,
    /// The relation expected.
    pub expected: Relation,
    /// The computed value.
    pub computed: f64,
    /// Why the bound or tolerance is what it is.
    pub reason: String,
    /// Condition under which the statement holds; may be empty.
    pub caveat: String,
    /// Value of the drive u0 \[m\] from which on the relation holds, with the printed one, where it was sought and
    /// found.
    pub remedy: Option<(f64, f64)>,
    /// The verdict.
    pub verdict: Verdict,
}

/// What a quantity is expected to be, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relation {
    /// Not less than.
    AtLeast(f64),
    /// Not more than.
    AtMost(f64),
    /// Equal within a tolerance.
    Equal(f64, f64),
}

impl Relation {
    /// Whether `value` obeys it; NaN never does.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::AtLeast(bound) => value >= bound,
            Self::AtMost(bound) => value <= bound,
            Self::Equal(expected, tolerance) => (value - expected).abs() <= tolerance,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ledger {
    claim: Vec<Claim>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Claim {
    id: String,
    section: String,
    statement: String,
    figure: Option<String>,
    quantity: QuantityText,
    expect: Expect,
    reason: String,
    #[serde(default)]
    caveat: String,
    remedy: Option<Remedy>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct QuantityText {
    name: String,
    a: Option<CurveText>,
    b: Option<CurveText>,
    #[serde(rename = "where")]
    region: Option<String>,
    #[serde(default)]
    friction: Vec<f64>,
    #[serde(default)]
    speeds: Vec<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveText {
    case: Option<String>,
    speed: Option<Number>,
    load: Option<Number>,
    drive: Option<Number>,
    formulation: Option<Formulation>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Expect {
    at_least: Option<Number>,
    at_most: Option<Number>,
    equal: Option<Number>,
    tolerance: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Remedy {
    vary: String,
    from: Number,
    to: Number,
}

/// A number in SI, or a string with a unit.
#[derive(Deserialize, Clone)]
#[serde(untagged)]
enum Number {
    Si(f64),
    Text(String),
}

impl Number {
    fn si(&self, unit: &str) -> std::result::Result<f64, String> {
        match self {
            Self::Si(value) => Ok(*value),
            Self::Text(text) => units::parse(text, unit).map_err(|why| format!("`{text}`: {why}")),
        }
    }
}

/// Computes and judges every claim of the ledger `text` (named `file` in messages) for the rig of `scenario`.
///
/// # Errors
/// [`Error::Input`] where the ledger cannot be read or names something unknown.
pub fn judge(text: &str, file: &str, scenario: &Scenario) -> Result<Vec<Judged>> {
    let ledger = read(text, file)?;
    let context = Context::new(scenario);
    ledger
        .claim
        .par_iter()
        .map(|claim| {
            judge_one(claim, &context).map_err(|why| {
                Error::Input(format!("error: {file}: claim `{}`: {why}\n  = help: correct the claim", claim.id))
            })
        })
        .collect()
}

/// The ids of the ledger `text` (named `file` in messages).
///
/// # Errors
/// [`Error::Input`] where the ledger cannot be read.
pub fn ids(text: &str, file: &str) -> Result<Vec<String>> {
    Ok(read(text, file)?.claim.into_iter().map(|claim| claim.id).collect())
}

fn read(text: &str, file: &str) -> Result<Ledger> {
    toml::from_str(text).map_err(|why| Error::Input(format!("error: {file}: {why}\n  = help: correct the ledger")))
}

fn judge_one(claim: &Claim, context: &Context) -> std::result::Result<Judged, String> {
    let setting = Setting::read(&claim.quantity)?;
    let unit = setting.unit();
    let expected = relation(&claim.expect, unit)?;
    let computed = setting.value(context, None)?;
    let holds = expected.holds(computed);
    let remedy = match &claim.remedy {
        Some(remedy) if !holds => seek(remedy, &setting, expected, context)?,
        _ => None,
    };
    let verdict = match (holds, claim.caveat.is_empty(), remedy) {
        (true, true, _) => Verdict::Reproduced,
        (true, false, _) => Verdict::Caveat,
        (false, _, Some(_)) => Verdict::NotReproducible,
        (false, _, None) => Verdict::Failed,
    };
    Ok(Judged {
        id: claim.id.clone(),
        section: claim.section.clone(),
        statement: claim.statement.clone(),
        figure: claim.figure.clone(),
        quantity: setting.words(),
        unit,
        expected,
        computed,
        reason: claim.reason.clone(),
        caveat: claim.caveat.clone(),
        remedy,
        verdict,
    })
}

fn relation(expect: &Expect, unit: &str) -> std::result::Result<Relation, String> {
    match (&expect.at_least, &expect.at_most, &expect.equal, &expect.tolerance) {
        (Some(bound), None, None, None) => Ok(Relation::AtLeast(bound.si(unit)?)),
        (None, Some(bound), None, None) => Ok(Relation::AtMost(bound.si(unit)?)),
        (None, None, Some(value), Some(tolerance)) => Ok(Relation::Equal(value.si(unit)?, tolerance.si(unit)?)),
        _ => Err("`expect` needs at_least, or at_most, or equal with tolerance".into()),
    }
}

/// Smallest value of the varied setting for which the relation holds, to one part in a thousand, with the printed
/// value.
fn seek(
    remedy: &Remedy,
    setting: &Setting,
    expected: Relation,
    context: &Context,
) -> std::result::Result<Option<(f64, f64)>, String> {
    if remedy.vary != "drive" {
        return Err(format!("`vary = \"{}\"` is unknown; it can be \"drive\"", remedy.vary));
    }
    let (mut low, mut high) = (remedy.from.si("m")?, remedy.to.si("m")?);
    let printed = low;
    if !expected.holds(setting.value(context, Some(high))?) {
        return Ok(None);
    }
    while high / low > 1.001 {
        let middle = (low * high).sqrt();
        if expected.holds(setting.value(context, Some(middle))?) { high = middle } else { low = middle }
    }
    Ok(Some((high, printed)))
}
