//! The text of an input, and places in it.
use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

use crate::problem::place::{Input, Place};

/// A longer line is not repeated with a problem.
const MAX_LINE: usize = 1000;
/// A longer value is cut where it is repeated.
pub(crate) const MAX_VALUE: usize = 200;

/// One input: the file, one that it inherits from, or one override.
#[derive(Debug)]
pub(crate) struct Source {
    pub input: Input,
    pub text: String,
    /// Relation to the file that inherits from it.
    pub parent: Option<Parent>,
    /// Bytes of the line ends; found when the first place is needed.
    ends: OnceLock<Vec<usize>>,
}

/// A file that another one inherits from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Parent {
    /// Status of its values in the file that inherits them.
    pub status: &'static str,
    /// From where they come, as `show` says it.
    pub from: String,
    /// Source of its values in the file that inherits them.
    pub words: String,
    /// Folder, relative to that of the file.
    pub folder: PathBuf,
}

impl Source {
    /// As an input that a file inherits from.
    pub fn inherited(self, parent: Option<Parent>) -> Self {
        Source { parent, ..self }
    }

    /// An input with its text.
    pub fn new(input: Input, text: &str) -> Self {
        Source {
            input,
            text: text.to_string(),
            parent: None,
            ends: OnceLock::new(),
        }
    }

    /// The place of a stretch of the text.
    pub fn place(&self, range: Range<usize>) -> Place {
        let whole = Place::from(self.input.clone());
        // Only a file has lines that a user could look up.
        if whole.file_name().is_none() {
            return whole;
        }
        let start = self.clamp(range.start);
        let line_start = self.line_start(start);
        let line_text = self.line_at(start);
        let end = self.clamp(range.end).clamp(
            start,
            line_start.max(start).max(line_start + line_text.len()),
        );
        Place {
            line: self.line(start) + 1,
            column: self.text[line_start..start].chars().count() + 1,
            line_text: if line_text.len() <= MAX_LINE {
                line_text.into()
            } else {
                "".into()
            },
            width: self.text[start..end].chars().count().max(1),
            ..whole
        }
    }

    /// Line of that place, 0 where the input has none.
    pub fn line_number(&self, range: &Range<usize>) -> usize {
        match self.input {
            Input::File(_) => self.line(self.clamp(range.start)) + 1,
            _ => 0,
        }
    }

    /// Number of line ends before a byte; looked up, since a file may have as many problems as lines.
    fn line(&self, at: usize) -> usize {
        // Searched word by word: byte by byte takes as long as the parser.
        let newlines = || self.text.match_indices('\n').map(|(at, _)| at).collect();
        self.ends
            .get_or_init(newlines)
            .partition_point(|end| *end < at)
    }

    /// Start of the line of a byte.
    pub fn line_start(&self, at: usize) -> usize {
        let line = self.line(self.clamp(at));
        self.ends
            .get()
            .and_then(|ends| ends.get(line.checked_sub(1)?))
            .map_or(0, |end| end + 1)
    }

    /// The line of a byte, without its end.
    pub fn line_at(&self, at: usize) -> &str {
        let start = self.line_start(at);
        let end = self
            .ends
            .get()
            .and_then(|ends| ends.get(self.line(self.clamp(at))))
            .map_or(self.text.len(), |end| end + 1);
        self.text[start..end].lines().next().unwrap_or_default()
    }

    /// The nearest earlier start of a character. The end of the text counts as the end of its last
    /// line with content, since nothing can be shown on the empty line after it.
    pub fn clamp(&self, at: usize) -> usize {
        let mut at = if at >= self.text.len() {
            self.text.trim_end().len()
        } else {
            at
        };
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }
}

/// A text as it is repeated in a problem: at most so many characters of it.
pub(crate) fn shortened(text: &str, max: usize) -> String {
    match text.char_indices().nth(max) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_the_text_is_shown_on_its_last_line() {
        let source = Source::new(Input::File("car.toml".into()), "a = 1\nb = [1\n\n\n");
        let place = source.place(15..15);
        assert_eq!((place.line, place.column, place.width), (2, 7, 1));
        assert_eq!(&*place.line_text, "b = [1");
    }
}
