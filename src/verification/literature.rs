//! Closed forms of the literature for dry friction and for the nonlinear arm.

use super::bench::{arm_stiffness, dynamic_stiffness, free_stroke, hold, with};
use super::{Check, at, value};
use crate::model::{Model, Operation};
use crate::scenario;
use crate::solver::cycle::Tolerance;
use crate::solver::{Status, Warm, orbit, solve};
use std::f64::consts::{PI, TAU};

/// Den Hartog, Forced vibrations with combined Coulomb and viscous friction, Trans. ASME 53 (1931): motion without
/// stops, peak displacement times k over P, friction beta P. At r = w/wn, with q = sqrt(1 - zeta^2): x k/P = -G beta +
/// sqrt(V^2 - (H beta)^2), V^-2 = (1 - r^2)^2 + (2 zeta r)^2, G = [sinh(zeta pi/r) - zeta/q sin(q pi/r)]/D, H = sin(q
/// pi/r)/(q r D), D = cosh(zeta pi/r) + cos(q pi/r).
pub fn den_hartog() -> Vec<Check> {
    let rows = [(0.8, 0.05, 0.2), (1.2, 0.05, 0.2), (0.9, 0.1, 0.3), (1.0, 0.1, 0.4)];
    rows.map(|(r, zeta, beta)| {
        let q = (1.0f64 - zeta * zeta).sqrt();
        let (decay, turn): (f64, f64) = (zeta * PI / r, q * PI / r);
        let d = decay.cosh() + turn.cos();
        let (g, h) = ((decay.sinh() - zeta / q * turn.sin()) / d, turn.sin() / (q * r * d));
        let expected =
            (1.0 / ((1.0 - r * r).powi(2) + (2.0 * zeta * r).powi(2)) - (h * beta).powi(2)).sqrt() - g * beta;
        let name = format!("Den Hartog, r = {r}, zeta = {zeta}, beta = {beta}");
        let how = "Coulomb and viscous friction on a mass (Den Hartog 1931): peak displacement times k/P";
        value(name, how, "1", expected, den_hartog_peak(r, zeta, beta), 2e-4)
    })
    .to_vec()
}

fn den_hartog_peak(r: f64, zeta: f64, beta: f64) -> f64 {
    let mut model = Model::new(&scenario::paper());
    // Springs without damping make the drive torque a u0 k0 = P. The contact is as good as rigid, and critically damped
    // so that it does not ring.
    let (stiffness, inertia, b) = (arm_stiffness(&model), model.rig.arm().inertia, model.rig.lever());
    model.rig.arm_mut().spring_damping = 0.0;
    model.rig.arm_mut().torsional_damping = 2.0 * zeta * (inertia * stiffness).sqrt();
    model.contact.stiffness = RIGID * stiffness / (b * b);
    model.contact.damping = 2.0 * (model.contact.stiffness * inertia).sqrt() / b;
    let drive = 2.5e-6;
    let torque = model.rig.arm().spring_arm * drive * model.rig.arm().spring_stiffness;
    let load = beta * torque / b / model.contact.friction;
    let operation = Operation { speed: 0.0, load, drive, frequency: r * (stiffness / inertia).sqrt() / TAU, series: 0 };
    let path = orbit(&model, &operation, 0, &Tolerance::default(), 4000);
    // No orbit, no peak.
    path.angle.iter().map(|th| th.abs()).reduce(f64::max).unwrap_or(f64::NAN) * stiffness / torque
}

/// Stiffness of the contact over that of the arm in place of a rigid contact.
const RIGID: f64 = 3e4;

/// Stroke over the stretch at which the slider gives way.
const JENKINS: [f64; 3] = [1.2, 2.0, 5.0];

/// Jenkins element, a spring in series with a slider: Caughey, Sinusoidal excitation of a system with bilinear
/// hysteresis, J. Appl. Mech. 27 (1960). For a stroke A times the stretch at slip, cos theta = 1 - 2/A: secant
/// stiffness (theta - sin(2 theta)/2)/pi, quadrature 4 (A - 1)/(pi A^2), energy of the loop 4 F (X - X/A).
pub fn jenkins() -> Vec<Check> {
    let mut checks = Vec::new();
    for ratio in JENKINS {
        let found = jenkins_loop(ratio);
        let theta = (1.0f64 - 2.0 / ratio).acos();
        let secant = (theta - 0.5 * (2.0 * theta).sin()) / PI;
        let quadrature = 4.0 * (ratio - 1.0) / (PI * ratio * ratio);
        let energy = 4.0 * (1.0 - 1.0 / ratio) / ratio;
        let how = |what: &str| {
            format!("spring and slider in series (Caughey 1960), stroke {ratio} times that at slip: {what}")
        };
        let check = |what: &str, how: &str, expected, computed| {
            value(format!("Jenkins element, A = {ratio}, {what}"), how, "1", expected, computed, 1e-5)
        };
        checks.extend([
            check("secant stiffness", &how("in-phase part of the force over kc X"), secant, found[0]),
            check("quadrature", &how("part of the force against the velocity, over kc X"), quadrature, found[1]),
            check("loop energy", &how("work per cycle over kc X^2"), energy, found[2]),
        ]);
    }
    checks
}

/// Secant stiffness, quadrature and energy of the loop, over kc, kc and kc X^2; from the force itself, since the arm
/// hardly feels it.
fn jenkins_loop(ratio: f64) -> [f64; 3] {
    let mut model = Model::new(&scenario::paper());
    model.contact.damping = 0.0;
    hold(&mut model, 1e6);
    let (stroke, phase) = free_stroke(&model);
    let load = model.contact.stiffness * stroke / ratio / model.contact.friction;
    let operation = Operation { load, ..at(0.0, 60.0) };
    let path = orbit(&model, &operation, 0, &Tolerance { steps: 64, roughness: 1e-4, ..Tolerance::default() }, 20_000);
    let share = 2.0 / path.time.len() as f64;
    let mut sums = [0.0; 3];
    for ((t, force), w) in path.time.iter().zip(&path.force).zip(&path.velocity) {
        let angle = TAU * operation.frequency * t + phase;
        sums[0] -= share * force * angle.sin();
        sums[1] -= share * force * angle.cos();
        sums[2] -= 0.5 * share * force * model.rig.lever() * w / operation.frequency;
    }
    let scale = model.contact.stiffness * stroke;
    // An empty orbit is no loop.
    if path.time.is_empty() { [f64::NAN; 3] } else { [sums[0] / scale, sums[1] / scale, sums[2] / (scale * stroke)] }
}

/// A continuum of sliders under an arm that moves as if it were free, with the stroke X at `reach` of the stretch at
/// which the last one gives way; the dynamic stiffness of the contact over kc.
fn continuum(n: f64, reach: f64) -> (f64, f64) {
    let mut model = with("partial-slip", &[n]);
    model.contact.damping = 0.0;
    hold(&mut model, 1e5);
    let most = model.contact.stiffness * free_stroke(&model).0 / reach / n;
    let operation = Operation { load: most / model.contact.friction, ..at(0.0, 60.0) };
    let found = dynamic_stiffness(&model, &operation, Tolerance::default()) / model.contact.stiffness;
    (found.re, found.im)
}

/// Masing, Eigenspannungen und Verfestigung beim Messing (1926): each branch of the loop is the first loading doubled
/// and shifted. Fundamental of that loop by quadrature, for the first loading F = mu N [1 - (1 - x/xm)^2].
pub fn masing() -> Vec<Check> {
    let (n, reach) = (2.0, 0.6);
    // In units of kc X for the force and of X for the stretch.
    let loading = |x: f64| (1.0 - (1.0 - reach * x).powf(n)) / (n * reach);
    let (mut secant, mut quadrature) = (0.0, 0.0);
    let count = 20_000;
    for i in 0..count {
        let angle = PI * (i as f64 + 0.5) / count as f64;
        let force = loading(1.0) - 2.0 * loading(0.5 * (1.0 - angle.cos()));
        secant += 2.0 / count as f64 * force * angle.cos();
        quadrature -= 2.0 / count as f64 * force * angle.sin();
    }
    let found = continuum(n, reach);
    let how = "continuum of sliders (n = 2, stroke 60 % of that of gross slip) against Masing's branches (1926): ";
    vec![
        value("Masing loop, secant stiffness", &format!("{how}in-phase part over kc"), "1", secant, found.0, 1e-5),
        value(
            "Masing loop, quadrature",
            &format!("{how}part against the velocity over kc"),
            "1",
            quadrature,
            found.1,
            5e-3,
        ),
    ]
}

/// Hertz-Mindlin-Cattaneo, the ball on a flat (n = 3/2): Mindlin and Deresiewicz, Elastic spheres in contact under
/// varying oblique forces, J. Appl. Mech. 20 (1953). Energy of the loop of force amplitude q mu N, times k0/(mu N)^2:
/// 36/5 {1 - (1 - q)^(5/3) - 5/6 q [1 + (1 - q)^(2/3)]}. Of a harmonic motion the quadrature does all the work, pi X^2
/// Im Z.
pub fn mindlin() -> Vec<Check> {
    [0.3f64, 0.7, 0.95]
        .map(|q| {
            let left = (1.0 - q).powf(2.0 / 3.0);
            let expected = 7.2 * (1.0 - (1.0 - q) * left - 5.0 / 6.0 * q * (1.0 + left));
            let stretch = 1.5 * (1.0 - left);
            let computed = PI * stretch * stretch * continuum(1.5, 1.0 - left).1;
            let how = "ball on a flat in partial slip (Mindlin and Deresiewicz 1953): work per cycle times k0/(mu N)^2";
            value(format!("Hertz-Mindlin-Cattaneo, q = {q}, loop energy"), how, "1", expected, computed, 5e-3)
        })
        .to_vec()
}

/// Duffing, Erzwungene Schwingungen bei veraenderlicher Eigenfrequenz (1918), in one harmonic: at the phase of -90
/// degrees against the drive torque the response lies on the backbone w^2 = (K + 3/4 K3 alpha^2)/J.
pub fn duffing() -> Vec<Check> {
    // A lightly damped arm in full slip under hardly any load, so that the static angle is nothing.
    let k3 = 2e9;
    let mut model = with("cubic-stiffness", &[k3]);
    model.rig.arm_mut().torsional_damping = 0.03;
    model.rig.arm_mut().spring_damping = 0.0;
    let (stiffness, inertia) = (arm_stiffness(&model), model.rig.arm().inertia);
    let natural = |alpha: f64| ((stiffness + 0.75 * k3 * alpha * alpha) / inertia).sqrt() / TAU;
    let (frequency, alpha) = resonance(&model).unwrap_or((f64::NAN, f64::NAN));
    let how =
        "cubic stiffness (Duffing 1918): by how much the frequency at a phase of -90 degrees lies above the linear one";
    // The shift, so that the bend of the backbone is what is compared.
    let shift = |f: f64| f - natural(0.0);
    vec![value("Duffing, bend of the backbone", how, "Hz", shift(natural(alpha)), shift(frequency), 2e-3)]
}

/// Frequency and amplitude at which the phase falls through -90 degrees, followed up the resonant branch.
fn resonance(model: &Model) -> Option<(f64, f64)> {
    let mut warm = Warm::default();
    let (mut phase, mut alpha) = (0.0, 0.0);
    let step = 0.02;
    for i in 0..2500 {
        let operation = Operation { load: 1e-9, ..at(0.5, 70.0 + step * i as f64) };
        let tolerance = Tolerance { steps: 64, roughness: 1e-3, ..Tolerance::default() };
        let now = solve(model, &operation, 0, &tolerance, false, &mut warm).state;
        if now.status != Status::Steady {
            return None;
        }
        if now.phase < -0.5 * PI {
            let back = (now.phase + 0.5 * PI) / (now.phase - phase);
            return Some((operation.frequency - step * back, now.amplitude - back * (now.amplitude - alpha)));
        }
        (phase, alpha) = (now.phase, now.amplitude);
    }
    None
}
