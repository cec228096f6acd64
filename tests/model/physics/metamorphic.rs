//! Properties of whole runs: what must change when an input changes, and what must not.
#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    clippy::print_stdout,
    reason = "tests say what they found"
)]

use crate::common::{CARS, ZERO, at, car, consumption, cycle, fuel_kg, larger, try_car};
use cvtcycle_model::drive::{Conditions, Start, drive};
use cvtcycle_model::transmission::component::Component;

/// Property: halving the step converges on the fuel of the finest step, within 0.2 % per second of step (+0.015 %); a step of 0.01 s still closes its books.
#[test]
fn halving_the_step_converges() {
    for name in CARS {
        let setup = car(name, &[]);
        let c = cycle("ece15_eudc");
        let run = |dt: f64| {
            drive(
                &setup,
                &c,
                &Conditions {
                    max_dt_s: dt,
                    ..at(-10.0, Start::Soak)
                },
            )
        };
        let steps = [1.0, 0.5, 0.25, 0.125, 0.0625];
        let fuel: Vec<f64> = steps
            .iter()
            .map(|&dt| run(dt).totals.total().fuel_kg)
            .collect();
        let finest = run(0.01);
        assert!(
            finest.totals.ledger_error <= 1e-9,
            "{name}: ledger {:e} at 0.01 s",
            finest.totals.ledger_error
        );
        let end = finest.totals.total().fuel_kg;
        let errors: Vec<f64> = fuel.iter().map(|f| 100.0 * (f / end - 1.0)).collect();
        println!(
            "{name}: error of fuel against 0.01 s in % at {steps:?} s: {errors:.4?}; worst residual {:e}",
            finest.totals.worst_residual
        );
        // Errors of both signs may cancel at one step; what converges is their bound.
        for (dt, error) in steps.iter().zip(&errors) {
            assert!(error.abs() < 0.2 * dt + 0.015, "{name}: {errors:?}");
        }
        // Below the bound of a vanishing step there is nothing left to halve.
        let coarse = errors[..3].iter().fold(0.0, |a, e| larger(e.abs(), a));
        assert!(
            errors[4].abs() < larger(0.5 * coarse, 0.015),
            "{name}: {errors:?}"
        );
    }
}

/// Property: an equal run gives equal bits, and keeping rows changes nothing.
#[test]
fn same_input_same_numbers() {
    for name in CARS {
        let setup = car(name, &[]);
        let c = cycle("udds");
        let conditions = at(-10.0, Start::Soak);
        let a = drive(&setup, &c, &conditions);
        let b = drive(
            &setup,
            &c,
            &Conditions {
                keep_rows: true,
                ..conditions
            },
        );
        assert_eq!(
            a.totals.total().fuel_kg.to_bits(),
            b.totals.total().fuel_kg.to_bits()
        );
        assert_eq!(a.end, b.end);
        assert!(!b.rows.is_empty() && a.rows.is_empty());
    }
}

/// Property: after a soak colder is never cheaper, on the dynamometer, for every car.
#[test]
fn colder_is_never_cheaper_after_a_soak() {
    let mut wrong = Vec::new();
    for name in CARS {
        let setup = car(name, &[]);
        for cycle_name in ["ece15_eudc", "ftp75", "us06"] {
            let c = cycle(cycle_name);
            for start in [Start::Soak, Start::Warm] {
                let fuel: Vec<f64> = (-4..=8)
                    .map(|i| fuel_kg(&setup, &c, &at(5.0 * f64::from(i), start)))
                    .collect();
                let shown: Vec<f64> = fuel.iter().map(|f| 1000.0 * f).collect();
                println!("{name} {cycle_name} {start:?}: fuel g from -20 to 40 degC: {shown:.1?}");
                if start == Start::Soak {
                    for (i, pair) in fuel.windows(2).enumerate() {
                        if pair[1] > pair[0] {
                            wrong.push(format!(
                                "{name} {cycle_name}: {} g at {} degC, {} g at {} degC",
                                1e3 * pair[0],
                                5 * i as i32 - 20,
                                1e3 * pair[1],
                                5 * i as i32 - 15
                            ));
                        }
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Settings that take away a component's loss: (component, car, settings).
const ZERO_LOSS: [(&str, &str, &[&str]); 13] = [
    (
        "seal_ring",
        "rover_216_cvt",
        &["transmission.cvt.seal_ring.friction=0"],
    ),
    (
        "pulley_bearing",
        "rover_216_cvt",
        &["transmission.cvt.pulley_bearing.friction=0"],
    ),
    (
        "input_shaft",
        "rover_216_cvt",
        &[
            "transmission.cvt.input_shaft.constant_nm=0",
            "transmission.cvt.input_shaft.viscous_nm_per_rpm=0",
        ],
    ),
    (
        "clutch_drag",
        "rover_216_cvt",
        &["transmission.cvt.reverse_clutch.drag_nm=0"],
    ),
    (
        "final_drive",
        "rover_216_cvt",
        &[
            "transmission.cvt.final_drive.bearing_factor=0",
            "transmission.cvt.final_drive.preload_factor=0",
            "transmission.cvt.final_drive.bearing_friction=0",
            "transmission.cvt.final_drive.churning_factor=0",
            "transmission.cvt.final_drive.oil_factor=0",
            "transmission.cvt.final_drive.seals=[]",
        ],
    ),
    ("belt_band", "rover_216_cvt", &["lubricant.friction.band=0"]),
    (
        "belt_film",
        "rover_216_cvt",
        &["lubricant.friction.film.enabled=false"],
    ),
    (
        "belt_wedge",
        "rover_216_cvt",
        &["lubricant.friction.flank=0"],
    ),
    (
        "belt_penetration",
        "rover_216_cvt",
        &["lubricant.friction.flank=0"],
    ),
    (
        "gear_mesh",
        "rover_216_5mt",
        &["transmission.manual.gears.oil_factor=0"],
    ),
    (
        "bearing",
        "rover_216_5mt",
        &[
            "transmission.manual.gears.bearings=[[0, 2, 50, 30, 0, 0], [1, 2, 50, 30, 0, 0], [2, 2, 62, 45, 0, 0]]",
            "transmission.manual.gears.bearing_friction=0",
        ],
    ),
    (
        "churning",
        "rover_216_5mt",
        &["transmission.manual.gears.churning_factor=0"],
    ),
    (
        "seal",
        "rover_216_5mt",
        &["transmission.manual.gears.seals=[]"],
    ),
];

/// Property: a component whose parameters are zero loses nothing, and only its loss vanishes. What has no zero is made small:
/// the film's shear (its onset can only be put far away), belt slip (stiff bands and segments), the pump (0.5 cc/rev).
#[test]
fn zero_parameters_give_zero_loss() {
    let c = cycle("ece15_eudc");
    for (component, name, sets) in ZERO_LOSS {
        // A box as heavy as it may be keeps its temperature, whatever it loses: the components meet in torque and pressure only.
        let mut heavy = vec![
            "thermal.transmission.oil_l=30",
            "thermal.transmission.metal_kj_k=1000",
            "thermal.transmission.oil_metal_w_k=5000",
        ];
        if name.ends_with("cvt") {
            heavy.extend([
                "thermal.transmission.belt_kj_k=1000",
                "thermal.transmission.spray_w_k=5000",
            ]);
        }
        let plain = drive(&car(name, &heavy), &c, &at(-10.0, Start::Soak))
            .totals
            .total();
        heavy.extend(sets);
        let without = drive(&car(name, &heavy), &c, &at(-10.0, Start::Soak))
            .totals
            .total();
        let k = Component::ALL
            .into_iter()
            .find(|k| k.name() == component)
            .unwrap();
        println!(
            "{component}: {:.1} kJ -> {:.3e} kJ",
            plain.loss_j[k] / 1e3,
            without.loss_j[k] / 1e3
        );
        assert!(plain.loss_j[k] > 1.0, "{component} had no loss to lose");
        let bound = if component == "belt_film" {
            1e-3 * plain.loss_j[k]
        } else {
            1e-9
        };
        assert!(
            without.loss_j[k].abs() <= bound,
            "{component}: {} J left",
            without.loss_j[k]
        );
        assert!(
            without.fuel_kg < plain.fuel_kg || component == "belt_film",
            "{component}: fuel does not fall"
        ); // without film, boundary friction stays whole
        for other in Component::ALL.iter().filter(|o| {
            **o != k && !(component.starts_with("belt_") && o.name().starts_with("belt_"))
        }) {
            let (a, b) = (plain.loss_j[*other], without.loss_j[*other]);
            // Only through torque, pressure and temperature; launch speed follows torque, the film's share is steep in temperature.
            let share = if *other == Component::LaunchClutch {
                0.15
            } else {
                0.10
            };
            assert!(
                (a - b).abs() <= share * a.abs() + 3e-3 * plain.loss_j.iter().sum::<f64>(),
                "{component} taken away moves {}: {a} -> {b} J",
                other.name()
            );
        }
    }
    // All at once: what remains is the launch clutch, the pump at 0.5 cc/rev and the slip of a stiff belt.
    let mut all: Vec<&str> = ZERO_LOSS
        .iter()
        .filter(|z| z.1 == "rover_216_cvt")
        .flat_map(|z| z.2.iter().copied())
        .collect();
    all.extend([
        "transmission.cvt.belt.youngs_gpa=500",
        "transmission.cvt.belt.strut_area_mm2=200",
        "transmission.cvt.pump.displacement_cc_rev=0.5",
        "transmission.cvt.pump.viscous_coefficient=0",
        "transmission.cvt.pump.lubrication_l_min=0",
        "transmission.cvt.pump.leakage_l_min_per_bar=0",
        "transmission.cvt.launch.friction_clutch.creep_nm=0",
    ]);
    let t = drive(&car("rover_216_cvt", &all), &c, &at(25.0, Start::Soak))
        .totals
        .total();
    let rest: Vec<String> = Component::ALL
        .iter()
        .filter(|k| t.loss_j[**k] > 0.0)
        .map(|k| format!("{} {:.2} kJ", k.name(), t.loss_j[*k] / 1e3))
        .collect();
    println!("all at once, left: {rest:?}");
    let lost: f64 = t.loss_j.iter().sum::<f64>() - t.loss_j[Component::LaunchClutch];
    assert!(lost < 0.03 * t.wheel_positive_j, "{rest:?}");
}

/// Property: a car with every length of time doubled and every force the same is the same car; here the simplest rescaling that
/// touches all: twice the mass, road load, torque and displacement on the same gears burns twice the fuel in a manual car
/// whose box losses, clutch, inertia, accessories, heat capacities and conductances are doubled too.
#[test]
fn twice_the_car_burns_twice_the_fuel() {
    let plain = car("rover_216_5mt", &[]);
    let mut sets = Vec::new();
    let doubled = [
        "road_load.mass_kg",
        "road_load.form.coefficients.f0_n",
        "road_load.form.coefficients.f2_n_per_kmh2",
        "engine.displacement_cc",
        "engine.rated_kw",
        "engine.inertia_kg_m2",
        "engine.inertia_torque_nm",
        "engine.electrical_w",
        "engine.accessory_nm",
        "transmission.manual.launch.friction_clutch.gain_nm_per_rpm2",
        "thermal.engine.block_kj_k",
        "thermal.engine.oil_kj_k",
        "thermal.engine.coolant_oil_w_k",
        "thermal.engine.block_air_w_k",
        "engine.fuel.start_g",
        "road_load.tyre.heat_capacity_kj_k",
        "road_load.tyre.still_w_k",
        "road_load.tyre.wind_w_k",
        "thermal.engine.block_air_w_k_per_m_s",
        "thermal.engine.pan_air_w_k",
        "thermal.engine.pan_air_w_k_per_m_s",
        "thermal.radiator.fan_w_k",
        "thermal.radiator.ram_w_k_per_m_s",
        "thermal.transmission.oil_l",
        "thermal.transmission.metal_kj_k",
        "thermal.transmission.oil_metal_w_k",
        "thermal.transmission.case_air_w_k",
        "thermal.transmission.case_air_v07_w_k",
        "thermal.transmission.bell_housing_w_k",
    ];
    let number = |key: &str| -> f64 {
        let info = plain.keys.iter().find(|k| k.key == key);
        let info = info.unwrap_or_else(|| panic!("no key {key}"));
        info.value.parse().unwrap()
    };
    for key in doubled {
        sets.push(format!("{key}={:?}", 2.0 * number(key)));
    }
    let line = plain
        .keys
        .iter()
        .find(|k| k.key == "engine.full_load")
        .unwrap();
    let rows: Vec<Vec<f64>> = serde_json::from_str(&line.value).unwrap();
    sets.push(format!(
        "engine.full_load={:?}",
        rows.iter()
            .map(|r| vec![r[0], 2.0 * r[1]])
            .collect::<Vec<_>>()
    ));
    // Bearings and seals by their number, teeth by their width; churning without the root of the oil's volume, which is doubled for its heat (CH-1).
    sets.extend([
        "transmission.manual.gears.bearings=[[0, 4, 50, 30, 2, 0], [1, 4, 50, 30, 4, 0.9], [2, 4, 62, 45, 4, 1.8]]".into(),
        "transmission.manual.gears.seals=[[0, 2, 25], [2, 4, 38]]".into(),
        "transmission.manual.gears.stages=[[75, 2.25, 40, 28], [115, 2.6, 60, 28]]".into(),
        format!(
            "transmission.manual.gears.churning_factor={:?}",
            2.0 * number("transmission.manual.gears.churning_factor") / 2f64.powf(0.1)
        ),
    ]);
    let twice = try_car("rover_216_5mt", &sets).unwrap();
    for cycle_name in ["ece15_eudc", "us06"] {
        let c = cycle(cycle_name);
        let a = drive(&plain, &c, &at(-10.0, Start::Soak));
        let b = drive(&twice, &c, &at(-10.0, Start::Soak));
        let (fa, fb) = (a.totals.total().fuel_kg, b.totals.total().fuel_kg);
        println!("{cycle_name}: {:.6} times the fuel", fb / fa);
        // The launch clutch's rounding torque (LC-1) and the radiator do not change this; the width of creeping does, a little.
        assert!(
            (fb / fa - 2.0).abs() < 2e-3,
            "{cycle_name}: {fa} and {fb} kg"
        );
        for k in 0..4 {
            assert!(
                (a.end.node_k[k] - b.end.node_k[k]).abs() < 0.2,
                "{cycle_name}: {:?} and {:?}",
                a.end,
                b.end
            );
        }
    }
}

/// Property, signs only: a better box, a lighter car and warmer oil from less cooling never cost fuel. A heat exchanger from the coolant
/// is printed: it warms the box but robs the engine, so that the sign depends on its size.
#[test]
fn improvements_save_fuel() {
    let c = cycle("ece15_eudc");
    let plain = drive(&car("rover_216_cvt", &[]), &c, &at(-10.0, Start::Soak));
    for size in [25, 50, 100, 150, 300] {
        let o = drive(
            &car(
                "rover_216_cvt",
                &[&format!("thermal.transmission.exchanger_w_k={size}")],
            ),
            &c,
            &at(-10.0, Start::Soak),
        );
        let change = 100.0 * (consumption(&o, &c, None) / consumption(&plain, &c, None) - 1.0);
        let t = o.end.node_k.map(|k| k - ZERO);
        println!(
            "exchanger {size} W/K: {change:+.2} % fuel, coolant {:.0}, engine oil {:.0}, sump {:.0} degC",
            t[0], t[1], t[2]
        );
    }
    for set in [
        "transmission.cvt.pump.displacement_cc_rev=7",
        "lubricant.friction.band=0.11",
        "transmission.cvt.final_drive.roughness_um=0.3",
        "road_load.mass_kg=1020",
        "engine.electrical_w=200",
        "thermal.cooler.bypassed=true",
        "transmission.cvt.clamp=torque_following",
        "transmission.cvt.clamp=slip_limited",
        "transmission.cvt.pump.kind=variable",
        "transmission.cvt.pump.kind=dual_cavity",
    ] {
        let o = drive(&car("rover_216_cvt", &[set]), &c, &at(-10.0, Start::Soak));
        let change = 100.0 * (consumption(&o, &c, None) / consumption(&plain, &c, None) - 1.0);
        println!(
            "{set}: {change:+.2} % fuel, sump {:.1} degC, ledger {:e}",
            o.end.node_k[2] - ZERO,
            o.totals.ledger_error
        );
        assert!(change < 0.0, "{set}: {change:+.3} %");
        assert!(
            o.totals.ledger_error < 1e-9 && o.totals.worst_residual < 1e-7,
            "{set}: ledger {:e}, residual {:e}",
            o.totals.ledger_error,
            o.totals.worst_residual
        );
    }
}
