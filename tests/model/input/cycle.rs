//! Cycles that a user gives: `read_csv` against all that may be handed in, and constant speeds.
#![allow(clippy::unwrap_used, reason = "a test ends at the first surprise")]

use cvtcycle_config::cycle::{Cycle, GearCommand, constant_speed, read_csv};
use cvtcycle_config::{Problem, Problems};
use proptest::prelude::*;
use std::fmt::Write;

fn good(text: &str) -> Cycle {
    read_csv("town.csv", text.as_bytes()).unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn bad(text: &str) -> Problems {
    read_csv("town.csv", text.as_bytes()).unwrap_err()
}

/// The only problem: line, column, key, value, message.
fn one(text: &str) -> (usize, usize, String, String, String) {
    let problems = bad(text);
    assert_eq!(problems.len(), 1, "{problems:#?}");
    let Problem {
        place,
        key,
        value,
        message,
        ..
    } = problems.into_iter().next().unwrap();
    assert_eq!(place.file_name(), Some("town.csv"));
    (place.line, place.column, key, value, message)
}

#[test]
fn all_units_of_speed_mean_the_same() {
    let kmh = 80.467_2;
    for (column, value) in [
        ("speed_kmh", kmh),
        ("speed_km_h", kmh),
        ("speed_m_s", kmh / 3.6),
        ("speed_mph", 50.0),
    ] {
        let cycle = good(&format!("time_s,{column}\n0,{value}\n10,{value}\n"));
        assert!(
            (cycle.trace_for(true).distance_m() - 223.52).abs() < 1e-9,
            "{column}"
        );
    }
}

#[test]
fn any_time_step_and_any_start_is_taken() {
    let cycle = good("\u{feff}speed_m_s, time_s\r\n1,-7.5\r\n2,-7.25\r\n\r\n2,100\r\n");
    let intervals = &cycle.trace_for(false).intervals;
    let times: Vec<[f64; 2]> = intervals.iter().map(|i| [i.start_s, i.end_s]).collect();
    assert_eq!(times, [[0.0, 0.25], [0.25, 107.5]]);
    assert!((cycle.trace_for(true).distance_m() - (0.375 + 214.5)).abs() < 1e-12);
}

#[test]
fn values_hold_from_their_row_to_the_next() {
    let text = "time_s,speed_kmh,phase,gear,gear_note,grade_percent,engine_off,operation\n\
                0,0,a,0,PM,0,1,x\n1,0,a,1,GC,0,0,\n2,3.6,\"b, c\",1,,-3.5,0,y\n3,3.6,b,2.0,2,35,0,\n4,0,end,0,,0,1,\n";
    let cycle = good(text);
    let trace = cycle.trace_for(false);
    // the last row holds over nothing, so its phase is none
    assert_eq!(cycle.phases, ["a", "b, c", "b"]);
    let held: Vec<_> = trace
        .intervals
        .iter()
        .map(|i| (i.phase, i.grade, i.engine_off))
        .collect();
    assert_eq!(
        held,
        [
            (0, 0.0, true),
            (0, 0.0, false),
            (1, -0.035, false),
            (2, 0.35, false)
        ]
    );
    let gears = [
        GearCommand::Neutral,
        GearCommand::Change(1),
        GearCommand::InGear(1),
        GearCommand::InGear(2),
    ];
    for count in [2, 4, 5, 6, 7] {
        assert_eq!(trace.gears(count), Some(&gears[..]));
    }
    assert_eq!(trace.gears(1), None);
    let cycle = good("time_s,speed_kmh,grade\n0,0,0.02\n1,0,0.35\n2,0,0\n");
    assert!((cycle.trace_for(true).intervals[0].grade - 0.02).abs() < 1e-15);
}

#[rustfmt::skip]
const BAD_VALUES: [(&str, usize, usize, &str, &str, &str); 26] = [
    ("time_s,speed_kmh\n0,0\n1,nan\n2,0", 3, 3, "speed_kmh", "nan", "not a number"),
    ("time_s,speed_kmh\n0,0\n1, inf\n2,0", 3, 4, "speed_kmh", "inf", "finite"),
    ("time_s,speed_kmh\n0,0\n1,1e999\n2,0", 3, 3, "speed_kmh", "1e999", "finite"),
    ("time_s,speed_kmh\n0,0\n1,fast\n2,0", 3, 3, "speed_kmh", "fast", "not a number"),
    ("time_s,speed_kmh\n0,0\n1,\n2,0", 3, 3, "speed_kmh", "", "missing"),
    ("time_s,speed_kmh\n0,0\n1,\"2,5\"\n2,0", 3, 4, "speed_kmh", "2,5", "not a number"),
    ("time_s,speed_kmh\n0,0\n1,-0.1\n2,0", 3, 3, "speed_kmh", "-0.1", "negative"),
    ("time_s,speed_kmh\n0,299\n1,300.1\n2,299", 3, 3, "speed_kmh", "300.1", "too fast"),
    ("time_s,speed_m_s\n0,83\n1,83.4\n2,83", 3, 3, "speed_m_s", "83.4", "too fast"),
    ("time_s,speed_mph\n0,186\n1,186.5\n2,186", 3, 3, "speed_mph", "186.5", "too fast"),
    ("speed_kmh,time_s\n0,0\n0,NaN\n0,2", 3, 3, "time_s", "NaN", "not a number"),
    ("time_s,speed_kmh\n0,0\n1,0\n1,0", 4, 1, "time_s", "1", "does not rise"),
    ("time_s,speed_kmh\n5,0\n4,0\n6,0", 3, 1, "time_s", "4", "does not rise"),
    ("time_s,speed_kmh\n0,0\n3600.5,0", 3, 1, "time_s", "3600.5", "gap"),
    ("time_s,speed_m_s\n0,0\n1,12.5", 3, 3, "speed_m_s", "12.5", "jumps"),
    ("time_s,speed_kmh\n0,20\n\n0.1,0", 4, 5, "speed_kmh", "0", "jumps"),
    ("time_s,speed_kmh,gear\n0,0,11\n1,0,0", 2, 5, "gear", "11", "out of range"),
    ("time_s,speed_kmh,gear_5mt\n0,0,6\n1,0,0", 2, 5, "gear_5mt", "6", "out of range"),
    ("time_s,speed_kmh,gear\n0,0,1.5\n1,0,0", 2, 5, "gear", "1.5", "not a whole number"),
    ("time_s,speed_kmh,gear,gear_note\n0,0,1,R\n1,0,0,", 2, 7, "gear_note", "R", "not known"),
    ("time_s,speed_kmh,gear_5mt,gear_note\n0,0,1,K6\n1,0,0,", 2, 7, "gear_note", "K6", "not known"),
    ("time_s,speed_kmh,grade_percent\n0,0,-35.1\n1,0,0", 2, 5, "grade_percent", "-35.1", "out of range"),
    ("time_s,speed_kmh,grade\n0,0,3\n1,0,0", 2, 5, "grade", "3", "out of range"),
    ("time_s,speed_kmh,engine_off\n0,0,yes\n1,0,0", 2, 5, "engine_off", "yes", "not a number"),
    ("time_s,speed_kmh,engine_off\n0,2,1\n1,0,0", 2, 5, "engine_off", "1", "moves"),
    ("time_s,speed_kmh,engine_off\n0,0,1\n1,2,0", 3, 3, "speed_kmh", "2", "starts with its engine off"),
];

#[test]
fn each_bad_value_is_named_with_its_place() {
    for (text, line, column, key, value, message) in BAD_VALUES {
        let found = one(text);
        assert_eq!(
            (found.0, found.1, found.2.as_str(), found.3.as_str()),
            (line, column, key, value),
            "{text}"
        );
        assert!(found.4.contains(message), "{text}: {}", found.4);
    }
}

#[test]
fn files_that_are_no_table_are_named() {
    let cases: [(&[u8], &str); 14] = [
        (b"", "empty"),
        (b"\xef\xbb\xbf\r\n \n", "empty"),
        (b"time_s,speed_kmh\n0,0\0\n", "zero byte in line 2"),
        (b"time_s,speed_kmh\n0,\xff\n", "not UTF-8 text: line 2"),
        (b"\xff\xfet\0", "UTF-16"),
        (
            b"time_s;speed_kmh\n0;13,889\n1;13,889\n",
            "in two ways: 13.889, or 13889",
        ),
        (
            b"time_s;speed_kmh\n0;0,5\n1;1.5\n",
            "this number and 0,5 in line 2 do not write their decimals alike",
        ),
        (b"time_s,speed_kmh\n", "no rows"),
        (b"time_s,speed_kmh\n0,0\n", "one row only"),
        (b"0,0\n1,0\n", "no column names"),
        (b"speed_kmh\n0\n1\n", "time_s is missing"),
        (
            b"time_s\n0\n1\n",
            "speed_kmh or speed_km_h or speed_m_s or speed_mph is missing",
        ),
        (
            b"time_s,speed_kmh,speed_m_s\n0,0,0\n1,0,0\n",
            "speed_m_s and speed_kmh say the same thing",
        ),
        (
            b"time_s,speed_kmh,time_s\n0,0,0\n1,0,0\n",
            "duplicate column",
        ),
    ];
    for (bytes, message) in cases {
        let problems = read_csv("town.csv", bytes).unwrap_err();
        assert_eq!(problems.len(), 1, "{problems:#?}");
        assert!(problems[0].message.contains(message), "{problems:#?}");
    }
}

#[test]
fn all_problems_come_at_once_in_the_order_of_the_lines() {
    let text = "time_s,speed_kmh,gradient,phase\n0,0,0,a\n1,x,0,a\n2,0,0\n3,0,0,a\n2,0,0,\n4,999,0,a\n5,0,0,a,b\n6,0,0,\"a\n";
    let found: Vec<(usize, String)> = bad(text)
        .into_iter()
        .map(|p| (p.place.line, p.key))
        .collect();
    let expected = [
        (1, "gradient"),
        (3, "speed_kmh"),
        (4, ""),
        (6, "phase"),
        (6, "time_s"),
        (7, "speed_kmh"),
        (8, ""),
        (9, ""),
    ];
    assert_eq!(found, expected.map(|(line, key)| (line, key.to_owned())));
}

#[test]
fn hints_speak_of_the_likely_cause() {
    let hint = |text: &str| bad(text).remove(0).hint;
    assert!(hint("time_s,speed_m_s\n0,0\n1,50\n").contains("is the column in km/h?"));
    assert!(hint("time_s,speed_kmh\n0,0\n1,50\n").contains("is the column in km/h?"));
    assert!(
        bad("time_s,speed\n0,0\n1,0\n")
            .remove(0)
            .allowed
            .contains("speed_kmh")
    );
    assert!(hint("time_s,speed_kmh\n0,5,1,5\n1,0\n").contains("decimal commas"));
    assert!(hint("time_s,speed_kmh\n0,0\n4000,0\n").contains("milliseconds"));
    assert!(hint("time_s,speed_kmh,grade\n0,0,3\n1,0,0\n").contains("grade_percent"));
}

#[test]
fn after_fifty_problems_the_rest_is_counted() {
    let mut text = "time_s,speed_kmh\n".to_owned();
    for time in 0..500 {
        writeln!(text, "{time},-1").unwrap();
    }
    let problems = bad(&text);
    assert_eq!(problems.len(), 51);
    assert_eq!(problems[50].message, "450 more problems are not shown");
}

#[test]
fn limits_of_length_are_kept() {
    let long = |seconds: u64| {
        (0..=seconds / 1000).fold("time_s,speed_kmh\n".to_owned(), |text, row| {
            text + &format!("{},0\n", row * 1000)
        })
    };
    assert!((good(&long(1_000_000)).trace_for(true).duration_s() - 1e6).abs() < 1e-6);
    assert!(one(&long(1_002_000)).4.contains("too long"));
    let rows = |count: usize| {
        "time_s,speed_kmh\n".to_owned()
            + &(0..count)
                .map(|row| format!("{},0\n", row as f64 / 4.0))
                .collect::<String>()
    };
    assert_eq!(
        good(&rows(2_000_000)).trace_for(true).intervals.len(),
        1_999_999
    );
    let found = one(&rows(2_000_001));
    assert!(found.0 == 2_000_002 && found.4.contains("too many rows"));
}

#[test]
fn times_that_fall_together_after_the_shift_do_not_rise() {
    assert!(
        one("time_s,speed_kmh\n-1000,0\n1e-20,0\n2e-20,0\n")
            .4
            .contains("does not rise")
    );
    assert!(!bad("time_s,speed_kmh\n-1.7e308,0\n1.7e308,0\n").is_empty());
}

// ---------------------------------------------------------------- any bytes at all

fn check(cycle: &Cycle) {
    for trace in [cycle.trace_for(false), cycle.trace_for(true)] {
        assert!(!trace.intervals.is_empty());
        let mut end_s = 0.0;
        for step in trace.steps(1.0).take(10_000) {
            assert!(step.dt_s > 0.0 && step.dt_s < 1.0 + 1e-6 && step.time_s > end_s);
            assert!(
                (0.0..=84.0).contains(&step.start_speed_m_s)
                    && (0.0..=84.0).contains(&step.end_speed_m_s)
            );
            assert!(step.grade.abs() <= 0.35 + 1e-12 && step.interval < trace.intervals.len());
            end_s = step.time_s;
        }
        for count in 0..12 {
            assert!(
                trace
                    .gears(count)
                    .is_none_or(|gears| gears.len() == trace.intervals.len())
            );
        }
    }
    assert!(
        cycle
            .phase_groups()
            .iter()
            .flat_map(|group| &group.1)
            .all(|&p| usize::from(p) < cycle.phases.len().max(1))
    );
}

fn check_bytes(bytes: &[u8]) {
    match read_csv("any.csv", bytes) {
        Ok(cycle) => check(&cycle),
        Err(problems) => {
            assert!((1..=51).contains(&problems.len()));
            assert!(problems.iter().all(|problem| !problem.message.is_empty()
                && problem.place.file_name() == Some("any.csv")));
        }
    }
}

fn word() -> impl Strategy<Value = String> {
    let words = [
        "0",
        "1",
        "2",
        "2.5",
        "-1",
        "1e300",
        "-1e308",
        "1e-300",
        "nan",
        "inf",
        "",
        " ",
        "\"",
        "\"\"",
        "\"a,b\"",
        "é",
        "PM",
        "K1",
        "K9",
        "GC",
        "\r",
        ";",
        "\u{feff}",
        "time_s",
        "speed_kmh",
        "speed_m_s",
        "phase",
        "gear",
        "gear_note",
        "gear_6mt",
        "grade",
        "engine_off",
    ];
    prop::sample::select(words.to_vec()).prop_map(str::to_owned)
}

fn table_text() -> impl Strategy<Value = String> {
    let names = [
        "time_s",
        "speed_m_s",
        "phase",
        "gear",
        "gear_5mt",
        "gear_note",
        "grade",
        "engine_off",
    ];
    let header = prop::sample::subsequence(names.to_vec(), 1..=names.len()).prop_shuffle();
    let row = prop::collection::vec(word(), 0..9);
    (header, prop::collection::vec(row, 0..12), any::<bool>()).prop_map(|(header, rows, crlf)| {
        let end = if crlf { "\r\n" } else { "\n" };
        rows.into_iter().fold(header.join(",") + end, |text, row| {
            text + &row.join(",") + end
        })
    })
}

/// Mostly sensible tables, so that good cycles are reached as well.
fn sensible() -> impl Strategy<Value = String> {
    let row = (
        0.001..30.0_f64,
        0.0..3.0_f64,
        0..4_u8,
        prop::sample::select(vec!["", "PM", "K2", "GC"]),
        -0.4..0.36_f64,
    );
    prop::collection::vec(row, 1..20).prop_map(|rows| {
        let mut time_s = -50.0;
        let mut text = "time_s,speed_m_s,gear,gear_note,grade,phase\n".to_owned();
        for (dt_s, speed, gear, note, grade) in rows {
            time_s += dt_s;
            writeln!(
                text,
                "{time_s},{speed},{gear},{note},{},p{gear}",
                f64::max(grade, -0.35)
            )
            .unwrap();
        }
        text
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn read_csv_never_panics_on_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        check_bytes(&bytes);
        // past the header and past the check of the encoding as well
        let text = format!("time_s,speed_kmh\n{}", String::from_utf8_lossy(&bytes));
        check_bytes(text.as_bytes());
    }

    #[test]
    fn read_csv_never_panics_on_nearly_tables(text in table_text()) {
        check_bytes(text.as_bytes());
    }

    #[test]
    fn read_csv_never_panics_on_words(words in prop::collection::vec(word(), 0..60), separators in prop::collection::vec(0..3_usize, 60)) {
        let text: String = words.iter().zip(separators).map(|(word, s)| word.clone() + [",", "\n", "\r\n"][s]).collect();
        check_bytes(text.as_bytes());
    }

    #[test]
    fn sensible_tables_give_sound_traces(text in sensible()) {
        check_bytes(text.as_bytes());
    }

    #[test]
    fn steps_add_up_to_the_trace(text in sensible(), max_dt_s in 0.01..40.0_f64) {
        if let Ok(cycle) = read_csv("any.csv", text.as_bytes()) {
            let trace = cycle.trace_for(false);
            let steps: Vec<_> = trace.steps(max_dt_s).collect();
            prop_assert_eq!(steps.len(), trace.step_count(max_dt_s));
            let distance: f64 = steps.iter().map(|s| 0.5 * (s.start_speed_m_s + s.end_speed_m_s) * s.dt_s).sum();
            prop_assert!((distance - trace.distance_m()).abs() < 1e-9 * (1.0 + distance));
            prop_assert!(steps.windows(2).all(|p| (p[1].start_speed_m_s - p[0].end_speed_m_s).abs() < 1e-12));
            prop_assert!((steps.last().unwrap().time_s - trace.duration_s()).abs() < 1e-9);
        }
    }
}

#[test]
fn a_constant_speed_is_600_s_with_flying_start() {
    for (name, metres) in [
        ("constant_90", 15_000.0),
        ("constant_120", 20_000.0),
        ("constant_88.5", 14_750.0),
        ("constant_250", 250_000.0 / 6.0),
        ("constant_0.1", 50.0 / 3.0),
    ] {
        let cycle = constant_speed(name).unwrap().unwrap();
        let trace = cycle.trace_for(true);
        assert!(
            (trace.distance_m() - metres).abs() < 1e-8
                && (trace.duration_s() - 600.0).abs() < 1e-12
        );
        assert!((trace.intervals[0].start_speed_m_s - metres / 600.0).abs() < 1e-12);
        assert_eq!(
            (
                cycle.name.as_str(),
                cycle.phase_groups()[0].0.as_str(),
                cycle.has_gears()
            ),
            (name, name, false)
        );
    }
}

#[test]
fn other_names_are_left_to_others_and_bad_speeds_explained() {
    assert!(constant_speed("ece15").is_none() && constant_speed("constant90").is_none());
    for bad in [
        "0", "0.0009", "", ".", "-5", "+5", "250.1", "1e2", "nan", "inf", "88,5", "9.0.0", "90kmh",
    ] {
        let problem = constant_speed(&format!("constant_{bad}"))
            .unwrap()
            .unwrap_err();
        assert!(
            problem.value.ends_with(bad)
                && problem.allowed.contains("250")
                && problem.hint.contains("constant_")
        );
    }
}

/// Names as people write them; every alias leads to a cycle, and none hides the name of another one.
#[test]
fn cycles_have_other_names() {
    use cvtcycle_config::cycle::{ALIASES, find, name_of, names};
    for (word, name) in [
        ("nedc", "ece15_eudc"),
        ("NEDC", "ece15_eudc"),
        ("MVEG-B", "ece15_eudc"),
        ("WLTP", "wltc_class3b"),
        ("wltc class 3b", "wltc_class3b"),
        ("FTP-75", "ftp75"),
        ("LA4", "udds"),
        ("HWFET", "hwfet"),
        ("10-15", "jp_10_15_mode"),
        ("US06", "us06"),
    ] {
        assert_eq!(find(word).unwrap().name, name, "{word}");
    }
    for (alias, name) in ALIASES {
        assert!(names().contains(&name), "{alias}");
    }
    for name in names() {
        assert_eq!(name_of(name), Some(*name));
    }
    let problem = &find("nedcc").unwrap_err()[0];
    assert!(problem.hint.contains("nedc"), "{}", problem.hint);
}
