//! Least squares by singular values, of matrices whose numbers may have gone out of range.

use nalgebra::{DMatrix, DVector, Dyn, SVD};

/// Singular values and vectors of a matrix; `None` where its numbers, or their squares, are not finite.
pub fn svd(matrix: DMatrix<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    (matrix.norm_squared().is_finite() && !matrix.is_empty()).then(|| matrix.svd(true, true))
}

/// The shortest solution of least squares, singular values below this share of the largest counted as none; `None`
/// where there is none in numbers.
pub fn least_squares(matrix: DMatrix<f64>, right: &DVector<f64>, none: f64) -> Option<DVector<f64>> {
    let parts = svd(matrix)?;
    let solution = parts.solve(right, none * parts.singular_values.max()).ok()?;
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_in_any_unit_and_numbers_out_of_range_have_no_solution() {
        for unit in [1.0, 1e-12, 1e12] {
            let rows = DMatrix::from_fn(5, 2, |i, j| (i as f64).powi(j as i32) * unit);
            let right = DVector::from_fn(5, |i, _| (2.0 + 3.0 * i as f64) * unit);
            let found = least_squares(rows, &right, 1e-9).unwrap();
            assert!((found[0] - 2.0).abs() < 1e-9 && (found[1] - 3.0).abs() < 1e-9, "{unit}: {found}");
        }
        for number in [f64::NAN, f64::INFINITY, 1e200] {
            assert!(least_squares(DMatrix::from_element(3, 2, number), &DVector::zeros(3), 1e-9).is_none());
        }
    }
}
