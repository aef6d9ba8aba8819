//! Raw samples in time, which are no table of steady states: recognised to say so once.

use super::header::time_unit;
use super::sheet::{Complaints, Sheet};
use crate::scenario::diagnostic::quote;
use crate::units;

/// Rows that tell a recording from a table of a few times, at least.
const LEAST: usize = 8;

/// Says that the sheet holds samples in time, where it does: a column of evenly growing times.
pub(crate) fn refuse(sheet: &Sheet, complaints: &mut Complaints<'_>) -> bool {
    let columns = 0..sheet.header.cells.len();
    let times = columns.filter_map(|index| time_unit(&sheet.headed(index)).map(|unit| (index, unit)));
    let times: Vec<(usize, String)> = times.collect();
    let steps = steps(sheet, &times.iter().map(|(index, _)| *index).collect::<Vec<_>>());
    let found = times.into_iter().zip(steps).find_map(|((index, unit), step)| Some((index, unit, step?)));
    let Some((index, unit, step)) = found else { return false };
    let rate = units::parse(&format!("{:e} {unit}", step), "s").map(|step| {
        let rate: f64 = format!("{:.3e}", 1.0 / step).parse().unwrap_or(1.0 / step);
        format!(", {} apart ({} a second)", units::format(step, "s"), units::format(rate, "1"))
    });
    let others = sheet.header.cells.len() - 1;
    let title = format!(
        "the table holds samples in time, not steady states: {} of {}",
        units::count(sheet.count, "row"),
        units::count(others, "signal")
    );
    let header = quote(&sheet.header.cells[index]);
    let label = format!("{}times in {header}{}", sheet.cell_name(&sheet.header, index), rate.unwrap_or_default());
    let help = "one row per steady state is needed: the frequency of the drive, and the amplitude and phase at that frequency of \
                drive and reading (a fit of a sine over whole periods, transients left out), e.g. frequency_hz, force_n, \
                amplitude_m, phase_rad";
    complaints.add(&sheet.place(&sheet.header, index), &title, &label, help);
    true
}

/// The step of each of these columns of evenly growing numbers; none of others.
fn steps(sheet: &Sheet, columns: &[usize]) -> Vec<Option<f64>> {
    if sheet.count < LEAST {
        return vec![None; columns.len()];
    }
    let number = |cell: &String| cell.replace(',', ".").parse::<f64>().ok().filter(|value| value.is_finite());
    // First and last number of a column that never falls.
    let mut grown: Vec<Option<(f64, f64)>> = vec![Some((f64::NAN, f64::NEG_INFINITY)); columns.len()];
    for row in sheet.rows() {
        for (grown, index) in grown.iter_mut().zip(columns) {
            *grown = grown.zip(number(&row.cells[*index])).and_then(|((first, last), time)| {
                let first = if first.is_nan() { time } else { first };
                (time >= last).then_some((first, time))
            });
        }
    }
    let whole = |(first, last): (f64, f64)| ((last - first) / (sheet.count - 1) as f64, first);
    let mut steps: Vec<Option<(f64, f64)>> =
        grown.into_iter().map(|grown| grown.map(whole).filter(|(step, _)| *step > 0.0)).collect();
    for (at, row) in sheet.rows().enumerate() {
        for (step, index) in steps.iter_mut().zip(columns).filter(|(step, _)| step.is_some()) {
            // Times written with few digits are even on the whole.
            let even = |(step, first): &(f64, f64), time: f64| (time - first - step * at as f64).abs() <= *step;
            *step = step.zip(number(&row.cells[*index])).and_then(|(step, time)| even(&step, time).then_some(step));
        }
    }
    steps.into_iter().map(|step| step.map(|(step, _)| step)).collect()
}
