//! Figures of pump, shafts, final drive, launch clutch and manual box.

use super::reference::{RPM, Reference};
use super::{Line, LinePanel, axes, plot, sweep};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::transmission::coupling::{Coupling, CouplingLoad};
use cvtcycle::model::transmission::cvt::pulley_bearing::PulleyBearing;
use cvtcycle::model::transmission::cvt::pump::{Pump, PumpKind};
use cvtcycle::model::transmission::cvt::seal_ring::SealRing;
use cvtcycle::model::transmission::cvt::variator::BeltAtRatio;
use cvtcycle::model::transmission::cvt::viscosity_power;
use cvtcycle::model::transmission::gear_train::TurningTrain;
use cvtcycle::output::Component;

const SPEED: &str = "Engine speed [rpm]";
const LITRES_MIN: f64 = 60_000.0;

/// Figures by file name.
pub fn figures(r: &Reference) -> Vec<(&'static str, String)> {
    vec![
        ("pump_torque", pump(r)),
        ("pump_flow", flow(r)),
        ("input_shaft_torque", input_shaft(r)),
        ("reverse_clutch_drag", reverse_clutch(r)),
        ("seal_ring_torque", seal_ring(r)),
        ("pulley_bearing_torque", pulley_bearing(r)),
        ("gear_train_parts", gear_train(r)),
        ("final_drive_torque", final_drive(r)),
        ("launch_speed", launch(r)),
        ("manual_torque", manual(r)),
    ]
}

fn eta(r: &Reference, degc: f64) -> f64 {
    r.oil().dynamic_pa_s(degc + ZERO_DEGC_K)
}

fn nu(r: &Reference, degc: f64) -> f64 {
    r.oil().kinematic_m2_s(degc + ZERO_DEGC_K)
}

fn pump(r: &Reference) -> String {
    let torque = |pump: &Pump, rpm: f64, bar: f64, degc: f64| {
        let (pa, eta) = (bar * 1e5, eta(r, degc));
        pump.state(&pump.at(eta), rpm * RPM, pa, pump.steady_need_m3_s(pa, eta))
            .torque_nm
    };
    let fixed = r.cvt().pump;
    let states = [
        (1000.0, 80.0),
        (3000.0, 80.0),
        (1000.0, 25.0),
        (3000.0, 25.0),
    ];
    let over_pressure: Vec<Line> = states
        .iter()
        .map(|&(n, t)| {
            sweep(&format!("{n:.0} rpm, {t:.0} degC"), 0.0, 40.0, 80, |p| {
                torque(&fixed, n, p, t)
            })
        })
        .collect();
    plot(
        "Pump torque against pressure",
        "fixed displacement of the Rover (PU-1)",
        "Torque at the pump shaft against secondary pressure at two speeds and two oil temperatures.",
        "",
        vec![axes(
            "",
            "Secondary pressure [bar]",
            "Pump torque [Nm]",
            over_pressure,
        )],
    )
}

fn flow(r: &Reference) -> String {
    let kinds = [
        ("fixed", PumpKind::Fixed),
        (
            "two cavities, share 0.5",
            PumpKind::DualCavity { share: 0.5 },
        ),
        ("variable, least 0.25", PumpKind::Variable { least: 0.25 }),
    ];
    let eta = eta(r, 80.0);
    let pa = 20e5;
    let state = |kind: PumpKind, rpm: f64| {
        let pump = Pump {
            kind,
            ..r.cvt().pump
        };
        pump.state(&pump.at(eta), rpm * RPM, pa, pump.steady_need_m3_s(pa, eta))
    };
    let over = |part: &dyn Fn(PumpKind, f64) -> f64| -> Vec<Line> {
        kinds
            .iter()
            .map(|&(name, kind)| sweep(name, 500.0, 4000.0, 140, |n| part(kind, n)))
            .collect()
    };
    let mut flows = over(&|kind, n| LITRES_MIN * state(kind, n).working_m3_s);
    flows.push(sweep("need without shift", 500.0, 4000.0, 2, |_| {
        LITRES_MIN * r.cvt().pump.steady_need_m3_s(pa, eta)
    }));
    let torques = over(&|kind, n| state(kind, n).torque_nm);
    plot(
        "Fixed, dual-cavity and variable pump",
        "20 bar, oil at 80 degC, no shift (PU-2, PU-4)",
        "Flow that works against pressure and torque of three kinds of pump against speed.",
        "",
        vec![
            axes("Working flow", SPEED, "Flow [l/min]", flows),
            axes("Torque", SPEED, "Pump torque [Nm]", torques),
        ],
    )
}

fn input_shaft(r: &Reference) -> String {
    let shaft = r.cvt().shaft_drag;
    let line = |degc: f64| {
        let power = viscosity_power(nu(r, degc), shaft.exponent);
        sweep(&format!("{degc:.0} degC"), 1000.0, 4000.0, 60, |n| {
            shaft.torque_nm(power, n * RPM)
        })
    };
    plot(
        "Input shaft torque",
        "fluid of the Rover (IS-1)",
        "Input shaft torque against engine speed at four oil temperatures.",
        "",
        vec![axes(
            "",
            SPEED,
            "Torque [Nm]",
            [25.0, 50.0, 75.0, 95.0].map(line).to_vec(),
        )],
    )
}

fn reverse_clutch(r: &Reference) -> String {
    let clutch = r.cvt().clutch_drag;
    let drag = sweep("", -20.0, 100.0, 240, |t| {
        clutch.torque_nm(viscosity_power(nu(r, t), clutch.exponent), 2000.0 * RPM)
    });
    plot(
        "Reverse clutch drag",
        "fluid of the Rover at 2000 rpm (CD-1)",
        "Drag of the open reverse clutch against oil temperature.",
        "",
        vec![axes(
            "",
            "Oil temperature [degC]",
            "Torque [Nm]",
            vec![drag],
        )],
    )
}

fn seal_ring(r: &Reference) -> String {
    let with = |friction: f64| {
        let ring = SealRing {
            friction,
            ..r.cvt().seal_ring
        };
        sweep(&format!("friction {friction:.3}"), 0.0, 40.0, 2, |bar| {
            ring.torque_per_pa() * bar * 1e5
        })
    };
    plot(
        "Seal rings of a pulley",
        "rings of the Rover with their friction and the ends of its range (SR-1)",
        "Friction torque of the seal rings of one pulley against the pressure in its cylinder, for three coefficients of friction.",
        "",
        vec![axes(
            "",
            "Pressure of the cylinder [bar]",
            "Torque [Nm]",
            vec![with(0.03), with(r.cvt().seal_ring.friction), with(0.06)],
        )],
    )
}

fn pulley_bearing(r: &Reference) -> String {
    let cvt = r.cvt();
    let at = |ratio: f64| {
        let per_n = PulleyBearing::pull_per_clamp(&cvt.belt, &BeltAtRatio::new(&cvt.belt, ratio));
        sweep(&format!("I = {ratio}"), 0.0, 40.0, 2, |kn| {
            cvt.pulley_bearing.torque_nm(0, per_n * kn * 1e3)
        })
    };
    plot(
        "Bearings of a pulley under the belt's pull",
        "primary of the Rover (PB-1, PB-2)",
        "Friction torque of the bearings of the primary shaft against the clamping force of the secondary, in low, at 1 and in high ratio.",
        "",
        vec![axes(
            "",
            "Clamping force of the secondary [kN]",
            "Torque at the shaft [Nm]",
            [2.417, 1.0, 0.5].map(at).to_vec(),
        )],
    )
}

fn gear_train(r: &Reference) -> String {
    let train = &r.cvt().final_drive.train;
    let oil = r.cvt_car.oils().0;
    let parts = |degc: f64| -> Vec<Line> {
        let state = oil.state(degc + ZERO_DEGC_K);
        let part = |name: &str, component: fn(&TurningTrain) -> f64| {
            sweep(name, 200.0, 8000.0, 90, |n| {
                component(&train.turning(n * RPM, 0.0, state))
            })
        };
        vec![
            part("bearings, preload included", |t| t.bearing_nm),
            part("churning", |t| t.churning_nm),
            part("seals", |t| t.seal_nm),
        ]
    };
    let x = "Speed of the secondary [rpm]";
    let y = "Torque at the secondary [Nm]";
    plot(
        "Parts of a gear train without load",
        "final drive of the Rover (BR-1, BR-2, CH-1, LS-1)",
        "Torque without load of bearings, churning and seals of the Rover's final drive against the speed of the secondary, at 80 and at -10 degC.",
        "",
        vec![
            axes("80 degC", x, y, parts(80.0)),
            axes("-10 degC", x, y, parts(-10.0)),
        ],
    )
}

fn final_drive(r: &Reference) -> String {
    let train = &r.cvt().final_drive.train;
    let oil = r.cvt_car.oils().0;
    let lines = |ratio: f64, from: f64| -> Vec<Line> {
        [-30.0, 0.0, 25.0, 50.0, 95.0]
            .map(|degc| {
                let state = oil.state(degc + ZERO_DEGC_K);
                sweep(&format!("{degc:.0} degC"), from, 4000.0, 90, |n| {
                    let turning = train.turning(n * RPM / ratio, 0.0, state);
                    turning.input_nm(0.0) / ratio
                })
            })
            .to_vec()
    };
    let x = "Input speed [rpm]";
    let y = "Torque at the primary shaft [Nm]";
    plot(
        "Final drive at no load, referred to the input",
        "FD-1 and FD-2, fluid of the Rover; below 25 degC unmeasured",
        "No-load torque of the final drive, divided by the belt ratio, against input speed at five oil temperatures in low and high ratio.",
        "",
        vec![
            axes("I = 2.417", x, y, lines(2.4169, 1000.0)),
            axes("I = 0.5", x, y, lines(0.5, 1750.0)),
        ],
    )
}

fn launch(r: &Reference) -> String {
    let launch = &r.cvt().coupling;
    let idle = r.cvt_car.car(298.15).engine.idle_hot_rad_s;
    let line = |rpm: f64, coupled: bool, name: &str| {
        sweep(name, 0.0, 100.0, 200, |t| {
            launch.engine_rad_s(&CouplingLoad::new(t, rpm * RPM, idle, coupled)) / RPM
        })
    };
    let speeds = vec![
        line(0.0, false, "shaft below idle, opening or closing"),
        line(1300.0, false, "shaft at 1300 rpm, not yet locked"),
        line(1300.0, true, "shaft at 1300 rpm, locked"),
    ];
    let shares = vec![
        sweep(
            "creep torque over its value at rest",
            0.0,
            1500.0,
            300,
            |n| launch.creep_nm(n * RPM, idle) / launch.creep_nm(0.0, idle),
        ),
        sweep("share of overrun torque carried", 0.0, 1500.0, 300, |n| {
            launch.overrun_share(n * RPM, idle)
        }),
    ];
    plot(
        "Launch clutch",
        "friction clutch of the Rover, idle at 850 rpm (LC-1 to LC-5)",
        "Engine speed against clutch torque while slipping and locked; creep torque and overrun share against input shaft speed.",
        "",
        vec![
            LinePanel {
                with_y: vec![800.0],
                ..axes(
                    "Engine speed",
                    "Clutch torque [Nm]",
                    "Engine speed [rpm]",
                    speeds,
                )
            },
            axes(
                "Creeping and letting go",
                "Input shaft speed [rpm]",
                "Share [-]",
                shares,
            ),
        ],
    )
}

fn manual(r: &Reference) -> String {
    let box_ = r.manual();
    let oil = r.manual_car.oils().0;
    let loss = |n: f64, degc: f64, wanted: &[Component]| {
        let k = degc + ZERO_DEGC_K;
        let engaged = box_.engaged(3, n * RPM, 0.0, (oil.state(k), k));
        let (parts, _) = engaged.losses_nm(0.0);
        parts
            .iter()
            .filter(|(part, _)| wanted.contains(part))
            .map(|(_, nm)| nm)
            .sum::<f64>()
    };
    let all = [Component::Seal, Component::Bearing, Component::Churning];
    let sum = |degc: f64| {
        sweep(&format!("sum, {degc:.0} degC"), 500.0, 5000.0, 90, |n| {
            loss(n, degc, &all)
        })
    };
    let part =
        |name: &str, part: Component| sweep(name, 500.0, 5000.0, 90, |n| loss(n, 80.0, &[part]));
    let published = sweep("published, hot", 500.0, 5000.0, 2, |n| {
        0.925 + 0.000_407 * n
    });
    let y = "Torque at the input shaft [Nm]";
    let parts = vec![
        part("seals", all[0]),
        part("bearings", all[1]),
        part("churning", all[2]),
        published,
    ];
    plot(
        "Manual box at no load",
        "gear oil of the sister car (MB-2 to MB-4)",
        "Sum of seal, bearing and churning torque against speed at three temperatures, and the parts at 80 degC with the published line.",
        "",
        vec![
            axes("Sum", SPEED, y, [-10.0, 25.0, 80.0].map(sum).to_vec()),
            axes("Parts at 80 degC", SPEED, y, parts),
        ],
    )
}
