//! Derivatives of a stepped cycle by the parameter columns, by the adjoint method: from the end of the cycle backwards.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::harmonic::Complex;
use super::radau::{Stepper, Taken};
use crate::model::system::{HybridSystem, MAX_COLUMNS, MAX_STATES, ParameterColumns};

/// Room for the derivatives of the rates and of the constraint by the columns.
pub struct Adjoints(Box<ParameterColumns>);

impl Adjoints {
    /// Empty.
    pub fn new() -> Self {
        Self(Box::new(ParameterColumns { f: [[0.0; MAX_STATES]; MAX_COLUMNS], g: [0.0; MAX_COLUMNS] }))
    }

    /// Carries the adjoint of the states from the end of a step to its start and adds to `out`, per column, the
    /// derivative of the fundamental by way of the step. False where the Jacobian is singular.
    pub fn step(
        &mut self,
        system: &dyn HybridSystem,
        stepper: &mut Stepper,
        taken: &Taken,
        adjoint: &mut [Complex; MAX_STATES],
        out: &mut [Complex],
    ) -> bool {
        let n = system.states();
        let (mut rates, mut constraint) = ([[(0.0, 0.0); MAX_STATES]; 3], [(0.0, 0.0); 3]);
        if !stepper.adjoint(system, taken, adjoint, &mut rates, &mut constraint) {
            return false;
        }
        for k in 0..3 {
            let columns = &mut self.0;
            system.parameter_columns(&taken.forcing[k], &taken.z[k], taken.s[k], taken.mode, columns);
            for (out, (f, g)) in out.iter_mut().zip(columns.f.iter().zip(&columns.g)) {
                out.0 += constraint[k].0 * g;
                out.1 += constraint[k].1 * g;
                for j in 0..n {
                    out.0 += rates[k][j].0 * f[j];
                    out.1 += rates[k][j].1 * f[j];
                }
            }
        }
        true
    }
}
