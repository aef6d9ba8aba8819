//! Axes, and panels of two of them: where values have their places.

use super::pixels::{FINE, fine};
use super::style::Unit;
use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;

/// What is smaller is zero on an axis: below it, fractions of a range lose their digits.
const SMALLEST: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// What places on an axis stand for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// The value itself.
    Value,
    /// a sinh(b place): a scale that is linear near zero and logarithmic far from it.
    Sinh(f64, f64),
    /// Rows of names, without values.
    Rows,
}

/// An axis in displayed units.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Label with unit.
    pub label: String,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Logarithmic.
    pub log: bool,
    /// Fixed distance of the ticks of a linear axis.
    pub step: Option<f64>,
    /// Where the ticks are; empty for round values.
    pub named: Vec<f64>,
    /// What places stand for.
    pub scale: Scale,
    /// Values per displayed unit, where they differ.
    pub per: f64,
}

impl Axis {
    /// A linear axis over exactly this range, widened where it has no extent.
    pub fn linear(label: impl Into<String>, low: f64, high: f64) -> Self {
        let (low, high) = if (high - low).is_finite() { (low, high) } else { (0.0, 1.0) };
        let scale = low.abs().max(high.abs());
        let flat = high - low <= (1e-9 * scale).max(SMALLEST);
        let pad = if !flat {
            0.0
        } else if scale <= SMALLEST {
            1.0
        } else {
            0.05 * scale
        };
        Self {
            label: label.into(),
            low: (low - pad).max(f64::MIN),
            high: (high + pad).min(f64::MAX),
            log: false,
            step: None,
            named: Vec::new(),
            scale: Scale::Value,
            per: 1.0,
        }
    }

    /// A linear axis of frequencies over exactly this range, named in Hz, kHz or MHz.
    pub fn frequency(name: &str, low: f64, high: f64) -> Self {
        let unit = Unit::frequency(high);
        Self { per: unit.factor, ..Self::linear(format!("{name} [{}]", unit.label), low, high) }
    }

    /// A linear axis around the values with a margin; from zero where they are positive and come near it.
    pub fn around(label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = range(values);
        let margin = 0.06 * (high - low);
        if low >= 0.0 && low < 0.45 * high {
            return Self::linear(label, 0.0, high + margin);
        }
        Self::linear(label, low - margin, high + margin)
    }

    /// A logarithmic axis around the positive values with a margin of `margin` of its length.
    pub fn logarithmic(label: impl Into<String>, values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let (low, high) = range(values.into_iter().filter(|value| *value > SMALLEST).map(f64::log10));
        let (low, high) = if !low.is_finite() { (-1.0, 0.0) } else { (low, high) };
        let pad = if high - low < 0.05 { 0.3 } else { margin * (high - low) };
        let reach = |exponent: f64| 10f64.powf(exponent).clamp(SMALLEST, f64::MAX);
        let (low, high) = (reach(low - pad), reach(high + pad));
        let (label, named) = (label.into(), Vec::new());
        Self { label, low, high, log: true, step: None, named, scale: Scale::Value, per: 1.0 }
    }

    /// The same with ticks at multiples of `step`.
    pub fn step(self, step: f64) -> Self {
        Self { step: Some(step), ..self }
    }

    /// The same with ticks at these values and no others.
    pub fn at(self, values: &[f64]) -> Self {
        Self { named: values.to_vec(), ..self }
    }

    /// An axis of rows that names nothing itself.
    pub fn rows() -> Self {
        Self { scale: Scale::Rows, ..Self::linear("", 0.2, 0.8).step(2.0) }
    }

    /// The same with places that stand for a sinh(b place).
    pub fn sinh(self, a: f64, b: f64) -> Self {
        Self { scale: Scale::Sinh(a, b), ..self }
    }

    /// Place of a value between the ends of the axis, given in logical pixels; none for what has no place on it.
    fn place(&self, value: f64, (start, end): (f64, f64)) -> f64 {
        let limits = (fine(start), fine(end));
        if !value.is_finite() || (self.log && value <= 0.0) {
            return f64::NAN;
        }
        let place = if self.log {
            LogCoord::from((self.low..self.high).log_scale()).map(&value, limits)
        } else {
            // plotters adds in 32 bits, which values far outside would exceed.
            let reach = 99.0 * (self.high - self.low);
            RangedCoordf64::from(self.low..self.high).map(&value.clamp(self.low - reach, self.high + reach), limits)
        };
        f64::from(place) / FINE
    }
}

/// Smallest and largest finite value (infinite ends where there is none).
pub fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// A rectangle of the figure with its two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Left edge \[px\].
    pub left: f64,
    /// Upper edge \[px\].
    pub top: f64,
    /// Width \[px\].
    pub width: f64,
    /// Height \[px\].
    pub height: f64,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
}

impl Panel {
    /// Pixel of a value on the horizontal axis; NaN where it has no place there.
    pub fn px(&self, value: f64) -> f64 {
        self.x.place(value, (self.left, self.right()))
    }

    /// Pixel of a value on the vertical axis; NaN where it has no place there.
    pub fn py(&self, value: f64) -> f64 {
        self.y.place(value, (self.bottom(), self.top))
    }

    /// Right edge \[px\].
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Lower edge \[px\].
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// The panel with the names of its axes only where asked for: the others share them.
    pub fn named(&self, below: bool, beside: bool) -> Self {
        let named =
            |axis: &Axis, named| if named { axis.clone() } else { Axis { label: String::new(), ..axis.clone() } };
        Self { x: named(&self.x, below), y: named(&self.y, beside), ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_run_between_the_edges_and_far_values_stay_finite() {
        let axis = |log| Axis { log, ..Axis::linear("", 1.0, 100.0) };
        let (x, y) = (axis(true), axis(false));
        let panel = Panel { left: 10.0, top: 20.0, width: 200.0, height: 99.0, x, y };
        assert_eq!([1.0, 10.0, 100.0].map(|value| panel.px(value)), [10.0, 110.0, 210.0]);
        assert_eq!([1.0, 2.0, 100.0].map(|value| panel.py(value)), [119.0, 118.0, 20.0]);
        assert!([0.0, -1.0, f64::NAN, f64::INFINITY].iter().all(|value| panel.px(*value).is_nan()));
        assert!(panel.py(1e300) < -9000.0 && panel.py(-1e300) > 9000.0 && panel.px(1e300) > 9000.0);
    }
}
