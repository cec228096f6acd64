//! Laws of every row of every drive: energy balances close, losses are not negative, torque in drive and in overrun has the right size.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use cvtcycle_config::cycle::Step;
use cvtcycle_model::drive::{Car, State, simulate};
use cvtcycle_model::drive::{Conditions, Start, drive};
use cvtcycle_model::drive::{EnergyTerms, Row};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::road::RoadLoad;
use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, Heat, METAL, NODES, SUMP};
use cvtcycle_model::transmission::component::Component;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use super::cars::{acceptance, recipes};
use super::hold;
use super::traces::traces;
use crate::common::{Keep, ZERO, larger};

type Checked = Result<(), TestCaseError>;

/// Work at the wheels of a step over its length, W: Simpson's rule, exact for the cubic that power is.
fn simpson_w(road: &RoadLoad, step: &Step, extra_n: f64) -> f64 {
    let (v0, v1) = (step.start_speed_m_s, step.end_speed_m_s);
    let slope = road.mass_kg * 9.80665 * step.grade.atan().sin();
    let power = |v: f64| {
        let standing = v0 + v1 <= 0.0;
        let force = road.f0_n
            + extra_n
            + road.f1_n_per_m_s * v
            + road.f2_n_per_m_s2 * v * v
            + road.inertia_kg * (v1 - v0) / step.dt_s
            + slope;
        if standing { 0.0 } else { force * v }
    };
    (power(v0) + 4.0 * power(0.5 * (v0 + v1)) + power(v1)) / 6.0
}

/// Both ledgers, and that each term is what the row shows.
fn books(step: &Step, row: &Row, t: &EnergyTerms, car: &Car, tyre_k: f64) -> Checked {
    prop_assert!(
        t.power_error() <= 1e-9 && t.heat_error() <= 1e-9,
        "ledgers {:e} {:e} in {t:?}",
        t.power_error(),
        t.heat_error()
    );
    let demand = simpson_w(&car.road_load, step, car.tyre.extra_n(tyre_k));
    let size = 1e-9
        * (demand.abs()
            + car.road_load.inertia_kg * row.speed_m_s * row.accel_m_s2.abs()
            + t.fuel
            + 1.0);
    prop_assert!(
        (row.wheel_power_w - demand).abs() <= size,
        "wheels {} W, by Simpson {demand} W",
        row.wheel_power_w
    );
    prop_assert!((t.wheels - (demand - row.deficit_w)).abs() <= size);
    prop_assert!(
        (row.wheel_work_positive_j + row.wheel_work_negative_j - demand * step.dt_s).abs()
            <= size * step.dt_s
    );
    prop_assert!(row.wheel_work_positive_j >= 0.0 && row.wheel_work_negative_j <= 0.0);
    Ok(())
}

/// Nothing that only flows one way is negative.
fn signs(row: &Row) -> Checked {
    for component in Component::ALL {
        let loss = row.loss_w[component];
        prop_assert!(loss >= 0.0, "{} loses {loss} W", component.name());
    }
    let named = [
        ("deficit", row.deficit_w),
        ("brake", row.brake_w),
        ("fuel", row.fuel_kg_s),
        ("exhaust", row.exhaust_w),
        ("engine heat", row.engine_heat_w),
        ("accessories", row.accessories_w),
        ("engine speed", row.engine_speed_rad_s),
        ("throttle", row.throttle),
        ("1 - throttle", 1.0 - row.throttle),
    ];
    for (name, x) in named {
        prop_assert!(x >= 0.0, "{name} is {x}");
    }
    prop_assert!(
        !(row.brake_w > 0.0 && row.deficit_w > 0.0),
        "brakes and full load at once"
    );
    Ok(())
}

/// Torque at the flywheel against that of a box without losses at the same speeds: not smaller in drive; in overrun of smaller magnitude,
/// or even driving. The difference is the losses, which add up.
fn torque_in(row: &Row) -> Checked {
    let wheels_w = row.wheel_power_w - row.deficit_w + row.brake_w;
    let input_w = row.engine_torque_nm * row.engine_speed_rad_s;
    let losses: f64 = row.loss_w.iter().sum();
    let size = 1e-9 * (input_w.abs() + wheels_w.abs() + losses);
    // Rotating energy of the engine that brakes or a slipping clutch take up (SI-4) does not come through the box from the wheels.
    let rotating_w = wheels_w + losses - input_w;
    // Rotating energy that the engine takes out of the brakes in overrun (SI-5) does not come through the box either.
    let faster = row.kinetic_w > 0.0 && input_w < 0.0 && (rotating_w + row.kinetic_w).abs() <= size;
    prop_assert!(
        rotating_w >= -size || faster,
        "in {input_w} W, out {wheels_w} W, lost {losses} W, rotating {} W",
        row.kinetic_w
    );
    let slower = row.kinetic_w < 0.0 && rotating_w <= -row.kinetic_w + size;
    prop_assert!(
        rotating_w <= size || slower,
        "in {input_w} W, out {wheels_w} W, lost {losses} W, rotating {} W",
        row.kinetic_w
    );
    let output_w = wheels_w - if slower || faster { rotating_w } else { 0.0 };
    if output_w >= 0.0 {
        prop_assert!(
            input_w >= output_w - size,
            "drive: in {input_w} W, out {output_w} W"
        );
    } else if input_w < 0.0 {
        prop_assert!(
            -input_w <= -output_w + size,
            "overrun: in {input_w} W, out {output_w} W"
        );
    }
    if row.flags.contains(Flags::OVERRUN) {
        prop_assert!(output_w <= size, "overrun with {output_w} W at the wheels");
    }
    Ok(())
}

/// The engine takes up no more in overrun than its drag, and gives no more than full load, beyond what the solve left.
fn engine_bounds(row: &Row, car: &Car, before: &Heat) -> Checked {
    let engine = car.engine.at(
        before.node_k[COOLANT],
        before.node_k[ENGINE_OIL],
        &car.engine_oil,
        car.charge,
    );
    let w = row.engine_speed_rad_s;
    if w <= 0.0 || row.flags.contains(Flags::NOT_CONVERGED) {
        return Ok(());
    }
    let crank_nm = row.engine_torque_nm + row.accessories_w / w;
    // What the rotating energy of a slowing engine gives is not burnt (SI-2).
    let burnt_nm = crank_nm + row.kinetic_w.min(0.0) / w;
    let full = engine.full_load_nm(w);
    let rest = 2e-5 * (full + crank_nm.abs());
    prop_assert!(
        crank_nm >= -engine.drag_nm(w) - rest,
        "crank {crank_nm} Nm, drag {} Nm",
        engine.drag_nm(w)
    );
    // An engine that cannot turn its own pump in the cold is outside validity; the row has the flag.
    let flagged = row.flags.contains(Flags::OUTSIDE_VALIDITY);
    prop_assert!(
        burnt_nm <= full + rest || flagged,
        "burnt {burnt_nm} Nm of {full} Nm"
    );
    Ok(())
}

/// Heat into each node by SI-3, with engine heat as a whole: an upper bound for coolant and for engine oil each.
fn most_heat_w(row: &Row, car: &Car) -> [f64; NODES] {
    let of = |list: &[Component]| list.iter().map(|c| row.loss_w[*c]).sum::<f64>();
    use Component as C;
    let belt = of(&[
        C::BeltBand,
        C::BeltFilm,
        C::BeltSlip,
        C::BeltWedge,
        C::BeltPenetration,
        C::BeltMap,
    ]);
    let metal = of(&[C::InputShaft, C::Bearing, C::Seal]);
    let all: f64 = row.loss_w.iter().sum();
    let clutch = of(&[C::LaunchClutch]);
    let cvt = car.transmission.is_cvt();
    let coolant = row.engine_heat_w + if cvt { 0.0 } else { clutch };
    let sump = all - metal - car.belt_heat_share * belt - if cvt { 0.0 } else { clutch };
    [
        coolant,
        row.engine_heat_w,
        sump,
        metal,
        car.belt_heat_share * belt,
    ]
}

/// Second law, step by step: no node falls below the coldest of nodes and air, none rises above the hottest of them by more than its own
/// heat warms it. (Maximum principle of TH-5: its matrix has no positive entry off the diagonal, and is dominated by it.)
fn temperatures(row: &Row, before: &Heat, after: &Heat, car: &Car) -> Checked {
    let used = |k: usize| car.network.capacity_j_k[k] > 0.0;
    let all = || {
        (0..NODES)
            .filter(|k| used(*k))
            .map(|k| before.node_k[k])
            .chain([car.ambient_k])
    };
    let (coldest, hottest) = (
        all().fold(f64::INFINITY, f64::min),
        all().fold(0.0, f64::max),
    );
    let heat = most_heat_w(row, car);
    let warmed = (0..NODES)
        .filter(|k| used(*k))
        .map(|k| heat[k] * row.dt_s / car.network.capacity_j_k[k])
        .fold(0.0, f64::max);
    for k in (0..NODES).filter(|k| used(*k)) {
        let t = after.node_k[k];
        prop_assert!(
            t >= coldest - 1e-9,
            "node {k} at {t} K, coldest {coldest} K"
        );
        prop_assert!(
            t <= hottest + warmed + 1e-9,
            "node {k} at {t} K, hottest {hottest} K, warmed by {warmed} K"
        );
    }
    prop_assert!(
        (after.node_k[SUMP] - row.sump_k).abs() <= 0.0
            && (after.node_k[METAL] - row.metal_k).abs() <= 0.0
    );
    Ok(())
}

/// The flags of what no car can do are those of the columns; the cycles prescribe no gears.
fn impossible(row: &Row, car: &Car) -> Checked {
    let hot = row.coolant_k > ZERO + 130.0
        || row.engine_oil_k > ZERO + 160.0
        || row.sump_k > ZERO + 160.0;
    for (flag, want) in [
        (Flags::TOO_HOT, hot),
        (
            Flags::OVERSPEED,
            row.engine_speed_rad_s > car.engine.highest_rad_s,
        ),
        (Flags::WRONG_GEAR, false),
    ] {
        prop_assert_eq!(row.flags.contains(flag), want, "{:?}", flag);
    }
    Ok(())
}

fn after(row: &Row, before: &Heat) -> Heat {
    let belt_k = if row.belt_spray_k.is_nan() {
        before.node_k[4]
    } else {
        row.belt_spray_k
    };
    Heat {
        node_k: [
            row.coolant_k,
            row.engine_oil_k,
            row.sump_k,
            row.metal_k,
            belt_k,
        ],
    }
}

/// Extremes over all cases, to be printed.
#[derive(Default)]
struct Seen {
    rows: Cell<usize>,
    ledger: Cell<f64>,
    flags: RefCell<BTreeMap<&'static str, usize>>,
}

impl Seen {
    fn row(&self, row: &Row, terms: &EnergyTerms) {
        self.rows.set(self.rows.get() + 1);
        self.ledger.set(larger(
            larger(terms.power_error(), terms.heat_error()),
            self.ledger.get(),
        ));
        for (_, name) in Flags::NAMES
            .iter()
            .filter(|(flag, _)| row.flags.contains(*flag))
        {
            *self.flags.borrow_mut().entry(name).or_default() += 1;
        }
    }
}

fn every_row(wide: f64, cases: u32) {
    let seen = Seen::default();
    let dt = prop_oneof![3 => Just(1.0), 1 => Just(0.1), 1 => Just(10.0), 1 => 0.05..5.0];
    let start = prop::option::of(-40.0..130.0);
    hold(
        cases,
        &(recipes(wide), traces(), -40.0..60.0, start, dt),
        |(recipe, rows, ambient, start, dt)| {
            let car = recipe.car().setup.car(ZERO + ambient);
            let cycle = rows.cycle();
            let trace = cycle.trace_for(car.transmission.is_cvt());
            let mut keep = Keep::default();
            let begin = State::at(ZERO + start.unwrap_or(ambient));
            let (mut before, mut tyre_k) = (begin.heat, begin.tyre_k);
            let end = simulate(&car, trace, dt, begin, &mut keep);
            prop_assert_eq!(keep.rows.len(), trace.step_count(dt));
            for ((step, row), terms) in trace.steps(dt).zip(&keep.rows).zip(&keep.terms) {
                let next = after(row, &before);
                let checked = books(&step, row, terms, &car, tyre_k)
                    .and_then(|()| signs(row))
                    .and_then(|()| impossible(row, &car))
                    .and_then(|()| torque_in(row))
                    .and_then(|()| engine_bounds(row, &car, &before))
                    .and_then(|()| temperatures(row, &before, &next, &car));
                checked.map_err(|error| {
                    TestCaseError::fail(format!(
                        "{} s: {error}\n{row:?}\nbefore {before:?}",
                        row.time_s
                    ))
                })?;
                seen.row(row, terms);
                (before, tyre_k) = (next, row.tyre_k);
            }
            prop_assert_eq!(
                end.heat.node_k[COOLANT].to_bits(),
                before.node_k[COOLANT].to_bits()
            );
            Ok(())
        },
    );
    let (accepted, offered) = acceptance();
    println!(
        "{cases} cars and cycles, {} rows, worst ledger {:e}",
        seen.rows.get(),
        seen.ledger.get()
    );
    println!(
        "groups of changes accepted so far: {accepted} of {offered}; rows with flags: {:?}",
        seen.flags.borrow()
    );
    assert!(10 * accepted > 3 * offered, "too few cars are accepted");
}

/// Cars as they might be built.
#[test]
fn every_row_of_likely_cars() {
    every_row(0.0, 500);
}

/// Cars with values from anywhere in what the keys allow.
#[test]
fn every_row_of_unlikely_cars() {
    every_row(0.3, 500);
}

/// Found by the fuzzer: slip that jumps from bound to bound was carried on in a line to more than 1, and no speed belonged to it. A drive far
/// beyond what the belt carries has numbers in every row all the same.
#[test]
fn slip_that_jumps_is_not_carried_on_beyond_what_a_belt_can_have() {
    let sets = [
        "transmission.cvt.variator.primary_stiffness_n=100000",
        "lubricant.friction.band=0.39",
        "transmission.cvt.belt.mass_kg=10",
        "road_load.payload_kg=3423.3756247597075",
        "transmission.cvt.belt.initial_gap_mm=68.47256302538055",
        "transmission.cvt.clamp=slip_limited",
    ];
    let car = crate::common::car("rover_216_cvt", &sets);
    let rows = [
        (0.0, 70.980_392_156_862_75, -0.015_623_712_520_027_463),
        (30.138_358_639_333_216, 0.0, 0.0),
        (
            58.763_906_505_538_52,
            135.629_205_767_910_26,
            0.094_509_803_921_568_63,
        ),
        (87.293_735_424_975_38, 0.0, 0.070_312_046_997_787_45),
        (112.590_563_567_997_3, 136.156_862_745_098_04, 0.0),
        (
            112.894_521_264_603_06,
            127.921_568_627_450_98,
            0.082_696_269_169_146_27,
        ),
        (114.884_452_778_522_43, 127.921_568_627_450_98, 0.0),
    ];
    let rows = rows.map(|(time_s, kmh, grade)| super::traces::Point {
        time_s,
        kmh,
        grade,
        engine_off: false,
    });
    let cycle = super::traces::Rows(rows.to_vec()).cycle();
    let conditions = Conditions {
        ambient_k: ZERO - 40.0,
        start: Start::Warm,
        max_dt_s: 0.5,
        keep_rows: true,
    };
    for row in drive(&car, &cycle, &conditions).rows {
        assert!(
            row.engine_speed_rad_s.is_finite()
                && row.fuel_kg_s.is_finite()
                && row.sump_k.is_finite(),
            "{row:?}"
        );
    }
}
