//! Transmissions on the bench: losses of components, and the belt alone, at given points.

use cvtcycle::config::{Problem, Problems, unit_of};
use cvtcycle::model::rig::Bench;
use cvtcycle::model::transmission::Transmission;
use cvtcycle::output::losses::{Axis, LossRow, MAX_POINTS, columns};
use cvtcycle::output::progress::Progress;
use cvtcycle::validate::belt::{Job, Model, Point, Solved, Take, output_columns};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::car::{Car, formulation};
use crate::errors::{bad, refused};
use crate::family::doubles;
use crate::job::{Interrupted, Stop, job};
use crate::table::{Table, TableColumn};

/// Maximum number of problems reported for a column.
const MAX_DESCRIBED: usize = 20;

/// Column of an axis in the table of losses.
fn column_of(axis: Axis, is_cvt: bool) -> &'static str {
    match axis {
        Axis::Ratio if is_cvt => "belt_ratio",
        Axis::Ratio => "gear",
        Axis::Sump => "transmission_sump_degc",
        Axis::Belt => "belt_spray_degc",
        Axis::Throttle => "throttle",
        Axis::Pressure => "secondary_pressure_bar",
        Axis::Torque => "output_torque_nm",
        Axis::InputTorque => "input_torque_nm",
        Axis::Speed => "input_speed_rpm",
    }
}

/// Points of a bench by axis: NaN for an axis without values.
type Points = [Vec<f64>; Axis::COUNT];

/// Builds points from columns of doubles, all of one length, or of length 1 for a value shared by all points.
fn build_points(transmission: &Transmission, given: &[(String, Vec<u8>)]) -> PyResult<Points> {
    let is_cvt = transmission.is_cvt();
    let has = |axis: &Axis| {
        let of_all = [
            Axis::Ratio,
            Axis::Sump,
            Axis::Torque,
            Axis::InputTorque,
            Axis::Speed,
        ];
        is_cvt || of_all.contains(axis)
    };
    let mut axes = Points::default();
    for (name, bytes) in given {
        let mut known = Axis::ALL.into_iter().filter(has);
        let Some(axis) = known.find(|axis| column_of(*axis, is_cvt) == name) else {
            let names = Axis::ALL.into_iter().filter(has);
            let names: Vec<&str> = names.map(|axis| column_of(axis, is_cvt)).collect();
            let message = "this transmission has no such column";
            return Err(bad(name, "", &names.join(", "), message));
        };
        axes[axis as usize] = doubles(name, bytes)?;
    }
    let none = given.iter().any(|(_, bytes)| bytes.is_empty());
    let most = axes.iter().map(Vec::len).max().unwrap_or(0);
    let count = if none { 0 } else { most };
    if count > MAX_POINTS {
        let message = format!("{count} points are too many for one call");
        let allowed = format!("at most {MAX_POINTS} points");
        return Err(bad("points", &count.to_string(), &allowed, &message));
    }
    let mut problems = Problems::new();
    for axis in Axis::ALL {
        let (values, name) = (&mut axes[axis as usize], column_of(axis, is_cvt));
        check(transmission, axis, values, &mut problems);
        match values.len() {
            0 | 1 => *values = vec![values.first().copied().unwrap_or(f64::NAN); count],
            n if n != count => {
                let message = format!("{n} values, where other columns have {count}");
                let problem = Problem::invalid(message).key(name);
                problems.add(problem.allowed(format!("1 or {count} values")));
            }
            _ => {}
        }
    }
    problems.finish().map_err(refused)?;
    Ok(axes)
}

/// Reports the first out-of-range values of an axis.
fn check(transmission: &Transmission, axis: Axis, values: &[f64], problems: &mut Problems) {
    let is_cvt = transmission.is_cvt();
    let (range, suffix) = axis.range_in(transmission);
    let is_gear = axis == Axis::Ratio && !is_cvt;
    let is_bad = |x: &f64| !range.contains(*x) || (is_gear && x.fract().abs() > 0.0);
    let bad = values.iter().enumerate().filter(|(_, x)| is_bad(x));
    for (row, x) in bad.take(MAX_DESCRIBED) {
        let message = format!("row {row}: {x} is out of range");
        let problem = Problem::out_of_range(message).key(column_of(axis, is_cvt));
        let allowed = range.in_unit(unit_of(suffix));
        problems.add(problem.value(x.to_string()).allowed(allowed));
    }
}

/// Losses of each component at points, given as doubles by column name.
#[pyfunction]
pub fn losses(
    py: Python<'_>,
    car: &Car,
    given: Vec<(String, Vec<u8>)>,
    threads: Option<usize>,
) -> PyResult<Table> {
    let transmission = car.setup.transmission();
    let axes = build_points(transmission, &given)?;
    let bench = Bench::as_printed(&car.setup);
    let solve = move |stop: &Stop| -> Vec<LossRow> {
        let row = |k: usize| {
            let asked = axes.each_ref().map(|values| values[k]);
            (!stop.stopped()).then(|| LossRow::new(&bench, asked))
        };
        let count = axes[0].len();
        (0..count).into_par_iter().filter_map(row).collect()
    };
    let rows = job(py, threads, Interrupted::Stops, solve)?;
    let column = |column: &_| TableColumn::from_rows(column, &rows, &[]);
    let columns = columns(transmission);
    Ok(Table::new(columns.iter().map(column).collect()))
}

/// Collects solved points.
#[derive(Default)]
struct SolvedPoints {
    with_case: bool,
    points: Vec<Point>,
}

impl Take for SolvedPoints {
    fn begin(&mut self, with_case: bool) -> Result<(), Problems> {
        self.with_case = with_case;
        Ok(())
    }

    fn put(&mut self, case: &str, row: &Solved) -> Result<(), Problems> {
        self.points.push((case.replace("\"\"", "\""), *row));
        Ok(())
    }
}

/// Evaluates the belt model at the points of a table, the text of a CSV file cited as `name`.
#[pyfunction]
pub fn belt(
    py: Python<'_>,
    car: &Car,
    name: String,
    text: Vec<u8>,
    named: &str,
    band_speed: Option<f64>,
) -> PyResult<Table> {
    let formulation = formulation(named)?;
    let Some(model) = Model::new(&car.setup, band_speed) else {
        return Err(bad(
            "car",
            &car.setup.name,
            "a car with a CVT",
            "this car has no belt",
        ));
    };
    let solve = move |_: &Stop| {
        let mut kept = SolvedPoints::default();
        let job = Job {
            model: Some(model),
            formulation,
            rows: &mut kept,
        };
        cvtcycle::validate::belt::read(&name, text.as_slice(), job).map(|_| kept)
    };
    let kept = job(py, Some(1), Interrupted::Detaches, solve)?.map_err(refused)?;
    let columns = output_columns(kept.with_case);
    let column = |column: &_| TableColumn::from_rows(column, &kept.points, &[]);
    Ok(Table::new(columns.iter().map(column).collect()))
}
