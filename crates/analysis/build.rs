//! Collects the equations of this crate from the heads of its modules into `equations.rs`, in the order in which the modules are declared.
//!
//! A line of a head is `//! | label | statement | status |`; a bar within a cell is written `\|`.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=src");
    let variable = |name: &str| env::var(name).unwrap_or_else(|error| panic!("{name}: {error}"));
    let name = variable("CARGO_PKG_NAME").replace("cvtcycle-", "");
    let mut list = "&[\n".to_owned();
    walk(
        &Path::new(&variable("CARGO_MANIFEST_DIR")).join("src/lib.rs"),
        &name,
        &mut list,
    );
    list += "]\n";
    let out = Path::new(&variable("OUT_DIR")).join("equations.rs");
    fs::write(&out, list).unwrap_or_else(|error| panic!("{}: {error}", out.display()));
}

/// Adds the equations of a file, then those of the modules that it declares.
fn walk(file: &Path, module: &str, list: &mut String) {
    let text =
        fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    for [label, statement, status] in text.lines().filter_map(equation) {
        // Writing into a String cannot fail.
        let _ = writeln!(
            list,
            "Equation {{ label: {label:?}, statement: {statement:?}, status: {status:?}, module: {module:?} }},"
        );
    }
    let stem = file.file_stem().unwrap_or_default();
    let own = ["lib", "mod"].iter().any(|name| stem == *name);
    let folder = if own {
        file.with_file_name("")
    } else {
        file.with_extension("")
    };
    for name in text.lines().filter_map(declared) {
        let flat = folder.join(format!("{name}.rs"));
        let inner = if flat.exists() {
            flat
        } else {
            folder.join(name).join("mod.rs")
        };
        if inner.exists() {
            walk(&inner, &format!("{module}::{name}"), list);
        }
    }
}

/// The name in `mod name;` and `pub mod name;`.
fn declared(line: &str) -> Option<&str> {
    let words = line.strip_suffix(';')?;
    let (before, name) = words.split_once("mod ")?;
    (before.is_empty() || before.starts_with("pub")).then_some(name)
}

/// Label, statement and status of a line of a head.
fn equation(line: &str) -> Option<[&str; 3]> {
    let mut rest = line.strip_prefix("//! |")?;
    let mut cells = Vec::new();
    while let Some(end) = end_of_cell(rest) {
        cells.push(rest[..end].trim());
        rest = &rest[end + 1..];
    }
    let [label, statement, status] = cells.try_into().ok()?;
    is_label(label).then_some([label, statement, status])
}

/// The first bar without a backslash before it.
fn end_of_cell(text: &str) -> Option<usize> {
    let mut bars = text.match_indices('|').map(|(at, _)| at);
    bars.find(|at| !text[..*at].ends_with('\\'))
}

/// Two capitals, a hyphen, digits.
fn is_label(word: &str) -> bool {
    word.split_once('-').is_some_and(|(letters, digits)| {
        let number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        letters.len() == 2 && letters.bytes().all(|byte| byte.is_ascii_uppercase()) && number
    })
}
