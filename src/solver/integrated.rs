//! The observables of a point by plain time integration: the cross-check of the periodic solver, and the maker of test
//! data.

use super::time::{Plan, integrate};
use crate::model::alone::Alone;
use crate::model::contact::Problem;
use crate::model::continuum::Element;
use crate::model::system::SingleMode;
use crate::model::{Model, Operation};
use std::f64::consts::TAU;

/// What a time integration reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrated {
    /// Amplitude as the instrument shows it, alpha of the paper's rig \[rad\].
    pub amplitude: f64,
    /// phi as the instrument shows it \[rad\].
    pub phase: f64,
    /// Mean of the coordinate \[rad, m\].
    pub mean: f64,
    /// Whether the motion became periodic; otherwise the numbers are averages over the window of the plan.
    pub periodic: bool,
}

/// Integrates the model at an operating point from rest, and reads the fundamental. Shares only the statement of the
/// laws with the periodic solver.
pub fn integrated(model: &Model, at: &Operation, plan: &Plan) -> Integrated {
    if at.load == 0.0 {
        return alone(&Alone::new(model, at), plan);
    }
    let problem = Problem::new(model, at);
    if problem.has_own_bristles() {
        // The sliders know no such force.
        return Integrated { amplitude: f64::NAN, phase: f64::NAN, mean: f64::NAN, periodic: false };
    }
    let lumps = &problem.lumps;
    let (free_re, free_im): (f64, f64) = lumps.free_response();
    let found = integrate(&problem.sliders(), plan);
    let (re, im) = (free_re + found.fundamental.0, free_im + found.fundamental.1);
    let (amplitude, phase) = lumps.reading((re, im));
    Integrated { amplitude, phase, mean: found.mean, periodic: found.periodic }
}

/// Cycles, in quality factors, after which a motion that began at rest differs by less than 1e-8 from the steady one.
const SETTLING: f64 = 6.5;
/// Steps per cycle that suffice for a mode without a contact, whose force is smooth but for joints.
const COARSE: usize = 400;
/// Most steps of one integration, and those of a mode with a joint, whose steps take longer.
const MOST_STEPS: [f64; 2] = [1e7, 8e5];

/// The plan for a model at an operating point: one without a contact rings long, and needs fewer steps a cycle for
/// that.
pub fn plan_for(model: &Model, at: &Operation, plan: &Plan) -> Plan {
    if model.has_contact {
        return *plan;
    }
    let mode = Alone::new(model, at);
    let [mass, damping, stiffness] = mode.linear();
    let needed = SETTLING * (stiffness * mass).sqrt() / damping;
    let most = MOST_STEPS[usize::from(mode.joint().is_some())] / COARSE as f64;
    Plan { steps: COARSE, cycles: needed.clamp(plan.cycles as f64, most) as usize, ..*plan }
}

/// A slip element: its share of the joint, and where it would be without force.
struct Slider {
    element: Element,
    rest: f64,
}

/// Elements of a joint of exponent `n`, as many for every factor of the stretch at which they slip.
fn sliders(n: f64) -> Vec<Slider> {
    const ELEMENTS: usize = 120;
    const SMALLEST: f64 = 1e-4;
    if n <= 1.0 {
        return vec![Slider { element: Element { share: 1.0, limit: 1.0 }, rest: 0.0 }];
    }
    let edge = |i: usize| if i == 0 { 0.0 } else { SMALLEST.powf(1.0 - i as f64 / ELEMENTS as f64) };
    let stuck = |xi: f64| (1.0 - xi).powf(n - 1.0);
    let element = |i: usize| {
        let (from, to) = (edge(i), edge(i + 1));
        let share = stuck(from) - stuck(to);
        // The mean of xi over the share: both stiffness and largest force are exact.
        let above = (n - 1.0) / n * ((1.0 - from).powf(n) - (1.0 - to).powf(n));
        // Of a share that is nothing but rounding, or none, any limit does that is not below zero.
        let element = Element { share, limit: (n * (share - above) / share).max(0.0) };
        Slider { element, rest: 0.0 }
    };
    (0..ELEMENTS).map(element).collect()
}

/// A mode without a contact, by the classical Runge-Kutta method, the joint as sliders that each keep where they came
/// to rest.
fn alone(mode: &Alone, plan: &Plan) -> Integrated {
    let [mass, damping, stiffness] = mode.linear();
    let ((re, im), omega) = (mode.drive(), mode.omega());
    let joint = mode.joint();
    let mut sliders: Vec<Slider> = joint.map_or_else(Vec::new, |[_, _, n]| sliders(n));
    let pull = |sliders: &[Slider], x: f64| -> f64 {
        let Some([k, limit, _]) = joint else { return 0.0 };
        let of = |s: &Slider| {
            let most = s.element.limit * limit;
            s.element.share * (k * (x - s.rest)).clamp(-most, most)
        };
        sliders.iter().map(of).sum()
    };
    let h = TAU / omega / plan.steps as f64;
    // Cycles over which the motion forgets where it began: as many times what a cycle changes is still to come.
    let ringing = (damping * TAU / (2.0 * mass * omega)).recip().clamp(1.0, plan.cycles as f64);
    let (mut x, mut v) = (0.0, 0.0);
    let mut last: Option<(f64, f64)> = None;
    let mut read = Integrated { amplitude: f64::NAN, phase: f64::NAN, mean: f64::NAN, periodic: false };
    for _ in 0..plan.cycles {
        let (mut fundamental, mut mean) = ((0.0, 0.0), 0.0);
        for step in 0..plan.steps {
            let phase = |part: f64| TAU * (step as f64 + part) / plan.steps as f64;
            let rate = |part: f64, x: f64, v: f64| {
                let (sine, cosine) = phase(part).sin_cos();
                let drive = re * sine + im * cosine;
                (v, (drive - stiffness * x - damping * v + mode.force(x, v)[0] - pull(&sliders, x)) / mass)
            };
            let a = rate(0.0, x, v);
            let b = rate(0.5, x + 0.5 * h * a.0, v + 0.5 * h * a.1);
            let c = rate(0.5, x + 0.5 * h * b.0, v + 0.5 * h * b.1);
            let d = rate(1.0, x + h * c.0, v + h * c.1);
            // x = Im(A e^{iwt}): the real part goes with the sine.
            let (sine, cosine) = phase(0.0).sin_cos();
            fundamental = (fundamental.0 + x * sine, fundamental.1 + x * cosine);
            mean += x;
            x += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
            v += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
            if let Some([k, limit, _]) = joint {
                for slider in &mut sliders {
                    let most = slider.element.limit * limit / k;
                    slider.rest = slider.rest.clamp(x - most, x + most);
                }
            }
        }
        let scale = 2.0 / plan.steps as f64;
        let (re, im) = (scale * fundamental.0, scale * fundamental.1);
        let settled = last.is_some_and(|(p, q)| ringing * (re - p).hypot(im - q) < plan.settled * re.hypot(im));
        last = Some((re, im));
        let (amplitude, phase) = mode.lumps.reading((re, im));
        read = Integrated { amplitude, phase, mean: mean / plan.steps as f64, periodic: settled };
        if settled || !re.is_finite() {
            break;
        }
    }
    read
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_have_the_stiffness_and_the_largest_force_of_the_joint() {
        for n in [1.0, 1.0 + 1e-15, 1.00000000926202, 1.000001, 1.01, 1.5, 3.0, 20.0] {
            let all = sliders(n);
            let stiffness: f64 = all.iter().map(|s| s.element.share).sum();
            assert!(all.iter().all(|s| s.element.limit >= 0.0), "{n}");
            let force: f64 = all.iter().map(|s| s.element.share * s.element.limit).sum();
            assert!((stiffness - 1.0).abs() < 1e-9 && (force - 1.0).abs() < 1e-6, "{n}: {stiffness} {force}");
        }
    }
}
