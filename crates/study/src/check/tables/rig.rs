//! The transmission rig's transients and strip-down as tables.

use super::bench::{self, row};
use super::{Marks, Table, from_rows, rpm, truth};
use crate::check::source::Source;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::bench::transmission::{Branch, Conditions, Piece, Plan, strip_down, transient};
use cvtcycle_model::bench::{Bench, BenchPoint};
use cvtcycle_model::fluid::ZERO_DEGC_K;

/// Columns of a transient before those of the bench.
const TRANSIENT: [&str; 4] = ["time_s", "cooling", "metal_degc", "gap_nm"];

const STRIP_DOWN: [&str; 18] = [
    "ratio",
    "speed_rpm",
    "temp_degc",
    "pump_found_nm",
    "pump_true_nm",
    "pump_interaction_nm",
    "input_shaft_found_nm",
    "input_shaft_true_nm",
    "input_shaft_interaction_nm",
    "clutch_drag_found_nm",
    "clutch_drag_true_nm",
    "clutch_drag_interaction_nm",
    "belt_found_nm",
    "belt_true_nm",
    "belt_interaction_nm",
    "final_drive_found_nm",
    "final_drive_true_nm",
    "final_drive_interaction_nm",
];

/// Names of the columns of a transient.
pub fn transient_columns() -> Vec<&'static str> {
    TRANSIENT.into_iter().chain(bench::columns()).collect()
}

/// Names of the columns of a strip-down.
pub fn strip_down_columns() -> Vec<&'static str> {
    STRIP_DOWN.to_vec()
}

/// Warm-up and cooling at each ratio, a row a second.
pub fn transients(
    source: &Source,
    setup: &Setup,
    conditions: &Conditions,
) -> Result<Table, String> {
    let bench = Bench::new(setup);
    let ratios = source.axis("ratio", conditions.low_ratio);
    cvt_only(&bench, &ratios)?;
    let mut rows = Vec::new();
    for ratio in ratios {
        let result = transient(&bench, conditions, ratio);
        for m in &result.moments {
            let point = BenchPoint {
                ratio,
                input_rad_s: conditions.transient.speed_rad_s,
                throttle: conditions.throttle,
                sump_k: m.sump_k,
                ..BenchPoint::default()
            };
            let gap_nm = result.gap_nm(m.sump_k).unwrap_or(f64::NAN);
            let head = [
                m.time_s,
                truth(m.branch == Branch::Cooling),
                m.metal_k - ZERO_DEGC_K,
                gap_nm,
            ];
            rows.push((
                head.into_iter()
                    .chain(row(&point, &m.answer))
                    .collect::<Vec<f64>>(),
                1.0,
            ));
        }
    }
    let count = TRANSIENT.len() + bench::GROSS;
    Ok(from_rows(
        count,
        rows.into_iter(),
        Marks {
            gross: Some(count),
            outside: Some(TRANSIENT.len() + bench::OUTSIDE),
        },
    ))
}

/// The box taken apart, a row a point.
pub fn strip_downs(
    source: &Source,
    setup: &Setup,
    conditions: &Conditions,
) -> Result<Table, String> {
    let bench = Bench::new(setup);
    let own = Plan::of(conditions);
    let plan = Plan {
        ratios: source.axis_or_none("ratio").unwrap_or(own.ratios),
        speeds_rad_s: source.axis_or_none("speed_rpm"),
        oil_k: source.axis_or_none("temp_degc").unwrap_or(own.oil_k),
        torques_nm: own.torques_nm,
    };
    cvt_only(&bench, &plan.ratios)?;
    let rows = strip_down(&bench, conditions, &plan)
        .into_iter()
        .map(|found| {
            let head = [
                found.set.ratio,
                rpm(found.set.input_rad_s),
                found.set.sump_k - ZERO_DEGC_K,
            ];
            let pieces = Piece::ALL
                .map(|piece| found.piece(piece))
                .map(|f| [f.corrected_nm, f.true_nm, f.interaction_nm()]);
            (
                head.into_iter()
                    .chain(pieces.into_iter().flatten())
                    .collect(),
                1.0,
            )
        });
    Ok(from_rows(STRIP_DOWN.len(), rows, Marks::default()))
}

fn cvt_only(bench: &Bench, ratios: &[f64]) -> Result<(), String> {
    let cvt = bench.cvt().ok_or("the transmission rig is for a CVT")?;
    ratios
        .iter()
        .try_for_each(|ratio| super::belt::fits(&cvt.belt, *ratio))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_after_the_pieces() {
        let named = Piece::ALL.iter().flat_map(|p| {
            ["found", "true", "interaction"].map(|what| format!("{}_{what}_nm", p.name()))
        });
        assert_eq!(STRIP_DOWN[3..].to_vec(), named.collect::<Vec<String>>());
    }
}
