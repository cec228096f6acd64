//! Threads, locales, clocks, and missing parts of the environment.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

use crate::sources::{Source, sources};

use super::{bin, ends, folder, made, program, same, stderr, words};

/// One and sixty-four threads, by variable and by option, give the same bytes.
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

/// Commands that compute in parallel, with output `OUT`.
const PARALLEL: [&str; 6] = [
    "run --cycle minute.csv --baseline none --sensitivity always --quiet --out OUT",
    "study plan.toml --quiet --out OUT",
    "study plan.toml --quiet --threads 1 --out OUT",
    "study show made_study",
    "report made_study --quiet --out OUT.html",
    "calibrate fit.toml --no-folds --quiet --out OUT",
];

/// If no thread can be started, as in a container with a process limit, the main thread computes the same bytes, with a warning.
#[test]
fn without_further_threads_the_main_one_computes() {
    let dir = made();
    let fit = "[calibration]\nvehicle = \"rover_216_cvt\"\n[sources.g]\nsource = \"bench\"\nratio = 1\nspeed_rpm = [1000, 3000]\n\
        temp_degc = 80\n[[parameter]]\nkey = \"transmission.cvt.pump.displacement_cc_rev\"\nlow = 5\nhigh = 20\n[[data]]\n\
        from = \"a test\"\ncompute = \"max(g: pump_nm)\"\nvalue = 2\nsd = 0.1\n";
    fs::write(dir.path().join("fit.toml"), fit).unwrap();
    let strace = |line: &str| {
        let mut command = Command::new("strace");
        let inject = ["clone", "clone3"].map(|call| format!("inject={call}:error=EAGAIN"));
        command
            .current_dir(dir.path())
            .args(["-f", "-qq", "-o", "calls.txt", "-e", "trace=clone,clone3"])
            .args(["-e", &inject[0], "-e", &inject[1]])
            .arg(bin())
            .args(words(line))
            .env("RAYON_NUM_THREADS", "4");
        command.output()
    };
    let works = strace("--version").is_ok_and(|output| output.status.success());
    assert!(
        works || std::env::var_os("CVTCYCLE_REQUIRE_STRACE").is_none(),
        "strace does not work here"
    );
    if !works {
        eprintln!("skipped: strace does not work here");
        return;
    }
    for line in PARALLEL {
        // Same command line in both, because the record of a run contains it.
        let line = line.replace("OUT", "made_now");
        let away = |to: &str| {
            for name in ["made_now", "made_now.html", "made_now_figures"] {
                let from = dir.path().join(name);
                if from.exists() {
                    fs::rename(from, dir.path().join(to).join(name)).unwrap();
                }
            }
        };
        for folder in ["with", "without"] {
            drop(fs::remove_dir_all(dir.path().join(folder)));
            fs::create_dir(dir.path().join(folder)).unwrap();
        }
        let with = program(dir.path(), &words(&line))
            .env("RAYON_NUM_THREADS", "4")
            .output()
            .unwrap();
        assert!(
            [Some(0), Some(1)].contains(&with.status.code()),
            "{line}: {}",
            stderr(&with)
        );
        away("with");
        let without = strace(&line).unwrap();
        away("without");
        let said = stderr(&without);
        assert_eq!(without.status.code(), with.status.code(), "{line}: {said}");
        let warned =
            said.contains("cannot start threads: ") && said.contains("; one thread computes");
        assert_eq!(warned, !line.contains("--threads"), "{line}: {said}");
        assert!(without.stdout == with.stdout, "{line}");
        same(&dir.path().join("with"), &dir.path().join("without"));
    }
    // An explicit number of threads is not reduced.
    let output = strace("study plan.toml --quiet --threads 2 --out refused").unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("--threads: cannot start threads"),
        "{}",
        stderr(&output)
    );
    assert!(!dir.path().join("refused").exists());
}

/// The variable has the limits of the option, and is checked before work starts.
#[test]
fn the_variable_of_threads_is_bounded() {
    let dir = made();
    for value in ["99999", "0", "x", "-1"] {
        for line in [
            "run --cycle minute.csv --quiet --out refused",
            "study plan.toml --quiet --out refused",
            "study show made_study",
            "report made_run --quiet",
        ] {
            let mut command = program(dir.path(), &words(line));
            let output = command.env("RAYON_NUM_THREADS", value).output().unwrap();
            let said = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{line}: {said}");
            assert!(
                said.contains(&format!("RAYON_NUM_THREADS: `{value}` is "))
                    && said.contains("1 to 1024"),
                "{line}: {said}"
            );
        }
        assert!(!dir.path().join("refused").exists());
    }
    let mut command = program(dir.path(), &words("study plan.toml --quiet --threads 2"));
    let output = command.env("RAYON_NUM_THREADS", "x").output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
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

/// An empty environment, locales with decimal commas, no home and no terminal give the same bytes.
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

/// A study without --out needs a temporary folder, and reports a missing one.
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

/// A deleted current folder is an error only for commands that need it.
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

/// Sets the modification time of all files below a directory.
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

/// Files from the future and from 1971, as left by a clock that was set back: --resume, --force and report work, and the bytes equal
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

/// No other module reads the time of day. A study measures its duration only.
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
