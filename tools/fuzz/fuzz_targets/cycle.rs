#![no_main]
//! See `targets::cycle`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("cycle", data));
