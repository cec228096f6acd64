//! A CSV file of points on the bench: settings, and what was measured there.

use super::sheet::{self, Measured, Sheet};
use crate::check::source::BENCH;
use crate::check::tables::bench;
use cvtcycle_config::csv::Column;
use cvtcycle_config::{Problems, to_si};
use cvtcycle_model::bench::{BenchPoint, Parts};

/// Prefix of the column of standard deviations.
pub const SD: &str = "sd_";

/// Columns of the bench that can be measured.
fn measurable() -> Vec<&'static str> {
    bench::columns()
        .into_iter()
        .filter(|name| !BENCH.iter().any(|(key, ..)| key == name))
        .collect()
}

/// Reads points as far as they can be understood, and all problems of the file.
pub fn read(file: &str, bytes: &[u8]) -> (Option<Sheet>, Problems) {
    let measurable = measurable();
    let settings = BENCH.iter().map(|(key, range, required, _)| {
        let column = Column::number(*key, *range);
        if *required {
            column.required()
        } else {
            column.or_empty()
        }
    });
    let columns = settings.chain(sheet::measured(&measurable)).collect();
    let measured = Measured {
        is_measured: &|name| measurable.contains(&name),
        example: "total_nm: the torque loss at the input shaft",
    };
    let names = "settings and columns of the bench: docs/calibration.md lists them";
    let (sheet, problems) = sheet::read(file, bytes, columns, names, Some(measured));
    (sheet, problems.finish())
}

/// Names of the measured columns of a sheet, and their indices.
pub fn measured(sheet: &Sheet) -> Vec<(usize, &str)> {
    let measurable = measurable();
    let named = sheet
        .columns
        .iter()
        .enumerate()
        .map(|(k, column)| (k, column.as_str()));
    named
        .filter(|(_, name)| measurable.contains(name))
        .collect()
}

/// The setting of the bench of each row.
pub fn points(sheet: &Sheet, parts: Parts) -> Vec<BenchPoint> {
    let column = |key: &str| sheet.find(key);
    let keys = [
        "ratio",
        "speed_rpm",
        "temp_degc",
        "torque_nm",
        "throttle",
        "pressure_bar",
        "pressure_factor",
        "belt_degc",
        "belt_above_sump_k",
    ];
    let columns = keys.map(column);
    (0..sheet.rows.len())
        .map(|row| {
            let given = |k: usize| sheet.number(row, columns[k]).map(|x| to_si(keys[k], x));
            let default = BenchPoint::default();
            let sump_k = given(2).unwrap_or(default.sump_k);
            BenchPoint {
                ratio: given(0).unwrap_or(default.ratio),
                input_rad_s: given(1).unwrap_or(default.input_rad_s),
                sump_k,
                output_nm: given(3).unwrap_or(0.0),
                throttle: given(4).unwrap_or(0.0),
                pressure_pa: given(5),
                pressure_factor: given(6).unwrap_or(1.0),
                belt_k: given(7).or(given(8).map(|above| sump_k + above)),
                parts,
            }
        })
        .collect()
}
