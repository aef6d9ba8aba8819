//! One competitor of the race: a fit of one more addition from one starting point.

use super::MARGIN;
use super::data::{Data, Effort, with_signs};
use super::hypothesis::{Addition, Basis, Estimate, Hypothesis};
use super::look::Start;
use super::race::{Competitor, Round};
use crate::fit::{Fit, Parameter, TAIL, robust_chi2, robust_square, typical_of};
use crate::model::Model;
use nalgebra::{DMatrix, DVector};

/// A continuum of sliders is looked at, and raced, on the points divided by this.
pub(super) const COSTLY: usize = 2;
/// A sum of squares as large as of noise, so many standard deviations of its distribution above the mean.
const NOISE: f64 = 3.0;

/// A fit of one more addition from one starting point, on its way.
// Wide: where a fit starts, where it is and when it ends, which every round reads together.
pub(super) struct Runner<'s, 'a> {
    data: &'s Data<'a>,
    /// What it adds to.
    pub from: &'s Hypothesis,
    /// Number of the candidate.
    pub of: usize,
    pub addition: Addition,
    model: Model,
    parameters: Vec<Parameter>,
    values: Vec<f64>,
    residuals: DVector<f64>,
    /// Sum of squares that what it adds to leaves of the readings of the look, as [`typical_square`].
    left: f64,
    /// Its fit so far.
    pub fit: Option<Fit>,
    /// What the last round took off its badness.
    gain: f64,
    /// Above what it is of no use.
    pub bar: Bar<'s>,
    /// Sum of squares on the same readings by which a rival has to be better for this one to leave.
    sure: f64,
}

/// What a fit has to come below to be of use.
#[derive(Clone, Copy)]
pub(super) enum Bar<'s> {
    None,
    /// The hypothesis that it adds to, which leaves nothing but noise, less the margin.
    Parent,
    /// This hypothesis, squares in this unit.
    At(&'s Hypothesis, f64),
}

impl Bar<'_> {
    fn unit(self) -> f64 {
        if let Self::At(_, unit) = self { unit } else { 1.0 }
    }
}

impl<'s, 'a> Runner<'s, 'a> {
    /// Before any fit.
    pub fn new(
        data: &'s Data<'a>,
        (from, of, sure): (&'s Hypothesis, usize, f64),
        addition: Addition,
        (start, rest): (Start, &DVector<f64>),
    ) -> Self {
        let Start { model, values, residuals } = start;
        let parameters = data.beside(&model, from, addition);
        Self {
            data,
            from,
            of,
            addition,
            model,
            parameters,
            values,
            residuals,
            left: typical_square(from, rest),
            fit: None,
            gain: 0.0,
            bar: Bar::None,
            sure,
        }
    }

    /// Number of the parameters of what it adds.
    pub fn own(&self) -> usize {
        self.parameters.len() - self.from.fit.parameters.len()
    }

    /// Distance from another of the same addition, in shares of the ranges of a search; without bound where a sign
    /// differs.
    pub fn distance(&self, other: &Self) -> f64 {
        let own = self.from.fit.parameters.len();
        let along = |i: usize| {
            let [a, b] = [self, other].map(|r| (r.parameters[i].share(r.values[i]), r.values[i].is_sign_negative()));
            if a.1 == b.1 { a.0 - b.0 } else { f64::INFINITY }
        };
        (own..self.parameters.len()).map(|i| along(i).powi(2)).sum::<f64>().sqrt()
    }

    /// Readings over those that the residuals are of.
    fn scale(&self) -> f64 {
        self.data.readings() as f64 / self.residuals.len().max(1) as f64
    }

    /// The criterion, squares in this unit.
    fn bic(&self, unit: f64) -> f64 {
        self.scale() * robust_square(&self.residuals, unit) + self.data.price(self.parameters.len())
    }

    /// The same of a hypothesis on the points that it was fitted to itself.
    fn on_same_points(&self, other: &Hypothesis, unit: f64) -> f64 {
        let points = self.fit.as_ref().map_or(0, |fit| fit.evaluation.predictions.len());
        let residuals = self.data.part(&other.fit.evaluation.residuals, points);
        self.scale() * robust_square(&residuals, unit) + self.data.price(other.fit.parameters.len())
    }

    /// By how much the sum of squares of what it adds to is larger over all readings than over those that the residuals
    /// are of: a part of the readings may happen to scatter less than all.
    fn ratio(&self) -> f64 {
        let all = &self.from.fit.evaluation.residuals;
        let left = self
            .fit
            .as_ref()
            .map_or(self.left, |fit| typical_square(self.from, &self.data.part(all, fit.evaluation.predictions.len())));
        let ratio = typical_square(self.from, all) / left;
        if ratio.is_finite() { ratio } else { self.scale() }
    }

    /// Whether it is worse than this by more than chance, also where it gains in the next round, with twice the
    /// evaluations, twice as much as in the last.
    fn is_above(&self, bar: f64, unit: f64) -> bool {
        let goes_on = self.fit.as_ref().is_some_and(Fit::is_exhausted);
        let gain = if goes_on { 2.0 * self.gain } else { 0.0 };
        self.bic(unit) - gain - bar > self.sure * self.scale()
    }

    /// Whether it has lost to what it was held against.
    pub fn has_lost(&self) -> bool {
        match self.bar {
            Bar::At(best, unit) if self.fit.is_some() => self.is_above(self.on_same_points(best, unit), unit),
            _ => false,
        }
    }

    /// As it stands; `full` where its fit is to all points.
    pub fn hypothesis(&self, full: bool) -> Hypothesis {
        let additions: Vec<Addition> = self.from.additions.iter().copied().chain([self.addition]).collect();
        let basis = match &self.fit {
            Some(fit) => Basis::SomePoints(fit.evaluation.predictions.len()),
            None => Basis::Linear,
        };
        let unfitted = || {
            let mut fit = self.from.fit.clone();
            (fit.parameters, fit.values) = (self.parameters.clone(), self.values.clone());
            fit.evaluation.jacobian = DMatrix::zeros(fit.evaluation.residuals.len(), fit.parameters.len());
            fit.termination = "not fitted: in a linear estimate it explains too little".into();
            fit
        };
        let fit = self.fit.clone().unwrap_or_else(unfitted);
        let estimate = (!full).then(|| Estimate { residuals: self.residuals.clone(), scale: self.ratio(), basis });
        Hypothesis { additions, model: self.model.clone(), fit, estimate, bic: f64::INFINITY }
    }
}

/// Sum of squares of residuals in the unit of what a hypothesis typically leaves.
fn typical_square(from: &Hypothesis, residuals: &DVector<f64>) -> f64 {
    robust_square(residuals, typical_of(&from.fit.evaluation.residuals).powi(2))
}

impl Competitor for Runner<'_, '_> {
    fn of(&self) -> usize {
        self.of
    }

    fn advance(&mut self, Round { points, evaluations, states }: Round) {
        let typical = if self.fit.is_some() { typical_of(&self.residuals) } else { f64::INFINITY };
        let all = self.data.points.len();
        let points = if self.model.has_sliders() && points < all { points / COSTLY } else { points };
        let effort = Effort { points, evaluations, states };
        if !self.data.affords(&self.model, effort) {
            return;
        }
        let unit = self.bar.unit();
        let before = if self.fit.is_some() { self.bic(unit) } else { f64::INFINITY };
        let fit = self.data.fit(&self.model, &self.parameters, &self.values, typical, effort);
        self.model = with_signs(&self.model, &fit);
        self.parameters.clone_from(&fit.parameters);
        self.values.clone_from(&fit.values);
        self.residuals.clone_from(&fit.evaluation.residuals);
        self.fit = Some(fit);
        self.gain = (before - self.bic(unit)).max(0.0);
    }

    fn typical(&self) -> f64 {
        typical_of(&self.residuals)
    }

    fn badness(&self, typical: f64) -> f64 {
        self.scale() * robust_chi2(&self.residuals, TAIL * typical) + self.data.price(self.parameters.len())
    }

    fn is_beaten(&self, first: &Self) -> bool {
        if self.fit.is_none() {
            return false;
        }
        let count = first.residuals.len() as f64;
        let noise = robust_square(&first.residuals, 1.0) < count + NOISE * (2.0 * count).sqrt();
        let barred = match self.bar {
            Bar::None => false,
            Bar::Parent => self.bic(1.0) + MARGIN >= self.on_same_points(self.from, 1.0),
            Bar::At(..) => self.has_lost(),
        };
        barred || (noise && self.is_above(first.bic(1.0), 1.0))
    }
}
