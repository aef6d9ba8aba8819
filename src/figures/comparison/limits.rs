//! Axes of what the contact did: wide enough for what is known well, not for what is hardly known.

use super::contact::Row;
use crate::compare::ContactPoint;
use crate::figures::axes::range;

/// A reading whose standard deviation is this many times the typical one is faded.
pub const VAGUE: f64 = 4.0;
/// Share of the readings that may lie beyond either end.
const TAIL: f64 = 0.01;
/// Margin around them.
const MARGIN: f64 = 0.08;

/// On which side of the axes a reading lies.
pub enum Outside {
    /// Above them.
    Above,
    /// Below them.
    Below,
}

/// The range of an axis in displayed units, and the typical standard deviation.
pub struct Limits {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    typical: f64,
}

impl Limits {
    /// The limits for some readings and the model's values, zero and what else is drawn (`besides`, SI).
    pub fn of<'a>(
        measured: impl Iterator<Item = &'a &'a ContactPoint> + Clone,
        model: impl Iterator<Item = &'a &'a ContactPoint>,
        row: &Row,
        besides: Option<f64>,
    ) -> Self {
        let mut sds: Vec<f64> = measured.clone().map(|p| (row.sd)(p)).filter(|sd| sd.is_finite()).collect();
        sds.sort_by(f64::total_cmp);
        let typical = sds.get(sds.len() / 2).copied().unwrap_or(0.0);
        let clear = measured.filter(|p| (row.sd)(p) <= VAGUE * typical);
        let of_model = inner(model.map(|p| (row.value)(p)));
        let ends = inner(clear.map(|p| (row.value)(p))).into_iter().chain(of_model).chain([0.0]).chain(besides);
        let (low, high) = range(ends.map(|value| row.unit.of(value)));
        let bar = row.unit.of(typical);
        let margin = MARGIN * (high - low) + bar;
        Self { low: low - margin, high: high + margin, typical }
    }

    /// Whether a reading says little.
    pub fn vague(&self, p: &ContactPoint, row: &Row) -> bool {
        (row.sd)(p).partial_cmp(&(VAGUE * self.typical)).is_none_or(|order| order.is_gt())
    }

    /// On which side of the axis a reading lies, if not on it.
    pub fn outside(&self, p: &ContactPoint, row: &Row) -> Option<Outside> {
        let value = row.unit.of((row.value)(p));
        if value > self.high {
            Some(Outside::Above)
        } else if value < self.low {
            Some(Outside::Below)
        } else {
            None
        }
    }
}

/// The ends of the values without their tails.
fn inner(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let cut = (TAIL * sorted.len() as f64) as usize;
    if sorted.is_empty() { Vec::new() } else { vec![sorted[cut], sorted[sorted.len() - 1 - cut]] }
}
