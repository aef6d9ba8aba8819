//! Measured and modelled resonance peaks, one row per condition: where and how high.

use super::words::{self, Amplitude};

use crate::compare::{Comparison, ConditionMetrics, Peak};
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::legend::Key;
use crate::figures::marks::Mark;
use crate::figures::style::{GREY, GRID, INK, STATIC, Table, WHITE, WIDTH, cell, count, significant, text_width};
use crate::figures::{Drawing, Figure, FigureError};

const TOP: f64 = 48.0;
const GAP: f64 = 34.0;

/// The figure.
pub struct Peaks;

struct Data<'a> {
    shown: Vec<&'a ConditionMetrics>,
    all: &'a [ConditionMetrics],
    amplitude: Amplitude,
    row: f64,
}

impl<'a> Data<'a> {
    fn of(c: &'a Comparison) -> Self {
        let (indices, _) = words::shown(c);
        let shown: Vec<_> = indices.into_iter().map(|i| &c.conditions[i]).collect();
        let row = (400.0 / shown.len().max(1) as f64).clamp(22.0, 44.0);
        Self { shown, all: &c.conditions, amplitude: Amplitude::of(c), row }
    }

    /// Frequency and height of the measured and the modelled peak, as shown.
    fn values(&self, condition: &ConditionMetrics) -> [Option<[f64; 2]>; 2] {
        let show = |peak: Peak| [peak.frequency_hz, self.amplitude.value(peak.amplitude, &condition.setting)];
        [condition.measured_peak.map(show), condition.model_peak.map(show)]
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let labels: Vec<String> = self.shown.iter().map(|condition| words::brief(&condition.setting)).collect();
        let left = labels.iter().map(|label| text_width(label, 14.0, false)).fold(0.0, f64::max) + 40.0;
        let width = 0.5 * (WIDTH - left - GAP - 30.0);
        let height = self.row * labels.len() as f64;
        let ends = |side: usize| {
            let values = self.shown.iter().flat_map(|condition| self.values(condition)).flatten();
            let (low, high) = crate::figures::axes::range(values.map(|value| value[side]));
            let margin = 0.06 * (high - low);
            (low - margin, high + margin)
        };
        let names = ["peak frequency [Hz]".to_string(), format!("peak {}", self.amplitude.label())];
        document((WIDTH, TOP + height + 62.0), (title, alt), |canvas| {
            let entries = [
                (Key::Mark(Mark::Circle, INK, true), "measured".to_string()),
                (Key::Mark(Mark::Diamond, STATIC, false), "model".into()),
            ];
            for (index, entry) in entries.iter().enumerate() {
                crate::figures::legend::legend(canvas, left + 150.0 * index as f64, 2.0, std::slice::from_ref(entry));
            }
            for (side, name) in names.iter().enumerate() {
                let (low, high) = ends(side);
                let x = Axis::linear(name.clone(), low, high);
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
        for (index, condition) in self.shown.iter().enumerate() {
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
        for (index, condition) in self.shown.iter().enumerate() {
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
        let header = [
            "speed [m/s]",
            "load [N]",
            "drive [m]",
            "measured peak [Hz]",
            "measured height [rad]",
            "model peak [Hz]",
            "model height [rad]",
        ];
        let mut table = Table::new(&header);
        for condition in self.all {
            let s = condition.setting;
            let numbers = |peak: Option<Peak>| peak.map_or([f64::NAN; 2], |p| [p.frequency_hz, p.amplitude]);
            let [a, b] = [numbers(condition.measured_peak), numbers(condition.model_peak)];
            table.row([s.speed, s.load, s.drive, a[0], a[1], b[0], b[1]].map(cell));
        }
        table.finish()
    }

    /// The largest differences, over the conditions that have both peaks.
    fn notes(&self) -> Vec<(String, String)> {
        let both = || self.all.iter().filter_map(|c| Some((c.model_peak?, c.measured_peak?, &c.setting)));
        let shift = both().map(|(a, b, s)| (a.frequency_hz - b.frequency_hz, s));
        let height = both().map(|(a, b, s)| (100.0 * (a.amplitude / b.amplitude - 1.0), s));
        let largest = |values: &mut dyn Iterator<Item = (f64, &'a crate::compare::Setting)>, unit: &str| {
            let worst = values.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            worst.map_or_else(
                || "–".into(),
                |(value, setting)| {
                    let sign = if value > 0.0 { "+" } else { "" };
                    format!("{sign}{} {unit} at {}", significant(value, 2), words::condition(setting))
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
            "Frequency (left) and height (right) of the resonance peak, one row per condition (speed V, load W, drive u₀): measured \
             (filled) and of the model (open), each by a parabola through the logarithms of the readings around the largest one.{}",
            words::shown(comparison).1
        );
        let alt = format!(
            "Dumbbell chart with {}: measured and modelled peak frequency on the left, peak height on the right, joined by a line.",
            count(data.shown.len(), "row")
        );
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), data.notes()))
    }
}
