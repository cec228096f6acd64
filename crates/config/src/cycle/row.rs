//! Rows of a cycle table: their columns, and one line checked.

use super::gears::Note;
use crate::csv::{self, Cells, Collector, Column, Columns, Foreign, Schema, Table};
use crate::{Bound, Problem, readable};
use cvtcycle_model::cycle::is_standstill;

/// Index of the column of times.
const TIME: usize = 0;
/// Index of the column of phases.
const PHASE: usize = 5;
/// Indices of the columns of gears: for every gearbox, for five and for six gears.
pub(super) const GEARS: [usize; 3] = [6, 7, 8];
/// Index of the column of notes on the gears.
pub(super) const NOTE: usize = 9;
/// Index of the column of the engine's state.
const ENGINE_OFF: usize = 12;
/// Index of the column of distances, which takes the place of times.
pub(super) const DISTANCE: usize = 14;
/// Index of the column of times at rest in a table over distance.
const STOP: usize = 15;
/// Name of the speed in a VECTO file, whose rows are a second apart where it has neither time nor distance.
pub(super) const VECTO_SPEED: &str = "<v>";
/// Group of the columns of speed.
const SPEED: &str = "speed";
/// Group of the columns of road grade.
const GRADE: &str = "grade";

/// The steepest streets stay below this slope (rise over run).
const STEEPEST: f64 = 0.35;
/// Highest gear of each of [`GEARS`].
const HIGHEST: [u8; 3] = [10, 5, 6];

/// Columns of EPA's, FASTSim's and VECTO's cycles, and what people call them.
pub const FOREIGN: Foreign = Foreign {
    headings: &[
        ("cycSecs", "time_s"),
        ("cycMps", "speed_m_s"),
        ("cycGrade", "grade"),
        ("cycRoadType", ""),
        ("road_type", ""),
        ("<t>", "time_s"),
        ("<s>", "distance_m"),
        (VECTO_SPEED, "speed_kmh"),
        ("<grad>", "grade_percent"),
        ("<stop>", "stop_s"),
        ("<gear>", "gear"),
        // Auxiliaries, wind, engine speed and measured values.
        ("<*", ""),
    ],
    lines: &[("Test Time, secs Target Speed, mph", "time:s,speed:mph")],
    words: &[
        ("t", "time"),
        ("test_time", "time"),
        ("elapsed_time", "time"),
        ("v", "speed"),
        ("velocity", "speed"),
        ("vehicle_speed", "speed"),
        ("target_speed", "speed"),
        ("s", "distance"),
        ("grad", "grade"),
        ("gradient", "grade"),
        ("slope", "grade"),
        ("road_grade", "grade"),
    ],
};

pub(super) fn schema(columns: &Columns) -> Schema {
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
                .required_unless(&["distance_m", VECTO_SPEED])
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
            Column::number("distance_m", Bound::any()).allowed("a distance in m"),
            Column::number("stop_s", Bound::closed(0.0, MAX_INTERVAL_S))
                .hint("is it in s? a longer rest has rows of its own"),
        ],
        max_rows: (2_000_000, "thin it out"),
        rows: "at least two rows",
        foreign: FOREIGN,
        named: Some(columns.clone()),
        ..Schema::default()
    }
}

/// Names of the columns that a cycle's file may have.
#[must_use]
pub fn columns() -> Vec<String> {
    let schema = schema(&Columns::default());
    let read = schema
        .columns
        .iter()
        .filter(|column| column.cells != Cells::Ignored);
    read.map(|column| column.name.to_string()).collect()
}

/// Highest gear that every gear column of the file can name.
fn highest_gear(table: &Table) -> u8 {
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

/// Faster is no road car; a higher number is nearly always a wrong unit.
const MAX_SPEED_KMH: f64 = 300.0;
/// A file with more phases has its row number or its time in the column.
const MAX_PHASES: usize = 200;
/// Tyres cannot do more; a higher value is a wrong unit or a lost sample.
const MAX_ACCEL_M_S2: f64 = 12.0;
/// A longer gap is a lost recording.
const MAX_INTERVAL_S: f64 = 3600.0;
pub(super) const MAX_DURATION_S: f64 = 1e6;

/// The values of a row, in SI. What a column does not give, or gives badly, is at its default.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row {
    pub(super) time_s: Option<f64>,
    /// From the first row, in a table over distance.
    pub(super) distance_m: Option<f64>,
    /// Time at rest, in a table over distance.
    pub(super) stop_s: f64,
    pub(super) speed_m_s: Option<f64>,
    pub(super) phase: u16,
    pub(super) grade: f64,
    pub(super) engine_off: bool,
    /// In the order of [`GEARS`].
    pub(super) gears: [u8; 3],
    pub(super) note: Note,
    /// Number of its line.
    pub(super) line: u32,
}

/// Order of the rows of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Over {
    Time,
    Distance,
    /// A second from row to row.
    Seconds,
}

impl Over {
    /// Time goes before distance, as in VECTO.
    pub(super) fn from_table(table: &Table<'_>) -> Over {
        match (table.has(TIME), table.has(DISTANCE)) {
            (true, _) => Over::Time,
            (false, true) => Over::Distance,
            (false, false) => Over::Seconds,
        }
    }
}

/// Rows that were read.
pub(super) struct Rows<'p> {
    /// Names of the phases.
    pub(super) phases: &'p mut Vec<String>,
    /// They form a trace only if there are no problems.
    pub(super) rows: Vec<Row>,
    /// Time or distance of the first row, which becomes 0.
    first: Option<f64>,
    too_long: bool,
    /// Number of phases before the last row.
    phases_before: usize,
}

impl<'p> Rows<'p> {
    pub(super) fn new(phases: &'p mut Vec<String>) -> Self {
        Rows {
            phases_before: phases.len(),
            phases,
            rows: Vec::new(),
            first: None,
            too_long: false,
        }
    }

    /// Ends the reading: the last row holds over nothing, so a phase that only it names has no interval.
    pub(super) fn finish(&mut self) {
        self.phases.truncate(self.phases_before);
    }

    pub(super) fn add(&mut self, cells: &csv::Row<'_, '_>, problems: &mut Collector<'_>) {
        self.phases_before = self.phases.len();
        let table = cells.table();
        let over = Over::from_table(table);
        let at = match over {
            Over::Time => cells.number(TIME),
            Over::Distance => cells.number(DISTANCE),
            Over::Seconds => Some(self.rows.len() as f64),
        };
        self.first = self.first.or(at);
        let at = at.zip(self.first).map(|(at, first)| at - first);
        let whole = |column| cells.number(column).unwrap_or_default() as u8;
        let row = Row {
            time_s: at.filter(|_| over != Over::Distance),
            distance_m: at.filter(|_| over == Over::Distance),
            stop_s: cells.number(STOP).unwrap_or_default(),
            speed_m_s: speed_m_s(cells, problems),
            phase: self.phase(cells, problems),
            grade: table.group_column(GRADE).map_or(0.0, |column| {
                let percent = table.name(column) == "grade_percent";
                cells.number(column).unwrap_or_default() / if percent { 100.0 } else { 1.0 }
            }),
            engine_off: whole(ENGINE_OFF) == 1,
            gears: GEARS.map(whole),
            note: note(cells, problems),
            line: u32::try_from(cells.line.number).unwrap_or(u32::MAX),
        };
        check_note(&row, cells, problems);
        // Neighbours are compared one to the next, so that one bad row does not condemn all that follow.
        let before = self.rows.last().copied().unwrap_or_default();
        if over == Over::Distance {
            check_distance(&row, self.rows.last(), cells, problems);
        } else if let Some(dt_s) = self.check_time(&row, &before, cells, problems) {
            check_jump(&row, &before, dt_s, cells, problems);
        }
        check_engine_off(&row, &before, cells, problems);
        self.rows.push(row);
    }

    fn phase(&mut self, cells: &csv::Row<'_, '_>, problems: &mut Collector<'_>) -> u16 {
        let name = cells.word(PHASE);
        let known = self.phases.iter().position(|known| known == name);
        if known.is_none() && !name.is_empty() {
            if self.phases.len() < MAX_PHASES {
                self.phases.push(name.to_owned());
                return u16::try_from(self.phases.len() - 1).unwrap_or_default();
            }
            let problem = Problem::too_large("there are too many phases")
                .allowed(format!("up to {MAX_PHASES} different names"))
                .hint("a phase is a part of the cycle that is reported by itself");
            cells.report(PHASE, problems, problem);
        }
        known
            .and_then(|k| u16::try_from(k).ok())
            .unwrap_or_default()
    }

    /// The time since the row above, if it can be used.
    fn check_time(
        &mut self,
        row: &Row,
        before: &Row,
        cells: &csv::Row<'_, '_>,
        problems: &mut Collector<'_>,
    ) -> Option<f64> {
        let time_s = row.time_s?;
        if !self.too_long && time_s > MAX_DURATION_S {
            self.too_long = true;
            let problem = Problem::out_of_range("the cycle is too long")
                .allowed("up to 1000000 s after the first row")
                .hint("is the time in milliseconds?");
            cells.report(TIME, problems, problem);
        }
        let dt_s = time_s - before.time_s?;
        let problem = if dt_s > 0.0 && dt_s <= MAX_INTERVAL_S {
            return Some(dt_s);
        } else if dt_s > 0.0 {
            Problem::out_of_range("the gap to the row above is too long")
                .allowed("up to 3600 s")
                .hint("is the time in milliseconds? otherwise fill the gap with rows")
        } else {
            Problem::conflict("the time does not rise")
                .allowed("more than in the row above")
                .hint("sort the rows by time and remove doubled ones")
        };
        cells.report(TIME, problems, problem);
        None
    }
}

/// Checks a row of a table over distance against the one above.
fn check_distance(
    row: &Row,
    before: Option<&Row>,
    cells: &csv::Row<'_, '_>,
    problems: &mut Collector<'_>,
) {
    let rises = |before: &Row| {
        let pair = row.distance_m.zip(before.distance_m);
        pair.is_none_or(|(now, before)| now > before)
    };
    if !before.is_none_or(rises) {
        let problem = Problem::conflict("the distance does not rise")
            .allowed("more than in the row above")
            .hint("sort the rows by distance and remove doubled ones");
        cells.report(DISTANCE, problems, problem);
    }
    // Refers to the row above: the last one of a table may end at rest without a time.
    let at_rest = before.filter(|before| before.speed_m_s.is_some_and(is_standstill));
    if at_rest.is_some_and(|before| before.stop_s <= 0.0) {
        let problem =
            Problem::missing("the car comes to rest in the row above without a time at rest")
                .allowed("a stop_s above 0 in each row with speed 0 but the last one")
                .hint("give the seconds that the car is at rest");
        cells.report(STOP, problems, problem);
    }
    if row.stop_s > 0.0 && row.speed_m_s.is_some_and(|v| !is_standstill(v)) {
        let problem = Problem::conflict("this row has a time at rest and a speed")
            .allowed("0 where the speed is above 0")
            .hint("set the speed of the row to 0 where the car stops");
        cells.report(STOP, problems, problem);
    }
    if at_rest.is_some() && row.speed_m_s.is_some_and(is_standstill) {
        let problem = Problem::conflict("the car cannot drive from rest to rest")
            .allowed("a speed above 0 between two stops")
            .hint("the speed of a row is the target up to the next one");
        cells.report(DISTANCE, problems, problem);
    }
}

fn speed_m_s(cells: &csv::Row<'_, '_>, problems: &mut Collector<'_>) -> Option<f64> {
    let column = cells.table().group_column(SPEED)?;
    let value = cells.number(column)?;
    let name = cells.table().name(column);
    let (kmh, m_s) = speed(name, value);
    if (0.0..=MAX_SPEED_KMH).contains(&kmh) {
        return Some(m_s);
    }
    let problem = if value < 0.0 {
        Problem::out_of_range("the speed is negative")
            .hint("set a sensor's small negative values to 0; reversing cannot be driven")
    } else {
        Problem::out_of_range(format!("{} km/h is too fast", readable(kmh, 1)))
            .hint(format!("is the column in another unit than {name} says?"))
    };
    cells.report(column, problems, problem.allowed("0 to 300 km/h"));
    None
}

fn note(cells: &csv::Row<'_, '_>, problems: &mut Collector<'_>) -> Note {
    let highest = highest_gear(cells.table());
    match Note::parse(cells.word(NOTE)) {
        Some(Note::Declutched(gear)) if gear > highest => {}
        Some(note) => return note,
        None => {}
    }
    let allowed = format!(
        "PM (neutral), K1 to K{highest} (clutch disengaged in that gear), GC (gear change), the gear again or nothing"
    );
    let problem = Problem::unknown_name("this note is not known").allowed(allowed);
    let hint = "leave the cell empty where the gear column says all";
    cells.report(NOTE, problems, problem.hint(hint));
    Note::Blank
}

fn check_note(row: &Row, cells: &csv::Row<'_, '_>, problems: &mut Collector<'_>) {
    if let Note::Gear(gear) = row.note
        && gear > 0
        && row.gears == [0; 3]
    {
        problems.line(cells.line, "gear_note", || {
            Problem::conflict(format!(
                "the note says gear {gear} and the gear column says none"
            ))
            .allowed("the same gear")
            .hint("write the gear into the gear column")
        });
    }
}

fn check_jump(
    row: &Row,
    before: &Row,
    dt_s: f64,
    cells: &csv::Row<'_, '_>,
    problems: &mut Collector<'_>,
) {
    let (Some(from), Some(to)) = (before.speed_m_s, row.speed_m_s) else {
        return;
    };
    let accel_m_s2 = (to - from) / dt_s;
    if !(-MAX_ACCEL_M_S2..=MAX_ACCEL_M_S2).contains(&accel_m_s2)
        && let Some(column) = cells.table().group_column(SPEED)
    {
        let hint = match cells.table().name(column) {
            "speed_kmh" | "speed_km_h" => {
                "is the column in km/h? is the time in seconds? or are samples lost?"
            }
            _ => "is the column in km/h? then name it speed_kmh",
        };
        let accel = readable(accel_m_s2, 1);
        let problem =
            Problem::out_of_range(format!("the speed jumps: {accel} m/s2 from the row above"));
        cells.report(
            column,
            problems,
            problem.allowed("-12 to 12 m/s2").hint(hint),
        );
    }
}

fn check_engine_off(
    row: &Row,
    before: &Row,
    cells: &csv::Row<'_, '_>,
    problems: &mut Collector<'_>,
) {
    if row.speed_m_s.is_none_or(is_standstill) {
        return;
    }
    if row.engine_off {
        let problem = Problem::conflict("the engine is off while the car moves")
            .allowed("0 where the speed is above 0")
            .hint("only a standing car can have its engine off");
        cells.report(ENGINE_OFF, problems, problem);
    } else if before.engine_off
        && let Some(column) = cells.table().group_column(SPEED)
    {
        let problem = Problem::conflict("the car starts with its engine off")
            .allowed("0 up to the end of engine_off")
            .hint("set engine_off to 0 in the row above: it holds until this row");
        cells.report(column, problems, problem);
    }
}
