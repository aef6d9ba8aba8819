//! Model against measurements: how wrong the model is, where, and what the contact must have done instead.
//!
//! [`compare`] calibrates the free parameters, and judges what is left.

mod branches;
mod budget;
mod calibrate;
mod curves;
mod fingerprint;
mod json;
mod metrics;
mod outliers;
mod regions;
mod setting;
mod shifts;
mod whiteness;

pub use budget::ErrorBudget;
pub(crate) use calibrate::TIGHTER;
pub use calibrate::{Calibration, EXCESS, MOST, calibrate, calibrate_about, problem, settings_of};
pub use curves::{ModelCurve, model_curves};
pub use fingerprint::{ContactPoint, fingerprint};
pub use json::{ComparisonJson, ForceJson, ParameterJson, SCHEMA, SettingJson, json, of_contact, units_of_force};
pub use metrics::{ConditionMetrics, Metrics, Peak, peak, rms_error_beside};
pub use regions::{Region, regions, words};
pub use setting::{Label, Setting};
pub use shifts::shifts;
pub use whiteness::{Whiteness, scatter, unless_understated, whiteness};

use crate::fit::resonance;
use crate::fit::{
    Correlation, Fit, Interval, Prediction, Problem, TAIL, approximate_intervals, correlations, is_lost, profiled,
    read_all, robust_chi2, typical_of,
};
use crate::measurement::{Point, Table};
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use crate::statistics::wrap;
use crate::units::count;
use crate::units::readable::quantity;
use schemars::JsonSchema;
use std::sync::OnceLock;

/// Version of the comparison: raised whenever the same input may give other numbers, so that a limit that is suddenly
/// crossed can be told from a change of the program.
pub const COMPARATOR: &str = "7";

/// A measured point beside what the model says of it.
#[derive(Debug, Clone)]
pub struct Compared {
    /// The measurement.
    pub point: Point,
    /// Index among [`Comparison::conditions`].
    pub condition: usize,
    /// The model.
    pub model: Prediction,
    /// Model minus measured amplitude, in standard deviations.
    pub amplitude_residual: f64,
    /// Model minus measured phase, in standard deviations, where measured.
    pub phase_residual: Option<f64>,
}

/// A single reading that no model of the kind explains: far off where its neighbours are not.
#[derive(Debug, Clone, PartialEq, JsonSchema, serde::Serialize)]
pub struct Outlier {
    /// Data row of the table, from 1.
    pub row: usize,
    /// Column, e.g. `amplitude_rad`, or [`PHASE`].
    pub column: &'static str,
    /// Model minus measured, in standard deviations.
    pub sigma: f64,
    /// How far that is off those of its neighbours along the series, in standard deviations: what makes it stand out; as `sigma`
    /// where it stands out of what all else leaves as noise.
    pub off_neighbours: f64,
}

/// The column of the phases.
pub const PHASE: &str = "phase_rad";

impl Outlier {
    /// Whether it is a phase, not an amplitude.
    pub fn is_phase(&self) -> bool {
        self.column == PHASE
    }
}

/// Everything that a comparison found.
#[derive(Debug, Clone)]
// Wide: every reader of a comparison takes some of these, and none a group of them.
pub struct Comparison {
    /// The scenario as it was read.
    pub scenario: Scenario,
    /// The measurements.
    pub table: Table,
    /// The calibrated model.
    pub model: Model,
    /// The calibration.
    pub fit: Fit,
    /// 95 % intervals of the calibrated parameters.
    pub intervals: Vec<Interval>,
    /// Estimates that are tied together.
    pub correlations: Vec<Correlation>,
    /// Point by point, in the order of the table.
    pub points: Vec<Compared>,
    /// Figures over all points.
    pub overall: Metrics,
    /// Figures per load, speed and drive.
    pub conditions: Vec<ConditionMetrics>,
    /// Whether what is left looks like noise.
    pub whiteness: Whiteness,
    /// Where the model fails, the largest share of chi2 first.
    pub regions: Vec<Region>,
    /// What the contact must have done, per point with phase and load; without a contact, what the missing force must
    /// have.
    pub contact: Vec<ContactPoint>,
    /// The same for the model, at the same points and in the same order.
    pub contact_model: Vec<ContactPoint>,
    /// Single readings that stand out.
    pub outliers: Vec<Outlier>,
    /// What the user should know about the calibration, in plain words.
    pub notes: Vec<String>,
    /// Steady states that its intervals took.
    pub solved: u64,
    error_budget: OnceLock<ErrorBudget>,
    curves: OnceLock<Vec<ModelCurve>>,
}

impl Compared {
    /// Model over measured amplitude, less one \[%\].
    pub fn error_percent(&self) -> f64 {
        100.0 * (self.model.amplitude / self.point.amplitude - 1.0)
    }

    /// Model minus measured phase \[rad\], where measured.
    pub fn phase_error(&self) -> Option<f64> {
        self.point.phase.map(|phase| wrap(self.model.phase - phase))
    }
}

impl Comparison {
    /// What squares are counted in where models are held against this one: the noise, and where more is left, the mean
    /// square of that (the quasi-likelihood of Burnham and Anderson 2002, section 2.5). A misfit a hundred times the
    /// noise makes no term significant that takes off a hundredth of it.
    pub fn unit(&self) -> f64 {
        unit(&self.whiteness, &self.fit, self.overall.readings)
    }

    /// Number of points at which the model has no steady state.
    pub fn unsolved(&self) -> usize {
        self.points.iter().filter(|p| !p.model.status.is_steady()).count()
    }

    /// Three numbers that add up. Integrated over time when first asked for, which takes long where motions settle
    /// slowly.
    pub fn error_budget(&self) -> &ErrorBudget {
        if let Some(budget) = self.error_budget.get() {
            return budget;
        }
        // Not while others wait for it: this thread may take up their work meanwhile.
        let budget =
            budget::budget(&self.model, &self.points, &self.overall, (noise_scale(&self.whiteness), &self.outliers));
        self.error_budget.get_or_init(|| budget)
    }

    /// The model between the measured frequencies, one curve per condition. Solved when first asked for.
    pub fn curves(&self) -> &[ModelCurve] {
        if let Some(curves) = self.curves.get() {
            return curves;
        }
        let settings: Vec<Setting> = self.conditions.iter().map(|c| c.setting).collect();
        let driven = |i: usize| {
            let own = self.points.iter().filter(move |p| p.condition == i);
            own.map(|p| (p.point.frequency, p.point.drive)).collect()
        };
        let driven: Vec<Vec<(f64, f64)>> = (0..settings.len()).map(driven).collect();
        let curves = model_curves(&self.model, &settings, &driven, &self.table.series);
        self.curves.get_or_init(|| curves)
    }

    /// Whether the amplitude or the phase of a row stands out.
    pub fn stands_out(&self, row: usize, phase: bool) -> bool {
        self.outliers.iter().any(|o| o.row == row && o.is_phase() == phase)
    }

    /// chi2 per reading without the readings that stand out; `None` where there are none.
    pub fn chi2_without_outliers(&self) -> Option<f64> {
        self.chi2_without(self)
    }

    /// chi2 per reading without the readings that stand out of another comparison; `None` where there are none.
    pub fn chi2_without(&self, other: &Self) -> Option<f64> {
        let out = |p: &Compared, phase: bool| other.stands_out(p.point.row, phase);
        let amplitudes = self.points.iter().filter(|p| !out(p, false)).map(|p| p.amplitude_residual);
        let phases = self.points.iter().filter(|p| !out(p, true)).filter_map(|p| p.phase_residual);
        let (sum, count) = amplitudes.chain(phases).fold((0.0, 0), |(sum, n), r| (sum + r * r, n + 1));
        (!other.outliers.is_empty() && count > 0).then(|| sum / f64::from(count))
    }
}

/// How a comparison is made.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Seed of the starts of the fit.
    pub seed: u32,
}

/// Steady states that a calibration may take, and the intervals of its numbers: some ten seconds each.
pub const STATES: u64 = 1_000_000;
/// One in so many of these intervals may take where the readings contradict the model: what they were if it were right is no
/// result.
const CONTRADICTED: u64 = 10;

/// Calibrates the free parameters of a scenario and compares with its measurements.
pub fn compare(scenario: &Scenario, table: &Table, options: &Options) -> Comparison {
    let scenario = &table.applied_to(scenario);
    let model = Model::new(scenario);
    let calibration = calibrate(&model, &scenario.free, &table.points, Tolerance::default(), options.seed);
    let mut comparison = judge(scenario, table, &calibration, Some(STATES));
    if calibration.solved >= STATES {
        let note = "the calibration took as many steady states as it may: it need not be the best there is";
        comparison.notes.push(note.into());
    }
    // Here, not by the first of the figures that are drawn in parallel.
    comparison.error_budget();
    comparison.curves();
    comparison
}

/// As [`Comparison::unit`], of a fit to so many readings and the tests of what it leaves.
pub fn unit(whiteness: &Whiteness, fit: &Fit, readings: usize) -> f64 {
    let residuals = &fit.evaluation.residuals;
    let left = || robust_chi2(residuals, TAIL * typical_of(residuals)) / readings as f64;
    if whiteness.structured { left().max(1.0) } else { 1.0 }
}

/// That a model resonates where nothing was read, and not among its readings, in words.
fn flank(model: &Model, points: &[Compared], table: &Table) -> Option<String> {
    let (own, seen) = resonance::left_readings(model, &table.points)?;
    // A joint or a hardening spring resonates higher than the rig by itself.
    let says = |p: &Compared| Point { amplitude: p.model.amplitude, ..p.point.clone() };
    let told: Vec<Point> = points.iter().map(says).collect();
    if resonance::is_spanned(&told, table.signals.reading.order) {
        return None;
    }
    // Digits enough to tell the two apart.
    let digits = (2.0 - (own / seen - 1.0).abs().log10()).ceil().clamp(3.0, 12.0) as usize;
    let [own, seen] = [own, seen].map(|f| quantity(f, "Hz", digits));
    Some(format!(
        "the model resonates at {own}, where nothing was read, the readings near {seen}: it follows a flank of theirs"
    ))
}

/// Compares a model whose calibration is done with the measurements; intervals are by profile likelihood where
/// `profiles` says how many steady states these may take, else from the curvature; where profiles find a better
/// calibration it is taken. Where nothing but noise is left and its scatter contradicts the stated standard deviations,
/// intervals, ranges of misfit and readings that stand out go by the scatter.
pub fn judge(scenario: &Scenario, table: &Table, calibration: &Calibration, profiles: Option<u64>) -> Comparison {
    let settings = settings_of(scenario, table);
    let mut calibrated =
        Problem::new(calibration.base.clone(), &table.points, calibration.fit.parameters.clone(), Tolerance::FIT);
    let left_by = |fit: &Fit| {
        let points = compared(&table.points, &fit.evaluation.predictions);
        let whiteness = whiteness(&points, table, fit.parameters.len());
        (points, whiteness)
    };
    let noise_of = |fit: &Fit| {
        let (points, whiteness) = left_by(fit);
        if whiteness.structured {
            Metrics::over(points.iter()).chi2_per_point.sqrt().max(1.0)
        } else {
            whiteness.noise()
        }
    };
    let (fit, intervals, unfinished, solved) = if let Some(allowed) = profiles {
        let allowed = if left_by(&calibration.fit).1.structured { allowed / CONTRADICTED } else { allowed };
        let found = profiled(&calibration.fit, noise_of, calibration.threshold, &mut calibrated, allowed);
        (found.fit, found.intervals, found.unfinished, found.solved)
    } else {
        (calibration.fit.clone(), approximate_intervals(&calibration.fit, noise_of(&calibration.fit)), 0, 0)
    };
    let model = calibrated.model(&fit.values);
    let points = compared(&table.points, &fit.evaluation.predictions);
    let of = |index: usize| points.iter().filter(move |p| p.condition == index).collect();
    let series: Vec<Vec<&Compared>> = (0..settings.len()).map(of).collect();
    let conditions: Vec<_> =
        settings.iter().zip(&series).map(|(&setting, own)| ConditionMetrics::over(setting, own)).collect();
    let whiteness = whiteness(&points, table, fit.parameters.len());
    let noise = noise_scale(&whiteness);
    let regions = regions(&points, &conditions, noise);
    let (contact, contact_model) = fingerprint(&model, &points);
    let outliers =
        outliers::standing_out(&series, table.signals.reading.reading_column(), (noise, whiteness.is_noise()));
    let at_bounds = Calibration { fit: fit.clone(), ..calibration.clone() };
    let mut notes = notes(&at_bounds.at_bounds(), unfinished, &points, table);
    notes.extend(flank(&model, &points, table).or_else(|| astray(&model, &whiteness, table)));
    Comparison {
        scenario: scenario.clone(),
        table: table.clone(),
        correlations: correlations(&fit),
        fit,
        intervals,
        overall: Metrics::over(points.iter()),
        whiteness,
        regions,
        contact,
        contact_model,
        outliers,
        notes,
        model,
        points,
        conditions,
        solved,
        error_budget: OnceLock::new(),
        curves: OnceLock::new(),
    }
}

/// That a model which leaves structure resonates otherwise than its readings do, in words; one that bends resonates
/// elsewhere at every amplitude.
fn astray(model: &Model, whiteness: &Whiteness, table: &Table) -> Option<String> {
    let is_told = whiteness.structured && !model.may_fold();
    let ((frequency, quality), seen) = resonance::astray(model, &table.points).filter(|_| is_told)?;
    // Digits enough to tell the two apart.
    let digits = (2.0 - (frequency / seen.frequency - 1.0).abs().log10()).ceil().clamp(3.0, 12.0) as usize;
    let [own, of_readings] = [frequency, seen.frequency].map(|f| quantity(f, "Hz", digits));
    Some(format!(
        "the model resonates at {own} with Q {}, the readings near {of_readings} with Q about {}: they hold what a linear mode \
         lacks, such as a constant background, further resonances, or a resonance that bends with the amplitude",
        quantity(quality, "1", 2),
        quantity(seen.quality, "1", 2)
    ))
}

/// What has to be known of a comparison: parameters that ended at a bound, ends of intervals that were not found,
/// readings where the model has several states or none.
fn notes(at_bounds: &[&str], unfinished: usize, points: &[Compared], table: &Table) -> Vec<String> {
    let mut notes = Vec::new();
    for key in at_bounds {
        notes.push(format!(
            "{key} ended at the bound of its search: the data do not hold it, or it is far off as stated"
        ));
    }
    if unfinished > 0 {
        notes.push(format!(
            "{} of intervals are where the curvature of the misfit puts them: to find all takes too many \
             steady states",
            count(unfinished, "end")
        ));
    }
    let states = |p: &Compared| p.model.others.len() + usize::from(!p.model.beyond);
    let two = points.iter().filter(|p| states(p) > 1).count();
    if two > 0 {
        let off = branches::off_the_sweep(points, &table.series);
        let which = match off {
            0 => "all of them those that a sweep of the model is on".into(),
            off => format!("{} with another than the one that a sweep of the model is on", count(off, "reading")),
        };
        notes.push(format!(
            "the model has two stable states at {}; each reading is compared with the state nearest to it, {which}",
            count(two, "point")
        ));
    }
    let beyond = points.iter().filter(|p| p.model.beyond).count();
    if beyond > 0 {
        let (lies, it) = if beyond == 1 { ("lies", "it is") } else { ("lie", "they are") };
        notes.push(format!(
            "{} {lies} beyond the end of the branch of states that {it} on: held against that end, by how far off it is in amplitude and \
             in drive",
            count(beyond, "reading")
        ));
    }
    notes
}

/// Readings that stand out, counted in words.
pub fn outlier_words(number: usize) -> String {
    format!("{} that {} out", count(number, "reading"), if number == 1 { "stands" } else { "stand" })
}

/// Noise of the readings over the stated one: larger where nothing but noise is left, by a test that could have failed;
/// smaller where the readings scatter less about a misfit.
fn noise_scale(whiteness: &Whiteness) -> f64 {
    match whiteness.scatter() {
        _ if whiteness.is_noise() => whiteness.noise().max(1.0),
        (factor, true) if whiteness.structured => factor.min(1.0),
        _ => 1.0,
    }
}

/// Measured points (in canonical order) beside what a model says of them.
pub fn compared(points: &[Point], predictions: &[Prediction]) -> Vec<Compared> {
    let left = read_all(|| points.iter().zip(predictions), is_lost(predictions));
    let beside = |((point, prediction), (amplitude_residual, phase_residual)): ((&Point, &Prediction), _)| {
        let (condition, model) = (point.series, prediction.clone());
        Compared { point: point.clone(), condition, model, amplitude_residual, phase_residual }
    };
    points.iter().zip(predictions).zip(left).map(beside).collect()
}
