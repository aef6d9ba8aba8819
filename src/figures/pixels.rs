//! Logical pixels, in which figures are laid out, and the units of the backend.

/// A point in logical pixels.
pub type Point = (f64, f64);

/// Units of the backend per logical pixel.
pub const FINE: f64 = 16.0;

/// A length in units of the backend.
pub fn fine(length: f64) -> i32 {
    (length * FINE).round() as i32
}
