//! Measured CSV files to numbers, with the place of each.
//!
//! | file | columns |
//! |---|---|
//! | points | settings of the bench, then measured columns of it |
//! | trace | `time_s`, then measured columns of the trace |
//! | scalars | `quantity`, `value`, `sd`, `phase` |
//!
//! Every column's unit is in its name. A measured column may have its standard deviation in `sd_COLUMN`; an empty cell was not
//! measured.

pub(super) mod sheet;

use cvtcycle_config::csv::{Cells, Column};
use cvtcycle_config::{Bound, Place, Problem, Problems, bounded, did_you_mean};
use cvtcycle_model::keys::Presence;
use cvtcycle_model::rig::{BenchPoint, Parts};
use cvtcycle_validate::source::Kind;
use cvtcycle_validate::tables;
use cvtcycle_validate::tables::bench::{self, SETTINGS};
use sheet::{Measured, Sheet, and_more};

/// Forms of a measured file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Points of a bench.
    Points,
    /// A trace over time.
    Trace,
    /// Single numbers of a run.
    Scalars,
}

impl Form {
    /// All of them.
    pub const ALL: [Form; 3] = [Form::Points, Form::Trace, Form::Scalars];
}

/// Reads a measured file by itself, without the plan that says what it is of; the number of its rows.
///
/// # Errors
/// All problems of the file.
///
/// ```
/// use cvtcycle_calibrate::data::{Form, check};
/// let text = "ratio,speed_rpm,temp_degc,total_nm\n2.417,1000,30,8.6\n";
/// assert_eq!(check(Form::Points, "spin.csv", text.as_bytes())?, 1);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn check(form: Form, file: &str, bytes: &[u8]) -> Result<usize, Problems> {
    let (sheet, problems) = match form {
        Form::Points => read_points(file, bytes),
        Form::Trace => read_trace(file, bytes, &tables::columns(Kind::Run, false)),
        Form::Scalars => read_scalars(file, bytes, &tables::columns(Kind::Run, true), None),
    };
    if problems.is_empty() {
        Ok(sheet.map_or(0, |sheet| sheet.rows.len()))
    } else {
        Err(problems)
    }
}

/// Reads a file that a plan names, relative to the plan.
///
/// # Errors
/// The operating system's words, or more bytes than a table may have, at the place in the plan.
pub(super) fn bytes_of(path: &str, place: &Place, key: &str) -> Result<Vec<u8>, Problems> {
    bounded::read_file(path, bounded::TABLE).map_err(|error| {
        Problem::unreadable(format!("cannot read `{path}`: {error}"))
            .at(place.clone())
            .key(key)
            .value(path)
            .allowed(error.allowed("a readable CSV file"))
            .hint(error.hint("check the name; a path is relative to the folder of the plan"))
            .into()
    })
}

/// Reads points as far as they can be understood, and all problems of the file.
pub(super) fn read_points(file: &str, bytes: &[u8]) -> (Option<Sheet>, Problems) {
    let settings = Kind::Bench.axes();
    let is_setting = |name: &&str| settings.iter().any(|key| key.name == *name);
    let columns = bench::columns().into_iter();
    let measurable: Vec<&'static str> = columns.filter(|name| !is_setting(name)).collect();
    let settings = settings.iter().map(|key| {
        let column = Column::number(key.name, key.range());
        match key.presence {
            Presence::RequiredIf(_) => column.required(),
            _ => column.or_empty(),
        }
    });
    let measured = Measured {
        names: &measurable,
        example: "total_nm: the torque loss at the input shaft",
    };
    let names = "settings and columns of the bench: docs/calibration.md lists them";
    let (sheet, problems) = sheet::read(file, bytes, settings, names, Some(measured));
    (sheet, problems.finish())
}

/// The setting of the bench of each row.
pub(super) fn bench_points(sheet: &Sheet, parts: Parts) -> Vec<BenchPoint> {
    let columns = SETTINGS.map(|key| (key, sheet.find(key.name)));
    let point = |row: usize| {
        let setting = columns.map(|(key, column)| {
            let default = match key.presence {
                Presence::Number(default) => default,
                _ => f64::NAN,
            };
            let number = sheet.number(row, column);
            key.quantity.to_si(number.unwrap_or(default))
        });
        bench::point(&setting, parts)
    };
    (0..sheet.rows.len()).map(point).collect()
}

/// Name of the column of times.
pub(super) const TIME: &str = "time_s";

/// So many columns are listed one by one.
const FEW: usize = 40;

/// Reads a trace, of which the columns `computed` can be computed, as far as it can be understood, and all problems of the file: also times
/// that do not rise.
pub(super) fn read_trace(
    file: &str,
    bytes: &[u8],
    computed: &[&'static str],
) -> (Option<Sheet>, Problems) {
    let measurable = computed.iter().copied().filter(|name| *name != TIME);
    let measurable: Vec<&str> = measurable.collect();
    let with_unit = measurable.iter().copied().filter(|name| name.contains('_'));
    let names = match with_unit.clone().count() {
        0..=FEW => with_unit.collect::<Vec<_>>().join(", "),
        _ => "time_s and columns of the trace: `cvtcycle explain COLUMN`".to_owned(),
    };
    let measured = Measured {
        names: &measurable,
        example: "transmission_sump_degc",
    };
    let time = Column::number(TIME, Bound::closed(0.0, 1e6)).required();
    let (sheet, mut problems) = sheet::read(file, bytes, [time], names, Some(measured));
    if let Some(sheet) = &sheet
        && let Some(time) = sheet.find(TIME)
    {
        let rows = 0..sheet.rows.len();
        let given = rows.filter_map(|row| Some((row, sheet.number(row, Some(time))?)));
        let given: Vec<(usize, f64)> = given.collect();
        let pairs = given.windows(2).filter(|pair| pair[0].1 >= pair[1].1);
        let falls: Vec<&[(usize, f64)]> = pairs.collect();
        if let Some([(_, before), (row, _)]) = falls.first() {
            let message = format!("the time does not rise{}", and_more(falls.len()));
            let complaint = Problem::out_of_range(message)
                .allowed(format!("above {before} s"))
                .hint("sort the rows, remove repeated ones");
            problems.add(sheet.problem(*row, time, complaint));
        }
    }
    (sheet, problems.finish())
}

/// Reads totals of a run with these quantities and, where they are known, phases, as far as they can be understood; and all problems of the
/// file.
pub(super) fn read_scalars(
    file: &str,
    bytes: &[u8],
    quantities: &[&'static str],
    phases: Option<&[String]>,
) -> (Option<Sheet>, Problems) {
    let columns = [
        Column::new("quantity", Cells::Word).required(),
        Column::number("value", Bound::any()).required(),
        Column::number("sd", Bound::positive()).required(),
        Column::new("phase", Cells::Word).or_empty(),
    ];
    let (sheet, mut problems) = sheet::read(file, bytes, columns, "", None);
    let Some(sheet) = sheet else {
        return (None, problems.finish());
    };
    let (quantity, phase) = (sheet.find("quantity"), sheet.find("phase"));
    for row in 0..sheet.rows.len() {
        let word = sheet.word(row, quantity);
        if !word.is_empty() && !quantities.contains(&word) {
            problems.add(sheet.problem(row, quantity.unwrap_or(0), no_quantity(word, quantities)));
        }
        let word = sheet.word(row, phase);
        let known =
            |phases: &&[String]| word.is_empty() || phases.iter().any(|phase| phase == word);
        if let Some(phases) = phases.filter(|phases| !known(phases)) {
            let problem = Problem::unknown_name(format!("the cycle has no phase `{word}`"))
                .allowed(phases.join(", "))
                .hint("leave the cell empty for the whole cycle");
            problems.add(sheet.problem(row, phase.unwrap_or(0), problem));
        }
    }
    (Some(sheet), problems.finish())
}

fn no_quantity(word: &str, quantities: &[&'static str]) -> Problem {
    let rest = |full: &str| full.strip_prefix(word).map(|rest| rest.starts_with('_'));
    let with_unit = quantities
        .iter()
        .copied()
        .filter(|full| rest(full) == Some(true));
    let with_unit: Vec<&str> = with_unit.collect();
    if !with_unit.is_empty() {
        return Problem::unknown_name("this quantity has no unit")
            .allowed(with_unit.join(", "))
            .hint("name it by its unit, and see that the value is in it");
    }
    let hint = did_you_mean(word, quantities.iter().copied());
    let allowed = "totals of a run, such as fuel_l_per_100km or end_sump_degc: docs/calibration.md lists them";
    Problem::unknown_name("there is no such quantity")
        .allowed(allowed)
        .hint(hint.unwrap_or_else(|| "remove the row or rename it".to_owned()))
}
