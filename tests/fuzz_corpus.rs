//! The committed inputs of the fuzzers, run by the fuzzers' own targets: what was once found stays mended.
//!
//! Truth: for any bytes the program answers or refuses with words, within the memory that it states; see `fuzz/src/targets/mod.rs`.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "tests stop at the first surprise; a target tells on request"
)]

#[path = "../fuzz/src/targets/mod.rs"]
mod targets;

use std::path::{Path, PathBuf};

/// The corpus is kept small: what has to be committed is what reaches code that nothing else reaches.
const MOST_BYTES: u64 = 1 << 20;

fn corpus(target: &str) -> Vec<PathBuf> {
    let folder = Path::new("fuzz/corpus").join(target);
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
}

#[test]
fn every_committed_input_is_answered_or_refused() {
    for (name, _) in targets::TARGETS {
        let files = corpus(name);
        assert!(files.len() >= 10, "{name} has {} inputs", files.len());
        for file in files {
            let bytes = std::fs::read(&file).unwrap();
            let answered = std::panic::catch_unwind(|| targets::run(name, &bytes));
            assert!(answered.is_ok(), "{}", file.display());
        }
    }
}

#[test]
fn every_target_has_a_program_and_a_small_corpus() {
    let manifest = std::fs::read_to_string("fuzz/Cargo.toml").unwrap();
    let folders = std::fs::read_dir("fuzz/corpus").unwrap().count();
    assert_eq!(folders, targets::TARGETS.len());
    let mut size = 0;
    for (name, _) in targets::TARGETS {
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
        let program = std::fs::read_to_string(format!("fuzz/fuzz_targets/{name}.rs")).unwrap();
        assert!(
            program.contains(&format!("run(\"{name}\", data)")),
            "{name}"
        );
        size += corpus(name)
            .iter()
            .map(|file| file.metadata().unwrap().len())
            .sum::<u64>();
    }
    assert!(size <= MOST_BYTES, "{size} bytes");
}

/// The bound on memory can fail: it is a number, and the counter counts.
#[test]
fn memory_is_counted() {
    let held =
        allocation_counter::measure(|| drop(std::hint::black_box(vec![1_u8; 1 << 20]))).bytes_max;
    assert!(held >= 1 << 20);
    assert!(targets::most_bytes(0) < targets::most_bytes(1000));
}
