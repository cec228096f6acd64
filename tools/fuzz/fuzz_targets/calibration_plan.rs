#![no_main]
//! See `targets::calibration_plan`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run("calibration_plan", data));
