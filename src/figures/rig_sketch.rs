//! The rig and the contact model with their symbols (after paper Figure 1).

use super::canvas::{Anchor, Canvas, Dash, Point, Stroke, Type, document};
use super::style::{Color, GREY, INK, ROLLER, SLIP, STATIC, Table, WHITE, WIDTH, cell, significant};
use super::{Drawing, Figure, FigureError};
use crate::scenario::Rig;
use crate::sweep::Outcome;
use std::f64::consts::TAU;

const HEIGHT: f64 = 620.0;
const STEEL: Color = Color(0xdd, 0xe2, 0xe8);
const RUBBER: Color = Color(0x4a, 0x4a, 0x4a);
const LINE: f64 = 2.0;
const LEVEL: f64 = 270.0;
const PIVOT: Point = (96.0, LEVEL);
const PINCH: f64 = 300.0;
const CONTACT: f64 = 504.0;

/// The figure.
pub struct RigSketch;

/// A zigzag spring between two points.
fn spring(canvas: &mut Canvas, from: Point, to: Point, half: f64) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let (ux, uy) = (dx / length, dy / length);
    let at = |along: f64, across: f64| (from.0 + along * ux - across * uy, from.1 + along * uy + across * ux);
    let lead = 0.14 * length;
    let mut points = vec![from, at(lead, 0.0)];
    for k in 0..7 {
        let along = lead + (f64::from(k) + 0.5) / 7.0 * (length - 2.0 * lead);
        points.push(at(along, if k % 2 == 0 { half } else { -half }));
    }
    points.extend([at(length - lead, 0.0), to]);
    canvas.polyline(&points, Stroke::solid(INK, LINE));
}

/// A dashpot between two points: cylinder on the first side, piston on the second.
fn dashpot(canvas: &mut Canvas, from: Point, to: Point, half: f64) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let (ux, uy) = (dx / length, dy / length);
    let at = |along: f64, across: f64| (from.0 + along * ux - across * uy, from.1 + along * uy + across * ux);
    let stroke = Stroke::solid(INK, LINE);
    let (bottom, rim, piston) = (0.3 * length, 0.68 * length, 0.5 * length);
    canvas.line(from, at(bottom, 0.0), stroke);
    canvas.polyline(&[at(rim, half), at(bottom, half), at(bottom, -half), at(rim, -half)], stroke);
    canvas.line(at(piston, 0.78 * half), at(piston, -0.78 * half), Stroke::solid(INK, 3.2));
    canvas.line(at(piston, 0.0), to, stroke);
}

/// Spring and dashpot side by side between two crossbars; vertical where `from` and `to` share x.
fn pair(canvas: &mut Canvas, from: Point, to: Point, apart: f64) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let (nx, ny) = (-dy / length * apart, dx / length * apart);
    let shifted = |point: Point, sign: f64| (point.0 + sign * nx, point.1 + sign * ny);
    spring(canvas, shifted(from, 1.0), shifted(to, 1.0), 9.0);
    dashpot(canvas, shifted(from, -1.0), shifted(to, -1.0), 10.0);
    for end in [from, to] {
        canvas.line(shifted(end, 1.0), shifted(end, -1.0), Stroke::solid(INK, LINE));
    }
}

/// A fixed wall along a line, hatched on the side that the normal (to the right of the direction) points to.
fn wall(canvas: &mut Canvas, from: Point, to: Point) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let (ux, uy) = (dx / length, dy / length);
    let count = (length / 9.0).round().max(1.0);
    for k in 0..=(count as usize) {
        let along = length * k as f64 / count;
        let foot = (from.0 + along * ux, from.1 + along * uy);
        canvas.line(foot, (foot.0 - 9.0 * uy - 6.0 * ux, foot.1 + 9.0 * ux - 6.0 * uy), Stroke::solid(GREY, 1.2));
    }
    canvas.line(from, to, Stroke::solid(INK, 2.6));
}

fn arc(center: Point, radius: f64, from: f64, to: f64) -> Vec<Point> {
    let at = |k: i32| (from + (to - from) * f64::from(k) / 48.0).to_radians();
    (0..=48).map(|k| (center.0 + radius * at(k).cos(), center.1 - radius * at(k).sin())).collect()
}

/// A dimension line with its symbol above.
fn dimension(canvas: &mut Canvas, from: Point, to: Point, symbol: &str) {
    let stroke = Stroke::solid(GREY, 1.4);
    let middle = (0.5 * (from.0 + to.0), from.1);
    canvas.arrow(middle, from, stroke);
    canvas.arrow(middle, to, stroke);
    for end in [from, to] {
        canvas.line((end.0, end.1 - 8.0), (end.0, end.1 + 8.0), stroke);
    }
    symbol_text(canvas, (middle.0, from.1 - 8.0), symbol, Anchor::Middle, INK);
}

fn symbol_text(canvas: &mut Canvas, at: Point, text: &str, anchor: Anchor, color: Color) {
    canvas.text(at, text, Type { size: 18.0, anchor, color, bold: false, upwards: false });
}

/// Arm, torsional spring, pinching springs and piezo.
fn rig(canvas: &mut Canvas) {
    canvas.rectangle((PIVOT.0, PIVOT.1 - 11.0), CONTACT - PIVOT.0, 22.0, STEEL, Some(Stroke::solid(INK, LINE)));
    symbol_text(canvas, (0.5 * (PINCH + CONTACT) + 10.0, LEVEL + 6.0), "J", Anchor::Middle, INK);
    let swing = arc(PIVOT, 118.0, 6.5, 29.0);
    let last = swing[swing.len() - 1];
    canvas.polyline(&swing, Stroke::solid(INK, 1.8));
    canvas.arrow((last.0 + 2.2, last.1 + 4.5), (last.0 - 4.4, last.1 - 7.0), Stroke::solid(INK, 1.8));
    symbol_text(canvas, (PIVOT.0 + 122.0, LEVEL - 44.0), "θ", Anchor::Start, INK);
    // Torsional spring: a spiral around the pivot, and the ground that holds its end.
    let turn = |k: i32| (f64::from(k) / 160.0, TAU * 2.25 * f64::from(k) / 160.0);
    let at = |(share, angle): (f64, f64)| {
        let radius = 13.0 + 33.0 * share;
        (PIVOT.0 + radius * angle.cos(), LEVEL + radius * angle.sin())
    };
    let spiral: Vec<Point> = (0..=160).map(|k| at(turn(k))).collect();
    canvas.polyline(&spiral, Stroke::solid(INK, LINE));
    canvas.line((PIVOT.0, LEVEL + 46.0), (PIVOT.0, LEVEL + 92.0), Stroke::solid(INK, LINE));
    canvas.circle(PIVOT, 8.0, WHITE, Stroke::solid(INK, LINE));
    canvas.circle(PIVOT, 2.0, INK, Stroke::solid(INK, 1.0));
    wall(canvas, (PIVOT.0 - 42.0, LEVEL + 92.0), (PIVOT.0 + 42.0, LEVEL + 92.0));
    symbol_text(canvas, (PIVOT.0 - 52.0, LEVEL - 62.0), "K₀, C₀", Anchor::Start, INK);
    pair(canvas, (PINCH, LEVEL - 108.0), (PINCH, LEVEL - 11.0), 22.0);
    pair(canvas, (PINCH, LEVEL + 108.0), (PINCH, LEVEL + 11.0), 22.0);
    canvas.rectangle((PINCH - 40.0, LEVEL - 150.0), 80.0, 42.0, WHITE, Some(Stroke::solid(INK, LINE)));
    canvas.text((PINCH, LEVEL - 124.0), "piezo", Type::at(Anchor::Middle));
    wall(canvas, (PINCH + 52.0, LEVEL - 150.0), (PINCH - 52.0, LEVEL - 150.0));
    wall(canvas, (PINCH - 52.0, LEVEL + 108.0), (PINCH + 52.0, LEVEL + 108.0));
    canvas.line((PINCH - 72.0, LEVEL - 92.0), (PINCH - 52.0, LEVEL - 92.0), Stroke::solid(STATIC, 1.8));
    canvas.arrow((PINCH - 62.0, LEVEL - 92.0), (PINCH - 62.0, LEVEL - 140.0), Stroke::solid(STATIC, 2.4));
    symbol_text(canvas, (PINCH - 76.0, LEVEL - 122.0), "u = u₀ sin ωt", Anchor::End, STATIC);
    for y in [LEVEL - 53.0, LEVEL + 66.0] {
        let sides = if y < LEVEL { ("c₀", "k₀") } else { ("k₀", "c₀") };
        symbol_text(canvas, (PINCH - 38.0, y), sides.1, Anchor::End, INK);
        symbol_text(canvas, (PINCH + 38.0, y), sides.0, Anchor::Start, INK);
    }
    let below = LEVEL + 178.0;
    for (x, from, to) in [(PIVOT.0, 110.0, 54.0), (PINCH, 126.0, 10.0), (CONTACT, 16.0, 54.0)] {
        canvas.line((x, LEVEL + from), (x, below + to), Stroke::dashed(GREY, 1.0, Dash::Dashes(2.0, 4.0)));
    }
    dimension(canvas, (PIVOT.0, below), (PINCH, below), "a");
    dimension(canvas, (PIVOT.0, below + 44.0), (CONTACT, below + 44.0), "b");
}

/// Roller with its speed and load, and the force on the arm.
fn roller(canvas: &mut Canvas) {
    let (radius, rim) = (92.0, 24.0);
    let center = (CONTACT + radius, LEVEL);
    canvas.circle(center, radius, RUBBER, Stroke::solid(INK, LINE));
    canvas.circle(center, radius - rim, STEEL, Stroke::solid(INK, LINE));
    canvas.circle(center, 6.0, WHITE, Stroke::solid(INK, LINE));
    canvas.text((center.0, LEVEL + 40.0), "rubber roller", Type::at(Anchor::Middle));
    let turning = arc(center, radius + 16.0, 132.0, 66.0);
    let last = turning[turning.len() - 1];
    canvas.polyline(&turning, Stroke::solid(ROLLER, 3.0));
    canvas.arrow((last.0 - 6.0, last.1 - 2.9), (last.0 + 9.0, last.1 + 4.6), Stroke::solid(ROLLER, 3.0));
    symbol_text(canvas, (center.0 - 8.0, center.1 - radius - 28.0), "V", Anchor::Middle, ROLLER);
    canvas.arrow((center.0 + radius + 78.0, LEVEL), (center.0 + radius + 4.0, LEVEL), Stroke::solid(INK, 3.0));
    symbol_text(canvas, (center.0 + radius + 46.0, LEVEL - 12.0), "W", Anchor::Middle, INK);
    canvas.arrow((CONTACT - 22.0, LEVEL - 14.0), (CONTACT - 22.0, LEVEL - 84.0), Stroke::solid(SLIP, 3.2));
    symbol_text(canvas, (CONTACT - 34.0, LEVEL - 62.0), "F", Anchor::End, SLIP);
}

/// The contact model, magnified: bristle in series with a slider between arm and roller surface.
fn inset(canvas: &mut Canvas) {
    let (left, top, width, height) = (660.0, 428.0, 416.0, 172.0);
    let frame = Stroke::dashed(GREY, 1.4, Dash::Dashes(5.0, 4.0));
    canvas.polyline(&[(CONTACT + 8.0, LEVEL + 21.0), (CONTACT + 28.0, top + 44.0), (left, top + 44.0)], frame);
    canvas.rectangle((left, top), width, height, WHITE, Some(Stroke::solid(GREY, 1.4)));
    let middle = top + 82.0;
    canvas.rectangle((left + 16.0, middle - 34.0), 58.0, 68.0, STEEL, Some(Stroke::solid(INK, LINE)));
    canvas.text((left + 45.0, middle + 5.0), "arm", Type::at(Anchor::Middle));
    pair(canvas, (left + 92.0, middle), (left + 196.0, middle), 20.0);
    canvas.line((left + 74.0, middle), (left + 92.0, middle), Stroke::solid(INK, LINE));
    symbol_text(canvas, (left + 144.0, middle + 48.0), "k_c, x", Anchor::Middle, INK);
    symbol_text(canvas, (left + 144.0, middle - 38.0), "c_c", Anchor::Middle, INK);
    // Slider: a block pressed on the roller's surface.
    canvas.line((left + 196.0, middle), (left + 228.0, middle), Stroke::solid(INK, LINE));
    canvas.rectangle((left + 228.0, middle - 16.0), 58.0, 32.0, WHITE, Some(Stroke::solid(INK, LINE)));
    symbol_text(canvas, (left + 257.0, middle + 6.0), "µ", Anchor::Middle, SLIP);
    canvas.arrow((left + 257.0, middle - 58.0), (left + 257.0, middle - 18.0), Stroke::solid(INK, 2.4));
    symbol_text(canvas, (left + 268.0, middle - 38.0), "W", Anchor::Start, INK);
    canvas.rectangle((left + 214.0, middle + 16.0), 186.0, 12.0, RUBBER, None);
    canvas.rectangle((left + 214.0, middle + 28.0), 186.0, 10.0, STEEL, None);
    canvas.arrow((left + 312.0, middle - 4.0), (left + 392.0, middle - 4.0), Stroke::solid(ROLLER, 3.0));
    symbol_text(canvas, (left + 352.0, middle - 14.0), "V − bθ′", Anchor::Middle, ROLLER);
    let baseline = top + height - 16.0;
    canvas.text((left + 30.0, baseline), "stick: s = 0, |F| ≤ µW", Type::default());
    canvas.text((left + width - 30.0, baseline), "slip: |F| = µW", Type::at(Anchor::End));
}

/// The values of the paper's kind of rig; of any other there is no sketch.
fn values(outcome: &Outcome) -> Option<Vec<(&'static str, &'static str, f64, &'static str)>> {
    let (Rig::TorsionalArm(rig), Some(contact)) = (&outcome.scenario.rig, &outcome.scenario.contact) else {
        return None;
    };
    Some(vec![
        ("J", "inertia of the arm", rig.inertia, "kg m²"),
        ("K0", "stiffness of the torsional spring", rig.torsional_stiffness, "N m/rad"),
        ("C0", "damping of the torsional spring", rig.torsional_damping, "N m s/rad"),
        ("k0", "stiffness of each pinching spring", rig.spring_stiffness, "N/m"),
        ("c0", "damping of each pinching spring", rig.spring_damping, "N s/m"),
        ("a", "arm of the pinching springs", rig.spring_arm, "m"),
        ("b", "arm of the contact", rig.contact_arm, "m"),
        ("kc", "stiffness of the bristles", contact.stiffness, "N/m"),
        ("cc", "damping of the bristles", contact.damping, "N s/m"),
        ("mu", "coefficient of friction", contact.friction, "-"),
    ])
}

/// The scenario's numbers beside the symbols that they belong to.
fn list(canvas: &mut Canvas, values: &[(&str, &str, f64, &str)]) {
    const SYMBOLS: [&str; 10] = ["J", "K₀", "C₀", "k₀", "c₀", "a", "b", "k_c", "c_c", "µ"];
    canvas.text((846.0, 52.0), "Values of the scenario", Type::default().bold());
    for (i, ((_, _, value, unit), symbol)) in values.iter().zip(SYMBOLS).enumerate() {
        let y = 78.0 + 23.0 * i as f64;
        let unit = if *unit == "-" { "" } else { unit };
        canvas.text((872.0, y), symbol, Type::at(Anchor::End));
        canvas.text((888.0, y), format!("{} {unit}", significant(*value, 4)).trim_end(), Type::default());
    }
}

impl Figure for RigSketch {
    fn name(&self) -> &'static str {
        "rig-sketch"
    }

    fn title(&self) -> &'static str {
        "The rig and its contact"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Every value is that of your rig.",
            "A value that belongs to another rig, or to another state of it.",
            "Correct the scenario file; the table of parameters below names the key of each value.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let need = "a rig of kind \"torsional-arm\" with a contact";
        let values = values(outcome).ok_or_else(|| FigureError::missing(self.name(), need))?;
        let mut table = Table::new(&["symbol", "quantity", "value", "unit"]);
        for (symbol, quantity, value, unit) in &values {
            table.row([(*symbol).to_string(), (*quantity).to_string(), cell(*value), (*unit).to_string()]);
        }
        let notes = values.iter().map(|(s, _, v, unit)| ((*s).to_string(), format!("{} {unit}", significant(*v, 4))));
        let notes = notes.collect();
        let caption = "A rigid arm of inertia J turns by the angle θ on a torsional spring (K₀, C₀). Two springs (k₀, c₀) pinch it at the                        distance a; a piezo actuator moves the end of one of them by u. At the distance b a rubber roller of peripheral speed V,                        pressed on with the load W, rubs on the arm with the tangential force F. Inset: the contact is a bristle (stiffness kc,                        damping cc, stretch x) in series with a slider of friction µ, whose slip rate is s. Not to scale.".to_string();
        let alt = "Sketch of the rig: arm on a torsional spring, pinched by two springs of which one is driven by a piezo, and a roller rubbing at the arm's end; inset of the contact model.".to_string();
        let svg = document((WIDTH, HEIGHT), (self.title(), &alt), |canvas| {
            rig(canvas);
            roller(canvas);
            inset(canvas);
            list(canvas, &values);
        })?;
        Ok(Drawing::of(self, (caption, alt), (svg, table.finish()), notes))
    }
}
