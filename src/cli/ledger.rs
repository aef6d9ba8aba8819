//! The claims of a report: which ledger, whether it has what the gates name, and how a judged claim is shown.

use crate::cache::Key;
use crate::claims::{self, Judged, Relation};
use crate::error::{Error, Result};
use crate::files;
use crate::report::{ClaimView, Verdict, anchor};
use crate::scenario::diagnostic::{nearest, quote, whole_file};
use crate::scenario::{self, Scenario};
use crate::units::readable as format;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Ledger and rig of the claims, below a scenarios folder.
const LEDGER: &str = "paper/claims.toml";
const RIG: &str = "paper/rig.toml";
/// Largest ledger that is read.
const MAX_BYTES: u64 = 1 << 20;

/// A ledger and the rig that it is about.
pub struct Ledger {
    text: String,
    file: String,
    rig: Scenario,
}

/// Every claim as the report shows it, and its verdict by id.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Claims {
    /// In the order of the ledger.
    pub views: Vec<ClaimView>,
    /// Likewise.
    pub verdicts: Vec<(String, claims::Verdict)>,
}

/// A scenario of the paper, where there is one: claims and atlas are for these.
pub fn of_paper<'a>(scenarios: impl IntoIterator<Item = &'a Scenario>) -> Option<&'a Scenario> {
    scenarios.into_iter().find(|scenario| scenario.id.starts_with("paper/"))
}

impl Ledger {
    /// The ledger, where scenarios of the paper are among those reported or a gate names a claim, which it must have.
    pub fn find(scenarios: &[Scenario]) -> Result<Option<Self>> {
        let one = of_paper(scenarios);
        if one.is_none() && scenarios.iter().all(|scenario| scenario.gate.claims.is_empty()) {
            return Ok(None);
        }
        // The folder of the scenarios has its own ledger and rig, unless they are the ones in the binary.
        let root = one.and_then(|one| one.path.parent().and_then(Path::parent));
        let beside = |name: &str| root.map(|root| root.join(name)).filter(|path| path.is_file());
        let ledger = match (beside(LEDGER), beside(RIG)) {
            (Some(ledger), Some(rig)) => Self {
                text: files::text(&ledger, MAX_BYTES, "the claims are a short text file")?,
                file: ledger.display().to_string(),
                rig: scenario::load_base(&rig)?,
            },
            _ => {
                let text = scenario::embedded_file(LEDGER).unwrap_or_default().into();
                Self { text, file: LEDGER.into(), rig: scenario::paper() }
            }
        };
        ledger.has_all(scenarios)?;
        Ok(Some(ledger))
    }

    fn has_all(&self, scenarios: &[Scenario]) -> Result<()> {
        let known = claims::ids(&self.text, &self.file)?;
        let wanted = scenarios.iter().flat_map(|s| s.gate.claims.iter().map(move |id| (s, id)));
        let unknown = |(scenario, id): (&Scenario, &String)| {
            let title = format!("{}: [gate] claims: there is no claim {}", scenario.path.display(), quote(id));
            let help = match nearest(id, known.iter().map(String::as_str)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("{} has {}", self.file, known.join(", ")),
            };
            whole_file(&title, &help)
        };
        let problems: Vec<String> = wanted.filter(|(_, id)| !known.contains(id)).map(unknown).collect();
        if problems.is_empty() { Ok(()) } else { Err(Error::Input(problems.join("\n\n"))) }
    }

    /// Name of its judged claims in a cache.
    pub fn key(&self) -> Key {
        Key::of("claims", &(&self.text, &self.file, &self.rig))
    }

    /// Computes and judges every claim.
    pub fn views(&self) -> Result<Claims> {
        let judged = claims::judge(&self.text, &self.file, &self.rig)?;
        let verdicts = judged.iter().map(|claim| (claim.id.clone(), claim.verdict)).collect();
        Ok(Claims { views: judged.iter().map(view).collect(), verdicts })
    }
}

/// A judged claim as the report shows it.
fn view(claim: &Judged) -> ClaimView {
    let show = |value: f64| number(value, claim.unit);
    let (expected, tolerance) = match claim.expected {
        Relation::AtLeast(bound) => (format!("at least {}", show(bound)), String::new()),
        Relation::AtMost(bound) => (format!("at most {}", show(bound)), String::new()),
        Relation::Equal(value, tolerance) => (show(value), format!("± {}", show(tolerance))),
    };
    let mut note = claim.caveat.clone();
    if let Some((needed, printed)) = claim.remedy {
        note += &format!(
            "It would hold for an actuator amplitude u₀ of {} or more; printed is {}.",
            format::quantity(needed, "m", 3),
            format::quantity(printed, "m", 3)
        );
    }
    ClaimView {
        id: claim.id.clone(),
        section: claim.section.clone(),
        statement: claim.statement.clone(),
        quantity: claim.quantity.clone(),
        expected,
        computed: show(claim.computed),
        tolerance,
        reason: claim.reason.clone(),
        verdict: match claim.verdict {
            claims::Verdict::Reproduced => Verdict::Reproduced,
            claims::Verdict::Caveat => Verdict::Caveat,
            claims::Verdict::NotReproducible => Verdict::NotReproducible,
            claims::Verdict::Failed => Verdict::Failed,
        },
        note,
        figure: claim.figure.as_ref().and_then(|f| f.split_once('#')).map(|(id, name)| anchor::figure(id, name)),
        ..ClaimView::default()
    }
}

/// Counts as they are, shares in percent, quantities with their unit.
fn number(value: f64, unit: &str) -> String {
    match unit {
        "1" if value.fract() == 0.0 && value.abs() < 1e6 => format!("{value}"),
        "1" if value.abs() >= 1e-4 => format::percent(value, 3),
        "1" => format!("{value:.1e}"),
        _ => format::quantity(value, unit, 3),
    }
}
