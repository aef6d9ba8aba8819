//! The equations of an affine mode without their algebraic unknown.

use super::radau::State;
use crate::model::system::{Evaluation, Forcing, HybridSystem, MAX_STATES, Mode};

/// The equations of an affine mode with the algebraic unknown eliminated: values for z = 0, and slopes.
pub struct Eliminated {
    /// f, g and their Jacobians at rest without forcing.
    pub base: Evaluation,
    /// Parts of f and g of sin wt and cos wt.
    pub forced: [(State, f64); 2],
}

impl Eliminated {
    /// The coefficients of a mode; `None` where the constraint does not determine s.
    pub fn new(system: &dyn HybridSystem, mode: Mode) -> Option<Self> {
        let zero = [0.0; MAX_STATES];
        let (mut base, mut out) = (Evaluation::default(), Evaluation::default());
        system.evaluate(&Forcing::default(), &zero, 0.0, mode, &mut base);
        if base.gs == 0.0 {
            return None;
        }
        let forced = [0.25 * system.period(), 0.0].map(|t| {
            system.evaluate(&system.forcing(t), &zero, 0.0, mode, &mut out);
            (std::array::from_fn(|i| out.f[i] - base.f[i]), out.g - base.g)
        });
        Some(Self { base, forced })
    }

    /// s at the states `z` under (constant, sine, cosine) parts of the forcing.
    pub fn slip(&self, z: &State, parts: [f64; 3]) -> f64 {
        let e = &self.base;
        let forced = self.forced[0].1 * parts[1] + self.forced[1].1 * parts[2];
        -(e.gz.iter().zip(z).map(|(g, z)| g * z).sum::<f64>() + parts[0] * e.g + forced) / e.gs
    }
}
