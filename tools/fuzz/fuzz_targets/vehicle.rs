#![no_main]
//! See `targets::vehicle`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("vehicle", data));
