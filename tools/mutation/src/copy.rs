//! The copy of the repository in which the mutants live.

use crate::config::Config;
use crate::find::{self, Source};
use crate::point::{self, Point};
use std::collections::{BTreeSet, HashSet};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder of the package whose code is changed.
const CRATE: &str = "crates/model";

/// A copy, and its mutants.
pub struct Copy {
    /// Where it is.
    pub root: PathBuf,
    /// The points, in the order of their numbers.
    pub points: Vec<Point>,
    /// Of each point, the bytes that it takes in the written file; empty where it is not written.
    pub ranges: Vec<Range<usize>>,
}

/// Files of a repository: those that git knows or does not ignore. A link to a folder counts as the files in that folder.
///
/// # Errors
/// git fails.
pub fn files(root: &Path) -> Result<Vec<String>, String> {
    let output = Command::new("git")
        .args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ])
        .current_dir(root)
        .output()
        .map_err(|e| format!("git: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let mut files = Vec::new();
    for name in text.split('\0').filter(|name| !name.is_empty()) {
        add(root, name, &mut files)?;
    }
    files.sort();
    files.dedup();
    if files.is_empty() {
        Err(format!(
            "no files of a git repository in {}",
            root.display()
        ))
    } else {
        Ok(files)
    }
}

/// Adds a file, or the files of a folder.
fn add(root: &Path, name: &str, files: &mut Vec<String>) -> Result<(), String> {
    let path = root.join(name);
    if path.is_file() {
        files.push(name.to_owned());
    } else if path.is_dir() {
        let failed = |e| format!("{}: {e}", path.display());
        for entry in fs::read_dir(&path).map_err(failed)? {
            let inner = entry.map_err(failed)?.file_name();
            add(root, &format!("{name}/{}", inner.to_string_lossy()), files)?;
        }
    }
    Ok(())
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Writes a file if it is not so already: a build looks at the times of files.
fn keep(path: &Path, bytes: &[u8]) -> Result<(), String> {
    if fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    let write = || {
        fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        fs::write(path, bytes)
    };
    write().map_err(|e| format!("{}: {e}", path.display()))
}

/// All points of all files that the configuration names.
///
/// # Errors
/// A file cannot be read, or is no Rust.
pub fn points(root: &Path, config: &Config, files: &[String]) -> Result<Vec<Point>, String> {
    let mut constants = BTreeSet::new();
    let mut texts = Vec::new();
    for file in files
        .iter()
        .filter(|f| f.starts_with(&format!("{CRATE}/src/")) && f.ends_with(".rs"))
    {
        let text = read(&root.join(file))?;
        constants.extend(find::constants(&text));
        if config.mutates(file) {
            texts.push((file, text));
        }
    }
    let mut all = Vec::new();
    let mut next = 1;
    for (file, text) in &texts {
        let source = Source {
            file,
            text,
            constants: &constants,
            methods: &config.methods,
            keep_literals: config.keeps_literals(file),
        };
        let found = find::points(&source, next)?;
        next += found.iter().map(|p| p.choices.len() as u32).sum::<u32>();
        all.extend(found);
    }
    // A name that no source uses was renamed there: the configuration is out of date.
    for name in config.methods.names() {
        if !texts
            .iter()
            .any(|(_, text)| text.contains(&format!("{name}(")))
        {
            return Err(format!(
                "tools/mutation/mutation.toml: no source calls {name}"
            ));
        }
    }
    let mut keys = BTreeSet::new();
    for point in &all {
        for choice in &point.choices {
            let key = point.key(choice);
            if !keys.insert(key.clone()) {
                return Err(format!("{}: two mutants have the name {key}", point.file));
            }
        }
    }
    Ok(all)
}

/// Copies the repository and writes `points` into it, but for those whose name is among `dropped`.
///
/// # Errors
/// A file cannot be read or written.
pub fn make(
    root: &Path,
    to: &Path,
    points: &[Point],
    dropped: &HashSet<String>,
) -> Result<Copy, String> {
    let files = files(root)?;
    let numbers = points.iter().flat_map(|p| &p.choices).map(|c| c.number);
    let count = numbers.max().unwrap_or(0) + 1;
    let mut ranges = vec![0..0; points.len()];
    for file in files.iter().filter(|f| !f.starts_with("tools/mutation/")) {
        let bytes = fs::read(root.join(file)).map_err(|e| format!("{file}: {e}"))?;
        let bytes = match file.as_str() {
            _ if points.iter().any(|p| p.file == *file) => {
                mutated(file, &bytes, points, dropped, &mut ranges)?
            }
            name if name == format!("{CRATE}/src/lib.rs") => {
                [&bytes, "\n/// Mutants.\npub mod mutant;\n".as_bytes()].concat()
            }
            name if name.ends_with("Cargo.toml") => {
                without_lints(&String::from_utf8_lossy(&bytes)).into_bytes()
            }
            _ => bytes,
        };
        keep(&to.join(file), &bytes)?;
    }
    let module = include_str!("template.rs.txt").replace("@COUNT@", &count.to_string());
    keep(&to.join(CRATE).join("src/mutant.rs"), module.as_bytes())?;
    for folder in ["src", "crates", "tests"] {
        remove_others(to, &to.join(folder), &files)?;
    }
    Ok(Copy {
        root: to.to_owned(),
        points: points.to_vec(),
        ranges,
    })
}

fn mutated(
    file: &str,
    bytes: &[u8],
    all: &[Point],
    dropped: &HashSet<String>,
    ranges: &mut [Range<usize>],
) -> Result<Vec<u8>, String> {
    let text = std::str::from_utf8(bytes).map_err(|e| format!("{file}: {e}"))?;
    let chosen: Vec<usize> = (0..all.len())
        .filter(|i| all[*i].file == file && !dropped.contains(&name(&all[*i])))
        .collect();
    let points: Vec<Point> = chosen.iter().map(|i| all[*i].clone()).collect();
    let written = point::write(text, &points);
    for (index, range) in chosen.into_iter().zip(written.ranges) {
        ranges[index] = range;
    }
    Ok(written.text.into_bytes())
}

/// Name of a point: the key of its first mutant.
#[must_use]
pub fn name(point: &Point) -> String {
    point
        .choices
        .first()
        .map_or_else(String::new, |c| point.key(c))
}

/// The manifest without its lint tables: mutants are no style.
fn without_lints(text: &str) -> String {
    let mut inside = false;
    let keep = text.lines().filter(|line| {
        if line.starts_with('[') {
            inside = line.starts_with("[lints") || line.starts_with("[workspace.lints");
        }
        !inside
    });
    keep.map(|line| format!("{line}\n")).collect()
}

/// Removes files and folders of a former copy that the repository no longer has.
fn remove_others(to: &Path, folder: &Path, files: &[String]) -> Result<(), String> {
    for entry in fs::read_dir(folder)
        .map_err(|e| format!("{}: {e}", folder.display()))?
        .flatten()
    {
        let path = entry.path();
        let short = path
            .strip_prefix(to)
            .unwrap_or(&path)
            .to_string_lossy()
            .replace('\\', "/");
        if path.is_dir() {
            remove_others(to, &path, files)?;
            let _ = fs::remove_dir(&path); // where it is empty: Cargo takes each folder of crates for a package
        } else if short != format!("{CRATE}/src/mutant.rs") && files.binary_search(&short).is_err()
        {
            fs::remove_file(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    Ok(())
}
