//! Uncertainty of the fuel of a car outside the fleet, from the errors of the cars in it.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FS-1 | c mean of ln(F_measured/F_computed) over the cars; s2 mean square of that number less the mean of the cars of the other groups | definition: each group is judged by the others |
//! | FS-2 | 90 % of new cars: F_computed exp(c +- t s), t Student's 95 % point with one degree of freedom less than there are groups | ASSUMED: cars of a group share their error, groups are independent and normal |
//! | FS-3 | pairs: as FS-1 and FS-2 with the measured less the computed difference, points, in place of the logarithm; twins: the same with the difference to the twin of the CVT car in place of the pair's manual one | as FS-1, FS-2 |
//! | FS-7 | coverage: share of the cars that lie in the range which FS-1 and FS-2 give from the cars of all other groups | definition; 90 % if FS-2 is right |

use cvtcycle_output::fleet_spread;
use serde::Serialize;
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

/// Numbers of one figure of one kind with their groups: ln(measured/computed), or measured less computed points.
struct Numbers {
    figure: String,
    kind: &'static str,
    of_groups: Vec<(String, f64)>,
}

impl Numbers {
    /// True for differences of two cars, in points.
    fn is_difference(&self) -> bool {
        matches!(self.kind, "pair" | "twin")
    }
}

fn numbers(cars: &[Entry], pairs: &[Pair], figures: &[String], column: &str) -> Vec<Numbers> {
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
            let of_groups = own
                .filter_map(|entry| Some((group(entry), ratio(entry).filter(|x| x.is_finite())?)));
            all.push(Numbers {
                figure: figure.clone(),
                kind,
                of_groups: of_groups.collect(),
            });
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
            let of_groups = own
                .map(|pair| (word(pair), -error(pair)))
                .filter(|(_, x)| x.is_finite());
            all.push(Numbers {
                figure: figure.clone(),
                kind,
                of_groups: of_groups.collect(),
            });
        }
    }
    all
}

/// Spreads of all figures, by box and of pairs, with the groups of a column.
#[must_use]
pub fn spreads(cars: &[Entry], pairs: &[Pair], figures: &[String], column: &str) -> Vec<Spread> {
    let own = |numbers: &Numbers| {
        let (groups, middle, ends) = spread(&numbers.of_groups)?;
        let percent = |x: f64| match numbers.is_difference() {
            true => x,
            false => 100.0 * x.exp_m1(),
        };
        Some(Spread {
            figure: numbers.figure.clone(),
            kind: numbers.kind,
            cars: numbers.of_groups.len(),
            groups,
            middle: percent(middle),
            ends: ends.map(percent),
        })
    };
    let all = numbers(cars, pairs, figures, column);
    all.iter().filter_map(own).collect()
}

/// Cars of a figure that lie in the range which the cars of other groups give (FS-7).
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Coverage {
    /// Column of the figure.
    pub figure: String,
    /// `cvt`, `manual`, `pair` or `twin`.
    pub kind: &'static str,
    /// Cars or pairs that were judged: those of groups of which the others are enough for a range.
    pub judged: usize,
    /// Number of them in the range.
    pub held: usize,
}

/// Coverage of the ranges of all figures; none for a figure of which no group can be judged.
#[must_use]
pub fn coverages(
    cars: &[Entry],
    pairs: &[Pair],
    figures: &[String],
    column: &str,
) -> Vec<Coverage> {
    let own = |numbers: &Numbers| {
        let (judged, held) = coverage(&numbers.of_groups);
        (judged > 0).then(|| Coverage {
            figure: numbers.figure.clone(),
            kind: numbers.kind,
            judged,
            held,
        })
    };
    let all = numbers(cars, pairs, figures, column);
    all.iter().filter_map(own).collect()
}

/// Numbers judged by the range of the other groups, and those that it holds (FS-7).
fn coverage(numbers: &[(String, f64)]) -> (usize, usize) {
    let mut groups: Vec<&str> = numbers.iter().map(|(group, _)| group.as_str()).collect();
    groups.sort_unstable();
    groups.dedup();
    let (mut judged, mut held) = (0, 0);
    for group in groups {
        let (own, others): (Vec<_>, Vec<_>) = numbers
            .iter()
            .cloned()
            .partition(|(other, _)| other == group);
        if let Some((_, _, [low, high])) = spread(&others) {
            judged += own.len();
            held += own.iter().filter(|(_, x)| (low..=high).contains(x)).count();
        }
    }
    (judged, held)
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

    /// By hand: four groups of three numbers 0, 1, 2; the other three give 1 +- 2.384. A number of 4 in a fifth group of one lies outside of
    /// the range of the four (1 +- t 0.816, t = 2.353 with three degrees of freedom: up to 2.92), and widens those of the others.
    #[test]
    fn val_coverage_by_hand() {
        let mut numbers: Vec<(String, f64)> = ["a", "b", "c", "d"]
            .iter()
            .flat_map(|group| [0.0, 1.0, 2.0].map(|x| ((*group).to_owned(), x)))
            .collect();
        assert_eq!(coverage(&numbers), (12, 12));
        numbers.push(("e".to_owned(), 4.0));
        assert_eq!(coverage(&numbers), (13, 12));
        assert_eq!(coverage(&numbers[..9]), (0, 0), "two groups are left");
    }
}
