//! The catalogue of effects: one registry slice, one file per effect.
//!
//! An effect declares what it contributes - a term of the friction coefficient, a change of the normal load, a branch
//! of the contact, a torque on the arm, a change of the drive or of the reading - and [`crate::model`] combines the
//! contributions in one place. Every law is stated once, here, and every solver evaluates that statement.

mod actuator_lag;
mod asymmetric_stiffness;
mod berg_friction;
mod clearance;
mod combine;
mod contact_renewal;
mod crosstalk;
mod cubic_stiffness;
mod drift;
pub mod formula;
mod friction_joint;
mod frictional_heating;
mod grosch;
mod load_stiffening;
mod lugre;
mod maxwell_branch;
mod normal_coupling;
mod partial_slip;
mod pivot_friction;
mod power_damping;
mod quadratic_damping;
mod quintic_stiffness;
mod rate_and_state;
mod rate_strengthening;
mod residual_modes;
mod roller_compliance;
mod sensor_delay;
mod spring_pot;
mod stribeck;
mod structural_damping;
mod typical;
mod viscous_film;

pub use crate::parameter::{Measure, ParameterInfo, Scales};
pub use combine::{compatible, enters_contact, fits_rig, in_paper_formulation, is_law, remembers, slides};
pub use typical::{middle, typical};

use crate::dual::Dual;

/// Part of the experiment that an effect belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// The law of friction at the interface.
    Interface,
    /// The element between the interface and the arm.
    Contact,
    /// The arm, its drive, the roller's support, the reading.
    RigAndInstrument,
}

impl Group {
    /// Its name in running text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interface => "interface",
            Self::Contact => "contact",
            Self::RigAndInstrument => "rig and instrument",
        }
    }
}

/// A parameter and the value at which its effect vanishes; infinity means the limit.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Zero {
    /// Index of the parameter.
    pub parameter: usize,
    /// The value.
    pub value: f64,
}

/// A scalar law with its partial derivatives.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Law {
    /// The value.
    pub value: f64,
    /// Derivative by the first argument (slip rate, or angle for a torque).
    pub d_first: f64,
    /// Derivative by the second argument (internal state, or angular velocity for a torque).
    pub d_second: f64,
    /// Derivatives by the parameters of the effect, in its order.
    pub d_parameters: [f64; 4],
}

/// Where a hysteresis stands; the default is rest, before any reversal.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Branch {
    /// Its force \[N\].
    pub force: f64,
    /// What the force had left to its limit at the last reversal \[N\]: positive on the way up, negative on the way
    /// down.
    pub reach: f64,
}

/// The compliant support of the roller: m y'' + c y' + k y = -F.
#[derive(Debug, Clone, Copy)]
pub struct Support {
    /// Mass \[kg\].
    pub mass: Dual,
    /// Damping \[N s/m\].
    pub damping: Dual,
    /// Stiffness \[N/m\].
    pub stiffness: Dual,
}

/// The form of an effect for a table of so many series.
pub type OfSeries = fn(usize) -> Option<&'static dyn Effect>;

/// What every effect of the catalogue states about itself, and its law. Every contribution defaults to none.
///
/// `p` are the parameters in SI in the order of [`Effect::parameters`]. Contributions that enter the equations linearly
/// are given as [`Dual`] numbers, so that their derivatives by all parameters follow; laws evaluated inside a cycle
/// return a [`Law`] with hand-written partial derivatives, which the tests over the registry check against differences.
pub trait Effect: Sync {
    /// Name used in scenario files.
    fn name(&self) -> &'static str;
    /// What it is called in running text, e.g. `Velocity weakening (Stribeck)`.
    fn title(&self) -> &'static str;
    /// Part of the experiment that it belongs to.
    fn group(&self) -> Group;
    /// The law in plain Unicode text.
    fn equation(&self) -> &'static str;
    /// What it is physically, in a few sentences.
    fn meaning(&self) -> &'static str;
    /// Where the law comes from.
    fn source(&self) -> &'static str;
    /// What it does to a resonance curve at V = 0, in partial stick and in full slip.
    fn fingerprint(&self) -> &'static str;
    /// What outside the catalogue looks the same, and what tells it apart; empty where nothing is known to.
    fn impersonator(&self) -> &'static str {
        ""
    }

    /// Effects that are this one with a parameter at a value or a bound: they are nested in it.
    fn contains(&self) -> &'static [&'static str] {
        &[]
    }
    /// Parameter values at which the base returns, all at once; empty where the effect replaces a part of the base.
    fn zero(&self) -> &'static [Zero];
    /// Its parameters in order, at most four where it has a law.
    fn parameters(&self) -> &'static [ParameterInfo];
    /// Magnitudes of parameter number `index` that a search should cover on a rig of these scales.
    fn search_range(&self, index: usize, scales: &Scales) -> (f64, f64) {
        self.parameters()[index].search_range(scales)
    }
    /// The formula of a scenario that it is, where it is none of the catalogue.
    fn formula(&self) -> Option<&formula::Formula> {
        None
    }
    /// Value of parameter number `index` where a scenario does not state it.
    fn unstated(&self, _index: usize) -> Option<f64> {
        None
    }
    /// The name and the parameters of a simpler effect near these values: which this one is with one of its parameters
    /// at a value, or what it does to a fundamental, to first order, on a rig of this size.
    fn simpler(&self, _p: &[f64], _scales: &Scales) -> Option<(&'static str, Vec<f64>)> {
        None
    }
    /// Effects of its kind that a scenario may have besides, under names of their own; none of them is searched for.
    fn further(&self) -> &'static [&'static dyn Effect] {
        &[]
    }
    /// Its form for a table of so many series, where it has numbers of each; none where there are too few or too many.
    fn of_series(&self) -> Option<OfSeries> {
        None
    }
    /// Keys of the parameters that a fit may move, as in `[fit] free`.
    fn keys(&self) -> Vec<String> {
        let movable = self.parameters().iter().filter(|info| !info.held);
        movable.map(|info| format!("effect.{}.{}", self.name(), info.key)).collect()
    }

    /// Term added to the friction coefficient at slip rate `s >= 0` \[m/s\] and interface state `psi` (0 where there is
    /// none).
    fn friction(&self, _p: &[f64], _s: f64, _psi: f64) -> Option<Law> {
        None
    }
    /// Rate of the interface state `psi` \[s\] at slip rate `s >= 0`; `Some` gives the contact one such state.
    fn interface_rate(&self, _p: &[f64], _s: f64, _psi: f64) -> Option<Law> {
        None
    }
    /// Flash heating: (power scale \[W\], relaxation time \[s\]); mu is divided by 1 + T, tau T' = F s/P0 - T.
    fn heating(&self, _p: &[Dual]) -> Option<(Dual, Dual)> {
        None
    }
    /// Stiffness \[N/m\] that couples the arm's displacement at the contact, b th, into the normal load.
    fn load_stiffness(&self, _p: &[Dual]) -> Option<Dual> {
        None
    }
    /// Factor on stiffness and damping of the bristles under the load `load` \[N\], which is positive.
    fn contact_factor(&self, _p: &[Dual], _load: Dual) -> Option<Dual> {
        None
    }
    /// Viscoelastic branch beside the bristles: (stiffness \[N/m\], relaxation time \[s\]).
    fn branch(&self, _p: &[Dual]) -> Option<(Dual, Dual)> {
        None
    }
    /// The same of a branch beside others, of which the solver of sliders alone carries several.
    fn further_branch(&self, _p: &[Dual]) -> Option<(Dual, Dual)> {
        None
    }
    /// Complex stiffness \[N/m\], in phase and in quadrature, that the bristles have beside their own at `omega`
    /// \[rad/s\], in proportion to a power of the frequency.
    fn fractional(&self, _p: &[Dual], _omega: f64) -> Option<(Dual, Dual)> {
        None
    }
    /// Force of the bristles that depends on the history of their stretch: where the hysteresis stands when the stretch
    /// has moved by `by` \[m\] without turning back, and the slope of its force there \[N/m\].
    fn hysteresis(&self, _p: &[f64], _from: Branch, _by: f64) -> Option<(Branch, f64)> {
        None
    }
    /// Rate \[1/s\] at which bristles are replaced unstretched, for the roller speed `speed` \[m/s\].
    fn renewal(&self, _p: &[Dual], _speed: Dual) -> Option<Dual> {
        None
    }
    /// Viscous coefficient \[N s/m\] of a rate element (LuGre) that replaces the slip interface.
    fn rate_element(&self, _p: &[Dual]) -> Option<Dual> {
        None
    }
    /// Exponent of a continuum of parallel elements (Iwan) that replaces the single one.
    fn continuum(&self, _p: &[f64]) -> Option<f64> {
        None
    }
    /// Slip elements between the body and the ground: (stiffness \[N/m, N m/rad\], force or torque at full slip \[N, N
    /// m\], exponent).
    fn joint(&self, _p: &[Dual]) -> Option<[Dual; 3]> {
        None
    }
    /// Torque on the arm \[N m\] at angle `th` \[rad\] and angular velocity `w` \[rad/s\].
    fn torque(&self, _p: &[f64], _th: f64, _w: f64) -> Option<Law> {
        None
    }
    /// Whether the torque has a kink in its slope where the angular velocity is zero, over which steps of high order
    /// lose it.
    fn torque_is_kinked(&self) -> bool {
        false
    }
    /// Whether the torque is so rough that many instants of a cycle have to be looked at.
    fn torque_is_rough(&self, _p: &[f64]) -> bool {
        false
    }
    /// Whether the slope of the torque has no bound where the angular velocity is zero.
    fn torque_is_steep(&self, _p: &[f64]) -> bool {
        false
    }
    /// Dry friction between the body and the ground \[N, N m\]: a force against the velocity that holds the body at
    /// rest.
    fn dry_friction(&self, _p: &[Dual]) -> Option<Dual> {
        None
    }
    /// Whether the solvers of a contact can carry it.
    fn beside_contact(&self) -> bool {
        true
    }
    /// Whether opposite motions have opposite torques.
    fn torque_is_odd(&self) -> bool {
        true
    }
    /// Whether its laws are smooth but for that kink.
    fn is_smooth(&self) -> bool {
        true
    }
    /// Force of the bristles \[N\], beside that of their stiffness and damping, at their stretch \[m\] and its rate
    /// \[m/s\].
    fn bristle_force(&self, _p: &[f64], _stretch: f64, _rate: f64) -> Option<Law> {
        None
    }
    /// Stiffness \[N m/rad\] added to the arm.
    fn stiffness(&self, _p: &[Dual]) -> Option<Dual> {
        None
    }
    /// Damping \[N m s/rad\] added to the arm of stiffness `k` \[N m/rad\] driven at `omega` \[rad/s\].
    fn damping(&self, _p: &[Dual], _k: Dual, _omega: f64) -> Option<Dual> {
        None
    }
    /// Complex factor (real, imaginary) on the actuator's motion at `omega` \[rad/s\].
    fn drive(&self, _p: &[Dual], _omega: f64) -> Option<(Dual, Dual)> {
        None
    }
    /// The roller's support, where it gives way.
    fn support(&self, _p: &[Dual]) -> Option<Support> {
        None
    }
    /// Angle \[rad\] added to the measured phase at `omega` \[rad/s\].
    fn reading(&self, _p: &[Dual], _omega: f64) -> Option<Dual> {
        None
    }
    /// Factors on stiffness and reading in series number `series`, the first being 0.
    fn between_series(&self, _p: &[Dual], _series: usize) -> Option<(Dual, Dual)> {
        None
    }
    /// Whether it is read beside the motion of the mode, which is as without it.
    fn is_read_beside(&self) -> bool {
        let one = Dual::constant(1.0);
        let at = Beside { omega: 1.0, stiffness: one, inertia: one, order: 0 };
        self.beside(&vec![one; self.parameters().len()], &at).is_some()
    }
    /// Motion per torque of the drive \[rad/(N m), m/N\], complex, that is read beside that of the mode.
    fn beside(&self, _p: &[Dual], _of: &Beside) -> Option<(Dual, Dual)> {
        None
    }
}

/// The mode that something is read beside.
#[derive(Debug, Clone, Copy)]
pub struct Beside {
    /// Frequency of the drive \[rad/s\].
    pub omega: f64,
    /// Stiffness \[N m/rad, N/m\].
    pub stiffness: Dual,
    /// Inertia \[kg m^2, kg\].
    pub inertia: Dual,
    /// Which derivative of the motion is read.
    pub order: u8,
}

/// All effects, in the order of the catalogue.
pub static REGISTRY: &[&dyn Effect] = &[
    &stribeck::Stribeck,
    &rate_strengthening::RateStrengthening,
    &grosch::Grosch,
    &rate_and_state::RateAndState,
    &frictional_heating::FrictionalHeating,
    &viscous_film::ViscousFilm,
    &normal_coupling::NormalCoupling,
    &load_stiffening::LoadStiffening,
    &maxwell_branch::FIRST,
    &spring_pot::SpringPot,
    &berg_friction::BergFriction,
    &partial_slip::PartialSlip,
    &contact_renewal::ContactRenewal,
    &lugre::LuGre,
    &cubic_stiffness::CubicStiffness,
    &quintic_stiffness::QuinticStiffness,
    &asymmetric_stiffness::AsymmetricStiffness,
    &clearance::Clearance,
    &quadratic_damping::QuadraticDamping,
    &power_damping::PowerDamping,
    &friction_joint::FrictionJoint,
    &pivot_friction::PivotFriction,
    &structural_damping::StructuralDamping,
    &actuator_lag::ActuatorLag,
    &roller_compliance::RollerCompliance,
    &sensor_delay::SensorDelay,
    &residual_modes::ResidualModes,
    &crosstalk::Crosstalk,
    drift::DRIFT,
];

/// The form of an effect for a table of so many series; the error says why there is none.
pub fn for_series(effect: &'static dyn Effect, count: usize) -> Result<&'static dyn Effect, String> {
    effect.of_series().map_or(Some(effect), |form| form(count)).ok_or_else(|| {
        format!("`{}` has numbers of each of 2 to {} series, and the table has {count}", effect.name(), drift::MOST)
    })
}

/// The effect of the catalogue of that name.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    REGISTRY.iter().copied().find(|effect| effect.name() == name)
}

/// The effect of that name that a scenario may have: one of these, or a further one of its kind.
pub fn find_among(effects: &[&'static dyn Effect], name: &str) -> Option<&'static dyn Effect> {
    effects.iter().flat_map(|effect| [effect].into_iter().chain(effect.further())).copied().find(|e| e.name() == name)
}
