//! Fuel by a regression over a few numbers of a car: the least that the model has to beat.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FB-1 | F = b . x, b from least squares of (b . x)/F_measured - 1 over the cars of the other groups | definition: each group is predicted by the others |
//! | FB-2 | x = 1; 1, mass; 1, wheel work a km, displacement, engine speed over road speed in the highest ratio | construction |

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::errors::{Entry, ErrorStatistics, box_word};

/// A regression on a figure.
#[derive(Clone, Debug, Serialize)]
pub struct Baseline {
    /// Column of the figure.
    pub figure: String,
    /// Kind of box.
    pub transmission: String,
    /// Numbers that it knows of a car.
    pub knows: String,
    /// Number of constants.
    pub constants: usize,
    /// Errors of cars whose group was left out.
    #[serde(flatten)]
    pub errors: ErrorStatistics,
}

/// Names of the regressions and of their numbers (FB-2).
const KINDS: [&str; 3] = ["mean", "mass", "wheel work, displacement, N/V"];

fn numbers(kind: usize, entry: Entry, test: usize) -> Vec<f64> {
    let (car, driven) = entry;
    let facts = &car.facts;
    match kind {
        0 => vec![1.0],
        1 => vec![1.0, facts.mass_kg / 1e3],
        _ => vec![
            1.0,
            driven.tests[test].wheel_mj_km,
            facts.displacement_m3 * 1e3,
            facts.top_rad_m / 10.0,
        ],
    }
}

/// Regressions of all figures, with the groups of a column left out in turn; without it each car by itself.
#[must_use]
pub fn baselines(cars: &[Entry], column: Option<&str>) -> Vec<Baseline> {
    let mut all = Vec::new();
    let Some((_, first)) = cars.first() else {
        return all;
    };
    for index in 0..first.tests.len() {
        let mut figures: Vec<&String> = cars
            .iter()
            .flat_map(|(_, driven)| driven.tests[index].fuel.keys())
            .collect();
        figures.sort();
        figures.dedup();
        for figure in figures {
            for transmission in ["cvt", "manual"] {
                let known = |entry: &&Entry| {
                    box_word(entry.0) == transmission
                        && entry.0.measured.contains_key(figure)
                        && entry.1.tests[index].wheel_mj_km.is_finite()
                };
                let entries: Vec<Entry> = cars.iter().filter(known).copied().collect();
                for (kind, knows) in KINDS.iter().enumerate() {
                    let errors = left_out(&entries, figure, column, &|entry| {
                        numbers(kind, entry, index)
                    });
                    let errors: Vec<(&str, f64)> =
                        errors.iter().map(|(id, e)| (id.as_str(), *e)).collect();
                    let constants = entries
                        .first()
                        .map_or(0, |entry| numbers(kind, *entry, index).len());
                    all.extend(ErrorStatistics::new(&errors).map(|errors| Baseline {
                        figure: figure.clone(),
                        transmission: transmission.to_owned(),
                        knows: (*knows).to_owned(),
                        constants,
                        errors,
                    }));
                }
            }
        }
    }
    all
}

/// Errors of the cars of each group, predicted from those of the others, per cent; none of a group that the others cannot predict.
fn left_out(
    cars: &[Entry],
    figure: &str,
    column: Option<&str>,
    x: &dyn Fn(Entry) -> Vec<f64>,
) -> Vec<(String, f64)> {
    let group = |entry: &Entry| match column.and_then(|column| entry.0.words.get(column)) {
        Some(word) => word.clone(),
        None => entry.0.id.clone(),
    };
    // Numbers over measured fuel: their sum with the constants is 1 for an exact prediction.
    let row = |entry: &Entry| -> Vec<f64> {
        let measured = entry.0.measured[figure];
        x(*entry).iter().map(|x| x / measured).collect()
    };
    let mut groups: BTreeMap<String, Vec<(&Entry, Vec<f64>)>> = BTreeMap::new();
    for entry in cars {
        let own = groups.entry(group(entry)).or_default();
        own.push((entry, row(entry)));
    }
    let all = || groups.values().flatten();
    let Some(width) = all().next().map(|(_, row)| row.len()) else {
        return Vec::new();
    };
    let sums = NormalEquations::of(all().map(|(_, row)| row.as_slice()), width);
    let mut errors = Vec::new();
    for own in groups.values() {
        let left = NormalEquations::of(own.iter().map(|(_, row)| row.as_slice()), width);
        let Some(b) = sums.without(&left) else {
            continue;
        };
        for (entry, row) in own {
            let predicted: f64 = row.iter().zip(b.iter()).map(|(x, b)| x * b).sum();
            errors.push((entry.0.id.clone(), 100.0 * (predicted - 1.0)));
        }
    }
    errors
}

/// Share of the largest singular value of the sums below which numbers of cars cannot be separated.
const SAME: f64 = 1e-12;

/// Sums over cars from which the constants of FB-1 follow; they cost the same for each group that is left out, whatever the number of cars.
struct NormalEquations {
    cars: usize,
    products: DMatrix<f64>,
    sums: DVector<f64>,
}

impl NormalEquations {
    fn of<'r>(rows: impl Iterator<Item = &'r [f64]>, width: usize) -> Self {
        let mut found = NormalEquations {
            cars: 0,
            products: DMatrix::zeros(width, width),
            sums: DVector::zeros(width),
        };
        for row in rows {
            let row = DVector::from_column_slice(row);
            found.products += &row * row.transpose();
            found.sums += row;
            found.cars += 1;
        }
        found
    }

    /// Constants of FB-1 of the cars that are not in `left`; `None` with fewer cars than constants and two more.
    fn without(&self, left: &Self) -> Option<DVector<f64>> {
        let width = self.sums.len();
        if self.cars - left.cars < width + 2 {
            return None;
        }
        let decomposed = (&self.products - &left.products).svd(true, true);
        let least = SAME * decomposed.singular_values.max();
        decomposed.solve(&(&self.sums - &left.sums), least).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: cars whose fuel is 0.5 + 2 x exactly; the group that is left out has another law, which must not be seen.
    #[test]
    fn val_a_group_that_is_left_out_has_no_part() {
        let of = |xs: &[f64], b: [f64; 2]| -> Vec<[f64; 2]> {
            let row = |x: &f64| {
                let litres = b[0] + b[1] * x;
                [1.0 / litres, x / litres]
            };
            xs.iter().map(row).collect()
        };
        let own = of(&[0.8, 1.1, 1.3, 1.9], [0.5, 2.0]);
        let left = of(&[0.9, 1.7], [3.0, -0.4]);
        let sums = |rows: &[[f64; 2]]| NormalEquations::of(rows.iter().map(|r| &r[..]), 2);
        let all = sums(&[&own[..], &left[..]].concat());
        let b = all.without(&sums(&left)).expect("enough cars");
        assert!(
            (b[0] - 0.5).abs() < 1e-9 && (b[1] - 2.0).abs() < 1e-9,
            "{b}"
        );
        let few = [&left[..], &own[..1]].concat();
        assert!(
            all.without(&sums(&few)).is_none(),
            "three cars, two constants"
        );
    }
}
