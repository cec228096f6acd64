//! A CSV file of points on the bench: settings, and what was measured there.

use super::sheet::{self, Measured, Sheet};
use crate::check::source::Kind;
use crate::check::tables::bench::{self, SETTINGS};
use cvtcycle_config::Problems;
use cvtcycle_config::csv::Column;
use cvtcycle_model::bench::{BenchPoint, Parts};
use cvtcycle_model::keys::Presence;

/// Reads points as far as they can be understood, and all problems of the file.
pub fn read(file: &str, bytes: &[u8]) -> (Option<Sheet>, Problems) {
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
pub fn points(sheet: &Sheet, parts: Parts) -> Vec<BenchPoint> {
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
