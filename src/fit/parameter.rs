//! What a fit may move: one number of a model with its bounds, on a scale on which searching is natural.

use std::f64::consts::PI;

use crate::model::Model;
use crate::parameter::FIRST_EFFECT_PARAMETER;
use crate::parameter::ParameterInfo;
use crate::statistics::wrap;

/// A contact is searched within this factor of its stated values.
const CONTACT_FACTOR: f64 = 30.0;
/// A rig and its instrument are known within this factor.
const RIG_FACTOR: f64 = 3.0;
/// Its dampings, which nobody measures before the experiment, within this one.
const RIG_DAMPING_FACTOR: f64 = 10.0;
/// Numbers of any other rig, its stiffness apart, within this one.
const UNKNOWN_FACTOR: f64 = 1e3;
/// A fit may leave the range that the catalogue searches by this factor.
const BEYOND: f64 = 3.0;
/// Part of the largest magnitude that counts as zero where a range starts at zero; of the smallest, where either sign
/// is physical.
const SMALLEST: f64 = 1e-4;

/// Sine of the coordinate at which a fit starts whose value is at a bound, where the coordinate has no slope.
const INSIDE: f64 = 0.999;
/// Coordinate of the middle of the bounds.
const ORIGIN: f64 = 1.0;

/// A parameter of a fit. The fit moves a coordinate u without bounds; the value is `t = middle + half sin(u - 1)`
/// between the bounds (so that the middle is at u = 1 and the first trust region, which is relative to u, is none of
/// zero size), `t` being the value or, for magnitudes, its logarithm. An angle has no bounds: `t = middle + half (u -
/// 1)`, and the values are those of one turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Key as in `[fit] free`, e.g. `contact.stiffness`, `effect.grosch.h`.
    pub key: String,
    /// SI unit.
    pub unit: &'static str,
    /// Symbol of the equations; may be empty.
    pub symbol: &'static str,
    /// Number among the parameters of the model ([`Model::parameter`]).
    pub index: usize,
    /// Whether either sign is physical, so that a search tries both.
    pub signed: bool,
    /// Sign of the value, for magnitudes.
    sign: f64,
    /// Whether it is a magnitude; else it is an angle, of which values a turn apart are the same.
    logarithmic: bool,
    /// What is added to the value before its magnitude is taken: 1 of a relative change.
    beside: f64,
    /// Bounds of `t`.
    bounds: (f64, f64),
    /// Bounds of `t` between which a search starts.
    range: (f64, f64),
}

/// The parameter of that key of a model, searched around its present value; `None` where the model has no such key.
pub fn parameter(model: &Model, key: &str) -> Option<Parameter> {
    let (table, name) = key.split_once('.')?;
    if table == "effect" {
        let (effect, name) = name.rsplit_once('.')?;
        let mut index = FIRST_EFFECT_PARAMETER;
        for (candidate, values) in &model.effects {
            for (number, (info, &value)) in candidate.parameters().iter().zip(values).enumerate() {
                if candidate.name() == effect && info.key == name && !info.held {
                    let range = candidate.search_range(number, &model.scales);
                    return Some(of_effect(key, &info.on(model.rig.coordinate()), index, value, range));
                }
                index += 1;
            }
        }
        return None;
    }
    let (_, index, info) = model.base_parameters().into_iter().find(|(known, ..)| known == key)?;
    let at = &mut crate::model::Operation { speed: 0.0, load: 0.0, drive: 0.0, frequency: 0.0, series: 0 };
    let value = *model.clone().parameter(at, index)?;
    let factor = match table {
        "contact" => CONTACT_FACTOR,
        // Nobody knows the mass of a mode, its damping or the gain of a sensor before it is measured.
        _ if !model.rig.is_arm() && !["natural_frequency", "stiffness"].contains(&name) => UNKNOWN_FACTOR,
        "rig" if ["damping", "quality_factor", "damping_ratio"].iter().any(|end| name.ends_with(end)) => {
            RIG_DAMPING_FACTOR
        }
        _ => RIG_FACTOR,
    };
    Some(of_base(key, info, index, (value, size_beside_zero(model, table, info)), factor))
}

/// A size for a number that is stated as zero: a critical damping, a friction coefficient of one.
fn size_beside_zero(model: &Model, table: &str, info: &ParameterInfo) -> f64 {
    let scales = &model.scales;
    match (table, info.unit) {
        (_, "1") => 1.0,
        ("contact", _) => model.contact.stiffness / scales.omega,
        _ => {
            scales.stiffness
                / scales.omega
                / if info.unit == "N s/m" { scales.lever.powi(2).max(f64::MIN_POSITIVE) } else { 1.0 }
        }
    }
}

/// A positive magnitude with these bounds and this range of its logarithm.
fn magnitude(key: &str, info: &ParameterInfo, index: usize, (bounds, range): ((f64, f64), (f64, f64))) -> Parameter {
    Parameter {
        key: key.into(),
        unit: info.unit,
        symbol: info.symbol,
        index,
        signed: false,
        sign: 1.0,
        logarithmic: true,
        beside: 0.0,
        bounds,
        range,
    }
}

fn of_base(key: &str, info: &ParameterInfo, index: usize, (value, beside_zero): (f64, f64), factor: f64) -> Parameter {
    if info.minimum < 0.0 {
        let (bounds, range) = ((value - PI, value + PI), (value - 0.5 * PI, value + 0.5 * PI));
        return Parameter { logarithmic: false, ..magnitude(key, info, index, (bounds, range)) };
    }
    // Nothing is known of what is stated as zero.
    let (lower, upper) =
        if value > 0.0 { (value / factor, value * factor) } else { (SMALLEST * SMALLEST * beside_zero, beside_zero) };
    let clip = |x: f64| x.clamp(info.minimum, info.maximum);
    let bounds = (clip(lower).ln(), clip(upper).ln());
    let middle = if value > 0.0 { value.ln() } else { 0.5 * (bounds.0 + bounds.1) };
    let range = (0.5 * (bounds.0 + middle), 0.5 * (bounds.1 + middle));
    magnitude(key, info, index, (bounds, range))
}

fn of_effect(key: &str, info: &ParameterInfo, index: usize, value: f64, (low, high): (f64, f64)) -> Parameter {
    if info.change {
        return of_change(key, info, index, high);
    }
    let low = if low > 0.0 { low } else { SMALLEST * high };
    let smallest = match (info.signed, info.minimum <= 0.0) {
        // As good as zero, which lies between the signs.
        (true, _) => SMALLEST * low,
        (false, true) => low / BEYOND,
        (false, false) => (low / BEYOND).max(info.minimum),
    };
    let largest = (high * BEYOND).min(info.maximum);
    let range = (low.ln(), high.ln());
    // A value that a user wrote is within the bounds.
    let written = if value == 0.0 { range.0 } else { value.abs().ln() };
    let bounds = (smallest.ln().min(written), largest.ln().max(written));
    let sign = if value < 0.0 { -1.0 } else { 1.0 };
    Parameter { signed: info.signed, sign, ..magnitude(key, info, index, (bounds, range)) }
}

/// A relative change, searched up to `high` to either side of none.
fn of_change(key: &str, info: &ParameterInfo, index: usize, high: f64) -> Parameter {
    let whole = |change: f64| change.clamp(info.minimum, info.maximum).ln_1p();
    let bounds = (whole(info.minimum), whole(info.maximum));
    Parameter { beside: 1.0, ..magnitude(key, info, index, (bounds, (whole(-high), whole(high)))) }
}

impl Parameter {
    /// Whether values a turn apart are the same.
    pub fn is_periodic(&self) -> bool {
        !self.logarithmic
    }

    /// Value at the coordinate `u`.
    pub fn value(&self, u: f64) -> f64 {
        if self.is_periodic() {
            return self.middle() + wrap(self.half() * (u - ORIGIN));
        }
        self.at(self.middle() + self.half() * (u - ORIGIN).sin())
    }

    /// Derivative of the value by the coordinate.
    pub fn slope(&self, u: f64) -> f64 {
        if self.is_periodic() {
            return self.half();
        }
        let by_t = self.natural_slope(self.value(u));
        by_t * self.half() * (u - ORIGIN).cos()
    }

    /// Coordinate of a value; one at a bound is moved a little away from it, where the coordinate has no slope.
    pub fn coordinate(&self, value: f64) -> f64 {
        let sine = (self.scale(value) - self.middle()) / self.half();
        if self.is_periodic() {
            return sine + ORIGIN;
        }
        let inside = if sine.abs() < 1.0 - 1e-9 { sine } else { sine.clamp(-INSIDE, INSIDE) };
        inside.asin() + ORIGIN
    }

    /// Of a value nearer to a bound than a fit starts that begins there: the side on the natural scale, -1 or 1, and
    /// the coordinate of the bound.
    pub fn edge(&self, value: f64) -> Option<(f64, f64)> {
        let sine = (self.scale(value) - self.middle()) / self.half();
        let side = sine.signum();
        (sine.abs() >= INSIDE && self.logarithmic).then_some((side, ORIGIN + side * std::f64::consts::FRAC_PI_2))
    }

    /// Value at the share `share` in 0..1 of the range of a search.
    pub fn within(&self, share: f64) -> f64 {
        self.at(self.range.0 + share * (self.range.1 - self.range.0))
    }

    /// The share of the range of a search at which a value lies: 0 at its start, 1 at its end, beyond that outside.
    pub fn share(&self, value: f64) -> f64 {
        (self.scale(value) - self.range.0) / (self.range.1 - self.range.0)
    }

    /// Whether a value lies within its bounds.
    pub fn reaches(&self, value: f64) -> bool {
        let t = self.scale(value);
        self.bounds.0 <= t && t <= self.bounds.1
    }

    /// How far a value lies from the middle of the range of a search: 0 there, 1 at either end, more outside.
    pub fn strain(&self, value: f64) -> f64 {
        (2.0 * self.share(value) - 1.0).abs()
    }

    /// Length of the range of a search on the natural scale.
    pub fn extent(&self) -> f64 {
        self.range.1 - self.range.0
    }

    /// The parameter within values of at most that strain, and within its bounds.
    pub fn strained_at_most(&self, strain: f64) -> Self {
        let (middle, half) = (0.5 * (self.range.0 + self.range.1), 0.5 * strain * (self.range.1 - self.range.0));
        let bounds = (self.bounds.0.max(middle - half), self.bounds.1.min(middle + half));
        Self { bounds, ..self.clone() }
    }

    /// The parameter for values of the other sign.
    pub fn mirrored(&self) -> Self {
        Self { sign: -self.sign, ..self.clone() }
    }

    /// Smallest and largest value in magnitude order of the bounds.
    pub fn bounds(&self) -> (f64, f64) {
        let (a, b) = (self.at(self.bounds.0), self.at(self.bounds.1));
        (a.min(b), a.max(b))
    }

    /// Whether the value lies at one of the bounds.
    pub fn at_bound(&self, value: f64) -> bool {
        if self.is_periodic() {
            return false;
        }
        let t = self.scale(value);
        let margin = 0.01 * (self.bounds.1 - self.bounds.0);
        t < self.bounds.0 + margin || t > self.bounds.1 - margin
    }

    /// Change of the value by a factor (magnitudes) or an addition, on which curvature is smallest: derivative of the
    /// value by that scale.
    pub fn natural_slope(&self, value: f64) -> f64 {
        if self.logarithmic { value + self.beside } else { 1.0 }
    }

    /// Whether an interval about a value that ends there ends at a bound, or an angle half a turn away.
    pub fn is_open(&self, value: f64, end: f64) -> bool {
        if self.is_periodic() { (end - value).abs() > PI * (1.0 - 1e-9) } else { self.at_bound(end) }
    }

    /// Length of the longest step of that sign from the value on its natural scale: to the bound, half a turn of an
    /// angle.
    pub fn room(&self, value: f64, direction: f64) -> f64 {
        if self.is_periodic() {
            return PI;
        }
        let bound = if direction < 0.0 { self.bounds.0 } else { self.bounds.1 };
        (bound - self.scale(value)).abs()
    }

    /// The value moved by `step` on its natural scale, within the bounds.
    pub fn moved(&self, value: f64, step: f64) -> f64 {
        if self.is_periodic() {
            return value + step;
        }
        self.at((self.scale(value) + step).clamp(self.bounds.0, self.bounds.1))
    }

    /// The step on the natural scale from one value to another.
    pub fn natural_step(&self, from: f64, to: f64) -> f64 {
        self.scale(to) - self.scale(from)
    }

    /// Distance of two values on the natural scale.
    pub fn natural_distance(&self, from: f64, to: f64) -> f64 {
        self.natural_step(from, to).abs()
    }

    /// `t` of a value.
    fn scale(&self, value: f64) -> f64 {
        if self.logarithmic { (value + self.beside).abs().max(f64::MIN_POSITIVE).ln() } else { value }
    }

    fn at(&self, t: f64) -> f64 {
        if self.logarithmic { self.sign * t.exp() - self.beside } else { t }
    }
    fn middle(&self) -> f64 {
        0.5 * (self.bounds.0 + self.bounds.1)
    }
    fn half(&self) -> f64 {
        0.5 * (self.bounds.1 - self.bounds.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_has_no_bounds_and_one_turn_of_values() {
        let info = crate::scenario::parameters::of_key("instrument.phase_offset", true).expect("an angle");
        let angle = of_base("instrument.phase_offset", info, 0, (3.0, 1.0), 1.0);
        for value in [3.0, -0.1, 6.1] {
            let u = angle.coordinate(value);
            let step = 1e-6;
            let difference = (angle.value(u + step) - angle.value(u - step)) / (2.0 * step);
            assert!((angle.value(u) - value).abs() < 1e-12 && (difference / angle.slope(u) - 1.0).abs() < 1e-6);
            // The slope does not turn back anywhere, and the values come again after a turn.
            assert_eq!(angle.slope(u + 1e3), angle.slope(u));
            assert!((angle.value(u + std::f64::consts::TAU / angle.slope(u)) - value).abs() < 1e-9);
            assert!(!angle.at_bound(value) && angle.edge(value).is_none());
        }
        assert!(angle.is_open(3.0, 3.0 + angle.room(3.0, 1.0)) && !angle.is_open(3.0, angle.moved(3.0, 3.0)));
    }
}
