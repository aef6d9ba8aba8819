//! Small plots in characters: a curve over its readings, and the fall of the error.

use crate::compare::Comparison;
use crate::figures::axes::range;
use crate::figures::comparison::overlay::Data;
use crate::figures::comparison::words::{condition, worst};
use crate::figures::style::significant;
use crate::terminal;
use clap::Args;

/// Characters of a plot across and lines down; with its margin a line stays below 100.
const WIDTH: usize = 64;
const HEIGHT: usize = 14;
/// Characters of the longest bar.
const BAR: f64 = 40.0;

/// Whether plots are drawn.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct Plot {
    /// Draw the curve and the fall of the error in characters; always done on a terminal
    #[arg(long)]
    plot: bool,
}

impl Plot {
    /// Whether they are.
    pub fn wanted(self) -> bool {
        self.plot || terminal::shows_results()
    }
}

/// The condition with the largest misfit: its readings and the curve of each model, told by its character.
pub fn curves(models: &[(char, &str, &Comparison)]) -> Vec<String> {
    let Some((_, _, first)) = models.first() else { return Vec::new() };
    let Some(&at) = worst(first, 1).first() else { return Vec::new() };
    let data: Vec<(char, Data<'_>)> = models.iter().map(|(sign, _, c)| (*sign, Data::of(c, false))).collect();
    let mut series: Vec<(char, Vec<(f64, f64)>)> = data.iter().map(|(sign, data)| (*sign, data.curve(at))).collect();
    let readings = data[0].1.measured(at);
    series.push(('o', readings.iter().map(|(f, y, _)| (*f, *y)).collect()));
    let keys: Vec<String> = models.iter().map(|(sign, name, _)| format!("{sign} {name}")).collect();
    let mut lines = vec![format!("{}: o measured, {}", condition(first, at), keys.join(", "))];
    lines.extend(chart(&series, &data[0].1.label()));
    lines
}

/// Series in a frame, later ones over earlier ones.
fn chart(series: &[(char, Vec<(f64, f64)>)], label: &str) -> Vec<String> {
    let points = || series.iter().flat_map(|(_, points)| points).filter(|(x, y)| x.is_finite() && y.is_finite());
    let (left, right) = range(points().map(|p| p.0));
    let (low, high) = range(points().map(|p| p.1));
    if !(left.is_finite() && low.is_finite()) {
        return Vec::new();
    }
    let low = if low >= 0.0 { 0.0 } else { low };
    let share = |value: f64, from: f64, to: f64| if to > from { (value - from) / (to - from) } else { 0.5 };
    let mut grid = vec![vec![' '; WIDTH]; HEIGHT];
    for (sign, points) in series {
        for &(x, y) in points.iter().filter(|(x, y)| x.is_finite() && y.is_finite()) {
            let column = (share(x, left, right) * (WIDTH - 1) as f64).round() as usize;
            let row = (share(y, low, high) * (HEIGHT - 1) as f64).round() as usize;
            grid[HEIGHT - 1 - row.min(HEIGHT - 1)][column.min(WIDTH - 1)] = *sign;
        }
    }
    let mut lines = vec![format!("  {label}")];
    for (row, cells) in grid.iter().enumerate() {
        let tick = match row {
            0 => significant(high, 3),
            _ if row == HEIGHT - 1 => significant(low, 3),
            _ => String::new(),
        };
        lines.push(format!("{tick:>9} |{}", cells.iter().collect::<String>()).trim_end().to_string());
    }
    lines.push(format!("{:>9} +{}", "", "-".repeat(WIDTH)));
    let (from, to) = (significant(left, 4), format!("{} Hz", significant(right, 4)));
    lines.push(format!("{:>10} {from}{to:>width$}", "", width = WIDTH.saturating_sub(from.chars().count())));
    lines
}

/// A bar for each step, by the logarithm of its error: noise alone has one character.
pub fn fall(steps: &[(String, f64)]) -> Vec<String> {
    let most = steps.iter().map(|(_, chi2)| *chi2).filter(|chi2| chi2.is_finite()).fold(1.0, f64::max);
    let length =
        |chi2: f64| 1.0 + (BAR - 1.0) * (chi2.max(1.0).ln() / most.ln().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let line = |(name, chi2): &(String, f64)| {
        let bar = if chi2.is_finite() { length(*chi2).round() as usize } else { 0 };
        let name: String = name.chars().take(36).collect();
        format!("  {name:<36} {} {}", "#".repeat(bar), significant(*chi2, 3))
    };
    let head = "chi2 per reading, the bars logarithmic from 1, which is noise alone:".to_string();
    std::iter::once(head).chain(steps.iter().map(line)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_has_its_points_at_their_places_and_lines_below_a_hundred_characters() {
        let lines = chart(&[('*', vec![(1.0, 0.0), (2.0, 5.0)]), ('o', vec![(3.0, 10.0), (2.0, f64::NAN)])], "a [m]");
        assert_eq!(lines.len(), HEIGHT + 3);
        assert!(lines.iter().all(|line| line.chars().count() < 100), "{lines:#?}");
        assert!(lines[1].starts_with("       10 |") && lines[1].ends_with('o'), "{}", lines[1]);
        assert_eq!(lines[HEIGHT], "        0 |*");
        assert_eq!(lines.iter().flat_map(|line| line.chars()).filter(|c| *c == '*').count(), 2);
        assert!(chart(&[('o', vec![(f64::NAN, 1.0)])], "").is_empty());
    }

    #[test]
    fn bars_fall_with_the_error_and_noise_has_one_character() {
        let lines = fall(&[("base".into(), 100.0), ("+ a".into(), 10.0), ("+ b".into(), 1.0)]);
        let bars: Vec<usize> = lines[1..].iter().map(|line| line.matches('#').count()).collect();
        assert_eq!(bars, [40, 21, 1]);
    }
}
