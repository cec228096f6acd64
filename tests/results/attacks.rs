//! Hostile inputs again (docs/attacks.md): those without another test, and a check that the tests named on the page exist.
//!
//! Truth: a number out of range is refused, otherwise the car is driven. A drive has closed energy balances and finite numbers, or fails a check.

use std::path::Path;

use cvtcycle::config::cycle::{Cycle, constant_speed, read_csv};
use cvtcycle::config::setup::{Options, Setup, embedded_vehicles, load};
use cvtcycle::config::{Override, ProblemKind};
use cvtcycle::model::drive::{Conditions, Start, drive};
use cvtcycle::output::summary::{Driven, RunSummary, Settings, run_summary};

use crate::common::range::range;

const PAGE: &str = include_str!("../../docs/attacks.md");

/// Appends the text of every Rust source below a folder.
fn read_code(folder: &Path, code: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            read_code(&path, code);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            code.push_str(&std::fs::read_to_string(path).unwrap());
        }
    }
}

fn driven(setup: &Setup, cycle: &Cycle, max_dt_s: f64) -> RunSummary {
    let conditions = Conditions {
        ambient_k: 268.15,
        start: Start::Soak,
        max_dt_s,
        keep_rows: false,
    };
    let outcome = drive(setup, cycle, &conditions);
    let name = "car";
    let driven = Driven {
        name,
        setup,
        outcome: &outcome,
    };
    run_summary(cycle, "subject", &Settings::default(), &driven)
}

/// Checks a run: closed balances and finite energies, or a failed check.
fn is_sound(run: &RunSummary) -> bool {
    let ledgers = [run.ledger_error, run.run_ledger_error];
    let closed = ledgers
        .iter()
        .all(|error| error.is_some_and(|error| error < 1e-9));
    let finite = run.fuel_energy_kj.is_finite() && run.wheel_work_positive_kj.is_finite();
    !run.failed_checks.is_empty() || (closed && finite)
}

fn car(name: &str, set: Vec<Override>) -> Result<Setup, Vec<ProblemKind>> {
    let options = Options {
        set,
        ..Options::default()
    };
    load(name, &options).map_err(|problems| problems.iter().map(|p| p.kind).collect())
}

/// Numbers just outside an allowed range.
fn beyond(allowed: &str) -> Option<[f64; 2]> {
    let words: Vec<&str> = allowed.split(' ').collect();
    let number = |at: usize| words.get(at).and_then(|word| word.parse::<f64>().ok());
    let out = |x: f64, way: f64| x + way * x.abs().max(1e-3) * 1e-6;
    Some(match words.as_slice() {
        ["integer", "from", ..] => [number(2)? - 1.0, number(4)? + 1.0],
        ["above", ..] => [number(1)?, out(number(4)?, 1.0)],
        [_, "to", ..] => [out(number(0)?, -1.0), out(number(2)?, 1.0)],
        _ => return None,
    })
}

#[test]
fn numbers_at_the_ends_of_their_ranges_are_driven_and_those_beyond_refused() {
    let text = "time_s,speed_kmh\n0,0\n3,0\n15,50\n25,50\n35,0\n40,0\n";
    let cycle = read_csv("town.csv", text.as_bytes()).unwrap();
    let (mut ends, mut runs) = (0, 0);
    for (name, _) in embedded_vehicles() {
        let shipped = car(name, Vec::new()).unwrap();
        for info in shipped.keys.iter().filter(|info| info.is_number) {
            let Some((low, high)) = range(&info.allowed) else {
                continue;
            };
            for end in [low, high] {
                ends += 1;
                // Two numbers that are valid alone may be invalid together.
                if let Ok(setup) = car(name, vec![Override::number(&info.key, end)]) {
                    runs += 1;
                    let run = driven(&setup, &cycle, 1.0);
                    assert!(is_sound(&run), "{name}, {} = {end}: {run:?}", info.key);
                }
            }
            for outside in beyond(&info.allowed).unwrap() {
                let kinds = car(name, vec![Override::number(&info.key, outside)]).unwrap_err();
                let refused = kinds.contains(&ProblemKind::OutOfRange);
                assert!(refused, "{name}, {} = {outside}: {kinds:?}", info.key);
            }
        }
    }
    assert!(ends > 700 && runs > 600, "{runs} of {ends}");
}

/// Cycles with unusual times and speeds are refused at a row, or driven.
#[test]
fn cycles_made_by_hand_are_driven_or_refused() {
    let setup = car("rover_216_5mt", Vec::new()).unwrap();
    let rows = |step_s: f64, speeds: &[f64]| {
        let row = |(k, v): (usize, &f64)| format!("{:e},{v:e}\n", k as f64 * step_s);
        let rows: String = speeds.iter().enumerate().map(row).collect();
        format!("time_s,speed_kmh\n{rows}")
    };
    let saw: Vec<f64> = (0..1000).map(|k| f64::from(k % 2) * 0.7).collect();
    let driven_ones = [
        rows(1e-9, &[0.0; 5]),
        rows(1e-3, &[0.0; 100_000]),
        rows(100.0, &[1e-300; 3]),
        rows(100.0, &[5e-324; 3]),
        rows(1.0, &saw),
        rows(3600.0, &[0.0; 20]),
        "time_s,speed_kmh\n-1e15,0\n-999999999999999,0\n".to_owned(),
    ];
    for text in &driven_ones {
        let cycle = read_csv("made.csv", text.as_bytes()).unwrap();
        let run = driven(&setup, &cycle, 1.0);
        let head = &text[..60.min(text.len())];
        assert!(is_sound(&run), "{head}: {run:?}");
        // Without distance there is no fuel per distance.
        let fuel = run.fuel_l_per_100km;
        assert!(fuel.is_none_or(|fuel| fuel < 1e4), "{head}: {fuel:?}");
    }
    for text in [
        rows(0.0, &[0.0; 2]),
        rows(1e15, &[0.0; 2]),
        rows(1e6, &[0.0; 2]),
        rows(1.0, &[0.0, 1e5]),
        rows(1.0, &[0.0, -1.0]),
        rows(1.0, &[0.0]),
        "time_s,speed_kmh\n-1e15,0\n10,0\n".to_owned(),
        "time_s,speed_kmh\n0,0\n5,nan\n".to_owned(),
    ] {
        let problems = read_csv("made.csv", text.as_bytes()).expect_err(&text);
        assert!(problems.iter().all(|p| !p.message.is_empty()), "{text}");
    }
    for word in ["constant_5e-324", "constant_1e-300", "constant_0"] {
        let problem = constant_speed(word).unwrap().unwrap_err();
        assert!(!problem.message.is_empty(), "{word}");
    }
}

/// Any gear or note in any row, from a seeded generator so that failures are reproducible.
#[test]
fn random_gears_and_notes_are_driven_or_refused() {
    let words = [
        "0", "1", "2", "3", "4", "5", "6", "7", "-1", "", "PM", "K1", "K2", "x",
    ];
    let speeds = [0.0, 0.5, 10.0, 35.0, 60.0, 110.0, 180.0];
    let cars = ["rover_216_5mt", "rover_216_cvt"].map(|name| car(name, Vec::new()).unwrap());
    let (mut state, mut count) = (2001_u64, [0_u32; 2]);
    let mut next = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below
    };
    for _ in 0..600 {
        let known = if next(4) == 0 { words.len() } else { 6 };
        let mut text = "time_s,speed_kmh,gear\n".to_owned();
        for k in 0..4 + next(8) {
            let (speed, word) = (speeds[next(speeds.len())], words[next(known)]);
            text += &format!("{},{speed},{word}\n", 20 * k);
        }
        let Ok(cycle) = read_csv("gears.csv", text.as_bytes()) else {
            count[1] += 1;
            continue;
        };
        count[0] += 1;
        for setup in &cars {
            let run = driven(setup, &cycle, 1.0);
            assert!(is_sound(&run), "{text}{run:?}");
        }
    }
    assert!(count[0] > 100 && count[1] > 50, "{count:?}");
}

/// 1 000 000 steps. For 100 000 000 the page has the printed output.
#[test]
fn the_energy_balance_of_a_million_steps_is_closed() {
    let points: Vec<String> = (0..10)
        .map(|k| format!("{},{}", k * 1000, 50 * (k % 2)))
        .collect();
    let text = format!("time_s,speed_kmh\n{}\n", points.join("\n"));
    let cycle = read_csv("slow.csv", text.as_bytes()).unwrap();
    let run = driven(&car("rover_216_5mt", Vec::new()).unwrap(), &cycle, 0.01);
    assert!(cycle.trace_for(false).step_count(0.01) >= 900_000);
    assert_eq!(run.failed_checks, Vec::<String>::new());
    let error = run.run_ledger_error;
    assert!(error.is_some_and(|error| error < 1e-9), "{error:?}");
}

/// Every row of the page names existing tests, or a reason for having none.
#[test]
fn every_input_of_the_page_is_repeated_or_has_its_reason() {
    let mut rows = 0;
    let mut code = String::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in ["tests", "crates"] {
        read_code(&root.join(folder), &mut code);
    }
    for row in PAGE.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").collect();
        let [what, _, by] = cells[..] else {
            panic!("three cells: {row}");
        };
        if what.trim() == "id" || what.trim() == "class" {
            continue;
        }
        rows += 1;
        let mut named = 0;
        let is_letter = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
        let is_name = |word: &&str| word.contains('_') && word.bytes().all(is_letter);
        // Names after the word "target" are fuzzing targets.
        let tests = by.split("target").next().unwrap_or(by);
        for test in tests.split('`').skip(1).step_by(2).filter(is_name) {
            assert!(code.contains(&format!("fn {test}(")), "{test}");
            named += 1;
        }
        let is_reasoned = by.contains("target") || by.contains("not repeated");
        assert!(named > 0 || is_reasoned, "{row}");
    }
    let findings = [("H", 8), ("M", 8), ("L", 12)];
    for (class, count) in findings {
        let is_there = |k: &usize| PAGE.contains(&format!("\n| {class}{k} | "));
        assert_eq!((1..=count).filter(is_there).count(), count, "{class}");
    }
    assert_eq!(rows, 28 + 20);
}
