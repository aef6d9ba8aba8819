//! Small motions: complex stiffnesses of the contact, and when steady sliding is stable.

use super::bench::{distance, dynamic_stiffness, hold, with};
use super::{Check, at, largest, value};
use crate::model::contact::Problem;
use crate::model::{Model, Operation};
use crate::solver::cycle::Tolerance;
use crate::solver::shooting;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// V of the checks in full slip \[m/s\].
const SPEED: f64 = 0.02;
/// Their frequencies \[Hz\].
const FREQUENCIES: [f64; 3] = [60.0, 72.0, 80.0];

/// Standard linear solid (Maxwell 1867, Zener 1948) without slip: Z = kc + i w cc + k1 i w tau/(1 + i w tau).
pub fn maxwell_branch() -> Vec<Check> {
    let (k1, tau) = (3e4, 2e-3);
    let model = with("maxwell-branch", &[k1, tau]);
    let frequencies = [55.0, 70.0, 82.0, 95.0];
    let closed = frequencies.map(|f| {
        let memory = Complex::new(0.0, TAU * f * tau);
        let expected = bristle(&model, f) + k1 * memory / (1.0 + memory);
        distance(dynamic_stiffness(&model, &at(0.0, f), Tolerance::default()), expected)
    });
    // The shooting solver, which is not asked for this point, gives it too.
    let shot = frequencies.map(|f| {
        let problem = Problem::new(&model, &at(0.0, f));
        let Ok(found) = shooting::solve(&problem, None, &Tolerance::default()) else { return f64::NAN };
        let (re, im) = found.cycle.fundamental;
        let (stuck, free): ((f64, f64), _) = (problem.lumps.stuck_response(), problem.free());
        distance(Complex::new(free.0 + re, free.1 + im), Complex::new(stuck.0, stuck.1))
    });
    let how = "complex stiffness of the stuck contact against the standard linear solid (Zener 1948), 55 to 95 Hz";
    let how_shot = "the same state by shooting against its closed form";
    vec![largest("Maxwell branch", how, closed, 1e-9), largest("Maxwell branch by shooting", how_shot, shot, 1e-6)]
}

/// kc + i w cc.
fn bristle(model: &Model, frequency: f64) -> Complex<f64> {
    Complex::new(model.contact.stiffness, TAU * frequency * model.contact.damping)
}

/// Distances of the contact in full slip under the drive `drive` from the bristles in series with the interface,
/// a dashpot eta(w).
fn full_slip(model: &Model, drive: f64, eta: impl Fn(f64) -> Complex<f64>) -> [f64; 3] {
    FREQUENCIES.map(|f| {
        let w = TAU * f;
        let (bristle, interface) = (bristle(model, f), Complex::new(0.0, w) * eta(w));
        let operation = Operation { drive, ..at(SPEED, f) };
        let found = dynamic_stiffness(model, &operation, Tolerance::default());
        distance(found, bristle * interface / (bristle + interface))
    })
}

/// Full slip, u0 -> 0: eta = N dmu/ds = N beta/(v0 + V) (the logarithm of Dieterich 1979).
pub fn rate_strengthening() -> Vec<Check> {
    let (beta, v0) = (0.2, 1e-3);
    let found = full_slip(&with("rate-strengthening", &[beta, v0]), 1e-10, |_| (20.0 * beta / (v0 + SPEED)).into());
    let how =
        "full slip, u0 -> 0: complex stiffness against bristles in series with the dashpot N dmu/ds (Dieterich 1979)";
    vec![largest("Rate strengthening in full slip", how, found, 1e-5)]
}

/// Full slip, u0 -> 0: eta(w) = N/(V + v0) [a - B (v0/V)/(1 + i w Dc/V)], the derivative of the law as it stands, with
/// the one under each logarithm. Without those ones it is the (N/V)[a - B/(1 + i w Dc/V)] of Ruina (1983).
pub fn rate_and_state() -> Vec<Check> {
    let (a, b, v0, dc) = (0.1, 0.06, 0.05, 6e-5);
    let found = full_slip(&with("rate-and-state", &[a, b, v0, dc]), 1e-10, |w| {
        20.0 / (SPEED + v0) * (a - b * v0 / SPEED / Complex::new(1.0, w * dc / SPEED))
    });
    let how =
        "full slip, u0 -> 0: complex stiffness against the linearised law (Ruina 1983) in series with the bristles";
    vec![largest("Rate-and-state in full slip", how, found, 1e-5)]
}

/// LuGre (Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995) with constant mu has no linear response in full
/// slip but for its viscous term: Z = i w sigma2.
pub fn lugre() -> Vec<Check> {
    let sigma = 8.0;
    let model = with("lugre", &[sigma]);
    let found = FREQUENCIES.map(|f| {
        let operation = Operation { drive: 1e-9, ..at(SPEED, f) };
        distance(dynamic_stiffness(&model, &operation, Tolerance::default()), Complex::new(0.0, TAU * f * sigma))
    });
    let how = "full slip, u0 -> 0: complex stiffness against the viscous term (Canudas de Wit et al. 1995)";
    vec![largest("LuGre in full slip", how, found, 1e-5)]
}

/// Ruina, Slip instability and state variable friction laws, J. Geophys. Res. 88 (1983): sliding through springs softer
/// than (B - a) N/Dc is unstable; with the ones under the logarithms and V = v0 both coefficients count half.
pub fn critical_stiffness() -> Vec<Check> {
    let (a, b, dc) = (0.01, 0.05, 1e-4);
    let expected = 0.5 * (b - a) * 20.0 / dc;
    let multiplier = |stiffness: f64| {
        // The arm is held: only the bristles give way.
        let mut model = with("rate-and-state", &[a, b, SPEED, dc]);
        hold(&mut model, 1e6);
        model.contact.damping = 0.0;
        model.contact.stiffness = stiffness;
        let problem = Problem::new(&model, &at(SPEED, 70.0));
        let found = shooting::solve(&problem, None, &Tolerance { steps: 200, roughness: 1e-4, ..Tolerance::default() });
        found.map_or(f64::NAN, |found| found.multiplier)
    };
    let (mut soft, mut stiff) = (0.8 * expected, 1.25 * expected);
    let bracketed = multiplier(soft) > 1.0 && multiplier(stiff) < 1.0;
    for _ in 0..12 {
        let middle = 0.5 * (soft + stiff);
        *(if multiplier(middle) > 1.0 { &mut soft } else { &mut stiff }) = middle;
    }
    let computed = if bracketed { 0.5 * (soft + stiff) } else { f64::NAN };
    let how = "rate-and-state sliding (Ruina 1983): stiffness of the bristles below which a disturbance grows";
    vec![value("Critical stiffness of rate-and-state", how, "N/m", expected, computed, 3e-3)]
}
