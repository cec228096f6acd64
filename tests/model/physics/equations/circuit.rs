//! The hydraulic circuit of the cylinders, HC-1 to HC-3.

use super::same;
use crate::common::{CARS, car, cycle, soak_rows};
use cvtcycle_model::drive::Row;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
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

/// Property: a primary piston that is too small for the line pressure is flagged (HC-1); with a valve for each cylinder the pump holds its higher
/// pressure instead (HC-2), which costs work. With pistons of 2.2 to 1 the line has enough.
#[test]
fn a_small_primary_is_flagged_or_costs_pressure() {
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
    let pump = |rows: &[Row]| {
        rows.iter()
            .map(|row| row.loss_w[Component::Pump])
            .sum::<f64>()
    };
    assert!(flagged(&ample) == 0 && flagged(&valves) == 0 && flagged(&short) > 100);
    assert!((pump(&short) / pump(&ample) - 1.0).abs() < 0.01);
    assert!(pump(&valves) > 1.1 * pump(&ample));
}

/// Property: the pressure that control needs may go to none. A secondary without pressure next to a primary with some, which the solution of a step
/// passes, is a point like any other: the drive is that of a vanishing pressure, every step converges and the pump has flow enough.
#[test]
fn a_secondary_without_pressure_is_no_limit_of_the_pump() {
    let floors = ["clutch_return_bar", "clutch_bar_per_nm", "strand_n"];
    let none = floors.map(|key| format!("transmission.cvt.pressure.{key}=0"));
    let sensor = "transmission.cvt.circuit.torque_sensor";
    for circuit in [
        vec!["transmission.cvt.circuit=independent".to_owned()],
        vec![
            "transmission.cvt.circuit=torque_sensor".to_owned(),
            format!("{sensor}.clamp_piston_cm2=100"),
            format!("{sensor}.shift_piston_cm2=60"),
        ],
    ] {
        let rows = |control_bar: &str| {
            let control = format!("transmission.cvt.pressure.control_bar={control_bar}");
            let mut set = vec!["transmission.cvt.clamp=torque_following", &control];
            set.extend(none.iter().chain(&circuit).map(String::as_str));
            soak_rows(&car("civic_20_cvt", &set), &cycle("ece15"), 25.0).rows
        };
        let (none, small) = (rows("0"), rows("1e-6"));
        let limits = Flags(Flags::FLOW_LIMITED.0 | Flags::NOT_CONVERGED.0);
        assert!(none.iter().all(|row| !row.flags.any(limits)));
        let fuel = |rows: &[Row]| rows.iter().map(|row| row.fuel_kg_s * row.dt_s).sum::<f64>();
        let moved = fuel(&none) / fuel(&small) - 1.0;
        assert!(moved.abs() < 1e-6, "{circuit:?}: {moved:e}");
    }
}
