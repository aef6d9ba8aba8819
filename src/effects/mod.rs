//! The catalogue of effects: one registry slice, one file per effect.

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

/// What every effect of the catalogue states about itself. The laws join it in [`REGISTRY`]'s files.
pub trait Effect: Sync {
    /// Name used in scenario files.
    fn name(&self) -> &'static str;
    /// Its parameters in order.
    fn parameters(&self) -> &'static [ParameterInfo];
}

/// All effects, in the order of the catalogue.
pub static REGISTRY: &[&dyn Effect] = &[];
