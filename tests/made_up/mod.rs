//! Made-up runs.
use cvtcycle::model::drive::FuelMap;
use cvtcycle::output::columns::columns_for;
use cvtcycle::output::{Component, Flags, History, Row};
use cvtcycle::report::charts::PlotRun;

pub mod every;

/// Components of a car with a CVT.
pub const CVT: [Component; 10] = [
    Component::LaunchClutch,
    Component::Pump,
    Component::InputShaft,
    Component::ClutchDrag,
    Component::BeltBand,
    Component::BeltFilm,
    Component::BeltSlip,
    Component::BeltWedge,
    Component::BeltPenetration,
    Component::FinalDrive,
];
/// Components of a car with a manual box.
pub const MANUAL: [Component; 5] = [
    Component::LaunchClutch,
    Component::GearMesh,
    Component::Bearing,
    Component::Churning,
    Component::Seal,
];

/// Hills of speed with idling between them: four short ones and a long one, over and over.
pub fn speed_kmh(t: f64) -> f64 {
    let urban = |t: f64| {
        let hills = [
            (11.0, 15.0, 23.0, 28.0, 15.0),
            (49.0, 61.0, 85.0, 96.0, 32.0),
            (117.0, 143.0, 155.0, 188.0, 50.0),
        ];
        hills
            .iter()
            .find(|h| t > h.0 && t < h.3)
            .map_or(0.0, |(a, b, c, d, v)| {
                v * ((t - a) / (b - a)).min(1.0).min((d - t) / (d - c)).max(0.0)
            })
    };
    let t = t % 1180.0;
    if t < 780.0 {
        return urban(t % 195.0);
    }
    let knots = [
        (0.0, 0.0),
        (20.0, 0.0),
        (61.0, 70.0),
        (111.0, 70.0),
        (119.0, 50.0),
        (188.0, 50.0),
        (201.0, 70.0),
        (251.0, 70.0),
        (286.0, 100.0),
        (316.0, 100.0),
        (336.0, 120.0),
        (346.0, 120.0),
        (380.0, 0.0),
        (401.0, 0.0),
    ];
    let t = t - 780.0;
    knots
        .windows(2)
        .find(|k| t >= k[0].0 && t <= k[1].0)
        .map_or(0.0, |k| {
            k[0].1 + (k[1].1 - k[0].1) * (t - k[0].0) / (k[1].0 - k[0].0)
        })
}

pub fn rows(n: usize, dt: f64, cvt: bool) -> Vec<Row> {
    (0..n).map(|i| row((i + 1) as f64 * dt, dt, cvt)).collect()
}

pub fn row(t: f64, dt: f64, cvt: bool) -> Row {
    let v = speed_kmh(t - 0.5 * dt) / 3.6;
    let a = (speed_kmh(t) - speed_kmh(t - dt)) / 3.6 / dt;
    let force = if v > 0.0 {
        130.0 + 0.4 * v * v + 1100.0 * a
    } else {
        0.0
    };
    let gear: u8 =
        [3.0, 7.0, 11.0, 16.0].iter().filter(|x| v > **x).count() as u8 + u8::from(v > 0.5);
    let overall = if cvt {
        (110.0 / v.max(1.0)).max(2.6 + 15.0 / (1.0 + v)).min(13.0)
    } else {
        [0.0, 14.0, 8.0, 5.4, 4.2, 3.3][usize::from(gear)]
    };
    let engine = (v / 0.29 * overall).max(90.0);
    let torque = if v > 0.3 {
        (force * 0.29 / overall.max(1.0)).max(-18.0)
    } else {
        6.0
    };
    let power = (torque * engine).abs();
    let warm = |k: f64, end: f64| 273.15 + end - (end - 22.0) * (-t / k).exp();
    let mut row = Row {
        time_s: t,
        dt_s: dt,
        phase: if t % 1180.0 <= 780.0 {
            ((t % 1180.0 - 1e-9) / 195.0) as u16
        } else {
            4
        },
        speed_m_s: v,
        accel_m_s2: a,
        wheel_torque_nm: force * 0.29,
        wheel_power_w: force * v,
        engine_speed_rad_s: engine,
        engine_torque_nm: torque,
        gear,
        belt_ratio: if cvt { overall / 5.2 } else { f64::NAN },
        overall_ratio: if v > 0.0 { overall } else { f64::NAN },
        primary_pressure_pa: if cvt {
            1e5 * (4.0 + 0.11 * torque.abs() + 3.0 * v / 30.0 + (t * 0.9).sin())
        } else {
            f64::NAN
        },
        secondary_pressure_pa: if cvt {
            1e5 * (7.0 + 0.18 * torque.abs() + 0.6 * (t * 1.7).sin())
        } else {
            f64::NAN
        },
        slip: 0.004 + 1e-5 * torque,
        clamp_safety: if torque.abs() > 1.0 {
            1.3
        } else {
            f64::INFINITY
        },
        fuel_kg_s: 1e-4 + power * 6.5e-8,
        coolant_k: warm(220.0, 90.0) + (t * 0.05).sin(),
        engine_oil_k: warm(330.0, 95.0),
        sump_k: warm(600.0, 75.0),
        metal_k: warm(800.0, 68.0),
        belt_spray_k: if cvt {
            warm(500.0, 80.0) + 6.0 * power / 2e4
        } else {
            f64::NAN
        },
        cooler_in_k: f64::NAN,
        cooler_out_k: if cvt { warm(700.0, 62.0) } else { f64::NAN },
        power_ledger_error: 1.3e-16,
        iterations: 7,
        ..Row::default()
    };
    let cold = 1.0 + 2.0 * (-t / 300.0).exp();
    let shares = [
        0.0, 0.004, 0.006, 0.005, 0.02, 0.006, 0.012, 0.008, 0.01, 0.03, 0.025, 0.03, 0.01, 0.004,
        0.003,
    ];
    for (component, share) in Component::ALL.into_iter().zip(shares) {
        row.loss_w[component as usize] =
            20.0 * share * 40.0 + share * power * cold.sqrt() + share * engine * 8.0 * cold;
    }
    row.loss_w[Component::LaunchClutch as usize] = if v > 0.1 && v < 4.0 && a > 0.0 {
        900.0
    } else {
        0.0
    };
    row.loss_w[Component::Pump as usize] =
        0.9 * engine * cold.sqrt() + row.secondary_pressure_pa.max(0.0) * 8e-5;
    row.flags.set(Flags::OVERRUN, torque < 0.0);
    row.flags.set(Flags::FUEL_CUT, torque < 0.0);
    row
}

pub fn fuel_map() -> FuelMap {
    let speed: Vec<f64> = (0..=26).map(|i| 80.0 + 21.0 * f64::from(i)).collect();
    let torque: Vec<f64> = (1..=30).map(|i| 5.0 * f64::from(i)).collect();
    let full: Vec<f64> = speed
        .iter()
        .map(|w| 132.0 - 0.00042 * (w - 380.0).powi(2))
        .collect();
    let bsfc = speed
        .iter()
        .zip(&full)
        .map(|(w, top)| {
            torque
                .iter()
                .map(|t| {
                    let drag = 9.0 + 0.012 * w + 0.00002 * w * w;
                    let rich = 1.0 + 0.9 * (t / top - 0.82).max(0.0);
                    if t > top {
                        f64::NAN
                    } else {
                        203.0 * rich * (t + drag) / t / 3.6e9
                    }
                })
                .collect()
        })
        .collect();
    FuelMap {
        speed_rad_s: speed,
        torque_nm: torque,
        bsfc_kg_j: bsfc,
        full_load_nm: full,
    }
}

pub fn phases() -> Vec<String> {
    ["ECE 1", "ECE 2", "ECE 3", "ECE 4", "EUDC"]
        .map(String::from)
        .to_vec()
}

pub fn history(cvt: bool, rows: &[Row], phases: &[String]) -> History {
    let components: &[Component] = if cvt { &CVT } else { &MANUAL };
    History::of(rows, &columns_for(cvt, components), phases)
}

pub fn run<'a>(name: &'a str, history: &'a History) -> PlotRun<'a> {
    let more = if history.is_cvt() { 0.4 } else { 0.0 };
    let group_fuel = [
        ("ECE 15", 8.9 + more),
        ("EUDC", 6.1),
        ("total", 7.12 + more / 2.0),
    ];
    PlotRun {
        name,
        history,
        fuel_map: Some(fuel_map()),
        group_fuel: group_fuel
            .map(|(group, fuel)| (group.to_string(), fuel))
            .to_vec(),
    }
}
