//! Below 25 degC: what carries the losses on, what bounds them (the page `docs/book/src/cold.md`).
//!
//! Truth: viscosities from published limits of the grades; the power laws written out again for files without the new keys; limits and
//! signs of the equations.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests say what they found"
)]

use crate::common::{CARS, RPM, ZERO, at, car, cycle, larger};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::render;
use cvtcycle_config::setup::{Options, Setup, embedded_vehicles, load, load_lubricant};
use cvtcycle_model::drive::{Start, drive};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::lubricant::Lubricant;
use cvtcycle_model::rig::{Bench, BenchAnswer, BenchPoint};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::{Cvt, viscosity_power};

const CVT: &str = "rover_216_cvt";
const MANUAL: &str = "rover_216_5mt";
/// The keys that bound what is extrapolated.
const KEYS: [&str; 2] = ["film_heating_w", "inlet_bar_per_l_min"];

fn fluid(name: &str) -> Lubricant {
    load_lubricant(name)
        .unwrap_or_else(|problems| panic!("{}", render(&problems, false)))
        .0
}

/// Viscosity of a shipped fluid by its D341 line, mPa s.
fn mpa_s(name: &str, degc: f64) -> f64 {
    1e3 * fluid(name).dynamic_pa_s(degc + ZERO)
}

/// A shipped car as a file of the time before the new keys.
fn old_file(name: &str) -> Setup {
    let text = embedded_vehicles()
        .iter()
        .find(|(shipped, _)| *shipped == name)
        .unwrap()
        .1;
    let kept: Vec<&str> = text
        .lines()
        .filter(|line| !KEYS.iter().any(|key| line.starts_with(key)))
        .collect();
    assert!(
        kept.len() < text.lines().count(),
        "{name} has none of the keys"
    );
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("old.toml");
    std::fs::write(&path, kept.join("\n")).unwrap();
    load(path.to_str().unwrap(), &Options::default())
        .unwrap_or_else(|problems| panic!("{}", render(&problems, false)))
}

fn cvt(setup: &Setup) -> &Cvt {
    match setup.transmission() {
        Transmission::Cvt(cvt) => cvt,
        Transmission::Manual(_) => panic!("no CVT"),
    }
}

/// Outside truth: limits that the grades set (GM by SAE literature: Brookfield; SAE J300 of 1999: cranking, CCS, and pumping, MRV; SAE J306:
/// 150 000 mPa s). The D341 lines through KV40 and KV100 keep all those for low shear. They miss the two for cranking by 10 and 16 %: these
/// hold at 1e5 1/s, where a multigrade oil is thinner than D341, which knows no shear; so the engine oils are a little too thick here.
#[test]
fn val_d341_lines_against_published_limits_in_the_cold() {
    let low_shear = [
        ("dexron_ii", -40.0, 50_000.0),
        ("dexron_iii", -40.0, 20_000.0),
        ("engine_10w40", -30.0, 60_000.0),
        ("engine_5w30", -35.0, 60_000.0),
    ];
    for (name, degc, limit) in low_shear.into_iter().chain([
        ("gear_75w80", -40.0, 150_000.0),
        ("cvtf_ezl799_class", -40.0, 20_000.0),
    ]) {
        let found = mpa_s(name, degc);
        println!("{name} at {degc} degC: {found:.0} mPa s, at most {limit:.0}");
        // Not a tenth of the limit either: fluids of these grades come within a factor of ten of it.
        assert!(
            found < limit && found > 0.1 * limit,
            "{name} at {degc} degC: {found:.0} mPa s, limit {limit:.0}"
        );
    }
    for (name, degc, limit, over) in [
        ("engine_10w40", -25.0, 7000.0, 1.16),
        ("engine_5w30", -30.0, 6600.0, 1.10),
    ] {
        let ratio = mpa_s(name, degc) / limit;
        println!("{name} at {degc} degC: {ratio:.3} of the limit for cranking");
        assert!(
            (ratio - over).abs() < 0.01,
            "{name} at {degc} degC: {ratio:.3} of the limit"
        );
    }
    // An oil sold as 10W would be sold as 5W if it met that grade's limit.
    assert!(mpa_s("engine_10w40", -30.0) > 6600.0);
}

/// Outside truth: the power laws from before films could warm and the inlet could starve, written out here. A file without the
/// keys means what it meant, to rounding.
#[test]
fn val_files_without_the_keys_keep_the_power_laws() {
    let setup = old_file(CVT);
    let (cvt, oil) = (cvt(&setup), setup.oils().0);
    for degc in [-40.0, -10.0, 25.0, 90.0] {
        let (nu, eta) = (
            oil.kinematic_m2_s(degc + ZERO),
            oil.dynamic_pa_s(degc + ZERO),
        );
        let power = |m: f64, x: f64| cvtcycle_model::math::exp(m * cvtcycle_model::math::ln(x));
        for w in [0.0, 100.0, 400.0] {
            let s = &cvt.shaft_drag;
            let shaft = s.constant_nm + s.viscous_nm_s * power(s.exponent, nu / 11e-6) * w;
            let now = s.torque_nm(viscosity_power(nu, s.exponent), w);
            assert!((now / shaft - 1.0).abs() < 2e-15, "{degc} degC");
            let p = &cvt.pump;
            let state = p.state(&p.at(eta), w, 20e5, 1e-4);
            let viscous = p.viscous
                * 0.010
                * power(p.viscous_exponent, eta / 0.010)
                * w
                * p.displacement_m3_rad;
            let torque = p.displacement_m3_rad * (1.0 + p.friction) * (20e5 + p.line_drop_pa)
                + viscous
                + p.constant_nm;
            assert!(
                (state.torque_nm / torque - 1.0).abs() < 2e-15,
                "{degc} degC"
            );
            assert_eq!(
                state.working_m3_s.to_bits(),
                (p.displacement_m3_rad * w).to_bits()
            );
            assert_eq!(state.flow_limited, p.displacement_m3_rad * w < 1e-4);
        }
    }
    // Heating that never comes is no heating, in a whole run.
    let never = ["transmission.cvt.input_shaft", "transmission.cvt.pump"];
    let mut never: Vec<String> = never
        .iter()
        .map(|table| format!("{table}.film_heating_w=1e9"))
        .collect();
    never.push("transmission.cvt.pump.inlet_bar_per_l_min=0".into());
    let c = cycle("ece15");
    let sets: Vec<&str> = never.iter().map(String::as_str).collect();
    let fuel = |setup: &Setup| {
        let start = at(-30.0, Start::Soak);
        drive(setup, &c, &start).totals.total().fuel_kg
    };
    let old = fuel(&old_file(CVT));
    let (never, shipped) = (fuel(&car(CVT, &sets)), fuel(&car(CVT, &[])));
    assert!((never / old - 1.0).abs() < 1e-5, "{old} {never}");
    assert!(shipped < old, "heating does nothing, {old} {shipped}");
}

fn solve(setup: &Setup, point: BenchPoint) -> BenchAnswer {
    Bench::new(setup).solve(&point)
}

/// Components whose only temperature here is the sump's.
const IN_THE_SUMP: [Component; 7] = [
    Component::Pump,
    Component::InputShaft,
    Component::ClutchDrag,
    Component::FinalDrive,
    Component::Bearing,
    Component::Churning,
    Component::Seal,
];

/// Colder oil never costs less, in drive and in overrun, and nothing is negative: every part that turns in the sump's oil, but for preloaded bearings,
/// whose rollers thicker oil lifts (BR-2).
#[test]
fn colder_oil_never_lowers_a_loss() {
    for (name, ratios) in [
        (CVT, [2.4, 0.45]),
        (MANUAL, [1.0, 5.0]),
        ("mondeo_20_5mt", [2.0, 4.0]),
    ] {
        let table = if name == CVT {
            "cvt.final_drive"
        } else {
            "manual.gears"
        };
        let setup = car(name, &[&format!("transmission.{table}.preload_factor=0")]);
        for ratio in ratios {
            for (rpm, output_nm) in [(800.0, 0.0), (2000.0, 150.0), (3500.0, -40.0)] {
                let mut last = [0.0; IN_THE_SUMP.len()];
                for step in 0..=65 {
                    let point = BenchPoint {
                        ratio,
                        input_rad_s: rpm * RPM,
                        output_nm,
                        pressure_pa: Some(20e5),
                        belt_k: Some(20.0 + ZERO),
                        sump_k: 25.0 - f64::from(step) + ZERO,
                        ..BenchPoint::default()
                    };
                    let answer = solve(&setup, point);
                    let now = IN_THE_SUMP.map(|part| answer.part_nm(part));
                    for ((now, last), part) in now.iter().zip(last).zip(IN_THE_SUMP) {
                        let slack = 1e-9 * last + 1e-12; // the belt's slip moves the final drive's speed
                        assert!(
                            *now >= last - slack && now.is_finite(),
                            "{name} {part:?} at {:.0} degC: {last} {now}",
                            point.sump_k - ZERO
                        );
                    }
                    last = now;
                }
                let parts = if name == CVT {
                    &IN_THE_SUMP[..4]
                } else {
                    &IN_THE_SUMP[4..]
                };
                assert!(
                    parts.iter().all(|part| last
                        [IN_THE_SUMP.iter().position(|p| p == part).unwrap()]
                        > 0.0),
                    "{name}: {last:?}"
                );
            }
        }
    }
}

/// The bound counts: from 25 to -40 degC the final drive grows by less than the power law by far, and by at least the root of it.
#[test]
fn what_is_extrapolated_grows_between_root_and_power() {
    let (shipped, old) = (car(CVT, &[]), old_file(CVT));
    let point = |degc: f64| BenchPoint {
        ratio: 0.45,
        sump_k: degc + ZERO,
        belt_k: Some(293.15),
        ..BenchPoint::default()
    };
    let unbound = car(CVT, &["transmission.cvt.final_drive.bearing_heating_w=1e9"]);
    for (part, old) in [
        (Component::FinalDrive, &unbound),
        (Component::InputShaft, &old),
    ] {
        let growth = |setup: &Setup| {
            solve(setup, point(-40.0)).part_nm(part) / solve(setup, point(25.0)).part_nm(part)
        };
        let (bounded, power) = (growth(&shipped), growth(old));
        println!("{part:?}: {bounded:.1} instead of {power:.1} times from 25 to -40 degC");
        assert!(
            bounded < 0.5 * power && bounded > 0.5 * power.sqrt(),
            "{part:?}: {bounded} {power}"
        );
    }
}

/// The bench over temperature and speed without a jump: the largest difference between neighbours halves with the step, in temperature
/// and in the logarithm of speed from 1 to 4000 rpm.
#[test]
fn losses_in_the_cold_are_continuous() {
    for (name, ratio) in [(CVT, 0.45), (CVT, 2.4), (MANUAL, 5.0)] {
        let setup = car(
            name,
            &["transmission.cvt.pump.inlet_bar_per_l_min=0.002"][..usize::from(name == CVT)],
        );
        let largest = |n: u32, over_speed: bool| {
            let at = |i: u32| f64::from(i) / f64::from(n);
            let total = |i: u32| {
                let (degc, rpm) = if over_speed {
                    (-25.0, 4000.0_f64.powf(at(i)))
                } else {
                    (-40.0 + 65.0 * at(i), 2000.0)
                };
                let point = BenchPoint {
                    ratio,
                    input_rad_s: rpm * RPM,
                    sump_k: degc + ZERO,
                    pressure_pa: Some(20e5),
                    ..BenchPoint::default()
                };
                let answer = solve(
                    &setup,
                    BenchPoint {
                        belt_k: Some(280.0),
                        ..point
                    },
                );
                answer.total_nm() + 1e3 * answer.oil_flow_m3_s
            };
            (0..n)
                .map(|i| (total(i + 1) - total(i)).abs())
                .fold(0.0, larger)
        };
        for over_speed in [false, true] {
            let (coarse, fine) = (largest(400, over_speed), largest(800, over_speed));
            assert!(
                fine < 0.6 * coarse,
                "{name}, ratio {ratio}, over speed {over_speed}: {coarse} {fine}"
            );
        }
    }
}

/// Driving at -40 degC with an inlet that starves: flow falls short and is said to, both ledgers close, nothing turns into what is no number.
#[test]
fn a_starved_pump_is_flagged_and_its_ledgers_close() {
    let run = |bar: f64, c: &Cycle| {
        let setup = car(
            CVT,
            &[&format!("transmission.cvt.pump.inlet_bar_per_l_min={bar}")],
        );
        drive(&setup, c, &at(-40.0, Start::Soak)).totals
    };
    let c = cycle("ece15");
    let (free, starved) = (run(0.0, &c), run(0.003, &c));
    assert_eq!(
        free.seconds(Flags::FLOW_LIMITED).to_bits(),
        0.0_f64.to_bits()
    );
    assert!(
        starved.seconds(Flags::FLOW_LIMITED) > 60.0,
        "{} s",
        starved.seconds(Flags::FLOW_LIMITED)
    );
    assert!(starved.ledger_error < 1e-9 && starved.total().fuel_kg.is_finite());
}

/// All cars at -40 degC, in drive, overrun and at rest: every loss at least zero, both ledgers closed.
#[test]
fn nothing_is_negative_at_forty_below() {
    for name in CARS {
        let totals = drive(&car(name, &[]), &cycle("udds"), &at(-40.0, Start::Soak)).totals;
        let total = totals.total();
        assert!(
            total.loss_j.iter().all(|loss| *loss >= 0.0) && totals.ledger_error < 1e-9,
            "{name}: {:?}",
            total.loss_j
        );
        assert_eq!(
            totals.seconds(Flags::NOT_CONVERGED).to_bits(),
            0.0_f64.to_bits(),
            "{name}"
        );
    }
}
