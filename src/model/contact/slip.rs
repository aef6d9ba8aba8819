//! The slip rate at which the bristles pull as hard as friction holds, on its several branches.

use super::Problem;
use crate::model::system::{Forcing, HybridSystem};
use crate::roots::regula_falsi;

impl Problem {
    /// Whether nothing holds the slip rate back, so that it jumps to the relative speed at once.
    pub(super) fn instant_slip(&self) -> bool {
        self.cc == 0.0 && !self.rate_element && self.friction_is_constant()
    }

    /// Whether no law makes friction depend on the slip rate.
    pub(super) fn friction_is_constant(&self) -> bool {
        self.laws.iter().all(|(e, p)| e.friction(p, 0.0, 0.0).is_none())
    }

    /// By how much the bristles pull harder in direction `sign` than friction holds, at the slip rate `s >= 0`.
    pub(super) fn excess(&self, forcing: &Forcing, z: &[f64], sign: f64, s: f64) -> f64 {
        let p = self.point(forcing, z, sign * s);
        let (mu, ..) = self.friction(s, self.state(self.at.psi, z), self.state(self.at.heat, z));
        sign * p.force - mu * p.normal
    }

    /// Slip rate on the stable branch nearest to zero in direction `sign`, or None where the interface can stick.
    pub(super) fn slip_root(&self, forcing: &Forcing, z: &[f64], sign: f64) -> Option<f64> {
        if self.excess(forcing, z, sign, 0.0) < 0.0 {
            return None;
        }
        self.slip_root_above(forcing, z, sign, (0.0, 1e-9 * self.slip_scale()))
    }

    /// Slip rate on the stable branch nearest to `last` in direction `sign`, or None where there is none.
    pub(super) fn slip_root_near(&self, forcing: &Forcing, z: &[f64], sign: f64, last: f64) -> Option<f64> {
        if self.friction_is_constant() && self.cc > 0.0 && !self.own_bristles {
            // The pull falls in proportion to the slip rate.
            let root = self.excess(forcing, z, sign, 0.0) / self.cc;
            return (root > 0.0).then_some(root);
        }
        let last = last.max(1e-9 * self.slip_scale());
        if self.excess(forcing, z, sign, last) > 0.0 {
            return self.slip_root_above(forcing, z, sign, (last, 1.1 * last));
        }
        let (mut low, mut high) = (0.9 * last, last);
        while self.excess(forcing, z, sign, low) <= 0.0 {
            (low, high) = (0.9 * low, low);
            if low < 1e-9 * self.slip_scale() {
                return None;
            }
        }
        self.slip_root_above(forcing, z, sign, (low, high))
    }

    /// Where the excess, positive at the lower end of the bracket, first vanishes at or above it.
    pub(super) fn slip_root_above(&self, forcing: &Forcing, z: &[f64], sign: f64, bracket: (f64, f64)) -> Option<f64> {
        let (mut low, mut high) = bracket;
        let top = 1e3 * (self.slip_scale() + self.speed) + high;
        while self.excess(forcing, z, sign, high) > 0.0 {
            (low, high) = (high, 1.5 * high);
            if high > top {
                return Some(top);
            }
        }
        let ends = [low, high].map(|s| self.excess(forcing, z, sign, s));
        Some(regula_falsi(|s| self.excess(forcing, z, sign, s), [low, high], ends, (0.0, 1e-14), 100))
    }
}
