//! The test benches, the belt command and tables of losses, through the library and the program.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../common/mod.rs"]
mod common;

mod belt;
mod loss_columns;
mod losses;
mod rig_transmission;
mod rig_variator;

use std::process::Output;

use assert_cmd::Command;

/// What the program answers to a command and its words.
fn run(command: &[&str], words: &[&str]) -> Output {
    Command::cargo_bin("cvtcycle")
        .unwrap()
        .args(command)
        .args(words)
        .output()
        .unwrap()
}

/// What a command prints that must succeed.
fn printed(command: &[&str], words: &[&str]) -> String {
    let output = run(command, words);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{words:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}
