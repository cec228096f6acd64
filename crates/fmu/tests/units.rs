//! Units without their C interface: equality with a drive, saved states, refused calls. tools/fmu tests them through C.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::Path;

use cvtcycle_config::ProblemKind::{Conflict, OutOfRange};
use cvtcycle_config::cycle::embedded;
use cvtcycle_config::setup::carried::{self, CarriedCar};
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_fmu::variables::{Causality, car, forward, point};
use cvtcycle_fmu::{Kind, Unit};
use cvtcycle_model::cycle::{Cycle, Trace};
use cvtcycle_model::drive::{Conditions, Start, drive};

fn setup(word: &str) -> Setup {
    load(word, &Options::default()).unwrap()
}

/// ECE15+EUDC for automatics, without the gears, which a unit does not have.
fn cycle() -> Cycle {
    let cycle = embedded("ece15_eudc").unwrap();
    let trace = Trace::without_gears(cycle.trace_for(true).intervals.to_vec());
    Cycle {
        manual: trace,
        automatic: None,
        ..cycle
    }
}

fn started(setup: Setup) -> Unit {
    let mut unit = Unit::new(Kind::Car, setup);
    unit.set(car::AMBIENT as u32, 263.15).unwrap();
    unit.start(0.0).unwrap();
    unit
}

/// Drives a range of rows.
fn drive_rows(unit: &mut Unit, cycle: &Cycle, rows: std::ops::Range<usize>) {
    for interval in &cycle.manual.intervals[rows] {
        unit.set(car::SPEED as u32, interval.end_speed_m_s).unwrap();
        let dt_s = interval.end_s - interval.start_s;
        unit.step(interval.start_s, dt_s).unwrap();
    }
}

fn value(unit: &mut Unit, name: &str) -> f64 {
    let place = unit.variables().iter().position(|own| own.name == name);
    unit.get(u32::try_from(place.unwrap()).unwrap()).unwrap()
}

fn all(unit: &mut Unit) -> Vec<u64> {
    let count = u32::try_from(unit.variables().len()).unwrap();
    (0..count).map(|k| unit.get(k).unwrap().to_bits()).collect()
}

/// Truth: [`drive`], with each kind of box and coupling.
#[test]
fn the_fuel_equals_that_of_a_drive() {
    let cycle = cycle();
    for word in ["rover_216_cvt", "civic_20_cvt", "rover_216_5mt"] {
        let setup = setup(word);
        let conditions = Conditions {
            ambient_k: 263.15,
            start: Start::Soak,
            max_dt_s: 1.0,
            keep_rows: false,
        };
        let want = drive(&setup, &cycle, &conditions).totals.total();
        let mut unit = started(setup);
        drive_rows(&mut unit, &cycle, 0..cycle.manual.intervals.len());
        let fuel_kg = value(&mut unit, "m_fuel_ENG_PNT_out_kg");
        assert!(
            (fuel_kg / want.fuel_kg - 1.0).abs() < 1e-12,
            "{word}: {fuel_kg}"
        );
        let distance_m = value(&mut unit, "s_VEH_PNT_out_m");
        assert!((distance_m / want.distance_m - 1.0).abs() < 1e-12);
    }
}

/// A restored state continues with the same bits, also in another instance.
#[test]
fn a_restored_state_continues_bit_by_bit() {
    let cycle = cycle();
    let (middle, end) = (500, cycle.manual.intervals.len());
    for word in ["rover_216_cvt", "rover_216_5mt"] {
        let mut unit = started(setup(word));
        drive_rows(&mut unit, &cycle, 0..middle);
        let saved = unit.save();
        let bytes = unit.to_bytes(&saved);
        drive_rows(&mut unit, &cycle, middle..end);
        let want = all(&mut unit);
        unit.restore(&saved).unwrap();
        drive_rows(&mut unit, &cycle, middle..end);
        assert_eq!(all(&mut unit), want);
        let mut other = Unit::new(Kind::Car, setup(word));
        other.restore_bytes(&bytes).unwrap();
        assert_eq!(other.to_bytes(&other.save()), bytes);
        drive_rows(&mut other, &cycle, middle..end);
        assert_eq!(all(&mut other), want);
    }
}

/// Sets the inputs of a driven box for a step, and computes it.
fn push(unit: &mut Unit, k: u32) {
    let t = f64::from(k);
    let launch = (t / 40.0).min(1.0);
    let ratio = if k < 60 { 2.4 } else { 1.0 };
    for (place, value) in [
        (forward::TORQUE, 20.0 + 30.0 * (t / 7.0).sin()),
        (forward::SPEED, 40.0 * launch),
        (forward::RATIO, ratio),
        (forward::OIL, 283.15 + 0.1 * t),
        (forward::COOLANT, 300.0 + 0.2 * t),
    ] {
        unit.set(place as u32, value).unwrap();
    }
    unit.step(0.5 * t, 0.5).unwrap();
}

/// Power in is power out, losses and rotating energy in every step. A restored state continues with the same bits.
#[test]
fn a_driven_box_is_balanced_and_a_restored_state_continues_bit_by_bit() {
    for word in ["rover_216_cvt", "civic_20_cvt"] {
        let mut unit = Unit::new(Kind::Cvt, setup(word));
        unit.start(0.0).unwrap();
        let mut bytes = Vec::new();
        for k in 0..200 {
            push(&mut unit, k);
            let mut at = |name: &str| value(&mut unit, name);
            let engine_w = at("trq_FW_PNT_out_Nm") * at("w_ENG_PNT_radps");
            let wheel_w = at("trq_DS_PNT_out_Nm") * at("w_DS_PNT_radps");
            let heat_w = at("Qf_HYD_PNT_W") + at("Qf_GB_PNT_W");
            let rest_w = engine_w - wheel_w - heat_w - at("P_kin_AT_PNT_W") - at("P_el_AT_PNT_W");
            let scale = engine_w.abs() + wheel_w.abs() + heat_w;
            assert!(rest_w.abs() < 1e-9 * scale, "{word} {k}: {rest_w}");
            if k == 99 {
                bytes = unit.to_bytes(&unit.save());
            }
        }
        let want = all(&mut unit);
        let mut other = Unit::new(Kind::Cvt, setup(word));
        other.restore_bytes(&bytes).unwrap();
        (100..200).for_each(|k| push(&mut other, k));
        assert_eq!(all(&mut other), want);
        for place in (0..bytes.len()).step_by(11) {
            let mut wrong = bytes.clone();
            wrong[place] ^= 0xff;
            let before = other.save();
            let seen = all(&mut other);
            if other.restore_bytes(&wrong).is_err() {
                assert_eq!(all(&mut other), seen, "{place}");
            }
            other.restore(&before).unwrap();
        }
    }
}

/// Damaged bytes give an error and leave the unit unchanged, or give another reachable state.
#[test]
fn damaged_states_are_refused_or_reachable() {
    let cycle = cycle();
    let mut unit = started(setup("rover_216_cvt"));
    drive_rows(&mut unit, &cycle, 0..30);
    let before = all(&mut unit);
    let bytes = unit.to_bytes(&unit.save());
    for length in (0..bytes.len()).step_by(7) {
        assert!(unit.restore_bytes(&bytes[..length]).is_err());
        assert_eq!(all(&mut unit), before);
    }
    let mut refused = 0;
    for place in 0..bytes.len() {
        let mut wrong = bytes.clone();
        wrong[place] ^= 0xff;
        let saved = unit.save();
        if unit.restore_bytes(&wrong).is_err() {
            refused += 1;
            assert_eq!(all(&mut unit), before, "{place}");
        }
        unit.restore(&saved).unwrap();
    }
    assert!(refused > bytes.len() / 20, "{refused} of {}", bytes.len());
}

/// Each input and parameter accepts both ends of its range and refuses values beyond. No other variable can be set.
#[test]
fn values_out_of_range_are_refused() {
    for (kind, word) in [
        (Kind::Car, "rover_216_cvt"),
        (Kind::Car, "rover_216_5mt"),
        (Kind::Losses, "rover_216_cvt"),
        (Kind::Losses, "rover_216_5mt"),
        (Kind::Cvt, "rover_216_cvt"),
        (Kind::Cvt, "civic_20_cvt"),
    ] {
        let mut unit = Unit::new(kind, setup(word));
        let variables = unit.variables().to_vec();
        for (place, own) in variables.iter().enumerate() {
            let reference = u32::try_from(place).unwrap();
            let is_set = matches!(own.causality, Causality::Input | Causality::Parameter);
            let (low, high) = own.range;
            for good in [low, high, own.start].into_iter().filter(|_| is_set) {
                unit.set(reference, good).unwrap();
            }
            for bad in [f64::NAN, f64::INFINITY, -1e9, 1e9] {
                let refused = unit.set(reference, bad).unwrap_err();
                let kind = if is_set { OutOfRange } else { Conflict };
                assert_eq!(
                    (refused.kind, refused.variable.as_str()),
                    (kind, own.name.as_str())
                );
            }
        }
        assert!(unit.get(1000).is_err() && unit.set(1000, 0.0).is_err());
        unit.start(0.0).unwrap();
        for (from_s, dt_s) in [
            (0.0, -1.0),
            (0.0, 0.0),
            (0.0, f64::NAN),
            (0.0, 1e5),
            (9.0, 1.0),
            (f64::NAN, 1.0),
        ] {
            assert!(unit.step(from_s, dt_s).is_err(), "{from_s} {dt_s}");
        }
        unit.step(0.0, 1.0).unwrap();
        if kind == Kind::Car {
            let late = unit.set(car::START as u32, 300.0).unwrap_err();
            assert_eq!(late.kind, Conflict);
            assert_eq!(late.variable, variables[car::START].name);
        }
    }
}

/// Power in is power out and losses; heat equals the losses; a shaft at rest has none.
#[test]
fn an_operating_point_balances() {
    for word in ["rover_216_cvt", "civic_20_cvt", "rover_216_5mt"] {
        let mut unit = Unit::new(Kind::Losses, setup(word));
        unit.start(0.0).unwrap();
        for (speed, torque) in [(150.0, 0.0), (250.0, 80.0), (400.0, -30.0)] {
            unit.set(point::SPEED as u32, speed).unwrap();
            unit.set(point::TORQUE as u32, torque).unwrap();
            let output_w =
                value(&mut unit, "trq_DS_PNT_out_Nm") * value(&mut unit, "w_DS_PNT_out_radps");
            let loss_w = value(&mut unit, "P_loss_AT_PNT_W");
            let heat_w = value(&mut unit, "Qf_HYD_PNT_W") + value(&mut unit, "Qf_GB_PNT_W");
            assert!(loss_w > 0.0 && (heat_w - loss_w).abs() < 1e-9 * loss_w);
            let input_w = speed * torque;
            assert!(
                (input_w - output_w - loss_w).abs() < 1e-6 * loss_w,
                "{word}: {input_w} {output_w} {loss_w}"
            );
        }
        unit.set(point::SPEED as u32, 0.0).unwrap();
        assert!(value(&mut unit, "P_loss_AT_PNT_W").abs() <= 0.0);
    }
}

/// A car read from its packed files is the same car. The originals are deleted first.
#[test]
fn a_car_carries_its_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let cycle = cycle();
    for (word, set) in [
        ("docs/own_tables/car.toml", "road_load.mass_kg=1200"),
        ("docs/own_tables/box.toml", "lubricant.density15_kg_m3=870"),
        ("vehicles/civic_20_cvt.toml", "road_load.mass_kg*=1.1"),
    ] {
        let options = Options {
            set: cvtcycle_config::Override::parse_all(&[set]).unwrap(),
            ..Options::default()
        };
        let (carried, own) = CarriedCar::load(root.join(word).to_str().unwrap(), &options).unwrap();
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in carried.into_files() {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
        let again = carried::open(folder.path()).unwrap();
        assert_eq!(again.name, own.name);
        let [one, two] = [own, again].map(|setup| {
            let mut unit = started(setup);
            drive_rows(&mut unit, &cycle, 0..200);
            all(&mut unit)
        });
        assert_eq!(one, two, "{word}");
        std::fs::remove_dir_all(folder.path().join("lubricant")).unwrap();
        assert!(carried::open(folder.path()).is_err());
    }
}
