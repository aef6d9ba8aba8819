//! Sizes of a rig and of its motion, from which every range of a search follows.

use super::lumps::Lumps;
use super::{Model, Operation};
use crate::parameter::Scales;
use crate::statistics::median;

/// Quality factor that stands for that of a rig without damping.
const UNDAMPED: f64 = 1e9;

impl Model {
    /// The model with the scales that it has at these operating points and amplitudes of the reading, its rig and
    /// contact being as stated.
    pub fn scaled_at(mut self, points: &[(Operation, f64)]) -> Self {
        self.scales = self.scales(points);
        self
    }

    fn scales(&self, points: &[(Operation, f64)]) -> Scales {
        let Some((first, _)) = points.first() else { return self.scales };
        let lumps = Lumps::new(self, first);
        let (k, m, c) = (lumps.stiffness.value, lumps.inertia.value, lumps.damping.value);
        // Without what is looked for, and as read.
        let motions = points.iter().map(|(at, reading)| {
            let lumps = Lumps::new(self, at);
            let (re, im): (f64, f64) = lumps.free_response();
            [re.hypot(im), reading / lumps.amplitude_gain.value]
        });
        let largest = |of: usize| motions.clone().map(|both| both[of]).filter(|x| x.is_finite()).fold(0.0, f64::max);
        // A contact may have kept the motion small; a resonance that bends away never has that of a linear one.
        let motion = if self.has_contact { largest(0) } else { largest(0).min(largest(1)) };
        let loads: Vec<f64> = points.iter().map(|(at, _)| at.load).filter(|load| *load > 0.0).collect();
        let load = if loads.is_empty() { 0.0 } else { median(loads) };
        Scales {
            omega: (k / m).sqrt(),
            quality: ((k * m).sqrt() / c).min(UNDAMPED),
            stiffness: k,
            motion,
            lever: lumps.arm.value,
            contact_stiffness: lumps.contact_stiffness.value,
            friction_force: lumps.friction.value * load,
            load,
            roller_speed: points.iter().map(|(at, _)| at.speed).fold(0.0, f64::max),
            has_contact: self.has_contact,
            series: points.iter().map(|(at, _)| at.series + 1).max().unwrap_or(0),
            spacing: spacing(points),
        }
    }
}

/// Median distance of neighbouring frequencies of a series \[rad/s\]; 0 where there are none.
fn spacing(points: &[(Operation, f64)]) -> f64 {
    let mut places: Vec<(usize, f64)> = points.iter().map(|(at, _)| (at.series, at.frequency)).collect();
    places.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let neighbours = places.windows(2).filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 < pair[1].1);
    let distances: Vec<f64> = neighbours.map(|pair| pair[1].1 - pair[0].1).collect();
    if distances.is_empty() { 0.0 } else { std::f64::consts::TAU * median(distances) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ranges_of_the_catalogue_are_those_of_the_papers_rig() {
        let mut points = Vec::new();
        for drive in [2.5e-6, 7.5e-6] {
            for step in 0..24 {
                let frequency = 52.0 + 2.0 * f64::from(step);
                points.push((Operation { speed: 0.1, load: 20.0, drive, frequency, series: 0 }, 1e-9));
            }
        }
        let found = Model::new(&crate::scenario::paper()).scaled_at(&points).scales;
        assert_eq!(found, Scales { series: 1, spacing: 2.0 * std::f64::consts::TAU, ..Scales::PAPER });
    }
}
