//! `losses --input-torque` and maps of a whole box in the forms of other programs, compared with the bench.
#![allow(clippy::unwrap_used, reason = "tests")]

use crate::common::{RPM, ZERO, car};
use cvtcycle::model::rig::{Bench, BenchPoint};
use serde_json::Value;

fn good(words: &[&str]) -> String {
    crate::printed(&["losses"], words)
}

fn refused(words: &[&str]) -> String {
    let output = crate::run(&["losses"], words);
    assert_eq!(output.status.code(), Some(2), "{words:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// Numbers of a line.
fn numbers(line: &str) -> Vec<f64> {
    let words = line.split([',', ' ']).filter(|word| !word.is_empty());
    words.map(|word| word.parse().unwrap()).collect()
}

fn close(a: f64, b: f64, near: f64) {
    assert!((a - b).abs() <= near, "{a} {b}");
}

/// A point by input torque equals the point with the resulting output torque.
#[test]
fn a_point_by_input_torque() {
    let words = ["--ratio", "0.8", "--temp", "60", "--json"];
    let by_input = good(&[&words[..], &["--input-torque", "70"]].concat());
    let by_input: Value = serde_json::from_str(&by_input).unwrap();
    let there = &by_input["points"][0];
    close(there["input_torque_nm"].as_f64().unwrap(), 70.0, 1e-9);
    let (torque, throttle) = (&there["output_torque_nm"], &there["throttle"]);
    let (torque, throttle) = (torque.to_string(), throttle.to_string());
    let by_output = good(
        &[
            &words[..],
            &["--torque", torque.as_str(), "--throttle", &throttle],
        ]
        .concat(),
    );
    let by_output: Value = serde_json::from_str(&by_output).unwrap();
    for column in ["input_torque_nm", "total_loss_nm", "secondary_pressure_bar"] {
        let back = by_output["points"][0][column].as_f64().unwrap();
        close(back, there[column].as_f64().unwrap(), 1e-9 * back);
    }
}

/// VECTO: three columns, every point of the grid, the bench's losses at the input torque, including overrun.
#[test]
fn a_loss_map_of_vecto() {
    let text = good(&[
        "--ratio",
        "1",
        "--speed",
        "1000,3000",
        "--torque",
        "-20,0,80",
        "--temp",
        "80",
        "--as-map",
        "box",
        "--map-form",
        "vtlm",
    ]);
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("Input Speed [rpm],Input Torque [Nm],Torque Loss [Nm]")
    );
    let bench = Bench::new(&car("rover_216_cvt", &[]));
    let mut count = 0;
    for line in lines {
        let row = numbers(line);
        let point = BenchPoint {
            ratio: 1.0,
            input_rad_s: row[0] * RPM,
            sump_k: 80.0 + ZERO,
            ..BenchPoint::default()
        };
        let answer = bench.solve(&bench.at_input_torque(&point, row[1]));
        close(answer.input_nm, row[1], 1e-9);
        close(answer.total_nm(), row[2], 1e-4);
        assert!(row[2] > 0.0);
        count += 1;
    }
    assert_eq!(count, 6);
}

/// 40 CFR 1037.565(d): five speeds from 600 rpm, the middle ones at multiples of 50 rpm, and two torques for each gear; (f): power loss is input
/// less output, and without load the input is the loss.
#[test]
fn the_table_of_the_cfr() {
    let text = good(&[
        "--vehicle",
        "rover_216_5mt",
        "--as-map",
        "box",
        "--map-form",
        "gem",
    ]);
    let mut lines = text.lines();
    let head = lines.next().unwrap();
    assert_eq!(
        head,
        "Gear,Input speed [r/min],Input torque [N.m],Power loss [kW]"
    );
    let rows: Vec<Vec<f64>> = lines.map(numbers).collect();
    assert_eq!(rows.len(), 5 * 5 * 2);
    let car = car("rover_216_5mt", &[]);
    let bench = Bench::new(&car);
    for row in &rows {
        let &[gear, speed, torque, loss_kw] = row.as_slice() else {
            panic!("{row:?}");
        };
        let ends = [600.0, car.engine().highest_rad_s / RPM];
        let is_end = ends.iter().any(|end| (end - speed).abs() < 0.06);
        assert!(is_end || (speed / 50.0).fract().abs() < 1e-9, "{speed}");
        let output_nm = if torque < 10.0 {
            0.0
        } else {
            let point = BenchPoint {
                ratio: gear,
                input_rad_s: speed * RPM,
                sump_k: 80.0 + ZERO,
                ..BenchPoint::default()
            };
            bench.at_input_torque(&point, torque).output_nm
        };
        let answer = bench.solve(&BenchPoint {
            ratio: gear,
            input_rad_s: speed * RPM,
            output_nm,
            sump_k: 80.0 + ZERO,
            ..BenchPoint::default()
        });
        let input_w = torque * speed * RPM;
        let output_w = output_nm * answer.output_rad_s;
        // Torque is written with two digits, speed with one.
        close(
            (input_w - output_w) / 1e3,
            loss_kw,
            0.006 * speed * RPM / 1e3 + 1e-4,
        );
    }
}

/// Modelica: `#1`, tables with their declared sizes, ascending axes, the viscosity of the oil.
#[test]
fn tables_of_modelica() {
    let text = good(&[
        "--ratio",
        "0.5,2",
        "--speed",
        "3000,1000",
        "--torque",
        "0,60",
        "--temp",
        "20,80,50",
        "--as-map",
        "box",
        "--map-form",
        "modelica",
    ]);
    let lines: Vec<&str> = text
        .lines()
        .filter(|line| !line.starts_with("# "))
        .collect();
    assert_eq!(lines[0], "#1");
    assert_eq!(lines.len(), 1 + 4 * 4);
    let car = car("rover_216_cvt", &[]);
    let bench = Bench::new(&car);
    for (table, (name, ratio, torque)) in lines[1..].chunks(4).zip([
        ("loss_1_1", 0.5, 0.0),
        ("loss_1_2", 0.5, 60.0),
        ("loss_2_1", 2.0, 0.0),
        ("loss_2_2", 2.0, 60.0),
    ]) {
        assert_eq!(table[0], format!("double {name}(3,4)"));
        let viscosity = numbers(table[1]);
        for (place, degc) in [80.0, 50.0, 20.0].into_iter().enumerate() {
            let nu = car.oils().0.kinematic_m2_s(degc + ZERO);
            close(viscosity[place + 1], nu, 1e-12);
            for (row, rpm) in [1000.0, 3000.0].into_iter().enumerate() {
                let row = numbers(table[row + 2]);
                close(row[0], rpm * RPM, 1e-9);
                let point = BenchPoint {
                    ratio,
                    input_rad_s: rpm * RPM,
                    sump_k: degc + ZERO,
                    ..BenchPoint::default()
                };
                let answer = bench.solve(&bench.at_input_torque(&point, torque));
                close(row[place + 1], answer.total_nm(), 1e-9);
            }
        }
        assert!(viscosity.windows(2).all(|pair| pair[0] < pair[1]));
    }
}

/// Conflicting options are reported with advice.
#[test]
fn conflicting_options_are_reported() {
    for (words, says) in [
        (vec!["--map-form", "vtlm"], "add --as-map box"),
        (
            vec!["--as-map", "pump", "--map-form", "gem"],
            "add --as-map box",
        ),
        (
            vec!["--as-map", "box", "--map-form", "vtml"],
            "did you mean `vtlm`",
        ),
        (
            vec!["--as-map", "box", "--map-form", "vtlm", "--temp", "20,80"],
            "--temp",
        ),
        (
            vec!["--as-map", "box", "--input-torque", "20"],
            "use --torque",
        ),
        (
            vec!["--input-torque", "20", "--throttle", "0.5"],
            "over full load",
        ),
        (vec!["--input-torque", "NaN"], "`NaN` is not a number"),
    ] {
        let text = refused(&words);
        assert!(text.contains(says), "{words:?}: {text}");
    }
}
