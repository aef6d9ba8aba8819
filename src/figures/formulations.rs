//! The published procedure against the series formulation, and the error of its step size.

use super::axes::{Axis, Panel, range};
use super::canvas::{Anchor, Canvas, Point, Stroke, Type, document};
use super::data::{self, Field, health};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::{MARKS, Mark};
use super::style::{Color, DASHES, GREY, INK, Table, WIDTH, cell, ramp, significant};
use super::{Drawing, Figure, FigureError};
use crate::scenario::Formulation;
use crate::sweep::{Curve, Outcome};

const HEIGHT: f64 = 660.0;

/// Name of the guide of a first-order procedure.
const SLOPE: &str = "slope −1";

/// The figure.
pub struct Formulations;

/// One condition: the series curve and the Euler curves of ascending steps.
struct Pair<'a> {
    label: String,
    /// Relative difference of the finest Euler curve from the series curve.
    difference: Vec<Point>,
    /// Steps per cycle and the largest relative difference from the series curve.
    to_series: Vec<Point>,
    /// Steps per cycle and the largest relative difference from the Richardson extrapolation of the two finest, for all
    /// others; empty below three step sizes.
    to_limit: Vec<Point>,
    /// Largest relative difference of that extrapolation from the series formulation.
    between: Option<f64>,
    series: &'a Curve,
    euler: Vec<&'a Curve>,
}

/// What is shown.
struct Data<'a> {
    pairs: Vec<Pair<'a>>,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        data::with_contact(outcome, "formulations")?;
        let all = data::curves(outcome);
        let groups = data::groups(&all, Field::Formulation);
        let fields: Vec<Field> =
            data::varying(&all, outcome).into_iter().filter(|field| *field != Field::Formulation).collect();
        let pairs: Vec<Pair<'_>> = groups.iter().filter_map(|group| Pair::of(group, &fields)).collect();
        if pairs.is_empty() {
            let need = "the same condition in both formulations (sweep.formulation = [\"series\", \"paper\"])";
            return Err(FigureError::missing("formulations", need));
        }
        Ok(Self { pairs })
    }

    fn color(&self, index: usize) -> Color {
        ramp(index, self.pairs.len())
    }

    fn finest(&self) -> usize {
        self.pairs.iter().filter_map(|pair| pair.euler.last()).map(|c| c.condition.euler_steps).max().unwrap_or(0)
    }

    fn largest(&self) -> f64 {
        range(self.pairs.iter().flat_map(|pair| pair.difference.iter().map(|point| point.1.abs()))).1
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let mut entries: Vec<Entry> = vec![(Key::Heading, "Condition".into())];
        let indexed: Vec<(usize, &Pair<'_>)> = self.pairs.iter().enumerate().collect();
        for (i, pair) in data::spread(&indexed, 14) {
            entries.push((Key::Line(Stroke::solid(self.color(i), 2.6)), pair.label.clone()));
        }
        let steps = self.pairs.iter().any(|pair| pair.to_series.len() > 1);
        let limits = self.pairs.iter().any(|pair| !pair.to_limit.is_empty());
        if steps {
            entries.push((Key::Heading, "Largest over f".into()));
            entries.push((Key::Mark(Mark::Circle, GREY, false), "from series".into()));
        }
        if limits {
            entries.push((Key::Mark(Mark::Square, GREY, true), "from Δt → 0".into()));
            entries.push((Key::Line(Stroke::dashed(INK, 1.6, DASHES[2])), SLOPE.into()));
        }
        let free = WIDTH - 92.0 - 40.0 - legend_width(&entries);
        let width = if steps { 0.5 * (free - 104.0) } else { free };
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            let left = self.left_panel(canvas, width);
            let right = if steps { self.right_panel(canvas, left.right() + 104.0, width) } else { left };
            legend(canvas, right.right() + 24.0, 30.0, &entries);
        })
    }

    fn left_panel(&self, canvas: &mut Canvas, width: f64) -> Panel {
        let points = || self.pairs.iter().flat_map(|pair| &pair.difference);
        let (low, high) = range(points().map(|point| point.0));
        let (lowest, highest) = range(points().map(|point| 100.0 * point.1).chain([0.0]));
        let pad = 0.08 * (highest - lowest);
        let y = Axis::linear("α paper / α series − 1 [%]", lowest - pad, highest + pad);
        let x = Axis::frequency("frequency f", low, high);
        let panel = Panel { left: 92.0, top: 44.0, width, height: 554.0, x, y };
        panel.frame(canvas, true, true);
        panel.heading(canvas, &format!("Euler, {} steps a cycle", self.finest()));
        panel.curve(canvas, &[(panel.x.low, 0.0), (panel.x.high, 0.0)], Stroke::solid(GREY, 1.2));
        for (i, pair) in self.pairs.iter().enumerate() {
            let points: Vec<Point> = pair.difference.iter().map(|&(f, d)| (f, 100.0 * d)).collect();
            canvas.series(&pair.label, |canvas| {
                panel.curve(canvas, &points, Stroke::solid(self.color(i), 2.2));
                if points.len() < 3 {
                    panel.marks(canvas, &points, Mark::Circle, 5.0, self.color(i), true);
                }
            });
        }
        panel
    }

    fn right_panel(&self, canvas: &mut Canvas, left: f64, width: f64) -> Panel {
        let points = || self.pairs.iter().flat_map(|pair| pair.to_series.iter().chain(&pair.to_limit));
        let x = Axis::logarithmic("Euler steps per cycle [–]", points().map(|point| point.0), 0.08);
        let room = range(points().map(|point| 1.9 * point.1)).1;
        let errors = points().map(|point| point.1).chain([room]);
        let y = Axis::logarithmic("largest |relative difference| of α [–]", errors, 0.04);
        let panel = Panel { left, top: 44.0, width, height: 554.0, x, y };
        panel.frame(canvas, true, true);
        panel.heading(canvas, "Error of the step size");
        for (i, pair) in self.pairs.iter().enumerate() {
            let color = self.color(i);
            canvas.series(&pair.label, |canvas| {
                panel.curve(canvas, &pair.to_series, Stroke::dashed(color, 1.6, DASHES[1]));
                panel.marks(canvas, &pair.to_series, Mark::Circle, 4.6, color, false);
                panel.curve(canvas, &pair.to_limit, Stroke::solid(color, 2.0));
                panel.marks(canvas, &pair.to_limit, MARKS[1], 4.6, color, true);
            });
        }
        let worst = self.pairs.iter().filter_map(|pair| pair.to_limit.first()).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some(&(n, error)) = worst.filter(|point| point.1 > 0.0) {
            let end = panel.x.high / 1.3;
            let guide = [(n, 1.7 * error), (end, 1.7 * error * n / end)];
            canvas.series(SLOPE, |canvas| panel.curve(canvas, &guide, Stroke::dashed(INK, 1.6, DASHES[2])));
            let at = (panel.px((n * end).sqrt()) + 12.0, panel.py(1.7 * error * n / (n * end).sqrt()) - 10.0);
            if at.1 > panel.top + 20.0 {
                canvas.within(&panel, |canvas| canvas.text(at, "∝ 1/steps", Type::at(Anchor::Start)));
            }
        }
        panel
    }

    fn csv(&self) -> String {
        let header =
            ["panel", "condition", "frequency [Hz]", "steps per cycle [-]", "relative difference in amplitude [-]"];
        let mut table = Table::new(&header);
        for pair in &self.pairs {
            let steps = pair.euler.last().map_or(0, |curve| curve.condition.euler_steps);
            for (f, d) in &pair.difference {
                table.row(["paper against series".into(), pair.label.clone(), cell(*f), steps.to_string(), cell(*d)]);
            }
            for (name, points) in
                [("largest from series", &pair.to_series), ("largest from step to zero", &pair.to_limit)]
            {
                for (n, d) in points {
                    table.row([name.into(), pair.label.clone(), String::new(), cell(*n), cell(*d)]);
                }
            }
        }
        table.finish()
    }
}

impl<'a> Pair<'a> {
    fn of(group: &[&'a Curve], fields: &[Field]) -> Option<Self> {
        let series = *group.iter().find(|curve| curve.condition.formulation == Formulation::Series)?;
        let mut euler: Vec<&Curve> =
            group.iter().copied().filter(|c| c.condition.formulation == Formulation::Paper).collect();
        euler.sort_by_key(|curve| curve.condition.euler_steps);
        let finest = *euler.last()?;
        let exact = data::steady(series, |s| s.amplitude);
        let relative = |curve: &Curve, reference: &[Point]| -> Vec<Point> {
            let own = data::steady(curve, |s| s.amplitude);
            own.iter().zip(reference).map(|(a, b)| (a.0, a.1 / b.1 - 1.0)).collect()
        };
        let worst = |curve: &Curve, reference: &[Point]| -> Point {
            let errors = relative(curve, reference);
            (curve.condition.euler_steps as f64, range(errors.iter().map(|point| point.1.abs())).1.max(0.0))
        };
        let to_series = euler.iter().map(|curve| worst(curve, &exact)).collect();
        let limit = if euler.len() > 2 { richardson(euler[euler.len() - 2], finest) } else { Vec::new() };
        // The two finest lie on the slope by construction: the limit is made of them.
        let coarser = &euler[..euler.len().saturating_sub(2)];
        let to_limit = if limit.is_empty() { Vec::new() } else { coarser.iter().map(|c| worst(c, &limit)).collect() };
        let errors = limit.iter().zip(&exact).map(|(a, b)| (a.1 / b.1 - 1.0).abs());
        let between = (!limit.is_empty()).then(|| range(errors).1);
        let condition = &series.condition;
        let fields = if fields.is_empty() { &[Field::Speed] } else { fields };
        let label = data::describe(condition, fields);
        let difference = relative(finest, &exact);
        Some(Self { label, difference, to_series, to_limit, between, series, euler })
    }
}

/// First-order extrapolation to a vanishing step from the two finest step sizes.
fn richardson(coarse: &Curve, fine: &Curve) -> Vec<Point> {
    let (m, n) = (coarse.condition.euler_steps as f64, fine.condition.euler_steps as f64);
    let pairs = data::steady(coarse, |s| s.amplitude).into_iter().zip(data::steady(fine, |s| s.amplitude));
    if n > m { pairs.map(|(a, b)| (b.0, b.1 + (b.1 - a.1) * m / (n - m))).collect() } else { Vec::new() }
}

impl Figure for Formulations {
    fn name(&self) -> &'static str {
        "formulations"
    }

    fn title(&self) -> &'static str {
        "Published procedure against the series formulation"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Squares that fall parallel to the dotted line, and a small difference of the formulations themselves.",
            "A difference of the formulations themselves above the noise of the readings: they are then different models.",
            "Take the series formulation; use the published procedure only to reproduce its numbers, with at least the steps shown.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let largest = format!("{} %", significant(100.0 * data.largest(), 2));
        let mut notes = vec![(format!("Largest difference in amplitude, {} steps", data.finest()), largest.clone())];
        let mut caption = format!(
            "Left: amplitude of the published Euler procedure ({} steps a cycle) relative to the series formulation, against \
             frequency; they differ by at most {largest}.",
            data.finest()
        );
        let limits = || data.pairs.iter().flat_map(|pair| &pair.to_limit);
        if let Some((n, error)) = limits().min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1))) {
            let text = format!("{} % at {n} steps", significant(100.0 * error, 2));
            caption += &format!(
                " Right: largest difference over frequency against steps per cycle. The error of the step size (squares, \
                 {text}) should fall parallel to the dotted line of slope −1, as that of a first-order procedure does; it is taken from the extrapolation of \
                 the two finest step sizes to none, which therefore have no squares. The difference from the series formulation \
                 (circles) is that error and the difference of the formulations themselves together."
            );
            let between = range(data.pairs.iter().filter_map(|pair| pair.between)).1;
            let between = format!("{} %", significant(100.0 * between, 2));
            caption += &format!(" Extrapolated to no step size, the formulations differ by at most {between}.");
            notes.push(("Largest difference without step size".into(), between));
            notes.push(("Largest error of the coarsest step".into(), text));
        }
        let curves: Vec<&Curve> = data.pairs.iter().flat_map(|p| p.euler.iter().copied().chain([p.series])).collect();
        caption += &health(&curves);
        for pair in data.pairs.iter().filter(|_| data.pairs.len() > 1) {
            let worst = range(pair.difference.iter().map(|point| point.1.abs())).1;
            let name = &pair.label;
            notes.push((format!("Largest difference, {name}"), format!("{} %", significant(100.0 * worst, 2))));
        }
        let alt = "Left: relative difference in amplitude between two formulations against frequency. Right: the error of the Euler procedure against steps per cycle on logarithmic axes.".to_string();
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
