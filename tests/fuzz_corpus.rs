//! Runs the committed inputs of the fuzzers with the targets of the fuzzers: a mended defect stays mended.
//!
//! Truth: for any bytes the program answers or refuses with words, within the memory that it states; see `tools/fuzz/src/targets/mod.rs`.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a failed unwrap fails the test; a target prints its input on request"
)]

#[path = "../tools/fuzz/src/corpus.rs"]
mod corpus;
#[path = "../tools/fuzz/src/targets/mod.rs"]
mod targets;

use std::fs::read_to_string;

/// Limit of the corpus in bytes: it holds only inputs that reach code which no other input reaches.
const MAX_BYTES: usize = 1 << 20;

fn inputs(target: &str) -> Vec<Vec<u8>> {
    let name = format!("tools/fuzz/corpus/{target}.txt");
    let text = read_to_string(&name).unwrap_or_else(|error| panic!("{name}: {error}"));
    corpus::parse(&text).unwrap_or_else(|line| panic!("{name}:{line}: wrong escape"))
}

#[test]
fn every_committed_input_is_answered_or_refused() {
    for (name, _) in targets::TARGETS {
        let inputs = inputs(name);
        assert!(inputs.len() >= 10, "{name} has {} inputs", inputs.len());
        for (number, bytes) in inputs.iter().enumerate() {
            let answered = std::panic::catch_unwind(|| targets::run(name, bytes));
            assert!(answered.is_ok(), "{name}.txt:{}", number + 1);
        }
    }
}

#[test]
fn every_target_has_a_program_and_a_small_corpus() {
    let manifest = read_to_string("tools/fuzz/Cargo.toml").unwrap();
    let files = std::fs::read_dir("tools/fuzz/corpus").unwrap();
    let files = files.filter(|entry| entry.as_ref().unwrap().path().is_file());
    assert_eq!(files.count(), targets::TARGETS.len());
    let mut size = 0;
    for (name, _) in targets::TARGETS {
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
        let program = read_to_string(format!("tools/fuzz/fuzz_targets/{name}.rs")).unwrap();
        let call = format!("run(\"{name}\", data)");
        assert!(program.contains(&call), "{name}");
        let inputs = inputs(name);
        size += inputs.iter().map(Vec::len).sum::<usize>();
        assert_eq!(
            inputs.len(),
            corpus::parse(&corpus::format(inputs)).unwrap().len(),
            "{name}: twice"
        );
    }
    assert!(size <= MAX_BYTES, "{size} bytes");
}

/// The bound on memory can fail: it is a number, and the counter counts.
#[test]
fn memory_is_counted() {
    let held =
        allocation_counter::measure(|| drop(std::hint::black_box(vec![1_u8; 1 << 20]))).bytes_max;
    assert!(held >= 1 << 20);
    assert!(targets::most_bytes(0) < targets::most_bytes(1000));
}
