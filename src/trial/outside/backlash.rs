//! Play in the pinching springs: around their preload they push nowhere.

use super::{Departure, Outside};
use crate::model::Model;
use crate::parameter::ParameterInfo;

/// The cause.
pub struct Backlash;

impl Outside for Backlash {
    fn name(&self) -> &'static str {
        "outside-backlash"
    }

    fn title(&self) -> &'static str {
        "the force of either pinching spring is zero within a gap around its preload"
    }

    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] =
            &[ParameterInfo::searched(("gap", "g", "m"), (0.0, 1e-3), (1e-8, 2e-6), "width of the gap")];
        LIST
    }

    fn departure(&self, p: &[f64], _model: &Model, _speed: f64, _ordinal: usize) -> Departure {
        Departure { gap: p[0], ..Departure::default() }
    }
}
