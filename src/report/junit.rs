//! The report as JUnit XML: one test case per gate, table of measurements, claim and check of the solvers.

use super::verdict::{Agreement, Match, Passed, Verdict};
use super::view::{CheckView, ClaimView, GateView, ReportView, ScenarioView};

/// What became of a test case, with the message of what did not pass.
enum Outcome {
    Passed,
    /// Neither right nor wrong.
    Skipped(String),
    Failed(String),
}

struct Case {
    class: String,
    name: String,
    outcome: Outcome,
}

/// The report for programs that show test results. A claim that cannot be decided counts as skipped, and so does a
/// table of measurements that the model misses where no gate says whether that matters.
pub fn junit(view: &ReportView) -> String {
    let suites: [(&str, Vec<Case>); 4] = [
        ("gates", view.gates.iter().map(gate).collect()),
        ("measurements", view.scenarios.iter().filter_map(|scenario| measured(scenario, &view.gates)).collect()),
        ("claims", view.claims.iter().map(claim).collect()),
        ("verification", view.verification.iter().map(check).collect()),
    ];
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let all = || suites.iter().flat_map(|(_, cases)| cases);
    text += &format!("<testsuites name=\"{}\"{}>\n", escape(&view.title), counts(all()));
    for (name, cases) in suites.iter().filter(|(_, cases)| !cases.is_empty()) {
        text += &format!("  <testsuite name=\"{name}\"{}>\n", counts(cases.iter()));
        cases.iter().for_each(|case| text += &element(case));
        text += "  </testsuite>\n";
    }
    text + "</testsuites>\n"
}

fn counts<'a>(cases: impl Iterator<Item = &'a Case>) -> String {
    let (mut tests, mut failures, mut skipped) = (0, 0, 0);
    for case in cases {
        tests += 1;
        failures += usize::from(matches!(case.outcome, Outcome::Failed(_)));
        skipped += usize::from(matches!(case.outcome, Outcome::Skipped(_)));
    }
    format!(" tests=\"{tests}\" failures=\"{failures}\" errors=\"0\" skipped=\"{skipped}\"")
}

fn element(case: &Case) -> String {
    let head = format!("    <testcase classname=\"{}\" name=\"{}\"", escape(&case.class), escape(&case.name));
    match &case.outcome {
        Outcome::Passed => format!("{head}/>\n"),
        Outcome::Skipped(why) => format!("{head}>\n      <skipped message=\"{}\"/>\n    </testcase>\n", escape(why)),
        Outcome::Failed(why) => {
            let why = escape(why);
            format!("{head}>\n      <failure message=\"{why}\">{why}</failure>\n    </testcase>\n")
        }
    }
}

fn gate(gate: &GateView) -> Case {
    let outcome = match gate.verdict {
        Passed::Yes => Outcome::Passed,
        Passed::No => Outcome::Failed(format!("{}; demanded: {}", gate.found.text, gate.demanded.text)),
    };
    // Several claims may be demanded under one key.
    let what = if gate.gate == "claims" { format!("claims: {}", gate.found.text) } else { gate.gate.clone() };
    Case { class: format!("gates.{}", gate.scenario), name: what, outcome }
}

fn measured(scenario: &ScenarioView, gates: &[GateView]) -> Option<Case> {
    let comparison = scenario.comparison.as_ref()?;
    let gated = gates.iter().any(|gate| gate.scenario == scenario.id);
    let outcome = match comparison.verdict {
        Match::Noise => Outcome::Passed,
        _ if gated => Outcome::Passed,
        _ => Outcome::Skipped(format!("no gate: {}", comparison.sentence)),
    };
    Some(Case { class: format!("measurements.{}", scenario.id), name: "model against measurements".into(), outcome })
}

fn claim(claim: &ClaimView) -> Case {
    let why =
        || format!("{}: computed {}, expected {}. {}", claim.statement, claim.computed, claim.expected, claim.note);
    let outcome = match claim.verdict {
        Verdict::Reproduced | Verdict::Caveat => Outcome::Passed,
        Verdict::NotReproducible => Outcome::Skipped(why()),
        Verdict::Failed => Outcome::Failed(why()),
    };
    Case { class: "claims".into(), name: claim.id.clone(), outcome }
}

fn check(check: &CheckView) -> Case {
    let outcome = match check.verdict {
        Agreement::Agrees => Outcome::Passed,
        Agreement::Disagrees => Outcome::Failed(format!(
            "{}: difference {}, tolerance {}",
            check.compares, check.difference, check.tolerance
        )),
    };
    Case { class: "verification".into(), name: check.name.clone(), outcome }
}

/// A text inside XML; characters that XML cannot hold become the replacement character.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&apos;",
            '\t' | '\n' | '\r' => escaped += &format!("&#{};", c as u32),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg::roxmltree::Document;

    const HOSTILE: &str = "]]></testcase>\"'<failure/>&amp;&\u{0}\u{b}\n\t\u{ffff}\u{202e}漢 --> <?xml?> <!--";

    #[test]
    fn hostile_words_stay_words() {
        let quantity = |text: &str| super::super::view::Quantity { value: None, text: text.into() };
        let gates = [Passed::No, Passed::Yes].map(|verdict| GateView {
            scenario: HOSTILE.into(),
            anchor: String::new(),
            gate: HOSTILE.into(),
            found: quantity(HOSTILE),
            demanded: quantity(HOSTILE),
            verdict,
        });
        let claims = [Verdict::Failed, Verdict::NotReproducible].map(|verdict| ClaimView {
            id: HOSTILE.into(),
            statement: HOSTILE.into(),
            verdict,
            ..ClaimView::default()
        });
        let checks = vec![CheckView { name: HOSTILE.into(), ..CheckView::default() }];
        let provenance = super::super::Provenance::fixed(HOSTILE);
        let mut view = ReportView::assemble(HOSTILE, claims.to_vec(), vec![], vec![], checks, &provenance);
        view.gates = gates.to_vec();
        let text = junit(&view);
        let document = Document::parse(&text).unwrap();
        let count = |name: &str| document.descendants().filter(|node| node.has_tag_name(name)).count();
        assert_eq!([count("testcase"), count("failure"), count("skipped")], [5, 3, 1]);
        let root = document.root_element();
        assert_eq!((root.attribute("tests"), root.attribute("failures")), (Some("5"), Some("3")));
        let shown: String =
            HOSTILE.chars().map(|c| if ['\u{0}', '\u{b}', '\u{ffff}'].contains(&c) { '\u{fffd}' } else { c }).collect();
        assert_eq!(root.attribute("name"), Some(shown.as_str()));
    }
}
