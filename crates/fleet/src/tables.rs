//! Results as CSV.

use cvtcycle_config::procedure::{Procedure, TestResult};

use crate::baselines::Baseline;
use crate::errors::{Entry, GroupErrors, Pair};
use crate::{Fleet, Refused};

/// Range of 90 % of cars for a computed figure, as factors on it: low and high. `None` where no measured cars tell.
pub type Interval<'a> = &'a dyn Fn(Entry, &str) -> Option<[f64; 2]>;

fn number(x: Option<f64>) -> String {
    x.filter(|x| x.is_finite())
        .map_or_else(String::new, |x| format!("{x:.4}"))
}

fn finished(out: csv::Writer<Vec<u8>>) -> Vec<u8> {
    // A vector takes every write.
    out.into_inner().unwrap_or_default()
}

fn put(out: &mut csv::Writer<Vec<u8>>, cells: &[String]) {
    let _ = out.write_record(cells);
}

/// Cell of the table of a fleet.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number; NaN where there is none.
    Number(f64),
    /// Text.
    Text(String),
}

/// Names of the columns, and a row for each row of the table of cars, driven or refused.
#[must_use]
pub fn fleet_table(
    fleet: &Fleet,
    cars: &[Entry],
    tests: &[Procedure],
    interval: Interval,
) -> (Vec<String>, Vec<Vec<Cell>>) {
    let of_test = |test: &Procedure| {
        test.results
            .iter()
            .map(TestResult::column)
            .collect::<Vec<_>>()
    };
    let columns: Vec<String> = tests.iter().flat_map(of_test).collect();
    let mut head = vec!["carid".to_owned(), "line".to_owned()];
    for column in &columns {
        let ends = ["_low", "_high", "_measured"].map(|end| format!("{column}{end}"));
        head.extend([column.clone()].into_iter().chain(ends));
    }
    head.extend(["failed_checks", "doubts", "refused"].map(str::to_owned));
    let mut rows: Vec<(u64, Vec<Cell>)> = Vec::new();
    let none = || Cell::Text(String::new());
    for entry in cars {
        let (car, driven) = *entry;
        let mut cells = vec![Cell::Text(car.id.clone()), Cell::Number(car.line as f64)];
        for column in &columns {
            let fuel = driven.fuel(column);
            let range =
                fuel.and_then(|fuel| Some(interval(*entry, column)?.map(|factor| factor * fuel)));
            let measured = car.measured.get(column).copied();
            let numbers = [fuel, range.map(|r| r[0]), range.map(|r| r[1]), measured];
            cells.extend(numbers.map(|x| Cell::Number(x.unwrap_or(f64::NAN))));
        }
        let texts = [driven.failed_checks().join("; "), car.doubts.join("; ")];
        cells.extend(texts.map(Cell::Text).into_iter().chain([none()]));
        rows.push((car.line, cells));
    }
    for Refused { line, id, reason } in &fleet.refused {
        let mut cells = vec![Cell::Text(id.clone()), Cell::Number(*line as f64)];
        cells.extend((0..4 * columns.len()).map(|_| Cell::Number(f64::NAN)));
        cells.extend([none(), none(), Cell::Text(reason.clone())]);
        rows.push((*line, cells));
    }
    rows.sort_by_key(|(line, _)| *line);
    (head, rows.into_iter().map(|(_, cells)| cells).collect())
}

/// `fleet.csv`.
#[must_use]
pub fn fleet_csv(
    fleet: &Fleet,
    cars: &[Entry],
    tests: &[Procedure],
    interval: Interval,
) -> Vec<u8> {
    let (head, rows) = fleet_table(fleet, cars, tests, interval);
    let mut out = csv::Writer::from_writer(Vec::new());
    put(&mut out, &head);
    for row in rows {
        let text = |(k, cell): (usize, &Cell)| match cell {
            Cell::Number(line) if k == 1 => line.to_string(),
            Cell::Number(x) => number(Some(*x)),
            Cell::Text(text) => text.clone(),
        };
        put(
            &mut out,
            &row.iter().enumerate().map(text).collect::<Vec<_>>(),
        );
    }
    finished(out)
}

/// `errors.csv`: statistics of the errors by group.
#[must_use]
pub fn errors_csv(groups: &[GroupErrors]) -> Vec<u8> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let head = [
        "figure",
        "column",
        "word",
        "n",
        "mean_percent",
        "sd_percent",
        "rms_percent",
        "within_5_percent",
        "worst_percent",
        "worst_car",
    ];
    put(&mut out, &head.map(str::to_owned));
    for group in groups {
        let e = &group.errors;
        let mut cells = vec![
            group.figure.clone(),
            group.column.clone(),
            group.word.clone(),
            e.n.to_string(),
        ];
        cells.extend(
            [
                e.mean_percent,
                e.sd_percent,
                e.rms_percent,
                e.within_5_percent,
                e.worst_percent,
            ]
            .map(|x| number(Some(x))),
        );
        cells.push(e.worst_car.clone());
        put(&mut out, &cells);
    }
    finished(out)
}

/// `pairs.csv`: differences between cars that differ in their box.
#[must_use]
pub fn pairs_csv(pairs: &[Pair]) -> Vec<u8> {
    let mut out = csv::Writer::from_writer(Vec::new());
    put(
        &mut out,
        &[
            "figure",
            "carid",
            "other",
            "measured_percent",
            "computed_percent",
            "error_points",
        ]
        .map(str::to_owned),
    );
    for pair in pairs {
        let mut cells = vec![pair.figure.clone(), pair.car.clone(), pair.other.clone()];
        cells.extend(
            [pair.measured_percent, pair.computed_percent, pair.error()].map(|x| number(Some(x))),
        );
        put(&mut out, &cells);
    }
    finished(out)
}

/// `baselines.csv`: errors of regressions on the same cars.
#[must_use]
pub fn baselines_csv(baselines: &[Baseline]) -> Vec<u8> {
    let mut out = csv::Writer::from_writer(Vec::new());
    put(
        &mut out,
        &[
            "figure",
            "transmission",
            "knows",
            "constants",
            "n",
            "mean_percent",
            "sd_percent",
            "rms_percent",
            "within_5_percent",
        ]
        .map(str::to_owned),
    );
    for baseline in baselines {
        let e = &baseline.errors;
        let mut cells = vec![
            baseline.figure.clone(),
            baseline.transmission.clone(),
            baseline.knows.clone(),
            baseline.constants.to_string(),
            e.n.to_string(),
        ];
        cells.extend(
            [
                e.mean_percent,
                e.sd_percent,
                e.rms_percent,
                e.within_5_percent,
            ]
            .map(|x| number(Some(x))),
        );
        put(&mut out, &cells);
    }
    finished(out)
}
