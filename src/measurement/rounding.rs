//! The steps in which readings are written: no reading is known better than what rounding leaves, its step over the
//! root of twelve.

use super::series::SEVERAL;
use super::sheet::Sheet;
use super::unit::Unit;

/// Steps in which the numbers of a column are written; none where these were set.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Steps {
    /// Greatest common divisor of all that are written without exponents: a scale may be read to halves.
    plain: f64,
    /// Decimals of the longest of those with exponents, of which all keep as many.
    digits: Option<i32>,
}

impl Steps {
    /// Of one column of a sheet.
    pub fn of(sheet: &Sheet, index: usize, commas: bool) -> Self {
        let cells: Vec<String> = sheet.rows().filter_map(|row| Some(plainly(row.cells.get(index)?, commas))).collect();
        let decimals = |cell: &str| cell.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
        let (plain, others): (Vec<&String>, Vec<&String>) = cells.iter().partition(|cell| !cell.contains(['e', 'E']));
        if is_set(&cells) {
            return Self::default();
        }
        let finest = plain.iter().map(|cell| decimals(cell)).max().unwrap_or(0);
        let step = 10f64.powi(-finest);
        let counts = plain.iter().filter_map(|cell| cell.parse::<f64>().ok()).map(|value| (value / step).round().abs());
        let plain = step * common(&counts.filter(|count| count.is_finite()).collect::<Vec<_>>());
        let digits = others.iter().map(|cell| cell.split(['e', 'E']).next().map_or(0, decimals)).max();
        Self { plain, digits }
    }

    /// Standard deviation that rounding leaves of a cell, in SI.
    pub fn deviation(&self, cell: &str, commas: bool, unit: &Unit) -> f64 {
        let cell = plainly(cell, commas);
        let Ok(value) = cell.parse::<f64>() else { return 0.0 };
        let step = match self.digits.filter(|_| cell.contains(['e', 'E'])) {
            Some(digits) => 10f64.powf(value.abs().log10().floor() - f64::from(digits)),
            None => self.plain,
        };
        let at = |value: f64| unit.convert(&format!("{value:e}")).unwrap_or(f64::NAN);
        let width = (at(value + 0.5 * step) - at(value - 0.5 * step)).abs();
        if width.is_finite() { width / 12f64.sqrt() } else { 0.0 }
    }
}

fn plainly(cell: &str, commas: bool) -> String {
    let cell = cell.replace('−', "-");
    if commas { cell.replace(',', ".") } else { cell }
}

/// Whether most cells share what is written in them with several others: it was set, as a response that is held, and not
/// read.
fn is_set(cells: &[String]) -> bool {
    let mut sorted: Vec<&String> = cells.iter().collect();
    sorted.sort();
    let shared = sorted.chunk_by(|a, b| a == b).map(<[&String]>::len).filter(|count| *count >= SEVERAL);
    2 * shared.sum::<usize>() >= cells.len()
}

/// The step of whole numbers of the finest: their greatest common divisor, or twice, five or ten times that and so on
/// where all but a tenth at most are whole numbers of it. A scale read to halves may for once have been read better.
fn common(counts: &[f64]) -> f64 {
    let all = counts.iter().copied().fold(0.0, divisor);
    if all == 0.0 {
        return 0.0;
    }
    let coarser = (0..).map(|power| 10f64.powi(power)).flat_map(|ten| [2.0, 5.0, 10.0].map(|times| all * times * ten));
    let is_most = |step: &f64| 10 * counts.iter().filter(|count| **count % step == 0.0).count() >= 9 * counts.len();
    let largest = counts.iter().copied().fold(0.0, f64::max);
    coarser.take_while(|step| *step <= largest).filter(is_most).last().unwrap_or(all)
}

/// Greatest common divisor of whole numbers.
fn divisor(a: f64, b: f64) -> f64 {
    if b > 0.0 { divisor(b, a % b) } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_that_is_held_was_set_and_not_read() {
        let cells = |of: &[&str]| of.iter().map(|cell| (*cell).into()).collect::<Vec<String>>();
        assert!(is_set(&cells(&["1", "2", "5", "1", "2", "5", "1", "2", "5"])));
        assert!(!is_set(&cells(&["1", "2", "4", "9", "9", "5", "3", "2", "1"])));
    }

    #[test]
    fn a_scale_that_is_read_to_halves_is_told_from_its_digits() {
        assert_eq!([1.5, 2.0, 7.5].map(|v: f64| (v / 0.1).round()).into_iter().fold(0.0, divisor), 5.0);
        assert_eq!([1.5, 2.2, 7.5].map(|v: f64| (v / 0.1).round()).into_iter().fold(0.0, divisor), 1.0);
        assert_eq!(divisor(0.0, 0.0), 0.0);
        // One of twelve was read better; of six it decides.
        let halves = [10.0, 15.0, 25.0, 30.0, 35.0, 45.0, 50.0, 65.0, 70.0, 75.0, 80.0];
        assert_eq!(common(&[&halves[..], &[17.0]].concat()), 5.0);
        assert_eq!(common(&[&halves[..5], &[17.0]].concat()), 1.0);
        assert_eq!(common(&[]), 0.0);
    }
}
