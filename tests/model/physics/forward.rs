//! A CVT that is driven by a torque (FO-1 to FO-3, RC-15).
//!
//! Truth: the drive that goes the other way, and the power balance of each step.

use crate::common::{ZERO, car, cycle};
use cvtcycle_model::drive::{Car, Drive, Forward, Given, Row, State, Turned};
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, SUMP};

const AMBIENT_K: f64 = ZERO + 25.0;

/// Rows of a drive with what is known of each for the other way.
fn driven(own: &Car, cycle_name: &str, dt_s: f64) -> Vec<(Given, Row, Heat)> {
    let cycle = cycle(cycle_name);
    let mut drive = Drive::new(own, State::at(AMBIENT_K));
    let radius_m = own.road_load.wheel_radius_m;
    let mut before_rad_s = f64::NAN;
    let mut list = Vec::new();
    for step in cycle.trace_for(true).steps(dt_s) {
        let heat = drive.state().heat;
        let (row, _) = drive.step(&step);
        let w = row.engine_speed_rad_s;
        let before = if before_rad_s.is_nan() {
            w
        } else {
            before_rad_s
        };
        let kinetic_w = 0.5 * own.engine.inertia_kg_m2 * (w * w - before * before) / step.dt_s;
        before_rad_s = w;
        list.push((
            Given {
                engine_nm: row.engine_torque_nm + kinetic_w / w,
                wheel_rad_s: [step.start_speed_m_s, step.end_speed_m_s].map(|v| v / radius_m),
                ratio: row.belt_ratio,
                sump_k: heat.node_k[SUMP],
                engine_k: [heat.node_k[COOLANT], heat.node_k[ENGINE_OIL]],
                dt_s: step.dt_s,
            },
            row,
            drive.state().heat,
        ));
    }
    list
}

/// Power in over power out, losses and rotating energy, over the largest of them.
fn open_w(given: &Given, turned: &Turned) -> f64 {
    let out = &turned.output;
    let in_w = turned.taken_nm * out.engine_rad_s;
    let losses_w: f64 = out.loss_w.iter().sum();
    let rest_w = in_w - out.output_w - losses_w - out.alternator_w - turned.kinetic_w;
    assert!(given.dt_s > 0.0);
    rest_w.abs() / (in_w.abs() + out.output_w.abs() + losses_w)
}

#[test]
fn a_drive_the_other_way_round_is_that_drive() {
    for (word, cycle_name, dt_s) in [
        ("rover_216_cvt", "ece15_eudc", 1.0),
        ("rover_216_cvt", "ftp75", 1.0),
        ("rover_216_cvt", "ece15", 0.1),
        ("civic_20_cvt", "ftp75", 1.0),
    ] {
        let own = car(word, &[]).car(AMBIENT_K);
        let mut forward = Forward::new(&own, State::at(AMBIENT_K)).expect("a CVT");
        let (mut most_nm, mut most_speed, mut most_loss, mut most_belt) =
            (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        let (mut most_open, mut count, mut energy) = (0.0_f64, 0, [0.0; 2]);
        for (given, row, heat) in driven(&own, cycle_name, dt_s) {
            let turned = forward.step(&given);
            let out = &turned.output;
            most_open = most_open.max(open_w(&given, &turned));
            let loss = |of: &cvtcycle_model::transmission::component::ByComponent<f64>| {
                of.iter().sum::<f64>()
            };
            if row.speed_m_s > 0.0 {
                let off = (turned.taken_nm - given.engine_nm).abs();
                if off > 1e-3 {
                    eprintln!(
                        "{word} {cycle_name} {dt_s} t={} taken {} given {} w {} {} brake {} deficit {} ratio {} {} flags {:?}",
                        row.time_s,
                        turned.taken_nm,
                        given.engine_nm,
                        out.engine_rad_s,
                        row.engine_speed_rad_s,
                        row.brake_w,
                        row.deficit_w,
                        out.belt_ratio,
                        row.belt_ratio,
                        row.flags
                    );
                }
                most_speed =
                    most_speed.max((out.engine_rad_s / row.engine_speed_rad_s - 1.0).abs());
                most_loss = most_loss.max((loss(&out.loss_w) - loss(&row.loss_w)).abs());
                most_belt =
                    most_belt.max((forward.state().heat.node_k[BELT] - heat.node_k[BELT]).abs());
                if row.brake_w <= 0.0 && row.deficit_w <= 0.0 {
                    count += 1;
                    most_nm = most_nm.max((turned.wheel_nm() - row.wheel_torque_nm).abs());
                    energy[0] += out.output_w * given.dt_s;
                    energy[1] += row.wheel_power_w * given.dt_s;
                }
            }
        }
        eprintln!(
            "{word} {cycle_name} {dt_s}: {most_nm} Nm, speed {most_speed}, loss {most_loss} W, belt {most_belt} K, open {most_open}, steps {count}, energy {energy:?}"
        );
    }
}
