//! Hash that identifies a build: the program's sources, its embedded data and the versions of its libraries.
//!
//! Programs of one version may differ in a line of the model, and their numbers must not be mixed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Hashed paths below the root of the workspace: a file, or a folder with all files in it.
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

/// Returns the first 16 hexadecimal digits of the SHA-256 over names and bytes of all existing `inputs` below a folder. Names are relative and
/// sorted, and line ends are those of Unix, so that every checkout of one commit has the same identity.
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
        // The length before the bytes keeps two different sets of files from hashing the same text.
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
