//! Fuel by a regression over a few numbers of a car: the least that the model has to beat.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FB-1 | F = b . x, b from least squares of (b . x)/F_measured - 1 over the cars of the other groups | definition: each group is predicted by the others |
//! | FB-2 | x = 1; 1, mass; 1, wheel work a km, displacement, engine speed over road speed in the highest ratio | construction |

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
    let vehicle = car.params.vehicle();
    match kind {
        0 => vec![1.0],
        1 => vec![1.0, vehicle.road_load.base.mass_kg / 1e3],
        _ => vec![
            1.0,
            driven.tests[test].wheel_mj_km,
            vehicle.engine().displacement_m3 * 1e3,
            car.top_rad_m() / 10.0,
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
    let mut groups: Vec<String> = cars.iter().map(group).collect();
    groups.sort();
    groups.dedup();
    let mut errors = Vec::new();
    for left in &groups {
        let others: Vec<&Entry> = cars.iter().filter(|entry| group(entry) != *left).collect();
        let own = cars.iter().filter(|entry| group(entry) == *left);
        let Some(b) = fit(&others, figure, x) else {
            continue;
        };
        for entry in own {
            let predicted: f64 = x(*entry).iter().zip(b.iter()).map(|(x, b)| x * b).sum();
            let measured = entry.0.measured[figure];
            errors.push((entry.0.id.clone(), 100.0 * (predicted / measured - 1.0)));
        }
    }
    errors
}

/// Constants of FB-1; `None` with fewer cars than constants and two more, or where the numbers do not tell them apart.
fn fit(cars: &[&Entry], figure: &str, x: &dyn Fn(Entry) -> Vec<f64>) -> Option<DVector<f64>> {
    let rows: Vec<Vec<f64>> = cars
        .iter()
        .map(|entry| {
            x(**entry)
                .iter()
                .map(|x| x / entry.0.measured[figure])
                .collect()
        })
        .collect();
    let width = rows.first()?.len();
    if rows.len() < width + 2 {
        return None;
    }
    let a = DMatrix::from_fn(rows.len(), width, |i, k| rows[i][k]);
    let one = DVector::from_element(rows.len(), 1.0);
    a.svd(true, true).solve(&one, 1e-10).ok()
}
