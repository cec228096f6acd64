//! What a build of the program computes with, as one hash: its sources, the data that it carries and the versions of its libraries.
//!
//! Two programs of one version may differ in a line of the model; their numbers are not to be mixed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// What counts, below the root of the workspace: a file, or a folder with all files in it.
pub const INPUTS: [&str; 28] = [
    "Cargo.lock",
    "calibrations",
    "classes",
    "crates/analysis/Cargo.toml",
    "crates/analysis/src",
    "crates/calibrate/Cargo.toml",
    "crates/calibrate/src",
    "crates/config/Cargo.toml",
    "crates/config/src",
    "crates/model/Cargo.toml",
    "crates/model/build.rs",
    "crates/model/src",
    "crates/output/Cargo.toml",
    "crates/output/build",
    "crates/output/build.rs",
    "crates/output/src",
    "crates/study/Cargo.toml",
    "crates/study/src",
    "crates/validate/Cargo.toml",
    "crates/validate/src",
    "cycles",
    "intervals",
    "levers",
    "lubricants",
    "plans",
    "rigs",
    "validation",
    "vehicles",
];

/// The first 16 hexadecimal digits of the SHA-256 over names and bytes of all `inputs` below a folder that are there. Names are relative and
/// sorted, and line ends are those of Unix, so that every checkout of one commit has one identity.
///
/// # Errors
/// A file or folder cannot be read.
pub fn identity(root: &Path, inputs: &[&str]) -> io::Result<String> {
    let mut files = Vec::new();
    for input in inputs {
        collect(&root.join(input), input, &mut files)?;
    }
    files.sort();
    let mut hash = Sha256::new();
    for (name, path) in files {
        let bytes = unix_lines(&fs::read(path)?);
        // With the length before the bytes no two sets of files are one text.
        hash.update(format!("{name}\n{}\n", bytes.len()));
        hash.update(bytes);
    }
    let digits = hash.finalize();
    Ok(digits
        .iter()
        .take(8)
        .map(|byte| format!("{byte:02x}"))
        .collect())
}

fn collect(path: &Path, name: &str, files: &mut Vec<(String, PathBuf)>) -> io::Result<()> {
    if path.is_file() {
        files.push((name.to_owned(), path.to_path_buf()));
    } else if path.is_dir() {
        for entry in fs::read_dir(path)? {
            let entry = entry?;
            let inner = entry.file_name().to_string_lossy().into_owned();
            collect(&entry.path(), &format!("{name}/{inner}"), files)?;
        }
    }
    Ok(())
}

fn unix_lines(bytes: &[u8]) -> Vec<u8> {
    let next = bytes.iter().skip(1).map(Some).chain([None]);
    let kept = bytes
        .iter()
        .zip(next)
        .filter(|(byte, next)| (**byte, *next) != (b'\r', Some(&b'\n')));
    kept.map(|(byte, _)| *byte).collect()
}
