//! Colours of the output.

use std::ffi::OsString;
use std::io::IsTerminal;

use clap::{ColorChoice, ValueEnum};

use super::Terminal;

/// When to colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    Auto,
    Always,
    Never,
}

/// Colours on or off.
#[derive(Clone, Copy, Debug)]
pub struct Paint(bool);

impl Colour {
    /// Word of the default.
    pub const AUTO: &'static str = "auto";

    /// The choice, found before the words are parsed.
    pub fn from_words(words: &[OsString]) -> Self {
        let words: Vec<&str> = words
            .iter()
            .filter_map(|word| word.to_str())
            .take_while(|word| *word != "--")
            .collect();
        let follows = words
            .windows(2)
            .filter(|pair| pair[0] == "--color")
            .map(|pair| pair[1]);
        let joined = words
            .iter()
            .filter_map(|word| word.strip_prefix("--color="));
        follows
            .chain(joined)
            .filter_map(|word| Colour::from_str(word, false).ok())
            .next()
            .unwrap_or(Colour::Auto)
    }

    /// The choice in clap's type.
    pub fn for_clap(self) -> ColorChoice {
        match self {
            Colour::Auto => ColorChoice::Auto,
            Colour::Always => ColorChoice::Always,
            Colour::Never => ColorChoice::Never,
        }
    }

    /// Colours of both streams.
    pub fn terminal(self) -> Terminal {
        Terminal {
            stdout: self.on(std::io::stdout().is_terminal()),
            stderr: self.on(std::io::stderr().is_terminal()),
        }
    }

    fn on(self, terminal: bool) -> Paint {
        // As no-color.org has it: set and not empty; the command line takes precedence.
        let declined = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        Paint(match self {
            Colour::Auto => terminal && !declined && !dumb,
            Colour::Always => true,
            Colour::Never => false,
        })
    }
}

impl Paint {
    /// Whether colours are on.
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
        if self.0 {
            format!("\u{1b}[{code}m{text}\u{1b}[0m")
        } else {
            text.to_owned()
        }
    }
}
