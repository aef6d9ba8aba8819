//! The answer as JSON, schema `stickslip.question/1`, and its table as CSV.

use super::{Answer, Deciding, Features, Otherwise, Setting};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Version of the format.
pub const SCHEMA: &str = "stickslip.question/1";

/// What `stickslip run` writes beside the figure of a question.
#[derive(Debug, Clone, Serialize)]
// Wide: a field is a key of the file, in the order in which it is written.
pub struct QuestionJson {
    schema: &'static str,
    scenario: String,
    title: String,
    provenance: String,
    /// Said in the file too: everything is simulated.
    nature: &'static str,
    resembles_m_s: f64,
    tolerance: f64,
    speed_m_s: f64,
    load_n: f64,
    drive_m: f64,
    described: Features,
    effects: Vec<EffectJson>,
    other_tolerances: Vec<Otherwise>,
    deciding: Option<Deciding>,
}

#[derive(Debug, Clone, Serialize)]
struct EffectJson {
    effect: String,
    rank: usize,
    can: bool,
    closest: SettingJson,
    least_strained: Option<SettingJson>,
}

#[derive(Debug, Clone, JsonSchema, Serialize)]
struct SettingJson {
    parameters: BTreeMap<&'static str, f64>,
    strain: f64,
    features: Features,
}

/// The view of an answer that scripts read.
pub fn json(answer: &Answer) -> QuestionJson {
    let effects = answer.hypotheses.iter().enumerate().map(|(index, h)| {
        let setting = |setting: &Setting| SettingJson {
            parameters: h.effect.parameters().iter().map(|info| info.key).zip(setting.values.iter().copied()).collect(),
            strain: setting.strain,
            features: setting.features.clone(),
        };
        EffectJson {
            effect: h.effect.name().into(),
            rank: index + 1,
            can: h.can(),
            closest: setting(&h.best),
            least_strained: h.mildest.as_ref().map(setting),
        }
    });
    QuestionJson {
        schema: SCHEMA,
        scenario: answer.scenario.id.clone(),
        title: answer.scenario.title.clone(),
        provenance: answer.scenario.provenance.clone(),
        nature: "hypotheses about a simulated curve; no measurement is involved",
        resembles_m_s: answer.question.resembles,
        tolerance: answer.question.tolerance,
        speed_m_s: answer.condition.speed,
        load_n: answer.condition.load,
        drive_m: answer.condition.drive,
        described: answer.described.clone(),
        effects: effects.collect(),
        other_tolerances: answer.otherwise.clone(),
        deciding: answer.deciding.clone(),
    }
}

/// The table of effects as CSV: two rows for those that can, one for the others.
pub fn table(answer: &Answer) -> String {
    let mut text = String::from(
        "rank,effect,can,setting,parameters,strain,rms,peak_hz,peak_rad,lower,shift_hz,first_end,last_end,not_steady\n",
    );
    for (index, h) in answer.hypotheses.iter().enumerate() {
        let settings = [("closest", Some(&h.best)), ("least strained", h.mildest.as_ref())];
        for (name, setting) in settings.into_iter().filter_map(|(name, setting)| Some((name, setting?))) {
            let values = h.effect.parameters().iter().zip(&setting.values);
            let values: Vec<String> = values.map(|(info, value)| format!("{}={value}", info.key)).collect();
            let f = &setting.features;
            let number = |value: Option<f64>| value.filter(|v| v.is_finite()).map_or(String::new(), |v| v.to_string());
            let peak = (number(f.peak.map(|p| p.frequency_hz)), number(f.peak.map(|p| p.amplitude)));
            let cells = [
                (index + 1).to_string(),
                h.effect.name().into(),
                h.can().to_string(),
                name.into(),
                values.join(" "),
                number(Some(setting.strain)),
                number(Some(f.rms)),
                peak.0,
                peak.1,
                number(Some(f.lower)),
                number(Some(f.shift_hz)),
                number(Some(f.ends[0])),
                number(Some(f.ends[1])),
                f.not_steady.to_string(),
            ];
            text += &cells.join(",");
            text.push('\n');
        }
    }
    text
}
