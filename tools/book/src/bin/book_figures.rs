//! Writes the figures and the generated tables of the book: `cargo run --release -p cvtcycle-book --bin book_figures`.
//!
//! `tools/docs` runs it; the files are not in git.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program that prints"
)]

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book/src");
    let files = match cvtcycle_book::figures::files(&folder) {
        Ok(files) => files,
        Err(why) => {
            eprintln!("{why}");
            return ExitCode::FAILURE;
        }
    };
    for (name, text) in files {
        let path = folder.join(&name);
        let old = std::fs::read_to_string(&path).unwrap_or_default();
        if old == text {
            continue;
        }
        if let Err(why) = std::fs::write(&path, text) {
            eprintln!("{}: {why}", path.display());
            return ExitCode::FAILURE;
        }
        println!("{name}");
    }
    ExitCode::SUCCESS
}
