//! Identifying word of a run: the same in all files of equal runs, another one if an input differs.

use super::*;

/// Commands with JSON results, and for each an option that changes the run. tests/results/report and tests/studies cover the other files of
/// runs and studies.
const COMMANDS: [(&str, &str); 5] = [
    ("losses --ratio low --speed 2000", "--temp 81"),
    (
        "losses --ratio low --speed 2000 --temp 60",
        "--set transmission.cvt.pump.constant_nm=0.2",
    ),
    (
        "rig variator --ratio low --pressure 20 --torque 10",
        "--pulses 61",
    ),
    (
        "rig transmission --test strip_down --speed 2000",
        "--temp 60",
    ),
    ("validate --chapter 8", "--held-out"),
];

fn word(object: &Value) -> String {
    object["run"].as_str().unwrap().to_owned()
}

fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

#[test]
fn equal_runs_have_one_word_and_other_runs_another() {
    let dir = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for (number, (line, other)) in COMMANDS.iter().enumerate() {
        let name = number.to_string();
        let line = format!("{line} --json");
        let (stdout, other) = (
            json(&words(&line)),
            json(&words(&format!("{line} {other}"))),
        );
        let line = [words(&line), vec!["--out", name.as_str()]].concat();
        assert!(run_in(dir.path(), &line).status.success(), "{line:?}");
        let file = fs::read(dir.path().join(&name).join("summary.json")).unwrap();
        let file: Value = serde_json::from_slice(&file).unwrap();
        assert_eq!(word(&file), word(&stdout), "{line:?}");
        all.extend([word(&stdout), word(&other)]);
    }
    assert!(all.iter().all(|word| word.len() == 16));
    let different: std::collections::BTreeSet<_> = all.iter().collect();
    assert_eq!(different.len(), all.len(), "{all:?}");
}

/// Two cars with the same name whose files differ in one value that no other part of the object contains.
#[test]
fn a_value_of_the_car_makes_another_word() {
    let dir = tempfile::tempdir().unwrap();
    let shipped = include_str!("../../../vehicles/rover_216_5mt.toml");
    let word_with = |own: &str| {
        let text = shipped.replace(
            "neutral_share = { value = 0.2",
            &format!("neutral_share = {{ {own}"),
        );
        fs::write(dir.path().join("own.toml"), text).unwrap();
        let output = run_in(
            dir.path(),
            &words("losses --vehicle own.toml --gear 3 --json"),
        );
        assert!(output.status.success(), "{}", stderr(&output));
        word(&serde_json::from_slice(&output.stdout).unwrap())
    };
    let share = word_with("value = 0.5");
    assert_eq!(share, word_with("value = 0.50"));
    assert_ne!(share, word_with("value = 0.6"));
}
