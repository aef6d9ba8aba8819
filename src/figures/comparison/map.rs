//! Where the model fails: errors over condition and frequency, amplitude and phase side by side.

use super::sigma::Sigma;
use super::words;

use crate::compare::{Compared, Comparison};
use crate::figures::axes::{Axis, Panel, Scale};
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::style::{Color, GREY, INK, Table, WIDTH, cell, count, diverging, significant};
use crate::figures::{Drawing, Figure, FigureError};

/// Shades of the colour scale on either side of zero.
const SHADES: f64 = 24.0;
const TOP: f64 = 40.0;
const GAP: f64 = 26.0;
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
        let rows = self.labels.len();
        let height = self.row * rows as f64;
        let widest = self.labels.iter().map(|l| crate::figures::style::text_width(l, 14.0, false)).fold(0.0, f64::max);
        let (left, n) = (widest + 40.0, self.maps.len() as f64);
        let width = (WIDTH - left - SCALE - GAP * n) / n;
        let edges = (0..rows).flat_map(|i| self.cells(i, self.maps[0].1)).flat_map(|(a, b, _)| [a, b]);
        let (low, high) = crate::figures::axes::range(edges);
        let bar = height.max(120.0);
        document((WIDTH, TOP + bar + 62.0), (title, alt), |canvas| {
            for (index, (name, of)) in self.maps.iter().enumerate() {
                let x = Axis::frequency("frequency f", low, high);
                let y = Axis::linear("", rows as f64, 0.0);
                let y = Axis { low: rows as f64, high: 0.0, scale: Scale::Rows, ..y };
                let panel = Panel { left: left + (width + GAP) * index as f64, top: TOP, width, height, x, y };
                canvas.areas(&panel, |canvas| self.map(canvas, &panel, *of));
                let frame = Panel { y: Axis::rows(), ..panel.clone() };
                frame.border(canvas, 1.0);
                panel.heading(canvas, name);
                panel.labels(canvas, true, false);
            }
            for (index, label) in self.labels.iter().enumerate() {
                let at = (left - 10.0, TOP + self.row * (index as f64 + 0.5) + 5.0);
                canvas.text(at, label, Type { size: 14.0, ..Type::at(Anchor::End) });
            }
            self.bar(canvas, WIDTH - SCALE + 6.0, bar);
        })
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

    fn bar(&self, canvas: &mut Canvas, left: f64, height: f64) {
        let steps = (2.0 * SHADES) as usize + 1;
        let step = height / steps as f64;
        let y = self.scale.axis("error [σ]");
        let panel = Panel { left, top: TOP, width: 18.0, height, x: Axis::linear("", 0.0, 1.0), y };
        canvas.color_bar(&panel, |canvas| {
            for i in 0..steps {
                let color = diverging(1.0 - i as f64 / SHADES);
                canvas.rectangle((left, TOP + step * i as f64), 18.0, step + 0.3, color, None);
            }
        });
        let frame = [(left, TOP), (left + 18.0, TOP), (left + 18.0, TOP + height), (left, TOP + height), (left, TOP)];
        canvas.polyline(&frame, Stroke::solid(GREY, 1.0));
        let mut last = f64::INFINITY;
        let ticks = self.scale.ticks();
        let ends = [-self.scale.limit, self.scale.limit];
        let all: Vec<f64> = ticks.iter().rev().map(|t| -t).chain([0.0]).chain(ticks.iter().copied()).collect();
        for tick in [ends[0]].into_iter().chain(all).chain([ends[1]]) {
            let y = TOP + 0.5 * height * (1.0 - self.scale.place(tick));
            canvas.line((left + 18.0, y), (left + 23.0, y), Stroke::solid(INK, 1.0));
            // The ends are named, and of the others those whose names touch no other.
            let end = ends.contains(&tick) && last != y;
            if !end && (last - y < 15.0 || y - TOP < 15.0) {
                continue;
            }
            last = y;
            let sign = if tick > 0.0 { "+" } else { "" };
            canvas.text(
                (left + 27.0, y + 5.0),
                &format!("{sign}{} σ", significant(tick, 3)),
                Type { size: 13.5, ..Type::default() },
            );
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
        "Where the model fails"
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
            [one] => format!("The outline marks the one range where the misfit is no chance: {}.", one.sentence),
            [first, ..] => format!(
                "Outlines mark the {} ranges where the misfit is no chance, the worst being: {}.",
                comparison.regions.len(),
                first.sentence
            ),
        };
        let both = if data.maps.len() > 1 { " (left) and phase (right)" } else { "" };
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
        let svg = data.draw(self.title(), &alt)?;
        let largest = comparison.points.iter().map(|p| p.amplitude_residual.abs()).fold(0.0, f64::max);
        let notes = vec![
            ("Ranges of misfit".to_string(), comparison.regions.len().to_string()),
            ("Largest error of an amplitude".to_string(), format!("{} σ", significant(largest, 3))),
        ];
        let mut drawing = Drawing::of(self, (caption, alt), (svg, data.csv()), notes);
        if !comparison.model.has_contact {
            drawing.reading[2] = ALONE.into();
        }
        Ok(drawing)
    }
}
