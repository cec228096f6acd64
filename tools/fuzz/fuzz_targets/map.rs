#![no_main]
//! See `targets::map`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("map", data));
