//! What is said of the overlay in words and numbers.

use super::super::sigma::BAND;
use super::super::words;
use super::{BAR, Data};
use crate::compare::Compared;
use crate::figures::style::{Table, cell, count, significant};
use crate::solver::Status;

impl Data<'_> {
    /// Everything shown, as CSV.
    pub(super) fn csv(&self) -> String {
        let value = self.label();
        let (sd, model) = (format!("sd of {value}"), format!("model {value}"));
        let header =
            ["kind", "condition", "row", "frequency [Hz]", &value, &sd, &model, "error [sigma]", "phase error [sigma]"];
        let mut table = Table::new(&header);
        for condition in 0..self.c.conditions.len() {
            let name = words::condition(self.c, condition);
            let measured = self.measured(condition);
            let points = self.points(condition).filter(|p| !self.phase || p.point.phase.is_some());
            for (p, (f, y, bar)) in points.zip(measured) {
                let of_phase = p.phase_residual.unwrap_or(f64::NAN);
                let (model, error) = match self.phase {
                    true => (self.degrees(p.model.phase), of_phase),
                    false => (self.amplitude.value(p.model.amplitude, p.point.drive), p.amplitude_residual),
                };
                let numbers = [f, y, bar / BAR, model, error, of_phase].map(cell);
                table.row(["reading".into(), name.clone(), p.point.row.to_string()].into_iter().chain(numbers));
            }
            for (f, y) in self.curve(condition) {
                let blank = String::new;
                let cells = [cell(f), blank(), blank(), cell(y), blank(), blank()];
                table.row(["curve".into(), name.clone(), blank()].into_iter().chain(cells));
            }
        }
        table.finish()
    }

    /// What it shows.
    pub(super) fn caption(&self) -> String {
        let signals = &self.c.table.signals;
        let (what, companion): (String, &str) = match self.phase {
            true if signals.of_arm() => ("Phase φ relative to the actuator".into(), ""),
            true => (format!("Phase φ of the {} relative to the {}", signals.reading.name, signals.drive.name), ""),
            false => {
                let strip = " The strip below each panel shows the errors of amplitude and, where measured, phase.";
                let of = if signals.of_arm() { String::new() } else { format!(" of the {}", signals.reading.name) };
                (format!("Amplitude{of}"), strip)
            }
        };
        let lost = self.c.points.iter().filter(|p| p.model.status != Status::Steady).count();
        let unsteady = match lost {
            0 => String::new(),
            n => format!(" At {} the model has no steady state.", count(n, "point")),
        };
        format!(
            "{what} against frequency, one panel per condition: measured points with 95 % error bars over the curve of the \
             calibrated model.{companion} {}{}{unsteady}",
            self.scale.sentence(),
            words::shown(self.c).1
        )
    }

    /// Key numbers.
    pub(super) fn notes(&self) -> Vec<(String, String)> {
        let m = &self.c.overall;
        let (error, noise) = match self.phase {
            true => (m.rms_phase_deg, m.noise_phase_deg),
            false => (Some(m.rms_error_percent), Some(m.noise_percent)),
        };
        let unit = if self.phase { "°" } else { " %" };
        let show = |value: Option<f64>| format!("{}{unit}", significant(value.unwrap_or(f64::NAN), 3));
        let residual = |p: &Compared| if self.phase { p.phase_residual } else { Some(p.amplitude_residual) };
        let beyond = self.c.points.iter().filter_map(residual).filter(|r| r.abs() > BAND).count();
        let all = self.c.points.iter().filter_map(residual).count();
        vec![
            ("Root mean square error".into(), format!("{} (noise {})", show(error), show(noise))),
            (
                "Readings beyond ±2 σ".into(),
                format!("{beyond} of {all}; noise alone: about {:.0}", 0.0455 * all as f64),
            ),
        ]
    }
}
