//! `new`: options, a file of answers and interactive questions make the same file; all mistakes are reported at once.
//! Truth: the three ways against each other, and the ordinary reader of vehicles.

use std::fs;

use super::*;

/// Catalogue numbers of a car, as options.
const NUMBERS: [(&str, &str); 9] = [
    ("mass", "3000lb"),
    ("f0", "105"),
    ("f1", "0.55"),
    ("f2", "0.0305"),
    ("tyre", "215/55 R16"),
    ("displacement", "1.8l"),
    ("power", "104kW@6400"),
    ("torque", "172@4000"),
    ("ratio-low", "2.6"),
];
/// Minimum input for a car.
const MINIMUM: [&str; 6] = [
    "new",
    "a",
    "--displacement",
    "1.8l",
    "--power",
    "132hp@6000",
];
/// Catalogue numbers as answers, in the order of the questions; class, box and engine come first.
const ANSWERS: &str =
    "\n\n\n3000lb\n105\n0.55\n0.0305\n\n215/55 R16\n1.8l\n104kW@6400\n172@4000\n\n\n\n2.6\n";

fn options() -> Vec<String> {
    let parts = NUMBERS.iter();
    parts
        .flat_map(|(name, value)| [format!("--{name}"), (*value).to_owned()])
        .collect()
}

fn made(dir: &Path, words: &[&str], typed: &str) -> (String, String) {
    let output = program()
        .current_dir(dir)
        .args(["new", "mycar", "--force"])
        .args(words)
        .write_stdin(typed)
        .output()
        .unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{words:?}: {}",
        stderr(&output)
    );
    let text = fs::read_to_string(dir.join("mycar.toml")).unwrap();
    (text, stderr(&output))
}

#[test]
fn options_answers_and_questions_make_the_same_car() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let options = options();
    let words: Vec<&str> = options.iter().map(String::as_str).collect();
    let (by_options, quiet) = made(dir, &words, "");
    assert_eq!(quiet, "");
    for part in [
        "mass_kg = { value = 1360.77711, source = \"given: 3000lb\" }",
        "source = \"NC-1: 215/55 R16\"",
        "like = [\"class:compact_2020\", \"class:box_cvt_clutch\"]",
    ] {
        assert!(by_options.contains(part), "{part}\n{by_options}");
    }
    // Keys of a file may use TOML's underscore.
    let lines = NUMBERS.map(|(name, value)| format!("{} = \"{value}\"\n", name.replace('-', "_")));
    fs::write(
        dir.join("answers.toml"),
        format!(
            "f0 = 7 # the option holds\n{}",
            lines.concat().replace("f0 = \"105\"\n", "")
        ),
    )
    .unwrap();
    let words = ["--answers", "answers.toml", "--f0", "105"];
    assert_eq!(made(dir, &words, "").0, by_options);
    let (asked, questions) = made(dir, &["--ask"], ANSWERS);
    assert_eq!(asked, by_options);
    for part in [
        "class: compact_1995, compact_2020,",
        "mass: test mass, the driver with it: kg, lb or t [1364 kg, class compact_2020]: ",
        // Without a terminal no Enter ends the prompt's line.
        "\ndisplacement: displacement of the engine: cm3 or l [needed]: \n",
    ] {
        assert!(questions.contains(part), "{part}\n{questions}");
    }
    for words in [
        &["check", "mycar.toml"][..],
        &["run", "--vehicle", "mycar.toml", "--price", "never"],
    ] {
        let output = run_in(dir, words);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}

/// Property: coefficients in lbf are EPA's, of a coast-down in neutral, unless it is said otherwise; the answer says what was taken. Truth: `--road-load`.
#[test]
fn coefficients_in_lbf_are_of_a_coast_down_in_neutral() {
    let dir = tempfile::tempdir().unwrap();
    let words = [
        "--displacement",
        "1.8l",
        "--power",
        "104kW",
        "--f0",
        "25lbf",
        "--f1",
        "0.2lbf/mph",
        "--f2",
        "0.019lbf/mph2",
    ];
    let new = |more: &[&str]| {
        let output = run_in(
            dir.path(),
            &[&["new", "mycar", "--force"][..], &words, more].concat(),
        );
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (
            fs::read_to_string(dir.path().join("mycar.toml")).unwrap(),
            stdout(&output),
        )
    };
    let (usual, said) = new(&[]);
    let [(neutral, quiet), (body, quiet_body)] =
        ["neutral", "body"].map(|word| new(&["--road-load", word]));
    assert_eq!(usual, neutral);
    assert_ne!(usual, body);
    assert!(
        said.contains("taken for EPA's targets") && said.contains("road-load is body"),
        "{said}"
    );
    for quiet in [quiet, quiet_body] {
        assert!(!quiet.contains("road load: "), "{quiet}");
    }
    // In newtons they are of the body, which is said as well.
    let output = run_in(
        dir.path(),
        &[
            "new",
            "newton",
            "--displacement",
            "1.8l",
            "--power",
            "104kW",
            "--f0",
            "105",
        ],
    );
    assert!(
        stdout(&output).contains("taken for those of the body"),
        "{}",
        stdout(&output)
    );
    assert!(
        !fs::read_to_string(dir.path().join("newton.toml"))
            .unwrap()
            .contains("driveline_f0_n")
    );
}

/// Truth: the same car by options. A wrong answer is asked again with its reason.
#[test]
fn the_engine_and_what_the_coefficients_are_of_are_asked() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let words = [
        "--engine",
        "turbo",
        "--engine-year",
        "2012",
        "--f0",
        "25lbf",
        "--road-load",
        "body",
    ];
    let rest = ["--displacement", "1.5l", "--power", "104kW"];
    let by_options = made(dir, &[&words[..], &rest].concat(), "").0;
    let (asked, questions) = made(
        dir,
        &["--ask"],
        "\n\nturbos\nturbo\nlast year\n2012\n\n25lbf\n\n\nbody\n\n1.5l\n104kW\n",
    );
    assert_eq!(asked, by_options);
    for part in [
        "engine: technology ",
        "or measured ",
        "there is no engine named `turbos`; did you mean `turbo`?",
        "this is no year of an engine; 1980 to 2030",
        "[neutral: targets in lbf are EPA's, of coast-downs in neutral]: ",
    ] {
        assert!(questions.contains(part), "{part}\n{questions}");
    }
    // Without coefficients there is nothing to ask of them.
    let (_, questions) = made(dir, &["--ask"], "\n\n\n\n\n\n\n\n1.5l\n104kW\n");
    assert!(!questions.contains("road-load: "), "{questions}");
}

/// Truth: the fuel of FTP75 by `run` with mass 2 % up and down.
#[test]
fn the_numbers_that_matter_most_are_named_with_what_they_move() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let car = |name: &str, mass: &str| {
        let words = [
            "new",
            name,
            "--displacement",
            "1.8l",
            "--power",
            "104kW",
            "--box",
            "box_cvt_converter",
            "--mass",
            mass,
        ];
        let output = run_in(dir, &words);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stdout(&output)
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    let said = car("own", "1500");
    let fuel = |name: &str| {
        let file = format!("{name}.toml");
        let words = [
            "run",
            "--vehicle",
            &file,
            "--cycle",
            "ftp75",
            "--ambient",
            "24",
            "--baseline",
            "none",
            "--price",
            "never",
            "--json",
        ];
        let found: serde_json::Value = serde_json::from_slice(&run_in(dir, &words).stdout).unwrap();
        found["runs"][0]["weighted_fuel_l_per_100km"]
            .as_f64()
            .unwrap()
    };
    car("more", "1530");
    car("less", "1470");
    let percent = 50.0 * (fuel("more") - fuel("less")) / fuel("own");
    let part = format!("mass (2 % more) {percent:+.1} %");
    assert!(said.contains(&part), "{part}: {said}");
    assert_eq!(said.matches(" more) ").count(), 3, "{said}");
}

/// NC-18: the drag of the box is subtracted from a coast-down in neutral, that of a CVT being the larger one, and a coast-down is required.
#[test]
fn a_coast_down_in_neutral_has_the_box_in_it() {
    let dir = tempfile::tempdir().unwrap();
    let make = |name: &str, more: &[&str]| {
        let words = [
            "new",
            name,
            "--displacement",
            "1.8l",
            "--power",
            "104kW@6400",
        ];
        run_in(dir.path(), &[&words[..], more].concat())
    };
    let load = ["--f0", "105", "--f1", "0.55", "--f2", "0.0305"];
    let neutral = [&load[..], &["--road-load", "neutral"]].concat();
    let manual = [&neutral[..], &["--box", "box_manual_5"]].concat();
    let mut drags = Vec::new();
    for (name, words, taken) in [
        ("a", &load[..], false),
        ("b", &neutral, true),
        ("c", &manual, true),
    ] {
        let output = make(name, words);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = fs::read_to_string(dir.path().join(format!("{name}.toml"))).unwrap();
        let value = |key: &str| -> Option<f64> {
            let (_, rest) = text.split_once(&format!("{key} = {{ value = "))?;
            rest.split(',').next()?.parse().ok()
        };
        let names = [
            "driveline_f0_n",
            "driveline_f1_n_per_kmh",
            "driveline_f2_n_per_kmh2",
        ];
        let found: Vec<f64> = names.into_iter().filter_map(value).collect();
        assert_eq!(found.len(), if taken { 3 } else { 0 }, "{text}");
        if let [f0, f1, f2] = found[..] {
            drags.push([20.0, 110.0].map(|kmh| f0 + (f1 + f2 * kmh) * kmh));
        }
    }
    // Coast-downs of cars with both boxes: more with the CVT, and some 5 to 60 N at all speeds.
    let [cvt, manual] = drags[..] else {
        panic!("{drags:?}")
    };
    for (cvt, manual) in cvt.iter().zip(manual) {
        assert!(5.0 < manual && manual < *cvt && *cvt < 60.0, "{drags:?}");
    }
    let output = make("d", &["--road-load", "neutral"]);
    assert!(stderr(&output).contains("no coast-down to take the drag of the box from"));
}

/// A wrong answer is explained and the question repeated, also if it contradicts an earlier answer.
#[test]
fn a_wrong_answer_repeats_the_question() {
    let dir = tempfile::tempdir().unwrap();
    let wrong = ANSWERS
        .replacen("\n\n", "compactt\n\n\n", 1)
        .replace("3000lb", "3000 stone\n3000lb")
        .replace("215/55 R16\n", "55/215\n215/55 R16\n\n")
        .replace("172@4000", "60\n172@4000");
    let (text, questions) = made(dir.path(), &["--ask"], &wrong);
    for part in [
        "there is no class named `compactt`",
        "`stone` is no unit of it",
        "this is no tyre code",
        "more than the highest torque of 60 Nm",
    ] {
        assert!(questions.contains(part), "{part}\n{questions}");
    }
    assert_eq!(text, made(dir.path(), &["--ask"], ANSWERS).0);
}

#[test]
fn all_mistakes_are_reported_at_once_and_nothing_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let answers =
        "mass = \"3000 stone\"\ndisplacement = 1800\npowr = \"104kW@6400\"\nidle = true\n";
    fs::write(dir.path().join("answers.toml"), answers).unwrap();
    let words = "new mycar --answers answers.toml --final-drive 4,9 --gears 3,2 --tyre 55/215 --road-load neutrl";
    let words: Vec<&str> = words.split(' ').collect();
    let output = run_in(dir.path(), &words);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    for part in [
        "mass: `stone` is no unit of it\n --> answers.toml:1:8",
        "there is no option named `powr`\n --> answers.toml:3:1",
        "did you mean `power`?",
        "idle: expected text or a number, found a boolean\n --> answers.toml:4:8",
        "--power: the power of the engine is missing",
        "--final-drive: a number with a comma",
        "write 4.9 with a decimal point",
        "--gears: the car has a CVT",
        "--tyre: this is no tyre code",
        "--road-load: this is no kind of road load",
        "8 problems",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(!dir.path().join("mycar.toml").exists());
    for (words, part) in [
        (&["new", "../car"][..], "this is no name of a car"),
        (
            &[
                "new",
                "a",
                "--like",
                "rover_216_cvt",
                "--class",
                "compact_2020",
            ],
            "a car and a class at once",
        ),
        (
            &["new", "a", "--class", "compact"],
            "did you mean `compact_1995` or `compact_2020`?",
        ),
        (
            &["new", "a", "--like", "rover_216_cvv"],
            "did you mean `rover_216_cvt`",
        ),
        (
            &["new", "a", "--like", "mondeo"],
            "did you mean `mondeo_20_5mt`",
        ),
        // Cites the option with its unit, and omits the stroke, which depends on it.
        (
            &["new", "a", "--displacement", "1.8", "--power", "132hp@6000"],
            "--displacement: `engine.displacement_cc` is out of range\n |\n = note: 1.8; allowed: 200 to 10000 cm³\n = help: did you mean 1.8l?\n\n1 problem in",
        ),
        (
            &[
                "new",
                "a",
                "--displacement",
                "1.8l",
                "--power",
                "132 hp @ 6,000 rpm",
            ],
            "write 6.000 with a decimal point, or 6000 without a comma",
        ),
    ] {
        let output = run_in(dir.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    // An existing file is kept.
    fs::write(dir.path().join("kept.toml"), "mine").unwrap();
    let output = run_in(dir.path(), &["new", "kept", "--like", "rover_216_cvt"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        fs::read_to_string(dir.path().join("kept.toml")).unwrap(),
        "mine"
    );
    assert_eq!(stderr(&output).matches("--force").count(), 1);
}

/// US coefficients without their unit: 33.21 - 0.0887 80 + 0.02124 80^2 = 162 N at 80 km/h.
#[test]
fn a_warning_of_new_is_one_of_check_and_run() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let words = "new mycar --displacement 1.8l --power 132hp@6000 --f0 33.21 --f1 -0.0887 --f2 0.02124 --mass 3125";
    let words: Vec<&str> = words.split(' ').collect();
    let doubts = [
        "the road load is 162 N at 80 km/h, of cars of the classes 0.22 to 0.28 N per kg: are the coefficients in lbf?",
        "the mass is 3125 kg: is it in lb?",
    ];
    let made = run_in(dir, &words);
    let checked = run_in(dir, &["check", "mycar.toml"]);
    for output in [&made, &checked] {
        assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
        for doubt in doubts {
            let line = format!("doubt: {doubt}");
            assert!(
                one_line(&stdout(output)).contains(&line),
                "{}",
                stdout(output)
            );
        }
    }
    let driven = run_in(
        dir,
        &[
            "run",
            "--vehicle",
            "mycar.toml",
            "--cycle",
            "ece15",
            "--price",
            "never",
        ],
    );
    let line = format!(
        "mycar: doubt: {} (1 more: `cvtcycle check` prints them)",
        doubts[0]
    );
    assert_eq!(driven.status.code(), Some(0), "{}", stderr(&driven));
    // Printed once, though the twin has the same mass and road load.
    assert!(
        one_line(&stdout(&driven)).contains(&line),
        "{}",
        stdout(&driven)
    );
    assert_eq!(stdout(&driven).matches("doubt:").count(), 1);
}

/// The map of a pump starts at 8 bar, and gentle driving needs 2 to 8: a headline from the trace names the places outside the map.
#[test]
fn a_drive_outside_a_map_is_a_headline() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let mut map = "input_speed_rpm,secondary_pressure_bar,torque_loss_nm\n".to_owned();
    for (rpm, bar) in [(0, 8), (0, 60), (7000, 8), (7000, 60)] {
        map += &format!("{rpm},{bar},1.5\n");
    }
    fs::write(dir.join("pump.csv"), map).unwrap();
    let like = "[\"class:compact_2020\", \"class:box_cvt_clutch\"]";
    let car = format!("[vehicle]\nlike = {like}\n[transmission.cvt.maps]\npump = \"pump.csv\"\n");
    fs::write(dir.join("car.toml"), car).unwrap();
    let words = [
        "run",
        "--vehicle",
        "car.toml",
        "--cycle",
        "ece15",
        "--price",
        "never",
        "--out",
        "out",
        "--sensitivity",
        "never",
    ];
    let output = run_in(dir, &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let trace = fs::read_to_string(dir.join("out/trace_car.csv")).unwrap();
    let mut lines = trace.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|own| *own == name).unwrap();
    let (dt, bar) = (column("dt_s"), column("secondary_pressure_bar"));
    let (mut below_s, mut all_s) = (0.0, 0.0);
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let [dt_s, bar]: [f64; 2] = [dt, bar].map(|k| cells[k].parse().unwrap());
        all_s += dt_s;
        below_s += if bar < 8.0 { dt_s } else { 0.0 };
    }
    let line = format!(
        "car: pump.csv was left for {:.0} % of the time with the engine on ({below_s:.0} s), most by secondary_pressure_bar below 8;",
        100.0 * below_s / all_s
    );
    // Lines end within the name of a column, too: behind a `_`.
    let solid = |text: &str| text.split_whitespace().collect::<String>();
    let text = solid(&stdout(&output));
    assert!(
        below_s > 0.2 * all_s && text.contains(&solid(&line)),
        "{line}\n{text}"
    );
    // The same from a run without rows. No headline for a map that covers the drive.
    let again = run_in(dir, &words[..7]);
    assert!(
        solid(&stdout(&again)).contains(&solid(&line)),
        "{}",
        stdout(&again)
    );
    let whole = fs::read_to_string(dir.join("pump.csv"))
        .unwrap()
        .replace(",8,", ",0,");
    fs::write(dir.join("pump.csv"), whole).unwrap();
    let covered = run_in(dir, &words[..7]);
    assert!(
        !stdout(&covered).contains("was left"),
        "{}",
        stdout(&covered)
    );
}

/// The default box is named in a note, unless a box is given.
#[test]
fn the_default_box_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let usual = stdout(&run_in(dir.path(), &MINIMUM));
    let line = "box: box_cvt_clutch, with a wet launch clutch; most CVTs from 2010 on have a torque converter: --box box_cvt_converter\n";
    assert!(usual.contains(line), "{usual}");
    let named = [&MINIMUM[..], &["--box", "box_cvt_clutch", "--force"]].concat();
    assert!(!stdout(&run_in(dir.path(), &named)).contains("box:"));
}

/// A file name in place of another argument gets a hint with the right option.
#[test]
fn a_misplaced_file_gets_a_hint() {
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(run_in(dir.path(), &MINIMUM).status.code(), Some(0));
    let map = "# a map\ninput_speed_rpm,torque_loss_nm\n600,1\n3000,2\n";
    fs::write(dir.path().join("pump.csv"), map).unwrap();
    for (words, part) in [
        (
            &["run", "a.toml"][..],
            "a vehicle is named by an option: --vehicle a.toml",
        ),
        (&["attribute", "a.toml"], "--vehicle a.toml"),
        (&["levers", "a.toml"], "this is a vehicle"),
        (&["run", "--vehicle", "a"], "did you mean `a.toml`?"),
        (
            &["check", "pump.csv"],
            "this is a measured map of a vehicle",
        ),
        (
            &[
                "run",
                "--vehicle",
                "a.toml",
                "--set",
                "road_load.mass_kg=3125lb",
            ],
            "write 1417.48 without a unit: 3125 lb are 1417.48 kg",
        ),
        (
            &[
                "run",
                "--vehicle",
                "a.toml",
                "--set",
                "engine.start_stop=true",
            ],
            "set one of its keys: engine.start_stop.KEY=VALUE",
        ),
    ] {
        let output = run_in(dir.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(
            stderr(&output).contains(part),
            "{words:?}: {}",
            stderr(&output)
        );
    }
    let words = [
        "run",
        "--vehicle",
        "a.toml",
        "--cycle",
        "ece15",
        "--ambient",
        "-10",
        "--price",
        "never",
        "--set",
        "engine.start_stop.delay_s=0.5",
    ];
    let cold = stdout(&run_in(dir.path(), &words));
    for part in [
        "a: start-stop does not stop the engine below -5 degC of ambient",
        "a_twin: gears prescribed by the cycle",
    ] {
        assert!(cold.contains(part), "{part}\n{cold}");
    }
    let by_rule = stdout(&run_in(
        dir.path(),
        &[
            "run",
            "--vehicle",
            "a.toml",
            "--cycle",
            "sc03",
            "--price",
            "never",
        ],
    ));
    assert!(
        by_rule.contains("a_twin: shift speeds by the rule TW-3, assumed\n"),
        "{by_rule}"
    );
}
