//! Loops of contact force against displacement of the arm.

use super::axes::{Axis, Panel, range};
use super::canvas::{Anchor, Canvas, Point, Stroke, Type, document};
use super::legend::{Key, legend};
use super::orbits::{Cycle, ROUNDING, cycles, force_range, force_unit, left_out};
use super::style::{INK, SLIP, STATIC, Table, Unit, WIDTH, cell};
use super::{Drawing, Figure, FigureError};
use crate::sweep::Outcome;

/// Names of the two states.
const NAMES: [&str; 2] = ["interface sticks", "interface slips, F = µW"];

/// The figure.
pub struct Loops;

/// What is shown, with the units that suit all panels.
struct Data<'a> {
    cycles: Vec<Cycle<'a>>,
    left_out: usize,
    stroke: Unit,
    force: Unit,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        let (cycles, left_out) = cycles(outcome, "loops")?;
        let moves = cycles.iter().flat_map(|c| (0..c.len()).map(|i| c.displacement(i).abs()));
        let stroke = Unit::fitting(range(moves).1, "m");
        let force = force_unit(&cycles);
        Ok(Self { cycles, left_out, stroke, force })
    }

    fn points(&self, cycle: &Cycle<'_>) -> Vec<(Point, bool)> {
        let at = |i: usize| {
            let x = self.stroke.of(cycle.displacement(i));
            ((x, self.force.of(cycle.force(i))), cycle.sticks(i))
        };
        (0..cycle.len()).map(at).collect()
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let columns = self.cycles.len().min(3);
        let rows = self.cycles.len().div_ceil(columns);
        let (left, gap, top, cell_height) = (96.0, 76.0, 96.0, 390.0);
        let width = (WIDTH - left - 28.0 - gap * (columns - 1) as f64) / columns as f64;
        let height = if rows == 1 { 430.0 } else { 310.0 };
        let pitch = if rows == 1 { cell_height } else { height + 66.0 };
        let total = top + (rows - 1) as f64 * pitch + height + 62.0;
        document((WIDTH, total), (title, alt), |canvas| {
            let entries = [
                (Key::Line(Stroke::solid(STATIC, 4.5)), NAMES[0].to_string()),
                (Key::Line(Stroke::solid(SLIP, 2.0)), NAMES[1].to_string()),
            ];
            legend(canvas, left, 2.0, &entries[..1]);
            legend(canvas, left + 220.0, 2.0, &entries[1..]);
            for (index, cycle) in self.cycles.iter().enumerate() {
                let (row, column) = (index / columns, index % columns);
                let (low, high) = range(self.points(cycle).into_iter().map(|((x, _), _)| x));
                let reach = 1.08 * low.abs().max(high.abs());
                let (lowest, highest) = force_range(cycle, &self.force);
                let x = Axis::linear(format!("arm displacement b(θ − θ₀) [{}]", self.stroke.label), -reach, reach);
                let y = Axis::linear(format!("force F − µW [{}]", self.force.label), lowest, highest);
                let (left, top) = (left + (width + gap) * column as f64, top + pitch * row as f64);
                let panel = Panel { left, top, width, height, x, y };
                canvas.register(&panel);
                panel
                    .named(row + 1 == rows || index + columns >= self.cycles.len(), column == 0)
                    .frame(canvas, true, true);
                let [first, second] = cycle.name();
                canvas.text((left, top - 29.0), &first, Type::at(Anchor::Start).bold());
                canvas.text((left, top - 9.0), &second, Type::at(Anchor::Start).colored(INK));
                self.draw_loop(&panel, canvas, cycle);
            }
        })
    }

    fn draw_loop(&self, panel: &Panel, canvas: &mut Canvas, cycle: &Cycle<'_>) {
        let mut points = self.points(cycle);
        points.extend(points.first().copied());
        // Runs of equal state; each reaches to the first sample of the next.
        let mut start = 0;
        for run in points.chunk_by(|a, b| a.1 == b.1) {
            let end = (start + run.len() + 1).min(points.len());
            let line: Vec<Point> = points[start..end].iter().map(|point| point.0).collect();
            let stroke = if run[0].1 { Stroke::solid(STATIC, 4.5) } else { Stroke::solid(SLIP, 2.0) };
            canvas.series(NAMES[usize::from(!run[0].1)], |canvas| panel.curve(canvas, &line, stroke));
            start += run.len();
        }
        // The direction of travel: an arrowhead where the force changes most.
        let step = (points.len() / 24).max(1);
        let pixel = |i: usize| (panel.px(points[i].0.0), panel.py(points[i].0.1));
        let rise = |i: usize| (pixel(i + step).1 - pixel(i).1).abs();
        let steepest = (0..points.len().saturating_sub(step)).max_by(|a, b| rise(*a).total_cmp(&rise(*b)));
        if let Some(i) = steepest.filter(|i| rise(*i) > 6.0) {
            let (from, middle, to) = (pixel(i), pixel(i + step / 2), pixel(i + step));
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            let along =
                |way: f64| (middle.0 + way * (to.0 - from.0) / length, middle.1 + way * (to.1 - from.1) / length);
            let stroke = Stroke::solid(if points[i].1 { STATIC } else { SLIP }, 3.4);
            canvas.within(panel, |canvas| canvas.arrow(along(-7.0), along(8.0), stroke));
        }
    }

    fn csv(&self) -> String {
        let (x, y) =
            (format!("displacement [{}]", self.stroke.label), format!("force minus mu W [{}]", self.force.label));
        let mut table = Table::new(&["frequency [Hz]", "speed [mm/s]", "time [ms]", &x, &y, "interface"]);
        for cycle in &self.cycles {
            for (i, ((x, y), sticks)) in self.points(cycle).into_iter().enumerate() {
                let speed = Unit::speed().of(cycle.condition.speed);
                let numbers = [cycle.frequency, speed, 1e3 * cycle.orbit.time[i], x, y].map(cell);
                let word = if sticks { "stick" } else { "slip" };
                table.row(numbers.into_iter().chain([word.to_string()]));
            }
        }
        table.finish()
    }
}

/// Area of the loop: the work that the contact takes from the arm in a cycle, by the polygon's formula \[J\].
fn work(cycle: &Cycle<'_>) -> f64 {
    let (n, mut area) = (cycle.len(), 0.0);
    for i in 0..n {
        let j = (i + 1) % n;
        area += 0.5 * (cycle.displacement(i) * cycle.force(j) - cycle.displacement(j) * cycle.force(i));
    }
    area
}

impl Figure for Loops {
    fn name(&self) -> &'static str {
        "loops"
    }

    fn title(&self) -> &'static str {
        "Force-displacement loops of the contact"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Closed loops: thick where the contact sticks, flat at the limit where it slips.",
            "A loop that does not close, or a force above the limit without an effect in the scenario.",
            "Compare areas: the loop with the largest area takes most energy out of the arm.",
        ]
    }

    fn needs_orbits(&self) -> bool {
        true
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let mut notes = Vec::new();
        for cycle in &data.cycles {
            let work = work(cycle);
            let (low, high) = range((0..cycle.len()).map(|i| cycle.displacement(i)));
            let nothing = ROUNDING * cycle.condition.friction * cycle.condition.load * (high - low);
            let shown =
                if work.abs() > nothing { Unit::fitting(work.abs(), "J").show(work.abs(), 3) } else { "0 J".into() };
            notes.push((format!("Loop area, {}", cycle.name()[0]), shown));
        }
        let regimes: Vec<String> = data.cycles.iter().map(|c| format!("{} ({})", c.name()[0], c.regime())).collect();
        let caption = format!(
            "Contact force less the Coulomb limit µW against displacement of the arm over one cycle, each panel with its own \
             axes: {}. While the interface \
             slips the force stays at the limit; while it sticks the bristles carry the arm's motion and the force falls below \
             it. The enclosed area is what the contact takes out of the arm's vibration per cycle.{}",
            regimes.join("; "),
            left_out(data.left_out)
        );
        let alt = format!(
            "{} panels of force against displacement: the part of the cycle that sticks drawn thick, the part that slips thin.",
            data.cycles.len()
        );
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
