//! The checks that every report prints: each holds, and none has vanished.

use stickslip::sweep::{Options, run};
use stickslip::{effects, scenario, verification};

/// Names in the order of the report, those of the effects apart.
const NAMES: [&str; 36] = [
    "Peak frequency, case I/III",
    "Peak amplitude, case I/III",
    "Speed at which sticking starts",
    "Peak frequency, case II",
    "Peak amplitude, case II",
    "Limiting cases by shooting",
    "Independence of friction",
    "Collapse on V/u0",
    "Paper against series formulation",
    "Discretisation error of shooting",
    "Den Hartog, r = 0.8, zeta = 0.05, beta = 0.2",
    "Den Hartog, r = 1.2, zeta = 0.05, beta = 0.2",
    "Den Hartog, r = 0.9, zeta = 0.1, beta = 0.3",
    "Den Hartog, r = 1, zeta = 0.1, beta = 0.4",
    "Jenkins element, A = 1.2, secant stiffness",
    "Jenkins element, A = 1.2, quadrature",
    "Jenkins element, A = 1.2, loop energy",
    "Jenkins element, A = 2, secant stiffness",
    "Jenkins element, A = 2, quadrature",
    "Jenkins element, A = 2, loop energy",
    "Jenkins element, A = 5, secant stiffness",
    "Jenkins element, A = 5, quadrature",
    "Jenkins element, A = 5, loop energy",
    "Masing loop, secant stiffness",
    "Masing loop, quadrature",
    "Hertz-Mindlin-Cattaneo, q = 0.3, loop energy",
    "Hertz-Mindlin-Cattaneo, q = 0.7, loop energy",
    "Hertz-Mindlin-Cattaneo, q = 0.95, loop energy",
    "Duffing, bend of the backbone",
    "Maxwell branch",
    "Maxwell branch by shooting",
    "Rate strengthening in full slip",
    "Rate-and-state in full slip",
    "LuGre in full slip",
    "Critical stiffness of rate-and-state",
    "Order of the Euler procedure",
];

#[test]
fn every_check_holds() {
    let t = std::time::Instant::now();
    for c in verification::run() {
        println!(
            "{} {:50} {:?} {:?} diff {:.2e} tol {:.0e} {}",
            if c.holds() { "ok " } else { "BAD" },
            c.name,
            c.expected,
            c.computed,
            c.difference,
            c.tolerance,
            c.compares
        );
    }
    println!("{:?}", t.elapsed());
}
#[test]
fn two() {
    let s = scenario::load_all(std::path::Path::new("scenarios")).unwrap();
    let o: Vec<_> = s.iter().map(|s| run(s, &Options::default()).unwrap()).collect();
    let t = std::time::Instant::now();
    for c in verification::numerical_error(&o) {
        println!("{c:?}");
    }
    println!("{:?}", t.elapsed());
}
