//! What is said of the contact in words and numbers.

use super::super::limits::VAGUE;
use super::super::words;
use super::{Data, Row};
use crate::compare::{Comparison, ContactPoint, units_of_force};
use crate::figures::style::{Table, cell, count, significant};
use crate::scenario::{Coordinate, Excitation, Rig};

/// The contact under the conditions of a comparison, from several sources, as CSV; without a contact the missing force.
pub fn csv(c: &Comparison, sources: &[(&str, &[ContactPoint])]) -> String {
    let contact = c.model.has_contact;
    let [stiffness, damping, motion] = if contact { ["N/m", "N s/m", "m"] } else { units_of_force(&c.model) };
    let amplitude =
        if contact { "speed amplitude [m/s]".into() } else { format!("amplitude of the motion [{motion}]") };
    let mut header = vec!["source".to_string()];
    header.extend(words::columns_of_condition(c));
    header.extend(["row".into(), "frequency [Hz]".into(), amplitude]);
    for (name, unit) in [("stiffness", stiffness), ("damping", damping)] {
        header.extend([format!("{name} [{unit}]"), format!("sd of {name} [{unit}]")]);
    }
    let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
    for (source, p) in sources.iter().flat_map(|(source, points)| points.iter().map(move |p| (source, p))) {
        let at = [p.frequency_hz, if contact { p.speed_amplitude_m_s } else { p.motion() }];
        let values = [p.stiffness_n_m, p.stiffness_sd_n_m, p.damping_n_s_m, p.damping_sd_n_s_m];
        let cells = std::iter::once(source.to_string()).chain(words::cells_of_condition(c, p.condition));
        table.row(cells.chain([p.row.to_string()]).chain(at.into_iter().chain(values).map(cell)));
    }
    table.finish()
}

impl Data<'_> {
    /// Everything shown, as CSV.
    pub(super) fn csv(&self) -> String {
        csv(self.c, &[("measured", &self.c.contact), ("model", &self.c.contact_model)])
    }

    /// What it shows.
    pub(super) fn caption(&self) -> String {
        let against = if self.by_speed {
            "against the amplitude bωα of the arm's speed; dotted, the speed V of the roller"
        } else {
            "against frequency"
        };
        format!(
            "Dynamic stiffness k (above) and damping c (below) of the contact, {against}: marks with bars of one standard \
             deviation, from the readings and the calibrated rig alone, with no law of the contact assumed; lines, those of the \
             model at the same points. Dashed: its Kelvin-Voigt element, stuck throughout; zero: full slip, no elastic force.{}{}",
            words::shown(self.c).1,
            self.remarks()
        )
    }

    /// The same without a contact.
    pub(super) fn caption_alone(&self) -> String {
        let against = if self.by_speed { "the amplitude of the motion" } else { "frequency" };
        let reading = self.c.table.signals.reading.name;
        let drive = match (self.c.model.rig, self.c.model.rig.coordinate()) {
            (Rig::Oscillator(rig), _) if rig.excitation != Excitation::Force => "(drive)",
            (_, Coordinate::Angle) => "T₀",
            (_, Coordinate::Displacement) => "F₀",
        };
        let lines = if self.c.model.effects.is_empty() { "" } else { "Lines, those of the model at the same points. " };
        format!(
            "What must act on the rig besides its own stiffness K, damping C and mass M, as a stiffness k (above) and a damping c (below), \
             against {against}: marks with bars of one standard deviation, from drive, {reading} and the calibrated linear rig alone, \
             k + iωc = {drive}/x − (K − Mω² + iωC). {lines}Zero: nothing is missing.{}{}",
            words::shown(self.c).1,
            self.remarks()
        )
    }

    /// What the captions say of lines that coincide and of readings that say little.
    fn remarks(&self) -> String {
        let mut remarks = String::new();
        let lines = self.c.model.has_contact || !self.c.model.effects.is_empty();
        if lines && self.columns.iter().any(|column| column.curves.len() > 1) {
            remarks += " Of several lines the first are wider, so that those that coincide show.";
        }
        let points = || self.columns.iter().flat_map(|column| &column.curves).flat_map(|curve| &curve.measured);
        let pairs = || self.rows.iter().zip(&self.limits);
        let vague = points().filter(|p| pairs().any(|(row, limits)| limits.vague(p, row))).count();
        let outside = points().filter(|p| pairs().any(|(row, limits)| limits.outside(p, row).is_some())).count();
        if vague > 0 {
            remarks += &format!(
                " Faded: {} whose standard deviation is more than {} times the typical one.",
                count(vague, "reading"),
                VAGUE
            );
        }
        if outside > 0 {
            let verb = if outside == 1 { "lies" } else { "lie" };
            remarks += &format!(" Arrows at the edges: {} that {verb} beyond the axes.", count(outside, "reading"));
        }
        remarks
    }

    /// Key numbers without a contact.
    pub(super) fn notes_alone(&self) -> Vec<(String, String)> {
        let [k, c] = &self.rows;
        let text = format!("{} σ in k, {} σ in c", self.distance(k), self.distance(c));
        vec![("Measured against model, root mean square".into(), text)]
    }

    /// Root mean square distance of the model from what was measured \[standard deviations\].
    fn distance(&self, row: &Row) -> String {
        let pairs = self.c.contact.iter().zip(&self.c.contact_model);
        let square: Vec<f64> = pairs
            .filter_map(|(p, q)| {
                let r = ((row.value)(p) - (row.value)(q)) / (row.sd)(p);
                r.is_finite().then_some(r * r)
            })
            .collect();
        significant((square.iter().sum::<f64>() / square.len().max(1) as f64).sqrt(), 3)
    }

    /// Key numbers.
    pub(super) fn notes(&self) -> Vec<(String, String)> {
        let [k, c] = &self.rows;
        let stuck = |row: &Row| row.unit.show(row.stuck.unwrap_or(f64::NAN), 3);
        vec![
            ("Kelvin-Voigt element of the model, stuck".into(), format!("k = {}, c = {}", stuck(k), stuck(c))),
            (
                "Measured against model, root mean square".into(),
                format!("{} σ in k, {} σ in c", self.distance(k), self.distance(c)),
            ),
        ]
    }
}
