//! The smaller points of the audit (the page `docs/book/src/physics_points.md`): pump pressure, half angle of the wedge, primary pressure, rotating
//! energy, mass that presses on the bands.
//!
//! Truth: flow against need and energy against speed, worked out from the rows; signs and limits of the equations.
#![allow(clippy::unwrap_used, reason = "tests stop at the first surprise")]

use crate::common::{CARS, ZERO, at, car, cycle, try_car};
use cvtcycle_model::drive::{Conditions, Outcome, Row, Start, drive};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::Cvt;

const CVT: &str = "rover_216_cvt";

fn nedc(name: &str, sets: &[&str]) -> Outcome {
    let conditions = Conditions {
        keep_rows: true,
        ..at(25.0, Start::Soak)
    };
    drive(&car(name, sets), &cycle("ece15_eudc"), &conditions)
}

fn cvt_of(sets: &[&str]) -> Cvt {
    let Transmission::Cvt(cvt) = car(CVT, sets).car(25.0 + ZERO).transmission else {
        panic!("a CVT")
    };
    *cvt
}

/// B1: a pump that is too small holds in no row more than its flow keeps up, slips, and fails the trace's checks; the shipped one is never limited.
#[test]
fn an_undersized_pump_loses_pressure() {
    let small = ["transmission.cvt.pump.displacement_cc_rev=2"];
    let (shipped, starved) = (nedc(CVT, &[]), nedc(CVT, &small));
    assert!(shipped.totals.seconds(Flags::FLOW_LIMITED) <= 0.0);
    assert!(starved.totals.seconds(Flags::FLOW_LIMITED) > 100.0);
    let seconds = starved.totals.seconds(Flags::LOW_CLAMP);
    let safety = starved.totals.min_clamp_safety;
    assert!(seconds > 0.0, "{seconds} s, {safety}");
    assert!(starved.totals.min_clamp_safety < 1.0 && starved.totals.ledger_error < 1e-9);
    let (pump, oil) = (cvt_of(&small).pump, car(CVT, &[]).car(25.0 + ZERO).oil);
    let mut lower = 0;
    for (row, (full, before)) in starved
        .rows
        .iter()
        .skip(1)
        .zip(shipped.rows.iter().skip(1).zip(&starved.rows))
    {
        if !row.flags.contains(Flags::FLOW_LIMITED) || row.speed_m_s > 0.0 {
            continue;
        }
        let eta = oil.dynamic_pa_s(before.sump_k);
        let drawn = pump
            .at(eta)
            .drawn_m3_s(pump.displacement_m3_rad * row.engine_speed_rad_s);
        let need = pump.lubrication_m3_s * (1.0 / eta).min(1.0)
            + row.secondary_pressure_pa * pump.leakage_m3_s_pa * 0.01 / eta;
        assert!((need / drawn - 1.0).abs() < 1e-6 || row.secondary_pressure_pa <= 1e4);
        lower += u32::from(row.secondary_pressure_pa < 0.9 * full.secondary_pressure_pa);
    }
    assert!(lower > 50, "{lower} rows at rest");
}

/// B2: below the angle of friction of the segments a file is refused, above it is read; the printed forms are read as printed.
#[test]
fn a_wedge_that_holds_its_segments_is_refused() {
    let set = |deg: f64, mu: f64| {
        vec![
            format!("transmission.cvt.variator.half_wedge_deg={deg}"),
            format!("lubricant.friction.segment={mu}"),
        ]
    };
    let refused = try_car(CVT, &set(7.0, 0.125)).unwrap_err();
    assert!(
        refused.contains("half_wedge_deg") && refused.contains("7.13"),
        "{refused}"
    );
    for (deg, mu) in [(7.0, 0.12), (7.2, 0.125), (9.0, 0.125), (11.0, 0.19)] {
        assert!(try_car(CVT, &set(deg, mu)).is_ok(), "{deg} {mu}");
    }
    assert!(try_car(CVT, &set(11.0, 0.195)).is_err());
}

/// B3: a primary piston of half the area needs more than the line's pressure in high; the Rover's does nowhere. Nothing else follows.
#[test]
fn a_small_primary_piston_is_flagged() {
    let small = nedc(CVT, &["transmission.cvt.variator.primary_piston_cm2=97"]);
    let seconds = |o: &Outcome| o.totals.seconds(Flags::PRIMARY_PRESSURE_SHORT);
    assert!(seconds(&small) > 300.0, "{} s", seconds(&small));
    assert!(seconds(&nedc(CVT, &[])) <= 0.0);
    for row in small.rows.iter().filter(|row| row.speed_m_s > 0.0) {
        let short = row.flags.contains(Flags::PRIMARY_PRESSURE_SHORT);
        assert_eq!(short, row.primary_pressure_pa > row.secondary_pressure_pa);
    }
}

/// B5: after a change up the clutch slips until the engine has come down, and what it loses is of the size of J (w1 - w2)2/2, whatever the step; the
/// rotating energy is that of the speed after every row. Only after a change down, where full load cannot speed the engine up within a step, it follows later.
#[test]
fn a_change_up_is_paid_by_the_clutch() {
    for name in &CARS[1..] {
        let lost = |dt: f64| {
            let conditions = Conditions {
                keep_rows: true,
                max_dt_s: dt,
                ..at(25.0, Start::Warm)
            };
            let rows = drive(&car(name, &[]), &cycle("eudc"), &conditions).rows;
            let j = car(name, &[]).car(25.0 + ZERO).engine.inertia_kg_m2;
            let mut energy_j = 0.5 * j * rows[0].engine_end_rad_s.powi(2);
            let mut changed_down_s = f64::NEG_INFINITY;
            for pair in rows.windows(2) {
                let row = &pair[1];
                if row.gear < pair[0].gear {
                    changed_down_s = row.time_s;
                }
                energy_j += row.kinetic_w * row.dt_s;
                let want_j = 0.5 * j * row.engine_end_rad_s.powi(2);
                // In overrun the brakes pay as much as they take (SI-5).
                let braked = row.flags.contains(Flags::OVERRUN) && row.brake_w < 1e-6;
                let is_near = row.time_s <= changed_down_s + 0.5;
                let lags = (is_near || braked) && energy_j < want_j;
                assert!(
                    lags || (energy_j - want_j).abs() < 1e-6,
                    "{name} {} s: {energy_j} J instead of {want_j}",
                    row.time_s
                );
            }
            let slips = |pair: &&[Row]| pair[1].gear >= pair[0].gear && pair[1].gear > 1;
            let of = |pair: &[Row]| pair[1].loss_w[Component::LaunchClutch] * pair[1].dt_s;
            rows.windows(2).filter(slips).map(of).sum::<f64>()
        };
        let (coarse, fine) = (lost(0.05), lost(0.025));
        assert!(
            (200.0..40e3).contains(&fine) && (coarse / fine - 1.0).abs() < 0.2,
            "{name}: {coarse} and {fine} J"
        );
    }
}

/// B11: by statics the bands press with nothing of their own mass: less on the shoulders, the same at rest; the printed forms do not see the key.
#[test]
fn bands_carry_themselves_where_they_may() {
    let belt = |word: &str| {
        cvt_of(&[&format!(
            "transmission.cvt.belt.bands_carry_themselves={word}"
        )])
        .belt
    };
    let (alone, whole) = (belt("true"), belt("false"));
    let steel_kg = 7800.0 * 12.0 * 0.217e-3 * 0.020 * alone.length_m;
    assert!((alone.band_mass_kg_m * alone.length_m - steel_kg).abs() < 1e-12);
    assert!(whole.band_mass_kg_m <= 0.0 && (alone.mass_kg_m - whole.mass_kg_m).abs() <= 0.0);
    let heavy = [
        "transmission.cvt.belt.bands_carry_themselves=true".to_owned(),
        "transmission.cvt.belt.mass_kg=0.2".to_owned(),
    ];
    let refused = try_car(CVT, &heavy).unwrap_err();
    assert!(refused.contains("the bands alone are heavier"), "{refused}");
    let fuel_kg = |word: &str| {
        let set = format!("transmission.cvt.belt.bands_carry_themselves={word}");
        nedc(CVT, &[&set]).totals.total().fuel_kg
    };
    let change = fuel_kg("true") / fuel_kg("false") - 1.0;
    assert!((-0.005..-0.0005).contains(&change), "{change}");
}
