//! Figures of a comparison: everything draws for full, sparse and awkward tables, nothing overlaps, the numbers are
//! right.

#[path = "figures/layout.rs"]
mod layout;

use layout::{check_drawing, rows};
use stickslip::compare::{Comparison, Options, compare};
use stickslip::figures::comparison::REGISTRY;
use stickslip::figures::{self, Drawing};
use stickslip::measurement::{self, Table};
use stickslip::scenario::{self, Scenario};

fn practice(number: usize) -> (Scenario, Table) {
    let folder = if [1, 4, 6].contains(&number) { "scenarios/practice" } else { "tests/data/practice" };
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("{folder}/{number}/scenario.toml"));
    let scenario = scenario::load(&path).unwrap();
    let table = measurement::load(&scenario).unwrap().unwrap();
    (scenario, table)
}

fn compared(number: usize, change: impl FnOnce(&mut Scenario, &mut Table)) -> Comparison {
    let (mut scenario, mut table) = practice(number);
    change(&mut scenario, &mut table);
    compare(&scenario, &table, &Options { seed: 0 })
}

fn one_condition(table: &mut Table) {
    let first = table.points[0].clone();
    table.points.retain(|p| (p.speed, p.load, p.drive) == (first.speed, first.load, first.drive));
}

fn without_phase(table: &mut Table) {
    for point in &mut table.points {
        (point.phase, point.phase_sd) = (None, None);
    }
    table.phase_noise = None;
}

/// Tables of users: full, amplitudes only, one condition, a handful of points, a hostile title, twenty conditions.
fn variants() -> Vec<(&'static str, Comparison)> {
    let hostile = |scenario: &mut Scenario, table: &mut Table| {
        scenario.title = "</svg><script>alert(1)</script> µ 漢".into();
        table.points.retain(|p| p.speed > 0.0);
    };
    let fixed = |scenario: &mut Scenario, table: &mut Table| {
        scenario.free.clear();
        table.points.retain(|p| p.row % 7 == 0);
    };
    let many = |scenario: &mut Scenario, table: &mut Table| {
        scenario.free.clear();
        for point in &mut table.points {
            point.load += 1.0 + f64::from((point.frequency as u32 / 2) % 2) * 0.25;
        }
        table.points.sort_by(|a, b| {
            (a.load, a.speed, a.drive, a.frequency).partial_cmp(&(b.load, b.speed, b.drive, b.frequency)).unwrap()
        });
    };
    vec![
        ("full", compared(1, |_, _| {})),
        ("amplitudes", compared(2, |_, table| without_phase(table))),
        ("one", compared(4, |_, table| one_condition(table))),
        ("hostile", compared(7, hostile)),
        ("sparse", compared(8, fixed)),
        ("many", compared(3, many)),
        ("one-drive", compared(6, |_, table| table.points.retain(|p| p.drive < 5e-6 && p.load > 15.0))),
    ]
}

fn drawn(comparison: &Comparison) -> Vec<Drawing> {
    figures::drawings(REGISTRY, comparison).unwrap()
}

#[test]
fn every_figure_draws_every_table_twice_alike_with_room_for_every_text() {
    for (name, comparison) in variants() {
        let drawings = drawn(&comparison);
        assert_eq!(drawings, drawn(&comparison), "{name}");
        drawings.iter().for_each(|drawing| check_drawing(name, drawing));
    }
}

#[test]
fn figures_of_phases_need_phases() {
    let names = |comparison: &Comparison| drawn(comparison).into_iter().map(|d| d.name).collect::<Vec<_>>();
    let full: Vec<String> = REGISTRY.iter().map(|figure| figure.name().to_string()).collect();
    assert_eq!(names(&compared(4, |_, _| {})), full);
    let amplitudes = names(&compared(4, |_, table| without_phase(table)));
    assert_eq!(amplitudes, ["overlay", "misfit-map", "peaks", "error-budget"]);
}

#[test]
fn a_narrow_misfit_map_names_every_row_beside_either_map() {
    let map = figures::find(REGISTRY, "misfit-map").unwrap().draw(&compared(1, |_, _| {})).unwrap();
    let narrow = map.narrow.unwrap();
    let times = |svg: &str, text: &str| svg.lines().filter(|line| *line == text).count();
    for row in ["0 mm/s, 0.1 N, 2.5 µm", "0.05 mm/s, 20 N, 2.5 µm", "100 mm/s, 20 N, 2.5 µm"] {
        assert_eq!([times(&map.svg, row), times(&narrow, row)], [1, 2], "{row}");
    }
    // The ends of the scale stand below, each once.
    let ends = |svg: &str| [times(svg, "frequency f [Hz]"), svg.matches(" data-lying=").count()];
    assert_eq!([ends(&map.svg), ends(&narrow)], [[2, 0], [1, 1]]);
}

#[test]
fn tables_hold_every_reading_and_the_numbers_of_the_comparison() {
    let comparison = compared(1, |_, _| {});
    let csv = |name: &str| rows(&figures::find(REGISTRY, name).unwrap().draw(&comparison).unwrap());
    let readings = comparison.points.len();
    assert_eq!(csv("misfit-map").len(), readings);
    assert_eq!(csv("contact-fingerprint").len(), 2 * readings);
    assert_eq!(csv("peaks").len(), comparison.conditions.len());
    let overlay = csv("overlay");
    let of_points: Vec<_> = overlay.iter().filter(|row| row[0] == "reading").collect();
    assert_eq!(of_points.len(), readings);
    for (row, point) in of_points.iter().zip(&comparison.points) {
        assert_eq!(row[2], point.point.row.to_string());
        let number = |i: usize| row[i].parse::<f64>().unwrap();
        assert!((number(4) * point.point.drive / point.point.amplitude - 1.0).abs() < 1e-8);
        let residual = (number(6) - number(4)) / number(5);
        assert!((residual - number(7)).abs() < 1e-5 * (1.0 + residual.abs()), "{residual} {}", number(7));
    }
}

#[test]
fn the_fingerprint_keeps_its_range_where_readings_say_nothing() {
    let calm = compared(4, |_, _| {});
    let wild = compared(4, |_, table| {
        for point in table.points.iter_mut().filter(|p| p.row % 40 == 0) {
            point.amplitude *= 0.02;
            point.amplitude_sd = 3.0 * point.amplitude;
        }
    });
    let drawing = |c: &Comparison| figures::find(REGISTRY, "contact-fingerprint").unwrap().draw(c).unwrap();
    assert!(drawing(&wild).caption.contains("Faded: ") && drawing(&wild).caption.contains("Arrows at the edges: "));
    assert!(!drawing(&calm).caption.contains("Faded: "), "{}", drawing(&calm).caption);
}

/// Writes every figure as PNG to `$STICKSLIP_FIGURES`, for looking at; does nothing where that is not set.
#[test]
fn gallery() {
    let Some(folder) = std::env::var_os("STICKSLIP_FIGURES") else { return };
    std::fs::create_dir_all(&folder).unwrap();
    for (name, comparison) in variants() {
        for drawing in drawn(&comparison) {
            let path = std::path::Path::new(&folder).join(format!("{name}-{}.png", drawing.name));
            std::fs::write(path, figures::png(&drawing.svg, 1.0).unwrap()).unwrap();
        }
    }
}
