#![no_main]
//! See `targets::measured`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("measured", data));
