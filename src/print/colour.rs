//! Colours of the output.

use std::env::var_os;
use std::ffi::OsString;
use std::io::IsTerminal;

use clap::{ColorChoice, ValueEnum};

/// Colours of the two output streams.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    /// Colours of standard output.
    pub stdout: Paint,
    /// Colours of standard error.
    pub stderr: Paint,
}

/// Colours on or off.
#[derive(Clone, Copy, Debug)]
pub struct Paint(bool);

/// The choice of `--color`, found before the words are parsed.
pub fn choice(words: &[OsString]) -> ColorChoice {
    let words = words.iter().filter_map(|word| word.to_str());
    let words: Vec<&str> = words.take_while(|word| *word != "--").collect();
    let pairs = words.windows(2).filter(|pair| pair[0] == "--color");
    let joined = words
        .iter()
        .filter_map(|word| word.strip_prefix("--color="));
    let mut given = pairs.map(|pair| pair[1]).chain(joined);
    let choice = given.find_map(|word| ColorChoice::from_str(word, false).ok());
    choice.unwrap_or(ColorChoice::Auto)
}

impl Terminal {
    /// Colours of both streams.
    pub fn new(choice: ColorChoice) -> Self {
        // As no-color.org has it: set and not empty; the command line takes precedence.
        let declined = var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let dumb = var_os("TERM").is_some_and(|term| term == "dumb");
        let on = |is_terminal: bool| match choice {
            ColorChoice::Auto => Paint(is_terminal && !declined && !dumb),
            ColorChoice::Always => Paint(true),
            ColorChoice::Never => Paint(false),
        };
        Terminal {
            stdout: on(std::io::stdout().is_terminal()),
            stderr: on(std::io::stderr().is_terminal()),
        }
    }
}

impl Paint {
    /// True if colours are on.
    pub fn is_on(self) -> bool {
        self.0
    }

    /// A heading.
    pub fn heading(self, text: &str) -> String {
        self.wrap("1", text)
    }

    /// A failure.
    pub fn bad(self, text: &str) -> String {
        self.wrap("1;31", text)
    }

    fn wrap(self, code: &str, text: &str) -> String {
        match self.0 {
            true => format!("\u{1b}[{code}m{text}\u{1b}[0m"),
            false => text.to_owned(),
        }
    }
}
