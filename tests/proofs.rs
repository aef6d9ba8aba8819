//! The contact against results of the literature, each in closed form and written by nobody here.

mod common;

use common::{at, complex, paper_model, steady};
use std::f64::consts::{PI, TAU};
use stickslip::effects;
use stickslip::model::contact::Problem;
use stickslip::model::system::HybridSystem;
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;
use stickslip::solver::cycle::{Record, Tolerance};
use stickslip::solver::radau::A;
use stickslip::solver::{Status, Warm, orbit, shooting, solve};

fn with(name: &str, parameters: &[f64]) -> Model {
    let mut model = paper_model(Series);
    model.effects.push((effects::find(name).unwrap(), parameters.to_vec()));
    model
}

/// Complex dynamic stiffness of the contact that turns the free arm into the arm of amplitude `a`:
/// b^2 Z = Gamma e^{i phi0}/a - (K - J w^2 + i w C).
fn dynamic_stiffness(model: &Model, operation: &Operation) -> (f64, f64) {
    let state = steady(model, operation);
    assert_eq!(state.status, Status::Steady, "{operation:?}");
    let (re, im) = complex(&state);
    let w = TAU * operation.frequency;
    let rig = &model.rig;
    let lever = rig.spring_arm * operation.drive;
    let gamma = (lever * rig.spring_stiffness, lever * rig.spring_damping * w);
    let square = re * re + im * im;
    let ratio = ((gamma.0 * re + gamma.1 * im) / square, (gamma.1 * re - gamma.0 * im) / square);
    let stiffness = rig.torsional_stiffness + 2.0 * rig.spring_arm.powi(2) * rig.spring_stiffness;
    let damping = rig.torsional_damping + 2.0 * rig.spring_arm.powi(2) * rig.spring_damping;
    let b2 = rig.contact_arm.powi(2);
    ((ratio.0 - stiffness + rig.inertia * w * w) / b2, (ratio.1 - w * damping) / b2)
}

fn close(found: (f64, f64), expected: (f64, f64), tolerance: f64, what: &str) {
    let error = (found.0 - expected.0).hypot(found.1 - expected.1) / expected.0.hypot(expected.1);
    assert!(error < tolerance, "{what}: {found:?} instead of {expected:?}, {error:e}");
}

/// (kc + i w cc) and i w eta in series, eta complex.
fn in_series(model: &Model, frequency: f64, eta: (f64, f64)) -> (f64, f64) {
    let w = TAU * frequency;
    let bristle = (model.contact.stiffness, w * model.contact.damping);
    let interface = (-w * eta.1, w * eta.0);
    let product =
        (bristle.0 * interface.0 - bristle.1 * interface.1, bristle.0 * interface.1 + bristle.1 * interface.0);
    let sum = (bristle.0 + interface.0, bristle.1 + interface.1);
    let square = sum.0 * sum.0 + sum.1 * sum.1;
    ((product.0 * sum.0 + product.1 * sum.1) / square, (product.1 * sum.0 - product.0 * sum.1) / square)
}

/// Den Hartog (1931): forced vibration with dry friction, motion without stops; peak displacement times k over P.
#[test]
fn den_hartog() {
    for (r, zeta, beta, expected) in
        [(0.8, 0.05, 0.2, 2.50014), (1.2, 0.05, 0.2, 1.96685), (0.9, 0.1, 0.3, 2.69765), (1.0, 0.1, 0.4, 2.45007)]
    {
        let mut model = paper_model(Series);
        // Springs c0 = 0 make the drive torque a u0 k0 = P; the contact is as good as rigid and critically damped, so
        // that it does not ring.
        let stiffness = 1018.8;
        let inertia = model.rig.inertia;
        let wn = (stiffness / inertia as f64).sqrt();
        model.rig.spring_damping = 0.0;
        model.rig.torsional_damping = 2.0 * zeta * (inertia * stiffness).sqrt();
        let drive = 2.5e-6;
        let torque = model.rig.spring_arm * drive * model.rig.spring_stiffness;
        let b = model.rig.contact_arm;
        let rigid = 3e4 * stiffness / (b * b);
        model.contact.stiffness = rigid;
        model.contact.damping = 2.0 * (rigid * inertia).sqrt() / b;
        model.contact.friction = 0.5;
        let load = beta * torque / b / 0.5;
        let operation = Operation { speed: 0.0, load, drive, frequency: r * wn / TAU };
        let path = orbit(&model, &operation, 0, &Tolerance::default(), 4000);
        let peak = path.angle.iter().fold(0.0f64, |m, th| m.max(th.abs())) * stiffness / torque;
        assert!((peak / expected - 1.0).abs() < 2e-3, "r {r} zeta {zeta} beta {beta}: {peak} {expected}");
    }
}

/// Jenkins element (Caughey 1960): secant stiffness and quadrature of the fundamental, energy of the loop.
#[test]
fn jenkins_element() {
    for (ratio, stiffness, quadrature) in [(1.2, 0.89045, 0.17684), (2.0, 0.5, 1.0 / PI), (5.0, 0.142378, 0.203719)] {
        // An arm so heavy and stiff that the contact does not change its harmonic motion.
        let mut model = paper_model(Series);
        model.contact.damping = 0.0;
        let heavy = 1e5;
        model.rig.inertia *= heavy;
        model.rig.torsional_stiffness *= heavy;
        model.rig.torsional_damping *= heavy;
        model.rig.spring_stiffness *= heavy;
        model.rig.spring_damping *= heavy;
        let free = steady(&model, &Operation { load: 0.0, ..at(0.0, 60.0) }).amplitude;
        let stroke = model.rig.contact_arm * free;
        let slip_force = model.contact.stiffness * stroke / ratio;
        let operation = Operation { load: slip_force / model.contact.friction, ..at(0.0, 60.0) };
        // From the force itself, since the arm hardly feels it.
        let path = orbit(&model, &operation, 0, &Tolerance { steps: 64, roughness: 1e-4 }, 20_000);
        let (amplitude, phase) = (free, steady(&model, &Operation { load: 0.0, ..operation }).phase);
        let (mut in_phase, mut against, mut loop_energy) = (0.0, 0.0, 0.0);
        let share = 2.0 / path.time.len() as f64;
        for ((t, force), w) in path.time.iter().zip(&path.force).zip(&path.velocity) {
            let angle = TAU * operation.frequency * t + phase;
            in_phase -= share * force * angle.sin();
            against -= share * force * angle.cos();
            loop_energy -= 0.5 * share * force * model.rig.contact_arm * w / operation.frequency;
        }
        let scale = model.contact.stiffness * model.rig.contact_arm * amplitude;
        assert!((in_phase / scale - stiffness).abs() < 3e-5, "A {ratio}: {}", in_phase / scale);
        assert!((against / scale - quadrature).abs() < 3e-5, "A {ratio}: {}", against / scale);
        let expected = 4.0 * slip_force * (stroke - stroke / ratio);
        assert!((loop_energy / expected - 1.0).abs() < 1e-3, "A {ratio}: {loop_energy:e} {expected:e}");
    }
}

/// Masing (1926): each branch of the loop is the first loading doubled and shifted, for the continuum of sliders.
#[test]
fn masing_branches() {
    let n = 2.0;
    let mut model = with("partial-slip", &[n]);
    model.contact.damping = 0.0;
    let heavy = 1e5;
    model.rig.inertia *= heavy;
    model.rig.torsional_stiffness *= heavy;
    model.rig.torsional_damping *= heavy;
    model.rig.spring_stiffness *= heavy;
    model.rig.spring_damping *= heavy;
    let free = steady(&model, &Operation { load: 0.0, ..at(0.0, 60.0) }).amplitude;
    let stroke = model.rig.contact_arm * free;
    // Stroke of 60 % of the travel at which the last slider gives way.
    let most = model.contact.stiffness * stroke / 0.6 / n;
    let operation = Operation { load: most / model.contact.friction, ..at(0.0, 60.0) };
    let reach = n * most / model.contact.stiffness;
    let loading = |x: f64| most * (1.0 - (1.0 - x / reach).powf(n));
    // Fundamental of the Masing loop of that amplitude, by quadrature of the two branches.
    let peak = loading(stroke);
    let (mut in_phase, mut against) = (0.0, 0.0);
    let count = 20_000;
    for i in 0..count {
        let angle = PI * (i as f64 + 0.5) / count as f64;
        let force = peak - 2.0 * loading(0.5 * stroke * (1.0 - angle.cos()));
        in_phase += 2.0 / count as f64 * force * angle.cos();
        against -= 2.0 / count as f64 * force * angle.sin();
    }
    let found = dynamic_stiffness(&model, &operation);
    close(found, (in_phase / stroke, against / stroke), 2e-3, "Masing loop");
}

/// Standard linear solid at V = 0 without slip: K(iw) = kc + i w cc + k1 i w tau/(1 + i w tau).
#[test]
fn maxwell_branch() {
    let (k1, tau) = (3e4, 2e-3);
    let model = with("maxwell-branch", &[k1, tau]);
    for f in [55.0, 70.0, 82.0, 95.0] {
        let w = TAU * f;
        let wt = w * tau;
        let expected = (8.9e4 + k1 * wt * wt / (1.0 + wt * wt), w * 26.0 + k1 * wt / (1.0 + wt * wt));
        close(dynamic_stiffness(&model, &at(0.0, f)), expected, 1e-9, "closed form");
        // The shooting solver, which is not asked for this point, gives it too.
        let problem = Problem::new(&model, &at(0.0, f));
        let found = shooting::solve(&problem, None, &Tolerance::default()).unwrap().cycle.fundamental;
        let (stuck, free) = (problem.lumps.stuck_response(), problem.lumps.free_response());
        close((free.0.value + found.0, free.1.value + found.1), (stuck.0.value, stuck.1.value), 1e-6, "shooting");
    }
}

/// Full slip, u0 -> 0: the interface is the dashpot eta = N dmu/ds in series with the bristles.
#[test]
fn rate_strengthening_in_full_slip() {
    let (beta, v0, speed) = (0.2, 1e-3, 0.02);
    let model = with("rate-strengthening", &[beta, v0]);
    for f in [60.0, 72.0, 80.0] {
        let operation = Operation { drive: 1e-10, ..at(speed, f) };
        let expected = in_series(&model, f, (20.0 * beta / (v0 + speed), 0.0));
        close(dynamic_stiffness(&model, &operation), expected, 1e-4, "rate strengthening");
    }
}

/// Full slip, u0 -> 0: eta(w) = N/(V + v0) [a - B (v0/V)/(1 + i w Dc/V)], the derivative of the law as it stands, with the
/// one under each logarithm. Without those ones it is the (N/V)[a - B/(1 + i w Dc/V)] of the textbooks.
#[test]
fn rate_and_state_in_full_slip() {
    let (a, b, v0, dc, speed) = (0.1, 0.06, 0.05, 6e-5, 0.02);
    let model = with("rate-and-state", &[a, b, v0, dc]);
    for f in [60.0, 72.0, 80.0] {
        let operation = Operation { drive: 1e-10, ..at(speed, f) };
        let q = TAU * f * dc / speed;
        let memory = b * v0 / speed / (1.0 + q * q);
        let eta = (20.0 / (speed + v0) * (a - memory), 20.0 / (speed + v0) * memory * q);
        close(dynamic_stiffness(&model, &operation), in_series(&model, f, eta), 2e-4, "rate and state");
    }
}

/// LuGre with constant mu has no linear response in full slip but for its viscous term.
#[test]
fn lugre_in_full_slip() {
    let sigma = 8.0;
    let model = with("lugre", &[sigma]);
    for f in [60.0, 72.0, 80.0] {
        let operation = Operation { drive: 1e-9, ..at(0.02, f) };
        close(dynamic_stiffness(&model, &operation), (0.0, TAU * f * sigma), 1e-3, "lugre");
    }
}

/// Duffing: the arm without contact in one harmonic; backbone w^2 = (K + 3/4 K3 alpha^2)/J. At the phase of -90 degrees
/// against the drive torque the response lies on it, up to third harmonics.
#[test]
fn duffing_backbone() {
    // A lightly damped arm in full slip under hardly any load, so that the static angle is nothing.
    let k3 = 2e9;
    let mut model = with("cubic-stiffness", &[k3]);
    model.rig.torsional_damping = 0.03;
    model.rig.spring_damping = 0.0;
    let stiffness = 1018.8;
    let state = |f: f64, warm: &mut Warm| {
        let operation = Operation { load: 1e-9, ..at(0.5, f) };
        solve(&model, &operation, 0, &Tolerance { steps: 64, roughness: 1e-3 }, false, warm).state
    };
    // Up the frequency the resonant branch is followed until its phase has fallen to -90 degrees.
    let mut warm = Warm::default();
    let mut last = (0.0, 0.0, 0.0);
    let mut f = 70.0;
    loop {
        let now = state(f, &mut warm);
        assert_eq!(now.status, Status::Steady, "{f} {now:?}");
        if now.phase < -0.5 * PI {
            let share = (-0.5 * PI - last.1) / (now.phase - last.1);
            let frequency = f - 0.02 * (1.0 - share);
            let alpha = last.2 + share * (now.amplitude - last.2);
            let expected = ((stiffness + 0.75 * k3 * alpha * alpha) / 0.005).sqrt() / TAU;
            assert!(expected - (stiffness / 0.005f64).sqrt() / TAU > 0.3, "the backbone must bend: {expected}");
            assert!((frequency / expected - 1.0).abs() < 2e-4, "{frequency} {expected}");
            break;
        }
        assert!(f < 120.0, "no resonance found");
        last = (f, now.phase, now.amplitude);
        f += 0.02;
    }
}

/// Rate-and-state spring slider: sliding through springs softer than (B - a) N/Dc is unstable (Ruina 1983); with the ones
/// under the logarithms and V = v0 both coefficients count half.
#[test]
fn critical_stiffness_of_rate_and_state() {
    let (a, b, dc, speed) = (0.01, 0.05, 1e-4, 0.02);
    let critical = 0.5 * (b - a) * 20.0 / dc;
    for (factor, stable) in [(0.8, false), (1.25, true)] {
        let mut model = with("rate-and-state", &[a, b, speed, dc]);
        // The arm is held: only the bristles give way.
        model.rig.inertia *= 1e6;
        model.rig.torsional_stiffness *= 1e6;
        model.rig.torsional_damping *= 1e6;
        model.rig.spring_stiffness *= 1e6;
        model.rig.spring_damping *= 1e6;
        model.contact.damping = 0.0;
        model.contact.stiffness = critical * factor;
        let problem = Problem::new(&model, &Operation { drive: 2.5e-6, ..at(speed, 70.0) });
        let found = shooting::solve(&problem, None, &Tolerance { steps: 200, roughness: 1e-4 }).unwrap();
        assert_eq!(found.multiplier < 1.0, stable, "{factor}: {}", found.multiplier);
    }
}

/// Over a steady period the work of drive and roller is what dissipates in C, the bristles, the interface, branch,
/// support and torques, for every effect of the catalogue.
#[test]
fn energy_balance_of_every_effect() {
    let table = include_str!("data/effects.csv");
    let mut names = std::collections::BTreeSet::new();
    for line in table.lines().skip(1) {
        let c: Vec<&str> = line.split(',').collect();
        let v: Vec<f64> = c[2..].iter().map(|v| v.parse().unwrap()).collect();
        if v[3] != 74.0 || c[0] == "none" || c[0] == "partial-slip" {
            continue;
        }
        let effect = effects::find(c[0]).unwrap();
        let value = |key: &str| -> f64 {
            c[1].split(' ').find_map(|w| w.strip_prefix(key)?.strip_prefix('=')).unwrap().parse().unwrap()
        };
        let parameters: Vec<f64> = effect.parameters().iter().map(|p| value(p.key)).collect();
        let model = with(c[0], &parameters);
        let operation = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3] };
        let problem = Problem::new(&model, &operation);
        let tolerance = Tolerance { steps: 96, roughness: 1e-4 };
        let Ok(periodic) = shooting::solve(&problem, None, &tolerance) else { continue };
        let lumps = &problem.lumps;
        let (mut supplied, mut to_arm, mut to_contact, mut lost) = (0.0, 0.0, 0.0, 0.0);
        let mut add = |r: &Record| {
            for i in 0..3 {
                let h = r.size * A[2][i];
                let (z, s, forcing) = (&r.stepper.z[i], r.stepper.s[i], &r.stepper.forcing[i]);
                let (th, w) = (forcing.angle + z[0], forcing.velocity + z[1]);
                let force = problem.force(forcing, z, s).0;
                let torque = lumps.torque_re.value * forcing.sine + lumps.torque_im.value * forcing.cosine;
                supplied += h * torque * w;
                to_arm += h * force * model.rig.contact_arm * w;
                to_contact += h * force * operation.speed;
                let resisting = effect.torque(&parameters, th, w).map_or(0.0, |law| law.value);
                lost += h * (lumps.damping.value * w * w - resisting * w);
            }
        };
        shooting::trace(&problem, &periodic.start, &tolerance, &mut add).unwrap();
        // Arm: what the drive supplies and the contact adds is what damping and torques take.
        let balance = (supplied + to_arm - lost).abs() / supplied.abs().max(lost.abs());
        assert!(balance < 1e-5, "{line}: {supplied:e} + {to_arm:e} - {lost:e}");
        // Contact: what the roller's motor puts in is not less than what the arm takes out.
        assert!(to_contact - to_arm > -1e-6 * supplied.abs(), "{line}: {to_contact:e} {to_arm:e}");
        names.insert(c[0]);
    }
    assert_eq!(names.len(), effects::REGISTRY.len() - 1, "{names:?}");
}
