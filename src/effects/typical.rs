//! Parameters in the middle of what a search covers.

use super::{Effect, ParameterInfo, Scales};

/// Values in the middle of what a search covers on a rig of these scales (geometric mean); those held, at their scale.
pub fn middle(effect: &dyn Effect, scales: &Scales) -> Vec<f64> {
    let middle = |(index, (info, typical)): (usize, (&ParameterInfo, f64))| {
        if info.held {
            return info.measure.size(scales);
        }
        if effect.formula().is_none() && (info.alone.is_none() || scales.has_contact) {
            return typical * (info.measure.size(scales) / info.measure.size(&Scales::PAPER));
        }
        let (low, high) = effect.search_range(index, scales);
        low.max(1e-4 * high).sqrt() * high.sqrt()
    };
    effect.parameters().iter().zip(typical(effect)).enumerate().map(middle).collect()
}

/// Values in the middle of the search ranges on the paper's rig (geometric mean to one digit): valid, and no statement
/// about any material. Of a formula those with which it was tried.
pub fn typical(effect: &dyn Effect) -> Vec<f64> {
    if let Some(formula) = effect.formula() {
        return formula.nominal();
    }
    let middle = |info: &ParameterInfo| {
        let (low, high) = info.range.unwrap_or((info.minimum, info.maximum));
        let low = low.max(1e-4 * high);
        format!("{:.0e}", (low * high).sqrt()).parse().unwrap_or(high)
    };
    effect.parameters().iter().map(middle).collect()
}
