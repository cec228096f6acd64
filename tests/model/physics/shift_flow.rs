//! A pump that cannot feed the clamp and the demanded shift: the clamp comes first, the shift waits (PU-7, RC-5).
//!
//! Truth: the balance of the oil from the rows, with the volume that the sheaves sweep by the geometry of the belt; solves that end; the same text
//! with f64.

use crate::common::{ZERO, car, cycle, try_car};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{
    Conditions, Drive, Outcome, Row, Run, Start, State, drive, drive_each,
};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::variator::Geometry;

const CVT: &str = "civic_20_cvt";
const CC: &str = "transmission.cvt.pump.displacement_cc_rev";

fn driven(setup: &Setup, name: &str, degc: f64, dt_s: f64) -> Outcome {
    let conditions = Conditions {
        ambient_k: degc + ZERO,
        start: Start::Soak,
        max_dt_s: dt_s,
        keep_rows: true,
    };
    drive(setup, &cycle(name), &conditions)
}

/// Every solve ends, the belt never slips, whatever the step, the oil and the pump.
#[test]
fn a_stop_with_a_small_pump_is_solved() {
    let kinds = [
        "transmission.cvt.pump.kind.fixed={}",
        "transmission.cvt.pump.kind.dual_cavity.share=0.5",
        "transmission.cvt.pump.kind.variable.least_share=0.25",
        "transmission.cvt.pump.kind.electric.fastest_rpm=1100",
    ];
    for (kind, cc) in kinds.iter().flat_map(|kind| [(kind, "6"), (kind, "7")]) {
        let mut sets = vec![format!("{CC}={cc}")];
        sets.extend((!kind.contains("fixed")).then(|| (*kind).to_owned()));
        let setup = try_car(CVT, &sets).unwrap_or_else(|problems| panic!("{problems}"));
        for (degc, dt_s) in [(24.0, 1.0), (24.0, 0.5), (24.0, 0.2), (-20.0, 1.0)] {
            let totals = driven(&setup, "udds", degc, dt_s).totals;
            let of = format!("{sets:?} {degc} degC {dt_s} s");
            assert!(totals.seconds(Flags::NOT_CONVERGED) <= 0.0, "{of}");
            assert!(totals.seconds(Flags::GROSS_SLIP) <= 0.0, "{of}");
            assert!(totals.seconds(Flags::FLOW_LIMITED) > 0.0, "{of}");
            assert!(totals.ledger_error < 1e-9, "{of}");
        }
    }
}

/// Conservation of the oil: what the pump draws covers lubrication, leakage and the sheaves in every row, and just so where the shift waits.
#[test]
fn the_shift_takes_what_the_clamp_leaves() {
    for (cc, dt_s) in [(5.6, 0.1), (6.0, 0.1), (7.0, 0.2)] {
        let setup = car(CVT, &[&format!("{CC}={cc}")]);
        let model = setup.car(24.0 + ZERO);
        let Transmission::Cvt(cvt) = &model.transmission else {
            panic!("a CVT")
        };
        let (belt, pump) = (&cvt.belt, &cvt.pump);
        let at = |ratio: f64| Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
        let cycle = cycle("udds");
        let mut drive = Drive::along(&model, cycle.trace_for(true), State::at(24.0 + ZERO));
        let rows: Vec<(Row, f64)> = cycle
            .trace_for(true)
            .steps(dt_s)
            .map(|step| {
                let row = drive.step(&step).0;
                let own = drive.state().transmission.and_then(|own| own.cvt);
                (row, own.expect("a CVT").shifting.ratio)
            })
            .collect();
        let mut waits = 0;
        for pair in rows.windows(2) {
            let [(before, from_ratio), (row, to_ratio)] = pair else {
                unreachable!()
            };
            if row.speed_m_s <= 0.0 {
                continue;
            }
            let (from, to) = (at(*from_ratio), at(*to_ratio));
            let travel = 2.0 * belt.tan_wedge;
            let secondary = to.secondary_radius_m - from.secondary_radius_m;
            let primary = to.primary_radius_m - from.primary_radius_m;
            let swept_m3 = (cvt.secondary_piston_m2 * travel * secondary)
                .max(cvt.primary_piston_m2 * travel * primary);
            let eta = model.oil.dynamic_pa_s(before.sump_k);
            let drawn =
                (pump.at(eta)).drawn_m3_s(pump.displacement_m3_rad * row.engine_speed_rad_s);
            let need = pump.steady_need_m3_s(row.secondary_pressure_pa, eta);
            let left_m3 = (drawn - need) * row.dt_s;
            // The slope of a radius at the begin of the step is taken for all of it (PU-3).
            assert!(
                swept_m3 <= 1.1 * left_m3 + 1e-9,
                "{cc} cc at {} s: {swept_m3} of {left_m3} m3",
                row.time_s
            );
            // At one rate for all of the step; a shift that waits for its reversal to be large enough (RC-10) moves in a part of it.
            let middle = (from_ratio * to_ratio).sqrt();
            let is_whole = (row.belt_ratio / middle - 1.0).abs() < 1e-6;
            if row.flags.contains(Flags::FLOW_LIMITED) {
                waits += 1;
                assert!(
                    !is_whole || swept_m3 >= 0.9 * left_m3 - 1e-9,
                    "{swept_m3} of {left_m3} m3"
                );
                assert!(
                    row.clamp_safety >= 1.0,
                    "{} at {} s",
                    row.clamp_safety,
                    row.time_s
                );
            }
        }
        assert!(waits > 3, "{cc} cc, {dt_s} s: {waits} rows");
    }
}

/// A pump that is larger by a ten-millionth moves nothing by more than a hundred thousandth: the limit has no steps.
#[test]
fn the_limit_is_continuous() {
    for cc in [5.6, 6.0, 6.5, 7.0] {
        let own = |cc: f64| driven(&car(CVT, &[&format!("{CC}={cc}")]), "udds", 24.0, 1.0);
        let (one, other) = (own(cc), own(cc * (1.0 + 1e-7)));
        let moved = one.rows.iter().zip(&other.rows);
        let moved = moved.map(|(a, b)| (a.belt_ratio / b.belt_ratio - 1.0).abs());
        let most = moved.fold(0.0, f64::max);
        assert!(most < 1e-5, "{cc} cc: {most}");
    }
}

/// Cars whose shifts wait at other moments, in lockstep: each has its own bits.
#[test]
fn searches_side_by_side_have_their_own_bits() {
    let cars: Vec<Setup> = (0..11)
        .map(|k| {
            let k = f64::from(k);
            let sets = [
                format!("{CC}={}", 4.5 + 0.2 * k),
                format!("road_load.mass_kg={}", 1150.0 + 60.0 * ((3.0 * k) % 11.0)),
            ];
            try_car(CVT, &sets).unwrap_or_else(|problems| panic!("{problems}"))
        })
        .collect();
    let trace = cycle("udds");
    let conditions = Conditions {
        ambient_k: 24.0 + ZERO,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let runs = cars.iter().map(|vehicle| Run {
        vehicle,
        conditions,
    });
    let runs: Vec<Run> = runs.collect();
    for (run, outcome) in runs.iter().zip(drive_each(&runs, &trace)) {
        let alone = drive(run.vehicle, &trace, &run.conditions);
        assert!(alone.totals.seconds(Flags::FLOW_LIMITED) > 0.0);
        assert_eq!(
            format!("{:?}", outcome.totals),
            format!("{:?}", alone.totals)
        );
    }
}
