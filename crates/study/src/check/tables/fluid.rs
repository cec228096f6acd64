//! A fluid over temperature as a table.

use super::{Marks, Table, from_rows};
use crate::check::source::Source;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::fluid::ZERO_DEGC_K;

/// Names of the columns.
pub fn columns() -> Vec<&'static str> {
    vec![
        "temp_degc",
        "kinematic_mm2_s",
        "dynamic_mpa_s",
        "density_kg_m3",
        "heat_capacity_kj_kgk",
    ]
}

/// Computes all temperatures for the transmission oil.
pub fn table(source: &Source, setup: &Setup) -> Table {
    let oil = setup.oils().0;
    let rows = source.axis("temp_degc", f64::NAN).into_iter().map(|k| {
        let row = vec![
            k - ZERO_DEGC_K,
            oil.kinematic_m2_s(k) * 1e6,
            oil.dynamic_pa_s(k) * 1e3,
            oil.density_kg_m3(k),
            oil.heat_capacity_j_kgk(k) / 1e3,
        ];
        (row, 1.0)
    });
    from_rows(5, rows, Marks::default())
}
