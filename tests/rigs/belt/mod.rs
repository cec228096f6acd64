//! `belt`: the program against the golden tables, and good and bad input tables.
//!
//! Truth of the `val_` tests: tables of an independent program that transcribes the thesis's Appendix C statement by statement.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests; differences are printed for the book"
)]

mod files;
mod golden;
mod points;
mod table;
mod tables;

use std::process::Output;

use assert_cmd::Command;
use table::Table;

const POINTS: &str = include_str!("../../golden/belt_points.csv");
const EDGES: &str = include_str!("../../golden/belt_edge_points.csv");
const NAMES: &str = "ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm";

fn program(words: &[&str], input: &[u8]) -> Output {
    Command::cargo_bin("cvtcycle")
        .unwrap()
        .env("NO_COLOR", "1")
        .args(words)
        .write_stdin(input)
        .output()
        .unwrap()
}

fn belt(input: &[u8], more: &[&str]) -> Output {
    program(&[&["belt", "--points", "-"], more].concat(), input)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Output table for a good input.
fn made(input: &str, more: &[&str]) -> Table {
    let output = belt(input.as_bytes(), more);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    Table::new(&text(&output.stdout))
}

/// One row under the four names, after further columns given as `name=value`.
fn one(values: &str, others: &[(&str, &str)], more: &[&str]) -> Table {
    let (mut names, mut row) = (NAMES.to_owned(), values.to_owned());
    for (name, value) in others {
        names += &format!(",{name}");
        row += &format!(",{value}");
    }
    made(&format!("{names}\n{row}\n"), more)
}

/// Message about a bad table; nothing else may be written.
fn refused(input: &[u8], more: &[&str]) -> String {
    let output = belt(input, more);
    assert_eq!(output.status.code(), Some(2), "{}", text(input));
    assert_eq!(text(&output.stdout), "", "{}", text(input));
    text(&output.stderr)
}
