//! Targets of the fuzzers; `tests/fuzz_corpus.rs` of the program runs them over the committed inputs.

#![forbid(unsafe_code)]

pub mod corpus;
pub mod targets;
