//! Puts an effect of one's own, as the worked example of `CONTRIBUTING.md` is, into the model of a scenario and solves
//! it.
#![allow(clippy::print_stdout)]

use stickslip::effects::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use stickslip::model::{Model, Operation};
use stickslip::solver::{Warm, cycle::Tolerance, solve_steady};

#[path = "../src/effects/viscous_film.rs"]
mod viscous_film;

fn main() {
    static FILM: viscous_film::ViscousFilm = viscous_film::ViscousFilm;
    let base = Model::new(&stickslip::scenario::paper());
    let slope = 2.0; // s/m
    let with_film = Model { effects: vec![(&FILM, vec![slope])], ..base.clone() };
    for frequency in [60.0, 70.0, 80.0] {
        let at = Operation { speed: 0.05, load: 20.0, drive: 2.5e-6, frequency, series: 0 };
        let [without, with] = [&base, &with_film]
            .map(|model| solve_steady(model, &at, &Tolerance::default(), false, &mut Warm::default()).state.amplitude);
        println!("{frequency} Hz: {without:.3e} rad, with {} {with:.3e} rad", FILM.title());
    }
}
