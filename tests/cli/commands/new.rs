//! `new`: options, a file of answers and questions make the same file; every mistake at once.
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
    ("power", "104@6400"),
    ("torque", "172@4000"),
    ("ratio-low", "2.6"),
];
/// The same as answers, in the order of the questions; before them class and box.
const ANSWERS: &str =
    "\n\n3000lb\n105\n0.55\n0.0305\n215/55 R16\n1.8l\n104@6400\n172@4000\n\n\n\n2.6\n";

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
    let lines = NUMBERS.map(|(name, value)| format!("{name} = \"{value}\"\n"));
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
        "displacement: displacement of the engine: cm3 or l [needed]: ",
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

/// A wrong answer is explained and the question comes again; an answer that contradicts one before it too.
#[test]
fn a_wrong_answer_is_asked_for_again() {
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
    let answers = "mass = \"3000 stone\"\ndisplacement = 1800\npowr = \"104@6400\"\nidle = true\n";
    fs::write(dir.path().join("answers.toml"), answers).unwrap();
    let words = "new mycar --answers answers.toml --final-drive 4,9 --gears 3,2 --tyre 55/215";
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
        "--final-drive: a ratio has no unit, not `,9`",
        "--gears: the car has a CVT",
        "--tyre: this is no tyre code",
        "7 problems",
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
    ] {
        let output = run_in(dir.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    // A file that exists is kept.
    fs::write(dir.path().join("kept.toml"), "mine").unwrap();
    let output = run_in(dir.path(), &["new", "kept", "--like", "rover_216_cvt"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        fs::read_to_string(dir.path().join("kept.toml")).unwrap(),
        "mine"
    );
}
