//! How far measured cars are from computed ones: the spread of a fleet's errors, for a car that has no measurement of its own.
//!
//! `intervals/fleet.csv` is written by `tools/fleet_spread`, from the cars of `validation/fleet` with their makes left out in turn (FS-1 to FS-3).
//!
//! | label | statement | status |
//! |---|---|---|
//! | FS-4 | FTP75 and HWFET have their own spread; every other cycle the wider of both; below 10 degC that of the first bag at -6.7 degC where it is wider | ASSUMED: no fleet is measured on other cycles |

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

/// The file.
const TABLE: &str = include_str!("../intervals/fleet.csv");
/// Ambient temperature below which the cold test tells, degC.
const COLD_DEGC: f64 = 10.0;

/// Range of 90 % of cars like one, from measured cars.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FleetRange {
    /// Figure of the fleet that tells.
    pub figure: String,
    /// Number of measured cars, or of pairs.
    pub cars: usize,
    /// Ends: fuel in L/100 km, or difference in per cent.
    pub ends: [f64; 2],
}

struct Row {
    figure: &'static str,
    kind: &'static str,
    cars: usize,
    ends: [f64; 2],
}

fn rows() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let row = |line: &'static str| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |k: usize| cells.get(k)?.parse::<f64>().ok();
            Some(Row {
                figure: cells.first()?.strip_suffix("_l_per_100km")?,
                kind: cells.get(1)?,
                cars: cells.get(2)?.parse().ok()?,
                ends: [number(5)?, number(6)?],
            })
        };
        TABLE.lines().skip(1).filter_map(row).collect()
    })
}

/// The row that tells of a run (FS-4).
fn row(kind: &str, cycle: &str, ambient_degc: f64) -> Option<&'static Row> {
    let named = |figure: &str| {
        rows()
            .iter()
            .find(|row| row.figure == figure && row.kind == kind)
    };
    let width = |row: &&Row| row.ends[1] - row.ends[0];
    let wider = |a: Option<&'static Row>, b: Option<&'static Row>| {
        [a, b]
            .into_iter()
            .flatten()
            .max_by(|a, b| width(a).total_cmp(&width(b)))
    };
    let own = match cycle {
        "ftp75" | "hwfet" => named(cycle),
        _ => wider(named("ftp75"), named("hwfet")),
    };
    match ambient_degc < COLD_DEGC {
        true => wider(own, named("cold_bag1")),
        false => own,
    }
}

/// Range of the fuel of 90 % of cars for which this fuel is computed.
///
/// ```
/// use cvtcycle_output::fleet_spread::fuel_range;
/// let range = fuel_range("cvt", "ftp75", 24.0, 7.0).expect("a spread of CVT cars");
/// assert!(range.ends[0] < 7.0 && 7.0 < range.ends[1]);
/// ```
#[must_use]
pub fn fuel_range(kind: &str, cycle: &str, ambient_degc: f64, fuel: f64) -> Option<FleetRange> {
    let row = row(kind, cycle, ambient_degc)?;
    Some(FleetRange {
        figure: row.figure.to_owned(),
        cars: row.cars,
        ends: row.ends.map(|percent| fuel * (1.0 + percent / 100.0)),
    })
}

/// Range of a figure of a test, of 90 % of cars for which this fuel is computed; of a figure that was not measured, that of the wider of FTP75 and HWFET.
#[must_use]
pub fn figure_range(kind: &str, column: &str, fuel: f64) -> Option<FleetRange> {
    let figure = column.strip_suffix("_l_per_100km").unwrap_or(column);
    let own = rows()
        .iter()
        .find(|row| row.figure == figure && row.kind == kind);
    let degc = if figure.starts_with("cold") {
        -6.7
    } else {
        24.0
    };
    let row = own.or_else(|| row(kind, figure, degc))?;
    Some(FleetRange {
        figure: row.figure.to_owned(),
        cars: row.cars,
        ends: row.ends.map(|percent| fuel * (1.0 + percent / 100.0)),
    })
}

/// Range of the difference of a CVT car to the same car with a manual box, for 90 % of pairs for which this difference is computed, per cent.
#[must_use]
pub fn pair_range(cycle: &str, ambient_degc: f64, percent: f64) -> Option<FleetRange> {
    let row = row("pair", cycle, ambient_degc)?;
    Some(FleetRange {
        figure: row.figure.to_owned(),
        cars: row.cars,
        ends: row.ends.map(|points| percent + points),
    })
}
