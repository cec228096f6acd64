//! Cars of a table, driven on tests.

use cvtcycle::config::Problems;
use cvtcycle::config::procedure::Procedure;
use cvtcycle::fleet::errors::Entry;
use cvtcycle::fleet::tables::{Cell, fleet_table};
use cvtcycle::fleet::{ColumnMap, DrivenCar, Fleet, Setting, Sheet, spread};
use cvtcycle::output::table::{Head, Kind};
use pyo3::prelude::*;

use crate::errors::{bad, refused};
use crate::job::{Interrupted, Stop, job};
use crate::table::{Cells, Table, TableColumn};

/// Step, s.
const STEP_S: std::ops::RangeInclusive<f64> = 0.01..=10.0;

/// Drives the cars of a table, the text of a CSV file cited as `name`; one row a row of the table.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the layer of Python names them")]
pub fn fleet(
    py: Python<'_>,
    name: String,
    text: Vec<u8>,
    map: Option<String>,
    tests: Vec<String>,
    set: Vec<String>,
    dt_s: f64,
    threads: Option<usize>,
) -> PyResult<Table> {
    if !STEP_S.contains(&dt_s) {
        return Err(bad(
            "dt_s",
            &dt_s.to_string(),
            "0.01 to 10 s",
            "the step is out of range",
        ));
    }
    let solve = move |stop: &Stop| -> Result<(Vec<String>, Vec<Vec<Cell>>), Problems> {
        let map = map.map_or_else(|| Ok(ColumnMap::own()), |word| ColumnMap::open(&word))?;
        let tests: Vec<Procedure> = tests
            .iter()
            .map(|word| Procedure::open(word))
            .collect::<Result<_, _>>()?;
        let sheet = Sheet::read(&name, &text)?;
        let set = Setting::read_all(&set, &sheet.names)?;
        let driven_with = |set: &[Setting]| -> Result<(Fleet, Vec<DrivenCar>), Problems> {
            Fleet::driven(&sheet, &map, &tests, set, dt_s, stop)
        };
        let (fleet, driven) = driven_with(&set)?;
        let cars: Vec<Entry> = fleet.cars.iter().zip(&driven).collect();
        let before = match set.is_empty() {
            true => None,
            false => Some(driven_with(&[])?),
        };
        let before = before
            .iter()
            .flat_map(|(fleet, driven)| fleet.cars.iter().zip(driven));
        let before: Vec<Entry> = before.collect();
        Ok(fleet_table(&fleet, &cars, &before, &tests, &spread::known))
    };
    let (names, rows) = job(py, threads, Interrupted::Detaches, solve)?.map_err(refused)?;
    let column = |(k, name): (usize, &String)| {
        let is_text = rows
            .first()
            .is_some_and(|row| matches!(row[k], Cell::Text(_)));
        let cells = match is_text {
            true => Cells::text(rows.iter().map(|row| match &row[k] {
                Cell::Text(text) => text.as_str(),
                Cell::Number(_) => "",
            })),
            false => Cells::numbers(
                rows.iter()
                    .map(|row| match row[k] {
                        Cell::Number(x) => x,
                        Cell::Text(_) => f64::NAN,
                    })
                    .collect(),
            ),
        };
        let unit = if name.contains("_l_per_100km") {
            "L/100 km"
        } else {
            ""
        };
        let kind = if is_text { Kind::Text } else { Kind::Number };
        let (name, doc) = (name.clone(), doc(name));
        TableColumn::new(
            Head {
                name,
                unit: unit.to_owned(),
                doc,
                kind,
            },
            cells,
        )
    };
    Ok(Table::new(names.iter().enumerate().map(column).collect()))
}

/// Meaning of a column.
fn doc(name: &str) -> String {
    let ends = [
        ("_low", "lower end of the range of 90 % of cars"),
        ("_high", "upper end of the range of 90 % of cars"),
        ("_measured", "measured fuel"),
        ("_before", "computed fuel without the settings"),
    ];
    let found = ends
        .iter()
        .find(|(end, _)| name.ends_with(end))
        .map(|(_, doc)| *doc);
    let known = match name {
        "carid" => "name of the car",
        "line" => "line of its row in the table",
        "failed_checks" => "checks that failed, each with its test",
        "doubts" => "doubts about its numbers",
        "refused" => "reason for which it was not driven",
        _ => "computed fuel",
    };
    found.unwrap_or(known).to_owned()
}
