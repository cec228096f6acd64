//! A grid of two factors as the matrix that it is.

use serde::Serialize;

use super::{label, values};
use crate::plan::{Design, Plan};

/// An output at every pair of levels of two factors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridMatrix {
    /// Names of the factors: that of the rows, that of the columns.
    pub factors: [String; 2],
    /// Levels of the first factor, with units.
    pub rows: Vec<String>,
    /// Levels of the second factor, with units.
    pub columns: Vec<String>,
    /// Numbers by row and column; none of a run that gave none.
    pub cells: Vec<Vec<Option<f64>>>,
}

impl GridMatrix {
    /// The matrix of a plan with two factors from the numbers of its points; none for another plan.
    pub(super) fn of(plan: &Plan, numbers: &[f64]) -> Option<Self> {
        let [first, second] = plan.factors.as_slice() else {
            return None;
        };
        if plan.design != Design::Grid {
            return None;
        }
        let names = |factor: usize, unit: &str| -> Vec<String> {
            let all = values(plan, factor, numbers.len());
            all.map(|value| value.map_or_else(String::new, |value| label(&value, unit)))
                .collect()
        };
        let (rows, columns) = (names(0, &first.unit), names(1, &second.unit));
        let factors = [first.name.clone(), second.name.clone()];
        Some(folded(factors, &rows, columns, numbers))
    }

    /// Place of the smallest number, row and column.
    pub fn least(&self) -> Option<(usize, usize)> {
        let rows = self.cells.iter().enumerate();
        let cells = rows.flat_map(|(i, row)| {
            let row = row.iter().enumerate();
            row.filter_map(move |(k, x)| Some(((i, k), (*x)?)))
        });
        let least = cells.min_by(|(_, a), (_, b)| a.total_cmp(b));
        least.map(|(place, _)| place)
    }
}

/// Levels and numbers point by point, the last factor fastest (DE-5), as a matrix.
fn folded(
    factors: [String; 2],
    rows: &[String],
    mut columns: Vec<String>,
    numbers: &[f64],
) -> GridMatrix {
    let width = rows
        .iter()
        .take_while(|row| **row == rows[0])
        .count()
        .max(1);
    columns.truncate(width);
    let cells = numbers.chunks(width);
    let cells = cells.map(|row| row.iter().map(|x| x.is_finite().then_some(*x)).collect());
    GridMatrix {
        factors,
        rows: rows.iter().step_by(width).cloned().collect(),
        columns,
        cells: cells.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_factor_runs_along_the_rows() {
        let words = |list: [&str; 6]| list.map(str::to_owned).to_vec();
        let rows = words(["6 cc", "6 cc", "6 cc", "7 cc", "7 cc", "7 cc"]);
        let columns = words(["1 mm", "2 mm", "3 mm", "1 mm", "2 mm", "3 mm"]);
        let numbers = [5.0, 6.0, 7.0, 4.5, f64::NAN, 8.0];
        let factors = ["pump".to_owned(), "offset".to_owned()];
        let matrix = folded(factors, &rows, columns, &numbers);
        assert_eq!(matrix.rows, ["6 cc", "7 cc"]);
        assert_eq!(matrix.columns, ["1 mm", "2 mm", "3 mm"]);
        assert_eq!(matrix.cells[0], [Some(5.0), Some(6.0), Some(7.0)]);
        assert_eq!(matrix.cells[1], [Some(4.5), None, Some(8.0)]);
        assert_eq!(matrix.least(), Some((1, 0)));
    }
}
