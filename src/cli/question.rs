//! The question of a scenario: its answer beside the figures of the sweep.

use super::folder::Folder;
use super::simulate;
use crate::error::{Error, Result};
use crate::figures;
use crate::question::{self, Answer};
use crate::report::FigureInput;
use crate::scenario::Scenario;

/// Answers the question of a scenario, where it asks one, and writes figure, table and JSON below `out`.
pub(super) fn answer(scenario: &Scenario, out: &Folder) -> Result<Option<(Answer, Vec<FigureInput>)>> {
    if scenario.question.is_none() {
        return Ok(None);
    }
    let Some(answer) = question::answer(scenario) else {
        return Err(Error::Input(format!(
            "error: {}: the question has no answer: in full slip, or as asked for, the curve has no peak within the frequencies of [sweep]\n  \
             = help: extend the frequencies to both sides of the resonance",
            scenario.path.display()
        )));
    };
    let drawing = figures::question::draw(&answer).map_err(|why| Error::Unfinished(why.to_string()))?;
    let mut figure = simulate::write(drawing, &scenario.id, out)?;
    let json =
        serde_json::to_string_pretty(&question::json(&answer)).map_err(|why| Error::Unfinished(why.to_string()))?;
    for (kind, text) in [("csv", question::table(&answer)), ("json", json + "\n")] {
        let name = format!("{}/{}-effects.{kind}", scenario.id, figures::question::NAME);
        out.write(&name, text.as_bytes())?;
        figure.files.push(name);
    }
    Ok(Some((answer, vec![figure])))
}
