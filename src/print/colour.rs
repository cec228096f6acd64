//! Colours of the output.

use std::env::var_os;
use std::ffi::OsString;
use std::io::IsTerminal;

use clap::{ColorChoice, ValueEnum};
use cvtcycle::output::table::set_line_width;
use terminal_size::{Width, terminal_size_of};

/// Style markers within the program: Unicode noncharacters, replaced by escape codes in [`Screen`](super::screen::Screen). One
/// in the text of a file can make its line bold and do nothing else.
const HEADING: char = '\u{FDD0}';
const BAD: char = '\u{FDD1}';
pub const STYLE_END: char = '\u{FDD2}';
const GOOD: char = '\u{FDD3}';
const FAINT: char = '\u{FDD4}';
const STYLES: [(char, &str); 5] = [
    (HEADING, "\u{1b}[1m"),
    (BAD, "\u{1b}[1;31m"),
    (GOOD, "\u{1b}[32m"),
    (FAINT, "\u{1b}[2m"),
    (STYLE_END, "\u{1b}[0m"),
];

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

/// Value of `--color`, found before clap parses the words.
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
    /// Detects colours of both streams, and the table width from the terminal of standard output.
    pub fn new(choice: ColorChoice) -> Self {
        if let Some((Width(columns), _)) = terminal_size_of(std::io::stdout()) {
            set_line_width(columns.into());
        }
        // no-color.org: set and not empty. The command line takes precedence.
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
    /// No colours.
    pub const NONE: Paint = Paint(false);

    /// True if colours are on.
    pub fn is_on(self) -> bool {
        self.0
    }

    /// Styles a heading.
    pub fn heading(self, text: &str) -> String {
        self.wrap(HEADING, text)
    }

    /// Styles agreement.
    pub fn good(self, text: &str) -> String {
        self.wrap(GOOD, text)
    }

    /// Styles an inconclusive value.
    pub fn faint(self, text: &str) -> String {
        self.wrap(FAINT, text)
    }

    /// Styles a failure.
    pub fn bad(self, text: &str) -> String {
        self.wrap(BAD, text)
    }

    fn wrap(self, style: char, text: &str) -> String {
        match self.0 {
            true => format!("{style}{text}{STYLE_END}"),
            false => text.to_owned(),
        }
    }

    /// Escape code of a style marker. None for other characters, and without colours.
    pub fn code(self, mark: char) -> Option<&'static str> {
        let styles = STYLES.iter().filter(|_| self.0);
        let mut codes = styles.filter(|(style, _)| *style == mark);
        codes.next().map(|(_, code)| *code)
    }
}
