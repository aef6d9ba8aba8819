//! Plausible outcomes without a solver: closed-form limiting cases, and an interpolation between them for the contact.

use std::f64::consts::TAU;
use stickslip::scenario::{Contact, Formulation, Instrument, Rig, Scenario, Signals, Sweep, TorsionalArm};
use stickslip::solver::{Method, Orbit, Status, SteadyState};
use stickslip::sweep::{Condition, Curve, LimitCurve, LimitingCase, Outcome};

pub const RIG: TorsionalArm = TorsionalArm {
    inertia: 5.0e-3,
    torsional_stiffness: 990.0,
    torsional_damping: 0.43,
    spring_stiffness: 1.6e4,
    spring_damping: 12.0,
    spring_arm: 0.030,
    contact_arm: 0.060,
};
pub const DRIVE: f64 = 2.5e-6;

/// Amplitude and phase of a limiting case: model section 2.
pub fn closed(case: LimitingCase, drive: f64, f: f64) -> (f64, f64) {
    let w = TAU * f;
    let (a, b) = (RIG.spring_arm, RIG.contact_arm);
    let mut k = RIG.torsional_stiffness + 2.0 * a * a * RIG.spring_stiffness;
    let mut c = RIG.torsional_damping + 2.0 * a * a * RIG.spring_damping;
    if case == LimitingCase::StaticContact {
        k += b * b * 8.9e4;
        c += b * b * 26.0;
    }
    let gamma = a * drive * RIG.spring_stiffness.hypot(RIG.spring_damping * w);
    let (real, imaginary) = (k - RIG.inertia * w * w, c * w);
    (gamma / real.hypot(imaginary), (RIG.spring_damping * w / RIG.spring_stiffness).atan() - imaginary.atan2(real))
}

fn limit(case: LimitingCase, drive: f64) -> LimitCurve {
    let frequency: Vec<f64> = (0..=1000).map(|i| 50.0 + 0.05 * f64::from(i)).collect();
    let values: Vec<(f64, f64)> = frequency.iter().map(|f| closed(case, drive, *f)).collect();
    let speed: Vec<f64> = frequency.iter().zip(&values).map(|(f, v)| RIG.contact_arm * TAU * f * v.0).collect();
    let top = |of: &[f64]| (0..of.len()).max_by(|i, j| of[*i].total_cmp(&of[*j])).unwrap();
    let amplitude: Vec<f64> = values.iter().map(|v| v.0).collect();
    let (i, j) = (top(&amplitude), top(&speed));
    LimitCurve {
        case,
        drive,
        peak_frequency: frequency[i],
        peak_amplitude: amplitude[i],
        speed_peak_frequency: frequency[j],
        speed_peak: speed[j],
        phase: values.iter().map(|v| v.1).collect(),
        speed_amplitude: speed,
        amplitude,
        frequency,
    }
}

fn state(condition: &Condition, f: f64) -> SteadyState {
    let b = RIG.contact_arm;
    let (slip, fixed) = (
        closed(LimitingCase::FreeOrFullSlip, condition.drive, f),
        closed(LimitingCase::StaticContact, condition.drive, f),
    );
    let reach = b * TAU * f * slip.0;
    let stick = if condition.speed >= reach { 0.0 } else { (1.0 - condition.speed / reach).powf(0.6) };
    // Mixed as complex compliances, so that phases stay continuous.
    let mix = |part: fn(f64) -> f64| slip.0 * part(slip.1) * (1.0 - stick) + fixed.0 * part(fixed.1) * stick;
    let (re, im) = (mix(f64::cos), mix(f64::sin));
    let error = match condition.formulation {
        Formulation::Series => 1e-13 * (37.0 * f * condition.friction).sin(),
        Formulation::Paper => 2e-3 * stick + 40.0 * stick / condition.euler_steps as f64,
    };
    let amplitude = re.hypot(im) * (1.0 + error);
    SteadyState {
        amplitude,
        phase: im.atan2(re),
        mean: b * condition.friction * condition.load / 1000.0,
        speed_amplitude: b * TAU * f * amplitude,
        stick_fraction: stick,
        force_minimum: 9.9,
        force_maximum: 10.0,
        cycles: 4,
        periodicity_error: 1e-12,
        status: Status::Steady,
        method: Method::Shooting,
    }
}

/// A prescribed arm motion with the bristles integrated over it.
fn orbit(condition: &Condition, f: f64, s: &SteadyState) -> Orbit {
    let (n, b, kc) = (400, RIG.contact_arm, 8.9e4);
    let (w, limit) = (TAU * f, condition.friction * condition.load);
    let dt = 1.0 / f / f64::from(n);
    let mut orbit = Orbit::default();
    let mut force = limit;
    for step in 0..4 * n {
        let t = f64::from(step) * dt;
        let velocity = w * s.amplitude * (w * t + s.phase).cos();
        let relative = condition.speed - b * velocity;
        let trial = force + kc * relative * dt;
        let slip_rate = if trial >= limit { relative } else { 0.0 };
        force = trial.min(limit);
        if step >= 3 * n {
            orbit.time.push(t - 3.0 / f);
            orbit.angle.push(s.mean + s.amplitude * (w * t + s.phase).sin());
            orbit.velocity.push(velocity);
            orbit.stretch.push(force / kc);
            orbit.slip_rate.push(slip_rate);
            orbit.force.push(force);
        }
    }
    orbit
}

/// Axes of an outcome.
#[derive(Clone)]
pub struct Axes {
    pub frequency: Vec<f64>,
    pub speed: Vec<f64>,
    pub load: Vec<f64>,
    pub drive: Vec<f64>,
    pub friction: Vec<f64>,
    pub formulation: Vec<Formulation>,
    pub euler_steps: Vec<usize>,
    pub orbits: bool,
}

impl Default for Axes {
    fn default() -> Self {
        Self {
            frequency: (0..=100).map(|i| 50.0 + 0.5 * f64::from(i)).collect(),
            speed: vec![5e-5],
            load: vec![20.0],
            drive: vec![DRIVE],
            friction: vec![0.5],
            formulation: vec![Formulation::Series],
            euler_steps: vec![20_000],
            orbits: false,
        }
    }
}

pub fn outcome(axes: &Axes) -> Outcome {
    let mut curves = Vec::new();
    for &formulation in &axes.formulation {
        let steps = if formulation == Formulation::Series { &axes.euler_steps[..1] } else { &axes.euler_steps[..] };
        for &euler_steps in steps {
            for &drive in &axes.drive {
                for &load in &axes.load {
                    for &friction in &axes.friction {
                        for &speed in &axes.speed {
                            let condition =
                                Condition { formulation, euler_steps, drive, load, friction, speed, series: 0 };
                            let states: Vec<SteadyState> =
                                axes.frequency.iter().map(|f| state(&condition, *f)).collect();
                            let points = axes.frequency.iter().zip(&states).filter(|_| axes.orbits);
                            let orbits = points.map(|(f, s)| orbit(&condition, *f, s)).collect();
                            curves.push(Curve {
                                condition,
                                frequency: axes.frequency.clone(),
                                states,
                                down: Vec::new(),
                                orbits,
                            });
                        }
                    }
                }
            }
        }
    }
    let cases = [LimitingCase::FreeOrFullSlip, LimitingCase::StaticContact];
    let limits = axes.drive.iter().flat_map(|drive| cases.map(|case| limit(case, *drive))).collect();
    let sweep = Sweep {
        frequency: axes.frequency.clone(),
        speed: axes.speed.clone(),
        load: axes.load.clone(),
        drive: axes.drive.clone(),
        friction: axes.friction.clone(),
        formulation: axes.formulation.clone(),
        euler_steps: axes.euler_steps.clone(),
    };
    Outcome { scenario: scenario(sweep), curves, limits, seconds: 0.0 }
}

fn scenario(sweep: Sweep) -> Scenario {
    Scenario {
        id: "test".into(),
        path: "test.toml".into(),
        hash: String::new(),
        title: "Test".into(),
        description: String::new(),
        provenance: String::new(),
        origins: std::collections::BTreeMap::new(),
        rig: Rig::TorsionalArm(RIG),
        contact: Some(Contact { stiffness: 8.9e4, damping: 26.0, friction: 0.5, formulation: Formulation::Series }),
        instrument: Instrument::default(),
        signals: Signals::ARM,
        sweep: Some(sweep),
        effects: Vec::new(),
        measurement: None,
        question: None,
        free: Vec::new(),
        figures: None,
        gate: Default::default(),
    }
}

fn logarithmic(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| low * (high / low).powf(i as f64 / (count - 1) as f64)).collect()
}

/// The outcome that suits a figure.
pub fn suited(figure: &str) -> Outcome {
    let base = Axes::default();
    let speeds = |values: &[f64]| values.iter().map(|v| v * 1e-3).collect::<Vec<_>>();
    let axes = match figure {
        "friction-independence" => Axes { friction: vec![0.2, 0.4, 0.6, 0.8, 1.0, 1.2], ..base },
        "resonance" => Axes { speed: speeds(&[0.0, 0.001, 0.01, 0.02, 0.05, 0.1, 0.15, 20.0]), ..base },
        "ridge" => Axes { speed: logarithmic(1e-6, 1e-3, 31), ..base },
        "regime-map" => Axes { speed: logarithmic(1e-6, 3e-4, 60), ..base },
        "collapse" => {
            let drive = vec![1.25e-6, 2.5e-6, 5e-6];
            let mut outcome = outcome(&Axes { drive, speed: speeds(&[0.01, 0.02, 0.04, 0.08, 0.16]), ..base });
            outcome.curves.retain(|c| (3.9..33.0).contains(&(c.condition.speed / c.condition.drive)));
            return outcome;
        }
        "loops" | "time-histories" => {
            Axes { frequency: vec![60.0, 71.0, 82.0], speed: speeds(&[0.08]), orbits: true, ..base }
        }
        "formulations" => Axes {
            speed: speeds(&[0.005, 0.02, 0.05, 0.1]),
            formulation: vec![Formulation::Series, Formulation::Paper],
            euler_steps: vec![1000, 2000, 5000, 10_000, 20_000],
            ..base
        },
        _ => base,
    };
    outcome(&axes)
}
