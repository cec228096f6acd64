//! Classes of engines: their lines and maps against the measured maps, and the drag without fuel (EN-7, WI-3).
//!
//! Truth: points of EPA's maps (`tests/golden/engine_map_points.csv`, with their source) and cells copied from them by hand; continuity, and the balance of energy.

use crate::common::{ZERO, cycle};
use cvtcycle_config::setup::{Disk, Kind, Options, Setup, read};
use cvtcycle_model::drive::{Conditions, Start, drive};
use cvtcycle_model::engine::{Engine, EngineAtTemperature, FuelModel};
use cvtcycle_model::keys::rad_s;
use cvtcycle_model::maps::{Basis, BsfcMap, Fuel, FuelRow, FuelTable, Load};

/// A car of classes, with tables of its own.
fn car(body: &str, engine: &str, own: &str) -> Setup {
    let like = format!("\"class:{body}\", \"class:{engine}\", \"class:box_cvt_clutch\"");
    let text = format!("[vehicle]\ntitle = \"a\"\nlike = [{like}]\n{own}");
    read(
        "a.toml",
        &text,
        Box::new(Disk::default()),
        &Options::default(),
    )
    .unwrap_or_else(|found| panic!("{engine}: {found:?}"))
}

fn hot<'e>(setup: &'e Setup, engine: &'e Engine) -> EngineAtTemperature<'e> {
    // The reference oil, so that friction is that of the fuel line to the last bit but rounding.
    EngineAtTemperature {
        friction_factor: 1.0,
        ..engine.at(engine.hot_k, engine.hot_k, setup.oils().1, 1.0)
    }
}

fn engines() -> Vec<&'static str> {
    let names = Kind::Class.names().into_iter();
    names.filter(|name| name.starts_with("engine_")).collect()
}

/// Rows of the points: class, stroke, six specific consumptions, four motoring pressures.
fn points() -> Vec<(String, Vec<f64>)> {
    let text = include_str!("../../golden/engine_map_points.csv");
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let row = |line: &str| {
        let (class, rest) = line.split_once(',').unwrap();
        (
            class.to_owned(),
            rest.split(',').map(|x| x.parse().unwrap()).collect(),
        )
    };
    rows.map(row).collect()
}

const PLACES: [(f64, f64); 6] = [
    (1500.0, 2.0),
    (1500.0, 6.0),
    (2000.0, 2.0),
    (2000.0, 4.0),
    (2000.0, 6.0),
    (2500.0, 8.0),
];

/// Root mean square of the errors of a class at the points of a measured engine, per cent. Fuel is compared as energy: the maps are for 43.1 MJ/kg, 42.8 for the diesel.
fn rms(class: &str, measured: &str) -> f64 {
    let points = points();
    let (_, row) = points.iter().find(|(name, _)| name == measured).unwrap();
    let own = format!("[engine]\nstroke_mm = {}\n", row[0]);
    let setup = car("compact_2020", class, &own);
    let engine = setup.engine();
    let now = hot(&setup, engine);
    let joule_per_kg = if measured == "engine_bmw_n57" {
        42.8e6
    } else {
        43.1e6
    };
    let square = |(k, (rpm, bar)): (usize, &(f64, f64))| {
        let (w, nm) = (rad_s(*rpm), engine.torque_nm(bar * 1e5));
        let g_kwh = now.burn(w, nm).fuel_w / joule_per_kg / (nm * w) * 3.6e9;
        (g_kwh / row[1 + k] - 1.0).powi(2)
    };
    let sum: f64 = PLACES.iter().enumerate().map(square).sum();
    100.0 * (sum / PLACES.len() as f64).sqrt()
}

/// Each class of technology has the consumption of the engines that it was fitted to, within the rms of its fit over 234 points; of six points, and of a mean of two lines, it may be a little more.
#[test]
fn classes_burn_what_measured_engines_burn() {
    for (class, measured, most) in [
        ("engine_atkinson_2017", "engine_toyota_a25a_fks", 1.4),
        (
            "engine_di_high_compression_2012",
            "engine_mazda_skyactiv_g_20",
            2.4,
        ),
        ("engine_di_2012", "engine_gm_lv3", 5.6),
        ("engine_di_2012", "engine_mazda_skyactiv_g_20", 7.0),
        ("engine_turbo_2010", "engine_ford_ecoboost_16", 3.7),
        ("engine_turbo_2015", "engine_honda_l15b7", 4.5),
        ("engine_turbo_2015", "engine_ford_ecoboost_27", 4.8),
        ("engine_diesel_2015", "engine_bmw_n57", 3.0),
        // Interpolated: between the group of 1991 and this one.
        ("engine_pfi_2013", "engine_gm_lv3", 3.0),
    ] {
        let rms = rms(class, measured);
        assert!(
            rms < most && rms > 0.1,
            "{class} against {measured}: {rms:.1} %"
        );
    }
    // A line of the 1990s is none of these: the test can tell them apart.
    assert!(rms("engine_pfi_1990", "engine_toyota_a25a_fks") > 15.0);
    assert!(rms("engine_pfi_1990", "engine_mazda_skyactiv_g_20") > 12.0);
}

/// Sets of port injection lie in order of their years.
#[test]
fn port_injection_falls_with_the_years() {
    let rms = |year: u32| rms(&format!("engine_pfi_{year}"), "engine_mazda_skyactiv_g_20");
    let all = [1990, 2000, 2005, 2010, 2013].map(rms);
    assert!(all.windows(2).all(|pair| pair[1] < pair[0]), "{all:?}");
}

/// Cells copied from EPA's maps: class, rpm, Nm, g/s.
const CELLS: [(&str, f64, f64, f64); 21] = [
    ("engine_toyota_a25a_fks", 1040.0, 87.07, 0.64037),
    ("engine_toyota_a25a_fks", 4493.1, 161.29, 4.96182),
    ("engine_toyota_a25a_fks", 1729.0, 45.7, 0.66672),
    ("engine_mazda_skyactiv_g_20", 3994.4, 80.02, 2.39613),
    ("engine_mazda_skyactiv_g_20", 3994.4, 129.76, 3.53799),
    ("engine_mazda_skyactiv_g_20", 1249.5, 110.09, 0.95079),
    ("engine_gm_lv3", 1999.9, 187.68, 2.7975),
    ("engine_gm_lv3", 1742.8, 166.38, 2.16268),
    ("engine_gm_lv3", 1742.8, 19.66, 0.72493),
    ("engine_ford_ecoboost_16", 2500.1, 71.57, 1.41579),
    ("engine_ford_ecoboost_16", 1151.0, 20.35, 0.27655),
    ("engine_ford_ecoboost_16", 1751.0, 108.45, 1.36261),
    ("engine_ford_ecoboost_27", 2251.1, 144.49, 2.36606),
    ("engine_ford_ecoboost_27", 1001.2, 104.38, 0.81504),
    ("engine_ford_ecoboost_27", 2001.1, 178.61, 2.51368),
    ("engine_honda_l15b7", 1501.5, 51.4, 0.57814),
    ("engine_honda_l15b7", 2251.4, 41.31, 0.77072),
    ("engine_honda_l15b7", 2499.6, 95.54, 1.62858),
    ("engine_bmw_n57", 3250.0, 132.57, 3.07017),
    ("engine_bmw_n57", 1500.1, 211.13, 2.15611),
    ("engine_bmw_n57", 3500.0, 132.57, 3.40136),
];

/// A named engine burns what its map has, and in another size the same per displacement.
#[test]
fn a_measured_engine_burns_its_map() {
    for (class, rpm, nm, g_s) in CELLS {
        let joule_per_kg = if class == "engine_bmw_n57" {
            42.8e6
        } else {
            43.1e6
        };
        let setup = car("compact_2020", class, "");
        let burn = hot(&setup, setup.engine()).burn(rad_s(rpm), nm);
        let got = burn.fuel_w / joule_per_kg * 1e3;
        assert!((got / g_s - 1.0).abs() < 1e-9, "{class} {rpm} {nm}: {got}");
        let litres = setup.engine().displacement_m3 * 1e3;
        let double = format!("[engine]\ndisplacement_cc = {}\n", 2000.0 * litres);
        let setup = car("compact_2020", class, &double);
        let twice = hot(&setup, setup.engine()).burn(rad_s(rpm), 2.0 * nm);
        assert!((twice.fuel_w / burn.fuel_w - 2.0).abs() < 1e-9, "{class}");
    }
}

/// Drags of the named engines against their closed-throttle lines; of the 1.6 and 2.7 EcoBoost those have steps that no smooth line has.
#[test]
fn drags_are_those_of_closed_throttles() {
    for (class, row) in points() {
        let setup = car("compact_2020", &class, "");
        let motored = setup.engine().motored.unwrap();
        for (k, v) in [2.0, 4.0, 6.0, 8.0].into_iter().enumerate() {
            let got = motored.hot_pa(v) / 1e5;
            let most = match class.as_str() {
                "engine_ford_ecoboost_27" => 0.4,
                "engine_ford_ecoboost_16" => 0.3,
                _ => 0.09,
            };
            assert!(
                (got - row[7 + k]).abs() < most,
                "{class} {v} m/s: {got:.3} and {}",
                row[7 + k]
            );
        }
    }
}

/// WI-3: fuel is continuous at no torque of the hot engine and at the drag, rises between, and is nothing at the drag; hot and cold.
#[test]
fn fuel_falls_to_nothing_at_the_drag() {
    for class in engines() {
        let setup = car("compact_2020", class, "");
        let engine = setup.engine();
        let cold = engine.at(ZERO, ZERO - 5.0, setup.oils().1, 1.05);
        assert!(cold.friction_factor > 1.3);
        for (now, what) in [(hot(&setup, engine), "hot"), (cold, "cold")] {
            for rpm in [900.0, 1500.0, 2500.0, 4000.0] {
                let w = rad_s(rpm);
                let drag = now.own_drag_nm(w);
                let colder = (now.friction_factor - 1.0)
                    * engine.torque_nm(engine.fuel.hot_friction_pa(engine.piston_m_s(w)));
                let fuel = |nm: f64| now.burn(w, nm).fuel_w;
                let most = fuel(0.0);
                let jump = |nm: f64| (fuel(nm + 1e-7) - fuel(nm - 1e-7)).abs() / most;
                assert!(
                    jump(-drag) < 1e-6 && jump(-colder) < 1e-6,
                    "{class} {what} {rpm}"
                );
                let at_drag = now.burn(w, -drag);
                assert!(
                    at_drag.fuel_w < 1e-3 && at_drag.cut && !at_drag.outside,
                    "{class} {what}: {at_drag:?}"
                );
                let mut before = 0.0;
                for k in 1..=20 {
                    let next = fuel(-drag * (1.0 - f64::from(k) / 20.0));
                    assert!(next > before, "{class} {what} {rpm}: {next} after {before}");
                    before = next;
                }
                assert!(now.burn(w, -0.5 * drag - 0.5 * colder).fuel_w > 0.0);
                // More than the closed throttle takes up is energy from nowhere.
                assert!(now.burn(w, -1.01 * drag).outside, "{class} {what}");
            }
        }
    }
}

/// The drag of the hot engine and what cold oil adds to friction, in newton metres by hand (EN-7).
#[test]
fn cold_oil_adds_to_the_drag_what_it_adds_to_friction() {
    let own = "[engine.friction]\noverrun_factor = 1.2\n";
    let setup = car("compact_1995", "engine_turbo_2015", own);
    let engine = setup.engine();
    let cold = engine.at(ZERO, ZERO, setup.oils().1, 1.0);
    let v = engine.stroke_m * 2000.0 / 30.0;
    let drag_bar = 0.953 + 0.0462 * v + 0.0021 * v * v;
    let friction_bar = 1.787_515 + 0.002_86 * v * v;
    let bar = 1.2 * (drag_bar + (cold.friction_factor - 1.0) * friction_bar);
    let nm = bar * 1e5 * engine.displacement_m3 / (4.0 * std::f64::consts::PI);
    assert!((cold.own_drag_nm(rad_s(2000.0)) / nm - 1.0).abs() < 1e-12);
}

/// Every joule of fuel and of what turns the engine is heat or exhaust, from full load down to the drag; the exhaust takes no more than the gas kept.
#[test]
fn the_balance_of_an_engine_is_closed_in_overrun() {
    for class in [
        "engine_di_2012",
        "engine_turbo_2010",
        "engine_honda_l15b7",
        "engine_bmw_n57",
    ] {
        let setup = car("compact_2020", class, "");
        let engine = setup.engine();
        for now in [
            hot(&setup, engine),
            engine.at(ZERO, ZERO, setup.oils().1, 1.0),
        ] {
            let w = rad_s(1800.0);
            let drag = now.own_drag_nm(w);
            for k in 0..=40 {
                let nm = -drag * (1.0 - f64::from(k) / 30.0);
                let burn = now.burn(w, nm);
                let heat = burn.to_coolant_w + burn.to_oil_w + burn.exhaust_w;
                assert!(
                    (burn.fuel_w - nm * w - heat).abs() < 1e-9 * (heat.abs() + 1.0),
                    "{class} {nm}"
                );
                for part in [burn.to_coolant_w, burn.to_oil_w, burn.exhaust_w] {
                    assert!(part > -1e-9, "{class} {nm}: {burn:?}");
                }
            }
            // Heat of friction goes over from that of the fuel line to the drag itself.
            let at_drag = now.burn(w, -drag);
            assert!((at_drag.to_oil_w - engine.friction_to_oil * drag * w).abs() < 1e-3);
        }
    }
}

/// A car with each engine keeps its books over a cycle, and leaves no fuel line below full load.
#[test]
fn cars_with_every_engine_keep_their_books() {
    let cycle = cycle("ece15_eudc");
    for class in engines() {
        let body = if class.contains("bmw") || class.contains("gm") {
            "suv_2020"
        } else {
            "compact_2020"
        };
        let setup = car(body, class, "");
        let conditions = Conditions {
            keep_rows: true,
            ..crate::common::at(-7.0, Start::Soak)
        };
        let outcome = drive(&setup, &cycle, &conditions);
        for row in &outcome.rows {
            assert!(
                row.power_ledger_error.abs() < 1e-6 * (1.0 + row.fuel_power_w.abs()),
                "{class}: {row:?}"
            );
        }
        let fuel = outcome.totals.total().fuel_kg;
        assert!(fuel > 0.2 && fuel < 1.5, "{class}: {fuel} kg");
    }
}

/// The Willans line has a root up to full load of every class, and the map reaches it.
#[test]
fn no_class_reaches_beyond_its_fuel_model() {
    for class in engines() {
        // Full load of a body of its years.
        let body = if class == "engine_pfi_1990" {
            "compact_1995"
        } else {
            "compact_2020"
        };
        let setup = car(body, class, "");
        let doubts = setup.doubts();
        let is_range = |doubt: &&String| doubt.contains("full load is");
        assert!(
            doubts.iter().find(is_range).is_none(),
            "{class}: {doubts:?}"
        );
        let FuelModel::Willans(line) = &setup.engine().fuel else {
            continue;
        };
        // 20 bar of a turbo engine, 24 of the diesel, 14 of the others.
        let bar = match class {
            _ if class.contains("turbo") => 20.0,
            _ if class.contains("diesel") => 24.0,
            _ => 14.0,
        };
        for k in 2..=16 {
            let v = f64::from(k);
            let b = line.efficiency(v);
            let root = b * b + 4.0 * line.a2 * (bar + line.l + line.l2 * v * v);
            assert!(root > 0.0, "{class} at {v} m/s");
        }
    }
    // 20 bar on a line of natural aspiration is doubted, with both numbers.
    let turbo = "[engine]\nfull_load = [[700, 150], [1500, 274], [4500, 274], [6000, 200]]\nrated_kw = 129\n";
    let found = car("compact_2020", "engine_di_2012", turbo).doubts();
    assert!(
        found
            .iter()
            .any(|doubt| doubt.contains("full load is 20.0 bar at")
                && doubt.contains("holds up to 15.1 bar")
                && doubt.contains("a turbo or diesel engine has its own")),
        "{found:?}"
    );
    let found = car(
        "compact_1995",
        "engine_pfi_1990",
        &turbo.replace("274", "180"),
    )
    .doubts();
    assert!(
        found
            .iter()
            .any(|doubt| doubt.contains("holds up to 11.9 bar")),
        "{found:?}"
    );
    let small = turbo
        .replace("274", "300")
        .replace("[engine]", "[engine]\ndisplacement_cc = 1496");
    let found = car("compact_2020", "engine_honda_l15b7", &small).doubts();
    assert!(
        found
            .iter()
            .any(|doubt| doubt.contains("map of fuel holds up to 20.9 bar")
                && doubt.contains("it is one of charged engines")),
        "{found:?}"
    );
}

/// BM-1 of fuel flows: loads at and below nothing are kept, those below the drag leave no fuel, and are no fall.
#[test]
fn maps_of_flow_go_below_no_torque() {
    let row = |w: f64, bar: f64, g_s: f64| (w, bar * 1e5, g_s * 1e-3);
    let rows = [
        row(100.0, -2.0, 0.0),
        row(100.0, -0.5, 0.1),
        row(100.0, 2.0, 0.4),
        row(200.0, -2.0, 0.01),
        row(200.0, -0.5, 0.2),
        row(200.0, 2.0, 0.8),
    ];
    let made = |rows: &[(f64, f64, f64)]| {
        let row = |row: &(f64, f64, f64)| FuelRow {
            speed_rad_s: row.0,
            load: row.1,
            fuel: row.2,
            line: 1,
        };
        let table = FuelTable {
            file: "map".to_owned(),
            read_as: None,
            swept: Vec::new(),
            load: Load::Bmep,
            fuel: Fuel::Flow,
            rows: rows.iter().map(row).collect(),
        };
        let basis = Basis {
            heating_value_j_kg: 43e6,
            displacement_m3: 1.5e-3,
            cylinders: None,
        };
        BsfcMap::from_table(&table, &basis, (2.0, 0.0)).unwrap()
    };
    let map = made(&rows);
    let mep = |w: f64, g_s: f64| g_s * 1e-3 * 43e6 / w * 4.0 * std::f64::consts::PI / 1.5e-3;
    assert!((map.fuel_pa[1][2] / mep(200.0, 0.8) - 1.0).abs() < 1e-12);
    let model = FuelModel::Map(map);
    // Hot drag of 1.2 bar: from -0.5 bar down to it the fuel falls to nothing, though the map has some at -2 bar.
    let at = |bar: f64| model.fuel_mep_above_drag(5.0, 200.0, bar * 1e5, 2e5, 1.2e5);
    assert!((at(-0.5).fuel_pa / mep(200.0, 0.2) - 1.0).abs() < 1e-12);
    assert!((at(-0.85).fuel_pa / mep(200.0, 0.1) - 1.0).abs() < 1e-12);
    assert!(at(-1.2).fuel_pa == 0.0 && at(-1.5).fuel_pa == 0.0 && at(-1.5).indicated_pa == 0.0);
    // Loads without fuel are no fall.
    assert!(made(&rows).judge(|_| 3e5).refusal.is_none());
}
