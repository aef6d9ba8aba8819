//! What was planted against what was named, with counts.

use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::style::{Color, GREY, GRID, INK, ROLLER, SLIP, Table, WHITE, WIDTH, count, text_width};
use crate::figures::{Drawing, Figure, FigureError};
use crate::trial::{Confusion, Summary, shown, sorted};

const SIZE: f64 = 13.0;
const ROW: f64 = 22.0;
const WIDEST: f64 = 46.0;
/// Colour of answers that are said not to be told apart from the right one.
const TIED: Color = Color(0xe6, 0x9f, 0x00);
/// Most columns, but for those of right answers; the rarest labels are united behind them.
const COLUMNS: usize = 34;

/// The figure.
pub struct ConfusionMatrix;

/// What is shown: the matrix with rare columns united.
struct Shown<'a> {
    planted: &'a [String],
    named: Vec<String>,
    counts: Vec<Vec<usize>>,
    tied: Vec<Vec<usize>>,
}

/// Whether what was named is the right answer to what was planted.
fn is_right(planted: &str, named: &str) -> bool {
    (planted.starts_with("outside-") && named == "unexplained") || named == sorted(planted)
}

impl<'a> Shown<'a> {
    fn of(c: &'a Confusion) -> Self {
        let none = || vec![vec![0; c.named.len()]; c.planted.len()];
        let tied = if c.tied.is_empty() { none() } else { c.tied.clone() };
        if c.named.len() <= COLUMNS {
            return Self { planted: &c.planted, named: c.named.clone(), counts: c.counts.clone(), tied };
        }
        let mut order: Vec<usize> = (0..c.named.len()).collect();
        let total = |column: usize| c.counts.iter().map(|row| row[column]).sum::<usize>();
        let is_right = |column: usize| c.planted.iter().any(|planted| is_right(planted, &c.named[column]));
        // What is right somewhere has a column of its own however rare.
        order.sort_by_key(|&column| (!is_right(column), std::cmp::Reverse(total(column))));
        let count = order.iter().filter(|&&column| is_right(column)).count().max(COLUMNS - 1);
        let (mut kept, rare) = (order[..count].to_vec(), &order[count..]);
        kept.sort_unstable();
        let mut named: Vec<String> = kept.iter().map(|&column| c.named[column].clone()).collect();
        named.push(format!("{} other answers", rare.len()));
        let row = |row: &Vec<usize>| {
            let mut cells: Vec<usize> = kept.iter().map(|&column| row[column]).collect();
            cells.push(rare.iter().map(|&column| row[column]).sum());
            cells
        };
        let rows = |cells: &[Vec<usize>]| cells.iter().map(row).collect();
        Self { planted: &c.planted, named, counts: rows(&c.counts), tied: rows(&tied) }
    }

    /// Whether a column is the right answer to a row.
    fn right(&self, row: usize, column: usize) -> bool {
        is_right(&self.planted[row], &self.named[column])
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let widest =
            |names: &[String]| names.iter().map(|name| text_width(name, SIZE, false)).fold(0.0, f64::max) + 14.0;
        let (left, top) = (widest(self.planted) + 30.0, widest(&self.named) + 30.0);
        let column = ((WIDTH - left - 20.0) / self.named.len() as f64).min(WIDEST);
        let height = top + ROW * self.planted.len() as f64 + 30.0;
        document((WIDTH, height), (title, alt), |canvas| {
            let heading = Type { size: SIZE, color: GREY, ..Type::default().bold() };
            canvas.text((left, 16.0), "named", heading);
            canvas.text((14.0, top - 8.0), "planted", heading);
            let (right, bottom) = (left + column * self.named.len() as f64, top + ROW * self.planted.len() as f64);
            for index in 0..=self.planted.len() {
                let y = top + ROW * index as f64;
                canvas.line((left, y), (right, y), Stroke::solid(GRID, 1.0));
            }
            for index in 0..=self.named.len() {
                let x = left + column * index as f64;
                canvas.line((x, top), (x, bottom), Stroke::solid(GRID, 1.0));
            }
            for (index, name) in self.named.iter().enumerate() {
                let x = left + column * (index as f64 + 0.5) + 0.36 * SIZE;
                // A text that reads upwards is anchored at its lower end.
                let style = Type { size: SIZE, upwards: true, ..Type::default() };
                canvas.text((x, top - 8.0), name, style);
            }
            for (index, name) in self.planted.iter().enumerate() {
                let y = top + ROW * (index as f64 + 0.5) + 0.36 * SIZE;
                let name = shown(name);
                canvas.text((left - 8.0, y), name, Type { size: SIZE, ..Type::at(Anchor::End) });
                self.row(canvas, index, (left, top + ROW * index as f64), column);
            }
        })
    }

    fn row(&self, canvas: &mut Canvas, row: usize, (left, top): (f64, f64), width: f64) {
        let total = self.counts[row].iter().sum::<usize>().max(1) as f64;
        for (column, &number) in self.counts[row].iter().enumerate() {
            let right = self.right(row, column);
            if number == 0 && !right {
                continue;
            }
            let x = left + width * column as f64;
            let hue = match right {
                true => ROLLER,
                false if self.tied[row][column] == number => TIED,
                false => SLIP,
            };
            let color = if number == 0 { WHITE } else { WHITE.mix(hue, 0.2 + 0.7 * number as f64 / total) };
            let frame = if right { Stroke::solid(GREY, 1.2) } else { Stroke::solid(GRID, 1.0) };
            canvas.rectangle((x, top), width, ROW, color, Some(frame));
            if number > 0 {
                let Color(red, green, blue) = color;
                let dark = u32::from(red) + u32::from(green) + u32::from(blue) < 380;
                let style = Type { size: SIZE, color: if dark { WHITE } else { INK }, ..Type::at(Anchor::Middle) };
                canvas.text((x + 0.5 * width, top + 0.5 * ROW + 0.36 * SIZE), &number.to_string(), style);
            }
        }
    }
}

impl Figure<Summary> for ConfusionMatrix {
    fn name(&self) -> &'static str {
        "confusion"
    }

    fn title(&self) -> &'static str {
        "What was planted, and what was named"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Green, and orange where two causes act alike.",
            "Red cells that repeat in one column: an answer that the search prefers without grounds.",
            "Where a cell is orange the tables cannot tell the two apart, and other conditions are needed; where it is red, compare \
             the two in the atlas.",
        ]
    }

    fn draw(&self, summary: &Summary) -> Result<Drawing, FigureError> {
        let c = &summary.confusion;
        if c.named.is_empty() {
            return Err(FigureError::missing(self.name(), "a trial that was searched"));
        }
        let shown = Shown::of(c);
        let trials = summary.scores[0].trials;
        let alt = format!(
            "Matrix of {} planted against {} with the number of trials in each cell.",
            count(c.planted.len(), "cause"),
            count(shown.named.len(), "answer")
        );
        let caption = format!(
            "{}: one row per planted cause, one column per answer; numbers are trials. Green: the right answer, with a grey frame \
             where it was not given; orange: another, which all these trials say not to be told apart from the right one (it counts \
             as named); red: another. For causes outside the catalogue the right answer is “unexplained”.",
            count(trials, "blind trial")
        );
        let mut header = vec!["planted"];
        header.extend(c.named.iter().map(String::as_str));
        let mut table = Table::new(&header);
        for (name, row) in c.planted.iter().zip(&c.counts) {
            table.row(std::iter::once(name.clone()).chain(row.iter().map(usize::to_string)));
        }
        let svg = shown.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, table.finish()), Vec::new()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_right_has_a_column_of_its_own_however_rare() {
        let planted: Vec<String> = (0..45).map(|i| format!("cause-{i}")).collect();
        let wrong = (0..5).map(|i| format!("wrong-{i}"));
        let named: Vec<String> = wrong.chain(planted.iter().cloned()).collect();
        // Every cause is named once, and the wrong answers more often.
        let row = |i: usize| (0..50).map(|column| if column < 5 { 2 } else { usize::from(column == i + 5) }).collect();
        let counts = (0..45).map(row).collect();
        let confusion = Confusion { planted: planted.clone(), named, counts, tied: Vec::new() };
        let shown = Shown::of(&confusion);
        assert_eq!(shown.named.last().map(String::as_str), Some("5 other answers"));
        for row in 0..45 {
            let right: Vec<usize> = (0..shown.named.len()).filter(|&column| shown.right(row, column)).collect();
            assert_eq!(right.iter().map(|&column| shown.counts[row][column]).collect::<Vec<_>>(), [1]);
            assert_eq!(shown.counts[row].last(), Some(&10));
        }
    }
}
