//! Where the model fails: errors over condition and frequency, amplitude and phase side by side, or one below the other.

use super::sigma::Sigma;
use super::stack::WIDTH as NARROW;
use super::words;

use crate::compare::{Compared, Comparison};
use crate::figures::axes::{Axis, Panel, Scale, range};
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::style::{Color, GREY, INK, TOP, Table, WIDTH, cell, count, diverging, significant, text_width};
use crate::figures::{Drawing, Figure, FigureError};

/// Shades of the colour scale on either side of zero.
const SHADES: f64 = 24.0;
const GAP: f64 = 26.0;
/// Below a map: its frequencies and their name \[px\].
const FOOT: f64 = 62.0;
/// Of the colour scale, across \[px\].
const THICK: f64 = 18.0;
/// Height of a row on a narrow screen at most \[px\].
const LOW: f64 = 22.0;
/// Of a lying scale, beside either end: half the name of it \[px\].
const SCALE_END: f64 = 40.0;
/// Right of the maps: the colour scale with its labels.
const SCALE: f64 = 96.0;

/// What to do where there is no contact.
const ALONE: &str = "Note whether all rows fail or those of strong drives, and look for an effect that acts there.";

/// The figure.
pub struct MisfitMap;

type Residual = fn(&Compared) -> Option<f64>;

struct Data<'a> {
    c: &'a Comparison,
    maps: Vec<(&'static str, Residual)>,
    scale: Sigma,
    labels: Vec<String>,
    row: f64,
}

impl<'a> Data<'a> {
    fn of(c: &'a Comparison) -> Self {
        let mut maps: Vec<(&'static str, Residual)> = vec![("Amplitude", |p| Some(p.amplitude_residual))];
        if c.points.iter().any(|p| p.phase_residual.is_some()) {
            maps.push(("Phase", |p| p.phase_residual));
        }
        let residuals = maps.iter().flat_map(|(_, of)| c.points.iter().filter_map(of));
        let rows = c.conditions.len() as f64;
        Self {
            c,
            scale: Sigma::over(residuals),
            maps,
            labels: (0..c.conditions.len()).map(|condition| words::brief(c, condition)).collect(),
            row: (420.0 / rows.max(1.0)).clamp(17.0, 40.0),
        }
    }

    /// Frequencies between which the cell of each point of a condition reaches, as (row, from, to, residual).
    fn cells(&self, condition: usize, of: Residual) -> Vec<(f64, f64, f64)> {
        let points: Vec<&Compared> = self.c.points.iter().filter(|p| p.condition == condition).collect();
        let f = |i: usize| points[i].point.frequency;
        let n = points.len();
        let half = |i: usize, j: usize| 0.5 * (f(i) + f(j));
        let alone = if self.c.table.signals.of_arm() { 0.5 } else { 0.01 * f(0) };
        let edges = |i: usize| {
            let (before, after) = match (i > 0, i + 1 < n) {
                (true, true) => (half(i - 1, i), half(i, i + 1)),
                (true, false) => (half(i - 1, i), 2.0 * f(i) - half(i - 1, i)),
                (false, true) => (2.0 * f(i) - half(i, i + 1), half(i, i + 1)),
                (false, false) => (f(i) - alone, f(i) + alone),
            };
            (before, after)
        };
        (0..n).filter_map(|i| of(points[i]).map(|r| (edges(i).0, edges(i).1, r))).collect()
    }

    fn color(&self, residual: f64) -> Color {
        diverging((SHADES * self.scale.place(residual)).round() / SHADES)
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let (left, n) = (self.widest() + 40.0, self.maps.len() as f64);
        let width = (WIDTH - left - SCALE - GAP * n) / n;
        let height = self.height();
        let bar = height.max(120.0);
        document((WIDTH, TOP + bar + FOOT), (title, alt), |canvas| {
            for index in 0..self.maps.len() {
                self.part(canvas, index, (left + (width + GAP) * index as f64, TOP, width), true);
            }
            self.rows(canvas, left, TOP);
            self.bar(canvas, (WIDTH - SCALE + 6.0, TOP), bar, false);
        })
    }

    /// The maps one below the other over a lying colour scale, for a narrow screen; nothing where the names of the rows
    /// leave them no room.
    fn narrow(mut self, title: &str, alt: &str) -> Result<Option<String>, FigureError> {
        let left = self.widest() + 20.0;
        let width = NARROW - left - 20.0;
        if width < 0.4 * NARROW {
            return Ok(None);
        }
        self.row = self.row.min(LOW);
        let (height, last) = (self.height(), self.maps.len() - 1);
        let below = TOP + (height + TOP) * last as f64 + height + FOOT;
        let drawn = document((NARROW, below + 48.0), (title, alt), |canvas| {
            for index in 0..=last {
                let top = TOP + (height + TOP) * index as f64;
                self.part(canvas, index, (left, top, width), index == last);
                self.rows(canvas, left, top);
            }
            self.bar(canvas, (SCALE_END, below), NARROW - 2.0 * SCALE_END, true);
        })?;
        Ok(Some(drawn))
    }

    /// Width of the longest name of a row.
    fn widest(&self) -> f64 {
        self.labels.iter().map(|l| text_width(l, 14.0, false)).fold(0.0, f64::max)
    }

    /// Height of a map.
    fn height(&self) -> f64 {
        self.row * self.labels.len() as f64
    }

    /// One map with its heading, its frequencies named or not; left edge, upper edge and width.
    fn part(&self, canvas: &mut Canvas, index: usize, (left, top, width): (f64, f64, f64), named: bool) {
        let (name, of) = self.maps[index];
        let rows = self.labels.len();
        let edges = (0..rows).flat_map(|i| self.cells(i, self.maps[0].1)).flat_map(|(a, b, _)| [a, b]);
        let (low, high) = range(edges);
        let x = Axis::frequency("frequency f", low, high);
        let y = Axis { low: rows as f64, high: 0.0, scale: Scale::Rows, ..Axis::linear("", rows as f64, 0.0) };
        let panel = Panel { left, top, width, height: self.height(), x, y };
        canvas.areas(&panel, |canvas| self.map(canvas, &panel, of));
        let frame = Panel { y: Axis::rows(), ..panel.clone() };
        frame.border(canvas, 1.0);
        panel.heading(canvas, name);
        if named {
            panel.labels(canvas, true, false);
        }
    }

    /// The names of the rows, left of a map.
    fn rows(&self, canvas: &mut Canvas, left: f64, top: f64) {
        for (index, label) in self.labels.iter().enumerate() {
            let at = (left - 10.0, top + self.row * (index as f64 + 0.5) + 5.0);
            canvas.text(at, label, Type { size: 14.0, ..Type::at(Anchor::End) });
        }
    }

    fn map(&self, canvas: &mut Canvas, panel: &Panel, of: Residual) {
        let y = |row: usize| panel.top + self.row * row as f64;
        let mut cells: Vec<(Color, usize, f64, f64)> = Vec::new();
        for row in 0..self.labels.len() {
            cells.extend(self.cells(row, of).into_iter().map(|(from, to, r)| (self.color(r), row, from, to)));
        }
        // Alike side by side, which takes less room in the file.
        cells.sort_by_key(|(Color(r, g, b), row, ..)| (*r, *g, *b, *row));
        canvas.rectangle((panel.left, panel.top), panel.width, panel.height, Color(0xd5, 0xd5, 0xd5), None);
        for (color, row, from, to) in cells {
            let (from, to) = (panel.px(from), panel.px(to));
            // A little wider, so that no seam shows between neighbours.
            canvas.rectangle((from, y(row)), to - from + 0.3, self.row, color, None);
        }
        for row in 1..self.labels.len() {
            canvas.line((panel.left, y(row)), (panel.right(), y(row)), Stroke::solid(Color(0xff, 0xff, 0xff), 2.0));
        }
        for region in &self.c.regions {
            let inside: Vec<_> = self
                .cells(region.condition, |_| Some(0.0))
                .into_iter()
                .filter(|(from, to, _)| {
                    let middle = 0.5 * (from + to);
                    let near = 1e-9 * middle;
                    middle > region.frequency_from_hz - near && middle < region.frequency_to_hz + near
                })
                .collect();
            let (Some(first), Some(last)) = (inside.first(), inside.last()) else { continue };
            let (l, r) = (panel.px(first.0) + 1.0, panel.px(last.1) - 1.0);
            let (t, b) = (y(region.condition) + 2.0, y(region.condition + 1) - 2.0);
            canvas.polyline(&[(l, t), (r, t), (r, b), (l, b), (l, t)], Stroke::solid(INK, 1.6));
        }
    }

    /// The colour scale, from its lower left or upper left corner on, upright or lying.
    fn bar(&self, canvas: &mut Canvas, (left, top): (f64, f64), length: f64, lying: bool) {
        let steps = (2.0 * SHADES) as usize + 1;
        let step = length / steps as f64;
        let (errors, across) = (self.scale.axis("error [σ]"), Axis::linear("", 0.0, 1.0));
        let (x, y) = if lying { (errors, across) } else { (across, errors) };
        let (width, height) = if lying { (length, THICK) } else { (THICK, length) };
        let panel = Panel { left, top, width, height, x, y };
        canvas.color_bar(&panel, |canvas| {
            for i in 0..steps {
                // As a cell has it, to the last digit: the colour is looked up.
                let (at, shade) = (step * i as f64, (SHADES - i as f64) / SHADES);
                if lying {
                    canvas.rectangle((left + at, top), step + 0.3, THICK, diverging(-shade), None);
                } else {
                    canvas.rectangle((left, top + at), THICK, step + 0.3, diverging(shade), None);
                }
            }
        });
        let (right, bottom) = (left + width, top + height);
        let frame = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        canvas.polyline(&frame, Stroke::solid(GREY, 1.0));
        // Room that a name takes along the scale.
        let room = if lying { 46.0 } else { 15.0 };
        let mut last = f64::NEG_INFINITY;
        let ticks = self.scale.ticks();
        let ends = [-self.scale.limit, self.scale.limit];
        let all: Vec<f64> = ticks.iter().rev().map(|t| -t).chain([0.0]).chain(ticks.iter().copied()).collect();
        for tick in [ends[0]].into_iter().chain(all).chain([ends[1]]) {
            let along = 0.5 * length * (1.0 + self.scale.place(tick));
            let place = |by: f64| if lying { (left + along, bottom + by) } else { (right + by, bottom - along) };
            canvas.line(place(0.0), place(5.0), Stroke::solid(INK, 1.0));
            // The ends are named, and of the others those whose names touch no other.
            let end = ends.contains(&tick) && last != along;
            if !end && (along - last < room || length - along < room) {
                continue;
            }
            last = along;
            let sign = if tick > 0.0 { "+" } else { "" };
            let name = format!("{sign}{} σ", significant(tick, 3));
            let ((x, y), anchor) = if lying { (place(20.0), Anchor::Middle) } else { (place(9.0), Anchor::Start) };
            let y = if lying { y } else { y + 5.0 };
            canvas.text((x, y), &name, Type { size: 13.5, ..Type::at(anchor) });
        }
    }

    fn csv(&self) -> String {
        let mut header = words::columns_of_condition(self.c);
        header.extend(["frequency [Hz]", "amplitude error [sigma]", "phase error [sigma]"].map(String::from));
        let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
        for p in &self.c.points {
            let phase = p.phase_residual.unwrap_or(f64::NAN);
            let cells = [p.point.frequency, p.amplitude_residual, phase].map(cell);
            table.row(words::cells_of_condition(self.c, p.condition).into_iter().chain(cells));
        }
        table.finish()
    }
}

impl Figure<Comparison> for MisfitMap {
    fn name(&self) -> &'static str {
        "misfit-map"
    }

    fn title(&self) -> &'static str {
        "Errors by condition and frequency"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Pale cells without pattern.",
            "Blocks of one colour, or blue beside red: a resonance at the wrong place. Rows that fail alike share a cause.",
            "Note whether the failing rows share the speed, the load or the drive, and look for an effect that acts there.",
        ]
    }

    fn draw(&self, comparison: &Comparison) -> Result<Drawing, FigureError> {
        let data = Data::of(comparison);
        let regions = match comparison.regions.as_slice() {
            [] => "No range of frequencies has a misfit that noise would not have.".into(),
            [one] => {
                format!("The outline marks the one range where the misfit is not due to chance: {}.", one.sentence)
            }
            [first, ..] => format!(
                "Outlines mark the {} ranges where the misfit is not due to chance, the worst being: {}.",
                comparison.regions.len(),
                first.sentence
            ),
        };
        let both = if data.maps.len() > 1 { " and of the phase" } else { "" };
        let caption = format!(
            "Error of the amplitude{both}, one row per {} and one cell per reading: red where the model is \
             too high or ahead, blue where it is too low or behind. {} {regions}",
            words::row(comparison),
            data.scale.sentence()
        );
        let alt = format!(
            "Heat map of errors in standard deviations, {} by frequency; red is too high, blue too low, {}.",
            count(data.labels.len(), "row"),
            count(comparison.regions.len(), "outlined range")
        );
        let (svg, csv) = (data.draw(self.title(), &alt)?, data.csv());
        let largest = comparison.points.iter().map(|p| p.amplitude_residual.abs()).fold(0.0, f64::max);
        let notes = vec![
            ("Ranges of misfit".to_string(), comparison.regions.len().to_string()),
            ("Largest error of an amplitude".to_string(), format!("{} σ", significant(largest, 3))),
        ];
        let narrow = data.narrow(self.title(), &alt)?;
        let mut drawing = Drawing::of(self, (caption, alt), (svg, csv), notes);
        drawing.narrow = narrow;
        if !comparison.model.has_contact {
            drawing.reading[2] = ALONE.into();
        }
        Ok(drawing)
    }
}
