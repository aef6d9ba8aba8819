//! How conditions are named, and which of many are shown.

use crate::compare::{Comparison, Setting};
use crate::figures::style::{Unit, significant};

/// Panels or curves that a figure shows at most.
pub const MOST: usize = 16;

/// The speed, as `V = 0.1 mm/s`.
pub fn speed(setting: &Setting) -> String {
    format!("V = {}", speed_value(setting.speed))
}

/// The speed alone.
pub fn speed_value(speed: f64) -> String {
    if speed == 0.0 { "0 mm/s".into() } else { Unit::speed().show(speed, 3) }
}

/// Load and drive, as `W = 20 N, u₀ = 2.5 µm`.
pub fn load_and_drive(setting: &Setting) -> String {
    format!("W = {} N, u₀ = {}", significant(setting.load, 3), drive(setting))
}

/// The drive alone.
pub fn drive(setting: &Setting) -> String {
    Unit::fitting(setting.drive, "m").show(setting.drive, 3)
}

/// The condition in one line.
pub fn condition(setting: &Setting) -> String {
    format!("{}, {}", speed(setting), load_and_drive(setting))
}

/// Without symbols, for narrow legends.
pub fn brief(setting: &Setting) -> String {
    format!("{}, {} N, {}", speed_value(setting.speed), significant(setting.load, 3), drive(setting))
}

/// Indices of the conditions shown, in their own order: all of them, or where there are too many the worst by chi2; and
/// what the caption says of that.
pub fn shown(comparison: &Comparison) -> (Vec<usize>, String) {
    let count = comparison.conditions.len();
    let mut order: Vec<usize> = (0..count).collect();
    if count <= MOST {
        return (order, String::new());
    }
    let chi2 = |i: &usize| {
        let metrics = &comparison.conditions[*i].metrics;
        metrics.chi2_per_point * metrics.readings as f64
    };
    order.sort_by(|a, b| chi2(b).total_cmp(&chi2(a)));
    order.truncate(MOST);
    order.sort_unstable();
    (order, format!(" Of {count} conditions the {MOST} with the largest misfit are shown; the CSV has all."))
}

/// Whether amplitudes are shown per drive: where there are several drives, so that one scale serves all.
pub fn per_drive(comparison: &Comparison) -> bool {
    comparison.conditions.windows(2).any(|pair| pair[0].setting.drive != pair[1].setting.drive)
}

/// How amplitudes are shown: per drive, or in a unit with prefix.
pub struct Amplitude {
    per_drive: bool,
    unit: Unit,
}

impl Amplitude {
    /// The way that suits a comparison.
    pub fn of(comparison: &Comparison) -> Self {
        let largest = comparison.points.iter().map(|p| p.point.amplitude).fold(0.0, f64::max);
        Self { per_drive: per_drive(comparison), unit: Unit::fitting(largest, "rad") }
    }

    /// An amplitude under a condition, as shown.
    pub fn value(&self, amplitude: f64, setting: &Setting) -> f64 {
        if self.per_drive { amplitude / setting.drive } else { self.unit.of(amplitude) }
    }

    /// Name with unit.
    pub fn label(&self) -> String {
        if self.per_drive {
            "amplitude per drive α/u₀ [rad/m]".into()
        } else {
            format!("amplitude α [{}]", self.unit.label)
        }
    }
}
