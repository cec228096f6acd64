//! README and docs against the files: links point to files in git, and the commands of a page run. Tables of the program: `tools/tables`.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use std::fs::read_to_string;
use std::path::{Component, Path, PathBuf};

use assert_cmd::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(name: &str) -> String {
    let text = read_to_string(root().join(name));
    text.unwrap_or_else(|error| panic!("{name}: {error}"))
        .replace("\r\n", "\n")
}

/// Documents with links: top level, `docs` and tools.
fn documents() -> Vec<PathBuf> {
    let mut list = Vec::new();
    for folder in ["", "docs", "tools/fuzz", "cycles", "tests/golden"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "md") {
                list.push(path.strip_prefix(root()).unwrap().to_owned());
            }
        }
    }
    list
}

/// Removes `.` and `..` from a path.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => assert!(normal.pop(), "{}", path.display()),
            Component::CurDir => {}
            part => normal.push(part),
        }
    }
    normal
}

/// Parses `.gitignore`, which has paths from the root only.
fn ignored() -> Vec<PathBuf> {
    let text = read(".gitignore");
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let path =
        |line: &str| PathBuf::from(line.strip_prefix('/').unwrap_or_else(|| panic!("{line}")));
    lines.map(path).collect()
}

#[test]
fn links_point_to_files_in_git() {
    let (mut wrong, mut links) = (String::new(), 0);
    let ignored = ignored();
    for document in documents() {
        let text = read(document.to_str().unwrap());
        let targets = text
            .match_indices("](")
            .map(|(at, mark)| &text[at + mark.len()..]);
        for target in targets.filter_map(|rest| rest.split(')').next()) {
            let file = target.split('#').next().unwrap();
            if file.is_empty() || file.contains("://") {
                continue;
            }
            links += 1;
            let path = normal(&document.parent().unwrap().join(file));
            if !root().join(&path).exists() {
                wrong += &format!("{}: {target} does not exist\n", document.display());
            } else if ignored.iter().any(|ignored| path.starts_with(ignored)) {
                wrong += &format!("{}: {target} is not in git\n", document.display());
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(links > 30, "{links}");
}

/// Splits a command at blanks, except between single quotes.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut quoted) = (vec![String::new()], false);
    for letter in command.chars() {
        match letter {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            letter => words.last_mut().unwrap().push(letter),
        }
    }
    words
}

/// Runs the blocks of docs/book/src/your_car.md in order in an empty folder. A file begins with a line that names it; a command must end with exit code 0.
#[test]
fn the_commands_of_your_car_in_an_hour_run() {
    let page = read("docs/book/src/your_car.md");
    let folder = tempfile::tempdir().unwrap();
    let (mut files, mut commands) = (0, 0);
    // Every second part is a block: its language, then its lines.
    for block in page.split("```").skip(1).step_by(2) {
        let (language, text) = block.split_once('\n').unwrap();
        if language != "console" {
            let name = text.lines().next().unwrap();
            if let Some(name) = name.strip_prefix("# ") {
                std::fs::write(folder.path().join(name), text).unwrap();
                files += 1;
            }
            continue;
        }
        for line in text.lines() {
            let Some(line) = line.strip_prefix("$ cvtcycle ") else {
                continue;
            };
            let mut command = Command::cargo_bin("cvtcycle").unwrap();
            command.args(words(line)).current_dir(folder.path());
            let output = command.output().unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{line}: {error}");
            commands += 1;
        }
    }
    assert!(files >= 6 && commands > 20, "{files} {commands}");
}
