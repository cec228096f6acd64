//! Uncertainty of a fit.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-10 | W = rows J diag(range) of the data and range / sd of the priors; W = U s V'; C = diag(range) V s^-2 V' diag(range) | source: linear Gaussian posterior, e.g. Tarantola 2005; standard deviations of the data are absolute, so C is not scaled by CA-13 |
//! | CA-11 | a direction v is unknown where \|W v\| is at most 0.1, or where the data's part of it is at most 1e-6 of their largest singular value and the priors' part at most 0.1; a parameter with more than 1e-3 of itself in unknown directions has no variance | ASSUMED: a standard deviation of 10 ranges says nothing; 1e-6 is the error of CA-5 |
//! | CA-12 | a parameter on a bound (1e-6 of its range) is held there: it has no variance, the others have theirs given its value | ASSUMED |
//! | CA-13 | reduced chi squared = cost / nu; nu = residuals + priors - known directions of the parameters that are not held | source: e.g. Bevington and Robinson 2003 |
//! | CA-14 | probability of a cost of at least this: 1 - F(cost), F of chi squared with nu degrees of freedom | source: Pearson 1900 (statrs) |
//! | CA-15 | prior share = C_kk / sd^2 of the prior: 1 where the data have no influence | derived |
//! | CA-16 | columns scaled to relative changes: x dr/dx; where start or x is 0, by the range | ASSUMED |

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::search::ON_BOUND;
use super::types::{Fit, Parameter};

/// Share of the largest singular value that is no more than the error of derivatives (CA-11).
pub(super) const NOISE: f64 = 1e-6;
/// Length below which a direction is unknown, in standard deviations a range (CA-11).
const UNKNOWN: f64 = 0.1;
/// Part of a parameter in unknown directions from which on it is unknown (CA-11).
const INVOLVED: f64 = 1e-3;

/// One of two bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// The least value.
    Low,
    /// The greatest value.
    High,
}

/// A direction in the space of relative changes, and how well the data determine it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Direction {
    /// Length of the change of the data's residuals by a unit step along it: 1 / its standard deviation from the data alone.
    pub singular_value: f64,
    /// Share of each parameter, relative to its value (to its range where start or value is 0, see CA-16); sum of squares 1.
    pub weights: Vec<f64>,
}

/// Uncertainty in the linear approximation at the solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Covariance in own units (CA-10); NaN in rows and columns of parameters without a standard error.
    pub covariance: DMatrix<f64>,
    /// Standard error in own unit; `None` where neither data nor prior determine the parameter (CA-11) or it lies on a bound (CA-12).
    pub standard_error: Vec<Option<f64>>,
    /// Correlation, NaN like the covariance.
    pub correlation: DMatrix<f64>,
    /// Variance after the fit over that of the prior (CA-15); `None` without prior or standard error.
    pub prior_share: Vec<Option<f64>>,
    /// Cost by degree of freedom (CA-13); `None` without one.
    pub reduced_chi2: Option<f64>,
    /// Residuals and priors less the directions that were fitted (CA-13).
    pub degrees_of_freedom: usize,
    /// Probability of a cost at least as large if the model is right and all standard deviations are (CA-14); `None` without a degree of
    /// freedom.
    pub chi2_probability: Option<f64>,
    /// Directions of the data alone (no priors), the best determined first; as many as parameters.
    pub directions: Vec<Direction>,
    /// The bound that a parameter is on.
    pub at_bound: Vec<Option<Bound>>,
    /// Parameters that move no residual of the data at the solution: a range of them less than 1e-6 of what a range of the strongest does.
    pub dead: Vec<usize>,
}

/// Covariance, chi squared and directions of a fit.
#[must_use]
pub fn uncertainty(fit: &Fit, parameters: &[Parameter]) -> Uncertainty {
    let n = parameters.len();
    let pairs = parameters.iter().zip(&fit.values);
    let at_bound: Vec<Option<Bound>> = pairs.map(|(p, x)| bound_of(p, *x)).collect();
    let free: Vec<usize> = (0..n).filter(|&k| at_bound[k].is_none()).collect(); // CA-12
    let (small, known) = free_covariance(fit, parameters, &free);
    let mut covariance = DMatrix::from_element(n, n, f64::NAN);
    for (i, &k) in free.iter().enumerate() {
        for (j, &l) in free.iter().enumerate() {
            covariance[(k, l)] = small[(i, j)];
        }
    }
    let finite = |se: f64| se.is_finite().then_some(se);
    let standard_error: Vec<Option<f64>> =
        (0..n).map(|k| finite(covariance[(k, k)].sqrt())).collect();
    let of = |k: usize| standard_error[k].unwrap_or(f64::NAN);
    let correlation = DMatrix::from_fn(n, n, |k, l| match k == l {
        true => of(k) / of(k),
        false => covariance[(k, l)] / (of(k) * of(l)),
    });
    let share = |(k, p): (usize, &Parameter)| Some((standard_error[k]? / p.prior?.sd).powi(2)); // CA-15
    let prior_share = parameters.iter().enumerate().map(share).collect();
    let degrees_of_freedom =
        (fit.residuals.len() + fit.prior_residuals.len()).saturating_sub(known);
    let freedom = (degrees_of_freedom > 0).then_some(degrees_of_freedom as f64);
    let reduced_chi2 = freedom.map(|nu| fit.cost / nu); // CA-13
    let chi2 = freedom.and_then(|nu| ChiSquared::new(nu).ok());
    let chi2_probability = chi2.map(|chi2| chi2.sf(fit.cost)); // CA-14
    let dead = dead(fit, parameters);
    let directions = directions(&fit.jacobian, &relative_scales(fit, parameters).0);
    Uncertainty {
        covariance,
        standard_error,
        correlation,
        prior_share,
        reduced_chi2,
        degrees_of_freedom,
        chi2_probability,
        directions,
        at_bound,
        dead,
    }
}

fn bound_of(p: &Parameter, x: f64) -> Option<Bound> {
    if x - p.low <= ON_BOUND * p.range() {
        Some(Bound::Low)
    } else if p.high - x <= ON_BOUND * p.range() {
        Some(Bound::High)
    } else {
        None
    }
}

/// Columns of the data in other units; zeros where there is no derivative.
pub(super) fn scaled(jacobian: &DMatrix<f64>, columns: &[usize], scales: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(jacobian.nrows(), columns.len(), |row, i| {
        let slope = jacobian[(row, columns[i])] * scales[columns[i]];
        if slope.is_finite() { slope } else { 0.0 }
    })
}

/// Singular values, descending, and V'; as many as columns.
pub(super) fn singular(rows: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let n = rows.ncols();
    if n == 0 {
        return (DVector::zeros(0), DMatrix::zeros(0, 0));
    }
    let padded = rows.clone().resize_vertically(rows.nrows().max(n), 0.0);
    let svd = padded.qr().r().svd(false, true);
    let v_t = svd.v_t.unwrap_or_else(|| DMatrix::identity(n, n));
    (svd.singular_values, v_t)
}

/// Covariance of the parameters that are not held, and the number of known directions (CA-10, CA-11).
fn free_covariance(fit: &Fit, parameters: &[Parameter], free: &[usize]) -> (DMatrix<f64>, usize) {
    let n = free.len();
    let ranges: Vec<f64> = parameters.iter().map(Parameter::range).collect();
    let data = scaled(&fit.jacobian, free, &ranges);
    let of_prior = |&k: &usize| {
        parameters[k]
            .prior
            .map_or(0.0, |prior| ranges[k] / prior.sd)
    };
    let priors = DVector::from_iterator(n, free.iter().map(of_prior));
    let mut both = data.clone().resize_vertically(data.nrows() + n, 0.0);
    both.rows_mut(data.nrows(), n)
        .copy_from(&DMatrix::from_diagonal(&priors));
    let largest = singular(&data).0.iter().copied().fold(0.0, f64::max);
    let (values, v_t) = singular(&both);
    let unknown = |i: usize| {
        let v = v_t.row(i).transpose();
        let (by_data, by_priors) = ((&data * &v).norm(), priors.component_mul(&v).norm());
        values[i] <= UNKNOWN || (by_data <= NOISE * largest && by_priors <= UNKNOWN) // CA-11
    };
    let (unknown, known): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| unknown(i));
    let part = |k: usize| {
        unknown
            .iter()
            .map(|&i| v_t[(i, k)].powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let lost: Vec<bool> = (0..n).map(|k| part(k) > INVOLVED).collect(); // CA-11
    let entry = |k: usize, l: usize| {
        let of = |&i: &usize| v_t[(i, k)] * v_t[(i, l)] / values[i].powi(2);
        match lost[k] || lost[l] {
            true => f64::NAN,
            false => known.iter().map(of).sum::<f64>() * ranges[free[k]] * ranges[free[l]], // CA-10
        }
    };
    (DMatrix::from_fn(n, n, entry), known.len())
}

/// Parameters that move no residual; one without a derivative is not among them.
pub(super) fn dead(fit: &Fit, parameters: &[Parameter]) -> Vec<usize> {
    let pairs = parameters.iter().zip(fit.jacobian.column_iter());
    let moved: Vec<f64> = pairs.map(|(p, column)| column.norm() * p.range()).collect();
    let most = moved.iter().copied().fold(0.0, f64::max);
    (0..moved.len())
        .filter(|&k| moved[k] <= NOISE * most)
        .collect()
}

/// Scale of each parameter's changes, and whether it is the value (CA-16).
pub(super) fn relative_scales(fit: &Fit, parameters: &[Parameter]) -> (Vec<f64>, Vec<bool>) {
    let is_zero = |x: f64| x.abs() <= f64::MIN_POSITIVE;
    let scale = |(p, x): (&Parameter, &f64)| {
        if is_zero(p.start) || is_zero(*x) {
            (p.range(), false)
        } else {
            (*x, true)
        }
    }; // CA-16
    parameters.iter().zip(&fit.values).map(scale).unzip()
}

fn directions(jacobian: &DMatrix<f64>, scales: &[f64]) -> Vec<Direction> {
    let all: Vec<usize> = (0..scales.len()).collect();
    let (values, v_t) = singular(&scaled(jacobian, &all, scales));
    let weights = v_t.row_iter().map(|v| v.iter().copied().collect());
    let pairs = values.iter().copied().zip(weights);
    pairs
        .map(|(singular_value, weights)| Direction {
            singular_value,
            weights,
        })
        .collect()
}
