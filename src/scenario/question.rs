//! The table `[question]`: a curve of the model itself that effects are asked to imitate at the speed of the sweep.

use super::parameters::QUESTION;
use super::reader::{Reader, units};
use super::types::{Formulation, Question, Sweep};
use super::written::Entry;

/// Frequencies from which on a sweep has a peak to speak of.
const CURVE: usize = 9;

/// The table `[question]`; the outer option tells whether it is sound, the inner one whether it is there.
pub(crate) fn question(reader: &mut Reader<'_>, entries: &[Entry], sweep: Option<&Sweep>) -> Option<Option<Question>> {
    if !entries.iter().any(|entry| entry.key == "question") {
        return Some(None);
    }
    let table = reader.table(entries, "question")?;
    reader.keys(&table, &units(QUESTION), &[]);
    let mut number = |at: usize| table.get(QUESTION[at].key).and_then(|node| reader.quantity(node, &QUESTION[at]));
    let (resembles, tolerance) = (number(0), number(1));
    let (resembles, tolerance) = (resembles?, tolerance?);
    let whole = sweep.is_some_and(|s| {
        let single = [&s.speed, &s.load, &s.drive, &s.friction].iter().all(|axis| axis.len() == 1);
        single && s.formulation == [Formulation::Series] && s.frequency.len() >= CURVE && s.load[0] > 0.0
    });
    // A sweep with errors of its own has been told of already.
    if !whole && (sweep.is_some() || !entries.iter().any(|entry| entry.key == "sweep")) {
        let title = "[question] needs a [sweep] of one curve";
        let label = format!("asked of one speed, load, drive and friction at {CURVE} frequencies or more");
        let help = "give [sweep] one value each of speed, load above zero, and drive, a range of frequencies, and \
                    formulation = \"series\", on which the effects build";
        reader.fail(&table.place, title, &label, help);
        return None;
    }
    Some(Some(Question { resembles, tolerance }))
}
