//! A roller that does not run true: its load changes with its angle.

use super::{Departure, Outside, RunOut};
use crate::model::Model;
use crate::parameter::ParameterInfo;

/// Radius of the roller \[m\].
const RADIUS: f64 = 0.03;
/// Time from one reading of a table to the next \[s\], in which the roller turns on.
const DWELL: f64 = 2.0;

/// The cause.
pub struct RollerRunOut;

impl Outside for RollerRunOut {
    fn name(&self) -> &'static str {
        "outside-run-out"
    }

    fn title(&self) -> &'static str {
        "the load changes with the angle of the roller, W (1 + e sin(V t/R))"
    }

    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] =
            &[ParameterInfo::searched(("share", "e", "1"), (0.0, 1.0), (0.01, 0.6), "share of the load that changes")];
        LIST
    }

    fn departure(&self, p: &[f64], _model: &Model, speed: f64, ordinal: usize) -> Departure {
        let phase = speed * DWELL * ordinal as f64 / RADIUS;
        Departure { run_out: Some(RunOut { share: p[0], radius: RADIUS, phase }), ..Departure::default() }
    }
}
