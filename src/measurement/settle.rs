//! Loads and speeds that are measured row by row, and the settings that they waver about.

use super::reading::Reading;
use super::series::{LEVEL, SEVERAL, SWEPT};
use crate::statistics::median;
use crate::units::readable::quantity;

/// Puts in place of loads and speeds that were measured row by row the settings that they waver about, and says so.
pub(super) fn settle(list: &mut [Reading], notes: &mut Vec<String>) {
    let frequencies: Vec<f64> = list.iter().map(|reading| reading.frequency).collect();
    for (what, unit, value) in
        [("loads", "N", (|r| &mut r.load) as fn(&mut Reading) -> &mut f64), ("speeds", "m/s", |r| &mut r.speed)]
    {
        let measured: Vec<f64> = list.iter_mut().map(|reading| *value(reading)).collect();
        let settings = wavering(&measured, &frequencies);
        let settled: Vec<f64> = settings.iter().map(|rows| median(rows.iter().map(|row| measured[*row]))).collect();
        for (rows, setting) in settings.iter().zip(&settled) {
            rows.iter().for_each(|row| *value(&mut list[*row]) = *setting);
        }
        // In the order of their size.
        let told = match settled[..] {
            [] => continue,
            [only] => format!("one setting, {}", quantity(only, unit, 3)),
            [low, .., high] => {
                let [low, high] = [low, high].map(|value| quantity(value, unit, 3));
                format!("{} settings, {low} to {high}", settled.len())
            }
        };
        notes.push(format!("the {what} waver from row to row: they are taken as {told}, the median of each"));
    }
}

/// Rows whose values waver about one setting each; nothing where values are set. Neighbouring values are one setting
/// where they differ by less than another level would, by less than they are from all others, and mostly from one row to
/// the next; not where every one of them stands at every frequency, as settings do that are gone through at each.
fn wavering(values: &[f64], frequencies: &[f64]) -> Vec<Vec<usize>> {
    let mut rows: Vec<usize> = (0..values.len()).collect();
    rows.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let is_near = |a: f64, b: f64| a == b || (a / b).ln().abs() < LEVEL;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for row in rows {
        match groups.last_mut() {
            Some(group) if is_near(values[row], values[group[0]]) => group.push(row),
            _ => groups.push(vec![row]),
        }
    }
    let ends: Vec<(f64, f64)> = groups.iter().map(|rows| (values[rows[0]], values[rows[rows.len() - 1]])).collect();
    let is_apart = |at: usize| {
        let width = ends[at].1 - ends[at].0;
        let before = at.checked_sub(1).is_none_or(|before| ends[at].0 - ends[before].1 > width);
        before && ends.get(at + 1).is_none_or(|after| after.0 - ends[at].1 > width)
    };
    if !(0..groups.len()).all(is_apart) {
        return Vec::new();
    }
    let wavers = |rows: &Vec<usize>| {
        let mut in_order = rows.clone();
        in_order.sort_unstable();
        let runs = in_order.chunk_by(|a, b| values[*a] == values[*b]).map(<[usize]>::len);
        let held = 2 * runs.filter(|run| *run >= SEVERAL).sum::<usize>() >= rows.len();
        !held && rows.len() >= SWEPT && !is_crossed(rows, values, frequencies)
    };
    let ends = ends.into_iter().map(|(low, high)| low < high);
    groups.into_iter().zip(ends).filter(|(rows, varies)| *varies && wavers(rows)).map(|(rows, _)| rows).collect()
}

/// Whether the values of some rows miss less than one of their frequencies each.
fn is_crossed(rows: &[usize], values: &[f64], frequencies: &[f64]) -> bool {
    let distinct = |of: &dyn Fn(usize) -> (f64, f64)| {
        let mut all: Vec<(f64, f64)> = rows.iter().map(|row| of(*row)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        all.dedup();
        all.len()
    };
    let levels = distinct(&|row| (values[row], 0.0));
    let pairs = distinct(&|row| (values[row], frequencies[row]));
    pairs + levels > levels * distinct(&|row| (frequencies[row], 0.0))
}
