//! Trace files and output directories.
#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]
use std::f64::consts::PI;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use cvtcycle::config::{Argument, ProblemKind, Setting};
use cvtcycle::output::file::OutputFile;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::number::{fixed, percent, plain, signed, tiny};
use cvtcycle::output::table::{Cell, Scope};
use cvtcycle::output::trace::write_trace;
use cvtcycle::output::trace::{COLUMNS, column, columns_for, loss_column};
use cvtcycle::output::{ByComponent, Component, Flags, Row};

#[allow(dead_code, reason = "shared with other tests")]
use crate::fixtures::{CVT, MANUAL, phases, rows};

#[test]
fn a_trace_reads_back_to_the_same_numbers() {
    let phases = phases();
    for (cvt, components) in [(true, &CVT[..]), (false, &MANUAL[..])] {
        let rows = rows(300, 0.1, cvt);
        let columns = columns_for(cvt, components);
        let mut bytes = Vec::new();
        write_trace(&mut bytes, &columns, &rows, &phases).unwrap();
        let mut reader = csv::Reader::from_reader(&bytes[..]);
        let names: Vec<_> = columns.iter().map(|c| &*c.name).collect();
        assert_eq!(reader.headers().unwrap(), &names);
        let records: Vec<_> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), rows.len());
        for (record, row) in records.iter().zip(&rows) {
            for (field, column) in record.iter().zip(&columns) {
                match column.cell(row) {
                    Cell::Number(x) if x.is_finite() => assert!(
                        field.parse::<f64>().unwrap().total_cmp(&(x + 0.0)).is_eq(),
                        "{field}"
                    ),
                    Cell::Number(_) => assert_eq!(field, ""),
                    Cell::Count(n) => assert_eq!(field, n.to_string()),
                    Cell::Phase(_) => assert_eq!(field, "ECE 1"),
                    Cell::Flags(f) if f == Flags::default() => assert_eq!(field, ""),
                    Cell::Flags(_) => assert_eq!(field, "overrun|fuel_cut"),
                    Cell::Text(words) => assert_eq!(field, words),
                    Cell::Names(_) => unreachable!(),
                }
            }
        }
    }
}

#[test]
fn columns_are_those_of_the_car_in_the_agreed_order() {
    let names = |cvt, components: &[Component]| {
        columns_for(cvt, components)
            .iter()
            .map(|c| &*c.name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    assert_eq!(
        names(true, &CVT),
        "time_s, dt_s, phase, speed_kmh, accel_m_s2, wheel_torque_nm, wheel_power_w, \
         engine_speed_rpm, engine_torque_nm, throttle, belt_ratio, overall_ratio, \
         primary_pressure_bar, secondary_pressure_bar, clamp_cause, slip_percent, clamp_safety, \
         launch_clutch_loss_w, pump_loss_w, input_shaft_loss_w, clutch_drag_loss_w, \
         seal_ring_loss_w, pulley_bearing_loss_w, belt_band_loss_w, belt_film_loss_w, belt_slip_loss_w, belt_wedge_loss_w, \
         belt_penetration_loss_w, final_drive_loss_w, accessories_w, brake_w, kinetic_w, \
         deficit_w, fuel_g_s, fuel_power_w, engine_heat_w, exhaust_w, coolant_degc, \
         engine_oil_degc, transmission_sump_degc, transmission_metal_degc, belt_spray_degc, \
         cooler_in_degc, cooler_out_degc, tyre_degc, stored_w, to_air_w, power_ledger_error, \
         heat_ledger_error, solve_residual, iterations, flags"
    );
    let manual = names(false, &MANUAL);
    assert!(
        manual.contains("throttle, gear, overall_ratio, launch_clutch_loss_w, gear_mesh_loss_w")
    );
    assert!(!manual.contains("belt") && !manual.contains("pressure") && !manual.contains("pump"));
    let row = Row {
        speed_m_s: 10.0,
        engine_speed_rad_s: 100.0 * PI,
        secondary_pressure_pa: 7e5,
        slip: 0.01,
        fuel_kg_s: 2e-3,
        coolant_k: 363.15,
        ..Row::default()
    };
    let wanted = [
        ("speed_kmh", 36.0),
        ("engine_speed_rpm", 3000.0),
        ("secondary_pressure_bar", 7.0),
        ("slip_percent", 1.0),
        ("fuel_g_s", 2.0),
        ("coolant_degc", 90.0),
    ];
    for (name, value) in wanted {
        assert!(
            (column(name).unwrap().number_of(&row) - value).abs() < 1e-9,
            "{name}"
        );
    }
    let two_ranges = [&CVT[..], &[Component::RangeGear]].concat();
    assert!(names(true, &two_ranges).contains("belt_ratio, range_ratio, overall_ratio"));
    assert_eq!(COLUMNS.len(), 42 + Component::COUNT);
}

fn names_in(dir: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(dir)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

fn text(words: &'static str) -> impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()> {
    move |out| out.write_all(words.as_bytes())
}

#[test]
fn files_appear_together_at_the_end() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("new/run1");
    let mut dir = OutputDir::create(&path, false).unwrap();
    dir.write("summary.json", text("{}")).unwrap();
    dir.write("trace.csv", text("a,b")).unwrap();
    assert!(
        !names_in(&path)
            .iter()
            .any(|name| !name.starts_with(".cvtcycle-"))
    );
    let paths = dir.commit().unwrap();
    assert_eq!(paths, [path.join("summary.json"), path.join("trace.csv")]);
    assert_eq!(names_in(&path), ["summary.json", "trace.csv"]);
    assert_eq!(fs::read_to_string(&paths[1]).unwrap(), "a,b");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let plain = home.path().join("plain");
        fs::write(&plain, "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&paths[0]), mode(&plain));
    }
}

#[test]
fn a_failure_leaves_nothing_behind() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("new/run1");
    let mut dir = OutputDir::create(&path, false).unwrap();
    dir.write("trace.csv", text("a,b")).unwrap();
    let full = dir.write("summary.json", |out| {
        out.write_all(b"half of it")?;
        Err(io::Error::from(io::ErrorKind::StorageFull))
    });
    let problem = full.unwrap_err();
    assert!(
        problem.place.is_argument(Argument::Output) && problem.message.contains("summary.json"),
        "{problem:?}"
    );
    assert!(problem.hint.contains("space"));
    drop(dir);
    assert_eq!(names_in(home.path()), Vec::<String>::new());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_in_the_words_of_the_system() {
    let home = tempfile::tempdir().unwrap();
    let mut dir = OutputDir::create(home.path().join("run"), false).unwrap();
    let full = dir.write("trace.csv", |out| {
        out.write_all(b"some")?;
        fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")?
            .write_all(b"more")
    });
    let problem = full.unwrap_err();
    assert!(!problem.message.contains(".cvtcycle-"), "{problem:?}");
    assert!(
        problem.message.contains("No space left on device"),
        "{problem:?}"
    );
    assert!(problem.message.contains("trace.csv") && problem.hint.contains("free some space"));
    drop(dir);
    assert!(names_in(home.path()).is_empty());
}

#[test]
fn other_peoples_files_are_never_touched() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("thesis.tex"), "x").unwrap();
    for force in [false, true] {
        let problem = OutputDir::create(home.path(), force).unwrap_err();
        assert!(problem.message.contains("thesis.tex") && problem.hint.contains("another name"));
    }
    assert_eq!(names_in(home.path()), ["thesis.tex"]);
    let file = home.path().join("thesis.tex");
    assert!(
        OutputDir::create(&file, true)
            .unwrap_err()
            .message
            .contains("not a directory")
    );
    assert!(OutputDir::create(file.join("deeper"), true).is_err());
    assert!(OutputDir::create("", true).is_err());
    assert_eq!(names_in(home.path()), ["thesis.tex"]);
}

#[test]
fn an_earlier_run_is_replaced_only_when_asked() {
    let home = tempfile::tempdir().unwrap();
    for name in ["summary.json", "trace.csv", "old.svg"] {
        fs::write(home.path().join(name), "old").unwrap();
    }
    let problem = OutputDir::create(home.path(), false).unwrap_err();
    assert!(
        problem.message.contains("old.svg, summary.json, trace.csv"),
        "{problem:?}"
    );
    assert_eq!(problem.settings, [Setting::Replace]);
    assert!(problem.hint.contains("another name"));
    let mut dir = OutputDir::create(home.path(), true).unwrap();
    dir.write("summary.json", text("new")).unwrap();
    dir.write("trace.csv", text("new")).unwrap();
    assert_eq!(dir.left_over(), ["old.svg"]);
    assert_eq!(
        fs::read_to_string(home.path().join("trace.csv")).unwrap(),
        "old"
    );
    dir.commit().unwrap();
    assert_eq!(
        names_in(home.path()),
        ["old.svg", "summary.json", "trace.csv"]
    );
    assert_eq!(
        fs::read_to_string(home.path().join("trace.csv")).unwrap(),
        "new"
    );
}

#[test]
fn a_failing_commit_puts_the_earlier_run_back() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("summary.json"), "old").unwrap();
    fs::write(home.path().join("trace.csv"), "old").unwrap();
    fs::create_dir(home.path().join("plot.svg")).unwrap();
    let mut dir = OutputDir::create(home.path(), true).unwrap();
    for name in ["summary.json", "trace.csv", "fresh.csv", "plot.svg"] {
        dir.write(name, text("new")).unwrap();
    }
    let problem = dir.commit().unwrap_err();
    assert!(problem.message.contains("plot.svg"), "{problem:?}");
    assert_eq!(
        names_in(home.path()),
        ["plot.svg", "summary.json", "trace.csv"]
    );
    for name in ["summary.json", "trace.csv"] {
        assert_eq!(fs::read_to_string(home.path().join(name)).unwrap(), "old");
    }
}

/// The second writer of a directory is refused and removes nothing. After the first has ended, the directory is free.
#[test]
fn one_at_a_time_writes_into_a_directory() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("new/run1");
    let mut first = OutputDir::create(&path, false).unwrap();
    for force in [false, true] {
        let problem = OutputDir::create(&path, force).unwrap_err();
        assert_eq!(problem.kind, ProblemKind::Locked);
        assert!(problem.hint.contains("wait until it has ended"));
    }
    first.write("summary.json", text("{}")).unwrap();
    first.commit().unwrap();
    assert_eq!(names_in(&path), ["summary.json"]);
    drop(OutputDir::create(&path, true).unwrap());
    assert_eq!(names_in(&path), ["summary.json"]);
}

/// The next run removes partial files of a killed process, but not those of a running one, and not links.
#[test]
fn the_next_run_removes_half_written_files() {
    let home = tempfile::tempdir().unwrap();
    let old = home.path().join(".cvtcycle-old.tmp");
    fs::write(&old, "half").unwrap();
    let mut points = OutputFile::create(home.path().join("points.csv"), false).unwrap();
    assert!(!old.exists());
    points.write_all(b"a,b").unwrap();
    fs::write(&old, "half").unwrap();
    let mine = home.path().join("mine");
    fs::write(&mine, "mine").unwrap();
    assert!(OutputDir::create(home.path(), true).is_err());
    assert!(old.exists(), "a directory that is refused is left alone");
    fs::remove_file(&mine).unwrap();
    OutputDir::create(home.path(), false)
        .unwrap()
        .commit()
        .unwrap();
    assert!(!old.exists());
    points.commit().unwrap();
    assert_eq!(names_in(home.path()), ["points.csv"]);
}

/// A file that appears while another one of that name is written is not replaced without --force.
#[test]
fn a_file_that_appeared_meanwhile_is_not_replaced() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("points.csv");
    for (force, text) in [(false, "mine"), (true, "")] {
        let file = OutputFile::create(&path, force).unwrap();
        fs::write(&path, "mine").unwrap();
        assert_eq!(file.commit().is_ok(), force);
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
        fs::remove_file(&path).unwrap();
        assert!(names_in(home.path()).is_empty());
    }
}

#[test]
fn names_that_would_leave_the_directory_or_clash_are_refused() {
    let home = tempfile::tempdir().unwrap();
    let mut dir = OutputDir::create(home.path(), false).unwrap();
    for name in ["", ".", "..", "../x", "a/b", "a\\b", "/etc/x", "c:x", "x/"] {
        assert!(dir.write(name, text("")).is_err(), "{name}");
    }
    dir.write("Car.svg", text("")).unwrap();
    assert!(
        dir.write("car.svg", text(""))
            .unwrap_err()
            .message
            .contains("two files")
    );
}

#[test]
fn every_component_has_its_column_in_the_order_of_the_power_flow() {
    let losses = COLUMNS
        .iter()
        .filter(|c| matches!(c.scope, Scope::Has(_)) && c.name.ends_with("_loss_w"));
    let names: Vec<_> = losses.map(|c| c.name.to_string()).collect();
    let wanted = Component::ALL.map(|c| format!("{}_loss_w", c.name()));
    assert_eq!(names, wanted);
    for component in Component::ALL {
        let mut row = Row::default();
        row.loss_w[component] = 7.5;
        let loss = |c: Component| loss_column(c).map_or(f64::NAN, |column| column.number_of(&row));
        let sum: f64 = Component::ALL.into_iter().map(loss).sum();
        assert!((loss(component) - 7.5).abs() < 1e-15 && (sum - 7.5).abs() < 1e-15);
    }
}

#[test]
fn many_numbers_are_those_of_single_rows() {
    let row = |k: u8| Row {
        time_s: f64::from(k),
        phase: u16::from(k),
        gear: k,
        slip: f64::NAN,
        loss_w: ByComponent([0.5; Component::COUNT]),
        ..Row::default()
    };
    let rows: Vec<Row> = (0..5).map(row).collect();
    for column in COLUMNS.iter() {
        let mut numbers = vec![7.0];
        column.numbers(&rows, &mut numbers);
        let single = rows.iter().map(|row| column.number_of(row).to_bits());
        let wanted: Vec<u64> = [7.0_f64.to_bits()].into_iter().chain(single).collect();
        let found: Vec<u64> = numbers.iter().map(|x| x.to_bits()).collect();
        assert_eq!(found, wanted, "{}", column.name);
    }
}

#[test]
fn names_are_unique_and_end_in_their_unit() {
    for (i, column) in COLUMNS.iter().enumerate() {
        assert!(COLUMNS[..i].iter().all(|other| other.name != column.name));
        let suffix = match column.unit {
            "" | "-" => continue,
            "km/h" => "_kmh",
            "m/s2" => "_m_s2",
            "g/s" => "_g_s",
            "%" => "_percent",
            "degC" => "_degc",
            "Nm" => "_nm",
            "W" => "_w",
            unit => &format!("_{unit}"),
        };
        assert!(column.name.ends_with(suffix), "{}", column.name);
    }
}

#[test]
fn numbers_are_formatted_for_display() {
    assert_eq!(fixed(-0.04, 1), "0.0");
    assert_eq!(fixed(-10.04, 1), "-10.0");
    assert_eq!(fixed(f64::NAN, 1), "-");
    assert_eq!(fixed(999_999_999_999_999.0, 0), "999999999999999");
    assert_eq!(fixed(-1e15, 0), "-1.00e15");
    assert_eq!(fixed(f64::MAX, 3), "1.80e308");
    assert_eq!(fixed(None, 1), "-");
    assert_eq!(signed(5.26, 1), "+5.3");
    assert_eq!(signed(0.01, 1), "0.0");
    assert_eq!(signed(-14.0, 1), "-14.0");
    assert_eq!(percent(1.0, 4.0, 0), "25");
    assert_eq!(tiny(Some(3.2e-15)), "3e-15");
    assert_eq!(plain(-0.0), "0");
    assert_eq!(plain(0.25), "0.25");
}
