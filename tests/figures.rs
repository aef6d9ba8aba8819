//! Structure of the figures, on synthetic outcomes: everything draws, nothing overlaps, the numbers are right.

#[path = "figures/layout.rs"]
mod layout;
#[path = "figures/synthetic.rs"]
mod synthetic;

use layout::{check_drawing, check_layout, rows};
use stickslip::figures::{self, Drawing, FigureError, data};
use stickslip::scenario::Formulation;
use stickslip::solver::Status;
use stickslip::sweep::{LimitingCase, Outcome};
use synthetic::{Axes, DRIVE, RIG, closed, outcome, suited};

fn draw(name: &str, outcome: &Outcome) -> Drawing {
    figures::find(figures::REGISTRY, name).unwrap().draw(outcome).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn every_figure_draws_its_outcome_twice_alike_with_room_for_every_text() {
    for figure in figures::REGISTRY {
        let outcome = suited(figure.name());
        let drawing = draw(figure.name(), &outcome);
        assert_eq!(drawing, draw(figure.name(), &outcome), "{} differs between two draws", figure.name());
        assert_eq!(drawing.name, figure.name());
        check_drawing("synthetic", &drawing);
    }
}

#[test]
fn tables_hold_every_point_with_finite_numbers() {
    let expected = [
        ("rig-sketch", 10),
        ("velocity-amplitude", 101 + 2 * 1001),
        ("friction-independence", 6 * 101),
        ("resonance", 8 * 101 + 2 * 1001),
        ("ridge", 31),
        ("regime-map", 60 * 101 + 1001),
        ("collapse", 11 * 101),
        ("loops", 3 * 400),
        ("time-histories", 3 * 400),
        // The two finest of five step sizes are what the others are held against.
        ("formulations", 4 * (101 + 5 + 3)),
    ];
    assert_eq!(expected.map(|(name, _)| name).to_vec(), figures::names());
    for (name, count) in expected {
        let rows = rows(&draw(name, &suited(name)));
        assert_eq!(rows.len(), count, "{name}");
        let numbers = rows.iter().flatten().filter_map(|cell| cell.parse::<f64>().ok());
        assert!(numbers.clone().count() >= count, "{name} has rows without numbers");
        assert!(numbers.clone().all(f64::is_finite), "{name}");
    }
}

#[test]
fn onsets_of_stick_agree_with_the_closed_form() {
    let drawing = draw("velocity-amplitude", &outcome(&Axes { speed: vec![8e-5], ..Axes::default() }));
    let speed = |f: f64| RIG.contact_arm * std::f64::consts::TAU * f * closed(LimitingCase::FreeOrFullSlip, DRIVE, f).0;
    let root = |mut low: f64, mut high: f64| {
        let rising = speed(low) < 8e-5;
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if (speed(middle) < 8e-5) == rising { low = middle } else { high = middle }
        }
        low
    };
    let found: Vec<&String> =
        drawing.notes.iter().filter(|(n, _)| n.starts_with('f')).map(|(_, value)| value).collect();
    let exact = [root(50.0, 71.0), root(72.0, 100.0)].map(|f| format!("{f:.3} Hz"));
    assert_eq!(found, exact.iter().collect::<Vec<_>>());
}

#[test]
fn peak_of_a_parabola_is_exact_on_an_uneven_grid() {
    let parabola = |x: f64| (x, 7.0 - 3.0 * (x - 2.3) * (x - 2.3));
    let (x, y) = data::peak(&[0.0, 1.1, 1.9, 3.2, 4.0].map(parabola)).unwrap();
    assert!((x - 2.3).abs() < 1e-12 && (y - 7.0).abs() < 1e-12, "{x} {y}");
    assert_eq!(data::peak(&[(0.0, 1.0), (1.0, 2.0)]), Some((1.0, 2.0)));
    assert_eq!(data::peak(&[(0.0, f64::NAN)]), None);
}

#[test]
fn an_empty_outcome_is_missing_data() {
    let mut empty = suited("resonance");
    empty.curves.clear();
    empty.limits.clear();
    for figure in figures::REGISTRY.iter().filter(|figure| figure.name() != "rig-sketch") {
        let error = figure.draw(&empty).unwrap_err();
        let FigureError::MissingData(text) = error else { panic!("{}: {error}", figure.name()) };
        assert!(text.contains(figure.name()), "{text}");
    }
}

/// Scenarios of users: one point, no contact, several loads, many curves.
fn variants() -> Vec<Outcome> {
    let speeds = |n: usize| (0..n).map(|i| 1e-6 * 1.3f64.powi(i as i32)).collect::<Vec<f64>>();
    let base = Axes::default();
    let cases = [
        Axes { frequency: vec![70.0], ..base.clone() },
        Axes { frequency: vec![70.0], load: vec![0.0], speed: vec![0.0], ..base.clone() },
        Axes { load: vec![0.0, 5.0, 20.0], ..base.clone() },
        Axes { speed: speeds(30), ..base.clone() },
        Axes { speed: speeds(10), load: vec![5.0, 20.0], drive: vec![1e-6, DRIVE], ..base.clone() },
        Axes { speed: speeds(3), formulation: vec![Formulation::Series, Formulation::Paper], ..base },
    ];
    cases.iter().map(outcome).collect()
}

#[test]
fn default_figures_take_any_scenario() {
    for outcome in variants() {
        for name in ["resonance", "velocity-amplitude"] {
            check_layout(&draw(name, &outcome));
        }
    }
    let loads = draw("resonance", &variants()[2]).caption;
    assert!(loads.contains("2 curves coincide") && loads.contains("nested"), "{loads}");
}

#[test]
fn points_that_are_not_steady_are_counted_and_not_joined() {
    let whole = suited("velocity-amplitude");
    let mut sick = whole.clone();
    for (i, state) in sick.curves[0].states.iter_mut().enumerate().skip(40).take(10) {
        if i < 45 {
            state.status = Status::SelfExcited("test".into());
        } else {
            state.status = Status::Failed("test".into());
            (state.amplitude, state.phase, state.speed_amplitude) = (f64::NAN, f64::NAN, f64::NAN);
        }
    }
    for name in ["resonance", "velocity-amplitude"] {
        let (good, bad) = (draw(name, &whole), draw(name, &sick));
        assert!(bad.caption.contains("5 are self-excited") && bad.caption.contains("5 failed"), "{}", bad.caption);
        let circles = |drawing: &Drawing| drawing.svg.matches("<circle").count();
        let lines = |drawing: &Drawing| drawing.svg.matches("<polyline").count();
        assert!(circles(&bad) >= circles(&good) + 5, "{name}: no open marks");
        assert!(lines(&bad) > lines(&good), "{name}: the line is not interrupted");
        check_layout(&bad);
    }
}

#[test]
fn collapse_and_friction_report_the_spread_they_are_given() {
    let mut apart = suited("collapse");
    for state in &mut apart.curves[0].states {
        state.amplitude *= 1.02;
    }
    let note = &draw("collapse", &apart).notes[0].1;
    assert!((note.parse::<f64>().unwrap() - 0.02).abs() < 1e-3, "{note}");
    let mut apart = suited("friction-independence");
    apart.curves[3].states[50].amplitude *= 1.05;
    let drawing = draw("friction-independence", &apart);
    assert_eq!(drawing.notes[1].1, "0.05");
}

#[test]
fn png_has_the_scaled_size_and_refuses_nonsense() {
    let drawing = draw("rig-sketch", &suited("rig-sketch"));
    let png = figures::png(&drawing.svg, 0.5).unwrap();
    assert_eq!(&png[1..4], b"PNG");
    assert_eq!(u32::from_be_bytes(png[16..20].try_into().unwrap()), 550);
    assert!(matches!(figures::png("<svg", 1.0), Err(FigureError::Render(_))));
    assert!(matches!(figures::png(&drawing.svg, 0.0), Err(FigureError::Render(_))));
}

/// Writes every figure as PNG to `$STICKSLIP_FIGURES`, for looking at; does nothing where that is not set.
#[test]
fn gallery() {
    let Some(folder) = std::env::var_os("STICKSLIP_FIGURES") else { return };
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: String, drawing: &Drawing| {
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        std::fs::write(path, figures::png(&drawing.svg, 1.0).unwrap()).unwrap();
    };
    for name in figures::names() {
        write(name.into(), &draw(name, &suited(name)));
    }
    for (i, outcome) in variants().iter().enumerate() {
        for name in ["resonance", "velocity-amplitude"] {
            write(format!("{name}-{i}"), &draw(name, outcome));
        }
    }
}
