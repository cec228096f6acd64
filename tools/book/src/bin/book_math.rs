//! Preprocessor of the book: equations become MathML when the book is built, so that it needs no network to be read.
//!
//! mdBook starts it (see `docs/book/book.toml`); by hand there is nothing to do but `mdbook build docs/book`.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a preprocessor writes to standard output"
)]

use cvtcycle_book::latex;
use serde_json::Value;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    if let Some(word) = arguments.next() {
        // `supports html` is answered by the exit code; other renderers would want other mathematics.
        let html = word == "supports" && arguments.next().as_deref() == Some("html");
        return if html {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        };
    }
    let input: Result<(Value, Value), _> = serde_json::from_reader(std::io::stdin().lock());
    let Ok((_, mut book)) = input else {
        eprintln!(
            "book_math: standard input is no pair of context and book; it is started by mdbook, not by hand"
        );
        return ExitCode::from(2);
    };
    let mut problems = Vec::new();
    chapters(&mut book, &mut problems);
    for problem in &problems {
        eprintln!("book_math: {problem}");
    }
    println!("{book}");
    if problems.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// Renders the content of every chapter, wherever the version of mdBook keeps its chapters.
fn chapters(value: &mut Value, problems: &mut Vec<String>) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|item| chapters(item, problems)),
        Value::Object(map) => {
            let name = map
                .get("path")
                .and_then(Value::as_str)
                .unwrap_or("a chapter")
                .to_owned();
            for (key, item) in map.iter_mut() {
                match item {
                    Value::String(text) if key == "content" => match latex::page(text) {
                        Ok(page) => *text = page,
                        Err(list) => problems
                            .extend(list.into_iter().map(|problem| format!("{name}: {problem}"))),
                    },
                    other => chapters(other, problems),
                }
            }
        }
        _ => {}
    }
}
