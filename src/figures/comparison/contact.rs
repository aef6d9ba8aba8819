//! What the contact must have done: dynamic stiffness and damping from the readings and the rig alone, beside those of
//! the model; against frequency, or against the amplitude of the arm's speed. Without a contact the same of the force
//! that is missing in the linear rig, against frequency or against the amplitude of the motion.

mod text;

pub use text::csv;

use super::columns::{Column, Curve, columns};
use super::limits::{Limits, Outside};
use super::multiples::frequencies;

use crate::compare::{Comparison, ContactPoint, units_of_force};
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Canvas, Point, Stroke, Type, document};
use crate::figures::marks::Mark;
use crate::figures::style::{Color, DASH_SLIP, DOTS, GAP, INK, LEFT, Unit, WIDTH, count, significant, text_width};
use crate::figures::{Drawing, Figure, FigureError};
use crate::scenario::Rig;

/// By how much the first of several lines is wider than the last, at most.
const WIDER: f64 = 3.9;
/// Right of the panels: names of the reference lines.
const RIGHT: f64 = 84.0;
/// Heights of the two rows.
const HEIGHTS: [f64; 2] = [280.0, 240.0];
/// Height of the name of a speed above its panel.
const SPEED_LINE: f64 = 17.0;
/// Speeds named in one column.
const SPEEDS: usize = 4;
/// Height of a line of a column's legend.
const LINE: f64 = 19.0;

/// Against frequency or against speed amplitude.
pub struct Contact {
    by_speed: bool,
}

/// Against frequency.
pub const FREQUENCY: Contact = Contact { by_speed: false };
/// Against the amplitude of the arm's speed.
pub const SPEED: Contact = Contact { by_speed: true };

/// Stiffness or damping: how it is read and shown.
pub struct Row {
    /// The value.
    pub value: fn(&ContactPoint) -> f64,
    /// Its standard deviation.
    pub sd: fn(&ContactPoint) -> f64,
    /// Its unit.
    pub unit: Unit,
    /// Label of its axis.
    pub label: String,
    /// Value of the calibrated contact in sticking, where there is one.
    pub stuck: Option<f64>,
    names: (&'static str, &'static str),
}

impl Row {
    /// Stiffness and damping of the contact of a comparison, or of the force that is missing.
    pub fn both(c: &Comparison) -> [Self; 2] {
        if !c.model.has_contact {
            return Self::of_missing_force(c);
        }
        let contact = &c.model.contact;
        let unit = Unit::fitting(contact.stiffness, "N/m");
        let stiffness = Self {
            value: |p| p.stiffness_n_m,
            sd: |p| p.stiffness_sd_n_m,
            label: format!("dynamic stiffness k [{}]", unit.label),
            unit,
            stuck: Some(contact.stiffness),
            names: ("stick: k_c", "slip: 0"),
        };
        let damping = Self {
            value: |p| p.damping_n_s_m,
            sd: |p| p.damping_sd_n_s_m,
            unit: Unit::new(1.0, "N s/m"),
            label: "damping c [N s/m]".into(),
            stuck: Some(contact.damping),
            names: ("stick: c_c", "slip: 0"),
        };
        [stiffness, damping]
    }

    /// In the units of the rig; where its mass is not stated, as shares of its stiffness and damping.
    fn of_missing_force(c: &Comparison) -> [Self; 2] {
        let units = units_of_force(&c.model);
        let mean = |of: fn(&ContactPoint) -> (f64, f64)| {
            let weighted = c.contact.iter().map(of).filter(|(x, sd)| x.is_finite() && *sd > 0.0);
            let (sum, weight) = weighted.fold((0.0, 0.0), |(s, w), (x, sd)| (s + (x / sd).powi(2), w + sd.powi(-2)));
            (sum / weight).sqrt()
        };
        let [k, c] = match (units[0], c.model.rig) {
            ("1/s^2", Rig::Oscillator(rig)) => {
                [Unit::new(0.01 * rig.stiffness(), "% of K"), Unit::new(0.01 * rig.damping(), "% of C")]
            }
            _ => [
                Unit::fitting(mean(|p| (p.stiffness_n_m, p.stiffness_sd_n_m)), units[0]),
                Unit::fitting(mean(|p| (p.damping_n_s_m, p.damping_sd_n_s_m)), units[1]),
            ],
        };
        let names = ("", "0: nothing");
        [
            Self {
                value: |p| p.stiffness_n_m,
                sd: |p| p.stiffness_sd_n_m,
                label: format!("stiffness k [{}]", k.label),
                unit: k,
                stuck: None,
                names,
            },
            Self {
                value: |p| p.damping_n_s_m,
                sd: |p| p.damping_sd_n_s_m,
                label: format!("damping c [{}]", c.label),
                unit: c,
                stuck: None,
                names,
            },
        ]
    }
}

struct Data<'a> {
    c: &'a Comparison,
    by_speed: bool,
    columns: Vec<Column<'a>>,
    rows: [Row; 2],
    limits: [Limits; 2],
}

impl<'a> Data<'a> {
    fn of(c: &'a Comparison, by_speed: bool) -> Self {
        let columns = columns(c);
        let rows = Row::both(c);
        let curves = || columns.iter().flat_map(|column| &column.curves);
        let limits = [&rows[0], &rows[1]].map(|row| {
            let (measured, model) = (curves().flat_map(|c| &c.measured), curves().flat_map(|c| &c.model));
            Limits::of(measured, model, row, row.stuck)
        });
        Self { c, by_speed, columns, rows, limits }
    }

    fn x(&self, p: &ContactPoint) -> f64 {
        match (self.by_speed, self.c.model.has_contact) {
            (true, true) => Unit::speed().of(p.speed_amplitude_m_s),
            (true, false) => self.motion().of(p.motion()),
            (false, _) => p.frequency_hz,
        }
    }

    /// The unit of the coordinate of a rig without contact.
    fn motion(&self) -> Unit {
        let largest = self.c.contact.iter().map(ContactPoint::motion).fold(0.0, f64::max);
        Unit::of_signal(largest, units_of_force(&self.c.model)[2])
    }

    fn axis(&self) -> Axis {
        let all = self.c.contact.iter().chain(&self.c.contact_model).map(|p| self.x(p));
        if self.by_speed && !self.c.model.has_contact {
            return Axis::logarithmic(format!("amplitude of the motion [{}]", self.motion().label), all, 0.05);
        }
        if self.by_speed {
            let label = if self.columns.len() > 3 { "bωα [mm/s]" } else { "speed amplitude bωα [mm/s]" };
            return Axis::logarithmic(label, all, 0.05);
        }
        frequencies("frequency f", all)
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let n = self.columns.len() as f64;
        let width = (WIDTH - LEFT - RIGHT - GAP * (n - 1.0)) / n;
        let most = self.columns.iter().map(|column| column.curves.len()).max().unwrap_or(1);
        let named = self.columns.iter().map(|column| column.speeds.iter().filter(|v| **v > 0.0).count()).max();
        let above = if self.by_speed { SPEED_LINE * named.unwrap_or(0).min(SPEEDS) as f64 } else { 0.0 };
        let top = 38.0 + LINE * most as f64 + above;
        let axis = self.axis();
        let height = top + HEIGHTS.iter().sum::<f64>() + 18.0 + 62.0;
        document((WIDTH, height), (title, alt), |canvas| {
            for (index, column) in self.columns.iter().enumerate() {
                let left = LEFT + (width + GAP) * index as f64;
                self.legend(canvas, (left, 22.0), column);
                let mut y = top;
                for (row, limits) in self.rows.iter().zip(&self.limits) {
                    let lower = std::ptr::eq(row, &self.rows[1]);
                    let height = HEIGHTS[usize::from(lower)];
                    let axis_y = Axis::linear(row.label.clone(), limits.low, limits.high);
                    let panel = Panel { left, top: y, width, height, x: axis.clone(), y: axis_y };
                    panel.frame(canvas, lower, index == 0);
                    self.references(canvas, &panel, row, index + 1 == self.columns.len());
                    if self.by_speed {
                        canvas.within(&panel, |canvas| speeds(canvas, &panel, column, !lower));
                    }
                    self.panel(canvas, &panel, column, (row, limits));
                    y += height + 18.0;
                }
            }
        })
    }

    fn legend(&self, canvas: &mut Canvas, (left, y): Point, column: &Column<'_>) {
        canvas.text((left, y), &column.heading, Type::default().bold());
        for (index, curve) in column.curves.iter().enumerate() {
            let y = y + LINE * (index + 1) as f64;
            canvas.key(&curve.label, |canvas| {
                canvas.line((left, y - 4.5), (left + 24.0, y - 4.5), Stroke::solid(curve.color, 1.6));
                canvas.mark(curve.mark, (left + 12.0, y - 4.5), 3.4, curve.color, Stroke::solid(curve.color, 0.4));
                canvas.text((left + 30.0, y), &curve.label, Type { size: 13.0, ..Type::default() });
            });
        }
    }

    /// Lines of full sticking and full slip, named beside the last panel.
    fn references(&self, canvas: &mut Canvas, panel: &Panel, row: &Row, named: bool) {
        let stuck = row.stuck.map(|stuck| panel.py(row.unit.of(stuck)));
        let slip = panel.py(0.0);
        canvas.within(panel, |canvas| {
            if let Some(stuck) = stuck {
                canvas.line((panel.left, stuck), (panel.right(), stuck), Stroke::dashed(INK, 1.4, DASH_SLIP));
            }
            canvas.line((panel.left, slip), (panel.right(), slip), Stroke::solid(INK, 1.1));
        });
        if named {
            // Names keep apart where the lines do not; they have their place in the whole view only.
            let apart = stuck.map_or(0.0, |stuck| (0.5 * (18.0 - (slip - stuck))).max(0.0));
            let at = |y: f64| (panel.right() + 8.0, y + 5.0);
            canvas.ticks(panel, (false, false), |canvas| {
                if let Some(stuck) = stuck {
                    canvas.text(at(stuck - apart), row.names.0, Type { size: 14.0, ..Type::default() });
                }
                canvas.text(at(slip + apart), row.names.1, Type { size: 14.0, ..Type::default() });
            });
        }
    }

    fn panel(&self, canvas: &mut Canvas, panel: &Panel, column: &Column<'_>, (row, limits): (&Row, &Limits)) {
        let place = |p: &ContactPoint| (self.x(p), row.unit.of((row.value)(p)));
        let bar = |canvas: &mut Canvas, p: &ContactPoint, color, width| {
            let ((x, y), sd) = (place(p), row.unit.of((row.sd)(p)));
            panel.curve(canvas, &[(x, y - sd), (x, y + sd)], Stroke::solid(color, width));
        };
        let of_curve = |canvas: &mut Canvas, curve: &Curve, draw: &dyn Fn(&mut Canvas)| {
            canvas.series(&curve.label, |canvas| canvas.within(panel, draw));
        };
        for curve in &column.curves {
            of_curve(canvas, curve, &|canvas| {
                for p in curve.measured.iter().filter(|p| limits.vague(p, row)) {
                    bar(canvas, p, curve.color.faded(), 0.9);
                    mark(canvas, panel, place(p), (curve.mark, curve.color.faded()));
                }
            });
        }
        // A linear model without contact misses nothing at any point: its lines would only hide the marks.
        let linear = !self.c.model.has_contact && self.c.model.effects.is_empty();
        for (index, curve) in column.curves.iter().enumerate().filter(|_| !linear) {
            let line: Vec<Point> = curve.model.iter().map(|p| place(p)).collect();
            // The first ones wider: a line that later ones coincide with shows beside them.
            let after = column.curves.len() - 1 - index;
            let width = 1.4 + (1.3 * after as f64).min(WIDER * after as f64 / (column.curves.len() - 1).max(1) as f64);
            of_curve(canvas, curve, &|canvas| panel.curve(canvas, &line, Stroke::solid(curve.color, width)));
        }
        for curve in &column.curves {
            of_curve(canvas, curve, &|canvas| {
                let clear = || curve.measured.iter().filter(|p| !limits.vague(p, row));
                clear().for_each(|p| bar(canvas, p, curve.color, 1.1));
                for p in clear() {
                    mark(canvas, panel, place(p), (curve.mark, curve.color));
                }
            });
        }
        for (curve, p) in column.curves.iter().flat_map(|curve| curve.measured.iter().map(move |p| (curve, p))) {
            let color = if limits.vague(p, row) { curve.color.faded() } else { curve.color };
            let x = panel.px(self.x(p));
            let tip =
                |edge: f64, inwards: f64| [(x, edge), (x - 3.6, edge + 7.0 * inwards), (x + 3.6, edge + 7.0 * inwards)];
            let at = match limits.outside(p, row) {
                Some(Outside::Above) => tip(panel.top + 1.0, 1.0),
                Some(Outside::Below) => tip(panel.bottom() - 1.0, -1.0),
                None => continue,
            };
            of_curve(canvas, curve, &|canvas| canvas.polygon(&at, color, None));
        }
    }
}

/// A small mark without outline, where it lies on the panel.
fn mark(canvas: &mut Canvas, panel: &Panel, at: Point, (mark, color): (Mark, Color)) {
    let (x, y) = (panel.px(at.0), panel.py(at.1));
    if !(panel.top..=panel.bottom()).contains(&y) || !(panel.left..=panel.right()).contains(&x) {
        return;
    }
    let (r, h) = (3.1, 2.5);
    match mark {
        Mark::Circle => canvas.dot((x, y), 2.8, color),
        Mark::Square => canvas.rectangle((x - h, y - h), 2.0 * h, 2.0 * h, color, None),
        Mark::Triangle => canvas.polygon(&[(x, y - r), (x + r, y + 0.8 * r), (x - r, y + 0.8 * r)], color, None),
        Mark::Diamond => canvas.polygon(&[(x - r, y), (x, y - r), (x + r, y), (x, y + r)], color, None),
    }
}

/// Dotted lines at the speeds of the roller; those beyond the axis are named at its end.
fn speeds(canvas: &mut Canvas, panel: &Panel, column: &Column<'_>, named: bool) {
    let small = Type { size: 13.0, ..Type::default() };
    let place = |speed: f64| panel.px(Unit::speed().of(speed));
    let inside = |speed: f64| (panel.left..=panel.right()).contains(&place(speed));
    let mut moving: Vec<f64> = column.speeds.iter().copied().filter(|speed| *speed > 0.0).collect();
    // Names of those on the axis stand lowest, next to their lines.
    moving.sort_by_key(|speed| inside(*speed));
    for (index, &speed) in moving.iter().enumerate() {
        let x = place(speed);
        let beyond = match inside(speed) {
            true => None,
            false => Some(if x > panel.right() { "V = {} →" } else { "← V = {}" }),
        };
        if beyond.is_none() {
            canvas.line((x, panel.top), (x, panel.bottom()), Stroke::dashed(INK, 1.5, DOTS));
        }
        if named && index < SPEEDS {
            let text = beyond.unwrap_or("V = {}").replace("{}", &significant(Unit::speed().of(speed), 3));
            let width = text_width(&text, 13.0, false);
            let left = (x - 0.5 * width).clamp(panel.left, panel.right() - width);
            let lift = 6.0 + SPEED_LINE * (moving.len().min(SPEEDS).saturating_sub(index + 1)) as f64;
            if beyond.is_none() && lift > 6.0 {
                canvas.line((x, panel.top), (x, panel.top - lift + 4.0), Stroke::dashed(INK, 1.5, DOTS));
            }
            canvas.text((left, panel.top - lift), &text, small);
        }
    }
}

impl Contact {
    /// The drawing for a rig without contact.
    fn alone(&self, data: &Data<'_>) -> Result<Drawing, FigureError> {
        let (name, title) = if self.by_speed {
            ("missing-force-amplitude", "What the missing force must have done, against the amplitude")
        } else {
            ("missing-force", "What the missing force must have done")
        };
        let alt = format!(
            "Two rows of panels, stiffness above and damping below, against the {}: marks with error bars for the measurements, \
             lines for the model, and a line at zero.",
            if self.by_speed { "amplitude of the motion" } else { "frequency" },
        );
        let reading = if self.by_speed {
            [
                "Marks on the lines, and on zero where the linear rig is all there is.",
                "k that changes with the amplitude alike in all curves: a stiffness that is not linear. c that does: friction \
                 (falls), drag (rises). Curves that lie apart at one amplitude: not the amplitude but the frequency, the time or the \
                 drive decides.",
                "Read the law off: k in proportion to the square of the amplitude is a cubic stiffness, c in proportion to the \
                 amplitude a quadratic damping, c in proportion to 1 over it dry friction. Then `stickslip effects NAME`.",
            ]
        } else {
            [
                "Marks on the lines, and on zero where the linear rig is all there is.",
                "k that rises or falls with frequency alike in all curves: mass or stiffness is wrong in the rig, or another mode is \
                 near. Curves that part near the resonance: a force that is not linear.",
                "Free a number of the rig where all curves agree; where they part look at the same against the amplitude.",
            ]
        };
        let mut reading = reading;
        if data.c.model.effects.is_empty() {
            reading[0] = "Marks on zero: the linear rig is all there is.";
        }
        let svg = data.draw(title, &alt)?;
        let drawing = Drawing::new((name, title), (data.caption_alone(), alt), (svg, data.csv()), reading);
        Ok(Drawing { notes: data.notes_alone(), ..drawing })
    }
}

impl Figure<Comparison> for Contact {
    fn name(&self) -> &'static str {
        if self.by_speed { "contact-amplitude" } else { "contact-fingerprint" }
    }

    fn title(&self) -> &'static str {
        if self.by_speed { "What the contact did, against the arm's speed" } else { "What the contact must have done" }
    }

    fn reading(&self) -> [&'static str; 3] {
        if self.by_speed {
            [
                "Marks on the lines. At rest k is flat. A sliding contact stays at zero while bωα is below V, and rises where the \
                 arm begins to overtake the roller.",
                "A rise that comes earlier or later than the model's; k or c away from zero below V; a level at rest that \
                 changes with bωα.",
                "Force left below V: friction that depends on the slip rate, or a contact that takes a distance to renew. \
                 A level at rest that follows bωα: stiffness or damping that depends on amplitude, or partial slip.",
            ]
        } else {
            [
                "Marks on the lines. Without an effect in the contact, k and c of a stuck one are level with the dashed lines, of a \
                 slipping one at zero.",
                "k that rises or falls with frequency everywhere, at rest too: mass or stiffness is missing in the rig or the \
                 contact. k above zero in slip: friction that is not Coulomb's.",
                "Find the conditions in which marks and lines part. At rest: the material or the rig. In slip: the law of \
                 friction. Then compare with the fingerprints in the atlas, or with what `stickslip effects NAME` tells.",
            ]
        }
    }

    fn draw(&self, comparison: &Comparison) -> Result<Drawing, FigureError> {
        if comparison.contact.is_empty() {
            return Err(FigureError::missing(self.name(), "measured phases"));
        }
        let data = Data::of(comparison, self.by_speed);
        if !comparison.model.has_contact {
            return self.alone(&data);
        }
        let alt = format!(
            "Two rows of panels, stiffness and damping of the contact {}, in {} by speed: marks with error bars for the \
             measurements, lines for the model, and lines at full stick and full slip.",
            if self.by_speed { "against the arm's speed amplitude" } else { "against frequency" },
            count(data.columns.len(), "column")
        );
        let svg = data.draw(self.title(), &alt)?;
        let drawing = Drawing::of(self, (data.caption(), alt), (svg, data.csv()), data.notes());
        Ok(drawing.told_of(&comparison.scenario))
    }
}
