#![no_main]
//! See `targets::history`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("history", data));
