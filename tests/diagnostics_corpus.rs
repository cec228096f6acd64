//! The diagnostics corpus: bad input files and, beside each, the whole text that a user sees.
//!
//! `tests/diagnostics/KIND/NAME` is a bad file, `NAME.expected` what the program says about it, compared byte by byte. After a change of
//! words that is meant: `CVTCYCLE_BLESS=1 cargo test --test diagnostics_corpus`, then read the difference.
//!
//! | module | what it enforces |
//! |---|---|
//! | `kinds`, `calibration` | how each kind of file is read |
//! | `keys` | every key of every shipped file and of every option: too low, too high, nan, of another type, missing, misspelt, twice |
//! | `sentences` | every sentence of a complaint in the source stands in an expected text |
#![allow(clippy::unwrap_used, reason = "tests say what they found")]

#[path = "diagnostics/calibrations.rs"]
mod calibration;
#[path = "diagnostics/keys.rs"]
mod keys;
#[path = "diagnostics/kinds.rs"]
mod kinds;
#[path = "diagnostics/sentences.rs"]
mod sentences;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Ending of the expected texts.
const EXPECTED: &str = ".expected";

/// Folder of the corpus from the package's own, in which tests run: it stands in the expected texts.
const CORPUS: &str = "tests/diagnostics";

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut list: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.is_file())
        .collect();
    list.sort();
    list
}

/// Bad files of a kind, seen from the package's folder, with forward slashes.
fn cases(kind: &str) -> Vec<String> {
    let folder = Path::new(CORPUS).join(kind);
    let names = files(&folder)
        .into_iter()
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned());
    names
        .filter(|name| !name.ends_with(EXPECTED) && !name.starts_with("logo."))
        .map(|name| format!("{CORPUS}/{kind}/{name}"))
        .collect()
}

/// All that the corpus makes the program say, problem by problem.
fn said() -> Vec<String> {
    let mut blocks = Vec::new();
    for kind in kinds::KINDS {
        for path in files(&Path::new(CORPUS).join(kind)) {
            if path.to_str().unwrap().ends_with(EXPECTED) {
                blocks.extend(
                    std::fs::read_to_string(&path)
                        .unwrap()
                        .split("\n\n")
                        .map(str::to_owned),
                );
            }
        }
    }
    // The forms of TOML have a test of their own; what it announces is held there.
    let announced = files(Path::new(CORPUS))
        .into_iter()
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    for path in announced {
        let text = std::fs::read_to_string(&path).unwrap();
        blocks.extend(
            text.lines()
                .filter_map(|line| line.trim_start().strip_prefix("#~ "))
                .map(str::to_owned),
        );
    }
    blocks
}

#[test]
fn every_bad_file_is_told_as_expected() {
    let bless = std::env::var_os("CVTCYCLE_BLESS").is_some();
    let mut wrong = String::new();
    let mut count = 0;
    for kind in kinds::KINDS {
        let mut told: Vec<(String, String)> = cases(kind)
            .into_iter()
            .map(|case| (case.clone(), kinds::told(kind, &case)))
            .collect();
        told.extend(
            kinds::made(kind)
                .into_iter()
                .map(|(name, text)| (format!("{CORPUS}/{kind}/{name}"), text)),
        );
        if kind == "plan" {
            told.extend(
                kinds::plans_of_the_reader()
                    .map(|(name, text)| (format!("{CORPUS}/plan/{name}"), text)),
            );
        }
        assert!(told.len() >= 2, "{kind}: {} cases", told.len());
        let known: BTreeSet<String> = told
            .iter()
            .map(|(case, _)| format!("{case}{EXPECTED}"))
            .collect();
        let orphans = files(&Path::new(CORPUS).join(kind))
            .into_iter()
            .map(|path| path.to_str().unwrap().replace('\\', "/"));
        for orphan in orphans.filter(|path| path.ends_with(EXPECTED) && !known.contains(path)) {
            wrong += &format!("{orphan}: there is no such bad file\n");
        }
        for (case, text) in told {
            count += 1;
            if text.is_empty() {
                wrong += &format!("{case}: accepted\n");
            }
            let path = format!("{case}{EXPECTED}");
            let expected = std::fs::read_to_string(&path)
                .unwrap_or_default()
                .replace("\r\n", "\n");
            if bless {
                std::fs::write(&path, &text).unwrap();
            } else if text != expected {
                wrong += &format!("==== {case}, expected\n{expected}==== found\n{text}\n");
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(count > 130, "only {count} bad files");
}

#[test]
fn every_message_says_what_is_allowed_or_what_to_do() {
    let leads_nowhere = |block: &&String| {
        block.starts_with("error") && !block.contains("allowed: ") && !block.contains("= help: ")
    };
    let said = said();
    let list: Vec<&str> = said
        .iter()
        .filter(leads_nowhere)
        .map(String::as_str)
        .collect();
    assert!(
        list.is_empty(),
        "{} of {}:\n{}",
        list.len(),
        said.len(),
        list.join("\n\n")
    );
}

#[test]
fn every_sentence_of_the_source_has_a_bad_file() {
    sentences::check(&said());
}

#[test]
fn every_key_complains_at_its_place() {
    keys::check();
}
