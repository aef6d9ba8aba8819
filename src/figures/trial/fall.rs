//! From the calibrated base to the explanation: the error over the noise, one line per trial.

use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Anchor, Stroke, Type, document};
use crate::figures::legend::{Key, legend};
use crate::figures::marks::Mark;
use crate::figures::style::{DOTS, GREY, GRID, SLIP, STATIC, Table, WHITE, WIDTH, cell, count, text_width};
use crate::figures::{Drawing, Figure, FigureError};
use crate::trial::{Record, Score, Summary, shown};

const SIZE: f64 = 13.0;
/// Height of a row with up to `FEW` trials, and what each more of them adds.
const ROW: f64 = 22.0;
const FEW: usize = 8;
const MORE: f64 = 1.5;
const TOP: f64 = 40.0;

/// The figure.
pub struct ErrorFall;

type Trial<'a> = (&'a Record, &'a Score);

fn draw(names: &[&str], trials: &[Trial], title: &str, alt: &str) -> Result<String, FigureError> {
    let left = names.iter().map(|name| text_width(shown(name), SIZE, false)).fold(0.0, f64::max) + 30.0;
    let of = |name: &str| -> Vec<&Trial> {
        let drawable = |s: &Score| [s.base_error, s.final_error].iter().all(|error| *error > 0.0 && error.is_finite());
        let mut mine: Vec<&Trial> = trials.iter().filter(|(r, s)| r.answer.cause == name && drawable(s)).collect();
        mine.sort_by(|(_, a), (_, b)| a.base_error.total_cmp(&b.base_error));
        mine
    };
    // Every row as high as the fullest.
    let most = names.iter().map(|name| of(name).len()).max().unwrap_or(0);
    let row = ROW + MORE * most.saturating_sub(FEW) as f64;
    let (width, height) = (WIDTH - left - 30.0, row * names.len() as f64);
    document((WIDTH, TOP + height + 62.0), (title, alt), |canvas| {
        let values = trials.iter().flat_map(|(_, s)| [s.base_error, s.final_error]).chain([0.9, 2.0]);
        let x = Axis::logarithmic("error of the amplitude over the noise", values, 0.05);
        let panel = Panel { left, top: TOP, width, height, x, y: Axis::linear("", 0.2, 0.8).step(2.0) };
        panel.frame(canvas, true, false);
        let floor = panel.px(1.0);
        canvas.line((floor, TOP), (floor, TOP + height), Stroke::dashed(GREY, 1.6, DOTS));
        let keys = [
            (Key::Mark(Mark::Circle, GREY, false), "calibrated base"),
            (Key::Mark(Mark::Circle, STATIC, true), "explanation, right verdict"),
            (Key::Mark(Mark::Circle, SLIP, true), "explanation, wrong verdict"),
        ];
        for (index, (key, text)) in keys.into_iter().enumerate() {
            legend(canvas, left + 240.0 * index as f64, 0.0, &[(key, text.to_string())]);
        }
        for (index, name) in names.iter().enumerate() {
            let middle = TOP + row * (index as f64 + 0.5);
            canvas.line((left, middle), (left + width, middle), Stroke::solid(GRID, 1.0));
            canvas.text((left - 10.0, middle + 5.0), shown(name), Type { size: SIZE, ..Type::at(Anchor::End) });
            let mine = of(name);
            let size = if mine.len() > FEW { 0.75 } else { 1.0 };
            let dumbbell = |(place, (_, s)): (usize, &&Trial)| {
                let y = middle + 0.7 * row * ((place as f64 + 0.5) / mine.len() as f64 - 0.5);
                ((panel.px(s.base_error), y), (panel.px(s.final_error), y), s.verdict)
            };
            let dumbbells: Vec<_> = mine.iter().enumerate().map(dumbbell).collect();
            for &(base, end, _) in &dumbbells {
                canvas.line(base, end, Stroke::solid(GREY, 0.9 * size));
            }
            for &(base, ..) in &dumbbells {
                canvas.circle(base, 2.6 * size, WHITE, Stroke::solid(GREY, 1.2 * size));
            }
            // Wrong ones on top.
            for (right, color) in [(true, STATIC), (false, SLIP)] {
                for &(_, end, _) in dumbbells.iter().filter(|(.., verdict)| *verdict == right) {
                    canvas.dot(end, 3.2 * size, color);
                }
            }
        }
    })
}

impl Figure<Summary> for ErrorFall {
    fn name(&self) -> &'static str {
        "error-fall"
    }

    fn title(&self) -> &'static str {
        "From the calibrated base to the noise"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Blue dots on the dotted line.",
            "Dots right of it: the explanation leaves misfit. Red dots on it: another cause explains the table as well.",
            "Right of the line more effects or a better search; on it, other conditions that tell the causes apart.",
        ]
    }

    fn draw(&self, summary: &Summary) -> Result<Drawing, FigureError> {
        let trials: Vec<Trial> = summary.trials.iter().filter_map(|r| Some((r, r.score.as_ref()?))).collect();
        if trials.is_empty() {
            return Err(FigureError::missing(self.name(), "a trial that was searched"));
        }
        let names: Vec<&str> =
            summary.causes.iter().filter(|c| c.scores.trials > 0).map(|c| c.cause.as_str()).collect();
        let alt = format!("Dumbbells on a logarithmic axis, one for each of {}.", count(trials.len(), "trial"));
        let caption = format!(
            "Root mean square error of the amplitude over the stated noise in {}: open circles are the calibrated base, dots the \
             explanation (blue where the verdict is right). 1, dotted, is the noise floor.",
            count(trials.len(), "trial")
        );
        let mut table =
            Table::new(&["trial", "cause", "noise", "base error over noise", "final error over noise", "verdict"]);
        for (r, s) in &trials {
            let verdict = r.found.as_ref().map_or_else(String::new, |f| f.verdict.clone());
            let numbers = [r.answer.noise, s.base_error, s.final_error].map(cell);
            let [noise, base, end] = numbers;
            table.row([r.id.clone(), r.answer.cause.clone(), noise, base, end, verdict]);
        }
        let svg = draw(&names, &trials, self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, table.finish()), Vec::new()))
    }
}
