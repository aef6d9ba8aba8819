//! Periodic states of a contact of many parallel sliders: Newton for the few states they share.

use super::slider::Slider;
use super::sliders::{Cycle, Method, SHARED, STRETCH, Shared, with_hysteresis};
use crate::effects::Branch;
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

/// Cycles that a slider by itself over a turning roller is left to itself, at first and after a Newton step that led
/// astray: until its bristles have slipped and turned back as they will.
const SETTLING: usize = 6;
/// Factor by which the change over a cycle grows where a step led astray.
const ASTRAY: f64 = 3.0;

/// Singular value, in parts of the largest, of what a cycle does not change: below it the differences are rounding.
const NEUTRAL: f64 = 1e-6;

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
    /// The same of a single slider, which goes from stick to slip as a whole: the steps do not stop there.
    pub const SINGLE: Self = Self { steps: 240, cycles: 200, ..Self::FINE };
    /// The same for searches over many models.
    pub const COARSE_SINGLE: Self = Self { steps: 96, cycles: 60, ..Self::COARSE };
}

/// A periodic state, as the start for a neighbouring problem.
#[derive(Debug, Clone)]
pub struct Memory {
    /// Shared states, less those of the system's own start.
    shared: Shared,
    /// The sliders, their stretch and the force of their branch in parts of what they can carry.
    sliders: Vec<Slider>,
    /// Slope of the change over a cycle by the shared states, in units of their scales, and the map itself.
    slopes: [DMatrix<f64>; 2],
}

/// Finds the periodic state, from that of a neighbouring problem where there is one; adds the cycles that it
/// integrates. Errors say why in words.
pub fn solve(
    system: &dyn SliderSystem,
    demand: &Demand,
    memory: &mut Option<Memory>,
    cycles: &mut usize,
) -> Result<Found, String> {
    let mut from = |start: Option<Memory>, memory: &mut Option<Memory>| {
        let mut search = Search::begin(system, demand, start);
        let found = search.run(demand, memory);
        *cycles += search.cycles;
        found
    };
    if let Some(start) = memory.take()
        && let Ok(found) = from(Some(start), memory)
    {
        return Ok(found);
    }
    from(None, memory)
}

/// A search on its way.
// Wide: one iterate, what it is measured by and what earlier ones left.
struct Search<'a> {
    system: &'a dyn SliderSystem,
    method: Method<'a>,
    /// The shared states that take part.
    active: Vec<usize>,
    scales: Shared,
    /// Shared states at the system's own start, and age of the interface there.
    at_start: (Shared, f64),
    /// Most stretch that each slider can carry at the start \[m\].
    most: Vec<f64>,
    at: Place,
    /// Slope of the change over a cycle by the shared states, in units of their scales, and the map of a cycle.
    slopes: [Option<DMatrix<f64>>; 2],
    /// The last step, in units of the scales.
    last: Option<DVector<f64>>,
    best: f64,
    cycles: usize,
    settling: Settling,
}

/// States at the start of a cycle.
#[derive(Clone)]
struct Place {
    shared: Shared,
    sliders: Vec<Slider>,
}

/// Of a slider by itself: cycles that it is still left to itself, and where the last good start led.
struct Settling {
    cycles: usize,
    safe: Option<Place>,
}

impl<'a> Search<'a> {
    /// At the system's own start, or at that of a neighbouring problem.
    fn begin(system: &'a dyn SliderSystem, demand: &Demand, from: Option<Memory>) -> Self {
        let method = Method::new(system, demand.steps);
        let (own, psi) = system.start();
        let mut shared = [0.0; SHARED];
        shared[..own.len()].copy_from_slice(&own);
        let (stroke, speed) = system.scale();
        let angle = stroke / system.lever();
        let omega = speed / stroke;
        let kc = system.bristles()[0];
        let force = kc * stroke;
        let scales = [angle, omega * angle, stroke, speed, shared[4].abs().max(1e-12), force, force, stroke];
        let active = method.active();
        let (limit, _) = system.limit(&system.forcing(0.0), shared[0], 0.0, psi, shared[4]);
        let stretch = |limit_of: f64| {
            let most = limit_of * limit / kc;
            if system.at_rest() { held(rest(system, &shared), most) } else { most }
        };
        let mut sliders: Vec<Slider> = system.elements().iter().map(|e| Slider::new(stretch(e.limit), psi)).collect();
        if let Some((branch, _)) = system.hysteresis(Branch::default(), sliders[0].x) {
            with_hysteresis(&mut shared, branch);
        }
        shared[STRETCH] = sliders[0].x;
        let at_start = (shared, psi);
        let most: Vec<f64> = system.elements().iter().map(|e| (e.limit * limit / kc).max(f64::MIN_POSITIVE)).collect();
        let mut slopes = [None, None];
        let alike = |from: &Memory| from.sliders.len() == sliders.len() && from.slopes[0].nrows() == active.len();
        if let Some(from) = from.filter(alike) {
            shared = std::array::from_fn(|i| at_start.0[i] + from.shared[i]);
            for ((slider, before), most) in sliders.iter_mut().zip(&from.sliders).zip(&most) {
                *slider = before.times(*most, kc * most);
            }
            slopes = from.slopes.map(Some);
        }
        let (last, best, cycles) = (None, f64::INFINITY, 0);
        let alone = if active.contains(&STRETCH) && slopes[0].is_none() { SETTLING } else { 0 };
        let (at, settling) = (Place { shared, sliders }, Settling { cycles: alone, safe: None });
        Self { system, method, active, scales, at_start, most, at, slopes, last, best, cycles, settling }
    }

    /// Newton steps until the state is periodic.
    fn run(&mut self, demand: &Demand, memory: &mut Option<Memory>) -> Result<Found, String> {
        while self.cycles < demand.cycles {
            self.cycles += 1;
            let cycle = match self.method.cycle(&self.at.shared, &self.at.sliders) {
                Ok(cycle) => cycle,
                Err(_) if self.retreat() => continue,
                Err(why) => return Err(why),
            };
            if cycle.shared.iter().any(|z| !z.is_finite()) {
                if self.retreat() {
                    continue;
                }
                return Err("the motion of the sliders has no bound".into());
            }
            let residual: Vec<f64> =
                self.active.iter().map(|&i| (cycle.shared[i] - self.at.shared[i]) / self.scales[i]).collect();
            let size = residual.iter().fold(0.0f64, |m, r| m.max(r.abs()));
            if self.settles(&cycle, size) {
                continue;
            }
            if size < demand.periodic && self.creep(&cycle) < demand.creep {
                return self.finish(cycle, size, memory);
            }
            let residual = DVector::from_vec(residual);
            self.learn(&cycle, &residual, size)?;
            self.step(&cycle, &residual);
        }
        Err(format!("no periodic state of the parallel sliders within {} cycles", demand.cycles))
    }

    /// Whether a slider by itself is left to itself for this cycle, which changed it by `size`.
    fn settles(&mut self, cycle: &Cycle, size: f64) -> bool {
        if self.system.elements().len() > 1 {
            return false;
        }
        if size > ASTRAY * self.best {
            return self.retreat();
        }
        let end = self.place(cycle.shared, cycle);
        self.settling.safe = Some(end.clone());
        if self.settling.cycles == 0 {
            return false;
        }
        self.settling.cycles -= 1;
        self.at = end;
        true
    }

    /// Goes back to where the last good start led, to begin from there again; false where there is none.
    fn retreat(&mut self) -> bool {
        let Some(safe) = self.settling.safe.take() else { return false };
        (self.at, self.settling.cycles) = (safe, SETTLING);
        (self.slopes, self.last, self.best) = ([None, None], None, f64::INFINITY);
        true
    }

    /// Sliders that give way a little once a cycle creep for long; what counts is their share of the force.
    fn creep(&self, cycle: &Cycle) -> f64 {
        let stroke = self.scales[2];
        let elements =
            self.system.elements().iter().zip(cycle.sliders.iter().zip(&self.at.sliders)).zip(&cycle.slipped);
        let slipping = elements.filter(|(_, slipped)| **slipped);
        slipping.map(|((e, (new, old)), _)| e.share * (new.x - old.x).abs() / stroke).sum()
    }

    /// The solution, and what a neighbouring problem may begin with.
    fn finish(&mut self, cycle: Cycle, residual: f64, memory: &mut Option<Memory>) -> Result<Found, String> {
        let cycles = self.cycles;
        let map = match self.slopes[1].take() {
            Some(map) => map,
            None => {
                self.cycles += self.active.len();
                self.method.jacobian(&self.at.shared, &self.at.sliders, &cycle, &self.scales, &self.active)?
            }
        };
        let multiplier = radius(&map);
        let kc = self.system.bristles()[0];
        let one = DMatrix::identity(self.active.len(), self.active.len());
        let parts = std::iter::zip(&self.at.sliders, &self.most);
        *memory = Some(Memory {
            shared: std::array::from_fn(|i| self.at.shared[i] - self.at_start.0[i]),
            sliders: parts.map(|(s, most)| s.times(1.0 / most, 1.0 / (kc * most))).collect(),
            slopes: [self.slopes[0].take().unwrap_or_else(|| &map - one), map],
        });
        let Cycle { fundamental, mean, stick, force, .. } = cycle;
        Ok(Found { fundamental, mean, stick_fraction: stick, force, cycles, residual, multiplier })
    }

    /// Learns the slope of the change over a cycle.
    fn learn(&mut self, cycle: &Cycle, residual: &DVector<f64>, size: f64) -> Result<(), String> {
        match (&mut self.slopes[0], &self.last) {
            (Some(slope), Some(step)) if size < 2.0 * self.best => {
                // Broyden's update: what the sliders' memory adds to the slope shows in the steps taken.
                let square = step.norm_squared();
                if square > 0.0 {
                    *slope += residual * step.transpose() / square;
                }
            }
            // That of the neighbouring problem.
            (Some(_), None) if self.best.is_infinite() => {}
            _ => {
                let n = self.active.len();
                let map = self.method.jacobian(&self.at.shared, &self.at.sliders, cycle, &self.scales, &self.active)?;
                self.cycles += n;
                self.slopes = [Some(&map - DMatrix::identity(n, n)), Some(map)];
            }
        }
        self.best = size;
        Ok(())
    }

    /// Takes a Newton step, or goes to the end of the cycle where there is none.
    fn step(&mut self, cycle: &Cycle, residual: &DVector<f64>) {
        let step = self.slopes[0].as_ref().and_then(|slope| self.newton(slope, residual));
        self.last = step.filter(|step| step.iter().all(|d| d.is_finite()));
        let mut shared = cycle.shared;
        if let Some(step) = &self.last {
            shared = self.at.shared;
            for (k, &i) in self.active.iter().enumerate() {
                shared[i] += step[k] * self.scales[i];
            }
        }
        self.at = self.place(shared, cycle);
    }

    /// The step that undoes the change over a cycle. A slider by itself is left where it is along what a cycle does not
    /// change: the memory of a stroke that is small.
    fn newton(&self, slope: &DMatrix<f64>, residual: &DVector<f64>) -> Option<DVector<f64>> {
        if self.system.elements().len() > 1 || slope.iter().any(|d| !d.is_finite()) {
            return slope.clone().lu().solve(&-residual);
        }
        let parts = slope.clone().svd(true, true);
        parts.solve(&-residual, NEUTRAL * parts.singular_values.max()).ok()
    }

    /// These shared states with the sliders at the end of a cycle.
    fn place(&self, shared: Shared, cycle: &Cycle) -> Place {
        let mut sliders = cycle.sliders.clone();
        if self.system.at_rest() {
            // What never slips started with the arm, and an interface that never slips has no rate.
            let (rest, psi) = (rest(self.system, &shared), self.at_start.1);
            for (slider, slipped) in sliders.iter_mut().zip(&cycle.slipped) {
                if !slipped {
                    (slider.x, slider.psi) = (rest, psi);
                }
            }
        }
        Place { shared, sliders }
    }
}

/// Stretch \[m\] of a slider that has never slipped over a roller at rest.
fn rest(system: &dyn SliderSystem, shared: &Shared) -> f64 {
    shared[2] - system.lever() * (system.forcing(0.0).angle + shared[0])
}

fn radius(matrix: &DMatrix<f64>) -> f64 {
    if matrix.iter().any(|d| !d.is_finite()) {
        return f64::INFINITY;
    }
    matrix.complex_eigenvalues().iter().fold(0.0, |m, e| m.max(e.norm()))
}
