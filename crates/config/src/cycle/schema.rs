//! The columns of a cycle file.

use crate::Bound;
use crate::csv::{Cells, Column, Schema, Table};

/// Index of the column of times.
pub(super) const TIME: usize = 0;
/// Index of the column of phases.
pub(super) const PHASE: usize = 5;
/// Indices of the columns of gears: for every gearbox, for five and for six gears.
pub(super) const GEARS: [usize; 3] = [6, 7, 8];
/// Index of the column of notes on the gears.
pub(super) const NOTE: usize = 9;
/// Index of the column of the engine's state.
pub(super) const ENGINE_OFF: usize = 12;
/// Group of the columns of speed.
pub(super) const SPEED: &str = "speed";
/// Group of the columns of road grade.
pub(super) const GRADE: &str = "grade";

/// The steepest streets stay below this slope (rise over run).
const STEEPEST: f64 = 0.35;
/// Highest gear of each of [`GEARS`].
const HIGHEST: [u8; 3] = [10, 5, 6];

pub(super) fn schema() -> Schema {
    let speed = |name| Column::number(name, Bound::any()).required().group(SPEED);
    let speed = |name| speed(name).allowed("a speed from 0 to 300 km/h");
    let gear = |name, k: usize| {
        Column::new(
            name,
            Cells::Whole(Bound::closed(0.0, f64::from(HIGHEST[k]))),
        )
        .hint("write the number alone, and 0 where no gear is engaged")
    };
    let grade = |name, divisor: f64| {
        let limit = STEEPEST * divisor;
        Column::number(name, Bound::closed(-limit, limit)).group(GRADE)
    };
    Schema {
        columns: vec![
            Column::number("time_s", Bound::any())
                .required()
                .allowed("a time in s"),
            speed("speed_kmh"),
            speed("speed_km_h"),
            speed("speed_m_s"),
            speed("speed_mph"),
            Column::new("phase", Cells::Word)
                .allowed("a name in each row")
                .hint("repeat the name in each row of the phase"),
            gear("gear", 0),
            gear("gear_5mt", 1),
            gear("gear_6mt", 2),
            Column::new("gear_note", Cells::Word).or_empty(),
            grade("grade_percent", 100.0)
                .hint("is the column in per mille or in degrees? a cell is one number"),
            grade("grade", 1.0).hint("is the column in percent? then name it grade_percent"),
            Column::new("engine_off", Cells::Whole(Bound::closed(0.0, 1.0)))
                .allowed("0 (engine on) or 1 (engine off)")
                .hint("write 1 only where the driver stops the engine"),
            Column::new("operation", Cells::Ignored),
        ],
        max_rows: (2_000_000, "thin it out"),
        rows: "at least two rows",
        ..Schema::default()
    }
}

/// Highest gear that every gear column of the file can name.
pub(super) fn highest_gear(table: &Table) -> u8 {
    let columns = GEARS.iter().zip(HIGHEST).filter(|(k, _)| table.has(**k));
    columns.map(|(_, highest)| highest).min().unwrap_or(10)
}

// the international mile, exact by definition
const KM_PER_MILE: f64 = 1.609_344;

/// A speed in km/h and in m/s; its unit is in the name of the column.
pub(super) fn speed(name: &str, value: f64) -> (f64, f64) {
    match name {
        "speed_m_s" => (value * 3.6, value),
        "speed_mph" => (value * KM_PER_MILE, value * KM_PER_MILE / 3.6),
        _ => (value, value / 3.6),
    }
}
