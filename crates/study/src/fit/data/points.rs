//! A CSV file of points on the bench: settings, and what was measured there.

use super::sheet::{self, Column, Rules, Sheet};
use super::unknown;
use crate::check::source::BENCH;
use crate::check::tables::bench;
use cvtcycle_config::{Bound, Problems, to_si};
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
    let settings: Vec<&str> = BENCH.iter().map(|(key, ..)| *key).collect();
    let known = |name: &str| {
        let column = |range, may_be_empty| {
            Ok(Column {
                name: name.to_owned(),
                range: Some(range),
                may_be_empty,
            })
        };
        if let Some((_, range, required, _)) = BENCH.iter().find(|(key, ..)| *key == name) {
            return column(*range, !*required);
        }
        let (range, measured) = match name.strip_prefix(SD) {
            Some(rest) => (Bound::positive(), rest),
            None => (Bound::any(), name),
        };
        if measurable.contains(&measured) {
            return column(range, true);
        }
        let all: Vec<&str> = settings.iter().chain(&measurable).copied().collect();
        Err(unknown(
            measured,
            &all,
            "settings and columns of the bench: docs/calibration.md lists them",
        ))
    };
    let required: Vec<&str> = BENCH
        .iter()
        .filter(|(_, _, required, _)| *required)
        .map(|(key, ..)| *key)
        .collect();
    let measured = |name: &str| measurable.contains(&name);
    let example = "total_nm: the torque loss at the input shaft";
    let rules = Rules {
        known: &known,
        required: &required,
        is_measured: Some(&measured),
        example,
    };
    let (sheet, problems) = sheet::read(file, bytes, &rules);
    (sheet, problems.finish())
}

/// Names of the measured columns of a sheet, and their indices.
pub fn measured(sheet: &Sheet) -> Vec<(usize, &str)> {
    let measurable = measurable();
    let named = sheet
        .columns
        .iter()
        .enumerate()
        .map(|(k, column)| (k, column.name.as_str()));
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
