//! What is missing against the variable that it depends on: stiffness and damping with their bands.

use crate::figures::axes::{Axis, Panel, range};
use crate::figures::canvas::{Canvas, Point, Stroke, Type, document};
use crate::figures::marks::Mark;
use crate::figures::style::{DASH_SLIP, GAP, INK, LEFT, RIGHT, STATIC, STATIC_BAND, TOP, Table, Unit, WIDTH, cell};
use crate::figures::{Drawing, Figure, FigureError};
use crate::free_form::{Curve, Dependence, FreeForm, Variable};

const HEIGHT: f64 = 220.0;
const BETWEEN: f64 = 18.0;
/// Curves at most.
const MOST: usize = 3;
/// Values of a curve up to which each is marked.
const FEW: usize = 12;

/// The figure.
pub struct Curves;

struct Shown<'a> {
    class: &'a Dependence,
    curve: &'a Curve,
}

/// Curves of the leading class and of those that are tied with it.
fn shown(found: &FreeForm) -> Vec<Shown<'_>> {
    let classes = found.leading().into_iter().chain(found.tied());
    classes.flat_map(|class| class.curves.iter().map(move |curve| Shown { class, curve })).take(MOST).collect()
}

/// Units of k and c: those of the rig, or where its mass is not stated shares of its own.
fn units(found: &FreeForm, shown: &[Shown<'_>]) -> [Unit; 2] {
    let [k, c, ..] = found.units;
    if k == "1/s^2" {
        return [Unit::new(0.01 * found.of_rig[0], "% of K"), Unit::new(0.01 * found.of_rig[1], "% of C")];
    }
    let largest = |of: fn(&Curve) -> &[[f64; 3]]| {
        shown.iter().flat_map(|one| of(one.curve)).flatten().fold(0.0, |most: f64, value| most.max(value.abs()))
    };
    [Unit::fitting(largest(|c| &c.stiffness), k), Unit::fitting(largest(|c| &c.damping), c)]
}

/// The axis of a variable, and the unit of its values.
fn axis(found: &FreeForm, curve: &Curve) -> (Axis, Unit) {
    let largest = curve.values.iter().copied().fold(0.0, f64::max);
    let unit = match curve.variable {
        Variable::Frequency => Unit::frequency(largest),
        Variable::Drift => Unit::new(1.0, ""),
        Variable::RollerSpeed => Unit::speed(),
        other => Unit::of_signal(largest, other.unit(&found.units)),
    };
    let name = match curve.variable {
        Variable::Amplitude => "amplitude of the motion",
        Variable::Drift => "number of the series",
        other => other.words(),
    };
    let label = if unit.label.is_empty() { name.to_string() } else { format!("{name} [{}]", unit.label) };
    let values: Vec<f64> = curve.values.iter().map(|value| unit.of(*value)).collect();
    let linear = matches!(curve.variable, Variable::Frequency | Variable::Drift | Variable::RollerSpeed);
    let (low, high) = range(values.iter().copied());
    let axis = if linear {
        Axis::linear(label, low - 0.03 * (high - low), high + 0.03 * (high - low))
    } else {
        Axis::logarithmic(label, values, 0.03)
    };
    (axis, unit)
}

fn draw(found: &FreeForm, shown: &[Shown<'_>], title: &str, alt: &str) -> Result<String, FigureError> {
    let n = shown.len() as f64;
    let width = (WIDTH - LEFT - RIGHT - GAP * (n - 1.0)) / n;
    let units = units(found, shown);
    document((WIDTH, TOP + 2.0 * HEIGHT + BETWEEN + 62.0), (title, alt), |canvas| {
        for (index, one) in shown.iter().enumerate() {
            let left = LEFT + (width + GAP) * index as f64;
            let (x, of_x) = axis(found, one.curve);
            let heading = format!("{}: explains at most {:.0} %", one.class.name(), one.class.explained_percent);
            canvas.text((left, TOP - 14.0), &heading, Type::default().bold());
            let rows = [("stiffness k", &one.curve.stiffness), ("damping c", &one.curve.damping)];
            for (lower, ((name, band), unit)) in rows.into_iter().zip(&units).enumerate() {
                let all = shown.iter().flat_map(|s| if lower == 0 { &s.curve.stiffness } else { &s.curve.damping });
                let (low, high) = range(all.flatten().map(|value| unit.of(*value)).chain([0.0]));
                let margin = 0.06 * (high - low);
                let y = Axis::linear(format!("{name} [{}]", unit.label), low - margin, high + margin);
                let top = TOP + (HEIGHT + BETWEEN) * lower as f64;
                let panel = Panel { left, top, width, height: HEIGHT, x: x.clone(), y };
                panel.frame(canvas, lower == 1, index == 0);
                curve(canvas, &panel, &one.curve.values, band, (&of_x, unit));
            }
        }
    })
}

fn curve(canvas: &mut Canvas, panel: &Panel, values: &[f64], band: &[[f64; 3]], (of_x, of_y): (&Unit, &Unit)) {
    let line =
        |end: usize| -> Vec<Point> { values.iter().zip(band).map(|(x, y)| (of_x.of(*x), of_y.of(y[end]))).collect() };
    let [best, low, high] = [0, 1, 2].map(line);
    canvas.within(panel, |canvas| {
        let outline: Vec<Point> =
            low.iter().chain(high.iter().rev()).map(|&(x, y)| (panel.px(x), panel.py(y))).collect();
        canvas.polygon(&outline, STATIC_BAND.faded(), None);
    });
    panel.curve(canvas, &[(panel.x.low, 0.0), (panel.x.high, 0.0)], Stroke::dashed(INK, 1.0, DASH_SLIP));
    for end in [&low, &high] {
        panel.curve(canvas, end, Stroke::solid(STATIC_BAND, 1.4));
    }
    panel.curve(canvas, &best, Stroke::solid(STATIC, 2.4));
    if best.len() <= FEW {
        panel.marks(canvas, &best, Mark::Circle, 4.0, STATIC, true);
    }
}

fn csv(found: &FreeForm, shown: &[Shown<'_>]) -> String {
    let [k, c, ..] = found.units;
    let ends = ["", " low", " high"];
    let of = |name: &str, unit: &str| ends.map(|end| format!("{name}{end} [{unit}]"));
    let header: Vec<String> = ["class", "variable", "unit", "value"]
        .map(String::from)
        .into_iter()
        .chain(of("stiffness", k))
        .chain(of("damping", c))
        .collect();
    let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
    for Shown { class, curve } in shown {
        let unit = curve.variable.unit(&found.units);
        for (at, value) in curve.values.iter().enumerate() {
            let words = [class.name(), curve.variable.words().into(), unit.into(), cell(*value)];
            let numbers = curve.stiffness[at].iter().chain(&curve.damping[at]).map(|value| cell(*value));
            table.row(words.into_iter().chain(numbers));
        }
    }
    table.finish()
}

impl Figure<FreeForm> for Curves {
    fn name(&self) -> &'static str {
        "free-form"
    }

    fn title(&self) -> &'static str {
        "What is missing, against what it depends on"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "A curve whose band leaves the dashed line: stiffness or damping that changes with this variable, whatever its law.",
            "A wide band, or several variables side by side: these readings do not hold the curve, or do not tell the variables apart.",
            "Compare its shape with the effects that lie nearest, or write a law with it; levels are relative to the calibrated model.",
        ]
    }

    fn draw(&self, found: &FreeForm) -> Result<Drawing, FigureError> {
        let shown = shown(found);
        if shown.is_empty() {
            return Err(FigureError::missing(self.name(), "a variable on which what is missing depends"));
        }
        let names: Vec<String> = shown.iter().map(|one| format!("the {}", one.curve.variable.words())).collect();
        let names = names.join(", ");
        let alt = format!(
            "Stiffness above and damping below against {names}: a line in a band, about a dashed line at zero."
        );
        let caption = format!(
            "Stiffness k and damping c of the force that is missing beside the calibrated model, −(k + iωc)x, against {names}, with \
             95 % bands: smooth curves about their mean over the readings, since a constant is part of the calibration. It acts on {}.",
            found.acts_on
        );
        let notes = shown.iter().map(|one| {
            (format!("Left by {}", one.class.name()), format!("{:.2} % of the amplitude", one.class.left_rms_percent))
        });
        let svg = draw(found, &shown, self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, csv(found, &shown)), notes.collect()))
    }
}
