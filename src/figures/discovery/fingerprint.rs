//! What the contact did before and after: measured stiffness and damping beside those of base and explanation.

use super::{color, dash, ladder_of};
use crate::compare::{ContactPoint, fingerprint};
use crate::discover::{Discovery, Step};
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Canvas, Point, Stroke, Type, document};
use crate::figures::comparison::contact::{self, Row};
use crate::figures::comparison::limits::Limits;
use crate::figures::comparison::multiples::frequencies;
use crate::figures::comparison::words;
use crate::figures::legend::{Entry, Key, legend};
use crate::figures::marks::Mark;
use crate::figures::style::{GAP, INK, LEFT, RIGHT, WIDTH, count, significant, text_width};
use crate::figures::{Drawing, Figure, FigureError};

/// Conditions at most.
const MOST: usize = 4;
const HEIGHT: f64 = 210.0;
const TOP: f64 = 92.0;
const BETWEEN: f64 = 18.0;

/// Names of what is drawn.
const MEASURED: &str = "measured, ± one standard deviation";
const EXPLANATION: &str = "explanation";

/// The figure.
pub struct Fingerprint;

struct Data<'a> {
    base: &'a Step,
    end: &'a Step,
    /// What one would take for the contact if the curves of the base were the readings: seen through the same rig and
    /// instrument as these.
    before: Vec<ContactPoint>,
    shown: Vec<usize>,
    rows: [Row; 2],
    limits: [Limits; 2],
}

/// Mean square distance of a model from the measured contact, in standard deviations, over some points.
fn distance(
    measured: &[ContactPoint],
    model: &[ContactPoint],
    row: &Row,
    wanted: impl Fn(&ContactPoint) -> bool,
) -> f64 {
    let pairs = measured.iter().zip(model).filter(|(p, _)| wanted(p));
    let square = pairs.map(|(p, q)| (((row.value)(p) - (row.value)(q)) / (row.sd)(p)).powi(2));
    let (sum, n) = square.filter(|s| s.is_finite()).fold((0.0, 0.0), |(sum, n), s| (sum + s, n + 1.0));
    if n > 0.0 { sum / n } else { 0.0 }
}

/// Those of the points that are at one of the conditions.
fn shown_of<'a>(points: &'a [ContactPoint], shown: &[usize]) -> Vec<&'a ContactPoint> {
    points.iter().filter(|p| shown.contains(&p.condition)).collect()
}

impl<'a> Data<'a> {
    fn of(steps: &'a [Step]) -> Self {
        let (base, end) = (&steps[0], &steps[steps.len() - 1]);
        let measured = &end.comparison.contact;
        let rows = Row::both(&end.comparison);
        let (_, before) = fingerprint(&end.comparison.model, &base.comparison.points);
        let telling = |i: &usize| {
            let of = |p: &ContactPoint| p.condition == *i;
            rows.iter().map(|row| distance(measured, &before, row, of)).sum::<f64>()
        };
        let mut shown: Vec<usize> = (0..end.comparison.conditions.len()).collect();
        shown.retain(|i| measured.iter().any(|p| p.condition == *i));
        shown.sort_by(|a, b| telling(b).total_cmp(&telling(a)).then(a.cmp(b)));
        shown.truncate(MOST);
        shown.sort_unstable();
        let limits = {
            let of = |points| shown_of(points, &shown);
            let (points, models) = (of(measured), [of(&before), of(&end.comparison.contact_model)].concat());
            [&rows[0], &rows[1]].map(|row| Limits::of(points.iter(), models.iter(), row, None))
        };
        Self { base, end, before, shown, rows, limits }
    }

    fn models(&self) -> [(&[ContactPoint], Stroke); 2] {
        let stroke = |index| Stroke::dashed(color(index, 2), 2.4, dash(index, 2));
        [(&self.before, stroke(0)), (&self.end.comparison.contact_model, stroke(1))]
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let n = self.shown.len() as f64;
        let width = (WIDTH - LEFT - RIGHT - GAP * (n - 1.0)) / n;
        let measured = &self.end.comparison.contact;
        let label = if n > 3.0 { "f" } else { "frequency f" };
        let points = measured.iter().filter(|p| self.shown.contains(&p.condition));
        let axis = frequencies(label, points.map(|p| p.frequency_hz));
        document((WIDTH, TOP + 2.0 * HEIGHT + BETWEEN + 62.0), (title, alt), |canvas| {
            self.legend(canvas);
            for (index, &condition) in self.shown.iter().enumerate() {
                let left = LEFT + (width + GAP) * index as f64;
                let (first, second) = words::heading(&self.end.comparison, condition);
                canvas.text((left, TOP - 26.0), &first, Type::default().bold());
                let small = Type { size: 14.0, ..Type::default() };
                canvas.text((left, TOP - 8.0), &second, small);
                for (lower, (row, limits)) in self.rows.iter().zip(&self.limits).enumerate() {
                    let y = Axis::linear(row.label.clone(), limits.low, limits.high);
                    let top = TOP + (HEIGHT + BETWEEN) * lower as f64;
                    let panel = Panel { left, top, width, height: HEIGHT, x: axis.clone(), y };
                    panel.frame(canvas, lower == 1, index == 0);
                    self.panel(canvas, &panel, condition, (row, limits));
                }
            }
        })
    }

    fn panel(&self, canvas: &mut Canvas, panel: &Panel, condition: usize, (row, limits): (&Row, &Limits)) {
        let place = |p: &ContactPoint| (p.frequency_hz, row.unit.of((row.value)(p)));
        let reading = |canvas: &mut Canvas, p: &ContactPoint| {
            let ((x, y), sd) = (place(p), row.unit.of((row.sd)(p)));
            let ink = if limits.vague(p, row) { INK.faded() } else { INK };
            panel.curve(canvas, &[(x, y - sd), (x, y + sd)], Stroke::solid(ink, 1.1));
            if (limits.low..=limits.high).contains(&y) {
                canvas.dot((panel.px(x), panel.py(y)), 2.4, ink);
            }
        };
        let readings = self.end.comparison.contact.iter().filter(|p| p.condition == condition);
        canvas.series(MEASURED, |canvas| {
            canvas.within(panel, |canvas| readings.for_each(|p| reading(canvas, p)));
        });
        for ((points, stroke), name) in self.models().into_iter().zip([&self.base.name(), EXPLANATION]) {
            let line: Vec<Point> = points.iter().filter(|p| p.condition == condition).map(place).collect();
            canvas.series(name, |canvas| panel.curve(canvas, &line, stroke));
        }
    }

    fn legend(&self, canvas: &mut Canvas) {
        let [(_, base), (_, end)] = self.models();
        let entries: [Entry; 3] = [
            (Key::Mark(Mark::Circle, INK, true), MEASURED.into()),
            (Key::Line(base), self.base.name()),
            (Key::Line(end), EXPLANATION.into()),
        ];
        let mut x = LEFT;
        for entry in &entries {
            legend(canvas, x, 2.0, std::slice::from_ref(entry));
            x += 44.0 + text_width(&entry.1, 15.0, false) + 28.0;
        }
    }

    fn csv(&self) -> String {
        let end = &self.end.comparison;
        let models = [("base", &*self.before), ("explanation", &end.contact_model)];
        contact::csv(end, &[("measured", &end.contact), models[0], models[1]])
    }

    fn notes(&self) -> Vec<(String, String)> {
        let measured = &self.end.comparison.contact;
        let root = |model: &[ContactPoint], row: &Row| significant(distance(measured, model, row, |_| true).sqrt(), 3);
        let [(before, _), (after, _)] = self.models();
        let note = |row: &Row| format!("{} σ before, {} σ after", root(before, row), root(after, row));
        let [k, c] = &self.rows;
        vec![("Distance in stiffness, rms".into(), note(k)), ("Distance in damping, rms".into(), note(c))]
    }
}

impl Figure<Discovery> for Fingerprint {
    fn name(&self) -> &'static str {
        "fingerprint-before-after"
    }

    fn title(&self) -> &'static str {
        "What the contact did, before and after"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "The solid line follows the measured points where the dashed one does not, in stiffness and in damping.",
            "A solid line that follows one of the two only, or runs between the points: the law has the wrong form.",
            "Where it fails, compare the measured shape with the fingerprints in the atlas, or with what `stickslip effects NAME` tells.",
        ]
    }

    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError> {
        let steps = ladder_of(self, discovery)?;
        let data = Data::of(steps);
        if data.shown.is_empty() {
            return Err(FigureError::missing(self.name(), "measured phases"));
        }
        let panels = count(data.shown.len(), "condition");
        let alt = format!(
            "Two rows of panels for {panels}, stiffness above and damping below against frequency: measured points with bars, a \
             dashed line for the base and a solid one for the explanation."
        );
        let alone = !discovery.explanation().comparison.model.has_contact;
        let title = if alone { "What the missing force did, before and after" } else { self.title() };
        let svg = data.draw(title, &alt)?;
        let rig = if discovery.explanation().hypothesis.recalibrated().is_empty() {
            ""
        } else {
            " Readings and both curves are seen through the recalibrated rig and instrument."
        };
        let added = discovery.explanation().hypothesis.label();
        let whose = if alone {
            "of the force that acts besides those of the linear rig, from the readings and that rig alone"
        } else {
            "that the contact must have had, from the readings and the rig alone"
        };
        let caption = format!(
            "Dynamic stiffness and damping {whose}, at the {panels} \
             where the base fails most; dashed, what one would find if the readings were the curves of the base; solid, that of the explanation, with {added}.{rig} \
             Faded: readings that say little; some may lie beyond the axes."
        );
        let drawing = Drawing::of(self, (caption, alt), (svg, data.csv()), data.notes());
        if alone {
            let mut reading = drawing.reading;
            reading[2] = "Where it fails, compare the measured shape with what `stickslip effects NAME` tells.".into();
            return Ok(Drawing { title: title.into(), reading, ..drawing });
        }
        Ok(drawing.told_of(&discovery.explanation().comparison.scenario))
    }
}
