//! Which classes the data tell apart.

use super::Standing;
use super::class::{Axis, Class, Residual};
use super::fit::Fitted;
use super::linear::robust;
use super::readings::Readings;
use super::variable::{ALL, Variable};
use crate::compare::{Comparison, Whiteness, whiteness};
use crate::fit::TAIL;
use crate::measurement::curves;
use crate::model::lumps::Lumps;
use crate::statistics::{SIGNIFICANCE, spread};
use nalgebra::DVector;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A residual of the leading class beyond so many times their typical size is that of a reading that stands out, which
/// says nothing of any class.
const OUTLYING: f64 = 5.0;
/// Most of a misfit is more than this share of it.
pub const MOST: f64 = 50.0;

/// A class that was fitted.
pub struct Tried<'a> {
    /// Its variables.
    pub variables: Vec<Variable>,
    /// The class.
    pub class: Class<'a>,
    /// Its fit.
    pub fitted: Fitted,
    /// Relative error in amplitude that is left \[%\].
    pub left_rms_percent: f64,
    /// The same of series predicted from the others.
    pub predicted_rms_percent: Option<f64>,
    /// Standard deviation of its residuals, widened by how far neighbours go together.
    pub scale: f64,
    /// Whether any law could be told from it at all.
    pub testable: bool,
}

/// All classes and what is told of them.
pub struct Judged<'a> {
    /// A constant, then the others.
    pub tried: Vec<Tried<'a>>,
    /// The class that is claimed.
    pub leading: Option<usize>,
    /// Whether a constant leaves more than noise.
    pub structured: bool,
    /// Whether the readings could show that.
    pub testable: bool,
    /// Whether the class that is claimed leaves more than noise as well.
    pub unfinished: bool,
    /// Limits, in words.
    pub notes: Vec<String>,
    used: Vec<bool>,
    tied: Vec<bool>,
}

impl Judged<'_> {
    /// What is said of a class.
    pub fn standing(&self, index: usize) -> Standing {
        match self.leading {
            _ if index == 0 => Standing::Base,
            _ if self.tried[index].variables.len() > 1 => Standing::Further,
            _ if !self.tried[index].testable => Standing::Untestable,
            None => Standing::Undecided,
            Some(leading) if leading == index => Standing::Leading,
            Some(_) if self.tied[index] => Standing::Tied,
            Some(_) => Standing::Excluded,
        }
    }

    /// Share of what a constant leaves that a class explains \[%\].
    pub fn explained(&self, index: usize) -> f64 {
        let left = |index: usize| square(&self.tried[index].fitted.residuals, &self.used);
        (100.0 * (1.0 - left(index) / left(0).max(f64::MIN_POSITIVE))).clamp(0.0, 100.0)
    }

    /// The same for residuals of anything else.
    pub fn explained_by(&self, residuals: &[Residual]) -> f64 {
        let base = square(&self.tried[0].fitted.residuals, &self.used);
        (100.0 * (1.0 - square(residuals, &self.used) / base.max(f64::MIN_POSITIVE))).clamp(0.0, 100.0)
    }
}

/// What the class of the amplitude leaves, and its number of unknowns; `None` where it cannot be fitted.
pub fn left_by_amplitude(c: &Comparison, readings: &Readings<'_>) -> Option<(DVector<f64>, usize)> {
    let motion = readings.measured_motion();
    let values = motion.iter().map(|ln| ln.exp()).collect();
    let class = Class::of(readings, &[(Variable::Amplitude, values)], c.table.series.len(), &motion)?;
    let fitted = class.fit(&motion, &asked(c, readings));
    let left = fitted.residuals.iter().flat_map(|(amplitude, phase)| [Some(*amplitude), *phase]).flatten();
    Some((DVector::from_vec(left.collect()), class.unknowns))
}

/// Fits all classes and judges them.
pub fn judge<'a>(c: &Comparison, readings: &'a Readings<'a>) -> Judged<'a> {
    let motion = readings.measured_motion();
    let start = asked(c, readings);
    let varied: Vec<(Variable, Vec<f64>)> =
        ALL.into_iter().filter_map(|v| Some((v, v.values(&readings.points, &c.table.series)?))).collect();
    let of = |variable: &(Variable, Vec<f64>)| match variable {
        (Variable::Amplitude, _) => (Variable::Amplitude, motion.iter().map(|ln| ln.exp()).collect()),
        other => other.clone(),
    };
    let varied: Vec<(Variable, Vec<f64>)> = varied.iter().map(of).collect();
    let attempt = |variables: &[(Variable, Vec<f64>)]| -> Option<Tried<'a>> {
        let class = Class::of(readings, variables, c.table.series.len(), &motion)?;
        let fitted = class.fit(&motion, &start);
        let names: Vec<Variable> = variables.iter().map(|(v, _)| *v).collect();
        let testable = class.is_bounded() && names.iter().all(|v| told_twice(*v, readings));
        Some(Tried {
            left_rms_percent: rms_percent(readings, &fitted.residuals),
            predicted_rms_percent: fitted.predicted.as_ref().map(|p| rms_percent(readings, p)),
            scale: scale(readings, &fitted),
            variables: names,
            class,
            fitted,
            testable,
        })
    };
    let mut sets: Vec<Vec<(Variable, Vec<f64>)>> = vec![Vec::new()];
    sets.extend(varied.iter().map(|v| vec![v.clone()]));
    let tried: Vec<Tried<'a>> = sets.par_iter().filter_map(|set| attempt(set)).collect();
    let white = white(c, readings, &tried[0].fitted);
    let mut judged = decided(c, readings, tried, &white);
    judged.unfinished = judged.leading.is_some_and(|leading| structured(c, readings, &judged.tried[leading].fitted));
    if let Some(leading) = judged.leading.filter(|_| judged.unfinished) {
        let first = judged.tried[leading].variables[0];
        let own = varied.iter().find(|(v, _)| *v == first).cloned();
        let pairs: Vec<Vec<(Variable, Vec<f64>)>> = varied
            .iter()
            .filter(|(v, _)| *v != first && !nested(*v, first))
            .filter_map(|other| Some(vec![own.clone()?, other.clone()]))
            .collect();
        let pairs: Vec<Tried<'a>> = pairs.par_iter().filter_map(|pair| attempt(pair)).filter(|p| p.testable).collect();
        let better = pairs
            .into_iter()
            .filter(|pair| is_worse(readings, &judged.used, &judged.tried[leading].fitted, &pair.fitted));
        let best = better.min_by(|a, b| {
            let left = |tried: &Tried<'_>| square(&tried.fitted.residuals, &judged.used);
            left(a).total_cmp(&left(b))
        });
        if let Some(pair) = best {
            judged.tried.push(pair);
        }
    }
    judged.notes.extend(notes(c, readings, &judged));
    judged
}

/// Whether one variable is a function of the other: a level of the drive of the series.
fn nested(one: Variable, other: Variable) -> bool {
    let both = [one, other];
    both.contains(&Variable::Drift) && (both.contains(&Variable::DriveLevel))
}

/// What the fits say together.
fn decided<'a>(c: &Comparison, readings: &Readings<'a>, tried: Vec<Tried<'a>>, white: &Whiteness) -> Judged<'a> {
    let candidates = || (1..tried.len()).filter(|&i| tried[i].testable);
    let typical = candidates().map(|i| size(&tried[i].fitted.residuals)).fold(f64::INFINITY, f64::min);
    let threshold = TAIL * typical.max(1.0);
    let loss = |i: usize| losses(&tried[i].fitted.residuals, threshold).iter().sum::<f64>();
    let best = candidates().min_by(|a, b| loss(*a).total_cmp(&loss(*b)));
    let all = vec![true; readings.points.len()];
    let mut judged = Judged {
        leading: None,
        structured: white.structured,
        testable: white.testable,
        unfinished: false,
        notes: Vec::new(),
        used: best.map_or(all, |best| standing_in(&tried[best].fitted.residuals)),
        tied: vec![false; tried.len()],
        tried,
    };
    let Some(best) = best.filter(|_| white.structured && white.testable) else { return judged };
    if !is_significant(readings, &judged, 0, best) {
        return judged;
    }
    judged.leading = Some(best);
    let used = &judged.used;
    let tied = |i: usize| {
        let fitted = &judged.tried[i].fitted;
        let better = &judged.tried[best].fitted;
        // What leaves nothing but noise is not ruled out, even where another follows the noise better. Nor, where the
        // better one leaves structure too, what leaves less than twice as much: that may be another cause, which one of
        // them happens to follow.
        let more = 100.0 * square(&better.residuals, used) < MOST * square(&fitted.residuals, used);
        let excluded = is_worse(readings, used, fitted, better)
            && structured(c, readings, fitted)
            && (more || !structured(c, readings, better));
        i != best && judged.tried[i].testable && !excluded
    };
    judged.tied = (0..judged.tried.len()).map(|i| i > 0 && tied(i)).collect();
    judged
}

/// Whether one fit leaves more than another by more than chance: the ratio of the variances that they leave, as the
/// likelihood of so many readings as are independent of their neighbours in the better one. Fewer unknowns are no
/// advantage.
fn is_worse(readings: &Readings<'_>, used: &[bool], one: &Fitted, better: &Fitted) -> bool {
    let count: usize = readings.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum();
    let variance = |fitted: &Fitted| square(&fitted.residuals, used) / (count as f64 - fitted.freedom).max(1.0);
    let residuals: Vec<f64> = better.residuals.iter().map(|(amplitude, _)| *amplitude).collect();
    let independent = count as f64 / inflation(readings, &residuals);
    independent * (variance(one) / variance(better)).ln() > -2.0 * SIGNIFICANCE.ln()
}

/// Whether a class leaves less than a constant by more than its curves would by chance, with as many readings as are
/// independent.
fn is_significant(readings: &Readings<'_>, judged: &Judged<'_>, base: usize, one: usize) -> bool {
    let (base, fitted) = (&judged.tried[base].fitted, &judged.tried[one].fitted);
    let count: usize = readings.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum();
    let residuals: Vec<f64> = fitted.residuals.iter().map(|(amplitude, _)| *amplitude).collect();
    let independent = count as f64 / inflation(readings, &residuals);
    let ratio = square(&base.residuals, &judged.used) / square(&fitted.residuals, &judged.used);
    let more = (fitted.freedom - base.freedom).max(1.0);
    let chance = ChiSquared::new(more).map_or(1.0, |law| law.sf(independent * ratio.ln()));
    chance < SIGNIFICANCE / judged.tried.len() as f64
}

/// By how much the variance of a sum over readings is larger than if neighbours along series were independent: their
/// correlations added up over the distances, as far as they are positive (Geyer 1992).
fn inflation(readings: &Readings<'_>, values: &[f64]) -> f64 {
    let energy: f64 = values.iter().map(|value| value * value).sum();
    let together = |distance: usize| {
        let pairs = readings.points.iter().zip(&readings.points[distance..]).enumerate();
        let same = pairs.filter(|(_, (one, other))| one.series == other.series);
        same.map(|(at, _)| values[at] * values[at + distance]).sum::<f64>() / energy
    };
    let positive = (1..values.len()).map(together).take_while(|correlation| *correlation > 0.0);
    1.0 + 2.0 * positive.sum::<f64>()
}

/// Whether a variable comes back at other readings often enough that k and c of it could be contradicted: every reading
/// tells one number of the two, or both where it has a phase; every series passes a frequency once and an amplitude
/// twice.
fn told_twice(variable: Variable, readings: &Readings<'_>) -> bool {
    let curves = curves(readings.points.iter().copied());
    match variable {
        Variable::Frequency => curves > 2,
        Variable::Amplitude => 2 * curves > 2,
        _ => true,
    }
}

/// k and c that the readings ask for beside those of the model, in units of the readings, and their weights: from the
/// dynamic stiffness of the contact, or of the missing force, less that of the model.
fn asked(c: &Comparison, readings: &Readings<'_>) -> Vec<Option<([f64; 2], [f64; 2])>> {
    let square = |p: &crate::measurement::Point| {
        let arm = Lumps::new(&c.model, &crate::fit::operation(p)).arm.value;
        if c.model.has_contact { arm * arm } else { 1.0 }
    };
    let of = |point: &&crate::measurement::Point| {
        let at = c.contact.iter().position(|p| p.row == point.row)?;
        let (measured, model, square) = (&c.contact[at], &c.contact_model[at], square(point));
        let [k, d] = readings.units.map(|unit| square / unit);
        let values =
            [(measured.stiffness_n_m - model.stiffness_n_m) * k, (measured.damping_n_s_m - model.damping_n_s_m) * d];
        let weights = [1.0 / (measured.stiffness_sd_n_m * k), 1.0 / (measured.damping_sd_n_s_m * d)];
        values.iter().chain(&weights).all(|x| x.is_finite()).then_some((values, weights))
    };
    readings.points.iter().map(of).collect()
}

/// The tests of what a fit leaves.
fn white(c: &Comparison, readings: &Readings<'_>, fitted: &Fitted) -> Whiteness {
    let left = readings.numbers.iter().zip(&fitted.residuals).map(|(number, (amplitude, phase))| {
        let mut compared = c.points[*number].clone();
        (compared.amplitude_residual, compared.phase_residual) = (*amplitude, *phase);
        compared
    });
    let freedom = fitted.freedom.round() as usize;
    whiteness(&left.collect::<Vec<_>>(), &c.table, freedom)
}

/// Whether a fit leaves more than noise.
fn structured(c: &Comparison, readings: &Readings<'_>, fitted: &Fitted) -> bool {
    white(c, readings, fitted).structured
}

/// Where one harmonic is not enough, and what was left out.
fn notes(c: &Comparison, readings: &Readings<'_>, judged: &Judged<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    if readings.points.len() < c.points.len() {
        notes.push(format!("the free force was fitted to {} of {} readings", readings.points.len(), c.points.len()));
    }
    if readings.points.iter().all(|p| p.phase.is_none()) {
        notes.push(
            "without phases the free force is fitted to amplitudes alone: its curves are the less certain".into(),
        );
    }
    let Some(leading) = judged.leading.map(|index| &judged.tried[index]) else { return notes };
    let drifts = |index: usize| judged.tried[index].variables.contains(&Variable::Drift);
    let open = |index: usize| [Standing::Leading, Standing::Tied].contains(&judged.standing(index));
    if (1..judged.tried.len()).any(|index| drifts(index) && open(index)) {
        notes.push("repeating the first series at the end of the test would tell drift from everything else".into());
    }
    // A force of a third of the first harmonic at three times the frequency, above the resonance: a share of the
    // motion.
    let share = |(index, point): (usize, &&crate::measurement::Point)| {
        let lumps = Lumps::new(&c.model, &crate::fit::operation(point));
        let motion = leading.class.motion(&leading.fitted)[index];
        let place = |axis: &Axis| {
            if axis.variable == Variable::Amplitude { motion } else { axis.places[index] }
        };
        let curves = leading.class.axes.iter().map(|axis| Class::curve(axis, &leading.fitted.state, place(axis)));
        let [k, d] = curves.fold([0.0; 2], |sum, curve| [sum[0] + curve[0], sum[1] + curve[1]]);
        let force = (k * readings.units[0]).hypot(d * readings.units[1] * lumps.omega) / 3.0;
        let third = (3.0 * lumps.omega).powi(2) * lumps.inertia.value - lumps.stiffness.value;
        force / third.hypot(3.0 * lumps.omega * lumps.damping.value)
    };
    let largest = readings.points.iter().enumerate().map(share).fold(0.0, f64::max);
    if 100.0 * largest > c.overall.noise_percent {
        notes.push(format!(
            "one harmonic is not all of it: a force of this size may have a third harmonic that moves the rig by {:.1} % of the \
             first, more than the noise of {:.1} %; where that matters the curves are approximate",
            100.0 * largest,
            c.overall.noise_percent
        ));
    }
    notes
}

/// Typical size of residuals.
fn size(residuals: &[Residual]) -> f64 {
    spread(residuals.iter().flat_map(|(amplitude, phase)| [Some(*amplitude), *phase].into_iter().flatten()), 0.0)
}

/// Readings that do not stand out of a fit.
fn standing_in(residuals: &[Residual]) -> Vec<bool> {
    let most = OUTLYING * size(residuals).max(1.0);
    residuals
        .iter()
        .map(|(amplitude, phase)| amplitude.abs() <= most && phase.is_none_or(|p| p.abs() <= most))
        .collect()
}

fn losses(residuals: &[Residual], threshold: f64) -> Vec<f64> {
    let loss = |r: f64| robust(&nalgebra::DVector::from_element(1, r), threshold).0;
    residuals.iter().map(|(amplitude, phase)| loss(*amplitude) + phase.map_or(0.0, loss)).collect()
}

/// Squares at every reading, those that stand out left out.
fn squares(residuals: &[Residual], used: &[bool]) -> Vec<f64> {
    let of = |((amplitude, phase), used): (&Residual, &bool)| {
        if *used { amplitude.powi(2) + phase.map_or(0.0, |p| p * p) } else { 0.0 }
    };
    residuals.iter().zip(used).map(of).collect()
}

fn square(residuals: &[Residual], used: &[bool]) -> f64 {
    squares(residuals, used).iter().sum()
}

/// Root mean square of the relative error in amplitude \[%\], what is far off counted less, as the fit does.
pub fn rms_percent(readings: &Readings<'_>, residuals: &[Residual]) -> f64 {
    let threshold = TAIL * size(residuals).max(1.0);
    let of = |((amplitude, _), point): (&Residual, &&crate::measurement::Point)| {
        let weight = (threshold / amplitude.abs()).powi(2).min(1.0);
        let error = (amplitude * point.amplitude_sd / point.amplitude).exp() - 1.0;
        (weight * error * error, weight)
    };
    let sums = residuals.iter().zip(&readings.points).map(of).fold((0.0, 0.0), |(s, w), (a, b)| (s + a, w + b));
    100.0 * (sums.0 / sums.1.max(f64::MIN_POSITIVE)).sqrt()
}

/// Standard deviation of residuals, as if they were independent.
fn scale(readings: &Readings<'_>, fitted: &Fitted) -> f64 {
    let count: usize = readings.points.iter().map(|p| 1 + usize::from(p.phase.is_some())).sum();
    let threshold = TAIL * size(&fitted.residuals).max(1.0);
    let sum: f64 = losses(&fitted.residuals, threshold).iter().sum();
    let amplitudes: Vec<f64> = fitted.residuals.iter().map(|(amplitude, _)| *amplitude).collect();
    (sum / (count as f64 - fitted.freedom).max(1.0) * inflation(readings, &amplitudes)).sqrt()
}
