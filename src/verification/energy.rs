//! Balance of energy over a steady period, for every effect of the catalogue.

use super::{Check, largest, steady};
use crate::effects::{self, Effect};
use crate::model::contact::Problem;
use crate::model::system::HybridSystem;
use crate::model::{Model, Operation};
use crate::scenario;
use crate::solver::Status;
use crate::solver::cycle::{Record, Tolerance};
use crate::solver::radau::A;
use crate::solver::shooting;
use rayon::prelude::*;

/// Conditions (V, W, u0): stuck, gross slip at rest, partial stick twice, full slip.
const CONDITIONS: [(f64, f64, f64); 5] =
    [(0.0, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6), (5e-5, 20.0, 2.5e-6), (1e-4, 10.0, 2.5e-6), (0.02, 20.0, 2.5e-6)];

/// The balance for every effect that acts beside a contact, at typical parameters.
pub fn every_effect() -> Vec<Check> {
    // The period of sliders, or of bristles that remember, is not one cycle of one system; the energies of their loops
    // are known in closed form.
    let single = |effect: &&&dyn Effect| !effects::slides(**effect, &effects::typical(**effect));
    let fits = |effect: &&&dyn Effect| effects::fits_rig(**effect, true).is_ok();
    let effects: Vec<_> = effects::REGISTRY.iter().filter(single).filter(fits).collect();
    effects.par_iter().flat_map_iter(|effect| energy_balance(**effect, &effects::typical(**effect))).collect()
}

/// Over a steady period the work of drive and contact on the arm is what damping and torques of the arm take; and the
/// contact gives the arm no more than the motor of the roller puts in, all relative to the work of the drive.
pub fn energy_balance(effect: &'static dyn Effect, parameters: &[f64]) -> [Check; 2] {
    let mut model = Model::new(&scenario::paper());
    model.effects.push((effect, parameters.to_vec()));
    let found: Vec<_> = CONDITIONS
        .iter()
        .map(|&(speed, load, drive)| Operation { speed, load, drive, frequency: 74.0, series: 0 })
        .filter(|at| is_periodic(&model, at))
        .map(|at| works(&model, &at).map_or((f64::NAN, f64::NAN), |w| (w.imbalance(), w.gain())))
        .collect();
    let count = format!("the {} periodic ones of {} conditions at 74 Hz", found.len(), CONDITIONS.len());
    let how = format!("work of drive and contact against damping and torques of the arm, {count}");
    let how_gain =
        format!("work that the contact gives the arm beyond what the roller puts in, over the drive's, {count}");
    let name = effect.name();
    [
        largest(format!("Energy balance, {name}"), &how, found.iter().map(|f| f.0), 1e-6),
        largest(format!("Contact dissipates, {name}"), &how_gain, found.iter().map(|f| f.1), 1e-6),
    ]
}

/// Whether energy returns after a period: not so where the motion is self-excited, nor in a contact that rests for ever
/// and ages.
fn is_periodic(model: &Model, at: &Operation) -> bool {
    let state = steady(model, at, Tolerance::default());
    !matches!(state.status, Status::SelfExcited(_)) && Problem::new(model, at).locked_state().is_none()
}

/// Works over a period \[J\].
#[derive(Default)]
struct Works {
    drive: f64,
    on_arm: f64,
    roller: f64,
    lost: f64,
}

impl Works {
    fn imbalance(&self) -> f64 {
        (self.drive + self.on_arm - self.lost).abs() / self.drive.abs().max(self.lost.abs())
    }
    fn gain(&self) -> f64 {
        let gain = (self.on_arm - self.roller) / self.drive.abs();
        if gain < 0.0 { 0.0 } else { gain }
    }
}

/// `None` where there is no periodic state.
fn works(model: &Model, at: &Operation) -> Option<Works> {
    let problem = Problem::new(model, at);
    let tolerance = Tolerance { steps: 96, roughness: 1e-4, ..Tolerance::default() };
    let periodic = shooting::solve(&problem, None, &tolerance).ok()?;
    let lumps = &problem.lumps;
    let mut sum = Works::default();
    let mut add = |r: &Record| {
        for (i, weight) in A[2].iter().enumerate() {
            let h = r.size * weight;
            let (z, s, forcing) = (&r.stepper.z[i], r.stepper.s[i], &r.stepper.forcing[i]);
            let (th, w) = (forcing.angle + z[0], forcing.velocity + z[1]);
            let force = problem.force(forcing, z, s).0;
            let torque = lumps.torque_re.value * forcing.sine + lumps.torque_im.value * forcing.cosine;
            let resisting: f64 =
                model.effects.iter().filter_map(|(e, p)| e.torque(p, th, w)).map(|law| law.value).sum();
            sum.drive += h * torque * w;
            sum.on_arm += h * force * model.rig.lever() * w;
            sum.roller += h * force * at.speed;
            sum.lost += h * (lumps.damping.value * w * w - resisting * w);
        }
    };
    shooting::trace(&problem, &periodic, &tolerance, &mut add).ok()?;
    Some(sum)
}
