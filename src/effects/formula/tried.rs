//! A formula tried at places and values, before it counts as a law.

use super::expression::{Blame, Fault};
use super::program::{Jet, Program, VARIABLES};
use super::statement::{ActsOn, Stated, Statement};
use crate::effects::Zero;
use std::f64::consts::TAU;

/// Magnitudes of the variables at which a formula is tried, in SI; at the first two it has to be finite whatever the
/// rig, beyond them an exponential may overflow.
const TRIED: [f64; 5] = [0.0, 1e-9, 1e-6, 1e-3, 1.0];
const NEAR: f64 = 1e-9;
/// Phases of an oscillation at which a force is looked at.
const PHASES: usize = 16;

/// A formula that is being tried.
pub(super) struct Tried<'a> {
    pub statement: &'a Statement,
    pub program: &'a Program,
}

impl Tried<'_> {
    /// Values of the parameters to try it with: as stated, in the middle of their ranges, or 1.
    pub fn nominal(&self) -> Vec<f64> {
        let of = |stated: &Stated| match (stated.value, stated.range) {
            (0.0, Some((low, high, _))) => low.max(1e-4 * high).sqrt() * high.sqrt(),
            (0.0, None) => 1.0,
            (value, _) => value,
        };
        self.statement.parameters.iter().map(of).collect()
    }

    /// Places at which it is tried.
    fn places(&self) -> Vec<[f64; VARIABLES]> {
        let either: Vec<f64> = TRIED.iter().flat_map(|x| [*x, -x]).collect();
        match self.statement.acts_on {
            ActsOn::Friction => TRIED.iter().map(|s| [*s, 0.0]).collect(),
            _ => either.iter().flat_map(|x| either.iter().map(move |v| [*x, *v])).collect(),
        }
    }

    fn value(&self, place: [f64; VARIABLES], parameters: &[f64]) -> f64 {
        self.program.jet(&place, parameters)[0]
    }

    /// The place in words.
    fn words(&self, place: [f64; VARIABLES]) -> String {
        let one = |(name, value): (&&str, f64)| format!("{name} = {value:e}");
        self.statement.acts_on.variables().iter().zip(place).map(one).collect::<Vec<_>>().join(", ")
    }

    /// Whether it has finite values and slopes where the variables are small, and does not jump where they change sign.
    pub fn check_finite(&self) -> Result<(), Fault> {
        let nominal = self.nominal();
        let friction = self.statement.acts_on == ActsOn::Friction;
        let near = |place: &[f64; VARIABLES]| friction || place.iter().all(|x| x.abs() <= NEAR);
        for place in self.places().into_iter().filter(near) {
            let jet = self.program.jet(&place, &nominal);
            if jet.iter().any(|x| !x.is_finite()) {
                let what = if jet[0].is_finite() { "a slope" } else { "a value" };
                let title = format!("the formula has {what} that is not finite at {}", self.words(place));
                let help = "variables take either sign and pass through zero (s is never negative): write abs(v)^p*sign(v) \
                            for a power p of a speed, ln(1 + s/v_0) for a logarithm";
                return Err(self.statement.fault(&title, "not finite there", help));
            }
        }
        let variables = self.statement.acts_on.variables();
        for (variable, name) in variables.iter().enumerate().filter(|_| !friction) {
            if self.jumps(variable, |jet| jet[0]) {
                let title = format!("the formula jumps where {name} changes sign");
                let help =
                    format!("solvers need a force without jumps: write e.g. tanh({name}/{name}_0) for sign({name})");
                return Err(self.statement.fault(&title, "not continuous", &help));
            }
        }
        Ok(())
    }

    /// Whether its value, or a slope, jumps or has no bound where a variable changes sign.
    pub fn jumps(&self, variable: usize, of: impl Fn(Jet) -> f64) -> bool {
        let nominal = self.nominal();
        let at = |beside: f64, t: f64| {
            let mut place = [beside; VARIABLES];
            place[variable] = t;
            of(self.program.jet(&place, &nominal))
        };
        // Of what is continuous the difference falls with the distance, by less than that for powers near zero only;
        // what has no bound grows.
        [0.0, 1e-6].into_iter().any(|beside| {
            let [near, far] = [1e-40, 1e-20].map(|t| [at(beside, t), at(beside, -t)]);
            let across = |ends: [f64; 2]| (ends[0] - ends[1]).abs();
            across(near).is_nan() || across(near) > 0.5 * across(far) || near[0].abs() > 2.0 * far[0].abs()
        })
    }

    /// The parameters that take it away when they are zero: one of them, or the fewest together.
    pub fn zero(&self) -> Result<Vec<Zero>, Fault> {
        let nominal = self.nominal();
        // Far out an exponential may overflow, and a logarithm end.
        let finite = |place: &[f64; VARIABLES]| self.value(*place, &nominal).is_finite();
        let places: Vec<[f64; VARIABLES]> = self.places().into_iter().filter(finite).collect();
        if !places.iter().any(|place| self.value(*place, &nominal).abs() > 0.0) {
            let help = "check its brackets and the values of its parameters";
            return Err(self.statement.fault("the formula is zero wherever it is tried", "always zero", help));
        }
        let count = nominal.len();
        let mut sets: Vec<u32> = (1..1 << count).collect();
        sets.sort_by_key(|set| set.count_ones());
        let vanishes = |set: &u32| {
            let without: Vec<f64> = (0..count).map(|i| if set >> i & 1 == 1 { 0.0 } else { nominal[i] }).collect();
            places.iter().all(|place| self.value(*place, &without) == 0.0)
        };
        let Some(set) = sets.into_iter().find(vanishes) else {
            let help = "give it a strength: a factor such as k in k*(…), with which it vanishes at 0";
            let title = "the formula does not vanish at 0 of any of its parameters";
            return Err(self.statement.fault(title, "no strength", help));
        };
        let zero = (0..count).filter(|i| set >> i & 1 == 1).map(|parameter| Zero { parameter, value: 0.0 });
        Ok(zero.collect())
    }

    /// Whether a search knows where to look for every parameter.
    pub fn check_ranges(&self, zero: &[Zero]) -> Result<(), Fault> {
        for (index, stated) in self.statement.parameters.iter().enumerate() {
            let strength = zero.iter().any(|zero| zero.parameter == index);
            if stated.range.is_some() || (stated.value != 0.0 && !strength) || (strength && self.is_linear(index)) {
                continue;
            }
            let title = format!("it cannot be told how large `{}` may be", stated.key);
            let label = if strength { "the formula is not in proportion to it" } else { "stated as zero" };
            let key = &stated.key;
            let help = format!("say what a search should cover: {key} = {{ value = …, low = …, high = … }}");
            return Err(Fault { blame: Blame::Parameter(index), title, label: label.into(), help });
        }
        Ok(())
    }

    /// Whether the formula is in proportion to a parameter.
    fn is_linear(&self, parameter: usize) -> bool {
        let with = |value: f64| {
            let mut parameters = self.nominal();
            parameters[parameter] = value;
            parameters
        };
        let [none, one, two] = [0.0, 1.0, 2.0].map(with);
        self.places().into_iter().all(|place| {
            let [a, b, c] = [&none, &one, &two].map(|p| self.value(place, p));
            let size = a.abs() + b.abs() + c.abs();
            !size.is_finite() || (c - 2.0 * b + a).abs() <= 1e-9 * size
        })
    }

    /// Largest value with a strength of one over an oscillation of these amplitudes, the least and the largest of what
    /// the other parameters make of it; `None` where there is none.
    pub fn sizes(&self, strength: usize, zero: &[Zero], amplitudes: [f64; VARIABLES]) -> Option<(f64, f64)> {
        let nominal = self.nominal();
        let choices: Vec<Vec<f64>> = (0..nominal.len())
            .map(|i| match self.statement.parameters[i].range {
                _ if i == strength => vec![1.0],
                _ if zero.iter().any(|zero| zero.parameter == i) => vec![0.0],
                Some((low, high, _)) => vec![low, nominal[i], high],
                None => vec![nominal[i]],
            })
            .collect();
        let mut corners = vec![Vec::new()];
        for of in &choices {
            corners = corners.iter().flat_map(|c: &Vec<f64>| of.iter().map(|x| [&c[..], &[*x]].concat())).collect();
        }
        let largest = |parameters: &Vec<f64>| {
            let at = |j: usize| {
                let (sine, cosine) = (TAU * j as f64 / PHASES as f64).sin_cos();
                let place = match self.statement.acts_on {
                    ActsOn::Friction => [amplitudes[0] * (1.0 + cosine), 0.0],
                    _ => [amplitudes[0] * sine, amplitudes[1] * cosine],
                };
                self.value(place, parameters).abs()
            };
            (0..PHASES).map(at).fold(0.0, f64::max)
        };
        let all = corners.iter().map(largest).filter(|size| *size > 0.0 && size.is_finite());
        all.fold(None, |range: Option<(f64, f64)>, size| {
            Some(range.map_or((size, size), |(low, high)| (low.min(size), high.max(size))))
        })
    }
}
