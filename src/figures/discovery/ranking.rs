//! The candidates by Schwarz's criterion: how far each is behind the best one.

use super::rows::Rows;

use crate::discover::{Basis, Candidate, Discovery, MARGIN};
use crate::figures::axes::Axis;
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::legend::{Entry, Key, legend};
use crate::figures::marks::Mark;
use crate::figures::style::{
    Color, GREY, GRID, INK, ROLLER, SHADE, SLIP, STATIC, TOP, Table, WHITE, WIDTH, cell, count, significant,
};
use crate::figures::{Drawing, Figure, FigureError};

/// Room for the numbers at the right.
const NUMBERS: f64 = 170.0;
/// Candidates shown, the base besides.
const MOST: usize = 14;
/// Values of the axis that are named.
const TICKS: [f64; 8] = [6.0, 20.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7];

/// The figure.
pub struct Ranking;

/// What a candidate adds: the words of legend and CSV.
fn kind(c: &Candidate) -> (&'static str, Mark, Color) {
    let effects = c.hypothesis.additions.iter().any(|a| a.is_effect());
    let numbers = c.hypothesis.additions.iter().any(|a| !a.is_effect());
    match (effects, numbers) {
        (false, false) => ("nothing but calibration", Mark::Triangle, INK),
        (true, false) => ("effects", Mark::Circle, STATIC),
        (false, true) => ("recalibration", Mark::Diamond, SLIP),
        (true, true) => ("both", Mark::Square, ROLLER),
    }
}

/// Its name in the figure.
fn title_of(c: &Candidate) -> String {
    if c.hypothesis.additions.is_empty() { "nothing (base)".into() } else { c.hypothesis.label() }
}

/// Place on the axis: linear within the margin, logarithmic beyond.
fn place(delta: f64) -> f64 {
    (delta.max(0.0) / MARGIN).asinh()
}

fn draw(shown: &[&Candidate], title: &str, alt: &str) -> Result<String, FigureError> {
    let rows = Rows::of(shown.iter().map(|c| title_of(c)), TOP, 30.0);
    let width = WIDTH - rows.left - NUMBERS - 14.0;
    let largest =
        shown.iter().map(|c| place(c.delta_bic)).filter(|p| p.is_finite()).fold(place(4.0 * MARGIN), f64::max);
    let high = 1.06 * largest;
    // The panel names its own ticks: its axis is in places.
    let panel = rows.panel(rows.left, width, Axis::linear("ΔBIC", -0.04 * high, high).step(1e9).sinh(MARGIN, 1.0));
    document((WIDTH, rows.bottom() + 62.0), (title, alt), |canvas| {
        entries(canvas, rows.left, shown);
        let tied = panel.px(place(MARGIN)) - panel.left;
        canvas.areas(&panel, |canvas| canvas.rectangle((panel.left, panel.top), tied, panel.height, SHADE, None));
        canvas.ticks(&panel, (true, false), |canvas| ticks(canvas, &panel, high));
        rows.draw(canvas, &[&panel]);
        panel.border(canvas, 0.0);
        let head = |x: f64, text: &str, canvas: &mut Canvas| {
            canvas.text((x, TOP - 8.0), text, Type { size: 13.0, ..Type::at(Anchor::End) });
        };
        head(WIDTH - 100.0, "weight", canvas);
        head(WIDTH - 20.0, "χ²", canvas);
        for (index, c) in shown.iter().enumerate() {
            let (_, mark, color) = kind(c);
            let (x, y) = (panel.px(place(c.delta_bic)), rows.y(index));
            let draw = |canvas: &mut Canvas| {
                canvas.areas(&panel, |canvas| {
                    canvas.line((panel.px(0.0), y), (x, y), Stroke::solid(color.faded(), 5.0));
                });
                let inner = if c.testable { color } else { WHITE };
                canvas.within(&panel, |canvas| canvas.mark(mark, (x, y), 5.5, inner, Stroke::solid(color, 1.6)));
            };
            canvas.series(kind(c).0, draw);
            let number = Type { size: 13.0, ..Type::at(Anchor::End) };
            let weight = if c.weight < 1e-3 { "< 0.001".into() } else { format!("{:.3}", c.weight) };
            canvas.text((WIDTH - 100.0, y + 4.5), &weight, number);
            let sure = if c.hypothesis.basis() == Basis::AllPoints { "" } else { "≈ " };
            canvas.text((WIDTH - 20.0, y + 4.5), &format!("{sure}{}", significant(c.chi2_per_point, 3)), number);
        }
        let label = Type { size: 16.0, ..Type::at(Anchor::Middle) };
        let at = (panel.left + 0.5 * panel.width, panel.bottom() + 46.0);
        canvas.text(at, "BIC above the best, ΔBIC", label);
    })
}

fn ticks(canvas: &mut Canvas, panel: &crate::figures::axes::Panel, high: f64) {
    let mut last = f64::NEG_INFINITY;
    for tick in std::iter::once(0.0).chain(TICKS).filter(|tick| place(*tick) <= high) {
        let x = panel.px(place(tick));
        canvas.line((x, panel.top), (x, panel.bottom()), Stroke::solid(GRID, 1.0));
        let text = significant(tick, 3);
        let half = 0.5 * crate::figures::style::text_width(&text, 15.0, false);
        if x - half > last + 8.0 {
            canvas.text((x, panel.bottom() + 21.0), &text, Type::at(Anchor::Middle));
            last = x + half;
        }
    }
}

fn entries(canvas: &mut Canvas, left: f64, shown: &[&Candidate]) {
    let mut entries: Vec<Entry> = Vec::new();
    for c in shown {
        let (word, mark, color) = kind(c);
        if !entries.iter().any(|(_, known)| known == word) {
            entries.push((Key::Mark(mark, color, true), word.into()));
        }
    }
    if shown.iter().any(|c| !c.testable) {
        entries.push((Key::Mark(Mark::Circle, GREY, false), "not testable".into()));
    }
    entries.push((Key::Patch(SHADE), format!("tie (within {MARGIN})")));
    let mut x = left.min(160.0);
    for entry in &entries {
        legend(canvas, x, -2.0, std::slice::from_ref(entry));
        x += 44.0 + crate::figures::style::text_width(&entry.1, 15.0, false) + 26.0;
    }
}

fn csv(d: &Discovery) -> String {
    let header = [
        "candidate",
        "kind",
        "delta BIC",
        "weight",
        "chi2 per reading",
        "left-out rms error [%]",
        "from",
        "testable",
        "shown",
    ];
    let mut table = Table::new(&header);
    let shown = d.leading(MOST, |_| true);
    for c in &d.candidates {
        let held_out = c.held_out.map_or(f64::NAN, |h| h.rms_percent);
        let words = |yes: bool| if yes { "yes" } else { "no" }.to_string();
        let numbers = [c.delta_bic, c.weight, c.chi2_per_point, held_out].map(cell);
        let cells = [c.hypothesis.label(), kind(c).0.to_string()].into_iter().chain(numbers);
        let basis = c.hypothesis.basis().words(d.explanation().comparison.table.points.len());
        table.row(cells.chain([basis, words(c.testable), words(shown.iter().any(|s| std::ptr::eq(*s, c)))]));
    }
    table.finish()
}

impl Figure<Discovery> for Ranking {
    fn name(&self) -> &'static str {
        "ranking"
    }

    fn title(&self) -> &'static str {
        "The candidates, ranked"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "One cause (or the base) alone in the band, or with companions that contain it and add a number that gains nothing.",
            "Different causes together in the band: these data cannot tell them apart, whatever the best one is called.",
            "Measure next where the rivals in the band differ most; the discovery names the place.",
        ]
    }

    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError> {
        let shown = discovery.leading(MOST, |_| true);
        if shown.len() < 2 {
            return Err(FigureError::missing(self.name(), "a second candidate"));
        }
        let tied = discovery.candidates.iter().filter(|c| !c.is_open && c.delta_bic <= MARGIN).count();
        let second = shown.iter().map(|c| c.delta_bic).find(|delta| *delta > MARGIN);
        let alt = format!(
            "Horizontal bars, {}: how far each is behind the best by BIC, on a scale that is linear below \
             {MARGIN} and logarithmic above; {} within {MARGIN} of the best.",
            count(shown.len(), "candidate"),
            count(tied, "candidate")
        );
        let rest = discovery.candidates.len() - shown.len();
        let more = if rest > 0 { format!(" {rest} more are in the CSV.") } else { String::new() };
        let caption = format!(
            "How far each candidate is behind the best one by BIC, misfit and a penalty for every parameter. \
             Candidates in the shaded band, within {MARGIN} of the best, are not decided between by these data; the one with \
             the fewest additions is taken. The scale is linear in the band and logarithmic beyond. ≈ stands before what was not fitted to its end: where an \
             estimate sees no gain beyond chance, a candidate stands at the penalty for its parameters.{more}"
        );
        let svg = draw(&shown, self.title(), &alt)?;
        let mut notes = vec![("Within the band".to_string(), count(tied, "candidate"))];
        if let Some(second) = second {
            notes.push(("First one outside the band".into(), format!("{} behind", significant(second, 3))));
        }
        Ok(Drawing::of(self, (caption, alt), (svg, csv(discovery)), notes))
    }
}
