//! Assigns numbers of the thesis to figures, by ids of validation rows, which hold the numbers, and by place.

use super::lines::PrintedMark;
use cvtcycle_model::rig::transmission::Piece;
use cvtcycle_output::summary::{StartWord, Summary};
use cvtcycle_validate::{Printed, ValidationRow, with_ids};

/// Car whose box and belt were tested on the rigs, and which drove the cycles.
pub(crate) const THESIS_CAR: &str = "rover_216_cvt";

/// A quantity of the transmission rig.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RigNumber {
    /// Loss of the complete box without load against speed.
    Total,
    /// Sum of the strip-down against speed.
    Sum,
    /// Loss of a piece against speed.
    Piece(Piece),
    /// Loss of the complete box against the oil's temperature, from the start of the warm-up.
    Warming { start_degc: f64 },
}

/// Rows of the minimum and the maximum, or of one number, and the speeds that they apply to, rpm.
type Span = (&'static [&'static str], [f64; 2]);

/// Speeds of thesis 5.3.1 and 5.5, rpm.
const LOW: [f64; 2] = [1000.0, 4000.0];
const HIGH: [f64; 2] = [2000.0, 4000.0];
const HIGH_PARTS: [f64; 2] = [1750.0, 4000.0];

fn span(ratio: &str, quantity: RigNumber) -> Option<Span> {
    let span: Span = match (ratio, quantity) {
        ("low", RigNumber::Total) => (&["5.04a", "5.04b"], LOW),
        ("high", RigNumber::Total) => (&["5.05a", "5.05b"], HIGH),
        ("low", RigNumber::Sum) => (&["5.18g", "5.18h"], LOW),
        ("high", RigNumber::Sum) => (&["5.19f"], HIGH_PARTS),
        ("low", RigNumber::Piece(Piece::Pump)) => (&["5.18a"], LOW),
        ("low", RigNumber::Piece(Piece::Belt)) => (&["5.18b"], LOW),
        ("low", RigNumber::Piece(Piece::InputShaft)) => (&["5.18c", "5.18d"], LOW),
        ("low", RigNumber::Piece(Piece::FinalDrive)) => (&["5.18e", "5.18f"], LOW),
        ("high", RigNumber::Piece(Piece::Pump)) => (&["5.19a", "5.19b"], HIGH_PARTS),
        ("high", RigNumber::Piece(Piece::Belt)) => (&["5.19c", "5.19d"], HIGH_PARTS),
        ("high", RigNumber::Piece(Piece::FinalDrive)) => (&["5.19e"], HIGH_PARTS),
        _ => return None,
    };
    Some(span)
}

/// Rows of the warm-up and the oil temperature that they apply to, degC; `None` at its start.
const WARMING: [(&str, &str, Option<f64>); 5] = [
    ("low", "5.09a", None),
    ("low", "5.09b", Some(80.0)),
    ("low", "5.09c", Some(100.0)),
    ("high", "5.11a", None),
    ("high", "5.11b", Some(100.0)),
];

/// Numbers of the thesis for a quantity of the rig, if the car is its car.
pub(crate) fn rig(vehicle: &str, ratio: &str, quantity: RigNumber) -> Vec<PrintedMark> {
    if vehicle != THESIS_CAR {
        return Vec::new();
    }
    if let RigNumber::Warming { start_degc } = quantity {
        let own = WARMING.iter().filter(|row| row.0 == ratio);
        let mark = |(_, id, degc): &(&str, &str, Option<f64>)| {
            let x = degc.unwrap_or(start_degc);
            Some(PrintedMark {
                x: [x; 2],
                y: number(&[id])?,
            })
        };
        return own.filter_map(mark).collect();
    }
    let mark = |(ids, x)| Some(PrintedMark { x, y: number(ids)? });
    span(ratio, quantity).and_then(mark).into_iter().collect()
}

/// The cycle of the tests in the thesis, its end, the end of its first quarter and of the four quarters, s.
const CYCLE: (&str, f64, f64, f64) = ("ece15_eudc", 1180.0, 195.0, 780.0);

/// Published numbers of a drive, each with its span on the time axis, s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PublishedDrive {
    /// Temperatures, degC.
    pub end_degc: Vec<([f64; 2], [f64; 2])>,
    /// Secondary pressures, bar.
    pub pressure_bar: Vec<([f64; 2], [f64; 2])>,
}

/// Numbers of the thesis for a drive of its car: temperatures after the soak at -10 degC, pressures at 25 degC.
pub fn published_drive(vehicle: &str, summary: &Summary) -> PublishedDrive {
    let (cycle, end, quarter, urban) = CYCLE;
    let mut quantity = PublishedDrive::default();
    if vehicle != THESIS_CAR || summary.cycle != cycle {
        return quantity;
    }
    let is_at = |degc: f64| (summary.ambient_degc - degc).abs() < 1e-6;
    let is_soaked = matches!(&summary.start, StartWord::Word(word) if word == "soak");
    if is_at(-10.0) && is_soaked {
        let marks = ["3.17a", "3.17b"].map(|id| Some(([end, end], number(&[id])?)));
        quantity.end_degc = marks.into_iter().flatten().collect();
    }
    if is_at(25.0) {
        let marks: [(&[&str], [f64; 2]); 3] = [
            (&["3.10a"], [0.0, quarter]),
            (&["3.10b"], [0.0, quarter]),
            (&["3.11a", "3.11b"], [urban, end]),
        ];
        let mark = |(ids, x): (&[&str], [f64; 2])| Some((x, number(ids)?));
        quantity.pressure_bar = marks.into_iter().filter_map(mark).collect();
    }
    quantity
}

/// Printed number of a row, or the range from that of the first to that of the last; `None` where a row has no finite number.
pub(crate) fn number(ids: &[&str]) -> Option<[f64; 2]> {
    let rows = with_ids(ids);
    let quantity = |row: &ValidationRow| match row.printed {
        Some(Printed::Range(low, high)) if low.is_finite() && high.is_finite() => Some((low, high)),
        _ => None,
    };
    let (first, last) = (rows.first()?, rows.last()?);
    Some([quantity(first)?.0, quantity(last)?.1])
}
