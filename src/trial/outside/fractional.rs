//! A spring-pot in the contact: part of the bristles' stiffness becomes k (i w/w0)^alpha.

use super::{Departure, Outside};
use crate::model::Model;
use crate::parameter::ParameterInfo;
use std::f64::consts::{PI, TAU};

/// Elements of the diffusive approximation.
const ELEMENTS: usize = 32;
/// Their corner frequencies \[Hz\].
const BAND: (f64, f64) = (0.01, 1e5);
/// Where the spring-pot has the modulus of the spring that it replaces \[Hz\].
const REFERENCE: f64 = 72.0;

/// Springs and dashpots that together have the modulus (i w/w0)^alpha.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffusive {
    /// What is slower than the band.
    pub spring: f64,
    /// What is faster than the band \[s\].
    pub damper: f64,
    /// (stiffness, rate \[1/s\]) of the elements k i w/(i w + r).
    pub elements: Vec<(f64, f64)>,
}

impl Diffusive {
    /// Complex modulus at `omega` \[rad/s\].
    pub fn modulus(&self, omega: f64) -> (f64, f64) {
        let start = (self.spring, omega * self.damper);
        self.elements.iter().fold(start, |(re, im), (k, r)| {
            let square = omega * omega + r * r;
            (re + k * omega * omega / square, im + k * omega * r / square)
        })
    }
}

/// The diffusive (Prony) form of a spring-pot of that order with modulus 1 at `reference` \[Hz\]: the integral
/// s^a = sin(pi a)/pi int r^(a-1) s/(s + r) dr over the logarithm of r, its tails in closed form.
pub fn diffusive(order: f64, elements: usize, reference: f64) -> Diffusive {
    let factor = (PI * order).sin() / PI / (TAU * reference).powf(order);
    let (low, high) = (TAU * BAND.0, TAU * BAND.1);
    let step = (high / low).ln() / (elements - 1) as f64;
    let element = |index: usize| {
        let rate = low * (step * index as f64).exp();
        let weight = if index == 0 || index == elements - 1 { 0.5 } else { 1.0 };
        (factor * weight * step * rate.powf(order), rate)
    };
    Diffusive {
        spring: factor * low.powf(order) / order,
        damper: factor * high.powf(order - 1.0) / (1.0 - order),
        elements: (0..elements).map(element).collect(),
    }
}

/// The cause.
pub struct SpringPot;

impl Outside for SpringPot {
    fn name(&self) -> &'static str {
        "outside-spring-pot"
    }

    fn title(&self) -> &'static str {
        "a fractional spring-pot takes the place of part of the contact's spring"
    }

    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("share", "s", "1"), (0.0, 1.0), (0.3, 1.0), "share of the stiffness at 72 Hz"),
            ParameterInfo::searched(("order", "α", "1"), (0.01, 0.99), (0.1, 0.7), "order of the derivative"),
        ];
        LIST
    }

    fn departure(&self, p: &[f64], model: &Model, _speed: f64, _ordinal: usize) -> Departure {
        let stiffness = p[0] * model.contact.stiffness;
        let unit = diffusive(p[1], ELEMENTS, REFERENCE);
        Departure {
            spring_share: 1.0 - p[0],
            added_stiffness: stiffness * unit.spring,
            added_damping: stiffness * unit.damper,
            branches: unit.elements.iter().map(|(k, r)| (stiffness * k, *r)).collect(),
            ..Departure::default()
        }
    }
}
