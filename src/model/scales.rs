//! Sizes of a rig and of its motion, from which every range of a search follows.

use super::lumps::Lumps;
use super::{Model, Operation};
use crate::parameter::Scales;
use crate::statistics::median;

/// Quality factor that stands for that of a rig without damping.
const UNDAMPED: f64 = 1e9;

impl Model {
    /// The model with the scales that it has at these operating points, its rig and contact being as stated.
    pub fn scaled_at(mut self, points: &[Operation]) -> Self {
        self.scales = self.scales(points);
        self
    }

    fn scales(&self, points: &[Operation]) -> Scales {
        let Some(first) = points.first() else { return self.scales };
        let lumps = Lumps::new(self, first);
        let (k, m, c) = (lumps.stiffness.value, lumps.inertia.value, lumps.damping.value);
        let motion = |at: &Operation| {
            let (re, im): (f64, f64) = Lumps::new(self, at).free_response();
            re.hypot(im)
        };
        let motion = points.iter().map(motion).filter(|x| x.is_finite()).fold(0.0, f64::max);
        let loads: Vec<f64> = points.iter().map(|at| at.load).filter(|load| *load > 0.0).collect();
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
            roller_speed: points.iter().map(|at| at.speed).fold(0.0, f64::max),
            has_contact: self.has_contact,
        }
    }
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
                points.push(Operation { speed: 0.1, load: 20.0, drive, frequency });
            }
        }
        let found = Model::new(&crate::scenario::paper()).scaled_at(&points).scales;
        assert_eq!(found, Scales::PAPER);
    }
}
