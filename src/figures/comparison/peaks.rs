//! Measured and modelled resonance peaks, one row per condition: where and how high.

use super::words::{self, Amplitude, cells_of_condition, columns_of_condition};

use crate::compare::{Comparison, ConditionMetrics, Peak};
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::legend::Key;
use crate::figures::marks::Mark;
use crate::figures::style::{
    GAP, GREY, GRID, INK, STATIC, TOP, Table, WHITE, WIDTH, cell, count, significant, text_width,
};
use crate::figures::{Drawing, Figure, FigureError};

/// What bad looks like and what to do where there is no contact.
const ALONE: [&str; 2] = [
    "Lines between the marks of one row: the length is the error. The same shift in all rows is a stiffness or a mass of the rig; \
     one that grows from row to row with the drive is a force that is not linear.",
    "A common shift: free a parameter of the rig in [fit]. Otherwise see whether frequency and height follow the amplitude.",
];

/// The figure.
pub struct Peaks;

struct Data<'a> {
    c: &'a Comparison,
    shown: Vec<usize>,
    amplitude: Amplitude,
    row: f64,
}

impl<'a> Data<'a> {
    fn of(c: &'a Comparison) -> Self {
        let (shown, _) = words::shown(c);
        let row = (400.0 / shown.len().max(1) as f64).clamp(22.0, 44.0);
        Self { c, shown, amplitude: Amplitude::of(c), row }
    }

    /// Frequency and height of the measured and the modelled peak of a condition, as shown.
    fn values(&self, condition: usize) -> [Option<[f64; 2]>; 2] {
        let condition = &self.c.conditions[condition];
        let show = |peak: Peak| [peak.frequency_hz, self.amplitude.value(peak.amplitude, condition.setting.drive)];
        [condition.measured_peak.map(show), condition.model_peak.map(show)]
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let labels: Vec<String> = self.shown.iter().map(|&condition| words::brief(self.c, condition)).collect();
        let left = labels.iter().map(|label| text_width(label, 14.0, false)).fold(0.0, f64::max) + 40.0;
        let width = 0.5 * (WIDTH - left - GAP - 30.0);
        let height = self.row * labels.len() as f64;
        let ends = |side: usize| {
            let values = self.shown.iter().flat_map(|&condition| self.values(condition)).flatten();
            let (low, high) = crate::figures::axes::range(values.map(|value| value[side]));
            let margin = 0.06 * (high - low);
            (low - margin, high + margin)
        };
        let axis = |side: usize, (low, high): (f64, f64)| match side {
            0 => Axis::frequency("peak frequency", low, high),
            _ => Axis::linear(format!("peak {}", self.amplitude.label()), low, high),
        };
        document((WIDTH, TOP + height + 62.0), (title, alt), |canvas| {
            let entries = [
                (Key::Mark(Mark::Circle, INK, true), "measured".to_string()),
                (Key::Mark(Mark::Diamond, STATIC, false), "model".into()),
            ];
            for (index, entry) in entries.iter().enumerate() {
                crate::figures::legend::legend(canvas, left + 150.0 * index as f64, 2.0, std::slice::from_ref(entry));
            }
            for side in 0..2 {
                let x = axis(side, ends(side));
                let y = Axis::rows();
                let panel = Panel { left: left + (width + GAP) * side as f64, top: TOP, width, height, x, y };
                self.panel(canvas, &panel, side);
            }
            for (index, label) in labels.iter().enumerate() {
                let at = (left - 10.0, TOP + self.row * (index as f64 + 0.5) + 5.0);
                canvas.text(at, label, Type { size: 14.0, ..Type::at(Anchor::End) });
            }
        })
    }

    fn panel(&self, canvas: &mut Canvas, panel: &Panel, side: usize) {
        panel.frame(canvas, true, false);
        canvas.within(panel, |canvas| self.joins(canvas, panel, side));
        for (shown, name) in [(1, "model"), (0, "measured")] {
            canvas.series(name, |canvas| canvas.within(panel, |canvas| self.marks(canvas, panel, side, shown)));
        }
    }

    /// Marks of the measured (0) or the modelled (1) peaks.
    fn marks(&self, canvas: &mut Canvas, panel: &Panel, side: usize, shown: usize) {
        for (index, &condition) in self.shown.iter().enumerate() {
            let Some(value) = self.values(condition)[shown] else { continue };
            let at = (panel.px(value[side]), TOP + self.row * (index as f64 + 0.5));
            match shown {
                0 => canvas.dot(at, 4.2, INK),
                _ => canvas.mark(Mark::Diamond, at, 6.0, WHITE, Stroke::solid(STATIC, 2.0)),
            }
        }
    }

    /// Lines along the rows, and between the two marks of each.
    fn joins(&self, canvas: &mut Canvas, panel: &Panel, side: usize) {
        for (index, &condition) in self.shown.iter().enumerate() {
            let y = TOP + self.row * (index as f64 + 0.5);
            canvas.line((panel.left, y), (panel.right(), y), Stroke::solid(GRID, 1.0));
            let values = self.values(condition);
            let [measured, model] = values.map(|value| value.map(|value| panel.px(value[side])));
            if let (Some(a), Some(b)) = (measured, model) {
                canvas.line((a, y), (b, y), Stroke::solid(GREY, 2.4));
            }
            if measured.is_none() && model.is_none() {
                let words = Type { size: 13.0, color: GREY, ..Type::at(Anchor::Middle) };
                canvas.text((panel.left + 0.5 * panel.width, y - 2.0), "no peak inside the measured range", words);
            }
        }
    }

    fn csv(&self) -> String {
        let signals = &self.c.table.signals;
        let [measured, model] = ["measured", "model"].map(|whose| format!("{whose} height [{}]", signals.reading.unit));
        let mut header = columns_of_condition(self.c);
        header.extend(["measured peak [Hz]".into(), measured, "model peak [Hz]".into(), model]);
        let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
        for (index, condition) in self.c.conditions.iter().enumerate() {
            let numbers = |peak: Option<Peak>| peak.map_or([f64::NAN; 2], |p| [p.frequency_hz, p.amplitude]);
            let [a, b] = [numbers(condition.measured_peak), numbers(condition.model_peak)];
            let cells = [a[0], a[1], b[0], b[1]].map(cell);
            table.row(cells_of_condition(self.c, index).into_iter().chain(cells));
        }
        table.finish()
    }

    /// The largest differences, over the conditions that have both peaks.
    fn notes(&self) -> Vec<(String, String)> {
        let all = || self.c.conditions.iter().enumerate();
        let both = || all().filter_map(|(i, c)| Some((c.model_peak?, c.measured_peak?, i)));
        let shift = both().map(|(a, b, s)| (a.frequency_hz - b.frequency_hz, s));
        let height = both().map(|(a, b, s)| (100.0 * (a.amplitude / b.amplitude - 1.0), s));
        let largest = |values: &mut dyn Iterator<Item = (f64, usize)>, unit: &str| {
            let worst = values.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            worst.map_or_else(
                || "–".into(),
                |(value, index)| {
                    let sign = if value > 0.0 { "+" } else { "" };
                    format!("{sign}{} {unit} at {}", significant(value, 2), words::condition(self.c, index))
                },
            )
        };
        vec![
            ("Largest error of the peak's frequency".into(), largest(&mut shift.into_iter(), "Hz")),
            ("Largest error of its height".into(), largest(&mut height.into_iter(), "%")),
        ]
    }
}

impl Figure<Comparison> for Peaks {
    fn name(&self) -> &'static str {
        "peaks"
    }

    fn title(&self) -> &'static str {
        "Resonance peaks, measured and modelled"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Open marks around filled ones in every row.",
            "Lines between the marks of one row: the length is the error. The same shift in all rows is a stiffness or an \
             inertia of the rig; one that changes from row to row is the contact.",
            "A common shift: free a parameter of the rig in [fit]. Otherwise see which of V, W and u₀ the shift follows.",
        ]
    }

    fn draw(&self, comparison: &Comparison) -> Result<Drawing, FigureError> {
        let has_peak = |c: &ConditionMetrics| c.measured_peak.is_some() || c.model_peak.is_some();
        if !comparison.conditions.iter().any(has_peak) {
            return Err(FigureError::missing(self.name(), "a resonance peak inside the measured range"));
        }
        let data = Data::of(comparison);
        let caption = format!(
            "Frequency (left) and height (right) of the resonance peak, one row per {}: measured \
             (filled) and of the model (open), each by a parabola through the logarithms of the readings around the largest one.{}",
            words::row(comparison),
            words::shown(comparison).1
        );
        let alt = format!(
            "Dumbbell chart with {}: measured and modelled peak frequency on the left, peak height on the right, joined by a line.",
            count(data.shown.len(), "row")
        );
        let svg = data.draw(self.title(), &alt)?;
        let mut drawing = Drawing::of(self, (caption, alt), (svg, data.csv()), data.notes());
        if !comparison.model.has_contact {
            drawing.reading[1..].clone_from_slice(&ALONE.map(String::from));
        } else if !comparison.table.signals.of_arm() {
            let symbol = comparison.table.signals.drive.symbol;
            drawing.reading[2] = drawing.reading[2].replace("u₀", symbol);
        }
        Ok(drawing)
    }
}
