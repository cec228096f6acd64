//! Full disks and read-only places.

use std::fs;
use std::path::Path;

use super::{WRITERS, bin, ends, folder, made, program, stderr, tree, with_mounts};

/// Runs every writing command with its output in `place`, and records code, messages, and remaining files.
fn script(place: &str, options: &str, before: &str) -> String {
    let mut text =
        format!("mkdir {place} && mount -t tmpfs -o {options} none {place} || exit 77\n{before}\n");
    for (k, line) in WRITERS.iter().enumerate() {
        let line = line.replace("OUT", &format!("{place}/out"));
        text += &format!(
            "'{}' {line} 2>message.{k} >printed.{k}; echo $? >code.{k}; find {place} -type f >left.{k}\n",
            bin().display()
        );
    }
    text + "exit 0\n"
}

fn text(dir: &Path, name: &str, k: usize) -> String {
    fs::read_to_string(dir.join(format!("{name}.{k}"))).unwrap()
}

fn refused(dir: &Path, k: usize, reason: &str) {
    let (line, message) = (WRITERS[k], text(dir, "message", k));
    assert_eq!(text(dir, "code", k).trim(), "2", "{line}: {message}");
    assert!(
        message.contains(reason) && message.contains("= help: "),
        "{line}: {message}"
    );
    assert_eq!(text(dir, "printed", k), "", "{line}");
    assert_eq!(text(dir, "left", k), "", "{line} left something");
}

/// 8 KiB hold a file or two, but no command's output: the system's message, a hint, code 2, and nothing left.
#[test]
fn a_full_disk_leaves_nothing_behind() {
    let dir = made();
    if with_mounts(dir.path(), &script("small", "size=8k", "")) {
        (0..WRITERS.len()).for_each(|k| refused(dir.path(), k, "No space left on device"));
    }
}

/// Only a study leaves its first parts on a full disk, for --resume (tests/studies/study). Here: a full disk while
/// replacing an earlier run leaves that run unchanged.
#[test]
fn a_full_disk_does_not_cost_the_earlier_run() {
    let dir = made();
    let script = format!(
        "mkdir small && mount -t tmpfs -o size=1500k none small && cp -r made_run small/run && cp -r small/run before || exit 77\n\
         dd if=/dev/zero of=small/filler bs=1k 2>/dev/null; truncate -s -24k small/filler\n\
         '{}' run --cycle minute.csv --sensitivity never --ambient 0 --quiet --out small/run --force 2>message.0; echo $? >code.0\n\
         cp -r small/run after\n",
        bin().display()
    );
    if with_mounts(dir.path(), &script) {
        assert_eq!(
            text(dir.path(), "code", 0).trim(),
            "2",
            "{}",
            text(dir.path(), "message", 0)
        );
        super::same(&dir.path().join("before"), &dir.path().join("after"));
    }
}

/// Read-only file system, for any user.
#[test]
fn a_read_only_place_is_refused() {
    let dir = made();
    if with_mounts(
        dir.path(),
        &script(
            "locked",
            "size=4m",
            "mount -o remount,ro none locked || exit 77",
        ),
    ) {
        (0..WRITERS.len()).for_each(|k| refused(dir.path(), k, "Read-only file system"));
    }
}

/// Without --out only the temporary folder is written; home and the current folder may be read-only.
#[test]
fn a_read_only_home_and_folder_are_enough_to_read() {
    let dir = folder();
    let script = format!(
        "mkdir home tmp && mount -t tmpfs -o size=4m none home && cp minute.csv plan.toml points.csv home && mount -o remount,ro none home || exit 77\n\
         export HOME=\"$PWD/home\" TMPDIR=\"$PWD/tmp\"; cd home\n\
         for line in 'run --cycle minute.csv' 'study plan.toml --quiet' 'belt --points points.csv' 'losses' 'list cycles'; do\n\
         '{}' $line >/dev/null 2>>../message.0 || echo \"$line\" >>../message.0; done\nls -A ../tmp >>../message.0; exit 0\n",
        bin().display()
    );
    if with_mounts(dir.path(), &script) {
        assert_eq!(text(dir.path(), "message", 0), "");
    }
}

/// Without --out the message does not advise --resume.
#[test]
fn a_study_that_keeps_nothing_has_no_advice_to_continue() {
    let dir = folder();
    let command = format!(
        "trap '' XFSZ; ulimit -f 2; exec '{}' study plan.toml --quiet",
        bin().display()
    );
    let output = std::process::Command::new("bash")
        .args(["-c", &command])
        .current_dir(dir.path())
        .output()
        .unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("nothing is kept without --out: name a directory on a disk with room")
            && !said.contains("--resume"),
        "{said}"
    );
}

/// A file size limit, as set by `ulimit -f`: its signal does not end the program.
#[test]
fn a_limit_to_the_size_of_files_leaves_nothing_behind() {
    let dir = made();
    for (k, line) in WRITERS.iter().enumerate() {
        let command = format!(
            "trap '' XFSZ; ulimit -f 2; exec '{}' {}",
            bin().display(),
            line.replace("OUT", "limited")
        );
        let output = std::process::Command::new("bash")
            .args(["-c", &command])
            .current_dir(dir.path())
            .output()
            .unwrap();
        let left: Vec<_> = tree(dir.path())
            .into_keys()
            .filter(|path| path.to_string_lossy().contains("limited"))
            .collect();
        assert_eq!(
            (output.status.code(), left.len()),
            (Some(2), 0),
            "{k} {line}: {} {left:?}",
            stderr(&output)
        );
        assert!(
            stderr(&output).contains("File too large"),
            "{line}: {}",
            stderr(&output)
        );
    }
}

/// Impossible places: a file in the way, or no directory.
#[test]
fn impossible_places_are_refused_with_code_2() {
    let dir = made();
    let before = tree(dir.path());
    for line in WRITERS {
        for place in ["points.csv/out", "/dev/null/out", "/proc/out"] {
            let line = line.replace("OUT", place);
            let output = program(dir.path(), &super::words(&line)).output().unwrap();
            assert_eq!(output.status.code(), Some(2), "{line}: {}", stderr(&output));
            assert!(
                output.stdout.is_empty() && stderr(&output).contains("--out"),
                "{line}: {}",
                stderr(&output)
            );
        }
    }
    assert_eq!(tree(dir.path()), before);
    ends(dir.path(), "run --cycle minute.csv --quiet", 0);
}
