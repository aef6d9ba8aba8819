//! What is seen in a table, in lines.

use super::draft::{Draft, digits};
use crate::measurement::{Direction, Mode, Point, Series, peaks};
use crate::scenario::Signal;
use crate::statistics::median;
use crate::units::{self, count};

/// Two neighbours along a series whose responses per drive differ by this many times what their neighbours do are a
/// jump, if by more than this many standard deviations.
const JUMP: (f64, f64) = (5.0, 8.0);

impl Draft<'_> {
    /// What is seen, in lines.
    pub fn description(&self) -> Vec<String> {
        let table = &self.seen.table;
        let (drive, reading) = self.signals();
        let mut lines = vec![format!("{}: {}", self.table.display(), table.summary())];
        for (number, (series, points)) in self.series().enumerate() {
            lines.push(format!("  {}", self.of_series(number, series, &points, drive, reading)));
        }
        lines.extend(table.notes.iter().map(|note| format!("  note: {note}")));
        let r = &self.resonance;
        lines.push(format!(
            "resonance near {}, quality factor about {}",
            units::format(digits(r.frequency, resolving(r.quality)), "Hz"),
            digits(r.quality, 2)
        ));
        lines.extend(self.lacking().into_iter().map(|text| format!("  note: {text}")));
        lines
    }

    fn of_series(&self, number: usize, series: &Series, points: &[&Point], drive: Signal, reading: Signal) -> String {
        let show = |value: f64, unit: &str| units::format(digits(value, 3), unit);
        let name =
            if series.name.is_empty() { format!("series {}", number + 1) } else { format!("series {}", series.name) };
        let [low, high] = [series.drives.0, series.drives.1].map(|level| show(level, drive.unit));
        let driven = if low == high { low } else { format!("{low} to {high}") };
        let range = |of: &dyn Fn(&Point) -> f64| {
            points.iter().map(|p| of(p)).fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(x), b.max(x)))
        };
        let (least, most) = range(&|p| p.amplitude);
        let swept = match series.direction {
            Direction::Up => ", swept up",
            Direction::Down => ", swept down",
            Direction::Unknown => "",
        };
        let contact = if self.rolls {
            format!("V = {}, W = {}, ", show(series.speed, "m/s"), show(series.load, "N"))
        } else {
            String::new()
        };
        let own: Vec<Point> = points.iter().map(|p| (*p).clone()).collect();
        let seen = self.resonance_of(&own).map_or(String::new(), |r| {
            let frequency = units::format(digits(r.frequency, resolving(r.quality)), "Hz");
            format!(", resonance near {frequency} with Q about {}", digits(r.quality, 2))
        });
        let jumps = match jumps(points) {
            0 => String::new(),
            n => format!(", {} (two stable states?)", count(n, "jump")),
        };
        format!(
            "{name}: {}, {contact}{} {driven}, {} {} to {}{swept}{seen}{jumps}",
            count(points.len(), "point"),
            drive.name,
            reading.name,
            show(least, reading.unit),
            show(most, reading.unit)
        )
    }

    /// What the table lacks, and what that costs.
    fn lacking(&self) -> Vec<String> {
        let mut lacking = Vec::new();
        if let [first, others @ ..] = self.modes {
            let show = |f: f64| units::format(digits(f, 3), "Hz");
            let others: Vec<String> = others.iter().map(|mode| show(mode.frequency)).collect();
            lacking.push(format!(
                "{} resonances: a scenario is of one mode, here of that near {}; for the others, near {}, change `frequency` in \
                 [measurement]",
                self.modes.len(),
                show(first.frequency),
                others.join(", ")
            ));
        }
        let peaks = peaks(&self.seen.table);
        if let [first, others @ ..] = &peaks[..] {
            let show = |mode: &Mode| units::format(digits(mode.frequency, 3), "Hz");
            let others: Vec<String> = others.iter().map(show).collect();
            lacking.push(format!(
                "{} peaks, near {} and {}, with valleys below half power between them: one mode has one, and what it lacks \
                 may be the other; `frequency` in [measurement] keeps to one of them",
                peaks.len(),
                show(first),
                others.join(", ")
            ));
        }
        if let Some((from, to)) = self.band.filter(|_| self.modes.is_empty()) {
            lacking.push(format!(
                "the readings from {from} to {to} Hz, about the resonance, are used: calibrated to all, the model has another one; \
                 what lies beyond it does not explain, and is used again without `frequency` in [measurement]"
            ));
        }
        if self.seen.table.points.iter().all(|p| p.phase.is_none()) {
            lacking.push("no phases: delays cannot be told, damping and nonlinearity less well".into());
        } else if self.resonance.phase.is_none() {
            lacking.push("the phases do not show that resonance: the amplitudes alone tell it".into());
        }
        let drives: Vec<f64> = self.seen.table.series.iter().map(|s| s.drive).collect();
        let spread = drives.iter().copied().fold(0.0, f64::max) / drives.iter().copied().fold(f64::INFINITY, f64::min);
        if spread < 1.2 {
            lacking.push(
                "one drive level: whether anything depends on the amplitude shows only in the shape of the peak; sweep again \
                 at a third and at three times the drive"
                    .into(),
            );
        }
        if !self.resonance.spanned {
            lacking.push("the readings lie on one side of the resonance only".into());
        }
        lacking
    }
}

/// Digits of a frequency that tell a tenth of the width of its resonance, at least three.
fn resolving(quality: f64) -> usize {
    2 + quality.log10().ceil().max(1.0) as usize
}

/// Steps of the response per drive between neighbours along the frequency that are far larger, and far steeper, than
/// the steps about them, which do not take them back: of readings that lie in groups the steps between these are large. A
/// first or a last reading alone may be an outlier as well.
fn jumps(points: &[&Point]) -> usize {
    let response = |p: &Point| p.amplitude / p.drive;
    let step = |pair: &[&Point]| (response(pair[1]) / response(pair[0])).ln();
    let steps: Vec<f64> = points.windows(2).map(step).collect();
    let noise = median(points.iter().map(|p| p.amplitude_sd / p.amplitude));
    let apart = |i: usize| points[i + 1].frequency - points[i].frequency;
    let is_jump = |i: usize| {
        let (first, end) = (i.saturating_sub(2), (i + 3).min(steps.len()));
        let largest = (first..end).filter(|&j| j != i).map(|j| steps[j].abs()).fold(noise, f64::max);
        let (step, kept) = (steps[i].abs(), steps[first..end].iter().sum::<f64>() * steps[i].signum());
        let others = (first..end).filter(|&j| j != i).map(|j| [steps[j].abs(), apart(j)]);
        let [about, over] = others.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        let steep = step * over > JUMP.0 * about * apart(i);
        steep && step > JUMP.0 * largest && step > JUMP.1 * noise && 2.0 * kept > step
    };
    (1..steps.len().saturating_sub(1)).filter(|&i| is_jump(i)).count()
}
