//! Curves of an earlier run under those of this one.

use super::axes::{Axis, Panel, range};
use super::canvas::{Dash, Point, Stroke, document};
use super::legend::{Key, legend, legend_width};
use super::style::{Color, GREY, LEFT, STATIC, TOP, Table, Unit, WIDTH, cell, count, ramp, significant};
use super::{Drawing, FigureError};
use crate::scenario::Signal;

/// Most curves drawn.
const MOST: usize = 8;

/// A curve in both runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// What distinguishes it.
    pub name: String,
    /// Frequency \[Hz\] and amplitude before, in the unit of the reading.
    pub before: Vec<Point>,
    /// The same now.
    pub after: Vec<Point>,
}

impl Pair {
    /// Largest difference of the amplitude relative to the peak before; infinite where the frequencies differ.
    pub fn difference(&self) -> f64 {
        let peak = self.before.iter().map(|p| p.1.abs()).filter(|a| a.is_finite()).fold(0.0, f64::max);
        let same = self.before.len() == self.after.len()
            && self.before.iter().zip(&self.after).all(|(a, b)| a.0.to_bits() == b.0.to_bits());
        if !same {
            return f64::INFINITY;
        }
        let of = |(a, b): (&Point, &Point)| match (b.1 - a.1).abs() {
            d if d.is_nan() && a.1.is_nan() && b.1.is_nan() => 0.0,
            d if d.is_nan() => f64::INFINITY,
            0.0 => 0.0,
            d => d / peak,
        };
        self.before.iter().zip(&self.after).map(of).fold(0.0, f64::max)
    }
}

/// Draws those curves of a scenario that differ by more than `tolerance` of their peak, the most different first;
/// `reading` is what they are of.
///
/// # Errors
/// [`FigureError::MissingData`] where none does, [`FigureError::Render`] where an element cannot be drawn.
pub fn draw(pairs: &[Pair], id: &str, tolerance: f64, reading: &Signal) -> Result<Drawing, FigureError> {
    let mut differing: Vec<&Pair> = pairs.iter().filter(|pair| pair.difference() > tolerance).collect();
    if differing.is_empty() {
        return Err(FigureError::missing("baseline", "curves that differ"));
    }
    differing.sort_by(|a, b| b.difference().total_cmp(&a.difference()));
    let (all, worst) = (differing.len(), differing[0].difference());
    differing.truncate(MOST);
    // In the order of the run, which is that of the other figures.
    differing.sort_by_key(|pair| pairs.iter().position(|other| std::ptr::eq(other, *pair)));
    let title = format!("Before and now: {id}");
    let alt =
        format!("Amplitude against frequency of {}, before dashed and now solid.", count(differing.len(), "curve"));
    let more = if all > MOST { format!(" The {MOST} most different of {all} are drawn.") } else { String::new() };
    let largest = if worst.is_finite() {
        format!(" The largest difference is {} % of the peak.", significant(100.0 * worst, 3))
    } else {
        " At least one has other frequencies, or points without an answer in one of the runs.".into()
    };
    let (of, name) = match *reading {
        Signal::ANGLE => ("arm", "amplitude".into()),
        other => (other.name, format!("{} amplitude", other.name)),
    };
    let caption = format!(
        "Amplitude of the {of}, dashed as the earlier run had it and solid as it is now, for {} of {} that differ.{largest}{more}",
        count(differing.len(), "curve"),
        pairs.len()
    );
    let svg = curves(&differing, (&title, &alt), &format!("{name} {}", reading.symbol), reading.unit)?;
    let how_to_read = [
        "Solid lines on the dashed ones of the same colour: what was changed does not show.",
        "A solid line that leaves its dashed one where nothing was meant to change.",
        "See among the changed inputs whether that follows from one of them; if not, from the program.",
    ];
    Ok(Drawing::new(("baseline", &title), (caption, alt), (svg, csv(&differing, reading.unit)), how_to_read))
}

/// Both curves of every pair in one panel; `label` and `unit` are those of the amplitude.
fn curves(pairs: &[&Pair], words: (&str, &str), label: &str, unit: &str) -> Result<String, FigureError> {
    let points = || pairs.iter().flat_map(|p| p.before.iter().chain(&p.after));
    let unit = Unit::of_signal(points().map(|p| p.1).filter(|a| a.is_finite()).fold(0.0, f64::max), unit);
    let scaled = |points: &[Point]| points.iter().map(|&(f, a)| (f, unit.of(a))).collect::<Vec<_>>();
    let color = |index: usize| if pairs.len() == 1 { STATIC } else { ramp(index, pairs.len()) };
    let before = |color: Color| Stroke::dashed(color, 3.0, Dash::Dashes(7.0, 5.0));
    let now = |index: usize| Stroke::solid(color(index), 2.2);
    let named = pairs.iter().enumerate().map(|(i, p)| (Key::Line(now(i)), p.name.clone()));
    let entries: Vec<_> = std::iter::once((Key::Line(before(GREY)), "before".into())).chain(named).collect();
    let width = (WIDTH - LEFT - legend_width(&entries) - 50.0).max(420.0);
    document((LEFT + width + legend_width(&entries) + 50.0, TOP + 330.0 + 66.0), words, |canvas| {
        let (low, high) = range(points().map(|p| p.0));
        let x = Axis::frequency("drive frequency f", low, high);
        let y = Axis::around(format!("{label} [{}]", unit.label), points().map(|p| unit.of(p.1)));
        let panel = Panel { left: LEFT, top: TOP, width, height: 330.0, x, y };
        panel.frame(canvas, true, true);
        for (index, pair) in pairs.iter().enumerate() {
            canvas.series(&pair.name, |canvas| panel.curve(canvas, &scaled(&pair.after), now(index)));
        }
        canvas.series("before", |canvas| {
            for (index, pair) in pairs.iter().enumerate() {
                panel.curve(canvas, &scaled(&pair.before), before(color(index).mix(GREY, 0.35)));
            }
        });
        legend(canvas, LEFT + width + 24.0, TOP - 12.0, &entries);
    })
}

fn csv(pairs: &[&Pair], unit: &str) -> String {
    let mut table = Table::new(&["curve", "run", "frequency [Hz]", &format!("amplitude [{unit}]")]);
    for pair in pairs {
        for (run, points) in [("before", &pair.before), ("now", &pair.after)] {
            for (f, a) in points {
                table.row([pair.name.clone(), run.into(), cell(*f), cell(*a)]);
            }
        }
    }
    table.finish()
}
