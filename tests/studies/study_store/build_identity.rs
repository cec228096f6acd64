//! Identity of a build: equal for equal sources, different after any change of them.

use std::fs;
use std::path::Path;

use cvtcycle::output::BUILD;
use tempfile::TempDir;

#[path = "../../../crates/output/build/identity.rs"]
mod build;

use build::{INPUTS, identity};

/// Workspace with one file for each input that counts.
fn workspace() -> TempDir {
    let dir = TempDir::new().unwrap();
    for input in INPUTS {
        let path = dir.path().join(input);
        let path = if path.extension().is_some() {
            path
        } else {
            path.join("inner/file.txt")
        };
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, format!("of {input}\nline two\n")).unwrap();
    }
    dir
}

fn workspace_identity(dir: &TempDir) -> String {
    identity(dir.path(), &INPUTS).unwrap()
}

#[test]
fn the_program_has_the_identity_of_its_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    assert_eq!(identity(root, &INPUTS).unwrap(), BUILD);
    for input in INPUTS {
        assert!(root.join(input).exists(), "{input}");
    }
}

#[test]
fn one_byte_or_name_of_any_input_makes_another_build() {
    let dir = workspace();
    let before = workspace_identity(&dir);
    assert_eq!(before, workspace_identity(&workspace()));
    assert_eq!(before.len(), 16);
    for input in INPUTS {
        let path = dir.path().join(input);
        let path = if path.is_file() {
            path
        } else {
            path.join("inner/file.txt")
        };
        let text = fs::read(&path).unwrap();
        fs::write(&path, text.to_ascii_uppercase()).unwrap();
        assert_ne!(workspace_identity(&dir), before, "{input}");
        fs::write(&path, &text).unwrap();
        assert_eq!(workspace_identity(&dir), before, "{input}");
    }
    let [old, new] = ["a.csv", "b.csv"].map(|name| dir.path().join("cycles").join(name));
    fs::write(&old, "0,0\n").unwrap();
    let with = workspace_identity(&dir);
    fs::rename(&old, new).unwrap();
    assert!(with != before && workspace_identity(&dir) != with);
}

#[test]
fn line_ends_and_files_that_do_not_count_make_no_other_build() {
    let dir = workspace();
    let before = workspace_identity(&dir);
    let lock = dir.path().join("Cargo.lock");
    fs::write(&lock, "of Cargo.lock\r\nline two\r\n").unwrap();
    fs::write(dir.path().join("README.md"), "words").unwrap();
    assert_eq!(workspace_identity(&dir), before);
    fs::write(&lock, "of Cargo.lock\rline two\n").unwrap();
    assert_ne!(workspace_identity(&dir), before);
}
