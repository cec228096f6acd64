//! Derivatives of the residuals by differences, columns in parallel.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-5 | dr/dx = ((r1 - r0) d2 / d1 - (r2 - r0) d1 / d2) / (d2 - d1), r1 and r2 at x + d1, x + d2; offsets -h, h; where a bound or a failure is in the way h, 2 h or -h, -2 h; then the same with h / 10 | derived: slope of the parabola through three points |
//! | CA-6 | h = 1e-3 S, S the least of high - low, 4 sd of the prior and, where the bounds have one sign, max(\|x\|, (high - low) / 100) | ASSUMED: with noise of 1e-9 of the residuals' scale, (3e-9)^(1/3) is best for central differences |
//!
//! With that noise the error of a column is about 1e-6 of what S moves. A mild kink inside h gives a slope between those of its sides.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::objective::{EvalError, Objective, Point};
use super::types::Parameter;

/// Step as a share of the scale (CA-6).
const STEP: f64 = 1e-3;
/// Standard deviations of a prior that make a scale (CA-6).
const PRIOR_WIDTH: f64 = 4.0;
/// Least scale as a share of the range, where x is near a bound of 0 (CA-6).
const MIN_SHARE: f64 = 0.01;

/// Step of a parameter at a value (CA-6).
fn step(parameter: &Parameter, x: f64) -> f64 {
    let range = parameter.range();
    let one_sign = parameter.low >= 0.0 || parameter.high <= 0.0;
    let size = match one_sign {
        true => x.abs().max(MIN_SHARE * range),
        false => range,
    };
    let prior = parameter
        .prior
        .map_or(range, |prior| PRIOR_WIDTH * prior.sd);
    STEP * range.min(size).min(prior) // CA-6
}

/// Column of parameter `k` from the residuals at two other values of it.
fn difference(
    objective: &Objective,
    point: &Point,
    k: usize,
    ends: [f64; 2],
) -> Result<Vec<f64>, EvalError> {
    let moved = |to: f64| {
        let mut values = point.values.clone();
        values[k] = to;
        objective.residuals(&values)
    };
    let (first, second) = (moved(ends[0])?, moved(ends[1])?);
    let [d1, d2] = ends.map(|to| to - point.values[k]);
    let slope = |((r0, r1), r2): ((&f64, &f64), &f64)| {
        ((r1 - r0) * d2 / d1 - (r2 - r0) * d1 / d2) / (d2 - d1)
    }; // CA-5
    let rows = point.residuals.iter().zip(&first).zip(&second);
    Ok(rows.map(slope).collect())
}

/// Column of parameter `k`.
fn column(objective: &Objective, point: &Point, k: usize) -> Result<Vec<f64>, EvalError> {
    let (parameter, x) = (&objective.parameters[k], point.values[k]);
    let mut error = EvalError::Model("no room between the bounds for a derivative".into());
    let h = step(parameter, x);
    for h in [h, 0.1 * h] {
        for offsets in [[-h, h], [h, 2.0 * h], [-h, -2.0 * h]] {
            let ends = offsets.map(|d| x + d);
            let inside = |to: &f64| parameter.low <= *to && *to <= parameter.high;
            if !ends.iter().all(inside) {
                continue;
            }
            match difference(objective, point, k, ends) {
                Err(EvalError::Model(why)) => error = EvalError::Model(why),
                done => return done,
            }
        }
    }
    Err(error)
}

/// All columns, in the parameters' own units. Each is computed by itself, so that the number of threads does not matter.
fn columns(objective: &Objective, point: &Point) -> Vec<Result<Vec<f64>, EvalError>> {
    let all = (0..objective.parameters.len()).into_par_iter();
    all.map(|k| column(objective, point, k)).collect()
}

fn matrix(rows: usize, columns: Vec<Vec<f64>>) -> DMatrix<f64> {
    DMatrix::from_iterator(rows, columns.len(), columns.into_iter().flatten())
}

/// Change of each residual of the data (row) with each parameter (column).
pub(super) fn jacobian(objective: &Objective, point: &Point) -> Result<DMatrix<f64>, EvalError> {
    let columns = columns(objective, point)
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    Ok(matrix(point.residuals.len(), columns))
}

/// The same with NaN in columns without a result.
pub(super) fn jacobian_with_gaps(objective: &Objective, point: &Point) -> DMatrix<f64> {
    let rows = point.residuals.len();
    let filled = |column: Result<Vec<f64>, _>| column.unwrap_or_else(|_| vec![f64::NAN; rows]);
    let columns = columns(objective, point).into_iter().map(filled).collect();
    matrix(rows, columns)
}
