//! A run row by row: SI-1 to SI-4, fuel, heat into the nodes and their step, and what a row says of the wheels, worked out again from the
//! driveline's answer and the temperatures at the end of the row before.

use super::{near, same};
use crate::common::{CARS, Keep, ZERO, at, car, cycle, hill};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_model::drive::{Car, State, simulate};
use cvtcycle_model::drive::{EnergyTerms, Row};
use cvtcycle_model::drive::{
    Start, co2_g_per_km, distance_counts, drive, fuel_map, litres_per_100km, litres_per_hour,
};
use cvtcycle_model::engine::Running;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, HeatInput, METAL, NODES, SUMP};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

#[track_caller]
fn close(got: f64, want: f64, scale: f64, place: &str) {
    assert!(
        (got - want).abs() <= 1e-9 * scale,
        "{got} instead of {want}: {place}"
    );
}

fn sum(row: &Row, parts: &[Component]) -> f64 {
    parts.iter().map(|c| row.loss_w[*c]).sum()
}

/// SI-3 by the words of the table.
fn heat_w(car: &Car, row: &Row) -> [f64; NODES] {
    use Component as C;
    let cvt = car.transmission.is_cvt();
    let belt = sum(
        row,
        &[
            C::BeltBand,
            C::BeltFilm,
            C::BeltSlip,
            C::BeltWedge,
            C::BeltPenetration,
            C::BeltMap,
        ],
    );
    let mut power = [0.0; NODES];
    power[BELT] = car.belt_heat_share * belt;
    power[METAL] = sum(row, &[C::InputShaft, C::PulleyBearing, C::Bearing, C::Seal]);
    let all: f64 = row.loss_w.iter().sum();
    let clutch = row.loss_w[C::LaunchClutch];
    power[SUMP] = all - power[BELT] - power[METAL] - if cvt { 0.0 } else { clutch };
    power[COOLANT] = if cvt { 0.0 } else { clutch };
    power
}

/// State between rows.
struct Carried {
    heat: Heat,
    kinetic_j: f64,
    running: Running,
}

/// Counts of the regimes that rows went through.
#[derive(Default, Debug)]
struct Seen {
    wanted_up: u32,
    held_up: u32,
    wanted_down: u32,
    braked: u32,
    off: u32,
    missed: u32,
}

fn check(car: &Car, row: &Row, c: &mut Carried, seen: &mut Seen, place: &str) {
    let (t, w, dt) = (c.heat.node_k, row.engine_speed_rad_s, row.dt_s);
    let off = row.flags.contains(Flags::ENGINE_OFF);
    if c.running.since_s == 0.0 {
        c.running.start_k = t[COOLANT];
    }
    // EN-11 looks at both ends of the step: with gears the wheels have the speed of the engine, a CVT holds it up to that in its lowest gear.
    let wheel_rad_s = row.speed_m_s / car.road_load.wheel_radius_m;
    let half_rad_s = 0.5 * row.accel_m_s2 * dt / car.road_load.wheel_radius_m;
    c.running.end_rad_s = match &car.transmission {
        Transmission::Cvt(cvt) => {
            let lowest = cvt.ratio.low * cvt.final_drive.ratio;
            c.running
                .speed_rad_s
                .min(lowest * (wheel_rad_s + half_rad_s).max(0.0))
        }
        Transmission::Manual(manual) => {
            let gear = usize::from(row.gear).checked_sub(1);
            let overall = gear.map_or(0.0, |gear| manual.overall[gear]);
            c.running.speed_rad_s = overall * (wheel_rad_s - half_rad_s).max(0.0);
            overall * (wheel_rad_s + half_rad_s).max(0.0)
        }
    };
    let now = car.engine.in_step(
        t[COOLANT],
        t[ENGINE_OIL],
        &car.engine_oil,
        car.charge,
        &c.running,
        dt,
    );
    c.running = if off {
        Running::STOPPED
    } else {
        Running {
            since_s: c.running.since_s + dt,
            speed_rad_s: row.engine_end_rad_s,
            ..c.running
        }
    };
    let begun = 0.5 * car.engine.inertia_kg_m2 * row.engine_end_rad_s * row.engine_end_rad_s;
    let accessories = now.accessories_nm(w);
    close(row.accessories_w, accessories * w, 1e3, place);
    let (to_coolant, to_oil);
    if off {
        // The engine runs out against its own friction.
        close(row.kinetic_w, -c.kinetic_j / dt, 1e4, place);
        (to_coolant, to_oil) = (-row.kinetic_w, 0.0);
        c.kinetic_j = 0.0;
        assert!(
            row.fuel_kg_s == 0.0 && !row.flags.contains(Flags::FUEL_CUT),
            "{place}"
        );
        close(row.engine_heat_w, to_coolant, 1e4, place);
        seen.off += 1;
    } else {
        let steady = row.engine_torque_nm + accessories;
        let wanted = (begun - c.kinetic_j) / dt / w;
        // In overrun the brakes give it, what they have (SI-5).
        let lags = row.kinetic_w < wanted * w * (1.0 - 1e-9);
        let room_w = (now.full_load_nm(w) - steady).max(0.0).min(wanted.max(0.0)) * w;
        let fired = row.brake_w <= 0.0 && (row.kinetic_w - room_w).abs() <= 1e-6 * (1.0 + room_w);
        let overruns = row.engine_torque_nm < 0.0 && wanted > 0.0;
        let by_brakes = overruns && !fired && (row.brake_w > 0.0 || lags);
        let torque = if by_brakes {
            0.0
        } else if wanted > 0.0 {
            (now.full_load_nm(w) - steady).max(0.0).min(wanted)
        } else {
            (-(steady + now.own_drag_nm(w))).max(wanted).min(0.0)
        }; // SI-2
        let over = if wanted < 0.0 { torque - wanted } else { 0.0 }; // SI-4
        let kinetic_w = match (by_brakes, row.brake_w > 0.0) {
            (true, true) => wanted * w,
            (true, false) => row.kinetic_w,
            (false, _) => (torque - over) * w,
        };
        close(row.kinetic_w, kinetic_w, 1e4, place); // SI-1
        c.kinetic_j += row.kinetic_w * dt;
        let burn = now.burn(w, steady + torque);
        close(row.fuel_kg_s, burn.fuel_kg_s, 1e-3, place);
        close(row.fuel_power_w, burn.fuel_w, 1e5, place);
        close(row.exhaust_w, burn.exhaust_w, 1e5, place);
        close(
            row.engine_heat_w,
            burn.to_coolant_w + burn.to_oil_w,
            1e5,
            place,
        );
        assert_eq!(row.flags.contains(Flags::FUEL_CUT), burn.cut, "{place}");
        assert!(
            !burn.outside || row.flags.contains(Flags::OUTSIDE_VALIDITY),
            "{place}"
        );
        (to_coolant, to_oil) = (burn.to_coolant_w, burn.to_oil_w);
        seen.wanted_up += u32::from(wanted > 1e-6 && (torque - wanted).abs() < 1e-12);
        seen.held_up += u32::from(wanted > 1e-6 && torque < wanted - 1e-6);
        seen.wanted_down += u32::from(wanted < -1e-6 && (torque - wanted).abs() < 1e-12);
        seen.braked += u32::from(over > 1e-6);
    }
    let mut power_w = heat_w(car, row);
    power_w[COOLANT] += to_coolant;
    power_w[ENGINE_OIL] += to_oil;
    heat(car, row, c, power_w, place);
}

/// The network's step with that heat, and what the row says of it.
fn heat(car: &Car, row: &Row, c: &mut Carried, power_w: [f64; NODES], place: &str) {
    let sump = c.heat.node_k[SUMP];
    let step = car.network.advance(
        &c.heat,
        &HeatInput {
            power_w,
            ambient_k: car.ambient_k,
            speed_m_s: row.speed_m_s,
            pump_rad_s: row.engine_speed_rad_s,
            oil_flow_m3_s: 0.0,
            oil_volume_heat_j_m3k: car.oil.density_kg_m3(sump) * car.oil.heat_capacity_j_kgk(sump),
            running: !row.flags.contains(Flags::ENGINE_OFF),
            dt_s: row.dt_s,
        },
    );
    let t = step.heat.node_k;
    for (got, want) in [
        (row.coolant_k, t[COOLANT]),
        (row.engine_oil_k, t[ENGINE_OIL]),
        (row.sump_k, t[SUMP]),
        (row.metal_k, t[METAL]),
    ] {
        close(got, want, 1e3, place);
    }
    assert!(row.belt_spray_k.is_nan() != car.transmission.is_cvt());
    if car.transmission.is_cvt() {
        close(row.belt_spray_k, t[BELT], 1e3, place);
    }
    close(row.stored_w, step.stored_w, 1e6, place);
    close(row.to_air_w, step.to_air_w, 1e6, place);
    c.heat = step.heat;
}

fn wheels(row: &Row, place: &str) {
    close(row.distance_m, row.speed_m_s * row.dt_s, 1e2, place);
    if row.speed_m_s > 0.0 {
        let wheel = row.wheel_power_w / row.wheel_torque_nm;
        assert!(
            row.wheel_power_w.abs() < 1e-9 || (row.speed_m_s / wheel - 0.2).abs() < 0.2,
            "{place}"
        );
        close(
            row.overall_ratio * row.wheel_power_w,
            row.engine_speed_rad_s * row.wheel_torque_nm,
            1e5,
            place,
        );
    } else {
        assert!(
            row.wheel_torque_nm == 0.0 && row.overall_ratio.is_nan(),
            "{place}"
        );
    }
    assert!(
        row.power_ledger_error.abs() < 1e-9 && row.heat_ledger_error.abs() < 1e-9,
        "{place}"
    );
}

/// Every row of cold runs of every shipped car, with gears of the cycle and without, over hills, a soak and steps below a second.
#[test]
fn val_rows_from_their_parts() {
    let mut seen = Seen::default();
    for (name, cycle, ambient_degc, dt) in [
        (CARS[0], cycle("ece15_eudc"), -10.0, 1.0),
        (CARS[1], cycle("ece15_eudc"), -10.0, 1.0),
        (CARS[2], cycle("ftp75"), 25.0, 1.0),
        (CARS[0], cycle("ftp75"), 5.0, 0.5),
        (CARS[0], hill(), 20.0, 1.0),
        (CARS[1], hill(), 20.0, 0.25),
    ] {
        let setup = car(name, &[]);
        let mut car = setup.car(ambient_degc + ZERO);
        car.network.cooler = None; // the row has no oil flow
        car.charge = if ambient_degc > 19.0 && ambient_degc < 21.0 {
            0.3
        } else {
            0.95
        };
        if dt < 1.0 {
            car.engine.inertia_torque_nm = 6.0; // a bound that is met
        }
        let (rows, start) = run(&car, &cycle, dt);
        let (coolant, oil) = (start.node_k[COOLANT], start.node_k[ENGINE_OIL]);
        let running = Running::STOPPED.started(coolant);
        let idle = car
            .engine
            .in_step(coolant, oil, &car.engine_oil, car.charge, &running, dt)
            .idle_rad_s;
        let kinetic_j = 0.5 * car.engine.inertia_kg_m2 * idle * idle;
        let mut carried = Carried {
            heat: start,
            kinetic_j,
            running: Running::STOPPED,
        };
        for row in &rows {
            let place = format!("{name} {ambient_degc} {} s", row.time_s);
            check(&car, row, &mut carried, &mut seen, &place);
            wheels(row, &place);
            seen.missed += u32::from(row.deficit_w > 1.0);
        }
    }
    let Seen {
        wanted_up,
        held_up,
        wanted_down,
        braked,
        off,
        missed,
    } = seen;
    assert!(
        [wanted_up, held_up, wanted_down, braked, off, missed]
            .iter()
            .all(|n| *n > 2),
        "{seen:?}"
    );
}

fn run(car: &Car, cycle: &Cycle, dt: f64) -> (Vec<Row>, Heat) {
    let mut keep = Keep::default();
    let start = State::at(car.ambient_k);
    simulate(
        car,
        cycle.trace_for(car.transmission.is_cvt()),
        dt,
        start,
        &mut keep,
    );
    (keep.rows, start.heat)
}

/// Rows that are kept are those that were driven, in order, whatever the number of the lots in which they come.
#[test]
fn kept_rows_are_all_rows() {
    let setup = car(CARS[1], &[]);
    let cycle = cycle("ece15_eudc");
    let outcome = drive(
        &setup,
        &cycle,
        &cvtcycle_model::drive::Conditions {
            keep_rows: true,
            ..at(20.0, Start::Soak)
        },
    );
    let (rows, _) = run(&setup.car(20.0 + ZERO), &cycle, 1.0);
    assert_eq!(outcome.rows.len(), rows.len());
    assert!(
        outcome
            .rows
            .iter()
            .zip(&rows)
            .all(|(a, b)| a.time_s == b.time_s && a.fuel_kg_s == b.fuel_kg_s)
    );
}

/// The plot's fuel map: its grid, its bound at full load, and fuel over work at its points.
#[test]
fn val_fuel_map_by_hand() {
    let setup = car(CARS[0], &[]);
    let (map, e) = (fuel_map(&setup), setup.engine());
    let hot = e.at(e.hot_k, e.hot_k, setup.oils().1, 1.0);
    assert_eq!((map.speed_rad_s.len(), map.torque_nm.len()), (41, 40));
    same(map.speed_rad_s[0], e.idle_hot_rad_s);
    same(
        map.speed_rad_s[10],
        0.75 * e.idle_hot_rad_s + 0.25 * e.highest_rad_s,
    );
    same(map.speed_rad_s[40], e.highest_rad_s);
    let most = map.full_load_nm.iter().copied().fold(0.0, f64::max);
    same(map.torque_nm[39], most);
    same(map.torque_nm[9], most / 4.0);
    for (i, w) in map.speed_rad_s.iter().enumerate() {
        same(map.full_load_nm[i], hot.full_load_nm(*w));
        for (j, t) in map.torque_nm.iter().enumerate() {
            let inside = *t <= hot.full_load_nm(*w) + most / 40.0;
            assert_eq!(map.bsfc_kg_j[i][j].is_nan(), !inside);
            if inside {
                near(
                    map.bsfc_kg_j[i][j],
                    hot.burn(*w, *t).fuel_kg_s / (t * w),
                    1e-12,
                );
            }
        }
    }
    same(litres_per_100km(0.745, 745.0, 20_000.0), 5.0);
    same(litres_per_100km(0.745, 745.0, 10.0), 10_000.0);
    same(litres_per_hour(0.745, 745.0, 1800.0), 2.0);
    assert!(litres_per_hour(0.745, 745.0, 0.0).is_nan());
    assert!(distance_counts(10.0, 36.0) && !distance_counts(9.99, 1.0));
    assert!(distance_counts(100.0, 359.9) && !distance_counts(100.0, 360.1)); // 1 km/h
    same(co2_g_per_km(1.0, 3.1, 20_000.0), 155.0);
    for short_m in [0.0, 1e-300, 9.99] {
        assert!(litres_per_100km(1.0, 745.0, short_m).is_nan());
        assert!(co2_g_per_km(1.0, 3.1, short_m).is_nan());
    }
}

/// LE-1 and LE-3 by hand: 100 W of fuel and 7 W out of the store against 94 W that are accounted for, with wheels that take and that drive. Terms of one
/// row have one sign each, so every sign of the sum of magnitudes counts.
#[test]
fn val_the_error_of_the_ledger_is_the_gap_over_all_magnitudes() {
    let terms = EnergyTerms {
        fuel: 100.0,
        wheels: 20.0,
        brake: 3.0,
        accessories: 5.0,
        losses: 11.0,
        kinetic: 13.0,
        engine_heat: 17.0,
        exhaust: 23.0,
        store: 7.0,
        electric_loss: 2.0,
        ..EnergyTerms::default()
    };
    same(terms.power_error(), 13.0 / 201.0);
    let driven = EnergyTerms {
        wheels: -20.0,
        ..terms
    };
    same(driven.power_error(), 53.0 / 201.0);
}

/// A drive whose rows are numbers counts none that is not.
#[test]
fn rows_of_numbers_are_not_counted_as_missing() {
    let totals = drive(
        &car("rover_216_cvt", &[]),
        &cycle("ece15"),
        &at(-10.0, Start::Soak),
    )
    .totals;
    assert!(totals.not_finite_s == 0.0 && totals.not_finite_at_s.is_nan());
}
