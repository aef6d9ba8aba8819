//! Derivatives of the equations by the lumped coefficients and the parameters of the laws.

use super::{Column, Problem};
use crate::model::system::{Forcing, HybridSystem, MAX_STATES, Mode, ParameterColumns};

impl Problem {
    /// Derivatives of the rates and of the constraint by every column.
    // Long: every column has a branch, and all of them share what is evaluated once; the loop is among those that take time.
    pub(super) fn fill_columns(&self, forcing: &Forcing, z: &[f64], s: f64, mode: Mode, out: &mut ParameterColumns) {
        let s = if mode == Mode::Stick { 0.0 } else { s };
        let p = self.point(forcing, z, s);
        let torque = self.torque(p.th, p.w);
        let sign = Self::sign(mode);
        let slip = if self.rate_element { p.v } else { s };
        let psi = self.state(self.at.psi, z);
        let limit = (p.mu * p.normal).max(1e-12 * self.force_scale());
        let (mut last, mut laws) = (None, [None; 4]);
        let own = self.bristle_law(z[self.at.x], p.d);
        for (index, column) in self.columns.iter().enumerate() {
            // Direct partial derivatives of the intermediate quantities by this column.
            let (mut dth, mut dw, mut dv, mut dn, mut dforce, mut dmu, mut dtorque) =
                (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
            let (mut arm, mut support, mut heat, mut stretch, mut branch, mut dpsi, mut stiff) =
                (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
            match *column {
                Column::FreeRe => (dth, dw) = (forcing.sine, self.omega * forcing.cosine),
                Column::FreeIm => (dth, dw) = (forcing.cosine, -self.omega * forcing.sine),
                Column::Damping => arm = -z[1],
                Column::Stiffness => arm = -z[0],
                Column::InverseInertia => arm = self.b * p.force + torque.value,
                Column::Arm => {
                    dv = -p.w;
                    dn = self.load_stiffness * p.th;
                    arm = self.inverse_inertia * p.force;
                }
                Column::ContactStiffness => {
                    dforce = z[self.at.x];
                    stiff = 1.0;
                }
                Column::ContactDamping => dforce = p.d,
                Column::Friction => dmu = p.heat_factor,
                Column::Load => dn = 1.0,
                Column::Speed => dv = 1.0,
                Column::LoadStiffness => dn = self.b * p.th,
                Column::Renewal => stretch = -z[self.at.x],
                Column::BranchStiffness => branch = p.d,
                Column::BranchRate => branch = -self.state(self.at.q, z),
                Column::RateViscosity => dforce = p.v,
                Column::SupportInverseMass => support = -p.force,
                Column::SupportDamping => support = -self.at.roller.map_or(0.0, |i| z[i + 1]),
                Column::SupportStiffness => support = -self.state(self.at.roller, z),
                Column::HeatingGain => heat = p.force * slip,
                Column::CoolingRate => heat = -self.state(self.at.heat, z),
                Column::Law { effect, parameter } => {
                    let (e, q) = &self.laws[effect];
                    let argument = if self.rate_element { p.v.abs() } else { (sign * s).max(0.0) };
                    // The columns of an effect follow each other.
                    if last != Some(effect) {
                        last = Some(effect);
                        laws = [
                            e.friction(q, argument, psi),
                            e.interface_rate(q, slip.abs(), psi),
                            e.torque(q, p.th, p.w),
                            e.bristle_force(q, z[self.at.x], p.d),
                        ];
                    }
                    let [dfriction, rate, twist, pull] =
                        laws.map(|law| law.map_or(0.0, |law| law.d_parameters[parameter]));
                    (dmu, dpsi, dtorque, dforce) = (dfriction * p.heat_factor, rate, twist, pull);
                }
            }
            dv -= self.b * dw;
            dn += self.load_stiffness * self.b * dth;
            if !p.loaded {
                dn = 0.0;
            }
            dforce += (self.cc + self.sigma2 + own.d_second) * dv;
            dtorque += torque.d_first * dth + torque.d_second * dw;
            let f = &mut out.f[index];
            *f = [0.0; MAX_STATES];
            f[1] = self.inverse_inertia * (self.b * dforce + dtorque) + arm;
            if let Some(i) = self.at.roller {
                f[i + 1] = support - self.support[0] * dforce;
            }
            if let Some(i) = self.at.heat {
                let dslip = if self.rate_element { dv } else { 0.0 };
                f[i] = heat + self.heating_gain * (dforce * slip + p.force * dslip);
            }
            f[self.at.x] = dv + stretch;
            if let Some(i) = self.at.q {
                f[i] = self.k1 * dv + branch;
            }
            if let Some(i) = self.at.psi {
                f[i] = dpsi;
                if self.rate_element {
                    f[i] += self.interface_rate(p.v.abs(), psi).d_first * sign * dv;
                }
            }
            out.g[index] = match mode {
                Mode::Stick => 0.0,
                Mode::SlipForward | Mode::SlipBackward => {
                    (dforce - sign * (p.mu * dn + dmu * p.normal)) / self.force_scale()
                }
                Mode::RateForward | Mode::RateBackward => {
                    let flow = self.kc * z[self.at.x] / limit;
                    let speed = p.v.abs();
                    let dlimit = p.mu * dn + (dmu + p.mu_s * sign * dv) * p.normal;
                    let by_stiffness = stiff * z[self.at.x] * speed / limit;
                    (flow * speed / limit * dlimit - flow * sign * dv - by_stiffness) / self.slip_scale()
                }
            };
        }
    }
}
