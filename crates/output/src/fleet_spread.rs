//! How far measured cars are from computed ones: the spread of a fleet's errors, for a car that has no measurement of its own.
//!
//! `intervals/fleet.csv` is written by `tools/fleet_spread`, from the cars of `validation/fleet` with their makes left out in turn (FS-1 to FS-3).
//!
//! | label | statement | status |
//! |---|---|---|
//! | FS-4 | FTP75 and HWFET have their own spread; every other cycle the wider of both; below 10 degC that of the first bag at -6.7 degC where it is wider | ASSUMED: no fleet is measured on other cycles |
//! | FS-5 | a part of a cycle has the widest spread of the three bags of FTP75 | ASSUMED: as FS-4 |
//! | FS-6 | cars that are no pair: ends of ln(F/F_other) from the middles and half widths of both kinds, c_1 - c_2 +- sqrt(h_1^2 + h_2^2) | ASSUMED: the errors of the two cars are independent |

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

/// Conditions of the drive by which measured cars are chosen for comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenOn<'a> {
    /// Name of the cycle.
    pub cycle: &'a str,
    /// True for a part of the cycle.
    pub is_part: bool,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
}

impl<'a> DrivenOn<'a> {
    /// A whole cycle.
    #[must_use]
    pub fn whole(cycle: &'a str, ambient_degc: f64) -> Self {
        DrivenOn {
            cycle,
            is_part: false,
            ambient_degc,
        }
    }

    /// A part of a cycle.
    #[must_use]
    pub fn part(cycle: &'a str, ambient_degc: f64) -> Self {
        DrivenOn {
            is_part: true,
            ..DrivenOn::whole(cycle, ambient_degc)
        }
    }

    /// The row that tells of a run (FS-4, FS-5).
    fn row(&self, kind: &str) -> Option<&'static Row> {
        let named = |figure: &str| {
            rows()
                .iter()
                .find(|row| row.figure == figure && row.kind == kind)
        };
        let width = |row: &&Row| row.ends[1] - row.ends[0];
        let widest = |figures: &[&str]| {
            figures
                .iter()
                .filter_map(|figure| named(figure))
                .max_by(|a, b| width(a).total_cmp(&width(b)))
        };
        let own = match (self.is_part, self.cycle) {
            (true, _) => widest(&["bag1", "bag2", "bag3"]),
            (_, "ftp75" | "hwfet") => named(self.cycle),
            _ => widest(&["ftp75", "hwfet"]),
        };
        match self.ambient_degc < COLD_DEGC {
            true => [own, named("cold_bag1")]
                .into_iter()
                .flatten()
                .max_by(|a, b| width(a).total_cmp(&width(b))),
            false => own,
        }
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
    let row = DrivenOn::whole(cycle, ambient_degc).row(kind)?;
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
    let row = own.or_else(|| DrivenOn::whole(figure, degc).row(kind))?;
    Some(FleetRange {
        figure: row.figure.to_owned(),
        cars: row.cars,
        ends: row.ends.map(|percent| fuel * (1.0 + percent / 100.0)),
    })
}

/// Kinds of box of two cars, and whether they differ in nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared<'a> {
    /// `cvt` or `manual`: the car, and the one that it is compared with.
    pub kinds: [&'a str; 2],
    /// Relation of the other car to this one.
    pub other: Other,
}

/// Relation of a car to the one it is compared with: sets which spread applies to the difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Other {
    /// The twin by the rules of the program (TW-1 to TW-4), whose gear set and shift speeds are guesses as well.
    Twin,
    /// A car of its own, with the same road load, tyres and engine.
    Alike,
    /// Any car.
    Any,
}

/// Range of the difference of two cars for 90 % of such cars, per cent: of a CVT to the same car with a manual box from measured pairs, driven with the pair's own
/// manual car or with the twin of the CVT in its place; of all others from the errors of both (FS-6).
///
/// ```
/// use cvtcycle_output::fleet_spread::{Compared, DrivenOn, Other, difference_range};
/// let of = |other| Compared { kinds: ["cvt", "manual"], other };
/// let on = DrivenOn::whole("hwfet", 24.0);
/// let range = |other| difference_range(of(other), on, -3.0).expect("cars of both kinds").ends;
/// let [pair, unlike] = [Other::Alike, Other::Any].map(range);
/// assert!(unlike[0] < pair[0] && pair[0] < -3.0 && -3.0 < pair[1] && pair[1] < unlike[1]);
/// ```
#[must_use]
pub fn difference_range(of: Compared, on: DrivenOn, percent: f64) -> Option<FleetRange> {
    if of.kinds == ["cvt", "manual"] && of.other != Other::Any {
        let row = on.row(match of.other {
            Other::Twin => "twin",
            _ => "pair",
        })?;
        return Some(FleetRange {
            figure: row.figure.to_owned(),
            cars: row.cars,
            ends: row.ends.map(|points| percent + points),
        });
    }
    let [own, other] = of.kinds.map(|kind| on.row(kind));
    let (own, other) = (own?, other?);
    let of = |row: &Row| {
        let [low, high] = row.ends.map(|percent| (percent / 100.0).ln_1p());
        (0.5 * (low + high), 0.5 * (high - low))
    };
    let ((own_middle, own_half), (other_middle, other_half)) = (of(own), of(other));
    let (middle, half) = (own_middle - other_middle, own_half.hypot(other_half)); // FS-6
    let ends =
        [middle - half, middle + half].map(|x| 100.0 * ((1.0 + percent / 100.0) * x.exp() - 1.0));
    Some(FleetRange {
        figure: own.figure.to_owned(),
        cars: own.cars.min(other.cars),
        ends,
    })
}
