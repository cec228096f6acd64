//! Command line of cvtcycle.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
