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

use super::Parameter;
use super::ask::{Ask, Refusal};

/// Share of the scale that a step takes (CA-6).
const STEP: f64 = 1e-3;
/// Standard deviations of a prior that make a scale (CA-6).
const PRIOR_WIDTH: f64 = 4.0;
/// Least scale as a share of the range, where x is near a bound of 0 (CA-6).
const LEAST_SHARE: f64 = 0.01;

/// Step of a parameter at a value (CA-6).
fn step(parameter: &Parameter, x: f64) -> f64 {
    let range = parameter.range();
    let one_sign = parameter.low >= 0.0 || parameter.high <= 0.0;
    let size = if one_sign {
        x.abs().max(LEAST_SHARE * range)
    } else {
        range
    };
    let known = parameter
        .prior
        .map_or(range, |prior| PRIOR_WIDTH * prior.sd);
    STEP * range.min(size).min(known) // CA-6
}

/// One column, `None` where both offsets are not inside the bounds.
fn difference(
    ask: &Ask,
    (values, at): (&[f64], usize),
    rows: &[f64],
    ends: [f64; 2],
) -> Result<Vec<f64>, Refusal> {
    let moved = |to: f64| {
        let mut values = values.to_vec();
        values[at] = to;
        ask.at(&values)
    };
    let (first, second) = (moved(ends[0])?, moved(ends[1])?);
    let [d1, d2] = ends.map(|to| to - values[at]);
    let slope = |((r0, r1), r2): ((&f64, &f64), &f64)| {
        ((r1 - r0) * d2 / d1 - (r2 - r0) * d1 / d2) / (d2 - d1)
    }; // CA-5
    Ok(rows.iter().zip(&first).zip(&second).map(slope).collect())
}

fn column(
    ask: &Ask,
    parameter: &Parameter,
    values: (&[f64], usize),
    rows: &[f64],
) -> Result<Vec<f64>, Refusal> {
    let x = values.0[values.1];
    let mut refusal = Refusal::Model("no room between the bounds for a derivative".into());
    let h = step(parameter, x);
    for h in [h, 0.1 * h] {
        for offsets in [[-h, h], [h, 2.0 * h], [-h, -2.0 * h]] {
            let ends = offsets.map(|d| x + d);
            if !ends
                .iter()
                .all(|to| parameter.low <= *to && *to <= parameter.high)
            {
                continue;
            }
            match difference(ask, values, rows, ends) {
                Err(Refusal::Model(why)) => refusal = Refusal::Model(why),
                done => return done,
            }
        }
    }
    Err(refusal)
}

/// All columns at a point, per own unit; `rows` are the residuals there. In parallel, each by itself, so that the number of threads does
/// not matter.
pub(super) fn columns(
    ask: &Ask,
    parameters: &[Parameter],
    values: &[f64],
    rows: &[f64],
) -> Vec<Result<Vec<f64>, Refusal>> {
    parameters
        .par_iter()
        .enumerate()
        .map(|(at, parameter)| column(ask, parameter, (values, at), rows))
        .collect()
}

/// The matrix of columns of which all are there; otherwise what is in the way.
pub(super) fn matrix(
    columns: Vec<Result<Vec<f64>, Refusal>>,
    rows: usize,
) -> Result<DMatrix<f64>, Refusal> {
    let columns = columns.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(DMatrix::from_iterator(
        rows,
        columns.len(),
        columns.into_iter().flatten(),
    ))
}

/// The same with NaN where a column is missing.
pub(super) fn matrix_with_gaps(
    columns: Vec<Result<Vec<f64>, Refusal>>,
    rows: usize,
) -> DMatrix<f64> {
    let filled: Vec<Vec<f64>> = columns
        .into_iter()
        .map(|column| column.unwrap_or_else(|_| vec![f64::NAN; rows]))
        .collect();
    DMatrix::from_iterator(rows, filled.len(), filled.into_iter().flatten())
}
