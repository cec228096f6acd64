//! Maps of a whole box by its input torque (MP-3, MP-4): loss, power or efficiency (MP-6), as a grid, a matrix, or scattered points (MP-5).
#![allow(clippy::unwrap_used, reason = "tests")]

use cvtcycle_config::cycle::embedded;
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_config::{Override, render};
use cvtcycle_model::drive::{Conditions, Outcome, Start, drive};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::file_table::FileRows;
use cvtcycle_model::keys::rad_s;
use cvtcycle_model::maps::{LossMap, MapPoint};
use cvtcycle_model::rig::{Bench, BenchPoint};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::box_map::scattered::{gridded, leave_one_out};
use cvtcycle_model::transmission::box_map::{map, points};
use cvtcycle_model::transmission::component::Component;
use std::fmt::Write;

const CVT: &str = "rover_216_cvt";
const BOX: &str = "transmission.cvt.maps.box=map.csv";

/// A shipped car with overrides, one of which may name `map.csv`.
pub fn car(vehicle: &str, csv: &str, set: &[&str]) -> Result<Setup, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("car.toml");
    let shipped = format!(
        "{}/../../vehicles/{vehicle}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::copy(shipped, &file).unwrap();
    std::fs::write(folder.path().join("map.csv"), csv).unwrap();
    let set = set.iter().map(|text| {
        let (key, value) = text.split_once('=').unwrap();
        Override::new(key, value).unwrap()
    });
    let options = Options {
        set: set.collect(),
        ..Options::default()
    };
    load(file.to_str().unwrap(), &options).map_err(|p| render(&p, false))
}

fn driven(setup: &Setup, start: Start) -> Outcome {
    let conditions = Conditions {
        ambient_k: 298.15,
        start,
        max_dt_s: 1.0,
        keep_rows: true,
    };
    drive(setup, &embedded("ece15_eudc").unwrap(), &conditions)
}

fn fuel_difference(a: &Outcome, b: &Outcome) -> f64 {
    a.totals.total().fuel_kg / b.totals.total().fuel_kg - 1.0
}

fn loss(map: &LossMap, ratio: f64, speed: f64, torque_nm: f64) -> f64 {
    let at = MapPoint {
        ratio,
        input_speed_rad_s: speed,
        torque_nm,
        pressure_pa: 0.0,
        oil_k: 353.15,
    };
    map.loss_nm(&at).0
}

/// Hand calculation: 3 Nm at any point is 3 Nm times the engine's speed in every row, at rest too, and no other loss but the clutch's.
#[test]
fn val_a_constant_cvt_box_map() {
    let csv = "input_torque_nm,torque_loss_nm\n-200,3\n400,3\n";
    let setup = car(CVT, csv, &[BOX]).unwrap();
    let o = driven(&setup, Start::Soak);
    let listed = setup.transmission().components();
    assert_eq!(listed, [Component::LaunchClutch, Component::BoxMap]);
    for row in &o.rows {
        let want = 3.0 * row.engine_speed_rad_s;
        let got = row.loss_w[Component::BoxMap];
        assert!(
            (got - want).abs() <= 1e-9 * want,
            "{} s: {got} {want}",
            row.time_s
        );
        let others: f64 = Component::ALL
            .into_iter()
            .filter(|c| !listed.contains(c))
            .map(|c| row.loss_w[c].abs())
            .sum();
        assert!(others <= 0.0 && row.slip.abs() <= 0.0);
    }
    assert!(o.totals.ledger_error < 1e-9);
    let without = car(CVT, csv, &[BOX, "transmission.cvt.loss_factor.box_map=0"]).unwrap();
    let without = driven(&without, Start::Soak);
    assert!(without.totals.total().loss_j[Component::BoxMap].abs() <= 0.0);
    assert!(fuel_difference(&without, &o) < -0.02);
}

/// The torque behind a map is the input torque less the loss there, in drive and overrun, with a factor on the loss too.
#[test]
fn the_input_torque_of_a_map_makes_up_its_loss() {
    let csv = FileRows {
        columns: vec!["input_torque_nm", "torque_loss_nm"],
        rows: [[-50.0, 8.0], [0.0, 2.0], [60.0, 5.0], [100.0, 11.0]]
            .map(Vec::from)
            .to_vec(),
    };
    let map = map(&points(&csv, None).unwrap()).unwrap();
    for behind_nm in [-70.0, -20.0, -1.0, 0.0, 0.3, 30.0, 55.0, 70.0, 120.0] {
        for factor in [0.0, 1.0, 2.5] {
            let at = MapPoint {
                ratio: 1.0,
                input_speed_rad_s: 100.0,
                torque_nm: behind_nm,
                pressure_pa: 0.0,
                oil_k: 300.0,
            };
            let (found, inside) = map.loss_behind_nm(&at, factor);
            let input_nm = behind_nm + found;
            let want = factor * loss(&map, 1.0, 100.0, input_nm);
            assert!((found - want).abs() < 1e-10, "{found} {want}");
            assert_eq!(inside, (-50.0..=100.0).contains(&input_nm));
        }
    }
    let steep = FileRows {
        columns: csv.columns,
        rows: [[0.0, 1.0], [10.0, 12.0]].map(Vec::from).to_vec(),
    };
    let why = self::map(&points(&steep, None).unwrap()).unwrap_err();
    assert!(why.message.contains("from 1.0000 to 12.0000"), "{why:?}");
}

/// Hand calculation of MP-6: power over speed, and efficiency in drive, without load, and mirrored or its own in overrun.
#[test]
fn val_power_and_efficiency_by_hand() {
    let rows = |columns: &[&'static str], rows: &[&[f64]]| FileRows {
        columns: columns.to_vec(),
        rows: rows.iter().map(|row| row.to_vec()).collect(),
    };
    let power = rows(
        &["input_speed_rpm", "input_torque_nm", "power_loss_w"],
        &[&[100.0, 0.0, 200.0], &[100.0, 50.0, 450.0]],
    );
    let power = map(&points(&power, None).unwrap()).unwrap();
    assert!((loss(&power, 1.0, 100.0, 25.0) - 3.25).abs() < 1e-12);
    let names = ["input_torque_nm", "efficiency_percent"];
    let share = rows(&names, &[&[20.0, 0.8], &[100.0, 0.95]]);
    let share = map(&points(&share, Some(1.5)).unwrap()).unwrap();
    for (torque, want) in [
        (0.0, 1.5),
        (20.0, 4.0),
        (60.0, 4.5),
        (100.0, 5.0),
        (-20.0, 20.0 * 0.25),
        (-100.0, 100.0 * (1.0 / 0.95 - 1.0)),
    ] {
        let got = loss(&share, 1.0, 100.0, torque);
        assert!((got - want).abs() < 1e-12, "{got} at {torque}");
    }
    let own = rows(&names, &[&[20.0, 0.8], &[-20.0, 0.5]]);
    let own = map(&points(&own, Some(0.5)).unwrap()).unwrap();
    assert!((loss(&own, 1.0, 100.0, -10.0) - 0.5 * (0.5 + 20.0)).abs() < 1e-12);
    for (torque, eta, idle) in [
        (1.0, 0.9, Some(1.0)),
        (20.0, 0.0, Some(1.0)),
        (20.0, 0.009, Some(1.0)),
        (20.0, 0.9, None),
    ] {
        assert!(points(&rows(&names, &[&[torque, eta]]), idle).is_err());
    }
}

/// The same map as rows, as a matrix with decimal commas, and with the headings of another program: the same drive to the bit.
#[test]
fn layouts_of_a_map_are_the_same_map() {
    let long = "ratio,input_speed_rpm,input_torque_nm,torque_loss_nm\n\
        0.4,500,-50,2.5\n0.4,500,150,6.5\n0.4,6000,-50,4\n0.4,6000,150,8\n\
        2.5,500,-50,3\n2.5,500,150,7\n2.5,6000,-50,5\n2.5,6000,150,9\n";
    let wide = "ratio;input_speed_rpm/input_torque_nm/torque_loss_nm;-50;150\n\
        0,4;500;2,5;6,5\n0,4;6000;4;8\n2,5;500;3;7\n2,5;6000;5;9\n";
    let other = long.replace(
        "ratio,input_speed_rpm,input_torque_nm,torque_loss_nm",
        "# a comment\nratio,Input Speed [rpm],Input Torque [Nm],Torque Loss [Nm]",
    );
    let fuel = |csv: &str| {
        let setup = car(CVT, csv, &[BOX]).unwrap();
        driven(&setup, Start::Soak).totals.total().fuel_kg.to_bits()
    };
    assert_eq!(fuel(long), fuel(wide));
    assert_eq!(fuel(long), fuel(&other));
    let hole = wide.replace("2,5;6000;5;9\n", "");
    let hole = car(CVT, &hole, &[BOX]).unwrap_err();
    assert!(
        hole.contains("there is no row for ratio 2.5, input_speed_rpm 6000"),
        "{hole}"
    );
}

/// Property of MP-5: points of a linear field make that field everywhere; one point off shows in the left-out differences.
#[test]
fn scattered_points_of_a_linear_field() {
    let field = |x: &[f64; 5]| 1.0 + 0.8 * x[0] + 0.002 * x[1] + 0.03 * x[2];
    let mut state = 1u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    let mut cloud = Vec::new();
    for corner in 0..8 {
        let end = |bit: u32, low: f64, high: f64| if corner >> bit & 1 == 1 { high } else { low };
        cloud.push([
            end(0, 0.4, 2.5),
            end(1, 50.0, 600.0),
            end(2, -50.0, 150.0),
            0.0,
            0.0,
        ]);
    }
    for _ in 0..300 {
        let x = [
            0.4 + 2.1 * random(),
            50.0 + 550.0 * random(),
            -50.0 + 200.0 * random(),
        ];
        cloud.push([x[0], x[1], x[2], 0.0, 0.0]);
    }
    let rows: Vec<([f64; 5], f64)> = cloud.iter().map(|x| (*x, field(x))).collect();
    let map = map(&gridded(&rows).unwrap()).unwrap();
    for _ in 0..200 {
        let x = [
            0.4 + 2.1 * random(),
            50.0 + 550.0 * random(),
            -50.0 + 200.0 * random(),
        ];
        let got = loss(&map, x[0], x[1], x[2]);
        let want = field(&[x[0], x[1], x[2], 0.0, 0.0]);
        assert!((got - want).abs() < 1e-9, "{got} {want}");
    }
    assert!(leave_one_out(&rows).unwrap().largest_nm < 1e-9);
    // As few points as are allowed: the plane through each twelve gives the thirteenth.
    let few = leave_one_out(&rows[..13]).unwrap();
    assert!(few.points == 13 && few.largest_nm < 1e-9, "{few:?}");
    let mut off = rows.clone();
    off[100].1 += 1.0;
    let missed = leave_one_out(&off).unwrap();
    assert!(missed.largest_nm > 0.9 && missed.rms_nm < missed.largest_nm);
    let csv = off.iter().fold(
        "ratio,input_speed_rpm,input_torque_nm,torque_loss_nm\n".to_owned(),
        |csv, (x, y)| {
            let rpm = x[1] * 30.0 / std::f64::consts::PI;
            csv + &format!("{},{rpm},{},{}\n", x[0], x[2], y + 20.0)
        },
    );
    let scattered = "transmission.cvt.maps.box_points=scattered";
    let setup = car(CVT, &csv, &[BOX, scattered]).unwrap();
    let said = format!(
        "{} scattered points: each differs from the plane through the others by {:.2} N m (root of the mean square), {:.2} N m at most",
        off.len(),
        missed.rms_nm,
        missed.largest_nm
    );
    assert!(
        setup.notes.iter().any(|note| note.contains(&said)),
        "{:?}",
        setup.notes
    );
    // Half of the box without a point, and points on one plane.
    let half = rows.iter().filter(|(x, _)| x[0] < 1.2 || x[1] < 100.0);
    let hole = gridded(&half.copied().collect::<Vec<_>>()).unwrap_err();
    assert!(hole.message.contains("leave a hole"), "{hole:?}");
    let flat: Vec<_> = rows
        .iter()
        .map(|(x, y)| ([x[0], 100.0 * x[0], x[2], 0.0, 0.0], *y))
        .collect();
    assert!(gridded(&flat).is_err());
}

/// The Rover's box on the bench, tabulated by input torque.
fn tabulated(setup: &Setup, torques: &[f64]) -> String {
    let bench = Bench::new(setup);
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a CVT");
    };
    let mut text =
        String::from("ratio,input_speed_rpm,input_torque_nm,oil_temp_degc,torque_loss_nm\n");
    let step = (cvt.ratio.low / cvt.ratio.high).powf(1.0 / 12.0);
    for k in 0..=12 {
        let ratio = match k {
            12 => cvt.ratio.low,
            k => cvt.ratio.high * step.powi(k),
        };
        for speed in [700.0, 1000.0, 1400.0, 1867.0, 2500.0, 4000.0, 6000.0] {
            for &torque in torques {
                for oil in [60.0, 90.0] {
                    let full_load_nm = setup.engine().full_load.at(rad_s(speed));
                    let overall = ratio * cvt.final_drive.ratio;
                    let mut p = BenchPoint {
                        ratio,
                        input_rad_s: rad_s(speed),
                        output_nm: torque * overall,
                        throttle: (torque / full_load_nm).clamp(0.0, 1.0),
                        sump_k: oil + 273.15,
                        ..BenchPoint::default()
                    };
                    for _ in 0..60 {
                        p.output_nm -= (bench.solve(&p).input_nm - torque) * overall;
                    }
                    let loss = bench.solve(&p).total_nm();
                    let _ = writeln!(text, "{ratio},{speed},{torque},{oil},{loss}");
                }
            }
        }
    }
    text
}

/// A box's own steady losses as a map drive to the same fuel from 80 degC, with the loss at rest given: what is left is interpolation, and slip, which
/// the map has as torque. Without it the belt and the final drive of the map turn at rest too.
#[test]
fn a_box_map_of_the_models_drives_like_them() {
    let own = car(CVT, "", &[]).unwrap();
    let reference = driven(&own, Start::At(353.15));
    let torques = [
        -80.0, -40.0, -20.0, 0.0, 10.0, 20.0, 40.0, 60.0, 90.0, 120.0, 150.0,
    ];
    let csv = tabulated(&own, &torques);
    let at_rest = |o: &Outcome| {
        let rows = o.rows.iter().filter(|row| row.speed_m_s <= 0.0);
        let nm = rows.map(|row| {
            row.engine_torque_nm - row.loss_w[Component::LaunchClutch] / row.engine_speed_rad_s
        });
        let nm: Vec<f64> = nm.collect();
        nm.iter().sum::<f64>() / nm.len() as f64
    };
    let nm = at_rest(&reference);
    let known = format!("transmission.cvt.maps.at_rest_loss_nm={nm}");
    let without = driven(&car(CVT, &csv, &[BOX]).unwrap(), Start::At(353.15));
    let more = fuel_difference(&without, &reference);
    println!("{nm:.2} Nm at rest; without it {:+.3} %", 100.0 * more);
    assert!((3e-3..1.5e-2).contains(&more), "{more}");
    let setup = car(CVT, &csv, &[BOX, &known]).unwrap();
    let mapped = driven(&setup, Start::At(353.15));
    assert!((at_rest(&mapped) - nm).abs() < 0.05);
    let off = fuel_difference(&mapped, &reference);
    println!("fuel with the map {:+.3} %", 100.0 * off);
    assert!(off.abs() < 3e-3, "{off}");
    assert!(mapped.totals.ledger_error < 1e-9);
    // Without overrun in the map its edge is held and the rows are flagged.
    let drive_only = car(CVT, &tabulated(&own, &torques[3..]), &[BOX]).unwrap();
    let drive_only = driven(&drive_only, Start::At(353.15));
    let outside = |o: &Outcome| {
        let is_out = |flags: Flags| flags.contains(Flags::OUTSIDE_VALIDITY);
        o.rows.iter().filter(|row| is_out(row.flags)).count()
    };
    let [all, part] = [&mapped, &drive_only].map(outside);
    assert!(all < 60 && part > all + 60, "{all} {part}");
}

/// A manual box map by efficiency, mirrored in overrun, is one of torque by hand.
#[test]
fn a_manual_box_takes_an_efficiency() {
    let share = "gear,input_torque_nm,efficiency_percent\n1,20,90\n1,200,95\n5,20,92\n5,200,97\n";
    let set = [
        "transmission.manual.maps.box=map.csv",
        "transmission.manual.maps.no_load_loss_nm=0.8",
    ];
    let mut torque = String::from("gear,input_torque_nm,torque_loss_nm\n");
    for (gear, part, full) in [(1, 0.9, 0.95), (5, 0.92, 0.97)] {
        let _ = write!(
            torque,
            "{gear},-200,{}\n{gear},-20,{}\n{gear},0,0.8\n{gear},20,{}\n{gear},200,{}\n",
            200.0 * (1.0 / full - 1.0),
            20.0 * (1.0 / part - 1.0),
            20.0 * (1.0 - part),
            200.0 * (1.0 - full)
        );
    }
    let manual = "rover_216_5mt";
    let a = driven(&car(manual, share, &set).unwrap(), Start::Soak);
    let b = driven(&car(manual, &torque, &set[..1]).unwrap(), Start::Soak);
    assert!(fuel_difference(&a, &b).abs() < 1e-12);
    let none = car(manual, share, &set[..1]).unwrap_err();
    assert!(none.contains("no_load_loss_nm"), "{none}");
}

/// The example of the book: a matrix of the Rover's losses at 80 degC drives like the Rover from 80 degC, within 1 %.
#[test]
fn the_box_of_the_docs_drives_like_the_rover() {
    let file = format!(
        "{}/../../docs/own_tables/box.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let load = |word: &str| load(word, &Options::default()).map_err(|p| render(&p, false));
    let own = driven(&load(&file).unwrap(), Start::At(353.15));
    let off = fuel_difference(&own, &driven(&load(CVT).unwrap(), Start::At(353.15)));
    assert!(off.abs() < 1e-2, "{off}");
    assert!(own.totals.ledger_error < 1e-9);
}
