//! Gears of UN GTR 15, Annex 2, against the validation cases that are published with the regulation's reference program (JRCSTU/wltp on GitHub, commit
//! 18650f3, `Notebooks/Matlab/src`; EUPL 1.1, not part of this project). Run by hand:
//!
//! `GTR15_CASES=FOLDER cargo run -p cvtcycle-model-tests --example gtr15_reference`
//!
//! Prints the seconds that differ in each case without downscaling and without a speed cap: 85 cases, 152 329 s. Seconds with an open clutch count as
//! equal, whatever gear is in.
#![allow(clippy::unwrap_used, reason = "a tool ends at the first surprise")]

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;

use cvtcycle_model::cycle::GearCommand;
use cvtcycle_model::cycle::gtr15::{GtrVehicle, MakerLimits, gears};

/// A row of a table by the names of its columns.
type Row = HashMap<String, String>;

fn table(folder: &Path, name: &str) -> Vec<Row> {
    let bytes = std::fs::read(folder.join(name)).unwrap();
    // Latin-1.
    let text: String = bytes.into_iter().map(char::from).collect();
    let cells = |line: &str| -> Vec<String> {
        line.split(',').map(|cell| cell.trim().to_owned()).collect()
    };
    let mut lines = text.lines();
    let names = cells(lines.next().unwrap());
    let rows = lines.filter(|line| line.contains(','));
    rows.map(|line| names.iter().cloned().zip(cells(line)).collect())
        .collect()
}

fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap()
}

/// The values of the rows of each key.
fn by<T>(rows: &[Row], key: &str, value: impl Fn(&Row) -> T) -> HashMap<String, Vec<T>> {
    let mut found: HashMap<String, Vec<T>> = HashMap::new();
    for row in rows {
        found.entry(row[key].clone()).or_default().push(value(row));
    }
    found
}

/// The gear of each second: 0 for none, nothing where the clutch is open.
fn expected(list: &[(usize, String)], seconds: usize) -> Vec<Option<u8>> {
    let ends = list.iter().skip(1).map(|(t, _)| *t).chain([seconds]);
    let mut gears = Vec::new();
    for ((from, word), to) in list.iter().zip(ends) {
        let gear = match word.rsplit('-').next().unwrap() {
            "CLUTCH" => None,
            "NEUTRAL" => Some(0),
            gear => Some(gear.parse().unwrap()),
        };
        gears.extend(std::iter::repeat_n(gear, to - from));
    }
    gears
}

fn vehicle(case: &Row, own: &Row, full_load: &[[f64; 3]], rpm_per_kmh: &[f64]) -> GtrVehicle {
    let of = |name: &str| number(case, name);
    GtrVehicle {
        test_mass_kg: number(own, "m_test"),
        load: ["f0", "f1", "f2"].map(|name| number(own, name)),
        idle_rpm: number(own, "n_idle"),
        full_load: full_load.to_vec(),
        rpm_per_kmh: rpm_per_kmh.to_vec(),
        safety: number(own, "SM"),
        maker: MakerLimits {
            highest_rpm: of("n_lim"),
            least_rpm: ["n_min3", "n_min3a", "n_min3d"].map(of),
            start_rpm: ["n_min3as", "n_min3ds"].map(of),
            start_s: of("t_start"),
        },
    }
}

fn main() {
    let folder = std::env::var("GTR15_CASES").expect("GTR15_CASES is the folder of the tables");
    let read = |name: &str| table(Path::new(&folder), name);
    let vehicles = by(&read("vehicle.txt"), "veh", Row::clone);
    let engines = by(&read("engine.txt"), "veh", |row| {
        ["n", "p", "ASM"].map(|name| number(row, name))
    });
    let boxes = by(&read("gearbox.txt"), "veh", |row| number(row, "ndv"));
    let traces = by(&read("trace.txt"), "class", |row| number(row, "v"));
    let shifts = by(&read("out_shift_condensed.txt"), "case", |row| {
        (number(row, "t") as usize, row["gear_or_clutch"].clone())
    });
    let (mut seconds, mut differ, mut cases) = (0, 0, 0);
    let mut out = std::io::stdout();
    for case in read("case.txt") {
        if number(&case, "do_dsc") > 0.0 || number(&case, "do_cap") > 0.0 {
            continue;
        }
        let (own, trace) = (&case["veh"], &traces[&case["class"]]);
        let car = vehicle(&case, &vehicles[own][0], &engines[own], &boxes[own]);
        let found = gears(trace, &car);
        let commands = found.commands(trace);
        let wanted = expected(&shifts[&case["case"]], trace.len());
        let is_open = |t: usize| {
            matches!(
                commands[t],
                GearCommand::Declutched(_) | GearCommand::Change(_)
            )
        };
        let is_other =
            |t: &usize| wanted[*t].is_some_and(|gear| gear != found.gear[*t]) && !is_open(*t);
        let other: Vec<usize> = (0..trace.len()).filter(is_other).collect();
        if !other.is_empty() {
            writeln!(
                out,
                "case {}: {} s differ: {other:?}",
                case["case"],
                other.len()
            )
            .unwrap();
        }
        (seconds, differ, cases) = (seconds + trace.len(), differ + other.len(), cases + 1);
    }
    writeln!(out, "{cases} cases, {seconds} s, {differ} s differ").unwrap();
}
