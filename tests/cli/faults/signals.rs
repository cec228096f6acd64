//! Signals: an end from outside at any moment leaves whole files or none.

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::{ends, folder, made, program, same, tree, words};

const TERM: i32 = 15;
const INT: i32 = 2;
const HUP: i32 = 1;

/// True if the parent of the tests ignores a signal, and so do the children: SIGHUP under `nohup`, SIGINT in the background of a script.
fn is_ignored(number: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .map(str::trim);
    mask.and_then(|mask| u64::from_str_radix(mask, 16).ok())
        .is_some_and(|mask| (mask >> (number - 1)) & 1 == 1)
}

fn send(child: &Child, signal: &str) {
    assert!(
        Command::new("kill")
            .args([&format!("-{signal}"), &child.id().to_string()])
            .status()
            .unwrap()
            .success()
    );
}

fn parts(dir: &Path) -> usize {
    let Ok(entries) = fs::read_dir(dir.join("parts")) else {
        return 0;
    };
    entries
        .filter(|entry| {
            entry
                .as_ref()
                .unwrap()
                .file_name()
                .to_string_lossy()
                .ends_with(".sha256")
        })
        .count()
}

/// SIGTERM and SIGHUP to a study end it at once, by the signal (143 and 129 in a shell); SIGINT at the next run, with 130 (tests/studies/study).
/// Whole parts are kept, and --resume ends with the bytes of an undisturbed study.
#[test]
fn a_study_that_is_ended_is_resumed_to_the_same_bytes() {
    let dir = folder();
    let plan = super::PLAN.replace("samples = 120", "samples = 4000");
    fs::write(dir.path().join("plan.toml"), plan).unwrap();
    ends(dir.path(), "study plan.toml --quiet --out whole", 0);
    for (signal, number) in [("TERM", TERM), ("HUP", HUP)] {
        let out = dir.path().join(signal);
        let line = format!("study plan.toml --quiet --threads 1 --out {signal}");
        let mut child = program(dir.path(), &words(&line)).spawn().unwrap();
        while parts(&out) < 2 && child.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(1));
        }
        send(&child, signal);
        let status = child.wait().unwrap();
        if is_ignored(number) {
            // It goes on, as under `nohup`.
            assert_eq!(status.code(), Some(0), "{signal}");
            same(&dir.path().join("whole"), &out);
            continue;
        }
        assert_eq!(status.signal(), Some(number), "{signal}");
        assert!(
            (2..32).contains(&parts(&out)),
            "{signal}: {} parts",
            parts(&out)
        );
        ends(
            dir.path(),
            &format!("study plan.toml --quiet --resume --out {signal}"),
            0,
        );
        same(&dir.path().join("whole"), &out);
    }
}

/// A run and a report that are ended at many moments: a file under a final name is whole and that of an undisturbed one; where the mark
/// exists, all of them do; and the same command works afterwards.
#[test]
fn what_is_ended_leaves_whole_files_or_none() {
    let dir = made();
    let lines = [
        (
            "run --cycle minute.csv --sensitivity never --quiet --out",
            "cut",
            "summary.json",
        ),
        ("validate --chapter 8 --quiet --out", "cut", "summary.json"),
        (
            "losses --ratio low --speed 1000..4000:250 --temp 25,80 --quiet --out",
            "cut",
            "summary.json",
        ),
    ];
    for (line, name, mark) in lines {
        let out = dir.path().join(name);
        // What the line before left; there is nothing at first.
        drop(fs::remove_dir_all(&out));
        ends(dir.path(), &format!("{line} {name}"), 0);
        let whole: Vec<_> = tree(&out)
            .into_iter()
            .filter(|(path, _)| path.as_os_str() != "inputs.json")
            .collect();
        let (mut cut, mut done) = (0, 0);
        for moment in 0..40_u64 {
            fs::remove_dir_all(&out).unwrap();
            let mut child = program(dir.path(), &words(&format!("{line} {name}")))
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            sleep(Duration::from_millis(5 * moment));
            let (signal, number) = if moment % 2 == 0 || is_ignored(INT) {
                ("TERM", TERM)
            } else {
                ("INT", INT)
            };
            // It may have ended by itself.
            drop(
                Command::new("kill")
                    .args([&format!("-{signal}"), &child.id().to_string()])
                    .stderr(Stdio::null())
                    .status(),
            );
            let status = child.wait().unwrap();
            assert!(
                status.code() == Some(0) || status.signal() == Some(number),
                "{line}: {status}"
            );
            if status.code() == Some(0) {
                done += 1
            } else {
                cut += 1
            };
            if !out.exists() {
                fs::create_dir(&out).unwrap();
            }
            let left = tree(&out);
            for (path, bytes) in &whole {
                assert!(
                    left.get(path).is_none_or(|now| now == bytes),
                    "{line}: {} is another",
                    path.display()
                );
                assert!(
                    left.contains_key(path) || !left.contains_key(Path::new(mark)),
                    "{line}: {} is missing",
                    path.display()
                );
            }
        }
        eprintln!("{line}: ended {cut} times, came to its own end {done} times");
        assert!(cut > 0);
        fs::remove_dir_all(&out).unwrap();
        ends(dir.path(), &format!("{line} {name}"), 0);
    }
}
