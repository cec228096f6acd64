//! The diagnostics corpus: bad input files, and after each the whole text that the program prints about it.
//!
//! `tests/diagnostics/KIND.txt` holds both; the text is compared byte by byte. After an intended change of a message:
//! `CVTCYCLE_BLESS=1 cargo test --test diagnostics_corpus`, then read the difference.
//!
//! | module | what it does |
//! |---|---|
//! | `corpus` | reads and writes the files of the corpus |
//! | `kinds`, `calibration` | read each kind of bad file |
//! | `reader` | files with a value of every kind, whose mistakes are announced in comments; texts of any content |
//! | `keys` | every key of every shipped file and of every option: too low, too high, nan, of another type, missing, misspelt, twice |
//! | `texts` | no code looks into the text of a problem |
//! | `sentences` | every sentence of a message in the source is in an expected text |
#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "common/announced.rs"]
mod announced;
#[path = "diagnostics/calibrations.rs"]
mod calibration;
#[path = "diagnostics/corpus.rs"]
mod corpus;
#[path = "../tools/fuzz/src/corpus.rs"]
mod escaped;
#[path = "diagnostics/keys.rs"]
mod keys;
#[path = "diagnostics/kinds.rs"]
mod kinds;
#[path = "common/loose.rs"]
mod loose;
#[path = "diagnostics/reader.rs"]
mod reader;
#[path = "diagnostics/schema.rs"]
mod schema;
#[path = "diagnostics/sentences.rs"]
mod sentences;
#[path = "common/sources.rs"]
mod sources;
#[path = "diagnostics/texts.rs"]
mod texts;

use corpus::{Case, FOLDER};

/// All messages of the corpus, one problem each.
fn messages() -> Vec<String> {
    let cases = kinds::KINDS.iter().flat_map(|kind| corpus::cases(kind));
    let texts: Vec<String> = cases.filter_map(|case| case.message).collect();
    let blocks = texts
        .iter()
        .flat_map(|text| text.split("\n\n").map(str::to_owned));
    let mut blocks: Vec<String> = blocks.collect();
    for case in corpus::cases("reader") {
        let lines = case.input.lines().map(str::trim_start);
        blocks.extend(lines.filter_map(|line| Some(line.strip_prefix("#~ ")?.to_owned())));
    }
    blocks
}

/// Messages about the bad files that the tests make: name and text.
fn made(kind: &str) -> Vec<(String, String)> {
    let mut made = kinds::made(kind);
    if kind == "plan" {
        made.extend(kinds::plans_of_the_reader());
    }
    made
}

#[test]
fn every_bad_file_has_its_message() {
    corpus::unpack();
    let bless = std::env::var_os("CVTCYCLE_BLESS").is_some();
    let mut wrong = String::new();
    let mut count = 0;
    for kind in kinds::KINDS {
        let mut cases = corpus::cases(kind);
        let mut made = made(kind);
        let missing: Vec<_> = made
            .iter()
            .filter(|(name, _)| !cases.iter().any(|case| case.name == *name))
            .collect();
        if bless {
            cases.extend(missing.iter().map(|(name, _)| Case {
                name: name.clone(),
                ..Case::default()
            }));
            cases.sort_by(|a, b| a.name.cmp(&b.name));
        } else {
            wrong.extend(
                missing
                    .iter()
                    .map(|(name, _)| format!("{kind}.txt: no case {name}\n")),
            );
        }
        for case in &mut cases {
            let name = format!("{FOLDER}/{kind}/{}", case.name);
            let text = if case.is_made() {
                let at = made.iter().position(|(name, _)| *name == case.name);
                at.map(|at| made.swap_remove(at).1)
                    .unwrap_or_else(|| panic!("{name}: nothing makes it"))
            } else if case.name.contains('/') {
                // A data file, which a case names.
                continue;
            } else {
                kinds::message(kind, &name)
            };
            count += 1;
            if text.is_empty() {
                wrong += &format!("{name}: accepted\n");
            }
            let expected = case.message.clone().unwrap_or_default();
            if !bless && text != expected {
                wrong += &format!("==== {name}, expected\n{expected}==== found\n{text}\n");
            }
            case.message = Some(text);
        }
        assert!(cases.len() >= 2, "{kind}: {} cases", cases.len());
        if bless {
            std::fs::write(corpus::path(kind), corpus::format(&cases)).unwrap();
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(count > 130, "only {count} bad files");
}

#[test]
fn every_message_has_the_allowed_values_or_help() {
    let leads_nowhere = |block: &&String| {
        block.starts_with("error") && !block.contains("allowed: ") && !block.contains("= help: ")
    };
    let messages = messages();
    let list: Vec<&str> = messages
        .iter()
        .filter(leads_nowhere)
        .map(String::as_str)
        .collect();
    assert!(
        list.is_empty(),
        "{} of {}:\n{}",
        list.len(),
        messages.len(),
        list.join("\n\n")
    );
}

#[test]
fn every_sentence_of_the_source_has_a_bad_file() {
    sentences::check(&messages());
}

#[test]
fn every_key_complains_at_its_place() {
    keys::check();
}
