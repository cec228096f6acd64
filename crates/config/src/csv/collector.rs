//! Collects the problems of a CSV file with their places.

use super::text::{Delimiter, Field, decode, empty, split};
use crate::problem::source::shortened;
use crate::{Input, Place, Problem, Problems};

/// Most problems that are described; the rest is counted.
const MAX_SHOWN: usize = 50;
/// A longer line is no row of a table, but another file.
pub(crate) const MAX_LINE_LEN: usize = 1 << 20;
/// No table has as many columns; each unknown one is compared with all known ones.
pub(super) const MAX_COLUMNS: usize = 1000;
// a longer line would only fill the screen
const MAX_SHOWN_LEN: usize = 500;
const MAX_VALUE_LEN: usize = 60;

/// One line of the file.
#[derive(Clone, Copy, Debug)]
pub struct Line<'t> {
    /// Counted from 1.
    pub number: usize,
    /// Without its line end.
    pub text: &'t str,
}

/// One value in its column.
#[derive(Clone, Copy, Debug)]
pub struct Cell<'t> {
    /// Line.
    pub line: Line<'t>,
    /// Column.
    pub key: &'t str,
    /// Value.
    pub field: Field,
}

impl<'t> Line<'t> {
    /// The value of a field of this line.
    #[must_use]
    pub fn text_of(&self, field: Field) -> &'t str {
        self.text.get(field.start..field.end).unwrap_or_default()
    }

    /// True if it is neither blank nor a comment, which begins with `#`.
    pub(super) fn has_content(&self) -> bool {
        let text = self.text.trim_start();
        !text.is_empty() && !text.starts_with('#')
    }

    /// Column of the first character of a field, counted from 1, and its number of characters, at least 1.
    #[must_use]
    pub fn columns_of(&self, field: Field) -> (usize, usize) {
        let before = self.text.get(..field.start).unwrap_or_default();
        let width = self.text_of(field).chars().count();
        (before.chars().count() + 1, width.max(1))
    }
}

impl<'t> Cell<'t> {
    /// Value.
    #[must_use]
    pub fn text(&self) -> &'t str {
        self.line.text_of(self.field)
    }
}

/// The problems found so far.
#[derive(Debug)]
pub struct Collector<'f> {
    file: &'f str,
    list: Problems,
    more: usize,
}

impl<'f> Collector<'f> {
    /// An empty collection for a file of that name.
    #[must_use]
    pub fn new(file: &'f str) -> Self {
        Self {
            file,
            list: Problems::new(),
            more: 0,
        }
    }

    /// The lines that are neither blank nor a comment; none where the bytes are no text or a line is too long for a table, which is reported.
    pub fn lines<'t>(
        &mut self,
        bytes: &'t [u8],
    ) -> Option<impl Iterator<Item = Line<'t>> + Clone + use<'t>> {
        match decode(bytes).and_then(no_long_line) {
            Ok(text) => Some(
                (1..)
                    .zip(text.lines())
                    .map(|(number, text)| Line { number, text })
                    .filter(Line::has_content),
            ),
            Err(complaint) => {
                self.file(complaint);
                None
            }
        }
    }

    /// Number of problems so far.
    #[must_use]
    pub fn count(&self) -> usize {
        self.list.len() + self.more
    }

    /// True if there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The column names of a line; none where the lines below it cannot be understood, which is reported.
    pub(super) fn names(&mut self, line: Line<'_>, delimiter: Delimiter) -> Option<Vec<Field>> {
        let mut fields = Vec::new();
        match split(line.text, delimiter.sign(), &mut fields) {
            Ok(()) if fields.len() > MAX_COLUMNS => {
                let message = format!("this line has {} column names", fields.len());
                let hint = "keep the columns that are needed, with a row for every point";
                self.line(line, "", || {
                    Problem::too_large(message)
                        .allowed(format!("up to {MAX_COLUMNS}"))
                        .hint(hint)
                });
                None
            }
            Ok(()) => Some(fields),
            Err(start) => {
                self.open_quote(line, start);
                None
            }
        }
    }

    /// Splits a row into as many fields as there are column names; false after reporting that it has others.
    pub(super) fn split(
        &mut self,
        line: Line<'_>,
        delimiter: Delimiter,
        wanted: usize,
        fields: &mut Vec<Field>,
    ) -> bool {
        if let Err(start) = split(line.text, delimiter.sign(), fields) {
            self.open_quote(line, start);
            return false;
        }
        let found = fields.len();
        if found != wanted {
            self.line(line, "", || other_count(delimiter, found, wanted));
        }
        found == wanted
    }

    /// Reports that the quote at that byte of the line is not closed.
    fn open_quote(&mut self, line: Line<'_>, start: usize) {
        let field = Field {
            start,
            end: line.text.len(),
        };
        self.value(line, field, "", || {
            Problem::syntax("this quote is not closed")
                .hint("close it behind the value, or remove it")
        });
    }

    /// Reports a problem of the whole file.
    pub fn file(&mut self, problem: Problem) {
        self.push(|file| problem.in_file(file));
    }

    /// Reports that the file is empty; nothing after another problem of the whole file.
    pub fn no_text(&mut self) {
        if self.is_empty() {
            self.file(empty());
        }
    }

    /// Reports that there are column names only.
    pub fn no_rows(&mut self, expected: &str) {
        let problem = Problem::missing("the file has column names and no rows");
        self.file(problem.allowed(expected).hint("add the rows"));
    }

    /// Reports a problem of a whole line; `key` is the column that is meant, if any.
    pub fn line(&mut self, line: Line<'_>, key: &str, problem: impl FnOnce() -> Problem) {
        let whole = Field {
            start: 0,
            end: line.text.len(),
        };
        self.push(|file| problem().at(place(file, line, whole)).for_key(key));
    }

    /// Reports a problem of one value of the column `key`.
    pub fn value(
        &mut self,
        line: Line<'_>,
        field: Field,
        key: &str,
        problem: impl FnOnce() -> Problem,
    ) {
        self.push(|file| {
            problem()
                .at(place(file, line, field))
                .for_key(key)
                .value(shortened(line.text_of(field), MAX_VALUE_LEN))
        });
    }

    /// Reports a problem of one cell.
    pub fn cell(&mut self, cell: &Cell<'_>, problem: impl FnOnce() -> Problem) {
        self.value(cell.line, cell.field, cell.key, problem);
    }

    /// Adds a problem that has its place.
    pub fn add(&mut self, problem: Problem) {
        self.push(|_| problem);
    }

    // made only if it will be shown, so that a file of a million bad rows costs nothing
    fn push(&mut self, make: impl FnOnce(&str) -> Problem) {
        if self.list.len() >= MAX_SHOWN {
            self.more += 1;
        } else {
            self.list.push(make(self.file));
        }
    }

    /// All of them; beyond the first 50, one last entry says how many more there are.
    #[must_use]
    pub fn finish(mut self) -> Problems {
        if self.more > 0 {
            self.list
                .push(Problem::more(Input::File(self.file.to_owned()), self.more));
        }
        self.list
    }
}

/// A row has `found` values in place of `wanted` ones.
fn other_count(delimiter: Delimiter, found: usize, wanted: usize) -> Problem {
    let commas = delimiter == Delimiter::Comma;
    let message = match found {
        1 => "this row has 1 value".to_owned(),
        // Every value may have a decimal comma, or none.
        _ if commas && found == 2 * wanted => format!(
            "this row has {found} values, or {wanted} with decimal commas: it can be read in two ways"
        ),
        _ => format!("this row has {found} values"),
    };
    let sign = delimiter.word();
    let hint = match found > wanted {
        true if commas => {
            "are there decimal commas? write 12.5 and not 12,5, or put semicolons between the columns"
                .to_owned()
        }
        true => format!("a {sign} within a value needs double quotes around it"),
        false => format!("an empty value keeps its {sign}; was the file cut off?"),
    };
    Problem::syntax(message)
        .allowed(format!("{wanted}, as the line of column names has"))
        .hint(hint)
}

fn no_long_line(text: &str) -> Result<&str, Problem> {
    let too_long = |line: &str| line.len() >= MAX_LINE_LEN;
    match text.split('\n').position(too_long) {
        Some(before) => Err(long_line(before + 1)),
        None => Ok(text),
    }
}

/// A line is longer than [`MAX_LINE_LEN`].
pub(crate) fn long_line(number: usize) -> Problem {
    Problem::too_large(format!("line {number} is too long for a row of a table"))
        .allowed(format!("up to {MAX_LINE_LEN} bytes"))
        .hint("is this a CSV file?")
}

fn place(file: &str, line: Line<'_>, field: Field) -> Place {
    let (column, width) = line.columns_of(field);
    let shown = line.text.len() <= MAX_SHOWN_LEN;
    let line_text = if shown { line.text } else { "" };
    Place {
        line: line.number,
        column,
        line_text: line_text.into(),
        width,
        ..Place::file(file)
    }
}
