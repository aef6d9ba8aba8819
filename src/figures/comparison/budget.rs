//! Where the error comes from: model, noise and numerics, whose squares add up.

use crate::compare::Comparison;
use crate::figures::canvas::{Stroke, Type, document};
use crate::figures::legend::{Key, legend};
use crate::figures::style::{Color, GREY, SLIP_BAND, STATIC, TOP, Table, WHITE, WIDTH, budget_percent, cell};
use crate::figures::{Drawing, Figure, FigureError};

const LEFT: f64 = 40.0;
const BAR: f64 = 46.0;
const NUMERICS: Color = Color(0x22, 0x22, 0x22);

/// The figure.
pub struct Budget;

impl Figure<Comparison> for Budget {
    fn name(&self) -> &'static str {
        "error-budget"
    }

    fn title(&self) -> &'static str {
        "Error budget"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Noise fills the bar; numerics are too small to see.",
            "The model fills the bar: better readings or finer steps would change nothing.",
            "Improve the largest part: the model, then the readings; numerics above a tenth of the noise is a fault of the program.",
        ]
    }

    fn draw(&self, comparison: &Comparison) -> Result<Drawing, FigureError> {
        let b = comparison.error_budget();
        let parts = [
            ("model", b.model_percent, STATIC),
            ("noise", b.noise_percent, SLIP_BAND),
            ("numerics", b.numerical_percent, NUMERICS),
        ];
        let square = |value: f64| if value.is_finite() { value * value } else { 0.0 };
        let squares: f64 = parts.iter().map(|(_, value, _)| square(*value)).sum();
        let share = |value: f64| if squares > 0.0 { square(value) / squares } else { 0.0 };
        let number = budget_percent;
        let alt = format!(
            "One horizontal bar in three parts: model {}, noise {}, numerics {}, root mean square.",
            number(b.model_percent),
            number(b.noise_percent),
            number(b.numerical_percent)
        );
        let width = WIDTH - 2.0 * LEFT;
        let svg = document((WIDTH, TOP + BAR + 78.0), (self.title(), &alt), |canvas| {
            let total = format!(
                "error of the amplitude: {} root mean square; the bar shares its square",
                number(b.total_percent)
            );
            canvas.text((LEFT, TOP - 14.0), &total, Type::default());
            let mut x = LEFT;
            for (_, value, color) in parts {
                canvas.rectangle((x, TOP), width * share(value), BAR, color, None);
                x += width * share(value);
                canvas.line((x, TOP), (x, TOP + BAR), Stroke::solid(WHITE, 1.0));
            }
            let (r, t, l) = (LEFT + width, TOP + BAR, LEFT);
            canvas.polyline(&[(l, TOP), (r, TOP), (r, t), (l, t), (l, TOP)], Stroke::solid(GREY, 1.0));
            for (index, (name, value, color)) in parts.into_iter().enumerate() {
                let text = format!("{name}: {}", number(value));
                let left = LEFT + width / 3.0 * index as f64;
                legend(canvas, left, TOP + BAR + 8.0, &[(Key::Patch(color), text)]);
                let text = format!("{} of the square", budget_percent(100.0 * share(value)));
                let small = Type { size: 13.0, color: GREY, ..Type::default() };
                canvas.text((left + 44.0, TOP + BAR + 50.0), &text, small);
            }
        })?;
        let mut table = Table::new(&["part", "rms [%]", "share of the square"]);
        for (name, value, _) in parts {
            table.row([name.to_string(), cell(value), cell(share(value))]);
        }
        table.row(["total".into(), cell(b.total_percent), cell(1.0)]);
        let caption = format!(
            "The error of the amplitude, {} root mean square over all points, in three parts whose squares add up: the noise of \
             the readings (those that stand out with it), the difference of two independent solvers at a sample of the points, and what is left, the model.",
            number(b.total_percent)
        );
        let notes = parts
            .iter()
            .map(|(name, value, _)| (format!("{}{}", name[..1].to_uppercase(), &name[1..]), number(*value)));
        Ok(Drawing::of(self, (caption, alt), (svg, table.finish()), notes.collect()))
    }
}
