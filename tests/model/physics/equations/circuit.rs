//! The hydraulic circuit of the cylinders, HC-1 to HC-4.

use super::same;
use crate::common::{CARS, car, cycle, soak_rows};
use cvtcycle_model::drive::Row;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::circuit::LineCircuit;

fn cvt(set: &[&str]) -> Cvt {
    match car(CARS[0], set).car(293.15).transmission {
        Transmission::Cvt(cvt) => *cvt,
        Transmission::Manual(_) => panic!("a CVT"),
    }
}

/// HC-1 to HC-3 by hand: pistons of 214 and 97.19 cm2, and of 100 and 60 cm2 with a torque sensor.
#[test]
fn val_line_pressure_by_hand() {
    let line = |circuit, secondary_pa: f64, primary_pa: f64| {
        Cvt {
            circuit,
            ..cvt(&[])
        }
        .line_pa(secondary_pa, primary_pa)
    };
    same(line(LineCircuit::LineIsSecondary, 12e5, 30e5), 12e5);
    same(line(LineCircuit::Independent, 12e5, 30e5), 30e5);
    same(line(LineCircuit::Independent, 40e5, 30e5), 40e5);
    let sensor = LineCircuit::TorqueSensor {
        clamp_m2: 100e-4,
        shift_m2: 60e-4,
    };
    // 11 662.8 N and 21 400 N: 11.66 bar clamp both, 9 737.2 N are left for 60 cm2.
    same(line(sensor, 12e5, 10e5), 9737.2 / 60e-4);
    // 11 662.8 N and 12 840 N: little is left.
    same(line(sensor, 12e5, 6e5), 11_662.8 / 100e-4);
}

fn drive(set: &[&str]) -> Vec<Row> {
    soak_rows(&car(CARS[0], set), &cycle("eudc"), 25.0).rows
}

/// Property (HC-4): with a primary piston that is half as large as the line pressure needs, the ratio is not held and the engine turns faster than with
/// a valve for each cylinder; the rows are flagged. With pistons of 2 to 1 none is.
#[test]
fn a_primary_that_is_too_small_does_not_hold_the_ratio() {
    let small = "transmission.cvt.variator.primary_piston_cm2=136";
    let [ample, short, valves] = [
        drive(&[]),
        drive(&[small]),
        drive(&[small, "transmission.cvt.circuit=independent"]),
    ];
    let flagged = |rows: &[Row]| {
        let is_short = |row: &&Row| row.flags.contains(Flags::PRIMARY_PRESSURE_SHORT);
        rows.iter().filter(is_short).count()
    };
    let turns = |rows: &[Row]| rows.iter().map(|row| row.engine_speed_rad_s).sum::<f64>();
    assert!(flagged(&ample) == 0 && flagged(&valves) == 0 && flagged(&short) > 100);
    assert!(turns(&short) > 1.2 * turns(&valves));
    assert!((turns(&valves) / turns(&ample) - 1.0).abs() < 0.02);
}
