//! Speed amplitude of the arm at the contact against frequency, with the roller's speed (paper Figure 2).

use super::axes::{Axis, Panel, range};
use super::canvas::{Anchor, Canvas, Point, Stroke, Type, document};
use super::data::{self, Field, crossings, health};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::Mark;
use super::scheme::{draw_curve, draw_limit, limit_name, limit_points, limits};
use super::style::{DASH_ROLLER, DOTS, INK, ROLLER, SLIP, TICK_SIZE, Table, Unit, WIDTH, cell, ramp, text_width};
use super::{Drawing, Figure, FigureError};
use crate::sweep::{Condition, Curve, LimitCurve, LimitingCase, Outcome};

const HEIGHT: f64 = 620.0;
const MOST_CURVES: usize = 8;

/// The figure.
pub struct VelocityAmplitude;

/// What is shown, in SI.
struct Data<'a> {
    curves: Vec<(&'a Curve, Stroke)>,
    left_out: usize,
    limits: Vec<(&'a LimitCurve, Stroke)>,
    span: (f64, f64),
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        data::with_contact(outcome, "velocity-amplitude")?;
        let all = data::curves(outcome);
        let groups = data::groups(&all, Field::Speed);
        let Some(group) = groups.first() else {
            return Err(FigureError::missing(
                "velocity-amplitude",
                "a sweep with at least one frequency and one speed",
            ));
        };
        let shown = data::spread(group, MOST_CURVES);
        let span = data::span(&shown);
        let count = shown.len();
        let color = |i: usize| if count == 1 { ROLLER } else { ramp(i, count) };
        let width = if count == 1 { 4.0 } else { 2.6 };
        let curves = shown.iter().enumerate().map(|(i, &curve)| (curve, Stroke::solid(color(i), width))).collect();
        let limits = limits(outcome, group[0].condition.drive);
        Ok(Self { curves, left_out: all.len() - count, limits, span })
    }

    fn slip(&self) -> Option<&'a LimitCurve> {
        self.limits.iter().map(|(limit, _)| *limit).find(|limit| limit.case == LimitingCase::FreeOrFullSlip)
    }

    /// Frequencies at which the full-slip curve passes the roller's speed; none without contact.
    fn onsets(&self, condition: &Condition) -> Vec<f64> {
        let Some(slip) = self.slip() else { return Vec::new() };
        let points = limit_points(slip, &slip.speed_amplitude, self.span, 1.0);
        if condition.speed > 0.0 && condition.load > 0.0 { crossings(&points, condition.speed) } else { Vec::new() }
    }

    /// Speeds below the top of the graph: others would only flatten it.
    fn fits(&self, speed: f64, top: f64) -> bool {
        speed > 0.0 && speed <= 1.5 * top
    }

    /// Name of a curve in the legend.
    fn name(&self, curve: &Curve) -> String {
        let partial = curve.states.iter().any(|s| s.stick_fraction > 0.0 && s.stick_fraction < 1.0);
        match self.curves.as_slice() {
            [_] if partial => "computed, partial stick".into(),
            [_] => "computed".into(),
            _ => Field::Speed.equation(&curve.condition),
        }
    }

    /// Name and dashes of the roller's speed in the legend.
    fn roller(&self) -> (String, Stroke) {
        let (name, color) = match self.curves.as_slice() {
            [(curve, _)] => (Field::Speed.equation(&curve.condition), ROLLER),
            _ => ("V in the curve's colour".into(), INK),
        };
        (name, Stroke::dashed(color, 2.0, DASH_ROLLER))
    }

    fn legend(&self, roller: bool) -> Vec<Entry> {
        let mut entries: Vec<Entry> = vec![(Key::Heading, "Arm, bωα".into())];
        entries.extend(self.curves.iter().map(|(curve, stroke)| (Key::Line(*stroke), self.name(curve))));
        entries.extend(self.limits.iter().map(|(limit, stroke)| (Key::Line(*stroke), limit_name(limit.case).into())));
        if roller {
            let (name, dashes) = self.roller();
            entries.extend([(Key::Heading, "Roller".into()), (Key::Line(dashes), name)]);
        }
        entries
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let unit = Unit::speed();
        let states = self.curves.iter().flat_map(|(curve, _)| curve.states.iter().map(|s| s.speed_amplitude));
        let of_limits =
            self.limits.iter().flat_map(|(l, _)| limit_points(l, &l.speed_amplitude, self.span, 1.0)).map(|p| p.1);
        let top = range(states.chain(of_limits)).1;
        let speeds: Vec<f64> =
            self.curves.iter().map(|(c, _)| c.condition.speed).filter(|v| self.fits(*v, top)).collect();
        let values = speeds.iter().copied().chain([0.0, top]).map(|v| unit.of(v));
        let entries = self.legend(!speeds.is_empty());
        let width = WIDTH - 92.0 - 50.0 - legend_width(&entries);
        let x = Axis::frequency("frequency f", self.span.0, self.span.1);
        let y = Axis::around("speed amplitude bωα [mm/s]", values);
        let panel = Panel { left: 92.0, top: 24.0, width, height: 536.0, x, y };
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            panel.frame(canvas, true, true);
            self.draw_curves(canvas, &panel, top);
            for (limit, stroke) in &self.limits {
                let points = limit_points(limit, &limit.speed_amplitude, self.span, unit.factor);
                draw_limit(&panel, canvas, &points, limit.case, *stroke);
            }
            self.draw_onsets(canvas, &panel);
            legend(canvas, panel.right() + 30.0, 20.0, &entries);
        })
    }

    /// The curves, and beneath each the speed of its roller where that fits.
    fn draw_curves(&self, canvas: &mut Canvas, panel: &Panel, top: f64) {
        let unit = Unit::speed();
        let (roller, _) = self.roller();
        for (curve, stroke) in &self.curves {
            let speed = curve.condition.speed;
            if self.fits(speed, top) {
                let level = unit.of(speed);
                let dashes = Stroke::dashed(stroke.color, 2.0, DASH_ROLLER);
                let ends = [(panel.x.low, level), (panel.x.high, level)];
                canvas.series(&roller, |canvas| panel.curve(canvas, &ends, dashes));
            }
            let draw = |canvas: &mut Canvas| draw_curve(panel, canvas, curve, *stroke, |s| unit.of(s.speed_amplitude));
            canvas.series(&self.name(curve), draw);
        }
    }

    /// Marks where full slip is as fast as the roller, and what frequencies these are where there is one curve.
    fn draw_onsets(&self, canvas: &mut Canvas, panel: &Panel) {
        for (curve, _) in &self.curves {
            let level = Unit::speed().of(curve.condition.speed);
            let roots = self.onsets(&curve.condition);
            let marks: Vec<Point> = roots.iter().map(|f| (*f, level)).collect();
            canvas.series("full slip is as fast as the roller", |canvas| {
                panel.marks(canvas, &marks, Mark::Circle, 6.0, SLIP, false);
            });
            if self.curves.len() == 1 {
                canvas.within(panel, |canvas| drop_lines(panel, canvas, &roots, level));
            }
        }
    }

    fn csv(&self) -> String {
        let mut table = Table::new(&["curve", "frequency [Hz]", "speed amplitude [mm/s]", "status"]);
        let unit = Unit::speed();
        for (curve, _) in &self.curves {
            let name = Field::Speed.equation(&curve.condition);
            for (f, s) in curve.frequency.iter().zip(&curve.states) {
                let word = data::status_word(&s.status);
                table.row([name.clone(), cell(*f), cell(unit.of(s.speed_amplitude)), word.into()]);
            }
        }
        for (limit, _) in &self.limits {
            for (f, v) in limit_points(limit, &limit.speed_amplitude, self.span, unit.factor) {
                table.row([limit_name(limit.case).into(), cell(f), cell(v), "closed form".into()]);
            }
        }
        table.finish()
    }
}

fn drop_lines(panel: &Panel, canvas: &mut Canvas, roots: &[f64], level: f64) {
    const NAMES: [&str; 4] = ["f₁", "f₂", "f₃", "f₄"];
    for (i, root) in roots.iter().enumerate() {
        let (x, y) = (panel.px(*root), panel.py(level));
        canvas.line((x, y + 6.0), (x, panel.bottom()), Stroke::dashed(INK, 1.2, DOTS));
        let name = NAMES.get(i).copied().unwrap_or("f");
        let text = format!("{name} = {root:.2} Hz");
        let reach = text_width(&text, TICK_SIZE, true) + 24.0;
        let leftwards = if i % 2 == 0 { x - reach > panel.left } else { x + reach > panel.right() };
        let (offset, anchor) = if leftwards { (-8.0, Anchor::End) } else { (8.0, Anchor::Start) };
        canvas.text((x + offset, panel.bottom() - 20.0 - 24.0 * i as f64), &text, Type::at(anchor).bold());
    }
}

impl Figure for VelocityAmplitude {
    fn name(&self) -> &'static str {
        "velocity-amplitude"
    }

    fn title(&self) -> &'static str {
        "Speed of the arm and speed of the roller"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "The computed curve lies on full slip wherever that stays below V, and leaves it towards static contact between f₁ and f₂.",
            "A curve that leaves full slip where bωα is below V, or stays on it above V, without an effect in the scenario.",
            "Look at the loops or the histories at that frequency: they show which part of the cycle sticks.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let unit = Unit::speed();
        let mut notes = Vec::new();
        for (curve, _) in &data.curves {
            let speed = unit.show(curve.condition.speed, 4);
            for (i, root) in data.onsets(&curve.condition).iter().enumerate() {
                notes.push((format!("f{} at V = {speed}", i + 1), format!("{root:.3} Hz")));
            }
        }
        let mut caption = String::from("Amplitude bωα of the arm's speed at the contact against drive frequency.");
        caption += if outcome.scenario.effects.is_empty() {
            " Where it stays below the roller's speed V the contact slips throughout and the computed curve lies on the \
             full-slip case; where that case would exceed V (marks) the contact sticks for part of each cycle and the \
             curve leaves it towards static contact."
        } else {
            " The limiting cases are those of the contact without its effects; look for where the computed curve leaves \
             them although V is above or below it."
        };
        if let Some(slip) = data.slip() {
            let (v, f) = (unit.show(slip.speed_peak, 4), slip.speed_peak_frequency);
            caption += &format!(" Full slip peaks at {v} ({f:.2} Hz)");
            caption += if outcome.scenario.effects.is_empty() {
                ": a roller faster than that never lets the contact stick."
            } else {
                "."
            };
            notes.push(("Largest arm speed in full slip".into(), format!("{v} at {f:.2} Hz")));
        }
        if let [(curve, _)] = data.curves.as_slice()
            && let [first, .., last] = data.onsets(&curve.condition).as_slice()
        {
            caption += &format!(
                " Here V = {}, f₁ = {first:.2} Hz and f₂ = {last:.2} Hz.",
                unit.show(curve.condition.speed, 4)
            );
        }
        if data.left_out > 0 {
            let (n, left) = (data.curves.len(), data.left_out);
            caption += &format!(" {n} curves of the first condition are shown, {left} left out.");
        }
        caption += &health(&data.curves.iter().map(|(curve, _)| *curve).collect::<Vec<_>>());
        let alt = "Graph of the arm's speed amplitude against frequency: a lower and a higher dashed resonance peak, the roller's speed as a horizontal line, and the computed curve in between.".to_string();
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
