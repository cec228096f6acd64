//! A grid of two factors as the matrix that it is.

use serde::Serialize;

use super::Column;
use super::levels::{label, values};
use crate::plan::{Design, Plan};
use cvtcycle_config::Problem;

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
    /// Cells that each minimum is taken over.
    pub least_of: MinimumOver,
    /// Row and column of the smallest numbers.
    pub least: Vec<[usize; 2]>,
}

/// Cells that a minimum is taken over. A condition such as the ambient temperature is not chosen, so each of its levels has a minimum
/// over the other factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MinimumOver {
    /// All cells.
    All,
    /// A row.
    Row,
    /// A column.
    Column,
}

/// Factors that are conditions.
const CONDITIONS: [&str; 3] = ["ambient_degc", "start", "cycle"];

impl GridMatrix {
    /// The matrix of a plan with two factors from the numbers of its points; none for another plan.
    pub(super) fn from_points(plan: &Plan, numbers: &Column) -> Result<Option<Self>, Problem> {
        let [first, second] = plan.factors.as_slice() else {
            return Ok(None);
        };
        if plan.design != Design::Grid {
            return Ok(None);
        }
        let numbers = numbers.all()?;
        let names = |factor: usize, unit: &str| -> Vec<String> {
            let all = values(plan, factor, numbers.len());
            all.map(|value| value.map_or_else(String::new, |value| label(&value, unit)))
                .collect()
        };
        let (rows, columns) = (names(0, &first.unit), names(1, &second.unit));
        let factors = [first.name.clone(), second.name.clone()];
        let condition = |key: &str| CONDITIONS.contains(&key);
        let least_of = match (condition(&first.key), condition(&second.key)) {
            (true, false) => MinimumOver::Row,
            (false, true) => MinimumOver::Column,
            _ => MinimumOver::All,
        };
        let matrix = folded(factors, &rows, columns, &numbers);
        Ok(Some(matrix.with_least(least_of)))
    }

    /// Finds the smallest numbers.
    fn with_least(mut self, least_of: MinimumOver) -> Self {
        let (high, wide) = (self.rows.len(), self.columns.len());
        let all = (0..high).flat_map(|i| (0..wide).map(move |k| [i, k]));
        let groups = match least_of {
            MinimumOver::All => 1,
            MinimumOver::Row => high,
            MinimumOver::Column => wide,
        };
        let number = |[i, k]: [usize; 2]| self.cells.get(i).and_then(|row| *row.get(k)?);
        let least = |group: usize| {
            let of_group = |place: &[usize; 2]| match least_of {
                MinimumOver::All => true,
                MinimumOver::Row => place[0] == group,
                MinimumOver::Column => place[1] == group,
            };
            let own = all.clone().filter(of_group);
            let known = own.filter_map(|place| Some((place, number(place)?)));
            let least = known.min_by(|a, b| a.1.total_cmp(&b.1));
            least.map(|(place, _)| place)
        };
        (self.least_of, self.least) = (least_of, (0..groups).filter_map(least).collect());
        self
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
        least_of: MinimumOver::All,
        least: Vec::new(),
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
        let least = |of| matrix.clone().with_least(of).least;
        assert_eq!(least(MinimumOver::All), [[1, 0]]);
        assert_eq!(least(MinimumOver::Row), [[0, 0], [1, 0]]);
        // A cell without a number is never the smallest.
        assert_eq!(least(MinimumOver::Column), [[1, 0], [0, 1], [0, 2]]);
    }
}
