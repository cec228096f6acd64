//! Files of the output directory, both streams, colours.

use super::*;

#[test]
fn files_appear_together_and_are_not_overwritten() {
    let dir = tempfile::tempdir().unwrap();
    let words = [
        "run",
        "--cycle",
        "ece15",
        "--baseline",
        "rover_216_5mt",
        "--out",
        "cold",
    ];
    let output = run_in(dir.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let names = "summary.json inputs.json fuel_comparison.svg trace_rover_216_cvt.csv driveline_rover_216_cvt.svg pressure_rover_216_cvt.svg \
        temperatures_rover_216_cvt.svg losses_rover_216_cvt.svg operating_points_rover_216_cvt.svg trace_rover_216_5mt.csv \
        driveline_rover_216_5mt.svg temperatures_rover_216_5mt.svg losses_rover_216_5mt.svg operating_points_rover_216_5mt.svg";
    let out = dir.path().join("cold");
    for name in names.split_whitespace() {
        assert!(out.join(name).is_file(), "{name}");
    }
    assert!(stdout(&output).contains("\nFiles written in cold: 14\n"));
    assert_eq!(
        fs::read_dir(&out).unwrap().count(),
        names.split_whitespace().count()
    );
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["cycle"], "ece15");
    let trace = fs::read_to_string(out.join("trace_rover_216_cvt.csv")).unwrap();
    assert_eq!(trace.lines().count(), 196);
    let before = fs::read(out.join("summary.json")).unwrap();
    let again = run_in(dir.path(), &[&words[..], &["--ambient", "0"]].concat());
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("--force"), "{}", stderr(&again));
    assert_eq!(fs::read(out.join("summary.json")).unwrap(), before);
    let forced = run_in(
        dir.path(),
        &[&words[..], &["--ambient", "0", "--force", "--json"]].concat(),
    );
    assert_eq!(forced.status.code(), Some(0), "{}", stderr(&forced));
    assert_eq!(fs::read(out.join("summary.json")).unwrap(), forced.stdout);
}

#[test]
fn nothing_is_left_after_a_failure() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("file"), "").unwrap();
    let message = stderr(&run_in(dir.path(), &["run", "--out", "file/below"]));
    assert!(message.contains("--out"), "{message}");
    let output = run_in(
        dir.path(),
        &["run", "--out", "new/run", "--vehicle", "no_such_car"],
    );
    assert_eq!(output.status.code(), Some(2));
    let left: Vec<_> = fs::read_dir(dir.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left, ["file"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported() {
    for words in [
        &["run"][..],
        &["list", "cycles"],
        &["--help"],
        &["assumptions"],
    ] {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("cvtcycle"));
        let output = command
            .args(words)
            .stdout(full)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
            .wait_with_output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(
            stderr(&output).contains("standard output: cannot write"),
            "{}",
            stderr(&output)
        );
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    for words in [&["assumptions"][..], &["run"], &["--help"]] {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("cvtcycle"));
        let mut child = command
            .args(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            (output.status.code(), stderr(&output)),
            (Some(0), String::new()),
            "{words:?}"
        );
    }
}

#[test]
fn colours_are_on_for_terminals_or_by_option() {
    let coloured = |words: &[&str], no_color: bool| {
        let mut command = program();
        if no_color {
            command.env("NO_COLOR", "1");
        }
        let output = command.args(words).output().unwrap();
        (stdout(&output) + &stderr(&output)).contains('\u{1b}')
    };
    for words in [
        &["run"][..],
        &["--help"],
        &["run", "--cycle", "x"],
        &["list", "vehicles"],
        &["--nonsense"],
    ] {
        assert!(
            !coloured(words, false) && !coloured(words, true),
            "{words:?}"
        );
        assert!(
            !coloured(&[words, &["--color", "never"]].concat(), false),
            "{words:?}"
        );
    }
    for words in [
        &["run", "--color=always"][..],
        &["run", "--color", "always", "--help"],
        &["--color=always", "run", "--cycle", "x"],
    ] {
        assert!(coloured(words, true), "{words:?}");
    }
    assert!(!coloured(&["run", "--json", "--color=always"], false));
}

/// Hidden characters of every kind in files and on the command line. Streams contain no escape codes except the program's own styles, and JSON
/// preserves the text.
#[test]
fn hidden_characters_reach_no_stream() {
    let hidden = "\u{1b}]0;x\u{7}\u{1b}[8m\u{7f}\u{9b}\u{85}\u{202e}\u{2066}\u{2028}\u{feff}\u{fdd1}\u{fdd2}end";
    let escaped: String = hidden
        .encode_utf16()
        .map(|unit| format!("\\u{unit:04x}"))
        .collect();
    let dir = tempfile::tempdir().unwrap();
    let car = include_str!("../../../vehicles/rover_216_5mt.toml");
    let title = "Rover 216, 1.6 L, 5-speed manual";
    assert!(car.contains(title));
    let car = car.replace(title, &format!("T{escaped}"));
    fs::write(dir.path().join("car.toml"), car).unwrap();
    fs::write(
        dir.path().join("plan.toml"),
        format!(
            "[study]\ntitle = \"T{escaped}\"\nquestion = \"Q{escaped}\"\nvehicle = \"car.toml\"\ncycle = \"ece15\"\n\
             [study.design.monte_carlo]\nsamples = 20\n[[factor]]\nname = \"F{escaped}\"\nkey = \"engine.electrical_w\"\nstatus = \"assumed\"\n\
             source = \"S{escaped}\"\ndistribution.uniform = {{ low = 100, high = 500 }}\n"
        ),
    )
    .unwrap();
    let word = format!("W{}", hidden.replace('\u{7}', ""));
    let lines: [&[&str]; 8] = [
        &["show", "./car.toml"],
        &[
            "run",
            "--vehicle",
            "car.toml",
            "--cycle",
            "ece15",
            "--baseline",
            "none",
        ],
        &["losses", "--vehicle", "car.toml"],
        &["study", "plan.toml", "--out", "study", "--force"],
        &["study", "show", "study"],
        &["run", "--cycle", &word],
        &["run", &word],
        &["check", &word],
    ];
    let whole = serde_json::json!(hidden).to_string();
    let mut same = 0;
    for (k, line) in lines.iter().enumerate() {
        for more in [&[][..], &["--json"], &["--color", "always"]] {
            let output = run_in(dir.path(), &[*line, more].concat());
            let code = if k < 5 { 0 } else { 2 };
            assert_eq!(
                output.status.code(),
                Some(code),
                "{line:?}: {}",
                stderr(&output)
            );
            for text in [stdout(&output), stderr(&output)] {
                let mut plain = text.clone();
                if more.len() == 2 {
                    // Allows the escape codes `m` of the program's styles and of the renderers of help and problems.
                    let mut pieces = text.split("\u{1b}[");
                    plain = pieces.next().unwrap().to_owned();
                    for piece in pieces {
                        let (code, rest) = piece.split_once('m').unwrap();
                        assert!(
                            code.bytes().all(|b| b.is_ascii_digit() || b == b';') && code != "8"
                        );
                        plain += rest;
                    }
                }
                let found = plain.chars().find(|c| cvtcycle::config::is_hidden(*c));
                assert!(found.is_none(), "{line:?} {more:?}: {found:?} in {text}");
            }
            if more == ["--json"] {
                let value: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
                same += usize::from(value.to_string().contains(whole.trim_matches('"')));
            }
        }
    }
    assert!(same > 0, "JSON has the title as it is");
}
