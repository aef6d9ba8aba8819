//! What a hypothesis leaves, and the criteria by which hypotheses are held against each other.

use super::hypothesis::Hypothesis;
use super::select::Search;
use crate::compare::{self, Whiteness};
use crate::fit::deviance;
use crate::measurement::Noise;

impl Search<'_> {
    /// Scatter of the residuals of a hypothesis about anything smooth over the stated noise, where that contradicts it.
    pub(super) fn scatter(&self, hypothesis: &Hypothesis) -> Option<Noise> {
        let points = compare::compared(&self.table.points, &hypothesis.fit.evaluation.predictions);
        compare::scatter(&points, self.table, hypothesis.fit.parameters.len())
    }

    /// Tests of the residuals; `None` where the fit is to a part of the points.
    pub(super) fn whiteness(&self, hypothesis: &Hypothesis) -> Option<Whiteness> {
        if hypothesis.fit.evaluation.predictions.len() != self.data.points.len() {
            return None;
        }
        let points = compare::compared(&self.table.points, &hypothesis.fit.evaluation.predictions);
        Some(compare::whiteness(&points, self.table, hypothesis.fit.parameters.len()))
    }

    pub(super) fn readings(&self) -> usize {
        self.data.readings()
    }

    /// Schwarz's criterion with squares in this unit.
    pub(super) fn bic(&self, unit: f64, hypothesis: &Hypothesis) -> f64 {
        let square = deviance(hypothesis.square(unit), self.readings(), self.table.freedom);
        square + self.data.price(hypothesis.fit.parameters.len())
    }

    /// The criterion with a charge for having looked at many additions.
    pub(super) fn score(&self, unit: f64, hypothesis: &Hypothesis) -> f64 {
        self.bic(unit, hypothesis) + self.looked_at(hypothesis)
    }

    /// The charge for having looked at many additions (extended BIC of Chen and Chen 2008).
    pub(super) fn looked_at(&self, hypothesis: &Hypothesis) -> f64 {
        2.0 * hypothesis.additions.len() as f64 * (self.pool.len().max(1) as f64).ln()
    }

    /// The hypothesis of the least criterion, squares in the least unit of all, and that unit.
    pub(super) fn least<'h>(&self, all: impl IntoIterator<Item = &'h Hypothesis>) -> Option<(f64, &'h Hypothesis)> {
        let all: Vec<&Hypothesis> = all.into_iter().collect();
        let unit = all.iter().map(|h| self.unit(h)).reduce(f64::min)?;
        let least = all.into_iter().min_by(|a, b| self.bic(unit, a).total_cmp(&self.bic(unit, b)))?;
        Some((unit, least))
    }

    /// What squares are counted in beside a hypothesis, as [`compare::Comparison::unit`]; beside one that was not
    /// fitted to all points, the noise.
    pub(super) fn unit(&self, hypothesis: &Hypothesis) -> f64 {
        let tested = self.whiteness(hypothesis);
        tested.map_or(1.0, |whiteness| compare::unit(&whiteness, &hypothesis.fit, self.readings()))
    }
}
