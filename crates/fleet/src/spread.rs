//! Uncertainty of the fuel of a car outside the fleet, from the errors of the cars in it.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FS-1 | c mean of ln(F_measured/F_computed) over the cars; s2 mean square of that number less the mean of the cars of the other groups | definition: each group is judged by the others |
//! | FS-2 | 90 % of new cars: F_computed exp(c +- t s), t Student's 95 % point with one degree of freedom less than there are groups | ASSUMED: cars of a group share their error, groups are independent and normal |
//! | FS-3 | pairs: as FS-1 and FS-2 with the measured less the computed difference, points, in place of the logarithm; twins: the same with the difference to the twin of the CVT car in place of the pair's manual one | as FS-1, FS-2 |

use cvtcycle_output::fleet_spread;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::errors::{Entry, Pair, box_word};

/// Fewest cars and groups that tell of others.
const FEWEST: (usize, usize) = (8, 3);

/// Spread of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// Column of the figure.
    pub figure: String,
    /// `cvt`, `manual`, `pair` or `twin`.
    pub kind: &'static str,
    /// Number of cars or pairs.
    pub cars: usize,
    /// Number of groups.
    pub groups: usize,
    /// Middle of the measured over the computed value, per cent; of pairs measured less computed, points.
    pub middle: f64,
    /// Ends of the range that holds 90 % of cars.
    pub ends: [f64; 2],
}

/// Range of a figure of a car as factors on it, from the fleet that the program carries.
#[must_use]
pub fn known((car, driven): Entry, figure: &str) -> Option<[f64; 2]> {
    let fuel = driven.fuel(figure)?;
    let range = fleet_spread::figure_range(box_word(car), figure, fuel)?;
    Some(range.ends.map(|end| end / fuel))
}

/// Spreads of all figures, by box and of pairs, with the groups of a column.
#[must_use]
pub fn spreads(cars: &[Entry], pairs: &[Pair], figures: &[String], column: &str) -> Vec<Spread> {
    let group = |entry: &Entry| entry.0.words.get(column).cloned().unwrap_or_default();
    let mut all = Vec::new();
    for figure in figures {
        for kind in ["cvt", "manual"] {
            let own = cars.iter().filter(|entry| box_word(entry.0) == kind);
            let ratio = |entry: &Entry| {
                entry
                    .0
                    .measured
                    .get(figure)
                    .zip(entry.1.fuel(figure))
                    .map(|(measured, computed)| (measured / computed).ln())
            };
            let numbers: Vec<(String, f64)> = own
                .filter_map(|entry| Some((group(entry), ratio(entry).filter(|x| x.is_finite())?)))
                .collect();
            let percent = |x: f64| 100.0 * x.exp_m1();
            all.extend(spread(&numbers).map(|(groups, middle, ends)| Spread {
                figure: figure.clone(),
                kind,
                cars: numbers.len(),
                groups,
                middle: percent(middle),
                ends: ends.map(percent),
            }));
        }
        let of_pair = |pair: &&Pair| pair.figure == *figure && pair.error().is_finite();
        let word = |pair: &Pair| {
            cars.iter()
                .find(|entry| entry.0.id == pair.car)
                .map(group)
                .unwrap_or_default()
        };
        for kind in ["pair", "twin"] {
            let error = |pair: &Pair| match kind {
                "pair" => pair.error(),
                _ => pair.twin_error(),
            };
            let own = pairs.iter().filter(of_pair);
            let numbers: Vec<(String, f64)> = own
                .map(|pair| (word(pair), -error(pair)))
                .filter(|(_, x)| x.is_finite())
                .collect();
            all.extend(spread(&numbers).map(|(groups, middle, ends)| Spread {
                figure: figure.clone(),
                kind,
                cars: numbers.len(),
                groups,
                middle,
                ends,
            }));
        }
    }
    all
}

/// Number of groups, mean, and ends of FS-2.
fn spread(numbers: &[(String, f64)]) -> Option<(usize, f64, [f64; 2])> {
    let mut groups: Vec<&str> = numbers.iter().map(|(group, _)| group.as_str()).collect();
    groups.sort_unstable();
    groups.dedup();
    if numbers.len() < FEWEST.0 || groups.len() < FEWEST.1 {
        return None;
    }
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let all: Vec<f64> = numbers.iter().map(|(_, x)| *x).collect();
    let residuals = numbers.iter().map(|(group, x)| {
        let others: Vec<f64> = numbers
            .iter()
            .filter(|(other, _)| other != group)
            .map(|(_, x)| *x)
            .collect();
        x - mean(&others)
    });
    let squares: Vec<f64> = residuals.map(|r| r * r).collect();
    let s = mean(&squares).sqrt(); // FS-1
    let t = StudentsT::new(0.0, 1.0, groups.len() as f64 - 1.0)
        .ok()?
        .inverse_cdf(0.95);
    let middle = mean(&all);
    Some((groups.len(), middle, [middle - t * s, middle + t * s])) // FS-2
}

/// The file of the spreads.
#[must_use]
pub fn csv(spreads: &[Spread]) -> String {
    let mut text = "figure,kind,cars,groups,middle,low,high\n".to_owned();
    for own in spreads {
        let Spread {
            figure,
            kind,
            cars,
            groups,
            middle,
            ends,
        } = own;
        text += &format!(
            "{figure},{kind},{cars},{groups},{middle:.2},{:.2},{:.2}\n",
            ends[0], ends[1]
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: three groups of three numbers 0, 1, 2 each; the others' mean is 1, the mean square 2/3, t with two degrees of freedom 2.920.
    #[test]
    fn val_spread_by_hand() {
        let numbers: Vec<(String, f64)> = ["a", "b", "c"]
            .iter()
            .flat_map(|group| [0.0, 1.0, 2.0].map(|x| ((*group).to_owned(), x)))
            .collect();
        let (groups, middle, ends) = spread(&numbers).unwrap_or((0, 0.0, [0.0; 2]));
        assert_eq!(groups, 3);
        assert!((middle - 1.0).abs() < 1e-12);
        let half = 2.919_986 * (2.0_f64 / 3.0).sqrt();
        assert!(
            (ends[1] - 1.0 - half).abs() < 1e-4 && (1.0 - ends[0] - half).abs() < 1e-4,
            "{ends:?}"
        );
        assert_eq!(spread(&numbers[..6]), None, "two groups");
    }
}
