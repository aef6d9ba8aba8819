//! Figures of a discovery: everything draws, twice alike, nothing overlaps, the numbers are those of the discovery.

#[path = "figures/layout.rs"]
mod layout;
#[path = "figures/small_discovery.rs"]
mod small_discovery;

use layout::{check_drawing, check_layout, rows};
use small_discovery::discovered;
use std::sync::OnceLock;
use stickslip::discover::{Discovery, Verdict, identified, open_ends, sentence};
use stickslip::figures::discovery::REGISTRY;
use stickslip::figures::{self, Drawing};
use stickslip::fit::{Identified, Interval};

const HOSTILE: &str = "</svg><script>alert(1)</script> µ 漢";

/// An effect, a recalibration, nothing; amplitudes only.
fn variants() -> &'static [(&'static str, Discovery)] {
    static VARIANTS: OnceLock<Vec<(&'static str, Discovery)>> = OnceLock::new();
    VARIANTS.get_or_init(|| {
        vec![
            ("effect", discovered(1, |scenario, _| scenario.title = HOSTILE.into())),
            ("recalibrate", discovered(6, |_, _| {})),
            (
                "amplitudes",
                discovered(4, |_, table| {
                    for point in &mut table.points {
                        (point.phase, point.phase_sd) = (None, None);
                    }
                    table.phase_noise = None;
                }),
            ),
        ]
    })
}

fn drawn(discovery: &Discovery) -> Vec<Drawing> {
    figures::drawings(REGISTRY, discovery).unwrap()
}

fn check(name: &str, discovery: &Discovery) {
    let drawings = drawn(discovery);
    assert_eq!(drawings, drawn(discovery), "{name}");
    drawings.iter().for_each(|drawing| check_drawing(name, drawing));
}

#[test]
fn every_figure_draws_twice_alike_with_room_for_every_text() {
    for (name, discovery) in variants() {
        check(name, discovery);
    }
}

#[test]
fn a_ladder_of_one_step_has_no_figure_of_steps() {
    let names = |d: &Discovery| drawn(d).into_iter().map(|d| d.name).collect::<Vec<_>>();
    let all: Vec<String> = REGISTRY.iter().map(|figure| figure.name().to_string()).collect();
    assert_eq!(names(&variants()[0].1), all);
    assert_eq!(variants()[2].1.verdict, Verdict::NothingMissing);
    assert_eq!(names(&variants()[2].1), ["before-after", "parameters", "ranking"]);
}

#[test]
fn tables_hold_the_numbers_of_the_discovery() {
    let d = &variants()[0].1;
    assert_eq!(d.verdict, Verdict::EffectMissing);
    assert!(sentence(d).starts_with("missing: "));
    let csv = |name: &str| rows(&figures::find(REGISTRY, name).unwrap().draw(d).unwrap());
    let number = |text: &str| text.parse::<f64>().unwrap();
    let ladder = csv("ladder");
    assert_eq!(ladder.len(), d.steps.len());
    for (row, step) in ladder.iter().zip(&d.steps) {
        assert!((number(&row[1]) / step.comparison.overall.chi2_per_point - 1.0).abs() < 1e-8);
    }
    assert_eq!(csv("ranking").len(), d.candidates.len());
    let end = d.explanation();
    assert_eq!(csv("parameters").len(), end.comparison.fit.parameters.len());
    assert_eq!(csv("fingerprint-before-after").len(), 3 * end.comparison.contact.len());
    let overlay = csv("ladder-overlay");
    let of = |kind: &str| overlay.iter().filter(|row| row[0] == kind).count();
    assert_eq!(of("reading"), end.comparison.points.len());
    assert_eq!(of("error"), d.steps.len() * end.comparison.points.len());
}

#[test]
fn the_first_picture_has_every_state_on_the_way_for_the_page_to_draw() {
    let d = &variants()[0].1;
    let fall = d.fall().unwrap();
    let drawing = figures::find(REGISTRY, "before-after").unwrap().draw(d).unwrap();
    let table = rows(&drawing);
    let states = table.iter().filter(|row| !row[1].is_empty()).collect::<Vec<_>>();
    assert_eq!(states.len(), fall.parts.len() * stickslip::discover::STRENGTHS);
    let end = states.last().unwrap();
    assert_eq!(end[2].parse::<f64>().unwrap(), d.explanation().comparison.overall.chi2_per_point);
    assert!(table.iter().all(|row| row.len() == table[0].len() && row.len() > 4));
    // The last state is the explanation: its values are those of the model at the readings shown.
    let (measured, last) = (table.iter().find(|row| row[0].starts_with("measured ")).unwrap(), end);
    let off = |i: usize| (last[i].parse::<f64>().unwrap() / measured[i].parse::<f64>().unwrap() - 1.0).abs();
    assert!((4..last.len()).all(|i| off(i) < 0.1));
    assert!(variants()[2].1.fall().is_none());
    // The page moves the same panels of the form for a narrow screen.
    let panels = |svg: &str| svg.matches("data-panel=").count();
    assert_eq!(panels(drawing.narrow.as_ref().unwrap()), panels(&drawing.svg));
}

#[test]
fn open_and_extreme_ends_of_intervals_stay_on_the_drawing() {
    let mut d = variants()[0].1.clone();
    let last = d.steps.len() - 1;
    let comparison = &mut d.steps[last].comparison;
    let parameters = comparison.fit.parameters.clone();
    let with = |i: usize, low, high, identified| Interval { low, high, identified, ..comparison.intervals[i] };
    let (bottom, top) = parameters[1].bounds();
    comparison.intervals = vec![
        with(0, 1e-9, 1e12, Identified::Yes),
        with(1, bottom, comparison.intervals[1].high, Identified::OneSided),
        with(2, 0.0, 1e9, Identified::No),
        with(3, f64::NAN, f64::INFINITY, Identified::Yes),
    ];
    let words: Vec<&str> = parameters.iter().zip(&comparison.intervals).map(|(p, i)| identified(p, i)).collect();
    assert_eq!(words, ["identified", "only an upper bound", "these data do not determine it", "identified"]);
    let above = Interval { low: comparison.intervals[1].value, high: top, ..comparison.intervals[1] };
    assert_eq!(open_ends(&parameters[1], &above), (false, true));
    let drawing = figures::find(REGISTRY, "parameters").unwrap().draw(&d).unwrap();
    look("open", &drawing);
    check_layout(&drawing);
}

#[test]
fn long_ladders_and_strange_numbers_find_room() {
    let mut d = variants()[0].1.clone();
    let step = d.steps[1].clone();
    d.steps.extend([step.clone(), step]);
    d.steps[2].added = Some("rate-strengthening-with-a-name-that-is-far-too-long-for-any-margin".into());
    d.steps[3].held_out = None;
    d.candidates[1].delta_bic = 1e7;
    d.candidates[2].weight = 0.0;
    d.candidates[3].testable = false;
    let last = &mut d.steps.last_mut().unwrap().comparison;
    last.fit.parameters[0].unit = "N s^2/m^2";
    (last.intervals[0].value, last.intervals[0].low, last.intervals[0].high) = (4.2114e-5, 4.1191e-5, 4.3052e-5);
    drawn(&d).iter().for_each(|drawing| look("long", drawing));
    check("long", &d);
}

/// Writes a figure as PNG to `$STICKSLIP_FIGURES`, for looking at; does nothing where that is not set.
fn look(name: &str, drawing: &Drawing) {
    let Some(folder) = std::env::var_os("STICKSLIP_FIGURES") else { return };
    std::fs::create_dir_all(&folder).unwrap();
    let path = std::path::Path::new(&folder).join(format!("{name}-{}.png", drawing.name));
    std::fs::write(path, figures::png(&drawing.svg, 1.0).unwrap()).unwrap();
}

#[test]
fn gallery() {
    for (name, discovery) in variants() {
        drawn(discovery).iter().for_each(|drawing| look(name, drawing));
    }
}
