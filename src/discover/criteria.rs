//! What a hypothesis leaves, and the criteria by which hypotheses are held against each other.

use super::hypothesis::Hypothesis;
use super::select::Search;
use crate::compare::{self, Whiteness};
use crate::fit::{MARGIN, deviance};
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

/// Whether a misfit so many times as small is worth so many parameters: Schwarz's criterion, squares counted in what is
/// left, over as many readings as are independent in that, of which neighbours are alike (Bartlett 1935).
pub(super) fn is_worth(ratio: f64, parameters: usize, readings: usize, autocorrelation: f64) -> bool {
    let alike = autocorrelation.clamp(0.0, 1.0);
    let independent = (readings as f64 * (1.0 - alike) / (1.0 + alike)).max(1.0);
    independent * ratio.ln() > parameters as f64 * independent.ln() + MARGIN
}

#[cfg(test)]
mod tests {
    use super::is_worth;

    #[test]
    fn of_readings_that_are_alike_few_speak_for_an_addition() {
        // A twentieth less of 4004 readings is worth three parameters, unless all neighbours are alike.
        assert!(is_worth(1.063, 3, 4004, 0.0) && !is_worth(1.063, 3, 4004, 0.98));
        assert!(is_worth(8.0, 2, 104, 0.84) && !is_worth(0.9, 1, 104, 0.0));
    }
}
