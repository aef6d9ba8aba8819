//! How often 95 % intervals hold the truth, by parameter.

use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Anchor, Stroke, Type, document};
use crate::figures::style::{DOTS, GREY, INK, SLIP, STATIC, Table, WIDTH, cell, count, text_width};
use crate::figures::{Drawing, Figure, FigureError};
use crate::trial::{Coverage, Proportion, Summary};

const SIZE: f64 = 13.0;
const ROW: f64 = 20.0;
const TOP: f64 = 34.0;

/// The figure.
pub struct Intervals;

fn draw(rows: &[(String, Proportion)], title: &str, alt: &str) -> Result<String, FigureError> {
    let widest =
        |texts: &mut dyn Iterator<Item = &str>| texts.map(|text| text_width(text, SIZE, false)).fold(0.0, f64::max);
    let numbers: Vec<String> = rows.iter().map(|(_, p)| format!("{} of {}", p.successes, p.of)).collect();
    let left = widest(&mut rows.iter().map(|(key, _)| key.as_str())) + 30.0;
    let right = widest(&mut numbers.iter().map(String::as_str)) + 24.0;
    let (width, height) = (WIDTH - left - right, ROW * rows.len() as f64);
    document((WIDTH, TOP + height + 62.0), (title, alt), |canvas| {
        // Dots, not bars from zero: the axis begins where there is something to see.
        let lowest = rows.iter().map(|(_, p)| 10.0 * (10.0 * p.low).floor()).fold(80.0, f64::min);
        let x = Axis::linear("share of the 95 % intervals that hold the truth [%]", lowest, 100.0).step(10.0);
        let y = Axis::linear("", 0.2, 0.8).step(2.0);
        let panel = Panel { left, top: TOP, width, height, x, y };
        panel.frame(canvas, true, false);
        let nominal = panel.px(95.0);
        canvas.line((nominal, TOP), (nominal, TOP + height), Stroke::dashed(GREY, 1.6, DOTS));
        canvas.text((nominal, TOP - 8.0), "95 %", Type { size: SIZE, color: GREY, ..Type::at(Anchor::Middle) });
        for (index, (key, p)) in rows.iter().enumerate() {
            let y = TOP + ROW * (index as f64 + 0.5);
            let bold = index == 0;
            canvas.text((left - 10.0, y + 5.0), key, Type { size: SIZE, bold, ..Type::at(Anchor::End) });
            let color = if p.high < 0.95 { SLIP } else { STATIC };
            let (a, b) = (panel.px(100.0 * p.low), panel.px(100.0 * p.high));
            canvas.line((a, y), (b, y), Stroke::solid(color, if bold { 4.0 } else { 2.4 }));
            canvas.dot((panel.px(100.0 * p.share.unwrap_or(0.0)), y), 4.2, INK);
            canvas.text((left + width + 10.0, y + 5.0), &numbers[index], Type { size: SIZE, ..Type::default() });
        }
    })
}

impl Figure<Summary> for Intervals {
    fn name(&self) -> &'static str {
        "coverage"
    }

    fn title(&self) -> &'static str {
        "How often the intervals hold the truth"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Every bar reaches over the dotted line.",
            "Bars that end left of it: intervals that promise too much.",
            "Look for parameters tied together, and for a solver whose errors are not small against the noise.",
        ]
    }

    fn draw(&self, summary: &Summary) -> Result<Drawing, FigureError> {
        let known: Vec<&Coverage> = summary.coverage.iter().filter(|c| c.identified.of > 0).collect();
        if known.is_empty() {
            return Err(FigureError::missing(self.name(), "a parameter of a cause that was found"));
        }
        let mut rows = vec![("all parameters".to_string(), summary.scores[0].coverage)];
        rows.extend(known.iter().map(|c| (c.key.clone(), c.identified)));
        let alt = format!("Dots with bars, one row for each of {}.", count(known.len(), "parameter"));
        let caption = format!(
            "Share of the 95 % intervals that hold the planted value (dots) with its own Wilson interval (bars; red where it ends below 95 %), \
             over the trials in which exactly the planted cause was named, and parameters that the data bound from both sides: {} of {}.",
            rows[0].1.successes, rows[0].1.of
        );
        let mut table =
            Table::new(&["parameter", "held", "of", "low", "high", "held, open ones too", "of all", "median bias"]);
        for c in &summary.coverage {
            let p = c.identified;
            let numbers = [p.successes as f64, p.of as f64, p.low, p.high, c.all.successes as f64, c.all.of as f64];
            let cells = numbers.into_iter().chain([c.median_bias.unwrap_or(f64::NAN)]).map(cell);
            table.row(std::iter::once(c.key.clone()).chain(cells));
        }
        let svg = draw(&rows, self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, table.finish()), Vec::new()))
    }
}
