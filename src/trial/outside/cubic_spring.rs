//! Bristles that stiffen with their stretch, F = kc x + k3 x^3.

use super::{Departure, Outside};
use crate::model::Model;
use crate::parameter::ParameterInfo;

/// The cause.
pub struct CubicSpring;

impl Outside for CubicSpring {
    fn name(&self) -> &'static str {
        "outside-cubic-spring"
    }

    fn title(&self) -> &'static str {
        "the contact's spring is cubic, kc x + k3 x³"
    }

    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("k_3", "k₃", "N/m^3"),
            (0.0, 1e30),
            (1e11, 1e15),
            "cubic stiffness of the bristles",
        )];
        LIST
    }

    fn departure(&self, p: &[f64], _model: &Model, _speed: f64, _ordinal: usize) -> Departure {
        Departure { cubic: p[0], ..Departure::default() }
    }
}
