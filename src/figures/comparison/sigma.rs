//! The scale of residuals: linear below two standard deviations, logarithmic far above, so that noise and a misfit of a
//! hundred sigma show in one drawing.

use crate::figures::axes::Axis;
use crate::figures::style::significant;

/// Residuals within this band are no surprise.
pub const BAND: f64 = 2.0;
/// Smallest end of the scale.
const LEAST: f64 = 5.0;

/// A scale of residuals in standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sigma {
    /// The end of the scale.
    pub limit: f64,
    /// The largest residual.
    largest: f64,
}

impl Sigma {
    /// A scale that reaches to the largest residual.
    pub fn over(residuals: impl IntoIterator<Item = f64>) -> Self {
        let sizes = residuals.into_iter().map(f64::abs).filter(|size| size.is_finite());
        let largest = sizes.fold(0.0, f64::max);
        Self { limit: largest.max(LEAST), largest }
    }

    /// Place of a residual, -1 to 1.
    pub fn place(self, residual: f64) -> f64 {
        ((residual / BAND).asinh() / (self.limit / BAND).asinh()).clamp(-1.0, 1.0)
    }

    /// An axis of places that names its residuals.
    pub fn axis(self, label: &str) -> Axis {
        Axis::linear(label, -1.0, 1.0).sinh(BAND, (self.limit / BAND).asinh())
    }

    /// Positive round values up to the end of the scale, not crowded.
    pub fn ticks(self) -> Vec<f64> {
        let mut ticks: Vec<f64> = vec![BAND];
        let steps = [5.0, 20.0, 100.0, 500.0, 2000.0, 1e4, 1e5, 1e6];
        ticks.extend(steps.into_iter().filter(|step| *step <= self.limit * (1.0 + 1e-9)));
        ticks
    }

    /// The largest round value that keeps clear of the end of the scale.
    pub fn top(self) -> f64 {
        self.ticks().into_iter().rfind(|tick| self.place(*tick) < 0.8).unwrap_or(BAND)
    }

    /// What a caption says of the scale.
    pub fn sentence(self) -> String {
        format!(
            "Errors are model minus measurement in standard deviations σ of the reading; their scale is linear within about \
             ±{BAND} σ and logarithmic beyond, and reaches to {} σ; the largest error is {} σ.",
            significant(self.limit, 3),
            significant(self.largest, 3)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_odd_monotonic_and_ends_at_one() {
        let scale = Sigma::over([0.1, -80.0, f64::NAN, f64::INFINITY]);
        assert_eq!(scale.limit, 80.0);
        assert_eq!([-80.0, 0.0, 80.0, 1e9].map(|r| scale.place(r)), [-1.0, 0.0, 1.0, 1.0]);
        assert!(scale.place(2.0) > 0.15 && scale.place(-3.0) == -scale.place(3.0));
        assert_eq!(scale.ticks(), [2.0, 5.0, 20.0]);
        assert_eq!(Sigma::over([]).limit, 5.0);
    }
}
