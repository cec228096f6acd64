//! Every equation of the loss, engine and heat models once more, written down from the tables at the heads of the model files with the
//! standard library's functions, against what the program computes: inside each regime and on both sides of each of its bounds.
//!
//! Truth: the labelled statements, and arithmetic. A changed sign, factor, exponent, bound or constant fails here (docs/mutation.md).
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::too_many_lines,
    reason = "tests; some equalities hold to the last bit"
)]

use cvtcycle_model::engine::EngineAtTemperature;
use cvtcycle_model::equations::EQUATIONS;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::transmission::cvt::Cvt;

mod belt;
mod bench;
mod chain;
mod circuit;
mod clamp;
mod control;
mod drive;
mod engine;
mod fluid;
mod fuel;
mod gear_train;
mod heat;
mod manual;
mod point;
mod rig;
mod road;
mod rows;
mod spin;
mod transition;

/// RC-3 with EN-8: three passes from the speed of greatest power, each with the part of the hot line that is left at the speed before.
pub fn route_rad_s(cvt: &Cvt, engine: &EngineAtTemperature, power_w: f64) -> f64 {
    let mut speed = engine.engine.peak_power_rad_s();
    for _ in 0..3 {
        let left = engine.full_load_nm(speed) / engine.engine.full_load.at(speed);
        speed = cvt.full_load_route.at(power_w / left);
    }
    speed
}

/// Equal to rounding: two ways of one sum.
#[track_caller]
pub fn same(got: f64, want: f64) {
    assert!(
        (got - want).abs() <= 1e-11 * want.abs() + 1e-13,
        "{got} instead of {want}"
    );
}

/// Equal but for `share`.
#[track_caller]
pub fn near(got: f64, want: f64, share: f64) {
    assert!(
        (got - want).abs() <= share * want.abs(),
        "{got} instead of {want}"
    );
}

#[test]
fn every_line_has_a_statement_and_a_status() {
    assert!(EQUATIONS.len() > 80, "{}", EQUATIONS.len());
    for equation in EQUATIONS {
        assert!(
            !equation.status.is_empty() && !equation.statement.is_empty(),
            "{equation:?}"
        );
    }
    let find = |label: &str| EQUATIONS.iter().find(|equation| equation.label == label);
    assert!(find("LE-3").is_some_and(|equation| equation.statement.contains("in - out")));
    assert!(find("LE-3").is_some_and(|equation| equation.module.starts_with("model::")));
}
