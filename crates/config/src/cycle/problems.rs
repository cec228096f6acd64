//! Collecting the problems of a CSV file and saying where each stands.

use super::text::{Field, decode, split};
use crate::{Place, Problem, Problems};

/// More than these help nobody; the rest is counted.
const SHOWN: usize = 50;
/// A longer line is no row of a table, but another file.
const MAX_LINE: usize = 1 << 20;
/// No table has as many columns; each unknown one is compared with all known ones.
const MAX_COLUMNS: usize = 1000;
// a longer line would only fill the screen
const MAX_SHOWN: usize = 500;
const MAX_VALUE: usize = 60;

/// One line of the file.
#[derive(Clone, Copy, Debug)]
pub struct Line<'t> {
    /// Counted from 1.
    pub number: usize,
    /// Without its line end.
    pub text: &'t str,
}

/// One value in its column, for reading and for complaining.
#[derive(Clone, Copy, Debug)]
pub struct Cell<'t> {
    /// Its line.
    pub line: Line<'t>,
    /// Its column.
    pub key: &'static str,
    /// Its value.
    pub field: Field<'t>,
}

/// What is wrong, without the place.
#[derive(Clone, Debug, Default)]
pub struct Complaint {
    /// What is wrong, one sentence.
    pub message: String,
    /// What would be accepted; empty where there is nothing to say.
    pub allowed: String,
    /// What to do about it; may be empty.
    pub hint: String,
}

impl Complaint {
    /// From its three texts.
    #[must_use]
    pub fn new(
        message: impl Into<String>,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self {
            message: message.into(),
            allowed: allowed.into(),
            hint: hint.into(),
        }
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
    /// None yet, of a file of that name.
    #[must_use]
    pub fn new(file: &'f str) -> Self {
        Self {
            file,
            list: Problems::new(),
            more: 0,
        }
    }

    /// The lines of a file that have something on them; none, and said so, where the bytes are no text or a line is too long for a table.
    pub fn lines<'t>(
        &mut self,
        bytes: &'t [u8],
    ) -> Option<impl Iterator<Item = Line<'t>> + use<'t>> {
        match decode(bytes).and_then(no_long_line) {
            Ok(text) => Some(
                (1..)
                    .zip(text.lines())
                    .map(|(number, text)| Line { number, text })
                    .filter(|line| !line.text.trim().is_empty()),
            ),
            Err(complaint) => {
                self.file(complaint);
                None
            }
        }
    }

    /// Whether none was found.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether the line of column names has commas between them, and no other separator.
    pub fn is_table(&mut self, line: Line<'_>) -> bool {
        let count = |separator| line.text.matches(separator).count();
        for (separator, name) in [(';', ";"), ('\t', "tabs")] {
            if count(separator) > count(',') {
                let message = format!("this file uses {name} - save it with commas");
                let hint = "and with decimal points: 12.5 and not 12,5";
                self.line(line, "", || {
                    Complaint::new(message, "commas between the columns", hint)
                });
                return false;
            }
        }
        true
    }

    /// The column names of the first line; none, and said so, where the lines below it cannot be understood.
    pub fn names<'t>(&mut self, line: Line<'t>) -> Option<Vec<Field<'t>>> {
        if !self.is_table(line) {
            return None;
        }
        let mut fields = Vec::new();
        match split(line.text, &mut fields) {
            Ok(()) if fields.len() > MAX_COLUMNS => {
                let message = format!("this line has {} column names", fields.len());
                let hint = "keep the columns that are needed, with a row for every point";
                self.line(line, "", || {
                    Complaint::new(message, format!("up to {MAX_COLUMNS}"), hint)
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

    /// Splits a row into as many fields as there are column names; says what is wrong where that fails.
    pub fn split<'t>(
        &mut self,
        line: Line<'t>,
        wanted: usize,
        fields: &mut Vec<Field<'t>>,
    ) -> bool {
        if let Err(start) = split(line.text, fields) {
            self.open_quote(line, start);
            return false;
        }
        let found = fields.len();
        if found != wanted {
            self.line(line, "", || {
                let hint = if found > wanted {
                    "are there decimal commas? write 12.5 and not 12,5"
                } else {
                    "an empty value keeps its comma; was the file cut off?"
                };
                let message = format!(
                    "this row has {found} {}",
                    if found == 1 { "value" } else { "values" }
                );
                Complaint::new(
                    message,
                    format!("{wanted}, as the line of column names has"),
                    hint,
                )
            });
        }
        found == wanted
    }

    /// A quote at that byte of the line is not closed.
    pub fn open_quote(&mut self, line: Line<'_>, start: usize) {
        let field = Field {
            text: &line.text[start..],
            start,
        };
        self.value(line, field, "", || {
            Complaint::new(
                "this quote is not closed",
                "",
                "close it behind the value, or remove it",
            )
        });
    }

    /// A problem of the whole file.
    pub fn file(&mut self, complaint: Complaint) {
        self.push("", |file| {
            (
                Place {
                    file: file.to_owned(),
                    ..Place::default()
                },
                String::new(),
                complaint,
            )
        });
    }

    /// A problem of a whole line; `key` is the column that is meant, if any.
    pub fn line(&mut self, line: Line<'_>, key: &str, complaint: impl FnOnce() -> Complaint) {
        let whole = Field {
            text: line.text,
            start: 0,
        };
        self.push(key, |file| {
            (place(file, line, whole), String::new(), complaint())
        });
    }

    /// A problem of one value, `key` being its column.
    pub fn value(
        &mut self,
        line: Line<'_>,
        field: Field<'_>,
        key: &str,
        complaint: impl FnOnce() -> Complaint,
    ) {
        self.push(key, |file| {
            (place(file, line, field), shortened(field.text), complaint())
        });
    }

    /// A problem of one table cell.
    pub fn cell(&mut self, cell: &Cell<'_>, complaint: impl FnOnce() -> Complaint) {
        self.value(cell.line, cell.field, cell.key, complaint);
    }

    /// Adds one that is made already.
    pub fn add(&mut self, problem: Problem) {
        if self.list.len() >= SHOWN {
            self.more += 1;
            return;
        }
        self.list.push(problem);
    }

    // built only while it will be shown, so that a file of a million bad rows costs nothing
    fn push(&mut self, key: &str, build: impl FnOnce(&str) -> (Place, String, Complaint)) {
        if self.list.len() >= SHOWN {
            self.more += 1;
            return;
        }
        let (
            place,
            value,
            Complaint {
                message,
                allowed,
                hint,
            },
        ) = build(self.file);
        self.list.push(
            Problem::invalid(message)
                .at(place)
                .key(key)
                .value(value)
                .allowed(allowed)
                .hint(hint),
        );
    }

    /// All of them; beyond the first 50, one last entry says how many more there are.
    #[must_use]
    pub fn finish(mut self) -> Problems {
        if self.more > 0 {
            self.list.push(Problem::more(self.file, self.more));
        }
        self.list
    }
}

fn no_long_line(text: &str) -> Result<&str, Complaint> {
    match text.split('\n').position(|line| line.len() >= MAX_LINE) {
        Some(before) => {
            let message = format!("line {} is too long for a row of a table", before + 1);
            Err(Complaint::new(
                message,
                format!("up to {MAX_LINE} bytes"),
                "is this a CSV file?",
            ))
        }
        None => Ok(text),
    }
}

fn place(file: &str, line: Line<'_>, field: Field<'_>) -> Place {
    let before = line.text.get(..field.start).unwrap_or_default();
    let shown = line.text.len() <= MAX_SHOWN;
    Place {
        file: file.to_owned(),
        line: line.number,
        column: before.chars().count() + 1,
        line_text: if shown {
            line.text.to_owned()
        } else {
            String::new()
        },
        width: field.text.chars().count().max(1),
    }
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(MAX_VALUE) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_counts_characters_and_not_bytes() {
        let line = Line {
            number: 7,
            text: "é,ü,12",
        };
        let mut problems = Collector::new("f.csv");
        problems.value(
            line,
            Field {
                text: "12",
                start: 6,
            },
            "k",
            Complaint::default,
        );
        let place = &problems.finish()[0].place;
        assert_eq!(
            (
                place.line,
                place.column,
                place.width,
                place.line_text.as_str()
            ),
            (7, 5, 2, "é,ü,12")
        );
    }

    #[test]
    fn long_lines_and_values_are_kept_off_the_screen() {
        let text = "ö".repeat(1000);
        let mut problems = Collector::new("f.csv");
        problems.value(
            Line {
                number: 1,
                text: &text,
            },
            Field {
                text: &text,
                start: 0,
            },
            "k",
            Complaint::default,
        );
        let problem = &problems.finish()[0];
        assert_eq!(
            (
                problem.place.line_text.as_str(),
                problem.value.chars().count()
            ),
            ("", 63)
        );
    }

    #[test]
    fn a_long_line_and_many_columns_are_refused() {
        for (length, taken) in [(MAX_LINE - 1, true), (MAX_LINE, false)] {
            let text = format!("a,b\n{}\n1,2\n", "1".repeat(length));
            let mut problems = Collector::new("f.csv");
            assert_eq!(
                problems.lines(text.as_bytes()).map(Iterator::count),
                taken.then_some(3)
            );
            let list = problems.finish();
            assert_eq!(
                list.first().map(|p| p.message.as_str()),
                (!taken).then_some("line 2 is too long for a row of a table")
            );
        }
        for (columns, taken) in [(MAX_COLUMNS, true), (MAX_COLUMNS + 1, false)] {
            let text = vec!["a"; columns].join(",");
            let mut problems = Collector::new("f.csv");
            assert_eq!(
                problems
                    .names(Line {
                        number: 1,
                        text: &text
                    })
                    .is_some(),
                taken
            );
            assert_eq!(problems.is_empty(), taken);
        }
    }

    #[test]
    fn the_rest_is_counted() {
        for (count, last) in [
            (50, None),
            (51, Some("1 more problem is not shown")),
            (250, Some("200 more problems are not shown")),
        ] {
            let mut problems = Collector::new("f.csv");
            for _ in 0..count {
                problems.file(Complaint::default());
            }
            let list = problems.finish();
            assert_eq!(list.len(), count.min(50) + usize::from(last.is_some()));
            assert_eq!(
                list.last()
                    .map(|p| p.message.as_str())
                    .filter(|m| !m.is_empty()),
                last
            );
        }
    }
}
