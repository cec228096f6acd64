//! A transmission on the bench as a table.

use std::sync::LazyLock;

use super::belt;
use super::{Column, Marks, Rows, combinations, rpm};
use crate::expr::{Table, truth};
use crate::keys::BENCH;
use crate::source::Source;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::Key;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::rig::{Bench, BenchAnswer, BenchPoint, KeptRatio, Parts};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

/// Columns before those of the components.
static COLUMNS: LazyLock<Vec<Column<BenchAnswer>>> = LazyLock::new(|| {
    columns! { BenchAnswer;
        "ratio" a => a.point.ratio;
        "speed_rpm" a => rpm(a.point.input_rad_s);
        "temp_degc" a => a.point.sump_k - ZERO_DEGC_K;
        "torque_nm" a => a.point.output_nm;
        "throttle" a => a.point.throttle;
        "pressure_factor" a => a.point.pressure_factor;
        "total_nm" a => a.total_nm();
        "belt_nm" a => a.belt_nm();
        "input_torque_nm" a => a.input_nm;
        "input_power_w" a => a.input_nm * a.point.input_rad_s;
        "efficiency_percent" a => 100.0 * efficiency(a);
        "output_speed_rpm" a => rpm(a.output_rad_s);
        "pressure_bar" a => a.secondary_pa / 1e5;
        "belt_degc" a => a.belt_k - ZERO_DEGC_K;
        "belt_above_sump_k" a => a.belt_k - a.point.sump_k;
        "slip_percent" a => a.belt.map_or(f64::NAN, |belt| 100.0 * belt.losses.slip_total);
        "capacity_nm" a => a.belt.map_or(f64::NAN, |belt| belt.losses.capacity_nm);
        "flow_l_min" a => a.oil_flow_m3_s * 6e4;
        "segment_compression_n" a => a.belt.map_or(f64::NAN, |belt| belt.tension.compression_n);
        "flow_limited" a => truth(a.flags.contains(Flags::FLOW_LIMITED));
        "outside_validity" a => truth(a.flags.contains(Flags::OUTSIDE_VALIDITY));
    }
});

static LOSSES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| Component::ALL.iter().map(|c| c.columns().nm).collect());

/// Names of the columns.
pub fn columns() -> Vec<&'static str> {
    let names = COLUMNS.iter().map(|column| column.name);
    names.chain(LOSSES.iter().copied()).collect()
}

fn efficiency(a: &BenchAnswer) -> f64 {
    let p = &a.point;
    let input_w = a.input_nm * p.input_rad_s;
    let output_w = p.output_nm * a.output_rad_s;
    if p.output_nm < 0.0 {
        input_w / output_w
    } else {
        output_w / input_w
    }
}

/// What counts of a solved point besides its numbers.
pub(super) fn marks(answer: &BenchAnswer) -> Marks {
    Marks {
        gross: answer.flags.contains(Flags::GROSS_SLIP),
        outside: answer.flags.contains(Flags::OUTSIDE_VALIDITY),
        ..Marks::default()
    }
}

/// Number of a solved point in a column.
pub(super) fn number(answer: &BenchAnswer, column: usize) -> f64 {
    match COLUMNS.get(column) {
        Some(of) => (of.get)(answer),
        None => answer.loss_nm[Component::ALL[column - COLUMNS.len()]],
    }
}

/// Number of columns.
pub(super) fn width() -> usize {
    COLUMNS.len() + LOSSES.len()
}

/// What sets a point, in the order in which [`point`] takes the values.
pub const SETTINGS: [&Key; 9] = [
    &BENCH.ratio,
    &BENCH.torque_nm,
    &BENCH.throttle,
    &BENCH.pressure_bar,
    &BENCH.pressure_factor,
    &BENCH.belt_degc,
    &BENCH.belt_above_sump_k,
    &BENCH.temp_degc,
    &BENCH.speed_rpm,
];

/// The point of some settings in SI units, NaN for what is not given.
pub fn point(x: &[f64], parts: Parts) -> BenchPoint {
    let given = |x: f64| (!x.is_nan()).then_some(x);
    BenchPoint {
        ratio: x[0],
        output_nm: x[1],
        throttle: x[2],
        pressure_pa: given(x[3]),
        pressure_factor: x[4],
        belt_k: given(x[5]).or(given(x[6] + x[7])),
        sump_k: x[7],
        input_rad_s: x[8],
        parts,
    }
}

/// Solves all points of a source.
pub fn table(source: &Source, setup: &Setup) -> Result<Table, String> {
    let parts = parts(source);
    let settings = combinations(&SETTINGS.map(|key| source.axis(key))).into_iter();
    let points: Vec<BenchPoint> = settings.map(|x| point(&x, parts)).collect();
    of_points(&points, setup)
}

/// Parts in the box.
pub fn parts(source: &Source) -> Parts {
    let has = |part: &str| !source.without.iter().any(|other| other == part);
    Parts {
        final_drive: has("final_drive"),
        belt: has("belt"),
        reverse_clutch: has("reverse_clutch"),
        pump: has("pump"),
        seal_rings: true,
    }
}

/// Solves points.
///
/// # Errors
/// A sentence: a ratio or gear that the box does not have.
pub fn of_points(points: &[BenchPoint], setup: &Setup) -> Result<Table, String> {
    let bench = Bench::new(setup);
    for point in points {
        fits(&bench, point.ratio)?;
    }
    let mut rows = Rows::new(points.len());
    let Some(first) = points.first() else {
        return Ok(rows.table(width(), number));
    };
    let mut bench = KeptRatio::new(&bench, first.ratio);
    for point in points {
        let answer = bench.at(point.ratio).solve(point);
        rows.add(answer, &marks(&answer));
    }
    Ok(rows.table(width(), number))
}

/// An error if the box does not have this ratio or gear.
fn fits(bench: &Bench, ratio: f64) -> Result<(), String> {
    let gears = match &bench.car().transmission {
        Transmission::Cvt(cvt) => return belt::fits(&cvt.belt, ratio),
        Transmission::Manual(manual) => manual.overall.len(),
    };
    if ratio.fract().abs() <= 0.0 && ratio >= 1.0 && ratio <= gears as f64 {
        return Ok(());
    }
    let message = format!("the box has the gears 1 to {gears}: give one as `ratio`");
    Err(message)
}
