//! Compliance alpha/u0 against frequency: curves of equal V/u0 fall on one another.

use super::axes::{Axis, Panel, range};
use super::canvas::{Point, Stroke, document};
use super::data::{self, Field, health};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::{MARKS, Mark};
use super::style::{Color, HEIGHT, Table, Unit, WIDTH, cell, ramp, significant};
use super::{Drawing, Figure, FigureError};
use crate::scenario::Signal;
use crate::sweep::{Curve, Outcome};

const FLOOR: f64 = 1e-16;

/// The figure.
pub struct Collapse;

/// Curves of one ratio V/u0.
struct Group<'a> {
    /// V/u0 [1/s].
    ratio: f64,
    curves: Vec<&'a Curve>,
    /// Largest minus smallest alpha/u0 over their mean, at every common frequency.
    spread: Vec<Point>,
}

/// What is shown, in SI.
struct Data<'a> {
    groups: Vec<Group<'a>>,
    drives: Vec<f64>,
    drive: Signal,
    unit: Unit,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        data::with_contact(outcome, "collapse")?;
        let all: Vec<&Curve> = data::curves(outcome).into_iter().filter(|c| c.condition.drive > 0.0).collect();
        let mut groups: Vec<Group<'_>> = Vec::new();
        for curve in &all {
            let ratio = curve.condition.speed / curve.condition.drive;
            match groups.iter_mut().find(|group| (group.ratio - ratio).abs() <= 1e-9 * ratio.abs()) {
                Some(group) => group.curves.push(curve),
                None => groups.push(Group { ratio, curves: vec![curve], spread: Vec::new() }),
            }
        }
        groups.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        for group in &mut groups {
            group.spread = spread(&group.curves);
        }
        let drives = Field::Drive(outcome.scenario.signals.drive).distinct(&all);
        if drives.len() < 2 || groups.iter().all(|group| group.curves.len() < 2) {
            let need = "several drives with speeds in proportion, so that curves share a ratio V/u₀";
            return Err(FigureError::missing("collapse", need));
        }
        let signals = outcome.scenario.signals;
        let largest = range(all.iter().flat_map(|c| c.states.iter().map(|s| s.amplitude / c.condition.drive))).1;
        Ok(Self {
            groups,
            drives,
            unit: Unit::of_ratio(largest, (signals.reading.unit, signals.drive.unit)),
            drive: signals.drive,
        })
    }

    fn color(&self, index: usize) -> Color {
        ramp(index, self.groups.len())
    }

    fn points(&self, curve: &Curve) -> Vec<Point> {
        data::steady(curve, |s| self.unit.of(s.amplitude / curve.condition.drive))
    }

    fn mark(&self, curve: &Curve) -> usize {
        self.drives.iter().position(|drive| *drive == curve.condition.drive).unwrap_or(0)
    }

    fn largest_spread(&self) -> f64 {
        range(self.groups.iter().flat_map(|group| group.spread.iter().map(|point| point.1))).1
    }

    /// Unit of a speed over a drive.
    fn per(&self) -> String {
        if self.drive.unit == "m" { "1/s".into() } else { Unit::of_ratio(1.0, ("m/s", self.drive.unit)).label }
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = vec![(Key::Heading, format!("Ratio V/u₀ [{}]", self.per()))];
        let ratios: Vec<(usize, f64)> = self.groups.iter().map(|group| group.ratio).enumerate().collect();
        for (i, ratio) in data::spread(&ratios, 14) {
            entries.push((Key::Line(Stroke::solid(self.color(i), 3.0)), significant(ratio, 4)));
        }
        entries.push((Key::Heading, "Drive u₀".into()));
        for (i, drive) in self.drives.iter().enumerate() {
            let key = Key::Mark(MARKS[i % MARKS.len()], super::style::GREY, i < MARKS.len());
            entries.push((key, data::drive(*drive, &self.drive, 4)));
        }
        entries.push((Key::Heading, "Largest spread".into()));
        entries.push((Key::Heading, significant(self.largest_spread(), 2)));
        entries
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let entries = self.legend();
        let width = WIDTH - 92.0 - 50.0 - legend_width(&entries);
        let curves = || self.groups.iter().flat_map(|group| &group.curves);
        let (low, high) = range(curves().flat_map(|curve| curve.frequency.iter().copied()));
        let axis = || Axis::frequency("frequency f", low, high);
        let values: Vec<f64> = curves().flat_map(|curve| self.points(curve)).map(|point| point.1).collect();
        let y = Axis::around(format!("compliance α/u₀ [{}]", self.unit.label), values);
        let upper = Panel { left: 92.0, top: 24.0, width, height: 430.0, x: axis(), y };
        let spreads = self.groups.iter().flat_map(|group| group.spread.iter().map(|point| point.1.max(FLOOR)));
        let y = Axis::logarithmic("spread [–]", spreads, 0.1);
        let lower = Panel { left: 92.0, top: 482.0, width, height: 200.0, x: axis(), y };
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            upper.frame(canvas, false, true);
            lower.frame(canvas, true, true);
            for (i, group) in self.groups.iter().enumerate() {
                canvas.series(&significant(group.ratio, 4), |canvas| {
                    for curve in &group.curves {
                        upper.curve(canvas, &self.points(curve), Stroke::solid(self.color(i), 1.6));
                    }
                    let floored: Vec<Point> = group.spread.iter().map(|&(f, s)| (f, s.max(FLOOR))).collect();
                    lower.curve(canvas, &floored, Stroke::solid(self.color(i), 1.8));
                });
            }
            // Marks of different drives are interleaved along the curve so that each stays visible.
            for (i, group) in self.groups.iter().enumerate() {
                for curve in &group.curves {
                    let (drive, points) = (self.mark(curve), self.points(curve));
                    let stride = (points.len() / 9).max(1);
                    let offset = drive * stride / self.drives.len() + i * 2;
                    let some: Vec<Point> = points.iter().copied().skip(offset % stride).step_by(stride).collect();
                    let (mark, color) = (MARKS[drive % MARKS.len()], self.color(i));
                    let excited = data::self_excited(curve, |s| self.unit.of(s.amplitude / curve.condition.drive));
                    canvas.series(&significant(group.ratio, 4), |canvas| {
                        upper.marks(canvas, &some, mark, 4.6, color, drive < MARKS.len());
                        upper.marks(canvas, &excited, Mark::Circle, 4.0, color, false);
                    });
                }
            }
            legend(canvas, upper.right() + 30.0, 20.0, &entries);
        })
    }

    fn csv(&self) -> String {
        let compliance = format!("alpha/u0 [{}]", self.unit.label);
        let scale = if self.drive.unit == "m" { Unit::new(1e-6, "µm") } else { Unit::new(1.0, self.drive.unit) };
        let mut table = Table::new(&[
            &format!("ratio V/u0 [{}]", self.per()),
            &format!("drive [{}]", scale.label),
            "speed [mm/s]",
            "frequency [Hz]",
            &compliance,
            "spread in group [-]",
            "status",
        ]);
        for group in &self.groups {
            for curve in &group.curves {
                let (drive, speed) = (curve.condition.drive, curve.condition.speed);
                for (f, state) in curve.frequency.iter().zip(&curve.states) {
                    let spread = group.spread.iter().find(|point| point.0 == *f).map_or(f64::NAN, |point| point.1);
                    let compliance = self.unit.of(state.amplitude / drive);
                    let drive = if self.drive.unit == "m" { drive * 1e6 } else { drive };
                    let numbers = [group.ratio, drive, speed * 1e3, *f, compliance, spread].map(cell);
                    table.row(numbers.into_iter().chain([data::status_word(&state.status).to_string()]));
                }
            }
        }
        table.finish()
    }
}

fn spread(curves: &[&Curve]) -> Vec<Point> {
    let [first, others @ ..] = curves else { return Vec::new() };
    if others.is_empty() {
        return Vec::new();
    }
    let at = |curve: &Curve| data::steady(curve, |s| s.amplitude / curve.condition.drive);
    let rest: Vec<Vec<Point>> = others.iter().map(|curve| at(curve)).collect();
    let mut points = Vec::new();
    for (f, value) in at(first) {
        let found = rest.iter().filter_map(|other| other.iter().find(|point| point.0 == f).map(|point| point.1));
        let (low, high) = range(found.chain([value]));
        points.push((f, if value.is_finite() { 2.0 * (high - low) / (high + low) } else { f64::NAN }));
    }
    points
}

impl Figure for Collapse {
    fn name(&self) -> &'static str {
        "collapse"
    }

    fn title(&self) -> &'static str {
        "Only the ratio of speed to drive matters"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Marks of one colour on each other, and a strip at the level of rounding.",
            "A strip that rises: something depends on speed or drive by itself, such as friction that depends on slip rate.",
            "Measure the same V/u₀ with two drives: if the curves part, Coulomb friction is not enough.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let count: usize = data.groups.iter().map(|group| group.curves.len()).sum();
        let largest = data.largest_spread();
        let caption = format!(
            "Amplitude over drive, α/u₀, for {count} curves with {} drives (marks) and {} ratios V/u₀ (colours). With Coulomb \
             friction the response depends on speed and drive only through their ratio: curves of one colour must fall on \
             one another. The strip below shows how far they are apart (largest minus smallest, over their mean; below 10⁻¹⁶ drawn at that value): at most {}.{}",
            data.drives.len(),
            data.groups.len(),
            significant(largest, 2),
            health(&data.groups.iter().flat_map(|group| group.curves.iter().copied()).collect::<Vec<_>>())
        );
        let notes = vec![("Largest relative spread at equal V/u₀".to_string(), significant(largest, 2))];
        let alt = "Graph of amplitude over drive against frequency: one colour for each ratio of speed to drive; a strip below shows the relative spread within each ratio.".to_string();
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
