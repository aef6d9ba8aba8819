//! The atlas of effects in the report: what the registry says of an effect, and its figure.

use super::anchor;
use super::format;
use super::scenario::{FigureInput, figure};
use super::view::{EffectParameterView, EffectView};
use crate::effects::{Effect, ParameterInfo};

/// The sub-section of one effect.
pub fn effect_view(effect: &dyn Effect, input: &FigureInput) -> EffectView {
    EffectView {
        name: effect.name().into(),
        anchor: anchor::effect(effect.name()),
        title: effect.title().into(),
        group: effect.group().name().into(),
        equation: effect.equation().into(),
        meaning: effect.meaning().into(),
        parameters: (0..effect.parameters().len()).map(|index| parameter(effect, index)).collect(),
        zero: zero(effect),
        source: effect.source().into(),
        figure: figure("atlas", input),
    }
}

fn parameter(effect: &dyn Effect, index: usize) -> EffectParameterView {
    let info = &effect.parameters()[index];
    EffectParameterView {
        key: info.key.into(),
        symbol: info.symbol.into(),
        meaning: info.meaning.into(),
        unit: info.unit.into(),
        range: range(info),
    }
}

fn range(info: &ParameterInfo) -> String {
    let text = |value: f64| format::setting(value, info.unit).text;
    let sign = if info.signed { "± " } else { "" };
    info.range.map_or(format::NONE.into(), |(low, high)| format!("{sign}{} to {}", text(low), text(high)))
}

fn zero(effect: &dyn Effect) -> String {
    let one = |zero: &crate::effects::Zero| {
        let info = &effect.parameters()[zero.parameter];
        let value = if zero.value.is_infinite() { "∞".into() } else { format::setting(zero.value, "1").text };
        let arrow = if zero.value.is_infinite() { "→" } else { "=" };
        format!("{} {arrow} {value}", info.symbol)
    };
    match effect.zero() {
        [] => "no value: it stands in place of a part of the base".into(),
        all => all.iter().map(one).collect::<Vec<_>>().join(" and "),
    }
}
