//! What is wrong with an input, as data: place, value, allowed range and a hint.

/// Where in the user's input a problem stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// File name as the user gave it, `embedded:NAME`, or `--set` / `--ambient` for the command line.
    pub file: String,
    /// Line, counted from 1; 0 where the input has no lines.
    pub line: usize,
    /// Column of the first character of the value, counted from 1; 0 where unknown.
    pub column: usize,
    /// The text of that line, for the caret; empty where unknown.
    pub line_text: String,
    /// Number of characters that the caret underlines.
    pub width: usize,
}

/// One problem of the user's input. All problems of an input are collected before any is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problem {
    /// Where it stands.
    pub place: Place,
    /// Dotted key, CSV column name or option; empty where the whole file is meant.
    pub key: String,
    /// The offending value as written; empty where something is missing.
    pub value: String,
    /// What would be accepted, in words or as a range with its unit; empty where there is no range.
    pub allowed: String,
    /// What is wrong, one sentence without the place.
    pub message: String,
    /// What to do about it; empty if nothing useful can be said.
    pub hint: String,
}
