//! The report: escaped, self-contained, navigable, the same every time, and the same as its JSON.

mod demo;
#[path = "../figures/small_discovery.rs"]
mod small_discovery;

use std::collections::BTreeSet;

use base64::Engine as _;
use serde_json::Value;
use sha2::Digest as _;
use stickslip::report::{ReportView, SCHEMA, json, others, render};

const TITLE: &str = "Transition between sticking and slipping";

const HOSTILE: &str =
    "</title></style><script>alert(1)</script>\"' onload='x' <img src=x onerror=y> javascript:alert(2) µ\u{202e}漢";

/// All values of an attribute.
fn attributes<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let key = format!(" {name}=\"");
    page.split(key.as_str()).skip(1).filter_map(|rest| rest.split_once('"').map(|(value, _)| value)).collect()
}

/// What the page says, its own script and every tag taken away, beside what its attributes say.
fn said(page: &str) -> String {
    let page = page.split("<script>").next().unwrap_or(page);
    let mut text = String::with_capacity(2 * page.len());
    for part in page.split('<').skip(1) {
        text.push_str(part.split_once('>').map_or(part, |(_, words)| words));
    }
    unescape(&(text + page))
}

/// Undoes the escaping of the templates.
fn unescape(page: &str) -> String {
    [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#x27;", "'"), ("&#x2f;", "/"), ("&amp;", "&")]
        .iter()
        .fold(page.to_owned(), |page, (from, to)| page.replace(from, to))
}

/// Every string and number of the JSON with its key.
fn leaves<'a>(value: &'a Value, key: &'a str, found: &mut Vec<(&'a str, String)>) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(key, value)| leaves(value, key, found)),
        Value::Array(items) => items.iter().for_each(|item| leaves(item, key, found)),
        Value::String(text) => found.push((key, text.clone())),
        Value::Number(number) => found.push((key, number.to_string())),
        _ => {}
    }
}

#[test]
fn hostile_text_stays_text() {
    let mut view = demo::report(HOSTILE);
    let claim = &mut view.claims[0];
    for field in [&mut claim.statement, &mut claim.note, &mut claim.expected, &mut claim.section, &mut claim.reason] {
        *field = HOSTILE.into();
    }
    let figure = demo::figure(HOSTILE, HOSTILE, HOSTILE);
    let mut scenario = demo::scenario(HOSTILE, HOSTILE);
    scenario.provenance = HOSTILE.into();
    scenario.description = HOSTILE.into();
    let status = stickslip::solver::Status::Failed(HOSTILE.into());
    view.scenarios.push(stickslip::report::scenario_view(&demo::outcome(scenario, &status), &[figure]));
    view.provenance.command = HOSTILE.into();
    let page = render(&view).unwrap();
    assert!(page.matches("<script").count() == 1 && !page.contains("<img"), "an element came through");
    assert_eq!(page.matches("</style>").count(), 1);
    assert_eq!(page.matches("</title>").count(), 1);
    assert!(page.contains("&lt;script&gt;alert(1)"));
    for link in attributes(&page, "href") {
        assert!(link.starts_with('#') || !link.contains(':'), "{link}");
    }
    let page = page.split("<script>").next().unwrap();
    for tag in page.split('<').skip(1).filter_map(|rest| rest.split_once('>').map(|(tag, _)| tag)) {
        let outside = tag.split('"').step_by(2).collect::<String>();
        assert!(!outside.contains(" on"), "an event handler came through: <{tag}>");
    }
}

#[test]
fn a_drawing_that_could_run_is_left_out() {
    let mut figure = demo::figure("a", "b", "c");
    figure.svg = "<svg><script>alert(1)</script></svg>".into();
    let outcome = demo::outcome(demo::scenario("a", "a"), &stickslip::solver::Status::Steady);
    let mut view = demo::report(TITLE);
    view.scenarios.push(stickslip::report::scenario_view(&outcome, &[figure]));
    let page = render(&view).unwrap();
    assert!(!page.contains("<script>alert"));
    assert!(page.contains("The drawing is not part of this page"));
}

#[test]
fn ids_are_unique_and_every_link_has_its_target() {
    let page = render(&demo::report(TITLE)).unwrap();
    let ids = attributes(&page, "id");
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), unique.len(), "an id is used twice");
    let links: Vec<&str> = attributes(&page, "href");
    assert!(links.len() > 20);
    for target in links.iter().filter_map(|link| link.strip_prefix('#')) {
        assert!(unique.contains(target), "no target for #{target}");
    }
    for list in ["aria-labelledby", "aria-describedby"] {
        for id in attributes(&page, list).iter().flat_map(|ids| ids.split_ascii_whitespace()) {
            assert!(unique.contains(id), "no element for {list}={id}");
        }
    }
}

#[test]
fn things_of_the_same_name_keep_apart() {
    let view = demo::report(TITLE);
    let twice = |mut items: Vec<stickslip::report::ScenarioView>| {
        items.extend(items.clone());
        items
    };
    let provenance = stickslip::report::Provenance::fixed("stickslip");
    let claims = [demo::claims(), demo::claims()].concat();
    let view = ReportView::assemble(TITLE, claims, twice(view.scenarios), view.atlas, view.verification, &provenance);
    let page = render(&view).unwrap();
    let ids = attributes(&page, "id");
    assert_eq!(ids.len(), ids.iter().collect::<BTreeSet<_>>().len());
    assert_eq!(view.scenarios[2].anchor, "scenario-paper-figure-6-2");
}

#[test]
fn nothing_is_loaded_from_anywhere() {
    let page = render(&demo::report(TITLE)).unwrap();
    assert!(unescape(&page).contains("default-src 'none'"));
    for element in ["<script src", "<link", "<iframe", "<img", "<object", "<embed", "@import", "@font-face"] {
        assert!(!page.contains(element), "{element}");
    }
    for value in ["src", "href", "xlink:href"].iter().flat_map(|name| attributes(&page, name)) {
        assert!(!value.contains("//"), "{value}");
    }
    assert!(!page.replace("url(#", "").contains("url("));
}

#[test]
fn only_the_script_of_the_page_may_run() {
    let page = render(&demo::report(TITLE)).unwrap();
    let between = |from: &str, to: &str| page.split_once(from).unwrap().1.split_once(to).unwrap().0;
    let policy = unescape(between("Content-Security-Policy\" content=\"", "\""));
    for (name, text) in
        [("script-src", between("<script>", "</script>")), ("style-src", between("<style>", "</style>"))]
    {
        let hash = base64::engine::general_purpose::STANDARD.encode(sha2::Sha256::digest(text.as_bytes()));
        assert!(policy.contains(&format!("{name} 'sha256-{hash}';")), "{policy}");
    }
    assert!(!policy.contains("unsafe") && !page.contains(" style=\""));
}

#[test]
fn the_same_view_gives_the_same_bytes() {
    let (first, second) = (demo::report(TITLE), demo::report(TITLE));
    assert_eq!(render(&first).unwrap(), render(&second).unwrap());
    assert_eq!(json(&first).unwrap(), json(&second).unwrap());
}

#[test]
fn only_the_provenance_may_differ() {
    let fixed = demo::report(TITLE);
    let mut dated = fixed.clone();
    let mut provenance = stickslip::report::Provenance::now("stickslip", 7);
    provenance.timings.push(("all".into(), 1.5));
    dated.provenance = provenance.view(&dated.scenarios);
    let before = |page: String| page.split("<section id=\"provenance\"").next().map(str::to_owned);
    assert_eq!(before(render(&fixed).unwrap()), before(render(&dated).unwrap()));
}

#[test]
fn what_the_json_says_the_page_shows() {
    let view = demo::report(TITLE);
    let data: Value = serde_json::from_str(&json(&view).unwrap()).unwrap();
    assert_eq!(data["schema"], SCHEMA);
    let page =
        said(&render(&view).unwrap()) + &others(&view).unwrap().iter().map(|(_, page)| said(page)).collect::<String>();
    let mut found = Vec::new();
    leaves(&data, "", &mut found);
    assert!(found.len() > 300);
    // Field names that lay out, symbols (split into letter and index), SI units and names that stand inside paths.
    let silent = ["key", "symbol", "unit", "name"];
    for (key, text) in found.iter().filter(|(key, text)| !["", "–"].contains(&text.as_str()) && !silent.contains(key))
    {
        assert!(page.contains(text.as_str()), "{key}: {text} is not in the page");
    }
    assert!(!json(&view).unwrap().contains("<svg"));
}

#[test]
fn the_json_can_be_read_back() {
    let mut view = demo::report(TITLE);
    let read: ReportView = serde_json::from_str(&json(&view).unwrap()).unwrap();
    view.scenarios.iter_mut().flat_map(|s| &mut s.figures).for_each(|figure| figure.svg.clear());
    view.atlas.iter_mut().for_each(|effect| effect.figure.svg.clear());
    view.scenarios.iter_mut().flat_map(|s| &mut s.figures).for_each(|figure| figure.csv.clear());
    view.atlas.iter_mut().for_each(|effect| effect.figure.csv.clear());
    assert_eq!(read, view);
}

#[test]
fn failures_come_first() {
    let view = demo::report(TITLE);
    let verdicts: Vec<&str> = view.summary.headlines.iter().map(|headline| headline.verdict.as_str()).collect();
    assert_eq!(
        verdicts,
        [
            "disagrees",
            "failed",
            "not reproducible from the printed values",
            "some points self-excited",
            "reproduced with a caveat"
        ]
    );
    assert_eq!(
        view.summary.sentence,
        "Of 4 published claims: 1 reproduced, 1 reproduced with a caveat, 1 not reproducible from the printed values, 1 failed; 1009 of 1010 points in 2 scenarios are steady states; 1 of 2 checks of the solvers agree."
    );
    assert_eq!(view.summary.claims.iter().map(|tally| tally.count).sum::<usize>(), view.claims.len());
}

/// A report on nothing but two tables of measurements: one that the model matches, one that it does not.
fn compared(title: &str) -> ReportView {
    let provenance = stickslip::report::Provenance::fixed("stickslip");
    let scenarios = vec![demo::measured(4, title), demo::measured(1, title)];
    ReportView::assemble(title, vec![], scenarios, vec![], vec![], &provenance)
}

#[test]
fn comparisons_are_summed_up_with_failures_first() {
    let view = compared("Readings");
    let verdicts: Vec<&str> = view.summary.compared.iter().map(|line| line.verdict.as_str()).collect();
    assert_eq!(verdicts, ["structured misfit", "within the noise"]);
    assert!(view.summary.sentence.contains("the model is within the noise in 1 of 2 comparisons with measurements"));
    let page = render(&view).unwrap();
    let ids: BTreeSet<&str> = attributes(&page, "id").into_iter().collect();
    for line in &view.summary.compared {
        assert!(ids.contains(line.anchor.as_str()) && line.detail.starts_with("χ² per reading "), "{}", line.detail);
    }
    let page = page.split_once("<section id=\"summary\"").unwrap().1;
    assert!(page.find(&view.summary.compared[0].anchor) < page.find(&view.summary.compared[1].anchor));
    // The sections follow each other as the lines of the summary do.
    let failing = view.scenarios[0].comparison.as_ref().unwrap();
    assert_eq!(failing.anchor, view.summary.compared[0].anchor);
    assert!(!failing.regions.is_empty() && failing.figures.len() == 3 && failing.more.len() == 1);
    assert_eq!((view.scenarios[1].points, view.scenarios[1].failed), (156, 0));
    assert_eq!(view.provenance.inputs.len(), 4);
}

#[test]
fn what_the_json_says_of_a_comparison_the_page_shows() {
    let view = compared("Readings");
    let text = json(&view).unwrap();
    let page = unescape(&render(&view).unwrap());
    let data: Value = serde_json::from_str(&text).unwrap();
    for scenario in data["scenarios"].as_array().unwrap() {
        let mut found = Vec::new();
        leaves(&scenario["comparison"], "", &mut found);
        assert!(found.len() > 200);
        for (key, text) in
            found.iter().filter(|(key, text)| !["", "–"].contains(&text.as_str()) && !["name", "value"].contains(key))
        {
            assert!(page.contains(text.as_str()), "{key}: {text} is not in the page");
        }
    }
    let read: ReportView = serde_json::from_str(&text).unwrap();
    assert_eq!(read.summary, view.summary);
}

#[test]
fn hostile_names_of_measurements_stay_text() {
    let page = render(&compared(HOSTILE)).unwrap();
    assert!(page.matches("<script").count() == 1 && !page.contains("<img"));
    let ids = attributes(&page, "id");
    assert_eq!(ids.len(), ids.iter().collect::<BTreeSet<_>>().len());
}

/// A report on two tables: what one misfits is explained by an effect, the other misses nothing.
fn discovered(title: &str) -> ReportView {
    let provenance = stickslip::report::Provenance::fixed("stickslip");
    let scenarios = vec![demo::discovered(4, title), demo::discovered(1, title)];
    ReportView::assemble(title, vec![], scenarios, vec![], vec![], &provenance)
}

#[test]
fn discoveries_are_told_and_summed_up() {
    let view = discovered("Readings");
    let verdicts: Vec<&str> = view.summary.compared.iter().map(|line| line.verdict.as_str()).collect();
    assert_eq!(verdicts, ["explained by an effect", "nothing missing"]);
    assert!(view.summary.compared[0].detail.contains(" → "), "{}", view.summary.compared[0].detail);
    assert!(view.summary.sentence.contains("what misfits is explained in 1"));
    assert_eq!(view.summary.comparisons.iter().map(|tally| tally.count).sum::<usize>(), 2);
    let text = json(&view).unwrap();
    let page = render(&view).unwrap();
    let ids: Vec<&str> = attributes(&page, "id");
    assert!(view.summary.compared.iter().all(|line| ids.contains(&line.anchor.as_str())));
    let page = said(&page);
    let data: Value = serde_json::from_str(&text).unwrap();
    for scenario in data["scenarios"].as_array().unwrap() {
        let mut found = Vec::new();
        leaves(&scenario["discovery"], "", &mut found);
        assert!(found.len() > 80);
        // The fall of the error is in the packed table of the first figure; tests/browser reads it there.
        let fall = ["strengths", "chi2_per_point", "rms_error_percent"];
        let silent = [&["name", "value", "identified"][..], &fall].concat();
        for (key, text) in found.iter().filter(|(key, text)| text != "–" && !text.is_empty() && !silent.contains(key))
        {
            assert!(page.contains(text.as_str()), "{key}: {text} is not in the page");
        }
    }
    let read: ReportView = serde_json::from_str(&text).unwrap();
    assert_eq!(read.summary, view.summary);
}

#[test]
fn what_stays_unexplained_is_a_failure_with_what_is_known() {
    let mut discovery = small_discovery::discovered(1, |_, _| {});
    discovery.steps.truncate(1);
    discovery.verdict = stickslip::discover::Verdict::Unexplained;
    discovery.indistinguishable = vec![vec![HOSTILE.into(), "b".into()]];
    discovery.notes = vec![HOSTILE.into()];
    let view = stickslip::report::discovery_view(&discovery, &[demo::figure(HOSTILE, HOSTILE, HOSTILE)]);
    let mut scenario = demo::discovered(4, HOSTILE);
    scenario.discovery = Some(view);
    let provenance = stickslip::report::Provenance::fixed("stickslip");
    let view = ReportView::assemble(HOSTILE, vec![], vec![scenario], vec![], vec![], &provenance);
    assert_eq!(view.summary.compared[0].verdict, "unexplained");
    assert_eq!(stickslip::report::Tone::of("unexplained"), stickslip::report::Tone::Bad);
    let page = render(&view).unwrap();
    assert!(page.matches("<script").count() == 1 && !page.contains("<img"));
    assert!(page.contains("What is known about the unknown") && page.contains("These data do not tell apart"));
    let ids = attributes(&page, "id");
    assert_eq!(ids.len(), ids.iter().collect::<BTreeSet<_>>().len());
}

#[test]
fn checks_have_a_page_of_their_own_that_needs_no_other() {
    let view = demo::report(TITLE);
    let pages = others(&view).unwrap();
    assert_eq!(pages.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["checks.html"]);
    let (main, checks) = (render(&view).unwrap(), &pages[0].1);
    let ids: BTreeSet<&str> = attributes(checks, "id").into_iter().collect();
    for check in &view.verification {
        assert!(ids.contains(check.anchor.as_str()) && !attributes(&main, "id").contains(&check.anchor.as_str()));
    }
    for link in attributes(&main, "href").iter().filter_map(|link| link.strip_prefix("checks.html#")) {
        assert!(ids.contains(link), "no target for checks.html#{link}");
    }
    for link in attributes(checks, "href") {
        assert!(link.strip_prefix('#').map_or(["report.html", "report.json"].contains(&link), |id| ids.contains(id)));
    }
}

#[test]
fn the_error_falls_from_the_calibrated_base_to_the_fit() {
    let view = discovered("Readings");
    let discovery = view.scenarios[0].discovery.as_ref().unwrap();
    let fall = discovery.fall.as_ref().unwrap();
    assert_eq!((fall.strengths.len(), fall.strengths[0], fall.strengths[20]), (21, 0.0, 1.0));
    let whole = fall.parts.last().unwrap();
    assert_eq!(whole.additions, fall.additions);
    let ends = [whole.chi2_per_point[0], whole.chi2_per_point[20]];
    assert_eq!(ends, [discovery.before.value, discovery.after.value]);
    // Every strength between is solved: none repeats its neighbour.
    assert!(whole.chi2_per_point.windows(2).all(|pair| pair[0].is_some() && pair[0] != pair[1]));
    assert!(view.scenarios[1].discovery.as_ref().unwrap().fall.is_none());
}

#[test]
fn a_view_of_nothing_is_still_a_page() {
    let provenance = stickslip::report::Provenance::fixed("stickslip");
    let page = render(&ReportView::assemble("Nothing", vec![], vec![], vec![], vec![], &provenance)).unwrap();
    assert!(page.contains("Nothing was computed.") && !page.contains("href=\"#claims\""));
}

#[test]
fn the_atlas_has_a_section_per_effect() {
    let view = demo::report(TITLE);
    let page = unescape(&render(&view).unwrap());
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is not in the page"));
    assert!(at("<section id=\"atlas\"") < at("<section id=\"symbols\""));
    assert!(at("href=\"#atlas\"") < at("href=\"checks.html\""));
    assert_eq!(view.atlas.len(), stickslip::effects::REGISTRY.len());
    for effect in &view.atlas {
        assert!(page.contains(&format!("<div id=\"{}\"", effect.anchor)));
        assert!(page.contains(&format!("href=\"atlas/{}.csv\"", effect.name)), "{}", effect.name);
    }
}

/// Writes the page to look at: `REPORT_DEMO=/tmp/report-demo cargo test --test report demo_page`.
#[test]
fn demo_page() {
    let Some(folder) = std::env::var_os("REPORT_DEMO").map(std::path::PathBuf::from) else { return };
    let view = demo::report(TITLE);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("report.html"), render(&view).unwrap()).unwrap();
    std::fs::write(folder.join("report.json"), json(&view).unwrap()).unwrap();
}
