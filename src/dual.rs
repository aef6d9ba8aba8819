//! Forward-mode derivatives of the lumped coefficients by every parameter of a model.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Most parameters a model can have: rig, contact, instrument, condition and all effects together.
pub const MAX_PARAMETERS: usize = 48;

/// What a formula is evaluated in: a value alone, or with its gradient.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self>
{
    /// Of a value with its gradient.
    fn of(dual: &Dual) -> Self;
    /// A constant.
    fn constant(value: f64) -> Self;
    /// The parameter number `index`.
    fn parameter(value: f64, index: usize) -> Self;
    /// Reciprocal.
    fn recip(self) -> Self;
}

impl Scalar for f64 {
    fn of(dual: &Dual) -> Self {
        dual.value
    }
    fn constant(value: f64) -> Self {
        value
    }
    fn parameter(value: f64, _: usize) -> Self {
        value
    }
    fn recip(self) -> Self {
        1.0 / self
    }
}

impl Scalar for Dual {
    fn of(dual: &Dual) -> Self {
        *dual
    }
    fn constant(value: f64) -> Self {
        Self::constant(value)
    }
    fn parameter(value: f64, index: usize) -> Self {
        Self::parameter(value, index)
    }
    fn recip(self) -> Self {
        self.recip()
    }
}

/// A value with its gradient by all parameters.
#[derive(Debug, Clone, Copy)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its gradient.
    pub gradient: [f64; MAX_PARAMETERS],
}

impl Dual {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; MAX_PARAMETERS] }
    }
    /// The parameter number `index`.
    pub fn parameter(value: f64, index: usize) -> Self {
        let mut dual = Self::constant(value);
        dual.gradient[index] = 1.0;
        dual
    }
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient.map(|g| slope * g) }
    }
    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        let mut gradient = [0.0; MAX_PARAMETERS];
        for (out, (x, y)) in gradient.iter_mut().zip(self.gradient.iter().zip(&other.gradient)) {
            *out = a * x + b * y;
        }
        Self { value, gradient }
    }
    /// Square root.
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    /// Power of a positive number.
    pub fn powd(self, exponent: Self) -> Self {
        let value = self.value.powf(exponent.value);
        self.combine(exponent, value, exponent.value * value / self.value, value * self.value.ln())
    }
    /// Sine and cosine.
    pub fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }
    /// Reciprocal.
    pub fn recip(self) -> Self {
        self.chain(1.0 / self.value, -1.0 / (self.value * self.value))
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.combine(other, quotient, 1.0 / other.value, -quotient / other.value)
    }
}
impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self.chain(self.value * factor, factor)
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_of_a_compound_expression_matches_its_closed_form() {
        let (x, y) = (Dual::parameter(1.7, 0), Dual::parameter(-0.4, 1));
        let f = (x * y - x.recip()) / (x + y * y).sqrt();
        let root = (1.7f64 + 0.16).sqrt();
        let numerator = 1.7 * -0.4 - 1.0 / 1.7;
        assert!((f.value - numerator / root).abs() < 1e-15);
        let dx = (-0.4 + 1.0 / (1.7 * 1.7)) / root - numerator * 0.5 / root.powi(3);
        let dy = 1.7 / root - numerator * -0.4 / root.powi(3);
        assert!((f.gradient[0] - dx).abs() < 1e-14 && (f.gradient[1] - dy).abs() < 1e-14);
        let power = x.powd(y);
        assert!((power.gradient[0] + 0.4 * 1.7f64.powf(-1.4)).abs() < 1e-15);
        assert!((power.gradient[1] - 1.7f64.powf(-0.4) * 1.7f64.ln()).abs() < 1e-15);
    }
}
