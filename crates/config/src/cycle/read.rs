//! A user's CSV file to a cycle, or to all that is wrong with it.

use std::path::Path;

use super::distance::{DistanceRow, Stretch, stretches};
use super::gears::{GearColumns, GearCommand, commands};
use super::likeness::likeness;
use super::row::{GEARS, MAX_DURATION_S, NOTE, Over, Row, Rows, schema};
use super::{Cycle, Interval, Measured, Recording, Trace, Weighting, is_standstill};
use crate::channel::{Quantity, Repairs};
use crate::csv::{self, Collector, Columns, Entry, Line, Table};
use crate::log::{self, Channel, Log, Resolution, Samples};
use crate::{Place, Problem, Problems, readable};

/// Reads a drive cycle from the bytes of a CSV file called `file`, as it is written: nothing is repaired or smoothed.
///
/// Columns: `time_s` (s, strictly rising, any step; the first time becomes 0), or `distance_m` with `stop_s` at speed 0 (CY-1), and one of
/// `speed_kmh`, `speed_km_h`, `speed_m_s`, `speed_mph`. Optional, holding from their row to the next: `phase` (name), `gear` (0 to 10, for every gearbox that has
/// these gears), `gear_5mt`, `gear_6mt`, `gear_note` (`PM`, `K1` .., `GC`; see [`GearCommand`]), `grade_percent` or `grade` (rise over
/// run), `engine_off` (0 or 1, standing only). `operation` is passed over. Speed is linear between rows. Names of EPA's, FASTSim's and
/// VECTO's files are known, semicolons and tabs are read, and with semicolons or tabs decimal commas: [`Cycle::read_as`].
///
/// # Errors
/// All problems of the file at once, in the order of its lines, each with its place; after 50 the rest is counted in one last entry.
pub fn read_csv(file: &str, bytes: &[u8]) -> Result<Cycle, Problems> {
    let mut phases = Vec::new();
    let read = read_rows((file, &Columns::default()), bytes, &mut phases, &mut false)?;
    let trace = trace(read.has, &read.rows, read.intervals, read.row_of);
    let read_as = read.read_as;
    let recording = None;
    Ok(cycle(
        file,
        phases,
        Found {
            trace,
            read_as,
            recording,
        },
    ))
}

/// The cycle of a file.
fn cycle(file: &str, phases: Vec<String>, found: Found) -> Cycle {
    let path = Path::new(file);
    let text = |part: Option<&std::ffi::OsStr>| {
        part.and_then(|part| part.to_str())
            .unwrap_or(file)
            .to_owned()
    };
    Cycle {
        name: text(path.file_stem()),
        title: text(path.file_name()),
        phases,
        weighting: Weighting::None,
        manual: found.trace,
        automatic: None,
        read_as: found.read_as,
        recording: found.recording,
        is_wltc: false,
    }
}

/// As [`read_csv`], with the columns that are meant, of which all others are passed over, and the repairs that are wanted. A file that is not written as the
/// program's own tables, or as those of EPA, FASTSim and VECTO, is read as a log: see [`crate::log`].
///
/// # Errors
/// As there.
pub fn read_columns(file: &str, bytes: &[u8], columns: &Columns) -> Result<Cycle, Problems> {
    let mut phases = Vec::new();
    let found = read_any(file, bytes, columns, &mut phases)?;
    Ok(cycle(file, phases, found))
}

/// A file that was read.
struct Found {
    trace: Trace,
    read_as: Option<String>,
    recording: Option<Box<Recording>>,
}

/// Reads a table of a cycle, else a log.
fn read_any(
    file: &str,
    bytes: &[u8],
    columns: &Columns,
    phases: &mut Vec<String>,
) -> Result<Found, Problems> {
    // Quantities that only the tables of cycles have: gears, distances.
    let of_table =
        |entry: &Entry| entry.quantity != "where" && Quantity::from_word(&entry.quantity).is_none();
    let is_table = columns.is_empty() || columns.entries().iter().any(of_table);
    let mut has_names = false;
    let table = is_table.then(|| read_rows((file, columns), bytes, phases, &mut has_names));
    let problems = match table {
        Some(Ok(read)) if !read.is_strange() => return as_recorded(file, read, columns),
        Some(Ok(_)) => None,
        Some(Err(problems)) => Some(problems),
        None => None,
    };
    phases.clear();
    let refused = match log::read(file, bytes, columns, likeness) {
        Ok(log) => return Ok(of_log(log, phases)),
        Err(refused) => refused,
    };
    // The reader of tables says more of a table of a cycle, unless there is something to choose, and that is all that it lacks.
    let is_choice = |problem: &Problem| problem.proposal.is_some() || !problem.settings.is_empty();
    let is_better = match has_names {
        true => {
            refused.problems.iter().any(is_choice)
                && mends((file, bytes), columns, &refused.problems)
        }
        false => refused.is_known,
    };
    match problems {
        Some(problems) if !is_better => {
            let columns = refused.problems.iter().map(Problem::proposed);
            let columns = columns.max().unwrap_or_default().to_owned();
            Err(alike(problems).map(|problem| problem.columns(columns.as_str())))
        }
        _ => Err(refused.problems),
    }
}

/// True if the log is read with the repairs that its problems propose, or with those that are proposed then; also where none is proposed.
fn mends((file, bytes): (&str, &[u8]), columns: &Columns, problems: &Problems) -> bool {
    let next = |wanted: Repairs, problems: &Problems| -> Option<Repairs> {
        let proposed = problems.iter().filter_map(|own| own.proposal.as_deref());
        let more = proposed.fold(wanted, |all, own| all.with(&own.repair));
        (more != wanted).then_some(more)
    };
    let Some(mut wanted) = next(columns.repairs(), problems) else {
        return true;
    };
    loop {
        let columns = columns.clone().with_repairs(wanted);
        let Err(refused) = log::read(file, bytes, &columns, likeness) else {
            return true;
        };
        match next(wanted, &refused.problems) {
            Some(more) => wanted = more,
            None => return false,
        }
    }
}

/// Problems of one kind as one, with the number of the others and the lines of the first.
fn alike(problems: Problems) -> Problems {
    const SHOWN: usize = 5;
    // Two problems that differ in their figures alone are of one kind.
    let kind = |problem: &Problem| {
        let words: String = problem
            .message
            .chars()
            .filter(|c| !c.is_ascii_digit())
            .collect();
        (problem.key.clone(), words, problem.place.line == 0)
    };
    let mut first: Vec<(Problem, Vec<usize>)> = Vec::new();
    let mut not_shown = None;
    for problem in problems {
        if problem.not_shown().is_some() {
            not_shown = Some(problem);
            continue;
        }
        match first
            .iter_mut()
            .find(|(other, _)| kind(other) == kind(&problem))
        {
            Some((_, lines)) => lines.push(problem.place.line),
            None => first.push((problem, Vec::new())),
        }
    }
    let joined = first.into_iter().map(|(problem, lines)| match lines.len() {
        0 => problem,
        1..=2 => {
            let lines: Vec<String> = lines.iter().map(usize::to_string).collect();
            let message = format!("{}, also in line {}", problem.message, lines.join(" and "));
            problem.message(message)
        }
        count => {
            let shown: Vec<String> = lines.iter().take(SHOWN).map(usize::to_string).collect();
            let more = if count > SHOWN { " and others" } else { "" };
            let message = format!(
                "{}, and in {count} more rows: line {}{more}",
                problem.message,
                shown.join(", ")
            );
            problem.message(message)
        }
    });
    joined.chain(not_shown).collect()
}

/// Other channels of the car, and the air's temperature, that a log has, over the cycle's time.
fn measured(log: &Log) -> Vec<Measured> {
    let samples = &log.treated.samples;
    let is_of_car = |channel: &&Channel| {
        use Quantity::{Ambient, Coolant, EngineOil, EngineSpeed, Fuel, Sump};
        matches!(
            channel.quantity,
            EngineSpeed | Fuel | Coolant | EngineOil | Sump | Ambient
        ) && channel.values.len() == samples.time_s.len()
            && channel.values.iter().any(|value| value.is_finite())
    };
    let of_car = log.channels.iter().filter(is_of_car);
    let times = samples.time_s.iter().map(|time| time - samples.time_s[0]);
    let times: Vec<f64> = times.collect();
    of_car
        .map(|channel| Measured {
            quantity: channel.quantity.name().to_owned(),
            time_s: times.clone(),
            values: channel.values.clone(),
        })
        .collect()
}

/// The trace of a log.
fn of_log(log: Log, phases: &mut Vec<String>) -> Found {
    /// Rows nearer to each other say nothing more about a drive, s.
    const NEAR_S: f64 = 0.1;
    let samples = &log.treated.samples;
    phases.extend(log.words.iter().take(usize::from(u16::MAX)).cloned());
    let first_s = samples.time_s[0];
    let last = samples.time_s.len() - 1;
    let mut rows = vec![0];
    let is_fast = log
        .treated
        .resolution
        .is_some_and(|own| own.step_s < 0.5 * NEAR_S);
    for k in 1..=last {
        let before = rows.last().copied().unwrap_or_default();
        let step = samples.time_s[k] - samples.time_s[before];
        // A start and a stop keep their instant.
        let turns = is_standstill(samples.speed_m_s[k]) != is_standstill(samples.speed_m_s[k - 1]);
        if !is_fast || k == last || turns || step >= NEAR_S {
            rows.push(k);
        }
    }
    let trace = |speed_m_s: &[f64]| {
        let interval = |pair: &[usize]| {
            let (from, to) = (pair[0], pair[1]);
            let rests = is_standstill(speed_m_s[from]) && is_standstill(speed_m_s[to]);
            Interval {
                start_s: samples.time_s[from] - first_s,
                end_s: samples.time_s[to] - first_s,
                start_speed_m_s: speed_m_s[from],
                end_speed_m_s: speed_m_s[to],
                phase: log.phase.as_ref().map_or(0, |phase| phase[from]),
                grade: log.grade.as_ref().map_or(0.0, |grade| grade[from]),
                engine_off: rests && log.engine_off.as_ref().is_some_and(|off| off[from]),
            }
        };
        Trace::without_gears(rows.windows(2).map(interval).collect())
    };
    let measured = measured(&log);
    let bounds = log
        .treated
        .bounds
        .iter()
        .map(|speed| trace(speed))
        .collect();
    let mut read_as = log.read_as;
    if rows.len() <= last {
        read_as.push(format!("a row each {NEAR_S} s"));
    }
    let all = log.channels.len() + log.passed_over.len();
    if !log.passed_over.is_empty() {
        read_as.push(format!("{} of {all} columns", log.channels.len()));
    }
    let treated = &log.treated;
    Found {
        trace: trace(&samples.speed_m_s),
        read_as: (!read_as.is_empty()).then(|| read_as.join(", ")),
        recording: Some(Box::new(Recording {
            repairs: treated.repairs.clone(),
            doubts: treated.doubts.clone(),
            bounds,
            left: treated.left,
            is_log: treated.is_recording,
            measured,
        })),
    }
}

/// A table of a cycle whose rows are a recording is repaired and doubted like a log.
fn as_recorded(file: &str, read: ReadRows, columns: &Columns) -> Result<Found, Problems> {
    let samples = read.samples();
    let ReadRows {
        has,
        mut rows,
        mut intervals,
        row_of,
        read_as,
    } = read;
    if row_of.is_some() {
        let trace = trace(has, &rows, intervals, row_of);
        return Ok(Found {
            trace,
            read_as,
            recording: None,
        });
    }
    let resolution = Resolution::of(&samples.time_s, &samples.speed_m_s);
    let like = likeness(&samples, resolution.map_or(0.0, |own| own.speed_m_s));
    let raw = samples.speed_m_s.clone();
    let place = |line: u32| {
        Problem::default().at(Place {
            line: line as usize,
            ..Place::file(file)
        })
    };
    let is_exact = like.is_exact && resolution.is_none_or(|own| own.speed_m_s < 0.15);
    let treated = log::treat(samples, columns.repairs(), is_exact, &place);
    let treated = treated.map_err(|problems| problems.into_iter().collect::<Problems>())?;
    let mut doubts = treated.doubts;
    doubts.extend(like.doubt);
    doubts.extend(log::motions(&treated.samples));
    doubts.extend(log::steep(rows.iter().map(|row| row.grade)));
    let (times, speeds) = (&treated.samples.time_s, &treated.samples.speed_m_s);
    let mut with = |speeds: &[f64]| {
        for (k, row) in rows.iter_mut().enumerate() {
            (row.time_s, row.speed_m_s) = (Some(times[k]), Some(speeds[k]));
        }
        for (k, interval) in intervals.iter_mut().enumerate() {
            (interval.start_s, interval.end_s) = (times[k], times[k + 1]);
            (interval.start_speed_m_s, interval.end_speed_m_s) = (speeds[k], speeds[k + 1]);
        }
        trace(has, &rows, intervals.clone(), None)
    };
    let bounds: Vec<Trace> = treated.bounds.iter().map(|speed| with(speed)).collect();
    let is_changed = raw != *speeds || !treated.repairs.is_empty();
    let trace = with(speeds);
    let is_said = is_changed || !doubts.is_empty() || treated.is_recording;
    let recording = Recording {
        repairs: treated.repairs,
        doubts,
        bounds,
        left: treated.left,
        is_log: treated.is_recording,
        measured: Vec::new(),
    };
    Ok(Found {
        trace,
        read_as,
        recording: is_said.then(|| Box::new(recording)),
    })
}

/// Rows of a table of a cycle.
pub(super) struct ReadRows {
    has: [bool; 3],
    rows: Vec<Row>,
    intervals: Vec<Interval>,
    /// Row of each interval in a table over distance.
    row_of: Option<Vec<usize>>,
    read_as: Option<String>,
}

impl ReadRows {
    /// True if its steps are those of no drive: stamps in another unit, which the reader of logs says with what to write.
    fn is_strange(&self) -> bool {
        self.row_of.is_none() && log::are_strange(&self.samples())
    }

    fn samples(&self) -> Samples {
        let of = |of: &dyn Fn(&Row) -> f64| self.rows.iter().map(of).collect::<Vec<f64>>();
        Samples {
            time_s: of(&|row| row.time_s.unwrap_or_default()),
            speed_m_s: of(&|row| row.speed_m_s.unwrap_or_default()),
            lines: self.rows.iter().map(|row| row.line).collect(),
            first_m_s: Vec::new(),
        }
    }
}

/// The trace alone, and how it was read. Phases known already keep their index, new ones are added.
#[cfg(test)]
pub(super) fn read_trace(
    own: (&str, &Columns),
    bytes: &[u8],
    phases: &mut Vec<String>,
) -> Result<(Trace, Option<String>), Problems> {
    let read = read_rows(own, bytes, phases, &mut false)?;
    let trace = trace(read.has, &read.rows, read.intervals, read.row_of);
    Ok((trace, read.read_as))
}

/// Reads a table of a cycle; phases known already keep their index, new ones are added. `has_names`: the names of its columns are those of a cycle.
fn read_rows(
    (file, columns): (&str, &Columns),
    bytes: &[u8],
    phases: &mut Vec<String>,
    has_names: &mut bool,
) -> Result<ReadRows, Problems> {
    let mut problems = Collector::new(file);
    let mut rows = Rows::new(phases);
    let schema = schema(columns);
    let table = csv::read(
        bytes,
        &schema,
        &mut problems,
        |table, header, problems| {
            *has_names = problems.is_empty();
            check_notes(table, header, problems);
        },
        |cells, problems| {
            rows.add(cells, problems);
            true
        },
    );
    rows.finish();
    let Some(table) = table else {
        return Err(problems.finish());
    };
    let rows = rows.rows;
    if rows.len() == 1 {
        problems.file(
            Problem::missing("the file has one row only")
                .allowed("at least two rows")
                .hint("a row holds until the next one: add one for the end"),
        );
    }
    // A table over distance has a time only when it is whole.
    let (intervals, row_of) =
        match problems.is_empty() && Over::from_table(&table) == Over::Distance {
            true => over_distance(&rows),
            false => {
                let pairs = rows.windows(2);
                (
                    pairs.map(|pair| interval(&pair[0], &pair[1])).collect(),
                    None,
                )
            }
        };
    let duration_s = intervals.last().map_or(0.0, |last| last.end_s);
    if problems.is_empty() && !(duration_s > 0.0 && duration_s <= MAX_DURATION_S) {
        let duration = readable(duration_s, 1);
        problems.file(
            Problem::out_of_range(format!("the cycle over distance takes {duration} s"))
                .allowed("above 0 and up to 1000000 s")
                .hint("are distances and speeds in the units that their columns say?"),
        );
    }
    problems.finish().finish()?;
    let read_as = read_as(&table);
    let has = GEARS.map(|k| table.has(k));
    Ok(ReadRows {
        has,
        rows,
        intervals,
        row_of,
        read_as,
    })
}

/// The intervals of a table over distance, and the row of each.
fn over_distance(rows: &[Row]) -> (Vec<Interval>, Option<Vec<usize>>) {
    let row = |row: &Row| DistanceRow {
        distance_m: row.distance_m.unwrap_or_default(),
        speed_m_s: row.speed_m_s.unwrap_or_default(),
        stop_s: row.stop_s,
    };
    let list: Vec<DistanceRow> = rows.iter().map(row).collect();
    let stretches = stretches(&list);
    let interval = |s: &Stretch| Interval {
        start_s: s.time_s[0],
        end_s: s.time_s[1],
        start_speed_m_s: s.speed_m_s[0],
        end_speed_m_s: s.speed_m_s[1],
        phase: rows[s.row].phase,
        grade: rows[s.row].grade,
        engine_off: rows[s.row].engine_off,
    };
    let row_of = stretches.iter().map(|s| s.row).collect();
    (stretches.iter().map(interval).collect(), Some(row_of))
}

/// How a table was read, where it is not as the program writes its own.
fn read_as(table: &Table) -> Option<String> {
    let over = match Over::from_table(table) {
        Over::Time => None,
        Over::Distance => Some("over distance, with 1.0 m/s2 up and 1.5 m/s2 down (CY-1)"),
        Over::Seconds => Some("a row a second"),
    };
    let words: Vec<&str> = table.read_as().into_iter().chain(over).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// Reports notes without a column of the gears that they are on.
fn check_notes(table: &Table, header: Line<'_>, problems: &mut Collector<'_>) {
    if table.has(NOTE) && !GEARS.iter().any(|k| table.has(*k)) {
        problems.line(header, "gear_note", || {
            Problem::missing("gear_note needs a column with the gears")
                .names_key()
                .allowed("gear, gear_5mt or gear_6mt")
                .hint("add a column gear, 0 where none is engaged")
        });
    }
}

/// The trace of rows; `has`: the columns of gears that there are, in the order of [`GEARS`].
pub(super) fn trace(
    has: [bool; 3],
    rows: &[Row],
    intervals: Vec<Interval>,
    row_of: Option<Vec<usize>>,
) -> Trace {
    let [plain, five, six] = [0, 1, 2].map(|k| -> Option<Vec<GearCommand>> {
        has[k].then(|| {
            let mut list = commands(rows.iter().map(|row| (row.gears[k], row.note)));
            match &row_of {
                Some(row_of) => row_of.iter().map(|row| list[*row]).collect(),
                None => {
                    list.truncate(intervals.len());
                    list
                }
            }
        })
    });
    Trace::with_gears(intervals, GearColumns::new(five, six, plain))
}

/// The interval from a row to the next.
pub(super) fn interval(row: &Row, next: &Row) -> Interval {
    let Row {
        phase,
        grade,
        engine_off,
        ..
    } = *row;
    Interval {
        start_s: row.time_s.unwrap_or_default(),
        end_s: next.time_s.unwrap_or_default(),
        start_speed_m_s: row.speed_m_s.unwrap_or_default(),
        end_speed_m_s: next.speed_m_s.unwrap_or_default(),
        phase,
        grade,
        engine_off,
    }
}
