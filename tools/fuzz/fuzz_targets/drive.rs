#![no_main]
//! See `targets::drive`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("drive", data));
