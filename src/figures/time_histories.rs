//! Speeds and force over one cycle.

use super::axes::{Axis, Panel, range};
use super::canvas::{Anchor, Canvas, Dash, Point, Stroke, Type, document};
use super::legend::{Key, legend};
use super::orbits::{Cycle, cycles, force_range, force_unit, left_out};
use super::style::{Color, DASH_ROLLER, HEIGHT, INK, ROLLER, SHADE, SLIP, Table, Unit, WIDTH, cell};
use super::{Drawing, Figure, FigureError};
use crate::sweep::Outcome;

const MOST_COLUMNS: usize = 3;
const FORCE: Color = Color(0x6a, 0x3d, 0x9a);

/// Names of what is drawn.
const ARM: &str = "arm bθ′";
const SPEED: &str = "roller V";
const SLIP_RATE: &str = "slip rate s";
const CONTACT: &str = "force F";
const STICKS: &str = "interface sticks";

/// The figure.
pub struct TimeHistories;

/// What is shown.
struct Data<'a> {
    cycles: Vec<Cycle<'a>>,
    left_out: usize,
    force: Unit,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        let (all, more) = cycles(outcome, "time-histories")?;
        let cycles = super::data::spread(&all, MOST_COLUMNS);
        let left_out = more + all.len() - cycles.len();
        let force = force_unit(&cycles);
        Ok(Self { cycles, left_out, force })
    }

    /// A quantity against the share of the period, closed by its first value.
    fn history(cycle: &Cycle<'_>, quantity: impl Fn(usize) -> f64) -> Vec<Point> {
        let n = cycle.len();
        (0..=n).map(|i| (i as f64 / n as f64, quantity(i % n))).collect()
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let speed = Unit::speed();
        let columns = self.cycles.len();
        let (left, gap) = (96.0, 82.0);
        let width = (WIDTH - left - 28.0 - gap * (columns - 1) as f64) / columns as f64;
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            let entries = [
                (Key::Line(Stroke::solid(INK, 2.6)), ARM),
                (Key::Line(Stroke::dashed(ROLLER, 2.4, DASH_ROLLER)), SPEED),
                (Key::Line(Stroke::dashed(SLIP, 2.4, Dash::Dashes(7.0, 3.0))), SLIP_RATE),
                (Key::Line(Stroke::solid(FORCE, 2.6)), CONTACT),
                (Key::Patch(SHADE), STICKS),
            ];
            for (i, (key, text)) in entries.into_iter().enumerate() {
                legend(canvas, left + 178.0 * i as f64, 2.0, &[(key, text.to_string())]);
            }
            for (index, cycle) in self.cycles.iter().enumerate() {
                let left = left + (width + gap) * index as f64;
                let axis = || Axis::linear("time t/T [–]", 0.0, 1.0).step(0.25);
                let own = (0..cycle.len()).flat_map(|i| [cycle.velocity(i), cycle.orbit.slip_rate[i]]);
                let (low, high) = range(own.chain([cycle.condition.speed]).map(|v| speed.of(v)));
                let pad = 0.06 * (high - low);
                let y = Axis::linear("speed [mm/s]", low - pad, high + pad);
                let upper = Panel { left, top: 92.0, width, height: 350.0, x: axis(), y };
                let (lowest, highest) = force_range(cycle, &self.force);
                let y = Axis::linear(format!("force F − µW [{}]", self.force.label), lowest, highest);
                let lower = Panel { left, top: 466.0, width, height: 214.0, x: axis(), y };
                for panel in [&upper, &lower] {
                    canvas.series(STICKS, |canvas| canvas.areas(panel, |canvas| shade(panel, canvas, cycle)));
                    canvas.register(panel);
                    panel.named(true, index == 0).frame(canvas, panel.top == lower.top, true);
                }
                let [first, second] = cycle.name();
                canvas.text((left, 92.0 - 29.0), &first, Type::at(Anchor::Start).bold());
                canvas.text((left, 92.0 - 9.0), &second, Type::at(Anchor::Start));
                let v = speed.of(cycle.condition.speed);
                let roller = vec![(0.0, v), (1.0, v)];
                let arm = Self::history(cycle, |i| speed.of(cycle.velocity(i)));
                let slip = Self::history(cycle, |i| speed.of(cycle.orbit.slip_rate[i]));
                let force = Self::history(cycle, |i| self.force.of(cycle.force(i)));
                for (name, panel, points, stroke) in [
                    (SPEED, &upper, roller, Stroke::dashed(ROLLER, 2.4, DASH_ROLLER)),
                    (ARM, &upper, arm, Stroke::solid(INK, 2.6)),
                    (SLIP_RATE, &upper, slip, Stroke::dashed(SLIP, 2.4, Dash::Dashes(7.0, 3.0))),
                    (CONTACT, &lower, force, Stroke::solid(FORCE, 2.6)),
                ] {
                    canvas.series(name, |canvas| panel.curve(canvas, &points, stroke));
                }
            }
        })
    }

    fn csv(&self) -> String {
        let force = format!("force minus mu W [{}]", self.force.label);
        let header = [
            "frequency [Hz]",
            "roller speed [mm/s]",
            "time over period [-]",
            "arm speed [mm/s]",
            "slip rate [mm/s]",
            &force,
            "interface",
        ];
        let mut table = Table::new(&header);
        let speed = Unit::speed();
        for cycle in &self.cycles {
            for i in 0..cycle.len() {
                let speeds = [cycle.velocity(i), cycle.orbit.slip_rate[i]].map(|v| speed.of(v));
                let time = i as f64 / cycle.len() as f64;
                let roller = speed.of(cycle.condition.speed);
                let numbers = [cycle.frequency, roller, time, speeds[0], speeds[1], self.force.of(cycle.force(i))];
                let word = if cycle.sticks(i) { "stick" } else { "slip" };
                table.row(numbers.map(cell).into_iter().chain([word.to_string()]));
            }
        }
        table.finish()
    }
}

fn shade(panel: &Panel, canvas: &mut Canvas, cycle: &Cycle<'_>) {
    let n = cycle.len();
    let states: Vec<bool> = (0..n).map(|i| cycle.sticks(i)).collect();
    let mut start = 0;
    for run in states.chunk_by(|a, b| a == b) {
        if run[0] {
            let (from, to) = (start as f64 / n as f64, (start + run.len()) as f64 / n as f64);
            let (left, right) = (panel.px(from), panel.px(to));
            canvas.rectangle((left, panel.top), right - left, panel.height, SHADE, None);
        }
        start += run.len();
    }
}

impl Figure for TimeHistories {
    fn name(&self) -> &'static str {
        "time-histories"
    }

    fn title(&self) -> &'static str {
        "One cycle in time"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Slip rate is zero wherever it is shaded, and positive elsewhere.",
            "Many short intervals of stick in one period: chatter, and a state that may not be steady.",
            "Read where in the cycle stick begins and ends; a sensor fast enough would see the force break there.",
        ]
    }

    fn needs_orbits(&self) -> bool {
        true
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let shares: Vec<String> = data.cycles.iter().map(|cycle| cycle.name().join(" – ")).collect();
        let caption = format!(
            "Speed of the arm at the contact, speed of the roller, slip rate and contact force less µW over one period \
             T, starting where the actuator passes zero upwards, each column with its own axes: {}. Stick (shaded) begins when the arm has caught up with the roller and \
             the slip rate reaches zero; it ends when the bristles are stretched back to the Coulomb limit µW.{}",
            shares.join("; "),
            left_out(data.left_out)
        );
        let notes = data.cycles.iter().map(|cycle| {
            (format!("Stick fraction, {}", cycle.name()[0]), format!("{:.3}", cycle.state.stick_fraction))
        });
        let notes = notes.collect();
        let alt = format!(
            "Histories over one cycle in {} columns: speeds above, force below; shaded where the interface sticks.",
            data.cycles.len()
        );
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
