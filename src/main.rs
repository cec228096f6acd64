//! Command line of cvtcycle.

mod args;
mod commands;
mod print;

fn main() -> std::process::ExitCode {
    commands::main()
}
