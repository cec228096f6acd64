//! `levers`: tables, files, resuming, refused options.

use super::*;

const SHORT_STUDY: &str = "levers --only variable_pump,offset_2mm --cycle ece15 --samples 8";

/// Files of a folder by name.
fn files(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let entries = fs::read_dir(dir).unwrap().map(Result::unwrap);
    let entries = entries.filter(|entry| entry.path().is_file());
    let mut files: Vec<_> = entries
        .map(|entry| {
            let bytes = fs::read(entry.path()).unwrap();
            (name(entry), bytes)
        })
        .collect();
    files.sort();
    files
}

#[test]
fn tables_and_files_of_levers() {
    let dir = tempfile::tempdir().unwrap();
    let line = format!("{SHORT_STUDY} --ambient -10,25 --out found");
    let output = run_in(dir.path(), &words(&line));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "8 paired runs with the uncertain values of embedded:uncertainty_rover.toml varied",
        "rover_216_cvt at -10 degC",
        "rover_216_cvt at 25 degC",
        "variable pump saves most",
        "8 of 8",
        "Together (variable_pump + offset_2mm)",
        "What they take",
        "control of displacement",
        "note: 8 varied runs that agree show no more than that 63 % of all do",
        "levers.csv",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let found = dir.path().join("found");
    let csv = fs::read_to_string(found.join("levers.csv")).unwrap();
    assert_eq!(csv.lines().count(), 7, "{csv}");
    let json: Value =
        serde_json::from_slice(&fs::read(found.join("levers.json")).unwrap()).unwrap();
    let first = &json["blocks"][0]["rows"][0];
    assert_eq!(first["name"], "variable_pump");
    assert_eq!(first["saves"]["k"], 8);
    assert!(first["fuel_percent"]["value"].as_f64().unwrap() < -1.0);
    assert_eq!(
        json["blocks"][1]["rows"][2]["members"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
    // The folder is a study, which `study show` recognises as levers.
    let shown = run_in(dir.path(), &["study", "show", "found"]);
    let head = |text: &str| text.lines().take(12).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(head(&stdout(&shown)), head(&text));
}

/// Truth: the numbers of `levers.json`. Reports of levers, and of a run with levers, print the savings.
#[test]
fn a_report_of_levers_prints_their_savings() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let done = |line: &str| {
        let output = run_in(dir, &words(line));
        assert_eq!(output.status.code(), Some(0), "{line}: {}", stderr(&output));
    };
    done(&format!("{SHORT_STUDY} --ambient -10,25 --out found"));
    done("run --cycle ece15 --baseline none --price never --out car");
    done("report found --format md --out levers.md");
    done("report car --with found --format md --out car.md");
    let json = fs::read(dir.join("found/levers.json")).unwrap();
    let json: Value = serde_json::from_slice(&json).unwrap();
    for file in ["levers.md", "car.md"] {
        let text = fs::read_to_string(dir.join(file)).unwrap();
        assert!(!text.contains("no pair of good runs"), "{file}: {text}");
        assert!(!text.contains("of another case"), "{file}: {text}");
        for block in json["blocks"].as_array().unwrap() {
            for row in block["rows"].as_array().unwrap() {
                let median = row["fuel_percent"]["value"].as_f64().unwrap();
                let title = row["title"].as_str().unwrap();
                let rows = text
                    .lines()
                    .map(|line| line.replace("**", "").replace('\u{a0}', " "));
                let cells = rows.filter_map(|line| {
                    let cell = line.strip_prefix(&format!("| {title} | \u{2212}"))?;
                    Some(cell.split(' ').next()?.to_owned())
                });
                // Equal to the first digit of its interval.
                let is_median = |cell: String| {
                    let decimals = cell.split_once('.').map_or(0, |(_, after)| after.len());
                    format!("{:.decimals$}", -median) == cell
                };
                assert!(cells.into_iter().any(is_median), "{title} {median}: {text}");
            }
        }
    }
    for (block, ambient) in [(0, "-10"), (1, "25")] {
        let svg = format!("found/levers_rover_216_cvt_{ambient}.svg");
        let svg = fs::read_to_string(dir.join(svg)).unwrap();
        let rows = json["blocks"][block]["rows"].as_array().unwrap();
        let saved = |row: &Value| -row["fuel_percent"]["value"].as_f64().unwrap();
        let together = rows
            .iter()
            .find(|row| row["kind"] == "combination")
            .unwrap();
        let title = format!(
            "Variable pump saves most: {:.1} % of the fuel; the combination of changes {:.1} %",
            saved(&rows[0]),
            saved(together)
        );
        assert!(svg.contains(&title), "{title}");
        assert!(svg.contains("8 of 8"));
    }
}

/// Property: an interrupted study of levers resumes to the same bytes with another number of threads.
#[test]
fn interrupted_levers_resume_to_the_same_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let at = |rest: &str| {
        words(&format!("{SHORT_STUDY} {rest}"))
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
    };
    let go = |rest: &str| {
        let line = at(rest);
        let line: Vec<&str> = line.iter().map(String::as_str).collect();
        let output = run_in(dir.path(), &line);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stdout(&output)
    };
    go("--threads 1 --out whole");
    go("--threads 4 --out half");
    let (whole, half) = (dir.path().join("whole"), dir.path().join("half"));
    assert_eq!(files(&whole), files(&half));
    // Simulates an interruption: some parts and all results are missing.
    for (name, _) in files(&half.join("parts")) {
        if name.contains("3") || name.contains("5") {
            fs::remove_file(half.join("parts").join(name)).unwrap();
        }
    }
    for name in ["levers.json", "levers.csv"] {
        fs::remove_file(half.join(name)).unwrap();
    }
    let text = go("--threads 3 --out half --resume");
    assert!(text.contains("8 of 8"), "{text}");
    assert_eq!(files(&whole), files(&half));
    assert_eq!(files(&whole.join("parts")), files(&half.join("parts")));
    let other = run_in(
        dir.path(),
        &words(&format!("{SHORT_STUDY} --seed 2 --out half --resume")),
    );
    assert_eq!(other.status.code(), Some(2));
    assert!(
        stderr(&other).contains("is another one"),
        "{}",
        stderr(&other)
    );
}

#[test]
fn levers_without_draws_say_so() {
    let text = stdout(&run(&words(
        "levers --only variable_pump --cycle ece15 --samples 0",
    )));
    assert!(text.contains("as their files have them"), "{text}");
    assert!(!text.contains("0 of"), "{text}");
    let none = json(&words(
        "levers --only variable_pump --cycle ece15 --plan none --json",
    ));
    assert_eq!(none["plan"], Value::Null);
    assert_eq!(none["blocks"][0]["rows"].as_array().unwrap().len(), 1);
}

#[test]
fn options_of_levers_are_refused_all_at_once() {
    let line = "levers --only variable_pumps --samples 1 --ambient 99 --cycle ece51 --nvh-rpm 1 --plan uncertainty_rovers";
    let text = refused(&words(line));
    for part in [
        "there is no lever named `variable_pumps`",
        "did you mean `variable_pump`?",
        "one draw tells nothing",
        "--ambient",
        "there is no cycle named `ece51`",
        "--nvh-rpm",
        "did you mean `uncertainty_rover`?",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let text = refused(&words("levers --combine none --combine a+b"));
    assert!(
        text.contains("`none` together with a combination"),
        "{text}"
    );
    let text = refused(&words("levers cvt cvt"));
    assert!(text.contains("is in embedded:cvt.toml as well"), "{text}");
    let text = refused(&words("levers --combine variable_pump+dual_cavity_pump"));
    assert!(
        text.contains("variable_pump and dual_cavity_pump do not go together"),
        "{text}"
    );
    let text = refused(&words("levers manual"));
    assert!(text.contains("is for cars with a manual gearbox"), "{text}");
    let text = refused(&words("levers --only offset_2mm --without offset_2mm"));
    assert!(text.contains("no lever is left"), "{text}");
}

#[test]
fn a_lever_file_is_checked_and_has_a_schema() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(
        dir.path().join("own.toml"),
        "[[lever]]\nname = \"lighter\"\nset = [\"road_load.mass_kg*=0.9\"]\n",
    )
    .unwrap();
    let output = run_in(dir.path(), &["check", "own.toml", "manual"]);
    assert_eq!(
        stdout(&output),
        "ok  own.toml (levers)\nok  manual (levers)\n"
    );
    let schema = json(&["schema", "levers"]);
    assert!(schema["properties"]["lever"]["items"]["properties"]["set"].is_object());
    assert!(stdout(&run(&["explain", "lever.set"])).contains("what is changed"));
    let output = run_in(
        dir.path(),
        &words("levers own.toml --cycle ece15 --samples 4"),
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("lighter"));
    let text = refused(&["show", "manual"]);
    assert!(text.contains("a file of levers"), "{text}");
}

/// The Rover's plan also works for another car and its twin. Truth: no choice for the manual box of the plan reaches the twin, whose gears follow
/// from its car, and no draw is refused.
#[test]
fn a_plan_serves_another_car() {
    let dir = tempfile::tempdir().unwrap();
    let text =
        "[vehicle]\ntitle = \"another\"\nlike = \"rover_216_cvt\"\n[road_load]\nmass_kg = 1400\n";
    fs::write(dir.path().join("own.toml"), text).unwrap();
    let line =
        "study uncertainty_rover --samples 2 --vehicle own.toml --baseline twin --yes --json";
    let output = run_in(dir.path(), &words(line));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["cars"], serde_json::json!(["own", "own_twin"]));
    assert_eq!(json["runs"]["not_run"], 0);
}

/// A pressure cap of 3 bar cannot clamp the belt. Failing draws are a result and not a failed command. Without draws, or for a car that fails by itself, the
/// exit code is 1.
#[test]
fn a_failing_lever_saves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let file = "[[lever]]\nname = \"soft\"\nset = [\"transmission.cvt.pressure.cap_bar=6\"]\n";
    fs::write(dir.path().join("own.toml"), file).unwrap();
    let line = "levers own.toml --cycle ftp75 --samples 8 --combine none";
    let output = run_in(dir.path(), &words(line));
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for part in [
        "L/100 km in the median of 8 runs with uncertain values varied; no lever saves fuel.",
        "soft does not work in this car: gross_slip",
        "in 8 of 8 runs.",
        "soft !8",
        "note: 8 of 16 runs fail a check and are left out: 6 x gross_slip, 2 x the smallest pressure is above",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(!text.contains("It is open"), "{text}");
    let nominal = run_in(
        dir.path(),
        &words("levers own.toml --cycle ftp75 --samples 0"),
    );
    assert_eq!(nominal.status.code(), Some(1));
    assert!(stdout(&nominal).contains("soft does not work in this car: gross_slip."));
    let car = "[vehicle]\nlike = \"rover_216_cvt\"\n[transmission.cvt.pressure]\ncap_bar = 6\n";
    fs::write(dir.path().join("car.toml"), car).unwrap();
    let line =
        "levers --only offset_2mm --vehicle car.toml --cycle ftp75 --samples 8 --combine none";
    let failed = run_in(dir.path(), &words(line));
    assert_eq!(failed.status.code(), Some(1), "{}", stdout(&failed));
    assert!(stdout(&failed).contains("In 8 of 8 runs the car as it is fails by gross_slip"));
}
