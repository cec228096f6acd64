//! Writes `intervals/penalty.csv` to stdout: the spread of the CVT's penalty over 256 draws of the plan of uncertainty, for the usual cases.
//!
//! `cargo run --release --example intervals > target/penalty.csv && mv target/penalty.csv intervals/`

use std::io::Write;

use cvtcycle::analysis::known::file;
use cvtcycle::config::render;

fn main() -> std::process::ExitCode {
    match file() {
        Ok(text) => match std::io::stdout().write_all(text.as_bytes()) {
            Ok(()) => std::process::ExitCode::SUCCESS,
            Err(_) => std::process::ExitCode::FAILURE,
        },
        Err(problems) => {
            let text = render(&problems, false);
            let _ = std::io::stderr().write_all(text.as_bytes());
            std::process::ExitCode::from(2)
        }
    }
}
