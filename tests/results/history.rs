//! Traces read back: equal numbers, and all problems of a bad file.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::fs;

use cvtcycle::config::Problems;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::output::table::Cell;
use cvtcycle::output::trace::write_trace;
use cvtcycle::output::trace::{COLUMNS, columns_for};
use cvtcycle::output::{Component, Flags, History, Row};
use cvtcycle::study::store::{read_trace_parquet, write_trace_parquet};

use crate::common;
use crate::common::{CARS, car, cycle, soak_rows};

/// Bits of a history: names and numbers of its columns, phases, flags.
#[derive(Debug, PartialEq)]
struct Bits {
    columns: Vec<(&'static str, Vec<u64>)>,
    phases: Vec<String>,
    steps: Vec<(usize, Flags)>,
}

fn bits(history: &History) -> Bits {
    let numbers = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect();
    Bits {
        columns: history
            .columns()
            .map(|(column, of)| (&*column.name, numbers(of)))
            .collect(),
        phases: history.phases().to_vec(),
        steps: (0..history.len())
            .map(|i| (history.phase(i), history.flags(i)))
            .collect(),
    }
}

fn csv(rows: &[Row], cvt: bool, parts: &[Component], phases: &[String]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_trace(&mut bytes, &columns_for(cvt, parts), rows, phases).unwrap();
    bytes
}

/// Drives a shipped car on a cycle: its rows, whether it has a belt, its components.
fn driven(name: &str, cycle: &Cycle) -> (Vec<Row>, bool, Vec<Component>) {
    let setup = car(name, &[]);
    let rows = soak_rows(&setup, cycle, 20.0).rows;
    (
        rows,
        setup.transmission().is_cvt(),
        setup.transmission().components(),
    )
}

#[test]
fn a_trace_reads_back_bit_by_bit() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("trace.parquet");
    for name in CARS {
        for cycle in [cycle("ece15_eudc"), cycle("ftp75"), common::hill()] {
            let (rows, cvt, parts) = driven(name, &cycle);
            let odd = ["a \"quoted\", odd name".to_owned()];
            let phases = if cycle.phases.is_empty() {
                &odd[..]
            } else {
                &cycle.phases
            };
            let columns = columns_for(cvt, &parts);
            let history = History::from_rows(&rows, &columns, phases);
            assert_eq!(
                (history.len(), history.is_cvt(), history.components()),
                (rows.len(), cvt, parts.clone())
            );
            let read = History::read_csv("trace.csv", &csv(&rows, cvt, &parts, phases)).unwrap();
            assert_eq!(bits(&read), bits(&history), "{name}");
            write_trace_parquet(
                fs::File::create(&path).unwrap(),
                &columns,
                &rows,
                phases,
                "",
            )
            .unwrap();
            assert_eq!(
                bits(&read_trace_parquet(&path).unwrap()),
                bits(&history),
                "{name}"
            );
            // Truth: the rows themselves.
            for (i, row) in rows.iter().enumerate() {
                assert_eq!(
                    history.phases()[history.phase(i)],
                    phases[usize::from(row.phase)]
                );
                assert_eq!(history.flags(i), row.flags);
                for column in &columns {
                    match column.cell(row) {
                        Cell::Number(x) if x.is_finite() => assert_eq!(
                            history.column(&column.name)[i].to_bits(),
                            (x + 0.0).to_bits()
                        ),
                        Cell::Number(_) => assert!(history.column(&column.name)[i].is_nan()),
                        Cell::Count(n) => assert_eq!(
                            history.column(&column.name)[i].to_bits(),
                            (n as f64).to_bits()
                        ),
                        _ => assert!(
                            !history.has(&column.name) && history.column(&column.name).is_empty()
                        ),
                    }
                }
            }
        }
    }
}

/// Short trace as lines of text.
fn lines() -> Vec<String> {
    let cycle = cycle("ece15");
    let (rows, cvt, parts) = driven("rover_216_cvt", &cycle);
    let text = String::from_utf8(csv(&rows[..30], cvt, &parts, &cycle.phases)).unwrap();
    text.lines().map(str::to_owned).collect()
}

fn problems(lines: &[String]) -> Problems {
    History::read_csv("trace_x.csv", lines.join("\n").as_bytes())
        .map(|_| ())
        .unwrap_err()
}

/// Replaces the cell of a column in a line, counted from 1.
fn replace(lines: &mut [String], line: usize, column: &str, cell: &str) {
    let at = lines[0].split(',').position(|name| name == column).unwrap();
    let mut cells: Vec<&str> = lines[line - 1].split(',').collect();
    cells[at] = cell;
    let text = cells.join(",");
    lines[line - 1] = text;
}

#[test]
fn everything_that_is_wrong_is_reported_at_once_with_its_place() {
    let mut bad = lines();
    replace(&mut bad, 1, "throttle", "thrott1e");
    replace(&mut bad, 3, "speed_kmh", "12;5");
    replace(&mut bad, 4, "flags", "overrun|flying");
    replace(&mut bad, 6, "time_s", "1");
    replace(&mut bad, 8, "dt_s", "0");
    replace(&mut bad, 9, "coolant_degc", "1e999");
    replace(&mut bad, 10, "time_s", "");
    bad[11].push_str(",7");
    let found = problems(&bad);
    let places: Vec<_> = found
        .iter()
        .map(|p| {
            (
                p.place.file_name().unwrap_or_default(),
                p.place.line,
                p.key.as_str(),
                p.value.as_str(),
            )
        })
        .collect();
    let file = "trace_x.csv";
    assert_eq!(
        places,
        [
            (file, 1, "throttle", ""),
            (file, 3, "speed_kmh", "12;5"),
            (file, 4, "flags", "overrun|flying"),
            (file, 6, "time_s", "1"),
            (file, 8, "dt_s", "0"),
            (file, 9, "coolant_degc", "1e999"),
            (file, 10, "time_s", ""),
            (file, 12, "", ""),
        ]
    );
    assert!(
        found
            .iter()
            .all(|p| !p.message.is_empty() && p.place.column > 0)
    );
    assert!(
        found[2].message.contains("`flying`")
            && found[2].hint.contains("fuel_cut")
            && found[3].allowed.contains("above 4")
    );
    // The column counts characters, so that it points to the bad value.
    assert_eq!(
        bad[2]
            .chars()
            .skip(found[1].place.column - 1)
            .take(4)
            .collect::<String>(),
        "12;5"
    );
}

#[test]
fn the_list_of_problems_is_bounded() {
    let mut bad = lines();
    for line in 2..=31 {
        for column in ["speed_kmh", "throttle", "fuel_g_s"] {
            replace(&mut bad, line, column, "x");
        }
    }
    let found = problems(&bad);
    assert_eq!(found.len(), 51);
    assert_eq!(found[50].message, "40 more problems are not shown");
}

#[test]
fn every_column_that_a_trace_must_have_is_missed() {
    let good = lines();
    let names: Vec<&str> = good[0].split(',').collect();
    for (k, name) in names.iter().enumerate() {
        let less = good.iter().map(|line| {
            let mut cells: Vec<&str> = line.split(',').collect();
            cells.remove(k);
            cells.join(",")
        });
        let text = less.collect::<Vec<_>>().join("\n");
        // A car may lack any one component.
        match History::read_csv("t.csv", text.as_bytes()) {
            Ok(history) => assert!(name.ends_with("_loss_w") && !history.has(name), "{name}"),
            Err(found) => assert!(
                found.len() == 1 && found[0].key == *name && found[0].message.contains("missing"),
                "{name}: {found:?}"
            ),
        }
    }
    let twice: Vec<String> = good
        .iter()
        .map(|line| format!("{line},{}", line.split(',').next().unwrap()))
        .collect();
    assert_eq!(
        (
            problems(&twice)[0].message.as_str(),
            problems(&twice)[0].key.as_str()
        ),
        ("duplicate column", "time_s")
    );
}

#[test]
fn columns_of_a_newer_version_are_ignored() {
    let good = lines();
    let more: Vec<String> = good
        .iter()
        .enumerate()
        .map(|(i, line)| format!("{line},{}", if i == 0 { "mood" } else { "fine" }))
        .collect();
    let read =
        |lines: &[String]| History::read_csv("t.csv", lines.join("\r\n").as_bytes()).unwrap();
    assert_eq!(bits(&read(&more)), bits(&read(&good)));
}

#[test]
fn a_file_without_a_trace_is_refused_in_one_line() {
    for (bytes, word) in [
        (&b""[..], "empty"),
        (b"PK\x03\x04\0\0", "not text"),
        (b"a,b\n1,2\n", "no trace of cvtcycle"),
        (b"time_s,\"dt_s\n1,2\n", "not closed"),
    ] {
        let found = History::read_csv("t.csv", bytes).map(|_| ()).unwrap_err();
        assert!(
            found.len() == 1 && found[0].message.contains(word),
            "{found:?}"
        );
    }
    let found = problems(&lines()[..1]);
    assert!(
        found.len() == 1 && found[0].message.contains("no rows"),
        "{found:?}"
    );
}

#[test]
fn a_bad_parquet_trace_is_reported_too() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("trace.parquet");
    let read_problems = || read_trace_parquet(&path).map(|_| ()).unwrap_err();
    assert!(
        read_problems()[0].message.contains("cannot read"),
        "{:?}",
        read_problems()
    );
    fs::write(&path, "time_s,dt_s").unwrap();
    assert_eq!(read_problems().len(), 1);
    let columns = columns_for(true, &[]);
    let write = |columns: &[_], rows: &[Row]| {
        write_trace_parquet(fs::File::create(&path).unwrap(), columns, rows, &[], "").unwrap()
    };
    write(&columns, &[]);
    assert!(
        read_problems()[0].message.contains("no rows"),
        "{:?}",
        read_problems()
    );
    let step = |time_s: f64, dt_s: f64| Row {
        time_s,
        dt_s,
        ..Row::default()
    };
    write(&columns, &[step(1.0, 1.0), step(3.0, 1.0), step(2.0, -1.0)]);
    let keys: Vec<String> = read_problems()
        .into_iter()
        .map(|p| format!("{} {}", p.key, p.message))
        .collect();
    assert_eq!(
        keys,
        [
            "time_s the time does not rise in row 3",
            "dt_s the length of the step is not positive in row 3"
        ]
    );
    let few: Vec<_> = COLUMNS
        .iter()
        .filter(|column| column.name == "time_s")
        .collect();
    write(&few, &[step(1.0, 1.0)]);
    assert!(
        read_problems().len() > 20
            && read_problems()
                .iter()
                .all(|p| p.message.contains("missing"))
    );
    write(&columns, &[step(1.0, 1.0), step(2.0, 1.0)]);
    assert_eq!(read_trace_parquet(&path).unwrap().time_s(), [1.0, 2.0]);
}
