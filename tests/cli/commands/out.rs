//! `--out` of every command: its problems are reported with all others, and nothing is written.

use std::fs;

use super::{one_line, run_in, stderr};

/// Words of a command with a second mistake besides `--out`, and the message about it.
type Case<'a> = (&'a [&'a str], &'a str);

/// Commands that write a directory.
const DIRECTORY_COMMANDS: [Case; 11] = [
    (&["run", "--ambient", "900"], "--ambient"),
    (&["losses", "--as-map", "box", "--temp", "900"], "--temp"),
    (&["losses", "--as-map", "boxes"], "--as-map"),
    (&["optimum", "--ambient", "900"], "--ambient"),
    (&["attribute", "--ambient", "900"], "--ambient"),
    (&["validate", "--format", "pdf"], "--format"),
    (&["rig", "variator", "--pulses", "-1"], "--pulses"),
    (&["calibrate", "none.toml"], "none.toml"),
    (&["study", "none.toml"], "none.toml"),
    (&["study", "ambient", "--ambient", "900"], "--ambient"),
    (&["levers", "--ambient", "900"], "--ambient"),
];

/// Commands that write a file, with a refused name.
const FILE_COMMANDS: [(Case, &str); 7] = [
    (
        (&["fmu", "rover_216_cvt", "--kind", "cars"], "--kind"),
        "x.zip",
    ),
    (
        (
            &["fmu", "rover_216_cvt", "--set", "road_load.mass_kg=-1"],
            "mass_kg",
        ),
        "x.zip",
    ),
    ((&["new", "a", "--class", "compact"], "--class"), "a.yaml"),
    ((&["report", "none"], "none"), "x.pdf"),
    ((&["report", "none", "--format", "md"], "none"), "x.html"),
    ((&["whatif", "--ambient", "900"], "--ambient"), "x.pdf"),
    ((&["study", "export", "none"], "none"), "x.doc"),
];

/// Commands that write a file of any name.
const ANY_FILE_COMMANDS: [Case; 2] = [
    (&["convert", "cycle", "none.csv"], "none.csv"),
    (&["belt", "--points", "none.csv"], "none.csv"),
];

/// Runs a command that must be refused, and checks that each part occurs in the problems.
fn refused(words: &[&str], out: &str, parts: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    fs::write(dir.join("file.txt"), "mine").unwrap();
    fs::create_dir(dir.join("full")).unwrap();
    fs::write(dir.join("full/mine.txt"), "mine").unwrap();
    let output = run_in(dir, &[words, &["--out", out]].concat());
    let text = one_line(&stderr(&output));
    assert_eq!(output.status.code(), Some(2), "{words:?}: {text}");
    for part in parts {
        assert!(text.contains(part), "{words:?} --out {out}: {part}\n{text}");
    }
    let mut left: Vec<_> = fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["file.txt", "full"], "{words:?}");
    assert_eq!(fs::read_dir(dir.join("full")).unwrap().count(), 1);
}

#[test]
fn a_bad_directory_is_reported_with_other_mistakes() {
    for (words, other) in DIRECTORY_COMMANDS {
        refused(words, "file.txt", &[other, "exists and is not a directory"]);
        refused(
            words,
            "full",
            &[other, "full holds files of something else"],
        );
    }
}

#[test]
fn a_wrong_ending_is_reported_with_other_mistakes() {
    for ((words, other), name) in FILE_COMMANDS {
        refused(words, name, &[other, "--out", name, "ending"]);
        let says = if words[0] == "study" {
            "ending"
        } else {
            "is a directory"
        };
        refused(words, "full", &[other, "--out", says]);
    }
    for (words, other) in ANY_FILE_COMMANDS {
        refused(words, "full", &[other, "--out", "is a directory"]);
        refused(words, "file.txt", &[other, "--out", "file.txt exists"]);
    }
}

/// An unknown form requires no extension, so the name of the file is not reported. Levers in a form without them are reported too.
#[test]
fn an_unknown_form_requires_no_extension() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "report", "none", "--format", "pdf", "--live", "--out", "x.md",
    ];
    let output = run_in(folder.path(), &words);
    let text = stderr(&output);
    for part in ["--format", "--live", "cannot read none"] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(!text.contains("--out"), "{text}");
}
