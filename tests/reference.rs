//! Steady states against numbers that a separate program integrated (Newmark for the arm, trapezoidal stretch).

use stickslip::model::{Model, Operation};
use stickslip::scenario::{Contact, Formulation, Instrument, Rig};
use stickslip::solver::{Status, Warm, cycle::Tolerance, solve};

fn paper_model() -> Model {
    Model {
        rig: Rig {
            inertia: 5.0e-3,
            torsional_stiffness: 990.0,
            torsional_damping: 0.43,
            spring_stiffness: 1.6e4,
            spring_damping: 12.0,
            spring_arm: 0.03,
            contact_arm: 0.06,
        },
        contact: Contact { stiffness: 8.9e4, damping: 26.0, friction: 0.5, formulation: Formulation::Series },
        instrument: Instrument::default(),
        effects: Vec::new(),
    }
}

#[test]
fn base_rows_agree_to_1e_4() {
    let table = include_str!("data/effects.csv");
    let mut rows = 0;
    for line in table.lines().filter(|line| line.starts_with("none,")) {
        let v: Vec<f64> = line.split(',').skip(2).map(|v| v.parse().unwrap()).collect();
        let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3] };
        let t0 = std::time::Instant::now();
        let state = solve(&paper_model(), &at, 0, &Tolerance::default(), false, &mut Warm::default()).state;
        let el = t0.elapsed();
        println!("{line} {:.2e} {:.2e} stick {:.3} cycles {} {:?} {:?}", state.amplitude / v[4] - 1.0, state.phase - v[5], state.stick_fraction, state.cycles, state.status, el);
        assert_eq!(state.status, Status::Steady, "{line}");
        assert!((state.amplitude / v[4] - 1.0).abs() < 1e-4, "{line}: amplitude {:e}", state.amplitude);
        assert!((state.phase - v[5]).abs() < 1e-4, "{line}: phase {}", state.phase);
        assert!((state.mean - v[6]).abs() < 1e-4 * v[6].abs().max(1e-9), "{line}: mean {:e}", state.mean);
        rows += 1;
    }
    assert_eq!(rows, 25);
}
