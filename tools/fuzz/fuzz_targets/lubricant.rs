#![no_main]
//! See `targets::lubricant`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("lubricant", data));
