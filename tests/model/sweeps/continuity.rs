//! Continuity: every loss, the pressure, the engine speed and the slip change a little when an input changes a little, across
//! every change of regime. Property: the largest difference between neighbours nearly halves when the step is halved.
#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    clippy::print_stdout,
    reason = "tests say what they found"
)]

use crate::common::bench_step::{Bench, Setting};
use crate::common::{RPM, ZERO, car, component_names, larger};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::thermal::{COOLANT, Heat, HeatInput, SUMP};
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::{StepOutput, Transmission};

/// Quantities that must be continuous: losses W, engine speed rad/s, flywheel torque Nm, throttle, pressure bar, slip, output W, brake W, deficit W.
const EXTRA: [&str; 9] = [
    "engine_speed",
    "flywheel_torque",
    "throttle",
    "pressure",
    "slip",
    "output",
    "brake",
    "deficit",
    NOT_CONVERGED,
];
/// 1 where the solve gave up.
const NOT_CONVERGED: &str = "not_converged";
const COUNT: usize = Component::COUNT + EXTRA.len();

fn values(d: &StepOutput) -> [f64; COUNT] {
    let number = |x: f64| if x.is_finite() { x } else { 0.0 };
    let mut v = [0.0; COUNT];
    v[..Component::COUNT].copy_from_slice(&d.loss_w.0);
    let extra = [
        d.engine_rad_s,
        d.shaft_nm,
        d.throttle,
        number(d.secondary_pa) * 1e-5,
        number(d.slip),
        d.output_w,
        d.brake_w,
        d.deficit_w,
        f64::from(u8::from(d.flags.contains(Flags::NOT_CONVERGED))),
    ];
    v[Component::COUNT..].copy_from_slice(&extra);
    v
}

/// Differences below these come from the rest that the solve leaves, in the unit of the value.
fn noise(k: usize, scale: f64) -> f64 {
    if k < Component::COUNT {
        2e-2 + 1e-7 * scale
    } else {
        1e-5 + 2e-6 * scale
    }
}

/// Largest difference between neighbours of each value, where it lies, and the largest value.
fn largest(
    step: f64,
    from: f64,
    to: f64,
    f: &dyn Fn(f64) -> [f64; COUNT],
) -> [(f64, f64, f64); COUNT] {
    let n = ((to - from) / step).round() as usize;
    let mut worst = [(0.0f64, f64::NAN, 0.0f64); COUNT];
    let mut last = f(from);
    for i in 1..=n {
        let x = from + step * i as f64;
        let now = f(x);
        for k in 0..COUNT {
            let d = (now[k] - last[k]).abs();
            if d.is_nan() || d > worst[k].0 {
                (worst[k].0, worst[k].1) = (d, x);
            }
            worst[k].2 = larger(now[k].abs(), worst[k].2);
        }
        last = now;
    }
    worst
}

/// Compares the largest differences of a step and of half of it; a jump keeps its size.
fn check(
    label: &str,
    step: f64,
    from: f64,
    to: f64,
    f: &dyn Fn(f64) -> [f64; COUNT],
    jumps: &mut Vec<String>,
) {
    let (a, b) = (largest(step, from, to, f), largest(0.5 * step, from, to, f));
    let names = component_names();
    for k in 0..COUNT {
        let name = if k < Component::COUNT {
            names[k]
        } else {
            EXTRA[k - Component::COUNT]
        };
        if name == NOT_CONVERGED && b[k].2 > 0.0 {
            jumps.push(format!("{label}: the solve gives up, near {:.5}", b[k].1));
        } else if b[k].0.is_nan() || b[k].0 > 0.6 * a[k].0 + noise(k, a[k].2) {
            // Some stretches are narrower than the step, under the following clamp laws above all: steep, not a jump, if another halving shrinks them.
            let finer = |part: f64| largest(part * step, from, to, f)[k].0;
            let shrinks = |wide: f64, narrow: f64| narrow <= 0.6 * wide + noise(k, a[k].2);
            let quarter = finer(0.25);
            if shrinks(b[k].0, quarter) || shrinks(quarter, finer(0.125)) {
                continue;
            }
            jumps.push(format!(
                "{label}: {name} differs by {:.4e}, at half the step by {:.4e}, near {:.5} (largest value {:.3e})",
                a[k].0, b[k].0, b[k].1, a[k].2
            ));
        }
    }
}

fn report(jumps: &[String]) {
    assert!(
        jumps.is_empty(),
        "{} jumps:\n{}",
        jumps.len(),
        jumps.join("\n")
    );
}

/// CVTs with the Rover's clamp law, and with the parts whose control changes regime.
const SHIPPED: [(&str, &[&str]); 4] = [
    ("map", &[]),
    ("dual_cavity", &["transmission.cvt.pump.kind=dual_cavity"]),
    ("variable", &["transmission.cvt.pump.kind=variable"]),
    (
        "uncompensated",
        &["transmission.cvt.variator.compensated=false"],
    ),
];

/// CVTs whose clamp follows the torque, so that pressure takes part in every change of regime.
const FOLLOWING: [(&str, &[&str]); 2] = [
    (
        "torque_following",
        &["transmission.cvt.clamp=torque_following"],
    ),
    ("slip_limited", &["transmission.cvt.clamp=slip_limited"]),
];

fn benches(variants: &[(&'static str, &[&str])]) -> Vec<(&'static str, Bench)> {
    variants
        .iter()
        .map(|(name, sets)| (*name, Bench::new(&car("rover_216_cvt", sets))))
        .collect()
}

fn sweep_ratio(name: &str, bench: &Bench, jumps: &mut Vec<String>) {
    for (rpm, input_nm) in [
        (2000.0, -12.0),
        (2000.0, 0.0),
        (2000.0, 40.0),
        (2000.0, 100.0),
        (4000.0, 60.0),
    ] {
        let f = |ratio: f64| {
            let wheel_rad_s = rpm * RPM / bench.overall(ratio);
            let wheel_nm = input_nm * bench.overall(ratio);
            values(&bench.solve(&Setting {
                ratio,
                wheel_rad_s,
                wheel_nm,
                ..Setting::default()
            }))
        };
        check(
            &format!("{name}, ratio at {rpm} rpm {input_nm} Nm"),
            1e-3,
            0.42,
            2.45,
            &f,
            jumps,
        );
    }
}

fn sweep_torque(name: &str, bench: &Bench, jumps: &mut Vec<String>) {
    for (ratio, rpm) in [
        (2.4169, 1500.0),
        (2.35, 3000.0),
        (1.0, 2000.0),
        (1.004, 2000.0),
        (0.7, 1100.0),
        (0.4137, 2500.0),
        (0.4137, 1000.0),
    ] {
        for coupled in [true, false] {
            let overall = bench.overall(ratio);
            let f = |input_nm: f64| {
                let wheel_rad_s = rpm * RPM / overall;
                values(&bench.solve(&Setting {
                    ratio,
                    wheel_rad_s,
                    wheel_nm: input_nm * overall,
                    coupled,
                    ..Setting::default()
                }))
            };
            check(
                &format!("{name}, torque at ratio {ratio} {rpm} rpm coupled {coupled}"),
                0.1,
                -60.0,
                180.0,
                &f,
                jumps,
            );
        }
    }
}

fn sweep_speed(name: &str, bench: &Bench, torques_nm: &[f64], jumps: &mut Vec<String>) {
    for ratio in [2.4169, 1.2, 0.4137] {
        let overall = bench.overall(ratio);
        for &input_nm in torques_nm {
            for (coupled, engine_degc) in
                [(true, -10.0), (true, 90.0), (false, -10.0), (false, 90.0)]
            {
                let f = |rpm: f64| {
                    let s = Setting {
                        ratio,
                        wheel_rad_s: rpm * RPM / overall,
                        wheel_nm: input_nm * overall,
                        coupled,
                        engine_degc,
                        ..Setting::default()
                    };
                    values(&bench.solve(&s))
                };
                let label = format!(
                    "{name}, speed at ratio {ratio} {input_nm} Nm coupled {coupled} engine {engine_degc} degC"
                );
                check(&label, 1.0, 0.5, 3500.0, &f, jumps);
            }
        }
    }
}

fn sweep_temperature(name: &str, bench: &Bench, jumps: &mut Vec<String>) {
    for (ratio, rpm, input_nm) in [
        (2.4169, 1500.0, 20.0),
        (0.4137, 2500.0, 20.0),
        (0.4137, 3900.0, -10.0),
        (1.5, 950.0, 10.0),
    ] {
        for coupled in [true, false] {
            let overall = bench.overall(ratio);
            let f = |t: f64| {
                let s = Setting {
                    ratio,
                    wheel_rad_s: rpm * RPM / overall,
                    wheel_nm: input_nm * overall,
                    sump_degc: t,
                    belt_degc: t,
                    engine_degc: t,
                    coupled,
                };
                values(&bench.solve(&s))
            };
            check(
                &format!(
                    "{name}, temperature at ratio {ratio} {rpm} rpm {input_nm} Nm coupled {coupled}"
                ),
                0.1,
                -30.0,
                120.0,
                &f,
                jumps,
            );
        }
    }
}

fn over(variants: &[(&'static str, &[&str])], sweep: impl Fn(&str, &Bench, &mut Vec<String>)) {
    let mut jumps = Vec::new();
    for (name, bench) in &benches(variants) {
        sweep(name, bench, &mut jumps);
    }
    report(&jumps);
}

/// Ratio from overdrive across 1 to the end stop and beyond it, at constant primary speed, in overrun, at no load, in drive.
#[test]
fn continuous_in_ratio() {
    over(&SHIPPED, sweep_ratio);
}

/// Torque from deep overrun (brakes), through zero and the breakpoint of segment compression, to full load and beyond it.
#[test]
fn continuous_in_torque() {
    over(&SHIPPED, sweep_torque);
}

/// Speed from standstill through engagement, idle speed, release and lock-up, pulling and braking, coming from either side.
#[test]
fn continuous_in_speed() {
    over(&SHIPPED, |name, bench, jumps| {
        sweep_speed(
            name,
            bench,
            &[-30.0, -6.0, 0.0, 3.0, 25.0, 90.0, 160.0],
            jumps,
        )
    });
}

/// Temperature of oil, belt and engine from -30 to 120 degC, across idle raise, enrichment's end, band floor and film lift-off.
#[test]
fn continuous_in_temperature() {
    over(&SHIPPED, sweep_temperature);
}

/// The same sweeps where the clamp follows the torque or limits the slip, over ratio and temperature.
#[test]
fn following_clamps_are_continuous_in_ratio_and_temperature() {
    over(&FOLLOWING, |name, bench, jumps| {
        sweep_ratio(name, bench, jumps);
        sweep_temperature(name, bench, jumps);
    });
}

/// The same over torque.
#[test]
fn following_clamps_are_continuous_in_torque() {
    over(&FOLLOWING, sweep_torque);
}

/// The same over speed.
#[test]
fn following_clamps_are_continuous_in_speed() {
    over(&FOLLOWING, |name, bench, jumps| {
        sweep_speed(name, bench, &[-30.0, -6.0, 25.0, 90.0], jumps)
    });
}

/// Torque up to the belt's capacity and into gross slip, with a clamp that is far too weak.
#[test]
fn continuous_into_gross_slip() {
    let mut jumps = Vec::new();
    let sets = [
        "transmission.cvt.clamp.map.base_bar=6",
        "transmission.cvt.clamp.map.throttle_bar=0",
        "transmission.cvt.pressure.control_bar=1",
    ];
    let bench = Bench::new(&car("rover_216_cvt", &sets));
    let mut slipped = 0;
    for (ratio, rpm) in [
        (2.4169, 2000.0),
        (1.3, 2000.0),
        (0.9, 2500.0),
        (0.4137, 3000.0),
    ] {
        let overall = bench.overall(ratio);
        let solve = |input_nm: f64| {
            bench.solve(&Setting {
                ratio,
                wheel_rad_s: rpm * RPM / overall,
                wheel_nm: input_nm * overall,
                ..Setting::default()
            })
        };
        slipped += (0..180)
            .filter(|i| {
                solve(f64::from(*i))
                    .flags
                    .contains(cvtcycle_model::flags::Flags::GROSS_SLIP)
            })
            .count();
        // Half the step of the other sweeps: slip runs into its bound within 0.1 Nm.
        check(
            &format!("weak clamp, torque at ratio {ratio}"),
            0.05,
            -40.0,
            180.0,
            &|t| values(&solve(t)),
            &mut jumps,
        );
    }
    assert!(slipped > 20, "gross slip was reached {slipped} times");
    report(&jumps);
}

/// Rolling infinitely slowly without torque is standing: what a standing car loses is the limit of what a creeping one loses.
#[test]
fn standstill_is_the_limit_of_creeping() {
    for (name, bench) in &benches(&SHIPPED)
        .into_iter()
        .chain(benches(&FOLLOWING))
        .collect::<Vec<_>>()
    {
        let ratio = 2.4169;
        let rests = values(&bench.solve(&Setting {
            ratio,
            wheel_rad_s: 0.0,
            coupled: false,
            ..Setting::default()
        }));
        let creeps = values(&bench.solve(&Setting {
            ratio,
            wheel_rad_s: 1e-7,
            wheel_nm: -1.0,
            coupled: false,
            ..Setting::default()
        }));
        let names = component_names();
        for k in 0..COUNT {
            let label = if k < Component::COUNT {
                names[k]
            } else {
                EXTRA[k - Component::COUNT]
            };
            if label == "slip" {
                continue; // a standing belt is said not to slip
            }
            let scale = rests[k].abs() + creeps[k].abs();
            assert!(
                (rests[k] - creeps[k]).abs() < 1e-4 * scale + 1e-4,
                "{name} {label}: {} standing, {} creeping",
                rests[k],
                creeps[k]
            );
        }
    }
}

/// The manual box over torque, speed and temperature in three of its gears.
#[test]
fn manual_box_is_continuous() {
    let mut jumps = Vec::new();
    let all = Bench::new(&car("rover_216_5mt", &[]));
    for number in [1.0, 3.0, 5.0] {
        // A box of one gear: taking a lower gear where torque is missing is a jump by nature.
        let overall = all.overall(number);
        let mut bench = Bench::new(&car("rover_216_5mt", &[]));
        if let Transmission::Manual(manual) = &mut bench.car.transmission {
            manual.overall = vec![overall];
        }
        let gear = 1.0;
        for coupled in [true, false] {
            let setting = |rpm: f64, input_nm: f64, t: f64| Setting {
                ratio: gear,
                wheel_rad_s: rpm * RPM / overall,
                wheel_nm: input_nm * overall,
                sump_degc: t,
                engine_degc: t,
                coupled,
                ..Setting::default()
            };
            for rpm in [700.0, 1100.0, 2500.0] {
                let f = |nm: f64| values(&bench.solve(&setting(rpm, nm, 60.0)));
                check(
                    &format!("manual, torque in gear {number} at {rpm} rpm coupled {coupled}"),
                    0.1,
                    -60.0,
                    180.0,
                    &f,
                    &mut jumps,
                );
            }
            for nm in [-30.0, -1.0, 0.0, 25.0, 160.0] {
                let f = |rpm: f64| values(&bench.solve(&setting(rpm, nm, 60.0)));
                check(
                    &format!("manual, speed in gear {number} at {nm} Nm coupled {coupled}"),
                    1.0,
                    0.5,
                    3500.0,
                    &f,
                    &mut jumps,
                );
            }
            let f = |t: f64| values(&bench.solve(&setting(1800.0, 30.0, t)));
            check(
                &format!("manual, temperature in gear {number} coupled {coupled}"),
                0.1,
                -30.0,
                120.0,
                &f,
                &mut jumps,
            );
        }
    }
    report(&jumps);
}

/// Heat to the air over coolant and sump temperature, across thermostat and cooler bypass. In the limit of a short step: the
/// linearised step itself has a bend of its slope at the thermostat's ends.
#[test]
fn heat_to_the_air_is_continuous() {
    let mut jumps = Vec::new();
    for (name, sets) in [
        ("always open", &[][..]),
        (
            "bypass below 60 degC",
            &["thermal.cooler.bypass_below_degc=60"][..],
        ),
    ] {
        let setup = car("rover_216_cvt", sets);
        let sim = setup.car(ZERO);
        for node in [COOLANT, SUMP] {
            let f = |t: f64| {
                let mut heat = Heat::uniform(ZERO + 50.0);
                heat.node_k[node] = ZERO + t;
                let input = HeatInput {
                    power_w: [3000.0, 500.0, 500.0, 300.0, 700.0],
                    ambient_k: ZERO,
                    speed_m_s: 15.0,
                    pump_rad_s: 200.0,
                    oil_flow_m3_s: 3e-4,
                    oil_volume_heat_j_m3k: 1.7e6,
                    dt_s: 1e-6,
                    running: true,
                };
                let s = sim.network.advance(&heat, &input);
                let mut v = [0.0; COUNT];
                v[0] = s.to_air_w;
                v[1] = s.stored_w;
                v[2..7].copy_from_slice(&s.heat.node_k);
                v
            };
            check(
                &format!("{name}, node {node} (first two values: to air, stored)"),
                0.1,
                -30.0,
                120.0,
                &f,
                &mut jumps,
            );
        }
    }
    report(&jumps);
}
