//! What the fuzzers run; `tests/fuzz_corpus.rs` of the program runs the same over the committed inputs.

#![forbid(unsafe_code)]

pub mod corpus;
pub mod targets;
