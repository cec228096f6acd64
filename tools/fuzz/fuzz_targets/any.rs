#![no_main]
//! Target named by `CVTCYCLE_FUZZ_TARGET`: see `targets`.

use std::env::var;
use std::sync::LazyLock;

static TARGET: LazyLock<String> = LazyLock::new(|| var("CVTCYCLE_FUZZ_TARGET").unwrap_or_default());

libfuzzer_sys::fuzz_target!(|data: &[u8]| cvtcycle_fuzz::targets::run(&TARGET, data));
