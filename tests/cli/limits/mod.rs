//! Files of any size. A file beyond its limit is refused with one message, and the memory for a hostile file stays below a
//! documented bound (docs/limits.md). The operating system enforces the bound: the program runs under a limit of its address space, so that
//! one allocation too many ends it.
#![cfg(target_os = "linux")]
#![allow(missing_docs, clippy::unwrap_used, reason = "helpers of tests")]

mod names;
mod parquet;
mod sizes;
mod structure;

use std::fs::{self, File};
use std::path::Path;
use std::process::Output;

use tempfile::TempDir;

/// Bytes of one MiB.
pub const MIB: u64 = 1 << 20;
/// Address space of the program with its threads, without input, MiB.
pub const PROGRAM_MIB: u64 = 160;

/// Creates a folder with small inputs: a cycle, a plan, a calibration, a vehicle, and a run of it.
pub fn folder() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    let cycle = "time_s,speed_kmh\n0,0\n4,0\n14,32\n24,32\n34,0\n";
    let calibration = "[calibration]\nvehicle = \"rover_216_cvt\"\n[[parameter]]\nkey = \"transmission.cvt.pump.displacement_cc_rev\"\nlow = 5\n\
        high = 20\n[[data]]\nfrom = \"a test\"\npoints = \"big.csv\"\nsd = 0.1\n";
    for (name, text) in [("short.csv", cycle), ("calibration.toml", calibration)] {
        fs::write(dir.path().join(name), text).unwrap();
    }
    dir
}

/// Creates a sparse file of a size, which takes no room on the disk.
pub fn sparse(path: &Path, bytes: u64) {
    File::create(path).unwrap().set_len(bytes).unwrap();
}

/// Drives the short cycle of [`folder`] with one car into `made`.
pub fn short_run(dir: &Path) {
    let made = within(
        dir,
        1000,
        "run --cycle short.csv --baseline none --sensitivity never --quiet --out made",
    );
    assert_eq!(
        made.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
}

/// Runs the program in a folder with a limit of memory beyond its own, MiB; a run that takes too long is killed.
pub fn within(dir: &Path, mib: u64, line: &str) -> Output {
    let script = format!(
        "ulimit -v {}; exec \"$0\" {line}",
        (PROGRAM_MIB + mib) * 1024
    );
    let program = assert_cmd::cargo::cargo_bin("cvtcycle");
    let mut command = assert_cmd::Command::new("sh");
    // One thread, since each has a stack and an arena in the address space.
    command
        .current_dir(dir)
        .env("RAYON_NUM_THREADS", "1")
        .env("MALLOC_ARENA_MAX", "1")
        .arg("-c")
        .arg(script)
        .arg(program);
    command
        .timeout(std::time::Duration::from_secs(120))
        .output()
        .unwrap()
}

/// Message about bad input, which the program must refuse.
pub fn refused(dir: &Path, mib: u64, line: &str) -> String {
    let output = within(dir, mib, line);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(
        output.status.code(),
        Some(2),
        "{line}: {:?}\n{}",
        output.status,
        printed.chars().take(2000).collect::<String>()
    );
    printed
}

/// As [`refused`], for exactly one problem with these words.
pub fn refused_once(dir: &Path, mib: u64, line: &str, words: &[&str]) {
    let printed = refused(dir, mib, line);
    for word in words {
        assert!(printed.contains(word), "{line}: no {word:?} in\n{printed}");
    }
    let last = printed.lines().last().unwrap_or_default();
    assert!(last.starts_with("1 problem"), "{line}:\n{printed}");
    assert!(printed.len() < 3000, "{line}: {} bytes", printed.len());
}
