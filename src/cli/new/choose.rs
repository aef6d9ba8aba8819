//! Which kind of rig and reading explains a table best, where it does not say.

use super::draft::{Draft, Kind, brief, thinned};
use crate::cli::Global;
use crate::cli::progress::of_searches;
use crate::compare::{EXCESS, calibrate, judge};
use crate::discover::{Hypothesis, MARGIN, SearchOptions, explain};
use crate::error::Result;
use crate::fit::{deviance, price, robust_square, typical_of};
use crate::free_form;
use crate::measurement::{Table, load};
use crate::model::Model;
use crate::scenario::Scenario;
use crate::solver::cycle::Tolerance;
use crate::statistics::wrap;
use nalgebra::DVector;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// The search that decides between so many kinds of readings: by what acts on the motion, or by what is read beside it.
/// All of them together take a tenth of what a whole search may.
fn short(kinds: usize, beside: bool) -> SearchOptions {
    let brief = brief(beside);
    SearchOptions { max_effects: 2, budget: brief.budget / kinds.max(1) as u64, ..brief }
}

/// What can be left of readings by a scenario with what it lacks.
struct Left {
    /// Residuals in standard deviations.
    residuals: DVector<f64>,
    parameters: usize,
    /// Degrees of freedom that the deviations are known from.
    freedom: f64,
    /// What the criterion charges for having looked at many effects.
    looked_at: f64,
}

impl Left {
    /// By effects of the catalogue and, where a search is too short for these, by any law of the amplitude.
    fn by(scenario: &Scenario, table: &Table, short: &SearchOptions, solved: &Arc<AtomicU64>) -> Vec<Self> {
        let model = Model::new(&table.applied_to(scenario));
        let calibration = calibrate(&model, &scenario.free, &table.points, Tolerance::FIT, 0);
        let law = free_form::left_by_amplitude(&judge(scenario, table, &calibration, None));
        let (Hypothesis { fit, .. }, looked_at) = explain(scenario, table, short, solved);
        let freedom = table.freedom;
        let effects =
            Self { residuals: fit.evaluation.residuals, parameters: fit.parameters.len(), freedom, looked_at };
        let law = law.map(|(residuals, parameters)| Self { residuals, parameters, freedom, looked_at: 0.0 });
        let readings = effects.residuals.len();
        law.into_iter().filter(|law| law.residuals.len() == readings).chain([effects]).collect()
    }

    /// The criterion, squares in this unit.
    fn criterion(&self, unit: f64) -> f64 {
        let readings = self.residuals.len();
        let square = deviance(robust_square(&self.residuals, unit), readings, self.freedom);
        square + price(self.parameters, readings, self.freedom) + self.looked_at
    }
}

/// A kind of rig and reading, the scenario of it, and its readings.
type Drafted = (Kind, String, Scenario, Table);

/// The mean square of what the best of the drafts leaves of the readings, and the criterion of each by it: by what acts on
/// the motion, or, where that explains the readings in no draft, by what is read beside it where that does. Such makes one
/// kind of another: an acceleration and a share of the drive are a displacement. By it the two count as one kind.
fn weighed(drafts: &[Drafted], global: &Global) -> (f64, Vec<f64>) {
    let left = |beside: bool| -> Vec<Vec<Left>> {
        let short = short(drafts.len(), beside);
        of_searches(global, drafts.len(), short.budget, |solved| {
            let each = drafts.par_iter().zip(solved);
            each.map(|((.., scenario, table), solved)| Left::by(scenario, table, &short, solved)).collect()
        })
    };
    let typical = |left: &Left| typical_of(&left.residuals);
    let least = |all: &[Vec<Left>]| all.iter().flatten().map(typical).fold(f64::INFINITY, f64::min).powi(2);
    let of_each = |all: &[Vec<Left>], unit: f64| -> Vec<f64> {
        let least = |all: &Vec<Left>| all.iter().map(|left| left.criterion(unit)).fold(f64::INFINITY, f64::min);
        all.iter().map(least).collect()
    };
    let acting = left(false);
    let unit = least(&acting);
    if unit > EXCESS {
        let beside = left(true);
        let unit = least(&beside);
        if unit <= EXCESS {
            let own = of_each(&beside, unit);
            let of_class = |kind: &Kind| {
                let class = drafts.iter().zip(&own).filter(|((other, ..), _)| kind.order % 2 == other.order % 2);
                class.map(|(_, own)| *own).fold(f64::INFINITY, f64::min)
            };
            return (unit, drafts.iter().map(|(kind, ..)| of_class(kind)).collect());
        }
    }
    (unit, of_each(&acting, unit))
}

impl Draft<'_> {
    /// The scenario that explains the readings best with what it lacks, and what was chosen between, in words: of a
    /// reading in volts it is not said whether it is of displacement, velocity or acceleration, of a rig on a moving
    /// base not whether its motion is read relative to that, and where no drive is stated not whether a base moves;
    /// they differ in shape and phase.
    pub fn best_scenario(&self, target: &Path, global: &Global) -> Result<(String, Option<String>)> {
        let kinds = self.kinds();
        if let [only] = kinds[..] {
            return Ok((self.scenario(target, only), None));
        }
        let mut drafts = Vec::new();
        for kind in kinds {
            let text = self.scenario(target, kind);
            let scenario = crate::scenario::load_text(target, &text)?;
            if let Some(table) = load(&scenario)? {
                drafts.push((kind, text, scenario, thinned(table)));
            }
        }
        let (unit, mut criteria) = weighed(&drafts, global);
        // What explains nothing is no testimony against what the phase at resonance says.
        let first = drafts.first().map(|(kind, ..)| kind.order);
        let by_phase = unit > EXCESS && self.resonance.phase.is_some();
        let eligible = |at: usize| !by_phase || Some(drafts[at].0.order) == first;
        let better = |best: usize, at: usize| eligible(at) && criteria[at] + MARGIN < criteria[best];
        let best = (1..criteria.len()).fold(0, |best, at| if better(best, at) { at } else { best });
        let (kind, text, ..) = drafts.remove(best);
        let own = criteria.remove(best);
        let margin = criteria.iter().map(|other| other - own).fold(f64::INFINITY, f64::min);
        let by = if margin > MARGIN && unit <= EXCESS {
            format!("explains the readings, with what is missing, better by {margin:.0} in BIC")
        } else if margin > MARGIN {
            "leaves less of the readings, but nothing that was tried explains them: it is an assumption".into()
        } else if by_phase {
            "is an assumption by the phase at resonance, nothing that was tried explains the readings".into()
        } else {
            "is an assumption, the readings do not decide".into()
        };
        let others: Vec<String> = drafts.iter().map(|(other, ..)| self.words(*other)).collect();
        let taken = if self.may_be_base() { "rig" } else { "reading" };
        let chosen = format!("the {taken} is taken as {}, not {}: that {by}", self.words(kind), others.join(" or "));
        Ok((text, Some(chosen)))
    }

    /// What the reading may be of: first what needs the least offset of the phases, if with the sensor turned round, and
    /// the usual before others.
    fn kinds(&self) -> Vec<Kind> {
        let reading = self.signals().1;
        let mut orders = if reading.unit == "V" { vec![0, 1, 2] } else { vec![0] };
        if let Some(offset) = self.phase_offset() {
            // To the degree: the noise of the phases is no reason.
            let needed = |order: u8| wrap(offset - FRAC_PI_2 * f64::from(order)).abs().to_degrees().round() as u16;
            orders.sort_by_key(|order| (needed(*order).min(180 - needed(*order)), needed(*order)));
        }
        let bases: &[(bool, bool)] = match (self.base_driven(), self.may_be_base()) {
            (true, _) => &[(true, false), (true, true)],
            (_, true) => &[(false, false), (true, false)],
            _ => &[(false, false)],
        };
        let of = |order: u8| bases.iter().map(move |&(base, absolute)| Kind { base, order, absolute });
        orders.into_iter().flat_map(of).collect()
    }

    /// Whether what drives may be a base: where nothing states it and a reading in volts does not take its place, whose
    /// acceleration under a force is a displacement relative to a base.
    fn may_be_base(&self) -> bool {
        self.is_drive_unstated() && self.signals().1.unit != "V" && !self.rolls
    }

    fn words(&self, kind: Kind) -> String {
        if self.may_be_base() {
            let by = if kind.base {
                "by a base that moves by the same at all frequencies, and read relative to it"
            } else {
                "by a force of one size"
            };
            return format!("driven {by}");
        }
        let order = kind.order.max(self.signals().1.order);
        let of = ["displacement", "velocity", "acceleration"][usize::from(order.min(2))];
        match (kind.base, kind.absolute) {
            (false, _) if order == 2 && self.is_drive_unstated() => {
                format!("{of} (or displacement relative to a moving base)")
            }
            (false, _) => of.into(),
            (true, false) => format!("{of} relative to the base"),
            (true, true) => format!("absolute {of}"),
        }
    }
}
