//! Readings that stand out of their series.

use super::{Compared, Outlier, PHASE};
use crate::statistics::{median, spread, wrap};
use nalgebra::{DMatrix, DVector};

/// A residual this many times the scatter of its neighbours about a line, or the step from one to the next, away from
/// that line stands out; where all is noise, one of so many standard deviations ...
const OUTLYING: f64 = 5.0;
/// Share of such a step that counts as scatter.
const STEP: f64 = 0.6;
/// ... and so many standard deviations from the parabola through them.
const OFF_PARABOLA: f64 = 4.5;
/// Neighbours on either side.
const NEIGHBOURS: usize = 3;

/// A residual of one reading in standard deviations, and what the model says there.
struct Held {
    row: usize,
    residual: f64,
    model: f64,
    sd: f64,
}

/// The readings of some series that stand out of these, `column` being that of the amplitudes and `noise` what is
/// theirs over the stated one; where all that is left looks like noise, `is_noise`, also what is no noise by its size
/// alone, which at the end of a series its neighbours may not tell.
pub(super) fn standing_out(
    series: &[Vec<&Compared>],
    column: &'static str,
    (noise, is_noise): (f64, bool),
) -> Vec<Outlier> {
    let amplitude = |p: &Compared| {
        let Compared { point, model, amplitude_residual, .. } = p;
        let (residual, sd) = (*amplitude_residual, point.amplitude_sd);
        Some(Held { row: point.row, residual, model: model.amplitude, sd })
    };
    let phase = |p: &Compared| {
        let Compared { point, model, phase_residual, .. } = p;
        Some(Held { row: point.row, residual: (*phase_residual)?, model: model.phase, sd: point.phase_sd? })
    };
    let amplitudes = of_column(series, column, (noise, is_noise), amplitude);
    let phases = of_column(series, PHASE, (noise, is_noise), phase);
    amplitudes.into_iter().zip(phases).flat_map(|(amplitudes, phases)| amplitudes.into_iter().chain(phases)).collect()
}

/// Of every series the readings of one column that stand out.
fn of_column(
    series: &[Vec<&Compared>],
    column: &'static str,
    (noise, is_noise): (f64, bool),
    held: impl Fn(&Compared) -> Option<Held>,
) -> Vec<Vec<Outlier>> {
    let curves: Vec<Vec<Held>> = series.iter().map(|own| own.iter().filter_map(|p| held(p)).collect()).collect();
    let bends: Vec<Vec<f64>> = curves.iter().map(|curve| bends(curve, column == PHASE)).collect();
    let share = missed(&curves, &bends, noise);
    let of = |(curve, bends): (&Vec<Held>, &Vec<f64>)| {
        let own = |row: usize| {
            let at = curve.iter().position(|held| held.row == row);
            noise.max(share * at.map_or(0.0, |at| bends[at]))
        };
        let residuals: Vec<(usize, f64)> = curve.iter().map(|held| (held.row, held.residual)).collect();
        let mut found = outliers(column, &residuals, own);
        let by_neighbours = found.len();
        for held in curve.iter().filter(|held| is_noise && held.residual.abs() > OUTLYING * noise) {
            if found[..by_neighbours].iter().all(|outlier| outlier.row != held.row) {
                let sigma = held.residual;
                found.push(Outlier { row: held.row, column, sigma, off_neighbours: sigma });
            }
        }
        found.sort_by_key(|outlier| curve.iter().position(|held| held.row == outlier.row));
        found
    };
    curves.iter().zip(&bends).map(of).collect()
}

/// How far every value of a curve is off the line through its neighbours.
fn deviations(values: &[f64]) -> Vec<f64> {
    let off = |i: usize| line(&near(values, i)).map_or(0.0, |(middle, _)| (values[i] - middle).abs());
    (0..values.len()).map(off).collect()
}

/// The same of what the model says, which may be angles, in standard deviations of the readings.
fn bends(curve: &[Held], angles: bool) -> Vec<f64> {
    let mut model: Vec<f64> = curve.iter().map(|held| held.model).collect();
    for i in (1..model.len()).filter(|_| angles) {
        model[i] = model[i - 1] + wrap(model[i] - model[i - 1]);
    }
    deviations(&model).into_iter().zip(curve).map(|(off, held)| off / held.sd).collect()
}

/// What a model misses of its own bends from one reading to the next, as a share: of a narrow peak on a coarse grid a
/// reading is as far off its neighbours as the model is wrong about the peak. The typical one of all readings at which
/// the model bends by more than noise; where these are few all of it.
fn missed(curves: &[Vec<Held>], bends: &[Vec<f64>], noise: f64) -> f64 {
    let missed = curves.iter().zip(bends).flat_map(|(curve, bends)| {
        let off = deviations(&curve.iter().map(|held| held.residual).collect::<Vec<_>>());
        let bent = off.into_iter().zip(bends).filter(|(_, bend)| **bend > OUTLYING * noise);
        bent.map(|(off, bend)| off / bend).collect::<Vec<_>>()
    });
    let missed: Vec<f64> = missed.collect();
    if missed.len() < NEIGHBOURS { 1.0 } else { median(missed) }
}

/// Readings that are far off where their neighbours along the frequency are not. `residuals` holds (row, residual) of
/// one column of one curve, in the order of the frequency; `noise` is, by row, how far off a reading may be where nothing
/// is wrong with it, in standard deviations. What stands out is taken out and the others are looked at again: of several
/// near each other one may hide the others.
pub(super) fn outliers(column: &'static str, residuals: &[(usize, f64)], noise: impl Fn(usize) -> f64) -> Vec<Outlier> {
    let mut kept = residuals.to_vec();
    let mut found: Vec<Outlier> = Vec::new();
    loop {
        let next = far_off(column, &kept, &noise);
        if next.is_empty() {
            found.sort_by_key(|outlier| residuals.iter().position(|(row, _)| *row == outlier.row));
            return found;
        }
        kept.retain(|(row, _)| !next.iter().any(|outlier| outlier.row == *row));
        found.extend(next);
    }
}

/// Those of them that their neighbours tell at once.
fn far_off(column: &'static str, residuals: &[(usize, f64)], noise: impl Fn(usize) -> f64) -> Vec<Outlier> {
    let mut found = Vec::new();
    let values: Vec<f64> = residuals.iter().map(|(_, residual)| *residual).collect();
    for (i, &(row, residual)) in residuals.iter().enumerate() {
        let near = near(&values, i);
        let Some((middle, scatter)) = line(&near) else { continue };
        // Where a model fails, its residuals run steeply and bend: a step from one neighbour to the next is no
        // surprise.
        let step = median(near.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()));
        let noise = noise(row);
        let off_line = (residual - middle).abs() > OUTLYING * scatter.max(STEP * step).max(noise);
        if off_line && off_parabola(residual, &near, noise) {
            found.push(Outlier { row, column, sigma: residual, off_neighbours: residual - middle });
        }
    }
    found
}

/// The neighbours of a value in a curve, and how many steps away: as many on one side as are missing on the other.
fn near(values: &[f64], i: usize) -> Vec<(f64, f64)> {
    let first = i.saturating_sub(NEIGHBOURS).min(values.len().saturating_sub(2 * NEIGHBOURS + 1));
    let range = first..(first + 2 * NEIGHBOURS + 1).min(values.len());
    range.filter(|&j| j != i).map(|j| (j as f64 - i as f64, values[j])).collect()
}

/// Where the line through neighbours passes (Theil 1950, Sen 1968: at the end of a curve on which a model fails smoothly
/// they are all on one side), and their scatter about it; `None` where these are too few.
fn line(near: &[(f64, f64)]) -> Option<(f64, f64)> {
    if near.len() < NEIGHBOURS {
        return None;
    }
    let pairs = near.iter().enumerate().flat_map(|(n, a)| near[..n].iter().map(move |b| (a.1 - b.1) / (a.0 - b.0)));
    let slope = median(pairs);
    let level: Vec<f64> = near.iter().map(|(step, value)| value - slope * step).collect();
    let middle = median(level.iter().copied());
    Some((middle, spread(level, middle)))
}

/// Whether a residual is further from the parabola through its neighbours (step, residual) than noise takes it: at the
/// end of a curve, where neighbours are on one side, that is known less well. One of them, the one that fits least to
/// the others, is left out: it may stand out itself.
fn off_parabola(residual: f64, near: &[(f64, f64)], noise: f64) -> bool {
    let without = |skipped: usize| {
        let kept: Vec<(f64, f64)> = (0..near.len()).filter(|&i| i != skipped).map(|i| near[i]).collect();
        let design = DMatrix::from_fn(kept.len(), 3, |row, power| kept[row].0.powi(power as i32));
        let values = DVector::from_iterator(kept.len(), kept.iter().map(|(_, residual)| *residual));
        let inverse = (design.transpose() * &design).try_inverse()?;
        let parabola = &inverse * design.transpose() * &values;
        Some(((values - design * &parabola).norm_squared(), parabola[0], inverse[(0, 0)]))
    };
    // Of four neighbours or fewer there is none that could miss.
    let fits = (0..near.len()).filter(|_| near.len() > 4).filter_map(without);
    let Some((_, there, variance)) = fits.min_by(|a, b| a.0.total_cmp(&b.0)) else { return true };
    (residual - there).abs() > OFF_PARABOLA * noise * (1.0 + variance).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Prediction;
    use crate::measurement::Point;
    use crate::solver::Status;

    /// Residuals without noise: what stands out is known.
    fn rows(residual: impl Fn(f64) -> f64) -> Vec<(usize, f64)> {
        (0..24).map(|row| (row, residual(row as f64))).collect()
    }

    #[test]
    fn a_smooth_misfit_has_no_outliers_and_a_reading_far_off_is_one_wherever_it_stands() {
        for smooth in [|x: f64| 60.0 - 8.0 * x, |x: f64| 100.0 * (0.2 * x).sin(), |x: f64| 0.5 * x * x] {
            assert_eq!(outliers("amplitude_rad", &rows(smooth), |_| 1.0), []);
        }
        for far in [0, 1, 12, 23] {
            let found =
                outliers("amplitude_rad", &rows(|x| 60.0 - 8.0 * x + if x == far as f64 { 30.0 } else { 0.0 }), |_| {
                    1.0
                });
            assert_eq!(found.iter().map(|o| o.row).collect::<Vec<_>>(), [far]);
        }
    }

    #[test]
    fn two_readings_off_side_by_side_hide_neither() {
        for (first, size) in [(0, 20.0), (11, 12.0), (22, 20.0)] {
            let found = outliers(
                "amplitude_rad",
                &rows(|x| if x == f64::from(first) || x == f64::from(first) + 1.0 { size } else { 0.0 }),
                |_| 1.0,
            );
            let found: Vec<usize> = found.iter().map(|o| o.row).collect();
            assert_eq!(found, [first as usize, first as usize + 1], "{size}");
        }
    }

    #[test]
    fn a_third_reading_off_nearby_hides_no_two_at_an_end() {
        // Where a planted drag is fitted, of an independent table with 6 % of its readings off.
        let few = [14.1, 21.8, 0.0, -0.3, 1.5, -19.0, -0.3, -0.8, 0.9, -0.9, 0.2, -0.5, -1.5, -1.0, -0.9, -0.8];
        let rows: Vec<(usize, f64)> = few.into_iter().enumerate().collect();
        let found: Vec<usize> = outliers("amplitude_v", &rows, |_| 1.0).iter().map(|o| o.row).collect();
        assert_eq!(found, [0, 1, 5]);
    }

    #[test]
    fn a_misfit_that_bends_at_its_end_has_no_outliers() {
        // Where the sixth of the practice curves of table 1 ends, as the published law misses it.
        let bent = [60.1, 66.7, 69.0, 69.1, 67.1, 66.7, 60.4, 54.1, 47.3, 40.6, 29.3, 20.1, 8.3, -5.2, -17.8, -24.4];
        let rows: Vec<(usize, f64)> = bent.into_iter().enumerate().collect();
        assert_eq!(outliers("amplitude_rad", &rows, |_| 1.0), []);
        let mirrored: Vec<(usize, f64)> = bent.into_iter().rev().enumerate().collect();
        assert_eq!(outliers("amplitude_rad", &mirrored, |_| 1.0), []);
    }

    /// Series of a linear resonance of quality factors `rigs` about one at Q 60, so many readings each, with one percent of
    /// noise, and one reading of the second series off by a share.
    fn beside(rigs: [f64; 3], readings: usize, off: (usize, f64)) -> Vec<Outlier> {
        let size = |r: f64, q: f64| (1.0 - r * r).hypot(r / q).recip();
        let compared = |(condition, q): (usize, &f64), i: usize| {
            let r = 1.0 + 0.2 * (i as f64 / (readings - 1) as f64 - 0.5);
            let row = condition * readings + i;
            let noise = 0.01 * (f64::from(sobol_burley::sample(row as u32, 0, 3)) - 0.5) * 12f64.sqrt();
            let share = if (condition, i) == (1, off.0) { 1.0 + off.1 } else { 1.0 };
            let (amplitude, model) = (size(r, *q) * (1.0 + noise) * share, size(r, 60.0));
            let sd = 0.01 * amplitude;
            let point = Point {
                row,
                line: row,
                speed: 0.0,
                load: 0.0,
                drive: 1.0,
                frequency: 100.0 * r,
                amplitude,
                phase: None,
                amplitude_sd: sd,
                phase_sd: None,
                mean: None,
                replicates: 1,
                series: condition,
            };
            let status = Status::Steady;
            let model = Prediction { amplitude: model, phase: 0.0, status, others: Vec::new(), beyond: false };
            let amplitude_residual = (model.amplitude - amplitude) / sd;
            Compared { point, condition, model, amplitude_residual, phase_residual: None }
        };
        let all: Vec<Vec<Compared>> =
            rigs.iter().enumerate().map(|of| (0..readings).map(|i| compared(of, i)).collect()).collect();
        let series: Vec<Vec<&Compared>> = all.iter().map(|own| own.iter().collect()).collect();
        standing_out(&series, "amplitude_m", (1.0, rigs == [60.0; 3]))
    }

    #[test]
    fn a_peak_on_a_coarse_grid_that_a_model_misses_is_no_outlier() {
        // Three readings within the width of the peak.
        assert_eq!(beside([20.0, 35.0, 120.0], 31, (0, 0.0)), []);
        assert_eq!(beside([60.0; 3], 31, (0, 0.0)), []);
        // Of a model that explains the others one at the peak is, and one on a flank of any.
        for (rigs, at) in [([60.0; 3], 15), ([60.0; 3], 14), ([60.0; 3], 4), ([20.0, 35.0, 120.0], 4)] {
            let found: Vec<usize> = beside(rigs, 31, (at, -0.4)).iter().map(|o| o.row).collect();
            assert_eq!(found, [31 + at], "{rigs:?}");
        }
        // Three readings are no neighbours of one another; where all else is noise its size tells it.
        assert_eq!(beside([60.0; 3], 3, (2, -0.08)).iter().map(|o| o.row).collect::<Vec<_>>(), [5]);
        assert_eq!(beside([60.0, 60.0, 60.1], 3, (2, -0.08)), []);
    }
}
