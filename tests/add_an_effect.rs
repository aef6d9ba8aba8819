//! Keeps the section "Add an effect" of `CONTRIBUTING.md` true: its worked example is compiled, and solved.

mod common;

use common::{at, complex, paper_model, steady};
use stickslip::effects::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use stickslip::model::Model;
use stickslip::scenario::Formulation::Series;

#[path = "../src/effects/viscous_film.rs"]
mod viscous_film;

#[test]
fn the_page_shows_the_file_that_is_compiled_here() {
    let page = include_str!("../CONTRIBUTING.md").replace("\r\n", "\n");
    let file = include_str!("../src/effects/viscous_film.rs").replace("\r\n", "\n");
    assert!(page.contains(&format!("```rust\n{file}```\n")));
}

#[test]
fn the_worked_example_is_a_dashpot_in_series_with_the_bristles() {
    static FILM: viscous_film::ViscousFilm = viscous_film::ViscousFilm;
    let b = 5.0;
    let model = Model { effects: vec![(&FILM, vec![b])], ..paper_model(Series) };
    let (rig, contact) = (*model.rig.arm(), model.contact);
    for frequency in [60.0, 71.0, 80.0] {
        let at = at(0.02, frequency);
        let w = std::f64::consts::TAU * frequency;
        // 1/Z = 1/(kc + i w cc) + 1/(i w b W)
        let (k, c, eta) = (contact.stiffness, w * contact.damping, w * b * at.load);
        let square = k * k + c * c;
        let (re, im) = (k / square, -c / square - 1.0 / eta);
        let square = re * re + im * im;
        let (z_re, z_im) = (re / square, -im / square);
        let (a2, b2) = (rig.spring_arm * rig.spring_arm, rig.contact_arm * rig.contact_arm);
        let stiffness = rig.torsional_stiffness + 2.0 * a2 * rig.spring_stiffness - rig.inertia * w * w + b2 * z_re;
        let damping = w * (rig.torsional_damping + 2.0 * a2 * rig.spring_damping) + b2 * z_im;
        // (stiffness + i damping) times the response is the torque of the drive.
        let state = steady(&model, &at);
        let (x, y) = complex(&state);
        let torque = (stiffness * x - damping * y, stiffness * y + damping * x);
        let u = rig.spring_arm * at.drive;
        let (expected_re, expected_im) = (u * rig.spring_stiffness, u * w * rig.spring_damping);
        let error = (torque.0 - expected_re).hypot(torque.1 - expected_im) / expected_re;
        assert!(error < 1e-6, "{frequency} Hz: {error:e}");
    }
}
