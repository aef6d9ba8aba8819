//! The equations of one operating point as a solver sees them.
//!
//! States: th and th' relative to the motion without contact; y and y' of the roller's support; the heating T; the
//! stretch x of the bristles; the force q of the viscoelastic branch; the interface state psi (those present, in that
//! order).

mod columns;
mod hybrid;
mod parallel;
mod slip;
mod states;

pub use parallel::Sliders;
pub use states::LimitingState;

use super::lumps::Lumps;
use super::relaxations::Relaxations;
use super::system::{Forcing, HybridSystem, Mode};
use super::{Model, Operation};
use crate::dual::{Dual, Scalar};
use crate::effects::{Effect, Law, remembers};
use crate::parameter::FIRST_EFFECT_PARAMETER;

/// Largest number of law parameters evaluated inside a cycle per effect.
const LAW_PARAMETERS: usize = 4;

/// A loss tangent w cc/kc of the bristles below this is none: it would change alpha by less than 1e-6 and make the
/// equations needlessly stiff.
const NO_DAMPING: f64 = 3e-6;

/// Where a column of parameter derivatives enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    FreeRe,
    FreeIm,
    Damping,
    Stiffness,
    InverseInertia,
    Arm,
    ContactStiffness,
    ContactDamping,
    Friction,
    Load,
    Speed,
    LoadStiffness,
    Renewal,
    BranchStiffness,
    BranchRate,
    RateViscosity,
    SupportInverseMass,
    SupportDamping,
    SupportStiffness,
    HeatingGain,
    CoolingRate,
    Law { effect: usize, parameter: usize },
}

/// One operating point of a model.
// Wide: a field is a symbol of the equations, or says which of them there are.
pub struct Problem {
    /// The coefficients with their gradients.
    pub lumps: Lumps,
    laws: Vec<(&'static dyn Effect, Vec<f64>)>,
    omega: f64,
    free: (f64, f64),
    c: f64,
    k: f64,
    inverse_inertia: f64,
    b: f64,
    kc: f64,
    cc: f64,
    mu: f64,
    load: f64,
    speed: f64,
    load_stiffness: f64,
    renewal: f64,
    k1: f64,
    branch_rate: f64,
    sigma2: f64,
    support: [f64; 3],
    heating_gain: f64,
    cooling_rate: f64,
    /// Where the states stand.
    at: Layout,
    rate_element: bool,
    /// Whether the bristles have a force beside that of their stiffness and damping.
    own_bristles: bool,
    /// The spring-pot beside them.
    spring_pot: Option<Box<Relaxations>>,
    /// Whether a law makes their force depend on the history of their stretch.
    hysteretic: bool,
    stroke: f64,
    psi_scale: f64,
    columns: Vec<Column>,
}

/// Where each state stands among those that are present, and how many there are.
#[derive(Debug, Clone, Copy)]
struct Layout {
    states: usize,
    roller: Option<usize>,
    heat: Option<usize>,
    x: usize,
    q: Option<usize>,
    psi: Option<usize>,
}

impl Layout {
    fn new(lumps: &Lumps, has_psi: bool) -> Self {
        let mut states = 2;
        let mut take = |present: bool, count: usize| {
            let index = states;
            if present {
                states += count;
            }
            present.then_some(index)
        };
        let (roller, heat) = (take(lumps.support.is_some(), 2), take(lumps.heating.is_some(), 1));
        let x = take(true, 1).unwrap_or(2);
        let (q, psi) = (take(lumps.branch.is_some(), 1), take(has_psi, 1));
        Self { states, roller, heat, x, q, psi }
    }
}

/// The coefficients by which derivatives are taken, each where it enters.
fn coefficients<T: Scalar>(lumps: &Lumps, laws: &[(&'static dyn Effect, Vec<f64>)]) -> Vec<(Column, T)> {
    let of = T::of;
    let (free_re, free_im) = lumps.free_response();
    let inverse = of(&lumps.inertia).recip();
    let mut columns = vec![
        (Column::FreeRe, free_re),
        (Column::FreeIm, free_im),
        (Column::Damping, of(&lumps.damping) * inverse),
        (Column::Stiffness, of(&lumps.stiffness) * inverse),
        (Column::InverseInertia, inverse),
        (Column::Arm, of(&lumps.arm)),
        (Column::ContactStiffness, of(&lumps.contact_stiffness)),
        (Column::ContactDamping, of(&lumps.contact_damping)),
        (Column::Friction, of(&lumps.friction)),
        (Column::Load, of(&lumps.load)),
        (Column::Speed, of(&lumps.speed)),
        (Column::LoadStiffness, of(&lumps.load_stiffness)),
        (Column::Renewal, of(&lumps.renewal)),
    ];
    if let Some(s) = &lumps.support {
        let inverse = of(&s.mass).recip();
        columns.extend([
            (Column::SupportInverseMass, inverse),
            (Column::SupportDamping, of(&s.damping) * inverse),
            (Column::SupportStiffness, of(&s.stiffness) * inverse),
        ]);
    }
    if let Some((stiffness, tau)) = lumps.branch.as_deref() {
        columns.extend([(Column::BranchStiffness, of(stiffness)), (Column::BranchRate, of(tau).recip())]);
    }
    if let Some(viscosity) = lumps.rate_element.as_deref() {
        columns.push((Column::RateViscosity, of(viscosity)));
    }
    if let Some((power, tau)) = lumps.heating.as_deref() {
        let gain = (of(power) * of(tau)).recip();
        columns.extend([(Column::HeatingGain, gain), (Column::CoolingRate, of(tau).recip())]);
    }
    let mut first = FIRST_EFFECT_PARAMETER;
    for (index, (effect, p)) in laws.iter().enumerate() {
        let inside = effect.friction(p, 0.0, 0.0).is_some()
            || effect.torque(p, 0.0, 0.0).is_some()
            || effect.bristle_force(p, 0.0, 0.0).is_some();
        for (parameter, &value) in p.iter().enumerate().take(LAW_PARAMETERS) {
            if inside {
                columns.push((Column::Law { effect: index, parameter }, T::parameter(value, first + parameter)));
            }
        }
        first += p.len();
    }
    columns
}

/// Damping of the bristles in the equations, where they have a law of their own or not.
fn damping_of_bristles(lumps: &Lumps, own_law: bool) -> f64 {
    let (kc, cc) = (lumps.contact_stiffness.value, lumps.contact_damping.value);
    match lumps.omega * cc < NO_DAMPING * kc {
        // The law may depend on the rate of their stretch: it follows from the force then, which needs a damping.
        true if own_law => NO_DAMPING * kc / lumps.omega,
        true => 0.0,
        false => cc,
    }
}

/// Intermediate quantities at one instant.
struct Point {
    th: f64,
    w: f64,
    v: f64,
    d: f64,
    normal: f64,
    loaded: bool,
    force: f64,
    mu: f64,
    mu_s: f64,
    heat_factor: f64,
}

impl Problem {
    /// Complex amplitude of the arm's motion without contact \[rad, m\].
    pub fn free(&self) -> (f64, f64) {
        self.free
    }

    /// The equations of `model` at an operating point.
    pub fn new(model: &Model, at: &Operation) -> Self {
        let lumps = Lumps::new(model, at);
        let free: (f64, f64) = lumps.free_response();
        let stuck: (f64, f64) = lumps.stuck_response();
        let laws = model.effects.clone();
        let has_psi = laws.iter().any(|(e, p)| e.interface_rate(p, 0.0, 0.0).is_some());
        let layout = Layout::new(&lumps, has_psi);
        let own_bristles = laws.iter().any(|(e, p)| e.bristle_force(p, 0.0, 0.0).is_some());
        let hysteretic = laws.iter().any(|(e, p)| remembers(*e, p));
        let spring_pot = lumps.spring_pot.as_deref().map(|(re, im)| (re.value, im.value));
        let spring_pot = spring_pot.filter(|(re, im)| re.hypot(*im) > 0.0);
        let inverse = 1.0 / lumps.inertia.value;
        let support = lumps.support.as_ref().map_or([0.0; 3], |s| {
            let inverse = 1.0 / s.mass.value;
            [inverse, s.damping.value * inverse, s.stiffness.value * inverse]
        });
        let branch = lumps.branch.as_deref().map(|(stiffness, tau)| (stiffness.value, 1.0 / tau.value));
        let heating = lumps.heating.as_deref().map(|(power, tau)| (1.0 / (power.value * tau.value), 1.0 / tau.value));
        let columns = coefficients::<f64>(&lumps, &laws).into_iter().map(|(column, _)| column).collect();
        let mut problem = Self {
            omega: lumps.omega,
            free,
            c: lumps.damping.value * inverse,
            k: lumps.stiffness.value * inverse,
            inverse_inertia: inverse,
            b: lumps.arm.value,
            kc: lumps.contact_stiffness.value,
            cc: damping_of_bristles(&lumps, own_bristles),
            mu: lumps.friction.value,
            load: lumps.load.value,
            speed: lumps.speed.value,
            load_stiffness: lumps.load_stiffness.value,
            renewal: lumps.renewal.value,
            k1: branch.map_or(0.0, |(stiffness, _)| stiffness),
            branch_rate: branch.map_or(0.0, |(_, rate)| rate),
            sigma2: lumps.rate_element.as_deref().map_or(0.0, |viscosity| viscosity.value),
            support,
            heating_gain: heating.map_or(0.0, |(gain, _)| gain),
            cooling_rate: heating.map_or(0.0, |(_, rate)| rate),
            at: layout,
            rate_element: lumps.rate_element.is_some(),
            own_bristles,
            spring_pot: spring_pot.map(|modulus| Box::new(Relaxations::new(modulus, lumps.omega))),
            hysteretic,
            stroke: lumps.arm.value * (free.0.hypot(free.1) * stuck.0.hypot(stuck.1)).sqrt(),
            psi_scale: 1.0,
            columns,
            laws,
            lumps,
        };
        problem.psi_scale = problem.steady_interface_state(problem.speed.max(problem.slip_scale()));
        problem
    }

    /// Gradient of each column's lumped coefficient by the parameters of the model.
    pub fn column_gradients(&self) -> Vec<Dual> {
        coefficients(&self.lumps, &self.laws).into_iter().map(|(_, dual)| dual).collect()
    }

    /// Index of the stretch of the bristles among the states.
    pub fn stretch_index(&self) -> usize {
        self.at.x
    }

    /// mu at the slip rate `s` in the direction of slip with its slopes by s, psi and T: (mu, mu_s, mu_psi, mu_T,
    /// 1/(1+T)).
    fn friction(&self, s: f64, psi: f64, heat: f64) -> (f64, f64, f64, f64, f64) {
        let (mut mu, mut mu_s, mut mu_psi) = (self.mu, 0.0, 0.0);
        let inside = s.max(0.0);
        for (effect, p) in &self.laws {
            if let Some(law) = effect.friction(p, inside, psi) {
                // Beyond the end of slip by its tangent, so that the end is found on a smooth curve.
                mu += law.value + law.d_first * s.min(0.0);
                mu_s += law.d_first;
                mu_psi += law.d_second;
            }
        }
        // Hardly a motion cools the interface below its surroundings. A search may look there: by the tangent, since
        // beyond T = -1 friction would drive the contact.
        let factor = if heat > 0.0 { 1.0 / (1.0 + heat) } else { 1.0 - heat };
        let slope = if heat > 0.0 { -factor * factor } else { -1.0 };
        (mu * factor, mu_s * factor, mu_psi * factor, mu * slope, factor)
    }

    /// Rate of the interface's state; beyond the end of slip by its tangent, too.
    fn interface_rate(&self, s: f64, psi: f64) -> Law {
        let law = self.laws.iter().find_map(|(e, p)| e.interface_rate(p, s.max(0.0), psi)).unwrap_or_default();
        Law { value: law.value + law.d_first * s.min(0.0), ..law }
    }

    fn state(&self, index: Option<usize>, z: &[f64]) -> f64 {
        index.map_or(0.0, |i| z[i])
    }

    /// v, speed of the roller's surface over the arm.
    fn relative_speed(&self, forcing: &Forcing, z: &[f64]) -> f64 {
        self.speed + self.at.roller.map_or(0.0, |i| z[i + 1]) - self.b * (forcing.velocity + z[1])
    }

    /// The force of the contact on the arm at relative speed `v`, of which `d` stretches the bristles.
    fn pull(&self, z: &[f64], v: f64, d: f64) -> f64 {
        let own = if self.own_bristles { self.bristle_law(z[self.at.x], d).value } else { 0.0 };
        self.kc * z[self.at.x] + self.cc * d + self.state(self.at.q, z) + self.sigma2 * v + own
    }

    /// Force of the bristles beside that of their stiffness and damping, with its slopes by their stretch and its rate.
    fn bristle_law(&self, stretch: f64, rate: f64) -> Law {
        let mut sum = Law::default();
        if self.own_bristles {
            for law in self.laws.iter().filter_map(|(e, p)| e.bristle_force(p, stretch, rate)) {
                sum.value += law.value;
                sum.d_first += law.d_first;
                sum.d_second += law.d_second;
            }
        }
        sum
    }

    /// Whether the bristles have a force beside that of their stiffness and damping.
    pub fn has_own_bristles(&self) -> bool {
        self.own_bristles
    }

    /// Whether the bristles remember more than a state or two, so that only the solver of sliders can carry them.
    pub fn remembers(&self) -> bool {
        self.spring_pot.is_some() || self.hysteretic || !self.lumps.further_branches.is_empty()
    }

    /// Torque of the laws on the arm, with its slopes by the angle and the angular velocity.
    fn torque(&self, th: f64, w: f64) -> Law {
        let mut torque = Law::default();
        for law in self.laws.iter().filter_map(|(e, p)| e.torque(p, th, w)) {
            torque.value += law.value;
            torque.d_first += law.d_first;
            torque.d_second += law.d_second;
        }
        torque
    }

    fn point(&self, forcing: &Forcing, z: &[f64], s: f64) -> Point {
        let (th, w) = (forcing.angle + z[0], forcing.velocity + z[1]);
        let v = self.relative_speed(forcing, z);
        let d = v - s;
        let normal = self.load + self.load_stiffness * self.b * th;
        let loaded = normal > 0.0;
        let normal = normal.max(0.0);
        let force = self.pull(z, v, d);
        let argument = if self.rate_element { v.abs() } else { s.abs() };
        let (mu, mu_s, _, _, heat_factor) =
            self.friction(argument, self.state(self.at.psi, z), self.state(self.at.heat, z));
        Point { th, w, v, d, normal, loaded, force, mu, mu_s, heat_factor }
    }

    fn force_scale(&self) -> f64 {
        (self.kc + self.omega * self.cc) * self.stroke
    }

    fn sign(mode: Mode) -> f64 {
        match mode {
            Mode::SlipBackward | Mode::RateBackward => -1.0,
            _ => 1.0,
        }
    }
}
