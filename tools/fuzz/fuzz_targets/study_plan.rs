#![no_main]
//! See `targets::study_plan`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("study_plan", data));
