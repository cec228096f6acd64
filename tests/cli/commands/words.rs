//! First lines of a run: contradicted published numbers, and the confidence of differences.

use super::*;
use cvtcycle::analysis::draws::prepare;
use cvtcycle::analysis::known::draw;
use cvtcycle::analysis::words::intervals::{CASES, line};
use cvtcycle::config::Override;
use cvtcycle::study::plan::Plan;
use cvtcycle::validate::{COMMON, CandidateVehicle, Computed, Verdict, embedded_rows, judge, read};

/// Words of a run of a case, without prices.
fn case_words<'a>(
    cars: &[&'a str],
    cycle: &'a str,
    ambient: &'a str,
    start: &'a str,
) -> Vec<&'a str> {
    let mut words = vec![
        "run",
        "--vehicle",
        cars[0],
        "--cycle",
        cycle,
        "--ambient",
        ambient,
    ];
    words.extend(["--start", start, "--price", "never"]);
    let baseline = cars.get(1).copied().unwrap_or("none");
    words.extend(["--baseline", baseline]);
    words
}

/// Replaces line breaks by spaces.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Truth: `validate`, which computes each row by its own expression. A row that names its run is contradicted by that run, with the same
/// number, exactly if the row differs, and the text of the run says so.
#[test]
fn every_row_that_differs_is_in_the_text_of_its_run() {
    let files: Vec<(String, String)> = embedded_rows()
        .iter()
        .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
        .collect();
    let files = read(COMMON, &files).unwrap();
    let candidate = CandidateVehicle {
        vehicle: "rover_216_cvt".to_owned(),
        ..CandidateVehicle::default()
    };
    let report = judge(&files, &candidate, |row| row.about.is_some()).unwrap();
    assert!(report.rows.len() >= 11, "{}", report.rows.len());
    let mut differing = 0;
    for judged in &report.rows {
        let (id, about) = (&judged.row.id, judged.row.about.as_ref().unwrap());
        let ambient = about.ambient_degc.to_string();
        let cars: Vec<&str> = [Some(about.subject.as_str()), about.baseline.as_deref()]
            .into_iter()
            .flatten()
            .collect();
        let words = case_words(&cars, &about.cycle, &ambient, &about.start);
        let found = json(&[&words[..], &["--json"]].concat());
        let none = Vec::new();
        let said = found["contradicted"].as_array().unwrap_or(&none);
        let own = said.iter().find(|row| row["row"] == *id);
        let differs = judged.verdict == Verdict::Differs;
        assert_eq!(own.is_some(), differs, "{id}: {said:?}");
        let Some(own) = own else { continue };
        differing += 1;
        let Some(Computed::Number(computed)) = &judged.computed else {
            panic!("{id} is no number");
        };
        let of_run = own["computed"].as_f64().unwrap();
        assert!(
            (of_run - computed).abs() < 1e-6 * computed.abs(),
            "{id}: {of_run} {computed}"
        );
        let text = flat(&stdout(&run(&words)));
        let row = format!("row {id} of `cvtcycle validate`");
        assert!(
            text.contains(&row) && text.contains(&flat(&judged.row.printed_text)),
            "{text}"
        );
    }
    assert!(differing >= 4, "{differing}");
}

/// A changed car has no published numbers to contradict, nor does a file with the same values under another name.
#[test]
fn a_changed_car_contradicts_nothing() {
    let words = case_words(&["rover_216_cvt", "rover_216_5mt"], "ftp75", "24", "soak");
    let said =
        |more: &[&str]| json(&[&words[..], &["--json"], more].concat())["contradicted"].clone();
    assert!(said(&[]).as_array().is_some_and(|rows| rows.len() == 1));
    for more in [
        ["--set", "transmission.cvt.belt.band_offset_mm=2"],
        ["--set-all", "engine.electrical_w=250"],
        ["--lubricant", "dexron_ii"],
        ["--dt", "0.5"],
        ["--formulation", "chapter_8"],
    ] {
        assert!(said(&more).is_null(), "{more:?}: {}", said(&more));
    }
    // Setting a value to its current one changes nothing.
    let same = said(&["--set", "transmission.cvt.belt.band_offset_mm=3"]);
    assert!(
        same.as_array().is_some_and(|rows| rows.len() == 1),
        "{same}"
    );
    // Valid up to 5 K away, and not at 6 K.
    let at = |degc| case_words(&["rover_216_cvt", "rover_216_5mt"], "ftp75", degc, "soak");
    let rows = |degc| json(&[&at(degc)[..], &["--json"]].concat())["contradicted"].clone();
    assert!(rows("29").is_array() && rows("30").is_null());
}

/// Truth: the same draws repeated. Every case of the file is found by a run.
#[test]
fn intervals_equal_those_of_the_draws() {
    let case = CASES[1];
    assert_eq!(draw(case).unwrap(), format!("{}\n", line(case).unwrap()));
    for case in CASES {
        let line = line(case).unwrap_or_else(|| panic!("{case:?} is not in the file"));
        let cells: Vec<&str> = line.split(',').collect();
        let (cycle, ambient, start) = case;
        let ambient = ambient.to_string();
        let words = case_words(&["rover_216_cvt", "rover_216_5mt"], cycle, &ambient, start);
        let found = json(&[&words[..], &["--json"]].concat());
        let of = &found["comparison"][0]["interval"];
        assert_eq!(of["draws"].to_string(), cells[7], "{case:?}: {found}");
        assert_eq!(
            of["percent"][2].as_f64().unwrap().to_string(),
            cells[11].parse::<f64>().unwrap().to_string()
        );
        // The car of the files lies among the possible ones.
        let own = found["comparison"][0]["fuel_percent"].as_f64().unwrap();
        let [low, high] = [0, 2].map(|k| of["percent"][k].as_f64().unwrap());
        assert!(
            low - 2.0 < own && own < high + 2.0,
            "{case:?}: {own} of {low} to {high}"
        );
    }
    let words = case_words(
        &["rover_216_cvt", "rover_216_5mt"],
        "ece15_eudc",
        "-10",
        "soak",
    );
    let text = flat(&stdout(&run(&words)));
    let cells: Vec<String> = line(CASES[1])
        .unwrap()
        .split(',')
        .map(str::to_owned)
        .collect();
    let whole = |k: usize| match cells[k].parse::<f64>().unwrap().round() {
        0.0 => "0".to_owned(),
        x => format!("{x:+.0}"),
    };
    let inputs = format!(
        "; uncertain inputs alone {} to {} %, more in {} of {} runs)",
        whole(9),
        whole(11),
        cells[8],
        cells[7]
    );
    assert!(
        text.contains(" than rover_216_5mt (90 % range -") && text.contains(&inputs),
        "{inputs}: {text}"
    );
    let changed = [&words[..], &["--set", "engine.electrical_w=250"]].concat();
    let text = flat(&stdout(&run(&changed)));
    // Measured cars tell, and few of them in the cold.
    assert!(text.contains("by the error of the model on "), "{text}");
    assert!(!text.contains("(no interval)"), "{text}");
    assert!(
        text.contains("gets an interval of its own from --draws 256"),
        "{text}"
    );
}

/// Places of "5.3 % more than", "less than", "+5.3 % at", "over the twin" and the like, each with what follows.
fn differences<'a>(text: &'a str, marks: &[&str]) -> Vec<&'a str> {
    let mut found = Vec::new();
    for mark in marks {
        for (place, _) in text.match_indices(mark) {
            let end = text[place..].char_indices().nth(120);
            found.push(&text[place..end.map_or(text.len(), |(k, _)| place + k)]);
        }
    }
    found
}

/// True if a range follows: "-6 to +10 %".
fn has_range(text: &str) -> bool {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_number = |word: &str| {
        let word = word.trim_start_matches(['(', '-', '+']);
        word.starts_with(|c: char| c.is_ascii_digit())
    };
    words
        .windows(4)
        .any(|w| is_number(w[0]) && w[1] == "to" && is_number(w[2]) && w[3].starts_with('%'))
}

/// Property: of a car without measurements of its own every difference to another car is printed with a range, in all commands. Ranges of parts of a cycle are
/// wider than those of the whole.
#[test]
fn no_difference_of_an_own_car_is_without_its_range() {
    let dir = tempfile::tempdir().unwrap();
    let run_here = |words: &[&str]| {
        let output = run_in(dir.path(), words);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{words:?}: {}",
            stderr(&output)
        );
        flat(
            &stdout(&output)
                .replace(['\u{2212}'], "-")
                .replace('\u{a0}', " "),
        )
    };
    let engine = [
        "--displacement",
        "2.0l",
        "--power",
        "125kW",
        "--mass",
        "1400",
    ];
    run_here(
        &[
            &[
                "new",
                "own",
                "--box",
                "box_cvt_converter",
                "--n-over-v",
                "19.5",
            ][..],
            &engine,
        ]
        .concat(),
    );
    let twin = ["--baseline", "twin"];
    let run_text = run_here(
        &[
            &[
                "run",
                "--vehicle",
                "own.toml",
                "--cycle",
                "wltp",
                "--price",
                "never",
                "--out",
                "a",
            ][..],
            &twin,
        ]
        .concat(),
    );
    let other = [
        "run",
        "--vehicle",
        "c_segment_20_6mt",
        "--baseline",
        "none",
        "--cycle",
        "wltp",
        "--price",
        "never",
    ];
    run_here(&[&other[..], &["--out", "b"]].concat());
    run_here(&["report", "a", "--format", "md", "--out", "report.md"]);
    let report = fs::read_to_string(dir.path().join("report.md")).unwrap();
    let report = flat(&report.replace('\u{2212}', "-").replace('\u{a0}', " "));
    let page_1 = report.split("## Results").next().unwrap();
    let texts = [
        ("run", run_text.clone(), 5),
        ("report", page_1.to_owned(), 1),
        (
            "study ambient",
            run_here(&[
                "study",
                "ambient",
                "--vehicle",
                "own.toml",
                "--start",
                "soak",
            ]),
            1,
        ),
        (
            "study",
            run_here(
                &[
                    &[
                        "study",
                        "uncertainty_rover",
                        "--samples",
                        "2",
                        "--vehicle",
                        "own.toml",
                    ][..],
                    &twin,
                ]
                .concat(),
            ),
            1,
        ),
        ("compare", run_here(&["compare", "b", "a"]), 0),
    ];
    let marks = [
        " % more than",
        " % less than",
        " % more",
        "The difference is",
        "over own_twin: ",
        ", medium ",
        ", high ",
        ", extra_high ",
        "whole cycle ",
    ];
    for (name, text, least) in &texts {
        let found = differences(text, &marks);
        let found: Vec<&&str> = found.iter().filter(|near| near.contains(" %")).collect();
        assert!(found.len() >= *least, "{name}: {text}");
        for near in found {
            // Of draws, the next sentence has that of measured cars.
            let is_draws = near.starts_with("The difference is")
                && text.contains("by the error of the model on");
            assert!(has_range(near) || is_draws, "{name}: {near}");
        }
        assert!(
            text.contains("error of the model") || text.contains("In brackets: 90 % range"),
            "{name}: {text}"
        );
    }
    // Fuel of levers; a change of the same car has the interval of its draws, or says that it has none.
    let levers = |samples: &str| {
        run_here(&[
            "levers",
            "--vehicle",
            "own.toml",
            "--only",
            "variable_pump",
            "--combine",
            "none",
            "--samples",
            samples,
        ])
    };
    assert!(levers("0").contains("(without draws no interval)"));
    for samples in ["0", "2"] {
        assert!(
            levers(samples).contains("by the error of the model on 65 measured cars"),
            "{samples}"
        );
    }
    run_here(&[&["whatif", "own.toml"][..], &twin].concat());
    let page = fs::read_to_string(dir.path().join("whatif.html")).unwrap();
    let page = page.replace('\u{2212}', "-").replace('\u{a0}', " ");
    // The sentences; the figures below them have the terms of the computed difference.
    let (_, page) = page.split_once("id=\"live-answer\"").unwrap();
    let page = page.split("<figure").next().unwrap();
    let near = differences(
        page,
        &[" less than own twin", " more than own twin", " as own twin"],
    );
    assert!(
        !near.is_empty() && near.iter().all(|near| has_range(&flat(near))),
        "{near:?}"
    );
    // Shipped cars have intervals of their own, or measured ones.
    let shipped = flat(&stdout(&run(&case_words(
        &["rover_216_cvt", "rover_216_5mt"],
        "ece15_eudc",
        "-10",
        "soak",
    ))));
    assert!(!shipped.contains("such cars"), "{shipped}");
    // FS-4 and FS-5 by the table of the spread: with twins the first bag is the widest part, 30.1 points, and HWFET the wider whole, 23.4.
    let width = |mark: &str| {
        let rest = &run_text[run_text.find(mark).unwrap()..];
        let rest = rest.split_once('(').unwrap().1.split_once(" %").unwrap().0;
        let ends: Vec<f64> = rest.split(" to ").map(|x| x.parse().unwrap()).collect();
        ends[1] - ends[0]
    };
    assert!(
        (width("over own_twin: low ") - 30.1).abs() < 1.2,
        "{run_text}"
    );
    assert!((width("whole cycle ") - 23.4).abs() < 1.2, "{run_text}");
}

/// Truth: the embedded intervals, made from the draws of the same plan. The relative ranges of the plan's own cars give the same values except for
/// rounding.
#[test]
fn draws_of_a_run_give_the_known_interval() {
    let words = case_words(
        &["rover_216_cvt", "rover_216_5mt"],
        "ece15_eudc",
        "-10",
        "soak",
    );
    let interval = |more: &[&str]| {
        json(&[&words[..], more, &["--json"]].concat())["comparison"][0]["interval"].clone()
    };
    let (known, drawn) = (interval(&[]), interval(&["--draws", "256"]));
    for key in ["draws", "more", "plan"] {
        assert_eq!(known[key], drawn[key]);
    }
    for k in 0..3 {
        let [known, drawn] = [&known, &drawn].map(|of| of["percent"][k].as_f64().unwrap());
        assert!((known - drawn).abs() < 6e-4, "{known} {drawn}");
    }
}

/// Property: a car never differs from itself. Against a smaller pump, the draws agree.
#[test]
fn two_cvts_have_the_same_draw() {
    let of = |more: &[&str]| {
        let words = [
            "run",
            "--cycle",
            "ece15",
            "--baseline",
            "rover_216_cvt",
            "--draws",
            "8",
            "--price",
            "never",
        ];
        json(&[&words[..], more, &["--json"]].concat())["comparison"][0]["interval"].clone()
    };
    let same = of(&[]);
    assert!(
        (0..3).all(|k| same["percent"][k].as_f64().unwrap().abs() < 1e-9),
        "{same}"
    );
    // Also with a manual car in the same run, whose uncertain values differ from those of the CVTs.
    let with_manual = of(&["--baseline", "rover_216_5mt"]);
    assert!(
        (0..3).all(|k| with_manual["percent"][k].as_f64().unwrap().abs() < 1e-9),
        "{with_manual}"
    );
    let smaller = of(&["--set", "transmission.cvt.pump.displacement_cc_rev*=0.82"]);
    let [low, high] = [0, 2].map(|k| smaller["percent"][k].as_f64().unwrap());
    assert!(-1.5 < low && low < high && high < -0.2, "{smaller}");
}

/// Property: values set by the user for all cars of a factor are certain, also if set as a list. Values set for the subject only
/// leave the others uncertain.
#[test]
fn values_set_by_the_user_are_certain() {
    let factors = |set: &[&str], set_all: &[&str]| -> Vec<String> {
        let mut base = Plan::open("uncertainty_rover").unwrap().base;
        base.set = Override::parse_all(set).unwrap();
        base.set_all = Override::parse_all(set_all).unwrap();
        let study = prepare(&base, 2).unwrap();
        let factors = study.plan.factors.iter();
        factors.map(|factor| factor.key.clone()).collect()
    };
    let all = factors(&[], &[]);
    let without = |gone: &str| {
        all.iter()
            .filter(|key| *key != gone)
            .cloned()
            .collect::<Vec<_>>()
    };
    let mass = "road_load.mass_kg";
    assert_eq!(factors(&[], &["road_load.mass_kg=1130"]), without(mass));
    assert_eq!(factors(&["road_load.mass_kg=1130"], &[]), all);
    assert_eq!(factors(&[], &["road_load.mass_kg*=1.1"]), all);
    let pump = "transmission.cvt.pump.displacement_cc_rev";
    assert!(all.iter().any(|key| key == pump), "{all:?}");
    assert_eq!(
        factors(&["transmission.cvt.pump.displacement_cc_rev=8"], &[]),
        without(pump)
    );
}

/// Truth: the draws of a car that misses its trace in some of them. Pairs that cannot be driven are left out and counted.
#[test]
fn draws_that_fail_are_left_out_and_counted() {
    let dir = tempfile::tempdir().unwrap();
    let weak = [
        "new",
        "weak",
        "--mass",
        "1300",
        "--displacement",
        "1.4l",
        "--power",
        "92kW",
        "--box",
        "box_cvt_converter",
    ];
    assert_eq!(run_in(dir.path(), &weak).status.code(), Some(0));
    let car = dir.path().join("weak.toml");
    let words = [
        "run",
        "--vehicle",
        car.to_str().unwrap(),
        "--baseline",
        "rover_216_5mt",
        "--cycle",
        "us06",
        "--start",
        "warm",
        "--draws",
        "16",
        "--price",
        "never",
    ];
    let found = json(&[&words[..], &["--json"]].concat());
    let of = &found["comparison"][0]["interval"];
    let [draws, left_out] = ["draws", "left_out"].map(|key| of[key].as_u64().unwrap());
    assert_eq!(draws + left_out, 16, "{of}");
    assert!(left_out > 0, "{of}");
    let text = flat(&stdout(&run(&words)));
    assert!(text.contains(&format!("; {left_out} left out)")), "{text}");
    let text = refused(&["run", "--baseline", "none", "--draws", "8"]);
    assert!(text.contains("--draws: there is no baseline"), "{text}");
}
