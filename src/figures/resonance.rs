//! Amplitude and phase against frequency, one curve per condition, between the limiting cases (paper Figures 5 and 6).

use super::axes::{Axis, Panel, range};
use super::canvas::{Canvas, Point, Stroke, document};
use super::data::{self, health};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::Mark;
use super::scheme::{Scheme, Styled, draw_curve, draw_limit, limit_band, limit_name, limit_points, limits};
use super::style::{INK, Table, Unit, WIDTH, cell, count};
use super::{Drawing, Figure, FigureError};
use crate::solver::SteadyState;
use crate::sweep::{Curve, LimitCurve, Outcome};
use std::f64::consts::PI;

const HEIGHT: f64 = 740.0;

/// The figure.
pub struct Resonance;

/// What is shown.
struct Data<'a> {
    scheme: Scheme<'a>,
    limits: Vec<(&'a LimitCurve, Stroke)>,
    span: (f64, f64),
    unit: Unit,
    wraps: bool,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        let curves = data::curves(outcome);
        let Some(first) = curves.first() else {
            return Err(FigureError::missing("resonance", "a sweep with at least one frequency and one condition"));
        };
        let limits = limits(outcome, first.condition.drive);
        let span = data::span(&curves);
        let states = || curves.iter().flat_map(|curve| &curve.states);
        let of_limits =
            limits.iter().flat_map(|(limit, _)| limit_points(limit, &limit.amplitude, span, 1.0)).map(|p| p.1);
        let largest = range(states().map(|state| state.amplitude).chain(of_limits)).1;
        let (low, high) = range(states().map(|state| state.phase));
        let unit = Unit::fitting(largest, "rad");
        Ok(Self { scheme: Scheme::of(&curves), limits, span, unit, wraps: high > 0.5 * PI && low < -0.5 * PI })
    }

    /// Phase in degrees; on the branch from -270° to 90° where the sweep crosses -180°.
    fn phase(&self, phase: f64) -> f64 {
        (if self.wraps && phase > 0.5 * PI { phase - 2.0 * PI } else { phase }).to_degrees()
    }

    fn limit_phase(&self, limit: &LimitCurve) -> Vec<f64> {
        limit.phase.iter().map(|phase| self.phase(*phase)).collect()
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = self.scheme.legend.clone();
        if !self.limits.is_empty() {
            entries.push((Key::Heading, "Limiting cases".into()));
        }
        for (limit, _) in &self.limits {
            entries.push((Key::Line(limit_band(limit.case, &self.scheme.curves)), limit_name(limit.case).into()));
        }
        let mut states = self.scheme.curves.iter().flat_map(|styled| &styled.curve.states);
        if states.any(|state| data::status_word(&state.status) == "self-excited") {
            entries.push((Key::Mark(Mark::Circle, INK, false), "self-excited".into()));
        }
        if self.scheme.curves.iter().any(|styled| styled.curve.down.iter().any(Option::is_some)) {
            entries.push((Key::Mark(Mark::Triangle, INK, false), "sweeping down".into()));
        }
        entries
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let entries = self.legend();
        let column = legend_width(&entries);
        let width = WIDTH - 92.0 - 30.0 - column - 20.0;
        let axis = || Axis::frequency("frequency f", self.span.0, self.span.1);
        let states = || self.scheme.curves.iter().flat_map(|s| &s.curve.states);
        let of_limits =
            self.limits.iter().flat_map(|(l, _)| limit_points(l, &l.amplitude, self.span, 1.0)).map(|p| p.1);
        let amplitudes = states().map(|s| s.amplitude).chain(of_limits);
        let amplitude = Axis::around(format!("amplitude α [{}]", self.unit.label), amplitudes.map(|a| self.unit.of(a)));
        let phases =
            states().map(|s| self.phase(s.phase)).chain(self.limits.iter().flat_map(|(l, _)| self.limit_phase(l)));
        let phase = phase_axis(phases);
        let upper = Panel { left: 92.0, top: 24.0, width, height: 330.0, x: axis(), y: amplitude };
        let lower = Panel { left: 92.0, top: 382.0, width, height: 300.0, x: axis(), y: phase };
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            upper.frame(canvas, false, true);
            lower.frame(canvas, true, true);
            for (limit, _) in &self.limits {
                let (case, band) = (limit.case, limit_band(limit.case, &self.scheme.curves));
                let points = limit_points(limit, &limit.amplitude, self.span, self.unit.factor);
                draw_limit(&upper, canvas, &points, case, band);
                for run in unbroken(&limit_points(limit, &self.limit_phase(limit), self.span, 1.0)) {
                    draw_limit(&lower, canvas, run, case, band);
                }
            }
            let mut widest_first: Vec<&Styled<'_>> = self.scheme.curves.iter().collect();
            widest_first.sort_by(|a, b| b.stroke.width.total_cmp(&a.stroke.width));
            for styled in widest_first {
                canvas.series(&styled.label, |canvas| self.curve(canvas, (&upper, &lower), styled));
            }
            legend(canvas, upper.right() + 30.0, 20.0, &entries);
        })
    }

    /// Amplitude and phase of one curve.
    fn curve(&self, canvas: &mut Canvas, (upper, lower): (&Panel, &Panel), styled: &Styled<'_>) {
        draw_curve(upper, canvas, styled.curve, styled.stroke, |s| self.unit.of(s.amplitude));
        // A line broken wherever the phase jumps by more than half a turn.
        let points = data::steady(styled.curve, |s| self.phase(s.phase));
        for run in unbroken(&points) {
            lower.curve(canvas, run, styled.stroke);
        }
        let dots = |s: &SteadyState| if points.len() == 1 { self.phase(s.phase) } else { f64::NAN };
        draw_curve(lower, canvas, styled.curve, styled.stroke, dots);
        let open = data::self_excited(styled.curve, |s| self.phase(s.phase));
        lower.marks(canvas, &open, Mark::Circle, 4.0, styled.stroke.color, false);
        let down = |of: &dyn Fn(&SteadyState) -> f64| -> Vec<Point> { other_branch(styled.curve, of) };
        let (a, p) = (down(&|s| self.unit.of(s.amplitude)), down(&|s| self.phase(s.phase)));
        upper.marks(canvas, &a, Mark::Triangle, 4.0, styled.stroke.color, false);
        lower.marks(canvas, &p, Mark::Triangle, 4.0, styled.stroke.color, false);
    }

    fn csv(&self) -> String {
        let amplitude = format!("amplitude [{}]", self.unit.label);
        let mut table = Table::new(&["curve", "frequency [Hz]", &amplitude, "phase [deg]", "status"]);
        for styled in &self.scheme.curves {
            for (f, s) in styled.curve.frequency.iter().zip(&styled.curve.states) {
                let numbers = [cell(*f), cell(self.unit.of(s.amplitude)), cell(self.phase(s.phase))];
                let [f, a, p] = numbers;
                table.row([styled.label.clone(), f, a, p, data::status_word(&s.status).into()]);
            }
            for (f, s) in styled.curve.frequency.iter().zip(&styled.curve.down) {
                if let Some(s) = s {
                    let [a, p] = [cell(self.unit.of(s.amplitude)), cell(self.phase(s.phase))];
                    let status = format!("{}, sweeping down", data::status_word(&s.status));
                    table.row([styled.label.clone(), cell(*f), a, p, status]);
                }
            }
        }
        for (limit, _) in &self.limits {
            let inside = |f: f64| (self.span.0 - 1e-9..=self.span.1 + 1e-9).contains(&f);
            for (i, f) in limit.frequency.iter().enumerate().filter(|(_, f)| inside(**f)) {
                let value = |values: &[f64]| values.get(i).copied().unwrap_or(f64::NAN);
                let (a, p) = (self.unit.of(value(&limit.amplitude)), self.phase(value(&limit.phase)));
                table.row([limit_name(limit.case).into(), cell(*f), cell(a), cell(p), "closed form".into()]);
            }
        }
        table.finish()
    }
}

/// States that only a downward sweep finds.
fn other_branch(curve: &Curve, of: &dyn Fn(&SteadyState) -> f64) -> Vec<Point> {
    curve.frequency.iter().zip(&curve.down).filter_map(|(f, s)| s.as_ref().map(|s| (*f, of(s)))).collect()
}

/// An axis of phases in degrees with ticks at multiples of 45 or 15.
pub(super) fn phase_axis(phases: impl IntoIterator<Item = f64>) -> Axis {
    let (low, high) = range(phases);
    let (low, high) = if low.is_finite() { (low, high) } else { (-180.0, 0.0) };
    let step = if high - low > 100.0 { 45.0 } else { 15.0 };
    let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
    Axis::linear("phase φ [°]", low, high.max(low + step)).step(step)
}

/// The points in runs without a jump of more than half a turn.
pub(super) fn unbroken(points: &[Point]) -> Vec<&[Point]> {
    points.chunk_by(|a, b| (a.1 - b.1).abs() <= 180.0 || !a.1.is_finite() || !b.1.is_finite()).collect()
}

impl Figure for Resonance {
    fn name(&self) -> &'static str {
        "resonance"
    }

    fn title(&self) -> &'static str {
        "Resonance curves"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Slow rollers near static contact, fast ones on full slip; between them peaks that may lie lower than both, since a contact that sticks and slips takes most energy.",
            "A peak higher than both limits without an effect in the scenario, open marks (self-excited states), or gaps (no state found).",
            "Compare peak frequencies with measured ones first: they tell the contact's stiffness better than heights do.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let curves: Vec<_> = data.scheme.curves.iter().map(|styled| styled.curve).collect();
        let mut notes = Vec::new();
        for (limit, _) in &data.limits {
            notes.push((
                format!("Peak, case {}", limit_name(limit.case)),
                peak_text((limit.peak_frequency, limit.peak_amplitude), &data.unit),
            ));
        }
        for styled in &data.scheme.curves {
            if let Some(peak) =
                data::peak(&data::steady(styled.curve, |s| s.amplitude)).filter(|_| styled.curve.frequency.len() > 2)
            {
                notes.push((format!("Peak, {}", styled.label), peak_text(peak, &data.unit)));
            }
        }
        let drives = data::Field::Drive.distinct(&curves).len();
        let of_drive = if drives > 1 { format!(" of the first of {drives} drives") } else { String::new() };
        let peaks = match data.limits.as_slice() {
            [(slip, _), (fixed, _)] => format!(
                " The limiting cases{of_drive} peak at {} (full slip or no contact) and {} (static contact); look for how {}.",
                peak_text((slip.peak_frequency, slip.peak_amplitude), &data.unit),
                peak_text((fixed.peak_frequency, fixed.peak_amplitude), &data.unit),
                if outcome.scenario.effects.is_empty() {
                    "each computed curve leaves the one and nears the other"
                } else {
                    "the effects of the scenario take the curves away from both"
                }
            ),
            _ => String::new(),
        };
        let drawn = data.scheme.curves.len();
        let (from, to) = range(curves.iter().flat_map(|curve| curve.frequency.iter().copied()));
        let caption = format!(
            "Amplitude α and phase φ of the arm at the drive frequency, {} from {} to {} Hz; wide and pale, the limiting cases.{peaks}{}{}{}",
            count(drawn, "computed curve"),
            cell(from),
            cell(to),
            coincidence(&curves, data.scheme.nested),
            branches(&curves),
            health(&curves)
        );
        let alt = format!(
            "Two stacked graphs against frequency: amplitude with resonance peaks, and phase falling through resonance, for {} and the limiting cases as wide pale lines beneath.",
            count(drawn, "condition")
        );
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes))
    }
}

/// What the caption says about frequencies with two steady states.
fn branches(curves: &[&Curve]) -> String {
    match curves.iter().flat_map(|curve| &curve.down).filter(|s| s.is_some()).count() {
        0 => String::new(),
        n => format!(" At {n} points a downward sweep ends in another state than an upward one (triangles)."),
    }
}

/// What the caption says about curves that lie on an earlier one.
fn coincidence(curves: &[&Curve], nested: bool) -> String {
    let count =
        (1..curves.len()).filter(|&i| curves[..i].iter().any(|earlier| data::coincide(earlier, curves[i]))).count();
    if count == 0 {
        return String::new();
    }
    let look =
        if nested { "the lines are nested so that all of them show" } else { "the line drawn later hides the other" };
    let verb = if count == 1 { "curve coincides" } else { "curves coincide" };
    format!(" {count} {verb} with another to a millionth of the largest amplitude; {look}.")
}

fn peak_text((f, a): Point, unit: &Unit) -> String {
    format!("{} at {f:.2} Hz", unit.show(a, 4))
}
