//! A grid of two factors as the matrix that it is, where further factors may span what is known of a friction.
//!
//! | label | statement | status |
//! |---|---|---|
//! | GF-1 | ends of a cell: y - sqrt(sum min(0, d_j)2), y + sqrt(sum max(0, d_j)2), y with every place at its middle, d_j the least and the largest difference with the place of friction j alone at its ends | derived: independent spreads of two standard deviations, to first order |
//! | GF-2 | A less B: y_A - y_B, from below by sqrt(below_A2 + above_B2), from above by sqrt(above_A2 + below_B2), above and below the distances of GF-1 | derived: what is not known of one fluid says nothing about the other; the runs of both are of the same car and cycle |

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
    /// Least and largest number of each cell over what is known of the frictions that further factors move (GF-1); empty without such factors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ends: Vec<Vec<Option<[f64; 2]>>>,
    /// Differences between the choices of each condition; empty where a minimum is taken over all cells.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<ChoicePair>,
}

/// Two choices, and what the first has less the second.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChoicePair {
    /// The first choice and the second.
    pub choices: [String; 2],
    /// Difference in each condition; none where a run gave no number.
    pub differences: Vec<Option<f64>>,
    /// Ends of the difference over the spreads of the frictions (GF-2); none without such factors.
    pub ends: Vec<Option<[f64; 2]>>,
}

/// True of a key that says where a friction is in its spread (FR-6).
fn is_place(key: &str) -> bool {
    key.contains("lubricant.friction.") && key.ends_with(".place")
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
        let [first, second, places @ ..] = plan.factors.as_slice() else {
            return Ok(None);
        };
        if plan.design != Design::Grid || !places.iter().all(|factor| is_place(&factor.key)) {
            return Ok(None);
        }
        let places: Vec<Vec<f64>> = places
            .iter()
            .map(|factor| {
                let list = factor.values.list().iter();
                list.filter_map(|value| value.number()).collect()
            })
            .collect();
        let all = numbers.all()?;
        let (numbers, ends) = middles(&all, &places);
        let names = |factor: usize, unit: &str| -> Vec<String> {
            let of_cell = all.len() / numbers.len().max(1);
            let points = values(plan, factor, all.len()).step_by(of_cell.max(1));
            points
                .map(|value| value.map_or_else(String::new, |value| label(&value, unit)))
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
        let mut matrix = folded(factors, &rows, columns, &numbers);
        if !places.is_empty() {
            let width = matrix.columns.len().max(1);
            matrix.ends = ends.chunks(width).map(<[_]>::to_vec).collect();
        }
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
        self.pairs = self.differences();
        self
    }

    /// Conditions and choices of a matrix whose minimum is taken for each condition.
    #[must_use]
    pub fn conditions(&self) -> Option<[&[String]; 2]> {
        match self.least_of {
            MinimumOver::All => None,
            MinimumOver::Row => Some([&self.rows, &self.columns]),
            MinimumOver::Column => Some([&self.columns, &self.rows]),
        }
    }

    /// Each choice less each later one, in each condition.
    fn differences(&self) -> Vec<ChoicePair> {
        let Some([conditions, choices]) = self.conditions() else {
            return Vec::new();
        };
        let place = |condition: usize, choice: usize| match self.least_of {
            MinimumOver::Column => [choice, condition],
            _ => [condition, choice],
        };
        // A number with its distances to the ends below and above.
        let known = |[i, k]: [usize; 2]| {
            let y = (*self.cells.get(i)?.get(k)?)?;
            let ends = self.ends.get(i).and_then(|row| *row.get(k)?);
            Some((y, ends.map(|[low, high]| [y - low, high - y])))
        };
        let pair = |(a, b): (usize, usize)| {
            let of = |at: usize| {
                let (first, second) = (known(place(at, a))?, known(place(at, b))?);
                let difference = first.0 - second.0;
                let ends = first.1.zip(second.1).map(|(own, other)| {
                    [
                        difference - own[0].hypot(other[1]),
                        difference + own[1].hypot(other[0]),
                    ] // GF-2
                });
                Some((difference, ends))
            };
            let all: Vec<_> = (0..conditions.len()).map(of).collect();
            ChoicePair {
                choices: [a, b].map(|choice| choices[choice].clone()),
                differences: all.iter().map(|own| Some(own.as_ref()?.0)).collect(),
                ends: all.iter().map(|own| own.as_ref()?.1).collect(),
            }
        };
        let pairs = (0..choices.len()).flat_map(|a| (a + 1..choices.len()).map(move |b| (a, b)));
        pairs.map(pair).collect()
    }
}

/// The number of each cell with every place in its middle, and its ends (GF-1), from the numbers of all points, the places fastest.
fn middles(numbers: &[f64], places: &[Vec<f64>]) -> (Vec<f64>, Vec<Option<[f64; 2]>>) {
    let of_cell: usize = places.iter().map(Vec::len).product();
    let nearest = |levels: &Vec<f64>| {
        let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
        let least = levels.iter().enumerate().min_by(by_size);
        least.map_or(0, |(k, _)| k)
    };
    let middle: Vec<usize> = places.iter().map(nearest).collect();
    // Index of a point within its cell, the last place fastest.
    let index = |at: &[usize]| {
        let levels = at.iter().zip(places);
        levels.fold(0, |index, (level, of)| index * of.len() + level)
    };
    let square = |x: f64| x * x;
    let cell = |own: &[f64]| {
        let y = own[index(&middle)];
        let mut sums = [0.0; 2];
        for (f, of) in places.iter().enumerate() {
            let mut widest = [0.0_f64; 2];
            for level in 0..of.len() {
                let mut at = middle.clone();
                at[f] = level;
                let d = own[index(&at)] - y;
                widest = [widest[0].min(d), widest[1].max(d)];
                if d.is_nan() {
                    return (y, None);
                }
            }
            sums = [sums[0] + square(widest[0]), sums[1] + square(widest[1])];
        }
        let [below, above] = sums.map(f64::sqrt);
        (y, y.is_finite().then_some([y - below, y + above])) // GF-1
    };
    numbers.chunks_exact(of_cell.max(1)).map(cell).unzip()
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
        ends: Vec::new(),
        pairs: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: two frictions whose places move a cell by -3, +4 and by -4, +3 about 10: 10 - 5 and 10 + 5. What moves nothing is no range.
    #[test]
    fn frictions_widen_a_cell_by_the_root_of_their_squares() {
        let places = vec![vec![-1.0, 0.0, 1.0], vec![-1.0, 0.0, 1.0]];
        let at = |a: f64, b: f64| 10.0 + a + b;
        let moved = |down: f64, up: f64| [down, 0.0, up];
        let (a, b) = (moved(-3.0, 4.0), moved(-4.0, 3.0));
        let mut numbers: Vec<f64> = Vec::new();
        for a in a {
            numbers.extend(b.iter().map(|b| at(a, *b)));
        }
        numbers.extend([7.0; 9]);
        let (cells, ends) = middles(&numbers, &places);
        assert_eq!(cells, [10.0, 7.0]);
        assert_eq!(ends, [Some([5.0, 15.0]), Some([7.0, 7.0])]);
        assert_eq!(middles(&[1.0, 2.0], &[]).0, [1.0, 2.0]);
    }

    /// By hand: 10 from 7 to 14 less 6 from 2 to 9 is 4, from below by the root of 9 + 9, from above by that of 16 + 16. A choice that is certain adds
    /// nothing.
    #[test]
    fn choices_are_compared_in_each_condition() {
        let names = |list: &[&str]| list.iter().map(|x| (*x).to_owned()).collect::<Vec<_>>();
        let mut matrix = GridMatrix {
            factors: ["ambient".to_owned(), "oil".to_owned()],
            rows: names(&["-10 degC", "25 degC"]),
            columns: names(&["a", "b", "c"]),
            cells: vec![
                vec![Some(10.0), Some(6.0), Some(5.0)],
                vec![Some(1.0), None, Some(3.0)],
            ],
            least_of: MinimumOver::All,
            least: Vec::new(),
            ends: vec![
                vec![Some([7.0, 14.0]), Some([2.0, 9.0]), Some([5.0, 5.0])],
                vec![Some([1.0, 1.0]), None, Some([2.0, 3.5])],
            ],
            pairs: Vec::new(),
        };
        assert_eq!(matrix.clone().with_least(MinimumOver::All).pairs, []);
        matrix = matrix.with_least(MinimumOver::Row);
        let named = |pair: &ChoicePair| pair.choices.join(" less ");
        let all: Vec<String> = matrix.pairs.iter().map(named).collect();
        assert_eq!(all, ["a less b", "a less c", "b less c"]);
        let of = |pair: usize| (&matrix.pairs[pair].differences, &matrix.pairs[pair].ends);
        let root = |x: f64| x.sqrt();
        let ends = [4.0 - root(18.0), 4.0 + root(32.0)];
        assert_eq!(of(0).0, &[Some(4.0), None]);
        assert!((of(0).1[0].unwrap()[0] - ends[0]).abs() < 1e-12);
        assert!((of(0).1[0].unwrap()[1] - ends[1]).abs() < 1e-12);
        assert_eq!(of(1).0, &[Some(5.0), Some(-2.0)]);
        assert_eq!(of(1).1, &[Some([2.0, 9.0]), Some([-2.5, -1.0])]);
        assert_eq!(of(2).0, &[Some(1.0), None]);
    }

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
