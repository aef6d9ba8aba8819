//! Derivatives of a stepped cycle by the parameter columns.

use super::cycle::Matrix;
use super::radau::{A, State, Stepper};
use crate::model::system::{HybridSystem, MAX_COLUMNS, MAX_STATES, Mode, ParameterColumns};

/// Sums up the derivatives by the parameter columns from step to step, at a fixed start of the cycle.
pub struct ColumnGatherer {
    /// Of the states reached, per column.
    pub end: Vec<State>,
    /// Of the fundamental, per column.
    pub fundamental: Vec<(f64, f64)>,
    columns: Box<[ParameterColumns; 3]>,
    own: [Vec<State>; 3],
}

impl ColumnGatherer {
    /// None yet, for so many columns.
    pub fn new(count: usize) -> Self {
        let empty = || ParameterColumns { f: [[0.0; MAX_STATES]; MAX_COLUMNS], g: [0.0; MAX_COLUMNS] };
        Self {
            end: vec![[0.0; MAX_STATES]; count],
            fundamental: vec![(0.0, 0.0); count],
            columns: Box::new([empty(), empty(), empty()]),
            own: std::array::from_fn(|_| vec![[0.0; MAX_STATES]; count]),
        }
    }

    /// Adds a step.
    #[allow(clippy::too_many_arguments)]
    pub fn add(
        &mut self,
        system: &dyn HybridSystem,
        stepper: &Stepper,
        size: f64,
        mode: Mode,
        n: usize,
        weight: f64,
        tangents: &[Matrix; 3],
    ) {
        stepper.parameter_tangent(system, size, mode, &mut self.columns, &mut self.own);
        for (column, end) in self.end.iter_mut().enumerate() {
            let before = *end;
            for i in 0..3 {
                let through = |row: usize| -> f64 {
                    self.own[i][column][row] + (0..n).map(|k| tangents[i][row][k] * before[k]).sum::<f64>()
                };
                let w = weight * A[2][i];
                let dz = through(0);
                self.fundamental[column].0 += w * stepper.forcing[i].sine * dz;
                self.fundamental[column].1 += w * stepper.forcing[i].cosine * dz;
                if i == 2 {
                    for (row, value) in end.iter_mut().enumerate().take(n) {
                        *value = through(row);
                    }
                }
            }
        }
    }
}
