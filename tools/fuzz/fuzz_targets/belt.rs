#![no_main]
//! See `targets::belt`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("belt", data));
