//! Runs the committed inputs of the fuzzers, so that corrected defects stay corrected.
//!
//! Truth: for any bytes the program answers or refuses with a message, within its documented memory; see `tools/fuzz/src/targets/mod.rs`.
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

/// Maximum size of the corpus, bytes. It holds only inputs that reach code which no other input reaches.
const MAX_BYTES: usize = 1 << 20;

const CORPUS: &str = "tools/fuzz/corpus.txt";

#[test]
fn every_committed_input_is_answered_or_refused() {
    let text = read_to_string(CORPUS).unwrap();
    let mut size = 0;
    let mut packed = String::new();
    for (name, _) in targets::TARGETS {
        let wrong = |line| panic!("{CORPUS}:{line}: wrong escape");
        let inputs = corpus::inputs(&text, name).unwrap_or_else(wrong);
        assert!(inputs.len() >= 10, "{name} has {} inputs", inputs.len());
        for (number, bytes) in inputs.iter().enumerate() {
            let answered = std::panic::catch_unwind(|| targets::run(name, bytes));
            assert!(answered.is_ok(), "{name}, input {}", number + 1);
            size += bytes.len();
        }
        packed += &corpus::lines(name, inputs);
    }
    assert!(
        packed == text,
        "{CORPUS}: `corpus pack` would write it otherwise"
    );
    assert!(size <= MAX_BYTES, "{size} bytes");
}

/// Checks that the memory bound can fail: it is finite, and the counter counts.
#[test]
fn memory_is_counted() {
    let held =
        allocation_counter::measure(|| drop(std::hint::black_box(vec![1_u8; 1 << 20]))).bytes_max;
    assert!(held >= 1 << 20);
    assert!(targets::max_bytes(0) < targets::max_bytes(1000));
}
