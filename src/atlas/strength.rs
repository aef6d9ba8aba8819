//! Strengths at which an effect is shown, by one rule from what the registry says of its parameters.

use crate::effects::{Effect, ParameterInfo, typical};

/// Multiples of the distance between the zero of an effect and its typical strength.
const MULTIPLES: &[f64] = &[0.1, 0.3, 1.0, 3.0, 10.0];
/// The same where the sign matters.
const SIGNED: &[f64] = &[-3.0, -0.3, -0.03, 0.03, 0.3, 3.0];
/// The same where no value gives the base back: from the lowest value that is physical.
const FROM_LOWEST: &[f64] = &[0.0, 0.1, 0.3, 1.0, 3.0, 10.0];

/// Indices of the parameters that are varied: those that make the effect vanish, or all where none does.
pub fn varied(effect: &dyn Effect) -> Vec<usize> {
    if effect.zero().is_empty() {
        return (0..effect.parameters().len()).collect();
    }
    effect.zero().iter().map(|zero| zero.parameter).collect()
}

/// Parameters of an effect, weakest first and negative before positive; all but those varied are typical.
///
/// A varied parameter moves from its zero in the multiples above of the way to its typical value, no further than its
/// search range; where the effect vanishes at infinity, the parameter is divided by them.
pub fn strengths(effect: &dyn Effect) -> Vec<Vec<f64>> {
    let (typical, varied) = (typical(effect), varied(effect));
    let signed = varied.iter().any(|&index| effect.parameters()[index].signed);
    let multiples = match (effect.zero().is_empty(), signed) {
        (true, _) => FROM_LOWEST,
        (false, true) => SIGNED,
        (false, false) => MULTIPLES,
    };
    let mut all: Vec<Vec<f64>> = Vec::new();
    for &multiple in multiples {
        let mut parameters = typical.clone();
        for &index in &varied {
            let info = &effect.parameters()[index];
            let zero = effect.zero().iter().find(|zero| zero.parameter == index).map_or(info.minimum, |z| z.value);
            parameters[index] = scaled(info, zero, typical[index], multiple);
        }
        if !all.contains(&parameters) {
            all.push(parameters);
        }
    }
    all
}

/// The value at a multiple of the distance from `zero` to `typical`, rounded to two digits.
fn scaled(info: &ParameterInfo, zero: f64, typical: f64, multiple: f64) -> f64 {
    let (low, high) = info.range.unwrap_or((info.minimum, info.maximum));
    let value = if zero.is_infinite() {
        (typical / multiple).max(low)
    } else {
        (zero + multiple * (typical - zero)).clamp(-high, high)
    };
    format!("{value:.1e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::REGISTRY;

    #[test]
    fn every_effect_has_at_least_three_strengths_that_are_valid() {
        for effect in REGISTRY {
            let all = strengths(*effect);
            assert!(all.len() >= 3, "{}: {all:?}", effect.name());
            for (value, info) in all.iter().flat_map(|parameters| parameters.iter().zip(effect.parameters())) {
                assert!((info.minimum..=info.maximum).contains(value), "{} {} {value}", effect.name(), info.key);
            }
        }
    }

    #[test]
    fn both_signs_are_shown_where_there_are_two() {
        let signed = |effect: &&&dyn Effect| effect.parameters().iter().any(|info| info.signed);
        for effect in REGISTRY.iter().filter(signed) {
            let index = varied(*effect)[0];
            let values: Vec<f64> = strengths(*effect).iter().map(|parameters| parameters[index]).collect();
            assert_eq!(values.iter().filter(|v| **v < 0.0).count(), values.iter().filter(|v| **v > 0.0).count());
            assert!(values.is_sorted(), "{}: {values:?}", effect.name());
        }
    }
}
