//! Threads, locales, clocks, and what may be missing around a process.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

use crate::sources::{Source, sources};

use super::{bin, ends, folder, made, program, same, stderr, words};

/// One thread and sixty-four, by the variable and by the option: the same bytes.
#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let dir = folder();
    for threads in ["1", "64"] {
        for (name, option) in [("variable", ""), ("option", "--threads")] {
            let line = format!("study plan.toml --quiet --format both --out {name}_{threads}");
            let mut command = program(dir.path(), &words(&line));
            if option.is_empty() {
                command.env("RAYON_NUM_THREADS", threads)
            } else {
                command.args([option, threads])
            };
            let output = command.output().unwrap();
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        }
    }
    for other in ["variable_64", "option_1", "option_64"] {
        same(&dir.path().join("variable_1"), &dir.path().join(other));
    }
}

const LINES: [&str; 7] = [
    "run --cycle minute.csv",
    "run --cycle minute.csv --json",
    "study plan.toml --json",
    "belt --points points.csv",
    "validate --chapter 8",
    "losses --format csv",
    "report made_run --json --force --out r.html",
];

/// Nothing set at all; locales with decimal commas; no home, no terminal: the same bytes as ever.
#[test]
fn bare_and_foreign_environments_change_nothing() {
    let dir = made();
    let surroundings: [&[(&str, &str)]; 5] = [
        &[],
        &[
            ("LC_ALL", "de_DE.UTF-8"),
            ("LANG", "de_DE.UTF-8"),
            ("LC_NUMERIC", "de_DE.UTF-8"),
            ("LANGUAGE", "de"),
        ],
        &[("LC_ALL", "C"), ("TERM", "")],
        &[
            ("HOME", "/nonexistent"),
            ("TERM", "dumb"),
            ("COLUMNS", "20"),
            ("TZ", "Asia/Kathmandu"),
        ],
        &[
            ("PATH", ""),
            ("USER", "\u{fc}"),
            ("PWD", "/nonexistent"),
            ("XDG_CONFIG_HOME", "/nonexistent"),
        ],
    ];
    for line in LINES {
        let report = dir.path().join("r.html");
        let plain = ends(dir.path(), line, 0).stdout;
        let page = fs::read(&report).unwrap_or_default();
        for list in surroundings {
            let mut command = Command::new(bin());
            command
                .current_dir(dir.path())
                .env_clear()
                .envs(list.iter().copied())
                .args(words(line))
                .stdin(Stdio::null());
            let output = command.output().unwrap();
            assert_eq!(
                output.status.code(),
                Some(0),
                "{line} {list:?}: {}",
                stderr(&output)
            );
            assert!(output.stdout == plain, "{line} {list:?}");
            assert!(
                fs::read(&report).unwrap_or_default() == page,
                "{line} {list:?}"
            );
        }
    }
}

/// A study without --out needs a folder of temporary files; without one it says so.
#[test]
fn no_folder_for_temporary_files_is_reported() {
    let dir = folder();
    let output = program(dir.path(), &words("study plan.toml --quiet"))
        .env("TMPDIR", "/nonexistent")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("temporary") && stderr(&output).contains("--out"),
        "{}",
        stderr(&output)
    );
    let output = program(dir.path(), &words("study plan.toml --quiet --out o"))
        .env("TMPDIR", "/nonexistent")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// A current folder that is gone is no reason to fail for what needs none.
#[test]
fn a_folder_that_is_gone_is_reported_or_not_needed() {
    for (line, code) in [
        ("run --quiet", 0),
        ("list cycles", 0),
        ("run --cycle minute.csv", 2),
        ("run --quiet --out o", 2),
    ] {
        let script = format!(
            "mkdir gone && cd gone && rmdir ../gone && exec '{}' {line}",
            bin().display()
        );
        let dir = folder();
        let output = Command::new("sh")
            .args(["-c", &script])
            .current_dir(dir.path())
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(code),
            "{line}: {}",
            stderr(&output)
        );
    }
}

/// Gives every file below a directory a time of last change.
fn dated(dir: &Path, time: SystemTime) {
    for path in super::tree(dir).keys() {
        File::options()
            .write(true)
            .open(dir.join(path))
            .unwrap()
            .set_modified(time)
            .unwrap();
    }
}

/// Files from the future and from 1971, as a clock that was set back leaves them: --resume, --force and report work as ever, and the bytes are
/// those of an undisturbed study.
#[test]
fn files_from_the_future_are_resumed_and_replaced() {
    let now = SystemTime::now();
    for time in [
        now + Duration::from_secs(80 * 365 * 86_400),
        SystemTime::UNIX_EPOCH + Duration::from_secs(400 * 86_400),
    ] {
        let dir = made();
        let path = dir.path();
        ends(path, "study plan.toml --quiet --out whole", 0);
        fs::remove_file(path.join("made_study/parts/part_00003.sha256")).unwrap();
        dated(path, time);
        ends(path, "study plan.toml --quiet --resume --out made_study", 0);
        same(&path.join("made_study"), &path.join("whole"));
        dated(&path.join("made_study"), time);
        ends(path, "study plan.toml --quiet --force --out made_study", 0);
        same(&path.join("made_study"), &path.join("whole"));
        ends(
            path,
            "run --cycle minute.csv --sensitivity never --quiet --out made_run --force",
            0,
        );
        ends(path, "report made_run --quiet", 0);
        dated(path, time);
        ends(path, "report made_run --quiet --force", 0);
    }
}

/// No other module reads the time of day; a study measures only how long it has run.
#[test]
fn results_do_not_depend_on_the_time_of_day() {
    let words = ["SystemTime", "UNIX_EPOCH", ".modified("];
    let reads = |source: &Source| words.iter().any(|word| source.code.contains(word));
    let found = sources().into_iter().filter(reads);
    let found: Vec<String> = found.map(|source| source.module).collect();
    assert_eq!(
        found,
        ["cvtcycle::commands::calibrate"],
        "the day in a fitted file"
    );
}
