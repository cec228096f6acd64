//! Interrupted studies are finished to the same bytes.

use std::fs;
use std::path::Path;
use std::thread;

use cvtcycle::config::{ProblemKind, Setting};
use cvtcycle::output::BUILD;
use cvtcycle::study::store::{Study, StudyDir};
use serde_json::Value;
use tempfile::TempDir;

use super::{PLAN, files, manifest, results, whole, write_part};

const PARTS: usize = 3;

/// Damage done to a file.
type Damage = fn(&Path);

/// Files of a study in order of creation.
fn order() -> Vec<String> {
    let part = |k: usize| {
        let names = [
            "trace_N.parquet",
            "trace_N.csv",
            "runs_N.parquet",
            "runs_N.csv",
            "part_N.sha256",
        ];
        names.map(|name| format!("parts/{}", name.replace('N', &format!("{k:05}"))))
    };
    let before = ["study.json", "plan.toml"].map(str::to_owned);
    let after = [
        "statistics.json",
        "tornado.svg",
        "summary.json",
        "results.sha256",
    ]
    .map(str::to_owned);
    before
        .into_iter()
        .chain((0..PARTS).flat_map(part))
        .chain(after)
        .collect()
}

fn finish(path: &Path) -> Vec<usize> {
    let dir = StudyDir::resume(path, &manifest(PARTS), PLAN).unwrap();
    let missing = dir.missing();
    missing.iter().for_each(|&part| write_part(&dir, part));
    dir.finish(&results()).unwrap();
    missing
}

/// Files are created one after the other, each complete: a killed process leaves the first few, and a partial one.
#[test]
fn a_study_killed_anywhere_is_finished_to_the_same_bytes() {
    let reference = TempDir::new().unwrap();
    whole(reference.path(), PARTS);
    let all = files(reference.path());
    let order = order();
    assert_eq!(order.len(), all.len(), "{:?}", all.keys());
    for there in 1..=order.len() {
        let dir = TempDir::new().unwrap();
        fs::create_dir(dir.path().join("parts")).unwrap();
        for name in &order[..there] {
            fs::write(dir.path().join(name), &all[name]).unwrap();
        }
        for folder in ["", "parts/"] {
            fs::write(dir.path().join(format!("{folder}.cvtcycle-x7.tmp")), "half").unwrap();
        }
        // Lock file of earlier versions.
        fs::write(dir.path().join(".lock"), "").unwrap();
        let parts = (there.saturating_sub(2) / 5).min(PARTS);
        assert_eq!(
            finish(dir.path()),
            (parts..PARTS).collect::<Vec<_>>(),
            "{there}"
        );
        assert_eq!(files(dir.path()), all, "{there}");
    }
}

#[test]
fn the_manifest_without_its_folder_is_a_study_too() {
    let dir = TempDir::new().unwrap();
    fs::write(dir.path().join("study.json"), manifest(PARTS)).unwrap();
    assert_eq!(finish(dir.path()).len(), PARTS);
}

#[test]
fn parts_in_any_order_and_from_several_threads_are_the_same() {
    let (one, two) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    whole(one.path(), 4);
    let dir = StudyDir::create(two.path(), &manifest(4), PLAN, false).unwrap();
    thread::scope(|scope| {
        let dir = &dir;
        for part in [3, 0, 2, 1] {
            scope.spawn(move || write_part(dir, part));
        }
    });
    dir.finish(&results()).unwrap();
    assert_eq!(files(one.path()), files(two.path()));
}

#[test]
fn a_part_that_is_not_whole_is_computed_again() {
    let spoil: [(&str, Damage); 5] = [
        ("part_00001.sha256", |path| fs::write(path, "").unwrap()),
        ("runs_00001.parquet", |path| fs::remove_file(path).unwrap()),
        ("trace_00001.csv", |path| fs::write(path, "run\n").unwrap()),
        ("trace_00001.parquet", |path| {
            let mut bytes = fs::read(path).unwrap();
            bytes[40] ^= 1;
            fs::write(path, bytes).unwrap();
        }),
        ("part_00001.sha256", |path| {
            let text = fs::read_to_string(path).unwrap();
            fs::write(
                path,
                text.lines()
                    .take(3)
                    .map(|line| format!("{line}\n"))
                    .collect::<String>(),
            )
            .unwrap();
        }),
    ];
    for (name, spoil) in spoil {
        let dir = TempDir::new().unwrap();
        whole(dir.path(), PARTS);
        let all = files(dir.path());
        spoil(&dir.path().join("parts").join(name));
        assert_eq!(finish(dir.path()), [1], "{name}");
        assert_eq!(files(dir.path()), all, "{name}");
    }
}

#[test]
fn a_part_deleted_while_the_study_ran_is_not_in_the_results() {
    let spoil: [(&str, Damage); 2] = [
        ("part_00001.sha256", |path| fs::remove_file(path).unwrap()),
        ("runs_00001.parquet", |path| fs::write(path, "x").unwrap()),
    ];
    for (name, spoil) in spoil {
        let dir = TempDir::new().unwrap();
        let study = StudyDir::create(dir.path(), &manifest(PARTS), PLAN, false).unwrap();
        (0..PARTS).for_each(|part| write_part(&study, part));
        assert_eq!(study.study().unwrap().present().len(), PARTS);
        spoil(&dir.path().join("parts").join(name));
        let mut problems = vec![study.finish(&results()).unwrap_err()];
        // A part without its mark would be missing in the answer; one with changed bytes is detected when read.
        if name.starts_with("part_") {
            problems.push(study.study().unwrap_err());
        }
        for problem in problems {
            assert!(
                problem.message.contains("1 of 3 parts in")
                    && problem
                        .message
                        .contains("was changed or removed while the study ran")
                    && problem.settings == [Setting::Resume],
                "{problem:?}"
            );
        }
        assert!(!dir.path().join("summary.json").exists(), "{name}");
        drop(study);
        assert_eq!(finish(dir.path()), [1], "{name}");
    }
}

#[test]
fn a_study_replaced_while_it_is_read_is_detected() {
    let dir = TempDir::new().unwrap();
    whole(dir.path(), PARTS);
    let study = Study::open(dir.path()).unwrap();
    study.unchanged().unwrap();
    // The same study computed again has the same parts.
    drop(StudyDir::create(dir.path(), &manifest(PARTS), PLAN, true).unwrap());
    study.unchanged().unwrap();
    drop(StudyDir::create(dir.path(), &manifest(PARTS + 1), PLAN, true).unwrap());
    let problem = study.unchanged().unwrap_err();
    assert!(
        problem.message.contains("was replaced while it was read")
            && problem.hint == "read it again",
        "{problem:?}"
    );
}

fn refused(path: &Path, change: impl Fn(&mut Value)) -> String {
    let mut other: Value = serde_json::from_slice(&manifest(PARTS)).unwrap();
    change(&mut other);
    let problem = StudyDir::resume(path, other.to_string().as_bytes(), PLAN).unwrap_err();
    format!("{} / {}", problem.message, problem.hint)
}

#[test]
fn another_study_is_not_resumed_and_the_difference_is_named() {
    let dir = TempDir::new().unwrap();
    whole(dir.path(), PARTS);
    let all = files(dir.path());
    let said = refused(dir.path(), |m| m["program"] = "cvtcycle 9.9.9".into());
    assert!(
        said.contains("`program` is \"cvtcycle 0.1.0\" there and \"cvtcycle 9.9.9\" now")
            && said.contains("in its place"),
        "{said}"
    );
    assert!(!said.contains("more values"), "{said}");
    // Another program has another build, which has no further message.
    let said = refused(dir.path(), |m| {
        m["program"] = "cvtcycle 9.9.9".into();
        m["build"] = "0123456789abcdef".into();
    });
    assert!(
        said.contains("`program` is") && !said.contains("more value"),
        "{said}"
    );
    // The identifying word of the run differs with every difference, and has no message either.
    let said = refused(dir.path(), |m| {
        m["build"] = "0123456789abcdef".into();
        m["run"] = "fedcba9876543210".into();
    });
    let words =
        format!("was begun by another build of the program: {BUILD} there, 0123456789abcdef now");
    assert!(
        said.contains(&words) && said.contains("resume it with that program"),
        "{said}"
    );
    let said = refused(dir.path(), |m| m["plan"] = "title = 2\n".into());
    assert!(
        said.contains("`plan, line 1` is `title = 1` there and `title = 2` now"),
        "{said}"
    );
    let said = refused(dir.path(), |m| {
        m["layout"]["csv"] = false.into();
        m["seed"] = 8.into();
        m["plan"] = "".into();
    });
    assert!(
        said.contains("`seed` is 7 there and 8 now (and 2 more values)"),
        "{said}"
    );
    // A changed plan is reported by its line, without the consequences.
    let mut other: Value = serde_json::from_slice(&manifest(PARTS)).unwrap();
    other["plan_sha256"] = "abc".into();
    let problem = StudyDir::resume(
        dir.path(),
        other.to_string().as_bytes(),
        b"title = \"test\"\nseed = 8\n",
    )
    .unwrap_err();
    let line = "`plan.toml, line 2` is no such line there and `seed = 8` now (and one more value)";
    assert!(problem.message.contains(line), "{}", problem.message);
    let spaced = [manifest(PARTS), b"\n".to_vec()].concat();
    let problem = StudyDir::resume(dir.path(), &spaced, PLAN).unwrap_err();
    assert!(
        problem.message.contains("another form"),
        "{}",
        problem.message
    );
    assert_eq!(files(dir.path()), all);
    fs::write(dir.path().join("study.json"), b"{\"a\": ").unwrap();
    let problem = StudyDir::resume(dir.path(), &manifest(PARTS), PLAN).unwrap_err();
    assert_eq!(problem.kind, ProblemKind::Damaged);
    let empty = TempDir::new().unwrap();
    for path in [empty.path().to_path_buf(), empty.path().join("nowhere")] {
        let said = refused(&path, |_| {});
        assert!(
            said.contains("no study in") && said.contains("without resuming"),
            "{said}"
        );
    }
    assert!(files(empty.path()).is_empty());
}

#[test]
fn a_plan_that_was_lost_or_changed_is_put_back() {
    let dir = TempDir::new().unwrap();
    whole(dir.path(), PARTS);
    for spoiled in [None, Some("title = \"mine\"\n")] {
        let path = dir.path().join("plan.toml");
        spoiled
            .map_or_else(|| fs::remove_file(&path), |text| fs::write(&path, text))
            .unwrap();
        assert_eq!(finish(dir.path()), [0_usize; 0]);
        assert_eq!(fs::read(&path).unwrap(), PLAN);
    }
}
