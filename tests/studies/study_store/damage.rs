//! Damaged files and failing disks: an error that names the file, never wrong rows or a panic.

use std::fs;
use std::path::Path;

use cvtcycle::config::{ProblemKind, Setting};
use cvtcycle::study::store::Values;
use cvtcycle::study::store::{PartTable, Study, StudyDir};
use tempfile::TempDir;

use super::{PLAN, files, heads, manifest, rows, whole, write_part};

/// Reads a complete table.
fn read(path: &Path) -> Result<usize, cvtcycle::config::Problem> {
    let names: Vec<String> = heads().into_iter().map(|column| column.name).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let study = Study::open(path)?;
    Ok(study.read("runs", &names)?.len())
}

#[test]
fn a_part_with_any_byte_changed_or_cut_off_is_noticed() {
    let dir = TempDir::new().unwrap();
    whole(dir.path(), 1);
    assert_eq!(read(dir.path()), Ok(3));
    let path = dir.path().join("parts/runs_00000.parquet");
    let good = fs::read(&path).unwrap();
    let noticed = |bytes: &[u8], what: String| {
        fs::write(&path, bytes).unwrap();
        let problem = read(dir.path()).expect_err(&what);
        assert!(
            problem
                .place
                .input
                .to_string()
                .ends_with("runs_00000.parquet")
                && problem.kind == ProblemKind::Damaged,
            "{what}: {problem:?}"
        );
        assert!(problem.hint.contains("continued"));
    };
    for at in 0..good.len() {
        noticed(&good[..at], format!("cut at {at}"));
        let mut bytes = good.clone();
        bytes[at] ^= 1 << (at % 8);
        noticed(&bytes, format!("bit at {at}"));
    }
    noticed(&[&good[..], b"x"].concat(), "longer".to_owned());
    fs::remove_file(&path).unwrap();
    assert!(
        read(dir.path())
            .unwrap_err()
            .place
            .input
            .to_string()
            .ends_with("runs_00000.parquet")
    );
    fs::write(&path, &good).unwrap();
    assert_eq!(read(dir.path()), Ok(3));
    let mark = dir.path().join("parts/part_00000.sha256");
    let list = fs::read_to_string(&mark).unwrap();
    let line = list
        .lines()
        .position(|line| line.ends_with("runs_00000.parquet"))
        .unwrap();
    let start: usize = list.lines().take(line).map(|line| line.len() + 1).sum();
    for at in start..start + 66 {
        let mut bytes = list.clone().into_bytes();
        bytes[at] ^= 1;
        fs::write(&mark, &bytes).unwrap();
        let problem = read(dir.path()).unwrap_err();
        assert_eq!(problem.kind, ProblemKind::Damaged, "{at}");
    }
}

#[test]
fn one_column_over_all_parts() {
    let dir = TempDir::new().unwrap();
    whole(dir.path(), 4);
    let study = Study::open(dir.path()).unwrap();
    assert_eq!(study.rows("runs").unwrap(), 3 + 4 + 5 + 6);
    let all = study.read("runs", &["fuel_l_per_100km"]).unwrap();
    let wanted: Vec<f64> = (0..4)
        .flat_map(|part| {
            if let Values::Number(x) = &rows(part).values[2] {
                x.clone()
            } else {
                Vec::new()
            }
        })
        .collect();
    assert_eq!(all.values, [Values::Number(wanted)]);
    let rows = |&part: &usize| study.part(part, "trace").unwrap().rows();
    let order: Vec<(usize, u64)> = study
        .present()
        .iter()
        .map(|part| (*part, rows(part)))
        .collect();
    assert_eq!(order, [(0, 3), (1, 4), (2, 5), (3, 6)]);
    let problem = study.read("walks", &["run"]).unwrap_err();
    assert!(
        problem
            .message
            .contains("no table `walks`, only trace, runs"),
        "{}",
        problem.message
    );
    assert_eq!(
        study.part(0, "runs").unwrap().metadata()[1],
        ("cvtcycle.part".to_owned(), "x".to_owned())
    );
}

#[test]
fn a_part_that_cannot_be_written_leaves_nothing_and_the_others_stay() {
    let dir = TempDir::new().unwrap();
    let study = StudyDir::create(dir.path(), &manifest(3), PLAN, false).unwrap();
    write_part(&study, 0);
    let before = files(dir.path());
    let (columns, rows) = (heads(), rows(1));
    let table = |name| PartTable {
        name,
        columns: &columns[..2],
        rows: &rows,
        metadata: &[],
    };
    // Mismatched rows stand in for any error in the middle of a file.
    let problem = study
        .write_part(1, &[table("trace"), table("runs")])
        .unwrap_err();
    assert!(
        problem.message.contains("cannot write trace_00001.parquet")
            && problem.settings == [Setting::Resume],
        "{problem:?}"
    );
    assert_eq!(files(dir.path()), before);
    assert_eq!(study.missing(), [1, 2]);
    // A folder in the way of the last file: earlier files exist, the part does not.
    fs::create_dir(dir.path().join("parts/part_00001.sha256")).unwrap();
    let whole = |name| PartTable {
        columns: &columns,
        ..table(name)
    };
    assert!(
        study
            .write_part(1, &[whole("trace"), whole("runs")])
            .is_err()
    );
    assert_eq!(study.missing(), [1, 2]);
    assert!(files(dir.path()).keys().all(|name| !name.contains(".tmp")));
    fs::remove_dir(dir.path().join("parts/part_00001.sha256")).unwrap();
    drop(study);
    assert_eq!(
        StudyDir::resume(dir.path(), &manifest(3), PLAN)
            .unwrap()
            .missing(),
        [1, 2]
    );
}

/// The lists can be checked by sha256sum.
#[test]
fn lists_of_checksums_are_those_of_sha256sum() {
    let dir = TempDir::new().unwrap();
    whole(dir.path(), 1);
    for (folder, list) in [("", "results.sha256"), ("parts", "part_00000.sha256")] {
        let folder = dir.path().join(folder);
        let Ok(output) = std::process::Command::new("sha256sum")
            .args(["--check", "--strict", list])
            .current_dir(&folder)
            .output()
        else {
            eprintln!("sha256sum is not on this machine: not checked");
            return;
        };
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}
