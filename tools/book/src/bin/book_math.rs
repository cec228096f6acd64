//! Preprocessor of the book: converts equations to MathML when the book is built, so that pages need no network, and inlines drawings,
//! so that the theme colours them.
//! mdBook starts it (see `docs/book/book.toml`); by hand, run `mdbook build docs/book`.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a preprocessor writes to standard output"
)]

use cvtcycle_book::{latex, pictures};
use serde_json::Value;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    if let Some(word) = arguments.next() {
        // mdBook expects the answer to `supports html` as exit code; other renderers would need other mathematics.
        let html = word == "supports" && arguments.next().as_deref() == Some("html");
        return if html {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        };
    }
    let input: Result<(Value, Value), _> = serde_json::from_reader(std::io::stdin().lock());
    let Ok((context, mut book)) = input else {
        eprintln!(
            "book_math: standard input is no pair of context and book; it is started by mdbook, not by hand"
        );
        return ExitCode::from(2);
    };
    let part = |place: &str| context.pointer(place).and_then(Value::as_str);
    let source =
        Path::new(part("/root").unwrap_or(".")).join(part("/config/book/src").unwrap_or("src"));
    let mut problems = Vec::new();
    chapters(&mut book, &source, &mut problems);
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

/// Converts equations of a page to MathML and inlines its drawings.
fn rendered(text: &str, source: &Path) -> Result<String, Vec<String>> {
    let read = |name: &str| std::fs::read_to_string(source.join(name)).ok();
    pictures::page(&latex::page(text)?, read)
}

/// Converts the content of every chapter, wherever the version of mdBook keeps its chapters.
fn chapters(value: &mut Value, source: &Path, problems: &mut Vec<String>) {
    match value {
        Value::Array(list) => list
            .iter_mut()
            .for_each(|item| chapters(item, source, problems)),
        Value::Object(map) => {
            let name = map
                .get("path")
                .and_then(Value::as_str)
                .unwrap_or("a chapter")
                .to_owned();
            for (key, item) in map.iter_mut() {
                match item {
                    Value::String(text) if key == "content" => match rendered(text, source) {
                        Ok(page) => *text = page,
                        Err(list) => problems
                            .extend(list.into_iter().map(|problem| format!("{name}: {problem}"))),
                    },
                    other => chapters(other, source, problems),
                }
            }
        }
        _ => {}
    }
}
