//! Files in the output directory.

use std::fs;

use tempfile::TempDir;

use super::{EDGES, NAMES, belt, program, refused, text};

#[test]
fn files_appear_complete_or_not_at_all() {
    let dir = TempDir::new().unwrap();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    let names = || {
        let mut names: Vec<_> = fs::read_dir(dir.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    let rows: Vec<String> = (0..20_000)
        .map(|k| format!("0.5,{},12,10", 1000 + k % 3000))
        .collect();
    let good = format!("{NAMES}\n{}\n", rows.join("\n"));
    let mut bad = rows.clone();
    bad[12_344] = "0.5,2000,12,1O".to_owned();
    let bad = format!("{NAMES}\n{}\n", bad.join("\n"));
    let (out, points) = (path("out.csv"), path("points.csv"));
    let run = |more: &[&str]| {
        program(
            &[&["belt", "--points", &points, "--out", &out], more].concat(),
            b"",
        )
    };
    fs::write(&points, &bad).unwrap();
    let output = run(&[]);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(
        said.contains("points.csv:12346:13") && said.contains("1 problem in"),
        "{said}"
    );
    assert_eq!(names(), ["points.csv"]);
    assert_eq!(
        text(&refused(bad.as_bytes(), &["--json"]).into_bytes())
            .matches("error")
            .count(),
        1
    );
    fs::write(&points, &good).unwrap();
    let output = run(&[]);
    assert_eq!(
        (output.status.code(), text(&output.stderr)),
        (Some(0), String::new())
    );
    assert!(
        text(&output.stdout).contains("20000 points: 20000 ok"),
        "{}",
        text(&output.stdout)
    );
    assert_eq!(names(), ["out.csv", "points.csv"]);
    let written = fs::read_to_string(&out).unwrap();
    assert_eq!(written, text(&belt(good.as_bytes(), &[]).stdout));
    // An existing file is replaced with --force only, and a bad table leaves it unchanged.
    assert!(text(&run(&[]).stderr).contains("--force"));
    fs::write(&points, &bad).unwrap();
    assert_eq!(run(&["--force"]).status.code(), Some(2));
    assert_eq!(fs::read_to_string(&out).unwrap(), written);
    fs::write(&points, EDGES).unwrap();
    assert_eq!(
        (
            run(&["--force", "--quiet"]).status.code(),
            text(&run(&["--force", "--quiet"]).stdout)
        ),
        (Some(0), String::new())
    );
    assert_eq!(fs::read_to_string(&out).unwrap().lines().count(), 71);
    assert_eq!(names(), ["out.csv", "points.csv"]);
}

#[test]
fn a_file_of_bad_rows_is_reported_up_to_a_number() {
    let rows = vec!["0.5,x,12,10"; 300].join("\n");
    let said = refused(format!("{NAMES}\n{rows}\n").as_bytes(), &[]);
    assert!(said.contains("250 more problems are not shown"), "{said}");
}
