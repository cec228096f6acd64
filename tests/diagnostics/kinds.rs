//! Reads each kind of bad file and returns the message.
//!
//! A bad vehicle or rig file contains bad lines only, as dotted keys. Missing keys are appended from the shipped file
//! named in the first line (`# on NAME`), so that the bad lines keep their numbers.

use cvtcycle::analysis::levers::{Combine, Lever, LeverFile, LeverRequest, prepare};
use cvtcycle::calibrate;
use cvtcycle::config::csv::Columns;
use cvtcycle::config::cycle::{self, Cycle};
use cvtcycle::config::procedure::Procedure;
use cvtcycle::config::setup::{self, Options};
use cvtcycle::config::{Document, KeyInfo, Override, Problem, Problems, Reader, render};
use cvtcycle::output::History;
use cvtcycle::report::cover::Cover;
use cvtcycle::study::Study;
use cvtcycle::study::plan::Plan;
use cvtcycle::validate;

use super::calibration;

/// Kinds of bad files.
pub const KINDS: [&str; 17] = [
    "vehicle",
    "like",
    "lubricant",
    "rig",
    "plan",
    "levers",
    "test",
    "rows",
    "cover",
    "cycle",
    "map",
    "points",
    "trace",
    "calibration",
    "calibration_points",
    "calibration_trace",
    "calibration_scalars",
];

/// Message of the program about a bad file; empty if it accepts the file.
pub fn message(kind: &str, case: &str) -> String {
    let bytes = std::fs::read(case).unwrap();
    let name = case.rsplit('/').next().unwrap();
    if kind == "points" {
        return points(case);
    }
    if name.starts_with("ran_") {
        return calibration::ran(case);
    }
    let problems = match kind {
        "calibration" => calibrate::open(case).err(),
        "calibration_points" | "calibration_trace" | "calibration_scalars" => {
            calibration::data(kind, case)
        }
        "vehicle" => return vehicle(case, &String::from_utf8(bytes).unwrap()),
        "like" if name.starts_with("twin_") => {
            setup::load(&setup::baseline_of(case, setup::TWIN), &Options::default()).err()
        }
        "like" => setup::load(case, &Options::default()).err(),
        "rig" => rig(case, &String::from_utf8(bytes).unwrap()),
        "lubricant" => setup::load_lubricant(case).err(),
        "plan" => Plan::open(case).and_then(Study::prepare).err(),
        "levers" => levers(case).err(),
        "test" => Procedure::open(case).err(),
        "rows" => rows(case, &bytes),
        "cover" => Cover::read(case).err(),
        "cycle" => cycle(case, &bytes).err(),
        "map" => map(case, name),
        "trace" => History::read_csv(case, &bytes).err(),
        _ => unreachable!("{kind}"),
    };
    render(&problems.unwrap_or_default(), false)
}

/// A comment `# --columns LIST` in the first line gives the columns.
fn cycle(case: &str, bytes: &[u8]) -> Result<Cycle, Problems> {
    let text = String::from_utf8_lossy(bytes);
    let list = text
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("# --columns "));
    match list.map(Columns::parse).transpose()? {
        Some(columns) => cycle::read_columns(case, bytes, &columns),
        // As a table of a cycle: what is no table of one is read as a log, whose refusals are in tests/cli/commands/log.rs.
        None => cycle::read_csv(case, bytes),
    }
}

/// Builds a study of the Rover with the levers of a file, without draws.
fn levers(case: &str) -> Result<Study, Problems> {
    let named = |lever| Lever {
        is_named: true,
        ..lever
    };
    prepare(&LeverRequest {
        levers: LeverFile::open(case)?
            .levers
            .into_iter()
            .map(named)
            .collect(),
        vehicles: vec!["rover_216_cvt".to_owned()],
        ambients_degc: vec![25.0],
        cycle: "constant_50".to_owned(),
        start: "soak".to_owned(),
        dt_s: 1.0,
        base: Options::default(),
        set_all: Vec::new(),
        others: Vec::new(),
        draws: None,
        combine: Combine::None,
        heard_rpm: 1300.0,
    })
}

fn rows(case: &str, bytes: &[u8]) -> Option<Problems> {
    let text = match cvtcycle::config::decode(case, bytes) {
        Ok(text) => text,
        Err(problems) => return Some(problems),
    };
    validate::read(
        ("embedded:common.toml", validate::COMMON.1),
        &[(case.to_owned(), text)],
    )
    .err()
}

fn points(case: &str) -> String {
    let output = assert_cmd::Command::cargo_bin("cvtcycle")
        .unwrap()
        .args(["belt", "--points", case])
        .output()
        .unwrap();
    assert_eq!(
        output.status.code(),
        Some(2),
        "{case}: {}",
        String::from_utf8_lossy(&output.stdout)
    );
    assert!(output.stdout.is_empty(), "{case}");
    String::from_utf8(output.stderr).unwrap()
}

/// The first word of a map's name is the part that it replaces. A comment `# --columns LIST` in the first line, in a script `% --columns LIST`,
/// gives the columns.
fn map(case: &str, name: &str) -> Option<Problems> {
    let (vehicle, key) = match name.split('_').next() {
        Some("bsfc") => ("rover_216_cvt", "engine.model.bsfc_map.file"),
        Some("shift") => ("rover_216_cvt", "transmission.cvt.ratio.shift_map"),
        Some("pressure") => ("rover_216_cvt", "transmission.cvt.clamp.table.file"),
        Some("whole" | "scattered") => ("rover_216_cvt", "transmission.cvt.maps.box"),
        Some("box") => ("rover_216_5mt", "transmission.manual.maps.box"),
        _ => ("rover_216_cvt", "transmission.cvt.maps.belt"),
    };
    let bytes = std::fs::read(case).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let columns = text.lines().next().and_then(|line| {
        line.trim_start_matches(['#', '%'])
            .strip_prefix(" --columns ")
    });
    let value = match columns {
        Some(columns) => format!("{{ value = {case:?}, columns = {columns:?} }}"),
        None => case.to_owned(),
    };
    setup::load(
        vehicle,
        &Options {
            set: [
                (key, &*value),
                ("transmission.cvt.maps.box_points", "scattered"),
            ]
            .into_iter()
            .take(if name.starts_with("scattered") { 2 } else { 1 })
            .map(|(key, value)| Override::new(key, value).unwrap())
            .collect(),
            ..Options::default()
        },
    )
    .err()
}

fn vehicle(case: &str, text: &str) -> String {
    let base = setup::load(base(text), &Options::default())
        .unwrap_or_else(|problems| panic!("{problems:?}"));
    let own = base
        .keys
        .iter()
        .filter(|info| !info.key.starts_with("lubricant.") && !info.key.starts_with("engine_oil."));
    // A separate folder, because the reader resolves names of files there.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("car.toml");
    std::fs::write(&path, completed(text, own)).unwrap();
    let tables = std::path::Path::new(case).with_file_name("tables");
    std::fs::create_dir(folder.path().join("tables")).unwrap();
    for entry in std::fs::read_dir(tables).unwrap() {
        let entry = entry.unwrap();
        let to = folder.path().join("tables").join(entry.file_name());
        std::fs::copy(entry.path(), to).unwrap();
    }
    let path = path.to_str().unwrap();
    let problems = setup::load(path, &Options::default())
        .err()
        .unwrap_or_default();
    within(case, text, &problems);
    render(&problems, false).replace(path, case)
}

fn rig(case: &str, text: &str) -> Option<Problems> {
    let (_, keys) = cvtcycle::config::rig::load(&[]).unwrap();
    let document = match Document::parse(case, &completed(text, keys.iter())) {
        Ok(document) => document,
        Err(problems) => return Some(problems),
    };
    let reader = Reader::new(&document);
    let _ = cvtcycle::config::rig::read(&reader.root());
    let problems = reader.finish().err().unwrap_or_default();
    within(case, text, &problems);
    Some(problems)
}

/// Asserts that messages are about the bad file, since the shipped file may change for other reasons.
fn within(case: &str, text: &str, problems: &[Problem]) {
    let beyond: Vec<&Problem> = problems
        .iter()
        .filter(|problem| problem.place.line > text.lines().count())
        .collect();
    assert!(
        beyond.is_empty(),
        "{case}: write these lines into the bad file, too: {beyond:#?}"
    );
}

fn base(text: &str) -> &str {
    text.lines()
        .next()
        .and_then(|line| line.strip_prefix("# on "))
        .unwrap_or("rover_216_cvt")
}

/// Appends all keys that the bad lines do not set.
fn completed<'k>(text: &str, keys: impl Iterator<Item = &'k KeyInfo>) -> String {
    let given: Vec<&str> = text
        .lines()
        .filter_map(|line| {
            line.trim_start_matches("#without ")
                .split(['=', ' '])
                .next()
        })
        .collect();
    let under = |key: &str, table: &str| !table.is_empty() && key.starts_with(&format!("{table}."));
    let touched = |key: &str| {
        given
            .iter()
            .any(|own| key == *own || under(key, own) || under(own, key))
    };
    let keys: Vec<&KeyInfo> = keys.filter(|info| !touched(&info.key)).collect();
    let chosen = |info: &KeyInfo| {
        keys.iter().any(|other| {
            other
                .key
                .starts_with(&format!("{}.{}.", info.key, info.value))
        })
    };
    let mut whole = text.to_owned();
    for info in &keys {
        if !info.value.is_empty() && !chosen(info) {
            whole += &format!("{} = {}\n", info.key, written(info));
        }
    }
    whole
}

/// Writes a value as in a file.
pub fn written(info: &KeyInfo) -> String {
    let is_text = info.allowed.starts_with("text") || info.allowed.starts_with("one of ");
    if is_text {
        format!("{:?}", info.value)
    } else {
        info.value.clone()
    }
}

/// Bad files that are too large to be kept, or that need every column of a trace: name and message.
pub fn made(kind: &str) -> Vec<(String, String)> {
    match kind {
        "trace" => traces(),
        "plan" => {
            let plan = |design: &str, factors: usize, values: &str| {
                let factor =
                    |k: usize| format!("[[factor]]\nkey = \"a.b{k}\"\nvalues = {values}\n");
                format!(
                    "[study.design.{design}\n{}",
                    (0..factors).map(factor).collect::<String>()
                )
            };
            let case = |name: &str, text: String| {
                (
                    format!("made_{name}"),
                    rendered(Plan::read(name, &text).err()),
                )
            };
            vec![
                case(
                    "too_many_factors.toml",
                    plan("sobol]\nsamples = 4", 257, "[0, 1]"),
                ),
                case("too_many_points.toml", plan("grid]", 32, "[0, 1, 2, 3]")),
            ]
        }
        "cycle" => {
            let text: String = std::iter::once("time_s,speed_kmh\n".to_owned())
                .chain((0..=2_000_000).map(|k| format!("{k},0\n")))
                .collect();
            let read = |path: &str, bytes: &[u8]| rendered(cycle::read_csv(path, bytes).err());
            let columns = format!("time_s,speed_kmh{}\n0,0\n", ",".repeat(999));
            let line = format!("time_s,speed_kmh\n0,0\n1,{}\n", "1".repeat(1 << 20));
            vec![
                made_file("too_many_rows.csv", text.as_bytes(), read),
                made_file("too_many_columns.csv", columns.as_bytes(), read),
                made_file("long_line.csv", line.as_bytes(), read),
            ]
        }
        "lubricant" => {
            let read = |path: &str, _: &[u8]| rendered(setup::load_lubricant(path).err());
            vec![
                made_file(
                    "too_many_tables.toml",
                    "[a]\n".repeat(20_001).as_bytes(),
                    read,
                ),
                made_file(
                    "too_many_keys.toml",
                    "a = 1\n".repeat(100_001).as_bytes(),
                    read,
                ),
                made_file("too_large.toml", &[b'#'; (1 << 20) + 1], read),
            ]
        }
        "map" => {
            let text = format!("ratio,torque_loss_nm\n{}", "1,1\n".repeat(1_000_001));
            vec![made_file(
                "belt_too_many_rows.csv",
                text.as_bytes(),
                |path, _| rendered(map(path, "belt_")),
            )]
        }
        _ if kind.starts_with("calibration") => calibration::made(kind),
        "points" => {
            let text = format!(
                "ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm\n{}",
                "1".repeat(1 << 21)
            );
            vec![made_file("long_line.csv", text.as_bytes(), |path, _| {
                points(path)
            })]
        }
        "cover" => {
            let text = b"logo = \"logo.png\"\n";
            vec![made_file("large_logo.toml", text, |path, _| {
                std::fs::write(
                    path.replace("large_logo.toml", "logo.png"),
                    vec![0; 500_001],
                )
                .unwrap();
                rendered(Cover::read(path).err())
            })]
        }
        _ => Vec::new(),
    }
}

pub fn rendered(problems: Option<Problems>) -> String {
    render(&problems.unwrap_or_default(), false)
}

/// Reads a file in a temporary folder, and removes the folder's path from the message.
pub fn made_file(
    name: &str,
    bytes: &[u8],
    read: impl Fn(&str, &[u8]) -> String,
) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(&path, bytes).unwrap();
    let text = read(&path, bytes);
    (
        format!("made_{name}"),
        text.replace(&format!("{}/", folder.path().to_str().unwrap()), ""),
    )
}

/// Traces with one mistake each; their columns are those of the program.
fn traces() -> Vec<(String, String)> {
    use cvtcycle::output::{table::Scope, trace::COLUMNS};
    let names: Vec<&str> = COLUMNS
        .iter()
        .filter(|column| column.scope != Scope::Cvt)
        .map(|column| &*column.name)
        .collect();
    let row = |time: &str, dt: &str, flags: &str, other: &str| {
        let cell = |name: &&str| match *name {
            "time_s" => time.to_owned(),
            "dt_s" => dt.to_owned(),
            "flags" => flags.to_owned(),
            "phase" => "all".to_owned(),
            _ => other.to_owned(),
        };
        names.iter().map(cell).collect::<Vec<_>>().join(",")
    };
    let head = names.join(",");
    let one = |name: &str, lines: &[String]| {
        let text = lines.join("\n") + "\n";
        let path = format!("made_{name}.csv");
        (
            path.clone(),
            rendered(History::read_csv(&path, text.as_bytes()).err()),
        )
    };
    let good = row("1", "1", "", "0");
    vec![
        one(
            "good_but_twice",
            &[format!("{head},time_s"), format!("{good},1")],
        ),
        one("no_rows", std::slice::from_ref(&head)),
        one(
            "missing_column",
            &[head.replace("dt_s,", ""), good.replacen("1,", "", 1)],
        ),
        one(
            "time_falls",
            &[head.clone(), good.clone(), row("0.5", "1", "", "0")],
        ),
        one("no_length", &[head.clone(), row("1", "0", "", "0")]),
        one("empty_time", &[head.clone(), row("", "1", "", "0")]),
        one("bad_number", &[head.clone(), row("1", "fast", "", "0")]),
        one(
            "unknown_flag",
            &[
                head.clone(),
                row("1", "1", "hurry", "0"),
                row("2", "1", "overrun|", "0"),
            ],
        ),
        one("short_row", &[head.clone(), "1,2,3".to_owned()]),
        one("too_many_phases", &many_phases(head, &good)),
    ]
}

/// Trace with one phase for each step.
fn many_phases(head: String, row: &str) -> Vec<String> {
    let row = |k: usize| {
        row.replacen("1,", &format!("{k},"), 1)
            .replacen(",all", &format!(",phase {k}"), 1)
    };
    std::iter::once(head).chain((1..=201).map(row)).collect()
}

/// Bad plans of the plan reader's own tests: name and text.
pub fn plans_of_the_reader() -> impl Iterator<Item = (String, String)> {
    let plans = include_str!("../plans/bad.txt").split("====\n").skip(1);
    let text: String = plans
        .map(|plan| {
            render(
                &Plan::read("bad.txt", plan).err().unwrap_or_default(),
                false,
            ) + "\n"
        })
        .collect();
    std::iter::once(("all_of_bad.txt".to_owned(), text))
}
