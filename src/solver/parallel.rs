//! Periodic states of a contact of many parallel sliders: Newton for the few states they share.

use super::sliders::{Cycle, Method, Slider};
use crate::model::continuum::held;
use crate::model::system::SliderSystem;
use nalgebra::{DMatrix, DVector};

/// Result of the periodic search.
#[derive(Debug, Clone)]
pub struct Found {
    /// Complex fundamental of the relative angle.
    pub fundamental: (f64, f64),
    /// Mean of the relative angle.
    pub mean: f64,
    /// Mean share of stuck stiffness.
    pub stick_fraction: f64,
    /// Extremes of the force.
    pub force: (f64, f64),
    /// Cycles integrated.
    pub cycles: usize,
    /// Relative change over the last cycle.
    pub residual: f64,
    /// Largest modulus of the eigenvalues of the map of the shared states over a cycle.
    pub multiplier: f64,
}

/// What is demanded of a solution.
#[derive(Debug, Clone, Copy)]
pub struct Demand {
    /// Steps per period.
    pub steps: usize,
    /// Relative change of the shared states over a cycle below which they count as periodic.
    pub periodic: f64,
    /// Change of the mean stretch over a cycle, relative to the stroke, below which the sliders count as periodic.
    pub creep: f64,
    /// Most cycles.
    pub cycles: usize,
}

impl Demand {
    /// Errors below 1e-4.
    pub const FINE: Self = Self { steps: 96, periodic: 1e-9, creep: 3e-6, cycles: 120 };
    /// Errors of about 1e-3, for searches over many models.
    pub const COARSE: Self = Self { steps: 48, periodic: 1e-6, creep: 1e-4, cycles: 28 };
}

/// A periodic state, as the start for a neighbouring problem.
#[derive(Debug, Clone)]
pub struct Memory {
    /// Shared states, less those of the system's own start.
    shared: [f64; 5],
    /// The sliders, their stretch and the force of their branch in parts of what they can carry.
    sliders: Vec<Slider>,
    /// Slope of the change over a cycle by the shared states, in units of their scales, and the map itself.
    slopes: [DMatrix<f64>; 2],
}

/// Finds the periodic state, from that of a neighbouring problem where there is one. Errors say why in words.
pub fn solve(system: &dyn SliderSystem, demand: &Demand, memory: &mut Option<Memory>) -> Result<Found, String> {
    if let Some(start) = memory.take()
        && let Ok(found) = search(system, demand, Some(start), memory)
    {
        return Ok(found);
    }
    search(system, demand, None, memory)
}

fn search(
    system: &dyn SliderSystem,
    demand: &Demand,
    from: Option<Memory>,
    memory: &mut Option<Memory>,
) -> Result<Found, String> {
    let method = Method::new(system, demand.steps);
    let (at_start, psi) = system.start();
    let mut shared = at_start;
    let (stroke, speed) = system.scale();
    let angle = stroke / system.lever();
    let omega = speed / stroke;
    let scales = [angle, omega * angle, stroke, speed, shared[4].abs().max(1e-12)];
    let active: Vec<usize> = method.active();
    let forcing = system.forcing(0.0);
    let kc = system.bristles()[0];
    let rest = |shared: &[f64; 5]| shared[2] - system.lever() * (forcing.angle + shared[0]);
    let (limit, _) = system.limit(&forcing, shared[0], 0.0, psi, shared[4]);
    let mut sliders: Vec<Slider> = system
        .elements()
        .iter()
        .map(|e| {
            let most = e.limit * limit / kc;
            let x = if system.at_rest() { held(rest(&shared), most) } else { most };
            Slider { x, q: 0.0, psi }
        })
        .collect();
    let most: Vec<f64> = system.elements().iter().map(|e| (e.limit * limit / kc).max(f64::MIN_POSITIVE)).collect();
    let mut jacobian: Option<DMatrix<f64>> = None;
    let mut slope: Option<DMatrix<f64>> = None;
    if let Some(from) =
        from.filter(|from| from.sliders.len() == sliders.len() && from.slopes[0].nrows() == active.len())
    {
        shared = std::array::from_fn(|i| at_start[i] + from.shared[i]);
        for ((slider, before), most) in sliders.iter_mut().zip(&from.sliders).zip(&most) {
            *slider = Slider { x: before.x * most, q: before.q * kc * most, psi: before.psi };
        }
        let [known, map] = from.slopes;
        (slope, jacobian) = (Some(known), Some(map));
    }
    let mut last: Option<DVector<f64>> = None;
    let mut best = f64::INFINITY;
    let mut cycles = 0;
    while cycles < demand.cycles {
        let cycle = method.cycle(&shared, &sliders)?;
        cycles += 1;
        let residual: Vec<f64> = active.iter().map(|&i| (cycle.shared[i] - shared[i]) / scales[i]).collect();
        // Sliders that give way a little once a cycle creep for long; what counts is their share of the force.
        let creep: f64 = system
            .elements()
            .iter()
            .zip(cycle.sliders.iter().zip(&sliders))
            .zip(&cycle.slipped)
            .filter(|(_, slipped)| **slipped)
            .map(|((e, (new, old)), _)| e.share * (new.x - old.x).abs() / stroke)
            .sum();
        let size = residual.iter().fold(0.0f64, |m, r| m.max(r.abs()));
        if size < demand.periodic && creep < demand.creep {
            let map = match jacobian.take() {
                Some(map) => map,
                None => method.jacobian(&shared, &sliders, &cycle, &scales, &active)?,
            };
            let multiplier = radius(&map);
            let one = DMatrix::identity(active.len(), active.len());
            *memory = Some(Memory {
                shared: std::array::from_fn(|i| shared[i] - at_start[i]),
                sliders: std::iter::zip(&sliders, &most)
                    .map(|(s, most)| Slider { x: s.x / most, q: s.q / (kc * most), psi: s.psi })
                    .collect(),
                slopes: [slope.unwrap_or_else(|| &map - one), map],
            });
            let Cycle { fundamental, mean, stick, force, .. } = cycle;
            return Ok(Found { fundamental, mean, stick_fraction: stick, force, cycles, residual: size, multiplier });
        }
        let residual = DVector::from_vec(residual);
        match (&mut slope, &last) {
            (Some(slope), Some(step)) if size < 2.0 * best => {
                // Broyden's update: what the sliders' memory adds to the slope shows in the steps taken.
                let square = step.norm_squared();
                if square > 0.0 {
                    *slope += &residual * step.transpose() / square;
                }
            }
            // That of the neighbouring problem.
            (Some(_), None) if best.is_infinite() => {}
            _ => {
                let map = method.jacobian(&shared, &sliders, &cycle, &scales, &active)?;
                cycles += active.len();
                slope = Some(&map - DMatrix::identity(active.len(), active.len()));
                jacobian = Some(map);
            }
        }
        best = size;
        let step = slope.as_ref().and_then(|slope| slope.clone().lu().solve(&-&residual));
        last = match step {
            Some(step) if step.iter().all(|d| d.is_finite()) => {
                for (k, &i) in active.iter().enumerate() {
                    shared[i] += step[k] * scales[i];
                }
                Some(step)
            }
            _ => {
                shared = cycle.shared;
                None
            }
        };
        sliders = cycle.sliders;
        if system.at_rest() {
            // What never slips started with the arm, and an interface that never slips has no rate.
            for (slider, slipped) in sliders.iter_mut().zip(&cycle.slipped) {
                if !slipped {
                    (slider.x, slider.psi) = (rest(&shared), psi);
                }
            }
        }
    }
    Err(format!("no periodic state of the parallel sliders within {} cycles", demand.cycles))
}

fn radius(matrix: &DMatrix<f64>) -> f64 {
    matrix.complex_eigenvalues().iter().fold(0.0, |m, e| m.max(e.norm()))
}
