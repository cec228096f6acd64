//! A fluid over temperature as a table.

use std::rc::Rc;

use super::{Column, Marks, Rows};
use crate::expr::Table;
use crate::keys::FLUID;
use crate::source::Source;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::lubricant::{Lubricant, ZERO_DEGC_K};

/// Oil and temperature in K.
type Point = (Rc<Lubricant>, f64);

/// Columns.
pub fn columns() -> Vec<Column<Point>> {
    columns! { Point;
    "temp_degc" (_, k) => k - ZERO_DEGC_K;
    "kinematic_mm2_s" (oil, k) => oil.kinematic_m2_s(*k) * 1e6;
    "dynamic_mpa_s" (oil, k) => oil.dynamic_pa_s(*k) * 1e3;
    "density_kg_m3" (oil, k) => oil.density_kg_m3(*k);
    "heat_capacity_kj_kgk" (oil, k) => oil.heat_capacity_j_kgk(*k) / 1e3;
    }
}

/// All temperatures of the source for the transmission oil.
pub fn table(source: &Source, setup: &Setup) -> Table {
    let oil = Rc::new(setup.oils().0.clone());
    let temperatures = source.axis(&FLUID.temp_degc);
    let mut rows = Rows::new(temperatures.len());
    for k in temperatures {
        rows.add((oil.clone(), k), &Marks::default());
    }
    rows.by(columns())
}
