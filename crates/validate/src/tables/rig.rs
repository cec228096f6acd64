//! The transmission rig's transients and strip-down as tables.

use std::rc::Rc;
use std::sync::LazyLock;

use super::bench;
use super::{Marks, Rows, rpm};
use crate::expr::{Table, truth};
use crate::keys::{STRIP_DOWN, TRANSIENT};
use crate::source::Source;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::rig::Bench;
use cvtcycle_model::rig::transmission::{
    Branch, Conditions, Moment, Piece, Plan, strip_down, transient,
};

/// Columns of a transient before those of the bench.
const OF_MOMENT: [&str; 4] = ["time_s", "cooling", "metal_degc", "gap_nm"];

/// Columns of a strip-down before those of the pieces.
const OF_POINT: [&str; 3] = ["ratio", "speed_rpm", "temp_degc"];

/// What is computed of a piece.
const OF_PIECE: [&str; 3] = ["found", "true", "interaction"];

static PIECES: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let of_piece = |p: &Piece| OF_PIECE.map(|what| &*format!("{}_{what}_nm", p.name()).leak());
    Piece::ALL.iter().flat_map(of_piece).collect()
});

/// Names of the columns of a transient.
pub fn transient_columns() -> Vec<&'static str> {
    OF_MOMENT.into_iter().chain(bench::columns()).collect()
}

/// Names of the columns of a strip-down.
pub fn strip_down_columns() -> Vec<&'static str> {
    OF_POINT.into_iter().chain(PIECES.iter().copied()).collect()
}

/// Warm-up and cooling at each ratio, a row a second.
pub fn transients(
    source: &Source,
    setup: &Setup,
    conditions: &Conditions,
) -> Result<Table, String> {
    let bench = Bench::new(setup);
    let ratios = source.axis(&TRANSIENT.ratio);
    cvt_only(&bench, &ratios)?;
    let mut rows = Rows::new(0);
    for ratio in ratios {
        let result = Rc::new(transient(&bench, conditions, ratio));
        for (second, m) in result.moments.iter().enumerate() {
            rows.add((result.clone(), second), &bench::marks(&m.answer));
        }
    }
    let width = OF_MOMENT.len() + bench::width();
    Ok(rows.table(width, |(result, second), column| {
        let m: &Moment = &result.moments[*second];
        match column {
            0 => m.time_s,
            1 => truth(m.branch == Branch::Cooling),
            2 => m.metal_k - ZERO_DEGC_K,
            3 => result.gap_nm(m.sump_k).unwrap_or(f64::NAN),
            of_bench => bench::number(&m.answer, of_bench - OF_MOMENT.len()),
        }
    }))
}

/// The box taken apart, a row a point.
pub fn strip_downs(
    source: &Source,
    setup: &Setup,
    conditions: &Conditions,
) -> Result<Table, String> {
    let bench = Bench::new(setup);
    let own = Plan::from_conditions(conditions);
    let plan = Plan {
        ratios: source.given(&STRIP_DOWN.ratio).unwrap_or(own.ratios),
        speeds_rad_s: source.given(&STRIP_DOWN.speed_rpm),
        oil_k: source.given(&STRIP_DOWN.temp_degc).unwrap_or(own.oil_k),
        torques_nm: own.torques_nm,
    };
    cvt_only(&bench, &plan.ratios)?;
    let found = strip_down(&bench, conditions, &plan);
    let mut rows = Rows::new(found.len());
    for found in found {
        let set = &found.set;
        let head = [set.ratio, rpm(set.input_rad_s), set.sump_k - ZERO_DEGC_K];
        let pieces = Piece::ALL.iter().flat_map(|piece| {
            let f = found.piece(*piece);
            [f.corrected_nm, f.true_nm, f.interaction_nm()]
        });
        let numbers: Vec<f64> = head.into_iter().chain(pieces).collect();
        rows.add(numbers, &Marks::default());
    }
    let width = OF_POINT.len() + PIECES.len();
    Ok(rows.table(width, |numbers, column| numbers[column]))
}

fn cvt_only(bench: &Bench, ratios: &[f64]) -> Result<(), String> {
    let cvt = bench.cvt().ok_or("the transmission rig is for a CVT")?;
    let mut ratios = ratios.iter();
    ratios.try_for_each(|ratio| super::belt::fits(&cvt.belt, *ratio))
}
