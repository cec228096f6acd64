//! A transmission on the bench as a table.

use super::{Marks, Table, combinations, from_rows, rpm, truth};
use crate::check::source::Source;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::bench::{Bench, BenchAnswer, BenchPoint, Parts};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_output::{Component, Flags};

/// Components in the order of [`Component::ALL`] as columns.
const COMPONENTS: [&str; Component::COUNT] = [
    "launch_clutch_nm",
    "pump_nm",
    "input_shaft_nm",
    "clutch_drag_nm",
    "belt_band_nm",
    "belt_film_nm",
    "belt_slip_nm",
    "belt_wedge_nm",
    "belt_penetration_nm",
    "belt_map_nm",
    "final_drive_nm",
    "gear_mesh_nm",
    "bearing_nm",
    "churning_nm",
    "seal_nm",
    "box_map_nm",
];

const OTHERS: [&str; 21] = [
    "ratio",
    "speed_rpm",
    "temp_degc",
    "torque_nm",
    "throttle",
    "pressure_factor",
    "total_nm",
    "belt_nm",
    "input_torque_nm",
    "input_power_w",
    "efficiency_percent",
    "output_speed_rpm",
    "pressure_bar",
    "belt_degc",
    "belt_above_sump_k",
    "slip_percent",
    "capacity_nm",
    "flow_l_min",
    "segment_compression_n",
    "flow_limited",
    "outside_validity",
];

/// Index of the mark of points outside validity.
pub const OUTSIDE: usize = OTHERS.len() - 1;
/// Index of gross slip behind the named columns.
pub const GROSS: usize = OTHERS.len() + Component::COUNT;

/// Names of the columns.
pub fn columns() -> Vec<&'static str> {
    OTHERS.into_iter().chain(COMPONENTS).collect()
}

/// Solves all points.
pub fn table(source: &Source, setup: &Setup) -> Result<Table, String> {
    let bench = Bench::new(setup);
    let parts = parts(source);
    let ratios = source.axis("ratio", 1.0);
    fits(&bench, &ratios)?;
    let nan = || vec![f64::NAN];
    let axes = [
        ratios,
        source.axis("torque_nm", 0.0),
        source.axis("throttle", 0.0),
        source.axis_or_none("pressure_bar").unwrap_or_else(nan),
        source.axis("pressure_factor", 1.0),
        source.axis_or_none("belt_degc").unwrap_or_else(nan),
        source.axis_or_none("belt_above_sump_k").unwrap_or_else(nan),
        source.axis("temp_degc", ZERO_DEGC_K + 75.0),
        source.axis("speed_rpm", f64::NAN),
    ];
    let given = |x: f64| (!x.is_nan()).then_some(x);
    let points = combinations(&axes).into_iter().map(|x| BenchPoint {
        ratio: x[0],
        output_nm: x[1],
        throttle: x[2],
        pressure_pa: given(x[3]),
        pressure_factor: x[4],
        belt_k: given(x[5]).or(given(x[6] + x[7])),
        sump_k: x[7],
        input_rad_s: x[8],
        parts,
    });
    Ok(solved(&bench, points))
}

/// Parts in the box.
pub fn parts(source: &Source) -> Parts {
    let has = |part: &str| !source.without.iter().any(|other| other == part);
    Parts {
        final_drive: has("final_drive"),
        belt: has("belt"),
        reverse_clutch: has("reverse_clutch"),
        pump: has("pump"),
    }
}

/// Solves points that were not made from axes.
///
/// # Errors
/// A sentence: a ratio or gear that the box does not have.
pub fn of_points(points: &[BenchPoint], setup: &Setup) -> Result<Table, String> {
    let bench = Bench::new(setup);
    fits(
        &bench,
        &points.iter().map(|point| point.ratio).collect::<Vec<f64>>(),
    )?;
    Ok(solved(&bench, points.iter().copied()))
}

fn solved(bench: &Bench, points: impl Iterator<Item = BenchPoint>) -> Table {
    let rows = points.map(|point| (row(&point, &bench.solve(&point)), 1.0));
    from_rows(
        GROSS,
        rows,
        Marks {
            gross: Some(GROSS),
            outside: Some(OUTSIDE),
        },
    )
}

/// Whether the box has these ratios or gears.
fn fits(bench: &Bench, ratios: &[f64]) -> Result<(), String> {
    match &bench.car().transmission {
        Transmission::Cvt(cvt) => ratios
            .iter()
            .try_for_each(|ratio| super::belt::fits(&cvt.belt, *ratio)),
        Transmission::Manual(manual) => {
            let gears = manual.overall.len();
            let good =
                |ratio: &f64| ratio.fract().abs() <= 0.0 && *ratio >= 1.0 && *ratio <= gears as f64;
            if ratios.iter().all(good) {
                Ok(())
            } else {
                Err(format!(
                    "the box has the gears 1 to {gears}: give one as `ratio`"
                ))
            }
        }
    }
}

/// Numbers of a point: the columns, then gross slip.
pub fn row(p: &BenchPoint, a: &BenchAnswer) -> Vec<f64> {
    let input_w = a.input_nm * p.input_rad_s;
    let output_w = p.output_nm * a.output_rad_s;
    let efficiency = if p.output_nm < 0.0 {
        input_w / output_w
    } else {
        output_w / input_w
    };
    let head = [
        p.ratio,
        rpm(p.input_rad_s),
        p.sump_k - ZERO_DEGC_K,
        p.output_nm,
        p.throttle,
        p.pressure_factor,
        a.total_nm(),
        a.belt_nm(),
        a.input_nm,
        input_w,
        100.0 * efficiency,
        rpm(a.output_rad_s),
        a.secondary_pa / 1e5,
        a.belt_k - ZERO_DEGC_K,
        a.belt_k - p.sump_k,
        a.belt.map_or(f64::NAN, |belt| 100.0 * belt.slip_total),
        a.belt.map_or(f64::NAN, |belt| belt.capacity_nm),
        a.oil_flow_m3_s * 6e4,
        a.belt.map_or(f64::NAN, |belt| belt.tension.compression_n),
        truth(a.flags.contains(Flags::FLOW_LIMITED)),
        truth(a.flags.contains(Flags::OUTSIDE_VALIDITY)),
    ];
    let gross = truth(a.flags.contains(Flags::GROSS_SLIP));
    head.into_iter().chain(a.loss_nm).chain([gross]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_after_the_components() {
        let names: Vec<String> = Component::ALL
            .iter()
            .map(|c| format!("{}_nm", c.name()))
            .collect();
        assert_eq!(COMPONENTS.to_vec(), names);
    }
}
