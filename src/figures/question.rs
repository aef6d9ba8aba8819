//! The answer to the question of a scenario: one panel per leading effect, its curves between those of the model
//! itself.

use super::axes::{Axis, Panel};
use super::canvas::{Anchor, Canvas, Dash, Point, Stroke, Type, document};
use super::comparison::grid::{Cell, Grid, Rows, heading};
use super::data;
use super::legend::{Entry, Key};
use super::style::{
    DASH_SLIP, DASH_STATIC, INK, LABEL_SIZE, LEFT, SLIP, STATIC, Table, Unit, WIDTH, budget_percent, cell, significant,
};
use super::{Drawing, FigureError};
use crate::question::{Answer, Hypothesis, Setting, condition, criteria, otherwise, why_not};
use crate::sweep::Curve;

/// Name of the figure; also the stem of its files.
pub const NAME: &str = "open-question";
/// Panels at most.
const MOST: usize = 6;
const TARGET: Stroke = Stroke { color: INK, width: 3.4, dash: Dash::Solid };
/// Colours that go with those of the limiting cases for all kinds of colour vision.
const CLOSEST: super::style::Color = super::style::Color(0x00, 0x8a, 0x63);
/// Curves that differ by less than this share of the largest value are drawn as one.
const ALIKE: f64 = 0.005;
/// Height of a line of text above a panel, and panels side by side from which on there is room for one criterion a
/// line.
const LINE: f64 = 18.0;
const MANY: usize = 3;
const MILDEST: super::style::Color = super::style::Color(0xaa, 0x44, 0x99);

/// Draws the answer.
///
/// # Errors
/// [`FigureError::Render`] where an element cannot be drawn.
pub fn draw(answer: &Answer) -> Result<Drawing, FigureError> {
    let title = "Simulated curves that the effects can give, and the one asked for".to_string();
    let able = answer.able().count();
    let target = speed(answer.question.resembles);
    let caption = format!(
        "All curves are simulated; nothing here is measured. Black: the model itself at {target}, the curve that the paper's \
         words name. Coloured: the same model at {} with one effect of the catalogue, where its curve comes closest and where \
         its parameters are strained least with all features kept (peak lower by {} or more, further right, equal to full \
         slip at both ends and alike between, within {}). {able} of {} effects can; hypotheses, not findings.",
        speed(answer.condition.speed),
        percent(2.0 * answer.question.tolerance),
        percent(answer.question.tolerance),
        answer.hypotheses.len(),
    );
    let shown = shown(answer);
    let alt = format!(
        "Small multiples of amplitude against frequency for {}: in each the curve asked for in black, full slip and static \
         contact dashed, and the curves with the effect.",
        shown.iter().map(|h| h.effect.name()).collect::<Vec<_>>().join(", ")
    );
    let svg = drawing(answer, &shown, (&title, &alt))?;
    Ok(Drawing {
        name: NAME.into(),
        title,
        caption,
        alt,
        svg,
        narrow: None,
        csv: csv(answer),
        notes: notes(answer),
        reading: reading(answer),
    })
}

/// The effects that can; where there are few, those that come closest as well.
fn shown(answer: &Answer) -> Vec<&Hypothesis> {
    answer.hypotheses.iter().take(answer.able().count().clamp(4, MOST)).collect()
}

fn speed(value: f64) -> String {
    format!("V = {}", Unit::speed().show(value, 3))
}

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

fn drawing(answer: &Answer, shown: &[&Hypothesis], words: (&str, &str)) -> Result<String, FigureError> {
    let frequency = &answer.target.frequency;
    let largest = answer.full_slip.iter().chain(&answer.static_contact).copied().fold(0.0, f64::max);
    let unit = Unit::fitting(largest, "rad");
    let rows = Rows::of(legend(answer, shown));
    // The criteria stand above the panels, where others have a strip beneath.
    let grid = Grid::of(shown.len(), rows.height());
    let per_line = if grid.columns >= MANY { 1 } else { 2 };
    let above = LINE * (4 / per_line) as f64;
    let grid = Grid { main: grid.main + grid.strip + above, strip: 0.0, ..grid };
    let x = Axis::linear("frequency f [Hz]", frequency[0], frequency[frequency.len() - 1]).step(10.0);
    let y = Axis::around("", [0.0, 1.06 * unit.of(largest)]);
    document((WIDTH, grid.bottom()), words, |canvas| {
        rows.draw(canvas);
        let upright = Type { size: LABEL_SIZE, anchor: Anchor::Middle, upwards: true, ..Type::default() };
        canvas.text((LEFT - 60.0, grid.middle()), &format!("amplitude α [{}]", unit.label), upright);
        for (index, hypothesis) in shown.iter().enumerate() {
            let Cell { left, top, width, first, last, .. } = grid.cell(index);
            let panel = Panel { left, top: top + above, width, height: grid.main - above, x: x.clone(), y: y.clone() };
            panel.frame(canvas, last, first);
            let name = format!("{}. {}", index + 1, hypothesis.effect.name());
            heading(canvas, &Panel { top, ..panel.clone() }, (&name, &subtitle(hypothesis)));
            for (number, criterion) in criteria(answer, hypothesis.shown()).iter().enumerate() {
                let x = left + width * (number % per_line) as f64 / per_line as f64;
                let y = top + LINE * (number / per_line) as f64 + 10.0;
                let text = if criterion.met { criterion.text.clone() } else { format!("NOT: {}", criterion.text) };
                let style = Type { size: 13.0, ..Type::default() };
                canvas.text((x, y), &text, if criterion.met { style } else { style.bold() });
            }
            lines(canvas, &panel, answer, hypothesis, &unit);
        }
    })
}

fn subtitle(hypothesis: &Hypothesis) -> String {
    match &hypothesis.mildest {
        Some(mild) if coincide(mild, &hypothesis.best) => {
            format!("can; strain {}; its closest curve is the same", significant(mild.strain, 2))
        }
        Some(mild) => format!("can; strain {}", significant(mild.strain, 2)),
        None => "cannot".into(),
    }
}

/// Whether two curves are the same to the eye.
fn coincide(a: &Setting, b: &Setting) -> bool {
    let largest = b.curve.states.iter().map(|s| s.amplitude).fold(0.0, f64::max);
    a.curve.states.iter().zip(&b.curve.states).all(|(a, b)| (a.amplitude - b.amplitude).abs() < ALIKE * largest)
}

fn lines(canvas: &mut Canvas, panel: &Panel, answer: &Answer, hypothesis: &Hypothesis, unit: &Unit) {
    let steady = |curve: &Curve| -> Vec<Point> { data::steady(curve, |s| unit.of(s.amplitude)) };
    let limit = |values: &[f64]| -> Vec<Point> {
        answer.target.frequency.iter().zip(values).map(|(f, a)| (*f, unit.of(*a))).collect()
    };
    panel.curve(canvas, &limit(&answer.full_slip), Stroke::dashed(SLIP, 1.6, DASH_SLIP));
    panel.curve(canvas, &limit(&answer.static_contact), Stroke::dashed(STATIC, 1.6, DASH_STATIC));
    panel.curve(canvas, &steady(&answer.target), TARGET);
    panel.curve(canvas, &steady(&hypothesis.best.curve), Stroke::solid(CLOSEST, 3.0));
    if let Some(mild) = hypothesis.mildest.as_ref().filter(|mild| !coincide(mild, &hypothesis.best)) {
        panel.curve(canvas, &steady(&mild.curve), Stroke::dashed(MILDEST, 2.0, Dash::Dashes(3.0, 3.0)));
    }
}

fn legend(answer: &Answer, shown: &[&Hypothesis]) -> Vec<Entry> {
    let line = |stroke: Stroke, text: String| (Key::Line(stroke), text);
    let mut entries = vec![
        line(TARGET, format!("asked for: model itself, {}", speed(answer.question.resembles))),
        line(Stroke::solid(CLOSEST, 3.0), format!("with the effect, {}", speed(answer.condition.speed))),
        line(Stroke::dashed(SLIP, 1.6, DASH_SLIP), "full slip (I, III)".into()),
        line(Stroke::dashed(STATIC, 1.6, DASH_STATIC), "static contact (II)".into()),
    ];
    if shown.iter().any(|h| h.mildest.as_ref().is_some_and(|mild| !coincide(mild, &h.best))) {
        let stroke = Stroke::dashed(MILDEST, 2.0, Dash::Dashes(3.0, 3.0));
        entries.insert(2, line(stroke, "with the effect, least strained".into()));
    }
    entries
}

fn csv(answer: &Answer) -> String {
    let header = ["curve", "setting", "parameters (SI)", "frequency [Hz]", "amplitude [rad]", "status"];
    let mut table = Table::new(&header);
    let mut rows = |name: &str, setting: &str, parameters: String, values: &[f64], words: &[&str]| {
        for ((f, a), word) in answer.target.frequency.iter().zip(values).zip(words) {
            let start = [name.to_string(), setting.to_string(), parameters.clone()];
            table.row(start.into_iter().chain([cell(*f), cell(*a), word.to_string()]));
        }
    };
    let of = |curve: &Curve| -> (Vec<f64>, Vec<&'static str>) {
        curve.states.iter().map(|s| (s.amplitude, data::status_word(&s.status))).unzip()
    };
    let exact = vec!["closed form"; answer.full_slip.len()];
    let (values, status) = of(&answer.target);
    rows("asked for", "simulated, base model", String::new(), &values, &status);
    rows("full slip", "simulated, base model", String::new(), &answer.full_slip, &exact);
    rows("static contact", "simulated, base model", String::new(), &answer.static_contact, &exact);
    for h in &answer.hypotheses {
        for (name, setting) in [("closest", Some(&h.best)), ("least strained", h.mildest.as_ref())] {
            let Some(setting) = setting else { continue };
            let pairs = h.effect.parameters().iter().zip(&setting.values);
            let parameters: Vec<String> = pairs.map(|(info, value)| format!("{} = {value}", info.key)).collect();
            let (values, status) = of(&setting.curve);
            rows(h.effect.name(), name, parameters.join("; "), &values, &status);
        }
    }
    table.finish()
}

/// Key numbers, and how to read the figure.
fn notes(answer: &Answer) -> Vec<(String, String)> {
    let d = &answer.described;
    let mut notes = vec![
        ("Condition".to_string(), condition(answer)),
        (
            "The curve asked for".to_string(),
            format!(
                "simulated; peak {} lower than full slip and {} Hz further right, ends differ by {} at most",
                percent(d.lower),
                significant(d.shift_hz, 2),
                budget_percent(100.0 * d.ends[0].abs().max(d.ends[1].abs()))
            ),
        ),
    ];
    if !answer.otherwise.is_empty() {
        notes.push(("With another tolerance".to_string(), otherwise(answer)));
    }
    notes
}

/// What good looks like, what bad looks like, what to do.
fn reading(answer: &Answer) -> [String; 3] {
    let cannot = answer.hypotheses.iter().find(|h| !h.can());
    let worst = cannot.map_or(String::new(), |h| {
        let why = why_not(h);
        format!(" The best of those that cannot is {}: {why}.", h.effect.name())
    });
    [
        "All four criteria above a panel met (what the least strained curve has, and in brackets what is asked), with a \
         margin: that is what an effect \"can\", and the line may do it beside the \
         black one. A strain well below 1."
            .into(),
        format!("A criterion above a panel that is not met, or a strain near 1 or above it.{worst}"),
        "Take no ranking for a finding: several effects give nearly the same curve, and the choice of the drive is \
         assumed. Make the reading that is named to decide between them."
            .into(),
    ]
}
