//! Logs of other programs and instruments: `run --cycle FILE` and `log`.
//!
//! Truth: the same drive without the fault (`clean.csv`), in each of the forms that public files have; shipped cycles, re-rounded.

use super::{run, stdout};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::process::Output;

fn folder() -> String {
    format!("{}/tests/cli/logs", env!("CARGO_MANIFEST_DIR"))
}

pub fn path(file: &str) -> String {
    format!("{}/{file}", folder())
}

/// A run of a cycle by its name or path, for its summary.
pub fn run_of(cycle: &str, more: &[&str]) -> Output {
    run(&[
        &["run", "--cycle", cycle, "--price", "never", "--json"],
        more,
    ]
    .concat())
}

/// The summary of such a run, which must not fail.
pub fn summary_of(cycle: &str, more: &[&str]) -> Value {
    let output = run_of(cycle, more);
    let problems = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{cycle} {more:?}: {problems}"
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

fn drive(file: &str, more: &[&str]) -> Output {
    run_of(&path(file), more)
}

fn summary(file: &str, more: &[&str]) -> Value {
    summary_of(&path(file), more)
}

pub fn fuel(summary: &Value) -> f64 {
    summary["runs"][0]["fuel_l_per_100km"].as_f64().unwrap()
}

fn alone(file: &str, more: &[&str]) -> Value {
    summary(file, &[&["--baseline", "none"], more].concat())
}

/// The line that is proposed, as arguments.
fn proposed(file: &str) -> (String, String) {
    let output = drive(file, &["--baseline", "none"]);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{file}: {text}");
    let line = text
        .lines()
        .find(|line| line.starts_with("try: cvtcycle run "));
    let line = line.unwrap_or_else(|| panic!("{file}: no proposal in {text}"));
    let (_, columns) = line.split_once("--columns ").unwrap();
    let columns = columns.trim_matches(['"', '\'']).to_owned();
    (columns, text)
}

#[test]
fn each_form_of_the_drive_gives_the_fuel_of_the_drive() {
    let clean = fuel(&alone("clean.csv", &[]));
    for (file, columns, within) in [
        ("k01_hms.csv", "", 1e-9),
        ("k02_ved_ms.csv", "", 1e-9),
        ("k04_doubled_at_bag.csv", "", 1e-9),
        ("k05_repeated_header.csv", "", 1e-9),
        ("k05_co2mpas_two_names.csv", "", 1e-9),
        ("k05_preamble.csv", "", 1e-9),
        ("k06_dash.csv", "", 2e-3),
        ("k06_nan_other_raster.csv", "", 1e-9),
        ("k07_negative_at_rest.csv", "", 0.02),
        ("k12_sumo_two_cars.csv", "where=vehicle_id:car_a", 1e-9),
        ("k21_latin1.csv", "", 1e-9),
        ("k22_spaces.txt", "time:s,speed:km/h", 1e-9),
        ("k23_kph.csv", "", 1e-9),
    ] {
        let more: &[&str] = if columns.is_empty() {
            &[]
        } else {
            &["--columns", columns]
        };
        let own = fuel(&alone(file, more));
        assert!((own - clean).abs() <= within, "{file}: {own} for {clean}");
    }
}

#[test]
fn each_proposal_is_read() {
    let clean = fuel(&alone("clean.csv", &[]));
    for (file, right) in [
        ("k03_ms_named_s.csv", Some(clean)),
        ("k04_carobd_4hz_whole_seconds.csv", None),
        ("k12_sumo_two_cars.csv", Some(clean)),
        ("k12_sumo_one_after_other.csv", None),
        ("k13_slope_percent_no_unit.csv", None),
        ("k22_spaces.txt", Some(clean)),
    ] {
        let (columns, text) = proposed(file);
        let own = fuel(&alone(file, &["--columns", &columns]));
        assert!(
            right.is_none_or(|right| (own - right).abs() < 1e-9),
            "{file} {columns}: {own}"
        );
        // One problem a kind, and not one a row.
        assert!(text.lines().count() < 20, "{file}: {text}");
    }
    let (_, text) = proposed("k12_sumo_one_after_other.csv");
    assert!(text.contains("`vehicle_id` has 2 values"), "{text}");
}

#[test]
fn slopes_and_flags_are_in_their_units() {
    let degrees = fuel(&alone("k13_slope_degrees.csv", &[]));
    let percent = fuel(&alone(
        "k13_slope_percent_no_unit.csv",
        &["--columns", "grade=slope:%"],
    ));
    // 0.2 degrees are 0.349 %.
    let written = "time=time [s],speed=vehicle_speed [km/h],grade=slope [°]:%!";
    let as_percent = fuel(&alone("k13_slope_degrees.csv", &["--columns", written]));
    assert!(
        (as_percent - percent).abs() < 1e-9,
        "{as_percent} {percent}"
    );
    assert!(degrees > percent + 0.05, "{degrees} {percent}");
    let off = fuel(&alone("k14_engine_on.csv", &[]));
    assert!(
        off < fuel(&alone("clean.csv", &[])) - 1.0,
        "the engine rests at standstill: {off}"
    );
}

#[test]
fn a_stated_unit_is_not_overridden_in_silence() {
    let of = |unit: &str| format!("time=Timestamp(ms):{unit},speed=Vehicle Speed[km/h]:km/h");
    let output = drive("k02_ved_ms.csv", &["--columns", &of("s")]);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(text.contains("states ms, and the columns say s"), "{text}");
    assert_eq!(
        drive("k02_ved_ms.csv", &["--columns", &of("ms")])
            .status
            .code(),
        Some(0)
    );
}

#[test]
fn faults_that_cannot_be_mended_in_one_way_are_refused_by_name() {
    for (file, words, repair) in [
        (
            "k08_gap_at_speed.csv",
            "1 gap while the car moves, 272.0 s",
            "cut",
        ),
        (
            "k10_sumo_teleport.csv",
            "the speed jumps: -195.2 m/s2",
            "cut",
        ),
        (
            "k10_gps_spike.csv",
            "1 sample against both neighbours",
            "no-spikes",
        ),
        (
            "k07_negative_at_rest.csv",
            "44 small negative speeds",
            "no-negative",
        ),
    ] {
        let (bad, good): (&[&str], &[&str]) = match repair {
            "cut" => (&[], &["--repair", "cut"]),
            _ => (&["--repair", repair], &[]),
        };
        let output = drive(file, bad);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{file}");
        let stem = match repair {
            "no-negative" => "the speed is negative, and in 43 more rows",
            _ => words,
        };
        assert!(text.contains(stem), "{file}: {text}");
        let mended = summary(file, good);
        let repairs = mended["recording"]["repairs"].as_array().unwrap();
        assert!(
            repairs
                .iter()
                .any(|own| own["what"].as_str().unwrap().contains(words)),
            "{repairs:?}"
        );
    }
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("one_stamp.csv");
    fs::write(&file, "t,v\n5,0\n5,1\n5,2\n").unwrap();
    let columns = ["--columns", "time=t:s,speed=v:km/h"];
    let output = run(&[&["run", "--cycle", file.to_str().unwrap()], &columns[..]].concat());
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("all rows have the same stamp"), "{text}");
    let spike = fuel(&alone("k10_gps_spike.csv", &[]));
    // The same drive with the sample as its neighbours have it.
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("even.csv");
    let even = fs::read_to_string(path("k10_gps_spike.csv")).unwrap();
    fs::write(&file, even.replace(",85\n", ",50\n")).unwrap();
    let even = summary_of(file.to_str().unwrap(), &["--baseline", "none"]);
    assert!((spike - fuel(&even)).abs() < 1e-9, "{spike}");
}

#[test]
fn a_cycle_in_another_unit_is_doubted_in_the_first_line() {
    let output = run(&["run", "--cycle", &path("k18_udds_mph_named_kmh.csv")]);
    let text = stdout(&output);
    let first: String = text
        .split("transmission losses")
        .next()
        .unwrap()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    assert!(
        first.starts_with("DOUBTFUL, this is udds times 0.6214: are the numbers mph?"),
        "{first}"
    );
    // The report repeats it before its first number.
    let out = tempfile::tempdir().unwrap();
    let at = |name: &str| out.path().join(name).to_str().unwrap().to_owned();
    let log = path("k18_udds_mph_named_kmh.csv");
    let driven = run(&[
        "run",
        "--cycle",
        &log,
        "--sensitivity",
        "never",
        "--quiet",
        "--out",
        &at("made"),
    ]);
    assert_eq!(driven.status.code(), Some(0));
    assert_eq!(
        run(&["report", &at("made"), "--stored", "--out", &at("page.html")])
            .status
            .code(),
        Some(0)
    );
    let page = fs::read_to_string(at("page.html")).unwrap();
    assert!(
        page.contains("Doubtful, this is udds times 0.6214: are the numbers mph? The CVT uses")
    );
    // NEDC with 94.4 in place of 120 km/h.
    let dir = tempfile::tempdir().unwrap();
    let nedc = stdout(&run(&[
        "convert",
        "cycle",
        "nedc",
        "--automatic",
        "--to",
        "csv",
    ]));
    let wrong: String = nedc
        .lines()
        .map(|line| line.replace(",120,", ",94.4,") + "\n")
        .collect();
    let file = dir.path().join("nedc.csv");
    fs::write(&file, wrong).unwrap();
    let text = stdout(&run(&["run", "--cycle", file.to_str().unwrap()]));
    assert!(
        text.starts_with("DOUBTFUL, this is ece15_eudc but for"),
        "{text}"
    );
    assert!(text.contains("94.4 km/h in place of"), "{text}");
}

/// Pseudo-random numbers from 0 to 1.
fn random(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Speeds of a shipped cycle, m/s, a second apart.
fn shipped(name: &str) -> Vec<f64> {
    let text = stdout(&run(&["convert", "cycle", name, "--automatic"]));
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let heads = reader.headers().unwrap().clone();
    let at = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let columns = [at("time_s"), at("speed_kmh")];
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        columns.map(|at| row[at].parse::<f64>().unwrap())
    });
    let rows: Vec<[f64; 2]> = rows.collect();
    let last = rows.last().unwrap()[0] as usize;
    let speed = |second: usize| {
        let second = second as f64;
        let next = rows.partition_point(|row| row[0] < second).max(1);
        let ([from, a], [to, b]) = (rows[next - 1], rows[next]);
        (a + (b - a) * (second - from) / (to - from)) / 3.6
    };
    (0..=last).map(speed).collect()
}

/// Truth: the clean cycle. Fuel within 1 % and the difference to the manual car within 0.5 points, and the printed intervals hold them.
#[test]
fn rate_and_resolution_leave_the_fuel_and_the_difference() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("log.csv");
    let drive = |text: &str| -> Value {
        fs::write(&file, text).unwrap();
        summary_of(file.to_str().unwrap(), &[])
    };
    let both = |summary: &Value| {
        (
            fuel(summary),
            summary["comparison"][0]["fuel_percent"].as_f64().unwrap(),
        )
    };
    for cycle in ["udds", "hwfet", "us06", "ece15_eudc_auto"] {
        // 70 km/h of the NEDC is a speed at which the manual car shifts: a breath decides about a gear.
        let is_on_edge = cycle == "ece15_eudc_auto";
        let speeds = shipped(cycle);
        let clean = summary_of(cycle, &[]);
        let (fuel, percent) = both(&clean);
        for hertz in [10_usize, 4, 2, 1] {
            for (unit, quantum) in [
                ("speed_kmh", 1.0 / 3.6),
                ("speed_mph", 0.447_04),
                ("speed_m_s", 0.0),
            ] {
                let mut text = format!("time_s,{unit}\n");
                let mut state = 1;
                for k in 0..=(speeds.len() - 1) * hertz {
                    let (second, part) = (k / hertz, (k % hertz) as f64 / hertz as f64);
                    let next = speeds[(second + 1).min(speeds.len() - 1)];
                    let speed = speeds[second] + part * (next - speeds[second]);
                    let shown = match quantum > 0.0 {
                        true => (speed / quantum).round(),
                        // Noise of 0.05 m/s, as the sum of twelve even numbers.
                        false if speed > 0.0 => (speed
                            + 0.05 * ((0..12).map(|_| random(&mut state)).sum::<f64>() - 6.0))
                            .max(0.0),
                        false => 0.0,
                    };
                    let _ = writeln!(text, "{},{shown:.4}", k as f64 / hertz as f64);
                }
                let own = drive(&text);
                let (own_fuel, own_percent) = both(&own);
                let case = format!("{cycle} {hertz} Hz {unit}");
                assert!(
                    (own_fuel / fuel - 1.0).abs() < 0.01,
                    "{case}: {own_fuel} for {fuel}"
                );
                assert!(
                    is_on_edge || (own_percent - percent).abs() < 0.5,
                    "{case}: {own_percent} for {percent}"
                );
                let recording = &own["recording"];
                if !recording["fuel"].is_null() {
                    let ends = |of: &Value| [0, 1].map(|k| of[k].as_f64().unwrap());
                    let ([low, high], [less, more]) =
                        (ends(&recording["fuel"]), ends(&recording["percent"][0]));
                    assert!(
                        low <= fuel && fuel <= high && less <= percent && percent <= more,
                        "{case}: {recording}"
                    );
                }
                assert_eq!(
                    recording["doubts"].as_array().map_or(0, Vec::len),
                    0,
                    "{case}: {recording}"
                );
            }
        }
    }
}

#[test]
fn a_log_is_shown_and_written_as_the_cycle_that_it_is() {
    let text = stdout(&run(&["log", &path("k11_long.csv")]));
    for part in [
        "VALUE",
        "km/h",
        "passed over: PID, UNITS",
        "steps of 1.000 s",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("cycle.csv");
    let written = run(&[
        "log",
        &path("k02_ved_ms.csv"),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(written.status.code(), Some(0));
    let again = summary_of(out.to_str().unwrap(), &["--baseline", "none"]);
    assert!((fuel(&again) - fuel(&alone("k02_ved_ms.csv", &[]))).abs() < 1e-9);
    let shown = run(&["log", &path("k09_udds_10hz_whole_kmh.csv"), "--json"]);
    let shown: Value = serde_json::from_slice(&shown.stdout).unwrap();
    let accel = shown["resolution"]["accel_m_s2"].as_f64().unwrap();
    assert!(
        (accel - 10.0 / 3.6).abs() < 1e-6,
        "a step of 1 km/h in 0.1 s: {accel}"
    );
    assert_eq!(shown["repairs"][0]["name"], "smooth");
}

/// Truth: the same drive; encodings, separators, stamps and units of the forms that people have.
#[test]
fn a_drive_in_many_written_forms_is_one_drive() {
    let clean = fs::read_to_string(path("clean.csv")).unwrap();
    let rows: Vec<(f64, f64)> = clean
        .lines()
        .skip(1)
        .map(|line| {
            line.split_once(',')
                .map(|(t, v)| (t.parse().unwrap(), v.parse().unwrap()))
                .unwrap()
        })
        .collect();
    let right = fuel(&alone("clean.csv", &[]));
    let text = |head: &str, row: &dyn Fn(f64, f64) -> String| {
        let rows: String = rows.iter().map(|(t, v)| row(*t, *v) + "\n").collect();
        format!("{head}\n{rows}")
    };
    let clock = |t: f64, from: f64| {
        let s = (from + t) as u64;
        format!("{:02}:{:02}:{:02}", s / 3600 % 24, s / 60 % 60, s % 60)
    };
    let plain = text("Time [s];Vehicle Speed [km/h]", &|t, v| format!("{t};{v}"));
    let utf16 = |text: &str| {
        text.encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect::<Vec<u8>>()
    };
    let forms: Vec<(&str, Vec<u8>)> = vec![
        ("semicolons", plain.clone().into_bytes()),
        ("decimal commas", plain.replace('.', ",").into_bytes()),
        (
            "UTF-16 with mark",
            [vec![0xff, 0xfe], utf16(&plain)].concat(),
        ),
        ("UTF-16 without", utf16(&plain)),
        (
            "Windows-1252",
            text("Zeit [s];Geschwindigkeit [km/h];\u{fc}", &|t, v| {
                format!("{t};{v};1")
            })
            .chars()
            .map(|c| c as u8)
            .collect(),
        ),
        (
            "tabs, CR LF",
            text("time (sec)\tspeed (mph)", &|t, v| {
                format!("{t}\t{}", v / 1.609_344)
            })
            .replace('\n', "\r\n")
            .into_bytes(),
        ),
        (
            "blanks",
            text("time_s speed_kmh", &|t, v| format!("  {t}     {v}")).into_bytes(),
        ),
        (
            "trailing semicolon",
            text("time_s;speed_kmh;", &|t, v| format!("{t};{v};")).into_bytes(),
        ),
        (
            "over midnight",
            text("clock,speed_kmh", &|t, v| {
                format!("{},{v}", clock(t, 86_300.0))
            })
            .into_bytes(),
        ),
        (
            "ISO",
            text("timestamp,speed_kmh", &|t, v| {
                format!("2026-01-05T{}Z,{v}", clock(t, 3600.0))
            })
            .into_bytes(),
        ),
        (
            "minutes",
            text("time [min],speed [m/s]", &|t, v| {
                format!("{},{}", t / 60.0, v / 3.6)
            })
            .into_bytes(),
        ),
        (
            "hours",
            text("elapsed time [h],velocity [kn]", &|t, v| {
                format!("{},{}", t / 3600.0, v / 1.852)
            })
            .into_bytes(),
        ),
        (
            "epoch in ms",
            text("epoch (ms),gps_speed (m/s)", &|t, v| {
                format!("{},{}", 1.767_6e12 + 1e3 * t, v / 3.6)
            })
            .into_bytes(),
        ),
        (
            "microseconds",
            text("Time_us,vehicle_speed_kph", &|t, v| {
                format!("{},{v}", 1e6 * t)
            })
            .into_bytes(),
        ),
        (
            "units below",
            text("t;v\ns;km/h", &|t, v| format!("{t};{v}")).into_bytes(),
        ),
        (
            "index column",
            text(",time_s,speed_kmh", &|t, v| format!("{t},{t},{v}")).into_bytes(),
        ),
        ("footer", format!("{}Total;rows\n", plain).into_bytes()),
        (
            "other channels",
            text("time_s,rpm,speed_kmh,note", &|t, v| {
                format!("{t},900,{v},x")
            })
            .into_bytes(),
        ),
        (
            "minutes and seconds",
            text("time,speed_kmh", &|t, v| {
                format!("{}:{:02},{v}", t as u64 / 60, t as u64 % 60)
            })
            .into_bytes(),
        ),
        (
            "quotes",
            text("\"time, s\",\"speed, km/h\"", &|t, v| {
                format!("\"{t}\",\"{v}\"")
            })
            .into_bytes(),
        ),
    ];
    let dir = tempfile::tempdir().unwrap();
    for (form, bytes) in forms {
        let file = dir.path().join("form.csv");
        fs::write(&file, bytes).unwrap();
        let own = fuel(&summary_of(file.to_str().unwrap(), &["--baseline", "none"]));
        assert!((own - right).abs() < 1e-6, "{form}: {own} for {right}");
    }
}

/// Property: the log that a car of the model writes of itself is computed again as it is.
#[test]
fn engine_speed_and_fuel_of_a_log_are_compared_with_the_computed_ones() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("own");
    let driven = run(&[
        "run",
        "--cycle",
        "udds",
        "--baseline",
        "none",
        "--price",
        "never",
        "--sensitivity",
        "never",
        "--out",
        out.to_str().unwrap(),
        "--quiet",
    ]);
    assert_eq!(
        driven.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&driven.stderr)
    );
    let trace = fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let trace = trace
        .into_iter()
        .find(|path| path.extension().is_some_and(|end| end == "csv"))
        .unwrap();
    let mut reader = csv::Reader::from_path(trace).unwrap();
    let heads = reader.headers().unwrap().clone();
    let at = |name: &str| {
        heads
            .iter()
            .position(|head| head == name)
            .unwrap_or_else(|| panic!("{name} in {heads:?}"))
    };
    let columns = [at("time_s"), at("engine_speed_rpm"), at("fuel_g_s")];
    let speeds = shipped("udds");
    let mut text =
        "time [s],vehicle_speed [m/s],engine_speed [rpm],fuel_rate [g/s],coolant [degC]\n"
            .to_owned();
    let _ = writeln!(text, "0,0,,,");
    for (k, row) in reader.records().map(Result::unwrap).enumerate() {
        let [time, rpm, fuel] = columns.map(|column| row[column].to_owned());
        let _ = writeln!(text, "{time},{},{rpm},{fuel},", speeds[k + 1]);
    }
    let file = dir.path().join("log.csv");
    fs::write(&file, text).unwrap();
    let again = summary_of(file.to_str().unwrap(), &["--baseline", "none"]);
    let measured = again["recording"]["measured"].as_array().unwrap();
    assert_eq!(
        measured.len(),
        2,
        "a channel without values is none: {measured:?}"
    );
    for own in measured {
        let number = |key: &str| own[key].as_f64().unwrap();
        assert!(number("rms") < 1e-3 * number("measured"), "{own}");
        assert!(
            (number("computed") / number("measured") - 1.0).abs() < 1e-4,
            "{own}"
        );
    }
}

/// A refusal that a repair mends ends with a call that works, also where it is chosen already.
#[test]
fn a_repair_is_proposed_as_a_call() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("turned.csv");
    let clean = fs::read_to_string(path("clean.csv")).unwrap();
    let mut rows: Vec<&str> = clean.lines().skip(1).collect();
    rows.swap(30, 31);
    fs::write(&file, format!("time_s,speed_kmh\n{}\n", rows.join("\n"))).unwrap();
    let file = file.to_str().unwrap();
    let gap = path("k08_gap_at_speed.csv");
    let cases: [(&str, &[&str], &str); 4] = [
        (file, &[], "sort"),
        (&gap, &[], "cut"),
        (&gap, &["--repair", "no-smooth"], "no-smooth,cut"),
        (&gap, &["--repair=no-smooth"], "no-smooth,cut"),
    ];
    for (file, more, repair) in cases {
        let output = run_of(file, &[&["--baseline", "none"], more].concat());
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        let line = text.lines().find(|line| line.starts_with("try: ")).unwrap();
        assert!(line.ends_with(&format!(" --repair {repair}")), "{line}");
        let own = summary_of(file, &["--baseline", "none", "--repair", repair]);
        assert!(fuel(&own).is_finite());
    }
}
