//! Share of the cycle that sticks over drive frequency and roller speed.

use super::axes::{Axis, Panel, range};
use super::canvas::{Anchor, Canvas, Point, Stroke, Type, document};
use super::data::{self, Field, health};
use super::scheme::limit_points;
use super::style::{Color, GREY, INK, SLIP, Table, Unit, WHITE, WIDTH, cell, text_width, viridis};
use super::{Drawing, Figure, FigureError};
use crate::solver::Status;
use crate::sweep::{Curve, LimitCurve, LimitingCase, Outcome};

const HEIGHT: f64 = 620.0;
const MISSING: Color = Color(0xd0, 0xd0, 0xd0);

/// Name of the line where the arm in full slip is as fast as the roller.
const BOUNDARY: &str = "V = bωα in full slip";

/// The figure.
pub struct RegimeMap;

/// What is shown: rows of ascending speed, in SI.
struct Data<'a> {
    rows: Vec<&'a Curve>,
    slip: Option<&'a LimitCurve>,
    span: (f64, f64),
    log: bool,
    left_out: usize,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        data::with_contact(outcome, "regime-map")?;
        let all = data::curves(outcome);
        let groups = data::groups(&all, Field::Speed);
        let positive = |group: &[&'a Curve]| -> Vec<&'a Curve> {
            let moving = group.iter().copied().filter(|c| c.condition.speed > 0.0 && c.frequency.len() > 1);
            moving.collect()
        };
        let mut rows =
            groups.iter().map(|group| positive(group)).find(|rows| rows.len() > 1).ok_or_else(|| {
                FigureError::missing("regime-map", "at least two positive speeds and two frequencies")
            })?;
        rows.sort_by(|a, b| a.condition.speed.total_cmp(&b.condition.speed));
        let span = range(rows.iter().flat_map(|curve| curve.frequency.iter().copied()));
        let speeds: Vec<f64> = rows.iter().map(|curve| curve.condition.speed).collect();
        let log =
            speeds[speeds.len() - 1] > 12.0 * speeds[0] && unevenness(&speeds, f64::ln) <= unevenness(&speeds, |v| v);
        let slip = data::limit(outcome, LimitingCase::FreeOrFullSlip, rows[0].condition.drive);
        let left_out = all.len() - rows.len();
        Ok(Self { rows, slip, span, log, left_out })
    }

    fn boundary(&self) -> Vec<Point> {
        self.slip.map_or_else(Vec::new, |slip| limit_points(slip, &slip.speed_amplitude, self.span, 1e-3))
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let speeds: Vec<f64> = self.rows.iter().map(|curve| Unit::speed().of(curve.condition.speed)).collect();
        let edges = edges(&speeds, self.log);
        let (low, high) = (edges[0], edges[edges.len() - 1]);
        let y = Axis { log: self.log, ..Axis::linear("roller speed V [mm/s]", low, high) };
        let x = Axis::frequency("frequency f", self.span.0, self.span.1);
        let panel = Panel { left: 92.0, top: 24.0, width: WIDTH - 92.0 - 132.0, height: 536.0, x, y };
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            canvas.areas(&panel, |canvas| self.cells(&panel, canvas, &edges));
            canvas.series(BOUNDARY, |canvas| {
                panel.curve(canvas, &self.boundary(), Stroke::solid(WHITE, 5.0));
                panel.curve(canvas, &self.boundary(), Stroke::solid(SLIP, 2.6));
            });
            panel.border(canvas, 1.0);
            panel.labels(canvas, true, true);
            // Has its place in the whole view only.
            canvas.ticks(&panel, (false, false), |canvas| label_boundary(&panel, canvas, &self.boundary()));
            color_bar(canvas, &panel);
        })
    }

    /// One rectangle for each run of equal colour in a row; a slight overlap avoids seams.
    fn cells(&self, panel: &Panel, canvas: &mut Canvas, edges: &[f64]) {
        for (curve, speeds) in self.rows.iter().zip(edges.windows(2)) {
            let columns = self::edges(&curve.frequency, false);
            let (top, bottom) = (panel.py(speeds[1]), (panel.py(speeds[0]) + 1.2).min(panel.bottom()));
            let states = curve.states.iter().take(curve.frequency.len());
            let colors: Vec<Color> = states.map(|s| color(&s.status, s.stick_fraction)).collect();
            let mut start = 0;
            for run in colors.chunk_by(|a, b| a == b) {
                let left = panel.px(columns[start]).max(panel.left);
                let right = (panel.px(columns[start + run.len()]) + 1.2).min(panel.right());
                canvas.rectangle((left, top), right - left, bottom - top, run[0], None);
                start += run.len();
            }
        }
    }

    fn csv(&self) -> String {
        let mut table = Table::new(&["item", "frequency [Hz]", "speed [mm/s]", "stick fraction [-]", "status"]);
        for curve in &self.rows {
            let speed = cell(Unit::speed().of(curve.condition.speed));
            for (f, s) in curve.frequency.iter().zip(&curve.states) {
                let word = data::status_word(&s.status).to_string();
                table.row(["cell".into(), cell(*f), speed.clone(), cell(s.stick_fraction), word]);
            }
        }
        for (f, v) in self.boundary() {
            table.row(["boundary".into(), cell(f), cell(v), "0".into(), "closed form".into()]);
        }
        table.finish()
    }
}

/// Edges of cells around ascending values: midpoints, and the outer values mirrored.
fn edges(values: &[f64], log: bool) -> Vec<f64> {
    let to = |value: f64| if log { value.ln() } else { value };
    let back = |value: f64| if log { value.exp() } else { value };
    let at: Vec<f64> = values.iter().map(|value| to(*value)).collect();
    let last = at.len() - 1;
    let mut edges = vec![at[0] - 0.5 * (at[1] - at[0])];
    edges.extend(at.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])));
    edges.push(at[last] + 0.5 * (at[last] - at[last - 1]));
    edges.into_iter().map(back).collect()
}

/// Largest over smallest distance of neighbours on a scale.
fn unevenness(ascending: &[f64], scale: fn(f64) -> f64) -> f64 {
    let (least, most) = range(ascending.windows(2).map(|pair| scale(pair[1]) - scale(pair[0])));
    most / least
}

fn color(status: &Status, stick: f64) -> Color {
    if *status == Status::Steady && stick.is_finite() { viridis((stick * 50.0).round() / 50.0) } else { MISSING }
}

/// Names the boundary above it, at its top or else near a side: wherever there is room.
fn label_boundary(panel: &Panel, canvas: &mut Canvas, boundary: &[Point]) {
    let text = BOUNDARY;
    let half = 0.5 * text_width(text, 15.0, true) + 8.0;
    let line: Vec<Point> = boundary.iter().map(|&(f, v)| (panel.px(f), panel.py(v))).collect();
    let Some(top) = line.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { return };
    for x in [top.0, panel.right(), panel.left] {
        let x = x.clamp(panel.left + half + 10.0, panel.right() - half - 10.0);
        let below = line.iter().filter(|point| (point.0 - x).abs() <= half);
        let y = range(below.map(|point| point.1)).0 - 14.0;
        if y - 24.0 > panel.top && y < panel.bottom() {
            let corner = (x - half, y - 17.0);
            canvas.rectangle(corner, 2.0 * half, 23.0, WHITE, Some(Stroke::solid(GREY, 0.7)));
            canvas.text((x, y), text, Type::at(Anchor::Middle).colored(SLIP).bold());
            return;
        }
    }
}

fn color_bar(canvas: &mut Canvas, panel: &Panel) {
    let (left, width, steps) = (panel.right() + 30.0, 22.0, 50);
    let axis = Axis::linear("share of the cycle that sticks", 0.0, 1.0).step(0.2);
    let bar = Panel { left, width, x: Axis::linear("", 0.0, 1.0), y: axis, ..panel.clone() };
    canvas.color_bar(&bar, |canvas| {
        for i in (0..=steps).rev() {
            let share = f64::from(i) / f64::from(steps);
            let (low, high) = ((share - 0.01).max(0.0), (share + 0.01).min(1.0));
            canvas.rectangle(
                (left, bar.py(high)),
                width,
                (bar.py(low) - bar.py(high) + 1.2).min(bar.bottom() - bar.py(high)),
                viridis(share),
                None,
            );
        }
    });
    let outline =
        [(left, bar.top), (bar.right(), bar.top), (bar.right(), bar.bottom()), (left, bar.bottom()), (left, bar.top)];
    canvas.polyline(&outline, Stroke::solid(INK, 1.2));
    for (value, label) in bar.y.ticks(bar.height, 60.0) {
        canvas.line((bar.right(), bar.py(value)), (bar.right() + 6.0, bar.py(value)), Stroke::solid(INK, 1.2));
        canvas.text((bar.right() + 10.0, bar.py(value) + 5.4), &label, Type::at(Anchor::Start));
    }
    let middle = (bar.right() + 62.0, bar.top + 0.5 * bar.height);
    canvas.text(middle, &bar.y.label, Type { upwards: true, ..Type::at(Anchor::Middle) });
}

impl Figure for RegimeMap {
    fn name(&self) -> &'static str {
        "regime-map"
    }

    fn title(&self) -> &'static str {
        "Where the contact sticks"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Colour begins at the line and grows inwards.",
            "Stick outside the line, or grey points, without an effect in the scenario.",
            "Choose conditions to measure from both sides of the line, and V = 0, which is not on this map: there the contact sticks all the time.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let states = || data.rows.iter().flat_map(|curve| &curve.states).filter(|s| s.status == Status::Steady);
        let (total, slipping) = (states().count(), states().filter(|s| s.stick_fraction <= 0.0).count());
        let share = 100.0 * slipping as f64 / total.max(1) as f64;
        let largest = range(states().map(|s| s.stick_fraction)).1;
        let mut notes = vec![
            ("Points in full slip".into(), format!("{slipping} of {total} ({share:.0} %)")),
            ("Largest stick fraction".into(), format!("{largest:.3}")),
        ];
        let mut caption = format!(
            "Share of each cycle during which the contact sticks, for every computed pair of frequency and roller speed; \
             {slipping} of {total} points slip throughout. With Coulomb friction stick begins exactly at the line, where the arm's speed \
             amplitude in full slip (closed form) equals the roller's speed."
        );
        if let Some(slip) = data.slip {
            let top = format!("{} at {:.2} Hz", Unit::speed().show(slip.speed_peak, 4), slip.speed_peak_frequency);
            caption += &format!(" The line's top is at {top}.");
            notes.push(("Top of the boundary".into(), top));
        }
        if data.left_out > 0 {
            caption +=
                &format!(" One condition is shown; {} curves (other conditions or V = 0) are not.", data.left_out);
        }
        let sick = health(&data.rows);
        if !sick.is_empty() {
            caption += &sick
                .replace("open marks: lock-in averages", "grey")
                .replace("gaps); no line joins across them", "grey)");
        }
        let alt = "Colour map of the stick fraction over frequency and roller speed; a resonance-shaped line marks where the arm in full slip is as fast as the roller.".to_string();
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
