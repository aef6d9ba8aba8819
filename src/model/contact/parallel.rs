//! The equations of one operating point as the solver of parallel sliders sees them.

use super::Problem;
use crate::effects::{Branch, Law};
use crate::model::continuum::{self, Element};
use crate::model::system::{Forcing, HybridSystem, Linear, SliderSystem};

/// A problem with its contact seen as parallel elements.
pub struct Sliders<'a> {
    problem: &'a Problem,
    elements: Vec<Element>,
    branches: Vec<(f64, f64)>,
}

impl Problem {
    /// The contact as one slider or as the elements of a continuum.
    pub fn sliders(&self) -> Sliders<'_> {
        self.continuum().unwrap_or_else(|| self.as_sliders(continuum::elements(1.0, 1.0)))
    }

    fn as_sliders(&self, elements: Vec<Element>) -> Sliders<'_> {
        let maxwell = self.at.q.map(|_| (self.k1, self.branch_rate));
        let spring_pot = self.spring_pot.iter().flat_map(|pot| pot.branches);
        let further = self.lumps.further_branches.iter().map(|(stiffness, tau)| (stiffness.value, 1.0 / tau.value));
        Sliders { problem: self, elements, branches: maxwell.into_iter().chain(further).chain(spring_pot).collect() }
    }

    /// The continuum of elements that replaces the single one, where an effect asks for it.
    pub fn continuum(&self) -> Option<Sliders<'_>> {
        let n = self.laws.iter().find_map(|(e, p)| e.continuum(p)).filter(|n| *n > 1.0)?;
        let (free, stuck): (_, (f64, f64)) = (self.free, self.lumps.stuck_response());
        let amplitude = |(re, im): (f64, f64)| re.hypot(im);
        // No stroke is much larger than those of the limiting cases; xm is where the last slider gives way.
        let stroke = 1.5 * self.b * amplitude(free).max(amplitude(stuck));
        let last = n * self.mu * self.load / self.kc;
        Some(self.as_sliders(continuum::elements(n, stroke / last)))
    }
}

impl SliderSystem for Sliders<'_> {
    fn period(&self) -> f64 {
        self.problem.period()
    }
    fn elements(&self) -> &[Element] {
        &self.elements
    }
    fn forcing(&self, t: f64) -> Forcing {
        self.problem.forcing(t)
    }
    fn arm(&self) -> Linear {
        Linear { stiffness: self.problem.k, damping: self.problem.c }
    }
    fn arm_load(&self, forcing: &Forcing, angle: f64, velocity: f64) -> (f64, f64) {
        let p = self.problem;
        let (th, w) = (forcing.angle + angle, forcing.velocity + velocity);
        let torque: f64 = p.laws.iter().filter_map(|(e, q)| e.torque(q, th, w)).map(|law: Law| law.value).sum();
        (p.inverse_inertia * p.b, p.inverse_inertia * torque)
    }
    fn support(&self) -> Option<(Linear, f64)> {
        let [inverse, damping, stiffness] = self.problem.support;
        self.problem.at.roller.map(|_| (Linear { stiffness, damping }, -inverse))
    }
    fn relative_speed(&self, forcing: &Forcing, velocity: f64, support: f64) -> f64 {
        self.problem.speed + support - self.problem.b * (forcing.velocity + velocity)
    }
    fn bristles(&self) -> [f64; 3] {
        let p = self.problem;
        let (spring, dashpot) = p.spring_pot.as_ref().map_or((0.0, 0.0), |pot| (pot.spring, pot.dashpot));
        [p.kc + spring, p.cc + dashpot, p.renewal]
    }
    fn branches(&self) -> &[(f64, f64)] {
        &self.branches
    }
    fn hysteresis(&self, from: Branch, by: f64) -> Option<(Branch, f64)> {
        self.problem.laws.iter().filter(|_| self.problem.hysteretic).find_map(|(e, p)| e.hysteresis(p, from, by))
    }
    fn heating(&self) -> (f64, f64) {
        (self.problem.heating_gain, self.problem.cooling_rate)
    }
    fn limit(&self, forcing: &Forcing, angle: f64, s: f64, psi: f64, heat: f64) -> (f64, f64) {
        let p = self.problem;
        let normal = (p.load + p.load_stiffness * p.b * (forcing.angle + angle)).max(0.0);
        let (mu, mu_s, ..) = p.friction(s, psi, heat);
        (mu * normal, mu_s * normal)
    }
    fn rate_independent(&self) -> bool {
        self.problem.at.psi.is_none() && self.problem.laws.iter().all(|(e, p)| e.friction(p, 0.0, 0.0).is_none())
    }
    fn interface(&self, s: f64) -> Option<(f64, f64)> {
        let law = self.problem.laws.iter().find_map(|(e, p)| e.interface_rate(p, s, 0.0))?;
        Some((law.value, law.d_second))
    }
    fn scale(&self) -> (f64, f64) {
        (self.problem.stroke, self.problem.slip_scale())
    }
    fn start(&self) -> ([f64; 5], f64) {
        let p = self.problem;
        let z = p.initial_state();
        let support = p.at.roller.map_or((0.0, 0.0), |i| (z[i], z[i + 1]));
        let psi = p.at.psi.map_or(0.0, |i| if p.speed > 0.0 { z[i] } else { p.psi_scale });
        ([z[0], z[1], support.0, support.1, p.at.heat.map_or(0.0, |i| z[i])], psi)
    }
    fn at_rest(&self) -> bool {
        self.problem.speed == 0.0
    }
    fn lever(&self) -> f64 {
        self.problem.b
    }
    fn rate_viscosity(&self) -> Option<f64> {
        self.problem.rate_element.then_some(self.problem.sigma2)
    }
}
