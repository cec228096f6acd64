//! The table of foreign files in the book: how each is read.
//!
//! Truth of each: the same drive as a plain table, made here from the file or from `clean.csv`; or what is wrong with it.

use super::log::{fuel, path, run_of, summary_of};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;

/// One car, from a soak, whatever temperatures a log begins with.
const ALONE: [&str; 4] = ["--baseline", "none", "--start", "soak"];

/// Truth of a file.
enum Right {
    /// The fuel of this plain table, L/100 km, within so much.
    Table(String, f64),
    /// It is read; no truth of the fuel is known.
    Read,
    /// It is no drive that can be repaired: refused with these words.
    Refused(&'static str),
    /// A doubt with these words.
    Doubt(&'static str),
}

use Right::{Doubt, Read, Refused, Table};

fn clean() -> String {
    fs::read_to_string(path("clean.csv")).unwrap()
}

/// The clean drive with another column, the same in all rows.
fn with(column: &str, value: f64) -> String {
    let text = clean();
    let rows = text.lines().skip(1).map(|row| format!("{row},{value}\n"));
    format!("time_s,speed_kmh,{column}\n{}", rows.collect::<String>())
}

/// Rows of a file of which a column has a value, as a plain table.
fn rows(file: &str, (column, word): (&str, &str), [time, speed]: [&str; 2], factor: f64) -> String {
    let text = fs::read_to_string(path(file)).unwrap();
    let separator = if text.lines().next().unwrap().contains(';') {
        b';'
    } else {
        b','
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .flexible(true)
        .from_reader(text.as_bytes());
    let heads = reader.headers().unwrap().clone();
    let at = |name: &str| {
        heads
            .iter()
            .position(|head| head == name)
            .unwrap_or_else(|| panic!("{name} in {heads:?}"))
    };
    let [of, time, speed] = [at(column), at(time), at(speed)];
    let mut plain = "time_s,speed_kmh\n".to_owned();
    for row in reader
        .records()
        .map(Result::unwrap)
        .filter(|row| &row[of] == word)
    {
        let speed: f64 = row[speed].parse().unwrap();
        let _ = writeln!(plain, "{},{}", &row[time], factor * speed);
    }
    plain
}

/// The first rows of the clean drive.
fn first(count: usize) -> String {
    clean()
        .lines()
        .take(count + 1)
        .map(|line| format!("{line}\n"))
        .collect()
}

/// The clean drive with the engine off where a file says that it is not on.
fn engine_off() -> String {
    let text = fs::read_to_string(path("k14_engine_on.csv")).unwrap();
    let rows = text.lines().skip(1).map(|row| {
        let (before, on) = row.rsplit_once(',').unwrap();
        format!("{before},{}\n", 1 - on.trim().parse::<i32>().unwrap())
    });
    format!("time_s,speed_kmh,engine_off\n{}", rows.collect::<String>())
}

/// Files, the fault of each, and what is right.
fn cases() -> Vec<(&'static str, &'static str, Right)> {
    let udds = fs::read_to_string(path("k09_udds_1hz_truth.csv")).unwrap();
    let spike = fs::read_to_string(path("k10_gps_spike.csv")).unwrap();
    let plain = || Table(clean(), 1e-6);
    let degrees = 100.0 * 0.2_f64.to_radians().tan();
    vec![
        ("k01_hms.csv", "clock times", plain()),
        (
            "k01_torque_clock.csv",
            "dates and times",
            Table(first(169), 0.1),
        ),
        ("k02_ved_ms.csv", "milliseconds", plain()),
        (
            "k03_ms_named_s.csv",
            "milliseconds that a name calls seconds",
            plain(),
        ),
        (
            "k04_carobd_4hz_whole_seconds.csv",
            "4 Hz with whole seconds, no units",
            Read,
        ),
        ("k04_doubled_at_bag.csv", "a doubled stamp", plain()),
        ("k05_repeated_header.csv", "names again", plain()),
        ("k05_co2mpas_two_names.csv", "two lines of names", plain()),
        ("k05_preamble.csv", "a preamble", plain()),
        ("k06_dash.csv", "cells with a dash", Table(clean(), 2e-3)),
        (
            "k06_nan_other_raster.csv",
            "cells of another raster",
            plain(),
        ),
        (
            "k07_negative_at_rest.csv",
            "small negative speeds",
            Table(clean(), 0.02),
        ),
        (
            "k08_gap_at_speed.csv",
            "a gap at speed",
            Refused("1 gap while the car moves, 272.0 s"),
        ),
        (
            "k09_udds_10hz_whole_kmh.csv",
            "whole km/h at 10 Hz",
            Table(udds, 0.0856),
        ),
        ("k09_can_89hz.csv", "89 Hz of a CAN bus", Read),
        (
            "k10_gps_spike.csv",
            "one impossible sample",
            Table(spike.replace(",85\n", ",50\n"), 1e-6),
        ),
        (
            "k10_sumo_teleport.csv",
            "a jump to rest",
            Refused("the speed jumps: -195.2 m/s2"),
        ),
        (
            "k11_long.csv",
            "names and values",
            Table(
                rows(
                    "k11_long.csv",
                    ("PID", "Vehicle speed"),
                    ["SECONDS", "VALUE"],
                    1.0,
                ),
                1e-6,
            ),
        ),
        ("k12_sumo_two_cars.csv", "two cars at a time", plain()),
        (
            "k12_sumo_one_after_other.csv",
            "two cars one after the other",
            Table(
                rows(
                    "k12_sumo_one_after_other.csv",
                    ("vehicle_id", "car_b"),
                    ["timestep_time", "vehicle_speed"],
                    3.6,
                ),
                1e-6,
            ),
        ),
        (
            "k13_slope_degrees.csv",
            "slopes in degrees",
            Table(with("grade_percent", degrees), 1e-3),
        ),
        (
            "k13_slope_percent_no_unit.csv",
            "slopes without a unit",
            Table(with("grade_percent", 0.2), 1e-3),
        ),
        (
            "k14_engine_on.csv",
            "engine on, not off",
            Table(engine_off(), 1e-6),
        ),
        (
            "k15_units_behind.vdri",
            "VECTO's own file",
            Table(with("grade_percent", 0.5), 1e-3),
        ),
        (
            "k18_udds_mph_named_kmh.csv",
            "a cycle in the wrong unit",
            Doubt("this is udds times 0.6214"),
        ),
        (
            "k19_full_throttle.csv",
            "full throttle as a cycle",
            Refused("the speed jumps"),
        ),
        ("k20_idle.csv", "a drive without way", Read),
        ("k21_latin1.csv", "Latin-1", plain()),
        ("k22_spaces.txt", "columns of blanks, no names", plain()),
        ("k23_kph.csv", "a name that is a unit", plain()),
    ]
}

/// How a file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Way {
    AsItIs,
    Proposed,
    Doubted,
    Refused,
    Wrong,
}

impl Way {
    fn words(self) -> &'static str {
        match self {
            Way::AsItIs => "as it is",
            Way::Proposed => "with the proposed line",
            Way::Doubted => "doubted in the first line",
            Way::Refused => "refused with its row and a remedy",
            Way::Wrong => "WRONG",
        }
    }
}

/// True if a summary is right.
fn is_right(summary: &Value, right: &Right, dir: &std::path::Path) -> bool {
    match right {
        Table(text, within) => {
            let file = dir.join("truth.csv");
            fs::write(&file, text).unwrap();
            let truth = fuel(&summary_of(file.to_str().unwrap(), &ALONE));
            (fuel(summary) - truth).abs() <= *within
        }
        Read => true,
        Doubt(words) => summary["recording"]["doubts"].to_string().contains(words),
        Refused(_) => false,
    }
}

fn way(file: &str, right: &Right, dir: &std::path::Path) -> Way {
    let output = run_of(&path(file), &ALONE);
    let text = String::from_utf8(output.stderr).unwrap();
    if output.status.code() != Some(2) {
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        let good = match right {
            Doubt(_) => Way::Doubted,
            _ => Way::AsItIs,
        };
        return if is_right(&summary, right, dir) {
            good
        } else {
            Way::Wrong
        };
    }
    if let Refused(words) = right {
        return if text.contains(words) {
            Way::Refused
        } else {
            Way::Wrong
        };
    }
    let line = text
        .lines()
        .find(|line| line.starts_with("try: cvtcycle run "));
    let Some((_, columns)) = line.and_then(|line| line.split_once("--columns ")) else {
        return Way::Wrong;
    };
    let columns = columns.trim_matches(['"', '\'']);
    let summary = summary_of(&path(file), &[&ALONE[..], &["--columns", columns]].concat());
    if is_right(&summary, right, dir) {
        Way::Proposed
    } else {
        Way::Wrong
    }
}

/// Lines between the marks of the book, which `CVTCYCLE_BLESS=1` renews.
const MARKS: [&str; 2] = [
    "<!-- foreign files -->\n",
    "<!-- end of foreign files -->\n",
];

#[test]
fn the_table_of_foreign_files_in_the_book_is_as_they_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let mut table = "| file | form | read |\n|---|---|---|\n".to_owned();
    let mut counts = std::collections::BTreeMap::new();
    let all = cases();
    for (file, form, right) in &all {
        let way = way(file, right, dir.path());
        assert_ne!(way, Way::Wrong, "{file}");
        *counts.entry(way).or_insert(0) += 1;
        let _ = writeln!(table, "| `{file}` | {form} | {} |", way.words());
    }
    let count = |way: Way| counts.get(&way).copied().unwrap_or(0);
    let sum = format!(
        "Of {} files {} are read as they are, {} with the proposed line; {} are refused with the row and a remedy, {} is doubted in the first line, {} are silently wrong.\n\n",
        all.len(),
        count(Way::AsItIs),
        count(Way::Proposed),
        count(Way::Refused),
        count(Way::Doubted),
        count(Way::Wrong)
    );
    // Every log of the folder is in the table, but for the clean drives.
    let names = fs::read_dir(path(""))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    for name in names.filter(|name| name.starts_with('k') && name != "k09_udds_1hz_truth.csv") {
        assert!(
            all.iter().any(|(file, ..)| *file == name),
            "{name} is not in the table"
        );
    }
    let page = format!("{}/docs/book/src/logs.md", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(&page).unwrap();
    let (before, rest) = text.split_once(MARKS[0]).unwrap();
    let (own, after) = rest.split_once(MARKS[1]).unwrap();
    let new = format!("\n{sum}{table}\n");
    if std::env::var_os("CVTCYCLE_BLESS").is_some() {
        fs::write(&page, [before, MARKS[0], &new, MARKS[1], after].concat()).unwrap();
        return;
    }
    assert_eq!(own, new, "CVTCYCLE_BLESS=1 renews the page");
}
