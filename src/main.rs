//! The program `cvtcycle`: command line to library calls, results to text. It computes nothing.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(cvtcycle::program(std::env::args_os()))
}
