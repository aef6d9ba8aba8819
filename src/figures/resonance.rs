//! Amplitude and phase against frequency, one curve per condition, between the limiting cases (paper Figures 5 and 6).

use super::axes::{Axis, Panel, range};
use super::canvas::{Canvas, Dash, Point, Stroke, document};
use super::data::{self, health};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::Mark;
use super::scheme::{Scheme, Styled, draw_curve, draw_limit, limit_band, limit_name, limit_points, limits};
use super::style::{DOTS, HEIGHT, INK, Table, Unit, WIDTH, cell, count};
use super::{Drawing, Figure, FigureError};
use crate::scenario::Signals;
use crate::solver::SteadyState;
use crate::sweep::{Curve, LimitCurve, Outcome};
use crate::units::Frequencies;
use std::f64::consts::PI;

/// Dash of what only a sweep downwards finds.
const DOWN: Dash = Dash::Dashes(8.0, 4.0);
/// How to read it where there is no contact.
const ALONE: [&str; 3] = [
    "One peak for every drive, at the same frequency and as much higher as the drive is stronger: the rig is linear.",
    "Peaks that move, lean or grow less than the drive, which is what effects of the scenario do; open marks (self-excited states), or gaps (no state found).",
    "Compare frequency, height and width of the peaks with measured ones, drive by drive.",
];

/// The figure.
pub struct Resonance;

/// What is shown.
struct Data<'a> {
    scheme: Scheme<'a>,
    limits: Vec<(&'a LimitCurve, Stroke)>,
    span: (f64, f64),
    unit: Unit,
    wraps: bool,
    signals: Signals,
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
        let signals = outcome.scenario.signals;
        let unit = Unit::of_signal(largest, signals.reading.unit);
        let (scheme, wraps) = (Scheme::of(&curves, outcome), high > 0.5 * PI && low < -0.5 * PI);
        Ok(Self { scheme, limits, span, unit, wraps, signals })
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
            entries.push((Key::Line(Stroke::dashed(INK, 2.0, DOWN)), "sweeping down".into()));
            entries.push((Key::Mark(Mark::Circle, INK, true), "fold: the sweep jumps".into()));
        }
        entries
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let entries = self.legend();
        let column = legend_width(&entries);
        let width = WIDTH - 92.0 - 30.0 - column - 20.0;
        let axis = || Axis::frequency("frequency f", self.span.0, self.span.1);
        let states =
            || self.scheme.curves.iter().flat_map(|s| s.curve.states.iter().chain(s.curve.down.iter().flatten()));
        let of_limits =
            self.limits.iter().flat_map(|(l, _)| limit_points(l, &l.amplitude, self.span, 1.0)).map(|p| p.1);
        let amplitudes = states().map(|s| s.amplitude).chain(of_limits);
        let label = format!("{} [{}]", data::reading(&self.signals), self.unit.label);
        let amplitude = Axis::around(label, amplitudes.map(|a| self.unit.of(a)));
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
        if styled.curve.down.iter().any(Option::is_some) {
            self.branches(canvas, upper, styled, false);
            self.branches(canvas, lower, styled, true);
            return;
        }
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
    }

    /// A curve that folds: what a sweep upwards finds as it is drawn elsewhere, what one downwards finds besides
    /// dashed; marks where they jump, and thin lines to where they land.
    fn branches(&self, canvas: &mut Canvas, panel: &Panel, styled: &Styled<'_>, phase: bool) {
        let of = |s: &SteadyState| if phase { self.phase(s.phase) } else { self.unit.of(s.amplitude) };
        // Phases are not joined across half a turn.
        let draw = |canvas: &mut Canvas, points: &[Point], stroke| match phase {
            true => unbroken(points).iter().for_each(|run| panel.curve(canvas, run, stroke)),
            false => panel.curve(canvas, points, stroke),
        };
        let folds = folds(styled.curve);
        let mut up = data::steady(styled.curve, of);
        // Highest first, so that places before stay where they are.
        for fold in folds.iter().filter(|fold| !fold.down).rev() {
            let (at, next) = (fold.from.min(fold.to), fold.from.max(fold.to));
            up.insert(next, (0.5 * (up[at].0 + up[next].0), f64::NAN));
        }
        let solid = styled.stroke;
        draw(canvas, &up, solid);
        let dashed = Stroke::dashed(solid.color, solid.width, DOWN);
        down_lines(styled.curve, &of).iter().for_each(|line| draw(canvas, line, dashed));
        for fold in &folds {
            let [from, to] = [(fold.from, fold.down), (fold.to, false)].map(|(at, down)| {
                let other = styled.curve.down[at].as_ref().filter(|_| down);
                (styled.curve.frequency[at], of(other.unwrap_or(&styled.curve.states[at])))
            });
            panel.curve(canvas, &[from, to], Stroke::dashed(solid.color, 1.3, DOTS));
            panel.marks(canvas, &[from], Mark::Circle, 4.2, solid.color, true);
        }
        panel.marks(canvas, &data::self_excited(styled.curve, of), Mark::Circle, 4.0, solid.color, false);
    }

    /// Peaks and folds as key numbers.
    fn notes(&self, digits: &Frequencies) -> Vec<(String, String)> {
        let mut notes = Vec::new();
        for (limit, _) in &self.limits {
            notes.push((format!("Peak, case {}", limit_name(limit.case)), self.limiting_peak(limit, digits)));
        }
        for styled in &self.scheme.curves {
            if let Some(peak) = peak_of(styled.curve).filter(|_| styled.curve.frequency.len() > 2) {
                notes.push((format!("Peak, {}", styled.label), peak_text(peak, &self.unit, digits)));
            }
            let folds = folds(styled.curve);
            if !folds.is_empty() {
                let one = |fold: &Fold| {
                    let way = if fold.down { "down" } else { "up" };
                    format!("sweeping {way} jumps at {}", digits.show(styled.curve.frequency[fold.from]))
                };
                let text = folds.iter().map(one).collect::<Vec<_>>().join(", ");
                notes.push((format!("Folds, {}", styled.label), text));
            }
        }
        notes
    }

    fn limiting_peak(&self, limit: &LimitCurve, digits: &Frequencies) -> String {
        peak_text((limit.peak_frequency, limit.peak_amplitude), &self.unit, digits)
    }

    /// What the caption says about the peaks of the limiting cases.
    fn limiting_peaks(&self, effects: bool, digits: &Frequencies) -> String {
        let [(slip, _), (fixed, _)] = self.limits.as_slice() else { return String::new() };
        let curves: Vec<_> = self.scheme.curves.iter().map(|styled| styled.curve).collect();
        let drives = data::Field::Drive(self.signals.drive).distinct(&curves).len();
        let of_drive = if drives > 1 { format!(" of the first of {drives} drives") } else { String::new() };
        format!(
            " The limiting cases{of_drive} peak at {} (full slip or no contact) and {} (static contact); look for how {}.",
            self.limiting_peak(slip, digits),
            self.limiting_peak(fixed, digits),
            if effects {
                "the effects of the scenario take the curves away from both"
            } else {
                "each computed curve leaves the one and nears the other"
            }
        )
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

/// Where a sweep jumps from one branch to the other: the last frequency before it and the first after it, by their
/// indices.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fold {
    from: usize,
    to: usize,
    /// Whether it is a sweep downwards that jumps.
    down: bool,
}

/// Runs of frequencies with two states, as their first and last index.
fn double(curve: &Curve) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (i, _) in curve.down.iter().enumerate().filter(|(_, s)| s.is_some()) {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == i => *last = i,
            _ => runs.push((i, i)),
        }
    }
    runs
}

/// Whether the branch of a sweep downwards is the one that goes on in the state at `beyond`, next to the end `at` of a
/// run.
fn down_goes_on(curve: &Curve, at: usize, beyond: usize) -> bool {
    let complex = |s: &SteadyState| (s.amplitude * s.phase.cos(), s.amplitude * s.phase.sin());
    let far = |s: &SteadyState| {
        let ((a, b), (x, y)) = (complex(s), complex(&curve.states[beyond]));
        (a - x).hypot(b - y)
    };
    curve.down[at].as_ref().is_some_and(|down| far(down) < far(&curve.states[at]))
}

/// The folds of a curve within its range, in the order of the frequency.
fn folds(curve: &Curve) -> Vec<Fold> {
    let mut folds = Vec::new();
    for (first, last) in double(curve) {
        let ends = [first.checked_sub(1).map(|next| (first, next)), Some((last, last + 1))];
        for (from, to) in ends.into_iter().flatten().filter(|(_, to)| *to < curve.states.len()) {
            folds.push(Fold { from, to, down: !down_goes_on(curve, from, to) });
        }
    }
    folds
}

/// What only a sweep downwards finds, joined with the states in which it goes on.
fn down_lines(curve: &Curve, of: &dyn Fn(&SteadyState) -> f64) -> Vec<Vec<Point>> {
    let single = |at: usize| (curve.frequency[at], of(&curve.states[at]));
    let line = |(first, last): (usize, usize)| {
        let before = first.checked_sub(1).filter(|&beyond| down_goes_on(curve, first, beyond)).map(single);
        let after = Some(last + 1).filter(|&beyond| beyond < curve.states.len() && down_goes_on(curve, last, beyond));
        let inner = (first..=last).filter_map(|i| curve.down[i].as_ref().map(|s| (curve.frequency[i], of(s))));
        before.into_iter().chain(inner).chain(after.map(single)).collect()
    };
    double(curve).into_iter().map(line).collect()
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
        let (signals, digits) = (&outcome.scenario.signals, data::frequencies(outcome));
        let peaks = data.limiting_peaks(!outcome.scenario.effects.is_empty(), &digits);
        let drawn = data.scheme.curves.len();
        let (from, to) = range(curves.iter().flat_map(|curve| curve.frequency.iter().copied()));
        let (whose, limiting) = match signals.of_arm() {
            true => ("the arm".to_string(), "; wide and pale, the limiting cases"),
            false => (format!("the {}", signals.reading.name), ""),
        };
        let caption = format!(
            "Amplitude {} and phase φ of {whose} at the drive frequency, {} from {} to {} Hz{limiting}.{peaks}{}{}{}",
            signals.reading.symbol,
            count(drawn, "computed curve"),
            cell(from),
            cell(to),
            coincidence(&curves, data.scheme.nested),
            branches(&curves),
            health(&curves)
        );
        let beneath = if signals.of_arm() { " and the limiting cases as wide pale lines beneath" } else { "" };
        let alt = format!(
            "Two stacked graphs against frequency: amplitude with resonance peaks, and phase falling through resonance, for {}{beneath}.",
            count(drawn, "condition")
        );
        let svg = data.draw(self.title(), &alt)?;
        let mut drawing = Drawing::of(self, (caption, alt), (svg, data.csv()), data.notes(&digits));
        if outcome.scenario.contact.is_none() {
            drawing.reading = ALONE.map(String::from);
        }
        Ok(drawing.told_of(&outcome.scenario))
    }
}

/// What the caption says about frequencies with two steady states.
fn branches(curves: &[&Curve]) -> String {
    match curves.iter().flat_map(|curve| &curve.down).filter(|s| s.is_some()).count() {
        0 => String::new(),
        n => format!(
            " At {n} points a downward sweep ends in another state than an upward one (dashed); dots mark where each of them \
             jumps to the other."
        ),
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

fn peak_text((f, a): Point, unit: &Unit, digits: &Frequencies) -> String {
    format!("{} at {}", unit.show(a, 4), digits.fixed(f))
}

/// The largest amplitude of either branch.
fn peak_of(curve: &Curve) -> Option<Point> {
    let up = data::peak(&data::steady(curve, |s| s.amplitude));
    let down = down_lines(curve, &|s| s.amplitude).into_iter().filter_map(|line| data::peak(&line));
    up.into_iter().chain(down).reduce(|a, b| if b.1 > a.1 { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Formulation;
    use crate::solver::{Method, Status};
    use crate::sweep::Condition;

    fn state(amplitude: f64) -> SteadyState {
        SteadyState {
            amplitude,
            phase: 0.0,
            mean: 0.0,
            speed_amplitude: 0.0,
            stick_fraction: 0.0,
            force_minimum: 0.0,
            force_maximum: 0.0,
            cycles: 1,
            periodicity_error: 0.0,
            status: Status::Steady,
            method: Method::Shooting,
        }
    }

    fn curve(up: &[f64], down: &[f64]) -> Curve {
        let condition = Condition {
            formulation: Formulation::Series,
            euler_steps: 1,
            drive: 1.0,
            load: 0.0,
            friction: 0.0,
            speed: 0.0,
            series: 0,
        };
        let other = |(up, down): (&f64, &f64)| (up != down).then(|| state(*down));
        Curve {
            condition,
            frequency: (0..up.len()).map(|i| i as f64).collect(),
            states: up.iter().map(|a| state(*a)).collect(),
            down: up.iter().zip(down).map(other).collect(),
            orbits: Vec::new(),
        }
    }

    #[test]
    fn a_sweep_up_falls_where_a_hardening_peak_ends_and_one_down_rises_where_its_foot_does() {
        let hardening = curve(&[1.0, 2.0, 3.0, 4.0, 5.0, 0.6, 0.5], &[1.0, 2.0, 0.9, 0.8, 0.7, 0.6, 0.5]);
        let (fall, rise) = (Fold { from: 4, to: 5, down: false }, Fold { from: 2, to: 1, down: true });
        assert_eq!(folds(&hardening), [rise, fall]);
        let lines = down_lines(&hardening, &|s| s.amplitude);
        assert_eq!(lines, [[(2.0, 0.9), (3.0, 0.8), (4.0, 0.7), (5.0, 0.6)]]);
        // By a parabola through the readings about the largest.
        assert!(peak_of(&hardening).is_some_and(|(f, a)| (f - 4.0).abs() < 0.5 && (a - 5.0).abs() < 0.5));
    }

    #[test]
    fn a_softening_peak_is_that_of_a_sweep_down() {
        let softening = curve(&[0.5, 0.6, 0.7, 0.8, 3.0, 2.0, 1.0], &[0.5, 0.6, 5.0, 4.0, 3.0, 2.0, 1.0]);
        let (rise, fall) = (Fold { from: 3, to: 4, down: false }, Fold { from: 2, to: 1, down: true });
        assert_eq!(folds(&softening), [fall, rise]);
        assert_eq!(peak_of(&softening), Some((2.0, 5.0)));
    }

    #[test]
    fn branches_that_reach_the_end_of_the_sweep_fold_only_within_it() {
        let cut = curve(&[1.0, 1.2, 1.4], &[1.0, 0.5, 0.4]);
        assert_eq!(folds(&cut), [Fold { from: 1, to: 0, down: true }]);
        assert_eq!(folds(&curve(&[1.0, 2.0], &[1.0, 2.0])), []);
    }
}
