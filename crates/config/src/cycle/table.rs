//! The rows of a table, each held against the one above.

use std::mem::discriminant;

use super::header::{Column, Header, SpeedUnit};
use super::problems::{Cell, Collector, Complaint, Line};
use super::row::{self, Row};
use super::text::Field;
use crate::readable;

/// Tyres cannot do more; a higher value is a wrong unit or a lost sample.
const HIGHEST_ACCEL_M_S2: f64 = 12.0;
/// A longer gap is a lost recording.
const MAX_INTERVAL_S: f64 = 3600.0;
const MAX_CYCLE_S: f64 = 1e6;
const MAX_ROWS: usize = 2_000_000;

/// What is known while the rows are read.
pub(super) struct Table<'a> {
    header: &'a Header,
    phases: &'a mut Vec<String>,
    problems: Collector<'a>,
    rows: Vec<Row>,
    // the row above as far as it could be read: neighbours are compared one to the next, so that one bad row
    // does not condemn all that follow
    before: Row,
    first_time_s: Option<f64>,
    too_long: bool,
}

impl<'a> Table<'a> {
    /// Reads all rows. They form a trace only if there are no problems.
    pub(super) fn read<'t>(
        header: &'a Header,
        phases: &'a mut Vec<String>,
        problems: Collector<'a>,
        lines: impl Iterator<Item = Line<'t>>,
    ) -> (Vec<Row>, Collector<'a>) {
        let mut table = Self {
            header,
            phases,
            problems,
            rows: Vec::new(),
            before: Row::default(),
            first_time_s: None,
            too_long: false,
        };
        table.read_lines(lines);
        (table.rows, table.problems)
    }

    fn read_lines<'t>(&mut self, lines: impl Iterator<Item = Line<'t>>) {
        let mut fields: Vec<Field<'t>> = Vec::new();
        let mut count = 0;
        let mut names = self.phases.len();
        for line in lines {
            if count == MAX_ROWS {
                self.problems.line(line, "", || {
                    Complaint::new(
                        "the file has too many rows",
                        format!("up to {MAX_ROWS} rows"),
                        "thin it out",
                    )
                });
                return;
            }
            count += 1;
            names = self.phases.len();
            if !self
                .problems
                .split(line, self.header.columns.len(), &mut fields)
            {
                self.before = Row::default();
                continue;
            }
            let row = row::read(line, &fields, self.header, self.phases, &mut self.problems);
            self.add(line, &fields, row);
        }
        // the last row holds over nothing: a phase named there only has no interval
        self.phases.truncate(names);
        if count < 2 {
            let message = if count == 0 {
                "the file has column names and no rows"
            } else {
                "the file has one row only"
            };
            self.problems.file(Complaint::new(
                message,
                "at least two rows",
                "a row holds until the next one: add one for the end",
            ));
        }
    }

    fn add(&mut self, line: Line<'_>, fields: &[Field<'_>], mut row: Row) {
        if let Some(time_s) = row.time_s {
            row.time_s = Some(time_s - *self.first_time_s.get_or_insert(time_s));
        }
        let cell = |column: Column| cell(self.header, line, fields, column);
        let (time, speed, engine_off) = (cell(Column::Time), cell(SPEED), cell(Column::EngineOff));
        let dt_s = time.and_then(|time| self.check_time(&time, &row));
        if let (Some(cell), Some(dt_s)) = (speed, dt_s) {
            self.check_jump(&cell, &row, dt_s);
        }
        if let (Some(speed), Some(engine_off)) = (speed, engine_off) {
            self.check_engine_off(&speed, &engine_off, &row);
        }
        self.before = row;
        self.rows.push(row);
    }

    // The distance to the row above, if it can be used.
    fn check_time(&mut self, cell: &Cell<'_>, row: &Row) -> Option<f64> {
        let time_s = row.time_s?;
        if !self.too_long && !(..=MAX_CYCLE_S).contains(&time_s) {
            self.too_long = true;
            let hint = "is the time in milliseconds?";
            self.problems.cell(cell, || {
                Complaint::new(
                    "the cycle is too long",
                    "up to 1000000 s after the first row",
                    hint,
                )
            });
        }
        let dt_s = time_s - self.before.time_s?;
        let complaint = if dt_s > 0.0 && dt_s <= MAX_INTERVAL_S {
            return Some(dt_s);
        } else if dt_s > 0.0 {
            Complaint::new(
                "the gap to the row above is too long",
                "up to 3600 s",
                "is the time in milliseconds? otherwise fill the gap with rows",
            )
        } else {
            Complaint::new(
                "the time does not rise",
                "more than in the row above",
                "sort the rows by time and remove doubled ones",
            )
        };
        self.problems.cell(cell, || complaint);
        None
    }

    fn check_jump(&mut self, cell: &Cell<'_>, row: &Row, dt_s: f64) {
        let (Some(from), Some(to)) = (self.before.speed_m_s, row.speed_m_s) else {
            return;
        };
        let accel_m_s2 = (to - from) / dt_s;
        if !(-HIGHEST_ACCEL_M_S2..=HIGHEST_ACCEL_M_S2).contains(&accel_m_s2) {
            let hint = match cell.key {
                "speed_kmh" | "speed_km_h" => {
                    "is the column in km/h? is the time in seconds? or are samples lost?"
                }
                _ => "is the column in km/h? then name it speed_kmh",
            };
            self.problems.cell(cell, || {
                let message = format!(
                    "the speed jumps: {} m/s2 from the row above",
                    readable(accel_m_s2, 1)
                );
                Complaint::new(message, "-12 to 12 m/s2", hint)
            });
        }
    }

    fn check_engine_off(&mut self, speed: &Cell<'_>, engine_off: &Cell<'_>, row: &Row) {
        if row.speed_m_s.is_none_or(|speed_m_s| speed_m_s <= 0.0) {
            return;
        }
        if row.engine_off {
            let hint = "only a standing car can have its engine off";
            self.problems.cell(engine_off, || {
                Complaint::new(
                    "the engine is off while the car moves",
                    "0 where the speed is above 0",
                    hint,
                )
            });
        } else if self.before.engine_off {
            let hint = "set engine_off to 0 in the row above: it holds until this row";
            self.problems.cell(speed, || {
                Complaint::new(
                    "the car starts with its engine off",
                    "0 up to the end of engine_off",
                    hint,
                )
            });
        }
    }
}

const SPEED: Column = Column::Speed(SpeedUnit::KmH);

fn cell<'t>(
    header: &Header,
    line: Line<'t>,
    fields: &[Field<'t>],
    column: Column,
) -> Option<Cell<'t>> {
    let same = |known: &Option<(Column, &str)>| {
        known.is_some_and(|known| discriminant(&known.0) == discriminant(&column))
    };
    let at = header.columns.iter().position(same)?;
    let (_, key) = header.columns[at]?;
    Some(Cell {
        line,
        key,
        field: *fields.get(at)?,
    })
}
