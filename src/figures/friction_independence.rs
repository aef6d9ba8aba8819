//! Curves for several coefficients of friction coincide (paper Figure 3).

use super::axes::{Axis, Panel, range};
use super::canvas::{Point, Stroke, document};
use super::data::{self, Field, health};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::Mark;
use super::style::{Table, Unit, WIDTH, cell, ramp, significant};
use super::{Drawing, Figure, FigureError};
use crate::sweep::{Curve, Outcome};

const HEIGHT: f64 = 780.0;
const FLOOR: f64 = 1e-16;

/// The figure.
pub struct FrictionIndependence;

/// What is shown, in SI: curves of ascending friction and their relative difference in alpha from the first.
struct Data<'a> {
    curves: Vec<&'a Curve>,
    differences: Vec<Vec<Point>>,
    phase_difference: f64,
    unit: Unit,
    left_out: usize,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        data::with_contact(outcome, "friction-independence")?;
        let all = data::curves(outcome);
        let groups = data::groups(&all, Field::Friction);
        let mut curves = groups.into_iter().find(|group| group.len() > 1).ok_or_else(|| {
            FigureError::missing("friction-independence", "at least two coefficients of friction (sweep.friction)")
        })?;
        curves.sort_by(|a, b| a.condition.friction.total_cmp(&b.condition.friction));
        let reference = data::steady(curves[0], |s| s.amplitude);
        let phases = data::steady(curves[0], |s| s.phase);
        let mut phase_difference = 0.0_f64;
        let mut differences = Vec::new();
        for curve in &curves[1..] {
            let own = data::steady(curve, |s| s.amplitude);
            let pairs = own.iter().zip(&reference);
            differences.push(pairs.map(|(a, b)| (a.0, (a.1 / b.1 - 1.0).abs())).collect::<Vec<Point>>());
            for (a, b) in data::steady(curve, |s| s.phase).iter().zip(&phases) {
                let turn = (a.1 - b.1).abs();
                phase_difference = phase_difference.max(turn.min((turn - std::f64::consts::TAU).abs()));
            }
        }
        let unit =
            Unit::of_signal(range(reference.iter().map(|point| point.1)).1, outcome.scenario.signals.reading.unit);
        let left_out = all.len() - curves.len();
        Ok(Self { curves, differences, phase_difference, unit, left_out })
    }

    fn largest(&self) -> f64 {
        range(self.differences.iter().flatten().map(|point| point.1)).1
    }

    /// Nested lines: the first is the widest, and each later one leaves the earlier visible on both sides.
    fn stroke(&self, index: usize) -> Stroke {
        let count = self.curves.len();
        let width = 2.0 + 14.0 * (count - 1 - index) as f64 / (count - 1).max(1) as f64;
        Stroke::solid(ramp(count - 1 - index, count), width)
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = vec![(Key::Heading, "Friction µ [–]".to_string())];
        for (i, curve) in self.curves.iter().enumerate() {
            entries.push((Key::Line(self.stroke(i)), significant(curve.condition.friction, 4)));
        }
        entries
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let entries = self.legend();
        let width = WIDTH - 92.0 - 50.0 - legend_width(&entries).max(178.0);
        let (low, high) = range(self.curves.iter().flat_map(|curve| curve.frequency.iter().copied()));
        let axis = || Axis::frequency("frequency f", low, high);
        let values = self.curves.iter().flat_map(|curve| curve.states.iter().map(|s| self.unit.of(s.amplitude)));
        let y = Axis::around(format!("amplitude α [{}]", self.unit.label), values);
        let upper = Panel { left: 92.0, top: 24.0, width, height: 270.0, x: axis(), y };
        let (lowest, highest) =
            range(self.curves.iter().flat_map(|curve| curve.states.iter().map(|s| s.phase.to_degrees())));
        let y = Axis::linear("phase φ [°]", lowest - 12.0, highest + 12.0).step(45.0);
        let middle = Panel { left: 92.0, top: 318.0, width, height: 220.0, x: axis(), y };
        let floored = self.differences.iter().flatten().map(|point| point.1.max(FLOOR));
        let y = Axis::logarithmic("rel. diff. of α [–]", floored, 0.12);
        let lower = Panel { left: 92.0, top: 562.0, width, height: 160.0, x: axis(), y };
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            upper.frame(canvas, false, true);
            middle.frame(canvas, false, true);
            lower.frame(canvas, true, true);
            for (i, curve) in self.curves.iter().enumerate() {
                let stroke = self.stroke(i);
                canvas.series(&significant(curve.condition.friction, 4), |canvas| {
                    upper.curve(canvas, &data::steady(curve, |s| self.unit.of(s.amplitude)), stroke);
                    middle.curve(canvas, &data::steady(curve, |s| s.phase.to_degrees()), stroke);
                    let excited = data::self_excited(curve, |s| self.unit.of(s.amplitude));
                    upper.marks(canvas, &excited, Mark::Circle, 4.0, stroke.color, false);
                });
            }
            for (i, points) in self.differences.iter().enumerate() {
                let points: Vec<Point> = points.iter().map(|&(f, d)| (f, d.max(FLOOR))).collect();
                let stroke = Stroke { width: 1.8, ..self.stroke(i + 1) };
                let name = significant(self.curves[i + 1].condition.friction, 4);
                canvas.series(&name, |canvas| lower.curve(canvas, &points, stroke));
            }
            legend(canvas, upper.right() + 30.0, 20.0, &entries);
            let base = significant(self.curves[0].condition.friction, 4);
            let largest = significant(self.largest(), 2);
            let text = [
                (Key::Heading, "Difference".into()),
                (Key::Heading, format!("from µ = {base}:")),
                (Key::Heading, format!("at most {largest}")),
            ];
            for (i, entry) in text.iter().enumerate() {
                legend(canvas, upper.right() + 30.0, lower.top + 24.0 * i as f64, std::slice::from_ref(entry));
            }
        })
    }

    fn csv(&self) -> String {
        let amplitude = format!("amplitude [{}]", self.unit.label);
        let header = [
            "friction [-]",
            "frequency [Hz]",
            &amplitude,
            "phase [deg]",
            "relative difference in amplitude [-]",
            "status",
        ];
        let mut table = Table::new(&header);
        for (i, curve) in self.curves.iter().enumerate() {
            for (k, (f, s)) in curve.frequency.iter().zip(&curve.states).enumerate() {
                let own = i.checked_sub(1).and_then(|i| self.differences.get(i));
                let difference = own.map_or(0.0, |points| points.get(k).map_or(f64::NAN, |point| point.1));
                let numbers =
                    [curve.condition.friction, *f, self.unit.of(s.amplitude), s.phase.to_degrees(), difference];
                table.row(numbers.map(cell).into_iter().chain([data::status_word(&s.status).to_string()]));
            }
        }
        table.finish()
    }
}

impl Figure for FrictionIndependence {
    fn name(&self) -> &'static str {
        "friction-independence"
    }

    fn title(&self) -> &'static str {
        "The coefficient of friction does not matter"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "One line with several rims, and a strip at the level of rounding.",
            "A strip above 10⁻⁶: friction moves the curve, through an effect that depends on the force or because points are not steady.",
            "Free µ in a fit only where this strip rises above the noise of the readings; else they cannot determine it.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let (largest, count) = (significant(data.largest(), 2), data.curves.len());
        let turn = Unit::new(1.0, "rad").show(data.phase_difference, 2);
        let drive = Field::Drive(outcome.scenario.signals.drive);
        let condition = data::describe(&data.curves[0].condition, &[Field::Speed, Field::Load, drive]);
        let mut caption = format!(
            "Amplitude and phase for {count} coefficients of friction ({condition}), drawn as nested lines: each leaves the \
             wider ones below it visible, so one line with several rims means that all coincide. The largest relative \
             difference in amplitude is {largest}, the largest difference in phase {turn}. The strip below shows the \
             former at every frequency (below 10⁻¹⁶ drawn at that value)."
        );
        if data.left_out > 0 {
            caption += &format!(" {} curves of other conditions are not shown.", data.left_out);
        }
        caption += &health(&data.curves);
        let notes = vec![
            ("Coefficients of friction".to_string(), count.to_string()),
            ("Largest relative difference in amplitude".into(), largest),
            ("Largest difference in phase".into(), turn),
        ];
        let alt = format!(
            "Amplitude and phase against frequency for {count} coefficients of friction as nested lines; a strip below shows the relative differences on a logarithmic axis."
        );
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
