//! The ledger: verdicts follow from computed numbers, and a broken ledger says what is wrong.

use stickslip::claims::{Verdict, judge};
use stickslip::scenario;

fn ledger(claim: &str) -> String {
    format!("[[claim]]\nid = \"x\"\nsection = \"s\"\nstatement = \"t\"\nreason = \"r\"\n{claim}")
}

fn verdict(claim: &str) -> (Verdict, f64, Option<(f64, f64)>) {
    let judged = judge(&ledger(claim), "claims.toml", &scenario::paper()).unwrap();
    (judged[0].verdict, judged[0].computed, judged[0].remedy)
}

const SHIFT: &str =
    r#"quantity = { name = "peak-shift", a = { case = "free-or-full-slip" }, b = { case = "static-contact" } }"#;

#[test]
fn verdict_follows_from_the_computed_number() {
    // Peaks of the two cases: 71.194 and 81.569 Hz.
    let (kind, computed, _) = verdict(&format!("{SHIFT}\nexpect = {{ equal = \"10.375 Hz\", tolerance = \"2 mHz\" }}"));
    assert_eq!(kind, Verdict::Reproduced);
    assert!((computed - 10.375).abs() < 1e-3);
    assert_eq!(verdict(&format!("{SHIFT}\nexpect = {{ at_least = \"11 Hz\" }}")).0, Verdict::Failed);
    let with_caveat = format!("{SHIFT}\nexpect = {{ at_most = \"11 Hz\" }}\ncaveat = \"only here\"");
    assert_eq!(verdict(&with_caveat).0, Verdict::Caveat);
}

#[test]
fn remedy_is_the_drive_at_which_the_fastest_speed_meets_the_threshold() {
    let claim = r#"
quantity = { name = "speeds-in-transition", speeds = ["0.1 mm/s", "0.5 mm/s"] }
expect = { at_least = 2 }
remedy = { vary = "drive", from = "2.5 um", to = "25 um" }"#;
    let (kind, computed, remedy) = verdict(claim);
    assert_eq!((kind, computed), (Verdict::NotReproducible, 1.0));
    // The threshold 0.16833 mm/s is proportional to u0; the grid of frequencies and the least visible difference
    // of 1e-4 raise it a little.
    let (needed, printed) = remedy.unwrap();
    let exact = 2.5e-6 * 0.5 / 0.16833;
    assert!(printed == 2.5e-6 && needed > 0.999 * exact && needed < 1.02 * exact, "{needed:e} {exact:e}");
}

#[test]
fn a_remedy_that_does_not_help_leaves_the_claim_failed() {
    let claim = r#"
quantity = { name = "speeds-in-transition", speeds = ["0.1 mm/s", "0.5 mm/s"] }
expect = { at_least = 3 }
remedy = { vary = "drive", from = "2.5 um", to = "25 um" }"#;
    assert_eq!(verdict(claim).0, Verdict::Failed);
}

#[test]
fn broken_ledgers_name_the_claim_and_what_is_possible() {
    let cases = [
        ("quantity = { name = \"peak-shfit\" }\nexpect = { at_least = 1 }", "peak-shift"),
        ("quantity = { name = \"peak-shift\" }\nexpect = { at_least = 1 }", "`a`"),
        (&format!("{SHIFT}\nexpect = {{ }}"), "at_least"),
        (&format!("{SHIFT}\nexpect = {{ at_least = \"1 kg\" }}"), "kg"),
        (&format!("{SHIFT}\nexpect = {{ atleast = 1 }}"), "atleast"),
        (
            "quantity = { name = \"peak-ratio\", a = { case = \"IV\" }, b = { speed = 0 } }\nexpect = { at_least = 1 }",
            "IV",
        ),
        ("quantity = 3\nexpect = { at_least = 1 }", "claims.toml"),
    ];
    for (claim, told) in cases {
        let error = judge(&ledger(claim), "claims.toml", &scenario::paper()).unwrap_err();
        assert!(error.to_string().contains(told), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}

#[test]
fn the_shipped_ledger_has_no_failure_and_names_what_cannot_follow() {
    let text = scenario::embedded_file("paper/claims.toml").unwrap();
    let judged = judge(text, "claims.toml", &scenario::paper()).unwrap();
    let of = |verdict| judged.iter().filter(|j| j.verdict == verdict).map(|j| j.id.as_str()).collect::<Vec<_>>();
    assert!(of(Verdict::Failed).is_empty(), "{:?}", of(Verdict::Failed));
    assert_eq!(of(Verdict::NotReproducible), ["transition-speeds-of-figure-6", "factor-of-a-hundred"]);
}

#[test]
fn figures_named_by_scenarios_and_claims_exist() {
    assert_eq!(scenario::parameters::FIGURES, stickslip::figures::names());
    let text = scenario::embedded_file("paper/claims.toml").unwrap();
    for line in text.lines().filter_map(|line| line.strip_prefix("figure = ")) {
        let (id, figure) = line.trim_matches('"').split_once('#').unwrap();
        let scenario = scenario::load_embedded(id).unwrap();
        assert!(scenario.figures.iter().flatten().any(|name| name == figure), "{line}");
    }
}
