//! Whether residuals look like noise: runs of signs, autocorrelation of neighbours, smooth components.

use super::Compared;
use super::outliers::outliers;
use crate::measurement::{self, Noise, NoiseSource, Point, Spread, Table};
use crate::statistics::{CLIP, SIGNIFICANCE, median};
use schemars::JsonSchema;
use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal};

/// Smooth components (polynomials of the point's number) that a curve is searched for, at most.
const COMPONENTS: usize = 5;
/// Points per component that a curve must have.
const POINTS_PER_COMPONENT: usize = 3;
/// Efficiency of a standard deviation told from the median size of normal residuals (Rousseeuw and Croux 1993).
const MEDIAN_EFFICIENCY: f64 = 0.3675;

/// Tests of residuals against noise; every probability is that of noise looking at least as structured.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, serde::Serialize)]
// Wide: a field is a key of the file, where they stand side by side.
pub struct Whiteness {
    /// Runs of equal sign along the frequency or, where that tells nothing and the order of the rows does, in that, over
    /// all curves.
    pub runs: usize,
    /// Runs that noise would have on average.
    pub runs_expected: f64,
    /// Probability of so few runs.
    pub runs_p: f64,
    /// Correlation of neighbours.
    pub autocorrelation: f64,
    /// Probability of so much of it.
    pub autocorrelation_p: f64,
    /// Mean square of the smooth components over that of the rest.
    pub smooth_ratio: f64,
    /// Probability of so large a ratio.
    pub smooth_p: f64,
    /// Mean square of the rest: the noise that the data have over the one stated, squared, whatever smooth misfit there
    /// is.
    pub rough_chi2: f64,
    /// Degrees of freedom of the rest.
    pub rough_freedom: f64,
    /// Whether the misfit is structured rather than noise.
    pub structured: bool,
    /// Whether that is told by its size alone: it is larger than the scatter of the readings along their series.
    #[serde(skip)]
    pub exceeds: bool,
    /// Whether that is told in the order of the rows: along the frequency there is none.
    #[serde(skip)]
    pub as_read: bool,
    /// Whether there are neighbours enough along series for the tests to find structure at all.
    pub testable: bool,
    /// Whether the noise is that of the readings' own scatter along series, so that a larger misfit is none of it.
    #[serde(skip)]
    pub own_scatter: bool,
}

/// The stated noise is contradicted by a scatter that differs by more than this factor.
const NOISE_DIFFERS: f64 = 1.25;

impl Whiteness {
    /// Whether nothing but noise is left, by tests that could have found more.
    pub fn is_noise(&self) -> bool {
        self.testable && !self.structured
    }

    /// Scatter of the residuals about anything smooth over the stated noise, and whether it differs from one by more
    /// than chance.
    pub fn scatter(&self) -> (f64, bool) {
        if self.own_scatter {
            return (1.0, false);
        }
        let factor = self.rough_chi2.sqrt();
        (factor, differs(factor, self.rough_freedom))
    }

    /// Noise of the readings over the stated one: the scatter where that contradicts it; where the noise was estimated
    /// from the readings alone, the scatter about the model, which is known better.
    pub fn noise(&self) -> f64 {
        match self.scatter() {
            _ if self.own_scatter => self.rough_chi2.sqrt(),
            (factor, true) => factor,
            _ => 1.0,
        }
    }
}

/// Whether a scatter of so many degrees of freedom, over the stated noise, differs from one, and by more than chance.
fn differs(factor: f64, freedom: f64) -> bool {
    let sure = factor.ln().abs() > 4.0 / (2.0 * freedom.max(1.0)).sqrt();
    sure && !(1.0 / NOISE_DIFFERS..NOISE_DIFFERS).contains(&factor)
}

/// The table with the scatter of the readings along their series for stated standard deviations that are too small for
/// it, before any model: beside these nothing would be left that looks like noise, and an explanation would be chosen
/// for its number of parameters. And how many times as large they are.
pub fn unless_understated(table: &Table) -> (Table, Noise) {
    let seen = measurement::scatter(&table.points);
    let of = |source: NoiseSource, seen: Option<Spread>, stated: &dyn Fn(&Point) -> Option<f64>| {
        let single = |p: &Point| Some(stated(p)? * (p.replicates as f64).sqrt());
        let stated = median(table.points.iter().filter_map(single));
        let seen = seen.filter(|_| source == NoiseSource::Stated && stated > 0.0);
        let factor = seen.map(|seen| (seen.sd / stated, seen.degrees_of_freedom as f64));
        let larger = factor.filter(|(factor, freedom)| *factor > 1.0 && differs(*factor, *freedom));
        larger.unwrap_or((1.0, f64::INFINITY))
    };
    let amplitude = of(table.amplitude_noise, seen.amplitude, &|p| Some(p.amplitude_sd / p.amplitude));
    let phase = table.phase_noise.map(|source| of(source, seen.phase, &|p| p.phase_sd));
    let phase = phase.unwrap_or((1.0, f64::INFINITY));
    let noise = Noise { amplitude: amplitude.0, phase: phase.0 };
    (table.estimated(noise, [amplitude.1, phase.1]), noise)
}

/// Scatter of amplitudes and phases about anything smooth, over their standard deviations, each by itself; `None` where
/// it is not to be gone by. Of stated deviations where it contradicts these, of those estimated along series always: it
/// is known better. More than they say only where nothing but noise is left: a misfit may be rough too.
pub fn scatter(points: &[Compared], table: &Table, fitted: usize) -> Option<Noise> {
    let structured = whiteness(points, table, fitted).structured;
    let of = |kind: fn(&Compared) -> Option<f64>, source: NoiseSource| {
        let curve = |number| points.iter().filter(|p| p.condition == number).filter_map(kind).collect();
        let curves: Vec<Vec<f64>> = (0..table.series.len()).map(curve).collect();
        let (factor, contradicted) = test(&curves, 0).scatter();
        let told = match source {
            NoiseSource::Estimated => !structured,
            _ => contradicted && (factor < 1.0 || !structured),
        };
        if told { factor } else { 1.0 }
    };
    let noise = Noise {
        amplitude: of(|p| Some(p.amplitude_residual), table.amplitude_noise),
        phase: table.phase_noise.map_or(1.0, |source| of(|p| p.phase_residual, source)),
    };
    (noise != Noise::STATED).then_some(noise)
}

/// Tests the residuals of all series along the frequency and, where these show nothing, in the order of the rows: two
/// sweeps of one series that differ alternate along the frequency. `fitted` parameters have absorbed as many components.
pub fn whiteness(points: &[Compared], table: &Table, fitted: usize) -> Whiteness {
    let own_scatter = table.amplitude_noise == NoiseSource::Estimated;
    let along = |key: fn(&Compared) -> usize| {
        let mut curves: Vec<Vec<f64>> = Vec::new();
        for condition in 0..table.series.len() {
            let mut of: Vec<&Compared> = points.iter().filter(|p| p.condition == condition).collect();
            of.sort_by_key(|p| key(p));
            curves.push(of.iter().map(|p| p.amplitude_residual).collect());
            curves.push(of.iter().filter_map(|p| p.phase_residual).collect());
        }
        curves
    };
    // Points stand in the order of the frequency, and sorting leaves those of one key as they are.
    let curves = along(|_| 0);
    let mut found = test(&curves, fitted);
    if !found.structured {
        let read = Whiteness { as_read: true, ..test(&along(|p| p.point.row), fitted) };
        found = if read.structured { read } else { found };
    }
    found.own_scatter = own_scatter;
    found.exceeds =
        own_scatter && excess_p(&curves.concat(), fitted, table.freedom) < SIGNIFICANCE && !found.structured;
    found.structured |= found.exceeds;
    found
}

/// Probability that a noise known from so many degrees of freedom leaves residuals as large. By the middle of them: a
/// few outliers are no misfit.
fn excess_p(residuals: &[f64], fitted: usize, freedom: f64) -> f64 {
    let left = MEDIAN_EFFICIENCY * residuals.len().saturating_sub(fitted) as f64;
    FisherSnedecor::new(left, freedom).map_or(1.0, |f| f.sf(typical(residuals).powi(2)))
}

fn test(curves: &[Vec<f64>], fitted: usize) -> Whiteness {
    let (mut runs, mut expected, mut variance) = (0, 0.0, 0.0);
    let (mut product, mut neighbours, mut energy) = (0.0, 0.0, 0.0);
    let (mut smooth, mut rough, mut smooth_n, mut rough_n) = (0.0, 0.0, 0.0, 0.0);
    for curve in curves.iter().map(|curve| clean(curve)).filter(|curve| curve.len() > 1) {
        runs += 1 + curve.windows(2).filter(|w| (w[0] > 0.0) != (w[1] > 0.0)).count();
        let pairs = (curve.len() - 1) as f64;
        expected += 1.0 + 0.5 * pairs;
        variance += 0.25 * pairs;
        neighbours += pairs;
        for pair in curve.windows(2) {
            product += pair[0] * pair[1];
            energy += 0.5 * (pair[0].powi(2) + pair[1].powi(2));
        }
        let components = (curve.len() / POINTS_PER_COMPONENT).min(COMPONENTS);
        let inside = projected(&curve, components);
        smooth += inside;
        smooth_n += components as f64;
        rough += curve.iter().map(|r| r * r).sum::<f64>() - inside;
        rough_n += (curve.len() - components) as f64;
    }
    let tail = |z: f64| Normal::standard().sf(z);
    let runs_p = if variance > 0.0 { tail((expected - runs as f64) / f64::sqrt(variance)) } else { 1.0 };
    let smooth_n: f64 = (smooth_n - fitted as f64).max(1.0);
    let rough_chi2 = if rough_n > 0.0 { rough / rough_n } else { 1.0 };
    let smooth_ratio = smooth / smooth_n / rough_chi2.max(f64::MIN_POSITIVE);
    // By the noise about anything smooth: a misfit of a few neighbours at a peak is small beside its own square.
    let by_chance = rough_chi2 * f64::sqrt(neighbours);
    let autocorrelation_p = if by_chance > 0.0 { tail(product / by_chance) } else { 1.0 };
    let smooth_p = FisherSnedecor::new(smooth_n, rough_n.max(1.0)).map_or(1.0, |f| f.sf(smooth_ratio));
    // Of so many pairs of neighbours the fewest runs, one, have to be impossible by chance; of as many as so many
    // parameters leave.
    let readings = curves.iter().map(Vec::len).sum::<usize>().max(1) as f64;
    let left = variance * (1.0 - fitted as f64 / readings).max(0.0);
    let testable = tail(2.0 * left.sqrt()) < 0.1 * SIGNIFICANCE;
    let structured = smooth_p < SIGNIFICANCE || autocorrelation_p < SIGNIFICANCE || runs_p < 0.1 * SIGNIFICANCE;
    Whiteness {
        runs,
        runs_expected: expected,
        runs_p,
        autocorrelation: if energy > 0.0 { product / energy } else { 0.0 },
        autocorrelation_p,
        smooth_ratio,
        smooth_p,
        rough_chi2,
        rough_freedom: rough_n,
        structured,
        exceeds: false,
        as_read: false,
        testable,
        own_scatter: false,
    }
}

/// A curve without the readings that stand out, which tell nothing of the others, and what is large cut.
fn clean(curve: &[f64]) -> Vec<f64> {
    let numbered: Vec<(usize, f64)> = curve.iter().copied().enumerate().collect();
    let out = outliers("", &numbered, |_| 1.0);
    let most = CLIP * typical(curve).max(1.0);
    let kept = numbered.iter().filter(|(row, _)| !out.iter().any(|o| o.row == *row));
    kept.map(|(_, residual)| residual.clamp(-most, most)).collect()
}

fn typical(curve: &[f64]) -> f64 {
    if curve.is_empty() {
        return 0.0;
    }
    let mut sizes: Vec<f64> = curve.iter().map(|r| r.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    1.4826 * sizes[sizes.len() / 2]
}

/// Sum of squares of the projection onto the first polynomials of the point's number.
fn projected(values: &[f64], components: usize) -> f64 {
    let n = values.len();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for order in 0..components {
        let x = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
        let mut vector: Vec<f64> = (0..n).map(|i| x(i).powi(order as i32)).collect();
        for earlier in &basis {
            let along: f64 = vector.iter().zip(earlier).map(|(a, b)| a * b).sum();
            vector.iter_mut().zip(earlier).for_each(|(a, b)| *a -= along * b);
        }
        let norm = vector.iter().map(|a| a * a).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|a| *a /= norm);
        basis.push(vector);
    }
    basis.iter().map(|vector| vector.iter().zip(values).map(|(a, b)| a * b).sum::<f64>().powi(2)).sum()
}
