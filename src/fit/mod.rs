//! Least squares on measured steady states: parameters within bounds, residuals on the solver's derivatives, few
//! outliers tolerated. What is fitted and why is decided by [`crate::compare`] and [`crate::discover`].

mod dense;
mod least_squares;
mod parameter;
pub mod placed;
mod problem;
mod profile;
pub mod resonance;

pub use least_squares::{
    CONVERGED, Fit, MARGIN, Settings, TAIL, deviance, minimise, price, robust_chi2, robust_square, typical_of,
};
pub use parameter::{Parameter, parameter};
pub use problem::{
    Evaluation, Prediction, Problem, TROUBLED, cost, is_lost, model_with, operation, read_all, values_in,
};
pub use profile::{Correlation, Identified, Interval, Profiles, approximate_intervals, correlations, profiled};
