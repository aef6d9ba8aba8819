//! Blocks of neighbouring rows: laws are judged at blocks that were left out of their fit, and uncertainties come from
//! what leaving out a block changes. Neighbours of a master curve are of one sweep and not independent; single rows
//! left out would tell an error that is too small.

use super::Moduli;
use super::law::{Fitted, Law};
use rayon::prelude::*;
use std::ops::Range;

/// Rows of a block at least, blocks per decade at most (a relaxation's loss peak is 1.1 decades wide at half its
/// height), and blocks at least and at most as far as there are rows.
const ROWS: usize = 3;
const PER_DECADE: f64 = 4.0;
const BLOCKS: (usize, usize) = (5, 100);
/// Fits with something left out, at most: of more blocks every so manieth is left out together (Kohavi, IJCAI 1995:
/// ten).
const FOLDS: usize = 10;

/// How far readings that were left out are missed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// Mean over the blocks of the mean squared relative residual.
    pub mean: f64,
    /// Standard error of that mean, from its scatter over the blocks.
    pub standard_error: f64,
}

/// So many blocks of so many rows in order, alike in length to one row.
fn blocks(moduli: &Moduli) -> Vec<Range<usize>> {
    let rows = moduli.points.len();
    let of_band = (PER_DECADE * moduli.decades()) as usize;
    let count = of_band.clamp(BLOCKS.0, BLOCKS.1).min(rows / ROWS).max(2);
    (0..count).map(|k| k * rows / count..(k + 1) * rows / count).collect()
}

/// The law fitted without each fold of the blocks: fits, each with the blocks that it did not see.
fn refits(law: &Law, moduli: &Moduli, blocks: &[Range<usize>]) -> Vec<(Fitted, Vec<Range<usize>>)> {
    let folds = blocks.len().min(FOLDS);
    let without = |fold: usize| {
        let left_out: Vec<Range<usize>> = blocks.iter().skip(fold).step_by(folds).cloned().collect();
        let is_in = |row: &usize| !left_out.iter().any(|block| block.contains(row));
        let points: Vec<_> = (0..moduli.points.len()).filter(is_in).map(|row| moduli.points[row].clone()).collect();
        (law.fit(moduli, &points), left_out)
    };
    (0..folds).into_par_iter().map(without).collect()
}

/// Predicts every block from the others. The first and the last row stay in: beyond the rows that are fitted nothing is
/// determined, and no law is to be judged there.
pub fn held_out(law: &Law, moduli: &Moduli) -> Score {
    let last = moduli.points.len() - 1;
    let inner: Vec<_> = blocks(moduli).into_iter().map(|block| block.start.max(1)..block.end.min(last)).collect();
    let error = |fitted: &Fitted, block: &Range<usize>| {
        let squares = moduli.errors(fitted, block.clone());
        squares.iter().sum::<f64>() / squares.len() as f64
    };
    let refits = refits(law, moduli, &inner);
    let errors: Vec<f64> =
        refits.iter().flat_map(|(fitted, blocks)| blocks.iter().map(|block| error(fitted, block))).collect();
    let (mean, variance) = moments(&errors);
    Score { mean, standard_error: (variance / errors.len() as f64).sqrt() }
}

/// Half the widths of the 95 % intervals of what `read` takes from a fit: the delete-a-group jackknife, with Student's
/// t.
pub fn half_widths(law: &Law, moduli: &Moduli, read: impl Fn(&Fitted) -> Vec<f64>) -> Vec<f64> {
    use statrs::distribution::{ContinuousCDF as _, StudentsT};
    let refits: Vec<Vec<f64>> = refits(law, moduli, &blocks(moduli)).iter().map(|(fitted, _)| read(fitted)).collect();
    let count = refits.len() as f64;
    let t = StudentsT::new(0.0, 1.0, count - 1.0).map_or(f64::NAN, |t| t.inverse_cdf(0.975));
    let width = |at: usize| {
        let values: Vec<f64> = refits.iter().map(|values| values[at]).collect();
        t * (moments(&values).1 * (count - 1.0) * (count - 1.0) / count).sqrt()
    };
    (0..refits[0].len()).map(width).collect()
}

/// Mean and variance of a sample.
fn moments(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0))
}
