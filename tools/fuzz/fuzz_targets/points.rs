#![no_main]
//! See `targets::points`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("points", data));
