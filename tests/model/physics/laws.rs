//! The physics checks by single rows: what they allow (PX-1, PX-3, PX-5), and from which row on.
//!
//! Truth: rounding and the tolerance of the solve are shares of the numbers compared, whatever their sign; the air that an engine draws in burns
//! LHV/14.6 J per kg.

use crate::common::{CARS, Keep, ZERO, car, cycle};
use cvtcycle_model::drive::{Car, Finding, Law, PhysicsCheck, Recorder, Row, State, simulate};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::math::Curve;
use cvtcycle_model::transmission::Transmission;

/// Rows of a drive, and what a check finds after some change of each.
fn kept(car: &Car, start: &State, name: &str) -> Keep {
    let mut keep = Keep::default();
    let trace = cycle(name);
    let trace = trace.trace_for(car.transmission.is_cvt());
    simulate(car, trace, 1.0, *start, &mut keep);
    keep
}

fn found(car: &Car, start: &State, keep: &Keep, law: Law, change: &dyn Fn(&mut Row)) -> Finding {
    let mut check = PhysicsCheck::new(car, start);
    for (row, terms) in keep.rows.iter().zip(&keep.terms) {
        let mut row = *row;
        change(&mut row);
        check.record(&row, terms);
    }
    check.findings()[law as usize]
}

/// Property: an error of the belt's torque below the tolerance of the solve, and one of a pulley's power below rounding, break no law, in overrun as in
/// drive; a greater one does.
#[test]
fn bounds_are_shares_of_torque_and_power_of_either_sign() {
    let car = car(CARS[0], &[]).car(ZERO + 20.0);
    let start = State::at(ZERO + 20.0);
    let keep = kept(&car, &start, "us06");
    let Transmission::Cvt(cvt) = &car.transmission else {
        panic!("a CVT")
    };
    let per_m_s = cvt.final_drive.ratio / car.road_load.wheel_radius_m;
    for sign in [1.0, -1.0] {
        let here = |row: &Row| row.speed_m_s > 0.0 && sign * row.secondary_nm > 20.0;
        assert!(keep.rows.iter().filter(|row| here(row)).count() > 50);
        let off = |share: f64| {
            let change = |row: &mut Row| {
                if here(row) {
                    row.primary_nm *= 1.0 + share;
                }
            };
            found(&car, &start, &keep, Law::Statics, &change)
        };
        assert!(off(8e-7).holds(), "{sign}: {:?}", off(8e-7));
        assert!(!off(1e-4).holds(), "{sign}: {:?}", off(1e-4));
        // A row without losses, its power out a share more than that in.
        let gains = |share: f64| {
            let change = |row: &mut Row| {
                if here(row) {
                    let secondary_w = row.secondary_nm * row.speed_m_s * per_m_s;
                    let primary_rad_s = row.belt_ratio * row.speed_m_s * per_m_s / (1.0 - row.slip);
                    row.primary_nm = (secondary_w - share * secondary_w.abs()) / primary_rad_s;
                    row.engine_torque_nm = 0.0;
                }
            };
            found(&car, &start, &keep, Law::SecondLaw, &change)
        };
        assert!(gains(1e-9).holds(), "{sign}: {:?}", gains(1e-9));
        assert!(!gains(1e-8).holds(), "{sign}: {:?}", gains(1e-8));
    }
}

/// PX-3 needs air from the first row that begins after the start of the engine.
#[test]
fn air_is_asked_for_after_the_start() {
    for sets in [&["engine.fuel.start_g=5"][..], &[]] {
        let car = car(CARS[1], sets).car(ZERO + 20.0);
        let start = State::at(ZERO + 20.0);
        let keep = kept(&car, &start, "ece15");
        let counted = |row: &&Row| {
            let off_line = [Flags::OUTSIDE_VALIDITY, Flags::OVERSPEED];
            row.time_s - row.dt_s > car.engine.start_s
                && !off_line.iter().any(|f| row.flags.contains(*f))
        };
        let rows = keep.rows.iter().filter(counted).count() as u64;
        let air = found(&car, &start, &keep, Law::Air, &|_| {});
        assert_eq!(air.rows, rows, "start of {} s", car.engine.start_s);
    }
}

/// PX-3 by hand: an engine without a charger, however weak its full load, draws in 1.05 of the density of air at 25 degC, and its fuel burns with 14.6
/// times its mass; one with twice the torque of the Rover's is charged, and burns in proportion to the charge. In the cold the air is as dense as that
/// of the ambient.
#[test]
fn air_of_the_displacement_or_of_the_full_load() {
    let bound_pa = |ambient_degc: f64, factor: f64| {
        let ambient_k = ZERO + ambient_degc;
        let mut car = car(CARS[1], &[]).car(ambient_k);
        let points = car.engine.full_load.points();
        let points: Vec<(f64, f64)> = points.map(|(w, nm)| (w, factor * nm)).collect();
        car.engine.full_load = Curve::new(&points).unwrap();
        let start = State::at(ambient_k);
        let keep = kept(&car, &start, "ece15");
        let air = found(&car, &start, &keep, Law::Air, &|_| {});
        (1e5 * air.bound, car.engine.heating_value_j_kg)
    };
    for factor in [0.5, 2.0] {
        let (plain_pa, heating_j_kg) = bound_pa(25.0, factor);
        let density = 101_325.0 / (287.05 * 298.15);
        let drawn_pa = 1.05 * density * heating_j_kg / 14.6;
        let share = plain_pa / drawn_pa;
        if factor < 1.0 {
            assert!((share - 1.0).abs() < 1e-9, "{share}");
        } else {
            assert!(share > 2.0, "{share}");
        }
        for (ambient_degc, charge) in [
            (45.0, (298.15 / 318.15_f64).sqrt()),
            (-20.0, 298.15 / 253.15),
        ] {
            let (own_pa, _) = bound_pa(ambient_degc, factor);
            let found = own_pa / plain_pa;
            assert!(
                (found / charge - 1.0).abs() < 1e-3,
                "{ambient_degc}: {found}, {charge}"
            );
        }
    }
}
