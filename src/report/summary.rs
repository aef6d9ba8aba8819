//! Puts the parts together: unique anchors, links that lead somewhere, the summary with failures first.

use super::anchor::{self, Anchors};
use super::glossary::{equations, glossary};
use super::provenance::{Provenance, SECTION};
use super::verdict::{Agreement, Completeness, Found, Match, Tone, Verdict};
use super::view::{
    CheckView, ClaimView, ComparisonView, DiscoveryView, EffectView, EquationView, FigureView, Headline, ReportView,
    SCHEMA, ScenarioView, SummaryView, SymbolView, TallyView,
};
use crate::units;

/// Ids of the page's own sections.
pub const SECTIONS: [&str; 13] = [
    "top",
    "content",
    "summary",
    "run",
    "baseline",
    "history",
    "simulations",
    "claims",
    "atlas",
    "trust",
    "verification",
    "symbols",
    SECTION,
];

const PAPER: &str = "the experiment of Nakano and others (Frontiers in Mechanical Engineering 5:9, 2019), simulated from its printed \
    values: what each claim comes to, the figures with their numbers, and how far these can be trusted.";

const PLAIN: &str = "Simulations of a torsional rig in frictional contact with a driven roller, after Nakano and others (Frontiers in \
    Mechanical Engineering 5:9, 2019): the figures with their numbers, and how far these can be trusted.";

/// What the report is, in a paragraph.
fn lead(claims: &[ClaimView], scenarios: &[ScenarioView]) -> String {
    match (claims.is_empty(), scenarios.iter().any(|scenario| scenario.rig.is_some())) {
        (false, _) => match comparisons(scenarios).count() {
            0 => format!("This is {PAPER}"),
            tables => {
                let of = units::count(tables, "table");
                format!("{of} of measurements{}, held against the model. Then the paper: {PAPER}", synthetic(scenarios))
            }
        },
        (true, false) => PLAIN.into(),
        (true, true) => of_others(scenarios),
    }
}

/// Of scenarios that are not all about the paper's kind of rig.
fn of_others(scenarios: &[ScenarioView]) -> String {
    let measured = scenarios.iter().any(|scenario| scenario.comparison.is_some());
    let equation = scenarios.iter().filter_map(|s| Some(s.rig.as_ref()?.equations.first()?.equation.clone())).next();
    let equation = equation.map_or(String::new(), |equation| format!(", {equation}"));
    if measured {
        format!(
            "Measured steady states held against the model of a single mode of vibration{equation}: how well it fits, where it \
             fails and what it lacks, and how far these numbers can be trusted."
        )
    } else {
        format!(
            "Simulations of a single mode of vibration{equation}: the figures with their numbers, and how far these can be trusted."
        )
    }
}

/// Equations and symbols of the rigs of some scenarios, each once.
fn of_rigs(scenarios: &[ScenarioView]) -> (Vec<EquationView>, Vec<SymbolView>) {
    let of_paper = scenarios.is_empty() || scenarios.iter().any(|scenario| scenario.rig.is_none());
    let (mut all, mut symbols) = if of_paper { (equations(), glossary()) } else { (Vec::new(), Vec::new()) };
    for rig in scenarios.iter().filter_map(|scenario| scenario.rig.as_ref()) {
        let new = rig.equations.iter().filter(|equation| !all.contains(equation)).cloned().collect::<Vec<_>>();
        all.extend(new);
        for symbol in &rig.symbols {
            // What two rigs mean by one letter may differ: then both are told.
            if !symbols.iter().any(|known: &SymbolView| known.anchor == symbol.anchor) {
                symbols.push(symbol.clone());
            }
        }
    }
    (all, symbols)
}

/// Names scenarios that share a title by their ids as well.
fn distinguish(scenarios: &mut [ScenarioView]) {
    let titles: Vec<String> = scenarios.iter().map(|scenario| scenario.title.clone()).collect();
    for scenario in scenarios {
        if titles.iter().filter(|title| **title == scenario.title).count() > 1 {
            scenario.title = format!("{} ({})", scenario.title, scenario.id);
        }
    }
}

/// What was measured comes before what was not, the most serious outcome first; what is alike keeps its order.
fn by_severity(scenarios: &mut [ScenarioView]) {
    let tone = |(scenario, c): (&ScenarioView, &ComparisonView)| Tone::of(outcome(scenario, c));
    let chi2 = |c: &ComparisonView| c.overall.chi2.value.unwrap_or(f64::INFINITY);
    scenarios.sort_by(|one, other| match (&one.comparison, &other.comparison) {
        (Some(a), Some(b)) => tone((other, b)).cmp(&tone((one, a))).then(chi2(b).total_cmp(&chi2(a))),
        (a, b) => b.is_some().cmp(&a.is_some()),
    });
}

/// Makes the anchors of a part of the page and of its figures unique.
fn claim_part<'a>(anchors: &mut Anchors, part: &mut String, figures: impl IntoIterator<Item = &'a mut FigureView>) {
    *part = anchors.claim(part);
    for figure in figures {
        figure.anchor = anchors.claim(&figure.anchor);
    }
}

/// The same of a scenario's section and of the parts in it.
fn claim_scenario(anchors: &mut Anchors, scenario: &mut ScenarioView) {
    claim_part(anchors, &mut scenario.anchor, &mut scenario.figures);
    if let Some(discovery) = &mut scenario.discovery {
        claim_part(anchors, &mut discovery.anchor, discovery.figures.iter_mut().chain(&mut discovery.more));
    }
    if let Some(free_form) = &mut scenario.free_form {
        claim_part(anchors, &mut free_form.anchor, &mut free_form.figures);
    }
    if let Some(question) = &mut scenario.question {
        claim_part(anchors, &mut question.anchor, &mut question.figures);
    }
    if let Some(comparison) = &mut scenario.comparison {
        claim_part(anchors, &mut comparison.anchor, comparison.figures.iter_mut().chain(&mut comparison.more));
    }
}

impl ReportView {
    /// The report from its parts. Anchors are made unique, links to figures that do not exist are dropped.
    pub fn assemble(
        title: &str,
        mut claims: Vec<ClaimView>,
        mut scenarios: Vec<ScenarioView>,
        mut atlas: Vec<EffectView>,
        mut verification: Vec<CheckView>,
        provenance: &Provenance,
    ) -> Self {
        distinguish(&mut scenarios);
        by_severity(&mut scenarios);
        let mut anchors = Anchors::default();
        for section in SECTIONS {
            anchors.claim(section);
        }
        for scenario in &mut scenarios {
            claim_scenario(&mut anchors, scenario);
        }
        for effect in &mut atlas {
            claim_part(&mut anchors, &mut effect.anchor, [&mut effect.figure]);
        }
        for claim in &mut claims {
            claim.figure = claim.figure.take().filter(|figure| anchors.has(figure));
            claim.anchor = anchors.claim(&anchor::claim(&claim.id));
        }
        for check in &mut verification {
            check.anchor = anchors.claim(&anchor::check(&check.name));
        }
        let (equations, glossary) = of_rigs(&scenarios);
        Self {
            schema: SCHEMA.into(),
            title: title.into(),
            lead: lead(&claims, &scenarios),
            summary: SummaryView::of(&claims, &scenarios, &verification),
            gates: Vec::new(),
            baseline: None,
            history: None,
            trust: None,
            provenance: provenance.view(&scenarios),
            claims,
            scenarios,
            atlas,
            verification,
            equations,
            glossary,
        }
    }
}

impl SummaryView {
    /// Counts and headlines, the most serious first.
    pub fn of(claims: &[ClaimView], scenarios: &[ScenarioView], checks: &[CheckView]) -> Self {
        let claim_words = || claims.iter().map(|claim| claim.verdict.words());
        let scenario_words = || scenarios.iter().map(|scenario| scenario.status.words());
        let check_words = || checks.iter().map(|check| check.verdict.words());
        Self {
            sentence: sentence(claims, scenarios, checks),
            claims: tally(&Verdict::ALL.map(Verdict::words), claim_words()),
            verification: tally(&Agreement::ALL.map(Agreement::words), check_words()),
            scenarios: tally(&Completeness::ALL.map(Completeness::words), scenario_words()),
            comparisons: tables(scenarios),
            compared: compared(scenarios),
            headlines: headlines(claims, scenarios, checks),
        }
    }
}

fn comparisons(scenarios: &[ScenarioView]) -> impl Iterator<Item = (&ScenarioView, &ComparisonView)> {
    scenarios.iter().filter_map(|scenario| Some((scenario, scenario.comparison.as_ref()?)))
}

/// One line per comparison.
fn compared(scenarios: &[ScenarioView]) -> Vec<Headline> {
    let line = |(scenario, c): (&ScenarioView, &ComparisonView)| {
        if let Some(d) = &scenario.discovery {
            return of_discovery(scenario, d);
        }
        let worst = c.regions.first().map_or(String::new(), |region| format!("; worst: {region}"));
        Headline {
            verdict: c.verdict.words().into(),
            subject: scenario.title.clone(),
            detail: format!(
                "χ² per reading {}, error {} rms, noise {}{worst}",
                c.overall.chi2.text, c.overall.error.text, c.overall.noise.text
            ),
            anchor: c.anchor.clone(),
        }
    };
    comparisons(scenarios).map(line).collect()
}

/// The outcome of a discovery in a line.
fn of_discovery(scenario: &ScenarioView, d: &DiscoveryView) -> Headline {
    let sentence = d.sentence.trim_end_matches('.');
    let what = if d.verdict == Found::Effect { format!(", {}", d.titles.join(", and ")) } else { String::new() };
    let after = if d.added.is_empty() { String::new() } else { format!(" → {}", d.after.text) };
    let numbers = format!("{sentence}{what}. χ² per reading {}{after}", d.before.text);
    let amounts: String = d.amounts.iter().map(|amount| format!("; {amount}")).collect();
    let made = if scenario.provenance.starts_with("synthetic") { " (synthetic readings)" } else { "" };
    Headline {
        verdict: d.verdict.words().into(),
        subject: format!("{}{made}", scenario.title),
        detail: format!("{numbers}{amounts}. {}", d.sure),
        anchor: d.anchor.clone(),
    }
}

/// How many of the tables were made by a program, said where there are any.
fn synthetic(scenarios: &[ScenarioView]) -> String {
    let tables = comparisons(scenarios).count();
    match comparisons(scenarios).filter(|(scenario, _)| scenario.provenance.starts_with("synthetic")).count() {
        0 => String::new(),
        n if n == tables => " (all of them synthetic)".into(),
        n => format!(" ({n} of them synthetic)"),
    }
}

/// What is known of a table in the end: what was discovered, or what the model leaves.
fn outcome(scenario: &ScenarioView, c: &ComparisonView) -> &'static str {
    scenario.discovery.as_ref().map_or(c.verdict.words(), |d| d.verdict.words())
}

/// Number of tables by outcome; of what the model leaves only what occurs, where there were discoveries.
fn tables(scenarios: &[ScenarioView]) -> Vec<TallyView> {
    let words = || comparisons(scenarios).map(|(scenario, c)| outcome(scenario, c));
    if words().next().is_none() {
        return Vec::new();
    }
    let matches = tally(&Match::ALL.map(Match::words), words());
    if scenarios.iter().all(|scenario| scenario.discovery.is_none()) {
        return matches;
    }
    let mut found = tally(&Found::ALL.map(Found::words), words());
    found.extend(matches.into_iter().filter(|tally| tally.count > 0));
    found
}

fn tally<'a>(order: &[&str], found: impl Iterator<Item = &'a str>) -> Vec<TallyView> {
    let found: Vec<&str> = found.collect();
    let count = |verdict: &str| found.iter().filter(|word| **word == verdict).count();
    order.iter().map(|&verdict| TallyView { verdict: verdict.into(), count: count(verdict) }).collect()
}

fn sentence(claims: &[ClaimView], scenarios: &[ScenarioView], checks: &[CheckView]) -> String {
    let points: usize = scenarios.iter().map(|scenario| scenario.points).sum();
    let steady: usize = scenarios.iter().map(|scenario| scenario.steady).sum();
    let agree = checks.iter().filter(|check| check.verdict == Agreement::Agrees).count();
    let mut parts = Vec::new();
    if !claims.is_empty() {
        // The most agreeable verdict first here; the list below begins with the failures.
        let counts = Verdict::ALL.iter().rev().map(|verdict| {
            let count = claims.iter().filter(|claim| claim.verdict == *verdict).count();
            (count > 0).then(|| format!("{count} {}", verdict.words()))
        });
        let counts: Vec<String> = counts.flatten().collect();
        parts.push(format!("Of {} published claims: {}", claims.len(), counts.join(", ")));
    }
    if points > 0 {
        parts.push(format!(
            "{steady} of {points} points in {} are steady states",
            units::count(scenarios.len(), "scenario")
        ));
    }
    let matches: Vec<Match> = comparisons(scenarios).map(|(_, c)| c.verdict).collect();
    if !matches.is_empty() {
        let good = matches.iter().filter(|verdict| **verdict == Match::Noise).count();
        parts.push(format!(
            "the model is within the noise in {good} of {} with measurements{}",
            units::count(matches.len(), "comparison"),
            synthetic(scenarios)
        ));
        let found = |wanted: &[Found]| {
            scenarios.iter().filter_map(|s| s.discovery.as_ref()).filter(|d| wanted.contains(&d.verdict)).count()
        };
        let told = [
            ("explained", found(&[Found::Effect, Found::Recalibrated])),
            ("unexplained", found(&[Found::Unexplained])),
        ];
        let told: Vec<String> = told.iter().filter(|(_, n)| *n > 0).map(|(word, n)| format!("{word} in {n}")).collect();
        if !told.is_empty() {
            parts.push(format!("what misfits is {}", told.join(" and ")));
        }
    }
    if !checks.is_empty() {
        parts.push(format!("{agree} of {} of the solvers agree", units::count(checks.len(), "check")));
    }
    if parts.is_empty() { "Nothing was computed.".into() } else { format!("{}.", parts.join("; ")) }
}

fn headlines(claims: &[ClaimView], scenarios: &[ScenarioView], checks: &[CheckView]) -> Vec<Headline> {
    let of_check = |check: &CheckView| Headline {
        verdict: check.verdict.words().into(),
        subject: check.name.clone(),
        detail: format!("computed {}, expected {}", check.computed, check.expected),
        anchor: check.anchor.clone(),
    };
    let of_scenario = |scenario: &ScenarioView| Headline {
        verdict: scenario.status.words().into(),
        subject: scenario.title.clone(),
        detail: format!(
            "{} points: {} failed, {} self-excited",
            scenario.points, scenario.failed, scenario.self_excited
        ),
        anchor: scenario.anchor.clone(),
    };
    let of_claim = |claim: &ClaimView| Headline {
        verdict: claim.verdict.words().into(),
        subject: claim.statement.clone(),
        detail: claim.note.clone(),
        anchor: claim.anchor.clone(),
    };
    let all = checks.iter().map(of_check).chain(scenarios.iter().map(of_scenario)).chain(claims.iter().map(of_claim));
    let mut worth: Vec<Headline> = all.filter(|headline| Tone::of(&headline.verdict) != Tone::Good).collect();
    worth.sort_by_key(|headline| std::cmp::Reverse(Tone::of(&headline.verdict)));
    worth
}
