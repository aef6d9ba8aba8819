//! One slider over the stages of a step: its bristles, and where it slips.

// Indices run over several matrices at once here.
#![allow(clippy::needless_range_loop)]

use super::collocation::{A, C};
use super::stages::{Block, Stages, chained, inverse, product, relaxation};
use crate::effects::Branch;
use crate::model::relaxations::RELAXATIONS;
use crate::model::system::SliderSystem;

/// States of a slider.
#[derive(Debug, Clone, Copy)]
pub struct Slider {
    /// Stretch \[m\].
    pub x: f64,
    /// Rate of stretch at the end of the last step \[m/s\].
    pub rate: f64,
    /// Forces of its branches \[N\].
    pub q: [f64; RELAXATIONS],
    /// State of its interface.
    pub psi: f64,
}

impl Slider {
    /// At rest.
    pub fn new(x: f64, psi: f64) -> Self {
        Self { x, rate: 0.0, q: [0.0; RELAXATIONS], psi }
    }

    /// With stretch and forces that many times as large.
    pub fn times(&self, stretch: f64, force: f64) -> Self {
        Self { x: self.x * stretch, rate: self.rate * stretch, q: self.q.map(|q| q * force), psi: self.psi }
    }
}

/// What every slider does over a step of one length.
pub struct Bristles<'a> {
    system: &'a dyn SliderSystem,
    h: f64,
    stretch: (Stages, Block),
    /// Of every branch: its stiffness, its force at the stages by that at the start and by the rates.
    branches: Vec<(f64, Stages, Block)>,
    stiffness: Block,
    /// Where friction does not depend on the slip rate: what a slider does with each set of its stages slipping.
    pub slipping: Option<[Slipping; 8]>,
    has_interface: bool,
    /// Whether its force has a hysteresis.
    pub is_hysteretic: bool,
}

/// The force of the bristles about a motion over the stages: its value there, and own + stiffness times the rates near
/// it.
struct Tangent {
    force: Stages,
    own: Stages,
    stiffness: Block,
}

/// A slider with some of its stages slipping (the bits of its index) at a force that does not depend on the slip rate.
pub struct Slipping {
    /// Rates of stretch by the relative speeds (stuck stages) and by the forces less those at no rate (slipping ones).
    rate: Block,
    /// Forces by the relative speeds.
    slope: Block,
}

impl Slipping {
    fn new(stiffness: &Block, stages: usize) -> Self {
        let slips = |i: usize| stages >> i & 1 == 1;
        let unit = |i: usize, k: usize| f64::from(u8::from(i == k));
        let row = |i: usize| if slips(i) { stiffness[i] } else { std::array::from_fn(|k| unit(i, k)) };
        let rate = inverse(&std::array::from_fn(row));
        let mut slope = chained(stiffness, &rate);
        (0..3).filter(|&k| slips(k)).for_each(|k| slope.iter_mut().for_each(|row| row[k] = 0.0));
        Self { rate, slope }
    }
}

impl<'a> Bristles<'a> {
    /// Of a contact, over steps of a length h \[s\].
    pub fn new(system: &'a dyn SliderSystem, h: f64) -> Self {
        let [kc, cc, renewal] = system.bristles();
        let stretch = relaxation(h, renewal);
        let branch = |&(k, rate): &(f64, f64)| {
            let (start, by_rate) = relaxation(h, rate);
            (k, start, by_rate)
        };
        let branches: Vec<_> = system.branches().iter().map(branch).collect();
        let mut stiffness = [[0.0; 3]; 3];
        for i in 0..3 {
            for k in 0..3 {
                let relaxing: f64 = branches.iter().map(|(k1, _, by_rate)| k1 * by_rate[i][k]).sum();
                stiffness[i][k] = kc * stretch.1[i][k] + relaxing;
            }
            stiffness[i][i] += cc;
        }
        let is_hysteretic = system.hysteresis(Branch::default(), 0.0).is_some();
        let slipping = (system.rate_independent() && !is_hysteretic)
            .then(|| std::array::from_fn(|stages| Slipping::new(&stiffness, stages)));
        let has_interface = system.interface(0.0).is_some();
        Self { system, h, stretch, branches, stiffness, slipping, has_interface, is_hysteretic }
    }

    /// Takes a slider to the end of the step with these rates of stretch and of slip at the stages.
    pub fn advance(&self, slider: &mut Slider, d: &Stages, slip: &Stages) {
        slider.rate = d[2];
        let dot = |row: &Stages| row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
        slider.x = self.stretch.0[2] * slider.x + dot(&self.stretch.1[2]);
        for (q, (k1, start, by_rate)) in slider.q.iter_mut().zip(&self.branches) {
            *q = start[2] * *q + k1 * dot(&by_rate[2]);
        }
        slider.psi = self.interface(slider.psi, slip)[2];
    }

    /// Interface state at the stages for given slip rates.
    fn interface(&self, psi: f64, slip: &Stages) -> Stages {
        if !self.has_interface {
            return [psi; 3];
        }
        let rate = slip.map(|s| self.system.interface(s).unwrap_or_default());
        let matrix: Block = std::array::from_fn(|i| {
            std::array::from_fn(|k| f64::from(u8::from(i == k)) - self.h * A[i][k] * rate[k].1)
        });
        let growth = product(&A, &rate.map(|r| r.0));
        product(&inverse(&matrix), &growth.map(|g| psi + self.h * g))
    }

    /// Force of bristles and branches at the stages without any rate.
    fn own(&self, slider: &Slider) -> Stages {
        let kc = self.system.bristles()[0];
        let relaxing =
            |i: usize| -> f64 { self.branches.iter().zip(&slider.q).map(|((_, start, _), q)| start[i] * q).sum() };
        std::array::from_fn(|i| kc * self.stretch.0[i] * slider.x + relaxing(i))
    }

    /// The force of the bristles at these rates, and its tangent there.
    fn tangent(&self, own: Stages, branch: Branch, before: f64, d: &Stages) -> Tangent {
        let mut stiffness = self.stiffness;
        let mut force = plus(&own, &stiffness, d);
        if !self.is_hysteretic {
            return Tangent { force, own, stiffness };
        }
        let (_, forces, slopes) = self.hysteresis(branch, before, d);
        for i in 0..3 {
            force[i] += forces[i];
            for k in 0..3 {
                stiffness[i][k] += slopes[i] * self.stretch.1[i][k];
            }
        }
        let moved = product(&stiffness, d);
        Tangent { force, own: std::array::from_fn(|i| force[i] - moved[i]), stiffness }
    }

    /// The hysteresis over a step: where it ends, its force and slope at the stages. Between two stages whose rates
    /// differ in sign the stretch turns back, where the line between the rates is zero.
    pub fn hysteresis(&self, from: Branch, before: f64, d: &Stages) -> (Branch, Stages, Stages) {
        let (mut branch, mut x, mut rate, mut time) = (from, 0.0, before, 0.0);
        let (mut forces, mut slopes) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let stretch = (0..3).map(|k| self.stretch.1[i][k] * d[k]).sum::<f64>();
            let mut by = stretch - x;
            let mut go = |by: f64| {
                let (there, slope) = self.system.hysteresis(branch, by).unwrap_or_default();
                branch = there;
                slope
            };
            if rate * d[i] < 0.0 {
                let to_reversal = 0.5 * rate * rate / (rate - d[i]) * (C[i] - time) * self.h;
                go(to_reversal);
                by -= to_reversal;
            }
            slopes[i] = go(by);
            forces[i] = branch.force;
            (x, rate, time) = (stretch, d[i], C[i]);
        }
        (branch, forces, slopes)
    }

    /// One slider at the stages, where its limit does not depend on the slip rate.
    pub fn steady_slider(
        &self,
        slipping: &[Slipping; 8],
        slider: &Slider,
        v: &Stages,
        most: &Stages,
        speed: f64,
    ) -> Solved {
        let own = self.own(slider);
        let mut rate = *v;
        let mut force = plus(&own, &self.stiffness, &rate);
        let mut sign = [0.0; 3];
        let mut stages = 0;
        for _ in 0..40 {
            if !switch(&mut sign, &force, |i| most[i], |i| v[i] - rate[i], speed) {
                break;
            }
            stages = (0..3).filter(|&i| sign[i] != 0.0).map(|i| 1 << i).sum();
            let known = std::array::from_fn(|i| if sign[i] == 0.0 { v[i] } else { sign[i] * most[i] - own[i] });
            rate = product(&slipping[stages].rate, &known);
            force = plus(&own, &self.stiffness, &rate);
        }
        Solved { force, rate, slope: slipping[stages].slope }
    }

    /// One slider at the stages: stuck or at its limit, each stage by itself.
    pub fn slider(
        &self,
        slider: &Slider,
        branch: Branch,
        v: &Stages,
        limit: &dyn Fn(usize, f64, f64) -> (f64, f64),
        speed: f64,
    ) -> Solved {
        let own = self.own(slider);
        let mut d = *v;
        let Tangent { force: mut f, own: mut start, mut stiffness } = self.tangent(own, branch, slider.rate, &d);
        if (0..3).all(|i| f[i].abs() <= limit(i, 0.0, slider.psi).0) && !self.has_interface {
            return Solved { force: f, rate: d, slope: stiffness };
        }
        let mut psi = [slider.psi; 3];
        let mut sign = [0.0; 3];
        let mut slopes = [0.0; 3];
        for _ in 0..40 {
            let changed = switch(&mut sign, &f, |i| limit(i, 0.0, psi[i]).0, |i| v[i] - d[i], speed);
            if sign == [0.0; 3] && !changed {
                break;
            }
            let mut matrix = [[0.0; 3]; 3];
            let mut right = [0.0; 3];
            for i in 0..3 {
                if sign[i] == 0.0 {
                    matrix[i][i] = 1.0;
                    right[i] = v[i];
                    slopes[i] = 0.0;
                } else {
                    let slip = (sign[i] * (v[i] - d[i])).max(0.0);
                    let (most, by_s) = limit(i, slip, psi[i]);
                    matrix[i] = stiffness[i];
                    matrix[i][i] += by_s;
                    right[i] = -start[i] + sign[i] * (most - by_s * slip) + by_s * v[i];
                    slopes[i] = by_s;
                }
            }
            let new = product(&inverse(&matrix), &right);
            let change = (0..3).fold(0.0f64, |m, i| m.max((new[i] - d[i]).abs()));
            d = new;
            Tangent { force: f, own: start, stiffness } = self.tangent(own, branch, slider.rate, &d);
            psi = self.interface(slider.psi, &std::array::from_fn(|i| (v[i] - d[i]).abs()));
            if !changed && change < 1e-13 * speed {
                break;
            }
        }
        if sign.iter().all(|s| *s != 0.0) && slopes == [0.0; 3] {
            return Solved { force: f, rate: d, slope: [[0.0; 3]; 3] };
        }
        Solved { force: f, rate: d, slope: chained(&stiffness, &rate_by_speed(&stiffness, &sign, &slopes)) }
    }
}

/// Lets stages slip whose force is beyond the limit, in its direction, and those stick whose slip has turned back;
/// whether any did.
#[inline(always)]
fn switch(
    sign: &mut Stages,
    force: &Stages,
    limit: impl Fn(usize) -> f64,
    slip: impl Fn(usize) -> f64,
    speed: f64,
) -> bool {
    let mut changed = false;
    for i in 0..3 {
        if sign[i] == 0.0 {
            if force[i].abs() > limit(i) {
                sign[i] = force[i].signum();
                changed = true;
            }
        } else if sign[i] * slip(i) < -1e-13 * speed {
            sign[i] = 0.0;
            changed = true;
        }
    }
    changed
}

/// Rates of stretch by the relative speeds: stuck stages follow, slipping ones through the slopes of the law.
fn rate_by_speed(stiffness: &Block, sign: &Stages, slopes: &Stages) -> Block {
    let mut matrix = [[0.0; 3]; 3];
    for i in 0..3 {
        if sign[i] == 0.0 {
            matrix[i][i] = 1.0;
        } else {
            matrix[i] = stiffness[i];
            matrix[i][i] += slopes[i];
        }
    }
    let mut by_speed = inverse(&matrix);
    for k in (0..3).filter(|&k| sign[k] != 0.0) {
        by_speed.iter_mut().for_each(|row| row[k] *= slopes[k]);
    }
    by_speed
}

/// a + B v
fn plus(a: &Stages, b: &Block, v: &Stages) -> Stages {
    let moved = product(b, v);
    std::array::from_fn(|i| a[i] + moved[i])
}

/// A slider that was solved at the stages: its force, its rate of stretch, and the slopes of the force by the relative
/// speeds.
pub struct Solved {
    pub force: Stages,
    pub rate: Stages,
    pub slope: Block,
}
