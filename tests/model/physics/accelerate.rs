//! Full throttle: against closed forms and an integration of its own, conservation, and what must make it slower.

use crate::common::{ZERO, car};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{Accelerated, Driven, FullThrottle, Grip, accelerate};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::thermal::Heat;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

/// Without the rolling resistance that tyres have while they are cold (RL-6).
const COLD_TYRES: &str = "road_load.tyre.rolling_coefficient=0";

/// Without road load, accessories and rotating wheels.
const BARE: [&str; 6] = [
    COLD_TYRES,
    "road_load.form.coefficients.f0_n=0",
    "road_load.form.coefficients.f1_n_per_kmh=0",
    "road_load.form.coefficients.f2_n_per_kmh2=0",
    "engine.electrical_w=0",
    "engine.accessory_nm=0",
];

/// A car without losses in its box but those of its coupling.
fn lossless(name: &str, sets: &[&str]) -> Setup {
    let transmission = car(name, &[]).transmission().clone();
    let kind = if transmission.is_cvt() {
        "cvt"
    } else {
        "manual"
    };
    let own = transmission.components().into_iter();
    let own = own.filter(|component| *component != Component::LaunchClutch);
    let zero =
        own.map(|component| format!("transmission.{kind}.loss_factor.{}=0", component.name()));
    let zero: Vec<String> = zero.collect();
    let all: Vec<&str> = sets
        .iter()
        .copied()
        .chain(zero.iter().map(String::as_str))
        .collect();
    car(name, &all)
}

fn asked(setup: &Setup, from_kmh: f64, to_kmh: f64) -> FullThrottle {
    FullThrottle {
        from_m_s: from_kmh / 3.6,
        to_m_s: to_kmh / 3.6,
        distance_m: 0.0,
        grade: 0.0,
        grip: None,
        shift_s: 0.5,
        gear: None,
        heat: (Heat::uniform(setup.engine().hot_k), 25.0 + ZERO),
        dt_s: 0.02,
    }
}

fn driven(setup: &Setup, asked: &FullThrottle) -> Accelerated {
    accelerate(&setup.car(25.0 + ZERO), asked)
}

fn time_s(found: &Accelerated, kmh: f64) -> f64 {
    found.time_to_speed_s(kmh / 3.6).expect("it gets there")
}

/// Truth: a car with constant power, t = m (v2 - v1)(v2 + v1)/(2 P). A CVT at the speed of greatest power is one, once its engine is there: no road load,
/// no accessory, no loss of the box.
#[test]
fn val_a_cvt_at_its_greatest_power_is_a_car_of_constant_power() {
    let setup = lossless("civic_20_cvt", &BARE);
    let found = driven(&setup, &asked(&setup, 0.0, 130.0));
    let (v1, v2) = (80.0 / 3.6, 120.0 / 3.6);
    let between: Vec<_> = found
        .steps
        .iter()
        .filter(|step| (v1..=v2).contains(&step.speed_m_s))
        .collect();
    let w = setup.engine().peak_power_rad_s();
    let power_w = setup.engine().full_load.at(w) * w;
    for step in &between {
        let now = step.row.engine_speed_rad_s;
        assert!(
            (now / w - 1.0).abs() < 2e-3,
            "{now} rad/s at {} m/s",
            step.speed_m_s
        );
    }
    let mass = setup.road_load.base.inertia_kg;
    let by_hand_s = mass * (v2 * v2 - v1 * v1) / (2.0 * power_w);
    let found_s = time_s(&found, 120.0) - time_s(&found, 80.0);
    println!("80 to 120 km/h at {power_w} W: {found_s} s, by hand {by_hand_s} s");
    assert!((found_s / by_hand_s - 1.0).abs() < 2e-3);
}

/// Truth: AC-3 by hand. With no road load and no rotating wheels mu m (g s - a h/L) = m a, so that a = mu g s/(1 + mu h/L) and t = v/a for a driven front axle;
/// a rear one has 1 - mu h/L, and four driven wheels a = mu g.
#[test]
fn val_grip_alone_gives_a_constant_acceleration() {
    let sets = [&BARE[..], &["road_load.rotating_factor=0"]].concat();
    let (mu, share, height, g) = (0.2, 0.6, 0.21, 9.80665);
    for name in ["civic_20_cvt", "civic_20_6mt"] {
        let setup = car(name, &sets);
        for (wheels, accel) in [
            (Driven::Front, mu * g * share / (1.0 + mu * height)),
            (Driven::Rear, mu * g * share / (1.0 - mu * height)),
            (Driven::All, mu * g),
        ] {
            let grip = Grip {
                mu,
                driven: wheels,
                axle_share: share,
                height_over_base: height,
            };
            let asked = FullThrottle {
                grip: Some(grip),
                ..asked(&setup, 0.0, 20.0)
            };
            let found = driven(&setup, &asked);
            let by_hand_s = 20.0 / 3.6 / accel;
            let found_s = time_s(&found, 20.0);
            println!("{name} {wheels:?}: {found_s} s, by hand {by_hand_s} s");
            assert!(
                (found_s / by_hand_s - 1.0).abs() < 1e-6,
                "{name} {wheels:?}: {found_s} {by_hand_s}"
            );
            assert!((found.grip_limited_s() - found_s).abs() <= asked.dt_s);
        }
        // On a slope, by hand: 10 % up, front-driven at rest.
        let grip = Grip::default();
        let (cos, sin) = (1.0 / 1.01_f64.sqrt(), 0.1 / 1.01_f64.sqrt());
        let load = 1000.0 * (9.80665 * (0.6 * cos - 0.21 * sin) - 0.21 * 2.0);
        assert!((grip.limit_n(1000.0, 2.0, 0.1) - 0.9 * load).abs() < 1e-9);
    }
}

/// Truth: an integration of its own (RK4) of (m + J i2/r2) dv/dt = T(w) i/r - F(v) in a kept gear, with a box that loses nothing.
#[test]
fn val_a_kept_gear_is_one_differential_equation() {
    let setup = lossless(
        "civic_20_6mt",
        &[COLD_TYRES, "engine.electrical_w=0", "engine.accessory_nm=0"],
    );
    let gear = 3;
    let found = driven(
        &setup,
        &FullThrottle {
            gear: Some(gear),
            ..asked(&setup, 60.0, 120.0)
        },
    );
    let Transmission::Manual(manual) = setup.transmission() else {
        panic!("a manual box")
    };
    let (i, car) = (
        manual.overall[usize::from(gear) - 1],
        setup.car(25.0 + ZERO),
    );
    let (engine, load) = (setup.engine(), &car.road_load);
    let r = load.wheel_radius_m;
    let mass = load.inertia_kg + engine.inertia_kg_m2 * i * i / (r * r);
    let accel = |v: f64| {
        let force = load.f0_n + load.f1_n_per_m_s * v + load.f2_n_per_m_s2 * v * v;
        (engine.full_load.at(i * v / r) * i / r - force) / mass
    };
    let (mut v, mut by_hand_s, dt) = (80.0 / 3.6, 0.0, 1e-3);
    while v < 120.0 / 3.6 {
        let a = accel(v);
        let b = accel(v + 0.5 * dt * a);
        let c = accel(v + 0.5 * dt * b);
        let d = accel(v + dt * c);
        v += dt * (a + 2.0 * b + 2.0 * c + d) / 6.0;
        by_hand_s += dt;
    }
    let found_s = time_s(&found, 120.0) - time_s(&found, 80.0);
    println!("third gear, 80 to 120 km/h: {found_s} s, by hand {by_hand_s} s");
    assert!((found_s / by_hand_s - 1.0).abs() < 1e-3);
}

/// Truth: conservation. Work at the wheels is what car and road took, work of the crank what wheels, losses, accessories and rotating parts took, and where nothing else
/// is the limit the crank is at full load; the power balance of every row closes.
#[test]
fn energy_is_conserved_and_the_engine_is_at_full_load() {
    for name in [
        "rover_216_cvt",
        "civic_20_cvt",
        "rover_216_5mt",
        "civic_20_6mt",
    ] {
        let setup = car(name, &[COLD_TYRES]);
        let car = setup.car(25.0 + ZERO);
        let found = driven(&setup, &asked(&setup, 0.0, 110.0));
        assert!(found.reached, "{name}");
        let load = &car.road_load;
        let (mut work_j, mut road_j, mut full, mut turning_j) = (0.0, 0.0, 0, 0.0);
        let mut from_m_s = 0.0;
        for step in &found.steps {
            let row = &step.row;
            assert!(
                row.power_ledger_error < 1e-9 && row.heat_ledger_error < 1e-9,
                "{name}"
            );
            assert!(
                row.deficit_w <= 1e-6 * setup.engine().rated_w,
                "{name}: {}",
                row.deficit_w
            );
            let (a, b) = (from_m_s, step.speed_m_s);
            let square = (a * a + a * b + b * b) / 3.0;
            let cube = (a + b) * (a * a + b * b) / 4.0;
            work_j += row.wheel_power_w * row.dt_s;
            road_j += (load.f0_n * 0.5 * (a + b)
                + load.f1_n_per_m_s * square
                + load.f2_n_per_m_s2 * cube)
                * row.dt_s;
            turning_j += row.kinetic_w * row.dt_s;
            from_m_s = b;
            let w = row.engine_speed_rad_s;
            let crank_nm = row.engine_torque_nm + (row.accessories_w + row.kinetic_w) / w;
            let hot = car
                .engine
                .at(row.coolant_k, row.engine_oil_k, &car.engine_oil, car.charge);
            let limit_nm = cvtcycle_model::prime_mover::PrimeMover::full_load_nm(&hot, w);
            assert!(
                crank_nm <= limit_nm * (1.0 + 1e-3),
                "{name}: {crank_nm} above {limit_nm}"
            );
            full += usize::from(crank_nm > 0.995 * limit_nm);
        }
        let kinetic_j = 0.5 * load.inertia_kg * from_m_s * from_m_s;
        assert!(((kinetic_j + road_j) / work_j - 1.0).abs() < 1e-9, "{name}");
        let last = found.steps.last().expect("steps").row.engine_speed_rad_s;
        let begun = setup.engine().idle_hot_rad_s;
        let by_speed_j = 0.5 * setup.engine().inertia_kg_m2 * (last * last - begun * begun);
        println!(
            "{name}: {full} of {} steps at full load, 0-100 km/h {} s",
            found.steps.len(),
            time_s(&found, 100.0)
        );
        assert!(
            (turning_j - by_speed_j).abs() < 0.02 * by_speed_j + 100.0,
            "{name}: {turning_j} {by_speed_j}"
        );
        // Changes of gear, and a ratio that is on its way, are the rest.
        assert!(
            full * 10 > found.steps.len() * 6,
            "{name}: {full} of {}",
            found.steps.len()
        );
        assert!(!found.has(Flags::OVERSPEED), "{name}");
    }
}

/// Property: load, slope, cold oil, less grip and longer changes cost time; a change costs about its own time. Truth: their sign; and order of the step: half a step
/// moves the time by less than a step does.
#[test]
fn what_hinders_costs_time() {
    for name in ["rover_216_cvt", "civic_20_cvt", "civic_20_6mt"] {
        let setup = car(name, &[]);
        let base = FullThrottle {
            grip: Some(Grip::default()),
            dt_s: 0.05,
            ..asked(&setup, 0.0, 100.0)
        };
        let of = |setup: &Setup, asked: &FullThrottle| time_s(&driven(setup, asked), 100.0);
        let now = of(&setup, &base);
        let heavy = of(&car(name, &["road_load.payload_kg=200"]), &base);
        let uphill = of(
            &setup,
            &FullThrottle {
                grade: 0.05,
                ..base.clone()
            },
        );
        let slippery = of(
            &setup,
            &FullThrottle {
                grip: Some(Grip {
                    mu: 0.2,
                    ..Grip::default()
                }),
                ..base.clone()
            },
        );
        let cold = of(
            &setup,
            &FullThrottle {
                heat: (Heat::uniform(ZERO - 10.0), 25.0 + ZERO),
                ..base.clone()
            },
        );
        for (what, slower) in [
            ("load", heavy),
            ("slope", uphill),
            ("grip", slippery),
            ("cold", cold),
        ] {
            assert!(
                slower > now + 0.02,
                "{name}: {what} {slower} s, {now} s without"
            );
        }
        let [half, quarter] = [0.025, 0.0125].map(|dt_s| {
            of(
                &setup,
                &FullThrottle {
                    dt_s,
                    ..base.clone()
                },
            )
        });
        println!("{name}: {now} s, half the step {half} s, a quarter {quarter} s");
        assert!(
            (half - now).abs() < 0.1 && (quarter - half).abs() < 0.05,
            "{name}"
        );
    }
    let setup = car("civic_20_6mt", &[]);
    let with = |shift_s: f64| {
        let asked = FullThrottle {
            shift_s,
            ..asked(&setup, 0.0, 100.0)
        };
        let found = driven(&setup, &asked);
        (time_s(&found, 100.0), found.shifts.len())
    };
    let ((quick_s, changes), (slow_s, _)) = (with(0.2), with(0.7));
    let each_s = (slow_s - quick_s) / changes as f64;
    println!("{changes} changes, {each_s} s for half a second more each");
    assert!(changes >= 1 && (0.4..0.65).contains(&each_s), "{each_s} s");
}

/// Truth: definition. A kept gear has no change, a speed that is not reached has no time, and times of a distance are those at which the rows pass it.
#[test]
fn ends_of_a_drive() {
    let setup = car("rover_216_5mt", &[]);
    let kept = driven(
        &setup,
        &FullThrottle {
            gear: Some(4),
            dt_s: 0.1,
            ..asked(&setup, 80.0, 120.0)
        },
    );
    assert!(kept.shifts.is_empty() && kept.steps.iter().all(|step| step.row.gear == 4));
    for step in &kept.steps {
        assert!((step.row.time_s - step.time_s).abs() < 1e-9);
    }
    // The speed of the begin is there at time 0, and no step is driven for it.
    let none = driven(&setup, &asked(&setup, 80.0, 80.0));
    assert!(none.reached && none.steps.is_empty() && time_s(&none, 80.0) <= 0.0);
    let changes = driven(
        &setup,
        &FullThrottle {
            dt_s: 0.1,
            ..asked(&setup, 80.0, 120.0)
        },
    );
    assert!(time_s(&changes, 120.0) < time_s(&kept, 120.0));
    let first = driven(
        &setup,
        &FullThrottle {
            gear: Some(1),
            dt_s: 0.02,
            ..asked(&setup, 0.0, 100.0)
        },
    );
    assert!(!first.reached && first.time_to_speed_s(100.0 / 3.6).is_none());
    let limit_m_s =
        setup.engine().highest_rad_s / overall(&setup, 1) * setup.road_load.base.wheel_radius_m;
    assert!(
        (first.highest_m_s() / limit_m_s - 1.0).abs() < 0.005,
        "{} {limit_m_s}",
        first.highest_m_s()
    );
    let mile = driven(
        &setup,
        &FullThrottle {
            distance_m: 402.336,
            dt_s: 0.1,
            ..asked(&setup, 0.0, 60.0)
        },
    );
    let (at_s, speed_m_s) = mile.at_distance(402.336).expect("it gets there");
    let after = mile
        .steps
        .iter()
        .find(|step| step.distance_m >= 402.336)
        .expect("a row");
    assert!(after.time_s - 0.1 < at_s && at_s <= after.time_s);
    assert!(speed_m_s <= after.speed_m_s && mile.at_distance(1e6).is_none());
}

/// Truth: AC-3. On a slope of 0.5 with mu 0.2 the grip, mu m g cos a, is less than the pull of the slope, m g sin a: the car stays where it is, which is its
/// top speed, and the drive ends after the second that shows it.
#[test]
fn a_car_that_cannot_pull_away_ends_its_drive() {
    let setup = car("rover_216_cvt", &[]);
    let grip = Grip {
        mu: 0.2,
        driven: Driven::All,
        ..Grip::default()
    };
    let stuck = driven(
        &setup,
        &FullThrottle {
            grip: Some(grip),
            grade: 0.5,
            dt_s: 0.1,
            ..asked(&setup, 0.0, 50.0)
        },
    );
    assert!(!stuck.reached && stuck.highest_m_s() <= 0.0);
    let last = stuck.steps.last().expect("steps");
    assert!(
        last.distance_m <= 0.0 && last.time_s <= 1.0 + 1e-9,
        "{} s",
        last.time_s
    );
}

/// Truth: RC-4. A CVT that drives at 60 km/h goes down when the pedal does, no faster than its rate: ln I changes by at most rate dt from step to step.
#[test]
fn a_kick_down_keeps_to_the_rate_of_the_ratio() {
    let setup = car("civic_20_cvt", &[]);
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a CVT")
    };
    let most = cvt.ratio.down_per_s;
    let found = driven(&setup, &asked(&setup, 60.0, 100.0));
    let ratios: Vec<f64> = found.steps.iter().map(|step| step.row.belt_ratio).collect();
    let rates: Vec<f64> = ratios
        .windows(2)
        .map(|two| (two[1] / two[0]).ln() / 0.02)
        .collect();
    let fastest = rates.iter().copied().fold(0.0, f64::max);
    let largest = ratios.iter().copied().fold(0.0, f64::max);
    println!(
        "down by {} at up to {fastest}/s of {most}/s",
        largest / ratios[0]
    );
    assert!(
        fastest <= most * (1.0 + 1e-9) && fastest > 0.5 * most,
        "{fastest} {most}"
    );
    assert!(largest > 1.3 * ratios[0], "{largest} {}", ratios[0]);
}

/// Truth: AC-4 in closed form. With a full load a - b w the gear above, whose ratio is less by a factor f, has the same torque at the wheels where
/// f (a - b f w) = a - b w, w = a/(b (1 + f)): each change begins with the first step from there, to a thousandth of the highest speed.
#[test]
fn val_a_manual_box_changes_where_the_gear_above_pulls_as_much() {
    let setup = car("civic_20_6mt", &["engine.full_load=[[600,242],[6700,59]]"]);
    let (engine, r) = (setup.engine(), setup.road_load.base.wheel_radius_m);
    let found = driven(&setup, &asked(&setup, 0.0, 130.0));
    assert!(found.shifts.len() >= 2, "{:?}", found.shifts);
    let per_rpm = (242.0 - 59.0) / 6100.0;
    let none_rpm = 600.0 + 242.0 / per_rpm;
    for (time_s, gear) in &found.shifts {
        let [here, above] =
            [usize::from(*gear) - 1, usize::from(*gear)].map(|k| overall(&setup, k));
        let rad_s = none_rpm / (1.0 + above / here) * std::f64::consts::PI / 30.0;
        let before = found
            .steps
            .iter()
            .filter(|step| step.time_s <= time_s + 1e-9);
        let speeds: Vec<f64> = before.map(|step| step.speed_m_s / r * here).collect();
        let [.., earlier, now] = speeds[..] else {
            panic!("gear {gear} at the begin")
        };
        println!("to gear {gear} at {now} rad/s, by hand {rad_s}");
        assert!(now >= rad_s * (1.0 - 1e-9) && earlier <= rad_s + 1e-3 * engine.highest_rad_s);
        assert!(rad_s < 0.95 * engine.highest_rad_s);
    }
}

fn overall(setup: &Setup, gear: usize) -> f64 {
    match setup.transmission() {
        Transmission::Manual(manual) => manual.overall[gear - 1],
        Transmission::Cvt(_) => f64::NAN,
    }
}
