//! The first picture of a table: readings and model before and after, where it fails most, and the fall of the error.
//!
//! The CSV holds the model at every strength and for every part of what was found; the page draws these in place of the
//! fit.

use crate::compare::Compared;
use crate::discover::{Discovery, Fall, STRENGTHS, State, Step};
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Canvas, Point, Stroke, document};
use crate::figures::comparison::grid::{Rows, heading};
use crate::figures::comparison::multiples::frequencies;
use crate::figures::comparison::overlay::{BAR, Data, MEASURED};
use crate::figures::comparison::stack::{Part, Stack};
use crate::figures::comparison::words;
use crate::figures::legend::{Entry, Key};
use crate::figures::marks::Mark;
use crate::figures::style::{DASH_SLIP, DASHES, INK, LEFT, RIGHT, SLIP, STATIC, Table, WIDTH, cell, significant};
use crate::figures::{Drawing, Figure, FigureError};

/// Panels of curves; beside them is the fall of the error.
const PANELS: usize = 3;
/// Between two of them, and between them and the fall with its own axis \[px\].
const GAP: f64 = 22.0;
const APART: f64 = 92.0;
/// Above a panel two lines, its height, below it an axis \[px\].
const HEADING: f64 = 50.0;
const HEIGHT: f64 = 236.0;
const FOOT: f64 = 58.0;
/// Names of what is drawn; the page moves the curve, the fall and the place that the second to fourth name.
const BEFORE: &str = "calibrated model";
const AFTER: &str = "with what was found";
const FALL: &str = "error on the way";
const HERE: &str = "error at this strength";
const NOISE: &str = "noise alone";
/// Heading of the fall.
const FALLS: &str = "The error falls";

/// The figure.
pub struct BeforeAfter;

struct Shown<'a> {
    base: &'a Step,
    /// Of the base and, where something was found, of the explanation.
    data: Vec<Data<'a>>,
    phase: bool,
    conditions: Vec<usize>,
    fall: Option<&'a Fall>,
}

fn residual(p: &Compared, phase: bool) -> Option<f64> {
    if phase { p.phase_residual } else { Some(p.amplitude_residual) }
}

impl<'a> Shown<'a> {
    fn of(d: &'a Discovery) -> Self {
        let base = &d.steps[0];
        let square =
            |phase| -> f64 { base.comparison.points.iter().filter_map(|p| residual(p, phase)).map(|r| r * r).sum() };
        // Amplitudes, unless the base is chiefly wrong in phase.
        let phase = square(true) > 2.0 * square(false);
        let steps: &[&Step] = if d.steps.len() > 1 { &[base, d.explanation()] } else { &[base] };
        let mut data: Vec<Data> = steps.iter().map(|step| Data::of(&step.comparison, phase)).collect();
        let wraps = data.iter().any(|d| d.wraps);
        data.iter_mut().for_each(|d| d.wraps = wraps);
        let fall = d.fall();
        let panels = if fall.is_some() { PANELS } else { PANELS + 1 };
        Self { base, data, phase, conditions: words::worst(&base.comparison, panels), fall }
    }

    /// Axes of the panels.
    fn axes(&self) -> (Axis, Axis) {
        let points = self.base.comparison.points.iter().filter(|p| self.conditions.contains(&p.condition));
        let x = frequencies("frequency f", points.map(|p| p.point.frequency));
        let curves = self.data.iter().flat_map(|d| self.conditions.iter().flat_map(|&i| d.curve(i))).map(|p| p.1);
        (x, Axis { label: self.data[0].label(), ..self.data[0].axis(&self.conditions, curves) })
    }

    /// The panels, and the one of the fall.
    fn panels(&self, top: f64) -> (Vec<Panel>, Option<Panel>) {
        let all = self.conditions.len() + usize::from(self.fall.is_some());
        let gaps =
            GAP * (self.conditions.len().saturating_sub(1)) as f64 + if self.fall.is_some() { APART } else { 0.0 };
        let width = (WIDTH - LEFT - RIGHT - gaps) / all as f64;
        let (x, y) = self.axes();
        let left = |k: usize| LEFT + (width + GAP) * k as f64;
        let main = |k: usize| Panel { left: left(k), top, width, height: HEIGHT, x: x.clone(), y: y.clone() };
        let whole = self.fall.map(|fall| {
            let (x, y) = axes_of(fall);
            Panel { left: WIDTH - RIGHT - width, top, width, height: HEIGHT, x, y }
        });
        ((0..self.conditions.len()).map(main).collect(), whole)
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let rows = Rows::of(self.legend());
        let top = rows.height() + HEADING;
        let (panels, whole) = self.panels(top);
        document((WIDTH, top + HEIGHT + FOOT), (title, alt), |canvas| {
            rows.draw(canvas);
            for (index, (panel, &condition)) in panels.iter().zip(&self.conditions).enumerate() {
                canvas.register(panel);
                panel.named(true, index == 0).frame(canvas, true, index == 0);
                let lines = words::heading(&self.base.comparison, condition);
                heading(canvas, panel, (&lines.0, &lines.1));
                self.fill(canvas, panel, condition);
            }
            if let (Some(panel), Some(fall)) = (&whole, self.fall) {
                canvas.register(panel);
                panel.frame(canvas, true, true);
                panel.heading(canvas, FALLS);
                draw_fall(canvas, panel, fall);
            }
        })
    }

    /// The same panels one below the other.
    fn narrow(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let (x, y) = self.axes();
        let lines = self.conditions.iter().map(|&i| words::heading(&self.base.comparison, i)).collect();
        let mut parts = Stack::conditions(lines, (&x, &y));
        parts.extend(self.fall.map(|fall| {
            let (x, y) = axes_of(fall);
            Part { lines: (FALLS.into(), y.label.clone()), x, y, foot: true }
        }));
        let stack = Stack { legend: self.legend(), head: vec![y.label.clone()], parts };
        stack.draw((title, alt), |canvas, panel, index| match (self.conditions.get(index), self.fall) {
            (Some(&condition), _) => self.fill(canvas, panel, condition),
            (None, Some(fall)) => draw_fall(canvas, panel, fall),
            (None, None) => {}
        })
    }

    /// Curves and readings of a condition.
    fn fill(&self, canvas: &mut Canvas, panel: &Panel, condition: usize) {
        for (data, (name, stroke)) in self.data.iter().zip(strokes()) {
            let curve = data.curve(condition);
            canvas.series(name, |canvas| {
                data.runs(&curve).iter().for_each(|run| panel.curve(canvas, run, stroke));
            });
        }
        self.data[0].readings(canvas, panel, condition);
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = vec![(Key::Mark(Mark::Circle, INK, true), MEASURED.to_string())];
        entries
            .extend(strokes().into_iter().take(self.data.len()).map(|(name, stroke)| (Key::Line(stroke), name.into())));
        if self.fall.is_some() {
            entries.push((Key::Line(Stroke::dashed(INK, 1.4, DASH_SLIP)), NOISE.into()));
        }
        entries
    }

    /// One column per reading shown: where it is, what was measured, and the model for every part and strength.
    fn csv(&self) -> String {
        let c = &self.base.comparison;
        let shown = || {
            self.conditions.iter().enumerate().flat_map(move |(panel, &i)| {
                c.points.iter().enumerate().filter(move |(_, p)| p.condition == i).map(move |(at, p)| (panel, at, p))
            })
        };
        let shown: Vec<(usize, usize, &Compared)> =
            shown().filter(|(_, _, p)| residual(p, self.phase).is_some()).collect();
        let measured: Vec<(f64, f64, f64)> = self.conditions.iter().flat_map(|&i| self.data[0].measured(i)).collect();
        let per = frequencies("", [c.points.iter().map(|p| p.point.frequency).fold(0.0, f64::max)]).per;
        let value = self.data[0].label();
        let names = shown.iter().map(|(_, _, p)| format!("row {}", p.point.row));
        let head = ["what", "strength [%]", "chi2 per reading", "rms error [%]"].map(String::from);
        let header: Vec<String> = head.into_iter().chain(names).collect();
        let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
        let mut row = |what: String, numbers: [String; 3], cells: Vec<String>| {
            table.row([what].into_iter().chain(numbers).chain(cells));
        };
        let blank = || [const { String::new() }; 3];
        row("panel".into(), blank(), shown.iter().map(|(panel, ..)| (panel + 1).to_string()).collect());
        let heading = |(panel, ..): &(usize, usize, &Compared)| words::condition(c, self.conditions[*panel]);
        row("condition".into(), blank(), shown.iter().map(heading).collect());
        row("frequency".into(), blank(), measured.iter().map(|(f, ..)| cell(f / per)).collect());
        row(format!("measured {value}"), blank(), measured.iter().map(|(_, y, _)| cell(*y)).collect());
        row("sd".into(), blank(), measured.iter().map(|(.., bar)| digits(bar / BAR)).collect());
        let mut state = |what: String, strength: usize, state: &State| {
            let at = |(_, at, p): &(usize, usize, &Compared)| {
                digits(self.data[0].modelled(&state.predictions[*at], p.point.drive))
            };
            // In full, as in the JSON.
            let numbers = [state.chi2_per_point, state.rms_error_percent].map(|number| number.to_string());
            let [chi2, error] = numbers;
            let percent = (100 * strength / (STRENGTHS - 1)).to_string();
            row(what, [percent, chi2, error], shown.iter().map(at).collect());
        };
        let parts = self.fall.map_or(&[][..], |fall| &fall.parts);
        for part in parts {
            let names = self.fall.iter().flat_map(|fall| &fall.additions).zip(&part.members).filter(|(_, is)| **is);
            let name = names.map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(" + ");
            for (k, one) in part.states.iter().enumerate() {
                state(name.clone(), k, one);
            }
        }
        table.finish()
    }
}

/// Enough digits for a drawing.
fn digits(value: f64) -> String {
    if value.is_finite() { significant(value, 5) } else { String::new() }
}

/// The curves of the model.
fn strokes() -> [(&'static str, Stroke); 2] {
    [(BEFORE, Stroke::dashed(SLIP, 2.0, DASHES[1])), (AFTER, Stroke::solid(STATIC, 2.6))]
}

/// Axes of the fall.
fn axes_of(fall: &Fall) -> (Axis, Axis) {
    let chi2 = fall.parts.iter().flat_map(|part| &part.states).map(|state| state.chi2_per_point);
    let x = Axis::linear("strength [%]", -4.0, 104.0).at(&[0.0, 50.0, 100.0]);
    (x, Axis::logarithmic("χ² per reading", chi2.chain([1.0]), 0.05))
}

fn draw_fall(canvas: &mut Canvas, panel: &Panel, fall: &Fall) {
    let noise = Stroke::dashed(INK, 1.4, DASH_SLIP);
    canvas.series(NOISE, |canvas| {
        canvas.within(panel, |canvas| canvas.line((panel.left, panel.py(1.0)), (panel.right(), panel.py(1.0)), noise));
    });
    let Some(whole) = fall.parts.last() else { return };
    let percent = |k: usize| 100.0 * k as f64 / (STRENGTHS - 1) as f64;
    let line: Vec<Point> = whole.states.iter().enumerate().map(|(k, s)| (percent(k), s.chi2_per_point)).collect();
    canvas.series(FALL, |canvas| panel.curve(canvas, &line, Stroke::solid(STATIC, 2.0)));
    let last = &line[line.len() - 1..];
    canvas.series(HERE, |canvas| panel.marks(canvas, last, Mark::Circle, 6.0, STATIC, true));
}

impl Figure<Discovery> for BeforeAfter {
    fn name(&self) -> &'static str {
        "before-after"
    }

    fn title(&self) -> &'static str {
        "Readings and model, before and after"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "The curve with what was found runs through the bars in every panel, and the error ends at the dashed line: nothing but noise is left.",
            "It misses the bars somewhere, or the error ends above the line: what was found helps, and something is missing still.",
            "Move the strength to see which part of the curve an effect bends; then read where it fails and how sure it is.",
        ]
    }

    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError> {
        let shown = Shown::of(discovery);
        let (first, last) = (&discovery.steps[0].comparison.overall, &discovery.explanation().comparison.overall);
        let chi2 = [first, last].map(|metrics| significant(metrics.chi2_per_point, 3));
        let what = if shown.phase { "phase" } else { "amplitude" };
        let conditions = self.conditions(&shown);
        let (caption, alt) = match shown.fall {
            Some(_) => (
                format!(
                    "Measured {what} with 95 % bars, the calibrated model, and the model with what was found, {conditions}. Last \
                     panel: χ² per reading as what was found grows from nothing to its fitted strength, {} to {}.",
                    chi2[0], chi2[1]
                ),
                format!(
                    "Measured {what} against frequency with two curves of the model, before and after what was found was added; \
                     beside them the error falls from {} to {} per reading, noise alone being 1.",
                    chi2[0], chi2[1]
                ),
            ),
            None => (
                format!(
                    "Measured {what} with 95 % bars and the calibrated model, {conditions}: χ² per reading {}.",
                    chi2[0]
                ),
                format!("Measured {what} against frequency with the curve of the calibrated model, {conditions}."),
            ),
        };
        let svg = shown.draw(self.title(), &alt)?;
        let narrow = Some(shown.narrow(self.title(), &alt)?);
        let notes = vec![("χ² per reading".to_string(), chi2.join(" → "))];
        Ok(Drawing { narrow, ..Drawing::of(self, (caption, alt), (svg, shown.csv()), notes) })
    }
}

impl BeforeAfter {
    fn conditions(&self, shown: &Shown<'_>) -> String {
        let all = shown.base.comparison.conditions.len();
        match shown.conditions.len() {
            some if some < all => format!("at the {some} of {all} conditions where the calibrated model misfits most"),
            _ => "at every condition".into(),
        }
    }
}
