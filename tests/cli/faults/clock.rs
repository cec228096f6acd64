//! The clock: nothing that is written or decided depends on it.

use std::fs::{self, File};
use std::path::Path;
use std::time::{Duration, SystemTime};

use crate::sources::{Source, sources};

use super::{ends, made, same};

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
        ["cvtcycle::commands::calibrate::date"],
        "the day in a fitted file"
    );
}
