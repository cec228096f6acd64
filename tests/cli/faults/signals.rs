//! Signals: killed at any moment, a command leaves all files or none.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::tree::parts;

use super::{ends, folder, made, program, same, stderr, tree, words};

const TERM: i32 = 15;
const INT: i32 = 2;
const HUP: i32 = 1;

/// True if the tests' parent ignores a signal, and therefore the children: SIGHUP under `nohup`, SIGINT in the background of a script.
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

/// SIGTERM and SIGHUP end a study at once, by the signal (143 and 129 in a shell); SIGINT at the next run, with 130 (tests/studies/study).
/// Complete parts are kept, and --resume gives the bytes of an undisturbed study.
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
            // Ignores SIGHUP, as under `nohup`.
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

/// Commands that write a set of files, and an option that changes the set.
const SETS: [(&str, &str); 3] = [
    (
        "run --cycle minute.csv --sensitivity never --quiet --out cut",
        " --ambient 0",
    ),
    ("validate --chapter 8 --quiet --out cut", ""),
    (
        "losses --ratio low --speed 1000..4000:250 --temp 25,80 --quiet --out cut",
        " --torque 5",
    ),
];

/// Contents of a folder without the record, which contains the command line.
fn set(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = if dir.exists() {
        tree(dir)
    } else {
        BTreeMap::new()
    };
    files.remove(Path::new("inputs.json"));
    files
}

/// Kills commands at many moments, in a new folder and over an earlier set. The folder then has the files of an undisturbed command, or the
/// earlier ones, or a journal of a pending commit. The same command with --force works at once, and leaves no hidden file.
#[test]
fn a_killed_command_leaves_all_files_or_none() {
    let dir = made();
    let out = dir.path().join("cut");
    for (line, other) in SETS {
        let all = |line: &str| {
            drop(fs::remove_dir_all(&out));
            ends(dir.path(), line, 0);
            (set(&out), tree(&out))
        };
        let (earlier, files) = all(&format!("{line}{other}"));
        let began = Instant::now();
        let (whole, _) = all(line);
        // Moments from the start to a quarter beyond the end of an undisturbed command, whatever the build and the machine.
        let moments = began.elapsed() / 32;
        let (mut cut, mut done) = (0, 0);
        for moment in 0..40_u32 {
            drop(fs::remove_dir_all(&out));
            let replaces = moment % 4 > 1;
            if replaces {
                fs::create_dir(&out).unwrap();
                for (name, bytes) in &files {
                    fs::write(out.join(name), bytes).unwrap();
                }
            }
            let command = format!("{line}{}", if replaces { " --force" } else { "" });
            let mut child = program(dir.path(), &words(&command))
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            sleep(moments * moment);
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
            let mut left = set(&out);
            let hidden = left.clone();
            left.retain(|name, _| !name.to_string_lossy().starts_with(".cvtcycle-"));
            let is_halfway = hidden.contains_key(Path::new(".cvtcycle-commit.json"));
            match status.code() {
                Some(_) => assert!(
                    left == whole && left == hidden,
                    "{line}: {:?}",
                    hidden.keys()
                ),
                None => assert!(
                    is_halfway
                        || left == whole
                        || left
                            == if replaces {
                                earlier.clone()
                            } else {
                                BTreeMap::new()
                            },
                    "{line}: {:?}",
                    hidden.keys()
                ),
            }
            if status.code() == Some(0) {
                done += 1;
            } else {
                cut += 1;
                if moment % 5 == 0 {
                    ends(dir.path(), &format!("{line} --force"), 0);
                    assert!(set(&out) == whole, "{line}: {:?}", set(&out).keys());
                }
            }
        }
        eprintln!("{line}: ended {cut} times, came to its own end {done} times");
        assert!(cut > 0);
    }
}

/// Two commands start in one new folder at once: one writes all its files, the other is refused.
#[test]
fn a_second_command_in_the_same_folder_is_refused() {
    let dir = made();
    for (line, other) in SETS {
        let out = dir.path().join("cut");
        for moment in 0..6_u64 {
            drop(fs::remove_dir_all(&out));
            let lines = [line.to_owned(), format!("{line}{other}")];
            let children = lines.each_ref().map(|line| {
                let child = program(dir.path(), &words(line))
                    .stderr(Stdio::piped())
                    .spawn();
                sleep(Duration::from_millis(moment));
                child.unwrap()
            });
            let outputs = children.map(|child| child.wait_with_output().unwrap());
            let mut codes = outputs.each_ref().map(|output| output.status.code());
            let winner = usize::from(codes[0] != Some(0));
            codes.sort_unstable();
            assert_eq!(codes, [Some(0), Some(2)], "{line}");
            let said = stderr(&outputs[1 - winner]);
            assert!(
                said.contains("another process is writing in") || said.contains("earlier run"),
                "{said}"
            );
            let left = set(&out);
            drop(fs::remove_dir_all(&out));
            ends(dir.path(), &lines[winner], 0);
            assert!(left == set(&out), "{line}: {:?}", left.keys());
        }
    }
}
