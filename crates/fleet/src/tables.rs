//! Results as CSV.

use cvtcycle_config::procedure::{Procedure, TestResult};

use crate::baselines::Baseline;
use crate::errors::{Entry, ErrorChange, ErrorStatistics, GroupErrors, Pair};
use crate::fit::FleetFit;
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

/// Names of the columns, and a row for each row of the table of cars, driven or refused. `before` has the cars without their settings; empty for none.
#[must_use]
pub fn fleet_table(
    fleet: &Fleet,
    cars: &[Entry],
    before: &[Entry],
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
        if !before.is_empty() {
            head.push(format!("{column}_before"));
        }
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
            if !before.is_empty() {
                let own = before.iter().find(|(other, _)| other.id == car.id);
                let fuel = own.and_then(|(_, driven)| driven.fuel(column));
                cells.push(Cell::Number(fuel.unwrap_or(f64::NAN)));
            }
        }
        let texts = [driven.failed_checks().join("; "), car.doubts.join("; ")];
        cells.extend(texts.map(Cell::Text).into_iter().chain([none()]));
        rows.push((car.line, cells));
    }
    for Refused { line, id, reason } in &fleet.refused {
        let mut cells = vec![Cell::Text(id.clone()), Cell::Number(*line as f64)];
        let width = if before.is_empty() { 4 } else { 5 };
        cells.extend((0..width * columns.len()).map(|_| Cell::Number(f64::NAN)));
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
    before: &[Entry],
    tests: &[Procedure],
    interval: Interval,
) -> Vec<u8> {
    let (head, rows) = fleet_table(fleet, cars, before, tests, interval);
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

/// Names of the cells of [`statistics`].
const STATISTICS: [&str; 7] = [
    "n",
    "mean_percent",
    "sd_percent",
    "rms_percent",
    "within_5_percent",
    "worst_percent",
    "worst_car",
];

fn statistics(e: &ErrorStatistics) -> impl Iterator<Item = String> {
    let numbers = [
        e.mean_percent,
        e.sd_percent,
        e.rms_percent,
        e.within_5_percent,
        e.worst_percent,
    ];
    let numbers = numbers.map(|x| number(Some(x)));
    [e.n.to_string()]
        .into_iter()
        .chain(numbers)
        .chain([e.worst_car.clone()])
}

/// A table of names and rows of cells.
fn csv_table<const N: usize>(
    names: [&str; N],
    rows: impl Iterator<Item = ([String; N], Vec<String>)>,
    more: &[&str],
) -> Vec<u8> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let head: Vec<String> = names
        .iter()
        .chain(more)
        .map(|name| (*name).to_owned())
        .collect();
    put(&mut out, &head);
    for (words, cells) in rows {
        put(
            &mut out,
            &words.into_iter().chain(cells).collect::<Vec<_>>(),
        );
    }
    finished(out)
}

/// `errors.csv`: statistics of the errors by group.
#[must_use]
pub fn errors_csv(groups: &[GroupErrors]) -> Vec<u8> {
    let row = |group: &GroupErrors| {
        let words = [&group.figure, &group.column, &group.word].map(Clone::clone);
        (words, statistics(&group.errors).collect())
    };
    csv_table(
        ["figure", "column", "word"],
        groups.iter().map(row),
        &STATISTICS,
    )
}

/// `pairs.csv`: differences between cars that differ in their box.
#[must_use]
pub fn pairs_csv(pairs: &[Pair]) -> Vec<u8> {
    let row = |pair: &Pair| {
        let words = [&pair.figure, &pair.car, &pair.other].map(Clone::clone);
        let numbers = [
            pair.measured_percent,
            pair.computed_percent,
            pair.error(),
            pair.twin_percent,
        ];
        (words, numbers.map(|x| number(Some(x))).to_vec())
    };
    let more = [
        "measured_percent",
        "computed_percent",
        "error_points",
        "twin_percent",
    ];
    csv_table(["figure", "carid", "other"], pairs.iter().map(row), &more)
}

/// `baselines.csv`: errors of regressions on the same cars.
#[must_use]
pub fn baselines_csv(baselines: &[Baseline]) -> Vec<u8> {
    let row = |own: &Baseline| {
        let words = [
            own.figure.clone(),
            own.transmission.clone(),
            own.knows.clone(),
            own.constants.to_string(),
        ];
        (words, statistics(&own.errors).collect())
    };
    csv_table(
        ["figure", "transmission", "knows", "constants"],
        baselines.iter().map(row),
        &STATISTICS,
    )
}

/// `changes.csv`: errors of the same cars before and after their settings.
#[must_use]
pub fn changes_csv(changes: &[ErrorChange]) -> Vec<u8> {
    let row = |own: &ErrorChange| {
        let words = [&own.figure, &own.transmission].map(Clone::clone);
        let counts = [own.cars[0], own.cars[1], own.n, own.nearer].map(|n| n.to_string());
        let numbers = [
            own.mean_percent[0],
            own.mean_percent[1],
            own.rms_percent[0],
            own.rms_percent[1],
            own.mean_change,
            own.sd_change,
        ];
        let numbers = numbers.map(|x| number(Some(x)));
        (words, counts.into_iter().chain(numbers).collect())
    };
    let more = [
        "cars_before",
        "cars_after",
        "n",
        "nearer",
        "mean_before_percent",
        "mean_after_percent",
        "rms_before_percent",
        "rms_after_percent",
        "mean_change",
        "sd_change",
    ];
    csv_table(["figure", "transmission"], changes.iter().map(row), &more)
}

/// `fit.csv`: errors of each group as its cars are made, and with the values that are fitted to the others.
#[must_use]
pub fn fit_csv(fit: &FleetFit) -> Vec<u8> {
    let of = |e: Option<&ErrorStatistics>| {
        let numbers = [e.map(|e| e.mean_percent), e.map(|e| e.rms_percent)];
        numbers.map(number)
    };
    let row = |own: &crate::fit::FoldErrors| {
        let errors = of(Some(&own.as_made))
            .into_iter()
            .chain(of(own.predicted.as_ref()));
        let values = own.values.iter().map(|x| number(Some(*x)));
        let n = [own.as_made.n.to_string()];
        (
            [own.word.clone()],
            n.into_iter().chain(errors).chain(values).collect(),
        )
    };
    let all = of(Some(&fit.as_made))
        .into_iter()
        .chain(of(fit.predicted.as_ref()));
    let values = fit.values.iter().map(|x| number(Some(*x)));
    let n = [fit.as_made.n.to_string()];
    let last = (
        ["all".to_owned()],
        n.into_iter().chain(all).chain(values).collect(),
    );
    let more = [
        "n",
        "mean_as_made_percent",
        "rms_as_made_percent",
        "mean_predicted_percent",
        "rms_predicted_percent",
    ];
    let more: Vec<&str> = more
        .into_iter()
        .chain(fit.keys.iter().map(String::as_str))
        .collect();
    csv_table(
        ["left_out"],
        fit.groups.iter().map(row).chain([last]),
        &more,
    )
}
