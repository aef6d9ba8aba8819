//! Smooth curves of one variable: cubic B-splines (de Boor 1978) with a penalty on second differences (Eilers and Marx
//! 1996), or a value for each series.

use nalgebra::DMatrix;

/// Functions of a curve at most. How smooth a curve is, its penalty decides, not this number.
const MOST: usize = 16;
const CUBIC: usize = 3;

/// The functions whose sum a curve is, about their means over the readings: a constant is none of them.
#[derive(Debug, Clone)]
pub struct Basis {
    kind: Kind,
    means: Vec<f64>,
}

#[derive(Debug, Clone)]
enum Kind {
    /// Degree and knots.
    Spline(usize, Vec<f64>),
    /// So many series.
    Series(usize),
}

impl Basis {
    /// Splines over the range of places, as many as their number of different values bears; `None` where they do not
    /// differ.
    pub fn spline(places: &[f64]) -> Option<Self> {
        let mut sorted = places.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (low, high) = (*sorted.first()?, *sorted.last()?);
        sorted.dedup_by(|a, b| *a - *b <= 1e-9 * (high - low));
        let functions = sorted.len().min(MOST);
        if functions < 2 {
            return None;
        }
        let degree = CUBIC.min(functions - 1);
        let step = (high - low) / (functions - degree) as f64;
        let knots = (0..=functions + degree).map(|j| low + (j as f64 - degree as f64) * step).collect();
        Some(Self::about_means(Kind::Spline(degree, knots), places))
    }

    /// A value for each of so many series, the places being their numbers.
    pub fn series(count: usize, places: &[f64]) -> Self {
        Self::about_means(Kind::Series(count), places)
    }

    fn about_means(kind: Kind, places: &[f64]) -> Self {
        let mut basis = Self { means: vec![0.0; kind.len()], kind };
        let mut means = vec![0.0; basis.len()];
        for place in places {
            for (mean, value) in means.iter_mut().zip(basis.values(*place)) {
                *mean += value / places.len() as f64;
            }
        }
        basis.means = means;
        basis
    }

    /// Number of functions.
    pub fn len(&self) -> usize {
        self.kind.len()
    }

    /// The functions at a place, which is moved into the range of the readings.
    pub fn values(&self, place: f64) -> Vec<f64> {
        let values = match &self.kind {
            Kind::Series(count) => (0..*count).map(|series| f64::from(u8::from(series == place as usize))).collect(),
            Kind::Spline(degree, knots) => splines(knots, *degree, within(knots, *degree, place)),
        };
        values.iter().zip(&self.means).map(|(value, mean)| value - mean).collect()
    }

    /// Their derivatives by the place.
    pub fn slopes(&self, place: f64) -> Vec<f64> {
        let Kind::Spline(degree, knots) = &self.kind else { return vec![0.0; self.len()] };
        let (p, lower) = (*degree, splines(knots, degree - 1, within(knots, *degree, place)));
        let share = |j: usize| lower[j] / (knots[j + p] - knots[j]);
        (0..self.len()).map(|j| p as f64 * (share(j) - share(j + 1))).collect()
    }

    /// Matrix of the penalty: squared second differences, or squared distances from the mean of the series.
    pub fn penalty(&self) -> DMatrix<f64> {
        let n = self.len();
        match self.kind {
            Kind::Series(_) => DMatrix::identity(n, n),
            Kind::Spline(..) => {
                let differences = DMatrix::from_fn(n.saturating_sub(2), n, |i, j| match j.wrapping_sub(i) {
                    0 | 2 => 1.0,
                    1 => -2.0,
                    _ => 0.0,
                });
                differences.transpose() * differences
            }
        }
    }
}

impl Kind {
    fn len(&self) -> usize {
        match self {
            Self::Series(count) => *count,
            Self::Spline(degree, knots) => knots.len() - degree - 1,
        }
    }
}

fn within(knots: &[f64], degree: usize, place: f64) -> f64 {
    place.clamp(knots[degree], knots[knots.len() - degree - 1])
}

/// The B-splines of a degree over uniform knots by the recursion of Cox and de Boor.
fn splines(knots: &[f64], degree: usize, place: f64) -> Vec<f64> {
    let last = knots.len() - 1;
    let interval = (0..last).rev().find(|&j| knots[j] <= place && j < last).unwrap_or(0);
    let mut values: Vec<f64> = (0..last).map(|j| f64::from(u8::from(j == interval))).collect();
    for p in 1..=degree {
        for j in 0..last - p {
            let rising = (place - knots[j]) / (knots[j + p] - knots[j]);
            let falling = (knots[j + p + 1] - place) / (knots[j + p + 1] - knots[j + 1]);
            values[j] = rising * values[j] + falling * values[j + 1];
        }
    }
    values.truncate(last - degree);
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_add_up_to_one_everywhere_and_have_the_slopes_of_their_differences() {
        for count in [2, 3, 4, 40] {
            let places: Vec<f64> = (0..count).map(|i| (f64::from(i)).sqrt() - 7.0).collect();
            let basis = Basis::spline(&places).expect("they differ");
            let Kind::Spline(degree, knots) = &basis.kind else { panic!("splines") };
            for place in places.iter().copied().chain([-6.7, -6.2]) {
                let sum: f64 = splines(knots, *degree, within(knots, *degree, place)).iter().sum();
                assert!((sum - 1.0).abs() < 1e-12, "{count} {place} {sum}");
            }
            let h = 1e-6;
            for (j, slope) in basis.slopes(-6.5).into_iter().enumerate() {
                let difference = (basis.values(-6.5 + h)[j] - basis.values(-6.5 - h)[j]) / (2.0 * h);
                assert!((slope - difference).abs() < 1e-6, "{count} {j} {slope} {difference}");
            }
        }
        assert!(Basis::spline(&[2.0, 2.0]).is_none());
    }

    #[test]
    fn a_straight_line_costs_nothing_and_the_mean_of_a_curve_is_zero() {
        let places: Vec<f64> = (0..30).map(|i| f64::from(i * i)).collect();
        let basis = Basis::spline(&places).expect("they differ");
        let line = nalgebra::DVector::from_fn(basis.len(), |j, _| j as f64);
        assert!((basis.penalty() * line).norm() < 1e-9);
        let mean: f64 = places.iter().flat_map(|place| basis.values(*place)).sum();
        assert!(mean.abs() < 1e-9);
    }
}
