//! Allowed directories of a new study.

use std::fs;

use cvtcycle::config::{Argument, ProblemKind, Setting};
use cvtcycle::output::files::OutputDir;
use cvtcycle::study::store::{Study, StudyDir};
use serde_json::json;
use tempfile::TempDir;

use super::{PLAN, files, manifest, results, whole, write_part};

fn refused(dir: &TempDir, force: bool) -> String {
    let problem = StudyDir::create(dir.path(), &manifest(2), PLAN, force).unwrap_err();
    assert!(problem.place.is_argument(Argument::Output));
    format!("{} / {}", problem.message, problem.hint)
}

#[test]
fn a_study_begins_in_a_new_or_empty_directory_with_manifest_and_plan() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("a").join("b");
    drop(StudyDir::create(&path, &manifest(2), PLAN, false).unwrap());
    assert_eq!(
        files(&path).keys().collect::<Vec<_>>(),
        ["plan.toml", "study.json"]
    );
    assert_eq!(files(&path)["plan.toml"], PLAN);
    let study = Study::open(&path).unwrap();
    assert_eq!(
        (study.manifest()["seed"].as_i64(), study.plan().unwrap()),
        (Some(7), PLAN.to_vec())
    );
    assert_eq!(
        (
            study.status().present,
            study.status().expected,
            study.status().finished
        ),
        (0, 2, false)
    );
    assert_eq!(
        (study.rows("runs").unwrap(), study.heads("runs").unwrap()),
        (0, Vec::new())
    );
}

#[test]
fn files_of_something_else_and_earlier_studies_are_not_written_over() {
    let dir = TempDir::new().unwrap();
    fs::write(dir.path().join("notes.txt"), "mine").unwrap();
    for force in [false, true] {
        let said = refused(&dir, force);
        assert!(
            said.contains("something else: notes.txt") && said.contains("empty directory"),
            "{said}"
        );
    }
    assert_eq!(files(dir.path()).keys().collect::<Vec<_>>(), ["notes.txt"]);
    let run = TempDir::new().unwrap();
    fs::write(run.path().join("summary.json"), "{}").unwrap();
    assert!(refused(&run, true).contains("something else"));
    let study = TempDir::new().unwrap();
    whole(study.path(), 1);
    let before = files(study.path());
    let said = refused(&study, false);
    assert!(
        said.contains("holds a study") && said.contains("continue it, replace it"),
        "{said}"
    );
    // A run does not replace the directory of a study either, though both have a summary.
    let problem = OutputDir::create(study.path(), true).unwrap_err();
    assert!(
        problem.message.contains("something else"),
        "{}",
        problem.message
    );
    assert_eq!(files(study.path()), before);
}

#[test]
fn force_removes_parts_and_results_of_the_earlier_study_and_nothing_else() {
    let dir = TempDir::new().unwrap();
    let victim = dir.path().join("victim.svg");
    let path = dir.path().join("study");
    whole(&path, 3);
    fs::write(&victim, "keep").unwrap();
    for mine in ["notes.csv", "parts/mine.csv"] {
        fs::write(path.join(mine), "keep").unwrap();
    }
    // A manipulated list points outside the directory, and to a file that must stay.
    let list = fs::read_to_string(path.join("results.sha256")).unwrap();
    let sum = &list[..64];
    fs::write(
        path.join("results.sha256"),
        format!("{list}{sum}  ../victim.svg\n{sum}  study.json\n{sum}  parts\n"),
    )
    .unwrap();
    let dir = StudyDir::create(&path, &manifest(2), PLAN, true).unwrap();
    let left: Vec<String> = files(&path).into_keys().collect();
    assert_eq!(
        left,
        ["notes.csv", "parts/mine.csv", "plan.toml", "study.json"]
    );
    assert_eq!(fs::read_to_string(victim).unwrap(), "keep");
    assert_eq!(dir.missing(), [0, 1]);
    assert_eq!(files(&path)["study.json"], manifest(2));
}

/// Targets of links belong to something else: they are not removed, read or written.
#[cfg(unix)]
#[test]
fn nothing_of_a_study_lies_behind_a_link() {
    use std::os::unix::fs::symlink;
    let other = TempDir::new().unwrap();
    whole(other.path(), 3);
    let before = files(other.path());
    for name in [
        ".lock",
        "study.json",
        "plan.toml",
        "parts",
        "results.sha256",
    ] {
        let dir = TempDir::new().unwrap();
        let path = dir.path().join("study");
        whole(&path, 3);
        let here = path.join(name);
        if here.is_dir() {
            fs::remove_dir_all(&here).unwrap();
        } else if here.exists() {
            fs::remove_file(&here).unwrap();
        }
        symlink(other.path().join(name), &here).unwrap();
        let words = format!("{name} in {} is a link; it is not followed", path.display());
        for problem in [
            StudyDir::create(&path, &manifest(2), PLAN, true).unwrap_err(),
            StudyDir::resume(&path, &manifest(3), PLAN).unwrap_err(),
            Study::open(&path).unwrap_err(),
        ] {
            assert_eq!(problem.message, words);
            assert!(problem.hint.contains("put the file or folder itself there"));
        }
        assert_eq!(files(other.path()), before, "{name}");
    }
    // An empty folder behind a link is not filled either.
    let dir = TempDir::new().unwrap();
    let empty = TempDir::new().unwrap();
    symlink(empty.path(), dir.path().join("parts")).unwrap();
    let problem = StudyDir::create(dir.path(), &manifest(2), PLAN, false).unwrap_err();
    assert!(problem.message.contains("parts in"), "{}", problem.message);
    // The directory itself may be a link, since the user names it.
    let link = dir.path().join("link");
    symlink(other.path(), &link).unwrap();
    drop(StudyDir::resume(&link, &manifest(3), PLAN).unwrap());
    assert!(files(empty.path()).is_empty());
}

#[test]
fn only_one_process_writes_a_study_and_others_may_read() {
    let dir = TempDir::new().unwrap();
    let first = StudyDir::create(dir.path(), &manifest(2), PLAN, false).unwrap();
    write_part(&first, 0);
    for second in [
        StudyDir::resume(dir.path(), &manifest(2), PLAN).unwrap_err(),
        StudyDir::create(dir.path(), &manifest(2), PLAN, true).unwrap_err(),
    ] {
        assert_eq!(second.kind, ProblemKind::Locked);
    }
    assert_eq!(Study::open(dir.path()).unwrap().present(), [0]);
    drop(first);
    assert_eq!(
        StudyDir::resume(dir.path(), &manifest(2), PLAN)
            .unwrap()
            .missing(),
        [1]
    );
}

#[test]
fn a_manifest_that_leads_astray_is_refused() {
    let layouts = [
        json!({ "parts": 1, "tables": ["../../x"], "csv": false }),
        json!({ "parts": 1, "tables": ["part"], "csv": false }),
        json!({ "parts": 1, "tables": ["runs", "runs"], "csv": false }),
        json!({ "parts": 1, "tables": [], "csv": false }),
        json!({ "parts": 1_000_000_000_000_u64, "tables": ["runs"], "csv": false }),
        json!({ "parts": -1, "tables": ["runs"], "csv": false }),
        json!(null),
    ];
    for layout in layouts {
        let dir = TempDir::new().unwrap();
        let bytes = json!({ "layout": layout }).to_string().into_bytes();
        assert!(
            StudyDir::create(dir.path(), &bytes, PLAN, false).is_err(),
            "{layout}"
        );
        assert!(files(dir.path()).is_empty());
        fs::write(dir.path().join("study.json"), &bytes).unwrap();
        let problem = Study::open(dir.path()).unwrap_err();
        assert!(
            problem.place.input.to_string().ends_with("study.json")
                && problem.kind == ProblemKind::Damaged,
            "{layout}: {problem:?}"
        );
    }
    let none = TempDir::new().unwrap();
    assert!(
        Study::open(none.path())
            .unwrap_err()
            .message
            .contains("no study in")
    );
    assert!(
        Study::open(none.path().join("nowhere"))
            .unwrap_err()
            .message
            .contains("no study in")
    );
}

#[test]
fn results_have_plain_names_and_need_all_parts() {
    let dir = TempDir::new().unwrap();
    let study = StudyDir::create(dir.path(), &manifest(2), PLAN, false).unwrap();
    write_part(&study, 1);
    let problem = study.finish(&results()).unwrap_err();
    assert!(
        problem.message.contains("1 of 2 parts are missing")
            && problem.settings == [Setting::Resume],
        "{}",
        problem.message
    );
    write_part(&study, 0);
    assert!(study.is_complete());
    for name in [
        "../x.svg",
        "a/b.svg",
        "study.json",
        "plan.toml",
        ".lock",
        "",
        "results.sha256",
    ] {
        assert!(
            study.finish(&[(name.to_owned(), Vec::new())]).is_err(),
            "{name}"
        );
    }
    assert!(
        study
            .finish(&[
                ("a.svg".to_owned(), Vec::new()),
                ("A.svg".to_owned(), Vec::new())
            ])
            .is_err()
    );
    assert_eq!(files(dir.path()).len(), 2 + 2 * 5);
    let paths = study.finish(&results()).unwrap();
    assert!(paths.iter().all(|path| path.is_file()) && paths[0].ends_with("summary.json"));
    assert!(study.study().unwrap().status().finished);
    assert!(study.write_part(2, &[]).is_err() && study.write_part(0, &[]).is_err());
}
