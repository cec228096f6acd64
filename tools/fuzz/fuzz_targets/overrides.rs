#![no_main]
//! See `targets::overrides`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("overrides", data));
