//! What is said of the contact in words and numbers.

use super::super::limits::VAGUE;
use super::super::words;
use super::{Data, Row};
use crate::compare::{ConditionMetrics, ContactPoint};
use crate::figures::style::{Table, cell, count, significant};

/// The contact under the conditions of a comparison, from several sources, as CSV.
pub fn csv(conditions: &[ConditionMetrics], sources: &[(&str, &[ContactPoint])]) -> String {
    let header = [
        "source",
        "speed [m/s]",
        "load [N]",
        "drive [m]",
        "row",
        "frequency [Hz]",
        "speed amplitude [m/s]",
        "stiffness [N/m]",
        "sd of stiffness [N/m]",
        "damping [N s/m]",
        "sd of damping [N s/m]",
    ];
    let mut table = Table::new(&header);
    for (source, p) in sources.iter().flat_map(|(source, points)| points.iter().map(move |p| (source, p))) {
        let s = conditions[p.condition].setting;
        let at = [p.frequency_hz, p.speed_amplitude_m_s];
        let values = [p.stiffness_n_m, p.stiffness_sd_n_m, p.damping_n_s_m, p.damping_sd_n_s_m];
        let cells = std::iter::once(source.to_string()).chain([s.speed, s.load, s.drive].map(cell));
        table.row(cells.chain([p.row.to_string()]).chain(at.into_iter().chain(values).map(cell)));
    }
    table.finish()
}

impl Data<'_> {
    /// Everything shown, as CSV.
    pub(super) fn csv(&self) -> String {
        csv(&self.c.conditions, &[("measured", &self.c.contact), ("model", &self.c.contact_model)])
    }

    /// What it shows.
    pub(super) fn caption(&self) -> String {
        let against = if self.by_speed {
            "against the amplitude bωα of the arm's speed; dotted, the speed V of the roller"
        } else {
            "against frequency"
        };
        let mut remarks = String::new();
        if self.columns.iter().any(|column| column.curves.len() > 1) {
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
        format!(
            "Dynamic stiffness k (above) and damping c (below) of the contact, {against}: marks with bars of one standard \
             deviation, from the readings and the calibrated rig alone, with no law of the contact assumed; lines, those of the \
             model at the same points. Dashed: its Kelvin-Voigt element, stuck throughout; zero: full slip, no elastic force.{}{remarks}",
            words::shown(self.c).1
        )
    }

    /// Key numbers.
    pub(super) fn notes(&self) -> Vec<(String, String)> {
        let [k, c] = &self.rows;
        let worst = |row: &Row, of: &dyn Fn(&ContactPoint) -> (f64, f64)| {
            let pairs = self.c.contact.iter().zip(&self.c.contact_model);
            let square: Vec<f64> = pairs
                .filter_map(|(p, q)| {
                    let r = ((row.value)(p) - (row.value)(q)) / of(p).1;
                    r.is_finite().then_some(r * r)
                })
                .collect();
            significant((square.iter().sum::<f64>() / square.len().max(1) as f64).sqrt(), 3)
        };
        let sd = |row: &Row| worst(row, &|p| ((row.value)(p), (row.sd)(p)));
        vec![
            (
                "Kelvin-Voigt element of the model, stuck".into(),
                format!("k = {}, c = {}", k.unit.show(k.stuck, 3), c.unit.show(c.stuck, 3)),
            ),
            ("Measured against model, root mean square".into(), format!("{} σ in k, {} σ in c", sd(k), sd(c))),
        ]
    }
}
