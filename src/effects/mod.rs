//! The catalogue of effects: one registry slice, one file per effect.
//!
//! An effect declares what it contributes - a term of the friction coefficient, a change of the normal load, a branch of
//! the contact, a torque on the arm, a change of the drive or of the reading - and [`crate::model`] combines the
//! contributions in one place. Every law is stated once, here, and every solver evaluates that statement.

use crate::model::dual::Dual;

/// A parameter of an effect, of the rig, the contact or the instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Key inside its table, e.g. `beta`, `torsional_stiffness`.
    pub key: &'static str,
    /// Symbol of the equations, e.g. `β`, `K₀`.
    pub symbol: &'static str,
    /// SI unit in the notation of scenario files, e.g. `N m/rad`; `1` for pure numbers.
    pub unit: &'static str,
    /// Smallest value that is physical.
    pub minimum: f64,
    /// Largest value that is physical.
    pub maximum: f64,
    /// One phrase of meaning.
    pub meaning: &'static str,
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

/// What every effect of the catalogue states about itself, and its law. Every contribution defaults to none.
///
/// `p` are the parameters in SI in the order of [`Effect::parameters`]. Contributions that enter the equations linearly
/// are given as [`Dual`] numbers, so that their derivatives by all parameters follow; laws evaluated inside a cycle
/// return a [`Law`] with hand-written partial derivatives, which the tests over the registry check against differences.
pub trait Effect: Sync {
    /// Name used in scenario files.
    fn name(&self) -> &'static str;
    /// Its parameters in order.
    fn parameters(&self) -> &'static [ParameterInfo];

    /// Term added to the friction coefficient at slip rate `s >= 0` \[m/s\] and interface state `psi` (0 where there is none).
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
    /// Viscoelastic branch beside the bristles: (stiffness \[N/m\], relaxation time \[s\]).
    fn branch(&self, _p: &[Dual]) -> Option<(Dual, Dual)> {
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
    /// Torque on the arm \[N m\] at angle `th` \[rad\] and angular velocity `w` \[rad/s\].
    fn torque(&self, _p: &[f64], _th: f64, _w: f64) -> Option<Law> {
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
}

/// All effects, in the order of the catalogue.
pub static REGISTRY: &[&dyn Effect] = &[];

/// The effect of that name.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    REGISTRY.iter().copied().find(|effect| effect.name() == name)
}
