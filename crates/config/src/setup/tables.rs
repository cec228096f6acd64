//! Tables that vehicle files name: BSFC and loss maps.

use std::io::ErrorKind;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::Files;
use super::map_csv::{self, Column, Form};
use crate::Section;
use crate::bounded::ReadError;
use crate::embedded;
use cvtcycle_model::engine::BsfcMap;
use cvtcycle_model::keys::Quantity;
use cvtcycle_model::math::{GRID_AXES, Grid};
use cvtcycle_model::transmission::loss_map::LossMap;

/// A CSV of numbers with a header, read whole, and the map that was made of it.
#[derive(Debug)]
pub struct Table {
    names: Vec<&'static str>,
    rows: Vec<Vec<f64>>,
    loss: OnceLock<LossMap>,
    /// With the bits of heating value and displacement, which are parts of its numbers.
    bsfc: Mutex<Option<([u64; 2], BsfcMap)>>,
}

impl Table {
    fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| *n == name)
    }
}

fn read(s: &Section, key: &str, file: &str, form: &Form) -> Option<Arc<Table>> {
    if file.trim().is_empty() {
        s.complain(
            key,
            "a CSV file",
            "the name of the map is empty",
            "name its file, or remove the key",
        );
        return None;
    }
    let mut make = || {
        let read;
        let bytes = match embedded::text(embedded::maps(), file) {
            Some(text) => text.as_bytes(),
            None => match fetch(s.reader.files, file) {
                Ok(bytes) => {
                    read = bytes;
                    read.as_slice()
                }
                Err(why) => {
                    s.complain(
                        key,
                        &why.allowed("a readable CSV file"),
                        &format!("cannot read `{file}`: {why}"),
                        why.hint("the path is relative to the vehicle file"),
                    );
                    return None;
                }
            },
        };
        match map_csv::read(file, bytes, form) {
            Ok(map) => Some(Arc::new(Table {
                names: map.names,
                rows: map.rows,
                loss: OnceLock::new(),
                bsfc: Mutex::default(),
            })),
            Err(problems) => {
                problems
                    .into_iter()
                    .for_each(|problem| s.report_problem(problem));
                None
            }
        }
    };
    match s.reader.files {
        Some(files) => files.table(form.columns[0].name, file, &mut make),
        None => make(),
    }
}

fn fetch(files: Option<&dyn Files>, file: &str) -> Result<Vec<u8>, ReadError> {
    let none = || ReadError::Unreadable(ErrorKind::NotFound.into());
    files.ok_or_else(none)?.fetch(file)
}

/// What helps with a BSFC map that does not hang together.
const GRID: &str = "give at least two speeds and two loads; more torque needs more fuel";

/// A BSFC map from CSV, without friction; none after a problem.
#[must_use]
pub fn bsfc_map(
    s: &Section,
    key: &str,
    file: &str,
    heating_value_j_kg: f64,
    displacement_m3: f64,
) -> Option<BsfcMap> {
    let columns = [
        Column {
            name: "speed_rpm",
            low: 100.0,
            high: 20_000.0,
        },
        Column {
            name: "bmep_bar",
            low: 0.05,
            high: 40.0,
        },
        Column {
            name: "torque_nm",
            low: 0.1,
            high: 5000.0,
        },
        Column {
            name: "bsfc_g_kwh",
            low: 100.0,
            high: 3000.0,
        },
    ];
    let required: [&[&str]; 3] = [&["speed_rpm"], &["bmep_bar", "torque_nm"], &["bsfc_g_kwh"]];
    let table = read(
        s,
        key,
        file,
        &Form {
            columns: &columns,
            required: &required,
        },
    )?;
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
        return None;
    };
    let rpm = Quantity::of("speed_rpm");
    let rows: Vec<(f64, f64, f64)> = table
        .rows
        .iter()
        .map(|r| (rpm.to_si(r[speed]), r[load] * factor, r[bsfc] / 3.6e9))
        .collect();
    let map = BsfcMap::from_rows(&rows, heating_value_j_kg, (0.0, 0.0))
        .map_err(|why| s.complain(key, "a map of fuel over speed and load", &why, GRID))
        .ok()?;
    *made = Some((scale, map.clone()));
    Some(map)
}

/// A measured torque-loss map from CSV; `first` is the name of its first axis, `ratio` or `gear`.
#[must_use]
pub fn loss_map(s: &Section, key: &str, file: &str, first: &'static str) -> Option<LossMap> {
    let torque = if first == "gear" {
        "input_torque_nm"
    } else {
        "output_torque_nm"
    };
    let columns = [
        Column {
            name: first,
            low: 0.2,
            high: 12.0,
        },
        Column {
            name: "input_speed_rpm",
            low: 0.0,
            high: 20_000.0,
        },
        Column {
            name: torque,
            low: -3000.0,
            high: 3000.0,
        },
        Column {
            name: "secondary_pressure_bar",
            low: 0.0,
            high: 200.0,
        },
        Column {
            name: "oil_temp_degc",
            low: -60.0,
            high: 200.0,
        },
        Column {
            name: "torque_loss_nm",
            low: 0.0,
            high: 1000.0,
        },
    ];
    let table = read(
        s,
        key,
        file,
        &Form {
            columns: &columns,
            required: &[&["torque_loss_nm"]],
        },
    )?;
    if let Some(map) = table.loss.get() {
        return Some(map.clone());
    }
    let loss = table.index("torque_loss_nm")?;
    let axes: Vec<(Option<usize>, Quantity)> = columns[..GRID_AXES]
        .iter()
        .map(|c| (table.index(c.name), Quantity::of(c.name)))
        .collect();
    let rows: Vec<([f64; GRID_AXES], f64)> = table
        .rows
        .iter()
        .map(|r| {
            let mut x = [0.0; GRID_AXES];
            for (x, (axis, quantity)) in x.iter_mut().zip(&axes) {
                *x = axis.map_or(0.0, |i| quantity.to_si(r[i]));
            }
            (x, r[loss])
        })
        .collect();
    let why = "every combination of the columns' values must stand once";
    let grid = Grid::from_rows(&rows)
        .map_err(|wrong| s.complain(key, "a full grid", &wrong, why))
        .ok()?;
    Some(table.loss.get_or_init(|| LossMap::new(grid)).clone())
}
