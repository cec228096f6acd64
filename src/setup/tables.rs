//! Tables that vehicle files name or hold: curves, viscosity, BSFC and loss maps.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::{Files, embedded_map};
use crate::config::{Place, Problem, Section, decode, near, to_si};
use crate::engine::BsfcMap;
use crate::lubricant::Viscosity;
use crate::numeric::{Curve, GRID_AXES, Grid};
use crate::transmission::loss_map::LossMap;

/// A curve from two-column rows; a problem at `key` if they do not make one.
#[must_use]
pub fn curve(s: &Section, key: &str, rows: &[Vec<f64>]) -> Curve {
    let points: Vec<(f64, f64)> = rows.iter().map(|r| (r[0], r[1])).collect();
    Curve::new(&points).unwrap_or_else(|why| {
        s.complain(key, "rows [x, y] with rising x", &why, "");
        Curve::constant(1.0)
    })
}

/// Viscosity from values at 40 and 100 degC; a problem at `key` if they do not make one.
#[must_use]
pub fn viscosity(s: &Section, key: &str, kv40: f64, kv100: f64) -> Viscosity {
    let points = [(313.15, kv40), (373.15, kv100)];
    Viscosity::new(&points).unwrap_or_else(|why| {
        if kv40.is_finite() && kv100.is_finite() {
            s.complain(key, "", &why, "check the two values and their unit, mm2/s (cSt)");
        }
        Viscosity::new(&[(313.15, 36e-6), (373.15, 7.2e-6)]).unwrap_or_else(|_| unreachable!("constant points"))
    })
}

/// One column of a CSV table: name, and range in its own unit.
struct Column {
    name: &'static str,
    low: f64,
    high: f64,
}

/// A CSV of numbers with a header, read whole, and the map that was made of it.
#[derive(Debug)]
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
    loss: OnceLock<LossMap>,
    /// With the bits of heating value and displacement, which are parts of its numbers.
    bsfc: Mutex<Option<([u64; 2], BsfcMap)>>,
}

fn problem(file: &str, line: usize, key: &str, value: &str, allowed: &str, message: String, hint: &str) -> Problem {
    Problem {
        place: Place { file: file.to_owned(), line, ..Place::default() },
        key: key.to_owned(),
        value: value.to_owned(),
        allowed: allowed.to_owned(),
        message,
        hint: hint.to_owned(),
    }
}

fn unknown_column(file: &str, name: &str, columns: &[Column]) -> Option<Problem> {
    if columns.iter().any(|c| c.name == name) {
        return None;
    }
    let close = near(name, columns.iter().map(|c| c.name));
    let all: Vec<&str> = columns.iter().map(|c| c.name).collect();
    let hint = if close.is_empty() { String::new() } else { format!("did you mean {}?", close.join(", ")) };
    Some(problem(file, 1, name, name, &all.join(", "), format!("unknown column `{name}`"), &hint))
}

/// All problems with line, column and value.
fn numbers(file: &str, bytes: &[u8], columns: &[Column]) -> Result<Table, Vec<Problem>> {
    let text = decode(file, bytes)?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let mut problems = Vec::new();
    let names: Vec<String> = reader.headers().map(|h| h.iter().map(str::to_owned).collect()).unwrap_or_default();
    if names.len() == 1 && names[0].contains(';') {
        return Err(vec![problem(
            file,
            1,
            "",
            &names[0],
            "",
            "the file uses `;` between columns".into(),
            "save it with commas between columns and decimal points",
        )]);
    }
    problems.extend(names.iter().filter_map(|name| unknown_column(file, name, columns)));
    let mut rows = Vec::new();
    for record in reader.records() {
        let Ok(record) = record else { continue };
        let line = record.position().map_or(0, |p| p.line() as usize);
        if record.len() != names.len() {
            problems.push(problem(
                file,
                line,
                "",
                "",
                &format!("{} fields", names.len()),
                format!("the row has {} fields", record.len()),
                "",
            ));
            continue;
        }
        let values = names.iter().zip(record.iter()).map(|(name, cell)| {
            let value: f64 = cell.parse().unwrap_or(f64::NAN);
            let range = columns.iter().find(|c| c.name == name).map_or((f64::MIN, f64::MAX), |c| (c.low, c.high));
            if !(range.0 <= value && value <= range.1) {
                problems.push(problem(
                    file,
                    line,
                    name,
                    cell,
                    &format!("a number from {} to {}", range.0, range.1),
                    format!("`{cell}` in column {name}"),
                    "",
                ));
            }
            value
        });
        rows.push(values.collect());
        if problems.len() > 50 {
            break;
        }
    }
    if rows.is_empty() && problems.is_empty() {
        problems.push(problem(file, 1, "", "", "a header and rows", "the file has no rows".into(), ""));
    }
    if problems.is_empty() { Ok(Table { names, rows, loss: OnceLock::new(), bsfc: Mutex::default() }) } else { Err(problems) }
}

impl Table {
    fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }
}

fn read(s: &Section, key: &str, file: &str, files: &dyn Files, columns: &[Column]) -> Option<Arc<Table>> {
    let mut make = || {
        let read;
        let bytes = match embedded_map(file) {
            Some(text) => text.as_bytes(),
            None => match files.read(file) {
                Ok(bytes) => {
                    read = bytes;
                    read.as_slice()
                }
                Err(why) => {
                    s.complain(
                        key,
                        "a readable CSV file",
                        &format!("cannot read `{file}`: {why}"),
                        "the path is relative to the vehicle file",
                    );
                    return None;
                }
            },
        };
        numbers(file, bytes, columns).map(Arc::new).map_err(|problems| problems.into_iter().for_each(|p| s.report_problem(p))).ok()
    };
    files.table(columns[0].name, file, &mut make)
}

/// A BSFC map from CSV; none after a problem.
#[must_use]
pub fn bsfc_map(s: &Section, file: &str, files: &dyn Files, heating_value_j_kg: f64, displacement_m3: f64) -> Option<BsfcMap> {
    let columns = [
        Column { name: "speed_rpm", low: 100.0, high: 20_000.0 },
        Column { name: "bmep_bar", low: 0.05, high: 40.0 },
        Column { name: "torque_nm", low: 0.1, high: 5000.0 },
        Column { name: "bsfc_g_kwh", low: 100.0, high: 3000.0 },
    ];
    let table = read(s, "file", file, files, &columns)?;
    let scale = [heating_value_j_kg.to_bits(), displacement_m3.to_bits()];
    let mut made = table.bsfc.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, map)) = made.as_ref().filter(|(of, _)| *of == scale) {
        return Some(map.clone());
    }
    let (speed, bsfc) = (table.index("speed_rpm"), table.index("bsfc_g_kwh"));
    let load = table.index("bmep_bar").map(|i| (i, 1e5));
    let per_torque = 4.0 * std::f64::consts::PI / displacement_m3;
    let load = load.or_else(|| table.index("torque_nm").map(|i| (i, per_torque)));
    let (Some(speed), Some(bsfc), Some((load, factor))) = (speed, bsfc, load) else {
        s.complain(
            "file",
            "speed_rpm, bmep_bar or torque_nm, bsfc_g_kwh",
            "a column is missing in the BSFC map",
            "name the columns with their units",
        );
        return None;
    };
    let rows: Vec<(f64, f64, f64)> = table.rows.iter().map(|r| (to_si("speed_rpm", r[speed]), r[load] * factor, r[bsfc] / 3.6e9)).collect();
    let map = BsfcMap::from_rows(&rows, heating_value_j_kg).map_err(|why| s.complain("file", "a full grid", &why, "")).ok()?;
    *made = Some((scale, map.clone()));
    Some(map)
}

/// A measured torque-loss map from CSV where `key` names one; `first` is the name of its first axis, `ratio` or `gear`.
#[must_use]
pub fn loss_map(s: &Section, key: &str, doc: &str, files: &dyn Files, first: &'static str) -> Option<LossMap> {
    let file = s.optional_text(key, doc)?;
    let torque = if first == "gear" { "input_torque_nm" } else { "output_torque_nm" };
    let columns = [
        Column { name: first, low: 0.2, high: 12.0 },
        Column { name: "input_speed_rpm", low: 0.0, high: 20_000.0 },
        Column { name: torque, low: -3000.0, high: 3000.0 },
        Column { name: "secondary_pressure_bar", low: 0.0, high: 200.0 },
        Column { name: "oil_temp_degc", low: -60.0, high: 200.0 },
        Column { name: "torque_loss_nm", low: 0.0, high: 1000.0 },
    ];
    let table = read(s, key, &file, files, &columns)?;
    if let Some(map) = table.loss.get() {
        return Some(map.clone());
    }
    let Some(loss) = table.index("torque_loss_nm") else {
        s.complain(key, "", "the map has no column torque_loss_nm", "losses are torques at the box's input shaft, Nm");
        return None;
    };
    let axes: Vec<Option<usize>> = columns[..GRID_AXES].iter().map(|c| table.index(c.name)).collect();
    let rows: Vec<([f64; GRID_AXES], f64)> = table
        .rows
        .iter()
        .map(|r| {
            let mut x = [0.0; GRID_AXES];
            for (k, axis) in axes.iter().enumerate() {
                x[k] = axis.map_or(0.0, |i| to_si(columns[k].name, r[i]));
            }
            (x, r[loss])
        })
        .collect();
    let why = "every combination of the columns' values must stand once";
    let grid = Grid::from_rows(&rows).map_err(|wrong| s.complain(key, "a full grid", &wrong, why)).ok()?;
    Some(table.loss.get_or_init(|| LossMap::new(grid)).clone())
}
