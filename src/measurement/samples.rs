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
    let found = times.filter_map(|(index, unit)| step(sheet, index).map(|step| (index, unit, step))).next();
    let Some((index, unit, step)) = found else { return false };
    let rate = units::parse(&format!("{:e} {unit}", step), "s").map(|step| {
        let rate: f64 = format!("{:.3e}", 1.0 / step).parse().unwrap_or(1.0 / step);
        format!(", {} apart ({} a second)", units::format(step, "s"), units::format(rate, "1"))
    });
    let others = sheet.header.cells.len() - 1;
    let title = format!(
        "the table holds samples in time, not steady states: {} of {}",
        units::count(sheet.rows.len(), "row"),
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

/// The step of a column of evenly growing numbers.
fn step(sheet: &Sheet, index: usize) -> Option<f64> {
    if sheet.rows.len() < LEAST {
        return None;
    }
    let number = |cell: &String| cell.replace(',', ".").parse::<f64>().ok().filter(|value| value.is_finite());
    let times: Vec<f64> = sheet.rows.iter().map(|row| number(&row.cells[index])).collect::<Option<_>>()?;
    let whole = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    // Times written with few digits are even on the whole.
    let even = |(at, time): (usize, &f64)| (time - times[0] - whole * at as f64).abs() <= whole;
    let grows = times.windows(2).all(|pair| pair[1] >= pair[0]);
    (whole > 0.0 && grows && times.iter().enumerate().all(even)).then_some(whole)
}
