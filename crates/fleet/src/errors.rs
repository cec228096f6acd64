//! Computed against measured fuel.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FE-1 | e = 100 (F_computed/F_measured - 1) | definition |
//! | FE-2 | pair: d = 100 (F/F_other - 1), error d_computed - d_measured | definition |
//! | FE-3 | change by settings: errors of the same cars before and after, those that were driven and measured in both | definition |

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{DrivenCar, FleetCar};

/// Error of a figure within which it is counted, per cent.
pub const WITHIN_PERCENT: f64 = 5.0;

/// Errors of a figure over some cars, per cent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorStatistics {
    /// Number of cars.
    pub n: usize,
    /// Mean.
    pub mean_percent: f64,
    /// Standard deviation about the mean; NaN of one car.
    pub sd_percent: f64,
    /// Root of the mean square.
    pub rms_percent: f64,
    /// Share of cars within 5 %, per cent.
    pub within_5_percent: f64,
    /// Largest error in size.
    pub worst_percent: f64,
    /// Name of its car.
    pub worst_car: String,
}

impl ErrorStatistics {
    /// Statistics of errors with the names of their cars; `None` without errors.
    #[must_use]
    pub fn new(errors: &[(&str, f64)]) -> Option<Self> {
        let n = errors.len();
        let worst = errors
            .iter()
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let mean = errors.iter().map(|(_, e)| e).sum::<f64>() / n as f64;
        let square = |e: f64| e * e;
        let spread: f64 = errors.iter().map(|(_, e)| square(e - mean)).sum();
        let rms = (errors.iter().map(|(_, e)| square(*e)).sum::<f64>() / n as f64).sqrt();
        let within = errors
            .iter()
            .filter(|(_, e)| e.abs() <= WITHIN_PERCENT)
            .count();
        Some(ErrorStatistics {
            n,
            mean_percent: mean,
            sd_percent: if n > 1 {
                (spread / (n as f64 - 1.0)).sqrt()
            } else {
                f64::NAN
            },
            rms_percent: rms,
            within_5_percent: 100.0 * within as f64 / n as f64,
            worst_percent: worst.1,
            worst_car: worst.0.to_owned(),
        })
    }
}

/// Errors of a figure over the cars that have one word in a column.
#[derive(Clone, Debug, Serialize)]
pub struct GroupErrors {
    /// Column of the figure.
    pub figure: String,
    /// Column of the word; `box` for cvt and manual, empty for all cars.
    pub column: String,
    /// The word.
    pub word: String,
    /// Statistics.
    #[serde(flatten)]
    pub errors: ErrorStatistics,
}

/// A pair of cars: the same car with another box.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    /// Column of the figure.
    pub figure: String,
    /// The car.
    pub car: String,
    /// The car that it is compared with.
    pub other: String,
    /// Measured difference, per cent; NaN without measured fuel of both.
    pub measured_percent: f64,
    /// Computed difference, per cent.
    pub computed_percent: f64,
    /// Computed difference to the twin that the program makes of the car (TW-1 to TW-4), in place of the measured one's own row; NaN of a car without one.
    pub twin_percent: f64,
}

impl Pair {
    /// As [`Pair::error`], with the twin in place of the other car.
    #[must_use]
    pub fn twin_error(&self) -> f64 {
        self.twin_percent - self.measured_percent
    }

    /// Computed less measured difference, points (FE-2).
    #[must_use]
    pub fn error(&self) -> f64 {
        self.computed_percent - self.measured_percent
    }
}

/// A car with its figures.
pub type Entry<'a> = (&'a FleetCar, &'a DrivenCar);

/// Computed over measured fuel of a figure, per cent (FE-1); `None` without both.
#[must_use]
pub fn error_percent((car, driven): Entry, figure: &str) -> Option<f64> {
    let error = 100.0 * (driven.fuel(figure)? / car.measured.get(figure)? - 1.0); // FE-1
    error.is_finite().then_some(error)
}

/// Word for the kind of a car's box.
#[must_use]
pub fn box_word(car: &FleetCar) -> &'static str {
    if car.facts.is_cvt { "cvt" } else { "manual" }
}

/// Errors with the names of their cars, by place of the column, its name and a word in it.
type ByWord<'a> = BTreeMap<(usize, &'a str, &'a str), Vec<(&'a str, f64)>>;

/// Errors of some figures: by box, and by each word of each grouping column.
#[must_use]
pub fn by_group(cars: &[Entry], figures: &[String], columns: &[String]) -> Vec<GroupErrors> {
    let mut all = Vec::new();
    for figure in figures {
        let mut groups = ByWord::new();
        for entry in cars {
            let Some(error) = error_percent(*entry, figure) else {
                continue;
            };
            let of_box = [(0, "box", box_word(entry.0))].into_iter();
            let of_columns = (1..).zip(columns).filter_map(|(k, column)| {
                Some((k, column.as_str(), entry.0.words.get(column)?.as_str()))
            });
            for key in of_box.chain(of_columns) {
                groups
                    .entry(key)
                    .or_default()
                    .push((entry.0.id.as_str(), error));
            }
        }
        for ((_, column, word), errors) in groups {
            let errors = ErrorStatistics::new(&errors);
            all.extend(errors.map(|errors| GroupErrors {
                figure: figure.clone(),
                column: column.to_owned(),
                word: word.to_owned(),
                errors,
            }));
        }
    }
    all
}

/// Errors of a figure before and after a change of the cars (FE-3).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorChange {
    /// Column of the figure.
    pub figure: String,
    /// Kind of box.
    pub transmission: String,
    /// Cars with an error, before and after.
    pub cars: [usize; 2],
    /// Cars with both.
    pub n: usize,
    /// Mean error of these, before and after, per cent.
    pub mean_percent: [f64; 2],
    /// Root of the mean square, before and after, per cent.
    pub rms_percent: [f64; 2],
    /// Mean change of the error of a car, points.
    pub mean_change: f64,
    /// Standard deviation of that change; NaN of one car.
    pub sd_change: f64,
    /// Cars whose error is smaller in size after.
    pub nearer: usize,
}

/// Errors of the same cars before and after, by figure and box.
#[must_use]
pub fn changes(before: &[Entry], after: &[Entry], figures: &[String]) -> Vec<ErrorChange> {
    let mut all = Vec::new();
    for figure in figures {
        for transmission in ["cvt", "manual"] {
            let errors = |entries: &[Entry]| -> BTreeMap<String, f64> {
                let own = entries
                    .iter()
                    .filter(|entry| box_word(entry.0) == transmission);
                own.filter_map(|entry| Some((entry.0.id.clone(), error_percent(*entry, figure)?)))
                    .collect()
            };
            let (first, second) = (errors(before), errors(after));
            let both: Vec<[f64; 2]> = first
                .iter()
                .filter_map(|(id, error)| Some([*error, *second.get(id)?]))
                .collect();
            if both.is_empty() {
                continue;
            }
            let n = both.len() as f64;
            let mean = |of: &dyn Fn(&[f64; 2]) -> f64| both.iter().map(of).sum::<f64>() / n;
            let mean_change = mean(&|pair| pair[1] - pair[0]);
            let square = mean(&|pair| (pair[1] - pair[0] - mean_change).powi(2));
            all.push(ErrorChange {
                figure: figure.clone(),
                transmission: transmission.to_owned(),
                cars: [first.len(), second.len()],
                n: both.len(),
                mean_percent: [0, 1].map(|k| mean(&|pair| pair[k])),
                rms_percent: [0, 1].map(|k| mean(&|pair| pair[k] * pair[k]).sqrt()),
                mean_change,
                sd_change: (square * n / (n - 1.0)).sqrt(),
                nearer: both
                    .iter()
                    .filter(|pair| pair[1].abs() < pair[0].abs())
                    .count(),
            });
        }
    }
    all
}

/// Pairs of cars by the names in their rows.
#[must_use]
pub fn pairs(cars: &[Entry], figures: &[String]) -> Vec<Pair> {
    let by_name: BTreeMap<&str, Entry> = cars
        .iter()
        .map(|entry| (entry.0.id.as_str(), *entry))
        .collect();
    let mut all = Vec::new();
    for figure in figures {
        for (car, driven) in cars.iter().filter(|(car, _)| !car.pair.is_empty()) {
            let Some((other, other_driven)) = by_name.get(car.pair.as_str()) else {
                continue;
            };
            let difference =
                |own: Option<f64>, other: Option<f64>| Some(100.0 * (own? / other? - 1.0));
            let computed = difference(driven.fuel(figure), other_driven.fuel(figure));
            let measured = |car: &FleetCar| car.measured.get(figure).copied();
            let Some(computed_percent) = computed else {
                continue;
            };
            all.push(Pair {
                figure: figure.clone(),
                car: car.id.clone(),
                other: other.id.clone(),
                measured_percent: difference(measured(car), measured(other)).unwrap_or(f64::NAN),
                computed_percent,
                twin_percent: difference(driven.fuel(figure), driven.twin_fuel(figure))
                    .unwrap_or(f64::NAN),
            });
        }
    }
    all
}
